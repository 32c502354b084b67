//! The code against the files that tools read.

extern crate std;

use std::collections::{BTreeMap, BTreeSet};
use std::string::{String, ToString};
use std::vec::Vec;
use std::{format, vec};

use can_dbc::{ByteOrder, Dbc, MessageId, MultiplexIndicator, Signal, ValueDescription, ValueType};

use super::super::field::{Field, Layout};
use super::super::inverter::{Alarm, Alarms, InverterView};
use super::super::state::{MODES, PHASES, REASONS, TRIPS};
use super::super::*;
use super::{INVERTER, OWN};
use crate::Real;
use crate::contactor::{Cause, Phase};
use crate::limit::{Limit, Limited, Limits, Mode, Request};
use crate::log::{Entry, Frame, Kind};
use crate::protect::{Clear, Faults, Id, Trip, Verdict};

const OWN_DBC: &str = include_str!("../../../../../data/voltstep.dbc");
const INVERTER_DBC: &str = include_str!("../../../../../data/inverter.dbc");
/// The longest name that common tools take.
const LONGEST_NAME: usize = 32;

fn parsed(text: &str) -> Dbc {
    Dbc::try_from(text).unwrap()
}

/// What a tool makes of a message that knows only the file.
fn seen(dbc: &Dbc, message: &Message) -> BTreeMap<String, f64> {
    let listed = dbc.messages.iter().find(|m| m.id == MessageId::Standard(message.id())).unwrap();
    assert_eq!(listed.size, message.data().len() as u64);
    let mut bytes = [0; 8];
    bytes[..message.data().len()].copy_from_slice(message.data());
    let bits = u128::from(u64::from_le_bytes(bytes));
    let raw = |signal: &Signal| {
        let raw = (bits >> signal.start_bit & ((1 << signal.size) - 1)).cast_signed();
        let negative = signal.value_type == ValueType::Signed && raw >> (signal.size - 1) == 1;
        if negative { raw - (1 << signal.size) } else { raw }
    };
    let switch = listed
        .signals
        .iter()
        .find(|signal| signal.multiplexer_indicator == MultiplexIndicator::Multiplexor)
        .map(raw);
    let shown = listed.signals.iter().filter(|signal| match signal.multiplexer_indicator {
        MultiplexIndicator::MultiplexedSignal(page) => Some(i128::from(page)) == switch,
        _ => true,
    });
    shown.map(|s| (s.name.clone(), raw(s) as f64 * s.factor + s.offset)).collect()
}

/// A signal as both sides write it down: name, page, start, width, signed, factor, offset, lowest,
/// highest.
type Line = (String, Option<u64>, u64, u64, bool, String, String, String, String);

fn line(
    name: String,
    page: Option<u64>,
    (start, width, signed): (u64, u64, bool),
    numbers: [f64; 4],
) -> Line {
    let [factor, offset, low, high] = numbers.map(|number| format!("{number:.5}"));
    (name, page, start, width, signed, factor, offset, low, high)
}

/// A single bit, or a few that have a table.
fn plain(name: String, page: Option<u64>, start: u64, width: u64) -> Line {
    line(name, page, (start, width, false), [1.0, 0.0, 0.0, ((1_u64 << width) - 1) as f64])
}

/// The lines of a signal of the code.
fn lines_of(field: &Field, name: String, page: Option<u64>) -> Vec<Line> {
    let all = (2.0_f64).powi(i32::from(field.width)) - 1.0;
    let (low, high) = match (field.signed, field.valid) {
        (true, _) => (-(all + 1.0) / 2.0, (all - 1.0) / 2.0),
        (false, None) => (0.0, all),
        (false, Some(_)) => (0.0, all - 1.0),
    };
    // The file says 0.1, the code the nearest number in single precision.
    let exact = |number: Real| number.to_string().parse::<f64>().unwrap();
    let (factor, offset) = (exact(field.factor), exact(field.offset));
    let place = (u64::from(field.start), u64::from(field.width), field.signed);
    let numbers = [factor, offset, low * factor + offset, high * factor + offset];
    let mut lines = vec![line(name.clone(), page, place, numbers)];
    if let Some(valid) = field.valid {
        lines.push(plain(format!("{name}Valid"), page, u64::from(valid), 1));
    }
    lines
}

