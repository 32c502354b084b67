//! Parts that stand beside the plant against closed forms, and against the adaptive solution where
//! there is none.

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

pub(super) const CASES: [Case; 1] =
    [Case { name: "thermal nodes", models: &["ThermalNode", "ThermalPair"], run: thermal }];

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
