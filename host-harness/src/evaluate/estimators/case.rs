//! What is made wrong on purpose before an estimator runs, and the run.

use plant_core::Dt;
use plant_core::battery::{MappedBatteryParams, OverSoc};
use plant_core::num::{SOC_POINTS, SocTable};
use serde::Serialize;
use voltstep_bms::estimate::coulomb::{CoulombCounter, CoulombInput, CoulombParams, CoulombState};
use voltstep_bms::estimate::ekf::{Ekf, EkfInput, EkfParams, Uncertainty};

use super::samples::Samples;
use crate::read::battery::BatteryFile;

/// An estimator is taken to know a start that is said to be right this well.
const START_SD: f64 = 0.01;
/// After this long without current the voltage is that of a rested battery \[s\].
const REST_S: f32 = 1800.0;

/// A test bench waits at least this long before a drive cycle \[s\].
const RESTED_S: f32 = 3600.0;

/// What is wrong: start, sensors, parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Case {
    /// Its name.
    pub name: &'static str,
    /// Added to the state of charge at the start; taken away where the sum leaves 0..1.
    pub initial_soc_error: f64,
    /// Added to the measured current \[A\].
    pub current_bias_a: f64,
    /// Added to the measured current, in units of the capacity per hour.
    pub current_bias_c: f64,
    /// Standard deviation of noise added to each voltage, as a ratio to it.
    pub voltage_noise: f64,
    /// Standard deviation of noise added to each current, in units of the capacity per hour.
    pub current_noise_c: f64,
    /// The estimator's resistances over the true ones.
    pub resistance_factor: f64,
    /// The estimator's capacity over the true one.
    pub capacity_factor: f64,
}

impl Case {
    /// Nothing wrong.
    pub const RIGHT: Self = Self {
        name: "as it is",
        initial_soc_error: 0.0,
        current_bias_a: 0.0,
        current_bias_c: 0.0,
        voltage_noise: 0.0,
        current_noise_c: 0.0,
        resistance_factor: 1.0,
        capacity_factor: 1.0,
    };

    /// The standard set.
    pub const MATRIX: [Self; 12] = [
        Self::RIGHT,
        Self { name: "start 30 % low", initial_soc_error: -0.3, ..Self::RIGHT },
        Self { name: "start 10 % low", initial_soc_error: -0.1, ..Self::RIGHT },
        Self { name: "start 10 % high", initial_soc_error: 0.1, ..Self::RIGHT },
        Self { name: "bias +C/100", current_bias_c: 0.01, ..Self::RIGHT },
        Self { name: "bias -C/100", current_bias_c: -0.01, ..Self::RIGHT },
        Self { name: "noise", voltage_noise: 0.0015, current_noise_c: 0.05, ..Self::RIGHT },
        Self { name: "resistance +20 %", resistance_factor: 1.2, ..Self::RIGHT },
        Self { name: "resistance -20 %", resistance_factor: 0.8, ..Self::RIGHT },
        Self { name: "capacity +5 %", capacity_factor: 1.05, ..Self::RIGHT },
        Self { name: "capacity -5 %", capacity_factor: 0.95, ..Self::RIGHT },
        Self {
            name: "start 30 % low, bias, resistance",
            initial_soc_error: -0.3,
            current_bias_c: 0.01,
            resistance_factor: 1.2,
            ..Self::RIGHT
        },
    ];

    /// A wrong start, and a wrong current.
    #[must_use]
    pub fn wrong(initial_soc_error: f64, current_bias_a: f64) -> Self {
        let name = if initial_soc_error == 0.0 && current_bias_a == 0.0 {
            Self::RIGHT.name
        } else {
            "as said"
        };
        Self { name, initial_soc_error, current_bias_a, ..Self::RIGHT }
    }

    /// The start that an estimator is told, and how well it is said to be known.
    #[must_use]
    pub fn start(&self, samples: &Samples) -> (f64, f64) {
        let truth = samples.soc.iter().copied().find(|s| s.is_finite()).unwrap_or(0.5);
        let told = truth + self.initial_soc_error;
        let told = if (0.0..=1.0).contains(&told) { told } else { truth - self.initial_soc_error };
        (told.clamp(0.0, 1.0), self.initial_soc_error.abs().max(START_SD))
    }

    /// The battery that an estimator believes in.
    #[expect(clippy::cast_possible_truncation, reason = "estimators compute in f32")]
    fn believed(&self, battery: &MappedBatteryParams) -> MappedBatteryParams {
        let factor = self.resistance_factor as f32;
        let mut believed = *battery;
        believed.capacity_ah *= self.capacity_factor as f32;
        for over in [
            &mut believed.series.resistance_ohm,
            &mut believed.polarisation.resistance_ohm,
            &mut believed.second_polarisation.resistance_ohm,
        ] {
            *over = match over {
                OverSoc::Constant(ohm) => OverSoc::Constant(*ohm * factor),
                OverSoc::Table(table) => {
                    let values: [f32; SOC_POINTS] = table.values().map(|ohm| ohm * factor);
                    SocTable::new("resistance_ohm", values).map_or(*over, OverSoc::Table)
                }
            };
        }
        believed
    }
}

