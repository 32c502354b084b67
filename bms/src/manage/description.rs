//! One description of a pack, checked.

use plant_core::battery::{MappedBattery, MappedBatteryParams};
use plant_core::error::{check, finite, not_negative, positive, ratio};
use plant_core::{Dt, ParamError, Real};

use crate::contactor::{ContactorParams, PrechargeParams};
use crate::protect::{PackSheet, Row, Table};

/// How alike the cells are.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Alike {
    /// Series resistance of a new cell at 25 °C \[Ω\], above zero.
    pub resistance_ohm: Real,
    /// Standard deviation of the cells' resistances, as a ratio, above zero.
    pub resistance_sd: Real,
    /// Standard deviation of their capacities, as a ratio, 0..1.
    pub capacity_sd: Real,
    /// Standard deviation of their states of charge at the start, above 0 and up to 1.
    pub soc_sd: Real,
    /// How far one wanders from the others in a day, as a state of charge, 0..1.
    pub drift_sd_per_day: Real,
}

/// What bleeds cells.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Balancing {
    /// Resistor across a cell \[Ω\], above zero.
    pub bleed_ohm: Real,
    /// The most channels at once, at least 1.
    pub channels: u16,
    /// No bleeding with the board warmer than this \[°C\].
    pub board_max_c: Real,
}

/// All that a [`Bms`](super::Bms) is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct BmsParams {
    /// Cell, layout, sensors and contactors, in the terms of their data sheets.
    pub sheet: PackSheet,
    /// The map of one cell, as `voltstep identify battery` writes it.
    pub cell: MappedBatteryParams,
    /// How alike the cells are.
    pub alike: Alike,
    /// Standard deviation of the pack's current sensor's offset \[A\], ≥ 0.
    pub current_offset_sd_a: Real,
    /// Standard deviation of its gain, as a ratio, 0..1.
    pub current_gain_sd: Real,
    /// How late voltages may be for the current \[s\], ≥ 0.
    pub skew_s: Real,
    /// Time between two samples of the filter \[s\], 0.05..0.25, a whole part of a second and a whole
    /// number of ticks.
    pub sample_s: Real,
    /// What counts as a rest \[s\], above zero.
    pub rest_s: Real,
    /// What counts as empty, 0..1.
    pub empty_soc: Real,
    /// Precharge of the link.
    pub precharge: PrechargeParams,
    /// How long contactors may take.
    pub contactors: ContactorParams,
    /// What bleeds cells.
    pub balancing: Balancing,
}

impl BmsParams {
    /// What fits a pack of identified cells with sensors and contactors of a production car, and a link
    /// that `precharge_ohm` \[Ω\] charges in some 0.2 s.
    ///
    /// All is chosen: cells alike to 10 % in resistance and 2 % in capacity and charge, a current
    /// sensor of 0.5 % gain and a third of its error as offset, voltages within 20 ms, a link that is charged
    /// at 97 % (what discharges it may take a third of the rest), a rest of half an
    /// hour, empty at 2 %, an eighth of the cells bled at once through 33 Ω.
    #[must_use]
    pub const fn typical(sheet: PackSheet, cell: MappedBatteryParams, precharge_ohm: Real) -> Self {
        let sensing = &sheet.sensing;
        let pack_v = sheet.cell.voltage.operating_max_v * sheet.layout.series as Real;
        // What a short takes until it is told: half the time constant and the samples of the verdict.
        let (tau_s, short_w) = (0.04, pack_v * pack_v / precharge_ohm);
        let short_j = 1.5 * tau_s * short_w;
        let channels = if sheet.layout.series < 8 { 1 } else { sheet.layout.series / 8 };
        Self {
            sheet,
            cell,
            alike: Alike {
                resistance_ohm: 0.5 * sheet.cell.resistance_ohm,
                resistance_sd: 0.1,
                capacity_sd: 0.02,
                soc_sd: 0.02,
                drift_sd_per_day: 0.001,
            },
            current_offset_sd_a: sensing.current_a.error / 3.0,
            current_gain_sd: 0.005,
            skew_s: 0.02,
            sample_s: 0.1,
            rest_s: 1800.0,
            empty_soc: 0.02,
            precharge: PrechargeParams {
                resistor_ohm: precharge_ohm,
                link_f: tau_s / precharge_ohm,
                tau_factor: 1.5,
                noise_v: 4.0 * (sensing.pack_v.noise_sd + sensing.link_v.noise_sd),
                noise_a: sensing.current_a.error,
                done_v: 0.03 * pack_v,
                count: 5,
                lag_s: 0.01,
                budget_j: 4.0 * short_j,
                short_j,
                cooling_s: 30.0,
            },
            contactors: ContactorParams::USUAL,
            balancing: Balancing { bleed_ohm: 33.0, channels, board_max_c: 80.0 },
        }
    }

