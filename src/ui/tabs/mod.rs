//! The inspector: the right panel, one tab at a time.

mod animated;
mod avatar;
pub mod display;
mod facts;
pub mod formula;
mod hiding;
mod joint_card;
mod lists;
mod materials;
mod performance;
mod pin;
pub mod report;
mod scene_tree;
mod tab;
mod validation;
mod view_options;

use egui::Ui;
use gaitway_scene::library::Library;

use super::{HostState, Output, Shown, UiState, Validation, controls, motion, text};

pub use formula::VertexProbe;
pub use joint_card::JointCard;
pub use lists::Lists;
pub(super) use pin::rounded;
pub use scene_tree::SceneTree;
pub use tab::Tab;
pub use view_options::PictureSettings;

/// Whether there is a clip to edit or a motion to map.
pub(super) fn has_motion_tab(library: &Library) -> bool {
    !library.motions().is_empty() || library.active().is_some_and(|model| !model.clips().is_empty())
}

/// Returns what the dot on the Info tab means: warnings about the file, and errors that the validator found.
fn problems(shown: &Shown<'_>, host: &HostState) -> Option<String> {
    let model = shown.library.active()?;
    let warnings = Some(model.findings().len()).filter(|&count| count > 0).map(text::file_warnings);
    let errors = match &host.validation {
        Some((of, Validation::Done(report))) if *of == model.id && report.counts[0] > 0 => {
            Some(text::labelled(text::KHRONOS_VALIDATOR, &text::validator_summary(report)))
        }
        _ => None,
    };
    let problems: Vec<String> = [warnings, errors].into_iter().flatten().collect();
    (!problems.is_empty()).then(|| problems.join("; "))
}

/// Shows the tab bar and the open tab. The bar of tabs leaves `corner_width` free at its right.
pub fn show(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, corner_width: f32, out: &mut Output) {
    let tabs = [Tab::Scene, Tab::Display, Tab::Info, Tab::Camera, Tab::Motion].map(|tab| (tab, tab.label()));
    let count = if has_motion_tab(shown.library) { tabs.len() } else { tabs.len() - 1 };
    let problems = problems(shown, &local.host);
    let badge = |tab| if tab == Tab::Info { problems.clone() } else { None };
    ui.scope(|ui| {
        ui.set_max_width(ui.available_width() - corner_width);
        if let Some(tab) =
            controls::tabs(ui, text::INSPECTOR, local.layout.open_tab(shown.library), &tabs[..count], badge)
        {
            local.layout.tab = tab;
        }
    });
    ui.add_space(6.0);
    match local.layout.open_tab(shown.library) {
        // Has a scroll area of its own.
        Tab::Scene => scene_tree::show(ui, shown, local, out),
        Tab::Display => controls::scrolled(ui, "display", |ui| display::show(ui, shown, out)),
        Tab::Info => {
            // Another model begins at the top.
            let place = ("file", shown.library.active().map(|model| model.id));
            controls::scrolled(ui, place, |ui| report::show(ui, shown, local, out));
        }
        Tab::Motion => motion::show(ui, shown, local, out),
        Tab::Camera => controls::scrolled(ui, "view", |ui| view_options::show(ui, shown, local, out)),
    }
}
