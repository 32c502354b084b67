//! Order of convergence and stability, in the f64 twin: there rounding does not hide the error of
//! the step. What must hold in f32 too is run in both.

use plant_core_f64::battery::{
    Battery, BatteryInput, BatteryState, RcBranch, RcBranchInput, RcBranchParams, RcBranchState,
};
use plant_core_f64::control::driver::{Driver, DriverInput, DriverState};
use plant_core_f64::control::foc::{Foc, FocInput, FocParams, FocState};
use plant_core_f64::control::pid::{Pid, PidInput, PidParams, PidState};
use plant_core_f64::machine::dc::{DcMotor, DcMotorInput, DcMotorState};
use plant_core_f64::machine::pmsm::{Pmsm, PmsmInput, PmsmState};
use plant_core_f64::mechanics::body::{Body, BodyInput, BodyState};
use plant_core_f64::mechanics::rotational::{
    RotationalLoad, RotationalLoadInput, RotationalLoadParams, RotationalLoadState,
};
use plant_core_f64::powertrain::{Feedback, Powertrain, PowertrainInput};
use plant_core_f64::presets::{
    BMW_I3_60AH_EPOWERTRAIN, CONVERTER_BENCH_LOAD, EPOWERTRAIN_UDDS, MOTOR_PASEK, PMSM_EPOWERTRAIN,
    Vehicle,
};
use plant_core_f64::{Accum, Dt};

/// The order that must be seen.
const ORDER: f64 = 0.95;
/// The longest step \[s\]; halved ten times it is 10 µs.
const LONGEST_S: f64 = 0.01;
const HALVINGS: u32 = 10;

fn dt(s: f64) -> Dt {
    Dt::from_s(s).unwrap()
}

/// A smooth input between 0 and 1 that begins at rest.
fn smooth(t: f64) -> f64 {
    0.5 * (1.0 - (4.0 * t).cos())
}

/// Values at the instants that all steps have in common: every `1 << halvings` steps.
fn at_common_instants(
    longest_s: f64,
    halvings: u32,
    duration_s: f64,
    mut step: impl FnMut(f64) -> f64,
) -> Vec<f64> {
    let h = longest_s / f64::from(1_u32 << halvings);
    let mut values = Vec::new();
    let instants = (duration_s / longest_s).round();
    let mut number = 0.0;
    while number < instants {
        let mut value = 0.0;
        for part in 0..1_u32 << halvings {
            value = step(number * longest_s + f64::from(part) * h);
        }
        values.push(value);
        number += 1.0;
    }
    values
}

/// The largest difference.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Halves the step again and again. The differences between one step and the next must fall with
/// the order, over the whole range and at its end.
#[track_caller]
fn converges(name: &str, halvings: u32, run: impl Fn(u32) -> Vec<f64>) {
    let runs: Vec<_> = (0..=halvings).map(run).collect();
    let differences: Vec<_> = runs.windows(2).map(|pair| apart(&pair[0], &pair[1])).collect();
    let orders: Vec<_> = differences.windows(2).map(|d| (d[0] / d[1]).log2()).collect();
    let (first, last) = (differences[0], differences[differences.len() - 1]);
    let overall = (first / last).log2() / f64::from(halvings - 1);
    let shown: Vec<_> = orders.iter().map(|o| format!("{o:.3}")).collect();
    println!("{name}: order {overall:.3} overall; {}", shown.join(" "));
    assert!(overall >= ORDER, "{name}: order {overall} overall: {orders:?}");
    let late = orders[orders.len() - 3..].iter().copied().fold(f64::INFINITY, f64::min);
    assert!(late >= ORDER, "{name}: order {late} at the shortest steps: {orders:?}");
}

#[test]
fn the_motor_is_of_first_order() {
    converges("motor", HALVINGS, |n| {
        let h = LONGEST_S / f64::from(1_u32 << n);
        let (m, mut s) = (DcMotor::new(MOTOR_PASEK, dt(h)).unwrap(), DcMotorState::default());
        at_common_instants(LONGEST_S, n, 1.0, |t| {
            let input = DcMotorInput { voltage_v: 20.0 + 200.0 * smooth(t + h), load_nm: 0.0 };
            m.step(&mut s, input).current_a
        })
    });
}

