//! Progress, errors and toasts, in the lower left corner of the viewport: the character is in its middle.

use egui::{Align, Align2, Area, Color32, Id, Layout, Order, Rect, RichText, Stroke, Ui, pos2};
use gaitway_scene::editor::Reading;

use super::panes::label_height;
use crate::ui::icons::{ICON_SIZE, Icon, icon_button, icon_size};
use crate::ui::{Output, Shown, UiAction, controls, style, text};

/// What the app tells or asks the user.
#[derive(Debug, Default)]
pub struct Messages {
    /// Shown until dismissed.
    pub error: Option<String>,
    /// The error is about motions that were refused: alternatives are offered.
    pub motion_refused: bool,
    /// Mapping joints manually is none of them.
    pub model_lacks_skeleton: bool,
    /// The error is about opening this file.
    failed_to_open: Option<String>,
    /// The load under way.
    pub progress: Option<Progress>,
    /// What can't be used of the view; shown until dismissed, or until another view replaces it.
    pub about_view: Option<String>,
    /// The latest one; a new toast replaces it.
    pub toast: Option<Toast>,
}

/// Progress of a load.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Progress {
    /// Name of the file being read, as shown to the user.
    pub name: String,
    /// Bytes read so far.
    pub received_bytes: u64,
    /// 0 if unknown.
    pub total_bytes: u64,
}

/// A short message that goes away by itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Toast {
    /// The message itself.
    pub text: String,
    /// When it disappears, in egui's time.
    pub until_secs: f64,
    /// It has a button that undoes what it reports.
    pub undoable: bool,
    /// What the user may have meant instead, which has a button.
    pub other: Option<Reading>,
}

impl Toast {
    /// Extra time to reach the Undo button.
    pub(crate) const UNDOABLE_SECS: f64 = 3.5;
    /// Extra time to choose what was meant.
    pub(crate) const CHOICE_SECS: f64 = 6.0;
}

impl Messages {
    /// Dismisses the error, with its title and the alternatives it offers.
    pub fn clear_error(&mut self) {
        (self.error, self.failed_to_open) = (None, None);
        (self.motion_refused, self.model_lacks_skeleton) = (false, false);
    }

    /// Replaces the error by why a load failed. `progress` is that of the load.
    pub fn fail_to_open(&mut self, error: &str, progress: Option<Progress>) {
        self.failed_to_open = progress.map(|progress| progress.name).filter(|_| !self.motion_refused);
        // The title has the name.
        let name = self.failed_to_open.as_deref();
        let after_name = name.and_then(|name| error.strip_prefix(name)?.strip_prefix(": "));
        self.error = Some(after_name.unwrap_or(error).to_owned());
    }

    /// Shows the messages in the viewport's lower left corner.
    pub(super) fn show(&mut self, ui: &Ui, viewport: Rect, shown: &Shown<'_>, out: &mut Output) {
        self.expire_toast(ui);
        let has_lasting = self.error.is_some() || self.about_view.is_some();
        if self.toast.is_none() && self.progress.is_none() && !has_lasting {
            return;
        }
        let width = (viewport.width() - 28.0).min(520.0);
        let bottom = viewport.bottom() - 14.0 - label_height(shown);
        let id = Id::unique("notices");
        let height_before = ui.ctx().memory(|memory| memory.area_rect(id)).map(|rect| rect.height());
        let area = Area::new(id)
            .order(Order::Foreground)
            .pivot(Align2::LEFT_BOTTOM)
            .fixed_pos(pos2(viewport.left() + 14.0, bottom));
        let shown = area.show(ui.ctx(), |ui| {
            ui.set_max_width(width);
            self.show_progress(ui, width, out);
            self.show_error(ui, out);
            self.show_about_view(ui);
            self.show_toast(ui, width, out);
        });
        // It was placed by its height before.
        if height_before != Some(shown.response.rect.height()) {
            ui.ctx().request_repaint();
        }
    }

    fn expire_toast(&mut self, ui: &Ui) {
        let now_secs = ui.input(|input| input.time);
        self.toast.take_if(|toast| toast.until_secs <= now_secs);
        if let Some(toast) = &self.toast {
            ui.ctx().request_repaint_after_secs((toast.until_secs - now_secs) as f32);
        }
    }

    fn show_progress(&self, ui: &mut Ui, width: f32, out: &mut Output) {
        let Some(Progress { name, received_bytes, total_bytes }) = &self.progress else { return };
        let palette = style::palette(ui);
        notice(ui, palette.line, |ui| {
            ui.set_width(width.min(360.0) - 32.0);
            ui.add(egui::Label::new(text::opening(name)).truncate());
            let bar = match total_bytes {
                0 => egui::ProgressBar::new(1.0).animate(true),
                total => egui::ProgressBar::new((*received_bytes as f64 / *total as f64) as f32),
            };
            let bar = ui.add(bar.desired_height(6.0).fill(palette.accent));
            controls::named(&bar, || text::opening(name));
            ui.horizontal(|ui| {
                if ui.button(text::CANCEL).clicked() {
                    out.actions.push(UiAction::CancelOpening);
                }
                if *received_bytes > 0 {
                    controls::hint(ui, text::amount_read(*received_bytes, *total_bytes));
                }
            });
        });
    }

