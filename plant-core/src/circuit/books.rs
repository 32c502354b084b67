//! Where the power of a step went.

use super::{Circuit, CircuitOutput, CircuitState, Element, Method};
use crate::num::Real;

/// The power of one step of a [`Circuit`](super::Circuit).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Books {
    /// `Σ v·i` over all elements \[W\]: zero but for rounding (Tellegen).
    pub balance_w: Real,
    /// `½·Σ |v·i|` \[W\].
    pub throughput_w: Real,
    /// What backward Euler swallows \[W\]: `½·L·Δi²/h` and `½·C·Δv²/h`.
    pub numerical_w: Real,
}

impl<const N: usize, const E: usize, const S: usize, const C: usize> Circuit<N, E, S, C> {
    /// The books of the step from `before` to `after` with the output `out`. `numerical_w` is for
    /// [`Method::BackwardEuler`]; the trapezoidal rule swallows nothing but where a switch changes.
    #[must_use]
    pub fn books(
        &self,
        before: &CircuitState<E>,
        after: &CircuitState<E>,
        out: &CircuitOutput<E>,
    ) -> Books {
        let mut books = Books::default();
        for e in 0..E {
            let power_w = out.voltage_v[e] * out.current_a[e];
            books.balance_w += power_w;
            books.throughput_w += 0.5 * power_w.abs();
            let rise = after.stored[e].since(before.stored[e]);
            let stiffness = match self.branches[e].element {
                Element::Coil { henry, .. } => henry,
                Element::Capacitor { farad } => farad,
                _ => 0.0,
            };
            if self.method == Method::BackwardEuler {
                books.numerical_w += 0.5 * stiffness * rise * rise * self.per_s;
            }
        }
        books
    }
}
