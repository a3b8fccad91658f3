//! Keeps typing and shortcuts apart when one frame has several inputs, as on a slow machine: what is typed goes to the field
//! that the inputs before it have focused, and a field's keys are never shortcuts.

use egui::text_edit::TextEditState;
use egui::{Context, Event, Id, Key, Plugin, RawInput, Ui};

/// Adds the rule to a context.
pub(super) fn install(context: &Context) {
    context.add_plugin(Typing::default());
}

/// Whether a text or number field has or had the keyboard in this frame. Enter, Esc or a click may have taken it away.
pub(super) fn is_typing(context: &Context) -> bool {
    let was_focused = context.plugin_opt::<Typing>().map(|typing| typing.lock().was_focused).unwrap_or_default();
    let focused = context.memory(|memory| memory.focused());
    // Looked up only now: a number field has no text state before its first frame with the keyboard.
    was_focused.into_iter().chain([focused]).flatten().any(|id| TextEditState::load(context, id).is_some())
}

#[derive(Default)]
struct Typing {
    /// What had focus before the pass, and after egui cleared it for Esc or moved it for Tab.
    was_focused: [Option<Id>; 2],
    /// Typed after an input that may move the focus, with all that followed.
    waiting: Vec<Event>,
    /// Withholds all input from the next pass: a field opened by a click asks for focus in the pass after the click.
    is_holding: bool,
}

impl Plugin for Typing {
    fn debug_name(&self) -> &'static str {
        "typing"
    }

    fn input_hook(&mut self, context: &Context, input: &mut RawInput) {
        self.was_focused[0] = context.memory(|memory| memory.focused());
        let mut events = std::mem::take(&mut self.waiting);
        events.append(&mut input.events);
        if std::mem::take(&mut self.is_holding) {
            self.waiting = events;
            return;
        }
        let mover = events.iter().position(may_move_focus).map_or(events.len(), |at| at + 1);
        if let Some(typed) = events[mover..].iter().position(is_typed) {
            self.waiting = events.split_off(mover + typed);
            self.is_holding = true;
        }
        input.events = events;
    }

    fn on_begin_pass(&mut self, ui: &mut Ui) {
        self.was_focused[1] = ui.memory(|memory| memory.focused());
    }

    fn on_end_pass(&mut self, ui: &mut Ui) {
        if !self.waiting.is_empty() {
            ui.ctx().request_repaint();
        }
    }
}

fn may_move_focus(event: &Event) -> bool {
    match event {
        Event::PointerButton { .. } => true,
        Event::Key { key, pressed, .. } => *pressed && matches!(key, Key::Enter | Key::Escape | Key::Tab),
        _ => false,
    }
}

fn is_typed(event: &Event) -> bool {
    match event {
        Event::Key { pressed, .. } => *pressed,
        Event::Text(_) | Event::Ime(_) | Event::Paste(_) | Event::Copy | Event::Cut => true,
        _ => false,
    }
}
