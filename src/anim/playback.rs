//! From a running playhead to a time inside a clip. No clock: whoever has one advances the playhead.

use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LoopMode {
    Once,
    #[default]
    Loop,
    PingPong,
}

/// In and out points within a clip, in seconds, `start <= end`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TimeRange {
    pub start_secs: f64,
    pub end_secs: f64,
}

impl TimeRange {
    pub fn length_secs(self) -> f64 {
        self.end_secs - self.start_secs
    }
}

/// Clip time for a playhead that runs freely (it may be negative, or many loops on). The playhead and the result are in
/// clip seconds: inside the range they are equal. `Once` clamps; a range without length gives its start.
pub fn clip_time(playhead_secs: f64, range: TimeRange, mode: LoopMode) -> f64 {
    let length = range.length_secs();
    if !playhead_secs.is_finite() || length <= 0.0 {
        return range.start_secs;
    }
    let offset = playhead_secs - range.start_secs;
    let inside = match mode {
        LoopMode::Once => offset.clamp(0.0, length),
        // The out point itself is shown, so that scrubbing to the end does not jump to the start.
        LoopMode::Loop if (0.0..=length).contains(&offset) => offset,
        LoopMode::Loop => offset.rem_euclid(length),
        LoopMode::PingPong => {
            let phase = offset.rem_euclid(2.0 * length);
            if phase <= length { phase } else { 2.0 * length - phase }
        }
    };
    range.start_secs + inside
}
