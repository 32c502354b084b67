//! The DC motor's step from 60 V to 248 V (`EPowertrain2025`, section 5.2.1).

use plant_core::Dt;
use plant_core::machine::dc::{DcMotor, DcMotorInput, DcMotorOutput, DcMotorParams, DcMotorState};
use plant_core::presets::{MOTOR_MOMENTS, MOTOR_PASEK};

use super::adaptive::{Clock, System, integrate};
use super::tolerance::{self as t, Bound};
use super::{Case, Checks};

pub(super) const RPM_PER_RAD_S: f64 = 30.0 / std::f64::consts::PI;
/// The step \[s\], and how many make a sample.
pub(super) const DT_S: f64 = 1e-5;
pub(super) const PER_SAMPLE: i32 = 10;
const STEPS_PER_S: i32 = 100_000;
/// How long the motor settles at 60 V, and runs at 248 V \[s\].
const SETTLE_S: i32 = 3;
const RUN_S: i32 = 2;
const TOLERANCE: f64 = 1e-10;

/// A parameter set, its equations and what it is checked against.
pub(super) struct Set {
    pub name: &'static str,
    exact: Motor,
    ours: DcMotorParams,
    bounds: &'static [Bound; 6],
}

pub(super) const SETS: [Set; 4] = [
    Set {
        name: "DC motor step, Pasek, with static torque",
        exact: PASEK,
        ours: MOTOR_PASEK,
        bounds: &t::MOTOR_PASEK_STATIC,
    },
    Set {
        name: "DC motor step, Pasek, without static torque",
        exact: Motor { tc: 0.0, ..PASEK },
        ours: DcMotorParams { coulomb_nm: 0.0, ..MOTOR_PASEK },
        bounds: &t::MOTOR_PASEK_FREE,
    },
    Set {
        name: "DC motor step, Moments, with static torque",
        exact: MOMENTS,
        ours: MOTOR_MOMENTS,
        bounds: &t::MOTOR_MOMENTS_STATIC,
    },
    Set {
        name: "DC motor step, Moments, without static torque",
        exact: Motor { tc: 0.0, ..MOMENTS },
        ours: DcMotorParams { coulomb_nm: 0.0, ..MOTOR_MOMENTS },
        bounds: &t::MOTOR_MOMENTS_FREE,
    },
];

pub(super) const CASES: [Case; 4] = [
    Case { name: SETS[0].name, models: &["DcMotor"], run: |c| step(c, &SETS[0], |_, _| {}) },
    Case { name: SETS[1].name, models: &["DcMotor"], run: |c| step(c, &SETS[1], |_, _| {}) },
    Case { name: SETS[2].name, models: &["DcMotor"], run: |c| step(c, &SETS[2], |_, _| {}) },
    Case { name: SETS[3].name, models: &["DcMotor"], run: |c| step(c, &SETS[3], |_, _| {}) },
];

/// The motor's continuous equations, turning forwards.
struct Motor {
    r: f64,
    l: f64,
    k: f64,
    j: f64,
    b: f64,
    tc: f64,
    v: f64,
}

const PASEK: Motor =
    Motor { r: 30.9, l: 0.438, k: 1.323, j: 0.0036, b: 0.0005, tc: 0.128, v: 248.0 };
const MOMENTS: Motor = Motor { l: 0.803, j: 0.0031, ..PASEK };

impl System<2> for Motor {
    fn slope(&self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
        let [i, w] = *y;
        [(self.v - self.r * i - self.k * w) / self.l, (self.k * i - self.b * w - self.tc) / self.j]
    }

    fn scale(&self) -> [f64; 2] {
        [1.0, 100.0]
    }
}

impl Motor {
    /// Current and speed once nothing changes at a voltage: `K·i = b·ω + T_c`, `V = R·i + K·ω`.
    fn steady(&self, v: f64) -> [f64; 2] {
        let w = (v - self.r * self.tc / self.k) / (self.k + self.r * self.b / self.k);
        [(self.b * w + self.tc) / self.k, w]
    }
}

/// Each figure in the order of its bounds: current and speed before, peak and its time, current
/// and speed after; then the same measured ones, and the whole trajectory. `each` sees every step
/// by its number, counted from the step of the voltage.
pub(super) fn step(
    checks: &mut Checks,
    set: &Set,
    mut each: impl FnMut(i32, &DcMotorOutput),
) -> anyhow::Result<()> {
    let Set { exact, ours, bounds, .. } = set;
    let mut y = exact.steady(60.0);
    let mut samples = Vec::new();
    let mut clock = Clock::new(DT_S * f64::from(PER_SAMPLE));
    let mut system = Motor { ..*exact };
    let span = (0.0, f64::from(RUN_S));
    integrate(&mut system, &mut y, span, TOLERANCE, &mut clock, |_, y, _| samples.push(*y))?;

    let mut samples = samples.into_iter();
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    let motor = DcMotor::new(*ours, Dt::from_s(DT_S as f32)?)?;
    let mut state = DcMotorState::default();
    let mut at = |voltage_v| motor.step(&mut state, DcMotorInput { voltage_v, load_nm: 0.0 });
    let first = 1 - SETTLE_S * STEPS_PER_S;
    let mut out = at(60.0);
    each(first, &out);
    for number in first + 1..=0 {
        out = at(60.0);
        each(number, &out);
    }
    let before = [f64::from(out.current_a), f64::from(out.speed_rad_s)];
    let (mut peak_a, mut peak_s, mut worst, mut largest) = (0.0, 0.0, 0.0_f64, 0.0_f64);
    for number in 1..=RUN_S * STEPS_PER_S {
        out = at(248.0);
        each(number, &out);
        let i = f64::from(out.current_a);
        if i > peak_a {
            (peak_a, peak_s) = (i, f64::from(number) * DT_S);
        }
        if number % PER_SAMPLE == 0
            && let Some(exact) = samples.next()
        {
            worst = worst.max((i - exact[0]).abs());
            largest = largest.max(exact[0]);
        }
    }
    let after = [f64::from(out.current_a), f64::from(out.speed_rad_s)];
    let figures = [
        before[0],
        before[1] * RPM_PER_RAD_S,
        peak_a,
        peak_s * 1000.0,
        after[0],
        after[1] * RPM_PER_RAD_S,
    ];
    for (bound, figure) in bounds.iter().zip(figures) {
        checks.add(bound, figure);
    }
    checks.add(&t::MOTOR_TRAJECTORY, worst / largest);
    for (bound, (exact, ours)) in
        t::MOTOR_STEADY.iter().zip(exact.steady(248.0).into_iter().zip(after))
    {
        checks.against(bound, exact, ours);
    }
    if exact.tc > 0.0 {
        for (bound, figure) in t::MOTOR_MEASURED.iter().zip([
            before[0],
            after[0],
            before[1] * RPM_PER_RAD_S,
            after[1] * RPM_PER_RAD_S,
            peak_s * 1000.0,
        ]) {
            checks.add(bound, figure);
        }
    }
    Ok(())
}
