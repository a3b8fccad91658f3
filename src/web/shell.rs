//! What the app tells the HTML shell.

use std::cell::RefCell;

use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// The object that the shell hands over when it starts an instance.
    #[derive(Clone)]
    pub type Shell;

    /// Shows the dialog in which files are chosen: `any`, or `motion` for files to borrow from.
    #[wasm_bindgen(method)]
    pub fn choose(this: &Shell, role: &str);

    /// Shows the gallery of samples.
    #[wasm_bindgen(method)]
    pub fn gallery(this: &Shell);

    /// Gives the person a file, as a download.
    #[wasm_bindgen(method)]
    pub fn save(this: &Shell, name: &str, bytes: &[u8]);

    /// Begins to record the canvas; false where the browser cannot.
    #[wasm_bindgen(method, js_name = startRecording)]
    pub fn start_recording(this: &Shell) -> bool;

    /// Ends the recording and gives the person the video under this name; without one it is thrown away.
    #[wasm_bindgen(method, js_name = stopRecording)]
    pub fn stop_recording(this: &Shell, name: Option<&str>);

    /// Bytes of a file that have arrived before there is anything to see; a total of 0 is not known.
    #[wasm_bindgen(method)]
    pub fn progress(this: &Shell, name: &str, received_bytes: f64, total_bytes: f64);

    /// Something was set; the text is the new part after `#`.
    #[wasm_bindgen(method)]
    pub fn changed(this: &Shell, link: &str);

    /// Shows what there is to pass on: the text is the part after `#`.
    #[wasm_bindgen(method)]
    pub fn share(this: &Shell, link: &str);

    /// Something a person should know, though nothing is lost.
    #[wasm_bindgen(method)]
    pub fn warn(this: &Shell, message: &str);

    /// Nothing more can be drawn or called.
    #[wasm_bindgen(method)]
    pub fn stopped(this: &Shell, message: &str);
}

thread_local! {
    static SHELL: RefCell<Option<Shell>> = const { RefCell::new(None) };
}

/// The hooks for panics and lost devices know nothing but their message: this is where they find the shell.
pub(super) fn keep(shell: Shell) {
    SHELL.with_borrow_mut(|slot| *slot = Some(shell));
}

pub(super) fn stopped(message: &str) {
    // A panic may come while the slot is borrowed; there is nothing better to do then than to be silent.
    let shell = SHELL.with(|slot| slot.try_borrow().ok().and_then(|slot| slot.clone()));
    if let Some(shell) = shell {
        shell.stopped(message);
    }
}
