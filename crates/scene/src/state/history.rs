//! Undo and redo of edits and of opened files, but not of time, selection or camera. One gesture is one step.

use std::mem::Discriminant;

use super::clips::restore_edits;
use super::{Command, SavedMotion, ViewerState, apply};
use crate::library::{Library, Loaded, ModelId};

/// The undo and redo stacks, newest step last.
#[derive(Debug, Default)]
pub struct History {
    past: Vec<Step>,
    future: Vec<Step>,
    /// The gesture that made the last step.
    gesture: Option<Gesture>,
}

/// Consecutive commands of one kind, which share a step.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Gesture {
    kind: Discriminant<Command>,
    has_ended: bool,
    /// Presses of the pointer since it ended.
    presses: u32,
}

#[derive(Debug)]
enum Step {
    /// Restores edits alone.
    Edits(ViewerState),
    /// Restores what was loaded, with its whole view.
    View(ViewerState, SavedMotion, Loaded),
    /// Restores the list of models.
    Listed(Vec<ModelId>),
}

impl History {
    const MAX_STEPS: usize = 200;

    /// Applies a command, and adds a step if it was an edit that changed something. Consecutive commands of one kind are one
    /// step until [`History::end_gesture`], and none if they end where they began.
    pub fn apply(&mut self, state: &mut ViewerState, library: &Library, command: Command) {
        if !may_be_edit(&command) {
            apply(state, library, command);
            return;
        }
        let kind = std::mem::discriminant(&command);
        let before = state.clone();
        apply(state, library, command);
        // Commands that move the camera while a slider is dragged don't end the gesture.
        if !before.has_edits_of(state) {
            let gesture = Some(Gesture { kind, has_ended: false, presses: 0 });
            if self.gesture != gesture {
                self.push(Step::Edits(before));
            }
            self.future.clear();
            self.gesture = gesture;
            let is_back = |step: &mut Step| matches!(step, Step::Edits(before) if before.has_edits_of(state));
            if self.past.pop_if(is_back).is_some() {
                self.gesture = None;
            }
        }
    }

    /// The pointer or the key was released: the next edit is a separate step.
    pub fn end_gesture(&mut self) {
        self.gesture.iter_mut().for_each(|gesture| gesture.has_ended = true);
    }

    /// The pointer was pressed.
    pub fn pointer_pressed(&mut self) {
        self.gesture.iter_mut().filter(|gesture| gesture.has_ended).for_each(|gesture| gesture.presses += 1);
    }

    /// The second click of a double click continues the gesture of the first, if that changed something.
    pub fn continue_gesture(&mut self) {
        if let Some(gesture) = self.gesture.as_mut().filter(|gesture| gesture.presses < 2) {
            (gesture.has_ended, gesture.presses) = (false, 0);
        }
    }

    /// Adds a step with what was loaded before something was opened, retargeted or removed.
    pub fn opened(&mut self, state: ViewerState, saved_motion: SavedMotion, loaded: Loaded) {
        self.begin(Step::View(state, saved_motion, loaded));
    }

    /// Adds a step with the list of models before one was closed.
    pub fn closed(&mut self, listed: Vec<ModelId>) {
        self.begin(Step::Listed(listed));
    }

    fn begin(&mut self, step: Step) {
        self.gesture = None;
        self.push(step);
        self.future.clear();
    }

    fn push(&mut self, step: Step) {
        if self.past.len() == Self::MAX_STEPS {
            self.past.remove(0);
        }
        self.past.push(step);
    }

    /// Drops the steps that depend on evicted models.
    pub fn forget_gone(&mut self, library: &Library) {
        let is_gone = |step: &Step| matches!(step, Step::View(_, _, loaded) if library.get(loaded.model).is_none());
        let is_whole = |ids: &[ModelId]| ids.iter().all(|&id| library.get(id).is_some());
        for steps in [&mut self.past, &mut self.future] {
            steps.retain(|step| !matches!(step, Step::Listed(ids) if !is_whole(ids)));
            if let Some(last) = steps.iter().rposition(is_gone) {
                steps.drain(..=last);
            }
        }
    }

