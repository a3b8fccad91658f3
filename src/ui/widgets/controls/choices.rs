//! Menus, lists that drop down, segmented buttons and tabs.

use egui::accesskit::Role;
use egui::{Rect, Response, Sense, Stroke, Ui, WidgetInfo, vec2};

use super::{List, ROW_HEIGHT, follow_focus, grouped, list, row_height, text_width};
use crate::ui::text;
use crate::ui::widgets::{accessible, style};

/// A button with a menu. Moving the focus to a control outside closes the menu; Esc and an entry pressed by key also give the focus
/// back to the button.
pub fn menu_button(ui: &mut Ui, label: &str, contents: impl FnOnce(&mut Ui)) -> Response {
    let (button, menu) = egui::containers::menu::MenuButton::new(label).ui(ui, contents);
    accessible::set_expanded(&button, menu.is_some());
    keep_menu_focus(ui, &button, menu.is_some());
    button
}

fn keep_menu_focus(ui: &Ui, button: &Response, is_open: bool) {
    let before = button.id.with("focus before");
    let focused = ui.memory(egui::Memory::focused);
    let is_outside = |id| ui.ctx().read_response(id).is_some_and(|control| control.layer_id == button.layer_id);
    if !is_open {
        let before = ui.data_mut(|data| data.remove_temp::<Option<egui::Id>>(before)).flatten();
        // The entry is gone.
        if before.is_some() && !focused.is_some_and(is_outside) {
            button.request_focus();
        }
        return;
    }
    let before = ui.data_mut(|data| std::mem::replace(data.get_temp_mut_or(before, focused), focused));
    if ui.input(|input| input.key_pressed(egui::Key::Escape)) {
        // Only if the keyboard was used: after a click, keys go on controlling the viewport.
        if before.is_some() {
            button.request_focus();
        }
    } else if focused != before && focused.is_some_and(|id| id != button.id && is_outside(id)) {
        egui::Popup::close_id(ui.ctx(), egui::Popup::default_response_id(button));
    }
}

/// A list of [`option`]s that drops down from a button with the text of the chosen one, as wide as what is available. `name` is its
/// accessible name. It takes and gives back the keyboard as menus do.
pub fn chooser(
    ui: &mut Ui,
    id: impl egui::AsIdSalt,
    name: &str,
    chosen: &str,
    options: impl FnOnce(&mut Ui),
) -> Response {
    /// A longer list scrolls.
    const MAX_HEIGHT: f32 = 440.0;
    // A higher list than the window would be cut off.
    let height = MAX_HEIGHT.min(ui.ctx().content_rect().height() - 40.0);
    let combo = egui::ComboBox::from_id_salt(id).width(ui.available_width()).height(height);
    let list = combo.truncate().selected_text(chosen).show_ui(ui, |ui| {
        options(ui);
        follow_focus(ui);
    });
    keep_menu_focus(ui, &list.response, list.inner.is_some());
    list.response.accessible_name(name)
}

/// A button that is on or off, in lists and groups.
pub fn choice(ui: &mut Ui, on: bool, label: &str) -> Response {
    // Pale like rows and segments. Set only here, since egui fills sliders with the same colour.
    let before = ui.visuals().selection;
    let palette = style::palette(ui);
    let selection = &mut ui.visuals_mut().selection;
    (selection.bg_fill, selection.stroke.color) = (palette.chosen, palette.accent);
    let response = ui.selectable_label(on, label);
    ui.visuals_mut().selection = before;
    response
}

/// An entry of a [`chooser`], which opens where it is `on`; returns whether it was chosen. A click would close the list anyway, a key
/// wouldn't.
pub fn option(ui: &mut Ui, on: bool, label: &str) -> bool {
    let response = choice(ui, on, label);
    if on && ui.is_sizing_pass() {
        response.scroll_to_me(Some(egui::Align::Center));
    }
    let is_chosen = response.clicked();
    if is_chosen {
        ui.close();
    }
    is_chosen
}

/// Buttons of equal width, of which one is selected, in as many rows as their texts need; returns the value of the one that
/// was pressed. The topic is the accessible name of their group.
pub fn segmented<T: Copy + PartialEq>(ui: &mut Ui, topic: &str, chosen: Option<T>, choices: &[(T, &str)]) -> Option<T> {
    grouped(ui, Role::RadioGroup, topic, |ui| segments(ui, chosen, choices, Segments::Choice { prefix: None }))
}

