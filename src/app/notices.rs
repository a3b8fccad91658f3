//! What the person is told: errors until they are dismissed, notices for a while; and the steps back and on again, which say
//! what they did.

use super::App;
use crate::ui::{Toast, short_name};

impl App {
    /// Shows what is wrong instead of what was wrong before.
    pub(super) fn fail(&mut self, error: String) {
        self.panels.motion_refused = false;
        self.panels.error = Some(error);
    }

    /// Shows what is wrong besides.
    pub(super) fn tell(&mut self, problems: Vec<String>) {
        if !problems.is_empty() {
            let before = self.panels.error.take().into_iter();
            self.panels.error = Some(before.chain(problems).collect::<Vec<_>>().join("\n"));
        }
    }

    /// A toast with a way back.
    pub(super) fn toast_undoable(&mut self, text: String) {
        self.toast(text);
        if let Some(toast) = &mut self.panels.toast {
            toast.undoable = true;
            toast.until_secs += Toast::UNDOABLE_SECS;
        }
        self.toasted_steps = self.history.steps();
    }

    /// The button of a toast takes back what the toast says: it goes when that is not the last step any more.
    pub(super) fn watch_toast(&mut self) {
        let steps = self.history.steps();
        self.panels.toast.take_if(|toast| toast.undoable && steps != self.toasted_steps);
    }

    pub(super) fn toast(&mut self, text: String) {
        const SECS: f64 = 2.5;
        const SECS_PER_LETTER: f64 = 0.03;
        let secs = SECS + SECS_PER_LETTER * text.len() as f64;
        let until_secs = self.context.input(|input| input.time) + secs;
        self.panels.toast = Some(Toast { text, until_secs, undoable: false });
    }

    /// One step back, or on again. That another model is shown then, or that a motion goes or comes, is said: it may have
    /// been opened long before.
    pub(super) fn step(&mut self, back: bool) {
        let shown = |app: &Self| app.library.active().map(|model| (model.id, short_name(&model.source)));
        let motions = |app: &Self| app.library.motions().iter().map(|motion| short_name(&motion.source)).collect();
        let (shown_before, motions_before): (_, Vec<String>) = (shown(self), motions(self));
        let done = match back {
            true => self.history.undo(&mut self.state, &mut self.library),
            false => self.history.redo(&mut self.state, &mut self.library),
        };
        if !done {
            return;
        }
        (self.dirty, self.changed) = (true, true);
        // What it said was about another step.
        self.panels.toast = None;
        let problems = self.refresh_motion();
        self.tell(problems);
        let motions_now: Vec<String> = motions(self);
        let only_in = |some: &[String], others: &[String]| -> String {
            some.iter().filter(|name| !others.contains(name)).cloned().collect::<Vec<_>>().join(", ")
        };
        let (gone, come) = (only_in(&motions_before, &motions_now), only_in(&motions_now, &motions_before));
        let other_way = if back { "Ctrl+Y" } else { "Ctrl+Z" };
        if !gone.is_empty() {
            self.toast(format!("Nothing is borrowed from {gone} any more. {other_way} brings it back."));
        } else if !come.is_empty() {
            self.toast(format!("Borrowed from {come} again."));
        } else if let (Some((before, old)), Some((now, new))) = (shown_before, shown(self))
            && before != now
        {
            self.toast(format!("{new} is shown again. {other_way} leads back to {old}."));
        }
    }
}
