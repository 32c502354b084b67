//! A vehicle with its driver in a closed loop.

use core::fmt::{Display, from_fn};

use plant_core::control::driver::{Driver, DriverInput, DriverState};
use plant_core::powertrain::Feedback;
use plant_core::powertrain::ledger::{Book, EnergyLedger, NoLedger};
use plant_core::powertrain::{Powertrain, PowertrainInput, PowertrainOutput, PowertrainState};
use plant_core::presets::Vehicle;
use plant_core::signal::sources::TimeTableOutput;
use plant_core::{Accum, Dt, ParamError};
use voltstep_bms::estimate::ekf::EkfState;

/// A plant and who drives it.
#[derive(Clone, Copy, Debug)]
pub struct Rig<L> {
    /// The plant.
    pub plant: Powertrain<L>,
    /// The driver.
    pub driver: Driver,
    initial_soc: f32,
}

/// What a [`Rig`] remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigState<L> {
    /// The plant.
    pub plant: PowertrainState<L>,
    /// The driver.
    pub driver: DriverState,
    /// What the driver sees: the end of the last step.
    pub seen: Feedback,
}

impl Rig<NoLedger> {
    /// A vehicle of [`plant_core::presets`], for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(vehicle: &Vehicle, dt: Dt) -> Result<Self, ParamError> {
        match Powertrain::new(vehicle.powertrain, dt) {
            Ok(plant) => Self::driven(plant, vehicle, dt),
            Err(error) => Err(error),
        }
    }
}

impl Rig<EnergyLedger> {
    /// The same, with an energy ledger.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn with_ledger(vehicle: &Vehicle, dt: Dt) -> Result<Self, ParamError> {
        match Powertrain::with_ledger(vehicle.powertrain, dt) {
            Ok(plant) => Self::driven(plant, vehicle, dt),
            Err(error) => Err(error),
        }
    }
}

impl<L: Copy> Rig<L> {
    const fn driven(plant: Powertrain<L>, vehicle: &Vehicle, dt: Dt) -> Result<Self, ParamError> {
        match Driver::new(vehicle.driver, &vehicle.powertrain, dt) {
            Ok(driver) => Ok(Self { plant, driver, initial_soc: vehicle.initial_soc }),
            Err(error) => Err(error),
        }
    }
}

impl<L: Book> Rig<L> {
    /// The state of charge at the start.
    #[must_use]
    pub const fn initial_soc(&self) -> f32 {
        self.initial_soc
    }

    /// Standing still, with the preset's state of charge.
    ///
    /// # Errors
    /// [`ParamError::NotARatio`] where that is none.
    pub fn start(&self) -> Result<RigState<L>, ParamError> {
        let plant = self.plant.at_rest(self.initial_soc)?;
        let seen = self.plant.feedback(&plant);
        Ok(RigState { plant, driver: DriverState::default(), seen })
    }

    /// One step of driver and plant, and what the plant says of it.
    #[inline(always)]
    pub fn step(&self, state: &mut RigState<L>, reference: TimeTableOutput) -> PowertrainOutput {
        let command = self.driver.step(
            &mut state.driver,
            DriverInput {
                reference_m_s: reference.value,
                reference_m_s2: reference.rate_per_s,
                vehicle: state.seen,
            },
        );
        let mut input = PowertrainInput { duty: command.duty, ..PowertrainInput::default() };
        input.road.brake_n = command.brake_n;
        let out = self.plant.step(&mut state.plant, input);
        state.seen = Feedback::from(&out);
        out
    }
}

/// Every bit that a step leaves behind, in the plant and in the estimators beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame(pub [u32; Self::FIELDS.len()]);

impl Frame {
    /// The first of them are the plant's.
    pub const PLANT: usize = 12;
    /// What the words of a frame are. `lost` is what a compensated sum holds back.
    pub const FIELDS: [&'static str; 19] = [
        "current_a",
        "current_a.lost",
        "speed_m_s",
        "speed_m_s.lost",
        "distance_m",
        "distance_m.lost",
        "soc",
        "soc.lost",
        "rc_v",
        "rc_v.lost",
        "battery_v",
        "duty",
        "ekf.soc",
        "ekf.polarisation_v",
        "ekf.error_v",
        "ekf.own_variance",
        "ekf.shared_per_v",
        "ekf.error_variance_v2",
        "counter.soc",
    ];

    /// The words of a plant.
    #[must_use]
    pub fn plant<L>(state: &RigState<L>) -> [u32; Self::PLANT] {
        let RigState { plant, seen, .. } = state;
        let [i, i_lost] = words(plant.current_a);
        let [v, v_lost] = words(plant.body.speed_m_s);
        let [x, x_lost] = words(plant.body.distance_m);
        let [soc, soc_lost] = words(plant.battery.soc);
        let [rc, rc_lost] = words(plant.battery.rc.voltage_v);
        let (battery_v, duty) = (plant.battery_v.to_bits(), seen.duty.to_bits());
        [i, i_lost, v, v_lost, x, x_lost, soc, soc_lost, rc, rc_lost, battery_v, duty]
    }

    /// The words of a plant, and of what is estimated of it.
    #[must_use]
    pub fn of<L>(state: &RigState<L>, ekf: &EkfState, counted_soc: f32) -> Self {
        let [polarisation_v, _] = ekf.polarisation_v;
        let estimators = [
            ekf.soc().to_bits(),
            polarisation_v.to_bits(),
            ekf.error_v.to_bits(),
            ekf.own_variance.to_bits(),
            ekf.shared_per_v.to_bits(),
            ekf.error_variance_v2.to_bits(),
            counted_soc.to_bits(),
        ];
        let mut frame = [0; Self::FIELDS.len()];
        let words = Self::plant(state).into_iter().chain(estimators);
        for (place, word) in frame.iter_mut().zip(words) {
            *place = word;
        }
        Self(frame)
    }

    /// The words after a step, in a line.
    #[must_use]
    pub fn line(&self, step: u32) -> impl Display {
        from_fn(move |f| write!(f, "frame {step} {:08x?}", self.0))
    }
}

/// The value of a compensated sum and, exactly, what it holds back.
fn words(sum: Accum) -> [u32; 2] {
    [sum.get().to_bits(), sum.since(Accum::new(sum.get())).to_bits()]
}
