//! Heat along a chain of nodes over one step.
//!
//! Node i has `C_i·dT_i/dt = P_i − k_i·(T_i − T_a) − q_i·(T_i − T_{i+1}) − q_{i−1}·(T_i − T_{i−1})`.
//! Taken implicitly, its increments solve a tridiagonal system whose matrix is the same in every
//! step: it is eliminated once, when the model is made, and a step is one walk up and one down.

use crate::num::Real;

/// `N` nodes in a row, discretised for one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Chain<const N: usize> {
    /// Of the eliminated diagonal \[K/W\].
    inverse: [Real; N],
    /// How much of an increment is passed on to the node before.
    pass: [Real; N],
    /// Cooling to the surroundings, and to the next node \[W/K\].
    ambient_w_per_k: [Real; N],
    next_w_per_k: [Real; N],
}

impl<const N: usize> Chain<N> {
    /// From heat capacities over the step \[W/K\], infinite where a temperature is held, the cooling of
    /// each node to the surroundings and to the next one \[W/K\]; the last has no next.
    pub(crate) const fn new(
        capacity_per_h: [Real; N],
        ambient_w_per_k: [Real; N],
        mut next_w_per_k: [Real; N],
    ) -> Self {
        let (mut inverse, mut pass) = ([0.0; N], [0.0; N]);
        let (mut i, mut from_before) = (0, 0.0);
        while i < N {
            if i + 1 == N {
                next_w_per_k[i] = 0.0;
            }
            let own = capacity_per_h[i] + ambient_w_per_k[i] + from_before;
            inverse[i] = 1.0 / (own + next_w_per_k[i]);
            pass[i] = next_w_per_k[i] * inverse[i];
            // The share that is not passed on, each time without cancellation.
            let kept = if pass[i] < 0.5 { 1.0 - pass[i] } else { own * inverse[i] };
            from_before = next_w_per_k[i] * kept;
            i += 1;
        }
        Self { inverse, pass, ambient_w_per_k, next_w_per_k }
    }

    /// What flows from each node to its surroundings, and to the next node \[W\].
    #[inline]
    pub(crate) fn flows_w(
        &self,
        celsius: &[Real; N],
        ambient_c: &[Real; N],
    ) -> ([Real; N], [Real; N]) {
        let (mut out, mut on) = ([0.0; N], [0.0; N]);
        for i in 0..N {
            out[i] = self.ambient_w_per_k[i] * (celsius[i] - ambient_c[i]);
            if i + 1 < N {
                on[i] = self.next_w_per_k[i] * (celsius[i] - celsius[i + 1]);
            }
        }
        (out, on)
    }

    /// The increments of one step under `heat_w` \[K\].
    #[inline]
    pub(crate) fn increments_k(
        &self,
        celsius: &[Real; N],
        ambient_c: &[Real; N],
        heat_w: &[Real; N],
    ) -> [Real; N] {
        let (out, on) = self.flows_w(celsius, ambient_c);
        let mut increments = [0.0; N];
        let (mut from_before, mut carried) = (0.0, 0.0);
        for i in 0..N {
            carried += heat_w[i] - out[i] - on[i] + from_before;
            increments[i] = carried * self.inverse[i];
            from_before = on[i];
            carried *= self.pass[i];
        }
        let mut after = 0.0;
        for i in (0..N).rev() {
            increments[i] += self.pass[i] * after;
            after = increments[i];
        }
        increments
    }
}
