//! The order in which contactors close and open.

use plant_core::error::{check, positive};
use plant_core::{Dt, ParamError, Real};

use super::state::{
    Cause, Coils, ContactorInput, ContactorState, CurrentClass, Feedback, LinkClass, Phase, Watch,
};
use crate::protect::Trip;

/// Parameters of [`ContactorControl`]: how long each wait may last.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ContactorParams {
    /// Until everything was seen after a reset \[s\], above zero.
    pub start_limit_s: Real,
    /// With minus closed alone, to see whether the link rises \[s\], above zero.
    pub settle_s: Real,
    /// Until a contactor shows closed \[s\], above `settle_s`.
    pub close_limit_s: Real,
    /// Until the link is charged \[s\], above zero.
    pub precharge_limit_s: Real,
    /// Until a contactor shows open \[s\], above zero.
    pub open_limit_s: Real,
    /// For a current that can be broken, where there is time \[s\], at least `hard_limit_s`.
    pub shed_limit_s: Real,
    /// For such a current at a safety limit \[s\], above zero.
    pub hard_limit_s: Real,
    /// For the link to fall \[s\], above zero.
    pub weld_limit_s: Real,
    /// Before the next try \[s\], above zero.
    pub cooldown_s: Real,
    /// Tries of a precharge that are allowed to fail while one request stands, 1..10.
    pub tries: u8,
}

impl ContactorParams {
    /// Usual times. Chosen: contactors of vehicles move within 30 ms, bounce for less than 10 ms.
    pub const USUAL: Self = Self {
        start_limit_s: 2.0,
        settle_s: 0.05,
        close_limit_s: 0.2,
        precharge_limit_s: 0.5,
        open_limit_s: 0.1,
        shed_limit_s: 2.0,
        hard_limit_s: 0.05,
        weld_limit_s: 5.0,
        cooldown_s: 3.0,
        tries: 3,
    };
}

/// Closes and opens the contactors in order. Every wait is bounded; what may last (`Standby`,
/// `Closed`, `Fault`) does not count, so the machine has finitely many states.
///
/// ```
/// use voltstep_bms::contactor::{
///     Coils, ContactorControl, ContactorInput, ContactorParams, CurrentClass, Feedback, LinkClass,
///     Phase, Watch,
/// };
/// use voltstep_bms::protect::{Clear, Trip};
/// use voltstep_bms::{Dt, must};
///
/// const CONTROL: ContactorControl =
///     must!(ContactorControl::new(ContactorParams::USUAL, must!(Dt::from_s(0.001))));
///
/// let mut state = CONTROL.start();
/// let mut coils = Coils::default();
/// for ms in 0..500 {
///     // Contactors that show at once what they were told, a link that charges in 150 ms.
///     let shows = |on| if on { Feedback::Closed } else { Feedback::Open };
///     let input = ContactorInput {
///         on: ms >= 10,
///         clear: Clear::No,
///         trip: Trip::None,
///         permit: true,
///         resistor_ready: true,
///         watch: if ms > 200 { Watch::Done } else { Watch::Wait },
///         current: CurrentClass::Breakable,
///         link: LinkClass::Steady,
///         feedback: [shows(coils.minus), shows(coils.precharge), shows(coils.plus)],
///     };
///     coils = CONTROL.step(&mut state, input);
/// }
/// assert_eq!(state.phase(), Phase::Closed);
/// assert!(coils.minus && coils.plus && !coils.precharge);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactorControl {
    pub(super) start: u16,
    pub(super) settle: u16,
    pub(super) close: u16,
    pub(super) precharge: u16,
    pub(super) open: u16,
    pub(super) shed: u16,
    pub(super) hard: u16,
    pub(super) weld: u16,
    pub(super) cooldown: u16,
    pub(super) tries: u8,
}

/// Whole steps in a time, at least one.
const fn steps(field: &'static str, time_s: Real, dt: Dt) -> Result<u16, ParamError> {
    let n = check!(positive(field, time_s)) / dt.s() + 0.999;
    if n >= 1.0 && n < 65_535.0 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "just checked")]
        let n = n as u16;
        Ok(n)
    } else {
        Err(ParamError::OutOfRange(field))
    }
}

