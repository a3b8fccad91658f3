//! Which commands belong to one gesture of the user, and so to one undo step.

use egui::{Event, PointerButton, Ui};

use crate::editor::Editor;

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
    if is_double_click {
        editor.continue_gesture();
    }
}

/// Ends the gesture once nothing is held. Call it after the frame's commands are applied.
pub fn end_gestures(ui: &Ui, editor: &mut Editor) {
    if ui.input(|input| !input.pointer.any_down() && input.keys_down.is_empty()) {
        editor.end_gesture();
    }
}
