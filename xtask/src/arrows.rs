//! Which module uses which: layers that only look down, and no circles between neighbours.
//!
//! Tests and comments may name what they like. A name that the crate's root passes on counts as a
//! name of the module that it comes from.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};

use crate::documents;
use crate::firmware;

/// A crate, and its modules from the lowest layer to the highest. Modules of one layer do not use
/// each other. Without layers only circles are looked for.
struct Crate {
    sources: &'static str,
    layers: &'static [&'static [&'static str]],
}

/// The one list of layers.
const CRATES: &[Crate] = &[
    Crate {
        sources: "plant-core/src",
        layers: &[
            // One thing: a table of numbers can be refused, and what is refused is a number.
            &["num+error+model"],
            &["port", "thermal"],
            &["battery", "auxiliary", "converter", "link", "mechanics"],
            &["machine"],
            &["signal", "circuit"],
            &["powertrain"],
            &["control"],
            &["presets"],
        ],
    },
    Crate {
        sources: "bms/src",
        layers: &[
            &["measure"],
            &["estimate"],
            &["protect"],
            &["balance", "contactor", "limit", "log"],
            &["store", "comm"],
            &["manage"],
        ],
    },
    Crate {
        sources: "host-harness/src",
        layers: &[
            &["read"],
            &["simulate"],
            &["verify", "evaluate", "identify"],
            &["show"],
            &["cli"],
            &["main"],
        ],
    },
    Crate { sources: "capi/src", layers: &[] },
    Crate { sources: "web/src", layers: &[] },
    Crate { sources: "python/src", layers: &[] },
    Crate { sources: "xtask/src", layers: &[] },
];

/// A module: the names on the way to it from the crate's root.
type Module = Vec<String>;

/// Fails on an upward arrow, one between modules of the same layer, or a circle.
pub fn arrows() -> Result<()> {
    let mut faults = Vec::new();
    for Crate { sources, layers } in CRATES {
        let mut files = BTreeMap::new();
        for path in documents::sources(Path::new(sources))? {
            let text = fs::read_to_string(firmware::root().join(&path))?;
            files.insert(path.strip_prefix(sources)?.to_owned(), text);
        }
        faults.extend(faults_of(&files, layers).iter().map(|fault| format!("{sources}: {fault}")));
    }
    if faults.is_empty() {
        println!("every arrow leads down");
        return Ok(());
    }
    bail!("arrows that do not lead down:\n  {}", faults.join("\n  "))
}

/// What is wrong in a crate, given its files by their paths.
fn faults_of(files: &BTreeMap<PathBuf, String>, layers: &[&[&str]]) -> Vec<String> {
    let root: Vec<(String, Module)> =
        files.get(Path::new("lib.rs")).map(|text| passed_on(&code(text))).unwrap_or_default();
    let modules: BTreeSet<Module> = files.keys().map(|path| module(path)).collect();
    let mut arrows: BTreeSet<(Module, Module)> = BTreeSet::new();
    for (path, text) in files {
        let from = module(path);
        if from.is_empty() || is_test(&from) {
            continue;
        }
        for used in uses(&code(text), &from) {
            let used = match used.first().and_then(|name| root.iter().find(|(n, _)| n == name)) {
                Some((_, target)) => target.clone(),
                None => used,
            };
            // The longest beginning of the path that is a module.
            let to = (1..=used.len()).rev().map(|n| used[..n].to_vec());
            if let Some(to) = to.into_iter().find(|to| modules.contains(to)) {
                arrows.insert((from.clone(), to));
            }
        }
    }
    let mut faults = upward(&arrows, layers);
    faults.extend(unlisted(&modules, layers));
    faults.extend(circles(&arrows, layers));
    faults
}

/// Whether a name of the list of layers stands for a module: `a+b` for either.
fn stands_for(names: &str, module: &str) -> bool {
    names.split('+').any(|name| name == module)
}

fn upward(arrows: &BTreeSet<(Module, Module)>, layers: &[&[&str]]) -> Vec<String> {
    let place = |module: &Module| {
        layers.iter().enumerate().find_map(|(layer, names)| {
            let names = names.iter().find(|names| stands_for(names, &module[0]))?;
            Some((layer, *names))
        })
    };
    let faulty = |(from, to): &(Module, Module)| {
        let ((from_layer, from_name), (to_layer, to_name)) = (place(from)?, place(to)?);
        let fine = to_layer < from_layer || from_name == to_name;
        (!fine).then(|| format!("{} uses {}", from.join("::"), to.join("::")))
    };
    arrows.iter().filter_map(faulty).collect()
}

/// Modules that the list of layers does not name.
fn unlisted(modules: &BTreeSet<Module>, layers: &[&[&str]]) -> Vec<String> {
    let known = |module: &Module| layers.concat().iter().any(|names| stands_for(names, &module[0]));
    let tops = modules.iter().filter(|module| module.len() == 1);
    tops.filter(|module| !layers.is_empty() && !known(module))
        .map(|module| format!("{} is in no layer", module[0]))
        .collect()
}

/// Circles between the modules of one folder, whatever of theirs uses the other.
fn circles(arrows: &BTreeSet<(Module, Module)>, layers: &[&[&str]]) -> Vec<String> {
    let one = |a: &str, b: &str| {
        layers.concat().iter().any(|names| stands_for(names, a) && stands_for(names, b))
    };
    let mut neighbours: BTreeMap<Module, BTreeSet<Module>> = BTreeMap::new();
    for (from, to) in arrows {
        let shared = from.iter().zip(to).take_while(|(a, b)| a == b).count();
        // A folder and what is in it are one module to everybody else.
        let apart = shared < from.len() && shared < to.len();
        if apart && !(shared == 0 && one(&from[0], &to[0])) {
            let (from, to) = (from[..=shared].to_vec(), to[..=shared].to_vec());
            neighbours.entry(from).or_default().insert(to);
        }
    }
    let reaches = |from: &Module, to: &Module| {
        let (mut seen, mut next) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(module) = next.pop() {
            for found in neighbours.get(&module).into_iter().flatten() {
                if found == to {
                    return true;
                }
                if seen.insert(found.clone()) {
                    next.push(found.clone());
                }
            }
        }
        false
    };
    let pairs = neighbours.iter().flat_map(|(from, all)| all.iter().map(move |to| (from, to)));
    pairs
        .filter(|(from, to)| reaches(to, from))
        .map(|(from, to)| format!("{} uses {}, in a circle", from.join("::"), to.join("::")))
        .collect()
}

/// The module that a file is.
fn module(path: &Path) -> Module {
    let path = path.with_extension("");
    let mut names: Module = path.iter().map(|name| name.to_string_lossy().into_owned()).collect();
    if names.last().is_some_and(|name| name == "mod" || name == "lib") {
        names.pop();
    }
    names
}

fn is_test(module: &Module) -> bool {
    module.iter().any(|name| name == "tests")
}

/// The code of a file: without comments, texts and what is only compiled for tests.
fn code(text: &str) -> String {
    let mut code = String::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let raw = rest.strip_prefix("r\"").map(|r| (r, "\""));
        let raw = raw.or_else(|| rest.strip_prefix("r#\"").map(|r| (r, "\"#")));
        if let Some((after, end)) = raw
            && !code.ends_with(|c: char| c.is_alphanumeric() || c == '_')
        {
            rest = after.split_once(end).map_or("", |(_, tail)| tail);
        } else if rest.starts_with("//") {
            rest = &rest[rest.find('\n').unwrap_or(rest.len())..];
        } else if let Some(after) = rest.strip_prefix("/*") {
            rest = after.split_once("*/").map_or("", |(_, tail)| tail);
        } else if c == '"' {
            rest = after_text(&rest[1..]);
        } else if let Some(after) = character(rest) {
            rest = after;
        } else {
            code.push(c);
            rest = &rest[c.len_utf8()..];
        }
    }
    without_tests(&code)
}

