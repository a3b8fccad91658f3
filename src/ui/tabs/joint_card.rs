//! The card of the selected joint: its name, transforms and matrices, and sliders to pose it.

use egui::{RichText, Sense, Ui, WidgetInfo, pos2, vec2};
use gaitway_character::anim::{JointIndex, Transform};
use gaitway_character::asset::Asset;
use gaitway_scene::library::{Model, manual_degrees};
use gaitway_scene::state::{Command, title};
use glam::{Affine3A, EulerRot, Quat, Vec3};

use super::facts::aligned;
use super::formula;
use super::pin;
use crate::ui::controls::SliderSettings;
use crate::ui::icons::{Icon, icon_button_sized, icon_size};
use crate::ui::{Output, Shown, controls, style, text};

/// What the card remembers.
#[derive(Debug, Default)]
pub struct JointCard {
    /// The pose sliders and the rotation gizmo are on.
    pub is_posing: bool,
    /// The sliders have just appeared, which changes the room above them first.
    reveals_sliders: bool,
    shows_matrices: bool,
    /// The number in the file of the joint that is being renamed, and what has been typed so far.
    renaming: Option<(usize, String)>,
}

/// `has_content`: the node or one below has a mesh or a light, which can be hidden.
pub fn show(
    ui: &mut Ui,
    shown: &Shown<'_>,
    model: &Model,
    joint: JointIndex,
    has_content: bool,
    card: &mut JointCard,
    out: &mut Output,
) {
    let asset = &model.asset;
    header(ui, shown, asset, joint, card, out);
    if has_content {
        hide_buttons(ui, shown, asset, joint, out);
    }
    // One that the user hid has a button that shows it.
    let is_hidden_here = shown.state.character.edits.hidden.nodes.contains(&asset.skeleton.source_index(joint));
    if !is_hidden_here && !shown.frame.is_visible(joint) {
        controls::hint(ui, text::NODE_HIDDEN);
    }
    let local = shown.frame.pose().get(joint).unwrap_or_default();
    ui.add_space(2.0);
    let is_switched = controls::switch(ui, text::POSE_MANUALLY, card.is_posing);
    if is_switched {
        card.is_posing = !card.is_posing;
        card.reveals_sliders = card.is_posing;
        ui.ctx().request_repaint();
        if shown.state.camera_options.turntable != 0.0 {
            out.commands.push(Command::SetTurntable(0.0));
        }
    }
    if card.is_posing {
        let sliders = ui.scope(|ui| pose_sliders(ui, shown, asset, joint, local.rotation, out));
        if !is_switched && std::mem::take(&mut card.reveals_sliders) {
            // On a phone they begin below the sheet.
            sliders.response.scroll_to_me(None);
        }
    }
    reset_buttons(ui, shown, asset.skeleton.source_index(joint), out);
    pin::show(ui, shown, model, joint, out);
    // Transforms or matrices: they say the same.
    if !card.shows_matrices {
        transforms(ui, shown, asset, joint, &local);
    }
    if controls::switch(ui, text::MATRICES, card.shows_matrices) {
        card.shows_matrices = !card.shows_matrices;
    }
    if card.shows_matrices {
        ui.scope(|ui| formula::matrices(ui, shown, model, joint));
    }
}

const CLOSE_SIZE: f32 = 24.0;

fn header(ui: &mut Ui, shown: &Shown<'_>, asset: &Asset, joint: JointIndex, card: &mut JointCard, out: &mut Output) {
    ui.horizontal(|ui| {
        let width = ui.available_width() - icon_size(ui, CLOSE_SIZE).x - 76.0;
        ui.scope(|ui| {
            ui.set_max_width(width);
            name(ui, shown, asset, joint, card, out);
        });
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if icon_button_sized(ui, Icon::Close, text::DESELECT, CLOSE_SIZE).clicked() {
                out.commands.push(Command::SelectJoint(None));
            }
            if card.renaming.is_none() && controls::small_button(ui, text::RENAME).clicked() {
                let name = title(Some(shown.state), asset, joint).into_owned();
                card.renaming = Some((asset.skeleton.source_index(joint), name));
            }
        });
    });
}

/// Hides or solos the meshes and lights of the node and below.
fn hide_buttons(ui: &mut Ui, shown: &Shown<'_>, asset: &Asset, joint: JointIndex, out: &mut Output) {
    let hidden = &shown.state.character.edits.hidden;
    let number = asset.skeleton.source_index(joint);
    ui.horizontal_wrapped(|ui| {
        let label = if hidden.nodes.contains(&number) { text::SHOW } else { text::HIDE };
        if ui.button(label).clicked() {
            out.commands.push(Command::SetHidden(hidden.clone().with_node_toggled(number)));
        }
        if ui.button(text::SOLO).on_hover_text(text::SOLO_HINT).clicked() {
            out.commands.push(Command::SetHidden(hidden.clone().with_node_soloed(asset, joint)));
        }
    });
}

/// Shown while any joint is posed manually.
fn reset_buttons(ui: &mut Ui, shown: &Shown<'_>, joint: usize, out: &mut Output) {
    let posed = &shown.state.character.edits.pose;
    if posed.is_empty() {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        if ui.add_enabled(posed.contains_key(&joint), egui::Button::new(text::RESET_JOINT)).clicked() {
            out.commands.push(Command::SetPose { joint, degrees: None });
        }
        if posed.keys().any(|&other| other != joint) {
            let all = ui.button(text::counted(text::RESET_ALL, posed.len()));
            if all.on_hover_text("Return all manually posed joints to the clip").clicked() {
                out.commands.push(Command::ClearPose);
            }
        }
    });
}

