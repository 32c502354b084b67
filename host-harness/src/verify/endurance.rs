//! `voltstep endurance`: ten years of a battery's operation, in steps of a second.
//!
//! Each day two drives of a synthetic profile, a charge to 80 % in the evening, rest in between. A
//! battery's state hangs on the one before, so the run is sequential.

use std::time::Instant;

use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};
use plant_core::battery::{Battery, BatteryInput, BatteryState};
use plant_core::{Dt, must, presets};
use serde::Serialize;

const DT: Dt = must!(Dt::from_s(1.0));
const DAY_S: usize = 86_400;
const DAYS_PER_YEAR: u32 = 365;
/// State of charge at the start, and what charging aims at.
const FULL: f32 = 0.8;
/// Charge current \[A\]: a wall box of 7 kW.
const CHARGE_A: f32 = 18.0;
/// Current at rest \[A\]: the electronics.
const REST_A: f32 = 0.02;
/// How far the charge balance may be off, relative to the charge that flowed.
const BALANCE: f64 = 1e-6;

/// What ten years came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Years of operation.
    pub years: u32,
    /// Steps of one second.
    pub steps: u64,
    /// Time spent \[s\].
    pub wall_s: f64,
    /// The same per step \[ns\].
    pub ns_per_step: f64,
    /// Charge that flowed, in either direction \[A·h\].
    pub throughput_ah: f64,
    /// Charge that left the battery, net, by adding up the current \[A·h\].
    pub net_ah: f64,
    /// The same by the state of charge \[A·h\].
    pub net_by_soc_ah: f64,
    /// What the two differ by, over the throughput.
    pub balance_rel: f64,
    /// How far the balance may be off.
    pub tolerance: f64,
    /// Lowest state of charge at the end of a day's drives.
    pub soc_min: f64,
    /// State of charge at the end.
    pub soc_final: f64,
    /// Charge that the battery refused \[A·h\].
    pub refused_ah: f64,
    /// Mean heat \[W\].
    pub heat_mean_w: f64,
    /// Whether the charge balances.
    pub pass: bool,
}

impl Report {
    /// Whether the charge balances.
    #[must_use]
    pub const fn is_good(&self) -> bool {
        self.pass
    }

    /// For a terminal.
    #[must_use]
    pub fn text(&self) -> String {
        format!(
            "{} years of a battery (open-circuit voltage, resistance, one RC branch) in {} steps \
             of 1 s: {:.1} s, {:.1} ns a step\n\
             charge moved {:.1} A·h, net {:.6} A·h; by the state of charge {:.6} A·h; \
             they differ by {:.1e} of the charge moved (at most {:.0e}): {}\n\
             state of charge: lowest {:.4}, at the end {:.6}; refused {:.3} A·h; \
             mean heat {:.2} W\n\
             for comparison: the source work quotes 288 s for ten years of a battery with ageing \
             by the fastest tool of its survey (Dymola); this battery does not age, a lighter job\n",
            self.years,
            self.steps,
            self.wall_s,
            self.ns_per_step,
            self.throughput_ah,
            self.net_ah,
            self.net_by_soc_ah,
            self.balance_rel,
            self.tolerance,
            if self.pass { "pass" } else { "FAIL" },
            self.soc_min,
            self.soc_final,
            self.refused_ah,
            self.heat_mean_w,
        )
    }

    /// The JSON text, with a line end.
    ///
    /// # Errors
    /// None that is known of.
    pub fn to_json(&self) -> anyhow::Result<String> {
        let mut text = serde_json::to_string_pretty(self).context("writing JSON")?;
        text.push('\n');
        Ok(text)
    }
}

/// The current of a day, second by second \[A\]: drives at 7:30 and at 17:00, else the electronics.
fn day() -> Vec<f32> {
    let mut day = vec![REST_A; DAY_S];
    for (start, length_s) in [(27_000, 1800), (61_200, 2100)] {
        let drive = day.iter_mut().skip(start).take(length_s);
        for (number, current) in (0_u16..).zip(drive) {
            // Accelerate, cruise, brake, stand: 80 s each time.
            *current = match number % 80 {
                0..12 => 110.0,
                12..55 => 24.0,
                55..65 => -45.0,
                _ => 1.5,
            };
        }
    }
    day
}

