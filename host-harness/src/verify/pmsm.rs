//! The synchronous machine of the source work (`EPowertrain` 2025, PMSM): its start at a constant
//! voltage, with a rotor of two different axes too.

use plant_core::machine::flux::{Flux, LinearFlux};
use plant_core::machine::pmsm::{Pmsm, PmsmInput, PmsmParams, PmsmState};
use plant_core::machine::transform::Dq;
use plant_core::presets::PMSM_EPOWERTRAIN;
use plant_core::{Dt, Real};

use super::adaptive::{Clock, System, integrate};
use super::tolerance as t;
use super::{Case, Checks};

/// The step \[s\], and how many make a sample.
const DT_S: f64 = 1e-6;
const PER_SAMPLE: u32 = 100;
/// How many samples: 0.2 s, until it runs steadily.
const SAMPLES: u32 = 2000;
/// What the load takes from the shaft \[N·m\].
const LOAD_NM: f64 = 0.2;
const TOLERANCE: f64 = 1e-10;

pub(super) const CASES: [Case; 2] = [
    Case { name: "PMSM start", models: &["Pmsm"], run: |c| start(c, &ROUND) },
    Case { name: "PMSM start, salient", models: &["Pmsm"], run: |c| start(c, &SALIENT) },
];

/// The machine's continuous equations: currents of both axes, speed, turning forwards.
pub(super) struct Machine {
    pub d_h: f64,
    pub q_h: f64,
    /// Voltages that settle at a current of the d axis which no torque needs.
    voltage_v: [f64; 2],
}

pub(super) const OHM: f64 = 2.98;
pub(super) const PAIRS: f64 = 2.0;
pub(super) const MAGNET_WB: f64 = 0.125;
pub(super) const INERTIA: f64 = 4.7e-5;
pub(super) const VISCOUS: f64 = 1.1e-4;

pub(super) const ROUND: Machine = Machine { d_h: 7e-3, q_h: 7e-3, voltage_v: [-8.0, 60.0] };
const SALIENT: Machine = Machine { q_h: 14e-3, ..ROUND };

impl System<3> for Machine {
    fn slope(&self, _t: f64, y: &[f64; 3]) -> [f64; 3] {
        let [d, q, w] = *y;
        let (flux_d, flux_q) = (self.d_h * d + MAGNET_WB, self.q_h * q);
        let torque = 1.5 * PAIRS * (flux_d * q - flux_q * d);
        [
            (self.voltage_v[0] - OHM * d + PAIRS * w * flux_q) / self.d_h,
            (self.voltage_v[1] - OHM * q - PAIRS * w * flux_d) / self.q_h,
            (torque - VISCOUS * w - LOAD_NM) / INERTIA,
        ]
    }

    fn scale(&self) -> [f64; 3] {
        [1.0, 1.0, 100.0]
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
pub(super) const fn single(x: f64) -> Real {
    x as Real
}

/// The same machine in `plant-core`, with its input.
fn ours(exact: &Machine, dt_s: f64) -> anyhow::Result<(Pmsm, PmsmInput)> {
    let flux =
        LinearFlux { magnet_wb: single(MAGNET_WB), d_h: single(exact.d_h), q_h: single(exact.q_h) };
    let params = PmsmParams { flux: Flux::Linear(flux), ..PMSM_EPOWERTRAIN };
    let [d, q] = exact.voltage_v.map(single);
    let input = PmsmInput::cold(Dq { d, q }, single(LOAD_NM));
    Ok((Pmsm::new(params, Dt::from_s(single(dt_s))?)?, input))
}

fn start(checks: &mut Checks, exact: &Machine) -> anyhow::Result<()> {
    let mut y = [0.0; 3];
    let mut samples = Vec::new();
    let mut clock = Clock::new(DT_S * f64::from(PER_SAMPLE));
    let mut system = Machine { ..*exact };
    let span = (0.0, DT_S * f64::from(PER_SAMPLE * SAMPLES));
    integrate(&mut system, &mut y, span, TOLERANCE, &mut clock, |_, y, _| samples.push(*y))?;

    let (machine, input) = ours(exact, DT_S)?;
    let mut state = PmsmState::default();
    let (mut worst, mut largest) = ([0.0_f64; 2], [0.0_f64; 2]);
    let (mut residual_w, mut throughput_w) = (0.0, 0.0);
    for [d, q, w] in &samples {
        let mut out = machine.step(&mut state, input);
        for number in 0..PER_SAMPLE {
            let [electrical, copper, field, gap] =
                [out.electrical_w, out.copper_w, out.field_w, out.air_gap_w].map(f64::from);
            residual_w += electrical - copper - field - gap;
            throughput_w += electrical.abs();
            if number < PER_SAMPLE - 1 {
                out = machine.step(&mut state, input);
            }
        }
        let (i, speed) = (out.current_a, f64::from(out.speed_rad_s));
        let off = (f64::from(i.d) - d).hypot(f64::from(i.q) - q);
        worst = [worst[0].max(off), worst[1].max((speed - w).abs())];
        largest = [largest[0].max(d.hypot(*q)), largest[1].max(w.abs())];
    }
    checks.add(&t::PMSM_TRAJECTORY[0], worst[0] / largest[0]);
    checks.add(&t::PMSM_TRAJECTORY[1], worst[1] / largest[1]);
    checks.add(&t::PMSM_BALANCE, residual_w / throughput_w);

    // The end does not depend on the step.
    let (machine, input) = ours(exact, 1e-3)?;
    let mut state = PmsmState::default();
    let mut out = machine.step(&mut state, input);
    for _ in 0..2000 {
        out = machine.step(&mut state, input);
    }
    let steady = [out.current_a.d, out.current_a.q, out.speed_rad_s].map(f64::from);
    for (bound, (target, obtained)) in t::PMSM_STEADY.iter().zip(y.into_iter().zip(steady)) {
        checks.against(bound, target, obtained);
    }
    Ok(())
}
