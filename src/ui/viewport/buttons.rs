//! The buttons in the upper corners of the viewport.

use egui::{Align, Layout, Rect, Ui, vec2};

use crate::state::Command;
use crate::ui::icons::{Icon, icon_button};
use crate::ui::{Output, Sheet, UiAction, UiState, is_narrow, style, text};

pub fn show(ui: &mut Ui, rect: Rect, local: &mut UiState, out: &mut Output) {
    let narrow = is_narrow(ui);
    let strip = Rect::from_min_size(rect.min + vec2(10.0, 10.0), vec2(rect.width() - 20.0, 36.0));
    let mut bar = ui.new_child(egui::UiBuilder::new().max_rect(strip).layout(Layout::left_to_right(Align::Center)));
    pill(&mut bar, |ui| {
        if narrow {
            let open = local.layout.sheet == Some(Sheet::Clips);
            if icon_button(ui, Icon::Clips, text::CLIPS, open).clicked() {
                local.layout.sheet = if open { None } else { Some(Sheet::Clips) };
            }
            if icon_button(ui, Icon::Open, text::OPEN_FILES, false).clicked() {
                out.actions.push(UiAction::OpenFiles);
            }
        } else {
            let label = if local.layout.clips_open { text::HIDE_CLIPS } else { text::SHOW_CLIPS };
            if icon_button(ui, Icon::PanelLeft, label, false).clicked() {
                local.layout.clips_open = !local.layout.clips_open;
            }
            if !local.layout.clips_open && icon_button(ui, Icon::Open, text::OPEN_FILES, false).clicked() {
                out.actions.push(UiAction::OpenFiles);
            }
        }
        if local.host.has_gallery && icon_button(ui, Icon::Samples, text::SAMPLES, false).clicked() {
            out.actions.push(UiAction::ShowGallery);
        }
    });
    let mut bar = ui.new_child(egui::UiBuilder::new().max_rect(strip).layout(Layout::right_to_left(Align::Center)));
    pill(&mut bar, |ui| {
        if narrow {
            let open = local.layout.sheet == Some(Sheet::Inspector);
            if icon_button(ui, Icon::Sliders, text::INSPECTOR, open).clicked() {
                local.layout.sheet = if open { None } else { Some(Sheet::Inspector) };
            }
        } else {
            let label = if local.layout.inspector_open { text::HIDE_INSPECTOR } else { text::SHOW_INSPECTOR };
            if icon_button(ui, Icon::PanelRight, label, false).clicked() {
                local.layout.inspector_open = !local.layout.inspector_open;
            }
            if icon_button(ui, Icon::Help, text::HELP, local.help.is_open).clicked() {
                local.help.is_open = !local.help.is_open;
            }
        }
        if icon_button(ui, Icon::Frame, text::FRAME_ALL_KEY, false).clicked() {
            out.commands.push(Command::FrameAll);
        }
    });
}

/// Buttons on a translucent background, legible over any scene.
fn pill(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    let fill = style::palette(ui).panel.gamma_multiply(0.86);
    egui::Frame::new().fill(fill).corner_radius(9).inner_margin(egui::Margin::same(2)).show(ui, |ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        contents(ui);
    });
}
