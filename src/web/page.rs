//! Starting and destroying an instance on a canvas.

use std::cell::{Cell, RefCell};
use std::future::poll_fn;
use std::pin::{Pin, pin};
use std::rc::Rc;
use std::task::Poll;

use egui::ThemePreference;
use futures_util::future::{Either, select};
use gaitway_character::asset::SharedBytes;
use gaitway_scene::editor::{AboutLink, Contents, ExportedFile, Scene, short_name};
use gaitway_scene::library::{Environment, Library, Model, ModelId};
use gaitway_scene::samples;
use gaitway_scene::state::{EnvironmentChoice, Link, ViewerState, from_link, to_link};
use gaitway_session::ErrorCode;
use js_sys::{Array, Uint8Array};
use serde_json::json;
use wasm_bindgen::prelude::*;

use super::calls::{Refusal, forget_images, progress_of, rest_progress, upload_image, with_app};
use super::shell::{self, Shell};
use crate::app::mirror::Mirror;
use crate::app::{App, Host, Inbox, Loads, Message, Video, set_fatal_hook, web_options};
use crate::files::{Held, ImageLimits, Item, OpenError, Role, open_items, open_view};

/// A running instance on its canvas.
pub(super) struct Page {
    pub runner: eframe::WebRunner,
    pub frames: Frames,
    pub inbox: Inbox,
    pub context: egui::Context,
    pub shell: Shell,
    pub image_limits: ImageLimits,
    pub loads: Loads,
    /// Cancels the latest load, while there is one.
    pub cancel_load: Cancel,
    /// The model that is shown without its images, and what resolves to its complete file.
    pub rest: RefCell<Option<(ModelId, Rest)>>,
    /// Cancels that.
    pub cancel_rest: Cancel,
}

/// The first contents with their view and the problems.
pub(super) type First = (Contents, ViewerState, Vec<String>);

/// Cancels what is being loaded; `None` if nothing is.
pub(super) type Cancel = RefCell<Option<js_sys::Function>>;

pub(super) type Rest = Pin<Box<dyn Future<Output = Result<First, String>>>>;

/// Draws frames besides those of eframe's runner, which come with the browser's animation frames: what arrives between two of them
/// would wait for up to 16 ms.
pub(super) struct Frames(web_sys::EventTarget);

impl Frames {
    const EVENT: &str = "frame";

    fn new(runner: &eframe::WebRunner) -> Result<Self, JsValue> {
        let target = web_sys::EventTarget::new()?;
        // Only listeners get the runner that draws.
        runner.add_event_listener(&target, Self::EVENT, |_: web_sys::Event, runner| {
            runner.logic();
            runner.paint();
        })?;
        Ok(Self(target))
    }

    /// Draws a frame now. Does nothing once the instance has stopped.
    pub fn draw(&self) {
        if let Ok(event) = web_sys::Event::new(Self::EVENT) {
            let _ = self.0.dispatch_event(&event);
        }
    }
}

thread_local! {
    /// The shell may end an instance that is still starting.
    static IS_DESTROYED: Cell<bool> = const { Cell::new(false) };
    static PAGE: RefCell<Option<Rc<Page>>> = const { RefCell::new(None) };
}

/// Installs the hooks for panics and lost devices. Nothing is drawn before the shell calls [`run`].
pub fn start() {
    // Replaces the default hook, which prints where the browser shows nothing. eframe adds one that prints to the console.
    std::panic::set_hook(Box::new(|info| {
        let message = info.payload_as_str().unwrap_or("unknown error");
        let place = info.location().map(|place| format!(" ({place})")).unwrap_or_default();
        shell::stopped(&format!("An error inside Gaitway: {message}{place}"));
    }));
    set_fatal_hook(shell::stopped);
}

