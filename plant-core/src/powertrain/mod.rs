//! The coupled plant: battery, auxiliary load, drives (converter, machine, gearbox), wheel, body.
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
//! Battery::offer       V  = emf − resistance·I                RC branch eliminated          source
//! Loads::leave         V  = emf − resistance·D·i'             loads eliminated              bus
//! Machine::solve       w  = D·(emf − resistance·D·i) − (R + R_c)·i − Ke·k·v ∓ V_d
//!                      within V_d of no current, none: i' = 0
//!                      Y  = 1/(L/h + R + R_c + D²·resistance)
//!                      Δi = Y·w − Y·Ke·k·Δv
//!                      F  = Kt·k·(i + Y·w) − Kt·Ke·k²·Y·Δv    = effort − slope·Δv           drive
//! Body::resistance     force = −(c·|v + w|·(v + w) + b·v + M·g·sin α)                  resistance
//!                      slope = m/h + b + c·|v + w|      friction = F_c
//! Resistance::solve    Δv = (force + effort ∓ friction)/(slope + drive.slope)             motion
//! ```
//!
//! That is a DC machine which has the bus for itself. Several drives, and those with three phases,
//! offer lines in the rise of the bus voltage too ([`BusLaw`](crate::port::BusLaw)); lines add.
//!
//! `project` takes v to exactly 0 where friction holds it. One walk back settles each state:
//! `Δi`, `I` and `V` on the bus, SOC, distance. No iteration, except
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

pub mod drives;
mod input;
pub mod ledger;
mod limit;
mod output;
mod params;
mod solve;

pub use drives::{Axles, Drive, DriveParams, Drives, Either, HeatedDriveParams, TORQUE_RATE_PER_S};
pub use input::PowertrainInput;
pub use output::{Feedback, Limited, PowertrainOutput};
pub use params::{DrivesParams, PackParams, PowertrainParams};

use core::marker::PhantomData;

use crate::auxiliary::Auxiliary;
use crate::battery::{Battery, BatteryState, Pack};
use crate::error::{ParamError, check};
use crate::machine::Solved;
use crate::mechanics::body::{Body, BodyState};
use crate::mechanics::wheel::Wheel;
use crate::model::{Dt, Model};
use crate::num::{Accum, Real, min, sound};
use crate::port::Coast;
use crate::powertrain::ledger::{Book, EnergyLedger, EnergyReport, NoLedger, Stored};
use crate::powertrain::solve::Walk;

/// The coupled plant, discretised for one step; `L` says whether it keeps an energy ledger, `B`
/// which battery it has, `D` what drives it: one [`Drive`], or a pair of drives, of which each may
/// be a pair again.
///
/// For given commands and given forces a step is stable for any `h` and any physical parameter. So it
/// is where a limit acts: the current stands at the limit; one that was beyond it already, as when
/// the limit falls, decays with the winding's L/R.
///
/// ```
/// use plant_core::powertrain::ledger::EnergyLedger;
/// use plant_core::powertrain::{Powertrain, PowertrainInput};
/// use plant_core::{Dt, ParamError, must, presets};
///
/// const CAR: Powertrain<EnergyLedger> = must!(Powertrain::new(
///     presets::EPOWERTRAIN_UDDS.powertrain,
///     must!(Dt::from_s(0.001)),
/// ))
/// .with_ledger();
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
pub struct Powertrain<L = NoLedger, B = Battery, D = Drive> {
    battery: B,
    drives: D,
    auxiliary: Auxiliary,
    /// Losses of the converters that do not depend on their load \[W\].
    constant_loss_w: Real,
    /// All that moves and rubs, seen from the road.
    coast: Coast,
    body: Body,
    dt_s: Real,
    has_gear_loss: bool,
    /// Neither auxiliary loads nor constant losses of converters: a step need not look for them.
    plain: bool,
    ledger: PhantomData<L>,
}

