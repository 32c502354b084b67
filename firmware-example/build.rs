//! Has the linker find the memory map of the machine that the binaries run on. A `memory.x` beside
//! the workspace's manifest would win over it: the linker looks there first.

fn main() {
    let board = std::env::var_os("CARGO_FEATURE_BOARD").is_some();
    let machine = if board { "nucleo-f411re" } else { "mps2" };
    println!("cargo::rustc-link-search={}/memory/{machine}", env!("CARGO_MANIFEST_DIR"));
    println!("cargo::rerun-if-changed=memory");
    if board {
        println!("cargo::rustc-link-arg-bins=-Tdefmt.x");
    }
}
