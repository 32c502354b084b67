//! The linear equations of a network, in a form that single precision can solve.
//!
//! Node potentials lose what matters: across a closed switch of 10 µΩ at 400 V they leave a current
//! uncertain by 2 A. The unknowns are therefore the voltages along a spanning tree of the largest
//! conductances. Each other branch then conducts no more than any tree branch on its way, so that
//! `Σ g·c·cᵀ`, scaled by its diagonal, has a condition number of at most 1 + (the sum of the ways'
//! lengths) whatever the conductances are, and Cholesky's factors, whose error depends on the scaled
//! matrix alone \[Demmel1989\], give each voltage to a few roundings of its own scale. The tree is
//! Kruskal's \[Kruskal1956\], the equations are those of the cut-sets.
//!
//! The choice of the tree for the sake of rounding is ours.

use super::element::{Branch, Element};
use super::error::CircuitError;
use crate::num::Real;

/// A network with all its conductances, factorised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Network<const N: usize, const E: usize> {
    conductance_s: [Real; E],
    /// The elements of the tree, sources of voltage first.
    tree: [usize; N],
    /// How many of them are sources of voltage.
    held: usize,
    /// −1, 0 or 1: how the potential of a node counts the voltage of each tree branch.
    path: [[i8; N]; N],
    /// `L·D·Lᵀ`, with 1/D on the diagonal.
    factor: [[Real; N]; N],
}

/// Voltages and currents of all elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Solution<const E: usize> {
    pub voltage_v: [Real; E],
    pub current_a: [Real; E],
}

impl<const N: usize, const E: usize> Network<N, E> {
    /// Branches of the tree.
    const TREE: usize = if N > 0 { N - 1 } else { 0 };

    /// Finds the tree and factorises. A conductance is infinite for a source of voltage, zero for one
    /// of current.
    pub(super) const fn new(
        branches: &[Branch; E],
        conductance_s: [Real; E],
    ) -> Result<Self, CircuitError> {
        let mut net =
            Self { conductance_s, tree: [0; N], held: 0, path: [[0; N]; N], factor: [[0.0; N]; N] };
        match net.grow(branches) {
            Ok(()) => {}
            Err(error) => return Err(error),
        }
        net.assemble(branches);
        net.factorise();
        Ok(net)
    }

    /// How the voltage of an element counts that of a tree branch.
    #[inline]
    const fn counts(&self, branch: &Branch, t: usize) -> Real {
        if branch.from < N && branch.to < N && t < N {
            (self.path[branch.from][t] - self.path[branch.to][t]) as Real
        } else {
            0.0
        }
    }

    /// Kruskal's tree: the largest conductances first, where they tie two parts together.
    const fn grow(&mut self, branches: &[Branch; E]) -> Result<(), CircuitError> {
        let mut part = [0; N];
        let mut n = 0;
        while n < N {
            part[n] = n;
            n += 1;
        }
        let mut seen: u32 = 0;
        let mut grown = 0;
        while grown < Self::TREE {
            let (mut best, mut most_s, mut ends) = (E, 0.0, (0, 0));
            let mut e = 0;
            while e < E {
                let g = self.conductance_s[e];
                if seen & (1 << e) == 0 && g > most_s {
                    (best, most_s, ends) = (e, g, (branches[e].from, branches[e].to));
                }
                e += 1;
            }
            if best == E {
                return Err(CircuitError::Floating(floating(&part)));
            }
            seen |= 1 << best;
            let source = most_s == Real::INFINITY;
            let (from, to) = ends;
            if from >= N || to >= N {
                return Err(CircuitError::NoSuchNode(best));
            }
            if part[from] == part[to] {
                if source {
                    return Err(CircuitError::SourceLoop(best));
                }
                continue;
            }
            self.tie(&mut part, from, to, grown);
            self.tree[grown] = best;
            grown += 1;
            if source {
                self.held = grown;
            }
        }
        // What is left may still close a loop of sources.
        let mut e = 0;
        while e < E {
            if seen & (1 << e) == 0 && self.conductance_s[e] == Real::INFINITY {
                return Err(CircuitError::SourceLoop(e));
            }
            e += 1;
        }
        Ok(())
    }

    /// Ties the part of `to` to that of `from` by tree branch `t`.
    const fn tie(&mut self, part: &mut [usize; N], from: usize, to: usize, t: usize) {
        if from >= N || to >= N || t >= N {
            return;
        }
        let (kept, gone) = (part[from], part[to]);
        let mut moved = [0; N];
        let mut u = 0;
        while u < N {
            moved[u] = self.path[from][u] - self.path[to][u];
            u += 1;
        }
        moved[t] = -1;
        let mut n = 0;
        while n < N {
            if part[n] == gone {
                part[n] = kept;
                let mut u = 0;
                while u < N {
                    self.path[n][u] += moved[u];
                    u += 1;
                }
            }
            n += 1;
        }
    }

    /// `Σ g·c·cᵀ` over all elements, for the tree branches that are no sources.
    const fn assemble(&mut self, branches: &[Branch; E]) {
        let mut e = 0;
        while e < E {
            let g = self.conductance_s[e];
            let mut t = self.held;
            while t < Self::TREE && g < Real::INFINITY {
                let c = self.counts(&branches[e], t);
                if c != 0.0 {
                    let mut u = self.held;
                    while u <= t && u < N {
                        self.factor[t][u] += g * c * self.counts(&branches[e], u);
                        u += 1;
                    }
                }
                t += 1;
            }
            e += 1;
        }
    }

