//! Faults that come and go.

use super::{Disturbed, Random};
use crate::error::{ParamError, check, finite, limit, not_negative, ratio};
use crate::model::{Dt, impl_model};
use crate::num::{LARGEST_PARAM, Real, clamp, sane};

/// What a [`Lapse`] does to the value while it lasts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case", deny_unknown_fields))]
pub enum LapseKind {
    /// No sample comes, and who reads is told.
    Missing,
    /// The reading stays as it was, and nobody is told.
    Stuck,
    /// The wire is open: what pulls it reads this, in the unit of the value.
    OpenWire(Real),
}

/// Parameters of a lapse.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct LapseParams {
    /// What it does.
    pub kind: LapseKind,
    /// Before this time there is none \[s\], ≥ 0; to the nearest step.
    pub from_s: Real,
    /// How likely one begins in a step, 0..1; 1 for one at `from_s`.
    pub chance: Real,
    /// How long it lasts \[s\], above zero, one step at least; infinity for ever.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub length_s: Real,
    /// From which its random numbers come.
    pub seed: u32,
}

/// A fault that comes and goes: samples that are missing, a reading that sticks, an open wire.
///
/// ```
/// use plant_core::signal::faults::{Lapse, LapseKind, LapseParams};
/// use plant_core::{Dt, must};
///
/// const BROKEN: Lapse = must!(Lapse::new(
///     LapseParams {
///         kind: LapseKind::OpenWire(5.0),
///         from_s: 0.2,
///         chance: 1.0,
///         length_s: f32::INFINITY,
///         seed: 0,
///     },
///     must!(Dt::from_s(0.1)),
/// ));
/// let mut state = BROKEN.start();
/// assert_eq!([3.0, 3.1, 3.2, 3.3].map(|x| BROKEN.step(&mut state, x).value), [3.0, 3.1, 5.0, 5.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lapse {
    kind: LapseKind,
    from_steps: u32,
    chance: Real,
    length_steps: u32,
    seed: u32,
}

/// The state of a [`Lapse`]; [`Lapse::start`] makes one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LapseState {
    random: Random,
    /// Steps until it may begin.
    ahead: u32,
    /// Steps that it will last.
    left: u32,
    last: Real,
}

/// For ever, in steps.
const EVER: u32 = u32::MAX;

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "held in range first; what is larger is for ever"
)]
const fn steps(seconds: Real, dt: Dt, least: Real) -> u32 {
    let steps = seconds / dt.s();
    if steps < 2_147_483_648.0 { clamp(steps + 0.5, least, 2_147_483_648.0) as u32 } else { EVER }
}

impl Lapse {
    /// Checks `params`, for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: LapseParams, dt: Dt) -> Result<Self, ParamError> {
        if let LapseKind::OpenWire(reading) = params.kind {
            check!(finite("lapse.open_wire", reading));
            if !sane(reading) {
                return Err(ParamError::NotFinite("lapse.open_wire"));
            }
        }
        check!(not_negative("lapse.from_s", params.from_s));
        check!(ratio("lapse.chance", params.chance));
        let length_s = check!(limit("lapse.length_s", params.length_s));
        let length_s = if length_s < LARGEST_PARAM { length_s } else { Real::INFINITY };
        Ok(Self {
            kind: params.kind,
            from_steps: steps(params.from_s, dt, 0.0),
            chance: params.chance,
            length_steps: steps(length_s, dt, 1.0),
            seed: params.seed,
        })
    }

    /// At time zero.
    #[must_use]
    pub const fn start(&self) -> LapseState {
        let random = Random::new(self.seed);
        LapseState { random, ahead: self.from_steps, left: 0, last: 0.0 }
    }

    /// One reading.
    #[inline]
    pub const fn step(&self, state: &mut LapseState, value: Real) -> Disturbed {
        if !sane(value) {
            return Disturbed { value: state.last, missing: false, rejected: true };
        }
        if state.ahead > 0 {
            state.ahead -= 1;
        } else if state.left == 0 && state.random.ratio() < self.chance {
            state.left = self.length_steps;
        }
        let lapsed = state.left > 0;
        if !lapsed {
            state.last = value;
        } else if state.left != EVER {
            state.left -= 1;
        }
        let value = match self.kind {
            LapseKind::OpenWire(reading) if lapsed => reading,
            _ => state.last,
        };
        let missing = lapsed && matches!(self.kind, LapseKind::Missing);
        Disturbed { value, missing, rejected: false }
    }
}

impl_model!(Lapse, LapseState, Real, Disturbed);
