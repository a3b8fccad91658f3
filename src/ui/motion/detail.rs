//! Details of the selected joint, below its row: its source as text, its rotation offset, muted channels of the source, and
//! what the joint does without one.

use egui::{EventFilter, Key, RichText, Ui};
use gaitway_character::anim::JointIndex;
use gaitway_retarget::{JointMap, MutedProperty, Unmapped};
use gaitway_scene::state::{Command, MapEdit, muted_properties};
use glam::{EulerRot, Quat};

use super::clicking::{Clicking, source_is_shown};
use super::picker::Picking;
use super::rows::Row;
use super::{MotionTab, Pairing, options};
use crate::ui::{Output, Shown, controls, style, text};

/// What the details say about the chosen joint, kept with the table's lines.
#[derive(Debug)]
pub(super) struct Texts {
    /// Its state, and why.
    standing: String,
    /// What the joint does without a source.
    policy: String,
    /// The option of doing what the map sets for all unmapped joints.
    default_policy: String,
    /// What it can do without a source.
    policies: Vec<(Unmapped, String)>,
}

impl Texts {
    pub fn new(pairing: &Pairing<'_>, row: &Row) -> Self {
        let default_policy = text::default_policy(&options::policy_text(pairing, &pairing.map.unmapped));
        let own = pairing.map.joints.get(&row.number).and_then(|entry| entry.unmapped.as_ref());
        Self {
            standing: text::labelled(row.state.word(), &row.why),
            policy: own.map_or_else(|| default_policy.clone(), |own| options::policy_text(pairing, own)),
            default_policy,
            policies: options::policies(pairing),
        }
    }
}

/// The chosen joint.
pub(super) struct About<'a, 'b> {
    pub shown: &'b Shown<'a>,
    pub pairing: &'b Pairing<'a>,
    pub map: &'b JointMap,
    pub row: &'b Row,
    pub texts: &'b Texts,
}

/// The text in the field for the source.
#[derive(Debug, PartialEq)]
pub(super) struct Typed {
    target: usize,
    /// Number of the source that the field showed before anything was typed.
    source: Option<usize>,
    text: String,
    /// Differs from that source.
    is_edited: bool,
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

pub(super) fn show(ui: &mut Ui, about: &About<'_, '_>, tab: &mut MotionTab, out: &mut Output) {
    let &About { shown, pairing, map, row, texts } = about;
    let edit = |edit| Command::EditMap { motion: pairing.id(), edit };
    let palette = style::palette(ui);
    // Unfilled, so that fields and buttons stand out.
    let card = egui::Frame::new()
        .stroke(egui::Stroke::new(1.0, palette.line))
        .corner_radius(style::CORNER)
        .inner_margin(egui::Margin::same(9));
    card.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.spacing_mut().item_spacing = egui::vec2(6.0, 6.0);
        let color = if row.needs_review { palette.warning } else { palette.weak_text };
        ui.add(egui::Label::new(RichText::new(&texts.standing).small().color(color)).wrap());
        source_field(ui, pairing, row, tab, out);
        ui.horizontal_wrapped(|ui| {
            let list = ui.button(text::LIST_SOURCES).on_hover_text("All joints of the motion");
            if list.clicked() {
                tab.picking = Some(Picking::new(pairing.id(), row.number));
            }
            if source_is_shown(shown, pairing)
                && ui.button(text::CLICK_SOURCE).on_hover_text("In the viewport, on the motion's skeleton").clicked()
            {
                tab.clicking = Some(Clicking::Source { motion: pairing.id(), target: row.number });
            }
            let clear = ui.add_enabled(row.source.is_some(), egui::Button::new(text::CLEAR_SOURCE));
            let clear = clear.on_hover_text("Leave the joint unmapped");
            if clear.clicked() {
                if clear.has_focus() {
                    // There is nothing more to clear.
                    list.request_focus();
                }
                out.commands.push(Command::SetSource { motion: pairing.id(), target: row.number, source: None });
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
                let own = map.joints.get(&row.number).and_then(|entry| entry.unmapped.as_ref());
                if let Some(unmapped) = own_policy(ui, texts, own) {
                    out.commands.push(edit(MapEdit::Unmapped { target: row.number, unmapped }));
                }
            }
        }
    });
    ui.add_space(6.0);
}

