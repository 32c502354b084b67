//! The BMS through C: every mistake gets its code and its words, and what the hardware says arrives.
#![cfg(feature = "bms")]

use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

use voltstep_capi::VoltstepStatus as Status;
use voltstep_capi::*;

mod memory;
use memory::{get, known, preset};

const CELLS: u16 = 18;

fn described() -> VoltstepBmsParams {
    // SAFETY: every pointer comes from a reference or is memory of its type.
    unsafe {
        let mut sheet: VoltstepBmsSheet = get(|sheet| voltstep_bms_sheet_example(sheet));
        sheet.layout.series = CELLS;
        let cell = preset().cell;
        get(|params| voltstep_bms_params_typical(&raw const sheet, &raw const cell, 33.0, params))
    }
}

fn blank() -> Box<VoltstepBms> {
    Box::new(VoltstepBms { opaque: [MaybeUninit::zeroed(); VOLTSTEP_BMS_WORDS] })
}

fn blank_state() -> Box<VoltstepBmsState> {
    Box::new(VoltstepBmsState { opaque: [MaybeUninit::zeroed(); VOLTSTEP_BMS_STATE_WORDS] })
}

fn init(bms: &mut VoltstepBms, params: &VoltstepBmsParams) -> (Status, Option<String>) {
    let mut refused: *const c_char = null();
    // SAFETY: every pointer comes from a reference; words are static texts that end with a zero.
    unsafe {
        let status = voltstep_bms_init(bms, params, &raw mut refused);
        let text = (!refused.is_null()).then(|| CStr::from_ptr(refused).to_str().unwrap().into());
        (status, text)
    }
}

/// A BMS and its state, started.
fn started() -> (Box<VoltstepBms>, Box<VoltstepBmsState>) {
    let (mut bms, mut state) = (blank(), blank_state());
    assert_eq!(init(&mut bms, &described()), (Status::Ok, None));
    // SAFETY: both are references; there is no record.
    let status =
        unsafe { voltstep_bms_start(&raw const *bms, &raw mut *state, null(), 0, 0, 25.0) };
    assert_eq!(status, Status::Ok);
    (bms, state)
}

/// All is well, and new.
fn measured() -> VoltstepBmsInputs {
    VoltstepBmsInputs {
        uptime_us: 0,
        cells_new: 1,
        cell_v: [3.7; VOLTSTEP_BMS_CELLS_MAX],
        temperatures_new: 1,
        temperature_c: [25.0; VOLTSTEP_BMS_SENSORS_MAX],
        current_new: 1,
        current_a: 0.0,
        pack_new: 1,
        pack_v: 66.6,
        link_new: 1,
        link_v: 0.0,
        feedback: [VoltstepBmsFeedback::Open as u32; 3],
        pin_failed: 0,
        flags: [0; 3],
        second_current_measured: 0,
        second_current_a: 0.0,
        insulation_watched: 0,
        insulation_ohm_per_v: f32::NAN,
        cells_found: 0,
        wires_tested: 0,
        wires_v: [0.0; VOLTSTEP_BMS_WIRES_MAX],
        balancing_c: 25.0,
    }
}

/// So many milliseconds in which the hardware says the same; what is known then.
fn after(milliseconds: u16, change: impl FnOnce(&mut VoltstepBmsInputs)) -> VoltstepBmsReport {
    let (bms, mut state) = started();
    let mut inputs = measured();
    change(&mut inputs);
    // SAFETY: every pointer comes from a reference or is memory of its type.
    unsafe {
        for _ in 0..milliseconds {
            inputs.uptime_us += 1000;
            let _: VoltstepBmsOutputs = get(|outputs| {
                voltstep_bms_tick(&raw const *bms, &raw mut *state, &raw const inputs, outputs)
            });
        }
        get(|report| voltstep_bms_report(&raw const *bms, &raw const *state, report))
    }
}

