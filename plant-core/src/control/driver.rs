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

pub use steering::{Steered, Steering};

use crate::control::pid::{Pid, PidInput, PidParams, PidState};
use crate::error::{ParamError, check, limit, not_negative, positive};
use crate::model::{Dt, Model};
use crate::num::{GRAVITY_M_S2, LARGEST, Real, clamp, lag_gain, max, min, sign, sound};
use crate::powertrain::{Feedback, PowertrainParams};

/// Below this speed the vehicle counts as standing \[m/s\].
pub const STANDSTILL_M_S: Real = 0.02;
/// On a hill the motor builds up this much more than the slope takes before the brake lets go.
const HILL_MARGIN: Real = 1.05;

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

/// Parameters of the driver of a real vehicle and its torque control.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct TorqueDriverParams {
    /// The speed controller: from m/s to the force at the road \[N\].
    pub speed: PidParams,
    /// Peak torque of the motor \[N·m\], above zero.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub peak_torque_nm: Real,
    /// Peak mechanical power of the motor \[W\], above zero.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub peak_power_w: Real,
    /// Largest regenerative torque \[N·m\], ≥ 0.
    pub regen_torque_nm: Real,
    /// Largest regenerative mechanical power \[W\], above zero.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub regen_power_w: Real,
    /// Below this speed regeneration fades to zero \[m/s\], above zero.
    pub regen_fade_m_s: Real,
    /// Regeneration fades to zero over this last share of the state of charge, above zero.
    pub regen_fade_soc: Real,
    /// Largest force of the friction brake at the road \[N\], above zero; it holds at standstill.
    pub brake_limit_n: Real,
    /// Bandwidth of the current controller \[1/s\], above zero.
    pub current_rate_per_s: Real,
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

/// The driver of a real vehicle, see [`DriverParams::Torque`]: from speed to torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueDriver {
    params: TorqueDriverParams,
    speed: Pid,
    motor_rad_per_m: Real,
    per_motor_rad_m: Real,
    mass_kg: Real,
    /// Speed that a force at the road adds within one step \[m/(s·N)\].
    m_s_per_n: Real,
    weight_n: Real,
    full_regen_soc: Real,
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

/// What a [`TorqueDriver`] asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Demand {
    /// Torque of all motors, as felt at the shaft of the first \[N·m\].
    pub torque_nm: Real,
    /// Force of the friction brake \[N\], ≥ 0.
    pub brake_n: Real,
    /// The speed expected at the end of the step \[m/s\].
    pub ahead_m_s: Real,
    /// An input was not finite or absurd: the driver holds its last command.
    pub rejected: bool,
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

