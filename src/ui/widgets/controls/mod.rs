//! Controls that all panels share: section titles, switches, rows and cards here, menus and choices, and numbers.

mod choices;
mod numbers;

use egui::accesskit::Role;
use egui::{Color32, Rect, Response, RichText, Sense, Ui, Vec2, WidgetInfo, vec2};

pub use self::choices::{choice, chooser, menu_button, option, segmented, segmented_about, tabs};
pub use self::numbers::{SliderSettings, is_double_clicked, knob_style, number, slider};
use super::style;
use crate::ui::text;

/// A constant text in capitals, for the title of a group; a constant itself.
macro_rules! capitals {
    ($text:expr) => {{
        const LETTERS: [u8; $text.len()] = crate::ui::widgets::controls::capital_letters($text);
        const CAPITALS: &str = match std::str::from_utf8(&LETTERS) {
            Ok(text) => text,
            Err(_) => panic!(),
        };
        CAPITALS
    }};
}

pub(crate) use capitals;

/// The bytes of `text` with ASCII letters in upper case. `LENGTH` is that of `text`.
pub const fn capital_letters<const LENGTH: usize>(text: &str) -> [u8; LENGTH] {
    let (bytes, mut capitals, mut at) = (text.as_bytes(), [0; LENGTH], 0);
    while at < LENGTH {
        capitals[at] = bytes[at].to_ascii_uppercase();
        at += 1;
    }
    capitals
}

/// Names a control for screen readers. `name` is called only while one reads the interface.
pub fn named(response: &Response, name: impl FnOnce() -> String) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name()));
}

/// Returns a text that ends with keys in parentheses; without them where the layout is for fingers.
pub fn with_key<'a>(ui: &Ui, label: &'a str) -> &'a str {
    if style::is_for_fingers(ui) { text::without_key(label) } else { label }
}

/// The title of a group of settings.
pub fn section(ui: &mut Ui, title: &str) {
    ui.add_space(10.0);
    let weak = style::palette(ui).weak_text;
    ui.label(RichText::new(title).small().strong().color(weak));
    ui.add_space(2.0);
}

/// Small, weak text that wraps.
pub fn hint(ui: &mut Ui, text: impl Into<RichText>) {
    let weak = style::palette(ui).weak_text;
    ui.add(egui::Label::new(text.into().small().color(weak)).wrap());
}

/// Height of a row in lists and of tabs.
pub const ROW_HEIGHT: f32 = 30.0;

/// Returns the height of a row that can be pressed: `height`, or more for fingers.
pub fn row_height(ui: &Ui, height: f32) -> f32 {
    style::press_size(ui, vec2(0.0, height)).y
}

/// Adds a control of this width and height, but no lower than egui draws it: each control of a row would otherwise sit below the
/// one before.
pub fn sized(ui: &mut Ui, [width, height]: [f32; 2], control: impl egui::Widget) -> Response {
    let height = height.max(ui.spacing().interact_size.y);
    ui.add_sized([width, height], control)
}

/// A small button beside a title, enlarged for fingers.
pub fn small_button(ui: &mut Ui, label: &str) -> Response {
    let height = row_height(ui, 0.0);
    ui.add(egui::Button::new(label).small().min_size(vec2(0.0, height)))
}

/// A text field of one line, in the middle of its height: a field for fingers is higher than its text.
pub fn text_field(text: &mut String) -> egui::TextEdit<'_> {
    egui::TextEdit::singleline(text).align(egui::Align2::LEFT_CENTER)
}

/// Returns the width of a line of text in letters of our font; others count as nothing. Unlike a layout, it allocates nothing.
pub fn text_width(ui: &Ui, text: &str, font: egui::FontId) -> f32 {
    ui.fonts_mut(|fonts| text.chars().map(|letter| fonts.glyph_width(&font, letter)).sum())
}

/// Returns the width of a button with this text.
pub fn button_width(ui: &Ui, text: &str) -> f32 {
    text_width(ui, text, style::BODY) + 2.0 * ui.spacing().button_padding.x
}

