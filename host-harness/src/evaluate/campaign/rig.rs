//! A simulated pack with contactors, link and sensors, for which a BMS cannot tell that it is one.

use plant_core::battery::{
    CellSpread, MappedBatteryParams, SeriesPack, SeriesPackInput, SeriesPackParams, SeriesPackState,
};
use plant_core::link::{
    Contactor, ContactorFault, ContactorInput, ContactorParams, ContactorState, Link, LinkInput,
    LinkParams, LinkState,
};
use plant_core::presets::PANASONIC_NCR18650PF;
use plant_core::signal::faults::Random;
use plant_core::{Dt, ParamError};
use voltstep_bms::contactor::{Coils, Feedback};
use voltstep_bms::limit::Limits;
use voltstep_bms::manage::Board;
use voltstep_bms::protect::{Faults, Id};
use voltstep_bms::{Measurements, Reading};

use super::fault::{Fault, Planted};
use super::{CELLS, PARALLEL, PRECHARGE_OHM, SENSORS, SHEET};

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
    random: Random,
    pub ms: u32,
    coils: Coils,
    bled: [bool; CELLS],
    planted: Option<Planted>,
    /// Contactors stay as they are, whatever is asked: what would have happened.
    pub held: Option<Coils>,
    /// What the vehicle draws \[A\].
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
        planted: Option<Planted>,
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
        let much = |fault| planted.filter(|p| p.fault == fault).map_or(1.0, |p| p.much);
        let link = LinkParams {
            capacitance_f: 0.04 / PRECHARGE_OHM * much(Fault::LinkTooLarge),
            bleeder_ohm: 2000.0,
            precharge_ohm: PRECHARGE_OHM * much(Fault::PrechargeResistorOpen),
            contact_ohm: 0.001,
            fuse_rated_a: 300.0,
            fuse_melting_a2s: 5e4,
        };
        Ok(Self {
            state: pack.rested(soc)?,
            pack,
            contactors: [Contactor::new(ContactorParams::USUAL, dt)?; 3],
            contactor_states: [ContactorState::default(); 3],
            link: Link::new(link, dt)?,
            link_state: LinkState::default(),
            random,
            ms: 0,
            coils: Coils::default(),
            bled: [false; CELLS],
            planted,
            held: None,
            demand_a: 0.0,
            battery_a: 0.0,
            harm: None,
            beyond_ms: 0,
            cell_v: [3.7; CELLS],
            pack_v: 3.7 * 14.0,
            stuck: None,
        })
    }

    /// The planted fault, once it is there.
    fn now(&self, fault: Fault) -> Option<f32> {
        self.planted.filter(|p| p.fault == fault && self.ms >= p.from_ms).map(|p| p.much)
    }

    /// How the vehicle drives: pulses and braking, within the limits that it is told.
    pub fn drive(&mut self, limits: &Limits, charging: bool) {
        const PULSES_A: [f32; 8] = [40.0, 0.0, 120.0, 60.0, -60.0, 20.0, 90.0, -30.0];
        let pulse_a = PULSES_A[(self.ms / 700) as usize % PULSES_A.len()];
        let wanted_a = if charging { -20.0 } else { pulse_a };
        let told_a = wanted_a.clamp(-limits.charge.current_a, limits.discharge.current_a);
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
            let fault = contactor_fault(self.planted, self.ms, index);
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
        if let Some(short_ohm) = self.now(Fault::CellShort) {
            bleed_a[6] += self.cell_v[6] / short_ohm;
        }
        if let Some(k_per_s) = self.now(Fault::CellHeated) {
            self.state.cells[6].temperature_c.add(k_per_s * 0.001);
        }
        let out =
            self.pack.step(&mut self.state, SeriesPackInput { current_a: self.battery_a, bleed_a });
        self.cell_v = out.cell_v;
        self.pack_v = out.terminal_v;
        self.look(out.refused_charge_c, &out.cell_temperature_c);
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
fn contactor_fault(planted: Option<Planted>, ms: u32, index: usize) -> ContactorFault {
    let Some(planted) = planted.filter(|p| ms >= p.from_ms) else { return ContactorFault::None };
    match (planted.fault, index) {
        (Fault::MinusStuckOpen, 0) | (Fault::PrechargeStuckOpen, 1) | (Fault::PlusStuckOpen, 2) => {
            ContactorFault::StuckOpen
        }
        (Fault::MinusWelded, 0) | (Fault::PrechargeWelded, 1) | (Fault::PlusWelded, 2) => {
            ContactorFault::Welded
        }
        (Fault::MinusShowsOpen, 0) | (Fault::PlusShowsOpen, 2) => ContactorFault::ShowsOpen,
        (Fault::PrechargeShowsClosed, 1) => ContactorFault::ShowsClosed,
        _ => ContactorFault::None,
    }
}

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
            let fault = contactor_fault(self.planted, self.ms, index);
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
        Some(Reading::new(self.now(Fault::Insulation).unwrap_or(5000.0)))
    }
}

impl Rig {
    fn measure_cells(&mut self, into: &mut Measurements<CELLS, SENSORS>) {
        let noise_v = SHEET.sensing.cell_v.noise_sd;
        let before_v = into.cell_v[6].value;
        for (reading, cell_v) in into.cell_v.iter_mut().zip(self.cell_v) {
            *reading = Reading::new(cell_v + noise_v * self.random.normal());
        }
        let cell = &mut into.cell_v[6].value;
        if self.planted.is_some_and(|p| p.fault == Fault::CellStuck && self.ms >= p.from_ms) {
            *cell = before_v;
        }
        *cell += self.now(Fault::CellReadsHigh).unwrap_or(0.0)
            - self.now(Fault::CellReadsLow).unwrap_or(0.0);
        if self.now(Fault::CellWireOpen).is_some() {
            into.cell_v[6].value = 0.05;
        }
        if self.now(Fault::CellSentinel).is_some() {
            into.cell_v[6].value = 819.1;
        }
        if self.now(Fault::CellsSwapped).is_some() {
            into.cell_v.swap(6, 7);
        }
    }

    fn measure_temperatures(&mut self, into: &mut Measurements<CELLS, SENSORS>) {
        let noise_k = SHEET.sensing.temperature_c.noise_sd;
        let before_c = into.temperature_c[1].value;
        for (index, reading) in into.temperature_c.iter_mut().enumerate() {
            // A sensor at every other cell, from the third on.
            let cell = (2 + 4 * index).min(CELLS - 1);
            let celsius = self.state.cells[cell].temperature_c.get();
            *reading = Reading::new(celsius + noise_k * self.random.normal());
        }
        let sensor = &mut into.temperature_c[1].value;
        if self.planted.is_some_and(|p| p.fault == Fault::TemperatureStuck && self.ms >= p.from_ms)
        {
            *sensor = before_c;
        }
        *sensor -= self.now(Fault::TemperatureReadsLow).unwrap_or(0.0);
        if self.now(Fault::TemperatureOpen).is_some() {
            into.temperature_c[1].value = -60.0;
        }
        if self.now(Fault::TemperatureShort).is_some() {
            into.temperature_c[1].value = 150.0;
        }
    }
}
