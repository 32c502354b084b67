//! `cargo xtask picture`: the pictures of a report, and of the live page of the book.

use std::fs;

use anyhow::{Result, ensure};

use crate::browser::Browser;
use crate::firmware::root;
use crate::live::FIRST_SHOWN;
use crate::metadata::Metadata;
use crate::shell::{cargo, program, run};

/// What is replayed, and the part of it that is shown.
const TRIP: &str = "data/trips/synthetic.csv";
const SHOWN: &str = "#t=60,330";
const PICTURE: &str = "docs/src/report.png";
/// The live page, and how much of it is shown.
const LIVE: &str = "docs/src/live.png";
const LIVE_SCREEN: (u32, u32) = (1180, 1080);
/// Pixels of a picture for one of a page.
const SCALE: f64 = 0.75;
/// The book stays small.
const MOST_BYTES: u64 = 150_000;

/// Has Chromium draw both.
pub fn picture() -> Result<()> {
    report()?;
    live()
}

/// The live page with a vehicle as it is.
fn live() -> Result<()> {
    crate::book::build()?;
    let target = Metadata::load()?.target_directory()?;
    let mut browser = Browser::start(&target.join("xtask-picture/profile-live"))?;
    browser.screen(LIVE_SCREEN.0, LIVE_SCREEN.1, SCALE, false)?;
    browser.open(&target.join("book/live.html"))?;
    browser.wait(FIRST_SHOWN)?;
    // The first run of a page takes longer than those that follow.
    browser.ask("document.querySelector('#knobs button').click()")?;
    browser.wait("document.getElementById('live-plant').dataset.shown === '2 1'")?;
    browser.picture(&root().join(LIVE), false)?;
    is_small(LIVE)
}

/// Replays a trip and has its report drawn.
fn report() -> Result<()> {
    let folder = Metadata::load()?.target_directory()?.join("xtask-picture");
    run(cargo().args(["run", "--quiet", "--", "replay", TRIP, "--out"]).arg(&folder))?;
    let file = root().join(PICTURE);
    run(program("chromium")
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"])
        .args(["--virtual-time-budget=10000", "--window-size=1180,1510"])
        .arg(format!("--force-device-scale-factor={SCALE}"))
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .arg(format!("--screenshot={}", file.display()))
        .arg(format!("file://{}{SHOWN}", folder.join("report.html").display())))?;
    is_small(PICTURE)
}

fn is_small(picture: &str) -> Result<()> {
    let bytes = fs::metadata(root().join(picture))?.len();
    ensure!(bytes <= MOST_BYTES, "{picture} has {bytes} bytes, more than {MOST_BYTES}");
    println!("{picture}: {bytes} bytes; look at it and commit it");
    Ok(())
}
