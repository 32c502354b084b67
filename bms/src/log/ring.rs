//! The newest events in memory, and what is known of each row.

use heapless::Deque;

use super::entry::{Entry, Frame, Kind, later};
use crate::protect::{Faults, Id, ROWS};

/// How many entries are kept.
pub const KEPT: usize = 32;

/// How often a row has tripped, and when.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct Occurrences {
    /// How often, up to 65 535.
    pub count: u16,
    /// Uptime of the first \[ms\].
    pub first_ms: u32,
    /// Uptime of the last \[ms\].
    pub last_ms: u32,
}

/// The newest [`KEPT`] events, and the occurrences of every row since the start.
///
/// What is to be stored is taken out by [`pending`](Self::pending) and [`stored`](Self::stored); an
/// event that was overwritten before it could be stored is counted in [`lost`](Self::lost).
#[derive(Clone, Debug)]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct Log {
    entries: Deque<Entry, KEPT>,
    #[cfg_attr(feature = "recorder", serde(with = "serde_big_array::BigArray"))]
    occurrences: [Occurrences; ROWS],
    next: u32,
    // What was stored is the product's matter.
    #[cfg_attr(feature = "recorder", serde(skip))]
    stored: u32,
    #[cfg_attr(feature = "recorder", serde(skip))]
    lost: u32,
}

impl Log {
    /// Empty, with the number of the first entry: one more than that of the last ever stored.
    #[must_use]
    pub const fn new(next: u32) -> Self {
        Self {
            entries: Deque::new(),
            occurrences: [Occurrences { count: 0, first_ms: 0, last_ms: 0 }; ROWS],
            next,
            stored: next,
            lost: 0,
        }
    }

    /// Before the first event: numbers go on after the newest entry of a store, where that is later
    /// than what the log was made with, as after a power cut.
    pub fn follow(&mut self, newest: Option<u32>) {
        if let Some(newest) = newest
            && self.entries.is_empty()
            && later(newest.wrapping_add(1), self.next)
        {
            self.next = newest.wrapping_add(1);
            self.stored = self.next;
        }
    }

    /// Writes down what happened to some rows in one moment.
    pub fn write(&mut self, rows: Faults, kind: Kind, at_ms: u32, phase: u8, frame: Frame) {
        if rows.is_empty() {
            return;
        }
        for id in rows.iter() {
            if let (Kind::Tripped, Some(seen)) =
                (kind, self.occurrences.get_mut(usize::from(id.index())))
            {
                if seen.count == 0 {
                    seen.first_ms = at_ms;
                }
                seen.count = seen.count.saturating_add(1);
                seen.last_ms = at_ms;
            }
            let entry = Entry { sequence: self.next, at_ms, id, kind, phase, frame };
            if self.entries.is_full()
                && let Some(oldest) = self.entries.pop_front()
                && oldest.sequence == self.stored
            {
                self.lost = self.lost.saturating_add(1);
                self.stored = self.stored.wrapping_add(1);
            }
            // There is room now.
            let _ = self.entries.push_back(entry);
            self.next = self.next.wrapping_add(1);
        }
    }

    /// The entries, the oldest first.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter()
    }

    /// What is known of a row.
    #[must_use]
    pub fn occurrences(&self, id: Id) -> Occurrences {
        self.occurrences.get(usize::from(id.index())).copied().unwrap_or_default()
    }

    /// The number of the newest entry; `None` where none was ever written.
    #[must_use]
    pub fn newest(&self) -> Option<u32> {
        self.entries.back().map(|entry| entry.sequence).or_else(|| self.next.checked_sub(1))
    }

    /// The oldest entry that is not stored yet.
    #[must_use]
    pub fn pending(&self) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.sequence == self.stored)
    }

    /// The entry that was pending is stored.
    pub fn stored(&mut self) {
        if self.pending().is_some() {
            self.stored = self.stored.wrapping_add(1);
        }
    }

    /// How many entries were overwritten before they could be stored.
    #[must_use]
    pub const fn lost(&self) -> u32 {
        self.lost
    }
}
