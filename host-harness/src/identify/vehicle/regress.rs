//! The regressions, one after the other; each takes what those before it found.

use anyhow::{Context, ensure};
use nalgebra::{Cholesky, DMatrix, DVector, Matrix4, Vector4};
use plant_core::num::GRAVITY_M_S2;

use super::samples::{Known, OfDrive, OnRoad, Prepared};
use crate::identify::fit;

/// Each pass takes the torque that the one before it expects: a torque that wind or a wrong height
/// made would be taken for a loss of the gear.
const PASSES: usize = 4;
/// From so many trips on the rolling resistance is a parabola over the air's temperature.
const PARABOLA: usize = 8;
/// Below this span the temperature tells nothing \[K\].
const TELLING_K: f64 = 5.0;
/// Where the rolling resistance is the vehicle's own \[°C\].
pub const REFERENCE_C: f64 = 15.0;
/// The strongest torque with a released pedal, as a share of the samples at a speed.
const STRONGEST: f64 = 0.05;
/// Samples are taken together over this speed \[m/s\]; fewer than so many tell nothing.
const BIN_M_S: f64 = 0.5;
const LEAST_IN_BIN: usize = 40;
/// Regeneration is whole where its torque has reached this share.
const WHOLE: f64 = 0.9;

/// What trips tell of a vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Mass with load \[kg\].
    pub mass_kg: f64,
    /// Drag coefficient times frontal area \[m²\].
    pub drag_area_m2: f64,
    /// Efficiency of the gear.
    pub efficiency: f64,
    /// What cold tyres add at the start \[N\].
    pub warm_up_n: f64,
    /// Rolling resistance with warm tyres over the air's temperature.
    pub rolling: Rolling,
    /// Drawn at standstill beside the auxiliary loads \[W\].
    pub base_w: f64,
    /// Its standard error: of a median, which leaving one trip out does not tell \[W\].
    pub base_error_w: f64,
    /// Losses per squared torque \[W/(N·m)²\], per torque \[W/(N·m)\], per squared speed
    /// \[W·s²\], while moving \[W\].
    pub losses: [f64; 4],
    /// Limits of regeneration, where a released pedal shows them.
    pub regeneration: Option<Regeneration>,
    /// Standard deviation over trips of the force that is left unexplained \[N\].
    pub unexplained_n: f64,
}

/// Rolling resistance over the temperature of the air: a polynomial, held beyond what was seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Rolling {
    /// Of powers of (temperature − 15 °C)/10 K \[N\].
    coefficients: Vec<f64>,
    /// Temperatures that were seen \[°C\].
    pub seen_c: (f64, f64),
}

/// How a car slows down with a released pedal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regeneration {
    /// Largest torque \[N·m\].
    pub torque_nm: f64,
    /// Largest mechanical power \[W\].
    pub power_w: f64,
    /// From this speed on the torque is whole \[m/s\].
    pub fade_m_s: f64,
}

impl Rolling {
    /// At a temperature of the air \[N\].
    pub fn at(&self, celsius: f64) -> f64 {
        let (low, high) = self.seen_c;
        powers(celsius.clamp(low, high)).iter().zip(&self.coefficients).map(|(p, c)| p * c).sum()
    }
}

fn powers(celsius: f64) -> [f64; 3] {
    let u = (celsius - REFERENCE_C) / 10.0;
    [1.0, u, u * u]
}

