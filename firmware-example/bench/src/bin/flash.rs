#![no_std]
#![no_main]
//! An image with one item in it, the one named by `VOLTSTEP_ITEM` at build time, or with none:
//! the difference of two sizes is what the item costs in flash.

use core::hint::black_box;

use cortex_m_rt::entry;
use panic_halt as _;
use voltstep_bench::{circuits, estimators, fast, items, manage, pack, pids};

const ITEM: &str = match option_env!("VOLTSTEP_ITEM") {
    Some(item) => item,
    None => "none",
};

/// Keeps the item of this name.
macro_rules! keep {
    ($module:ident: $($item:ident)+) => {
        $(if const { same(ITEM, stringify!($item)) } {
            black_box($module::$item as *const ());
        })+
    };
}

#[entry]
fn main() -> ! {
    keep!(
        items: bench_nothing bench_plant_pid_off bench_plant_pid_on bench_plant_torque_off
        bench_plant_torque_on bench_plant_mapped_off bench_plant_mapped_on bench_plant_pmsm_off
        bench_plant_axles_off bench_plant_dc_off bench_plant_dcs_off bench_powertrain
        bench_battery bench_mapped_battery bench_rc_branch bench_auxiliary
        bench_converter bench_dc_motor bench_gearbox bench_wheel bench_body
        bench_rotational_load bench_axis bench_slope bench_pid bench_torque_driver
        bench_voltage_sensor bench_current_sensor bench_speed_sensor bench_time_table bench_sine
    );
    keep!(pids: bench_pi bench_pi_ram bench_pi_pid bench_pi_idsp bench_pi_idsp_ram);
    keep!(circuits: bench_h_bridge bench_three_phase);
    keep!(fast: bench_num_sqrt bench_fast_sqrt bench_num_exp bench_fast_exp);
    keep!(
        estimators: bench_ekf_update bench_ekf_refresh bench_counter_step bench_counter_review
        bench_cells bench_kalman
    );
    keep!(
        pack: bench_resistance bench_capacity bench_energy_step bench_energy_report bench_energy_walk
        bench_power_ahead bench_power_walk bench_power_cells bench_power_cells_walk
        bench_cell_resistances bench_series
    );
    keep!(
        manage: bench_bms bench_bms_fast bench_bms_filter bench_bms_slow bench_bms_fast_96
        bench_bms_filter_96 bench_bms_slow_96
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
