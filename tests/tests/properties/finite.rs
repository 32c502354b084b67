//! No input and no permitted parameter makes a component infinite.

use plant_core::Real;
use plant_core::auxiliary::{Auxiliary, AuxiliaryInput};
use plant_core::battery::{Battery, BatteryInput, BatteryState};
use plant_core::battery::{RcBranch, RcBranchInput, RcBranchState};
use plant_core::control::foc::{Foc, FocInput, FocState};
use plant_core::control::pid::{Pid, PidInput, PidState};
use plant_core::converter::{Converter, ConverterInput};
use plant_core::machine::dc::{DcMotor, DcMotorInput, DcMotorSpeedInput, DcMotorState};
use plant_core::machine::pmsm::{Pmsm, PmsmInput, PmsmSpeedInput, PmsmState};
use plant_core::machine::transform::Dq;
use plant_core::mechanics::body::{Body, BodyInput, BodyState, Road};
use plant_core::mechanics::gearbox::{Gearbox, GearboxInput};
use plant_core::mechanics::rotational::{Axis, AxisInput, AxisState};
use plant_core::mechanics::rotational::{
    RotAxis, RotAxisInput, RotAxisParams, RotAxisState, RotationalLoad, RotationalLoadInput,
    RotationalLoadParams, RotationalLoadState,
};
use plant_core::mechanics::slope::{Grade, Slope, SlopeInput, SlopeParams, SlopeState};
use plant_core::mechanics::wheel::{Wheel, WheelInput};
use plant_core::signal::faults::{
    Delay, Drift, DriftParams, DriftState, Lapse, LapseKind, LapseParams, Noise, NoiseParams,
};
use plant_core::signal::sensors::{
    AxialSpeedSensor, AxialSpeedSensorInput, AxialSpeedSensorParams, AxialSpeedSensorState,
    CurrentSensor, CurrentSensorInput, SensorParams, VoltageSensor, VoltageSensorInput,
};
use plant_core::thermal::{
    ThermalNode, ThermalNodeInput, ThermalNodeParams, ThermalNodeState, ThermalPair,
    ThermalPairInput, ThermalPairParams, ThermalPairState,
};
use proptest::prelude::*;

use crate::check::{check, inputs, keeps, positive, signed};
use crate::draw::{self, Draw, PERMITTED, PLAUSIBLE, Spread, drawn};

/// Parameters from all over the spread, and plausible ones.
pub fn some<T: std::fmt::Debug>(
    spread: Spread,
    make: impl Fn(&mut Draw) -> T + Clone,
) -> impl Strategy<Value = T> {
    prop_oneof![drawn(spread, make.clone()), drawn(PLAUSIBLE, make)]
}

#[test]
fn rc_branch() {
    let model = some(PERMITTED, |d| (draw::rc_branch(d), d.dt()));
    check(768, (model, inputs([signed(500.0)])), |((params, dt), inputs)| {
        let model = RcBranch::new(params, dt).unwrap();
        keeps(RcBranchState::default(), &inputs, |s, [discharge_a]| {
            let out = model.step(s, RcBranchInput { discharge_a });
            (out, out.rejected)
        })
    });
}

#[test]
fn battery() {
    let model = some(PERMITTED, |d| (draw::battery(d), d.dt(), d.ratio()));
    check(768, (model, inputs([signed(500.0)])), |((params, dt, soc), inputs)| {
        let model = Battery::new(params, dt).unwrap();
        keeps(BatteryState::rested(soc).unwrap(), &inputs, |s, [current_a]| {
            let out = model.step(s, BatteryInput { current_a });
            (out, out.rejected)
        })
    });
}

#[test]
fn converter() {
    let model = some(PERMITTED, draw::converter);
    check(768, (model, inputs([signed(1.0), signed(500.0), signed(500.0)])), |(params, inputs)| {
        let model = Converter::new(params).unwrap();
        keeps((), &inputs, |s, [duty, input_v, output_a]| {
            let out = model.step(s, ConverterInput { duty, input_v, output_a });
            (out, out.rejected)
        })
    });
}

#[test]
fn auxiliary() {
    let model = some(PERMITTED, draw::auxiliary);
    check(768, (model, inputs([signed(500.0), signed(1e4)])), |(params, inputs)| {
        let model = Auxiliary::new(params).unwrap();
        keeps((), &inputs, |s, [voltage_v, power_w]| {
            let out = model.step(s, AuxiliaryInput { voltage_v, power_w });
            (out, out.rejected)
        })
    });
}

