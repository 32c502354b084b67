//! One solution of the coupled plant for one command: down the chain, one equation, and back to the
//! currents, as the header of [`powertrain`](super) says.
//!
//! Tests: `tests` of the powertrain.

use super::drives::Drives;
use super::{Powertrain, PowertrainState};
use crate::battery::Pack;
use crate::machine::{Footing, Review, Seen, Solved};
use crate::mechanics::body::{Motion, Resistance};
use crate::num::{Real, sign};
use crate::port::Source;
use crate::powertrain::ledger::Book;

/// What draws from the battery beside the drives, within one step.
#[derive(Clone, Copy, Default)]
pub(super) struct Loads {
    /// There are any: where there are none, nothing is added for them.
    pub any: bool,
    /// The constant power's current \[A\].
    pub constant_a: Real,
    /// Auxiliary resistor \[S\].
    pub resistor_s: Real,
    /// The converters' constant loss \[S\].
    pub converter_s: Real,
}

impl Loads {
    /// A share of them.
    pub(super) const fn times(&self, share: Real) -> Self {
        Self {
            any: self.any,
            constant_a: self.constant_a * share,
            resistor_s: self.resistor_s * share,
            converter_s: self.converter_s * share,
        }
    }

    pub(super) const fn current_a(&self, battery_v: Real) -> Real {
        self.constant_a + (self.resistor_s + self.converter_s) * battery_v
    }

    /// What they leave of a source.
    #[inline(always)]
    pub(super) const fn leave(&self, source: Source) -> Source {
        if self.any {
            source.loaded(self.constant_a, self.resistor_s + self.converter_s)
        } else {
            source
        }
    }
}

/// What one command leads to.
#[derive(Clone, Copy)]
pub(super) struct Walk<K> {
    pub link: K,
    pub motion: Motion,
    pub battery_v: Real,
    pub battery_a: Real,
    pub review: Review,
}

impl<L: Book, B: Pack, D: Drives> Powertrain<L, B, D> {
    /// What draws from the battery beside the drives, at its last voltage.
    #[inline(always)]
    pub(super) fn loads(
        &self,
        asked_w: Real,
        state: &PowertrainState<L, B::State, D::State>,
    ) -> Loads {
        if self.plain && asked_w <= 0.0 {
            return Loads::default();
        }
        let battery_v = state.battery_v;
        let cut_out = state.cut_out_s > 0.0;
        Loads {
            any: true,
            constant_a: if cut_out {
                0.0
            } else {
                self.auxiliary.constant_power_a(asked_w, battery_v)
            },
            resistor_s: self.auxiliary.conductance_s,
            converter_s: crate::converter::shunt_s(self.constant_loss_w, battery_v),
        }
    }

    /// A solution and what it leads to.
    #[inline(always)]
    pub(super) fn reviewed(
        &self,
        state: &PowertrainState<L, B::State, D::State>,
        loads: &Loads,
        solved: Solved<D::Link>,
    ) -> Walk<D::Link> {
        let Solved { link, bus_v: battery_v, motion } = solved;
        let review = self.drives.review(&state.drives, &link, battery_v, motion.increment_m_s);
        let mut battery_a = review.bus_a;
        if loads.any {
            battery_a += loads.current_a(battery_v);
        }
        Walk { link, motion, battery_v, battery_a, review }
    }

    /// What the drives see when a step begins.
    #[inline(always)]
    pub(super) fn seen(
        state: &PowertrainState<L, B::State, D::State>,
        bus: Source,
        resistance: &Resistance,
    ) -> Seen {
        let speed_m_s = state.body.speed_m_s.get();
        let mobility = 1.0 / resistance.slope_n_s_per_m;
        let coasting_n = resistance.force_n - sign(speed_m_s) * resistance.friction_n;
        Seen {
            bus_v: bus.emf_v,
            from_v: state.battery_v,
            speed_m_s,
            footing: Footing { speed_m_s: speed_m_s + mobility * coasting_n, mobility },
        }
    }
}
