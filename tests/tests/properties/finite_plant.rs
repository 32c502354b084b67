//! No input and no parameter makes the plant, its drivers or a source infinite.

use plant_core::control::driver::{Driver, DriverInput, DriverOutput, DriverParams, DriverState};
use plant_core::mechanics::body::Road;
use plant_core::mechanics::slope::Grade;
use plant_core::num::LARGEST_PARAM;
use plant_core::powertrain::Feedback;
use plant_core::powertrain::{Powertrain, PowertrainInput, PowertrainParams};
use plant_core::signal::sources::{
    AtEnd, Ramp, RampParams, Saturation, SaturationParams, Sine, SineParams, Square, SquareParams,
    Step, StepParams, TimeTable, TimeTableParams, UnitDelay, UnitDelayParams, UnitDelayState,
};
use plant_core::{Dt, Real};
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

use crate::check::{Tally, cases, check, inputs, keeps, positive, signed};
use crate::draw::{self, Draw, PERMITTED, Spread, within};
use crate::finite::some;

/// Where the plant stays finite. Beyond, a coefficient seen through gears and wheels or a power
/// under absurd wind is too large for `f32`.
const PLANT: Spread = within(1e3);

#[test]
fn powertrain_with_its_ledger() {
    let model = some(PLANT, |d| (draw::plant(d), d.dt(), d.ratio(), d.signed(10.0)));
    let road = [signed(0.2), signed(1e-3), signed(20.0), positive(5000.0)];
    let [sin, cos, wind, brake] = road;
    let inputs = inputs([signed(1.0), sin, cos, wind, brake, positive(2000.0)]);
    check(512, (model, inputs), |((params, dt, soc, speed), inputs)| {
        let model = Powertrain::new(params, dt).unwrap().with_ledger();
        let start = model.at_speed(soc, speed).unwrap();
        keeps(start, &inputs, |s, [duty, sin, cos, headwind_m_s, brake_n, auxiliary_w]| {
            let cos = cos + Grade::from_sin(sin).cos;
            let road = Road { grade: Grade { sin, cos }, headwind_m_s, brake_n, ..Road::default() };
            let out =
                model.step(s, PowertrainInput { road, auxiliary_w, ..PowertrainInput::on(duty) });
            ((out, model.energy(&start, s)), out.rejected)
        })
    });
}

/// Steps a driver through what it hears; where it rejects, its command holds.
fn drives(
    params: DriverParams,
    vehicle: &PowertrainParams,
    dt: Dt,
    inputs: &[[Real; 7]],
) -> Result<Tally, TestCaseError> {
    let model = Driver::new(params, vehicle, dt).unwrap();
    let mut held = DriverOutput { duty: 0.0, brake_n: 0.0, rejected: false };
    keeps(DriverState::default(), inputs, |s, fields| {
        let [reference_m_s, reference_m_s2, speed_m_s, motor_a, battery_v, soc, duty] = fields;
        let limited = battery_v.to_bits() & 1 == 1;
        let vehicle = Feedback {
            speed_m_s,
            motor_a,
            motor_nm: 0.3 * motor_a,
            battery_v,
            soc,
            duty,
            limited,
            slope_sin: 0.0,
        };
        let out = model.step(s, DriverInput { reference_m_s, reference_m_s2, vehicle });
        let moved = out.rejected && out != DriverOutput { rejected: true, ..held };
        held = out;
        ((out, if moved { Real::NAN } else { 0.0 }), out.rejected)
    })
}

fn what_drivers_hear() -> impl Strategy<Value = Vec<[Real; 7]>> {
    let vehicle = [signed(30.0), signed(300.0), positive(400.0), positive(1.0), signed(1.0)];
    let [speed, current, voltage, soc, duty] = vehicle;
    inputs([signed(30.0), signed(3.0), speed, current, voltage, soc, duty])
}

/// It does not look at all that it hears.
#[test]
fn driver_from_speed_to_duty() {
    let model = some(PERMITTED, |d| (DriverParams::Duty(draw::pid(d)), draw::plant(d), d.dt()));
    let inputs = what_drivers_hear().prop_map(|mut inputs| {
        for [_, acceleration, _, current, voltage, soc, _] in &mut inputs {
            (*acceleration, *current, *voltage, *soc) = (0.0, 1.0, 350.0, 0.5);
        }
        inputs
    });
    check(512, (model, inputs), |((params, vehicle, dt), inputs)| {
        drives(params, &vehicle, dt, &inputs)
    });
}

