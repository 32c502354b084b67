//! Mirrored inputs give the mirrored motion, bit for bit: nothing in the plant knows forward from
//! backward.

use plant_core::control::foc::{Foc, FocInput, FocState};
use plant_core::converter::Gates;
use plant_core::machine::dc::{DcMotor, DcMotorInput, DcMotorState};
use plant_core::machine::pmsm::{Pmsm, PmsmInput, PmsmState};
use plant_core::machine::transform::Dq;
use plant_core::mechanics::body::Road;
use plant_core::mechanics::slope::Grade;
use plant_core::port::Slip;
use plant_core::powertrain::{Powertrain, PowertrainInput};
use plant_core::{Accum, Dt, Real};
use proptest::prelude::*;

use crate::check::{cases, log, positive, signed};
use crate::draw::{self, PLAUSIBLE, drawn};

fn mirrored(input: PowertrainInput) -> PowertrainInput {
    let Road { grade, headwind_m_s, .. } = input.road;
    let grade = Grade { sin: -grade.sin, ..grade };
    let road = Road { grade, headwind_m_s: -headwind_m_s, ..input.road };
    PowertrainInput { gates: Gates::On(-input.gates.modulation().unwrap()), road, ..input }
}

fn opposite(slip: Slip) -> Slip {
    match slip {
        Slip::Forward => Slip::Backward,
        Slip::Backward => Slip::Forward,
        Slip::Stuck => Slip::Stuck,
    }
}

proptest! {
    #![proptest_config(cases(1024))]

    /// Limits, losses, brake and auxiliary loads included.
    #[test]
    fn powertrain(
        params in drawn(PLAUSIBLE, draw::plant),
        dt_s in log(1e-5, 1.0),
        soc in 0.0..=1.0_f32,
        speed in signed(40.0),
        current in signed(500.0),
        inputs in prop::collection::vec(
            (signed(1.1), signed(0.2), signed(20.0), positive(5000.0), positive(5000.0)),
            1..50,
        ),
    ) {
        let plant = Powertrain::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let (mut s, mut m) = (plant.at_speed(soc, speed).unwrap(), plant.at_speed(soc, -speed).unwrap());
        (s.drives, m.drives) = (Accum::new(current), Accum::new(-current));
        for (duty, sin, headwind_m_s, brake_n, auxiliary_w) in inputs {
            let road = Road { grade: Grade::from_sin(sin), headwind_m_s, brake_n, ..Road::default() };
            let input = PowertrainInput { road, auxiliary_w, ..PowertrainInput::on(duty) };
            let (out, mirror) = (plant.step(&mut s, input), plant.step(&mut m, mirrored(input)));
            let moves = [out.drives.duty, out.speed_m_s, out.distance_m, out.drives.motor_a, out.drives.motor_nm];
            let mirror_moves =
                [mirror.drives.duty, mirror.speed_m_s, mirror.distance_m, mirror.drives.motor_a, mirror.drives.motor_nm];
            prop_assert_eq!(moves, mirror_moves.map(|x| -x), "{:?} {:?}", input, out);
            let battery = [out.battery_a, out.battery_v, out.soc];
            prop_assert_eq!(battery, [mirror.battery_a, mirror.battery_v, mirror.soc]);
            prop_assert_eq!(out.flows, mirror.flows);
            prop_assert_eq!((out.limited, out.slip), (mirror.limited, opposite(mirror.slip)));
        }
    }

    #[test]
    fn dc_motor(
        params in drawn(PLAUSIBLE, draw::lossy_motor),
        dt_s in log(1e-6, 1.0),
        inputs in prop::collection::vec((signed(400.0), signed(300.0)), 1..50),
    ) {
        let motor = DcMotor::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let (mut s, mut m) = (DcMotorState::default(), DcMotorState::default());
        for (voltage_v, load_nm) in inputs {
            let out = motor.step(&mut s, DcMotorInput { voltage_v, load_nm });
            let mirror =
                motor.step(&mut m, DcMotorInput { voltage_v: -voltage_v, load_nm: -load_nm });
            prop_assert_eq!(
                [out.current_a, out.speed_rad_s, out.shaft_nm],
                [mirror.current_a, mirror.speed_rad_s, mirror.shaft_nm].map(|x| -x)
            );
            prop_assert_eq!([out.copper_w, out.friction_w], [mirror.copper_w, mirror.friction_w]);
        }
    }

    /// Under control, its limits included; the d axis is the same in both directions.
    #[test]
    fn synchronous_machine_under_control(
        (params, control) in drawn(PLAUSIBLE, |d| (draw::pmsm(d), draw::foc(d))),
        dt_s in log(1e-6, 1e-2),
        inputs in prop::collection::vec((signed(300.0), signed(100.0), positive(500.0)), 1..50),
    ) {
        let dt = Dt::from_s(dt_s).unwrap();
        let (machine, foc) =
            (Pmsm::new(params, dt).unwrap(), Foc::new(control, params, dt).unwrap());
        let mut directions = [1.0, -1.0].map(|direction| (direction, FocState::default(), PmsmState::default()));
        for (torque_nm, load_nm, bus_v) in inputs {
            let [there, back] = directions.each_mut().map(|(direction, control, state)| {
                let input = FocInput {
                    torque_nm: *direction * torque_nm,
                    current_a: state.current_a(),
                    speed_rad_s: state.speed_rad_s.get(),
                    bus_v,
                };
                let told = foc.step(control, input);
                let out =
                    machine.step(state, PmsmInput::cold(told.voltage_v, *direction * load_nm));
                let flip = |v: Dq| [v.d, *direction * v.q];
                let vectors = [told.voltage_v, told.reference_a, out.current_a, out.flux_wb];
                let moves = [out.speed_rad_s, out.torque_nm, out.shaft_nm, told.torque_nm];
                let flags = [told.weakened, told.limited, told.saturated, told.rejected];
                let moves: [Real; 4] = moves.map(|x| *direction * x);
                (vectors.map(flip), moves, flags, [out.electrical_w, out.copper_w, out.iron_w])
            });
            prop_assert_eq!(there, back);
        }
    }
}
