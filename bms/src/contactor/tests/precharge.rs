//! Precharges of a simulated link, with noise.

extern crate std;

use std::println;

use plant_core::ParamError;

use crate::contactor::{
    CurrentClass, LinkClass, LinkTrend, LinkTrendParams, LinkTrendState, PrechargeInput,
    PrechargeParams, PrechargeWatch, Watch, current_class,
};
use crate::{Dt, Real, must};

/// As of a Hyundai Kona: 121 to 354 of 355 V with a time constant of 38.4 ms; a resistor of 40 Ω is
/// assumed.
const PARAMS: PrechargeParams = PrechargeParams {
    resistor_ohm: 40.0,
    link_f: 0.00096,
    tau_factor: 1.5,
    noise_v: 1.5,
    noise_a: 0.05,
    done_v: 4.0,
    count: 5,
    lag_s: 0.01,
    budget_j: 120.0,
    short_j: 60.0,
    cooling_s: 30.0,
};
const DT: Dt = must!(Dt::from_s(0.001));
const WATCH: PrechargeWatch = must!(PrechargeWatch::new(PARAMS, DT));

/// What is charged.
#[derive(Clone, Copy)]
struct Link {
    ohm: Real,
    farad: Real,
    start_v: Real,
    load_w: Real,
    short: bool,
    open: bool,
}

const KONA: Link =
    Link { ohm: 40.0, farad: 0.00096, start_v: 121.0, load_w: 0.0, short: false, open: false };

/// The verdict, when [ms], the heat [J], and the heat reckoned.
fn charge(link: Link) -> (Watch, u32, Real, Real) {
    let pack_v = 355.0;
    let mut link_v = link.start_v;
    let mut state = WATCH.cold();
    WATCH.begin(&mut state, pack_v, link_v);
    let mut seed = 1_u32;
    let mut noise = |amplitude: Real| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        amplitude * ((seed >> 8) as Real / 8_388_608.0 - 1.0)
    };
    let mut heat_j = 0.0;
    for ms in 1..=3000 {
        // It bounces for 5 ms.
        let flows = ms > 5 && !link.open;
        let current_a = if flows { (pack_v - link_v) / link.ohm } else { 0.0 };
        let load_a = if link_v > 50.0 { link.load_w / link_v } else { 0.0 };
        link_v = if link.short {
            0.1 * current_a
        } else {
            link_v + (current_a - load_a) * 0.001 / link.farad
        };
        heat_j += current_a * current_a * link.ohm * 0.001;
        let input = PrechargeInput {
            pack_v: pack_v + noise(0.5),
            link_v: link_v + noise(0.5),
            current_a: current_a + noise(0.02),
        };
        let verdict = WATCH.step(&mut state, input);
        if verdict != Watch::Wait {
            return (verdict, ms, heat_j, state.heat_j());
        }
    }
    panic!("no verdict in 3 s");
}

#[test]
fn a_precharge_is_judged_against_the_expected_exponential() {
    let empty = Link { start_v: 0.0, ..KONA };
    // Expected verdict, within so many milliseconds and joules.
    for (name, link, verdict, within_ms, within_j) in [
        ("Kona, from 121 V", KONA, Watch::Done, 340, 27.0),
        ("from 0 V", empty, Watch::Done, 340, 62.0),
        ("charged already", Link { start_v: 354.0, ..KONA }, Watch::Done, 20, 0.1),
        (
            "a quarter more resistance, 15 % more capacitance",
            Link { ohm: 50.0, farad: 0.0011, ..empty },
            Watch::Done,
            400,
            71.0,
        ),
        ("short", Link { short: true, ..empty }, Watch::Short, 40, 80.0),
        ("resistor open", Link { open: true, ..empty }, Watch::Open, 40, 0.1),
        ("resistor open at 121 V", Link { open: true, ..KONA }, Watch::Open, 40, 0.1),
        ("three times the capacitance", Link { farad: 0.00288, ..empty }, Watch::Slow, 60, 90.0),
        ("a load of 200 W", Link { load_w: 200.0, ..empty }, Watch::Slow, 340, 100.0),
    ] {
        let (told, ms, heat_j, reckoned_j) = charge(link);
        println!("{name}: {told:?} after {ms} ms, {heat_j:.1} J, reckoned {reckoned_j:.1} J");
        assert_eq!(told, verdict, "{name}");
        assert!(ms <= within_ms && heat_j <= within_j, "{name}: {ms} ms, {heat_j} J");
        // A resistor that is not as declared warms up as the ratio says.
        let share = PARAMS.resistor_ohm / link.ohm;
        assert!((reckoned_j - share * heat_j).abs() < 0.02 * heat_j + 0.1, "{name}");
    }
}

