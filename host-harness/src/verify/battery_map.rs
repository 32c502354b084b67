//! A battery with parameters over state of charge and temperature, two branches, hysteresis and a
//! thermal node, against the adaptive solution of the same equations, written once more.

use plant_core::battery::{
    BranchMap, HysteresisParams, IdentifiedRange, MappedBattery, MappedBatteryInput,
    MappedBatteryParams, OpenCircuit, OverSoc, ResistanceMap, ThermalParams, VoltageLimits,
};
use plant_core::num::SocTable;
use plant_core::{Dt, Real};

use anyhow::Context;

use super::adaptive::{Clock, System, integrate};
use super::tolerance as t;
use super::{Case, Checks};
use crate::read::cycle;
use crate::read::vehicle::{self, VehicleBattery};
use crate::simulate::progress::Unseen;
use crate::simulate::route::Route;
use crate::simulate::run::{self, Run};

pub(super) const CASES: [Case; 2] = [
    Case { name: "battery with maps", models: &["MappedBattery"], run: maps },
    Case {
        name: "UDDS, bmw-i3-60ah with its battery map",
        models: &["Powertrain", "Driver", "MappedBattery"],
        run: in_the_plant,
    },
];

/// A point of a polyline: state of charge, value.
type Points = &'static [(Real, Real)];
const OPEN_CIRCUIT: Points = &[(0.0, 3.0), (0.25, 3.5), (0.5, 3.65), (1.0, 4.15)];
const SERIES: Points = &[(0.0, 0.06), (0.5, 0.03), (1.0, 0.03)];
const SLOW: Points = &[(0.0, 0.06), (0.25, 0.02), (1.0, 0.02)];
const FAST_OHM: Real = 0.02;
/// Activation temperatures of the series resistance and of the branches \[K\].
const ACTIVATION_K: [Real; 3] = [2000.0, 4000.0, 3000.0];
const TAU_S: [Real; 2] = [10.0, 120.0];
const THERMAL: ThermalParams =
    ThermalParams { heat_capacity_j_per_k: 50.0, cooling_w_per_k: 0.1, ambient_c: 10.0 };
const HYSTERESIS: HysteresisParams = HysteresisParams { half_gap_v: 0.01, rate_per_soc: 50.0 };
const CAPACITY_AH: Real = 3.0;
const SOC: Real = 0.9;

/// The current holds for this long \[s\] …
const STRETCH_S: f64 = 20.0;
/// … at each of these, over and over \[A\].
const CURRENTS_A: [Real; 6] = [3.0, -1.0, 6.0, 0.0, 2.0, 0.5];
const STRETCHES: usize = 150;
const DT_S: f64 = 0.01;

fn params() -> anyhow::Result<MappedBatteryParams> {
    let table = |points| anyhow::Ok(SocTable::from_points("table", points)?);
    let [series_k, fast_k, slow_k] = ACTIVATION_K;
    Ok(MappedBatteryParams {
        capacity_ah: CAPACITY_AH,
        discharge_limit_a: Real::INFINITY,
        charge_limit_a: Real::INFINITY,
        voltage_limits: VoltageLimits::NONE,
        refresh_s: 1.0,
        open_circuit: OpenCircuit::Table(table(OPEN_CIRCUIT)?),
        hysteresis: HYSTERESIS,
        series: ResistanceMap {
            resistance_ohm: OverSoc::Table(table(SERIES)?),
            activation_k: series_k,
        },
        polarisation: BranchMap {
            resistance_ohm: OverSoc::Constant(FAST_OHM),
            activation_k: fast_k,
            time_constant_s: TAU_S[0],
        },
        second_polarisation: BranchMap {
            resistance_ohm: OverSoc::Table(table(SLOW)?),
            activation_k: slow_k,
            time_constant_s: TAU_S[1],
        },
        thermal: THERMAL,
        identified: IdentifiedRange::ALL,
    })
}

fn polyline(points: Points, soc: f64) -> f64 {
    let pair = points.windows(2).find(|w| soc <= f64::from(w[1].0)).unwrap_or(&[]);
    let [(x0, y0), (x1, y1)] = pair else { return f64::NAN };
    let (x0, y0, x1, y1) = (f64::from(*x0), f64::from(*y0), f64::from(*x1), f64::from(*y1));
    y0 + (soc - x0) / (x1 - x0) * (y1 - y0)
}

/// State of charge, both branches \[V\], temperature \[°C\], hysteresis.
struct Cell {
    current_a: f64,
}

fn resistance(k: usize, base_ohm: f64, celsius: f64) -> f64 {
    let (reference_k, kelvin) = (298.15, celsius + 273.15);
    base_ohm * (f64::from(ACTIVATION_K[k]) * (1.0 / kelvin - 1.0 / reference_k)).exp()
}

