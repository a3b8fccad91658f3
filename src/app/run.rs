//! One frame: reads the inbox, lays out the panels, applies the user's input, advances time, and draws what changed.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use gaitway_render::texture_formats;
use gaitway_scene::editor::{Admit, Contents, Editor, OpenedModel};
use gaitway_scene::library::{Library, ModelId, Motion};
use gaitway_scene::state::{Command, Embed, PageOptions, ViewerState, to_link};

use super::recording::Recording;
use super::timing::Timing;
use super::viewport::Viewport;
use super::{Host, Inbox, Message, Reply, ScriptCall, device};
use crate::files::Role;
use crate::ui::{self, Output, Shown, UiAction, UiState};

/// The app that eframe runs, in a window or a page: owns the editor, the viewport and the panels.
pub struct App {
    pub(super) editor: Editor,
    pub(super) viewport: Viewport,
    pub(super) panels: UiState,
    output: Output,
    pub(super) inbox: Inbox,
    pub(super) context: egui::Context,
    pub(super) host: Box<dyn Host>,
    /// Time is stopped until the first image is on screen: on slow devices, further frames would queue up behind it.
    has_begun: bool,
    /// The panels have been laid out once.
    is_laid_out: bool,
    /// Replies to send once the viewport shows what was requested.
    after_draw: Vec<Box<dyn FnOnce()>>,
    pub(super) screenshots: Vec<Reply<Vec<u8>>>,
    pub(super) recording: Option<Recording>,
    /// Undo steps when the toast appeared, or after what `announcement` tells.
    pub(super) notice_steps: usize,
    /// Tells those who don't see it what was done, undone or redone. `None` after a later notice or edit.
    pub(super) announcement: Option<String>,
    /// A notice or an error was added since the host last heard of a change.
    pub(super) has_new_message: bool,
    /// The last value passed to [`Host::modal_changed`].
    had_modal: bool,
    /// Motions loaded in the last frame.
    last_motions: Vec<ModelId>,
    timing: Timing,
    backend: &'static str,
    closing: Arc<AtomicBool>,
}

impl App {
    /// Starts without a model: call [`Self::open`] next. `inbox_ready` receives the queue through which everything else arrives.
    ///
    /// # Errors
    /// If there is no wgpu device.
    pub fn new(
        cc: &eframe::CreationContext<'_>,
        host: Box<dyn Host>,
        inbox_ready: impl FnOnce(Inbox),
    ) -> Result<Self, String> {
        let gpu = cc.wgpu_render_state.clone().ok_or("there is no graphics device")?;
        let closing = Arc::new(AtomicBool::new(false));
        device::watch(&gpu.device, &closing);
        let longest_edge = gpu.device.limits().max_texture_dimension_2d;
        host.image_limits().set(longest_edge, texture_formats(gpu.device.features()));
        let info = gpu.adapter.get_info();
        ui::install(&cc.egui_ctx);
        let inbox = Inbox::new(cc.egui_ctx.clone());
        let mut panels = UiState::default();
        panels.host.has_gallery = host.has_gallery();
        panels.host.has_fullscreen = host.has_fullscreen();
        panels.host.can_save_page = host.can_save_page();
        panels.host.has_validator = host.has_validator();
        cc.egui_ctx.set_theme(host.theme());
        let app = Self {
            editor: Editor::default(),
            viewport: Viewport::new(gpu),
            panels,
            output: Output::default(),
            inbox: inbox.clone(),
            context: cc.egui_ctx.clone(),
            host,
            has_begun: cfg!(not(target_arch = "wasm32")),
            is_laid_out: cfg!(not(target_arch = "wasm32")),
            after_draw: Vec::new(),
            screenshots: Vec::new(),
            recording: None,
            notice_steps: 0,
            announcement: None,
            has_new_message: false,
            had_modal: false,
            last_motions: Vec::new(),
            timing: Timing::default(),
            backend: device::backend_name(&info),
            closing,
        };
        inbox_ready(inbox);
        Ok(app)
    }

    /// Returns the editor, read-only. Changes go through the inbox.
    pub fn editor(&self) -> &Editor {
        &self.editor
    }