/// Like [`segmented`], but each button's accessible name begins with the topic, because the labels alone are ambiguous.
pub fn segmented_about<T: Copy + PartialEq>(
    ui: &mut Ui,
    topic: &str,
    chosen: Option<T>,
    choices: &[(T, &str)],
) -> Option<T> {
    let row = Segments::Choice { prefix: Some(topic) };
    grouped(ui, Role::RadioGroup, topic, |ui| segments(ui, chosen, choices, row))
}

/// The tabs of a panel with this name, of which one is open, above a line; returns the one that was pressed. Some have a badge: a
/// text about them, shown as a dot and its tooltip.
pub fn tabs<T: Copy + PartialEq>(
    ui: &mut Ui,
    panel: &str,
    open: T,
    tabs: &[(T, &str)],
    badge: impl Fn(T) -> Option<String>,
) -> Option<T> {
    list(ui, List::Tabs, panel, |ui| segments(ui, Some(open), tabs, Segments::Tabs { badge: &badge }))
}

/// Minimum gap between the texts of neighbouring segments.
const SEGMENT_GAP: f32 = 8.0;

/// Returns how many segments with these texts go into a row of this width, if all rows are about equally full.
fn columns(ui: &Ui, width: f32, texts: &mut dyn ExactSizeIterator<Item = &str>) -> usize {
    let count = texts.len().max(1);
    let widest = texts.map(|text| text_width(ui, text, style::SMALL)).fold(0.0, f32::max);
    let max = ((width / (widest + SEGMENT_GAP)) as usize).clamp(1, count);
    let rows = count.div_ceil(max);
    count.div_ceil(rows)
}

/// What a row of segments is.
#[derive(Clone, Copy)]
enum Segments<'a, T> {
    /// Values to choose from; each accessible name begins with the prefix.
    Choice { prefix: Option<&'a str> },
    /// Tabs, with their badges.
    Tabs { badge: &'a dyn Fn(T) -> Option<String> },
}

fn segments<T: Copy + PartialEq>(
    ui: &mut Ui,
    chosen: Option<T>,
    choices: &[(T, &str)],
    row: Segments<'_, T>,
) -> Option<T> {
    let mut pressed = None;
    let palette = style::palette(ui);
    let (width, height) = (ui.available_width(), row_height(ui, ROW_HEIGHT));
    let (role, prefix, font, columns) = match row {
        Segments::Choice { prefix } => {
            let columns = columns(ui, width, &mut choices.iter().map(|(_, label)| *label));
            (Role::RadioButton, prefix, style::SMALL, columns)
        }
        Segments::Tabs { .. } => (Role::Tab, None, style::BODY, choices.len().max(1)),
    };
    let rows = choices.len().div_ceil(columns).max(1);
    let (bar, whole) = ui.allocate_exact_size(vec2(width, rows as f32 * height), Sense::hover());
    match row {
        Segments::Choice { .. } => drop(ui.painter().rect_filled(bar, style::CORNER, palette.surface)),
        Segments::Tabs { .. } => {
            ui.painter().hline(bar.x_range(), bar.bottom() + 3.0, Stroke::new(1.0, palette.line));
        }
    }
    let size = vec2(bar.width() / columns as f32, height);
    for (index, (value, label)) in choices.iter().enumerate() {
        let at = vec2((index % columns) as f32, (index / columns) as f32);
        let cell = Rect::from_min_size(bar.min + at * size, size);
        let response = ui.interact(cell, whole.id.with(index), Sense::click());
        let on = chosen == Some(*value);
        response.widget_info(|| {
            let name = prefix.map_or_else(|| (*label).to_owned(), |prefix| text::labelled(prefix, label));
            WidgetInfo::selected(role, ui.is_enabled(), on, name)
        });
        segment(ui, cell, &response, on, label, font.clone());
        if response.clicked() {
            pressed = Some(*value);
        }
        if let Segments::Tabs { badge } = row
            && let Some(badge) = badge(*value)
        {
            ui.painter().circle_filled(cell.right_top() + vec2(-8.0, 8.0), 3.0, palette.warning);
            response.ctx.accesskit_node_builder(response.id, |node| node.set_description(badge.clone()));
            response.on_hover_text(badge);
        }
    }
    pressed
}

fn segment(ui: &Ui, cell: Rect, response: &Response, on: bool, label: &str, font: egui::FontId) {
    let palette = style::palette(ui);
    let inner = cell.shrink(2.0);
    let corner = style::CORNER - 2;
    ui.painter().rect_filled(inner, corner, style::fill(&palette, response, on));
    style::focus_ring(ui, response, inner, corner, 1.0);
    let color = if on { palette.accent } else { palette.text };
    ui.painter().text(cell.center(), egui::Align2::CENTER_CENTER, label, font, color);
}
