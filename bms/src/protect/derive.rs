//! How each row follows from the description of the pack. The numbers that are chosen and not
//! derived stand here, each with its reason.

use plant_core::Real;
use plant_core::num::{max, min};

use super::debounce::Debounce;
use super::id::{Flow, Id, Level, Side, Source};
use super::row::{Clear, Pace, Reaction, Row};
use super::sheet::{CellSheet, PackSheet};
use crate::estimate::power::TemperatureWindow;

/// A current beyond its safety limit trips within this \[s\].
pub const CURRENT_BUDGET_S: Real = 0.02;
/// So does a voltage.
pub const VOLTAGE_BUDGET_S: Real = 0.1;
/// So does a temperature.
pub const TEMPERATURE_BUDGET_S: Real = 1.0;
/// Data that do not come trip within this of the last that came; where the sensor's own period is
/// longer than a fifth of it, within this of the moment they are overdue.
pub const STALE_BUDGET_S: Real = 0.1;

/// A row that heals has been good for this long \[s\]. Chosen: longer than a pulse of a driver.
const HEAL_S: Real = 1.0;
/// What is not dangerous at once may last this long before power is taken \[s\]. Chosen: a rest
/// between two pulses shows whether it was one.
const PATIENCE_S: Real = 10.0;
/// Two sensors of one quantity may differ this long \[s\]. Chosen: longer than their lags.
pub(super) const AGREE_S: Real = 0.5;
/// Samples of what may not wait for a time: the fewest that are not one.
const AT_ONCE: u16 = 2;
/// Share of the voltage window beyond which cells are apart, or a model is off: at a mean slope,
/// a tenth of the charge.
const APART: Real = 0.1;
/// Beyond this, sensors of one pack are apart \[K\]. Chosen: cells in one coolant differ by less
/// than 10 K.
const APART_K: Real = 15.0;
/// A reading that moves more than this under the test current hangs on no wire \[V\]. Chosen: what
/// front-end chips state.
const OPEN_WIRE_V: Real = 0.4;
/// Insulation \[Ω/V\] \[Iso6469\]: 500 with alternating current, 100 with direct current alone.
const INSULATION: [Real; 3] = [500.0, 300.0, 100.0];
/// Heaters and coolant warm cells up by less \[K/s\]. Chosen: some times the degree a minute that
/// packs are heated with.
const HEATED_K_PER_S: Real = 0.1;
/// Time over which warming up is measured \[s\].
pub(super) const RATE_S: Real = 10.0;

/// Whole ticks in a time.
const fn ticks(sheet: &PackSheet, time_s: Real) -> u16 {
    let n = time_s / sheet.tick_s + 0.01;
    if n < 60_000.0 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "just checked")]
        let n = n as u16;
        n
    } else {
        60_000
    }
}

/// Judgements in a time, less the one that a sweep may take until it has come round.
const fn judgements(sheet: &PackSheet, pace: Pace, time_s: Real) -> u16 {
    let n = ticks(sheet, time_s);
    match pace {
        Pace::Tick => n,
        Pace::Sweep => (n / sheet.turns()).saturating_sub(1),
    }
}

/// A row that trips within `budget_s`, and `delay_s` later.
#[derive(Clone, Copy)]
struct Timing {
    pace: Pace,
    count: u16,
    delay_s: Real,
}

impl Timing {
    const fn within(sheet: &PackSheet, pace: Pace, budget_s: Real) -> Self {
        Self { pace, count: judgements(sheet, pace, budget_s), delay_s: 0.0 }
    }

    const fn at_once(pace: Pace) -> Self {
        Self { pace, count: AT_ONCE, delay_s: 0.0 }
    }

    const fn later(self, delay_s: Real) -> Self {
        Self { delay_s, ..self }
    }
}

/// What follows a trip.
type Then = (Level, Reaction, Clear);

const fn made(
    sheet: &PackSheet,
    id: Id,
    (threshold, hysteresis): (Real, Real),
    timing: Timing,
    (level, reaction, clear): Then,
) -> Row {
    let slot = match timing.pace {
        Pace::Tick => 1,
        Pace::Sweep => sheet.turns(),
    };
    let heal = ticks(sheet, HEAL_S) / slot;
    let missing = match id {
        // What is watched is whether it comes.
        Id::Stale(_) | Id::Insulation(Level::Mol) => 1,
        _ => 0,
    };
    Row {
        id,
        level,
        threshold,
        hysteresis,
        pace: timing.pace,
        debounce: Debounce {
            count: timing.count,
            delay: ticks(sheet, timing.delay_s) / slot,
            heal,
            missing,
        },
        clear,
        reaction,
    }
}

