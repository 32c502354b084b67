//! The energy ledger of the coupled plant: where every joule went.

use crate::num::{Accum, Real};

/// Lists the ledger's terms once; everything that knows them comes from here.
macro_rules! terms {
    ($($(#[$doc:meta])* $term:ident),+ $(,)?) => {
        /// The mean power of each term over one step \[W\].
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub struct Flows {
            $($(#[$doc])* pub $term: Real,)+
            /// What the battery exchanged with the rest, without its sign.
            pub throughput: Real,
        }

        /// The energy ledger: a compensated sum for each term \[J\].
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub struct EnergyLedger {
            $($term: Accum,)+
            throughput: Accum,
            start: Stored,
        }

        impl Book for EnergyLedger {
            fn starting_with(start: Stored) -> Self {
                Self { start, ..Self::default() }
            }

            #[inline]
            fn book(&mut self, flows: &Flows, dt_s: Real) {
                $(self.$term.add(flows.$term * dt_s);)+
                self.throughput.add(flows.throughput * dt_s);
            }
        }

        /// Where the energy went since the start \[J\]; each term positive in the sense of its
        /// name. `electrochemical` is the sum of all others but `open_circuit_explicit`.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub struct EnergyReport {
            $($(#[$doc])* pub $term: Real,)+
            /// Gained in the motion of body, wheels, gears and rotor.
            pub kinetic: Real,
            /// Gained in the winding's inductance.
            pub inductive: Real,
            /// Gained in the RC branch's capacitance.
            pub capacitive: Real,
            /// What the balance does not explain: rounding.
            pub residual: Real,
            /// The step takes the open-circuit voltage of its start; this is how much the
            /// battery's stored energy fell beyond `electrochemical` for it.
            pub open_circuit_explicit: Real,
            /// Σ|E·I|·h at the battery: what the residual is measured against.
            pub throughput: Real,
        }

        impl EnergyReport {
            /// Each term's name and value, in the order of the ledger.
            #[must_use]
            pub const fn terms(&self) -> [(&'static str, Real); TERMS + 6] {
                [
                    $((stringify!($term), self.$term),)+
                    ("kinetic", self.kinetic),
                    ("inductive", self.inductive),
                    ("capacitive", self.capacitive),
                    ("residual", self.residual),
                    ("open_circuit_explicit", self.open_circuit_explicit),
                    ("throughput", self.throughput),
                ]
            }

            /// The residual over the throughput; 0 where nothing flowed.
            #[must_use]
            pub const fn residual_rel(&self) -> Real {
                if self.throughput > 0.0 { self.residual / self.throughput } else { 0.0 }
            }
        }

        const TERMS: usize = [$(stringify!($term)),+].len();

        impl EnergyLedger {
            /// The report, given what is stored now and how much the battery's own energy fell.
            #[must_use]
            pub(crate) fn report(&self, now: Stored, discharged_j: Real) -> EnergyReport {
                let mut balance = Accum::new(0.0);
                $(balance.add_sum(self.$term.scaled(-1.0));)+
                balance.add_sum(self.electrochemical.scaled(2.0));
                balance.add(-(now.kinetic - self.start.kinetic));
                balance.add(-(now.inductive - self.start.inductive));
                balance.add(-(now.capacitive - self.start.capacitive));
                EnergyReport {
                    $($term: self.$term.get(),)+
                    kinetic: now.kinetic - self.start.kinetic,
                    inductive: now.inductive - self.start.inductive,
                    capacitive: now.capacitive - self.start.capacitive,
                    residual: balance.get(),
                    open_circuit_explicit: discharged_j - self.electrochemical.get(),
                    throughput: self.throughput.get(),
                }
            }
        }
    };
}

terms! {
    /// Out of the battery's chemistry, at the open-circuit voltage.
    electrochemical,
    /// Heat in the battery's series resistance.
    series_joule,
    /// Heat in the battery's polarisation resistance.
    polarisation_joule,
    /// Loss of the converter.
    converter,
    /// Delivered to the auxiliary loads.
    auxiliary,
    /// Heat in the motor's winding.
    copper,
    /// `(Ke − Kt)·ω·i`: iron losses where Ke > Kt; negative, created from nothing, where a
    /// parameter set has Kt > Ke.
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
    /// What the implicit step dissipates: `½L·Δi² + ½m·Δv² + ½C·ΔV²`. It vanishes with the step.
    numerical,
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
    /// Books the flows of one step.
    fn book(&mut self, flows: &Flows, dt_s: Real);
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

    #[inline]
    fn book(&mut self, _flows: &Flows, _dt_s: Real) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_flows_in_must_be_named_or_is_left_over() {
        let mut ledger = EnergyLedger::starting_with(Stored { kinetic: 5.0, ..Stored::default() });
        let flows = Flows {
            electrochemical: 100.0,
            copper: 10.0,
            drag: 40.0,
            numerical: 1.0,
            throughput: 100.0,
            ..Flows::default()
        };
        for _ in 0..100 {
            ledger.book(&flows, 0.01);
        }
        let stored = |kinetic| Stored { kinetic, inductive: 1.0, ..Stored::default() };
        let closed = ledger.report(stored(53.0), 100.5);
        assert!(closed.residual.abs() < 1e-4 && closed.kinetic == 48.0, "{closed:?}");
        assert!((closed.open_circuit_explicit - 0.5).abs() < 1e-4);
        let open = ledger.report(stored(33.0), 100.0);
        assert!((open.residual_rel() - 0.2).abs() < 1e-5);
        assert_eq!(open.terms()[5], ("copper", open.copper));
        assert_eq!(EnergyReport::default().residual_rel(), 0.0);
    }
}
