//! Closed forms, balances, faults.

use super::*;

const PARAMS: LinkParams = LinkParams {
    capacitance_f: 0.00096,
    bleeder_ohm: 10_000.0,
    precharge_ohm: 40.0,
    contact_ohm: 0.001,
    fuse_rated_a: 300.0,
    fuse_melting_a2s: 1e5,
};
const BATTERY: Source = Source { emf_v: 355.0, resistance_ohm: 0.1 };
const CLOSED: LinkInput = LinkInput {
    source: BATTERY,
    minus: true,
    precharge: false,
    plus: true,
    load_a: 0.0,
    short_ohm: Real::INFINITY,
};
const PRECHARGE: LinkInput = LinkInput { precharge: true, plus: false, ..CLOSED };
const OPEN: LinkInput = LinkInput { minus: false, plus: false, ..CLOSED };

fn link(dt_s: Real) -> Link {
    Link::new(PARAMS, Dt::from_s(dt_s).unwrap()).unwrap()
}

/// Voltage after a time of precharge from 121 V \[V\].
fn precharged(dt_s: Real, time_s: Real) -> Real {
    let link = link(dt_s);
    let mut state = LinkState::charged_to(121.0);
    for _ in 0..(time_s / dt_s + 0.5) as u32 {
        link.step(&mut state, PRECHARGE);
    }
    state.voltage_v.get()
}

#[test]
fn precharge_is_the_closed_form_to_first_order() {
    let (all_ohm, time_s) = (40.101_f64, 0.04);
    let rest_s = 1.0 / all_ohm + 1e-4;
    let end_v = 355.0 / all_ohm / rest_s;
    let exact = end_v + (121.0 - end_v) * (-time_s * rest_s / 0.00096_f64).exp();
    let error = |dt_s: Real| (f64::from(precharged(dt_s, 0.04)) - exact).abs();
    let (coarse, fine) = (error(1e-3), error(1e-4));
    assert!(coarse < 2.0 && (8.0..12.0).contains(&(coarse / fine)), "{coarse} {fine}");
}

#[test]
fn charge_and_energy_balance() {
    for dt_s in [1e-5, 1e-3, 0.1] {
        let link = link(dt_s);
        let mut state = LinkState::charged_to(100.0);
        for n in 0..200_u16 {
            let load_a = Real::from(n % 40) - 10.0;
            let input = LinkInput { load_a, plus: n > 100, precharge: true, ..CLOSED };
            let before_v = state.voltage_v.get();
            let out = link.step(&mut state, input);
            assert!(!out.rejected);
            let stored_a = PARAMS.capacitance_f * (out.voltage_v - before_v) / dt_s;
            let flows_a = out.battery_a - out.load_a - out.leak_a;
            let scale_a = 10.0 + out.battery_a.abs() + PARAMS.capacitance_f * 355.0 / dt_s;
            assert!(
                (stored_a - flows_a).abs() < 1e-6 * scale_a,
                "{dt_s} {n}: {stored_a} {flows_a}"
            );
            // What the resistor turns into heat is no more than what the battery loses on the way.
            let lost_w = out.battery_a * (BATTERY.emf_v - out.voltage_v);
            assert!(out.precharge_w >= 0.0 && out.precharge_w <= lost_w * 1.0001 + 1e-3);
        }
    }
}

#[test]
fn an_open_link_falls_and_gives_no_more_than_it_has() {
    let link = link(1e-3);
    let mut state = LinkState::charged_to(355.0);
    for _ in 0..9600 {
        link.step(&mut state, OPEN);
    }
    // One time constant of 9.6 s.
    assert!((state.voltage_v.get() / 355.0 - 0.3679).abs() < 1e-3);
    let out = link.step(&mut state, LinkInput { load_a: 1e4, ..OPEN });
    assert_eq!(out.battery_a, 0.0);
    assert!(out.load_a < 1e4 && out.voltage_v.abs() < 1e-3, "{out:?}");
}

