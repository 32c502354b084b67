//! Cells and temperatures looked at in turn: extremes, what is missing, what is out of range, what
//! does not move.

use plant_core::Real;
use plant_core::num::{max, min, sane};

use super::sheet::Sensor;
use crate::Reading;

/// A reading as the rows take it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Taken {
    /// A value.
    Value(Real),
    /// None, or an old one.
    Stale,
    /// One that the sensor cannot show.
    OutOfRange,
}

impl Taken {
    pub(super) const fn value(self) -> Option<Real> {
        match self {
            Self::Value(value) => Some(value),
            Self::Stale | Self::OutOfRange => None,
        }
    }
}

/// What a reading of such a sensor is worth.
pub(super) const fn taken(reading: &Reading, sensor: &Sensor, oldest_s: Real) -> Taken {
    match reading.usable(oldest_s) {
        Some(value) if value >= sensor.lowest && value <= sensor.highest => Taken::Value(value),
        Some(_) => Taken::OutOfRange,
        None => Taken::Stale,
    }
}

/// What was seen of several readings of one quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Look {
    pub lowest: Real,
    pub highest: Real,
    pub sum: Real,
    pub seen: u16,
    pub stale: bool,
    pub out_of_range: bool,
}

impl Look {
    pub(super) const NEW: Self = Self {
        lowest: Real::INFINITY,
        highest: Real::NEG_INFINITY,
        sum: 0.0,
        seen: 0,
        stale: false,
        out_of_range: false,
    };

    pub(super) const fn take(&mut self, taken: Taken) {
        match taken {
            Taken::Value(value) => {
                self.lowest = min(value, self.lowest);
                self.highest = max(value, self.highest);
                self.sum += value;
                self.seen += 1;
            }
            Taken::Stale => self.stale = true,
            Taken::OutOfRange => self.out_of_range = true,
        }
    }

    /// Every one was seen.
    pub(super) const fn complete(&self) -> bool {
        self.seen > 0 && !self.stale && !self.out_of_range
    }

    pub(super) fn mean(&self) -> Option<Real> {
        (self.seen > 0).then(|| self.sum / Real::from(self.seen))
    }
}

/// Which of several sensors has not moved by a single bit while something else shows that it
/// should have.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Moves<const N: usize> {
    #[cfg_attr(feature = "recorder", serde(with = "serde_big_array::BigArray"))]
    last: [Real; N],
    #[cfg_attr(feature = "recorder", serde(with = "serde_big_array::BigArray"))]
    moved: [bool; N],
    /// Of what shows it, where it was when this began.
    reference: Real,
    /// Sweeps until the verdict: the readings must have had time to follow.
    wait: u8,
    stuck: bool,
}

/// Sweeps that a reading may need to follow.
pub(super) const FOLLOW: u8 = 3;

impl<const N: usize> Moves<N> {
    pub(super) const NEW: Self = Self {
        last: [Real::NAN; N],
        moved: [false; N],
        reference: Real::NAN,
        wait: 0,
        stuck: false,
    };

    /// A reading that is not seen cannot be called stuck.
    pub(super) fn take(&mut self, index: usize, value: Option<Real>) {
        if let (Some(last), Some(moved)) = (self.last.get_mut(index), self.moved.get_mut(index)) {
            let value = value.unwrap_or(Real::NAN);
            // Not a number differs from everything.
            #[expect(clippy::float_cmp, reason = "a stuck reading is the same to the bit")]
            if value != *last {
                *moved = true;
            }
            *last = value;
        }
    }

    /// At the end of a sweep: whether one is stuck, given what shows it and how far that must move.
    pub(super) fn stuck(&mut self, shows: Real, far: Real) -> bool {
        if self.wait > 0 {
            self.wait -= 1;
            if self.wait == 0 {
                self.stuck = self.moved.contains(&false);
                self.moved = [false; N];
                self.reference = shows;
            }
        } else if !sane(self.reference) {
            self.moved = [false; N];
            self.reference = shows;
        } else if (shows - self.reference).abs() > far {
            self.wait = FOLLOW;
        }
        self.stuck
    }
}
