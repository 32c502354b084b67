//! What is derived, and what is refused.

extern crate std;

use std::collections::BTreeSet;

use super::scene::TABLE;
use crate::estimate::power::TemperatureWindow;
use crate::protect::{
    Actuators, CellSheet, Clear, Currents, Debounce, EXAMPLE, Faults, Flow, Id, Layout, Level,
    Pace, PackSheet, Protection, ROWS, Reaction, Row, Sensing, Sensor, Side, Table, VoltageWindow,
};
use crate::{ParamError, Real};

/// Each limit lies between that of operation and the absolute one, in the unit of the sheet.
fn limits_lie_within(rows: &[Row; ROWS]) -> bool {
    let v = &EXAMPLE.cell.voltage;
    let at = |id: Id| rows[usize::from(id.index())].threshold;
    let over = |level| at(Id::CellVoltage(Side::High, level));
    let under = |level| at(Id::CellVoltage(Side::Low, level));
    let windows = [EXAMPLE.cell.discharge_window, EXAMPLE.cell.charge_window];
    over(Level::Mol) == v.operating_max_v
        && over(Level::Rsl) > v.operating_max_v
        && over(Level::Msl) > over(Level::Rsl)
        && over(Level::Msl) <= v.absolute_max_v - 3.0 * EXAMPLE.sensing.cell_v.error
        && under(Level::Mol) == v.operating_min_v
        && under(Level::Rsl) < v.operating_min_v
        && under(Level::Msl) < under(Level::Rsl)
        && under(Level::Msl) >= v.absolute_min_v + 3.0 * EXAMPLE.sensing.cell_v.error
        && [Flow::Discharge, Flow::Charge].into_iter().zip(windows).all(|(flow, window)| {
            let at = |side, level| at(Id::Temperature(flow, side, level));
            let error_k = EXAMPLE.sensing.temperature_c.error;
            at(Side::High, Level::Mol) == window.all_to_c
                && at(Side::Low, Level::Mol) == window.all_from_c
                && at(Side::High, Level::Msl) <= window.none_above_c - 3.0 * error_k
                && at(Side::Low, Level::Msl) >= window.none_below_c + 3.0 * error_k
        })
}

#[test]
fn limits_follow_from_the_sheet() {
    assert!(limits_lie_within(TABLE.rows()));
    // Planted: a limit in millivolts.
    let mut wrong = *TABLE.rows();
    wrong[usize::from(Id::CellVoltage(Side::High, Level::Msl).index())].threshold *= 1000.0;
    assert!(!limits_lie_within(&wrong));
    let at = |id: Id| TABLE.row(id).threshold;
    assert_eq!(at(Id::Current(Flow::Discharge, Level::Mol)), 140.0);
    assert_eq!(at(Id::Current(Flow::Charge, Level::Rsl)), 102.0);
    assert_eq!(at(Id::Current(Flow::Discharge, Level::Msl)), 310.0);
    assert_eq!(at(Id::Surge(Flow::Charge)), 200.0);
    assert_eq!(
        at(Id::PackVoltage(Side::High)),
        14.0 * at(Id::CellVoltage(Side::High, Level::Msl)) + 0.2
    );
    // Where a sensor cannot tell a tenth apart: 100 + 8 + 2 × (8 + 1.2) A.
    let current_a = Sensor { error: 8.0, ..EXAMPLE.sensing.current_a };
    let coarse = PackSheet { sensing: Sensing { current_a, ..EXAMPLE.sensing }, ..EXAMPLE };
    let coarse = Table::new(coarse).unwrap().row(Id::Current(Flow::Charge, Level::Msl)).threshold;
    assert!((coarse - 126.4).abs() < 1e-4, "{coarse}");
    let heat = 10.0 * (280.0 * 280.0 - 140.0 * 140.0);
    assert_eq!(at(Id::Heat(Flow::Discharge)), heat);
}

