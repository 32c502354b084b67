//! Has the linker find the memory map.

fn main() {
    println!("cargo::rustc-link-search={}/../memory/mps2", env!("CARGO_MANIFEST_DIR"));
    println!("cargo::rerun-if-changed=../memory/mps2");
}
