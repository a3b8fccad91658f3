//! Frame times, for `window.gaitway.stats()` and the Info tab.

use gaitway_scene::library::ModelId;

use crate::ui::FrameTimes;

/// Zero until measured.
#[derive(Debug, Default)]
pub(super) struct Timing {
    /// Running mean of the time between consecutive frames.
    pub frame_secs: f32,
    /// CPU time of the last frame.
    pub cpu_secs: f32,
    /// Times between the last frames.
    pub recent: FrameTimes,
    /// The model that `recent` is of.
    model: Option<ModelId>,
    /// It has just replaced another one: the frame took as long as opening it.
    is_new: bool,
    /// Frames laid out so far; does not grow while nothing changes.
    pub frames: u64,
}

impl Timing {
    /// Forgets the last frames if they were of another model.
    pub fn begin_frame(&mut self, model: Option<ModelId>) {
        if std::mem::replace(&mut self.model, model) != model {
            (self.recent, self.is_new) = (FrameTimes::default(), true);
        }
    }

    /// Adds the time between two frames, unless it was a pause, such as that of a hidden page.
    pub fn record(&mut self, secs: f32) {
        const MAX_SECS: f32 = 1.0;
        const SMOOTHING: f32 = 0.1;
        if std::mem::take(&mut self.is_new) {
            return;
        }
        if secs < MAX_SECS {
            let weight = if self.frame_secs == 0.0 { 1.0 } else { SMOOTHING };
            self.recent.push(secs);
            self.frame_secs += weight * (secs - self.frame_secs);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_times_are_those_of_the_model_that_is_shown() {
        let mut timing = Timing::default();
        let times = |timing: &Timing| timing.recent.iter().collect::<Vec<_>>();
        for model in [ModelId(1), ModelId(2)] {
            for secs in [0.5, 0.01, 0.02] {
                timing.begin_frame(Some(model));
                timing.record(secs);
            }
            assert_eq!(times(&timing), [0.01, 0.02], "without the frame that opened {model:?}");
        }
    }
}
