//! Least squares with bounds: Levenberg-Marquardt steps (Marquardt1963), each a non-negative least
//! squares problem (`LawsonHanson1974`, ch. 23), since resistances, activation temperatures and
//! steps of the open-circuit voltage cannot be negative.

use anyhow::Context;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use ndarray::{Array1, Array2};

use super::layout::{BRANCHES, Layout};
use super::normal::{Normal, equations};
use super::series::Series;

/// The search ends where the squares fall by less than this share.
const CONVERGED: f64 = 1e-9;
/// Steps that are enough from afar.
pub const MOST_STEPS: usize = 60;
/// Logarithms of time constants move by no more than this in a step.
const LONGEST_LOG_STEP: f64 = 1.0;
/// Damping at the start, as a share of the diagonal.
const DAMPING: f64 = 1e-3;
/// In a first fit neighbouring points of a table pull on each other by this share of what the
/// samples of a point do: that tells where no sample does.
const FIRST_SMOOTHING_V: f64 = 1e-5;
const FIRST_SMOOTHING_OHM: f64 = 1e-3;
/// Then by what is expected of a battery before it is measured, as standard deviations. Of the bend
/// of the open-circuit curve at a point, as a share of its mean …
const BEND_V: f64 = 5e-3;
/// … of the bend of a resistance, as a share of its mean …
const BEND_OHM: f64 = 3.0;
/// … and of the difference of two activation temperatures, in their unit.
const ACTIVATIONS_APART: f64 = 1.5;
/// A share of the diagonal that keeps what no sample moves from being singular.
const RIDGE: f64 = 1e-10;

/// Which parameters are free, where the search begins, and what smooths the tables.
#[derive(Clone, Debug)]
pub struct Start {
    pub parameters: Vec<f64>,
    pub free: Vec<bool>,
    pub smoothing: Smoothing,
}

/// What second differences of the tables and differences of the activation temperatures cost.
#[derive(Clone, Debug)]
pub enum Smoothing {
    /// A share of what the samples say.
    First,
    /// As much as what was expected is worth beside the samples: squares of the voltage for each
    /// unit of the open-circuit curve, of each branch's resistance, of the activation temperatures.
    Expected { volts: f64, ohm: [f64; BRANCHES], activation: f64 },
}

impl Smoothing {
    /// What is expected of a battery beside samples that a first fit leaves with such residuals.
    ///
    /// Residuals follow each other for minutes, so that a thousand samples may tell no more than ten
    /// independent ones: what a sample is worth shows in how far the pulls of the blocks on the
    /// open-circuit voltages scatter (the "meat" of a sandwich estimate, Huber1967).
    pub fn expected(layout: &Layout, fit: &Fit) -> Self {
        let len = layout.len();
        let (mut pulls, mut weight) = (0.0, 0.0);
        for block in fit.blocks.iter().flatten() {
            for i in layout.voltages() {
                pulls += block.pull[i] * block.pull[i];
                weight += block.gram[i * len + i];
            }
        }
        let squares = if weight > 0.0 { pulls / weight } else { 0.0 };
        let worth = |expected: f64| {
            if expected > 0.0 { squares / (expected * expected) } else { 0.0 }
        };
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let mean = |range: std::ops::Range<usize>| {
            let count = range.len() as f64;
            range.map(|i| fit.parameters[i]).sum::<f64>() / count
        };
        Self::Expected {
            volts: worth(BEND_V * mean(layout.voltages())),
            ohm: std::array::from_fn(|b| worth(BEND_OHM * mean(layout.resistances(b)))),
            activation: worth(ACTIVATIONS_APART),
        }
    }
}

impl Start {
    /// Two branches, `tau_s` apart, and common activation temperatures \[kK\].
    pub fn new(layout: &Layout, tau_s: [f64; 2], activation: f64) -> Self {
        let mut parameters = vec![0.0; layout.len()];
        for (branch, tau_s) in tau_s.into_iter().enumerate() {
            parameters[layout.log_tau(branch + 1)] = tau_s.ln();
        }
        for branch in 0..BRANCHES {
            parameters[layout.activation(branch)] = activation;
        }
        Self { parameters, free: vec![true; layout.len()], smoothing: Smoothing::First }
    }

