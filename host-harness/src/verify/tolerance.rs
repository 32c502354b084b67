//! Every target and every tolerance of `voltstep validate`, in one table, with its reason.

/// How far a figure may be from its target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Within {
    /// This much.
    Absolute(f64),
    /// This share of the target.
    Relative(f64),
    /// Between the target divided and multiplied by this.
    Factor(f64),
    /// Its magnitude not above this; there is no target.
    AtMost(f64),
    /// No verdict: for information.
    Shown,
}

/// What one figure is checked against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// The figure, with its unit.
    pub quantity: &'static str,
    /// Its target; none where a run of the adaptive solver or a closed form gives it.
    pub target: Option<f64>,
    /// How near it must come.
    pub within: Within,
    /// Where the target comes from.
    pub source: &'static str,
    /// What the source work prints, where that is no target: it contradicts itself or is a reading
    /// from a plot.
    pub published: Option<&'static str>,
    /// Why this tolerance.
    pub reason: &'static str,
}

impl Bound {
    const fn new(
        quantity: &'static str,
        target: Option<f64>,
        within: Within,
        source: &'static str,
        reason: &'static str,
    ) -> Self {
        Self { quantity, target, within, source, published: None, reason }
    }

    const fn printed(self, published: &'static str) -> Self {
        Self { published: Some(published), ..self }
    }
}

use Within::{Absolute, AtMost, Factor, Relative, Shown};

const ADAPTIVE: &str = "adaptive solution";
const CLOSED: &str = "closed form";
const RECOMPUTED: &str = "recomputed";
const CONSERVATION: &str = "conservation";
const MEASURED: &str = "measured (EPowertrain2025, section 5.2.1)";

/// The adaptive solution of a UDDS set against earlier recomputations: SOC, energy, torque
/// (lowest, highest), current (lowest, highest), speed error.
pub const UDDS_ADAPTIVE: [Bound; 7] = [
    Bound::new("SOC at the end", Some(0.742_094), Absolute(5e-6), RECOMPUTED, "its last digits")
        .printed("0.743"),
    Bound::new(
        "battery energy [kWh]",
        Some(1.002_53),
        Relative(1e-4),
        RECOMPUTED,
        "its last digits",
    ),
    Bound::new("lowest torque [N·m]", Some(-839.0), Relative(0.003), RECOMPUTED, PEAK)
        .printed("-900"),
    Bound::new("highest torque [N·m]", Some(1043.2), Relative(0.003), RECOMPUTED, PEAK)
        .printed("1000"),
    Bound::new("lowest battery current [A]", Some(-90.8), Relative(0.006), RECOMPUTED, PEAK)
        .printed("-40"),
    Bound::new("highest battery current [A]", Some(77.1), Relative(0.006), RECOMPUTED, PEAK)
        .printed("above 60"),
    Bound::new("speed error [m/s]", Some(0.0094), Absolute(2e-4), RECOMPUTED, "rounded up"),
];

const PEAK: &str = "peaks of the 33 Hz ringing hang on the sampling";

/// The same of a run in steps of 0.1 ms.
pub const UDDS_EXPERIMENT: [Bound; 7] = [
    Bound { within: Absolute(2e-5), reason: TENTH_MS, ..UDDS_ADAPTIVE[0] },
    Bound { within: Relative(5e-4), reason: TENTH_MS, ..UDDS_ADAPTIVE[1] },
    Bound { within: Relative(0.01), ..UDDS_ADAPTIVE[2] },
    Bound { within: Relative(0.01), ..UDDS_ADAPTIVE[3] },
    Bound { within: Relative(0.01), ..UDDS_ADAPTIVE[4] },
    Bound { within: Relative(0.01), ..UDDS_ADAPTIVE[5] },
    Bound { within: Absolute(1e-4), ..UDDS_ADAPTIVE[6] },
];

const TENTH_MS: &str = "its last digits, and first order at 0.1 ms";

