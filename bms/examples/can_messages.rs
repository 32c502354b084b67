//! Every message of both CAN maps with values in it, a line each: identifier, data, and what a tool that
//! knows only `data/voltstep.dbc` or `data/inverter.dbc` must read in it, in the units of those files.
//!
//! ```sh
//! cargo run -p voltstep-bms --example can_messages
//! ```

use voltstep_bms::Reading;
use voltstep_bms::comm::can::inverter::{Alarm, Alarms, InverterView};
use voltstep_bms::comm::can::{
    CellExtremes, CellGroup, Command, FAULT_PAGES, FaultPage, LogRequest, Message, Pack, Status,
    TemperatureExtremes, encode_limits, log_parts,
};
use voltstep_bms::contactor::{Cause, Phase};
use voltstep_bms::limit::{Limit, Limited, Limits, Mode, Request};
use voltstep_bms::log::{Entry, Frame, Kind};
use voltstep_bms::protect::{Clear, Faults, Id, Level, Side, Trip, Verdict};

fn show(message: &Message, expected: &[(&str, f64)]) {
    let mut line = format!("{:03X}#", message.id());
    for byte in message.data() {
        line += &format!("{byte:02X}");
    }
    for (name, value) in expected {
        line += &format!(" {name}={value}");
    }
    println!("{line}");
}

fn main() {
    state();
    cells();
    events();
    inverter();
}

fn state() {
    let status = Status {
        phase: Phase::Closed,
        cause: Cause::None,
        trip: Trip::Soft,
        permit: true,
        mode: Mode::Charge,
        soc: 0.643,
        soc_sd: 0.021,
    };
    let known = [("SocValid", 1.0), ("SocSdValid", 1.0), ("Alive", 5.0)];
    let said = [("Phase", 6.0), ("Cause", 0.0), ("Trip", 1.0), ("Permit", 1.0), ("Mode", 2.0)];
    let values = [("Soc", 64.3), ("SocSd", 2.1)];
    show(&status.encode(5), &[&said[..], &values, &known].concat());
    show(&Status { soc: f32::NAN, ..status }.encode(6), &[("SocValid", 0.0), ("SocSd", 2.1)]);

    for current_a in [-123.4, 0.0, 250.05] {
        let pack = Pack { pack_v: 51.24, link_v: 1000.02, current_a };
        show(
            &pack.encode(0),
            &[
                ("PackVoltage", 51.24),
                ("LinkVoltage", 1000.02),
                ("Current", f64::from(current_a)),
                ("PackVoltageValid", 1.0),
                ("LinkVoltageValid", 1.0),
                ("CurrentValid", 1.0),
            ],
        );
    }

    let limits = Limits {
        discharge: Limit { current_a: 174.0, by: Limited::Cells },
        charge: Limit { current_a: 12.3, by: Limited::Cold },
    };
    let values = [("DischargeCurrent", 174.0), ("ChargeCurrent", 12.3), ("Alive", 14.0)];
    let by = [("DischargeBy", 0.0), ("ChargeBy", 4.0)];
    show(&encode_limits(&limits, 14), &[&values[..], &by].concat());

    let command = Command { request: Request::Drive, clear: Clear::No };
    for message in [command.encode_vehicle(3), command.encode_charger(3)] {
        show(&message, &[("Mode", 1.0), ("Clear", 0.0), ("Alive", 3.0)]);
    }
}

fn cells() {
    let cell_v: Vec<Reading> =
        (0..14_u8).map(|n| Reading::new(3.6 + 0.01 * f32::from(n))).collect();
    show(
        &CellExtremes::of(&cell_v, 1.0).encode(),
        &[
            ("LowestVoltage", 3.6),
            ("HighestVoltage", 3.73),
            ("LowestCell", 0.0),
            ("HighestCell", 13.0),
            ("CellsMissing", 0.0),
            ("LowestVoltageValid", 1.0),
            ("HighestVoltageValid", 1.0),
        ],
    );
    let celsius = [Reading::new(-12.5), Reading::NONE, Reading::new(31.0)];
    show(
        &TemperatureExtremes::of(&celsius, 1.0).encode(),
        &[
            ("ColdestTemperature", -12.5),
            ("HottestTemperature", 31.0),
            ("ColdestSensor", 0.0),
            ("HottestSensor", 2.0),
            ("SensorsMissing", 1.0),
        ],
    );
    // Of the last group two places are empty.
    for (number, names) in [(1, ["Voltage4", "Voltage7"]), (3, ["Voltage12", "Voltage13"])] {
        let Some(group) = CellGroup::of(&cell_v, 1.0, number) else { continue };
        let value = |name: &str| {
            let cell: f64 = name.trim_start_matches("Voltage").parse().unwrap_or(f64::NAN);
            3.6 + 0.01 * cell
        };
        let empty = if number == 3 { Some(("Voltage15Valid", 0.0)) } else { None };
        let mut expected = vec![("Group", f64::from(number))];
        expected.extend(names.map(|name| (name, value(name))));
        expected.extend(empty);
        show(&group.encode(), &expected);
    }
}

