//! The source of the active retargeted clip, displayed beside the model or overlaid on it.

use glam::{Affine3A, Vec3};

use super::ViewerState;
use super::playhead::{active_clip, world_from_model};
use crate::library::{BorrowedClip, Library, Model};
use crate::mesh::Bounds;

/// A motion's own skeleton, playing the original clip.
#[derive(Debug, Clone, Copy)]
pub struct SourceOnStage<'a> {
    /// The motion as a model, see [`crate::library::Motion::stage`].
    pub model: &'a Model,
    /// Index among its own clips.
    pub clip: usize,
    /// The retargeted clip, one of the active model's.
    pub borrowed: &'a BorrowedClip,
    /// Includes the up axis and the offset to the place beside the model.
    pub world_from_source: Affine3A,
}

/// Returns the source on stage; `None` if the state hides it or the clip is not retargeted.
pub fn source_on_stage<'a>(library: &'a Library, state: &ViewerState) -> Option<SourceOnStage<'a>> {
    let model = library.active().filter(|_| state.display.show.source)?;
    let borrowed = model.borrowed(active_clip(model, state)?)?;
    let source = library.motions().get(borrowed.motion)?.stage();
    let in_place = world_from_model(state.edits.up) * borrowed.model_from_source;
    let half_width = |bounds: Bounds| if bounds.is_empty() { 0.0 } else { 0.5 * bounds.size().x };
    let sizes = [
        model.rest_bounds().transformed(&world_from_model(state.edits.up)),
        source.rest_bounds().transformed(&in_place),
    ];
    let distance = match state.display.show.over {
        true => 0.0,
        false => 1.15 * (half_width(sizes[0]) + half_width(sizes[1])),
    };
    let world_from_source = Affine3A::from_translation(distance * Vec3::NEG_X) * in_place;
    world_from_source.is_finite().then_some(SourceOnStage {
        model: source,
        clip: borrowed.source_clip,
        borrowed,
        world_from_source,
    })
}
