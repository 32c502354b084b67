//! Three phases as a rotating pair: Clarke, Park, the space vector, and the averaged inverter.
//!
//! Amplitude-invariant, the neutral point floating: a vector is as long as the peak of its phase
//! quantity, and the power of three phases is `3/2·(v_d·i_d + v_q·i_q)`.
//!
//! ```
//! use plant_core::machine::transform::{Abc, Dq, RotorAngle, duties};
//!
//! let angle = RotorAngle::of_turns(0.1);
//! let (voltage_v, current_a) = (Dq { d: -20.0, q: 150.0 }, Dq { d: -30.0, q: 80.0 });
//! let (legs, phases): (Abc, Abc) =
//!     (duties(voltage_v.to_stator(angle), 360.0), current_a.to_stator(angle).to_phases());
//! // What the legs draw from the bus is what the machine takes.
//! let bus_w = 360.0 * (legs.a * phases.a + legs.b * phases.b + legs.c * phases.c);
//! assert!((bus_w / (1.5 * voltage_v.dot(current_a)) - 1.0).abs() < 1e-5);
//! ```

use core::ops::{Add, Mul, Sub};

use crate::num::{Real, clamp, max, min, sin_cos_turns, sqrt};

/// √3.
#[allow(clippy::excessive_precision, reason = "digits that the f64 twin needs")]
const ROOT_3: Real = 1.732_050_807_568_877_2;
/// The longest voltage vector of the space-vector modulation over the bus voltage, 1/√3.
pub const LARGEST_PER_BUS: Real = 1.0 / ROOT_3;

/// A vector in the frame of the rotor: d along the magnets' flux, q a quarter turn ahead.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Dq {
    /// Along the direct axis.
    pub d: Real,
    /// Along the quadrature axis.
    pub q: Real,
}

impl Dq {
    /// No vector.
    pub const ZERO: Self = Self { d: 0.0, q: 0.0 };

    /// The scalar product.
    #[inline]
    #[must_use]
    pub const fn dot(self, other: Self) -> Real {
        self.d * other.d + self.q * other.q
    }

    /// A quarter turn ahead.
    #[inline]
    #[must_use]
    pub const fn turned(self) -> Self {
        Self { d: -self.q, q: self.d }
    }

    /// Its length: the peak of the phase quantity.
    #[inline]
    #[must_use]
    pub fn length(self) -> Real {
        sqrt(self.dot(self))
    }

    /// Itself, or shortened to `longest` (≥ 0) in its own direction.
    #[inline]
    #[must_use]
    pub fn within(self, longest: Real) -> Self {
        let square = self.dot(self);
        if square > longest * longest { self * (longest / sqrt(square)) } else { self }
    }

    /// In the frame of the stator (inverse Park).
    #[inline]
    #[must_use]
    pub const fn to_stator(self, rotor: RotorAngle) -> AlphaBeta {
        AlphaBeta {
            alpha: rotor.cos * self.d - rotor.sin * self.q,
            beta: rotor.sin * self.d + rotor.cos * self.q,
        }
    }
}

impl Add for Dq {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { d: self.d + other.d, q: self.q + other.q }
    }
}

impl Sub for Dq {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self { d: self.d - other.d, q: self.q - other.q }
    }
}

impl Mul<Real> for Dq {
    type Output = Self;

    #[inline]
    fn mul(self, factor: Real) -> Self {
        Self { d: self.d * factor, q: self.q * factor }
    }
}

/// A vector in the frame of the stator: α along phase a, β a quarter turn ahead.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AlphaBeta {
    /// Along phase a.
    pub alpha: Real,
    /// A quarter turn ahead of it.
    pub beta: Real,
}

impl AlphaBeta {
    /// In the frame of the rotor (Park).
    #[inline]
    #[must_use]
    pub const fn to_rotor(self, rotor: RotorAngle) -> Dq {
        Dq {
            d: rotor.cos * self.alpha + rotor.sin * self.beta,
            q: rotor.cos * self.beta - rotor.sin * self.alpha,
        }
    }

    /// As three phases whose sum is zero (inverse Clarke).
    #[inline]
    #[must_use]
    pub const fn to_phases(self) -> Abc {
        let (half, side) = (0.5 * self.alpha, 0.5 * ROOT_3 * self.beta);
        Abc { a: self.alpha, b: side - half, c: -side - half }
    }
}

/// One quantity of three phases.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Abc {
    /// Phase a.
    pub a: Real,
    /// Phase b, a third of a turn later.
    pub b: Real,
    /// Phase c, two thirds of a turn later.
    pub c: Real,
}

impl Abc {
    /// As one vector (Clarke); what the three have in common drops out.
    #[inline]
    #[must_use]
    pub const fn to_vector(self) -> AlphaBeta {
        AlphaBeta {
            alpha: (2.0 * self.a - self.b - self.c) / 3.0,
            beta: (self.b - self.c) / ROOT_3,
        }
    }
}

/// The electrical angle from phase a to the rotor's d axis, carried as sine and cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RotorAngle {
    /// Sine of the angle.
    pub sin: Real,
    /// Cosine of the angle.
    pub cos: Real,
}

impl RotorAngle {
    /// An angle counted in turns.
    #[must_use]
    pub fn of_turns(turns: Real) -> Self {
        let (sin, cos) = sin_cos_turns(turns);
        Self { sin, cos }
    }
}

