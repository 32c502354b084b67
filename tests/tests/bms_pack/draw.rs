//! Inputs, made up.

use plant_core::Real;
use plant_core::battery::OpenCircuit;
use plant_core::num::{LARGEST, SocTable};
use proptest::prelude::*;

/// The settings of a property that runs `of_256` cases where the default is 256.
pub fn cases(of_256: u32) -> ProptestConfig {
    let default = ProptestConfig::default();
    let cases = (default.cases * of_256).div_ceil(256);
    ProptestConfig { cases, failure_persistence: None, ..default }
}

/// Any bit pattern, the awkward ones often, values that make sense oftener.
pub fn any_bits(plausible: impl Strategy<Value = Real> + 'static) -> BoxedStrategy<Real> {
    let awkward = [
        0.0,
        -0.0,
        LARGEST,
        -LARGEST * 1.000_001,
        Real::NAN,
        Real::INFINITY,
        Real::NEG_INFINITY,
        Real::MAX,
        Real::MIN_POSITIVE,
        Real::from_bits(1),
    ];
    prop_oneof![
        4 => plausible,
        1 => any::<u32>().prop_map(Real::from_bits),
        1 => prop::sample::select(awkward.to_vec()),
    ]
    .boxed()
}

/// Evenly spread over the decades of `from..to`.
pub fn log(from: f64, to: f64) -> impl Strategy<Value = Real> {
    (from.ln()..to.ln()).prop_map(|x| x.exp() as Real)
}

/// A cell's curve that rises somehow from 2.5 V, flat stretches included.
pub fn curve() -> impl Strategy<Value = OpenCircuit> {
    let rise = prop_oneof![1 => Just(0.0), 1 => Just(0.001), 2 => 0.01..0.3_f32];
    prop::collection::vec(rise, 10).prop_map(|rises| {
        let mut points = vec![(0.0, 2.5)];
        for (i, rise) in rises.iter().enumerate() {
            points.push(((i + 1) as Real / 10.0, points[i].1 + rise));
        }
        OpenCircuit::Table(SocTable::from_points("curve", &points).unwrap())
    })
}

/// Normally distributed numbers, the same for the same seed.
pub struct Normal(pub u64);

impl Normal {
    fn uniform(&mut self) -> f64 {
        // Knuth's constants for a linear congruential generator; the upper bits are the good ones.
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// With a standard deviation of `sd`.
    pub fn next(&mut self, sd: f64) -> f64 {
        sd * ((0..12).map(|_| self.uniform()).sum::<f64>() - 6.0)
    }
}

/// How often truth lies within three standard deviations, and the error over the standard
/// deviation, root mean square.
#[derive(Clone, Copy, Debug, Default)]
pub struct Honesty {
    count: u32,
    inside: u32,
    squares: f64,
}

impl Honesty {
    pub fn book(&mut self, error: f64, sd: f64) {
        self.count += 1;
        self.inside += u32::from(error.abs() <= 3.0 * sd);
        self.squares += (error / sd).powi(2);
    }

    pub const fn count(&self) -> u32 {
        self.count
    }

    pub fn share_inside(&self) -> f64 {
        f64::from(self.inside) / f64::from(self.count)
    }

    pub fn rms(&self) -> f64 {
        (self.squares / f64::from(self.count)).sqrt()
    }
}
