extern crate std;
use super::*;
use crate::battery::{
    Battery, BatteryInput, BatteryParams, BatteryState, BranchMap, HysteresisParams,
    IdentifiedRange, OverSoc, Pack, RcBranchParams, ResistanceMap, ThermalParams, VoltageLimits,
};
use crate::num::SocTable;

const PLAIN: BatteryParams = BatteryParams {
    open_circuit: OpenCircuit::Linear { empty_v: 3.0, full_v: 4.2 },
    capacity_ah: 3.0,
    series_resistance_ohm: 0.03,
    polarisation: RcBranchParams { resistance_ohm: 0.02, capacitance_f: 500.0 },
    discharge_limit_a: 10.0,
    charge_limit_a: 3.0,
    voltage_limits: VoltageLimits::NONE,
};

/// The same battery, as a map.
const SAME: MappedBatteryParams = MappedBatteryParams {
    capacity_ah: 3.0,
    discharge_limit_a: 10.0,
    charge_limit_a: 3.0,
    voltage_limits: VoltageLimits::NONE,
    refresh_s: 1.0,
    open_circuit: PLAIN.open_circuit,
    hysteresis: HysteresisParams::NONE,
    series: ResistanceMap { resistance_ohm: OverSoc::Constant(0.03), activation_k: 0.0 },
    polarisation: BranchMap {
        resistance_ohm: OverSoc::Constant(0.02),
        activation_k: 0.0,
        time_constant_s: 10.0,
    },
    second_polarisation: BranchMap::NONE,
    thermal: ThermalParams::FIXED,
    identified: IdentifiedRange::ALL,
};

fn dt(seconds: Real) -> Dt {
    Dt::from_s(seconds).unwrap()
}

fn mapped(params: MappedBatteryParams, dt_s: Real) -> MappedBattery {
    MappedBattery::new(params, dt(dt_s)).unwrap()
}

