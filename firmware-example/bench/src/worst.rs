//! What UDDS does not come to: battery limits in both directions, an empty battery that cannot even feed the
//! auxiliary loads, a full one, standstill, plug braking, refused inputs. Each plant goes through
//! all of it on its painted stack, so that the stack reported is that of the worst path.
//!
//! Steps in which a limit acts are counted, as items of their own; the others are not.

use plant_core::Accum;
use plant_core::battery::{BatteryState, MappedBatteryState, Pack};
use plant_core::control::driver::Steering;
use plant_core::machine::pmsm::DqCurrents;
use plant_core::powertrain::ledger::{Book, EnergyLedger, NoLedger};
use plant_core::powertrain::{Drives, Limited};
use plant_core::signal::sources::TimeTableOutput;
use voltstep_trace::{
    BMW_I3, BMW_I3_CONSTANT, BMW_I3_CONSTANT_LEDGER, BMW_I3_LEDGER, BMW_I3_PMSM, EPOWERTRAIN,
    EPOWERTRAIN_LEDGER, Rig, RigState, TWO_AXLED,
};

use voltstep_bench::items::{
    ONE_DC, TWO_DC, bench_plant_axles_off, bench_plant_dc_off, bench_plant_dcs_off,
    bench_plant_mapped_off, bench_plant_mapped_on, bench_plant_pid_off, bench_plant_pid_on,
    bench_plant_pmsm_off, bench_plant_torque_off, bench_plant_torque_on,
};
use voltstep_bench::stack::Stack;
use voltstep_bench::{call, call_uncounted, hprintln};

/// An item that drives a [`Rig`].
type Item<L, S, E> = extern "C" fn(&mut RigState<L, S, E>, &TimeTableOutput, &mut ());

/// Where a stretch starts: state of charge and speed \[m/s\], a reference \[m/s\] that takes turns.
const STRETCHES: &[(f32, f32, [f32; 2])] = &[
    (0.80, 0.0, [60.0, 60.0]),      // the discharge limit
    (0.80, 60.0, [0.0, 0.0]),       // the charge limit
    (0.02, 60.0, [0.0, 0.0]),       // the same at a lower voltage, where less power reaches it
    (0.80, 60.0, [-60.0, -60.0]),   // plug braking
    (0.80, -60.0, [60.0, 60.0]),    // the same backwards
    (0.0, 0.0, [1.0, 1.0]),         // empty, and from there on
    (1e-7, 20.0, [30.0, 30.0]),     // nearly
    (1.0, 30.0, [0.0, 0.0]),        // full
    (0.80, 1.0, [0.0, 0.0]),        // standstill
    (0.80, 0.0, [0.1, -0.1]),       // to and fro
    (0.80, 10.0, [f32::NAN, 1e38]), // refused
];
const STEPS_PER_STRETCH: usize = 3000;

/// What a run came to.
#[derive(Clone, Copy, Default)]
#[allow(clippy::struct_excessive_bools, reason = "a list of what happened")]
pub struct Came {
    pub discharge: bool,
    pub charge: bool,
    pub starved: bool,
    pub refused: bool,
    pub standstill: bool,
}

impl Came {
    /// In a line, for xtask to demand.
    pub fn say(self, item: &str) {
        let Self { discharge, charge, starved, refused, standstill } = self;
        hprintln!(
            "came {} discharge={} charge={} starved={} refused={} standstill={}",
            item,
            discharge,
            charge,
            starved,
            refused,
            standstill
        );
    }
}

/// Sends one plant through all stretches. `limited` is another name of `item`.
fn run<L: Book, B: Pack, D: Drives, C: Steering<D>>(
    rig: &Rig<L, B, D, C>,
    stack: &mut Stack,
    item: Item<L, B::State, D::State>,
    mut limited: impl FnMut(&mut Stack, &mut RigState<L, B::State, D::State>, &TimeTableOutput),
) -> Option<Came> {
    let mut came = Came::default();
    for (soc, speed_m_s, references) in STRETCHES {
        let mut state = rig.start().ok()?;
        state.plant = rig.plant.at_speed(*soc, *speed_m_s).ok()?;
        state.seen = rig.plant.feedback(&state.plant);
        for n in 0..STEPS_PER_STRETCH {
            let value = references[n / 100 % 2];
            let reference = TimeTableOutput { value, rate_per_s: 0.0, ended: false };
            if look(rig, state, &reference, &mut came) {
                limited(stack, &mut state, &reference);
            } else {
                call_uncounted!(stack, item, &mut state, &reference);
            }
        }
    }
    Some(came)
}

