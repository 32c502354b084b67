//! The identification of a battery, end to end.

use std::path::PathBuf;

use anyhow::{Context, ensure};

use super::capacity::Estimate;
use super::cross::{self, Folds, HeldOut};
use super::fit::{self, Fit, MOST_STEPS, Smoothing, Start};
use super::input;
use super::layout::{self, ACTIVATION_UNIT_K, BRANCHES, Layout, place};
use super::normal::Normal;
use super::series::{LOWEST_SOC, Measured, Series, coldness};
use super::telling::{agree, excited, told};
use super::thermal::{self, Node};
use crate::read::cell::{CellRecord, Kind};
use crate::read::trip::Trip;

/// The resistances' dependence on temperature shows where the temperature spans this \[K\].
const TELLING_K: f64 = 10.0;
/// … and the tables where the state of charge spans this.
const TELLING_SOC: f64 = 0.1;
/// Where the search begins: time constants \[s\], activation temperature \[kK\].
const START_TAU_S: [f64; 2] = [10.0, 150.0];
const START_ACTIVATION: f64 = 2.5;
/// Delays of the current that are tried, in samples, on a fit of a few steps.
const DELAYS: [f64; 3] = [0.0, 1.0, 2.0];
const DELAY_STEPS: usize = 5;
/// A slower logger hides any delay \[s\].
const DELAY_SAMPLING_S: f64 = 1.0;
/// A second branch this much slower than the first, at least.
const APART: f64 = 1.5;

/// What is known beforehand, and how to validate.
#[derive(Clone, Debug)]
pub struct Options {
    /// Name of the battery.
    pub name: String,
    /// What it is, in one line.
    pub description: String,
    /// Where the measurements come from.
    pub source: String,
    /// The command, for the file.
    pub command: String,
    /// Capacity where it is known \[A·h\].
    pub capacity_ah: Option<f64>,
    /// Largest discharge current \[A\]; infinity for none.
    pub discharge_limit_a: f64,
    /// Largest charge current \[A\]; infinity for none.
    pub charge_limit_a: f64,
    /// Folds of the cross-validation.
    pub folds: usize,
    /// Seed of the order in which files are dealt to folds.
    pub seed: u64,
}

/// A battery, and how well it is known.
#[derive(Clone, Debug)]
pub struct Identified {
    /// What was asked for.
    pub options: Options,
    /// Trips, or tests of a cell.
    pub of_trips: bool,
    /// Names of the files that were fitted.
    pub files: Vec<String>,
    /// Charge between empty and full \[A·h\].
    pub capacity: Estimate,
    pub(super) layout: Layout,
    pub(super) parameters: Vec<f64>,
    pub(super) errors: Vec<f64>,
    /// Whether there is a second RC branch.
    pub second_branch: bool,
    /// The thermal node where the measurements tell it.
    pub thermal: Option<Node>,
    /// By how much the logged current leads the logged voltage \[s\].
    pub current_delay_s: f64,
    /// The state of charge for which resistances were identified.
    pub soc: (f64, f64),
    /// The temperature for which they were \[°C\].
    pub celsius: (f64, f64),
    /// Over all that was fitted \[V\].
    pub voltage_rmse_v: f64,
    /// How far it is from files that it was not fitted to.
    pub held_out: Vec<HeldOut>,
    /// What the reader should know.
    pub notes: Vec<String>,
}

/// Says how far it is; may end the work.
pub type Tick<'a> = &'a (dyn Fn(&str) -> anyhow::Result<()> + Sync);

/// Identifies a battery from files, and from the CSV files in folders.
///
/// # Errors
/// A file that cannot be read, trips among tests, measurements that do not tell a battery; what
/// `tick` says.
pub fn identify(inputs: &[PathBuf], options: Options, tick: Tick) -> anyhow::Result<Identified> {
    tick("reading")?;
    let (trips, cells) = input::read(inputs)?;
    of_records(trips, cells, options, tick)
}

