//! Functions for the shell's `window.gaitway` and dialogs. Documents are passed as JSON text. An error has the message for
//! the user and a `code` for scripts.

use std::cell::RefCell;
use std::pin::pin;
use std::rc::Rc;

use futures_util::future::{Either, select};
use gaitway_formats::{self as formats, FileSet};
use gaitway_scene::editor::{AboutLink, Contents, short_name};
use gaitway_scene::frame::PoseDocument;
use gaitway_scene::library::{Environment, Model, ModelClip, ModelId, Motion, inspect};
use gaitway_scene::samples;
use gaitway_scene::state::{
    EnvironmentChoice, MotionMap, ViewerState, active_clip, from_object, to_object, with_current_member,
};
use gaitway_session::{ErrorCode, Kind};
use js_sys::{Array, Function, Promise, Reflect, Uint8Array};
use serde_json::{Value, json};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;
use web_sys::ImageBitmap;

use super::page::{Cancel, Page, page, state_of_link};
use crate::app::{App, Message, Reply, ScriptCall};
use crate::files::{Held, Item, Role, open_items, open_view, within};
use crate::ui::{Progress, text, title_and_hint};

/// Returns the font of the panels, for the rest of the page.
#[wasm_bindgen]
pub fn font() -> Uint8Array {
    Uint8Array::from(crate::ui::FONT)
}

/// Panics. Nothing calls it but the test of what the page says then.
#[wasm_bindgen]
#[expect(clippy::panic, reason = "that is what it is for")]
pub fn panic_for_test() {
    panic!("as the test asked");
}

/// Opens one set: an array of URLs and `[name, Uint8Array]` pairs. A model becomes the active one; motions and joint maps are
/// applied to the active model. With the role `motion`, models are opened as motions too. Resolves once it is on screen, to
/// `{shown, document}`: which of `model`, `motion`, `light` and `map` it was, and the inspect document. Changes nothing on failure.
/// `is_by_hand`: the user opened it, not a script.
#[wasm_bindgen]
pub async fn open(items: Array, role: String, is_private: bool, is_by_hand: bool) -> Result<String, JsValue> {
    let page = page().map_err(stopped)?;
    let items = items_of(items).map_err(malformed)?;
    let role = if role == "motion" { Role::Motion } else { Role::Any };
    let opened = load(&page, Request::Items { items, role, is_private, is_by_hand }).await?;
    // After the frame: checking rig and clips takes milliseconds.
    let document = with_app(&page, |app| {
        let sources = &app.state().character.sources.model;
        app.library().active().map(|model| inspect(model, sources)).unwrap_or_default()
    });
    Ok(json!({ "shown": opened.kind, "document": document.map_err(stopped)? }).to_string())
}

/// Opens a link, given the part after `#`, as far as it can be shown without the files that it waits for. Loads its files if they
/// differ from the loaded ones, or all of them with `reload`. Resolves to `{loaded, problems}`: the sources that were read, and what
/// could not be opened.
#[wasm_bindgen]
pub async fn follow_link(link: String, reload: bool) -> Result<String, JsValue> {
    let page = page().map_err(stopped)?;
    let (state, about_link) = state_of_link(&link);
    Ok(open_state(&page, state, reload, Some(about_link)).await?)
}

/// Sets some keys of the link; resolves like [`follow_link`], after the frame that shows the result.
#[wasm_bindgen]
pub async fn apply(partial: String) -> Result<String, JsValue> {
    let page = page().map_err(stopped)?;
    let partial: Value = serde_json::from_str(&partial).map_err(|problem| malformed(problem.to_string()))?;
    // Keys that it doesn't set keep the values of a link, whatever the preference for reduced motion has stopped.
    let read = |app: &mut App| {
        let before = app.editor().shared_state();
        let (state, errors) = from_object(&before, app.library(), &partial);
        (before, state, errors)
    };
    let (before, state, errors) = with_app(&page, read).map_err(stopped)?;
    if !errors.is_empty() || !needs_files(&before, &state) {
        let (promise, reply) = promise::<()>(|()| JsValue::UNDEFINED);
        page.inbox.send(Message::Script(ScriptCall::Apply(partial, reply)));
        return settled(promise).await.map(|_| report(&[], &[])).map_err(malformed);
    }
    Ok(open_state(&page, state.or_sample(samples::WALKER), false, None).await?)
}

