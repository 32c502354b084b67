//! A measured trip: what a car recorded while it drove.
//!
//! [`parse`] reads the format of "Battery and Heating Data in Real Driving Cycles" (TU Munich, DOI
//! 10.21227/6jr9-5235), Latin-1 or UTF-8: columns found by the name before the unit in brackets, in
//! any order and beside any others, known units converted.

mod quirks;
mod read;
mod screen;
#[cfg(test)]
mod tests;

pub(crate) use super::stamp::mean;
pub use read::parse;
pub(crate) use read::{COLUMNS, of_table, open};
pub use screen::Screened;

/// What a car recorded, a row per sample, in SI units.
///
/// Every vector has the same length, 2 at least where [`parse`] made it. Time rises from row to
/// row. A sample that is missing is NaN; time, speed, height, voltage and current never are.
#[derive(Clone, Debug, PartialEq)]
pub struct Trip {
    /// The file's name without its extension.
    pub name: String,
    /// Time \[s\].
    pub time_s: Vec<f64>,
    /// Speed \[m/s\].
    pub speed_m_s: Vec<f64>,
    /// Height \[m\].
    pub elevation_m: Vec<f64>,
    /// Torque of the motor \[N·m\].
    pub motor_torque_nm: Vec<f64>,
    /// Voltage of the battery \[V\].
    pub battery_v: Vec<f64>,
    /// Current of the battery \[A\], positive when discharging: the file has it with the other sign.
    pub battery_a: Vec<f64>,
    /// Temperature of the battery \[°C\].
    pub battery_c: Vec<f64>,
    /// State of charge, 0..1.
    pub soc: Vec<f64>,
    /// Power of the heating \[W\].
    pub heating_w: Vec<f64>,
    /// Power of the air conditioning \[W\].
    pub aircon_w: Vec<f64>,
    /// Temperature outside \[°C\].
    pub ambient_c: Vec<f64>,
    /// Position of the accelerator pedal, 0..1.
    pub throttle: Vec<f64>,
    /// Power of the heating, as another bus of the car reports it \[W\].
    pub heating_lin_w: Vec<f64>,
    /// Power that was asked of the heating \[W\].
    pub heating_requested_w: Vec<f64>,
    /// What the file lacks, in words.
    pub notes: Vec<String>,
}

impl Trip {
    /// `rows` rows of zeros, and of NaN where a sample may be missing.
    #[must_use]
    pub fn empty(name: &str, rows: usize) -> Self {
        let zeros = || vec![0.0; rows];
        let missing = || vec![f64::NAN; rows];
        Self {
            name: name.to_owned(),
            time_s: zeros(),
            speed_m_s: zeros(),
            elevation_m: zeros(),
            motor_torque_nm: missing(),
            battery_v: zeros(),
            battery_a: zeros(),
            battery_c: missing(),
            soc: missing(),
            heating_w: zeros(),
            aircon_w: zeros(),
            ambient_c: missing(),
            throttle: missing(),
            heating_lin_w: missing(),
            heating_requested_w: missing(),
            notes: Vec::new(),
        }
    }

    /// How many samples there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// From the first sample to the last \[s\].
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.time_s.last().zip(self.time_s.first()).map_or(0.0, |(last, first)| last - first)
    }

    /// The integral of the speed by the trapezoidal rule \[km\].
    #[must_use]
    pub fn distance_km(&self) -> f64 {
        integral(&self.time_s, &self.speed_m_s) / 1000.0
    }

    /// Heating and air conditioning at sample `i` as reported \[W\]; 0 where missing, never below 0.
    /// [`screened`](Self::screened) says what of it can be believed.
    #[must_use]
    pub fn auxiliary_w(&self, i: usize) -> f64 {
        // `max` takes the number where the other is not one.
        let of = |powers: &[f64]| powers.get(i).map_or(0.0, |w| w.max(0.0));
        of(&self.heating_w) + of(&self.aircon_w)
    }

    /// The first state of charge that is not missing.
    #[must_use]
    pub fn first_soc(&self) -> Option<f64> {
        self.soc.iter().copied().find(|s| s.is_finite())
    }

    /// The last state of charge that is not missing.
    #[must_use]
    pub fn last_soc(&self) -> Option<f64> {
        self.soc.iter().copied().rfind(|s| s.is_finite())
    }

    /// How many samples have no state of charge.
    #[must_use]
    pub fn missing_soc(&self) -> usize {
        self.soc.iter().filter(|s| !s.is_finite()).count()
    }
}

/// The integral of `values` over time by the trapezoidal rule.
fn integral(time_s: &[f64], values: &[f64]) -> f64 {
    time_s.windows(2).zip(values.windows(2)).map(|(t, y)| 0.5 * (y[0] + y[1]) * (t[1] - t[0])).sum()
}
