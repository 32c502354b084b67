//! The pack of `own_pack`, recorded: the bytes in hexadecimal, for `voltstep rewind`.
//!
//! `cargo run --release -p voltstep-bms --features recorder --example recorded`
#![allow(dead_code, reason = "the pack is driven by another loop here")]

#[path = "own_pack/hardware.rs"]
mod hardware;
#[path = "own_pack/pack.rs"]
mod pack;
#[path = "own_pack/recorded.rs"]
mod recorded;

fn main() -> Result<(), voltstep_bms::ParamError> {
    let mut memory = vec![0; 1 << 16];
    let mut text = String::new();
    let there = recorded::drive(&mut memory, |bytes| {
        text.extend(bytes.iter().map(|byte| format!("{byte:02x}")));
    })?;
    assert!(there, "the memory is too small");
    println!("{text}");
    Ok(())
}
