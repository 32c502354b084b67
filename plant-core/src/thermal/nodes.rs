//! One lumped node, and two of which one lies within the other.

use super::Chain;
use crate::error::{ParamError, check, limit};
use crate::model::{Dt, impl_model};
use crate::num::{Accum, Real, sane};

/// Parameters of a lumped thermal node.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct ThermalNodeParams {
    /// Heat capacity C \[J/K\], above zero; infinity: the temperature stays as it is set.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub heat_capacity_j_per_k: Real,
    /// Thermal resistance R to the surroundings \[K/W\], above zero; infinity for none.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub ambient_k_per_w: Real,
}

impl ThermalNodeParams {
    /// The temperature stays as it is set.
    pub const FIXED: Self =
        Self { heat_capacity_j_per_k: Real::INFINITY, ambient_k_per_w: Real::INFINITY };
}

/// A lumped thermal node, `C·dT/dt = P − (T − T_ambient)/R`, discretised for one step.
///
/// ```
/// use plant_core::thermal::{ThermalNode, ThermalNodeInput, ThermalNodeParams, ThermalNodeState};
/// use plant_core::{Dt, must};
///
/// const INVERTER: ThermalNode = must!(ThermalNode::new(
///     ThermalNodeParams { heat_capacity_j_per_k: 1000.0, ambient_k_per_w: 0.05 },
///     must!(Dt::from_s(0.1)),
/// ));
///
/// let mut state = ThermalNodeState::at(25.0);
/// let mut out = INVERTER.step(&mut state, ThermalNodeInput { heat_w: 800.0, ambient_c: 25.0 });
/// for _ in 1..5000 {
///     out = INVERTER.step(&mut state, ThermalNodeInput { heat_w: 800.0, ambient_c: 25.0 });
/// }
/// assert!((out.temperature_c - 65.0).abs() < 0.01); // 800 W · 0.05 K/W above the surroundings
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalNode {
    chain: Chain<1>,
}

/// The state of a [`ThermalNode`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ThermalNodeState {
    /// Temperature \[°C\]; may be set between steps where it is measured.
    pub temperature_c: Accum,
}

impl ThermalNodeState {
    /// At a temperature \[°C\].
    #[must_use]
    pub const fn at(temperature_c: Real) -> Self {
        Self { temperature_c: Accum::new(temperature_c) }
    }
}

/// Input of a [`ThermalNode`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalNodeInput {
    /// Heat P that flows in \[W\].
    pub heat_w: Real,
    /// Temperature of the surroundings \[°C\].
    pub ambient_c: Real,
}

/// Output of one step of a [`ThermalNode`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ThermalNodeOutput {
    /// Temperature at the end of the step \[°C\].
    pub temperature_c: Real,
    /// Heat that went to the surroundings \[W\].
    pub cooling_w: Real,
    /// An input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

const fn conductance(field: &'static str, k_per_w: Real) -> Result<Real, ParamError> {
    Ok(1.0 / check!(limit(field, k_per_w)))
}

impl ThermalNode {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError::NotALimit`] names the field that is out of range.
    pub const fn new(params: ThermalNodeParams, dt: Dt) -> Result<Self, ParamError> {
        let capacity = check!(limit("thermal.heat_capacity_j_per_k", params.heat_capacity_j_per_k));
        let cooling = check!(conductance("thermal.ambient_k_per_w", params.ambient_k_per_w));
        Ok(Self { chain: Chain::new([capacity / dt.s()], [cooling], [0.0]) })
    }

    /// Advances by one step.
    #[inline]
    pub fn step(&self, state: &mut ThermalNodeState, input: ThermalNodeInput) -> ThermalNodeOutput {
        let before = [state.temperature_c.get()];
        let [increment_k] = self.chain.increments_k(&before, &[input.ambient_c], &[input.heat_w]);
        let rejected =
            !(sane(input.heat_w) && sane(input.ambient_c) && sane(before[0] + increment_k));
        if rejected {
            return ThermalNodeOutput { temperature_c: before[0], cooling_w: 0.0, rejected };
        }
        state.temperature_c.add(increment_k);
        let temperature_c = state.temperature_c.get();
        let ([cooling_w], _) = self.chain.flows_w(&[temperature_c], &[input.ambient_c]);
        ThermalNodeOutput { temperature_c, cooling_w, rejected }
    }

    /// Advances what it is above surroundings that stay as they are \[K\] by one step; what is absurd
    /// changes nothing.
    #[inline(always)]
    pub(crate) fn step_above(&self, above_k: &mut Accum, heat_w: Real) {
        let [increment_k] = self.chain.increments_k(&[above_k.get()], &[0.0], &[heat_w]);
        if sane(heat_w) && sane(above_k.get() + increment_k) {
            above_k.add(increment_k);
        }
    }
}

impl_model!(ThermalNode, ThermalNodeState, ThermalNodeInput, ThermalNodeOutput);

/// Parameters of two nodes, one within the other.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct ThermalPairParams {
    /// The inner node, as a winding; its own way to the surroundings is often none.
    pub inner: ThermalNodeParams,
    /// The outer node, as a housing.
    pub outer: ThermalNodeParams,
    /// Thermal resistance between both \[K/W\], above zero; infinity for none.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub between_k_per_w: Real,
}

/// Two lumped thermal nodes, as a winding within its housing, discretised for one step:
/// `C_i·dT_i/dt = P_i − (T_i − T_o)/R_b − (T_i − T_a)/R_i`, likewise for the outer one.
///
/// ```
/// use plant_core::thermal::{
///     ThermalNodeParams, ThermalPair, ThermalPairInput, ThermalPairParams, ThermalPairState,
/// };
/// use plant_core::{Dt, must};
///
/// const MACHINE: ThermalPair = must!(ThermalPair::new(
///     ThermalPairParams {
///         inner: ThermalNodeParams { heat_capacity_j_per_k: 3e3, ambient_k_per_w: f32::INFINITY },
///         outer: ThermalNodeParams { heat_capacity_j_per_k: 2e4, ambient_k_per_w: 0.02 },
///         between_k_per_w: 0.03,
///     },
///     must!(Dt::from_s(0.1)),
/// ));
///
/// let mut state = ThermalPairState::at(20.0);
/// let input = ThermalPairInput { inner_w: 1000.0, outer_w: 500.0, ambient_c: 20.0 };
/// for _ in 0..50_000 {
///     MACHINE.step(&mut state, input);
/// }
/// assert!((state.outer_c.get() - 50.0).abs() < 0.05); // 1500 W · 0.02 K/W
/// assert!((state.inner_c.get() - 80.0).abs() < 0.05); // 1000 W · 0.03 K/W above that
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalPair {
    chain: Chain<2>,
}

/// The state of a [`ThermalPair`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ThermalPairState {
    /// Temperature of the inner node \[°C\]; may be set between steps where it is measured.
    pub inner_c: Accum,
    /// Temperature of the outer node \[°C\], likewise.
    pub outer_c: Accum,
}

