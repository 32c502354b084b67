//! Components one by one.

use super::Within::{Absolute, AtMost, Relative};
use super::{ADAPTIVE, Bound, CLOSED, CONSERVATION, FIRST_ORDER, NUMERICAL_1MS};

pub const RC_TRAJECTORY: Bound = Bound::new(
    "voltage / final voltage, largest difference",
    None,
    AtMost(2e-5),
    CLOSED,
    "first order, h/τ = 2.2e-5",
);
pub const BATTERY_SOC: Bound =
    Bound::new("SOC", None, Absolute(1e-6), CLOSED, "rounding of charge per step in f32");
pub const BATTERY_VOLTAGE: Bound =
    Bound::new("voltage [V]", None, Relative(2e-6), CLOSED, "rounding in f32");
pub const BATTERY_HEAT: Bound =
    Bound::new("heat [J]", None, Relative(1e-5), CLOSED, "rounding in f32");
pub const MAP_SOC: Bound = Bound::new("SOC", None, Absolute(2e-6), ADAPTIVE, "rounding in f32");
pub const MAP_VOLTAGE: Bound =
    Bound::new("voltage, largest difference [V]", None, AtMost(1e-3), ADAPTIVE, REFRESH);
pub const MAP_TEMPERATURE: Bound =
    Bound::new("temperature, largest difference [K]", None, AtMost(0.05), ADAPTIVE, REFRESH);

/// The map in the coupled plant, 1 ms against 0.1 ms.
pub const MAP_PLANT_SOC: Bound =
    Bound::new("SOC at the end", None, Absolute(2e-5), "step of 0.1 ms", FIRST_ORDER);
pub const MAP_PLANT_NUMERICAL: Bound = NUMERICAL_1MS;

const REFRESH: &str =
    "first order in the refresh of 1 s: a tenth of it gives a tenth (6e-4 V, 2e-3 K)";

pub const PID_TRAJECTORY: Bound = Bound::new(
    "output, largest difference",
    None,
    AtMost(5e-3),
    CLOSED,
    "first order, h·rate = 0.01 of a lag of 2",
);
pub const COAST_SPEED: Bound = Bound::new(
    "speed, largest difference [m/s]",
    None,
    AtMost(1e-3),
    ADAPTIVE,
    "first order at 1 ms, rounding in f32",
);
pub const COAST_DISTANCE: Bound =
    Bound::new("distance [m]", None, Relative(2e-5), ADAPTIVE, "first order at 1 ms");
pub const STANDSTILL: Bound =
    Bound::new("speed at standstill [m/s]", None, AtMost(0.0), CLOSED, "friction holds exactly");
pub const SLOPE_SIN: Bound =
    Bound::new("sine of the slope", None, Relative(1e-5), CLOSED, "rounding in f32");
pub const SLOPE_SPEED: Bound =
    Bound::new("speed downhill [m/s]", None, Relative(1e-4), CLOSED, "first order at 1 ms");
