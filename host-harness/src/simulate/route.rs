//! A cycle or a trip as the plant's inputs over time.

use plant_core::mechanics::slope::Grade;

use plant_core::mechanics::body::RoadResistance;

use crate::read::cycle::Cycle;
use crate::read::trip::{Trip, mean};
use crate::read::vehicle::{Vehicle, air_density_kg_m3};
use crate::simulate::smooth;

/// Trace rows of a cycle are no further apart than this \[s\].
const CYCLE_ROW_S: f64 = 0.1;
/// The slope of a trip is measured over this distance to either side \[m\]: its heights come in
/// steps of a metre.
const SLOPE_REACH_M: f64 = 50.0;
/// Density of the air for which the road load of a coast-down test holds \[kg/m³\].
const COAST_DOWN_AIR_KG_M3: f64 = 1.2;
/// Steeper slopes than any public road are errors of the height.
const LARGEST_SIN: f64 = 0.25;

/// A speed to follow, and what acts on the vehicle meanwhile.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// What holds from each row to the next, and where a trace row is kept; times rise from 0.
    pub rows: Vec<Row>,
}

/// One instant of a route.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Time \[s\].
    pub time_s: f64,
    /// The speed to follow, linear to the next row \[m/s\].
    pub speed_m_s: f64,
    /// Slope of the road, to the next row.
    pub grade: Grade,
    /// Auxiliary power beside the vehicle's own, to the next row \[W\].
    pub auxiliary_w: f32,
    /// Measured temperature of the battery \[°C\]; NaN where there is none.
    pub battery_c: f32,
    /// Density of the air over that of the parameters.
    pub air_density_factor: f32,
    /// Rolling resistance over that of the parameters.
    pub rolling_factor: f32,
}

impl Row {
    /// At rest on a flat road.
    pub const FLAT: Self = Self {
        time_s: 0.0,
        speed_m_s: 0.0,
        grade: Grade::FLAT,
        auxiliary_w: 0.0,
        battery_c: f32::NAN,
        air_density_factor: 1.0,
        rolling_factor: 1.0,
    };
}

