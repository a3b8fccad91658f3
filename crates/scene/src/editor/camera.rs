//! Camera rules: commands that depend on the viewport's shape, or that must not change what is in view.

use glam::Vec3;

use super::Editor;
use crate::frame::{current_orbit, travelled};
use crate::library::ClipId;
use crate::state::{
    CameraChoice, CameraOptions, Command, OrbitCamera, ViewerState, active_clip, automatic_camera, comparison,
    comparison_ratio, frame_all, looks_past, resolved_bounds, sees_all,
};

/// What a camera that the user has moved looks at.
pub(super) struct LookedAt {
    /// The active clip.
    clip: Option<ClipId>,
    /// See [`Editor::body_place`].
    body: Vec3,
    /// See [`Editor::followed_travel`].
    travel: Vec3,
}

impl Editor {
    /// Returns what the viewport shows if the camera is automatic, or stands in for an automatic one.
    pub(super) fn automatic_view(&self) -> Option<OrbitCamera> {
        let is_held = |orbit| self.held_camera == Some(orbit);
        match self.state.camera {
            CameraChoice::Auto => Some(automatic_camera(&self.library, &self.state, self.aspect)),
            CameraChoice::Orbit(orbit) if is_held(orbit) => Some(orbit),
            _ => None,
        }
    }

    /// Holds the view of an automatic camera when an option changes what it would frame. The camera becomes automatic
    /// again as soon as that is the same, or if what plays has left the view.
    pub(super) fn hold_view(&mut self, before: OrbitCamera) {
        let is_same = automatic_camera(&self.library, &self.state, self.aspect) == before;
        let holds = !is_same && sees_all(&before, &self.library, &self.state, self.aspect);
        self.hold(holds.then_some(before));
        if !is_same && !holds {
            self.suit_automatic_follow();
        }
    }

    /// Holds it even if what is dragged by hand leaves the view.
    pub(super) fn hold_still(&mut self, before: OrbitCamera) {
        let is_same = automatic_camera(&self.library, &self.state, self.aspect) == before;
        self.hold((!is_same).then_some(before));
    }

    /// Holds this view of an automatic camera; none: it frames what plays.
    pub(super) fn hold(&mut self, held: Option<OrbitCamera>) {
        self.held_camera = held;
        let camera = held.map_or(CameraChoice::Auto, CameraChoice::Orbit);
        if self.state.camera != camera {
            self.record(Command::SetCamera(camera));
        }
    }

    /// Makes a held camera automatic again.
    fn release_view(&mut self) {
        if self.automatic_view().is_some() && self.held_camera.take().is_some() {
            self.record(Command::SetCamera(CameraChoice::Auto));
        }
    }

    /// Prepares the camera for a command, and returns the command to apply.
    pub(super) fn prepare_camera(&mut self, command: Command) -> Command {
        if matches!(command, Command::SetClip(_) | Command::FrameAll) {
            self.release_view();
        }
        let is_auto = self.state.camera == CameraChoice::Auto;
        let has_turntable = self.state.camera_options.turntable != 0.0;
        // Grabbing the scene or a joint stops the turntable.
        let grabs = matches!(
            command,
            Command::Orbit { .. } | Command::Pan { .. } | Command::SetPose { .. } | Command::SetPin { .. }
        );
        if grabs && has_turntable {
            self.record(Command::SetTurntable(0.0));
        }
        if let Some(orbit) = self.compensated_camera(&command) {
            self.record(Command::SetCamera(CameraChoice::Orbit(orbit)));
        }
        // The automatic camera depends on the viewport's shape, and the file's cameras on the pose; commands know neither.
        let is_relative = match command {
            Command::Orbit { .. } | Command::Pan { .. } | Command::Zoom { .. } => true,
            Command::FrameAll => !is_auto,
            Command::Advance(_) => has_turntable && is_auto,
            _ => false,
        };
        if is_relative && !matches!(self.state.camera, CameraChoice::Orbit(_)) {
            let orbit = current_orbit(&self.library, &self.state, self.aspect);
            self.record(Command::SetCamera(CameraChoice::Orbit(orbit)));
        }
        if matches!(command, Command::FrameAll) && !is_auto {
            return Command::SetCamera(CameraChoice::Orbit(frame_all(&self.library, &self.state, self.aspect)));
        }
        command
    }

