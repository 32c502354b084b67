use plant_core::presets::PANASONIC_NCR18650PF as CELL;
use voltstep_bms::manage::BmsParams;
use voltstep_bms::protect::{EXAMPLE, Id, Level, Side};

use super::*;

const OVER: Id = Id::CellVoltage(Side::High, Level::Msl);

fn changed(changes: &[&str]) -> Result<Description, ChangeError> {
    let changes: Vec<Change> = changes.iter().map(|text| text.parse().unwrap()).collect();
    change::applied(BmsParams::typical(EXAMPLE, CELL, 33.0), &changes)
}

#[test]
fn rows_and_parameters_are_changed_by_name() {
    let usual = changed(&[]).unwrap();
    assert_eq!(usual.params(), &BmsParams::typical(EXAMPLE, CELL, 33.0), "to the last bit");
    let row = usual.table().row(OVER);
    let by =
        changed(&["CellVoltage(High, Msl).threshold -= 0.02", "cellvoltage(high,msl).count=2"]);
    let by = *by.unwrap().table().row(OVER);
    assert!((row.threshold - by.threshold - 0.02).abs() < 1e-6 && by.debounce.count == 2);
    let wider = changed(&["sheet.cell.voltage.absolute_max_v+=0.1", "precharge.count=7"]).unwrap();
    assert!((wider.table().row(OVER).threshold - row.threshold - 0.1).abs() < 1e-5);
    assert_eq!(wider.params().precharge.count, 7);
    // A row of the user's on top of what follows from a parameter.
    let both = changed(&["Crash.count=3", "sheet.actuators.break_a=55"]).unwrap();
    assert_eq!(both.table().row(Id::Crash).debounce.count, 3);
    assert_eq!(both.params().sheet.actuators.break_a, 55.0);
}

#[test]
fn what_cannot_be_changed_is_refused_by_name() {
    for text in ["threshold", "=1", "a=b", "a=nan", "a-=", ""] {
        let error = text.parse::<Change>().unwrap_err();
        assert_eq!(error, ChangeError::Form(text.to_owned()));
    }
    for (text, part) in [
        ("CellVoltage(High,Msl).colour=1", "a row has threshold"),
        ("CellVoltage(Up,Msl).threshold=1", "`CellVoltage(Up,Msl)` is none of: alike"),
        ("sheet.cell.volts=1", "`volts` is none of: "),
        ("sheet.cell=1", "it is a table"),
        ("sample_s=0.3", "bms.sample_s"),
        ("Crash.count=0", "row.debounce.count"),
        ("Crash.count=-1", "-1 is no count"),
        ("precharge.count=300", "u8"),
    ] {
        let error = changed(&[text]).unwrap_err().to_string();
        assert!(error.contains(part), "{text}: {error}");
    }
}

#[test]
fn changes_are_written_as_they_are_read() {
    for text in ["a.b=1.5", "Crash.count+=2", "a-=0.02"] {
        assert_eq!(text.parse::<Change>().unwrap().to_string(), text);
    }
}
