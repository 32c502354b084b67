//! Text that fits: estimated widths, shortening, wrapping, and number formats.

/// The text without characters that must not be in an XML file; white space of
/// any kind becomes a blank, except for spaces at which no line may break.
pub(super) fn clean(text: &str) -> String {
    let is_hard = |c| matches!(c, '\u{A0}' | '\u{202F}');
    let blank = |c: char| c.is_control() || (c.is_whitespace() && !is_hard(c));
    let text: String = text
        .chars()
        .filter(|c| !matches!(c, '\u{FFFE}' | '\u{FFFF}'))
        .map(|c| if blank(c) { ' ' } else { c })
        .collect();
    text.trim().to_owned()
}

/// Estimated width in pixels in a sans-serif font. On the large side, because
/// the reader's font is not known.
pub(super) fn width(text: &str, size_px: f64) -> f64 {
    let em: f64 = text
        .chars()
        .map(|c| match c {
            'i' | 'j' | 'l' | '\'' | '|' => 0.25,
            ' ' | '\u{A0}' | '\u{202F}' | '.' | ',' | ':' | ';' | '!' | 'f' | 't' | 'I' | '/'
            | '(' | ')' | '[' | ']' => 0.31,
            'r' | '-' | '·' => 0.36,
            'm' | 'M' | 'w' | '%' | '@' => 0.87,
            'W' | '…' | '—' => 1.0,
            'A'..='Z' => 0.71,
            c if c.is_ascii() || c < '\u{1100}' => 0.56,
            '−' => 0.58,
            _ => 1.0,
        })
        .sum();
    em * size_px * 1.12
}

/// The text, cut and ended with an ellipsis where it is wider than `max_px`.
pub(super) fn fit(text: &str, size_px: f64, max_px: f64) -> String {
    if width(text, size_px) <= max_px {
        return text.to_owned();
    }
    let room = max_px - width("…", size_px);
    let mut end = 0;
    for (at, c) in text.char_indices() {
        let next = at + c.len_utf8();
        if width(&text[..next], size_px) > room {
            break;
        }
        end = next;
    }
    format!("{}…", text[..end].trim_end())
}

/// The text broken between words into lines of at most `max_px`.
pub(super) fn wrap(text: &str, size_px: f64, max_px: f64) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = String::new();
    for word in text.split(' ') {
        let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if line.is_empty() || width(&longer, size_px) <= max_px {
            line = longer;
        } else {
            lines.push(fit(&line, size_px, max_px));
            word.clone_into(&mut line);
        }
    }
    lines.push(fit(&line, size_px, max_px));
    lines
}

/// The number with three significant digits.
pub(super) fn three_digits(value: f64) -> String {
    if !value.is_finite() {
        return "n/a".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    // Rounding first, so that 9.999 counts as 10.0.
    let scientific = format!("{value:.2e}");
    let rounded: f64 = scientific.parse().unwrap_or(value);
    let exponent = scientific.split_once('e').and_then(|(_, e)| e.parse::<i32>().ok());
    let text = match exponent {
        Some(exponent @ -4..=6) => {
            let decimals = usize::try_from(2 - exponent).unwrap_or(0);
            format!("{rounded:.decimals$}")
        }
        _ => scientific,
    };
    minus(&text)
}

/// The number with `decimals` decimals.
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    if text.trim_start_matches(['-', '0', '.']).is_empty() {
        return text.trim_start_matches('-').to_owned();
    }
    minus(&text)
}

/// The number in scientific notation with `decimals` decimals.
pub(super) fn scientific(value: f64, decimals: usize) -> String {
    if value == 0.0 { "0".to_owned() } else { minus(&format!("{value:.decimals$e}")) }
}

/// Hyphens as minus signs.
fn minus(text: &str) -> String {
    text.replace('-', "−")
}
