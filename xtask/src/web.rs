//! What the live page of the book loads: the plant as WebAssembly, scripts and styles.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Map, Value, json};

use crate::firmware::root;
use crate::metadata::Metadata;
use crate::shell::{cargo, program, run};

/// What the plant is compiled for.
pub const TARGET: &str = "wasm32-unknown-unknown";
/// What the vehicles come to.
pub const GOLDEN: &str = "firmware-example/golden.toml";
/// What lies beside the page as it is.
const FILES: [&str; 7] = [
    "web/page/live.js",
    "web/page/live.css",
    "host-harness/src/show/report/plots.js",
    "host-harness/src/show/report/plots.css",
    "host-harness/src/show/report/uplot/uPlot.iife.min.js",
    "host-harness/src/show/report/uplot/uPlot.min.css",
    "host-harness/src/show/report/uplot/LICENSE",
];

/// Compiles the plant and lays what the page loads into the book.
pub fn place(book: &Path) -> Result<()> {
    // A library for the browser only here: with the symbols of `defmt` a PC cannot link one.
    run(cargo()
        .args([
            "rustc",
            "--crate-type",
            "cdylib",
            "-p",
            "voltstep-web",
            "--lib",
            "--profile",
            "web",
        ])
        .args(["--target", TARGET]))?;
    let built = Metadata::load()?.target_directory()?.join(TARGET).join("web/voltstep_web.wasm");
    let packed = program("gzip").args(["-9", "-n", "-c"]).arg(&built).output().context("gzip")?;
    ensure!(packed.status.success(), "gzip ended with {}", packed.status);
    let hashes: Map<String, Value> =
        golden()?.into_iter().map(|(name, hash)| (name, hash.into())).collect();
    // A page that was opened as a file may fetch nothing, but it may load a script.
    let plant = json!({ "golden": hashes, "wasm": BASE64_STANDARD.encode(packed.stdout) });
    let folder = book.join("live");
    fs::create_dir_all(&folder)?;
    fs::write(folder.join("plant.js"), format!("const voltstepPlant = {plant};\n"))?;
    for file in FILES.map(Path::new) {
        let name = file.file_name().context("a file")?;
        fs::copy(root().join(file), folder.join(name))
            .with_context(|| file.display().to_string())?;
    }
    Ok(())
}

/// The vehicles with golden bits, and their hashes.
pub fn golden() -> Result<Vec<(String, String)>> {
    let text = fs::read_to_string(root().join(GOLDEN)).context(GOLDEN)?;
    let table: toml::Table = toml::from_str(&text).context(GOLDEN)?;
    let hash = |section: &toml::Value| Some(section.get("hash")?.as_str()?.to_owned());
    Ok(table.iter().filter_map(|(name, section)| Some((name.clone(), hash(section)?))).collect())
}
