extern crate std;
use plant_core::battery::{
    BranchMap, IdentifiedRange, MappedBattery, MappedBatteryParams, OpenCircuit, OverSoc,
    ResistanceMap,
};
use plant_core::num::SocTable;
use plant_core::presets::{BMW_I3_60AH_PACK, PANASONIC_NCR18650PF};
use plant_core::{Accum, Dt, must};

use super::*;
use crate::estimate::energy::{EnergyParams, EnergyState};
use crate::estimate::power::{Allowance, BoundBy};
use crate::{Estimate, Health};

const DT: Dt = must!(Dt::from_s(1.0));
/// A cell whose numbers do not move when a preset is made anew.
const CELL: MappedBattery = must!(MappedBattery::new(
    MappedBatteryParams {
        capacity_ah: 2.97,
        open_circuit: OpenCircuit::Table(must!(SocTable::from_points(
            "open_circuit",
            &[(0.0, 3.177), (0.25, 3.483), (0.5, 3.647), (0.75, 3.888), (1.0, 4.149)]
        ))),
        series: ResistanceMap { resistance_ohm: OverSoc::Constant(0.032), activation_k: 0.0 },
        polarisation: BranchMap::NONE,
        second_polarisation: BranchMap {
            resistance_ohm: OverSoc::Constant(0.02),
            activation_k: 0.0,
            time_constant_s: 120.0,
        },
        identified: IdentifiedRange::ALL,
        ..PANASONIC_NCR18650PF
    },
    DT
));
const GAUGE: EnergyGauge<'static> = must!(EnergyGauge::new(
    EnergyParams { empty_soc: 0.0, full_soc: 1.0, empty_v: 2.5, least_a: 0.01 },
    &CELL,
    DT
));
const IDENTITY: Identity<'static> = Identity {
    design_capacity_ah: 2.97,
    design_voltage_v: 3.6,
    manufacture_date: ManufactureDate::new(),
    serial_number: 4711,
    manufacturer_name: "Voltstep",
    device_name: "18650PF",
    device_chemistry: "LION",
};

fn snapshot() -> Snapshot {
    Snapshot {
        voltage_v: 3.612,
        current_a: 1.5,
        estimate: Estimate::rested(0.5, 0.011, 25.0),
        health: Health::as_new(&CELL),
        averages: EnergyState { average_a: Accum::new(1.2), average_w: Accum::new(4.32) },
        discharge: Allowance {
            current_a: 10.0,
            power_w: 30.0,
            voltage_v: 3.0,
            bound_by: BoundBy::Current,
        },
        charging_current_a: 1.485,
        charging_voltage_v: 4.2,
        cycles: 17.3,
        status: BatteryStatusFields::new().with_initialized(true),
    }
}

fn pack() -> SmartPack<'static> {
    let mut pack = SmartPack::new(IDENTITY, GAUGE);
    pack.show(snapshot()).unwrap();
    pack
}

const OVERFLOW: ErrorKind = ErrorKind::BatteryStatus(ErrorCode::UnderOverFlow);

#[test]
fn answers_in_the_units_and_signs_of_the_specification() {
    let mut pack = pack();
    assert_eq!(pack.voltage(), Ok(3612));
    assert_eq!(pack.current(), Ok(-1500));
    assert_eq!(pack.average_current(), Ok(-1200));
    assert_eq!(pack.temperature(), Ok(2982)); // 298.15 K
    assert_eq!(pack.max_error(), Ok(3));
    assert_eq!(pack.relative_state_of_charge(), Ok(50));
    assert_eq!(pack.absolute_state_of_charge(), Ok(50));
    assert_eq!(pack.remaining_capacity(), Ok(CapacityModeValue::MilliAmpUnsigned(1485)));
    assert_eq!(pack.full_charge_capacity(), Ok(CapacityModeValue::MilliAmpUnsigned(2970)));
    assert_eq!(pack.design_capacity(), Ok(CapacityModeValue::MilliAmpUnsigned(2970)));
    assert_eq!((pack.design_voltage(), pack.cycle_count()), (Ok(3600), Ok(17)));
    assert_eq!((pack.charging_current(), pack.charging_voltage()), (Ok(1485), Ok(4200)));
    // Some 5.1 Wh at 4.32 W, at 5.42 W.
    let (average, run) = (pack.average_time_to_empty().unwrap(), pack.run_time_to_empty().unwrap());
    assert!((68..73).contains(&average) && (53..58).contains(&run), "{average} {run}");
    assert_eq!(pack.average_time_to_full(), Ok(u16::MAX));
    assert_eq!(pack.serial_number(), Ok(4711));
    let info = pack.specification_info().unwrap();
    assert_eq!((info.into_bits(), info.v_scale(), info.ip_scale()), (0x21, 0, 0));
}

