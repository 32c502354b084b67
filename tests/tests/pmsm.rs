//! The synchronous machine against its continuous equations, solved with fine steps of fourth
//! order in double precision; with saturation; and with a measured map, where `VOLTSTEP_DATA` names
//! the folder that has it.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "tables are made in f64, the models take f32"
)]

use std::path::Path;

use plant_core::control::foc::{Foc, FocInput, FocParams, FocState};
use plant_core::machine::pmsm::{Pmsm, PmsmParams, PmsmSpeedInput, PmsmState};
use plant_core::machine::{flux as single, transform};
use plant_core::presets::PMSM_EPOWERTRAIN;
use plant_core_f64::machine::flux::{Flux, FluxAxis, FluxMap, LinearFlux};
use plant_core_f64::machine::pmsm as double;
use plant_core_f64::machine::transform::Dq;

/// Currents of both axes and speed.
type State = [f64; 3];

/// Fourth-order Runge–Kutta.
fn rk4(y: State, h: f64, slope: impl Fn(&State) -> State) -> State {
    let along = |k: &State, by: f64| std::array::from_fn(|i| y[i] + by * k[i]);
    let a = slope(&y);
    let b = slope(&along(&a, 0.5 * h));
    let c = slope(&along(&b, 0.5 * h));
    let d = slope(&along(&c, h));
    std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
}

const OHM: f64 = 0.3;
const PAIRS: f64 = 4.0;
const INERTIA: f64 = 0.01;
const VISCOUS: f64 = 1e-3;
const IRON: f64 = 0.01;

fn params(flux: Flux) -> double::PmsmParams {
    double::PmsmParams {
        flux,
        resistance_ohm: OHM,
        resistance_per_k: 0.0,
        pole_pairs: 4,
        iron_s: IRON,
        inertia_kg_m2: INERTIA,
        viscous_nm_s_per_rad: VISCOUS,
        coulomb_nm: 0.0,
    }
}

/// `ℓ·di/dt = v − R·i − ω_e·J·ψ`, and the shaft.
fn slope(flux: &Flux, v: [f64; 2], load_nm: f64, y: &State) -> State {
    let [d, q, w] = *y;
    let p = flux.at(Dq { d, q });
    let psi = [p.flux_wb.d, p.flux_wb.q];
    let u = [v[0] - OHM * d + PAIRS * w * psi[1], v[1] - OHM * q - PAIRS * w * psi[0]];
    let det = p.dd_h * p.qq_h - p.dq_h * p.qd_h;
    let torque = 1.5 * PAIRS * (psi[0] * q - psi[1] * d);
    let iron = 1.5 * IRON * PAIRS * PAIRS * (psi[0] * psi[0] + psi[1] * psi[1]) * w;
    [
        (p.qq_h * u[0] - p.dq_h * u[1]) / det,
        (p.dd_h * u[1] - p.qd_h * u[0]) / det,
        (torque - iron - VISCOUS * w - load_nm) / INERTIA,
    ]
}

/// Voltages that change smoothly.
fn voltage(t: f64) -> [f64; 2] {
    let swing = 0.5 * (1.0 - (40.0 * t).cos());
    [-4.0 * swing, 12.0 + 8.0 * swing]
}

const LOAD_NM: f64 = 1.0;
/// All steps share these instants [s].
const INSTANT_S: f64 = 2e-4;
const INSTANTS: usize = 500;

fn exact(flux: &Flux) -> Vec<State> {
    let (mut y, mut t, fine) = ([0.0; 3], 0.0, 40);
    let h = INSTANT_S / f64::from(fine);
    (0..INSTANTS)
        .map(|_| {
            for _ in 0..fine {
                // Within a step the machine sees the voltage of its end: first order.
                y = rk4(y, h, |y| slope(flux, voltage(t + 0.5 * h), LOAD_NM, y));
                t += h;
            }
            y
        })
        .collect()
}

