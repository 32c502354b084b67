//! What a step of the plant says, powers included.

use super::solve::{Solution, Start};
use super::{Powertrain, PowertrainState};
use crate::battery::{Losses, Pack};
use crate::mechanics::body::Road;
use crate::num::Real;
use crate::port::Slip;
use crate::powertrain::ledger::{Book, Flows};

/// What changed the duty, if anything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Limited {
    /// The duty is the commanded one; or the gates are off.
    #[default]
    No,
    /// The discharge limit, or what is left to discharge, held it back.
    Discharge,
    /// The charge limit, or what is left to charge, held it back.
    Charge,
    /// The commanded duty lay beyond the converter's limit.
    Duty,
    /// The converter's current limit held it back.
    Current,
}

/// Output of one step of a [`Powertrain`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PowertrainOutput {
    /// An input was not finite or absurd; the state is unchanged and nothing flowed.
    pub rejected: bool,
    /// The duty applied. With gates off the diodes': ±1 while they conduct, else 0.
    pub duty: Real,
    /// What changed it.
    pub limited: Limited,
    /// How far the battery's current is beyond its limits all the same \[A\], ≥ 0: while a winding's
    /// current decays, where the back-EMF exceeds what a duty can hold, or with gates off.
    pub limit_exceeded_a: Real,
    /// Charge of this step that went into a full battery, or, negative, out of an empty one, and
    /// is lost \[C\].
    pub overcharged_c: Real,
    /// Neither battery nor drive could feed the auxiliary loads: they were cut off.
    pub auxiliary_starved: bool,
    /// Whether and in which direction the vehicle moves.
    pub slip: Slip,
    /// Speed \[m/s\].
    pub speed_m_s: Real,
    /// Distance \[m\].
    pub distance_m: Real,
    /// Sine of the slope under the vehicle, as an inclinometer tells it.
    pub slope_sin: Real,
    /// State of charge, 0..1.
    pub soc: Real,
    /// Battery current \[A\], positive when discharging.
    pub battery_a: Real,
    /// Voltage at the battery's terminals \[V\].
    pub battery_v: Real,
    /// The battery's open-circuit voltage over the step \[V\].
    pub open_circuit_v: Real,
    /// The battery's state of charge or temperature lie outside what its parameters were
    /// identified for.
    pub battery_outside_identified: bool,
    /// Winding current \[A\].
    pub motor_a: Real,
    /// Air-gap torque of the motor \[N·m\].
    pub motor_nm: Real,
    /// Motor speed \[rad/s\].
    pub motor_rad_s: Real,
    /// The power of every term of the energy ledger \[W\].
    pub flows: Flows,
}

/// What a driver knows of the vehicle: the end of the last step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Feedback {
    /// Speed \[m/s\].
    pub speed_m_s: Real,
    /// Winding current \[A\].
    pub motor_a: Real,
    /// Voltage at the battery's terminals \[V\].
    pub battery_v: Real,
    /// State of charge, 0..1.
    pub soc: Real,
    /// The duty applied; counts only where it was `limited`.
    pub duty: Real,
    /// A limit changed the duty.
    pub limited: bool,
    /// Sine of the slope, for the start on a hill; 0, or not a number, where it is not known.
    pub slope_sin: Real,
}

impl From<&PowertrainOutput> for Feedback {
    #[inline]
    fn from(out: &PowertrainOutput) -> Self {
        Self {
            speed_m_s: out.speed_m_s,
            motor_a: out.motor_a,
            battery_v: out.battery_v,
            soc: out.soc,
            duty: out.duty,
            limited: out.limited != Limited::No,
            slope_sin: out.slope_sin,
        }
    }
}

impl<L: Book, B: Pack> Powertrain<L, B> {
    /// What each raw power of [`raw_flows`](Self::raw_flows) is to be multiplied by.
    #[inline(always)]
    pub(super) fn flow_factors(&self) -> Flows {
        let (series_joule, polarisation_joule) = self.battery.loss_factors();
        Flows {
            series_joule,
            polarisation_joule,
            copper: self.winding.resistance_ohm,
            conversion: self.winding.back_emf - self.winding.effort_per_a,
            viscous: self.coast.viscous,
            coulomb: self.coast.coulomb,
            gear: self.gear_loss_n_per_a,
            rolling: self.body.rolling_n,
            potential: self.body.weight_n,
            numerical: 0.5,
            ..Flows::ONES
        }
    }

    /// Each power from the definitions of its component, at the end of the step, so that the
    /// ledger checks the elimination and does not repeat it; without the constant factors.
    #[inline(always)]
    pub(super) fn raw_flows(
        &self,
        state: &PowertrainState<L, B::State>,
        road: &Road,
        start: &Start,
        solution: &Solution,
        open_circuit_v: Real,
        losses: Losses,
    ) -> Flows {
        let (i, v) = (state.current_a.get(), state.body.speed_m_s.get());
        let (di, dv) = (solution.current_increment_a, solution.motion.increment_m_s);
        let (battery_a, battery_v) = (solution.battery_a, solution.battery_v);
        let speed_m_s = v.abs();
        let electrochemical = open_circuit_v * battery_a;
        let loads = &start.loads;
        let (mut converter, mut auxiliary) = (0.0, 0.0);
        if loads.any {
            converter = (start.converter_ohm * i + solution.drop_v) * i
                + loads.converter_s * battery_v * battery_v;
            auxiliary = (loads.constant_a + loads.resistor_s * battery_v) * battery_v;
        }
        Flows {
            electrochemical,
            series_joule: losses.series,
            polarisation_joule: losses.polarisation,
            converter,
            auxiliary,
            copper: i * i,
            conversion: v * i,
            viscous: v * v,
            coulomb: speed_m_s,
            gear: start.current_a.abs() * speed_m_s,
            drag: start.resistance.drag_n_s_per_m * (v + road.headwind_m_s) * v,
            rolling: road.rolling_factor * road.grade.cos * speed_m_s,
            brake: road.brake_n * speed_m_s,
            potential: road.grade.sin * v,
            numerical: self.winding.inductance_per_h_ohm * di * di
                + self.coast.inertia_per_h * dv * dv
                + losses.numerical,
            throughput: electrochemical.abs(),
        }
    }

    /// What a refused step says: the state as it was, and nothing flowing.
    #[inline(always)]
    pub(super) fn rejected(
        &self,
        state: &PowertrainState<L, B::State>,
        open_circuit_v: Real,
    ) -> PowertrainOutput {
        let (i, v) = (state.current_a.get(), state.body.speed_m_s.get());
        PowertrainOutput {
            rejected: true,
            duty: 0.0,
            limited: Limited::No,
            limit_exceeded_a: 0.0,
            overcharged_c: 0.0,
            auxiliary_starved: false,
            slip: if v > 0.0 {
                Slip::Forward
            } else if v < 0.0 {
                Slip::Backward
            } else {
                Slip::Stuck
            },
            speed_m_s: v,
            distance_m: state.body.distance_m.get(),
            slope_sin: 0.0,
            soc: B::soc(&state.battery),
            battery_a: 0.0,
            battery_v: state.battery_v,
            open_circuit_v,
            battery_outside_identified: B::is_outside(&state.battery),
            motor_a: i,
            motor_nm: self.torque_nm_per_a * i,
            motor_rad_s: self.motor_rad_per_m * v,
            flows: Flows::default(),
        }
    }
}
