//! The whole BMS as one struct: from one description of a pack to contactors, limits, estimates and a
//! record.
//!
//! [`BmsParams`] describes cell, pack, sensors, precharge and balancing in the terms of data sheets;
//! [`Description`] checks it and derives the table of rows, when compiling; [`Bms`] derives every
//! estimator and controller from that. Three calls, from one loop or from interrupts that do not
//! preempt each other:
//!
//! | Call | How often | What it does |
//! |---|---|---|
//! | [`Bms::fast`] | 1 kHz, `sheet.tick_s` | reads, judges every row, moves the contactors, counts; waits for nothing |
//! | [`Bms::filter`] | 10 Hz, `sample_s` | filter, counter, health, cells, limits, balancing |
//! | [`Bms::slow`] | when there is time, some 23 times a second | one slice of state of power or energy left |
//!
//! All that the hardware does is in a [`Board`]. What vehicle and charger ask for comes by
//! [`Bms::request`]; what is known by [`Bms::report`]; what should survive a power cut by
//! [`Bms::record`], only when worth a write. Time is measured, not assumed: what was missed is bridged
//! or, after a sleep, aged.
//!
//! The estimators work in the units of one cell; the report is in those of the pack.
//!
//! It is ours. Tests: `tests` below; against a plant with faults, `voltstep bms`.

mod board;
mod description;
mod fast;
mod record;
mod report;
mod samples;
mod slow;
mod state;

pub use board::Board;
pub use description::{Alike, Balancing, BmsParams, Description};
pub use report::{Report, SocSource};
pub use state::{Asked, BmsState};

use plant_core::error::check;
use plant_core::{Dt, ParamError, Real};

use crate::balance::{Balancer, BalancerParams};
use crate::contactor::{ContactorControl, LinkTrend, LinkTrendParams, PrechargeWatch};
use crate::estimate::cells::{CellResistanceParams, CellResistances, Cells, CellsParams};
use crate::estimate::coulomb::{CoulombCounter, CoulombParams};
use crate::estimate::ekf::{Ekf, EkfParams, Uncertainty};
use crate::estimate::energy::{EnergyGauge, EnergyParams};
use crate::estimate::power::{HORIZONS_S, PowerLimits, PowerParams};
use crate::estimate::series::Series;
use crate::estimate::soh::{
    CapacityEstimator, CapacityParams, ResistanceEstimator, ResistanceParams,
};
use crate::limit::{Limiter, LimiterParams};
use crate::protect::Protection;

/// How many times what is declared of a sensor or a cell a limit keeps away. Chosen: 97.7 % of what is
/// normally distributed lies within two.
const MARGIN_SDS: Real = 2.0;
/// Steps that health is learnt from are remembered so many. Chosen: an hour of driving.
const MEMORY: Real = 500.0;
/// The smallest step of the current that resistances are learnt from, as a share of the capacity \[1/h\].
/// Chosen: its voltage is well above the noise of a cell's reading.
const LEAST_STEP_PER_H: Real = 0.17;

