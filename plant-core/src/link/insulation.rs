//! Leakage to the chassis, and how a device on board measures it.

use crate::error::{ParamError, check, positive};
use crate::model::{Dt, impl_model};
use crate::num::{Real, max, min, sane};

/// A measured resistance is given up to so many times that of the bridge: beyond, the difference of two
/// voltages is lost in them. Chosen.
const FARTHEST: Real = 50.0;

/// Parameters of an [`Insulation`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct InsulationParams {
    /// Capacitors between both poles and the chassis, together \[F\], above zero.
    pub y_capacitance_f: Real,
    /// The voltmeter's resistance from each pole to the chassis \[Ω\], above zero.
    pub bridge_ohm: Real,
    /// What is switched from one pole to the chassis \[Ω\], above zero.
    pub switched_ohm: Real,
    /// So long voltages settle before each reading \[s\], above zero: some five times half the bridge's
    /// resistance times the capacitance.
    pub settle_s: Real,
}

impl InsulationParams {
    /// Of a pack of 50 V. Chosen: a reading every 4 s.
    pub const USUAL: Self =
        Self { y_capacitance_f: 1e-6, bridge_ohm: 5e5, switched_ohm: 5e4, settle_s: 2.0 };
}

/// A pack that floats above its chassis: a leakage resistance from each pole, capacitors, and a bridge
/// that measures the smaller of the two.
///
/// ```text
/// C·dv/dt = (V − v)/R_plus − v/R_minus      v: of the chassis above the minus pole
/// R = R_0·(V/v' − V/v)
/// ```
///
/// with the bridge's resistors in parallel to the leakages, `v` the larger of the voltages from either pole
/// to the chassis, `v'` the same once `R_0` is switched in parallel to it \[`UnR100`, annex 5A\]: that is the
/// leakage of the other pole, the smaller one. What the bridge itself conducts is taken off. Voltages are
/// taken relative to the pack's at the same time, so that a load between both readings does no harm.
///
/// ```
/// use plant_core::link::{Insulation, InsulationInput, InsulationParams, InsulationState};
/// use plant_core::{Dt, must};
///
/// const INSULATION: Insulation =
///     must!(Insulation::new(InsulationParams::USUAL, must!(Dt::from_s(0.01))));
///
/// let mut state = InsulationState::default();
/// let input = InsulationInput { pack_v: 52.0, plus_ohm: 20e3, minus_ohm: 1e6 };
/// let measured = (0..500).filter_map(|_| INSULATION.step(&mut state, input).measured_ohm).next();
/// assert!(measured.is_some_and(|ohm| (ohm / 20e3 - 1.0).abs() < 0.01));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Insulation {
    params: InsulationParams,
    /// h/C.
    v_per_a: Real,
    bridge_s: Real,
    dt_s: Real,
}

/// What the bridge is at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
enum Switch {
    /// Nothing is switched in.
    #[default]
    Open,
    /// The resistor lies between plus pole and chassis.
    Plus,
    /// … minus pole and chassis.
    Minus,
}

/// The state of an [`Insulation`]; the default has its chassis at the minus pole, and nothing measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct InsulationState {
    /// The chassis above the minus pole \[V\].
    pub chassis_v: Real,
    switch: Switch,
    since_s: Real,
    /// The larger voltage before switching, of that of the pack.
    share: Real,
}

/// Input of one step of an [`Insulation`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InsulationInput {
    /// Voltage between the poles \[V\], ≥ 0.
    pub pack_v: Real,
    /// Leakage from the plus pole to the chassis \[Ω\], above zero; infinity for none.
    pub plus_ohm: Real,
    /// … from the minus pole.
    pub minus_ohm: Real,
}

/// Output of one step of an [`Insulation`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct InsulationOutput {
    /// The smaller leakage resistance \[Ω\], in the steps that finish a reading; 50 times the bridge's
    /// at most.
    pub measured_ohm: Option<Real>,
    /// The chassis above the minus pole \[V\].
    pub chassis_v: Real,
    /// An input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