/// The largest relative difference of currents and speed, in steps of 1/`parts` of an instant.
fn off(flux: &Flux, exact: &[State], parts: u32) -> [f64; 3] {
    let h = INSTANT_S / f64::from(parts);
    let dt = plant_core_f64::Dt::from_s(h).unwrap();
    let machine = double::Pmsm::new(params(*flux), dt).unwrap();
    let (mut state, mut t) = (double::PmsmState::default(), 0.0);
    let (mut worst, mut largest) = ([0.0_f64; 3], [0.0_f64; 3]);
    for y in exact {
        for _ in 0..parts {
            t += h;
            let [d, q] = voltage(t);
            let out = machine.step(&mut state, double::PmsmInput::cold(Dq { d, q }, LOAD_NM));
            assert!(!out.rejected && !out.beyond_map, "{out:?}");
        }
        let i = state.current_a();
        for (k, x) in [i.d, i.q, state.speed_rad_s.get()].into_iter().enumerate() {
            worst[k] = worst[k].max((x - y[k]).abs());
            largest[k] = largest[k].max(y[k].abs());
        }
    }
    std::array::from_fn(|k| worst[k] / largest[k])
}

#[track_caller]
fn is_of_first_order(name: &str, flux: &Flux) {
    let exact = exact(flux);
    let errors = [2, 4, 8, 16, 32].map(|parts| off(flux, &exact, parts));
    for k in 0..3 {
        let orders: Vec<_> = errors.windows(2).map(|e| (e[0][k] / e[1][k]).log2()).collect();
        println!("{name}: {:.2e} at the shortest step, orders {orders:.3?}", errors[4][k]);
        assert!(errors[4][k] < 5e-3, "{name}: {errors:?}");
        assert!(orders[2..].iter().all(|o| *o > 0.95), "{name}: {orders:?}");
    }
}

#[test]
fn a_salient_machine_converges_to_its_equations_with_the_first_order() {
    is_of_first_order(
        "salient",
        &Flux::Linear(LinearFlux { magnet_wb: 0.05, d_h: 1e-3, q_h: 3e-3 }),
    );
}

/// Flux linkages that saturate, and each axis the other: the gradient of a co-energy.
fn saturating(d: f64, q: f64) -> [f64; 2] {
    let bent = 1.0 / (1.0 + (d / 120.0).powi(2) + (q / 60.0).powi(2)).sqrt();
    [0.05 + 1e-3 * d * bent, 4e-3 * q * bent]
}

fn saturating_map() -> FluxMap {
    let (d, q) = (
        FluxAxis { start_a: -320.0, step_a: 8.0, points: 81 },
        FluxAxis { start_a: -320.0, step_a: 8.0, points: 81 },
    );
    let at = |axis: FluxAxis, n: u16| axis.start_a + axis.step_a * f64::from(n);
    let table: Vec<_> = (0..d.points)
        .flat_map(|n| (0..q.points).map(move |m| saturating(at(d, n), at(q, m))))
        .collect();
    FluxMap { d, q, flux_wb: Box::leak(table.into_boxed_slice()) }
}

#[test]
fn a_saturating_machine_converges_to_its_equations_with_the_first_order() {
    is_of_first_order("saturating", &Flux::Map(saturating_map()));
}

