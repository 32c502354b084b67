//! How the parameters of each part follow from the description, in the units of one cell where the
//! part works in them. What is chosen and not derived stands here, each with its reason.

use plant_core::Real;

use super::BmsParams;
use crate::balance::BalancerParams;
use crate::contactor::LinkTrendParams;
use crate::estimate::cells::{CellResistanceParams, CellsParams};
use crate::estimate::coulomb::CoulombParams;
use crate::estimate::ekf::{EkfParams, Uncertainty};
use crate::estimate::energy::EnergyParams;
use crate::estimate::power::{HORIZONS_S, PowerParams};
use crate::estimate::soh::{CapacityParams, ResistanceParams};
use crate::limit::LimiterParams;
use crate::protect::Sensor;

/// How many standard deviations the limits keep away. Chosen: 97.7 % of what is normally distributed
/// lies within two.
const MARGIN_SDS: Real = 2.0;
/// Steps that resistances are learnt from are remembered so many. Chosen: an hour of driving.
const MEMORY_STEPS: Real = 500.0;
/// Pairs of rests that the capacity is learnt from, likewise. Chosen: some weeks.
const MEMORY_PAIRS: Real = 50.0;
/// The smallest step of the current that resistances are learnt from, as a share of the capacity
/// \[1/h\]. Chosen: its voltage is well above the noise of a cell's reading.
const LEAST_STEP_PER_H: Real = 0.17;
/// A capacity is learnt from rests this far apart, as a state of charge. Chosen: what 10 mV of the
/// curve leave open is a twentieth of it.
const LEAST_SOC_CHANGE: Real = 0.2;
/// Whether the link rises or falls is seen over this time \[s\]. Chosen: a link with a bleeder falls
/// by more than its noise in it.
const TREND_S: Real = 0.1;

impl BmsParams {
    const fn parallel(&self) -> Real {
        self.sheet.layout.parallel as Real
    }

    /// Noise of a cell's voltage \[V\] and of its share of the current \[A\], the resolution included.
    const fn noise(&self) -> (Real, Real) {
        let sensing = &self.sheet.sensing;
        (noise(&sensing.cell_v), noise(&sensing.current_a) / self.parallel())
    }

    const fn least_step_a(&self) -> Real {
        let (_, current_sd_a) = self.noise();
        most(LEAST_STEP_PER_H * self.cell.capacity_ah, 4.0 * current_sd_a)
    }

    /// Below this current the pack rests \[A\]: what offset and noise of the sensor let be told from
    /// none, or C/100.
    pub(super) const fn rest_current_a(&self) -> Real {
        let c100_a = 0.01 * self.parallel() * self.cell.capacity_ah;
        most(2.0 * self.current_offset_sd_a, c100_a)
    }

    pub(super) const fn link_trend(&self) -> LinkTrendParams {
        LinkTrendParams { time_s: TREND_S, noise_v: self.sheet.sensing.link_v.hysteresis() }
    }

    pub(super) const fn filter(&self) -> EkfParams {
        let (voltage, sensor) = (&self.sheet.cell.voltage, &self.sheet.sensing.cell_v);
        let nominal_v = 0.5 * (voltage.operating_min_v + voltage.operating_max_v);
        let typical = EkfParams::typical(self.cell, nominal_v);
        let (voltage_sd_v, _) = self.noise();
        let known = &typical.uncertainty;
        let uncertainty = Uncertainty {
            open_circuit_sd_v: most(known.open_circuit_sd_v, sensor.error),
            capacity_sd: most(known.capacity_sd, self.alike.capacity_sd),
            current_offset_sd_a: self.current_offset_sd_a / self.parallel(),
            voltage_sd_v: most(known.voltage_sd_v, voltage_sd_v),
            ..*known
        };
        EkfParams { uncertainty, ..typical }
    }

    pub(super) const fn counter(&self) -> CoulombParams {
        let Uncertainty { capacity_sd, current_offset_sd_a, open_circuit_sd_v, .. } =
            self.filter().uncertainty;
        CoulombParams {
            capacity_ah: self.cell.capacity_ah,
            capacity_sd_ah: capacity_sd * self.cell.capacity_ah,
            charge_efficiency: 1.0,
            offset_sd_a: current_offset_sd_a,
            gain_sd: self.current_gain_sd,
            largest_current_a: self.sheet.sensing.current_a.highest / self.parallel(),
            open_circuit: self.cell.open_circuit,
            rest_voltage_sd_v: open_circuit_sd_v,
            rest_current_a: self.rest_current_a() / self.parallel(),
            rest_s: self.rest_s,
        }
    }

