//! What must hold in every step, judged by a bystander who sees inputs and coils, and counts by
//! himself: no property trusts a timer of the machine.

use crate::contactor::{
    Cause, Coils, ContactorControl, ContactorInput, ContactorState, CurrentClass, Feedback,
    LinkClass, Phase, Watch,
};
use crate::protect::Trip;

/// What the bystander counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Bystander {
    /// Steps with a main closed while a hard trip stands.
    hard: u16,
    /// Steps with both mains closed since they were to open.
    due: u16,
    /// Steps in a phase that must end.
    phase: u16,
    /// Failed precharges since the contactors were last closed, or the request was off.
    failed: u8,
    /// The request was off while all was open, since the start or the last fault.
    off: bool,
}

const fn mains(coils: Coils) -> bool {
    coils.minus && coils.plus
}

const fn any(coils: Coils) -> bool {
    coils.minus || coils.plus || coils.precharge
}

const fn rises(before: bool, after: bool) -> bool {
    !before && after
}

/// A step: state and what the bystander knew before, input, state after.
#[derive(Clone, Copy)]
pub struct Step<'a> {
    pub control: &'a ContactorControl,
    pub before: &'a ContactorState,
    pub after: &'a ContactorState,
    pub input: &'a ContactorInput,
    pub known: &'a Bystander,
}

