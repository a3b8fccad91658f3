//! The user's preference for reduced motion: views start paused and without turntable until the user starts them. It is
//! never written to links.

use super::{Admit, Contents, Editor};
use crate::state::{SavedMotion, ViewerState};

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ReducedMotion {
    is_preferred: bool,
    /// The current view's own settings.
    pub saved: SavedMotion,
}

impl Editor {
    /// Sets whether views start without motion from now on.
    pub fn prefer_reduced_motion(&mut self, is_preferred: bool) {
        self.reduced_motion.is_preferred = is_preferred;
    }

    /// Returns the state for links, without the effects of the preference for reduced motion.
    pub fn shared_state(&self) -> ViewerState {
        let mut state = self.state.clone();
        let SavedMotion { playing, turntable } = self.reduced_motion.saved;
        state.playback.playing = playing.unwrap_or(state.playback.playing);
        state.camera_options.turntable = turntable.unwrap_or(state.camera_options.turntable);
        state
    }

    /// Applies the preference to a view that is about to replace the state.
    pub(super) fn view_with_reduced_motion(&mut self, mut view: ViewerState) -> ViewerState {
        let is_preferred = self.reduced_motion.is_preferred;
        self.reduced_motion.saved = if is_preferred { view.reduce_motion() } else { SavedMotion::default() };
        view
    }

    /// Opens files together with a changed version of the current view that needs them. Unlike a link, the change
    /// doesn't stop motion that the user has started.
    ///
    /// # Errors
    /// As [`Editor::open`].
    pub fn open_change(&mut self, contents: Contents, view: ViewerState, admit: Admit<'_>) -> Result<(), String> {
        let SavedMotion { playing, turntable } = self.reduced_motion.saved;
        let (plays, turns) = self.moving_parts();
        let keeps_playing = playing.is_none() && plays == view.playback.playing;
        let keeps_turning = turntable.is_none() && turns == view.camera_options.turntable;
        self.open(contents, Some(view), admit)?;
        if keeps_playing {
            (self.state.playback.playing, self.reduced_motion.saved.playing) = (plays, None);
        }
        if keeps_turning {
            (self.state.camera_options.turntable, self.reduced_motion.saved.turntable) = (turns, None);
        }
        Ok(())
    }

    pub(super) fn moving_parts(&self) -> (bool, f32) {
        (self.state.playback.playing, self.state.camera_options.turntable)
    }

    /// Drops the override of what the user has set since.
    pub(super) fn note_moving_parts(&mut self, (playing, turntable): (bool, f32)) {
        let now = self.moving_parts();
        let saved = &mut self.reduced_motion.saved;
        saved.playing.take_if(|_| now.0 != playing);
        saved.turntable.take_if(|_| now.1 != turntable);
    }
}
