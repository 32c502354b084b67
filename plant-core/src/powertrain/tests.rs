//! A step of the coupled plant against the equations of its components, written once more, in
//! double precision, at the end of the step: however the step was found, these must hold.

extern crate std;

mod either;
mod ledger;
mod limits;

use std::vec::Vec;

use super::*;
use crate::auxiliary::AuxiliaryParams;
use crate::battery::{BatteryParams, CurrentLimits, OpenCircuit, RcBranchParams, VoltageLimits};
use crate::converter::ConverterParams;
use crate::machine::dc::DcMotorParams;
use crate::mechanics::body::{BodyParams, Road, RoadResistance};
use crate::mechanics::gearbox::GearboxParams;
use crate::mechanics::slope::Grade;
use crate::mechanics::wheel::WheelParams;
use crate::num::GRAVITY_M_S2;
use crate::port::Slip;

const H: Real = 0.01;
const DT: Dt = crate::must!(Dt::from_s(H));

/// Everything in it, and each factor another number.
const FULL: PowertrainParams = PowertrainParams {
    battery: BatteryParams {
        open_circuit: OpenCircuit::Linear { empty_v: 310.0, full_v: 390.0 },
        capacity_ah: 0.3,
        series_resistance_ohm: 0.12,
        polarisation: RcBranchParams { resistance_ohm: 0.05, capacitance_f: 2.0 },
        discharge_limit_a: 300.0,
        charge_limit_a: 200.0,
        voltage_limits: VoltageLimits::NONE,
    },
    auxiliary: AuxiliaryParams { power_w: 700.0, resistance_ohm: 90.0, cut_out_v: 200.0 },
    drives: DriveParams {
        converter: ConverterParams {
            duty_limit: 1.0,
            constant_loss_w: 300.0,
            voltage_drop_v: 1.5,
            resistance_ohm: 0.004,
            current_limit_a: 800.0,
        },
        motor: DcMotorParams {
            resistance_ohm: 0.03,
            inductance_h: 4e-4,
            back_emf_v_s_per_rad: 0.5,
            torque_nm_per_a: 0.45,
            inertia_kg_m2: 0.04,
            viscous_nm_s_per_rad: 0.01,
            coulomb_nm: 0.7,
        },
        gearbox: GearboxParams { ratio: 7.0, efficiency: 0.95, inertia_kg_m2: 0.02 },
        torque_rate_per_s: TORQUE_RATE_PER_S,
        torque_share: 1.0,
    },
    wheel: WheelParams { radius_m: 0.3, inertia_kg_m2: 2.0, viscous_nm_s_per_rad: 0.3 },
    body: BodyParams {
        mass_kg: 1400.0,
        resistance: RoadResistance::Physical {
            drag_coefficient: 0.3,
            frontal_area_m2: 2.2,
            air_density_kg_m3: 1.2,
            rolling_coefficient: 0.012,
        },
    },
};

/// Neither auxiliary loads nor losses of the converter.
const PLAIN: PowertrainParams = PowertrainParams {
    auxiliary: AuxiliaryParams::NONE,
    drives: DriveParams {
        converter: ConverterParams::IDEAL,
        gearbox: GearboxParams { efficiency: 1.0, ..FULL.drives.gearbox },
        ..FULL.drives
    },
    ..FULL
};

/// Only one thing of each that a plain plant need not look for.
fn with_one_load() -> [PowertrainParams; 5] {
    let (a, c) = (PLAIN.auxiliary, PLAIN.drives.converter);
    let auxiliary = |auxiliary| PowertrainParams { auxiliary, ..PLAIN };
    let converter =
        |converter| PowertrainParams { drives: DriveParams { converter, ..PLAIN.drives }, ..PLAIN };
    [
        auxiliary(AuxiliaryParams { power_w: 700.0, ..a }),
        auxiliary(AuxiliaryParams { resistance_ohm: 90.0, ..a }),
        converter(ConverterParams { constant_loss_w: 300.0, ..c }),
        converter(ConverterParams { voltage_drop_v: 1.5, ..c }),
        converter(ConverterParams { resistance_ohm: 0.004, ..c }),
    ]
}

type Plant = Powertrain<EnergyLedger>;
type State = PowertrainState<EnergyLedger>;

fn plant(params: PowertrainParams) -> Plant {
    Powertrain::new(params, DT).unwrap().with_ledger()
}

/// Numbers in −1..1, the same in every run.
struct Numbers(u32);

impl Numbers {
    fn next(&mut self) -> Real {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as Real / 8_388_608.0 - 1.0
    }
}

