//! Whether measurements tell a battery at all.

use anyhow::{bail, ensure};

use super::series::Measured;

/// A current that varies by less tells no resistance, as a share of the capacity an hour.
const TELLING_CURRENT: f64 = 0.05;
/// An open-circuit curve beyond the measured voltages by more than this share of their span was not
/// told by them.
const OUTSIDE: f64 = 0.5;
/// What a fit may leave, RMS, as a share of the span of the measured voltages; good ones leave 0.02.
const LEFT: f64 = 0.1;

/// Whether an open-circuit curve lies where the voltages were measured: else nothing held its level,
/// as in a pulse test alone.
pub fn told(measured: &[Measured], ocv: &[f64]) -> anyhow::Result<()> {
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)))
    };
    let (low_v, high_v) = range(&mut measured.iter().flat_map(|m| m.voltage_v.iter().copied()));
    let (fitted_low_v, fitted_high_v) = range(&mut ocv.iter().copied());
    let margin_v = OUTSIDE * (high_v - low_v);
    ensure!(
        fitted_low_v >= low_v - margin_v && fitted_high_v <= high_v + margin_v,
        "the measurements do not tell the open-circuit voltage: {fitted_low_v:.2}..{fitted_high_v:.2} V \
         fits best, and {low_v:.2}..{high_v:.2} V was measured; add a slow discharge of a full cell or \
         a drive cycle without gaps"
    );
    Ok(())
}

/// Whether one battery can have given all of the measurements: some resistance fits them, and what is
/// left is small beside the voltages' span.
pub fn agree(measured: &[Measured], resists: bool, voltage_rmse_v: f64) -> anyhow::Result<()> {
    let (low_v, high_v) = (measured.iter().flat_map(|m| m.voltage_v.iter().copied()))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let worst = voltage_rmse_v / (high_v - low_v);
    let why = if !resists {
        "no resistance above zero fits"
    } else if worst > LEFT || worst.is_nan() {
        "no battery fits"
    } else {
        return Ok(());
    };
    bail!(
        "the measurements contradict each other or the model: {why}, {:.0} mV RMS are left of {:.2} V; \
         are all of one cell, each begun as its counter says, at the right sign of the current? \
         Leave out one after the other: {}",
        1000.0 * voltage_rmse_v,
        high_v - low_v,
        measured.iter().map(|m| m.name.as_str()).collect::<Vec<_>>().join(", ")
    );
}

/// Whether any current varies enough.
pub fn excited(measured: &[Measured], capacity_ah: f64) -> anyhow::Result<()> {
    let spread = |m: &Measured| {
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let n = m.current_a.len() as f64;
        let mean = m.current_a.iter().sum::<f64>() / n;
        (m.current_a.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / n).sqrt()
    };
    let most = measured.iter().map(spread).fold(0.0, f64::max);
    ensure!(
        most >= TELLING_CURRENT * capacity_ah,
        "the current varies by {most:.3} A: too little to tell a resistance (at least {:.3} A)",
        TELLING_CURRENT * capacity_ah
    );
    Ok(())
}
