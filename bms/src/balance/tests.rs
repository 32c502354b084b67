use super::*;
use crate::must;

const PARAMS: BalancerParams = BalancerParams {
    bleed_ohm: 33.0,
    capacity_ah: 5.0,
    hysteresis: 0.005,
    sds: 3.0,
    hysteresis_v: 0.01,
    least_v: 3.0,
    board_max_c: 80.0,
    channels: 2,
    bleed_s: 0.9,
    pause_s: 0.1,
};
const DT: Dt = must!(Dt::from_s(0.01));
const BALANCER: Balancer = must!(Balancer::new(PARAMS, DT));
const FRAME: usize = 100;

const fn new() -> BalancerState<8> {
    BalancerState::NEW
}

#[derive(Clone, Copy)]
struct Pack {
    soc: [(Real, Real); 8],
    cell_v: [Real; 8],
    rested: bool,
    board_c: Real,
    allowed: bool,
}

const EVEN: Pack =
    Pack { soc: [(0.6, 0.002); 8], cell_v: [3.7; 8], rested: false, board_c: 30.0, allowed: true };

/// What is bled of each in so many frames \[A·s\]; nobody is bled beside another, nor more than two
/// at once, nor in a pause.
fn bled(state: &mut BalancerState<8>, pack: &Pack, frames: usize) -> [Real; 8] {
    let Pack { soc, cell_v, rested, board_c, allowed } = pack;
    let (rested, board_c, allowed) = (*rested, *board_c, *allowed);
    let input = BalancerInput { soc, cell_v, rested, board_c, allowed };
    let mut sum_as = [Accum::new(0.0); 8];
    for step in 0..frames * FRAME {
        let step_as = BALANCER.step(state, &input);
        let on = state.bleeding();
        assert!(!on.windows(2).any(|pair| pair == [true, true]), "neighbours");
        assert!(on.iter().filter(|on| **on).count() <= 2, "too many");
        assert!(step % FRAME < 90 || !on.contains(&true), "in the pause");
        for (cell, (sum, one)) in sum_as.iter_mut().zip(step_as).enumerate() {
            sum.add(one);
            assert!(one == 0.0 || state.bleeding()[cell]);
        }
    }
    sum_as.map(Accum::get)
}

