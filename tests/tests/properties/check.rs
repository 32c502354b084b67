//! Inputs of any bits, and what every model must keep under them.

use std::cell::Cell;
use std::fmt::Debug;

use plant_core::Real;
use plant_core::num::{LARGEST, sane};
use proptest::prelude::*;
use proptest::test_runner::{TestCaseError, TestRunner};

/// The settings of a property that runs `of_256` cases where the default is 256.
pub fn cases(of_256: u32) -> ProptestConfig {
    let default = ProptestConfig::default();
    let cases = (default.cases * of_256).div_ceil(256);
    ProptestConfig { cases, max_global_rejects: 4 * cases, failure_persistence: None, ..default }
}

/// Evenly spread over the decades of `from..to`.
pub fn log(from: f64, to: f64) -> impl Strategy<Value = Real> {
    (from.ln()..to.ln()).prop_map(|x| x.exp() as Real)
}

/// Zero, or over five decades up to `largest`.
pub fn positive(largest: f64) -> BoxedStrategy<Real> {
    prop_oneof![1 => Just(0.0), 8 => log(1e-5 * largest, largest)].boxed()
}

/// The same, of either sign.
pub fn signed(largest: f64) -> BoxedStrategy<Real> {
    (positive(largest), any::<bool>()).prop_map(|(x, minus)| if minus { -x } else { x }).boxed()
}

/// Any bit pattern, the awkward ones often.
pub fn any_bits() -> impl Strategy<Value = Real> {
    let awkward = [
        0.0,
        LARGEST,
        LARGEST * 1.000_001,
        Real::NAN,
        Real::INFINITY,
        Real::MAX,
        Real::MIN_POSITIVE,
        Real::from_bits(1),
    ];
    prop_oneof![
        4 => any::<u32>().prop_map(Real::from_bits),
        1 => (prop::sample::select(awkward.to_vec()), any::<bool>())
            .prop_map(|(x, minus)| if minus { -x } else { x }),
        1 => signed(f64::from(LARGEST)),
    ]
}

/// Up to 20 inputs of `N` fields: most of them plausible, some with any bits in one field or
/// another, some with any bits in all.
pub fn inputs<const N: usize>(
    plausible: [BoxedStrategy<Real>; N],
) -> impl Strategy<Value = Vec<[Real; N]>> {
    let bits = prop::collection::vec(any_bits(), N);
    let one = (plausible, bits, 0..10, 0..N).prop_map(|(mut fields, bits, kind, which)| {
        for (i, (field, bits)) in fields.iter_mut().zip(bits).enumerate() {
            if kind == 9 || (kind > 5 && i == which) {
                *field = bits;
            }
        }
        fields
    });
    prop::collection::vec(one, 1..=20)
}

/// How many steps were accepted and how many rejected.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    accepted: u32,
    rejected: u32,
}

/// Whether every number in what `{:?}` shows of `value`, private fields included, is finite.
pub fn all_finite(value: &str) -> bool {
    !value
        .split(|c: char| !(c.is_alphanumeric() || c == '_'))
        .any(|word| word == "NaN" || word == "inf")
}

/// Steps through `inputs`: after every step the state and the output are finite, a step that is
/// rejected leaves the state as it was, bit for bit, and an input that is not sane is rejected.
///
/// `step` also says whether it rejected. Bits are compared as `{:?}` shows them, which tells any
/// two numbers apart, −0 and 0 too.
pub fn keeps<S: Debug, O: Debug, const N: usize>(
    mut state: S,
    inputs: &[[Real; N]],
    mut step: impl FnMut(&mut S, [Real; N]) -> (O, bool),
) -> Result<Tally, TestCaseError> {
    let mut before = format!("{state:?}");
    stays_finite(&mut state, inputs, |state, input| {
        let (output, rejected) = step(state, input);
        let after = format!("{state:?}");
        if rejected {
            prop_assert_eq!(&after, &before, "{:?} was rejected but changed the state", input);
        } else {
            prop_assert!(input.iter().all(|x| sane(*x)), "{input:?} was accepted: {output:?}");
        }
        before = after;
        Ok((output, rejected))
    })
}

/// Steps through `inputs`: after every step the state and the output are finite.
pub fn stays_finite<S: Debug, O: Debug, const N: usize>(
    state: &mut S,
    inputs: &[[Real; N]],
    mut step: impl FnMut(&mut S, [Real; N]) -> Result<(O, bool), TestCaseError>,
) -> Result<Tally, TestCaseError> {
    let mut tally = Tally::default();
    for input in inputs {
        let (output, rejected) = step(state, *input)?;
        let (state, output) = (format!("{state:?}"), format!("{output:?}"));
        prop_assert!(all_finite(&state), "{input:?} made the state {state}");
        prop_assert!(all_finite(&output), "{input:?} made the output {output}");
        if rejected {
            tally.rejected += 1;
        } else {
            tally.accepted += 1;
        }
    }
    Ok(tally)
}

/// Runs a property that counts its steps, and makes sure that it saw both kinds often enough to
/// mean something.
pub fn check<S: Strategy>(
    of_256: u32,
    cases_of: S,
    property: impl Fn(S::Value) -> Result<Tally, TestCaseError>,
) {
    let seen = Cell::new(Tally::default());
    let counted = |case| {
        let tally = property(case)?;
        let all = seen.get();
        seen.set(Tally {
            accepted: all.accepted + tally.accepted,
            rejected: all.rejected + tally.rejected,
        });
        Ok(())
    };
    if let Err(failure) = TestRunner::new(cases(of_256)).run(&cases_of, counted) {
        panic!("{failure}");
    }
    let Tally { accepted, rejected } = seen.get();
    let both = accepted > rejected / 2 && rejected > accepted / 20;
    assert!(both || accepted + rejected < 1000, "{:?} is lopsided", seen.get());
}

#[test]
fn sees_what_is_not_finite() {
    assert!(all_finite("S { infinite: 1.0, nan: [0.5, -1e-12], last: Some(-0.0) }"));
    for bad in [Real::NAN, Real::INFINITY, -Real::INFINITY] {
        assert!(!all_finite(&format!("{:?}", Some([1.0, bad]))), "{bad}");
    }
}
