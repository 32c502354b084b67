//! Permanent-magnet synchronous machine in the frame of its rotor, saturation and saliency
//! included.
//!
//! It steps at any step size: currents and speed are solved together, and without a source the
//! stored energy never rises. Once the rotor turns by more than [`FINE_STEP_RAD`] (electrically) in
//! a step, steady currents and torques stay right, but what rings at the electrical frequency is
//! damped instead of followed, and the output says so (`coarse_step`): then drive it by currents,
//! as [`Foc`](crate::control::foc::Foc) does, rather than by voltages open loop.
//!
//! Not modelled: the magnets' temperature, and current displacement in the winding.
//!
//! ```
//! use plant_core::machine::pmsm::{Pmsm, PmsmInput, PmsmState};
//! use plant_core::machine::transform::Dq;
//! use plant_core::{Dt, must, presets};
//!
//! const MACHINE: Pmsm = must!(Pmsm::new(presets::PMSM_EPOWERTRAIN, must!(Dt::from_s(1e-4))));
//!
//! let mut state = PmsmState::default();
//! let voltage_v = Dq { d: 0.0, q: 50.0 };
//! let mut out = MACHINE.step(&mut state, PmsmInput::cold(voltage_v, 0.1));
//! for _ in 0..10_000 {
//!     out = MACHINE.step(&mut state, PmsmInput::cold(voltage_v, 0.1));
//! }
//! assert!((out.speed_rad_s - 193.0).abs() < 0.1 && (out.shaft_nm - 0.1).abs() < 1e-3);
//! ```
//! Tests: against its equations in double precision and without a source `pmsm/tests.rs`; order of
//! convergence, passivity, a measured map `tests/tests/pmsm.rs`; bad input `tests/tests/properties`.

use crate::error::{ParamError, check, not_negative, positive};
use crate::machine::flux::Flux;
use crate::machine::transform::Dq;
use crate::model::{Dt, impl_model};
use crate::num::{Accum, Real, sane, sound};
use crate::port::{Coast, Slip, project};

mod drive;
mod winding;

pub use drive::{DqCurrents, PmsmDrive, PmsmDriveOutput, PmsmLink};
pub use winding::{DqLaw, DqWinding};

/// The temperature at which resistances are given \[°C\].
pub const REFERENCE_C: Real = 25.0;
/// How much the resistance of copper grows per kelvin, from 25 °C (235 °C + T, IEC 60034-1).
pub const COPPER_PER_K: Real = 1.0 / (235.0 + REFERENCE_C);
/// The largest electrical angle per step at which transients are followed \[rad\].
pub const FINE_STEP_RAD: Real = 0.1;
/// Temperatures outside −100..300 °C are refused.
const WINDING_C: (Real, Real) = (-100.0, 300.0);
/// A resistance that grows faster would be negative at −100 °C.
const LARGEST_PER_K: Real = 0.007;

/// What is known about a permanent-magnet synchronous machine.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct PmsmParams {
    /// Flux linkage over the currents.
    pub flux: Flux,
    /// Resistance of one phase at 25 °C \[Ω\], above zero.
    pub resistance_ohm: Real,
    /// How much it grows per kelvin, 0..0.007: [`COPPER_PER_K`].
    pub resistance_per_k: Real,
    /// Pole pairs, 1 at least.
    pub pole_pairs: u16,
    /// Iron loss as a conductance across the induced voltage of each phase \[S\], ≥ 0: eddy
    /// currents. Hysteresis loss at constant flux is a part of `coulomb_nm`.
    pub iron_s: Real,
    /// Rotor inertia \[kg·m²\], above zero.
    pub inertia_kg_m2: Real,
    /// Viscous friction \[N·m·s/rad\], ≥ 0.
    pub viscous_nm_s_per_rad: Real,
    /// Coulomb friction \[N·m\], ≥ 0.
    pub coulomb_nm: Real,
}

/// A permanent-magnet synchronous machine, discretised for one step.
///
/// `v = R·i + dψ/dt + ω_e·J·ψ` with J a quarter turn, `T = 3/2·p·(ψ_d·i_q − ψ_q·i_d)`,
/// `ω_e = p·ω` \[EPowertrain2025, PMSM\], `J·dω/dt = T − T_fe − T_load − b·ω − T_c·sgn(ω)`,
/// `T_fe = 3/2·g·p²·|ψ|²·ω`. The iron takes its loss from the shaft rather than from the
/// terminals: the same power, without one more state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pmsm {
    winding: DqWinding,
    coast: Coast,
}

