//! The capacity where one of the pairs that it is learnt from is wrong.

use plant_core::Dt;
use voltstep_bms::Estimate;
use voltstep_bms::estimate::soh::{CapacityEstimator, CapacityInput, CapacityParams};

use super::random::Random;
use super::tally::{Said, Tally};

const NOMINAL_AH: f32 = 2.5;
/// How well it was known when new, and the state of charge at either end of a pair.
const NOMINAL_SD: f32 = 0.1;
const SOC_SD: f32 = 0.01;
const OFFSET_SD_A: f32 = 0.005 * NOMINAL_AH;
/// A pair takes this long \[s\].
const PAIR_S: f32 = 4.0 * 3600.0;
const PAIRS: u32 = 20;

/// Runs the pairs of a seed.
///
/// # Panics
/// Where the estimator refuses its parameters: a mistake in the matrix itself.
pub fn run(seed: u64) -> Tally {
    let mut random = Random::new(seed);
    let params = CapacityParams {
        nominal_ah: NOMINAL_AH,
        nominal_sd_ah: NOMINAL_SD * NOMINAL_AH,
        current_noise_sd_a: 0.01,
        current_offset_sd_a: OFFSET_SD_A,
        current_gain_sd: 0.005,
        least_soc_change: 0.1,
        least_soc_change_sds: 3.0,
        memory_pairs: 50.0,
    };
    let dt = Dt::from_s(0.1).expect("a time");
    let estimator = CapacityEstimator::new(params, dt).expect("an estimator");
    let truth_ah = NOMINAL_AH * (1.0 + NOMINAL_SD * random.normal());
    let gain = 1.0 + params.current_gain_sd * random.normal();
    let bad = random.count(0..PAIRS);
    let mut state = estimator.unknown();
    let mut tally = Tally::default();
    for pair in 0..PAIRS {
        let (high, low) = (0.6 + 0.35 * random.even(), 0.1 + 0.3 * random.even());
        let (from, to) = if random.even() < 0.5 { (high, low) } else { (low, high) };
        let mut told = |soc| Estimate::rested(soc + SOC_SD * random.normal(), SOC_SD, 25.0);
        let (start, end) = (told(from), told(to));
        let counted_ah = truth_ah * (from - to) + OFFSET_SD_A * random.normal() * PAIR_S / 3600.0;
        let factor =
            if pair == bad { random.one_of(&[-1.0, 0.0, 0.2, 0.5, 2.0, 5.0]) } else { 1.0 };
        let input = CapacityInput {
            start,
            end,
            discharged_ah: gain * factor * counted_ah,
            duration_s: PAIR_S,
        };
        let out = estimator.step(&mut state, input);
        let said = Said {
            value: f64::from(out.capacity_ah / NOMINAL_AH),
            sd: f64::from(out.capacity_sd_ah / NOMINAL_AH),
            contradicted: out.contradicted,
            outside_known: false,
        };
        tally.book(said, f64::from(truth_ah / NOMINAL_AH), f64::from(PAIR_S));
    }
    tally
}
