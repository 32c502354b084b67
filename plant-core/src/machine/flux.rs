//! Flux linkage of a synchronous machine over its currents: two inductances, or a measured map.

use crate::error::{ParamError, check, finite, not_negative, positive};
use crate::machine::transform::Dq;
use crate::num::{Real, clamp};

/// Flux linkage of a winding in the frame of the rotor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Flux {
    /// Constant inductances.
    Linear(LinearFlux),
    /// Measured or computed points: saturation, and what one axis does to the other.
    #[cfg_attr(feature = "serde", serde(skip))]
    Map(FluxMap),
}

/// `ψ_d = L_d·i_d + ψ_m`, `ψ_q = L_q·i_q` \[EPowertrain2025, PMSM\].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct LinearFlux {
    /// Flux linkage of the magnets \[Wb\], peak of a phase, ≥ 0; 0 only where the axes differ.
    pub magnet_wb: Real,
    /// Inductance of the d axis \[H\], above zero.
    pub d_h: Real,
    /// Inductance of the q axis \[H\], above zero.
    pub q_h: Real,
}

/// Flux linkages on an even grid of currents, read by cubic convolution in both directions
/// \[Keys1981\], so that the inductances are continuous. Beyond the grid the flux goes on straight with
/// the inductances of its edge, and the machine says so.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FluxMap {
    /// Currents of the d axis.
    pub d: FluxAxis,
    /// Currents of the q axis, both directions.
    pub q: FluxAxis,
    /// `[ψ_d, ψ_q]` \[Wb\] at each point, the current of the q axis running fastest. A table in
    /// flash, or read once from a file and kept. More current in a direction must make more flux
    /// in it: checked at the points and midway between them.
    pub flux_wb: &'static [[Real; 2]],
}

/// The currents of one axis of a [`FluxMap`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FluxAxis {
    /// Lowest current \[A\].
    pub start_a: Real,
    /// From one point to the next \[A\], above zero.
    pub step_a: Real,
    /// How many points, four at least.
    pub points: u16,
}

/// Flux linkage at a current, and how it grows from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluxPoint {
    /// Flux linkage \[Wb\].
    pub flux_wb: Dq,
    /// `∂ψ_d/∂i_d` \[H\].
    pub dd_h: Real,
    /// `∂ψ_d/∂i_q` \[H\].
    pub dq_h: Real,
    /// `∂ψ_q/∂i_d` \[H\].
    pub qd_h: Real,
    /// `∂ψ_q/∂i_q` \[H\].
    pub qq_h: Real,
    /// The current lies beyond the map.
    pub beyond_map: bool,
}

impl Flux {
    pub(crate) const fn checked(self) -> Result<Self, ParamError> {
        match self {
            Self::Linear(linear) => {
                check!(not_negative("pmsm.flux.magnet_wb", linear.magnet_wb));
                check!(positive("pmsm.flux.d_h", linear.d_h));
                check!(positive("pmsm.flux.q_h", linear.q_h));
                if linear.magnet_wb == 0.0 && linear.d_h == linear.q_h {
                    return Err(ParamError::OutOfRange("pmsm.flux.magnet_wb"));
                }
            }
            Self::Map(map) => {
                check!(map.checked());
            }
        }
        Ok(self)
    }

    /// Flux linkage and incremental inductances at a current.
    #[inline]
    #[must_use]
    pub const fn at(&self, current_a: Dq) -> FluxPoint {
        match self {
            Self::Linear(linear) => linear.at(current_a),
            Self::Map(map) => map.at(current_a),
        }
    }

    /// The inductances and magnets with which a linear machine would make the same flux at a
    /// current, and grow alike along d: what closed forms need of a map.
    #[must_use]
    pub const fn near(&self, current_a: Dq) -> LinearFlux {
        match self {
            Self::Linear(linear) => *linear,
            Self::Map(map) => map.near(current_a),
        }
    }

    /// The mean of both axes' inductances without current \[H\].
    pub(crate) const fn mean_h(&self) -> Real {
        let point = self.at(Dq::ZERO);
        0.5 * (point.dd_h + point.qq_h)
    }

