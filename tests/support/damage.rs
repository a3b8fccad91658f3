//! Damaged files, the same on every run.

/// The state of the random numbers (xorshift).
pub struct Damage(u64);

impl Damage {
    pub fn new() -> Self {
        Self(0x9E37_79B9_7F4A_7C15)
    }

    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % limit as u64) as usize
    }

    /// Returns a copy with up to three flipped bits, overwritten bytes or a lost end.
    pub fn of(&mut self, file: &[u8]) -> Vec<u8> {
        let mut damaged = file.to_vec();
        for _ in 0..=self.below(3) {
            let at = self.below(damaged.len());
            match self.below(4) {
                0 => damaged.truncate(at.max(12)),
                1 => damaged[at] = [0, 0x7F, 0xFF][self.below(3)],
                _ => damaged[at] ^= 1 << self.below(8),
            }
        }
        damaged
    }
}

/// How many times to damage each file: `CASES`, or 200.
pub fn cases() -> usize {
    std::env::var("CASES").map_or(200, |cases| cases.parse().unwrap())
}
