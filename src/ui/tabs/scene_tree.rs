//! The Scene tab: every node of the file as a tree, and the chosen joint's transforms.

use egui::{Color32, Rect, RichText, ScrollArea, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};
use glam::{Affine3A, EulerRot, Quat, Vec3};

use super::formula;
use super::report::short;
use crate::anim::{JointIndex, Transform};
use crate::asset::Asset;
use crate::library::Model;
use crate::state::{Command, ViewerState, degrees_by_hand, title};
use crate::ui::controls::SliderSettings;
use crate::ui::{Output, Shown, UiState, clips, controls, icons, style};

const ROW_HEIGHT: f32 = 26.0;
const LEAST_TREE_HEIGHT: f32 = 8.0 * ROW_HEIGHT;

pub fn show(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let Some(model) = shown.library.active() else { return };
    if local.folded_of != Some(model.id) {
        local.folded_of = Some(model.id);
        local.folded.clear();
        local.joint_search.clear();
        local.scrolled_to = None;
        local.probe.forget();
    }
    let chosen = shown.state.selection.joint.and_then(|joint| model.asset.skeleton.joint_of_source(joint));
    let height = ui.available_height();
    // What is above the tree may need more than all of the room.
    ScrollArea::vertical().id_salt("scene").auto_shrink([false, false]).show(ui, |ui| {
        let top = ui.cursor().top();
        // Room for the bar, as in the other tabs.
        ui.set_max_width(ui.available_width() - controls::BAR);
        ui.add_space(4.0);
        cards(ui, shown, model, chosen, local, out);
        ui.add_space(6.0);
        clips::search_field(ui, &mut local.joint_search, "Search nodes by name");
        ui.add_space(2.0);
        let left = (top + height - ui.cursor().top()).max(LEAST_TREE_HEIGHT);
        ui.allocate_ui(vec2(ui.available_width(), left), |ui| tree(ui, shown, model, local, out));
    });
}

/// The chosen joint and the vertex that is looked at. Presses on the vertex's lines choose joints, so the vertex is above;
/// while it is only a switch, it leaves the room to the joint.
fn cards(
    ui: &mut Ui,
    shown: &Shown<'_>,
    model: &Model,
    chosen: Option<JointIndex>,
    local: &mut UiState,
    out: &mut Output,
) {
    let Some(joint) = chosen else {
        vertex(ui, shown, model, local, out);
        controls::hint(ui, "Choose a joint here or in the picture to see its transforms.");
        return;
    };
    let vertex_first = local.probe.is_on(shown);
    if vertex_first {
        vertex(ui, shown, model, local, out);
    }
    controls::card(ui, |ui| joint_card(ui, shown, model, joint, local, out));
    if !vertex_first {
        vertex(ui, shown, model, local, out);
    }
}

fn vertex(ui: &mut Ui, shown: &Shown<'_>, model: &Model, local: &mut UiState, out: &mut Output) {
    if model.asset.instances.is_empty() {
        return;
    }
    if local.probe.is_on(shown) {
        controls::card(ui, |ui| formula::vertex(ui, shown, model, local, out));
        ui.add_space(6.0);
    } else {
        formula::vertex(ui, shown, model, local, out);
    }
}

/// One line of the tree.
struct Row {
    joint: JointIndex,
    depth: usize,
    has_children: bool,
}

fn rows(asset: &Asset, state: &ViewerState, local: &UiState) -> Vec<Row> {
    let skeleton = &asset.skeleton;
    let wanted = local.joint_search.to_lowercase();
    let mut has_children = vec![false; skeleton.len()];
    for parent in skeleton.parents().iter().flatten() {
        has_children[parent.get()] = true;
    }
    // Joints are sorted depth first, so their order is the tree's; depths follow the parents'.
    let mut depths = vec![0; skeleton.len()];
    let mut hidden = vec![false; skeleton.len()];
    let mut rows = Vec::new();
    for joint in skeleton.joints() {
        if let Some(parent) = skeleton.parent(joint) {
            depths[joint.get()] = depths[parent.get()] + 1;
            hidden[joint.get()] = hidden[parent.get()] || local.folded.contains(&skeleton.source_index(parent));
        }
        if wanted.is_empty() {
            if !hidden[joint.get()] {
                rows.push(Row { joint, depth: depths[joint.get()], has_children: has_children[joint.get()] });
            }
        } else if title(Some(state), asset, joint).to_lowercase().contains(&wanted) {
            rows.push(Row { joint, depth: 0, has_children: false });
        }
    }
    rows
}

