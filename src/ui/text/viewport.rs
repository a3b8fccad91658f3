//! The viewport, the layout around it, help and messages.

use gaitway_scene::editor::Reading;

use super::megabytes;

// Viewport and layout
/// Accessible name of the 3D view.
pub const VIEWPORT: &str = "Viewport";
/// Narrow screens: button that opens the clips sheet. Also the number of clips in the Info tab.
pub const CLIPS: &str = "Clips";
/// Narrow screens: button that opens the inspector sheet.
pub const INSPECTOR: &str = "Inspector";
/// Wide screens: button that closes the clips panel.
pub const HIDE_CLIPS: &str = "Hide clips";
/// Wide screens: button that opens the clips panel.
pub const SHOW_CLIPS: &str = "Show clips";
/// Wide screens: button that closes the inspector.
pub const HIDE_INSPECTOR: &str = "Hide inspector";
/// Wide screens: button that opens the inspector.
pub const SHOW_INSPECTOR: &str = "Show inspector";
/// The edge of the clips panel that changes its width.
pub const RESIZE_CLIPS: &str = "Width of the clips panel";
/// The edge of the inspector that changes its width.
pub const RESIZE_INSPECTOR: &str = "Width of the inspector";
/// Close button of a sheet.
pub const CLOSE_SHEET: &str = "Close panel";
/// What [`FRAME_ALL_KEY`] does, in the help.
pub const FRAME_ALL: &str = "Fit everything in view";
/// Button that fits everything into the viewport, with its key.
pub const FRAME_ALL_KEY: &str = "Fit everything in view (F)";

// Help
/// Title of the help.
pub const HELP_TITLE: &str = "Keys and gestures";
/// Close button of the help.
pub const CLOSE_HELP: &str = "Close help";
/// What dragging a ring of the rotation gizmo does, in the help.
pub const HELP_RING: &str = "Rotate the selected joint, with “Pose manually” on in the Scene tab";
/// Keys that step by a frame, spelled out for the help.
pub const STEP_KEYS: &str = "Comma, period";
/// What [`STEP_KEYS`] do, in the help.
pub const STEP_FRAMES: &str = "Previous frame, next frame";

/// What undo and redo cover, in the help.
pub const UNDO_HELP: &str = "Undo, redo: edits, display settings and opening, but not playback or the camera";

/// The gesture that zooms, in the help.
pub const PINCH: &str = "Pinch";

// Messages
/// Title of the error for refused motions.
pub const REFUSED_TITLE: &str = "Couldn't borrow the motion";
/// Close button of an error.
pub const DISMISS_ERROR: &str = "Dismiss error";
/// Close button of a notice that stays.
pub const DISMISS_NOTICE: &str = "Dismiss notice";
/// Button on a refused motion: shows its skeleton instead of the model.
pub const SHOW_REFUSED_ALONE: &str = "Show its skeleton";
/// Button on a refused motion: borrows from it with an empty joint map.
pub const MAP_REFUSED_MANUALLY: &str = "Map joints manually";
/// Button on a toast that reports an undoable step.
pub const UNDO: &str = "Undo";
/// Button that closes a list, or ends a load or a recording.
pub const CANCEL: &str = "Cancel";

/// Returns the text of the button on a toast about files that may have been meant otherwise.
pub fn other_reading(other: Reading) -> &'static str {
    match other {
        Reading::Models => "Open as models",
        Reading::Both => "Keep both",
    }
}

/// Returns the label of the progress bar while a file loads.
pub fn opening(name: &str) -> String {
    format!("Opening {name}")
}

/// Returns how much of a file has been read; a total of 0 is unknown.
pub fn amount_read(received_bytes: u64, total_bytes: u64) -> String {
    match total_bytes {
        0 => megabytes(received_bytes),
        total => format!("{:.1} of {}", received_bytes as f64 / 1e6, megabytes(total)),
    }
}

/// What to do about a model whose images the user did not wait for.
pub const WITHOUT_IMAGES: &str = "The model is shown without its images. Reload the page to load them.";

/// Returns the title of the error for a file that failed to open.
pub fn couldnt_open(name: &str) -> String {
    format!("Couldn't open {name}")
}

/// Returns what stands on the stage in place of a model that the user has yet to supply.
pub fn waiting_for(name: &str) -> String {
    format!("Waiting for {name}")
}

/// Returns what stands on the stage in place of a model that couldn't be loaded.
pub fn couldnt_load(name: &str) -> String {
    format!("Couldn't load {name}")
}