#[test]
fn capacity_comes_as_charge_or_energy() {
    let mut pack = pack();
    let flags = BatteryModeFields::from_bits(u16::MAX);
    pack.set_battery_mode(flags).unwrap();
    let mode = pack.battery_mode().unwrap();
    assert!(mode.capacity_mode() && !mode.condition_flag() && !mode.primary_battery_support());
    let Ok(CapacityModeValue::CentiWattUnsigned(energy)) = pack.remaining_capacity() else {
        panic!("not an energy")
    };
    assert!((490..530).contains(&energy), "{energy}");
    assert_eq!(pack.design_capacity(), Ok(CapacityModeValue::CentiWattUnsigned(1069)));
}

#[test]
fn answers_for_a_rate() {
    let mut pack = pack();
    assert_eq!(pack.at_rate(), Ok(CapacityModeSignedValue::MilliAmpSigned(0)));
    assert_eq!(pack.at_rate_ok(), Ok(true));
    for (rate, ok, empty, full) in [
        (CapacityModeSignedValue::MilliAmpSigned(-1485), true, 56..61, None),
        (CapacityModeSignedValue::MilliAmpSigned(-10_001), false, 4..9, None),
        (CapacityModeSignedValue::MilliAmpSigned(1485), true, 0..0, Some(60)),
        (CapacityModeSignedValue::CentiWattSigned(-510), true, 56..61, None),
        (CapacityModeSignedValue::CentiWattSigned(-3001), false, 4..10, None),
        (CapacityModeSignedValue::CentiWattSigned(510), true, 0..0, Some(66)),
    ] {
        pack.set_at_rate(rate).unwrap();
        assert_eq!((pack.at_rate(), pack.at_rate_ok()), (Ok(rate), Ok(ok)));
        let (to_empty, to_full) =
            (pack.at_rate_time_to_empty().unwrap(), pack.at_rate_time_to_full().unwrap());
        if let Some(full) = full {
            assert_eq!(to_empty, u16::MAX);
            assert!(to_full.abs_diff(full) < 3, "{rate:?}: {to_full}");
        } else {
            assert_eq!(to_full, u16::MAX);
            assert!(empty.contains(&to_empty), "{rate:?}: {to_empty}");
        }
    }
}

#[test]
fn raises_its_alarms() {
    let mut pack = pack();
    let status = pack.battery_status().unwrap();
    assert!(status.discharging() && status.initialized());
    assert!(!status.remaining_capacity_alarm() && !status.remaining_time_alarm());
    assert_eq!(pack.remaining_capacity_alarm(), Ok(CapacityModeValue::MilliAmpUnsigned(297)));
    assert_eq!(pack.remaining_time_alarm(), Ok(10));
    for alarm in
        [CapacityModeValue::MilliAmpUnsigned(1500), CapacityModeValue::CentiWattUnsigned(600)]
    {
        pack.set_remaining_capacity_alarm(alarm).unwrap();
        assert!(pack.battery_status().unwrap().remaining_capacity_alarm());
    }
    pack.set_remaining_time_alarm(100).unwrap();
    assert!(pack.battery_status().unwrap().remaining_time_alarm());
    pack.show(Snapshot { current_a: -1.0, averages: EnergyState::default(), ..snapshot() })
        .unwrap();
    let status = pack.battery_status().unwrap();
    assert!(!status.discharging() && !status.remaining_time_alarm());
    assert_eq!(pack.run_time_to_empty(), Ok(u16::MAX));
}