/// Returns what the files of a set refer to and what isn't among them: relative URIs, percent-decoded. Ignores URLs.
#[wasm_bindgen]
pub fn missing_files(items: Array) -> Result<Vec<String>, JsValue> {
    let mut files = FileSet::default();
    for item in items_of(items).map_err(malformed)? {
        if let Item::File(name, bytes) = item {
            files.insert(name, bytes);
        }
    }
    Ok(formats::missing_files(&files))
}

/// Shows why the shell refused a request.
#[wasm_bindgen]
pub fn refuse(problem: String) -> Result<(), JsValue> {
    page().map_err(stopped)?.inbox.send(Message::Failed(problem));
    Ok(())
}

/// Shows a notice of the shell's.
#[wasm_bindgen]
pub fn notify(notice: String) -> Result<(), JsValue> {
    page().map_err(stopped)?.inbox.send(Message::Notice(notice));
    Ok(())
}

/// Returns the link's keys as JSON.
#[wasm_bindgen]
pub fn state() -> Result<String, JsValue> {
    let page = page().map_err(stopped)?;
    with_app(&page, |app| to_object(app.state(), app.library()).to_string()).map_err(stopped)
}

/// Returns the pose document of the current pose.
#[wasm_bindgen]
pub fn pose() -> Result<String, JsValue> {
    let page = page().map_err(stopped)?;
    with_app(&page, |app| PoseDocument::new(app.library(), app.state()).to_string()).map_err(stopped)
}

#[wasm_bindgen]
pub fn stats() -> Result<String, JsValue> {
    let page = page().map_err(stopped)?;
    with_app(&page, |app| app.stats().to_string()).map_err(stopped)
}

/// Returns the viewport as PNG bytes.
#[wasm_bindgen]
pub async fn screenshot() -> Result<Uint8Array, JsValue> {
    let page = page().map_err(stopped)?;
    let (promise, reply) = promise::<Vec<u8>>(|png| Uint8Array::from(png.as_slice()).into());
    page.inbox.send(Message::Script(ScriptCall::Screenshot(reply)));
    settled(promise).await.map(JsValue::unchecked_into).map_err(stopped)
}

/// Returns the pixels of a frame of the video that is being recorded: RGBA rows from the top, with straight alpha.
#[wasm_bindgen]
pub async fn video_frame(index: u32) -> Result<Uint8Array, JsValue> {
    let page = page().map_err(stopped)?;
    let pixels = with_app(&page, |app| app.video_frame(index)).flatten().map_err(stopped)?;
    pixels.await.map(|pixels| Uint8Array::from(pixels.as_slice())).map_err(stopped)
}

/// Returns the glTF that a model was read from as it was opened, or the file that it refers to by a URI.
#[wasm_bindgen]
pub fn gltf_file(model: f64, uri: Option<String>) -> Result<Uint8Array, JsValue> {
    let page = page().map_err(stopped)?;
    let read = |app: &mut App| {
        app.editor().gltf_file(ModelId(model as u64), uri.as_deref()).map(|file| Uint8Array::from(file.as_slice()))
    };
    with_app(&page, read).map_err(stopped)?.ok_or_else(|| error(ErrorCode::NotFound, "there is no such file"))
}

/// Resolves when the first image has been drawn. The next frame shows it once more.
#[wasm_bindgen]
pub async fn drawn() -> Result<(), JsValue> {
    let page = page().map_err(stopped)?;
    with_app(&page, |app| app.drawn()).map_err(stopped)?.await;
    page.context.request_repaint();
    Ok(())
}

/// Starts time: the first image is on screen.
#[wasm_bindgen]
pub fn begin() -> Result<(), JsValue> {
    with_app(&*page().map_err(stopped)?, App::begin).map_err(stopped)
}

