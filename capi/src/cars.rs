//! A vehicle by its drives: one of a few plants, and what it remembers.
//!
//! One drive has a plant for itself, so that it costs what it costs in Rust and gives the same bits; two
//! and more are told apart at run time. What is not built in, by the features `pmsm`, `drives` and
//! `thermal`, takes no flash.

use core::mem::MaybeUninit;
use core::slice::IterMut;

use plant_core::Accum;
use plant_core::battery::{Battery, BatteryState};
#[cfg(any(feature = "drives", feature = "pmsm", feature = "thermal"))]
use plant_core::control::driver::TorqueDriver;
use plant_core::control::driver::{Driver, DriverState};
use plant_core::converter::Gates;
#[cfg(feature = "thermal")]
use plant_core::machine::Temperatures;
#[cfg(any(feature = "drives", feature = "thermal"))]
use plant_core::machine::dc::DcDrive;
use plant_core::machine::dc::DcDriveOutput;
#[cfg(feature = "thermal")]
use plant_core::machine::heated::{Heated, HeatedMachine, HeatedOutput, HeatedState};
#[cfg(feature = "pmsm")]
use plant_core::machine::pmsm::{DqCurrents, PmsmDrive, PmsmDriveOutput};
#[cfg(all(feature = "drives", feature = "pmsm"))]
use plant_core::powertrain::Either;
use plant_core::powertrain::ledger::NoLedger;
use plant_core::powertrain::{Drive, Drives, Feedback, Powertrain, PowertrainState};

use crate::params::VOLTSTEP_DRIVES;
use crate::status::VoltstepStatus;
use crate::values::{VoltstepDriveOutputs, VoltstepDriveSnapshot};

/// With temperatures, where they are built in: of a drive without them none changes.
#[cfg(all(feature = "drives", feature = "thermal"))]
type Warm<M> = Heated<M>;
#[cfg(all(feature = "drives", not(feature = "thermal")))]
type Warm<M> = M;

/// A drive of any kind.
#[cfg(all(feature = "drives", feature = "pmsm"))]
pub(crate) type AnyDrive = Either<Drive<Warm<DcDrive>>, Drive<Warm<PmsmDrive>>>;
#[cfg(all(feature = "drives", not(feature = "pmsm")))]
pub(crate) type AnyDrive = Drive<Warm<DcDrive>>;
#[cfg(feature = "drives")]
type Two = (AnyDrive, AnyDrive);
#[cfg(feature = "drives")]
type Three = (AnyDrive, Two);
#[cfg(feature = "drives")]
type Four = (Two, Two);

/// A plant and who drives it, if anyone does.
#[derive(Clone, Copy)]
pub(crate) struct Car<D, C> {
    pub plant: Powertrain<NoLedger, Battery, D>,
    pub driver: Option<C>,
}

/// What a [`Car`] remembers.
#[derive(Clone, Copy)]
pub(crate) struct Trip<D: Drives> {
    pub plant: PowertrainState<NoLedger, BatteryState, D::State>,
    pub driver: DriverState,
    /// What the driver sees: the end of the last step.
    pub seen: Feedback,
}

/// A vehicle with any drives.
pub(crate) enum Cars {
    Dc(Car<Drive, Driver>),
    #[cfg(feature = "pmsm")]
    Pmsm(Car<Drive<PmsmDrive>, TorqueDriver>),
    #[cfg(feature = "thermal")]
    HeatedDc(Car<Drive<Heated<DcDrive>>, TorqueDriver>),
    #[cfg(all(feature = "thermal", feature = "pmsm"))]
    HeatedPmsm(Car<Drive<Heated<PmsmDrive>>, TorqueDriver>),
    #[cfg(feature = "drives")]
    Two(Car<Two, TorqueDriver>),
    #[cfg(feature = "drives")]
    Three(Car<Three, TorqueDriver>),
    #[cfg(feature = "drives")]
    Four(Car<Four, TorqueDriver>),
}

/// What one of [`Cars`] remembers.
#[derive(Clone, Copy)]
pub(crate) enum Trips {
    Dc(Trip<Drive>),
    #[cfg(feature = "pmsm")]
    Pmsm(Trip<Drive<PmsmDrive>>),
    #[cfg(feature = "thermal")]
    HeatedDc(Trip<Drive<Heated<DcDrive>>>),
    #[cfg(all(feature = "thermal", feature = "pmsm"))]
    HeatedPmsm(Trip<Drive<Heated<PmsmDrive>>>),
    #[cfg(feature = "drives")]
    Two(Trip<Two>),
    #[cfg(feature = "drives")]
    Three(Trip<Three>),
    #[cfg(feature = "drives")]
    Four(Trip<Four>),
}