/// The state of a [`Powertrain`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PowertrainState<L = NoLedger, S = BatteryState, E = Accum> {
    /// The battery.
    pub battery: S,
    /// The drives: of one with a DC machine the winding current \[A\].
    pub drives: E,
    /// Speed and distance.
    pub body: BodyState,
    /// Voltage at the battery's terminals at the last step \[V\].
    pub battery_v: Real,
    /// How long the constant auxiliary power still stays cut out \[s\]; 0 where it is not.
    pub cut_out_s: Real,
    /// The books, or nothing.
    pub ledger: L,
}

impl Powertrain {
    /// Checks `params` and discretises them for steps of `dt`: one DC machine on a battery of
    /// constant parameters. [`of`](Powertrain::of) makes any other plant,
    /// [`with_ledger`](Powertrain::with_ledger) one that keeps books.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: PowertrainParams, dt: Dt) -> Result<Self, ParamError> {
        let battery = check!(Battery::new(params.battery, dt));
        Powertrain::of(battery, check!(params.drives.on(params.wheel, dt)), &params, dt)
    }
}

impl<B: Pack, D: Drives> Powertrain<EnergyLedger, B, D> {
    /// Where the energy went between the state `start` and the state `now`, which came from it.
    #[must_use]
    pub fn energy(
        &self,
        start: &PowertrainState<EnergyLedger, B::State, D::State>,
        now: &PowertrainState<EnergyLedger, B::State, D::State>,
    ) -> EnergyReport {
        let discharged_j = self.battery.discharged_energy_j(&start.battery, &now.battery);
        now.ledger.report(&self.flow_factors(), self.dt_s, self.stored(now), discharged_j)
    }
}

impl<B: Copy, D: Copy> Powertrain<NoLedger, B, D> {
    /// A battery and drives, with the auxiliary loads, the wheels and the body of `params`.
    ///
    /// ```
    /// use plant_core::powertrain::ledger::NoLedger;
    /// use plant_core::powertrain::{Axles, Drive, Powertrain, PowertrainParams};
    /// use plant_core::{Dt, MappedBattery, MappedBatteryParams, must, presets};
    ///
    /// const DT: Dt = must!(Dt::from_s(0.001));
    /// const I3: PowertrainParams<MappedBatteryParams> = presets::BMW_I3_60AH.powertrain;
    /// // The car with a second drive like its own.
    /// const DRIVE: Axles<Drive> = must!(I3.drives.on(I3.wheel, DT));
    /// const CAR: Powertrain<NoLedger, MappedBattery, (Drive, Drive)> = must!(Powertrain::of(
    ///     must!(MappedBattery::new(I3.battery, DT)),
    ///     DRIVE.and(DRIVE),
    ///     &I3,
    ///     DT,
    /// ));
    /// assert!(CAR.moving_mass_kg() > 1500.0);
    /// ```
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn of<P, Q>(
        battery: B,
        axles: Axles<D>,
        params: &PowertrainParams<P, Q>,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        let wheel = check!(Wheel::new(params.wheel, dt));
        let body = check!(Body::new(params.body, dt));
        let auxiliary = check!(Auxiliary::new(params.auxiliary));
        Ok(Self {
            battery,
            drives: axles.drives,
            constant_loss_w: axles.constant_loss_w,
            coast: wheel.coast(axles.coast).plus(body.coast()),
            body,
            dt_s: dt.s(),
            has_gear_loss: axles.has_gear_loss,
            plain: auxiliary.is_none() && axles.constant_loss_w == 0.0,
            auxiliary,
            ledger: PhantomData,
        })
    }

    /// The same plant, keeping an energy ledger.
    #[must_use]
    pub const fn with_ledger(self) -> Powertrain<EnergyLedger, B, D> {
        Powertrain {
            battery: self.battery,
            drives: self.drives,
            auxiliary: self.auxiliary,
            constant_loss_w: self.constant_loss_w,
            coast: self.coast,
            body: self.body,
            dt_s: self.dt_s,
            has_gear_loss: self.has_gear_loss,
            plain: self.plain,
            ledger: PhantomData,
        }
    }
}