/// Opens the link's files, or `items` (see [`super::calls::open`]) in the link's view, with the motions in `motion_items` and
/// those that the link lists. `is_private` marks the items as the user's local files. Resolves once the first image has been
/// requested, to `{problems, code}`: the problems and the kind of the first one. Call [`drawn`](super::calls::drawn),
/// [`begin`](super::calls::begin) and [`complete`](super::calls::complete) next. Rejects, and leaves nothing behind, if no device is
/// available, nothing could be opened or the model doesn't fit on the device.
#[wasm_bindgen]
pub async fn run(
    canvas: web_sys::HtmlCanvasElement,
    link: String,
    items: Array,
    motion_items: Array,
    is_private: bool,
    shell: Shell,
) -> Result<String, JsValue> {
    let unsupported = |message| Refusal { code: ErrorCode::Unsupported, message };
    shell::set_shell(shell.clone());
    let first: Rc<RefCell<Option<First>>> = Rc::default();
    let image_limits = ImageLimits::default();
    let (wanted, about_link) = state_of_link(&link);
    let all = {
        let (shell, limits, early) = (shell.clone(), image_limits.clone(), first.clone());
        Box::pin(async move { first_contents(wanted, items, motion_items, is_private, &shell, &limits, &early).await })
    };
    // Request the files first: the network takes longest. Meanwhile, create the device.
    let shown = pin!(async {
        let no_graphics = |message| Refusal { code: ErrorCode::NoGraphics, message };
        start_app(canvas, &shell, image_limits).await.map_err(no_graphics)?;
        // Nothing has to wake it: it is polled after what fills the slot.
        poll_fn(|_| first.take().map_or(Poll::Pending, |first| Poll::Ready(Ok::<_, Refusal>(first)))).await
    });
    let started = async {
        let ((contents, state, missing), rest) = match select(all, shown).await {
            Either::Left((all, shown)) => {
                first.replace(Some(all.map_err(unsupported)?));
                (shown.await?, None)
            }
            Either::Right((early, rest)) => (early?, Some(rest as Rest)),
        };
        let page = page().map_err(unsupported)?;
        let failure = contents.failure;
        let name = contents.models.first().map(|opened| short_name(&opened.model.source));
        let shown = with_app(&page, |app| {
            let contents = Contents { problems: missing, about_link, ..contents };
            let problems = app.open_link(contents, state)?;
            Ok::<_, String>((app.library().active().map(|model| model.id), problems))
        });
        forget_images(&page);
        let (model, problems) = shown.flatten().map_err(unsupported)?;
        if let (Some(model), Some(rest), Some(name)) = (model, rest, name) {
            page.rest.replace(Some((model, rest)));
            page.inbox.send(Message::OpenProgress(progress_of(&name, 0, 0)));
        }
        page.inbox.wake();
        Ok::<_, Refusal>(json!({ "problems": problems, "code": failure }))
    };
    let shown = started.await.inspect_err(|_| destroy())?;
    Ok(shown.to_string())
}

async fn start_app(canvas: web_sys::HtmlCanvasElement, shell: &Shell, image_limits: ImageLimits) -> Result<(), String> {
    let runner = eframe::WebRunner::new();
    let started = Rc::new(RefCell::new(None));
    let start = started.clone();
    let host = Box::new(PageHost { shell: shell.clone(), image_limits: image_limits.clone() });
    let create: eframe::AppCreator<'static> = Box::new(move |cc| {
        let context = cc.egui_ctx.clone();
        context.add_plugin(Mirror::new(shell::mirror));
        Ok(Box::new(App::new(cc, host, |inbox| *start.borrow_mut() = Some((inbox, context)))?))
    });
    let options = web_options(&canvas, &shell.renderer()).await?;
    runner.start(canvas, options, create).await.map_err(|error| text_of(&error))?;
    if IS_DESTROYED.get() {
        runner.destroy();
        return Err("Gaitway was stopped".to_owned());
    }
    let (inbox, context) = started.borrow_mut().take().ok_or("Gaitway couldn't start")?;
    let frames = Frames::new(&runner).map_err(|error| text_of(&error))?;
    let (loads, rest) = (Loads::default(), RefCell::default());
    let [cancel_load, cancel_rest] = [Cancel::default(), Cancel::default()];
    let page = Page {
        runner,
        frames,
        inbox,
        context,
        shell: shell.clone(),
        image_limits,
        loads,
        cancel_load,
        rest,
        cancel_rest,
    };
    PAGE.with_borrow_mut(|slot| *slot = Some(Rc::new(page)));
    Ok(())
}

