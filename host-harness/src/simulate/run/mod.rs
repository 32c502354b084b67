//! The stepping loops: [`vehicle()`] drives the whole vehicle, [`battery()`] the battery alone; both
//! keep a trace and count over every step.

mod battery;
mod drives;
mod vehicle;

use std::time::Duration;

use plant_core::machine::Temperatures;
use plant_core::num;
use plant_core::powertrain::Limited;
use plant_core::powertrain::ledger::EnergyReport;

use crate::simulate::progress::Progress;

pub use battery::{Load, Of, battery};
pub use vehicle::vehicle;

/// Progress is told once in so many rows.
const ROWS_PER_PROGRESS: usize = 256;

/// One kept row of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TraceRow {
    /// Time from the start \[s\].
    pub time_s: f64,
    /// The speed to follow \[m/s\].
    pub reference_m_s: f32,
    /// Speed \[m/s\].
    pub speed_m_s: f32,
    /// Distance \[m\].
    pub distance_m: f32,
    /// Sine of the slope.
    pub slope_sin: f32,
    /// Duty applied.
    pub duty: f32,
    /// Air-gap torque \[N·m\].
    pub motor_torque_nm: f32,
    /// Friction brake \[N\].
    pub brake_n: f32,
    /// Winding current \[A\].
    pub motor_current_a: f32,
    /// Battery current \[A\], positive when discharging.
    pub battery_current_a: f32,
    /// Voltage at the battery's terminals \[V\].
    pub battery_voltage_v: f32,
    /// State of charge, 0..1.
    pub soc: f32,
    /// The lowest and highest of every step since the row before, so that nothing is lost between
    /// two rows; where there was none, of the row itself.
    pub extremes: Extremes,
    /// How warm the drives are; of a vehicle that has temperatures.
    pub temperatures: Option<Temperatures>,
}

/// Lowest and highest value of what may jump from step to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremes {
    /// Air-gap torque \[N·m\].
    pub motor_torque_nm: (f32, f32),
    /// Battery current \[A\].
    pub battery_current_a: (f32, f32),
    /// Voltage at the battery's terminals \[V\].
    pub battery_voltage_v: (f32, f32),
}

/// Of no step: any value widens it.
const NOTHING: (f32, f32) = (f32::INFINITY, f32::NEG_INFINITY);

impl Default for Extremes {
    fn default() -> Self {
        Self { motor_torque_nm: NOTHING, battery_current_a: NOTHING, battery_voltage_v: NOTHING }
    }
}

impl Extremes {
    /// Where there was no step: the values that a row has anyhow.
    fn of(row: &TraceRow) -> Self {
        let mut extremes = Self::default();
        extremes.see(row.motor_torque_nm, row.battery_current_a, row.battery_voltage_v);
        extremes
    }

    /// Takes in the values of a step.
    #[inline]
    fn see(&mut self, motor_torque_nm: f32, battery_current_a: f32, battery_voltage_v: f32) {
        widen(&mut self.motor_torque_nm, motor_torque_nm);
        widen(&mut self.battery_current_a, battery_current_a);
        widen(&mut self.battery_voltage_v, battery_voltage_v);
    }
}

/// The extremes and sums over every step of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Totals {
    /// Sum of the squared speed errors \[m²/s²\].
    pub speed_error_squares: f64,
    /// Largest speed error \[m/s\].
    pub speed_error_max_m_s: f32,
    /// Air-gap torque \[N·m\]: lowest, highest.
    pub motor_torque_nm: (f32, f32),
    /// Battery current \[A\]: lowest, highest.
    pub battery_current_a: (f32, f32),
    /// Lowest battery voltage \[V\].
    pub battery_voltage_min_v: f32,
    /// Net energy at the battery's terminals \[J\].
    pub battery_energy_j: f64,
    /// Steps in which a limit changed the duty or refused current.
    pub limited: LimitedSteps,
    /// By how much the battery's current was beyond its limit all the same, at most \[A\].
    pub limit_exceeded_a: f32,
    /// Charge that the battery refused \[C\], without its sign (battery mode).
    pub refused_charge_c: f64,
    /// The highest temperatures of the drives, and the least that they left of a current limit; of a
    /// vehicle that has temperatures.
    pub temperatures: Option<Temperatures>,
}

/// In how many steps each limit acted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LimitedSteps {
    /// The battery's limit of discharging.
    pub discharge: u64,
    /// The battery's limit of charging.
    pub charge: u64,
    /// The current limit of a drive.
    pub current: u64,
    /// The limit of the duty.
    pub duty: u64,
}

impl LimitedSteps {
    /// Counts a step.
    #[inline]
    pub const fn count(&mut self, limited: Limited) {
        match limited {
            Limited::No => {}
            Limited::Discharge => self.discharge += 1,
            Limited::Charge => self.charge += 1,
            Limited::Current => self.current += 1,
            Limited::Duty => self.duty += 1,
        }
    }

    /// In how many any of them did.
    #[must_use]
    pub const fn any(self) -> u64 {
        self.discharge + self.charge + self.current + self.duty
    }
}

impl Default for Totals {
    fn default() -> Self {
        Self {
            speed_error_squares: 0.0,
            speed_error_max_m_s: 0.0,
            motor_torque_nm: NOTHING,
            battery_current_a: NOTHING,
            battery_voltage_min_v: f32::INFINITY,
            battery_energy_j: 0.0,
            limited: LimitedSteps::default(),
            limit_exceeded_a: 0.0,
            refused_charge_c: 0.0,
            temperatures: None,
        }
    }
}

/// A finished run.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The step \[s\].
    pub dt_s: f64,
    /// How many steps.
    pub steps: u64,
    /// Time spent stepping.
    pub wall: Duration,
    /// The kept rows: one at each row of the route, the first before the first step.
    pub trace: Vec<TraceRow>,
    /// Extremes and sums over every step.
    pub totals: Totals,
    /// The energy ledger, where it was kept.
    pub energy: Option<EnergyReport>,
}

/// The number of the step that begins nearest to a time.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "times are ≥ 0")]
fn step_at(time_s: f64, dt_s: f64) -> u64 {
    (time_s / dt_s).round() as u64
}

impl Totals {
    /// Takes in the extremes of a stretch.
    fn widen(&mut self, seen: &Extremes) {
        for (all, (low, high)) in [
            (&mut self.motor_torque_nm, seen.motor_torque_nm),
            (&mut self.battery_current_a, seen.battery_current_a),
        ] {
            widen(all, low);
            widen(all, high);
        }
        self.battery_voltage_min_v = num::min(self.battery_voltage_min_v, seen.battery_voltage_v.0);
    }
}

#[inline]
fn widen(range: &mut (f32, f32), value: f32) {
    *range = (num::min(range.0, value), num::max(range.1, value));
}

/// Tells now and then how far a run is.
fn tell(progress: &dyn Progress, row: usize, rows: usize) {
    if row.is_multiple_of(ROWS_PER_PROGRESS) {
        progress.at(row, rows, "");
    }
}
