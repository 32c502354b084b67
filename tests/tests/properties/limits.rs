//! A limit holds at any step, in `f32` and in its f64 twin, without exception.

use plant_core::Real;
use plant_core::battery::{BatteryParams, VoltageLimits};
use plant_core::converter::ConverterParams;
use plant_core::powertrain::{DriveParams, PowertrainParams};
use proptest::prelude::*;

use crate::check::{cases, log, positive, signed};
use crate::draw::{self, Draw, PLAUSIBLE, drawn};
use crate::ledger::twin;

/// Steps under one command: long enough to see a duty that flips from step to step.
const STEPS: u32 = 300;
/// How closely a limit is held, in shares of it, of what the winding carries, and of the power that
/// its field would give up within one step.
const HELD_REL: f64 = 1e-3;
const WINDING_REL: f64 = 1e-5;
const FIELD_REL: f64 = 2e-7;
/// From this share of the largest duty on a change of direction counts as a flip.
const FLIP: f64 = 2e-3;
/// Turns for which there is a reason: the current comes to a limit, and leaves it. There are three:
/// the winding's, that of the battery's current, and that of its voltage.
const FLIPS: u32 = 6;
/// Turns one right after the other; a duty that flips between two limits does not stop.
const IN_A_ROW: u32 = 2;

/// Now and then voltages that may act, around the one at rest.
fn voltage_limits(d: &mut Draw, battery: &BatteryParams, soc: Real) -> VoltageLimits {
    let (below, above) = (0.1 + d.ratio(), 0.1 + d.ratio());
    if !d.seldom() {
        return VoltageLimits::NONE;
    }
    let rest_v = battery.open_circuit.at(soc);
    let width_v = 0.2 * (battery.open_circuit.at(1.0) - battery.open_circuit.at(0.0));
    VoltageLimits {
        lowest_v: (rest_v - below * width_v).max(0.0),
        highest_v: rest_v + above * width_v,
    }
}

/// A plant with tight limits now and then, and near-empty or near-full now and then.
fn case(d: &mut Draw) -> (PowertrainParams, Real) {
    let plant = draw::plant(d);
    let tight = if d.seldom() { 0.05 } else { 1.0 };
    let current_limit_a = if d.seldom() { d.near(300.0) } else { 1e9 };
    let converter = ConverterParams { duty_limit: 1.0, current_limit_a, ..plant.drives.converter };
    let soc = d.ratio();
    let margin = d.near(1e-6).min(0.5);
    let soc = if d.seldom() { if soc > 0.5 { 1.0 - margin } else { margin } } else { soc };
    let battery = BatteryParams {
        discharge_limit_a: tight * plant.battery.discharge_limit_a,
        charge_limit_a: tight * plant.battery.charge_limit_a,
        voltage_limits: voltage_limits(d, &plant.battery, soc),
        ..plant.battery
    };
    let drives = DriveParams { converter, ..plant.drives };
    (PowertrainParams { battery, drives, ..plant }, soc)
}

/// One command, held.
#[derive(Clone, Copy, Debug)]
struct Command {
    dt_s: Real,
    speed_m_s: Real,
    duty: Real,
    sin: Real,
    brake_n: Real,
    auxiliary_w: Real,
    discharge_a: Real,
    charge_a: Real,
}

fn commands() -> impl Strategy<Value = Command> {
    let limit = || prop_oneof![Just(1e9), log(1.0, 300.0)];
    (
        (log(1e-6, 0.02), signed(50.0), -1.0..1.0_f32, signed(0.2)),
        (positive(5000.0), positive(2000.0), limit(), limit()),
    )
        .prop_map(
            |((dt_s, speed_m_s, duty, sin), (brake_n, auxiliary_w, discharge_a, charge_a))| {
                Command { dt_s, speed_m_s, duty, sin, brake_n, auxiliary_w, discharge_a, charge_a }
            },
        )
}