/// Loads the first contents: the items, otherwise the files of the link. If the model cannot be opened, falls back to the
/// skeleton of the first motion that can, then to an empty stage. `early` receives the same without images, if that helps.
async fn first_contents(
    wanted: ViewerState,
    items: Array,
    motion_items: Array,
    is_private: bool,
    shell: &Shell,
    limits: &ImageLimits,
    early: &RefCell<Option<First>>,
) -> Result<First, String> {
    let items = super::calls::items_of(items)?;
    let motion_items = super::calls::items_of(motion_items)?;
    let progress = |name: &str, received: u64, total: u64| match page() {
        // The model is shown without its images.
        Ok(page) if page.cancel_rest.borrow().is_some() => rest_progress(&page, name, received, total),
        _ => shell.progress(name, received as f64, total as f64),
    };
    let show_early = |model: Model| {
        let contents = Contents { models: vec![model.into()], motions: Some(Vec::new()), ..Contents::default() };
        early.replace(Some((contents, wanted.clone(), Vec::new())));
    };
    match open_wanted(limits, &wanted, items, motion_items, &progress, &show_early).await {
        Ok((mut contents, view)) => {
            let problems = std::mem::take(&mut contents.problems);
            Ok((if is_private { contents.into_private() } else { contents }, view, problems))
        }
        Err(error) => {
            let failure = Some(error.code());
            let (contents, view, problems) = open_fallback(limits, wanted, vec![error.to_string()], &progress).await?;
            let contents = Contents { failure, ..contents };
            // The view names the user's files although they could not be read.
            Ok((if is_private { contents.into_private() } else { contents }, view, problems))
        }
    }
}

async fn open_wanted(
    limits: &ImageLimits,
    wanted: &ViewerState,
    items: Vec<Item>,
    motion_items: Vec<Item>,
    progress: &dyn Fn(&str, u64, u64),
    show_early: &dyn Fn(Model),
) -> Result<(Contents, ViewerState), OpenError> {
    let (mut models, mut motions, mut environments, mut problem) = (Vec::new(), Vec::new(), Vec::new(), None);
    if !items.is_empty() {
        let found = open_items(limits, items, Role::Model, progress, Some(&upload_image)).await?;
        models = found.models;
        environments.extend(found.environment);
        motions.extend(found.motions.into_iter().flatten());
    }
    if !motion_items.is_empty() {
        match open_items(limits, motion_items, Role::Motion, progress, None).await {
            Ok(found) => {
                motions.extend(found.motions.into_iter().flatten());
                environments.extend(found.environment);
            }
            Err(error) => problem = Some(error.to_string()),
        }
    }
    let held = Held { motions: &motions, environments: &environments };
    let early = motions.is_empty().then_some(show_early);
    let (mut contents, view) =
        open_view(limits, wanted.clone(), models.is_empty(), held, progress, early, Some(&upload_image)).await?;
    contents.models.extend(models);
    let is_wanted = |held: &Environment| wanted.lighting.environment == EnvironmentChoice::File(held.origin.clone());
    let light = environments.iter().position(is_wanted).map(|at| environments.swap_remove(at));
    contents.environment = contents.environment.or(light);
    contents.problems.extend(problem);
    Ok((contents, view))
}

