//! Cells and temperatures.

use plant_core::Real;

use super::field::{Field, Layout, Message};
use crate::measure::{Reading, Spread};

const LOWEST_V: Field = Field::value("LowestVoltage", 0, 16, 0.0001, 0.0).valid_at(62);
const HIGHEST_V: Field = Field::value("HighestVoltage", 16, 16, 0.0001, 0.0).valid_at(63);
const LOWEST_CELL: Field = Field::raw("LowestCell", 32, 10);
const HIGHEST_CELL: Field = Field::raw("HighestCell", 42, 10);
const CELLS_MISSING: Field = Field::raw("CellsMissing", 52, 10);
pub(super) const CELL_EXTREMES: Layout = Layout {
    id: 0x513,
    length: 8,
    name: "CellExtremes",
    fields: &[LOWEST_V, HIGHEST_V, LOWEST_CELL, HIGHEST_CELL, CELLS_MISSING],
};

const COLDEST_C: Field = Field::value("ColdestTemperature", 0, 12, 0.1, -100.0).valid_at(54);
const HOTTEST_C: Field = Field::value("HottestTemperature", 12, 12, 0.1, -100.0).valid_at(55);
const COLDEST_SENSOR: Field = Field::raw("ColdestSensor", 24, 10);
const HOTTEST_SENSOR: Field = Field::raw("HottestSensor", 34, 10);
const SENSORS_MISSING: Field = Field::raw("SensorsMissing", 44, 10);
pub(super) const TEMPERATURE_EXTREMES: Layout = Layout {
    id: 0x514,
    length: 8,
    name: "TemperatureExtremes",
    fields: &[COLDEST_C, HOTTEST_C, COLDEST_SENSOR, HOTTEST_SENSOR, SENSORS_MISSING],
};

/// How many cells a frame holds.
pub const CELLS_IN_A_GROUP: usize = 4;

const GROUP: Field = Field::raw("Group", 0, 8);
const CELL_V: [Field; CELLS_IN_A_GROUP] = [
    Field::value("Voltage0", 8, 13, 0.001, 0.0).valid_at(60),
    Field::value("Voltage1", 21, 13, 0.001, 0.0).valid_at(61),
    Field::value("Voltage2", 34, 13, 0.001, 0.0).valid_at(62),
    Field::value("Voltage3", 47, 13, 0.001, 0.0).valid_at(63),
];
pub(super) const CELLS: Layout = Layout {
    id: 0x515,
    length: 8,
    name: "Cells",
    fields: &[GROUP, CELL_V[0], CELL_V[1], CELL_V[2], CELL_V[3]],
};

/// Ends of what several sensors of one quantity show. Places and counts end at 1023.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Ends {
    low: Real,
    high: Real,
    low_index: u16,
    high_index: u16,
    missing: u16,
}

impl Ends {
    fn of(readings: &[Reading], oldest_s: Real) -> Self {
        let short = |number: usize| u16::try_from(number).unwrap_or(u16::MAX);
        match Spread::of(readings, oldest_s) {
            None => Self {
                low: Real::NAN,
                high: Real::NAN,
                low_index: 0,
                high_index: 0,
                missing: short(readings.len()),
            },
            Some(spread) => Self {
                low: spread.min,
                high: spread.max,
                low_index: short(spread.min_index),
                high_index: short(spread.max_index),
                missing: short(readings.len().saturating_sub(spread.usable)),
            },
        }
    }

    fn encode(
        &self,
        layout: &Layout,
        [low, high, low_at, high_at, missing]: [&Field; 5],
    ) -> Message {
        let bits = low.with(0, self.low);
        let bits = high.with(bits, self.high);
        let bits = low_at.with_number(bits, usize::from(self.low_index));
        let bits = high_at.with_number(bits, usize::from(self.high_index));
        layout.message(missing.with_number(bits, usize::from(self.missing)))
    }

    fn decode(bits: u64, [low, high, low_at, high_at, missing]: [&Field; 5]) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "ten bits")]
        let number = |field: &Field| field.raw_of(bits) as u16;
        Self {
            low: low.of(bits),
            high: high.of(bits),
            low_index: number(low_at),
            high_index: number(high_at),
            missing: number(missing),
        }
    }
}

/// The lowest and the highest cell.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CellExtremes {
    /// The lowest \[V\], 0 to 6.5534, in steps of 0.0001; NaN where no cell is usable.
    pub lowest_v: Real,
    /// The highest \[V\], as the lowest.
    pub highest_v: Real,
    /// Which is the lowest, from 0; up to 1023.
    pub lowest_cell: u16,
    /// Which is the highest.
    pub highest_cell: u16,
    /// How many are not usable.
    pub missing: u16,
}

