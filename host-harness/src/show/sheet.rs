//! What the plots of a replay show.

use crate::read::trip::Trip;
use crate::show::plot::{Bar, Kind, Panel, Series, Sheet};
use crate::simulate::figures::J_PER_KWH;
use crate::simulate::replay::Replay;
use crate::simulate::run::{Extremes, TraceRow};

/// The plots of a replay, its key figures above them and its energy below.
pub fn of(replay: &Replay) -> Sheet {
    let summary = &replay.summary;
    let trace = &replay.run.trace;
    let ours = |pick: fn(&TraceRow) -> f32| {
        let values = trace.iter().map(|r| f64::from(pick(r))).collect();
        Series::new("simulated", Kind::Simulated, values)
    };
    let stepped = |pick: fn(&TraceRow) -> f32, extremes: fn(&Extremes) -> (f32, f32)| {
        let both = |(low, high): (f32, f32)| (f64::from(low), f64::from(high));
        let extremes = trace.iter().map(|r| both(extremes(&r.extremes))).collect();
        Series { extremes, ..ours(pick) }
    };
    let measured = |pick: fn(&Trip) -> &Vec<f64>| {
        replay.trip.as_ref().map(|trip| Series::new("measured", Kind::Measured, pick(trip).clone()))
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
    if summary.mode.drives() {
        let (name, kind) = match replay.trip {
            Some(_) => ("measured", Kind::Measured),
            None => ("reference", Kind::Reference),
        };
        let reference = Series::new(name, kind, kmh(|r| r.reference_m_s));
        let speed = Series::new("simulated", Kind::Simulated, kmh(|r| r.speed_m_s));
        panels.push(panel("Speed", "km/h", vec![reference, speed]));
        let torque = stepped(|r| r.motor_torque_nm, |e| e.motor_torque_nm);
        let torque = with(torque, measured(|t| &t.motor_torque_nm));
        panels.push(panel("Motor torque", "N·m", torque));
    }
    let percent = |mut series: Series| {
        series.values.iter_mut().for_each(|v| *v *= 100.0);
        series
    };
    let soc = with(percent(ours(|r| r.soc)), measured(|t| &t.soc).map(percent));
    panels.push(panel("State of charge", "%", soc));
    let current = stepped(|r| r.battery_current_a, |e| e.battery_current_a);
    let current = with(current, measured(|t| &t.battery_a));
    panels.push(panel("Battery current (discharge positive)", "A", current));
    let voltage = stepped(|r| r.battery_voltage_v, |e| e.battery_voltage_v);
    let voltage = with(voltage, measured(|t| &t.battery_v));
    panels.push(panel("Battery voltage", "V", voltage));

    Sheet {
        title: format!("{} · {}", summary.input, summary.vehicle),
        subtitle: subtitle(replay),
        time_s: trace.iter().map(|r| r.time_s).collect(),
        panels,
        bars_title: "Where the energy went".into(),
        bars_unit: "kWh".into(),
        bars: bars(replay),
    }
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