    /// Holds parameters at a value.
    pub fn hold(&mut self, which: impl IntoIterator<Item = usize>, value: f64) {
        for i in which {
            (self.parameters[i], self.free[i]) = (value, false);
        }
    }
}

/// What a fit came to.
#[derive(Clone, Debug)]
pub struct Fit {
    pub parameters: Vec<f64>,
    /// The sums of each block of each series there.
    pub blocks: Vec<Vec<Normal>>,
    /// Parameters that are free and not at their bound.
    pub moving: Vec<usize>,
}

/// Finds the parameters that fit the blocks that `keep` (series, block) names; `tick` is called
/// before each step and may end the search.
///
/// # Errors
/// What `tick` says.
pub fn fit(
    series: &[Series],
    layout: &Layout,
    start: &Start,
    most_steps: usize,
    keep: impl Fn(usize, usize) -> bool,
    mut tick: impl FnMut() -> anyhow::Result<()>,
) -> anyhow::Result<Fit> {
    let total = |blocks: &[Vec<Normal>]| {
        let mut sum = Normal::new(layout.len());
        for (s, blocks) in blocks.iter().enumerate() {
            blocks.iter().enumerate().filter(|(b, _)| keep(s, *b)).for_each(|(_, n)| sum.add(n));
        }
        sum
    };
    let mut parameters = start.parameters.clone();
    tick()?;
    let mut blocks = equations(series, layout, &parameters);
    let mut problem = Problem::new(layout, start, total(&blocks), &parameters);
    let mut damping = DAMPING;
    for _ in 0..most_steps {
        tick()?;
        let next = problem.step(&parameters, damping)?;
        let next_blocks = equations(series, layout, &next);
        let next_problem = Problem::new(layout, start, total(&next_blocks), &next);
        if next_problem.cost() <= problem.cost() {
            let converged = problem.cost() - next_problem.cost() < CONVERGED * problem.cost();
            (parameters, blocks, problem) = (next, next_blocks, next_problem);
            damping = (damping / 10.0).max(1e-9);
            if converged && damping < DAMPING {
                break;
            }
        } else {
            damping *= 10.0;
            if damping > 1e6 {
                break;
            }
        }
    }
    let moving = problem.moving(&parameters);
    Ok(Fit { parameters, blocks, moving })
}

/// Standard errors of every parameter, NaN for one that is held or at its bound: a delete-one-block
/// jackknife, each block left out to first order. Residuals within a block may follow each other as
/// they like; with few blocks it errs on the large side (`BellMcCaffrey2002`; `MacKinnon2023`,
/// where it is called CV3).
pub fn standard_errors(layout: &Layout, start: &Start, fit: &Fit) -> Vec<f64> {
    let blocks: Vec<&Normal> = fit.blocks.iter().flatten().filter(|b| b.counts()).collect();
    let mut sum = Normal::new(layout.len());
    for block in &blocks {
        sum.add(block);
    }
    let problem = Problem::new(layout, start, sum, &fit.parameters);
    let mut squares = vec![0.0; layout.len()];
    for block in &blocks {
        let moved = problem.without(block, &fit.moving);
        for (i, square) in squares.iter_mut().enumerate() {
            *square += moved.as_ref().map_or(f64::INFINITY, |m| m[i] * m[i]);
        }
    }
    #[expect(clippy::cast_precision_loss, reason = "a count")]
    let share = 1.0 - 1.0 / blocks.len() as f64;
    let mut errors: Vec<f64> = squares.iter().map(|s| (share * s).sqrt()).collect();
    for (i, error) in errors.iter_mut().enumerate() {
        let still = *error == 0.0 || !start.free[i];
        if still {
            *error = f64::NAN;
        }
    }
    errors
}

/// The quadratic around one point, in coordinates that are not negative: the lowest open-circuit
/// voltage and its steps from point to point, resistances, activation temperatures.
pub struct Problem<'a> {
    layout: &'a Layout,
    free: Vec<usize>,
    gram: DMatrix<f64>,
    pull: DVector<f64>,
    squares: f64,
    penalty: DMatrix<f64>,
    at: DVector<f64>,
}

