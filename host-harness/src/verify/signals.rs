//! Sources and sensors against what they are defined as.

use plant_core::signal::faults::{
    Delay, Drift, DriftParams, DriftState, Lapse, LapseKind, LapseParams, Noise, NoiseParams,
};
use plant_core::signal::sensors::{
    AxialSpeedSensor, AxialSpeedSensorInput, AxialSpeedSensorParams, AxialSpeedSensorState,
    CurrentSensor, CurrentSensorInput, SensorParams, VoltageSensor, VoltageSensorInput,
};
use plant_core::signal::sources::{
    AtEnd, ElapsedState, PhaseState, Ramp, RampParams, Saturation, SaturationParams, Sine,
    SineParams, Square, SquareParams, Step, StepParams, TimeTable, TimeTableParams, TimeTableState,
    UnitDelay, UnitDelayParams, UnitDelayState,
};
use plant_core::{Dt, must};

use super::tolerance as t;
use super::{Case, Checks};
use crate::read::cycle;

const DT: Dt = must!(Dt::from_s(1e-3));

pub(super) const CASES: [Case; 4] = [
    Case { name: "sine and square", models: &["Sine", "Square"], run: waves },
    Case {
        name: "step, ramp, table, delay, saturation",
        models: &["Step", "Ramp", "TimeTable", "UnitDelay", "Saturation"],
        run: edges,
    },
    Case {
        name: "sensors",
        models: &["VoltageSensor", "CurrentSensor", "AxialSpeedSensor"],
        run: sensors,
    },
    Case { name: "sensor faults", models: &["Noise", "Drift", "Delay", "Lapse"], run: faults },
];

/// The largest difference over `steps` instants, each a whole number of the step in f32.
fn worst(steps: u32, mut ours: impl FnMut() -> f32, exact: impl Fn(f64) -> f64) -> f64 {
    let mut worst = 0.0_f64;
    for number in 0..steps {
        let off = (f64::from(ours()) - exact(f64::from(number) * f64::from(DT.s()))).abs();
        worst = if off.is_nan() { f64::NAN } else { worst.max(off) };
    }
    worst
}

fn waves(checks: &mut Checks) -> anyhow::Result<()> {
    let params = SineParams { amplitude: 2.0, offset: 1.0, frequency_hz: 3.0, phase_turns: 0.25 };
    let (sine, mut state) = (Sine::new(params, DT)?, PhaseState::default());
    let off = worst(
        10_000,
        || sine.step(&mut state, ()),
        |time| 1.0 + 2.0 * (std::f64::consts::TAU * (3.0 * time + 0.25)).sin(),
    );
    checks.add(&t::SINE, off);

    let params =
        SquareParams { low: -1.0, high: 4.0, period_s: 0.02, on_ratio: 0.3, phase_turns: 0.0 };
    let (square, mut state) = (Square::new(params, DT)?, PhaseState::default());
    let off = worst(
        100_000,
        || square.step(&mut state, ()),
        |time| if ((time + 1e-4) % 0.02) < 0.006 { 4.0 } else { -1.0 },
    );
    checks.add(&t::EXACT, off);
    Ok(())
}

fn edges(checks: &mut Checks) -> anyhow::Result<()> {
    let params = StepParams { before: 60.0, after: 248.0, at_s: 0.3 };
    let (step, mut state) = (Step::new(params, DT)?, ElapsedState::default());
    let edge = |time: f64| if time > 0.2995 { 248.0 } else { 60.0 };
    checks.add(&t::EXACT, worst(1000, || step.step(&mut state, ()), edge));

    let params = RampParams { start: -1.0, slope_per_s: 2.0, from_s: 0.25, to_s: 2.0 };
    let (ramp, mut state) = (Ramp::new(params, DT)?, ElapsedState::default());
    let line = |time: f64| -1.0 + 2.0 * (time - 0.25).clamp(0.0, 1.75);
    checks.add(&t::RAMP, worst(3000, || ramp.step(&mut state, ()), line));

    let points = cycle::by_name("udds").map(|c| c.points).unwrap_or_default();
    let table = TimeTable::new(TimeTableParams { points: &points, at_end: AtEnd::Hold }, DT)?;
    let mut state = TimeTableState::default();
    let cycle = |time: f64| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "≥ 0")]
        let at = (time as usize).min(points.len() - 2);
        let [(t0, v0), (t1, v1)] =
            [points[at], points[at + 1]].map(|(t, v)| (f64::from(t), f64::from(v)));
        v0 + (v1 - v0) / (t1 - t0) * (time - t0)
    };
    checks.add(&t::TABLE, worst(1_369_000, || table.step(&mut state, ()).value, cycle));

    let delay = UnitDelay::new(UnitDelayParams { initial: 7.0 })?;
    let saturation = Saturation::new(SaturationParams { low: -0.5, high: 1.0 })?;
    let (mut state, mut before) = (UnitDelayState::default(), 7.0);
    let (mut late, mut held) = (0.0_f64, 0.0_f64);
    for x in [0.3, -2.0, 5.0, 1.0, -0.5] {
        let (delayed, limited) = (delay.step(&mut state, x), saturation.step(&mut (), x));
        late = late.max(f64::from((delayed.value - before).abs()));
        held = held.max(f64::from((limited.value - x.clamp(-0.5, 1.0)).abs()));
        before = x;
    }
    checks.add(&t::EXACT, late);
    checks.add(&t::EXACT, held);
    Ok(())
}

