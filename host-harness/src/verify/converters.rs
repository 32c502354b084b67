//! Circuits switch by switch beside closed forms and averaged equations: a precharge, a buck and a
//! boost converter, an H-bridge with a DC motor.

use plant_core::circuit::{
    Branch, Circuit, CircuitError, CircuitInput, CircuitOutput, CircuitState, Element, Method,
    h_bridge, sources,
};
use plant_core::machine::dc::{DcMotor, DcMotorInput, DcMotorParams, DcMotorState};
use plant_core::presets::MOTOR_PASEK;
use plant_core::{Accum, Dt, Real, must};

use super::tolerance as t;
use super::{Case, Checks};

pub(super) const CASES: [Case; 4] = [
    Case {
        name: "circuit: precharge and contactor",
        models: &["Circuit"],
        run: |checks| precharge(checks, |_, _| ()),
    },
    Case {
        name: "circuit: buck converter with its filter",
        models: &["Circuit"],
        run: |checks| stage(&BUCK, checks, |_, _| ()),
    },
    Case {
        name: "circuit: boost converter",
        models: &["Circuit"],
        run: |checks| stage(&BOOST, checks, |_, _| ()),
    },
    Case {
        name: "circuit: H-bridge",
        models: &["Circuit", "DcMotor"],
        run: |checks| motor(checks, |_, _| ()),
    },
];

const STEP: Dt = must!(Dt::from_s(1e-6));
const STEP_S: f64 = 1e-6;
/// A switching period in steps: 10 kHz.
const PERIOD: u32 = 100;
const ON_OHM: Real = 0.005;
const TRANSISTOR: Element =
    Element::Transistor { on_ohm: ON_OHM, off_ohm: 1e6, drop_v: 0.0, diode_drop_v: 0.8 };

fn sound<const E: usize>(out: &CircuitOutput<E>, step: u32) -> anyhow::Result<()> {
    anyhow::ensure!(out.settled && !out.rejected, "{out:?} in step {step}");
    Ok(())
}

const BUS_V: Real = 355.0;
const CONTACT: Element = Element::Switch { on_ohm: 0.05, off_ohm: 1e8 };
/// The precharge relay with 40 Ω, and the main contactor beside both, charge 0.96 mF.
const LINK: [Branch; 5] = [
    Branch::new(1, 0, Element::Voltage),
    Branch::new(1, 2, CONTACT),
    Branch::new(2, 3, Element::Resistor { ohm: 40.0 }),
    Branch::new(1, 3, CONTACT),
    Branch::new(3, 0, Element::Capacitor { farad: 0.00096 }),
];
static PRECHARGE: Result<Circuit<4, 5, { sources(&LINK) }, 4>, CircuitError> =
    Circuit::tabled(LINK, Method::BackwardEuler, STEP);
/// The relay closes at 10 ms, the main contactor five time constants later.
const RELAY_CLOSES: u32 = 10_000;
const MAIN_CLOSES: u32 = RELAY_CLOSES + 192_000;
const END: u32 = 240_000;

/// `see` gets, in each step that is worth it, time and: voltage of the capacitor by its closed form,
/// and found; the source's current.
pub(super) fn precharge(
    checks: &mut Checks,
    mut see: impl FnMut(f64, [f64; 3]),
) -> anyhow::Result<()> {
    let circuit = PRECHARGE?;
    let mut state = CircuitState::default();
    let (bus_v, tau_s) = (f64::from(BUS_V), 40.05 * 0.00096);
    let (mut worst_v, mut before_v, mut inrush_a) = (0.0_f64, 0.0, 0.0_f64);
    for step in 1..=END {
        // What closes at a step conducts from the next on.
        let gates = u32::from(step > RELAY_CLOSES) << 1 | u32::from(step > MAIN_CLOSES) << 3;
        let values = [BUS_V, 0.0, 0.0, 0.0, 0.0];
        let out = circuit.step(&mut state, CircuitInput { values, gates });
        sound(&out, step)?;
        let (found_v, source_a) = (f64::from(out.voltage_v[4]), -f64::from(out.current_a[0]));
        let since_s = STEP_S * f64::from(step.saturating_sub(RELAY_CLOSES));
        let mut exact_v = bus_v * (1.0 - (-since_s / tau_s).exp());
        if step <= MAIN_CLOSES {
            worst_v = worst_v.max((found_v - exact_v).abs());
            before_v = exact_v;
        } else {
            let main_s = STEP_S * f64::from(step - MAIN_CLOSES);
            exact_v = bus_v - (bus_v - before_v) * (-main_s / (0.05 * 0.00096)).exp();
            inrush_a = inrush_a.max(source_a);
        }
        if step % 250 == 0 || (MAIN_CLOSES..MAIN_CLOSES + 500).contains(&step) {
            see(STEP_S * f64::from(step), [exact_v, found_v, source_a]);
        }
    }
    checks.add(&t::PRECHARGE_VOLTAGE, worst_v / bus_v);
    checks.against(&t::PRECHARGE_INRUSH, (bus_v - before_v) / 0.05, inrush_a);
    Ok(())
}

