//! What a [`SmartPack`](super::SmartPack) is made from and shows.

use embedded_batteries::smart_battery::{BatteryStatusFields, ManufactureDate};
use plant_core::Real;

use crate::estimate::energy::EnergyState;
use crate::estimate::power::Allowance;
use crate::{Estimate, Health};

/// Who made the pack, and of what.
#[derive(Clone, Copy, Debug)]
pub struct Identity<'i> {
    /// Capacity of a new pack \[A·h\].
    pub design_capacity_ah: Real,
    /// Nominal voltage of a new pack \[V\].
    pub design_voltage_v: Real,
    /// When it was made.
    pub manufacture_date: ManufactureDate,
    /// Number of this pack among its kind.
    pub serial_number: u16,
    /// Who made it.
    pub manufacturer_name: &'i str,
    /// What it is called.
    pub device_name: &'i str,
    /// What is in it, as `LION`.
    pub device_chemistry: &'i str,
}

/// What the battery management knows at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snapshot {
    /// Voltage at the terminals \[V\].
    pub voltage_v: Real,
    /// Current \[A\], positive when discharging.
    pub current_a: Real,
    /// What is believed to be in it.
    pub estimate: Estimate,
    /// How far it has aged.
    pub health: Health,
    /// The averages over a minute.
    pub averages: EnergyState,
    /// What may be drawn for ten seconds.
    pub discharge: Allowance,
    /// The largest current to charge with \[A\], ≥ 0.
    pub charging_current_a: Real,
    /// The highest voltage to charge with \[V\].
    pub charging_voltage_v: Real,
    /// Discharges of the design capacity so far.
    pub cycles: Real,
    /// Flags and alarms that the battery management decides on; the error code, `discharging` and
    /// the alarms of capacity and time are filled in.
    pub status: BatteryStatusFields,
}
