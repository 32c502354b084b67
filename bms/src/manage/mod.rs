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
//! [`Bms::record`], only when worth a write; the feature `recorder` keeps what it was given. A [`Bus`] sends it over CAN and hears who asks. Time is measured, not assumed: what was missed is bridged
//! or, after a sleep, aged.
//!
//! The estimators work in the units of one cell; the report is in those of the pack.
//!
//! It is ours. Tests: `tests` below; against a plant with faults, `voltstep bms`.

mod board;
mod bus;
mod derive;
mod description;
mod fast;
mod record;
#[cfg(feature = "recorder")]
pub mod recorder;
mod report;
mod samples;
mod slow;
mod state;

pub use board::Board;
pub use bus::Bus;
pub use description::{Alike, Balancing, BmsParams, Description};
pub use report::{Report, SocSource};
pub use state::{Asked, BmsState};

use plant_core::error::check;
use plant_core::{Dt, ParamError};

use crate::balance::Balancer;
use crate::contactor::{ContactorControl, LinkTrend, PrechargeWatch};
use crate::estimate::cells::{CellResistances, Cells};
use crate::estimate::coulomb::CoulombCounter;
use crate::estimate::ekf::Ekf;
use crate::estimate::energy::EnergyGauge;
use crate::estimate::power::PowerLimits;
use crate::estimate::series::Series;
use crate::estimate::soh::{CapacityEstimator, ResistanceEstimator};
use crate::limit::Limiter;
use crate::protect::Protection;

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
/// for ms in 1..=60_000 {
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
        let (p, battery) = (of.params(), of.battery());
        let tick = check!(Dt::from_s(p.sheet.tick_s));
        let sample = check!(Dt::from_s(p.sample_s));
        let second = check!(Dt::from_s(1.0));
        Ok(Self {
            of,
            protection: check!(Protection::new(of.table())),
            contactors: check!(ContactorControl::new(p.contactors, tick)),
            precharge: check!(PrechargeWatch::new(p.precharge, tick)),
            trend: check!(LinkTrend::new(p.link_trend(), tick)),
            series: Series {
                filter: check!(Ekf::new(p.filter(), sample)),
                counter: check!(CoulombCounter::new(p.counter(), sample)),
                cells: check!(Cells::new(p.cells(), second)),
                resistance: check!(ResistanceEstimator::new(p.resistance(), battery, sample)),
                capacity: check!(CapacityEstimator::new(p.capacity(), sample)),
                per_second: p.per_second(),
                dt_s: p.sample_s,
            },
            resistances: check!(CellResistances::new(p.cell_resistances())),
            energy: check!(EnergyGauge::new(p.energy(), battery, sample)),
            power: check!(PowerLimits::new(p.power(), battery)),
            limiter: check!(Limiter::new(p.limiter(), sample)),
            balancer: check!(Balancer::new(p.balancer(), sample)),
            precharge_closes: check!(p.precharge_closes()),
        })
    }

    /// The description that it was made from.
    #[must_use]
    pub const fn description(&self) -> &'static Description {
        self.of
    }
}

#[cfg(test)]
mod tests;
