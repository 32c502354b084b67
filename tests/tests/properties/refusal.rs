//! Every `new` refuses each bad field by name and takes what is valid.

use plant_core::auxiliary::{Auxiliary, AuxiliaryParams};
use plant_core::battery::{
    Battery, BatteryParams, CellSpread, MappedBattery, MappedBatteryParams, OpenCircuit, RcBranch,
    RcBranchParams, SeriesPack, SeriesPackParams, VoltageLimits,
};
use plant_core::control::driver::{Driver, DriverParams, TorqueDriverParams};
use plant_core::control::foc::{Foc, FocParams};
use plant_core::control::pid::{Pid, PidParams};
use plant_core::converter::{Converter, ConverterParams};
use plant_core::machine::dc::{DcMotor, DcMotorParams};
use plant_core::machine::flux::{Flux, LinearFlux};
use plant_core::machine::heated::{DriveThermalParams, HeatedPartParams};
use plant_core::machine::pmsm::{Pmsm, PmsmParams};
use plant_core::mechanics::body::{Body, BodyParams, RoadResistance};
use plant_core::mechanics::gearbox::{Gearbox, GearboxParams};
use plant_core::mechanics::rotational::{
    RotAxis, RotAxisParams, RotationalLoad, RotationalLoadParams,
};
use plant_core::mechanics::slope::{Slope, SlopeParams};
use plant_core::mechanics::wheel::{Wheel, WheelParams};
use plant_core::num::SocTable;
use plant_core::powertrain::{DriveParams, HeatedDriveParams, Powertrain, PowertrainParams};
use plant_core::presets::{BMW_I3_60AH_CONSTANT, EPOWERTRAIN_UDDS, PMSM_EPOWERTRAIN};
use plant_core::signal::faults::{
    Drift, DriftParams, Lapse, LapseKind, LapseParams, Noise, NoiseParams,
};
use plant_core::signal::sensors::{
    AxialSpeedSensor, AxialSpeedSensorParams, SensorParams, VoltageSensor,
};
use plant_core::signal::sources::{
    AtEnd, Ramp, RampParams, Saturation, SaturationParams, Sine, SineParams, Square, SquareParams,
    Step, StepParams, TimeTable, TimeTableParams, UnitDelay, UnitDelayParams,
};
use plant_core::thermal::{
    Conductor, Derating, DriveLosses, ThermalNode, ThermalNodeParams, ThermalPair,
    ThermalPairParams,
};
use plant_core::{Dt, ParamError, Real, must};
use proptest::prelude::*;

use crate::check::cases;
use crate::draw::{self, PERMITTED, drawn};

const DT: Dt = must!(Dt::from_s(1e-3));
const INF: Real = Real::INFINITY;
const NAN: Real = Real::NAN;

// What breaks each rule of `ParamError`.
const POSITIVE: &[Real] = &[0.0, -1.0, 1e-13, 1e13, NAN, INF, -INF];
const NOT_NEGATIVE: &[Real] = &[-1e-9, -1.0, 1e13, NAN, INF, -INF];
const FINITE: &[Real] = &[1e13, -1e13, NAN, INF, -INF];
const LIMIT: &[Real] = &[0.0, -1.0, 1e-13, NAN, -INF];
const RATIO: &[Real] = &[-1e-6, 1.000_001, NAN, INF, -INF];
const EFFICIENCY: &[Real] = &[0.0, -1.0, 1.000_001, NAN, INF, -INF];

/// That `result` is an error about `field`, whatever component it belongs to.
fn assert_refused<T>(result: Result<T, ParamError>, field: &str, bad: &dyn std::fmt::Debug) {
    match result.err().map(ParamError::field) {
        Some(named) if named == field || named.ends_with(&format!(".{field}")) => {}
        Some(named) => panic!("{field} = {bad:?} is refused as {named}"),
        None => panic!("{field} = {bad:?} is accepted"),
    }
}

