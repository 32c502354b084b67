//! Single components against closed forms, and against the adaptive solution where there is none.

use plant_core::auxiliary::{Auxiliary, AuxiliaryInput, AuxiliaryParams};
use plant_core::battery::{
    Battery, BatteryInput, BatteryState, RcBranch, RcBranchInput, RcBranchParams, RcBranchState,
};
use plant_core::control::pid::{Pid, PidInput, PidParams, PidState};
use plant_core::mechanics::body::{Body, BodyInput, BodyState, Road};
use plant_core::mechanics::gearbox::{Gearbox, GearboxInput, GearboxParams};
use plant_core::mechanics::rotational::{
    Axis, AxisInput, AxisState, RotAxis, RotAxisInput, RotAxisParams, RotAxisState, RotationalLoad,
    RotationalLoadInput, RotationalLoadState,
};
use plant_core::mechanics::slope::{Grade, Slope, SlopeInput, SlopeParams, SlopeState};
use plant_core::mechanics::wheel::{Wheel, WheelInput, WheelParams};
use plant_core::presets::{BMW_I3_60AH_EPOWERTRAIN as I3, CONVERTER_BENCH_LOAD};
use plant_core::{Dt, must};

use super::adaptive::{Clock, System, integrate};
use super::tolerance as t;
use super::{Case, Checks};

const DT: Dt = must!(Dt::from_s(1e-3));
const DT_S: f64 = 1e-3;

pub(super) const CASES: [Case; 8] = [
    Case { name: "RC branch", models: &["RcBranch"], run: rc },
    Case { name: "battery", models: &["Battery"], run: battery },
    Case { name: "PID", models: &["Pid"], run: pid },
    Case { name: "body, coasting to a stop", models: &["Body"], run: coast },
    Case { name: "body on a slope", models: &["Body", "Slope"], run: slope },
    Case { name: "load on a shaft", models: &["RotationalLoad", "Axis"], run: shaft },
    Case { name: "shaft with inertia", models: &["RotAxis"], run: shaft_with_inertia },
    Case {
        name: "gearbox, wheel, auxiliary load",
        models: &["Gearbox", "Wheel", "Auxiliary"],
        run: statics,
    },
];

/// A pulse of 100 A for 60 s, then 60 s of rest: `V = R·I·(1 − e^(−t/τ))`, τ = 45 s.
fn rc(checks: &mut Checks) -> anyhow::Result<()> {
    let (r, c, amps) = (0.03_f32, 1500.0_f32, 100.0_f32);
    let branch = RcBranch::new(RcBranchParams { resistance_ohm: r, capacitance_f: c }, DT)?;
    let mut state = RcBranchState::default();
    let (peak_v, tau) = (f64::from(r) * f64::from(amps), f64::from(r) * f64::from(c));
    let mut worst = 0.0_f64;
    for number in 1..=120_000_u32 {
        let discharge_a = if number <= 60_000 { amps } else { 0.0 };
        let out = branch.step(&mut state, RcBranchInput { discharge_a });
        let time = f64::from(number) * DT_S;
        let charged = |t: f64| peak_v * (1.0 - (-t / tau).exp());
        let exact =
            if time <= 60.0 { charged(time) } else { charged(60.0) * (-(time - 60.0) / tau).exp() };
        worst = worst.max((f64::from(out.voltage_v) - exact).abs());
    }
    checks.add(&t::RC_TRAJECTORY, worst / peak_v);
    Ok(())
}

/// Half an hour at 60 A: half the charge; the voltage from the same equations.
fn battery(checks: &mut Checks) -> anyhow::Result<()> {
    let params = I3.powertrain.battery;
    let battery = Battery::new(params, DT)?;
    let mut state = BatteryState::rested(0.9)?;
    let mut out = battery.step(&mut state, BatteryInput { current_a: 60.0 });
    let mut heat_j = f64::from(out.heat_w) * DT_S;
    let steps = 1_800_000;
    for _ in 1..steps {
        out = battery.step(&mut state, BatteryInput { current_a: 60.0 });
        heat_j += f64::from(out.heat_w) * DT_S;
    }
    let resistance = 0.1051 + 1.7834e-4;
    checks.against(&t::BATTERY_SOC, 0.4, f64::from(out.soc));
    let voltage = 343.22 + (399.8 - 343.22) * 0.4 - resistance * 60.0;
    checks.against(&t::BATTERY_VOLTAGE, voltage, f64::from(out.terminal_v));
    // Less what the capacitor, with τ = 1.7 s, keeps from being heat.
    let tau = 1.7834e-4 * 9532.9;
    let exact_j = 3600.0 * (resistance * 1800.0 - 1.7834e-4 * 1.5 * tau);
    checks.against(&t::BATTERY_HEAT, exact_j, heat_j);
    Ok(())
}

