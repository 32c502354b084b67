//! The command line.

use std::fmt::Write;

use crate::parts::{LONG, PARTS, Part};

/// The word that stands for every part.
const EVERYTHING: &str = "test";

/// The parts that the command line asks for; `None` where it is not understood.
pub fn parse(words: &[String]) -> Option<Vec<&'static Part>> {
    let [word] = words else { return None };
    if word == EVERYTHING {
        return Some(PARTS.iter().collect());
    }
    PARTS.iter().chain(LONG).find(|part| part.name == word).map(|part| vec![part])
}

/// What to type, with one line per part.
pub fn usage() -> String {
    let mut text = format!(
        "Usage: cargo xtask {EVERYTHING}      run every part, in this order\n       \
         cargo xtask <part>    run one part\n\nParts:\n"
    );
    for part in PARTS {
        let _ = writeln!(text, "  {:<9}  {}", part.name, part.about);
    }
    text += "\nOnly by name:\n";
    for part in LONG {
        let _ = writeln!(text, "  {:<9}  {}", part.name, part.about);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(words: &[&str]) -> Option<Vec<&'static str>> {
        let words: Vec<String> = words.iter().map(ToString::to_string).collect();
        parse(&words).map(|parts| parts.iter().map(|part| part.name).collect())
    }

    #[test]
    fn test_means_every_part_in_order() {
        let all: Vec<_> = PARTS.iter().map(|part| part.name).collect();
        assert_eq!(names(&["test"]), Some(all));
    }

    #[test]
    fn a_part_by_its_name() {
        for part in PARTS.iter().chain(LONG) {
            assert_eq!(names(&[part.name]), Some(vec![part.name]));
        }
    }

    #[test]
    fn anything_else_is_not_understood() {
        assert_eq!(names(&[]), None);
        assert_eq!(names(&["nonsense"]), None);
        assert_eq!(names(&["format", "docs"]), None);
        assert_eq!(names(&["test", "--fast"]), None);
    }

    #[test]
    fn part_names_are_unique_and_differ_from_the_word_for_all() {
        for (i, part) in PARTS.iter().enumerate() {
            assert_ne!(part.name, EVERYTHING);
            assert!(PARTS[..i].iter().all(|other| other.name != part.name), "{}", part.name);
        }
    }

    #[test]
    fn usage_names_every_part() {
        let text = usage();
        for part in PARTS.iter().chain(LONG) {
            assert!(text.contains(part.name) && text.contains(part.about), "{}", part.name);
        }
    }
}
