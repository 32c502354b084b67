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
    let report = |verdict, false_trips| Report {
        cases: vec![good.clone(), Judged { verdict, ..good.clone() }],
        hours: 1.0,
        false_trips,
    };
    assert!(report(Verdict::Noticed, Vec::new()).is_good());
    assert!(!report(Verdict::Late, Vec::new()).is_good());
    assert!(!report(Verdict::Missed, Vec::new()).is_good());
    assert!(!report(Verdict::InTime, vec![String::from("Stale")]).is_good());
}
