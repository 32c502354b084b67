use super::sets::UDDS;
use super::*;

const DC: Drive = Drive {
    machine: Machine::Dc { r: 0.025, l: 1e-3, ke: 1.4, kt: 1.4 },
    j: 3.87e-7,
    bm: 4.21e-6,
    gear: 1.0,
    gear_loss: 0.0,
    rate: 500.0,
};
const PMSM: Drive = Drive {
    machine: Machine::Pmsm { r: 0.02, ld: 2e-4, lq: 4e-4, magnet: 0.08, pairs: 4.0, iron: 1e-3 },
    j: 0.03,
    bm: 1e-3,
    gear: 6.0,
    gear_loss: 0.0,
    rate: 500.0,
};

/// The vehicle of UDDS with other drives.
fn vehicle(drives: &'static [Drive]) -> Description {
    Description { drives, controller: None, ..UDDS }
}

fn only(drive: Drive) -> &'static [Drive] {
    Box::leak(Box::new([drive]))
}

/// A battery whose voltage nothing moves.
fn stiff(drives: &'static [Drive]) -> Description {
    Description { rs: 0.0, rp: 0.0, v_empty: 400.0, v_full: 400.0, ..vehicle(drives) }
}

fn run(reference: &mut ComposedReference, y: &mut State, command: &Command, until_s: f64) {
    let clock = &mut Clock::never();
    reference.advance(y, command, (0.0, until_s), 1e-11, clock, |_, _, _| {}).unwrap();
}

fn gates(first: Gates, second: Gates) -> [Gates; MOST] {
    [first, second, Gates::Off, Gates::Off]
}

#[track_caller]
fn near(a: f64, b: f64, relative: f64) {
    assert!((a - b).abs() <= relative * b.abs(), "{a} {b}: {:e}", (a / b - 1.0).abs());
}

#[test]
fn what_stands_still_rises_with_its_time_constant() {
    // A winding with L/R of 40 ms on 4 V; an ideal loop of 2 ms.
    for (gates, end_a, per_s) in
        [(Gates::Modulated([0.01, 0.0]), 160.0, 25.0), (Gates::Torque(140.0), 100.0, 500.0)]
    {
        let mut reference = ComposedReference::new(stiff(&[DC])).unwrap();
        let mut y = reference.rolling_at(0.0, 0.5);
        let command = Command { gates: [gates; MOST], brake: 1e6, ..Command::default() };
        let (mut worst, mut clock) = (0.0_f64, Clock::new(1e-3));
        let exact = |t: f64| end_a * (1.0 - (-t * per_s).exp());
        reference
            .advance(&mut y, &command, (0.0, 0.2), 1e-11, &mut clock, |t, y, _| {
                worst = worst.max((y[CURRENTS] - exact(t)).abs());
            })
            .unwrap();
        assert!(worst < 1e-8 * end_a && clock.taken == 200, "{worst}");
        assert_eq!(y[V], 0.0);
    }
}

/// The loop with the controller's smoothing as a state of its own.
struct Smoothed(ComposedReference);

const ALL: usize = STATES + 1;

fn head(y: &[f64; ALL]) -> State {
    std::array::from_fn(|i| y[i])
}

impl System<ALL> for Smoothed {
    fn slope(&self, t: f64, y: &[f64; ALL]) -> [f64; ALL] {
        let (state, duty) = (head(y), y[STATES]);
        let mut under = self.0.clone();
        under.command.gates[0] = Gates::Modulated([duty, 0.0]);
        let mut slope = [0.0; ALL];
        slope[..STATES].copy_from_slice(&under.slope(t, &state));
        let target = self.0.raw(&UDDS.controller.unwrap(), t, &state);
        slope[STATES] = 1e6 * (target - duty);
        slope
    }

    fn margin(&self, t: f64, y: &[f64; ALL]) -> f64 {
        self.0.margin(t, &head(y))
    }

    fn switch(&mut self, t: f64, y: &mut [f64; ALL]) {
        let mut state = head(y);
        self.0.switch(t, &mut state);
        y[..STATES].copy_from_slice(&state);
    }