/// Alone it is compared with its continuous equations in `pmsm`.
#[test]
fn field_oriented_control_is_of_first_order_from_10_khz() {
    const LONGEST: f64 = 1e-4;
    for (pick, what) in ["speed", "torque", "current of the d axis"].into_iter().enumerate() {
        converges(&format!("synchronous machine under control, {what}"), 6, |n| {
            let h = LONGEST / f64::from(1_u32 << n);
            let params = FocParams { bandwidth_rad_s: 1000.0, ..FocParams::DEFAULT };
            let foc = Foc::new(params, PMSM_EPOWERTRAIN, dt(h)).unwrap();
            let machine = Pmsm::new(PMSM_EPOWERTRAIN, dt(h)).unwrap();
            let (mut control, mut state) = (FocState::default(), PmsmState::default());
            // Fast enough in the end that the field is weakened.
            at_common_instants(LONGEST, n, 0.2, |t| {
                let input = FocInput {
                    torque_nm: 0.2 * smooth(10.0 * t),
                    current_a: state.current_a(),
                    speed_rad_s: state.speed_rad_s.get(),
                    bus_v: 120.0,
                };
                let voltage_v = foc.step(&mut control, input).voltage_v;
                let out = machine.step(&mut state, PmsmInput::cold(voltage_v, 0.02));
                [out.speed_rad_s, out.torque_nm, out.current_a.d][pick]
            })
        });
    }
}

#[test]
fn battery_and_rc_branch_are_of_first_order() {
    converges("RC branch", HALVINGS, |n| {
        let h = LONGEST_S / f64::from(1_u32 << n);
        let params = RcBranchParams { resistance_ohm: 0.03, capacitance_f: 10.0 };
        let (m, mut s) = (RcBranch::new(params, dt(h)).unwrap(), RcBranchState::default());
        at_common_instants(LONGEST_S, n, 1.0, |t| {
            m.step(&mut s, RcBranchInput { discharge_a: 100.0 * smooth(t + h) }).voltage_v
        })
    });
    converges("battery", HALVINGS, |n| {
        let h = LONGEST_S / f64::from(1_u32 << n);
        let params = BMW_I3_60AH_EPOWERTRAIN.powertrain.battery;
        let m = Battery::new(params, dt(h)).unwrap();
        let mut s = BatteryState::rested(0.5).unwrap();
        at_common_instants(LONGEST_S, n, 1.0, |t| {
            m.step(&mut s, BatteryInput { current_a: 200.0 * smooth(t + h) }).terminal_v
        })
    });
}

#[test]
fn the_controller_is_of_first_order() {
    converges("PID", HALVINGS, |n| {
        let h = LONGEST_S / f64::from(1_u32 << n);
        let params = PidParams {
            integral_per_s: 2.0,
            derivative_s: 0.05,
            derivative_filter_s: 0.1,
            smoothing_per_s: 20.0,
            ..PidParams::DEFAULT
        };
        let (m, mut s) = (Pid::new(params, dt(h)).unwrap(), PidState::default());
        at_common_instants(LONGEST_S, n, 1.0, |t| {
            m.step(&mut s, PidInput { reference: smooth(t), measurement: 0.0 }).output
        })
    });
}

#[test]
fn bodies_and_loads_are_of_first_order() {
    converges("body", HALVINGS, |n| {
        let h = LONGEST_S / f64::from(1_u32 << n);
        let m = Body::new(BMW_I3_60AH_EPOWERTRAIN.powertrain.body, dt(h)).unwrap();
        let mut s = BodyState { speed_m_s: Accum::new(30.0), ..BodyState::default() };
        at_common_instants(LONGEST_S, n, 1.0, |t| {
            let input = BodyInput { force_n: 3000.0 * smooth(t + h), ..BodyInput::default() };
            m.step(&mut s, input).speed_m_s
        })
    });
    converges("load", HALVINGS, |n| {
        let h = LONGEST_S / f64::from(1_u32 << n);
        let params = RotationalLoadParams { viscous_nm_s_per_rad: 30.0, ..CONVERTER_BENCH_LOAD };
        let m = RotationalLoad::new(params, dt(h)).unwrap();
        let mut s = RotationalLoadState::default();
        at_common_instants(LONGEST_S, n, 1.0, |t| {
            m.step(&mut s, RotationalLoadInput { torque_nm: 1.0 + smooth(t + h) }).speed_rad_s
        })
    });
}

/// The plant at a given duty: first speed, then current.
fn plant_at_duty(vehicle: &Vehicle, n: u32, pick: usize) -> Vec<f64> {
    let h = LONGEST_S / f64::from(1_u32 << n);
    let plant = Powertrain::new(vehicle.powertrain, dt(h)).unwrap();
    let mut s = plant.at_speed(0.8, 10.0).unwrap();
    let idle =
        vehicle.powertrain.drives.motor.back_emf_v_s_per_rad * plant.motor_rad_per_m() * 10.0;
    let duty = idle / s.battery_v;
    at_common_instants(LONGEST_S, n, 1.0, |t| {
        let duty = duty * (1.0 + 0.3 * smooth(t + h));
        let out = plant.step(&mut s, PowertrainInput::on(duty));
        [out.speed_m_s, out.drives.motor_a][pick]
    })
}

