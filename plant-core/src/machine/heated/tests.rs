//! A drive with temperatures: the bits of the machine alone where they do nothing, the balance of
//! heat, the resistance, the derating.

extern crate std;

use super::*;
use crate::battery::{BatteryParams, CurrentLimits};
use crate::machine::dc::{DcDrive, DcMotorParams};
use crate::machine::pmsm::PmsmParams;
use crate::mechanics::body::RoadResistance;
use crate::powertrain::{
    Drive, DriveParams, Drives, DrivesParams, HeatedDriveParams, Limited, Powertrain,
    PowertrainInput, PowertrainParams,
};
use crate::presets::{BMW_I3_60AH_CONSTANT, BMW_I3_60AH_PMSM};

const PART: HeatedPartParams = HeatedPartParams {
    heat_capacity_j_per_k: 500.0,
    coolant_k_per_w: 0.02,
    derate_from_c: 90.0,
    derate_to_c: 130.0,
};
const THERMAL: DriveThermalParams = DriveThermalParams {
    coolant_c: 30.0,
    machine: PART,
    inverter: HeatedPartParams { heat_capacity_j_per_k: 300.0, ..PART },
    winding: Conductor::COPPER,
};

fn dt(dt_s: Real) -> Dt {
    Dt::from_s(dt_s).unwrap()
}

fn heated<M: Copy>(
    car: PowertrainParams<BatteryParams, DriveParams<M>>,
    thermal: DriveThermalParams,
) -> PowertrainParams<BatteryParams, HeatedDriveParams<M>> {
    car.with_drives(HeatedDriveParams { drive: car.drives, thermal })
}

/// Torque both ways, gates off for a while, limits of the battery that act.
fn input<C: Copy + Default>(n: u16, command: impl Fn(Real) -> C) -> PowertrainInput<C> {
    let torque_nm = if n % 1000 < 500 { 240.0 } else { -150.0 };
    let gates = if (2200..2300).contains(&n) { C::default() } else { command(torque_nm) };
    let limits = CurrentLimits { discharge_a: 60.0 + Real::from(n), charge_a: 30.0 };
    PowertrainInput { limits, ..PowertrainInput::with(gates) }
}

