//! One simulated battery, what is wrong with it, and the filter that looks at it.

use plant_core::Dt;
use plant_core::battery::{MappedBattery, MappedBatteryInput, MappedBatteryParams};
use voltstep_bms::estimate::ekf::{Ekf, EkfInput, EkfParams, EkfState};
use voltstep_bms::measure::{Measurements, Reading};

use super::Kind;
use super::batteries::{Chemistry, bend, in_series, scale_resistances};
use super::random::Random;
use super::tally::{Said, Tally};

const DT_S: f32 = 1.0;
/// A start is judged from here on \[s\].
const JUDGED_FROM_S: u32 = 60;
/// Drives end, and charging begins, here; it ends there.
const LOW: f32 = 0.32;
const HIGH: f32 = 0.84;
/// A rest after either \[s\].
const RESTED_S: u32 = 7200;
/// Cosines that make up an error of the curve, and how far apart it is another one.
const WAVES: usize = 40;
const WAVE_SOC: f32 = 0.06;

/// What the current does.
#[derive(Clone, Copy, PartialEq)]
enum Load {
    /// Driven, rested, charged, and again.
    Days,
    /// Driven for an hour, then rested.
    Drive,
    /// Nothing.
    Rest,
}

/// A battery, its sensors and what the filter is told.
pub struct World {
    truth: MappedBatteryParams,
    believed: EkfParams,
    random: Random,
    soc: f32,
    celsius: f32,
    /// What the filter is told of the start, and how well that is said to be known.
    told: Option<(f32, f32)>,
    /// Before the start a current \[A\] has flowed for 25 minutes.
    before_a: f32,
    load: Load,
    seconds: u32,
    /// Flows beside the load, unseen \[A\].
    unseen_a: f32,
    gain: f32,
    offset_a: f32,
    /// The ammeter shows this, whatever flows \[A\].
    stuck_a: Option<f32>,
    /// The battery has so many cells less than the filter is told, and the sum of the cells is
    /// compared with the whole.
    cells_less: f32,
    noise_v: f32,
    quantum_v: f32,
    missing: f64,
}

/// Who draws the current.
struct Driver {
    load: Load,
    /// While driven \[A\], for so many seconds.
    wanted_a: f32,
    left: u32,
    charging: bool,
    /// Rests for so many seconds.
    resting: u32,
}

impl Driver {
    fn current_a(&mut self, second: u32, soc: f32, capacity_ah: f32) -> f32 {
        self.left -= 1;
        match self.load {
            Load::Drive if second < 3600 && soc > LOW => self.wanted_a,
            Load::Rest | Load::Drive => 0.0,
            Load::Days if self.resting > 0 => {
                self.resting -= 1;
                0.0
            }
            Load::Days => {
                let turns = if self.charging { soc >= HIGH } else { soc <= LOW };
                if turns {
                    (self.charging, self.resting) = (!self.charging, RESTED_S);
                }
                if self.charging { -0.3 * capacity_ah } else { self.wanted_a }
            }
        }
    }
}

impl World {
    /// Draws what is wrong.
    pub fn new(kind: Kind, chemistry: Chemistry, seed: u64) -> Self {
        let truth = chemistry.params();
        let nominal_v = truth.open_circuit.at(0.5);
        let believed = EkfParams::typical(truth, nominal_v);
        let cells = nominal_v / 3.65;
        let mut random = Random::new(1000 * kind as u64 + seed);
        let soc = LOW + 0.05 + (HIGH - LOW - 0.05) * random.even();
        let mut world = Self {
            truth,
            believed,
            soc,
            celsius: 25.0,
            told: Some((soc, 0.02)),
            before_a: 0.0,
            load: Load::Days,
            seconds: 86_400,
            unseen_a: 0.0,
            gain: 1.0,
            offset_a: 0.0,
            stuck_a: None,
            cells_less: 0.0,
            noise_v: 0.001 * cells,
            quantum_v: 0.001 * cells,
            missing: 0.0,
            random,
        };
        world.spoil(kind, chemistry, cells);
        world
    }