#[test]
fn ids_are_unique_and_found_again() {
    let indices: BTreeSet<u8> = Id::ALL.iter().map(|id| id.index()).collect();
    assert_eq!(indices.len(), ROWS);
    for id in Id::ALL {
        assert_eq!(Id::at(id.index()), Some(id));
        let one = Faults::NONE.with(id);
        assert!(one.has(id) && one.iter().eq([id]) && one.without(id).is_empty());
        assert_eq!(one.bits(), 1 << id.index());
        assert_eq!(TABLE.row(id).id, id);
    }
    assert_eq!(Id::at(84), None);
    let (a, b) = (Faults::NONE.with(Id::Crash), Faults::NONE.with(Id::Pin));
    assert_eq!(a.union(b).minus(a), b);
}

fn refused(sheet: PackSheet) -> &'static str {
    Table::new(sheet).expect_err("refused").field()
}

fn with_cell(cell: CellSheet) -> PackSheet {
    PackSheet { cell, ..EXAMPLE }
}

#[test]
fn a_sheet_out_of_range_is_refused_by_name() {
    let cell = EXAMPLE.cell;
    let v = cell.voltage;
    for bad in [Real::NAN, -1.0] {
        for (voltage, field) in [
            (VoltageWindow { deep_v: bad, ..v }, "sheet.voltage.deep_v"),
            (VoltageWindow { absolute_min_v: bad, ..v }, "sheet.voltage.absolute_min_v"),
            (VoltageWindow { operating_min_v: bad, ..v }, "sheet.voltage.operating_min_v"),
            (VoltageWindow { operating_max_v: bad, ..v }, "sheet.voltage.operating_max_v"),
            (VoltageWindow { absolute_max_v: bad, ..v }, "sheet.voltage.absolute_max_v"),
        ] {
            assert_eq!(refused(with_cell(CellSheet { voltage, ..cell })), field);
        }
        let currents = |continuous_a, ten_seconds_a| Currents { continuous_a, ten_seconds_a };
        for (changed, field) in [
            (CellSheet { discharge: currents(bad, 9.0), ..cell }, "sheet.discharge.continuous_a"),
            (CellSheet { discharge: currents(7.0, bad), ..cell }, "sheet.discharge.ten_seconds_a"),
            (CellSheet { charge: currents(bad, 9.0), ..cell }, "sheet.charge.continuous_a"),
            (CellSheet { charge: currents(7.0, bad), ..cell }, "sheet.charge.ten_seconds_a"),
            (CellSheet { capacity_ah: bad, ..cell }, "sheet.capacity_ah"),
            (CellSheet { resistance_ohm: bad, ..cell }, "sheet.resistance_ohm"),
            (CellSheet { heat_capacity_j_per_k: bad, ..cell }, "sheet.heat_capacity_j_per_k"),
        ] {
            assert_eq!(refused(with_cell(changed)), field);
        }
        for (actuators, field) in [
            (Actuators { open_s: bad, ..EXAMPLE.actuators }, "actuators.open_s"),
            (Actuators { wait_s: bad, ..EXAMPLE.actuators }, "actuators.wait_s"),
            (Actuators { break_a: bad, ..EXAMPLE.actuators }, "actuators.break_a"),
        ] {
            assert_eq!(refused(PackSheet { actuators, ..EXAMPLE }), field);
        }
        assert_eq!(refused(PackSheet { tick_s: bad, ..EXAMPLE }), "tick_s");
    }
    for (layout, field) in [
        (Layout { series: 0, parallel: 1 }, "layout.series"),
        (Layout { series: 1, parallel: 0 }, "layout.parallel"),
    ] {
        assert_eq!(refused(PackSheet { layout, ..EXAMPLE }), field);
    }
    for sweep_ticks in [0, 26] {
        assert_eq!(refused(PackSheet { sweep_ticks, ..EXAMPLE }), "sweep_ticks");
    }
    assert_eq!(refused(PackSheet { tick_s: 0.0051, sweep_ticks: 1, ..EXAMPLE }), "tick_s");
    let window = |none_below_c, all_from_c, all_to_c, none_above_c| TemperatureWindow {
        none_below_c,
        all_from_c,
        all_to_c,
        none_above_c,
    };
    for (bad, field) in [
        (window(Real::NAN, 0.0, 40.0, 60.0), "none_below_c"),
        (window(0.0, -1.0, 40.0, 60.0), "all_from_c"),
        (window(-20.0, 0.0, -1.0, 60.0), "all_to_c"),
        (window(-20.0, 0.0, 40.0, 39.0), "none_above_c"),
        (window(-20.0, 0.0, 40.0, Real::INFINITY), "none_above_c"),
    ] {
        let discharge = refused(with_cell(CellSheet { discharge_window: bad, ..cell }));
        assert_eq!(discharge.strip_prefix("sheet.discharge_window."), Some(field));
        let charge = refused(with_cell(CellSheet { charge_window: bad, ..cell }));
        assert_eq!(charge.strip_prefix("sheet.charge_window."), Some(field));
    }
    let sensors = EXAMPLE.sensing;
    let bad = Sensor { period_s: 0.0, ..sensors.cell_v };
    for (sensing, field) in [
        (Sensing { cell_v: bad, ..sensors }, "sensing.cell_v"),
        (Sensing { temperature_c: bad, ..sensors }, "sensing.temperature_c"),
        (Sensing { current_a: bad, ..sensors }, "sensing.current_a"),
        (Sensing { pack_v: bad, ..sensors }, "sensing.pack_v"),
        (Sensing { link_v: bad, ..sensors }, "sensing.link_v"),
    ] {
        assert_eq!(refused(PackSheet { sensing, ..EXAMPLE }), field);
    }
    for cell_v in [
        Sensor { error: -0.1, ..sensors.cell_v },
        Sensor { noise_sd: Real::NAN, ..sensors.cell_v },
        Sensor { resolution: 0.0, ..sensors.cell_v },
        Sensor { lowest: 5.0, ..sensors.cell_v },
        Sensor { highest: Real::INFINITY, ..sensors.cell_v },
    ] {
        let sensing = Sensing { cell_v, ..sensors };
        assert_eq!(refused(PackSheet { sensing, ..EXAMPLE }), "sensing.cell_v");
    }
}

