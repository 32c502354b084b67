//! Field-oriented control of a synchronous machine: torque to currents, currents to voltage.
//!
//! Each step finds the [reference](mod@reference) currents (least current for the torque, field
//! weakening on the voltage circle, limits of current and torque) and moves the measured currents
//! a share of the distance with a model of the winding, both axes decoupled. What the model lacks
//! is seen as a voltage by comparing the currents that it foresaw with those that came, and made
//! up for: the integral part of a PI controller with active damping \[Harnefors1998\],
//! which knows of the voltage limit and therefore never winds up.
//!
//! With an infinite bandwidth it is an ideal inner torque loop: the currents are there after one
//! step, wherever the voltage allows it. It is stable at any step and speed as long as its model is
//! that of the machine.
//!
//! ```
//! use plant_core::control::foc::{Foc, FocInput, FocParams, FocState};
//! use plant_core::machine::pmsm::{Pmsm, PmsmInput, PmsmState};
//! use plant_core::{Dt, must, presets};
//!
//! const DT: Dt = must!(Dt::from_s(1e-4));
//! const MACHINE: Pmsm = must!(Pmsm::new(presets::PMSM_EPOWERTRAIN, DT));
//! const FOC: Foc = must!(Foc::new(
//!     FocParams { bandwidth_rad_s: 1000.0, current_limit_a: 5.0, ..FocParams::DEFAULT },
//!     presets::PMSM_EPOWERTRAIN,
//!     DT,
//! ));
//!
//! let (mut foc, mut machine) = (FocState::default(), PmsmState::default());
//! let mut torque_nm = 0.0;
//! for _ in 0..100 {
//!     let input = FocInput {
//!         torque_nm: 0.5,
//!         current_a: machine.current_a(),
//!         speed_rad_s: machine.speed_rad_s.get(),
//!         bus_v: 300.0,
//!     };
//!     let voltage_v = FOC.step(&mut foc, input).voltage_v;
//!     torque_nm = MACHINE.step(&mut machine, PmsmInput::cold(voltage_v, 0.5)).torque_nm;
//! }
//! assert!((torque_nm - 0.5).abs() < 1e-3);
//! ```
//! Tests: closed forms `foc/reference/tests.rs`; with a machine, at wrong parameters and in
//! saturation `foc/tests.rs`; a measured map `tests/tests/pmsm.rs`.

use crate::error::{ParamError, check, efficiency, limit};
use crate::machine::pmsm::{DqWinding, PmsmParams, REFERENCE_C};
use crate::machine::transform::{Dq, LARGEST_PER_BUS};
use crate::model::{Dt, impl_model};
use crate::num::{LARGEST_PARAM, Real, lag_gain, max, sane, sound};

pub mod reference;

use reference::Torque;

/// What is known about a field-oriented controller.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct FocParams {
    /// Bandwidth of the current loop \[rad/s\], above zero; infinity: there after one step.
    pub bandwidth_rad_s: Real,
    /// Largest winding current, peak of a phase \[A\], above zero; infinity for none.
    pub current_limit_a: Real,
    /// Largest torque in either direction \[N·m\], above zero; infinity for none.
    pub torque_limit_nm: Real,
    /// The share of the largest voltage that steady currents may use, above 0 up to 1; the rest is
    /// for moving them.
    pub voltage_share: Real,
}

impl Default for FocParams {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl FocParams {
    /// The default, as a constant: an ideal inner loop without limits of its own.
    pub const DEFAULT: Self = Self {
        bandwidth_rad_s: Real::INFINITY,
        current_limit_a: Real::INFINITY,
        torque_limit_nm: Real::INFINITY,
        voltage_share: 0.95,
    };
}

/// A field-oriented controller, discretised for one step.
///
/// `v = R·i + ω_e·J·ψ + Z·k·(i* − i) + d`, `k = (h·α)/(1 + h·α)` with α the bandwidth and Z the
/// winding's impedance over a step ([`DqLaw`](crate::machine::pmsm::DqLaw)); shortened to the
/// voltage circle; `d += Z·k·(i_foreseen − i)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foc {
    winding: DqWinding,
    params: FocParams,
    gain: Real,
}

/// The state of a [`Foc`]; fresh by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FocState {
    /// The currents that it foresaw for now; none at the first step.
    foreseen_a: Option<Dq>,
    /// The voltage that its model lacks.
    lacking_v: Dq,
}

