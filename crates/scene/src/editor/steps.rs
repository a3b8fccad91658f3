//! Undo and redo. A notice says when that activates, lists or closes another model, or removes or restores a motion: the user
//! may have opened it long ago.

use super::transact::Change;
use super::{Editor, Event, short_name};
use crate::library::ModelId;
use crate::state::{Edited, History};

impl Editor {
    /// Returns whether there is a step to undo.
    pub fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    /// Returns whether there is an undone step to redo.
    pub fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    /// Whether the next undo takes back the user's edit of a joint map or of how motions are retargeted.
    pub fn can_undo_retargeting(&self) -> bool {
        self.history.would_undo_retargeting(&self.state) && !self.history.would_undo_automatic(&self.state)
    }

    /// Whether the next redo repeats such an edit.
    pub fn can_redo_retargeting(&self) -> bool {
        self.history.would_redo_retargeting(&self.state) && !self.history.would_redo_automatic(&self.state)
    }

    /// Number of steps that can be undone.
    pub fn undo_steps(&self) -> usize {
        self.history.steps()
    }

    /// The pointer or the key was released: the next edit is a separate step.
    pub fn end_gesture(&mut self) {
        self.history.end_gesture();
    }

    /// The pointer was pressed.
    pub fn pointer_pressed(&mut self) {
        self.history.pointer_pressed();
    }

    /// The second click of a double click continues the gesture of the first, if that changed something.
    pub fn continue_gesture(&mut self) {
        self.history.continue_gesture();
    }

    /// Undoes the last step; returns false if there is none.
    pub fn undo(&mut self) -> bool {
        self.step(true)
    }

    /// Redoes the last undone step; returns false if there is none.
    pub fn redo(&mut self) -> bool {
        self.step(false)
    }

    fn step(&mut self, is_undo: bool) -> bool {
        let is_edit = match is_undo {
            true if self.can_undo() => self.history.would_undo_edit(),
            false if self.can_redo() => self.history.would_redo_edit(),
            _ => return false,
        };
        // A step that opened or removed something restores its own clip and view.
        let kind = if is_edit { Change::Edit } else { Change::View };
        let (before, names) = (self.state.clone(), self.loaded_names());
        let mut edited = None;
        let problems = self.transact(kind, |editor| {
            let Self { history, state, reduced_motion, library, .. } = &mut *editor;
            let step = if is_undo { History::undo } else { History::redo };
            step(history, state, &mut reduced_motion.saved, library);
            edited = Edited::between(&before, state);
        });
        let notice = step_notice(&names, &self.loaded_names(), if is_undo { "Redo" } else { "Undo" });
        self.events.push(Event::Stepped { is_undo, edited: edited.filter(|_| notice.is_none()) });
        self.report(problems);
        if let Some(text) = notice {
            self.notify(text);
        }
        true
    }

    fn loaded_names(&self) -> LoadedNames {
        LoadedNames {
            model: self.library.active().map(|model| (model.id, short_name(&model.source))),
            listed: self.library.models().iter().map(|model| (model.id, short_name(&model.source))).collect(),
            motions: self.library.motions().iter().map(|motion| short_name(&motion.source)).collect(),
        }
    }
}

struct LoadedNames {
    model: Option<(ModelId, String)>,
    listed: Vec<(ModelId, String)>,
    motions: Vec<String>,
}

/// Returns what a step did to models and motions; `None` for edits alone.
fn step_notice(before: &LoadedNames, after: &LoadedNames, opposite: &str) -> Option<String> {
    if let (Some((old_id, old)), Some((id, name))) = (&before.model, &after.model)
        && old_id != id
    {
        return Some(format!("Back to {name}. {opposite} returns to {old}."));
    }
    let motion = |name: &String| name.clone();
    if let Some(removed) = missing_from(&before.motions, &after.motions, motion) {
        return Some(format!("Removed motion {removed}. {opposite} brings it back."));
    }
    if let Some(added) = missing_from(&after.motions, &before.motions, motion) {
        return Some(format!("Added motion {added} again."));
    }
    let model = |(_, name): &(ModelId, String)| name.clone();
    if let Some(closed) = missing_from(&before.listed, &after.listed, model) {
        return Some(format!("Closed {closed}. {opposite} reopens it."));
    }
    let reopened = missing_from(&after.listed, &before.listed, model)?;
    Some(format!("Reopened {reopened}. {opposite} closes it."))
}

/// Returns the names of what is not in `others`, separated by commas.
fn missing_from<T: PartialEq>(all: &[T], others: &[T], name: impl Fn(&T) -> String) -> Option<String> {
    let missing: Vec<String> = all.iter().filter(|one| !others.contains(one)).map(name).collect();
    (!missing.is_empty()).then(|| missing.join(", "))
}
