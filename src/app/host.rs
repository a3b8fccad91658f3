//! What the frame loop leaves to the platform: file dialogs, links, recording, and change notifications.

use super::Inbox;
use crate::files::Role;
use crate::state::ViewerState;

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

    /// Starts recording the canvas.
    ///
    /// # Errors
    /// The message for the user if that is unsupported.
    fn start_recording(&self) -> Result<(), String> {
        Err("Couldn't record a video: only the page can. Open this link there, or save images instead.".to_owned())
    }

    /// Stops the recording and saves it under this name; without a name, discards it.
    fn stop_recording(&self, name: Option<&str>) {
        let _ = name;
    }

    /// Opens files dropped on the window, as one set.
    fn open_dropped(&self, files: Vec<egui::DroppedFileHandle>, inbox: &Inbox);

    /// Shows the share dialog for a link, given the part after `#`; returns false if the link can only be copied.
    fn share(&self, fragment: &str) -> bool {
        let _ = fragment;
        false
    }

    /// Returns the full link to share, given the part after `#`.
    fn link(&self, fragment: &str) -> String;

    /// Called when the state has changed other than by time passing.
    fn state_changed(&self, state: &ViewerState);

    /// Called at the start of every frame, before the inbox is read.
    fn before_frame(&self, inbox: &Inbox) {
        let _ = inbox;
    }
}
