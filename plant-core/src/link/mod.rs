//! Between battery and vehicle: main contactors, precharge resistor, link capacitor, fuse.
//!
//! - [`Contactor`]: moves a lag after its coil, bounces, may be welded or stuck open
//! - [`Link`]: `C·dv/dt = i − i_load − v/R_bleed` behind them, fed by
//!   `i = (emf − v)/(R_battery + R_path)`, taken implicitly: stable at any step
//! - the fuse: `∫(i² − i_rated²) dt`, never below zero, against its melting integral
//! - [`Insulation`]: leakage from either pole to the chassis, and a switched bridge that measures it
//!
//! With `v` of the end of the step both in the current and at the capacitor, the charge that leaves the
//! battery is to rounding what load, bleeder and capacitor take up.
//!
//! It is ours. Tests: `tests` below; cases "precharge of the link", "contactor", "insulation to the chassis"; with a BMS, `voltstep
//! bms`.

mod contactor;
mod insulation;

pub use contactor::{
    Contactor, ContactorFault, ContactorInput, ContactorOutput, ContactorParams, ContactorState,
};
pub use insulation::{
    Insulation, InsulationInput, InsulationOutput, InsulationParams, InsulationState,
};

use crate::error::{ParamError, check, limit, positive};
use crate::model::{Dt, impl_model};
use crate::num::{Accum, LARGEST, Real, max, min, sane};
use crate::port::Source;

/// Parameters of a [`Link`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct LinkParams {
    /// Capacitance \[F\], above zero.
    pub capacitance_f: Real,
    /// What discharges it when all is open \[Ω\], above zero; infinity for none.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub bleeder_ohm: Real,
    /// The precharge resistor \[Ω\], above zero.
    pub precharge_ohm: Real,
    /// Both closed main contactors, fuse and cables \[Ω\], above zero.
    pub contact_ohm: Real,
    /// What the fuse carries for ever \[A\], above zero; infinity for none.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub fuse_rated_a: Real,
    /// What melts it beyond that \[A²·s\], above zero.
    pub fuse_melting_a2s: Real,
}

/// Contactors in front of a link capacitor, discretised for one step.
///
/// ```
/// use plant_core::link::{Link, LinkInput, LinkParams, LinkState};
/// use plant_core::port::Source;
/// use plant_core::{Dt, must};
///
/// const LINK: Link = must!(Link::new(
///     LinkParams {
///         capacitance_f: 0.00096,
///         bleeder_ohm: f32::INFINITY,
///         precharge_ohm: 40.0,
///         contact_ohm: 0.001,
///         fuse_rated_a: 300.0,
///         fuse_melting_a2s: 1e5,
///     },
///     must!(Dt::from_s(0.0001)),
/// ));
///
/// let mut state = LinkState::charged_to(121.0);
/// let input = LinkInput {
///     source: Source { emf_v: 355.0, resistance_ohm: 0.1 },
///     minus: true,
///     precharge: true,
///     plus: false,
///     load_a: 0.0,
///     short_ohm: f32::INFINITY,
/// };
/// for _ in 0..2100 {
///     LINK.step(&mut state, input);
/// }
/// // After 0.21 s, ln(234) time constants of 38.4 ms, a volt is missing.
/// assert!((state.voltage_v.get() - 354.0).abs() < 0.05);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    params: LinkParams,
    /// h/C.
    v_per_a: Real,
    bleeder_s: Real,
    dt_s: Real,
}

/// The state of a [`Link`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LinkState {
    /// Voltage of the capacitor \[V\].
    pub voltage_v: Accum,
    /// What the fuse has taken beyond its rating \[A²·s\].
    pub fuse_a2s: Real,
    /// It has melted.
    pub fuse_blown: bool,
}

impl LinkState {
    /// A capacitor at a voltage \[V\], a new fuse.
    #[must_use]
    pub const fn charged_to(voltage_v: Real) -> Self {
        Self { voltage_v: Accum::new(voltage_v), fuse_a2s: 0.0, fuse_blown: false }
    }
}

/// Input of one step of a [`Link`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkInput {
    /// What the battery offers over this step.
    pub source: Source,
    /// The main contactor at the negative pole conducts.
    pub minus: bool,
    /// The precharge contactor conducts.
    pub precharge: bool,
    /// The main contactor at the positive pole conducts.
    pub plus: bool,
    /// What converter and loads draw \[A\]; negative feeds back. An empty capacitor gives nothing.
    pub load_a: Real,
    /// A short across the link \[Ω\], above zero; infinity for none.
    pub short_ohm: Real,
}

