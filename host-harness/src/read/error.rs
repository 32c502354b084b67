//! What is wrong with an input, and where.

use std::fmt;
use std::io::Read;
use std::path::Path;

/// A larger input is refused before it is read \[bytes\].
const LARGEST_BYTES: u64 = 64 << 20;
/// Longer names and values are shortened in a message \[characters\].
const LONGEST_SHOWN: usize = 60;

/// What is wrong with an input, and where: `file:line:column: message`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputError {
    /// The file, or the name that was asked for.
    pub file: String,
    /// Line from 1; none where the file as a whole is meant.
    pub line: Option<u64>,
    /// Column from 1, in characters.
    pub column: Option<u64>,
    /// What is wrong and what was expected.
    pub message: String,
}

impl InputError {
    /// About a file as a whole.
    #[must_use]
    pub fn of_file(file: &str, message: impl Into<String>) -> Self {
        Self { file: file.to_owned(), line: None, column: None, message: message.into() }
    }

    /// About the place `offset` bytes into `text`.
    #[must_use]
    pub fn at(file: &str, text: &str, offset: usize, message: impl Into<String>) -> Self {
        let before = &text.as_bytes()[..offset.min(text.len())];
        let start = before.iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
        let line = before.split(|&b| b == b'\n').count();
        // Every byte that does not continue a character starts one.
        let column = before[start..].iter().filter(|&&b| b & 0xC0 != 0x80).count() + 1;
        Self {
            file: file.to_owned(),
            line: u64::try_from(line).ok(),
            column: u64::try_from(column).ok(),
            message: message.into(),
        }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.file)?;
        for number in [self.line, self.column].into_iter().flatten() {
            write!(f, "{number}:")?;
        }
        write!(f, " {}", self.message)
    }
}

impl std::error::Error for InputError {}

/// The name of a file, without its folder and its extension.
pub(crate) fn stem(file: &str) -> String {
    Path::new(file).file_stem().map_or(file.into(), |stem| stem.to_string_lossy()).into_owned()
}

/// The bytes of a file.
///
/// # Errors
/// It cannot be read, or is too large.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, InputError> {
    let file = path.to_string_lossy();
    let unreadable = |e: std::io::Error| InputError::of_file(&file, format!("cannot read: {e}"));
    let mut bytes = Vec::new();
    let reader = std::fs::File::open(path).map_err(unreadable)?;
    reader.take(LARGEST_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if u64::try_from(bytes.len()).is_ok_and(|n| n <= LARGEST_BYTES) {
        Ok(bytes)
    } else {
        Err(InputError::of_file(&file, format!("larger than {} MiB", LARGEST_BYTES >> 20)))
    }
}

/// The text in `bytes`, without a byte order mark.
///
/// # Errors
/// It is not UTF-8; the place is that of the first byte that is not.
pub(crate) fn text<'a>(file: &str, bytes: &'a [u8]) -> Result<&'a str, InputError> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    std::str::from_utf8(bytes).map_err(|e| {
        let (sound, _) = bytes.split_at(e.valid_up_to());
        let sound = String::from_utf8_lossy(sound);
        InputError::at(file, &sound, sound.len(), "not a text: expected UTF-8")
    })
}

/// Of `known`, the one that `name` was meant to be, if one is near.
pub(crate) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if name.len() > LONGEST_SHOWN {
        return None;
    }
    let name = name.to_lowercase();
    known
        .into_iter()
        .map(|k| (strsim::normalized_damerau_levenshtein(&name, &k.to_lowercase()), k))
        .filter(|(likeness, _)| *likeness >= 0.6)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, k)| k)
}

/// A piece of an input, fit to stand within a message: on one line and short.
pub(crate) fn shown(piece: &str) -> String {
    let mut short: String = piece.trim().chars().take(LONGEST_SHOWN).collect();
    if piece.trim().chars().nth(LONGEST_SHOWN).is_some() {
        short.push('…');
    }
    on_one_line(&short)
}

/// A text without line ends or anything else that would steer a terminal.
pub(crate) fn on_one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{FFFD}' } else { c }).collect()
}

/// `` `a`, `b`, `c` ``.
pub(crate) fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    names.into_iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_lines_and_characters_from_one() {
        let text = "a = 1\r\nµé = 2\n";
        let at = |offset| InputError::at("f", text, offset, "m").to_string();
        assert_eq!(at(0), "f:1:1: m");
        assert_eq!(at(4), "f:1:5: m");
        assert_eq!(at(text.find('=').unwrap()), "f:1:3: m");
        assert_eq!(at(text.rfind('=').unwrap()), "f:2:4: m");
        assert_eq!(at(8), "f:2:2: m", "within a character");
        assert_eq!(at(1000), "f:3:1: m");
        assert_eq!(InputError::of_file("f", "m").to_string(), "f: m");
    }

    #[test]
    fn finds_the_byte_that_is_not_text() {
        assert_eq!(text("f", b"\xEF\xBB\xBFa").unwrap(), "a");
        let error = text("f", b"ab\nc\xFFd").unwrap_err();
        assert_eq!(error.to_string(), "f:2:2: not a text: expected UTF-8");
    }

    #[test]
    fn suggests_only_what_is_near() {
        let known = ["mass_kg", "resistance"];
        assert_eq!(nearest("masss_kg", known), Some("mass_kg"));
        assert_eq!(nearest("Resistanse", known), Some("resistance"));
        assert_eq!(nearest("colour", known), None);
        assert_eq!(nearest(&"mass_kg".repeat(100_000), known), None);
    }

    #[test]
    fn shortens_what_it_shows() {
        assert_eq!(shown(" a\u{1b}b\n"), "a\u{FFFD}b");
        assert_eq!(shown(&"µ".repeat(100)), format!("{}…", "µ".repeat(60)));
    }

    #[test]
    fn names_a_file_that_is_not_there() {
        let error = read(Path::new("nowhere/x.toml")).unwrap_err().to_string();
        assert!(error.starts_with("nowhere/x.toml: cannot read: "), "{error}");
    }
}