/// Many states and inputs, some of them at or near standstill.
fn cases(plant: &Plant) -> Vec<(State, PowertrainInput)> {
    let mut n = Numbers(1);
    let case = |k: usize| {
        let slow = if k.is_multiple_of(3) { 0.01 } else { 1.0 };
        let mut state = plant.at_speed(0.5 + 0.45 * n.next(), 30.0 * slow * n.next()).unwrap();
        state.drives = Accum::new(150.0 * slow * n.next());
        state.battery.rc.voltage_v = Accum::new(3.0 * n.next());
        if k.is_multiple_of(40) {
            state.battery.soc = Accum::new(1e-7 * (1.0 + n.next()));
        }
        state.battery_v += 10.0 * n.next();
        let road = Road {
            grade: Grade::from_sin(0.1 * n.next()),
            headwind_m_s: 10.0 * n.next(),
            brake_n: 1000.0 * (1.0 + n.next()),
            ..Road::default()
        };
        let auxiliary_w = if k.is_multiple_of(2) { 0.0 } else { 1000.0 * (1.0 + n.next()) };
        // Around the duty at which nothing flows, or anything.
        let idle = state.body.speed_m_s.get() * 0.5 * 7.0 / 0.3 / 350.0;
        let duty = if k.is_multiple_of(5) { 1.2 * n.next() } else { idle + 0.05 * n.next() };
        (state, PowertrainInput { road, auxiliary_w, ..PowertrainInput::on(duty) })
    };
    (0..3000).map(case).collect()
}

/// Terms that add up to nothing, but for rounding.
#[track_caller]
fn balances(terms: &[f64], what: &str) {
    let (sum, size): (f64, f64) = (terms.iter().sum(), terms.iter().map(|t| t.abs()).sum());
    assert!(sum.abs() <= 5e-6 * size + 1e-9, "{what}: {sum} of {size}, {terms:?}");
}

/// What `FULL` or `PLAIN` come to at the road.
struct Sizes {
    mass_kg: f64,
    viscous: f64,
    coulomb_n: f64,
    gear_n_per_a: f64,
    kt: f64,
    ke: f64,
    turns: f64,
}

fn sizes(p: &PowertrainParams) -> Sizes {
    let radius = f64::from(p.wheel.radius_m);
    let turns = f64::from(p.drives.gearbox.ratio) / radius;
    let rotor = f64::from(p.drives.motor.inertia_kg_m2) + f64::from(p.drives.gearbox.inertia_kg_m2);
    let kt = f64::from(p.drives.motor.torque_nm_per_a) * turns;
    Sizes {
        mass_kg: f64::from(p.body.mass_kg)
            + f64::from(p.wheel.inertia_kg_m2) / radius.powi(2)
            + rotor * turns.powi(2),
        viscous: f64::from(p.wheel.viscous_nm_s_per_rad) / radius.powi(2)
            + f64::from(p.drives.motor.viscous_nm_s_per_rad) * turns.powi(2),
        coulomb_n: f64::from(p.drives.motor.coulomb_nm) * turns,
        gear_n_per_a: (1.0 - f64::from(p.drives.gearbox.efficiency)) * kt,
        kt,
        ke: f64::from(p.drives.motor.back_emf_v_s_per_rad) * turns,
        turns,
    }
}

