//! Noise that is the same on every machine.

/// Xorshift noise (Marsaglia 2003), so that no random library's version changes what is made of it.
pub(crate) struct Noise(u64);

impl Noise {
    /// The sequence from a state on, which must not be 0.
    pub(crate) const fn from_state(state: u64) -> Self {
        Self(state)
    }

    /// A sequence of its own for each seed.
    pub(crate) fn new(seed: u64) -> Self {
        // Never 0, and near seeds far apart.
        let mut noise = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        for _ in 0..8 {
            noise.even();
        }
        noise
    }

    /// Evenly in 0..n, a place in a list.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_precision_loss,
        clippy::cast_sign_loss,
        reason = "a place in a short list, not negative"
    )]
    pub(crate) fn below(&mut self, n: usize) -> usize {
        ((self.even() * n as f32) as usize).min(n - 1)
    }

    /// Evenly in 0..1.
    #[expect(clippy::cast_precision_loss, reason = "24 bits")]
    pub(crate) fn even(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / 16_777_216.0
    }

    /// Close to normal, of mean 0 and standard deviation 1.
    pub(crate) fn normal(&mut self) -> f32 {
        (0..12).map(|_| self.even()).sum::<f32>() - 6.0
    }
}
