//! Frame times, for `window.gaitway.stats()`.

/// Zero until measured.
#[derive(Debug, Default)]
pub(super) struct Timing {
    /// Running mean of the time between consecutive frames.
    pub frame_secs: f32,
    pub cpu_secs: f32,
    /// Frames laid out so far; does not grow while nothing changes.
    pub frames: u64,
}

impl Timing {
    /// Adds a frame time to the mean; ignores pauses, such as a hidden page.
    pub fn record(&mut self, secs: f32) {
        const SMOOTHING: f32 = 0.1;
        if secs < 1.0 {
            let weight = if self.frame_secs == 0.0 { 1.0 } else { SMOOTHING };
            self.frame_secs += weight * (secs - self.frame_secs);
        }
    }
}