impl Insulation {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: InsulationParams, dt: Dt) -> Result<Self, ParamError> {
        let c = check!(positive("insulation.y_capacitance_f", params.y_capacitance_f));
        let bridge_ohm = check!(positive("insulation.bridge_ohm", params.bridge_ohm));
        check!(positive("insulation.switched_ohm", params.switched_ohm));
        check!(positive("insulation.settle_s", params.settle_s));
        Ok(Self { params, v_per_a: dt.s() / c, bridge_s: 1.0 / bridge_ohm, dt_s: dt.s() })
    }

    /// Advances by one step.
    pub fn step(&self, state: &mut InsulationState, input: InsulationInput) -> InsulationOutput {
        let InsulationInput { pack_v, plus_ohm, minus_ohm } = input;
        let switched_s = |on: Switch| {
            if state.switch == on { 1.0 / self.params.switched_ohm } else { 0.0 }
        };
        let plus_s = 1.0 / plus_ohm + self.bridge_s + switched_s(Switch::Plus);
        let minus_s = 1.0 / minus_ohm + self.bridge_s + switched_s(Switch::Minus);
        let before_v = state.chassis_v;
        // The end of the step counts: stable at any step.
        let after_v =
            (before_v + self.v_per_a * plus_s * pack_v) / (1.0 + self.v_per_a * (plus_s + minus_s));
        let sound = sane(after_v) && sane(pack_v) && pack_v >= 0.0 && plus_s > 0.0 && minus_s > 0.0;
        if !sound {
            return InsulationOutput { measured_ohm: None, chassis_v: before_v, rejected: true };
        }
        state.chassis_v = after_v;
        state.since_s += self.dt_s;
        let mut measured_ohm = None;
        if state.since_s >= self.params.settle_s {
            state.since_s = 0.0;
            measured_ohm = self.read(state, after_v / pack_v);
        }
        InsulationOutput { measured_ohm, chassis_v: after_v, rejected: false }
    }

    /// At the end of settling, with the chassis at a share of the pack's voltage above its minus pole.
    fn read(&self, state: &mut InsulationState, share: Real) -> Option<Real> {
        if !sane(share) {
            // Without a voltage nothing is measured.
            state.switch = Switch::Open;
            return None;
        }
        let of = |switch| if switch == Switch::Plus { 1.0 - share } else { share };
        match state.switch {
            Switch::Open => {
                state.switch = if share >= 0.5 { Switch::Minus } else { Switch::Plus };
                state.share = of(state.switch);
                None
            }
            switch => {
                state.switch = Switch::Open;
                let InsulationParams { switched_ohm, bridge_ohm, .. } = self.params;
                let parallel_ohm = switched_ohm * (1.0 / of(switch) - 1.0 / state.share);
                let leak_s = 1.0 / parallel_ohm - self.bridge_s;
                let least_s = 1.0 / (FARTHEST * bridge_ohm);
                let ohm = 1.0 / max(least_s, leak_s);
                if sane(ohm) { Some(max(0.0, min(ohm, FARTHEST * bridge_ohm))) } else { None }
            }
        }
    }
}

