//! Composed plants of two drives, each a DC or a synchronous machine, in `f32` and in the f64 twin:
//! any input is refused or leaves all finite, the ledger closes, shorted terminals are passive,
//! limits hold. The same of drives that heat up.

use plant_core::auxiliary::AuxiliaryParams;
use plant_core::battery::{BatteryParams, CurrentLimits};
use plant_core::converter::{ConverterParams, Gates};
use plant_core::machine::dc::DcMotorParams;
use plant_core::machine::flux::Flux;
use plant_core::machine::heated::{DriveThermalParams, HeatedPartParams};
use plant_core::machine::pmsm::{DqCurrents, PmsmParams};
use plant_core::machine::transform::Dq as Vector;
use plant_core::mechanics::body::Road;
use plant_core::powertrain::{DriveParams, HeatedDriveParams, PowertrainInput, PowertrainParams};
use plant_core::thermal::Conductor;
use plant_core::{Accum, Dt, Real};
use proptest::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::check::{all_finite, any_bits, cases, log, positive, signed};
use crate::draw::{self, Draw, PLAUSIBLE, Spread, drawn, within};

type Dc = DriveParams<DcMotorParams>;
type Dq = DriveParams<PmsmParams>;
type Vehicle<A, B> = PowertrainParams<BatteryParams, (A, B)>;

/// Where a plant stays finite. Beyond, a coefficient seen through gears and wheels is too large for
/// `f32`.
const FINITE: Spread = within(1e3);

/// Steps of the ledger, of limits until they stand, and then.
const STEPS: u32 = 300;
/// The largest residual in shares of the turnover: a few of the scalar's last bits, of a synchronous
/// machine those of the squares of flux and current, which the vehicle sees at its highest ratio.
const CLOSES: f64 = 1e-5;
const TWIN_CLOSES: f64 = 1e-14;
/// How much energy rounding may add in one step, in shares of it.
const ROUNDING: f64 = 1e-6;

fn dc(d: &mut Draw) -> Dc {
    DriveParams {
        converter: draw::converter(d),
        ..DriveParams::new(draw::motor(d), draw::gearbox(d))
    }
}

/// An inverter has no drop in the model.
fn dq(d: &mut Draw) -> Dq {
    let converter = ConverterParams { voltage_drop_v: 0.0, ..draw::converter(d) };
    let motor = draw::pmsm(d);
    // Its largest value is larger in double precision than its bound.
    let motor = PmsmParams { resistance_per_k: 0.99 * motor.resistance_per_k, ..motor };
    DriveParams { converter, ..DriveParams::new(motor, draw::gearbox(d)) }
}

/// Cold to too hot from the start on, small enough to warm up in a few steps; a current limit that
/// can be derated.
fn heated<M>(d: &mut Draw, mut drive: DriveParams<M>) -> HeatedDriveParams<M> {
    let limit_a = &mut drive.converter.current_limit_a;
    *limit_a = limit_a.min(1e4);
    let mut part = || {
        let derate_from_c = 40.0 + 60.0 * d.ratio();
        HeatedPartParams {
            heat_capacity_j_per_k: d.near(30.0),
            coolant_k_per_w: d.near(0.02),
            derate_from_c,
            derate_to_c: derate_from_c + 1.0 + 50.0 * d.ratio(),
        }
    };
    let (machine, inverter) = (part(), part());
    let winding = Conductor { reference_c: 20.0, per_k: 0.009 * d.ratio() };
    let thermal =
        DriveThermalParams { coolant_c: -40.0 + 160.0 * d.ratio(), machine, inverter, winding };
    HeatedDriveParams { drive, thermal }
}

fn hot_dc(d: &mut Draw) -> HeatedDriveParams {
    let drive = dc(d);
    heated(d, drive)
}

fn hot_dq(d: &mut Draw) -> HeatedDriveParams<PmsmParams> {
    let drive = dq(d);
    heated(d, drive)
}

/// Nothing is infinite, so that the twin can take the parameters as text.
fn vehicle<A: Copy, B: Copy>(
    one: fn(&mut Draw) -> A,
    other: fn(&mut Draw) -> B,
) -> impl Fn(&mut Draw) -> Vehicle<A, B> {
    move |d| {
        let battery = draw::battery(d);
        let battery = BatteryParams {
            discharge_limit_a: battery.discharge_limit_a.min(1e9),
            charge_limit_a: battery.charge_limit_a.min(1e9),
            ..battery
        };
        let auxiliary = draw::auxiliary(d);
        let auxiliary =
            AuxiliaryParams { resistance_ohm: auxiliary.resistance_ohm.min(1e9), ..auxiliary };
        let drives = (one(d), other(d));
        PowertrainParams { battery, auxiliary, drives, wheel: draw::wheel(d), body: draw::body(d) }
    }
}

