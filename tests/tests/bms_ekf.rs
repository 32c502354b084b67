//! The Kalman filter over long times: rounding, covariance, a flat curve with hysteresis.

use plant_core::battery::{
    BranchMap, HysteresisParams, IdentifiedRange, MappedBattery, MappedBatteryInput,
    MappedBatteryParams, OpenCircuit, OverSoc, ResistanceMap,
};
use plant_core::num::SocTable;
use plant_core::presets::PANASONIC_NCR18650PF;
use plant_core::{Dt, must};
use voltstep_bms::estimate::ekf::{Ekf, EkfInput, EkfParams, EkfState};

/// What single precision may cost in the state of charge.
const ROUNDING_SOC: f64 = 2e-4;
/// What it may cost in the standard deviation, relative: the curve's slope is held for a while, and
/// taken anew a second sooner or later.
const ROUNDING_SD: f64 = 0.02;

/// A filter over ten hours of drives with a recharge after each: state of charge and its standard
/// deviation each hour.
macro_rules! ten_hours {
    ($name:ident, $core:ident, $bms:ident, $real:ty) => {
        #[allow(
            clippy::cast_lossless,
            clippy::cast_precision_loss,
            clippy::useless_conversion,
            clippy::cast_possible_truncation
        )]
        fn $name(rate_hz: u32) -> Vec<[f64; 2]> {
            use $bms::estimate::ekf::{Ekf, EkfInput, EkfParams};
            use $core::battery::{MappedBattery, MappedBatteryInput};
            use $core::presets::PANASONIC_NCR18650PF as CELL;
            let dt = $core::Dt::from_s(1.0 / rate_hz as $real).unwrap();
            let ekf = Ekf::new(EkfParams::typical(CELL, 3.65), dt).unwrap();
            let battery = MappedBattery::new(CELL, dt).unwrap();
            let mut cell = battery.rested(0.9).unwrap();
            let mut state = ekf.start(0.8, 0.1, 25.0).unwrap();
            let mut hours = Vec::new();
            for step in 0..36_000 * rate_hz {
                let second = step / rate_hz;
                // Two hours down with stops, half an hour up.
                let current_a: $real = match (second % 9000, second % 60) {
                    (7200.., _) => -2.9,
                    (_, 0..=9) => 0.0,
                    (_, 10..=39) => 0.9,
                    _ => 0.95,
                };
                let out = battery.step(&mut cell, MappedBatteryInput { current_a });
                // What an ammeter 3 mA off and a voltmeter of 1 mV show, in both precisions.
                let voltage_v = ((out.terminal_v as f64 * 1000.0).round() / 1000.0) as f32;
                ekf.step(
                    &mut state,
                    EkfInput {
                        current_a: current_a + 0.003,
                        voltage_v: voltage_v.into(),
                        temperature_c: 25.0,
                        contactors_open: false,
                    },
                );
                if (step + 1) % (3600 * rate_hz) == 0 {
                    let estimate = ekf.estimate(&state);
                    hours.push([f64::from(estimate.soc), f64::from(estimate.soc_sd)]);
                }
            }
            hours
        }
    };
}

ten_hours!(single, plant_core, voltstep_bms, f32);
ten_hours!(double, plant_core_f64, voltstep_bms_f64, f64);

#[test]
fn single_precision_is_as_good_as_double_over_ten_hours() {
    for rate_hz in [1, 10] {
        let (ours, exact) = (single(rate_hz), double(rate_hz));
        assert_eq!(ours.len(), 10);
        let (mut soc, mut sd) = (0.0_f64, 0.0_f64);
        for ([a, a_sd], [b, b_sd]) in ours.iter().zip(&exact) {
            soc = soc.max((a - b).abs());
            sd = sd.max((a_sd / b_sd - 1.0).abs());
        }
        println!(
            "{rate_hz} Hz: SOC {soc:.1e} (bound {ROUNDING_SOC}), its σ {sd:.1e} ({ROUNDING_SD})"
        );
        assert!(soc <= ROUNDING_SOC && sd <= ROUNDING_SD);
        assert!(exact.iter().all(|[soc, _]| (0.05..0.95).contains(soc)), "{exact:?}");
    }
}

const DT: Dt = must!(Dt::from_s(0.1));

/// Symmetric it is by form; positive it must be.
fn is_sound(state: &EkfState) -> bool {
    let EkfState { own_variance, error_variance_v2, shared_per_v, error_v, .. } = *state;
    own_variance > 0.0
        && own_variance < 10.0
        && error_variance_v2 > 0.0
        && error_variance_v2.is_finite()
        && shared_per_v.is_finite()
        && error_v.is_finite()
        && state.soc().is_finite()
        && state.polarisation_v.iter().all(|v| v.is_finite())
}

