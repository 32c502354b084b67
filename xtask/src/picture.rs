//! `cargo xtask picture`: the picture of a report in the book.

use std::fs;

use anyhow::{Result, ensure};

use crate::firmware::root;
use crate::metadata::Metadata;
use crate::shell::{cargo, program, run};

/// What is replayed, and the part of it that is shown.
const TRIP: &str = "data/trips/synthetic.csv";
const SHOWN: &str = "#t=60,330";
const PICTURE: &str = "docs/src/report.png";
/// The book stays small.
const MOST_BYTES: u64 = 150_000;

/// Replays a trip and has Chromium draw its report.
pub fn picture() -> Result<()> {
    let folder = Metadata::load()?.target_directory()?.join("xtask-picture");
    run(cargo().args(["run", "--quiet", "--", "replay", TRIP, "--out"]).arg(&folder))?;
    let file = root().join(PICTURE);
    run(program("chromium")
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"])
        .args([
            "--virtual-time-budget=10000",
            "--window-size=1180,1510",
            "--force-device-scale-factor=0.75",
        ])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .arg(format!("--screenshot={}", file.display()))
        .arg(format!("file://{}{SHOWN}", folder.join("report.html").display())))?;
    let bytes = fs::metadata(&file)?.len();
    ensure!(bytes <= MOST_BYTES, "{PICTURE} has {bytes} bytes, more than {MOST_BYTES}");
    println!("{PICTURE}: {bytes} bytes; look at it and commit it");
    Ok(())
}