    fn scale(&self) -> [f64; ALL] {
        let mut scale = [1e-2; ALL];
        scale[..STATES].copy_from_slice(&self.0.scale());
        scale
    }
}

#[test]
fn eliminating_the_smoothing_changes_nothing_that_is_compared() {
    let mut reduced = ComposedReference::new(UDDS).unwrap();
    let mut y = reduced.rolling_at(0.0, 0.8);
    let command = Command { gates: [Gates::ControlledDuty; MOST], rate: 1.5, ..Command::default() };
    let (mut speeds, mut worst) = (Vec::new(), 0.0_f64);
    reduced.command = command;
    let mut whole = Smoothed(reduced.clone());
    let mut z = [0.0; ALL];
    z[..STATES].copy_from_slice(&y);
    let span = (0.0, 1.0);
    reduced
        .advance(&mut y, &command, span, 1e-10, &mut Clock::new(0.01), |_, y, _| speeds.push(y[V]))
        .unwrap();
    let mut speeds = speeds.into_iter();
    integrate(&mut whole, &mut z, span, 1e-10, &mut Clock::new(0.01), |_, z, _| {
        worst = worst.max((z[V] - speeds.next().unwrap()).abs());
    })
    .unwrap();
    assert!(worst > 0.0 && worst < 1e-7, "{worst}");
    assert!((y[SOC] - z[SOC]).abs() < 1e-9);
}

#[test]
fn the_energy_balance_of_two_axles_closes() {
    const DRIVES: &[Drive] = &[DC, Drive { gear_loss: 0.03, ..PMSM }];
    let slow = Description { rp: 0.01, c: 500.0, load_s: 0.002, ..vehicle(DRIVES) };
    let mut reference = ComposedReference::new(slow).unwrap();
    let mut y = reference.rolling_at(3.0, 0.6);
    let (start, mut thrown) = (reference.stored(&y), 0.0);
    for (first, second, sin, until) in [
        (Gates::Modulated([0.03, 0.0]), Gates::Torque(60.0), 0.03, 4.0),
        (Gates::Torque(-150.0), Gates::Torque(80.0), -0.02, 3.0),
        (Gates::Torque(0.0), Gates::Volts([-3.0, 20.0]), 0.0, 0.5),
        (Gates::Torque(-400.0), Gates::Torque(-90.0), 0.0, 8.0),
    ] {
        let command = Command {
            gates: gates(first, second),
            sin,
            auxiliary_w: 500.0,
            brake: 100.0,
            ..Command::default()
        };
        let clock = &mut Clock::never();
        reference.advance(&mut y, &command, (0.0, until), 1e-12, clock, |_, _, _| {}).unwrap();
        thrown += reference.battery_a(until, &y).abs();
    }
    assert!(thrown > 50.0 && y[LOST] > 0.01, "{thrown} {y:?}");
    let balance = 3.6e6 * (y[ENERGY] - y[LOST]) - (reference.stored(&y) - start);
    assert!(balance.abs() < 1e-9 * 3.6e6 * y[LOST], "{balance} J of {}", 3.6e6 * y[LOST]);
}

/// Two axles share what a controller asks for.
#[test]
fn a_controller_of_torque_reaches_its_speed() {
    let controller =
        Controller { k: 800.0, i: 400.0, d: 0.0, min: -2e3, max: 2e3, smoothing: f64::INFINITY };
    let description = Description { controller: Some(controller), ..vehicle(&[DC, PMSM]) };
    let mut reference = ComposedReference::new(description).unwrap();
    let mut y = reference.rolling_at(0.0, 0.7);
    let gates = gates(Gates::ControlledTorque(0.6), Gates::ControlledTorque(0.1));
    let command = Command { gates, reference: 12.0, ..Command::default() };
    run(&mut reference, &mut y, &command, 60.0);
    near(y[V], 12.0, 1e-6);
    near(reference.torque(&y, 0), 6.0 * reference.torque(&y, 1), 1e-6);
    // Their forces carry air, tyres and friction.
    let w = [12.0 / 0.25, 6.0 * 12.0 / 0.25];
    let i = ComposedReference::currents(&y, 1);
    let rubbed = 4.21e-6 * w[0] / 0.25 + (1e-3 + PMSM.machine.iron(i)) * w[1] * 6.0 / 0.25;
    let needed = 0.5 * 1.2 * 0.29 * 2.2 * 144.0 + 0.009 * 1500.0 * G + rubbed;
    near((reference.torque(&y, 0) + 6.0 * reference.torque(&y, 1)) / 0.25, needed, 1e-6);
    // The battery's own voltage, and how far the converters go.
    let ocv = 500.0 + 100.0 * y[SOC];
    near(reference.battery_v(60.0, &y), ocv - 0.061 * reference.battery_a(60.0, &y), 1e-9);
    let back_emf = 1.4 * w[0] + 0.025 * ComposedReference::currents(&y, 0)[0];
    near(reference.used(60.0, &y, 0), back_emf / reference.battery_v(60.0, &y), 1e-6);
}