    /// Returns the view state.
    pub fn state(&self) -> &ViewerState {
        self.editor.state()
    }

    /// Returns the loaded models and motions.
    pub fn library(&self) -> &Library {
        self.editor.library()
    }

    /// The error that the user sees, with the name of the file in its title.
    pub fn problem(&self) -> Option<String> {
        self.panels.messages.problem()
    }

    /// What was done last if nothing says so visibly, or the notice that the user sees: the one that goes away if there are two.
    pub fn notice(&self) -> Option<&str> {
        let messages = &self.panels.messages;
        let toast = messages.toast.as_ref().map(|toast| &*toast.text);
        self.announcement.as_deref().or(toast).or(messages.about_view.as_deref())
    }

    /// Opens `contents`, in `view` if given.
    ///
    /// # Errors
    /// If the model doesn't fit on the device.
    pub fn open(&mut self, contents: Contents, view: Option<ViewerState>) -> Result<(), String> {
        self.opening(|editor, admit| editor.open(contents, view, admit))
    }

    /// Opens a link. If a part of it couldn't be opened, returns all that is wrong with it, for the shell to show at once.
    ///
    /// # Errors
    /// If the model doesn't fit on the device.
    pub fn open_link(&mut self, mut contents: Contents, view: ViewerState) -> Result<Vec<String>, String> {
        let mut problems = std::mem::take(&mut contents.problems);
        self.open(contents, Some(view))?;
        if !problems.is_empty() {
            let messages = &mut self.panels.messages;
            let toast = messages.toast.take().map(|toast| toast.text);
            for text in [messages.error.take(), messages.about_view.take(), toast].into_iter().flatten() {
                problems.extend(text.lines().map(str::to_owned));
            }
        }
        Ok(problems)
    }

    /// Completes a model that was opened before its images had arrived.
    ///
    /// # Errors
    /// If it doesn't fit on the device with them.
    pub fn complete(&mut self, id: ModelId, opened: OpenedModel) -> Result<(), String> {
        self.panels.forget_images();
        self.context.request_repaint();
        self.editor.complete(id, opened, &mut |model| self.viewport.admit(model))
    }

