//! The Scene tab: every node of the file as a tree, and below it the selected joint and vertex.

use std::collections::{BTreeMap, HashSet};

use egui::{Color32, Key, Rect, ScrollArea, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};
use gaitway_character::anim::JointIndex;
use gaitway_character::asset::Asset;
use gaitway_scene::library::{Model, ModelId};
use gaitway_scene::state::{Command, ViewerState, joints_with_content, title};

use super::{hiding, joint_card};
use crate::ui::motion::namespace;
use crate::ui::search::finds;
use crate::ui::widgets::accessible;
use crate::ui::{Output, Shown, UiState, clips, controls, style, text};

const MIN_ROWS: f32 = 6.0;
/// On a phone, those rows are no more than this share of the tab, so that a selected joint shows below them.
const MAX_SHARE: f32 = 0.55;
/// Minimum share of the tab's height. The tree also takes what is left over below its cards.
const TREE_SHARE: f32 = 0.4;

/// What the tree remembers about one model. Joints are numbered as in the file.
#[derive(Debug, Default)]
pub struct SceneTree {
    model: Option<ModelId>,
    search: String,
    /// See [`namespace`].
    namespace: String,
    /// Joints whose children are hidden.
    collapsed: HashSet<usize>,
    /// The joint that the tree last scrolled to.
    scrolled_to: Option<usize>,
    /// Index of the row that a key leads to: scrolled to, then focused.
    leap: Option<usize>,
    /// Height of the tree and how far it was scrolled, in the last frame.
    height: f32,
    offset: f32,
    /// Height of all else in the tab in the last frame, and whether that was with a selected joint.
    rest: Option<(bool, f32)>,
    /// By joint.
    nodes: Vec<Node>,
    /// `None` at first and after a row is expanded or collapsed.
    rows: Option<Rows>,
}

/// What the tree shows of a node besides its name.
#[derive(Debug, Clone, Copy)]
struct Node {
    kind: Kind,
    /// It or a node below has a mesh or a light, which its eye hides.
    has_content: bool,
    /// Number of warnings in the Info tab about it.
    warnings: usize,
}

fn row_height(ui: &Ui) -> f32 {
    controls::row_height(ui, 26.0)
}

pub fn show(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let Some(model) = shown.library.active() else { return };
    if local.scene_tree.model != Some(model.id) {
        let namespace = namespace(&model.asset).to_owned();
        local.scene_tree = SceneTree { model: Some(model.id), namespace, nodes: nodes(model), ..SceneTree::default() };
    }
    let selected = shown.state.selection.joint.and_then(|joint| model.asset.skeleton.joint_of_source(joint));
    let height = local.scene_tree.height(ui, selected.is_some());
    // Everything scrolls together when there is too little room for the cards.
    controls::scrolled(ui, "scene", |ui| {
        clips::search_field(ui, &mut local.scene_tree.search, text::SEARCH_NODES);
        ui.add_space(2.0);
        let tree =
            ui.allocate_ui(vec2(ui.available_width(), height), |ui| local.scene_tree.show(ui, shown, model, out));
        hiding::show_all(ui, shown, out);
        ui.add_space(6.0);
        cards(ui, shown, model, selected, local, out);
        let content_height = ui.cursor().top() - ui.min_rect().top();
        let rest = Some((selected.is_some(), (content_height - tree.response.rect.height()).ceil()));
        if std::mem::replace(&mut local.scene_tree.rest, rest) != rest {
            ui.ctx().request_repaint();
        }
    });
}

