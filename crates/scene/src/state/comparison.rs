//! Variants of the active model side by side, one to a pane of the viewport.

use gaitway_character::mesh::SkinningMode;
use gaitway_retarget::RestChoice;

use super::ViewerState;
use super::playhead::active_clip;
use crate::library::Library;

/// What the panes of the viewport compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// [`COMPARED_SKINNING`].
    Skinning,
    /// The rests that the active clip's motion can be measured from; holds the one that the joint map chooses.
    Rests(RestChoice),
}

/// The skinning methods by pane.
pub const COMPARED_SKINNING: [SkinningMode; 3] =
    [SkinningMode::Linear, SkinningMode::Rigid, SkinningMode::DualQuaternion];

/// Returns the rests by pane: the chosen one first.
pub fn compared_rests(chosen: RestChoice) -> [RestChoice; 4] {
    let mut rests = RestChoice::ALL;
    let place = rests.iter().position(|&rest| rest == chosen).unwrap_or(0);
    rests[..=place].rotate_right(1);
    rests
}

/// Returns what is compared. Rests are compared only while a borrowed clip plays.
pub fn comparison(library: &Library, state: &ViewerState) -> Option<Comparison> {
    if state.inspect.split {
        return Some(Comparison::Skinning);
    }
    let model = library.active().filter(|_| state.inspect.rests)?;
    let borrowed = active_clip(model, state)?.borrowed()?;
    Some(Comparison::Rests(borrowed.rest_choice()))
}

/// Returns the columns and rows of panes in a viewport of this aspect ratio (width over height). Three panes are laid out along
/// the longer side.
pub fn panes(comparison: Option<Comparison>, aspect: f32) -> [u32; 2] {
    match comparison {
        None => [1, 1],
        Some(Comparison::Skinning) if aspect >= 1.0 => [3, 1],
        Some(Comparison::Skinning) => [1, 3],
        Some(Comparison::Rests(_)) => [2, 2],
    }
}

/// Returns the aspect ratio of one pane of a viewport of this aspect ratio.
pub fn pane_aspect(comparison: Option<Comparison>, aspect: f32) -> f32 {
    let [columns, rows] = panes(comparison, aspect);
    aspect * rows as f32 / columns as f32
}

/// Returns the factor for the camera's distance when the comparison changes in a viewport of this aspect ratio, so that each of
/// the narrower panes shows what was in the centre of the whole viewport.
pub fn comparison_ratio(before: Option<Comparison>, after: Option<Comparison>, aspect: f32) -> f32 {
    let zoom_out = |comparison| (aspect.min(1.0) / pane_aspect(comparison, aspect).min(1.0)).max(1.0);
    zoom_out(after) / zoom_out(before)
}
