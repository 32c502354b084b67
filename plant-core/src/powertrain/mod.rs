//! The coupled plant: battery, auxiliary load, converter, motor, gearbox, wheel, body.
//!
//! # Equations
//! With D the duty, i the winding current, v the speed of the road, k the motor's turns (rad) per
//! metre (`motor_rad_per_m`), m all that moves as mass (`moving_mass_kg`) and b all that is
//! viscous, seen from the road (`coast`), the components are coupled by
//!
//! ```text
//! battery    V = V_oc(SOC) − V_rc − R_s·I     dSOC/dt = −I/(3600·Q)    C·dV_rc/dt = I − V_rc/R_p
//! bus        I = D·i + P/V + V/R_aux + P_0/V                  auxiliary loads, converter's loss
//! winding    L·di/dt = D·V − (R + R_c)·i − V_d·sgn(i) − Ke·k·v     R_c, V_d: converter
//!            set-valued at i = 0; gates off: D = −sgn(i), and nothing flows into the winding
//! road       m·dv/dt = Kt·k·i − c·|v + w|·(v + w) − b·v − M·g·sin α − F_c·sgn(v)
//!            F_c = C_r·M·g·cos α + F_brake + Coulomb friction + gears' loss, set-valued at v = 0
//! ```
//!
//! \[EPowertrain2025, eq. 3.2 to 3.15 and 4.2 to 4.7, errata applied\]; each component's own header
//! says where an equation comes from.
//!
//! # One step
//! What is linear in the new state is taken implicitly; `V_oc`, `|v + w|`, `|i|` of the gears' loss
//! and `V` of the constant powers at the old one. So a step is stable for any h. One walk down the
//! chain eliminates everything but the increment Δv (`i`, `v` are the old values):
//!
//! ```text
//! Battery::offer              V  = emf − resistance·I         RC branch eliminated      source
//! Source::loaded              V  = emf − resistance·D·i'      loads eliminated          bus
//! Converter::seen_through     D·emf ∓ V_d behind D²·resistance + R_c                    seen
//!                             within V_d of no current, none: i' = 0                    blocked
//! Winding::law                Y  = 1/(L/h + R + seen.resistance)               admittance_s
//!                             Δi = Y·(seen.emf − (R + seen.resistance)·i − Ke·k·v) − Y·Ke·k·Δv
//!                                = free_a − per_speed·Δv                                current
//!                             F  = Kt·k·(i + free_a) − Kt·Ke·k²·Y·Δv = effort − slope·Δv  drive
//! Body::resistance            force = −(c·|v + w|·(v + w) + b·v + M·g·sin α)       resistance
//!                             slope = m/h + b + c·|v + w|      friction = F_c
//! project                     Δv = (force + effort ∓ friction)/(slope + drive.slope)   motion
//! ```
//!
//! `project` takes v to exactly 0 where friction holds it. One walk back settles each state:
//! `Δi = free_a − per_speed·Δv`, `I` and `V` on the bus, SOC, distance. No iteration, except
//! a bounded one when a limit acts ([`Limited`]). In one line, with `a11 = L/h + R_total`
//! and `a22 = m/h + c·|v + w| + b`, it is the solution of the two by two system whose determinant
//! is `a11·a22 + Ke·Kt·k²`.
//!
//! The reduction is ours, as are port laws ([`port`](crate::port)), limits and ledger.
//!
//! Tests: `tests` below (the equations above, written again in double precision, at the end of each
//! step); all `properties`; order of convergence in `tests/tests/order.rs`; rounding in
//! `tests/tests/rounding.rs`; a second tool in `tests/tests/second_reference.rs`; cases "UDDS",
//! "trip", "converter bench".

mod input;
pub mod ledger;
mod limit;
mod output;
mod params;
mod solve;

pub use input::PowertrainInput;
pub use output::{Feedback, Limited, PowertrainOutput};
pub use params::PowertrainParams;

use core::marker::PhantomData;

use crate::auxiliary::Auxiliary;
use crate::battery::{Battery, BatteryState, MappedBattery, MappedBatteryParams, Pack};
use crate::converter::{Converter, Gates};
use crate::error::{ParamError, check};
use crate::machine::dc::{DcMotor, Winding};
use crate::mechanics::body::{Body, BodyState};
use crate::mechanics::gearbox::Gearbox;
use crate::mechanics::wheel::Wheel;
use crate::model::{Dt, Model};
use crate::num::{Accum, Real, min, sound};
use crate::port::Coast;
use crate::powertrain::ledger::{Book, EnergyLedger, EnergyReport, NoLedger, Stored};
use crate::powertrain::solve::Solution;

