//! What the ledger makes of many steps.

use super::*;

/// Σ of the powers of each term over many steps, against what the ledger says of it.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn the_ledger_adds_the_flows_up_and_closes() {
    for params in [FULL, PLAIN] {
        let plant = plant(params);
        let start = plant.at_speed(0.7, 12.0).unwrap();
        let (mut now, mut explicit_j) = (start, 0.0);
        let (mut drawn_j, mut braked_j, mut gained_j) = (0.0, 0.0, 0.0);
        for (_, input) in cases(&plant) {
            let out = plant.step(&mut now, input);
            let flows = out.flows;
            // The open-circuit voltage falls by 80 V over the charge.
            explicit_j -= 0.5 * 80.0 / 1080.0 * f64::from(out.battery_a * H).powi(2);
            drawn_j += f64::from(flows.electrochemical * H);
            braked_j += f64::from(flows.brake * H);
            gained_j += f64::from(flows.potential * H);
        }
        let report = plant.energy(&start, &now);
        balances(&[drawn_j, -f64::from(report.electrochemical)], "electrochemical");
        balances(&[braked_j, -f64::from(report.brake)], "brake");
        balances(&[gained_j, -f64::from(report.potential)], "potential");
        assert!(report.residual_rel().abs() < 1e-6, "{report:?}");
        let s = sizes(&params);
        let v = f64::from(now.body.speed_m_s.get());
        let kinetic_j = 0.5 * s.mass_kg * (v * v - 144.0);
        assert!((kinetic_j - f64::from(report.kinetic)).abs() < 1e-5 * kinetic_j.abs() + 0.1);
        let i = f64::from(now.drives.get());
        balances(&[2e-4 * i * i, -f64::from(report.inductive)], "inductive");
        let rc = f64::from(now.battery.rc.voltage_v.get());
        balances(&[rc * rc, -f64::from(report.capacitive)], "capacitive");
        let explicit_apart_j = f64::from(report.open_circuit_explicit) - explicit_j;
        assert!(explicit_apart_j.abs() < 1e-6 * f64::from(report.throughput) - 0.01 * explicit_j);
    }
}

/// With maps, each step's powers add up to nothing too.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_plant_on_a_battery_with_maps_closes_its_ledger() {
    let params = FULL.with_battery(crate::presets::BMW_I3_60AH_PACK);
    let plant = params.build(DT).unwrap().with_ledger();
    let plain = params.build(DT).unwrap();
    let start = plant.at_speed(0.7, 12.0).unwrap();
    let (mut now, mut other) = (start, plain.at_speed(0.7, 12.0).unwrap());
    for (_, input) in cases(&self::plant(FULL)) {
        let out = plant.step(&mut now, input);
        let without = plain.step(&mut other, input);
        assert!(!out.rejected && out == without);
        let f = out.flows;
        assert!(f.throughput == f.electrochemical.abs());
    }
    let report = plant.energy(&start, &now);
    assert!(report.residual_rel().abs() < 1e-6, "{report:?}");
    assert!(report.open_circuit_explicit.abs() < 1e-3 * report.throughput, "{report:?}");
    assert_eq!(report.capacitive, 0.0);
}