/// Sets each field to each of its bad values and asks `make`. The pattern names every field of the
/// struct, those that hold no number after `beside`: a new field does not compile until it stands
/// here.
macro_rules! refuses {
    ($make:expr, $params:ident: $base:expr, { $($field:ident: $bad:expr),* $(,)? }
        $(beside $($other:ident),*)?) => {{
        let $params { $($field: _,)* $($($other: _,)*)? } = $base;
        let good = $base;
        assert!($make(good).is_ok(), "{good:?}");
        $(for bad in $bad {
            let mut params = good;
            params.$field = *bad;
            assert_refused($make(params), stringify!($field), bad);
        })*
    }};
}

/// The same for an enum's variant, which is made of all of its fields.
macro_rules! refuses_variant {
    ($make:expr, $enum:ident::$variant:ident: {
        $($field:ident: $value:expr => $bad:expr),* $(,)?
    }) => {{
        let good = $enum::$variant { $($field: $value),* };
        assert!($make(good).is_ok(), "{good:?}");
        $(for bad in $bad {
            let mut params = good;
            if let $enum::$variant { $field, .. } = &mut params {
                *$field = *bad;
            }
            assert_refused($make(params), stringify!($field), bad);
        })*
    }};
}

const PLANT: PowertrainParams = BMW_I3_60AH_CONSTANT.powertrain;

#[test]
fn step() {
    for bad in POSITIVE {
        assert_refused(Dt::from_s(*bad), "dt_s", bad);
    }
}

#[test]
fn battery() {
    let make = |p| Battery::new(p, DT);
    refuses!(make, BatteryParams: PLANT.battery, {
        capacity_ah: POSITIVE,
        series_resistance_ohm: POSITIVE,
        discharge_limit_a: LIMIT,
        charge_limit_a: LIMIT,
    } beside open_circuit, polarisation, voltage_limits);
    let polarisation = PLANT.battery.polarisation;
    refuses!(|p| RcBranch::new(p, DT), RcBranchParams: polarisation, {
        resistance_ohm: POSITIVE,
        capacitance_f: POSITIVE,
    });
    let within = |polarisation| make(BatteryParams { polarisation, ..PLANT.battery });
    refuses!(within, RcBranchParams: polarisation, {
        resistance_ohm: POSITIVE,
        capacitance_f: POSITIVE,
    });
}

#[test]
fn voltage_limits() {
    let good = VoltageLimits { lowest_v: 300.0, highest_v: 400.0 };
    let make = |voltage_limits| Battery::new(BatteryParams { voltage_limits, ..PLANT.battery }, DT);
    refuses!(make, VoltageLimits: good, {
        lowest_v: &[-1e-9, -1.0, 1e13, NAN, INF],
        highest_v: &[0.0, -1.0, 300.0, NAN, -INF],
    });
    let mapped = MappedBatteryParams::constant(PLANT.battery);
    let make =
        |voltage_limits| MappedBattery::new(MappedBatteryParams { voltage_limits, ..mapped }, DT);
    refuses!(make, VoltageLimits: good, {
        lowest_v: &[-1.0, NAN],
        highest_v: &[300.0, NAN],
    });
    assert!(make(VoltageLimits::NONE).is_ok());
}

#[test]
fn cells_in_series() {
    let cell = MappedBatteryParams::constant(PLANT.battery);
    let good = SeriesPackParams { cell, spread: [CellSpread::NONE; 2], neighbour_w_per_k: 0.1 };
    let make = |params: SeriesPackParams<2>| SeriesPack::new(params, DT);
    refuses!(make, SeriesPackParams: good, {
        neighbour_w_per_k: NOT_NEGATIVE,
    } beside cell, spread);
    for i in 0..2 {
        let within = |one: CellSpread| {
            let mut params = good;
            params.spread[i] = one;
            make(params)
        };
        refuses!(within, CellSpread: CellSpread::NONE, {
            capacity_ratio: &[0.0, 0.009, 101.0, NAN, INF, -INF],
            resistance_ratio: &[0.0, 0.009, 101.0, NAN, INF, -INF],
            cooling_ratio: &[-1e-9, 101.0, NAN, INF, -INF],
            self_discharge_a: NOT_NEGATIVE,
            soc_offset: &[-1.001, 1.001, NAN, INF, -INF],
            temperature_offset_k: &[-101.0, 101.0, NAN, INF, -INF],
        });
    }
    let bad = MappedBatteryParams { capacity_ah: NAN, ..cell };
    assert_refused(make(SeriesPackParams { cell: bad, ..good }), "capacity_ah", &NAN);
}

