//! With a machine: torque there, limits held, wrong parameters made up for, no winding up.

extern crate std;
use super::*;
use crate::machine::flux::{Flux, LinearFlux};
use crate::machine::pmsm::{COPPER_PER_K, Pmsm, PmsmOutput, PmsmSpeedInput, PmsmState};
use crate::machine::transform::{RotorAngle, averaged_inverter, duties};
use crate::num::{PI, wrap_turns};

const MACHINE: PmsmParams = PmsmParams {
    flux: Flux::Linear(LinearFlux { magnet_wb: 0.05, d_h: 1e-4, q_h: 3e-4 }),
    resistance_ohm: 8e-3,
    resistance_per_k: COPPER_PER_K,
    pole_pairs: 6,
    iron_s: 0.0,
    inertia_kg_m2: 0.04,
    viscous_nm_s_per_rad: 0.0,
    coulomb_nm: 0.0,
};
const PARAMS: FocParams = FocParams {
    bandwidth_rad_s: 2000.0,
    current_limit_a: 450.0,
    torque_limit_nm: 250.0,
    voltage_share: 0.95,
};

struct Rig {
    foc: Foc,
    machine: Pmsm,
    state: (FocState, PmsmState),
    winding_c: Real,
}

impl Rig {
    fn new(params: FocParams, believed: PmsmParams, real: PmsmParams, dt_s: Real) -> Self {
        let dt = Dt::from_s(dt_s).unwrap();
        let (foc, machine) =
            (Foc::new(params, believed, dt).unwrap(), Pmsm::new(real, dt).unwrap());
        Self { foc, machine, state: Default::default(), winding_c: 25.0 }
    }

    /// One step on an imposed speed.
    fn step(&mut self, torque_nm: Real, speed_rad_s: Real) -> (FocOutput, PmsmOutput) {
        let (foc, machine) = &mut self.state;
        let input =
            FocInput { torque_nm, current_a: machine.current_a(), speed_rad_s, bus_v: 360.0 };
        let control = self.foc.step(foc, input);
        let input =
            PmsmSpeedInput { voltage_v: control.voltage_v, speed_rad_s, winding_c: self.winding_c };
        (control, self.machine.step_at_speed(machine, input))
    }

    fn run(&mut self, steps: u32, torque_nm: Real, speed_rad_s: Real) -> (FocOutput, PmsmOutput) {
        let mut out = self.step(torque_nm, speed_rad_s);
        for _ in 1..steps {
            out = self.step(torque_nm, speed_rad_s);
        }
        out
    }
}

fn near(a: Real, b: Real, within: Real) {
    assert!((a - b).abs() <= within, "{a} against {b}");
}

