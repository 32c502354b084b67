//! What the hardware does.

use plant_core::Real;

use crate::contactor::{Coils, Feedback};
use crate::protect::Faults;
use crate::{Measurements, Reading};

/// The hardware around a BMS, or a plant in place of it. Nothing here may wait: what is not there yet
/// is left as it was.
pub trait Board<const CELLS: usize, const SENSORS: usize> {
    /// Time since the first power-up \[µs\], sleep included; it never goes back.
    fn uptime_us(&mut self) -> u64;

    /// Replaces the readings that are new; the others keep their value and their age. What could not
    /// be trusted is a reading that is not valid.
    fn measure(&mut self, into: &mut Measurements<CELLS, SENSORS>);

    /// What the contactors show: minus, precharge, plus.
    fn feedback(&mut self) -> [Feedback; 3];

    /// Drives the contactors; `false` where a pin failed.
    /// [`Contactors`](crate::contactor::Contactors) does it for pins.
    fn drive(&mut self, coils: Coils) -> bool;

    /// Turns the bleed switches.
    fn bleed(&mut self, cells: &[bool; CELLS]);

    /// The rows that the hardware finds bad by itself: interlock, crash, supply, coolant, a comparator
    /// of a short circuit, memory.
    fn flags(&mut self) -> Faults {
        Faults::NONE
    }

    /// A second current sensor \[A\]; NaN where there is none.
    fn second_current_a(&mut self) -> Real {
        Real::NAN
    }

    /// Insulation to the chassis \[Ω/V\]; `None` without a device.
    fn insulation_ohm_per_v(&mut self) -> Option<Reading> {
        None
    }

    /// How many cells the front end found; `None` where it does not count.
    fn cells_found(&mut self) -> Option<u16> {
        None
    }

    /// How far each wire moves under the front end's test current \[V\], one more than cells; `None`
    /// without a test.
    fn wires_v(&mut self) -> Option<&[Real]> {
        None
    }

    /// Temperature of the balancing board \[°C\].
    fn balancing_c(&mut self) -> Real {
        25.0
    }
}
