//! The list of keys and gestures.

use egui::{Align, Context, Key, Layout, RichText, Sense, Ui, vec2};

use crate::ui::icons::{Icon, icon_button};
use crate::ui::{KEY_TABLE, modal, style, text};

/// Whether the help is open.
#[derive(Debug, Default)]
pub struct Help {
    /// Set by the help button and its key. The help appears in the pass after that.
    pub is_open: bool,
    /// It was opened by its key, so there is a keyboard, even if the screen is small.
    by_key: bool,
    /// Number of passes that it has been open for; 2 means more.
    passes: u8,
}

/// What a pointer does, the same with fingers, and what it is for. What one of them lacks is empty.
const GESTURES: [(&str, &str, &str); 9] = [
    ("Drop files", "", "Open a model, borrow motion for it, or apply a joint map"),
    ("Drag", "Drag", "Orbit"),
    ("Right drag, shift drag", "", "Pan"),
    ("Wheel, pinch", text::PINCH, "Zoom to the pointer"),
    ("Two-finger drag", "Two-finger drag", "Pan"),
    ("Drag a ring", "Drag a ring", text::HELP_RING),
    ("Drag a handle", "Drag a handle", text::HELP_HANDLE),
    ("Click a joint", "Tap a joint", "Select it; in the Motion tab, choose its source"),
    ("Double-click", "Double tap", text::FRAME_ALL),
];

impl Help {
    /// Opens or closes it by its key.
    pub(crate) fn toggle_by_key(&mut self) {
        self.is_open = !self.is_open;
        self.by_key = self.is_open;
    }

    /// Shows the help if it has been open since the last pass; clears `is_open` when the user closes it.
    pub(super) fn show(&mut self, context: &Context) {
        // Not in the pass that opens it: that click would count as one outside the modal and close it again.
        match (self.is_open, self.passes) {
            (false, _) => (self.passes, self.by_key) = (0, false),
            (true, 0) => {
                self.passes = 1;
                context.request_repaint();
            }
            (true, _) => self.modal(context),
        }
    }

    fn modal(&mut self, context: &Context) {
        let modal = modal::window("help", context).show(context, |ui| {
            let width = (ui.ctx().content_rect().width() - 64.0).min(400.0);
            ui.set_width(width);
            let has_keys = self.by_key || !style::is_for_fingers(ui);
            let is_closed = title_bar(ui, has_keys, std::mem::replace(&mut self.passes, 2) == 1);
            list(ui, width, has_keys);
            is_closed
        });
        self.is_open &= !(modal.inner || modal.should_close());
    }
}

/// Returns whether its close button was clicked. Its title has the focus: unlike a button, it leaves Space alone.
fn title_bar(ui: &mut Ui, has_keys: bool, takes_focus: bool) -> bool {
    let close = |ui: &mut Ui| icon_button(ui, Icon::Close, text::CLOSE_HELP).clicked();
    ui.horizontal(|ui| {
        let title = if has_keys { text::HELP_TITLE } else { text::GESTURES };
        modal::set_name(ui, title);
        // Not a label, which would be underlined while it has the focus.
        let galley = ui.painter().layout_no_wrap(title.to_owned(), style::HEADING, style::palette(ui).text);
        let (rect, response) = ui.allocate_exact_size(galley.size(), Sense::FOCUSABLE);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Label, true, title));
        ui.painter().galley(rect.min, galley, style::palette(ui).text);
        if takes_focus {
            response.request_focus();
        }
        ui.with_layout(Layout::right_to_left(Align::Center), close).inner
    })
    .inner
}

fn list(ui: &mut Ui, width: f32, has_keys: bool) {
    let accent = style::palette(ui).accent;
    let for_fingers = style::is_for_fingers(ui);
    let keys = KEY_TABLE.iter().filter(|_| has_keys).map(|line| (line.keys, line.does));
    let gestures = GESTURES.map(|(pointer, fingers, does)| (if for_fingers { fingers } else { pointer }, does));
    let lines = keys.chain(gestures).filter(|(how, _)| !how.is_empty());
    let max_height = (ui.ctx().content_rect().height() - 160.0).max(120.0);
    // A scroll bar that is always visible: nothing else would show that the list goes on.
    ui.spacing_mut().scroll = egui::style::ScrollStyle::solid();
    egui::ScrollArea::vertical().max_height(max_height).min_scrolled_height(max_height).show(ui, |ui| {
        ui.scroll_with_delta(vec2(0.0, -scrolled_by_keys(ui, max_height)));
        // Fixed widths: on small screens the longest key and the longest text don't fit side by side.
        let columns = [0.37 * width, 0.63 * width - 18.0];
        egui::Grid::new("keys").num_columns(2).min_row_height(18.0).spacing([18.0, 7.0]).show(ui, |ui| {
            for (keys, does) in lines {
                cell(ui, columns[0], RichText::new(keys).color(accent));
                cell(ui, columns[1], does.into());
                ui.end_row();
            }
        });
    });
}

/// Returns how far the keys scroll down in this frame; nothing in the list could be reached with them otherwise.
fn scrolled_by_keys(ui: &Ui, page: f32) -> f32 {
    const LINE: f32 = 40.0;
    /// Longer than the list.
    const ALL: f32 = 10_000.0;
    let steps = [
        (Key::ArrowDown, LINE),
        (Key::ArrowUp, -LINE),
        (Key::PageDown, page - LINE),
        (Key::PageUp, LINE - page),
        (Key::End, ALL),
        (Key::Home, -ALL),
    ];
    ui.input(|input| steps.into_iter().map(|(key, by)| input.num_presses(key) as f32 * by).sum())
}

fn cell(ui: &mut Ui, width: f32, text: RichText) {
    ui.vertical(|ui| {
        ui.set_width(width);
        ui.add(egui::Label::new(text).wrap());
    });
}