/// The duties (0..1) with which three legs on a bus make a voltage, by space-vector modulation:
/// both zero vectors for equally long, which is the middle of the largest and the smallest phase
/// voltage taken off all three \[Broeck1988\]. Exact up to
/// [`LARGEST_PER_BUS`] of the bus; cut off beyond, and 1/2 where there is no bus voltage.
#[must_use]
pub fn duties(voltage_v: AlphaBeta, bus_v: Real) -> Abc {
    let v = voltage_v.to_phases();
    let middle = 0.5 * (max(v.a, max(v.b, v.c)) + min(v.a, min(v.b, v.c)));
    let per_v = if bus_v > 0.0 { 1.0 / bus_v } else { 0.0 };
    let duty = |volts: Real| clamp(0.5 + per_v * (volts - middle), 0.0, 1.0);
    Abc { a: duty(v.a), b: duty(v.b), c: duty(v.c) }
}

/// The voltage that three legs with duties make on a bus, and the current that they draw from it
/// for the phase currents, which add up to zero. No power is lost: `V·I = Σ v·i`.
#[inline]
#[must_use]
pub const fn averaged_inverter(duties: Abc, bus_v: Real, current_a: Abc) -> (AlphaBeta, Real) {
    let legs_v = Abc { a: bus_v * duties.a, b: bus_v * duties.b, c: bus_v * duties.c };
    let bus_a = duties.a * current_a.a + duties.b * current_a.b + duties.c * current_a.c;
    (legs_v.to_vector(), bus_a)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    fn near(a: Real, b: Real, within: Real) -> bool {
        (a - b).abs() <= within
    }

    /// Vectors and angles all round.
    fn all_round() -> impl Iterator<Item = (Dq, RotorAngle, f64)> {
        (0..360_u16).map(|n| {
            let turns = Real::from(n) / 360.0;
            let (sin, cos) = (f64::from(7 * n) / 57.3).sin_cos();
            let vector = Dq { d: 100.0 * cos as Real, q: 100.0 * sin as Real };
            (vector, RotorAngle::of_turns(turns), std::f64::consts::TAU * f64::from(turns))
        })
    }

    #[test]
    fn a_vector_turns_as_three_cosines() {
        for (v, rotor, angle) in all_round() {
            let phases = v.to_stator(rotor).to_phases();
            for (k, phase) in [phases.a, phases.b, phases.c].into_iter().enumerate() {
                let along = angle - std::f64::consts::TAU * k as f64 / 3.0;
                let exact = f64::from(v.d) * along.cos() - f64::from(v.q) * along.sin();
                assert!(near(phase, exact as Real, 1e-4), "{k}: {phase} {exact}");
            }
            let back = phases.to_vector().to_rotor(rotor);
            assert!(near(back.d, v.d, 1e-4) && near(back.q, v.q, 1e-4), "{back:?} {v:?}");
            assert!(near(v.length(), 100.0, 1e-4));
        }
    }

    #[test]
    fn what_phases_have_in_common_drops_out() {
        let common = Abc { a: 103.0, b: 98.0, c: 99.0 };
        let v = common.to_vector();
        assert!(near(v.alpha, 3.0, 1e-5) && near(v.beta, -1.0 / ROOT_3, 1e-5), "{v:?}");
    }

    #[test]
    fn the_inverter_makes_what_is_asked_up_to_its_circle_and_loses_nothing() {
        for (v, rotor, _) in all_round() {
            let asked = (v * (LARGEST_PER_BUS * 3.6)).to_stator(rotor);
            let current = Dq { d: -30.0, q: 80.0 }.to_stator(rotor).to_phases();
            let legs = duties(asked, 360.0);
            let (made, bus_a) = averaged_inverter(legs, 360.0, current);
            assert!(near(made.alpha, asked.alpha, 1e-4 * 360.0), "{made:?} {asked:?}");
            assert!(near(made.beta, asked.beta, 1e-4 * 360.0), "{made:?} {asked:?}");
            let phases = made.to_phases();
            let taken_w = phases.a * current.a + phases.b * current.b + phases.c * current.c;
            assert!(near(360.0 * bus_a, taken_w, 0.05), "{bus_a} {taken_w}");
        }
        // The circle touches the hexagon: a longer vector is cut off somewhere.
        let beyond = AlphaBeta { alpha: 0.0, beta: 1.05 * LARGEST_PER_BUS * 360.0 };
        let (made, _) = averaged_inverter(duties(beyond, 360.0), 360.0, Abc::default());
        assert!(near(made.beta, LARGEST_PER_BUS * 360.0, 1e-3), "{made:?}");
        assert_eq!(duties(beyond, 0.0), Abc { a: 0.5, b: 0.5, c: 0.5 });
    }

    #[test]
    fn a_vector_is_shortened_in_its_direction() {
        let v = Dq { d: -3.0, q: 4.0 };
        assert_eq!((v.within(5.0), v.within(6.0)), (v, v));
        let short = v.within(2.5);
        assert!(near(short.d, -1.5, 1e-6) && near(short.q, 2.0, 1e-6));
        assert_eq!(Dq::ZERO.within(0.0), Dq::ZERO);
        assert_eq!(v.turned(), Dq { d: -4.0, q: -3.0 });
        assert_eq!((v.dot(v.turned()), (v - v) + v), (0.0, v));
    }
}
