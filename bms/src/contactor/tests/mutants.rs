//! Defects of the kind found in others' state machines, planted around the real step: the walk
//! catches each.

extern crate std;

use std::string::String;
use std::vec::Vec;
use std::{println, vec};

use super::walk::{Machine, SHORT, every_input, real, walk};
use crate::contactor::{
    Cause, ContactorControl, ContactorInput, ContactorState, Feedback, LinkClass, Phase, Watch,
};
use crate::protect::{Clear, Trip};

/// One good sample clears a latched fault.
fn good_sample_clears(c: &ContactorControl, state: &mut ContactorState, input: ContactorInput) {
    let clear = if input.trip == Trip::None { Clear::Service } else { input.clear };
    real(c, state, ContactorInput { clear, ..input });
}

/// An endless wait for the second main.
fn endless_wait(c: &ContactorControl, state: &mut ContactorState, input: ContactorInput) {
    if state.phase == Phase::ClosePlus {
        state.since = 0;
    }
    real(c, state, input);
}

/// The same for the first.
fn endless_open(c: &ContactorControl, state: &mut ContactorState, input: ContactorInput) {
    if state.phase == Phase::OpenFirst {
        state.since = 0;
    }
    real(c, state, input);
}

/// A failed try is counted twice.
fn counted_twice(c: &ContactorControl, state: &mut ContactorState, input: ContactorInput) {
    let before = state.tries;
    real(c, state, input);
    if state.tries > before {
        state.tries += 1;
    }
}

/// A failed try is not counted.
fn never_counted(c: &ContactorControl, state: &mut ContactorState, input: ContactorInput) {
    state.tries = 0;
    real(c, state, input);
}

/// The timer is never reset.
fn timer_kept(c: &ContactorControl, state: &mut ContactorState, input: ContactorInput) {
    let before = *state;
    real(c, state, input);
    if state.phase != before.phase {
        state.since = before.since;
    }
}

/// The second main closes before the precharge contactor shows closed.
fn before_feedback(c: &ContactorControl, state: &mut ContactorState, input: ContactorInput) {
    let [minus, _, plus] = input.feedback;
    let feedback = if state.phase == Phase::Precharge {
        [minus, Feedback::Closed, plus]
    } else {
        input.feedback
    };
    real(c, state, ContactorInput { feedback, ..input });
}

/// A late precharge contactor leads back instead of out.
fn loops_back(c: &ContactorControl, state: &mut ContactorState, input: ContactorInput) {
    let late = state.phase == Phase::OpenPrecharge && input.feedback[1] != Feedback::Open;
    real(c, state, input);
    if late {
        state.phase = Phase::ClosePlus;
    }
}

/// A trip while the link is charged is not looked at.
fn deaf_while_charging(c: &ContactorControl, state: &mut ContactorState, input: ContactorInput) {
    let trip = if state.phase == Phase::Precharge { Trip::None } else { input.trip };
    real(c, state, ContactorInput { trip, ..input });
}

/// Closing goes on though data went missing.
fn blind_start(c: &ContactorControl, state: &mut ContactorState, input: ContactorInput) {
    real(c, state, ContactorInput { permit: true, ..input });
}

/// The request need not be renewed after a fault.
fn starts_by_itself(c: &ContactorControl, state: &mut ContactorState, input: ContactorInput) {
    state.armed = true;
    real(c, state, input);
}

/// What makes the walk of a defect short: the inputs that lead through everything.
fn fewer_inputs() -> Vec<ContactorInput> {
    let mut inputs = every_input();
    inputs.retain(|i| {
        i.link != LinkClass::Unknown
            && i.clear != Clear::Reset
            && (i.trip == Trip::None || i.watch == Watch::Wait)
            && i.watch != Watch::Short
    });
    inputs
}

fn verdict(inputs: &[ContactorInput], machine: Machine) -> Result<usize, String> {
    walk(&SHORT, inputs, machine)?.longest_passage()
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn each_planted_defect_is_caught() {
    let inputs = fewer_inputs();
    let defects: [(&str, Machine); 11] = [
        ("one good sample clears a latched fault", good_sample_clears),
        ("an endless wait for the second main", endless_wait),
        ("an endless wait for the first to open", endless_open),
        ("a failed try counts twice", counted_twice),
        ("a failed try does not count", never_counted),
        ("the timer is never reset", timer_kept),
        ("plus closes before precharge shows closed", before_feedback),
        ("a late precharge contactor leads back", loops_back),
        ("a trip while charging is not seen", deaf_while_charging),
        ("missing data are not seen", blind_start),
        ("a start without a renewed request", starts_by_itself),
    ];
    let mut missed = vec![];
    for (defect, machine) in defects {
        match verdict(&inputs, machine) {
            Ok(_) => missed.push(defect),
            Err(broken) => {
                // The inputs that lead there, step by step.
                let shown = broken.contains(" steps:\n  after a reset, cause ");
                assert!(shown || broken.starts_with("an endless passage through "), "{broken}");
                println!("{defect}:\n  {broken}\n");
            }
        }
    }
    assert!(missed.is_empty(), "not caught: {missed:?}");
    assert!(verdict(&inputs, real).is_ok());
    assert_eq!(Cause::None.needs(), Clear::No);
}