    /// Energy of the field at a current, less that without current \[J\]: `3/2·(i·ψ − ∫ψ·di)`,
    /// along the straight line. Not for a hot step: a map is read 65 times.
    #[must_use]
    pub fn energy_j(&self, current_a: Dq) -> Real {
        match self {
            Self::Linear(linear) => {
                let Dq { d, q } = current_a;
                0.75 * (linear.d_h * d * d + linear.q_h * q * q)
            }
            Self::Map(map) => {
                let psi = map.at(current_a).flux_wb - map.mean_wb(current_a);
                1.5 * current_a.dot(psi)
            }
        }
    }
}

impl LinearFlux {
    #[inline]
    const fn at(&self, current_a: Dq) -> FluxPoint {
        FluxPoint {
            flux_wb: Dq { d: self.magnet_wb + self.d_h * current_a.d, q: self.q_h * current_a.q },
            dd_h: self.d_h,
            dq_h: 0.0,
            qd_h: 0.0,
            qq_h: self.q_h,
            beyond_map: false,
        }
    }
}

impl FluxAxis {
    const fn checked(
        self,
        start: &'static str,
        step: &'static str,
        points: &'static str,
    ) -> Result<(), ParamError> {
        check!(finite(start, self.start_a));
        check!(positive(step, self.step_a));
        if self.points < 4 { Err(ParamError::OutOfRange(points)) } else { Ok(()) }
    }

    const fn end_a(self) -> Real {
        self.start_a + self.step_a * (self.points as Real - 1.0)
    }

    /// Four points around a current, and what each of them weighs.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "held within the grid first"
    )]
    const fn find(self, current_a: Real) -> Stencil {
        let cells = if self.points < 4 { 3 } else { self.points as usize - 1 };
        let held_a = clamp(current_a, self.start_a, self.end_a());
        let x = clamp((held_a - self.start_a) / self.step_a, 0.0, cells as Real);
        let cell = if (x as usize) < cells { x as usize } else { cells - 1 };
        let s = x - cell as Real;
        let (value, slope) = (weights(s), slopes(s));
        // At the ends a point is missing: it is thought on the straight line of the last two.
        let (first, value, slope) = if cell == 0 {
            (0, lower(value), lower(slope))
        } else if cell == cells - 1 {
            (cells - 3, upper(value), upper(slope))
        } else {
            (cell - 1, value, slope)
        };
        Stencil { first, value, slope, per_a: 1.0 / self.step_a, beyond_a: current_a - held_a }
    }
}

/// Where to read along one axis.
struct Stencil {
    first: usize,
    value: [Real; 4],
    slope: [Real; 4],
    per_a: Real,
    beyond_a: Real,
}

/// Weights of the four points around a place `s` (0..1) between the middle two \[Keys1981,
/// a = −1/2\].
const fn weights(s: Real) -> [Real; 4] {
    let r = 1.0 - s;
    [
        -0.5 * s * r * r,
        1.0 - 0.5 * s * s * (5.0 - 3.0 * s),
        1.0 - 0.5 * r * r * (5.0 - 3.0 * r),
        -0.5 * r * s * s,
    ]
}

/// The weights' derivatives.
const fn slopes(s: Real) -> [Real; 4] {
    let r = 1.0 - s;
    [
        0.5 * r * (3.0 * s - 1.0),
        0.5 * s * (9.0 * s - 10.0),
        -0.5 * r * (9.0 * r - 10.0),
        -0.5 * s * (3.0 * r - 1.0),
    ]
}

const fn lower([ghost, a, b, c]: [Real; 4]) -> [Real; 4] {
    [a + 2.0 * ghost, b - ghost, c, 0.0]
}

const fn upper([a, b, c, ghost]: [Real; 4]) -> [Real; 4] {
    [0.0, a, b - ghost, c + 2.0 * ghost]
}

/// Four points of one row, weighed: both fluxes.
const fn weigh(row: &[[Real; 2]; 4], by: &[Real; 4]) -> Dq {
    let [[a, e], [b, f], [c, g], [d, h]] = *row;
    let [w, x, y, z] = *by;
    Dq { d: w * a + x * b + y * c + z * d, q: w * e + x * f + y * g + z * h }
}

