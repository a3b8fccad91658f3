//! The progress of a video that is being recorded. Nothing else can be done meanwhile.

use egui::{Align, Context, Key, Layout, Modifiers};

use crate::ui::{Output, UiAction, UiState, controls, modal, style, text};

pub fn show(context: &Context, local: &mut UiState, out: &mut Output) {
    let Some(progress) = local.host.recording else { return };
    modal::window("recording", context).show(context, |ui| {
        ui.set_width((ui.ctx().content_rect().width() - 64.0).min(320.0));
        modal::set_name(ui, text::RECORDING);
        ui.heading(text::RECORDING);
        ui.add_space(4.0);
        ui.label(text::frames_done(progress.frames_done, progress.frame_count));
        let fraction = progress.frames_done as f32 / progress.frame_count.max(1) as f32;
        let bar = ui.add(egui::ProgressBar::new(fraction).desired_height(6.0).fill(style::palette(ui).accent));
        controls::named(&bar, || text::RECORDING.to_owned());
        ui.add_space(4.0);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let is_cancelled = ui.button(text::CANCEL).clicked();
            if is_cancelled || ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape)) {
                out.actions.push(UiAction::CancelRecording);
            }
        });
    });
}
