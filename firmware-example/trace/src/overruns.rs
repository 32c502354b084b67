//! Steps that a control loop did not finish in time.

/// Counts the steps of a control loop that were not over when the next tick came.
///
/// A step that lasts several ticks counts once: the timer's flag does not say how many came.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overruns {
    count: u32,
}

impl Overruns {
    /// A step is over; `tick_pending` says whether the timer has ticked since the step began.
    pub const fn step_ended(&mut self, tick_pending: bool) {
        if tick_pending {
            self.count = self.count.saturating_add(1);
        }
    }

    /// How many steps were late.
    #[must_use]
    pub const fn count(self) -> u32 {
        self.count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs steps of these lengths in ticks, each as soon as its tick is there.
    fn late(lengths: &[f32]) -> u32 {
        let mut overruns = Overruns::default();
        let (mut now, mut served) = (0.0_f32, 0.0_f32);
        for length in lengths {
            // Waits for a tick that is not served yet, or takes the one that is pending.
            now = now.max(served + 1.0);
            served = now.floor();
            now += length;
            overruns.step_ended(now.floor() > served);
        }
        overruns.count()
    }

    #[test]
    fn steps_in_time_are_not_counted() {
        assert_eq!(late(&[0.5; 10]), 0);
        assert_eq!(late(&[0.99, 0.01, 0.99]), 0);
    }

    #[test]
    fn a_late_step_counts_once() {
        assert_eq!(late(&[0.5, 1.5, 0.25, 0.5]), 1);
        assert_eq!(late(&[0.5, 3.5, 0.25, 0.5]), 1);
        // The second starts late because of the first, and is late by that.
        assert_eq!(late(&[1.5, 0.75, 0.5]), 2);
        assert_eq!(late(&[1.5; 4]), 4);
    }

    #[test]
    fn the_count_does_not_wrap() {
        let mut overruns = Overruns { count: u32::MAX };
        overruns.step_ended(true);
        assert_eq!(overruns.count(), u32::MAX);
    }
}
