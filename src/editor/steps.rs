//! Undo and redo. A notice says when that activates, lists or closes another model, or removes or restores a motion: the user
//! may have opened it long ago.

use super::{Editor, Event, short_name};
use crate::library::ModelId;
use crate::state::{Edited, OrbitCamera, ViewerState};

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
        let before = self.before_step(self.history.would_undo_motion(&self.state));
        let done = self.history.undo(&mut self.state, &mut self.reduced_motion.saved, &mut self.library);
        if done {
            self.finish_step(before, true);
        }
        done
    }

    /// Redoes the last undone step; returns false if there is none.
    pub fn redo(&mut self) -> bool {
        let before = self.before_step(self.history.would_redo_motion(&self.state));
        let done = self.history.redo(&mut self.state, &mut self.reduced_motion.saved, &mut self.library);
        if done {
            self.finish_step(before, false);
        }
        done
    }

    fn before_step(&self, is_motion: bool) -> BeforeStep {
        BeforeStep {
            state: self.state.clone(),
            names: self.loaded_names(),
            view: if is_motion { self.automatic_view() } else { None },
        }
    }

    fn finish_step(&mut self, before: BeforeStep, is_undo: bool) {
        let BeforeStep { state, names: before, view } = before;
        (self.needs_redraw, self.is_changed) = (true, true);
        let after = self.loaded_names();
        let notice = step_notice(&before, &after, if is_undo { "Redo" } else { "Undo" });
        let edited = if notice.is_none() { Edited::between(&state, &self.state) } else { None };
        self.events.push(Event::Stepped { is_undo, edited });
        let problems = self.retarget();
        self.report(problems);
        if let Some(text) = notice {
            self.notify(text);
        }
        self.hold_view(view);
    }

    fn loaded_names(&self) -> LoadedNames {
        LoadedNames {
            model: self.library.active().map(|model| (model.id, short_name(&model.source))),
            listed: self.library.models().iter().map(|model| (model.id, short_name(&model.source))).collect(),
            motions: self.library.motions().iter().map(|motion| short_name(&motion.source)).collect(),
        }
    }
}

/// What a step may change. A step that opened or removed something restores its own clip and view.
struct BeforeStep {
    state: ViewerState,
    names: LoadedNames,
    /// What the camera showed before an edit of how the body moves, unless the user has chosen the view.
    view: Option<OrbitCamera>,
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
