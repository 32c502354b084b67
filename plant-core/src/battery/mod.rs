//! Batteries: open-circuit voltage, series resistance, RC branches, state of charge.
//!
//! [`Battery`] has constant parameters and one RC branch; with discharge current positive
//! \[EPowertrain2025, eq. 3.6 to 3.9, errata applied\]:
//! `dSOC/dt = −I/(3600·Q)`, `C·dV_rc/dt = I − V_rc/R_p`, `V = V_oc(SOC) − R_s·I − V_rc`.
//!
//! [`MappedBattery`] has parameters over state of charge and temperature, a second branch,
//! hysteresis and a thermal node. [`SeriesPack`] is a row of these that are not alike. Each can sit in
//! the coupled plant, which asks of it what [`Pack`] says.
//!
//! Tests: `tests` below; properties `charge`, `finite`, `monotony`, `refusal`; order of convergence
//! in `tests/tests/order.rs`; case "battery".

mod cells;
mod limits;
mod map;
mod mapped;
mod open_circuit;
mod pack;
mod rc;
mod series_pack;

pub use limits::{CurrentLimits, VoltageLimits};
pub use map::{
    BranchMap, HysteresisParams, IdentifiedRange, MappedBatteryParams, OverSoc, REFERENCE_C,
    ResistanceMap, ThermalParams, temperature_factor,
};
pub use mapped::{
    MappedBattery, MappedBatteryInput, MappedBatteryOutput, MappedBatteryState, Resistances,
};
pub use open_circuit::OpenCircuit;
pub use pack::{Losses, Pack};
pub use rc::{RcBranch, RcBranchInput, RcBranchOutput, RcBranchParams, RcBranchState};
pub use series_pack::{
    CellSpread, SeriesPack, SeriesPackInput, SeriesPackOutput, SeriesPackParams, SeriesPackState,
};

use crate::error::{ParamError, check, limit, positive, ratio};
use crate::model::{Dt, impl_model};
use crate::num::{Accum, LARGEST, Real, clamp, max, min, sane};
use crate::port::Source;
use limits::Ends;

/// A battery within this of 0 or 1 counts as depleted or full.
pub const SOC_MARGIN: Real = 1e-6;

/// Parameters of a battery (a cell, or a pack as one).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct BatteryParams {
    /// Open-circuit voltage over the state of charge.
    pub open_circuit: OpenCircuit,
    /// Charge between SOC 0 and 1 \[A·h\], above zero.
    pub capacity_ah: Real,
    /// Series resistance \[Ω\], above zero.
    pub series_resistance_ohm: Real,
    /// The RC branch.
    pub polarisation: RcBranchParams,
    /// Largest discharge current \[A\], above zero; infinity for none.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub discharge_limit_a: Real,
    /// Largest charge current \[A\], above zero; infinity for none.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub charge_limit_a: Real,
    /// Lowest and highest voltage at the terminals; any by default.
    #[cfg_attr(feature = "serde", serde(default))]
    pub voltage_limits: VoltageLimits,
}

/// A battery, discretised for one step.
///
/// The open-circuit voltage is taken at the old SOC, the rest implicitly, so within one step the
/// battery is a [`Source`].
///
/// ```
/// use plant_core::battery::{
///     Battery, BatteryInput, BatteryParams, BatteryState, OpenCircuit, RcBranchParams,
///     VoltageLimits,
/// };
/// use plant_core::{Dt, ParamError, must};
///
/// const CELL: Battery = must!(Battery::new(
///     BatteryParams {
///         open_circuit: OpenCircuit::Linear { empty_v: 3.0, full_v: 4.2 },
///         capacity_ah: 2.0,
///         series_resistance_ohm: 0.03,
///         polarisation: RcBranchParams { resistance_ohm: 0.02, capacitance_f: 1000.0 },
///         discharge_limit_a: 10.0,
///         charge_limit_a: 2.0,
///         voltage_limits: VoltageLimits { lowest_v: 2.5, highest_v: 4.2 },
///     },
///     must!(Dt::from_s(1.0)),
/// ));
///
/// let mut state = BatteryState::rested(1.0)?;
/// let mut out = CELL.step(&mut state, BatteryInput { current_a: 2.0 });
/// for _ in 1..1800 {
///     out = CELL.step(&mut state, BatteryInput { current_a: 2.0 });
/// }
/// assert!((out.soc - 0.5).abs() < 1e-5); // half an hour at 1C
/// assert!((out.open_circuit_v - out.terminal_v - 2.0 * 0.05).abs() < 1e-4);
/// # Ok::<(), ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Battery {
    pub(crate) open_circuit: OpenCircuit,
    pub(crate) rc: RcBranch,
    pub(crate) series_resistance_ohm: Real,
    source_resistance_ohm: Real,
    soc_per_a: Real,
    a_per_soc: Real,
    capacity_c: Real,
    discharge_limit_a: Real,
    charge_limit_a: Real,
    ends: Ends,
    may_collapse: bool,
}

