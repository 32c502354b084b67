//! What a campaign must be able to see.

use super::*;

fn of(fault: Fault, severity: usize, soc: f32, celsius: f32) -> Case {
    cases(1)
        .into_iter()
        .find(|case| {
            case.fault == fault
                && case.severity == severity
                && (case.soc - soc).abs() < 1e-6
                && (case.temperature_c - celsius).abs() < 1e-6
        })
        .unwrap()
}

#[test]
fn there_are_enough_cases() {
    assert!(cases(1).len() >= 2500, "{}", cases(1).len());
    let few = cases(10);
    for fault in Fault::ALL {
        assert!(few.iter().any(|case| case.fault == fault), "{fault:?} is in no tenth");
    }
    let reasons = cases(1)
        .iter()
        .filter(|case| case.fault.need_not_be_noticed(case.severity).is_some())
        .count();
    assert!(reasons > 0 && reasons < cases(1).len() / 3, "{reasons}");
}

#[test]
fn a_cell_that_is_overcharged_is_saved_in_time() {
    let judged = judge(&of(Fault::Overcharge, 3, 0.97, 25.0)).unwrap();
    assert_eq!(judged.verdict, Verdict::InTime, "{judged:?}");
    assert!(judged.before_harm_ms.is_some_and(|ms| ms > 0), "{judged:?}");
    assert!(judged.opened_ms.is_some_and(|ms| ms < 300), "{judged:?}");
}

#[test]
fn what_no_contactor_can_do_is_called_so() {
    let judged = judge(&of(Fault::CellShort, 3, 0.03, -15.0)).unwrap();
    assert_eq!(judged.verdict, Verdict::BeyondContactors, "{judged:?}");
    assert_eq!(judged.harm, Some(Harm::Undervoltage));
}

#[test]
fn without_a_bms_a_cell_is_harmed() {
    // The same pack, contactors held closed: the campaign would see a BMS that does nothing.
    let case = of(Fault::Overcharge, 3, 0.97, 25.0);
    let planted = vec![Planted::new(case.fault, case.much, case.from_ms)];
    let place = (case.soc, case.temperature_c);
    let mut drive = Drive::new(place, Demand::of(true), case.seed, planted).unwrap();
    while drive.rig.ms < case.from_ms {
        drive.step();
    }
    assert_eq!((drive.phase(), drive.rig.harm), (Phase::Closed, None));
    drive.rig.held = Some(Coils { minus: true, precharge: false, plus: true });
    for _ in 0..20_000 {
        drive.step();
    }
    assert_eq!(drive.rig.harm, Some(Harm::Overvoltage));
}

#[test]
fn a_report_is_bad_where_one_case_is() {
    let good = judge(&of(Fault::Crash, 0, 0.6, 25.0)).unwrap();
    assert_eq!((good.verdict, good.opened_ms), (Verdict::InTime, Some(1)), "{good:?}");
    let report = |verdict, false_trips| {
        Report::new(vec![good.clone(), Judged { verdict, ..good.clone() }], 1.0, false_trips)
    };
    assert!(report(Verdict::Noticed, Vec::new()).is_good());
    assert!(!report(Verdict::Late, Vec::new()).is_good());
    assert!(!report(Verdict::Missed, Vec::new()).is_good());
    assert!(!report(Verdict::InTime, vec![String::from("Stale")]).is_good());
    let without = Judged { without: vec![String::from("StuckCell")], ..good };
    assert!(!Report::new(vec![without], 1.0, Vec::new()).is_good(), "it trips without a fault");
}

#[test]
fn a_report_counts_kinds_and_reasons() {
    let judged = |fault, verdict, opened_ms, reason| Judged {
        case: Case { fault, ..cases(1)[0] },
        verdict,
        opened_ms,
        before_harm_ms: opened_ms.map(|ms| 10 * ms),
        harm: None,
        reason,
        before: Vec::new(),
        rows: Vec::new(),
        at_the_end: false,
        without: Vec::new(),
    };
    let (one, other) = (Some("one reason"), Some("another"));
    let report = Report::new(
        vec![
            judged(Fault::CellShort, Verdict::Harmless, None, one),
            judged(Fault::CellStuck, Verdict::InTime, Some(90), None),
            judged(Fault::CellStuck, Verdict::InTime, Some(30), None),
            judged(Fault::CellStuck, Verdict::Harmless, None, other),
            judged(Fault::CellShort, Verdict::Harmless, None, one),
        ],
        0.0,
        Vec::new(),
    );
    let kinds: Vec<_> = report.kinds.iter().map(|kind| (kind.fault, kind.cases())).collect();
    assert_eq!(kinds, [(Fault::CellStuck, 3), (Fault::CellShort, 2)], "in the order of all");
    let stuck = &report.kinds[0];
    assert_eq!((stuck.opened_ms, stuck.least_before_harm_ms), (Some((30, 90)), Some(300)));
    assert_eq!(stuck.ended, [2, 0, 1, 0, 0, 0]);
    let why: Vec<_> = report.unnoticed.iter().map(|of| (of.fault, of.cases)).collect();
    assert_eq!(why, [(Fault::CellShort, 2), (Fault::CellStuck, 1)], "the most first");
}

