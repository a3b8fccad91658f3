//! Calls from the app to the HTML shell.

use std::cell::RefCell;

use js_sys::Array;
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// The object that the shell passes in when it starts an instance.
    #[derive(Clone)]
    pub type Shell;

    /// The back end that the instance has to draw with: `webgpu` or `webgl2`.
    #[wasm_bindgen(method, getter)]
    pub fn renderer(this: &Shell) -> String;

    /// Shows the file dialog, for `any` files or for `motion` files.
    #[wasm_bindgen(method)]
    pub fn choose(this: &Shell, role: &str);

    /// Shows the gallery of samples.
    #[wasm_bindgen(method)]
    pub fn gallery(this: &Shell);

    /// Dims the page around the canvas while a modal dialog is open in it.
    #[wasm_bindgen(method, js_name = setModal)]
    pub fn set_modal(this: &Shell, is_open: bool);

    /// Downloads a file.
    #[wasm_bindgen(method)]
    pub fn save(this: &Shell, name: &str, bytes: &[u8]);

    /// Whether there is a gallery of samples, and a page to open the view in.
    #[wasm_bindgen(method, getter, js_name = hasGallery)]
    pub fn has_gallery(this: &Shell) -> bool;

    /// Saves a self-contained page that shows a scene, once the user has chosen how. The files are pairs of name and content.
    /// `has_ktx2`: images of the model have to be transcoded.
    #[wasm_bindgen(method, js_name = savePage)]
    pub fn save_page(this: &Shell, title: &str, link: &str, model: Array, motion: Array, has_ktx2: bool);

    /// Records a video, GIF or images from the frames that [`super::calls::video_frame`] returns, and downloads it. Resolves to its
    /// file name, or to nothing if it was cancelled.
    #[wasm_bindgen(method, catch)]
    pub async fn record(
        this: &Shell,
        name: &str,
        width: u32,
        height: u32,
        frames_per_sec: u32,
        frame_count: u32,
        transparent: bool,
        format: &str,
    ) -> Result<JsValue, JsValue>;

    /// Ends the recording without saving it.
    #[wasm_bindgen(method, js_name = cancelRecording)]
    pub fn cancel_recording(this: &Shell);

    /// Validates the glTF of a model, which [`super::calls::gltf_file`] returns. Resolves to the report as JSON.
    #[wasm_bindgen(method, catch)]
    pub async fn validate(this: &Shell, model: f64) -> Result<JsValue, JsValue>;

    /// Reports the progress of a download before anything is on screen; a total of 0 is unknown.
    #[wasm_bindgen(method)]
    pub fn progress(this: &Shell, name: &str, received_bytes: f64, total_bytes: f64);

    /// Reports a change of state, with the new part after `#`.
    #[wasm_bindgen(method)]
    pub fn changed(this: &Shell, link: &str);

    /// Shows the share dialog for a link, given the part after `#`.
    #[wasm_bindgen(method)]
    pub fn share(this: &Shell, link: &str);

    /// Opens a URL, or the page with another part after `#`, in another tab.
    #[wasm_bindgen(method)]
    pub fn visit(this: &Shell, address: &str);

    /// Whether the browser has a full screen.
    #[wasm_bindgen(method, js_name = hasFullscreen)]
    pub fn has_fullscreen(this: &Shell) -> bool;

    /// Enters or leaves full screen.
    #[wasm_bindgen(method, js_name = toggleFullscreen)]
    pub fn toggle_fullscreen(this: &Shell);

    /// Returns the theme that the user chose on an earlier visit: `light`, `dark` or nothing for the system's.
    #[wasm_bindgen(method)]
    pub fn theme(this: &Shell) -> String;

    /// Remembers the theme that the user chooses, in the same words.
    #[wasm_bindgen(method, js_name = setTheme)]
    pub fn set_theme(this: &Shell, theme: &str);

    /// Shows a warning, or one per line; it replaces the one before. The code tells scripts what kind of failure it is.
    #[wasm_bindgen(method)]
    pub fn warn(this: &Shell, message: &str, code: Option<String>);

    /// Reports a problem of an embedded view to the page around it; returns false if the app has to show it.
    #[wasm_bindgen(method)]
    pub fn report(this: &Shell, problem: &str) -> bool;

    /// Shows the panels' accessibility tree; see [`crate::app::mirror`].
    #[wasm_bindgen(method)]
    pub fn mirror(this: &Shell, tree: &str);

    /// Reports that the instance has stopped: nothing more can be drawn or called.
    #[wasm_bindgen(method)]
    pub fn stopped(this: &Shell, message: &str);
}

thread_local! {
    static SHELL: RefCell<Option<Shell>> = const { RefCell::new(None) };
}

/// Makes the shell available to hooks, which receive nothing but a text.
pub(super) fn set_shell(shell: Shell) {
    SHELL.with_borrow_mut(|slot| *slot = Some(shell));
}

fn shell() -> Option<Shell> {
    SHELL.with_borrow(Clone::clone)
}

pub(super) fn stopped(message: &str) {
    if let Some(shell) = shell() {
        shell.stopped(message);
    }
}

pub(super) fn mirror(tree: &str) {
    if let Some(shell) = shell() {
        shell.mirror(tree);
    }
}
