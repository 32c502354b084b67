//! Why a value of a document does not fit.

use std::fmt;

use serde::de::{self, Expected, Unexpected};

use crate::read::error::{listed, nearest, shown};

/// Why a value does not fit; the innermost place wins.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) kind: Kind,
    pub(super) message: String,
    pub(super) offset: Option<usize>,
}

/// What is wrong, as far as it is known without the place.
#[derive(Debug)]
pub(super) enum Kind {
    /// A name that is none of those known.
    UnknownName(String, &'static [&'static str]),
    /// A key that must be there.
    MissingKey(&'static str),
    /// A value that does not fit; the message says why.
    Value,
    /// The message says it all.
    Told,
}

impl Fault {
    fn new(kind: Kind, message: String) -> Self {
        Self { kind, message, offset: None }
    }

    pub(super) fn told(offset: usize, message: String) -> Self {
        Self { kind: Kind::Told, message, offset: Some(offset) }
    }

    /// Words the fault once its place is known.
    pub(super) fn or_at(self, offset: usize, path: &str) -> Self {
        let subject = path.rsplit_once('.').map_or((path, ""), |(table, key)| (key, table));
        let message = match self.kind {
            Kind::Told => return self,
            Kind::MissingKey(key) => format!("missing key {}", of_table(key, path)),
            Kind::UnknownName(name, known) => format!(
                "unknown value `{}` of {}; {}",
                shown(&name),
                of_table(subject.0, subject.1),
                advice(&name, known, None)
            ),
            Kind::Value if path.is_empty() => self.message,
            Kind::Value => {
                // A rule names its field in full, or as far as it is known.
                let named = [path, subject.0].into_iter().find_map(|name| {
                    self.message.strip_prefix(name).and_then(|rest| rest.strip_prefix(' '))
                });
                let subject = of_table(subject.0, subject.1);
                match named {
                    Some(rule) => format!("{subject} {rule}"),
                    None => format!("{subject}: {}", self.message),
                }
            }
        };
        Self::told(offset, message)
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Fault {}

impl de::Error for Fault {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self::new(Kind::Value, message.to_string())
    }

    fn invalid_type(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        let expected = match expected.to_string() {
            number if number == "f32" || number == "f64" => "a number".to_owned(),
            text if text == "a string" => "a text".to_owned(),
            table if table.contains("struct ") || table.contains("variant") => "a table".to_owned(),
            other => other,
        };
        let found = match found {
            Unexpected::Bool(b) => format!("`{b}`"),
            Unexpected::Unsigned(_) | Unexpected::Signed(_) | Unexpected::Float(_) => {
                "a number".to_owned()
            }
            Unexpected::Str(text) => format!("the text \"{}\"", shown(text)),
            Unexpected::Seq => "a list".to_owned(),
            Unexpected::Map => "a table".to_owned(),
            Unexpected::UnitVariant => "a text".to_owned(),
            other => other.to_string(),
        };
        Self::custom(format_args!("expected {expected}, found {found}"))
    }

    fn unknown_variant(name: &str, known: &'static [&'static str]) -> Self {
        Self::new(Kind::UnknownName(name.to_owned(), known), String::new())
    }

    fn unknown_field(name: &str, known: &'static [&'static str]) -> Self {
        Self::unknown_variant(name, known)
    }

    fn missing_field(key: &'static str) -> Self {
        Self::new(Kind::MissingKey(key), String::new())
    }
}

/// `` `key` in [table] ``.
pub(super) fn of_table(key: &str, table: &str) -> String {
    if table.is_empty() {
        format!("`{}`", shown(key))
    } else {
        format!("`{}` in [{}]", shown(key), shown(table))
    }
}

pub(super) fn joined(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// What follows a message about an unknown name.
pub(super) fn advice(name: &str, known: &[&'static str], brackets: Option<&str>) -> String {
    let mark = |k: &str| match brackets {
        Some(path) => format!("[{}]", joined(path, k)),
        None => format!("`{k}`"),
    };
    match nearest(name, known.iter().copied()) {
        Some(near) => format!("did you mean {}?", mark(near)),
        None => format!("expected one of {}", listed(known.iter().copied())),
    }
}
