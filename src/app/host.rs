//! What the frame loop leaves to the platform: file dialogs, links, recording, and change notifications.

use super::Inbox;
use crate::files::Role;
use crate::state::ViewerState;

/// A video to record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Video {
    /// File name without its extension, which depends on what the host can encode.
    pub name: String,
    /// Width and height in pixels, both even.
    pub size: [u32; 2],
    /// Frame rate.
    pub frames_per_sec: u32,
    /// Number of frames.
    pub frame_count: u32,
    /// Keeps the frames' alpha.
    pub transparent: bool,
}

/// Implemented by the page and by the window. All calls come from the loop's thread; results arrive through the inbox.
pub trait Host {
    /// Lets the user choose files; returns false if the platform has no file dialog.
    fn choose_files(&self, role: Role, inbox: &Inbox) -> bool;

    /// Opens a path the user typed, on platforms without [`Host::choose_files`].
    fn open_path(&self, path: &str, role: Role, inbox: &Inbox) {
        let _ = (path, role, inbox);
    }

    /// Whether there is a gallery of samples.
    fn has_gallery(&self) -> bool {
        false
    }

    /// Opens the gallery of samples. Called only if [`Host::has_gallery`] returns true.
    fn show_gallery(&self) {}

    /// Saves a file for the user; returns false if that takes a path, which is then passed to [`Host::save_path`].
    fn save_file(&self, name: &str, bytes: &[u8]) -> bool;

    /// Writes a file to the path the user typed.
    ///
    /// # Errors
    /// The message for the user if it cannot be written.
    fn save_path(&self, path: &str, bytes: &[u8]) -> Result<(), String> {
        let _ = (path, bytes);
        Ok(())
    }

    /// Starts recording a video: asks for one frame after the other with [`App::video_frame`](super::App::video_frame), saves the
    /// file, and sends [`Message::Recorded`](super::Message::Recorded) at the end, whatever it is.
    ///
    /// # Errors
    /// The message for the user if that is unsupported.
    fn record(&self, video: Video, inbox: &Inbox) -> Result<(), String> {
        let _ = (video, inbox);
        Err("Couldn't record a video: only the page can. Open this link there, or save images instead.".to_owned())
    }

    /// Ends the recording without saving it.
    fn cancel_recording(&self) {}

    /// Opens files dropped on the window, as one set.
    fn open_dropped(&self, files: Vec<egui::DroppedFileHandle>, inbox: &Inbox);

    /// Shows the share dialog for a link, given the part after `#`; returns false if the link can only be copied.
    fn share(&self, fragment: &str) -> bool {
        let _ = fragment;
        false
    }

    /// Returns the full link to share, given the part after `#`.
    fn link(&self, fragment: &str) -> String;

    /// Called when the state has changed other than by time passing, with [`Editor::shared_state`](crate::editor::Editor).
    fn state_changed(&self, state: &ViewerState);

    /// Whether the user prefers reduced motion: views start paused and don't turn.
    fn prefers_reduced_motion(&self) -> bool {
        false
    }

    /// Called at the start of every frame, before the inbox is read.
    fn before_frame(&self, inbox: &Inbox) {
        let _ = inbox;
    }
}
