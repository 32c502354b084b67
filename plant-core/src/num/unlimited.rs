//! A limit in a file, for `#[serde(with = "…")]`: infinity where there is none.
//!
//! TOML writes infinity as `inf`. JSON knows no infinity: there `null` stands for it, which is read
//! as [`Real::INFINITY`], or by [`below`] as its negative. Formats that no human reads hold the
//! number as it is.

use serde::{Deserialize, Deserializer, Serialize, Serializer, ser::Error};

use super::Real;

/// Writes a limit from above.
///
/// # Errors
/// It is not a number, or −infinity: read back, that would be no limit.
pub fn serialize<S: Serializer>(limit: &Real, serializer: S) -> Result<S::Ok, S::Error> {
    write(*limit, Real::INFINITY, serializer)
}

/// Reads a limit from above.
///
/// # Errors
/// Neither a number nor `null`.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Real, D::Error> {
    read(Real::INFINITY, deserializer)
}

/// The same for a limit from below: −infinity where there is none.
pub mod below {
    use super::{Deserializer, Real, Serializer, read, write};

    /// Writes a limit from below.
    ///
    /// # Errors
    /// It is not a number, or infinity: read back, that would be no limit.
    pub fn serialize<S: Serializer>(limit: &Real, serializer: S) -> Result<S::Ok, S::Error> {
        write(*limit, -Real::INFINITY, serializer)
    }

    /// Reads a limit from below.
    ///
    /// # Errors
    /// Neither a number nor `null`.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Real, D::Error> {
        read(-Real::INFINITY, deserializer)
    }
}

fn write<S: Serializer>(limit: Real, none: Real, serializer: S) -> Result<S::Ok, S::Error> {
    #[expect(clippy::float_cmp, reason = "infinity is exact")]
    if limit.is_finite() || limit == none {
        limit.serialize(serializer)
    } else {
        Err(S::Error::custom("a limit must be a number, or infinite where there is none"))
    }
}

fn read<'de, D: Deserializer<'de>>(none: Real, deserializer: D) -> Result<Real, D::Error> {
    if deserializer.is_human_readable() {
        Ok(Option::deserialize(deserializer)?.unwrap_or(none))
    } else {
        Real::deserialize(deserializer)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::string::{String, ToString};

    use crate::auxiliary::AuxiliaryParams;
    use crate::battery::VoltageLimits;
    use crate::control::pid::PidParams;
    use crate::num::Real;

    fn json(value: &impl serde::Serialize) -> Result<String, String> {
        serde_json::to_string(value).map_err(|e| e.to_string())
    }

    #[test]
    fn no_limit_is_null_in_json() {
        let text = json(&PidParams::DEFAULT).unwrap();
        assert!(text.contains(r#""output_min":null,"output_max":null"#), "{text}");
        assert_eq!(serde_json::from_str::<PidParams>(&text).unwrap(), PidParams::DEFAULT);
        let limited = PidParams { output_min: -0.1, output_max: 0.7, ..PidParams::DEFAULT };
        let text = json(&limited).unwrap();
        assert_eq!(serde_json::from_str::<PidParams>(&text).unwrap(), limited);
    }

    #[test]
    fn one_voltage_may_be_limited_alone() {
        let read = |text| serde_json::from_str::<VoltageLimits>(text).unwrap();
        assert_eq!(json(&VoltageLimits::NONE).unwrap(), r#"{"lowest_v":null,"highest_v":null}"#);
        assert_eq!(read(r#"{"lowest_v":null,"highest_v":null}"#), VoltageLimits::NONE);
        let lowest = VoltageLimits { lowest_v: 2.5, ..VoltageLimits::NONE };
        assert_eq!(read(r#"{"lowest_v":2.5}"#), lowest);
    }

    #[test]
    fn what_would_be_read_as_no_limit_is_not_written() {
        for pid in [
            PidParams { output_max: Real::NAN, ..PidParams::DEFAULT },
            PidParams { output_max: -Real::INFINITY, ..PidParams::DEFAULT },
            PidParams { output_min: Real::INFINITY, ..PidParams::DEFAULT },
        ] {
            assert!(json(&pid).unwrap_err().starts_with("a limit must be a number"));
        }
    }

    #[test]
    fn only_a_limit_may_be_null_and_it_has_to_be_there() {
        let read = |text| serde_json::from_str::<AuxiliaryParams>(text).map_err(|e| e.to_string());
        let text = r#"{"power_w":0.0,"resistance_ohm":null,"cut_out_v":1.0}"#;
        assert_eq!(read(text).unwrap(), AuxiliaryParams::NONE);
        let error = read(r#"{"power_w":null,"resistance_ohm":1.0,"cut_out_v":1.0}"#).unwrap_err();
        assert!(error.starts_with("invalid type: null"), "{error}");
        let error = read(r#"{"power_w":0.0,"resistance_ohm":"inf","cut_out_v":1.0}"#).unwrap_err();
        assert!(error.starts_with("invalid type: string"), "{error}");
    }
}
