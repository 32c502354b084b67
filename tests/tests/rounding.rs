//! How far f32 is from the same sources in f64, after UDDS and after ten hours of it.

/// Each energy term, relative to itself where it is at all large …
const ENERGY: f64 = 1e-5;
/// … that is, above this share of the throughput; a smaller one relative to this share of it.
const LARGE: f64 = 1e-3;
/// What the step itself dissipates is made of squares of small increments.
const NUMERICAL: f64 = 5e-5;
/// Of the state of charge.
const SOC: f64 = 1e-6;
/// Of the distance.
const DISTANCE: f64 = 1e-6;

/// What a run came to.
#[derive(Clone, Debug, Default)]
struct Figures {
    soc: f64,
    distance_m: f64,
    energy_j: Vec<(&'static str, f64)>,
}

impl Figures {
    fn energy(&self, term: &str) -> f64 {
        self.energy_j.iter().find(|(name, _)| *name == term).unwrap().1
    }
}

/// Drives UDDS `times` times in steps of 1 ms, and charges in between; `$real` is the scalar of
/// `$core`.
macro_rules! in_precision {
    ($module:ident, $core:ident, $real:ty) => {
        pub mod $module {
            use super::Figures;
            use $core::Dt;
            use $core::battery::BatteryInput;
            use $core::control::driver::{Driver, DriverInput, DriverState};
            use $core::powertrain::{Feedback, Powertrain, PowertrainInput};
            use $core::presets::EPOWERTRAIN_UDDS;

            const STEPS_PER_S: u32 = 1000;
            const CHARGE_A: $real = -100.0;
            const CHARGE_STEPS: u32 = 62_640;

            pub fn udds(points: &[(f32, f32)], times: u32) -> Figures {
                let dt = Dt::from_s(1e-3).unwrap();
                let vehicle = &EPOWERTRAIN_UDDS;
                let plant = Powertrain::new(vehicle.powertrain, dt).unwrap().with_ledger();
                let driver = Driver::new(vehicle.driver, &vehicle.powertrain, dt).unwrap();
                let mut state = plant.at_rest(vehicle.initial_soc).unwrap();
                let mut driving = DriverState::default();
                let mut figures = Figures::default();
                for time in 0..times {
                    if time > 0 {
                        for _ in 0..CHARGE_STEPS {
                            let input = BatteryInput { current_a: CHARGE_A };
                            assert!(!plant.battery().step(&mut state.battery, input).rejected);
                        }
                    }
                    let mut feedback = plant.feedback(&state);
                    for pair in points.windows(2) {
                        let (v0, v1) = (<$real>::from(pair[0].1), <$real>::from(pair[1].1));
                        for number in 0..STEPS_PER_S {
                            let along = number as $real / STEPS_PER_S as $real;
                            let input = DriverInput {
                                reference_m_s: v0 + (v1 - v0) * along,
                                reference_m_s2: 0.0,
                                vehicle: feedback,
                            };
                            let duty = driver.step(&mut driving, input).duty;
                            let input = PowertrainInput::on(duty);
                            feedback = Feedback::from(&plant.step(&mut state, input));
                        }
                    }
                }
                // The ledger holds every drive but no charging in between.
                let whole = plant.at_rest(vehicle.initial_soc).unwrap();
                let terms = plant.energy(&whole, &state).terms();
                figures.energy_j = terms.map(|(n, j)| (n, f64::from(j))).to_vec();
                figures.soc = f64::from(state.battery.soc.get());
                figures.distance_m = f64::from(state.body.distance_m.get());
                figures
            }
        }
    };
}

#[allow(clippy::cast_precision_loss, clippy::cast_lossless, clippy::useless_conversion)]
mod precisions {
    use super::Figures;
    in_precision!(single, plant_core, f32);
    in_precision!(double, plant_core_f64, f64);
}
use precisions::{double, single};

/// Both precisions side by side; every difference is printed, and held to its bound.
#[track_caller]
fn compare(name: &str, times: u32) {
    let points = voltstep::read::cycle::by_name("udds").unwrap().points;
    let (ours, exact) = std::thread::scope(|scope| {
        let ours = scope.spawn(|| single::udds(&points, times));
        let exact = scope.spawn(|| double::udds(&points, times));
        (ours.join().unwrap(), exact.join().unwrap())
    });
    let soc = ours.soc - exact.soc;
    let distance = ours.distance_m / exact.distance_m - 1.0;
    println!("{name}: SOC {soc:+.2e} (bound {SOC:.0e}), distance {distance:+.2e} ({DISTANCE:.0e})");
    let throughput = exact.energy("throughput");
    for (term, j) in &exact.energy_j {
        // These two are differences: their bound is that of the ledger; the charging in between
        // is part of the second.
        if ["residual", "open_circuit_explicit"].contains(term) {
            continue;
        }
        let off = (ours.energy(term) - j) / j.abs().max(LARGE * throughput);
        let bound = if *term == "numerical" { NUMERICAL } else { ENERGY };
        println!("  {term}: {j:.6e} J, {off:+.2e} (bound {bound:.0e})");
        assert!(off.abs() <= bound, "{name}: {term} {off}");
    }
    let residual = ours.energy("residual") / throughput;
    println!("  residual {residual:+.2e} of the throughput (bound 1e-6)");
    assert!(residual.abs() <= 1e-6, "{name}: residual {residual}");
    assert!(soc.abs() <= SOC, "{name}: SOC {soc}");
    assert!(distance.abs() <= DISTANCE, "{name}: distance {distance}");
}

#[test]
fn after_udds_single_precision_is_as_good_as_double() {
    compare("UDDS", 1);
}

#[test]
fn after_ten_hours_too() {
    compare("ten hours of UDDS", 27);
}