#[test]
fn a_synchronous_machine_settles_where_its_voltage_equation_does() {
    let mut reference = ComposedReference::new(stiff(&[PMSM])).unwrap();
    let mut y = reference.rolling_at(1.0, 0.5);
    let command =
        Command { gates: gates(Gates::Modulated([-0.04, 0.16]), Gates::Off), ..Command::default() };
    run(&mut reference, &mut y, &command, 600.0);
    let (w, [d, q]) = (6.0 / 0.25 * y[V], ComposedReference::currents(&y, 0));
    let turning = 4.0 * w;
    near(0.02 * d - turning * 4e-4 * q, -16.0, 1e-7);
    near(0.02 * q + turning * (2e-4 * d + 0.08), 64.0, 1e-7);
    let torque = 6.0 * ((2e-4 * d + 0.08) * q - 4e-4 * q * d);
    near(torque, reference.torque(&y, 0), 1e-12);
    let iron = 1.5e-3 * 16.0 * ((2e-4 * d + 0.08).powi(2) + (4e-4 * q).powi(2));
    let drag = 0.5 * 1.2 * 0.29 * 2.2 * y[V].powi(2) + 0.009 * 1500.0 * G;
    near((torque - (1e-3 + iron) * w) * 6.0 / 0.25, drag, 1e-6);
}

#[test]
fn the_least_current_for_a_torque_is_the_least() {
    let torque = |d: f64, q: f64| PMSM.machine.torque([d, q]);
    for asked in [-200.0, -20.0, 5.0, 120.0] {
        let [d, q] = (0..60).fold([0.0; 2], |i, _| PMSM.machine.aim(asked, i));
        near(torque(d, q), asked, 1e-12);
        // The same torque a little further along its hyperbola takes more.
        for more in [-0.5, 0.5] {
            let other = asked / (6.0 * (0.08 + (2e-4 - 4e-4) * (d + more)));
            assert!((d + more).hypot(other) > d.hypot(q), "{asked} {more}");
        }
    }
}

#[test]
fn diodes_block_below_the_bus_and_feed_it_above() {
    for (drive, share) in [(DC, 1.0), (Drive { machine: ROUND, ..PMSM }, 1.0 / 3.0_f64.sqrt())] {
        // So heavy that the speed stands while the currents settle.
        let heavy = Description { mass: 1e9, cr: 0.0, ..stiff(only(drive)) };
        let flux = drive.machine.axis().2 * drive.gear / 0.25;
        let base = share * 400.0 / flux;
        for (over, conducts) in [(0.99, false), (1.02, true), (1.3, true)] {
            let mut reference = ComposedReference::new(heavy).unwrap();
            let mut y = reference.rolling_at(over * base, 0.5);
            run(&mut reference, &mut y, &Command::default(), 1.0);
            let i = dot(ComposedReference::currents(&y, 0), ComposedReference::currents(&y, 0));
            let i = i.sqrt();
            assert_eq!(i > 0.0, conducts, "{over}: {i}");
            if !conducts {
                assert_eq!(reference.battery_a(1.0, &y), 0.0);
                continue;
            }
            // `e² = (V_d + R·i)² + (X·i)²`, without reactance of a DC machine.
            let (r, e, v) = (drive.machine.resistance(), flux * y[V], share * 400.0);
            let x = if share < 1.0 { 4.0 * drive.gear / 0.25 * y[V] * 3e-4 } else { 0.0 };
            near((v + r * i).hypot(x * i), e, 1e-6);
            near(reference.battery_a(1.0, &y), -drive.machine.phases() * share * i, 1e-12);
        }
    }
}