/// A row for what is so or not.
const fn flag(sheet: &PackSheet, id: Id, timing: Timing, then: Then) -> Row {
    made(sheet, id, (0.5, 0.0), timing, then)
}

/// What the three levels lead to: MOL is written down, RSL takes back power, MSL opens.
const fn by_level(level: Level) -> Then {
    match level {
        Level::Mol => (level, Reaction::Log, Clear::No),
        Level::Rsl => (level, Reaction::Derate, Clear::No),
        Level::Msl => (level, Reaction::Hard, Clear::Reset),
    }
}

/// The three limits: that of operation, that of safety, and one between.
const fn limit(level: Level, mol: Real, msl: Real) -> Real {
    match level {
        Level::Mol => mol,
        Level::Rsl => 0.5 * (mol + msl),
        Level::Msl => msl,
    }
}

const WARNS: Then = (Level::Mol, Reaction::Log, Clear::No);
const DERATES: Then = (Level::Rsl, Reaction::Derate, Clear::No);
const ENDS: Then = (Level::Rsl, Reaction::Soft, Clear::No);
const ENDS_AND_LATCHES: Then = (Level::Rsl, Reaction::Soft, Clear::Reset);
const OPENS: Then = (Level::Msl, Reaction::Hard, Clear::Reset);
const LOCKS: Then = (Level::Msl, Reaction::Hard, Clear::Service);

/// The row of one id.
pub(super) const fn derived(sheet: &PackSheet, id: Id) -> Row {
    let cell = &sheet.cell;
    let at_once = Timing::at_once(Pace::Tick);
    let next_sweep = Timing::at_once(Pace::Sweep);
    let patient = next_sweep.later(PATIENCE_S);
    match id {
        Id::CellVoltage(..) | Id::DeepDischarge | Id::PackVoltage(_) => voltage(sheet, id),
        Id::Temperature(flow, side, level) => temperature(sheet, id, flow, side, level),
        Id::Current(flow, _) | Id::Surge(flow) | Id::Heat(flow) => current(sheet, id, flow),
        Id::CurrentWhileOpen | Id::ShortCircuit | Id::CurrentsDiffer => {
            current(sheet, id, Flow::Discharge)
        }
        Id::CellSum | Id::LinkDiffers => differing_voltage(sheet, id),
        Id::Stale(source) => stale(sheet, id, source),
        Id::Range(source) => out_of_range(sheet, id, source),

        Id::Residual | Id::Imbalance => {
            let window_v = cell.voltage.operating_max_v - cell.voltage.operating_min_v;
            let share = (APART * window_v, sheet.sensing.cell_v.hysteresis());
            made(sheet, id, share, patient, DERATES)
        }
        Id::TemperatureSpread => {
            let apart = (APART_K, sheet.sensing.temperature_c.hysteresis());
            made(sheet, id, apart, patient, DERATES)
        }
        Id::TemperatureRate => {
            // What the current cannot explain.
            let noise = sheet.sensing.temperature_c.hysteresis() / RATE_S;
            let threshold = HEATED_K_PER_S + 2.0 * noise;
            let timing = Timing::within(sheet, Pace::Sweep, TEMPERATURE_BUDGET_S);
            made(
                sheet,
                id,
                (threshold, noise),
                timing,
                (Level::Msl, Reaction::Soft, Clear::Service),
            )
        }
        Id::OpenWire => {
            made(sheet, id, (OPEN_WIRE_V, 0.25 * OPEN_WIRE_V), next_sweep, ENDS_AND_LATCHES)
        }
        Id::Insulation(level) => {
            let [mol, rsl, msl] = INSULATION;
            let threshold = match level {
                Level::Mol => mol,
                Level::Rsl => rsl,
                Level::Msl => msl,
            };
            // While it drives it is safer to go on; what is latched does not close again.
            let then = match level {
                Level::Mol => WARNS,
                Level::Rsl => DERATES,
                Level::Msl => (Level::Msl, Reaction::Derate, Clear::Reset),
            };
            let timing = Timing::within(sheet, Pace::Sweep, TEMPERATURE_BUDGET_S);
            made(sheet, id, (threshold, 0.1 * threshold), timing, then)
        }
        Id::LateStep => made(sheet, id, (2.0, 0.5), at_once, ENDS),

        Id::StuckCell | Id::StuckCurrent | Id::CellCount => {
            flag(sheet, id, next_sweep, ENDS_AND_LATCHES)
        }
        Id::Interlock => {
            let timing = Timing::within(sheet, Pace::Tick, VOLTAGE_BUDGET_S);
            flag(sheet, id, timing, ENDS_AND_LATCHES)
        }
        Id::Crash => flag(sheet, id, at_once, (Level::Msl, Reaction::Crash, Clear::Service)),
        Id::Pin | Id::Supply => flag(sheet, id, at_once, ENDS_AND_LATCHES),
        Id::RequestLost | Id::RequestCorrupt | Id::ChargerLost => flag(sheet, id, at_once, ENDS),
        Id::Parameters => flag(sheet, id, at_once, (Level::Msl, Reaction::Soft, Clear::Service)),
        Id::StuckTemperature | Id::Coolant | Id::Estimator => flag(sheet, id, next_sweep, DERATES),
        // The state machine of the contactors reacts to these by itself.
        Id::Feedback(_) | Id::Weld(_) | Id::Bypassed | Id::Precharge(_) => {
            let once = Timing { count: 1, ..at_once };
            flag(sheet, id, once, (Level::Msl, Reaction::Log, Clear::No))
        }
        Id::Record | Id::LogStore | Id::BleedStuck | Id::BleedHot => {
            flag(sheet, id, next_sweep, WARNS)
        }
    }
}