/// Waits for the images of the model that [`run`](super::page::run) has shown without them, if so. Resolves to why they can't be
/// shown: then the model stays as it is. To an empty text if they can be, if the user cancels it or looks at another model.
#[wasm_bindgen]
pub async fn complete() -> String {
    let Ok(page) = page() else { return String::new() };
    let Some((model, rest)) = page.rest.take() else { return String::new() };
    let rest = unless_cancelled(&page.cancel_rest, rest).await;
    if page.cancel_load.borrow().is_none() {
        page.inbox.send(Message::OpenFailedSilently);
    }
    let completed = match rest {
        None => {
            page.inbox.send(Message::Notice(text::WITHOUT_IMAGES.to_owned()));
            Ok(())
        }
        Some(Err(problem)) => Err(problem),
        Some(Ok((mut contents, _, problems))) => match contents.models.pop() {
            Some(opened) if problems.is_empty() => with_app(&page, |app| app.complete(model, opened)).flatten(),
            _ => Err(problems.join("\n")),
        },
    };
    forget_images(&page);
    let is_active = |app: &mut App| app.library().active().is_some_and(|active| active.id == model);
    let problem = completed.err().filter(|_| with_app(&page, is_active).unwrap_or_default());
    problem.unwrap_or_default()
}

/// Loads the active model's images again after [`complete`] has failed, and resolves to the same.
#[wasm_bindgen]
pub async fn complete_again() -> String {
    let Ok(page) = page() else { return String::new() };
    let bare = |app: &mut App| {
        let model = app.library().active().filter(|model| model.awaits_images())?;
        Some((model.id, model.origin.clone(), app.editor().state().clone()))
    };
    let Ok(Some((model, origin, state))) = with_app(&page, bare) else { return String::new() };
    let reading = page.clone();
    let rest = async move {
        let progress = |name: &str, received: u64, total: u64| rest_progress(&reading, name, received, total);
        let items = vec![Item::Address(origin.into())];
        let contents = open_items(&reading.image_limits, items, Role::Model, &progress, Some(&upload_image)).await;
        contents.map(|contents| (contents, state, Vec::new())).map_err(|problem| problem.to_string())
    };
    page.rest.replace(Some((model, Box::pin(rest))));
    complete().await
}

/// Shows how much of a model's complete file has arrived, while no other load shows its own progress.
pub(super) fn rest_progress(page: &Page, name: &str, received_bytes: u64, total_bytes: u64) {
    if page.cancel_load.borrow().is_none() {
        page.inbox.send(Message::OpenProgress(progress_of(name, received_bytes, total_bytes)));
    }
}

/// Returns the contents of the live regions as `{model, isEmpty, unlisted, clip, playing, isEmbedded, notice, problem}`. `clip` is
/// null for the rest pose; `isEmpty` is true without a model; `unlisted` are the names of the open models that the link leaves out.
#[wasm_bindgen]
pub fn summary() -> Result<String, JsValue> {
    let page = page().map_err(stopped)?;
    let named = |model: &Model| match model.is_placeholder() {
        true => title_and_hint(model).0,
        false => short_name(&model.source),
    };
    let summary = |app: &mut App| {
        let state = app.state();
        let model = app.library().active();
        let clip = model.and_then(|model| active_clip(model, state)).map(ModelClip::title);
        let models = app.library().models().iter();
        let unlisted =
            models.filter(|other| !other.is_placeholder() && !state.character.sources.model.contains(&other.origin));
        json!({
            "model": model.map_or_else(String::new, named),
            "isEmpty": model.is_none_or(Model::is_placeholder),
            "unlisted": unlisted.map(|model| short_name(&model.source)).collect::<Vec<_>>(),
            "clip": clip,
            "playing": state.playback.playing,
            "isEmbedded": state.page.embed.is_on(),
            "notice": app.notice(),
            "problem": app.problem(),
        })
        .to_string()
    };
    with_app(&page, summary).map_err(stopped)
}

/// Whether files must be read to go from `before` to `state`.
fn needs_files(before: &ViewerState, state: &ViewerState) -> bool {
    let has_map_file = || state.character.retarget.map.iter().any(|map| matches!(map, MotionMap::File(_)));
    let light = &state.lighting.environment;
    let has_other_light = matches!(light, EnvironmentChoice::File(_)) && *light != before.lighting.environment;
    let has_other_sources = state.character.sources.model != before.character.sources.model
        || state.character.sources.motion != before.character.sources.motion;
    has_other_sources || has_other_light || has_map_file()
}

