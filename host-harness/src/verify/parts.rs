//! Parts that stand beside the plant against closed forms, and against the adaptive solution where
//! there is none.

use plant_core::battery::{
    BranchMap, CellSpread, HysteresisParams, IdentifiedRange, MappedBattery, MappedBatteryInput,
    MappedBatteryParams, OpenCircuit, OverSoc, ResistanceMap, SeriesPack, SeriesPackInput,
    SeriesPackParams, ThermalParams, VoltageLimits,
};
use plant_core::presets::PANASONIC_NCR18650PF;
use plant_core::thermal::{
    ThermalNode, ThermalNodeInput, ThermalNodeParams, ThermalNodeState, ThermalPair,
    ThermalPairInput, ThermalPairParams, ThermalPairState,
};
use plant_core::{Dt, Real, must};

use super::adaptive::{Clock, System, integrate};
use super::tolerance as t;
use super::{Case, Checks};

const DT: Dt = must!(Dt::from_s(0.1));
const DT_S: f64 = 0.1;

pub(super) const CASES: [Case; 2] = [
    Case { name: "thermal nodes", models: &["ThermalNode", "ThermalPair"], run: thermal },
    Case { name: "cells in series", models: &["SeriesPack"], run: row },
];

/// A winding in its housing, heated for a while \[°C\].
const MACHINE: ThermalPairParams = ThermalPairParams {
    inner: ThermalNodeParams { heat_capacity_j_per_k: 3000.0, ambient_k_per_w: Real::INFINITY },
    outer: ThermalNodeParams { heat_capacity_j_per_k: 20_000.0, ambient_k_per_w: 0.02 },
    between_k_per_w: 0.03,
};
const AMBIENT_C: f64 = 20.0;

struct Winding {
    heat_w: f64,
}

impl System<2> for Winding {
    fn slope(&self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
        let on_w = (y[0] - y[1]) / 0.03;
        [(self.heat_w - on_w) / 3000.0, (on_w - (y[1] - AMBIENT_C) / 0.02) / 20_000.0]
    }

    fn scale(&self) -> [f64; 2] {
        [10.0, 10.0]
    }
}

fn thermal(checks: &mut Checks) -> anyhow::Result<()> {
    let params = ThermalNodeParams { heat_capacity_j_per_k: 1000.0, ambient_k_per_w: 0.05 };
    let (node, mut state) = (ThermalNode::new(params, DT)?, ThermalNodeState::at(25.0));
    let mut worst = 0.0_f64;
    for number in 1..=3000_u32 {
        let out = node.step(&mut state, ThermalNodeInput { heat_w: 800.0, ambient_c: 25.0 });
        let exact = 25.0 + 40.0 * (1.0 - (-f64::from(number) * DT_S / 50.0).exp());
        worst = worst.max((f64::from(out.temperature_c) - exact).abs());
    }
    checks.add(&t::NODE_TRAJECTORY, worst);

    let (pair, mut state) = (ThermalPair::new(MACHINE, DT)?, ThermalPairState::at(20.0));
    let (mut y, mut from_s, mut worst) = ([AMBIENT_C; 2], 0.0, 0.0_f64);
    for inner_w in [2000.0_f32, 500.0, 3000.0, 0.0] {
        let mut winding = Winding { heat_w: f64::from(inner_w) };
        let span = (from_s, from_s + 300.0);
        from_s = span.1;
        integrate(&mut winding, &mut y, span, 1e-10, &mut Clock::never(), |_, _, _| {})?;
        let input = ThermalPairInput { inner_w, outer_w: 0.0, ambient_c: 20.0 };
        for _ in 0..3000 {
            pair.step(&mut state, input);
        }
        for (found, exact) in [state.inner_c, state.outer_c].iter().zip(y) {
            worst = worst.max((f64::from(found.get()) - exact).abs());
        }
    }
    checks.add(&t::PAIR_TRAJECTORY, worst);
    Ok(())
}

/// Three cells that are not alike: a weak one, one that is cooled better, one that starts ahead.
const ROW: [CellSpread; 3] = [
    CellSpread { capacity_ratio: 0.9, resistance_ratio: 1.5, ..CellSpread::NONE },
    CellSpread { cooling_ratio: 3.0, self_discharge_a: 0.02, ..CellSpread::NONE },
    CellSpread { soc_offset: 0.05, ..CellSpread::NONE },
];
const NEIGHBOUR_W_PER_K: f64 = 0.1;
const CELL_OHM: f64 = 0.05;
const CELL: MappedBatteryParams = MappedBatteryParams {
    capacity_ah: 3.0,
    discharge_limit_a: Real::INFINITY,
    charge_limit_a: Real::INFINITY,
    voltage_limits: VoltageLimits::NONE,
    refresh_s: 1.0,
    open_circuit: OpenCircuit::Linear { empty_v: 3.0, full_v: 4.2 },
    hysteresis: HysteresisParams::NONE,
    series: ResistanceMap { resistance_ohm: OverSoc::Constant(0.05), activation_k: 0.0 },
    polarisation: BranchMap::NONE,
    second_polarisation: BranchMap::NONE,
    thermal: ThermalParams { heat_capacity_j_per_k: 45.0, cooling_w_per_k: 0.05, ambient_c: 20.0 },
    identified: IdentifiedRange::ALL,
};

