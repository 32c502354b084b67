//! The battery on its own.

extern crate std;
use super::*;

const PARAMS: BatteryParams = BatteryParams {
    open_circuit: OpenCircuit::Linear { empty_v: 300.0, full_v: 400.0 },
    capacity_ah: 2.0,
    series_resistance_ohm: 0.1,
    polarisation: RcBranchParams { resistance_ohm: 0.05, capacitance_f: 200.0 },
    discharge_limit_a: 100.0,
    charge_limit_a: 50.0,
    voltage_limits: VoltageLimits::NONE,
};

fn battery(dt_s: Real) -> Battery {
    Battery::new(PARAMS, Dt::from_s(dt_s).unwrap()).unwrap()
}

fn load(current_a: Real) -> BatteryInput {
    BatteryInput { current_a }
}

/// As an estimate may set it.
#[test]
fn a_charge_outside_its_range_counts_as_its_end() {
    let b = battery(0.001);
    for (soc, end) in [(1.0001, 1.0), (-0.0001, 0.0)] {
        let mut s = BatteryState { soc: Accum::new(soc), ..BatteryState::rested(0.5).unwrap() };
        let limits = b.limits(&s);
        assert!(limits.discharge_a >= 0.0 && limits.charge_a >= 0.0, "{limits:?}");
        let out = b.step(&mut s, load(0.0));
        assert_eq!((out.current_a, out.soc, out.rejected), (0.0, end, false));
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn counts_charge_and_drops_voltage() {
    let (b, mut s) = (battery(0.001), BatteryState::rested(0.8).unwrap());
    let mut out = b.step(&mut s, load(20.0));
    for _ in 1..36_000 {
        out = b.step(&mut s, load(20.0));
    }
    // 20 A for 36 s = 0.2 Ah of 2 Ah; the branch (τ = 10 s) has settled to 97 %.
    assert!((out.soc - 0.7).abs() < 1e-6, "{}", out.soc);
    let rc_v = 1.0 - Real::from(-3.6_f32).exp();
    assert!((out.terminal_v - (370.0 - 2.0 - rc_v)).abs() < 2e-3, "{}", out.terminal_v);
    assert!((out.heat_w - (40.0 + rc_v * rc_v / 0.05)).abs() < 1e-2);
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_small_current_on_a_large_pack_still_counts() {
    let p = BatteryParams { capacity_ah: 100.0, ..PARAMS };
    let b = Battery::new(p, Dt::from_s(0.001).unwrap()).unwrap();
    let mut s = BatteryState::rested(0.9).unwrap();
    for _ in 0..1_000_000 {
        b.step(&mut s, load(1.0));
    }
    assert!((s.soc.get() - (0.9 - 1000.0 / 360_000.0)).abs() < 2e-7);
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn stops_at_empty_and_full_and_says_what_it_refused() {
    for (soc, current, end) in [(0.001, 60.0, 0.0), (0.999, -40.0, 1.0)] {
        let (b, mut s) = (battery(0.01), BatteryState::rested(soc).unwrap());
        let (mut flowed, mut refused) = (0.0, 0.0);
        for _ in 0..10_000 {
            let out = b.step(&mut s, load(current));
            flowed += f64::from(out.current_a) * 0.01;
            refused += f64::from(out.refused_charge_c);
            assert!((0.0..=1.0).contains(&out.soc));
        }
        let out = b.step(&mut s, load(current));
        assert!((f64::from(out.soc) - end).abs() < 1e-6);
        assert_eq!((out.depleted, out.full), (end == 0.0, end == 1.0));
        let asked = f64::from(current) * 100.0;
        assert!((flowed + refused - asked).abs() < 1e-4 * asked.abs(), "{flowed} {refused}");
        assert!((flowed.abs() - 7.2).abs() < 0.01, "{flowed}");
        // and the other direction is open
        assert!(b.step(&mut s, load(-current / 10.0)).current_a != 0.0);
    }
}

#[test]
fn limits_the_current() {
    let (b, mut s) = (battery(0.01), BatteryState::rested(0.5).unwrap());
    assert_eq!(b.step(&mut s, load(500.0)).current_a, 100.0);
    let out = b.step(&mut s, load(-500.0));
    assert_eq!(out.current_a, -50.0);
    assert!((out.refused_charge_c + 4.5).abs() < 1e-3, "{}", out.refused_charge_c);
}

#[test]
fn stored_energy_falls_by_what_leaves_at_the_open_circuit_voltage() {
    let (b, mut s) = (battery(1.0), BatteryState::rested(0.8).unwrap());
    let before = s;
    let first = b.step(&mut s, load(10.0));
    let mut left = first.open_circuit_v * 10.0;
    for _ in 1..100 {
        left += b.step(&mut s, load(10.0)).open_circuit_v * 10.0;
    }
    let dropped = b.discharged_energy_j(&before, &s);
    assert!((dropped / left - 1.0).abs() < 3e-4, "{dropped} {left}");
    assert_eq!(b.discharged_energy_j(&s, &s), 0.0);
    // Full at 400 V down to 300 V: 350 V on average.
    assert!((first.stored_energy_j / (7200.0 * 0.8 * 340.0) - 1.0).abs() < 2e-3);
}

#[test]
fn bad_input_changes_nothing() {
    let (b, mut s) = (battery(1.0), BatteryState::rested(0.5).unwrap());
    let before = s;
    for bad in [Real::NAN, Real::INFINITY, -1e38] {
        let out = b.step(&mut s, load(bad));
        assert!(out.rejected && out.terminal_v.is_finite() && s == before);
    }
}

#[test]
fn refuses_each_bad_field_by_name() {
    let refused = |p| Battery::new(p, Dt::from_s(0.001).unwrap()).unwrap_err();
    for bad in [0.0, -1.0, Real::NAN] {
        assert_eq!(
            refused(BatteryParams { capacity_ah: bad, ..PARAMS }),
            ParamError::NotPositive("battery.capacity_ah")
        );
        assert_eq!(
            refused(BatteryParams { series_resistance_ohm: bad, ..PARAMS }),
            ParamError::NotPositive("battery.series_resistance_ohm")
        );
        assert_eq!(
            refused(BatteryParams { discharge_limit_a: bad, ..PARAMS }),
            ParamError::NotALimit("battery.discharge_limit_a")
        );
        assert_eq!(
            refused(BatteryParams { charge_limit_a: bad, ..PARAMS }),
            ParamError::NotALimit("battery.charge_limit_a")
        );
    }
    for bad in [-0.1, 1.1, Real::NAN] {
        assert_eq!(BatteryState::rested(bad), Err(ParamError::NotARatio("soc")));
    }
}

#[test]
fn energy_is_stored_as_charge_and_in_the_branch() {
    let b = battery(1.0);
    let mut s = BatteryState::rested(0.5).unwrap();
    s.rc.voltage_v = Accum::new(3.0);
    // 1 Ah between 300 V and 350 V, and 200 F at 3 V.
    let stored_j = 3600.0 * 325.0 + 0.5 * 200.0 * 9.0;
    assert!((b.stored_energy_j(&s) / stored_j - 1.0).abs() < 1e-6, "{}", b.stored_energy_j(&s));
}

#[test]
fn what_is_left_of_the_charge_limits_the_current() {
    let b = battery(1.0);
    // 7200 C in all, so 10 A for 1 s take 0.14 %.
    for (soc, discharge_a, charge_a) in
        [(0.5, 100.0, 50.0), (0.001, 7.2, 50.0), (0.999, 100.0, 7.2)]
    {
        let limits = b.limits(&BatteryState::rested(soc).unwrap());
        assert!((limits.discharge_a / discharge_a - 1.0).abs() < 1e-3, "{limits:?}");
        assert!((limits.charge_a / charge_a - 1.0).abs() < 1e-3, "{limits:?}");
    }
    // In a plant of short steps they fade over 0.1 s, from where they would be used up by then.
    let b = battery(0.001);
    for (soc, discharge_a, charge_a) in
        [(0.0013, 93.6, 50.0), (0.0015, 100.0, 50.0), (0.9994, 100.0, 43.2), (0.999, 100.0, 50.0)]
    {
        let s = BatteryState::rested(soc).unwrap();
        let faded = b.faded(&s);
        assert!((faded.discharge_a / discharge_a - 1.0).abs() < 1e-3, "{soc}: {faded:?}");
        assert!((faded.charge_a / charge_a - 1.0).abs() < 1e-3, "{soc}: {faded:?}");
    }
}

/// Beyond `faded` no step is allowed, and up to it any is, clear of the ends of charge: near a
/// voltage, with high limits and with none.
#[test]
fn what_it_allows_is_what_is_left_of_its_limits() {
    let voltages = VoltageLimits { lowest_v: 320.0, highest_v: 390.0 };
    for (limit_a, dt_s) in [(100.0, 1e-3), (100.0, 1.0), (2000.0, 1e-3), (Real::INFINITY, 1e-3)] {
        for voltage_limits in [VoltageLimits::NONE, voltages] {
            let limits = BatteryParams {
                discharge_limit_a: limit_a,
                charge_limit_a: limit_a,
                voltage_limits,
                ..PARAMS
            };
            let b = Battery::new(limits, Dt::from_s(dt_s).unwrap()).unwrap();
            for soc in [5e-4, 1.5e-3, 2e-3, 0.01, 0.205, 0.5, 0.895, 0.99, 0.998, 0.9985, 0.9995] {
                let mut s = BatteryState::rested(soc).unwrap();
                s.rc.voltage_v = Accum::new(0.7);
                let faded = b.faded(&s);
                for share in [0.0, 0.5, 0.98, 1.02, 1.5, 30.0] {
                    for current_a in [share * faded.discharge_a, -share * faded.charge_a] {
                        if current_a.abs() > 1e8 || current_a == 0.0 {
                            continue;
                        }
                        let next = b.next(&s, current_a);
                        let clear = (2e-3..=0.998).contains(&next.soc.get());
                        let allowed = b.allows(current_a, current_a, &next);
                        let told = (limit_a, dt_s, soc, current_a, faded);
                        assert!(!allowed || share <= 1.0, "{told:?}");
                        assert!(allowed || !clear || share > 1.0, "{told:?}");
                    }
                }
            }
        }
    }
    // Near the ends the limits are looked at in any case.
    for (soc, far) in [(0.0009, false), (0.0014, true), (0.9992, true), (0.9994, false)] {
        let (b, s) = (battery(0.001), BatteryState::rested(soc).unwrap());
        assert_eq!(b.allows(0.0, 0.0, &b.next(&s, 0.0)), far, "{soc}");
    }
}

/// As a constant-current discharge or charge ends: at the voltage, with what keeps it.
#[test]
fn voltages_limit_the_current() {
    let voltage_limits = VoltageLimits { lowest_v: 320.0, highest_v: 390.0 };
    for (soc, current_a, end_v) in [(0.3, 60.0, 320.0), (0.8, -40.0, 390.0)] {
        let b = Battery::new(BatteryParams { voltage_limits, ..PARAMS }, Dt::from_s(0.1).unwrap());
        let (b, mut s) = (b.unwrap(), BatteryState::rested(soc).unwrap());
        let (mut last_a, mut refused_c, mut steps) = (current_a, 0.0, 0);
        for _ in 0..3000 {
            let out = b.step(&mut s, load(current_a));
            assert!((out.terminal_v - end_v) * current_a >= -1e-2, "beyond: {out:?}");
            // It only ever falls, and keeps the voltage from then on.
            assert!(out.current_a.abs() <= last_a.abs() + 1e-3, "{out:?} after {last_a}");
            assert!(out.current_a == current_a || (out.terminal_v - end_v).abs() < 1e-3, "{out:?}");
            steps += u32::from(out.current_a != current_a);
            (last_a, refused_c) = (out.current_a, refused_c + out.refused_charge_c);
        }
        assert!(steps > 1000 && last_a.abs() < 0.3 * current_a.abs(), "{steps} {last_a}");
        assert!(refused_c * current_a > 0.0);
        // The other way is open.
        assert_eq!(b.step(&mut s, load(-0.5 * current_a)).current_a, -0.5 * current_a);
    }
    // Beyond a limit at rest already, nothing flows that way.
    let b = Battery::new(BatteryParams { voltage_limits, ..PARAMS }, Dt::from_s(0.1).unwrap());
    let (b, mut s) = (b.unwrap(), BatteryState::rested(0.1).unwrap());
    assert_eq!(b.step(&mut s, load(50.0)).current_a, 0.0);
    assert_eq!(b.step(&mut s, load(-50.0)).current_a, -50.0);
}

#[test]
fn settling_beyond_the_last_bit_ends_at_empty_or_full() {
    let b = battery(1.0);
    for (soc, current_a, end) in [(0.001, 8.0, 0.0), (0.999, -8.0, 1.0)] {
        let mut s = BatteryState::rested(soc).unwrap();
        let beyond_c = b.settle(&mut s, current_a);
        assert!(beyond_c * current_a < 0.0 && beyond_c.abs() < current_a.abs() * 100.0);
        assert_eq!(s.soc, Accum::new(end));
    }
}
