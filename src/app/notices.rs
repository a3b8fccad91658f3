//! Messages for the user: errors and what can't be used of a view stay until dismissed, notices for a few seconds.

use gaitway_scene::editor::Event;

use super::App;
use crate::ui::{Toast, text};

impl App {
    /// Shows an error, replacing earlier ones. The page's shell has it already and announces it itself.
    pub(super) fn replace_error(&mut self, error: String) {
        self.panels.messages.clear_error();
        self.panels.messages.error = Some(error);
    }

    /// Shows an error below earlier ones.
    pub(super) fn add_error(&mut self, problem: &str) {
        let error = self.panels.messages.error.get_or_insert_default();
        if !error.is_empty() {
            error.push('\n');
        }
        error.push_str(problem);
        self.has_new_message = true;
    }

    pub(super) fn toast(&mut self, text: String) {
        self.show_toast(text, false);
    }

    fn show_toast(&mut self, text: String, undoable: bool) {
        const SECS: f64 = 2.5;
        const SECS_PER_BYTE: f64 = 0.03;
        let secs = SECS + SECS_PER_BYTE * text.len() as f64 + if undoable { Toast::UNDOABLE_SECS } else { 0.0 };
        let until_secs = self.context.input(|input| input.time) + secs;
        self.panels.messages.toast = Some(Toast { text, until_secs, undoable, other: None });
        self.notice_steps = self.editor.undo_steps();
        self.announcement = None;
        self.has_new_message = true;
    }

    /// Hides an undoable toast once its step is no longer the last, since that is what its button undoes, and forgets what was undone
    /// or redone, so that the same is told again.
    pub(super) fn expire_notices(&mut self) {
        if self.editor.undo_steps() != self.notice_steps {
            self.panels.messages.toast.take_if(|toast| toast.undoable);
            self.announcement = None;
        }
    }

    /// Shows the editor's events.
    pub(super) fn show_events(&mut self) {
        for event in self.editor.take_events() {
            match event {
                Event::Notice { text, undoable } => self.show_toast(text, undoable),
                Event::Problem(problem) => self.add_error(&problem),
                // Nothing stays over an embedded view.
                Event::AboutView(text) if self.state().page.embed.is_on() => {
                    if !self.host.report(&text) {
                        self.toast(text);
                    }
                }
                Event::AboutView(text) => {
                    self.panels.messages.about_view = Some(text);
                    self.announcement = None;
                    self.has_new_message = true;
                }
                Event::ViewOpened => {
                    self.panels.on_view_opened(self.editor.state());
                    // Space plays and pauses the new view, instead of pressing the button that had focus.
                    if let Some(focused) = self.context.memory(|memory| memory.focused()) {
                        self.context.memory_mut(|memory| memory.surrender_focus(focused));
                    }
                }
                Event::ModelOpened => self.panels.on_model_opened(self.editor.library()),
                Event::MotionsAdded => self.panels.on_motions_added(),
                Event::MotionsRefused { lacks_skeleton } => {
                    let messages = &mut self.panels.messages;
                    (messages.motion_refused, messages.model_lacks_skeleton) = (true, lacks_skeleton);
                }
                Event::OtherReading(other) => {
                    if let Some(toast) = &mut self.panels.messages.toast {
                        toast.other = Some(other);
                        toast.until_secs += Toast::CHOICE_SECS;
                    }
                }
                Event::MapStarted => {
                    let has_focus = self.context.memory(|memory| memory.focused().is_some());
                    self.panels.on_map_started(has_focus);
                }
                Event::Stepped { is_undo, edited } => {
                    self.panels.messages.toast = None;
                    self.announce(text::stepped(is_undo, edited, self.editor.undo_steps()));
                }
                Event::SourceSet { target, source } => {
                    self.announce(text::source_set(&target, source.as_deref()));
                }
            }
        }
    }

    /// Tells screen readers what everyone else sees.
    fn announce(&mut self, text: String) {
        self.notice_steps = self.editor.undo_steps();
        self.announcement = Some(text);
        self.has_new_message = true;
    }
}
