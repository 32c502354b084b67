//! What of an input is replayed.

use serde::Serialize;

/// What of a trip is replayed, as asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "command", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// The whole vehicle on measured speed, height and auxiliary power.
    Vehicle,
    /// The battery alone on measured current.
    Battery,
}

impl Mode {
    /// The word for it, on the command line and in JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Vehicle => "vehicle",
            Self::Battery => "battery",
        }
    }
}

/// What was replayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Replayed {
    /// The whole vehicle on a driving cycle.
    Cycle,
    /// The whole vehicle on a trip.
    Trip,
    /// The battery alone on a trip's measured current.
    Battery,
    /// The battery alone on a profile of current or power.
    Profile,
}

impl Replayed {
    /// Whether a vehicle moves.
    #[must_use]
    pub const fn drives(self) -> bool {
        matches!(self, Self::Cycle | Self::Trip)
    }
}
