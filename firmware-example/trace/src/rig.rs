//! A vehicle with its driver in a closed loop.

use plant_core::battery::{
    Battery, BatteryParams, BatteryState, MappedBattery, MappedBatteryParams, Pack,
};
use plant_core::control::driver::{
    Driver, DriverInput, DriverParams, DriverState, Steering, TorqueDriver,
};
use plant_core::powertrain::ledger::{Book, EnergyLedger, NoLedger};
use plant_core::powertrain::{
    Axles, Drive, Drives, Feedback, Powertrain, PowertrainInput, PowertrainOutput, PowertrainState,
};
use plant_core::presets::Vehicle;
use plant_core::signal::sources::TimeTableOutput;
use plant_core::{Accum, Dt, ParamError};

/// A plant and who drives it.
#[derive(Clone, Copy, Debug)]
pub struct Rig<L, B = Battery, D = Drive, C = Driver> {
    /// The plant.
    pub plant: Powertrain<L, B, D>,
    /// The driver.
    pub driver: C,
    initial_soc: f32,
}

/// What a [`Rig`] remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigState<L, S = BatteryState, E = Accum> {
    /// The plant.
    pub plant: PowertrainState<L, S, E>,
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

impl<D: Copy> Rig<NoLedger, Battery, D, TorqueDriver> {
    /// A vehicle with any drives.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range; `driver.torque` where the driver
    /// is none that asks for a torque.
    pub const fn composed<Q>(
        vehicle: &Vehicle<BatteryParams, Q>,
        axles: Axles<D>,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        let params = &vehicle.powertrain;
        let DriverParams::Torque(driver) = vehicle.driver else {
            return Err(ParamError::NotFinite("driver.torque"));
        };
        let motor_rad_per_m = axles.motor_rad_per_m();
        let plant = match Battery::new(params.battery, dt) {
            Ok(battery) => Powertrain::of(battery, axles, params, dt),
            Err(error) => Err(error),
        };
        let plant = match plant {
            Ok(plant) => plant,
            Err(error) => return Err(error),
        };
        let (body_kg, moving_kg) = (params.body.mass_kg, plant.moving_mass_kg());
        match TorqueDriver::fitted(driver, motor_rad_per_m, body_kg, moving_kg, dt) {
            Ok(driver) => Ok(Self { plant, driver, initial_soc: vehicle.initial_soc }),
            Err(error) => Err(error),
        }
    }
}

impl<B: Copy, D: Copy, C: Copy> Rig<NoLedger, B, D, C> {
    /// The same, with an energy ledger.
    #[must_use]
    pub const fn with_ledger(self) -> Rig<EnergyLedger, B, D, C> {
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

impl<L: Book, B: Pack, D: Drives, C: Steering<D>> Rig<L, B, D, C> {
    /// The state of charge at the start.
    #[must_use]
    pub const fn initial_soc(&self) -> f32 {
        self.initial_soc
    }

    /// Standing still, with the preset's state of charge.
    ///
    /// # Errors
    /// [`ParamError::NotARatio`] where that is none.
    pub fn start(&self) -> Result<RigState<L, B::State, D::State>, ParamError> {
        let plant = self.plant.at_rest(self.initial_soc)?;
        let seen = self.plant.feedback(&plant);
        Ok(RigState { plant, driver: DriverState::default(), seen })
    }

    /// What the driver makes of the reference, and whether it refused it.
    #[inline(always)]
    pub fn steer(
        &self,
        state: &mut RigState<L, B::State, D::State>,
        reference: TimeTableOutput,
    ) -> (PowertrainInput<D::Command>, bool) {
        let input = DriverInput {
            reference_m_s: reference.value,
            reference_m_s2: reference.rate_per_s,
            vehicle: state.seen,
        };
        let steered = self.driver.steer(&mut state.driver, input, self.plant.drives());
        let mut input = PowertrainInput::with(steered.command);
        input.road.brake_n = steered.brake_n;
        (input, steered.rejected)
    }

    /// One step of driver and plant, and what the plant says of it.
    #[inline(always)]
    pub fn step(
        &self,
        state: &mut RigState<L, B::State, D::State>,
        reference: TimeTableOutput,
    ) -> PowertrainOutput<D::Output> {
        let (input, _) = self.steer(state, reference);
        let out = self.plant.step(&mut state.plant, input);
        state.seen = self.plant.seen_of(&out);
        out
    }
}
