//! What components say to each other within a step.
//!
//! Going down the chain, each component offers the next one a straight line: how its answer depends
//! on the increment that is not known yet ([`Source`], [`DriveLaw`]). The vehicle at the end solves
//! one equation; going back, each component settles its own state. Drives on one battery share the
//! bus voltage as well ([`BusLaw`]). What resists alike in every step
//! ([`Coast`]) is composed down the same chain once, when the plant is made. A new machine, axle or
//! source joins by giving the same line.
//!
//! The port laws are ours; the projection of a set-valued friction is the implicit step of
//! \[AcaryBrogliato2008\] for one friction.
//!
//! Tests: in the components that use them; properties `passivity`, `standstill`.

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

/// What a machine offers over one step, its own state eliminated: `effort − slope·Δ`, Δ the
/// increment of the speed. At a shaft the effort is a torque \[N·m\] over rad/s; seen from the
/// road ([`Winding::reflected`](crate::machine::dc::Winding::reflected)) a force \[N\] over m/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveLaw {
    /// Torque or force if the speed stayed as it is.
    pub effort: Real,
    /// How much a speed increment lowers it.
    pub slope: Real,
}

impl core::ops::Add for DriveLaw {
    type Output = Self;

    /// Two machines on the same shaft, or two axles on the same road.
    #[inline]
    fn add(self, other: Self) -> Self {
        Self { effort: self.effort + other.effort, slope: self.slope + other.slope }
    }
}

/// What drives offer over one step, their own states eliminated: lines in what they all share, the
/// rise u of the bus voltage above some voltage near it, and the increment Δ of the road's speed.
/// Laws on one bus and one road add.
///
/// `I = current_a + conductance_s·u − a_per_speed·Δ`, `F = effort + effort_per_v·u − slope·Δ`, I
/// positive when it leaves the bus.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BusLaw {
    /// Current if voltage and speed stayed as they are \[A\].
    pub current_a: Real,
    /// How much more a voltage draws \[S\].
    pub conductance_s: Real,
    /// How much a speed increment lowers the current.
    pub a_per_speed: Real,
    /// Force if voltage and speed stayed as they are \[N\].
    pub effort: Real,
    /// How much more a voltage gives.
    pub effort_per_v: Real,
    /// How much a speed increment lowers the force.
    pub slope: Real,
}

impl core::ops::Add for BusLaw {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            current_a: self.current_a + other.current_a,
            conductance_s: self.conductance_s + other.conductance_s,
            a_per_speed: self.a_per_speed + other.a_per_speed,
            effort: self.effort + other.effort,
            effort_per_v: self.effort_per_v + other.effort_per_v,
            slope: self.slope + other.slope,
        }
    }
}

/// The rise of a bus voltage under all that draws from it: `u = idle_v + v_per_speed·Δ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BusRise {
    /// If the speed stayed as it is \[V\].
    pub idle_v: Real,
    /// How much a speed increment adds.
    pub v_per_speed: Real,
}

impl BusRise {
    /// Once the speed increment is known \[V\].
    #[inline]
    #[must_use]
    pub const fn at(self, speed_increment: Real) -> Real {
        self.idle_v + self.v_per_speed * speed_increment
    }
}

impl BusLaw {
    /// On a source, which eliminates the voltage: with `ρ = R/(1 + R·ΣY)`,
    /// `u = (E − V_0 − R·ΣI_0)/(1 + R·ΣY) + ρ·ΣT·Δ`, `V_0` = `from_v` being the voltage that the laws
    /// count from. Nothing is lost where the rise is small against it.
    #[inline(always)]
    #[must_use]
    pub const fn on(self, source: Source, from_v: Real) -> (DriveLaw, BusRise) {
        let share = 1.0 / (1.0 + source.resistance_ohm * self.conductance_s);
        let idle_v = ((source.emf_v - from_v) - source.resistance_ohm * self.current_a) * share;
        let v_per_speed = source.resistance_ohm * share * self.a_per_speed;
        (
            DriveLaw {
                effort: self.effort + self.effort_per_v * idle_v,
                slope: self.slope - self.effort_per_v * v_per_speed,
            },
            BusRise { idle_v, v_per_speed },
        )
    }
}

/// What resists on a shaft or at the road whatever drives it. It does not change from step to
/// step, so a chain of components adds it up once, when the plant is made.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coast {
    /// Inertia over the step \[kg·m²/s\] or \[kg/s\].
    pub inertia_per_h: Real,
    /// Viscous friction \[N·m·s/rad\] or \[N·s/m\].
    pub viscous: Real,
    /// Coulomb friction \[N·m\] or \[N\]; projected once, at the end of the chain.
    pub coulomb: Real,
}

impl Coast {
    /// Both on the same shaft.
    #[inline]
    #[must_use]
    pub const fn plus(self, other: Self) -> Self {
        Self {
            inertia_per_h: self.inertia_per_h + other.inertia_per_h,
            viscous: self.viscous + other.viscous,
            coulomb: self.coulomb + other.coulomb,
        }
    }

    /// Seen from a place that moves by 1 where this shaft turns by `ratio`.
    #[inline]
    #[must_use]
    pub const fn reflected(self, ratio: Real) -> Self {
        Self {
            inertia_per_h: self.inertia_per_h * (ratio * ratio),
            viscous: self.viscous * (ratio * ratio),
            coulomb: self.coulomb * ratio,
        }
    }

    /// How much a speed increment is resisted: inertia and viscous friction.
    #[inline]
    #[must_use]
    pub const fn slope(self) -> Real {
        self.inertia_per_h + self.viscous
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
    if reached.abs() <= grip {
        (-x, Slip::Stuck)
    } else if reached < 0.0 {
        (free + grip, Slip::Backward)
    } else {
        // Also where a force is not a number, so that the caller sees it.
        (free - grip, Slip::Forward)
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
    fn a_bus_law_on_a_source_solves_both_equations() {
        let one = BusLaw {
            current_a: -20.0,
            conductance_s: 0.1,
            a_per_speed: 3.0,
            effort: -500.0,
            effort_per_v: 4.0,
            slope: 90.0,
        };
        let source = Source { emf_v: 400.0, resistance_ohm: 0.5 };
        for law in [one, one + one] {
            let (drive, rise) = law.on(source, 380.0);
            for increment in [0.0, 1.0, -2.0] {
                let u = rise.at(increment);
                let a = law.current_a + law.conductance_s * u - law.a_per_speed * increment;
                assert!((source.voltage_v(a) - 380.0 - u).abs() < 1e-3, "{u}");
                let n = law.effort + law.effort_per_v * u - law.slope * increment;
                assert!((drive.effort - drive.slope * increment - n).abs() < 1e-2, "{n}");
            }
        }
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
    fn axles_add_and_shafts_reflect() {
        let a = DriveLaw { effort: 1.0, slope: 2.0 };
        assert_eq!(a + a, DriveLaw { effort: 2.0, slope: 4.0 });
        let shaft = Coast { inertia_per_h: 3.0, viscous: 0.5, coulomb: 1.5 };
        let road = shaft.plus(shaft).reflected(10.0);
        assert_eq!(road, Coast { inertia_per_h: 600.0, viscous: 100.0, coulomb: 30.0 });
        assert_eq!(road.slope(), 700.0);
    }
}
