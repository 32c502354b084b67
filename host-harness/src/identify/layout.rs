//! Where each parameter stands in the vector that is fitted.

use std::ops::Range;

/// Tables of the battery are read at these many even intervals: their points lie on that grid, so
/// that a table and the polyline through its points are the same.
const INTERVALS: f64 = 64.0;
/// Points of the open-circuit table, in grid intervals …
const OCV_POINTS: [u8; 33] = [
    0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30, 32, 34, 36, 38, 40, 42, 44, 46, 48,
    50, 52, 54, 56, 58, 60, 62, 64,
];
/// … and of the resistances: close where a cell runs empty and its resistance rises.
const OHM_POINTS: [u8; 8] = [10, 13, 16, 24, 32, 42, 52, 64];

/// Branches: the series resistance, then the RC branches, the faster first.
pub const BRANCHES: usize = 3;
/// Activation temperatures are fitted in units of this \[K\].
pub const ACTIVATION_UNIT_K: f64 = 1000.0;

/// The order of the parameters: open-circuit voltages, three tables of resistances, two logarithms
/// of time constants, three activation temperatures.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// States of charge of the open-circuit points.
    pub ocv: Vec<f64>,
    /// States of charge of the resistances' points.
    pub ohm: Vec<f64>,
}

/// A place between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The point below.
    pub below: usize,
    /// How far from it to the next, 0..1.
    pub along: f64,
}

impl Layout {
    /// The points inside a range of the state of charge, two at least; resistances from `lowest`.
    pub fn over(soc: (f64, f64), lowest: f64) -> Option<Self> {
        let inside = |points: &[u8], lowest: f64| -> Vec<f64> {
            let half = 0.5 / INTERVALS;
            let on_grid = points.iter().map(|&i| f64::from(i) / INTERVALS);
            on_grid.filter(|s| (lowest - half..=soc.1 + half).contains(s)).collect()
        };
        let ocv = inside(&OCV_POINTS, soc.0);
        let ohm = inside(&OHM_POINTS, soc.0.max(lowest));
        (ocv.len() > 2 && ohm.len() > 1).then_some(Self { ocv, ohm })
    }

    /// How many parameters there are.
    pub fn len(&self) -> usize {
        self.activation(0) + BRANCHES
    }

    /// The open-circuit voltages.
    pub fn voltages(&self) -> Range<usize> {
        0..self.ocv.len()
    }

    /// The resistances of a branch.
    pub fn resistances(&self, branch: usize) -> Range<usize> {
        let start = self.ocv.len() + branch * self.ohm.len();
        start..start + self.ohm.len()
    }

    /// The logarithm of the time constant of a branch from 1.
    pub fn log_tau(&self, branch: usize) -> usize {
        self.ocv.len() + BRANCHES * self.ohm.len() + branch - 1
    }

    /// The activation temperature of a branch.
    pub fn activation(&self, branch: usize) -> usize {
        self.ocv.len() + BRANCHES * self.ohm.len() + 2 + branch
    }

    /// The first parameter in which the model is not linear.
    pub fn first_nonlinear(&self) -> usize {
        self.log_tau(1)
    }
}

/// Where a state of charge lies among points; beyond them, at the nearer end.
pub fn place(points: &[f64], soc: f64) -> Place {
    let above = points.partition_point(|p| *p <= soc).clamp(1, points.len() - 1);
    let (low, high) = (points[above - 1], points[above]);
    Place { below: above - 1, along: ((soc - low) / (high - low)).clamp(0.0, 1.0) }
}

/// A value between points.
pub fn at(values: &[f64], place: Place) -> f64 {
    values[place.below] + place.along * (values[place.below + 1] - values[place.below])
}
