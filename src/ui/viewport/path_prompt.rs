//! Asks for a path where the platform has no file dialog.

use egui::{Align, Context, Layout};

use super::overlays;
use crate::editor::Export;
use crate::ui::{Output, PathPurpose, Saved, UiAction, UiState, controls, text};

/// An open prompt for a path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PathPrompt {
    /// What the path is for; sets the title and the button.
    pub purpose: PathPurpose,
    /// What has been typed so far.
    pub path: String,
}

pub fn show(context: &Context, local: &mut UiState, out: &mut Output) {
    let Some(PathPrompt { purpose, path }) = &mut local.messages.path_prompt else { return };
    let (title, hint) = title_and_hint(*purpose);
    let button = if matches!(purpose, PathPurpose::Save(_)) { text::PROMPT_SAVE } else { text::PROMPT_OPEN };
    let mut done = false;
    let modal = overlays::modal("path prompt", context).show(context, |ui| {
        ui.set_width((ui.ctx().content_rect().width() - 64.0).min(460.0));
        ui.heading(title);
        ui.add_space(4.0);
        let field = egui::TextEdit::singleline(path)
            .hint_text(hint)
            .margin(egui::Margin::symmetric(10, 6))
            .desired_width(f32::INFINITY);
        let field = ui.add(field).accessible_name(text::PATH);
        let entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        if !field.has_focus() && !entered {
            field.request_focus();
        }
        if !matches!(purpose, PathPurpose::Save(_)) {
            controls::hint(ui, "You can also drop files anywhere on the window.");
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let filled = !path.trim().is_empty();
            let go = ui.add_enabled(filled, egui::Button::new(button));
            if filled && (go.clicked() || entered) {
                out.actions.push(UiAction::UsePath(*purpose, path.trim().to_owned()));
                done = true;
            }
            done |= ui.button(text::CANCEL).clicked();
        });
    });
    if done || modal.should_close() {
        local.messages.path_prompt = None;
    }
}

fn title_and_hint(purpose: PathPurpose) -> (&'static str, &'static str) {
    const GLB: &str = "Path of the .glb to write";
    match purpose {
        PathPurpose::Open => ("Open a file", "Path of a .glb, .gltf, .fbx, .x, .bvh, .obj, .zip or folder"),
        PathPurpose::OpenMotion => ("Borrow motion", "Path of a .bvh, .fbx, .x, .glb, .vrma or joint map .json"),
        PathPurpose::Save(Saved::File(Export::Map { .. })) => ("Save joint map", "Path of the .json to write"),
        PathPurpose::Save(Saved::File(Export::Model { .. } | Export::FullModel { .. })) => ("Save model", GLB),
        PathPurpose::Save(Saved::File(Export::Clip { .. })) => ("Save clip", GLB),
        PathPurpose::Save(Saved::Picture { .. }) => ("Save image", "Path of the .png to write"),
    }
}
