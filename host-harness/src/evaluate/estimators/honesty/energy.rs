//! The energy left, from 25 to −10 °C: what the gauge says against what the battery gives.

use plant_core::battery::{MappedBattery, MappedBatteryInput};
use plant_core::{Accum, Dt};
use voltstep_bms::estimate::energy::{EnergyGauge, EnergyParams, EnergyState};
use voltstep_bms::{Estimate, Health};

use super::batteries::{Chemistry, scale_resistances};
use super::random::Random;
use super::tally::{Said, Tally};

/// Discharges for each seed.
const DISCHARGES: u32 = 10;
/// How well the battery is known: resistance and capacity as ratios, state of charge.
const RESISTANCE_SD: f32 = 0.1;
const CAPACITY_SD: f32 = 0.02;
const SOC_SD: f32 = 0.01;
/// Each is a sample of its own \[s\].
const APART_S: f64 = 3600.0;

/// Runs the discharges of a seed.
///
/// # Panics
/// Where a battery or a gauge refuses what is simulated: a mistake in the matrix itself.
pub fn run(chemistry: Chemistry, seed: u64) -> Tally {
    let mut random = Random::new(seed);
    let mut tally = Tally::default();
    let dt = Dt::from_s(1.0).expect("a second");
    let known = chemistry.params();
    let model = MappedBattery::new(known, dt).expect("a battery");
    let empty_v = chemistry.cells() * chemistry.empty_v();
    let params = EnergyParams { empty_soc: 0.0, full_soc: 1.0, empty_v, least_a: 1e-3 };
    let gauge = EnergyGauge::new(params, &model, dt).expect("a gauge");
    let nominal_v = known.open_circuit.at(0.5);
    let full_wh = f64::from(known.capacity_ah * nominal_v);
    for _ in 0..DISCHARGES {
        let mut truth = known;
        (truth.discharge_limit_a, truth.charge_limit_a) = (1e4, 1e4);
        scale_resistances(&mut truth, (1.0 + RESISTANCE_SD * random.normal()).max(0.3));
        truth.capacity_ah *= 1.0 + CAPACITY_SD * random.normal();
        let celsius = random.one_of(&[25.0, 10.0, 0.0, -10.0]);
        let soc = 0.15 + 0.8 * random.even();
        let average_a = known.capacity_ah * (0.1 + 2.5 * random.even());
        let average_w = average_a * nominal_v;
        let estimate = Estimate::rested(soc + SOC_SD * random.normal(), SOC_SD, celsius);
        let health = Health {
            capacity_sd_ah: CAPACITY_SD * known.capacity_ah,
            resistance_factor_sd: RESISTANCE_SD,
            ..Health::as_new(&model)
        };
        let state =
            EnergyState { average_a: Accum::new(average_a), average_w: Accum::new(average_w) };
        let report = gauge.report(&state, &estimate, &health).expect("a finite estimate");
        let truth = MappedBattery::new(truth, dt).expect("a battery");
        let given_wh = discharge(&truth, soc, celsius, average_w, empty_v);
        let said = Said {
            value: f64::from(report.remaining_energy_wh) / full_wh,
            sd: f64::from(report.remaining_energy_sd_wh) / full_wh,
            contradicted: false,
            outside_known: false,
        };
        tally.book(said, given_wh / full_wh, APART_S);
    }
    tally
}

/// What it gives at a constant power until empty \[W·h\].
fn discharge(battery: &MappedBattery, soc: f32, celsius: f32, power_w: f32, empty_v: f32) -> f64 {
    let mut state = battery.rested_at(soc, celsius).expect("a state");
    let mut seconds = 0.0;
    loop {
        let (source, _) = battery.offer(&state);
        let square = source.emf_v * source.emf_v - 4.0 * source.resistance_ohm * power_w;
        let current_a = 2.0 * power_w / (source.emf_v + square.max(0.0).sqrt());
        let out = battery.step(&mut state, MappedBatteryInput { current_a });
        if square < 0.0 || out.terminal_v < empty_v || out.depleted {
            return f64::from(power_w) * seconds / 3600.0;
        }
        seconds += 1.0;
    }
}