async fn open_fallback(
    limits: &ImageLimits,
    wanted: ViewerState,
    mut problems: Vec<String>,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<First, String> {
    let mut models = Vec::new();
    for motion in &wanted.character.sources.motion {
        match open_items(limits, vec![Item::Address(motion.into())], Role::Model, progress, None).await {
            Ok(found) => models.extend(found.models),
            Err(error) => problems.push(error.to_string()),
        }
    }
    models.truncate(1);
    let view = match (models.first(), wanted.character.sources.model.first()) {
        (Some(model), _) => wanted.for_model(ViewerState::of_model(model.model.source.clone())),
        (None, Some(awaited)) => {
            models.push(Model::placeholder(awaited).into());
            wanted
        }
        (None, None) => return Err(problems.join("\n")),
    };
    Ok((Contents { models, motions: Some(Vec::new()), ..Contents::default() }, view, problems))
}

/// Reads as much of a link as can be shown without the files that it waits for, and what is known of it besides.
pub(super) fn state_of_link(link: &str) -> (ViewerState, AboutLink) {
    let link = Link::from(link);
    let shown = link.without_missing();
    let (state, errors) = from_link(shown.text());
    (state.or_sample(samples::WALKER), AboutLink { errors, is_partial: shown != link })
}

pub(super) fn page() -> Result<Rc<Page>, String> {
    PAGE.with_borrow(Clone::clone).ok_or_else(|| "Gaitway has not started yet".to_owned())
}

/// Destroys this instance and releases its canvas.
#[wasm_bindgen]
pub fn destroy() {
    IS_DESTROYED.set(true);
    if let Some(page) = PAGE.with_borrow_mut(Option::take) {
        page.runner.destroy();
    }
}

pub(super) fn text_of(value: &JsValue) -> String {
    if let Some(error) = value.dyn_ref::<js_sys::Error>() {
        return error.message().into();
    }
    value.as_string().unwrap_or_else(|| String::from(js_sys::Object::from(value.clone()).to_string()))
}

struct PageHost {
    shell: Shell,
    image_limits: ImageLimits,
}

impl Host for PageHost {
    fn image_limits(&self) -> ImageLimits {
        self.image_limits.clone()
    }

    fn choose_files(&self, role: Role, _inbox: &Inbox) {
        self.shell.choose(if role == Role::Motion { "motion" } else { "any" });
    }

    fn cancel_opening(&self) {
        let Ok(page) = page() else { return };
        if let Some(cancel) = page.cancel_load.take().or_else(|| page.cancel_rest.take()) {
            let _ = cancel.call0(&JsValue::UNDEFINED);
        }
    }

    fn has_gallery(&self) -> bool {
        self.shell.has_gallery()
    }

    fn report(&self, problem: &str) -> bool {
        self.shell.report(problem)
    }

    fn show_gallery(&self) {
        self.shell.gallery();
    }

    fn modal_changed(&self, is_open: bool) {
        self.shell.set_modal(is_open);
    }

    fn save_file(&self, file: ExportedFile, inbox: &Inbox) {
        self.shell.save(&file.name, &file.bytes);
        inbox.send(Message::Saved(Ok((file.name, file.remark))));
    }

    fn can_save_page(&self) -> bool {
        true
    }

    fn save_page(&self, scene: Scene, has_ktx2: bool) {
        let pair = |(name, bytes): &(String, SharedBytes)| Array::of2(&name.into(), &Uint8Array::from(&bytes[..]));
        let [model, motion] = [&scene.model, &scene.motion].map(|files| files.iter().map(pair).collect());
        self.shell.save_page(&scene.title, &scene.link, model, motion, has_ktx2);
    }

    fn record(&self, video: Video, inbox: &Inbox) -> Result<(), String> {
        let (shell, inbox) = (self.shell.clone(), inbox.clone());
        wasm_bindgen_futures::spawn_local(async move {
            let Video { name, size: [width, height], frames_per_sec, frame_count, transparent, format } = video;
            let recorded =
                shell.record(&name, width, height, frames_per_sec, frame_count, transparent, format.key()).await;
            let recorded = recorded.map(|name| name.as_string()).map_err(|error| text_of(&error));
            inbox.send(Message::Recorded(recorded));
        });
        Ok(())
    }

    fn cancel_recording(&self) {
        self.shell.cancel_recording();
    }

    fn has_validator(&self) -> bool {
        true
    }

    fn validate(&self, model: ModelId, inbox: &Inbox) {
        let (shell, inbox) = (self.shell.clone(), inbox.clone());
        wasm_bindgen_futures::spawn_local(async move {
            let report = shell.validate(model.0 as f64).await;
            let report = report.map(|report| text_of(&report)).map_err(|error| text_of(&error));
            inbox.send(Message::Validated(model, report));
        });
    }

    /// Does nothing: the shell handles drops before the canvas does, since it keeps the files and reads folders.
    fn open_dropped(&self, _files: Vec<egui::DroppedFileHandle>, _inbox: &Inbox) {}

    fn share(&self, fragment: &str) -> bool {
        self.shell.share(fragment);
        true
    }

    fn open_page(&self, fragment: &str) {
        self.shell.visit(&format!("#{fragment}"));
    }

    fn open_url(&self, url: &str) {
        self.shell.visit(url);
    }

    fn has_fullscreen(&self) -> bool {
        self.shell.has_fullscreen()
    }

    fn toggle_fullscreen(&self) {
        self.shell.toggle_fullscreen();
    }

    fn theme(&self) -> ThemePreference {
        match &*self.shell.theme() {
            "light" => ThemePreference::Light,
            "dark" => ThemePreference::Dark,
            _ => ThemePreference::System,
        }
    }

    fn set_theme(&self, theme: ThemePreference) {
        self.shell.set_theme(match theme {
            ThemePreference::Light => "light",
            ThemePreference::Dark => "dark",
            ThemePreference::System => "",
        });
    }

    fn link(&self, fragment: &str) -> String {
        let href = web_sys::window().and_then(|window| window.location().href().ok()).unwrap_or_default();
        format!("{}#{fragment}", href.split('#').next().unwrap_or_default())
    }

    fn prefers_reduced_motion(&self) -> bool {
        let query = "(prefers-reduced-motion: reduce)";
        let query = web_sys::window().and_then(|window| window.match_media(query).ok()).flatten();
        query.is_some_and(|query| query.matches())
    }

    fn state_changed(&self, state: &ViewerState, library: &Library) {
        self.shell.changed(&to_link(state, library));
    }
}
