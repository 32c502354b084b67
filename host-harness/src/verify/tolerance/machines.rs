//! Machines, their control, and plants with several drives.

use super::Within::{Absolute, AtMost, Factor, Relative, Shown};
use super::{ADAPTIVE, Bound, CLOSED, FIRST_ORDER, GAIN, GEAR_BALANCE, MEASURED, RECOMPUTED};

/// The motor's step with `T_c`, Pasek: current and speed before, peak and its time, current and
/// speed after.
pub const MOTOR_PASEK_STATIC: [Bound; 6] = motor(
    [0.1129, 407.9, 4.674, 29.5, 0.1661, 1753.0],
    [None, None, Some("4.5"), None, None, Some("1772")],
);
/// Without `T_c`.
pub const MOTOR_PASEK_FREE: [Bound; 6] = motor(
    [0.016_99, 429.29, 4.578, 29.5, 0.070_22, 1774.4],
    [None, None, Some("4.5"), None, None, Some("1772")],
);
/// The set found by the method of moments, with `T_c`.
pub const MOTOR_MOMENTS_STATIC: [Bound; 6] = motor(
    [0.1129, 407.9, 4.081, 41.6, 0.1661, 1753.0],
    [None, None, Some("3.985"), None, None, Some("1772")],
);
/// Without `T_c`.
pub const MOTOR_MOMENTS_FREE: [Bound; 6] = motor(
    [0.016_99, 429.29, 3.985, 41.6, 0.070_22, 1774.4],
    [None, None, Some("3.985"), None, None, Some("1772")],
);