fn events() {
    let high = Id::CellVoltage(Side::High, Level::Msl);
    let verdict = Verdict {
        trip: Trip::Hard,
        permit: false,
        tripped: Faults::NONE.with(high).with(Id::Crash),
        latched: Faults::NONE.with(Id::Crash),
        rose: Faults::NONE,
        fell: Faults::NONE,
    };
    for page in 0..FAULT_PAGES {
        let Some(shown) = FaultPage::of(&verdict, page) else { continue };
        let mut expected = vec![("Page", f64::from(page))];
        // Rows that have tripped come first, then those that are latched, 56 on a page.
        let at = |id: Id, first: u8| first + id.index() / 56;
        for (id, first, name) in [
            (high, 0, "T_CellVoltage_High_Msl"),
            (Id::Crash, 0, "T_Crash"),
            (Id::Crash, 2, "L_Crash"),
        ] {
            if at(id, first) == page {
                expected.push((name, 1.0));
            }
        }
        if page == at(high, 2) {
            expected.push(("L_CellVoltage_High_Msl", 0.0));
        }
        show(&shown.encode(), &expected);
    }

    let frame = Frame {
        cell_v: [3.61, 4.29],
        temperature_c: [24.0, 31.0],
        current_a: -40.0,
        pack_v: 58.1,
        link_v: 58.0,
        soc: 0.99,
    };
    let entry = Entry {
        sequence: 0x0403_0201,
        at_ms: 0x0006_0005,
        id: high,
        kind: Kind::Tripped,
        phase: 6,
        frame,
    };
    for (number, part) in (0_u8..).zip(log_parts(&entry)) {
        // The first holds the number and three bytes of the time: 0x06_00_05_04_03_02_01.
        let bytes = if number == 0 { Some(("Bytes", 1_688_871_402_406_401.0)) } else { None };
        let mut expected = vec![("Part", f64::from(number))];
        expected.extend(bytes);
        show(&part, &expected);
    }
    show(&LogRequest::Newest.encode(), &[("Newest", 1.0)]);
    show(&LogRequest::Sequence(123_456).encode(), &[("Newest", 0.0), ("Sequence", 123_456.0)]);
}

fn inverter() {
    let view = InverterView {
        charge_v: 56.4,
        discharge_v: 48.0,
        charge_a: 80.0,
        discharge_a: 120.0,
        soc: 0.5,
        soh: 0.97,
        pack_v: 52.0,
        current_a: 15.5,
        temperature_c: -3.5,
        alarms: Alarms::NONE.with(Alarm::HighVoltage),
        warnings: Alarms::NONE,
        may_charge: true,
        may_discharge: false,
        force_charge: false,
        full_charge: true,
        name: *b"VOLTSTEP",
    };
    let expected: [&[(&str, f64)]; 6] = [
        &[
            ("ChargeVoltage", 56.4),
            ("ChargeCurrent", 80.0),
            ("DischargeCurrent", 120.0),
            ("DischargeVoltage", 48.0),
        ],
        &[("Soc", 50.0), ("Soh", 97.0), ("SocFine", 50.0)],
        // On this map a current is positive into the battery.
        &[("Voltage", 52.0), ("Current", -15.5), ("Temperature", -3.5)],
        &[
            ("Alarm_General", 1.0),
            ("Alarm_HighVoltage", 1.0),
            ("Alarm_LowVoltage", 2.0),
            ("Warning_General", 2.0),
        ],
        &[("FullCharge", 1.0), ("ForceCharge", 0.0), ("MayDischarge", 0.0), ("MayCharge", 1.0)],
        // Too long for a number here: that it is there is all that is asked.
        &[],
    ];
    for (message, expected) in view.encode().iter().flatten().zip(expected) {
        show(message, expected);
    }
}
