//! From samples to normal equations: the model's voltage, and how it changes with each parameter.
//!
//! For given time constants and activation temperatures the voltage is linear in the open-circuit
//! voltages and the resistances: each resistance of an RC branch has its own filtered current.
//! What it changes by with a time constant or an activation temperature runs along as one more
//! filter. Per block of samples the products are summed, so that blocks can be left out later.

use rayon::prelude::*;

use super::layout::{ACTIVATION_UNIT_K, BRANCHES, Layout, Place, at};
use super::series::{Sample, Series};

/// Voltages above these states of charge are tallied apart.
pub const TALLIED_ABOVE: [f64; 3] = [f64::NEG_INFINITY, 0.15, 0.25];

/// Sums over one block of samples, with `r` measured minus modelled and `J` what the modelled
/// voltage changes by with each parameter.
#[derive(Clone, Debug)]
pub struct Normal {
    /// `JᵀWJ`, upper triangle, row by row in a full square.
    pub gram: Vec<f64>,
    /// `JᵀWr`.
    pub pull: Vec<f64>,
    /// `rᵀWr`.
    pub squares: f64,
    /// Sums of `W`, `WJ` and `Wr`.
    weight: f64,
    sum: Vec<f64>,
    residual: f64,
    /// Sums of `r²`, and how many, by [`TALLIED_ABOVE`].
    pub tally: [(f64, f64); 3],
}

impl Normal {
    pub fn new(len: usize) -> Self {
        Self {
            gram: vec![0.0; len * len],
            pull: vec![0.0; len],
            squares: 0.0,
            weight: 0.0,
            sum: vec![0.0; len],
            residual: 0.0,
            tally: [(0.0, 0.0); 3],
        }
    }

    /// Root of the mean of `r²`, by [`TALLIED_ABOVE`]; none without samples.
    pub fn rms(&self) -> [Option<f64>; 3] {
        self.tally.map(|(squares, count)| (count > 0.0).then(|| (squares / count).sqrt()))
    }

    /// Whether any sample counts.
    pub fn counts(&self) -> bool {
        self.weight > 0.0
    }

    /// Adds another block.
    pub fn add(&mut self, other: &Self) {
        self.gram.iter_mut().zip(&other.gram).for_each(|(a, b)| *a += b);
        self.pull.iter_mut().zip(&other.pull).for_each(|(a, b)| *a += b);
        self.squares += other.squares;
        self.tally.iter_mut().zip(other.tally).for_each(|(a, b)| *a = (a.0 + b.0, a.1 + b.1));
    }

    /// Frees the level of the voltage: what is left is how the residual varies about its mean.
    fn free_level(&mut self) {
        if self.weight <= 0.0 {
            return;
        }
        let len = self.pull.len();
        for i in 0..len {
            if self.sum[i] != 0.0 {
                let share = self.sum[i] / self.weight;
                self.pull[i] -= share * self.residual;
                for j in i..len {
                    self.gram[i * len + j] -= share * self.sum[j];
                }
            }
        }
        self.squares -= self.residual * self.residual / self.weight;
    }

    fn sample(&mut self, row: &[(usize, f64)], residual: f64, sample: &Sample) {
        let len = self.pull.len();
        for (n, &(i, a)) in row.iter().enumerate() {
            let weighted = sample.weight * a;
            self.pull[i] += weighted * residual;
            self.sum[i] += weighted;
            let line = &mut self.gram[i * len..][..len];
            for &(j, b) in &row[n..] {
                line[j] += weighted * b;
            }
        }
        self.squares += sample.weight * residual * residual;
        self.weight += sample.weight;
        self.residual += sample.weight * residual;
        for (tally, above) in self.tally.iter_mut().zip(TALLIED_ABOVE) {
            if sample.soc > above {
                *tally = (tally.0 + residual * residual, tally.1 + 1.0);
            }
        }
    }
}

/// The sums of every block of every series at `parameters`, in the order of the series.
pub fn equations(series: &[Series], layout: &Layout, parameters: &[f64]) -> Vec<Vec<Normal>> {
    series.par_iter().map(|one| of_series(one, layout, parameters)).collect()
}

/// One RC branch: the voltage per ohm of each point of its resistance, and how the voltage of the
/// branch changes with its time constant and its activation temperature.
struct Branch<'a> {
    ohm: &'a [f64],
    tau_s: f64,
    per_ohm: Vec<f64>,
    voltage: f64,
    by_log_tau: f64,
    by_activation: f64,
    decay: (f64, f64),
}

