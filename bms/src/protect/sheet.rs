//! The pack as its data sheets describe it: what the table of rows is derived from.

use plant_core::error::{above, check, finite, not_negative, positive};
use plant_core::{ParamError, Real};

use crate::estimate::power::TemperatureWindow;

/// Voltages of a cell \[V\], rising.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct VoltageWindow {
    /// Below this, not to be charged again without a look at the cell \[V\], above zero.
    pub deep_v: Real,
    /// The absolute minimum of the data sheet \[V\].
    pub absolute_min_v: Real,
    /// Where discharging ends \[V\].
    pub operating_min_v: Real,
    /// Where charging ends \[V\].
    pub operating_max_v: Real,
    /// The absolute maximum of the data sheet \[V\].
    pub absolute_max_v: Real,
}

/// Currents of a cell in one direction \[A\].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Currents {
    /// Continuous \[A\], above zero.
    pub continuous_a: Real,
    /// For ten seconds \[A\], above the continuous one.
    pub ten_seconds_a: Real,
}

/// A cell in the terms of its data sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct CellSheet {
    /// Its voltages.
    pub voltage: VoltageWindow,
    /// Its currents when discharging.
    pub discharge: Currents,
    /// Its currents when charging.
    pub charge: Currents,
    /// Temperatures at which it may be discharged; `none_below_c` and `none_above_c` are the
    /// absolute limits, the others those of operation.
    pub discharge_window: TemperatureWindow,
    /// Temperatures at which it may be charged.
    pub charge_window: TemperatureWindow,
    /// Capacity \[A·h\], above zero.
    pub capacity_ah: Real,
    /// The largest resistance within its life and its windows \[Ω\], above zero.
    pub resistance_ohm: Real,
    /// Heat capacity \[J/K\], above zero.
    pub heat_capacity_j_per_k: Real,
}

/// How many cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Layout {
    /// In series, at least 1.
    pub series: u16,
    /// In parallel, at least 1.
    pub parallel: u16,
}

/// A kind of sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Sensor {
    /// How far a value may be off, offset and gain together, in its unit, ≥ 0.
    pub error: Real,
    /// Standard deviation of its noise, in its unit, ≥ 0.
    pub noise_sd: Real,
    /// What one step of its converter means, in its unit, above zero.
    pub resolution: Real,
    /// Time between two values \[s\], above zero.
    pub period_s: Real,
    /// The lowest value that it can show.
    pub lowest: Real,
    /// The highest value that it can show, above the lowest. What lies outside is no value but a
    /// sentinel, or in another unit.
    pub highest: Real,
}

/// The sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Sensing {
    /// Of the cells' voltages \[V\].
    pub cell_v: Sensor,
    /// Of temperatures \[°C\].
    pub temperature_c: Sensor,
    /// Of the pack's current \[A\].
    pub current_a: Sensor,
    /// Of the pack's voltage \[V\].
    pub pack_v: Sensor,
    /// Of the voltage behind the contactors \[V\].
    pub link_v: Sensor,
}

/// What opens the circuit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Actuators {
    /// From the command until the contactor is open \[s\], above zero.
    pub open_s: Real,
    /// How long an opening for safety waits for a smaller current \[s\], ≥ 0.
    pub wait_s: Real,
    /// The largest current that a contactor breaks without harm \[A\], above zero.
    pub break_a: Real,
}

/// All that the table of rows is derived from.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct PackSheet {
    /// One cell.
    pub cell: CellSheet,
    /// How many of them.
    pub layout: Layout,
    /// What measures them.
    pub sensing: Sensing,
    /// What protects them.
    pub actuators: Actuators,
    /// Time between two calls \[s\], 0.1 ms up to 5 ms.
    pub tick_s: Real,
    /// Calls in which every cell and every temperature is looked at once, at least 1. Together at
    /// most 25 ms.
    pub sweep_ticks: u16,
}

