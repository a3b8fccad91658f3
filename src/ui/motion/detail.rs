//! Details of the selected joint, below its row: its source as text, its rotation offset, muted channels of the source, and
//! what the joint does without one.

use egui::{EventFilter, Key, RichText, Ui};
use glam::{EulerRot, Quat};

use super::clicking::{Clicking, source_is_shown};
use super::picker::Picking;
use super::rows::Row;
use super::{MotionTab, Pairing, options};
use crate::anim::JointIndex;
use crate::retarget::{JointMap, MutedProperty, Unmapped};
use crate::state::{Command, MapEdit, muted_properties};
use crate::ui::{Output, Shown, style, text};

/// A source being typed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Typed {
    target: usize,
    text: String,
    /// Why the entered text was rejected.
    problem: Option<String>,
}

/// A rotation offset as typed: the rotation alone does not determine the angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turn {
    target: usize,
    rotation: Quat,
    degrees: [f64; 3],
}

pub(super) fn show(
    ui: &mut Ui,
    shown: &Shown<'_>,
    pairing: &Pairing<'_>,
    map: &JointMap,
    row: &Row,
    tab: &mut MotionTab,
    out: &mut Output,
) {
    let edit = |edit| Command::EditMap { motion: pairing.index, edit };
    let palette = style::palette(ui);
    // Unfilled, so that fields and buttons stand out.
    let card = egui::Frame::new()
        .stroke(egui::Stroke::new(1.0, palette.line))
        .corner_radius(8)
        .inner_margin(egui::Margin::same(9));
    card.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.spacing_mut().item_spacing = egui::vec2(6.0, 6.0);
        let color = if row.look { palette.warning } else { palette.weak_text };
        let text = format!("{}: {}", row.state.word(), row.why);
        ui.add(egui::Label::new(RichText::new(text).small().color(color)).wrap());
        source_field(ui, pairing, row, tab, out);
        ui.horizontal_wrapped(|ui| {
            if ui.button("List…").on_hover_text("All joints of the motion").clicked() {
                tab.picking = Some(Picking::new(pairing.index, row.number));
            }
            if source_is_shown(shown, pairing)
                && ui.button("Click its source").on_hover_text("In the viewport, on the motion's skeleton").clicked()
            {
                tab.clicking = Some(Clicking::Source { motion: pairing.index, target: row.number });
            }
            let clear = ui.add_enabled(row.source.is_some(), egui::Button::new("Clear"));
            if clear.on_hover_text("Follow nothing").clicked() {
                out.commands.push(Command::SetSource { motion: pairing.index, target: row.number, source: None });
            }
        });
        match row.source {
            Some(source) => {
                let mut turn = Turn::of(map, row.number, tab.turn);
                if turn_fields(ui, &mut turn) {
                    tab.turn = Some(turn);
                    out.commands.push(edit(MapEdit::Correction { target: row.number, correction: turn.rotation }));
                }
                out.commands.extend(muting(ui, pairing, map, source).map(edit));
            }
            None => {
                let own = map.joints.get(&row.number).and_then(|entry| entry.unmapped.clone());
                if let Some(unmapped) = own_policy(ui, pairing, map, own) {
                    out.commands.push(edit(MapEdit::Unmapped { target: row.number, unmapped }));
                }
            }
        }
    });
    ui.add_space(6.0);
}

fn source_field(ui: &mut Ui, pairing: &Pairing<'_>, row: &Row, tab: &mut MotionTab, out: &mut Output) {
    let asset = &pairing.motion.asset;
    let now = row.source.map_or_else(String::new, |source| asset.skeleton.source_index(source).to_string());
    let mut typed = tab.typed.take().filter(|typed| typed.target == row.number);
    let mut text = typed.as_ref().map_or(now, |typed| typed.text.clone());
    let field = ui
        .horizontal(|ui| {
            let label = ui.label("Source");
            let field = egui::TextEdit::singleline(&mut text)
                .hint_text("Name or number; empty: none")
                .margin(egui::Margin::symmetric(8, 5))
                .desired_width(ui.available_width());
            ui.add(field).labelled_by(label.id).accessible_name(format!("Source of {}", row.target))
        })
        .inner;
    if field.changed() {
        typed = Some(Typed { target: row.number, text: text.clone(), problem: None });
    }
    // Escape discards the typed text and does nothing else.
    let filter = EventFilter { escape: true, ..EventFilter::default() };
    if field.has_focus() {
        ui.memory_mut(|memory| memory.set_focus_lock_filter(field.id, filter));
        if ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Escape)) {
            typed = None;
            field.surrender_focus();
            ui.ctx().request_repaint();
        }
    }
    if field.lost_focus()
        && let Some(entered) = &mut typed
    {
        match find_source(pairing, &entered.text) {
            Ok(source) => {
                if source != row.source.map(|source| asset.skeleton.source_index(source)) {
                    out.commands.push(Command::SetSource { motion: pairing.index, target: row.number, source });
                }
                typed = None;
            }
            Err(problem) => entered.problem = Some(problem),
        }
    }
    if let Some(problem) = typed.as_ref().and_then(|typed| typed.problem.as_ref()) {
        let error = style::palette(ui).error;
        ui.add(egui::Label::new(RichText::new(problem).small().color(error)).wrap());
    }
    tab.typed = typed;
}

