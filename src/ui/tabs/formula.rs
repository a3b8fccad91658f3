//! The formula of skinning with its numbers: three matrices of the chosen joint, and what each joint does to one vertex.

use egui::{Align2, FontId, Painter, Rect, Response, RichText, Sense, Ui, WidgetInfo, pos2, vec2};
use glam::{Affine3A, Mat4, Vec2, Vec3};

use crate::anim::JointIndex;
use crate::frame::{VertexFormula, joint_matrices, pick_vertex, vertex_formula};
use crate::library::Model;
use crate::mesh::{DeformedVertices, SkinningMode};
use crate::state::{Command, VertexChoice, title};
use crate::ui::viewport::picture::{pane_at, to_screen};
use crate::ui::{Output, Shown, UiState, controls, style};

const LINE: f32 = 17.0;

/// What the vertex part remembers between passes.
#[derive(Debug, Default)]
pub struct Probe {
    /// Vertices are looked for under the pointer.
    on: bool,
    /// The one that was found last, where none is kept.
    hovered: Option<VertexChoice>,
    looked_at: Option<egui::Pos2>,
    /// There was one.
    is_hit: bool,
    formula: VertexFormula,
    scratch: DeformedVertices,
}

impl Probe {
    pub fn is_on(&self, shown: &Shown<'_>) -> bool {
        self.on || shown.state.selection.vertex.is_some()
    }

    /// Another model has other vertices.
    pub fn forget(&mut self) {
        (self.hovered, self.looked_at, self.is_hit) = (None, None, false);
    }

    fn vertex(&self, shown: &Shown<'_>) -> Option<VertexChoice> {
        shown.state.selection.vertex.or(self.hovered)
    }
}

/// What the pointer does to the picture while vertices are looked for: true when it is on the mesh.
pub fn point_at_vertex(response: &Response, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) -> bool {
    if !local.probe.is_on(shown) || shown.state.page.embed {
        return false;
    }
    let clicked = response.clicked();
    let at = if clicked { response.interact_pointer_pos() } else { response.hover_pos() };
    let Some(at) = at.filter(|_| !response.dragged()) else { return false };
    // A vertex that is kept stays; one under a pointer at rest as well, however the model moves.
    if !clicked && (shown.state.selection.vertex.is_some() || local.probe.looked_at == Some(at)) {
        return local.probe.is_hit && shown.state.selection.vertex.is_none();
    }
    local.probe.looked_at = Some(at);
    let found = vertex_at(shown, response.rect, at, &mut local.probe.scratch);
    local.probe.is_hit = found.is_some();
    if clicked && found != shown.state.selection.vertex {
        out.commands.push(Command::SelectVertex(found));
    } else if found.is_some() {
        local.probe.hovered = found;
    }
    // The joints behind it are not named meanwhile.
    if found.is_some() {
        (local.hovered, local.hovered_joint) = (None, None);
    }
    found.is_some()
}

fn vertex_at(shown: &Shown<'_>, rect: Rect, at: egui::Pos2, scratch: &mut DeformedVertices) -> Option<VertexChoice> {
    let model = shown.library.active()?;
    let pane = pane_at(shown, rect, Some(at));
    let part = (at - pane.min) / pane.size();
    let point = Vec2::new(2.0 * part.x - 1.0, 1.0 - 2.0 * part.y);
    pick_vertex(model, shown.frame, shown.frame.characters.first()?, point, scratch)
}

/// A dot on the vertex and its number.
pub fn mark(ui: &Ui, painter: &Painter, pane: Rect, shown: &Shown<'_>, local: &mut UiState) -> Option<()> {
    let choice = local.probe.vertex(shown).filter(|_| local.probe.is_on(shown) && !shown.state.page.embed)?;
    let (model, character) = (shown.library.active()?, shown.frame.characters.first()?);
    let formula = &mut local.probe.formula;
    if !vertex_formula(model, character, choice, formula) {
        return None;
    }
    let at = to_screen(shown, pane, formula.drawn)?;
    let palette = style::palette(ui);
    painter.circle(at, 4.0, palette.accent, egui::Stroke::new(2.0, palette.panel));
    let text = vertex_title(model, choice);
    let galley = painter.layout_no_wrap(text, FontId::proportional(13.0), palette.text);
    let half = galley.size().x / 2.0 + 8.0;
    let x = at.x.clamp(pane.left() + half, (pane.right() - half).max(pane.left() + half));
    // Below the vertex, where there is room for it.
    let below = if at.y + 34.0 < pane.bottom() - 12.0 { 22.0 } else { -22.0 };
    let box_ = Rect::from_center_size(pos2(x, at.y + below), galley.size() + vec2(16.0, 6.0));
    painter.rect_filled(box_, 6.0, palette.panel.gamma_multiply(0.92));
    painter.galley(box_.center() - galley.size() / 2.0, galley, palette.text);
    Some(())
}