/// Limits that a sensor cannot tell apart, and currents that it cannot show.
#[test]
fn sensors_that_cannot_protect_are_refused() {
    let sensors = EXAMPLE.sensing;
    let coarse = Sensor { error: 0.012, ..sensors.cell_v };
    let sensing = Sensing { cell_v: coarse, ..sensors };
    assert_eq!(refused(PackSheet { sensing, ..EXAMPLE }), "sheet.voltage.absolute_max_v");
    let coarse = Sensor { error: 2.5, ..sensors.temperature_c };
    let sensing = Sensing { temperature_c: coarse, ..sensors };
    assert_eq!(refused(PackSheet { sensing, ..EXAMPLE }), "sheet.discharge_window.none_below_c");
    for (lowest, highest) in [(-600.0, 320.0), (-120.0, 600.0)] {
        let current_a = Sensor { lowest, highest, ..sensors.current_a };
        let sensing = Sensing { current_a, ..sensors };
        assert_eq!(refused(PackSheet { sensing, ..EXAMPLE }), "sensing.current_a");
    }
}

#[test]
fn a_row_of_the_users_own_is_checked_too() {
    let over = *TABLE.row(Id::CellVoltage(Side::High, Level::Msl));
    let own = Row { threshold: over.threshold - 0.001, clear: Clear::Service, ..over };
    assert_eq!(*TABLE.with(own).unwrap().row(over.id), own);
    let debounce = over.debounce;
    let warning = *TABLE.row(Id::CellVoltage(Side::High, Level::Mol));
    for (row, error) in [
        (Row { threshold: Real::NAN, ..over }, ParamError::NotFinite("row.threshold")),
        (Row { hysteresis: -0.1, ..over }, ParamError::Negative("row.hysteresis")),
        (
            Row { debounce: Debounce { count: 1, ..debounce }, ..over },
            ParamError::OutOfRange("row.debounce.count"),
        ),
        (
            Row { debounce: Debounce { heal: 0, ..debounce }, ..over },
            ParamError::OutOfRange("row.debounce.heal"),
        ),
        (
            Row { debounce: Debounce { delay: 1, ..warning.debounce }, ..warning },
            ParamError::OutOfRange("row.debounce.delay"),
        ),
        (Row { threshold: 4.21, ..over }, ParamError::OutOfRange("sheet.voltage.absolute_max_v")),
    ] {
        assert_eq!(TABLE.with(row), Err(error));
    }
    assert_eq!(Reaction::Derate.trip(), crate::protect::Trip::None);
}

