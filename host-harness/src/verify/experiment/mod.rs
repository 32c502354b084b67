//! `voltstep experiment`: the experiments of the reference system and of circuits, each with its figures beside
//! what was published, and what happened over time.
//!
//! The runs themselves are those of the cases beside this folder.

mod bench;
mod bridge;
mod converters;
mod motor;
mod pmsm;
mod udds;

use serde::Serialize;

use super::{Check, Checks};
use crate::read::error::{InputError, listed, nearest, shown};

/// One experiment.
#[derive(Clone, Copy)]
pub struct Experiment {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is.
    pub title: &'static str,
    /// Where it comes from, by the keys of the bibliography.
    pub source: &'static str,
    run: fn() -> anyhow::Result<(Vec<Check>, Record)>,
}

/// Every experiment.
pub const EXPERIMENTS: &[Experiment] = &[
    motor::STEP,
    bench::BENCH,
    udds::ENERGY,
    pmsm::START,
    pmsm::WEAKENING,
    converters::PRECHARGE,
    converters::BUCK_CONVERTER,
    converters::BOOST_CONVERTER,
    converters::H_BRIDGE,
    bridge::START,
    bridge::OPEN,
    bridge::SHORTED,
];

/// What an experiment came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// The experiment's name.
    pub name: &'static str,
    /// What it is.
    pub title: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Every figure beside its target.
    pub figures: Vec<Check>,
    /// What happened over time.
    #[serde(skip)]
    pub record: Record,
}

impl Outcome {
    /// Whether no figure is off.
    #[must_use]
    pub fn is_good(&self) -> bool {
        self.figures.iter().all(|f| f.pass != Some(false))
    }
}

/// What a line of a plot is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// What was asked for, or a closed form.
    Reference,
    /// Measured.
    Measured,
    /// What the plant did.
    Simulated,
}

/// A line of a plot; a column of the trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// Its name in the trace, with the unit.
    pub column: &'static str,
    /// Its name in the plot.
    pub label: &'static str,
    /// What it is.
    pub role: Role,
}

/// A plot over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Panel {
    /// The quantity.
    pub title: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Its lines.
    pub lines: &'static [Line],
}

/// What happened over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// How it is plotted.
    pub panels: &'static [Panel],
    /// The time of each row \[s\].
    pub time_s: Vec<f64>,
    /// The values of each line, in the order of the panels; NaN where there is none.
    pub columns: Vec<Vec<f64>>,
    /// Where the energy went at the end: names, values.
    pub energy: Vec<(String, f64)>,
    /// The unit of these.
    pub energy_unit: &'static str,
}

impl Record {
    /// Nothing yet.
    fn new(panels: &'static [Panel]) -> Self {
        let lines = panels.iter().map(|p| p.lines.len()).sum();
        Self {
            panels,
            time_s: Vec::new(),
            columns: vec![Vec::new(); lines],
            energy: Vec::new(),
            energy_unit: "",
        }
    }

    /// The lines, in the order of the columns.
    pub fn lines(&self) -> impl Iterator<Item = &'static Line> {
        self.panels.iter().flat_map(|p| p.lines)
    }

    /// Keeps a row: a value for each line.
    fn keep<const N: usize>(&mut self, time_s: f64, row: [f64; N]) {
        debug_assert_eq!(N, self.columns.len());
        self.time_s.push(time_s);
        for (column, value) in self.columns.iter_mut().zip(row) {
            column.push(value);
        }
    }
}

const fn line(column: &'static str, label: &'static str, role: Role) -> Line {
    Line { column, label, role }
}

/// The checks of one case, made by `run`.
fn checks(
    case: &'static str,
    run: impl FnOnce(&mut Checks) -> anyhow::Result<()>,
) -> anyhow::Result<Vec<Check>> {
    let mut checks = Checks::new(case);
    run(&mut checks)?;
    Ok(checks.list)
}

/// The experiment of that name.
///
/// # Errors
/// [`InputError`] lists those that there are.
pub fn by_name(name: &str) -> Result<&'static Experiment, InputError> {
    let names = || EXPERIMENTS.iter().map(|e| e.name);
    EXPERIMENTS.iter().find(|e| e.name == name).ok_or_else(|| {
        let near =
            nearest(name, names()).map_or(String::new(), |n| format!("; did you mean `{n}`?"));
        let message = format!("no such experiment{near} (there are: {})", listed(names()));
        InputError::of_file(&shown(name), message)
    })
}

impl Experiment {
    /// Runs it.
    ///
    /// # Errors
    /// A run that diverged.
    pub fn run(&self) -> anyhow::Result<Outcome> {
        let (figures, record) = (self.run)()?;
        let Self { name, title, source, .. } = *self;
        Ok(Outcome { name, title, source, figures, record })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_figure_that_is_off_spoils_an_experiment() {
        let figure = |pass| Check::without("case", "figure", pass, String::new());
        let good = |figures| {
            let record = Record::new(&[]);
            Outcome { name: "x", title: "x", source: "x", figures, record }.is_good()
        };
        assert!(good(vec![figure(Some(true)), figure(None)]));
        assert!(!good(vec![figure(Some(true)), figure(Some(false))]));
    }

    #[test]
    fn lines_have_names_of_their_own() {
        for experiment in EXPERIMENTS {
            let record = experiment.run().unwrap().record;
            let mut names: Vec<_> = record.lines().map(|l| l.column).collect();
            let count = names.len();
            names.sort_unstable();
            names.dedup();
            assert_eq!(names.len(), count, "{}", experiment.name);
        }
    }
}
