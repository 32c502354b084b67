//! The map of inverters, there and back.

extern crate std;

use proptest::prelude::*;

use super::super::inverter::{Alarm, Alarms, InverterView};
use super::message;
use crate::protect::{EXAMPLE, Faults, Flow, Id, Level, Side, Table, Trip, Verdict};
use crate::{Real, must};

const TABLE: Table = must!(Table::new(EXAMPLE));

const KNOWN: InverterView = InverterView {
    charge_v: 56.4,
    discharge_v: 48.0,
    charge_a: 80.0,
    discharge_a: 120.0,
    soc: 0.5,
    soh: 0.97,
    pack_v: 52.0,
    current_a: 15.5,
    temperature_c: 21.5,
    ..InverterView::NONE
};

fn heard(sent: &InverterView) -> InverterView {
    let mut heard = InverterView::NONE;
    for message in sent.encode().into_iter().flatten() {
        assert!(heard.hear(&message));
    }
    heard
}

fn alarms(mask: u16) -> Alarms {
    let raised = Alarm::ALL.into_iter().filter(|alarm| mask >> *alarm as u8 & 1 == 1);
    raised.fold(Alarms::NONE, Alarms::with)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_view_comes_back(
        (charge_v, discharge_v, pack_v) in (0.0 as Real..6000.0, 0.0 as Real..6000.0, 0.0 as Real..327.0),
        (charge_a, discharge_a, current_a) in (0.0 as Real..3276.0, 0.0 as Real..3276.0, -3276.0 as Real..3276.0),
        (soc, soh, temperature_c) in (0.0 as Real..1.0, 0.0 as Real..1.0, -100.0 as Real..200.0),
        (alarm, warning) in (0_u16..1 << 13, 0_u16..1 << 13),
        (may_charge, may_discharge, force_charge, full_charge) in any::<(bool, bool, bool, bool)>(),
        name in any::<[u8; 8]>(),
    ) {
        let (alarms, warnings) = (alarms(alarm), alarms(warning));
        let sent = InverterView {
            charge_v, discharge_v, charge_a, discharge_a, soc, soh, pack_v, current_a,
            temperature_c, alarms, warnings, may_charge, may_discharge, force_charge, full_charge,
            name,
        };
        let back = heard(&sent);
        for (back, sent, step) in [
            (back.discharge_v, discharge_v, 0.1),
            (back.soc, soc, 1e-4),
            (back.soh, soh, 0.01),
            (back.pack_v, pack_v, 0.01),
            (back.current_a, current_a, 0.1),
            (back.temperature_c, temperature_c, 0.1),
        ] {
            let fine = 4.0 * Real::EPSILON * sent.abs().max(1.0);
            prop_assert!((back - sent).abs() <= 0.5 * step + fine, "{sent} became {back}");
        }
        for (back, sent) in
            [(back.charge_v, charge_v), (back.charge_a, charge_a), (back.discharge_a, discharge_a)]
        {
            prop_assert!(back <= sent && sent - back < 0.102, "{sent} became {back}");
        }
        let flags = |v: &InverterView| (v.may_charge, v.may_discharge, v.force_charge, v.full_charge);
        prop_assert_eq!(flags(&back), flags(&sent));
        prop_assert_eq!((back.alarms, back.warnings, back.name), (alarms, warnings, name));
    }
}

#[test]
fn what_is_not_known_is_not_sent() {
    let sent = |view: InverterView| view.encode().map(|message| message.is_some());
    assert_eq!(sent(KNOWN), [true; 6]);
    let nan = Real::NAN;
    for (view, missing) in [
        (InverterView { charge_v: nan, ..KNOWN }, 0),
        (InverterView { discharge_v: nan, ..KNOWN }, 0),
        (InverterView { soc: nan, ..KNOWN }, 1),
        (InverterView { soh: nan, ..KNOWN }, 1),
        (InverterView { pack_v: nan, ..KNOWN }, 2),
        (InverterView { current_a: nan, ..KNOWN }, 2),
        (InverterView { temperature_c: nan, ..KNOWN }, 2),
    ] {
        let mut wanted = [true; 6];
        wanted[missing] = false;
        assert_eq!(sent(view), wanted, "{view:?}");
    }
}