/// The same for the set of the table.
pub const UDDS_TABLE_ADAPTIVE: [Bound; 7] = [
    Bound::new("SOC at the end", Some(0.682_84), Absolute(6e-5), RECOMPUTED, TWO).printed("0.743"),
    Bound::new("battery energy [kWh]", Some(2.0179), Relative(0.0005), RECOMPUTED, TWO),
    Bound::new("lowest torque [N·m]", Some(-810.0), Relative(0.006), RECOMPUTED, TWO)
        .printed("-900"),
    Bound::new("highest torque [N·m]", Some(1006.0), Relative(0.007), RECOMPUTED, TWO)
        .printed("1000"),
    Bound::new("lowest battery current [A]", Some(-117.5), Relative(0.012), RECOMPUTED, TWO)
        .printed("-40"),
    Bound::new("highest battery current [A]", Some(249.0), Relative(0.013), RECOMPUTED, TWO)
        .printed("above 60"),
    Bound::new("speed error [m/s]", None, Shown, RECOMPUTED, "no earlier figure"),
];

const TWO: &str = "two earlier computations are 0.05 %, 0.6 % and 1.2 % apart";

/// A run on UDDS against the adaptive solution, in steps of 1 ms.
pub const UDDS_1MS: [Bound; 6] = [
    Bound::new("SOC over the whole run", None, AtMost(1e-4), ADAPTIVE, FIRST_ORDER),
    Bound::new("battery energy [kWh]", None, Relative(0.0015), ADAPTIVE, FIRST_ORDER),
    Bound::new("speed difference, RMS [m/s]", None, AtMost(1e-4), ADAPTIVE, FIRST_ORDER),
    Bound::new("highest torque [N·m]", None, Relative(0.01), ADAPTIVE, PEAKS_1MS),
    Bound::new("highest battery current [A]", None, Relative(0.08), ADAPTIVE, PEAKS_1MS),
    Bound::new("distance [km]", None, Relative(1e-5), ADAPTIVE, "the loop holds the speed"),
];

const FIRST_ORDER: &str = "first order: the loop sees the speed one step late";
const PEAKS_1MS: &str = "a step is 3 % of the ringing's period";

/// The same for the set of the table, which takes twice the energy.
pub const UDDS_TABLE_1MS: [Bound; 6] = [
    Bound { within: AtMost(2e-4), ..UDDS_1MS[0] },
    UDDS_1MS[1],
    UDDS_1MS[2],
    UDDS_1MS[3],
    UDDS_1MS[4],
    UDDS_1MS[5],
];
/// And in steps of 0.1 ms.
pub const UDDS_TABLE_100US: [Bound; 6] = [
    Bound { within: AtMost(2e-5), ..UDDS_100US[0] },
    UDDS_100US[1],
    UDDS_100US[2],
    UDDS_100US[3],
    UDDS_100US[4],
    UDDS_100US[5],
];

/// The same in steps of 0.1 ms.
pub const UDDS_100US: [Bound; 6] = [
    Bound::new("SOC over the whole run", None, AtMost(1e-5), ADAPTIVE, TENTH),
    Bound::new("battery energy [kWh]", None, Relative(0.000_15), ADAPTIVE, TENTH),
    Bound::new("speed difference, RMS [m/s]", None, AtMost(1e-5), ADAPTIVE, TENTH),
    Bound::new("highest torque [N·m]", None, Relative(0.005), ADAPTIVE, TENTH),
    Bound::new("highest battery current [A]", None, Relative(0.01), ADAPTIVE, TENTH),
    Bound::new("distance [km]", None, Relative(1e-5), ADAPTIVE, "the loop holds the speed"),
];

const TENTH: &str = "a tenth of the step, a tenth of the error";

/// How much nearer a tenth of the step comes: SOC, energy, speed.
pub const UDDS_GAIN: [Bound; 3] = [
    Bound::new("SOC error, 1 ms over 0.1 ms", Some(10.0), Factor(2.0), "first order", GAIN),
    Bound::new("energy error, 1 ms over 0.1 ms", Some(10.0), Factor(2.0), "first order", GAIN),
    Bound::new("speed error, 1 ms over 0.1 ms", Some(10.0), Factor(2.0), "first order", GAIN),
];

