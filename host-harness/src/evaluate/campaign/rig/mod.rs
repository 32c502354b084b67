//! A simulated pack with contactors, link and sensors, for which a BMS cannot tell that it is one.

use plant_core::battery::{
    CellSpread, MappedBatteryParams, SeriesPack, SeriesPackInput, SeriesPackParams, SeriesPackState,
};
use plant_core::link::{
    Contactor, ContactorFault, ContactorInput, ContactorParams, ContactorState, Insulation,
    InsulationInput, InsulationParams, InsulationState, Link, LinkInput, LinkParams, LinkState,
};
use plant_core::presets::PANASONIC_NCR18650PF;
use plant_core::signal::faults::Random;
use plant_core::{Dt, ParamError};
use voltstep_bms::contactor::Coils;
use voltstep_bms::limit::Limits;

use super::demand::Demand;
use super::{CELLS, PARALLEL, PRECHARGE_OHM, SHEET};
use crate::read::scenario::{Fault, Planted};

mod board;

/// What a cell has left behind: its absolute limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Harm {
    /// Above its absolute voltage, or charged beyond full.
    Overvoltage,
    /// Below its absolute voltage, or discharged beyond empty.
    Undervoltage,
    /// Hotter than its absolute limit while in use.
    TooHot,
    /// Charged below its absolute limit.
    ChargedCold,
}

/// A cell is harmed by what lasts \[ms\]: two fault-tolerant times of a voltage. Chosen: contactors cannot
/// open before a short of the link has pulled the voltage down, and a fuse takes as long.
const HARM_MS: u32 = 340;
/// How long insulation is measured before the start \[ms\]: two readings.
const MEASURED_BEFORE_MS: u32 = 8100;
/// Leakage from either pole to the chassis without a fault \[Ω\].
const LEAKAGE_OHM: f32 = 1e6;
/// Noise of a current that nobody would call a charge \[A of a cell\].
const NO_CHARGE_A: f32 = 0.05;

/// A pack that can be driven.
#[derive(Clone)]
pub struct Rig {
    pack: SeriesPack<CELLS>,
    pub state: SeriesPackState<CELLS>,
    contactors: [Contactor; 3],
    contactor_states: [ContactorState; 3],
    link: Link,
    link_state: LinkState,
    insulation: Insulation,
    insulation_state: InsulationState,
    /// What was measured last \[Ω\], and when.
    insulation_ohm: Option<(f32, u32)>,
    random: Random,
    pub ms: u32,
    coils: Coils,
    bled: [bool; CELLS],
    planted: Vec<Planted>,
    /// Contactors stay as they are, whatever is asked: what would have happened.
    pub held: Option<Coils>,
    /// What the limits take of what the vehicle would draw \[A\], without a sign.
    pub withheld_a: f32,
    /// What it draws \[A\].
    pub demand_a: f32,
    pub battery_a: f32,
    pub harm: Option<Harm>,
    /// How long a cell has been beyond its limits \[ms\].
    beyond_ms: u32,
    cell_v: [f32; CELLS],
    pack_v: f32,
    stuck: Option<(f32, f32, f32)>,
}

