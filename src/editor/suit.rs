//! Settings chosen for what the user opens: the camera follows a clip that travels, and feet that would slide or hover are held
//! on the ground. Links and scripts get exactly what they say.

use super::Editor;
use crate::retarget::Feet;
use crate::state::{CameraChoice, CameraOptions, Command, ViewerState, frame_all};

/// The camera follows if framing the whole travel would take it this many times as far away as framing the character.
const FAR: f32 = 1.7;
/// Slide beyond the source's that is visible, as a share of the model's height per second.
const VISIBLE_SLIDE: f64 = 0.06;
/// Height of the soles above or below the ground that is visible, as a share of the model's height.
const VISIBLE_HOVER: f64 = 0.025;

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

    /// Holds the feet on the ground if a borrowed clip slides or hovers visibly and no map says what feet do. Returns whether it
    /// did, which is a step of its own.
    pub(super) fn suit_feet(&mut self, clip: usize) -> bool {
        let Some(model) = self.library.active() else { return false };
        let height = f64::from(model.rest_bounds().size().max_element());
        let Some(figures) = self.library.figures(clip).filter(|_| self.state.retarget.feet.is_none()) else {
            return false;
        };
        let slide = figures.foot_slide_metres_per_sec.unwrap_or_default();
        let source_slide = figures.foot_slide_source_metres_per_sec.unwrap_or_default();
        let hover = figures.foot_hover_metres_mean.unwrap_or_default().abs();
        let is_visible = slide - source_slide > VISIBLE_SLIDE * height || hover > VISIBLE_HOVER * height;
        if is_visible {
            self.end_gesture();
            self.apply(Command::SetFeet(Some(Feet::Plant)));
            self.end_gesture();
        }
        is_visible
    }
}
