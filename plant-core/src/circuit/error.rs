//! Why a circuit is refused.

use crate::error::{ErrorText, ParamError};

/// A circuit that can't be built: which element or node, and what is wrong with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum CircuitError {
    /// A parameter of this element broke a rule.
    Element(usize, ParamError),
    /// This element names a node that the circuit does not have.
    NoSuchNode(usize),
    /// Both ends of this element lie at the same node.
    Shorted(usize),
    /// Nothing but current sources ties this node to the others.
    Floating(usize),
    /// This voltage source closes a loop of voltage sources.
    SourceLoop(usize),
    /// This element's values change from step to step: a table can't hold it.
    NotInTable(usize),
    /// The number of two-state elements asks for another size of the table: `2^n`, or 0 for none.
    TableSize(usize),
    /// The number of elements that can drive a current asks for another size: see
    /// [`sources`](super::sources).
    Sources(usize),
    /// More than 16 two-state elements, or more than 32 elements.
    TooLarge(usize),
}

impl CircuitError {
    /// What is wrong, and the element, node or number that it is wrong with.
    const fn words(self) -> (&'static str, &'static str, usize) {
        match self {
            Self::Element(at, error) => (error.field(), error.message(), at),
            Self::NoSuchNode(at) => ("element", "names a node that the circuit does not have", at),
            Self::Shorted(at) => ("element", "has both ends at the same node", at),
            Self::Floating(at) => {
                ("node", "is tied to the others by nothing but sources of current", at)
            }
            Self::SourceLoop(at) => ("element", "closes a loop of voltage sources", at),
            Self::NotInTable(at) => {
                ("element", "changes from step to step, which no table holds", at)
            }
            Self::TableSize(at) => ("CONFIGURATIONS", "must be 0 or", at),
            Self::Sources(at) => ("SOURCES", "must be", at),
            Self::TooLarge(at) => {
                ("circuit", "may have 16 two-state elements and 32 elements, not", at)
            }
        }
    }

    /// All in one text, for the compile error of [`must!`](crate::must).
    #[doc(hidden)]
    #[must_use]
    pub const fn text(self) -> ErrorText {
        let (what, rule, number) = self.words();
        ErrorText::numbered(what, rule, number)
    }
}

impl core::fmt::Display for CircuitError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (what, rule, number) = self.words();
        write!(f, "{what} {rule} ({number})")
    }
}

impl core::error::Error for CircuitError {}