#[test]
fn dc_motor_with_a_free_shaft() {
    let model = some(PERMITTED, |d| (draw::lossy_motor(d), d.dt()));
    check(768, (model, inputs([signed(500.0), signed(300.0)])), |((params, dt), inputs)| {
        let model = DcMotor::new(params, dt).unwrap();
        keeps(DcMotorState::default(), &inputs, |s, [voltage_v, load_nm]| {
            let out = model.step(s, DcMotorInput { voltage_v, load_nm });
            (out, out.rejected)
        })
    });
}

#[test]
fn dc_motor_at_an_imposed_speed() {
    let model = some(PERMITTED, |d| (draw::lossy_motor(d), d.dt()));
    check(768, (model, inputs([signed(500.0), signed(1000.0)])), |((params, dt), inputs)| {
        let model = DcMotor::new(params, dt).unwrap();
        keeps(DcMotorState::default(), &inputs, |s, [voltage_v, speed_rad_s]| {
            let out = model.step_at_speed(s, DcMotorSpeedInput { voltage_v, speed_rad_s });
            (out, out.rejected)
        })
    });
}

#[test]
fn synchronous_machine_with_a_free_shaft() {
    let model = some(PERMITTED, |d| (draw::pmsm(d), d.dt()));
    let inputs = inputs([signed(200.0), signed(200.0), signed(300.0), signed(100.0)]);
    check(768, (model, inputs), |((params, dt), inputs)| {
        let model = Pmsm::new(params, dt).unwrap();
        keeps(PmsmState::default(), &inputs, |s, [d, q, load_nm, winding_c]| {
            let out = model.step(s, PmsmInput { voltage_v: Dq { d, q }, load_nm, winding_c });
            (out, out.rejected)
        })
    });
}

#[test]
fn synchronous_machine_at_an_imposed_speed() {
    let model = some(PERMITTED, |d| (draw::pmsm(d), d.dt()));
    let inputs = inputs([signed(200.0), signed(200.0), signed(1000.0), signed(100.0)]);
    check(768, (model, inputs), |((params, dt), inputs)| {
        let model = Pmsm::new(params, dt).unwrap();
        keeps(PmsmState::default(), &inputs, |s, [d, q, speed_rad_s, winding_c]| {
            let input = PmsmSpeedInput { voltage_v: Dq { d, q }, speed_rad_s, winding_c };
            let out = model.step_at_speed(s, input);
            (out, out.rejected)
        })
    });
}

#[test]
fn field_oriented_control() {
    let model = some(PERMITTED, |d| (draw::foc(d), draw::pmsm(d), d.dt()));
    let inputs =
        inputs([signed(300.0), signed(400.0), signed(400.0), signed(1000.0), positive(500.0)]);
    check(768, (model, inputs), |((params, machine, dt), inputs)| {
        let model = Foc::new(params, machine, dt).unwrap();
        keeps(FocState::default(), &inputs, |s, [torque_nm, d, q, speed_rad_s, bus_v]| {
            let input = FocInput { torque_nm, current_a: Dq { d, q }, speed_rad_s, bus_v };
            let out = model.step(s, input);
            (out, out.rejected)
        })
    });
}

#[test]
fn gearbox() {
    let model = some(PERMITTED, |d| (draw::gearbox(d), d.dt()));
    check(768, (model, inputs([signed(300.0), signed(200.0)])), |((params, dt), inputs)| {
        let model = Gearbox::new(params, dt).unwrap();
        keeps(0.0, &inputs, |s, [motor_nm, wheel_rad_s]| {
            let out = model.step(s, GearboxInput { motor_nm, wheel_rad_s });
            (out, out.rejected)
        })
    });
}

#[test]
fn wheel() {
    let model = some(PERMITTED, |d| (draw::wheel(d), d.dt()));
    check(768, (model, inputs([signed(3000.0), signed(60.0)])), |((params, dt), inputs)| {
        let model = Wheel::new(params, dt).unwrap();
        keeps(0.0, &inputs, |s, [axle_nm, speed_m_s]| {
            let out = model.step(s, WheelInput { axle_nm, speed_m_s });
            (out, out.rejected)
        })
    });
}

