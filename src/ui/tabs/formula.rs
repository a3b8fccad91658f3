//! The skinning equation with its numbers: the matrices of the selected joint, and each joint's contribution to one vertex.

use egui::{Align2, Painter, Rect, Response, RichText, Sense, Ui, WidgetInfo, pos2, vec2};
use gaitway_character::anim::JointIndex;
use gaitway_character::mesh::{DeformedVertices, SkinningMode};
use gaitway_scene::frame::{Character, FormulaTerm, VertexFormula, joint_matrices, pick_vertex, vertex_formula};
use gaitway_scene::library::{Model, ModelId};
use gaitway_scene::state::{Command, Comparison, VertexChoice, title};
use glam::{Affine3A, Mat4, Vec3};

use crate::ui::viewport::panes::{pane_index, pane_rects, to_ndc, to_screen};
use crate::ui::{Output, Shown, UiState, controls, style, text};

const LINE: f32 = 17.0;

/// Inspects the vertex under the pointer, or a pinned one.
#[derive(Debug, Default)]
pub struct VertexProbe {
    is_switched_on: bool,
    /// The model that has what was found.
    model: Option<ModelId>,
    /// The vertex last found under the pointer.
    hovered: Option<VertexChoice>,
    /// Where the last search was, and whether it found one.
    searched_at: Option<egui::Pos2>,
    is_hit: bool,
    formula: VertexFormula,
    scratch: DeformedVertices,
}

impl VertexProbe {
    pub fn is_on(&self, shown: &Shown<'_>) -> bool {
        self.is_switched_on || shown.state.selection.vertex.is_some()
    }

    /// Forgets the vertex of another model than this.
    pub fn keep_to(&mut self, model: Option<ModelId>) {
        if std::mem::replace(&mut self.model, model) != model {
            (self.hovered, self.searched_at, self.is_hit) = (None, None, false);
        }
    }

    fn vertex(&self, shown: &Shown<'_>) -> Option<VertexChoice> {
        shown.state.selection.vertex.or(self.hovered)
    }

    /// The switch, and the equation at the vertex.
    pub fn show(&mut self, ui: &mut Ui, shown: &Shown<'_>, model: &Model, out: &mut Output) {
        let is_on = self.is_on(shown);
        if controls::switch(ui, text::VERTEX_PROBE, is_on) {
            self.is_switched_on = !is_on;
            self.hovered = None;
            if is_on && shown.state.selection.vertex.is_some() {
                out.commands.push(Command::SelectVertex(None));
            }
        }
        if !is_on {
            return;
        }
        let formula = &mut self.formula;
        let choice = shown.state.selection.vertex.or(self.hovered);
        let found = choice.zip(shown.frame.characters.first());
        match found.filter(|(choice, character)| vertex_formula(model, character, *choice, formula)) {
            Some((choice, _)) => _ = ui.scope(|ui| equation(ui, shown, model, choice, formula, out)),
            None => controls::hint(ui, text::VERTEX_HINT),
        }
    }
}

/// Finds the vertex under the pointer while the probe is on; returns whether the pointer is on the mesh.
pub fn point_at_vertex(response: &Response, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) -> bool {
    if !local.vertex_probe.is_on(shown) || shown.state.page.embed.is_on() {
        return false;
    }
    let clicked = response.clicked();
    let at = if clicked { response.interact_pointer_pos() } else { response.hover_pos() };
    let Some(at) = at.filter(|_| !response.dragged()) else { return false };
    // A pinned vertex stays, and so does the vertex under a resting pointer, however the model moves.
    if !clicked && (shown.state.selection.vertex.is_some() || local.vertex_probe.searched_at == Some(at)) {
        return local.vertex_probe.is_hit && shown.state.selection.vertex.is_none();
    }
    local.vertex_probe.searched_at = Some(at);
    let found = vertex_at(shown, response.rect, at, &mut local.vertex_probe.scratch);
    local.vertex_probe.is_hit = found.is_some();
    if clicked && found != shown.state.selection.vertex {
        out.commands.push(Command::SelectVertex(found));
    } else if found.is_some() {
        local.vertex_probe.hovered = found;
    }
    // The mesh hides the joints behind it.
    if found.is_some() {
        local.viewport.clear_hover();
    }
    found.is_some()
}

/// Returns the joint, by its file's number, that moves the surface under a point most.
pub fn joint_of_surface(shown: &Shown<'_>, rect: Rect, at: egui::Pos2) -> Option<usize> {
    if !shown.state.display.show.mesh {
        return None;
    }
    let choice = vertex_at(shown, rect, at, &mut DeformedVertices::default())?;
    let model = shown.library.active()?;
    let mut formula = VertexFormula::default();
    vertex_formula(model, shown.frame.characters.first()?, choice, &mut formula);
    Some(model.asset.skeleton.source_index(formula.terms.first()?.joint))
}

