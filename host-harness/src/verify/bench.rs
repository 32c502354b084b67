//! The converter bench (`EPowertrain2025`, section 5.2.3): a motor with a load of 10 kg·m² behind the
//! converter on 400 V, its speed held by a PID from rad/s to duty.
//!
//! Controller, amplitudes and frequencies are printed nowhere; chosen here: K 0.002, I 0.004,
//! smoothing 1e6, limits −1…1; a square wave of ±20 rad/s and 0.1 Hz; a sine of ±50 rad/s and
//! 0.2 Hz; 20 s each, in steps of 0.1 ms. The duty stays within its limits.

use plant_core::control::pid::{AntiWindup, Pid, PidInput, PidParams, PidState};
use plant_core::converter::{Converter, ConverterInput, ConverterParams};
use plant_core::machine::dc::{DcMotor, DcMotorSpeedInput, DcMotorState};
use plant_core::mechanics::rotational::{RotationalLoad, RotationalLoadState};
use plant_core::port::Source;
use plant_core::presets::{CONVERTER_BENCH_LOAD, CONVERTER_BENCH_MOTOR, CONVERTER_BENCH_SUPPLY_V};
use plant_core::signal::sources::{PhaseState, Sine, SineParams, Square, SquareParams};
use plant_core::{Dt, must};

use super::adaptive::{Clock, System, integrate};
use super::tolerance as t;
use super::{Case, Checks};

const K: f64 = 0.002;
const I: f64 = 0.004;
const SMOOTHING: f64 = 1e6;
const SQUARE: f64 = 20.0;
const SQUARE_S: f64 = 10.0;
const SINE: f64 = 50.0;
const SINE_HZ: f64 = 0.2;
const RUN_S: u32 = 20;
const HALF_PERIODS: u32 = 4;
const DT: Dt = must!(Dt::from_s(1e-4));
pub(super) const STEPS_PER_S: u32 = 10_000;
const PER_SAMPLE: u32 = 10;
const TOLERANCE: f64 = 1e-10;

pub(super) const CASES: [Case; 2] = [
    Case {
        name: "converter bench, square",
        models: &["DcMotor", "Converter", "Pid", "RotationalLoad", "Square"],
        run: |checks| bench(checks, Wave::Square, |_, _| {}),
    },
    Case {
        name: "converter bench, sine",
        models: &["DcMotor", "Converter", "Pid", "RotationalLoad", "Sine"],
        run: |checks| bench(checks, Wave::Sine, |_, _| {}),
    },
];

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Wave {
    Square,
    Sine,
}

/// The continuous equations: current, speed, the PID's integral, energy out of the supply \[J\].
struct Bench {
    wave: Wave,
    /// Of the square wave.
    level: f64,
}

impl Bench {
    /// The reference and its rate.
    fn reference(&self, t: f64) -> (f64, f64) {
        let turn = std::f64::consts::TAU * SINE_HZ;
        match self.wave {
            Wave::Square => (self.level, 0.0),
            Wave::Sine => (SINE * (turn * t).sin(), SINE * turn * (turn * t).cos()),
        }
    }
}

impl System<4> for Bench {
    fn slope(&self, t: f64, y: &[f64; 4]) -> [f64; 4] {
        let [i, w, integral, _] = *y;
        let (reference, rate) = self.reference(t);
        let acceleration = (0.72 * i - (5e-4 + 8.5e-6) * w) / (0.031 + 10.0);
        let error = reference - w;
        let duty = K * error + integral - (K * (rate - acceleration) + I * error) / SMOOTHING;
        [(duty * 400.0 - 0.025 * i - 0.7144 * w) / 1e-3, acceleration, I * error, 400.0 * duty * i]
    }

    fn scale(&self) -> [f64; 4] {
        [10.0, 1.0, 1e-2, 1e3]
    }
}

/// Samples of speed and the energy out of the supply at the end.
fn solve(wave: Wave) -> anyhow::Result<(Vec<f64>, f64)> {
    let mut bench = Bench { wave, level: SQUARE };
    let (mut y, mut speed) = ([0.0; 4], vec![0.0]);
    let mut clock = Clock::new(1e-3);
    for number in 0..HALF_PERIODS {
        bench.level = if number % 2 == 0 { SQUARE } else { -SQUARE };
        let span = (f64::from(number) * 0.5 * SQUARE_S, f64::from(number + 1) * 0.5 * SQUARE_S);
        integrate(&mut bench, &mut y, span, TOLERANCE, &mut clock, |_, y, _| speed.push(y[1]))?;
    }
    Ok((speed, y[3]))
}

/// Where the energy went \[J\].
#[derive(Clone, Copy, Default)]
pub(super) struct Energy {
    pub supply: f64,
    pub copper: f64,
    pub conversion: f64,
    pub friction: f64,
    pub numerical: f64,
    pub throughput: f64,
}

/// What is seen of one step.
pub(super) struct Seen {
    pub reference: f64,
    pub speed_rad_s: f64,
    pub duty: f64,
    pub current_a: f64,
    pub energy: Energy,
}

