//! What is drawn for a seed.

/// Numbers that are the same for the same seed.
pub struct Random(fastrand::Rng);

impl Random {
    pub fn new(seed: u64) -> Self {
        let mut random = fastrand::Rng::with_seed(seed);
        for _ in 0..8 {
            random.f32();
        }
        Self(random)
    }

    /// Even in 0..1.
    pub fn even(&mut self) -> f32 {
        self.0.f32()
    }

    /// The same, with more digits.
    pub fn even_f64(&mut self) -> f64 {
        self.0.f64()
    }

    /// One way or the other.
    pub fn coin(&mut self) -> bool {
        self.0.bool()
    }

    /// A whole number of a range.
    pub fn count(&mut self, range: std::ops::Range<u32>) -> u32 {
        self.0.u32(range)
    }

    /// One of some.
    pub fn one_of<T: Copy>(&mut self, some: &[T]) -> T {
        some[self.0.usize(0..some.len())]
    }

    /// Of the normal distribution (`BoxMuller1958`).
    pub fn normal(&mut self) -> f32 {
        let radius = (-2.0 * (1.0 - self.0.f32()).ln()).sqrt();
        radius * (std::f32::consts::TAU * self.0.f32()).cos()
    }
}
