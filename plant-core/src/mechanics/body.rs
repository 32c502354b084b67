//! Body: mass, air, rolling resistance, slope, friction brake.
//!
//! `M·dv/dt = F − ½·ρ·C_d·A_f·v·|v| − C_r·M·g·cos α·sgn(v) − M·g·sin α − F_brake·sgn(v)`
//! \[EPowertrain2025, eq. 3.10 to 3.15; the print divides by `A_f`\]. Wind, brake and the road load
//! `A + B·v + C·v²` of a coast-down test are ours, and so are the factors of air density and rolling
//! resistance that a step may bring.
//!
//! Drag with wind w is taken as `c·|v + w|·(v' + w)`, v' the new speed; rolling resistance and
//! brake are set-valued and projected once, so standstill is exact and holds on a slope.
//!
//! Tests: `tests` below; properties `finite`, `refusal`, `standstill`; order of convergence in
//! `tests/tests/order.rs`; cases "body, coasting to a stop", "body on a slope".

use crate::error::{ParamError, check, not_negative, positive};
use crate::mechanics::slope::Grade;
use crate::model::{Dt, impl_model};
use crate::num::{Accum, GRAVITY_M_S2, LARGEST_PARAM, Real, sane};
use crate::port::{Coast, DriveLaw, Slip, project};

/// Parameters of a vehicle's body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct BodyParams {
    /// Mass with load \[kg\], without what turns, above zero.
    pub mass_kg: Real,
    /// What resists the motion on a flat road.
    pub resistance: RoadResistance,
}

/// What resists the motion on a flat road: by physics, or as a coast-down test found it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case", deny_unknown_fields))]
pub enum RoadResistance {
    /// Drag `½·ρ·C_d·A_f·v²` and rolling resistance `C_r·M·g·cos α`.
    Physical {
        /// Drag coefficient `C_d`, ≥ 0.
        drag_coefficient: Real,
        /// Frontal area `A_f` \[m²\], ≥ 0.
        frontal_area_m2: Real,
        /// Density of the air ρ \[kg/m³\], ≥ 0.
        air_density_kg_m3: Real,
        /// Rolling resistance coefficient `C_r`, ≥ 0.
        rolling_coefficient: Real,
    },
    /// Road load `A + B·v + C·v²` of a coast-down test.
    CoastDown {
        /// A: the part that does not depend on speed \[N\], ≥ 0.
        a_n: Real,
        /// B: the part that grows with speed \[N·s/m\]. A fit may find it negative: down to −2·√(A·C),
        /// where the force is positive at any speed (with the [`Road`]'s factors at 1), and to half
        /// of the mass over the step.
        b_n_s_per_m: Real,
        /// C: the part that grows with its square \[N·s²/m²\], ≥ 0; it takes the wind.
        c_n_s2_per_m2: Real,
    },
}

/// A body that moves along the road, discretised for one step.
///
/// ```
/// use plant_core::mechanics::body::{Body, BodyInput, BodyParams, BodyState, RoadResistance};
/// use plant_core::{Dt, must};
///
/// const NO_RESISTANCE: RoadResistance =
///     RoadResistance::CoastDown { a_n: 0.0, b_n_s_per_m: 0.0, c_n_s2_per_m2: 0.0 };
/// const BODY: Body = must!(Body::new(
///     BodyParams { mass_kg: 1000.0, resistance: NO_RESISTANCE },
///     must!(Dt::from_s(0.01)),
/// ));
///
/// let mut state = BodyState::default();
/// for _ in 0..1000 {
///     BODY.step(&mut state, BodyInput { force_n: 500.0, ..BodyInput::default() });
/// }
/// assert!((state.speed_m_s.get() - 5.0).abs() < 1e-4); // F·t/M after 10 s
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    pub(crate) mass_kg: Real,
    pub(crate) coast: Coast,
    pub(crate) weight_n: Real,
    pub(crate) rolling_n: Real,
    drag_n_s2_per_m2: Real,
    dt_s: Real,
}

