//! Sensors: what a measurement makes of a value.
//!
//! `reading = gain·x + offset`, rounded to the nearest multiple of the quantum; on a shaft
//! `ω_el = p·ω_mech`, `θ = ∫ω dt`. The quantities are those of \[EPowertrain2025, `Sensors`\],
//! which are ideal; the errors are ours.
//!
//! Tests: below; properties `finite`, `refusal`; case "sensors".

use crate::error::{ParamError, check, finite, not_negative, positive};
use crate::mechanics::rotational::{angle_rad, turn, turns_per_rad_s};
use crate::model::{Dt, impl_model};
use crate::num::{Accum, Real, floor, sane};

/// Parameters of a sensor; the same for every quantity, in the quantity's own unit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct SensorParams {
    /// Reading per value; 1 for a true sensor, 0 for a dead one.
    pub gain: Real,
    /// Reading at value zero.
    pub offset: Real,
    /// Step between two readings, ≥ 0; 0 for none.
    pub quantum: Real,
}

impl Default for SensorParams {
    /// Reads the value itself.
    fn default() -> Self {
        Self::IDEAL
    }
}

impl SensorParams {
    /// Reads the value itself.
    pub const IDEAL: Self = Self { gain: 1.0, offset: 0.0, quantum: 0.0 };
}

/// `reading = gain·x + offset`, rounded to the nearest multiple of the quantum.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scale {
    gain: Real,
    offset: Real,
    quantum: Real,
    per_quantum: Real,
}

impl Scale {
    const fn new(params: SensorParams) -> Result<Self, ParamError> {
        let quantum = check!(not_negative("sensor.quantum", params.quantum));
        Ok(Self {
            gain: check!(finite("sensor.gain", params.gain)),
            offset: check!(finite("sensor.offset", params.offset)),
            quantum,
            per_quantum: if quantum > 0.0 {
                1.0 / check!(positive("sensor.quantum", quantum))
            } else {
                0.0
            },
        })
    }

    #[inline]
    fn reading(&self, value: Real) -> Real {
        let reading = self.gain * value + self.offset;
        if self.quantum > 0.0 {
            self.quantum * floor(reading * self.per_quantum + 0.5)
        } else {
            reading
        }
    }
}

/// A sensor of one quantity: the same for each, but for the unit in the field's name.
macro_rules! sensor_of {
    ($quantity:literal, $field:ident, $unit:literal, $sensor:ident, $input:ident, $output:ident) => {
        #[doc = concat!("A ", $quantity, " sensor: `gain·x + offset`, in multiples of the quantum.")]
        ///
        /// It has no state of its own and no time in it, so it takes no `Dt`.
        ///
        /// ```
        /// use plant_core::must;
        #[doc = concat!(
            "use plant_core::signal::sensors::{SensorParams, ", stringify!($sensor), ", ",
            stringify!($input), "};"
        )]
        ///
        /// const PARAMS: SensorParams = SensorParams { gain: 1.0, offset: 0.5, quantum: 0.1 };
        #[doc = concat!(
            "const SENSOR: ", stringify!($sensor), " = must!(", stringify!($sensor),
            "::new(PARAMS));"
        )]
        ///
        #[doc = concat!(
            "let out = SENSOR.step(&mut (), ", stringify!($input), " { ", stringify!($field),
            ": 12.34 });"
        )]
        #[doc = concat!("assert!((out.", stringify!($field), " - 12.8).abs() < 1e-5);")]
        /// ```
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $sensor {
            scale: Scale,
        }

        #[doc = concat!("Input of a [`", stringify!($sensor), "`].")]
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $input {
            #[doc = concat!("The true ", $quantity, " \\[", $unit, "\\].")]
            pub $field: Real,
        }

        #[doc = concat!("Output of a [`", stringify!($sensor), "`].")]
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub struct $output {
            #[doc = concat!("The ", $quantity, " that it reads \\[", $unit, "\\].")]
            pub $field: Real,
            /// The input was not finite or absurd; the reading is zero.
            pub rejected: bool,
        }

        impl $sensor {
            /// Checks `params`.
            ///
            /// # Errors
            /// [`ParamError`] names the first field that is out of range.
            pub const fn new(params: SensorParams) -> Result<Self, ParamError> {
                Ok(Self { scale: check!(Scale::new(params)) })
            }

            /// One reading.
            #[inline]
            #[must_use]
            pub fn step(&self, _state: &mut (), input: $input) -> $output {
                let rejected = !sane(input.$field);
                let $field = if rejected { 0.0 } else { self.scale.reading(input.$field) };
                $output { $field, rejected }
            }
        }

        impl_model!($sensor, (), $input, $output);
    };
}

sensor_of!("voltage", voltage_v, "V", VoltageSensor, VoltageSensorInput, VoltageSensorOutput);
sensor_of!("current", current_a, "A", CurrentSensor, CurrentSensorInput, CurrentSensorOutput);

