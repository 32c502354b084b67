//! What goes into a step and what comes out of it, as C sees it.

use plant_core::Accum;

use crate::params::VOLTSTEP_DRIVES;

/// What changed the duty, if anything.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepLimited {
    /// The duty is the commanded one; or the gates are off.
    No = 0,
    /// The discharge limit, or what is left to discharge, held it back.
    Discharge = 1,
    /// The charge limit, or what is left to charge, held it back.
    Charge = 2,
    /// The commanded duty lay beyond the converter's limit.
    Duty = 3,
    /// The converter's current limit held it back.
    Current = 4,
}

/// What drives one step. Start from `voltstep_inputs_default`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepInputs {
    /// With a driver: the speed to follow in m/s.
    pub reference_m_s: f32,
    /// With the torque driver: how fast that changes, in m/s^2; 0 where it is not known.
    pub reference_m_s2: f32,
    /// Without a driver, of one DC drive without temperatures: duty of the converter, a ratio -1..1; NaN, the default,
    /// where a torque is asked for, or gates are to be off.
    pub duty: f32,
    /// Without a driver: torque of all motors, as felt at the shaft of the first, in N m, by an ideal
    /// current loop of each; NaN, the default, where a duty is given, or gates are to be off.
    pub torque_nm: f32,
    /// Force of the friction brake in N, beside that of the driver; zero or above.
    pub brake_n: f32,
    /// Sine of the road's angle; positive climbs.
    pub grade_sin: f32,
    /// Cosine of the road's angle; zero or above, 1 on a flat road.
    pub grade_cos: f32,
    /// Wind against the vehicle in m/s.
    pub headwind_m_s: f32,
    /// Auxiliary power beside the parameter in W; zero or above.
    pub auxiliary_w: f32,
    /// What the battery's management lets it discharge, in A; zero or above, infinity for any.
    pub discharge_limit_a: f32,
    /// What the battery's management lets it charge, in A; zero or above, infinity for any.
    pub charge_limit_a: f32,
}

/// What one step says of a drive.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepDriveOutputs {
    /// The duty applied, a ratio; of a synchronous machine its voltage over the largest. With gates off
    /// what the diodes make of it while they conduct, else 0.
    pub duty: f32,
    /// Winding current in A; of a synchronous machine the peak of a phase.
    pub motor_a: f32,
    /// Synchronous machine: its part along d in A.
    pub d_a: f32,
    /// Synchronous machine: its part along q in A.
    pub q_a: f32,
    /// Air-gap torque in N m.
    pub motor_nm: f32,
    /// Motor speed in rad/s.
    pub motor_rad_s: f32,
    /// Synchronous machine: it turned too far in this step for what rings at the electrical frequency
    /// to be followed; it is damped.
    pub coarse_step: bool,
    /// Temperature of a heated drive's machine in degrees C; else 0.
    pub machine_c: f32,
    /// Temperature of a heated drive's inverter in degrees C; else 0.
    pub inverter_c: f32,
    /// How much of the converter's current limit the temperatures take away, a ratio 0..1.
    pub derated: f32,
}

impl VoltstepDriveOutputs {
    /// Of a drive that there is not.
    pub(crate) const NONE: Self = Self {
        duty: 0.0,
        motor_a: 0.0,
        d_a: 0.0,
        q_a: 0.0,
        motor_nm: 0.0,
        motor_rad_s: 0.0,
        coarse_step: false,
        machine_c: 0.0,
        inverter_c: 0.0,
        derated: 0.0,
    };
}

