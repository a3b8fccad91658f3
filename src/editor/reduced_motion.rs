//! The user's wish for reduced motion. It stops what a view would set in motion, until the user starts it, and is no part of
//! the view: a link to share says what the view said.

use super::Editor;
use crate::state::{Command, ViewerState};

/// What the view says about motion while the wish overrides it.
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

    /// Returns the state for links: as it is, except that the wish for reduced motion leaves no trace.
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
                // Before it is noted as a change: it is none of the user's.
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

    /// What has been set since then no longer follows the view.
    pub(super) fn note_moving_parts(&mut self, (playing, turntable): (bool, f32)) {
        let now = self.moving_parts();
        self.reduced_motion.playing.take_if(|_| now.0 != playing);
        self.reduced_motion.turntable.take_if(|_| now.1 != turntable);
    }
}