fn tree(ui: &mut Ui, shown: &Shown<'_>, model: &Model, local: &mut UiState, out: &mut Output) {
    let asset = &model.asset;
    let mut kinds = vec![Kind::Empty; asset.skeleton.len()];
    for joint in asset.skeleton.joints().filter(|&joint| model.rig().is_real(joint)) {
        kinds[joint.get()] = Kind::Joint;
    }
    for camera in &asset.cameras {
        kinds[camera.joint.get()] = Kind::Camera;
    }
    for light in &asset.lights {
        kinds[light.joint.get()] = Kind::Light;
    }
    for instance in &asset.instances {
        kinds[instance.joint.get()] = Kind::Mesh;
    }
    let rows = rows(asset, shown.state, local);
    if rows.is_empty() {
        controls::hint(ui, format!("No node's name contains “{}”.", local.joint_search));
        return;
    }
    let mut area = ScrollArea::vertical().id_salt(("tree", model.id)).auto_shrink([false, false]);
    if local.scrolled_to != shown.state.selection.joint && local.scroll_next != shown.state.selection.joint {
        // The card of the joint has just taken its room; egui would spring back from where the tree could be before.
        local.scroll_next = shown.state.selection.joint;
        ui.ctx().request_repaint();
    } else if local.scrolled_to != shown.state.selection.joint {
        local.scrolled_to = shown.state.selection.joint;
        let at =
            rows.iter().position(|row| Some(asset.skeleton.source_index(row.joint)) == shown.state.selection.joint);
        if let Some(at) = at {
            // A few rows above it stay in sight, to show where it hangs.
            let most = rows.len() as f32 * ROW_HEIGHT - ui.available_height();
            let wanted = (at as f32 - 4.0) * ROW_HEIGHT;
            area = area.vertical_scroll_offset(wanted.min(most).max(0.0));
        }
    }
    let spacing = std::mem::take(&mut ui.spacing_mut().item_spacing.y);
    area.show_rows(ui, ROW_HEIGHT, rows.len(), |ui, visible| {
        ui.set_max_width(ui.available_width() - controls::BAR);
        for row in rows.get(visible).unwrap_or_default() {
            let source = asset.skeleton.source_index(row.joint);
            let chosen = shown.state.selection.joint == Some(source);
            match tree_row(
                ui,
                row,
                &title(Some(shown.state), asset, row.joint),
                kinds[row.joint.get()],
                chosen,
                local.folded.contains(&source),
            ) {
                Some(Pressed::Row) => {
                    (local.scrolled_to, local.scroll_next) = (Some(source), Some(source));
                    out.commands.push(Command::SelectJoint((!chosen).then_some(source)));
                }
                Some(Pressed::Fold) => {
                    let was_folded = local.folded.remove(&source);
                    if !was_folded {
                        local.folded.insert(source);
                    }
                }
                None => {}
            }
        }
    });
    ui.spacing_mut().item_spacing.y = spacing;
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Empty,
    Joint,
    Mesh,
    Camera,
    Light,
}

enum Pressed {
    Row,
    Fold,
}

fn tree_row(ui: &mut Ui, row: &Row, name: &str, kind: Kind, chosen: bool, folded: bool) -> Option<Pressed> {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW_HEIGHT), Sense::click());
    let role = egui::accesskit::Role::TreeItem;
    response.widget_info(|| WidgetInfo::selected(role, true, chosen, name));
    let palette = style::palette(ui);
    let fill = if chosen {
        palette.chosen
    } else if response.hovered() {
        palette.hover
    } else {
        Color32::TRANSPARENT
    };
    ui.painter().rect_filled(rect.shrink2(vec2(0.0, 1.0)), 5.0, fill);
    // Deep rigs stay readable: the indent grows ever more slowly.
    let depth = row.depth as f32;
    let indent = if depth <= 8.0 { depth * 11.0 } else { 88.0 + (depth - 8.0) * 3.0 };
    let x = rect.left() + 4.0 + indent.min(rect.width() * 0.55);
    let mut pressed = response.clicked().then_some(Pressed::Row);
    if row.has_children {
        let center = pos2(x + 6.0, rect.center().y);
        let grab = Rect::from_center_size(center, vec2(18.0, ROW_HEIGHT));
        let fold = ui.interact(grab, ui.scope_id().with(("fold", row.joint.0)), Sense::click());
        let label = format!("{} {name}", if folded { "Unfold" } else { "Fold" });
        fold.widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Button, true, &label));
        if fold.clicked() {
            pressed = Some(Pressed::Fold);
        }
        let (a, b) = if folded { (vec2(-2.0, -4.0), vec2(-2.0, 4.0)) } else { (vec2(-4.0, -2.0), vec2(4.0, -2.0)) };
        let tip = if folded { vec2(3.0, 0.0) } else { vec2(0.0, 3.0) };
        let color = if fold.hovered() { palette.text } else { palette.weak_text };
        ui.painter().add(Shape::convex_polygon(vec![center + a, center + tip, center + b], color, Stroke::NONE));
    }
    kind_mark(ui, kind, pos2(x + 20.0, rect.center().y), palette);
    let text = Rect::from_min_max(pos2(x + 32.0, rect.top()), rect.right_bottom() - vec2(6.0, 0.0));
    let color = if chosen {
        palette.accent
    } else if kind == Kind::Empty {
        palette.weak_text
    } else {
        palette.text
    };
    if controls::elided(ui, text, name, color) {
        response.on_hover_text(name);
    }
    pressed
}