/// A step of the error: proportional part at once, integral as a ramp, the output smoothed.
fn pid(checks: &mut Checks) -> anyhow::Result<()> {
    let (k, i, rate) = (2.0_f32, 0.5_f32, 10.0_f32);
    let params = PidParams {
        proportional: k,
        integral_per_s: i,
        smoothing_per_s: rate,
        ..PidParams::DEFAULT
    };
    let pid = Pid::new(params, DT)?;
    let mut state = PidState::default();
    let (k, i, rate) = (f64::from(k), f64::from(i), f64::from(rate));
    let mut worst = 0.0_f64;
    for number in 1..=5000_u32 {
        let out = pid.step(&mut state, PidInput { reference: 1.0, measurement: 0.0 });
        let time = f64::from(number) * DT_S;
        let exact = (k - i / rate) * (1.0 - (-rate * time).exp()) + i * time;
        worst = worst.max((f64::from(out.output) - exact).abs());
    }
    checks.add(&t::PID_TRAJECTORY, worst);
    Ok(())
}

/// A body that rolls to a stop: speed, distance \[m\].
struct Rolling {
    moving: bool,
}

impl System<2> for Rolling {
    fn slope(&self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
        if !self.moving {
            return [0.0, 0.0];
        }
        let drag = 0.5 * 1.225 * 0.29 * 2.38;
        [-(drag * y[0] * y[0]) / 1280.0 - 0.0084 * 9.80665, y[0]]
    }

    fn margin(&self, _t: f64, y: &[f64; 2]) -> f64 {
        if self.moving { y[0] } else { 1.0 }
    }

    fn switch(&mut self, _t: f64, y: &mut [f64; 2]) {
        y[0] = 0.0;
        self.moving = false;
    }

    fn scale(&self) -> [f64; 2] {
        [1.0, 100.0]
    }
}

fn coast(checks: &mut Checks) -> anyhow::Result<()> {
    const RUN_S: u32 = 300;
    let mut speeds = Vec::new();
    let mut y = [30.0, 0.0];
    let mut rolling = Rolling { moving: true };
    let mut clock = Clock::new(DT_S);
    let span = (0.0, f64::from(RUN_S));
    integrate(&mut rolling, &mut y, span, 1e-10, &mut clock, |_, y, _| speeds.push(y[0]))?;
    let body = Body::new(I3.powertrain.body, DT)?;
    let mut state = BodyState::default();
    state.speed_m_s.add(30.0);
    let mut worst = 0.0_f64;
    for exact in &speeds {
        let out = body.step(&mut state, BodyInput::default());
        worst = worst.max((f64::from(out.speed_m_s) - exact).abs());
    }
    checks.add(&t::COAST_SPEED, worst);
    checks.against(&t::COAST_DISTANCE, y[1], f64::from(state.distance_m.get()));
    checks.add(&t::STANDSTILL, f64::from(state.speed_m_s.get()));
    Ok(())
}

/// A slope found from heights, and what holds on it: rolling resistance holds up to
/// `tan α = C_r`.
fn slope(checks: &mut Checks) -> anyhow::Result<()> {
    let finder = Slope::new(SlopeParams { window_m: 10.0, largest_sin: 0.25 })?;
    let body = Body::new(I3.powertrain.body, DT)?;
    for (rise, bound) in [(0.008_f32, &t::STANDSTILL), (0.05, &t::SLOPE_SPEED)] {
        let mut seen = SlopeState::starting_at(0.0, 0.0);
        let mut grade = Grade::FLAT;
        for number in 0..100_u16 {
            let distance_m = f32::from(number);
            let input = SlopeInput { height_m: rise * distance_m, distance_m };
            grade = finder.step(&mut seen, input).grade;
        }
        checks.against(&t::SLOPE_SIN, f64::from(rise), f64::from(grade.sin));
        let mut state = BodyState::default();
        let road = Road { grade, ..Road::default() };
        for _ in 0..1000 {
            body.step(&mut state, BodyInput { force_n: 0.0, road });
        }
        let speed = f64::from(state.speed_m_s.get());
        if rise < 0.0084 {
            checks.add(bound, speed);
        } else {
            // One second downhill: v = a/q·tanh(q·t) backwards, q² = a·c/M.
            let sin = f64::from(rise);
            let a = 9.80665 * (sin - 0.0084 * (1.0 - sin * sin).sqrt());
            let q = (a * 0.5 * 1.225 * 0.29 * 2.38 / 1280.0).sqrt();
            checks.against(bound, -a / q * q.tanh(), speed);
        }
    }
    Ok(())
}