#[test]
fn open_circuit() {
    let make = |open_circuit| Battery::new(BatteryParams { open_circuit, ..PLANT.battery }, DT);
    refuses_variant!(make, OpenCircuit::Linear: {
        empty_v: 300.0 => NOT_NEGATIVE,
        full_v: 400.0 => &[299.9, 0.0, NAN, INF, -INF],
    });
    let falling = SocTable::from_points("points", &[(0.0, 2.0), (1.0, 1.0)]).unwrap();
    assert_refused(make(OpenCircuit::Table(falling)), "table", &falling);
    for bad in FINITE {
        let mut values = [3.7; 65];
        values[40] = *bad;
        assert_refused(SocTable::new("table", values), "table", bad);
        assert_refused(SocTable::from_points("table", &[(0.0, 1.0), (1.0, *bad)]), "table", bad);
    }
    for bad in [0.0, -1.0, 1.01, 50.0, NAN, INF, -INF] {
        assert_refused(SocTable::from_points("table", &[(0.0, 1.0), (bad, 1.0)]), "table", &bad);
    }
}

#[test]
fn auxiliary_and_converter() {
    refuses!(Auxiliary::new, AuxiliaryParams: PLANT.auxiliary, {
        power_w: NOT_NEGATIVE,
        resistance_ohm: LIMIT,
        cut_out_v: LIMIT,
    });
    refuses!(Converter::new, ConverterParams: PLANT.drives.converter, {
        duty_limit: LIMIT,
        constant_loss_w: NOT_NEGATIVE,
        voltage_drop_v: NOT_NEGATIVE,
        resistance_ohm: NOT_NEGATIVE,
        current_limit_a: LIMIT,
    });
}

#[test]
fn motor_and_what_turns() {
    refuses!(|p| DcMotor::new(p, DT), DcMotorParams: PLANT.drives.motor, {
        resistance_ohm: POSITIVE,
        inductance_h: POSITIVE,
        back_emf_v_s_per_rad: POSITIVE,
        torque_nm_per_a: POSITIVE,
        inertia_kg_m2: POSITIVE,
        viscous_nm_s_per_rad: NOT_NEGATIVE,
        coulomb_nm: NOT_NEGATIVE,
    });
    refuses!(|p| Gearbox::new(p, DT), GearboxParams: PLANT.drives.gearbox, {
        ratio: POSITIVE,
        efficiency: EFFICIENCY,
        inertia_kg_m2: NOT_NEGATIVE,
    });
    refuses!(|p| Wheel::new(p, DT), WheelParams: PLANT.wheel, {
        radius_m: POSITIVE,
        inertia_kg_m2: NOT_NEGATIVE,
        viscous_nm_s_per_rad: NOT_NEGATIVE,
    });
    refuses!(|p| RotAxis::new(p, DT), RotAxisParams: RotAxisParams { inertia_kg_m2: 0.1 }, {
        inertia_kg_m2: POSITIVE,
    });
    let load =
        RotationalLoadParams { inertia_kg_m2: 1.0, viscous_nm_s_per_rad: 0.1, coulomb_nm: 0.1 };
    refuses!(|p| RotationalLoad::new(p, DT), RotationalLoadParams: load, {
        inertia_kg_m2: POSITIVE,
        viscous_nm_s_per_rad: NOT_NEGATIVE,
        coulomb_nm: NOT_NEGATIVE,
    });
}

