//! Windows over everything else, which take all input while they are open.

use egui::{Context, Id, Ui};

use super::style;

/// Returns the window of this name, to be shown in every frame in which it is open.
pub fn window(name: &str, context: &Context) -> egui::Modal {
    let frame = egui::Frame::window(&context.global_style()).inner_margin(egui::Margin::same(style::WINDOW_MARGIN));
    egui::Modal::new(Id::unique(name)).frame(frame)
}

/// Gives the modal around `ui` its accessible name.
pub fn set_name(ui: &Ui, title: &str) {
    if let Some(modal) = ui.stack().iter().find(|ui| ui.kind() == Some(egui::UiKind::Modal)) {
        ui.ctx().accesskit_node_builder(modal.unique_id, |node| node.set_label(title));
    }
}