/// The same parameters for the twin.
fn twin<P: Serialize, T: DeserializeOwned>(params: &P) -> T {
    let text = serde_json::to_value(params).expect("finite numbers");
    serde_json::from_value(text).expect("the same fields")
}

/// What acts on a plant.
#[derive(Clone, Copy, Debug)]
struct Command {
    dt_s: Real,
    speed_m_s: Real,
    torque_nm: Real,
    sin: Real,
    brake_n: Real,
    auxiliary_w: Real,
    discharge_a: Real,
    charge_a: Real,
}

fn commands() -> impl Strategy<Value = Command> {
    let limit = || prop_oneof![Just(1e9), log(5.0, 300.0)];
    let acts = (log(1e-5, 0.02), signed(40.0), signed(150.0), signed(0.1));
    (acts, (positive(2000.0), positive(2000.0), limit(), limit())).prop_map(
        |((dt_s, speed_m_s, torque_nm, sin), (brake_n, auxiliary_w, discharge_a, charge_a))| {
            Command { dt_s, speed_m_s, torque_nm, sin, brake_n, auxiliary_w, discharge_a, charge_a }
        },
    )
}

/// Torque loops for a while. The battery's current keeps its limits to 1 %, or what is beyond is
/// reported; gives residual and turnover of the ledger \[J\].
macro_rules! driven {
    ($core:ident, $real:ty, $params:expr, $c:expr) => {{
        use $core::battery::CurrentLimits;
        use $core::mechanics::{body::Road, slope::Grade};
        use $core::powertrain::{Drives, PowertrainInput};
        let (c, of) = ($c, |x: Real| <$real>::from(x));
        let plant = $params.build($core::Dt::from_s(of(c.dt_s)).unwrap()).unwrap().with_ledger();
        let start = plant.at_speed(of(0.6), of(c.speed_m_s)).unwrap();
        let mut s = start;
        let asked = CurrentLimits { discharge_a: of(c.discharge_a), charge_a: of(c.charge_a) };
        let input = PowertrainInput {
            road: Road {
                grade: Grade::from_sin(of(c.sin)),
                brake_n: of(c.brake_n),
                ..Road::default()
            },
            auxiliary_w: of(c.auxiliary_w),
            limits: asked,
            ..PowertrainInput::with(plant.drives().command(of(c.torque_nm)))
        };
        for n in 0..STEPS {
            let limits = plant.battery().faded(&s.battery).within(asked);
            let out = plant.step(&mut s, input);
            prop_assert!(!out.rejected, "{n}: {out:?}");
            let over_a = f64::from(out.battery_a - limits.discharge_a)
                .max(f64::from(-out.battery_a - limits.charge_a));
            let near_a = f64::from(out.limit_exceeded_a) + 0.01 * f64::from(out.battery_a.abs());
            prop_assert!(over_a <= near_a + 0.02, "{n}: {over_a} {limits:?} {out:?}");
        }
        let report = plant.energy(&start, &s);
        let kinetic_j = 0.5 * f64::from(plant.moving_mass_kg()) * f64::from(c.speed_m_s).powi(2);
        let terms = report.terms();
        let named = terms.iter().filter(|(name, _)| *name != "residual");
        let turnover_j: f64 = named.map(|(_, j)| f64::from(*j).abs()).sum();
        (f64::from(report.residual).abs(), turnover_j + kinetic_j)
    }};
}

/// Both precisions, without the books.
macro_rules! limited_in_both {
    ($params:expr, $twin:ty, $c:expr) => {{
        let (params, c) = ($params, $c);
        let _ = driven!(plant_core, f32, params, c);
        let params: $twin = twin(&params);
        let _ = driven!(plant_core_f64, f64, params, c);
    }};
}

/// Both precisions.
macro_rules! driven_in_both {
    ($params:expr, $twin:ty, $c:expr) => {{
        let (params, c) = ($params, $c);
        let (residual_j, turnover_j) = driven!(plant_core, f32, params, c);
        prop_assert!(residual_j <= CLOSES * turnover_j, "{residual_j} of {turnover_j}");
        let params: $twin = twin(&params);
        let (residual_j, turnover_j) = driven!(plant_core_f64, f64, params, c);
        prop_assert!(residual_j <= TWIN_CLOSES * turnover_j, "{residual_j} of {turnover_j} (f64)");
    }};
}