#[test]
fn synchronous_machine_and_its_control() {
    let machine = PMSM_EPOWERTRAIN;
    refuses!(|p| Pmsm::new(p, DT), PmsmParams: machine, {
        resistance_ohm: POSITIVE,
        resistance_per_k: &[-1e-9, 0.008, NAN, INF, -INF],
        pole_pairs: &[0],
        iron_s: NOT_NEGATIVE,
        inertia_kg_m2: POSITIVE,
        viscous_nm_s_per_rad: NOT_NEGATIVE,
        coulomb_nm: NOT_NEGATIVE,
    } beside flux);
    let Flux::Linear(flux) = machine.flux else { panic!("a linear machine") };
    let make = |flux| Pmsm::new(PmsmParams { flux: Flux::Linear(flux), ..machine }, DT);
    refuses!(make, LinearFlux: flux, {
        magnet_wb: &[0.0, -1.0, 1e13, NAN, INF, -INF],
        d_h: POSITIVE,
        q_h: POSITIVE,
    });
    refuses!(|p| Foc::new(p, machine, DT), FocParams: FocParams::DEFAULT, {
        bandwidth_rad_s: LIMIT,
        current_limit_a: LIMIT,
        torque_limit_nm: LIMIT,
        voltage_share: EFFICIENCY,
    });
    let bad = PmsmParams { resistance_ohm: NAN, ..machine };
    assert_refused(Foc::new(FocParams::DEFAULT, bad, DT), "resistance_ohm", &NAN);
}

#[test]
fn body_and_slope() {
    refuses!(|p| Body::new(p, DT), BodyParams: PLANT.body, {
        mass_kg: POSITIVE,
    } beside resistance);
    let make = |resistance| Body::new(BodyParams { resistance, ..PLANT.body }, DT);
    refuses_variant!(make, RoadResistance::Physical: {
        drag_coefficient: 0.3 => NOT_NEGATIVE,
        frontal_area_m2: 2.0 => NOT_NEGATIVE,
        air_density_kg_m3: 1.2 => NOT_NEGATIVE,
        rolling_coefficient: 0.01 => NOT_NEGATIVE,
    });
    refuses_variant!(make, RoadResistance::CoastDown: {
        a_n: 100.0 => NOT_NEGATIVE,
        b_n_s_per_m: 1.0 => &[-12.7, NAN, INF, -INF],
        c_n_s2_per_m2: 0.4 => NOT_NEGATIVE,
    });
    refuses!(Slope::new, SlopeParams: SlopeParams { window_m: 10.0, largest_sin: 0.25 }, {
        window_m: POSITIVE,
        largest_sin: RATIO,
    });
}

/// The plant passes on what any of its parts refuses, and refuses a bad start.
#[test]
fn powertrain() {
    let make = |p| Powertrain::new(p, DT);
    assert!(make(PLANT).is_ok() && Powertrain::new(PLANT, DT).map(Powertrain::with_ledger).is_ok());
    let PowertrainParams { mut battery, mut auxiliary, drives, mut wheel, mut body } = PLANT;
    let DriveParams { mut converter, mut motor, mut gearbox, .. } = drives;
    let with = |drives| PowertrainParams { drives, ..PLANT };
    battery.capacity_ah = NAN;
    auxiliary.cut_out_v = NAN;
    converter.duty_limit = NAN;
    motor.coulomb_nm = NAN;
    gearbox.ratio = NAN;
    wheel.radius_m = NAN;
    body.mass_kg = NAN;
    for (params, field) in [
        (PowertrainParams { battery, ..PLANT }, "battery.capacity_ah"),
        (PowertrainParams { auxiliary, ..PLANT }, "auxiliary.cut_out_v"),
        (with(DriveParams { converter, ..drives }), "converter.duty_limit"),
        (with(DriveParams { motor, ..drives }), "motor.coulomb_nm"),
        (with(DriveParams { gearbox, ..drives }), "gearbox.ratio"),
        (PowertrainParams { wheel, ..PLANT }, "wheel.radius_m"),
        (PowertrainParams { body, ..PLANT }, "body.mass_kg"),
    ] {
        assert_refused(make(params), field, &NAN);
        assert_refused(Powertrain::new(params, DT).map(Powertrain::with_ledger), field, &NAN);
    }
    let plant = make(PLANT).unwrap();
    for bad in RATIO {
        assert_refused(plant.at_rest(*bad), "soc", bad);
    }
    for bad in FINITE {
        assert_refused(plant.at_speed(0.5, *bad), "speed_m_s", bad);
    }
}

