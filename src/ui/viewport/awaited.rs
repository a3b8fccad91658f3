//! What stands on the empty stage while a link's model can't be had: which one it is, and how to bring it.

use egui::{Align2, Area, Id, Order, Rect, RichText, Stroke, Ui};
use gaitway_scene::editor::short_name;
use gaitway_scene::library::Model;
use gaitway_scene::state::is_to_bring;

use crate::ui::{Output, Shown, UiAction, style, text};

/// Returns what the stage says about the model that it stands for, and what to do.
pub fn title_and_hint(placeholder: &Model) -> (String, &'static str) {
    let name = short_name(&placeholder.source);
    match is_to_bring(&placeholder.origin) {
        true => (text::waiting_for(&name), text::BRING_HERE),
        false => (text::couldnt_load(&name), text::NOT_LOADED),
    }
}

pub fn show(ui: &Ui, viewport: Rect, shown: &Shown<'_>, out: &mut Output) {
    let Some(model) = shown.library.active().filter(|model| model.is_placeholder()) else { return };
    let area =
        Area::new(Id::unique("awaited")).order(Order::Middle).pivot(Align2::CENTER_CENTER).fixed_pos(viewport.center());
    area.show(ui.ctx(), |ui| {
        let palette = style::palette(ui);
        let card = egui::Frame::new()
            .fill(palette.panel)
            .stroke(Stroke::new(1.0, palette.line))
            .corner_radius(style::WINDOW_CORNER)
            .inner_margin(egui::Margin::same(style::WINDOW_MARGIN));
        card.show(ui, |ui| {
            ui.set_width((viewport.width() - 88.0).clamp(120.0, 320.0));
            ui.vertical_centered(|ui| {
                let (title, hint) = title_and_hint(model);
                ui.add(egui::Label::new(RichText::new(title).heading().color(palette.text)).wrap());
                ui.add(egui::Label::new(RichText::new(hint).color(palette.weak_text)).wrap());
                ui.add_space(4.0);
                if ui.button(text::BRING).clicked() {
                    out.actions.push(UiAction::OpenFiles);
                }
            });
        });
    });
}