#[test]
fn limits_that_are_not_known_or_negative_are_zero() {
    for current_a in [Real::NAN, -1.0, Real::NEG_INFINITY] {
        let view = InverterView { charge_a: current_a, discharge_a: current_a, ..KNOWN };
        let back = heard(&view);
        assert_eq!((back.charge_a, back.discharge_a), (0.0, 0.0), "{current_a}");
    }
    let view = InverterView { charge_a: 1e9, discharge_a: Real::INFINITY, ..KNOWN };
    assert_eq!((heard(&view).charge_a, heard(&view).discharge_a), (3276.7, 3276.7));
}

#[test]
fn examples_of_a_public_implementation_are_understood() {
    // 0x355, "1A 00 64 00", and 0x356, "4e 13 02 03 04 05", as the comments of `DiyBms` give them;
    // the first is of the four bytes without the fine state of charge, and is not ours.
    let mut view = InverterView::NONE;
    assert!(view.hear(&message(0x356, &[0x4e, 0x13, 0x02, 0x03, 0x04, 0x05])));
    assert!((view.pack_v - 49.42).abs() < 1e-4, "{}", view.pack_v);
    assert!((view.current_a + 77.0).abs() < 1e-4, "{}", view.current_a);
    assert!((view.temperature_c - 128.4).abs() < 1e-4, "{}", view.temperature_c);
    assert!(!view.hear(&message(0x355, &[0x1a, 0x00, 0x64, 0x00])));
    // 0x35C, "C0 00": may be charged and discharged. 0x35E: the name.
    assert!(view.hear(&message(0x35c, &[0xc0, 0x00])));
    assert!(view.may_charge && view.may_discharge && !view.force_charge && !view.full_charge);
    assert!(view.hear(&message(0x35e, b"PYLON   ")));
    assert_eq!(&view.name, b"PYLON   ");
    assert!(!view.hear(&message(0x351, &[0; 6])), "a shorter one");
    // 0x35A: 0 and 3 are "not supported".
    for pairs in [0x00, 0xff] {
        assert!(view.hear(&message(0x35a, &[pairs; 8])));
        assert_eq!((view.alarms, view.warnings), (Alarms::NONE, Alarms::NONE), "{pairs:#x}");
    }
}

#[test]
fn rows_become_alarms_at_a_safety_limit_and_warnings_below() {
    let verdict = |id: Id| Verdict {
        trip: Trip::None,
        permit: false,
        tripped: Faults::NONE.with(id),
        latched: Faults::NONE,
        rose: Faults::NONE,
        fell: Faults::NONE,
    };
    for id in Id::ALL {
        let (alarms, warnings) = InverterView::alarms_of(&TABLE, &verdict(id));
        let alarmed = TABLE.row(id).level == Level::Msl;
        let (raised, quiet) = if alarmed { (alarms, warnings) } else { (warnings, alarms) };
        assert!(raised.has(Alarm::of(id)) && raised.has(Alarm::General), "{id:?}");
        assert_eq!(quiet, Alarms::NONE, "{id:?}");
        let latched = Verdict { latched: Faults::NONE.with(id), ..verdict(Id::Record) };
        let (alarms, warnings) = InverterView::alarms_of(&TABLE, &latched);
        assert!(alarms.has(Alarm::of(id)) || warnings.has(Alarm::of(id)), "{id:?} latched");
    }
    for (id, alarm) in [
        (Id::CellVoltage(Side::High, Level::Msl), Alarm::HighVoltage),
        (Id::PackVoltage(Side::Low), Alarm::LowVoltage),
        (Id::Temperature(Flow::Charge, Side::Low, Level::Msl), Alarm::LowTemperatureCharge),
        (Id::Temperature(Flow::Discharge, Side::High, Level::Rsl), Alarm::HighTemperature),
        (Id::Surge(Flow::Charge), Alarm::HighCurrentCharge),
        (Id::Heat(Flow::Discharge), Alarm::HighCurrent),
        (Id::Pin, Alarm::Contactor),
        (Id::ShortCircuit, Alarm::ShortCircuit),
        (Id::Imbalance, Alarm::Imbalance),
        (Id::Parameters, Alarm::Internal),
    ] {
        assert_eq!(Alarm::of(id), alarm, "{id:?}");
    }
    let places: std::vec::Vec<_> = Alarm::ALL.iter().map(|alarm| *alarm as u8).collect();
    assert_eq!(places, (0..13).collect::<std::vec::Vec<u8>>());
}
