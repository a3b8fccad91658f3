//! Layers over the current clip: a section below the clip's edits, and tracks under the timeline.

use std::borrow::Cow;

use egui::{Response, Ui};
use gaitway_character::asset::Slot;
use gaitway_retarget::{BodyPart, ClipLayer, LayerMask, LayerMode};
use gaitway_scene::library::{LayeredClip, Model, ModelClip};
use gaitway_scene::state::{Command, title};

use super::icons::{Icon, icon_button_sized, icon_size};
use super::widgets::controls::{self, SliderSettings, capitals};
use super::{Output, Shown, text, tracks};

const WEIGHT: SliderSettings =
    SliderSettings { range: (0.0, 1.0), default: 1.0, decimals: 2, suffix: "", logarithmic: false };
const SPEED: SliderSettings =
    SliderSettings { range: (0.0, 4.0), default: 1.0, decimals: 2, suffix: " ×", logarithmic: false };
/// Values beyond come from links.
const START: SliderSettings =
    SliderSettings { range: (-5.0, 5.0), default: 0.0, decimals: 2, suffix: " s", logarithmic: false };
const BUTTON_SIZE: f32 = 28.0;
const UPPER_BODY: [BodyPart; 4] = [BodyPart::Torso, BodyPart::Head, BodyPart::LeftArm, BodyPart::RightArm];

/// Shows the section for a model with clips.
pub(super) fn section(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let Some(model) = shown.library.active().filter(|model| !model.clips().is_empty()) else { return };
    let before = &shown.state.character.edits.layers;
    let mut layers = before.clone();
    let mut moved = None;
    controls::section(ui, capitals!(text::LAYERS));
    controls::hint(ui, text::ABOUT_LAYERS);
    let add = ui.button(text::ADD_LAYER);
    ui.add_space(4.0);
    // A layer that was just added gets the focus. That scrolls to its chooser, so the whole card scrolls into view afterwards.
    let added_id = ui.scope_id().with("added layer");
    let added: Option<usize> = ui.data(|data| data.get_temp(added_id));
    for (index, over) in layers.iter_mut().enumerate().rev() {
        let name = text::layer(index + 1, &title_of(model, over));
        let can_rise = index + 1 < before.len();
        let done = ui.push_id(("layer", index), |ui| {
            controls::group(ui, &name, |ui| controls::card(ui, |ui| card(ui, shown, model, over, can_rise)))
        });
        let (chooser, how) = done.inner;
        if added == Some(index) && chooser.has_focus() {
            // Its top, if the whole card is higher than the panel.
            let mut rect = done.response.rect;
            rect.max.y = rect.max.y.min(rect.top() + ui.clip_rect().height());
            ui.scroll_to_rect(rect, None);
            ui.data_mut(|data| data.remove::<usize>(added_id));
        } else if added == Some(index) {
            chooser.request_focus();
            ui.ctx().request_repaint();
        }
        ui.add_space(4.0);
        moved = how.map(|how| (index, how)).or(moved);
    }
    match moved {
        Some((index, Moved::Raised)) => layers.swap(index, index + 1),
        Some((index, Moved::Removed { by_key })) => {
            layers.remove(index);
            // What is nearest to the button that goes with the layer belongs to something else.
            if by_key {
                add.request_focus();
            }
        }
        None => {}
    }
    if add.clicked() {
        // Another clip than the one that plays, if there is one.
        let playing = shown.clip().map(ModelClip::id);
        let other = model.clips().iter().map(ModelClip::id).find(|clip| Some(*clip) != playing);
        // On the upper body, so that the legs show what a layer is for: the clip below goes on.
        let has_arms = model.body().slots.0.contains_key(&Slot::LeftUpperArm);
        let mask = if has_arms { LayerMask::of_parts(&UPPER_BODY) } else { LayerMask::default() };
        let layer = ClipLayer { mask, ..ClipLayer::default() };
        layers.extend(other.or(playing).map(|clip| LayeredClip { clip: clip.clone(), layer }));
        ui.data_mut(|data| data.insert_temp(added_id, before.len()));
    }
    if layers != *before {
        out.commands.push(Command::SetLayers(layers));
    }
}

/// How the user moves a layer in the stack.
enum Moved {
    Raised,
    /// `by_key`: not with the pointer.
    Removed {
        by_key: bool,
    },
}

fn title_of<'a>(model: &'a Model, over: &LayeredClip) -> Cow<'a, str> {
    model.clip(&over.clip).map_or_else(|| over.clip.to_string().into(), |clip| clip.title().into())
}

