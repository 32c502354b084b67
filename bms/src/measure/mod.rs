//! What is measured on a pack, and how far it can be believed.
//!
//! It is ours. Tests: below.

use plant_core::Real;
use plant_core::num::{max, min, sane};

/// One value from one sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reading {
    /// The value, in the unit that the field holding it names.
    pub value: Real,
    /// Time since it was taken \[s\].
    pub age_s: Real,
    /// Whether the sensor vouches for it: it answered, its checksum held, it was not saturated.
    pub valid: bool,
}

impl Reading {
    /// Nothing yet.
    pub const NONE: Self = Self { value: 0.0, age_s: Real::INFINITY, valid: false };

    /// A value just taken.
    #[must_use]
    pub const fn new(value: Real) -> Self {
        Self { value, age_s: 0.0, valid: true }
    }

    /// The value where it is valid, neither infinite nor NaN nor beyond
    /// [`LARGEST`](plant_core::num::LARGEST), and at most `oldest_s` old.
    #[inline]
    #[must_use]
    pub const fn usable(&self, oldest_s: Real) -> Option<Real> {
        // An age below zero or not a number is a clock gone wrong.
        if self.valid && self.age_s >= 0.0 && self.age_s <= oldest_s && sane(self.value) {
            Some(self.value)
        } else {
            None
        }
    }

    /// The same for the estimators' inputs, in which NaN stands for no value.
    #[inline]
    #[must_use]
    pub const fn usable_or_nan(&self, oldest_s: Real) -> Real {
        match self.usable(oldest_s) {
            Some(value) => value,
            None => Real::NAN,
        }
    }

    /// Lets a time pass \[s\].
    #[inline]
    pub const fn elapse(&mut self, elapsed_s: Real) {
        self.age_s += elapsed_s;
    }
}

impl Default for Reading {
    fn default() -> Self {
        Self::NONE
    }
}

/// Everything that is measured on a pack of `CELLS` cells in series with `SENSORS` temperatures.
///
/// ```
/// use voltstep_bms::{Measurements, Reading};
///
/// let mut now: Measurements<3, 1> = Measurements::NONE;
/// now.cell_v = [3.71, 0.0, 3.69].map(Reading::new);
/// now.cell_v[1].valid = false; // a wire is lost
/// now.current_a = Reading::new(12.5);
/// let cells = now.cell_spread(0.1).expect("two cells are usable");
/// assert_eq!((cells.usable, cells.min_index, cells.max_index), (2, 2, 0));
///
/// now.elapse(0.2);
/// assert_eq!(now.current_a.usable(0.1), None); // too old
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct Measurements<const CELLS: usize, const SENSORS: usize> {
    /// Voltage of each cell \[V\].
    #[cfg_attr(feature = "recorder", serde(with = "serde_big_array::BigArray"))]
    pub cell_v: [Reading; CELLS],
    /// Temperatures \[°C\].
    #[cfg_attr(feature = "recorder", serde(with = "serde_big_array::BigArray"))]
    pub temperature_c: [Reading; SENSORS],
    /// Pack current, positive when discharging \[A\].
    pub current_a: Reading,
    /// Voltage of the cells together, before the contactors \[V\].
    pub pack_v: Reading,
    /// Voltage behind the contactors \[V\].
    pub link_v: Reading,
}

impl<const CELLS: usize, const SENSORS: usize> Measurements<CELLS, SENSORS> {
    /// Nothing yet.
    pub const NONE: Self = Self {
        cell_v: [Reading::NONE; CELLS],
        temperature_c: [Reading::NONE; SENSORS],
        current_a: Reading::NONE,
        pack_v: Reading::NONE,
        link_v: Reading::NONE,
    };

    /// Lets a time pass for every reading \[s\], as it was measured.
    pub fn elapse(&mut self, elapsed_s: Real) {
        for reading in &mut self.cell_v {
            reading.elapse(elapsed_s);
        }
        for reading in &mut self.temperature_c {
            reading.elapse(elapsed_s);
        }
        self.current_a.elapse(elapsed_s);
        self.pack_v.elapse(elapsed_s);
        self.link_v.elapse(elapsed_s);
    }

    /// The voltage of each cell \[V\], NaN where it is not usable.
    #[must_use]
    pub fn cells_or_nan(&self, oldest_s: Real) -> [Real; CELLS] {
        self.cell_v.map(|cell| cell.usable_or_nan(oldest_s))
    }

    /// Lowest, mean and highest usable cell voltage \[V\]; `None` where no cell is usable.
    #[must_use]
    pub fn cell_spread(&self, oldest_s: Real) -> Option<Spread> {
        Spread::of(&self.cell_v, oldest_s)
    }

    /// Whether the cells in series and the pack fit: `CELLS` times the mean of the usable cells is
    /// the pack's voltage to within half a cell. A pack that is said to have one cell too many or too
    /// few does not. `None` where no cell, or the pack, is usable.
    #[must_use]
    pub fn fits_in_series(&self, oldest_s: Real) -> Option<bool> {
        let cell_v = self.cell_spread(oldest_s)?.mean;
        let pack_v = self.pack_v.usable(oldest_s)?;
        #[expect(clippy::cast_precision_loss, reason = "a pack has fewer cells than 2^24")]
        let sum_v = CELLS as Real * cell_v;
        Some((sum_v - pack_v).abs() <= 0.5 * cell_v)
    }

    /// Lowest, mean and highest usable temperature \[°C\]; `None` where no sensor is usable.
    #[must_use]
    pub fn temperature_spread(&self, oldest_s: Real) -> Option<Spread> {
        Spread::of(&self.temperature_c, oldest_s)
    }
}