    fn spoil(&mut self, kind: Kind, chemistry: Chemistry, cells: f32) {
        let known = self.believed.uncertainty;
        let capacity_ah = self.truth.capacity_ah;
        match kind {
            Kind::Clean => self.told = Some((self.soc, 0.01)),
            Kind::Drawn => {
                self.bend_curve(known.open_circuit_sd_v);
                let factor = (1.0 + known.resistance_sd * self.random.normal()).max(0.3);
                scale_resistances(&mut self.truth, factor);
                self.truth.capacity_ah *= 1.0 + known.capacity_sd * self.random.normal();
                self.offset_a = known.current_offset_sd_a * self.random.normal();
                self.celsius = self.random.one_of(&[25.0, 10.0, 0.0]);
                let sd = self.random.one_of(&[0.02, 0.05, 0.1]);
                self.told = Some(((self.soc + sd * self.random.normal()).clamp(0.0, 1.0), sd));
            }
            Kind::Drain => {
                self.load = Load::Rest;
                self.soc = 0.5 + 0.34 * self.random.even();
                self.told = Some((self.soc, 0.02));
                self.unseen_a = capacity_ah / 300.0 * 0.1_f32.powf(self.random.even());
                self.seconds = 4 * 86_400;
            }
            Kind::Rest => {
                self.load = Load::Rest;
                let up_v = known.open_circuit_sd_v * self.random.normal().clamp(-2.0, 2.0);
                bend(&mut self.truth, |_| up_v);
                self.told = None;
            }
            Kind::Reset => {
                self.load = if self.random.coin() { Load::Drive } else { Load::Rest };
                self.soc = 0.55;
                let per_hour = 0.15 + 0.4 * self.random.even();
                self.before_a = if self.random.coin() { per_hour } else { -per_hour } * capacity_ah;
                self.celsius = self.random.one_of(&[25.0, 10.0, 0.0]);
                self.told = self.random.coin().then_some((0.0, 0.05));
                self.seconds = 3 * 3600;
            }
            Kind::Dropouts => {
                self.missing = f64::from(0.001 * 200.0_f32.powf(self.random.even()));
            }
            Kind::Quantised => {
                self.quantum_v = cells * self.random.one_of(&[0.005, 0.01, 0.02]);
                self.noise_v = 0.0;
                self.believed.uncertainty.voltage_sd_v =
                    known.voltage_sd_v.max(self.quantum_v / 12.0_f32.sqrt());
            }
            Kind::Stale => {
                let off = if self.random.coin() { 0.08 } else { -0.08 };
                self.told = Some((self.soc + off, 0.01));
            }
            Kind::Dead => self.gain = 0.0,
            Kind::Reversed => self.gain = -1.0,
            Kind::Stuck => {
                self.stuck_a = Some(capacity_ah * (0.33 + 0.6 * self.random.normal()).max(-0.6));
            }
            Kind::WrongCurve => self.bend_curve(4.0 * known.open_circuit_sd_v),
            Kind::OtherCells => self.truth = chemistry.other(),
            Kind::FewerCells => {
                self.cells_less = 1.0;
                in_series(&mut self.truth, 1.0 - 1.0 / chemistry.cells());
            }
            Kind::Aged => {
                scale_resistances(&mut self.truth, 1.4 + 0.4 * self.random.even());
                self.truth.capacity_ah *= 0.9 - 0.1 * self.random.even();
            }
            // Not of the filter.
            Kind::BadPair | Kind::WeakCell | Kind::Energy => {}
        }
    }

    /// A smooth error of the curve with this standard deviation \[V\].
    fn bend_curve(&mut self, sd_v: f32) {
        let waves: [(f32, f32); WAVES] = std::array::from_fn(|_| {
            (self.random.normal() / WAVE_SOC, std::f32::consts::TAU * self.random.even())
        });
        #[expect(clippy::cast_precision_loss, reason = "a few")]
        let height_v = sd_v * (2.0 / WAVES as f32).sqrt();
        bend(&mut self.truth, |soc| {
            height_v * waves.iter().map(|(per_soc, at)| (per_soc * soc + at).cos()).sum::<f32>()
        });
    }