/// What one step says. Discharge current, traction torque and forward speed are positive.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepOutputs {
    /// Each drive; zeros beyond those that there are.
    pub drives: [VoltstepDriveOutputs; VOLTSTEP_DRIVES],
    /// Air-gap torque of all motors, as felt at the shaft of the first, in N m.
    pub motor_nm: f32,
    /// Force of the friction brake that was commanded, in N.
    pub brake_n: f32,
    /// Speed in m/s.
    pub speed_m_s: f32,
    /// Distance in m.
    pub distance_m: f32,
    /// State of charge, a ratio 0..1.
    pub soc: f32,
    /// Battery current in A.
    pub battery_a: f32,
    /// Voltage at the battery's terminals in V.
    pub battery_v: f32,
    /// The battery's open-circuit voltage over the step in V.
    pub open_circuit_v: f32,
    /// How far the battery's current is beyond its limits all the same, in A; zero or above.
    pub limit_exceeded_a: f32,
    /// Charge of this step that went into a full battery, or, negative, out of an empty one, and is
    /// lost, in C.
    pub overcharged_c: f32,
    /// One of `VoltstepLimited`.
    pub limited: u32,
    /// Neither battery nor drive could feed the auxiliary loads: they were cut off.
    pub auxiliary_starved: bool,
    /// The plant refused the step and is as it was.
    pub rejected: bool,
    /// The driver refused its inputs and holds its last command.
    pub driver_rejected: bool,
}

/// A compensated sum: what it is, and what its last additions rounded away.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepSum {
    /// The sum.
    pub value: f32,
    /// What `value` has too little, exactly, in the same unit.
    pub lost: f32,
}

/// Every bit that a drive remembers; zeros of the other kind of machine.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepDriveSnapshot {
    /// DC machine: winding current in A.
    pub current_a: VoltstepSum,
    /// Synchronous machine: current of the d axis in A.
    pub d_a: VoltstepSum,
    /// Synchronous machine: current of the q axis in A.
    pub q_a: VoltstepSum,
    /// Heated drive: how much warmer than the coolant its machine is, in K.
    pub machine_above_k: VoltstepSum,
    /// Heated drive: how much warmer than the coolant its inverter is, in K.
    pub inverter_above_k: VoltstepSum,
}

impl VoltstepDriveSnapshot {
    /// Of a drive that there is not.
    pub(crate) const NONE: Self = Self {
        current_a: VoltstepSum::ZERO,
        d_a: VoltstepSum::ZERO,
        q_a: VoltstepSum::ZERO,
        machine_above_k: VoltstepSum::ZERO,
        inverter_above_k: VoltstepSum::ZERO,
    };

    /// What a drive remembers of which only one of the two is used.
    #[cfg(all(feature = "drives", feature = "pmsm"))]
    pub(crate) fn or(self, other: Self) -> Self {
        Self {
            current_a: self.current_a.or(other.current_a),
            d_a: self.d_a.or(other.d_a),
            q_a: self.q_a.or(other.q_a),
            machine_above_k: self.machine_above_k.or(other.machine_above_k),
            inverter_above_k: self.inverter_above_k.or(other.inverter_above_k),
        }
    }
}

/// Every bit that the plant remembers: to compare two runs bit for bit.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepSnapshot {
    /// Each drive; zeros beyond those that there are.
    pub drives: [VoltstepDriveSnapshot; VOLTSTEP_DRIVES],
    /// Speed in m/s.
    pub speed_m_s: VoltstepSum,
    /// Distance in m.
    pub distance_m: VoltstepSum,
    /// State of charge, a ratio 0..1.
    pub soc: VoltstepSum,
    /// Voltage across the battery's RC branch in V.
    pub rc_v: VoltstepSum,
    /// Voltage at the battery's terminals in V.
    pub battery_v: f32,
    /// The duty that the first drive last applied, a ratio.
    pub duty: f32,
}

impl VoltstepSum {
    const ZERO: Self = Self { value: 0.0, lost: 0.0 };

    /// The one of two that has any bit set.
    #[cfg(all(feature = "drives", feature = "pmsm"))]
    const fn or(self, other: Self) -> Self {
        if self.value.to_bits() | self.lost.to_bits() == 0 { other } else { self }
    }
}

impl From<Accum> for VoltstepSum {
    fn from(sum: Accum) -> Self {
        Self { value: sum.get(), lost: sum.since(Accum::new(sum.get())) }
    }
}
