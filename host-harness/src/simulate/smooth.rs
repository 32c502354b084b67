//! Measurements made smooth: by a Gaussian over time, or along the road.

/// Where a Gaussian ends \[standard deviations\].
pub const REACH: f64 = 3.0;
/// Heights are taken together over this share of the standard deviation.
const CELL: f64 = 1.0 / 30.0;
/// More cells than this are no road \[–\].
const MOST_CELLS: f64 = 1e6;

/// Values over time, smoothed by a Gaussian of standard deviation `sigma_s`. A sample at zero stays
/// there: a wheel that stands is measured well.
pub fn over_time(time_s: &[f64], values: &[f64], sigma_s: f64) -> Vec<f64> {
    if sigma_s <= 0.0 {
        return values.to_vec();
    }
    let mut first = 0;
    (0..values.len())
        .map(|i| {
            while time_s[i] - time_s[first] > REACH * sigma_s {
                first += 1;
            }
            if values[i] == 0.0 {
                return 0.0;
            }
            let (mut sum, mut weights) = (0.0, 0.0);
            for j in first..values.len() {
                let away = (time_s[j] - time_s[i]) / sigma_s;
                if away > REACH {
                    break;
                }
                let weight = (-0.5 * away * away).exp();
                sum += weight * values[j];
                weights += weight;
            }
            sum / weights
        })
        .collect()
}

/// The slope at each sample, rise over distance: that of the line through the heights around, which
/// count by a Gaussian of standard deviation `sigma_m` along the road.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "places on a grid of bounded size"
)]
pub fn slopes(distance_m: &[f64], height_m: &[f64], sigma_m: f64) -> Vec<f64> {
    let end_m = distance_m.last().copied().unwrap_or(0.0);
    let cell_m = (CELL * sigma_m).max(end_m / MOST_CELLS);
    let place = |m: f64| (m / cell_m) as usize;
    // The mean height of each cell: standing still weighs no more than driving through.
    let mut cells = vec![(0.0, 0.0); place(end_m) + 1];
    for (m, h) in distance_m.iter().zip(height_m) {
        let (sum, count) = &mut cells[place(*m)];
        *sum += h;
        *count += 1.0;
    }
    let reach = (REACH / CELL) as usize;
    let slope = |at: usize| {
        let around = at.saturating_sub(reach)..(at + reach + 1).min(cells.len());
        let (mut w, mut wx, mut wh, mut wxx, mut wxh) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for j in around {
            let (sum, count) = cells[j];
            if count == 0.0 {
                continue;
            }
            let x = (j as f64 - at as f64) * cell_m;
            let h = sum / count;
            let weight = (-0.5 * (x / sigma_m).powi(2)).exp();
            w += weight;
            wx += weight * x;
            wh += weight * h;
            wxx += weight * x * x;
            wxh += weight * x * h;
        }
        let spread = wxx * w - wx * wx;
        // One cell tells no slope.
        if spread > 1e-9 * w * w * sigma_m * sigma_m { (wxh * w - wx * wh) / spread } else { 0.0 }
    };
    let found: Vec<f64> = (0..cells.len()).map(slope).collect();
    distance_m
        .iter()
        .map(|m| {
            // From the middle of one cell to that of the next.
            let along = (m / cell_m - 0.5).clamp(0.0, (found.len() - 1) as f64);
            let below = along as usize;
            let above = (below + 1).min(found.len() - 1);
            found[below] + (along - below as f64) * (found[above] - found[below])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_over_time_stays_one_and_a_stop_stays_a_stop() {
        let t: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.1).collect();
        let v: Vec<f64> = t.iter().map(|t| 3.0 + 2.0 * t).collect();
        let s = over_time(&t, &v, 0.15);
        assert!((s[50] - v[50]).abs() < 1e-9);
        let mut stop = v.clone();
        stop[40..].fill(0.0);
        let s = over_time(&t, &stop, 0.15);
        assert!(s[39] < stop[39] && s[40..].iter().all(|v| *v == 0.0));
        assert_eq!(over_time(&t, &v, 0.0), v);
    }

    #[test]
    fn noise_is_damped_by_as_much_as_the_gaussian_says() {
        let t: Vec<f64> = (0..20_000).map(|i| f64::from(i) * 0.01).collect();
        let mut random = fastrand::Rng::with_seed(1);
        let v: Vec<f64> = t.iter().map(|_| 10.0 + random.f64() - 0.5).collect();
        let s = over_time(&t, &v, 0.1);
        let variance = |x: &[f64]| x.iter().map(|x| (x - 10.0).powi(2)).sum::<f64>();
        // Variance falls by 1/(2·√π·σ) samples.
        let expected = 1.0 / (2.0 * std::f64::consts::PI.sqrt() * 10.0);
        assert!((variance(&s) / variance(&v) / expected - 1.0).abs() < 0.1);
    }

    #[test]
    fn a_climb_is_found_to_its_ends_and_while_standing() {
        let mut d: Vec<f64> = (0..5000).map(f64::from).collect();
        d[2000..2500].fill(2000.0);
        d[2500..].iter_mut().for_each(|m| *m -= 500.0);
        let h: Vec<f64> = d.iter().map(|m| (500.0 + 0.03 * m).round()).collect();
        let worst = slopes(&d, &h, 600.0).iter().map(|s| (s - 0.03).abs()).fold(0.0, f64::max);
        assert!(worst < 3e-4, "{worst}");
    }

    #[test]
    fn no_distance_is_no_slope() {
        assert_eq!(slopes(&[0.0; 4], &[500.0, 501.0, 502.0, 503.0], 600.0), [0.0; 4]);
    }
}
