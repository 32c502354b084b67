//! Every history against a plain statement of the rule.

extern crate std;

use std::vec::Vec;

use crate::protect::{Debounce, DebounceState, Sample};

const SAMPLES: [Sample; 4] = [Sample::Good, Sample::Near, Sample::Bad, Sample::Missing];

/// The rule, read off a whole history: whether it is tripped at its end.
fn tripped(rule: &Debounce, history: &[Sample]) -> bool {
    let (mut net, mut last_bad, mut tripped) = (0_i32, false, false);
    let mut active_for: Option<u16> = None;
    let mut good = 0;
    for sample in history {
        match sample {
            Sample::Bad => (net, last_bad, good) = (net + 1, true, 0),
            Sample::Missing => {
                let as_bad = i32::from(rule.missing);
                net += if last_bad { as_bad.max(1) } else { as_bad };
                good = 0;
            }
            Sample::Near => (net, last_bad, good) = (net - 1, false, 0),
            Sample::Good => (net, last_bad, good) = (net - 1, false, good + 1),
        }
        net = net.clamp(0, i32::from(rule.count));
        let healed = net == 0 && (!tripped || good >= rule.heal);
        active_for = match active_for {
            Some(_) if healed => None,
            Some(judgements) => Some(judgements + 1),
            None if net == i32::from(rule.count) => Some(0),
            None => None,
        };
        tripped = match active_for {
            None => false,
            Some(judgements) => tripped || judgements >= rule.delay,
        };
    }
    tripped
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn every_history_is_judged_by_the_rule() {
    let mut compared = 0_u32;
    for (count, delay, heal, missing) in
        [(1, 0, 1, 0), (2, 0, 2, 0), (2, 0, 2, 1), (3, 2, 2, 1), (3, 1, 3, 2), (2, 3, 1, 0)]
    {
        let rule = Debounce { count, delay, heal, missing };
        for number in 0..4_u32.pow(8) {
            let history: Vec<_> =
                (0..8).map(|place| SAMPLES[(number >> (2 * place) & 3) as usize]).collect();
            let mut state = DebounceState::NEW;
            for (i, sample) in history.iter().enumerate() {
                let now = rule.step(&mut state, *sample);
                assert_eq!(now, tripped(&rule, &history[..=i]), "{rule:?} {:?}", &history[..=i]);
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 6 * 8 * 4_u32.pow(8));
}

#[test]
fn trips_at_the_judgement_that_is_stated() {
    for count in 1..=5 {
        for delay in 0..=4 {
            let rule = Debounce { count, delay, heal: 3, missing: 0 };
            let mut state = DebounceState::default();
            let at = (1..20).find(|_| rule.step(&mut state, Sample::Bad));
            assert_eq!(at, Some(count + delay));
            assert!(!state.quiet());
        }
    }
}

/// A missing sample counts as the stated number of bad ones; without a number it repeats the last.
#[test]
fn missing_samples_count_as_stated() {
    let after = |missing, first| {
        let rule = Debounce { count: 12, delay: 0, heal: 1, missing };
        let mut state = DebounceState::NEW;
        rule.step(&mut state, first);
        (1..100).find(|_| rule.step(&mut state, Sample::Missing))
    };
    assert_eq!(after(0, Sample::Good), None);
    assert_eq!(after(0, Sample::Bad), Some(11));
    for missing in 1..=12 {
        let samples = 12_u32.div_ceil(u32::from(missing));
        assert_eq!(after(missing, Sample::Good), Some(samples));
    }
}