/// What a stretch of steps adds up to.
#[derive(Clone, Copy, Default)]
struct Sums {
    net_c: f64,
    moved_c: f64,
    refused_c: f64,
    heat_j: f64,
}

/// Runs `years` of operation.
///
/// # Errors
/// None that is known of.
pub fn run(years: u32, show_progress: bool) -> anyhow::Result<Report> {
    let days = years * DAYS_PER_YEAR;
    let bar = if show_progress {
        let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {eta} left")?;
        ProgressBar::new(u64::from(days)).with_style(style)
    } else {
        ProgressBar::hidden()
    };
    let params = presets::BMW_I3_60AH_CONSTANT.powertrain.battery;
    let battery = Battery::new(params, DT)?;
    let start = BatteryState::rested(FULL)?;
    let day = day();
    let mut state = start;
    let (mut sums, mut soc_min) = (Sums::default(), FULL);
    let started = Instant::now();
    for number in 0..days {
        one_day(&battery, &mut state, &day, &mut sums, &mut soc_min);
        if number % 64 == 0 {
            bar.set_position(u64::from(number));
        }
    }
    let wall_s = started.elapsed().as_secs_f64();
    bar.finish_and_clear();

    let steps = u64::from(days) * DAY_S as u64;
    let capacity_c = f64::from(params.capacity_ah) * 3600.0;
    let by_soc_c = f64::from(start.soc.since(state.soc)) * capacity_c;
    let balance_rel = (by_soc_c - sums.net_c).abs() / sums.moved_c;
    #[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
    let count = steps as f64;
    Ok(Report {
        years,
        steps,
        wall_s,
        ns_per_step: wall_s * 1e9 / count,
        throughput_ah: sums.moved_c / 3600.0,
        net_ah: sums.net_c / 3600.0,
        net_by_soc_ah: by_soc_c / 3600.0,
        balance_rel,
        tolerance: BALANCE,
        soc_min: f64::from(soc_min),
        soc_final: f64::from(state.soc.get()),
        refused_ah: sums.refused_c / 3600.0,
        heat_mean_w: sums.heat_j / count,
        pass: balance_rel <= BALANCE,
    })
}

/// One day: the profile, but charging from 22:00 until the battery is where it began.
fn one_day(
    battery: &Battery,
    state: &mut BatteryState,
    day: &[f32],
    sums: &mut Sums,
    soc_min: &mut f32,
) {
    const EVENING_S: usize = 79_200;
    let (driving, evening) = day.split_at(EVENING_S);
    let mut own = *state;
    for &current_a in driving {
        let out = battery.step(&mut own, BatteryInput { current_a });
        sums.add(out.current_a, out.refused_charge_c, out.heat_w);
    }
    *soc_min = soc_min.min(own.soc.get());
    for &rest_a in evening {
        let current_a = if own.soc.get() < FULL { -CHARGE_A } else { rest_a };
        let out = battery.step(&mut own, BatteryInput { current_a });
        sums.add(out.current_a, out.refused_charge_c, out.heat_w);
    }
    *state = own;
}

impl Sums {
    #[inline]
    fn add(&mut self, current_a: f32, refused_c: f32, heat_w: f32) {
        let charge_c = f64::from(current_a);
        self.net_c += charge_c;
        self.moved_c += charge_c.abs();
        self.refused_c += f64::from(refused_c.abs());
        self.heat_j += f64::from(heat_w);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_year_balances_and_charges_every_night() {
        let report = run(1, false).unwrap();
        assert_eq!(report.steps, 365 * 86_400);
        assert!(report.is_good(), "{report:?}");
        assert!(report.soc_final > 0.79 && report.soc_min > 0.2 && report.soc_min < 0.75);
        assert_eq!(report.refused_ah, 0.0);
        assert!(report.text().contains("pass"));
        let worse = Report { pass: false, ..report };
        assert!(worse.text().contains("FAIL") && !worse.is_good());
    }
}
