//! Puts the memory map of the machine that the binaries run on where the linker looks.

use std::path::PathBuf;
use std::{env, fs};

fn main() {
    let map = if env::var_os("CARGO_FEATURE_BOARD").is_some() { "board.x" } else { "memory.x" };
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy(map, out.join("memory.x")).expect("the memory map lies beside build.rs");
    println!("cargo::rustc-link-search={}", out.display());
    println!("cargo::rustc-link-arg-bins=-Tdefmt.x");
    println!("cargo::rerun-if-changed=memory.x");
    println!("cargo::rerun-if-changed=board.x");
}
