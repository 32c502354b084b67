//! An own pack with the whole BMS: `own_pack/pack.rs` is what one writes, `own_pack/hardware.rs` stands
//! in for drivers. The same two files run on a Cortex-M4F in `firmware-example`, to the same bits.
//!
//! `cargo run --release -p voltstep-bms --example own_pack`

#[path = "own_pack/hardware.rs"]
mod hardware;
#[path = "own_pack/pack.rs"]
mod pack;
#[path = "own_pack/says.rs"]
mod says;

use voltstep_bms::ParamError;

fn main() -> Result<(), ParamError> {
    let said = says::drive(60_000)?;
    println!("{}", said.line());
    assert!(said.closed && (said.soc - said.truth).abs() < 3.0 * said.soc_sd);
    Ok(())
}