    fn opening(&mut self, open: impl FnOnce(&mut Editor, Admit<'_>) -> Result<(), String>) -> Result<(), String> {
        self.panels.messages.clear_error();
        self.panels.messages.about_view = None;
        self.editor.prefer_reduced_motion(self.host.prefers_reduced_motion());
        let opened = open(&mut self.editor, &mut |model| self.viewport.admit(model));
        self.show_events();
        opened
    }

    fn handle(&mut self, message: Message) {
        match message {
            Message::OpenProgress(progress) => self.panels.messages.progress = Some(progress),
            Message::Opened { contents, state, is_change, reply } => {
                let progress = self.panels.messages.progress.take();
                let opened = match state {
                    Some(view) if is_change => {
                        let problems = contents.problems.clone();
                        let opened = self.opening(|editor, admit| editor.open_change(*contents, *view, admit));
                        opened.map(|()| problems)
                    }
                    Some(view) => self.open_link(*contents, *view),
                    None => self.open(*contents, None).map(|()| Vec::new()),
                };
                if let Err(error) = &opened {
                    self.panels.messages.fail_to_open(error, progress);
                }
                match (opened, reply) {
                    (Ok(problems), Some(reply)) => self.after_draw.push(Box::new(move || reply(Ok(problems)))),
                    (Err(error), Some(reply)) => reply(Err(error)),
                    (_, None) => {}
                }
            }
            Message::OpenFailed(error) => {
                let progress = self.panels.messages.progress.take();
                self.panels.messages.clear_error();
                self.panels.messages.fail_to_open(&error, progress);
            }
            Message::OpenFailedSilently => self.panels.messages.progress = None,
            Message::Failed(error) => self.replace_error(error),
            Message::Notice(notice) => self.toast(notice),
            Message::Save(file) => self.host.save_file(file, &self.inbox),
            Message::Saved(Ok((name, remark))) => self.toast(ui::text::saved(&name, remark.as_deref())),
            Message::Saved(Err(error)) => self.add_error(&error),
            Message::Recorded(saved_name) => self.end_recording(saved_name),
            Message::Validated(model, report) => self.end_validation(model, report),
            Message::Script(call) => self.script(call),
        }
    }

    fn script(&mut self, call: ScriptCall) {
        match call {
            ScriptCall::Apply(partial, reply) => match self.editor.apply_partial(&partial) {
                Ok(()) => {
                    self.panels.messages.about_view = None;
                    self.show_events();
                    self.after_draw.push(Box::new(move || reply(Ok(()))));
                }
                Err(error) => reply(Err(error)),
            },
            ScriptCall::Screenshot(reply) => self.screenshots.push(reply),
        }
    }

    /// Uploads an image of the next model; see [`Self::forget_images`].
    #[cfg(target_arch = "wasm32")]
    pub fn upload_image(&mut self, image: &web_sys::ImageBitmap, srgb: bool) {
        self.viewport.scene.upload_image(image, srgb);
    }

    /// Frees the images of a model that doesn't come after all.
    #[cfg(target_arch = "wasm32")]
    pub fn forget_images(&mut self) {
        self.viewport.scene.forget_images();
    }

    /// Starts time: the first image is on screen.
    #[cfg(target_arch = "wasm32")]
    pub fn begin(&mut self) {
        self.has_begun = true;
        self.context.request_repaint();
    }

    /// Resolves when the device has finished all drawing submitted so far.
    #[cfg(target_arch = "wasm32")]
    pub fn drawn(&self) -> impl Future<Output = ()> + use<> {
        let (device, queue, _) = self.viewport.scene.last_image();
        async move { gaitway_render::finished(&device, &queue).await }
    }

    /// Returns frame times in milliseconds, the graphics backend, and counts for the last frame drawn, as an object.
    pub fn stats(&self) -> serde_json::Value {
        let drawn = self.viewport.scene.stats();
        let characters = &self.viewport.frame.characters;
        let joints: usize = characters.iter().map(|character| character.world_from_joint.len()).sum();
        serde_json::json!({
            "backend": self.backend,
            "frame_ms": 1000.0 * self.timing.frame_secs,
            "cpu_ms": 1000.0 * self.timing.cpu_secs,
            "frames": self.timing.frames,
            "draw_calls": drawn.draw_calls,
            "triangles": drawn.triangles,
            "joints": joints,
            "characters": characters.len(),
        })
    }

    /// Applies a command, such as one of the user's.
    pub fn apply(&mut self, command: Command) {
        self.editor.apply(command);
        self.show_events();
    }

    fn act(&mut self, action: UiAction) {
        let admit = &mut |model: &_| self.viewport.admit(model);
        let result = match action {
            UiAction::ShowModel(id) => self.editor.activate(id, admit),
            UiAction::CloseModel(id) => self.editor.close(id, admit),
            UiAction::BorrowFrom(id) => self.editor.borrow_from(id, admit),
            UiAction::ShowMotionAlone(motion) => self.editor.open_motion_alone(&motion, admit),
            UiAction::ShowRefusedAlone => self.editor.open_refused_alone(admit),
            UiAction::MapRefusedManually => {
                self.editor.map_refused_manually();
                Ok(())
            }
            UiAction::ReadOtherwise => {
                self.editor.read_otherwise();
                Ok(())
            }
            UiAction::RemoveMotion(motion) => {
                self.editor.remove_motion(&motion);
                Ok(())
            }
            UiAction::Undo => {
                self.editor.undo();
                Ok(())
            }
            UiAction::Redo => {
                self.editor.redo();
                Ok(())
            }
            UiAction::CancelOpening => {
                self.panels.messages.progress = None;
                return self.host.cancel_opening();
            }
            UiAction::OpenFiles => return self.host.choose_files(Role::Any, &self.inbox),
            UiAction::ShowGallery => return self.host.show_gallery(),
            UiAction::ChooseMotion => return self.host.choose_files(Role::Motion, &self.inbox),
            UiAction::Save(what) => return self.save(what),
            UiAction::SavePage => return self.save_page(),
            UiAction::Record(settings) => return self.start_recording(settings),
            UiAction::CancelRecording => return self.host.cancel_recording(),
            UiAction::Validate => return self.start_validation(),
            UiAction::ShareLink => return self.share(),
            UiAction::OpenPage => return self.open_page(),
            UiAction::OpenUrl(url) => return self.host.open_url(url),
            UiAction::ToggleFullscreen => return self.host.toggle_fullscreen(),
            UiAction::SetTheme(theme) => {
                self.context.set_theme(theme);
                return self.host.set_theme(theme);
            }
        };
        self.show_events();
        if let Err(error) = result {
            self.add_error(&error);
        }
    }

    fn share(&mut self) {
        let link = to_link(&self.editor.shared_state(), self.editor.library());
        if !self.host.share(&link) {
            self.context.copy_text(self.host.link(&link));
            self.toast("Link copied.".to_owned());
        }
    }

    /// Resets the panels' state about motions when the loaded motions change.
    fn update_motions(&mut self) {
        let motions = || self.editor.library().motions().iter().map(Motion::stage_id);
        if !motions().eq(self.last_motions.iter().copied()) {
            self.last_motions = motions().collect();
            self.panels.on_motions_changed();
        }
    }

    /// Reports what was drawn, and makes the thumbnails of a model once the Info tab shows it.
    fn update_drawn(&mut self) {
        let drawn = self.viewport.scene.stats();
        self.timing.begin_frame(self.editor.library().active().map(|model| model.id));
        let host = &mut self.panels.host;
        host.drawn = ui::Drawn { draw_calls: drawn.draw_calls, triangles: drawn.triangles, frames: self.timing.recent };
        let Some(model) = self.panels.info_model.take() else { return };
        host.drawn_bytes = self.viewport.scene.device_bytes();
        if host.thumbnails_of != Some(model) {
            host.thumbnails = self.viewport.scene.thumbnails(model, &host.thumbnails);
            host.thumbnails_of = Some(model);
            self.context.request_repaint();
        }
    }

    /// Opens the view without the page that embeds it.
    fn open_page(&self) {
        let state = self.editor.shared_state();
        let page = PageOptions { embed: Embed::Off, ..state.page.clone() };
        self.host.open_page(&to_link(&ViewerState { page, ..state }, self.editor.library()));
    }

    fn shown(&self) -> Shown<'_> {
        Shown { library: self.editor.library(), state: self.editor.state(), frame: &self.viewport.frame }
    }