impl<const CELLS: usize, const SENSORS: usize> Default for Measurements<CELLS, SENSORS> {
    fn default() -> Self {
        Self::NONE
    }
}

/// How far several readings of one quantity lie apart, in their unit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Spread {
    /// The lowest.
    pub min: Real,
    /// The mean.
    pub mean: Real,
    /// The highest.
    pub max: Real,
    /// Which reading is the lowest; the first where several are.
    pub min_index: usize,
    /// Which reading is the highest; the first where several are.
    pub max_index: usize,
    /// How many are usable.
    pub usable: usize,
}

impl Spread {
    /// Over those of `readings` that are usable; `None` where none is.
    #[must_use]
    pub fn of(readings: &[Reading], oldest_s: Real) -> Option<Self> {
        let mut spread: Option<Self> = None;
        let mut sum = 0.0;
        for (i, reading) in readings.iter().enumerate() {
            let Some(value) = reading.usable(oldest_s) else { continue };
            sum += value;
            spread = Some(match spread {
                None => Self {
                    min: value,
                    mean: value,
                    max: value,
                    min_index: i,
                    max_index: i,
                    usable: 1,
                },
                Some(so_far) => Self {
                    min: min(value, so_far.min),
                    mean: 0.0,
                    max: max(value, so_far.max),
                    min_index: if value < so_far.min { i } else { so_far.min_index },
                    max_index: if value > so_far.max { i } else { so_far.max_index },
                    usable: so_far.usable + 1,
                },
            });
        }
        spread.map(|spread| {
            #[expect(clippy::cast_precision_loss, reason = "a pack has fewer cells than 2^24")]
            let mean = sum / spread.usable as Real;
            Self { mean, ..spread }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uses_only_what_is_valid_finite_and_fresh() {
        let reading = |value, age_s, valid| Reading { value, age_s, valid };
        assert_eq!(reading(3.7, 0.1, true).usable(0.1), Some(3.7));
        for bad in [
            reading(3.7, 0.1, false),
            reading(3.7, 0.11, true),
            reading(3.7, Real::NAN, true),
            reading(3.7, -0.1, true),
            reading(Real::NAN, 0.0, true),
            reading(Real::INFINITY, 0.0, true),
            reading(1e30, 0.0, true),
            Reading::NONE,
        ] {
            assert_eq!(bad.usable(0.1), None, "{bad:?}");
            assert!(bad.usable_or_nan(0.1).is_nan());
        }
        assert_eq!(Reading::default().usable(Real::INFINITY), None);
    }

    #[test]
    fn ages_every_reading() {
        let new = Reading::new(1.0);
        let mut now: Measurements<2, 1> = Measurements {
            cell_v: [new; 2],
            temperature_c: [new; 1],
            current_a: new,
            pack_v: new,
            link_v: new,
        };
        now.elapse(0.25);
        now.elapse(0.25);
        for reading in [
            now.cell_v[0],
            now.cell_v[1],
            now.temperature_c[0],
            now.current_a,
            now.pack_v,
            now.link_v,
        ] {
            assert_eq!(reading.age_s, 0.5);
        }
        assert_eq!(now.cells_or_nan(0.5), [1.0; 2]);
        assert!(now.cells_or_nan(0.4).iter().all(|v| v.is_nan()));
    }

    #[test]
    fn spreads_over_usable_readings() {
        let mut readings = [3.5, 3.7, 9.9, 3.3, 3.7].map(Reading::new);
        readings[2].valid = false;
        let spread = Spread::of(&readings, 1.0).unwrap();
        assert_eq!((spread.min, spread.max), (3.3, 3.7));
        assert_eq!((spread.min_index, spread.max_index, spread.usable), (3, 1, 4));
        assert!((spread.mean - 3.55).abs() < 1e-6);
        let same = Spread::of(&[Reading::new(3.6); 3], 1.0).unwrap();
        assert_eq!((same.min_index, same.max_index), (0, 0), "the first of several");
        let now: Measurements<5, 2> = Measurements {
            cell_v: readings,
            temperature_c: [20.0, 30.0].map(Reading::new),
            ..Measurements::NONE
        };
        assert_eq!(now.cell_spread(1.0), Some(spread));
        assert_eq!(now.temperature_spread(1.0).unwrap().mean, 25.0);
        assert_eq!(Spread::of(&[Reading::NONE; 3], 1.0), None);
        assert_eq!(Measurements::<4, 2>::default().cell_spread(1.0), None);
    }

    #[test]
    fn a_cell_too_few_does_not_fit() {
        let pack_of = |cells: Real| {
            let mut now: Measurements<4, 0> = Measurements::NONE;
            now.cell_v = [3.7, 3.65, 3.72, 3.6].map(Reading::new);
            now.pack_v = Reading::new(3.67 * cells);
            now
        };
        assert_eq!(pack_of(4.0).fits_in_series(1.0), Some(true));
        assert_eq!(pack_of(3.0).fits_in_series(1.0), Some(false));
        assert_eq!(pack_of(5.0).fits_in_series(1.0), Some(false));
        let mut lost = pack_of(4.0);
        lost.cell_v[1].valid = false;
        assert_eq!(lost.fits_in_series(1.0), Some(true), "one reading is lost");
        lost.pack_v.valid = false;
        assert_eq!(lost.fits_in_series(1.0), None);
        assert_eq!(Measurements::<4, 0>::NONE.fits_in_series(1.0), None);
    }

    #[test]
    fn without_a_reading_there_is_no_spread() {
        assert_eq!(Measurements::<4, 2>::default().temperature_spread(1.0), None);
    }
}