pub const LOAD_TRAJECTORY: Bound = Bound::new(
    "speed / final speed, largest difference",
    None,
    AtMost(1e-4),
    CLOSED,
    "first order, h/τ = 2e-4",
);
pub const AXIS_ANGLE: Bound = Bound::new(
    "angle [rad]",
    None,
    Absolute(1e-4),
    CLOSED,
    "1e-7 of the angle turned: the step is rounded once",
);
pub const SHAFT_TRAJECTORY: Bound = Bound::new(
    "speed / largest speed, largest difference",
    None,
    AtMost(1.5e-3),
    CLOSED,
    "first order: half a step of the torque's swing, w·h/4 = 1.25e-3",
);
pub const SHAFT_ANGLE: Bound = Bound::new(
    "angle [rad]",
    None,
    Absolute(2e-3),
    CLOSED,
    "first order: half a step of the swinging speed and torque; mean over whole swings it vanishes",
);
pub const NOISE_MEAN: Bound = Bound::new(
    "noise, mean",
    None,
    Absolute(0.005),
    CLOSED,
    "three standard deviations of a mean of 100 000: 0.5/√100 000 each",
);
pub const NOISE_SD: Bound = Bound::new(
    "noise, standard deviation",
    None,
    Relative(0.007),
    CLOSED,
    "three standard deviations of it: 1/√200 000 each",
);
pub const DRIFT: Bound = Bound::new(
    "drift of 1e-3 1/s after 100 s",
    None,
    Absolute(1e-5),
    CLOSED,
    "one step of it, and rounding in f32",
);
pub const MISSING: Bound = Bound::new(
    "share of samples that are missing",
    None,
    Absolute(0.006),
    CLOSED,
    "three standard deviations of some 1700 gaps of five samples",
);
pub const ELECTRICAL_ANGLE: Bound =
    Bound { quantity: "electrical angle [rad]", within: Absolute(4e-4), ..AXIS_ANGLE };
pub const ELECTRICAL_SPEED: Bound =
    Bound::new("electrical speed [rad/s]", None, Relative(1e-6), CLOSED, "rounding in f32");
pub const NODE_TRAJECTORY: Bound = Bound::new(
    "temperature, largest difference [K]",
    None,
    AtMost(0.02),
    CLOSED,
    "first order: half of h/τ = 2e-3, times 1/e of the rise of 40 K, is 0.0147",
);
pub const PAIR_TRAJECTORY: Bound = Bound::new(
    "temperature of winding and housing, largest difference [K]",
    None,
    AtMost(0.02),
    ADAPTIVE,
    "first order, h/τ = 1e-3",
);
pub const ROW_SOC: Bound = Bound::new(
    "SOC of a cell, largest difference",
    None,
    AtMost(2e-6),
    ADAPTIVE,
    "rounding in f32; what a cell loses by itself is booked each second, 20 mA · 1 s of 3 A·h",
);
pub const ROW_TEMPERATURE: Bound = Bound::new(
    "temperature of a cell, largest difference [K]",
    None,
    AtMost(0.05),
    ADAPTIVE,
    "first order in the refresh of 1 s, τ of some 300 s",
);
pub const ROW_VOLTAGE: Bound = Bound::new(
    "voltage of 96 like cells less that of the pack as one, largest difference [V]",
    None,
    AtMost(1e-3),
    CLOSED,
    "rounding in f32: 96 sums at 350 V",
);
pub const GEAR_TORQUE: Bound =
    Bound::new("torque at the wheel [N·m]", None, Relative(1e-6), CLOSED, "rounding in f32");
pub const GEAR_BALANCE: Bound =
    Bound::new("power balance of the gears", None, AtMost(1e-6), CONSERVATION, "rounding in f32");
pub const WHEEL_FORCE: Bound =
    Bound::new("force of the wheel [N]", None, Relative(1e-6), CLOSED, "rounding in f32");
pub const AUXILIARY_POWER: Bound =
    Bound::new("auxiliary power [W]", None, Relative(1e-6), CLOSED, "rounding in f32");
pub const SINE: Bound = Bound::new(
    "sine, largest difference",
    None,
    AtMost(5e-5),
    CLOSED,
    "1e-7 of 30 turns, amplitude 2",
);
pub const RAMP: Bound =
    Bound::new("ramp, largest difference", None, AtMost(1e-6), CLOSED, "rounding in f32");
pub const TABLE: Bound = Bound::new(
    "UDDS from a table, largest difference [m/s]",
    None,
    AtMost(5e-6),
    CLOSED,
    "rounding of the step in f32",
);
pub const EXACT: Bound =
    Bound::new("largest difference", None, AtMost(0.0), CLOSED, "no rounding here");
