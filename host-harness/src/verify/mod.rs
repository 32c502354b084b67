//! `voltstep validate`: every published experiment, and an independent solution of the same
//! equations, against what `plant-core` gives.
//!
//! | Module | What it does |
//! |---|---|
//! | `tolerance` | every target and tolerance, with its reason |
//! | `adaptive`, `composed` | the independent solver and a vehicle's continuous equations |
//! | `udds`, `bench`, `motor`, `drives`, `torque_loops`, `heated`, `pmsm`, `field_oriented`, `sampled`, `sampled_vehicle`, `components`, `circuit`, `converters`, `bridge`, `parts`, `battery_map`, `signals`, `trip` | the cases |
//! | [`experiment`] | `voltstep experiment` |
//! | [`endurance`] | `voltstep endurance` |

mod adaptive;
mod battery_map;
mod bench;
mod bridge;
mod circuit;
mod components;
#[cfg_attr(not(test), expect(dead_code, reason = "for cases of several drives"))]
mod composed;
mod converters;
mod drives;
pub mod endurance;
pub mod experiment;
mod field_oriented;
mod heated;
mod link;
mod motor;
mod parts;
mod pmsm;
mod sampled;
mod sampled_vehicle;
mod signals;
mod tolerance;
mod torque_loops;
mod trip;
mod udds;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use plant_core::powertrain::ledger::EnergyReport;
use rayon::prelude::*;
use serde::Serialize;

use crate::simulate::progress::Progress;
use tolerance::{Bound, Within};
pub use udds::{StepRow, step_sizes};

/// One figure against its target.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// The case it belongs to.
    pub name: String,
    /// The figure, with its unit.
    pub quantity: String,
    /// What the source work prints, where that is not the target.
    pub published: Option<&'static str>,
    /// What it should be; none where only its size is bounded.
    pub target: Option<f64>,
    /// Where the target comes from.
    pub source: &'static str,
    /// What it is.
    pub obtained: Option<f64>,
    /// How far it may be from the target; without one, how large.
    pub tolerance: Option<f64>,
    /// Whether it is near enough; none where it is shown for information, or skipped.
    pub pass: Option<bool>,
    /// Why this tolerance; why skipped; what went wrong.
    pub reason: String,
}

impl Check {
    fn new(case: &str, bound: &Bound, target: Option<f64>, obtained: f64) -> Self {
        let against = target.unwrap_or(f64::NAN);
        let off = (obtained - against).abs();
        let (tolerance, pass) = match bound.within {
            Within::Absolute(a) => (Some(a), Some(off <= a)),
            Within::Relative(r) => (Some(r * against.abs()), Some(off <= r * against.abs())),
            Within::Factor(f) => (
                Some(against * (f - 1.0)),
                Some(obtained >= against / f && obtained <= against * f),
            ),
            Within::AtMost(a) => (Some(a), Some(obtained.abs() <= a)),
            Within::Shown => (None, None),
        };
        Self {
            name: case.to_owned(),
            quantity: bound.quantity.to_owned(),
            published: bound.published,
            target,
            source: bound.source,
            obtained: Some(obtained),
            tolerance,
            pass,
            reason: bound.reason.to_owned(),
        }
    }

    /// A check without a figure: skipped (`pass` none), or gone wrong.
    pub(crate) fn without(case: &str, quantity: &str, pass: Option<bool>, reason: String) -> Self {
        Self {
            name: case.to_owned(),
            quantity: quantity.to_owned(),
            published: None,
            target: None,
            source: "",
            obtained: None,
            tolerance: None,
            pass,
            reason,
        }
    }
}

/// The checks of one case, as they are made.
struct Checks {
    case: &'static str,
    list: Vec<Check>,
}

impl Checks {
    const fn new(case: &'static str) -> Self {
        Self { case, list: Vec::new() }
    }

    /// Against the table's own target.
    fn add(&mut self, bound: &Bound, obtained: f64) {
        self.list.push(Check::new(self.case, bound, bound.target, obtained));
    }

    /// Against a target that a run or a closed form gave.
    fn against(&mut self, bound: &Bound, target: f64, obtained: f64) {
        self.list.push(Check::new(self.case, bound, Some(target), obtained));
    }

    /// The energy ledger of a run, and its numerical dissipation as a row of its own.
    fn ledger(&mut self, energy: &EnergyReport, numerical: &Bound) {
        self.add(&tolerance::LEDGER, f64::from(energy.residual_rel()));
        self.add(numerical, f64::from(energy.numerical / energy.throughput));
    }

    /// Something that could not be done here.
    fn skipped(&mut self, why: &str) {
        self.list.push(Check::without(self.case, "SKIPPED", None, why.to_owned()));
    }
}

/// One group of checks.
struct Case {
    name: &'static str,
    /// The models of `plant-core` that it exercises.
    models: &'static [&'static str],
    run: fn(&mut Checks) -> anyhow::Result<()>,
}

/// What a case covers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Covered {
    /// The case.
    pub name: &'static str,
    /// The models of `plant-core` that it exercises.
    pub models: &'static [&'static str],
}

