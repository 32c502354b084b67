//! Rows that have tripped, and those that are latched.

use super::field::{Field, Layout, Message};
use crate::protect::{Faults, Id, ROWS, Verdict};

/// Rows in a frame.
const ROWS_IN_A_PAGE: usize = 56;
/// How many frames hold all: two of tripped rows, two of latched ones.
pub const FAULT_PAGES: u8 = 4;

const _: () = assert!(2 * ROWS_IN_A_PAGE >= ROWS);

const PAGE: Field = Field::raw("Page", 0, 8);
const MASK: Field = Field::raw("Rows", 8, 56);
pub(super) const FAULTS: Layout =
    Layout { id: 0x516, length: 8, name: "Faults", fields: &[PAGE, MASK] };

/// A share of the rows: pages 0 and 1 are those that have tripped, 2 and 3 those that are latched;
/// bit k of an odd page is the row with index 56 + k.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FaultPage {
    /// Which share, below [`FAULT_PAGES`].
    pub page: u8,
    /// The rows in it.
    pub rows: Faults,
}

impl FaultPage {
    /// One page; `None` beyond the last.
    #[must_use]
    pub fn of(verdict: &Verdict, page: u8) -> Option<Self> {
        let rows = match page {
            0 | 1 => verdict.tripped,
            2 | 3 => verdict.latched,
            _ => return None,
        };
        let outside = rows.iter().filter(|id| place(page, *id).is_none());
        Some(Self { page, rows: outside.fold(rows, Faults::without) })
    }

    /// Whether it is a page of latched rows.
    #[must_use]
    pub const fn latched(&self) -> bool {
        self.page >= 2
    }

    /// As a message; rows of other pages are left out.
    #[must_use]
    pub fn encode(&self) -> Message {
        let places = self.rows.iter().filter_map(|id| place(self.page, id));
        let mask = places.fold(0, |mask, place| mask | 1 << place);
        FAULTS.message(MASK.with_raw(PAGE.with_raw(0, u64::from(self.page)), mask))
    }

    /// That of a message; `None` where it is another, or has a page or a row that there is not.
    #[must_use]
    pub fn decode(message: &Message) -> Option<Self> {
        let bits = message.bits(&FAULTS)?;
        let page = u8::try_from(PAGE.raw_of(bits)).ok().filter(|page| *page < FAULT_PAGES)?;
        let mask = MASK.raw_of(bits);
        let set = |id: &Id| place(page, *id).is_some_and(|place| mask >> place & 1 == 1);
        let rows = Id::ALL.into_iter().filter(set).fold(Faults::NONE, Faults::with);
        let page = Self { page, rows };
        (page.encode() == *message).then_some(page)
    }
}

/// The bit of a row in a page.
fn place(page: u8, id: Id) -> Option<usize> {
    let first = ROWS_IN_A_PAGE * usize::from(page % 2);
    usize::from(id.index()).checked_sub(first).filter(|place| *place < ROWS_IN_A_PAGE)
}