    /// Runs the filter over it.
    ///
    /// # Panics
    /// Where a battery or a filter refuses what is simulated: a mistake in the matrix itself.
    pub fn run(mut self) -> Tally {
        let dt = Dt::from_s(DT_S).expect("a second");
        self.truth.discharge_limit_a = 1e4;
        self.truth.charge_limit_a = 1e4;
        let battery = MappedBattery::new(self.truth, dt).expect("a battery");
        let filter = Ekf::new(self.believed, dt).expect("a filter");
        let mut cell = battery.rested_at(self.soc, self.celsius).expect("a state");
        if self.before_a != 0.0 {
            for _ in 0..1500 {
                battery.step(&mut cell, MappedBatteryInput { current_a: self.before_a });
            }
            self.told = self.told.map(|(_, sd)| (cell.soc.get(), sd));
        }
        let mut state = self.start(&filter);
        let mut tally = Tally::default();
        let mut driver =
            Driver { load: self.load, wanted_a: 0.0, left: 0, charging: false, resting: 0 };
        for second in 0..self.seconds {
            if driver.left == 0 {
                driver.left = self.random.count(1..20);
                driver.wanted_a =
                    self.truth.capacity_ah * (0.33 + 0.6 * self.random.normal()).max(-0.6);
            }
            let current_a = driver.current_a(second, cell.soc.get(), self.truth.capacity_ah);
            let out = battery
                .step(&mut cell, MappedBatteryInput { current_a: current_a + self.unseen_a });
            let input = self.sense(current_a, out.terminal_v, out.temperature_c);
            filter.step(&mut state, input);
            let truth = f64::from(cell.soc.get());
            // Where the truth is beyond what the model knows, nobody is asked.
            let known = self.believed.battery.identified.holds(cell.soc.get(), out.temperature_c);
            if second >= JUDGED_FROM_S && known {
                let (estimate, status) = (filter.estimate(&state), filter.status(&state));
                let said = Said {
                    value: f64::from(estimate.soc),
                    sd: f64::from(estimate.soc_sd),
                    contradicted: !status.consistent || self.miscounted(input.voltage_v),
                    outside_known: status.outside_identified,
                };
                tally.book(said, truth, f64::from(DT_S));
            }
        }
        tally
    }

    fn start(&self, filter: &Ekf) -> EkfState {
        match self.told {
            Some((soc, sd)) => filter.start(soc, sd, self.celsius),
            None => filter.start_unknown(self.celsius),
        }
        .expect("a start")
    }

    fn sense(&mut self, current_a: f32, voltage_v: f32, temperature_c: f32) -> EkfInput {
        let noise_a = 0.003 * self.truth.capacity_ah * self.random.normal();
        let voltage_v = voltage_v + self.noise_v * self.random.normal();
        let mut input = EkfInput {
            current_a: self.stuck_a.unwrap_or(self.gain * current_a + self.offset_a + noise_a),
            voltage_v: (voltage_v / self.quantum_v).round() * self.quantum_v,
            temperature_c,
            contactors_open: false,
        };
        if self.random.even_f64() < self.missing {
            (input.current_a, input.voltage_v) = (f32::NAN, f32::NAN);
        }
        input
    }

    /// Whether the cells in series, as many as the filter is told, and the whole do not fit.
    fn miscounted(&self, voltage_v: f32) -> bool {
        const CELLS: usize = 96;
        if self.cells_less == 0.0 {
            return false;
        }
        #[expect(clippy::cast_precision_loss, reason = "96")]
        let cell_v = voltage_v / (CELLS as f32 - self.cells_less);
        let measured: Measurements<CELLS, 0> = Measurements {
            cell_v: [Reading::new(cell_v); CELLS],
            pack_v: Reading::new(voltage_v),
            ..Measurements::NONE
        };
        measured.fits_in_series(1.0) == Some(false)
    }
}