/// The state of a [`Pmsm`]; at rest by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PmsmState {
    /// Current of the d axis \[A\].
    pub d_a: Accum,
    /// Current of the q axis \[A\].
    pub q_a: Accum,
    /// Rotor speed \[rad/s\].
    pub speed_rad_s: Accum,
}

impl PmsmState {
    /// The winding current \[A\].
    #[inline]
    #[must_use]
    pub const fn current_a(&self) -> Dq {
        Dq { d: self.d_a.get(), q: self.q_a.get() }
    }
}

/// What drives a [`Pmsm`] with a free shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PmsmInput {
    /// Voltage at the terminals over the step, peak of a phase \[V\].
    pub voltage_v: Dq,
    /// Torque that the load takes from the shaft \[N·m\].
    pub load_nm: Real,
    /// Temperature of the winding \[°C\], −100..300.
    pub winding_c: Real,
}

impl PmsmInput {
    /// With the winding at 25 °C.
    #[must_use]
    pub const fn cold(voltage_v: Dq, load_nm: Real) -> Self {
        Self { voltage_v, load_nm, winding_c: REFERENCE_C }
    }
}

/// What drives a [`Pmsm`] on an imposed speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PmsmSpeedInput {
    /// Voltage at the terminals over the step, peak of a phase \[V\].
    pub voltage_v: Dq,
    /// Rotor speed at the end of the step \[rad/s\].
    pub speed_rad_s: Real,
    /// Temperature of the winding \[°C\], −100..300.
    pub winding_c: Real,
}

/// What one step of a [`Pmsm`] says. `electrical_w = copper_w + field_w + air_gap_w` and
/// `air_gap_w = iron_w + (shaft_nm + friction and inertia)·ω`, to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PmsmOutput {
    /// Winding current \[A\].
    pub current_a: Dq,
    /// Flux linkage \[Wb\].
    pub flux_wb: Dq,
    /// Rotor speed \[rad/s\].
    pub speed_rad_s: Real,
    /// Air-gap torque over the step \[N·m\].
    pub torque_nm: Real,
    /// Torque left at the shaft \[N·m\]: air gap less iron loss, friction and inertia.
    pub shaft_nm: Real,
    /// Power into the terminals \[W\].
    pub electrical_w: Real,
    /// Power that the air gap passes to the shaft \[W\].
    pub air_gap_w: Real,
    /// Power into the field \[W\], with what the step itself dissipates
    /// (`3/4·Δiᵀ·ℓ·Δi/h` with constant inductances).
    pub field_w: Real,
    /// Heat in the winding \[W\], never negative.
    pub copper_w: Real,
    /// Heat in the iron \[W\], never negative.
    pub iron_w: Real,
    /// Heat by viscous and Coulomb friction \[W\], never negative.
    pub friction_w: Real,
    /// The rotor turned by more than [`FINE_STEP_RAD`]: transients are damped, not followed.
    pub coarse_step: bool,
    /// The currents lie beyond the flux map, which goes on straight there.
    pub beyond_map: bool,
    /// An input, or what it would have led to, was not finite or absurd: the state is unchanged
    /// and no power flows.
    pub rejected: bool,
}