/// Finds the joint of the motion that a text names, by number or name; None for an empty text.
fn find_source(pairing: &Pairing<'_>, text: &str) -> Result<Option<usize>, String> {
    let skeleton = &pairing.motion.asset.skeleton;
    let text = text.trim();
    if text.is_empty() {
        return Ok(None);
    }
    if let Ok(number) = text.trim_start_matches('#').parse::<usize>() {
        let last = skeleton.len().saturating_sub(1);
        let known = skeleton.joint_of_source(number).is_some();
        return if known { Ok(Some(number)) } else { Err(format!("The motion's joints are numbered 0 to {last}.")) };
    }
    let called = |same: &dyn Fn(&str) -> bool| -> Vec<usize> {
        let joints = skeleton.joints().filter(|&joint| same(skeleton.name(joint)));
        joints.map(|joint| skeleton.source_index(joint)).collect()
    };
    let lower = text.to_lowercase();
    let mut found = called(&|name| name == text);
    if found.is_empty() {
        found = called(&|name| name.to_lowercase() == lower);
    }
    match found.as_slice() {
        [number] => Ok(Some(*number)),
        [] => Err(format!("No joint of the motion is called “{text}”.")),
        several => {
            let numbers: Vec<String> = several.iter().map(ToString::to_string).collect();
            Err(format!("Several joints are called “{text}”: type one of their numbers, {}.", numbers.join(", ")))
        }
    }
}

impl Turn {
    /// The typed angles while they match the map, otherwise angles of the map's rotation.
    fn of(map: &JointMap, target: usize, typed: Option<Self>) -> Self {
        let rotation = map.joints.get(&target).map_or(Quat::IDENTITY, |entry| entry.correction);
        let same = |turn: &Self| turn.target == target && turn.rotation.abs_diff_eq(rotation, 1e-6);
        typed.filter(same).unwrap_or_else(|| {
            let (x, y, z) = rotation.to_euler(EulerRot::XYZ);
            // Rounds off floating-point noise; adding 0.0 turns -0.0 into 0.0.
            let degrees = [x, y, z].map(|angle| (f64::from(angle).to_degrees() * 1e4).round() / 1e4 + 0.0);
            Self { target, rotation, degrees }
        })
    }
}

/// Edits three angles; returns whether one changed.
fn turn_fields(ui: &mut Ui, turn: &mut Turn) -> bool {
    let mut degrees = turn.degrees;
    let weak = style::palette(ui).weak_text;
    ui.horizontal(|ui| {
        ui.label(RichText::new(text::ROTATION_OFFSET).small().color(weak))
            .on_hover_text("In the joint's own space: about its X, then Y, then Z");
        let turned = turn.rotation != Quat::IDENTITY;
        if turned && ui.small_button("Reset").on_hover_text("No offset").clicked() {
            degrees = [0.0; 3];
        }
    });
    ui.horizontal(|ui| {
        let width = (ui.available_width() - 12.0) / 3.0;
        for (angle, axis) in degrees.iter_mut().zip(["X", "Y", "Z"]) {
            let field = egui::DragValue::new(angle)
                .speed(0.5)
                .range(-180.0..=180.0)
                .max_decimals(1)
                // Typing an angle is a single undo step, not one per digit.
                .update_while_editing(false)
                .prefix(format!("{axis} "))
                .suffix("°");
            let field = ui.add_sized([width, 26.0], field);
            field.accessible_name(text::rotation_offset_about(axis));
        }
    });
    if degrees == turn.degrees {
        return false;
    }
    turn.degrees = degrees;
    let [x, y, z] = degrees.map(|angle| angle.to_radians() as f32);
    turn.rotation = Quat::from_euler(EulerRot::XYZ, x, y, z);
    true
}

fn muting(ui: &mut Ui, pairing: &Pairing<'_>, map: &JointMap, source: JointIndex) -> Option<MapEdit> {
    let source = pairing.motion.asset.skeleton.source_index(source);
    let weak = style::palette(ui).weak_text;
    ui.label(RichText::new(text::IGNORED_CHANNELS).small().color(weak));
    let channels = [
        (MutedProperty::Rotation, "rotation", 1),
        (MutedProperty::Translation, "translation", 0),
        (MutedProperty::Scale, "scale", 2),
    ];
    let now = muted_properties(map, source);
    let mut edit = None;
    ui.horizontal_wrapped(|ui| {
        for (property, name, at) in channels {
            let mut muted = now[at];
            let response = ui.checkbox(&mut muted, name);
            if response.accessible_name(text::ignore_channels(name)).changed() {
                edit = Some(MapEdit::Mute { source, property, muted });
            }
        }
    });
    edit
}

/// Chooses what this joint does without a source.
fn own_policy(ui: &mut Ui, pairing: &Pairing<'_>, map: &JointMap, own: Option<Unmapped>) -> Option<Option<Unmapped>> {
    let mut pressed = None;
    let all = options::policy_text(pairing, &map.unmapped);
    let as_all = format!("As all ({})", all.to_lowercase());
    let text = own.as_ref().map_or(as_all.clone(), |own| options::policy_text(pairing, own));
    let combo = egui::ComboBox::from_id_salt("own policy").width(ui.available_width()).truncate().selected_text(text);
    let response = combo.show_ui(ui, |ui| {
        if ui.selectable_label(own.is_none(), as_all).clicked() {
            pressed = Some(None);
        }
        for (policy, text) in options::policies(pairing) {
            if ui.selectable_label(own.as_ref() == Some(&policy), text).clicked() {
                pressed = Some(Some(policy));
            }
        }
    });
    response.response.accessible_name("What it does instead");
    pressed
}
