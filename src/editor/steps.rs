//! Undo and redo. A notice says when that activates another model, or removes or restores a motion: the user may have opened it
//! long ago.

use super::short_name;
use super::{Editor, Event};
use crate::library::ModelId;

impl Editor {
    /// Returns whether there is a step to undo.
    pub fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    /// Returns whether there is an undone step to redo.
    pub fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    /// Number of steps that can be undone.
    pub fn undo_steps(&self) -> usize {
        self.history.steps()
    }

    /// The pointer or the key was released: the next edit is a step of its own.
    pub fn end_gesture(&mut self) {
        self.history.end_gesture();
    }

    /// Undoes the last step; returns false if there is none.
    pub fn undo(&mut self) -> bool {
        let before = self.loaded_names();
        let done = self.history.undo(&mut self.state, &mut self.library);
        if done {
            self.finish_step(before, "Ctrl+Y");
        }
        done
    }

    /// Redoes the last undone step; returns false if there is none.
    pub fn redo(&mut self) -> bool {
        let before = self.loaded_names();
        let done = self.history.redo(&mut self.state, &mut self.library);
        if done {
            self.finish_step(before, "Ctrl+Z");
        }
        done
    }

    fn finish_step(&mut self, before: LoadedNames, opposite: &str) {
        (self.needs_redraw, self.is_changed) = (true, true);
        self.events.push(Event::Stepped);
        let problems = self.retarget();
        self.report(problems);
        let after = self.loaded_names();
        let removed = missing_from(&before.motions, &after.motions);
        let added = missing_from(&after.motions, &before.motions);
        if !removed.is_empty() {
            self.notify(format!("Removed motion {removed}. {opposite} brings it back."));
        } else if !added.is_empty() {
            self.notify(format!("Added motion {added} again."));
        } else if let (Some((old_id, old)), Some((id, name))) = (before.model, after.model)
            && old_id != id
        {
            self.notify(format!("Back to {name}. {opposite} returns to {old}."));
        }
    }

    fn loaded_names(&self) -> LoadedNames {
        LoadedNames {
            model: self.library.active().map(|model| (model.id, short_name(&model.source))),
            motions: self.library.motions().iter().map(|motion| short_name(&motion.source)).collect(),
        }
    }
}

struct LoadedNames {
    model: Option<(ModelId, String)>,
    motions: Vec<String>,
}

/// Returns the names that are not in `others`, separated by commas.
fn missing_from(names: &[String], others: &[String]) -> String {
    let missing: Vec<&str> = names.iter().filter(|name| !others.contains(name)).map(String::as_str).collect();
    missing.join(", ")
}
