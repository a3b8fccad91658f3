//! The buttons in the upper right corner of the viewport.

use egui::{Align, Layout, Rect, RichText, Ui, vec2};
use gaitway_scene::state::{Command, Embed};

use crate::ui::icons::{ICON_SIZE, Icon, icon_button, icon_size};
use crate::ui::{Output, Shown, UiAction, UiState, controls, style, text};

/// To the edges of the viewport.
const MARGIN: f32 = 10.0;

pub fn show(ui: &mut Ui, rect: Rect, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let embed = shown.state.page.embed;
    let is_embedded = embed.is_on();
    if is_embedded && (embed != Embed::Page || !local.host.has_gallery) {
        return;
    }
    let height = icon_size(ui, ICON_SIZE).y + 4.0;
    if rect.height() < height + MARGIN {
        return;
    }
    // The viewport reaches under the corner of a sheet at its side.
    let sheet = local.layout.sheet_rect.filter(|sheet| sheet.left() > rect.left());
    let right = sheet.map_or(rect.right(), |sheet| sheet.left());
    let strip = Rect::from_min_size(rect.min + vec2(MARGIN, MARGIN), vec2(right - rect.left() - 2.0 * MARGIN, height));
    let mut bar = ui.new_child(egui::UiBuilder::new().max_rect(strip).layout(Layout::right_to_left(Align::Center)));
    // Translucent, legible over any scene.
    let fill = style::palette(ui).panel.gamma_multiply(0.86);
    let pill = egui::Frame::new().fill(fill).corner_radius(style::CORNER + 2).inner_margin(egui::Margin::same(2));
    pill.show(&mut bar, |ui| {
        if is_embedded {
            if ui.button(text::OPEN_PAGE).clicked() {
                out.actions.push(UiAction::OpenPage);
            }
        } else if icon_button(ui, Icon::Frame, controls::with_key(ui, text::FRAME_ALL_KEY)).clicked() {
            out.commands.push(Command::FrameAll);
        }
    });
    // Its switch may be out of sight, and the gizmo takes the drags that would orbit.
    if local.joint_card.is_posing && shown.state.selection.joint.is_some() && !is_embedded {
        let palette = style::palette(ui);
        let width = controls::text_width(ui, text::POSING, style::BODY) + controls::button_width(ui, text::DONE_POSING);
        // Above a sheet at the bottom, the viewport is low, and the character's head is where the note would be.
        let is_low = local.layout.sheet_rect.is_some_and(|sheet| sheet.top() > rect.top());
        let has_room = !is_low && bar.available_width() >= width + ui.spacing().item_spacing.x + 12.0;
        let left = if has_room { 10 } else { 2 };
        pill.inner_margin(egui::Margin { left, ..egui::Margin::same(2) }).show(&mut bar, |ui| {
            let done = RichText::new(text::DONE_POSING).color(palette.on_accent);
            if ui.add(egui::Button::new(done).fill(palette.accent)).clicked() {
                local.joint_card.is_posing = false;
            }
            if has_room {
                ui.label(text::POSING);
            }
        });
    }
}