impl Found {
    /// From trips that can be trusted.
    ///
    /// # Errors
    /// They do not tell a vehicle.
    pub fn from(trips: &[&Prepared], known: &Known) -> anyhow::Result<Self> {
        let (base_w, base_error_w) = base(trips).unwrap_or((known.base_w, f64::NAN));
        let losses = losses(trips, base_w)?;
        let viscous = losses[2];
        let [mass_kg, drag_area_m2, warm_up_n, gear_loss] = road(trips, viscous, known)?;
        ensure!(mass_kg > 0.0 && gear_loss < 1.0, "the trips tell no mass and no loss of the gear");
        let forces: Vec<(Option<f64>, f64)> = (trips.iter())
            .filter_map(|trip| {
                let (mut sum, mut weights) = (0.0, 0.0);
                for s in &trip.road {
                    let [inertia, pressure, cold, gear] =
                        regressors(s, size_nm(s, viscous, known), known);
                    let rest = force(s, known)
                        - mass_kg * inertia
                        - drag_area_m2 * pressure
                        - warm_up_n * cold
                        - gear_loss * gear;
                    // Weighted by the distance, a force that is wrong leaves the energy right.
                    sum += s.speed_m_s * rest;
                    weights += s.speed_m_s;
                }
                (weights > 0.0).then(|| (trip.ambient_c, sum / weights))
            })
            .collect();
        let (rolling, unexplained_n) = rolling(&forces)?;
        Ok(Self {
            mass_kg,
            drag_area_m2,
            efficiency: 1.0 - gear_loss,
            warm_up_n,
            rolling,
            base_w,
            base_error_w,
            losses,
            regeneration: regeneration(trips, known),
            unexplained_n,
        })
    }

    /// How far the battery's energy is from what torque, speed, auxiliary and base load explain, as
    /// a share of what it exchanged: the measurement against itself.
    pub fn unexplained_energy(&self, trip: &Prepared) -> f64 {
        let (mut sum, mut all) = (0.0, 0.0);
        for s in &trip.drive {
            let lost: f64 = (OfLosses::new(s, self.losses[2]).0.iter())
                .zip(self.losses)
                .map(|(x, loss)| x * loss)
                .sum();
            sum += s.rest_w - self.base_w - lost;
            all += s.battery_w.abs();
        }
        sum.abs() / all
    }
}

/// The median over trips of what each draws at standstill, and its standard error.
fn base(trips: &[&Prepared]) -> Option<(f64, f64)> {
    let mut medians: Vec<f64> = trips.iter().filter_map(|t| t.standing_w).collect();
    medians.sort_unstable_by(f64::total_cmp);
    let count = medians.len();
    let middle = medians.get(count / 2)?;
    let below = medians.get(count.checked_sub(1)? / 2)?;
    #[expect(clippy::cast_precision_loss, reason = "a count")]
    let n = count as f64;
    let mean = medians.iter().sum::<f64>() / n;
    let variance = medians.iter().map(|w| (w - mean).powi(2)).sum::<f64>() / (n - 1.0);
    // Of a normal distribution a median scatters by √(π/2) more than a mean.
    let error = (0.5 * std::f64::consts::PI * variance / n).sqrt();
    Some(((0.5 * (middle + below)).max(0.0), error))
}

/// The drive's losses: least squares, none below zero. Its winding makes what friction takes from the
/// shaft too, so that the first pass finds the friction for the second.
fn losses(trips: &[&Prepared], base_w: f64) -> anyhow::Result<[f64; 4]> {
    let first = losses_with(trips, base_w, 0.0)?;
    losses_with(trips, base_w, first[2])
}

fn losses_with(trips: &[&Prepared], base_w: f64, viscous: f64) -> anyhow::Result<[f64; 4]> {
    let mut matrix = DMatrix::zeros(4, 4);
    let mut goal = DVector::zeros(4);
    for s in trips.iter().flat_map(|t| &t.drive).filter(|s| s.moving > 0.0) {
        let x = OfLosses::new(s, viscous).0;
        let y = s.rest_w - base_w;
        for i in 0..4 {
            for j in 0..4 {
                matrix[(i, j)] += x[i] * x[j];
            }
            goal[i] += x[i] * y;
        }
    }
    let found = fit::non_negative(&matrix, &goal, &[0, 1, 2, 3])
        .context("the trips tell no losses of the drive")?;
    Ok([found[0], found[1], found[2], found[3]])
}

/// What stands beside the losses.
struct OfLosses([f64; 4]);