/// Steps through a command. In every step the battery's current keeps its limits, own and asked
/// for; what is beyond is reported, and only where the winding carried as much before or no duty
/// holds it. The duty does not flip.
macro_rules! keeps_limits {
    ($core:ident, $real:ty, $params:expr, $soc:expr, $command:expr) => {{
        use $core::battery::CurrentLimits;
        use $core::mechanics::{body::Road, slope::Grade};
        use $core::powertrain::{Powertrain, PowertrainInput};
        let (c, of) = ($command, |x: Real| <$real>::from(x));
        let plant =
            Powertrain::new($params, $core::Dt::from_s(of(c.dt_s)).unwrap()).unwrap().with_ledger();
        let mut s = plant.at_speed(of($soc), of(c.speed_m_s)).unwrap();
        let start = s;
        let grade = Grade::from_sin(of(c.sin));
        let asked = CurrentLimits { discharge_a: of(c.discharge_a), charge_a: of(c.charge_a) };
        let input = PowertrainInput {
            road: Road { grade, brake_n: of(c.brake_n), ..Road::default() },
            auxiliary_w: of(c.auxiliary_w),
            limits: asked,
            ..PowertrainInput::on(of(c.duty))
        };
        let (mut duty, mut rise, mut flips, mut in_a_row) = (0.0, 0.0, 0, 0);
        for n in 0..STEPS {
            let before = s;
            let limits = plant.battery().faded(&before.battery).within(asked);
            let out = plant.step(&mut s, input);
            prop_assert!(!out.rejected, "{out:?}");
            let (battery_a, motor_a) = (f64::from(out.battery_a), f64::from(out.drives.motor_a));
            let carried_a = f64::from(before.drives.get());
            // In single precision the power of the winding's field is known to some of its last
            // bits; near the battery's greatest power a current follows badly from a power.
            let most_a = motor_a.abs().max(carried_a.abs());
            let field_w =
                f64::from($params.drives.motor.inductance_h / of(c.dt_s)) * most_a * most_a;
            let per_a_v = f64::from(2.0 * out.battery_v - out.open_circuit_v).abs().max(0.1);
            let rounding_a = 2e-3
                + HELD_REL * battery_a.abs()
                + WINDING_REL * most_a
                + FIELD_REL * field_w / per_a_v;
            let over_a = (battery_a - f64::from(limits.discharge_a))
                .max(-battery_a - f64::from(limits.charge_a));
            let reported_a = f64::from(out.limit_exceeded_a);
            prop_assert!(over_a <= reported_a + rounding_a, "{n}: {over_a} {out:?} {before:?}");
            let why = carried_a.abs() >= 0.999 * motor_a.abs() || out.drives.duty.abs() == 1.0;
            prop_assert!(reported_a <= rounding_a || why, "{n}: {reported_a} {out:?} {before:?}");
            let step = f64::from(out.drives.duty) - duty;
            let flip = n > 1 && step * rise < 0.0 && step.abs().min(f64::abs(rise)) > FLIP;
            flips += u32::from(flip);
            in_a_row = if flip { in_a_row + 1 } else { 0 };
            prop_assert!(
                in_a_row <= IN_A_ROW && flips <= FLIPS,
                "{n}: {flips} flips, {duty} then {out:?} {before:?}"
            );
            (duty, rise) = (f64::from(out.drives.duty), step);
        }
        let report = plant.energy(&start, &s);
        (f64::from(report.residual).abs(), report.terms().map(|(_, j)| f64::from(j).abs()))
    }};
}

proptest! {
    #![proptest_config(cases(2048))]

    #[test]
    fn hold_at_any_step_in_both_precisions(
        (params, soc) in drawn(PLAUSIBLE, case),
        command in commands(),
    ) {
        let (residual_j, terms_j) = keeps_limits!(plant_core, f32, params, soc, command);
        let kinetic_j = 1e3 * f64::from(command.speed_m_s).powi(2);
        let turnover_j = kinetic_j + terms_j.iter().sum::<f64>();
        prop_assert!(residual_j <= 1e-6 * turnover_j, "{residual_j} of {turnover_j}");
        keeps_limits!(plant_core_f64, f64, twin(&params), soc, command);
    }
}
