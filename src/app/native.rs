//! The native window. Opens files from the command line, from the system's dialog and dropped ones; reads them in the background.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};

use gaitway_scene::editor::{Contents, ExportedFile};
use gaitway_scene::library::Library;
use gaitway_scene::samples;
use gaitway_scene::state::ViewerState;

use super::{App, Host, Inbox, Loads, Message, native_options};
use crate::files::{Disk, ImageLimits, OpenError, Role, save_file};
use crate::ui::Progress;

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
    let disk = Disk::default();
    let contents = disk.read_paths(&files, Role::Model)?;
    let files_read = disk.files_read();
    let create: eframe::AppCreator<'_> = Box::new(move |cc| {
        let window = Window::new(cc.egui_ctx.clone(), files_read);
        let mut app = App::new(cc, Box::new(window), |_| {})?;
        app.open(contents, None)?;
        Ok(Box::new(app))
    });
    Ok(eframe::run_native("Gaitway", native_options(), create)?)
}

/// The result of a load.
struct Loaded {
    number: u32,
    /// What was read, or why nothing could be.
    contents: Result<Box<Contents>, String>,
    files_read: Vec<PathBuf>,
}

/// What came of a file dialog.
enum Answer {
    Open(Vec<PathBuf>, Role),
    /// The path and a remark, or why the file couldn't be written.
    Saved(Result<(String, Option<String>), String>),
}

struct Window {
    context: egui::Context,
    /// Number of loads started. Only the latest is shown, whichever ends last.
    loads: Loads,
    loaded: Receiver<Loaded>,
    sender: Sender<Loaded>,
    answered: Receiver<Answer>,
    answer_sender: Sender<Answer>,
    /// Every file read so far, none of which is overwritten.
    files_read: RefCell<Vec<PathBuf>>,
    images: ImageLimits,
}

impl Window {
    fn new(context: egui::Context, files_read: Vec<PathBuf>) -> Self {
        let (sender, loaded) = channel();
        let (answer_sender, answered) = channel();
        let (loads, images, files_read) = (Loads::default(), ImageLimits::default(), RefCell::new(files_read));
        Self { context, loads, loaded, sender, answered, answer_sender, files_read, images }
    }

    /// Reads files in the background; the result arrives in a later frame, unless something else is opened in the meantime.
    fn open(&self, paths: Vec<PathBuf>, role: Role, inbox: &Inbox) {
        let number = self.loads.start();
        let name = paths.first().and_then(|path| path.file_name()).map(|name| name.to_string_lossy().into_owned());
        inbox.send(Message::OpenProgress(Progress { name: name.unwrap_or_default(), ..Progress::default() }));
        let (sender, context) = (self.sender.clone(), self.context.clone());
        let disk = Disk::for_device(self.images.clone());
        std::thread::spawn(move || {
            let contents = disk.read_paths(&paths, role).map(Box::new).map_err(|error| error.to_string());
            // Fails only if the window was closed in the meantime.
            let _ = sender.send(Loaded { number, contents, files_read: disk.files_read() });
            context.request_repaint();
        });
    }

    /// Waits for a file dialog in the background; nothing happens if it is cancelled. The dialog itself has to be created on the
    /// main thread, as macOS wants it.
    fn when_answered(&self, answer: impl Future<Output = Option<Answer>> + Send + 'static) {
        let (sender, context) = (self.answer_sender.clone(), self.context.clone());
        std::thread::spawn(move || {
            if let Some(answer) = pollster::block_on(answer) {
                // Fails only if the window was closed in the meantime.
                let _ = sender.send(answer);
                context.request_repaint();
            }
        });
    }
}

impl Host for Window {
    fn image_limits(&self) -> ImageLimits {
        self.images.clone()
    }

    fn choose_files(&self, role: Role, _inbox: &Inbox) {
        let title = if role == Role::Motion { "Borrow motion" } else { "Open" };
        let files = rfd::AsyncFileDialog::new().set_title(title).pick_files();
        self.when_answered(async move {
            let paths = files.await?.iter().map(|file| file.path().to_owned()).collect();
            Some(Answer::Open(paths, role))
        });
    }

    fn cancel_opening(&self) {
        // Its result arrives too late.
        self.loads.start();
    }

