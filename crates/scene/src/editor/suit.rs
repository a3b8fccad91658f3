//! Settings chosen for what the user opens: the camera follows a clip that travels, and feet that would slide, hover or
//! sink in are held on the ground. Links and scripts get exactly what they say.
//!
//! They are set with the user's own commands, so a link stays a total description. The state says that feet were planted
//! automatically: the joint table's undo doesn't take that back.

use gaitway_retarget::{Feet, Verdict, Verdicts};

use super::Editor;
use crate::library::{ClipId, ModelClip};
use crate::state::{CameraChoice, CameraOptions, Command, ViewerState, frame_all};

/// The camera follows if framing the whole travel would take it this many times as far away as framing the character.
const FAR: f32 = 1.7;

impl Editor {
    /// Lets the camera follow the active clip if that travels far, and stand still otherwise.
    pub(super) fn suit_follow(&mut self) {
        let distance = |follow| {
            let camera_options = CameraOptions { follow, ..self.state.camera_options };
            let state = ViewerState { camera: CameraChoice::Auto, camera_options, ..self.state.clone() };
            frame_all(&self.library, &state, self.aspect).distance
        };
        let follow = distance(false) > FAR * distance(true);
        if follow != self.state.camera_options.follow {
            self.record(Command::SetFollow(follow));
        }
    }

    /// The same after another clip or model was chosen: neither the user's camera nor the user's choice is changed.
    pub(super) fn suit_automatic_follow(&mut self) {
        if self.suits_follow && self.state.camera == CameraChoice::Auto {
            self.suit_follow();
        }
    }

    /// Holds the feet on the ground if the first clip of one of the last `motions` motions slides, hovers or sinks in more than is
    /// acceptable, in a step of its own. Returns what to tell the user about it.
    pub(super) fn suit_feet(&mut self, motions: usize) -> Option<&'static str> {
        if self.state.character.retarget.feet.is_some() || !self.needs_feet_held(motions) {
            return None;
        }
        self.end_gesture();
        self.apply(Command::SetFeet(Some(Feet::Plant)));
        self.end_gesture();
        self.state.character.retarget.feet_are_automatic = true;
        Some("The feet would slide, hover or sink in, so they are held on the ground. Undo turns this off.")
    }

    fn needs_feet_held(&self, motions: usize) -> bool {
        let Some(model) = self.library.active() else { return false };
        let is_off = |clip: &ModelClip| {
            let contacts = self.state.character.retarget.contacts.unwrap_or_default();
            let verdicts = Verdicts::new(self.library.figures(clip.id())?, model.size_metres(), contacts);
            let feet = [verdicts.foot_slide, verdicts.foot_hover, verdicts.sole_penetration];
            Some(feet.contains(&Some(Verdict::NeedsReview)))
        };
        let from = self.library.motions().len().saturating_sub(motions);
        let mut first = self.library.motions()[from..].iter().map(|motion| ClipId::Borrowed(motion.id().clone(), 0));
        first.any(|clip| model.clip(&clip).and_then(is_off) == Some(true))
    }
}
