//! A vehicle with its driver in a closed loop.

use plant_core::battery::{Battery, BatteryState, MappedBattery, MappedBatteryParams, Pack};
use plant_core::control::driver::{Driver, DriverInput, DriverState};
use plant_core::powertrain::Feedback;
use plant_core::powertrain::ledger::{Book, EnergyLedger, NoLedger};
use plant_core::powertrain::{Powertrain, PowertrainInput, PowertrainOutput, PowertrainState};
use plant_core::presets::Vehicle;
use plant_core::signal::sources::TimeTableOutput;
use plant_core::{Dt, ParamError};

/// A plant and who drives it.
#[derive(Clone, Copy, Debug)]
pub struct Rig<L, B = Battery> {
    /// The plant.
    pub plant: Powertrain<L, B>,
    /// The driver.
    pub driver: Driver,
    initial_soc: f32,
}

/// What a [`Rig`] remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigState<L, S = BatteryState> {
    /// The plant.
    pub plant: PowertrainState<L, S>,
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

impl Rig<NoLedger, MappedBattery> {
    /// The same with a battery whose parameters depend on state of charge and temperature.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn mapped(
        vehicle: &Vehicle<MappedBatteryParams>,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        let params = &vehicle.powertrain;
        match (MappedBattery::new(params.battery, dt), params.drives.on(params.wheel, dt)) {
            (Ok(battery), Ok(axles)) => match Powertrain::of(battery, axles, params, dt) {
                Ok(plant) => Self::driven(plant, vehicle, dt),
                Err(error) => Err(error),
            },
            (Err(error), _) | (_, Err(error)) => Err(error),
        }
    }
}

impl<B: Copy> Rig<NoLedger, B> {
    /// The same, with an energy ledger.
    #[must_use]
    pub const fn with_ledger(self) -> Rig<EnergyLedger, B> {
        Rig { plant: self.plant.with_ledger(), driver: self.driver, initial_soc: self.initial_soc }
    }
}

impl<L: Copy, B: Copy> Rig<L, B> {
    const fn driven<P>(
        plant: Powertrain<L, B>,
        vehicle: &Vehicle<P>,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        match Driver::new(vehicle.driver, &vehicle.powertrain, dt) {
            Ok(driver) => Ok(Self { plant, driver, initial_soc: vehicle.initial_soc }),
            Err(error) => Err(error),
        }
    }
}

impl<L: Book, B: Pack> Rig<L, B> {
    /// The state of charge at the start.
    #[must_use]
    pub const fn initial_soc(&self) -> f32 {
        self.initial_soc
    }

    /// Standing still, with the preset's state of charge.
    ///
    /// # Errors
    /// [`ParamError::NotARatio`] where that is none.
    pub fn start(&self) -> Result<RigState<L, B::State>, ParamError> {
        let plant = self.plant.at_rest(self.initial_soc)?;
        let seen = self.plant.feedback(&plant);
        Ok(RigState { plant, driver: DriverState::default(), seen })
    }

    /// One step of driver and plant, and what the plant says of it.
    #[inline(always)]
    pub fn step(
        &self,
        state: &mut RigState<L, B::State>,
        reference: TimeTableOutput,
    ) -> PowertrainOutput {
        let command = self.driver.step(
            &mut state.driver,
            DriverInput {
                reference_m_s: reference.value,
                reference_m_s2: reference.rate_per_s,
                vehicle: state.seen,
            },
        );
        let mut input = PowertrainInput::on(command.duty);
        input.road.brake_n = command.brake_n;
        let out = self.plant.step(&mut state.plant, input);
        state.seen = Feedback::from(&out);
        out
    }
}
