//! One turn of the loop: read the inbox, show the panels, apply what was pressed, advance time, draw what changed.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::borrow::Refused;
use super::open::Shelved;
use super::record::Recording;
use super::scene_texture::SceneTexture;
use super::{Host, Inbox, Message, Opening, Reply, ScriptCall, device};
use crate::files::{Contents, Role, encode_png, set_largest_image};
use crate::frame::{Frame, evaluate, pose_document, travelled};
use crate::library::{Library, ModelId, Motion, inspect};
use crate::render::read_pixels;
use crate::state::{
    CameraChoice, Command, History, OrbitCamera, ViewerState, frame_all, from_object, resolve_camera, source_on_stage,
    split_ratio, to_link, to_object,
};
use crate::ui::{self, Output, PathPrompt, PathPurpose, Progress, Shown, UiAction, UiState};

pub struct App {
    pub(super) library: Library,
    pub(super) state: ViewerState,
    pub(super) history: History,
    frame: Frame,
    pub(super) panels: UiState,
    output: Output,
    pub(super) scene: SceneTexture,
    /// Size in pixels and aspect of the last picture; none: nothing drawn yet.
    drawn_size: Option<[u32; 2]>,
    /// Something the picture depends on has changed since it was drawn.
    pub(super) dirty: bool,
    /// Something was set since the host was last told.
    pub(super) changed: bool,
    pub(super) refused: Option<Refused>,
    /// What is kept of each model of the library besides.
    pub(super) shelf: BTreeMap<ModelId, Shelved>,
    /// A joint map of a person's own was opened.
    pub(super) has_own_map: bool,
    /// How many steps led back when the toast was shown.
    pub(super) toasted_steps: usize,
    /// The motions of the last frame.
    motions_before: Vec<ModelId>,
    /// What does not work about the borrowed clips and has been told.
    pub(super) borrow_errors: Vec<String>,
    inbox: Inbox,
    pub(super) context: egui::Context,
    pub(super) host: Box<dyn Host>,
    /// Time stands still until the first picture is seen: where that takes long, the next ones would wait in a queue.
    begun: bool,
    /// The panels have been laid out once.
    laid_out: bool,
    /// Answered once the picture shows what they asked for.
    after_draw: Vec<Box<dyn FnOnce()>>,
    screenshots: Vec<Reply<Vec<u8>>>,
    backend: &'static str,
    closing: Arc<AtomicBool>,
    /// Running mean of the time between frames that follow one another, seconds.
    frame_secs: f32,
    cpu_secs: f32,
    /// Times the panels were shown: stands still while nothing changes.
    frames: u64,
    pub(super) recording: Option<Recording>,
    /// What was brought to the device: the model, and the source beside it.
    staged: Option<(ModelId, Option<ModelId>)>,
}

impl App {
    /// Shows `contents`, which has a model, at first: in `state`, if there is one. `inbox_ready` gets the queue through which everything else arrives.
    ///
    /// # Errors
    /// When there is no wgpu device, or the model does not fit on it.
    pub fn new(
        cc: &eframe::CreationContext<'_>,
        host: Box<dyn Host>,
        contents: Contents,
        state: Option<ViewerState>,
        inbox_ready: impl FnOnce(Inbox),
    ) -> Result<Self, String> {
        let gpu = cc.wgpu_render_state.clone().ok_or("there is no graphics device")?;
        let closing = Arc::new(AtomicBool::new(false));
        device::watch(&gpu.device, &closing);
        set_largest_image(gpu.device.limits().max_texture_dimension_2d);
        let info = gpu.adapter.get_info();
        ui::install(&cc.egui_ctx);
        let inbox = Inbox::new(cc.egui_ctx.clone());
        let mut app = Self {
            library: Library::default(),
            state: ViewerState::default(),
            history: History::default(),
            frame: Frame::default(),
            panels: UiState::default(),
            output: Output::default(),
            scene: SceneTexture::new(gpu, device::samples(&info)),
            drawn_size: None,
            dirty: true,
            changed: false,
            refused: None,
            shelf: BTreeMap::new(),
            has_own_map: false,
            toasted_steps: 0,
            motions_before: Vec::new(),
            borrow_errors: Vec::new(),
            inbox: inbox.clone(),
            context: cc.egui_ctx.clone(),
            host,
            begun: cfg!(not(target_arch = "wasm32")),
            laid_out: cfg!(not(target_arch = "wasm32")),
            after_draw: Vec::new(),
            screenshots: Vec::new(),
            backend: device::backend_name(&info),
            closing,
            frame_secs: 0.0,
            cpu_secs: 0.0,
            frames: 0,
            recording: None,
            staged: None,
        };
        app.panels.has_gallery = app.host.has_gallery();
        app.show(contents, state)?;
        inbox_ready(inbox);
        Ok(app)
    }

