//! Writes the files of this workspace that are made from others; `cargo xtask presets` and
//! `cargo xtask trip` run it.

mod presets;

use std::path::Path;
use std::process::ExitCode;

use voltstep::simulate::synthetic::{trip_csv, truth_toml};

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    match std::env::args().nth(1).as_deref() {
        Some("presets") => presets::write(&root),
        Some("trip") => {
            let folder = root.join("data/trips");
            std::fs::write(folder.join("synthetic.csv"), trip_csv()).unwrap();
            std::fs::write(folder.join("synthetic.truth.toml"), truth_toml()).unwrap();
        }
        _ => {
            eprintln!("usage: generate presets|trip");
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}
