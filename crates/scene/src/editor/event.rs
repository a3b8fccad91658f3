//! Events that a shell presents to the user.

use crate::state::Edited;

/// Drained with [`super::Editor::take_events`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event {
    /// Something was done. If `undoable`, the next undo reverts exactly that.
    Notice {
        /// For the user, in full sentences.
        text: String,
        /// Whether the shell may offer to undo it.
        undoable: bool,
    },
    /// What can't be used of a view that was applied, in full sentences. The rest of it is shown.
    AboutView(String),
    /// Part of an operation failed, although the rest worked.
    Problem(String),
    /// A whole view, such as a link's, is active.
    ViewOpened,
    /// Another model was opened and is active.
    ModelOpened,
    /// Motions were added to the active model.
    MotionsAdded,
    /// None of the opened motions fits the model. [`super::Editor::open_refused_alone`] and, for a model with a skeleton,
    /// [`super::Editor::map_refused_manually`] are the alternatives.
    MotionsRefused {
        /// The model has no joints to map.
        lacks_skeleton: bool,
    },
    /// The files of the notice before may have been meant otherwise, which [`super::Editor::read_otherwise`] does.
    OtherReading(Reading),
    /// The user is about to edit a joint map.
    MapStarted,
    /// A step of the history was undone or redone: notices about other steps no longer apply.
    Stepped {
        /// It was undone.
        is_undo: bool,
        /// What it changed. `None`: it brought something back or removed it, which a notice says.
        edited: Option<Edited>,
    },
    /// The user chose which joint of a motion a joint of the model follows, or that it follows none.
    SourceSet {
        /// Name of the model's joint.
        target: String,
        /// Name of the motion's joint.
        source: Option<String>,
    },
}

/// What the user may have meant by files instead.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reading {
    /// The files that became clips of a character are models.
    Models,
    /// The file that took the place of its older version is another model.
    Both,
}
