//! What the BMS sees of the pack: sensors with noise and faults, feedback, flags.

use plant_core::link::ContactorFault;
use voltstep_bms::contactor::{Coils, Feedback};
use voltstep_bms::manage::Board;
use voltstep_bms::protect::{Faults, Id};
use voltstep_bms::{Measurements, Reading};

use super::super::{CELLS, SENSORS, SHEET};
use super::{Rig, contactor_fault};
use crate::read::scenario::Fault;

impl Board<CELLS, SENSORS> for Rig {
    fn uptime_us(&mut self) -> u64 {
        u64::from(self.ms) * 1000
    }

    fn measure(&mut self, into: &mut Measurements<CELLS, SENSORS>) {
        let sensing = &SHEET.sensing;
        if self.now(Fault::CurrentLost).is_none() {
            let noise_a = sensing.current_a.noise_sd * self.random.normal();
            let stuck = *self.stuck.get_or_insert((0.0, 0.0, 0.0));
            let mut current_a = self.battery_a + noise_a;
            if self.now(Fault::CurrentStuck).is_some() {
                current_a = stuck.0;
            } else {
                self.stuck = Some((current_a, stuck.1, stuck.2));
            }
            current_a += self.now(Fault::CurrentOffset).unwrap_or(0.0);
            current_a *= 1.0 - self.now(Fault::CurrentGain).unwrap_or(0.0);
            if self.now(Fault::CurrentReversed).is_some() {
                current_a = -current_a;
            }
            if let Some(most_a) = self.now(Fault::CurrentSaturated) {
                current_a = current_a.clamp(-most_a, most_a);
            }
            into.current_a = Reading::new(current_a);
        }
        if self.ms % 2 == 1 {
            let noise_v = sensing.pack_v.noise_sd;
            if self.now(Fault::PackVoltageLost).is_none() {
                let off_v = self.now(Fault::PackVoltageOff).unwrap_or(0.0);
                into.pack_v = Reading::new(self.pack_v + off_v + noise_v * self.random.normal());
            }
            if self.now(Fault::LinkVoltageLost).is_none() {
                let off_v = self.now(Fault::LinkVoltageOff).unwrap_or(0.0);
                let link_v = self.link_state.voltage_v.get();
                into.link_v = Reading::new(link_v + off_v + noise_v * self.random.normal());
            }
        }
        if self.ms % 20 == 1 && self.now(Fault::CellsLost).is_none() {
            self.measure_cells(into);
        }
        if self.ms % 100 == 1 && self.now(Fault::TemperatureLost).is_none() {
            self.measure_temperatures(into);
        }
    }

    fn feedback(&mut self) -> [Feedback; 3] {
        let mut shown = [Feedback::Unknown; 3];
        for (index, shown) in shown.iter_mut().enumerate() {
            let fault = contactor_fault(&self.planted, self.ms, index);
            let closed = match fault {
                ContactorFault::Welded | ContactorFault::ShowsClosed => true,
                ContactorFault::StuckOpen | ContactorFault::ShowsOpen => false,
                ContactorFault::None => self.contactor_states[index].is_closed(),
            };
            *shown = if closed { Feedback::Closed } else { Feedback::Open };
        }
        shown
    }

    fn drive(&mut self, coils: Coils) -> bool {
        self.coils = coils;
        true
    }

    fn bleed(&mut self, cells: &[bool; CELLS]) {
        self.bled = *cells;
    }

    fn flags(&mut self) -> Faults {
        let mut flags = Faults::NONE;
        for (fault, id) in [
            (Fault::Crash, Id::Crash),
            (Fault::Interlock, Id::Interlock),
            (Fault::RequestLost, Id::RequestLost),
            (Fault::RequestCorrupt, Id::RequestCorrupt),
        ] {
            if self.now(fault).is_some() {
                flags = flags.with(id);
            }
        }
        flags
    }

    fn insulation_ohm_per_v(&mut self) -> Option<Reading> {
        let (ohm, at_ms) = self.insulation_ohm?;
        #[expect(clippy::cast_precision_loss, reason = "seconds")]
        let age_s = 0.001 * (self.ms - at_ms) as f32;
        Some(Reading { age_s, ..Reading::new(ohm / self.pack_v) })
    }
}

impl Rig {
    /// The two wires above a cell and above the next are swapped.
    fn swap_wires(&self, into: &mut Measurements<CELLS, SENSORS>, at: usize) {
        let cell_v = |cell: usize| self.cell_v.get(cell).copied().unwrap_or(0.0);
        let next_v = cell_v(at + 1);
        for (cell, reads_v) in
            [(at, cell_v(at) + next_v), (at + 1, -next_v), (at + 2, next_v + cell_v(at + 2))]
        {
            if let Some(reading) = into.cell_v.get_mut(cell) {
                reading.value = reads_v;
            }
        }
    }

    fn measure_cells(&mut self, into: &mut Measurements<CELLS, SENSORS>) {
        let noise_v = SHEET.sensing.cell_v.noise_sd;
        let before_v = into.cell_v.map(|reading| reading.value);
        for (reading, cell_v) in into.cell_v.iter_mut().zip(self.cell_v) {
            *reading = Reading::new(cell_v + noise_v * self.random.normal());
        }
        for planted in self.planted.iter().filter(|p| self.ms >= p.from_ms) {
            let at = planted.at;
            if planted.fault == Fault::CellsSwapped {
                self.swap_wires(into, at);
                continue;
            }
            let cell = &mut into.cell_v[at].value;
            match planted.fault {
                Fault::CellStuck => *cell = before_v[at],
                Fault::CellReadsHigh => *cell += planted.much,
                Fault::CellReadsLow => *cell -= planted.much,
                Fault::CellWireOpen => *cell = 0.05,
                Fault::CellSentinel => *cell = 819.1,
                _ => {}
            }
        }
    }

    fn measure_temperatures(&mut self, into: &mut Measurements<CELLS, SENSORS>) {
        let noise_k = SHEET.sensing.temperature_c.noise_sd;
        let before_c = into.temperature_c.map(|reading| reading.value);
        for (index, reading) in into.temperature_c.iter_mut().enumerate() {
            // A sensor at every other cell, from the third on.
            let cell = (2 + 4 * index).min(CELLS - 1);
            let celsius = self.state.cells[cell].temperature_c.get();
            *reading = Reading::new(celsius + noise_k * self.random.normal());
        }
        for planted in self.planted.iter().filter(|p| self.ms >= p.from_ms) {
            let Some(sensor) = into.temperature_c.get_mut(planted.at) else { continue };
            match planted.fault {
                Fault::TemperatureStuck => sensor.value = before_c[planted.at],
                Fault::TemperatureReadsLow => sensor.value -= planted.much,
                Fault::TemperatureOpen => sensor.value = -60.0,
                Fault::TemperatureShort => sensor.value = 150.0,
                _ => {}
            }
        }
    }
}
