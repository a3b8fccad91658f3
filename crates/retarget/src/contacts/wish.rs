//! What contacts ask the end of a limb to do.

use glam::DVec3;

/// How far the end of one limb should move: a weighted least-squares fit.
#[derive(Debug, Clone, Copy, Default)]
pub struct Wish {
    sum: DVec3,
    squares: f64,
    /// How much the most urgent point wants it.
    share: f64,
}

impl Wish {
    /// Adds what a point wants that moves by `lever` as far as the limb's end.
    pub fn add(&mut self, by: DVec3, lever: f64, weight: f64, share: f64) {
        self.sum += weight * lever * by;
        self.squares += weight * lever * lever;
        self.share = self.share.max(share);
    }

    /// Adds another wish for the same limb.
    pub fn join(&mut self, other: Self, weight: f64) {
        self.sum += weight * other.sum;
        self.squares += weight * other.squares;
        self.share = self.share.max(other.share);
    }

    /// The move that fits best, and how much it is wanted, from 0 to 1.
    pub fn fit(self) -> (DVec3, f64) {
        if self.squares > 0.0 { (self.sum / self.squares, self.share) } else { (DVec3::ZERO, 0.0) }
    }
}
