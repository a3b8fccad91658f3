//! The inspector: the right panel, one tab at a time.

pub mod display;
pub mod formula;
pub mod report;
pub mod scene_tree;
pub mod view_options;

use egui::Ui;

use crate::ui::{Output, Shown, UiState, controls, motion};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tab {
    Scene,
    Display,
    File,
    View,
    Motion,
}

pub fn show(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let mut tabs = vec![(Tab::Scene, "Scene"), (Tab::Display, "Display"), (Tab::File, "File"), (Tab::View, "View")];
    if !shown.library.motions().is_empty() {
        tabs.push((Tab::Motion, "Motion"));
    }
    if let Some(tab) = controls::segmented(ui, Some(local.open_tab(shown.library)), &tabs) {
        local.tab = tab;
    }
    ui.add_space(4.0);
    match local.open_tab(shown.library) {
        // The tree scrolls by itself, under the chosen joint's numbers.
        Tab::Scene => scene_tree::show(ui, shown, local, out),
        Tab::Display => controls::scrolled(ui, "display", |ui| display::show(ui, shown, out)),
        Tab::File => controls::scrolled(ui, "file", |ui| report::show(ui, shown, out)),
        Tab::Motion => motion::show(ui, shown, local, out),
        Tab::View => controls::scrolled(ui, "view", |ui| view_options::show(ui, shown, local, out)),
    }
}
