//! The energy ledger of the coupled plant: where every joule went. It is ours.
//!
//! `E_electrochemical = Σ terms + ΔE_stored + residual`: each term is the power of one component,
//! from its own definition, at the end of a step, times `h`; the residual is rounding.
//!
//! A step offers each term's *raw* power: without the parameter that it is proportional to (`i²`
//! for the copper, `|v|` for the motor's Coulomb friction). The parameter and the step's length
//! come in once, when the books are read. Raw powers gather in a plain sum per term; each step
//! pours one of these into its compensated total and empties it, so that a step costs little and
//! no sum grows long enough to lose anything.
//!
//! Tests: below and in `tests/ledger.rs`; property `ledger`.

use crate::num::{Accum, Real, max};

/// Lists the ledger's terms once; everything that knows them comes from here.
macro_rules! terms {
    ($($(#[$doc:meta])* $term:ident),+ $(,)?) => {
        /// One value for each term; powers \[W\], or what they are proportional to.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub struct Flows {
            $($(#[$doc])* pub $term: Real,)+
            /// What the battery exchanged with the rest, without its sign.
            pub throughput: Real,
        }

        impl Flows {
            /// One for each term.
            pub(crate) const ONES: Self = Self { $($term: 1.0,)+ throughput: 1.0 };

            /// Term by term.
            #[inline(always)]
            pub(crate) const fn times(&self, factors: &Self) -> Self {
                Self {
                    $($term: self.$term * factors.$term,)+
                    throughput: self.throughput * factors.throughput,
                }
            }

            #[inline(always)]
            const fn array(&self) -> [Real; TERMS] {
                [self.throughput, $(self.$term,)+]
            }
        }

        const TERMS: usize = ["throughput", $(stringify!($term),)+].len();
        const NAMES: [&str; TERMS] = ["throughput", $(stringify!($term),)+];

        /// Where the energy went since the start \[J\]; each term positive in the sense of its
        /// name. `electrochemical` is the sum of all others but the last two.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub struct EnergyReport {
            $($(#[$doc])* pub $term: Real,)+
            /// Σ|E·I|·h at the battery: what the residual is measured against.
            pub throughput: Real,
            /// Gained in the motion of body, wheels, gears and rotor.
            pub kinetic: Real,
            /// Gained in the inductance of machines with one winding.
            pub inductive: Real,
            /// Gained in the RC branch's capacitance.
            pub capacitive: Real,
            /// What the balance does not explain: rounding.
            pub residual: Real,
            /// Part of `electrochemical` that no charge stands for: it went into a full battery
            /// (positive), or out of an empty one.
            pub overcharge: Real,
            /// The step takes the open-circuit voltage of its start; this is how much the
            /// battery's stored energy fell beyond `electrochemical` and `overcharge` for it.
            pub open_circuit_explicit: Real,
        }

        impl EnergyReport {
            /// Each term's name and value, in the order of the ledger.
            #[must_use]
            pub const fn terms(&self) -> [(&'static str, Real); TERMS + 6] {
                [
                    $((stringify!($term), self.$term),)+
                    ("throughput", self.throughput),
                    ("kinetic", self.kinetic),
                    ("inductive", self.inductive),
                    ("capacitive", self.capacitive),
                    ("residual", self.residual),
                    ("overcharge", self.overcharge),
                    ("open_circuit_explicit", self.open_circuit_explicit),
                ]
            }

            fn from_sums(sums: [Real; TERMS]) -> Self {
                let [throughput, $($term,)+] = sums;
                Self { $($term,)+ throughput, ..Self::default() }
            }
        }
    };
}

terms! {
    /// Out of the battery's chemistry, at the open-circuit voltage.
    electrochemical,
    /// Heat in the battery's series resistance.
    series_joule,
    /// Heat in the battery's polarisation resistance; for a battery with maps what its branches
    /// and its hysteresis take, stored or not.
    polarisation_joule,
    /// Loss of the converter.
    converter,
    /// Delivered to the auxiliary loads.
    auxiliary,
    /// Heat in the motor's winding.
    copper,
    /// `(Ke − Kt)·ω·i`: what a parameter set with Ke ≠ Kt takes from one side and does not give to
    /// the other. Negative, created from nothing, where Kt > Ke and the motor drives, or where
    /// Ke > Kt and it generates.
    conversion,
    /// Viscous friction of motor, wheels and body.
    viscous,
    /// Coulomb friction of the motor.
    coulomb,
    /// Loss of the gearbox.
    gear,
    /// Work against the air; negative where a tailwind pushes.
    drag,
    /// Rolling resistance.
    rolling,
    /// Heat in the friction brake.
    brake,
    /// Gained in height.
    potential,
    /// What the implicit step dissipates: `½L·Δi² + ½m·Δv² + ½C·ΔV²`, L of machines with one winding.
    /// It vanishes with the step.
    numerical,
    /// Heat in the iron of machines that have it apart.
    iron,
    /// Into the field of machines with three phases, with what the step dissipates there.
    field,
}

/// So many terms, the last, are of windings with three phases.
const THREE_PHASE: usize = 2;

impl EnergyReport {
    /// The residual over the throughput, or over what moved between height, motion and brake where
    /// that is more (a full battery downhill); 0 where nothing moved.
    #[must_use]
    pub const fn residual_rel(&self) -> Real {
        let moved = max(self.potential.abs(), max(self.kinetic.abs(), self.brake));
        let size = max(self.throughput, moved);
        if size > 0.0 { self.residual / size } else { 0.0 }
    }
}

/// The energy ledger: what each term has come to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct EnergyLedger {
    recent: [Real; TERMS],
    totals: [Accum; TERMS],
    next: usize,
    start: Stored,
    overcharge_j: Accum,
}

impl EnergyLedger {
    /// The report, given the factors that the raw powers were booked without, the step, what is
    /// stored now and how much the battery's own energy fell.
    pub(crate) fn report(
        &self,
        factors: &Flows,
        dt_s: Real,
        now: Stored,
        discharged_j: Real,
    ) -> EnergyReport {
        let factors = factors.array();
        let mut balance = Accum::new(0.0);
        let mut sums = [0.0; TERMS];
        for (k, sum) in sums.iter_mut().enumerate() {
            let mut total = self.totals[k];
            total.add(self.recent[k]);
            let energy = total.scaled(factors[k] * dt_s);
            *sum = energy.get();
            // The source on one side, the named terms on the other, the throughput on none.
            match NAMES[k] {
                "electrochemical" => balance.add_sum(energy),
                "throughput" => {}
                _ => balance.add_sum(energy.scaled(-1.0)),
            }
        }
        let mut report = EnergyReport::from_sums(sums);
        report.kinetic = now.kinetic - self.start.kinetic;
        report.inductive = now.inductive - self.start.inductive;
        report.capacitive = now.capacitive - self.start.capacitive;
        for stored in [report.kinetic, report.inductive, report.capacitive] {
            balance.add(-stored);
        }
        report.residual = balance.get();
        report.overcharge = self.overcharge_j.get();
        report.open_circuit_explicit = discharged_j - report.electrochemical - report.overcharge;
        report
    }
}

/// Energy held in motion and fields \[J\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Stored {
    /// In the motion of body, wheels, gears and rotor.
    pub kinetic: Real,
    /// In the winding's inductance.
    pub inductive: Real,
    /// In the RC branch's capacitance.
    pub capacitive: Real,
}

/// Whether a plant keeps books. Chosen by type when the plant is made; without, a step costs less.
pub trait Book: Copy + Default {
    /// Opens the books.
    fn starting_with(start: Stored) -> Self;
    /// Books the raw powers of one step, those of a winding with three phases only where there is one.
    fn book(&mut self, raw: &Flows, three_phase: bool);
    /// Books what went into a full battery, or out of an empty one \[J\].
    fn book_overcharge(&mut self, energy_j: Real);
}

impl Book for EnergyLedger {
    fn starting_with(start: Stored) -> Self {
        Self { start, ..Self::default() }
    }

    #[inline(always)]
    fn book(&mut self, raw: &Flows, three_phase: bool) {
        let terms = if three_phase { TERMS } else { TERMS - THREE_PHASE };
        for (sum, power) in self.recent.iter_mut().zip(raw.array()).take(terms) {
            *sum += power;
        }
        let k = if self.next < terms { self.next } else { 0 };
        self.totals[k].add(self.recent[k]);
        self.recent[k] = 0.0;
        self.next = k + 1;
    }

    fn book_overcharge(&mut self, energy_j: Real) {
        self.overcharge_j.add(energy_j);
    }
}

/// Keeps no books.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NoLedger;

impl Book for NoLedger {
    #[inline]
    fn starting_with(_start: Stored) -> Self {
        Self
    }

    #[inline(always)]
    fn book(&mut self, _raw: &Flows, _three_phase: bool) {}

    #[inline(always)]
    fn book_overcharge(&mut self, _energy_j: Real) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEPS: u32 = 1000;

    /// A thousand steps of 0.01 s in which 100 W leave the battery and 91 W are named.
    fn ledger() -> EnergyLedger {
        let mut ledger = EnergyLedger::starting_with(Stored { kinetic: 5.0, ..Stored::default() });
        let raw = Flows {
            electrochemical: 100.0,
            copper: 5.0,
            drag: 80.0,
            numerical: 1.0,
            throughput: 100.0,
            ..Flows::default()
        };
        for _ in 0..STEPS {
            ledger.book(&raw, true);
        }
        ledger
    }

    const FACTORS: Flows = Flows { copper: 2.0, ..Flows::ONES };

    #[test]
    fn what_flows_in_must_be_named_or_is_left_over() {
        let stored = |kinetic| Stored { kinetic, inductive: 1.0, ..Stored::default() };
        let closed = ledger().report(&FACTORS, 0.01, stored(94.0), 1000.5);
        assert!(closed.residual.abs() < 1e-3 && closed.kinetic == 89.0, "{closed:?}");
        assert!((closed.copper - 100.0).abs() < 1e-3 && (closed.drag - 800.0).abs() < 1e-3);
        assert!((closed.open_circuit_explicit - 0.5).abs() < 1e-3);
        let open = ledger().report(&FACTORS, 0.01, stored(34.0), 1000.0);
        assert!((open.residual_rel() - 0.06).abs() < 1e-5, "{open:?}");
        assert!(open.terms().contains(&("copper", open.copper)));
        assert_eq!(EnergyReport::default().residual_rel(), 0.0);
        let downhill = EnergyReport { residual: 2.0, potential: -1e6, ..EnergyReport::default() };
        assert_eq!(downhill.residual_rel(), 2e-6);
    }

    #[test]
    fn what_is_stored_counts_from_the_start() {
        let stored = |kinetic, inductive, capacitive| Stored { kinetic, inductive, capacitive };
        let ledger = EnergyLedger::starting_with(stored(5.0, 3.0, 2.0));
        let report = ledger.report(&Flows::ONES, 1.0, stored(7.0, 10.0, 13.0), 0.0);
        assert_eq!((report.kinetic, report.inductive, report.capacitive), (2.0, 7.0, 11.0));
        assert_eq!(report.residual, -20.0);
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn small_powers_are_not_lost_in_large_sums() {
        let mut ledger = EnergyLedger::default();
        let raw = Flows { brake: 1e6, ..Flows::default() };
        let tiny = Flows { brake: 0.01, ..Flows::default() };
        for _ in 0..1000 {
            ledger.book(&raw, true);
        }
        for _ in 0..100_000 {
            ledger.book(&tiny, true);
        }
        let report = ledger.report(&Flows::ONES, 1.0, Stored::default(), 0.0);
        assert!((report.brake - 1_000_001_000.0).abs() < 100.0, "{}", report.brake);
    }

    #[test]
    fn factors_apply_term_by_term() {
        let raw = Flows { copper: 3.0, drag: 4.0, ..Flows::default() };
        let powers = raw.times(&FACTORS);
        assert_eq!((powers.copper, powers.drag, powers.gear), (6.0, 4.0, 0.0));
    }
}