/// `ω = T/f·(1 − e^(−f·t/J))`, and the angle turned at a constant speed.
fn shaft(checks: &mut Checks) -> anyhow::Result<()> {
    let params = plant_core::mechanics::rotational::RotationalLoadParams {
        viscous_nm_s_per_rad: 2.0,
        ..CONVERTER_BENCH_LOAD
    };
    let load = RotationalLoad::new(params, DT)?;
    let mut state = RotationalLoadState::default();
    let mut worst = 0.0_f64;
    for number in 1..=20_000_u32 {
        let out = load.step(&mut state, RotationalLoadInput { torque_nm: 40.0 });
        let exact = 20.0 * (1.0 - (-f64::from(number) * DT_S / 5.0).exp());
        worst = worst.max((f64::from(out.speed_rad_s) - exact).abs());
    }
    checks.add(&t::LOAD_TRAJECTORY, worst / 20.0);

    let axis = Axis::new(DT);
    let mut turned = AxisState::default();
    let mut angle = 0.0;
    for _ in 0..100_000 {
        let out = axis.step(&mut turned, AxisInput { speed_rad_s: 3.7, torque_nm: 1.0 });
        angle = f64::from(out.angle_rad);
    }
    checks.against(&t::AXIS_ANGLE, (370.0_f64).rem_euclid(std::f64::consts::TAU), angle);
    Ok(())
}

/// A shaft with inertia under a torque that swings: `ω = T̂/(J·w)·(1 − cos w·t)`.
#[expect(clippy::cast_possible_truncation, reason = "the model computes in f32")]
fn shaft_with_inertia(checks: &mut Checks) -> anyhow::Result<()> {
    let shaft = RotAxis::new(RotAxisParams { inertia_kg_m2: 0.2 }, DT)?;
    let (mut state, mut worst) = (RotAxisState::default(), 0.0_f64);
    let (largest_nm, swing_rad_s) = (30.0, 5.0);
    let largest_rad_s = 2.0 * largest_nm / (0.2 * swing_rad_s);
    let mut out = shaft.step(&mut state, RotAxisInput { driving_nm: 0.0, load_nm: 0.0 });
    for number in 1..=10_000_u32 {
        let time = f64::from(number) * DT_S;
        let swinging_nm = (largest_nm * (swing_rad_s * time).sin()) as f32;
        let input = RotAxisInput { driving_nm: 7.0 + swinging_nm, load_nm: 7.0 };
        out = shaft.step(&mut state, input);
        let exact = 0.5 * largest_rad_s * (1.0 - (swing_rad_s * time).cos());
        worst = worst.max((f64::from(out.speed_rad_s) - exact).abs());
    }
    checks.add(&t::SHAFT_TRAJECTORY, worst / largest_rad_s);
    let angle = 0.5 * largest_rad_s * (10.0 - (swing_rad_s * 10.0).sin() / swing_rad_s);
    let exact = angle.rem_euclid(std::f64::consts::TAU);
    checks.against(&t::SHAFT_ANGLE, exact, f64::from(out.angle_rad));
    Ok(())
}

/// What follows its input without delay.
fn statics(checks: &mut Checks) -> anyhow::Result<()> {
    let params = GearboxParams { ratio: 9.665, efficiency: 0.97, inertia_kg_m2: 0.0 };
    let gearbox = Gearbox::new(params, DT)?;
    let gear = gearbox.step(&mut 50.0, GearboxInput { motor_nm: 100.0, wheel_rad_s: 50.0 });
    checks.against(&t::GEAR_TORQUE, 0.97 * 966.5, f64::from(gear.wheel_nm));
    let balance = 100.0 * f64::from(gear.motor_rad_s)
        - f64::from(gear.wheel_nm) * 50.0
        - f64::from(gear.loss_w);
    checks.add(&t::GEAR_BALANCE, balance / (100.0 * f64::from(gear.motor_rad_s)));

    // Speeding up by 1 m/s² at 10 m/s.
    let params = WheelParams { radius_m: 0.34, inertia_kg_m2: 2.2, viscous_nm_s_per_rad: 0.1 };
    let wheel = Wheel::new(params, must!(Dt::from_s(1.0)))?;
    let rolled = wheel.step(&mut 9.0, WheelInput { axle_nm: 340.0, speed_m_s: 10.0 });
    let exact = 1000.0 - (0.1 * 10.0 + 2.2) / (0.34 * 0.34);
    checks.against(&t::WHEEL_FORCE, exact, f64::from(rolled.force_n));

    let params =
        AuxiliaryParams { power_w: 530.0, resistance_ohm: 80.4765, ..AuxiliaryParams::NONE };
    let drawn =
        Auxiliary::new(params)?.step(&mut (), AuxiliaryInput { voltage_v: 360.0, power_w: 1000.0 });
    let exact = 1530.0 + 360.0 * 360.0 / 80.4765;
    checks.against(&t::AUXILIARY_POWER, exact, f64::from(drawn.power_w));
    Ok(())
}
