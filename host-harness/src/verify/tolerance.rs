//! Every target and every tolerance of `voltstep validate`, in one place, with its reason: here what
//! they are and those of whole vehicles, beside it those of machines and of components.

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

mod components;
mod converters;
mod machines;

pub use components::*;
pub use converters::*;
pub use machines::*;

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