impl<L, B, D> Powertrain<L, B, D> {
    /// The battery model inside.
    #[must_use]
    pub const fn battery(&self) -> &B {
        &self.battery
    }

    /// The drives inside.
    #[must_use]
    pub const fn drives(&self) -> &D {
        &self.drives
    }

    /// Everything that moves with the vehicle, as mass \[kg\].
    #[must_use]
    pub const fn moving_mass_kg(&self) -> Real {
        self.coast.inertia_per_h * self.dt_s
    }
}

impl<L: Book, B: Pack, D: Drives> Powertrain<L, B, D> {
    /// A rested plant that stands still with its battery at `soc`.
    ///
    /// # Errors
    /// [`ParamError::NotARatio`] for a state of charge outside 0..1.
    pub fn at_rest(&self, soc: Real) -> Result<PowertrainState<L, B::State, D::State>, ParamError> {
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
    ) -> Result<PowertrainState<L, B::State, D::State>, ParamError> {
        let speed_m_s = Accum::new(crate::error::finite("speed_m_s", speed_m_s)?);
        let battery = self.battery.rested(soc)?;
        let mut state = PowertrainState {
            battery,
            drives: D::State::default(),
            body: BodyState { speed_m_s, distance_m: Accum::new(0.0) },
            battery_v: self.battery.offer(&battery).0.emf_v,
            cut_out_s: 0.0,
            ledger: L::default(),
        };
        state.ledger = L::starting_with(self.stored(&state));
        Ok(state)
    }

    /// Energy held in motion and fields.
    fn stored(&self, state: &PowertrainState<L, B::State, D::State>) -> Stored {
        let v = state.body.speed_m_s.get();
        Stored {
            kinetic: 0.5 * self.moving_mass_kg() * v * v,
            inductive: self.drives.field_j(&state.drives),
            capacitive: self.battery.capacitive_j(&state.battery),
        }
    }

    /// Motor speed per road speed \[rad/m\], of the first motor.
    #[must_use]
    pub fn motor_rad_per_m(&self) -> Real {
        self.drives.motor_rad_per_m()
    }

    /// Whether a solution keeps every limit.
    ///
    /// A winding's field that grows hides what the battery will be charged with once it has grown:
    /// that counts too.
    #[inline(always)]
    fn keeps_limits<C>(
        &self,
        walk: &Walk<D::Link>,
        next: &B::State,
        input: &PowertrainInput<C>,
        emf_v: Real,
    ) -> bool {
        let battery_a = walk.battery_a;
        let least_a = min(battery_a, battery_a - walk.review.field_w / walk.battery_v);
        // Asked as what breaks a limit: beyond an infinite one there is nothing to compare. What is
        // not a number is refused further on.
        let broken = !walk.review.fits
            || battery_a > input.limits.discharge_a
            || least_a < -input.limits.charge_a
            || self.battery.may_collapse() && walk.battery_v < limit::COLLAPSED * emf_v;
        !broken && self.battery.allows(battery_a, least_a, next)
    }

