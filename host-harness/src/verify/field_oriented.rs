//! The synchronous machine of the source work under field-oriented control: a step of the torque,
//! a field that is weakened, a start under control of the speed.
//!
//! The source work names no controllers; chosen here: bandwidth of the currents 1000 rad/s; a speed
//! loop of 200 rad/s (K 9.4 mN·m·s/rad) with an integral a fifth as fast; a start to 400 rad/s
//! within 40 ms, a load of 0.3 N·m from 80 ms on. Steps of 10 µs on a bus of 300 V.

use plant_core::Dt;
use plant_core::control::foc::{Foc, FocInput, FocOutput, FocParams, FocState};
use plant_core::control::pid::{Pid, PidInput, PidParams, PidState};
use plant_core::machine::pmsm::{Pmsm, PmsmInput, PmsmOutput, PmsmSpeedInput, PmsmState};
use plant_core::presets::PMSM_EPOWERTRAIN;

use super::adaptive::{Clock, System, integrate};
use super::pmsm::{INERTIA, MAGNET_WB, OHM, PAIRS, ROUND, VISCOUS, single};
use super::tolerance as t;
use super::{Case, Checks};

/// Bandwidth of the current loop \[rad/s\], and the bus \[V\] with the share of its voltage.
pub(super) const BANDWIDTH: f64 = 1000.0;
pub(super) const BUS_V: f64 = 300.0;
const SHARE: f64 = 0.95;
/// The step \[s\].
pub(super) const DT_S: f64 = 1e-5;
/// The speed loop.
const K: f64 = INERTIA * 200.0;
const I: f64 = K * 40.0;
/// The start: how fast, from when on loaded and with what, until when.
const SPEED: f64 = 400.0;
const RAMP_S: f64 = 0.04;
const LOADED_S: f64 = 0.08;
const LOAD_NM: f64 = 0.3;
const END_S: f64 = 0.3;
/// Steps between two samples.
pub(super) const PER_SAMPLE: u32 = 10;
const TOLERANCE: f64 = 1e-10;
/// Torque per current of the q axis \[N·m/A\].
const NM_PER_A: f64 = 1.5 * PAIRS * MAGNET_WB;
/// The torque that is weakened, and where it stands still.
const WEAKENED_NM: f64 = 0.3;
const WEAKENED: f64 = 800.0;
/// The ramp of the speed on which the field is weakened, and before it the time in which the torque
/// comes.
const STANDING_S: f64 = 0.01;
const RAMP_TO: f64 = 1200.0;
const RAMP_UP_S: f64 = 2.0;

pub(super) const CASES: [Case; 3] = [
    Case {
        name: "PMSM under field-oriented control",
        models: &["Pmsm", "Foc"],
        run: |checks| {
            step(checks)?;
            weakened(checks)
        },
    },
    Case {
        name: "PMSM over its speed, field weakened",
        models: &["Pmsm", "Foc"],
        run: |checks| ramp(checks, |_, _| {}),
    },
    Case {
        name: "PMSM start under control of its speed",
        models: &["Pmsm", "Foc", "Pid"],
        run: |checks| start(checks, |_, _| {}),
    },
];

/// What is seen of one step.
pub(super) struct Seen {
    /// Speed that is wanted \[rad/s\]; where it is imposed, that one.
    pub reference: f64,
    /// Torque that is wanted \[N·m\].
    pub torque_nm: f64,
    pub control: FocOutput,
    pub machine: PmsmOutput,
    /// Current of the d axis by the closed form \[A\].
    pub d_a: f64,
}

/// Controller and machine.
struct Drive {
    foc: Foc,
    machine: Pmsm,
    control: FocState,
    state: PmsmState,
}

impl Drive {
    fn new() -> anyhow::Result<Self> {
        let dt = Dt::from_s(single(DT_S))?;
        let params = FocParams {
            bandwidth_rad_s: single(BANDWIDTH),
            voltage_share: single(SHARE),
            ..FocParams::DEFAULT
        };
        Ok(Self {
            foc: Foc::new(params, PMSM_EPOWERTRAIN, dt)?,
            machine: Pmsm::new(PMSM_EPOWERTRAIN, dt)?,
            control: FocState::default(),
            state: PmsmState::default(),
        })
    }

    /// The controller's step.
    fn command(&mut self, torque_nm: f64, speed_rad_s: f64) -> FocOutput {
        let input = FocInput {
            torque_nm: single(torque_nm),
            current_a: self.state.current_a(),
            speed_rad_s: single(speed_rad_s),
            bus_v: single(BUS_V),
        };
        self.foc.step(&mut self.control, input)
    }