/// Identifies a battery from what was read: trips or tests of a cell.
///
/// # Errors
/// Measurements that do not tell a battery; what `tick` says.
pub fn of_records(
    trips: Vec<Trip>,
    cells: Vec<CellRecord>,
    options: Options,
    tick: Tick,
) -> anyhow::Result<Identified> {
    let mut notes = Vec::new();
    let of_trips = !trips.is_empty();
    let (capacity, measured) = if of_trips {
        input::from_trips(trips, options.capacity_ah, &mut notes)?
    } else {
        input::from_cells(&cells, options.capacity_ah, &mut notes)?
    };
    let (soc, celsius) = spans(&measured);
    ensure!(
        soc.1 - soc.0 >= TELLING_SOC,
        "the state of charge spans {:.1} %: too little for an open-circuit curve (at least {:.0} %)",
        100.0 * (soc.1 - soc.0),
        100.0 * TELLING_SOC
    );
    let layout = Layout::over(soc, LOWEST_SOC).context("the state of charge spans too little")?;
    let level = excited(&measured, capacity.value);
    let curve_only = level.is_err() && measured.iter().all(|m| m.kind == Kind::Sweep);
    if !curve_only {
        level?;
    }

    let mut start = Start::new(&layout, START_TAU_S, START_ACTIVATION);
    if celsius.1 - celsius.0 < TELLING_K {
        start.hold((0..BRANCHES).map(|b| layout.activation(b)), 0.0);
        notes.push(format!(
            "the temperature spans {:.1} K: no dependence on temperature can be told, the \
             activation temperatures are 0",
            celsius.1 - celsius.0
        ));
    }
    if curve_only {
        without_resistance(&mut start, &layout, &measured, &mut notes);
    }
    let current_delay_s = if curve_only { 0.0 } else { delay(&measured, &layout, &start, tick)? };
    let series: Vec<Series> = measured.iter().map(|m| m.placed(&layout, current_delay_s)).collect();
    let (mut start, first) = if curve_only {
        let first = fit::fit(&series, &layout, &start, MOST_STEPS, |_, _| true, || tick("fit"))?;
        (start, first)
    } else {
        branches(&series, &layout, start, &mut notes, tick)?
    };
    start.smoothing = Smoothing::expected(&layout, &first);
    start.parameters = first.parameters;
    let found = fit::fit(&series, &layout, &start, MOST_STEPS, |_, _| true, || tick("fit"))?;
    told(&measured, &found.parameters[layout.voltages()])?;
    let mut sum = Normal::new(layout.len());
    found.blocks.iter().flatten().for_each(|b| sum.add(b));
    let voltage_rmse_v = sum.rms()[0].unwrap_or(f64::NAN);
    let resists = (0..BRANCHES).any(|b| layout.resistances(b).any(|i| found.parameters[i] > 0.0));
    agree(&measured, resists || curve_only, voltage_rmse_v)?;
    let errors = fit::standard_errors(&layout, &start, &found);
    let second_branch = start.free[layout.log_tau(2)];
    uncertain(&layout, &found, &errors, second_branch, &mut notes);

    tick("thermal node")?;
    let at = |range, points, soc| layout::at(&found.parameters[range], place(points, soc));
    let open_circuit_v = |soc| at(layout.voltages(), &layout.ocv, soc);
    let series_ohm = |soc, celsius| {
        let activation = found.parameters[layout.activation(0)] * ACTIVATION_UNIT_K;
        at(layout.resistances(0), &layout.ohm, soc) * (activation * coldness(celsius)).exp()
    };
    // A pulse test begins anew after each gap, at a temperature of its own.
    let cycles = measured.iter().filter(|m| m.kind == Kind::Cycle && thermal::tells(m));
    let node = thermal::node(&cycles.collect::<Vec<_>>(), open_circuit_v, series_ohm);
    if node.is_none() && !of_trips {
        notes.push(
            "no test tells the thermal node: it needs the measured temperature of the \
             surroundings and a cell that warms by 1 K"
                .to_owned(),
        );
    }

    let folds = Folds::new(&measured, &series, options.folds, options.seed);
    let held_out = if folds.used() < 2 {
        notes.push("too few drive cycles to leave any out: no cross-validation".to_owned());
        Vec::new()
    } else {
        tick("cross-validation")?;
        cross::validate(&measured, (&series, &layout), (&start, &found), &folds, || {
            tick("cross-validation")
        })?
    };
    let (lowest, highest) = (layout.ohm[0].max(soc.0), soc.1.min(1.0));
    Ok(Identified {
        options,
        of_trips,
        files: measured.iter().map(|m| m.name.clone()).collect(),
        capacity,
        parameters: found.parameters,
        errors,
        second_branch,
        thermal: node,
        current_delay_s,
        soc: (lowest, highest),
        celsius,
        voltage_rmse_v,
        held_out,
        notes,
        layout,
    })
}

/// The ranges of state of charge and temperature.
fn spans(measured: &[Measured]) -> ((f64, f64), (f64, f64)) {
    let over = |pick: fn(&Measured) -> &Vec<f64>| {
        measured
            .iter()
            .flat_map(pick)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |r, x| (r.0.min(*x), r.1.max(*x)))
    };
    let (low, high) = over(|m| &m.soc);
    ((low.max(0.0), high.min(1.0)), over(|m| &m.celsius))
}

/// Holds every resistance at zero, and says what the curve is then.
fn without_resistance(
    start: &mut Start,
    layout: &Layout,
    measured: &[Measured],
    notes: &mut Vec<String>,
) {
    start.hold((0..BRANCHES).flat_map(|b| layout.resistances(b)), 0.0);
    start.hold((0..BRANCHES).map(|b| layout.activation(b)), 0.0);
    for (b, tau_s) in (1..BRANCHES).zip(START_TAU_S) {
        start.hold([layout.log_tau(b)], tau_s.ln());
    }
    let mut amps: Vec<f64> = measured.iter().flat_map(|m| m.current_a.iter().copied()).collect();
    amps.sort_unstable_by(f64::total_cmp);
    notes.push(format!(
        "no test varies the current: none tells a resistance, and the curve is the voltage under \
         {:.3} A, off by what that drops: add pulses or a drive cycle",
        amps.get(amps.len() / 2).copied().unwrap_or(f64::NAN)
    ));
}