/// How far a safety limit lies within the absolute one: what the sensor may be off, and what the
/// quantity moves until the contactors are open.
const fn margin(sheet: &PackSheet, error: Real, rate_per_s: Real, budget_s: Real) -> Real {
    let until_open_s = budget_s + sheet.actuators.wait_s + sheet.actuators.open_s;
    3.0 * error + rate_per_s * until_open_s
}

const fn voltage(sheet: &PackSheet, id: Id) -> Row {
    let (v, series) = (&sheet.cell.voltage, sheet.layout.series as Real);
    let sensor = &sheet.sensing.cell_v;
    let margin_v = margin(sheet, sensor.error, sheet.cell.worst_v_per_s(), VOLTAGE_BUDGET_S);
    let (low_v, high_v) = (v.absolute_min_v + margin_v, v.absolute_max_v - margin_v);
    let sweep = Timing::within(sheet, Pace::Sweep, VOLTAGE_BUDGET_S);
    match id {
        Id::CellVoltage(side, level) => {
            let threshold = match side {
                Side::Low => limit(level, v.operating_min_v, low_v),
                Side::High => limit(level, v.operating_max_v, high_v),
            };
            made(sheet, id, (threshold, sensor.hysteresis()), sweep, by_level(level))
        }
        Id::PackVoltage(side) => {
            let pack = &sheet.sensing.pack_v;
            let threshold = match side {
                Side::Low => series * low_v - pack.error,
                Side::High => series * high_v + pack.error,
            };
            let timing = Timing::within(sheet, Pace::Tick, VOLTAGE_BUDGET_S);
            made(sheet, id, (threshold, pack.hysteresis()), timing, OPENS)
        }
        _ => made(sheet, id, (v.deep_v, sensor.hysteresis()), sweep, LOCKS),
    }
}

const fn differing_voltage(sheet: &PackSheet, id: Id) -> Row {
    let (sensing, series) = (&sheet.sensing, sheet.layout.series as Real);
    let hysteresis = sensing.pack_v.hysteresis();
    let (errors, timing) = if matches!(id, Id::CellSum) {
        let errors = series * sensing.cell_v.error + sensing.pack_v.error;
        (errors, Timing::at_once(Pace::Sweep))
    } else {
        // Closed contactors drop next to nothing.
        (sensing.link_v.error + sensing.pack_v.error, Timing::at_once(Pace::Tick))
    };
    let limit = (errors + 2.0 * hysteresis, hysteresis);
    made(sheet, id, limit, timing.later(AGREE_S), ENDS_AND_LATCHES)
}

