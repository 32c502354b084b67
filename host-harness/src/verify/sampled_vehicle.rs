//! A vehicle with a synchronous machine under a controller that samples: a driver's torque and the
//! field-oriented controller, which holds its modulation for a period. The same controllers drive the
//! plant and the adaptive solution.

use plant_core::Dt;
use plant_core::control::foc::{Foc, FocInput, FocParams, FocState};
use plant_core::control::pid::{Pid, PidInput, PidParams, PidState};
use plant_core::converter::Gates;
use plant_core::machine::transform::{Dq, LARGEST_PER_BUS};
use plant_core::powertrain::PowertrainInput;
use plant_core::presets::BMW_I3_60AH_PMSM;

use super::adaptive::Clock;
use super::composed::sets::I3_PMSM;
use super::composed::{Command, ComposedReference, Gates as Told, MOST, SOC, V};
use super::drives::{START_SOC, Sample, TOLERANCE, off, single};
use super::tolerance as t;
use super::{Case, Checks};

pub(super) const CASES: [Case; 2] = [
    Case {
        name: "PMSM vehicle under a controller of 10 kHz",
        models: &["Powertrain", "Pmsm", "Foc", "Pid", "Converter", "Gearbox", "Battery"],
        run: |checks| sampled(checks, 1e-4),
    },
    Case {
        name: "PMSM vehicle under a controller of 20 kHz",
        models: &["Powertrain", "Pmsm", "Foc", "Pid", "Converter", "Gearbox", "Battery"],
        run: |checks| sampled(checks, 5e-5),
    },
];

/// The plant steps once in a period, and in as many parts.
const PARTS: u32 = 10;
/// Time and speed that the driver wants: a start, a faster stretch, braking.
const PROFILE: [(f64, f64); 5] = [(0.0, 0.0), (1.0, 0.0), (5.0, 9.0), (6.0, 9.0), (9.0, 2.0)];
/// The driver: torque per speed error \[N·m·s/m\], and its integral's rate.
const K: f64 = 210.0;
const I: f64 = 105.0;
/// Of the current loop \[rad/s\].
const BANDWIDTH: f64 = 1000.0;
const AUXILIARY_W: f64 = 530.0;
/// Rows are this far apart \[s\].
const ROW_S: f64 = 0.01;

/// What the controllers see.
#[derive(Clone, Copy)]
struct Measured {
    speed_m_s: f64,
    current_a: [f64; 2],
    bus_v: f64,
    soc: f64,
}

fn wanted(t: f64) -> f64 {
    let span = PROFILE.windows(2).find(|pair| t < pair[1].0);
    span.map_or(f64::NAN, |pair| {
        let ((t0, v0), (t1, v1)) = (pair[0], pair[1]);
        v0 + (v1 - v0) * (t - t0) / (t1 - t0)
    })
}

/// Driver and controller, whose share of the bus voltage `advance` holds for a period.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
fn in_samples(
    period_s: f64,
    mut now: Measured,
    mut advance: impl FnMut(f64, Dq) -> anyhow::Result<Measured>,
) -> anyhow::Result<Vec<Sample>> {
    let dt = Dt::from_s(single(period_s))?;
    let pid = PidParams {
        proportional: single(K),
        integral_per_s: single(I),
        smoothing_per_s: f32::INFINITY,
        ..PidParams::DEFAULT
    };
    let (driver, mut driving) = (Pid::new(pid, dt)?, PidState::default());
    let drive = BMW_I3_60AH_PMSM.powertrain.drives;
    let params = FocParams { bandwidth_rad_s: single(BANDWIDTH), ..FocParams::DEFAULT };
    let (foc, mut control) = (Foc::new(params, drive.motor, dt)?, FocState::default());
    let rad_per_m = f64::from(drive.gearbox.ratio / BMW_I3_60AH_PMSM.powertrain.wheel.radius_m);
    let (periods, per_row) = ((9.0 / period_s).round() as u32, (ROW_S / period_s).round() as u32);
    let mut found = Vec::new();
    for number in 0..periods {
        let time_s = period_s * f64::from(number);
        let measurement = single(now.speed_m_s);
        let reference = single(wanted(time_s));
        let torque_nm = driver.step(&mut driving, PidInput { reference, measurement }).output;
        let [d, q] = now.current_a.map(single);
        let input = FocInput {
            torque_nm,
            current_a: Dq { d, q },
            speed_rad_s: single(rad_per_m * now.speed_m_s),
            bus_v: single(now.bus_v),
        };
        let out = foc.step(&mut control, input);
        anyhow::ensure!(!out.rejected && !out.saturated, "at {time_s} s: {out:?}");
        now = advance(time_s, out.voltage_v * (1.0 / single(now.bus_v)))?;
        if (number + 1) % per_row == 0 {
            found.push([now.speed_m_s, now.soc, now.current_a[1]]);
        }
    }
    Ok(found)
}