    /// Advances by one step.
    #[inline(always)]
    pub fn step(
        &self,
        state: &mut PowertrainState<L, B::State, D::State>,
        input: PowertrainInput<D::Command>,
    ) -> PowertrainOutput<D::Output> {
        let v = state.body.speed_m_s.get();
        let mut resistance = self.body.resistance(&input.road, self.coast, v);
        let mut gear_n = 0.0;
        if self.has_gear_loss {
            gear_n = self.drives.gear_n(&state.drives);
            resistance.friction_n += gear_n;
        }
        let (source, open_circuit_v) = self.battery.offer(&state.battery);
        let mut loads = self.loads(input.auxiliary_w, state);
        let bus = loads.leave(source);
        let seen = Self::seen(state, bus, &resistance);
        let solved = self.drives.solve(&state.drives, input.gates, seen, bus, &resistance);
        let mut walk = self.reviewed(state, &loads, solved);
        let mut battery = self.battery.next(&state.battery, walk.battery_a);
        let mut limited = if D::is_clipped(&walk.link) {
            Limited::Duty
        } else if D::is_derated(&walk.link) {
            Limited::Current
        } else {
            Limited::No
        };
        let (mut starved, mut exceeded_a, mut overcharged_c) = (false, 0.0, 0.0);
        if !self.keeps_limits(&walk, &battery, &input, bus.emf_v) {
            let kept = self.keep_limits(
                state,
                input.gates,
                input.limits,
                Solved { link: walk.link, bus_v: walk.battery_v, motion: walk.motion },
                loads,
                source,
                resistance,
            );
            (walk, starved, exceeded_a) = (kept.walk, kept.starved, kept.exceeded_a);
            if kept.limited != Limited::No {
                limited = kept.limited;
            }
            loads = loads.times(kept.share);
            // In a place of its own: what is lent to a call lies in memory, in every step.
            let mut settled = state.battery;
            overcharged_c = self.battery.settle(&mut settled, walk.battery_a);
            battery = settled;
        }

        // One check of what could pass unseen (a standstill swallows it) and of what is about to
        // enter a state, where the rest shows.
        let magnitude = (input.auxiliary_w + input.road.magnitude())
            + walk.review.magnitude
            + (v + walk.motion.increment_m_s).abs()
            + walk.battery_a.abs()
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
        let losses = self.battery.losses(&state.battery, &battery, walk.battery_a);
        let before = state.drives;
        self.drives.settle(&mut state.drives, &walk.link);
        Body::settle(&mut state.body, walk.motion, self.dt_s);
        state.battery = battery;
        state.battery_v = walk.battery_v;
        if !self.plain || input.auxiliary_w > 0.0 {
            state.cut_out_s = self.auxiliary.cut_out_s(state.cut_out_s, walk.battery_v, self.dt_s);
        }

        let v = state.body.speed_m_s.get();
        let machines = self.drives.flows(&before, &state.drives, &walk.link, v);
        let raw = self.raw_flows(
            v,
            &input.road,
            &loads,
            &walk,
            machines,
            gear_n,
            resistance.drag_n_s_per_m,
            open_circuit_v,
            losses,
        );
        state.ledger.book(&raw, D::THREE_PHASE);
        if overcharged_c != 0.0 {
            state.ledger.book_overcharge(overcharged_c * open_circuit_v);
        }
        self.battery.refresh(&mut state.battery);
        let drives = self.drives.output(&state.drives, &walk.link, v);
        PowertrainOutput {
            rejected: false,
            limited,
            limit_exceeded_a: exceeded_a,
            overcharged_c,
            auxiliary_starved: starved,
            slip: walk.motion.slip,
            speed_m_s: v,
            distance_m: state.body.distance_m.get(),
            slope_sin: input.road.grade.sin,
            soc: B::soc(&state.battery),
            battery_a: walk.battery_a,
            battery_v: walk.battery_v,
            open_circuit_v,
            battery_outside_identified: B::is_outside(&state.battery),
            drives,
            flows: raw.times(&self.flow_factors()),
        }
    }
}

impl<L: Book, B: Pack, D: Drives> Model for Powertrain<L, B, D> {
    type State = PowertrainState<L, B::State, D::State>;
    type Input = PowertrainInput<D::Command>;
    type Output = PowertrainOutput<D::Output>;

    #[inline]
    fn step(&self, state: &mut Self::State, input: Self::Input) -> Self::Output {
        Self::step(self, state, input)
    }
}

#[cfg(test)]
mod tests;
