//! What the machine is in, what it sees, what it gives.

use crate::protect::{Clear, Contactor, Faults, Id, PrechargeFault, Trip};

/// Where the contactors are in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum Phase {
    /// After a reset: nothing is known yet.
    Start,
    /// All open, ready.
    Standby,
    /// The main contactor at the negative pole closes.
    CloseMinus,
    /// The link is charged through the resistor.
    Precharge,
    /// The main contactor at the positive pole closes.
    ClosePlus,
    /// The precharge contactor opens.
    OpenPrecharge,
    /// Both mains are closed.
    Closed,
    /// Both are closed still, and no power is allowed.
    Shed,
    /// The main contactor at the positive pole opens.
    OpenFirst,
    /// All open.
    OpenSecond,
    /// All should be open: are they?
    WeldCheck,
    /// A pause before the next try.
    Cooldown,
    /// All open, until somebody clears it.
    Fault,
}

/// Why the contactors opened, or may not close.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum Cause {
    /// Nothing, or the request ended.
    #[default]
    None,
    /// A trip that let the power be taken back first.
    Soft,
    /// A trip at a safety limit.
    Hard,
    /// A crash.
    Crash,
    /// Data went missing while closing, or never came.
    Lost,
    /// Minus does not show closed.
    MinusStuckOpen,
    /// Plus does not show closed.
    PlusStuckOpen,
    /// Precharge does not show closed.
    PrechargeStuckOpen,
    /// Precharge does not show open.
    PrechargeStuckClosed,
    /// Current flows, the link stays down.
    PrechargeShort,
    /// No current flows into the link.
    PrechargeOpen,
    /// The link rises too slowly.
    PrechargeSlow,
    /// The link rises, or a contactor shows closed, before its turn.
    Bypassed,
    /// A main that was closed shows open.
    Dropped,
    /// One shows closed that should be open.
    Welded,
}

impl Cause {
    /// Every one, in the order of [`code`](Self::code).
    pub const ALL: [Self; 15] = [
        Self::None,
        Self::Soft,
        Self::Hard,
        Self::Crash,
        Self::Lost,
        Self::MinusStuckOpen,
        Self::PlusStuckOpen,
        Self::PrechargeStuckOpen,
        Self::PrechargeStuckClosed,
        Self::PrechargeShort,
        Self::PrechargeOpen,
        Self::PrechargeSlow,
        Self::Bypassed,
        Self::Dropped,
        Self::Welded,
    ];

    /// Who may end a fault with this cause. What may hurt somebody, or means a damaged part that
    /// the next try would stress, needs a workshop.
    #[must_use]
    pub const fn needs(self) -> Clear {
        match self {
            Self::None | Self::Soft | Self::Lost => Clear::No,
            Self::Welded | Self::Crash | Self::PrechargeShort | Self::Bypassed => Clear::Service,
            _ => Clear::Reset,
        }
    }

    /// Its number, for a record or a bus.
    #[must_use]
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The one with this number.
    #[must_use]
    pub fn at(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }

    /// The rows of the table that it is written down as; which contactor is welded is seen from what
    /// they show.
    #[must_use]
    pub fn faults(self, feedback: [Feedback; 3]) -> Faults {
        let one = |id| Faults::NONE.with(id);
        match self {
            Self::None | Self::Soft | Self::Hard | Self::Crash | Self::Lost => Faults::NONE,
            Self::MinusStuckOpen => one(Id::Feedback(Contactor::Minus)),
            Self::PlusStuckOpen => one(Id::Feedback(Contactor::Plus)),
            Self::PrechargeStuckOpen => one(Id::Feedback(Contactor::Precharge)),
            Self::PrechargeStuckClosed => one(Id::Weld(Contactor::Precharge)),
            Self::PrechargeShort => one(Id::Precharge(PrechargeFault::Short)),
            Self::PrechargeOpen => one(Id::Precharge(PrechargeFault::Open)),
            Self::PrechargeSlow => one(Id::Precharge(PrechargeFault::Slow)),
            Self::Bypassed => one(Id::Bypassed),
            Self::Dropped => shown(
                feedback,
                Feedback::Open,
                [
                    Id::Feedback(Contactor::Minus),
                    Id::Feedback(Contactor::Precharge),
                    Id::Feedback(Contactor::Plus),
                ],
            )
            .without(Id::Feedback(Contactor::Precharge)),
            Self::Welded => shown(
                feedback,
                Feedback::Closed,
                [
                    Id::Weld(Contactor::Minus),
                    Id::Weld(Contactor::Precharge),
                    Id::Weld(Contactor::Plus),
                ],
            ),
        }
    }
}