/// The coupled plant, discretised for one step; `L` says whether it keeps an energy ledger, `B`
/// which battery it has.
///
/// For a given duty and given forces a step is stable for any `h` and any physical parameter. So it
/// is where a limit acts: the current stands at the limit; one that was beyond it already, as when
/// the limit falls, decays with the winding's L/R.
///
/// ```
/// use plant_core::powertrain::ledger::EnergyLedger;
/// use plant_core::powertrain::{Powertrain, PowertrainInput};
/// use plant_core::{Dt, ParamError, must, presets};
///
/// const CAR: Powertrain<EnergyLedger> = must!(Powertrain::with_ledger(
///     presets::EPOWERTRAIN_UDDS.powertrain,
///     must!(Dt::from_s(0.001)),
/// ));
///
/// let start = CAR.at_rest(0.8)?;
/// let mut state = start;
/// for _ in 0..5000 {
///     CAR.step(&mut state, PowertrainInput::on(0.1));
/// }
/// assert!(state.body.speed_m_s.get() > 5.0);
/// let energy = CAR.energy(&start, &state);
/// assert!(energy.kinetic > 0.0 && energy.copper > 0.0 && energy.drag > 0.0);
/// assert!(energy.residual_rel().abs() < 1e-5); // every joule is named
/// # Ok::<(), ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Powertrain<L = NoLedger, B = Battery> {
    battery: B,
    auxiliary: Auxiliary,
    converter: Converter,
    /// The motor's electrical side, seen from the road.
    winding: Winding,
    /// All that moves and rubs, seen from the road.
    coast: Coast,
    /// Loss of the gears as friction at the road, per motor current \[N/A\].
    gear_loss_n_per_a: Real,
    body: Body,
    dt_s: Real,
    /// Motor turns (rad) per metre of road.
    motor_rad_per_m: Real,
    torque_nm_per_a: Real,
    inductance_h: Real,
    /// Neither auxiliary loads nor losses of the converter: a step need not look for them.
    plain: bool,
    ledger: PhantomData<L>,
}

/// The state of a [`Powertrain`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PowertrainState<L = NoLedger, S = BatteryState> {
    /// The battery.
    pub battery: S,
    /// Winding current \[A\].
    pub current_a: Accum,
    /// Speed and distance.
    pub body: BodyState,
    /// Voltage at the battery's terminals at the last step \[V\].
    pub battery_v: Real,
    /// How long the constant auxiliary power still stays cut out \[s\]; 0 where it is not.
    pub cut_out_s: Real,
    /// The books, or nothing.
    pub ledger: L,
}

impl Powertrain<NoLedger> {
    /// Checks `params` and discretises them for steps of `dt`; keeps no ledger.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: PowertrainParams, dt: Dt) -> Result<Self, ParamError> {
        Self::assembled(check!(Battery::new(params.battery, dt)), &params, dt)
    }
}

impl Powertrain<NoLedger, MappedBattery> {
    /// The same with a battery whose parameters depend on state of charge and temperature.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn mapped(
        params: PowertrainParams<MappedBatteryParams>,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        Self::assembled(check!(MappedBattery::new(params.battery, dt)), &params, dt)
    }
}

impl Powertrain<EnergyLedger, MappedBattery> {
    /// The same with a ledger.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn mapped_with_ledger(
        params: PowertrainParams<MappedBatteryParams>,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        Self::assembled(check!(MappedBattery::new(params.battery, dt)), &params, dt)
    }
}

impl Powertrain<EnergyLedger> {
    /// Checks `params` and discretises them for steps of `dt`; keeps an energy ledger.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn with_ledger(params: PowertrainParams, dt: Dt) -> Result<Self, ParamError> {
        Self::assembled(check!(Battery::new(params.battery, dt)), &params, dt)
    }
}

impl<B: Pack> Powertrain<EnergyLedger, B> {
    /// Where the energy went between the state `start` and the state `now`, which came from it.
    #[must_use]
    pub fn energy(
        &self,
        start: &PowertrainState<EnergyLedger, B::State>,
        now: &PowertrainState<EnergyLedger, B::State>,
    ) -> EnergyReport {
        let discharged_j = self.battery.discharged_energy_j(&start.battery, &now.battery);
        now.ledger.report(&self.flow_factors(), self.dt_s, self.stored(now), discharged_j)
    }
}