impl FluxMap {
    const fn checked(&self) -> Result<(), ParamError> {
        const D: [&str; 3] = ["pmsm.flux.d.start_a", "pmsm.flux.d.step_a", "pmsm.flux.d.points"];
        const Q: [&str; 3] = ["pmsm.flux.q.start_a", "pmsm.flux.q.step_a", "pmsm.flux.q.points"];
        check!(self.d.checked(D[0], D[1], D[2]));
        check!(self.q.checked(Q[0], Q[1], Q[2]));
        if self.flux_wb.len() != self.d.points as usize * self.q.points as usize {
            return Err(ParamError::LengthsDiffer("pmsm.flux.flux_wb"));
        }
        let mut rest = self.flux_wb;
        while let [[d, q], tail @ ..] = rest {
            check!(finite("pmsm.flux.flux_wb", *d));
            check!(finite("pmsm.flux.flux_wb", *q));
            rest = tail;
        }
        // Inductances must be positive definite, or a step could gain energy.
        let (mut d, mut q) = (0.0, 0.0);
        while d < 2.0 * self.d.points as Real - 1.0 {
            let p = self.at(Dq {
                d: self.d.start_a + 0.5 * d * self.d.step_a,
                q: self.q.start_a + 0.5 * q * self.q.step_a,
            });
            let mutual_h = p.dq_h + p.qd_h;
            if !(p.dd_h > 0.0 && 4.0 * p.dd_h * p.qq_h > mutual_h * mutual_h) {
                return Err(ParamError::Decreasing("pmsm.flux.flux_wb"));
            }
            q += 1.0;
            if q >= 2.0 * self.q.points as Real - 1.0 {
                (d, q) = (d + 1.0, 0.0);
            }
        }
        Ok(())
    }

    /// Four points from `at` on; none where the table is too short, which `checked` excludes.
    const fn four(&self, at: usize) -> Option<&[[Real; 2]; 4]> {
        match self.flux_wb.split_at_checked(at) {
            Some((_, tail)) => tail.first_chunk(),
            None => None,
        }
    }

    const fn at(&self, current_a: Dq) -> FluxPoint {
        let (d, q) = (self.d.find(current_a.d), self.q.find(current_a.q));
        // Each row at the place along q, and its slope there.
        let (mut value, mut along_q) = ([[0.0; 2]; 4], [[0.0; 2]; 4]);
        let mut row = 0;
        while row < 4 {
            let Some(points) = self.four((d.first + row) * self.q.points as usize + q.first) else {
                break;
            };
            let (v, s) = (weigh(points, &q.value), weigh(points, &q.slope));
            // Shifted in, so that no index can be out of bounds.
            value = [value[1], value[2], value[3], [v.d, v.q]];
            along_q = [along_q[1], along_q[2], along_q[3], [s.d, s.q]];
            row += 1;
        }
        let (flux, by_d, by_q) =
            (weigh(&value, &d.value), weigh(&value, &d.slope), weigh(&along_q, &d.value));
        let (dd_h, qd_h) = (by_d.d * d.per_a, by_d.q * d.per_a);
        let (dq_h, qq_h) = (by_q.d * q.per_a, by_q.q * q.per_a);
        FluxPoint {
            flux_wb: Dq {
                d: flux.d + dd_h * d.beyond_a + dq_h * q.beyond_a,
                q: flux.q + qd_h * d.beyond_a + qq_h * q.beyond_a,
            },
            dd_h,
            dq_h,
            qd_h,
            qq_h,
            beyond_map: d.beyond_a != 0.0 || q.beyond_a != 0.0,
        }
    }

    const fn near(&self, current_a: Dq) -> LinearFlux {
        let point = self.at(current_a);
        // Close to zero the quotient would be one of rounding errors.
        let q_h = if current_a.q.abs() > 0.5 * self.q.step_a {
            point.flux_wb.q / current_a.q
        } else {
            point.qq_h
        };
        LinearFlux { magnet_wb: point.flux_wb.d - point.dd_h * current_a.d, d_h: point.dd_h, q_h }
    }

    /// The mean of the flux on the straight line from no current, by Simpson's rule.
    fn mean_wb(&self, to: Dq) -> Dq {
        const PIECES: u8 = 32;
        let (mut sum, share) = (Dq::ZERO, 1.0 / (2.0 * Real::from(PIECES)));
        for n in 0..=2 * PIECES {
            let weight = match n {
                0 => 1.0,
                n if n == 2 * PIECES => 1.0,
                n if n % 2 == 1 => 4.0,
                _ => 2.0,
            };
            sum = sum + self.at(to * (share * Real::from(n))).flux_wb * weight;
        }
        sum * (share / 3.0)
    }
}

#[cfg(test)]
mod tests;
