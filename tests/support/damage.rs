//! Damaged files, the same on every run.

#[path = "random.rs"]
mod random;

use random::Random;

/// Damages files at random places.
pub struct Damage(Random);

impl Damage {
    pub fn new() -> Self {
        Self(Random(1))
    }

    /// Returns a copy with up to three flipped bits, overwritten bytes or truncations.
    pub fn of(&mut self, file: &[u8]) -> Vec<u8> {
        let mut damaged = file.to_vec();
        for _ in 0..=self.0.below(3) {
            let at = self.0.below(damaged.len());
            match self.0.below(4) {
                0 => damaged.truncate(at.max(12)),
                1 => damaged[at] = [0, 0x7F, 0xFF][self.0.below(3)],
                _ => damaged[at] ^= 1 << self.0.below(8),
            }
        }
        damaged
    }
}

/// How many times to damage each file: `CASES`, or 200.
pub fn cases() -> usize {
    std::env::var("CASES").map_or(200, |cases| cases.parse().unwrap())
}