#[test]
fn a_short_melts_the_fuse() {
    let link = link(1e-4);
    let mut state = LinkState::charged_to(355.0);
    let short = LinkInput { short_ohm: 0.1, ..CLOSED };
    let mut through_a = 0.0;
    let melts = (1..10_000).find(|_| {
        let out = link.step(&mut state, short);
        through_a = max(out.battery_a, through_a);
        out.fuse_blown
    });
    // 355 V over 0.2 Ω; 1e5 A²·s over the square of it is some 30 ms.
    assert!((1700.0..1800.0).contains(&through_a), "{through_a}");
    assert!(melts.is_some_and(|steps| (300..400).contains(&steps)), "{melts:?}");
    assert_eq!(link.step(&mut state, short).battery_a, 0.0);
    let mut state = LinkState::charged_to(355.0);
    for _ in 0..50_000 {
        link.step(&mut state, LinkInput { load_a: 299.0, ..CLOSED });
    }
    assert!(!state.fuse_blown && state.fuse_a2s < 1.0, "{state:?}");
}

#[test]
fn what_is_no_number_changes_nothing() {
    let link = link(1e-3);
    let before = LinkState::charged_to(300.0);
    for bad in [
        LinkInput { load_a: Real::NAN, ..CLOSED },
        LinkInput { load_a: Real::NEG_INFINITY, ..CLOSED },
        LinkInput { source: Source { emf_v: Real::NAN, ..BATTERY }, ..CLOSED },
        LinkInput { short_ohm: -1.0, ..CLOSED },
        LinkInput { short_ohm: Real::NAN, ..CLOSED },
    ] {
        let mut state = before;
        assert!(link.step(&mut state, bad).rejected, "{bad:?}");
        assert_eq!(state, before, "{bad:?}");
    }
    let refused = |params| Link::new(params, Dt::from_s(1e-3).unwrap()).unwrap_err().field();
    assert_eq!(refused(LinkParams { capacitance_f: 0.0, ..PARAMS }), "link.capacitance_f");
    assert_eq!(refused(LinkParams { bleeder_ohm: 0.0, ..PARAMS }), "link.bleeder_ohm");
    assert_eq!(refused(LinkParams { precharge_ohm: -1.0, ..PARAMS }), "link.precharge_ohm");
    assert_eq!(refused(LinkParams { contact_ohm: 0.0, ..PARAMS }), "link.contact_ohm");
    assert_eq!(refused(LinkParams { fuse_rated_a: -1.0, ..PARAMS }), "link.fuse_rated_a");
    assert_eq!(
        refused(LinkParams { fuse_melting_a2s: Real::NAN, ..PARAMS }),
        "link.fuse_melting_a2s"
    );
}

#[test]
fn a_contactor_is_late_bounces_and_fails() {
    let dt = Dt::from_s(1e-3).unwrap();
    let main = Contactor::new(ContactorParams::USUAL, dt).unwrap();
    let mut state = ContactorState::default();
    let mut step = |coil, fault| main.step(&mut state, ContactorInput { coil, fault });
    let none = ContactorFault::None;
    let conducting = |out: ContactorOutput| out.conducts;
    let closing: [bool; 30] = core::array::from_fn(|_| conducting(step(true, none)));
    assert!(closing[..20].iter().all(|on| !on));
    assert_eq!(&closing[20..27], [true, false, true, false, true, true, true]);
    assert!(closing[27..].iter().all(|on| *on));
    assert!(!step(true, ContactorFault::ShowsOpen).shows_closed);
    assert!(conducting(step(true, ContactorFault::ShowsOpen)));
    let opening: [bool; 12] = core::array::from_fn(|_| conducting(step(false, none)));
    assert!(opening[..10].iter().all(|on| *on) && !opening[10] && !opening[11]);
    assert!(step(false, ContactorFault::Welded).conducts);
    assert!(!step(false, none).conducts, "it was welded only in between");
    assert!(step(false, ContactorFault::ShowsClosed).shows_closed);
    for _ in 0..50 {
        assert!(!step(true, ContactorFault::StuckOpen).conducts);
    }
    let slow = ContactorParams { close_s: 100.0, ..ContactorParams::USUAL };
    assert_eq!(Contactor::new(slow, dt).unwrap_err().field(), "contactor.close_s");
}
