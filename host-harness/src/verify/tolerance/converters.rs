//! Targets and tolerances of circuits beside closed forms and averaged equations.

use super::Within::{AtMost, Relative};
use super::{Bound, CLOSED};

const AVERAGED: &str = "averaged equations";

pub const PRECHARGE_VOLTAGE: Bound = Bound::new(
    "voltage / 355 V until the contactor closes, largest difference",
    None,
    AtMost(2e-5),
    CLOSED,
    "first order: half of h/τ = 2.6e-5, times 1/e; rounding of 2e5 steps in f32",
);
pub const PRECHARGE_INRUSH: Bound = Bound::new(
    "largest current when the contactor closes [A]",
    None,
    Relative(0.03),
    CLOSED,
    "the first step ends 1 µs after it closed, 2 % of that time constant",
);
pub const STAGE_VOLTAGE: Bound = Bound::new(
    "steady voltage, mean of a period [V]",
    None,
    Relative(2e-3),
    AVERAGED,
    "first order: an output takes in each step the coil's current at its end",
);
pub const STAGE_CURRENT: Bound = Bound {
    quantity: "steady current of the coil, mean of a period [A]",
    within: Relative(0.01),
    reason: "the same: half of a step's fall is 0.1 A",
    ..STAGE_VOLTAGE
};
pub const STAGE_START: Bound = Bound {
    quantity: "voltage from rest on / steady voltage, largest difference of the means",
    within: AtMost(0.01),
    ..STAGE_VOLTAGE
};
pub const STAGE_RIPPLE: Bound = Bound {
    quantity: "ripple of the coil's current, peak to peak [A]",
    within: Relative(0.03),
    source: CLOSED,
    reason: "the closed form takes the voltage across the coil as constant",
    ..STAGE_VOLTAGE
};
pub const H_BRIDGE_SPEED: Bound = Bound {
    quantity: "steady speed, forward and backward [rad/s]",
    within: Relative(2e-3),
    reason: "the dead time counts by the sign of the mean current",
    ..STAGE_VOLTAGE
};
pub const H_BRIDGE_RUN: Bound = Bound {
    quantity: "speed over the whole run / steady speed, largest difference",
    within: AtMost(0.01),
    ..STAGE_VOLTAGE
};