/// What faults do to a value of 10 over 100 000 samples: the figures of their distributions.
fn faults(checks: &mut Checks) -> anyhow::Result<()> {
    const SAMPLES: u32 = 100_000;
    let noise = Noise::new(NoiseParams { sd: 0.5, seed: 1 })?;
    let drift = Drift::new(DriftParams { per_s: 1e-3, largest: 1.0 }, DT)?;
    let missing = LapseParams {
        kind: LapseKind::Missing,
        from_s: 10.0,
        chance: 0.02,
        length_s: 5e-3,
        seed: 2,
    };
    let (gaps, late) = (Lapse::new(missing, DT)?, Delay::<5>::new()?);
    let (mut n, mut d) = (noise.start(), DriftState::default());
    let (mut g, mut l) = (gaps.start(), late.start(0.0)?);
    let (mut sum, mut squares, mut lost, mut off) = (0.0, 0.0, 0_u32, 0.0_f64);
    let (mut drifted, mut sent) = (0.0, Vec::new());
    for _ in 0..SAMPLES {
        let noisy = noise.step(&mut n, 10.0).value;
        let deviation = f64::from(noisy) - 10.0;
        (sum, squares) = (sum + deviation, squares + deviation * deviation);
        drifted = f64::from(drift.step(&mut d, 10.0).value);
        lost += u32::from(gaps.step(&mut g, noisy).missing);
        sent.push(noisy);
        let read = late.step(&mut l, noisy).value;
        let then = sent.len().checked_sub(6).map_or(0.0, |k| sent[k]);
        off = off.max(f64::from(read - then).abs());
    }
    let count = f64::from(SAMPLES);
    checks.against(&t::NOISE_MEAN, 0.0, sum / count);
    checks.against(&t::NOISE_SD, 0.5, (squares / count).sqrt());
    checks.against(&t::DRIFT, 10.0 + 0.1, drifted);
    checks.against(&t::MISSING, 5.0 / 54.0, f64::from(lost) / (count - 10_000.0));
    checks.add(&t::EXACT, off);
    Ok(())
}

fn sensors(checks: &mut Checks) -> anyhow::Result<()> {
    let params = SensorParams { gain: 1.02, offset: -0.3, quantum: 0.25 };
    let expected = |x: f64| ((1.02 * x - 0.3) / 0.25).round() * 0.25;
    let (volts, amps) = (VoltageSensor::new(params)?, CurrentSensor::new(params)?);
    let (mut off_v, mut off_a) = (0.0_f64, 0.0_f64);
    for x in [-401.0_f32, -0.1, 0.0, 3.3, 382.4] {
        let v = volts.step(&mut (), VoltageSensorInput { voltage_v: x }).voltage_v;
        let a = amps.step(&mut (), CurrentSensorInput { current_a: x }).current_a;
        off_v = off_v.max((f64::from(v) - expected(f64::from(x))).abs());
        off_a = off_a.max((f64::from(a) - expected(f64::from(x))).abs());
    }
    checks.add(&t::EXACT, off_v);
    checks.add(&t::EXACT, off_a);

    let params = AxialSpeedSensorParams { speed: SensorParams::IDEAL, pole_pairs: 4 };
    let sensor = AxialSpeedSensor::new(params, DT)?;
    let mut state = AxialSpeedSensorState::default();
    let mut out = sensor.step(&mut state, AxialSpeedSensorInput { speed_rad_s: 12.5 });
    for _ in 1..10_000 {
        out = sensor.step(&mut state, AxialSpeedSensorInput { speed_rad_s: 12.5 });
    }
    let turn = std::f64::consts::TAU;
    checks.against(&t::AXIS_ANGLE, 125.0_f64.rem_euclid(turn), f64::from(out.angle_rad));
    let electrical = 500.0_f64.rem_euclid(turn);
    checks.against(&t::ELECTRICAL_ANGLE, electrical, f64::from(out.electrical_angle_rad));
    checks.against(&t::ELECTRICAL_SPEED, 50.0, f64::from(out.electrical_speed_rad_s));
    Ok(())
}
