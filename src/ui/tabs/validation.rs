//! What the Khronos validator says about the model's file, in the Info tab.

use egui::text::{LayoutJob, TextFormat};
use egui::{RichText, Ui};
use gaitway_scene::editor::ValidatorGroup;
use gaitway_scene::library::Model;

use super::facts::about_node;
use crate::ui::controls::capitals;
use crate::ui::{Layout, Output, Shown, UiAction, UiState, Validation, controls, style, text};

pub fn show(ui: &mut Ui, shown: &Shown<'_>, model: &Model, local: &mut UiState, out: &mut Output) {
    let host = &local.host;
    if !host.has_validator {
        return;
    }
    controls::section(ui, capitals!(text::KHRONOS_VALIDATOR));
    if !host.has_gltf {
        controls::hint(ui, if model.awaits_images() { text::NO_GLTF_YET } else { text::NO_GLTF });
        return;
    }
    let validation = host.validation.as_ref().filter(|(of, _)| *of == model.id).map(|(_, validation)| validation);
    let label = match validation {
        None => text::VALIDATE,
        Some(Validation::Running) => text::VALIDATING,
        Some(_) => text::VALIDATE_AGAIN,
    };
    // Shown in every state, so that it keeps the focus.
    let button = ui.add(egui::Button::new(label).min_size(egui::vec2(ui.available_width(), 32.0)));
    if button.clicked() {
        out.actions.push(UiAction::Validate);
    }
    let is_running = matches!(validation, Some(Validation::Running));
    let was_asked = std::mem::replace(&mut local.is_validating, is_running || button.clicked());
    match validation {
        None | Some(Validation::Running) => {}
        Some(Validation::Failed(error)) => {
            let failure = RichText::new(text::validator_failed(error)).color(style::palette(ui).error);
            ui.add(egui::Label::new(failure).wrap());
        }
        Some(Validation::Done(report)) => {
            controls::hint(ui, text::validator_summary(report));
            for group in &report.groups {
                findings(ui, shown, model, group, &mut local.layout, out);
            }
        }
    }
    if was_asked && !local.is_validating {
        // As many of the results as there is room for below the button, which has the focus.
        let results = button.rect.with_max_y(ui.cursor().top());
        let height = results.height().min(ui.clip_rect().height() - 2.0 * ui.spacing().item_spacing.y);
        ui.scroll_to_rect(results.with_max_y(results.top() + height), None);
    }
}

fn findings(
    ui: &mut Ui,
    shown: &Shown<'_>,
    model: &Model,
    group: &ValidatorGroup,
    layout: &mut Layout,
    out: &mut Output,
) {
    let ValidatorGroup { severity, code, meaning, count, findings } = group;
    let palette = style::palette(ui);
    let color = [palette.error, palette.warning, palette.weak_text, palette.weak_text][*severity];
    let what = if meaning.is_empty() { code } else { meaning };
    let mut title = LayoutJob::simple(text::finding_title(*severity, what, *count), style::BODY, color, 0.0);
    if !meaning.is_empty() {
        // For professionals, and for a search on the web.
        title.append(&format!("\n{code}"), 0.0, TextFormat::simple(style::SMALL, palette.weak_text));
    }
    // A header doesn't wrap its text, and a code is one long word.
    let width = ui.available_width() - ui.spacing().indent - ui.spacing().button_padding.x;
    let wrap = Some(egui::TextWrapMode::Wrap);
    let title = egui::WidgetText::from(title).into_galley(ui, wrap, width, egui::TextStyle::Button);
    egui::CollapsingHeader::new(title)
        .id_salt((severity, code))
        .default_open(*severity < 2 && findings.len() <= 3)
        .show(ui, |ui| {
            for (finding, joint) in findings {
                about_node(ui, shown, model, finding, *joint, layout, out);
            }
            if *count > findings.len() as u64 {
                controls::hint(ui, text::more_findings(*count - findings.len() as u64));
            }
        });
}
