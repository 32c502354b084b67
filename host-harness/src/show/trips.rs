//! `voltstep validate --trips` on a terminal.

use crate::evaluate::trips::TripsReport;
use crate::show::table::{number, table};
use crate::simulate::mode::Mode;
use crate::simulate::statistics::Spread;

type Pick = (&'static str, fn(&Spread) -> f64);
const SPREADS: [Pick; 3] =
    [("median", |s| s.median), ("90th percentile", |s| s.p90), ("largest", |s| s.max)];

/// A table for each mode, then what the reader should know.
pub fn render(report: &TripsReport) -> String {
    let mut text = String::new();
    let (counted, all) = (&report.summary, &report.summary_of_all);
    for (mode, counted, all) in [
        (Mode::Battery, &counted.battery, &all.battery),
        (Mode::Vehicle, &counted.vehicle, &all.vehicle),
    ] {
        let mut rows = table(&[
            mode.name(),
            "voltage [V]",
            "SOC [%]",
            "SOC drop [%]",
            "current [A]",
            "torque [N·m]",
            "energy [%]",
            "speed [m/s]",
        ]);
        for r in report.trips.iter().filter(|r| r.mode == mode) {
            rows.add_row([
                format!("{}{}", r.name, if r.counts { "" } else { " *" }),
                number(Some(r.voltage_rmse_v), 2),
                number(Some(100.0 * r.soc_rmse), 3),
                format!("{:+.1}", 100.0 * r.soc_drop_rel),
                number(Some(r.current_rmse_a), 2),
                number(r.torque_rmse_nm, 1),
                format!("{:+.1}", 100.0 * r.energy_rel),
                number(r.speed_error_rms_m_s, 4),
            ]);
        }
        // Without a marked trip both are the same.
        let summaries: &[_] = if all.count > counted.count { &[counted, all] } else { &[counted] };
        let spreads = summaries.iter().flat_map(|of| SPREADS.map(|spread| (*of, spread)));
        for (summary, (label, pick)) in spreads {
            let of =
                |name, factor, digits| number(summary.get(name).map(|s| factor * pick(s)), digits);
            let marked = if summary.count > counted.count { ", marked too" } else { "" };
            rows.add_row([
                format!("{label} of {}{marked}", summary.count),
                of("voltage_rmse_v", 1.0, 2),
                of("soc_rmse", 100.0, 3),
                of("soc_drop_rel", 100.0, 1),
                of("current_rmse_a", 1.0, 2),
                of("torque_rmse_nm", 1.0, 1),
                of("energy_rel", 100.0, 1),
                of("speed_error_rms_m_s", 1.0, 4),
            ]);
        }
        text += &format!("{rows}\n");
    }
    text += "* marked, for reasons below that do not look at the result; RMS of simulated minus measured, drop and energy \
             relative, their spreads without sign\n";
    for r in report.trips.iter().filter(|r| r.mode == Mode::Vehicle) {
        for note in &r.notes {
            text += &format!("{}: {note}\n", r.name);
        }
    }
    let count = report.trips.len() / 2;
    text + &format!(
        "{count} trips, {} in steps of {} ms, in {:.1} s\n",
        report.vehicle,
        1000.0 * report.dt_s,
        report.wall_s
    )
}
