//! Edits of the current clip: a section of the Motion tab.

use egui::Ui;
use gaitway_character::anim::TimeRange;
use gaitway_retarget::ClipChanges;
use gaitway_scene::library::{ClipEdits, ModelClip};
use gaitway_scene::state::{ClipEdit, Command, active_clip};

use super::widgets::controls::{self, SliderSettings, capitals};
use super::{Output, Shown, text};

const SPEED: SliderSettings = SliderSettings {
    range: (ClipChanges::MIN_SPEED, ClipChanges::MAX_SPEED),
    default: ClipChanges::NONE.speed,
    decimals: 2,
    suffix: " ×",
    logarithmic: true,
};
// These sliders span what is common. Values beyond, up to the limits of `ClipChanges`, come from links.
const BLEND: SliderSettings =
    SliderSettings { range: (0.0, 2.0), default: DEFAULT_BLEND_SECS, decimals: 2, suffix: " s", logarithmic: false };
const TURN: SliderSettings =
    SliderSettings { range: (-180.0, 180.0), default: 0.0, decimals: 0, suffix: "°", logarithmic: false };
const OFFSET: SliderSettings =
    SliderSettings { range: (-5.0, 5.0), default: 0.0, decimals: 2, suffix: " m", logarithmic: false };
const DEFAULT_BLEND_SECS: f64 = 0.2;

/// Shows the section, unless the model is in its rest pose.
pub(super) fn section(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let Some(model) = shown.library.active() else { return };
    let Some(clip) = active_clip(model, shown.state) else { return };
    let before = shown.state.character.edits.clips.changes_of(clip.id());
    let mut changes = before.clone();
    controls::section(ui, capitals!(text::CHANGE_CLIP));
    name(ui, clip, out);
    changes.mirror ^= controls::switch(ui, text::MIRROR, changes.mirror);
    changes.reverse ^= controls::switch(ui, text::BACKWARDS, changes.reverse);
    let copy = trim(ui, shown, &mut changes);
    if controls::switch(ui, text::MAKE_LOOP, changes.loop_secs.is_some()) {
        changes.loop_secs = if changes.loop_secs.is_some() { None } else { Some(DEFAULT_BLEND_SECS) };
    }
    if let Some(secs) = changes.loop_secs {
        changes.loop_secs = controls::slider(ui, text::BLEND, secs, BLEND).or(changes.loop_secs);
        if let Some(seam) = clip.changed().and_then(|changed| changed.seam) {
            controls::hint(ui, text::seam(seam));
        }
    }
    let [x, z] = &mut changes.offset;
    for (label, value, settings) in [
        (text::BAKED_SPEED, &mut changes.speed, SPEED),
        (text::TURN_PATH, &mut changes.turn_degrees, TURN),
        (text::MOVE_X, x, OFFSET),
        (text::MOVE_Z, z, OFFSET),
    ] {
        *value = controls::slider(ui, label, *value, settings).unwrap_or(*value);
    }
    if !changes.is_none() && ui.button(text::RESET_CHANGES).clicked() {
        changes = ClipChanges::default();
    }
    let edit = |edit| Command::EditClip { clip: clip.id().clone(), edit };
    if let Some(changes) = copy {
        out.commands.push(edit(ClipEdit::Copy(Box::new(changes))));
    } else if clip.is_copy() && ui.button(text::REMOVE_COPY).clicked() {
        out.commands.push(edit(ClipEdit::RemoveCopy));
    } else if changes != before {
        out.commands.push(edit(ClipEdit::Change(Box::new(changes))));
    }
}

/// The field for the clip's name: Enter or a click elsewhere accepts, Esc cancels.
fn name(ui: &mut Ui, clip: &ModelClip, out: &mut Output) {
    let typed_id = ui.scope_id().with(("clip name", clip.id()));
    let mut typed: String = ui.data(|data| data.get_temp(typed_id)).unwrap_or_else(|| clip.title().to_owned());
    let field = controls::text_field(&mut typed).hint_text(text::CLIP_NAME_IN_FILE).desired_width(f32::INFINITY);
    let field = ui.add(field).accessible_name(text::CLIP_NAME);
    if field.has_focus() {
        ui.data_mut(|data| data.insert_temp(typed_id, typed));
        return;
    }
    ui.data_mut(|data| data.remove::<String>(typed_id));
    let is_cancelled = ui.input(|input| input.key_pressed(egui::Key::Escape));
    if field.lost_focus() && !is_cancelled && typed != clip.title() {
        let edit = ClipEdit::Rename(typed);
        out.commands.push(Command::EditClip { clip: clip.id().clone(), edit });
    }
}

/// Buttons that keep only what is between the in and out points, in place or as a new clip, and one that restores the whole clip.
/// Returns the changes of the new clip.
fn trim(ui: &mut Ui, shown: &Shown<'_>, changes: &mut ClipChanges) -> Option<ClipChanges> {
    // The range is then not in the time of the original clip.
    let is_timed = changes.reverse || changes.speed != 1.0;
    let range = shown.state.character.playhead.range.filter(|range| !is_timed && range.length_secs() > 0.0);
    let start_secs = changes.trim.map_or(0.0, |trim| trim.start_secs);
    let in_clip = |secs: f64| egui::emath::round_to_decimals(start_secs + secs, 6);
    let range =
        range.map(|range| TimeRange { start_secs: in_clip(range.start_secs), end_secs: in_clip(range.end_secs) });
    let no_range = match (changes.reverse, changes.speed != 1.0) {
        (true, true) => text::RETIMED,
        (true, false) => text::REVERSED,
        (false, true) => text::OTHER_SPEED,
        (false, false) => text::NEEDS_RANGE,
    };
    let why_not = range.is_none().then_some(no_range);
    let is_full = shown.state.character.edits.clips.copies.len() == ClipEdits::MAX_COPIES;
    ui.horizontal_wrapped(|ui| {
        let is_trimmed = changes.trim.is_some();
        if trim_button(ui, text::TRIM_TO_RANGE, why_not) {
            changes.trim = range;
        }
        let why_not = why_not.or(is_full.then_some(text::ENOUGH_COPIES));
        let copy = trim_button(ui, text::TRIM_TO_COPY, why_not).then(|| ClipChanges { trim: range, ..changes.clone() });
        if is_trimmed && ui.button(text::UNDO_TRIM).clicked() {
            changes.trim = None;
        }
        copy
    })
    .inner
}

/// Returns whether the button was clicked; `why_not` disables it.
fn trim_button(ui: &mut Ui, label: &str, why_not: Option<&str>) -> bool {
    let button = ui.add_enabled(why_not.is_none(), egui::Button::new(label));
    if let Some(why_not) = why_not {
        ui.ctx().accesskit_node_builder(button.id, |node| node.set_description(why_not));
    }
    let hint = controls::with_key(ui, why_not.unwrap_or_default());
    button.on_disabled_hover_text(hint).clicked()
}
