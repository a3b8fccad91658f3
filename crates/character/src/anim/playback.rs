//! Maps a running playhead to a time inside a clip. Callers with a clock advance the playhead.

use serde::{Deserialize, Serialize};

/// What happens when the playhead leaves the range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LoopMode {
    /// Stops at the in and out points.
    Once,
    /// Wraps around to the other end.
    #[default]
    Loop,
    /// Alternates between forward and backward.
    PingPong,
}

/// In and out points within a clip, in seconds, `start <= end`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct TimeRange {
    /// In point.
    pub start_secs: f64,
    /// Out point.
    pub end_secs: f64,
}

impl TimeRange {
    /// Length of the range.
    pub fn length_secs(self) -> f64 {
        self.end_secs - self.start_secs
    }
}

/// Returns the clip time of an unbounded playhead, which may be negative or many loops ahead. Both are in clip seconds
/// and equal inside the range. `Once` clamps; an empty range gives its start.
pub fn clip_time(playhead_secs: f64, range: TimeRange, mode: LoopMode) -> f64 {
    let length = range.length_secs();
    if !playhead_secs.is_finite() || length <= 0.0 {
        return range.start_secs;
    }
    let offset = playhead_secs - range.start_secs;
    let inside = match mode {
        LoopMode::Once => offset.clamp(0.0, length),
        // Includes the out point, so that scrubbing to the end does not jump to the start.
        LoopMode::Loop if (0.0..=length).contains(&offset) => offset,
        LoopMode::Loop => offset.rem_euclid(length),
        LoopMode::PingPong => {
            let phase = offset.rem_euclid(2.0 * length);
            if phase <= length { phase } else { 2.0 * length - phase }
        }
    };
    range.start_secs + inside
}
