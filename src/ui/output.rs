//! What the panels ask for: changes of the view state, and everything that the app has to do.

use crate::editor::Export;
use crate::library::ModelId;
use crate::state::Command;

/// The requests of one pass.
#[derive(Debug, Default, PartialEq)]
pub struct Output {
    pub commands: Vec<Command>,
    pub actions: Vec<UiAction>,
}

/// A request that is not a change of the view state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum UiAction {
    /// Choose files to open.
    OpenFiles,
    /// Show the gallery of samples.
    ShowGallery,
    /// Choose files to borrow motion from, or a joint map.
    ChooseMotion,
    /// Use the path that was typed into a prompt.
    UsePath(PathPurpose, String),
    Save(Saved),
    /// Activate another of the open models.
    ShowModel(ModelId),
    /// Close a model; if it is the active one, its neighbour takes its place.
    CloseModel(ModelId),
    RemoveMotion(usize),
    /// Show the skeleton of a motion by itself instead of the model.
    ShowMotionAlone(usize),
    /// Show the skeleton of the motions that were refused.
    ShowRefusedAlone,
    /// Borrow from the motions that were refused, with an empty joint map.
    MapRefusedManually,
    /// Record one loop of the clip.
    Record,
    /// Discard the recording.
    StopRecording,
    /// Share a link to this view.
    ShareLink,
    Undo,
    Redo,
}

/// What a typed path is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathPurpose {
    Open,
    OpenMotion,
    Save(Saved),
}

/// A file that can be saved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Saved {
    File(Export),
    /// The current view, rendered at a size in pixels.
    Picture {
        size: [u32; 2],
        transparent: bool,
    },
}