impl OfLosses {
    /// With a friction at the shaft of `viscous` \[N·m·s\].
    fn new(s: &OfDrive, viscous: f64) -> Self {
        let squared =
            s.torque_squared + 2.0 * viscous * s.power_w + viscous * viscous * s.speed_squared;
        let size = s.torque_size_nm + viscous * s.signed_speed_rad_s;
        Self([squared, size, s.speed_squared, s.moving])
    }
}

/// The size of the torque that the winding makes, friction included \[N·m\].
fn size_nm(s: &OnRoad, viscous: f64, known: &Known) -> f64 {
    s.torque_size_nm + viscous * known.rad_per_m * s.speed_m_s * s.torque_nm.signum()
}

/// What stands beside mass, drag area, cold tyres and loss of the gear.
fn regressors(s: &OnRoad, torque_size_nm: f64, known: &Known) -> [f64; 4] {
    [
        s.acceleration_m_s2 + f64::from(GRAVITY_M_S2) * s.slope_sin,
        s.pressure_n_m2,
        s.cold,
        known.rad_per_m * torque_size_nm,
    ]
}

/// The motor's force at the road, less what turns itself takes \[N\].
fn force(s: &OnRoad, known: &Known) -> f64 {
    known.rad_per_m * s.torque_nm - known.turning_kg * s.acceleration_m_s2
}

/// Mass, drag area, force of cold tyres, loss of the gear: from changes within each trip, so that
/// what differs between trips (wind, load, tyres) does not enter.
fn road(trips: &[&Prepared], viscous: f64, known: &Known) -> anyhow::Result<[f64; 4]> {
    let mut found: Option<Vector4<f64>> = None;
    for _ in 0..PASSES {
        let mut matrix = Matrix4::zeros();
        let mut goal = Vector4::zeros();
        for trip in trips {
            #[expect(clippy::cast_precision_loss, reason = "a count")]
            let n = trip.road.len() as f64;
            if n < 1.0 {
                continue;
            }
            let constant_n = found.map_or(0.0, |p| {
                let rest = |s: &OnRoad| {
                    force(s, known)
                        - p.dot(&Vector4::from(regressors(s, size_nm(s, viscous, known), known)))
                };
                trip.road.iter().map(rest).sum::<f64>() / n
            });
            let rows: Vec<(Vector4<f64>, f64)> = (trip.road.iter())
                .map(|s| {
                    let size = found.map_or_else(
                        || size_nm(s, viscous, known),
                        |p| expected(s, &p, constant_n, viscous, known),
                    );
                    (Vector4::from(regressors(s, size, known)), force(s, known))
                })
                .collect();
            let mean_x = rows.iter().map(|(x, _)| x).sum::<Vector4<f64>>() / n;
            let mean_y = rows.iter().map(|(_, y)| y).sum::<f64>() / n;
            for (x, y) in rows {
                let x = x - mean_x;
                matrix += x * x.transpose();
                goal += x * (y - mean_y);
            }
        }
        let units = Vector4::from_fn(|i, _| 1.0 / matrix[(i, i)].sqrt().max(1e-150));
        let scaled = Matrix4::from_fn(|i, j| matrix[(i, j)] * units[i] * units[j]);
        ensure!(
            Cholesky::new(scaled).is_some_and(|f| f.determinant() > 1e-9),
            "the trips tell no mass, drag and losses apart: speed and height must vary"
        );
        // Neither the air, nor cold tyres, nor a gear push.
        let matrix = DMatrix::from_iterator(4, 4, matrix.iter().copied());
        let goal = DVector::from_iterator(4, goal.iter().copied());
        let solved = fit::non_negative(&matrix, &goal, &[0, 1, 2, 3])?;
        found = Some(Vector4::from_iterator(solved));
    }
    Ok(found.context("no pass")?.into())
}

