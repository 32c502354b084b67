//! How a measured trip acts on a vehicle, beside its speed and its slope.

use serde::{Deserialize, Serialize};

/// What heights and weather of a measured trip mean for a vehicle: the table `[trips]` of its file.
/// The vehicle's parameters were found with them, so they belong together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TripConditions {
    /// The measured speed is smoothed by a Gaussian of this standard deviation \[s\], 0 to 10.
    pub speed_smoothing_s: f64,
    /// The slope is that of heights weighted by a Gaussian of this standard deviation along the
    /// road \[m\], 1 to 10 000.
    pub height_smoothing_m: f64,
    /// Rolling resistance over that of the parameters, at temperatures of the air \[°C\] that rise;
    /// linear between them, held beyond; above 0.
    pub rolling_factor: Vec<(f64, f64)>,
    /// What cold tyres add to that factor at the start of a trip, ≥ 0.
    pub warm_up_factor: f64,
    /// Distance over which that falls to 1/e \[m\], above 0.
    pub warm_up_m: f64,
    /// Drawn from the battery while the car moves, beside the base load \[W\], ≥ 0.
    pub moving_power_w: f64,
}

impl TripConditions {
    /// Which field breaks its rule, and the rule.
    ///
    /// # Errors
    /// The first that does.
    pub(super) fn check(&self) -> Result<(), (&'static str, &'static str)> {
        let rules = [
            (
                (0.0..=10.0).contains(&self.speed_smoothing_s),
                "trips.speed_smoothing_s",
                "must lie in 0..10",
            ),
            (
                (1.0..=10_000.0).contains(&self.height_smoothing_m),
                "trips.height_smoothing_m",
                "must lie in 1..10000",
            ),
            (
                !self.rolling_factor.is_empty()
                    && self
                        .rolling_factor
                        .iter()
                        .all(|(c, f)| c.is_finite() && *f > 0.0 && *f <= 100.0)
                    && self.rolling_factor.windows(2).all(|w| w[0].0 < w[1].0),
                "trips.rolling_factor",
                "must be pairs of rising temperatures and factors above 0, up to 100",
            ),
            (
                (0.0..=100.0).contains(&self.warm_up_factor),
                "trips.warm_up_factor",
                "must lie in 0..100",
            ),
            (
                self.warm_up_m > 0.0 && self.warm_up_m.is_finite(),
                "trips.warm_up_m",
                "must be above 0",
            ),
            (
                (0.0..=1e5).contains(&self.moving_power_w),
                "trips.moving_power_w",
                "must lie in 0..100000",
            ),
        ];
        rules
            .into_iter()
            .find(|(kept, ..)| !kept)
            .map_or(Ok(()), |(_, field, rule)| Err((field, rule)))
    }

    /// The factor of rolling resistance with tyres that are warm, at a temperature of the air.
    #[must_use]
    pub fn warm_rolling(&self, ambient_c: f64) -> f64 {
        let points = &self.rolling_factor;
        let after = points.partition_point(|(c, _)| *c <= ambient_c);
        match (after.checked_sub(1).and_then(|i| points.get(i)), points.get(after)) {
            (Some((c0, f0)), Some((c1, f1))) => f0 + (f1 - f0) * (ambient_c - c0) / (c1 - c0),
            (Some((_, f)), None) | (None, Some((_, f))) => *f,
            (None, None) => 1.0,
        }
    }

    /// What cold tyres add to it after a distance from the start.
    #[must_use]
    pub fn warm_up(&self, distance_m: f64) -> f64 {
        self.warm_up_factor * (-distance_m / self.warm_up_m).exp()
    }
}

/// Density of dry air at a temperature and a height above the sea \[kg/m³\], by the international
/// standard atmosphere's pressure.
#[must_use]
pub fn air_density_kg_m3(ambient_c: f64, height_m: f64) -> f64 {
    const GAS_J_KG_K: f64 = 287.05;
    let pressure_pa = 101_325.0 * (1.0 - 2.255_77e-5 * height_m).max(0.0).powf(5.255_88);
    pressure_pa / (GAS_J_KG_K * (ambient_c + 273.15))
}

#[cfg(test)]
mod tests {
    use super::*;

    pub const CONDITIONS: fn() -> TripConditions = || TripConditions {
        speed_smoothing_s: 0.15,
        height_smoothing_m: 600.0,
        rolling_factor: vec![(0.0, 1.5), (20.0, 1.0), (30.0, 0.9)],
        warm_up_factor: 0.4,
        warm_up_m: 2500.0,
        moving_power_w: 0.0,
    };

    #[test]
    fn air_is_as_the_standard_atmosphere_has_it() {
        assert!((air_density_kg_m3(15.0, 0.0) - 1.225).abs() < 1e-3);
        assert!((air_density_kg_m3(8.5, 1000.0) - 1.112).abs() < 1e-3);
    }

    #[test]
    fn rolling_is_linear_between_points_and_held_beyond() {
        let c = CONDITIONS();
        assert_eq!(
            [-10.0, 0.0, 10.0, 25.0, 40.0].map(|t| c.warm_rolling(t)),
            [1.5, 1.5, 1.25, 0.95, 0.9]
        );
        assert!((c.warm_up(2500.0) - 0.4 / std::f64::consts::E).abs() < 1e-12);
    }

    #[test]
    fn each_field_keeps_its_rule() {
        assert_eq!(CONDITIONS().check(), Ok(()));
        let refused = |change: fn(&mut TripConditions)| {
            let mut c = CONDITIONS();
            change(&mut c);
            c.check().unwrap_err().0
        };
        assert_eq!(refused(|c| c.speed_smoothing_s = -1.0), "trips.speed_smoothing_s");
        assert_eq!(refused(|c| c.height_smoothing_m = 0.0), "trips.height_smoothing_m");
        assert_eq!(refused(|c| c.rolling_factor.clear()), "trips.rolling_factor");
        assert_eq!(refused(|c| c.rolling_factor[1].0 = 0.0), "trips.rolling_factor");
        assert_eq!(refused(|c| c.rolling_factor[1].1 = f64::NAN), "trips.rolling_factor");
        assert_eq!(refused(|c| c.warm_up_factor = f64::NAN), "trips.warm_up_factor");
        assert_eq!(refused(|c| c.warm_up_m = 0.0), "trips.warm_up_m");
        assert_eq!(refused(|c| c.moving_power_w = -1.0), "trips.moving_power_w");
    }
}
