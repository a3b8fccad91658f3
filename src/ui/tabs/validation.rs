//! What the Khronos validator says about the model's file, in the Info tab.

use egui::text::{LayoutJob, TextFormat};
use egui::{RichText, Ui};

use super::report::about_node;
use crate::editor::ValidatorGroup;
use crate::library::Model;
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
    if ui.add(egui::Button::new(label).min_size(egui::vec2(ui.available_width(), 32.0))).clicked() {
        out.actions.push(UiAction::Validate);
    }
    let is_running = matches!(validation, Some(Validation::Running));
    let was_running = std::mem::replace(&mut local.is_validating, is_running);
    let summary = match validation {
        None | Some(Validation::Running) => return,
        Some(Validation::Failed(error)) => {
            let failure = RichText::new(text::validator_failed(error)).color(style::palette(ui).error);
            ui.add(egui::Label::new(failure).wrap())
        }
        Some(Validation::Done(report)) => ui.scope(|ui| controls::hint(ui, text::validator_summary(report))).response,
    };
    if was_running {
        summary.scroll_to_me(None);
    }
    if let Some(Validation::Done(report)) = validation {
        for group in &report.groups {
            findings(ui, shown, model, group, &mut local.layout, out);
        }
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
