//! Cross-validation: what a fit says of measurements that it has not seen.

use rayon::prelude::*;
use serde::Serialize;

use super::fit::{self, Fit, Start};
use super::layout::Layout;
use super::normal::Normal;
use super::series::{Measured, Series};
use crate::read::cell::Kind;
use crate::simulate::noise::Noise;

/// Tests whose mean temperatures are closer are of one temperature \[K\].
const SAME_K: f64 = 5.0;
/// The search begins at the fit to everything: these steps bring it to where it belongs.
const STEPS: usize = 10;

/// How far a fit is from a file that it has not seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeldOut {
    /// The file.
    pub name: String,
    /// Into how many parts it was split: 1 where it was left out whole.
    pub parts: usize,
    /// Voltage \[V\].
    pub voltage_rmse_v: f64,
    /// Voltage above 15 % state of charge \[V\].
    pub voltage_rmse_v_above_15_soc: Option<f64>,
    /// Voltage above 25 % state of charge \[V\].
    pub voltage_rmse_v_above_25_soc: Option<f64>,
}

/// Which fold a block belongs to; none where it is never left out.
pub struct Folds(Vec<Vec<Option<usize>>>);

impl Folds {
    /// Drive cycles and trips are left out whole, dealt to `count` folds in an order that `seed`
    /// gives; one that is alone at its temperature is cut into `count` stretches first. Sweeps and
    /// pulse tests stay.
    pub fn new(measured: &[Measured], series: &[Series], count: usize, seed: u64) -> Self {
        let mut places: Vec<Vec<Option<usize>>> =
            series.iter().map(|s| vec![None; s.blocks]).collect();
        let mut units: Vec<(usize, Vec<usize>)> = Vec::new();
        let cycles: Vec<usize> =
            (0..measured.len()).filter(|&i| measured[i].kind == Kind::Cycle).collect();
        for &i in &cycles {
            let near = |&&j: &&usize| {
                j != i && (mean(&measured[j].celsius) - mean(&measured[i].celsius)).abs() < SAME_K
            };
            let alone = !cycles.iter().any(|j| near(&j));
            let blocks = series[i].blocks;
            let parts = if alone { count.min(blocks) } else { 1 };
            units.extend(
                (0..parts).map(|p| (i, (p * blocks / parts..(p + 1) * blocks / parts).collect())),
            );
        }
        // Fisher and Yates.
        let mut noise = Noise::new(seed);
        for last in (1..units.len()).rev() {
            units.swap(last, noise.below(last + 1));
        }
        for (n, (i, blocks)) in units.into_iter().enumerate() {
            for b in blocks {
                places[i][b] = Some(n % count);
            }
        }
        Self(places)
    }

    /// How many folds have something in them.
    pub fn used(&self) -> usize {
        self.0.iter().flatten().flatten().max().map_or(0, |last| last + 1)
    }
}

/// Fits once for each fold without it and compares with it.
///
/// # Errors
/// What `tick` says.
pub fn validate(
    measured: &[Measured],
    (series, layout): (&[Series], &Layout),
    (start, whole): (&Start, &Fit),
    folds: &Folds,
    tick: impl Fn() -> anyhow::Result<()> + Sync,
) -> anyhow::Result<Vec<HeldOut>> {
    let start = Start { parameters: whole.parameters.clone(), ..start.clone() };
    let fits: anyhow::Result<Vec<Fit>> = (0..folds.used())
        .into_par_iter()
        .map(|f| {
            let keep = |s: usize, b: usize| folds.0[s][b] != Some(f);
            fit::fit(series, layout, &start, STEPS, keep, &tick)
        })
        .collect();
    let fits = fits?;
    let mut rows = Vec::new();
    for (i, places) in folds.0.iter().enumerate() {
        let mut sum = Normal::new(layout.len());
        for (b, fold) in places.iter().enumerate() {
            if let Some(f) = fold {
                sum.add(&fits[*f].blocks[i][b]);
            }
        }
        let [all, above_15, above_25] = sum.rms();
        let mut parts: Vec<usize> = places.iter().flatten().copied().collect();
        parts.sort_unstable();
        parts.dedup();
        if let Some(all) = all {
            rows.push(HeldOut {
                name: measured[i].name.clone(),
                parts: parts.len(),
                voltage_rmse_v: all,
                voltage_rmse_v_above_15_soc: above_15,
                voltage_rmse_v_above_25_soc: above_25,
            });
        }
    }
    Ok(rows)
}

#[expect(clippy::cast_precision_loss, reason = "a count")]
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
