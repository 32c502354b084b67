//! What `example/estimators.c` does, on the estimators themselves: says the same hash.

use plant_core::battery::MappedBattery;
use plant_core::{Dt, ParamError};
use voltstep_bms::Estimate;
use voltstep_bms::estimate::cells::{CellResistances, CellResistancesState, Cells};
use voltstep_bms::estimate::coulomb::CoulombCounter;
use voltstep_bms::estimate::ekf::{Ekf, EkfMemory};
use voltstep_bms::estimate::energy::{EnergyGauge, EnergyInput, EnergyState};
use voltstep_bms::estimate::power::{PowerLimits, SeriesCells};
use voltstep_bms::estimate::series::{Series, SeriesInput, SeriesState};
use voltstep_bms::estimate::soh::{CapacityEstimator, ResistanceEstimator};
use voltstep_bms::store::record::Record;
use voltstep_capi::EstimatorParams;

const P: EstimatorParams = EstimatorParams::PANASONIC_NCR18650PF;
const CELLS: usize = 18;
const PER_SECOND: u32 = 10;
const DRIVEN_S: u32 = 1500;
const RESTED_S: u32 = 2400;
const DT_S: f32 = 0.1;
const TEMPERATURE_C: f32 = 25.0;

/// FNV-1a.
struct Hash(u64);

impl Hash {
    fn byte(&mut self, byte: u8) {
        self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }

    fn floats(&mut self, values: &[f32]) {
        for byte in values.iter().flat_map(|value| value.to_le_bytes()) {
            self.byte(byte);
        }
    }
}

/// What the cells are, and what the sensors show of them.
struct Profile {
    soc: f32,
    noise: u32,
}

impl Profile {
    /// The next of a sequence that looks random, in −1..1: xorshift.
    #[expect(clippy::cast_precision_loss, reason = "24 bits")]
    fn draw(&mut self) -> f32 {
        self.noise ^= self.noise << 13;
        self.noise ^= self.noise >> 17;
        self.noise ^= self.noise << 5;
        (self.noise >> 8) as f32 / 8_388_608.0 - 1.0
    }

    /// One sample: the current takes turns every five seconds, or there is none.
    fn sample(&mut self, n: u32, driven: bool) -> (f32, [f32; CELLS]) {
        const AMPS: [f32; 8] = [3.0, 7.0, 0.0, -2.0, 5.0, 1.0, 9.0, -4.0];
        let current_a = if driven { AMPS[(n / (5 * PER_SECOND) % 8) as usize] } else { 0.0 };
        self.soc -= current_a * (DT_S / 3600.0) / P.filter.battery.capacity_ah;
        let rest_v = P.filter.battery.open_circuit.at(self.soc);
        let mut cell_v = [0.0; CELLS];
        for (i, voltage_v) in (0_i16..).zip(&mut cell_v) {
            let ohm = 0.035 + 0.001 * f32::from(i);
            let off_v = 0.0005 * f32::from(i - 9);
            *voltage_v = rest_v + off_v - ohm * current_a + 0.001 * self.draw();
        }
        if n.is_multiple_of(97) {
            cell_v[3] = f32::NAN;
        }
        (current_a + 0.01 * self.draw(), cell_v)
    }
}

/// The estimators, and what they remember.
struct Pack<'b> {
    series: Series<'b>,
    of_each: CellResistances,
    power: PowerLimits<'b>,
    gauge: EnergyGauge<'b>,
    state: SeriesState<CELLS>,
    resistances: CellResistancesState<CELLS>,
    energy: EnergyState,
    mean: Estimate,
    hash: Hash,
    profile: Profile,
}

impl<'b> Pack<'b> {
    /// Nothing is known.
    fn new(battery: &'b MappedBattery, dt: Dt) -> Result<Self, ParamError> {
        let filter = Ekf::new(P.filter, dt)?;
        #[expect(clippy::cast_precision_loss, reason = "ten")]
        let second = Dt::from_s(PER_SECOND as f32 * DT_S)?;
        let series = Series {
            filter,
            counter: CoulombCounter::new(P.counter, dt)?,
            cells: Cells::new(P.cells, second)?,
            resistance: ResistanceEstimator::new(P.resistance, battery, dt)?,
            capacity: CapacityEstimator::new(P.capacity, dt)?,
            per_second: PER_SECOND,
            dt_s: DT_S,
        };
        let unlearnt = voltstep_bms::Health {
            capacity_ah: P.capacity.nominal_ah,
            capacity_sd_ah: P.capacity.nominal_sd_ah,
            resistance_factor: 1.0,
            resistance_factor_sd: P.resistance.initial_sd,
        };
        let unknown = filter.remember(&filter.start_unknown(TEMPERATURE_C)?);
        let unknown = EkfMemory { polarisation: None, ..unknown };
        let state = series.resume(unknown, unlearnt, Some(0.0), TEMPERATURE_C)?;
        let of_each = CellResistances::new(P.cell_resistances)?;
        Ok(Self {
            mean: filter.estimate(&state.filter),
            series,
            of_each,
            power: PowerLimits::new(P.power, battery)?,
            gauge: EnergyGauge::new(P.energy, battery, dt)?,
            state,
            resistances: of_each.start(),
            energy: EnergyState::default(),
            hash: Hash(0xcbf2_9ce4_8422_2325),
            profile: Profile { soc: 0.9, noise: 1 },
        })
    }