#[test]
fn the_coupled_plant_is_of_first_order() {
    for vehicle in [&EPOWERTRAIN_UDDS, &BMW_I3_60AH_EPOWERTRAIN] {
        for (pick, what) in ["speed", "current"].into_iter().enumerate() {
            let name = format!("{}, {what} at given duty", vehicle.name);
            converges(&name, HALVINGS, |n| plant_at_duty(vehicle, n, pick));
        }
    }
}

#[test]
fn the_closed_loop_is_of_first_order_from_2_ms() {
    const LONGEST: f64 = 0.002;
    converges("closed loop", 8, |n| {
        let h = LONGEST / f64::from(1_u32 << n);
        let vehicle = &EPOWERTRAIN_UDDS;
        let plant = Powertrain::new(vehicle.powertrain, dt(h)).unwrap();
        let driver = Driver::new(vehicle.driver, &vehicle.powertrain, dt(h)).unwrap();
        // On the move, so that no standstill makes a kink.
        let (mut ps, mut ds) = (plant.at_speed(0.8, 10.0).unwrap(), DriverState::default());
        let mut feedback = plant.feedback(&ps);
        at_common_instants(LONGEST, n, 2.0, |t| {
            let input = DriverInput {
                reference_m_s: 10.0 + 2.0 * smooth(t),
                reference_m_s2: 0.0,
                vehicle: feedback,
            };
            let duty = driver.step(&mut ds, input).duty;
            let out = plant.step(&mut ps, PowertrainInput::on(duty));
            feedback = Feedback::from(&out);
            out.speed_m_s
        })
    });
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped before")]
fn count(x: f64) -> u32 {
    x as u32
}

/// What must hold in single precision too; `$real` is the scalar of `$core`.
macro_rules! in_precision {
    ($module:ident, $core:ident, $real:ty, $steady:expr) => {
        mod $module {
            use $core::battery::{RcBranch, RcBranchInput, RcBranchParams, RcBranchState};
            use $core::control::pid::{Pid, PidInput, PidParams, PidState};
            use $core::machine::dc::{DcMotor, DcMotorInput, DcMotorParams, DcMotorState};
            use $core::mechanics::rotational::{
                RotationalLoad, RotationalLoadInput, RotationalLoadParams, RotationalLoadState,
            };
            use $core::powertrain::{Powertrain, PowertrainInput};
            use $core::presets::{EPOWERTRAIN_UDDS, MOTOR_PASEK};
            use $core::{Accum, Dt};

            const NINE_DECADES: [$real; 10] =
                [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3];

            fn dt(s: $real) -> Dt {
                Dt::from_s(s).unwrap()
            }

            /// Steps a lag with τ = 1 s from 0 towards 1 for long enough, or as long as is bearable.
            #[track_caller]
            fn settles(name: &str, h: $real, mut step: impl FnMut() -> $real) {
                let steps = super::count((40.0 / h).clamp(50.0, 2e6).into());
                let mut before: $real = 0.0;
                for _ in 0..steps {
                    let now = step();
                    assert!(now >= before - $steady && now <= 1.0 + $steady, "{name} {h}: {now}");
                    before = now;
                }
                if f64::from(steps) * f64::from(h) > 20.0 {
                    assert!((before - 1.0).abs() <= $steady, "{name} {h}: ends at {before}");
                }
            }

            #[test]
            fn no_lag_grows_or_ends_elsewhere_over_nine_decades() {
                for h in NINE_DECADES {
                    let rc = RcBranchParams { resistance_ohm: 0.01, capacitance_f: 100.0 };
                    let (m, mut s) = (RcBranch::new(rc, dt(h)).unwrap(), RcBranchState::default());
                    settles("RC", h, || {
                        m.step(&mut s, RcBranchInput { discharge_a: 100.0 }).voltage_v
                    });

                    let pid = PidParams { smoothing_per_s: 1.0, ..PidParams::DEFAULT };
                    let (m, mut s) = (Pid::new(pid, dt(h)).unwrap(), PidState::default());
                    let input = PidInput { reference: 1.0, measurement: 0.0 };
                    settles("PID", h, || m.step(&mut s, input).output);

                    let load = RotationalLoadParams {
                        inertia_kg_m2: 2.0,
                        viscous_nm_s_per_rad: 2.0,
                        coulomb_nm: 0.5,
                    };
                    let m = RotationalLoad::new(load, dt(h)).unwrap();
                    let mut s = RotationalLoadState::default();
                    let input = RotationalLoadInput { torque_nm: 2.5 };
                    settles("load", h, || m.step(&mut s, input).speed_rad_s);

                    // A motor whose mechanical time constant R·J/(Ke·Kt) is 1 s.
                    let motor = DcMotorParams {
                        resistance_ohm: 1.0,
                        inductance_h: 1e-3,
                        back_emf_v_s_per_rad: 1.0,
                        torque_nm_per_a: 1.0,
                        inertia_kg_m2: 1.0,
                        viscous_nm_s_per_rad: 0.0,
                        coulomb_nm: 0.0,
                    };
                    let (m, mut s) = (DcMotor::new(motor, dt(h)).unwrap(), DcMotorState::default());
                    let input = DcMotorInput { voltage_v: 1.0, load_nm: 0.0 };
                    settles("motor", h, || m.step(&mut s, input).speed_rad_s);
                }
            }

            #[test]
            fn the_steady_state_of_a_motor_with_friction_does_not_depend_on_the_step() {
                let p = MOTOR_PASEK;
                // K·i = b·ω + T_c and V = R·i + K·ω.
                let (k, r) = (p.torque_nm_per_a, p.resistance_ohm);
                let exact = (248.0 - r * p.coulomb_nm / k) / (k + r * p.viscous_nm_s_per_rad / k);
                for h in [1e-5, 1e-4, 1e-3, 1e-2, 1.0, 1e3] {
                    let (m, mut s) = (DcMotor::new(p, dt(h)).unwrap(), DcMotorState::default());
                    let input = DcMotorInput { voltage_v: 248.0, load_nm: 0.0 };
                    for _ in 0..super::count((5.0 / h).clamp(100.0, 1e6).into()) {
                        m.step(&mut s, input);
                    }
                    let off = s.speed_rad_s.get() / exact - 1.0;
                    assert!(off.abs() <= $steady, "{h}: {off}");
                }
            }

            /// At duty zero nothing drives the plant: what is stored can only fall.
            #[test]
            fn the_coupled_plant_never_gains_energy_over_nine_decades() {
                const WINDING_S: $real = 0.04;
                for ratio in NINE_DECADES {
                    let plant = Powertrain::new(EPOWERTRAIN_UDDS.powertrain, dt(ratio * WINDING_S))
                        .unwrap();
                    let mut s = plant.at_speed(0.8, 20.0).unwrap();
                    s.drives = Accum::new(50.0);
                    let mass = plant.moving_mass_kg();
                    let stored = |v: $real, i: $real| 0.5 * mass * v * v + 0.5e-3 * i * i;
                    let mut before = stored(20.0, 50.0);
                    for _ in 0..20_000 {
                        let out = plant.step(&mut s, PowertrainInput::on(0.0));
                        let now = stored(out.speed_m_s, out.drives.motor_a);
                        assert!(now <= before * (1.0 + $steady), "{ratio}: {before} to {now}");
                        before = now;
                    }
                }
            }

            /// A battery that hardly empties drives at a given duty: one speed at every step.
            #[test]
            fn the_steady_speed_of_the_plant_does_not_depend_on_the_step() {
                let mut params = EPOWERTRAIN_UDDS.powertrain;
                params.battery.capacity_ah = 1e9;
                let ends = [1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0].map(|h: $real| {
                    let plant = Powertrain::new(params, dt(h)).unwrap();
                    let mut s = plant.at_speed(0.8, 10.0).unwrap();
                    let input = PowertrainInput::on(0.15);
                    for _ in 0..super::count((60.0 / h).clamp(200.0, 6e5).into()) {
                        plant.step(&mut s, input);
                    }
                    (h, s.body.speed_m_s.get(), s.drives.get())
                });
                for (h, speed, current) in ends {
                    let (_, first_speed, first_current) = ends[1];
                    assert!((speed / first_speed - 1.0).abs() <= $steady, "{ends:?} at {h}");
                    // The current is what friction leaves of two large voltages.
                    let off = (current / first_current - 1.0).abs();
                    assert!(off <= 100.0 * $steady, "{ends:?} at {h}");
                }
            }
        }
    };
}

in_precision!(double, plant_core_f64, f64, 1e-9);
in_precision!(single, plant_core, f32, 1e-6);