    pub fn state(&self) -> &ViewerState {
        &self.state
    }

    pub fn library(&self) -> &Library {
        &self.library
    }

    /// What is wrong, as the person sees it.
    pub fn problem(&self) -> Option<&str> {
        self.panels.error.as_deref()
    }

    fn handle(&mut self, message: Message) {
        match message {
            Message::OpenProgress(opening) => self.panels.progress = Some(progress(&opening)),
            Message::Opened { contents, state, reply } => {
                self.panels.progress = None;
                let shown = self.show(*contents, state.map(|state| *state));
                if let Err(error) = &shown {
                    self.panels.error = Some(error.clone());
                }
                if let Some(reply) = reply {
                    match shown {
                        Ok(()) => {
                            let document = self.library.active().map(|model| inspect(model, &self.state.model));
                            let document = document.unwrap_or_default();
                            self.after_draw.push(Box::new(move || reply(Ok(document))));
                        }
                        Err(error) => reply(Err(error)),
                    }
                }
            }
            Message::OpenFailed(error) => {
                self.panels.progress = None;
                self.fail(error);
            }
            Message::OpenGivenUp => self.panels.progress = None,
            Message::Failed(error) => self.fail(error),
            Message::Save(name, bytes) => {
                self.host.save_file(&name, &bytes);
                self.toast(format!("Saved {name}."));
            }
            Message::Commands(commands) => commands.into_iter().for_each(|command| self.apply(command)),
            Message::Script(call) => self.script(call),
        }
    }

    fn script(&mut self, call: ScriptCall) {
        match call {
            ScriptCall::State(reply) => reply(Ok(to_object(&self.state))),
            ScriptCall::Apply(partial, reply) => {
                let (state, errors) = from_object(&self.state, &partial);
                if errors.is_empty() && !self.has_files_of(&state) {
                    reply(Err("something else was opened meanwhile".to_owned()));
                } else if errors.is_empty() {
                    let before = self.state.clone();
                    self.history.apply(&mut self.state, &self.library, Command::Replace(Box::new(state)));
                    let problems = self.refresh_motion();
                    (self.dirty, self.changed) = (true, true);
                    if !problems.is_empty() {
                        self.state = before;
                        self.refresh_motion();
                        reply(Err(problems.join("; ")));
                        return;
                    }
                    self.after_draw.push(Box::new(move || reply(Ok(()))));
                } else {
                    let errors: Vec<String> = errors.iter().map(ToString::to_string).collect();
                    reply(Err(errors.join("; ")));
                }
            }
            ScriptCall::Pose(reply) => reply(Ok(pose_document(&self.library, &self.state))),
            ScriptCall::Screenshot(reply) => self.screenshots.push(reply),
            ScriptCall::Stats(reply) => reply(Ok(self.stats())),
        }
    }

    /// The first picture is drawn and seen.
    #[cfg(target_arch = "wasm32")]
    pub fn begin(&mut self) {
        self.begun = true;
        self.context.request_repaint();
    }

    /// Resolves when the device has drawn all that was asked of it so far.
    #[cfg(target_arch = "wasm32")]
    pub fn drawn(&self) -> impl Future<Output = ()> + use<> {
        let (device, queue, _) = self.scene.last_picture();
        async move { crate::render::finished(&device, &queue).await }
    }

