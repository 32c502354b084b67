//! What a step leaves behind, as words: the same on any machine.

use core::fmt::{Display, from_fn};

use plant_core::Accum;
use plant_core::battery::{BatteryState, MappedBatteryState};
use plant_core::machine::heated::HeatedState;
use plant_core::machine::pmsm::DqCurrents;
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

/// The state of a battery or of drives as words of a [`Frame`].
pub trait Words {
    /// What they are. `lost` is what a compensated sum holds back.
    fn fields() -> impl Iterator<Item = &'static str>;
    /// Puts them there.
    fn put(&self, frame: &mut Frame);
}

/// The winding current of a DC machine.
impl Words for Accum {
    fn fields() -> impl Iterator<Item = &'static str> {
        ["current_a", "current_a.lost"].into_iter()
    }

    fn put(&self, frame: &mut Frame) {
        frame.put_sum(*self);
    }
}

impl Words for DqCurrents {
    fn fields() -> impl Iterator<Item = &'static str> {
        ["d_a", "d_a.lost", "q_a", "q_a.lost"].into_iter()
    }

    fn put(&self, frame: &mut Frame) {
        frame.put_sum(self.d_a);
        frame.put_sum(self.q_a);
    }
}

/// Those of the machine, then how much warmer than the coolant machine and inverter are.
impl<S: Words> Words for HeatedState<S> {
    fn fields() -> impl Iterator<Item = &'static str> {
        let warm = ["machine_k", "machine_k.lost", "inverter_k", "inverter_k.lost"];
        S::fields().chain(warm)
    }

    fn put(&self, frame: &mut Frame) {
        self.machine.put(frame);
        frame.put_sum(self.machine_above_k);
        frame.put_sum(self.inverter_above_k);
    }
}

/// Those of both drives, one after the other.
impl<A: Words, B: Words> Words for (A, B) {
    fn fields() -> impl Iterator<Item = &'static str> {
        A::fields().chain(B::fields())
    }

    fn put(&self, frame: &mut Frame) {
        self.0.put(frame);
        self.1.put(frame);
    }
}

impl Words for BatteryState {
    fn fields() -> impl Iterator<Item = &'static str> {
        ["soc", "soc.lost", "rc_v", "rc_v.lost"].into_iter()
    }

    fn put(&self, frame: &mut Frame) {
        frame.put_sum(self.soc);
        frame.put_sum(self.rc.voltage_v);
    }
}

impl Words for MappedBatteryState {
    fn fields() -> impl Iterator<Item = &'static str> {
        Frame::MAPPED_BATTERY.into_iter()
    }

    fn put(&self, frame: &mut Frame) {
        let [fast_v, slow_v] = self.polarisation_v;
        for sum in [self.soc, fast_v, slow_v, self.hysteresis, self.temperature_c] {
            frame.put_sum(sum);
        }
    }
}

impl Frame {
    const MOTION: [&'static str; 4] =
        ["speed_m_s", "speed_m_s.lost", "distance_m", "distance_m.lost"];
    const MAPPED_BATTERY: [&'static str; 10] = [
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
    /// Words of two synchronous machines.
    const DRIVES: usize = 8;
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
    const MOST: usize = Self::DRIVES
        + Self::MOTION.len()
        + Self::MAPPED_BATTERY.len()
        + Self::TERMINALS.len()
        + Self::ESTIMATORS.len();

    /// What the words are, for a vehicle whose battery remembers `S` and whose drives remember `E`.
    pub fn fields<S: Words, E: Words>() -> impl Iterator<Item = &'static str> {
        let plant = E::fields().chain(Self::MOTION).chain(S::fields()).chain(Self::TERMINALS);
        plant.chain(Self::ESTIMATORS)
    }

    /// The words of a plant.
    #[must_use]
    pub fn plant<L, S: Words, E: Words>(state: &RigState<L, S, E>) -> Self {
        let RigState { plant, seen, .. } = state;
        let mut frame = Self { words: [0; Self::MOST], length: 0, plant: 0 };
        plant.drives.put(&mut frame);
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
    pub fn of<L, S: Words, E: Words>(
        state: &RigState<L, S, E>,
        ekf: &EkfState,
        counted_soc: f32,
    ) -> Self {
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