    /// Advances time while something moves, and requests the next frame; otherwise does neither.
    fn advance(&mut self, context: &egui::Context) {
        /// Pauses (a hidden page, a long load) are skipped, not caught up.
        const MAX_STEP_SECS: f32 = 0.25;
        let state = self.editor.state();
        let has_motion = self.shown().is_animated() || state.character.playhead.fade.is_some();
        let is_moving = (state.playback.playing && has_motion) || state.is_turning();
        if !self.has_begun || !is_moving || self.panels.holds_time || self.recording.is_some() {
            return;
        }
        let (secs, unsmoothed_secs) = context.input(|input| (input.stable_dt, input.unstable_dt));
        self.apply(Command::Advance(f64::from(secs.min(MAX_STEP_SECS))));
        self.timing.record(unsmoothed_secs);
        context.request_repaint();
    }

    fn draw(&mut self, rect: egui::Rect, pixels_per_point: f32) {
        let max = self.viewport.scene.max_size() as f32;
        // Rounded as egui rounds the rectangle it paints into, so that pixels match one to one.
        let pixels = |from: f32, to: f32| {
            ((to * pixels_per_point).round() - (from * pixels_per_point).round()).clamp(1.0, max) as u32
        };
        let size = [pixels(rect.left(), rect.right()), pixels(rect.top(), rect.bottom())];
        let now_secs = self.context.input(|input| input.time);
        let refine_in = self.viewport.draw(&mut self.editor, size, now_secs);
        if let Some(secs) = refine_in.filter(|_| self.has_begun) {
            self.context.request_repaint_after(Duration::from_secs_f64(secs));
        }
        if !self.screenshots.is_empty() {
            self.viewport.refine();
        }
    }