const GAIN: &str = "the leading term of the error dominates";

/// The energy ledger of every run.
pub const LEDGER: Bound = Bound::new(
    "ledger residual / throughput",
    None,
    AtMost(1e-6),
    CONSERVATION,
    "rounding of the powers in f32",
);

/// What the step itself dissipates, at 1 ms, at 0.1 ms, and where it is not bounded.
pub const NUMERICAL_1MS: Bound = Bound::new(
    "numerical dissipation / throughput",
    None,
    AtMost(1e-3),
    "of first order",
    "0.05 % on UDDS at 1 ms",
);
/// The same at 0.1 ms.
pub const NUMERICAL_100US: Bound = Bound { within: AtMost(1e-4), ..NUMERICAL_1MS };

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

/// The converter bench's energy balance.
pub const BENCH_BALANCE: Bound = Bound::new(
    "energy balance / throughput",
    None,
    AtMost(1e-6),
    CONSERVATION,
    "rounding of the powers in f32",
)
.printed("0");
pub const BENCH_SPEED: Bound = Bound::new(
    "speed difference, RMS [rad/s]",
    None,
    AtMost(5e-3),
    ADAPTIVE,
    "first order at 0.1 ms, edges of 40 rad/s",
);
pub const BENCH_ENERGY: Bound = Bound::new(
    "energy out of the supply [J]",
    None,
    Relative(2e-3),
    ADAPTIVE,
    "first order at 0.1 ms",
);
pub const BENCH_NUMERICAL: Bound =
    Bound { within: AtMost(5e-4), reason: "0.02 % at 0.1 ms", ..NUMERICAL_1MS };
pub const BENCH_SATURATED: Bound =
    Bound::new("saturated steps", None, AtMost(0.0), "choice of the gains", "none is wanted");

/// The synthetic trip and `TripA01` against the adaptive solution.
pub const TRIP_SOC: Bound =
    Bound::new("SOC over the whole run", None, AtMost(1e-4), ADAPTIVE, FIRST_ORDER);
pub const TRIP_ENERGY: Bound =
    Bound::new("battery energy [kWh]", None, Relative(0.0015), ADAPTIVE, FIRST_ORDER);
pub const TRIP_SPEED: Bound =
    Bound::new("speed difference, RMS [m/s]", None, AtMost(1e-3), ADAPTIVE, FIRST_ORDER);
pub const TRIP_NUMERICAL: Bound = Bound { reason: "no ringing to damp", ..NUMERICAL_100US };

/// `TripA01`, the battery alone on measured current: SOC at the end, voltage.
pub const TRIP_A01_BATTERY: [Bound; 2] = [
    Bound::new("battery mode: SOC error at the end", None, AtMost(0.01), "measured", NEGLIGIBLE)
        .printed("negligible"),
    Bound::new("battery mode: voltage, RMS [V]", None, Shown, "measured", "no figure published"),
];

const NEGLIGIBLE: &str = "readings in steps of 0.1 %; the capacity is the rated one";

/// `TripA01`, closed loop: SOC at the end, SOC drop, energy, current, torque, speed.
pub const TRIP_A01_VEHICLE: [Bound; 6] = [
    Bound::new("vehicle mode: SOC at the end", Some(0.815), Shown, "measured", AS_PRINTED),
    Bound::new("vehicle mode: SOC drop, relative error", None, Shown, "measured", AS_PRINTED)
        .printed("below 5 %"),
    Bound::new("vehicle mode: energy, relative error", None, Shown, "measured", AS_PRINTED)
        .printed("below 5 %"),
    Bound::new("vehicle mode: current, RMS [A]", None, Shown, "measured", AS_PRINTED),
    Bound::new("vehicle mode: torque, RMS [N·m]", None, Shown, "measured", AS_PRINTED),
    Bound::new(
        "vehicle mode: speed error [m/s]",
        None,
        Shown,
        "yardstick of the source work: 0.44",
        AS_PRINTED,
    ),
];

const AS_PRINTED: &str = "a recomputation of the print, errata included, is 12 % short";

// Single components.

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