#[test]
fn the_covariance_stays_positive_under_ten_million_hostile_samples() {
    let ekf = Ekf::new(EkfParams::typical(PANASONIC_NCR18650PF, 3.65), DT).unwrap();
    let mut state = ekf.start(0.5, 0.2, 25.0).unwrap();
    let mut seed = 1_u64;
    let mut draw = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 32) as u32
    };
    // A part of any bits at all, a part of plausible values, long calms and long storms.
    for k in 0..10_000_000_u32 {
        let (a, b, c) = (draw(), draw(), draw());
        let unit = |bits: u32| f64::from(bits) / f64::from(u32::MAX);
        #[expect(clippy::cast_possible_truncation, reason = "samples are f32")]
        let mut input = EkfInput {
            current_a: (60.0 * unit(a) - 30.0) as f32,
            voltage_v: (2.0 + 3.0 * unit(b)) as f32,
            temperature_c: (100.0 * unit(c) - 40.0) as f32,
            contactors_open: c % 7 == 0,
        };
        match k / 1_000_000 {
            0..=2 => {}
            3 => (input.current_a, input.voltage_v) = (0.0, 3.7),
            4 => (input.current_a, input.voltage_v) = (50.0, 0.0),
            5 => input.current_a = f32::from_bits(a),
            6 => input.voltage_v = f32::from_bits(b),
            _ => {
                input.current_a = f32::from_bits(a);
                input.voltage_v = f32::from_bits(b);
                input.temperature_c = f32::from_bits(c);
            }
        }
        ekf.step(&mut state, input);
        assert!(is_sound(&state), "sample {k}: {input:?} left {state:?}");
    }
    // What it has made of them is nonsense; it must find out, or say so.
    for _ in 0..36_000 {
        ekf.step(
            &mut state,
            EkfInput {
                current_a: 0.0,
                voltage_v: PANASONIC_NCR18650PF.open_circuit.at(0.7),
                temperature_c: 25.0,
                contactors_open: false,
            },
        );
    }
    let estimate = ekf.estimate(&state);
    let right = (estimate.soc - 0.7).abs() <= 3.0 * estimate.soc_sd;
    assert!(right || !ekf.status(&state).consistent, "{estimate:?}");
}

/// A cell as flat as lithium iron phosphate, with its hysteresis.
const FLAT: MappedBatteryParams = MappedBatteryParams {
    open_circuit: OpenCircuit::Table(must!(SocTable::from_points(
        "open_circuit",
        &[
            (0.0, 2.80),
            (0.05, 3.05),
            (0.10, 3.18),
            (0.15, 3.22),
            (0.25, 3.265),
            (0.30, 3.285),
            (0.60, 3.292),
            (0.65, 3.325),
            (0.70, 3.330),
            (0.95, 3.337),
            (1.0, 3.60),
        ]
    ))),
    hysteresis: HysteresisParams { half_gap_v: 0.012, rate_per_soc: 30.0 },
    identified: IdentifiedRange::ALL,
    series: ResistanceMap { resistance_ohm: OverSoc::Constant(0.03), activation_k: 2500.0 },
    polarisation: BranchMap {
        resistance_ohm: OverSoc::Constant(0.01),
        activation_k: 2500.0,
        time_constant_s: 20.0,
    },
    second_polarisation: BranchMap {
        resistance_ohm: OverSoc::Constant(0.02),
        activation_k: 2500.0,
        time_constant_s: 300.0,
    },
    ..PANASONIC_NCR18650PF
};

/// The plateau with its shoulders, for judging: where the voltage is within 50 mV of that at half
/// charge or above 10 %, which three standard deviations of the model's error hide.
const PLATEAU: std::ops::RangeInclusive<f32> = 0.08..=0.96;

#[test]
fn on_a_flat_curve_it_claims_only_what_it_can_know() {
    let dt = Dt::from_s(1.0).unwrap();
    let ekf = Ekf::new(EkfParams::typical(FLAT, 3.29), dt).unwrap();
    let battery = MappedBattery::new(FLAT, dt).unwrap();
    for (start, told) in
        [(0.5, 0.7), (0.5, 0.3), (0.55, 0.35), (0.4, 0.6), (0.9, 0.7), (0.75, 0.95)]
    {
        for direction in [1.0, -1.0] {
            let mut cell = battery.rested(start).unwrap();
            // Where the hysteresis stands is not known: half of the cells were charged last.
            for _ in 0..600 {
                battery.step(&mut cell, MappedBatteryInput { current_a: 0.3 * direction });
            }
            for _ in 0..600 {
                battery.step(&mut cell, MappedBatteryInput { current_a: -0.3 * direction });
            }
            let mut state = ekf.start(told, 0.2, 25.0).unwrap();
            let (mut inside, mut samples, mut since_flat_s) = (0_u32, 0_u32, 0_u32);
            let mut after_plateau = 0.0_f32;
            for second in 0..40_000_u32 {
                let pulse = if second % 50 < 15 { 2.0 } else { 0.4 };
                let out =
                    battery.step(&mut cell, MappedBatteryInput { current_a: direction * pulse });
                let soc = cell.soc.get();
                if !(0.06..=0.99).contains(&soc) {
                    break;
                }
                ekf.step(
                    &mut state,
                    EkfInput {
                        current_a: direction * pulse,
                        voltage_v: out.terminal_v,
                        temperature_c: 25.0,
                        contactors_open: false,
                    },
                );
                let estimate = ekf.estimate(&state);
                let error = (estimate.soc - soc).abs();
                samples += 1;
                inside += u32::from(error <= 3.0 * estimate.soc_sd);
                since_flat_s = if PLATEAU.contains(&soc) { 0 } else { since_flat_s + 1 };
                if since_flat_s >= 60 {
                    after_plateau = after_plateau.max(error);
                }
            }
            let share = f64::from(inside) / f64::from(samples);
            println!(
                "{start} told {told}, {direction}: {share:.4} of {samples} inside 3σ; within \
                 {after_plateau:.3} a minute after the plateau"
            );
            assert!(share >= 0.99, "{start} told {told}, {direction}: {share}");
            // Told 20 % wrong with a standard deviation of 20 %, several places show the same voltage at
            // first: the mean lies between them, within what is claimed.
            assert!(after_plateau <= 0.04, "{start} told {told}, {direction}: {after_plateau}");
        }
    }
}