fn vertex_at(shown: &Shown<'_>, rect: Rect, at: egui::Pos2, scratch: &mut DeformedVertices) -> Option<VertexChoice> {
    let model = shown.library.active()?;
    let panes = pane_rects(shown, rect);
    let pane = pane_index(&panes, Some(at));
    pick_vertex(model, shown.frame, character_in(shown, pane)?, to_ndc(panes[pane], at), scratch)
}

/// The character of a pane; without a comparison, the only one of the model.
fn character_in<'a>(shown: &Shown<'a>, pane: usize) -> Option<&'a Character> {
    let characters = &shown.frame.characters;
    if shown.frame.comparison.is_some() { characters.get(pane) } else { characters.first() }
}

/// Marks the vertex with a dot and its number in a pane, given its index and rectangle.
pub fn mark(
    ui: &Ui,
    painter: &Painter,
    (index, pane): (usize, Rect),
    shown: &Shown<'_>,
    local: &mut UiState,
) -> Option<()> {
    let choice = local
        .vertex_probe
        .vertex(shown)
        .filter(|_| local.vertex_probe.is_on(shown) && !shown.state.page.embed.is_on())?;
    let (model, character) = (shown.library.active()?, character_in(shown, index)?);
    let formula = &mut local.vertex_probe.formula;
    if !vertex_formula(model, character, choice, formula) {
        return None;
    }
    let at = to_screen(shown, pane, formula.drawn)?;
    let palette = style::palette(ui);
    painter.circle(at, 4.0, palette.accent, egui::Stroke::new(2.0, palette.panel));
    let text = vertex_title(model, choice);
    let galley = painter.layout_no_wrap(text, style::SMALL, palette.text);
    let half = galley.size().x / 2.0 + 8.0;
    let x = at.x.clamp(pane.left() + half, (pane.right() - half).max(pane.left() + half));
    // Below the vertex if there is room.
    let below = if at.y + 34.0 < pane.bottom() - 12.0 { 22.0 } else { -22.0 };
    let frame = Rect::from_center_size(pos2(x, at.y + below), galley.size() + vec2(16.0, 6.0));
    painter.rect_filled(frame, style::CORNER, palette.panel.gamma_multiply(0.92));
    painter.galley(frame.center() - galley.size() / 2.0, galley, palette.text);
    Some(())
}

fn vertex_title(model: &Model, choice: VertexChoice) -> String {
    let mesh = model.asset.instances.get(choice.instance).and_then(|instance| model.asset.meshes.get(instance.mesh));
    let primitive = mesh.and_then(|mesh| mesh.primitives.get(choice.primitive));
    text::vertex(primitive.map_or(choice.vertex, |primitive| primitive.number_in_file(choice.vertex)))
}

/// The three matrices of a joint that a skin uses.
pub fn matrices(ui: &mut Ui, shown: &Shown<'_>, model: &Model, joint: JointIndex) {
    let found = shown.frame.characters.first().and_then(|character| joint_matrices(model, character, joint));
    let Some(found) = found else {
        controls::hint(ui, "No mesh is bound to this joint.");
        return;
    };
    controls::hint(ui, "A joint moves the mesh by T · inv(B).");
    ui.spacing_mut().item_spacing.y = 1.0;
    matrix(ui, text::INVERSE_BIND, "bind pose: world to joint", &found.joint_from_bind);
    matrix(ui, text::WORLD_MATRIX, "current pose: joint to world", &found.world_from_joint);
    matrix(ui, text::SKINNING_MATRIX, "bind pose to current pose", &found.world_from_bind());
}

fn matrix(ui: &mut Ui, name: &str, meaning: &str, matrix: &Affine3A) {
    let palette = style::palette(ui);
    ui.add_space(3.0);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        ui.label(RichText::new(name).strong());
        ui.label(RichText::new(meaning).small().color(palette.weak_text));
    });
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 4.0 * LINE), Sense::hover());
    let rows = Mat4::from(*matrix).transpose().to_cols_array_2d();
    let mut text = String::new();
    for (row, numbers) in rows.iter().enumerate() {
        let y = rect.top() + LINE * (row as f32 + 0.5);
        for (column, &number) in numbers.iter().enumerate() {
            let written = fixed(number, decimals(number));
            let right = rect.left() + rect.width() / 4.0 * (column + 1) as f32;
            ui.painter().text(pos2(right, y), Align2::RIGHT_CENTER, &written, style::SMALL, palette.text);
            text.push(' ');
            text.push_str(&written);
        }
    }
    response.widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Label, true, format!("{name}:{text}")));
}