    /// A step on an imposed speed.
    fn at_speed(&mut self, torque_nm: f64, speed: f64) -> Seen {
        let control = self.command(torque_nm, speed);
        let (voltage_v, speed_rad_s) = (control.voltage_v, single(speed));
        let input = PmsmSpeedInput { voltage_v, speed_rad_s, winding_c: 25.0 };
        let machine = self.machine.step_at_speed(&mut self.state, input);
        Seen { reference: speed, torque_nm, control, machine, d_a: weakening_a(speed) }
    }

    /// A step on a free shaft under a load.
    fn free(&mut self, reference: f64, torque_nm: f64, load_nm: f64) -> Seen {
        let control = self.command(torque_nm, f64::from(self.state.speed_rad_s.get()));
        let input = PmsmInput::cold(control.voltage_v, single(load_nm));
        let machine = self.machine.step(&mut self.state, input);
        Seen { reference, torque_nm, control, machine, d_a: 0.0 }
    }
}

/// A step of the torque at standstill is one lag.
fn step(checks: &mut Checks) -> anyhow::Result<()> {
    let (mut drive, mut worst) = (Drive::new()?, 0.0_f64);
    for number in 1..=1000 {
        let exact = WEAKENED_NM * (1.0 - (-BANDWIDTH * DT_S * f64::from(number)).exp());
        let seen = drive.at_speed(WEAKENED_NM, 0.0);
        worst = worst.max((f64::from(seen.machine.torque_nm) - exact).abs());
    }
    checks.add(&t::FOC_STEP, worst / WEAKENED_NM);
    Ok(())
}

/// The longest steady voltage \[V\].
pub(super) fn longest_v() -> f64 {
    SHARE * BUS_V / 3.0_f64.sqrt()
}

/// The current of the d axis that keeps a round rotor's voltage within its circle, 0 where none is
/// needed: a root of `(R² + ω²·L²)·(i_d² + i_q²) + 2·ω²·ψ·L·i_d + 2·R·ω·ψ·i_q + ω²·ψ² = V²` at
/// `i_q = T/(3/2·p·ψ)`.
fn weakening_a(speed: f64) -> f64 {
    let (turning, q) = (PAIRS * speed, WEAKENED_NM / NM_PER_A);
    let (x, emf) = (turning * ROUND.d_h, turning * MAGNET_WB);
    let (a, b) = (OHM * OHM + x * x, emf * x);
    let c = a * q * q + 2.0 * OHM * emf * q + emf * emf - longest_v() * longest_v();
    ((-b + (b * b - a * c).sqrt()) / a).min(0.0)
}

/// Above base speed, once nothing changes: currents, torque, voltage.
pub(super) fn weakened(checks: &mut Checks) -> anyhow::Result<()> {
    let mut drive = Drive::new()?;
    let mut seen = drive.at_speed(WEAKENED_NM, WEAKENED);
    for _ in 1..10_000 {
        seen = drive.at_speed(WEAKENED_NM, WEAKENED);
    }
    let current = seen.machine.current_a;
    let figures = [current.d, current.q, seen.machine.torque_nm, seen.control.voltage_v.length()];
    let targets = [seen.d_a, WEAKENED_NM / NM_PER_A, WEAKENED_NM, longest_v()];
    for (bound, (target, figure)) in t::FOC_WEAKENED.iter().zip(targets.into_iter().zip(figures)) {
        checks.against(bound, target, figure.into());
    }
    Ok(())
}

