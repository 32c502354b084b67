//! From a speed reference to a torque and a brake force, see [`DriverParams::Torque`](super::DriverParams::Torque).

use super::{DriverInput, DriverState, Wish};
use crate::control::pid::{Pid, PidInput, PidParams};
use crate::error::{ParamError, check, limit, not_negative, positive};
use crate::model::Dt;
use crate::num::{GRAVITY_M_S2, Real, clamp, max, min, sign, sound};
use crate::powertrain::{Feedback, PowertrainParams};

/// Below this speed the vehicle counts as standing \[m/s\].
pub const STANDSTILL_M_S: Real = 0.02;
/// On a hill the motor builds up this much more than the slope takes before the brake lets go.
const HILL_MARGIN: Real = 1.05;

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

/// The driver of a real vehicle, see [`DriverParams::Torque`](super::DriverParams::Torque): from speed to torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueDriver {
    params: TorqueDriverParams,
    pub(super) speed: Pid,
    motor_rad_per_m: Real,
    per_motor_rad_m: Real,
    mass_kg: Real,
    /// Speed that a force at the road adds within one step \[m/(s·N)\].
    m_s_per_n: Real,
    weight_n: Real,
    full_regen_soc: Real,
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
    pub(super) fn wanted(&self, state: &mut DriverState, input: DriverInput) -> Option<Demand> {
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
