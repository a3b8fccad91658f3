//! Controls that all panels share: section titles, switches, segmented buttons, labelled sliders, rows and cards.

use egui::accesskit::Role;
use egui::{Color32, Rect, Response, RichText, Sense, Stroke, Ui, Vec2, WidgetInfo, vec2};

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

/// Adds a field for a number, which `setup` describes.
pub fn number<N: egui::emath::Numeric>(
    ui: &mut Ui,
    size: [f32; 2],
    value: &mut N,
    setup: impl for<'a> FnOnce(egui::DragValue<'a>) -> egui::DragValue<'a>,
) -> Response {
    let before = *value;
    let field = sized(ui, size, setup(egui::DragValue::new(value)));
    if is_swiped(ui, &field) {
        *value = before;
    }
    field
}

/// Returns whether a finger on this control moves up or down, or may be about to: then it doesn't drag the control, but scrolls
/// what that is in, as from anywhere else.
fn is_swiped(ui: &Ui, response: &Response) -> bool {
    /// In points; less is a tap.
    const MIN_DISTANCE: f32 = 6.0;
    let id = response.id.with("is swiped");
    if !response.is_pointer_button_down_on() {
        let is_lifted = response.interact_pointer_pos().is_some();
        return is_lifted && ui.data(|data| data.get_temp(id)).unwrap_or(false);
    }
    let (moved, delta) = ui.input(|input| {
        let pointer = &input.pointer;
        let moved = pointer.press_origin().zip(pointer.latest_pos()).map(|(from, to)| to - from);
        (moved.unwrap_or_default(), pointer.delta())
    });
    if ui.input(|input| input.pointer.any_pressed()) {
        ui.data_mut(|data| data.remove::<bool>(id));
    }
    if !ui.input(egui::InputState::any_touches) {
        // The browser tells that something is pressed before it tells that it is a finger.
        return moved.length() < MIN_DISTANCE && ui.input(egui::InputState::has_touch_screen);
    }
    let decided = ui.data(|data| data.get_temp(id));
    let is_swiped = decided.or((moved.length() >= MIN_DISTANCE).then(|| moved.y.abs() > moved.x.abs()));
    let Some(is_swiped) = is_swiped else { return true };
    ui.data_mut(|data| data.insert_temp(id, is_swiped));
    if is_swiped {
        let by = if decided.is_some() { delta } else { moved };
        ui.scroll_with_delta_animation(vec2(0.0, by.y), egui::style::ScrollAnimation::none());
    }
    is_swiped
}

/// A small button beside a title, enlarged for fingers.
pub fn small_button(ui: &mut Ui, label: &str) -> Response {
    let height = row_height(ui, 0.0);
    ui.add(egui::Button::new(label).small().min_size(vec2(0.0, height)))
}

