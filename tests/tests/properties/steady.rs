//! The steady state does not depend on the step: one first-order step is exact where nothing
//! changes.

use plant_core::battery::{BatteryParams, OpenCircuit, RcBranchParams, VoltageLimits};
use plant_core::converter::ConverterParams;
use plant_core::powertrain::{Powertrain, PowertrainInput, PowertrainOutput, PowertrainParams};
use plant_core::{Dt, Real};
use proptest::prelude::*;

use crate::check::cases;
use crate::draw::{self, Draw, PLAUSIBLE, drawn};

/// How long all of it takes to settle \[s\], and how many steps at least: where a step is long,
/// drag is taken at the speed of the step before, and the speed rings.
const SETTLED_S: f64 = 20.0;
const SETTLED_STEPS: u32 = 5000;
/// How far two steady states may be apart, in shares of themselves.
const SAME: Real = 1e-4;
/// The last two bits of a voltage, in shares of it.
const LAST_BITS: Real = 2.4e-7;

/// A plant on the bench: light enough to settle within seconds, its battery too large to be
/// drained and with one voltage over all of its charge. No limits, as the start may exceed them,
/// and no cut-out, at which a voltage would never settle.
fn bench(d: &mut Draw) -> PowertrainParams {
    let mut plant = draw::plant(d);
    let time_s = d.near(0.1);
    let empty_v = d.near(300.0);
    plant.battery = BatteryParams {
        open_circuit: OpenCircuit::Linear { empty_v, full_v: empty_v },
        capacity_ah: 1e7,
        polarisation: RcBranchParams { resistance_ohm: 0.02, capacitance_f: d.near(5.0) },
        discharge_limit_a: Real::INFINITY,
        charge_limit_a: Real::INFINITY,
        voltage_limits: VoltageLimits::NONE,
        ..plant.battery
    };
    plant.auxiliary.cut_out_v = 1.0;
    plant.drives.converter = ConverterParams { duty_limit: 1.0, ..plant.drives.converter };
    let per_m = plant.drives.gearbox.ratio / plant.wheel.radius_m;
    let n_s_per_m = (plant.drives.motor.back_emf_v_s_per_rad * per_m).powi(2) / series_ohm(&plant);
    plant.body.mass_kg = time_s * n_s_per_m;
    plant.drives.motor.inertia_kg_m2 = 1e-3;
    plant.wheel.inertia_kg_m2 = 0.0;
    plant.drives.gearbox.inertia_kg_m2 = 0.0;
    plant
}

/// All that the current passes at full duty \[Ω\].
fn series_ohm(plant: &PowertrainParams) -> Real {
    plant.drives.motor.resistance_ohm
        + plant.drives.converter.resistance_ohm
        + plant.battery.series_resistance_ohm
        + plant.battery.polarisation.resistance_ohm
}

/// The state after long enough at a constant duty on a flat road.
fn settled(params: PowertrainParams, dt_s: f64, duty: Real) -> PowertrainOutput {
    let plant = Powertrain::new(params, Dt::from_s(dt_s as Real).unwrap()).unwrap();
    let mut s = plant.at_rest(0.5).unwrap();
    let input = PowertrainInput::on(duty);
    let steps = (SETTLED_S / dt_s) as u32 + SETTLED_STEPS;
    for _ in 1..steps {
        plant.step(&mut s, input);
    }
    plant.step(&mut s, input)
}

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn speed_and_currents_settle_where_they_do_at_any_step(
        params in drawn(PLAUSIBLE, bench),
        duty in -1.0..1.0_f32,
    ) {
        let reference = settled(params, 1e-2, duty);
        // The last bits of a voltage, as currents: they are differences of voltages.
        let last_bits_a = LAST_BITS * reference.open_circuit_v / params.drives.motor.resistance_ohm;
        for dt_s in [1e-4, 1e-3, 1.0] {
            let out = settled(params, dt_s, duty);
            for (name, at, expected, last_bits) in [
                ("speed", out.speed_m_s, reference.speed_m_s, 0.0),
                ("battery voltage", out.battery_v, reference.battery_v, 0.0),
                ("motor current", out.drives.motor_a, reference.drives.motor_a, last_bits_a),
                ("battery current", out.battery_a, reference.battery_a, last_bits_a),
            ] {
                let off = (at - expected).abs();
                prop_assert!(off <= SAME * expected.abs() + last_bits, "{name} at {dt_s}: {at} {expected}");
            }
        }
    }
}
