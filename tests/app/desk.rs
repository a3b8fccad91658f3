//! The app in a test harness on any available adapter, with files opened as if dropped.

use std::cell::RefCell;
use std::path::PathBuf;
use std::rc::Rc;

use eframe::App as _;
use eframe::egui_wgpu::{RenderState, RendererOptions};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gaitway::app::{App, Host, Inbox, Message, ScriptCall, Video, native_options};
use gaitway::files::{Role, read_paths};
use gaitway::ui::text;
use gaitway_scene::editor::ExportedFile;
use gaitway_scene::library::{Library, ModelId};
use gaitway_scene::state::{Command, ViewerState};

use crate::adapter::or_skipped;
use crate::data_folder::data_folder;

pub struct Desk {
    /// The first frame creates the app from these contents.
    harness: Harness<'static, Option<App>>,
    inbox: Inbox,
    /// The video whose recording was started last.
    pub video: Rc<RefCell<Option<Video>>>,
    /// The models whose validation was started.
    pub validated: Rc<RefCell<Vec<ModelId>>>,
}

/// Returns `None` if there is no adapter.
pub fn desk(first: &str) -> Option<Desk> {
    let gpu = or_skipped(gpu())?;
    let mut contents = Some(read_paths(&[first.into()], Role::Model).expect("is there"));
    let inbox = Rc::new(RefCell::new(None));
    let ready = inbox.clone();
    let video = Rc::new(RefCell::new(None));
    let window_video = video.clone();
    let validated = Rc::new(RefCell::new(Vec::new()));
    let window_validated = validated.clone();
    let mut frame = eframe::Frame::_new_kittest();
    let show = move |ui: &mut egui::Ui, app: &mut Option<App>| {
        let app = app.get_or_insert_with(|| {
            let mut cc = eframe::CreationContext::_new_kittest(ui.ctx().clone());
            cc.wgpu_render_state = Some(gpu.clone());
            let (contents, ready) = (contents.take().expect("begins once"), ready.clone());
            let window = Window { video: window_video.clone(), validated: window_validated.clone() };
            let ready = move |inbox| *ready.borrow_mut() = Some(inbox);
            let mut app = App::new(&cc, Box::new(window), ready).expect("starts");
            app.open(contents, None).expect("fits");
            app
        });
        // The harness adds a margin around its contents; the window has none.
        let whole = ui.ctx().content_rect();
        let mut ui = ui.new_child(egui::UiBuilder::new().max_rect(whole));
        ui.set_clip_rect(whole);
        let context = ui.ctx().clone();
        app.logic(&context, &mut frame);
        app.ui(&mut ui, &mut frame);
    };
    let harness = Harness::builder().with_size([1280.0, 720.0]).build_ui_state(show, None);
    let inbox = inbox.take().expect("given at the start");
    let mut desk = Desk { harness, inbox, video, validated };
    desk.command(Command::TogglePlaying);
    assert!(!desk.state().playback.playing);
    // A window of this size starts without it.
    desk.press(text::SHOW_INSPECTOR);
    Some(desk)
}

/// Returns the path of a real file; prints a notice and returns `None` if the data is missing.
pub fn real(name: &str) -> Option<PathBuf> {
    Some(data_folder()?.join(name))
}

impl Desk {
    /// Opens files or samples as one set.
    pub fn open(&mut self, files: &[PathBuf]) {
        self.inbox.send(match read_paths(files, Role::Any) {
            Ok(contents) => {
                Message::Opened { contents: Box::new(contents), state: None, is_change: false, reply: None }
            }
            Err(error) => Message::OpenFailed(error.to_string()),
        });
        self.run_frames();
    }

    pub fn command(&mut self, command: Command) {
        self.harness.state_mut().as_mut().expect("has begun").apply(command);
        self.run_frames();
    }

    pub fn send(&mut self, message: Message) {
        self.inbox.send(message);
        self.run_frames();
    }

    /// Returns the pixels of a frame of the video that is being recorded.
    pub fn video_frame(&mut self, index: u32) -> Result<Vec<u8>, String> {
        let pixels = self.harness.state_mut().as_mut().expect("has begun").video_frame(index)?;
        self.run_frames();
        pollster::block_on(pixels)
    }

