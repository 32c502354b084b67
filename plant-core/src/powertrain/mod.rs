//! The coupled plant: battery, auxiliary load, converter, motor, gearbox, wheel, body.
//!
//! One walk down the chain eliminates everything but the vehicle's speed increment; one walk back
//! settles each state from it. No iteration, except a bounded one when a battery limit acts.

mod limit;
mod output;

pub use output::{Limited, PowertrainOutput};

use core::marker::PhantomData;

use crate::auxiliary::{Auxiliary, AuxiliaryParams};
use crate::battery::{Battery, BatteryParams, BatteryState, CurrentLimits};
use crate::body::{Body, BodyParams, BodyState, Motion, Resistance, Road};
use crate::converter::{Converter, ConverterParams};
use crate::dc_motor::{DcMotor, DcMotorParams};
use crate::driver::Feedback;
use crate::energy::{Book, EnergyLedger, EnergyReport, NoLedger, Stored};
use crate::error::{ParamError, check};
use crate::gearbox::{Gearbox, GearboxParams};
use crate::model::{Dt, Model};
use crate::num::{Accum, LARGEST, Real};
use crate::port::{RoadLaw, Source};
use crate::wheel::{Wheel, WheelParams};

/// What is known about a powertrain: the parameters of its components.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct PowertrainParams {
    /// The battery.
    pub battery: BatteryParams,
    /// What else draws from it.
    #[cfg_attr(feature = "serde", serde(default))]
    pub auxiliary: AuxiliaryParams,
    /// The converter.
    #[cfg_attr(feature = "serde", serde(default))]
    pub converter: ConverterParams,
    /// The motor.
    pub motor: DcMotorParams,
    /// The gearbox.
    pub gearbox: GearboxParams,
    /// The wheels.
    pub wheel: WheelParams,
    /// The body.
    pub body: BodyParams,
}

/// The coupled plant, discretised for one step; `L` says whether it keeps an energy ledger.
///
/// For a given duty and given forces a step is stable for any `h` and any physical parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Powertrain<L = NoLedger> {
    battery: Battery,
    auxiliary: Auxiliary,
    converter: Converter,
    motor: DcMotor,
    gearbox: Gearbox,
    wheel: Wheel,
    body: Body,
    dt_s: Real,
    /// Motor turns (rad) per metre of road.
    motor_rad_per_m: Real,
    /// Everything that moves with the vehicle, as mass \[kg\].
    moving_mass_kg: Real,
    ledger: PhantomData<L>,
}

/// The state of a [`Powertrain`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PowertrainState<L = NoLedger> {
    /// The battery.
    pub battery: BatteryState,
    /// Winding current \[A\].
    pub current_a: Accum,
    /// Speed and distance.
    pub body: BodyState,
    /// Voltage at the battery's terminals at the last step \[V\].
    pub battery_v: Real,
    /// The books, or nothing.
    pub ledger: L,
}

/// What drives a [`Powertrain`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PowertrainInput {
    /// Commanded duty of the converter.
    pub duty: Real,
    /// Slope, wind and friction brake.
    pub road: Road,
    /// Auxiliary power beside the parameter \[W\], ≥ 0.
    pub auxiliary_w: Real,
}

/// Where a step starts from, as far as the solution depends on it.
#[derive(Clone, Copy)]
struct Start {
    speed_m_s: Real,
    current_a: Real,
    /// What the battery offers once the auxiliary loads have drawn.
    bus: Source,
    converter_ohm: Real,
    resistance: Resistance,
}

/// What one duty leads to.
#[derive(Clone, Copy)]
struct Solution {
    motion: Motion,
    current_increment_a: Real,
    /// Current into the converter \[A\].
    drive_a: Real,
    battery_v: Real,
}

impl Powertrain<NoLedger> {
    /// Checks `params` and discretises them for steps of `dt`; keeps no ledger.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: PowertrainParams, dt: Dt) -> Result<Self, ParamError> {
        Self::checked(params, dt)
    }
}

impl Powertrain<EnergyLedger> {
    /// Checks `params` and discretises them for steps of `dt`; keeps an energy ledger.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn with_ledger(params: PowertrainParams, dt: Dt) -> Result<Self, ParamError> {
        Self::checked(params, dt)
    }

    /// Where the energy went between the state `start` and the state `now`, which came from it.
    #[must_use]
    pub fn energy(
        &self,
        start: &PowertrainState<EnergyLedger>,
        now: &PowertrainState<EnergyLedger>,
    ) -> EnergyReport {
        let discharged_j = self.battery.discharged_energy_j(&start.battery, &now.battery);
        now.ledger.report(self.stored(now), discharged_j)
    }
}

