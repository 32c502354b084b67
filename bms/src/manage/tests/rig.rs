//! A simulated pack and a board around it.

use plant_core::battery::{MappedBattery, MappedBatteryInput, MappedBatteryState};
use plant_core::presets::PANASONIC_NCR18650PF as CELL;

use super::{CELLS, PARALLEL};
use crate::contactor::{Coils, Feedback};
use crate::manage::Board;
use crate::protect::Faults;
use crate::{Dt, Measurements, Reading, Real};

/// Cells that are alike, three contactors, a link with a resistor.
pub(in crate::manage) struct Rig {
    pub(in crate::manage) battery: MappedBattery,
    pub(in crate::manage) cell: MappedBatteryState,
    pub(in crate::manage) cell_v: Real,
    pub(in crate::manage) link_v: Real,
    pub(in crate::manage) coils: Coils,
    pub(in crate::manage) us: u64,
    pub(in crate::manage) tick_us: u64,
    pub(in crate::manage) load_a: Real,
    pub(in crate::manage) flags: Faults,
    pub(in crate::manage) over_v: [Real; CELLS],
    pub(in crate::manage) lost: bool,
    pub(in crate::manage) bled: [bool; CELLS],
    pub(in crate::manage) current_a: Real,
    pub(in crate::manage) leak_a: Real,
}

impl Rig {
    pub(in crate::manage) fn new(soc: Real) -> Self {
        let dt = Dt::from_s(0.001).unwrap();
        let battery = MappedBattery::new(CELL, dt).unwrap();
        let cell = battery.rested_at(soc, 25.0).unwrap();
        Self {
            battery,
            cell,
            cell_v: 3.7,
            link_v: 0.0,
            coils: Coils::default(),
            us: 0,
            tick_us: 1000,
            load_a: 0.0,
            flags: Faults::NONE,
            over_v: [0.0; CELLS],
            lost: false,
            bled: [false; CELLS],
            current_a: 0.0,
            leak_a: 0.0,
        }
    }
}

impl Board<CELLS, 4> for Rig {
    fn uptime_us(&mut self) -> u64 {
        self.us += self.tick_us;
        self.us
    }

    fn measure(&mut self, into: &mut Measurements<CELLS, 4>) {
        let Coils { minus, precharge, plus } = self.coils;
        let pack_v = 14.0 * self.cell_v;
        let (through_a, load_a) = match (minus, precharge, plus) {
            (true, _, true) => {
                self.link_v = pack_v;
                (0.0, self.load_a)
            }
            (true, true, false) => ((pack_v - self.link_v) / 33.0, 0.0),
            _ => (0.0, 0.0),
        };
        self.link_v += through_a * 0.001 / (0.04 / 33.0);
        self.current_a = through_a + load_a;
        let input = MappedBatteryInput { current_a: self.current_a / PARALLEL };
        self.cell_v = self.battery.step(&mut self.cell, input).terminal_v;
        if self.lost {
            return;
        }
        for ((reading, over_v), bled) in into.cell_v.iter_mut().zip(self.over_v).zip(self.bled) {
            // A bleed current in the wires.
            *reading = Reading::new(self.cell_v + over_v - if bled { 0.02 } else { 0.0 });
        }
        into.temperature_c = [Reading::new(25.0); 4];
        into.current_a = Reading::new(self.current_a + self.leak_a);
        into.pack_v = Reading::new(pack_v);
        into.link_v = Reading::new(self.link_v);
    }

    fn feedback(&mut self) -> [Feedback; 3] {
        let Coils { minus, precharge, plus } = self.coils;
        [minus, precharge, plus].map(|on| if on { Feedback::Closed } else { Feedback::Open })
    }

    fn drive(&mut self, coils: Coils) -> bool {
        self.coils = coils;
        true
    }

    fn bleed(&mut self, cells: &[bool; CELLS]) {
        self.bled = *cells;
    }

    fn flags(&mut self) -> Faults {
        self.flags
    }
}