    /// Presses a control that may have to be scrolled to.
    pub fn scroll_and_press(&mut self, label: &str) {
        self.harness.get_by_label(label).scroll_to_me();
        self.run_frames();
        self.press(label);
    }

    /// Presses the control with this label.
    pub fn press(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        self.run_frames();
    }

    /// Moves the pointer to a place in the window and leaves it there.
    pub fn point_at(&mut self, at: egui::Pos2) {
        self.harness.input_mut().events.push(egui::Event::PointerMoved(at));
        self.run_frames();
    }

    pub fn undo(&mut self) {
        self.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
        self.run_frames();
    }

    pub fn redo(&mut self) {
        self.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Y);
        self.run_frames();
    }

    /// Runs for most of a second, after which nothing may request another frame.
    pub fn settle(&mut self) {
        self.harness.run_steps(45);
        let root = &self.harness.output().viewport_output[&egui::ViewportId::ROOT];
        assert!(root.repaint_delay.as_secs() > 1, "{:?}", root.repaint_delay);
    }

    /// Returns a screenshot taken by a script, as PNG.
    pub fn screenshot(&mut self) -> Vec<u8> {
        let png = Rc::new(RefCell::new(None));
        let taken = png.clone();
        let reply = Box::new(move |picture| *taken.borrow_mut() = Some(picture));
        self.send(Message::Script(ScriptCall::Screenshot(reply)));
        png.take().expect("answered").expect("the device works")
    }

    /// Runs a few frames: the panels are laid out before input takes effect.
    fn run_frames(&mut self) {
        self.harness.run_steps(4);
    }

    fn app(&self) -> &App {
        self.harness.state().as_ref().expect("has begun")
    }

    pub fn state(&self) -> &ViewerState {
        self.app().state()
    }

    pub fn library(&self) -> &Library {
        self.app().library()
    }

    pub fn problem(&self) -> Option<String> {
        self.app().problem()
    }

    /// What screen readers are told.
    pub fn notice(&self) -> Option<&str> {
        self.app().notice()
    }

    /// The source of the active model.
    pub fn active(&self) -> &str {
        &self.library().active().expect("a model").source
    }

    /// The sources of all listed models.
    pub fn models(&self) -> Vec<&str> {
        self.library().models().iter().map(|model| &*model.source).collect()
    }

    pub fn retargeted_clips(&self) -> usize {
        self.library().active().expect("a model").clips().borrowed().count()
    }

    /// Whether a text is visible.
    pub fn shows(&self, text: &str) -> bool {
        self.harness.query_all_by_label_contains(text).next().is_some()
    }
}

fn gpu() -> Result<RenderState, impl std::fmt::Display> {
    let options = native_options().wgpu_options;
    let instance = pollster::block_on(options.wgpu_setup.new_instance());
    pollster::block_on(RenderState::create(&options, &instance, None, RendererOptions::default()))
}

struct Window {
    video: Rc<RefCell<Option<Video>>>,
    validated: Rc<RefCell<Vec<ModelId>>>,
}

impl Host for Window {
    fn choose_files(&self, _role: Role, _inbox: &Inbox) {}

    fn save_file(&self, file: ExportedFile, inbox: &Inbox) {
        inbox.send(Message::Saved(Ok((file.name, file.remark))));
    }

    fn open_url(&self, _url: &str) {}

    fn toggle_fullscreen(&self) {}

    fn record(&self, video: Video, _inbox: &Inbox) -> Result<(), String> {
        *self.video.borrow_mut() = Some(video);
        Ok(())
    }

    fn has_validator(&self) -> bool {
        true
    }

    fn validate(&self, model: ModelId, _inbox: &Inbox) {
        self.validated.borrow_mut().push(model);
    }

    fn open_dropped(&self, _files: Vec<egui::DroppedFileHandle>, _inbox: &Inbox) {}

    fn link(&self, fragment: &str) -> String {
        format!("#{fragment}")
    }

    fn state_changed(&self, _state: &ViewerState, _library: &Library) {}
}
