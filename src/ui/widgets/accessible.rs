//! Accessibility of the widgets that we draw ourselves: what they tell assistive technology, and the actions it requests.

use egui::accesskit::{Action, ActionData};
use egui::{EventFilter, Key, Response, Ui};

use crate::ui::text;

/// Describes a slider from 0 to `max` seconds; returns the value that assistive technology requests, if any.
pub fn time_slider(ui: &Ui, response: &Response, value: f64, max: f64, step: f64) -> Option<f64> {
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_value(text::seconds(value, max));
        node.set_min_numeric_value(0.0);
        node.set_max_numeric_value(max);
        node.set_numeric_value_step(step);
        [Action::SetValue, Action::Increment, Action::Decrement].into_iter().for_each(|action| node.add_action(action));
    });
    ui.input(|input| {
        let count = |action| input.num_accesskit_action_requests(response.id, action) as f64;
        let steps = count(Action::Increment) - count(Action::Decrement);
        let requests = input.accesskit_action_requests(response.id, Action::SetValue);
        let set = requests.filter_map(|request| match request.data {
            Some(ActionData::NumericValue(value)) => Some(value),
            _ => None,
        });
        let requested = set.last().or((steps != 0.0).then_some(value + steps * step));
        requested.filter(|value| value.is_finite()).map(|value| value.clamp(0.0, max))
    })
}

/// Describes a slider's value with the unit and decimals that the screen shows.
pub fn describe_value(slider: &Response, text: impl FnOnce() -> String) {
    slider.ctx.accesskit_node_builder(slider.id, |node| node.set_value(text()));
}

/// Describes a row of a tree, scrolls to it when it gains focus, and returns whether an arrow key expands or collapses it.
/// `depth` is 0 for a root; `is_expanded` is `None` for a row without children.
pub fn tree_item(ui: &Ui, response: &Response, depth: usize, is_expanded: Option<bool>) -> bool {
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_level(depth);
        if let Some(is_expanded) = is_expanded {
            node.set_expanded(is_expanded);
        }
    });
    if response.gained_focus() {
        response.scroll_to_me(None);
    }
    if !response.has_focus() {
        return false;
    }
    let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let pressed = |key| ui.input(|input| input.key_pressed(key));
    match is_expanded {
        Some(true) => pressed(Key::ArrowLeft),
        Some(false) => pressed(Key::ArrowRight),
        None => false,
    }
}

/// Tells whether what a button opens is open.
pub fn set_expanded(button: &Response, is_open: bool) {
    button.ctx.accesskit_node_builder(button.id, |node| node.set_expanded(is_open));
}

/// Makes a control a cell of a table; `row` identifies its row.
pub fn cell(response: &Response, row: usize) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_row_index(row));
}