impl Route {
    /// The cycle's speed on its road, flat where the file says none. Every point of the cycle is a
    /// row, with others between.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    pub fn of_cycle(cycle: &Cycle) -> Self {
        let start_s = cycle.points.first().map_or(0.0, |p| f64::from(p.0));
        let row = |time_s, speed_m_s, grade| Row {
            time_s: time_s - start_s,
            speed_m_s,
            grade,
            ..Row::FLAT
        };
        let grades = if cycle.elevation_m.is_empty() {
            // Rise over the way along the road is its sine.
            let held = |g: &f64| Grade::from_sin(g.clamp(-LARGEST_SIN, LARGEST_SIN) as f32);
            cycle.grade.iter().map(held).collect()
        } else {
            let (time_s, speed_m_s): (Vec<f64>, Vec<f64>) =
                cycle.points.iter().map(|p| (f64::from(p.0), f64::from(p.1))).unzip();
            grades(&time_s, &speed_m_s, &cycle.elevation_m)
        };
        let grade = |i: usize| grades.get(i).copied().unwrap_or(Grade::FLAT);
        let mut rows = Vec::new();
        for (k, pair) in cycle.points.windows(2).enumerate() {
            let ((t0, v0), (t1, v1)) = (pair[0], pair[1]);
            let ((t0, v0), (t1, v1)) =
                ((f64::from(t0), f64::from(v0)), (f64::from(t1), f64::from(v1)));
            #[expect(clippy::cast_sign_loss, reason = "a count")]
            let parts = ((t1 - t0) / CYCLE_ROW_S - 1e-6).ceil().max(1.0) as u32;
            rows.extend((0..parts).map(|i| {
                let along = f64::from(i) / f64::from(parts);
                row(t0 + along * (t1 - t0), v0 + along * (v1 - v0), grade(k))
            }));
        }
        let last = cycle.points.len().saturating_sub(1);
        let end = cycle.points.last().map(|&(t, v)| row(f64::from(t), f64::from(v), grade(last)));
        rows.extend(end);
        Self { rows }
    }

    /// That the road was made less steep than the file has it, in words.
    #[must_use]
    pub fn cut(&self) -> Option<String> {
        let steepest = |row: &&Row| f64::from(row.grade.sin.abs()) >= LARGEST_SIN - 1e-6;
        let s: f64 = (self.rows.windows(2))
            .filter(|pair| steepest(&&pair[0]))
            .map(|pair| pair[1].time_s - pair[0].time_s)
            .sum();
        let percent = 100.0 * LARGEST_SIN;
        (s > 0.0).then(|| {
            format!(
                "the road is steeper than {percent:.0} % during {s:.1} s: {percent:.0} % taken there"
            )
        })
    }

    /// The trip's speed, slope and auxiliary power, [screened](Trip::screened); a row per sample.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    pub fn of_trip(trip: &Trip) -> Self {
        let start_s = trip.time_s.first().copied().unwrap_or(0.0);
        let auxiliary_w = trip.screened().auxiliary_w;
        let grades = grades(&trip.time_s, &trip.speed_m_s, &trip.elevation_m);
        let rows = (0..trip.time_s.len())
            .map(|i| Row {
                time_s: trip.time_s[i] - start_s,
                speed_m_s: trip.speed_m_s[i],
                grade: grades[i],
                auxiliary_w: auxiliary_w[i] as f32,
                battery_c: trip.battery_c.get(i).map_or(f32::NAN, |c| *c as f32),
                ..Row::FLAT
            })
            .collect();
        Self { rows }
    }

    /// The same for a vehicle: where its file says how trips act on it, with speed and heights
    /// smoothed, and the air and the tyres as they were. The temperature of the air is the mean
    /// of the trip; without one they are as the parameters have them.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    pub fn of_trip_for(trip: &Trip, vehicle: &Vehicle) -> Self {
        let mut route = Self::of_trip(trip);
        let Some(conditions) = &vehicle.trips else { return route };
        let speed_m_s =
            smooth::over_time(&trip.time_s, &trip.speed_m_s, conditions.speed_smoothing_s);
        let distance_m = distances(&trip.time_s, &speed_m_s);
        let sines = smooth::slopes(&distance_m, &trip.elevation_m, conditions.height_smoothing_m);
        let ambient_c = mean(trip.ambient_c.iter().copied());
        let height_m = mean(trip.elevation_m.iter().copied()).unwrap_or(0.0);
        let parameters_kg_m3 = match vehicle.powertrain.body.resistance {
            RoadResistance::Physical { air_density_kg_m3, .. } => f64::from(air_density_kg_m3),
            RoadResistance::CoastDown { .. } => COAST_DOWN_AIR_KG_M3,
        };
        let air = ambient_c.map_or(1.0, |c| air_density_kg_m3(c, height_m) / parameters_kg_m3);
        let warm = ambient_c.map_or(1.0, |c| conditions.warm_rolling(c));
        for (i, row) in route.rows.iter_mut().enumerate() {
            row.speed_m_s = speed_m_s[i];
            row.grade = Grade::from_sin(sines[i].clamp(-LARGEST_SIN, LARGEST_SIN) as f32);
            row.air_density_factor = if air.is_finite() { air as f32 } else { 1.0 };
            row.rolling_factor = (warm + conditions.warm_up(distance_m[i])) as f32;
            if speed_m_s[i] > 0.0 {
                row.auxiliary_w += conditions.moving_power_w as f32;
            }
        }
        route
    }

    /// How long it takes \[s\].
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.rows.last().map_or(0.0, |r| r.time_s)
    }
}

/// How far it is from the start at each sample \[m\].
pub(crate) fn distances(time_s: &[f64], speed_m_s: &[f64]) -> Vec<f64> {
    let mut distance_m = vec![0.0; time_s.len()];
    for i in 1..time_s.len() {
        let mean = 0.5 * (speed_m_s[i] + speed_m_s[i - 1]);
        distance_m[i] = distance_m[i - 1] + mean.max(0.0) * (time_s[i] - time_s[i - 1]);
    }
    distance_m
}