const PID: PidParams = PidParams { output_min: -1.0, output_max: 1.0, ..PidParams::DEFAULT };

#[test]
fn pid() {
    refuses!(|p| Pid::new(p, DT), PidParams: PID, {
        proportional: FINITE,
        integral_per_s: NOT_NEGATIVE,
        derivative_s: NOT_NEGATIVE,
        derivative_filter_s: NOT_NEGATIVE,
        dead_zone: NOT_NEGATIVE,
        output_min: &[INF, NAN],
        output_max: &[-1.0, -2.0, -INF, NAN],
        smoothing_per_s: LIMIT,
    } beside derivative_of, anti_windup);
}

#[test]
fn drivers() {
    let make = |p| Driver::new(p, &PLANT, DT);
    let DriverParams::Torque(torque) = BMW_I3_60AH_CONSTANT.driver else {
        panic!("a torque driver")
    };
    refuses!(|p| make(DriverParams::Torque(p)), TorqueDriverParams: torque, {
        peak_torque_nm: LIMIT,
        peak_power_w: LIMIT,
        regen_torque_nm: NOT_NEGATIVE,
        regen_power_w: LIMIT,
        regen_fade_m_s: POSITIVE,
        regen_fade_soc: POSITIVE,
        brake_limit_n: POSITIVE,
        current_rate_per_s: POSITIVE,
    } beside speed);
    let speed = PidParams { proportional: NAN, ..torque.speed };
    let bad = DriverParams::Torque(TorqueDriverParams { speed, ..torque });
    assert_refused(make(bad), "proportional", &NAN);
    assert_refused(make(DriverParams::Duty(speed)), "proportional", &NAN);
    assert!(Driver::new(EPOWERTRAIN_UDDS.driver, &PLANT, DT).is_ok());
}

#[test]
fn sensors() {
    let sensor = SensorParams { quantum: 0.1, ..SensorParams::IDEAL };
    refuses!(VoltageSensor::new, SensorParams: sensor, {
        gain: FINITE,
        offset: FINITE,
        quantum: &[-0.1, 1e-13, 1e13, NAN, INF, -INF],
    });
    let shaft = AxialSpeedSensorParams { speed: sensor, pole_pairs: 4 };
    refuses!(|p| AxialSpeedSensor::new(p, DT), AxialSpeedSensorParams: shaft, {
        pole_pairs: &[0],
    } beside speed);
    let speed = SensorParams { gain: NAN, ..sensor };
    let bad = AxialSpeedSensorParams { speed, ..shaft };
    assert_refused(AxialSpeedSensor::new(bad, DT), "gain", &NAN);
}