#[test]
fn body() {
    let model = some(PERMITTED, |d| (draw::body(d), d.dt()));
    let road = [signed(0.3), signed(1e-3), signed(20.0), positive(5000.0)];
    let [sin, cos, wind, brake] = road;
    let inputs = inputs([signed(5000.0), sin, cos, wind, brake, positive(2.0), positive(2.0)]);
    check(768, (model, inputs), |((params, dt), inputs)| {
        let model = Body::new(params, dt).unwrap();
        keeps(BodyState::default(), &inputs, |s, fields| {
            let [force_n, sin, cos, headwind_m_s, brake_n, air_density_factor, rolling_factor] =
                fields;
            let grade = Grade { sin, cos: cos + Grade::from_sin(sin).cos };
            let road = Road { grade, headwind_m_s, brake_n, air_density_factor, rolling_factor };
            let out = model.step(s, BodyInput { force_n, road });
            (out, out.rejected)
        })
    });
}

#[test]
fn slope() {
    let model = some(PERMITTED, |d| SlopeParams { window_m: d.near(10.0), largest_sin: d.ratio() });
    check(768, (model, inputs([signed(1000.0), signed(1e4)])), |(params, inputs)| {
        let model = Slope::new(params).unwrap();
        keeps(SlopeState::starting_at(0.0, 0.0), &inputs, |s, [height_m, distance_m]| {
            let out = model.step(s, SlopeInput { height_m, distance_m });
            (out, out.rejected)
        })
    });
}

#[test]
fn pid() {
    let model = some(PERMITTED, |d| (draw::pid(d), d.dt()));
    check(768, (model, inputs([signed(30.0), signed(30.0)])), |((params, dt), inputs)| {
        let model = Pid::new(params, dt).unwrap();
        keeps(PidState::default(), &inputs, |s, [reference, measurement]| {
            let out = model.step(s, PidInput { reference, measurement });
            (out, out.rejected)
        })
    });
}

/// A preload is refused as a step is: the state stays as it was, and the next step is finite.
#[test]
fn pid_preload() {
    let model = some(PERMITTED, |d| (draw::pid(d), d.dt()));
    let inputs = inputs([signed(1.0), signed(30.0), signed(30.0)]);
    check(768, (model, inputs), |((params, dt), inputs)| {
        let model = Pid::new(params, dt).unwrap();
        keeps(PidState::default(), &inputs, |s, [output, reference, measurement]| {
            let (input, mut fresh) = (PidInput { reference, measurement }, PidState::default());
            model.preload(&mut fresh, output, input);
            model.preload(s, output, input);
            let mut next = *s;
            let out = model.step(&mut next, PidInput { reference: 10.0, measurement: 9.0 });
            ((next, out), fresh == PidState::default())
        })
    });
}

#[test]
fn rotational_load() {
    let model = some(PERMITTED, |d| {
        let params = RotationalLoadParams {
            inertia_kg_m2: d.near(0.1),
            viscous_nm_s_per_rad: d.near_or(1e-3, 0.0),
            coulomb_nm: d.near_or(0.1, 0.0),
        };
        (params, d.dt())
    });
    check(768, (model, inputs([signed(300.0)])), |((params, dt), inputs)| {
        let model = RotationalLoad::new(params, dt).unwrap();
        keeps(RotationalLoadState::default(), &inputs, |s, [torque_nm]| {
            let out = model.step(s, RotationalLoadInput { torque_nm });
            (out, out.rejected)
        })
    });
}

#[test]
fn axis() {
    check(
        256,
        (some(PERMITTED, Draw::dt), inputs([signed(1000.0), signed(300.0)])),
        |(dt, inputs)| {
            let model = Axis::new(dt);
            keeps(AxisState::default(), &inputs, |s, [speed_rad_s, torque_nm]| {
                let out = model.step(s, AxisInput { speed_rad_s, torque_nm });
                (out, out.rejected)
            })
        },
    );
}

#[test]
fn shaft_with_inertia() {
    let model = some(PERMITTED, |d| (RotAxisParams { inertia_kg_m2: d.near(0.1) }, d.dt()));
    check(768, (model, inputs([signed(300.0), signed(300.0)])), |((params, dt), inputs)| {
        let model = RotAxis::new(params, dt).unwrap();
        keeps(RotAxisState::default(), &inputs, |s, [driving_nm, load_nm]| {
            let out = model.step(s, RotAxisInput { driving_nm, load_nm });
            (out, out.rejected)
        })
    });
}

