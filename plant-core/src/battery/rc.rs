//! One RC branch, the slow part of a battery's voltage: `C·dv/dt = I − v/R`.
//!
//! \[EPowertrain2025, eq. 3.9, sign corrected\].
//!
//! Tests: below; properties `finite`, `refusal`, `steady`; order of convergence in
//! `tests/tests/order.rs`; case "RC branch".

use crate::error::{ParamError, check, positive};
use crate::model::{Dt, impl_model};
use crate::num::{Accum, Real, lag_gain, sane};

/// Parameters of one RC branch of a battery.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct RcBranchParams {
    /// Polarisation resistance \[Ω\], above zero.
    pub resistance_ohm: Real,
    /// Polarisation capacitance \[F\], above zero.
    pub capacitance_f: Real,
}

/// One polarisation time constant of an equivalent-circuit battery, discretised for one step.
///
/// `C·dv/dt = I − v/R` \[EPowertrain2025, eq. 3.9, sign corrected\], taken implicitly in `v`:
/// `v += k·(R·I − v)` with `k = (h/τ)/(1 + h/τ)`, `τ = R·C`. Stable for every `h` and `τ`;
/// first order in `h`; the steady state `R·I` does not depend on `h`.
///
/// ```
/// use plant_core::battery::{RcBranch, RcBranchInput, RcBranchParams, RcBranchState};
/// use plant_core::{Dt, must};
///
/// const BRANCH: RcBranch = must!(RcBranch::new(
///     RcBranchParams { resistance_ohm: 0.01, capacitance_f: 1000.0 },
///     must!(Dt::from_s(0.01)),
/// ));
///
/// let mut state = RcBranchState::default();
/// for _ in 0..1000 {
///     BRANCH.step(&mut state, RcBranchInput { discharge_a: 100.0 });
/// }
/// // After one time constant 63 % of R·I = 1 V.
/// assert!((state.voltage_v.get() - 0.632).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RcBranch {
    pub(crate) resistance_ohm: Real,
    pub(crate) conductance_s: Real,
    pub(crate) capacitance_f: Real,
    pub(crate) capacitance_per_h_s: Real,
    k: Real,
}

/// The state of an [`RcBranch`]: the voltage across it \[V\]. The default is a rested battery.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RcBranchState {
    /// Voltage across the branch, positive when discharging.
    pub voltage_v: Accum,
}

/// Input of one step of an [`RcBranch`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RcBranchInput {
    /// Current \[A\], positive when discharging.
    pub discharge_a: Real,
}

/// Output of one step of an [`RcBranch`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RcBranchOutput {
    /// Voltage across the branch after the step \[V\].
    pub voltage_v: Real,
    /// Heat in the resistance \[W\], never negative.
    pub heat_w: Real,
    /// The input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

