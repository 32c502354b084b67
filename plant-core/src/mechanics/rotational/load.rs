//! A load on a shaft: inertia and friction, `J·dω/dt = T − f_s·ω − T_c·sgn(ω)`.
//!
//! \[EPowertrain2025, `RotLoad`\]; the Coulomb torque is ours.
//!
//! Tests: `tests` below; properties `finite`, `refusal`; order of convergence in
//! `tests/tests/order.rs`; cases "load on a shaft", "converter bench".

use crate::error::{ParamError, check, not_negative, positive};
use crate::model::{Dt, impl_model};
use crate::num::{Accum, Real, sane};
use crate::port::{Coast, DriveLaw, Slip, project};

/// Parameters of a load on a shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct RotationalLoadParams {
    /// Inertia \[kg·m²\], above zero.
    pub inertia_kg_m2: Real,
    /// Viscous friction \[N·m·s/rad\], ≥ 0.
    pub viscous_nm_s_per_rad: Real,
    /// Coulomb (static) friction \[N·m\], ≥ 0.
    pub coulomb_nm: Real,
}

/// A turning load, discretised for one step.
///
/// `J·dω/dt = T − f_s·ω − T_c·sgn(ω)` \[EPowertrain2025, `RotLoad`\], taken implicitly in ω; the
/// Coulomb torque is set-valued, so standstill is exact.
///
/// It steps on its own under a given torque, or closes a chain: [`solve`](Self::solve) takes what
/// a motor's or a gearbox's shaft offers and finds the one speed increment of everything on that
/// shaft; [`settle`](Self::settle) books it.
///
/// ```
/// use plant_core::mechanics::rotational::{
///     RotationalLoad, RotationalLoadInput, RotationalLoadParams, RotationalLoadState,
/// };
/// use plant_core::{Dt, must};
///
/// const FAN: RotationalLoad = must!(RotationalLoad::new(
///     RotationalLoadParams { inertia_kg_m2: 0.04, viscous_nm_s_per_rad: 0.0, coulomb_nm: 0.3 },
///     must!(Dt::from_s(0.01)),
/// ));
///
/// let mut state = RotationalLoadState::default();
/// assert_eq!(FAN.step(&mut state, RotationalLoadInput { torque_nm: 0.29 }).speed_rad_s, 0.0);
/// for _ in 0..100 {
///     FAN.step(&mut state, RotationalLoadInput { torque_nm: 1.3 });
/// }
/// assert!((state.speed_rad_s.get() - 25.0).abs() < 1e-3); // (T − T_c)·t/J after 1 s
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotationalLoad {
    coast: Coast,
}

/// The state of a [`RotationalLoad`]; at rest by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RotationalLoadState {
    /// Speed \[rad/s\].
    pub speed_rad_s: Accum,
}

/// Input of a [`RotationalLoad`] that steps on its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotationalLoadInput {
    /// Torque of the shaft on the load \[N·m\].
    pub torque_nm: Real,
}

/// Output of one step of a [`RotationalLoad`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RotationalLoadOutput {
    /// Speed \[rad/s\].
    pub speed_rad_s: Real,
    /// Torque that the load took from the shaft \[N·m\]: inertia and friction. At standstill
    /// the friction is as large as what it holds, and counts as zero here.
    pub shaft_nm: Real,
    /// Power that the load took from the shaft \[W\].
    pub shaft_w: Real,
    /// Heat by viscous and Coulomb friction \[W\], never negative.
    pub friction_w: Real,
    /// An input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

impl RotationalLoad {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: RotationalLoadParams, dt: Dt) -> Result<Self, ParamError> {
        let inertia_kg_m2 = check!(positive("load.inertia_kg_m2", params.inertia_kg_m2));
        let viscous =
            check!(not_negative("load.viscous_nm_s_per_rad", params.viscous_nm_s_per_rad));
        let coulomb = check!(not_negative("load.coulomb_nm", params.coulomb_nm));
        Ok(Self { coast: Coast { inertia_per_h: inertia_kg_m2 / dt.s(), viscous, coulomb } })
    }

    /// The speed increment over one step \[rad/s\] on a shaft that a machine drives with `law` and
    /// that carries `shaft` (rotor, gears, their friction) beside this load; and how friction ends
    /// it.
    ///
    /// A law that is not finite gives an increment that is not a number, which
    /// [`settle`](Self::settle) rejects.
    #[inline]
    #[must_use]
    pub const fn solve(
        &self,
        state: &RotationalLoadState,
        law: DriveLaw,
        shaft: Coast,
    ) -> (Real, Slip) {
        if !(sane(law.effort) && law.slope >= 0.0 && law.slope.is_finite()) {
            return (Real::NAN, Slip::Stuck);
        }
        let coast = self.coast.plus(shaft);
        let speed_rad_s = state.speed_rad_s.get();
        project(
            speed_rad_s,
            law.effort - coast.viscous * speed_rad_s,
            law.slope + coast.slope(),
            coast.coulomb,
        )
    }

    /// Books the speed increment that [`solve`](Self::solve) found.
    #[inline]
    pub const fn settle(
        &self,
        state: &mut RotationalLoadState,
        speed_increment_rad_s: Real,
        slip: Slip,
    ) -> RotationalLoadOutput {
        let rejected = !sane(state.speed_rad_s.get() + speed_increment_rad_s);
        let increment_rad_s = if rejected { 0.0 } else { speed_increment_rad_s };
        if !rejected {
            match slip {
                Slip::Stuck => state.speed_rad_s = Accum::new(0.0),
                _ => state.speed_rad_s.add(increment_rad_s),
            }
        }
        let speed_rad_s = state.speed_rad_s.get();
        let friction_nm = self.coast.viscous * speed_rad_s + self.coast.coulomb * slip.sign();
        let shaft_nm = self.coast.inertia_per_h * increment_rad_s + friction_nm;
        RotationalLoadOutput {
            speed_rad_s,
            shaft_nm,
            shaft_w: shaft_nm * speed_rad_s,
            friction_w: (friction_nm * speed_rad_s).abs(),
            rejected,
        }
    }

    /// Advances by one step under a given torque.
    #[inline]
    pub const fn step(
        &self,
        state: &mut RotationalLoadState,
        input: RotationalLoadInput,
    ) -> RotationalLoadOutput {
        let law = DriveLaw { effort: input.torque_nm, slope: 0.0 };
        let none = Coast { inertia_per_h: 0.0, viscous: 0.0, coulomb: 0.0 };
        let (increment_rad_s, slip) = self.solve(state, law, none);
        self.settle(state, increment_rad_s, slip)
    }
}

impl_model!(RotationalLoad, RotationalLoadState, RotationalLoadInput, RotationalLoadOutput);

#[cfg(test)]
mod tests;
