//! A vehicle with a synchronous machine, and one with two axles.

extern crate std;

use std::vec::Vec;

use super::*;
use crate::battery::{BatteryState, CurrentLimits};
use crate::converter::Gates;
use crate::machine::pmsm::PmsmParams;
use crate::mechanics::body::Road;
use crate::mechanics::slope::Grade;
use crate::powertrain::ledger::EnergyLedger;
use crate::powertrain::{
    Drive, DriveParams, Drives, Limited, Powertrain, PowertrainInput, PowertrainOutput,
    PowertrainParams, PowertrainState,
};
use crate::presets::{BMW_I3_60AH_PMSM, TWO_AXLES};

type Plant = Powertrain<EnergyLedger, crate::battery::Battery, Drive<PmsmDrive>>;
type State = PowertrainState<EnergyLedger, BatteryState, DqCurrents>;

const CAR: PowertrainParams<crate::battery::BatteryParams, DriveParams<PmsmParams>> =
    BMW_I3_60AH_PMSM.powertrain;

fn dt(dt_s: Real) -> Dt {
    Dt::from_s(dt_s).unwrap()
}

fn plant(dt_s: Real) -> Plant {
    CAR.build(dt(dt_s)).unwrap().with_ledger()
}

fn torque(torque_nm: Real) -> PowertrainInput<Gates<Dq>> {
    PowertrainInput::with(Gates::Torque(torque_nm))
}

fn held(
    plant: &Plant,
    state: &mut State,
    input: PowertrainInput<Gates<Dq>>,
    steps: u32,
) -> PowertrainOutput<PmsmDriveOutput> {
    let mut out = plant.step(state, input);
    for _ in 1..steps {
        out = plant.step(state, input);
    }
    out
}

/// Forwards, backwards, driving and braking, below base speed and above: the torque asked for, and
/// what the bus gives is what the ledger names.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_torque_is_what_was_asked_for_and_every_joule_is_named() {
    for dt_s in [1e-4, 1e-3, 1e-2] {
        for (speed_m_s, torque_nm) in
            [(3.0, 200.0), (10.0, -80.0), (-8.0, 90.0), (-8.0, -90.0), (30.0, 60.0), (38.0, -40.0)]
        {
            let plant = plant(dt_s);
            let mut state = plant.at_speed(0.7, speed_m_s).unwrap();
            let start = state;
            let out = held(&plant, &mut state, torque(torque_nm), (0.3 / dt_s) as u32);
            assert_eq!(out.limited, Limited::No, "{dt_s} {speed_m_s} {torque_nm}: {out:?}");
            let error = (out.drives.motor_nm / torque_nm - 1.0).abs();
            assert!(error < 0.01, "{dt_s} {speed_m_s} {torque_nm}: {out:?}");
            let report = plant.energy(&start, &state);
            // The kinetic energy itself is known to some of its last bits only.
            let kinetic_j = 0.5 * plant.moving_mass_kg() * speed_m_s * speed_m_s;
            let rounding_j = 1e-6 * report.throughput + 2e-7 * kinetic_j;
            assert!(report.residual.abs() < rounding_j, "{dt_s} {speed_m_s}: {report:?}");
            assert!(report.copper > 0.0 && report.iron > 0.0 && report.numerical >= 0.0);
            // Of least current, or with the field weakened.
            let Dq { d, q } = out.drives.current_a;
            let least = -1e-4 * q * q / (0.02 + sqrt(4e-4 + 1e-8 * q * q));
            assert_eq!(d < 1.1 * least - 1.0, speed_m_s.abs() > 25.0, "{least}: {out:?}");
        }
    }
}

