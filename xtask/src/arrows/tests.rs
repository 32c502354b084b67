use super::*;

const LAYERS: &[&[&str]] = &[&["num+error"], &["battery", "motor"], &["plant"]];

/// The faults of a crate with these files and, where they are not among them, empty others.
fn faults(given: &[(&str, &str)]) -> Vec<String> {
    let mut files = BTreeMap::new();
    for path in ["lib.rs", "num.rs", "error.rs", "battery/mod.rs", "motor.rs", "plant.rs"] {
        files.insert(PathBuf::from(path), String::new());
    }
    for (path, text) in given {
        files.insert(PathBuf::from(path), (*text).to_owned());
    }
    faults_of(&files, LAYERS)
}

#[test]
fn downward_arrows_pass() {
    let found = faults(&[
        ("error.rs", "use crate::num::Real;"),
        ("num.rs", "use crate::error::check;"),
        ("plant.rs", "use crate::{battery::{Battery, rc::Rc}, motor};"),
        ("battery/mod.rs", "mod rc; use crate::num::Real;"),
        ("battery/rc.rs", "use super::Battery; fn f() { crate::error::fail(); }"),
    ]);
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn an_upward_arrow_is_named() {
    for (path, text, fault) in [
        ("num.rs", "use crate::plant::Plant;", "num uses plant"),
        ("battery/mod.rs", "use crate::{num::Real, motor::Motor};", "battery uses motor"),
        ("battery/rc.rs", "fn f() { super::super::plant::go() }", "battery::rc uses plant"),
        ("motor.rs", "struct S(crate::battery::rc::Rc);", "motor uses battery"),
    ] {
        let found = faults(&[(path, text)]);
        assert_eq!(found, [fault], "{text}");
    }
}

#[test]
fn what_the_root_passes_on_is_its_modules() {
    let root = ("lib.rs", "pub mod plant; pub use plant::{Plant, Step as Go};");
    for name in ["Plant", "Go"] {
        let text = format!("use crate::{name};");
        assert_eq!(faults(&[root, ("num.rs", &text)]), ["num uses plant"], "{name}");
    }
    assert!(faults(&[root, ("num.rs", "use crate::Step;")]).is_empty());
}

#[test]
fn tests_texts_and_comments_do_not_count() {
    let text = r##"
        // use crate::plant::A;
        /// [`crate::plant`] /* */
        /* crate::plant::B */
        const T: &str = "crate::plant::C \" crate::plant::D";
        const R: &str = r#"crate::plant::E"#;
        const C: [char; 3] = ['"', '\'', '\u{7f}'];
        fn f<'a>(x: &'a str) {}
        #[cfg(test)]
        use crate::plant::F;
        #[cfg(test)]
        mod tests { fn g() { crate::plant::G } }
        #[cfg(test)]
        mod more;
    "##;
    assert!(faults(&[("num.rs", text), ("battery/tests.rs", "use crate::plant::H;")]).is_empty());
    let after = format!("{text}\nuse crate::plant::I;");
    assert_eq!(faults(&[("num.rs", &after)]), ["num uses plant"]);
}

#[test]
fn a_circle_between_neighbours_is_named() {
    let found = faults(&[
        ("battery/a.rs", "use super::b::B;"),
        ("battery/b.rs", "use crate::battery::c::C;"),
        ("battery/c.rs", "use super::a::A;"),
    ]);
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(found[0].contains("battery::a uses battery::b, in a circle"), "{found:?}");
    assert!(faults(&[("battery/a.rs", "use super::b::B;"), ("battery/b.rs", "")]).is_empty());
}

#[test]
fn a_module_without_a_layer_is_named() {
    assert_eq!(faults(&[("inverter.rs", "")]), ["inverter is in no layer"]);
}

#[test]
fn every_crate_of_the_list_is_there_and_seen() {
    for Crate { sources, layers } in CRATES {
        let files = documents::sources(Path::new(sources)).unwrap();
        for name in layers.concat().iter().flat_map(|names| names.split('+')) {
            let seen = files.iter().any(|path| {
                module(path.strip_prefix(sources).unwrap()).first().is_some_and(|top| top == name)
            });
            assert!(seen, "{sources} has no {name}");
        }
    }
}