/// The state of a [`Battery`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BatteryState {
    /// State of charge, 0..1. May be set from an estimate; what lies outside is held at the end.
    pub soc: Accum,
    /// The RC branch.
    pub rc: RcBranchState,
}

impl BatteryState {
    /// A rested battery at `soc`.
    ///
    /// # Errors
    /// [`ParamError::NotARatio`] outside 0..1.
    pub const fn rested(soc: Real) -> Result<Self, ParamError> {
        let soc = check!(ratio("soc", soc));
        Ok(Self { soc: Accum::new(soc), rc: RcBranchState { voltage_v: Accum::new(0.0) } })
    }
}

/// Input of a [`Battery`] that steps on its own: the current imposed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BatteryInput {
    /// Current \[A\], positive when discharging.
    pub current_a: Real,
}

/// Output of one step of a [`Battery`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BatteryOutput {
    /// State of charge, 0..1.
    pub soc: Real,
    /// Voltage at the terminals \[V\].
    pub terminal_v: Real,
    /// Open-circuit voltage over the step \[V\].
    pub open_circuit_v: Real,
    /// The current that flowed \[A\], positive when discharging.
    pub current_a: Real,
    /// Charge of this step that the limits or the state of charge refused \[C\]; positive where
    /// discharge was refused, negative where charge was.
    pub refused_charge_c: Real,
    /// Heat in both resistances \[W\], never negative.
    pub heat_w: Real,
    /// Energy stored above SOC 0, at the open-circuit voltage, and in the RC branch \[J\].
    pub stored_energy_j: Real,
    /// Nothing is left to discharge.
    pub depleted: bool,
    /// Nothing more can be charged.
    pub full: bool,
    /// The input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