fn shown(feedback: [Feedback; 3], state: Feedback, ids: [Id; 3]) -> Faults {
    let mut faults = Faults::NONE;
    for (seen, id) in feedback.into_iter().zip(ids) {
        if seen == state {
            faults = faults.with(id);
        }
    }
    faults
}

/// How the precharge goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Watch {
    /// As expected so far.
    #[default]
    Wait,
    /// The link is charged.
    Done,
    /// Current flows, the link does not rise.
    Short,
    /// No current flows.
    Open,
    /// The link rises more slowly than expected.
    Slow,
}

/// What the current is to a contactor that opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CurrentClass {
    /// Nobody knows; it is not taken for small.
    Unknown,
    /// A contactor breaks it without harm.
    Breakable,
    /// More than that.
    High,
}

/// What the link's voltage does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LinkClass {
    /// Nobody knows.
    Unknown,
    /// It stays.
    Steady,
    /// It rises.
    Rising,
    /// It falls.
    Falling,
}

/// What a contactor's mirror contact shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum Feedback {
    /// It could not be read.
    Unknown,
    /// Open.
    Open,
    /// Closed.
    Closed,
}

/// What the machine sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ContactorInput {
    /// Somebody wants to drive or charge.
    pub on: bool,
    /// Who asks for a fault to end.
    pub clear: Clear,
    /// What the rows of the table say.
    pub trip: Trip,
    /// Everything is seen, and no row forbids to close.
    pub permit: bool,
    /// The precharge resistor can take one more short.
    pub resistor_ready: bool,
    /// How the precharge goes.
    pub watch: Watch,
    /// The current.
    pub current: CurrentClass,
    /// The link.
    pub link: LinkClass,
    /// What minus, precharge and plus show.
    pub feedback: [Feedback; 3],
}

/// What the coils get.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Coils {
    /// The main contactor at the negative pole.
    pub minus: bool,
    /// The precharge contactor.
    pub precharge: bool,
    /// The main contactor at the positive pole.
    pub plus: bool,
}

/// The state of a [`ContactorControl`](super::ContactorControl).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactorState {
    pub(super) phase: Phase,
    /// Steps in this phase.
    pub(super) since: u16,
    pub(super) cause: Cause,
    /// Tries that failed while one request stands.
    pub(super) tries: u8,
    /// The request has been off since the start or the last fault.
    pub(super) armed: bool,
}

impl ContactorState {
    /// The phase.
    #[must_use]
    pub const fn phase(&self) -> Phase {
        self.phase
    }

    /// Why it opened, or may not close.
    #[must_use]
    pub const fn cause(&self) -> Cause {
        self.cause
    }

    /// Tries that failed while one request stands.
    #[must_use]
    pub const fn tries(&self) -> u8 {
        self.tries
    }

    /// What the coils get: a function of the phase alone.
    #[must_use]
    pub const fn coils(&self) -> Coils {
        let (minus, precharge, plus) = match self.phase {
            Phase::CloseMinus | Phase::OpenFirst => (true, false, false),
            Phase::Precharge => (true, true, false),
            Phase::ClosePlus => (true, true, true),
            Phase::OpenPrecharge | Phase::Closed | Phase::Shed => (true, false, true),
            Phase::Start
            | Phase::Standby
            | Phase::OpenSecond
            | Phase::WeldCheck
            | Phase::Cooldown
            | Phase::Fault => (false, false, false),
        };
        Coils { minus, precharge, plus }
    }

    /// Whether power is allowed on the bus at all.
    #[must_use]
    pub const fn power_allowed(&self) -> bool {
        matches!(self.phase, Phase::Closed)
    }
}
