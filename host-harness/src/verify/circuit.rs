//! Circuits against closed forms, and the switched converter against the averaged one.

use plant_core::circuit::{
    Branch, Circuit, CircuitError, CircuitInput, CircuitState, Element, Method, sources,
};
use plant_core::converter::{Converter, ConverterInput, ConverterParams};
use plant_core::{Dt, Real, must};

use super::tolerance as t;
use super::{Case, Checks};

pub(super) const CASES: [Case; 3] = [
    Case { name: "circuit: precharge", models: &["Circuit"], run: precharge },
    Case { name: "circuit: series resonance", models: &["Circuit"], run: resonance },
    Case { name: "circuit: buck converter", models: &["Circuit", "Converter"], run: buck },
];

/// 355 V through 40 Ω into 0.96 mF: `v = V·(1 − e^(−t/RC))`, by both methods.
fn precharge(checks: &mut Checks) -> anyhow::Result<()> {
    const DT_S: f64 = 1e-4;
    const PRECHARGE: [Branch; 3] = [
        Branch::new(1, 0, Element::Voltage),
        Branch::new(1, 2, Element::Resistor { ohm: 40.0 }),
        Branch::new(2, 0, Element::Capacitor { farad: 0.00096 }),
    ];
    for (method, bound) in
        [(Method::BackwardEuler, &t::RC_EULER), (Method::Trapezoidal, &t::RC_TRAPEZOIDAL)]
    {
        let circuit: Circuit<3, 3> = Circuit::new(PRECHARGE, method, step(DT_S)?)?;
        let mut state = CircuitState::default();
        // From t = 0+ on, the capacitor takes V/R.
        state.rate[2] = 355.0 / 40.0;
        let mut worst_v = 0.0_f64;
        for number in 1..=4000_u32 {
            let out = circuit.step(&mut state, CircuitInput::of([355.0, 0.0, 0.0]));
            let time_s = f64::from(number) * DT_S;
            let exact_v = 355.0 * (1.0 - (-time_s / 0.0384).exp());
            worst_v = worst_v.max((f64::from(out.voltage_v[2]) - exact_v).abs());
        }
        checks.add(bound, worst_v / 355.0);
    }
    Ok(())
}

/// 1 mH, 10 µF and 2 Ω on a step of 10 V: `v_C = V·(1 − e^(−δt)·(cos ωt + δ/ω·sin ωt))`.
fn resonance(checks: &mut Checks) -> anyhow::Result<()> {
    const SERIES: [Branch; 3] = [
        Branch::new(1, 0, Element::Voltage),
        Branch::new(1, 2, Element::Coil { henry: 1e-3, ohm: 2.0 }),
        Branch::new(2, 0, Element::Capacitor { farad: 1e-5 }),
    ];
    let (decay_per_s, rad_per_s) = (1000.0_f64, (1e8_f64 - 1e6).sqrt());
    let mut worst = [0.0_f64; 2];
    for (worst_v, dt_s) in worst.iter_mut().zip([4e-6, 2e-6]) {
        let circuit: Circuit<3, 3> = Circuit::new(SERIES, Method::Trapezoidal, step(dt_s)?)?;
        let mut state = CircuitState::default();
        state.rate[1] = 10.0;
        let mut time_s = 0.0;
        while time_s < 1e-3 {
            let out = circuit.step(&mut state, CircuitInput::of([10.0, 0.0, 0.0]));
            time_s += dt_s;
            let (sin, cos) = (rad_per_s * time_s).sin_cos();
            let exact_v = 10.0
                * (1.0 - (-decay_per_s * time_s).exp() * (cos + decay_per_s / rad_per_s * sin));
            *worst_v = worst_v.max((f64::from(out.voltage_v[2]) - exact_v).abs());
        }
    }
    checks.add(&t::RESONANCE, worst[1] / 10.0);
    checks.against(&t::RESONANCE_ORDER, 2.0, (worst[0] / worst[1]).log2());
    Ok(())
}

/// A leg at 10 kHz with 1 µs steps feeds a motor's winding: over one period, voltage and current are
/// those of the averaged converter with the same duty.
fn buck(checks: &mut Checks) -> anyhow::Result<()> {
    const TRANSISTOR: Element =
        Element::Transistor { on_ohm: 0.01, off_ohm: 1e6, drop_v: 0.0, diode_drop_v: 0.7 };
    const LEG: [Branch; 4] = [
        Branch::new(1, 0, Element::Voltage),
        Branch::new(1, 2, TRANSISTOR),
        Branch::new(2, 0, TRANSISTOR),
        Branch::new(2, 0, Element::Coil { henry: 1e-3, ohm: 0.49 }),
    ];
    const TABLED: Result<Circuit<3, 4, { sources(&LEG) }, 4>, CircuitError> =
        Circuit::tabled(LEG, Method::BackwardEuler, must!(Dt::from_s(1e-6)));
    let circuit = TABLED?;
    let (source_v, back_emf_v) = (400.0, 100.0);
    let mut state = CircuitState::default();
    let (mut mean_v, mut mean_a, mut source_a) = (0.0, 0.0, 0.0);
    for number in 0..20_000_u32 {
        // 40 of 100 µs high, the lower transistor in the rest.
        let gates = if number % 100 < 40 { 0b0010 } else { 0b0100 };
        let values = [source_v, 0.0, 0.0, back_emf_v];
        let out = circuit.step(&mut state, CircuitInput { values, gates });
        if number >= 19_900 {
            mean_v += f64::from(out.voltage_v[3]) / 100.0;
            mean_a += f64::from(out.current_a[3]) / 100.0;
            source_a -= f64::from(out.current_a[0]) / 100.0;
        }
    }
    let converter =
        Converter::new(ConverterParams { resistance_ohm: 0.01, ..ConverterParams::IDEAL })?;
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    let output_a = mean_a as Real;
    let averaged =
        converter.step(&mut (), ConverterInput { duty: 0.4, input_v: source_v, output_a });
    checks.against(&t::BUCK_VOLTAGE, f64::from(averaged.output_v), mean_v);
    checks.against(&t::BUCK_CURRENT, (0.4 * 400.0 - 100.0) / 0.5, mean_a);
    checks.against(&t::BUCK_INPUT, f64::from(averaged.input_a), source_a);
    Ok(())
}

fn step(dt_s: f64) -> anyhow::Result<Dt> {
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    Ok(Dt::from_s(dt_s as Real)?)
}