    /// Samples of the filter in a second.
    #[must_use]
    pub const fn per_second(&self) -> u32 {
        whole(1.0 / self.sample_s)
    }

    /// Ticks between two samples of the filter.
    #[must_use]
    pub const fn ticks_per_sample(&self) -> u32 {
        whole(self.sample_s / self.sheet.tick_s)
    }

    pub(super) const fn precharge_closes(&self) -> Result<u16, ParamError> {
        let ticks = whole(self.contactors.close_limit_s / self.sheet.tick_s);
        if ticks == 0 || ticks > 60_000 {
            return Err(ParamError::OutOfRange("contactor.close_limit_s"));
        }
        #[expect(clippy::cast_possible_truncation, reason = "just checked")]
        let ticks = ticks as u16;
        Ok(ticks)
    }
}

/// The nearest whole number of a ratio that is not negative; what is absurd is none.
pub(super) const fn whole(ratio: Real) -> u32 {
    if ratio > 0.0 && ratio < 1e6 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "just checked")]
        let whole = (ratio + 0.5) as u32;
        whole
    } else {
        0
    }
}

#[allow(clippy::cast_precision_loss, reason = "counts are below 2^24")]
pub(super) const fn real(count: u32) -> Real {
    count as Real
}

/// Whether a ratio is a whole number, to rounding.
const fn is_whole(ratio: Real) -> bool {
    let off = ratio - real(whole(ratio));
    off.abs() < 1e-3
}

/// A description of a pack that was checked, with what follows from it: the table of rows, and one
/// cell. It lies in flash memory; a [`Bms`](super::Bms) borrows it.
#[derive(Clone, Copy, Debug)]
pub struct Description {
    params: BmsParams,
    table: Table,
    battery: MappedBattery,
}

impl Description {
    /// Checks the description and derives the table.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: BmsParams) -> Result<Self, ParamError> {
        check!(positive("bms.alike.resistance_ohm", params.alike.resistance_ohm));
        check!(positive("bms.alike.resistance_sd", params.alike.resistance_sd));
        check!(not_negative("bms.current_offset_sd_a", params.current_offset_sd_a));
        check!(ratio("bms.current_gain_sd", params.current_gain_sd));
        check!(not_negative("bms.skew_s", params.skew_s));
        check!(finite("bms.sample_s", params.sample_s));
        let table = check!(Table::new(params.sheet));
        let samples = is_whole(1.0 / params.sample_s)
            && is_whole(params.sample_s / params.sheet.tick_s)
            && params.sample_s >= 0.05
            && params.sample_s <= 0.25;
        if !samples {
            return Err(ParamError::OutOfRange("bms.sample_s"));
        }
        let battery = check!(MappedBattery::new(params.cell, check!(Dt::from_s(params.sample_s))));
        Ok(Self { params, table, battery })
    }

    /// The same with another row, which is checked by itself alone: to ask of a recording what would
    /// have been.
    ///
    /// # Errors
    /// [`ParamError`] as for [`Table::supposing`].
    pub const fn supposing(self, row: Row) -> Result<Self, ParamError> {
        Ok(Self { table: check!(self.table.supposing(row)), ..self })
    }

    /// What it was made from.
    #[must_use]
    pub const fn params(&self) -> &BmsParams {
        &self.params
    }

    /// The table of rows.
    #[must_use]
    pub const fn table(&self) -> &Table {
        &self.table
    }

    /// One cell.
    #[must_use]
    pub const fn battery(&self) -> &MappedBattery {
        &self.battery
    }
}