    pub(super) const fn cells(&self) -> CellsParams {
        let (sensor, alike) = (&self.sheet.sensing.cell_v, &self.alike);
        CellsParams {
            open_circuit: self.cell.open_circuit,
            noise_sd_v: noise(sensor),
            offset_sd_v: sensor.error,
            resistance_sd_ohm: alike.resistance_sd * alike.resistance_ohm,
            capacity_sd: alike.capacity_sd,
            soc_sd: alike.soc_sd,
            drift_sd_per_day: alike.drift_sd_per_day,
            // Beyond, nobody knows where on the curve the cells are.
            pack_soc_sd_max: 0.2,
            voltage_min_v: sensor.lowest,
            voltage_max_v: sensor.highest,
        }
    }

    pub(super) const fn resistance(&self) -> ResistanceParams {
        let (voltage_sd_v, current_sd_a) = self.noise();
        ResistanceParams {
            voltage_sd_v,
            current_sd_a,
            least_step_a: self.least_step_a(),
            memory_steps: MEMORY_STEPS,
            // A battery may be anything between new and worn out.
            initial_sd: 0.5,
            skew_s: self.skew_s,
        }
    }

    pub(super) const fn capacity(&self) -> CapacityParams {
        let (_, current_sd_a) = self.noise();
        let capacity_ah = self.cell.capacity_ah;
        CapacityParams {
            nominal_ah: capacity_ah,
            // Likewise.
            nominal_sd_ah: most(self.alike.capacity_sd, 0.15) * capacity_ah,
            current_noise_sd_a: current_sd_a,
            current_offset_sd_a: self.current_offset_sd_a / self.parallel(),
            current_gain_sd: self.current_gain_sd,
            least_soc_change: LEAST_SOC_CHANGE,
            least_soc_change_sds: 10.0,
            memory_pairs: MEMORY_PAIRS,
        }
    }

    pub(super) const fn cell_resistances(&self) -> CellResistanceParams {
        CellResistanceParams {
            resistance_ohm: self.alike.resistance_ohm,
            spread_sd: self.alike.resistance_sd,
            noise_sd_v: noise(&self.sheet.sensing.cell_v),
            least_step_a: self.least_step_a(),
            memory_steps: MEMORY_STEPS,
        }
    }

    pub(super) const fn energy(&self) -> EnergyParams {
        EnergyParams {
            empty_soc: self.empty_soc,
            full_soc: 1.0,
            empty_v: self.sheet.cell.voltage.operating_min_v,
            least_a: self.rest_current_a() / self.parallel(),
        }
    }

    pub(super) const fn power(&self) -> PowerParams {
        let cell = &self.sheet.cell;
        PowerParams {
            voltage_min_v: cell.voltage.operating_min_v,
            voltage_max_v: cell.voltage.operating_max_v,
            soc_min: self.empty_soc,
            soc_max: 1.0,
            margin_sds: MARGIN_SDS,
            horizons_s: HORIZONS_S,
            discharge_window: cell.discharge_window,
            charge_window: cell.charge_window,
        }
    }

    pub(super) const fn limiter(&self) -> LimiterParams {
        let cell = &self.sheet.cell;
        LimiterParams {
            discharge_a: self.parallel() * cell.discharge.ten_seconds_a,
            charge_a: self.parallel() * cell.charge.ten_seconds_a,
            parallel: self.sheet.layout.parallel,
            // What a driver can follow.
            fall_per_s: 0.2,
            rise_per_s: 0.05,
            ending_s: 0.5 * self.contactors.shed_limit_s,
            derated: 0.5,
            charge_from_c: cell.charge_window.none_below_c,
            temperature_error_k: self.sheet.sensing.temperature_c.error,
        }
    }

    pub(super) const fn balancer(&self) -> BalancerParams {
        BalancerParams {
            bleed_ohm: self.balancing.bleed_ohm,
            capacity_ah: self.parallel() * self.cell.capacity_ah,
            hysteresis: 0.005,
            sds: 3.0,
            hysteresis_v: most(0.01, 4.0 * self.sheet.sensing.cell_v.error),
            least_v: self.sheet.cell.voltage.operating_min_v,
            board_max_c: self.balancing.board_max_c,
            channels: self.balancing.channels,
            // A frame is a second; the last sample of its pause is undisturbed.
            bleed_s: 1.0 - 2.0 * self.sample_s,
            pause_s: 2.0 * self.sample_s,
        }
    }
}

/// Standard deviation of one value, at least a step.
const fn noise(sensor: &Sensor) -> Real {
    most(sensor.noise_sd, sensor.resolution)
}

/// The larger of two, in `const`.
const fn most(a: Real, b: Real) -> Real {
    if a > b { a } else { b }
}
