#![no_std]
#![no_main]
//! The same items on a Cortex-M0+, which has no floating point unit: the first stretch of UDDS.

use cortex_m_rt::entry;
use panic_halt as _;
use plant_core::battery::{BatteryInput, BatteryState, RcBranchInput, RcBranchState};
use plant_core::control::pid::{PidInput, PidState};
use plant_core::machine::dc::{DcMotorInput, DcMotorState};
use plant_core::num::fast::{EXP_RANGE, SQRT_RANGE};
use plant_core::signal::sources::TimeTableState;
use voltstep_trace::{
    BMW_I3_CONSTANT, EPOWERTRAIN, EPOWERTRAIN_LEDGER, Fnv1a, Frame, REFERENCE, STEPS_PER_BLOCK,
};

use voltstep_bench::{call, end, fast, hprintln, items, painted, report};

/// How far along UDDS \[s\].
const SECONDS: u32 = 340;

#[entry]
fn main() -> ! {
    end(run())
}

fn run() -> Option<()> {
    painted!(
        nothing,
        plant_pid_off,
        plant_pid_on,
        plant_torque_off,
        battery,
        rc_branch,
        dc_motor,
        pid,
        num_sqrt,
        fast_sqrt,
        num_exp,
        fast_exp
    );
    let mut clock = TimeTableState::default();
    let mut pid_off = EPOWERTRAIN.start().ok()?;
    let mut pid_on = EPOWERTRAIN_LEDGER.start().ok()?;
    let mut torque_off = BMW_I3_CONSTANT.start().ok()?;
    let mut battery_state = BatteryState::rested(0.9).ok()?;
    let mut rc_state = RcBranchState::default();
    let mut motor_state = DcMotorState::default();
    let mut pid_state = PidState::default();
    let mut hash = Fnv1a::default();
    for _ in 0..SECONDS * STEPS_PER_BLOCK {
        let reference = REFERENCE.step(&mut clock, ());
        call!(nothing, items::bench_nothing, &mut (), &());
        call!(plant_pid_off, items::bench_plant_pid_off, &mut pid_off, &reference);
        for word in Frame::plant(&pid_off).words() {
            hash.word(*word);
        }
        call!(plant_pid_on, items::bench_plant_pid_on, &mut pid_on, &reference);
        call!(plant_torque_off, items::bench_plant_torque_off, &mut torque_off, &reference);
        let seen = torque_off.seen;
        let current_a = seen.duty * seen.motor_a;
        call!(battery, items::bench_battery, &mut battery_state, &BatteryInput { current_a });
        let input = RcBranchInput { discharge_a: current_a };
        call!(rc_branch, items::bench_rc_branch, &mut rc_state, &input);
        let load_nm = 0.135 * seen.motor_a;
        let input = DcMotorInput { voltage_v: seen.duty * seen.battery_v, load_nm };
        call!(dc_motor, items::bench_dc_motor, &mut motor_state, &input);
        let input = PidInput { reference: reference.value, measurement: seen.speed_m_s };
        call!(pid, items::bench_pid, &mut pid_state, &input);
    }
    for n in 0..=fast::COUNTED {
        let x = fast::along(SQRT_RANGE, n, fast::COUNTED);
        call!(num_sqrt, fast::bench_num_sqrt, &mut (), &x);
        call!(fast_sqrt, fast::bench_fast_sqrt, &mut (), &x);
        let x = fast::along(EXP_RANGE, n, fast::COUNTED);
        call!(num_exp, fast::bench_num_exp, &mut (), &x);
        call!(fast_exp, fast::bench_fast_exp, &mut (), &x);
    }
    // Comparable with what the host says of the same steps.
    hprintln!("block {} {:016x}", SECONDS - 1, hash.get());
    report!(
        nothing: (), plant_pid_off: pid_off, plant_pid_on: pid_on, plant_torque_off: torque_off,
        battery: battery_state, rc_branch: rc_state, dc_motor: motor_state, pid: pid_state, num_sqrt: (), fast_sqrt: (), num_exp: (), fast_exp: (),
    );
    Some(())
}
