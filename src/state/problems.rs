//! Compares a view with the model it is for: what is out of range, and what the model doesn't have.

use super::apply::{checked, checked_for};
use super::layers::unknown_layers;
use super::link::differences;
use super::playhead::{clip_called, unknown_clip};
use super::variant::unknown_variant;
use super::{LinkError, NameKind, UnknownName, ViewerState};
use crate::library::Model;
use crate::retarget::ClipChanges;

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
    let edits = &view.edits;
    if let Some(unknown) = unknown_clip(model, view) {
        add("clip", unknown, "the rest pose is used");
    }
    for unknown in unknown_layers(model, &edits.layers) {
        add("layers", unknown, "the layer is left out");
    }
    let clip_unknown =
        |name: &String| UnknownName { kind: NameKind::Clip, name: name.clone(), names: model.clip_titles().to_vec() };
    for copy in edits.copies.iter().filter(|copy| clip_called(model, &copy.of).is_none()) {
        add("copy", clip_unknown(&copy.of), LEFT_OUT);
    }
    for (name, changes) in edits.clips.iter().filter(|(name, _)| clip_called(model, name).is_none()) {
        let is_only_mirrored = *changes == ClipChanges { mirror: true, ..ClipChanges::NONE };
        add(if is_only_mirrored { "mirror" } else { "change" }, clip_unknown(name), LEFT_OUT);
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
