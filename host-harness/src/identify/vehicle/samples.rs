//! What the regressions see of a trip: means over short windows of what was measured.

use anyhow::Context;
use plant_core::mechanics::body::RoadResistance;
use plant_core::powertrain::DriveParams;

use crate::read::trip::{Trip, mean};
use crate::read::vehicle::Vehicle;
use crate::simulate::route::{Route, distances};
use crate::simulate::smooth;

/// Windows of the road's forces and of the drive's losses \[s\].
const ROAD_S: f64 = 1.0;
const LOSS_S: f64 = 0.5;
/// Rows further apart than this tell no acceleration \[s\].
const GAP_S: f64 = 2.0;
/// Below this speed a brake may hold the car \[m/s\].
const ROLLING_M_S: f64 = 0.5;
/// Below this share the pedal is not pressed.
const RELEASED: f64 = 0.01;
/// A brake that is not seen to act acts no more after this \[s\].
const SETTLED_S: f64 = 0.2;
/// Fewer samples at standstill tell no base load.
const LEAST_STANDING: usize = 20;

/// What is known of the vehicle beforehand.
#[derive(Clone, Copy, Debug)]
pub struct Known {
    /// Motor turns per metre of road \[rad/m\]: force at the road per torque of the motor.
    pub rad_per_m: f64,
    /// What turns, as mass at the road \[kg\].
    pub turning_kg: f64,
    /// Torque per current \[N·m/A\].
    pub torque_nm_per_a: f64,
    /// Resistance of the converter \[Ω\].
    pub converter_ohm: f64,
    /// Frontal area \[m²\].
    pub area_m2: f64,
    /// Density of the air for which its drag holds \[kg/m³\].
    pub air_kg_m3: f64,
    /// Base load where no trip stands still \[W\].
    pub base_w: f64,
    /// Distance over which tyres get warm \[m\].
    pub warm_up_m: f64,
}

impl Known {
    /// Of a vehicle with one DC machine and a resistance by physics.
    ///
    /// # Errors
    /// Another vehicle.
    pub fn of(vehicle: &Vehicle, warm_up_m: f64) -> anyhow::Result<Self> {
        let plant = &vehicle.powertrain;
        let drive: &DriveParams = plant.drives.one_dc().with_context(|| {
            format!("`{}`: only a vehicle with one DC machine can be identified", vehicle.name)
        })?;
        let RoadResistance::Physical { frontal_area_m2, air_density_kg_m3, .. } =
            plant.body.resistance
        else {
            anyhow::bail!("`{}`: its resistance must be a table `physical`", vehicle.name)
        };
        let rad_per_m = f64::from(drive.gearbox.ratio) / f64::from(plant.wheel.radius_m);
        let turning = f64::from(drive.motor.inertia_kg_m2 + drive.gearbox.inertia_kg_m2);
        let wheels = f64::from(plant.wheel.inertia_kg_m2);
        Ok(Self {
            rad_per_m,
            turning_kg: turning * rad_per_m.powi(2)
                + wheels / f64::from(plant.wheel.radius_m).powi(2),
            torque_nm_per_a: f64::from(drive.motor.torque_nm_per_a),
            converter_ohm: f64::from(drive.converter.resistance_ohm),
            area_m2: f64::from(frontal_area_m2),
            air_kg_m3: f64::from(air_density_kg_m3),
            base_w: f64::from(plant.auxiliary.power_w),
            warm_up_m,
        })
    }
}

/// Means over one window of a moving car that does not brake.
#[derive(Clone, Copy, Debug, Default)]
pub struct OnRoad {
    pub torque_nm: f64,
    pub torque_size_nm: f64,
    pub speed_m_s: f64,
    pub acceleration_m_s2: f64,
    pub slope_sin: f64,
    /// ½·ρ·v² \[N/m²\].
    pub pressure_n_m2: f64,
    /// Share of the cold tyres' resistance that is left.
    pub cold: f64,
}

/// Means over one window of the drive.
#[derive(Clone, Copy, Debug, Default)]
pub struct OfDrive {
    /// What the battery gives beside mechanical and auxiliary power \[W\].
    pub rest_w: f64,
    pub torque_squared: f64,
    pub torque_size_nm: f64,
    pub speed_squared: f64,
    /// Torque times speed, and speed with the torque's sign.
    pub power_w: f64,
    pub signed_speed_rad_s: f64,
    /// Share of the time in which the car moves.
    pub moving: f64,
    pub battery_w: f64,
}

/// A trip, ready to be fitted.
#[derive(Clone, Debug)]
pub struct Prepared {
    pub trip: Trip,
    /// Mean temperature of the air \[°C\].
    pub ambient_c: Option<f64>,
    pub road: Vec<OnRoad>,
    pub drive: Vec<OfDrive>,
    /// Median at standstill of what the battery gives beside the auxiliary loads \[W\].
    pub standing_w: Option<f64>,
    /// Speed \[m/s\] and torque \[N·m\] with the pedal released.
    pub released: Vec<(f64, f64)>,
    /// Why it is not fitted, in words.
    pub doubts: Vec<String>,
}

