//! A parameter file as a table: what stands beside a value in the file is its source.

use std::fmt::Write;

use super::page::escaped;

/// The lines of a parameter file (TOML), its head as it is.
pub fn html(text: &str) -> String {
    let mut head = String::new();
    let mut rows = String::new();
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        let line = line.trim();
        if let Some(comment) = line.strip_prefix('#') {
            if rows.is_empty() {
                let _ = writeln!(head, "{}", comment.strip_prefix(' ').unwrap_or(comment));
            } else {
                let _ = writeln!(
                    rows,
                    "<tr><td colspan=\"3\" class=\"quiet\">{}</td></tr>",
                    escaped(comment.trim())
                );
            }
        } else if line.starts_with('[') {
            let (name, comment) = split(line);
            let name = escaped(name.trim_matches(['[', ']']));
            let _ = writeln!(
                rows,
                "<tr class=\"group\"><th colspan=\"2\" scope=\"rowgroup\">{name}</th><td>{}</td></tr>",
                escaped(comment)
            );
        } else if let Some((key, rest)) = line.split_once('=') {
            let (value, comment) = split(rest);
            let (mut value, mut comment) = (value.to_owned(), comment.to_owned());
            // A comment goes on below itself.
            while let Some(more) = lines.peek().filter(|l| l.starts_with([' ', '\t'])) {
                let (more, said) = split(more);
                if !more.is_empty() {
                    value += "\n";
                    value += more;
                }
                if !said.is_empty() {
                    comment += if comment.is_empty() { "" } else { " " };
                    comment += said;
                }
                lines.next();
            }
            if let Some(end) = lines.next_if(|l| matches!(l.trim(), "]" | "}" | "],")) {
                value += "\n";
                value += end.trim();
            }
            let _ = writeln!(
                rows,
                "<tr><td><code>{}</code></td><td><code>{}</code></td><td>{}</td></tr>",
                escaped(key.trim()),
                escaped(&value),
                escaped(&comment)
            );
        }
    }
    let head = head.trim();
    let head =
        if head.is_empty() { String::new() } else { format!("<pre>{}</pre>\n", escaped(head)) };
    format!(
        "{head}<div class=\"scroll\"><table class=\"parameters\">\n<thead><tr><th scope=\"col\">parameter</th>\
         <th scope=\"col\">value</th><th scope=\"col\">source, meaning</th></tr></thead>\n\
         <tbody>\n{rows}</tbody></table></div>\n"
    )
}

/// What stands before and behind the `#` of a comment that is not in a text.
fn split(line: &str) -> (&str, &str) {
    let mut quote = None;
    for (at, c) in line.char_indices() {
        match (quote, c) {
            (None, '#') => return (line[..at].trim(), line[at + 1..].trim()),
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), c) if c == open => quote = None,
            _ => {}
        }
    }
    (line.trim(), "")
}

#[cfg(test)]
mod tests {
    use super::html;

    #[test]
    fn each_value_stands_beside_its_source() {
        let table = html(
            "# Car\n#   [B] a <b>\nname = \"a # b\"   # one line\n                  # and more\n\
             [body]   # all of it\nmass_kg = 1490.0 # [B]\ntable = [\n    [1, 2], # first\n    [3, 4],\n]\nlast = 1\n",
        );
        for part in [
            "<pre>Car\n  [B] a &lt;b&gt;</pre>",
            "<td><code>name</code></td><td><code>&quot;a # b&quot;</code></td><td>one line and more</td>",
            "scope=\"rowgroup\">body</th><td>all of it</td>",
            "<td><code>mass_kg</code></td><td><code>1490.0</code></td><td>[B]</td>",
            "<td><code>table</code></td><td><code>[\n[1, 2],\n[3, 4],\n]</code></td><td>first</td>",
            "<td><code>last</code></td>",
        ] {
            assert!(table.contains(part), "{part} in {table}");
        }
    }

    #[test]
    fn no_parameter_of_a_built_in_vehicle_is_lost() {
        for vehicle in crate::read::vehicle::builtin() {
            let (_, text) = crate::read::vehicle::text(&vehicle.name).unwrap();
            let keys = text.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_lowercase()));
            assert_eq!(
                html(&text).matches("<tr><td><code>").count(),
                keys.count(),
                "{}",
                vehicle.name
            );
        }
    }
}
