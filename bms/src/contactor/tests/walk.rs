//! Every state that can be reached, under every class of input, timers included.

extern crate std;

use std::collections::HashMap;
use std::string::String;
use std::time::Instant;
use std::vec::Vec;
use std::{format, println, vec};

use super::properties::{Bystander, Step};
use crate::contactor::{
    Cause, ContactorControl, ContactorInput, ContactorParams, ContactorState, CurrentClass,
    Feedback, LinkClass, Phase, Watch,
};
use crate::protect::{Clear, Trip};
use crate::{Dt, must};

/// The step that is walked: the real one, or one with a defect.
pub type Machine = fn(&ContactorControl, &mut ContactorState, ContactorInput);

pub fn real(control: &ContactorControl, state: &mut ContactorState, input: ContactorInput) {
    control.step(state, input);
}

const BOTH: [bool; 2] = [false, true];

/// Each input so far with every value of one more field.
fn over<T: Copy>(
    inputs: &mut Vec<ContactorInput>,
    values: &[T],
    set: impl Fn(&mut ContactorInput, T),
) {
    *inputs = inputs
        .iter()
        .flat_map(|input| {
            values.iter().map(|value| {
                let mut input = *input;
                set(&mut input, *value);
                input
            })
        })
        .collect();
}

pub fn every_input() -> Vec<ContactorInput> {
    let shows = [Feedback::Unknown, Feedback::Open, Feedback::Closed];
    let mut inputs = vec![ContactorInput {
        on: false,
        clear: Clear::No,
        trip: Trip::None,
        permit: false,
        resistor_ready: false,
        watch: Watch::Wait,
        current: CurrentClass::Unknown,
        link: LinkClass::Unknown,
        feedback: [Feedback::Unknown; 3],
    }];
    over(&mut inputs, &BOTH, |i, v| i.on = v);
    over(&mut inputs, &[Clear::No, Clear::Reset, Clear::Service], |i, v| i.clear = v);
    over(&mut inputs, &[Trip::None, Trip::Soft, Trip::Hard, Trip::Crash], |i, v| i.trip = v);
    over(&mut inputs, &BOTH, |i, v| i.permit = v);
    over(&mut inputs, &BOTH, |i, v| i.resistor_ready = v);
    let watches = [Watch::Wait, Watch::Done, Watch::Short, Watch::Open, Watch::Slow];
    over(&mut inputs, &watches, |i, v| i.watch = v);
    let currents = [CurrentClass::Unknown, CurrentClass::Breakable, CurrentClass::High];
    over(&mut inputs, &currents, |i, v| i.current = v);
    let links = [LinkClass::Unknown, LinkClass::Steady, LinkClass::Rising, LinkClass::Falling];
    over(&mut inputs, &links, |i, v| i.link = v);
    for which in 0..3 {
        over(&mut inputs, &shows, |i, v| i.feedback[which] = v);
    }
    inputs
}

type Node = (ContactorState, Bystander);

pub struct Walk {
    /// Each node, and whence and by which input it was reached first; those of a reset by themselves.
    nodes: Vec<(Node, usize, usize)>,
    /// What follows each.
    next: Vec<Vec<u32>>,
    pub steps: u64,
}

impl Walk {
    pub fn states(&self) -> usize {
        let mut states: Vec<_> = self.nodes.iter().map(|((state, _), ..)| state).collect();
        states.sort_by_key(|s| (s.phase, s.since, s.cause, s.tries, s.armed));
        states.dedup();
        states.len()
    }

    pub fn edges(&self) -> usize {
        self.next.iter().map(Vec::len).sum()
    }

    fn rests(&self, node: usize) -> bool {
        let phase = self.nodes[node].0.0.phase;
        matches!(phase, Phase::Standby | Phase::Closed | Phase::Fault)
    }

    /// The longest way through phases of passage, whatever the inputs do; an endless one is named.
    pub fn longest_passage(&self) -> Result<usize, String> {
        let n = self.nodes.len();
        let (mut mark, mut length) = (vec![0_u8; n], vec![0_usize; n]);
        for root in (0..n).filter(|root| !self.rests(*root)) {
            if mark[root] != 0 {
                continue;
            }
            let mut stack = vec![(root, 0_usize)];
            mark[root] = 1;
            while let Some((node, done)) = stack.last_mut() {
                let node = *node;
                if let Some(to) = self.next[node].get(*done).map(|to| *to as usize) {
                    *done += 1;
                    if self.rests(to) {
                        length[node] = length[node].max(1);
                    } else if mark[to] == 0 {
                        mark[to] = 1;
                        stack.push((to, 0));
                    } else if mark[to] == 1 {
                        let phase = self.nodes[to].0.0.phase;
                        return Err(format!("an endless passage through {phase:?}"));
                    } else {
                        length[node] = length[node].max(length[to] + 1);
                    }
                } else {
                    mark[node] = 2;
                    stack.pop();
                    if let Some((before, _)) = stack.last() {
                        length[*before] = length[*before].max(length[node] + 1);
                    }
                }
            }
        }
        Ok(length.into_iter().max().unwrap_or(0))
    }

    /// How many nodes can never come to a phase again.
    pub fn stranded_from(&self, goal: Phase) -> usize {
        let n = self.nodes.len();
        let mut before = vec![Vec::new(); n];
        for (node, next) in self.next.iter().enumerate() {
            for to in next {
                before[*to as usize].push(node);
            }
        }
        let mut comes: Vec<bool> = self.nodes.iter().map(|(n, ..)| n.0.phase == goal).collect();
        let mut queue: Vec<usize> = (0..n).filter(|node| comes[*node]).collect();
        while let Some(node) = queue.pop() {
            for from in &before[node] {
                if !comes[*from] {
                    comes[*from] = true;
                    queue.push(*from);
                }
            }
        }
        comes.iter().filter(|comes| !**comes).count()
    }
}

