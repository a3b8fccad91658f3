//! What lies over everything for a while.

use egui::{Align2, Context, Id, Order, Rect, Stroke, Ui, vec2};

use super::{about, awaited, recording, sheet};
use crate::ui::{Output, Shown, UiState, is_small, motion, style};

/// Call last; `viewport` is the viewport's rectangle.
pub fn overlays(ui: &mut Ui, viewport: Rect, shown: Shown<'_>, local: &mut UiState, out: &mut Output) {
    if is_small(ui) && !shown.state.page.embed.is_on() {
        sheet::show(ui, &shown, local, out);
    } else {
        local.layout.sheet = None;
    }
    keep_focus(ui.ctx(), local);
    awaited::show(ui, viewport, &shown, out);
    local.messages.show(ui, viewport, &shown, out);
    local.help.show(ui.ctx());
    about::show(ui.ctx(), &mut local.about_open, out);
    recording::show(ui.ctx(), local, out);
    motion::banner(ui.ctx(), viewport, &shown, local);
    motion::picker(ui.ctx(), &shown, local, out);
    if ui.input(|input| !input.raw.hovered_files.is_empty()) {
        drop_target(ui);
    }
}

/// Notes what has the focus when a modal opens, and gives it back when the modal and its controls are gone.
fn keep_focus(context: &Context, local: &mut UiState) {
    let is_modal = local.has_modal();
    let before = &mut local.focus_before_modal;
    if is_modal {
        // Only in the first pass does whatever opened the modal still have the focus.
        before.get_or_insert_with(|| context.memory(egui::Memory::focused));
    } else if let Some(id) = before.take().flatten() {
        context.memory_mut(|memory| memory.request_focus(id));
    }
}

fn drop_target(ui: &Ui) {
    let palette = style::palette(ui);
    let painter = ui.ctx().layer_painter(egui::LayerId::new(Order::Tooltip, Id::unique("drop target")));
    let whole = ui.ctx().content_rect();
    painter.rect_filled(whole, 0.0, palette.panel.gamma_multiply(0.82));
    let inner = whole.shrink(24.0);
    let corners = [inner.left_top(), inner.right_top(), inner.right_bottom(), inner.left_bottom(), inner.left_top()];
    painter.extend(egui::Shape::dashed_line(&corners, Stroke::new(2.0, palette.accent), 10.0, 8.0));
    let center = whole.center();
    painter.text(center, Align2::CENTER_BOTTOM, "Drop to open", style::HEADING, palette.text);
    let below = "A model with its files, motions for it, a folder or a .zip archive";
    let at = center + vec2(0.0, 10.0);
    painter.text(at, Align2::CENTER_TOP, below, style::BODY, palette.weak_text);
}
