//! As much JSON as the page is told: a crate for it would be half of what the browser loads.

/// A number, or null for what is none.
#[must_use]
pub fn number(value: f64) -> String {
    if value.is_finite() { value.to_string() } else { "null".to_owned() }
}

/// Names, without anything that JSON would escape, and values that are JSON already.
#[must_use]
pub fn object(fields: &[(&str, String)]) -> String {
    let fields: Vec<_> = fields.iter().map(|(name, value)| format!("\"{name}\":{value}")).collect();
    format!("{{{}}}", fields.join(","))
}

/// A name, without anything that JSON would escape.
#[must_use]
pub fn name(text: &str) -> String {
    format!("\"{text}\"")
}

/// Values that are JSON already.
#[must_use]
pub fn list(values: &[String]) -> String {
    format!("[{}]", values.join(","))
}