/// An estimate after each sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Estimated, 0..1.
    pub soc: f64,
    /// Estimated less measured; not a number where the truth is not known.
    pub error: f64,
    /// The estimator's standard deviation.
    pub sd: f64,
    /// The truth lies in the range in which the parameters were identified.
    pub identified: bool,
    /// The estimator says that something contradicts.
    pub contradicted: bool,
}

/// Runs the Kalman filter over samples with what a case makes wrong, from a state of charge and its
/// standard deviation.
///
/// # Errors
/// Parameters that the filter refuses.
#[expect(clippy::cast_possible_truncation, reason = "estimators compute in f32")]
pub fn ekf(
    battery: &BatteryFile,
    samples: &Samples,
    case: &Case,
    (soc, sd): (f64, f64),
) -> anyhow::Result<Vec<Point>> {
    let believed = case.believed(&battery.battery);
    let nominal_v = believed.open_circuit.at(0.5);
    let filter =
        Ekf::new(EkfParams::typical(believed, nominal_v), Dt::from_s(samples.dt_s as f32)?)?;
    let mut state =
        filter.start(soc as f32, sd as f32, first(&samples.temperature_c, 25.0) as f32)?;
    if samples.starts_rested {
        filter.pause(&mut state, Some(RESTED_S));
    }
    let mut noise = Noise::new(case, f64::from(battery.battery.capacity_ah));
    Ok((0..samples.soc.len())
        .map(|i| {
            let (current_a, voltage_v) = noise.disturb(samples.current_a[i], samples.voltage_v[i]);
            let input = EkfInput {
                current_a: current_a as f32,
                voltage_v: voltage_v as f32,
                temperature_c: samples.temperature_c[i] as f32,
                contactors_open: false,
            };
            filter.step(&mut state, input);
            let estimate = filter.estimate(&state);
            let contradicted = !filter.status(&state).consistent;
            let said = (f64::from(estimate.soc), f64::from(estimate.soc_sd));
            Point { contradicted, ..point(battery, samples, i, said) }
        })
        .collect())
}

/// Counts the charge of samples with what a case makes wrong, from a state of charge and its standard
/// deviation; the voltage is asked after a rest.
///
/// # Errors
/// Parameters that the counter refuses.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "f32; a count")]
pub fn coulomb(
    battery: &BatteryFile,
    samples: &Samples,
    case: &Case,
    (soc, sd): (f64, f64),
) -> anyhow::Result<Vec<Point>> {
    let believed = case.believed(&battery.battery);
    let known = Uncertainty::typical(believed.open_circuit.at(0.5), believed.capacity_ah);
    let counter = CoulombCounter::new(
        CoulombParams {
            capacity_ah: believed.capacity_ah,
            capacity_sd_ah: known.capacity_sd * believed.capacity_ah,
            charge_efficiency: 1.0,
            offset_sd_a: known.current_offset_sd_a,
            gain_sd: 0.005,
            largest_current_a: 2.0 * believed.discharge_limit_a,
            open_circuit: believed.open_circuit,
            rest_voltage_sd_v: known.open_circuit_sd_v,
            rest_current_a: known.current_offset_sd_a,
            rest_s: REST_S,
        },
        Dt::from_s(samples.dt_s as f32)?,
    )?;
    let mut state = CoulombState::known(soc as f32, sd as f32);
    let mut noise = Noise::new(case, f64::from(battery.battery.capacity_ah));
    let per_review = ((1.0 / samples.dt_s).round() as usize).max(1);
    let mut out = counter.review(&mut state, f32::NAN);
    Ok((0..samples.soc.len())
        .map(|i| {
            let (current_a, voltage_v) = noise.disturb(samples.current_a[i], samples.voltage_v[i]);
            counter.step(&mut state, CoulombInput { current_a: current_a as f32 });
            if (i + 1).is_multiple_of(per_review) {
                out = counter.review(&mut state, voltage_v as f32);
            }
            point(battery, samples, i, (f64::from(counter.soc(&state)), f64::from(out.soc_sd)))
        })
        .collect())
}

#[expect(clippy::cast_possible_truncation, reason = "the range is that of the model, in f32")]
fn point(battery: &BatteryFile, samples: &Samples, i: usize, (soc, sd): (f64, f64)) -> Point {
    let truth = samples.soc[i];
    let range = &battery.battery.identified;
    let identified = range.holds(truth as f32, samples.temperature_c[i] as f32);
    Point { soc, error: soc - truth, sd, identified, contradicted: false }
}

fn first(values: &[f64], otherwise: f64) -> f64 {
    values.iter().copied().find(|v| v.is_finite()).unwrap_or(otherwise)
}

/// The disturbed sensors of a case; the same for the same case.
struct Noise<'a> {
    case: &'a Case,
    capacity_ah: f64,
    random: fastrand::Rng,
}

impl<'a> Noise<'a> {
    fn new(case: &'a Case, capacity_ah: f64) -> Self {
        Self { case, capacity_ah, random: fastrand::Rng::with_seed(1) }
    }

    fn disturb(&mut self, current_a: f64, voltage_v: f64) -> (f64, f64) {
        let case = self.case;
        let extra_c = case.current_bias_c + case.current_noise_c * self.normal();
        (
            current_a + case.current_bias_a + extra_c * self.capacity_ah,
            voltage_v * (1.0 + case.voltage_noise * self.normal()),
        )
    }

    /// A draw of the normal distribution (`BoxMuller1958`).
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.random.f64()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.random.f64()).cos()
    }
}