fn in_continuous_time(period_s: f64) -> anyhow::Result<Vec<Sample>> {
    let mut vehicle = ComposedReference::new(I3_PMSM)?;
    let mut y = vehicle.rolling_at(0.0, START_SOC);
    let bus_v = I3_PMSM.v_empty + (I3_PMSM.v_full - I3_PMSM.v_empty) * START_SOC;
    let start = Measured { speed_m_s: 0.0, current_a: [0.0; 2], bus_v, soc: START_SOC };
    in_samples(period_s, start, |from_s, per_bus| {
        let gates = [Told::Modulated([per_bus.d, per_bus.q].map(f64::from)); MOST];
        let command = Command { gates, auxiliary_w: AUXILIARY_W, ..Command::default() };
        let until_s = from_s + period_s;
        let clock = &mut Clock::never();
        vehicle.advance(&mut y, &command, (from_s, until_s), TOLERANCE, clock, |_, _, _| {})?;
        Ok(Measured {
            speed_m_s: y[V],
            current_a: ComposedReference::currents(&y, 0),
            bus_v: vehicle.battery_v(until_s, &y),
            soc: y[SOC],
        })
    })
}

fn in_steps(period_s: f64, parts: u32) -> anyhow::Result<Vec<Sample>> {
    let dt = Dt::from_s(single(period_s / f64::from(parts)))?;
    let plant = BMW_I3_60AH_PMSM.powertrain.build(dt)?;
    let mut state = plant.at_rest(single(START_SOC))?;
    let bus_v = f64::from(state.battery_v);
    let start = Measured { speed_m_s: 0.0, current_a: [0.0; 2], bus_v, soc: START_SOC };
    in_samples(period_s, start, |_, per_bus| {
        let input = PowertrainInput::with(Gates::On(per_bus * (1.0 / LARGEST_PER_BUS)));
        let mut out = plant.step(&mut state, input);
        for _ in 1..parts {
            out = plant.step(&mut state, input);
        }
        anyhow::ensure!(!out.rejected, "the plant refused its input");
        let current_a = [out.drives.current_a.d, out.drives.current_a.q].map(f64::from);
        let [speed_m_s, bus_v, soc] = [out.speed_m_s, out.battery_v, out.soc].map(f64::from);
        Ok(Measured { speed_m_s, current_a, bus_v, soc })
    })
}

fn sampled(checks: &mut Checks, period_s: f64) -> anyhow::Result<()> {
    let stepped = || rayon::join(|| in_steps(period_s, 1), || in_steps(period_s, PARTS));
    let (exact, (coarse, fine)) = rayon::join(|| in_continuous_time(period_s), stepped);
    let (exact, coarse, fine) = (exact?, coarse?, fine?);
    for (bounds, k) in t::SAMPLED_VEHICLE.chunks(2).zip([0, 2]) {
        checks.add(&bounds[0], off(&fine, &exact, k));
        checks.add(&bounds[1], off(&coarse, &exact, k) / off(&fine, &exact, k));
    }
    checks.add(&t::SAMPLED_VEHICLE[4], off(&fine, &exact, 1));
    Ok(())
}