    /// Lays out the panels and the viewport, and applies the user's input. Returns whether there was any, the viewport's
    /// rectangle, and where to paint the scene.
    fn lay_out(&mut self, ui: &mut egui::Ui, output: &mut Output) -> (bool, egui::Rect, ui::ViewportSlot) {
        if self.timing.frames == 1 {
            self.panels.start(self.context.content_rect().width());
        }
        let shown = Shown { library: self.editor.library(), state: self.editor.state(), frame: &self.viewport.frame };
        let rect = ui::panels(ui, shown, &mut self.panels, output);
        let slot = ui::viewport(ui, rect, shown, &mut self.panels, output);
        ui::overlays(ui, rect, shown, &mut self.panels, output);
        let has_input = !output.commands.is_empty() || !output.actions.is_empty();
        self.editor.set_aspect(self.panels.viewport.aspect);
        ui::begin_gestures(ui, &mut self.editor);
        output.commands.drain(..).for_each(|command| self.apply(command));
        output.actions.drain(..).for_each(|action| self.act(action));
        ui::end_gestures(ui, &mut self.editor);
        (has_input, rect, slot)
    }
}

impl Drop for App {
    fn drop(&mut self) {
        self.closing.store(true, Ordering::Relaxed);
    }
}

impl eframe::App for App {
    fn logic(&mut self, _context: &egui::Context, _frame: &mut eframe::Frame) {
        self.host.before_frame(&self.inbox);
        while let Some(message) = self.inbox.take() {
            self.handle(message);
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        // The page starts without a model, and a panel keeps the width that its first contents gave it.
        if !self.has_begun && self.editor.library().active().is_none() {
            return;
        }
        self.timing.frames += 1;
        self.timing.cpu_secs = frame.info().cpu_usage.unwrap_or(0.0);
        let context = ui.ctx().clone();
        let dropped = context.input(|input| input.raw.dropped_files.clone());
        if !dropped.is_empty() {
            self.host.open_dropped(dropped, &self.inbox);
        }
        self.panels.host.can_undo = self.editor.can_undo();
        self.panels.host.can_redo = self.editor.can_redo();
        self.panels.host.can_undo_retargeting = self.editor.can_undo_retargeting();
        self.panels.host.can_redo_retargeting = self.editor.can_redo_retargeting();
        self.panels.host.has_gltf = self.editor.has_gltf();
        self.expire_notices();
        self.update_motions();
        self.update_drawn();
        self.viewport.keep_up(&mut self.editor);
        let mut output = std::mem::take(&mut self.output);
        let (has_input, rect, slot) = self.lay_out(ui, &mut output);
        self.output = output;
        let has_modal = self.panels.has_modal();
        if std::mem::replace(&mut self.had_modal, has_modal) != has_modal {
            self.host.modal_changed(has_modal);
        }
        self.advance(&context);
        if !std::mem::replace(&mut self.is_laid_out, true) {
            // The panels come first, the scene a frame later: both in one frame would block the page for too long.
            context.request_repaint();
        } else if rect.is_positive() {
            // While recording, the renderer's textures have the video's size: the screen keeps its image unless a script waits.
            if self.recording.is_none() || !self.after_draw.is_empty() || !self.screenshots.is_empty() {
                self.draw(rect, context.pixels_per_point());
            }
            slot.fill(|rect| self.viewport.scene.paint(rect));
            let shown =
                Shown { library: self.editor.library(), state: self.editor.state(), frame: &self.viewport.frame };
            ui::labels(ui, rect, shown, &mut self.panels);
        }
        self.after_draw.drain(..).for_each(|reply| reply());
        self.answer_screenshots();
        if has_input {
            // The panels were laid out before the commands were applied.
            context.request_repaint();
        }
        // The page announces new messages to screen readers.
        if self.editor.take_changed() | std::mem::take(&mut self.has_new_message) {
            self.host.state_changed(&self.editor.shared_state(), self.editor.library());
        }
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }

    #[cfg(target_arch = "wasm32")]
    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }
}