#[test]
fn what_does_not_fit_is_an_error() {
    const PACK: MappedBattery = must!(MappedBattery::new(BMW_I3_60AH_PACK, DT));
    let params = EnergyParams { empty_soc: 0.1, full_soc: 0.95, empty_v: 300.0, least_a: 0.1 };
    let gauge = EnergyGauge::new(params, &PACK, DT).unwrap();
    let identity = Identity { design_capacity_ah: 61.7, design_voltage_v: 360.0, ..IDENTITY };
    let mut pack = SmartPack::new(identity, gauge);
    pack.show(Snapshot {
        voltage_v: 372.0,
        current_a: 45.0,
        health: Health::as_new(&PACK),
        charging_current_a: 100.0,
        charging_voltage_v: 400.0,
        averages: EnergyState { average_a: Accum::new(-40.0), average_w: Accum::new(-15e3) },
        ..snapshot()
    })
    .unwrap();
    assert_eq!(pack.voltage(), Err(OVERFLOW));
    assert_eq!((pack.current(), pack.average_current()), (Err(OVERFLOW), Err(OVERFLOW)));
    assert_eq!((pack.charging_current(), pack.charging_voltage()), (Err(OVERFLOW), Err(OVERFLOW)));
    assert_eq!(pack.design_voltage(), Err(OVERFLOW));
    // Its charge fits, its energy does not.
    assert_eq!(pack.design_capacity(), Ok(CapacityModeValue::MilliAmpUnsigned(61_700)));
    assert!(pack.remaining_capacity().is_ok() && pack.relative_state_of_charge().is_ok());
    pack.set_battery_mode(BatteryModeFields::new().with_capacity_mode(true)).unwrap();
    assert_eq!(pack.remaining_capacity(), Err(OVERFLOW));
    assert_eq!(pack.average_time_to_full(), Ok(42)); // 0.45·61.7 Ah at 40 A

    let mut pack = self::pack();
    pack.show(Snapshot { voltage_v: -0.1, cycles: 1e5, ..snapshot() }).unwrap();
    assert_eq!((pack.voltage(), pack.cycle_count()), (Err(OVERFLOW), Err(OVERFLOW)));
    pack.show(Snapshot { voltage_v: Real::NAN, ..snapshot() }).unwrap();
    assert_eq!(pack.voltage(), Err(OVERFLOW));
    let slow = EnergyState { average_a: Accum::new(0.011), average_w: Accum::new(1e-4) };
    pack.show(Snapshot { averages: slow, ..snapshot() }).unwrap();
    assert_eq!(pack.average_time_to_empty(), Err(OVERFLOW));
}

#[test]
fn without_a_snapshot_it_is_busy() {
    let mut pack = SmartPack::new(IDENTITY, GAUGE);
    assert_eq!(pack.voltage(), Err(ErrorKind::BatteryStatus(ErrorCode::Busy)));
    let mut bad = snapshot();
    bad.estimate.soc = Real::NAN;
    assert_eq!(pack.show(bad), Err(ErrorKind::BatteryStatus(ErrorCode::UnknownError)));
    assert!(pack.relative_state_of_charge().is_err() && pack.battery_status().is_err());
    assert_eq!(pack.serial_number(), Ok(4711));
}

#[test]
fn names_end_with_a_zero_or_are_refused() {
    let mut pack = pack();
    let mut name = [b'?'; 10];
    pack.manufacturer_name(&mut name).unwrap();
    assert_eq!(&name, b"Voltstep\0?");
    pack.device_chemistry(&mut name[..5]).unwrap();
    assert_eq!(&name[..5], b"LION\0");
    let before = name;
    let refused = pack.device_name(&mut name[..7]);
    assert_eq!(refused, Err(ErrorKind::BatteryStatus(ErrorCode::BadSize)));
    assert_eq!(name, before);
    assert_eq!(pack.manufacture_date().unwrap().into_bits(), 0);
}