impl<'a> Problem<'a> {
    pub fn new(layout: &'a Layout, start: &Start, sum: Normal, parameters: &[f64]) -> Self {
        let len = layout.len();
        let full = DMatrix::from_row_slice(len, len, &sum.gram);
        let gram = DMatrix::from_fn(len, len, |i, j| full[(i.min(j), i.max(j))]);
        let steps = steps(layout);
        let penalty = penalty(layout, &gram, &start.smoothing);
        Self {
            layout,
            free: (0..len).filter(|&i| start.free[i]).collect(),
            gram: steps.tr_mul(&gram) * &steps,
            pull: steps.tr_mul(&DVector::from_vec(sum.pull)),
            squares: sum.squares,
            penalty: steps.tr_mul(&penalty) * &steps,
            at: to_steps(layout, parameters),
        }
    }

    /// The squares, and what smoothing adds.
    fn cost(&self) -> f64 {
        self.squares + self.at.dot(&(&self.penalty * &self.at))
    }

    /// The parameters after one step.
    fn step(&self, parameters: &[f64], damping: f64) -> anyhow::Result<Vec<f64>> {
        let first = self.layout.first_nonlinear();
        let taus = [self.layout.log_tau(1), self.layout.log_tau(2)];
        let mut matrix = &self.gram + &self.penalty;
        let mut goal = &self.gram * &self.at + &self.pull;
        for i in first..self.layout.len() {
            let extra = damping * self.gram[(i, i)];
            matrix[(i, i)] += extra;
            goal[i] += extra * self.at[i];
        }
        // A logarithm may be negative: it is counted from its longest step back.
        let shift = DVector::from_fn(self.layout.len(), |i, _| {
            if taus.contains(&i) { self.at[i] - LONGEST_LOG_STEP } else { 0.0 }
        });
        // What is held stays where it is.
        let held = DVector::from_fn(self.layout.len(), |i, _| {
            if self.free.contains(&i) { shift[i] } else { self.at[i] }
        });
        let goal = goal - &matrix * &held;
        let found = non_negative(&matrix, &goal, &self.free)?;
        let mut at = held;
        for (&i, x) in self.free.iter().zip(found) {
            at[i] += x;
        }
        for i in taus {
            at[i] = at[i].min(self.at[i] + LONGEST_LOG_STEP);
        }
        let mut next = from_steps(self.layout, &at);
        for (i, value) in next.iter_mut().enumerate() {
            if !self.free.contains(&i) {
                *value = parameters[i];
            }
        }
        Ok(next)
    }

    /// Parameters that are free and not at their bound, as steps.
    fn moving(&self, parameters: &[f64]) -> Vec<usize> {
        let at = to_steps(self.layout, parameters);
        let taus = [self.layout.log_tau(1), self.layout.log_tau(2)];
        let inside = |&i: &usize| taus.contains(&i) || at[i] > 0.0;
        self.free.iter().copied().filter(inside).collect()
    }

    /// The change of the parameters when `block` is left out, to first order, where `moving` move.
    pub fn without(&self, block: &Normal, moving: &[usize]) -> Option<Vec<f64>> {
        let all = Start::new(self.layout, [1.0; 2], 0.0);
        let part = Problem::new(self.layout, &all, block.clone(), &vec![0.0; self.layout.len()]);
        let matrix = &self.gram + &self.penalty - &part.gram;
        let small = factored(&matrix, moving)?;
        let pull = DVector::from_fn(moving.len(), |i, _| -part.pull[moving[i]]);
        let found = small.solve(&pull);
        let mut at = DVector::zeros(self.layout.len());
        for (&i, x) in moving.iter().zip(found.iter()) {
            at[i] = *x;
        }
        Some(from_steps(self.layout, &at))
    }
}

/// The factor of a part of a matrix, with a ridge.
fn factored(matrix: &DMatrix<f64>, which: &[usize]) -> Option<Cholesky<f64, Dyn>> {
    let small = DMatrix::from_fn(which.len(), which.len(), |i, j| {
        let ridge = if i == j { 1.0 + RIDGE } else { 1.0 };
        matrix[(which[i], which[j])] * ridge + if i == j { f64::MIN_POSITIVE } else { 0.0 }
    });
    Cholesky::new(small)
}