/// The selected joint and vertex. The vertex comes first while it is shown, because its rows select joints; while it is only
/// a switch, it comes last.
fn cards(
    ui: &mut Ui,
    shown: &Shown<'_>,
    model: &Model,
    selected: Option<JointIndex>,
    local: &mut UiState,
    out: &mut Output,
) {
    let vertex_first = local.vertex_probe.is_on(shown);
    if vertex_first {
        vertex(ui, shown, model, local, out);
    }
    match selected {
        Some(joint) => {
            let has_content = local.scene_tree.nodes.get(joint.get()).is_some_and(|node| node.has_content);
            let card = &mut local.joint_card;
            controls::card(ui, |ui| joint_card::show(ui, shown, model, joint, has_content, card, out));
        }
        None => {
            let what = if model.has_skeleton() { "joint" } else { "node" };
            controls::hint(ui, format!("Select a {what} here or in the viewport to see its transforms."));
        }
    }
    if !vertex_first {
        vertex(ui, shown, model, local, out);
    }
}

fn vertex(ui: &mut Ui, shown: &Shown<'_>, model: &Model, local: &mut UiState, out: &mut Output) {
    if model.asset.instances.is_empty() {
        return;
    }
    let probe = &mut local.vertex_probe;
    if probe.is_on(shown) {
        controls::card(ui, |ui| probe.show(ui, shown, model, out));
        ui.add_space(6.0);
    } else {
        probe.show(ui, shown, model, out);
    }
}

/// Cached rows and the inputs they depend on, besides the collapsed joints.
#[derive(Debug)]
struct Rows {
    search: String,
    names: BTreeMap<usize, String>,
    rows: Vec<Row>,
}

/// One row of the tree.
#[derive(Debug)]
struct Row {
    joint: JointIndex,
    depth: usize,
    has_children: bool,
}

impl SceneTree {
    /// The tree's height: its share of the tab, and what its cards leave if there are as many rows. A card that has just
    /// appeared is first laid out below.
    fn height(&self, ui: &Ui, has_selected: bool) -> f32 {
        let room = ui.available_height();
        let usual = (TREE_SHARE * room).max((MIN_ROWS * row_height(ui)).min(MAX_SHARE * room));
        let left = match (self.rest, &self.rows) {
            (Some((of_selected, rest)), Some(kept)) if of_selected == has_selected => {
                (room - rest - controls::SCROLLED_MARGIN).min(kept.rows.len() as f32 * row_height(ui))
            }
            _ => self.height,
        };
        usual.max(left.floor())
    }

    fn show(&mut self, ui: &mut Ui, shown: &Shown<'_>, model: &Model, out: &mut Output) {
        let asset = &model.asset;
        let names = &shown.state.character.edits.names;
        let kept = self.rows.take().filter(|kept| kept.search == self.search && kept.names == *names);
        let kept = kept.unwrap_or_else(|| {
            let rows = self.rows(asset, shown.state);
            Rows { search: self.search.clone(), names: names.clone(), rows }
        });
        let spacing = std::mem::take(&mut ui.spacing_mut().item_spacing.y);
        let is_folded = !kept.rows.is_empty()
            && controls::list(ui, controls::List::Tree, text::NODES, |ui| {
                self.show_rows(ui, shown, model, &kept.rows, out)
            });
        ui.spacing_mut().item_spacing.y = spacing;
        if kept.rows.is_empty() {
            controls::hint(ui, text::no_node_found(&self.search));
        }
        self.rows = (!is_folded).then_some(kept);
    }