impl Prepared {
    /// From a trip as it was read, for a vehicle whose file says how trips act on it.
    pub fn new(trip: Trip, vehicle: &Vehicle, known: &Known) -> Self {
        let trip = trip.without_frozen();
        let screened = trip.screened();
        let doubts = trip.marked(f64::from(vehicle.powertrain.battery.capacity_ah()));
        let route = Route::of_trip_for(&trip, vehicle);
        let speed: Vec<f64> = route.rows.iter().map(|r| r.speed_m_s).collect();
        let distance = distances(&trip.time_s, &speed);
        // As the speed was, so that neither lags or is flatter than the other.
        let smoothing_s = vehicle.trips.as_ref().map_or(0.0, |t| t.speed_smoothing_s);
        let smooth_nm = smooth::over_time(&trip.time_s, &trip.motor_torque_nm, smoothing_s);
        let near_brake = near_brake(&trip, &speed, smoothing_s);
        let n = trip.len();
        let mut road = Windows::new(ROAD_S);
        let mut drive = Windows::new(LOSS_S);
        let (mut standing, mut released) = (Vec::new(), Vec::new());
        for i in 0..n {
            let (time_s, v, torque) = (trip.time_s[i], speed[i], trip.motor_torque_nm[i]);
            let battery_w = trip.battery_v[i] * trip.battery_a[i];
            let row = &route.rows[i];
            let omega = v * known.rad_per_m;
            if trip.speed_m_s[i] == 0.0 {
                standing.push(battery_w - screened.auxiliary_w[i]);
            }
            if torque.is_nan() {
                continue;
            }
            drive.add(
                time_s,
                [
                    battery_w - screened.auxiliary_w[i] - torque * omega,
                    torque * torque,
                    torque.abs(),
                    omega * omega,
                    torque * omega,
                    omega * torque.signum(),
                    f64::from(u8::from(v > 0.0)),
                    battery_w,
                ],
            );
            if trip.throttle[i] < RELEASED && torque < 0.0 {
                released.push((v, torque));
            }
            let (before, after) = (i.saturating_sub(1), (i + 1).min(n - 1));
            let span_s = trip.time_s[after] - trip.time_s[before];
            let smooth_nm = smooth_nm[i];
            if near_brake[i] || span_s > GAP_S || smooth_nm.is_nan() {
                road.spoil(time_s);
                continue;
            }
            road.add(
                time_s,
                [
                    smooth_nm,
                    smooth_nm.abs(),
                    v,
                    (speed[after] - speed[before]) / span_s,
                    f64::from(row.grade.sin),
                    0.5 * f64::from(row.air_density_factor) * known.air_kg_m3 * v * v,
                    (-distance[i] / known.warm_up_m).exp(),
                ],
            );
        }
        standing.sort_unstable_by(f64::total_cmp);
        let standing_w = (standing.len() >= LEAST_STANDING).then(|| standing[standing.len() / 2]);
        Self {
            ambient_c: mean(trip.ambient_c.iter().copied()),
            road: road.means(|m| OnRoad {
                torque_nm: m[0],
                torque_size_nm: m[1],
                speed_m_s: m[2],
                acceleration_m_s2: m[3],
                slope_sin: m[4],
                pressure_n_m2: m[5],
                cold: m[6],
            }),
            drive: drive.means(|m| OfDrive {
                rest_w: m[0],
                torque_squared: m[1],
                torque_size_nm: m[2],
                speed_squared: m[3],
                power_w: m[4],
                signed_speed_rad_s: m[5],
                moving: m[6],
                battery_w: m[7],
            }),
            standing_w,
            released,
            doubts,
            trip,
        }
    }
}

/// Where a friction brake may act beside the motor, or has within the reach of the smoothing: with
/// the pedal released and a torque that slows down, and at standstill.
fn near_brake(trip: &Trip, speed_m_s: &[f64], smoothing_s: f64) -> Vec<bool> {
    let reach_s = smooth::REACH * smoothing_s + SETTLED_S;
    let brakes = |i: usize| {
        let pressed = trip.throttle[i] >= RELEASED;
        speed_m_s[i] < ROLLING_M_S || trip.motor_torque_nm[i] < 0.0 && !pressed
    };
    let mut near = vec![false; trip.len()];
    let mut last_s = f64::NEG_INFINITY;
    for (i, near) in near.iter_mut().enumerate() {
        if brakes(i) {
            last_s = trip.time_s[i];
        }
        *near = trip.time_s[i] - last_s <= reach_s;
    }
    let mut next_s = f64::INFINITY;
    for (i, near) in near.iter_mut().enumerate().rev() {
        if brakes(i) {
            next_s = trip.time_s[i];
        }
        *near |= next_s - trip.time_s[i] <= reach_s;
    }
    near
}

/// Sums over windows of equal length.
struct Windows<const N: usize> {
    length_s: f64,
    /// Number of the window, sums, count; a count of none is a window that does not count.
    open: Option<(f64, [f64; N], f64)>,
    spoilt: f64,
    done: Vec<[f64; N]>,
}

impl<const N: usize> Windows<N> {
    fn new(length_s: f64) -> Self {
        Self { length_s, open: None, spoilt: f64::NEG_INFINITY, done: Vec::new() }
    }

    fn add(&mut self, time_s: f64, values: [f64; N]) {
        let number = (time_s / self.length_s).floor();
        if self.open.is_none_or(|(open, ..)| open != number) {
            self.close();
            self.open = Some((number, [0.0; N], 0.0));
        }
        if let Some((_, sums, count)) = &mut self.open {
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
            *count += 1.0;
        }
    }

    /// The window of this instant does not count.
    fn spoil(&mut self, time_s: f64) {
        self.spoilt = (time_s / self.length_s).floor();
        if self.open.is_some_and(|(open, ..)| open != self.spoilt) {
            self.close();
        }
        self.open = None;
    }

    fn close(&mut self) {
        if let Some((number, sums, count)) = self.open.take()
            && number != self.spoilt
        {
            self.done.push(sums.map(|sum| sum / count));
        }
    }

    fn means<T>(mut self, of: impl Fn([f64; N]) -> T) -> Vec<T> {
        self.close();
        self.done.into_iter().map(of).collect()
    }
}
