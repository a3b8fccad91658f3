//! What the frame loop leaves to the platform: choosing files, links, and news for whoever embeds the page.

use super::Inbox;
use crate::files::Role;
use crate::state::ViewerState;

/// Implemented once for the page and once for the window. All calls come from the loop's thread; answers arrive
/// through the inbox.
pub trait Host {
    /// Lets the person choose files; false when there is no way to on this platform.
    fn choose_files(&self, role: Role, inbox: &Inbox) -> bool;

    /// Opens a path that was typed, on platforms where [`Host::choose_files`] cannot help.
    fn open_path(&self, path: &str, role: Role, inbox: &Inbox) {
        let _ = (path, role, inbox);
    }

    /// Whether there is a gallery of samples.
    fn has_gallery(&self) -> bool {
        false
    }

    fn show_gallery(&self) {}

    /// Gives a file to the person; false when that needs a path, which [`Host::save_path`] then gets.
    fn save_file(&self, name: &str, bytes: &[u8]) -> bool;

    /// Writes a file where the person said.
    ///
    /// # Errors
    /// What the person sees when it cannot be written.
    fn save_path(&self, path: &str, bytes: &[u8]) -> Result<(), String> {
        let _ = (path, bytes);
        Ok(())
    }

    /// Begins to record what is on the canvas.
    ///
    /// # Errors
    /// What the person sees where that is not possible.
    fn start_recording(&self) -> Result<(), String> {
        Err("videos are recorded in the browser; open this view there, or save pictures".to_owned())
    }

    /// Ends the recording and gives the person the file; without a name it is thrown away.
    fn stop_recording(&self, name: Option<&str>) {
        let _ = name;
    }

    /// Opens files that were dropped on the canvas or the window, as one set.
    fn open_dropped(&self, files: Vec<egui::DroppedFileHandle>, inbox: &Inbox);

    /// Shows the link, from the part after `#`, with all that can be done with it; false where it can only be copied.
    fn share(&self, fragment: &str) -> bool {
        let _ = fragment;
        false
    }

    /// A link that a person can pass on, from the part after `#`.
    fn link(&self, fragment: &str) -> String;

    /// Something was set, other than the playhead moving on by itself.
    fn state_changed(&self, state: &ViewerState);

    /// Called at the start of every frame, before the inbox is read.
    fn before_frame(&self, inbox: &Inbox) {
        let _ = inbox;
    }
}
