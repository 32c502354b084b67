#![no_std]
#![forbid(unsafe_code)]
// Tests run on the host and compare with the standard library's functions.
#![cfg_attr(
    test,
    allow(
        clippy::disallowed_methods,
        clippy::cast_possible_truncation,
        clippy::cast_precision_loss,
        clippy::cast_sign_loss,
        clippy::many_single_char_names
    )
)]
//! EV powertrain plant models that step in closed form on a microcontroller, in `f32`, bit for bit
//! as on a PC.
//!
//! # Map
//! Each module uses only those above it.
//!
//! | Module | What it holds |
//! |---|---|
//! | [`num`], [`error`], [`model`] | the scalar [`Real`], compensated sums, lookup table, the only calls to `libm`; why a parameter set is refused ([`must!`] turns that into a compile error); the trait every model shares and the fixed step [`Dt`] |
//! | [`port`] | what components say to each other within a step |
//! | [`thermal`] | lumped thermal nodes; derating, resistance over temperature, the losses of a drive |
//! | [`battery`] | open-circuit voltage, resistances, one RC branch or two, state of charge, temperature; cells in series |
//! | [`link`] | contactors, precharge, link capacitor and fuse between battery and vehicle |
//! | [`auxiliary`] | what else draws from the battery |
//! | [`circuit`] | any network of switches, diodes, transistors, coils, capacitors: the switched converter |
//! | [`converter`] | averaged four-quadrant converter |
//! | [`mechanics`] | [`gearbox`](mechanics::gearbox), [`wheel`](mechanics::wheel), [`body`](mechanics::body), [`slope`](mechanics::slope); [`rotational`](mechanics::rotational): a load on a shaft, its angle, a shaft with inertia |
//! | [`machine`] | electric machines: [`dc`](machine::dc), [`pmsm`](machine::pmsm) with its [`flux`](machine::flux); three phases as one vector: [`transform`](machine::transform) |
//! | [`signal`] | [`sources`](signal::sources) over time, what [`sensors`](signal::sensors) make of a value, and their [`faults`](signal::faults) |
//! | [`powertrain`] | the coupled plant, and its energy [`ledger`](powertrain::ledger) |
//! | [`control`] | [`pid`](control::pid); [`driver`](control::driver): speed to torque to duty; [`foc`](control::foc): torque to the voltage of a synchronous machine |
//! | [`presets`] | parameter sets with their sources |
//!
//! # Conventions
//! - SI units, named in each field: `_a`, `_v`, `_ohm`, `_nm`, `_m_s`, … State of charge and
//!   efficiency are ratios in 0..1, duty is a ratio in −1..1, angles are in rad.
//! - Discharge current is positive. Traction torque, traction force and forward speed are
//!   positive; a positive slope climbs; wind is positive against the vehicle. Losses are ≥ 0.
//! - Parameters are checked once, in a `const fn new`; after that nothing fails or panics. An
//!   input that is not finite, or larger than [`num::LARGEST`], leaves the state as it was and is
//!   reported as `rejected` in the output.
//! - One step goes from instant n to n + 1. Outputs hold at n + 1.
//! - A component's header gives its equation and its source: a key in brackets is one of the book's
//!   list of references (`docs/src/references.md`), what is ours says so. It ends with where its
//!   tests are: `properties` lie in `tests/tests/properties`, cases are those of `voltstep
//!   validate`.
//!
//! # Example
//! ```
//! use plant_core::{DcMotor, DcMotorInput, DcMotorState, Dt, must, presets};
//!
//! const DT: Dt = must!(Dt::from_s(0.001));
//! const MOTOR: DcMotor = must!(DcMotor::new(presets::MOTOR_PASEK, DT));
//!
//! let mut state = DcMotorState::default();
//! let mut speed_rad_s = 0.0;
//! for _ in 0..2000 {
//!     speed_rad_s = MOTOR.step(&mut state, DcMotorInput { voltage_v: 60.0, load_nm: 0.0 }).speed_rad_s;
//! }
//! assert!((speed_rad_s * 60.0 / 6.2832 - 407.9).abs() < 0.5); // rpm
//! ```

pub mod auxiliary;
pub mod battery;
pub mod circuit;
pub mod control;
pub mod converter;
pub mod error;
pub mod link;
pub mod machine;
pub mod mechanics;
pub mod model;
pub mod num;
pub mod port;
pub mod powertrain;
pub mod presets;
pub mod signal;
pub mod thermal;

pub use battery::{Battery, BatteryParams, MappedBattery, MappedBatteryParams};
pub use control::driver::{Driver, DriverInput, DriverOutput, DriverParams, DriverState};
pub use control::pid::{Pid, PidInput, PidOutput, PidParams, PidState};
pub use error::ParamError;
pub use machine::dc::{DcMotor, DcMotorInput, DcMotorOutput, DcMotorParams, DcMotorState};
pub use model::{Dt, Model};
pub use num::{Accum, Real};
pub use powertrain::{
    Feedback, Powertrain, PowertrainInput, PowertrainOutput, PowertrainParams, PowertrainState,
};

/// The example of this crate's README, kept compiling.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