#[test]
fn only_what_is_surely_above_is_bled() {
    let mut pack = EVEN;
    pack.soc[3] = (0.63, 0.002);
    let sum_as = bled(&mut new(), &pack, 10);
    // Every second frame: five of ten, 0.9 s each.
    let expected_as = 5.0 * 0.9 * 3.7 / 33.0;
    assert!((sum_as[3] - expected_as).abs() < 0.01 * expected_as, "{sum_as:?}");
    assert_eq!(sum_as.iter().filter(|sum| **sum > 0.0).count(), 1);
    // 3 % apart, and each may be off by 2 %: nobody knows.
    pack.soc = pack.soc.map(|(soc, _)| (soc, 0.02));
    assert_eq!(bled(&mut new(), &pack, 10), [0.0; 8]);
    pack.soc[3] = (Real::NAN, 0.002);
    assert_eq!(bled(&mut new(), &pack, 10), [0.0; 8]);
    // Within the hysteresis.
    let mut pack = EVEN;
    pack.soc[3] = (0.616, 0.002);
    assert_eq!(bled(&mut new(), &pack, 10), [0.0; 8]);
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn bleeding_ends_when_the_charge_is_out() {
    let mut pack = EVEN;
    pack.soc[4] = (0.63, 0.0);
    pack.soc[0] = (0.6, 0.0);
    let mut state = BalancerState::NEW;
    bled(&mut state, &pack, 1);
    bled(&mut state, &pack, 1);
    let left_as = state.to_bleed_as(4).unwrap();
    assert!(left_as > 0.0 && left_as <= 3600.0 * 5.0 * 0.03);
    // Believed even from now on, the rest that is known is still taken out, and no more.
    let sum_as = bled(&mut state, &EVEN, 12_000)[4];
    assert!((sum_as - left_as).abs() < 0.01, "{sum_as} of {left_as}");
    let over_as = -state.to_bleed_as(4).unwrap();
    assert!((0.0..0.01).contains(&over_as), "{over_as} more than was to be");
    assert_eq!(state.to_bleed_as(8), None);
}

#[test]
fn by_voltage_at_rest_alone() {
    let mut pack = EVEN;
    pack.soc = [(0.6, 0.1); 8];
    pack.cell_v[5] = 3.72;
    assert_eq!(bled(&mut new(), &pack, 10), [0.0; 8]);
    pack.rested = true;
    let mut state = BalancerState::NEW;
    let sum_as = bled(&mut state, &pack, 10);
    assert!(sum_as[5] > 0.4 && sum_as.iter().filter(|sum| **sum > 0.0).count() == 1);
    // Even again.
    pack.cell_v[5] = 3.709;
    bled(&mut state, &pack, 1);
    assert_eq!(bled(&mut state, &pack, 4), [0.0; 8]);
}

#[test]
fn the_fullest_first_and_turn_by_turn() {
    let mut pack = EVEN;
    for (soc, above) in pack.soc.iter_mut().zip([0.0, 0.05, 0.03, 0.04, 0.05, 0.02, 0.04, 0.03]) {
        soc.0 += above;
    }
    let mut state = BalancerState::NEW;
    let first = bled(&mut state, &pack, 1).map(|sum| sum > 0.0);
    assert_eq!(first, [false, true, false, true, false, false, false, false]);
    let second = bled(&mut state, &pack, 1).map(|sum| sum > 0.0);
    assert_eq!(second, [false, false, false, false, true, false, true, false]);
}

#[test]
fn what_forbids_bleeding() {
    let mut pack = EVEN;
    pack.soc[3] = (0.63, 0.002);
    for (forbidden, why) in [
        (Pack { allowed: false, ..pack }, "not allowed"),
        (Pack { board_c: 80.1, ..pack }, "hot"),
        (Pack { board_c: Real::NAN, ..pack }, "not known how hot"),
        (Pack { cell_v: [2.99; 8], ..pack }, "low"),
        (Pack { cell_v: [Real::NAN; 8], ..pack }, "not measured"),
    ] {
        let mut state = BalancerState::NEW;
        bled(&mut state, &pack, 1);
        assert_eq!(bled(&mut state, &forbidden, 4), [0.0; 8], "{why}");
        assert!(!state.bleeding().contains(&true));
    }
}

#[test]
fn a_neighbour_of_a_bled_cell_is_not_to_be_read() {
    let mut pack = EVEN;
    pack.soc[3] = (0.63, 0.002);
    let input = BalancerInput {
        soc: &pack.soc,
        cell_v: &pack.cell_v,
        rested: false,
        board_c: 30.0,
        allowed: true,
    };
    let mut state = BalancerState::NEW;
    BALANCER.step(&mut state, &input);
    let disturbed = [0, 1, 2, 3, 4, 5, 6, 7].map(|cell| state.disturbs(cell));
    assert_eq!(disturbed, [false, false, true, true, true, false, false, false]);
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    let refused = |params| Balancer::new(params, DT).expect_err("refused").field();
    for bad in [Real::NAN, Real::NEG_INFINITY] {
        for (params, field) in [
            (BalancerParams { bleed_ohm: bad, ..PARAMS }, "balancer.bleed_ohm"),
            (BalancerParams { capacity_ah: bad, ..PARAMS }, "balancer.capacity_ah"),
            (BalancerParams { hysteresis: bad, ..PARAMS }, "balancer.hysteresis"),
            (BalancerParams { sds: bad, ..PARAMS }, "balancer.sds"),
            (BalancerParams { hysteresis_v: bad, ..PARAMS }, "balancer.hysteresis_v"),
            (BalancerParams { least_v: bad, ..PARAMS }, "balancer.least_v"),
            (BalancerParams { board_max_c: bad, ..PARAMS }, "balancer.board_max_c"),
            (BalancerParams { bleed_s: bad, ..PARAMS }, "balancer.bleed_s"),
            (BalancerParams { pause_s: bad, ..PARAMS }, "balancer.pause_s"),
        ] {
            assert_eq!(refused(params), field);
        }
    }
    for (params, field) in [
        (BalancerParams { channels: 0, ..PARAMS }, "balancer.channels"),
        (BalancerParams { bleed_s: 0.01, ..PARAMS }, "balancer.bleed_s"),
        (BalancerParams { pause_s: 0.01, ..PARAMS }, "balancer.pause_s"),
        (BalancerParams { bleed_s: 601.0, ..PARAMS }, "balancer.bleed_s"),
    ] {
        assert_eq!(refused(params), field);
    }
}
