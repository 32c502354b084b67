//! Drivers: from a speed reference to a duty and a brake force.
//!
//! [`DriverParams::Duty`] is the reference system's \[EPowertrain2025, section 5.3\]: a PID from
//! the speed error straight to the duty.
//!
//! [`DriverParams::Torque`] is ours, in the usual order, with k the motor's turns (rad) per metre:
//! force `F = PID(v_ref, v) + m·dv_ref/dt`, torque `T = F/k` within peak torque and power and what
//! regeneration may do at this speed and state of charge; the friction brake takes the rest.
//! Current `i* = T/Kt`; duty `D = ((L'+ R)·i* − L'·i + Ke·k·v' + V_d·sgn(i*))/V`, a current
//! controller with feed-forward of the back-EMF at the end of the step, v' being the speed there if
//! it changes as in the last step, but for what the forces of motor and brake change.
//! `L' = L·λ/(1 + h·λ)` for a bandwidth λ: at most `L/h`, so that the loop is stable at any step.
//!
//! On a hill the brake holds until the motor carries the slope.
//!
//! Tests: `tests` below; properties `finite_plant`, `refusal`; cases "UDDS", "trip".

mod steering;
mod torque;

pub use steering::{Steered, Steering};
pub use torque::{Demand, TorqueDriver, TorqueDriverParams};

use crate::control::pid::{Pid, PidInput, PidParams, PidState};
use crate::error::{ParamError, check, positive};
use crate::model::{Dt, Model};
use crate::num::{LARGEST, Real, lag_gain, max, min, sign};
use crate::powertrain::{Feedback, PowertrainParams};

/// Parameters of a [`Driver`]: how a vehicle is driven.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum DriverParams {
    /// The reference system's: a PID from the speed error straight to the duty; no friction brake.
    Duty(PidParams),
    /// A real vehicle's: speed → torque → limits → current → duty, with brake blending.
    Torque(TorqueDriverParams),
}

/// Input of a [`Driver`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriverInput {
    /// The speed to follow \[m/s\].
    pub reference_m_s: Real,
    /// How fast it changes, as feed-forward \[m/s²\]; 0 where it is not known.
    pub reference_m_s2: Real,
    /// The vehicle.
    pub vehicle: Feedback,
}

/// Output of a [`Driver`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DriverOutput {
    /// Duty of the converter.
    pub duty: Real,
    /// Force of the friction brake \[N\], ≥ 0.
    pub brake_n: Real,
    /// An input was not finite or absurd: the driver holds its last command.
    pub rejected: bool,
}

/// The state of a [`Driver`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DriverState {
    /// The speed controller.
    pub speed: PidState,
    /// Duty or torque.
    last: Real,
    last_brake_n: Real,
    last_m_s: Option<Real>,
}

/// What the driver sees where the brake may have to help: put together there, so that no other step
/// has to.
#[derive(Clone, Copy)]
struct Wish {
    wanted_nm: Real,
    reference_m_s: Real,
    speed_m_s: Real,
    motor_nm: Real,
    soc: Real,
    slope_sin: Real,
    limited: bool,
}

impl DriverState {
    /// The command that is held where an input is refused.
    #[inline(always)]
    const fn commit(&mut self, command: Real, brake_n: Real) {
        (self.last, self.last_brake_n) = (command, brake_n);
    }
}

/// A driver, discretised for one step. A sampled controller: it sees the end of the last step.
///
/// ```
/// use plant_core::control::driver::{Driver, DriverInput, DriverState};
/// use plant_core::powertrain::{Feedback, Powertrain, PowertrainInput};
/// use plant_core::presets::EPOWERTRAIN_UDDS as CAR;
/// use plant_core::{Dt, ParamError, must};
///
/// const DT: Dt = must!(Dt::from_s(0.001));
/// const PLANT: Powertrain = must!(Powertrain::new(CAR.powertrain, DT));
/// const DRIVER: Driver = must!(Driver::new(CAR.driver, &CAR.powertrain, DT));
///
/// let (mut plant, mut driver) = (PLANT.at_rest(0.8)?, DriverState::default());
/// let mut seen = PLANT.feedback(&plant);
/// for _ in 0..10_000 {
///     let drive = DriverInput { reference_m_s: 5.0, reference_m_s2: 0.0, vehicle: seen };
///     let command = DRIVER.step(&mut driver, drive);
///     seen = Feedback::from(&PLANT.step(&mut plant, PowertrainInput::on(command.duty)));
/// }
/// assert!((seen.speed_m_s - 5.0).abs() < 0.02);
/// # Ok::<(), ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Driver {
    /// See [`DriverParams::Duty`].
    Duty(Pid),
    /// See [`DriverParams::Torque`].
    Torque(TorqueDriver, CurrentLoop),
}