/// The size of the torque that what was found so far expects.
fn expected(s: &OnRoad, p: &Vector4<f64>, constant_n: f64, viscous: f64, known: &Known) -> f64 {
    let [inertia, pressure, cold, _] = regressors(s, 0.0, known);
    let force_n = p[0] * inertia
        + known.turning_kg * s.acceleration_m_s2
        + p[1] * pressure
        + p[2] * cold
        + constant_n
        + viscous * known.rad_per_m.powi(2) * s.speed_m_s;
    let through = if force_n > 0.0 { 1.0 - p[3] } else { 1.0 + p[3] };
    (force_n / (known.rad_per_m * through)).abs()
}

/// The rolling resistance over the temperature, and what it leaves unexplained.
fn rolling(forces: &[(Option<f64>, f64)]) -> anyhow::Result<(Rolling, f64)> {
    let told: Vec<(f64, f64)> = forces.iter().filter_map(|(c, f)| Some(((*c)?, *f))).collect();
    let (low, high) = (told.iter())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (c, _)| {
            (low.min(*c), high.max(*c))
        });
    let (points, order): (Vec<(f64, f64)>, usize) = if high - low < TELLING_K || told.len() < 3 {
        (forces.iter().map(|(_, f)| (REFERENCE_C, *f)).collect(), 1)
    } else {
        let order = if told.len() < PARABOLA { 2 } else { 3 };
        (told, order)
    };
    let seen_c = if order == 1 { (REFERENCE_C, REFERENCE_C) } else { (low, high) };
    let n = points.len();
    ensure!(n >= order, "{n} trips tell no rolling resistance");
    let x = DMatrix::from_fn(n, order, |i, j| powers(points[i].0)[j]);
    let y = DVector::from_fn(n, |i, _| points[i].1);
    let coefficients = (x.transpose() * &x)
        .cholesky()
        .context("the trips' temperatures tell no rolling resistance")?
        .solve(&(x.transpose() * &y));
    let squares = (y - &x * &coefficients).norm_squared();
    #[expect(clippy::cast_precision_loss, reason = "counts")]
    let unexplained_n = (squares / (n.saturating_sub(order)).max(1) as f64).sqrt();
    let rolling = Rolling { coefficients: coefficients.iter().copied().collect(), seen_c };
    for c in [seen_c.0, REFERENCE_C, seen_c.1] {
        ensure!(rolling.at(c) > 0.0, "the trips tell no rolling resistance at {c:.0} °C");
    }
    Ok((rolling, unexplained_n))
}

/// The strongest torque of a released pedal over the speed.
fn regeneration(trips: &[&Prepared], known: &Known) -> Option<Regeneration> {
    let mut bins: Vec<Vec<f64>> = Vec::new();
    for (v, torque) in trips.iter().flat_map(|t| &t.released) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place")]
        let bin = (v / BIN_M_S).max(0.0) as usize;
        if bins.len() <= bin {
            bins.resize(bin + 1, Vec::new());
        }
        bins[bin].push(-torque);
    }
    let strongest: Vec<(f64, f64)> = (bins.iter_mut().enumerate())
        .filter(|(_, torques)| torques.len() >= LEAST_IN_BIN)
        .map(|(bin, torques)| {
            torques.sort_unstable_by(|a, b| b.total_cmp(a));
            #[expect(clippy::cast_precision_loss, reason = "counts")]
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place")]
            let (speed, at) =
                ((bin as f64 + 0.5) * BIN_M_S, (STRONGEST * torques.len() as f64) as usize);
            (speed, torques[at])
        })
        .collect();
    let most = |of: &dyn Fn(&(f64, f64)) -> f64| strongest.iter().map(of).reduce(f64::max);
    let torque_nm = most(&|(_, torque)| *torque)?;
    let power_w = most(&|(v, torque)| v * known.rad_per_m * torque)?;
    let fade_m_s = strongest.iter().find(|(_, torque)| *torque >= WHOLE * torque_nm)?.0;
    Some(Regeneration { torque_nm, power_w, fade_m_s })
}
