//! Tests of the whole workspace. The crate itself knows where real measurements are, and its program
//! `generate` writes the files that are made from others (`cargo xtask presets`, `cargo xtask trip`);
//! the tests are in `tests/`:
//!
//! | Test | What it holds |
//! |---|---|
//! | `bms_pack` | coulomb counter, cells and record: honest, finite, never a wrong record |
//! | `bms_power` | the state of power's currents and powers, tried on the plant |
//! | `bms_soh` | the state of health of a faded cell after ten days of driving and charging |
//! | `bms_trips` | nothing trips on the measured current of trips; real ones where `VOLTSTEP_DATA` names them |
//! | `coverage` | every public model has a case in `voltstep validate` |
//! | `pmsm` | the synchronous machine against its equations, saturation included, and on a measured map |
//! | `order` | order of convergence, stability and steady state at any step |
//! | `properties` | what is true of the models for any input and any parameters (proptest) |
//! | `reference_system` | the published reference system: UDDS in closed loop, the DC motor's step |
//! | `rounding` | single precision against double, after ten hours of driving |
//! | `soc` | the estimators of the state of charge on real measurements, where `VOLTSTEP_DATA` names them |
//! | `trips` | trips against their measurements; real ones where `VOLTSTEP_DATA` names them |

use std::ffi::OsStr;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The CSV files in a folder of real measurements; none where there are none, which is said aloud.
/// They are not part of the project: `VOLTSTEP_DATA` names the folder that has them.
///
/// # Panics
/// Where `VOLTSTEP_DATA` names a folder without them.
#[must_use]
pub fn real_files(folder: &str) -> Vec<PathBuf> {
    let Some(data) = std::env::var_os("VOLTSTEP_DATA").filter(|value| !value.is_empty()) else {
        // Not by a macro: the test runner keeps to itself what a test that passes prints.
        let _ = writeln!(
            std::io::stderr(),
            "SKIPPED tests on real measurements: set VOLTSTEP_DATA to the folder that has them"
        );
        return Vec::new();
    };
    let folder = Path::new(&data).join(folder);
    let entries = std::fs::read_dir(&folder)
        .unwrap_or_else(|e| panic!("VOLTSTEP_DATA has no {}: {e}", folder.display()));
    let paths = entries.map(|entry| entry.expect("an entry of the folder").path());
    let mut files: Vec<_> =
        paths.filter(|path| path.extension() == Some(OsStr::new("csv"))).collect();
    files.sort_unstable();
    assert!(!files.is_empty(), "no .csv file in {}", folder.display());
    files
}

/// The examples of the documents, kept compiling.
#[cfg(doctest)]
mod documents {
    #[doc = include_str!("../../README.md")]
    struct Readme;
    #[doc = include_str!("../../docs/src/start.md")]
    struct Start;
    #[doc = include_str!("../../docs/src/models/circuit.md")]
    struct Circuit;
}
