//! Without a source the stored energy never rises.

use plant_core::auxiliary::AuxiliaryParams;
use plant_core::converter::ConverterParams;
use plant_core::machine::dc::{DcMotor, DcMotorInput, DcMotorParams, DcMotorState};
use plant_core::machine::flux::Flux;
use plant_core::machine::pmsm::{Pmsm, PmsmInput, PmsmState};
use plant_core::machine::transform::Dq;
use plant_core::mechanics::body::Road;
use plant_core::powertrain::{DriveParams, Powertrain, PowertrainInput, PowertrainParams};
use plant_core::{Accum, Dt, Real};
use proptest::prelude::*;

use crate::check::{cases, log, positive, signed};
use crate::draw::{self, Draw, PLAUSIBLE, drawn};

/// Whether stored energy rose from one step to the next beyond what rounding of speed and current
/// makes of it; below 1e-30 J speeds are too small to be rounded well.
fn rose(from_j: f64, to_j: f64) -> bool {
    to_j > from_j * (1.0 + 1e-6) + 1e-30
}

/// Kinetic, weighted with Ke/Kt, and inductive energy \[J\]. With Ke = Kt that is the energy
/// itself. Otherwise the machine's constants create or destroy energy, of either sign; weighted,
/// what one side gives the other side takes, and only losses remain.
fn weighted_j(mass_kg: Real, speed: Real, motor: &DcMotorParams, current_a: Real) -> f64 {
    let ke_per_kt = f64::from(motor.back_emf_v_s_per_rad) / f64::from(motor.torque_nm_per_a);
    0.5 * ke_per_kt * f64::from(mass_kg) * f64::from(speed).powi(2)
        + 0.5 * f64::from(motor.inductance_h) * f64::from(current_a).powi(2)
}

fn passive_plant(d: &mut Draw) -> PowertrainParams {
    let motor = if d.seldom() { draw::lossy_motor(d) } else { draw::motor(d) };
    let plant = draw::plant(d);
    let converter = ConverterParams { constant_loss_w: 0.0, ..plant.drives.converter };
    let drives = DriveParams { converter, motor, ..plant.drives };
    PowertrainParams { auxiliary: AuxiliaryParams::NONE, drives, ..plant }
}

proptest! {
    #![proptest_config(cases(1024))]

    /// Rolling on a flat road without wind, winding shorted, battery resting.
    #[test]
    fn powertrain_at_duty_zero(
        params in drawn(PLAUSIBLE, passive_plant),
        dt_s in log(1e-5, 1.0),
        speed in signed(60.0),
        current in signed(2000.0),
        rc_v in signed(10.0),
        brake_n in positive(5000.0),
    ) {
        let plant = Powertrain::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let mut s = plant.at_speed(0.5, speed).unwrap();
        s.drives = Accum::new(current);
        s.battery.rc.voltage_v = Accum::new(rc_v);
        let input = PowertrainInput {
            road: Road { brake_n, ..Road::default() },
            ..PowertrainInput::on(0.0)
        };
        let farad = f64::from(params.battery.polarisation.capacitance_f);
        let (mut last_j, mut last_c_j) = (f64::INFINITY, f64::INFINITY);
        for step in 0..200 {
            let (v, i) = (s.body.speed_m_s.get(), s.drives.get());
            let stored_j = weighted_j(plant.moving_mass_kg(), v, &params.drives.motor, i);
            let capacitive_j = 0.5 * farad * f64::from(s.battery.rc.voltage_v.get()).powi(2);
            prop_assert!(!rose(last_j, stored_j), "{step}: {last_j} {stored_j}");
            prop_assert!(!rose(last_c_j, capacitive_j), "{step}: {s:?}");
            (last_j, last_c_j) = (stored_j, capacitive_j);
            let out = plant.step(&mut s, input);
            prop_assert!(!out.rejected && out.battery_a == 0.0, "{step}: {out:?}");
        }
    }

    /// A shorted motor with a free shaft.
    #[test]
    fn dc_motor_at_zero_volts(
        params in prop_oneof![drawn(PLAUSIBLE, draw::motor), drawn(PLAUSIBLE, draw::lossy_motor)],
        dt_s in log(1e-6, 1.0),
        speed in signed(1000.0),
        current in signed(1000.0),
    ) {
        let motor = DcMotor::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let mut s = DcMotorState {
            current_a: Accum::new(current),
            speed_rad_s: Accum::new(speed),
        };
        let mut last_j = f64::INFINITY;
        for step in 0..200 {
            let (w, i) = (s.speed_rad_s.get(), s.current_a.get());
            let stored_j = weighted_j(params.inertia_kg_m2, w, &params, i);
            prop_assert!(!rose(last_j, stored_j), "{step}: {last_j} {stored_j}");
            last_j = stored_j;
            let out = motor.step(&mut s, DcMotorInput { voltage_v: 0.0, load_nm: 0.0 });
            prop_assert!(!out.rejected);
        }
    }

    /// A shorted synchronous machine with a free shaft, however far it turns in a step.
    #[test]
    fn synchronous_machine_at_zero_volts(
        params in drawn(PLAUSIBLE, draw::pmsm),
        dt_s in log(1e-6, 10.0),
        speed in signed(1000.0),
        currents in (signed(1000.0), signed(1000.0)),
    ) {
        let machine = Pmsm::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let Flux::Linear(flux) = params.flux else { panic!("drawn linear") };
        let stored = |s: &PmsmState| {
            let square = |x: Accum| f64::from(x.get()).powi(2);
            0.5 * f64::from(params.inertia_kg_m2) * square(s.speed_rad_s)
                + 0.75 * f64::from(flux.d_h) * square(s.d_a)
                + 0.75 * f64::from(flux.q_h) * square(s.q_a)
        };
        let mut s = PmsmState {
            d_a: Accum::new(currents.0),
            q_a: Accum::new(currents.1),
            speed_rad_s: Accum::new(speed),
        };
        let mut last_j = f64::INFINITY;
        for step in 0..200 {
            let stored_j = stored(&s);
            prop_assert!(!rose(last_j, stored_j), "{step}: {last_j} {stored_j}");
            last_j = stored_j;
            prop_assert!(!machine.step(&mut s, PmsmInput::cold(Dq::ZERO, 0.0)).rejected);
        }
    }
}