/// Missing values are nothing to go on by: out, and not by "done".
#[test]
fn missing_values_never_count_as_charged() {
    for (pack_v, link_v, current_a) in [
        (Real::NAN, 0.0, 1.0),
        (355.0, Real::NAN, 1.0),
        (355.0, 354.0, Real::NAN),
        (Real::NAN, Real::NAN, Real::NAN),
    ] {
        let mut state = WATCH.cold();
        WATCH.begin(&mut state, 355.0, 0.0);
        let mut last = Watch::Wait;
        for _ in 0..1000 {
            last = WATCH.step(&mut state, PrechargeInput { pack_v, link_v, current_a });
            assert_ne!(last, Watch::Done);
        }
        assert!(last != Watch::Wait || link_v == 354.0);
        assert!(state.heat_j().is_finite());
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn the_resistor_must_be_able_to_take_a_short() {
    let mut state = WATCH.cold();
    assert!(WATCH.ready(&state));
    // A short that goes on for as long as it may.
    let short = PrechargeInput { pack_v: 355.0, link_v: 0.0, current_a: 8.875 };
    for tries in 1..=2 {
        WATCH.begin(&mut state, 355.0, 0.0);
        while WATCH.step(&mut state, short) == Watch::Wait {}
        assert_eq!(WATCH.ready(&state), tries == 1, "{}", state.heat_j());
    }
    // Without a current, by the largest that can flow.
    let mut blind = WATCH.cold();
    WATCH.begin(&mut blind, 355.0, 0.0);
    for _ in 0..10 {
        WATCH.step(&mut blind, PrechargeInput { current_a: Real::NAN, ..short });
    }
    assert!((blind.heat_j() - 10.0 * 0.001 * 355.0 * 355.0 / 40.0).abs() < 0.1);
    // It cools down with its time constant, over a power cut too.
    let mut state = WATCH.warmed(150.0);
    assert!(!WATCH.ready(&state));
    for _ in 0..30_000 {
        WATCH.cool(&mut state);
    }
    assert!(
        (f64::from(state.heat_j()) - 150.0 / core::f64::consts::E).abs() < 0.5,
        "{}",
        state.heat_j()
    );
    assert!(WATCH.ready(&state));
    assert!(!WATCH.ready(&WATCH.warmed(Real::NAN)));
    assert_eq!(WATCH.warmed(-1.0), WATCH.cold());
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    let refused = |params| PrechargeWatch::new(params, DT).expect_err("refused").field();
    for bad in [Real::NAN, -1.0] {
        for (params, field) in [
            (PrechargeParams { resistor_ohm: bad, ..PARAMS }, "precharge.resistor_ohm"),
            (PrechargeParams { link_f: bad, ..PARAMS }, "precharge.link_f"),
            (PrechargeParams { tau_factor: bad, ..PARAMS }, "precharge.tau_factor"),
            (PrechargeParams { noise_v: bad, ..PARAMS }, "precharge.noise_v"),
            (PrechargeParams { noise_a: bad, ..PARAMS }, "precharge.noise_a"),
            (PrechargeParams { done_v: bad, ..PARAMS }, "precharge.done_v"),
            (PrechargeParams { lag_s: bad, ..PARAMS }, "precharge.lag_s"),
            (PrechargeParams { budget_j: bad, ..PARAMS }, "precharge.budget_j"),
            (PrechargeParams { short_j: bad, ..PARAMS }, "precharge.short_j"),
            (PrechargeParams { cooling_s: bad, ..PARAMS }, "precharge.cooling_s"),
        ] {
            assert_eq!(refused(params), field);
        }
    }
    for (params, field) in [
        (PrechargeParams { link_f: 0.00004, ..PARAMS }, "precharge.link_f"),
        (PrechargeParams { tau_factor: 1.0, ..PARAMS }, "precharge.tau_factor"),
        (PrechargeParams { count: 1, ..PARAMS }, "precharge.count"),
        (PrechargeParams { count: 101, ..PARAMS }, "precharge.count"),
        (PrechargeParams { lag_s: 66.0, ..PARAMS }, "precharge.lag_s"),
        (PrechargeParams { budget_j: 60.0, ..PARAMS }, "precharge.budget_j"),
    ] {
        assert_eq!(refused(params), field);
    }
}

#[test]
fn currents_and_links_have_classes() {
    for (current_a, class) in [
        (Real::NAN, CurrentClass::Unknown),
        (Real::INFINITY, CurrentClass::Unknown),
        (200.0, CurrentClass::Breakable),
        (-200.0, CurrentClass::Breakable),
        (200.1, CurrentClass::High),
        (-200.1, CurrentClass::High),
    ] {
        assert_eq!(current_class(current_a, 200.0), class);
    }
    let params = LinkTrendParams { time_s: 0.05, noise_v: 1.0 };
    let trend = LinkTrend::new(params, DT).unwrap();
    let mut state = LinkTrendState::NEW;
    assert_eq!(trend.of(&mut state, 300.0), LinkClass::Steady);
    assert_eq!(trend.of(&mut state, 300.9), LinkClass::Steady);
    let slope = |state: &mut LinkTrendState, v_per_s: Real| {
        let mut class = LinkClass::Unknown;
        for ms in 0..300 {
            class = trend.of(state, 300.0 + v_per_s * 0.001 * ms as Real);
        }
        class
    };
    assert_eq!(slope(&mut state, 30.0), LinkClass::Rising);
    assert_eq!(slope(&mut state, -30.0), LinkClass::Falling);
    assert_eq!(slope(&mut state, 10.0), LinkClass::Steady);
    assert_eq!(trend.of(&mut state, Real::NAN), LinkClass::Unknown);
    assert_eq!(trend.of(&mut state, 0.0), LinkClass::Steady, "nothing to compare with");
    let bad = LinkTrendParams { time_s: 0.0, ..params };
    assert_eq!(LinkTrend::new(bad, DT), Err(ParamError::NotPositive("link_trend.time_s")));
    let bad = LinkTrendParams { noise_v: -1.0, ..params };
    assert_eq!(LinkTrend::new(bad, DT), Err(ParamError::Negative("link_trend.noise_v")));
}

/// Verdicts at their limits: after the lag and so many samples, by so much.
#[test]
fn verdicts_come_at_their_limits() {
    let (lag, count) = (10, u32::from(PARAMS.count));
    let ohm = PARAMS.resistor_ohm;
    let until = |pack_v: Real, link_v: Real, current_a: Real| {
        let mut state = WATCH.cold();
        WATCH.begin(&mut state, 355.0, 0.0);
        (1..1000).find_map(|step| {
            match WATCH.step(&mut state, PrechargeInput { pack_v, link_v, current_a }) {
                Watch::Wait => None,
                watch => Some((watch, step)),
            }
        })
    };
    // The lag is over, then all samples are good; the last bit of the voltage and the current.
    let done_v = PARAMS.done_v;
    let still_a = done_v / ohm + PARAMS.noise_a;
    assert_eq!(until(355.0, 355.0 - done_v, 0.0), Some((Watch::Done, lag + count)));
    assert_eq!(until(355.0, 355.0 + done_v, 0.0), Some((Watch::Done, lag + count)));
    assert_eq!(until(355.0, 355.0, 0.999 * still_a), Some((Watch::Done, lag + count)));
    assert_eq!(until(355.0, 355.0, -0.999 * still_a), Some((Watch::Done, lag + count)));
    assert_eq!(until(355.0, 355.0, 1.001 * still_a), None);
    assert_ne!(until(355.0, 354.9 - done_v, 0.0).map(|(watch, _)| watch), Some(Watch::Done));
    // A link that has risen by a twentieth is no short; a current of 0.3 of the expected one flows.
    let last = |link_v: Real, share: Real, off_a: Real| {
        let current_a = share * (355.0 - link_v) / ohm + off_a;
        until(355.0, link_v, current_a).unwrap().0
    };
    assert_eq!(last(0.049 * 355.0, 1.0, 0.0), Watch::Short);
    assert_eq!(last(0.051 * 355.0, 1.0, 0.0), Watch::Slow);
    assert_eq!(last(0.0, 0.3, 0.9 * PARAMS.noise_a), Watch::Open);
    assert_eq!(last(0.0, 0.3, 1.1 * PARAMS.noise_a), Watch::Short);
    assert_eq!(last(0.0, -0.31, -PARAMS.noise_a), Watch::Short, "whatever its sign");
    // One good sample, or one bad one, begins anew.
    let mut state = WATCH.cold();
    WATCH.begin(&mut state, 355.0, 0.0);
    for step in 0..10 * (lag + count) {
        let charged = step % count != 0;
        let link_v = if charged { 355.0 } else { 0.0 };
        let input = PrechargeInput { pack_v: 355.0, link_v, current_a: 0.0 };
        assert_eq!(WATCH.step(&mut state, input), Watch::Wait, "{step}");
    }
}
