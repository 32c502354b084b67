//! What a step of the plant says, powers included.

use super::drives::Drives;
use super::solve::{Loads, Walk};
use super::{Powertrain, PowertrainState};
use crate::battery::{Losses, Pack};
use crate::machine::dc::DcDriveOutput;
use crate::machine::{Footing, MachineFlows, Seen, Temperatures};
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
    /// The converter's current limit, or what a temperature leaves of it, held it back.
    Current,
}

/// Output of one step of a [`Powertrain`]; `O` is what its drives say.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PowertrainOutput<O = DcDriveOutput> {
    /// An input was not finite or absurd; the state is unchanged and nothing flowed.
    pub rejected: bool,
    /// What changed a command.
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
    /// The drives.
    pub drives: O,
    /// The power of every term of the energy ledger \[W\].
    pub flows: Flows,
}

/// What a driver knows of the vehicle: the end of the last step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Feedback {
    /// Speed \[m/s\].
    pub speed_m_s: Real,
    /// Winding current \[A\] of the first motor, of three phases its length.
    pub motor_a: Real,
    /// Torque of the motor, or of all as felt at the shaft of the first \[N·m\].
    pub motor_nm: Real,
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
            motor_a: out.drives.motor_a,
            motor_nm: out.drives.motor_nm,
            battery_v: out.battery_v,
            soc: out.soc,
            duty: out.drives.duty,
            limited: out.limited != Limited::No,
            slope_sin: out.slope_sin,
        }
    }
}

impl<L: Book, B: Pack, D: Drives> Powertrain<L, B, D> {
    /// What each raw power of [`raw_flows`](Self::raw_flows) is to be multiplied by.
    #[inline(always)]
    pub(super) fn flow_factors(&self) -> Flows {
        let (series_joule, polarisation_joule) = self.battery.loss_factors();
        let machines = self.drives.flow_factors();
        Flows {
            series_joule,
            polarisation_joule,
            copper: machines.copper,
            conversion: machines.conversion,
            viscous: self.coast.viscous,
            coulomb: self.coast.coulomb,
            rolling: self.body.rolling_n,
            potential: self.body.weight_n,
            numerical: 0.5,
            ..Flows::ONES
        }
    }

    /// Each power from the definitions of its component, at the end of the step, so that the
    /// ledger checks the elimination and does not repeat it; without the constant factors.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "one step's values")]
    pub(super) fn raw_flows(
        &self,
        v: Real,
        road: &Road,
        loads: &Loads,
        walk: &Walk<D::Link>,
        machines: MachineFlows,
        gear_n: Real,
        drag_n_s_per_m: Real,
        open_circuit_v: Real,
        losses: Losses,
    ) -> Flows {
        let dv = walk.motion.increment_m_s;
        let (battery_a, battery_v) = (walk.battery_a, walk.battery_v);
        let speed_m_s = v.abs();
        let electrochemical = open_circuit_v * battery_a;
        let (mut converter, mut auxiliary) = (machines.converter, 0.0);
        if loads.any {
            converter += loads.converter_s * battery_v * battery_v;
            auxiliary = (loads.constant_a + loads.resistor_s * battery_v) * battery_v;
        }
        Flows {
            electrochemical,
            series_joule: losses.series,
            polarisation_joule: losses.polarisation,
            converter,
            auxiliary,
            copper: machines.copper,
            conversion: machines.conversion,
            iron: machines.iron,
            field: machines.field,
            viscous: v * v,
            coulomb: speed_m_s,
            gear: gear_n * speed_m_s,
            drag: drag_n_s_per_m * (v + road.headwind_m_s) * v,
            rolling: road.rolling_factor * road.grade.cos * speed_m_s,
            brake: road.brake_n * speed_m_s,
            potential: road.grade.sin * v,
            numerical: machines.numerical + self.coast.inertia_per_h * dv * dv + losses.numerical,
            throughput: electrochemical.abs(),
        }
    }

    /// What a refused step says: the state as it was, and nothing flowing.
    #[inline(always)]
    pub(super) fn rejected(
        &self,
        state: &PowertrainState<L, B::State, D::State>,
        open_circuit_v: Real,
    ) -> PowertrainOutput<D::Output> {
        let v = state.body.speed_m_s.get();
        PowertrainOutput {
            rejected: true,
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
            drives: self.idle(state),
            flows: Flows::default(),
        }
    }

    /// What the drives say where nothing is commanded.
    fn idle(&self, state: &PowertrainState<L, B::State, D::State>) -> D::Output {
        let speed_m_s = state.body.speed_m_s.get();
        let footing = Footing { speed_m_s, mobility: 0.0 };
        let (bus_v, from_v) = (state.battery_v, state.battery_v);
        let seen = Seen { bus_v, from_v, speed_m_s, footing };
        let (_, link) = self.drives.law(&state.drives, D::Command::default(), seen);
        self.drives.output(&state.drives, &link, speed_m_s)
    }

    /// What a driver sees of a step.
    #[inline(always)]
    #[must_use]
    pub fn seen_of(&self, out: &PowertrainOutput<D::Output>) -> Feedback {
        let (duty, motor_a) = D::duty_and_current(&out.drives);
        Feedback {
            speed_m_s: out.speed_m_s,
            motor_a,
            motor_nm: self.drives.torque_nm(&out.drives),
            battery_v: out.battery_v,
            soc: out.soc,
            duty,
            limited: out.limited != Limited::No,
            slope_sin: out.slope_sin,
        }
    }

    /// How warm the drives of a state are, those that have temperatures; of several the warmest parts.
    #[must_use]
    pub fn temperatures(
        &self,
        state: &PowertrainState<L, B::State, D::State>,
    ) -> Option<Temperatures> {
        D::temperatures(&self.idle(state))
    }

    /// What a driver sees of a state before its first step.
    #[must_use]
    pub fn feedback(&self, state: &PowertrainState<L, B::State, D::State>) -> Feedback {
        self.seen_of(&self.rejected(state, 0.0))
    }
}