/// A converter of one leg, one coil, and one capacitor with a load beside it.
pub(super) struct Stage {
    branches: [Branch; 6],
    coil: usize,
    supply_v: Real,
    /// Share of a period in which the first switch is on, in steps of it.
    high_steps: u32,
    /// What the coil sees of the source, and of the output, in the mean.
    of_source: f64,
    of_output: f64,
    load_ohm: f64,
    /// Peak to peak, by what lies across the coil while the first switch is on \[V\].
    charging_v: fn(f64) -> f64,
}

const HENRY: Real = 1e-3;
const COIL: Element = Element::Coil { henry: HENRY, ohm: 0.1 };
const FILTER: Element = Element::Capacitor { farad: 1e-4 };

/// 400 V to some 160 V into 5 Ω.
pub(super) const BUCK: Stage = Stage {
    branches: [
        Branch::new(1, 0, Element::Voltage),
        Branch::new(1, 2, TRANSISTOR),
        Branch::new(2, 0, TRANSISTOR),
        Branch::new(2, 3, COIL),
        Branch::new(3, 0, FILTER),
        Branch::new(3, 0, Element::Resistor { ohm: 5.0 }),
    ],
    coil: 3,
    supply_v: 400.0,
    high_steps: 40,
    of_source: 0.4,
    of_output: 1.0,
    load_ohm: 5.0,
    charging_v: |output_v| 400.0 - output_v,
};

/// 200 V to some 400 V into 50 Ω.
pub(super) const BOOST: Stage = Stage {
    branches: [
        Branch::new(1, 0, Element::Voltage),
        // Towards the ground, and, its diode towards the output, to the output.
        Branch::new(2, 0, TRANSISTOR),
        Branch::new(3, 2, TRANSISTOR),
        Branch::new(1, 2, COIL),
        Branch::new(3, 0, FILTER),
        Branch::new(3, 0, Element::Resistor { ohm: 50.0 }),
    ],
    coil: 3,
    supply_v: 200.0,
    high_steps: 50,
    of_source: 1.0,
    of_output: 0.5,
    load_ohm: 50.0,
    charging_v: |_| 200.0,
};

/// From rest for 30 ms. `see` gets in each step: output voltage averaged and switched, current of the
/// coil averaged and switched.
pub(super) fn stage(
    stage: &Stage,
    checks: &mut Checks,
    mut see: impl FnMut(f64, [f64; 4]),
) -> anyhow::Result<()> {
    const STEPS: u32 = 30_000;
    let circuit: Circuit<4, 6> = Circuit::new(stage.branches, Method::BackwardEuler, STEP)?;
    let mut state = CircuitState::default();
    let (supply_v, ohm) = (f64::from(stage.supply_v), 0.1 + f64::from(ON_OHM));
    let (mut averaged_v, mut averaged_a) = (0.0, 0.0);
    let (mut means, mut worst_v) = ([0.0; 4], 0.0_f64);
    let (mut least_a, mut most_a) = (f64::INFINITY, f64::NEG_INFINITY);
    for step in 0..STEPS {
        // In the middle of a period: from its start on, the current would begin half a ripple ahead of
        // its mean.
        let from = (PERIOD - stage.high_steps) / 2;
        let high = (from..from + stage.high_steps).contains(&(step % PERIOD));
        let gates = if high { 0b010 } else { 0b100 };
        let values = [stage.supply_v, 0.0, 0.0, 0.0, 0.0, 0.0];
        let out = circuit.step(&mut state, CircuitInput { values, gates });
        sound(&out, step)?;
        let across_v = stage.of_source * supply_v - ohm * averaged_a - stage.of_output * averaged_v;
        averaged_a += STEP_S / f64::from(HENRY) * across_v;
        let into_a = stage.of_output * averaged_a - averaged_v / stage.load_ohm;
        averaged_v += STEP_S / 1e-4 * into_a;
        let coil_a = f64::from(out.current_a[stage.coil]);
        let row = [averaged_v, f64::from(out.voltage_v[4]), averaged_a, coil_a];
        if step % PERIOD == 0 {
            means = [0.0; 4];
        }
        for (mean, value) in means.iter_mut().zip(row) {
            *mean += value / f64::from(PERIOD);
        }
        if step % PERIOD == PERIOD - 1 {
            worst_v = worst_v.max((means[0] - means[1]).abs());
        }
        if step >= STEPS - PERIOD {
            (least_a, most_a) = (least_a.min(coil_a), most_a.max(coil_a));
        }
        see(STEP_S * f64::from(step + 1), row);
    }
    let [target_v, mean_v, target_a, mean_a] = means;
    checks.against(&t::STAGE_VOLTAGE, target_v, mean_v);
    checks.against(&t::STAGE_CURRENT, target_a, mean_a);
    checks.add(&t::STAGE_START, worst_v / target_v);
    let on_s = STEP_S * f64::from(stage.high_steps);
    let coil_v = (stage.charging_v)(target_v) - ohm * target_a;
    checks.against(&t::STAGE_RIPPLE, coil_v * on_s / f64::from(HENRY), most_a - least_a);
    Ok(())
}

