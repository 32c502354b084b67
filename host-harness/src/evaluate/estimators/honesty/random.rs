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