/// The name of a row.
fn row_name(id: Id) -> String {
    format!("{id:?}").replace(['(', ')', ','], " ").split_whitespace().collect::<Vec<_>>().join("_")
}

/// The lines of a message of the code.
fn expected(layout: &Layout) -> BTreeSet<Line> {
    let mut lines = Vec::new();
    match layout.name {
        "Cells" => {
            lines.extend(lines_of(&layout.fields[0], "Group".to_string(), None));
            for (group, (cell, field)) in (0..24)
                .flat_map(|group| layout.fields[1..].iter().enumerate().map(move |f| (group, f)))
            {
                let name = format!("Voltage{}", CELLS_IN_A_GROUP as u64 * group + cell as u64);
                lines.extend(lines_of(field, name, Some(group)));
            }
        }
        "Faults" => {
            lines.extend(lines_of(&layout.fields[0], "Page".to_string(), None));
            for id in Id::ALL {
                let index = u64::from(id.index());
                for (letter, first) in [("T", 0), ("L", 2)] {
                    let name = format!("{letter}_{}", row_name(id));
                    lines.push(plain(name, Some(first + index / 56), 8 + index % 56, 1));
                }
            }
        }
        "InverterAlarms" => {
            for (alarm, place) in Alarm::ALL.into_iter().zip(0_u64..) {
                lines.push(plain(format!("Alarm_{alarm:?}"), None, 2 * place, 2));
                lines.push(plain(format!("Warning_{alarm:?}"), None, 32 + 2 * place, 2));
            }
        }
        _ => {
            let fields = layout.fields.iter();
            lines.extend(fields.flat_map(|f| lines_of(f, f.name.to_string(), None)));
        }
    }
    let count = lines.len();
    let set: BTreeSet<Line> = lines.into_iter().collect();
    assert_eq!(set.len(), count);
    set
}

/// The lines of a message of the file.
fn listed(signals: &[Signal]) -> BTreeSet<Line> {
    let number = |text: String| text.parse::<f64>().unwrap();
    let line_of = |signal: &Signal| {
        assert_eq!(signal.byte_order, ByteOrder::LittleEndian, "{}", signal.name);
        assert!(signal.name.len() <= LONGEST_NAME, "{}", signal.name);
        let page = match signal.multiplexer_indicator {
            MultiplexIndicator::MultiplexedSignal(page) => Some(page),
            _ => None,
        };
        let place = (signal.start_bit, signal.size, signal.value_type == ValueType::Signed);
        let (low, high) = (number(signal.min.to_string()), number(signal.max.to_string()));
        line(signal.name.clone(), page, place, [signal.factor, signal.offset, low, high])
    };
    signals.iter().map(line_of).collect()
}

#[test]
fn files_and_code_have_the_same_signals() {
    for (text, layouts) in [(OWN_DBC, OWN), (INVERTER_DBC, INVERTER)] {
        let dbc = parsed(text);
        assert_eq!(dbc.messages.len(), layouts.len());
        for layout in layouts {
            let message = dbc.messages.iter().find(|m| m.id == MessageId::Standard(layout.id));
            let message = message.unwrap_or_else(|| panic!("{} is not in the file", layout.name));
            assert_eq!((&*message.name, message.size), (layout.name, layout.length as u64));
            let (file, code) = (listed(&message.signals), expected(layout));
            let only_file: Vec<_> = file.difference(&code).collect();
            let only_code: Vec<_> = code.difference(&file).collect();
            assert!(
                only_file.is_empty() && only_code.is_empty(),
                "{}: only in the file {only_file:#?}, only in the code {only_code:#?}",
                layout.name
            );
        }
    }
}

