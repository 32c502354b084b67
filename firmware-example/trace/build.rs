//! Makes the driving cycle a constant table.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs};

/// The cycle, as CSV: `time_s,speed_m_s`.
const CYCLE: &str = "../../data/cycles/udds.csv";

fn main() {
    println!("cargo::rerun-if-changed={CYCLE}");
    let csv = fs::read_to_string(CYCLE).expect("the cycle lies in data/cycles");
    let mut table = String::from("&[\n");
    for line in csv.lines().skip(1) {
        let mut fields = line.split(',').map(|field| {
            field.trim().parse::<f32>().unwrap_or_else(|e| panic!("{CYCLE}: {line}: {e}"))
        });
        let (Some(time_s), Some(speed_m_s)) = (fields.next(), fields.next()) else {
            panic!("{CYCLE}: `{line}` has no two fields");
        };
        // Rust prints the shortest text that reads back as the same bits.
        writeln!(table, "    ({time_s:?}, {speed_m_s:?}),").expect("a String takes any text");
    }
    table.push_str("]\n");
    let out = env::var_os("OUT_DIR").expect("cargo sets OUT_DIR");
    fs::write(Path::new(&out).join("udds.rs"), table).expect("OUT_DIR can be written");
}
