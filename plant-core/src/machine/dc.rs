//! DC motor: winding, back-EMF, rotor.
//!
//! `V = R·i + L·di/dt + Ke·ω` \[EPowertrain2025, eq. 3.2\] and
//! `J·dω/dt = Kt·i − T_load − b·ω − T_c·sgn(ω)` (eq. 3.3, with the static torque `T_c` that the
//! print leaves out).
//!
//! One step takes current and speed implicitly, together, for increments: with
//! `Y = 1/(L/h + R)`, `Δi = Y·(V − R·i − Ke·ω) − Y·Ke·Δω`, which leaves one equation for Δω, the
//! motor's [`DriveLaw`]. The Coulomb torque is set-valued, so standstill is exact.
//!
//! Tests: `tests` below; properties `finite`, `passivity`, `refusal`, `symmetry`; order of
//! convergence in `tests/tests/order.rs`; cases "DC motor step".

mod drive;

pub use drive::{DcDrive, DcDriveOutput, DcLink};

use crate::error::{ParamError, check, not_negative, positive};
use crate::model::{Dt, impl_model};
use crate::num::{Accum, Real, sane};
use crate::port::{Coast, DriveLaw, Slip, Source, project};

/// Parameters of a DC motor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct DcMotorParams {
    /// Winding resistance \[Ω\], above zero.
    pub resistance_ohm: Real,
    /// Winding inductance \[H\], above zero.
    pub inductance_h: Real,
    /// Back-EMF constant Ke \[V·s/rad\], above zero.
    pub back_emf_v_s_per_rad: Real,
    /// Torque constant Kt \[N·m/A\], above zero. Equal to Ke in a machine without iron losses;
    /// above Ke it creates energy (the ledger's `conversion` term).
    pub torque_nm_per_a: Real,
    /// Rotor inertia \[kg·m²\], above zero.
    pub inertia_kg_m2: Real,
    /// Viscous friction \[N·m·s/rad\], ≥ 0.
    pub viscous_nm_s_per_rad: Real,
    /// Coulomb (static) friction \[N·m\], ≥ 0.
    pub coulomb_nm: Real,
}

/// A DC motor, discretised for one step.
///
/// ```
/// use plant_core::machine::dc::{DcMotor, DcMotorSpeedInput, DcMotorState};
/// use plant_core::{Dt, must, presets};
///
/// const MOTOR: DcMotor = must!(DcMotor::new(presets::MOTOR_PASEK, must!(Dt::from_s(0.01))));
///
/// let mut state = DcMotorState::default();
/// let blocked = DcMotorSpeedInput { voltage_v: 60.0, speed_rad_s: 0.0 };
/// let mut out = MOTOR.step_at_speed(&mut state, blocked);
/// for _ in 0..100 {
///     out = MOTOR.step_at_speed(&mut state, blocked);
/// }
/// assert!((out.current_a - 60.0 / 30.9).abs() < 1e-4); // V/R: no back-EMF at standstill
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DcMotor {
    pub(crate) winding: Winding,
    pub(crate) coast: Coast,
    pub(crate) inductance_h: Real,
    pub(crate) inertia_kg_m2: Real,
}

/// The state of a [`DcMotor`]; at rest by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DcMotorState {
    /// Winding current \[A\].
    pub current_a: Accum,
    /// Rotor speed \[rad/s\].
    pub speed_rad_s: Accum,
}

/// Input of a [`DcMotor`] with a free shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DcMotorInput {
    /// Voltage at the winding's terminals \[V\].
    pub voltage_v: Real,
    /// Torque that the load takes from the shaft \[N·m\].
    pub load_nm: Real,
}

/// Input of a [`DcMotor`] on an imposed speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DcMotorSpeedInput {
    /// Voltage at the winding's terminals \[V\].
    pub voltage_v: Real,
    /// Rotor speed at the end of the step \[rad/s\].
    pub speed_rad_s: Real,
}

/// Output of one step of a [`DcMotor`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DcMotorOutput {
    /// Winding current \[A\].
    pub current_a: Real,
    /// Rotor speed \[rad/s\].
    pub speed_rad_s: Real,
    /// Air-gap torque Kt·i \[N·m\].
    pub torque_nm: Real,
    /// Torque left at the shaft \[N·m\]: air gap less friction and inertia.
    pub shaft_nm: Real,
    /// Back-EMF Ke·ω \[V\].
    pub back_emf_v: Real,
    /// Heat in the winding \[W\], never negative.
    pub copper_w: Real,
    /// Heat by viscous and Coulomb friction \[W\], never negative.
    pub friction_w: Real,
    /// An input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

/// The electrical side of a motor, discretised for one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Winding {
    pub(crate) resistance_ohm: Real,
    pub(crate) inductance_per_h_ohm: Real,
    pub(crate) back_emf: Real,
    pub(crate) effort_per_a: Real,
    effort_emf: Real,
}

/// A winding's current within one step: `Δi = free_a − per_speed·Δω`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentLaw {
    /// Current increment if the speed stayed as it is \[A\].
    pub free_a: Real,
    /// How much a speed increment lowers it.
    pub per_speed: Real,
}

impl CurrentLaw {
    /// The current increment for the speed increment that the step found \[A\].
    #[inline]
    #[must_use]
    pub const fn increment_a(self, speed_increment: Real) -> Real {
        self.free_a - self.per_speed * speed_increment
    }
}

