//! What an identification gives: each parameter with its standard error.

use super::battery::Identified;
use super::capacity::Estimate;
use super::layout::{ACTIVATION_UNIT_K, BRANCHES};
use crate::simulate::statistics::{Spread, spread};

impl Identified {
    /// The spread over the files that were left out.
    #[must_use]
    pub fn held_out_spread(&self) -> Option<Spread> {
        spread("voltage_rmse_v", self.held_out.iter().map(|r| Some(r.voltage_rmse_v)))
    }

    fn estimate(&self, i: usize, unit: f64) -> Estimate {
        Estimate { value: self.parameters[i] * unit, error: self.errors[i] * unit }
    }

    /// Resistances at 25 °C over the state of charge \[Ω\] of a branch from 0, the series
    /// resistance.
    #[must_use]
    pub fn resistances(&self, branch: usize) -> Vec<(f64, Estimate)> {
        let range = self.layout.resistances(branch);
        self.layout.ohm.iter().zip(range).map(|(s, i)| (*s, self.estimate(i, 1.0))).collect()
    }

    /// Open-circuit voltages over the state of charge \[V\].
    #[must_use]
    pub fn open_circuit(&self) -> Vec<(f64, Estimate)> {
        let range = self.layout.voltages();
        self.layout.ocv.iter().zip(range).map(|(s, i)| (*s, self.estimate(i, 1.0))).collect()
    }

    /// Activation temperature of a branch from 0 \[K\].
    #[must_use]
    pub fn activation_k(&self, branch: usize) -> Estimate {
        self.estimate(self.layout.activation(branch), ACTIVATION_UNIT_K)
    }

    /// Branches that there are, the series resistance among them.
    #[must_use]
    pub fn branches(&self) -> usize {
        if self.second_branch { BRANCHES } else { BRANCHES - 1 }
    }

    /// The time constant of a branch from 1 \[s\].
    #[must_use]
    pub fn time_constant(&self, branch: usize) -> Estimate {
        let at = self.layout.log_tau(branch);
        let value = self.parameters[at].exp();
        Estimate { value, error: value * self.errors[at] }
    }
}