/// Shorted, on a free shaft: what motion and field hold never grows, however long the step.
/// Tried, not proven as for constant inductances.
#[test]
fn a_saturating_machine_without_a_source_never_gains_energy() {
    let flux = Flux::Map(saturating_map());
    let mut seed = 1_u32;
    let mut number = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(seed >> 8) / f64::from(1 << 23) - 1.0
    };
    let mut worst = 0.0_f64;
    for _ in 0..400 {
        let dt_s = 10_f64.powf(-2.5 + 3.5 * number());
        let params = double::PmsmParams {
            resistance_ohm: OHM * 10_f64.powf(2.0 * number()),
            inertia_kg_m2: INERTIA * 10_f64.powf(2.0 * number()),
            ..params(flux)
        };
        let dt = plant_core_f64::Dt::from_s(dt_s).unwrap();
        let machine = double::Pmsm::new(params, dt).unwrap();
        let mut state = double::PmsmState {
            d_a: plant_core_f64::Accum::new(15.0 * number()),
            q_a: plant_core_f64::Accum::new(15.0 * number()),
            speed_rad_s: plant_core_f64::Accum::new(1000.0 * number()),
        };
        let stored = |s: &double::PmsmState| {
            let w = s.speed_rad_s.get();
            0.5 * params.inertia_kg_m2 * w * w + flux.energy_j(s.current_a())
        };
        let first = stored(&state);
        let mut lowest = first;
        for step in 0..100 {
            let out = machine.step(&mut state, double::PmsmInput::cold(Dq::ZERO, 0.0));
            assert!(!out.rejected && !out.beyond_map, "{out:?}");
            let now = stored(&state);
            worst = worst.max((now - lowest) / first);
            assert!(now <= lowest + 1e-9 * first, "{step} of {dt_s} s: {lowest} to {now}");
            lowest = lowest.min(now);
        }
    }
    println!("energy rose by {worst:.1e} of what there was at most");
}

/// The measured map of a 5.6 kW machine, each `every`-th node of it; none without the data.
fn measured(every: usize) -> Option<(Vec<[f64; 4]>, single::FluxMap)> {
    let files = voltstep_tests::real_files("pmsm-flux-maps");
    let path = files.iter().find(|p| p.file_name() == Some("baldor_pmsyrm_400rpm.csv".as_ref()))?;
    let nodes = nodes(path);
    let (d, q) = (axis(&nodes, 0, every), axis(&nodes, 1, every));
    let on = |axis: &single::FluxAxis, x: f64| {
        let place = (x as f32 - axis.start_a) / axis.step_a;
        (place - place.round()).abs() < 1e-3 && place.round() < f32::from(axis.points)
    };
    let kept = nodes.iter().filter(|n| on(&d, n[0]) && on(&q, n[1]));
    let table: Vec<_> = kept.map(|n| [n[2] as f32, n[3] as f32]).collect();
    let map = single::FluxMap { d, q, flux_wb: Box::leak(table.into_boxed_slice()) };
    Some((nodes, map))
}

/// Currents and flux linkages of both axes, by the current of d, then of q.
fn nodes(path: &Path) -> Vec<[f64; 4]> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    reader.deserialize().map(|row| row.unwrap()).collect()
}

/// Each `every`-th current of one axis.
fn axis(nodes: &[[f64; 4]], which: usize, every: usize) -> single::FluxAxis {
    let mut currents: Vec<_> = nodes.iter().map(|n| n[which]).collect();
    currents.sort_by(f64::total_cmp);
    currents.dedup();
    let kept: Vec<_> = currents.into_iter().step_by(every).collect();
    let step_a = (kept[1] - kept[0]) as f32;
    single::FluxAxis { start_a: kept[0] as f32, step_a, points: kept.len() as u16 }
}

/// Rated torque of that machine [N·m], its pole pairs, resistance [Ω], bus [V] and the peak of its
/// rated current [A].
const RATED_NM: f64 = 29.7;
const MEASURED_PAIRS: u16 = 2;
const MEASURED_OHM: f32 = 0.63;
const MEASURED_BUS_V: f32 = 540.0;
const RATED_A: f64 = 8.8 * std::f64::consts::SQRT_2;

/// The machine held at a current, as its step sees it: torque and flux.
fn torque_nm(machine: &Pmsm, d: f64, q: f64) -> f64 {
    let current_a = transform::Dq { d: d as f32, q: q as f32 };
    f64::from(machine.winding().law(current_a, 0.0, 25.0).torque_nm(current_a))
}

fn measured_machine(map: single::FluxMap, dt_s: f32) -> (PmsmParams, Pmsm) {
    let params = PmsmParams {
        flux: single::Flux::Map(map),
        resistance_ohm: MEASURED_OHM,
        pole_pairs: MEASURED_PAIRS,
        inertia_kg_m2: 0.05,
        ..PMSM_EPOWERTRAIN
    };
    (params, Pmsm::new(params, plant_core::Dt::from_s(dt_s).unwrap()).unwrap())
}

