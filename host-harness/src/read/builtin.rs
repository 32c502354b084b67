//! What is built in under a name, or else lies in a file.

use std::path::Path;

use crate::read::error::{self, InputError, listed, nearest, shown};
use crate::read::recognise::{FileKind, recognise};

/// The built-in files of one kind.
pub(crate) struct BuiltIn {
    /// What each of them is.
    pub(crate) kind: FileKind,
    /// Their names, and what they hold.
    pub(crate) files: &'static [(&'static str, &'static str)],
}

impl BuiltIn {
    /// Their names.
    pub(crate) fn names(&self) -> impl Iterator<Item = &'static str> {
        self.files.iter().map(|(name, _)| *name)
    }

    /// All of them, each read by `parse` from its name and its bytes.
    pub(crate) fn all<T>(&self, parse: fn(&str, &[u8]) -> Result<T, InputError>) -> Vec<T> {
        self.files.iter().filter_map(|(name, text)| parse(name, text.as_bytes()).ok()).collect()
    }

    /// The built-in one of that name, or one from a file: a path that ends in `.toml` or names a
    /// folder.
    ///
    /// # Errors
    /// [`InputError`] says what is wrong and where.
    pub(crate) fn load<T>(
        &self,
        name_or_path: &str,
        parse: fn(&str, &[u8]) -> Result<T, InputError>,
    ) -> Result<T, InputError> {
        if let Some((name, text)) = self.files.iter().find(|(name, _)| *name == name_or_path) {
            return parse(name, text.as_bytes());
        }
        if is_toml(name_or_path) || name_or_path.contains(std::path::is_separator) {
            let bytes = error::read(Path::new(name_or_path))?;
            recognise(name_or_path, &bytes, &[self.kind])?;
            return parse(name_or_path, &bytes);
        }
        let near = nearest(name_or_path, self.names())
            .map_or(String::new(), |near| format!("; did you mean `{near}`?"));
        let message = format!(
            "no such {}{near} (built in: {}; or the path of a .toml file)",
            self.kind.name(),
            listed(self.names())
        );
        Err(InputError::of_file(&shown(name_or_path), message))
    }
}

/// Whether a name is that of a TOML file.
pub(crate) fn is_toml(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}