impl ThermalPairState {
    /// Both at a temperature \[°C\].
    #[must_use]
    pub const fn at(temperature_c: Real) -> Self {
        Self { inner_c: Accum::new(temperature_c), outer_c: Accum::new(temperature_c) }
    }
}

/// Input of a [`ThermalPair`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalPairInput {
    /// Heat that flows into the inner node \[W\].
    pub inner_w: Real,
    /// Heat that flows into the outer node \[W\].
    pub outer_w: Real,
    /// Temperature of the surroundings \[°C\].
    pub ambient_c: Real,
}

/// Output of one step of a [`ThermalPair`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ThermalPairOutput {
    /// Temperature of the inner node at the end of the step \[°C\].
    pub inner_c: Real,
    /// Temperature of the outer node at the end of the step \[°C\].
    pub outer_c: Real,
    /// Heat that went from the inner to the outer node \[W\].
    pub between_w: Real,
    /// Heat that went from both to the surroundings \[W\].
    pub cooling_w: Real,
    /// An input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

impl ThermalPair {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError::NotALimit`] names the first field that is out of range.
    pub const fn new(params: ThermalPairParams, dt: Dt) -> Result<Self, ParamError> {
        let (inner, outer) = (params.inner, params.outer);
        let capacities = [
            check!(limit("thermal.inner.heat_capacity_j_per_k", inner.heat_capacity_j_per_k))
                / dt.s(),
            check!(limit("thermal.outer.heat_capacity_j_per_k", outer.heat_capacity_j_per_k))
                / dt.s(),
        ];
        let cooling = [
            check!(conductance("thermal.inner.ambient_k_per_w", inner.ambient_k_per_w)),
            check!(conductance("thermal.outer.ambient_k_per_w", outer.ambient_k_per_w)),
        ];
        let between = check!(conductance("thermal.between_k_per_w", params.between_k_per_w));
        Ok(Self { chain: Chain::new(capacities, cooling, [between, 0.0]) })
    }

    /// Advances by one step.
    #[inline]
    pub fn step(&self, state: &mut ThermalPairState, input: ThermalPairInput) -> ThermalPairOutput {
        let before = [state.inner_c.get(), state.outer_c.get()];
        let heat_w = [input.inner_w, input.outer_w];
        let [inner_k, outer_k] = self.chain.increments_k(&before, &[input.ambient_c; 2], &heat_w);
        let rejected = !(sane(input.inner_w)
            && sane(input.outer_w)
            && sane(input.ambient_c)
            && sane(before[0] + inner_k)
            && sane(before[1] + outer_k));
        if !rejected {
            state.inner_c.add(inner_k);
            state.outer_c.add(outer_k);
        }
        let now = [state.inner_c.get(), state.outer_c.get()];
        let mut out = ThermalPairOutput {
            inner_c: now[0],
            outer_c: now[1],
            between_w: 0.0,
            cooling_w: 0.0,
            rejected,
        };
        if !rejected {
            let ([inner_w, outer_w], [between_w, _]) =
                self.chain.flows_w(&now, &[input.ambient_c; 2]);
            (out.between_w, out.cooling_w) = (between_w, inner_w + outer_w);
        }
        out
    }
}

impl_model!(ThermalPair, ThermalPairState, ThermalPairInput, ThermalPairOutput);