#[test]
fn tables_of_names_are_those_of_the_code() {
    fn names<T: core::fmt::Debug>(all: &[T]) -> BTreeMap<i64, String> {
        (0..).zip(all.iter().map(|one| format!("{one:?}"))).collect()
    }
    let mut requests = names(&[Request::Off, Request::Drive, Request::Charge]);
    requests.insert(7, format!("{:?}", Request::Unknown));
    let clears = names(&[Clear::No, Clear::Reset, Clear::Service]);
    let mut tables = BTreeMap::from([
        ((0x510, "Phase"), names(&PHASES)),
        ((0x510, "Cause"), names(&Cause::ALL)),
        ((0x510, "Trip"), names(&TRIPS)),
        ((0x510, "Mode"), names(&MODES)),
        ((0x512, "DischargeBy"), names(&REASONS)),
        ((0x512, "ChargeBy"), names(&REASONS)),
    ]);
    for id in [0x520, 0x521] {
        tables.insert((id, "Mode"), requests.clone());
        tables.insert((id, "Clear"), clears.clone());
    }
    let dbc = parsed(OWN_DBC);
    assert_eq!(dbc.value_descriptions.len(), tables.len());
    for description in &dbc.value_descriptions {
        let ValueDescription::Signal { message_id, name, value_descriptions } = description else {
            panic!("not of a signal: {description:?}");
        };
        let MessageId::Standard(id) = message_id else { panic!("{message_id:?}") };
        let listed: BTreeMap<i64, String> =
            value_descriptions.iter().map(|v| (v.id, v.description.clone())).collect();
        assert_eq!(Some(&listed), tables.get(&(*id, &**name)), "{id:#x} {name}");
    }
    // The numbers on the bus are those that the code casts to.
    for (number, phase) in (0..).zip(PHASES) {
        assert_eq!(phase as u8, number);
    }
    for (number, reason) in (0..).zip(REASONS) {
        assert_eq!(reason as u8, number);
    }
    assert_eq!(TRIPS.map(|trip| trip as u8), [0, 1, 2, 3]);
    assert_eq!(MODES.map(|mode| mode as u8), [0, 1, 2]);
}

/// That a tool sees these, to the sixth digit.
fn assert_seen(dbc: &Dbc, message: &Message, wanted: &[(&str, f64)]) {
    let seen = seen(dbc, message);
    for (name, value) in wanted {
        assert!((seen[*name] - value).abs() < 1e-6, "{name}: {} for {value}", seen[*name]);
    }
}