    /// Number of steps that can be undone.
    pub fn steps(&self) -> usize {
        self.past.len()
    }

    /// Whether there is a step to undo.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is a step to redo.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }

    /// Whether the last step edited joint maps or how motions are retargeted.
    pub fn would_undo_retargeting(&self, state: &ViewerState) -> bool {
        self.past.last().is_some_and(|step| step.is_of_retargeting(state))
    }

    /// Whether the last undone step did.
    pub fn would_redo_retargeting(&self, state: &ViewerState) -> bool {
        self.future.last().is_some_and(|step| step.is_of_retargeting(state))
    }

    /// Whether the last step changed nothing but edits.
    pub fn would_undo_edit(&self) -> bool {
        matches!(self.past.last(), Some(Step::Edits(_)))
    }

    /// Whether the last undone step did.
    pub fn would_redo_edit(&self) -> bool {
        matches!(self.future.last(), Some(Step::Edits(_)))
    }

    /// Whether the editor made the last step, not the user.
    pub fn would_undo_automatic(&self, state: &ViewerState) -> bool {
        matches!(self.past.last(), Some(Step::Edits(before)) if plants_feet(before, state))
    }

    /// Whether the editor made the last undone step.
    pub fn would_redo_automatic(&self, state: &ViewerState) -> bool {
        matches!(self.future.last(), Some(Step::Edits(after)) if plants_feet(state, after))
    }

    /// Undoes the last step; returns false if there is none.
    pub fn undo(&mut self, state: &mut ViewerState, saved_motion: &mut SavedMotion, library: &mut Library) -> bool {
        self.gesture = None;
        let Some(step) = self.past.pop() else { return false };
        self.future.push(step.take(state, saved_motion, library));
        true
    }

    /// Redoes the last undone step; returns false if there is none.
    pub fn redo(&mut self, state: &mut ViewerState, saved_motion: &mut SavedMotion, library: &mut Library) -> bool {
        self.gesture = None;
        let Some(step) = self.future.pop() else { return false };
        self.past.push(step.take(state, saved_motion, library));
        true
    }
}

impl Step {
    /// Whether taking the step changes nothing but edits, and among them those of retargeting.
    fn is_of_retargeting(&self, state: &ViewerState) -> bool {
        matches!(self, Self::Edits(before)
            if before.character.retarget != state.character.retarget
                || before.character.edits.clips != state.character.edits.clips
                || before.character.edits.layers != state.character.edits.layers)
    }

    /// Restores what the step holds; returns the step in the opposite direction.
    fn take(self, state: &mut ViewerState, saved_motion: &mut SavedMotion, library: &mut Library) -> Self {
        match self {
            Self::Edits(edits) => {
                let before = state.clone();
                restore_edits(state, library.active(), &edits);
                Self::Edits(before)
            }
            Self::View(view, view_motion, loaded) => {
                let before = Self::View(state.clone(), *saved_motion, library.loaded());
                if library.restore(loaded) {
                    (*state, *saved_motion) = (view, view_motion);
                }
                before
            }
            Self::Listed(ids) => {
                let before = library.listed();
                library.set_listed(&ids);
                Self::Listed(before)
            }
        }
    }
}

/// Whether the step from one state to the next is the editor's planting of the feet.
fn plants_feet(before: &ViewerState, after: &ViewerState) -> bool {
    after.character.retarget.feet_are_automatic && !before.character.retarget.feet_are_automatic
}

/// Whether undo may cover the command; whether it does depends on the groups of the state that it changes. Neither a whole
/// view nor the reconciliation of maps is an edit of the user's, and time must not cost a copy of the state in every frame.
fn may_be_edit(command: &Command) -> bool {
    !matches!(command, Command::Replace(_) | Command::ReconcileMaps(_) | Command::Advance(_))
}