/// The shortest way to a step that breaks a property, in lines.
fn trace(
    walk: &Walk,
    at: usize,
    inputs: &[ContactorInput],
    last: (usize, ContactorState),
) -> String {
    let line = |input: &ContactorInput, state: &ContactorState| {
        format!(
            "\n  {input:?}\n    -> {:?} since {} cause {:?} tries {}",
            state.phase, state.since, state.cause, state.tries
        )
    };
    let mut lines = vec![line(&inputs[last.0], &last.1)];
    let mut back = at;
    loop {
        let ((state, _), from, by) = &walk.nodes[back];
        if *from == back {
            lines.push(format!("\n  after a reset, cause {:?}", state.cause));
            break;
        }
        lines.push(line(&inputs[*by], state));
        back = *from;
    }
    lines.reverse();
    format!("{} steps:{}", lines.len() - 1, lines.concat())
}

/// Breadth first, so that a counterexample is a shortest one.
pub fn walk(
    control: &ContactorControl,
    inputs: &[ContactorInput],
    machine: Machine,
) -> Result<Walk, String> {
    let mut found: HashMap<Node, u32> = HashMap::new();
    let mut walk = Walk { nodes: Vec::new(), next: Vec::new(), steps: 0 };
    // Whatever a record may say.
    for cause in Cause::ALL {
        let first = (control.resume(cause), Bystander::default());
        let root = walk.nodes.len();
        found.insert(first, u32::try_from(root).unwrap());
        walk.nodes.push((first, root, 0));
    }
    let mut at = 0;
    while at < walk.nodes.len() {
        let (before, known) = walk.nodes[at].0;
        let mut next: Vec<u32> = Vec::new();
        let mut last: Option<(Node, u32)> = None;
        for (k, input) in inputs.iter().enumerate() {
            let mut after = before;
            machine(control, &mut after, *input);
            let step = Step { control, before: &before, after: &after, input, known: &known };
            let now = step.watch();
            walk.steps += 1;
            if let Some(why) = step.broken(&now) {
                return Err(format!("{why}; {}", trace(&walk, at, inputs, (k, after))));
            }
            let id = match last {
                Some((node, id)) if node == (after, now) => id,
                _ => *found.entry((after, now)).or_insert_with(|| {
                    walk.nodes.push(((after, now), at, k));
                    u32::try_from(walk.nodes.len() - 1).unwrap()
                }),
            };
            last = Some(((after, now), id));
            next.push(id);
            if next.len() > 256 {
                next.sort_unstable();
                next.dedup();
            }
        }
        next.sort_unstable();
        next.dedup();
        walk.next.push(next);
        at += 1;
    }
    Ok(walk)
}

/// Timers of a few steps: every order of events, with every input.
pub const SHORT: ContactorControl = must!(ContactorControl::new(
    ContactorParams {
        start_limit_s: 0.04,
        settle_s: 0.02,
        close_limit_s: 0.04,
        precharge_limit_s: 0.05,
        open_limit_s: 0.03,
        shed_limit_s: 0.05,
        hard_limit_s: 0.02,
        weld_limit_s: 0.04,
        cooldown_s: 0.03,
        tries: 3,
    },
    DT
));
/// The usual timers.
const USUAL: ContactorControl = must!(ContactorControl::new(ContactorParams::USUAL, DT));
const DT: Dt = must!(Dt::from_s(0.01));

fn report(name: &str, walk: &Walk, inputs: usize, began: Instant) {
    println!(
        "{name} x {inputs} inputs: {} states, {} with the bystander, {} edges, {} steps judged, \
         longest passage {} steps, {:.1} s",
        walk.states(),
        walk.nodes.len(),
        walk.edges(),
        walk.steps,
        walk.longest_passage().unwrap(),
        began.elapsed().as_secs_f64(),
    );
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn every_state_and_every_input_keeps_every_property() {
    let began = Instant::now();
    let inputs = every_input();
    assert_eq!(inputs.len(), 155_520);
    let walk = walk(&SHORT, &inputs, real).unwrap_or_else(|broken| panic!("{broken}"));
    report("short timers", &walk, inputs.len(), began);
    // As the book says.
    assert_eq!((walk.states(), walk.edges()), (546, 2076));
    // No dead state and no endless wait: from anywhere to rest and to drive.
    assert!(walk.longest_passage().is_ok());
    assert_eq!(walk.stranded_from(Phase::Standby), 0);
    assert_eq!(walk.stranded_from(Phase::Closed), 0);
    // Every phase and every cause is reached.
    let reached = |cause| walk.nodes.iter().any(|(node, ..)| node.0.cause == cause);
    assert!(Cause::ALL.into_iter().all(reached));
}

/// The usual timers, step by step, with the inputs that lead on: a tenth of a minute.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn usual_timers_keep_every_property() {
    let began = Instant::now();
    let mut inputs = every_input();
    inputs.retain(|i| {
        i.current != CurrentClass::Unknown
            && i.clear != Clear::Reset
            && i.link != LinkClass::Unknown
            && !i.feedback.contains(&Feedback::Unknown)
            && (i.permit || i.trip == Trip::None)
            && (i.trip == Trip::None || i.watch == Watch::Wait)
            && i.resistor_ready
    });
    let walk = walk(&USUAL, &inputs, real).unwrap_or_else(|broken| panic!("{broken}"));
    report("usual timers", &walk, inputs.len(), began);
    assert_eq!(walk.states(), 24_759, "as the book says");
    assert!(walk.longest_passage().is_ok_and(|steps| steps < 2000));
    assert_eq!(walk.stranded_from(Phase::Standby), 0);
}
