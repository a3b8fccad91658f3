//! The materials and images of the model in the Info tab. Materials have an eye, images a thumbnail.

use std::sync::Arc;

use egui::{Galley, Id, Rect, Sense, Ui, pos2, vec2};
use gaitway_scene::library::Model;
use gaitway_scene::state::Command;

use super::hiding::{self, Pressed};
use super::lists::{ImageText, Lists, MaterialText};
use crate::ui::{HostState, Output, Shown, controls, style, text};

/// Further materials and images are not listed.
const MAX_ROWS: usize = 200;
const THUMBNAIL: f32 = 36.0;
/// Height of the line with an image's name.
const NAME_HEIGHT: f32 = 20.0;

pub fn show(ui: &mut Ui, shown: &Shown<'_>, model: &Model, lists: &Lists, out: &mut Output) {
    if lists.materials.is_empty() {
        return;
    }
    controls::section(ui, text::MATERIALS);
    for material in lists.materials.iter().take(MAX_ROWS) {
        row(ui, shown, model, material, out);
    }
    hiding::show_all(ui, shown, out);
}

fn row(ui: &mut Ui, shown: &Shown<'_>, model: &Model, material: &MaterialText, out: &mut Output) {
    let hidden = &shown.state.character.edits.hidden;
    let is_shown = !hidden.materials.contains(&material.index);
    // As high as the button that hides the material.
    let name_height = controls::row_height(ui, 22.0);
    let facts = wrapped(ui, &material.facts, ui.available_width());
    let height = name_height + facts.size().y;
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let first = rect.with_max_y(rect.top() + name_height);
    let palette = style::palette(ui);
    let color = if is_shown { palette.text } else { palette.weak_text };
    let id = Id::unique(("material", material.index));
    line(ui, id, first.with_max_x(rect.right() - hiding::EYE_WIDTH), &material.name, color);
    show_wrapped(ui, id.with("facts"), rect.with_min_y(first.bottom()), &material.facts, facts);
    let hidden = match hiding::eye(ui, first, id.with("eye"), &material.name, is_shown) {
        Some(Pressed::Toggle) => hidden.clone().with_material_toggled(material.index),
        Some(Pressed::Solo) => hidden.clone().with_material_soloed(&model.asset, material.index),
        None => return,
    };
    out.commands.push(Command::SetHidden(hidden));
}

/// A line of text; its tooltip has the whole text if it is cut.
fn line(ui: &Ui, id: Id, rect: Rect, text: &str, color: egui::Color32) {
    let response = ui.interact(rect, id, Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Label, true, text));
    if controls::elided(ui, rect, text, color) {
        response.on_hover_text(text);
    }
}

/// Lays small text out for [`show_wrapped`].
fn wrapped(ui: &Ui, text: &str, width: f32) -> Arc<Galley> {
    ui.painter().layout(text.to_owned(), style::SMALL, style::palette(ui).weak_text, width)
}

fn show_wrapped(ui: &Ui, id: Id, rect: Rect, text: &str, galley: Arc<Galley>) {
    let response = ui.interact(rect, id, Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Label, true, text));
    ui.painter().galley(rect.min, galley, style::palette(ui).weak_text);
}

pub fn images(ui: &mut Ui, model: &Model, lists: &Lists, host: &HostState) {
    if lists.images.is_empty() {
        return;
    }
    controls::section(ui, text::IMAGES);
    let thumbnails = if host.thumbnails_of == Some(model.id) { &host.thumbnails[..] } else { &[] };
    for (index, image) in lists.images.iter().enumerate().take(MAX_ROWS) {
        image_row(ui, Id::unique(("image", index)), image, thumbnails.get(index).copied().flatten());
    }
}

fn image_row(ui: &mut Ui, id: Id, image: &ImageText, thumbnail: Option<egui::TextureId>) {
    const GAP: f32 = 8.0;
    let palette = style::palette(ui);
    let width = ui.available_width() - THUMBNAIL - GAP;
    let facts = wrapped(ui, &image.line, width);
    let height = (NAME_HEIGHT + facts.size().y).max(THUMBNAIL) + 4.0;
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let square = Rect::from_min_size(rect.min + vec2(0.0, 2.0), vec2(THUMBNAIL, THUMBNAIL));
    match thumbnail {
        Some(id) => {
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter().image(id, square, whole, egui::Color32::WHITE);
        }
        None => _ = ui.painter().rect_filled(square, 2.0, palette.surface),
    }
    let text = rect.with_min_x(square.right() + GAP);
    let below = text.with_min_y(text.top() + NAME_HEIGHT);
    line(ui, id, text.with_max_y(below.top()), &image.name, palette.text);
    show_wrapped(ui, id.with("facts"), below, &image.line, facts);
}