/// Parameters of a speed sensor on a shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct AxialSpeedSensorParams {
    /// What the sensor makes of the mechanical speed \[rad/s\].
    pub speed: SensorParams,
    /// Pole pairs of the machine, 1 at least.
    pub pole_pairs: u16,
}

/// A speed sensor on a shaft, with the angle.
///
/// `ω_el = p·ω_mech`, p the pole pairs; `θ` is the integral of the true speed, whatever the
/// speed's reading is. \[EPowertrain2025, `AxialSpeed`\] swaps electrical and mechanical speed.
///
/// ```
/// use plant_core::signal::sensors::{
///     AxialSpeedSensor, AxialSpeedSensorInput, AxialSpeedSensorParams, AxialSpeedSensorState,
///     SensorParams,
/// };
/// use plant_core::{Dt, must};
///
/// const RESOLVER: AxialSpeedSensor = must!(AxialSpeedSensor::new(
///     AxialSpeedSensorParams { speed: SensorParams::IDEAL, pole_pairs: 6 },
///     must!(Dt::from_s(0.01)),
/// ));
///
/// let mut state = AxialSpeedSensorState::default();
/// let out = RESOLVER.step(&mut state, AxialSpeedSensorInput { speed_rad_s: 10.0 });
/// assert_eq!(out.electrical_speed_rad_s, 60.0);
/// assert!((out.angle_rad - 0.1).abs() < 1e-6 && (out.electrical_angle_rad - 0.6).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxialSpeedSensor {
    scale: Scale,
    pole_pairs: Real,
    turns_per_rad_s: Real,
}

/// The state of an [`AxialSpeedSensor`]; at angle zero by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AxialSpeedSensorState {
    /// Mechanical angle in turns, within 0..1 (1 where an angle just below rounds up to it).
    pub turns: Accum,
}

/// Input of an [`AxialSpeedSensor`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxialSpeedSensorInput {
    /// The true mechanical speed over the step \[rad/s\].
    pub speed_rad_s: Real,
}

/// Output of one step of an [`AxialSpeedSensor`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AxialSpeedSensorOutput {
    /// The mechanical speed that it reads \[rad/s\].
    pub speed_rad_s: Real,
    /// The electrical speed that follows from the reading \[rad/s\].
    pub electrical_speed_rad_s: Real,
    /// Mechanical angle at the end of the step \[rad\], 0 up to, not including, 2π.
    pub angle_rad: Real,
    /// Electrical angle at the end of the step \[rad\], 0 up to, not including, 2π.
    pub electrical_angle_rad: Real,
    /// The input was not finite or absurd: both speeds read zero, the state is unchanged.
    pub rejected: bool,
}

impl AxialSpeedSensor {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: AxialSpeedSensorParams, dt: Dt) -> Result<Self, ParamError> {
        Ok(Self {
            scale: check!(Scale::new(params.speed)),
            pole_pairs: check!(positive("sensor.pole_pairs", params.pole_pairs as Real)),
            turns_per_rad_s: turns_per_rad_s(dt),
        })
    }

    /// Advances by one step.
    #[inline]
    pub fn step(
        &self,
        state: &mut AxialSpeedSensorState,
        input: AxialSpeedSensorInput,
    ) -> AxialSpeedSensorOutput {
        let rejected = !sane(input.speed_rad_s);
        let mut speed_rad_s = 0.0;
        if !rejected {
            turn(&mut state.turns, input.speed_rad_s * self.turns_per_rad_s);
            speed_rad_s = self.scale.reading(input.speed_rad_s);
        }
        let turns = state.turns.get();
        AxialSpeedSensorOutput {
            speed_rad_s,
            electrical_speed_rad_s: self.pole_pairs * speed_rad_s,
            angle_rad: angle_rad(turns),
            electrical_angle_rad: angle_rad(self.pole_pairs * turns),
            rejected,
        }
    }
}

