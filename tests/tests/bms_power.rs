//! The currents and powers that the state of power allows, tried on the plant.

#![allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, clippy::cast_sign_loss)]

use plant_core::battery::{MappedBattery, MappedBatteryParams, MappedBatteryState};
use plant_core::port::Source;
use plant_core::presets::{BMW_I3_60AH_PACK, PANASONIC_NCR18650PF};
use voltstep_bms::estimate::power::{
    Allowance, BoundBy, HORIZONS_S, PowerLimits, PowerParams, TemperatureWindow,
};
use voltstep_bms::{Accum, Dt, Estimate, Health};

/// How far the voltage may go beyond its limit \[V per cell\].
const BEYOND_V: f32 = 0.010;
/// What is allowed, of the largest constant current that the plant stands.
const SHARE: f32 = 0.95;
/// Steps of the plant \[s\].
const DT_S: f32 = 0.05;

const ANY: TemperatureWindow = TemperatureWindow {
    none_below_c: -40.0,
    all_from_c: -30.0,
    all_to_c: 80.0,
    none_above_c: 90.0,
};

/// Even numbers in 0..1, the same every time.
struct Dice(u32);

impl Dice {
    fn roll(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / 16_777_216.0
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.roll()
    }
}

struct Pack {
    plant: MappedBattery,
    cells: f32,
    params: PowerParams,
}

impl Pack {
    fn new(params: MappedBatteryParams, cells: f32, (low_v, high_v): (f32, f32)) -> Self {
        Self {
            plant: MappedBattery::new(params, Dt::from_s(DT_S).unwrap()).unwrap(),
            cells,
            params: PowerParams {
                voltage_min_v: low_v * cells,
                voltage_max_v: high_v * cells,
                soc_min: 0.0,
                soc_max: 1.0,
                margin_sds: 0.0,
                horizons_s: HORIZONS_S,
                discharge_window: ANY,
                charge_window: ANY,
            },
        }
    }

    /// Some state that driving or charging has led to.
    fn some_state(&self, dice: &mut Dice) -> MappedBatteryState {
        let celsius = dice.between(-10.0, 40.0);
        let fresh = self.plant.rested_at(dice.between(0.05, 1.0), celsius).unwrap();
        let mut state = fresh;
        let known = self.plant.params();
        let current_a = match dice.between(0.0, 3.0) as u32 {
            0 => 0.0,
            1 => dice.between(0.0, 0.3 * known.discharge_limit_a),
            _ => -dice.between(0.0, 0.3 * known.charge_limit_a),
        };
        for _ in 0..dice.between(0.0, 4000.0) as u32 {
            self.plant.settle(&mut state, current_a);
            // Not further than the voltage may go.
            let over_v = state.polarisation_v[0].get() + state.polarisation_v[1].get();
            if over_v.abs() > 0.15 * self.cells {
                break;
            }
        }
        let mut polarised = fresh;
        polarised.polarisation_v = state.polarisation_v;
        polarised
    }

    /// How much room constant current, or power, leaves to the closest limit over `seconds`:
    /// in V per cell, and in the state of charge.
    fn room(&self, state: MappedBatteryState, seconds: f32, load: Load) -> (f32, f32) {
        let mut state = state;
        let (mut room_v, mut room_soc) = (f32::MAX, f32::MAX);
        for _ in 0..(seconds / DT_S).round() as u32 {
            let (source, _) = self.plant.offer(&state);
            let current_a = match load {
                Load::Current(current_a) => current_a,
                Load::Power(power_w) => current_for_power_a(source, power_w),
            };
            let voltage_v = source.voltage_v(current_a);
            self.plant.settle(&mut state, current_a);
            self.plant.refresh(&mut state);
            let (low, high) = (self.params.voltage_min_v, self.params.voltage_max_v);
            let room = if current_a > 0.0 { voltage_v - low } else { high - voltage_v };
            room_v = room_v.min(room / self.cells);
        }
        let soc = state.soc.get();
        room_soc = room_soc.min(soc).min(1.0 - soc);
        (room_v, room_soc)
    }