fn tripped(report: &VoltstepBmsReport, row: VoltstepBmsRow) -> bool {
    report.tripped[row as usize / 32] >> (row as u32 % 32) & 1 == 1
}

#[test]
fn every_bad_field_is_named() {
    let mut bms = blank();
    let mut said: Vec<String> = Vec::new();
    let mut refused = |field: &str, change: fn(&mut VoltstepBmsParams)| {
        let mut bad = described();
        change(&mut bad);
        let (status, words) = init(&mut bms, &bad);
        let words = words.unwrap_or_default();
        assert_ne!(status, Status::Ok, "{field}");
        let named = words
            .split_once(' ')
            .is_some_and(|(name, rule)| name.ends_with(field) && rule.starts_with("must "));
        assert!(named, "{field}: {words}");
        said.push(words);
    };
    macro_rules! each_nan {
        ($($group:tt as $words:literal { $($field:ident)+ })+) => {
            $(each_nan!(@all $group $words $($field)+);)+
        };
        (@all $group:tt $words:literal $($field:ident)+) => {
            $(each_nan!(@one $group $words $field);)+
        };
        (@one [$($group:tt)+] $words:literal $field:ident) => {
            refused(concat!($words, stringify!($field)), |p| p.$($group)+.$field = f32::NAN);
        };
    }
    each_nan!(
        [sheet.cell.voltage] as "sheet.voltage." {
            deep_v absolute_min_v operating_min_v operating_max_v absolute_max_v
        }
        [sheet.cell.discharge] as "sheet.discharge." { continuous_a ten_seconds_a }
        [sheet.cell.charge] as "sheet.charge." { continuous_a ten_seconds_a }
        [sheet.cell.discharge_window] as "sheet.discharge_window." {
            none_below_c all_from_c all_to_c none_above_c
        }
        [sheet.cell.charge_window] as "sheet.charge_window." {
            none_below_c all_from_c all_to_c none_above_c
        }
        [sheet.cell] as "sheet." { capacity_ah resistance_ohm heat_capacity_j_per_k }
        [sheet.actuators] as "actuators." { open_s wait_s break_a }
        [sheet] as "" { tick_s }
        [alike] as "bms.alike." { resistance_ohm resistance_sd }
        [precharge] as "precharge." {
            resistor_ohm link_f tau_factor noise_v noise_a done_v lag_s budget_j short_j cooling_s
        }
        [contactors] as "contactor." {
            start_limit_s settle_s close_limit_s precharge_limit_s open_limit_s shed_limit_s
            hard_limit_s weld_limit_s cooldown_s
        }
        [balancing] as "balancer." { bleed_ohm board_max_c }
    );
    refused("bms.current_offset_sd_a", |p| p.current_offset_sd_a = -1.0);
    refused("bms.current_gain_sd", |p| p.current_gain_sd = 2.0);
    refused("bms.skew_s", |p| p.skew_s = -1.0);
    refused("bms.sample_s", |p| p.sample_s = f32::NAN);
    refused("bms.sample_s", |p| p.sample_s = 0.3);
    refused("energy.empty_soc", |p| p.empty_soc = 2.0);
    refused("rest_s", |p| p.rest_s = 0.0);
    refused("layout.parallel", |p| p.sheet.layout.parallel = 0);
    refused("sweep_ticks", |p| p.sheet.sweep_ticks = 0);
    refused("precharge.count", |p| p.precharge.count = 0);
    refused("contactor.tries", |p| p.contactors.tries = 0);
    refused("balancer.channels", |p| p.balancing.channels = 0);
    refused("sensing.cell_v", |p| p.sheet.sensing.cell_v.error = -1.0);
    refused("sensing.temperature_c", |p| p.sheet.sensing.temperature_c.resolution = 0.0);
    refused("sensing.current_a", |p| p.sheet.sensing.current_a.highest = 10.0);
    refused("sensing.pack_v", |p| p.sheet.sensing.pack_v.lowest = f32::NAN);
    refused("sensing.link_v", |p| p.sheet.sensing.link_v.highest = -9.0);
    refused("battery.capacity_ah", |p| p.cell.capacity_ah = 0.0);
    refused("battery.open_circuit.table", |p| p.cell.open_circuit_v[3] = f32::NAN);
    let all = said.len();
    said.sort();
    said.dedup();
    assert_eq!(said.len(), all, "two refusals have the same words");
}