    /// Returns whether a row was expanded or collapsed.
    fn show_rows(&mut self, ui: &mut Ui, shown: &Shown<'_>, model: &Model, rows: &[Row], out: &mut Output) -> bool {
        let asset = &model.asset;
        let hidden = &shown.state.character.edits.hidden;
        let mut is_folded = false;
        // The few rows that a search leaves bring the card of the joint closer.
        let is_searching = !self.search.is_empty();
        let mut area = ScrollArea::vertical().id_salt(("tree", model.id)).auto_shrink([false, is_searching]);
        if let Some(offset) = self.scroll_offset(ui, shown, asset, rows) {
            area = area.vertical_scroll_offset(offset);
        }
        let leap = self.leap.take();
        let scrolled = area.show_rows(ui, row_height(ui), rows.len(), |ui, visible| {
            ui.set_max_width(ui.available_width() - controls::SCROLL_BAR_WIDTH);
            let page = visible.len().saturating_sub(2).max(1);
            for (at, row) in rows.iter().enumerate().take(visible.end).skip(visible.start) {
                let number = asset.skeleton.source_index(row.joint);
                let Some(&Node { kind, has_content, warnings }) = self.nodes.get(row.joint.get()) else { continue };
                let name = &*title(Some(shown.state), asset, row.joint);
                let line = Line {
                    name,
                    short_name: name.strip_prefix(&*self.namespace).unwrap_or(name),
                    kind,
                    is_selected: shown.state.selection.joint == Some(number),
                    is_collapsed: self.collapsed.contains(&number),
                    is_shown: has_content.then(|| !hidden.nodes.contains(&number)),
                    warnings,
                    is_dimmed: has_content && !shown.frame.is_visible(row.joint),
                    takes_focus: leap == Some(at),
                };
                match tree_row(ui, row, &line) {
                    Some(Pressed::Row) => {
                        self.scrolled_to = Some(number);
                        out.commands.push(Command::SelectJoint((!line.is_selected).then_some(number)));
                    }
                    Some(Pressed::Eye(pressed)) => {
                        let hidden = match pressed {
                            hiding::Pressed::Toggle => hidden.clone().with_node_toggled(number),
                            hiding::Pressed::Solo => hidden.clone().with_node_soloed(asset, row.joint),
                        };
                        out.commands.push(Command::SetHidden(hidden));
                    }
                    Some(Pressed::Triangle) => {
                        is_folded = true;
                        self.fold(number);
                    }
                    Some(Pressed::Leap(key)) => {
                        self.leap = row_after(key, at, page, rows);
                        ui.ctx().request_repaint();
                    }
                    None => {}
                }
            }
        });
        self.offset = scrolled.state.clamped_offset().y;
        is_folded
    }

    /// Expands or collapses a joint.
    fn fold(&mut self, joint: usize) {
        if !self.collapsed.remove(&joint) {
            self.collapsed.insert(joint);
        }
    }

    /// The rows that the search and the collapsed joints leave.
    fn rows(&self, asset: &Asset, state: &ViewerState) -> Vec<Row> {
        let skeleton = &asset.skeleton;
        if !self.search.is_empty() {
            let is_wanted = |&joint: &JointIndex| finds(&self.search, &title(Some(state), asset, joint));
            return skeleton
                .joints()
                .filter(is_wanted)
                .map(|joint| Row { joint, depth: 0, has_children: false })
                .collect();
        }
        let mut has_children = vec![false; skeleton.len()];
        for parent in skeleton.parents().iter().flatten() {
            has_children[parent.get()] = true;
        }
        // Joints are sorted depth first, so a parent's depth is known before its children's.
        let mut depths = vec![0; skeleton.len()];
        let mut hidden = vec![false; skeleton.len()];
        for joint in skeleton.joints() {
            if let Some(parent) = skeleton.parent(joint) {
                depths[joint.get()] = depths[parent.get()] + 1;
                hidden[joint.get()] = hidden[parent.get()] || self.collapsed.contains(&skeleton.source_index(parent));
            }
        }
        let visible = skeleton.joints().filter(|joint| !hidden[joint.get()]);
        visible
            .map(|joint| Row { joint, depth: depths[joint.get()], has_children: has_children[joint.get()] })
            .collect()
    }

