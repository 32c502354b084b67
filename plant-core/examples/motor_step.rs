//! A DC motor from 60 V to 248 V: the published experiment of the laboratory motor
//! [EPowertrain2025, section 5.2.1], current and speed over time.

use plant_core::presets::MOTOR_PASEK;
use plant_core::{DcMotor, DcMotorInput, DcMotorState, Dt, must};

const DT: Dt = must!(Dt::from_s(0.0001));
const MOTOR: DcMotor = must!(DcMotor::new(MOTOR_PASEK, DT));
const RPM: f32 = 60.0 / (2.0 * plant_core::num::PI);

fn main() {
    let mut state = DcMotorState::default();
    let mut run = |steps: u32, voltage_v: f32| {
        let mut out = MOTOR.step(&mut state, DcMotorInput { voltage_v, load_nm: 0.0 });
        for _ in 1..steps {
            out = MOTOR.step(&mut state, DcMotorInput { voltage_v, load_nm: 0.0 });
        }
        out
    };

    let before = run(20_000, 60.0);
    println!("60 V:  {:.4} A, {:.1} rpm", before.current_a, before.speed_rad_s * RPM);

    println!("\n  ms       A      rpm");
    let (mut peak_a, mut peak_ms) = (0.0, 0.0);
    for sample in 1_u8..=200 {
        let out = run(5, 248.0); // half a millisecond
        let ms = 0.5 * f32::from(sample);
        if out.current_a > peak_a {
            (peak_a, peak_ms) = (out.current_a, ms);
        }
        if sample % 20 == 0 {
            println!("{ms:4.0} {:7.3} {:8.1}", out.current_a, out.speed_rad_s * RPM);
        }
    }

    let after = run(20_000, 248.0);
    println!("\n248 V: {:.4} A, {:.1} rpm", after.current_a, after.speed_rad_s * RPM);
    println!("peak:  {peak_a:.3} A after {peak_ms} ms");

    // What an adaptive solver gives.
    assert!((before.current_a - 0.1129).abs() < 1e-3);
    assert!((after.current_a - 0.1661).abs() < 1e-3);
    assert!((after.speed_rad_s * RPM - 1753.0).abs() < 1.0);
    assert!((peak_a - 4.674).abs() < 0.01 && (peak_ms - 29.5).abs() < 1.0);
}
