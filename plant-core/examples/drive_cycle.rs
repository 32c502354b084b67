//! A vehicle over a small urban cycle: where the energy of its battery went.

use plant_core::powertrain::ledger::EnergyLedger;
use plant_core::presets::EPOWERTRAIN_UDDS as CAR;
use plant_core::signal::sources::{AtEnd, TimeTable, TimeTableParams, TimeTableState};
use plant_core::{
    Driver, DriverInput, DriverState, Dt, Feedback, ParamError, Powertrain, PowertrainInput, must,
};

const DT: Dt = must!(Dt::from_s(0.001));
const PLANT: Powertrain<EnergyLedger> = must!(Powertrain::new(CAR.powertrain, DT)).with_ledger();
const DRIVER: Driver = must!(Driver::new(CAR.driver, &CAR.powertrain, DT));

/// Seconds and metres per second.
const POINTS: &[(f32, f32)] =
    &[(0.0, 0.0), (5.0, 0.0), (17.0, 9.0), (60.0, 9.0), (75.0, 14.0), (110.0, 14.0), (130.0, 0.0)];
const CYCLE: TimeTable =
    must!(TimeTable::new(TimeTableParams { points: POINTS, at_end: AtEnd::Hold }, DT));

fn main() -> Result<(), ParamError> {
    let start = PLANT.at_rest(CAR.initial_soc)?;
    let (mut plant, mut driver, mut cycle) =
        (start, DriverState::default(), TimeTableState::default());
    let mut seen = PLANT.feedback(&plant);
    let mut worst_m_s: f32 = 0.0;
    loop {
        let wanted = CYCLE.step(&mut cycle, ());
        if wanted.ended {
            break;
        }
        let (reference_m_s, reference_m_s2) = (wanted.value, wanted.rate_per_s);
        let input = DriverInput { reference_m_s, reference_m_s2, vehicle: seen };
        let command = DRIVER.step(&mut driver, input);
        seen = Feedback::from(&PLANT.step(&mut plant, PowertrainInput::on(command.duty)));
        worst_m_s = plant_core::num::max(worst_m_s, (seen.speed_m_s - reference_m_s).abs());
    }

    let energy = PLANT.energy(&start, &plant);
    for (name, joule) in energy.terms().into_iter().filter(|(_, joule)| joule.abs() > 36.0) {
        println!("{name:22} {:8.2} Wh", joule / 3600.0);
    }
    let km = plant.body.distance_m.get() / 1000.0;
    let wh_per_km = energy.electrochemical / 3600.0 / km;
    println!("{km:.3} km, {wh_per_km:.1} Wh/km, SOC {:.4}, within {worst_m_s:.3} m/s", seen.soc);

    assert!((km - 1.2435).abs() < 0.001, "the area below the cycle");
    assert!(worst_m_s < 0.1 && seen.soc < CAR.initial_soc);
    assert!((50.0..150.0).contains(&wh_per_km));
    assert!(energy.residual_rel().abs() < 1e-5, "every joule is named");
    Ok(())
}