fn kind_mark(ui: &Ui, kind: Kind, center: egui::Pos2, palette: style::Palette) {
    let painter = ui.painter();
    let line = Stroke::new(1.3, palette.weak_text);
    match kind {
        Kind::Empty => {
            painter.circle_stroke(center, 3.0, line);
        }
        Kind::Joint => {
            painter.circle_filled(center, 3.5, palette.accent);
        }
        Kind::Mesh => {
            let points = [vec2(0.0, -5.0), vec2(5.0, 4.0), vec2(-5.0, 4.0)].map(|corner| center + corner);
            painter.add(Shape::closed_line(points.to_vec(), line));
        }
        Kind::Camera => {
            let body = Rect::from_center_size(center - vec2(1.5, 0.0), vec2(8.0, 7.0));
            painter.rect_stroke(body, 1.5, line, egui::StrokeKind::Middle);
            painter.line_segment([center + vec2(3.0, 0.0), center + vec2(6.0, -3.0)], line);
            painter.line_segment([center + vec2(3.0, 0.0), center + vec2(6.0, 3.0)], line);
        }
        Kind::Light => {
            painter.circle_filled(center, 2.5, palette.warning);
            for step in 0..8 {
                let way = egui::Vec2::angled(step as f32 * std::f32::consts::FRAC_PI_4);
                painter.line_segment([center + way * 4.0, center + way * 5.5], Stroke::new(1.2, palette.warning));
            }
        }
    }
}

fn joint_card(ui: &mut Ui, shown: &Shown<'_>, model: &Model, joint: JointIndex, panel: &mut UiState, out: &mut Output) {
    let asset = &model.asset;
    ui.horizontal(|ui| {
        let width = ui.available_width() - 100.0;
        ui.scope(|ui| {
            ui.set_max_width(width);
            name(ui, shown, asset, joint, panel, out);
        });
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let close = icons::icon_button_sized(ui, icons::Icon::Close, "Choose no joint", false, 24.0);
            if close.clicked() {
                out.commands.push(Command::SelectJoint(None));
            }
            if panel.renaming.is_none() && ui.small_button("Rename").clicked() {
                let name = title(Some(shown.state), asset, joint).into_owned();
                panel.renaming = Some((asset.skeleton.source_index(joint), name));
            }
        });
    });
    let local = shown.frame.pose().locals.get(joint.get()).copied().unwrap_or_default();
    ui.add_space(2.0);
    if controls::switch(ui, "Turn by hand", panel.turning) {
        panel.turning = !panel.turning;
        if shown.state.camera_options.turntable != 0.0 {
            out.commands.push(Command::SetTurntable(0.0));
        }
    }
    if panel.turning {
        by_hand(ui, shown, asset, joint, local.rotation, out);
    }
    if !shown.state.edits.pose.is_empty() {
        let count = shown.state.edits.pose.len();
        let is_turned = shown.state.edits.pose.contains_key(&asset.skeleton.source_index(joint));
        ui.horizontal_wrapped(|ui| {
            if ui.add_enabled(is_turned, egui::Button::new("Reset joint")).clicked() {
                out.commands.push(Command::SetPose { joint: asset.skeleton.source_index(joint), degrees: None });
            }
            let all = format!("Reset all {count}");
            if ui.button(all).on_hover_text("Gives all joints turned by hand back to the clip").clicked() {
                out.commands.push(Command::ClearPose);
            }
        });
    }
    // The matrices say the same in another way.
    if !panel.matrices {
        parts(ui, shown, asset, joint, &local);
    }
    if controls::switch(ui, "Matrices", panel.matrices) {
        panel.matrices = !panel.matrices;
    }
    if panel.matrices {
        ui.scope(|ui| formula::matrices(ui, shown, model, joint));
    }
}

