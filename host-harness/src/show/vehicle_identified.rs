//! `voltstep identify vehicle` on a terminal.

use crate::identify::IdentifiedVehicle;
use crate::show::table::{number, table};
use crate::simulate::statistics::Spreads;

/// Each parameter, each trip against what the others found, and what to expect of a new one.
pub fn render(found: &IdentifiedVehicle) -> String {
    let mut rows = table(&[found.name.as_str(), "value", "standard error"]);
    for p in &found.parameters {
        // Two digits of the error; where there is none, four of the value.
        let told = p.standard_error > 1e-6 * p.value.abs();
        let size = if told { p.standard_error } else { p.value.abs() / 100.0 };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 12")]
        let digits = match size {
            0.0 => 0,
            size => (1.0 - size.log10().floor()).clamp(0.0, 12.0) as usize,
        };
        rows.add_row([
            p.name.clone(),
            number(Some(p.value), digits),
            number(Some(p.standard_error), digits),
        ]);
    }
    let mut text = format!("{rows}\n");
    let mut rows = table(&["left out of the fit", "energy [%]", "torque [N·m]", "SOC [%]"]);
    for r in &found.left_out {
        rows.add_row([
            format!("{}{}", r.name, if r.doubts.is_empty() { "" } else { " *" }),
            format!("{:+.1}", 100.0 * r.energy_rel),
            number(r.torque_rmse_nm, 1),
            number(Some(100.0 * r.soc_rmse), 2),
        ]);
    }
    text += &format!("{rows}\n");
    text += "* marked, never fitted; energy relative, torque and SOC the RMS of simulated minus measured\n";
    text += &expected("a new trip, as those left out", &found.expected);
    text += &expected("with those that are marked", &found.expected_of_all);
    text +=
        &format!("force that no parameter explains, over trips: {:.0} N\n", found.unexplained_n);
    for r in &found.left_out {
        for doubt in &r.doubts {
            text += &format!("{}: {doubt}\n", r.name);
        }
    }
    for note in &found.notes {
        text += &format!("{note}\n");
    }
    text
}

fn expected(what: &str, spreads: &Spreads) -> String {
    let of = |name, factor: f64| {
        let spread = spreads.get(name);
        let number = |value: Option<f64>| number(value.map(|v| factor * v), 1);
        format!("{} / {}", number(spread.map(|s| s.median)), number(spread.map(|s| s.p90)))
    };
    format!(
        "{what} (median / 90th percentile of {}): energy {} %, torque {} N·m, SOC {} %\n",
        spreads.count,
        of("energy_rel", 100.0),
        of("torque_rmse_nm", 1.0),
        of("soc_rmse", 100.0)
    )
}