impl<L: Book, B: Pack> Powertrain<L, B> {
    const fn assembled<P>(
        battery: B,
        params: &PowertrainParams<P>,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        let motor = check!(DcMotor::new(params.motor, dt));
        let gearbox = check!(Gearbox::new(params.gearbox, dt));
        let wheel = check!(Wheel::new(params.wheel, dt));
        let body = check!(Body::new(params.body, dt));
        let auxiliary = check!(Auxiliary::new(params.auxiliary));
        let converter = check!(Converter::new(params.converter));
        let motor_rad_per_m = gearbox.ratio * wheel.per_radius;
        Ok(Self {
            battery,
            winding: motor.winding().reflected(motor_rad_per_m),
            coast: wheel.coast(gearbox.coast(motor.coast())).plus(body.coast()),
            gear_loss_n_per_a: gearbox.loss_ratio()
                * motor.winding().effort_per_a
                * wheel.per_radius,
            body,
            dt_s: dt.s(),
            motor_rad_per_m,
            torque_nm_per_a: motor.winding().effort_per_a,
            inductance_h: motor.inductance_h,
            plain: auxiliary.is_none() && converter.is_ideal(),
            auxiliary,
            converter,
            ledger: PhantomData,
        })
    }

    /// A rested plant that stands still with its battery at `soc`.
    ///
    /// # Errors
    /// [`ParamError::NotARatio`] for a state of charge outside 0..1.
    pub fn at_rest(&self, soc: Real) -> Result<PowertrainState<L, B::State>, ParamError> {
        self.at_speed(soc, 0.0)
    }

    /// A plant that rolls at `speed_m_s` without current, its battery rested at `soc`.
    ///
    /// # Errors
    /// [`ParamError::NotARatio`] for a state of charge outside 0..1,
    /// [`ParamError::NotFinite`] for a bad speed.
    pub fn at_speed(
        &self,
        soc: Real,
        speed_m_s: Real,
    ) -> Result<PowertrainState<L, B::State>, ParamError> {
        let speed_m_s = Accum::new(crate::error::finite("speed_m_s", speed_m_s)?);
        let battery = self.battery.rested(soc)?;
        let mut state = PowertrainState {
            battery,
            current_a: Accum::new(0.0),
            body: BodyState { speed_m_s, distance_m: Accum::new(0.0) },
            battery_v: self.battery.offer(&battery).0.emf_v,
            cut_out_s: 0.0,
            ledger: L::default(),
        };
        state.ledger = L::starting_with(self.stored(&state));
        Ok(state)
    }

    /// Energy held in motion and fields.
    fn stored(&self, state: &PowertrainState<L, B::State>) -> Stored {
        let v = state.body.speed_m_s.get();
        let i = state.current_a.get();
        Stored {
            kinetic: 0.5 * self.moving_mass_kg() * v * v,
            inductive: 0.5 * self.inductance_h * i * i,
            capacitive: self.battery.capacitive_j(&state.battery),
        }
    }

    /// What a driver sees of a state before its first step.
    #[must_use]
    pub fn feedback(&self, state: &PowertrainState<L, B::State>) -> Feedback {
        Feedback {
            speed_m_s: state.body.speed_m_s.get(),
            motor_a: state.current_a.get(),
            battery_v: state.battery_v,
            soc: B::soc(&state.battery),
            duty: 0.0,
            limited: false,
            slope_sin: 0.0,
        }
    }

    /// The battery model inside.
    #[must_use]
    pub const fn battery(&self) -> &B {
        &self.battery
    }

    /// Motor speed per road speed \[rad/m\].
    #[must_use]
    pub const fn motor_rad_per_m(&self) -> Real {
        self.motor_rad_per_m
    }

    /// Everything that moves with the vehicle, as mass \[kg\].
    #[must_use]
    pub const fn moving_mass_kg(&self) -> Real {
        self.coast.inertia_per_h * self.dt_s
    }

    /// Whether a solution keeps every limit, with gates on.
    ///
    /// A winding's field that grows hides what the battery will be charged with once it has grown:
    /// that counts too.
    #[inline(always)]
    fn keeps_limits(
        &self,
        i: Real,
        solution: &Solution,
        next: &B::State,
        input: &PowertrainInput,
    ) -> bool {
        let (reached_a, battery_a) = (i + solution.current_increment_a, solution.battery_a);
        let field_w = self.winding.inductance_per_h_ohm * solution.current_increment_a * reached_a;
        let least_a = min(battery_a, battery_a - field_w / solution.battery_v);
        // Asked as what breaks a limit: beyond an infinite one there is nothing to compare. What is
        // not a number is refused further on.
        let broken = input.gates == Gates::Off
            || reached_a.abs() > self.converter.params.current_limit_a
            || battery_a > input.limits.discharge_a
            || least_a < -input.limits.charge_a;
        !broken && self.battery.allows(battery_a, least_a, next)
    }