/// A constant torque while the speed rises far above base speed; `each` sees every step by its
/// number, from 1.
pub(super) fn ramp(checks: &mut Checks, mut each: impl FnMut(u32, &Seen)) -> anyhow::Result<()> {
    let mut drive = Drive::new()?;
    let (mut worst_a, mut worst_nm) = (0.0_f64, 0.0_f64);
    for number in 1..=steps(STANDING_S + RAMP_UP_S) {
        let time_s = DT_S * f64::from(number);
        let speed = RAMP_TO / RAMP_UP_S * (time_s - STANDING_S).max(0.0);
        let seen = drive.at_speed(WEAKENED_NM, speed);
        if speed > 0.0 {
            worst_a = worst_a.max((f64::from(seen.machine.current_a.d) - seen.d_a).abs());
            worst_nm = worst_nm.max((f64::from(seen.machine.torque_nm) - WEAKENED_NM).abs());
        }
        each(number, &seen);
    }
    checks.add(&t::FOC_RAMP[0], worst_a / weakening_a(RAMP_TO).abs());
    checks.add(&t::FOC_RAMP[1], worst_nm / WEAKENED_NM);
    Ok(())
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
fn steps(duration_s: f64) -> u32 {
    (duration_s / DT_S).round() as u32
}

/// Current of the q axis, speed and the integral of a start: the currents follow their reference
/// with one lag, the machine's axes are decoupled.
struct Start {
    from: f64,
    rate: f64,
    load_nm: f64,
    from_s: f64,
}

impl System<3> for Start {
    fn slope(&self, t: f64, y: &[f64; 3]) -> [f64; 3] {
        let [q, w, integral] = *y;
        let error = self.from + self.rate * (t - self.from_s) - w;
        let torque_nm = K * error + integral;
        [
            BANDWIDTH * (torque_nm / NM_PER_A - q),
            (NM_PER_A * q - VISCOUS * w - self.load_nm) / INERTIA,
            I * error,
        ]
    }

    fn scale(&self) -> [f64; 3] {
        [1.0, 100.0, 0.1]
    }
}

/// Reference speed and load in a moment.
fn wanted(t: f64) -> (f64, f64) {
    (SPEED * (t / RAMP_S).min(1.0), if t > LOADED_S + 0.5 * DT_S { LOAD_NM } else { 0.0 })
}

/// A start to a speed and a load; `each` sees every step by its number, from 1.
pub(super) fn start(checks: &mut Checks, mut each: impl FnMut(u32, &Seen)) -> anyhow::Result<()> {
    let mut clock = Clock::new(DT_S * f64::from(PER_SAMPLE));
    let (mut y, mut samples) = ([0.0; 3], Vec::new());
    for (from_s, to_s, load_nm) in
        [(0.0, RAMP_S, 0.0), (RAMP_S, LOADED_S, 0.0), (LOADED_S, END_S, LOAD_NM)]
    {
        let ((from, _), (to, _)) = (wanted(from_s), wanted(to_s));
        let mut system = Start { from, rate: (to - from) / (to_s - from_s), load_nm, from_s };
        integrate(&mut system, &mut y, (from_s, to_s), TOLERANCE, &mut clock, |_, y, _| {
            samples.push(*y);
        })?;
    }

    let pid = Pid::new(
        PidParams {
            proportional: single(K),
            integral_per_s: single(I),
            smoothing_per_s: f32::INFINITY,
            ..PidParams::DEFAULT
        },
        Dt::from_s(single(DT_S))?,
    )?;
    let (mut drive, mut control) = (Drive::new()?, PidState::default());
    let (mut worst, mut largest) = ([0.0_f64; 2], [0.0_f64; 2]);
    let (mut residual_w, mut throughput_w) = (0.0, 0.0);
    let mut samples = samples.into_iter();
    let mut end = [0.0; 3];
    for number in 1..=steps(END_S) {
        let (reference, load_nm) = wanted(DT_S * f64::from(number));
        let input =
            PidInput { reference: single(reference), measurement: drive.state.speed_rad_s.get() };
        let torque_nm = f64::from(pid.step(&mut control, input).output);
        let seen = drive.free(reference, torque_nm, load_nm);
        let out = &seen.machine;
        let [electrical, copper, field, gap] =
            [out.electrical_w, out.copper_w, out.field_w, out.air_gap_w].map(f64::from);
        residual_w += electrical - copper - field - gap;
        throughput_w += electrical.abs();
        let (q, w) = (f64::from(out.current_a.q), f64::from(out.speed_rad_s));
        end = [w, q, f64::from(seen.control.voltage_v.length())];
        if number % PER_SAMPLE == 0
            && let Some([exact_q, exact_w, _]) = samples.next()
        {
            worst = [worst[0].max((q - exact_q).abs()), worst[1].max((w - exact_w).abs())];
            largest = [largest[0].max(exact_q.abs()), largest[1].max(exact_w.abs())];
        }
        each(number, &seen);
    }
    checks.add(&t::FOC_START[0], worst[0] / largest[0]);
    checks.add(&t::FOC_START[1], worst[1] / largest[1]);
    // Steady: the torque of load and friction, the voltage that drives it.
    let q = (LOAD_NM + VISCOUS * SPEED) / NM_PER_A;
    let turning = PAIRS * SPEED;
    let volts = (turning * ROUND.q_h * q).hypot(OHM * q + turning * MAGNET_WB);
    for (bound, (target, figure)) in
        t::FOC_START_END.iter().zip([SPEED, q, volts].into_iter().zip(end))
    {
        checks.against(bound, target, figure);
    }
    checks.add(&t::PMSM_BALANCE, residual_w / throughput_w);
    Ok(())
}
