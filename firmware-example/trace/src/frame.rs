//! What a step leaves behind, as words: the same on any machine.

use core::fmt::{Display, from_fn};

use plant_core::Accum;
use plant_core::battery::{BatteryState, MappedBatteryState};
use voltstep_bms::estimate::ekf::EkfState;

use crate::RigState;

/// Every bit that a step leaves behind, in the plant and in the estimators beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    words: [u32; Self::MOST],
    length: usize,
    /// The first of them are the plant's.
    plant: usize,
}

/// The state of a battery as words of a [`Frame`].
pub trait Words {
    /// What they are. `lost` is what a compensated sum holds back.
    const FIELDS: &'static [&'static str];
    /// State of charge, 0..1.
    fn soc(&self) -> f32;
    /// Puts them there.
    fn put(&self, frame: &mut Frame);
}

impl Words for BatteryState {
    const FIELDS: &'static [&'static str] = &["soc", "soc.lost", "rc_v", "rc_v.lost"];

    fn soc(&self) -> f32 {
        self.soc.get()
    }

    fn put(&self, frame: &mut Frame) {
        frame.put_sum(self.soc);
        frame.put_sum(self.rc.voltage_v);
    }
}

impl Words for MappedBatteryState {
    const FIELDS: &'static [&'static str] = &[
        "soc",
        "soc.lost",
        "fast_v",
        "fast_v.lost",
        "slow_v",
        "slow_v.lost",
        "hysteresis",
        "hysteresis.lost",
        "temperature_c",
        "temperature_c.lost",
    ];

    fn soc(&self) -> f32 {
        self.soc.get()
    }

    fn put(&self, frame: &mut Frame) {
        let [fast_v, slow_v] = self.polarisation_v;
        for sum in [self.soc, fast_v, slow_v, self.hysteresis, self.temperature_c] {
            frame.put_sum(sum);
        }
    }
}

impl Frame {
    const MOTION: [&'static str; 6] = [
        "current_a",
        "current_a.lost",
        "speed_m_s",
        "speed_m_s.lost",
        "distance_m",
        "distance_m.lost",
    ];
    const TERMINALS: [&'static str; 2] = ["battery_v", "duty"];
    const ESTIMATORS: [&'static str; 7] = [
        "ekf.soc",
        "ekf.polarisation_v",
        "ekf.error_v",
        "ekf.own_variance",
        "ekf.shared_per_v",
        "ekf.error_variance_v2",
        "counter.soc",
    ];
    /// Words of the longest.
    const MOST: usize = Self::MOTION.len()
        + MappedBatteryState::FIELDS.len()
        + Self::TERMINALS.len()
        + Self::ESTIMATORS.len();

    /// What the words are, for a vehicle whose battery remembers `S`.
    pub fn fields<S: Words>() -> impl Iterator<Item = &'static str> {
        let battery = S::FIELDS.iter().copied();
        Self::MOTION.into_iter().chain(battery).chain(Self::TERMINALS).chain(Self::ESTIMATORS)
    }

    /// The words of a plant.
    #[must_use]
    pub fn plant<L, S: Words>(state: &RigState<L, S>) -> Self {
        let RigState { plant, seen, .. } = state;
        let mut frame = Self { words: [0; Self::MOST], length: 0, plant: 0 };
        frame.put_sum(plant.drives);
        frame.put_sum(plant.body.speed_m_s);
        frame.put_sum(plant.body.distance_m);
        plant.battery.put(&mut frame);
        frame.put(plant.battery_v);
        frame.put(seen.duty);
        frame.plant = frame.length;
        frame
    }

    /// The words of a plant, and of what is estimated of it.
    #[must_use]
    pub fn of<L, S: Words>(state: &RigState<L, S>, ekf: &EkfState, counted_soc: f32) -> Self {
        let mut frame = Self::plant(state);
        let [polarisation_v, _] = ekf.polarisation_v;
        for value in [
            ekf.soc(),
            polarisation_v,
            ekf.error_v,
            ekf.own_variance,
            ekf.shared_per_v,
            ekf.error_variance_v2,
            counted_soc,
        ] {
            frame.put(value);
        }
        frame
    }

    /// All of it.
    #[must_use]
    pub fn words(&self) -> &[u32] {
        self.words.get(..self.length).unwrap_or_default()
    }

    /// The plant's part, and the rest.
    #[must_use]
    pub fn parts(&self) -> (&[u32], &[u32]) {
        self.words().split_at_checked(self.plant).unwrap_or_default()
    }

    /// The words after a step, in a line.
    #[must_use]
    pub fn line(&self, step: u32) -> impl Display {
        from_fn(move |f| write!(f, "frame {step} {:08x?}", self.words()))
    }

    fn put(&mut self, value: f32) {
        if let Some(place) = self.words.get_mut(self.length) {
            *place = value.to_bits();
            self.length += 1;
        }
    }

    /// The value of a compensated sum and, exactly, what it holds back.
    fn put_sum(&mut self, sum: Accum) {
        self.put(sum.get());
        self.put(sum.since(Accum::new(sum.get())));
    }
}
