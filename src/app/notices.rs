//! What the user is told: errors until they are dismissed, notices for a while.

use super::App;
use crate::editor::Event;
use crate::ui::{Tab, Toast};

impl App {
    /// Shows an error instead of earlier ones.
    pub(super) fn fail(&mut self, error: String) {
        self.panels.messages.clear_error();
        self.panels.messages.error = Some(error);
    }

    /// Shows an error besides earlier ones.
    pub(super) fn tell(&mut self, problem: &str) {
        let error = self.panels.messages.error.get_or_insert_default();
        if !error.is_empty() {
            error.push('\n');
        }
        error.push_str(problem);
    }

    pub(super) fn toast(&mut self, text: String) {
        self.show_toast(text, false);
    }

    fn show_toast(&mut self, text: String, undoable: bool) {
        const SECS: f64 = 2.5;
        const SECS_PER_LETTER: f64 = 0.03;
        let secs = SECS + SECS_PER_LETTER * text.len() as f64 + if undoable { Toast::UNDOABLE_SECS } else { 0.0 };
        let until_secs = self.context.input(|input| input.time) + secs;
        self.panels.messages.toast = Some(Toast { text, until_secs, undoable });
        self.toasted_steps = self.editor.undo_steps();
    }

    /// A toast's button undoes what the toast says: the toast goes once that is no longer the last step.
    pub(super) fn watch_toast(&mut self) {
        let steps = self.editor.undo_steps();
        self.panels.messages.toast.take_if(|toast| toast.undoable && steps != self.toasted_steps);
    }

    /// Shows what happened in the editor.
    pub(super) fn show_events(&mut self) {
        for event in self.editor.take_events() {
            match event {
                Event::Notice { text, undoable } => self.show_toast(text, undoable),
                Event::Problem(problem) => self.tell(&problem),
                Event::ViewOpened => {
                    self.panels.on_view_opened(self.editor.state());
                    // Space is for the new view, not for a button that was pressed before.
                    if let Some(focused) = self.context.memory(|memory| memory.focused()) {
                        self.context.memory_mut(|memory| memory.surrender_focus(focused));
                    }
                }
                Event::ModelOpened => self.panels.on_model_opened(self.editor.library()),
                Event::MotionsRefused => self.panels.messages.motion_refused = true,
                Event::MapStarted => (self.panels.layout.tab, self.panels.layout.inspector_open) = (Tab::Motion, true),
                Event::Stepped => self.panels.messages.toast = None,
            }
        }
    }
}