    /// The scroll offset that shows a newly selected joint, or the row that a key leads to.
    fn scroll_offset(&mut self, ui: &Ui, shown: &Shown<'_>, asset: &Asset, rows: &[Row]) -> Option<f32> {
        /// Fewer in a tree that shows few rows, as on a phone.
        const MAX_ROWS_ABOVE: f32 = 4.0;
        let selected = shown.state.selection.joint;
        let find = || rows.iter().position(|row| Some(asset.skeleton.source_index(row.joint)) == selected);
        let height = ui.available_height();
        let last_height = std::mem::replace(&mut self.height, height);
        let max = (rows.len() as f32 * row_height(ui) - height).max(0.0);
        if height > last_height && self.offset > max {
            // Otherwise it would spring back.
            return Some(max);
        }
        if self.leap.is_none() && self.scrolled_to == selected && height < last_height {
            // The card of a joint that was pressed took the room.
            let needed = (find()? + 1) as f32 * row_height(ui) - height;
            return (needed > self.offset).then_some(needed);
        }
        let at = if self.leap.is_some() {
            self.leap
        } else if self.scrolled_to == selected {
            None
        } else {
            self.scrolled_to = selected;
            find()
        }?;
        let rows_above = (0.5 * height / row_height(ui)).floor().min(MAX_ROWS_ABOVE);
        let wanted = (at as f32 - rows_above) * row_height(ui);
        Some(wanted.min(max).max(0.0))
    }
}

fn nodes(model: &Model) -> Vec<Node> {
    let asset = &model.asset;
    let rig = model.rig();
    let node = |(joint, has_content)| {
        let kind = if rig.is_real(joint) { Kind::Joint } else { Kind::Empty };
        Node { kind, has_content, warnings: 0 }
    };
    let mut nodes: Vec<Node> = asset.skeleton.joints().zip(joints_with_content(asset, true)).map(node).collect();
    for camera in &asset.cameras {
        nodes[camera.joint.get()].kind = Kind::Camera;
    }
    for light in &asset.lights {
        nodes[light.joint.get()].kind = Kind::Light;
    }
    for instance in &asset.instances {
        nodes[instance.joint.get()].kind = Kind::Mesh;
    }
    for joint in model.findings().iter().filter_map(|finding| finding.joint) {
        nodes[joint.get()].warnings += 1;
    }
    nodes
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Empty,
    Joint,
    Mesh,
    Camera,
    Light,
}

/// What a row shows.
struct Line<'a> {
    name: &'a str,
    /// The name without the tree's [`namespace`].
    short_name: &'a str,
    kind: Kind,
    is_selected: bool,
    is_collapsed: bool,
    /// Whether it is hidden by its eye; `None` if there is nothing to hide.
    is_shown: Option<bool>,
    /// Number of warnings about it, shown as a dot.
    warnings: usize,
    /// Has content that isn't shown, for whatever reason.
    is_dimmed: bool,
    takes_focus: bool,
}

enum Pressed {
    Row,
    Eye(hiding::Pressed),
    Triangle,
    Leap(Key),
}