impl Step<'_> {
    /// What the bystander knows after it.
    pub fn watch(&self) -> Bystander {
        let (control, input, known) = (self.control, self.input, self.known);
        let (from, to) = (self.before.phase(), self.after.phase());
        let coils = self.after.coils();
        let until = |counted: u16, limit: u16| (counted + 1).min(limit + 2);
        let hard = (coils.minus || coils.plus) && input.trip >= Trip::Hard;
        let due = mains(coils) && to == Phase::Shed;
        let fails = from == Phase::Precharge
            && to == Phase::OpenSecond
            && input.on
            && input.trip == Trip::None
            && input.permit
            && input.watch != Watch::Short;
        let failed = known.failed + u8::from(fails);
        Bystander {
            hard: if hard { until(known.hard, control.hard + control.open) } else { 0 },
            due: if due { until(known.due, control.shed) } else { 0 },
            phase: if from == to { until(known.phase, self.longest(to)) } else { 0 },
            failed: if to == Phase::Closed || to == Phase::Standby && !input.on {
                0
            } else {
                failed.min(control.tries + 1)
            },
            off: !matches!(to, Phase::Fault | Phase::Start)
                && (known.off || !input.on && to == Phase::Standby),
        }
    }

    /// Steps that a phase may last.
    fn longest(&self, phase: Phase) -> u16 {
        let c = self.control;
        match phase {
            Phase::CloseMinus | Phase::ClosePlus => c.close,
            Phase::Precharge => c.precharge,
            Phase::OpenPrecharge | Phase::OpenFirst | Phase::OpenSecond => c.open,
            Phase::Shed => c.shed,
            Phase::WeldCheck => c.weld,
            Phase::Cooldown => c.cooldown,
            // All may take turns to show that nothing is known.
            Phase::Start => c.start.max(c.open),
            Phase::Standby | Phase::Closed | Phase::Fault => 0,
        }
    }

    /// It leaves a phase for a reason that takes a time, before that time.
    fn too_soon(&self) -> bool {
        let (c, i) = (self.control, self.input);
        let (from, to, cause) = (self.before.phase(), self.after.phase(), self.after.cause());
        let (open, closed) = (Feedback::Open, Feedback::Closed);
        let least = match (from, to) {
            (Phase::Start, Phase::Fault) if self.before.cause() == Cause::None => match cause {
                Cause::Welded => c.open,
                _ => c.start,
            },
            (Phase::CloseMinus, Phase::Precharge) => c.settle,
            (Phase::CloseMinus, _) if cause == Cause::MinusStuckOpen => c.close,
            (Phase::Precharge, _) if cause == Cause::PrechargeSlow && i.watch != Watch::Slow => {
                c.precharge
            }
            (Phase::ClosePlus, _) if cause == Cause::PlusStuckOpen => c.close,
            (Phase::OpenPrecharge, _) if cause == Cause::PrechargeStuckClosed => c.open,
            (Phase::OpenFirst, Phase::OpenSecond)
                if i.feedback[2] != open && i.trip != Trip::Crash =>
            {
                c.open
            }
            (Phase::OpenSecond, Phase::WeldCheck) if i.feedback != [open; 3] => c.open,
            (Phase::WeldCheck, Phase::Cooldown | Phase::Fault)
                if i.link != LinkClass::Falling || i.feedback.contains(&closed) =>
            {
                c.weld
            }
            (Phase::Cooldown, Phase::Standby) => c.cooldown,
            _ => return false,
        };
        from != to && self.known.phase + 1 < least
    }

    /// The first property that it breaks.
    pub fn broken(&self, now: &Bystander) -> Option<&'static str> {
        let (before, after) = (self.before.coils(), self.after.coils());
        let (c, i, known) = (self.control, self.input, self.known);
        let (from, to) = (self.before.phase(), self.after.phase());
        let [minus, precharge, plus] = i.feedback;
        let (open, closed) = (Feedback::Open, Feedback::Closed);
        let minus_rises = rises(before.minus, after.minus);
        let precharge_rises = rises(before.precharge, after.precharge);
        let plus_rises = rises(before.plus, after.plus);
        let main_opens = mains(before) && !mains(after);
        let waited = known.due
            >= if i.trip == Trip::Hard || self.after.cause() == Cause::Hard {
                c.hard
            } else {
                c.shed
            };
        let crash = i.trip == Trip::Crash || self.after.cause() == Cause::Crash;
        let may_end = i.clear >= self.before.cause().needs()
            && i.trip == Trip::None
            && !i.on
            && !i.feedback.contains(&closed);
        let lasts = matches!(to, Phase::Standby | Phase::Closed | Phase::Fault);
        let rules = [
            (
                plus_rises
                    && !(i.watch == Watch::Done
                        && minus == closed
                        && precharge == closed
                        && before.minus
                        && before.precharge),
                "plus closes only onto a charged link, through contactors that show closed",
            ),
            (
                (minus_rises || precharge_rises || plus_rises)
                    && !(i.on && i.trip == Trip::None && i.permit)
                    && !(plus_rises && i.on && i.trip == Trip::None),
                "nothing closes without request, with a trip, or with data missing",
            ),
            (
                (minus_rises || precharge_rises) && !i.permit,
                "nothing starts while a fault is latched, data are missing or cells unseen",
            ),
            (
                precharge_rises && !(before.minus && minus == closed && plus != closed),
                "precharge closes only behind a closed minus and an open plus",
            ),
            (
                minus_rises && !(i.resistor_ready && known.off && i.feedback == [open; 3]),
                "a start needs a cool resistor, a renewed request, and all shown open",
            ),
            (minus_rises && after.plus, "never both mains in one step"),
            (i.trip == Trip::Crash && any(after), "a crash opens all in the same step"),
            (
                now.hard > c.hard + c.open + 1,
                "at a safety limit both mains are open within the two stated waits and a step",
            ),
            (now.due > c.shed + 1, "a main opens within the stated wait and a step"),
            (
                main_opens && i.current != CurrentClass::Breakable && !crash && !waited,
                "a main opens on a current that can be broken, or after the whole wait",
            ),
            (before.plus && !after.plus && after.precharge, "precharge is off when a main opens"),
            (
                from == Phase::Fault && to != Phase::Fault && !may_end,
                "a fault ends by the clearance that its cause needs, with trip and request gone",
            ),
            (to == Phase::Fault && self.after.cause() == Cause::None, "every fault has a cause"),
            (known.failed >= c.tries && minus_rises, "no try after the last one has failed"),
            (
                from == Phase::WeldCheck
                    && to == Phase::Fault
                    && self.before.cause() == self.after.cause()
                    && matches!(self.after.cause(), Cause::PrechargeSlow | Cause::PrechargeOpen)
                    && known.failed < c.tries,
                "every try that is allowed is made",
            ),
            (
                any(after)
                    && matches!(
                        to,
                        Phase::Start
                            | Phase::Standby
                            | Phase::OpenSecond
                            | Phase::WeldCheck
                            | Phase::Cooldown
                            | Phase::Fault
                    ),
                "all is open at rest",
            ),
            (!lasts && now.phase >= self.longest(to), "no phase outlasts its limit"),
            (!lasts && from != to && now.phase != 0, "a timer begins with its phase"),
            (self.too_soon(), "what has a time is not cut short, and nobody is accused before it"),
        ];
        rules.into_iter().find(|(broken, _)| *broken).map(|(_, why)| why)
    }
}