/// Opens a state. Loads its files if they differ from the loaded ones, or all of them with `reload`. For a link, given with what
/// was not understood of it, the shell reports what is missing.
async fn open_state(
    page: &Rc<Page>,
    state: ViewerState,
    reload: bool,
    about_link: Option<AboutLink>,
) -> Result<String, Refusal> {
    // What has arrived since the last frame is shown first: which files are needed depends on it.
    page.frames.draw();
    let before = with_app(page, |app| app.state().clone())?;
    if !reload && !needs_files(&before, &state) {
        // What is being loaded for another link is no longer wanted.
        page.loads.start();
        let contents = Contents { about_link: about_link.unwrap_or_default(), ..Contents::default() };
        let (contents, state) = (Box::new(contents), Some(Box::new(state)));
        page.inbox.send(Message::Opened { contents, state, is_change: false, reply: None });
        return Ok(report(&[], &[]));
    }
    let with_model = reload || !with_app(page, |app| app.editor().holds(&state))?;
    let current_motions = if reload { Vec::new() } else { with_app(page, |app| app.library().motions().to_vec())? };
    let environments = if reload { Vec::new() } else { with_app(page, |app| app.library().environments().to_vec())? };
    let mut loaded = if with_model { state.character.sources.model.clone() } else { Vec::new() };
    let mut motions = state.character.sources.motion.clone();
    motions.retain(|source| !current_motions.iter().any(|motion| motion.origin == *source));
    let request = Request::View { state: Box::new(state), with_model, current_motions, environments, about_link };
    let opened = load(page, request).await?;
    // What couldn't be read is among the problems.
    with_app(page, |app| {
        loaded.retain(|source| app.library().models().iter().any(|model| model.origin == *source));
        motions.retain(|source| app.library().motions().iter().any(|motion| motion.origin == *source));
    })?;
    loaded.append(&mut motions);
    Ok(report(&loaded, &opened.problems))
}

fn report(loaded: &[String], problems: &[String]) -> String {
    json!({ "loaded": loaded, "problems": problems }).to_string()
}

/// What to open.
enum Request {
    /// Files; as much of the current state as fits is kept.
    Items { items: Vec<Item>, role: Role, is_private: bool, is_by_hand: bool },
    /// A whole view, with its model or on the active one. For a link, given with what is known of it, the shell reports what
    /// is missing.
    View {
        state: Box<ViewerState>,
        with_model: bool,
        current_motions: Vec<Motion>,
        environments: Vec<Environment>,
        about_link: Option<AboutLink>,
    },
}

/// What was opened.
struct Opened {
    kind: Kind,
    /// What could not be opened.
    problems: Vec<String>,
}

/// A server that takes longer to answer is shown as being waited for.
const PATIENCE_MILLIS: i32 = 400;

/// Loads what was requested and shows it, unless another load starts in the meantime.
async fn load(page: &Rc<Page>, request: Request) -> Result<Opened, Refusal> {
    let opened = load_and_show(page, request).await;
    forget_images(page);
    opened
}

/// Uploads an image of a model that is being read: while the browser decodes the next one, there is nothing else to do. Otherwise it
/// is uploaded with the model.
pub(super) fn upload_image(image: &ImageBitmap, srgb: bool) {
    if let Ok(page) = page() {
        let _ = with_app(&page, |app| app.upload_image(image, srgb));
    }
}

/// Frees the images of a model that wasn't shown after all.
pub(super) fn forget_images(page: &Page) {
    let _ = with_app(page, App::forget_images);
}