impl_model!(AxialSpeedSensor, AxialSpeedSensorState, AxialSpeedSensorInput, AxialSpeedSensorOutput);

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::num::PI;

    const IDEAL: SensorParams = SensorParams::IDEAL;

    fn volts(params: SensorParams, voltage_v: Real) -> Real {
        let sensor = VoltageSensor::new(params).unwrap();
        sensor.step(&mut (), VoltageSensorInput { voltage_v }).voltage_v
    }

    fn speed_sensor(pole_pairs: u16, speed: SensorParams) -> AxialSpeedSensor {
        let dt = Dt::from_s(1e-3).unwrap();
        AxialSpeedSensor::new(AxialSpeedSensorParams { speed, pole_pairs }, dt).unwrap()
    }

    #[test]
    fn an_ideal_sensor_reads_the_value_itself() {
        let sensor = CurrentSensor::new(SensorParams::default()).unwrap();
        for x in [-1e9, -3.3, 0.0, 1e-7, 812.5] {
            assert_eq!(volts(IDEAL, x), x);
            let out = sensor.step(&mut (), CurrentSensorInput { current_a: x });
            assert_eq!(out, CurrentSensorOutput { current_a: x, rejected: false });
        }
    }

    #[test]
    fn gain_and_offset_falsify_it() {
        assert_eq!(volts(SensorParams { gain: 1.5, offset: -2.0, ..IDEAL }, 10.0), 13.0);
        assert_eq!(volts(SensorParams { gain: 0.0, offset: 5.0, ..IDEAL }, 10.0), 5.0);
    }

    #[test]
    fn reads_the_nearest_multiple_of_the_quantum() {
        let params = SensorParams { quantum: 0.25, ..IDEAL };
        for (x, reading) in
            [(1.1, 1.0), (1.13, 1.25), (-1.1, -1.0), (-1.2, -1.25), (0.0, 0.0), (0.124, 0.0)]
        {
            assert_eq!(volts(params, x), reading, "{x}");
        }
        for i in -100..100 {
            let x = i as Real * 0.037;
            assert!((volts(SensorParams { quantum: 0.1, ..IDEAL }, x) - x).abs() < 0.050_01);
        }
    }

    #[test]
    fn the_largest_values_stay_finite() {
        let params = SensorParams { gain: 1e12, offset: 1e12, quantum: 1e-12 };
        assert!(volts(params, 1e9).is_finite());
    }

    #[test]
    fn electrical_speed_is_the_mechanical_one_times_the_pole_pairs() {
        let (sensor, mut s) = (speed_sensor(4, IDEAL), AxialSpeedSensorState::default());
        let out = sensor.step(&mut s, AxialSpeedSensorInput { speed_rad_s: 100.0 });
        assert_eq!((out.speed_rad_s, out.electrical_speed_rad_s), (100.0, 400.0));
        assert!((out.angle_rad - 0.1).abs() < 1e-6);
        assert!((out.electrical_angle_rad - 0.4).abs() < 1e-6);
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn the_angle_follows_the_true_speed_and_wraps_both_ways() {
        let wrong = SensorParams { gain: 2.0, offset: 1.0, quantum: 10.0 };
        for pole_pairs in [1, 3, u16::MAX] {
            let (sensor, mut s) =
                (speed_sensor(pole_pairs, wrong), AxialSpeedSensorState::default());
            for (speed_rad_s, reading) in [(47.0, 100.0), (-47.0, -90.0)] {
                for _ in 0..12_345 {
                    let out = sensor.step(&mut s, AxialSpeedSensorInput { speed_rad_s });
                    assert_eq!(out.speed_rad_s, reading);
                    for angle in [out.angle_rad, out.electrical_angle_rad] {
                        assert!((0.0..2.0 * PI).contains(&angle), "{out:?}");
                    }
                }
            }
            let off = s.turns.get() - floor(s.turns.get() + 0.5);
            assert!(off.abs() < 1e-6, "there and back: {s:?}");
        }
    }

    #[test]
    fn bad_input_reads_zero_and_changes_nothing() {
        let sensor = VoltageSensor::new(SensorParams { offset: 3.0, ..IDEAL }).unwrap();
        let (speed, mut s) = (speed_sensor(2, IDEAL), AxialSpeedSensorState::default());
        speed.step(&mut s, AxialSpeedSensorInput { speed_rad_s: 100.0 });
        let before = s;
        for bad in [Real::NAN, Real::INFINITY, -1e38] {
            let out = sensor.step(&mut (), VoltageSensorInput { voltage_v: bad });
            assert_eq!(out, VoltageSensorOutput { voltage_v: 0.0, rejected: true });
            let out = speed.step(&mut s, AxialSpeedSensorInput { speed_rad_s: bad });
            assert!(out.rejected && out.speed_rad_s == 0.0 && out.angle_rad > 0.0);
            assert_eq!(s, before);
        }
    }

    #[test]
    fn refuses_each_bad_field_by_name() {
        let refused = |p| VoltageSensor::new(p).unwrap_err();
        for bad in [Real::NAN, Real::INFINITY, -1e13] {
            for (params, error) in [
                (SensorParams { gain: bad, ..IDEAL }, ParamError::NotFinite("sensor.gain")),
                (SensorParams { offset: bad, ..IDEAL }, ParamError::NotFinite("sensor.offset")),
                (SensorParams { quantum: bad, ..IDEAL }, ParamError::Negative("sensor.quantum")),
            ] {
                assert_eq!(refused(params), error);
                assert_eq!(CurrentSensor::new(params).unwrap_err(), error);
            }
        }
        let tiny = SensorParams { quantum: 1e-20, ..IDEAL };
        assert_eq!(refused(tiny), ParamError::NotPositive("sensor.quantum"));
        let dt = Dt::from_s(1e-3).unwrap();
        let none = AxialSpeedSensorParams { speed: IDEAL, pole_pairs: 0 };
        assert_eq!(
            AxialSpeedSensor::new(none, dt).unwrap_err(),
            ParamError::NotPositive("sensor.pole_pairs")
        );
        let bad = AxialSpeedSensorParams { speed: tiny, pole_pairs: 1 };
        assert_eq!(refused(tiny), AxialSpeedSensor::new(bad, dt).unwrap_err());
    }
}