#[test]
fn currents_approach_as_one_lag_in_both_axes() {
    for speed in [0.0, 300.0, -300.0] {
        let mut rig = Rig::new(PARAMS, MACHINE, MACHINE, 1e-4);
        rig.run(1000, 0.0, speed);
        let mut last = rig.state.1.current_a();
        for _ in 0..30 {
            let (control, out) = rig.step(50.0, speed);
            assert!(!control.saturated && !control.limited && !control.rejected);
            let (target, k) = (control.reference_a, lag_gain(0.2));
            near(out.current_a.d, last.d + k * (target.d - last.d), 0.01);
            near(out.current_a.q, last.q + k * (target.q - last.q), 0.01);
            last = out.current_a;
        }
        near(rig.run(100, 50.0, speed).1.torque_nm, 50.0, 0.05);
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn an_ideal_loop_is_there_after_one_step_however_far_the_rotor_turns() {
    let ideal = FocParams { bandwidth_rad_s: Real::INFINITY, ..PARAMS };
    for (dt_s, speed) in [(1e-5, 100.0), (1e-3, 100.0), (1e-3, 1194.0), (1e-2, 1194.0)] {
        let mut rig = Rig::new(ideal, MACHINE, MACHINE, dt_s);
        let settled = rig.run(2000, 10.0, speed);
        near(settled.1.torque_nm, 10.0, 0.05);
        let (control, _) = rig.step(11.0, speed);
        let out = rig.step(11.0, speed).1;
        assert!(!control.rejected);
        near(out.torque_nm, 11.0, 0.1);
        assert_eq!(out.coarse_step, 6.0 * speed * dt_s > 0.1);
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn it_holds_the_circle_and_the_current_above_base_speed() {
    let mut rig = Rig::new(PARAMS, MACHINE, MACHINE, 1e-4);
    let mut last_nm = 250.0;
    for n in 1..=12_u16 {
        let (control, out) = rig.run(2000, 250.0, 100.0 * Real::from(n));
        let longest = LARGEST_PER_BUS * 360.0;
        assert!(control.voltage_v.length() <= longest * 1.000_01);
        assert!(out.current_a.length() <= 450.0 * 1.001, "{out:?}");
        near(out.torque_nm, control.torque_nm, 0.3);
        assert!(out.torque_nm <= last_nm + 0.5, "{n}: {} {last_nm}", out.torque_nm);
        last_nm = out.torque_nm;
        if control.weakened {
            // Steady on the share of the circle.
            near(control.voltage_v.length(), 0.95 * longest, 0.01 * longest);
        }
        assert_eq!(control.limited, control.torque_nm < 249.99, "{n}: {control:?}");
    }
    assert!(last_nm > 50.0, "{last_nm}");
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn what_its_model_lacks_is_made_up_for() {
    let Flux::Linear(flux) = MACHINE.flux else { unreachable!() };
    let wrong = PmsmParams {
        flux: Flux::Linear(LinearFlux { magnet_wb: 0.045, d_h: 1.3e-4, q_h: 2.4e-4 }),
        resistance_ohm: 5e-3,
        ..MACHINE
    };
    for (winding_c, speed) in [(25.0, 50.0), (150.0, 50.0), (150.0, 600.0)] {
        let mut rig = Rig::new(PARAMS, wrong, MACHINE, 1e-4);
        rig.winding_c = winding_c;
        let (control, out) = rig.run(5000, 40.0, speed);
        near(out.current_a.d, control.reference_a.d, 0.05);
        near(out.current_a.q, control.reference_a.q, 0.05);
        assert!(rig.state.0.lacking_v().length() > 0.1 && flux.magnet_wb == 0.05);
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_saturated_second_leaves_no_trace() {
    // A torque that this bus cannot give: the voltage saturates on the way; then none at all.
    let greedy = FocParams { voltage_share: 1.0, torque_limit_nm: Real::INFINITY, ..PARAMS };
    let mut rig = Rig::new(greedy, MACHINE, MACHINE, 1e-4);
    let mut saturated = 0;
    for n in 0..10_000_u16 {
        let torque_nm = if n % 20 < 10 { 300.0 } else { -300.0 };
        saturated += u32::from(rig.step(torque_nm, 500.0).0.saturated);
    }
    assert!(saturated > 300, "{saturated}");
    assert!(rig.state.0.lacking_v().length() < 0.05, "{:?}", rig.state.0);
    let (control, _) = rig.step(0.0, 500.0);
    let target = control.reference_a;
    let (_, out) = rig.run(60, 0.0, 500.0);
    near(out.current_a.q, target.q, 2.0);
}

/// Phase currents in, duties out, as in firmware: the same as in the frame of the rotor.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn through_three_phases_and_an_inverter_it_is_the_same() {
    let (mut direct, mut rig) =
        (Rig::new(PARAMS, MACHINE, MACHINE, 1e-4), Rig::new(PARAMS, MACHINE, MACHINE, 1e-4));
    let mut turns = 0.3;
    for _ in 0..2000 {
        turns = wrap_turns(turns + 6.0 * 300.0 * 1e-4 / (2.0 * PI));
        let rotor = RotorAngle::of_turns(turns);
        let (_, exact) = direct.step(120.0, 300.0);
        let (foc, machine) = &mut rig.state;
        let phases_a = machine.current_a().to_stator(rotor).to_phases();
        let input = FocInput {
            torque_nm: 120.0,
            current_a: phases_a.to_vector().to_rotor(rotor),
            speed_rad_s: 300.0,
            bus_v: 360.0,
        };
        let asked_v = rig.foc.step(foc, input).voltage_v.to_stator(rotor);
        let (made_v, bus_a) = averaged_inverter(duties(asked_v, 360.0), 360.0, phases_a);
        let voltage_v = made_v.to_rotor(rotor);
        let taken_w = 1.5 * voltage_v.dot(machine.current_a());
        near(360.0 * bus_a, taken_w, 2.0);
        let input = PmsmSpeedInput { voltage_v, speed_rad_s: 300.0, winding_c: 25.0 };
        let out = rig.machine.step_at_speed(machine, input);
        near(out.torque_nm, exact.torque_nm, 0.1);
    }
}

#[test]
fn bad_input_changes_nothing() {
    let mut rig = Rig::new(PARAMS, MACHINE, MACHINE, 1e-4);
    rig.run(20, 50.0, 100.0);
    let before = rig.state.0;
    let good = FocInput { torque_nm: 1.0, current_a: Dq::ZERO, speed_rad_s: 1.0, bus_v: 300.0 };
    for bad in [Real::NAN, Real::INFINITY, -1e38] {
        for input in [
            FocInput { torque_nm: bad, ..good },
            FocInput { current_a: Dq { d: bad, q: 0.0 }, ..good },
            FocInput { current_a: Dq { d: 0.0, q: bad }, ..good },
            FocInput { speed_rad_s: bad, ..good },
            FocInput { bus_v: bad, ..good },
        ] {
            let out = rig.foc.step(&mut rig.state.0, input);
            assert!(out.rejected && rig.state.0 == before && out.voltage_v == Dq::ZERO);
        }
    }
    // No bus, no voltage.
    let out = rig.foc.step(&mut rig.state.0, FocInput { bus_v: 0.0, ..good });
    assert!(!out.rejected && out.voltage_v == Dq::ZERO, "{out:?}");
}