impl FocState {
    /// The voltage that the model lacks \[V\]: the integral part.
    #[must_use]
    pub const fn lacking_v(&self) -> Dq {
        self.lacking_v
    }
}

/// What drives a [`Foc`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FocInput {
    /// Air-gap torque that is asked for \[N·m\].
    pub torque_nm: Real,
    /// Winding current as measured \[A\].
    pub current_a: Dq,
    /// Rotor speed \[rad/s\].
    pub speed_rad_s: Real,
    /// Bus voltage \[V\].
    pub bus_v: Real,
}

/// What one step of a [`Foc`] says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[expect(clippy::struct_excessive_bools, reason = "independent flags")]
pub struct FocOutput {
    /// Voltage for the machine's terminals over the step \[V\], within the voltage circle.
    pub voltage_v: Dq,
    /// The currents that it aims at \[A\].
    pub reference_a: Dq,
    /// The torque that they make \[N·m\].
    pub torque_nm: Real,
    /// The field is weakened to stay within the voltage circle.
    pub weakened: bool,
    /// Less torque than asked for: a limit of torque, current or voltage acts.
    pub limited: bool,
    /// The voltage was shortened to the circle.
    pub saturated: bool,
    /// An input, or what it led to, was not finite or absurd; the state is unchanged and the
    /// voltage zero.
    pub rejected: bool,
}

impl Foc {
    /// Checks `params` and what is known about the machine, and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: FocParams, machine: PmsmParams, dt: Dt) -> Result<Self, ParamError> {
        let bandwidth = check!(limit("foc.bandwidth_rad_s", params.bandwidth_rad_s));
        check!(limit("foc.current_limit_a", params.current_limit_a));
        check!(limit("foc.torque_limit_nm", params.torque_limit_nm));
        check!(efficiency("foc.voltage_share", params.voltage_share));
        Ok(Self {
            winding: check!(DqWinding::new(&machine, dt)),
            params,
            gain: if bandwidth < LARGEST_PARAM { lag_gain(dt.s() * bandwidth) } else { 1.0 },
        })
    }

    /// Advances by one step.
    #[inline]
    pub fn step(&self, state: &mut FocState, input: FocInput) -> FocOutput {
        let FocInput { torque_nm, current_a, speed_rad_s, bus_v } = input;
        let law = self.winding.law(current_a, speed_rad_s, REFERENCE_C);
        let mut lacking_v = state.lacking_v;
        if let Some(foreseen_a) = state.foreseen_a {
            lacking_v = lacking_v + law.impede(foreseen_a - current_a) * self.gain;
        }
        let longest_v = LARGEST_PER_BUS * max(bus_v, 0.0);
        let reference = Torque {
            flux: self.winding.flux().near(current_a),
            pole_pairs: self.winding.pole_pairs(),
            resistance_ohm: law.resistance_ohm,
            current_limit_a: self.params.current_limit_a,
            torque_limit_nm: self.params.torque_limit_nm,
        }
        .currents(
            torque_nm,
            speed_rad_s,
            max(self.params.voltage_share * longest_v - lacking_v.length(), 0.0),
        );
        let step_a = (reference.current_a - current_a) * self.gain;
        let wanted_v = law.voltage_v(step_a) + lacking_v;
        let voltage_v = wanted_v.within(longest_v);
        let foreseen_a = current_a + law.increment_a(voltage_v - lacking_v, 0.0);
        let valid = sane(torque_nm)
            && sane(current_a.d)
            && sane(current_a.q)
            && sane(speed_rad_s)
            && sane(bus_v)
            && is_sound([wanted_v, voltage_v, foreseen_a, lacking_v, reference.current_a])
            && sane(reference.torque_nm);
        if !valid {
            return FocOutput { rejected: true, ..FocOutput::default() };
        }
        *state = FocState { foreseen_a: Some(foreseen_a), lacking_v };
        FocOutput {
            voltage_v,
            reference_a: reference.current_a,
            torque_nm: reference.torque_nm,
            weakened: reference.weakened,
            limited: reference.limited,
            saturated: voltage_v != wanted_v,
            rejected: false,
        }
    }
}

/// Whether no number in these is absurd, or none at all.
fn is_sound(vectors: [Dq; 5]) -> bool {
    let mut sum = 0.0;
    for v in vectors {
        sum += v.d.abs() + v.q.abs();
    }
    sound(sum)
}

impl_model!(Foc, FocState, FocInput, FocOutput);

#[cfg(test)]
mod tests;
