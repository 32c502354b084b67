//! One contactor.

use crate::error::{ParamError, check, not_negative};
use crate::model::{Dt, impl_model};
use crate::num::Real;

/// Parameters of a [`Contactor`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct ContactorParams {
    /// From the coil's current until the contacts touch \[s\], ≥ 0 and below 65 000 steps.
    pub close_s: Real,
    /// For so long they bounce then \[s\], likewise.
    pub bounce_s: Real,
    /// From the end of the coil's current until they part \[s\], likewise.
    pub open_s: Real,
}

impl ContactorParams {
    /// Of a vehicle's main contactor. Chosen: data sheets state 25 ms with 5 ms of bounce, and 10 ms.
    pub const USUAL: Self = Self { close_s: 0.02, bounce_s: 0.005, open_s: 0.01 };
}

/// A contactor that follows its coil late, discretised for one step.
///
/// While it bounces, contacts conduct in every second step. The mirror contact shows where the armature
/// is: closed from the first touch on.
///
/// ```
/// use plant_core::link::{
///     Contactor, ContactorFault, ContactorInput, ContactorParams, ContactorState,
/// };
/// use plant_core::{Dt, must};
///
/// const MAIN: Contactor =
///     must!(Contactor::new(ContactorParams::USUAL, must!(Dt::from_s(0.001))));
///
/// let mut state = ContactorState::default();
/// let input = ContactorInput { coil: true, fault: ContactorFault::None };
/// let ms = (1..).find(|_| MAIN.step(&mut state, input).conducts);
/// assert_eq!(ms, Some(21));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contactor {
    close: u16,
    bounce: u16,
    open: u16,
}

/// What is wrong with a contactor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum ContactorFault {
    /// Nothing.
    #[default]
    None,
    /// The contacts are welded: closed, whatever the coil does.
    Welded,
    /// The armature is stuck: open.
    StuckOpen,
    /// It works, and its mirror contact shows closed.
    ShowsClosed,
    /// It works, and its mirror contact shows open.
    ShowsOpen,
}

/// The state of a [`Contactor`]; the default is open, without a coil current.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ContactorState {
    coil: bool,
    closed: bool,
    since: u16,
}

impl ContactorState {
    /// Where the armature is, whatever is wrong with the contacts.
    #[must_use]
    pub const fn is_closed(&self) -> bool {
        self.closed
    }
}

/// Input of one step of a [`Contactor`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactorInput {
    /// Its coil is driven.
    pub coil: bool,
    /// What is wrong with it.
    pub fault: ContactorFault,
}

/// Output of one step of a [`Contactor`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ContactorOutput {
    /// Its contacts conduct.
    pub conducts: bool,
    /// Its mirror contact shows closed.
    pub shows_closed: bool,
}

/// Whole steps in a time.
const fn steps(field: &'static str, time_s: Real, dt: Dt) -> Result<u16, ParamError> {
    let n = check!(not_negative(field, time_s)) / dt.s() + 0.5;
    if n < 65_000.0 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "just checked")]
        let n = n as u16;
        Ok(n)
    } else {
        Err(ParamError::OutOfRange(field))
    }
}

impl Contactor {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the field: below zero, or of too many steps.
    pub const fn new(params: ContactorParams, dt: Dt) -> Result<Self, ParamError> {
        Ok(Self {
            close: check!(steps("contactor.close_s", params.close_s, dt)),
            bounce: check!(steps("contactor.bounce_s", params.bounce_s, dt)),
            open: check!(steps("contactor.open_s", params.open_s, dt)),
        })
    }

    /// Advances by one step.
    pub const fn step(&self, state: &mut ContactorState, input: ContactorInput) -> ContactorOutput {
        if input.coil != state.coil {
            (state.coil, state.since) = (input.coil, 0);
        }
        let lag = if input.coil { self.close } else { self.open };
        if state.since >= lag {
            state.closed = input.coil;
        }
        let touching = state.since.saturating_sub(self.close);
        state.since = state.since.saturating_add(1);
        let bounces = state.closed && state.coil && touching < self.bounce && touching % 2 == 1;
        match input.fault {
            ContactorFault::None => {
                ContactorOutput { conducts: state.closed && !bounces, shows_closed: state.closed }
            }
            ContactorFault::Welded => ContactorOutput { conducts: true, shows_closed: true },
            ContactorFault::StuckOpen => ContactorOutput { conducts: false, shows_closed: false },
            ContactorFault::ShowsClosed => {
                ContactorOutput { conducts: state.closed && !bounces, shows_closed: true }
            }
            ContactorFault::ShowsOpen => {
                ContactorOutput { conducts: state.closed && !bounces, shows_closed: false }
            }
        }
    }
}

impl_model!(Contactor, ContactorState, ContactorInput, ContactorOutput);