/// A row with a label on the left and a switch on the right; returns true when it was flipped.
pub fn switch(ui: &mut Ui, label: &str, on: bool) -> bool {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), row_height(ui, 28.0)), Sense::click());
    let role = Role::CheckBox;
    response.widget_info(|| WidgetInfo::selected(role, ui.is_enabled(), on, label));
    let palette = style::palette(ui);
    let painter = ui.painter_at(rect.expand(2.0));
    let text = if ui.is_enabled() { palette.text } else { palette.weak_text.gamma_multiply(0.7) };
    elided(ui, Rect::from_min_max(rect.min, rect.max - vec2(42.0, 0.0)), label, text);

    let how_on = ui.ctx().animate_bool_responsive(response.id, on);
    let track = Rect::from_min_size(rect.right_center() - vec2(34.0, 9.0), vec2(34.0, 18.0));
    let off = if response.hovered() { palette.pressed } else { palette.hover };
    let mut fill = off.lerp_to_gamma(palette.accent, how_on);
    if !ui.is_enabled() {
        fill = fill.gamma_multiply(0.5);
    }
    painter.rect_filled(track, 9.0, fill);
    let knob = egui::pos2(egui::lerp(track.left() + 9.0..=track.right() - 9.0, how_on), track.center().y);
    painter.circle_filled(knob, 6.5, if on { palette.on_accent } else { palette.weak_text });
    style::focus_ring(ui, &response, rect.expand(1.0), style::CORNER, 1.0);
    response.clicked()
}

/// Groups controls for assistive technology, under a name that tells them from other controls with the same names.
pub fn group<R>(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui) -> R) -> R {
    grouped(ui, Role::Group, name, contents)
}

/// Makes a list of tabs, of rows of a tree or of cells of a table for assistive technology, with a name.
pub fn list<R>(ui: &mut Ui, kind: List, name: &str, contents: impl FnOnce(&mut Ui) -> R) -> R {
    let role = match kind {
        List::Tabs => Role::TabList,
        List::Tree => Role::Tree,
        List::Table => Role::Grid,
    };
    grouped(ui, role, name, contents)
}

/// What a [`list`] consists of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum List {
    /// Tabs of a panel.
    Tabs,
    /// Rows of a tree.
    Tree,
    /// Cells of a table.
    Table,
}

fn grouped<R>(ui: &mut Ui, role: Role, name: &str, contents: impl FnOnce(&mut Ui) -> R) -> R {
    let group = egui::UiBuilder::new().accessibility_role(role);
    ui.scope_builder(group, |ui| {
        ui.ctx().accesskit_node_builder(ui.unique_id(), |node| node.set_label(name));
        contents(ui)
    })
    .inner
}

/// A rounded card that fills the width.
pub fn card<R>(ui: &mut Ui, contents: impl FnOnce(&mut Ui) -> R) -> R {
    let style::Palette { surface, panel, .. } = style::palette(ui);
    egui::Frame::new()
        .fill(surface)
        .corner_radius(style::CORNER)
        .inner_margin(egui::Margin::same(10))
        .show(ui, |ui| {
            ui.set_width(ui.available_width());
            // The usual colour of buttons is the card's own.
            ui.visuals_mut().widgets.inactive.weak_bg_fill = panel;
            contents(ui)
        })
        .inner
}