/// Translation, rotation and scale, relative to the parent and to the world.
fn transforms(ui: &mut Ui, shown: &Shown<'_>, asset: &Asset, joint: JointIndex, local: &Transform) {
    let parent = asset.skeleton.parent(joint).map(|parent| title(Some(shown.state), asset, parent));
    let (heads, _) = ui.allocate_exact_size(vec2(ui.available_width(), 12.0), Sense::hover());
    for (axis, name) in ["X", "Y", "Z"].into_iter().enumerate() {
        let right = heads.left() + 60.0 + (heads.width() - 60.0) / 3.0 * (axis + 1) as f32;
        let (at, font) = (pos2(right, heads.center().y), style::SMALL);
        ui.painter().text(at, egui::Align2::RIGHT_CENTER, name, font, style::palette(ui).weak_text);
    }
    // Below a scaled parent, the numbers are not metres.
    transform(ui, &text::local_transform(parent.as_deref()), local, "");
    let character = shown.frame.characters.first();
    if let Some(world) = character.and_then(|character| character.world_from_joint.get(joint.get())) {
        transform(ui, "World", &decomposed(world), " m");
    }
}

/// The joint's name, or the field to rename it: Enter or a click elsewhere accepts, Esc cancels.
fn name(ui: &mut Ui, shown: &Shown<'_>, asset: &Asset, joint: JointIndex, card: &mut JointCard, out: &mut Output) {
    let number = asset.skeleton.source_index(joint);
    let Some((_, typed)) = card.renaming.as_mut().filter(|(of, _)| *of == number) else {
        card.renaming = None;
        let name = RichText::new(title(Some(shown.state), asset, joint)).strong();
        ui.add(egui::Label::new(name).truncate().selectable(true));
        return;
    };
    let in_file = asset.skeleton.name(joint);
    let field = controls::text_field(typed).hint_text(in_file).desired_width(f32::INFINITY);
    let field = ui.add(field).accessible_name(text::JOINT_NAME);
    let is_cancelled = ui.input(|input| input.key_pressed(egui::Key::Escape));
    if field.lost_focus() {
        if !is_cancelled {
            out.commands.push(Command::RenameJoint { joint: number, name: typed.clone() });
        }
        card.renaming = None;
    } else if !field.has_focus() {
        field.request_focus();
    }
}

/// Three angles relative to the rest pose; they follow the clip until they are touched.
fn pose_sliders(ui: &mut Ui, shown: &Shown<'_>, asset: &Asset, joint: JointIndex, rotation: Quat, out: &mut Output) {
    let number = asset.skeleton.source_index(joint);
    let rest = asset.skeleton.rest().get(joint).map_or(Quat::IDENTITY, |local| local.rotation);
    let now = shown.state.character.edits.pose.get(&number).copied().unwrap_or_else(|| manual_degrees(rest, rotation));
    // Turns -0 into 0.
    let now = now.map(|angle| angle + 0.0);
    controls::hint(ui, text::POSE_HINT);
    for (axis, name) in text::POSE_ANGLES.into_iter().enumerate() {
        let settings =
            SliderSettings { range: (-180.0, 180.0), default: 0.0, decimals: 1, suffix: "°", logarithmic: false };
        if let Some(angle) = controls::slider(ui, name, f64::from(now[axis]), settings) {
            let mut degrees = now;
            degrees[axis] = angle as f32;
            out.commands.push(Command::SetPose { joint: number, degrees: Some(degrees) });
        }
    }
}

fn decomposed(world: &Affine3A) -> Transform {
    Transform::from_matrix(&(*world).into())
}

/// `unit`: of its position.
fn transform(ui: &mut Ui, title: &str, value: &Transform, unit: &str) {
    let palette = style::palette(ui);
    ui.add_space(4.0);
    ui.add(egui::Label::new(RichText::new(title).small().color(palette.weak_text)).truncate());
    let (x, y, z) = value.rotation.normalize_or_identity().to_euler(EulerRot::XYZ);
    let degrees = Vec3::new(x, y, z) * (180.0 / std::f32::consts::PI);
    let rows = [(text::POSITION, value.translation, unit), ("Rotation", degrees, "°"), (text::SCALE, value.scale, "")];
    for (name, numbers, unit) in rows {
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::hover());
        ui.painter().text(rect.left_center(), egui::Align2::LEFT_CENTER, name, style::SMALL, palette.weak_text);
        let width = (rect.width() - 60.0) / 3.0;
        let texts = match unit {
            "°" => numbers.to_array().map(|number| formula::fixed(number, 1) + "°").into(),
            _ => aligned(&numbers.to_array()),
        };
        for (column, text) in texts.iter().enumerate() {
            let at = pos2(rect.left() + 60.0 + width * (column + 1) as f32, rect.center().y);
            ui.painter().text(at, egui::Align2::RIGHT_CENTER, text, style::SMALL, palette.text);
        }
        let whole = text::labelled(name, &texts.join(" "));
        response.widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Label, true, &whole));
        let exact = match unit {
            "°" => quaternion_text(value.rotation),
            _ => format!("{} {} {}{unit}", numbers.x, numbers.y, numbers.z),
        };
        response.on_hover_text(exact);
    }
}

fn quaternion_text(rotation: Quat) -> String {
    let [x, y, z, w] = rotation.to_array();
    format!("Quaternion x {x:.5}  y {y:.5}  z {z:.5}  w {w:.5}\nEuler angles about the joint's X, then Y, then Z.")
}

trait NormalizeOrIdentity {
    fn normalize_or_identity(self) -> Quat;
}

impl NormalizeOrIdentity for Quat {
    fn normalize_or_identity(self) -> Quat {
        if self.length_squared() > 0.0 && self.is_finite() { self.normalize() } else { Quat::IDENTITY }
    }
}