impl Seen {
    /// In the winding's field and in motion \[J\].
    pub fn stored(&self) -> f64 {
        0.5 * 1e-3 * self.current_a.powi(2) + 0.5 * 10.031 * self.speed_rad_s.powi(2)
    }

    /// What the balance does not explain \[J\].
    pub fn residual(&self) -> f64 {
        let Energy { supply, copper, conversion, friction, numerical, .. } = self.energy;
        supply - copper - conversion - friction - numerical - self.stored()
    }
}

/// A wave's run; `each` sees every step by its number, from 1.
#[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
pub(super) fn bench(
    checks: &mut Checks,
    wave: Wave,
    mut each: impl FnMut(u32, &Seen),
) -> anyhow::Result<()> {
    let (exact, exact_j) = solve(wave)?;
    let motor = DcMotor::new(CONVERTER_BENCH_MOTOR, DT)?;
    let load = RotationalLoad::new(CONVERTER_BENCH_LOAD, DT)?;
    let converter = Converter::new(ConverterParams::IDEAL)?;
    let pid = Pid::new(
        PidParams {
            proportional: K as f32,
            integral_per_s: I as f32,
            output_min: -1.0,
            output_max: 1.0,
            smoothing_per_s: SMOOTHING as f32,
            anti_windup: AntiWindup::Freeze,
            ..PidParams::DEFAULT
        },
        DT,
    )?;
    let square = Square::new(
        SquareParams {
            low: -SQUARE as f32,
            high: SQUARE as f32,
            period_s: SQUARE_S as f32,
            on_ratio: 0.5,
            phase_turns: 0.0,
        },
        DT,
    )?;
    let sine = Sine::new(
        SineParams {
            amplitude: SINE as f32,
            offset: 0.0,
            frequency_hz: SINE_HZ as f32,
            phase_turns: 0.0,
        },
        DT,
    )?;

    let (mut phase, mut control) = (PhaseState::default(), PidState::default());
    let (mut motor_state, mut load_state) =
        (DcMotorState::default(), RotationalLoadState::default());
    let mut energy = Energy::default();
    let mut last = Seen { reference: 0.0, speed_rad_s: 0.0, duty: 0.0, current_a: 0.0, energy };
    let (mut squares, mut count, mut saturated) = (0.0, 0.0, 0.0);
    for number in 1..=RUN_S * STEPS_PER_S {
        let reference = match wave {
            Wave::Square => square.step(&mut phase, ()),
            Wave::Sine => sine.step(&mut phase, ()),
        };
        let (i, w) = (motor_state.current_a.get(), load_state.speed_rad_s.get());
        let command = pid.step(&mut control, PidInput { reference, measurement: w });
        let voltage_v = command.output * CONVERTER_BENCH_SUPPLY_V;
        let (law, _) = motor.winding().law(Source::stiff(voltage_v), i, w);
        let (increment, slip) = load.solve(&load_state, law, motor.coast());
        let turned = load.settle(&mut load_state, increment, slip);
        let out = motor.step_at_speed(
            &mut motor_state,
            DcMotorSpeedInput { voltage_v, speed_rad_s: turned.speed_rad_s },
        );
        let supply = converter.step(
            &mut (),
            ConverterInput {
                duty: command.output,
                input_v: CONVERTER_BENCH_SUPPLY_V,
                output_a: out.current_a,
            },
        );
        energy.book(
            f64::from(CONVERTER_BENCH_SUPPLY_V) * f64::from(supply.input_a),
            f64::from(out.current_a),
            f64::from(turned.speed_rad_s),
            (f64::from(out.current_a) - f64::from(i), f64::from(increment)),
        );
        saturated += f64::from(u8::from(command.saturated));
        last = Seen {
            reference: f64::from(reference),
            speed_rad_s: f64::from(turned.speed_rad_s),
            duty: f64::from(command.output),
            current_a: f64::from(out.current_a),
            energy,
        };
        each(number, &last);
        if number % PER_SAMPLE == 0
            && let Some(exact) = exact.get((number / PER_SAMPLE) as usize)
        {
            squares += (f64::from(turned.speed_rad_s) - exact).powi(2);
            count += 1.0;
        }
    }
    checks.add(&t::BENCH_BALANCE, last.residual() / energy.throughput);
    checks.add(&t::BENCH_SPEED, f64::sqrt(squares / count));
    checks.against(&t::BENCH_ENERGY, exact_j, energy.supply);
    checks.add(&t::BENCH_NUMERICAL, energy.numerical / energy.throughput);
    checks.add(&t::BENCH_SATURATED, saturated);
    Ok(())
}

impl Energy {
    /// Books one step: power out of the supply, current, speed, and their increments.
    fn book(&mut self, supply_w: f64, i: f64, w: f64, (di, dw): (f64, f64)) {
        let h = 1.0 / f64::from(STEPS_PER_S);
        self.supply += supply_w * h;
        self.throughput += supply_w.abs() * h;
        self.copper += 0.025 * i * i * h;
        self.conversion += (0.7144 - 0.72) * w * i * h;
        self.friction += (5e-4 + 8.5e-6) * w * w * h;
        self.numerical += 0.5 * 1e-3 * di * di + 0.5 * 10.031 * dw * dw;
    }
}
