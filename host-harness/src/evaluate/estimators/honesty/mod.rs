//! Whether the filter's standard deviation can be believed where the world is not as assumed:
//! simulated batteries of three kinds, each with something wrong, drawn anew for each seed.

mod batteries;
mod capacity;
mod energy;
mod random;
mod tally;
mod weak;
mod world;

use rayon::prelude::*;
use serde::Serialize;

pub use batteries::Chemistry;
pub use tally::Tally;
use world::World;

/// Seeds of the full matrix.
pub const SEEDS: u64 = 10;

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Nothing: what the sensors show is what is declared.
    Clean,
    /// Curve, resistance, capacity, ammeter and start drawn from what is declared of them.
    Drawn,
    /// A stand-by current that the ammeter does not see.
    Drain,
    /// A rest of which nothing is known, with an error of the curve.
    Rest,
    /// A start while polarised: what was before is not known.
    Reset,
    /// Samples are missing.
    Dropouts,
    /// The voltage comes in coarse steps, as declared.
    Quantised,
    /// A state of charge that has grown old, said to be known.
    Stale,
    /// The ammeter shows nothing.
    Dead,
    /// The ammeter is mounted in the wrong direction.
    Reversed,
    /// The ammeter shows the same all the time.
    Stuck,
    /// The curve is another one: four times its declared error.
    WrongCurve,
    /// The cells are of another chemistry.
    OtherCells,
    /// One of the cells in series is not there.
    FewerCells,
    /// More resistance and less capacity than was declared, and nobody said so.
    Aged,
    /// One of the pairs that the capacity is learnt from is wrong.
    BadPair,
    /// One of the cells in series is weak: what the pack may give.
    WeakCell,
    /// The energy left, in the cold.
    Energy,
}

/// What a kind must reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Share of the samples of every run that hold the truth within three standard deviations.
    pub inside: f64,
    /// The same in the mean of the runs.
    pub inside_mean: f64,
    /// Share of the samples that are outside, without a flag, in the mean of the runs.
    pub silent: f64,
    /// The largest error in standard deviations.
    pub worst: f64,
    /// Share of the samples that are flagged.
    pub flagged: f64,
    /// The largest mean standard deviation: it may not simply grow.
    pub sd: f64,
    /// The largest error, root mean square, over the mean standard deviation.
    pub ratio: f64,
}

impl Bound {
    /// Every sample tells the truth.
    const STRICT: Self = Self {
        inside: 0.997,
        inside_mean: 0.997,
        silent: 0.0,
        worst: 4.0,
        flagged: 0.005,
        sd: 0.05,
        ratio: f64::INFINITY,
    };
    /// What is wrong was not declared: it need only be said.
    const TOLD: Self = Self {
        inside: 0.0,
        inside_mean: 0.0,
        silent: 0.01,
        worst: f64::INFINITY,
        flagged: 1.0,
        sd: f64::INFINITY,
        ..Self::STRICT
    };
    /// What is wrong is drawn as declared. A Gaussian leaves three in a thousand outside; runs are few,
    /// so at times more.
    const DRAWN: Self = Self {
        inside: 0.0,
        inside_mean: 0.99,
        silent: 0.01,
        worst: f64::INFINITY,
        flagged: 0.03,
        ratio: 1.05,
        ..Self::STRICT
    };
}

impl Kind {
    /// All.
    pub const ALL: [Self; 18] = [
        Self::Clean,
        Self::Drawn,
        Self::Drain,
        Self::Rest,
        Self::Reset,
        Self::Dropouts,
        Self::Quantised,
        Self::Stale,
        Self::Dead,
        Self::Reversed,
        Self::Stuck,
        Self::WrongCurve,
        Self::OtherCells,
        Self::FewerCells,
        Self::Aged,
        Self::BadPair,
        Self::WeakCell,
        Self::Energy,
    ];

    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Clean => "as declared",
            Self::Drawn => "errors drawn as declared",
            Self::Drain => "unseen stand-by current",
            Self::Rest => "rest from an unknown start",
            Self::Reset => "reset while polarised",
            Self::Dropouts => "missing samples",
            Self::Quantised => "coarse voltage, declared",
            Self::Stale => "start 8 % off, said to be 1 %",
            Self::Dead => "ammeter dead",
            Self::Reversed => "ammeter reversed",
            Self::Stuck => "ammeter stuck",
            Self::WrongCurve => "curve four times as wrong",
            Self::OtherCells => "cells of another chemistry",
            Self::FewerCells => "95 of 96 cells",
            Self::Aged => "aged, and nobody said so",
            Self::BadPair => "capacity: a bad pair",
            Self::WeakCell => "power: a weak cell",
            Self::Energy => "energy left, 25 to -10 °C",
        }
    }

    /// Whether it can happen to a battery.
    #[must_use]
    pub fn happens_to(self, chemistry: Chemistry) -> bool {
        match self {
            Self::FewerCells => chemistry == Chemistry::Pack,
            // The capacity is learnt from states of charge, whatever the curve.
            Self::BadPair => chemistry == Chemistry::Cell,
            _ => true,
        }
    }

    /// A kind whose errors are drawn from a distribution needs so many seeds to show a share of one in a
    /// hundred.
    const fn seeds(self, seeds: u64) -> u64 {
        match self {
            Self::Drawn | Self::Energy | Self::BadPair if seeds < SEEDS => 4 * SEEDS,
            Self::Drawn | Self::Energy | Self::BadPair => 4 * seeds,
            _ => seeds,
        }
    }

    /// What it must reach on a battery.
    #[must_use]
    pub const fn bound(self, chemistry: Chemistry) -> Bound {
        let bound = match self {
            // What is known of these lets the standard deviation be as small as this.
            Self::Clean => Bound { sd: 0.018, ..Bound::STRICT },
            Self::Drain | Self::Reset | Self::Dropouts => Bound::STRICT,
            // A rest alone knows no more than the slope of the curve where it is.
            Self::Rest => Bound { sd: 0.08, ..Bound::STRICT },
            Self::Drawn => Bound::DRAWN,
            Self::Quantised => Bound { inside: 0.985, silent: 0.015, worst: 5.0, ..Bound::STRICT },
            Self::Stale
            | Self::Dead
            | Self::Reversed
            | Self::Stuck
            | Self::OtherCells
            | Self::FewerCells
            | Self::Aged
            | Self::BadPair => Bound::TOLD,
            // It is said once some errors have been seen, each of which takes charge that moves.
            Self::WrongCurve => Bound { silent: 0.05, ..Bound::TOLD },
            // Nobody is told of a cell: the limits keep it.
            Self::WeakCell => Bound { sd: f64::INFINITY, ratio: f64::INFINITY, ..Bound::DRAWN },
            // In watt-hours over those of a full battery.
            Self::Energy => Bound { sd: 0.07, ..Bound::DRAWN },
        };
        match (chemistry, self) {
            // The voltage says little there, so the standard deviation is larger.
            (Chemistry::Flat, Self::Clean | Self::Drawn | Self::Dropouts | Self::Quantised) => {
                Bound { sd: 0.14, ..bound }
            }
            (Chemistry::Flat, Self::Drain | Self::Rest | Self::Reset) => Bound { sd: 0.2, ..bound },
            // Four times the error, 36 mV, is more than the whole plateau rises: there the voltage has
            // nothing to tell it from the state of charge.
            (Chemistry::Flat, Self::WrongCurve) => Bound { silent: 0.2, ..bound },
            _ => bound,
        }
    }
}