impl ContactorControl {
    /// Checks the parameters, for a call every `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the field: not positive, in the wrong order, or of more than 65 534
    /// steps.
    pub const fn new(params: ContactorParams, dt: Dt) -> Result<Self, ParamError> {
        let control = Self {
            start: check!(steps("contactor.start_limit_s", params.start_limit_s, dt)),
            settle: check!(steps("contactor.settle_s", params.settle_s, dt)),
            close: check!(steps("contactor.close_limit_s", params.close_limit_s, dt)),
            precharge: check!(steps("contactor.precharge_limit_s", params.precharge_limit_s, dt)),
            open: check!(steps("contactor.open_limit_s", params.open_limit_s, dt)),
            shed: check!(steps("contactor.shed_limit_s", params.shed_limit_s, dt)),
            hard: check!(steps("contactor.hard_limit_s", params.hard_limit_s, dt)),
            weld: check!(steps("contactor.weld_limit_s", params.weld_limit_s, dt)),
            cooldown: check!(steps("contactor.cooldown_s", params.cooldown_s, dt)),
            tries: params.tries,
        };
        if control.close <= control.settle {
            return Err(ParamError::NotAbove("contactor.close_limit_s"));
        }
        if control.shed < control.hard {
            return Err(ParamError::NotAbove("contactor.shed_limit_s"));
        }
        if params.tries == 0 || params.tries > 10 {
            return Err(ParamError::OutOfRange("contactor.tries"));
        }
        Ok(control)
    }

    /// After a reset: nothing is closed, nothing is known.
    #[must_use]
    pub const fn start(&self) -> ContactorState {
        self.resume(Cause::None)
    }

    /// The same, with a fault that is remembered; [`Cause::None`] for none.
    #[must_use]
    pub const fn resume(&self, cause: Cause) -> ContactorState {
        ContactorState { phase: Phase::Start, since: 0, cause, tries: 0, armed: false }
    }

    /// One step; what the coils get.
    pub fn step(&self, state: &mut ContactorState, input: ContactorInput) -> Coils {
        let (phase, cause) = self.next(state, &input);
        if !input.on && matches!(phase, Phase::Standby) {
            state.armed = true;
            state.tries = 0;
        }
        let lasts = matches!(phase, Phase::Standby | Phase::Closed | Phase::Fault);
        state.since =
            if phase == state.phase && !lasts { state.since.saturating_add(1) } else { 0 };
        (state.phase, state.cause) = (phase, cause);
        state.coils()
    }

    fn next(&self, state: &mut ContactorState, input: &ContactorInput) -> (Phase, Cause) {
        let none_closed = !input.feedback.contains(&Feedback::Closed);
        let all_open = input.feedback == [Feedback::Open; 3];
        let [_, _, plus] = input.feedback;
        let over = |limit: u16| state.since + 1 >= limit;
        match state.phase {
            Phase::Start => self.begin(state, input),
            Phase::Standby => {
                let ready = input.permit && input.resistor_ready && all_open;
                let starts = input.on && state.armed && input.trip == Trip::None && ready;
                (if starts { Phase::CloseMinus } else { Phase::Standby }, Cause::None)
            }
            Phase::CloseMinus
            | Phase::Precharge
            | Phase::ClosePlus
            | Phase::OpenPrecharge
            | Phase::Closed => match wish(input) {
                Some(cause) => self.leave(state, input, cause),
                None => self.close(state, input),
            },
            Phase::Shed => self.shed(input, state.cause, state.since + 1),
            Phase::OpenFirst if input.trip == Trip::Crash => (Phase::OpenSecond, Cause::Crash),
            Phase::OpenFirst if plus == Feedback::Open || over(self.open) => {
                (Phase::OpenSecond, state.cause)
            }
            Phase::OpenSecond if all_open || over(self.open) => (Phase::WeldCheck, state.cause),
            Phase::WeldCheck if none_closed && input.link == LinkClass::Falling => self.rest(state),
            // A link that stays charged proves nothing: not every one has a load.
            Phase::WeldCheck if over(self.weld) && none_closed => self.rest(state),
            Phase::WeldCheck if over(self.weld) => lock(state, Cause::Welded),
            Phase::Cooldown if over(self.cooldown) => (Phase::Standby, Cause::None),
            Phase::OpenFirst | Phase::OpenSecond | Phase::WeldCheck | Phase::Cooldown => {
                (state.phase, state.cause)
            }
            Phase::Fault => {
                let cleared = input.clear >= state.cause.needs();
                if cleared && !input.on && input.trip == Trip::None && none_closed {
                    (Phase::Standby, Cause::None)
                } else {
                    (Phase::Fault, state.cause)
                }
            }
        }
    }

    /// After a reset.
    fn begin(&self, state: &mut ContactorState, input: &ContactorInput) -> (Phase, Cause) {
        let over = |limit: u16| state.since + 1 >= limit;
        let known = input.permit && input.feedback == [Feedback::Open; 3];
        if input.feedback.contains(&Feedback::Closed) {
            if over(self.open) { lock(state, Cause::Welded) } else { (Phase::Start, state.cause) }
        } else if state.cause != Cause::None {
            lock(state, state.cause)
        } else if known {
            (Phase::Standby, Cause::None)
        } else if over(self.start) {
            lock(state, Cause::Lost)
        } else {
            (Phase::Start, Cause::None)
        }
    }