#[test]
fn sensor_faults() {
    let make = |NoiseParams { sd, seed }| Noise::new(NoiseParams { sd, seed });
    refuses!(make, NoiseParams: NoiseParams { sd: 0.1, seed: 1 }, { sd: NOT_NEGATIVE } beside seed);
    refuses!(|p| Drift::new(p, DT), DriftParams: DriftParams { per_s: 0.1, largest: 1.0 }, {
        per_s: FINITE,
        largest: NOT_NEGATIVE,
    });
    let kind = LapseKind::Stuck;
    let lapse = LapseParams { kind, from_s: 1.0, chance: 0.1, length_s: 1.0, seed: 1 };
    refuses!(|p| Lapse::new(p, DT), LapseParams: lapse, {
        from_s: NOT_NEGATIVE,
        chance: RATIO,
        length_s: LIMIT,
    } beside kind, seed);
    for bad in [1e10, -1e13, NAN, INF] {
        let open = LapseParams { kind: LapseKind::OpenWire(bad), ..lapse };
        assert_refused(Lapse::new(open, DT), "open_wire", &bad);
    }
}

#[test]
fn thermal() {
    let node = ThermalNodeParams { heat_capacity_j_per_k: 500.0, ambient_k_per_w: 0.1 };
    refuses!(|p| ThermalNode::new(p, DT), ThermalNodeParams: node, {
        heat_capacity_j_per_k: LIMIT,
        ambient_k_per_w: LIMIT,
    });
    let pair = ThermalPairParams { inner: node, outer: node, between_k_per_w: 0.2 };
    refuses!(|p| ThermalPair::new(p, DT), ThermalPairParams: pair, {
        between_k_per_w: LIMIT,
    } beside inner, outer);
    for within in [
        |node| {
            ThermalPair::new(
                ThermalPairParams { inner: node, outer: node, between_k_per_w: 1.0 },
                DT,
            )
        },
        |outer| {
            ThermalPair::new(
                ThermalPairParams { inner: ThermalNodeParams::FIXED, outer, between_k_per_w: 1.0 },
                DT,
            )
        },
    ] {
        refuses!(within, ThermalNodeParams: node, {
            heat_capacity_j_per_k: LIMIT,
            ambient_k_per_w: LIMIT,
        });
    }
    refuses!(Derating::checked, Derating: Derating { derate_from_c: 100.0, derate_to_c: 150.0 }, {
        derate_from_c: &[-274.0, NAN, -INF],
        derate_to_c: &[100.0, 0.0, NAN, -INF],
    });
    refuses!(Conductor::checked, Conductor: Conductor::COPPER, {
        reference_c: &[-101.0, 301.0, NAN, INF],
        per_k: &[-1e-9, 0.021, NAN, INF],
    });
    let part = HeatedPartParams {
        heat_capacity_j_per_k: 500.0,
        coolant_k_per_w: 0.1,
        derate_from_c: 100.0,
        derate_to_c: 150.0,
    };
    let warm = DriveThermalParams { machine: part, inverter: part, ..DriveThermalParams::NONE };
    let car = BMW_I3_60AH_CONSTANT.powertrain;
    let heated = |thermal| HeatedDriveParams { drive: car.drives, thermal }.on(car.wheel, DT);
    for within in [
        |machine, warm| DriveThermalParams { machine, ..warm },
        |inverter, warm| DriveThermalParams { inverter, ..warm },
    ] {
        refuses!(|part| heated(within(part, warm)), HeatedPartParams: part, {
            heat_capacity_j_per_k: LIMIT,
            coolant_k_per_w: LIMIT,
            derate_from_c: &[-274.0, NAN, -INF],
            derate_to_c: &[100.0, 0.0, NAN, -INF],
        });
    }
    refuses!(heated, DriveThermalParams: warm, {
        coolant_c: &[-101.0, 201.0, NAN, INF],
    } beside machine, inverter, winding);
    refuses!(|winding| heated(DriveThermalParams { winding, ..warm }), Conductor: Conductor::COPPER, {
        reference_c: &[-101.0, 301.0, NAN, INF],
        per_k: &[-1e-9, 0.021, NAN, INF],
    });
    let losses = DriveLosses::of_dc_machine(0.27, 3e-3, 2.7, 1e-3, 30.0);
    refuses!(DriveLosses::checked, DriveLosses: losses, {
        torque_w_per_nm2: NOT_NEGATIVE,
        torque_w_per_nm: NOT_NEGATIVE,
        speed_w_s2: NOT_NEGATIVE,
        constant_w: NOT_NEGATIVE,
    });
}