/// By how much the logged current leads the logged voltage: the delay, in whole samples, with the
/// least squares.
fn delay(measured: &[Measured], layout: &Layout, start: &Start, tick: Tick) -> anyhow::Result<f64> {
    let cycles: Vec<&Measured> = measured.iter().filter(|m| m.kind == Kind::Cycle).collect();
    let sampling_s = cycles.iter().map(|m| m.sampling_s()).fold(f64::INFINITY, f64::min);
    if sampling_s > DELAY_SAMPLING_S {
        return Ok(0.0);
    }
    let mut best = (f64::INFINITY, 0.0);
    for samples in DELAYS {
        // Whole milliseconds: what a sampling time means.
        let delay_s = (1e3 * samples * sampling_s).round() / 1e3;
        let series: Vec<Series> = cycles.iter().map(|m| m.placed(layout, delay_s)).collect();
        let found = fit::fit(&series, layout, start, DELAY_STEPS, |_, _| true, || tick("delay"))?;
        let squares = found.blocks.iter().flatten().map(|b| b.squares).sum();
        if squares < best.0 {
            best = (squares, delay_s);
        }
    }
    Ok(best.1)
}

/// Two branches, or one where the measurements do not tell two apart.
fn branches(
    series: &[Series],
    layout: &Layout,
    start: Start,
    notes: &mut Vec<String>,
    tick: Tick,
) -> anyhow::Result<(Start, Fit)> {
    let mut found = fit::fit(series, layout, &start, MOST_STEPS, |_, _| true, || tick("fit"))?;
    let tau = |fit: &Fit, b: usize| fit.parameters[layout.log_tau(b)].exp();
    let none = |b: usize| found.parameters[layout.resistances(b)].iter().all(|r| *r <= 0.0);
    let ratio = tau(&found, 2) / tau(&found, 1);
    if none(1) || none(2) || (1.0 / APART..APART).contains(&ratio) {
        notes.push("the measurements do not tell two RC branches apart: there is one".to_owned());
        let mut one = start;
        let second = layout.resistances(2).chain([layout.activation(2), layout.log_tau(2)]);
        one.hold(second, 0.0);
        found = fit::fit(series, layout, &one, MOST_STEPS, |_, _| true, || tick("fit"))?;
        return Ok((one, found));
    }
    if ratio < 1.0 {
        // The faster first: the same search, from the other side.
        let mut swapped = start.clone();
        for (a, b) in layout
            .resistances(1)
            .chain([layout.log_tau(1), layout.activation(1)])
            .zip(layout.resistances(2).chain([layout.log_tau(2), layout.activation(2)]))
        {
            (swapped.parameters[a], swapped.parameters[b]) =
                (found.parameters[b], found.parameters[a]);
        }
        found = fit::fit(series, layout, &swapped, MOST_STEPS, |_, _| true, || tick("fit"))?;
    }
    Ok((start, found))
}

/// Says which parameters are poorly identifiable: their standard error is not small beside them.
fn uncertain(
    layout: &Layout,
    fit: &Fit,
    errors: &[f64],
    second_branch: bool,
    notes: &mut Vec<String>,
) {
    const POOR: f64 = 0.5;
    let names = ["series resistance", "first RC branch", "second RC branch"];
    for (b, name) in names.iter().enumerate().take(if second_branch { 3 } else { 2 }) {
        if b > 0 && errors[layout.log_tau(b)] > POOR {
            notes.push(format!("the time constant of the {name} is poorly identifiable"));
        }
        let at = layout.activation(b);
        if errors[at] > POOR * fit.parameters[at] {
            notes.push(format!("the activation temperature of the {name} is poorly identifiable"));
        }
        let weak = layout.resistances(b).filter(|&i| errors[i] > POOR * fit.parameters[i]).count();
        if weak > 0 {
            let points = layout.ohm.len();
            notes.push(format!("{weak} of {points} points of the {name} are poorly identifiable"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_far_from_what_was_measured_is_refused() {
        let record = CellRecord {
            time_s: vec![0.0, 1.0],
            current_a: vec![0.0, 1.0],
            voltage_v: vec![4.2, 2.5],
            discharged_ah: vec![0.0, 3.0],
            cell_c: vec![25.0; 2],
            chamber_c: vec![25.0; 2],
            ..CellRecord::default()
        };
        let measured = [Measured::of_cell(&record, 3.0)];
        assert!(told(&measured, &[2.4, 3.7, 4.25]).is_ok());
        for ocv in [[0.0, 0.5, 0.95], [3.0, 3.7, 17.0]] {
            let said = told(&measured, &ocv).unwrap_err().to_string();
            assert!(said.contains("do not tell the open-circuit voltage"), "{said}");
        }
    }
}