impl Rig {
    /// At a state of charge and a temperature \[°C\].
    pub fn new(
        soc: f32,
        temperature_c: f32,
        seed: u32,
        planted: Vec<Planted>,
    ) -> Result<Self, ParamError> {
        let dt = Dt::from_s(SHEET.tick_s)?;
        let mut random = Random::new(seed);
        let alike = [(); CELLS].map(|()| CellSpread {
            capacity_ratio: 1.0 + 0.01 * random.normal(),
            resistance_ratio: 1.0 + 0.03 * random.normal(),
            soc_offset: 0.003 * random.normal(),
            ..CellSpread::NONE
        });
        let mut cell: MappedBatteryParams = PANASONIC_NCR18650PF.pack(1, u16::from(PARALLEL))?;
        // Whoever ignores the limits is not stopped by the model.
        (cell.discharge_limit_a, cell.charge_limit_a) = (f32::INFINITY, f32::INFINITY);
        cell.thermal.ambient_c = temperature_c;
        let pack =
            SeriesPack::new(SeriesPackParams { cell, spread: alike, neighbour_w_per_k: 0.5 }, dt)?;
        let much =
            |fault| planted.iter().find(|p| p.fault == fault).map_or(1.0, |planted| planted.much);
        let link = LinkParams {
            capacitance_f: 0.04 / PRECHARGE_OHM * much(Fault::LinkTooLarge),
            bleeder_ohm: 2000.0,
            precharge_ohm: PRECHARGE_OHM * much(Fault::PrechargeResistorOpen),
            contact_ohm: 0.001,
            fuse_rated_a: 300.0,
            fuse_melting_a2s: 5e4,
        };
        let mut rig = Self {
            state: pack.rested(soc)?,
            pack,
            contactors: [Contactor::new(ContactorParams::USUAL, dt)?; 3],
            contactor_states: [ContactorState::default(); 3],
            link: Link::new(link, dt)?,
            link_state: LinkState::default(),
            insulation: Insulation::new(InsulationParams::USUAL, dt)?,
            insulation_state: InsulationState::default(),
            insulation_ohm: None,
            random,
            ms: 0,
            coils: Coils::default(),
            bled: [false; CELLS],
            planted,
            held: None,
            withheld_a: 0.0,
            demand_a: 0.0,
            battery_a: 0.0,
            harm: None,
            beyond_ms: 0,
            cell_v: [3.7; CELLS],
            pack_v: 3.7 * 14.0,
            stuck: None,
        };
        // The device has measured before anybody asks for the contactors.
        for _ in 0..MEASURED_BEFORE_MS {
            rig.leak();
        }
        Ok(rig)
    }

    /// A planted fault, once it is there.
    fn planted(&self, fault: Fault) -> Option<&Planted> {
        self.planted.iter().find(|p| p.fault == fault && self.ms >= p.from_ms)
    }

    /// How much of it.
    fn now(&self, fault: Fault) -> Option<f32> {
        self.planted(fault).map(|p| p.much)
    }

    /// How the vehicle drives or is charged, within the limits that it is told.
    pub fn drive(&mut self, limits: &Limits, demand: &Demand) {
        let wanted_a = demand.at(self.ms);
        let told_a = wanted_a.clamp(-limits.charge.current_a, limits.discharge.current_a);
        self.withheld_a = (wanted_a - told_a).abs();
        self.demand_a = match (self.now(Fault::Overcharge), self.now(Fault::Overload)) {
            (Some(charged_a), _) => -charged_a,
            (_, Some(drawn_a)) => drawn_a,
            _ => told_a,
        };
    }

    /// A millisecond passes.
    pub fn advance(&mut self) {
        self.ms += 1;
        let coils = self.held.unwrap_or(self.coils);
        let driven = [coils.minus, coils.precharge, coils.plus];
        let mut conducts = [false; 3];
        for (index, (contactor, state)) in
            self.contactors.iter().zip(&mut self.contactor_states).enumerate()
        {
            let fault = contactor_fault(&self.planted, self.ms, index);
            conducts[index] =
                contactor.step(state, ContactorInput { coil: driven[index], fault }).conducts;
        }
        let [minus, precharge, plus] = conducts;
        let short_ohm = self
            .now(Fault::LinkShort)
            .or_else(|| self.now(Fault::LinkShortBefore))
            .unwrap_or(f32::INFINITY);
        let load_a = if minus && plus { self.demand_a } else { 0.0 };
        let (source, _) = self.pack.offer(&self.state);
        let out = self.link.step(
            &mut self.link_state,
            LinkInput { source, minus, precharge, plus, load_a, short_ohm },
        );
        self.battery_a = out.battery_a;
        let mut bleed_a = [0.0; CELLS];
        for ((bleed_a, on), cell_v) in bleed_a.iter_mut().zip(self.bled).zip(self.cell_v) {
            *bleed_a = if on { cell_v / 33.0 } else { 0.0 };
        }
        for planted in self.planted.iter().filter(|p| self.ms >= p.from_ms) {
            let Planted { fault, much, at, .. } = *planted;
            match fault {
                Fault::CellShort => bleed_a[at] += self.cell_v[at] / much,
                Fault::CellHeated => self.state.cells[at].temperature_c.add(much * 0.001),
                _ => {}
            }
        }
        let out =
            self.pack.step(&mut self.state, SeriesPackInput { current_a: self.battery_a, bleed_a });
        self.cell_v = out.cell_v;
        self.pack_v = out.terminal_v;
        self.leak();
        self.look(out.refused_charge_c, &out.cell_temperature_c);
    }

