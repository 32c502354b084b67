//! What each drive wants, and what a limit leaves to it.

use crate::machine::{Bounds, Wish};
use crate::num::{Real, max, min};

/// What a set of limits leaves to each drive.
#[derive(Clone, Copy, Debug)]
pub struct Shares {
    /// There is one drive.
    pub(super) alone: bool,
    wishes: Wishes,
    /// What all together may take from the bus, at least and at most \[W\].
    lowest_w: Real,
    highest_w: Real,
    /// Voltage of the bus if no drive draws from it \[V\].
    bus_v: Real,
    /// How much a current lowers it \[Ω\].
    bus_ohm: Real,
}

/// What all drives want from the bus \[W\].
#[derive(Clone, Copy, Debug, Default)]
#[expect(clippy::struct_field_names, reason = "the unit")]
pub struct Wishes {
    /// The sum over the step, and, where that is less, once held.
    pub(in crate::powertrain) power_w: Real,
    least_w: Real,
    /// What those draw, and feed (≤ 0), that do.
    draws_w: Real,
    feeds_w: Real,
}

impl core::ops::Add for Wishes {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            power_w: self.power_w + other.power_w,
            least_w: self.least_w + other.least_w,
            draws_w: self.draws_w + other.draws_w,
            feeds_w: self.feeds_w + other.feeds_w,
        }
    }
}

impl From<Wish> for Wishes {
    fn from(wish: Wish) -> Self {
        let least_w = min(wish.now_w, wish.held_w);
        Self {
            power_w: wish.now_w,
            least_w,
            draws_w: max(wish.now_w, 0.0),
            feeds_w: min(least_w, 0.0),
        }
    }
}

impl Wishes {
    /// What is left to each where all together may take from `lowest_w` to `highest_w`.
    pub(in crate::powertrain) const fn shares(
        self,
        lowest_w: Real,
        highest_w: Real,
        bus_v: Real,
        bus_ohm: Real,
        alone: bool,
    ) -> Shares {
        Shares { alone, wishes: self, lowest_w, highest_w, bus_v, bus_ohm }
    }
}

impl Shares {
    /// For one drive: all.
    pub(super) const fn all(&self) -> Bounds {
        Bounds {
            lowest_w: self.lowest_w,
            highest_w: self.highest_w,
            bus_v: self.bus_v,
            bus_ohm: self.bus_ohm,
        }
    }

    /// Those that feed, or draw, too much share what there is in proportion to it; what is left over
    /// anyone may have.
    pub(super) fn bounds(&self, wish: Wish) -> Bounds {
        let (all, own) = (&self.wishes, Wishes::from(wish));
        let lowest_w = if all.least_w < self.lowest_w {
            (self.lowest_w - (all.least_w - all.feeds_w)) * (own.feeds_w / all.feeds_w)
        } else {
            self.lowest_w - (all.least_w - own.least_w)
        };
        let highest_w = if all.power_w > self.highest_w {
            (self.highest_w - (all.power_w - all.draws_w)) * (own.draws_w / all.draws_w)
        } else {
            self.highest_w - (all.power_w - own.power_w)
        };
        Bounds {
            lowest_w: min(lowest_w, 0.0),
            highest_w: max(highest_w, 0.0),
            bus_v: self.bus_v,
            bus_ohm: self.bus_ohm,
        }
    }
}

/// How the road answers all drives in one friction mode.
#[derive(Clone, Copy, Debug)]
pub struct Mode {
    /// Speed at the end of the step if no drive made a force \[m/s\].
    pub coasting_m_s: Real,
    /// Speed that a force adds \[m/(s·N)\]; 0 where friction holds.
    pub mobility: Real,
    /// What all drives make of it \[N\].
    pub force_n: Real,
}

impl Mode {
    /// The speed at the end of the step \[m/s\].
    pub(in crate::powertrain) const fn ended_m_s(&self) -> Real {
        self.coasting_m_s + self.mobility * self.force_n
    }
}