fn equation(
    ui: &mut Ui,
    shown: &Shown<'_>,
    model: &Model,
    choice: VertexChoice,
    formula: &mut VertexFormula,
    out: &mut Output,
) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(vertex_title(model, choice)).strong());
        if shown.state.selection.vertex.is_some() {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let unpin = controls::small_button(ui, text::UNPIN_VERTEX);
                if unpin.on_hover_text("Inspect the vertex under the pointer again").clicked() {
                    out.commands.push(Command::SelectVertex(None));
                }
            });
        }
    });
    controls::hint(ui, "p' = Σ w · T · inv(B) · p, summed over the joints with a weight w:");
    ui.spacing_mut().item_spacing.y = 1.0;
    // The same number of decimals everywhere, so that the columns add up.
    let largest = formula.terms.iter().map(|term| term.alone.abs().max_element()).fold(0.0, f32::max);
    let digits = decimals(largest.max(formula.bound.abs().max_element()));
    column_heads(ui);
    numbers(ui, text::FormulaRow::Bound, formula.bound, digits, true);
    for term in &formula.terms {
        term_row(ui, shown, model, term, out);
        numbers(ui, text::FormulaRow::Alone, term.alone, digits, false);
        numbers(ui, text::FormulaRow::Share, term.share, digits, false);
    }
    ui.add_space(2.0);
    ui.separator();
    numbers(ui, text::FormulaRow::Sum, formula.sum, digits, true);
    if shown.frame.comparison == Some(Comparison::Skinning) {
        for character in shown.frame.characters.iter().filter(|character| character.skinning != SkinningMode::Linear) {
            if let Some(drawn) = formula.drawn_by(model, character, choice) {
                numbers(ui, text::FormulaRow::DrawnBy(character.skinning), drawn, digits, true);
            }
        }
    } else if shown.state.display.skinning != SkinningMode::Linear {
        numbers(ui, text::FormulaRow::Drawn, formula.drawn, digits, true);
        controls::hint(ui, "The sum is the result of linear skinning; the Display tab sets another method.");
    }
}

/// A joint with its weight; a click selects the joint.
fn term_row(ui: &mut Ui, shown: &Shown<'_>, model: &Model, term: &FormulaTerm, out: &mut Output) {
    let palette = style::palette(ui);
    let name = title(Some(shown.state), &model.asset, term.joint);
    let number = model.asset.skeleton.source_index(term.joint);
    let is_selected = shown.state.selection.joint == Some(number);
    ui.add_space(3.0);
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), controls::row_height(ui, 21.0)), Sense::click());
    let label = text::joint_weight(&name, term.weight);
    let role = egui::accesskit::Role::Button;
    response.widget_info(|| WidgetInfo::selected(role, true, is_selected, &label));
    if response.hovered() || is_selected {
        let fill = if is_selected { palette.chosen } else { palette.hover };
        ui.painter().rect_filled(rect.expand2(vec2(4.0, 0.0)), 4.0, fill);
    }
    let bar = Rect::from_min_size(rect.left_bottom() - vec2(0.0, 2.0), vec2(rect.width() * term.weight, 2.0));
    ui.painter().rect_filled(bar, 1.0, palette.accent);
    let color = if is_selected { palette.accent } else { palette.text };
    controls::elided(ui, rect.with_max_x(rect.right() - 76.0), &name, color);
    let weight = format!("w {:.4}", term.weight);
    ui.painter().text(rect.right_center(), Align2::RIGHT_CENTER, weight, style::SMALL, palette.text);
    if response.clicked() {
        out.commands.push(Command::SelectJoint((!is_selected).then_some(number)));
    }
}

/// Right edge of a column, in a row of a name and three numbers.
fn column_end(line: Rect, column: usize) -> f32 {
    const NAME_WIDTH: f32 = 44.0;
    line.left() + NAME_WIDTH + (line.width() - NAME_WIDTH) / 3.0 * (column + 1) as f32
}

/// The axes above the columns.
fn column_heads(ui: &mut Ui) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), LINE), Sense::hover());
    for (column, axis) in ["X", "Y", "Z"].into_iter().enumerate() {
        let at = pos2(column_end(rect, column), rect.center().y);
        ui.painter().text(at, Align2::RIGHT_CENTER, axis, style::SMALL, style::palette(ui).weak_text);
    }
}

/// A name and three numbers.
fn numbers(ui: &mut Ui, row: text::FormulaRow, value: Vec3, digits: usize, strong: bool) {
    let (name, meaning) = row.name_and_meaning();
    let palette = style::palette(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), LINE), Sense::hover());
    let color = if strong { palette.text } else { palette.weak_text };
    ui.painter().text(rect.left_center(), Align2::LEFT_CENTER, name, style::SMALL, color);
    let mut text = row.label();
    for (column, number) in value.to_array().into_iter().enumerate() {
        let written = fixed(number, digits);
        let at = pos2(column_end(rect, column), rect.center().y);
        ui.painter().text(at, Align2::RIGHT_CENTER, &written, style::SMALL, color);
        text.push(' ');
        text.push_str(&written);
    }
    response.widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Label, true, &text));
    response.on_hover_text(meaning);
}

/// Number of decimals that gives five or six digits.
fn decimals(number: f32) -> usize {
    match number.abs() {
        size if size < 10.0 => 4,
        size if size < 100.0 => 3,
        size if size < 1000.0 => 2,
        _ => 1,
    }
}

/// Formats a number with a fixed number of decimals, and zero without a sign.
pub fn fixed(number: f32, digits: usize) -> String {
    let text = format!("{number:.digits$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|byte| matches!(byte, b'0' | b'.')) => rest.to_owned(),
        _ => text,
    }
}