    /// Runs for so many seconds.
    fn run(&mut self, seconds: u32, driven: bool) {
        for n in 0..seconds * PER_SECOND {
            let (current_a, cell_v) = self.profile.sample(n, driven);
            let input = SeriesInput {
                cell_v: &cell_v,
                current_a,
                temperature_c: TEMPERATURE_C,
                contactors_open: false,
            };
            self.mean = self.series.step(&mut self.state, input);
            self.of_each.step(&mut self.resistances, &cell_v, current_a);
            let read = || cell_v.iter().filter(|v| v.is_finite());
            #[expect(clippy::cast_precision_loss, reason = "a few")]
            let voltage_v = read().sum::<f32>() / read().count() as f32;
            self.gauge.step(&mut self.energy, EnergyInput { current_a, voltage_v });
            self.believed();
            if n.is_multiple_of(60 * PER_SECOND) {
                self.ahead();
            }
        }
    }

    fn believed(&mut self) {
        let (e, h, counter) = (&self.mean, &self.state.health, &self.series.counter);
        let (spread, [fast_v, slow_v]) = (self.state.cells.spread(), e.polarisation_v);
        let status = self.series.filter.status(&self.state.filter);
        self.hash.floats(&[
            e.soc,
            e.soc_sd,
            fast_v,
            slow_v,
            e.hysteresis,
            e.offset_v,
            e.temperature_c,
            h.capacity_ah,
            h.capacity_sd_ah,
            h.resistance_factor,
            h.resistance_factor_sd,
            counter.soc(&self.state.counter),
            counter.soc_sd(&self.state.counter),
            spread.min,
            spread.max,
        ]);
        for index in [spread.min_index, spread.max_index] {
            self.hash.byte(u8::try_from(index).unwrap_or(u8::MAX));
        }
        self.hash.byte(status.converged.into());
        self.hash.byte(status.consistent.into());
    }

    /// What may be drawn and charged, and what is left.
    fn ahead(&mut self) {
        let cells = SeriesCells {
            mean: self.mean,
            health: self.state.health,
            socs: &self.state.cells,
            resistances: &self.resistances,
        };
        for p in self.power.ahead_of_cells(&cells) {
            self.hash.floats(&[
                p.discharge.current_a,
                p.discharge.power_w,
                p.charge.current_a,
                p.charge.power_w,
            ]);
        }
        if let Some(left) = self.gauge.report(&self.energy, &self.mean, &self.state.health) {
            self.hash.floats(&[left.remaining_energy_wh, left.remaining_energy_sd_wh]);
        }
    }

    /// The power goes, and comes again after ten minutes.
    fn cut_off(&mut self) -> Result<(), ParamError> {
        let memory = self.series.filter.remember(&self.state.filter);
        let health = self.state.health;
        for byte in Record::of(memory, health).encode(1)? {
            self.hash.byte(byte);
        }
        self.state = self.series.resume(memory, health, Some(600.0), TEMPERATURE_C)?;
        self.resistances = self.of_each.start();
        self.energy = EnergyState::default();
        Ok(())
    }

    fn cells(&mut self) {
        for index in 0..CELLS {
            if let (Some(cell), Some((ratio, ratio_sd))) =
                (self.state.cells.cell(index), self.resistances.ratio(index))
            {
                self.hash.floats(&[cell.soc, cell.soc_sd, ratio, ratio_sd]);
                self.hash.byte(cell.held.into());
            }
        }
    }
}

fn main() -> Result<(), ParamError> {
    let dt = Dt::from_s(DT_S)?;
    let battery = MappedBattery::new(P.filter.battery, dt)?;
    let mut pack = Pack::new(&battery, dt)?;
    for (seconds, driven) in
        [(DRIVEN_S, true), (RESTED_S, false), (DRIVEN_S, true), (RESTED_S, false)]
    {
        pack.run(seconds, driven);
    }
    let (truth, believed) = (pack.profile.soc, pack.mean);
    println!("estimators soc {truth} believed {} ± {}", believed.soc, believed.soc_sd);
    pack.cut_off()?;
    pack.run(60, true);
    pack.cells();
    println!("estimators hash {:016x}", pack.hash.0);
    Ok(())
}