fn source_field(ui: &mut Ui, pairing: &Pairing<'_>, row: &Row, tab: &mut MotionTab, out: &mut Output) {
    let kept = tab.typed.take().filter(|typed| typed.target == row.number);
    let kept = kept.filter(|typed| typed.is_edited || typed.source == source_number(pairing, row));
    let mut typed = kept.unwrap_or_else(|| Typed::new(pairing, row));
    let field = ui
        .horizontal(|ui| {
            let label = ui.label("Source");
            let field = controls::text_field(&mut typed.text)
                .hint_text("Name or number, or empty")
                .margin(egui::Margin::symmetric(8, 5))
                .desired_width(ui.available_width());
            ui.add(field).labelled_by(label.id)
        })
        .inner;
    controls::named(&field, || text::source_of(&row.target));
    if field.changed() {
        (typed.is_edited, typed.problem) = (true, None);
    }
    // Escape discards the typed text and does nothing else.
    let filter = EventFilter { escape: true, ..EventFilter::default() };
    if field.has_focus() {
        ui.memory_mut(|memory| memory.set_focus_lock_filter(field.id, filter));
        if ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Escape)) {
            typed = Typed::new(pairing, row);
            field.surrender_focus();
            ui.ctx().request_repaint();
        }
    }
    if field.lost_focus() && typed.is_edited {
        match find_source(pairing, &typed.text) {
            Ok(source) => {
                if source != source_number(pairing, row) {
                    out.commands.push(Command::SetSource { motion: pairing.id(), target: row.number, source });
                }
                typed = Typed::new(pairing, row);
            }
            Err(problem) => typed.problem = Some(problem),
        }
    }
    if let Some(problem) = &typed.problem {
        let error = style::palette(ui).error;
        ui.add(egui::Label::new(RichText::new(problem).small().color(error)).wrap());
    }
    tab.typed = Some(typed);
}

impl Typed {
    /// The number of the row's source.
    fn new(pairing: &Pairing<'_>, row: &Row) -> Self {
        let source = source_number(pairing, row);
        let text = source.map_or_else(String::new, |source| source.to_string());
        Self { target: row.number, source, text, is_edited: false, problem: None }
    }
}

fn source_number(pairing: &Pairing<'_>, row: &Row) -> Option<usize> {
    row.source.map(|source| pairing.motion.asset.skeleton.source_index(source))
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
        [] => Err(text::no_source_called(text)),
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
        if turned && controls::small_button(ui, text::RESET_OFFSET).on_hover_text("No offset").clicked() {
            degrees = [0.0; 3];
        }
    });
    ui.horizontal(|ui| {
        let width = (ui.available_width() - 12.0) / 3.0;
        for (angle, (axis, prefix)) in degrees.iter_mut().zip([("X", "X "), ("Y", "Y "), ("Z", "Z ")]) {
            let field = controls::number(ui, [width, 26.0], angle, |field| {
                field.speed(0.5).range(-180.0..=180.0).max_decimals(1).prefix(prefix).suffix("°")
            });
            controls::named(&field, || text::rotation_offset_about(axis));
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
    let channels = [(MutedProperty::Rotation, 1), (MutedProperty::Translation, 0), (MutedProperty::Scale, 2)];
    let now = muted_properties(map, source);
    let mut edit = None;
    ui.horizontal_wrapped(|ui| {
        for (property, at) in channels {
            let (mut muted, name) = (now[at], text::CHANNELS[at]);
            let response = ui.checkbox(&mut muted, name);
            controls::named(&response, || text::ignore_channels(name));
            if response.changed() {
                edit = Some(MapEdit::Mute { source, property, muted });
            }
        }
    });
    edit
}

/// Chooses what this joint does without a source.
fn own_policy(ui: &mut Ui, texts: &Texts, own: Option<&Unmapped>) -> Option<Option<Unmapped>> {
    let mut pressed = None;
    controls::chooser(ui, "own policy", text::OWN_POLICY, &texts.policy, |ui| {
        if controls::option(ui, own.is_none(), &texts.default_policy) {
            pressed = Some(None);
        }
        for (policy, text) in &texts.policies {
            if controls::option(ui, own == Some(policy), text) {
                pressed = Some(Some(policy.clone()));
            }
        }
    });
    pressed
}
