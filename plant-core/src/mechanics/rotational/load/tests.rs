extern crate std;
use super::*;
use crate::converter::Converter;
use crate::machine::dc::{DcMotor, DcMotorParams, DcMotorState};
use crate::mechanics::gearbox::{Gearbox, GearboxParams};
use crate::port::Source;

const LOAD: RotationalLoadParams =
    RotationalLoadParams { inertia_kg_m2: 0.04, viscous_nm_s_per_rad: 0.002, coulomb_nm: 0.3 };
const MOTOR: DcMotorParams = DcMotorParams {
    resistance_ohm: 0.5,
    inductance_h: 0.004,
    back_emf_v_s_per_rad: 0.4,
    torque_nm_per_a: 0.4,
    inertia_kg_m2: 0.01,
    viscous_nm_s_per_rad: 0.001,
    coulomb_nm: 0.1,
};

fn dt(dt_s: Real) -> Dt {
    Dt::from_s(dt_s).unwrap()
}

fn load(params: RotationalLoadParams, dt_s: Real) -> RotationalLoad {
    RotationalLoad::new(params, dt(dt_s)).unwrap()
}

fn close(obtained: Real, target: Real, relative: Real) {
    assert!((obtained / target - 1.0).abs() < relative, "{obtained} against {target}");
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn speeds_up_as_the_exponential() {
    let (l, mut s) = (load(LOAD, 1e-3), RotationalLoadState::default());
    let mut out = l.step(&mut s, RotationalLoadInput { torque_nm: 1.3 });
    for _ in 1..20_000 {
        out = l.step(&mut s, RotationalLoadInput { torque_nm: 1.3 });
    }
    // One time constant J/f_s = 20 s: ω = (T − T_c)/f_s·(1 − 1/e).
    close(out.speed_rad_s, 500.0 * (1.0 - 0.367_879_44), 1e-4);
    close(out.shaft_nm, 1.3, 1e-4);
    close(out.friction_w, (0.002 * out.speed_rad_s + 0.3) * out.speed_rad_s, 1e-5);
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn the_published_load_coasts_for_hours() {
    // J = 10 kg·m², f_s = 8.5e-6: the increment is a hundredth of the last bit.
    let params =
        RotationalLoadParams { inertia_kg_m2: 10.0, viscous_nm_s_per_rad: 8.5e-6, coulomb_nm: 0.0 };
    let (l, mut s) = (load(params, 1e-3), RotationalLoadState::default());
    s.speed_rad_s = Accum::new(100.0);
    for _ in 0..3_600_000 {
        l.step(&mut s, RotationalLoadInput { torque_nm: 0.0 });
    }
    let lost = 100.0 - s.speed_rad_s.get();
    assert!((lost - 100.0 * (1.0 - 0.996_944_67)).abs() < 2e-5, "{lost}");
}

#[test]
fn friction_holds_and_stops_it() {
    let (l, mut s) = (load(LOAD, 1e-2), RotationalLoadState::default());
    assert_eq!(l.step(&mut s, RotationalLoadInput { torque_nm: 0.29 }).speed_rad_s, 0.0);
    assert!(l.step(&mut s, RotationalLoadInput { torque_nm: -0.31 }).speed_rad_s < 0.0);
    s.speed_rad_s = Accum::new(1.0);
    for _ in 0..20 {
        l.step(&mut s, RotationalLoadInput { torque_nm: 0.0 });
    }
    assert_eq!(s, RotationalLoadState::default());
}

#[test]
fn stable_at_any_step() {
    for dt_s in [1e-9, 1.0, 1e6] {
        let (l, mut s) = (load(LOAD, dt_s), RotationalLoadState::default());
        for _ in 0..1000 {
            let out = l.step(&mut s, RotationalLoadInput { torque_nm: 1.3 });
            assert!((0.0..=500.001).contains(&out.speed_rad_s), "{dt_s}: {out:?}");
        }
    }
}

/// A bench: a stiff bus, an ideal converter at `duty`, a motor, a load on its shaft.
struct Bench {
    load: RotationalLoad,
    motor: DcMotor,
    source: Source,
}

impl Bench {
    fn new(duty: Real, dt_s: Real) -> Self {
        Self {
            load: load(LOAD, dt_s),
            motor: DcMotor::new(MOTOR, dt(dt_s)).unwrap(),
            source: Converter::seen_through(Source::stiff(48.0), duty),
        }
    }

    /// Down the chain and back: both states settle from one speed increment.
    fn step(
        &self,
        motor: &mut DcMotorState,
        load: &mut RotationalLoadState,
    ) -> (RotationalLoadOutput, Real) {
        let (current_a, speed_rad_s) = (motor.current_a.get(), load.speed_rad_s.get());
        let (law, current) = self.motor.winding().law(self.source, current_a, speed_rad_s);
        let (increment_rad_s, slip) = self.load.solve(load, law, self.motor.coast());
        let increment_a = current.increment_a(increment_rad_s);
        motor.current_a.add(increment_a);
        let out = self.load.settle(load, increment_rad_s, slip);
        motor.speed_rad_s = load.speed_rad_s;
        (out, increment_a)
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_motor_with_this_load_reaches_its_steady_state() {
    let bench = Bench::new(0.5, 1e-3);
    let (mut motor, mut load) = (DcMotorState::default(), RotationalLoadState::default());
    for _ in 0..30_000 {
        bench.step(&mut motor, &mut load);
    }
    // V = R·i + Ke·ω and Kt·i = T_c + b·ω, motor and load taken together.
    let (volt, ke, friction_nm, b) = (24.0, 0.4, 0.4, 0.003);
    let speed_rad_s = (volt - 0.5 * friction_nm / ke) / (ke + 0.5 * b / ke);
    close(load.speed_rad_s.get(), speed_rad_s, 1e-5);
    close(motor.current_a.get(), (friction_nm + b * speed_rad_s) / ke, 1e-4);
}

#[test]
fn the_bench_loses_no_energy() {
    let dt_s = 1e-3;
    let (mut motor, mut load) = (DcMotorState::default(), RotationalLoadState::default());
    let [mut drawn, mut copper, mut friction, mut numerical] = [0.0_f64; 4];
    // Up, down by regeneration, and backwards.
    for duty in [1.0, 0.2, -0.6] {
        let bench = Bench::new(duty, dt_s);
        for _ in 0..2000 {
            let before = load.speed_rad_s;
            let (out, di) = bench.step(&mut motor, &mut load);
            let (i, w) = (f64::from(motor.current_a.get()), f64::from(out.speed_rad_s));
            let dw = f64::from(load.speed_rad_s.since(before));
            let h = f64::from(dt_s);
            drawn += 48.0 * f64::from(duty) * i * h;
            copper += 0.5 * i * i * h;
            friction += (f64::from(out.friction_w) + (0.1 + 0.001 * w.abs()) * w.abs()) * h;
            numerical += 0.5 * (0.004 * f64::from(di).powi(2) + 0.05 * dw.powi(2));
        }
    }
    let (i, w) = (f64::from(motor.current_a.get()), f64::from(load.speed_rad_s.get()));
    let stored = 0.5 * (0.004 * i * i + 0.05 * w * w);
    let residual = drawn - copper - friction - numerical - stored;
    assert!(w < -50.0 && drawn > 100.0, "{w} {drawn}");
    assert!((residual / copper).abs() < 1e-5, "{residual} of {drawn}");
    assert!(numerical / copper < 0.05, "{numerical} of {copper}");
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_gearbox_fits_between() {
    let (motor, gearbox) = (
        DcMotor::new(MOTOR, dt(1e-3)).unwrap(),
        Gearbox::new(GearboxParams { ratio: 5.0, ..GearboxParams::NONE }, dt(1e-3)).unwrap(),
    );
    let (winding, coast) = (motor.winding().reflected(5.0), gearbox.coast(motor.coast()));
    let (l, mut s) = (load(LOAD, 1e-3), RotationalLoadState::default());
    let mut current_a = Accum::new(0.0);
    for _ in 0..30_000 {
        let source = Source::stiff(24.0);
        let (law, current) = winding.law(source, current_a.get(), s.speed_rad_s.get());
        let (increment_rad_s, slip) = l.solve(&s, law, coast);
        current_a.add(current.increment_a(increment_rad_s));
        l.settle(&mut s, increment_rad_s, slip);
    }
    let (ke, friction_nm, b) = (2.0, 0.3 + 0.5, 0.002 + 25.0 * 0.001);
    close(s.speed_rad_s.get(), (24.0 - 0.5 * friction_nm / ke) / (ke + 0.5 * b / ke), 1e-5);
}

#[test]
fn bad_torque_changes_nothing() {
    let (l, mut s) = (load(LOAD, 1e-3), RotationalLoadState::default());
    s.speed_rad_s = Accum::new(7.0);
    let before = s;
    for bad in [Real::NAN, Real::INFINITY, -1e38] {
        assert!(l.step(&mut s, RotationalLoadInput { torque_nm: bad }).rejected);
        for law in [DriveLaw { effort: bad, slope: 0.0 }, DriveLaw { effort: 1.0, slope: bad }] {
            let (increment_rad_s, slip) = l.solve(&s, law, Coast::default());
            let out = l.settle(&mut s, increment_rad_s, slip);
            assert!(out.rejected && out.speed_rad_s == 7.0, "{law:?}");
        }
        assert_eq!(s, before);
    }
}

#[test]
fn refuses_each_bad_field_by_name() {
    let refused = |p| RotationalLoad::new(p, dt(1e-3)).unwrap_err();
    for bad in [-1.0, Real::NAN, Real::INFINITY] {
        assert_eq!(
            refused(RotationalLoadParams { inertia_kg_m2: bad, ..LOAD }),
            ParamError::NotPositive("load.inertia_kg_m2")
        );
        assert_eq!(
            refused(RotationalLoadParams { viscous_nm_s_per_rad: bad, ..LOAD }),
            ParamError::Negative("load.viscous_nm_s_per_rad")
        );
        assert_eq!(
            refused(RotationalLoadParams { coulomb_nm: bad, ..LOAD }),
            ParamError::Negative("load.coulomb_nm")
        );
    }
}

/// Steps beside a machine and another shaft, against Newton's law at their end.
#[test]
fn a_shared_shaft_keeps_newtons_law() {
    let params =
        RotationalLoadParams { inertia_kg_m2: 2.0, viscous_nm_s_per_rad: 0.5, coulomb_nm: 3.0 };
    let l = RotationalLoad::new(params, Dt::from_s(0.1).unwrap()).unwrap();
    let shaft = Coast { inertia_per_h: 10.0, viscous: 0.2, coulomb: 2.0 };
    for before in [40.0, 4.0, -4.0, -40.0] {
        for effort in [-70.0, -4.0, 4.0, 70.0] {
            let law = DriveLaw { effort, slope: 1.5 };
            let mut s = RotationalLoadState { speed_rad_s: Accum::new(before) };
            let (rise, slip) = l.solve(&s, law, shaft);
            let out = l.settle(&mut s, rise, slip);
            let now = out.speed_rad_s;
            let machine_nm = effort - 1.5 * rise;
            let other_nm = 10.0 * rise + 0.2 * now + 2.0 * slip.sign();
            assert!((now - before - rise).abs() < 1e-4 && now * slip.sign() > 0.0);
            assert!((machine_nm - other_nm - out.shaft_nm).abs() < 1e-3, "{out:?}");
            let friction_nm = 0.5 * now + 3.0 * slip.sign();
            assert!((out.shaft_nm - 20.0 * rise - friction_nm).abs() < 1e-3, "{out:?}");
            assert!((out.friction_w - friction_nm * now).abs() < 1e-2, "{out:?}");
            assert!((out.shaft_w - out.shaft_nm * now).abs() < 1e-2, "{out:?}");
        }
    }
    let mut still = RotationalLoadState::default();
    for (effort, slope) in [(Real::NAN, 0.0), (2e9, 0.0), (1.0, -1.0), (1.0, Real::INFINITY)] {
        let (rise, slip) = l.solve(&still, DriveLaw { effort, slope }, shaft);
        let out = l.settle(&mut still, rise, slip);
        assert!(out.rejected && still == RotationalLoadState::default(), "{effort} {slope}");
    }
}