#[test]
fn every_second_node_of_a_measured_map_gives_the_torque_within_2_percent() {
    let Some((nodes, map)) = measured(2) else { return };
    assert_eq!((nodes.len(), map.d.points, map.q.points), (567, 11, 14));
    let (_, machine) = measured_machine(map, 1e-4);
    let mut worst = (0.0, 0.0, 0.0);
    for [d, q, psi_d, psi_q] in nodes {
        let exact = 1.5 * f64::from(MEASURED_PAIRS) * (psi_d * q - psi_q * d);
        let off = (torque_nm(&machine, d, q) - exact).abs() / RATED_NM;
        if off > worst.0 {
            worst = (off, d, q);
        }
    }
    println!(
        "largest difference {:.2} % of rated, at {} and {} A",
        100.0 * worst.0,
        worst.1,
        worst.2
    );
    assert!(worst.0 < 0.02, "{worst:?}");
}

/// Field-oriented control with the coarse map of a machine that has the full one.
#[test]
fn a_measured_machine_makes_the_torque_that_is_asked_for_with_nearly_the_least_current() {
    let (Some((nodes, full)), Some((_, coarse))) = (measured(1), measured(2)) else { return };
    let dt_s = 1e-4;
    let (_, machine) = measured_machine(full, dt_s);
    let (believed, _) = measured_machine(coarse, dt_s);
    let foc = FocParams {
        bandwidth_rad_s: 1000.0,
        current_limit_a: 1.5 * RATED_A as f32,
        ..FocParams::DEFAULT
    };
    let foc = Foc::new(foc, believed, plant_core::Dt::from_s(dt_s).unwrap()).unwrap();
    for (share, speed_rad_s) in [(0.25, 50.0), (0.5, 50.0), (1.0, 50.0), (-1.0, 50.0), (0.5, 350.0)]
    {
        let asked = share * RATED_NM;
        let (mut control, mut state) = (FocState::default(), PmsmState::default());
        let mut seen = Vec::new();
        for number in 0..20_000 {
            let input = FocInput {
                torque_nm: asked as f32,
                current_a: state.current_a(),
                speed_rad_s,
                bus_v: MEASURED_BUS_V,
            };
            let out = foc.step(&mut control, input);
            let voltage_v = out.voltage_v;
            let input = PmsmSpeedInput { voltage_v, speed_rad_s, winding_c: 25.0 };
            let told = machine.step_at_speed(&mut state, input);
            assert!(!out.rejected && !told.rejected && !told.beyond_map, "{out:?} {told:?}");
            if number >= 19_900 {
                seen.push((f64::from(told.torque_nm), out.weakened));
            }
        }
        let i = state.current_a();
        let (mean, weakened) =
            (seen.iter().map(|s| s.0).sum::<f64>() / seen.len() as f64, seen[0].1);
        let ripple = seen.iter().map(|s| (s.0 - mean).abs()).fold(0.0, f64::max);
        let amps = f64::from(i.length());
        // The least current of all nodes that make no less torque.
        let least = nodes
            .iter()
            .filter(|[d, q, a, b]| {
                let torque = 1.5 * f64::from(MEASURED_PAIRS) * (a * q - b * d);
                torque * share.signum() >= asked.abs() * 0.98
            })
            .map(|n| n[0].hypot(n[1]))
            .fold(f64::INFINITY, f64::min);
        println!(
            "{asked:.1} N·m at {speed_rad_s} rad/s: {mean:.2} ± {ripple:.1e} N·m, {amps:.2} A (nodes: {least:.2} A), weakened {weakened}"
        );
        assert!((mean - asked).abs() < 0.02 * RATED_NM, "{mean} {asked}");
        assert!(ripple < 0.002 * RATED_NM, "{ripple}");
        assert_eq!(weakened, speed_rad_s > 100.0);
        assert!(weakened || amps < 1.15 * least, "{amps} {least}");
    }
}