#[test]
fn a_table_of_another_pack_is_refused() {
    let error = ParamError::LengthsDiffer("layout.series");
    assert_eq!(Protection::<13, 4>::new(&TABLE).err(), Some(error));
    assert_eq!(Protection::<14, 0>::new(&TABLE).err(), Some(error));
}

/// Threshold, hysteresis, count, delay and pace of each row of the example, worked out by hand from its
/// sheet, in the order of the ids.
///
/// A safety limit lies within the absolute one by three errors of the sensor and what the quantity
/// moves until the contactors are open: 20 × 1.4 V × 14 A / 5 A·h = 0.021778 V/s,
/// (14 A)² × 0.06 Ω / 65 J/K = 0.180923 K/s, over 0.1 s and 1 s of detection, 0.05 s of waiting and 0.02 s of
/// opening; the middle limit is the mean. A sweep is 20 ticks of 1 ms, one of its judgements is kept
/// for its turn. Stale: what 1.5 periods and a tick leave of 100 ms.
const BY_HAND: [(Real, Real, u16, u16, Pace); ROWS] = {
    use Pace::{Sweep as S, Tick as T};
    [
        (2.8, 0.002, 4, 0, S),
        (2.654_851, 0.002, 4, 0, S),
        (2.509_702, 0.002, 4, 0, S),
        (4.2, 0.002, 4, 0, S),
        (4.220_149, 0.002, 4, 0, S),
        (4.240_298, 0.002, 4, 0, S),
        (-10.0, 0.2, 49, 0, S),
        (-13.5, 0.2, 49, 0, S),
        (-17.0, 0.2, 49, 0, S),
        (45.0, 0.2, 49, 0, S),
        (50.903_206, 0.2, 49, 0, S),
        (56.8064, 0.2, 49, 0, S),
        (10.0, 0.2, 49, 0, S),
        (6.5, 0.2, 49, 0, S),
        (3.0, 0.2, 49, 0, S),
        (45.0, 0.2, 49, 0, S),
        (48.403_206, 0.2, 49, 0, S),
        (51.8064, 0.2, 49, 0, S),
        // 20 × 7 A; 20 × 14 A and the error; a tenth of the 280 A more.
        (140.0, 1.2, 20, 0, T),
        (282.0, 1.2, 20, 0, T),
        (310.0, 1.2, 20, 0, T),
        (50.0, 1.2, 20, 0, T),
        (102.0, 1.2, 20, 0, T),
        (112.0, 1.2, 20, 0, T),
        // Twice 280 A, at most 0.9 of what is shown.
        (540.0, 1.2, 2, 0, T),
        (200.0, 1.2, 2, 0, T),
        // 10 s × (280² − 140²) A².
        (588_000.0, 58_800.0, 2, 0, T),
        (75_000.0, 7_500.0, 2, 0, T),
        // 14 cells, and the pack's own error.
        (34.9358, 0.08, 100, 0, T),
        (59.5642, 0.08, 100, 0, T),
        (0.5, 0.0, 2, 0, S),
        (0.5, 0.0, 2, 0, S),
        (0.5, 0.0, 97, 0, T),
        (0.5, 0.0, 96, 0, T),
        (0.5, 0.0, 96, 0, T),
        (0.5, 0.0, 4, 0, S),
        (0.5, 0.0, 4, 0, S),
        (0.5, 0.0, 100, 0, T),
        (0.5, 0.0, 100, 0, T),
        (0.5, 0.0, 100, 0, T),
        // The machine of the contactors has waited already.
        (0.5, 0.0, 1, 0, T),
        (0.5, 0.0, 1, 0, T),
        (0.5, 0.0, 1, 0, T),
        (0.5, 0.0, 1, 0, T),
        (0.5, 0.0, 1, 0, T),
        (0.5, 0.0, 1, 0, T),
        (0.5, 0.0, 1, 0, T),
        (0.5, 0.0, 1, 0, T),
        (0.5, 0.0, 1, 0, T),
        (0.5, 0.0, 1, 0, T),
        (500.0, 50.0, 49, 0, S),
        (300.0, 30.0, 49, 0, S),
        (100.0, 10.0, 49, 0, S),
        (2.0, 0.002, 4, 0, S),
        (3.2, 1.2, 100, 500, T),
        (570.0, 1.2, 2, 0, T),
        // 14 × 2 mV + 0.2 V + 2 × 80 mV, for half a second; 0.2 V + 0.2 V likewise.
        (0.388, 0.08, 2, 25, S),
        (0.56, 0.08, 2, 500, T),
        (5.2, 1.2, 2, 500, T),
        // A tenth of 1.4 V, for 10 s.
        (0.14, 0.002, 2, 500, S),
        (0.5, 0.0, 2, 0, S),
        (0.5, 0.0, 2, 0, S),
        (0.5, 0.0, 2, 0, S),
        (0.5, 0.0, 2, 0, S),
        (0.14, 0.002, 2, 500, S),
        (15.0, 0.2, 2, 500, S),
        // What heaters do, and two hysteresises in 10 s.
        (0.14, 0.02, 49, 0, S),
        (0.4, 0.1, 2, 0, S),
        (0.5, 0.0, 2, 0, T),
        (0.5, 0.0, 1, 0, T),
        (0.5, 0.0, 100, 0, T),
        (0.5, 0.0, 2, 0, T),
        (0.5, 0.0, 2, 0, T),
        (0.5, 0.0, 2, 0, S),
        (0.5, 0.0, 2, 0, T),
        (0.5, 0.0, 2, 0, T),
        (0.5, 0.0, 2, 0, T),
        (2.0, 0.5, 2, 0, T),
        (0.5, 0.0, 2, 0, S),
        (0.5, 0.0, 2, 0, T),
        (0.5, 0.0, 2, 0, S),
        (0.5, 0.0, 2, 0, S),
        (0.5, 0.0, 2, 0, S),
        (0.5, 0.0, 2, 0, S),
    ]
};

#[test]
fn the_example_is_as_worked_out_by_hand() {
    for (row, (threshold, hysteresis, count, delay, pace)) in TABLE.rows().iter().zip(BY_HAND) {
        let near = |a: Real, b: Real| (a - b).abs() <= 2e-6 * b.abs().max(0.5);
        assert!(near(row.threshold, threshold), "{row:?}, not {threshold}");
        assert!(near(row.hysteresis, hysteresis), "{row:?}, not {hysteresis}");
        // A second heals, a missing sample counts where nothing but its coming is watched.
        let heal = if pace == Pace::Tick { 1000 } else { 50 };
        let missing = matches!(row.id, Id::Stale(_) | Id::Insulation(Level::Mol));
        let debounce = Debounce { count, delay, heal, missing: u8::from(missing) };
        assert_eq!((row.debounce, row.pace), (debounce, pace), "{:?}", row.id);
        let (period_s, turn) = if pace == Pace::Tick { (0.001, 0.0) } else { (0.02, 1.0) };
        let longest_s = (Real::from(count) + Real::from(delay) + turn) * period_s;
        assert!((TABLE.longest_s(row) - longest_s).abs() < 1e-5, "{row:?}");
    }
}