/// The state of a [`Body`]; at rest by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BodyState {
    /// Speed along the road \[m/s\].
    pub speed_m_s: Accum,
    /// Distance along the road \[m\].
    pub distance_m: Accum,
}

/// The road and the weather over one step; by default flat, calm and as the parameters have it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Road {
    /// The slope, no steeper than 45°.
    pub grade: Grade,
    /// Wind against the vehicle \[m/s\].
    pub headwind_m_s: Real,
    /// Force of the friction brake \[N\], ≥ 0.
    pub brake_n: Real,
    /// Density of the air over that of the parameters, ≥ 0: with it drag, or C of a coast-down
    /// test, grows.
    pub air_density_factor: Real,
    /// Rolling resistance over that of the parameters, ≥ 0, for cold tyres or a wet road: with it
    /// the rolling resistance, or A of a coast-down test, grows.
    pub rolling_factor: Real,
}

impl Default for Road {
    fn default() -> Self {
        Self {
            grade: Grade::default(),
            headwind_m_s: 0.0,
            brake_n: 0.0,
            air_density_factor: 1.0,
            rolling_factor: 1.0,
        }
    }
}

impl Road {
    /// The sum of its magnitudes but the slope's, for one check of all.
    #[inline]
    pub(crate) const fn magnitude(&self) -> Real {
        // What is often constant is one term.
        (self.headwind_m_s.abs() + self.air_density_factor + self.rolling_factor)
            + self.brake_n.abs()
    }

    /// Whether the slope, the brake and the factors can be.
    #[inline(always)]
    pub(crate) const fn is_possible(&self) -> bool {
        self.grade.is_possible()
            && self.brake_n >= 0.0
            && self.air_density_factor >= 0.0
            && self.rolling_factor >= 0.0
    }
}

/// Input of a [`Body`] that steps on its own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyInput {
    /// Force of the wheels \[N\].
    pub force_n: Real,
    /// The road and the weather.
    pub road: Road,
}

/// Output of one step of a [`Body`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BodyOutput {
    /// Speed \[m/s\].
    pub speed_m_s: Real,
    /// Distance \[m\].
    pub distance_m: Real,
    /// Acceleration over the step \[m/s²\].
    pub acceleration_m_s2: Real,
    /// Force of the air, positive against forward motion \[N\].
    pub drag_n: Real,
    /// Whether and in which direction it moves.
    pub slip: Slip,
    /// An input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

/// What the body does over one step, before it is booked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Speed increment \[m/s\].
    pub increment_m_s: Real,
    /// Whether and in which direction it moves afterwards.
    pub slip: Slip,
}

/// The forces at the road that the increment does not know yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resistance {
    /// Force if the speed stayed as it is \[N\].
    pub force_n: Real,
    /// How much a speed increment lowers it, inertia included \[N·s/m\].
    pub slope_n_s_per_m: Real,
    /// Coulomb-type forces \[N\].
    pub friction_n: Real,
    /// `c·|v + w|` \[N·s/m\].
    pub drag_n_s_per_m: Real,
}

impl Resistance {
    /// The speed increment under a machine's law, seen from the road.
    #[inline]
    #[must_use]
    pub const fn solve(&self, drive: DriveLaw, speed_m_s: Real) -> Motion {
        let (increment_m_s, slip) = project(
            speed_m_s,
            self.force_n + drive.effort,
            self.slope_n_s_per_m + drive.slope,
            self.friction_n,
        );
        Motion { increment_m_s, slip }
    }
}

