//! What the frame loop leaves to the platform: file dialogs, links, recording, and change notifications.

use gaitway_scene::editor::{ExportedFile, Scene};
use gaitway_scene::library::{Library, ModelId};
use gaitway_scene::state::ViewerState;

use super::Inbox;
use crate::files::{ImageLimits, Role};
use crate::ui::RecordingFormat;

/// One loop of a clip to record.
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
    /// What the frames become.
    pub format: RecordingFormat,
}

/// Implemented by the page and by the window. All calls come from the loop's thread; results arrive through the inbox.
pub trait Host {
    /// What the host opens files with; the app sets it once there is a device.
    fn image_limits(&self) -> ImageLimits {
        ImageLimits::default()
    }

    /// Lets the user choose files, which are then opened.
    fn choose_files(&self, role: Role, inbox: &Inbox);

    /// Abandons the load under way: nothing of it is shown.
    fn cancel_opening(&self) {}

    /// Whether there is a gallery of samples.
    fn has_gallery(&self) -> bool {
        false
    }

    /// Opens the gallery of samples. Called only if [`Host::has_gallery`] returns true.
    fn show_gallery(&self) {}

    /// Called when a modal dialog opens or closes.
    fn modal_changed(&self, is_open: bool) {
        let _ = is_open;
    }

    /// Saves a file for the user. Sends [`Message::Saved`](super::Message::Saved), unless the user changes their mind.
    fn save_file(&self, file: ExportedFile, inbox: &Inbox);

    /// Whether the host can save self-contained pages that show a scene.
    fn can_save_page(&self) -> bool {
        false
    }

    /// Saves a self-contained page that shows a scene, once the user has chosen how. `has_ktx2`: images of the model have to be
    /// transcoded. Called only if [`Host::can_save_page`] returns true.
    fn save_page(&self, scene: Scene, has_ktx2: bool) {
        let _ = (scene, has_ktx2);
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

    /// Reports a problem of an embedded view to the page around it. Returns false if the app has to show it.
    fn report(&self, problem: &str) -> bool {
        let _ = problem;
        false
    }

    /// Ends the recording without saving it.
    fn cancel_recording(&self) {}

    /// Whether the host can run the Khronos glTF validator.
    fn has_validator(&self) -> bool {
        false
    }

    /// Validates the glTF of a model, whose files [`Editor::gltf_file`](gaitway_scene::editor::Editor::gltf_file) returns. Sends
    /// [`Message::Validated`](super::Message::Validated). Called only if [`Host::has_validator`] returns true.
    fn validate(&self, model: ModelId, inbox: &Inbox) {
        let _ = (model, inbox);
    }

    /// Opens files dropped on the window, as one set.
    fn open_dropped(&self, files: Vec<egui::DroppedFileHandle>, inbox: &Inbox);

    /// Shows the share dialog for a link, given the part after `#`; returns false if the link can only be copied.
    fn share(&self, fragment: &str) -> bool {
        let _ = fragment;
        false
    }

    /// Opens a link, given the part after `#`, in a page of its own. Called only by views that are embedded in another page.
    fn open_page(&self, fragment: &str) {
        let _ = fragment;
    }

    /// Opens a web page.
    fn open_url(&self, url: &str);

    /// Whether there is a full screen to enter.
    fn has_fullscreen(&self) -> bool {
        true
    }

    /// Enters or leaves full screen.
    fn toggle_fullscreen(&self);

    /// Returns the theme of the panels that the user chose earlier.
    fn theme(&self) -> egui::ThemePreference {
        egui::ThemePreference::System
    }

    /// Remembers the theme of the panels that the user chooses.
    fn set_theme(&self, theme: egui::ThemePreference) {
        let _ = theme;
    }

    /// Returns the full link to share, given the part after `#`.
    fn link(&self, fragment: &str) -> String;

    /// Called when the state has changed other than by time passing, or when there is a new message for the user, with
    /// [`Editor::shared_state`](gaitway_scene::editor::Editor). The library has the clips that the state refers to.
    fn state_changed(&self, state: &ViewerState, library: &Library);

    /// Whether the user prefers reduced motion: views start paused and don't turn.
    fn prefers_reduced_motion(&self) -> bool {
        false
    }

    /// Called at the start of every frame, before the inbox is read.
    fn before_frame(&self, inbox: &Inbox) {
        let _ = inbox;
    }
}
