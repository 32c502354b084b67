//! What the firmware's `circuits` says, on this machine.

use voltstep_trace::circuits::{STEPS, switched};

fn main() {
    println!("{}", switched(STEPS));
}