/// Everything that was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ValidationReport {
    /// Every check, in a fixed order.
    pub cases: Vec<Check>,
    /// What each case covers.
    pub covered: Vec<Covered>,
    /// How many checks passed.
    pub passed: usize,
    /// How many failed.
    pub failed: usize,
    /// How many cases had to be skipped.
    pub skipped: usize,
    /// How long it took \[s\].
    pub wall_s: f64,
}

impl ValidationReport {
    /// Whether no check failed.
    #[must_use]
    pub const fn is_good(&self) -> bool {
        self.failed == 0
    }
}

/// Every case: the longest first, so that the work spreads well.
fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    cases.extend(udds::CASES);
    cases.extend(trip::CASES);
    cases.extend(bench::CASES);
    cases.extend(motor::CASES);
    cases.extend(pmsm::CASES);
    cases.extend(drives::CASES);
    cases.extend(torque_loops::CASES);
    cases.extend(heated::CASES);
    cases.extend(field_oriented::CASES);
    cases.extend(sampled::CASES);
    cases.extend(sampled_vehicle::CASES);
    cases.extend(components::CASES);
    cases.extend(parts::CASES);
    cases.extend(link::CASES);
    cases.extend(circuit::CASES);
    cases.extend(converters::CASES);
    cases.extend(bridge::CASES);
    cases.extend(battery_map::CASES);
    cases.extend(signals::CASES);
    cases
}

/// What each case covers, without running it.
#[must_use]
pub fn covered() -> Vec<Covered> {
    cases().iter().map(|c| Covered { name: c.name, models: c.models }).collect()
}

/// Runs every case, in parallel.
#[must_use]
pub fn run(progress: &dyn Progress) -> ValidationReport {
    run_all(&cases(), progress)
}

fn run_all(cases: &[Case], progress: &dyn Progress) -> ValidationReport {
    let started = Instant::now();
    let done = AtomicUsize::new(0);
    progress.at(0, cases.len(), "");
    let found: Vec<Vec<Check>> = cases
        .par_iter()
        .map(|case| {
            let mut checks = Checks::new(case.name);
            if let Err(error) = (case.run)(&mut checks) {
                let check = Check::without(case.name, "the run", Some(false), format!("{error:#}"));
                checks.list.push(check);
            }
            progress.at(1 + done.fetch_add(1, Ordering::Relaxed), cases.len(), case.name);
            checks.list
        })
        .collect();
    let cases_found: Vec<Check> = found.into_iter().flatten().collect();
    let count = |pass| cases_found.iter().filter(|c| c.pass == pass).count();
    ValidationReport {
        passed: count(Some(true)),
        failed: count(Some(false)),
        skipped: cases_found.iter().filter(|c| c.pass.is_none() && c.obtained.is_none()).count(),
        covered: cases.iter().map(|c| Covered { name: c.name, models: c.models }).collect(),
        wall_s: started.elapsed().as_secs_f64(),
        cases: cases_found,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::progress::Unseen;

    fn verdict(within: Within, target: Option<f64>, obtained: f64) -> Option<bool> {
        let bound = Bound {
            quantity: "x",
            target,
            within,
            source: "test",
            published: None,
            reason: "test",
        };
        Check::new("c", &bound, target, obtained).pass
    }

    #[test]
    fn each_kind_of_tolerance_passes_and_fails() {
        for (within, target, good, bad) in [
            (Within::Absolute(0.1), Some(2.0), [1.95, 2.05], [1.8, 2.2]),
            (Within::Relative(0.1), Some(-2.0), [-1.9, -2.1], [-1.7, -2.3]),
            (Within::Factor(2.0), Some(10.0), [5.1, 19.9], [4.9, 20.1]),
            (Within::AtMost(1e-6), None, [9e-7, -9e-7], [2e-6, -2e-6]),
        ] {
            for (good, bad) in good.into_iter().zip(bad) {
                assert_eq!(verdict(within, target, good), Some(true), "{within:?} {good}");
                assert_eq!(verdict(within, target, bad), Some(false), "{within:?} {bad}");
            }
            assert_eq!(verdict(within, target, f64::NAN), Some(false), "{within:?}");
        }
        assert_eq!(verdict(Within::Shown, Some(1.0), 2.0), None);
    }

    #[test]
    fn a_case_that_breaks_is_a_failure_and_a_skipped_one_is_not() {
        let broken: fn(&mut Checks) -> anyhow::Result<()> = |_| anyhow::bail!("on purpose");
        let skipped: fn(&mut Checks) -> anyhow::Result<()> = |checks| {
            checks.skipped("nothing there");
            Ok(())
        };
        let report = run_all(
            &[
                Case { name: "broken", models: &[], run: broken },
                Case { name: "skipped", models: &[], run: skipped },
            ],
            &Unseen,
        );
        assert_eq!((report.passed, report.failed, report.skipped), (0, 1, 1));
        assert_eq!(report.cases[0].name, "broken");
        assert_eq!(report.cases[0].reason, "on purpose");
        assert_eq!(
            (report.cases[1].reason.as_str(), report.cases[1].pass),
            ("nothing there", None)
        );
        assert!(!report.is_good());
    }

    #[test]
    fn every_case_has_its_own_name() {
        let mut names: Vec<_> = covered().iter().map(|c| c.name).collect();
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
