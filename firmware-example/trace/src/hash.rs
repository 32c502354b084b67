//! FNV-1a with 64 bits: small, and the same in any language.

use plant_core::Accum;

/// A running FNV-1a hash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fnv1a(u64);

impl Default for Fnv1a {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv1a {
    /// Takes in the four bytes of a word, the lowest first.
    #[inline]
    pub fn word(&mut self, word: u32) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Takes in the value of a compensated sum and, exactly, what it holds back.
    #[inline]
    pub fn sum(&mut self, sum: Accum) {
        self.word(sum.get().to_bits());
        self.word(sum.since(Accum::new(sum.get())).to_bits());
    }

    /// The hash so far.
    #[must_use]
    pub const fn get(self) -> u64 {
        self.0
    }
}
