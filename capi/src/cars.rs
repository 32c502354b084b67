//! A vehicle by its drives: one of a few plants, and what it remembers.
//!
//! One DC drive has a plant for itself, so that it costs what it costs in Rust; two and more are told
//! apart at run time. What is not built in, by the features `pmsm` and `drives`, takes no flash.

use core::mem::MaybeUninit;
use core::slice::IterMut;

use plant_core::Accum;
use plant_core::battery::{Battery, BatteryState};
#[cfg(any(feature = "drives", feature = "pmsm"))]
use plant_core::control::driver::TorqueDriver;
use plant_core::control::driver::{Driver, DriverState};
use plant_core::converter::Gates;
use plant_core::machine::dc::DcDriveOutput;
#[cfg(feature = "pmsm")]
use plant_core::machine::pmsm::{DqCurrents, PmsmDrive, PmsmDriveOutput};
#[cfg(all(feature = "drives", feature = "pmsm"))]
use plant_core::powertrain::Either;
use plant_core::powertrain::ledger::NoLedger;
use plant_core::powertrain::{Drive, Drives, Feedback, Powertrain, PowertrainState};

use crate::params::VOLTSTEP_DRIVES;
use crate::status::VoltstepStatus;
use crate::values::{VoltstepDriveOutputs, VoltstepDriveSnapshot};

/// A drive of either kind.
#[cfg(all(feature = "drives", feature = "pmsm"))]
pub(crate) type AnyDrive = Either<Drive, Drive<PmsmDrive>>;
#[cfg(all(feature = "drives", not(feature = "pmsm")))]
pub(crate) type AnyDrive = Drive;
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
            #[cfg(feature = "drives")]
            (Cars::Two($one), Trips::Two($of)) => $answer,
            #[cfg(feature = "drives")]
            (Cars::Three($one), Trips::Three($of)) => $answer,
            #[cfg(feature = "drives")]
            (Cars::Four($one), Trips::Four($of)) => $answer,
            #[cfg(any(feature = "drives", feature = "pmsm"))]
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
    fn asked(&self, duty: f32, torque_nm: f32) -> Result<Self::Command, VoltstepStatus> {
        match (duty.is_nan(), torque_nm.is_nan()) {
            (true, true) => Ok(Self::Command::default()),
            (true, false) => Ok(self.command(torque_nm)),
            (false, _) => Err(VoltstepStatus::DutyNotTaken),
        }
    }
    /// What each says of a step, into the next place.
    fn say(output: &Self::Output, places: &mut IterMut<'_, MaybeUninit<VoltstepDriveOutputs>>);
    /// What the winding of each remembers, into the next place.
    fn recall(state: &Self::State, places: &mut IterMut<'_, VoltstepDriveSnapshot>);
}

impl Told for Drive {
    #[inline(always)]
    fn asked(&self, duty: f32, torque_nm: f32) -> Result<Gates, VoltstepStatus> {
        match (duty.is_nan(), torque_nm.is_nan()) {
            (true, true) => Ok(Gates::Off),
            (true, false) => Ok(Gates::Torque(torque_nm)),
            (false, true) => Ok(Gates::On(duty)),
            (false, false) => Err(VoltstepStatus::DutyNotTaken),
        }
    }

    #[inline(always)]
    fn say(out: &DcDriveOutput, places: &mut IterMut<'_, MaybeUninit<VoltstepDriveOutputs>>) {
        put(
            places,
            MaybeUninit::new(VoltstepDriveOutputs {
                duty: out.duty,
                motor_a: out.motor_a,
                motor_nm: out.motor_nm,
                motor_rad_s: out.motor_rad_s,
                ..VoltstepDriveOutputs::NONE
            }),
        );
    }

    fn recall(current_a: &Accum, places: &mut IterMut<'_, VoltstepDriveSnapshot>) {
        let current_a = (*current_a).into();
        put(places, VoltstepDriveSnapshot { current_a, ..VoltstepDriveSnapshot::NONE });
    }
}

#[cfg(feature = "pmsm")]
impl Told for Drive<PmsmDrive> {
    fn say(out: &PmsmDriveOutput, places: &mut IterMut<'_, MaybeUninit<VoltstepDriveOutputs>>) {
        let (duty, motor_a) = Self::duty_and_current(out);
        put(
            places,
            MaybeUninit::new(VoltstepDriveOutputs {
                duty,
                motor_a,
                d_a: out.current_a.d,
                q_a: out.current_a.q,
                motor_nm: out.motor_nm,
                motor_rad_s: out.motor_rad_s,
                coarse_step: out.coarse_step,
            }),
        );
    }

    fn recall(currents: &DqCurrents, places: &mut IterMut<'_, VoltstepDriveSnapshot>) {
        let (d_a, q_a) = (currents.d_a.into(), currents.q_a.into());
        put(places, VoltstepDriveSnapshot { d_a, q_a, ..VoltstepDriveSnapshot::NONE });
    }
}

#[cfg(all(feature = "drives", feature = "pmsm"))]
impl Told for AnyDrive {
    fn say(output: &Self::Output, places: &mut IterMut<'_, MaybeUninit<VoltstepDriveOutputs>>) {
        match output {
            Either::One(out) => <Drive as Told>::say(out, places),
            Either::Other(out) => Drive::<PmsmDrive>::say(out, places),
        }
    }

    /// The state is that of both kinds, of which one is used.
    fn recall(state: &Self::State, places: &mut IterMut<'_, VoltstepDriveSnapshot>) {
        let (current_a, d_a, q_a) = (state.0.into(), state.1.d_a.into(), state.1.q_a.into());
        put(places, VoltstepDriveSnapshot { current_a, d_a, q_a });
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

#[inline(always)]
fn put<T>(places: &mut IterMut<'_, T>, value: T) {
    if let Some(place) = places.next() {
        *place = value;
    }
}