const fn motor(targets: [f64; 6], published: [Option<&'static str>; 6]) -> [Bound; 6] {
    const LAST: &str = "its last digit, and first order at 10 µs";
    const fn bound(
        quantity: &'static str,
        target: f64,
        tolerance: f64,
        published: Option<&'static str>,
    ) -> Bound {
        let within = Absolute(tolerance);
        let target = Some(target);
        Bound { published, ..Bound::new(quantity, target, within, RECOMPUTED, LAST) }
    }
    [
        bound("current at 60 V [A]", targets[0], 6e-5, published[0]),
        bound("speed at 60 V [rpm]", targets[1], 0.06, published[1]),
        bound("peak current [A]", targets[2], 1.5e-3, published[2]),
        bound("time of the peak [ms]", targets[3], 0.07, published[3]),
        bound("current at 248 V [A]", targets[4], 6e-5, published[4]),
        bound("speed at 248 V [rpm]", targets[5], 0.06, published[5]),
    ]
}

/// The whole step against the adaptive solution.
pub const MOTOR_TRAJECTORY: Bound = Bound::new(
    "current over the whole step / peak, largest difference",
    None,
    AtMost(1e-3),
    ADAPTIVE,
    "first order at 10 µs; the winding's time constant is 14 ms",
);

/// Current and speed once nothing changes.
pub const MOTOR_STEADY: [Bound; 2] = [
    Bound::new("steady current [A]", None, Relative(2e-4), CLOSED, STEADY),
    Bound::new("steady speed [rad/s]", None, Relative(1e-5), CLOSED, STEADY),
];

const STEADY: &str = "does not depend on the step; the current is a small difference in f32";

/// What was measured: neither parameter set gives all of it.
pub const MOTOR_MEASURED: [Bound; 5] = [
    Bound::new("measured current at 60 V [A]", Some(0.113), Relative(0.01), MEASURED, READING),
    Bound::new("measured current at 248 V [A]", Some(0.167), Relative(0.01), MEASURED, READING),
    Bound::new("measured speed at 60 V [rpm]", Some(400.0), Relative(0.03), MEASURED, READING),
    Bound::new("measured speed at 248 V [rpm]", Some(1745.0), Relative(0.01), MEASURED, READING),
    Bound::new(
        "measured time of the peak [ms]",
        Some(26.0),
        Shown,
        MEASURED,
        "neither set of inductance and inertia gives it",
    ),
];

const READING: &str = "what the parameters, identified on the same motor, allow";

/// The synchronous machine's start against the adaptive solution: current, speed.
pub const PMSM_TRAJECTORY: [Bound; 2] = [
    Bound::new("current / peak, largest difference", None, AtMost(1e-3), ADAPTIVE, PMSM_STEP),
    Bound::new("speed / final speed, largest difference", None, AtMost(5e-4), ADAPTIVE, PMSM_STEP),
];

const PMSM_STEP: &str = "first order at 1 µs; it starts within 0.5 ms";

/// Its currents and its speed once nothing changes, in steps of 1 ms.
pub const PMSM_STEADY: [Bound; 3] = [
    Bound::new("steady current of the d axis [A]", None, Relative(2e-4), ADAPTIVE, STEADY),
    Bound::new("steady current of the q axis [A]", None, Relative(2e-4), ADAPTIVE, STEADY),
    Bound::new("steady speed [rad/s]", None, Relative(1e-5), ADAPTIVE, STEADY),
];
pub const PMSM_BALANCE: Bound = Bound { quantity: "energy balance / throughput", ..GEAR_BALANCE };

/// The machine under field-oriented control: a step of the torque.
pub const FOC_STEP: Bound = Bound::new(
    "torque / its step, largest difference",
    None,
    AtMost(3e-3),
    CLOSED,
    "one lag, h·bandwidth = 0.01 at 10 µs",
);
/// Its field weakened: currents, torque, voltage.
pub const FOC_WEAKENED: [Bound; 4] = [
    Bound::new("weakening current of the d axis [A]", None, Relative(1e-3), CLOSED, WEAKENED),
    Bound::new("weakened: current of the q axis [A]", None, Relative(1e-3), CLOSED, WEAKENED),
    Bound::new("weakened: torque [N·m]", None, Relative(1e-3), CLOSED, WEAKENED),
    Bound::new("weakened: voltage [V]", None, Relative(1e-3), CLOSED, WEAKENED),
];

const WEAKENED: &str = "three passes for the drop at the resistance";

/// The same while the speed rises.
pub const FOC_RAMP: [Bound; 2] = [
    Bound::new("current of the d axis / its largest, difference", None, AtMost(4e-3), CLOSED, RISE),
    Bound::new("torque / what is asked for, difference", None, AtMost(2e-4), CLOSED, RISE),
];

const RISE: &str = "the closed form is steady: currents lag by 1 ms of 2 s";

/// A start under control of the speed: over time, and its end.
pub const FOC_START: [Bound; 2] = [
    Bound::new("current of the q axis / peak, difference", None, AtMost(2e-3), ADAPTIVE, LATE),
    Bound::new("speed / final speed, difference", None, AtMost(5e-4), ADAPTIVE, LATE),
];
pub const FOC_START_END: [Bound; 3] = [
    Bound::new("speed at the end [rad/s]", None, Relative(1e-4), CLOSED, SETTLED),
    Bound::new("current of the q axis at the end [A]", None, Relative(1e-3), CLOSED, SETTLED),
    Bound::new("voltage at the end [V]", None, Relative(1e-3), CLOSED, SETTLED),
];

const LATE: &str = "first order at 10 µs: a sampled loop sees the speed one step late";
/// The machine under a controller of 10 kHz, in steps of a tenth of its period.
pub const SAMPLED: [Bound; 6] = [
    Bound::new("current at 10 µs / peak, largest difference", None, AtMost(3e-3), ADAPTIVE, STEP),
    Bound::new("current error, 100 µs over 10 µs", Some(10.0), Factor(2.0), "first order", GAIN),
    Bound::new("current error, 10 µs over 1 µs", Some(10.0), Factor(2.0), "first order", GAIN),
    Bound::new("speed at 10 µs / highest, largest difference", None, AtMost(2e-4), ADAPTIVE, STEP),
    Bound::new("speed error, 100 µs over 10 µs", Some(10.0), Factor(2.0), "first order", GAIN),
    Bound::new("speed error, 10 µs over 1 µs", Some(10.0), Factor(2.0), "first order", GAIN),
];

const STEP: &str = "first order; the rotor turns by 0.01 in a step of 10 µs";

const SETTLED: &str = "0.22 s after the load; the slowest lag is 25 ms";

/// Gates off above base speed: speed and state of charge at 1 ms, and how their errors fall from
/// 10 ms to 1 ms, from 1 ms to 0.1 ms.
pub const GATES_OFF: [Bound; 6] = drives(4e-3, 4e-6);
/// The same under battery limits from outside.
pub const LIMITS: [Bound; 6] = drives(2e-3, 1e-6);
/// Both with a synchronous machine.
pub const PMSM_GATES_OFF: [Bound; 6] = drives(2e-3, 4e-6);
/// At 10 ms the torque loop is there after a step, which is no longer first order. The current of the
/// battery is the limit, so that the state of charge is right to its last bits.
pub const PMSM_LIMITS: [Bound; 3] = [
    Bound::new(SPEED_1MS, None, AtMost(5e-4), ADAPTIVE, "first order, h·bandwidth = 0.5"),
    Bound::new("speed error, 1 ms over 0.1 ms", Some(10.0), Factor(2.0), "first order", GAIN),
    Bound::new(SOC_1MS, None, AtMost(2e-7), ADAPTIVE, "rounding in f32"),
];
/// UDDS by torque loops, on one axle and on two.
pub const TORQUE_LOOP: [Bound; 6] = drives(2e-4, 4e-6);
pub const TWO_AXLES: [Bound; 6] = drives(2e-4, 4e-6);
/// Under a controller that samples.
pub const SAMPLED_VEHICLE: [Bound; 5] = [
    Bound::new("speed, a tenth of a period, difference [m/s]", None, AtMost(1e-5), ADAPTIVE, PART),
    Bound::new(
        "speed error, a period over its tenth",
        Some(10.0),
        Factor(2.0),
        "first order",
        GAIN,
    ),
    Bound::new(
        "current of the q axis, a tenth, difference [A]",
        None,
        AtMost(5e-3),
        ADAPTIVE,
        PART,
    ),
    Bound::new(
        "current error, a period over its tenth",
        Some(10.0),
        Factor(2.0),
        "first order",
        GAIN,
    ),
    Bound::new("SOC, largest difference", None, AtMost(2e-7), ADAPTIVE, "rounding in f32"),
];

const PART: &str = "first order; the rotor turns by 0.02 in 10 µs";

/// UDDS by a torque loop of the i3 with a synchronous machine, all of it; and, with a DC machine in
/// front, as far as above.
pub const PMSM_TORQUE_LOOP: [Bound; 6] = drives(2e-4, 1e-5);
pub const PMSM_AND_DC: [Bound; 6] = drives(2e-4, 4e-6);
/// Energy over the whole of UDDS with a synchronous machine.
pub const PMSM_ENERGY: [Bound; 3] = [
    Bound::new("battery energy at 1 ms [kWh]", None, Relative(0.003), ADAPTIVE, FIRST_ORDER),
    Bound::new("energy error, 10 ms over 1 ms", Some(10.0), Factor(2.0), "first order", GAIN),
    Bound::new("energy error, 1 ms over 0.1 ms", Some(10.0), Factor(2.0), "first order", GAIN),
];
/// A drive that heats up: temperature of the machine, of the inverter, speed, each at 1 ms, and how
/// its error falls from 10 ms to 1 ms, from 1 ms to 0.1 ms.
pub const HEATED: [[Bound; 3]; 3] = [
    [
        heated("temperature of the machine at 1 ms, largest difference [K]", 2e-2),
        fall("machine's error, 10 ms over 1 ms"),
        fall("machine's error, 1 ms over 0.1 ms"),
    ],
    [
        heated("temperature of the inverter at 1 ms, largest difference [K]", 4e-2),
        fall("inverter's error, 10 ms over 1 ms"),
        fall("inverter's error, 1 ms over 0.1 ms"),
    ],
    [
        heated(SPEED_1MS, 1e-2),
        fall("speed error, 10 ms over 1 ms"),
        fall("speed error, 1 ms over 0.1 ms"),
    ],
];
/// What its temperatures leave of the current limit.
pub const HEATED_LEFT: [Bound; 2] = [
    Bound::new(
        "least that is left of the current limit",
        None,
        Absolute(1e-3),
        ADAPTIVE,
        "first order: 0.04 of it for each kelvin of the inverter",
    ),
    Bound::new(
        "the same, so that it is derated",
        None,
        AtMost(0.8),
        "the case",
        "it asks for 0.81 of the limit",
    ),
];

const fn heated(quantity: &'static str, most: f64) -> Bound {
    Bound::new(quantity, None, AtMost(most), ADAPTIVE, REVERSED)
}

const REVERSED: &str =
    "first order: at a reversal of the torque the loop lags by the bus of a step";

const fn fall(quantity: &'static str) -> Bound {
    Bound::new(quantity, Some(10.0), Factor(2.0), "first order", GAIN)
}

pub const LIMIT_HELD: Bound = Bound::new(
    "battery current that a limit holds [A]",
    None,
    Relative(0.01),
    "the limit",
    "charging, the winding's field grows while the speed falls",
);

const SPEED_1MS: &str = "speed at 1 ms, largest difference [m/s]";
const SOC_1MS: &str = "SOC at 1 ms, largest difference";

const fn drives(speed_m_s: f64, soc: f64) -> [Bound; 6] {
    const fn gain(quantity: &'static str) -> Bound {
        Bound::new(quantity, Some(10.0), Factor(2.0), "first order", GAIN)
    }
    const fn off(quantity: &'static str, most: f64) -> Bound {
        Bound::new(quantity, None, AtMost(most), ADAPTIVE, FIRST_ORDER)
    }
    [
        off(SPEED_1MS, speed_m_s),
        gain("speed error, 10 ms over 1 ms"),
        gain("speed error, 1 ms over 0.1 ms"),
        off(SOC_1MS, soc),
        gain("SOC error, 10 ms over 1 ms"),
        gain("SOC error, 1 ms over 0.1 ms"),
    ]
}
