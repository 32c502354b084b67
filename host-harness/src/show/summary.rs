//! The summary of a replay on a terminal.

use crate::show::table::{number, table};
use crate::simulate::comparison::Deviation;
use crate::simulate::figures::Figures;
use crate::simulate::summary::Summary;

/// Of the energy ledger, terms below this do not show in the table \[kWh\].
const SMALLEST_TERM_KWH: f64 = 5e-5;

/// A figure that a replay and a measurement have in common.
type Row = (&'static str, fn(&Figures) -> Option<f64>, usize);

const ROWS: [Row; 10] = [
    ("distance [km]", |f| Some(f.distance_km), 3),
    ("SOC at the start [%]", |f| Some(100.0 * f.soc_initial), 2),
    ("SOC at the end [%]", |f| Some(100.0 * f.soc_final), 3),
    ("energy at the battery [kWh]", |f| Some(f.battery_energy_kwh), 4),
    ("consumption [Wh/km]", |f| f.consumption_wh_per_km, 1),
    ("motor torque, lowest [N·m]", |f| f.motor_torque_min_nm, 1),
    ("motor torque, highest [N·m]", |f| f.motor_torque_max_nm, 1),
    ("battery current, lowest [A]", |f| Some(f.battery_current_min_a), 1),
    ("battery current, highest [A]", |f| Some(f.battery_current_max_a), 1),
    ("battery voltage, lowest [V]", |f| Some(f.battery_voltage_min_v), 1),
];

/// The summary as a table that fits a terminal.
pub fn render(s: &Summary) -> String {
    let mut text = format!(
        "{} · {} · {} steps of {} ms in {:.3} s ({:.0} times real time)\n",
        s.input,
        s.vehicle,
        s.steps,
        s.dt_s * 1000.0,
        s.run_wall_s,
        s.realtime_factor,
    );
    let mut rows = match s.measured {
        Some(_) => table(&["", "simulated", "measured"]),
        None => table(&["", "simulated"]),
    };
    for row in figures(s) {
        rows.add_row(&row[..if s.measured.is_some() { 3 } else { 2 }]);
    }
    text += &format!("{rows}\n");

    if let Some(e) = &s.error {
        let mut rows = table(&["simulated minus measured", ""]);
        for (name, value) in errors(e) {
            rows.add_row([name.to_owned(), value]);
        }
        text += &format!("{rows}\n");
    }
    if let Some(energy) = &s.energy {
        let mut ledger = table(&["energy", "kWh", "share [%]"]);
        let throughput = energy.get("throughput").copied().unwrap_or(f64::NAN);
        let mut terms: Vec<_> = energy
            .iter()
            .filter(|(name, v)| **name != "throughput" && v.abs() >= SMALLEST_TERM_KWH)
            .collect();
        terms.sort_by(|a, b| b.1.total_cmp(a.1));
        for (name, kwh) in terms {
            ledger.add_row([
                name.replace('_', " "),
                format!("{kwh:.4}"),
                format!("{:.2}", 100.0 * kwh / throughput),
            ]);
        }
        text += &format!("{ledger}\n");
        text += &format!(
            "shares are of the battery's throughput, {throughput:.4} kWh; the ledger closes to {:.1e} of it\n",
            s.energy_residual_rel.unwrap_or(f64::NAN).abs()
        );
    }
    for note in &s.notes {
        text += &format!("note: {note}\n");
    }
    text
}

/// The figures of a replay: name, simulated, measured.
pub fn figures(s: &Summary) -> Vec<[String; 3]> {
    let measured = s.measured.as_ref();
    let both = ROWS.into_iter().map(|(name, pick, digits)| {
        let theirs = measured.map_or_else(String::new, |m| number(pick(m), digits));
        [name.to_owned(), number(pick(&s.figures), digits), theirs]
    });
    let hottest = s.drive_temperatures;
    let ours_only = [
        ("speed error, RMS [m/s]", s.speed_error_rms_m_s, 4),
        ("speed error, largest [m/s]", s.speed_error_max_m_s, 4),
        ("machine, highest [°C]", hottest.map(|h| h.machine_max_c), 1),
        ("inverter, highest [°C]", hottest.map(|h| h.inverter_max_c), 1),
    ];
    let ours_only = ours_only
        .into_iter()
        .filter(|(_, value, _)| value.is_some())
        .map(|(name, value, digits)| [name.to_owned(), number(value, digits), String::new()]);
    both.chain(ours_only).collect()
}

/// How far a replay is from the measurement: name, value.
pub fn errors(e: &Deviation) -> [(&'static str, String); 8] {
    [
        ("SOC, RMS [%]", format!("{:.3}", 100.0 * e.soc_rmse)),
        ("SOC at the end [%]", format!("{:+.3}", 100.0 * e.soc_final)),
        ("SOC drop, relative [%]", format!("{:+.2}", 100.0 * e.soc_drop_rel)),
        ("battery voltage, RMS [V]", format!("{:.3}", e.voltage_rmse_v)),
        ("battery voltage, largest [V]", format!("{:.2}", e.voltage_max_v)),
        ("battery current, RMS [A]", format!("{:.2}", e.current_rmse_a)),
        ("motor torque, RMS [N·m]", number(e.torque_rmse_nm, 2)),
        ("energy at the battery, relative [%]", format!("{:+.2}", 100.0 * e.energy_rel)),
    ]
}