async fn load_and_show(page: &Rc<Page>, request: Request) -> Result<Opened, Refusal> {
    let number = page.loads.start();
    let latest = RefCell::new(Progress::default());
    let show_progress = || {
        if page.loads.is_latest(number) && !latest.borrow().name.is_empty() {
            page.inbox.send(Message::OpenProgress(latest.borrow().clone()));
        }
    };
    let progress = |name: &str, received_bytes: u64, total_bytes: u64| {
        latest.replace(progress_of(name, received_bytes, total_bytes));
        // What is in memory is read at once: a frame that shows it would only delay it.
        if received_bytes > 0 {
            show_progress();
        }
    };
    let shell_reports = matches!(request, Request::View { about_link: Some(_), .. });
    // Over an embedded view, only errors of what the user opened are shown. Scripts get the others.
    let is_embedded = with_app(page, |app| app.state().page.embed.is_on())?;
    let is_silent = is_embedded && !matches!(request, Request::Items { is_by_hand: true, .. });
    let read = async {
        match request {
            Request::Items { items, role, is_private, is_by_hand } => {
                let contents = open_items(&page.image_limits, items, role, &progress, Some(&upload_image)).await;
                let contents = contents.map(|contents| Contents { is_by_hand, ..contents });
                contents.map(|contents| (if is_private { contents.into_private() } else { contents }, None))
            }
            Request::View { state, with_model, current_motions, environments, about_link } => {
                let held = Held { motions: &current_motions, environments: &environments };
                let opened =
                    open_view(&page.image_limits, *state, with_model, held, &progress, None, Some(&upload_image)).await;
                let about_link = about_link.unwrap_or_default();
                opened.map(|(contents, state)| (Contents { about_link, ..contents }, Some(Box::new(state))))
            }
        }
    };
    let read = with_patience(read, show_progress);
    let Some(opened) = unless_cancelled(&page.cancel_load, read).await else {
        // The last bytes may have arrived together with the click.
        page.inbox.send(Message::OpenFailedSilently);
        return Err(Refusal::cancelled("Opening was cancelled."));
    };
    if !page.loads.is_latest(number) {
        let Progress { name, .. } = latest.into_inner();
        let what = if name.is_empty() { name } else { format!("{name}: ") };
        return Err(Refusal::cancelled(&format!("{what}something else was opened in the meantime")));
    }
    // Names what is opened or has failed, in the frame that shows it.
    page.inbox.send(Message::OpenProgress(latest.into_inner()));
    match opened {
        Ok((contents, state)) => {
            let shown = show(page, contents, state, shell_reports, is_silent).await;
            shown.map_err(|message| Refusal { code: ErrorCode::Unsupported, message })
        }
        Err(problem) => {
            let (code, message) = (problem.code(), problem.to_string());
            let is_silent = shell_reports || is_silent;
            let failed = if is_silent { Message::OpenFailedSilently } else { Message::OpenFailed(message.clone()) };
            page.inbox.send(failed);
            Err(Refusal { code, message })
        }
    }
}

/// Awaits a load, and shows its progress if that takes long.
async fn with_patience<T>(load: impl Future<Output = T>, show_progress: impl FnOnce()) -> T {
    match within(pin!(load), PATIENCE_MILLIS).await {
        Ok(loaded) => loaded,
        Err(load) => {
            show_progress();
            load.await
        }
    }
}

/// Awaits a load; `None` if the user cancels it, which the slot allows meanwhile.
async fn unless_cancelled<T>(slot: &Cancel, load: impl Future<Output = T>) -> Option<T> {
    let mut own = None;
    let cancelled = Promise::new(&mut |cancel, _| own = Some(cancel));
    slot.replace(own.clone());
    let loaded = match select(pin!(load), JsFuture::from(cancelled)).await {
        Either::Left((loaded, _)) => Some(loaded),
        Either::Right(_) => None,
    };
    // A later load may have taken the slot.
    slot.borrow_mut().take_if(|current| own.as_ref() == Some(current));
    loaded
}

pub(super) fn progress_of(name: &str, received_bytes: u64, total_bytes: u64) -> Progress {
    Progress { name: name.to_owned(), received_bytes, total_bytes }
}