/// What trips in the same drive without the fault is no answer to it.
#[test]
fn what_happens_anyway_is_not_noticed() {
    use voltstep_bms::protect::{Flow, Id, Level};
    let warns = Faults::NONE.with(Id::Current(Flow::Discharge, Level::Mol));
    let healthy = Seen {
        already: Faults::NONE,
        rows: warns,
        driven: warns,
        trip: Trip::Soft,
        reached: true,
        opened_ms: Some(500),
        before_harm_ms: None,
    };
    let beyond = healthy.beyond(&healthy);
    assert!(!beyond.noticed() && beyond.driven.is_empty());
    assert_eq!(beyond.opened_ms, None);
    let more = Seen { rows: warns.with(Id::Imbalance), trip: Trip::Hard, ..healthy };
    let beyond = more.beyond(&healthy);
    assert_eq!((names(beyond.rows), beyond.trip), (vec![String::from("Imbalance")], Trip::Hard));
    let quiet = Seen { opened_ms: None, trip: Trip::None, ..healthy };
    assert_eq!(healthy.beyond(&quiet).opened_ms, Some(500));
}

/// Half a kelvin a second from any temperature: it opens before the cell is too hot, though no current
/// is allowed by then.
#[test]
fn a_cell_that_heats_itself_opens() {
    for (soc, celsius) in [(0.6, 25.0), (0.97, 42.0), (0.2, -15.0)] {
        let judged = judge(&of(Fault::CellHeated, 1, soc, celsius)).unwrap();
        assert_eq!(judged.verdict, Verdict::InTime, "{judged:?}");
        assert!(judged.rows.iter().any(|row| row == "TemperatureRate"), "{judged:?}");
        assert!(judged.opened_ms.is_some_and(|ms| ms < 12_000), "{judged:?}");
    }
}

/// An offset that began while the current changed shows at the latest when none can flow.
#[test]
fn a_drive_ends_before_the_next() {
    let mut case = of(Fault::CurrentOffset, 0, 0.6, 25.0);
    case.charging = false;
    // Pulses change every 700 ms.
    case.from_ms = 3501;
    let judged = judge(&case).unwrap();
    assert_eq!((judged.verdict, judged.at_the_end), (Verdict::Noticed, true), "{judged:?}");
    assert!(judged.rows.iter().any(|row| row == "CurrentWhileOpen"), "{judged:?}");
}

#[test]
fn a_fault_of_a_sensor_is_beyond_what_is_declared() {
    let sensing = &SHEET.sensing;
    let least = |fault: Fault| fault.severities().into_iter().fold(f32::INFINITY, f32::min);
    for (fault, declared) in [
        (Fault::CellReadsHigh, sensing.cell_v.error),
        (Fault::CellReadsLow, sensing.cell_v.error),
        (Fault::TemperatureReadsLow, sensing.temperature_c.error),
        (Fault::CurrentOffset, sensing.current_a.error),
        (Fault::PackVoltageOff, sensing.pack_v.error),
        (Fault::LinkVoltageOff, sensing.link_v.error),
    ] {
        assert!(least(fault) >= 3.0 * declared, "{fault:?}");
    }
    assert!(CHARGER_A * least(Fault::CurrentGain) >= 3.0 * sensing.current_a.error);
    let bears = |continuous_a: f32| f32::from(PARALLEL) * continuous_a;
    assert!(least(Fault::Overcharge) > bears(SHEET.cell.charge.continuous_a));
    assert!(least(Fault::Overload) > bears(SHEET.cell.discharge.continuous_a));
}