/// All runs of one kind on one battery.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Group {
    /// What is wrong.
    pub kind: Kind,
    /// The battery.
    pub chemistry: Chemistry,
    /// A tally for each seed.
    pub runs: Vec<Tally>,
}

impl Group {
    fn mean(&self, of: impl Fn(&Tally) -> f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a few")]
        let count = self.runs.len() as f64;
        self.runs.iter().map(of).sum::<f64>() / count
    }

    /// Share of the samples inside three standard deviations, in the mean and at worst.
    #[must_use]
    pub fn inside(&self) -> (f64, f64) {
        let worst = self.runs.iter().map(Tally::inside).fold(1.0, f64::min);
        (self.mean(Tally::inside), worst)
    }

    /// Share of the samples outside without a flag.
    #[must_use]
    pub fn silent(&self) -> f64 {
        self.mean(Tally::silent)
    }

    /// Share of the samples that are flagged.
    #[must_use]
    pub fn flagged(&self) -> f64 {
        self.mean(Tally::flagged)
    }

    /// The largest error in standard deviations.
    #[must_use]
    pub fn worst(&self) -> f64 {
        self.runs.iter().map(|tally| tally.worst).fold(0.0, f64::max)
    }

    /// The mean standard deviation.
    #[must_use]
    pub fn sd(&self) -> f64 {
        self.mean(Tally::sd)
    }

    /// The error, root mean square, over the mean standard deviation.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.mean(Tally::mean_square).sqrt() / self.sd()
    }

    /// What chance does to the root mean square of so few runs.
    fn chance(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a few")]
        let count = self.runs.len() as f64;
        (0.5 / count).sqrt()
    }

    /// Whether it reaches what its kind must.
    #[must_use]
    pub fn is_honest(&self) -> bool {
        let bound = self.kind.bound(self.chemistry);
        let (mean, worst) = self.inside();
        worst >= bound.inside
            && mean >= bound.inside_mean
            && self.silent() <= bound.silent
            && self.worst() < bound.worst
            && self.flagged() <= bound.flagged
            && self.sd() <= bound.sd
            && self.ratio() <= bound.ratio * (1.0 + self.chance())
    }
}

/// Every kind on every battery.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Kinds and batteries.
    pub groups: Vec<Group>,
}

impl Report {
    /// Runs all, with so many seeds.
    #[must_use]
    pub fn of(seeds: u64) -> Self {
        Self { groups: run(seeds) }
    }

    /// Whether each reaches what it must.
    #[must_use]
    pub fn is_honest(&self) -> bool {
        self.groups.iter().all(Group::is_honest)
    }
}

/// Runs every kind on every battery, with so many seeds.
#[must_use]
pub fn run(seeds: u64) -> Vec<Group> {
    let pairs: Vec<(Kind, Chemistry)> = Kind::ALL
        .into_iter()
        .flat_map(|kind| Chemistry::ALL.map(|chemistry| (kind, chemistry)))
        .filter(|(kind, chemistry)| kind.happens_to(*chemistry))
        .collect();
    pairs
        .into_par_iter()
        .map(|(kind, chemistry)| {
            let runs = (1..=kind.seeds(seeds)).into_par_iter().map(|seed| match kind {
                Kind::BadPair => capacity::run(seed),
                Kind::WeakCell => weak::run(chemistry, seed),
                Kind::Energy => energy::run(chemistry, seed),
                _ => World::new(kind, chemistry, seed).run(),
            });
            Group { kind, chemistry, runs: runs.collect() }
        })
        .collect()
}