/// Output of one step of a [`Link`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LinkOutput {
    /// Current out of the battery \[A\].
    pub battery_a: Real,
    /// Voltage of the link \[V\].
    pub voltage_v: Real,
    /// What the load got \[A\].
    pub load_a: Real,
    /// What bleeder and short took \[A\].
    pub leak_a: Real,
    /// Power in the precharge resistor \[W\].
    pub precharge_w: Real,
    /// The fuse has melted.
    pub fuse_blown: bool,
    /// An input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

impl Link {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: LinkParams, dt: Dt) -> Result<Self, ParamError> {
        let capacitance_f = check!(positive("link.capacitance_f", params.capacitance_f));
        let bleeder_ohm = check!(limit("link.bleeder_ohm", params.bleeder_ohm));
        check!(positive("link.precharge_ohm", params.precharge_ohm));
        check!(positive("link.contact_ohm", params.contact_ohm));
        check!(limit("link.fuse_rated_a", params.fuse_rated_a));
        check!(positive("link.fuse_melting_a2s", params.fuse_melting_a2s));
        Ok(Self {
            params,
            v_per_a: dt.s() / capacitance_f,
            bleeder_s: 1.0 / bleeder_ohm,
            dt_s: dt.s(),
        })
    }

    /// Conductance from the battery to the link \[S\], and the precharge resistor's share of the
    /// voltage across it.
    fn path(&self, state: &LinkState, input: &LinkInput) -> (Real, Real) {
        let p = &self.params;
        let closed = input.minus && (input.plus || input.precharge) && !state.fuse_blown;
        if !closed {
            return (0.0, 0.0);
        }
        let resistor_ohm = if input.plus { 0.0 } else { p.precharge_ohm };
        let all_ohm = input.source.resistance_ohm + p.contact_ohm + resistor_ohm;
        (1.0 / all_ohm, resistor_ohm / all_ohm)
    }

    /// Advances by one step.
    pub fn step(&self, state: &mut LinkState, input: LinkInput) -> LinkOutput {
        let before_v = state.voltage_v.get();
        let (path_s, resistor_share) = self.path(state, &input);
        let short_s = 1.0 / input.short_ohm;
        let leak_s = self.bleeder_s + short_s;
        let across_before_v = input.source.emf_v - before_v;
        let most_a = before_v / self.v_per_a + path_s * input.source.emf_v;
        // What would drain the capacitor below zero is not there.
        let load_a = min(input.load_a, max(0.0, most_a));
        let rise_v = self.v_per_a * (path_s * across_before_v - load_a - leak_s * before_v)
            / (1.0 + self.v_per_a * (path_s + leak_s));
        let after_v = before_v + rise_v;
        // By differences, which lose no digits where both voltages are nearly the same.
        let across_v = across_before_v - rise_v;
        let battery_a = path_s * across_v;
        let resistor_v = resistor_share * across_v;
        let sound = sane(after_v) && sane(battery_a) && sane(input.load_a) && leak_s >= 0.0;
        if !sound {
            return LinkOutput {
                battery_a: 0.0,
                voltage_v: before_v,
                load_a: 0.0,
                leak_a: 0.0,
                precharge_w: 0.0,
                fuse_blown: state.fuse_blown,
                rejected: true,
            };
        }
        state.voltage_v.add(rise_v);
        let rated_a = self.params.fuse_rated_a;
        let over_a2 = min(battery_a * battery_a - rated_a * rated_a, LARGEST);
        state.fuse_a2s = min(max(0.0, state.fuse_a2s + over_a2 * self.dt_s), LARGEST);
        state.fuse_blown |= state.fuse_a2s >= self.params.fuse_melting_a2s;
        LinkOutput {
            battery_a,
            voltage_v: after_v,
            load_a,
            leak_a: leak_s * after_v,
            precharge_w: resistor_v * battery_a,
            fuse_blown: state.fuse_blown,
            rejected: false,
        }
    }
}

impl_model!(Link, LinkState, LinkInput, LinkOutput);

#[cfg(test)]
mod tests;
