//! A drive that heats up until its inverter derates it, against the adaptive solution of its
//! equations: driven and braked in turns on a level road, by an ideal torque loop.
//!
//! ```text
//! battery  V = V_oc(SOC) − V_rc − R_s·I     dSOC/dt = −I/(3600·Q)     C·dV_rc/dt = I − V_rc/R_p
//! drive    di/dt = rate·(i* − i)            i* = T*/Kt within ± i_most·left(ϑ, υ), and so is i
//!          V·I = i·(Ke·ω + R(ϑ)·i + R_c·i + L·di/dt) + V_d·|i|       R(ϑ) = R·(1 + α·(ϑ − ϑ_R))
//! heat     C_m·dϑ/dt = R(ϑ)·i² + b·ω² − (ϑ − ϑ_k)/R_m    C_u·dυ/dt = R_c·i² + V_d·|i| − (υ − ϑ_k)/R_u
//! road     m·dv/dt = Kt·k·i − (1 − η)·Kt·k·|i| − air − rolling − b·k²·v
//! ```

use plant_core::converter::Gates;
use plant_core::machine::heated::HeatedPartParams;
use plant_core::powertrain::{HeatedDriveParams, Limited, PowertrainInput, PowertrainParams};
use plant_core::presets::BMW_I3_60AH_THERMAL;
use plant_core::{BatteryParams, Dt};

use super::adaptive::{Clock, System, integrate};
use super::drives::{START_SOC, STEPS_MS, TOLERANCE, off, single};
use super::tolerance as t;
use super::{Case, Checks};

pub(super) const CASES: [Case; 1] = [Case {
    name: "heated drive",
    models: &["Powertrain", "ThermalPair", "DcMotor", "Converter", "Gearbox", "Battery"],
    run,
}];

/// Torque \[N·m\] and for how long it is asked for \[s\], in turns: friction brakes too.
const TURNS: [(f64, f64); 2] = [(220.0, 4.0), (-220.0, 3.4)];
/// How long \[s\]: the inverter has settled by then, at a tenth of its heat capacity.
const LONG_S: f64 = 44.4;
const START_M_S: f64 = 8.0;
/// Rows are compared at this spacing \[s\].
const ROW_S: f64 = 0.1;
/// Of the torque loop \[1/s\]: slow enough for steps of 10 ms.
const RATE: f64 = 50.0;

/// A row: temperatures of machine and inverter, speed.
type Row = [f64; 3];

fn params() -> PowertrainParams<BatteryParams, HeatedDriveParams> {
    let mut params = BMW_I3_60AH_THERMAL.powertrain;
    params.auxiliary.power_w = 0.0;
    params.drives.drive.torque_rate_per_s = single(RATE);
    // At a reversal the loop plans with the bus of the step before, 80 V away: of little effect here.
    params.drives.drive.motor.inductance_h = single(INDUCTANCE);
    let tenth = |part: &mut HeatedPartParams| part.heat_capacity_j_per_k *= 0.1;
    tenth(&mut params.drives.thermal.machine);
    tenth(&mut params.drives.thermal.inverter);
    // The equations know no limit of the battery.
    (params.battery.discharge_limit_a, params.battery.charge_limit_a) = (1e6, 1e6);
    params
}

/// The states: speed, SOC, voltage of the RC branch, winding current, both temperatures.
struct Vehicle {
    torque: f64,
    /// The current stands at a limit that falls.
    held: bool,
}

const V: usize = 0;
const SOC: usize = 1;
const RC: usize = 2;
const I: usize = 3;
const MACHINE: usize = 4;
const INVERTER: usize = 5;

/// Motor speed per road speed, and all that moves as mass.
const K: f64 = 9.665 / 0.340;
const MOVING: f64 = 1490.0 + 2.2 / (0.340 * 0.340) + 0.031 * K * K;
const KT: f64 = 0.27;
const VISCOUS: f64 = 1.27e-3;
const COOLANT: f64 = 50.0;
const INDUCTANCE: f64 = 1e-3;

/// What two temperatures leave of the current limit.
fn left(machine: f64, inverter: f64) -> f64 {
    let of = |x: f64, from: f64, to: f64| ((to - x) / (to - from)).clamp(0.0, 1.0);
    of(machine, 140.0, 180.0).min(of(inverter, 100.0, 125.0))
}

/// The current limit \[A\]; the machine never derates here.
fn most(y: &[f64; 6]) -> f64 {
    1000.0 * left(y[MACHINE], y[INVERTER])
}

/// Heat in the converter \[W\].
fn converter(i: f64) -> f64 {
    1e-3 * i * i + 2.74 * i.abs()
}

/// How fast the inverter warms up \[K/s\], and with it the limit falls \[A/s\].
fn warming(y: &[f64; 6]) -> (f64, f64) {
    let rate = (converter(y[I]) - (y[INVERTER] - COOLANT) / 0.027) / 400.0;
    (rate, 1000.0 * rate / 25.0)
}