pub const PRECHARGE_TRAJECTORY: Bound = Bound::new(
    "link voltage, largest difference [V]",
    None,
    AtMost(0.12),
    CLOSED,
    "first order: half of h/τ = 2.6e-3, times 1/e of the rise of 234 V, is 0.112",
);
pub const PRECHARGE_TIME: Bound =
    Bound::new("time until a volt is missing [s]", None, Absolute(5e-4), CLOSED, "first order");
pub const PRECHARGE_CHARGE: Bound = Bound::new(
    "charge of battery and capacitor, difference",
    None,
    AtMost(1e-6),
    CONSERVATION,
    "rounding in f32 over 4000 steps",
);
pub const CONTACTOR_CLOSES: Bound =
    Bound::new("closes after [s]", None, Absolute(1e-9), CLOSED, "whole steps");
pub const CONTACTOR_OPENS: Bound = Bound { quantity: "opens after [s]", ..CONTACTOR_CLOSES };
pub const INSULATION_MEASURED: Bound = Bound::new(
    "measured insulation, largest relative difference",
    None,
    AtMost(0.003),
    CLOSED,
    "what is left after settling for eight time constants, e^-8, in the difference of two voltages, \
     which is a third of either where the leak is weakest",
);
pub const RC_EULER: Bound = Bound::new(
    "backward Euler, largest difference / 355 V",
    None,
    AtMost(5e-4),
    CLOSED,
    "first order: half of h/τ = 2.6e-3, times 1/e",
);
pub const RC_TRAPEZOIDAL: Bound = Bound::new(
    "trapezoidal, largest difference / 355 V",
    None,
    AtMost(2e-6),
    CLOSED,
    "second order: (h/τ)²/12/e = 2.1e-7, and rounding in f32",
);
pub const RESONANCE: Bound = Bound::new(
    "trapezoidal, largest difference / 10 V",
    None,
    AtMost(5e-4),
    CLOSED,
    "second order: (ωh)²/12 of the phase, 10 rad long, damped",
);
pub const RESONANCE_ORDER: Bound =
    Bound::new("order in the step", None, Absolute(0.1), CLOSED, "trapezoidal rule");
pub const BUCK_VOLTAGE: Bound = Bound::new(
    "mean voltage of the leg, averaged and switched [V]",
    None,
    Absolute(0.005),
    CLOSED,
    "open transistors leak, rounding of 100 values in f32",
);
pub const BUCK_CURRENT: Bound = Bound {
    quantity: "mean current of the winding [A]",
    within: Absolute(0.02),
    reason: "20 ms are ten time constants; first order in the step",
    ..BUCK_VOLTAGE
};
pub const BUCK_INPUT: Bound = Bound {
    quantity: "mean current of the source [A]",
    within: Absolute(0.1),
    reason: "first order: half of each step's rise, 0.12 A",
    ..BUCK_VOLTAGE
};
pub const BRIDGE_SPEED: Bound = Bound::new(
    "steady speed, averaged and switched [rad/s]",
    None,
    Absolute(0.5),
    CLOSED,
    "the drops count by their fundamental only, and the current's ripple shifts where they turn",
);
pub const DEAD_TIME_SPEED: Bound = Bound {
    within: Absolute(2.0),
    reason: "near its zero a current stands still in the dead time, which takes less than its full share",
    ..BRIDGE_SPEED
};
pub const ONE_OPEN: Bound = Bound::new(
    "largest current out of the leg over that into it",
    None,
    AtMost(0.05),
    CLOSED,
    "what is left flows through the lower diode while the back-EMF drives it",
);
pub const ONE_SHORTED: Bound = Bound::new(
    "largest current into the healthy phases over that out of them",
    None,
    AtMost(0.05),
    CLOSED,
    "with all gates off only their upper diodes conduct, out of the machine",
);
pub const SHOOT_THROUGH: Bound = Bound::new(
    "largest current of the source [A]",
    None,
    Relative(0.01),
    CLOSED,
    "the phase current beside it",
);