#[test]
fn driver_from_speed_to_torque_to_duty() {
    let model =
        some(PERMITTED, |d| (DriverParams::Torque(draw::torque_driver(d)), draw::plant(d), d.dt()));
    let inputs = what_drivers_hear().prop_map(|mut inputs| {
        for [.., duty] in &mut inputs {
            *duty = 1.0;
        }
        inputs
    });
    check(512, (model, inputs), |((params, vehicle, dt), inputs)| {
        drives(params, &vehicle, dt, &inputs)
    });
}

#[test]
fn delay_and_saturation() {
    let model = some(PERMITTED, |d| {
        let (initial, low) = (d.signed(1.0), d.signed(1.0).min(1e11));
        let high = (low + low.abs() + d.near(1.0)).clamp(low.next_up(), LARGEST_PARAM);
        (UnitDelayParams { initial }, SaturationParams { low, high })
    });
    check(512, (model, inputs([signed(10.0)])), |((delay, saturation), inputs)| {
        let delay = UnitDelay::new(delay).unwrap();
        let saturation = Saturation::new(saturation).unwrap();
        keeps(UnitDelayState::default(), &inputs, |s, [x]| {
            let (now, late) = (saturation.step(&mut (), x), delay.step(s, x));
            ((now, late), now.rejected && late.rejected)
        })
    });
}

fn edges(d: &mut Draw) -> (StepParams, RampParams) {
    let step =
        StepParams { before: d.signed(1.0), after: d.signed(1.0), at_s: d.near_or(1.0, 0.0) };
    let (start, slope_per_s) = (d.signed(1.0), d.signed(1.0));
    let from_s = d.near_or(1.0, 0.0).min(1e11);
    let to_s = (from_s + d.near(1.0)).clamp(from_s.next_up(), LARGEST_PARAM);
    (step, RampParams { start, slope_per_s, from_s, to_s })
}

fn waves(d: &mut Draw) -> (SineParams, SquareParams) {
    let sine = SineParams {
        amplitude: d.signed(1.0),
        offset: d.signed(1.0),
        frequency_hz: d.near(50.0),
        phase_turns: d.ratio(),
    };
    let square = SquareParams {
        low: d.signed(1.0),
        high: d.signed(1.0),
        period_s: d.near(0.02),
        on_ratio: d.ratio(),
        phase_turns: d.ratio(),
    };
    (sine, square)
}

/// Points of a table, and a step that fits it.
fn points(d: &mut Draw) -> (Vec<(Real, Real)>, AtEnd, Dt) {
    let mut points = vec![(d.signed(1.0).min(1e10), d.signed(1.0))];
    for _ in 0..5 {
        let (time_s, _) = points[points.len() - 1];
        let next_s = (time_s + d.near(1.0).min(1e10)).max(time_s.next_up()).max(time_s + 2e-12);
        points.push((next_s, d.signed(1.0)));
    }
    let length_s = points[5].0 - points[0].0;
    if d.seldom() {
        return (points, AtEnd::Hold, d.dt());
    }
    let dt_s = d.dt().s().min(0.9 * length_s);
    (points, AtEnd::Repeat, Dt::from_s(dt_s).expect("a step is long enough"))
}

/// Twenty steps of a source.
macro_rules! source_keeps {
    ($source:expr) => {{
        let source = $source.unwrap();
        keeps(Default::default(), &[[]; 20], |s, []| (source.step(s, ()), false))?;
    }};
}

proptest! {
    #![proptest_config(cases(512))]

    #[test]
    fn sources(
        (step, ramp) in some(PERMITTED, edges),
        (sine, square) in some(PERMITTED, waves),
        (points, at_end, table_dt) in some(PERMITTED, points),
        dt in some(PERMITTED, Draw::dt),
    ) {
        source_keeps!(Step::new(step, dt));
        source_keeps!(Ramp::new(ramp, dt));
        source_keeps!(Sine::new(sine, dt));
        source_keeps!(Square::new(square, dt));
        let table = TimeTableParams { points: &points, at_end };
        source_keeps!(TimeTable::new(table, table_dt));
    }
}
