//! One row of the table.

use plant_core::Real;
use plant_core::num::sane;

use super::debounce::{Debounce, Sample};
use super::id::{Id, Level, Side};

/// How often a row is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Pace {
    /// In every call.
    Tick,
    /// When all cells and temperatures were looked at once more.
    Sweep,
}

/// What a trip leads to, the stronger the later.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reaction {
    /// It is written down.
    Log,
    /// Less power is allowed, in the direction that it concerns.
    Derate,
    /// Power is taken back over seconds, then the contactors open.
    Soft,
    /// The contactors open after a short wait for the current.
    Hard,
    /// They open at once.
    Crash,
}

/// What the contactors are told, the stronger the later.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum Trip {
    /// Nothing: go on.
    #[default]
    None,
    /// Power is taken back over seconds, then they open.
    Soft,
    /// They open after a short wait for the current.
    Hard,
    /// They open at once.
    Crash,
}

impl Reaction {
    /// What it tells the contactors.
    #[must_use]
    pub const fn trip(self) -> Trip {
        match self {
            Self::Log | Self::Derate => Trip::None,
            Self::Soft => Trip::Soft,
            Self::Hard => Trip::Hard,
            Self::Crash => Trip::Crash,
        }
    }
}

/// Who may end a fault whose cause is gone, the stronger the later.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum Clear {
    /// Nobody needs to: it heals.
    No,
    /// A reset by the driver or the vehicle: it is latched until then.
    Reset,
    /// A workshop: it is latched beyond a power cut.
    Service,
}

/// One row of the table: what is watched, when it trips, and what follows.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Row {
    /// What it watches; the quantity and its unit stand there.
    pub id: Id,
    /// How severe it is.
    pub level: Level,
    /// Beyond this it is bad, in the unit of the quantity. Where something is so or not, 0.5.
    pub threshold: Real,
    /// How far within the threshold it must be to heal, ≥ 0.
    pub hysteresis: Real,
    /// How often it is judged.
    pub pace: Pace,
    /// After how many bad judgements it trips, and after how many good ones it heals.
    pub debounce: Debounce,
    /// Latched until somebody ends it, or healing by itself.
    pub clear: Clear,
    /// What follows.
    pub reaction: Reaction,
}

/// What a row sees of its quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Seen {
    /// The value, of several the worst that was seen; NaN where none was.
    pub value: Real,
    /// Whether all of it was seen: an extreme of some cells vouches for no other.
    pub complete: bool,
}

impl Seen {
    /// Nothing.
    pub const NOTHING: Self = Self { value: Real::NAN, complete: false };

    /// All of it.
    #[must_use]
    pub const fn all(value: Real) -> Self {
        Self { value, complete: true }
    }

    /// Something that is so or not.
    #[must_use]
    pub const fn flag(bad: bool) -> Self {
        Self::all(if bad { 1.0 } else { 0.0 })
    }
}

impl Row {
    /// What this row makes of a value.
    #[must_use]
    pub const fn judge(&self, seen: Seen) -> Sample {
        let beyond = match self.id.side() {
            Side::High => seen.value - self.threshold,
            Side::Low => self.threshold - seen.value,
        };
        if !sane(seen.value) {
            Sample::Missing
        } else if beyond > 0.0 {
            Sample::Bad
        } else if !seen.complete {
            Sample::Missing
        } else if beyond > -self.hysteresis {
            Sample::Near
        } else {
            Sample::Good
        }
    }
}