impl Cell {
    fn voltage(&self, y: &[f64; 5]) -> f64 {
        let r0 = resistance(0, polyline(SERIES, y[0]), y[3]);
        polyline(OPEN_CIRCUIT, y[0]) + f64::from(HYSTERESIS.half_gap_v) * y[4]
            - r0 * self.current_a
            - y[1]
            - y[2]
    }
}

impl System<5> for Cell {
    fn slope(&self, _t: f64, y: &[f64; 5]) -> [f64; 5] {
        let i = self.current_a;
        let r1 = resistance(1, f64::from(FAST_OHM), y[3]);
        let r2 = resistance(2, polyline(SLOW, y[0]), y[3]);
        let soc_rate = -i / (3600.0 * f64::from(CAPACITY_AH));
        let heat_w = (polyline(OPEN_CIRCUIT, y[0]) - self.voltage(y)) * i;
        let cooling_w = f64::from(THERMAL.cooling_w_per_k) * (y[3] - f64::from(THERMAL.ambient_c));
        let towards = if i == 0.0 { 0.0 } else { -i.signum() };
        [
            soc_rate,
            (r1 * i - y[1]) / f64::from(TAU_S[0]),
            (r2 * i - y[2]) / f64::from(TAU_S[1]),
            (heat_w - cooling_w) / f64::from(THERMAL.heat_capacity_j_per_k),
            f64::from(HYSTERESIS.rate_per_soc) * soc_rate.abs() * (towards - y[4]),
        ]
    }

    fn scale(&self) -> [f64; 5] {
        [1.0, 0.1, 0.1, 10.0, 1.0]
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of steps")]
fn maps(checks: &mut Checks) -> anyhow::Result<()> {
    #[expect(clippy::cast_possible_truncation, reason = "the model computes in f32")]
    let dt = Dt::from_s(DT_S as Real)?;
    let battery = MappedBattery::new(params()?, dt)?;
    let mut state = battery.rested(SOC)?;
    let mut y = [f64::from(SOC), 0.0, 0.0, f64::from(THERMAL.ambient_c), 0.0];
    let steps = (STRETCH_S / DT_S).round() as u32;
    let (mut voltage, mut temperature, mut from_s) = (0.0_f64, 0.0_f64, 0.0);
    for current_a in CURRENTS_A.iter().copied().cycle().take(STRETCHES) {
        let mut cell = Cell { current_a: f64::from(current_a) };
        let span = (from_s, from_s + STRETCH_S);
        integrate(&mut cell, &mut y, span, 1e-9, &mut Clock::never(), |_, _, _| {})?;
        from_s = span.1;
        let mut out = battery.step(&mut state, MappedBatteryInput { current_a });
        for _ in 1..steps {
            out = battery.step(&mut state, MappedBatteryInput { current_a });
        }
        voltage = voltage.max((f64::from(out.terminal_v) - cell.voltage(&y)).abs());
        temperature = temperature.max((f64::from(out.temperature_c) - y[3]).abs());
    }
    checks.against(&t::MAP_SOC, y[0], f64::from(state.soc.get()));
    checks.add(&t::MAP_VOLTAGE, voltage);
    checks.add(&t::MAP_TEMPERATURE, temperature);
    Ok(())
}

/// The battery's map in the coupled plant: the books close, and a tenth of the step changes little.
fn in_the_plant(checks: &mut Checks) -> anyhow::Result<()> {
    let vehicle = vehicle::load("bmw-i3-60ah")?;
    let mapped = matches!(vehicle.powertrain.battery, VehicleBattery::Mapped(_));
    anyhow::ensure!(mapped, "no battery map");
    let route = Route::of_cycle(&cycle::by_name("udds").context("no UDDS")?);
    let run = |dt_s| run::vehicle(&vehicle, &route, vehicle.initial_soc, dt_s, true, &Unseen);
    let (coarse, fine) = rayon::join(|| run(1e-3), || run(1e-4));
    let (coarse, fine) = (coarse?, fine?);
    let soc = |run: &Run| run.trace.last().map_or(f64::NAN, |row| f64::from(row.soc));
    checks.against(&t::MAP_PLANT_SOC, soc(&fine), soc(&coarse));
    let [coarse, fine] = [coarse, fine].map(|run| run.energy);
    let coarse = coarse.context("no ledger")?;
    checks.ledger(&coarse, &t::MAP_PLANT_NUMERICAL);
    checks.add(&t::LEDGER, f64::from(fine.context("no ledger")?.residual_rel()));
    Ok(())
}
