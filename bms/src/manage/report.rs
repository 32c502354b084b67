//! What is known, in one struct.

use plant_core::Real;

use super::{Bms, BmsState};
use crate::Health;
use crate::contactor::{Cause, Phase};
use crate::estimate::cells::SocSpread;
use crate::estimate::ekf::EkfStatus;
use crate::estimate::energy::EnergyReport;
use crate::limit::{Limits, Mode};
use crate::measure::Spread;
use crate::protect::Verdict;

/// Where a state of charge comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SocSource {
    /// From current and voltage, by the filter.
    Filter,
    /// From counting alone: it knows better, or the filter contradicts itself.
    Counter,
}

/// What a pack's BMS knows. Charge, energy and currents are those of the pack.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Report {
    /// State of charge, 0..1.
    pub soc: Real,
    /// Its standard deviation.
    pub soc_sd: Real,
    /// Where it comes from.
    pub soc_from: SocSource,
    /// What the filter thinks of itself.
    pub status: EkfStatus,
    /// States of charge of the cells.
    pub cells: SocSpread,
    /// Capacity of the pack \[A·h\].
    pub capacity_ah: Real,
    /// Health of the mean cell.
    pub health: Health,
    /// Energy and time left of the pack; nothing in the first second.
    pub energy: Option<EnergyReport>,
    /// What may be drawn and fed, and why not more.
    pub limits: Limits,
    /// Voltages of the cells \[V\], where any is usable.
    pub cell_v: Option<Spread>,
    /// Temperatures \[°C\], likewise.
    pub temperature_c: Option<Spread>,
    /// Current, positive when discharging \[A\]; NaN where it is not known.
    pub current_a: Real,
    /// Voltage of the pack \[V\]; NaN where it is not known.
    pub pack_v: Real,
    /// Voltage behind the contactors \[V\]; NaN where it is not known.
    pub link_v: Real,
    /// What is done of what is asked for.
    pub mode: Mode,
    /// Where the contactors are.
    pub phase: Phase,
    /// Why they opened, or may not close.
    pub cause: Cause,
    /// What the rows say.
    pub verdict: Verdict,
    /// Charge that went through the pack over its life \[A·h\].
    pub throughput_ah: Real,
}

impl<const CELLS: usize, const SENSORS: usize> Bms<CELLS, SENSORS> {
    /// What is known now.
    #[must_use]
    pub fn report(&self, state: &BmsState<CELLS, SENSORS>) -> Report {
        let (soc, soc_sd, soc_from) = self.charge(state);
        let sheet = &self.of.params().sheet;
        let (sensing, parallel) = (&sheet.sensing, Real::from(sheet.layout.parallel));
        let oldest_s = |sensor: &crate::protect::Sensor| sensor.oldest_s(sheet.tick_s);
        let [current_a, pack_v, link_v] = self.usable(state);
        Report {
            soc,
            soc_sd,
            soc_from,
            status: self.series.filter.status(&state.series.filter),
            cells: state.series.cells.spread(),
            capacity_ah: state.series.health.capacity_ah * parallel,
            health: state.series.health,
            energy: state.energy_left.map(|of_cell| self.of_pack(&of_cell)),
            limits: state.limits,
            cell_v: state.now.cell_spread(oldest_s(&sensing.cell_v)),
            temperature_c: state.now.temperature_spread(oldest_s(&sensing.temperature_c)),
            current_a,
            pack_v,
            link_v,
            mode: state.mode,
            phase: state.contactors.phase(),
            cause: state.contactors.cause(),
            verdict: state.verdict,
            throughput_ah: state.throughput_ah.get(),
        }
    }

    /// State of charge, its standard deviation, and where it comes from.
    pub(super) fn charge(&self, state: &BmsState<CELLS, SENSORS>) -> (Real, Real, SocSource) {
        let filter = self.series.filter.estimate(&state.series.filter);
        let (counter, counted) = (&self.series.counter, &state.series.counter);
        let counted_sd = counter.soc_sd(counted);
        if counted_sd < filter.soc_sd || state.contradicts {
            (counter.soc(counted), counted_sd, SocSource::Counter)
        } else {
            (filter.soc, filter.soc_sd, SocSource::Filter)
        }
    }

    /// What is left in the pack: of each group its parallel cells, of all groups the energy.
    fn of_pack(&self, of_cell: &EnergyReport) -> EnergyReport {
        let layout = &self.of.params().sheet.layout;
        let parallel = Real::from(layout.parallel);
        let cells = parallel * Real::from(layout.series);
        EnergyReport {
            remaining_capacity_ah: parallel * of_cell.remaining_capacity_ah,
            remaining_energy_wh: cells * of_cell.remaining_energy_wh,
            full_charge_capacity_ah: parallel * of_cell.full_charge_capacity_ah,
            full_charge_energy_wh: cells * of_cell.full_charge_energy_wh,
            remaining_energy_sd_wh: cells * of_cell.remaining_energy_sd_wh,
            ..*of_cell
        }
    }
}