/// What follows a text whose opening mark is gone.
fn after_text(text: &str) -> &str {
    let mut escaped = false;
    for (at, c) in text.char_indices() {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return &text[at + 1..],
            _ => {}
        }
    }
    ""
}

/// What follows a character in quotes; none where it is a lifetime or something else.
fn character(text: &str) -> Option<&str> {
    let inside = text.strip_prefix('\'')?;
    let end = match inside.strip_prefix('\\') {
        Some(escape) => 1 + escape.char_indices().nth(1)?.0 + escape[1..].find('\'')?,
        None => inside.chars().next()?.len_utf8(),
    };
    inside.get(end..)?.strip_prefix('\'')
}

/// Code without the items that are only compiled for tests.
fn without_tests(code: &str) -> String {
    let mut kept = String::new();
    let mut rest = code;
    while let Some((before, after)) = rest.split_once("#[cfg(test)]") {
        kept += before;
        let mut depth = 0;
        let end = after.char_indices().find_map(|(at, c)| {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                _ => {}
            }
            (depth == 0 && (c == ';' || c == '}')).then_some(at + 1)
        });
        rest = &after[end.unwrap_or(after.len())..];
    }
    kept + rest
}

/// The paths in code that begin with `crate::` or `super::`, from the crate's root.
fn uses(code: &str, module: &Module) -> Vec<Module> {
    let mut uses = Vec::new();
    for (at, start) in code.match_indices("crate::").chain(code.match_indices("super::")) {
        if code[..at].ends_with(|c: char| c.is_alphanumeric() || "_:$".contains(c)) {
            continue;
        }
        let mut base = module.clone();
        let mut rest = &code[at..];
        if start == "crate::" {
            base.clear();
            rest = &rest[start.len()..];
        }
        while let Some(after) = rest.strip_prefix("super::") {
            base.pop();
            rest = after;
        }
        let (paths, _) = tree(rest);
        uses.extend(paths.into_iter().map(|(path, _)| [base.clone(), path].concat()));
    }
    uses
}

