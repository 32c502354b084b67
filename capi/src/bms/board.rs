//! The hardware as structs: what it measured goes in, what it is told comes out.

use voltstep_bms::contactor::{Coils, Feedback};
use voltstep_bms::manage::Board;
use voltstep_bms::protect::{Faults, Id};
use voltstep_bms::{Measurements, Reading};

use super::handle::Told;
use super::params::{VOLTSTEP_BMS_CELLS_MAX, VOLTSTEP_BMS_SENSORS_MAX, VOLTSTEP_BMS_WIRES_MAX};
use super::{CELLS, SENSORS};

/// What a contactor shows.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepBmsFeedback {
    /// It could not be read.
    Unknown = 0,
    /// Open.
    Open = 1,
    /// Closed.
    Closed = 2,
}

/// What the hardware knows in a tick. Values that are not new keep what they were and grow older; one
/// that could not be trusted is given as new and not a number. All zero is a start: nothing is new, nothing
/// is fitted. Beyond the cells and temperatures that
/// the library is built for nothing is read.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsInputs {
    /// Time since the first power-up in us, sleep included; it never goes back.
    pub uptime_us: u64,
    /// Other than 0: `cell_v` is new.
    pub cells_new: u32,
    /// Voltage of each cell in V.
    pub cell_v: [f32; VOLTSTEP_BMS_CELLS_MAX],
    /// Other than 0: `temperature_c` is new.
    pub temperatures_new: u32,
    /// Temperatures in degC.
    pub temperature_c: [f32; VOLTSTEP_BMS_SENSORS_MAX],
    /// Other than 0: `current_a` is new.
    pub current_new: u32,
    /// Current of the pack in A, positive when discharging.
    pub current_a: f32,
    /// Other than 0: `pack_v` is new.
    pub pack_new: u32,
    /// Voltage of the cells together, before the contactors, in V.
    pub pack_v: f32,
    /// Other than 0: `link_v` is new.
    pub link_new: u32,
    /// Voltage behind the contactors in V.
    pub link_v: f32,
    /// What the contactors show, each one of `VoltstepBmsFeedback` (another number: unknown): minus,
    /// precharge, plus.
    pub feedback: [u32; 3],
    /// Other than 0: a pin failed when the contactors were last driven.
    pub pin_failed: u32,
    /// What the hardware finds bad by itself, a bit for each of `VoltstepBmsRow`, row k in word k/32:
    /// interlock, crash, supply, coolant, a comparator of a short circuit, memory.
    pub flags: [u32; 3],
    /// Other than 0: there is a second current sensor.
    pub second_current_measured: u32,
    /// What it shows in A; NaN where it could not be trusted.
    pub second_current_a: f32,
    /// Other than 0: a device watches the insulation.
    pub insulation_watched: u32,
    /// Insulation to the chassis in ohm/V; NaN where the device is silent.
    pub insulation_ohm_per_v: f32,
    /// How many cells the front end found; 0 where it does not count.
    pub cells_found: u16,
    /// Other than 0: the wires were tested, `wires_v` is set.
    pub wires_tested: u32,
    /// How far each wire moves under the front end's test current in V: one more than cells.
    pub wires_v: [f32; VOLTSTEP_BMS_WIRES_MAX],
    /// Temperature of the balancing board in degC.
    pub balancing_c: f32,
}

/// What the hardware is told.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsOutputs {
    /// Close the main contactor at the negative pole.
    pub minus: bool,
    /// Close the precharge contactor.
    pub precharge: bool,
    /// Close the main contactor at the positive pole.
    pub plus: bool,
    /// Bleed each of these cells.
    pub bleed: [bool; VOLTSTEP_BMS_CELLS_MAX],
}

impl From<&Told> for VoltstepBmsOutputs {
    fn from(told: &Told) -> Self {
        let Coils { minus, precharge, plus } = told.coils;
        let mut bleed = [false; VOLTSTEP_BMS_CELLS_MAX];
        for (to, on) in bleed.iter_mut().zip(told.bleed) {
            *to = on;
        }
        Self { minus, precharge, plus, bleed }
    }
}

/// A tick of the hardware.
pub(super) struct Wired<'a> {
    pub inputs: &'a VoltstepBmsInputs,
    pub told: &'a mut Told,
}

/// Rows by their bits; what is none is left out.
pub(super) fn rows(words: [u32; 3]) -> Faults {
    let mut faults = Faults::NONE;
    for (word, mut bits) in (0_u8..).zip(words) {
        while bits != 0 {
            #[expect(clippy::cast_possible_truncation, reason = "below 32")]
            let bit = bits.trailing_zeros() as u8;
            bits &= bits.wrapping_sub(1);
            if let Some(id) = Id::at(32 * word + bit) {
                faults = faults.with(id);
            }
        }
    }
    faults
}

impl Board<CELLS, SENSORS> for Wired<'_> {
    fn uptime_us(&mut self) -> u64 {
        self.inputs.uptime_us
    }

    fn measure(&mut self, into: &mut Measurements<CELLS, SENSORS>) {
        let new = self.inputs;
        if new.cells_new != 0 {
            for (reading, value) in into.cell_v.iter_mut().zip(new.cell_v) {
                *reading = Reading::new(value);
            }
        }
        if new.temperatures_new != 0 {
            for (reading, value) in into.temperature_c.iter_mut().zip(new.temperature_c) {
                *reading = Reading::new(value);
            }
        }
        if new.current_new != 0 {
            into.current_a = Reading::new(new.current_a);
        }
        if new.pack_new != 0 {
            into.pack_v = Reading::new(new.pack_v);
        }
        if new.link_new != 0 {
            into.link_v = Reading::new(new.link_v);
        }
    }

    fn feedback(&mut self) -> [Feedback; 3] {
        self.inputs.feedback.map(|shown| match shown {
            s if s == VoltstepBmsFeedback::Open as u32 => Feedback::Open,
            s if s == VoltstepBmsFeedback::Closed as u32 => Feedback::Closed,
            _ => Feedback::Unknown,
        })
    }

    fn drive(&mut self, coils: Coils) -> bool {
        self.told.coils = coils;
        self.inputs.pin_failed == 0
    }

    fn bleed(&mut self, cells: &[bool; CELLS]) {
        self.told.bleed = *cells;
    }

    fn flags(&mut self) -> Faults {
        rows(self.inputs.flags)
    }

    fn second_current_a(&mut self) -> f32 {
        if self.inputs.second_current_measured == 0 {
            f32::NAN
        } else {
            self.inputs.second_current_a
        }
    }

    fn insulation_ohm_per_v(&mut self) -> Option<Reading> {
        (self.inputs.insulation_watched != 0)
            .then(|| Reading::new(self.inputs.insulation_ohm_per_v))
    }

    fn cells_found(&mut self) -> Option<u16> {
        (self.inputs.cells_found != 0).then_some(self.inputs.cells_found)
    }

    fn wires_v(&mut self) -> Option<&[f32]> {
        if self.inputs.wires_tested == 0 { None } else { self.inputs.wires_v.get(..=CELLS) }
    }

    fn balancing_c(&mut self) -> f32 {
        self.inputs.balancing_c
    }
}
