//! What the estimators say to C and are told by it.

use voltstep_bms::estimate::power::{Allowance, BoundBy, PowerAhead};
use voltstep_bms::{Estimate, Health};

/// What is believed to be in a cell, or in a pack as one.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepEstimate {
    /// State of charge, a ratio 0..1.
    pub soc: f32,
    /// Its standard deviation, a ratio.
    pub soc_sd: f32,
    /// Voltage across the RC branches, the faster first, positive when discharging, in V.
    pub polarisation_v: [f32; 2],
    /// Where between the curves of discharge (-1) and charge (1) the open-circuit voltage lies.
    pub hysteresis: f32,
    /// What the terminals show above what the model expects, in V.
    pub offset_v: f32,
    /// Temperature in degC.
    pub temperature_c: f32,
}

impl From<Estimate> for VoltstepEstimate {
    fn from(e: Estimate) -> Self {
        Self {
            soc: e.soc,
            soc_sd: e.soc_sd,
            polarisation_v: e.polarisation_v,
            hysteresis: e.hysteresis,
            offset_v: e.offset_v,
            temperature_c: e.temperature_c,
        }
    }
}

impl From<VoltstepEstimate> for Estimate {
    fn from(e: VoltstepEstimate) -> Self {
        Self {
            soc: e.soc,
            soc_sd: e.soc_sd,
            polarisation_v: e.polarisation_v,
            hysteresis: e.hysteresis,
            offset_v: e.offset_v,
            temperature_c: e.temperature_c,
        }
    }
}

/// How a cell differs from the one that its parameters describe.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepHealth {
    /// Charge between state of charge 0 and 1, in A h.
    pub capacity_ah: f32,
    /// Its standard deviation in A h.
    pub capacity_sd_ah: f32,
    /// Every resistance is larger by this factor.
    pub resistance_factor: f32,
    /// Its standard deviation.
    pub resistance_factor_sd: f32,
}

impl From<Health> for VoltstepHealth {
    fn from(h: Health) -> Self {
        Self {
            capacity_ah: h.capacity_ah,
            capacity_sd_ah: h.capacity_sd_ah,
            resistance_factor: h.resistance_factor,
            resistance_factor_sd: h.resistance_factor_sd,
        }
    }
}

impl From<VoltstepHealth> for Health {
    fn from(h: VoltstepHealth) -> Self {
        Self {
            capacity_ah: h.capacity_ah,
            capacity_sd_ah: h.capacity_sd_ah,
            resistance_factor: h.resistance_factor,
            resistance_factor_sd: h.resistance_factor_sd,
        }
    }
}

/// What kept a current from being larger.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepBoundBy {
    /// The largest current of the cell.
    Current = 0,
    /// The voltage at the terminals.
    Voltage = 1,
    /// The state of charge.
    Soc = 2,
    /// The temperature, now or as the current raises it.
    Temperature = 3,
    /// The estimate was not finite or absurd: nothing is allowed.
    Unknown = 4,
}

/// What may be drawn, or charged.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepAllowance {
    /// Constant current in A, zero or above in either direction.
    pub current_a: f32,
    /// Constant power in W, zero or above in either direction.
    pub power_w: f32,
    /// The voltage closest to its limit that this current leads to, in V.
    pub voltage_v: f32,
    /// One of `VoltstepBoundBy`.
    pub bound_by: u32,
}

impl From<Allowance> for VoltstepAllowance {
    fn from(a: Allowance) -> Self {
        let bound_by = match a.bound_by {
            BoundBy::Current => VoltstepBoundBy::Current,
            BoundBy::Voltage => VoltstepBoundBy::Voltage,
            BoundBy::Soc => VoltstepBoundBy::Soc,
            BoundBy::Temperature => VoltstepBoundBy::Temperature,
            BoundBy::Unknown => VoltstepBoundBy::Unknown,
        } as u32;
        Self { current_a: a.current_a, power_w: a.power_w, voltage_v: a.voltage_v, bound_by }
    }
}

/// What is allowed over one length of time.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepPowerAhead {
    /// How long it holds, in s.
    pub horizon_s: f32,
    /// Discharging.
    pub discharge: VoltstepAllowance,
    /// Charging.
    pub charge: VoltstepAllowance,
}

impl From<PowerAhead> for VoltstepPowerAhead {
    fn from(p: PowerAhead) -> Self {
        Self { horizon_s: p.horizon_s, discharge: p.discharge.into(), charge: p.charge.into() }
    }
}

/// One sample of cells in series.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepSeriesInput {
    /// Current of one cell in A, positive when discharging; NaN where there is no usable reading.
    pub current_a: f32,
    /// Temperature in degC.
    pub temperature_c: f32,
    /// Other than 0: the contactors are open.
    pub contactors_open: u32,
}

/// What is believed of cells in series after a sample.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepSeriesOutputs {
    /// Of their mean, by the filter.
    pub estimate: VoltstepEstimate,
    /// The health of their mean.
    pub health: VoltstepHealth,
    /// State of charge of their mean by counting, a ratio 0..1.
    pub counted_soc: f32,
    /// Its standard deviation, a ratio.
    pub counted_soc_sd: f32,
    /// Lowest state of charge of a cell, a ratio 0..1.
    pub soc_min: f32,
    /// Highest state of charge of a cell, a ratio 0..1.
    pub soc_max: f32,
    /// Which cell has the lowest.
    pub soc_min_index: u32,
    /// Which cell has the highest.
    pub soc_max_index: u32,
    /// The filter's standard deviation is below the `converged_sd` of the parameters.
    pub converged: bool,
    /// The model's error, and the mean residual beside it, are of the size that is expected.
    pub consistent: bool,
    /// The open-circuit curve is flat here: the voltage does not correct.
    pub flat: bool,
    /// State of charge or temperature lie outside the identified range.
    pub outside_identified: bool,
    /// The temperature is not known; the last one holds.
    pub temperature_missing: bool,
}

/// What is believed of one cell in series.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepSeriesCell {
    /// State of charge, a ratio 0..1.
    pub soc: f32,
    /// Its standard deviation, a ratio.
    pub soc_sd: f32,
    /// Its resistance over the mean of all, a ratio.
    pub resistance_ratio: f32,
    /// Its standard deviation, a ratio.
    pub resistance_ratio_sd: f32,
    /// Its voltage said nothing in the last second.
    pub held: bool,
}