impl Winding {
    /// Seen from a place that moves by 1 where the shaft turns by `ratio`: a winding with both
    /// constants `ratio` times as large.
    #[must_use]
    pub const fn reflected(self, ratio: Real) -> Self {
        Self {
            back_emf: self.back_emf * ratio,
            effort_per_a: self.effort_per_a * ratio,
            effort_emf: self.effort_emf * (ratio * ratio),
            ..self
        }
    }

    /// What the machine offers over one step on `source`, the winding eliminated, and the current
    /// to settle once the speed increment is known.
    #[inline]
    #[must_use]
    pub const fn law(
        &self,
        source: Source,
        current_a: Real,
        speed: Real,
    ) -> (DriveLaw, CurrentLaw) {
        let resistance_ohm = self.resistance_ohm + source.resistance_ohm;
        let admittance_s = 1.0 / (self.inductance_per_h_ohm + resistance_ohm);
        let free_a =
            admittance_s * (source.emf_v - resistance_ohm * current_a - self.back_emf * speed);
        (
            DriveLaw {
                effort: self.effort_per_a * (current_a + free_a),
                slope: self.effort_emf * admittance_s,
            },
            CurrentLaw { free_a, per_speed: self.back_emf * admittance_s },
        )
    }
}

impl DcMotor {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: DcMotorParams, dt: Dt) -> Result<Self, ParamError> {
        let inductance_h = check!(positive("motor.inductance_h", params.inductance_h));
        let ke = check!(positive("motor.back_emf_v_s_per_rad", params.back_emf_v_s_per_rad));
        let kt = check!(positive("motor.torque_nm_per_a", params.torque_nm_per_a));
        let j = check!(positive("motor.inertia_kg_m2", params.inertia_kg_m2));
        let b = check!(not_negative("motor.viscous_nm_s_per_rad", params.viscous_nm_s_per_rad));
        Ok(Self {
            winding: Winding {
                resistance_ohm: check!(positive("motor.resistance_ohm", params.resistance_ohm)),
                inductance_per_h_ohm: inductance_h / dt.s(),
                back_emf: ke,
                effort_per_a: kt,
                effort_emf: kt * ke,
            },
            coast: Coast {
                inertia_per_h: j / dt.s(),
                viscous: b,
                coulomb: check!(not_negative("motor.coulomb_nm", params.coulomb_nm)),
            },
            inductance_h,
            inertia_kg_m2: j,
        })
    }

    /// The electrical side, to join a chain.
    #[must_use]
    pub const fn winding(&self) -> &Winding {
        &self.winding
    }

    /// Rotor and friction, to join a chain.
    #[must_use]
    pub const fn coast(&self) -> Coast {
        self.coast
    }

    /// Advances by one step with a free shaft under a load torque.
    #[inline]
    pub fn step(&self, state: &mut DcMotorState, input: DcMotorInput) -> DcMotorOutput {
        let (i, w) = (state.current_a.get(), state.speed_rad_s.get());
        let (law, current) = self.winding.law(Source::stiff(input.voltage_v), i, w);
        let (dw, slip) = project(
            w,
            law.effort - self.coast.viscous * w - input.load_nm,
            law.slope + self.coast.slope(),
            self.coast.coulomb,
        );
        let valid = sane(input.voltage_v) && sane(input.load_nm);
        self.settle(state, current.increment_a(dw), dw, slip, valid)
    }

    /// Advances by one step while something else imposes the speed.
    #[inline]
    pub fn step_at_speed(
        &self,
        state: &mut DcMotorState,
        input: DcMotorSpeedInput,
    ) -> DcMotorOutput {
        let (i, w) = (state.current_a.get(), state.speed_rad_s.get());
        let (_, current) = self.winding.law(Source::stiff(input.voltage_v), i, w);
        let dw = input.speed_rad_s - w;
        let slip = if input.speed_rad_s > 0.0 {
            Slip::Forward
        } else if input.speed_rad_s < 0.0 {
            Slip::Backward
        } else {
            Slip::Stuck
        };
        let valid = sane(input.voltage_v) && sane(input.speed_rad_s);
        self.settle(state, current.increment_a(dw), dw, slip, valid)
    }

    #[inline]
    fn settle(
        &self,
        state: &mut DcMotorState,
        di: Real,
        dw: Real,
        slip: Slip,
        valid: bool,
    ) -> DcMotorOutput {
        let (i, w) = (state.current_a.get(), state.speed_rad_s.get());
        let rejected = !(valid && sane(i + di) && sane(w + dw));
        let dw = if rejected { 0.0 } else { dw };
        if !rejected {
            state.current_a.add(di);
            match slip {
                Slip::Stuck => state.speed_rad_s = Accum::new(0.0),
                _ => state.speed_rad_s.add(dw),
            }
        }
        let (current_a, speed_rad_s) = (state.current_a.get(), state.speed_rad_s.get());
        let torque_nm = self.winding.effort_per_a * current_a;
        let friction_nm = self.coast.viscous * speed_rad_s + self.coast.coulomb * slip.sign();
        DcMotorOutput {
            current_a,
            speed_rad_s,
            torque_nm,
            shaft_nm: torque_nm - friction_nm - self.coast.inertia_per_h * dw,
            back_emf_v: self.winding.back_emf * speed_rad_s,
            copper_w: self.winding.resistance_ohm * current_a * current_a,
            friction_w: (friction_nm * speed_rad_s).abs(),
            rejected,
        }
    }
}

impl_model!(DcMotor, DcMotorState, DcMotorInput, DcMotorOutput);

#[cfg(test)]
mod tests;