fn tree_row(ui: &mut Ui, row: &Row, line: &Line<'_>) -> Option<Pressed> {
    let &Line { name, kind, is_selected, .. } = line;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), row_height(ui)), Sense::click());
    let role = egui::accesskit::Role::TreeItem;
    response.widget_info(|| WidgetInfo::selected(role, true, is_selected, name));
    let is_expanded = row.has_children.then_some(!line.is_collapsed);
    let is_toggled = accessible::tree_item(ui, &response, row.depth, is_expanded);
    let palette = style::palette(ui);
    let fill = if is_selected {
        palette.chosen
    } else if response.hovered() {
        palette.hover
    } else {
        Color32::TRANSPARENT
    };
    ui.painter().rect_filled(rect.shrink2(vec2(0.0, 1.0)), 5.0, fill);
    // The indent grows more slowly at depth, which keeps deep rigs readable.
    let depth = row.depth as f32;
    let indent = if depth <= 8.0 { depth * 11.0 } else { 88.0 + (depth - 8.0) * 3.0 };
    let x = rect.left() + 4.0 + indent.min(rect.width() * 0.55);
    let mut pressed =
        leap(&response, is_expanded == Some(true), line.takes_focus).or(response.clicked().then_some(Pressed::Row));
    if is_toggled || row.has_children && triangle(ui, row, line, pos2(x + 6.0, rect.center().y)) {
        pressed = Some(Pressed::Triangle);
    }
    if let Some(is_shown) = line.is_shown
        && let Some(eye) = hiding::eye(ui, rect, ui.scope_id().with(("eye", row.joint.0)), name, is_shown)
    {
        pressed = Some(Pressed::Eye(eye));
    }
    kind_mark(ui, kind, pos2(x + 20.0, rect.center().y), palette);
    let eye_width = if line.is_shown.is_some() { hiding::EYE_WIDTH } else { 6.0 };
    let warnings = (line.warnings > 0).then(|| text::node_warnings(line.warnings));
    let dot_width = if warnings.is_some() { 12.0 } else { 0.0 };
    let is_hidden = line.is_shown == Some(false);
    if is_hidden || warnings.is_some() {
        let state = is_hidden.then_some(text::HIDDEN_NODE).into_iter().chain(warnings.as_deref());
        let describe = |node: &mut egui::accesskit::Node| node.set_description(state.collect::<Vec<_>>().join(", "));
        ui.ctx().accesskit_node_builder(response.id, describe);
    }
    if warnings.is_some() {
        let at = rect.right_center() - vec2(eye_width + 4.0, 0.0);
        ui.painter().circle_filled(at, 3.0, palette.warning);
    }
    let text = Rect::from_min_max(pos2(x + 32.0, rect.top()), rect.right_bottom() - vec2(eye_width + dot_width, 0.0));
    let color = if is_selected {
        palette.accent
    } else if kind == Kind::Empty || line.is_dimmed {
        palette.weak_text
    } else {
        palette.text
    };
    let is_cut = controls::elided(ui, text, line.short_name, color) || line.short_name != name;
    if is_cut || warnings.is_some() {
        response.on_hover_ui(|ui| {
            if is_cut {
                ui.label(name);
            }
            warnings.into_iter().for_each(|warnings| drop(ui.label(warnings)));
        });
    }
    pressed
}

/// Returns the row that a key leads to, if any.
fn row_after(key: Key, at: usize, page: usize, rows: &[Row]) -> Option<usize> {
    let last = rows.len() - 1;
    match key {
        Key::ArrowLeft => rows[..at].iter().rposition(|row| row.depth < rows[at].depth),
        Key::ArrowRight => Some(at + 1),
        Key::Home => Some(0),
        Key::End => Some(last),
        Key::PageUp => Some(at.saturating_sub(page)),
        _ => Some((at + page).min(last)),
    }
}

/// Gives the focus to a row, and returns the key that leads from it to another one. `is_open`: its children follow it.
fn leap(row: &egui::Response, is_open: bool, takes_focus: bool) -> Option<Pressed> {
    if takes_focus {
        row.request_focus();
    }
    if takes_focus || row.has_focus() {
        let is_pressed = |key: &Key| row.ctx.input(|input| input.key_pressed(*key));
        // The other horizontal arrow opens or closes the row.
        let horizontal = if is_open { Key::ArrowRight } else { Key::ArrowLeft };
        let keys = [Key::Home, Key::End, Key::PageUp, Key::PageDown, horizontal];
        return keys.into_iter().find(is_pressed).map(Pressed::Leap);
    }
    None
}

/// Expands or collapses a row; returns true when clicked.
fn triangle(ui: &Ui, row: &Row, line: &Line<'_>, center: egui::Pos2) -> bool {
    let grab = Rect::from_center_size(center, vec2(18.0, row_height(ui)));
    let response = ui.interact(grab, ui.scope_id().with(("collapse", row.joint.0)), Sense::click());
    let label = if line.is_collapsed { text::expand(line.name) } else { text::collapse(line.name) };
    response.widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Button, true, &label));
    let (a, b, tip) = if line.is_collapsed {
        (vec2(-2.0, -4.0), vec2(-2.0, 4.0), vec2(3.0, 0.0))
    } else {
        (vec2(-4.0, -2.0), vec2(4.0, -2.0), vec2(0.0, 3.0))
    };
    let palette = style::palette(ui);
    let color = if response.hovered() { palette.text } else { palette.weak_text };
    ui.painter().add(Shape::convex_polygon(vec![center + a, center + tip, center + b], color, Stroke::NONE));
    response.clicked()
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
