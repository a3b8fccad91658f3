//! The user's preference for reduced motion: views start paused and without turntable until the user starts them. It never gets
//! into links.

use super::Editor;
use super::{Admit, Contents};
use crate::state::{Command, Overridden, ViewerState};

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ReducedMotion {
    is_preferred: bool,
    /// Of the current view.
    pub overridden: Overridden,
}

impl Editor {
    /// Sets whether views start calmly from now on.
    pub fn prefer_reduced_motion(&mut self, is_preferred: bool) {
        self.reduced_motion.is_preferred = is_preferred;
    }

    /// Returns the state for links: as it is, except that the preference for reduced motion leaves no trace.
    pub fn shared_state(&self) -> ViewerState {
        let mut state = self.state.clone();
        let Overridden { playing, turntable } = self.reduced_motion.overridden;
        state.playback.playing = playing.unwrap_or(state.playback.playing);
        state.camera_options.turntable = turntable.unwrap_or(state.camera_options.turntable);
        state
    }

    /// Calms a view that is about to replace the state.
    pub(super) fn calmed_view(&mut self, mut view: ViewerState) -> ViewerState {
        let is_preferred = self.reduced_motion.is_preferred;
        self.reduced_motion.overridden = if is_preferred { view.calm() } else { Overridden::default() };
        view
    }

    /// Opens the files that a change of the current view needs, in the changed view. Unlike a link, it doesn't stop what
    /// the user has started.
    ///
    /// # Errors
    /// As [`Editor::open`].
    pub fn open_change(&mut self, contents: Contents, view: ViewerState, admit: Admit<'_>) -> Result<(), String> {
        let Overridden { playing, turntable } = self.reduced_motion.overridden;
        let (plays, turns) = self.moving_parts();
        let keeps_playing = playing.is_none() && plays == view.playback.playing;
        let keeps_turning = turntable.is_none() && turns == view.camera_options.turntable;
        self.open(contents, Some(view), admit)?;
        if keeps_playing {
            (self.state.playback.playing, self.reduced_motion.overridden.playing) = (plays, None);
        }
        if keeps_turning {
            (self.state.camera_options.turntable, self.reduced_motion.overridden.turntable) = (turns, None);
        }
        Ok(())
    }

    /// Calms the view of a command that replaces the state.
    pub(super) fn calmed(&mut self, command: Command) -> Command {
        match command {
            Command::Replace(view) => {
                let view = self.calmed_view(*view);
                self.held_camera = None;
                // Set before the command is recorded, so that it doesn't count as the user's own change.
                let calm = (view.playback.playing, view.camera_options.turntable);
                (self.state.playback.playing, self.state.camera_options.turntable) = calm;
                Command::Replace(Box::new(view))
            }
            command => command,
        }
    }

    pub(super) fn moving_parts(&self) -> (bool, f32) {
        (self.state.playback.playing, self.state.camera_options.turntable)
    }

    /// Drops the override of what the user has set since.
    pub(super) fn note_moving_parts(&mut self, (playing, turntable): (bool, f32)) {
        let now = self.moving_parts();
        let overridden = &mut self.reduced_motion.overridden;
        overridden.playing.take_if(|_| now.0 != playing);
        overridden.turntable.take_if(|_| now.1 != turntable);
    }
}