    /// On the way to closed, and there.
    fn close(&self, state: &mut ContactorState, input: &ContactorInput) -> (Phase, Cause) {
        let [minus, precharge, plus] = input.feedback;
        let over = |limit: u16| state.since + 1 >= limit;
        let closed = Feedback::Closed;
        match state.phase {
            Phase::CloseMinus | Phase::Precharge if !input.permit => {
                self.leave(state, input, Cause::Lost)
            }
            Phase::CloseMinus => {
                let bypassed = input.link == LinkClass::Rising || precharge == closed;
                if bypassed || plus == closed {
                    self.leave(state, input, Cause::Bypassed)
                } else if minus == closed && input.link != LinkClass::Unknown && over(self.settle) {
                    (Phase::Precharge, Cause::None)
                } else if over(self.close) {
                    self.leave(state, input, Cause::MinusStuckOpen)
                } else {
                    (Phase::CloseMinus, Cause::None)
                }
            }
            Phase::Precharge => match input.watch {
                Watch::Short => self.leave(state, input, Cause::PrechargeShort),
                Watch::Open if precharge == closed => {
                    self.leave(state, input, Cause::PrechargeOpen)
                }
                Watch::Open => self.leave(state, input, Cause::PrechargeStuckOpen),
                Watch::Slow => self.leave(state, input, Cause::PrechargeSlow),
                Watch::Done if minus == closed && precharge == closed && plus != closed => {
                    (Phase::ClosePlus, Cause::None)
                }
                Watch::Done | Watch::Wait if over(self.precharge) => {
                    self.leave(state, input, Cause::PrechargeSlow)
                }
                Watch::Done | Watch::Wait => (Phase::Precharge, Cause::None),
            },
            Phase::ClosePlus if plus == closed => (Phase::OpenPrecharge, Cause::None),
            Phase::ClosePlus if over(self.close) => self.leave(state, input, Cause::PlusStuckOpen),
            Phase::OpenPrecharge if precharge == Feedback::Open => {
                state.tries = 0;
                (Phase::Closed, Cause::None)
            }
            Phase::OpenPrecharge if over(self.open) => {
                self.leave(state, input, Cause::PrechargeStuckClosed)
            }
            Phase::Closed if minus == Feedback::Open || plus == Feedback::Open => {
                self.leave(state, input, Cause::Dropped)
            }
            phase => (phase, Cause::None),
        }
    }

    /// Begins to open: through the resistor at once, else once the current can be broken.
    fn leave(
        &self,
        state: &mut ContactorState,
        input: &ContactorInput,
        cause: Cause,
    ) -> (Phase, Cause) {
        // A try that the request ended has not failed.
        if failed_try(cause) {
            state.tries += 1;
        }
        match state.phase {
            Phase::CloseMinus | Phase::Precharge => (Phase::OpenSecond, cause),
            _ => self.shed(input, cause, 0),
        }
    }

    /// Waits for a current that can be broken; one that is not known cannot. `waited` steps so far.
    fn shed(&self, input: &ContactorInput, cause: Cause, waited: u16) -> (Phase, Cause) {
        let (limit, cause) = match input.trip {
            Trip::Crash => return (Phase::OpenSecond, Cause::Crash),
            Trip::Hard => (self.hard, Cause::Hard),
            Trip::Soft | Trip::None if cause == Cause::Hard => (self.hard, cause),
            Trip::Soft | Trip::None => (self.shed, cause),
        };
        if input.current == CurrentClass::Breakable || waited >= limit {
            (Phase::OpenFirst, cause)
        } else {
            (Phase::Shed, cause)
        }
    }

    /// All is open: what comes next depends on why.
    fn rest(&self, state: &mut ContactorState) -> (Phase, Cause) {
        let again = failed_try(state.cause) && state.tries < self.tries;
        if state.cause == Cause::None || again {
            (Phase::Cooldown, Cause::None)
        } else {
            lock(state, state.cause)
        }
    }
}

/// A fault; the request must be seen off before the next start.
fn lock(state: &mut ContactorState, cause: Cause) -> (Phase, Cause) {
    state.armed = false;
    (Phase::Fault, cause)
}

/// What may be tried again.
const fn failed_try(cause: Cause) -> bool {
    matches!(cause, Cause::PrechargeSlow | Cause::PrechargeOpen)
}

/// Why to open, whatever is closed: a trip, or the end of the request.
const fn wish(input: &ContactorInput) -> Option<Cause> {
    match input.trip {
        Trip::Crash => Some(Cause::Crash),
        Trip::Hard => Some(Cause::Hard),
        Trip::Soft => Some(Cause::Soft),
        Trip::None if !input.on => Some(Cause::None),
        Trip::None => None,
    }
}