type TwinDc = plant_core_f64::powertrain::DriveParams<plant_core_f64::machine::dc::DcMotorParams>;
type TwinDq = plant_core_f64::powertrain::DriveParams<plant_core_f64::machine::pmsm::PmsmParams>;
type TwinHot<M> = plant_core_f64::powertrain::HeatedDriveParams<M>;
type TwinHotDc = TwinHot<plant_core_f64::machine::dc::DcMotorParams>;
type TwinHotDq = TwinHot<plant_core_f64::machine::pmsm::PmsmParams>;
type Twin<A, B> =
    plant_core_f64::powertrain::PowertrainParams<plant_core_f64::battery::BatteryParams, (A, B)>;

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn two_synchronous_machines_keep_limits(
        params in drawn(PLAUSIBLE, vehicle(dq, dq)),
        command in commands(),
    ) {
        limited_in_both!(params, Twin<TwinDq, TwinDq>, command);
    }

    #[test]
    fn two_synchronous_machines_keep_books(
        params in drawn(PLAUSIBLE, vehicle(dq, dq)),
        command in commands(),
    ) {
        driven_in_both!(params, Twin<TwinDq, TwinDq>, command);
    }

    #[test]
    fn different_machines_keep_limits(
        params in drawn(PLAUSIBLE, vehicle(dq, dc)),
        command in commands(),
    ) {
        limited_in_both!(params, Twin<TwinDq, TwinDc>, command);
    }

    #[test]
    fn different_machines_keep_books(
        params in drawn(PLAUSIBLE, vehicle(dq, dc)),
        command in commands(),
    ) {
        driven_in_both!(params, Twin<TwinDq, TwinDc>, command);
    }

    #[test]
    fn two_dc_machines_keep_limits_and_books(
        params in drawn(PLAUSIBLE, vehicle(dc, dc)),
        command in commands(),
    ) {
        driven_in_both!(params, Twin<TwinDc, TwinDc>, command);
    }

    #[test]
    fn heated_drives_keep_limits(
        params in drawn(PLAUSIBLE, vehicle(hot_dq, hot_dc)),
        command in commands(),
    ) {
        limited_in_both!(params, Twin<TwinHotDq, TwinHotDc>, command);
    }

    #[test]
    fn heated_drives_keep_books(
        params in drawn(PLAUSIBLE, vehicle(hot_dq, hot_dc)),
        command in commands(),
    ) {
        driven_in_both!(params, Twin<TwinHotDq, TwinHotDc>, command);
    }

    /// As warm as it is, a machine is passive with its winding shorted, whatever its resistance
    /// becomes; what it loses is in the nodes.
    #[test]
    fn shorted_heated_machines_are_passive(
        params in drawn(PLAUSIBLE, vehicle(hot_dc, hot_dc)),
        dt_s in log(1e-5, 1.0),
        speed_m_s in signed(40.0),
        (one_a, two_a) in (signed(500.0), signed(500.0)),
        (above_k, inverter_k) in (signed(300.0), signed(300.0)),
    ) {
        let plant = params.build(Dt::from_s(dt_s).unwrap()).unwrap();
        let mut s = plant.at_speed(0.6, speed_m_s).unwrap();
        (s.drives.0.machine, s.drives.1.machine) = (Accum::new(one_a), Accum::new(two_a));
        s.drives.0.machine_above_k = Accum::new(above_k);
        s.drives.1.inverter_above_k = Accum::new(inverter_k);
        let (one, two) = (params.drives.0.drive.motor, params.drives.1.drive.motor);
        let stored = |a: Accum, b: Accum, v: Real| {
            let squares = |factor: Real, x: Real| f64::from(factor) * f64::from(x).powi(2);
            0.5 * (squares(one.inductance_h, a.get()) + squares(two.inductance_h, b.get()))
                + 0.5 * squares(plant.moving_mass_kg(), v)
        };
        let mut last_j = f64::INFINITY;
        for n in 0..STEPS {
            let shorted = (Gates::On(0.0), Gates::On(0.0));
            let out = plant.step(&mut s, PowertrainInput::with(shorted));
            prop_assert!(!out.rejected, "{out:?}");
            let now_j =
                stored(s.drives.0.machine, s.drives.1.machine, s.body.speed_m_s.get());
            prop_assert!(now_j <= last_j * (1.0 + ROUNDING) + 1e-30, "{n}: {last_j} {now_j} {out:?}");
            last_j = now_j;
        }
    }

    /// As for drives without temperatures, whatever these are.
    #[test]
    fn any_input_of_heated_drives_is_refused_or_leaves_all_finite(
        (params, dt) in drawn(FINITE, |d| (vehicle(hot_dq, hot_dc)(d), d.dt())),
        (above_k, inverter_k) in (signed(1e6), signed(1e6)),
        inputs in prop::collection::vec((any_bits(), any_bits(), any_bits()), 1..20),
    ) {
        let Ok(plant) = params.build(dt) else { return Ok(()) };
        let mut s = plant.at_rest(0.6).unwrap();
        s.drives.0.machine_above_k = Accum::new(above_k);
        s.drives.1.inverter_above_k = Accum::new(inverter_k);
        for (torque_nm, duty, auxiliary_w) in inputs {
            let before = format!("{s:?}");
            let commands = (Gates::Torque(torque_nm), Gates::On(duty));
            let input = PowertrainInput { auxiliary_w, ..PowertrainInput::with(commands) };
            let out = plant.step(&mut s, input);
            let after = format!("{s:?}");
            prop_assert!(all_finite(&after) && all_finite(&format!("{out:?}")), "{input:?}: {out:?}");
            prop_assert!(!out.rejected || after == before, "{input:?} was refused, and changed it");
        }
    }

    /// Rolling, both windings shorted: motion and fields together never rise.
    #[test]
    fn shorted_terminals_are_passive(
        params in drawn(PLAUSIBLE, vehicle(dq, dc)),
        dt_s in log(1e-5, 1.0),
        speed_m_s in signed(40.0),
        (d_a, q_a, dc_a) in (signed(500.0), signed(500.0), signed(500.0)),
    ) {
        let plant = params.build(Dt::from_s(dt_s).unwrap()).unwrap();
        let mut s = plant.at_speed(0.6, speed_m_s).unwrap();
        (s.drives.0.d_a, s.drives.0.q_a) = (Accum::new(d_a), Accum::new(q_a));
        s.drives.1 = Accum::new(dc_a);
        let Flux::Linear(flux) = params.drives.0.motor.flux else { unreachable!() };
        let stored = |i: DqCurrents, dc: Accum, v: Real| {
            let i = i.get();
            let squares = |factor: Real, x: Real| f64::from(factor) * f64::from(x).powi(2);
            0.75 * (squares(flux.d_h, i.d) + squares(flux.q_h, i.q))
                + 0.5 * squares(params.drives.1.motor.inductance_h, dc.get())
                + 0.5 * squares(plant.moving_mass_kg(), v)
        };
        let shorted = (Gates::On(Vector::ZERO), Gates::On(0.0));
        let mut last_j = stored(s.drives.0, s.drives.1, s.body.speed_m_s.get());
        for n in 0..STEPS {
            let out = plant.step(&mut s, PowertrainInput::with(shorted));
            prop_assert!(!out.rejected, "{out:?}");
            let now_j = stored(s.drives.0, s.drives.1, s.body.speed_m_s.get());
            prop_assert!(now_j <= last_j * (1.0 + ROUNDING) + 1e-30, "{n}: {last_j} {now_j} {out:?}");
            last_j = now_j;
        }
    }

    /// Parameters far from any vehicle, inputs of any bits.
    #[test]
    fn any_input_is_refused_or_leaves_all_finite(
        (params, dt) in drawn(FINITE, |d| (vehicle(dq, dc)(d), d.dt())),
        inputs in prop::collection::vec(
            (any_bits(), any_bits(), any_bits(), any_bits(), (any_bits(), any_bits())), 1..20),
    ) {
        let Ok(plant) = params.build(dt) else { return Ok(()) };
        let mut s = plant.at_rest(0.6).unwrap();
        for (torque_nm, duty, auxiliary_w, brake_n, (discharge_a, charge_a)) in inputs {
            let before = format!("{s:?}");
            let input = PowertrainInput {
                road: Road { brake_n, ..Road::default() },
                auxiliary_w,
                limits: CurrentLimits { discharge_a, charge_a },
                ..PowertrainInput::with((Gates::Torque(torque_nm), Gates::On(duty)))
            };
            let out = plant.step(&mut s, input);
            let after = format!("{s:?}");
            prop_assert!(all_finite(&after) && all_finite(&format!("{out:?}")), "{input:?}: {out:?}");
            prop_assert!(!out.rejected || after == before, "{input:?} was refused, and changed it");
        }
    }
}
