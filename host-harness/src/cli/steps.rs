//! `voltstep steps`.

use crate::verify;

/// Prints what each step costs in accuracy, as a Markdown table.
///
/// # Errors
/// A run that diverged.
pub fn run() -> anyhow::Result<bool> {
    let mut table = String::from(
        "| step [ms] | SOC, largest error | energy, error [%] | speed, RMS error [m/s] | \
         numerical dissipation [%] | steps a second |\n|--:|--:|--:|--:|--:|--:|\n",
    );
    for row in verify::step_sizes()? {
        table += &format!(
            "| {} | {:.1e} | {:.3} | {:.1e} | {:.4} | {:.0} |\n",
            row.step_ms,
            row.soc,
            100.0 * row.energy_rel,
            row.speed_rms_m_s,
            100.0 * row.numerical_rel,
            1000.0 / row.step_ms,
        );
    }
    super::print(&table)?;
    Ok(true)
}
