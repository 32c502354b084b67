//! One solution of the coupled plant for one duty, or with gates off: down the chain, one equation,
//! and back to the currents, as the header of [`powertrain`](super) says.
//!
//! Tests: `tests` of the powertrain.

use super::{Powertrain, PowertrainState};
use crate::battery::Pack;
use crate::converter::Converter;
use crate::machine::dc::CurrentLaw;
use crate::mechanics::body::{Motion, Resistance};
use crate::num::{Real, sign};
use crate::port::{DriveLaw, Source};
use crate::powertrain::ledger::Book;

/// What draws from the battery beside the drive, within one step.
#[derive(Clone, Copy, Default)]
pub(super) struct Loads {
    /// There are any: where there are none, nothing is added for them.
    pub any: bool,
    /// The constant power's current \[A\].
    pub constant_a: Real,
    /// Auxiliary resistor \[S\].
    pub resistor_s: Real,
    /// The converter's constant loss \[S\].
    pub converter_s: Real,
}

impl Loads {
    pub(super) const fn current_a(&self, battery_v: Real) -> Real {
        self.constant_a + (self.resistor_s + self.converter_s) * battery_v
    }
}

/// Where a step starts from, as far as the solution depends on it.
#[derive(Clone, Copy)]
pub(super) struct Start {
    pub speed_m_s: Real,
    pub current_a: Real,
    pub loads: Loads,
    /// What the battery offers once these have drawn.
    pub bus: Source,
    pub converter_ohm: Real,
    pub drop_v: Real,
    pub resistance: Resistance,
}

impl Start {
    /// Cuts the auxiliary loads off.
    pub(super) const fn starve(&mut self, source: Source) {
        self.loads = Loads { any: true, constant_a: 0.0, resistor_s: 0.0, converter_s: 0.0 };
        self.bus = source;
    }
}

/// What one duty leads to.
#[derive(Clone, Copy)]
pub(super) struct Solution {
    pub duty: Real,
    /// Of the converter, against the current.
    pub drop_v: Real,
    pub motion: Motion,
    pub current_increment_a: Real,
    pub battery_a: Real,
    pub battery_v: Real,
}

impl<L: Book, B: Pack> Powertrain<L, B> {
    /// What draws from the battery beside the drive, at its last voltage.
    #[inline(always)]
    fn loads(&self, asked_w: Real, state: &PowertrainState<L, B::State>) -> Loads {
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
            converter_s: self.converter.shunt_s(battery_v),
        }
    }

    /// Down the chain: what the terminals offer, what the auxiliary loads leave of it. Also the
    /// terminals themselves, and the open-circuit voltage \[V\].
    #[inline(always)]
    pub(super) fn start(
        &self,
        state: &PowertrainState<L, B::State>,
        auxiliary_w: Real,
        resistance: Resistance,
    ) -> (Start, Source, Real) {
        let (i, v) = (state.current_a.get(), state.body.speed_m_s.get());
        let (source, open_circuit_v) = self.battery.offer(&state.battery);
        let mut start = Start {
            speed_m_s: v,
            current_a: i,
            loads: Loads::default(),
            bus: source,
            converter_ohm: 0.0,
            drop_v: 0.0,
            resistance,
        };
        if !self.plain || auxiliary_w > 0.0 {
            start.loads = self.loads(auxiliary_w, state);
            start.bus = source
                .loaded(start.loads.constant_a, start.loads.resistor_s + start.loads.converter_s);
            start.converter_ohm = self.converter.params.resistance_ohm;
            start.drop_v = self.converter.params.voltage_drop_v;
        }
        (start, source, open_circuit_v)
    }

    /// What one duty leads to: down the chain, one equation, and back to the currents.
    ///
    /// The converter's drop is set-valued: it takes its voltage from what drives the current, and
    /// where that is less, nothing flows.
    #[inline(always)]
    pub(super) fn solve(&self, start: &Start, duty: Real) -> Solution {
        let (mut drop_v, mut blocked) = (0.0, false);
        if start.drop_v > 0.0 {
            let driving_v =
                duty * start.bus.emf_v + self.winding.free_v(start.current_a, start.speed_m_s);
            blocked = driving_v.abs() <= start.drop_v;
            drop_v = if driving_v < 0.0 { -start.drop_v } else { start.drop_v };
        }
        self.settled(start, duty, drop_v, blocked)
    }

    /// What gates off lead to: the diodes conduct where what drives the current exceeds the bus and
    /// their drop, from the winding into the bus; the current ends where they block.
    #[inline(always)]
    pub(super) fn solve_off(&self, start: &Start) -> Solution {
        let free_v = self.winding.free_v(start.current_a, start.speed_m_s);
        let direction = sign(free_v);
        let blocked = free_v.abs() <= start.bus.emf_v + start.drop_v;
        let solution = self.settled(start, -direction, direction * start.drop_v, blocked);
        // The speed fell so far within the step that they would conduct backwards.
        let backwards = direction * (start.current_a + solution.current_increment_a) < 0.0;
        if blocked || backwards {
            Solution { duty: 0.0, drop_v: 0.0, ..self.settled(start, 0.0, 0.0, true) }
        } else {
            solution
        }
    }

    #[inline(always)]
    fn settled(&self, start: &Start, duty: Real, drop_v: Real, blocked: bool) -> Solution {
        let (i, v) = (start.current_a, start.speed_m_s);
        let (drive, current) = if blocked {
            (DriveLaw::default(), CurrentLaw::blocked(i))
        } else {
            let mut seen = Converter::seen_through(start.bus, duty);
            seen.emf_v -= drop_v;
            seen.resistance_ohm += start.converter_ohm;
            self.winding.law(seen, i, v)
        };
        let motion = start.resistance.solve(drive, v);
        let current_increment_a = current.increment_a(motion.increment_m_s);
        let drive_a = duty * (i + current_increment_a);
        let battery_v = start.bus.voltage_v(drive_a);
        let mut battery_a = drive_a;
        if start.loads.any {
            battery_a += start.loads.current_a(battery_v);
        }
        Solution { duty, drop_v, motion, current_increment_a, battery_a, battery_v }
    }
}
