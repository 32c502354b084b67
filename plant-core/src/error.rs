//! Why a parameter set is refused.

use crate::num::{LARGEST_PARAM, Real, SMALLEST_PARAM};

/// A parameter that broke a rule: which field (`component.field_unit`), and which rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ParamError {
    /// Must be finite and between 1e-12 and 1e12.
    NotPositive(&'static str),
    /// Must be finite, zero or above, and at most 1e12.
    Negative(&'static str),
    /// Must be finite and between −1e12 and 1e12.
    NotFinite(&'static str),
    /// Must be at least 1e-12; infinity means no limit.
    NotALimit(&'static str),
    /// Must lie in 0..1, both included.
    NotARatio(&'static str),
    /// Must lie above 0 and up to 1.
    NotAnEfficiency(&'static str),
    /// Must lie above the field that limits it from below.
    NotAbove(&'static str),
    /// Must have two entries at least, each finite and above the one before.
    NotIncreasing(&'static str),
    /// Must have as many entries as the field that it belongs to.
    LengthsDiffer(&'static str),
    /// Must not decrease from one entry to the next.
    Decreasing(&'static str),
    /// Must lie in the range that the field's documentation gives.
    OutOfRange(&'static str),
}

impl ParamError {
    /// The field that broke the rule, as `component.field_unit`.
    #[must_use]
    pub const fn field(self) -> &'static str {
        match self {
            Self::NotPositive(f)
            | Self::Negative(f)
            | Self::NotFinite(f)
            | Self::NotALimit(f)
            | Self::NotARatio(f)
            | Self::NotAnEfficiency(f)
            | Self::NotAbove(f)
            | Self::NotIncreasing(f)
            | Self::LengthsDiffer(f)
            | Self::Decreasing(f)
            | Self::OutOfRange(f) => f,
        }
    }

    /// The rule, as words that follow the field's name.
    #[must_use]
    pub const fn message(self) -> &'static str {
        match self {
            Self::NotPositive(_) => "must be finite and between 1e-12 and 1e12",
            Self::Negative(_) => "must be finite, zero or above, and at most 1e12",
            Self::NotFinite(_) => "must be finite and between -1e12 and 1e12",
            Self::NotALimit(_) => "must be at least 1e-12 (infinity: no limit)",
            Self::NotARatio(_) => "must lie in 0..1",
            Self::NotAnEfficiency(_) => "must lie above 0 and up to 1",
            Self::NotAbove(_) => "must lie above the field that limits it from below",
            Self::NotIncreasing(_) => {
                "must have two entries at least, each finite and above the one before"
            }
            Self::LengthsDiffer(_) => "must have as many entries as the field that it belongs to",
            Self::Decreasing(_) => "must not decrease from one entry to the next",
            Self::OutOfRange(_) => "must lie in the range that its documentation gives",
        }
    }

    /// `field rule` in one text, for the compile error of [`must!`](crate::must).
    #[doc(hidden)]
    #[must_use]
    pub const fn text(self) -> ErrorText {
        let mut text = ErrorText { bytes: [b' '; ErrorText::LENGTH], length: 0 };
        text.push(self.field());
        text.push(" ");
        text.push(self.message());
        text
    }
}

impl core::fmt::Display for ParamError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.field())?;
        f.write_str(" ")?;
        f.write_str(self.message())
    }
}

impl core::error::Error for ParamError {}

/// A short text that a `const fn` can build.
#[doc(hidden)]
#[derive(Clone, Copy)]
pub struct ErrorText {
    bytes: [u8; Self::LENGTH],
    length: usize,
}

impl ErrorText {
    const LENGTH: usize = 160;

    /// `what number rule`, for an error that counts.
    pub(crate) const fn numbered(what: &str, rule: &str, number: usize) -> Self {
        let mut text = Self { bytes: [b' '; Self::LENGTH], length: 0 };
        text.push(what);
        text.push(" ");
        text.push(rule);
        text.push(" (");
        let mut decade = 1;
        while number / decade >= 10 {
            decade *= 10;
        }
        while decade > 0 {
            const DIGITS: &str = "0123456789";
            let digit = number / decade % 10;
            text.push(DIGITS.split_at(digit).1.split_at(1).0);
            decade /= 10;
        }
        text.push(")");
        text
    }

    const fn push(&mut self, part: &str) {
        let part = part.as_bytes();
        let mut i = 0;
        while i < part.len() && self.length < Self::LENGTH {
            self.bytes[self.length] = part[i];
            self.length += 1;
            i += 1;
        }
    }

    /// The text.
    #[must_use]
    pub const fn as_str(&self) -> &str {
        match core::str::from_utf8(self.bytes.split_at(self.length).0) {
            Ok(text) => text,
            Err(_) => "bad parameter",
        }
    }
}

/// Takes the value out of a `Result<_, ParamError>` **at compile time**: a bad parameter is a
/// compile error that names the field and the rule, and no panic reaches the firmware.
///
/// ```
/// use plant_core::{Dt, must};
/// const DT: Dt = must!(Dt::from_s(0.001));
/// ```
/// ```compile_fail
/// use plant_core::{Dt, must};
/// const DT: Dt = must!(Dt::from_s(-0.001)); // dt_s must be finite and between 1e-12 and 1e12
/// ```
#[macro_export]
macro_rules! must {
    ($checked:expr) => {
        const {
            match $checked {
                Ok(value) => value,
                Err(error) => panic!("{}", error.text().as_str()),
            }
        }
    };
}

/// `?` for a `const fn`, for crates that check their parameters as this one does.
#[doc(hidden)]
#[macro_export]
macro_rules! check {
    ($result:expr) => {
        match $result {
            Ok(value) => value,
            Err(error) => return Err(error),
        }
    };
}
pub use check;

/// `value` must lie between 1e-12 and 1e12.
///
/// # Errors
/// [`ParamError::NotPositive`] names `field`.
pub const fn positive(field: &'static str, value: Real) -> Result<Real, ParamError> {
    if value >= SMALLEST_PARAM && value <= LARGEST_PARAM {
        Ok(value)
    } else {
        Err(ParamError::NotPositive(field))
    }
}

/// `value` must lie zero or above and at most 1e12.
///
/// # Errors
/// [`ParamError::Negative`] names `field`.
pub const fn not_negative(field: &'static str, value: Real) -> Result<Real, ParamError> {
    if value >= 0.0 && value <= LARGEST_PARAM {
        Ok(value)
    } else {
        Err(ParamError::Negative(field))
    }
}

/// `value` must be finite and between −1e12 and 1e12.
///
/// # Errors
/// [`ParamError::NotFinite`] names `field`.
pub const fn finite(field: &'static str, value: Real) -> Result<Real, ParamError> {
    if value >= -LARGEST_PARAM && value <= LARGEST_PARAM {
        Ok(value)
    } else {
        Err(ParamError::NotFinite(field))
    }
}

/// A limit: above zero, infinity for none.
///
/// # Errors
/// [`ParamError::NotALimit`] names `field`.
pub const fn limit(field: &'static str, value: Real) -> Result<Real, ParamError> {
    if value >= SMALLEST_PARAM { Ok(value) } else { Err(ParamError::NotALimit(field)) }
}

/// `value` must lie in 0..1.
///
/// # Errors
/// [`ParamError::NotARatio`] names `field`.
pub const fn ratio(field: &'static str, value: Real) -> Result<Real, ParamError> {
    if value >= 0.0 && value <= 1.0 { Ok(value) } else { Err(ParamError::NotARatio(field)) }
}

/// `value` must lie above 0 and up to 1.
///
/// # Errors
/// [`ParamError::NotAnEfficiency`] names `field`.
pub const fn efficiency(field: &'static str, value: Real) -> Result<Real, ParamError> {
    if value > 0.0 && value <= 1.0 { Ok(value) } else { Err(ParamError::NotAnEfficiency(field)) }
}

/// `value` must lie above `low`.
///
/// # Errors
/// [`ParamError::NotAbove`] names `field`.
pub const fn above(field: &'static str, value: Real, low: Real) -> Result<Real, ParamError> {
    if value > low { Ok(value) } else { Err(ParamError::NotAbove(field)) }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn the_compile_error_says_what_display_says() {
        for error in [
            ParamError::NotPositive("battery.capacity_ah"),
            ParamError::Negative("x"),
            ParamError::NotIncreasing("a.table"),
        ] {
            let text = std::format!("{} {}", error.field(), error.message());
            assert_eq!(error.text().as_str(), text);
            assert_eq!(std::format!("{error}"), text);
        }
        assert_eq!(ParamError::NotARatio("soc").text().as_str(), "soc must lie in 0..1");
        // What is too long is cut.
        let long = ParamError::NotARatio(
            "a_field_whose_name_goes_on_and_on_and_on_until_the_text_has_no_room_for_it_any_more_\
             a_field_whose_name_goes_on_and_on_and_on_until_the_text_has_no_room_for_it_any_more",
        );
        assert_eq!(long.text().as_str(), &long.field()[..ErrorText::LENGTH]);
    }

    #[test]
    fn each_rule_takes_its_ends_and_nothing_beyond() {
        type Rule = fn(&'static str, Real) -> Result<Real, ParamError>;
        let (low, high) = (SMALLEST_PARAM, LARGEST_PARAM);
        let cases: [(Rule, &[Real], &[Real]); 6] = [
            (positive, &[low, 1.0, high], &[0.0, 0.9 * low, 1.1 * high, -1.0]),
            (not_negative, &[0.0, 1.0, high], &[-low, 1.1 * high]),
            (finite, &[-high, 0.0, high], &[-1.1 * high, 1.1 * high]),
            (limit, &[low, 1.0, Real::INFINITY], &[0.0, 0.9 * low, -1.0]),
            (ratio, &[0.0, 0.3, 1.0], &[-low, 1.001]),
            (efficiency, &[low, 0.3, 1.0], &[0.0, -0.5, 1.001]),
        ];
        for (i, (rule, taken, refused)) in cases.into_iter().enumerate() {
            for x in taken {
                assert_eq!(rule("x", *x), Ok(*x), "{i}");
            }
            for x in refused.iter().chain(&[Real::NAN, -Real::INFINITY]) {
                assert_eq!(rule("x", *x).unwrap_err().field(), "x", "{i}: {x}");
            }
        }
        assert_eq!(above("x", 2.0, 1.0), Ok(2.0));
        assert!(above("x", 1.0, 1.0).is_err() && above("x", 0.0, 1.0).is_err());
    }
}