/// A limit of the battery, its own or asked for: the current stands at it and nothing flips.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_battery_current_stands_at_its_limit_at_any_step() {
    for dt_s in [1e-5, 1e-4, 1e-3, 1e-2] {
        for (speed_m_s, torque_nm, discharge_a, charge_a) in
            [(20.0, 200.0, 60.0, 150.0), (20.0, -87.0, 400.0, 30.0), (32.0, -80.0, 400.0, 40.0)]
        {
            let plant = plant(dt_s);
            let mut state = plant.at_speed(0.7, speed_m_s).unwrap();
            let limits = CurrentLimits { discharge_a, charge_a };
            let input = PowertrainInput { limits, ..torque(torque_nm) };
            let settled = (0.15 / dt_s) as u32;
            let mut last = held(&plant, &mut state, input, settled);
            let (limit_a, sign) =
                if torque_nm > 0.0 { (discharge_a, 1.0) } else { (charge_a, -1.0) };
            let (mut rise, mut flips) = (0.0, 0);
            for _ in 0..settled.min(2000) {
                let out = plant.step(&mut state, input);
                assert!((sign * out.battery_a / limit_a - 1.0).abs() < 0.01, "{dt_s}: {out:?}");
                let step = out.drives.modulation.q - last.drives.modulation.q;
                flips += u32::from(step * rise < 0.0 && step.abs().min(rise.abs()) > 1e-3);
                (last, rise) = (out, step);
            }
            assert!(
                flips == 0 && last.limited != Limited::No,
                "{dt_s} {speed_m_s}: {flips} {last:?}"
            );
        }
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn gates_off_let_nothing_flow_below_base_speed_and_feed_the_bus_above() {
    for dt_s in [1e-4, 1e-3] {
        let plant = plant(dt_s);
        let mut state = plant.at_speed(0.7, 20.0).unwrap();
        held(&plant, &mut state, torque(100.0), 200);
        let out = held(&plant, &mut state, PowertrainInput::default(), 2);
        assert_eq!((out.drives.current_a, out.drives.motor_nm), (Dq::ZERO, 0.0), "{out:?}");
        // 48 m/s: the magnets alone induce 1.5 times what the bus holds.
        let mut state = plant.at_speed(0.5, 48.0).unwrap();
        let start = state;
        let out = held(&plant, &mut state, PowertrainInput::default(), (0.2 / dt_s) as u32);
        assert!(out.battery_a < -20.0 && out.drives.motor_nm < -20.0, "{dt_s}: {out:?}");
        let voltage = out.drives.modulation.length();
        assert!((voltage - 1.0).abs() < 0.01, "{dt_s}: {voltage}");
        let report = plant.energy(&start, &state);
        assert!(report.residual_rel().abs() < 1e-5, "{dt_s}: {report:?}");
    }
}

/// Shorted terminals, rolling: what is stored never grows, at any step.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn without_a_source_nothing_grows() {
    for dt_s in [1e-5, 1e-3, 0.1, 10.0] {
        let plant = plant(dt_s);
        for speed_m_s in [-40.0, 5.0, 30.0] {
            let mut state = plant.at_speed(0.7, speed_m_s).unwrap();
            state.drives.q_a = Accum::new(150.0);
            let stored = |s: &State| {
                let (i, v) = (s.drives.get(), s.body.speed_m_s.get());
                0.75 * (1e-4 * i.d * i.d + 2e-4 * i.q * i.q) + 0.5 * plant.moving_mass_kg() * v * v
            };
            let mut last_j = stored(&state);
            for _ in 0..100 {
                plant.step(&mut state, PowertrainInput::with(Gates::On(Dq::ZERO)));
                let now_j = stored(&state);
                assert!(now_j <= last_j * (1.0 + 1e-6), "{dt_s} {speed_m_s}: {now_j} {last_j}");
                last_j = now_j;
            }
        }
    }
}

