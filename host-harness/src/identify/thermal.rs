//! The thermal node: heat capacity and cooling from the temperature of a cell in surroundings whose
//! temperature was measured.

use nalgebra::{Matrix2, Vector2};

use super::capacity::Estimate;
use super::series::Measured;

/// Surroundings that differ from the cell by more at the start were not logged right \[K\].
const AMBIENT_K: f64 = 5.0;
/// A cell must warm by this to tell anything \[K\].
const TELLING_K: f64 = 1.0;
const STEPS: usize = 30;
/// The temperature in the middle of this time is its mean \[s\].
const START_S: f64 = 10.0;
/// A new block begins where the state of charge has moved by this.
const BLOCK_SOC: f64 = 0.1;

/// A thermal node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Heat capacity \[J/K\].
    pub heat_capacity_j_per_k: Estimate,
    /// Cooling to the surroundings \[W/K\].
    pub cooling_w_per_k: Estimate,
    /// Temperature of the surroundings in the tests, on average \[°C\].
    pub ambient_c: f64,
    /// What is left, over all samples \[K\].
    pub rmse_k: f64,
}

/// Sums over one block.
#[derive(Clone, Copy)]
struct Block {
    gram: Matrix2<f64>,
    pull: Vector2<f64>,
    squares: f64,
    weight: f64,
}

/// Whether a series tells of the node.
pub fn tells(series: &Measured) -> bool {
    let ambient = series.ambient_c.iter().copied().find(|c| c.is_finite());
    let range = series.celsius.iter().fold((f64::MAX, f64::MIN), |r, c| (r.0.min(*c), r.1.max(*c)));
    let known = ambient.is_some_and(|c| (c - series.celsius[0]).abs() <= AMBIENT_K);
    known && range.1 - range.0 >= TELLING_K
}

/// Fits `C·dT/dt = heat − k·(T − T_ambient)` to the series that tell: Gauss-Newton steps in `1/C`
/// and `k/C`, standard errors by a jackknife over blocks as for the voltage.
pub fn node(
    series: &[&Measured],
    open_circuit_v: impl Fn(f64) -> f64,
    series_ohm: impl Fn(f64, f64) -> f64,
) -> Option<Node> {
    if series.is_empty() {
        return None;
    }
    let heat_w: Vec<Vec<f64>> =
        series.iter().map(|s| heat_w(s, &open_circuit_v, &series_ohm)).collect();
    // A few tens of joules per kelvin for each ampere-hour's worth of cell, an hour to cool.
    let mut at = Vector2::new(1.0 / 50.0, 1.0 / 500.0);
    let mut blocks = run(series, &heat_w, at);
    for _ in 0..STEPS {
        let sum = total(&blocks);
        let step = sum.gram.try_inverse()? * sum.pull;
        let mut length = 1.0;
        loop {
            let next = at + step * length;
            let tried = run(series, &heat_w, next);
            if next.min() > 0.0 && total(&tried).squares <= sum.squares {
                (at, blocks) = (next, tried);
                break;
            }
            length *= 0.5;
            if length < 1e-6 {
                break;
            }
        }
        if length < 1e-6 || step.component_div(&at).amax() < 1e-9 {
            break;
        }
    }
    let sum = total(&blocks);
    let (mut capacity, mut cooling) = (0.0, 0.0);
    let values = |at: Vector2<f64>| (1.0 / at.x, at.y / at.x);
    for block in &blocks {
        let moved = (sum.gram - block.gram).try_inverse()? * -block.pull;
        let (c, k) = values(at + moved);
        capacity += (c - values(at).0).powi(2);
        cooling += (k - values(at).1).powi(2);
    }
    #[expect(clippy::cast_precision_loss, reason = "a count")]
    let share = 1.0 - 1.0 / blocks.len() as f64;
    let ambient: Vec<f64> =
        series.iter().filter_map(|s| s.ambient_c.iter().copied().find(|c| c.is_finite())).collect();
    #[expect(clippy::cast_precision_loss, reason = "a count")]
    let ambient_c = ambient.iter().sum::<f64>() / ambient.len() as f64;
    Some(Node {
        heat_capacity_j_per_k: Estimate { value: values(at).0, error: (share * capacity).sqrt() },
        cooling_w_per_k: Estimate { value: values(at).1, error: (share * cooling).sqrt() },
        ambient_c,
        rmse_k: (sum.squares / sum.weight).sqrt(),
    })
}