    const fn factorise(&mut self) {
        let mut t = self.held;
        while t < Self::TREE {
            // L·D of this row, which the earlier rows of L take from.
            let mut u = self.held;
            while u < t && u < N {
                let mut k = self.held;
                while k < u && k < N {
                    self.factor[t][u] -= self.factor[t][k] * self.factor[u][k];
                    k += 1;
                }
                u += 1;
            }
            let mut pivot = self.factor[t][t];
            let mut k = self.held;
            while k < t && k < N {
                let scaled = self.factor[t][k];
                self.factor[t][k] = scaled * self.factor[k][k];
                pivot -= scaled * self.factor[t][k];
                k += 1;
            }
            self.factor[t][t] = 1.0 / pivot;
            t += 1;
        }
    }

    /// Solves for what drives the network: the voltage of each source of voltage, and for each other
    /// element the `s` of `i = g·v + s`.
    pub(super) const fn solve(&self, branches: &[Branch; E], drive: &[Real; E]) -> Solution<E> {
        let along = self.along(branches, drive);
        let mut found = Solution { voltage_v: [0.0; E], current_a: [0.0; E] };
        let mut e = 0;
        while e < E {
            let mut voltage_v = 0.0;
            let mut t = 0;
            while t < Self::TREE {
                voltage_v += self.counts(&branches[e], t) * along[t];
                t += 1;
            }
            found.voltage_v[e] = voltage_v;
            if self.conductance_s[e] < Real::INFINITY {
                found.current_a[e] = self.conductance_s[e] * voltage_v + drive[e];
            }
            e += 1;
        }
        self.close(branches, &mut found);
        found
    }

    /// Voltages along the tree.
    const fn along(&self, branches: &[Branch; E], drive: &[Real; E]) -> [Real; N] {
        let mut along = [0.0; N];
        let mut t = 0;
        while t < self.held && t < N {
            along[t] = at(drive, self.tree[t]);
            t += 1;
        }
        let mut e = 0;
        while e < E {
            let g = self.conductance_s[e];
            if g < Real::INFINITY {
                let mut by_sources_v = 0.0;
                let mut u = 0;
                while u < self.held && u < N {
                    by_sources_v += self.counts(&branches[e], u) * along[u];
                    u += 1;
                }
                let current_a = drive[e] + g * by_sources_v;
                let mut t = self.held;
                while t < Self::TREE {
                    along[t] -= self.counts(&branches[e], t) * current_a;
                    t += 1;
                }
            }
            e += 1;
        }
        let mut t = self.held;
        while t < Self::TREE {
            let mut k = self.held;
            while k < t && k < N {
                along[t] -= self.factor[t][k] * along[k];
                k += 1;
            }
            t += 1;
        }
        let mut t = self.held;
        while t < Self::TREE {
            along[t] *= self.factor[t][t];
            t += 1;
        }
        let mut t = Self::TREE;
        while t > self.held && t < N {
            t -= 1;
            let mut k = t + 1;
            while k < Self::TREE {
                along[t] -= self.factor[k][t] * along[k];
                k += 1;
            }
        }
        along
    }

    /// The currents along the tree from those beside it: exact where a conductance is so large that
    /// its voltage says little.
    const fn close(&self, branches: &[Branch; E], found: &mut Solution<E>) {
        let mut beside = [true; E];
        let mut t = 0;
        while t < Self::TREE {
            let e = self.tree[t];
            if e < E {
                beside[e] = false;
            }
            t += 1;
        }
        let mut t = 0;
        while t < Self::TREE {
            let mut current_a = 0.0;
            let mut e = 0;
            while e < E {
                if beside[e] {
                    current_a -= self.counts(&branches[e], t) * found.current_a[e];
                }
                e += 1;
            }
            let e = self.tree[t];
            if e < E {
                found.current_a[e] = current_a;
            }
            t += 1;
        }
    }

    /// Whether an element lies in the tree.
    pub(super) const fn in_tree(&self, element: usize) -> bool {
        let mut t = 0;
        while t < Self::TREE {
            if self.tree[t] == element {
                return true;
            }
            t += 1;
        }
        false
    }

    /// Potential of a node over the ground \[V\], from the voltages of all elements.
    pub(super) fn potential_v(&self, node: usize, voltage_v: &[Real; E]) -> Real {
        let over_ground = Branch { from: node, to: 0, element: Element::Current };
        let mut potential_v = 0.0;
        let mut t = 0;
        while t < Self::TREE {
            potential_v += self.counts(&over_ground, t) * at(voltage_v, self.tree[t]);
            t += 1;
        }
        potential_v
    }
}

/// A node that is in another part than the ground.
const fn floating<const N: usize>(part: &[usize; N]) -> usize {
    let mut n = 0;
    while n < N {
        if part[n] != part[0] {
            return n;
        }
        n += 1;
    }
    0
}

/// An entry that is there.
#[inline]
const fn at<const L: usize>(values: &[Real; L], i: usize) -> Real {
    if i < L { values[i] } else { 0.0 }
}