const MOTOR: DcMotorParams = DcMotorParams { coulomb_nm: 0.0, ..MOTOR_PASEK };
const SUPPLY_V: Real = 400.0;
const LOAD_NM: Real = 0.5;
const H: [Branch; 6] =
    h_bridge(TRANSISTOR, Element::Coil { henry: MOTOR.inductance_h, ohm: MOTOR.resistance_ohm });
static H_BRIDGE: Result<Circuit<4, 6, { sources(&H) }, 16>, CircuitError> =
    Circuit::tabled(H, Method::BackwardEuler, STEP);
/// Steps in which all four gates are off after one of them was on.
const DEAD: u32 = 2;
/// Twice in a period.
const DEAD_SHARE: Real = 0.04;
/// Forward for the first half, then backward, which takes the load along.
const HALF: u32 = 500_000;

/// `see` gets for each switching period: speed averaged and switched, current averaged and its mean.
pub(super) fn motor(checks: &mut Checks, mut see: impl FnMut(f64, [f64; 4])) -> anyhow::Result<()> {
    let circuit = H_BRIDGE?;
    // Two transistors are always in series with the winding.
    let in_series = DcMotorParams { resistance_ohm: MOTOR.resistance_ohm + 2.0 * ON_OHM, ..MOTOR };
    let averaged = DcMotor::new(in_series, STEP)?;
    let (mut beside, mut state) = (DcMotorState::default(), CircuitState::default());
    let mut speed = Accum::new(0.0);
    let (mut mean_a, mut beside_a, mut worst) = (0.0, 0.0, 0.0_f64);
    let mut steady = [[0.0; 2]; 2];
    for step in 0..2 * HALF {
        let backward = step >= HALF;
        // 85 of 100 steps one diagonal, the other in the rest.
        let (first, second) = if backward { (0b01100, 0b10010) } else { (0b10010, 0b01100) };
        let gates = match step % PERIOD {
            DEAD..85 => first,
            p if p >= 85 + DEAD => second,
            _ => 0,
        };
        let back_emf_v = MOTOR.back_emf_v_s_per_rad * speed.get();
        let values = [SUPPLY_V, 0.0, 0.0, 0.0, 0.0, back_emf_v];
        let out = circuit.step(&mut state, CircuitInput { values, gates });
        sound(&out, step)?;
        let torque_nm = MOTOR.torque_nm_per_a * out.current_a[5]
            - MOTOR.viscous_nm_s_per_rad * speed.get()
            - LOAD_NM;
        speed.add(STEP.s() / MOTOR.inertia_kg_m2 * torque_nm);
        // In the dead time the diodes turn the voltage, and their drops, against the current.
        let way = if backward { -1.0 } else { 1.0 };
        let against = match beside.current_a.get() {
            a if a > 0.0 => 1.0,
            a if a < 0.0 => -1.0,
            _ => 0.0,
        };
        let voltage_v = way * 0.7 * SUPPLY_V - DEAD_SHARE * (SUPPLY_V + 1.6) * against;
        let mean = averaged.step(&mut beside, DcMotorInput { voltage_v, load_nm: LOAD_NM });
        mean_a += f64::from(out.current_a[5]) / f64::from(PERIOD);
        beside_a += f64::from(mean.current_a) / f64::from(PERIOD);
        if step % PERIOD == PERIOD - 1 {
            let speeds = [f64::from(mean.speed_rad_s), f64::from(speed.get())];
            worst = worst.max((speeds[0] - speeds[1]).abs());
            steady[usize::from(backward)] = speeds;
            see(STEP_S * f64::from(step + 1), [speeds[0], speeds[1], beside_a, mean_a]);
            (mean_a, beside_a) = (0.0, 0.0);
        }
    }
    let [[forward, found_forward], [back, found_back]] = steady;
    checks.against(&t::H_BRIDGE_SPEED, forward, found_forward);
    checks.against(&t::H_BRIDGE_SPEED, back, found_back);
    checks.add(&t::H_BRIDGE_RUN, worst / forward.abs());
    Ok(())
}