impl Body {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: BodyParams, dt: Dt) -> Result<Self, ParamError> {
        let mass_kg = check!(positive("body.mass_kg", params.mass_kg));
        let weight_n = mass_kg * GRAVITY_M_S2;
        let (rolling_n, viscous_n_s_per_m, drag_n_s2_per_m2) = match params.resistance {
            RoadResistance::Physical {
                drag_coefficient,
                frontal_area_m2,
                air_density_kg_m3,
                rolling_coefficient,
            } => {
                check!(not_negative("body.resistance.drag_coefficient", drag_coefficient));
                check!(not_negative("body.resistance.frontal_area_m2", frontal_area_m2));
                check!(not_negative("body.resistance.air_density_kg_m3", air_density_kg_m3));
                check!(not_negative("body.resistance.rolling_coefficient", rolling_coefficient));
                let drag = 0.5 * air_density_kg_m3 * drag_coefficient * frontal_area_m2;
                (rolling_coefficient * weight_n, 0.0, drag)
            }
            RoadResistance::CoastDown { a_n, b_n_s_per_m, c_n_s2_per_m2 } => {
                check!(not_negative("body.resistance.a_n", a_n));
                check!(not_negative("body.resistance.c_n_s2_per_m2", c_n_s2_per_m2));
                let b = b_n_s_per_m;
                let resists =
                    b >= 0.0 || b * b <= 4.0 * a_n * c_n_s2_per_m2 && -2.0 * b * dt.s() <= mass_kg;
                if !(resists && b <= LARGEST_PARAM) {
                    return Err(ParamError::OutOfRange("body.resistance.b_n_s_per_m"));
                }
                (a_n, b_n_s_per_m, c_n_s2_per_m2)
            }
        };
        Ok(Self {
            mass_kg,
            coast: Coast {
                inertia_per_h: mass_kg / dt.s(),
                viscous: viscous_n_s_per_m,
                coulomb: 0.0,
            },
            weight_n,
            rolling_n,
            drag_n_s2_per_m2,
            dt_s: dt.s(),
        })
    }

    /// Mass and viscous resistance, to join a chain.
    #[must_use]
    pub const fn coast(&self) -> Coast {
        self.coast
    }

    /// What resists at the road over one step: air, slope, rolling, brake, and `coast`, all that
    /// moves with the body and itself.
    #[inline]
    #[must_use]
    pub const fn resistance(&self, road: &Road, coast: Coast, speed_m_s: Real) -> Resistance {
        let air_m_s = speed_m_s + road.headwind_m_s;
        let drag_n_s_per_m = self.drag_n_s2_per_m2 * road.air_density_factor * air_m_s.abs();
        Resistance {
            force_n: -(drag_n_s_per_m * air_m_s
                + coast.viscous * speed_m_s
                + self.weight_n * road.grade.sin),
            slope_n_s_per_m: coast.slope() + drag_n_s_per_m,
            friction_n: self.rolling_n * road.rolling_factor * road.grade.cos
                + road.brake_n
                + coast.coulomb,
            drag_n_s_per_m,
        }
    }

    /// Books the motion found: the speed, and the distance `x += h·v'`.
    #[inline]
    pub const fn settle(state: &mut BodyState, motion: Motion, dt_s: Real) {
        if matches!(motion.slip, Slip::Stuck) {
            state.speed_m_s = Accum::new(0.0);
        } else {
            state.speed_m_s.add(motion.increment_m_s);
            state.distance_m.add(state.speed_m_s.get() * dt_s);
        }
    }

    /// Advances by one step on its own, under a force at the wheels.
    #[inline]
    pub fn step(&self, state: &mut BodyState, input: BodyInput) -> BodyOutput {
        let v = state.speed_m_s.get();
        let resistance = self.resistance(&input.road, self.coast, v);
        let mut motion = resistance.solve(DriveLaw { effort: input.force_n, slope: 0.0 }, v);
        let rejected = !(sane(input.force_n)
            && sane(input.road.magnitude())
            && input.road.is_possible()
            && sane(v + motion.increment_m_s));
        if rejected {
            motion.increment_m_s = 0.0;
        } else {
            Self::settle(state, motion, self.dt_s);
        }
        let speed_m_s = state.speed_m_s.get();
        BodyOutput {
            speed_m_s,
            distance_m: state.distance_m.get(),
            acceleration_m_s2: motion.increment_m_s / self.dt_s,
            drag_n: if rejected {
                0.0
            } else {
                resistance.drag_n_s_per_m * (speed_m_s + input.road.headwind_m_s)
            },
            slip: motion.slip,
            rejected,
        }
    }
}

impl_model!(Body, BodyState, BodyInput, BodyOutput);

#[cfg(test)]
mod tests;