    /// Advances by one step.
    #[inline(always)]
    pub fn step(
        &self,
        state: &mut PowertrainState<L, B::State>,
        input: PowertrainInput,
    ) -> PowertrainOutput {
        let (i, v) = (state.current_a.get(), state.body.speed_m_s.get());
        let mut resistance = self.body.resistance(&input.road, self.coast, v);
        if self.gear_loss_n_per_a > 0.0 {
            resistance.friction_n += self.gear_loss_n_per_a * i.abs();
        }
        let (mut start, source, open_circuit_v) = self.start(state, input.auxiliary_w, resistance);
        let asked = input.gates.duty();
        let commanded = self.converter.allowed_duty(asked);
        let mut solution = self.solve(&start, commanded);
        let mut battery = self.battery.next(&state.battery, solution.battery_a);
        let mut limited = if commanded == asked { Limited::No } else { Limited::Duty };
        let (mut starved, mut exceeded_a, mut overcharged_c) = (false, 0.0, 0.0);
        if !self.keeps_limits(i, &solution, &battery, &input) {
            let held = self.hold_limits(
                state,
                input.gates,
                input.auxiliary_w,
                input.limits,
                resistance.force_n,
                resistance.slope_n_s_per_m,
                resistance.friction_n,
            );
            (solution, starved, exceeded_a) = (held.solution, held.starved, held.exceeded_a);
            if held.limited != Limited::No {
                limited = held.limited;
            }
            if starved {
                start.starve(source);
            }
            // In a place of its own: what is lent to a call lies in memory, in every step.
            let mut settled = state.battery;
            overcharged_c = self.battery.settle(&mut settled, solution.battery_a);
            battery = settled;
        }

        // One check of what could pass unseen (a standstill swallows it) and of what is about to
        // enter a state, where the rest shows.
        let magnitude = input.auxiliary_w
            + input.road.magnitude()
            + (i + solution.current_increment_a).abs()
            + (v + solution.motion.increment_m_s).abs()
            + solution.battery_a.abs()
            + B::magnitude(&battery);
        let accepted = sound(magnitude)
            && input.road.is_possible()
            && input.auxiliary_w >= 0.0
            && input.limits.discharge_a >= 0.0
            && input.limits.charge_a >= 0.0;
        if !accepted {
            return self.rejected(state, open_circuit_v);
        }

        // Back: each state from the solution.
        let losses = self.battery.losses(&state.battery, &battery, solution.battery_a);
        state.current_a.add(solution.current_increment_a);
        Body::settle(&mut state.body, solution.motion, self.dt_s);
        state.battery = battery;
        state.battery_v = solution.battery_v;
        if start.loads.any {
            state.cut_out_s =
                self.auxiliary.cut_out_s(state.cut_out_s, solution.battery_v, self.dt_s);
        }

        let raw = self.raw_flows(state, &input.road, &start, &solution, open_circuit_v, losses);
        state.ledger.book(&raw);
        if overcharged_c != 0.0 {
            state.ledger.book_overcharge(overcharged_c * open_circuit_v);
        }
        self.battery.refresh(&mut state.battery);
        PowertrainOutput {
            rejected: false,
            duty: solution.duty,
            limited,
            limit_exceeded_a: exceeded_a,
            overcharged_c,
            auxiliary_starved: starved,
            slip: solution.motion.slip,
            speed_m_s: state.body.speed_m_s.get(),
            distance_m: state.body.distance_m.get(),
            slope_sin: input.road.grade.sin,
            soc: B::soc(&state.battery),
            battery_a: solution.battery_a,
            battery_v: solution.battery_v,
            open_circuit_v,
            battery_outside_identified: B::is_outside(&state.battery),
            motor_a: state.current_a.get(),
            motor_nm: self.torque_nm_per_a * state.current_a.get(),
            motor_rad_s: self.motor_rad_per_m * state.body.speed_m_s.get(),
            flows: raw.times(&self.flow_factors()),
        }
    }
}

impl<L: Book, B: Pack> Model for Powertrain<L, B> {
    type State = PowertrainState<L, B::State>;
    type Input = PowertrainInput;
    type Output = PowertrainOutput;

    #[inline]
    fn step(&self, state: &mut Self::State, input: PowertrainInput) -> PowertrainOutput {
        Self::step(self, state, input)
    }
}

#[cfg(test)]
mod tests;
