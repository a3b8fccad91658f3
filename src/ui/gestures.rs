//! Which commands belong to one gesture of the user, and so to one undo step.

use egui::accesskit::{Action, ActionRequest};
use egui::{Event, Id, Key, PointerButton, Ui};
use gaitway_scene::editor::Editor;

/// Begins the gestures of a frame. Call it before the frame's commands are applied.
pub fn begin_gestures(ui: &Ui, editor: &mut Editor) {
    let is_double_click = ui.input(|input| {
        for event in &input.events {
            match event {
                // On a slow machine, one key is released in the same frame as the next is pressed.
                Event::Key { pressed: true, repeat: false, .. } => editor.end_gesture(),
                Event::PointerButton { button: PointerButton::Primary, pressed: true, .. } => editor.pointer_pressed(),
                _ => {}
            }
        }
        input.pointer.button_double_clicked(PointerButton::Primary)
    });
    if is_double_click || continues_steps(ui) {
        editor.continue_gesture();
    }
}

/// Whether keys or assistive technology go on changing one control by small steps, which together are one edit.
fn continues_steps(ui: &Ui) -> bool {
    /// Between two steps.
    const MAX_PAUSE_SECS: f64 = 1.0;
    let is_step = |event: &Event| match event {
        Event::Key { key, pressed: true, .. } => {
            [Key::ArrowUp, Key::ArrowDown, Key::ArrowLeft, Key::ArrowRight].contains(key)
        }
        Event::AccessKitActionRequest(ActionRequest { action, .. }) => {
            [Action::Increment, Action::Decrement].contains(action)
        }
        _ => false,
    };
    let (steps, now_secs) = ui.input(|input| (input.events.iter().any(is_step), input.time));
    let Some(control) = ui.memory(|memory| memory.focused()).filter(|_| steps) else { return false };
    let last = Id::unique("last step");
    ui.data_mut(|data| {
        let before: Option<(Id, f64)> = data.get_temp(last);
        data.insert_temp(last, (control, now_secs));
        before.is_some_and(|(of, at_secs)| of == control && now_secs - at_secs < MAX_PAUSE_SECS)
    })
}

/// Ends the gesture once nothing is held. Call it after the frame's commands are applied.
pub fn end_gestures(ui: &Ui, editor: &mut Editor) {
    if ui.input(|input| !input.pointer.any_down() && input.keys_down.is_empty()) {
        editor.end_gesture();
    }
}
