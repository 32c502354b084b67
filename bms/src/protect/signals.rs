//! What else there is to judge, and what comes out.

use plant_core::Real;

use super::id::{Faults, Flow, Id, Level};
use super::row::{Clear, Reaction, Trip};
use super::table::Table;
use crate::Reading;

/// What the measurements do not hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signals<'a> {
    /// Rows that others find bad: the state machine of the contactors, communication, memory, the
    /// loop through the connectors, a crash, supply, coolant, estimator, bleed switches, the
    /// comparator of a short circuit.
    pub flags: Faults,
    /// Cells are bled: one may move alone.
    pub bleeding: bool,
    /// Both main contactors show closed.
    pub mains_closed: bool,
    /// All contactors show open.
    pub all_open: bool,
    /// A second current sensor \[A\]; NaN where there is none.
    pub second_current_a: Real,
    /// The mean cell less its model \[V\]; NaN where there is none.
    pub residual_v: Real,
    /// How far the reading at each wire, from the lowest to the highest, moves under the front end's
    /// test current \[V\]: one more than cells; NaN where it was not tested, empty without a test.
    pub wires_v: &'a [Real],
    /// How many cells the front end found.
    pub cells_found: Option<u16>,
    /// Insulation to the chassis \[Ω/V\]; `None` without a device.
    pub insulation_ohm_per_v: Option<Reading>,
    /// Time since the last call \[s\].
    pub elapsed_s: Real,
    /// Who asks for latched faults to end.
    pub clear: Clear,
}

impl Signals<'_> {
    /// Nothing to report, nothing asked.
    pub const QUIET: Self = Self {
        flags: Faults::NONE,
        bleeding: false,
        mains_closed: false,
        all_open: false,
        second_current_a: Real::NAN,
        residual_v: Real::NAN,
        wires_v: &[],
        cells_found: None,
        insulation_ohm_per_v: None,
        elapsed_s: 0.0,
        clear: Clear::No,
    };
}

/// What the rows say together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct Verdict {
    /// What the contactors are told.
    pub trip: Trip,
    /// Everything was seen, and nothing that forbids to close has tripped or is latched.
    pub permit: bool,
    /// Rows that have tripped and not healed.
    pub tripped: Faults,
    /// Rows that stay until somebody ends them.
    pub latched: Faults,
    /// Rows that have tripped in this call.
    pub rose: Faults,
    /// Rows that have healed in this call.
    pub fell: Faults,
}

impl Verdict {
    /// No power in this direction: a safety limit of it is broken.
    #[must_use]
    pub fn bars(&self, table: &Table, flow: Flow) -> bool {
        self.concerning(flow).any(|id| table.row(id).level == Level::Msl && id.flow().is_some())
    }

    /// Less power in this direction.
    #[must_use]
    pub fn derates(&self, table: &Table, flow: Flow) -> bool {
        self.concerning(flow).any(|id| table.row(id).reaction >= Reaction::Derate)
    }

    fn concerning(&self, flow: Flow) -> impl Iterator<Item = Id> {
        let both = self.tripped.union(self.latched);
        both.iter().filter(move |id| id.flow().is_none_or(|concerned| concerned == flow))
    }
}