impl RcBranch {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError::NotPositive`] names the field that is out of range.
    pub const fn new(params: RcBranchParams, dt: Dt) -> Result<Self, ParamError> {
        let r = check!(positive("battery.polarisation.resistance_ohm", params.resistance_ohm));
        let c = check!(positive("battery.polarisation.capacitance_f", params.capacitance_f));
        // h/τ; 1e9 for the 1 mΩ · 1 µF branch at 1 s. Two divisions keep r·c from underflowing.
        let k = lag_gain(dt.s() / r / c);
        // k → 1 where the quotient overflows.
        let k = if k <= 1.0 { k } else { 1.0 };
        Ok(Self {
            resistance_ohm: r,
            conductance_s: 1.0 / r,
            capacitance_f: c,
            capacitance_per_h_s: c / dt.s(),
            k,
        })
    }

    /// The part of the branch that acts as a resistance within one step \[Ω\].
    #[inline]
    pub(crate) const fn implicit_ohm(&self) -> Real {
        self.k * self.resistance_ohm
    }

    /// The voltage after a step without current \[V\].
    #[inline]
    pub(crate) const fn offer_v(&self, state: &RcBranchState) -> Real {
        let v = state.voltage_v.get();
        v - self.k * v
    }

    /// The increment of the voltage under `discharge_a` \[V\].
    #[inline]
    pub(crate) const fn increment_v(&self, state: &RcBranchState, discharge_a: Real) -> Real {
        self.k * (self.resistance_ohm * discharge_a - state.voltage_v.get())
    }

    /// Advances by one step.
    #[inline]
    pub fn step(&self, state: &mut RcBranchState, input: RcBranchInput) -> RcBranchOutput {
        let increment_v = self.increment_v(state, input.discharge_a);
        let rejected = !(sane(input.discharge_a) && sane(state.voltage_v.get() + increment_v));
        if !rejected {
            state.voltage_v.add(increment_v);
        }
        let voltage_v = state.voltage_v.get();
        RcBranchOutput { voltage_v, heat_w: voltage_v * voltage_v * self.conductance_s, rejected }
    }
}

impl_model!(RcBranch, RcBranchState, RcBranchInput, RcBranchOutput);

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    const PARAMS: RcBranchParams = RcBranchParams { resistance_ohm: 0.02, capacitance_f: 1500.0 };
    const LOAD: RcBranchInput = RcBranchInput { discharge_a: 50.0 };

    fn branch(dt_s: Real) -> RcBranch {
        RcBranch::new(PARAMS, Dt::from_s(dt_s).unwrap()).unwrap()
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn follows_the_exponential_and_halves_its_error_with_the_step() {
        let (tau, end): (f64, f64) = (30.0, 60.0);
        let exact = 0.02 * 50.0 * (1.0 - (-end / tau).exp());
        let error = |dt: f64| {
            let (b, mut s) = (branch(dt as Real), RcBranchState::default());
            for _ in 0..(end / dt).round() as u32 {
                b.step(&mut s, LOAD);
            }
            (f64::from(s.voltage_v.get()) - exact).abs()
        };
        let order = (error(0.1) / error(0.05)).log2();
        assert!(error(0.1) < 1e-3 * exact && (0.95..1.05).contains(&order), "order {order}");
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn reaches_the_same_steady_state_at_any_step() {
        for (dt, steps) in [(1e-4, 3_000_000), (1.0, 600), (1e6, 2)] {
            let (b, mut s) = (branch(dt), RcBranchState::default());
            for _ in 0..steps {
                b.step(&mut s, LOAD);
            }
            assert!((s.voltage_v.get() - 1.0).abs() < 1e-4, "dt {dt}: {}", s.voltage_v.get());
        }
    }

    #[test]
    fn is_stable_for_a_microsecond_milliohm_branch_at_any_step() {
        let tiny = RcBranchParams { resistance_ohm: 1e-3, capacitance_f: 1e-6 };
        for dt_s in [1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e12] {
            let b = RcBranch::new(tiny, Dt::from_s(dt_s).unwrap()).unwrap();
            let mut s = RcBranchState::default();
            for _ in 0..100 {
                let v = b.step(&mut s, LOAD).voltage_v;
                assert!((0.0..=0.050_001).contains(&v), "dt {dt_s}: {v}");
            }
        }
    }

    #[test]
    fn heat_is_that_of_the_resistance_and_bad_input_changes_nothing() {
        let (b, mut s) = (branch(1.0), RcBranchState { voltage_v: Accum::new(0.5) });
        let before = s;
        let out = b.step(&mut s, RcBranchInput { discharge_a: Real::NAN });
        assert!(out.rejected && s == before);
        assert!((out.heat_w - 0.25 / 0.02).abs() < 1e-3);
        assert!(!b.step(&mut s, LOAD).rejected && s != before);
    }

    #[test]
    fn refuses_each_bad_field_by_name() {
        let dt = Dt::from_s(0.001).unwrap();
        for bad in [0.0, -1.0, Real::NAN, Real::INFINITY] {
            let r = RcBranch::new(RcBranchParams { resistance_ohm: bad, ..PARAMS }, dt);
            assert_eq!(r, Err(ParamError::NotPositive("battery.polarisation.resistance_ohm")));
            let c = RcBranch::new(RcBranchParams { capacitance_f: bad, ..PARAMS }, dt);
            assert_eq!(c, Err(ParamError::NotPositive("battery.polarisation.capacitance_f")));
            assert_eq!(Dt::from_s(bad), Err(ParamError::NotPositive("dt_s")));
        }
    }

    #[test]
    fn a_voltage_that_would_become_absurd_stays() {
        let params = RcBranchParams { resistance_ohm: 1e4, capacitance_f: 1e-6 };
        let branch = RcBranch::new(params, Dt::from_s(1.0).unwrap()).unwrap();
        let mut s = RcBranchState::default();
        assert!(branch.step(&mut s, RcBranchInput { discharge_a: 1e6 }).rejected);
        assert_eq!(s, RcBranchState::default());
    }
}
