//! The DC motor's step from 60 V to 248 V (`EPowertrain2025`, section 5.2.1).

use plant_core::Dt;
use plant_core::machine::dc::{DcMotor, DcMotorInput, DcMotorParams, DcMotorState};
use plant_core::presets::{MOTOR_MOMENTS, MOTOR_PASEK};

use super::adaptive::{Clock, System, integrate};
use super::tolerance::{self as t, Bound};
use super::{Case, Checks};

const RPM_PER_RAD_S: f64 = 30.0 / std::f64::consts::PI;
/// The step \[s\], and how many make a sample.
const DT_S: f64 = 1e-5;
const PER_SAMPLE: u32 = 10;
/// How long the motor settles at 60 V, and runs at 248 V \[s\].
const SETTLE_S: u32 = 3;
const RUN_S: u32 = 2;
const TOLERANCE: f64 = 1e-10;

pub(super) const CASES: [Case; 4] = [
    Case {
        name: "DC motor step, Pasek, with static torque",
        models: &["DcMotor"],
        run: |c| step(c, &PASEK, MOTOR_PASEK, &t::MOTOR_PASEK_STATIC),
    },
    Case {
        name: "DC motor step, Pasek, without static torque",
        models: &["DcMotor"],
        run: |c| {
            let ours = DcMotorParams { coulomb_nm: 0.0, ..MOTOR_PASEK };
            step(c, &Motor { tc: 0.0, ..PASEK }, ours, &t::MOTOR_PASEK_FREE)
        },
    },
    Case {
        name: "DC motor step, Moments, with static torque",
        models: &["DcMotor"],
        run: |c| step(c, &MOMENTS, MOTOR_MOMENTS, &t::MOTOR_MOMENTS_STATIC),
    },
    Case {
        name: "DC motor step, Moments, without static torque",
        models: &["DcMotor"],
        run: |c| {
            let ours = DcMotorParams { coulomb_nm: 0.0, ..MOTOR_MOMENTS };
            step(c, &Motor { tc: 0.0, ..MOMENTS }, ours, &t::MOTOR_MOMENTS_FREE)
        },
    },
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
/// and speed after; then the same measured ones, and the whole trajectory.
fn step(
    checks: &mut Checks,
    exact: &Motor,
    ours: DcMotorParams,
    bounds: &[Bound; 6],
) -> anyhow::Result<()> {
    let mut y = exact.steady(60.0);
    let mut samples = vec![y];
    let mut clock = Clock::new(DT_S * f64::from(PER_SAMPLE));
    let mut system = Motor { ..*exact };
    let span = (0.0, f64::from(RUN_S));
    integrate(&mut system, &mut y, span, TOLERANCE, &mut clock, |_, y, _| samples.push(*y))?;

    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    let motor = DcMotor::new(ours, Dt::from_s(DT_S as f32)?)?;
    let mut state = DcMotorState::default();
    let mut at = |voltage_v| motor.step(&mut state, DcMotorInput { voltage_v, load_nm: 0.0 });
    let mut out = at(60.0);
    for _ in 1..SETTLE_S * 100_000 {
        out = at(60.0);
    }
    let before = [f64::from(out.current_a), f64::from(out.speed_rad_s)];
    let (mut peak_a, mut peak_s, mut worst, mut largest) = (0.0, 0.0, 0.0_f64, 0.0_f64);
    for number in 1..=RUN_S * 100_000 {
        out = at(248.0);
        let i = f64::from(out.current_a);
        if i > peak_a {
            (peak_a, peak_s) = (i, f64::from(number) * DT_S);
        }
        if number % PER_SAMPLE == 0
            && let Some(exact) = samples.get((number / PER_SAMPLE) as usize)
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