    pub fn stats(&self) -> serde_json::Value {
        let drawn = self.scene.stats();
        let joints: usize = self.frame.characters.iter().map(|character| character.world_from_joint.len()).sum();
        serde_json::json!({
            "backend": self.backend,
            "frame_ms": 1000.0 * self.frame_secs,
            "cpu_ms": 1000.0 * self.cpu_secs,
            "frames": self.frames,
            "draw_calls": drawn.draw_calls,
            "triangles": drawn.triangles,
            "joints": joints,
            "characters": self.frame.characters.len(),
        })
    }

    /// Whether a view is one of the files that are shown: a view must never name others than these.
    fn has_files_of(&self, state: &ViewerState) -> bool {
        state.model == self.state.model && state.motion == self.state.motion
    }

    pub(super) fn apply(&mut self, command: Command) {
        if matches!(&command, Command::Replace(state) if !self.has_files_of(state)) {
            // Something else was opened since it was asked for.
            return;
        }
        let aspect = self.panels.aspect;
        let turns = self.state.turntable != 0.0 && matches!(self.state.camera, CameraChoice::Auto);
        // Whoever takes hold of the picture or of a joint wants it to stand still.
        let holds = matches!(command, Command::Orbit { .. } | Command::Pan { .. } | Command::SetPose { .. });
        if holds && self.state.turntable != 0.0 {
            self.history.apply(&mut self.state, &self.library, Command::SetTurntable(0.0));
        }
        let relative = matches!(command, Command::Orbit { .. } | Command::Pan { .. } | Command::Zoom { .. })
            || (turns && matches!(command, Command::Advance(_)));
        if let Some(orbit) = self.kept_camera(&command) {
            self.history.apply(&mut self.state, &self.library, Command::SetCamera(CameraChoice::Orbit(orbit)));
        }
        // The automatic camera depends on the picture's shape, which commands do not know.
        let command = if matches!(command, Command::FrameAll) && self.state.camera != CameraChoice::Auto {
            Command::SetCamera(CameraChoice::Orbit(frame_all(&self.library, &self.state, aspect)))
        } else {
            if relative && !matches!(self.state.camera, CameraChoice::Orbit(_)) {
                let orbit = resolve_camera(&self.library, &self.state, aspect);
                self.history.apply(&mut self.state, &self.library, Command::SetCamera(CameraChoice::Orbit(orbit)));
            }
            command
        };
        self.changed |= !matches!(command, Command::Advance(_));
        self.dirty = true;
        let is_about_motion = matches!(
            command,
            Command::Replace(_)
                | Command::SetMap { .. }
                | Command::SetSource { .. }
                | Command::EditMap { .. }
                | Command::SetUnmapped(_)
                | Command::SetRoot(_)
                | Command::SetFeet(_)
        );
        if let Command::SetFollow(follow) = command
            && follow != self.state.follow
        {
            let follows = if follow { "goes along with the character" } else { "stays where it is" };
            self.toast(format!("The camera {follows}."));
        }
        let refits = matches!(command, Command::SetUp(_));
        self.history.apply(&mut self.state, &self.library, command);
        if refits {
            self.apply(Command::FrameAll);
        }
        if is_about_motion {
            let problems = self.refresh_motion();
            self.tell(problems);
        }
    }

    /// The camera set by hand, so that it still shows what it shows now when the command has been applied.
    fn kept_camera(&self, command: &Command) -> Option<OrbitCamera> {
        let CameraChoice::Orbit(orbit) = self.state.camera else { return None };
        match *command {
            Command::SetShow(show) if show.split != self.state.show.split => {
                let ratio = split_ratio(&self.state, self.panels.aspect);
                Some(OrbitCamera { distance: ratio * orbit.distance, ..orbit })
            }
            Command::SetFollow(follow) if follow != self.state.follow => {
                let travel = travelled(&self.library, &self.state);
                let target = if follow { orbit.target - travel } else { orbit.target + travel };
                Some(OrbitCamera { target, ..orbit })
            }
            _ => None,
        }
    }