#[test]
fn a_tool_sees_what_was_sent() {
    let dbc = parsed(OWN_DBC);
    let status = Status {
        phase: Phase::Shed,
        cause: Cause::Hard,
        trip: Trip::Hard,
        permit: true,
        mode: Mode::Charge,
        soc: 0.423,
        soc_sd: Real::NAN,
    };
    let wanted = [
        ("Phase", 7.0),
        ("Cause", 2.0),
        ("Trip", 2.0),
        ("Permit", 1.0),
        ("Mode", 2.0),
        ("Soc", 42.3),
        ("SocValid", 1.0),
        ("SocSdValid", 0.0),
        ("Alive", 9.0),
    ];
    assert_seen(&dbc, &status.encode(9), &wanted);
    let pack = Pack { pack_v: 401.62, link_v: Real::NAN, current_a: -87.65 };
    let wanted = [
        ("PackVoltage", 401.62),
        ("PackVoltageValid", 1.0),
        ("LinkVoltageValid", 0.0),
        ("Current", -87.65),
        ("CurrentValid", 1.0),
    ];
    assert_seen(&dbc, &pack.encode(0), &wanted);
    let limits = Limits {
        discharge: Limit { current_a: 250.19, by: Limited::Pack },
        charge: Limit { current_a: Real::NAN, by: Limited::Unknown },
    };
    let wanted = [
        ("DischargeCurrent", 250.1),
        ("DischargeBy", 1.0),
        ("ChargeCurrent", 0.0),
        ("ChargeBy", 5.0),
    ];
    assert_seen(&dbc, &encode_limits(&limits, 0), &wanted);
    let cells = CellGroup { group: 23, cell_v: [3.6, Real::NAN, 3.7, 4.181] };
    let wanted =
        [("Voltage92", 3.6), ("Voltage93Valid", 0.0), ("Voltage94", 3.7), ("Voltage95", 4.181)];
    assert_seen(&dbc, &cells.encode(), &wanted);
    let ends = TemperatureExtremes {
        coldest_c: -12.5,
        hottest_c: 31.4,
        coldest_sensor: 3,
        hottest_sensor: 1000,
        missing: 2,
    };
    let wanted = [
        ("ColdestTemperature", -12.5),
        ("HottestTemperature", 31.4),
        ("ColdestSensor", 3.0),
        ("HottestSensor", 1000.0),
        ("SensorsMissing", 2.0),
    ];
    assert_seen(&dbc, &ends.encode(), &wanted);
    let verdict = Verdict {
        trip: Trip::Crash,
        permit: false,
        tripped: Faults::NONE.with(Id::Interlock),
        latched: Faults::NONE.with(Id::Crash),
        rose: Faults::NONE,
        fell: Faults::NONE,
    };
    let page = |page| FaultPage::of(&verdict, page).unwrap().encode();
    assert_seen(&dbc, &page(1), &[("T_Interlock", 1.0), ("T_Crash", 0.0)]);
    assert_seen(&dbc, &page(3), &[("L_Interlock", 0.0), ("L_Crash", 1.0)]);
    let ask = Command { request: Request::Drive, clear: Clear::Service };
    let wanted = [("Mode", 1.0), ("Clear", 2.0), ("Key", f64::from(0xc35a_u32)), ("Alive", 14.0)];
    assert_seen(&dbc, &ask.encode_vehicle(14), &wanted);
    assert_seen(&dbc, &LogRequest::Sequence(70_000).encode(), &[("Sequence", 70_000.0)]);
    let frame = Frame {
        cell_v: [3.0, 3.1],
        temperature_c: [20.0, 21.0],
        current_a: 1.0,
        pack_v: 42.0,
        link_v: 42.0,
        soc: 0.5,
    };
    let entry =
        Entry { sequence: 258, at_ms: 0, id: Id::Crash, kind: Kind::Tripped, phase: 1, frame };
    assert_seen(&dbc, &log_parts(&entry)[0], &[("Part", 0.0), ("Bytes", 258.0)]);
}

#[test]
fn an_inverter_sees_what_was_sent() {
    let dbc = parsed(INVERTER_DBC);
    let view = InverterView {
        charge_v: 56.4,
        discharge_v: 48.0,
        charge_a: 80.0,
        discharge_a: 120.5,
        soc: 0.4321,
        soh: 0.97,
        pack_v: 52.13,
        current_a: 15.5,
        temperature_c: -3.4,
        alarms: Alarms::NONE.with(Alarm::Contactor),
        warnings: Alarms::NONE.with(Alarm::LowVoltage),
        may_charge: true,
        may_discharge: false,
        force_charge: true,
        full_charge: false,
        name: *b"VOLTSTEP",
    };
    let [limits, charge, measured, alarms, permits, name] = view.encode().map(Option::unwrap);
    let wanted = [
        ("ChargeVoltage", 56.4),
        ("ChargeCurrent", 80.0),
        ("DischargeCurrent", 120.5),
        ("DischargeVoltage", 48.0),
    ];
    assert_seen(&dbc, &limits, &wanted);
    assert_seen(&dbc, &charge, &[("Soc", 43.0), ("Soh", 97.0), ("SocFine", 43.21)]);
    let wanted = [("Voltage", 52.13), ("Current", -15.5), ("Temperature", -3.4)];
    assert_seen(&dbc, &measured, &wanted);
    let wanted = [
        ("Alarm_General", 1.0),
        ("Alarm_Contactor", 1.0),
        ("Alarm_LowVoltage", 2.0),
        ("Warning_General", 1.0),
        ("Warning_LowVoltage", 1.0),
        ("Warning_Imbalance", 2.0),
    ];
    assert_seen(&dbc, &alarms, &wanted);
    let wanted = [("MayCharge", 1.0), ("MayDischarge", 0.0), ("ForceCharge", 1.0)];
    assert_seen(&dbc, &permits, &wanted);
    assert_eq!(name.data(), b"VOLTSTEP");
}
