//! What the plot sheet of a replay shows.

use crate::read::trip::Trip;
use crate::show::plot::{Bar, Kind, Panel, Series, Sheet, render as draw};
use crate::simulate::figures::J_PER_KWH;
use crate::simulate::mode::Replayed;
use crate::simulate::replay::Replay;
use crate::simulate::run::TraceRow;

/// The plot sheet as SVG.
pub fn render(replay: &Replay) -> anyhow::Result<String> {
    let summary = &replay.summary;
    let trace = &replay.run.trace;
    let ours = |pick: fn(&TraceRow) -> f32| {
        let values = trace.iter().map(|r| f64::from(pick(r))).collect();
        Series { name: "simulated".into(), values, kind: Kind::Simulated }
    };
    let measured = |pick: fn(&Trip) -> &Vec<f64>| {
        replay.trip.as_ref().map(|trip| {
            let values = pick(trip).clone();
            Series { name: "measured".into(), values, kind: Kind::Measured }
        })
    };
    let panel = |title: &str, unit: &str, series: Vec<Series>| Panel {
        title: title.into(),
        unit: unit.into(),
        series,
    };
    let kmh = |pick: fn(&TraceRow) -> f32| -> Vec<f64> {
        trace.iter().map(|r| f64::from(pick(r)) * 3.6).collect()
    };
    let with = |first: Series, second: Option<Series>| {
        // The measured line is the wider one and goes behind ours.
        second.into_iter().chain([first]).collect::<Vec<_>>()
    };

    let mut panels = Vec::new();
    if summary.mode != Replayed::Battery {
        let reference = Series {
            name: "reference".into(),
            values: kmh(|r| r.reference_m_s),
            kind: Kind::Reference,
        };
        let speed = Series {
            name: "simulated".into(),
            values: kmh(|r| r.speed_m_s),
            kind: Kind::Simulated,
        };
        panels.push(panel("Speed", "km/h", vec![reference, speed]));
        let torque = with(ours(|r| r.motor_torque_nm), measured(|t| &t.motor_torque_nm));
        panels.push(panel("Motor torque", "N·m", torque));
    }
    let percent = |mut series: Series| {
        series.values.iter_mut().for_each(|v| *v *= 100.0);
        series
    };
    let soc = with(percent(ours(|r| r.soc)), measured(|t| &t.soc).map(percent));
    panels.push(panel("State of charge", "%", soc));
    let current = with(ours(|r| r.battery_current_a), measured(|t| &t.battery_a));
    panels.push(panel("Battery current (discharge positive)", "A", current));
    let voltage = with(ours(|r| r.battery_voltage_v), measured(|t| &t.battery_v));
    panels.push(panel("Battery voltage", "V", voltage));

    draw(&Sheet {
        title: format!("{} · {}", summary.input, summary.vehicle),
        subtitle: subtitle(replay),
        time_s: trace.iter().map(|r| r.time_s).collect(),
        panels,
        bars_title: "Where the energy went".into(),
        bars_unit: "kWh".into(),
        bars: bars(replay),
    })
}

/// The energy terms that matter, largest first.
fn bars(replay: &Replay) -> Vec<Bar> {
    let Some(report) = &replay.run.energy else { return Vec::new() };
    let skipped = ["throughput", "electrochemical", "open_circuit_explicit", "residual"];
    let mut bars: Vec<_> = report
        .terms()
        .into_iter()
        .filter(|(name, _)| !skipped.contains(name))
        .map(|(name, j)| Bar { name: name.replace('_', " "), value: f64::from(j) / J_PER_KWH })
        .filter(|bar| bar.value.abs() > 5e-5)
        .collect();
    bars.sort_by(|a, b| b.value.total_cmp(&a.value));
    bars
}

fn subtitle(replay: &Replay) -> Vec<String> {
    let s = &replay.summary;
    let f = &s.figures;
    let consumption =
        f.consumption_wh_per_km.map(|c| format!(" · {c:.1}\u{a0}Wh/km")).unwrap_or_default();
    let mut lines = vec![format!(
        "{:.3}\u{a0}km · SOC {:.2} → {:.2}\u{a0}% · {:.3}\u{a0}kWh at the battery's terminals{consumption}",
        f.distance_km,
        100.0 * f.soc_initial,
        100.0 * f.soc_final,
        f.battery_energy_kwh,
    )];
    if let Some(e) = &s.error {
        lines.push(format!(
            "against the measurement: SOC {:+.2}\u{a0}% at the end · energy {:+.1}\u{a0}% · voltage RMSE {:.2}\u{a0}V · current RMSE {:.1}\u{a0}A",
            100.0 * e.soc_final,
            100.0 * e.energy_rel,
            e.voltage_rmse_v,
            e.current_rmse_a,
        ));
    }
    lines
}