    fn act(&mut self, action: UiAction) {
        match action {
            UiAction::OpenFiles => self.choose(Role::Any, PathPurpose::Open),
            UiAction::ShowGallery => self.host.show_gallery(),
            UiAction::ChooseMotion => self.choose(Role::Motion, PathPurpose::OpenMotion),
            UiAction::UsePath(PathPurpose::Open, path) => self.host.open_path(&path, Role::Any, &self.inbox),
            UiAction::UsePath(PathPurpose::OpenMotion, path) => self.host.open_path(&path, Role::Motion, &self.inbox),
            UiAction::UsePath(PathPurpose::Save(what), path) => {
                let saved = self.file_to_save(what).and_then(|file| self.host.save_path(&path, &file.bytes));
                match saved {
                    Ok(()) => self.toast(format!("Saved as {path}.")),
                    Err(error) => self.tell(vec![error]),
                }
            }
            #[cfg(target_arch = "wasm32")]
            UiAction::Save(ui::Saved::Picture { size, transparent }) => {
                let (picture, name, inbox) =
                    (self.draw_for_file(size, transparent), self.picture_name(), self.inbox.clone());
                wasm_bindgen_futures::spawn_local(async move {
                    inbox.send(match picture.await {
                        Ok(bytes) => Message::Save(name, bytes),
                        Err(error) => Message::Failed(error),
                    });
                });
            }
            UiAction::Record => self.record(),
            UiAction::StopRecording => self.stop_recording(false),
            UiAction::Save(what) => match self.file_to_save(what) {
                Ok(file) if self.host.save_file(&file.name, &file.bytes) => {
                    self.toast(file.remark.unwrap_or_else(|| format!("Saved {}.", file.name)));
                }
                Ok(file) => {
                    self.panels.path_prompt = Some(PathPrompt { purpose: PathPurpose::Save(what), path: file.name });
                }
                Err(error) => self.tell(vec![error]),
            },
            UiAction::ShowModel(id) => self.turn_to(id),
            UiAction::CloseModel(id) => self.close_model(id),
            UiAction::RemoveMotion(index) => self.remove_motion(index),
            UiAction::ShowMotionAlone(index) => {
                if let Some(motion) = self.library.motions().get(index).cloned() {
                    self.show_motion_alone(&motion);
                }
            }
            UiAction::ShowRefusedAlone => self.show_refused_alone(),
            UiAction::MapRefusedByHand => self.map_refused_by_hand(),
            UiAction::ShareLink => {
                let link = to_link(&self.state);
                if !self.host.share(&link) {
                    self.context.copy_text(self.host.link(&link));
                    self.toast("Link copied.".to_owned());
                }
            }
            UiAction::Undo => self.step(true),
            UiAction::Redo => self.step(false),
        }
    }

    /// What has been begun about a motion is about none when there are others.
    fn watch_motions(&mut self) {
        let now = || self.library.motions().iter().map(Motion::id);
        if !now().eq(self.motions_before.iter().copied()) {
            self.motions_before = now().collect();
            self.panels.other_motions();
        }
    }

    fn choose(&mut self, role: Role, purpose: PathPurpose) {
        if !self.host.choose_files(role, &self.inbox) {
            self.panels.path_prompt = Some(PathPrompt { purpose, path: String::new() });
        }
    }

    /// Time goes by while playing; nothing is asked for when it does not.
    fn advance(&mut self, context: &egui::Context) {
        if !self.begun {
            return;
        }
        let shown = Shown { library: &self.library, state: &self.state, frame: &self.frame };
        let moves = shown.clip().is_some_and(|clip| clip.duration_secs() > 0.0);
        let turns = self.state.turntable != 0.0 && !matches!(self.state.camera, CameraChoice::File(_));
        if ((self.state.playing && moves) || turns) && !self.panels.holds_time {
            let (secs, unsmoothed_secs) = context.input(|input| (input.stable_dt, input.unstable_dt));
            // A pause (a hidden page, a long load) is not made up for.
            self.apply(Command::Advance(f64::from(secs.min(0.25))));
            if unsmoothed_secs < 1.0 {
                let share = if self.frame_secs == 0.0 { 1.0 } else { 0.1 };
                self.frame_secs += share * (unsmoothed_secs - self.frame_secs);
            }
            context.request_repaint();
        }
    }