/// Checks one step against the equations; `h·F` of each force for the ledger's terms.
#[allow(clippy::too_many_lines, reason = "one equation after the other")]
fn holds(
    p: &PowertrainParams,
    before: &State,
    input: &PowertrainInput,
    now: &State,
    out: &PowertrainOutput,
) {
    let s = sizes(p);
    let h = f64::from(H);
    let value = |sum: Accum| f64::from(sum.get());
    let rise = |now: Accum, before: Accum| f64::from(now.since(before));
    let (v0, v) = (value(before.body.speed_m_s), value(now.body.speed_m_s));
    let (i0, i) = (value(before.drives), value(now.drives));
    let rc = value(now.battery.rc.voltage_v);
    let (bat_a, bat_v, duty) =
        (f64::from(out.battery_a), f64::from(out.battery_v), f64::from(out.drives.duty));

    // Battery.
    let b = &p.battery;
    let ocv = 310.0 + 80.0 * value(before.battery.soc);
    let rs = f64::from(b.series_resistance_ohm);
    let rp = f64::from(b.polarisation.resistance_ohm);
    let c = f64::from(b.polarisation.capacitance_f);
    balances(&[ocv, -rs * bat_a, -rc, -bat_v], "terminals");
    let drc = rise(now.battery.rc.voltage_v, before.battery.rc.voltage_v);
    balances(&[c * drc / h, rc / rp, -bat_a], "polarisation");
    let charge = 3600.0 * f64::from(b.capacity_ah);
    // Give or take what an empty battery is held at zero by.
    let moved_c = charge * rise(now.battery.soc, before.battery.soc) + bat_a * h;
    assert!(moved_c.abs() <= 2e-6 * bat_a.abs() * h + 3e-9 * charge, "charge: {moved_c}");

    // Loads, at the voltage of the step before, and the converter.
    let last_v = f64::from(before.battery_v);
    let power_w = f64::from(p.auxiliary.power_w) + f64::from(input.auxiliary_w);
    let mut resistor_s = 1.0 / f64::from(p.auxiliary.resistance_ohm);
    let mut shunt_s = f64::from(p.drives.converter.constant_loss_w) / last_v.powi(2);
    let mut constant_a = power_w / last_v;
    if out.auxiliary_starved {
        // The same share of each is left.
        let full_a = constant_a + (resistor_s + shunt_s) * bat_v;
        let share = (bat_a - duty * i) / full_a;
        assert!((-1e-6..1.0).contains(&share), "{share}: {out:?}");
        (constant_a, resistor_s, shunt_s) =
            (share * constant_a, share * resistor_s, share * shunt_s);
        let auxiliary_w = (constant_a + resistor_s * bat_v) * bat_v;
        let error_w = (f64::from(out.flows.auxiliary) - auxiliary_w).abs();
        assert!(error_w <= 1e-5 * full_a * bat_v + 1e-5 * (duty * i * bat_v).abs(), "{out:?}");
    }
    balances(&[duty * i, constant_a, (resistor_s + shunt_s) * bat_v, -bat_a], "node");
    let ohm = f64::from(p.drives.converter.resistance_ohm);
    let mut drop_v = f64::from(p.drives.converter.voltage_drop_v);
    let (r, l) = (f64::from(p.drives.motor.resistance_ohm), f64::from(p.drives.motor.inductance_h));
    let di = rise(now.drives, before.drives);
    let driving_v = duty * bat_v - s.ke * v - l * di / h;
    if i == 0.0 && drop_v > 0.0 {
        // Within the converter's drop nothing flows; the speed was the old one there.
        assert!(driving_v.abs() <= drop_v + s.ke * (v - v0).abs() + 1e-3, "{driving_v}");
    } else {
        drop_v *= (driving_v - (r + ohm) * i).signum();
        balances(&[duty * bat_v, -(r + ohm) * i, -drop_v, -s.ke * v, -l * di / h], "winding");
    }

    // Road.
    let wind = f64::from(input.road.headwind_m_s);
    let drag_c = 0.5 * 1.2 * 0.3 * 2.2 * (v0 + wind).abs();
    let (sin, cos) = (f64::from(input.road.grade.sin), f64::from(input.road.grade.cos));
    let weight = f64::from(p.body.mass_kg) * f64::from(GRAVITY_M_S2);
    let rolling = 0.012 * weight * cos;
    let brake = f64::from(input.road.brake_n);
    let gear = s.gear_n_per_a * i0.abs();
    let friction = rolling + brake + s.coulomb_n + gear;
    let dv = rise(now.body.speed_m_s, before.body.speed_m_s);
    let forces =
        [s.kt * i, -drag_c * (v + wind), -s.viscous * v, -weight * sin, -s.mass_kg * dv / h];
    match out.slip {
        Slip::Stuck => {
            assert_eq!(v, 0.0);
            assert!(forces.iter().sum::<f64>().abs() <= friction * (1.0 + 1e-5), "{forces:?}");
        }
        slip => {
            let sign = f64::from(slip.sign());
            assert!(sign * v > 0.0);
            balances(&[&forces[..], &[-sign * friction]].concat(), "forces");
            let moved = rise(now.body.distance_m, before.body.distance_m);
            balances(&[moved, -h * v], "moved");
        }
    }

    // What the step says.
    for (said, wanted) in [
        (out.speed_m_s, v),
        (out.drives.motor_a, i),
        (out.distance_m, value(now.body.distance_m)),
        (out.soc, value(now.battery.soc)),
        (now.battery_v, bat_v),
        (out.open_circuit_v, ocv),
        (out.drives.motor_nm, s.kt / s.turns * i),
        (out.drives.motor_rad_s, s.turns * v),
    ] {
        balances(&[f64::from(said), -wanted], "output");
    }
    let f = &out.flows;
    let vane = drag_c * (v + wind) * v;
    let lost = l * di * di + s.mass_kg * dv * dv + c * drc * drc;
    for (name, said, wanted) in [
        ("electrochemical", f.electrochemical, ocv * bat_a),
        ("series", f.series_joule, rs * bat_a * bat_a),
        ("polarisation", f.polarisation_joule, rc * rc / rp),
        ("converter", f.converter, (ohm * i + drop_v) * i + shunt_s * bat_v * bat_v),
        ("auxiliary", f.auxiliary, (constant_a + resistor_s * bat_v) * bat_v),
        ("copper", f.copper, r * i * i),
        ("conversion", f.conversion, (s.ke - s.kt) * v * i),
        ("viscous", f.viscous, s.viscous * v * v),
        ("coulomb", f.coulomb, s.coulomb_n * v.abs()),
        ("gear", f.gear, gear * v.abs()),
        ("drag", f.drag, vane),
        ("rolling", f.rolling, rolling * v.abs()),
        ("brake", f.brake, brake * v.abs()),
        ("potential", f.potential, weight * sin * v),
        ("numerical", f.numerical, 0.5 * lost / h),
        ("throughput", f.throughput, (ocv * bat_a).abs()),
    ] {
        let apart = (f64::from(said) - wanted).abs();
        assert!(apart <= 1e-5 * wanted.abs() + 1e-2 * (1.0 + dv.abs()), "{name}: {said} {wanted}");
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn every_step_keeps_the_equations_and_the_limits() {
    for params in [FULL, PLAIN].into_iter().chain(with_one_load()) {
        let plant = plant(params);
        let mut seen = [0; 9];
        for (before, input) in cases(&plant) {
            let mut now = before;
            let limits = plant.battery().limits(&before.battery);
            let out = plant.step(&mut now, input);
            assert!(!out.rejected && !out.battery_outside_identified);
            holds(&params, &before, &input, &now, &out);
            let starved = limits.discharge_a < loads_a(&params, &before, &input);
            assert!(starved || !out.auxiliary_starved, "{out:?}");
            let rounding_a = 1e-3 + 1e-3 * out.battery_a.abs();
            assert!(out.battery_a <= limits.discharge_a + rounding_a, "{out:?}");
            let over_a = -out.battery_a - limits.charge_a;
            assert!(over_a <= out.limit_exceeded_a + rounding_a, "{out:?}");
            let (asked, limit) =
                (input.gates.modulation().unwrap(), params.drives.converter.duty_limit);
            match out.limited {
                Limited::No => assert_eq!(out.drives.duty, asked),
                Limited::Duty => {
                    assert!(asked.abs() > limit && out.drives.duty.abs() == limit, "{out:?}");
                }
                Limited::Discharge => {
                    // Braking by drawing may end before, at the charge limit of what is held; and
                    // within the converter's drop nothing flows.
                    let held = (out.battery_a - limits.discharge_a).abs() <= rounding_a;
                    let brakes = out.drives.motor_a * out.drives.motor_rad_s <= 0.0;
                    let fades = before.battery.soc.get() < 1e-3;
                    assert!(held || brakes || fades, "{out:?}");
                }
                Limited::Charge => assert!(
                    out.drives.motor_a * out.drives.motor_rad_s < 0.0,
                    "{before:?} {input:?} {out:?}"
                ),
                Limited::Current => {
                    let held = out.drives.motor_a.abs() - params.drives.converter.current_limit_a;
                    assert!(held <= 1e-3 || out.drives.duty.abs() == limit, "{out:?}");
                }
            }
            // Only what the winding already carried is beyond the limit, or what no duty can hold.
            let carried = before.drives.get().abs() >= out.drives.motor_a.abs();
            assert!(
                out.limit_exceeded_a == 0.0 || carried || out.drives.duty.abs() == limit,
                "{out:?}"
            );
            seen[out.limited as usize] += 1;
            seen[5 + out.slip as usize] += 1;
            seen[8] += usize::from(out.auxiliary_starved);
        }
        // A current limit and loads that starve: only in one.
        let often = |(k, n): (usize, &usize)| *n > 20 || params != FULL && (k == 4 || k == 8);
        assert!(seen.iter().enumerate().all(often), "{seen:?}");
    }
}

/// What is drawn beside the drive \[A\] where this alone decides: nearly empty.
fn loads_a(p: &PowertrainParams, before: &State, input: &PowertrainInput) -> Real {
    let volts = before.battery_v;
    (p.auxiliary.power_w + input.auxiliary_w) / volts
        + (1.0 / p.auxiliary.resistance_ohm + p.drives.converter.constant_loss_w / (volts * volts))
            * 310.0
}

#[test]
fn a_refused_step_changes_nothing_and_says_so() {
    let plant = plant(FULL);
    let good = PowertrainInput::on(0.0);
    for speed in [7.0, 0.0, -7.0] {
        let mut before = plant.at_speed(0.4, speed).unwrap();
        before.drives = Accum::new(33.0);
        let flat = Road::default();
        let road = |road| PowertrainInput { road, ..good };
        let mut bad = std::vec![
            PowertrainInput { auxiliary_w: -1.0, ..good },
            road(Road { brake_n: -1.0, ..flat }),
            road(Road { grade: Grade { sin: 0.0, cos: -1.0 }, ..flat }),
            road(Road { grade: Grade { sin: 5.0, cos: 1.0 }, ..flat }),
            road(Road { grade: Grade::from_ratio(5.0), ..flat }),
        ];
        for x in [Real::NAN, Real::INFINITY, 1e38] {
            bad.extend([
                PowertrainInput::on(x),
                PowertrainInput {
                    limits: CurrentLimits { charge_a: -1.0, ..CurrentLimits::NONE },
                    ..good
                },
                PowertrainInput {
                    limits: CurrentLimits { discharge_a: Real::NAN, ..CurrentLimits::NONE },
                    ..good
                },
                PowertrainInput { auxiliary_w: x, ..good },
                road(Road { headwind_m_s: x, ..flat }),
                road(Road { brake_n: x, ..flat }),
                road(Road { grade: Grade { sin: x, cos: 1.0 }, ..flat }),
                road(Road { grade: Grade { sin: 0.0, cos: x }, ..flat }),
            ]);
        }
        for input in bad {
            let mut now = before;
            let out = plant.step(&mut now, input);
            assert!(out.rejected && now == before, "{input:?}");
            assert_eq!((out.speed_m_s, out.distance_m, out.soc), (speed, 0.0, 0.4));
            assert_eq!((out.drives.duty, out.battery_a, out.limited), (0.0, 0.0, Limited::No));
            assert_eq!((out.battery_v, out.drives.motor_a), (before.battery_v, 33.0));
            assert_eq!(out.drives.motor_nm, FULL.drives.motor.torque_nm_per_a * 33.0);
            assert_eq!(out.drives.motor_rad_s, plant.motor_rad_per_m() * speed);
            assert_eq!(out.slip.sign(), speed.signum() * Real::from(speed != 0.0));
            assert!(
                out.flows == crate::powertrain::ledger::Flows::default() && !out.auxiliary_starved
            );
        }
    }
}

/// At standstill without current nothing else shows that an input was absurd.
#[test]
fn what_standstill_would_swallow_is_refused() {
    let plant = plant(PLAIN);
    let before = plant.at_rest(0.5).unwrap();
    for (auxiliary_w, headwind_m_s, brake_n) in
        [(0.0, 0.0, 1.5e9), (0.0, 0.7e9, 0.7e9), (100.0, 0.0, 1.5e9), (0.0, 0.0, 1e30)]
    {
        let road = Road { headwind_m_s, brake_n, ..Road::default() };
        let mut now = before;
        let out =
            plant.step(&mut now, PowertrainInput { road, auxiliary_w, ..PowertrainInput::on(0.0) });
        assert!(out.rejected && now == before, "{auxiliary_w} {road:?}");
    }
}

#[test]
fn says_what_it_is_and_where_it_starts() {
    let (plant, s) = (plant(FULL), sizes(&FULL));
    balances(&[f64::from(plant.moving_mass_kg()), -s.mass_kg], "mass");
    balances(&[f64::from(plant.motor_rad_per_m()), -s.turns], "turns");
    assert_eq!(plant.battery(), &Battery::new(FULL.battery, DT).unwrap());
    let state = plant.at_speed(0.25, 3.0).unwrap();
    let seen = plant.feedback(&state);
    assert_eq!((seen.speed_m_s, seen.motor_a, seen.soc), (3.0, 0.0, 0.25));
    assert_eq!((seen.battery_v, seen.duty, seen.limited), (330.0, 0.0, false));
    assert_eq!(plant.at_rest(0.25).unwrap(), plant.at_speed(0.25, 0.0).unwrap());
    let mut polarised = state.battery;
    polarised.rc.voltage_v = Accum::new(3.0);
    assert_eq!(plant.battery().capacitive_j(&polarised), 9.0);
    assert!(plant.at_rest(1.1).is_err() && plant.at_speed(0.5, Real::NAN).is_err());
}