const fn temperature(sheet: &PackSheet, id: Id, flow: Flow, side: Side, level: Level) -> Row {
    let sensor = &sheet.sensing.temperature_c;
    let window: &TemperatureWindow = match flow {
        Flow::Discharge => &sheet.cell.discharge_window,
        Flow::Charge => &sheet.cell.charge_window,
    };
    let warming = sheet.cell.worst_k_per_s();
    let threshold = match side {
        // Its own current cools no cell.
        Side::Low => limit(
            level,
            window.all_from_c,
            window.none_below_c + margin(sheet, sensor.error, 0.0, TEMPERATURE_BUDGET_S),
        ),
        Side::High => limit(
            level,
            window.all_to_c,
            window.none_above_c - margin(sheet, sensor.error, warming, TEMPERATURE_BUDGET_S),
        ),
    };
    let timing = Timing::within(sheet, Pace::Sweep, TEMPERATURE_BUDGET_S);
    made(sheet, id, (threshold, sensor.hysteresis()), timing, by_level(level))
}

const fn current(sheet: &PackSheet, id: Id, flow: Flow) -> Row {
    let (sensor, parallel) = (&sheet.sensing.current_a, sheet.layout.parallel as Real);
    let cell: &CellSheet = &sheet.cell;
    let currents = match flow {
        Flow::Discharge => &cell.discharge,
        Flow::Charge => &cell.charge,
    };
    let (continuous_a, short_a) =
        (parallel * currents.continuous_a, parallel * currents.ten_seconds_a);
    let hysteresis = sensor.hysteresis();
    let within = Timing::within(sheet, Pace::Tick, CURRENT_BUDGET_S);
    let at_once = Timing::at_once(Pace::Tick);
    let shown_a = min(sensor.highest, -sensor.lowest);
    match id {
        Id::Current(_, level) => {
            let threshold = match level {
                Level::Mol => continuous_a,
                Level::Rsl => short_a + sensor.error,
                // A tenth more, or as much as the sensor can tell apart.
                Level::Msl => {
                    short_a + sensor.error + max(0.1 * short_a, 2.0 * (sensor.error + hysteresis))
                }
            };
            made(sheet, id, (threshold, hysteresis), within, by_level(level))
        }
        Id::Surge(_) => {
            made(sheet, id, (min(2.0 * short_a, 0.9 * shown_a), hysteresis), at_once, OPENS)
        }
        Id::Heat(_) => {
            // Ten seconds at the ten-second current; the sensor's error counts for the battery.
            let over = 10.0 * (short_a * short_a - continuous_a * continuous_a);
            made(sheet, id, (over, 0.1 * over), at_once, ENDS)
        }
        Id::CurrentWhileOpen => {
            let timing = Timing::within(sheet, Pace::Tick, VOLTAGE_BUDGET_S).later(AGREE_S);
            made(sheet, id, (sensor.error + hysteresis, hysteresis), timing, ENDS_AND_LATCHES)
        }
        Id::ShortCircuit => made(sheet, id, (0.95 * shown_a, hysteresis), at_once, LOCKS),
        _ => {
            let apart = 2.0 * sensor.error + hysteresis;
            made(sheet, id, (apart, hysteresis), at_once.later(AGREE_S), ENDS_AND_LATCHES)
        }
    }
}

const fn paced(source: Source) -> Pace {
    match source {
        Source::Cell | Source::Temperature => Pace::Sweep,
        Source::Current | Source::Pack | Source::Link => Pace::Tick,
    }
}

/// Without the pack's or the link's voltage a closed pack may go on: the cells are seen.
const fn without(source: Source) -> Then {
    match source {
        Source::Cell | Source::Temperature | Source::Current => ENDS,
        Source::Pack | Source::Link => DERATES,
    }
}

const fn stale(sheet: &PackSheet, id: Id, source: Source) -> Row {
    let sensing = &sheet.sensing;
    let sensor = match source {
        Source::Cell => &sensing.cell_v,
        Source::Temperature => &sensing.temperature_c,
        Source::Current => &sensing.current_a,
        Source::Pack => &sensing.pack_v,
        Source::Link => &sensing.link_v,
    };
    let pace = paced(source);
    let left_s = max(0.0, STALE_BUDGET_S - sensor.oldest_s(sheet.tick_s));
    let count = judgements(sheet, pace, left_s);
    let count = if count > AT_ONCE { count } else { AT_ONCE };
    flag(sheet, id, Timing { pace, count, delay_s: 0.0 }, without(source))
}

const fn out_of_range(sheet: &PackSheet, id: Id, source: Source) -> Row {
    let pace = paced(source);
    let timing = Timing::within(sheet, pace, STALE_BUDGET_S);
    flag(sheet, id, timing, without(source))
}
