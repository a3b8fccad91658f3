//! The user's preference for reduced motion: views start paused and without turntable until the user starts them. It never gets
//! into links.

use super::Editor;
use crate::state::{Command, ViewerState};

/// What the view says about motion while the preference overrides it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ReducedMotion {
    is_preferred: bool,
    playing: Option<bool>,
    turntable: Option<f32>,
}

impl Editor {
    /// Sets whether views start calmly from now on.
    pub fn prefer_reduced_motion(&mut self, is_preferred: bool) {
        self.reduced_motion.is_preferred = is_preferred;
    }

    /// Returns the state for links: as it is, except that the preference for reduced motion leaves no trace.
    pub fn shared_state(&self) -> ViewerState {
        let mut state = self.state.clone();
        let ReducedMotion { playing, turntable, .. } = self.reduced_motion;
        state.playback.playing = playing.unwrap_or(state.playback.playing);
        state.camera_options.turntable = turntable.unwrap_or(state.camera_options.turntable);
        state
    }

    /// Calms a view that is about to replace the state.
    pub(super) fn calmed_view(&mut self, view: ViewerState) -> ViewerState {
        let is_preferred = self.reduced_motion.is_preferred;
        self.reduced_motion = ReducedMotion { is_preferred, ..ReducedMotion::default() };
        if !is_preferred {
            return view;
        }
        self.reduced_motion.playing = Some(view.playback.playing);
        self.reduced_motion.turntable = Some(view.camera_options.turntable);
        view.calmed()
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

    /// Drops the override: another view is back.
    pub(super) fn forget_overridden_motion(&mut self) {
        self.reduced_motion =
            ReducedMotion { is_preferred: self.reduced_motion.is_preferred, ..ReducedMotion::default() };
    }

    pub(super) fn moving_parts(&self) -> (bool, f32) {
        (self.state.playback.playing, self.state.camera_options.turntable)
    }

    /// Drops the override of what the user has set since.
    pub(super) fn note_moving_parts(&mut self, (playing, turntable): (bool, f32)) {
        let now = self.moving_parts();
        self.reduced_motion.playing.take_if(|_| now.0 != playing);
        self.reduced_motion.turntable.take_if(|_| now.1 != turntable);
    }
}
