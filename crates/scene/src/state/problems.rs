//! Compares a view with the model it is for: what is out of range, and what the model doesn't have.

use gaitway_retarget::ClipChanges;

use super::apply::{checked, checked_for};
use super::clip_names::{look_up_clip, unknown_layers, unknown_name};
use super::link::differences;
use super::playhead::unknown_clip;
use super::variant::unknown_variant;
use super::{LinkError, NameKind, UnknownName, ViewerState};
use crate::library::{ClipEdits, ClipId, Model, ModelClip};

const LEFT_OUT: &str = "it is left out";

/// Returns what a view asks for that can't be shown, key by key. Without a model, or while an empty stage stands in for it,
/// only what no model could show. The model must have the view's copies of clips.
pub fn view_problems(view: &ViewerState, model: Option<&Model>) -> Vec<LinkError> {
    // Angles may only be written otherwise.
    const ANGLES: [&str; 3] = ["camera", "environment", "pose"];
    let checked = checked(view);
    let mut found = Vec::new();
    differences(view, &checked, "", &mut found);
    found.retain(|problem| !ANGLES.contains(&problem.key()));
    if let Some(model) = model.filter(|model| !model.is_placeholder()) {
        find_names(view, model, &mut found);
        find_empty_clips(view, model, &mut found);
        differences(&checked, &checked_for(&checked, model), "this model can't show it, so ", &mut found);
    }
    found
}

fn find_names(view: &ViewerState, model: &Model, found: &mut Vec<LinkError>) {
    let mut add = |key, unknown, instead| found.push(LinkError::UnknownName { key, unknown, instead });
    let edits = &view.character.edits;
    if let Some(unknown) = unknown_clip(model, view) {
        add("clip", unknown, "the rest pose is used");
    }
    for unknown in unknown_layers(model, &edits.layers) {
        add("layers", unknown, "the layer is left out");
    }
    let ClipEdits { copies, names, changes } = &edits.clips;
    let is_unknown = |clip: &ClipId| look_up_clip(model, clip).is_none();
    for copy in copies.iter().filter(|copy| is_unknown(&copy.of)) {
        add("copy", unknown_name(model, &copy.of), LEFT_OUT);
    }
    for clip in names.keys().filter(|clip| clip.name().is_some() && is_unknown(clip)) {
        add("rename", unknown_name(model, clip), LEFT_OUT);
    }
    for (clip, changes) in changes.iter().filter(|(clip, _)| is_unknown(clip)) {
        let is_only_mirrored = *changes == ClipChanges { mirror: true, ..ClipChanges::NONE };
        add(if is_only_mirrored { "mirror" } else { "change" }, unknown_name(model, clip), LEFT_OUT);
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
    for (id, ClipChanges { trim, .. }) in &view.character.edits.clips.changes {
        let clip = look_up_clip(model, id).map(ModelClip::unchanged);
        if let (Some(clip), Some(range)) = (clip, trim)
            && range.start_secs >= f64::from(clip.duration_secs())
        {
            let value = format!("{id}:trim:{}:{}", range.start_secs, range.end_secs);
            let instead = format!("it ends at {:.3} s, so nothing is left", clip.duration_secs());
            found.push(LinkError::OutOfRange { key: "change", value, expected: "a start within the clip", instead });
        }
    }
}