    /// The largest constant current that the plant stands, by bisection.
    fn largest_a(&self, state: MappedBatteryState, seconds: f32, sign: f32) -> f32 {
        let known = self.plant.params();
        let (limit_a, room) = if sign > 0.0 {
            (known.discharge_limit_a, state.soc.get())
        } else {
            (known.charge_limit_a, 1.0 - state.soc.get())
        };
        let top_a = limit_a.min(room * 3600.0 * known.capacity_ah / seconds);
        let stands = |a: f32| self.room(state, seconds, Load::Current(sign * a)).0 >= 0.0;
        if stands(top_a) {
            return top_a;
        }
        let (mut low, mut high) = (0.0, top_a);
        for _ in 0..16 {
            let middle = 0.5 * (low + high);
            if stands(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }
}

/// The current at which a source gives a power; the largest power's where it cannot.
fn current_for_power_a(source: Source, power_w: f32) -> f32 {
    let root =
        (source.emf_v * source.emf_v - 4.0 * source.resistance_ohm * power_w).max(0.0).sqrt();
    2.0 * power_w / (source.emf_v + root)
}

#[derive(Clone, Copy)]
enum Load {
    Current(f32),
    Power(f32),
}

/// What the estimator says when it is right.
fn truth(state: &MappedBatteryState) -> Estimate {
    Estimate {
        soc: state.soc.get(),
        soc_sd: 0.01,
        polarisation_v: state.polarisation_v.map(Accum::get),
        hysteresis: state.hysteresis.get(),
        offset_v: 0.0,
        temperature_c: state.temperature_c.get(),
    }
}

/// The worst of many states.
#[derive(Debug)]
struct Worst {
    beyond_v: f32,
    beyond_at_power_v: f32,
    share: f32,
    bound_by_voltage: u32,
    cases: u32,
}

fn try_out(pack: &Pack, states: u32, horizon: usize, sign: f32, dice: &mut Dice) -> Worst {
    let limits = PowerLimits::new(pack.params, &pack.plant).unwrap();
    let health = Health::as_new(&pack.plant);
    let mut worst = Worst {
        beyond_v: f32::MIN,
        beyond_at_power_v: f32::MIN,
        share: 1.0,
        bound_by_voltage: 0,
        cases: 0,
    };
    for _ in 0..states {
        let state = pack.some_state(dice);
        let ahead = limits.ahead(&truth(&state), &health)[horizon];
        let Allowance { current_a, power_w, bound_by, .. } =
            if sign > 0.0 { ahead.discharge } else { ahead.charge };
        let largest_a = pack.largest_a(state, ahead.horizon_s, sign);
        worst.cases += 1;
        worst.bound_by_voltage += u32::from(bound_by == BoundBy::Voltage);
        if current_a > 0.0 {
            let seconds = ahead.horizon_s;
            let (room_v, room_soc) = pack.room(state, seconds, Load::Current(sign * current_a));
            worst.beyond_v = worst.beyond_v.max(-room_v);
            assert!(room_soc >= -1e-5, "{room_soc}");
            let (room_v, _) = pack.room(state, seconds, Load::Power(sign * power_w));
            worst.beyond_at_power_v = worst.beyond_at_power_v.max(-room_v);
        }
        // Below a twentieth of an hour's current there is so little room that what relaxes in the
        // plant's first step, 0.3 mV, counts.
        if largest_a > 0.05 * pack.plant.params().capacity_ah {
            worst.share = worst.share.min(current_a / largest_a);
        }
    }
    worst
}

fn check(pack: &Pack, states: u32) {
    let mut dice = Dice(1);
    for (horizon, seconds) in HORIZONS_S.iter().enumerate() {
        for sign in [1.0, -1.0] {
            let worst = try_out(pack, states, horizon, sign, &mut dice);
            let named = format!("{seconds} s, {sign:+}: {worst:?}");
            println!("{named}");
            assert!(worst.beyond_v <= BEYOND_V && worst.beyond_at_power_v <= BEYOND_V, "{named}");
            assert!(worst.share >= SHARE, "{named}");
            assert!(worst.bound_by_voltage > states / 20, "{named}");
        }
    }
}

#[test]
fn a_cell_keeps_its_limits_and_gives_nearly_all_it_can() {
    check(&Pack::new(PANASONIC_NCR18650PF, 1.0, (2.5, 4.2)), 500);
}

#[test]
fn a_pack_keeps_its_limits_and_gives_nearly_all_it_can() {
    check(&Pack::new(BMW_I3_60AH_PACK, 96.0, (3.0, 4.15)), 300);
}
