//! The Display tab: material variants, skinning, overlays, expressions and morph targets.

use egui::Ui;
use gaitway_character::mesh::{Geometry, SkinningMode, Topology};
use gaitway_scene::library::{Model, ModelClip};
use gaitway_scene::state::{
    COMPARED_SKINNING, Channel, Command, Inspect, Show, active_clip, active_variant, title as joint_title,
};

use super::avatar;
use crate::ui::controls::{self, SliderSettings, capitals};
use crate::ui::{Output, Shown, text};

/// The full name of a skinning method.
pub fn title(mode: SkinningMode) -> &'static str {
    match mode {
        SkinningMode::DualQuaternion => "Dual quaternion",
        SkinningMode::Linear | SkinningMode::Rigid => text::skinning_method(mode),
    }
}

fn explanation(mode: SkinningMode) -> &'static str {
    match mode {
        SkinningMode::Linear => {
            "Each vertex is the weighted mean of its positions under each joint. The usual method; twisted limbs get thin."
        }
        SkinningMode::Rigid => {
            "Each vertex follows its strongest joint only. Limbs break at the joints, which shows what blending is for."
        }
        SkinningMode::DualQuaternion => {
            "Joints are blended as screw motions: twisted limbs keep their volume, bent ones may bulge."
        }
    }
}

pub fn show(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let model = shown.library.active();
    if let Some(model) = model {
        variants(ui, shown, model, out);
    }
    // First for unskinned models, where they are the most useful controls.
    let morphs_first = model.is_some_and(|model| model.asset.skins.is_empty());
    if let Some(model) = model.filter(|_| morphs_first) {
        avatar::controls(ui, shown, model, out);
        morphs(ui, shown, model, out);
    }
    skinning(ui, shown, out);
    overlays(ui, shown, out);
    special_overlays(ui, shown, out);
    source(ui, shown, out);
    if let Some(model) = model.filter(|_| !morphs_first) {
        avatar::controls(ui, shown, model, out);
        morphs(ui, shown, model, out);
    }
}

/// The file's material variants, if it has any.
fn variants(ui: &mut Ui, shown: &Shown<'_>, model: &Model, out: &mut Output) {
    let variants = &model.asset.variants;
    if variants.is_empty() {
        return;
    }
    controls::section(ui, text::VARIANTS);
    let active = active_variant(model, shown.state);
    if controls::list_row(ui, text::NO_VARIANT, "", active.is_none()).clicked() {
        out.commands.push(Command::SetVariant(None));
    }
    for (index, name) in variants.iter().enumerate() {
        if controls::list_row(ui, name, "", active == Some(index)).clicked() {
            out.commands.push(Command::SetVariant(Some(name.clone())));
        }
    }
}

fn skinning(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let state = shown.state;
    controls::section(ui, capitals!(text::SKINNING));
    let methods = COMPARED_SKINNING.map(|mode| (mode, text::skinning_method(mode)));
    if let Some(mode) = controls::segmented(ui, text::SKINNING, Some(state.display.skinning), &methods) {
        out.commands.push(Command::SetSkinning(mode));
    }
    ui.add_space(2.0);
    controls::hint(ui, explanation(state.display.skinning));
    if controls::switch(ui, text::COMPARE_SKINNING, state.inspect.split) {
        out.commands.push(Command::SetInspect(Inspect { split: !state.inspect.split, rests: false, ..state.inspect }));
    }
}

fn overlays(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let state = shown.state;
    let show = state.display.show;
    controls::section(ui, "SHOW");
    channel(ui, state.channel(), out);
    if let Some(absent) = shown.library.active().and_then(|model| text::absent(state.channel(), model)) {
        controls::hint(ui, absent);
    }
    let mut flip = |ui: &mut Ui, label: &str, on: bool, flipped: Show| {
        if controls::switch(ui, label, on) {
            out.commands.push(Command::SetShow(flipped));
        }
    };
    flip(ui, "Mesh", show.mesh, Show { mesh: !show.mesh, ..show });
    flip(ui, text::SKELETON, show.skeleton, Show { skeleton: !show.skeleton, ..show });
    let weights = state.inspect.weights;
    let flip_weights = controls::switch(ui, text::JOINT_WEIGHTS, weights);
    if weights {
        let hint = match state.selection.joint {
            None => text::JOINT_WEIGHTS_HINT,
            Some(_) => {
                "Grey: no influence. Then from blue through green and yellow to red, where the joint is the only influence."
            }
        };
        controls::hint(ui, hint);
    }
    flip(ui, "Wireframe", show.wireframe, Show { wireframe: !show.wireframe, ..show });
    flip(ui, "Bounds", show.bounds, Show { bounds: !show.bounds, ..show });
    flip(ui, "Grid", show.grid, Show { grid: !show.grid, ..show });
    flip(ui, "Shadow", show.shadow, Show { shadow: !show.shadow, ..show });
    if flip_weights {
        out.commands.push(Command::SetInspect(Inspect { weights: !weights, ..state.inspect }));
    }
}

/// The choice of what surfaces show.
fn channel(ui: &mut Ui, now: Channel, out: &mut Output) {
    let chosen = text::labelled(text::CHANNEL, text::channel(now));
    controls::chooser(ui, "channel", text::CHANNEL, &chosen, |ui| {
        for channel in Channel::ALL {
            if controls::option(ui, channel == now, text::channel(channel)) {
                out.commands.push(Command::SetChannel(channel));
            }
        }
    });
    ui.add_space(2.0);
}

