#![no_std]
#![no_main]
//! The same items on a Cortex-M0+, which has no floating point unit: the first stretch of UDDS.

use cortex_m_rt::entry;
use panic_halt as _;
use plant_core::battery::{BatteryInput, RcBranchInput};
use plant_core::control::pid::PidInput;
use plant_core::machine::dc::DcMotorInput;
use voltstep_trace::{Fnv1a, Frame, REFERENCE, STEPS_PER_BLOCK};

use voltstep_bench::common::Common;
use voltstep_bench::{call, call_functions, end, hprintln, items, painted, report};

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
    let mut common = Common::new()?;
    let mut hash = Fnv1a::default();
    for _ in 0..SECONDS * STEPS_PER_BLOCK {
        let reference = REFERENCE.step(&mut common.clock, ());
        call!(nothing, items::bench_nothing, &mut (), &());
        call!(plant_pid_off, items::bench_plant_pid_off, &mut common.pid_off, &reference);
        for word in Frame::plant(&common.pid_off).words() {
            hash.word(*word);
        }
        call!(plant_pid_on, items::bench_plant_pid_on, &mut common.pid_on, &reference);
        call!(plant_torque_off, items::bench_plant_torque_off, &mut common.torque_off, &reference);
        let seen = common.torque_off.seen;
        let current_a = seen.duty * seen.motor_a;
        call!(battery, items::bench_battery, &mut common.battery, &BatteryInput { current_a });
        let input = RcBranchInput { discharge_a: current_a };
        call!(rc_branch, items::bench_rc_branch, &mut common.rc_branch, &input);
        let load_nm = 0.135 * seen.motor_a;
        let input = DcMotorInput { voltage_v: seen.duty * seen.battery_v, load_nm };
        call!(dc_motor, items::bench_dc_motor, &mut common.dc_motor, &input);
        let input = PidInput { reference: reference.value, measurement: seen.speed_m_s };
        call!(pid, items::bench_pid, &mut common.pid, &input);
    }
    call_functions!(num_sqrt, fast_sqrt, num_exp, fast_exp);
    // Comparable with what the host says of the same steps.
    hprintln!("block {} {:016x}", SECONDS - 1, hash.get());
    report!(
        nothing: (), plant_pid_off: common.pid_off, plant_pid_on: common.pid_on, plant_torque_off: common.torque_off,
        battery: common.battery, rc_branch: common.rc_branch, dc_motor: common.dc_motor, pid: common.pid, num_sqrt: (), fast_sqrt: (), num_exp: (), fast_exp: (),
    );
    Some(())
}