/// Returns the chooser of the clip, and how the layer is moved, if it is.
fn card(
    ui: &mut Ui,
    shown: &Shown<'_>,
    model: &Model,
    over: &mut LayeredClip,
    can_rise: bool,
) -> (Response, Option<Moved>) {
    let mut moved = None;
    let row = ui.horizontal(|ui| {
        let shown = title_of(model, over);
        let buttons = controls::button_width(ui, text::RAISE_LAYER) + icon_size(ui, BUTTON_SIZE).x;
        let width = ui.available_width() - buttons - 2.0 * ui.spacing().item_spacing.x;
        let mut picked = None;
        let choices = |ui: &mut Ui| {
            for clip in model.clips() {
                if controls::option(ui, *clip.id() == over.clip, clip.title()) {
                    picked = Some(clip.id().clone());
                }
            }
        };
        // The text of a combo box takes what is available, whatever its width.
        let chooser = ui.scope(|ui| {
            ui.set_max_width(width);
            controls::chooser(ui, "clip", text::LAYER_CLIP, &shown, choices)
        });
        if let Some(clip) = picked {
            over.clip = clip;
        }
        if ui.add_enabled(can_rise, egui::Button::new(text::RAISE_LAYER)).clicked() {
            moved = Some(Moved::Raised);
        }
        let remove = icon_button_sized(ui, Icon::Close, text::REMOVE_LAYER, BUTTON_SIZE);
        if remove.clicked() {
            moved = Some(Moved::Removed { by_key: !remove.clicked_by(egui::PointerButton::Primary) });
        }
        chooser.inner
    });
    let layer = &mut over.layer;
    let modes = LayerMode::ALL.map(|mode| (mode, text::layer_mode(mode)));
    layer.mode = controls::segmented_about(ui, text::LAYER_MODE, Some(layer.mode), &modes).unwrap_or(layer.mode);
    for (label, value, settings) in [
        (text::LAYER_WEIGHT, &mut layer.weight, WEIGHT),
        (text::LAYER_SPEED, &mut layer.speed, SPEED),
        (text::LAYER_START, &mut layer.start_secs, START),
    ] {
        *value = controls::slider(ui, label, *value, settings).unwrap_or(*value);
    }
    mask(ui, shown, model, layer);
    (row.inner, moved)
}

/// Shows which parts of the body the layer moves.
fn mask(ui: &mut Ui, shown: &Shown<'_>, model: &Model, layer: &mut ClipLayer) {
    let has_parts = !model.body().slots.0.is_empty();
    if has_parts {
        controls::hint(ui, text::LAYER_PARTS);
    }
    ui.horizontal_wrapped(|ui| {
        if has_parts {
            for (part, _) in BodyPart::ALL {
                if controls::choice(ui, layer.mask.has(part), text::body_part(part)).clicked() {
                    layer.mask.toggle(part);
                }
            }
        }
        // The selected joint can be added, and those that are in the mask removed.
        let selected = shown.state.selection.joint;
        let mut pressed = None;
        let extra = selected.filter(|joint| !layer.mask.joints.contains(joint));
        for &joint in layer.mask.joints.iter().chain(&extra) {
            let Some(index) = model.asset.skeleton.joint_of_source(joint) else { continue };
            let name = title(Some(shown.state), &model.asset, index);
            if controls::choice(ui, extra != Some(joint), &text::below_joint(&name)).clicked() {
                pressed = Some(joint);
            }
        }
        if let Some(joint) = pressed
            && !layer.mask.joints.remove(&joint)
        {
            layer.mask.joints.insert(joint);
        }
    });
}

/// The layers that the model has clips for.
fn playable<'a>(shown: &Shown<'a>) -> impl Iterator<Item = (&'a ClipLayer, &'a ModelClip)> + use<'a> {
    let layers = shown.library.active().map(|model| (model, &shown.state.character.edits.layers));
    let layers = layers.into_iter().flat_map(|(model, layers)| layers.iter().map(move |over| (over, model)));
    layers.filter_map(|(over, model)| Some((&over.layer, model.clip(&over.clip)?)))
}

/// Returns the width that the names of the layers take at the left of the timeline; 0 if there are none.
pub(super) fn gutter(ui: &Ui, shown: &Shown<'_>) -> f32 {
    tracks::widest(ui, &mut playable(shown).map(|(_, clip)| clip.title().to_owned()))
}

/// Shows a track for each layer, the top one first, with a bar for each time that its clip plays.
pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, gutter: f32) {
    let Some(duration_secs) = tracks::duration_secs(shown) else { return };
    let rows: Vec<_> = playable(shown).collect();
    for (layer, clip) in rows.into_iter().rev() {
        let name = clip.title();
        tracks::row(ui, shown, gutter, name, &text::layer_track(name), |ui, lane| {
            let period = layer.period_secs(clip.clip()).unwrap_or(f64::INFINITY);
            // Beyond that many, bars would be narrower than the gaps between them.
            let period = period.max(4.0 * duration_secs / f64::from(lane.width().max(1.0)));
            let x_of = |secs: f64| lane.left() + (secs / duration_secs) as f32 * lane.width();
            let mut start = if period.is_finite() { layer.start_secs.rem_euclid(period) - period } else { 0.0 };
            while start < duration_secs {
                let end = x_of((start + period).min(duration_secs)) - 1.0;
                tracks::bar(ui, lane, [x_of(start), end], 0.15 + 0.45 * layer.weight as f32);
                start += period;
            }
        });
    }
}