fn total(blocks: &[Block]) -> Block {
    let zero = Block { gram: Matrix2::zeros(), pull: Vector2::zeros(), squares: 0.0, weight: 0.0 };
    blocks.iter().fold(zero, |a, b| Block {
        gram: a.gram + b.gram,
        pull: a.pull + b.pull,
        squares: a.squares + b.squares,
        weight: a.weight + b.weight,
    })
}

/// The heat over the step to each sample: what the voltage lacks to the open-circuit voltage, of
/// which the part in the RC branches moved from what it was at the sample before \[W\].
fn heat_w(
    s: &Measured,
    open_circuit_v: impl Fn(f64) -> f64,
    series_ohm: impl Fn(f64, f64) -> f64,
) -> Vec<f64> {
    let mut before_v = 0.0;
    let heat = |i: usize| {
        let lacking_v = open_circuit_v(s.soc[i]) - s.voltage_v[i];
        let branches_v = lacking_v - series_ohm(s.soc[i], s.celsius[i]) * s.current_a[i];
        let moved_v = if i == 0 { 0.0 } else { branches_v - before_v };
        before_v = branches_v;
        (lacking_v - 0.5 * moved_v) * s.current_a[i]
    };
    (0..s.soc.len()).map(heat).collect()
}

/// The temperature near the start, in the middle of so many samples: one alone is coarse.
fn first_c(s: &Measured, at: usize) -> (f64, usize) {
    let until_s = s.time_s[at] + START_S;
    let count = s.time_s[at..].iter().take_while(|t| **t <= until_s).count();
    #[expect(clippy::cast_precision_loss, reason = "a count")]
    let mean = s.celsius[at..at + count].iter().sum::<f64>() / count as f64;
    (mean, count)
}

fn run(series: &[&Measured], heat_w: &[Vec<f64>], at: Vector2<f64>) -> Vec<Block> {
    let mut blocks = Vec::new();
    for (s, heat_w) in series.iter().zip(heat_w) {
        let longest_s = s.longest_step_s();
        let (mut celsius, mut ambient_c, mut block_soc) =
            (s.celsius[0], s.celsius[0], f64::INFINITY);
        let (mut slope, mut wait) = (Vector2::zeros(), 0);
        for i in 0..s.time_s.len() {
            if (s.ambient_c[i] - s.celsius[0]).abs() <= AMBIENT_K {
                ambient_c = s.ambient_c[i];
            }
            let dt_s = if i == 0 { f64::INFINITY } else { s.time_s[i] - s.time_s[i - 1] };
            if dt_s > longest_s {
                let (mean_c, count) = first_c(s, i);
                (celsius, slope, wait) = (mean_c, Vector2::zeros(), count / 2);
                continue;
            }
            if wait > 0 {
                wait -= 1;
                continue;
            }
            let heat_w = heat_w[i];
            let keep = (-at.y * dt_s).exp();
            let above_k = celsius - ambient_c;
            // What a constant rate of change adds over the step.
            let held_s = (1.0 - keep) / at.y;
            // What the temperature changes by with 1/C and with k/C.
            slope = slope * keep
                + Vector2::new(
                    held_s * heat_w,
                    -dt_s * keep * above_k
                        + heat_w * at.x * (dt_s * keep * at.y - (1.0 - keep)) / (at.y * at.y),
                );
            celsius = ambient_c + above_k * keep + held_s * heat_w * at.x;
            if (s.soc[i] - block_soc).abs() > BLOCK_SOC {
                block_soc = s.soc[i];
                blocks.push(total(&[]));
            }
            let residual = s.celsius[i] - celsius;
            if let Some(block) = blocks.last_mut() {
                block.gram += slope * slope.transpose() * dt_s;
                block.pull += slope * (residual * dt_s);
                block.squares += residual * residual * dt_s;
                block.weight += dt_s;
            }
        }
    }
    blocks
}