#[test]
fn a_description_of_another_pack_is_refused() {
    let refused = |change: fn(&mut VoltstepBmsParams)| {
        let mut bad = described();
        change(&mut bad);
        init(&mut blank(), &bad).0
    };
    assert_eq!(refused(|p| p.abi = 1), Status::AbiMismatch);
    assert_eq!(refused(|p| p.sheet.layout.series = 14), Status::CellCount);
    assert_eq!(refused(|p| p.sensors = 3), Status::SensorCount);
}

#[test]
fn a_refused_description_leaves_no_bms() {
    let (mut bms, mut state) = started();
    let mut bad = described();
    bad.skew_s = -1.0;
    assert_eq!(init(&mut bms, &bad).0, Status::Parameter);
    // SAFETY: both are references; there is no record.
    let status =
        unsafe { voltstep_bms_start(&raw const *bms, &raw mut *state, null(), 0, 0, 25.0) };
    assert_eq!(status, Status::BmsNotInitialised);
}

#[test]
fn bad_pointers_and_records_are_refused() {
    let (mut bms, mut state) = started();
    let (mut inputs, params, mut record) = (measured(), described(), known());
    let request = VoltstepBmsRequest { vehicle: 2, charger: 0, clear: 0, flags: [0; 3] };
    let mut fresh = blank_state();
    let (mut worth, mut left) = (false, false);
    // SAFETY: bad pointers are refused before they are used; the others are good.
    unsafe {
        let mut outputs: VoltstepBmsOutputs = MaybeUninit::zeroed().assume_init();
        let mut report: VoltstepBmsReport = MaybeUninit::zeroed().assume_init();
        let mut moved = VoltstepBms { opaque: bms.opaque };
        let (b, s, i) = (&raw mut *bms, &raw mut *state, &raw mut inputs);
        let (o, r, f) = (&raw mut outputs, &raw mut record, &raw mut *fresh);
        let (w, q, p) = (&raw mut worth, &raw const request, &raw const params);
        for call in [voltstep_bms_tick, voltstep_bms_fast, voltstep_bms_filter] {
            assert_eq!(call(b, s, i, o), Status::Ok);
            assert_eq!(call(null(), s, i, o), Status::NullPointer);
            assert_eq!(call(b, null_mut(), i, o), Status::NullPointer);
            assert_eq!(call(b, s, null(), o), Status::NullPointer);
            assert_eq!(call(b, s, i, null_mut()), Status::NullPointer);
            assert_eq!(call(b.byte_add(8), s, i, o), Status::Misaligned);
            assert_eq!(call(b, b.cast(), i, o), Status::Overlap);
            assert_eq!(call(b, f, i, o), Status::StateNotInitialised);
            assert_eq!(call(&raw mut moved, s, i, o), Status::BmsMoved);
        }
        assert_eq!(voltstep_bms_init(null_mut(), p, null_mut()), Status::NullPointer);
        assert_eq!(voltstep_bms_init(b, null(), null_mut()), Status::NullPointer);
        assert_eq!(voltstep_bms_start(b, null_mut(), null(), 0, 0, 25.0), Status::NullPointer);
        assert_eq!(voltstep_bms_start(b, b.cast(), null(), 0, 0, 25.0), Status::Overlap);
        assert_eq!(voltstep_bms_start(b, s, null(), 0, 0, 900.0), Status::TemperatureC);
        assert_eq!(voltstep_bms_request(b, s, null()), Status::NullPointer);
        assert_eq!(voltstep_bms_request(b, f, q), Status::StateNotInitialised);
        assert_eq!(voltstep_bms_slow(b, s, null_mut()), Status::Ok);
        assert_eq!(voltstep_bms_slow(b, f, &raw mut left), Status::StateNotInitialised);
        assert_eq!(voltstep_bms_report(b, s, null_mut()), Status::NullPointer);
        assert_eq!(voltstep_bms_report(b, f, &raw mut report), Status::StateNotInitialised);
        assert_eq!(voltstep_bms_record(b, s, 0, 0, r, null_mut()), Status::NullPointer);
        assert_eq!(voltstep_bms_record(b, s, 0, 0, null_mut(), w), Status::NullPointer);
        assert_eq!(voltstep_bms_worth_keeping(b, s, 0, 0, null_mut()), Status::NullPointer);
        assert_eq!(voltstep_bms_start(b, s, r, 1, 100, 25.0), Status::Ok);
        (*r).soc = 2.0;
        assert_eq!(voltstep_bms_start(b, s, r, 1, 100, 25.0), Status::RecordSoc);
    }
}

