//! A vehicle on its way along the cycle.

use core::fmt::{Display, from_fn};

use plant_core::battery::{BatteryState, Pack};
use plant_core::control::driver::Steering;
use plant_core::powertrain::Drives;
use plant_core::powertrain::ledger::Book;
use plant_core::signal::sources::TimeTableState;
use plant_core::{Accum, ParamError};

use crate::monitor::{Monitor, MonitorState};
use crate::{BLOCKS, Fnv1a, Frame, REFERENCE, Rig, RigState, STEPS_PER_BLOCK, Words};

/// A vehicle on its way along the cycle, and the hash of all that was.
#[derive(Clone, Copy, Debug)]
pub struct Run<L, S = BatteryState, E = Accum> {
    /// Where it is.
    pub state: RigState<L, S, E>,
    /// What its estimators believe.
    pub monitor: MonitorState,
    clock: TimeTableState,
    hash: Fnv1a,
    estimators: Fnv1a,
    steps: u32,
    rejected: bool,
}

impl<L: Book, S: Words, E: Words> Run<L, S, E> {
    /// At the start of the cycle.
    ///
    /// # Errors
    /// [`ParamError::NotARatio`] for a vehicle whose state of charge is none.
    pub fn new<B: Pack<State = S>, D: Drives<State = E>, C: Steering<D>>(
        rig: &Rig<L, B, D, C>,
        monitor: &Monitor,
    ) -> Result<Self, ParamError> {
        let state = rig.start()?;
        let monitor = monitor.start(rig.initial_soc())?;
        let (clock, hash) = (TimeTableState::default(), Fnv1a::default());
        Ok(Self { state, monitor, clock, hash, estimators: hash, steps: 0, rejected: false })
    }

    /// One step: reference, driver, plant, estimators, hash. What it left behind.
    #[inline]
    pub fn step<B: Pack<State = S>, D: Drives<State = E>, C: Steering<D>>(
        &mut self,
        rig: &Rig<L, B, D, C>,
        monitor: &Monitor,
    ) -> Frame {
        let reference = REFERENCE.step(&mut self.clock, ());
        let pack = rig.step(&mut self.state, reference);
        self.rejected |= pack.rejected;
        monitor.step(&mut self.monitor, self.steps, &pack);
        self.steps += 1;
        let counted_soc = monitor.counter.soc(&self.monitor.counter);
        let frame = Frame::of(&self.state, &self.monitor.ekf, counted_soc);
        let (plant, estimators) = frame.parts();
        for word in plant {
            self.hash.word(*word);
        }
        for word in estimators {
            self.estimators.word(*word);
        }
        frame
    }

    /// Whether the cycle is over.
    #[must_use]
    pub const fn ended(&self) -> bool {
        self.steps == BLOCKS * STEPS_PER_BLOCK
    }

    /// Steps made.
    #[must_use]
    pub const fn steps(&self) -> u32 {
        self.steps
    }

    /// The number of the block that the last step completed.
    #[must_use]
    pub const fn block_completed(&self) -> Option<u32> {
        if self.steps > 0 && self.steps.is_multiple_of(STEPS_PER_BLOCK) {
            Some(self.steps / STEPS_PER_BLOCK - 1)
        } else {
            None
        }
    }

    /// The hash of the plant's part of every frame so far.
    #[must_use]
    pub const fn hash(&self) -> u64 {
        self.hash.get()
    }

    /// The hash of the estimators' part.
    #[must_use]
    pub const fn estimators_hash(&self) -> u64 {
        self.estimators.get()
    }

    /// Whether the plant refused a step.
    #[must_use]
    pub const fn rejected(&self) -> bool {
        self.rejected
    }

    /// The block of the last step and both hashes so far, in a line.
    #[must_use]
    pub fn block(&self) -> impl Display {
        from_fn(|f| {
            let block = self.steps.saturating_sub(1) / STEPS_PER_BLOCK;
            write!(f, "block {block} {:016x} {:016x}", self.hash(), self.estimators_hash())
        })
    }

    /// Both hashes, where the plant is, and what its estimators believe, in a line.
    #[must_use]
    pub fn result(&self, monitor: &Monitor) -> impl Display {
        from_fn(|f| {
            let plant = &self.state.plant;
            let believed = monitor.ekf.estimate(&self.monitor.ekf);
            write!(
                f,
                "result hash {:016x} {:016x} soc {} distance_m {} rejected {} ekf {} ± {} counted {}",
                self.hash(),
                self.estimators_hash(),
                self.state.seen.soc,
                plant.body.distance_m.get(),
                self.rejected,
                believed.soc,
                believed.soc_sd,
                monitor.counter.soc(&self.monitor.counter)
            )
        })
    }
}