impl_model!(Insulation, InsulationState, InsulationInput, InsulationOutput);

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: Real = 0.001;

    fn insulation() -> Insulation {
        Insulation::new(InsulationParams::USUAL, Dt::from_s(DT_S).unwrap()).unwrap()
    }

    fn input(plus_ohm: Real, minus_ohm: Real) -> InsulationInput {
        InsulationInput { pack_v: 52.0, plus_ohm, minus_ohm }
    }

    /// The second reading: the first begins with an empty capacitor.
    fn measured(mut input: impl FnMut(u32) -> InsulationInput) -> Real {
        let (insulation, mut state) = (insulation(), InsulationState::default());
        let readings = (0..8100).filter_map(|n| insulation.step(&mut state, input(n)).measured_ohm);
        readings.last().unwrap()
    }

    #[test]
    fn the_smaller_leakage_is_measured_on_either_side() {
        for (plus_ohm, minus_ohm) in [
            (23.4e3, 1e6),
            (1e6, 23.4e3),
            (4.7e3, Real::INFINITY),
            (52.0, 1e6),
            (Real::INFINITY, 200e3),
            (100e3, 100e3),
            (100e3, 110e3),
        ] {
            let least = plus_ohm.min(minus_ohm);
            let ohm = measured(|_| input(plus_ohm, minus_ohm));
            assert!((ohm / least - 1.0).abs() < 0.01, "{plus_ohm} {minus_ohm}: {ohm}");
        }
    }

    #[test]
    fn without_a_leak_the_bridge_reaches_its_end() {
        let most = FARTHEST * InsulationParams::USUAL.bridge_ohm;
        let ohm = measured(|_| input(Real::INFINITY, Real::INFINITY));
        assert!(ohm > 10.0 * InsulationParams::USUAL.bridge_ohm && ohm <= most, "{ohm}");
    }

    /// A load that pulls the pack down between both readings.
    #[test]
    fn a_load_does_no_harm() {
        let ohm = measured(|n| InsulationInput {
            pack_v: if n % 4000 < 1000 { 52.0 } else { 44.0 },
            ..input(23.4e3, 1e6)
        });
        assert!((ohm / 23.4e3 - 1.0).abs() < 0.01, "{ohm}");
    }

    /// `v` relaxes with `C·R_plus∥R_minus`, the bridge in parallel to both.
    #[test]
    fn the_chassis_settles_as_the_closed_form_says() {
        let (insulation, mut state) = (insulation(), InsulationState::default());
        let both: Real = 1.0 / (1.0 / 100e3 + 1.0 / 5e5);
        let tau_s = 0.5 * both * 1e-6;
        for _ in 0..(tau_s / DT_S) as u32 {
            insulation.step(&mut state, input(100e3, 100e3));
        }
        let exact_v = 26.0 * (1.0 - (-((tau_s / DT_S).floor() * DT_S) / tau_s).exp());
        assert!((state.chassis_v / exact_v - 1.0).abs() < 0.01, "{} {exact_v}", state.chassis_v);
    }

    #[test]
    fn a_bad_input_changes_nothing() {
        let (insulation, mut state) = (insulation(), InsulationState::default());
        insulation.step(&mut state, input(1e5, 1e5));
        let before = state;
        for bad in [
            input(0.0, 1e5),
            input(1e5, -1.0),
            input(Real::NAN, 1e5),
            InsulationInput { pack_v: Real::NAN, ..input(1e5, 1e5) },
            InsulationInput { pack_v: -1.0, ..input(1e5, 1e5) },
        ] {
            let out = insulation.step(&mut state, bad);
            assert!(out.rejected && out.measured_ohm.is_none(), "{bad:?}");
            assert_eq!(state, before, "{bad:?}");
        }
        // No voltage, nothing measured, and no harm.
        let none = InsulationInput { pack_v: 0.0, ..input(1e5, 1e5) };
        let quiet = (0..9000).all(|_| insulation.step(&mut state, none).measured_ohm.is_none());
        assert!(quiet && state.chassis_v.abs() < 1e-3, "{state:?}");
    }

    #[test]
    fn each_field_is_checked() {
        let refused = |change: fn(&mut InsulationParams)| {
            let mut params = InsulationParams::USUAL;
            change(&mut params);
            Insulation::new(params, Dt::from_s(DT_S).unwrap()).unwrap_err().field()
        };
        assert_eq!(refused(|p| p.y_capacitance_f = 0.0), "insulation.y_capacitance_f");
        assert_eq!(refused(|p| p.bridge_ohm = Real::INFINITY), "insulation.bridge_ohm");
        assert_eq!(refused(|p| p.switched_ohm = -1.0), "insulation.switched_ohm");
        assert_eq!(refused(|p| p.settle_s = Real::NAN), "insulation.settle_s");
    }
}