/// The same for each kind of a vehicle and of its trip.
macro_rules! same_kind {
    ($car:expr, $trip:expr, |$one:ident, $of:ident| $answer:expr) => {
        match ($car, $trip) {
            (Cars::Dc($one), Trips::Dc($of)) => $answer,
            #[cfg(feature = "pmsm")]
            (Cars::Pmsm($one), Trips::Pmsm($of)) => $answer,
            #[cfg(feature = "thermal")]
            (Cars::HeatedDc($one), Trips::HeatedDc($of)) => $answer,
            #[cfg(all(feature = "thermal", feature = "pmsm"))]
            (Cars::HeatedPmsm($one), Trips::HeatedPmsm($of)) => $answer,
            #[cfg(feature = "drives")]
            (Cars::Two($one), Trips::Two($of)) => $answer,
            #[cfg(feature = "drives")]
            (Cars::Three($one), Trips::Three($of)) => $answer,
            #[cfg(feature = "drives")]
            (Cars::Four($one), Trips::Four($of)) => $answer,
            #[cfg(any(feature = "drives", feature = "pmsm", feature = "thermal"))]
            _ => VoltstepStatus::StateOfOtherDrives,
        }
    };
}
pub(crate) use same_kind;

/// The same for each kind of a trip.
macro_rules! each_trip {
    ($trip:expr, |$of:ident| $answer:expr) => {
        match $trip {
            Trips::Dc($of) => $answer,
            #[cfg(feature = "pmsm")]
            Trips::Pmsm($of) => $answer,
            #[cfg(feature = "thermal")]
            Trips::HeatedDc($of) => $answer,
            #[cfg(all(feature = "thermal", feature = "pmsm"))]
            Trips::HeatedPmsm($of) => $answer,
            #[cfg(feature = "drives")]
            Trips::Two($of) => $answer,
            #[cfg(feature = "drives")]
            Trips::Three($of) => $answer,
            #[cfg(feature = "drives")]
            Trips::Four($of) => $answer,
        }
    };
}
pub(crate) use each_trip;

impl Cars {
    /// A trip that starts with a state of charge and a speed.
    pub fn start(&self, soc: f32, speed_m_s: f32) -> Result<Trips, VoltstepStatus> {
        Ok(match self {
            Self::Dc(car) => Trips::Dc(car.start(soc, speed_m_s)?),
            #[cfg(feature = "pmsm")]
            Self::Pmsm(car) => Trips::Pmsm(car.start(soc, speed_m_s)?),
            #[cfg(feature = "thermal")]
            Self::HeatedDc(car) => Trips::HeatedDc(car.start(soc, speed_m_s)?),
            #[cfg(all(feature = "thermal", feature = "pmsm"))]
            Self::HeatedPmsm(car) => Trips::HeatedPmsm(car.start(soc, speed_m_s)?),
            #[cfg(feature = "drives")]
            Self::Two(car) => Trips::Two(car.start(soc, speed_m_s)?),
            #[cfg(feature = "drives")]
            Self::Three(car) => Trips::Three(car.start(soc, speed_m_s)?),
            #[cfg(feature = "drives")]
            Self::Four(car) => Trips::Four(car.start(soc, speed_m_s)?),
        })
    }
}

impl<D: Drives, C> Car<D, C> {
    fn start(&self, soc: f32, speed_m_s: f32) -> Result<Trip<D>, VoltstepStatus> {
        let plant = self.plant.at_speed(soc, speed_m_s)?;
        let seen = self.plant.feedback(&plant);
        Ok(Trip { plant, driver: DriverState::default(), seen })
    }
}

/// Where the drives' outputs go, whatever is there.
pub(crate) type DrivePlaces = [MaybeUninit<VoltstepDriveOutputs>; VOLTSTEP_DRIVES];