fn vertex_title(model: &Model, choice: VertexChoice) -> String {
    let mesh = model.asset.instances.get(choice.instance).and_then(|instance| model.asset.meshes.get(instance.mesh));
    let piece = mesh.and_then(|mesh| mesh.primitives.get(choice.primitive));
    format!("Vertex {}", piece.map_or(choice.vertex, |piece| piece.number_in_file(choice.vertex)))
}

/// The three matrices of a joint; nothing for one that no skin names.
pub fn matrices(ui: &mut Ui, shown: &Shown<'_>, model: &Model, joint: JointIndex) {
    let found = shown.frame.characters.first().and_then(|character| joint_matrices(model, character, joint));
    let Some(found) = found else {
        controls::hint(ui, "No mesh is bound to this joint.");
        return;
    };
    controls::hint(ui, "A joint moves the mesh by T · inv(B).");
    ui.spacing_mut().item_spacing.y = 1.0;
    matrix(ui, "inv(B)", "at bind: world to joint", &found.joint_from_bind);
    matrix(ui, "T", "now: joint to world", &found.world_from_joint);
    matrix(ui, "T · inv(B)", "bound place to present one", &found.world_from_bind());
}

fn matrix(ui: &mut Ui, name: &str, what: &str, matrix: &Affine3A) {
    let palette = style::palette(ui);
    ui.add_space(3.0);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        ui.label(RichText::new(name).strong());
        ui.label(RichText::new(what).small().color(palette.weak_text));
    });
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 4.0 * LINE), Sense::hover());
    let rows = Mat4::from(*matrix).transpose().to_cols_array_2d();
    let mut text = String::new();
    for (row, numbers) in rows.iter().enumerate() {
        let y = rect.top() + LINE * (row as f32 + 0.5);
        for (column, &number) in numbers.iter().enumerate() {
            let written = fixed(number, decimals(number));
            let right = rect.left() + rect.width() / 4.0 * (column + 1) as f32;
            let font = FontId::monospace(12.0);
            ui.painter().text(pos2(right, y), Align2::RIGHT_CENTER, &written, font, palette.text);
            text.push(' ');
            text.push_str(&written);
        }
    }
    response.widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Label, true, format!("{name}:{text}")));
}

/// The switch for looking at vertices, and the formula at the one that was found.
pub fn vertex(ui: &mut Ui, shown: &Shown<'_>, model: &Model, local: &mut UiState, out: &mut Output) {
    let on = local.probe.is_on(shown);
    if controls::switch(ui, "Vertex under the pointer", on) {
        local.probe.on = !on;
        local.probe.hovered = None;
        if on && shown.state.selection.vertex.is_some() {
            out.commands.push(Command::SelectVertex(None));
        }
    }
    if !on {
        return;
    }
    let mut formula = std::mem::take(&mut local.probe.formula);
    let choice = local.probe.vertex(shown);
    let character = shown.frame.characters.first();
    let found = match (choice, character) {
        (Some(choice), Some(character)) if vertex_formula(model, character, choice, &mut formula) => Some(choice),
        _ => None,
    };
    match found {
        Some(choice) => {
            ui.scope(|ui| table(ui, shown, model, choice, &formula, out));
        }
        None => controls::hint(ui, "Point at the mesh to see which joints move a vertex. A click keeps it."),
    }
    local.probe.formula = formula;
}

