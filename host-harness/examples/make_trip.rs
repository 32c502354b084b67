//! Writes the synthetic trip and its true parameters to `data/trips/`.
//!
//! `cargo run --release -p voltstep --example make_trip`

use std::path::Path;

use voltstep::simulate::synthetic::{trip_csv, truth_toml};

fn main() -> std::io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/trips");
    std::fs::create_dir_all(&folder)?;
    std::fs::write(folder.join("synthetic.csv"), trip_csv())?;
    std::fs::write(folder.join("synthetic.truth.toml"), truth_toml())
}
