//! The materials and images of the model in the Info tab. Materials have an eye, images a thumbnail.

use egui::{Id, Rect, Sense, Ui, pos2, vec2};

use super::hiding::{self, Pressed};
use super::lists::{ImageText, Lists, MaterialText};
use crate::library::Model;
use crate::state::Command;
use crate::ui::{HostState, Output, Shown, controls, style, text};

/// Further materials and images are not listed.
const MAX_ROWS: usize = 200;
const LINE_HEIGHT: f32 = 16.0;
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
    let hidden = &shown.state.edits.hidden;
    let is_shown = !hidden.materials.contains(&material.index);
    // As high as the button that hides the material.
    let name_height = controls::row_height(ui, 22.0);
    let height = name_height + material.lines.len() as f32 * LINE_HEIGHT;
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let first = rect.with_max_y(rect.top() + name_height);
    let palette = style::palette(ui);
    let color = if is_shown { palette.text } else { palette.weak_text };
    let id = Id::unique(("material", material.index));
    line(ui, id, first.with_max_x(rect.right() - hiding::EYE_WIDTH), &material.name, false, color);
    for (at, text) in material.lines.iter().enumerate() {
        let top = first.bottom() + at as f32 * LINE_HEIGHT;
        let below = Rect::from_min_max(pos2(rect.left(), top), pos2(rect.right(), top + LINE_HEIGHT));
        line(ui, id.with(at), below, text, true, palette.weak_text);
    }
    let hidden = match hiding::eye(ui, first, id.with("eye"), &material.name, is_shown) {
        Some(Pressed::Toggle) => hidden.clone().with_material_toggled(material.index),
        Some(Pressed::Solo) => hidden.clone().with_material_soloed(&model.asset, material.index),
        None => return,
    };
    out.commands.push(Command::SetHidden(hidden));
}

/// A line of text; its tooltip has the whole text if it is cut.
fn line(ui: &Ui, id: Id, rect: Rect, text: &str, is_small: bool, color: egui::Color32) {
    let response = ui.interact(rect, id, Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Label, true, text));
    let cut = match is_small {
        true => controls::elided_small(ui, rect, text, color),
        false => controls::elided(ui, rect, text, color),
    };
    if cut {
        response.on_hover_text(text);
    }
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

/// The details wrap if the list of maps is too long for one line.
fn image_row(ui: &mut Ui, id: Id, image: &ImageText, thumbnail: Option<egui::TextureId>) {
    const GAP: f32 = 8.0;
    let palette = style::palette(ui);
    let width = ui.available_width() - THUMBNAIL - GAP;
    let facts = ui.painter().layout(image.line.clone(), style::SMALL, palette.weak_text, width);
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
    line(ui, id, text.with_max_y(below.top()), &image.name, false, palette.text);
    let response = ui.interact(below, id.with("facts"), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Label, true, &image.line));
    ui.painter().galley(below.min, facts, palette.weak_text);
}
