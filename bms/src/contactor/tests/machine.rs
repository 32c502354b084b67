//! Parameters, causes, and single ways through the machine.

use plant_core::ParamError;

use super::walk::SHORT;
use crate::contactor::{
    Cause, ContactorControl, ContactorInput, ContactorParams, ContactorState, CurrentClass,
    Feedback, LinkClass, Phase, Watch,
};
use crate::protect::{Clear, Contactor, Faults, Id, PrechargeFault, Trip};
use crate::{Dt, Real, must};

const DT: Dt = must!(Dt::from_s(0.001));

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    let usual = ContactorParams::USUAL;
    let refused = |params| ContactorControl::new(params, DT).expect_err("refused").field();
    for bad in [Real::NAN, 0.0, -1.0, 70.0] {
        for (params, field) in [
            (ContactorParams { start_limit_s: bad, ..usual }, "contactor.start_limit_s"),
            (ContactorParams { settle_s: bad, ..usual }, "contactor.settle_s"),
            (ContactorParams { close_limit_s: bad, ..usual }, "contactor.close_limit_s"),
            (ContactorParams { precharge_limit_s: bad, ..usual }, "contactor.precharge_limit_s"),
            (ContactorParams { open_limit_s: bad, ..usual }, "contactor.open_limit_s"),
            (ContactorParams { shed_limit_s: bad, ..usual }, "contactor.shed_limit_s"),
            (ContactorParams { hard_limit_s: bad, ..usual }, "contactor.hard_limit_s"),
            (ContactorParams { weld_limit_s: bad, ..usual }, "contactor.weld_limit_s"),
            (ContactorParams { cooldown_s: bad, ..usual }, "contactor.cooldown_s"),
        ] {
            assert_eq!(refused(params), field, "{bad}");
        }
    }
    let settle = ContactorParams { settle_s: 0.2, ..usual };
    assert_eq!(
        ContactorControl::new(settle, DT),
        Err(ParamError::NotAbove("contactor.close_limit_s"))
    );
    let hard = ContactorParams { hard_limit_s: 2.1, ..usual };
    assert_eq!(
        ContactorControl::new(hard, DT),
        Err(ParamError::NotAbove("contactor.shed_limit_s"))
    );
    for tries in [0, 11] {
        assert_eq!(refused(ContactorParams { tries, ..usual }), "contactor.tries");
    }
    let control = ContactorControl::new(usual, DT).unwrap();
    assert_eq!((control.settle, control.hard, control.shed), (50, 50, 2000));
}

#[test]
fn causes_have_numbers_and_rows() {
    for (code, cause) in Cause::ALL.into_iter().enumerate() {
        assert_eq!(usize::from(cause.code()), code);
        assert_eq!(Cause::at(cause.code()), Some(cause));
    }
    assert_eq!(Cause::at(15), None);
    let (open, closed) = (Feedback::Open, Feedback::Closed);
    let mixed = [closed, closed, open];
    for (cause, ids) in [
        (Cause::Hard, &[][..]),
        (Cause::MinusStuckOpen, &[Id::Feedback(Contactor::Minus)]),
        (Cause::PlusStuckOpen, &[Id::Feedback(Contactor::Plus)]),
        (Cause::PrechargeStuckOpen, &[Id::Feedback(Contactor::Precharge)]),
        (Cause::PrechargeStuckClosed, &[Id::Weld(Contactor::Precharge)]),
        (Cause::PrechargeShort, &[Id::Precharge(PrechargeFault::Short)]),
        (Cause::PrechargeOpen, &[Id::Precharge(PrechargeFault::Open)]),
        (Cause::PrechargeSlow, &[Id::Precharge(PrechargeFault::Slow)]),
        (Cause::Bypassed, &[Id::Bypassed]),
        (Cause::Dropped, &[Id::Feedback(Contactor::Plus)]),
        (Cause::Welded, &[Id::Weld(Contactor::Minus), Id::Weld(Contactor::Precharge)]),
    ] {
        let expected = ids.iter().fold(Faults::NONE, |faults, id| faults.with(*id));
        assert_eq!(cause.faults(mixed), expected, "{cause:?}");
    }
}

const QUIET: ContactorInput = ContactorInput {
    on: false,
    clear: Clear::No,
    trip: Trip::None,
    permit: true,
    resistor_ready: true,
    watch: Watch::Wait,
    current: CurrentClass::Breakable,
    link: LinkClass::Steady,
    feedback: [Feedback::Open; 3],
};

/// Contactors that show what they were told.
fn obeying(state: &ContactorState, input: ContactorInput) -> ContactorInput {
    let shows = |on| if on { Feedback::Closed } else { Feedback::Open };
    let coils = state.coils();
    let feedback = [shows(coils.minus), shows(coils.precharge), shows(coils.plus)];
    ContactorInput { feedback, ..input }
}

fn run(state: &mut ContactorState, input: ContactorInput, steps: u32) {
    for _ in 0..steps {
        let input = obeying(state, input);
        SHORT.step(state, input);
    }
}

/// After so many failed tries as are allowed it locks out, and not before.
#[test]
fn tries_are_bounded() {
    let mut state = SHORT.start();
    run(&mut state, QUIET, 3);
    let slow = ContactorInput { on: true, watch: Watch::Slow, ..QUIET };
    let (mut precharges, mut was, mut counted) = (0, false, [false; 4]);
    for _ in 0..500 {
        let input = obeying(&state, slow);
        let coils = SHORT.step(&mut state, input);
        precharges += u8::from(coils.precharge && !was);
        was = coils.precharge;
        counted[usize::from(state.tries())] = true;
    }
    assert_eq!((precharges, SHORT.tries), (3, 3));
    assert_eq!(counted[..3], [true; 3], "each failed try is told");
    assert_eq!((state.phase(), state.cause()), (Phase::Fault, Cause::PrechargeSlow));
    // Neither time nor a request ends it; a reset with the request off does.
    run(&mut state, QUIET, 100);
    assert_eq!(state.phase(), Phase::Fault);
    run(&mut state, ContactorInput { on: true, clear: Clear::Reset, ..QUIET }, 100);
    assert_eq!(state.phase(), Phase::Fault);
    run(&mut state, ContactorInput { clear: Clear::Reset, ..QUIET }, 1);
    assert_eq!((state.phase(), state.tries()), (Phase::Standby, 0));
}

/// A reset in the middle of anything: nothing closes until all shows open and the request was off.
#[test]
fn after_a_reset_nothing_closes_by_itself() {
    let mut state = SHORT.start();
    run(&mut state, ContactorInput { on: true, ..QUIET }, 100);
    assert_eq!(state.phase(), Phase::Standby);
    run(&mut state, QUIET, 1);
    run(&mut state, ContactorInput { on: true, watch: Watch::Done, ..QUIET }, 20);
    assert_eq!(state.phase(), Phase::Closed);
    assert!(state.power_allowed());
    // What is remembered stays.
    let mut state = SHORT.resume(Cause::PrechargeShort);
    run(&mut state, ContactorInput { clear: Clear::Reset, ..QUIET }, 100);
    assert_eq!((state.phase(), state.cause()), (Phase::Fault, Cause::PrechargeShort));
    run(&mut state, ContactorInput { clear: Clear::Service, ..QUIET }, 1);
    assert_eq!(state.phase(), Phase::Standby);
}