    /// Leakage to the chassis, and what its device measures of it.
    fn leak(&mut self) {
        // The fault is stated as devices show it, by the pack's voltage, and lies at the plus pole.
        let plus_ohm = self.now(Fault::Insulation).map_or(LEAKAGE_OHM, |of| of * self.pack_v);
        let input = InsulationInput { pack_v: self.pack_v, plus_ohm, minus_ohm: LEAKAGE_OHM };
        let out = self.insulation.step(&mut self.insulation_state, input);
        if let Some(ohm) = out.measured_ohm {
            self.insulation_ohm = Some((ohm, self.ms));
        }
    }

    /// Whether a cell has left its absolute limits.
    fn look(&mut self, refused_charge_c: f32, temperature_c: &[f32; CELLS]) {
        let cell = &SHEET.cell;
        let cell_a = self.battery_a / f32::from(PARALLEL);
        let (mut low_v, mut high_v) = (f32::INFINITY, f32::NEG_INFINITY);
        for cell_v in self.cell_v {
            (low_v, high_v) = (low_v.min(cell_v), high_v.max(cell_v));
        }
        let hottest_c = temperature_c.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let coldest_c = temperature_c.iter().copied().fold(f32::INFINITY, f32::min);
        let harm = if high_v > cell.voltage.absolute_max_v || refused_charge_c < 0.0 {
            Some(Harm::Overvoltage)
        } else if low_v < cell.voltage.absolute_min_v || refused_charge_c > 0.0 {
            Some(Harm::Undervoltage)
        } else if hottest_c > cell.discharge_window.none_above_c && cell_a.abs() > NO_CHARGE_A {
            Some(Harm::TooHot)
        } else if coldest_c < cell.charge_window.none_below_c && cell_a < -NO_CHARGE_A {
            Some(Harm::ChargedCold)
        } else {
            None
        };
        self.beyond_ms = if harm.is_some() { self.beyond_ms + 1 } else { 0 };
        if self.beyond_ms >= HARM_MS {
            self.harm = self.harm.or(harm);
        }
    }
}

/// What is wrong with a contactor: 0 minus, 1 precharge, 2 plus.
fn contactor_fault(planted: &[Planted], ms: u32, index: usize) -> ContactorFault {
    let of = |planted: &Planted| match (planted.fault, index) {
        (Fault::MinusStuckOpen, 0) | (Fault::PrechargeStuckOpen, 1) | (Fault::PlusStuckOpen, 2) => {
            Some(ContactorFault::StuckOpen)
        }
        (Fault::MinusWelded, 0) | (Fault::PrechargeWelded, 1) | (Fault::PlusWelded, 2) => {
            Some(ContactorFault::Welded)
        }
        (Fault::MinusShowsOpen, 0) | (Fault::PlusShowsOpen, 2) => Some(ContactorFault::ShowsOpen),
        (Fault::PrechargeShowsClosed, 1) => Some(ContactorFault::ShowsClosed),
        _ => None,
    };
    let there = planted.iter().filter(|p| ms >= p.from_ms);
    there.rev().find_map(of).unwrap_or(ContactorFault::None)
}