impl Pmsm {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: PmsmParams, dt: Dt) -> Result<Self, ParamError> {
        let inertia = check!(positive("pmsm.inertia_kg_m2", params.inertia_kg_m2));
        Ok(Self {
            winding: check!(DqWinding::new(&params, dt)),
            coast: Coast {
                inertia_per_h: inertia / dt.s(),
                viscous: check!(not_negative(
                    "pmsm.viscous_nm_s_per_rad",
                    params.viscous_nm_s_per_rad
                )),
                coulomb: check!(not_negative("pmsm.coulomb_nm", params.coulomb_nm)),
            },
        })
    }

    /// The electrical side, to join a chain.
    #[must_use]
    pub const fn winding(&self) -> &DqWinding {
        &self.winding
    }

    /// Rotor and friction, to join a chain.
    #[must_use]
    pub const fn coast(&self) -> Coast {
        self.coast
    }

    /// Advances by one step with a free shaft under a load torque.
    #[inline]
    pub fn step(&self, state: &mut PmsmState, input: PmsmInput) -> PmsmOutput {
        let (i, w) = (state.current_a(), state.speed_rad_s.get());
        let law = self.winding.law(i, w, input.winding_c);
        let free_a = i + law.increment_a(input.voltage_v, 0.0);
        let drag = law.iron_nm_s_per_rad + self.coast.viscous;
        let per_speed_a = law.admit(law.back_emf_v_s_per_rad);
        let (dw, slip) = project(
            w,
            law.torque_nm(free_a) - drag * w - input.load_nm,
            law.torque_nm(per_speed_a) + self.coast.inertia_per_h + drag,
            self.coast.coulomb,
        );
        let valid = sane(input.load_nm) && usable(input.voltage_v, input.winding_c);
        self.settle(state, &law, input.voltage_v, (dw, slip), valid)
    }

    /// Advances by one step while something else imposes the speed.
    #[inline]
    pub fn step_at_speed(&self, state: &mut PmsmState, input: PmsmSpeedInput) -> PmsmOutput {
        let w = state.speed_rad_s.get();
        let law = self.winding.law(state.current_a(), w, input.winding_c);
        let slip = if input.speed_rad_s > 0.0 {
            Slip::Forward
        } else if input.speed_rad_s < 0.0 {
            Slip::Backward
        } else {
            Slip::Stuck
        };
        let valid = sane(input.speed_rad_s) && usable(input.voltage_v, input.winding_c);
        self.settle(state, &law, input.voltage_v, (input.speed_rad_s - w, slip), valid)
    }

    #[inline]
    fn settle(
        &self,
        state: &mut PmsmState,
        law: &DqLaw,
        voltage_v: Dq,
        (dw, slip): (Real, Slip),
        valid: bool,
    ) -> PmsmOutput {
        let mut next = *state;
        let increment_a = law.increment_a(voltage_v, dw);
        next.d_a.add(increment_a.d);
        next.q_a.add(increment_a.q);
        match slip {
            Slip::Stuck => next.speed_rad_s = Accum::new(0.0),
            _ => next.speed_rad_s.add(dw),
        }
        let (current_a, speed_rad_s) = (next.current_a(), next.speed_rad_s.get());
        let torque_nm = law.torque_nm(current_a);
        let (iron_nm, viscous_nm) =
            (law.iron_nm_s_per_rad * speed_rad_s, self.coast.viscous * speed_rad_s);
        let friction_nm = viscous_nm + self.coast.coulomb * slip.sign();
        let point = self.winding.flux().at(current_a);
        let electrical_w = 1.5 * voltage_v.dot(current_a);
        let copper_w = 1.5 * law.resistance_ohm * current_a.dot(current_a);
        let out = PmsmOutput {
            current_a,
            flux_wb: point.flux_wb,
            speed_rad_s,
            torque_nm,
            shaft_nm: torque_nm - iron_nm - friction_nm - self.coast.inertia_per_h * dw,
            electrical_w,
            air_gap_w: torque_nm * speed_rad_s,
            field_w: 1.5 * current_a.dot(law.field_v(increment_a)),
            copper_w,
            iron_w: iron_nm * speed_rad_s,
            friction_w: (friction_nm * speed_rad_s).abs(),
            coarse_step: self.winding.is_coarse(speed_rad_s),
            beyond_map: point.beyond_map,
            rejected: false,
        };
        if valid && out.is_sound() {
            *state = next;
            out
        } else {
            PmsmOutput {
                current_a: state.current_a(),
                speed_rad_s: state.speed_rad_s.get(),
                rejected: true,
                ..PmsmOutput::default()
            }
        }
    }
}

impl PmsmOutput {
    /// Whether no number in it is absurd, or none at all.
    fn is_sound(&self) -> bool {
        let Self { current_a, flux_wb, speed_rad_s, torque_nm, shaft_nm, .. } = *self;
        let vectors = current_a.d.abs() + current_a.q.abs() + flux_wb.d.abs() + flux_wb.q.abs();
        let shaft = speed_rad_s.abs() + torque_nm.abs() + shaft_nm.abs();
        let flows = self.electrical_w.abs() + self.air_gap_w.abs() + self.field_w.abs();
        sound(vectors + shaft + flows + self.copper_w + self.iron_w + self.friction_w)
    }
}

/// Whether a voltage and a temperature can be worked with.
fn usable(voltage_v: Dq, winding_c: Real) -> bool {
    let (coldest, hottest) = WINDING_C;
    sane(voltage_v.d) && sane(voltage_v.q) && winding_c >= coldest && winding_c <= hottest
}

impl_model!(Pmsm, PmsmState, PmsmInput, PmsmOutput);

#[cfg(test)]
mod tests;
