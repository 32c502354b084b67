//! Every check of the workspace in one command.
//!
//! `cargo xtask test` sets up what it needs and runs every part of [`parts::PARTS`] in order; it
//! stops at the first part that fails. `cargo xtask <part>` runs one part. CI runs the same
//! command. `cargo xtask math` is what mdBook calls for the book's equations.

mod args;
mod arrows;
mod board;
mod book;
mod browser;
mod capi;
mod citations;
mod compare;
mod counted;
mod counts;
mod data;
mod dbc;
mod documents;
mod examples;
mod firmware;
mod generate;
mod generated;
mod image;
mod links;
mod live;
mod math;
mod metadata;
mod mutants;
mod parts;
mod paths;
mod picture;
mod python;
mod qemu;
mod report;

mod shell;
mod venv;
mod web;

use std::process::ExitCode;
use std::time::Instant;

use crate::parts::Part;
use crate::report::Verdict;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if let [first, rest @ ..] = words.as_slice()
        && first == math::WORD
    {
        return math::answer(rest).map_or_else(
            |error| {
                eprintln!("{error:#}");
                ExitCode::FAILURE
            },
            |()| ExitCode::SUCCESS,
        );
    }
    if let Some(parts) = args::parse(&words) {
        run(&parts)
    } else {
        eprint!("{}", args::usage());
        ExitCode::from(2)
    }
}

/// Runs the parts up to the first that fails, then prints the table.
fn run(parts: &[&Part]) -> ExitCode {
    let mut table = Vec::new();
    let mut failure = None;
    for part in parts {
        if failure.is_some() {
            table.push((part.name, Verdict::NotRun));
            continue;
        }
        println!("\n=== {}: {}", part.name, part.about);
        let start = Instant::now();
        let result = (part.run)();
        let time = start.elapsed();
        table.push(match result {
            Ok(()) => (part.name, Verdict::Passed(time)),
            Err(error) => {
                failure = Some((part.name, error));
                (part.name, Verdict::Failed(time))
            }
        });
    }

    print!("\n{}", report::table(&table));
    if parts.iter().any(|part| part.needs_data) && data::folder().is_none() {
        print!("{}", data::NOTICE);
    }
    match failure {
        None => ExitCode::SUCCESS,
        Some((name, error)) => {
            eprintln!("\nxtask: part `{name}` failed: {error:#}");
            ExitCode::FAILURE
        }
    }
}