impl CellExtremes {
    const FIELDS: [&Field; 5] =
        [&LOWEST_V, &HIGHEST_V, &LOWEST_CELL, &HIGHEST_CELL, &CELLS_MISSING];

    /// Those of cells, of which none may be older than `oldest_s`.
    #[must_use]
    pub fn of(cell_v: &[Reading], oldest_s: Real) -> Self {
        Self::from_ends(Ends::of(cell_v, oldest_s))
    }

    /// As a message.
    #[must_use]
    pub fn encode(&self) -> Message {
        let ends = Ends {
            low: self.lowest_v,
            high: self.highest_v,
            low_index: self.lowest_cell,
            high_index: self.highest_cell,
            missing: self.missing,
        };
        ends.encode(&CELL_EXTREMES, Self::FIELDS)
    }

    /// Those of a message; `None` where it is another.
    #[must_use]
    pub fn decode(message: &Message) -> Option<Self> {
        Some(Self::from_ends(Ends::decode(message.bits(&CELL_EXTREMES)?, Self::FIELDS)))
    }

    const fn from_ends(ends: Ends) -> Self {
        Self {
            lowest_v: ends.low,
            highest_v: ends.high,
            lowest_cell: ends.low_index,
            highest_cell: ends.high_index,
            missing: ends.missing,
        }
    }
}

/// The coldest and the hottest sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TemperatureExtremes {
    /// The coldest \[°C\], −100 to 309.4, in steps of 0.1; NaN where no sensor is usable.
    pub coldest_c: Real,
    /// The hottest \[°C\], as the coldest.
    pub hottest_c: Real,
    /// Which is the coldest, from 0; up to 1023.
    pub coldest_sensor: u16,
    /// Which is the hottest.
    pub hottest_sensor: u16,
    /// How many are not usable.
    pub missing: u16,
}

impl TemperatureExtremes {
    const FIELDS: [&Field; 5] =
        [&COLDEST_C, &HOTTEST_C, &COLDEST_SENSOR, &HOTTEST_SENSOR, &SENSORS_MISSING];

    /// Those of sensors, of which none may be older than `oldest_s`.
    #[must_use]
    pub fn of(temperature_c: &[Reading], oldest_s: Real) -> Self {
        Self::from_ends(Ends::of(temperature_c, oldest_s))
    }

    /// As a message.
    #[must_use]
    pub fn encode(&self) -> Message {
        let ends = Ends {
            low: self.coldest_c,
            high: self.hottest_c,
            low_index: self.coldest_sensor,
            high_index: self.hottest_sensor,
            missing: self.missing,
        };
        ends.encode(&TEMPERATURE_EXTREMES, Self::FIELDS)
    }

    /// Those of a message; `None` where it is another.
    #[must_use]
    pub fn decode(message: &Message) -> Option<Self> {
        Some(Self::from_ends(Ends::decode(message.bits(&TEMPERATURE_EXTREMES)?, Self::FIELDS)))
    }

    const fn from_ends(ends: Ends) -> Self {
        Self {
            coldest_c: ends.low,
            hottest_c: ends.high,
            coldest_sensor: ends.low_index,
            hottest_sensor: ends.high_index,
            missing: ends.missing,
        }
    }
}

/// Four cells: group k holds those from 4·k.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CellGroup {
    /// Which four.
    pub group: u8,
    /// Their voltages \[V\], 0 to 8.19, in steps of 0.001; NaN where one is not usable, or there is
    /// none.
    pub cell_v: [Real; CELLS_IN_A_GROUP],
}

impl CellGroup {
    /// One group of all cells, of which none may be older than `oldest_s`; `None` beyond the last.
    #[must_use]
    pub fn of(cell_v: &[Reading], oldest_s: Real, group: u8) -> Option<Self> {
        let cells = cell_v.chunks(CELLS_IN_A_GROUP).nth(usize::from(group))?;
        let mut shown = [Real::NAN; CELLS_IN_A_GROUP];
        for (place, cell) in shown.iter_mut().zip(cells) {
            *place = cell.usable_or_nan(oldest_s);
        }
        Some(Self { group, cell_v: shown })
    }

    /// As a message.
    #[must_use]
    pub fn encode(&self) -> Message {
        let bits = GROUP.with_raw(0, u64::from(self.group));
        let cells = CELL_V.iter().zip(self.cell_v);
        CELLS.message(cells.fold(bits, |bits, (field, value)| field.with(bits, value)))
    }

    /// That of a message; `None` where it is another.
    #[must_use]
    pub fn decode(message: &Message) -> Option<Self> {
        let bits = message.bits(&CELLS)?;
        #[expect(clippy::cast_possible_truncation, reason = "eight bits")]
        let group = GROUP.raw_of(bits) as u8;
        Some(Self { group, cell_v: CELL_V.map(|field| field.of(bits)) })
    }
}