impl<L: Book> Powertrain<L> {
    const fn checked(params: PowertrainParams, dt: Dt) -> Result<Self, ParamError> {
        let motor = check!(DcMotor::new(params.motor, dt));
        let gearbox = check!(Gearbox::new(params.gearbox, dt));
        let wheel = check!(Wheel::new(params.wheel, dt));
        let body = check!(Body::new(params.body, dt));
        let motor_rad_per_m = gearbox.ratio * wheel.per_radius;
        Ok(Self {
            battery: check!(Battery::new(params.battery, dt)),
            auxiliary: check!(Auxiliary::new(params.auxiliary)),
            converter: check!(Converter::new(params.converter)),
            dt_s: dt.s(),
            motor_rad_per_m,
            moving_mass_kg: body.mass_kg
                + wheel.mass_kg
                + (motor.inertia_kg_m2 + gearbox.inertia_kg_m2)
                    * (motor_rad_per_m * motor_rad_per_m),
            motor,
            gearbox,
            wheel,
            body,
            ledger: PhantomData,
        })
    }

    /// A rested plant that stands still with its battery at `soc`.
    ///
    /// # Errors
    /// [`ParamError::NotARatio`] for a state of charge outside 0..1.
    pub fn at_rest(&self, soc: Real) -> Result<PowertrainState<L>, ParamError> {
        self.at_speed(soc, 0.0)
    }

    /// A plant that rolls at `speed_m_s` without current, its battery rested at `soc`.
    ///
    /// # Errors
    /// [`ParamError::NotARatio`] for a state of charge outside 0..1,
    /// [`ParamError::NotFinite`] for a bad speed.
    pub fn at_speed(&self, soc: Real, speed_m_s: Real) -> Result<PowertrainState<L>, ParamError> {
        let speed_m_s = Accum::new(crate::error::finite("speed_m_s", speed_m_s)?);
        let battery = BatteryState::rested(soc)?;
        let mut state = PowertrainState {
            battery,
            current_a: Accum::new(0.0),
            body: BodyState { speed_m_s, distance_m: Accum::new(0.0) },
            battery_v: self.battery.offer(&battery).0.emf_v,
            ledger: L::default(),
        };
        state.ledger = L::starting_with(self.stored(&state));
        Ok(state)
    }

    /// Energy held in motion and fields.
    fn stored(&self, state: &PowertrainState<L>) -> Stored {
        let v = state.body.speed_m_s.get();
        let i = state.current_a.get();
        let rc_v = state.battery.rc.voltage_v.get();
        Stored {
            kinetic: 0.5 * self.moving_mass_kg * v * v,
            inductive: 0.5 * self.motor.inductance_h * i * i,
            capacitive: 0.5 * self.battery.rc.capacitance_f * rc_v * rc_v,
        }
    }

    /// What a driver sees of a state before its first step.
    #[must_use]
    pub const fn feedback(&self, state: &PowertrainState<L>) -> Feedback {
        Feedback {
            speed_m_s: state.body.speed_m_s.get(),
            motor_a: state.current_a.get(),
            battery_v: state.battery_v,
            soc: state.battery.soc.get(),
            duty: 0.0,
            limited: false,
        }
    }

    /// The battery model inside.
    #[must_use]
    pub const fn battery(&self) -> &Battery {
        &self.battery
    }

    /// Motor speed per road speed \[rad/m\].
    #[must_use]
    pub const fn motor_rad_per_m(&self) -> Real {
        self.motor_rad_per_m
    }

    /// What one duty leads to: down the chain, one equation, and back to the currents.
    #[inline]
    fn solve(&self, start: &Start, duty: Real) -> Solution {
        let seen = Converter::seen_through(start.bus, duty, start.converter_ohm);
        let motor_rad_s = self.motor_rad_per_m * start.speed_m_s;
        let (shaft, winding) = self.motor.law(seen, start.current_a, motor_rad_s);
        let axle = self.wheel.law(self.gearbox.law(shaft), start.speed_m_s);
        let motion = start.resistance.solve(axle, start.speed_m_s);
        let current_increment_a = winding.increment_a(self.motor_rad_per_m * motion.increment_m_s);
        let drive_a = duty * (start.current_a + current_increment_a);
        Solution { motion, current_increment_a, drive_a, battery_v: start.bus.voltage_v(drive_a) }
    }

    /// The axle when the winding carries no torque.
    fn coasting_axle(&self, start: &Start) -> RoadLaw {
        let motor_rad_s = self.motor_rad_per_m * start.speed_m_s;
        let shaft = self.motor.coast_law(start.current_a, motor_rad_s);
        self.wheel.law(self.gearbox.law(shaft), start.speed_m_s)
    }