impl CellSheet {
    const fn checked(&self) -> Result<(), ParamError> {
        let v = &self.voltage;
        check!(positive("sheet.voltage.deep_v", v.deep_v));
        check!(above("sheet.voltage.absolute_min_v", v.absolute_min_v, v.deep_v));
        check!(above("sheet.voltage.operating_min_v", v.operating_min_v, v.absolute_min_v));
        check!(above("sheet.voltage.operating_max_v", v.operating_max_v, v.operating_min_v));
        check!(above("sheet.voltage.absolute_max_v", v.absolute_max_v, v.operating_max_v));
        check!(finite("sheet.voltage.absolute_max_v", v.absolute_max_v));
        let (d, c) = (&self.discharge, &self.charge);
        check!(positive("sheet.discharge.continuous_a", d.continuous_a));
        check!(positive("sheet.discharge.ten_seconds_a", d.ten_seconds_a));
        check!(above("sheet.discharge.ten_seconds_a", d.ten_seconds_a, d.continuous_a));
        check!(positive("sheet.charge.continuous_a", c.continuous_a));
        check!(positive("sheet.charge.ten_seconds_a", c.ten_seconds_a));
        check!(above("sheet.charge.ten_seconds_a", c.ten_seconds_a, c.continuous_a));
        let w = &self.discharge_window;
        check!(finite("sheet.discharge_window.none_below_c", w.none_below_c));
        check!(above("sheet.discharge_window.all_from_c", w.all_from_c, w.none_below_c));
        check!(above("sheet.discharge_window.all_to_c", w.all_to_c, w.all_from_c));
        check!(above("sheet.discharge_window.none_above_c", w.none_above_c, w.all_to_c));
        check!(finite("sheet.discharge_window.none_above_c", w.none_above_c));
        let w = &self.charge_window;
        check!(finite("sheet.charge_window.none_below_c", w.none_below_c));
        check!(above("sheet.charge_window.all_from_c", w.all_from_c, w.none_below_c));
        check!(above("sheet.charge_window.all_to_c", w.all_to_c, w.all_from_c));
        check!(above("sheet.charge_window.none_above_c", w.none_above_c, w.all_to_c));
        check!(finite("sheet.charge_window.none_above_c", w.none_above_c));
        check!(positive("sheet.capacity_ah", self.capacity_ah));
        check!(positive("sheet.resistance_ohm", self.resistance_ohm));
        check!(positive("sheet.heat_capacity_j_per_k", self.heat_capacity_j_per_k));
        Ok(())
    }

    /// How fast the voltage may rise or fall at most, beyond what the current does at once \[V/s\]:
    /// at the ten-second current, where the curve is twenty times as steep as on the mean. Chosen:
    /// the ends of open-circuit curves are that steep.
    pub(super) const fn worst_v_per_s(&self) -> Real {
        let window_v = self.voltage.operating_max_v - self.voltage.operating_min_v;
        20.0 * window_v * self.worst_a() / (3600.0 * self.capacity_ah)
    }

    /// How fast it may warm up at most by its own current \[K/s\].
    pub(super) const fn worst_k_per_s(&self) -> Real {
        self.worst_a() * self.worst_a() * self.k_per_s_a2()
    }

    /// The same for each square of its current \[K/(s·A²)\].
    pub(super) const fn k_per_s_a2(&self) -> Real {
        self.resistance_ohm / self.heat_capacity_j_per_k
    }

    const fn worst_a(&self) -> Real {
        if self.discharge.ten_seconds_a > self.charge.ten_seconds_a {
            self.discharge.ten_seconds_a
        } else {
            self.charge.ten_seconds_a
        }
    }
}

impl Sensor {
    const fn checked(&self, field: &'static str) -> Result<(), ParamError> {
        check!(not_negative(field, self.error));
        check!(not_negative(field, self.noise_sd));
        check!(positive(field, self.resolution));
        check!(positive(field, self.period_s));
        check!(finite(field, self.lowest));
        check!(finite(field, self.highest));
        check!(above(field, self.highest, self.lowest));
        Ok(())
    }

    /// Between bad and good: four standard deviations of the noise or two steps, whatever is more.
    pub(crate) const fn hysteresis(&self) -> Real {
        let (noise, steps) = (4.0 * self.noise_sd, 2.0 * self.resolution);
        if noise > steps { noise } else { steps }
    }

    /// Older than this, a value is missing \[s\]: half a period late.
    pub(crate) const fn oldest_s(&self, tick_s: Real) -> Real {
        1.5 * self.period_s + tick_s
    }
}

impl PackSheet {
    /// Ticks of a sweep, at least one: a division by it cannot fail.
    pub(crate) const fn turns(&self) -> u16 {
        if self.sweep_ticks == 0 { 1 } else { self.sweep_ticks }
    }

    /// Time in which every cell is looked at once \[s\].
    #[must_use]
    pub const fn sweep_s(&self) -> Real {
        self.tick_s * self.sweep_ticks as Real
    }

    pub(super) const fn checked(&self) -> Result<(), ParamError> {
        check!(self.cell.checked());
        if self.layout.series == 0 {
            return Err(ParamError::OutOfRange("layout.series"));
        }
        if self.layout.parallel == 0 {
            return Err(ParamError::OutOfRange("layout.parallel"));
        }
        check!(self.sensing.cell_v.checked("sensing.cell_v"));
        check!(self.sensing.temperature_c.checked("sensing.temperature_c"));
        check!(self.sensing.current_a.checked("sensing.current_a"));
        check!(self.sensing.pack_v.checked("sensing.pack_v"));
        check!(self.sensing.link_v.checked("sensing.link_v"));
        check!(positive("actuators.open_s", self.actuators.open_s));
        check!(not_negative("actuators.wait_s", self.actuators.wait_s));
        check!(positive("actuators.break_a", self.actuators.break_a));
        if !(self.tick_s >= 1e-4 && self.tick_s <= 5e-3) {
            return Err(ParamError::OutOfRange("tick_s"));
        }
        if self.sweep_ticks == 0 || self.sweep_s() > 0.025 {
            return Err(ParamError::OutOfRange("sweep_ticks"));
        }
        Ok(())
    }
}