/// Makes a step on a copy, to see what it comes to; whether a limit acts.
#[inline(never)]
fn look<L: Book, B: Pack, D: Drives, C: Steering<D>>(
    rig: &Rig<L, B, D, C>,
    mut state: RigState<L, B::State, D::State>,
    reference: &TimeTableOutput,
    came: &mut Came,
) -> bool {
    let (input, refused) = rig.steer(&mut state, *reference);
    let out = rig.plant.step(&mut state.plant, input);
    came.discharge |= out.limited == Limited::Discharge;
    came.charge |= out.limited == Limited::Charge;
    came.starved |= out.auxiliary_starved;
    came.refused |= out.rejected || refused;
    came.standstill |= out.speed_m_s == 0.0;
    out.limited != Limited::No
}

/// Names a plant's item once more, for the plugin: in steps in which a limit acts it is called by
/// this name, which is one branch more. Then sends the plant through all stretches.
macro_rules! worst {
    ($($run:ident: $item:ident, $other:ident, $ledger:ty, $battery:ty, $drives:ty, $rig:path;)+) => {$(
        core::arch::global_asm!(
            concat!(".global ", stringify!($other)),
            concat!(".type ", stringify!($other), ", %function"),
            concat!(stringify!($other), ": b {item}"),
            item = sym $item,
        );

        #[doc = concat!("See [`run`]: ", stringify!($item), ".")]
        pub fn $run(stack: &mut Stack) -> Option<Came> {
            #[allow(improper_ctypes, reason = "the types are those of the item")]
            unsafe extern "C" {
                safe fn $other(
                    state: &mut RigState<$ledger, $battery, $drives>,
                    input: &TimeTableOutput,
                    out: &mut (),
                );
            }
            run(&$rig, stack, $item, |stack, state, reference| {
                call!(stack, $other, state, reference);
            })
        }
    )+};
}

worst! {
    plant_pid_off: bench_plant_pid_off, bench_limited_pid_off,
        NoLedger, BatteryState, Accum, EPOWERTRAIN;
    plant_pid_on: bench_plant_pid_on, bench_limited_pid_on,
        EnergyLedger, BatteryState, Accum, EPOWERTRAIN_LEDGER;
    plant_torque_off: bench_plant_torque_off, bench_limited_torque_off,
        NoLedger, BatteryState, Accum, BMW_I3_CONSTANT;
    plant_torque_on: bench_plant_torque_on, bench_limited_torque_on,
        EnergyLedger, BatteryState, Accum, BMW_I3_CONSTANT_LEDGER;
    plant_mapped_off: bench_plant_mapped_off, bench_limited_mapped_off,
        NoLedger, MappedBatteryState, Accum, BMW_I3;
    plant_mapped_on: bench_plant_mapped_on, bench_limited_mapped_on,
        EnergyLedger, MappedBatteryState, Accum, BMW_I3_LEDGER;
    plant_pmsm_off: bench_plant_pmsm_off, bench_limited_pmsm_off,
        NoLedger, BatteryState, DqCurrents, BMW_I3_PMSM;
    plant_axles_off: bench_plant_axles_off, bench_limited_axles_off,
        NoLedger, BatteryState, (DqCurrents, Accum), TWO_AXLED;
    plant_dc_off: bench_plant_dc_off, bench_limited_dc_off,
        NoLedger, BatteryState, Accum, ONE_DC;
    plant_dcs_off: bench_plant_dcs_off, bench_limited_dcs_off,
        NoLedger, BatteryState, (Accum, Accum), TWO_DC;
}

/// Uses 256 bytes of stack and more: the report has to show them.
#[inline(never)]
pub extern "C" fn deep(_: &mut (), _: &(), _: &mut ()) {
    core::hint::black_box([0_u32; 64]);
}