/// Hands opened files to the app; resolves once they are on screen. The shell reports missing files of links, and only
/// of links, so a `state` whose problems it doesn't report is a change of the current one. With `is_silent`, only scripts learn of
/// problems.
async fn show(
    page: &Rc<Page>,
    mut contents: Contents,
    state: Option<Box<ViewerState>>,
    shell_reports: bool,
    is_silent: bool,
) -> Result<Opened, String> {
    let kind = match &contents {
        Contents { models, .. } if !models.is_empty() => Kind::Model,
        Contents { motions: Some(_), .. } => Kind::Motion,
        Contents { environment: Some(_), .. } => Kind::Light,
        _ => Kind::Map,
    };
    if !shell_reports && !contents.problems.is_empty() {
        page.shell.warn(&contents.problems.join("\n"), contents.failure.map(code_text));
        if is_silent {
            contents.problems.clear();
        }
    }
    let (promise, reply) =
        promise::<Vec<String>>(|problems| problems.into_iter().map(JsValue::from).collect::<Array>().into());
    let opened = Message::Opened { contents: Box::new(contents), state, is_change: !shell_reports, reply: Some(reply) };
    page.inbox.send(opened);
    // In a task of its own, since reading may have taken this one long enough, unless an animation frame comes first.
    let shown = match within(pin!(settled(promise)), 0).await {
        Ok(shown) => shown,
        Err(shown) => {
            page.frames.draw();
            shown.await
        }
    };
    let problems = Array::from(&shown?).iter().filter_map(|problem| problem.as_string()).collect();
    Ok(Opened { kind, problems })
}

/// Takes the array, so that the browser can free the files as soon as they are copied.
pub(super) fn items_of(items: Array) -> Result<Vec<Item>, String> {
    let invalid = || "expected URLs, files, or one object with a buffer for each name".to_owned();
    items
        .iter()
        .map(|item| {
            if let Some(url) = item.as_string() {
                return Ok(Item::Address(with_current_member(&url).into()));
            }
            let pair: Array = item.dyn_into().map_err(|_| invalid())?;
            let name = pair.get(0).as_string().ok_or_else(invalid)?;
            let bytes: Uint8Array = pair.get(1).dyn_into().map_err(|_| invalid())?;
            Ok(Item::File(name, bytes.to_vec()))
        })
        .collect()
}

pub(super) fn with_app<T>(page: &Page, read: impl FnOnce(&mut App) -> T) -> Result<T, String> {
    let mut app = page.runner.app_mut::<App>().ok_or_else(|| "Gaitway is busy or has stopped".to_owned())?;
    Ok(read(&mut app))
}

/// Returns a promise with the reply that settles it.
fn promise<T: 'static>(into: impl FnOnce(T) -> JsValue + 'static) -> (Promise, Reply<T>) {
    let mut functions = None;
    let promise = Promise::new(&mut |resolve, reject| functions = Some((resolve, reject)));
    let reply: Reply<T> = Box::new(move |answer| {
        let call = |function: &Function, value: &JsValue| {
            // Settling a promise only queues its callbacks; it cannot fail.
            let _ = function.call1(&JsValue::UNDEFINED, value);
        };
        match (answer, functions) {
            (Ok(answer), Some((resolve, _))) => call(&resolve, &into(answer)),
            (Err(message), Some((_, reject))) => call(&reject, &JsValue::from_str(&message)),
            (_, None) => {}
        }
    });
    (promise, reply)
}

async fn settled(promise: Promise) -> Result<JsValue, String> {
    let settled = JsFuture::from(promise).await;
    settled.map_err(|message| message.as_string().unwrap_or_default())
}

/// Why a call failed.
pub(super) struct Refusal {
    pub code: ErrorCode,
    pub message: String,
}

impl Refusal {
    fn cancelled(message: &str) -> Self {
        Self { code: ErrorCode::Cancelled, message: message.to_owned() }
    }
}

/// Only an instance that has stopped, or is about to, has no app to ask.
impl From<String> for Refusal {
    fn from(message: String) -> Self {
        Self { code: ErrorCode::LostDevice, message }
    }
}

impl From<Refusal> for JsValue {
    fn from(Refusal { code, message }: Refusal) -> Self {
        error(code, &message)
    }
}

/// Returns a code as scripts get it.
fn code_text(code: ErrorCode) -> String {
    json!(code).as_str().unwrap_or_default().to_owned()
}

fn error(code: ErrorCode, message: &str) -> JsValue {
    let error = js_sys::Error::new(message);
    // Only a frozen object refuses a property.
    let _ = Reflect::set(&error, &"code".into(), &code_text(code).into());
    error.into()
}

fn stopped(message: String) -> JsValue {
    error(ErrorCode::LostDevice, &message)
}

pub(super) fn malformed(message: String) -> JsValue {
    error(ErrorCode::Malformed, &message)
}
