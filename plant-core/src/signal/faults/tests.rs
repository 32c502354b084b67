//! Faults of sensors: what they do to a value, and that they do the same every time.

extern crate std;
use super::*;
use crate::error::ParamError;
use crate::model::Dt;

fn dt(dt_s: Real) -> Dt {
    Dt::from_s(dt_s).unwrap()
}

const LAPSE: LapseParams =
    LapseParams { kind: LapseKind::Missing, from_s: 0.0, chance: 0.02, length_s: 0.05, seed: 3 };

fn lapse(params: LapseParams) -> Lapse {
    Lapse::new(params, dt(0.01)).unwrap()
}

/// The generator's first numbers, as its own paper's algorithm gives them with wider arithmetic.
#[test]
fn the_generator_is_pcg32() {
    let (multiplier, increment) = (6_364_136_223_846_793_005_u128, 1_442_695_040_888_963_407_u128);
    let advance = |s: u128| (s * multiplier + increment) % (1 << 64);
    let mut state = advance((increment + 42) % (1 << 64));
    let mut random = Random::new(42);
    for _ in 0..1000 {
        let mixed = (((state >> 18) ^ state) >> 27) as u32;
        let turn = (state >> 59) as u32;
        let exact = (mixed >> turn) | mixed.checked_shl(32 - turn).unwrap_or(0);
        assert_eq!(random.bits(), exact);
        state = advance(state);
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn noise_is_normal_and_white() {
    let noise = Noise::new(NoiseParams { sd: 0.5, seed: 11 }).unwrap();
    let mut s = noise.start();
    let (mut moments, mut products, mut before) = ([0.0_f64; 4], 0.0, 0.0);
    let (count, mut beyond) = (200_000, 0);
    for _ in 0..count {
        let off = (f64::from(noise.step(&mut s, 10.0).value) - 10.0) / 0.5;
        for (moment, power) in moments.iter_mut().zip(1..) {
            *moment += off.powi(power) / f64::from(count);
        }
        products += off * before / f64::from(count);
        beyond += u32::from(off.abs() > 3.0);
        before = off;
    }
    // Three standard deviations of each figure.
    for (moment, (exact, within)) in
        moments.iter().zip([(0.0, 0.007), (1.0, 0.01), (0.0, 0.026), (3.0, 0.07)])
    {
        assert!((moment - exact).abs() < within, "{moments:?}");
    }
    assert!(products.abs() < 0.007, "{products}");
    // 0.27 % lie beyond three.
    assert!((470..610).contains(&beyond), "{beyond}");
}

#[test]
fn the_same_seed_gives_the_same_and_another_another() {
    let readings = |seed| {
        let noise = Noise::new(NoiseParams { sd: 1.0, seed }).unwrap();
        let mut s = noise.start();
        [0.0; 20].map(|x| noise.step(&mut s, x).value)
    };
    assert_eq!(readings(5), readings(5));
    assert_ne!(readings(5), readings(6));
    let quiet = Noise::new(NoiseParams { sd: 0.0, seed: 1 }).unwrap();
    assert_eq!(quiet.step(&mut quiet.start(), 3.25).value, 3.25);
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_slow_drift_does_not_stick() {
    // 1 mV a day at 1 kHz: 1e-11 of it in a step.
    let drift = Drift::new(DriftParams { per_s: 1e-3 / 86_400.0, largest: 1.0 }, dt(1e-3)).unwrap();
    let mut s = DriftState::default();
    for _ in 0..1_000_000 {
        drift.step(&mut s, 0.0);
    }
    assert!((s.offset.get() / (1000.0 * 1e-3 / 86_400.0) - 1.0).abs() < 1e-5, "{s:?}");
}

#[test]
fn what_is_late_comes_whole() {
    let late = Delay::<7>::new().unwrap();
    let mut s = late.start(-1.0).unwrap();
    for k in 0..100 {
        let out = late.step(&mut s, k as Real);
        assert_eq!(out.value, if k < 7 { -1.0 } else { k as Real - 7.0 });
    }
    assert_eq!(Delay::<0>::new(), Err(ParamError::NotPositive("delay.steps")));
    assert_eq!(late.start(Real::NAN), Err(ParamError::NotFinite("delay.value")));
}

/// The share of samples that is missing follows from chance and length; what is told is what is old.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn samples_are_missing_as_often_as_said() {
    let model = lapse(LAPSE);
    let (mut s, mut missing, mut last) = (model.start(), 0, 0.0);
    for k in 1..=100_000 {
        let out = model.step(&mut s, k as Real);
        assert_eq!(out.value, if out.missing { last } else { k as Real });
        missing += u32::from(out.missing);
        last = out.value;
    }
    // Five steps each; on average 49 between two.
    let share = f64::from(missing) / 100_000.0;
    assert!((share - 5.0 / 54.0).abs() < 0.006, "{share}");
}

#[test]
fn a_stuck_reading_stays_and_nobody_is_told() {
    let kind = LapseKind::Stuck;
    let model = lapse(LapseParams { kind, from_s: 0.1, chance: 1.0, length_s: 1e9, ..LAPSE });
    let mut s = model.start();
    for k in 0..50 {
        let out = model.step(&mut s, k as Real);
        assert_eq!((out.value, out.missing), (if k < 10 { k as Real } else { 9.0 }, false));
    }
    let never = lapse(LapseParams { kind, chance: 0.0, ..LAPSE });
    let mut s = never.start();
    assert!((0..1000).all(|k| never.step(&mut s, k as Real).value == k as Real));
}

#[test]
fn an_open_wire_reads_what_pulls_it_while_it_is_open() {
    let kind = LapseKind::OpenWire(-0.2);
    let model = lapse(LapseParams { kind, chance: 0.1, length_s: 0.03, seed: 9, ..LAPSE });
    let (mut s, mut open, mut runs) = (model.start(), 0, 0);
    let mut before = false;
    for _ in 0..2000 {
        let out = model.step(&mut s, 3.7);
        let now = out.value == -0.2;
        assert!(now || out.value == 3.7, "{out:?}");
        (open, runs) = (open + u32::from(now), runs + u32::from(now && !before));
        before = now;
    }
    assert!(open % 3 <= 2 && open >= 3 * runs && runs > 50, "{open} {runs}");
}

#[test]
fn bad_input_changes_nothing() {
    let noise = Noise::new(NoiseParams { sd: 1.0, seed: 1 }).unwrap();
    let drift = Drift::new(DriftParams { per_s: 1.0, largest: 9.0 }, dt(0.1)).unwrap();
    let (late, model) = (Delay::<2>::new().unwrap(), lapse(LAPSE));
    let (mut n, mut d) = (noise.start(), DriftState::default());
    let (mut l, mut m) = (late.start(4.0).unwrap(), model.start());
    let last = [
        noise.step(&mut n, 4.0).value,
        drift.step(&mut d, 4.0).value,
        late.step(&mut l, 4.0).value,
        model.step(&mut m, 4.0).value,
    ];
    let before = (n, d, l, m);
    for bad in [Real::NAN, Real::INFINITY, -1e38] {
        let outs = [
            noise.step(&mut n, bad),
            drift.step(&mut d, bad),
            late.step(&mut l, bad),
            model.step(&mut m, bad),
        ];
        assert!(outs.iter().all(|out| out.rejected), "{outs:?}");
        assert_eq!(outs.map(|out| out.value), last);
    }
    assert_eq!((n, d, l, m), before);
}

#[test]
fn refuses_each_bad_field_by_name() {
    for bad in [-1.0, Real::NAN] {
        let noise = Noise::new(NoiseParams { sd: bad, seed: 0 });
        assert_eq!(noise, Err(ParamError::Negative("noise.sd")));
        let drift = Drift::new(DriftParams { per_s: 0.0, largest: bad }, dt(0.1));
        assert_eq!(drift, Err(ParamError::Negative("drift.largest")));
        for (params, error) in [
            (LapseParams { from_s: bad, ..LAPSE }, ParamError::Negative("lapse.from_s")),
            (LapseParams { chance: bad, ..LAPSE }, ParamError::NotARatio("lapse.chance")),
            (LapseParams { length_s: bad, ..LAPSE }, ParamError::NotALimit("lapse.length_s")),
        ] {
            assert_eq!(Lapse::new(params, dt(0.1)), Err(error));
        }
    }
    let drift = Drift::new(DriftParams { per_s: Real::NAN, largest: 1.0 }, dt(0.1));
    assert_eq!(drift, Err(ParamError::NotFinite("drift.per_s")));
    for bad in [Real::NAN, 1e10] {
        let open = LapseParams { kind: LapseKind::OpenWire(bad), ..LAPSE };
        assert_eq!(Lapse::new(open, dt(0.1)), Err(ParamError::NotFinite("lapse.open_wire")));
    }
}