    fn show_error(&mut self, ui: &mut Ui, out: &mut Output) {
        let Some(error) = &self.error else { return };
        let error = error.lines().map(text::sentence).collect::<Vec<_>>().join("\n");
        let color = style::palette(ui).error;
        if dismissible(ui, color, text::DISMISS_ERROR, |ui| self.show_error_text(ui, &error, out)) {
            self.clear_error();
        }
    }

    fn show_about_view(&mut self, ui: &mut Ui) {
        let Some(about) = &self.about_view else { return };
        let line = style::palette(ui).line;
        let is_dismissed = dismissible(ui, line, text::DISMISS_NOTICE, |ui| {
            // Beside the middle of its button.
            ui.add_space(4.0);
            scrolled_text(ui, about);
        });
        self.about_view.take_if(|_| is_dismissed);
    }

    fn show_error_text(&mut self, ui: &mut Ui, error: &str, out: &mut Output) {
        match self.error_title() {
            Some(title) => _ = ui.label(RichText::new(title).strong().color(style::palette(ui).error)),
            // Beside the middle of the button.
            None => ui.add_space(4.0),
        }
        scrolled_text(ui, error);
        if self.motion_refused {
            self.offer_alternatives(ui, out);
        }
    }

    /// The error that is shown, as one text.
    pub fn problem(&self) -> Option<String> {
        let error = self.error.as_deref()?;
        Some(self.failed_to_open.as_deref().map_or_else(|| error.to_owned(), |name| format!("{name}: {error}")))
    }

    /// `None` if the message itself names what failed.
    fn error_title(&self) -> Option<String> {
        let refused = self.motion_refused.then(|| text::REFUSED_TITLE.to_owned());
        self.failed_to_open.as_deref().map(text::couldnt_open).or(refused)
    }

    fn offer_alternatives(&mut self, ui: &mut Ui, out: &mut Output) {
        ui.add_space(4.0);
        ui.horizontal_wrapped(|ui| {
            let offers = [
                (text::SHOW_REFUSED_ALONE, UiAction::ShowRefusedAlone),
                (text::MAP_REFUSED_MANUALLY, UiAction::MapRefusedManually),
            ];
            let count = if self.model_lacks_skeleton { 1 } else { offers.len() };
            for (label, action) in offers.into_iter().take(count) {
                if ui.button(label).clicked() {
                    out.actions.push(action);
                    self.clear_error();
                }
            }
        });
    }

    fn show_toast(&mut self, ui: &mut Ui, width: f32, out: &mut Output) {
        let Some(toast) = &self.toast else { return };
        let line = style::palette(ui).line;
        let text = toast.text.lines().map(text::sentence).collect::<Vec<_>>().join("\n");
        let undo = toast.undoable.then_some((text::UNDO, UiAction::Undo));
        let other = toast.other.map(|other| (text::other_reading(other), UiAction::ReadOtherwise));
        let offers = [undo, other].into_iter().flatten();
        let buttons_width: f32 = offers.clone().map(|(label, _)| controls::button_width(ui, label) + 8.0).sum();
        let mut chosen = None;
        let row = |ui: &mut Ui| {
            ui.scope(|ui| {
                ui.set_max_width(width - 32.0 - buttons_width - icon_size(ui, ICON_SIZE).x - 8.0);
                ui.add(egui::Label::new(text).wrap());
            });
            for (label, action) in offers {
                let mut button = ui.button(label);
                if action == UiAction::Undo && !style::is_for_fingers(ui) {
                    button = button.on_hover_text("Ctrl+Z");
                }
                if button.clicked() {
                    chosen = Some(action);
                }
            }
            icon_button(ui, Icon::Close, text::DISMISS_NOTICE).clicked()
        };
        let is_dismissed = notice(ui, line, |ui| ui.horizontal(row).inner);
        if is_dismissed || chosen.is_some() {
            self.toast = None;
        }
        out.actions.extend(chosen);
    }
}

/// Shows a message with a button that dismisses it; returns whether that was pressed.
fn dismissible(ui: &mut Ui, line: Color32, label: &str, contents: impl FnOnce(&mut Ui)) -> bool {
    let row = |ui: &mut Ui| {
        let is_dismissed = icon_button(ui, Icon::Close, label).clicked();
        ui.with_layout(Layout::top_down(Align::Min), contents);
        is_dismissed
    };
    notice(ui, line, |ui| ui.with_layout(Layout::right_to_left(Align::Min), row).inner)
}

fn scrolled_text(ui: &mut Ui, text: &str) {
    egui::ScrollArea::vertical().max_height(180.0).show(ui, |ui| {
        ui.add(egui::Label::new(text).wrap().selectable(true));
    });
}

fn notice<R>(ui: &mut Ui, line: Color32, contents: impl FnOnce(&mut Ui) -> R) -> R {
    let palette = style::palette(ui);
    egui::Frame::new()
        .fill(palette.panel)
        .stroke(Stroke::new(1.0, line))
        .corner_radius(style::WINDOW_CORNER)
        .shadow(ui.visuals().popup_shadow)
        .inner_margin(egui::Margin::symmetric(16, 12))
        .show(ui, contents)
        .inner
}
