//! The table of rows, derived from the description of the pack.

use plant_core::error::{check, finite, not_negative};
use plant_core::{ParamError, Real};

use super::debounce::Debounce;
use super::derive::derived;
use super::id::{Flow, Id, Level, ROWS, Side};
use super::row::{Clear, Pace, Reaction, Row};
use super::sheet::PackSheet;

/// Every row, and what it was derived from. Made and checked when compiling.
///
/// ```
/// use voltstep_bms::must;
/// use voltstep_bms::protect::{EXAMPLE, Id, Level, Reaction, Side, Table};
///
/// const TABLE: Table = must!(Table::new(EXAMPLE));
/// let row = TABLE.row(Id::CellVoltage(Side::High, Level::Msl));
/// assert!(row.threshold > 4.2 && row.threshold < 4.25);
/// assert_eq!(row.reaction, Reaction::Hard);
/// ```
/// What cannot protect does not compile:
/// ```compile_fail
/// use voltstep_bms::must;
/// use voltstep_bms::protect::{EXAMPLE, PackSheet, Table};
///
/// // Cells looked at every 0.1 s: a voltage cannot trip within that.
/// const TABLE: Table = must!(Table::new(PackSheet { sweep_ticks: 100, ..EXAMPLE }));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table {
    sheet: PackSheet,
    rows: [Row; ROWS],
}

impl Table {
    /// Derives every row from the sheet.
    ///
    /// # Errors
    /// [`ParamError`] names what is out of range: a field of the sheet, or one whose limits lie so
    /// close together that a sensor cannot tell them apart.
    pub const fn new(sheet: PackSheet) -> Result<Self, ParamError> {
        check!(sheet.checked());
        let mut rows = [Row {
            id: Id::Crash,
            level: Level::Msl,
            threshold: 0.5,
            hysteresis: 0.0,
            pace: Pace::Tick,
            debounce: Debounce { count: 1, delay: 0, heal: 1, missing: 1 },
            clear: Clear::No,
            reaction: Reaction::Log,
        }; ROWS];
        let mut i = 0;
        while i < ROWS {
            rows[i] = derived(&sheet, Id::ALL[i]);
            i += 1;
        }
        Self { sheet, rows }.checked()
    }

    /// The table with a row of the user's own in place of the derived one.
    ///
    /// # Errors
    /// [`ParamError`] as for [`new`](Self::new).
    pub const fn with(mut self, row: Row) -> Result<Self, ParamError> {
        let index = row.id.index() as usize;
        if index >= ROWS {
            return Err(ParamError::OutOfRange("row.id"));
        }
        self.rows[index] = row;
        self.checked()
    }

    /// The same, with the row checked by itself alone: to ask what would have been. Limits may lie
    /// closer than a sensor can tell, which is nothing for a product.
    ///
    /// # Errors
    /// [`ParamError`] names what is wrong with the row.
    pub const fn supposing(mut self, row: Row) -> Result<Self, ParamError> {
        let index = row.id.index() as usize;
        if index >= ROWS {
            return Err(ParamError::OutOfRange("row.id"));
        }
        self.rows[index] = row;
        self.each_checked()
    }

    /// Every row, in the order of [`Id::index`].
    #[must_use]
    pub const fn rows(&self) -> &[Row; ROWS] {
        &self.rows
    }

    /// One row.
    #[must_use]
    pub const fn row(&self, id: Id) -> &Row {
        // Each index is below `ROWS`, as the list of them shows when compiling.
        let index = id.index() as usize;
        if index < ROWS { &self.rows[index] } else { &self.rows[0] }
    }

    /// What it was derived from.
    #[must_use]
    pub const fn sheet(&self) -> &PackSheet {
        &self.sheet
    }

    /// Time between two judgements of a row \[s\].
    #[must_use]
    pub const fn period_s(&self, row: &Row) -> Real {
        match row.pace {
            Pace::Tick => self.sheet.tick_s,
            Pace::Sweep => self.sheet.sweep_s(),
        }
    }

    /// The longest time from an event until its row has tripped \[s\]: count, delay, and where cells
    /// are looked at in turn, one sweep.
    #[must_use]
    pub const fn longest_s(&self, row: &Row) -> Real {
        let judgements = row.debounce.count as Real + row.debounce.delay as Real;
        let turn = match row.pace {
            Pace::Tick => 0.0,
            Pace::Sweep => 1.0,
        };
        (judgements + turn) * self.period_s(row)
    }