/// What is left of a filtered current below this share of the present one is none.
const FORGOTTEN: f64 = 1e-7;

impl<'a> Branch<'a> {
    fn new(ohm: &'a [f64], tau_s: f64) -> Self {
        Self {
            ohm,
            tau_s,
            per_ohm: vec![0.0; ohm.len()],
            voltage: 0.0,
            by_log_tau: 0.0,
            by_activation: 0.0,
            decay: (0.0, 1.0),
        }
    }

    fn rest(&mut self) {
        self.per_ohm.fill(0.0);
        (self.voltage, self.by_log_tau, self.by_activation) = (0.0, 0.0, 0.0);
    }

    /// `load_a` is the current times the factor of the temperature, which holds over the sample.
    fn step(&mut self, sample: &Sample, load_a: f64) {
        if self.decay.0 != sample.dt_s {
            self.decay = (sample.dt_s, (-sample.dt_s / self.tau_s).exp());
        }
        let keep = self.decay.1;
        let goal = at(self.ohm, sample.ohm) * load_a;
        self.by_log_tau =
            keep * (self.by_log_tau + sample.dt_s / self.tau_s * (self.voltage - goal));
        self.by_activation =
            keep * self.by_activation + (1.0 - keep) * goal * ACTIVATION_UNIT_K * sample.coldness;
        self.voltage = keep * self.voltage + (1.0 - keep) * goal;
        for x in &mut self.per_ohm {
            *x = if x.abs() < FORGOTTEN { 0.0 } else { *x * keep };
        }
        let Place { below, along } = sample.ohm;
        self.per_ohm[below] += (1.0 - keep) * load_a * (1.0 - along);
        self.per_ohm[below + 1] += (1.0 - keep) * load_a * along;
    }
}

fn of_series(series: &Series, layout: &Layout, parameters: &[f64]) -> Vec<Normal> {
    let mut blocks = vec![Normal::new(layout.len()); series.blocks];
    let ocv = &parameters[layout.voltages()];
    let series_ohm = &parameters[layout.resistances(0)];
    let mut branches = [1, 2].map(|b| {
        Branch::new(&parameters[layout.resistances(b)], parameters[layout.log_tau(b)].exp())
    });
    let mut row: Vec<(usize, f64)> = Vec::with_capacity(layout.len());
    let mut factors = (f64::NAN, [1.0; BRANCHES]);
    for sample in &series.samples {
        if factors.0 != sample.coldness {
            let of = |b| parameters[layout.activation(b)] * ACTIVATION_UNIT_K * sample.coldness;
            factors = (sample.coldness, [0, 1, 2].map(|b| f64::exp(of(b))));
        }
        let load = factors.1.map(|f| f * sample.current_a);
        for (branch, load_a) in branches.iter_mut().zip(&load[1..]) {
            if sample.rested { branch.rest() } else { branch.step(sample, *load_a) }
        }
        if sample.weight == 0.0 {
            continue;
        }
        let drop = at(series_ohm, sample.ohm) * load[0];
        let modelled = at(ocv, sample.ocv) - drop - branches[0].voltage - branches[1].voltage;
        row.clear();
        let mut pair = |first: usize, place: Place, value: f64| {
            row.push((first + place.below, value * (1.0 - place.along)));
            row.push((first + place.below + 1, value * place.along));
        };
        pair(layout.voltages().start, sample.ocv, 1.0);
        pair(layout.resistances(0).start, sample.ohm, -load[0]);
        for (b, branch) in branches.iter().enumerate() {
            let start = layout.resistances(b + 1).start;
            let per_ohm = branch.per_ohm.iter().enumerate().filter(|(_, x)| **x != 0.0);
            row.extend(per_ohm.map(|(k, x)| (start + k, -x)));
        }
        row.push((layout.log_tau(1), -branches[0].by_log_tau));
        row.push((layout.log_tau(2), -branches[1].by_log_tau));
        row.push((layout.activation(0), -drop * ACTIVATION_UNIT_K * sample.coldness));
        row.push((layout.activation(1), -branches[0].by_activation));
        row.push((layout.activation(2), -branches[1].by_activation));
        blocks[sample.block].sample(&row, sample.voltage_v - modelled, sample);
    }
    if series.free_level {
        blocks.iter_mut().for_each(Normal::free_level);
    }
    blocks
}