/// Overlays that only some models or views have a use for.
fn special_overlays(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let show = shown.state.display.show;
    if controls::switch(ui, text::SKELETON_BOXES, show.boxes) {
        // Switching them on shows the skeleton.
        let boxes = !show.boxes;
        out.commands.push(Command::SetShow(Show { boxes, skeleton: show.skeleton || boxes, ..show }));
    }
    let has_controls = shown.library.active().is_some_and(|model| model.rig().has_controls());
    if has_controls && controls::switch(ui, text::CONTROL_BONES, show.controls) {
        let controls = !show.controls;
        out.commands.push(Command::SetShow(Show { controls, skeleton: show.skeleton || controls, ..show }));
    }
    let lacks_normals = |geometry: &Geometry| geometry.normals.is_empty() && geometry.topology == Topology::Triangles;
    let any_lacks_normals =
        |model: &Model| model.asset.meshes.iter().flat_map(|mesh| &mesh.primitives).any(lacks_normals);
    if shown.library.active().is_some_and(any_lacks_normals) {
        if controls::switch(ui, text::SMOOTH_SURFACE, show.smooth) {
            out.commands.push(Command::SetShow(Show { smooth: !show.smooth, ..show }));
        }
        controls::hint(
            ui,
            "Parts of the mesh have no normals. This computes smooth ones; without it, their faces are flat.",
        );
    }
}

/// Where to show the skeleton that the current clip is borrowed from.
fn source(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let show = shown.state.display.show;
    let Some(model) = shown.library.active().filter(|_| !shown.library.motions().is_empty()) else { return };
    controls::section(ui, capitals!(text::MOTION_SOURCE));
    #[derive(Clone, Copy, PartialEq)]
    enum Place {
        Away,
        Beside,
        Over,
    }
    let place = match (show.source, show.over) {
        (false, _) => Place::Away,
        (true, false) => Place::Beside,
        (true, true) => Place::Over,
    };
    let places = [(Place::Away, "Hidden"), (Place::Beside, "Beside"), (Place::Over, "Over")];
    if let Some(place) = controls::segmented(ui, text::MOTION_SOURCE, Some(place), &places) {
        let (source, over) = (place != Place::Away, place == Place::Over);
        out.commands.push(Command::SetShow(Show { source, over, ..show }));
    }
    if !show.source {
        return;
    }
    if active_clip(model, shown.state).and_then(ModelClip::borrowed).is_none() {
        controls::hint(ui, "This clip is the model's own. Choose a borrowed clip to see its source.");
        return;
    }
    controls::hint(
        ui,
        "Foot contacts below the timeline: tinted while the source's foot is planted; the bar's height is the foot slide of the model.",
    );
    if controls::switch(ui, "Colour bones by rotation error", show.error) {
        out.commands.push(Command::SetShow(Show { error: !show.error, ..show }));
    }
    if show.error {
        controls::hint(
            ui,
            "Rotation error relative to the source: green 0°, yellow 7.5°, red 15° or more; grey is unmapped. Hover over a \
             joint for its error.",
        );
    }
}

/// A slider for each morph target; they follow the clip until they are touched.
fn morphs(ui: &mut Ui, shown: &Shown<'_>, model: &Model, out: &mut Output) {
    let asset = &model.asset;
    let now = shown.frame.characters.first().map_or(&[][..], |character| &character.morph_weights);
    // Copies of a mesh at one node share its weights.
    let nodes = asset.instances.chunk_by(|a, b| a.joint == b.joint).filter_map(|copies| copies.first());
    let morphed = nodes.filter(|instance| !asset.skeleton.morph_range(instance.joint).is_empty());
    let count = morphed.clone().count();
    if count > 0 {
        controls::section(ui, "MORPH TARGETS");
        // Always visible, so that the sliders don't move when the first one is touched.
        let is_edited = !shown.state.character.edits.morph.is_empty();
        if ui.add_enabled(is_edited, egui::Button::new(text::RESET_MORPHS)).clicked() {
            out.commands.push(Command::ClearMorphs);
        }
    }
    for instance in morphed {
        let (Some(mesh), range) = (asset.meshes.get(instance.mesh), asset.skeleton.morph_range(instance.joint)) else {
            continue;
        };
        if count > 1 {
            // Their targets often have the same names.
            controls::hint(ui, joint_title(Some(shown.state), asset, instance.joint).into_owned());
        }
        for (target, index) in range.enumerate() {
            let name = mesh.target_names.get(target).filter(|name| !name.is_empty());
            let name = name.cloned().unwrap_or_else(|| format!("Target {target}"));
            let rest = asset.skeleton.rest().morph_weights.get(index).copied().unwrap_or(0.0);
            let edited = shown.state.character.edits.morph.get(&index).copied();
            let value = edited.or_else(|| now.get(index).copied()).unwrap_or(rest);
            let settings = SliderSettings {
                range: (0.0, 1.0),
                default: f64::from(rest),
                decimals: 2,
                suffix: "",
                logarithmic: false,
            };
            let new = ui.push_id(index, |ui| controls::slider(ui, &name, f64::from(value), settings)).inner;
            if let Some(weight) = new {
                out.commands.push(Command::SetMorph { index, weight: Some(weight as f32) });
            }
        }
    }
}
