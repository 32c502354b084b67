//! The Kalman filter on a simulated cell: it starts with nothing known, its current sensor has an
//! offset, its voltage noise; what it says, how sure it is, and the truth.

use plant_core::battery::MappedBatteryInput;
use plant_core::presets::PANASONIC_NCR18650PF as CELL;
use plant_core::{MappedBattery, must};
use voltstep_bms::{Dt, Ekf, EkfInput, EkfParams, ParamError};

const DT: Dt = must!(Dt::from_s(0.1));
const TRUTH: MappedBattery = must!(MappedBattery::new(CELL, DT));
const FILTER: Ekf = must!(Ekf::new(EkfParams::typical(CELL, 3.65), DT));
const OFFSET_A: f32 = 0.02;

fn main() -> Result<(), ParamError> {
    let mut truth = TRUTH.rested_at(0.85, 25.0)?;
    let mut filter = FILTER.start_unknown(25.0)?;

    println!("  min     SOC      ±   truth");
    for minute in 0_u16..40 {
        for tenth in 0_u16..600 {
            // A minute of driving: 3 A, a second of 8 A now and then, some regeneration.
            let current_a = match tenth / 10 % 20 {
                0 => 8.0,
                1..=13 => 3.0,
                14..=16 => -1.5,
                _ => 0.0,
            };
            let cell = TRUTH.step(&mut truth, MappedBatteryInput { current_a });
            let noise_v = 0.002 * f32::from((tenth * 7 + minute * 3) % 11) / 5.0 - 0.002;
            FILTER.step(
                &mut filter,
                EkfInput {
                    current_a: current_a + OFFSET_A,
                    voltage_v: cell.terminal_v + noise_v,
                    temperature_c: cell.temperature_c,
                    contactors_open: false,
                },
            );
        }
        let (estimate, soc) = (FILTER.estimate(&filter), truth.soc.get());
        if minute % 5 == 4 {
            println!("{:5} {:7.4} {:6.4} {soc:7.4}", minute + 1, estimate.soc, estimate.soc_sd);
        }
        assert!((estimate.soc - soc).abs() < 3.0 * estimate.soc_sd, "{estimate:?}, truth {soc}");
    }

    let (estimate, soc) = (FILTER.estimate(&filter), truth.soc.get());
    assert!((estimate.soc - soc).abs() < 0.02 && estimate.soc_sd < 0.03);
    assert!(soc < 0.5, "the cell was driven far enough");
    Ok(())
}
