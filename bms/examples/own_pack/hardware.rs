//! In place of drivers: a simulated pack behind them.

use plant_core::battery::{
    CellSpread, SeriesPack, SeriesPackInput, SeriesPackParams, SeriesPackState,
};
use plant_core::link::{
    Contactor, ContactorFault, ContactorInput, ContactorParams, ContactorState, Link, LinkInput,
    LinkParams, LinkState,
};
use plant_core::num::clamp;
use plant_core::presets::PANASONIC_NCR18650PF as CELL;
use plant_core::signal::faults::Random;
use plant_core::{Dt, ParamError, must};
use voltstep_bms::limit::Limits;

const TICK: Dt = must!(Dt::from_s(0.001));
const WEAK: CellSpread =
    CellSpread { capacity_ratio: 0.97, resistance_ratio: 1.1, ..CellSpread::NONE };
const PACK: SeriesPack<14> = must!(SeriesPack::new(
    SeriesPackParams {
        cell: must!(CELL.pack(1, 20)),
        spread: {
            let mut spread = [CellSpread::NONE; 14];
            spread[9] = WEAK;
            spread
        },
        neighbour_w_per_k: 0.5,
    },
    TICK,
));
const LINK: Link = must!(Link::new(
    LinkParams {
        capacitance_f: 0.0012,
        bleeder_ohm: 5000.0,
        precharge_ohm: 33.0,
        contact_ohm: 0.001,
        fuse_rated_a: 300.0,
        fuse_melting_a2s: 5e4,
    },
    TICK,
));
const CONTACTOR: Contactor = must!(Contactor::new(ContactorParams::USUAL, TICK));

/// A pack, its contactors and sensors.
#[derive(Clone)]
pub struct Hardware {
    pub milliseconds: u32,
    pack: SeriesPackState<14>,
    cell_v: [f32; 14],
    link: LinkState,
    contactors: [ContactorState; 3],
    pins: [bool; 3],
    conducts: [bool; 3],
    bleed_a: [f32; 14],
    battery_a: f32,
    noise: Random,
}

impl Hardware {
    pub fn at(soc: f32) -> Result<Self, ParamError> {
        Ok(Self {
            milliseconds: 0,
            pack: PACK.rested(soc)?,
            cell_v: [3.6; 14],
            link: LinkState::default(),
            contactors: [ContactorState::default(); 3],
            pins: [false; 3],
            conducts: [false; 3],
            bleed_a: [0.0; 14],
            battery_a: 0.0,
            noise: Random::new(1),
        })
    }

    /// What is really in the pack.
    pub fn soc(&self) -> f32 {
        let mut sum = 0.0;
        for cell in &self.pack.cells {
            sum += cell.soc.get();
        }
        sum / 14.0
    }

    pub fn front_end_is_ready(&self) -> bool {
        self.milliseconds.is_multiple_of(20)
    }

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "millivolts")]
    pub fn cells_mv(&mut self) -> [u16; 14] {
        self.cell_v.map(|v| (1000.0 * v + self.noise.normal() + 0.5) as u16)
    }

    pub fn temperatures_c(&mut self) -> [f32; 4] {
        [0, 4, 9, 13].map(|cell: usize| self.pack.cells[cell].temperature_c.get())
    }

    pub fn current_a(&mut self) -> f32 {
        self.battery_a + 0.2 * self.noise.normal()
    }

    pub fn pack_v(&mut self) -> f32 {
        self.cell_v.iter().sum::<f32>() + 0.02 * self.noise.normal()
    }

    pub fn link_v(&mut self) -> f32 {
        self.link.voltage_v.get() + 0.02 * self.noise.normal()
    }

    pub fn pins(&self) -> [bool; 3] {
        self.contactors.map(|contactor| contactor.is_closed())
    }

    /// What the contactors are told.
    #[allow(dead_code, reason = "shown on a board")]
    pub fn coils(&self) -> [bool; 3] {
        self.pins
    }

    pub fn set_pins(&mut self, pins: [bool; 3]) -> bool {
        self.pins = pins;
        true
    }

    pub fn bleed(&mut self, cells: &[bool; 14]) {
        self.bleed_a = cells.map(|on| if on { 0.11 } else { 0.0 });
    }

    /// A vehicle that pulls and brakes, within its limits.
    pub fn wait_for_the_next_millisecond(&mut self, limits: &Limits) {
        self.milliseconds += 1;
        let wanted_a = match self.milliseconds / 2000 % 4 {
            0 => 80.0,
            1 => 20.0,
            2 => -20.0,
            _ => 0.0,
        };
        let told_a = clamp(wanted_a, -limits.charge.current_a, limits.discharge.current_a);
        for index in 0..3 {
            let input = ContactorInput { coil: self.pins[index], fault: ContactorFault::None };
            self.conducts[index] = CONTACTOR.step(&mut self.contactors[index], input).conducts;
        }
        let [minus, precharge, plus] = self.conducts;
        let (source, _) = PACK.offer(&self.pack);
        let load_a = if minus && plus { told_a } else { 0.0 };
        let short_ohm = f32::INFINITY;
        let input = LinkInput { source, minus, precharge, plus, load_a, short_ohm };
        self.battery_a = LINK.step(&mut self.link, input).battery_a;
        let input = SeriesPackInput { current_a: self.battery_a, bleed_a: self.bleed_a };
        self.cell_v = PACK.step(&mut self.pack, input).cell_v;
    }
}