/// The least of `½xᵀMx − gᵀx` over `x ≥ 0`, for the parameters in `free`.
pub(super) fn non_negative(
    matrix: &DMatrix<f64>,
    goal: &DVector<f64>,
    free: &[usize],
) -> anyhow::Result<Vec<f64>> {
    let n = free.len();
    // Parameters differ by orders of magnitude in what they move: each is counted in its own unit.
    let unit: Vec<f64> = free.iter().map(|&i| 1.0 / matrix[(i, i)].sqrt().max(1e-150)).collect();
    let scaled = DMatrix::from_fn(n, n, |i, j| {
        let ridge = if i == j { RIDGE } else { 0.0 };
        matrix[(free[i], free[j])] * unit[i] * unit[j] + ridge
    });
    let factor = Cholesky::new(scaled).context(
        "the measurements do not tell every parameter: add a slow discharge of a full cell or a drive \
         cycle without gaps",
    )?;
    let right = DVector::from_fn(n, |i, _| goal[free[i]] * unit[i]);
    let right = factor.l_dirty().solve_lower_triangular(&right).context("no solution")?;
    let lower = factor.l();
    let root = Array2::from_shape_fn((n, n), |(i, j)| lower[(j, i)]);
    let (found, _) = nnls::nnls(root.view(), Array1::from_iter(right.iter().copied()).view());
    Ok(found.iter().zip(unit).map(|(x, unit)| x * unit).collect())
}

/// From steps of the open-circuit voltage to its values; the rest as it is.
fn steps(layout: &Layout) -> DMatrix<f64> {
    let n = layout.ocv.len();
    DMatrix::from_fn(layout.len(), layout.len(), |i, j| {
        f64::from(u8::from(i == j || (i < n && j < i)))
    })
}

fn from_steps(layout: &Layout, at: &DVector<f64>) -> Vec<f64> {
    let mut values: Vec<f64> = at.iter().copied().collect();
    for i in layout.voltages().skip(1) {
        values[i] += values[i - 1];
    }
    values
}

fn to_steps(layout: &Layout, values: &[f64]) -> DVector<f64> {
    let inside = layout.voltages();
    DVector::from_fn(values.len(), |i, _| {
        if i > 0 && inside.contains(&i) { values[i] - values[i - 1] } else { values[i] }
    })
}

/// The quadratic form of the smoothing.
fn penalty(layout: &Layout, gram: &DMatrix<f64>, smoothing: &Smoothing) -> DMatrix<f64> {
    let mut penalty = DMatrix::zeros(layout.len(), layout.len());
    let tables =
        std::iter::once(layout.voltages()).chain((0..BRANCHES).map(|b| layout.resistances(b)));
    for (which, table) in tables.enumerate() {
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let mean = table.clone().map(|i| gram[(i, i)]).sum::<f64>() / table.len() as f64;
        let cost = match (smoothing, which) {
            (Smoothing::First, 0) => FIRST_SMOOTHING_V * mean,
            (Smoothing::First, _) => FIRST_SMOOTHING_OHM * mean,
            (Smoothing::Expected { volts, .. }, 0) => *volts,
            (Smoothing::Expected { ohm, .. }, branch) => ohm[branch - 1],
        };
        for i in table.start..table.end.saturating_sub(2) {
            for (j, a) in [1.0, -2.0, 1.0].into_iter().enumerate() {
                for (k, b) in [1.0, -2.0, 1.0].into_iter().enumerate() {
                    penalty[(i + j, i + k)] += cost * a * b;
                }
            }
        }
    }
    if let Smoothing::Expected { activation, .. } = smoothing {
        // What warms the one warms the others.
        let first = layout.activation(0);
        for other in (1..BRANCHES).map(|b| layout.activation(b)) {
            for (i, j, sign) in [
                (first, first, 1.0),
                (other, other, 1.0),
                (first, other, -1.0),
                (other, first, -1.0),
            ] {
                penalty[(i, j)] += sign * activation;
            }
        }
    }
    penalty
}