fn sensor(d: &mut Draw) -> SensorParams {
    SensorParams { gain: d.signed(1.0), offset: d.signed(0.1), quantum: d.near_or(0.01, 0.0) }
}

#[test]
fn sensors() {
    let model =
        some(PERMITTED, |d| (sensor(d), 1 + (65534.0 * f64::from(d.ratio())) as u16, d.dt()));
    check(768, (model, inputs([signed(1000.0)])), |((params, pole_pairs, dt), inputs)| {
        let volts = VoltageSensor::new(params).unwrap();
        let amps = CurrentSensor::new(params).unwrap();
        let params = AxialSpeedSensorParams { speed: params, pole_pairs };
        let speed = AxialSpeedSensor::new(params, dt).unwrap();
        keeps(AxialSpeedSensorState::default(), &inputs, |s, [x]| {
            let v = volts.step(&mut (), VoltageSensorInput { voltage_v: x });
            let a = amps.step(&mut (), CurrentSensorInput { current_a: x });
            let w = speed.step(s, AxialSpeedSensorInput { speed_rad_s: x });
            ((v, a, w), v.rejected && a.rejected && w.rejected)
        })
    });
}

fn thermal_node(d: &mut Draw) -> ThermalNodeParams {
    ThermalNodeParams {
        heat_capacity_j_per_k: d.near_or(1000.0, Real::INFINITY),
        ambient_k_per_w: d.near_or(0.1, Real::INFINITY),
    }
}

#[test]
fn thermal_nodes() {
    let model = some(PERMITTED, |d| {
        let (inner, outer) = (thermal_node(d), thermal_node(d));
        let between_k_per_w = d.near_or(0.05, Real::INFINITY);
        (ThermalPairParams { inner, outer, between_k_per_w }, d.dt())
    });
    let inputs = inputs([signed(2000.0), signed(500.0), signed(50.0)]);
    check(768, (model, inputs), |((params, dt), inputs)| {
        let one = ThermalNode::new(params.inner, dt).unwrap();
        let two: Vec<_> =
            inputs.iter().map(|[heat_w, _, ambient_c]| [*heat_w, *ambient_c]).collect();
        keeps(ThermalNodeState::at(20.0), &two, |s, [heat_w, ambient_c]| {
            let out = one.step(s, ThermalNodeInput { heat_w, ambient_c });
            (out, out.rejected)
        })?;
        let pair = ThermalPair::new(params, dt).unwrap();
        keeps(ThermalPairState::at(20.0), &inputs, |s, [inner_w, outer_w, ambient_c]| {
            let out = pair.step(s, ThermalPairInput { inner_w, outer_w, ambient_c });
            (out, out.rejected)
        })
    });
}

#[test]
fn sensor_faults() {
    let model = some(PERMITTED, |d| {
        let noise = NoiseParams { sd: d.near_or(0.01, 0.0), seed: d.number().to_bits() as u32 };
        let drift = DriftParams { per_s: d.signed(0.01), largest: d.near_or(1.0, 0.0) };
        let kind = if d.seldom() { LapseKind::OpenWire(5.0) } else { LapseKind::Stuck };
        let (from_s, chance) = (d.near_or(1.0, 0.0), d.ratio());
        let length_s = d.near_or(1.0, Real::INFINITY);
        (noise, drift, LapseParams { kind, from_s, chance, length_s, seed: noise.seed }, d.dt())
    });
    check(768, (model, inputs([signed(1000.0)])), |((noise, drift, lapse, dt), inputs)| {
        let (noise, drift) = (Noise::new(noise).unwrap(), Drift::new(drift, dt).unwrap());
        let (lapse, late) = (Lapse::new(lapse, dt).unwrap(), Delay::<3>::new().unwrap());
        keeps(DriftState::default(), &inputs, |s, [x]| {
            let out = drift.step(s, x);
            (out, out.rejected)
        })?;
        keeps(noise.start(), &inputs, |s, [x]| {
            let out = noise.step(s, x);
            (out, out.rejected)
        })?;
        keeps((late.start(0.0).unwrap(), lapse.start()), &inputs, |(l, m), [x]| {
            let (late, lapsed) = (late.step(l, x), lapse.step(m, x));
            ((late, lapsed), late.rejected && lapsed.rejected)
        })
    });
}