/// Translation, rotation and scale: below the parent, and in the world.
fn parts(ui: &mut Ui, shown: &Shown<'_>, asset: &Asset, joint: JointIndex, local: &Transform) {
    let parent =
        asset.skeleton.parent(joint).map_or("no parent".into(), |parent| title(Some(shown.state), asset, parent));
    let (heads, _) = ui.allocate_exact_size(vec2(ui.available_width(), 12.0), Sense::hover());
    for (axis, name) in ["X", "Y", "Z"].into_iter().enumerate() {
        let right = heads.left() + 60.0 + (heads.width() - 60.0) / 3.0 * (axis + 1) as f32;
        let (at, font) = (pos2(right, heads.center().y), egui::FontId::proportional(11.0));
        ui.painter().text(at, egui::Align2::RIGHT_CENTER, name, font, style::palette(ui).weak_text);
    }
    transform(ui, &format!("Local, in {parent}"), local);
    let character = shown.frame.characters.first();
    if let Some(world) = character.and_then(|character| character.world_from_joint.get(joint.get())) {
        transform(ui, "World", &decomposed(world));
    }
}

/// The joint's name, or the field to change it in: Enter or a press elsewhere takes it, Esc does not.
fn name(ui: &mut Ui, shown: &Shown<'_>, asset: &Asset, joint: JointIndex, panel: &mut UiState, out: &mut Output) {
    let number = asset.skeleton.source_index(joint);
    let Some((_, typed)) = panel.renaming.as_mut().filter(|(of, _)| *of == number) else {
        panel.renaming = None;
        let name = RichText::new(title(Some(shown.state), asset, joint)).strong().size(15.0);
        ui.add(egui::Label::new(name).truncate().selectable(true));
        return;
    };
    let in_file = asset.skeleton.name(joint);
    let field = egui::TextEdit::singleline(typed).hint_text(in_file).desired_width(f32::INFINITY);
    let field = ui.add(field).accessible_name("Name of the joint");
    let given_up = ui.input(|input| input.key_pressed(egui::Key::Escape));
    if field.lost_focus() {
        if !given_up {
            out.commands.push(Command::RenameJoint { joint: number, name: typed.clone() });
        }
        panel.renaming = None;
    } else if !field.has_focus() {
        field.request_focus();
    }
}

/// Three angles from the joint's rest; they follow the clip until they are touched.
fn by_hand(ui: &mut Ui, shown: &Shown<'_>, asset: &Asset, joint: JointIndex, rotation: Quat, out: &mut Output) {
    let number = asset.skeleton.source_index(joint);
    let rest = asset.skeleton.rest().locals.get(joint.get()).map_or(Quat::IDENTITY, |local| local.rotation);
    let now = shown.state.edits.pose.get(&number).copied().unwrap_or_else(|| degrees_by_hand(rest, rotation));
    // Never minus nothing.
    let now = now.map(|angle| angle + 0.0);
    controls::hint(ui, "From its rest: about its X, then its Y, then its Z. Or drag the rings in the picture.");
    for (axis, name) in ["Turn X", "Turn Y", "Turn Z"].into_iter().enumerate() {
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

fn transform(ui: &mut Ui, title: &str, value: &Transform) {
    let palette = style::palette(ui);
    ui.add_space(4.0);
    ui.add(egui::Label::new(RichText::new(title).small().color(palette.weak_text)).truncate());
    let (x, y, z) = value.rotation.normalize_or_identity().to_euler(EulerRot::XYZ);
    let degrees = Vec3::new(x, y, z) * (180.0 / std::f32::consts::PI);
    let rows = [("Position", value.translation, " m"), ("Rotation", degrees, "°"), ("Scale", value.scale, "")];
    for (name, numbers, unit) in rows {
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::hover());
        let font = egui::FontId::proportional(12.5);
        ui.painter().text(rect.left_center(), egui::Align2::LEFT_CENTER, name, font, palette.weak_text);
        let font = egui::FontId::monospace(12.0);
        let width = (rect.width() - 60.0) / 3.0;
        let texts = numbers.to_array().map(|number| match unit {
            "°" => formula::fixed(number, 1) + "°",
            _ => short(number),
        });
        for (column, text) in texts.iter().enumerate() {
            let at = pos2(rect.left() + 60.0 + width * (column + 1) as f32, rect.center().y);
            ui.painter().text(at, egui::Align2::RIGHT_CENTER, text, font.clone(), palette.text);
        }
        let whole = format!("{name} {}", texts.join(" "));
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
    format!("Quaternion x {x:.5}  y {y:.5}  z {z:.5}  w {w:.5}\nAngles are about X, then Y, then Z of the joint.")
}

trait NormalizeOrIdentity {
    fn normalize_or_identity(self) -> Quat;
}

impl NormalizeOrIdentity for Quat {
    fn normalize_or_identity(self) -> Quat {
        if self.length_squared() > 0.0 && self.is_finite() { self.normalize() } else { Quat::IDENTITY }
    }
}