/// A battery management system for `CELLS` cells in series with `SENSORS` temperatures.
///
/// ```
/// use plant_core::presets::PANASONIC_NCR18650PF;
/// use voltstep_bms::limit::Request;
/// use voltstep_bms::manage::{Asked, Bms, BmsParams, Board, Description};
/// use voltstep_bms::contactor::{Coils, Feedback, Phase};
/// use voltstep_bms::protect::EXAMPLE;
/// use voltstep_bms::{Measurements, Reading, must};
///
/// // Take the figures of your own data sheets.
/// static PACK: Description =
///     must!(Description::new(BmsParams::typical(EXAMPLE, PANASONIC_NCR18650PF, 33.0)));
/// const BMS: Bms<14, 4> = must!(Bms::new(&PACK));
///
/// /// Contactors that do as they are told, a link that charges at once.
/// #[derive(Default)]
/// struct Bench {
///     coils: Coils,
///     us: u64,
/// }
///
/// impl Board<14, 4> for Bench {
///     fn uptime_us(&mut self) -> u64 {
///         self.us += 1000;
///         self.us
///     }
///     fn measure(&mut self, into: &mut Measurements<14, 4>) {
///         into.cell_v = [Reading::new(3.7); 14];
///         into.temperature_c = [Reading::new(25.0); 4];
///         into.current_a = Reading::new(0.0);
///         into.pack_v = Reading::new(51.8);
///         let on = self.coils.precharge || self.coils.plus;
///         into.link_v = Reading::new(if on { 51.8 } else { 0.0 });
///     }
///     fn feedback(&mut self) -> [Feedback; 3] {
///         let Coils { minus, precharge, plus } = self.coils;
///         [minus, precharge, plus].map(|on| if on { Feedback::Closed } else { Feedback::Open })
///     }
///     fn drive(&mut self, coils: Coils) -> bool {
///         self.coils = coils;
///         true
///     }
///     fn bleed(&mut self, _: &[bool; 14]) {}
/// }
///
/// let mut board = Bench::default();
/// let mut state = BMS.start(None, None, 25.0)?;
/// for ms in 1..=1000 {
///     let drive = if ms > 100 { Request::Drive } else { Request::Off };
///     BMS.request(&mut state, Asked { vehicle: drive, ..Asked::NOTHING });
///     BMS.tick(&mut state, &mut board);
/// }
/// let report = BMS.report(&state);
/// assert_eq!(report.phase, Phase::Closed);
/// assert!(report.limits.discharge.current_a > 0.0);
/// # Ok::<(), voltstep_bms::ParamError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Bms<const CELLS: usize, const SENSORS: usize> {
    of: &'static Description,
    protection: Protection<'static, CELLS, SENSORS>,
    contactors: ContactorControl,
    precharge: PrechargeWatch,
    trend: LinkTrend,
    series: Series<'static>,
    resistances: CellResistances,
    energy: EnergyGauge<'static>,
    power: PowerLimits<'static>,
    limiter: Limiter,
    balancer: Balancer,
    /// Ticks in which the precharge contactor must show closed.
    precharge_closes: u16,
}

