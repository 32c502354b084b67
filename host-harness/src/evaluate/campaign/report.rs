//! What all cases say together.

use serde::Serialize;

use super::{Judged, Verdict};
use crate::read::scenario::Fault;

/// The whole campaign.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Every case.
    pub cases: Vec<Judged>,
    /// The cases of each fault together.
    pub kinds: Vec<Kind>,
    /// What was not noticed, by fault and reason, the most first.
    pub unnoticed: Vec<Unnoticed>,
    /// Hours of driving without a fault.
    pub hours: f64,
    /// What tripped in them.
    pub false_trips: Vec<String>,
}

/// The cases of one fault.
#[derive(Clone, Debug, Serialize)]
pub struct Kind {
    /// Which.
    pub fault: Fault,
    /// How many ended so, in the order of [`Verdict::ALL`].
    pub ended: [usize; Verdict::ALL.len()],
    /// From the fault until the contactors were told to open, the soonest and the latest \[ms\].
    pub opened_ms: Option<(u32, u32)>,
    /// The least time from there until a cell would have left its limits \[ms\].
    pub least_before_harm_ms: Option<u32>,
}

/// Cases of one fault that were not noticed for the same reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Unnoticed {
    /// Which fault.
    pub fault: Fault,
    /// Why it need not be noticed.
    pub reason: &'static str,
    /// How many cases.
    pub cases: usize,
}

impl Kind {
    /// How many cases there were.
    #[must_use]
    pub fn cases(&self) -> usize {
        self.ended.iter().sum()
    }

    /// Those of one fault among all; none where it was not planted.
    fn of(fault: Fault, cases: &[Judged]) -> Option<Self> {
        let of = || cases.iter().filter(|judged| judged.case.fault == fault);
        let ended = Verdict::ALL.map(|one| of().filter(|judged| judged.verdict == one).count());
        let opened_ms = of().filter_map(|judged| judged.opened_ms);
        let kind = Self {
            fault,
            ended,
            opened_ms: opened_ms.clone().min().zip(opened_ms.max()),
            least_before_harm_ms: of().filter_map(|judged| judged.before_harm_ms).min(),
        };
        Some(kind).filter(|kind| kind.cases() > 0)
    }
}

/// What was not noticed, by fault and reason.
fn unnoticed(cases: &[Judged]) -> Vec<Unnoticed> {
    let mut all: Vec<Unnoticed> = Vec::new();
    for judged in cases {
        let (fault, Some(reason)) = (judged.case.fault, judged.reason) else { continue };
        match all.iter_mut().find(|of| of.fault == fault && of.reason == reason) {
            Some(of) => of.cases += 1,
            None => all.push(Unnoticed { fault, reason, cases: 1 }),
        }
    }
    all.sort_by_key(|of| std::cmp::Reverse(of.cases));
    all
}

impl Report {
    /// Of cases, and of so many hours in which this tripped.
    #[must_use]
    pub fn new(cases: Vec<Judged>, hours: f64, false_trips: Vec<String>) -> Self {
        let kinds = Fault::ALL.into_iter().filter_map(|fault| Kind::of(fault, &cases)).collect();
        let unnoticed = unnoticed(&cases);
        Self { cases, kinds, unnoticed, hours, false_trips }
    }

    /// How many ended so.
    #[must_use]
    pub fn count(&self, verdict: Verdict) -> usize {
        self.cases.iter().filter(|judged| judged.verdict == verdict).count()
    }

    /// Whether nothing was late, missed or false.
    #[must_use]
    pub fn is_good(&self) -> bool {
        self.count(Verdict::Late) == 0
            && self.count(Verdict::Missed) == 0
            && self.false_trips.is_empty()
            && self.cases.iter().all(|judged| judged.without.is_empty())
    }

    /// The margins before harm \[ms\], sorted.
    #[must_use]
    pub fn margins_ms(&self) -> Vec<u32> {
        let mut margins: Vec<_> =
            self.cases.iter().filter_map(|judged| judged.before_harm_ms).collect();
        margins.sort_unstable();
        margins
    }
}
