//! What the panels ask for: changes of the view state, and everything that the app has to do.

use gaitway_scene::editor::Export;
use gaitway_scene::library::{ModelId, MotionId};
use gaitway_scene::state::Command;

/// The requests of one pass.
#[derive(Debug, Default, PartialEq)]
pub struct Output {
    /// Changes of the view state, in order.
    pub commands: Vec<Command>,
    /// Handled in order, after the commands.
    pub actions: Vec<UiAction>,
}

/// A request that is not a change of the view state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum UiAction {
    /// Abandon the load under way.
    CancelOpening,
    /// Choose files to open.
    OpenFiles,
    /// Show the gallery of samples.
    ShowGallery,
    /// Choose files to borrow motion from, or a joint map.
    ChooseMotion,
    /// Borrow the clips of another open model.
    BorrowFrom(ModelId),
    /// Save a file.
    Save(Saved),
    /// Activate another of the open models.
    ShowModel(ModelId),
    /// Close a model; if it is the active one, its neighbour takes its place.
    CloseModel(ModelId),
    /// Remove a motion, and all others from the same archive.
    RemoveMotion(MotionId),
    /// Show the skeleton of a motion by itself instead of the model.
    ShowMotionAlone(MotionId),
    /// Show the skeleton of the motions that were refused.
    ShowRefusedAlone,
    /// Borrow from the motions that were refused, with an empty joint map.
    MapRefusedManually,
    /// Take the files that were just opened as the notice about them offers.
    ReadOtherwise,
    /// Save a self-contained page that shows the scene.
    SavePage,
    /// Record one loop of the clip.
    Record(VideoSettings),
    /// Discard the recording.
    CancelRecording,
    /// Validate the model's file.
    Validate,
    /// Share a link to this view.
    ShareLink,
    /// Open this view in a page of its own, from a page that embeds it.
    OpenPage,
    /// Open a web page.
    OpenUrl(&'static str),
    /// Enter or leave full screen.
    ToggleFullscreen,
    /// Use light or dark panels, or those of the system's theme.
    SetTheme(egui::ThemePreference),
    /// Undo the last step.
    Undo,
    /// Redo the last undone step.
    Redo,
}

/// A file that can be saved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Saved {
    /// A model, clip or joint map that the editor exports.
    File(Export),
    /// The current view, rendered at a size in pixels.
    Picture {
        /// Width and height. Each is clamped to the device's maximum texture size.
        size: [u32; 2],
        /// Leaves out the background of the view.
        transparent: bool,
    },
}

/// Settings of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VideoSettings {
    /// Width and height in pixels. The app reduces both to even numbers that the device can draw.
    pub size: [u32; 2],
    /// Frame rate.
    pub frames_per_sec: u32,
    /// Leaves out the background of the view.
    pub transparent: bool,
    /// What the frames become.
    pub format: RecordingFormat,
}

/// What the frames of a recording become.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RecordingFormat {
    /// MP4 or WebM.
    Video,
    /// An animated GIF.
    Gif,
    /// An archive of PNGs.
    Images,
}

impl RecordingFormat {
    /// Its key in the calls of the page's script.
    pub fn key(self) -> &'static str {
        match self {
            Self::Video => "video",
            Self::Gif => "gif",
            Self::Images => "images",
        }
    }
}