const ROUND: Machine =
    Machine::Pmsm { r: 0.02, ld: 3e-4, lq: 3e-4, magnet: 0.08, pairs: 4.0, iron: 0.0 };

#[test]
fn a_current_ends_when_gates_open() {
    for drive in [DC, Drive { machine: ROUND, ..PMSM }] {
        let mut reference = ComposedReference::new(vehicle(only(drive))).unwrap();
        let mut y = reference.rolling_at(5.0, 0.5);
        let on = Command { gates: gates(Gates::Torque(50.0), Gates::Off), ..Command::default() };
        run(&mut reference, &mut y, &on, 0.5);
        near(reference.torque(&y, 0), 50.0, 1e-9);
        let (soc, speed) = (y[SOC], y[V]);
        run(&mut reference, &mut y, &Command::default(), 0.5);
        assert_eq!(ComposedReference::currents(&y, 0), [0.0; 2]);
        // The field went back into the battery.
        assert!(y[SOC] > soc && y[V] < speed);
    }
}

#[test]
fn battery_limits_hold_in_both_directions() {
    for drive in [DC, Drive { machine: ROUND, ..PMSM }] {
        let mut reference = ComposedReference::new(vehicle(only(drive))).unwrap();
        let k = drive.gear / 0.25;
        for (newtons, from) in [(9000.0, 15.0), (-9000.0, 20.0)] {
            let mut y = reference.rolling_at(from, 0.5);
            let limits = Command {
                discharge_a: 100.0,
                charge_a: 60.0,
                auxiliary_w: 300.0,
                ..Command::default()
            };
            let command =
                Command { gates: gates(Gates::Torque(newtons / k), Gates::Off), ..limits };
            let (mut clock, mut least, mut most) = (Clock::new(1e-3), f64::INFINITY, -1e9_f64);
            reference
                .advance(&mut y, &command, (0.0, 2.0), 1e-10, &mut clock, |t, y, system| {
                    if t > 0.1 {
                        least = least.min(system.battery_a(t, y));
                        most = most.max(system.battery_a(t, y));
                    }
                })
                .unwrap();
            let limit = if newtons > 0.0 { 100.0 } else { -60.0 };
            // Discharge is held to the power itself; charge to that of the current held, while the
            // field grows by what the speed falls.
            let within = if newtons > 0.0 { 1e-6 } else { 2e-3 };
            near(least, limit, within);
            near(most, limit, within);
            // A lower limit: the current beyond decays.
            if newtons < 0.0 {
                let lower = Command { charge_a: 30.0, ..command };
                run(&mut reference, &mut y, &lower, 1.0);
                near(reference.battery_a(1.0, &y), -30.0, 2e-3);
                let released = Command { gates: gates(Gates::Torque(0.0), Gates::Off), ..lower };
                run(&mut reference, &mut y, &released, 1.0);
                assert!(reference.torque(&y, 0).abs() < 1e-6);
            }
        }
    }
}

#[test]
fn what_is_not_described_is_refused() {
    assert!(ComposedReference::new(vehicle(&[])).is_err());
    assert!(ComposedReference::new(vehicle(&[DC; MOST + 1])).is_err());
    let mut reference = ComposedReference::new(vehicle(&[DC, PMSM])).unwrap();
    let mut y = reference.rolling_at(1.0, 0.5);
    let command = Command { charge_a: 10.0, ..Command::default() };
    let clock = &mut Clock::never();
    let refused = reference.advance(&mut y, &command, (0.0, 1.0), 1e-9, clock, |_, _, _| {});
    assert!(refused.unwrap_err().to_string().contains("one drive"));
}