/// A button with a menu. Moving the focus to a control outside closes the menu; Esc and an entry pressed by key also give the focus
/// back to the button.
pub fn menu_button(ui: &mut Ui, label: &str, contents: impl FnOnce(&mut Ui)) -> Response {
    let (button, menu) = egui::containers::menu::MenuButton::new(label).ui(ui, contents);
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

/// Buttons of equal width, of which one is selected, in as many rows as their texts need; returns the value of the one that
/// was pressed. The topic is the accessible name of their group.
pub fn segmented<T: Copy + PartialEq>(ui: &mut Ui, topic: &str, chosen: Option<T>, choices: &[(T, &str)]) -> Option<T> {
    segments(ui, chosen, choices, Segments::Choice { topic, is_named: false })
}

/// Like [`segmented`], but each button's accessible name begins with the topic, because the labels alone are ambiguous.
pub fn segmented_about<T: Copy + PartialEq>(
    ui: &mut Ui,
    topic: &str,
    chosen: Option<T>,
    choices: &[(T, &str)],
) -> Option<T> {
    segments(ui, chosen, choices, Segments::Choice { topic, is_named: true })
}

/// The tabs of a panel, of which one is open, above a line; returns the one that was pressed. Some have a badge: a text about
/// them, shown as a dot and its tooltip.
pub fn tabs<T: Copy + PartialEq>(
    ui: &mut Ui,
    open: T,
    tabs: &[(T, &str)],
    badge: impl Fn(T) -> Option<String>,
) -> Option<T> {
    segments(ui, Some(open), tabs, Segments::Tabs { badge: &badge })
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
    /// Values to choose from. `is_named`: the topic is part of each accessible name.
    Choice { topic: &'a str, is_named: bool },
    /// Tabs, with their badges.
    Tabs { badge: &'a dyn Fn(T) -> Option<String> },
}

fn segments<T: Copy + PartialEq>(
    ui: &mut Ui,
    chosen: Option<T>,
    choices: &[(T, &str)],
    row: Segments<'_, T>,
) -> Option<T> {
    let Segments::Choice { topic, .. } = row else { return segments_in(ui, chosen, choices, row) };
    grouped(ui, Role::RadioGroup, topic, |ui| segments_in(ui, chosen, choices, row))
}

/// Groups controls for assistive technology, under a name that tells them from other controls with the same names.
pub fn group<R>(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui) -> R) -> R {
    grouped(ui, Role::Group, name, contents)
}

fn grouped<R>(ui: &mut Ui, role: Role, name: &str, contents: impl FnOnce(&mut Ui) -> R) -> R {
    let group = egui::UiBuilder::new().accessibility_role(role);
    ui.scope_builder(group, |ui| {
        ui.ctx().accesskit_node_builder(ui.unique_id(), |node| node.set_label(name));
        contents(ui)
    })
    .inner
}

fn segments_in<T: Copy + PartialEq>(
    ui: &mut Ui,
    chosen: Option<T>,
    choices: &[(T, &str)],
    row: Segments<'_, T>,
) -> Option<T> {
    let mut pressed = None;
    let palette = style::palette(ui);
    let (width, height) = (ui.available_width(), row_height(ui, ROW_HEIGHT));
    let (role, about, font, columns) = match row {
        Segments::Choice { topic, is_named } => {
            let columns = columns(ui, width, &mut choices.iter().map(|(_, label)| *label));
            (Role::RadioButton, is_named.then_some(topic), style::SMALL, columns)
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
            let name = about.map_or_else(|| (*label).to_owned(), |topic| text::labelled(topic, label));
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

/// A label and a value with a slider below; returns the new value. A double click resets it to `default`.
pub fn slider(ui: &mut Ui, label: &str, value: f64, settings: SliderSettings) -> Option<f64> {
    ui.scope(|ui| slider_in(ui, label, value, settings)).inner
}

fn slider_in(ui: &mut Ui, label: &str, value: f64, settings: SliderSettings) -> Option<f64> {
    let mut new = value;
    label_and_value(ui, label, &mut new, &settings);
    let width = ui.available_width();
    ui.spacing_mut().slider_width = width;
    let mut bar = new;
    let (row, _) = ui.allocate_exact_size(vec2(width, row_height(ui, SLIDER_HEIGHT)), Sense::hover());
    knob_style(ui);
    let middle = Rect::from_center_size(row.center(), vec2(width, SLIDER_HEIGHT));
    let response = ui.new_child(egui::UiBuilder::new().max_rect(middle)).add(
        egui::Slider::new(&mut bar, settings.range.0..=settings.range.1)
            .show_value(false)
            .logarithmic(settings.logarithmic)
            // From 0, where such a slider is at rest, egui can't fill it.
            .trailing_fill(settings.range.0 >= 0.0)
            .clamping(egui::SliderClamping::Never),
    );
    response.widget_info(|| WidgetInfo::slider(true, bar, label));
    if !is_swiped(ui, &response) && response.changed() {
        new = bar;
    }
    // The knob is as high as the slider, but fingers can press anywhere in the row.
    if ui.interact(row, response.id, Sense::click()).double_clicked() {
        new = settings.default;
    }
    (new != value).then_some(new)
}

/// Whether a slider was double-clicked; by itself it senses drags only.
pub fn is_double_clicked(slider: &Response) -> bool {
    slider.interact(Sense::click()).double_clicked()
}

/// Height of a slider, which its knob fills.
const SLIDER_HEIGHT: f32 = 20.0;

/// Draws the knobs of all further sliders in this `Ui` as rings in the accent colour.
pub fn knob_style(ui: &mut Ui) {
    let palette = style::palette(ui);
    ui.spacing_mut().interact_size.y = SLIDER_HEIGHT;
    let widgets = &mut ui.visuals_mut().widgets;
    for (widget, width) in [(&mut widgets.inactive, 2.0), (&mut widgets.hovered, 2.5), (&mut widgets.active, 3.0)] {
        widget.fg_stroke = Stroke::new(width, palette.accent);
        widget.bg_stroke = Stroke::NONE;
        widget.bg_fill = palette.pressed;
    }
}

#[derive(Debug, Clone, Copy)]
pub struct SliderSettings {
    pub range: (f64, f64),
    pub default: f64,
    pub decimals: usize,
    pub suffix: &'static str,
    pub logarithmic: bool,
}

fn label_and_value(ui: &mut Ui, label: &str, value: &mut f64, settings: &SliderSettings) {
    ui.horizontal(|ui| {
        let field_width = 76.0;
        let width = (ui.available_width() - field_width - 8.0).max(20.0);
        let height = row_height(ui, 24.0);
        let (rect, _) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
        elided(ui, rect, label, style::palette(ui).text);
        ui.spacing_mut().interact_size.y = height;
        let (min, max) = settings.range;
        let before = *value;
        // When a field loses the focus, egui sets the number that it shows, rounded and clamped, even if nothing was typed.
        let shown = egui::emath::round_to_decimals(before, settings.decimals);
        let typed = move |text: &str| read_number(text).filter(|&typed| typed != shown);
        let field = number(ui, [field_width, height], value, |field| {
            field
                .speed((max - min) / 300.0)
                .range(min..=max)
                // A link's value may lie outside and stays until it is edited.
                .clamp_existing_to_range(false)
                .fixed_decimals(settings.decimals)
                // What is typed is one edit, not one per key.
                .update_while_editing(false)
                .custom_parser(typed)
                .suffix(settings.suffix)
        });
        if *value != before {
            // Arrow keys don't stop at the range.
            *value = value.clamp(min, max);
        }
        named(&field, || text::value_of(label));
    });
}

/// Reads a typed number, whose decimals may follow a comma.
pub fn read_number(text: &str) -> Option<f64> {
    let text: String = text.replace('−', "-").split_whitespace().collect();
    // Beside a point, commas would separate thousands.
    let text = if text.contains('.') { text } else { text.replace(',', ".") };
    text.parse().ok()
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

/// Scrolls to a control that has just taken the focus and may be out of sight, which egui doesn't. Call it in a scroll area, after
/// its contents.
pub fn follow_focus(ui: &Ui) {
    let Some(focused) = ui.memory(egui::Memory::focused).and_then(|id| ui.ctx().read_response(id)) else { return };
    // What is in sight of a control elsewhere, such as in the row below the panel, isn't within this panel's clip.
    let is_inside = ui.min_rect().contains_rect(focused.rect)
        && (!focused.interact_rect.is_positive() || ui.clip_rect().contains_rect(focused.interact_rect));
    if focused.gained_focus() && is_inside {
        focused.scroll_to_me(None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_a_point_or_a_comma() {
        for (text, number) in [
            ("1.5", Some(1.5)),
            ("1,5", Some(1.5)),
            ("−0,25", Some(-0.25)),
            (" 1 000 ", Some(1000.0)),
            ("1,234.5", None),
            ("1,5,0", None),
            ("50%", None),
            ("", None),
        ] {
            assert_eq!(read_number(text), number, "{text}");
        }
    }
}
