//! The source of the active retargeted clip, displayed beside the model or overlaid on it.

use gaitway_character::mesh::Bounds;
use glam::{Affine3A, Quat, Vec3};

use super::framing::front_yaw_radians;
use super::playhead::{active_clip, world_from_model};
use super::{ViewerState, active_take};
use crate::library::{BorrowedClip, ClipId, Library, Model, Take};

/// A motion's own skeleton, playing the original clip.
#[derive(Debug, Clone)]
pub struct SourceOnStage<'a> {
    /// The motion as a model, see [`crate::library::Motion::stage`].
    pub model: &'a Model,
    /// One of its own clips.
    pub clip: ClipId,
    /// The retargeted clip, one of the active model's.
    pub borrowed: &'a BorrowedClip,
    /// Includes the up axis and the offset to the place beside the model.
    pub world_from_source: Affine3A,
}

impl<'a> SourceOnStage<'a> {
    /// What it plays.
    pub fn take(&self) -> Take<'a> {
        source_take(self.model, &self.clip, self.world_from_source)
    }
}

fn source_take<'a>(model: &'a Model, clip: &ClipId, world_from_model: Affine3A) -> Take<'a> {
    Take { world_from_model, ..Take::new(model, model.clip(clip)) }
}

/// Returns the source on stage; `None` if the state hides it or the clip is not retargeted.
pub fn source_on_stage<'a>(library: &'a Library, state: &ViewerState) -> Option<SourceOnStage<'a>> {
    let model = library.active().filter(|_| state.display.show.source)?;
    let active = active_clip(model, state)?;
    let borrowed = active.borrowed()?;
    let source = library.motion(&borrowed.motion)?.stage();
    let clip = ClipId::Own(borrowed.source_clip);
    let in_place = world_from_model(state.character.edits.up) * borrowed.model_from_source;
    let bounds = [
        library.bounds(&active_take(model, state), state.character.sources.scene, true),
        library.bounds(&source_take(source, &clip, in_place), None, true),
    ];
    let offset = if state.display.show.over { Vec3::ZERO } else { beside(bounds, front_yaw_radians(library, state)) };
    let world_from_source = Affine3A::from_translation(offset) * in_place;
    world_from_source.is_finite().then_some(SourceOnStage { model: source, clip, borrowed, world_from_source })
}

/// The gap between two characters, as a share of their widths.
const GAP: f32 = 0.1;

/// Returns the offset that places the second character to the right of the first, clear of both. `yaw_radians` is the
/// direction that the first one faces: a model that is long from front to back has the source at its flank.
fn beside([model, source]: [Bounds; 2], yaw_radians: f32) -> Vec3 {
    let right = (Quat::from_rotation_y(yaw_radians) * Vec3::NEG_X).round();
    // From the left to the right end of a box.
    let extent = |bounds: Bounds| {
        let along = bounds.corners().map(|corner| corner.dot(right));
        along.into_iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(min, max), at| (min.min(at), max.max(at)))
    };
    if model.is_empty() || source.is_empty() {
        return Vec3::ZERO;
    }
    let ((from, to), (source_from, source_to)) = (extent(model), extent(source));
    (to - source_from + GAP * (to - from + source_to - source_from)) * right
}