/// What the crate's root passes on: the name there, and the path that it stands for.
fn passed_on(code: &str) -> Vec<(String, Module)> {
    let trees = code.split("pub use ").skip(1).map(|rest| tree(rest).0);
    trees.flatten().filter_map(|(path, name)| Some((name?, path))).collect()
}

/// The paths of a tree like `a::{b, c::d as e}`, each with the name that it brings, and what
/// follows the tree.
fn tree(text: &str) -> (Vec<(Module, Option<String>)>, &str) {
    let text = text.trim_start();
    if let Some(mut rest) = text.strip_prefix('{') {
        let mut paths = Vec::new();
        loop {
            rest = rest.trim_start_matches(|c: char| c == ',' || c.is_whitespace());
            if rest.is_empty() {
                return (paths, rest);
            }
            if let Some(after) = rest.strip_prefix('}') {
                return (paths, after);
            }
            let before = rest.len();
            let (found, after) = tree(rest);
            paths.extend(found);
            // What is no tree is passed by.
            rest = if after.len() == before { &after[char_len(after)..] } else { after };
        }
    }
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
    let (name, rest) = text.split_at(end);
    if name.is_empty() {
        return (vec![(Vec::new(), None)], rest);
    }
    if let Some(rest) = rest.strip_prefix("::") {
        let (paths, rest) = tree(rest);
        let longer = |(path, alias)| ([vec![name.to_owned()], path].concat(), alias);
        return (paths.into_iter().map(longer).collect(), rest);
    }
    if let Some(renamed) = rest.strip_prefix(" as ") {
        let end = renamed.find(|c: char| !(c.is_alphanumeric() || c == '_'));
        let (alias, rest) = renamed.split_at(end.unwrap_or(renamed.len()));
        return (vec![(vec![name.to_owned()], Some(alias.to_owned()))], rest);
    }
    (vec![(vec![name.to_owned()], Some(name.to_owned()))], rest)
}

fn char_len(text: &str) -> usize {
    text.chars().next().map_or(0, char::len_utf8)
}

#[cfg(test)]
mod tests;