fn table(
    ui: &mut Ui,
    shown: &Shown<'_>,
    model: &Model,
    choice: VertexChoice,
    formula: &VertexFormula,
    out: &mut Output,
) {
    let palette = style::palette(ui);
    ui.horizontal(|ui| {
        ui.label(RichText::new(vertex_title(model, choice)).strong());
        if shown.state.selection.vertex.is_some() {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.small_button("Let go").on_hover_text("Look at what is under the pointer again").clicked() {
                    out.commands.push(Command::SelectVertex(None));
                }
            });
        }
    });
    controls::hint(ui, "p' = Σ w · T · inv(B) · p, one line for each joint j with a weight w:");
    ui.spacing_mut().item_spacing.y = 1.0;
    // All numbers of the card with the same decimals, so that they can be added up.
    let largest = formula.terms.iter().map(|part| part.alone.abs().max_element()).fold(0.0, f32::max);
    let digits = decimals(largest.max(formula.bound.abs().max_element()));
    heads(ui);
    numbers(ui, "p", "where it is bound", formula.bound, digits, true);
    for part in &formula.terms {
        let name = title(Some(shown.state), &model.asset, part.joint);
        let number = model.asset.skeleton.source_index(part.joint);
        ui.add_space(3.0);
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 21.0), Sense::click());
        let chosen = shown.state.selection.joint == Some(number);
        let label = format!("{name}, weight {:.4}", part.weight);
        let role = egui::accesskit::Role::Button;
        response.widget_info(|| WidgetInfo::selected(role, true, chosen, &label));
        if response.hovered() || chosen {
            let fill = if chosen { palette.chosen } else { palette.hover };
            ui.painter().rect_filled(rect.expand2(vec2(4.0, 0.0)), 4.0, fill);
        }
        let bar = Rect::from_min_size(rect.left_bottom() - vec2(0.0, 2.0), vec2(rect.width() * part.weight, 2.0));
        ui.painter().rect_filled(bar, 1.0, palette.accent);
        let color = if chosen { palette.accent } else { palette.text };
        controls::elided(ui, rect.with_max_x(rect.right() - 76.0), &name, color);
        let weight = format!("w {:.4}", part.weight);
        ui.painter().text(rect.right_center(), Align2::RIGHT_CENTER, weight, FontId::monospace(12.0), palette.text);
        if response.clicked() {
            out.commands.push(Command::SelectJoint((!chosen).then_some(number)));
        }
        numbers(ui, "alone", "T · inv(B) · p", part.alone, digits, false);
        numbers(ui, "share", "w times that", part.share, digits, false);
    }
    ui.add_space(2.0);
    ui.separator();
    numbers(ui, "p'", "the sum of the shares", formula.sum, digits, true);
    if shown.state.display.skinning != SkinningMode::Linear {
        numbers(ui, "drawn", "with the skinning that is chosen", formula.drawn, digits, true);
        controls::hint(ui, "The sum is what linear skinning draws; another way is chosen in the Display tab.");
    }
}

/// Where the number of a column ends, in a line of a name and three numbers.
fn column_end(line: Rect, column: usize) -> f32 {
    const NAME_WIDTH: f32 = 44.0;
    line.left() + NAME_WIDTH + (line.width() - NAME_WIDTH) / 3.0 * (column + 1) as f32
}

/// Above the numbers: which axis they are of.
fn heads(ui: &mut Ui) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), LINE), Sense::hover());
    for (column, axis) in ["X", "Y", "Z"].into_iter().enumerate() {
        let at = pos2(column_end(rect, column), rect.center().y);
        ui.painter().text(at, Align2::RIGHT_CENTER, axis, FontId::proportional(11.0), style::palette(ui).weak_text);
    }
}

/// A name and three numbers.
fn numbers(ui: &mut Ui, name: &str, what: &str, value: Vec3, digits: usize, strong: bool) {
    let palette = style::palette(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), LINE), Sense::hover());
    let color = if strong { palette.text } else { palette.weak_text };
    let font = FontId::proportional(if strong { 13.0 } else { 12.0 });
    ui.painter().text(rect.left_center(), Align2::LEFT_CENTER, name, font, color);
    let mut text = format!("{name}, {what}:");
    for (column, number) in value.to_array().into_iter().enumerate() {
        let written = fixed(number, digits);
        let at = pos2(column_end(rect, column), rect.center().y);
        ui.painter().text(at, Align2::RIGHT_CENTER, &written, FontId::monospace(12.0), color);
        text.push(' ');
        text.push_str(&written);
    }
    response.widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Label, true, &text));
    response.on_hover_text(what);
}

/// So many that five or six digits are written.
fn decimals(number: f32) -> usize {
    match number.abs() {
        size if size < 10.0 => 4,
        size if size < 100.0 => 3,
        size if size < 1000.0 => 2,
        _ => 1,
    }
}

/// Never minus nothing.
pub fn fixed(number: f32, digits: usize) -> String {
    let text = format!("{number:.digits$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|byte| matches!(byte, b'0' | b'.')) => rest.to_owned(),
        _ => text,
    }
}
