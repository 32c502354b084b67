//! `voltstep endurance` on a terminal.

use crate::verify::endurance::EnduranceReport;

/// A few lines of text.
pub fn render(report: &EnduranceReport) -> String {
    format!(
        "{} years of a battery (open-circuit voltage, resistance, one RC branch) in {} steps \
         of 1 s: {:.1} s, {:.1} ns a step\n\
         charge moved {:.1} A·h, net {:.6} A·h; by the state of charge {:.6} A·h; \
         they differ by {:.1e} of the charge moved (at most {:.0e}): {}\n\
         state of charge: lowest {:.4}, at the end {:.6}; refused {:.3} A·h; \
         mean heat {:.2} W\n\
         for comparison: the source work quotes 288 s for ten years of a battery with ageing \
         by the fastest tool of its survey (Dymola); this battery does not age, a lighter job\n",
        report.years,
        report.steps,
        report.wall_s,
        report.ns_per_step,
        report.throughput_ah,
        report.net_ah,
        report.net_by_soc_ah,
        report.balance_rel,
        report.tolerance,
        if report.pass { "pass" } else { "FAIL" },
        report.soc_min,
        report.soc_final,
        report.refused_ah,
        report.heat_mean_w,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_whether_the_charge_balances() {
        let mut report = EnduranceReport {
            years: 1,
            steps: 31_536_000,
            wall_s: 0.5,
            ns_per_step: 15.9,
            throughput_ah: 20_000.0,
            net_ah: 0.25,
            net_by_soc_ah: 0.25,
            balance_rel: 1e-9,
            tolerance: 1e-6,
            soc_min: 0.4,
            soc_final: 0.8,
            refused_ah: 0.0,
            heat_mean_w: 20.0,
            pass: true,
        };
        assert!(render(&report).contains("(at most 1e-6): pass\n"), "{}", render(&report));
        report.pass = false;
        assert!(render(&report).contains("(at most 1e-6): FAIL\n"), "{}", render(&report));
    }
}
