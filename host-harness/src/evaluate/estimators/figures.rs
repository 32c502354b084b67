//! What the errors of a run come to.

use serde::Serialize;

use super::case::Point;

/// Errors count as settled after this time \[s\].
pub const SETTLED_S: f64 = 300.0;
/// An estimate has converged where its error is at most this …
const CONVERGED: f64 = 0.02;
/// … and stays so for this long \[s\].
const CONVERGED_FOR_S: f64 = 60.0;
/// An error beyond this is a bad one.
const BAD: f64 = 0.05;

/// How good a run was. Errors are estimated less measured state of charge, 0..1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// RMS of the error.
    pub soc_rmse: f64,
    /// Largest error.
    pub soc_max: f64,
    /// RMS of the error after the first five minutes.
    pub soc_rmse_after_300_s: f64,
    /// Largest error after the first five minutes.
    pub soc_max_after_300_s: f64,
    /// Error at the end.
    pub soc_error_end: f64,
    /// The estimator's standard deviation at the end.
    pub soc_sd_end: f64,
    /// The estimator's standard deviation, mean.
    pub soc_sd_mean: f64,
    /// When the error first was within 2 % for a minute \[s\]; absent where it never was.
    pub convergence_s: Option<f64>,
    /// Share of the samples in which the truth lies within three standard deviations.
    pub inside_3_sigma: f64,
    /// The same within the range in which the model's parameters were identified; absent where no
    /// sample is.
    pub inside_3_sigma_identified: Option<f64>,
    /// Share of the samples in which the estimator says that something contradicts.
    pub contradicted: f64,
    /// Time with an error beyond 5 % \[s\].
    pub outside_5_percent_s: f64,
    /// Samples compared.
    pub samples: usize,
}

impl Figures {
    /// The figures of a run whose points are `dt_s` apart; none where no truth is known.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "counts and times")]
    pub fn of(points: &[Point], dt_s: f64) -> Option<Self> {
        let known: Vec<(f64, &Point)> = (1..)
            .map(|k: u32| f64::from(k) * dt_s)
            .zip(points)
            .filter(|(_, p)| p.error.is_finite())
            .collect();
        let last = known.last()?.1;
        let settled = |&&(t, _): &&(f64, &Point)| t > SETTLED_S;
        let inside = |p: &Point| p.error.abs() <= 3.0 * p.sd;
        let share = |hits: usize, of: usize| hits as f64 / of as f64;
        let identified = known.iter().filter(|(_, p)| p.identified).count();
        let honest = known.iter().filter(|(_, p)| p.identified && inside(p)).count();
        let bad = known.iter().filter(|(_, p)| p.error.abs() > BAD).count();
        Some(Self {
            soc_rmse: rms(known.iter().map(|(_, p)| p.error)),
            soc_max: largest(known.iter().map(|(_, p)| p.error)),
            soc_rmse_after_300_s: rms(known.iter().filter(settled).map(|(_, p)| p.error)),
            soc_max_after_300_s: largest(known.iter().filter(settled).map(|(_, p)| p.error)),
            soc_error_end: last.error,
            soc_sd_end: last.sd,
            soc_sd_mean: known.iter().map(|(_, p)| p.sd).sum::<f64>() / known.len() as f64,
            convergence_s: converged(&known, dt_s),
            inside_3_sigma: share(known.iter().filter(|(_, p)| inside(p)).count(), known.len()),
            inside_3_sigma_identified: (identified > 0).then(|| share(honest, identified)),
            contradicted: share(known.iter().filter(|(_, p)| p.contradicted).count(), known.len()),
            outside_5_percent_s: bad as f64 * dt_s,
            samples: known.len(),
        })
    }
}

/// When the error first was small for a minute, or from then to the end.
fn converged(known: &[(f64, &Point)], dt_s: f64) -> Option<f64> {
    let mut since = None;
    for (t, p) in known {
        if p.error.abs() > CONVERGED {
            since = None;
        } else {
            let start = *since.get_or_insert(*t);
            if t - start >= CONVERGED_FOR_S {
                return Some(start - dt_s);
            }
        }
    }
    since.map(|start| start - dt_s)
}

fn rms(errors: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = errors.fold((0.0, 0.0), |(sum, n), e| (sum + e * e, n + 1.0));
    if count > 0.0 { f64::sqrt(sum / count) } else { f64::NAN }
}

fn largest(errors: impl Iterator<Item = f64>) -> f64 {
    errors.fold(f64::NAN, |most, e| most.max(e.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(error: f64) -> Point {
        Point { soc: error, error, sd: 0.01, identified: error < 0.04, contradicted: error < 0.0 }
    }

    #[test]
    fn counts_what_was_said() {
        // 100 s of 10 %, 300 s of 1 %, 100 s of 4 %, one second apart.
        let mut points = vec![point(0.1); 100];
        points.extend(vec![point(-0.01); 300]);
        points.extend(vec![point(0.04); 100]);
        points.push(point(f64::NAN));
        let f = Figures::of(&points, 1.0).unwrap();
        let square = (100.0 * 0.01 + 300.0 * 1e-4 + 100.0 * 16e-4) / 500.0;
        assert!((f.soc_rmse - f64::sqrt(square)).abs() < 1e-12);
        assert_eq!((f.soc_max, f.soc_max_after_300_s, f.soc_error_end), (0.1, 0.04, 0.04));
        let settled = (100.0 * 1e-4 + 100.0 * 16e-4) / 200.0;
        assert!((f.soc_rmse_after_300_s - f64::sqrt(settled)).abs() < 1e-12);
        assert_eq!((f.convergence_s, f.outside_5_percent_s, f.samples), (Some(100.0), 100.0, 500));
        assert!((f.inside_3_sigma - 0.6).abs() < 1e-12);
        assert_eq!((f.inside_3_sigma_identified, f.contradicted), (Some(1.0), 0.6));
        assert!(Figures::of(&[point(f64::NAN)], 1.0).is_none());
        assert_eq!(Figures::of(&[point(0.1)], 1.0).unwrap().convergence_s, None);
    }
}