/// The slope at each sample: the rise over the road from 50 m before to 50 m after.
#[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
fn grades(time_s: &[f64], speed_m_s: &[f64], elevation_m: &[f64]) -> Vec<Grade> {
    let n = time_s.len();
    let distance_m = distances(time_s, speed_m_s);
    let (mut behind, mut ahead) = (0, 0);
    (0..n)
        .map(|i| {
            while distance_m[i] - distance_m[behind] > SLOPE_REACH_M {
                behind += 1;
            }
            while ahead + 1 < n && distance_m[ahead] - distance_m[i] < SLOPE_REACH_M {
                ahead += 1;
            }
            let along_m = distance_m[ahead] - distance_m[behind];
            let rise_m = elevation_m[ahead] - elevation_m[behind];
            // Too short a distance says nothing, at the ends of a trip or where it hardly moves.
            if along_m < SLOPE_REACH_M || !rise_m.is_finite() {
                return Grade::FLAT;
            }
            Grade::from_sin((rise_m / along_m).clamp(-LARGEST_SIN, LARGEST_SIN) as f32)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cycle_has_rows_to_its_end() {
        let cycle = crate::read::cycle::by_name("udds").unwrap();
        let route = Route::of_cycle(&cycle);
        assert_eq!((route.rows.len(), route.duration_s()), (13_691, 1369.0));
        assert!(route.rows.windows(2).all(|w| w[0].time_s < w[1].time_s));
        let point = cycle.points[200];
        let row = route.rows.iter().find(|r| r.time_s == f64::from(point.0)).unwrap();
        assert_eq!(row.speed_m_s, f64::from(point.1), "every point of the cycle is a row");
    }

    #[test]
    fn a_constant_climb_is_found_away_from_its_ends() {
        let n = 2000;
        let along = |i: usize| i as f64; // 10 m/s at 10 Hz
        let trip = Trip {
            time_s: (0..n).map(|i| 100.0 + i as f64 * 0.1).collect(),
            speed_m_s: vec![10.0; n],
            elevation_m: (0..n).map(|i| 0.04 * along(i)).collect(),
            ..crate::read::trip::Trip::empty("climb", n)
        };
        let route = Route::of_trip(&trip);
        assert_eq!(route.rows[0].time_s, 0.0);
        for row in &route.rows {
            assert!((row.grade.sin - 0.04).abs() < 1e-3, "{row:?}");
        }
    }

    #[test]
    fn a_cycle_climbs_as_its_slope_or_its_height_says_and_a_cut_is_said() {
        let points: Vec<(f32, f32)> = (0..100).map(|i| (i as f32, 10.0)).collect();
        let flat = crate::read::cycle::by_name("udds").unwrap();
        let flat = crate::read::cycle::Cycle { points, ..flat };
        assert!(Route::of_cycle(&flat).rows.iter().all(|r| r.grade == Grade::FLAT));
        let height = |slope: f64| (0..100).map(|i| slope * 10.0 * f64::from(i)).collect();
        let by_grade = crate::read::cycle::Cycle { grade: vec![0.04; 100], ..flat.clone() };
        let by_height = crate::read::cycle::Cycle { elevation_m: height(0.04), ..flat.clone() };
        for cycle in [by_grade, by_height] {
            let route = Route::of_cycle(&cycle);
            assert!(route.rows.iter().all(|r| (r.grade.sin - 0.04).abs() < 1e-5));
            assert_eq!(route.cut(), None);
        }
        let steep = crate::read::cycle::Cycle { elevation_m: height(0.3), ..flat };
        let said = Route::of_cycle(&steep).cut().unwrap();
        assert_eq!(said, "the road is steeper than 25 % during 99.0 s: 25 % taken there");
    }

    #[test]
    fn weather_and_tyres_act_where_the_vehicle_says_how() {
        let n = 6000;
        let trip = Trip {
            time_s: (0..n).map(|i| i as f64 * 0.1).collect(),
            speed_m_s: (0..n).map(|i| if i == 0 { 0.0 } else { 10.0 }).collect(),
            elevation_m: vec![500.0; n],
            ambient_c: vec![0.0; n],
            heating_w: vec![100.0; n],
            ..Trip::empty("winter", n)
        };
        let mut vehicle = crate::read::vehicle::load("bmw-i3-60ah").unwrap();
        let route = Route::of_trip_for(&trip, &vehicle);
        let conditions = vehicle.trips.as_mut().unwrap();
        let air = air_density_kg_m3(0.0, 500.0) / 1.2;
        let warm = conditions.warm_rolling(0.0);
        assert!(air > 1.0 && warm > 1.5, "{air} {warm}");
        // 2.5 km on, the tyres are warm but for a 1/e.
        for (i, cold) in [(1, 1.0), (2500, (-1.0_f64).exp())] {
            let row = &route.rows[i];
            assert!((f64::from(row.air_density_factor) - air).abs() < 1e-6);
            let rolling = warm + cold * conditions.warm_up_factor;
            assert!((f64::from(row.rolling_factor) - rolling).abs() < 1e-3, "{row:?}");
            assert!(row.grade.sin.abs() < 1e-9);
        }
        conditions.moving_power_w = 40.0;
        let route = Route::of_trip_for(&trip, &vehicle);
        assert_eq!([0, 100].map(|i| route.rows[i].auxiliary_w), [100.0, 140.0]);
        // Without a temperature, or a vehicle that says nothing, all is as the parameters have it.
        let unknown = Trip { ambient_c: vec![f64::NAN; n], ..trip.clone() };
        let row = Route::of_trip_for(&unknown, &vehicle).rows[5999];
        assert!(row.air_density_factor == 1.0 && (row.rolling_factor - 1.0).abs() < 0.1);
        vehicle.trips = None;
        let plain = Route::of_trip_for(&trip, &vehicle);
        let as_parameters = |r: &Row| (r.air_density_factor, r.rolling_factor) == (1.0, 1.0);
        assert!(plain.rows.len() == n && plain.rows.iter().all(as_parameters));
    }
}