    /// Advances by one step.
    #[inline]
    pub fn step(&self, state: &mut PowertrainState<L>, input: PowertrainInput) -> PowertrainOutput {
        let (i, v) = (state.current_a.get(), state.body.speed_m_s.get());
        let duty = self.converter.allowed_duty(input.duty);

        // Down: what the terminals offer, and what the auxiliary loads leave of it.
        let (source, open_circuit_v) = self.battery.offer(&state.battery);
        let limits = self.battery.limits(&state.battery);
        let mut load_a = self.auxiliary.constant_power_a(input.auxiliary_w, state.battery_v);
        let converter_s = self.converter.shunt_s(state.battery_v);
        let mut load_s = self.auxiliary.conductance_s + converter_s;
        let starved = limits.discharge_a < load_a + load_s * state.battery_v;
        if starved {
            (load_a, load_s) = (0.0, 0.0);
        }
        let start = Start {
            speed_m_s: v,
            current_a: i,
            bus: if load_a + load_s > 0.0 { source.loaded(load_a, load_s) } else { source },
            converter_ohm: self.converter.series_ohm(i),
            resistance: self.body.resistance(&input.road, v),
        };

        let mut applied = duty;
        let mut solution = self.solve(&start, duty);
        let battery_a = |s: &Solution| s.drive_a + load_a + load_s * s.battery_v;
        let mut limited = Limited::No;
        let drawn_a = battery_a(&solution);
        if drawn_a > limits.discharge_a || drawn_a < -limits.charge_a {
            let charge = drawn_a < 0.0;
            limited = if charge { Limited::Charge } else { Limited::Discharge };
            let allowed_a = drive_limit_a(source, limits, charge, load_a, load_s);
            (applied, solution) = self.hold_limit(&start, duty, solution, allowed_a);
        }
        let battery_a = battery_a(&solution);

        // One check of everything that is about to enter a state.
        let magnitude = input.duty.abs()
            + input.auxiliary_w.abs()
            + input.road.magnitude()
            + solution.current_increment_a.abs()
            + solution.motion.increment_m_s.abs()
            + battery_a.abs()
            + solution.battery_v.abs();
        let accepted = magnitude + i.abs() + v.abs() <= LARGEST
            && input.road.brake_n >= 0.0
            && input.auxiliary_w >= 0.0;
        if !accepted {
            return self.rejected(state, open_circuit_v);
        }

        // Back: each state from the solution.
        let rc_before_v = state.battery.rc.voltage_v.get();
        state.current_a.add(solution.current_increment_a);
        Body::settle(&mut state.body, solution.motion, self.dt_s);
        self.battery.settle(&mut state.battery, battery_a);
        state.battery_v = solution.battery_v;

        let out = PowertrainOutput {
            rejected: false,
            duty: applied,
            limited,
            auxiliary_starved: starved,
            slip: solution.motion.slip,
            speed_m_s: state.body.speed_m_s.get(),
            distance_m: state.body.distance_m.get(),
            soc: state.battery.soc.get(),
            battery_a,
            battery_v: solution.battery_v,
            open_circuit_v,
            motor_a: state.current_a.get(),
            motor_nm: self.motor.torque_nm_per_a * state.current_a.get(),
            motor_rad_s: self.motor_rad_per_m * state.body.speed_m_s.get(),
            flows: self.flows(
                state,
                &input,
                &start,
                &solution,
                open_circuit_v,
                output::Loads {
                    auxiliary_w: (load_a
                        + if starved { 0.0 } else { self.auxiliary.conductance_s }
                            * solution.battery_v)
                        * solution.battery_v,
                    converter_w: if starved { 0.0 } else { converter_s }
                        * solution.battery_v
                        * solution.battery_v,
                    battery_a,
                    rc_increment_v: state.battery.rc.voltage_v.get() - rc_before_v,
                },
            ),
        };
        state.ledger.book(&out.flows, self.dt_s);
        out
    }
}

/// What is left for the drive when the battery is at its limit, positive when discharging \[A\].
#[inline]
const fn drive_limit_a(
    source: Source,
    limits: CurrentLimits,
    charge: bool,
    load_a: Real,
    load_s: Real,
) -> Real {
    let battery_a = if charge { -limits.charge_a } else { limits.discharge_a };
    let left_a = battery_a - load_a - load_s * source.voltage_v(battery_a);
    if charge { left_a } else { crate::num::max(left_a, 0.0) }
}

impl<L: Book> Model for Powertrain<L> {
    type State = PowertrainState<L>;
    type Input = PowertrainInput;
    type Output = PowertrainOutput;

    #[inline]
    fn step(&self, state: &mut Self::State, input: PowertrainInput) -> PowertrainOutput {
        Self::step(self, state, input)
    }
}
