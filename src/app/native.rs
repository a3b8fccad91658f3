//! The native window. Opens files from the command line, typed paths and dropped files; reads them in the background.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};

use super::{App, Host, Inbox, Loads, Message, Opening, native_options};
use crate::editor::Contents;
use crate::files::{OpenError, Role, read_paths};
use crate::samples;
use crate::state::ViewerState;

/// Why the window could not be opened, or stopped.
#[derive(Debug, thiserror::Error)]
pub enum WindowError {
    /// The files could not be read.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// No window or graphics device, the first model could not be shown, or the event loop failed.
    #[error("the window could not be opened: {0}")]
    Window(#[from] eframe::Error),
}

/// Opens the window and returns when it is closed. The files are opened as one set; without any, the first sample is.
///
/// # Errors
/// If the files cannot be read, or no window or graphics device is available.
pub fn run_native(files: Vec<PathBuf>) -> Result<(), WindowError> {
    let files = if files.is_empty() { vec![samples::FIRST.into()] } else { files };
    let contents = read_paths(&files, Role::Model)?;
    let create: eframe::AppCreator<'_> = Box::new(move |cc| {
        let mut app = App::new(cc, Box::new(Window::new(cc.egui_ctx.clone())), |_| {})?;
        app.open(contents, None)?;
        Ok(Box::new(app))
    });
    Ok(eframe::run_native("Gaitway", native_options(), create)?)
}

/// A load's number, with what was read or why nothing could be.
type Loaded = (u32, Result<Box<Contents>, String>);

struct Window {
    context: egui::Context,
    /// Number of loads started. Only the latest is shown, whichever ends last.
    loads: Loads,
    loaded: Receiver<Loaded>,
    sender: Sender<Loaded>,
}

impl Window {
    fn new(context: egui::Context) -> Self {
        let (sender, loaded) = channel();
        Self { context, loads: Loads::default(), loaded, sender }
    }

    /// Reads files in the background; the result arrives in a later frame, unless something else is opened in the meantime.
    fn open(&self, paths: Vec<PathBuf>, role: Role, inbox: &Inbox) {
        let number = self.loads.start();
        let name = paths.first().and_then(|path| path.file_name()).map(|name| name.to_string_lossy().into_owned());
        let opening = Opening { name: name.unwrap_or_default(), received_bytes: 0, total_bytes: 0 };
        inbox.send(Message::OpenProgress(opening));
        let (sender, context) = (self.sender.clone(), self.context.clone());
        std::thread::spawn(move || {
            let opened = read_paths(&paths, role).map(Box::new).map_err(|error| error.to_string());
            // Fails only if the window was closed in the meantime.
            let _ = sender.send((number, opened));
            context.request_repaint();
        });
    }
}

impl Host for Window {
    fn choose_files(&self, _role: Role, _inbox: &Inbox) -> bool {
        false
    }

    fn open_path(&self, path: &str, role: Role, inbox: &Inbox) {
        self.open(vec![PathBuf::from(path)], role, inbox);
    }

    fn save_file(&self, _name: &str, _bytes: &[u8]) -> bool {
        false
    }

    fn save_path(&self, path: &str, bytes: &[u8]) -> Result<(), String> {
        std::fs::write(path, bytes).map_err(|error| format!("{path}: {error}"))
    }

    fn open_dropped(&self, files: Vec<egui::DroppedFileHandle>, inbox: &Inbox) {
        self.open(files.iter().map(|file| file.path().to_owned()).collect(), Role::Any, inbox);
    }

    fn link(&self, fragment: &str) -> String {
        format!("#{fragment}")
    }

    fn state_changed(&self, state: &ViewerState) {
        let title = match state.sources.model.first() {
            Some(model) => format!("{model} – Gaitway"),
            None => "Gaitway".to_owned(),
        };
        self.context.send_viewport_cmd(egui::ViewportCommand::Title(title));
    }

    fn before_frame(&self, inbox: &Inbox) {
        while let Ok((number, loaded)) = self.loaded.try_recv() {
            if !self.loads.is_latest(number) {
                continue;
            }
            inbox.send(match loaded {
                Ok(contents) => Message::Opened { contents, state: None, reply: None },
                Err(error) => Message::OpenFailed(error),
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_latest_load_is_shown() {
        let context = egui::Context::default();
        let (window, inbox) = (Window::new(context.clone()), Inbox::new(context));
        let [old, new] = [window.loads.start(), window.loads.start()];
        for (number, name) in [(new, "new"), (old, "old")] {
            window.sender.send((number, Err(name.to_owned()))).expect("the window is open");
        }
        window.before_frame(&inbox);
        assert!(matches!(inbox.take(), Some(Message::OpenFailed(name)) if name == "new"));
        assert!(inbox.take().is_none());
    }
}
