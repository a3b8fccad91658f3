//! Fields for numbers and sliders, and how numbers are typed.

use egui::{Rect, Response, Sense, Stroke, Ui, WidgetInfo, vec2};

use super::{elided, named, row_height, sized};
use crate::ui::text;
use crate::ui::widgets::{accessible, style};

/// Adds a field for a number, which `setup` describes. What is typed is one edit, once Enter or a click elsewhere accepts it; Esc
/// leaves the number as it was. Callers compare the number with the one before.
pub fn number<N: egui::emath::Numeric>(
    ui: &mut Ui,
    size: [f32; 2],
    value: &mut N,
    setup: impl for<'a> FnOnce(egui::DragValue<'a>) -> egui::DragValue<'a>,
) -> Response {
    let before = *value;
    let field = egui::DragValue::new(value).custom_parser(read_number).update_while_editing(false);
    let field = sized(ui, size, setup(field));
    if is_swiped(ui, &field) || is_cancelled(ui, &field) {
        *value = before;
    }
    field
}

/// Returns whether Esc has taken the keyboard from this field: egui drops what was typed then, but sets it in the next frame, in
/// which the field counts as just left, too, and Esc is no longer pressed.
fn is_cancelled(ui: &Ui, field: &Response) -> bool {
    let id = field.id.with("is cancelled");
    let was_cancelled = ui.data_mut(|data| data.remove_temp(id)).unwrap_or(false);
    let is_cancelled = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Escape));
    if is_cancelled {
        ui.data_mut(|data| data.insert_temp(id, true));
    }
    was_cancelled || is_cancelled
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
    let SliderSettings { decimals, suffix, .. } = settings;
    accessible::describe_value(&response, || format!("{bar:.decimals$}{suffix}"));
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
fn read_number(text: &str) -> Option<f64> {
    let text: String = text.replace('−', "-").split_whitespace().collect();
    // Beside a point, commas would separate thousands.
    let text = if text.contains('.') { text } else { text.replace(',', ".") };
    text.parse().ok()
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
