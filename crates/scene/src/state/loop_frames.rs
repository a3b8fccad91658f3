//! The frames of a video that shows one loop of the active clip. Their times depend only on the view, not on a clock.

use gaitway_character::anim::LoopMode;

use super::playhead::{active_clip, play_range};
use super::{CameraChoice, Command, ViewerState, apply, resolve_camera};
use crate::library::Library;

/// One loop of the active clip, divided into frames of equal duration.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopFrames {
    first: ViewerState,
    frames_per_sec: u32,
    count: u32,
}

impl LoopFrames {
    /// Maximum number of frames to draw, more than four hours at 60 a second: a damaged file may have a clip of a thousand years.
    pub const MAX_COUNT: u32 = 1_000_000;

    /// Starts at the in point, with the loop mode and speed of the view; `None` if there is nothing to play. `aspect` is the
    /// video's width over height.
    pub fn new(library: &Library, state: &ViewerState, aspect: f32, frames_per_sec: u32) -> Option<Self> {
        let model = library.active()?;
        let range = play_range(active_clip(model, state)?, state);
        let length_secs = range.length_secs() / state.playback.speed;
        if length_secs <= 0.0 {
            return None;
        }
        let frames_in = |secs: f64| (secs * f64::from(frames_per_sec)).round() as u32;
        let count = match state.playback.loop_mode {
            // Ends with the last pose. The other modes end before the first one is repeated.
            LoopMode::Once => frames_in(length_secs).saturating_add(1),
            LoopMode::Loop => frames_in(length_secs).max(1),
            LoopMode::PingPong => frames_in(2.0 * length_secs).max(1),
        };
        let mut first = state.clone();
        first.character.playhead.fade = None;
        apply(&mut first, library, Command::Seek(range.start_secs));
        apply(&mut first, library, Command::SetPlaying(true));
        if state.camera_options.turntable != 0.0 && state.camera == CameraChoice::Auto {
            // Otherwise the turntable would turn the camera of another aspect ratio.
            let orbit = resolve_camera(library, &first, aspect);
            apply(&mut first, library, Command::SetCamera(CameraChoice::Orbit(orbit)));
        }
        Some(Self { first, frames_per_sec, count })
    }

    /// Leaves out the grid and the shadow: they are partly transparent, and would leave specks where pixels are either opaque or
    /// transparent.
    pub fn without_ground(mut self) -> Self {
        let show = &mut self.first.display.show;
        (show.grid, show.shadow) = (false, false);
        self
    }

    /// Returns the number of frames.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Returns the view that a frame shows.
    pub fn state(&self, library: &Library, index: u32) -> ViewerState {
        let mut state = self.first.clone();
        let time_secs = f64::from(index) / f64::from(self.frames_per_sec);
        apply(&mut state, library, Command::Advance(time_secs));
        state
    }
}