    fn save_file(&self, file: ExportedFile, _inbox: &Inbox) {
        let path = rfd::AsyncFileDialog::new().set_title("Save").set_file_name(&file.name).save_file();
        let inputs = self.files_read.borrow().clone();
        self.when_answered(async move { Some(Answer::Saved(written(file, path.await?.path(), &inputs))) });
    }

    fn open_url(&self, url: &str) {
        let opener = match std::env::consts::OS {
            "windows" => "explorer",
            "macos" => "open",
            _ => "xdg-open",
        };
        // Without one, the link stays where it is.
        let _ = std::process::Command::new(opener).arg(url).spawn();
    }

    fn toggle_fullscreen(&self) {
        let is_full = self.context.input(|input| input.viewport().fullscreen.unwrap_or_default());
        self.context.send_viewport_cmd(egui::ViewportCommand::Fullscreen(!is_full));
    }

    fn open_dropped(&self, files: Vec<egui::DroppedFileHandle>, inbox: &Inbox) {
        self.open(files.iter().map(|file| file.path().to_owned()).collect(), Role::Any, inbox);
    }

    fn link(&self, fragment: &str) -> String {
        format!("#{fragment}")
    }

    fn state_changed(&self, state: &ViewerState, _: &Library) {
        let title = match state.character.sources.model.first() {
            Some(model) => format!("{model} – Gaitway"),
            None => "Gaitway".to_owned(),
        };
        self.context.send_viewport_cmd(egui::ViewportCommand::Title(title));
    }

    fn before_frame(&self, inbox: &Inbox) {
        while let Ok(answer) = self.answered.try_recv() {
            match answer {
                Answer::Open(paths, role) => self.open(paths, role, inbox),
                Answer::Saved(saved) => inbox.send(Message::Saved(saved)),
            }
        }
        while let Ok(Loaded { number, contents, files_read }) = self.loaded.try_recv() {
            self.files_read.borrow_mut().extend(files_read);
            if !self.loads.is_latest(number) {
                continue;
            }
            inbox.send(match contents {
                Ok(contents) => {
                    let contents = Box::new(Contents { is_by_hand: true, ..*contents });
                    Message::Opened { contents, state: None, is_change: false, reply: None }
                }
                Err(error) => Message::OpenFailed(error),
            });
        }
    }
}

/// Writes a file to the path that the user chose, unless it was read from there. Returns what to tell the user.
fn written(file: ExportedFile, path: &Path, inputs: &[PathBuf]) -> Result<(String, Option<String>), String> {
    save_file(path, &file.bytes, inputs).map_err(|error| error.to_string())?;
    Ok((path.display().to_string(), file.remark))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_latest_load_is_shown() {
        let context = egui::Context::default();
        let (window, inbox) = (Window::new(context.clone(), Vec::new()), Inbox::new(context));
        let [old, new] = [window.loads.start(), window.loads.start()];
        for (number, name) in [(new, "new"), (old, "old")] {
            let loaded = Loaded { number, contents: Err(name.to_owned()), files_read: Vec::new() };
            window.sender.send(loaded).expect("the window is open");
        }
        window.before_frame(&inbox);
        assert!(matches!(inbox.take(), Some(Message::OpenFailed(name)) if name == "new"));
        assert!(inbox.take().is_none());
        let cancelled = Loaded { number: new, contents: Err("cancelled".to_owned()), files_read: Vec::new() };
        window.sender.send(cancelled).expect("the window is open");
        window.cancel_opening();
        window.before_frame(&inbox);
        assert!(inbox.take().is_none());
    }

    #[test]
    fn a_file_that_was_opened_is_not_saved_over() {
        let path = std::env::temp_dir().join(format!("gaitway-opened-{}.bvh", std::process::id()));
        std::fs::write(&path, "HIERARCHY").expect("a file");
        let text = path.to_str().expect("a plain path");
        let picture = ExportedFile { name: "a.png".to_owned(), bytes: b"a picture".to_vec(), remark: None };
        let error = written(picture, &path, std::slice::from_ref(&path)).expect_err("it would be lost");
        assert!(error.starts_with(text), "{error}");
        assert_eq!(std::fs::read(&path).expect("still there"), b"HIERARCHY");
        std::fs::remove_file(&path).expect("it was created");
    }
}
