//! A healthy pack, and the event of each row in it.

use crate::protect::{
    EXAMPLE, Faults, Flow, Id, Level, Protection, ProtectionState, Side, Signals, Source, Table,
    Verdict,
};
use crate::{Measurements, Reading, Real, must};

pub const TABLE: Table = must!(Table::new(EXAMPLE));
pub const PACK: Protection<'static, 14, 4> = must!(Protection::new(&TABLE));
pub const CELLS: usize = 14;

pub type State = ProtectionState<14, 4>;

#[derive(Clone, Copy)]
pub struct Scene {
    pub now: Measurements<14, 4>,
    pub wires_v: [Real; CELLS + 1],
    pub signals: Signals<'static>,
}

impl Scene {
    pub fn healthy() -> Self {
        Self {
            now: Measurements {
                cell_v: [Reading::new(3.7); CELLS],
                temperature_c: [Reading::new(25.0); 4],
                current_a: Reading::new(12.0),
                pack_v: Reading::new(51.8),
                link_v: Reading::new(51.8),
            },
            wires_v: [0.01; CELLS + 1],
            signals: Signals {
                mains_closed: true,
                second_current_a: 12.0,
                residual_v: 0.001,
                cells_found: Some(14),
                insulation_ohm_per_v: Some(Reading::new(5000.0)),
                elapsed_s: EXAMPLE.tick_s,
                ..Signals::QUIET
            },
        }
    }

    pub fn step(&self, state: &mut State) -> Verdict {
        self.step_of(&PACK, state)
    }

    pub fn step_of(&self, pack: &Protection<14, 4>, state: &mut State) -> Verdict {
        let signals = Signals { wires_v: &self.wires_v, ..self.signals };
        pack.step(state, &self.now, &signals)
    }

    /// A load that comes and goes, and cells, sensors and current that follow.
    pub fn load(&mut self, on: bool) {
        let on = if on { 1.0 } else { 0.0 };
        self.now.current_a.value = 12.0 + 100.0 * on;
        self.signals.second_current_a = self.now.current_a.value;
        self.now.cell_v = [Reading::new(3.7 - 0.1 * on); CELLS];
        self.now.pack_v.value = 14.0 * self.now.cell_v[0].value;
        self.now.link_v = self.now.pack_v;
        // More than sensors may be off, and no more than they may warm up.
        self.now.temperature_c = [Reading::new(25.0 + 2.2 * on); 4];
    }

    /// Two seconds of it: whatever was bad has healed.
    pub fn settle(&self, state: &mut State) -> Verdict {
        for _ in 0..1999 {
            self.step(state);
        }
        self.step(state)
    }

    /// Makes what a row watches bad, by a little.
    pub fn plant(&mut self, id: Id, state: &mut State) {
        let row = TABLE.row(id);
        let by = 1.01 * row.hysteresis + 1e-3;
        let value = match id.side() {
            Side::High => row.threshold + by,
            Side::Low => row.threshold - by,
        };
        match id {
            Id::CellVoltage(..) | Id::DeepDischarge => self.now.cell_v[5].value = value,
            Id::Temperature(..) => self.now.temperature_c[2].value = value,
            Id::Current(Flow::Discharge, _) | Id::Surge(Flow::Discharge) | Id::ShortCircuit => {
                self.now.current_a.value = value;
            }
            Id::Current(Flow::Charge, _) | Id::Surge(Flow::Charge) => {
                self.now.current_a.value = -value;
            }
            Id::Heat(flow) => {
                state.heat_a2s[flow as usize] = row.threshold;
                self.now.current_a.value = if flow == Flow::Discharge { 250.0 } else { -90.0 };
            }
            Id::CurrentWhileOpen => {
                self.signals.mains_closed = false;
                self.signals.all_open = true;
                self.now.current_a.value = value;
            }
            Id::PackVoltage(_) => self.now.pack_v.value = value,
            Id::CellSum => self.now.pack_v.value += value,
            Id::LinkDiffers => self.now.link_v.value -= value,
            Id::CurrentsDiffer => self.signals.second_current_a -= value,
            Id::Residual => self.signals.residual_v = -value,
            Id::CellCount => self.signals.cells_found = Some(13),
            Id::Stale(source) => self.reading(source).valid = false,
            Id::Range(source) => self.reading(source).value = 819.1,
            Id::Imbalance => self.now.cell_v[13].value += value,
            Id::TemperatureSpread => self.now.temperature_c[3].value += value,
            // A jump is that fast at first.
            Id::TemperatureRate => self.now.temperature_c[0].value += 11.5 * value,
            Id::OpenWire => self.wires_v[7] = value,
            Id::Insulation(_) => {
                self.signals.insulation_ohm_per_v = Some(Reading::new(value));
            }
            Id::LateStep => self.signals.elapsed_s = value * EXAMPLE.tick_s,
            // The readings of all but one move, or the cells do and the current does not.
            Id::StuckCell => {
                self.now.current_a.value += 40.0;
                for cell in self.now.cell_v.iter_mut().skip(1) {
                    cell.value -= 0.01;
                }
            }
            Id::StuckTemperature => {
                for sensor in self.now.temperature_c.iter_mut().skip(1) {
                    sensor.value += 3.0;
                }
            }
            Id::StuckCurrent => {
                for cell in &mut self.now.cell_v {
                    cell.value -= 0.1;
                }
            }
            _ => self.signals.flags = Faults::NONE.with(id),
        }
    }

    fn reading(&mut self, source: Source) -> &mut Reading {
        match source {
            Source::Cell => &mut self.now.cell_v[11],
            Source::Temperature => &mut self.now.temperature_c[1],
            Source::Current => &mut self.now.current_a,
            Source::Pack => &mut self.now.pack_v,
            Source::Link => &mut self.now.link_v,
        }
    }
}

/// Rows whose quantity must first be made out of readings over time.
pub fn made_over_time(id: Id) -> bool {
    matches!(id, Id::StuckCell | Id::StuckTemperature | Id::StuckCurrent)
}

pub const MSL: Level = Level::Msl;
