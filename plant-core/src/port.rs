//! What components say to each other within a step.
//!
//! Going down the chain, each component offers the next one a straight line: how its answer
//! depends on the increment that is not known yet. The vehicle at the end solves one equation;
//! going back, each component settles its own state. A new machine, axle or source joins by
//! giving the same line.

use crate::num::Real;

/// What two terminals offer over one step: `v = emf_v − resistance_ohm·i`, i positive when it
/// leaves the source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// Voltage without current \[V\].
    pub emf_v: Real,
    /// How much a current lowers it \[Ω\].
    pub resistance_ohm: Real,
}

impl Source {
    /// A source that holds its voltage at any current.
    #[inline]
    #[must_use]
    pub const fn stiff(emf_v: Real) -> Self {
        Self { emf_v, resistance_ohm: 0.0 }
    }

    /// The voltage at the terminals under `current_a`.
    #[inline]
    #[must_use]
    pub const fn voltage_v(self, current_a: Real) -> Real {
        self.emf_v - self.resistance_ohm * current_a
    }

    /// What is left for others once a load draws `current_a + conductance_s·v` (Thevenin).
    #[inline]
    #[must_use]
    pub const fn loaded(self, current_a: Real, conductance_s: Real) -> Self {
        let share = 1.0 / (1.0 + self.resistance_ohm * conductance_s);
        Self {
            emf_v: (self.emf_v - self.resistance_ohm * current_a) * share,
            resistance_ohm: self.resistance_ohm * share,
        }
    }
}

/// What a shaft offers over one step: `T = torque_nm − slope·Δω`, Δω the shaft's speed increment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TorqueLaw {
    /// Torque if the speed stayed as it is \[N·m\]; inertia and viscous friction included.
    pub torque_nm: Real,
    /// How much a speed increment lowers it \[N·m·s/rad\].
    pub slope_nm_s_per_rad: Real,
    /// Coulomb friction behind this shaft \[N·m\], ≥ 0; projected once, at the vehicle.
    pub friction_nm: Real,
    /// Torque that the shaft carried at the start of the step \[N·m\], for load-dependent losses.
    pub carried_nm: Real,
}

/// What an axle offers at the road over one step: `F = force_n − slope·Δv`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RoadLaw {
    /// Force if the speed stayed as it is \[N\].
    pub force_n: Real,
    /// How much a speed increment lowers it \[N·s/m\].
    pub slope_n_s_per_m: Real,
    /// Coulomb friction seen at the road \[N\], ≥ 0.
    pub friction_n: Real,
}

impl core::ops::Add for RoadLaw {
    type Output = Self;

    /// Two axles at the same road.
    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            force_n: self.force_n + other.force_n,
            slope_n_s_per_m: self.slope_n_s_per_m + other.slope_n_s_per_m,
            friction_n: self.friction_n + other.friction_n,
        }
    }
}

/// How a set-valued friction ended the step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Slip {
    /// Moving with positive speed.
    Forward,
    /// Moving with negative speed.
    Backward,
    /// Held at standstill, exactly.
    #[default]
    Stuck,
}

impl Slip {
    /// The direction in which friction acts against the motion: 1, −1, or 0 when stuck.
    #[inline]
    #[must_use]
    pub const fn sign(self) -> Real {
        match self {
            Self::Forward => 1.0,
            Self::Backward => -1.0,
            Self::Stuck => 0.0,
        }
    }
}

/// Solves `slope·Δ = force ∓ friction` for the increment Δ of a speed `x`, friction being
/// set-valued at standstill.
///
/// The step without friction gives `x* = x + force/slope`; then
/// `x = sgn(x*)·max(|x*| − friction/slope, 0)`. The result is an increment, so that nothing is
/// lost where it is small against `x`.
#[inline]
#[must_use]
pub const fn project(x: Real, force: Real, slope: Real, friction: Real) -> (Real, Slip) {
    let mobility = 1.0 / slope;
    let free = force * mobility;
    let grip = friction * mobility;
    let reached = x + free;
    if reached > grip {
        (free - grip, Slip::Forward)
    } else if reached < -grip {
        (free + grip, Slip::Backward)
    } else {
        (-x, Slip::Stuck)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_load_takes_its_share() {
        let s = Source { emf_v: 400.0, resistance_ohm: 0.5 }.loaded(2.0, 0.1);
        // i = 2 + 0.1·v + j with v = 400 − 0.5·i, solved by hand for j = 0 and j = 10.
        assert!((s.voltage_v(0.0) - 399.0 / 1.05).abs() < 1e-3);
        assert!((s.voltage_v(10.0) - 394.0 / 1.05).abs() < 1e-3);
        assert_eq!(Source::stiff(12.0).voltage_v(1e6), 12.0);
    }

    #[test]
    fn friction_holds_brakes_and_never_pushes() {
        for (x, force, increment, slip) in [
            (0.0, 50.0, 0.0, Slip::Stuck),
            (0.0, 70.0, 0.1, Slip::Forward),
            (0.0, -70.0, -0.1, Slip::Backward),
            (0.3, 0.0, -0.3, Slip::Stuck),
            (2.0, 0.0, -0.6, Slip::Forward),
            (-2.0, 0.0, 0.6, Slip::Backward),
        ] {
            let (found, mode) = project(x, force, 100.0, 60.0);
            assert!((found - increment).abs() < 1e-6 && mode == slip, "{x} {force}: {found}");
        }
    }

    #[test]
    fn axles_add() {
        let a = RoadLaw { force_n: 1.0, slope_n_s_per_m: 2.0, friction_n: 3.0 };
        assert_eq!(a + a, RoadLaw { force_n: 2.0, slope_n_s_per_m: 4.0, friction_n: 6.0 });
    }
}
