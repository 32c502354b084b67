//! Every signal, over every value that it can have.

extern crate std;

use proptest::prelude::*;

use super::super::field::{Field, Rounding};
use super::{INVERTER, OWN};
use crate::Real;

/// Those that hold a value: wider ones are bytes and masks.
fn values() -> impl Iterator<Item = &'static Field> {
    OWN.iter().chain(INVERTER).flat_map(|layout| layout.fields).filter(|field| field.width <= 16)
}

/// The raw numbers that stand for a value, and that value.
fn decoded(field: &Field) -> impl Iterator<Item = (u64, Real)> {
    let (low, high) = field.range();
    (low..=high).map(|raw| {
        let bits = field.with_raw(0, i64::from(raw) as u64);
        let bits = field.valid.map_or(bits, |bit| bits | 1 << bit);
        (bits, field.of(bits))
    })
}

#[test]
fn every_raw_number_comes_back() {
    let mut tried = 0_u64;
    for field in values() {
        for (bits, value) in decoded(field) {
            assert!(!value.is_nan(), "{}: {bits:#x}", field.name);
            assert_eq!(field.with(0, value), bits, "{}: {value}", field.name);
            tried += 1;
        }
    }
    assert!(tried > 900_000, "all numbers of all signals: {tried}");
}

#[test]
fn what_is_missing_stays_missing() {
    for field in values() {
        let bits = field.with(0, Real::NAN);
        let Some(valid) = field.valid else {
            let lowest = decoded(field).next().unwrap().1;
            assert_eq!(field.of(bits), lowest, "{}: nothing can be missing", field.name);
            continue;
        };
        assert_eq!(bits >> valid & 1, 0, "{}", field.name);
        assert!(field.of(bits).is_nan(), "{}", field.name);
        // Either alone is enough to refuse it.
        assert!(field.of(bits | 1 << valid).is_nan(), "{}: all ones", field.name);
        assert!(field.of(field.with_raw(0, 5)).is_nan(), "{}: not valid", field.name);
    }
}

#[test]
fn beyond_the_range_the_end_is_sent() {
    for field in values() {
        let (low, high) = {
            let mut all = decoded(field);
            let low = all.next().unwrap().1;
            (low, all.last().unwrap().1)
        };
        for (value, end) in [
            (Real::NEG_INFINITY, low),
            (-3e38, low),
            (low - 1.5 * field.factor, low),
            (high + 1.5 * field.factor, high),
            (3e38, high),
            (Real::INFINITY, high),
        ] {
            assert_eq!(field.of(field.with(0, value)), end, "{}: {value}", field.name);
        }
    }
}

#[test]
fn only_its_own_bits_change() {
    for field in values() {
        let own = (field.with_raw(0, u64::MAX)) | field.valid.map_or(0, |bit| 1 << bit);
        for value in [Real::NEG_INFINITY, 0.0, 1.0, 77.7, Real::INFINITY, Real::NAN] {
            assert_eq!(field.with(!own, value) | own, u64::MAX, "{}: {value}", field.name);
            assert_eq!(field.with(0, value) & !own, 0, "{}: {value}", field.name);
            let (fresh, over) = (field.with(0, value), field.with(u64::MAX, value));
            assert_eq!(field.raw_of(over), field.raw_of(fresh), "{}: over another", field.name);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Half a step where it is rounded to the nearest, a step and never above for limits; and what
    /// single precision adds.
    #[test]
    fn a_value_comes_back_within_a_step(share in 0.0 as Real..=1.0) {
        for field in values() {
            let (low, high) = field.range();
            let span = (high as Real - low as Real) * field.factor;
            let value = low as Real * field.factor + field.offset + share * span;
            let back = field.of(field.with(0, value));
            let fine = 4.0 * Real::EPSILON * (value.abs() + field.offset.abs());
            match field.rounding {
                Rounding::Nearest => {
                    prop_assert!(
                        (back - value).abs() <= 0.5 * field.factor + fine,
                        "{}: {} became {}", field.name, value, back
                    );
                }
                Rounding::Down => {
                    prop_assert!(
                        back <= value && value - back <= field.factor + fine,
                        "{}: {} became {}", field.name, value, back
                    );
                }
            }
        }
    }
}