impl Battery {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: BatteryParams, dt: Dt) -> Result<Self, ParamError> {
        let rc = check!(RcBranch::new(params.polarisation, dt));
        let capacity_c = 3600.0 * check!(positive("battery.capacity_ah", params.capacity_ah));
        let series_resistance_ohm =
            check!(positive("battery.series_resistance_ohm", params.series_resistance_ohm));
        // No limit still keeps absurd currents out.
        let limits = CurrentLimits {
            discharge_a: check!(limit("battery.discharge_limit_a", params.discharge_limit_a)),
            charge_a: check!(limit("battery.charge_limit_a", params.charge_limit_a)),
        };
        let limits = limits.within(CurrentLimits { discharge_a: LARGEST, charge_a: LARGEST });
        let open_circuit = check!(params.open_circuit.checked());
        let source_resistance_ohm = series_resistance_ohm + rc.implicit_ohm();
        Ok(Self {
            // At half of the voltage; a polarised battery has less. Without a limit nothing is held.
            may_collapse: limits.discharge_a < LARGEST
                && limits.discharge_a * source_resistance_ohm > 0.4 * open_circuit.lowest_v(),
            open_circuit,
            series_resistance_ohm,
            source_resistance_ohm,
            rc,
            soc_per_a: dt.s() / capacity_c,
            a_per_soc: capacity_c / dt.s(),
            capacity_c,
            discharge_limit_a: limits.discharge_a,
            charge_limit_a: limits.charge_a,
            ends: Ends::new(capacity_c, limits, check!(params.voltage_limits.checked()), dt),
        })
    }

    /// What the terminals offer over the next step, and the open-circuit voltage in it \[V\].
    #[inline]
    #[must_use]
    pub fn offer(&self, state: &BatteryState) -> (Source, Real) {
        let open_circuit_v = self.open_circuit.at(state.soc.get());
        let emf_v = open_circuit_v - self.rc.offer_v(&state.rc);
        (Source { emf_v, resistance_ohm: self.source_resistance_ohm }, open_circuit_v)
    }

    /// The currents that the battery allows over the next step.
    #[inline]
    #[must_use]
    pub fn limits(&self, state: &BatteryState) -> CurrentLimits {
        let soc = state.soc.get();
        let limits = CurrentLimits {
            discharge_a: min(self.discharge_limit_a, max(soc, 0.0) * self.a_per_soc),
            charge_a: min(self.charge_limit_a, max(1.0 - soc, 0.0) * self.a_per_soc),
        };
        if self.ends.cut_off() {
            limits.within(self.at_voltages(soc, self.rc.offer_v(&state.rc)))
        } else {
            limits
        }
    }

    /// What the voltages leave where the branch holds `held_v` without current.
    #[cold]
    #[inline(never)]
    fn at_voltages(&self, soc: Real, held_v: Real) -> CurrentLimits {
        let emf_v = self.open_circuit.at(soc) - held_v;
        self.ends.at_voltages(Source { emf_v, resistance_ohm: self.source_resistance_ohm })
    }

    /// The state after one step under `current_a`, whatever the limits say.
    #[inline]
    #[must_use]
    pub const fn next(&self, state: &BatteryState, current_a: Real) -> BatteryState {
        let mut next = *state;
        next.rc.voltage_v.add(self.rc.increment_v(&state.rc, current_a));
        next.soc.add(-(current_a * self.soc_per_a));
        next
    }

    /// The same, as a coupled plant keeps them: towards full, and towards empty, they fade with the
    /// charge that is left to go, over 0.1 s.
    #[inline]
    #[must_use]
    pub fn faded(&self, state: &BatteryState) -> CurrentLimits {
        let soc = state.soc.get();
        // What one step could take of the charge is never less than what fades.
        let limits = self.ends.faded(soc).within(CurrentLimits {
            discharge_a: self.discharge_limit_a,
            charge_a: self.charge_limit_a,
        });
        if self.ends.cut_off() {
            limits.within(self.at_voltages(soc, self.rc.offer_v(&state.rc)))
        } else {
            limits
        }
    }

    /// Whether a step under `current_a`, and under `least_a` once the windings have settled, that
    /// leads to `next` keeps every limit, as [`faded`](Self::faded) gives them, clear of the ends of
    /// charge.
    #[inline]
    #[must_use]
    pub fn allows(&self, current_a: Real, least_a: Real, next: &BatteryState) -> bool {
        let (soc, rc_v) = (next.soc.get(), next.rc.voltage_v.get());
        current_a <= self.discharge_limit_a
            && least_a >= -self.charge_limit_a
            && (self.ends.are_far(soc) || self.ends_allow(current_a, least_a, soc, rc_v))
    }

    /// Numbers and not a state: to hand that over would have every step keep it in memory.
    #[cold]
    #[inline(never)]
    fn ends_allow(&self, current_a: Real, least_a: Real, next_soc: Real, rc_v: Real) -> bool {
        if self.ends.are_near(next_soc) {
            return false;
        }
        let soc = next_soc + current_a * self.soc_per_a;
        let mut limits = self.ends.faded(soc);
        if self.ends.cut_off() {
            let held_v = rc_v - self.rc.implicit_ohm() * current_a;
            limits = limits.within(self.at_voltages(soc, held_v));
        }
        current_a <= limits.discharge_a && -least_a <= limits.charge_a
    }

    /// Books one step under `current_a`, which [`limits`](Self::limits) allow. Returns what was
    /// charged beyond full all the same, or, negative, drawn beyond empty \[C\]: it is lost.
    // A call, though rare, would keep the state out of registers in every step of the plant.
    #[inline(always)]
    pub const fn settle(&self, state: &mut BatteryState, current_a: Real) -> Real {
        *state = self.next(state, current_a);
        let reached = state.soc;
        state.soc.clamp(0.0, 1.0);
        self.capacity_c * reached.since(state.soc)
    }

    /// Energy stored above SOC 0 at the open-circuit voltage, and in the RC branch \[J\].
    #[must_use]
    pub fn stored_energy_j(&self, state: &BatteryState) -> Real {
        let rc_v = state.rc.voltage_v.get();
        let soc = state.soc.get();
        self.capacity_c * soc * self.open_circuit.mean(0.0, soc)
            + 0.5 * self.rc.capacitance_f * rc_v * rc_v
    }

    /// The drop of the electrochemical energy between two states \[J\], precise where they are
    /// close.
    #[must_use]
    pub fn discharged_energy_j(&self, from: &BatteryState, to: &BatteryState) -> Real {
        let mean_v = self.open_circuit.mean(from.soc.get(), to.soc.get());
        self.capacity_c * mean_v * from.soc.since(to.soc)
    }

    /// Whether `soc` is as good as 0.
    #[inline]
    #[must_use]
    pub const fn is_depleted(state: &BatteryState) -> bool {
        state.soc.get() <= SOC_MARGIN
    }

    /// Whether `soc` is as good as 1.
    #[inline]
    #[must_use]
    pub const fn is_full(state: &BatteryState) -> bool {
        state.soc.get() >= 1.0 - SOC_MARGIN
    }

    /// Advances by one step under an imposed current. What the limits or the state of charge do
    /// not allow is refused and reported.
    #[inline]
    pub fn step(&self, state: &mut BatteryState, input: BatteryInput) -> BatteryOutput {
        let (source, open_circuit_v) = self.offer(state);
        let limits = self.limits(state);
        let mut wanted_a = input.current_a;
        let mut current_a = clamp(wanted_a, -limits.charge_a, limits.discharge_a);
        let mut next = *state;
        self.settle(&mut next, current_a);
        let rejected = !(sane(wanted_a) && sane(next.rc.voltage_v.get()));
        if rejected {
            (wanted_a, current_a) = (0.0, 0.0);
        } else {
            *state = next;
        }
        let rc_v = state.rc.voltage_v.get();
        BatteryOutput {
            soc: state.soc.get(),
            terminal_v: source.voltage_v(current_a),
            open_circuit_v,
            current_a,
            refused_charge_c: (wanted_a - current_a) * self.soc_per_a * self.capacity_c,
            heat_w: self.series_resistance_ohm * current_a * current_a
                + rc_v * rc_v * self.rc.conductance_s,
            stored_energy_j: self.stored_energy_j(state),
            depleted: Self::is_depleted(state),
            full: Self::is_full(state),
            rejected,
        }
    }
}

impl_model!(Battery, BatteryState, BatteryInput, BatteryOutput);

#[cfg(test)]
mod tests;