impl System<6> for Vehicle {
    fn slope(&self, _t: f64, y: &[f64; 6]) -> [f64; 6] {
        let (v, i, w) = (y[V], y[I], K * y[V]);
        let ((inverter, falling), most) = (warming(y), most(y));
        let di = if self.held {
            -falling * i.signum()
        } else {
            RATE * ((self.torque / KT).clamp(-most, most) - i)
        };
        let winding = 2e-3 * (1.0 + (y[MACHINE] - 60.0) / 295.0);
        let power = i * (KT * w + winding * i + INDUCTANCE * di) + converter(i);
        let emf = 343.22 + (399.8 - 343.22) * y[SOC] - y[RC];
        let battery_v = 0.5 * emf + (0.25 * emf * emf - 0.1051 * power).sqrt();
        let battery_a = power / battery_v;
        let force = KT * K * i
            - 0.03 * (KT * K * i).abs()
            - 0.5 * 1.2 * 0.29 * 2.38 * v * v
            - 0.0131 * 1490.0 * 9.80665
            - VISCOUS * K * K * v;
        let machine = winding * i * i + VISCOUS * w * w;
        [
            force / MOVING,
            -battery_a / (3600.0 * 60.0),
            (battery_a - y[RC] / 1.7834e-4) / 9532.9,
            di,
            (machine - (y[MACHINE] - COOLANT) / 0.08) / 1200.0,
            inverter,
        ]
    }

    fn margin(&self, _t: f64, y: &[f64; 6]) -> f64 {
        // Held while the limit falls; a reversal begins with a vehicle that is not held.
        if self.held { warming(y).1 } else { most(y) - y[I].abs() + 1e-7 }
    }

    fn switch(&mut self, _t: f64, y: &mut [f64; 6]) {
        self.held = !self.held && self.torque * y[I] > 0.0;
    }

    fn scale(&self) -> [f64; 6] {
        [1.0, 1e-2, 1e-2, 1.0, 1.0, 1.0]
    }
}

/// The parts of the run: torque, from, to.
fn parts() -> impl Iterator<Item = (f64, f64, f64)> {
    let mut from = 0.0;
    TURNS
        .into_iter()
        .cycle()
        .map(move |(torque, long)| {
            let part = (torque, from, from + long);
            from = part.2;
            part
        })
        .take_while(|part| part.1 < LONG_S)
}

fn exact() -> anyhow::Result<Vec<Row>> {
    let mut y = [START_M_S, START_SOC, 0.0, 0.0, COOLANT, COOLANT];
    let (mut rows, mut clock) = (Vec::new(), Clock::new(ROW_S));
    for (torque, from, to) in parts() {
        let mut vehicle = Vehicle { torque, held: false };
        integrate(&mut vehicle, &mut y, (from, to), TOLERANCE, &mut clock, |_, y, _| {
            rows.push([y[MACHINE], y[INVERTER], y[V]]);
        })?;
    }
    Ok(rows)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts")]
fn ours(step_ms: f64) -> anyhow::Result<Vec<Row>> {
    let dt = Dt::from_s(single(step_ms / 1000.0))?;
    let plant = params().build(dt)?;
    let mut state = plant.at_speed(single(START_SOC), single(START_M_S))?;
    let steps = |s: f64| (1000.0 * s / step_ms).round() as u64;
    let (row, mut rows, mut done) = (steps(ROW_S), Vec::new(), 0);
    for (torque, _, to) in parts() {
        let input = PowertrainInput::with(Gates::Torque(single(torque)));
        while done < steps(to) {
            let out = plant.step(&mut state, input);
            let fits = matches!(out.limited, Limited::No | Limited::Current);
            anyhow::ensure!(!out.rejected && fits, "{:?}", out.limited);
            done += 1;
            if done.is_multiple_of(row) {
                let now = out.drives.temperatures;
                rows.push([now.machine_c, now.inverter_c, out.speed_m_s].map(f64::from));
            }
        }
    }
    Ok(rows)
}

fn run(checks: &mut Checks) -> anyhow::Result<()> {
    let exact = exact()?;
    let runs = STEPS_MS.into_iter().map(ours).collect::<anyhow::Result<Vec<_>>>()?;
    let [coarse, usual, fine] = &runs[..] else { anyhow::bail!("a run for each step") };
    for run in &runs {
        anyhow::ensure!(run.len().abs_diff(exact.len()) <= 1, "the rows do not match");
    }
    for (k, [at_1_ms, coarser, finer]) in t::HEATED.iter().enumerate() {
        let off = |ours: &[Row]| off(ours, &exact, k);
        checks.add(at_1_ms, off(usual));
        checks.add(coarser, off(coarse) / off(usual));
        checks.add(finer, off(usual) / off(fine));
    }
    let least = |rows: &[Row]| rows.iter().map(|r| left(r[0], r[1])).fold(1.0, f64::min);
    checks.against(&t::HEATED_LEFT[0], least(&exact), least(usual));
    checks.add(&t::HEATED_LEFT[1], least(usual));
    Ok(())
}