/// Two axles: what one bus gives is shared, the torques add at the road, and the ledger closes.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn two_axles_share_a_bus_and_a_road() {
    for dt_s in [1e-4, 1e-3, 1e-2] {
        let plant = TWO_AXLES.powertrain.build(dt(dt_s)).unwrap().with_ledger();
        for (torque_nm, discharge_a, charge_a) in
            [(150.0, 400.0, 150.0), (150.0, 80.0, 150.0), (-100.0, 400.0, 40.0)]
        {
            let mut state = plant.at_speed(0.7, 15.0).unwrap();
            let start = state;
            let limits = CurrentLimits { discharge_a, charge_a };
            let command = plant.drives().command(torque_nm);
            let input = PowertrainInput { limits, ..PowertrainInput::with(command) };
            let mut out = plant.step(&mut state, input);
            let mut modulations = Vec::new();
            for _ in 0..(0.3 / dt_s) as u32 {
                out = plant.step(&mut state, input);
                modulations.push(out.drives.1.duty);
            }
            let report = plant.energy(&start, &state);
            let kinetic_j = 0.5 * plant.moving_mass_kg() * 15.0 * 15.0;
            let rounding_j = 1e-6 * report.throughput + 2e-7 * kinetic_j;
            assert!(report.residual.abs() < rounding_j, "{dt_s} {torque_nm}: {report:?}");
            let total_nm = plant.drives().torque_nm(&out.drives);
            if discharge_a == 400.0 && charge_a == 150.0 {
                assert_eq!(out.limited, Limited::No);
                assert!((total_nm / torque_nm - 1.0).abs() < 0.02, "{dt_s}: {total_nm}");
                let rear = out.drives.0.motor_nm / total_nm;
                assert!((rear - 0.7).abs() < 0.02, "{dt_s}: {rear}");
            } else {
                let limit_a = if torque_nm > 0.0 { discharge_a } else { -charge_a };
                assert!((out.battery_a / limit_a - 1.0).abs() < 0.01, "{dt_s}: {out:?}");
                assert!(total_nm.abs() < 0.99 * torque_nm.abs());
                let late = &modulations[modulations.len() / 2..];
                let turns = late.windows(3).filter(|m| {
                    let (a, b) = (m[1] - m[0], m[2] - m[1]);
                    a * b < 0.0 && a.abs().min(b.abs()) > 1e-3
                });
                assert_eq!(turns.count(), 0, "{dt_s} {torque_nm}");
            }
        }
    }
}

#[test]
fn hills_hold_and_refusals_change_nothing() {
    let plant = plant(1e-3);
    let mut state = plant.at_rest(0.7).unwrap();
    let road = Road { grade: Grade::from_sin(0.1), brake_n: 5000.0, ..Road::default() };
    let out = held(&plant, &mut state, PowertrainInput { road, ..torque(0.0) }, 50);
    assert!(out.speed_m_s == 0.0 && !out.drives.coarse_step, "{out:?}");
    let before = state;
    for bad in [
        torque(Real::NAN),
        torque(1e38),
        PowertrainInput::with(Gates::On(Dq { d: Real::NAN, q: 0.0 })),
        PowertrainInput { auxiliary_w: -1.0, ..torque(1.0) },
    ] {
        let out = plant.step(&mut state, bad);
        assert!(out.rejected || bad.gates == Gates::Torque(1e38), "{out:?}");
        assert!(state.battery.soc.get().is_finite() && state.drives.get().d.is_finite());
        state = before;
    }
}

#[test]
fn refuses_each_bad_field_by_name() {
    let refused = |drives: DriveParams<PmsmParams>| {
        CAR.with_drives(drives).build(dt(1e-3)).err().map(crate::ParamError::field)
    };
    let good = CAR.drives;
    let converter = |converter| DriveParams { converter, ..good };
    let c = good.converter;
    for (params, field) in [
        (converter(ConverterParams { voltage_drop_v: 1.0, ..c }), "converter.voltage_drop_v"),
        (converter(ConverterParams { resistance_ohm: -1.0, ..c }), "converter.resistance_ohm"),
        (converter(ConverterParams { current_limit_a: 0.0, ..c }), "converter.current_limit_a"),
        (converter(ConverterParams { duty_limit: Real::NAN, ..c }), "converter.duty_limit"),
        (DriveParams { torque_rate_per_s: 0.0, ..good }, "drive.torque_rate_per_s"),
        (DriveParams { torque_share: -1.0, ..good }, "drive.torque_share"),
        (
            DriveParams { motor: PmsmParams { resistance_ohm: 0.0, ..good.motor }, ..good },
            "pmsm.resistance_ohm",
        ),
    ] {
        assert_eq!(refused(params), Some(field));
    }
}
