//! Compares a view with the model it is for: what is out of range, and what the model doesn't have.

use super::layers::unknown_layers;
use super::link::differences;
use super::playhead::{clip_called, unknown_clip};
use super::variant::unknown_variant;
use super::{CameraChoice, LinkError, NameKind, UnknownName, VertexChoice, ViewerState, apply, pinning};
use crate::library::Model;
use crate::retarget::{ClipChanges, PinGoal};

const LEFT_OUT: &str = "it is left out";

/// Returns what a view asks for that can't be shown, key by key. Without a model, or while an empty stage stands in for it,
/// only what no model could show.
pub fn view_problems(view: &ViewerState, model: Option<&Model>) -> Vec<LinkError> {
    let mut found = differences(view, &apply::checked(view.clone()));
    if let Some(model) = model.filter(|model| !model.is_placeholder()) {
        find_names(view, model, &mut found);
        find_empty_clips(view, model, &mut found);
        find_indices(view, model, &mut found);
        find_pins(view, model, &mut found);
    }
    found
}

fn find_names(view: &ViewerState, model: &Model, found: &mut Vec<LinkError>) {
    let mut add = |key, unknown, instead| found.push(LinkError::UnknownName { key, unknown, instead });
    if let Some(unknown) = unknown_clip(model, view) {
        add("clip", unknown, "the rest pose is used");
    }
    let edits = &view.edits;
    for unknown in unknown_layers(model, &edits.layers) {
        add("layers", unknown, "the layer is left out");
    }
    for (name, changes) in edits.clips.iter().filter(|(name, _)| clip_called(model, name).is_none()) {
        let is_only_mirrored = *changes == ClipChanges { mirror: true, ..ClipChanges::NONE };
        let unknown = UnknownName { kind: NameKind::Clip, name: name.clone(), names: model.clip_titles().to_vec() };
        add(if is_only_mirrored { "mirror" } else { "change" }, unknown, LEFT_OUT);
    }
    if let Some(unknown) = unknown_variant(model, view) {
        add("variant", unknown, "the file's own materials are used");
    }
    let avatar = &model.asset.avatar;
    for name in edits.expressions.keys().filter(|name| avatar.expression(name).is_none()) {
        let names = avatar.expressions.iter().map(|expression| expression.name.clone()).collect();
        add("expression", UnknownName { kind: NameKind::Expression, name: name.clone(), names }, LEFT_OUT);
    }
}

/// A trim may begin where its clip has ended.
fn find_empty_clips(view: &ViewerState, model: &Model, found: &mut Vec<LinkError>) {
    for (name, ClipChanges { trim, .. }) in &view.edits.clips {
        let clip = clip_called(model, name).and_then(|clip| model.unchanged_clip(clip));
        if let (Some(clip), Some(range)) = (clip, trim)
            && range.start_secs >= f64::from(clip.duration_secs())
        {
            let value = format!("{name}:trim:{}:{}", range.start_secs, range.end_secs);
            let instead = format!("it ends at {:.3} s, so nothing is left", clip.duration_secs());
            found.push(LinkError::OutOfRange { key: "change", value, expected: "a start within the clip", instead });
        }
    }
}

fn find_indices(view: &ViewerState, model: &Model, found: &mut Vec<LinkError>) {
    let (asset, edits) = (&model.asset, &view.edits);
    let mut check = |key, what, count: usize, indices: &mut dyn Iterator<Item = usize>| {
        let unknown: Vec<String> = indices.filter(|&index| index >= count).map(|index| index.to_string()).collect();
        if !unknown.is_empty() {
            found.push(LinkError::UnknownIndex { key, what, count, found: unknown.join(", ") });
        }
    };
    // The skeleton has a joint for each node of the file.
    let joints = asset.skeleton.len();
    check("joint", "joint", joints, &mut view.selection.joint.into_iter());
    check("pose", "joint", joints, &mut edits.pose.keys().copied());
    check("names", "joint", joints, &mut edits.names.keys().copied());
    check("layers", "joint", joints, &mut edits.layers.iter().flat_map(|layer| layer.mask.joints.iter().copied()));
    check("hidden", "node", joints, &mut edits.hidden.nodes.iter().copied());
    let materials = &mut edits.hidden.materials.iter().flatten().copied();
    check("hidden", "material", asset.materials.len(), materials);
    check("morph", "morph target", asset.skeleton.rest().morph_weights.len(), &mut edits.morph.keys().copied());
    check("scene", "scene", asset.scenes.len(), &mut view.sources.scene.into_iter());
    if let CameraChoice::File(index) = view.camera {
        check("camera", "camera", asset.cameras.len(), &mut [index].into_iter());
    }
    if let Some(VertexChoice { instance, primitive, vertex }) = view.selection.vertex {
        let mesh = asset.instances.get(instance).map(|instance| &asset.meshes[instance.mesh]);
        let geometry = mesh.and_then(|mesh| mesh.primitives.get(primitive));
        check(
            "vertex",
            "vertex of that primitive",
            geometry.map_or(0, |geometry| geometry.positions.len()),
            &mut [vertex].into_iter(),
        );
    }
}

/// Not every joint can have every goal.
fn find_pins(view: &ViewerState, model: &Model, found: &mut Vec<LinkError>) {
    let (pinning, skeleton) = (pinning(model, view, None), &model.asset.skeleton);
    for (&joint, pin) in view.edits.pins.iter().filter(|(joint, pin)| !pinning.allows(**joint, pin.goal)) {
        let (joint, what, count) = match pin.goal {
            PinGoal::Joint(other, _) if other >= skeleton.len() => (other, "joint", skeleton.len()),
            goal => {
                let allowed = (0..skeleton.len()).filter(|&joint| pinning.allows(joint, goal));
                (joint, "joint that can be pinned like this", allowed.count())
            }
        };
        found.push(LinkError::UnknownIndex { key: "pin", what, count, found: joint.to_string() });
    }
}