#[test]
fn time_table() {
    let make = |points: &[(Real, Real)], at_end| {
        TimeTable::new(TimeTableParams { points, at_end }, DT).map(|_| ())
    };
    let points = [(0.0, 1.0), (1.0, 2.0), (2.0, 1.0)];
    for at_end in [AtEnd::Hold, AtEnd::Repeat] {
        assert!(make(&points, at_end).is_ok());
        for bad in FINITE {
            for i in 0..3 {
                let (mut times, mut values) = (points, points);
                (times[i].0, values[i].1) = (*bad, *bad);
                assert_refused(make(&times, at_end), "time_s", &times);
                assert_refused(make(&values, at_end), "value", &values);
            }
        }
        assert_refused(make(&points[..1], at_end), "time_s", &1);
        assert_refused(make(&[(1.0, 0.0), (1.0, 0.0)], at_end), "time_s", &"not increasing");
    }
    assert_refused(
        make(&[(0.0, 1.0), (5e-4, 2.0)], AtEnd::Repeat),
        "time_s",
        &"shorter than a step",
    );
}

#[test]
fn sources() {
    let step = StepParams { before: 0.0, after: 1.0, at_s: 1.0 };
    refuses!(|p| Step::new(p, DT), StepParams: step, {
        before: FINITE,
        after: FINITE,
        at_s: NOT_NEGATIVE,
    });
    let ramp = RampParams { start: 0.0, slope_per_s: 1.0, from_s: 1.0, to_s: 2.0 };
    refuses!(|p| Ramp::new(p, DT), RampParams: ramp, {
        start: FINITE,
        slope_per_s: FINITE,
        from_s: NOT_NEGATIVE,
        to_s: &[1.0, 0.5, 1e13, NAN, INF, -INF],
    });
    let sine = SineParams { amplitude: 1.0, offset: 0.0, frequency_hz: 50.0, phase_turns: 0.0 };
    refuses!(|p| Sine::new(p, DT), SineParams: sine, {
        amplitude: FINITE,
        offset: FINITE,
        frequency_hz: POSITIVE,
        phase_turns: RATIO,
    });
    let square =
        SquareParams { low: 0.0, high: 1.0, period_s: 0.02, on_ratio: 0.5, phase_turns: 0.0 };
    refuses!(|p| Square::new(p, DT), SquareParams: square, {
        low: FINITE,
        high: FINITE,
        period_s: POSITIVE,
        on_ratio: RATIO,
        phase_turns: RATIO,
    });
    refuses!(UnitDelay::new, UnitDelayParams: UnitDelayParams { initial: 0.0 }, {
        initial: FINITE,
    });
    refuses!(Saturation::new, SaturationParams: SaturationParams { low: -1.0, high: 1.0 }, {
        low: FINITE,
        high: &[-1.0, -2.0, NAN, INF, -INF],
    });
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn what_is_permitted_is_taken(
        (plant, torque, pid, dt) in drawn(PERMITTED, |d| {
            (draw::plant(d), draw::torque_driver(d), draw::pid(d), d.dt())
        }),
        motor in drawn(PERMITTED, draw::lossy_motor),
    ) {
        let plant = PowertrainParams { drives: DriveParams { motor, ..plant.drives }, ..plant };
        prop_assert_eq!(Powertrain::new(plant, dt).err(), None);
        prop_assert_eq!(Powertrain::new(plant, dt).map(Powertrain::with_ledger).err(), None);
        prop_assert_eq!(Driver::new(DriverParams::Torque(torque), &plant, dt).err(), None);
        prop_assert_eq!(Driver::new(DriverParams::Duty(pid), &plant, dt).err(), None);
        prop_assert_eq!(Pid::new(pid, dt).err(), None);
    }
}