    /// Returns the orbit camera that keeps the view unchanged by the command; `None` if the current one does.
    fn compensated_camera(&self, command: &Command) -> Option<OrbitCamera> {
        let CameraChoice::Orbit(orbit) = self.state.camera else { return None };
        match *command {
            Command::SetInspect(inspect) if inspect != self.state.inspect => {
                let after = ViewerState { inspect, ..self.state.clone() };
                let [before, after] = [&self.state, &after].map(|state| comparison(&self.library, state));
                let ratio = comparison_ratio(before, after, self.aspect);
                (ratio != 1.0).then_some(OrbitCamera { distance: ratio * orbit.distance, ..orbit })
            }
            Command::SetFollow(follow) if follow != self.state.camera_options.follow => {
                let travel = travelled(&self.library, &self.state);
                let target = if follow { orbit.target - travel } else { orbit.target + travel };
                Some(OrbitCamera { target, ..orbit })
            }
            _ => None,
        }
    }

    /// Returns what a camera that the user has moved looks at.
    pub(super) fn looked_at(&self) -> Option<LookedAt> {
        match self.state.camera {
            CameraChoice::Orbit(orbit) if self.held_camera != Some(orbit) => {
                let (clip, body, travel) = (self.active_clip(), self.body_place(), self.followed_travel());
                Some(LookedAt { clip, body, travel })
            }
            _ => None,
        }
    }

    /// Moves such a camera along if another clip is somewhere else, or if an edit has moved the body out of its view: its direction
    /// and distance from the character stay.
    pub(super) fn keep_looking(&mut self, before: LookedAt) {
        /// Of the camera's distance: what moves by less stays in view.
        const MIN_SHIFT: f32 = 0.25;
        let CameraChoice::Orbit(orbit) = self.state.camera else { return };
        let is_other_clip = self.active_clip() != before.clip;
        if !is_other_clip && !looks_past(&self.library, &self.state, self.aspect) {
            return;
        }
        if is_other_clip && self.suits_follow {
            self.suit_follow();
        }
        let shift = (self.body_place() - before.body) * Vec3::new(1.0, 0.0, 1.0);
        let shift = if shift.length() > MIN_SHIFT * orbit.distance { shift } else { Vec3::ZERO };
        let shift = shift + before.travel - self.followed_travel();
        if shift != Vec3::ZERO {
            let target = orbit.target + shift;
            self.record(Command::SetCamera(CameraChoice::Orbit(OrbitCamera { target, ..orbit })));
        }
    }

    /// Returns the travel that is added to an orbit camera.
    fn followed_travel(&self) -> Vec3 {
        if self.state.camera_options.follow { travelled(&self.library, &self.state) } else { Vec3::ZERO }
    }

    /// Returns the middle of the body's space in the active clip, where the body is now.
    fn body_place(&self) -> Vec3 {
        let camera_options = CameraOptions { follow: true, ..self.state.camera_options };
        let following = ViewerState { camera_options, ..self.state.clone() };
        resolved_bounds(&self.library, &following).center() + travelled(&self.library, &self.state)
    }

    fn active_clip(&self) -> Option<ClipId> {
        Some(active_clip(self.library.active()?, &self.state)?.id().clone())
    }

    pub(super) fn notify_follow(&mut self, command: &Command) {
        if let Command::SetFollow(follow) = *command
            && follow != self.state.camera_options.follow
        {
            let text = if follow { "The camera follows the character." } else { "The camera stays where it is." };
            self.notify(text.to_owned());
        }
    }
}