/// A selectable full-width row: a name, and a short text on the right.
pub fn list_row(ui: &mut Ui, name: &str, right: &str, chosen: bool) -> Response {
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), row_height(ui, ROW_HEIGHT)), Sense::click());
    let role = Role::Button;
    response.widget_info(|| WidgetInfo::selected(role, ui.is_enabled(), chosen, name));
    let mut cut = false;
    if ui.is_rect_visible(rect) {
        let palette = style::palette(ui);
        ui.painter().rect_filled(rect, style::CORNER, style::fill(&palette, &response, chosen));
        style::focus_ring(ui, &response, rect, style::CORNER, 1.0);
        let mut left = rect.shrink2(Vec2::new(10.0, 0.0));
        if !right.is_empty() {
            let drawn = ui.painter().text(
                left.right_center(),
                egui::Align2::RIGHT_CENTER,
                right,
                style::SMALL,
                palette.weak_text,
            );
            left.max.x = drawn.left() - 8.0;
        }
        let color = if chosen { palette.accent } else { palette.text };
        cut = elided(ui, left, name, color);
    }
    if cut { response.on_hover_text(name) } else { response }
}

/// Paints one line of text, truncated with an ellipsis where it doesn't fit; returns whether it was truncated.
pub fn elided(ui: &Ui, rect: Rect, text: &str, color: Color32) -> bool {
    elided_in(ui, rect, text, color, egui::TextStyle::Body)
}

/// Like [`elided`], in small text.
pub fn elided_small(ui: &Ui, rect: Rect, text: &str, color: Color32) -> bool {
    elided_in(ui, rect, text, color, egui::TextStyle::Small)
}

fn elided_in(ui: &Ui, rect: Rect, text: &str, color: Color32, style: egui::TextStyle) -> bool {
    let font = style.resolve(ui.style());
    let line = |text: &str, width: f32| {
        let mut job = egui::text::LayoutJob { break_on_newline: false, ..egui::text::LayoutJob::default() };
        job.append(text, 0.0, egui::TextFormat::simple(font.clone(), color));
        job.wrap = egui::text::TextWrapping::truncate_at_width(width.max(0.0));
        ui.painter().layout_job(job)
    };
    let mut galley = line(text, rect.width());
    let cut = galley.elided;
    let mut at = rect.left_center() - vec2(0.0, galley.size().y / 2.0);
    // Equal names differ in the number at the end.
    let number = text.rfind(" (").filter(|_| cut && text.ends_with(')'));
    if let Some((name, number)) = number.map(|number| (&text[..number], line(&text[number..], rect.width())))
        && number.size().x < 0.5 * rect.width()
    {
        let name = line(name, rect.width() - number.size().x);
        let after = at + vec2(name.size().x, 0.0);
        ui.painter().galley(at, name, color);
        (at, galley) = (after, number);
    }
    ui.painter().galley(at, galley, color);
    cut
}

/// Room for the floating scroll bar, which widens under the pointer.
pub const SCROLL_BAR_WIDTH: f32 = 12.0;
/// Space below what scrolls.
pub const SCROLLED_MARGIN: f32 = 12.0;

/// The contents of a tab, which scroll if they are higher than the panel. `id` identifies the scroll position.
pub fn scrolled(ui: &mut Ui, id: impl egui::AsIdSalt, contents: impl FnOnce(&mut Ui)) {
    egui::ScrollArea::vertical().id_salt(id).auto_shrink([false, false]).show(ui, |ui| {
        ui.set_max_width(ui.available_width() - SCROLL_BAR_WIDTH);
        contents(ui);
        ui.add_space(SCROLLED_MARGIN);
        follow_focus(ui);
    });
}

/// Returns the control that has the focus.
pub fn focused(ui: &Ui) -> Option<Response> {
    ui.memory(egui::Memory::focused).and_then(|id| ui.ctx().read_response(id))
}

/// Scrolls to a control that has just taken the focus and may be out of sight, which egui doesn't. Call it in a scroll area, after
/// its contents.
pub fn follow_focus(ui: &Ui) {
    let Some(focused) = focused(ui) else { return };
    // What is in sight of a control elsewhere, such as in the row below the panel, isn't within this panel's clip.
    let is_inside = ui.min_rect().contains_rect(focused.rect)
        && (!focused.interact_rect.is_positive() || ui.clip_rect().contains_rect(focused.interact_rect));
    if focused.gained_focus() && is_inside {
        focused.scroll_to_me(None);
    }
}