impl TorqueDriver {
    /// Checks `params` and fits the driver to a vehicle with one DC machine, for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new<P>(
        params: TorqueDriverParams,
        vehicle: &PowertrainParams<P>,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        let radius_m = check!(positive("wheel.radius_m", vehicle.wheel.radius_m));
        let ratio = check!(positive("gearbox.ratio", vehicle.drives.gearbox.ratio));
        let motor_rad_per_m = ratio / radius_m;
        let inertia = vehicle.drives.motor.inertia_kg_m2 + vehicle.drives.gearbox.inertia_kg_m2;
        let mass_kg = vehicle.body.mass_kg
            + vehicle.wheel.inertia_kg_m2 / (radius_m * radius_m)
            + inertia * motor_rad_per_m * motor_rad_per_m;
        Self::fitted(params, motor_rad_per_m, vehicle.body.mass_kg, mass_kg, dt)
    }

    /// The same for any plant; its torques are those of all motors, as felt at the shaft of the
    /// first, which turns by `motor_rad_per_m` per metre.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn fitted(
        params: TorqueDriverParams,
        motor_rad_per_m: Real,
        body_kg: Real,
        moving_kg: Real,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        check!(limit("driver.torque.peak_torque_nm", params.peak_torque_nm));
        check!(limit("driver.torque.peak_power_w", params.peak_power_w));
        check!(not_negative("driver.torque.regen_torque_nm", params.regen_torque_nm));
        check!(limit("driver.torque.regen_power_w", params.regen_power_w));
        check!(positive("driver.torque.regen_fade_m_s", params.regen_fade_m_s));
        let fade_soc = check!(positive("driver.torque.regen_fade_soc", params.regen_fade_soc));
        check!(positive("driver.torque.brake_limit_n", params.brake_limit_n));
        check!(positive("driver.torque.current_rate_per_s", params.current_rate_per_s));
        Ok(Self {
            speed: check!(Pid::new(params.speed, dt)),
            motor_rad_per_m,
            per_motor_rad_m: 1.0 / motor_rad_per_m,
            mass_kg: moving_kg,
            m_s_per_n: dt.s() / moving_kg,
            weight_n: body_kg * GRAVITY_M_S2,
            full_regen_soc: 1.0 - fade_soc,
            params,
        })
    }

    /// Whether every limit allows a torque, counted in the direction of motion.
    #[inline(always)]
    fn allows(&self, torque_nm: Real, speed_m_s: Real, soc: Real) -> bool {
        let p = &self.params;
        let power_w = torque_nm * self.motor_rad_per_m * speed_m_s;
        if torque_nm >= 0.0 {
            torque_nm <= p.peak_torque_nm && power_w <= p.peak_power_w
        } else {
            torque_nm >= -p.regen_torque_nm
                && power_w >= -p.regen_power_w
                && speed_m_s >= p.regen_fade_m_s
                && soc <= self.full_regen_soc
        }
    }

    /// The torque that the limits leave of one, counted in the direction of motion.
    #[cold]
    fn allowed_nm(&self, torque_nm: Real, speed_m_s: Real, soc: Real) -> Real {
        let p = &self.params;
        let motor_rad_s = self.motor_rad_per_m * speed_m_s;
        let within = |torque_nm: Real, power_w: Real| {
            if torque_nm * motor_rad_s > power_w { power_w / motor_rad_s } else { torque_nm }
        };
        let fade = clamp(speed_m_s / p.regen_fade_m_s, 0.0, 1.0)
            * clamp((1.0 - soc) / p.regen_fade_soc, 0.0, 1.0);
        clamp(
            torque_nm,
            -within(p.regen_torque_nm, p.regen_power_w) * fade,
            within(p.peak_torque_nm, p.peak_power_w),
        )
    }

    /// Decides on one step.
    #[inline(always)]
    pub fn step(&self, state: &mut DriverState, input: DriverInput) -> Demand {
        if let Some(demand) = self.wanted(state, input) {
            state.commit(demand.torque_nm, demand.brake_n);
            return demand;
        }
        let ahead_m_s = input.vehicle.speed_m_s;
        Demand { torque_nm: state.last, brake_n: state.last_brake_n, ahead_m_s, rejected: true }
    }

    /// What the driver wants, or nothing, and no change, where an input is absurd. It works on the
    /// state where it lies: a copy would cost every step more than the speed controller does.
    #[inline(always)]
    fn wanted(&self, state: &mut DriverState, input: DriverInput) -> Option<Demand> {
        let DriverInput { reference_m_s, reference_m_s2, vehicle } = input;
        let v = vehicle.speed_m_s;
        let ahead_n = self.mass_kg * reference_m_s2;
        let magnitude = reference_m_s.abs()
            + v.abs()
            + reference_m_s2.abs()
            + ahead_n.abs()
            + vehicle.soc.abs()
            + vehicle.motor_a.abs()
            + vehicle.motor_nm.abs()
            + vehicle.battery_v.abs();
        if !sound(magnitude) {
            return None;
        }
        let controller = PidInput { reference: reference_m_s, measurement: v };
        let force_n = self.speed.step_sound(&mut state.speed, controller) + ahead_n;
        let wanted_nm = force_n * self.per_motor_rad_m;
        let (mut torque_nm, mut brake_n) = (wanted_nm, 0.0);
        let free = v >= STANDSTILL_M_S && self.allows(wanted_nm, v, vehicle.soc);
        if !free || vehicle.limited {
            let wish = Wish {
                wanted_nm,
                reference_m_s,
                speed_m_s: v,
                motor_nm: vehicle.motor_nm,
                soc: vehicle.soc,
                slope_sin: vehicle.slope_sin,
                limited: vehicle.limited,
            };
            (torque_nm, brake_n) = self.blend(state, wish);
        }
        let ahead_m_s = self.ahead_m_s(state, &vehicle, torque_nm, brake_n);
        state.last_m_s = Some(v);
        Some(Demand { torque_nm, brake_n, ahead_m_s, rejected: false })
    }

    /// The speed at the end of the step to come, whose back-EMF the current will meet: it changes
    /// as in the last step, but for what the forces of motor and brake change.
    #[inline(always)]
    fn ahead_m_s(
        &self,
        state: &DriverState,
        vehicle: &Feedback,
        command_nm: Real,
        brake_n: Real,
    ) -> Real {
        let v = vehicle.speed_m_s;
        let Some(last_m_s) = state.last_m_s else { return v };
        let mut more_n = (command_nm - vehicle.motor_nm) * self.motor_rad_per_m;
        if brake_n != state.last_brake_n || brake_n > 0.0 {
            if v.abs() < STANDSTILL_M_S {
                return v;
            }
            more_n -= (brake_n - state.last_brake_n) * sign(v);
        }
        v + (v - last_m_s) + self.m_s_per_n * more_n
    }

    /// The torque command \[N·m\] and the friction brake \[N\] where a limit acts, backwards, and at
    /// standstill: the brake takes what the motor may not do, or what the battery does not let it
    /// do. Tells the speed controller in which direction it is held back.
    #[cold]
    fn blend(&self, state: &mut DriverState, wish: Wish) -> (Real, Real) {
        let Wish { wanted_nm, reference_m_s, speed_m_s: v, .. } = wish;
        let standing = v.abs() < STANDSTILL_M_S;
        // Nor does it start before it has seen the slope.
        let starts = reference_m_s.abs() >= STANDSTILL_M_S && state.last_m_s.is_some();
        if standing && !starts {
            state.speed.reset();
            return (0.0, self.params.brake_limit_n);
        }
        let forward = if standing { reference_m_s >= 0.0 } else { v > 0.0 };
        // From here on torques and forces count in the direction of motion.
        let direction = if forward { 1.0 } else { -1.0 };
        let motor_nm = direction * wish.motor_nm;
        let slope_n = direction * self.weight_n * wish.slope_sin;
        if standing && slope_n > max(motor_nm * self.motor_rad_per_m, 0.0) {
            return self.start_on_hill(state, wish, direction, slope_n);
        }
        let wanted_nm = direction * wanted_nm;
        let mut command_nm = self.allowed_nm(wanted_nm, v.abs(), wish.soc);
        if direction * reference_m_s < 0.0 && v.abs() < self.params.regen_fade_m_s {
            // Rolling in the wrong direction: to drive against it is no regeneration to fade.
            command_nm = max(min(command_nm, wanted_nm), -self.params.peak_torque_nm);
        }
        let mut short_nm = command_nm - wanted_nm;
        if wish.limited {
            if wanted_nm < 0.0 {
                short_nm += max(motor_nm - command_nm, 0.0);
            } else {
                short_nm += min(motor_nm - command_nm, 0.0);
            }
        }
        let demand_n = short_nm * self.motor_rad_per_m;
        let saturation = if demand_n < 0.0 {
            direction // the drive gives less than wanted
        } else if demand_n > self.params.brake_limit_n {
            -direction // even the brake does
        } else {
            0.0
        };
        self.speed.saturate(&mut state.speed, saturation);
        (direction * command_nm, clamp(demand_n, 0.0, self.params.brake_limit_n))
    }

    /// Holds with the brake until the motor carries the slope; the speed controller starts from
    /// there.
    fn start_on_hill(
        &self,
        state: &mut DriverState,
        wish: Wish,
        direction: Real,
        slope_n: Real,
    ) -> (Real, Real) {
        let (reference, measurement) = (wish.reference_m_s, wish.speed_m_s);
        let error_n = self.params.speed.proportional * (reference - measurement);
        let carried_n = direction * HILL_MARGIN * slope_n;
        let controller = PidInput { reference, measurement };
        self.speed.preload(&mut state.speed, carried_n + error_n, controller);
        let command_nm = self.allowed_nm(direction * carried_n * self.per_motor_rad_m, 0.0, 0.0);
        (direction * command_nm, self.params.brake_limit_n)
    }
}

#[cfg(test)]
mod tests;
