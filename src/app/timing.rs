//! How long frames take, for `window.gaitway.stats()`.

/// Zero until measured.
#[derive(Debug, Default)]
pub(super) struct Timing {
    /// Running mean of the time between consecutive frames.
    pub frame_secs: f32,
    pub cpu_secs: f32,
    /// Frames laid out so far; stands still while nothing changes.
    pub frames: u64,
}

impl Timing {
    /// Pauses, such as a hidden page, do not count.
    pub fn count(&mut self, secs: f32) {
        const SHARE: f32 = 0.1;
        if secs < 1.0 {
            let share = if self.frame_secs == 0.0 { 1.0 } else { SHARE };
            self.frame_secs += share * (secs - self.frame_secs);
        }
    }
}