fn load(current_a: Real) -> MappedBatteryInput {
    MappedBatteryInput { current_a }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_map_of_constants_is_the_constant_battery() {
    let (plain, map) = (Battery::new(PLAIN, dt(0.1)).unwrap(), mapped(SAME, 0.1));
    let (mut p, mut m) = (BatteryState::rested(0.9).unwrap(), map.rested(0.9).unwrap());
    for i in 0..30_000_u32 {
        // Includes what the limits refuse, in both directions.
        let current_a = [2.0, -1.0, 12.0, 0.0, -4.0, 3.0][(i / 500) as usize % 6];
        let a = plain.step(&mut p, BatteryInput { current_a });
        let b = map.step(&mut m, load(current_a));
        assert!((a.terminal_v - b.terminal_v).abs() < 2e-6, "{i}: {a:?} {b:?}");
        assert_eq!((a.soc, a.current_a), (b.soc, b.current_a));
        assert_eq!(a.refused_charge_c, b.refused_charge_c);
        assert!((plain.limits(&p).discharge_a - map.limits(&m).discharge_a).abs() < 1e-6);
    }
    assert!(p.soc.get() < 0.5);
    let (from, to) = (map.rested(0.9).unwrap(), m);
    let ours = Pack::discharged_energy_j(&map, &from, &to);
    let theirs = plain.discharged_energy_j(&BatteryState::rested(0.9).unwrap(), &p);
    assert!((ours / theirs - 1.0).abs() < 1e-6, "{ours} {theirs}");
}

#[test]
fn resistances_follow_charge_and_temperature_and_hold_outside() {
    let table = SocTable::from_points("t", &[(0.0, 0.06), (1.0, 0.02)]).unwrap();
    let params = MappedBatteryParams {
        series: ResistanceMap { resistance_ohm: OverSoc::Table(table), activation_k: 3000.0 },
        identified: IdentifiedRange {
            soc_min: 0.25,
            soc_max: 0.75,
            temperature_min_c: 0.0,
            temperature_max_c: 40.0,
        },
        ..SAME
    };
    let map = mapped(params, 0.1);
    let at = |soc, celsius| map.resistances(soc, celsius).series_ohm;
    assert!((at(0.5, 25.0) - 0.04).abs() < 1e-7);
    // exp(3000·(1/273.15 − 1/298.15))
    assert!((at(0.5, 0.0) / 0.04 - 2.511_4).abs() < 1e-3, "{}", at(0.5, 0.0));
    assert!(at(0.5, 40.0) < 0.04);
    assert_eq!((at(0.5, -20.0), at(0.5, 60.0)), (at(0.5, 0.0), at(0.5, 40.0)));
    assert_eq!((at(0.1, 25.0), at(0.9, 25.0)), (at(0.25, 25.0), at(0.75, 25.0)));
    assert_eq!(map.resistances(0.5, 0.0).polarisation_ohm, [0.02, 0.0]);

    for (soc, celsius, outside) in [
        (0.5, 25.0, false),
        (0.1, 25.0, true),
        (0.9, 25.0, true),
        (0.5, -1.0, true),
        (0.5, 41.0, true),
    ] {
        let mut s = map.rested_at(soc, celsius).unwrap();
        assert_eq!(map.step(&mut s, load(1.0)).outside_identified, outside, "{soc} {celsius}");
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn both_branches_follow_their_exponentials() {
    let params = MappedBatteryParams {
        second_polarisation: BranchMap {
            resistance_ohm: OverSoc::Constant(0.05),
            activation_k: 0.0,
            time_constant_s: 200.0,
        },
        ..SAME
    };
    let map = mapped(params, 0.1);
    let mut s = map.rested(0.9).unwrap();
    for _ in 0..1000 {
        map.step(&mut s, load(2.0));
    }
    let [fast, slow] = s.polarisation_v.map(Accum::get);
    assert!((fast - 0.04).abs() < 1e-5, "{fast}");
    let exact = 0.1 * (1.0 - Real::from(-0.5_f32).exp());
    assert!((slow / exact - 1.0).abs() < 1e-3, "{slow} {exact}");
    // Both show at the terminals.
    let out = map.step(&mut s, load(2.0));
    let wanted = out.open_circuit_v - 2.0 * 0.03 - fast - slow;
    assert!((out.terminal_v - wanted).abs() < 1e-4, "{out:?}");
    assert!((out.heat_w - 2.0 * (out.open_circuit_v - out.terminal_v)).abs() < 1e-6);
}

const NODE: ThermalParams =
    ThermalParams { heat_capacity_j_per_k: 50.0, cooling_w_per_k: 0.1, ambient_c: 20.0 };

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn warms_to_its_steady_state_and_cools_to_its_surroundings() {
    for dt_s in [0.01, 1.0] {
        let map = mapped(
            MappedBatteryParams { thermal: NODE, capacity_ah: 300.0, charge_limit_a: 10.0, ..SAME },
            dt_s,
        );
        let mut s = map.rested(0.5).unwrap();
        let steps = (5000.0 / dt_s) as u32;
        let mut heat_w = 0.0;
        for _ in 0..steps {
            heat_w = map.step(&mut s, load(5.0)).heat_w;
        }
        // 25 A² · 50 mΩ over 0.1 W/K, ten time constants later.
        assert!((heat_w - 1.25).abs() < 1e-3);
        assert!((s.temperature_c.get() - 32.5).abs() < 0.02, "{}", s.temperature_c.get());
        s.ambient_c = 0.0;
        for _ in 0..steps {
            map.step(&mut s, load(0.0));
        }
        assert!(s.temperature_c.get().abs() < 0.02, "{}", s.temperature_c.get());
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn all_heat_enters_the_node() {
    let thermal = ThermalParams { cooling_w_per_k: 0.0, ..NODE };
    let map = mapped(MappedBatteryParams { thermal, ..SAME }, 0.1);
    let mut s = map.rested(0.5).unwrap();
    let mut heat_j = 0.0;
    for i in 0..6000_u32 {
        let out = map.step(&mut s, load(if i < 3000 { 6.0 } else { -2.0 }));
        heat_j += f64::from(out.heat_w) * 0.1;
    }
    let risen = f64::from(s.temperature_c.get()) - 20.0;
    assert!((risen * 50.0 / heat_j - 1.0).abs() < 1e-4, "{risen} {heat_j}");
}

#[test]
fn a_warm_battery_resists_less_only_after_a_refresh() {
    let series = ResistanceMap { resistance_ohm: OverSoc::Constant(0.03), activation_k: 3000.0 };
    let map = mapped(MappedBatteryParams { series, ..SAME }, 0.1);
    let mut s = map.rested_at(0.5, 10.0).unwrap();
    let cold = map.offer(&s).0.resistance_ohm;
    s.temperature_c = Accum::new(30.0);
    for _ in 0..9 {
        map.step(&mut s, load(0.0));
        assert_eq!(map.offer(&s).0.resistance_ohm, cold);
    }
    map.step(&mut s, load(0.0));
    assert!(map.offer(&s).0.resistance_ohm < 0.6 * cold);
    // A measured temperature counts at once; an absurd one not at all.
    assert!(map.set_temperature(&mut s, 10.0));
    assert_eq!(map.offer(&s).0.resistance_ohm, cold);
    let before = s;
    for bad in [Real::NAN, 300.0, -150.0] {
        assert!(!map.set_temperature(&mut s, bad));
        assert_eq!(s, before);
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn surroundings_that_cannot_be_are_ignored() {
    let thermal =
        ThermalParams { heat_capacity_j_per_k: 100.0, cooling_w_per_k: 1.0, ..SAME.thermal };
    let map = mapped(MappedBatteryParams { thermal, ..SAME }, 1.0);
    for bad in [Real::NAN, Real::INFINITY, 293.15, -Real::INFINITY] {
        let mut s = map.rested_at(0.5, 20.0).unwrap();
        let mut told = s;
        for n in 0..3000 {
            s.ambient_c = if n < 1000 { 40.0 } else { bad };
            told.ambient_c = 40.0;
            assert!(!map.step(&mut s, load(5.0)).rejected);
            map.step(&mut told, load(5.0));
            assert_eq!(s.temperature_c, told.temperature_c, "{n} {bad}");
        }
        s.temperature_c = Accum::new(Real::NAN);
        for _ in 0..1000 {
            map.step(&mut s, load(5.0));
        }
        assert!((20.0..60.0).contains(&s.temperature_c.get()), "{:?}", s.temperature_c);
    }
}

#[test]
fn a_temperature_held_at_the_end_is_flagged() {
    let map = mapped(MappedBatteryParams { identified: IdentifiedRange::ALL, ..SAME }, 1.0);
    let mut s = map.rested_at(0.5, 199.0).unwrap();
    assert!(!map.step(&mut s, load(0.0)).outside_identified);
    for end in [200.0, -100.0] {
        assert!(map.set_temperature(&mut s, end));
        assert!(map.step(&mut s, load(0.0)).outside_identified, "{end}");
    }
}

#[test]
fn hysteresis_stays_between_its_curves_and_moves_with_charge() {
    let hysteresis = HysteresisParams { half_gap_v: 0.05, rate_per_soc: 100.0 };
    let map = mapped(MappedBatteryParams { hysteresis, ..SAME }, 1.0);
    let mut s = map.rested(0.9).unwrap();
    let emf = |s: &MappedBatteryState| map.offer(s).0.emf_v - map.offer(s).1;
    for _ in 0..400 {
        map.step(&mut s, load(3.0));
    }
    // 11 % of the charge and 11 rates later.
    assert!((s.hysteresis.get() + 1.0).abs() < 1e-3, "{}", s.hysteresis.get());
    for _ in 0..200 {
        map.step(&mut s, load(0.0));
    }
    assert!((emf(&s) + 0.05).abs() < 1e-4, "{}", emf(&s));
    // 1 % of charge back: exp(−1) of the gap is left.
    for _ in 0..36 {
        map.step(&mut s, load(-3.0));
    }
    let exact = 1.0 - 2.0 * Real::from(-1.0_f32).exp();
    assert!((s.hysteresis.get() - exact).abs() < 0.02, "{} {exact}", s.hysteresis.get());
}

#[test]
fn bad_input_changes_nothing() {
    let map = mapped(SAME, 1.0);
    let mut s = map.rested(0.5).unwrap();
    let before = s;
    for bad in [Real::NAN, Real::INFINITY, -1e38] {
        let out = map.step(&mut s, load(bad));
        assert!(out.rejected && out.terminal_v.is_finite() && s == before);
    }
    assert_eq!(map.rested(1.5), Err(ParamError::NotARatio("soc")));
    assert_eq!(map.rested_at(0.5, 1e3), Err(ParamError::OutOfRange("temperature_c")));
}

#[test]
fn stays_finite_however_hot_it_is_made() {
    let thermal = ThermalParams { heat_capacity_j_per_k: 1e-6, ..NODE };
    let series = ResistanceMap { resistance_ohm: OverSoc::Constant(0.03), activation_k: 9000.0 };
    let map = mapped(MappedBatteryParams { series, thermal, ..SAME }, 1.0);
    let mut s = map.rested(0.9).unwrap();
    for i in 0..500_u32 {
        let out = map.step(&mut s, load(if i % 7 == 0 { -3.0 } else { 10.0 }));
        assert!((-100.0..=200.0).contains(&out.temperature_c) && out.terminal_v.is_finite());
    }
}

type Case = (fn(&mut MappedBatteryParams), ParamError);

const REFUSED: [Case; 24] = {
    use ParamError::{
        Decreasing, Negative, NotALimit, NotARatio, NotAbove, NotPositive, OutOfRange,
    };
    const NAN: Real = Real::NAN;
    const FALLING: OpenCircuit = OpenCircuit::Linear { empty_v: 4.0, full_v: 3.0 };
    [
        (|p| p.capacity_ah = 0.0, NotPositive("battery.capacity_ah")),
        (|p| p.discharge_limit_a = NAN, NotALimit("battery.discharge_limit_a")),
        (|p| p.charge_limit_a = 0.0, NotALimit("battery.charge_limit_a")),
        (|p| p.refresh_s = 0.0, NotPositive("battery.refresh_s")),
        (|p| p.open_circuit = FALLING, Decreasing("battery.open_circuit.linear.full_v")),
        (|p| p.hysteresis.half_gap_v = -1.0, Negative("battery.hysteresis.half_gap_v")),
        (|p| p.hysteresis.rate_per_soc = NAN, Negative("battery.hysteresis.rate_per_soc")),
        (
            |p| p.series.resistance_ohm = OverSoc::Constant(-0.1),
            Negative("battery.series.resistance_ohm"),
        ),
        (
            |p| {
                let falling = SocTable::from_points("t", &[(0.0, 0.1), (1.0, -0.1)]).unwrap();
                p.series.resistance_ohm = OverSoc::Table(falling);
            },
            Negative("battery.series.resistance_ohm"),
        ),
        (|p| p.series.activation_k = -1.0, Negative("battery.series.activation_k")),
        (|p| p.series.activation_k = 3e4, OutOfRange("battery.series.activation_k")),
        (
            |p| p.polarisation.resistance_ohm = OverSoc::Constant(NAN),
            Negative("battery.polarisation.resistance_ohm"),
        ),
        (
            |p| p.polarisation.time_constant_s = 0.0,
            NotPositive("battery.polarisation.time_constant_s"),
        ),
        (
            |p| p.second_polarisation.activation_k = 3e4,
            OutOfRange("battery.second_polarisation.activation_k"),
        ),
        (
            |p| p.second_polarisation.time_constant_s = NAN,
            NotPositive("battery.second_polarisation.time_constant_s"),
        ),
        (
            |p| p.thermal.heat_capacity_j_per_k = 0.0,
            NotALimit("battery.thermal.heat_capacity_j_per_k"),
        ),
        (|p| p.thermal.cooling_w_per_k = -0.1, Negative("battery.thermal.cooling_w_per_k")),
        (|p| p.thermal.ambient_c = 300.0, OutOfRange("battery.thermal.ambient_c")),
        (|p| p.identified.soc_min = -0.1, NotARatio("battery.identified.soc_min")),
        (|p| p.identified.soc_max = 1.1, NotARatio("battery.identified.soc_max")),
        (|p| p.identified.soc_max = 0.0, NotAbove("battery.identified.soc_max")),
        (
            |p| p.identified.temperature_min_c = NAN,
            OutOfRange("battery.identified.temperature_min_c"),
        ),
        (
            |p| p.identified.temperature_max_c = 400.0,
            OutOfRange("battery.identified.temperature_max_c"),
        ),
        (
            |p| p.identified.temperature_max_c = -101.0 + 0.5,
            OutOfRange("battery.identified.temperature_max_c"),
        ),
    ]
};

#[test]
fn refuses_each_bad_field_by_name() {
    for (spoil, error) in REFUSED {
        let mut params = SAME;
        spoil(&mut params);
        assert_eq!(MappedBattery::new(params, dt(0.1)), Err(error));
    }
    let mut params = SAME;
    params.identified.temperature_min_c = 20.0;
    params.identified.temperature_max_c = 10.0;
    let above = ParamError::NotAbove("battery.identified.temperature_max_c");
    assert_eq!(MappedBattery::new(params, dt(0.1)), Err(above));
}

#[test]
fn the_plant_sees_its_losses_and_its_magnitude() {
    let hysteresis = HysteresisParams { half_gap_v: 0.5, rate_per_soc: 100.0 };
    let map = mapped(MappedBatteryParams { hysteresis, ..SAME }, 1.0);
    let mut before = map.rested(0.5).unwrap();
    before.hysteresis = Accum::new(-0.5);
    let mut after = before;
    after.polarisation_v = [Accum::new(0.4), Accum::new(-0.1)];
    after.heat_j = -7.0;
    assert!((<MappedBattery as Pack>::magnitude(&after) - 7.5).abs() < 1e-6);
    let losses = map.losses(&before, &after, 2.0);
    assert!((losses.series - 0.03 * 4.0).abs() < 1e-6, "{losses:?}");
    assert!((losses.polarisation - (0.4 - 0.1 + 0.25) * 2.0).abs() < 1e-6, "{losses:?}");
    assert_eq!((losses.numerical, map.loss_factors()), (0.0, (1.0, 1.0)));
    // Each branch has lost its share by the end of the step: 1/11 at 10 s, 1/2 at 1 s.
    assert!((map.offer(&before).0.emf_v - (3.6 - 0.25)).abs() < 1e-5);
    let emf_v = map.offer(&after).0.emf_v;
    assert!((emf_v - (3.35 - 0.4 / 1.1 + 0.1 / 2.0)).abs() < 1e-5, "{emf_v}");
}

#[test]
fn what_it_allows_are_its_limits() {
    let map = mapped(SAME, 1.0);
    let allows = |soc, current_a| {
        let s = map.rested(soc).unwrap();
        map.allows(current_a, current_a, &map.next(&s, current_a))
    };
    // 10 800 C in all.
    for (soc, discharge_a, charge_a) in [(0.5, 10.0, 3.0), (5e-4, 5.4, 3.0), (0.9999, 10.0, 1.08)] {
        let limits = map.limits(&map.rested(soc).unwrap());
        assert!((limits.discharge_a / discharge_a - 1.0).abs() < 1e-3, "{limits:?}");
        assert!((limits.charge_a / charge_a - 1.0).abs() < 1e-3, "{limits:?}");
        assert!(!allows(soc, 1.01 * discharge_a) && !allows(soc, -1.01 * charge_a));
        let within = allows(soc, 0.99 * discharge_a) && allows(soc, -0.99 * charge_a);
        assert!(soc != 0.5 || within);
    }
    assert!(allows(0.5, 10.0) && allows(0.5, -3.0), "the limits themselves");
    for (soc, current_a, end) in [(1e-4, 2.0, 0.0), (0.9999, -2.0, 1.0)] {
        let mut s = map.rested(soc).unwrap();
        map.settle(&mut s, current_a);
        assert_eq!(s.soc, Accum::new(end));
    }
}

/// The voltage in it is that of the step's own source: hysteresis and branches as they were.
#[test]
fn voltages_limit_the_current() {
    let voltage_limits = VoltageLimits { lowest_v: 3.3, highest_v: 3.9 };
    let hysteresis = HysteresisParams { half_gap_v: 0.05, rate_per_soc: 1e4 };
    let params = MappedBatteryParams { voltage_limits, hysteresis, ..SAME };
    let params = MappedBatteryParams { discharge_limit_a: 100.0, charge_limit_a: 100.0, ..params };
    let map = mapped(params, 0.1);
    for h in [-0.8, 0.6] {
        let mut s = map.rested(0.5).unwrap();
        s.hysteresis = Accum::new(h);
        s.polarisation_v = [Accum::new(0.03), Accum::new(-0.02)];
        let faded = map.faded(&s);
        assert!(faded.discharge_a < 20.0 && faded.charge_a < 20.0, "{faded:?}");
        for current_a in [faded.discharge_a, -faded.charge_a] {
            for (share, allowed) in [(0.5, true), (0.999, true), (1.001, false), (1.5, false)] {
                let current_a = share * current_a;
                let next = map.next(&s, current_a);
                assert_eq!(map.allows(current_a, current_a, &next), allowed, "{h} {share}");
            }
            let out = map.step(&mut s.clone(), MappedBatteryInput { current_a: 2.0 * current_a });
            let end_v = if current_a > 0.0 { 3.3 } else { 3.9 };
            assert!((out.terminal_v - end_v).abs() < 1e-5, "{out:?}");
            assert!((out.current_a - current_a).abs() < 1e-4 * current_a.abs(), "{out:?}");
        }
    }
}
