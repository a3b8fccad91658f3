//! Camera rules: commands that depend on the viewport's shape, or that must not change what is in view.

use glam::Vec3;

use super::Editor;
use crate::frame::{current_orbit, travelled};
use crate::library::ClipId;
use crate::state::{
    CameraChoice, Command, OrbitCamera, ViewerState, active_clip, automatic_camera, comparison, comparison_ratio,
    frame_all,
};

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
    /// again as soon as that is the same.
    pub(super) fn hold_view(&mut self, before: Option<OrbitCamera>) {
        let Some(before) = before else { return };
        let is_same = automatic_camera(&self.library, &self.state, self.aspect) == before;
        self.held_camera = (!is_same).then_some(before);
        let camera = self.held_camera.map_or(CameraChoice::Auto, CameraChoice::Orbit);
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

    /// Returns the active clip and where a camera that the user has moved and that follows the character finds it there. The
    /// automatic camera finds it anyway.
    pub(super) fn followed_place(&self) -> Option<(Option<ClipId>, Vec3)> {
        let follows = self.state.camera_options.follow && matches!(self.state.camera, CameraChoice::Orbit(_));
        follows.then(|| (self.active_clip(), self.automatic_target()))
    }

    /// Moves such a camera along if another clip is somewhere else: otherwise, it follows the character within a clip only.
    pub(super) fn follow_to_place(&mut self, before: Option<(Option<ClipId>, Vec3)>) {
        /// Of the camera's distance: what moves by less stays in view.
        const MIN_SHIFT: f32 = 0.25;
        let (Some((clip, before)), CameraChoice::Orbit(orbit)) = (before, self.state.camera) else { return };
        if self.active_clip() == clip {
            return;
        }
        let shift = (self.automatic_target() - before) * Vec3::new(1.0, 0.0, 1.0);
        if shift.length() > MIN_SHIFT * orbit.distance && self.held_camera != Some(orbit) {
            let target = orbit.target + shift;
            self.record(Command::SetCamera(CameraChoice::Orbit(OrbitCamera { target, ..orbit })));
        }
    }

    fn active_clip(&self) -> Option<ClipId> {
        Some(active_clip(self.library.active()?, &self.state)?.id().clone())
    }

    fn automatic_target(&self) -> Vec3 {
        automatic_camera(&self.library, &self.state, self.aspect).target
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