impl<const CELLS: usize, const SENSORS: usize> Bms<CELLS, SENSORS> {
    /// Derives all parts from the description.
    ///
    /// # Errors
    /// [`ParamError::LengthsDiffer`] where it is one of another number of cells; what a part refuses,
    /// by the name of its field.
    pub const fn new(of: &'static Description) -> Result<Self, ParamError> {
        let p = of.params();
        let sheet = &p.sheet;
        let (cell, sensing) = (&sheet.cell, &sheet.sensing);
        let tick = check!(Dt::from_s(sheet.tick_s));
        let sample = check!(Dt::from_s(p.sample_s));
        let second = check!(Dt::from_s(1.0));
        let parallel = sheet.layout.parallel as Real;

        // What current and voltage are worth, of one cell.
        let voltage_sd_v = most(sensing.cell_v.noise_sd, sensing.cell_v.resolution);
        let offset_sd_a = p.current_offset_sd_a / parallel;
        let noise_sd_a = most(sensing.current_a.noise_sd, sensing.current_a.resolution) / parallel;
        let nominal_v = 0.5 * (cell.voltage.operating_min_v + cell.voltage.operating_max_v);
        let typical = EkfParams::typical(p.cell, nominal_v);
        let known = Uncertainty {
            open_circuit_sd_v: most(typical.uncertainty.open_circuit_sd_v, sensing.cell_v.error),
            capacity_sd: most(typical.uncertainty.capacity_sd, p.alike.capacity_sd),
            current_offset_sd_a: offset_sd_a,
            voltage_sd_v: most(typical.uncertainty.voltage_sd_v, voltage_sd_v),
            ..typical.uncertainty
        };
        let capacity_ah = p.cell.capacity_ah;
        let capacity_sd_ah = known.capacity_sd * capacity_ah;
        let least_step_a = most(LEAST_STEP_PER_H * capacity_ah, 4.0 * noise_sd_a);
        let filter = check!(Ekf::new(EkfParams { uncertainty: known, ..typical }, sample));
        let counter = check!(CoulombCounter::new(
            CoulombParams {
                capacity_ah,
                capacity_sd_ah,
                charge_efficiency: 1.0,
                offset_sd_a,
                gain_sd: p.current_gain_sd,
                largest_current_a: sensing.current_a.highest / parallel,
                open_circuit: p.cell.open_circuit,
                rest_voltage_sd_v: known.open_circuit_sd_v,
                rest_current_a: p.rest_current_a() / parallel,
                rest_s: p.rest_s,
            },
            sample
        ));
        let cells = check!(Cells::new(
            CellsParams {
                open_circuit: p.cell.open_circuit,
                noise_sd_v: voltage_sd_v,
                offset_sd_v: sensing.cell_v.error,
                resistance_sd_ohm: p.alike.resistance_sd * p.alike.resistance_ohm,
                capacity_sd: p.alike.capacity_sd,
                soc_sd: p.alike.soc_sd,
                drift_sd_per_day: p.alike.drift_sd_per_day,
                pack_soc_sd_max: 0.2,
                voltage_min_v: sensing.cell_v.lowest,
                voltage_max_v: sensing.cell_v.highest,
            },
            second
        ));
        let resistance = check!(ResistanceEstimator::new(
            ResistanceParams {
                voltage_sd_v,
                current_sd_a: noise_sd_a,
                least_step_a,
                memory_steps: MEMORY,
                initial_sd: 0.5,
                skew_s: p.skew_s,
            },
            of.battery(),
            sample
        ));
        let capacity = check!(CapacityEstimator::new(
            CapacityParams {
                nominal_ah: capacity_ah,
                nominal_sd_ah: most(capacity_sd_ah, 0.15 * capacity_ah),
                current_noise_sd_a: noise_sd_a,
                current_offset_sd_a: offset_sd_a,
                current_gain_sd: p.current_gain_sd,
                least_soc_change: 0.2,
                least_soc_change_sds: 10.0,
                memory_pairs: 50.0,
            },
            sample
        ));
        Ok(Self {
            of,
            protection: check!(Protection::new(of.table())),
            contactors: check!(ContactorControl::new(p.contactors, tick)),
            precharge: check!(PrechargeWatch::new(p.precharge, tick)),
            trend: check!(LinkTrend::new(
                LinkTrendParams { time_s: 0.1, noise_v: sensing.link_v.hysteresis() },
                tick
            )),
            series: Series {
                filter,
                counter,
                cells,
                resistance,
                capacity,
                per_second: p.per_second(),
                dt_s: p.sample_s,
            },
            resistances: check!(CellResistances::new(CellResistanceParams {
                resistance_ohm: p.alike.resistance_ohm,
                spread_sd: p.alike.resistance_sd,
                noise_sd_v: voltage_sd_v,
                least_step_a,
                memory_steps: MEMORY,
            })),
            energy: check!(EnergyGauge::new(
                EnergyParams {
                    empty_soc: p.empty_soc,
                    full_soc: 1.0,
                    empty_v: cell.voltage.operating_min_v,
                    least_a: p.rest_current_a() / parallel,
                },
                of.battery(),
                sample
            )),
            power: check!(PowerLimits::new(
                PowerParams {
                    voltage_min_v: cell.voltage.operating_min_v,
                    voltage_max_v: cell.voltage.operating_max_v,
                    soc_min: p.empty_soc,
                    soc_max: 1.0,
                    margin_sds: MARGIN_SDS,
                    horizons_s: HORIZONS_S,
                    discharge_window: cell.discharge_window,
                    charge_window: cell.charge_window,
                },
                of.battery()
            )),
            limiter: check!(Limiter::new(
                LimiterParams {
                    discharge_a: parallel * cell.discharge.ten_seconds_a,
                    charge_a: parallel * cell.charge.ten_seconds_a,
                    parallel: sheet.layout.parallel,
                    fall_per_s: 0.2,
                    rise_per_s: 0.05,
                    ending_s: 0.5 * p.contactors.shed_limit_s,
                    derated: 0.5,
                    charge_from_c: cell.charge_window.none_below_c,
                    temperature_error_k: sensing.temperature_c.error,
                },
                sample
            )),
            balancer: check!(Balancer::new(
                BalancerParams {
                    bleed_ohm: p.balancing.bleed_ohm,
                    capacity_ah: parallel * capacity_ah,
                    hysteresis: 0.005,
                    sds: 3.0,
                    hysteresis_v: most(0.01, 4.0 * sensing.cell_v.error),
                    least_v: cell.voltage.operating_min_v,
                    board_max_c: p.balancing.board_max_c,
                    channels: p.balancing.channels,
                    // A frame is a second; the last sample of its pause is undisturbed.
                    bleed_s: 1.0 - 2.0 * p.sample_s,
                    pause_s: 2.0 * p.sample_s,
                },
                sample
            )),
            precharge_closes: check!(p.precharge_closes()),
        })
    }

    /// The description that it was made from.
    #[must_use]
    pub const fn description(&self) -> &'static Description {
        self.of
    }
}

#[expect(clippy::cast_precision_loss, reason = "counts are small")]
const fn real(count: u32) -> Real {
    count as Real
}

/// The larger of two, in `const`.
const fn most(a: Real, b: Real) -> Real {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests;