/// Drives whose command, outputs and state C can read and write, one after the other.
pub(crate) trait Told: Drives {
    /// Without a driver: the command for a duty or a torque, of which what is not a number is not
    /// given; gates off where none is.
    #[inline(always)]
    fn asked(&self, duty: f32, torque_nm: f32) -> Result<Self::Command, VoltstepStatus> {
        match (duty.is_nan(), torque_nm.is_nan()) {
            (true, true) => Ok(Self::Command::default()),
            (true, false) => Ok(self.command(torque_nm)),
            (false, true) => Self::by_duty(duty),
            (false, false) => Err(VoltstepStatus::DutyNotTaken),
        }
    }
    /// The command for a duty, of drives that take one.
    fn by_duty(_duty: f32) -> Result<Self::Command, VoltstepStatus> {
        Err(VoltstepStatus::DutyNotTaken)
    }
    /// What each says of a step, into the next place.
    fn say(output: &Self::Output, places: &mut IterMut<'_, MaybeUninit<VoltstepDriveOutputs>>);
    /// What each remembers, into the next place.
    fn recall(state: &Self::State, places: &mut IterMut<'_, VoltstepDriveSnapshot>);
}

/// One drive.
pub(crate) trait Single: Drives {
    /// The command for a duty, of a drive that takes one.
    fn of_duty(_duty: f32) -> Result<Self::Command, VoltstepStatus> {
        Err(VoltstepStatus::DutyNotTaken)
    }
    /// What it says of a step.
    fn said(output: &Self::Output) -> VoltstepDriveOutputs;
    /// What it remembers.
    fn kept(state: &Self::State) -> VoltstepDriveSnapshot;
}

impl<D: Single> Told for D {
    #[inline(always)]
    fn by_duty(duty: f32) -> Result<Self::Command, VoltstepStatus> {
        Self::of_duty(duty)
    }

    #[inline(always)]
    fn say(output: &Self::Output, places: &mut IterMut<'_, MaybeUninit<VoltstepDriveOutputs>>) {
        put(places, MaybeUninit::new(Self::said(output)));
    }

    fn recall(state: &Self::State, places: &mut IterMut<'_, VoltstepDriveSnapshot>) {
        put(places, Self::kept(state));
    }
}

#[cfg(feature = "drives")]
impl<A: Told, B: Told> Told for (A, B) {
    fn say(output: &Self::Output, places: &mut IterMut<'_, MaybeUninit<VoltstepDriveOutputs>>) {
        A::say(&output.0, places);
        B::say(&output.1, places);
    }

    fn recall(state: &Self::State, places: &mut IterMut<'_, VoltstepDriveSnapshot>) {
        A::recall(&state.0, places);
        B::recall(&state.1, places);
    }
}

impl Single for Drive {
    #[inline(always)]
    fn of_duty(duty: f32) -> Result<Gates, VoltstepStatus> {
        Ok(Gates::On(duty))
    }

    #[inline(always)]
    fn said(out: &DcDriveOutput) -> VoltstepDriveOutputs {
        VoltstepDriveOutputs {
            duty: out.duty,
            motor_a: out.motor_a,
            motor_nm: out.motor_nm,
            motor_rad_s: out.motor_rad_s,
            ..VoltstepDriveOutputs::NONE
        }
    }

    fn kept(current_a: &Accum) -> VoltstepDriveSnapshot {
        VoltstepDriveSnapshot { current_a: (*current_a).into(), ..VoltstepDriveSnapshot::NONE }
    }
}

#[cfg(feature = "pmsm")]
impl Single for Drive<PmsmDrive> {
    #[inline(always)]
    fn said(out: &PmsmDriveOutput) -> VoltstepDriveOutputs {
        let (duty, motor_a) = Self::duty_and_current(out);
        VoltstepDriveOutputs {
            duty,
            motor_a,
            d_a: out.current_a.d,
            q_a: out.current_a.q,
            motor_nm: out.motor_nm,
            motor_rad_s: out.motor_rad_s,
            coarse_step: out.coarse_step,
            ..VoltstepDriveOutputs::NONE
        }
    }

    fn kept(currents: &DqCurrents) -> VoltstepDriveSnapshot {
        let (d_a, q_a) = (currents.d_a.into(), currents.q_a.into());
        VoltstepDriveSnapshot { d_a, q_a, ..VoltstepDriveSnapshot::NONE }
    }
}

#[cfg(feature = "thermal")]
impl<M: HeatedMachine> Single for Drive<Heated<M>>
where
    Drive<M>: Single<Output = M::Output, State = M::State>,
    Self: Drives<Output = HeatedOutput<M::Output>, State = HeatedState<M::State>>,
{
    #[inline(always)]
    fn said(out: &HeatedOutput<M::Output>) -> VoltstepDriveOutputs {
        let Temperatures { machine_c, inverter_c, left } = out.temperatures;
        let derated = 1.0 - left;
        VoltstepDriveOutputs { machine_c, inverter_c, derated, ..Drive::<M>::said(&out.machine) }
    }

    fn kept(state: &HeatedState<M::State>) -> VoltstepDriveSnapshot {
        VoltstepDriveSnapshot {
            machine_above_k: state.machine_above_k.into(),
            inverter_above_k: state.inverter_above_k.into(),
            ..Drive::<M>::kept(&state.machine)
        }
    }
}

#[cfg(all(feature = "drives", feature = "pmsm"))]
impl<A: Single, B: Single> Single for Either<A, B>
where
    Self: Drives<Output = Either<A::Output, B::Output>, State = (A::State, B::State)>,
{
    #[inline(always)]
    fn said(output: &Self::Output) -> VoltstepDriveOutputs {
        match output {
            Either::One(out) => A::said(out),
            Either::Other(out) => B::said(out),
        }
    }

    /// The state is that of both kinds, of which one is used.
    fn kept(state: &Self::State) -> VoltstepDriveSnapshot {
        A::kept(&state.0).or(B::kept(&state.1))
    }
}

#[inline(always)]
fn put<T>(places: &mut IterMut<'_, T>, value: T) {
    if let Some(place) = places.next() {
        *place = value;
    }
}