    fn draw(&mut self, rect: egui::Rect, pixels_per_point: f32) {
        let largest = self.scene.largest_size() as f32;
        // As egui rounds the rectangle that the picture is painted into: it fits pixel for pixel.
        let pixels = |from: f32, to: f32| {
            ((to * pixels_per_point).round() - (from * pixels_per_point).round()).clamp(1.0, largest) as u32
        };
        let size = [pixels(rect.left(), rect.right()), pixels(rect.top(), rect.bottom())];
        if self.dirty || self.drawn_size != Some(size) {
            let source = source_on_stage(&self.library, &self.state).map(|source| source.model);
            let key = self.library.active().map(|model| (model.id, source.map(|source| source.id)));
            if let Some(model) = self.library.active().filter(|_| self.staged != key) {
                // A source too large for the device is shown by its bones alone.
                let _ = self.scene.upload(model, source);
                self.staged = key;
            }
            evaluate(&self.library, &self.state, size[0] as f32 / size[1] as f32, &mut self.frame);
            self.scene.draw(&self.frame, size);
            self.drawn_size = Some(size);
            self.dirty = false;
        }
    }

    fn answer(&mut self) {
        self.after_draw.drain(..).for_each(|reply| reply());
        for reply in self.screenshots.drain(..) {
            let (device, queue, texture) = self.scene.last_picture();
            let screenshot = async move {
                let pixels = read_pixels(&device, &queue, &texture).await;
                let png = encode_png(texture.width(), texture.height(), &pixels);
                reply(png.ok_or_else(|| "the picture could not be read back from the graphics device".to_owned()));
            };
            #[cfg(target_arch = "wasm32")]
            wasm_bindgen_futures::spawn_local(screenshot);
            #[cfg(not(target_arch = "wasm32"))]
            pollster::block_on(screenshot);
        }
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
        self.frames += 1;
        self.cpu_secs = frame.info().cpu_usage.unwrap_or(0.0);
        let context = ui.ctx().clone();
        let dropped = context.input(|input| input.raw.dropped_files.clone());
        if !dropped.is_empty() {
            self.host.open_dropped(dropped, &self.inbox);
        }
        (self.panels.can_undo, self.panels.can_redo) = (self.history.can_undo(), self.history.can_redo());
        self.watch_toast();
        self.watch_motions();
        let mut output = std::mem::take(&mut self.output);
        let shown = Shown { library: &self.library, state: &self.state, frame: &self.frame };
        let rect = ui::panels(ui, shown, &mut self.panels, &mut output);
        let slot = ui::picture(ui, rect, shown, &mut self.panels, &mut output);
        ui::overlays(ui, rect, shown, &mut self.panels, &mut output);
        let acted = !output.commands.is_empty() || !output.actions.is_empty();
        // On a slow machine one key goes up in the frame in which the next goes down.
        let is_press = |event: &egui::Event| matches!(event, egui::Event::Key { pressed: true, repeat: false, .. });
        if context.input(|input| input.events.iter().any(is_press)) {
            self.history.end_gesture();
        }
        output.commands.drain(..).for_each(|command| self.apply(command));
        output.actions.drain(..).for_each(|action| self.act(action));
        self.output = output;
        if context.input(|input| !input.pointer.any_down() && input.keys_down.is_empty()) {
            self.history.end_gesture();
        }
        self.advance(&context);
        self.go_on_recording(&context);
        if !std::mem::replace(&mut self.laid_out, true) {
            // The panels alone, then the scene: both in one frame would keep a page from answering for too long.
            context.request_repaint();
        } else if rect.is_positive() {
            self.draw(rect, context.pixels_per_point());
            slot.fill(|rect| self.scene.paint(rect));
            let shown = Shown { library: &self.library, state: &self.state, frame: &self.frame };
            ui::labels(ui, rect, shown, &mut self.panels);
        }
        self.answer();
        if acted {
            // The panels were laid out before the commands were applied.
            context.request_repaint();
        }
        if std::mem::take(&mut self.changed) {
            self.host.state_changed(&self.state);
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

fn progress(opening: &Opening) -> Progress {
    let total = opening.total_bytes;
    let fraction = (total > 0).then(|| (opening.received_bytes as f64 / total as f64).clamp(0.0, 1.0) as f32);
    Progress { name: opening.name.clone(), fraction }
}