/// State of charge of each cell, then its temperature \[°C\].
struct Row {
    current_a: f64,
    bleed_a: [f64; 3],
}

impl System<6> for Row {
    fn slope(&self, _t: f64, y: &[f64; 6]) -> [f64; 6] {
        let mut slope = [0.0; 6];
        for (i, spread) in ROW.iter().enumerate() {
            let lost_a = f64::from(spread.self_discharge_a);
            let cell_a = self.current_a + self.bleed_a[i];
            slope[i] = -(cell_a + lost_a) / (10_800.0 * f64::from(spread.capacity_ratio));
            let own_w = f64::from(spread.resistance_ratio) * CELL_OHM * cell_a * cell_a;
            let mut heat_w = own_w + lost_a * (3.0 + 1.2 * y[i]);
            heat_w -= 0.05 * f64::from(spread.cooling_ratio) * (y[3 + i] - AMBIENT_C);
            for beside in [i.checked_sub(1), (i < 2).then_some(i + 1)].into_iter().flatten() {
                heat_w -= NEIGHBOUR_W_PER_K * (y[3 + i] - y[3 + beside]);
            }
            slope[3 + i] = heat_w / 45.0;
        }
        slope
    }

    fn scale(&self) -> [f64; 6] {
        [1.0, 1.0, 1.0, 10.0, 10.0, 10.0]
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the model computes in f32")]
fn row(checks: &mut Checks) -> anyhow::Result<()> {
    let params =
        SeriesPackParams { cell: CELL, spread: ROW, neighbour_w_per_k: NEIGHBOUR_W_PER_K as Real };
    let (pack, mut y) = (SeriesPack::new(params, DT)?, [0.9, 0.9, 0.95, 20.0, 20.0, 20.0]);
    let (mut state, mut from_s) = (pack.rested(0.9)?, 0.0);
    let (mut soc, mut temperature) = (0.0_f64, 0.0_f64);
    for (current_a, bleed_a) in
        [(6.0, [0.0; 3]), (-2.0, [0.0, 0.0, 0.3]), (0.0, [0.2, 0.0, 0.1]), (9.0, [0.0; 3])]
    {
        let span = (from_s, from_s + 300.0);
        from_s = span.1;
        let mut exact = Row { current_a, bleed_a };
        integrate(&mut exact, &mut y, span, 1e-10, &mut Clock::never(), |_, _, _| {})?;
        let input =
            SeriesPackInput { current_a: current_a as Real, bleed_a: bleed_a.map(|a| a as Real) };
        for _ in 0..3000 {
            let out = pack.step(&mut state, input);
            anyhow::ensure!(out.refused_charge_c == 0.0, "no limit is to act: {out:?}");
        }
        for (i, cell) in state.cells.iter().enumerate() {
            soc = soc.max((f64::from(cell.soc.get()) - y[i]).abs());
            temperature = temperature.max((f64::from(cell.temperature_c.get()) - y[3 + i]).abs());
        }
    }
    checks.add(&t::ROW_SOC, soc);
    checks.add(&t::ROW_TEMPERATURE, temperature);

    // Cells that are alike are one battery.
    let spread = [CellSpread::NONE; 96];
    let params = SeriesPackParams { cell: PANASONIC_NCR18650PF, spread, neighbour_w_per_k: 0.0 };
    let (pack, whole) = (SeriesPack::new(params, DT)?, PANASONIC_NCR18650PF.pack(96, 1)?);
    let whole = MappedBattery::new(whole, DT)?;
    let (mut state, mut one, mut worst) = (pack.rested(0.8)?, whole.rested(0.8)?, 0.0_f64);
    for number in 0..6000_u16 {
        let current_a = if number % 600 < 400 { 5.0 } else { -2.0 };
        let row = pack.step(&mut state, SeriesPackInput { current_a, bleed_a: [0.0; 96] });
        let single = whole.step(&mut one, MappedBatteryInput { current_a });
        worst = worst.max(f64::from(row.terminal_v - single.terminal_v).abs());
    }
    checks.add(&t::ROW_VOLTAGE, worst);
    Ok(())
}