/// At the temperature at which its resistance was given, and below that at which it is derated, a
/// drive is what it is without temperatures, though they change.
fn bits_of<M: Copy + core::fmt::Debug>(car: PowertrainParams<BatteryParams, DriveParams<M>>)
where
    DriveParams<M>: DrivesParams<Drives: Drives<Output: PartialEq + core::fmt::Debug>>,
    HeatedDriveParams<M>: DrivesParams,
    <HeatedDriveParams<M> as DrivesParams>::Drives: Drives<
            State = HeatedState<<<DriveParams<M> as DrivesParams>::Drives as Drives>::State>,
            Output = HeatedOutput<<<DriveParams<M> as DrivesParams>::Drives as Drives>::Output>,
        >,
    <<DriveParams<M> as DrivesParams>::Drives as Drives>::State: PartialEq + core::fmt::Debug,
{
    let part = HeatedPartParams { derate_from_c: 900.0, derate_to_c: 950.0, ..PART };
    let warming = DriveThermalParams {
        machine: part,
        inverter: part,
        winding: Conductor::CONSTANT,
        ..THERMAL
    };
    for (thermal, warms) in [(DriveThermalParams::NONE, false), (warming, true)] {
        let (plain, warm) =
            (car.build(dt(1e-3)).unwrap(), heated(car, thermal).build(dt(1e-3)).unwrap());
        let (mut a, mut b) = (plain.at_speed(0.6, 8.0).unwrap(), warm.at_speed(0.6, 8.0).unwrap());
        let mut limited = 0;
        for n in 0..4000 {
            let x = plain.step(&mut a, input(n, |t| plain.drives().command(t)));
            let y = warm.step(&mut b, input(n, |t| warm.drives().command(t)));
            assert!(!x.rejected && !y.rejected, "{n}");
            limited += u16::from(x.limited != Limited::No);
            assert_eq!((a.battery, a.body, a.battery_v), (b.battery, b.body, b.battery_v), "{n}");
            assert_eq!(a.drives, b.drives.machine, "{n}");
            assert_eq!((x.limited, x.flows), (y.limited, y.flows), "{n}");
            assert_eq!(x.drives, y.drives.machine, "{n}");
        }
        assert!(limited > 100 && limited < 3900, "{limited}");
        assert_eq!(b.drives.machine_above_k.get() > 5.0, warms, "{:?}", b.drives);
        assert_eq!(b.drives.inverter_above_k.get() > 1.0, warms, "{:?}", b.drives);
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn without_effect_the_bits_are_those_of_the_machine_alone() {
    bits_of::<DcMotorParams>(BMW_I3_60AH_CONSTANT.powertrain);
    bits_of::<PmsmParams>(BMW_I3_60AH_PMSM.powertrain);
}

/// What the nodes hold and gave to the coolant is what the ledger says that converter, winding, iron
/// and shaft lost.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn all_that_the_ledger_calls_heat_is_in_the_nodes_or_the_coolant() {
    fn balance<M: HeatedMachine>(
        plant: Powertrain<crate::powertrain::ledger::NoLedger, crate::Battery, Drive<Heated<M>>>,
        thermal: DriveThermalParams,
        viscous: Real,
        dt_s: Real,
    ) {
        let plant = plant.with_ledger();
        let start = plant.at_speed(0.6, 8.0).unwrap();
        let (mut state, mut cooled_j, mut friction_j) = (start, [0.0_f64; 2], 0.0_f64);
        for n in 0..4000 {
            let out = plant.step(&mut state, input(n, |t| plant.drives().command(t)));
            assert!(
                !out.rejected && out.drives.temperatures.left == 1.0,
                "{n}: {out:?}",
                out = out.limited
            );
            let above = [state.drives.machine_above_k, state.drives.inverter_above_k];
            for (sum, above_k) in cooled_j.iter_mut().zip(above) {
                *sum += f64::from(above_k.get() / PART.coolant_k_per_w * dt_s);
            }
            let speed = f64::from(out.speed_m_s * plant.motor_rad_per_m());
            friction_j += f64::from(viscous) * speed * speed * f64::from(dt_s);
        }
        let report = plant.energy(&start, &state);
        let held = |c: HeatedPartParams, k: Accum| f64::from(c.heat_capacity_j_per_k * k.get());
        let machine_j = held(thermal.machine, state.drives.machine_above_k) + cooled_j[0];
        let lost_j = f64::from(report.copper) + f64::from(report.iron) + friction_j;
        assert!((machine_j / lost_j - 1.0).abs() < 3e-6, "{machine_j} {lost_j}");
        let inverter_j = held(thermal.inverter, state.drives.inverter_above_k) + cooled_j[1];
        let lost_j = f64::from(report.converter);
        assert!((inverter_j / lost_j - 1.0).abs() < 3e-6, "{inverter_j} {lost_j}");
        assert!(report.residual.abs() < 2e-6 * report.throughput, "{report:?}");
    }
    let part =
        |p: HeatedPartParams| HeatedPartParams { derate_from_c: 500.0, derate_to_c: 600.0, ..p };
    let thermal = DriveThermalParams {
        machine: part(THERMAL.machine),
        inverter: part(THERMAL.inverter),
        ..THERMAL
    };
    for dt_s in [1e-3, 1e-2] {
        let dc = heated(BMW_I3_60AH_CONSTANT.powertrain, thermal).build(dt(dt_s)).unwrap();
        balance(dc, thermal, 5e-4, dt_s);
        let pmsm = heated(BMW_I3_60AH_PMSM.powertrain, thermal).build(dt(dt_s)).unwrap();
        balance(pmsm, thermal, 5e-4, dt_s);
    }
}

/// A converter's constant loss heats it.
#[test]
fn a_constant_loss_heats_the_inverter() {
    let mut car = BMW_I3_60AH_CONSTANT.powertrain;
    car.drives.converter.constant_loss_w = 200.0;
    let plant = heated(car, THERMAL).build(dt(1e-2)).unwrap();
    let mut state = plant.at_rest(0.6).unwrap();
    for _ in 0..10_000 {
        plant.step(&mut state, PowertrainInput::default());
    }
    // 4 K, with a time constant of 6 s.
    assert!((state.drives.inverter_above_k.get() - 4.0).abs() < 1e-3, "{:?}", state.drives);
    assert_eq!(state.drives.machine_above_k.get(), 0.0);
}

#[test]
fn a_warm_winding_resists_more() {
    let plant = heated(BMW_I3_60AH_CONSTANT.powertrain, THERMAL).build(dt(1e-3)).unwrap();
    let copper_ohm = |above_k| {
        let mut state = plant.at_speed(0.6, 5.0).unwrap();
        state.drives.machine = Accum::new(400.0);
        state.drives.machine_above_k = Accum::new(above_k);
        let out = plant.step(&mut state, PowertrainInput::with(Gates::Torque(108.0)));
        out.flows.copper / (out.drives.machine.motor_a * out.drives.machine.motor_a)
    };
    let (cold, warm) = (copper_ohm(-10.0), copper_ohm(45.0));
    assert!((cold / 5e-3 - 1.0).abs() < 1e-5, "{cold}");
    assert!((warm / cold - 310.0 / 255.0).abs() < 1e-5, "{warm} {cold}");
}

/// Between its temperatures a drive gives what is left of the limit, above them nothing, and says
/// so; cold it gives all.
fn derated<M: HeatedMachine>(
    plant: &Powertrain<crate::powertrain::ledger::NoLedger, crate::Battery, Drive<Heated<M>>>,
    limit_a: Real,
) {
    for (machine_c, inverter_c, left) in [
        (30.0, 30.0, 1.0),
        (90.0, 60.0, 1.0),
        (120.0, 95.0, 0.25),
        (50.0, 110.0, 0.5),
        (131.0, 30.0, 0.0),
    ] {
        for torque_nm in [240.0, -240.0] {
            let mut state = plant.at_speed(0.6, 10.0).unwrap();
            let hold = |state: &mut HeatedState<M::State>| {
                state.machine_above_k = Accum::new(machine_c - 30.0);
                state.inverter_above_k = Accum::new(inverter_c - 30.0);
            };
            let mut out = plant.step(&mut state, PowertrainInput::default());
            for n in 0..300 {
                hold(&mut state.drives);
                let command = plant.drives().command(torque_nm);
                out = plant.step(&mut state, PowertrainInput::with(command));
                let (_, current_a) = M::duty_and_current(&out.drives.machine);
                assert!(current_a.abs() <= limit_a * left * 1.0001, "{n} {machine_c}: {current_a}");
            }
            let (_, current_a) = M::duty_and_current(&out.drives.machine);
            assert_eq!(out.limited == Limited::Current, left < 1.0, "{machine_c}: {current_a}");
            if left < 1.0 {
                assert!(current_a.abs() >= limit_a * left * 0.999, "{machine_c}: {current_a}");
            } else {
                let torque = M::torque_nm(&out.drives.machine);
                assert!((torque / torque_nm - 1.0).abs() < 0.01, "{torque}");
            }
        }
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_hot_part_derates_the_current_in_both_directions() {
    let unlimited = |car: &mut BatteryParams| {
        (car.discharge_limit_a, car.charge_limit_a) = (1e9, 1e9);
    };
    let mut car = BMW_I3_60AH_CONSTANT.powertrain;
    unlimited(&mut car.battery);
    derated::<DcDrive>(&heated(car, THERMAL).build(dt(1e-3)).unwrap(), 1000.0);
    let mut car = BMW_I3_60AH_PMSM.powertrain;
    unlimited(&mut car.battery);
    derated(&heated(car, THERMAL).build(dt(1e-3)).unwrap(), 600.0);
}

/// Left to itself under a torque that would overheat it, the drive settles where what is left of the
/// torque makes just the heat that the coolant takes: no step turns the current around.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_derated_drive_settles() {
    let mut car = BMW_I3_60AH_CONSTANT.powertrain;
    car.drives.converter.resistance_ohm = 0.0;
    car.drives.converter.voltage_drop_v = 0.0;
    (car.battery.discharge_limit_a, car.body.mass_kg) = (1e9, 1e8);
    // Nothing slows it down, and hardly anything makes it faster.
    car.body.resistance = RoadResistance::Physical {
        drag_coefficient: 0.0,
        frontal_area_m2: 0.0,
        air_density_kg_m3: 0.0,
        rolling_coefficient: 0.0,
    };
    let plant = heated(car, THERMAL).build(dt(1e-2)).unwrap();
    let mut state = plant.at_speed(0.6, 5.0).unwrap();
    let (mut last_a, mut turns, mut warm) = (Real::MAX, 0, Temperatures::default());
    for n in 0..20_000 {
        let out = plant.step(&mut state, PowertrainInput::with(Gates::Torque(250.0)));
        let now_a = out.drives.machine.motor_a;
        if n > 3000 {
            turns += u32::from(now_a > last_a + 0.01);
        }
        (last_a, warm) = (now_a, out.drives.temperatures);
    }
    let Temperatures { machine_c, left, .. } = warm;
    let heat_w = 5e-3 * (235.0 + machine_c) / 255.0 * last_a * last_a + 5e-4 * 142.1 * 142.1;
    assert!((left - last_a / 1000.0).abs() < 1e-3 && (0.3..0.9).contains(&left), "{left} {last_a}");
    assert!((heat_w * 0.02 / (machine_c - 30.0) - 1.0).abs() < 0.01, "{machine_c} {heat_w}");
    assert_eq!(turns, 0);
}

#[test]
fn refuses_each_bad_field_by_name() {
    let refused = |thermal| {
        heated(BMW_I3_60AH_CONSTANT.powertrain, thermal).build(dt(1e-3)).map(|_| ()).unwrap_err()
    };
    for bad in [0.0, -1.0, Real::NAN] {
        let (capacity, coolant) = (
            HeatedPartParams { heat_capacity_j_per_k: bad, ..PART },
            HeatedPartParams { coolant_k_per_w: bad, ..PART },
        );
        for (thermal, field) in [
            (
                DriveThermalParams { machine: capacity, ..THERMAL },
                "thermal.machine.heat_capacity_j_per_k",
            ),
            (DriveThermalParams { machine: coolant, ..THERMAL }, "thermal.machine.coolant_k_per_w"),
            (
                DriveThermalParams { inverter: capacity, ..THERMAL },
                "thermal.inverter.heat_capacity_j_per_k",
            ),
            (
                DriveThermalParams { inverter: coolant, ..THERMAL },
                "thermal.inverter.coolant_k_per_w",
            ),
        ] {
            assert_eq!(refused(thermal), ParamError::NotALimit(field));
        }
    }
    let from = HeatedPartParams { derate_from_c: -300.0, ..PART };
    let to = HeatedPartParams { derate_to_c: 90.0, ..PART };
    let winding = |reference_c, per_k| DriveThermalParams {
        winding: Conductor { reference_c, per_k },
        ..THERMAL
    };
    for (thermal, error) in [
        (
            DriveThermalParams { machine: from, ..THERMAL },
            ParamError::OutOfRange("thermal.machine.derate_from_c"),
        ),
        (
            DriveThermalParams { inverter: to, ..THERMAL },
            ParamError::NotAbove("thermal.inverter.derate_to_c"),
        ),
        (
            DriveThermalParams { coolant_c: 201.0, ..THERMAL },
            ParamError::OutOfRange("thermal.coolant_c"),
        ),
        (
            DriveThermalParams { coolant_c: Real::NAN, ..THERMAL },
            ParamError::NotFinite("thermal.coolant_c"),
        ),
        (winding(400.0, 0.004), ParamError::OutOfRange("thermal.winding.reference_c")),
        (winding(20.0, 0.03), ParamError::OutOfRange("thermal.winding.per_k")),
    ] {
        assert_eq!(refused(thermal), error);
    }
    let mut car = BMW_I3_60AH_CONSTANT.powertrain;
    car.drives.converter.current_limit_a = Real::INFINITY;
    let refused = heated(car, THERMAL).build(dt(1e-3)).map(|_| ()).unwrap_err();
    assert_eq!(refused, ParamError::NotPositive("converter.current_limit_a"));
    assert!(heated(car, DriveThermalParams::NONE).build(dt(1e-3)).is_ok());
}
