#![no_std]
#![no_main]
//! An image with one item in it, the one named by `VOLTSTEP_ITEM` at build time, or with none:
//! the difference of two sizes is what the item costs in flash.

#[path = "../items.rs"]
#[allow(dead_code, reason = "one of them is used")]
mod items;

use core::hint::black_box;

use cortex_m_rt::entry;
use panic_halt as _;

const ITEM: &str = match option_env!("VOLTSTEP_ITEM") {
    Some(item) => item,
    None => "none",
};

/// Keeps the item of this name.
macro_rules! keep {
    ($($item:ident)+) => {
        $(if const { same(ITEM, stringify!($item)) } {
            black_box(items::$item as *const ());
        })+
    };
}

#[entry]
fn main() -> ! {
    keep!(
        bench_nothing bench_plant_pid_off bench_plant_pid_on bench_plant_torque_off
        bench_plant_torque_on bench_powertrain bench_battery bench_rc_branch bench_auxiliary
        bench_converter bench_dc_motor bench_gearbox bench_wheel bench_body
        bench_rotational_load bench_axis bench_slope bench_pid bench_torque_driver
        bench_voltage_sensor bench_current_sensor bench_speed_sensor bench_time_table bench_sine
    );
    loop {
        cortex_m::asm::nop();
    }
}

const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut same = a.len() == b.len();
    let mut i = 0;
    while same && i < a.len() {
        same = a[i] == b[i];
        i += 1;
    }
    same
}