    const fn each_checked(self) -> Result<Self, ParamError> {
        let mut i = 0;
        while i < ROWS {
            let row = &self.rows[i];
            if row.id.index() as usize != i {
                return Err(ParamError::OutOfRange("row.id"));
            }
            check!(finite("row.threshold", row.threshold));
            check!(not_negative("row.hysteresis", row.hysteresis));
            // One sample of something that is measured may be noise.
            let least = if row.hysteresis > 0.0 { 2 } else { 1 };
            if row.debounce.count < least {
                return Err(ParamError::OutOfRange("row.debounce.count"));
            }
            if row.debounce.heal == 0 {
                return Err(ParamError::OutOfRange("row.debounce.heal"));
            }
            // What is only written down is written down when it happens.
            if row.debounce.delay > 0 && matches!(row.reaction, Reaction::Log) {
                return Err(ParamError::OutOfRange("row.debounce.delay"));
            }
            i += 1;
        }
        Ok(self)
    }

    const fn checked(self) -> Result<Self, ParamError> {
        check!(self.each_checked());
        check!(self.apart(
            "sheet.voltage.absolute_min_v",
            [
                Id::CellVoltage(Side::Low, Level::Mol),
                Id::CellVoltage(Side::Low, Level::Rsl),
                Id::CellVoltage(Side::Low, Level::Msl),
            ],
            self.sheet.sensing.cell_v.error,
        ));
        check!(self.apart(
            "sheet.voltage.absolute_max_v",
            [
                Id::CellVoltage(Side::High, Level::Mol),
                Id::CellVoltage(Side::High, Level::Rsl),
                Id::CellVoltage(Side::High, Level::Msl),
            ],
            self.sheet.sensing.cell_v.error,
        ));
        check!(self.temperatures_apart(Flow::Discharge));
        check!(self.temperatures_apart(Flow::Charge));
        check!(self.currents_apart("sheet.discharge.ten_seconds_a", Flow::Discharge));
        check!(self.currents_apart("sheet.charge.ten_seconds_a", Flow::Charge));
        // A current beyond its limit must still be shown.
        let shown = &self.sheet.sensing.current_a;
        let discharge = self.row(Id::Current(Flow::Discharge, Level::Msl));
        let charge = self.row(Id::Current(Flow::Charge, Level::Msl));
        if discharge.threshold > 0.9 * shown.highest || charge.threshold > -0.9 * shown.lowest {
            return Err(ParamError::OutOfRange("sensing.current_a"));
        }
        Ok(self)
    }

    const fn temperatures_apart(&self, flow: Flow) -> Result<(), ParamError> {
        let [low, high] = match flow {
            Flow::Discharge => {
                ["sheet.discharge_window.none_below_c", "sheet.discharge_window.none_above_c"]
            }
            Flow::Charge => {
                ["sheet.charge_window.none_below_c", "sheet.charge_window.none_above_c"]
            }
        };
        let error = self.sheet.sensing.temperature_c.error;
        let levels = [Level::Mol, Level::Rsl, Level::Msl];
        check!(self.apart(low, temperatures(flow, Side::Low, levels), error));
        check!(self.apart(high, temperatures(flow, Side::High, levels), error));
        Ok(())
    }

    const fn currents_apart(&self, field: &'static str, flow: Flow) -> Result<(), ParamError> {
        self.apart(
            field,
            [
                Id::Current(flow, Level::Mol),
                Id::Current(flow, Level::Rsl),
                Id::Current(flow, Level::Msl),
            ],
            self.sheet.sensing.current_a.error,
        )
    }

    /// The three limits of a quantity lie in order, the last two so far apart that the sensor can
    /// tell one from the other.
    const fn apart(
        &self,
        field: &'static str,
        ids: [Id; 3],
        error: Real,
    ) -> Result<(), ParamError> {
        let [mol, rsl, msl] = [self.row(ids[0]), self.row(ids[1]), self.row(ids[2])];
        let outward = match ids[0].side() {
            Side::High => 1.0,
            Side::Low => -1.0,
        };
        let least = 2.0 * (error + msl.hysteresis);
        if outward * (rsl.threshold - mol.threshold) >= 0.0
            && outward * (msl.threshold - rsl.threshold) >= least
        {
            Ok(())
        } else {
            Err(ParamError::OutOfRange(field))
        }
    }
}

const fn temperatures(flow: Flow, side: Side, levels: [Level; 3]) -> [Id; 3] {
    let [mol, rsl, msl] = levels;
    [
        Id::Temperature(flow, side, mol),
        Id::Temperature(flow, side, rsl),
        Id::Temperature(flow, side, msl),
    ]
}