/// The current controller of a DC machine: from torque to duty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentLoop {
    /// Voltage per commanded torque \[V/(N·m)\].
    v_per_nm: Real,
    back_emf_v_s_per_m: Real,
    drop_v: Real,
    gain_ohm: Real,
}

impl Driver {
    /// Checks `params` and fits the driver to a vehicle, for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new<P>(
        params: DriverParams,
        vehicle: &PowertrainParams<P>,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        match params {
            DriverParams::Duty(pid) => Ok(Self::Duty(check!(Pid::new(pid, dt)))),
            DriverParams::Torque(torque) => Ok(Self::Torque(
                check!(TorqueDriver::new(torque, vehicle, dt)),
                check!(CurrentLoop::new(torque.current_rate_per_s, vehicle, dt)),
            )),
        }
    }

    /// Decides on one step.
    #[inline(always)]
    pub fn step(&self, state: &mut DriverState, input: DriverInput) -> DriverOutput {
        match self {
            Self::Duty(pid) => {
                let command = pid.step_fed_back(
                    &mut state.speed,
                    PidInput {
                        reference: input.reference_m_s,
                        measurement: input.vehicle.speed_m_s,
                    },
                    input.vehicle.duty,
                    input.vehicle.limited,
                );
                DriverOutput { duty: command.output, brake_n: 0.0, rejected: command.rejected }
            }
            Self::Torque(driver, current) => {
                let demand = driver.wanted(state, input);
                if let Some(demand) = demand {
                    state.commit(current.duty(&demand, &input.vehicle), demand.brake_n);
                }
                let rejected = demand.is_none();
                DriverOutput { duty: state.last, brake_n: state.last_brake_n, rejected }
            }
        }
    }
}

impl Model for Driver {
    type State = DriverState;
    type Input = DriverInput;
    type Output = DriverOutput;

    #[inline]
    fn step(&self, state: &mut DriverState, input: DriverInput) -> DriverOutput {
        Self::step(self, state, input)
    }
}

impl CurrentLoop {
    /// Checks the bandwidth \[1/s\] and fits the controller to a vehicle, for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    const fn new<P>(
        rate_per_s: Real,
        vehicle: &PowertrainParams<P>,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        let rate = check!(positive("driver.torque.current_rate_per_s", rate_per_s));
        let (motor, converter) = (&vehicle.drives.motor, &vehicle.drives.converter);
        let kt = check!(positive("motor.torque_nm_per_a", motor.torque_nm_per_a));
        // At most L/h, so that the loop is stable at any step.
        let gain_ohm = motor.inductance_h * (lag_gain(dt.s() * rate) / dt.s());
        let rad_per_m = vehicle.drives.gearbox.ratio / vehicle.wheel.radius_m;
        Ok(Self {
            v_per_nm: (gain_ohm + motor.resistance_ohm + converter.resistance_ohm) / kt,
            back_emf_v_s_per_m: motor.back_emf_v_s_per_rad * rad_per_m,
            drop_v: converter.voltage_drop_v,
            gain_ohm,
        })
    }

    #[inline(always)]
    fn duty(&self, demand: &Demand, vehicle: &Feedback) -> Real {
        let voltage_v = self.v_per_nm * demand.torque_nm - self.gain_ohm * vehicle.motor_a
            + self.back_emf_v_s_per_m * demand.ahead_m_s
            + self.drop_v * sign(demand.torque_nm);
        // No converter reaches the bound; without it an absurd motor would make a number that is none.
        max(min(voltage_v / max(vehicle.battery_v, 1.0), LARGEST), -LARGEST)
    }
}

#[cfg(test)]
mod tests;
