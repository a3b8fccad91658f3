//! The Display tab: how the mesh is bent, what is drawn over it, and morph targets set by hand.

use egui::Ui;

use crate::library::Model;
use crate::mesh::{Geometry, SkinningMode, Topology};
use crate::state::{Command, Inspect, Show, active_clip};
use crate::ui::controls::{self, SliderSettings};
use crate::ui::{Output, Shown};

const MODES: [(SkinningMode, &str); 3] =
    [(SkinningMode::Linear, "Linear"), (SkinningMode::Rigid, "Rigid"), (SkinningMode::DualQuaternion, "Dual quat.")];

/// What a skinning mode is called.
pub fn title(mode: SkinningMode) -> &'static str {
    match mode {
        SkinningMode::Linear => "Linear",
        SkinningMode::Rigid => "Rigid",
        SkinningMode::DualQuaternion => "Dual quaternion",
    }
}

fn explanation(mode: SkinningMode) -> &'static str {
    match mode {
        SkinningMode::Linear => {
            "Each vertex is the weighted mean of where its joints would put it. The usual way; twisted limbs get thin."
        }
        SkinningMode::Rigid => {
            "Each vertex follows its strongest joint alone. Shows what blending is for: limbs break at the joints."
        }
        SkinningMode::DualQuaternion => {
            "Joints are blended as screw motions, so twisted limbs keep their thickness; bent ones may bulge."
        }
    }
}

pub fn show(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let state = shown.state;
    let model = shown.library.active();
    // Where nothing is skinned they are what there is to play with.
    let morphs_first = model.is_some_and(|model| model.asset.skins.is_empty());
    if let Some(model) = model.filter(|_| morphs_first) {
        morphs(ui, shown, model, out);
    }
    controls::section(ui, "SKINNING");
    if let Some(mode) = controls::segmented(ui, Some(state.display.skinning), &MODES) {
        out.commands.push(Command::SetSkinning(mode));
    }
    ui.add_space(2.0);
    controls::hint(ui, explanation(state.display.skinning));
    if controls::switch(ui, "Compare all three", state.inspect.split) {
        out.commands.push(Command::SetInspect(Inspect { split: !state.inspect.split, ..state.inspect }));
    }

    controls::section(ui, "SHOW");
    let Show { mesh, skeleton, bounds, wireframe, grid, shadow, .. } = state.display.show;
    type Flip = fn(&mut Show, &mut Inspect);
    let switches: [(&str, bool, Flip); 7] = [
        ("Mesh", mesh, |show, _| show.mesh = !show.mesh),
        ("Skeleton", skeleton, |show, _| show.skeleton = !show.skeleton),
        ("Influence of the chosen joint", state.inspect.weights, |_, inspect| inspect.weights = !inspect.weights),
        ("Wireframe", wireframe, |show, _| show.wireframe = !show.wireframe),
        ("Bounds", bounds, |show, _| show.bounds = !show.bounds),
        ("Grid", grid, |show, _| show.grid = !show.grid),
        ("Shadow", shadow, |show, _| show.shadow = !show.shadow),
    ];
    for (label, on, flip) in switches {
        if controls::switch(ui, label, on) {
            let (mut show, mut inspect) = (state.display.show, state.inspect);
            flip(&mut show, &mut inspect);
            let is_show = show != state.display.show;
            out.commands.push(if is_show { Command::SetShow(show) } else { Command::SetInspect(inspect) });
        }
        if label.starts_with("Influence") && on {
            let hint = match state.selection.joint {
                None => "Choose a joint in the picture or in the Scene tab to see what it pulls.",
                Some(_) => {
                    "Grey where it does not pull at all, then from blue through green and yellow to red, where it pulls alone."
                }
            };
            controls::hint(ui, hint);
        }
    }
    more(ui, shown, out);
    source(ui, shown, out);
    if let Some(model) = model.filter(|_| !morphs_first) {
        morphs(ui, shown, model, out);
    }
}

/// What only some models or views have a use for.
fn more(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let show = shown.state.display.show;
    if controls::switch(ui, "Skeleton of spheres and boxes", show.boxes) {
        // Who asks for them wants to see them.
        let boxes = !show.boxes;
        out.commands.push(Command::SetShow(Show { boxes, skeleton: show.skeleton || boxes, ..show }));
    }
    let lacks_normals = |geometry: &Geometry| geometry.normals.is_empty() && geometry.topology == Topology::Triangles;
    let pieces = |model: &Model| model.asset.meshes.iter().flat_map(|mesh| &mesh.primitives).any(lacks_normals);
    if shown.library.active().is_some_and(pieces) {
        if controls::switch(ui, "Smooth surface", show.smooth) {
            out.commands.push(Command::SetShow(Show { smooth: !show.smooth, ..show }));
        }
        controls::hint(ui, "The file has no normals for some of its mesh: flat faces, unless this is on.");
    }
}

/// Where the file is shown that the playing clip is borrowed from.
fn source(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let show = shown.state.display.show;
    let Some(model) = shown.library.active().filter(|_| !shown.library.motions().is_empty()) else { return };
    controls::section(ui, "SOURCE OF THE MOTION");
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
    if let Some(place) = controls::segmented(ui, Some(place), &places) {
        let (source, over) = (place != Place::Away, place == Place::Over);
        out.commands.push(Command::SetShow(Show { source, over, ..show }));
    }
    if !show.source {
        return;
    }
    if active_clip(model, shown.state).and_then(|clip| model.borrowed(clip)).is_none() {
        controls::hint(ui, "This clip is the model's own: choose a borrowed one to see where it comes from.");
        return;
    }
    controls::hint(
        ui,
        "Below the timeline: tinted while the source's foot stands; the higher the bar, the faster the model's slides.",
    );
    if controls::switch(ui, "Colour bones by error", show.error) {
        out.commands.push(Command::SetShow(Show { error: !show.error, ..show }));
    }
    if show.error {
        controls::hint(
            ui,
            "How far a joint's turn away from its rest differs from its source's: green 0°, yellow 7.5°, red 15° and \
             more; grey follows nothing. Hover a joint for the number.",
        );
    }
}

/// Sliders for every morph target; they follow the clip until they are touched.
fn morphs(ui: &mut Ui, shown: &Shown<'_>, model: &Model, out: &mut Output) {
    let asset = &model.asset;
    let now = shown.frame.characters.first().map_or(&[][..], |character| &character.morph_weights);
    let mut titled = false;
    for instance in &asset.instances {
        let (Some(mesh), range) = (asset.meshes.get(instance.mesh), asset.skeleton.morph_range(instance.joint)) else {
            continue;
        };
        if range.is_empty() {
            continue;
        }
        if !titled {
            titled = true;
            controls::section(ui, "MORPH TARGETS");
            // Always there: it must not push a slider away from under the pointer.
            let by_hand = !shown.state.edits.morph.is_empty();
            if ui.add_enabled(by_hand, egui::Button::new("Let the clip decide")).clicked() {
                out.commands.push(Command::ClearMorphs);
            }
        }
        for (target, index) in range.enumerate() {
            let name = mesh.target_names.get(target).filter(|name| !name.is_empty());
            let name = name.cloned().unwrap_or_else(|| format!("Target {target}"));
            let rest = asset.skeleton.rest().morph_weights.get(index).copied().unwrap_or(0.0);
            let by_hand = shown.state.edits.morph.get(&index).copied();
            let value = by_hand.or_else(|| now.get(index).copied()).unwrap_or(rest);
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