#[test]
fn what_the_hardware_says_arrives() {
    use VoltstepBmsRow as Row;
    let well = after(300, |_| ());
    assert_eq!(well.phase, VoltstepBmsPhase::Standby as u32);
    assert_eq!((well.tripped, well.cell_v.usable), ([0; 3], u32::from(CELLS)));
    assert!((well.cell_v.mean - 3.7).abs() < 1e-5 && (well.soc - well.soc_mean).abs() < 0.1);

    let crash = after(300, |i| i.flags[Row::Crash as usize / 32] = 1 << (Row::Crash as u32 % 32));
    assert!(tripped(&crash, Row::Crash) && crash.trip == VoltstepBmsTrip::Crash as u32);
    // A number that is no row.
    assert_eq!(after(300, |i| i.flags[2] = 1 << 31).tripped, [0; 3]);
    assert!(tripped(&after(300, |i| i.cell_v[17] = f32::NAN), Row::StaleCell));
    assert!(tripped(&after(300, |i| i.cells_new = 0), Row::StaleCell));
    assert!(tripped(&after(300, |i| i.current_new = 0), Row::StaleCurrent));
    assert!(tripped(&after(300, |i| i.cell_v[0] = 4.4), Row::CellVoltageHighMsl));
    assert!(tripped(&after(3000, |i| i.temperature_c[3] = 70.0), Row::TemperatureDischargeHighMsl));
    assert!(tripped(&after(300, |i| i.pin_failed = 1), Row::Pin));
    assert!(tripped(&after(3000, |i| i.cells_found = 17), Row::CellCount));
    assert!(!tripped(&after(3000, |i| i.cells_found = 18), Row::CellCount));
    // Beyond the temperatures that there are nothing is read.
    assert_eq!(after(300, |i| i.temperature_c[4] = 900.0).tripped, [0; 3]);
    let apart = |measured| {
        after(3000, |i| {
            (i.current_a, i.second_current_measured) = (50.0, measured);
        })
    };
    assert!(tripped(&apart(1), Row::CurrentsDiffer) && !tripped(&apart(0), Row::CurrentsDiffer));
    let silent = after(3000, |i| i.insulation_watched = 1);
    assert!(tripped(&silent, Row::InsulationMol));
    let wire = after(3000, |i| (i.wires_tested, i.wires_v[18]) = (1, 1.0));
    assert!(tripped(&wire, Row::OpenWire));
    let welded = after(300, |i| i.feedback[0] = VoltstepBmsFeedback::Closed as u32);
    assert_ne!(welded.phase, VoltstepBmsPhase::Standby as u32);
    let unread = after(300, |i| i.feedback = [77; 3]);
    assert_ne!(unread.phase, VoltstepBmsPhase::Standby as u32);
}
