//! What the shell's `window.gaitway` and dialog call. Documents cross as JSON text, errors as the message a person sees.

use std::rc::Rc;

use js_sys::{Array, Function, Promise, Uint8Array};
use serde_json::{Value, json};
use wasm_bindgen::prelude::*;

use super::page::{Page, page, state_of_link};
use crate::app::{App, Message, Opening, Reply, ScriptCall};
use crate::editor::Contents;
use crate::files::{Item, OpenError, Role, open_items, open_view};
use crate::frame::pose_document;
use crate::library::Motion;
use crate::samples;
use crate::state::{Command, MotionMap, ViewerState, active_clip, from_object, to_object};

/// Opens one set: an array of addresses and of `[name, Uint8Array]`. A model takes the place of what is shown; motions and
/// joint maps are used for it. With the role `motion` everything is borrowed from, models too. Resolves to
/// `{shown, document}` once it is on the screen: which of `model`, `motion` and `map` it was, and the inspect document.
/// What is shown stays when that fails.
#[wasm_bindgen]
pub async fn open(items: Array, role: Option<String>, is_own: bool) -> Result<String, JsError> {
    let page = page().map_err(error)?;
    let items = items_of(&items).map_err(error)?;
    let role = if role.as_deref() == Some("motion") { Role::Motion } else { Role::Any };
    let shown = show(&page, What::Items { items, role, is_own }).await.map_err(error)?;
    Ok(json!({ "shown": shown.what, "document": shown.document }).to_string())
}

/// Takes over another part after `#`, with its files when they are others than those shown, or when all is to be read
/// `again`. Resolves to `{loaded, problems}`: the addresses that were read, and what of the link could not be had.
#[wasm_bindgen]
pub async fn follow_link(link: String, again: bool) -> Result<String, JsError> {
    let page = page().map_err(error)?;
    let state = state_of_link(&link, &page.shell);
    take_over(&page, state, again, true).await.map_err(error)
}

/// Sets some keys of the link; resolves after the frame that shows them, to the same as [`follow_link`].
#[wasm_bindgen]
pub async fn apply(partial: String) -> Result<String, JsError> {
    let page = page().map_err(error)?;
    let partial: Value = serde_json::from_str(&partial).map_err(|problem| error(problem.to_string()))?;
    let before = with_app(&page, |app| app.state().clone()).map_err(error)?;
    let (state, errors) = from_object(&before, &partial);
    if !errors.is_empty() || !needs_files(&before, &state) {
        let (promise, reply) = promise::<()>(|()| JsValue::UNDEFINED);
        page.inbox.send(Message::Script(ScriptCall::Apply(partial, reply)));
        return settled(promise).await.map(|_| news(&[], &[])).map_err(error);
    }
    take_over(&page, state.or_sample(samples::WALKER), false, false).await.map_err(error)
}

/// Takes the model off the list that was shown while a link's own files were waited for.
#[wasm_bindgen]
pub fn close_stand_in() -> Result<(), JsError> {
    let page = page().map_err(error)?;
    with_app(&page, App::close_placeholder).map_err(error)
}

/// Shows why something that was asked of the shell cannot be had.
#[wasm_bindgen]
pub fn refuse(problem: String) -> Result<(), JsError> {
    page().map_err(error)?.inbox.send(Message::Failed(problem));
    Ok(())
}

/// Whether anything that is shown or borrowed from is a person's own.
#[wasm_bindgen]
pub fn is_private() -> Result<bool, JsError> {
    let page = page().map_err(error)?;
    with_app(&page, |app| app.editor().is_private()).map_err(error)
}

/// The picture of a QR code: a line of `0` and `1` for each row. None for a text too long to be read off a screen.
#[wasm_bindgen]
pub fn qr(text: &str) -> Option<String> {
    let largest = qrcodegen::Version::new(30);
    let segments = qrcodegen::QrSegment::make_segments(text);
    let (least, smallest) = (qrcodegen::QrCodeEcc::Low, qrcodegen::Version::MIN);
    let code = qrcodegen::QrCode::encode_segments_advanced(&segments, least, smallest, largest, None, true).ok()?;
    let row = |y| (0..code.size()).map(|x| if code.get_module(x, y) { '1' } else { '0' }).collect();
    Some((0..code.size()).map(row).collect::<Vec<String>>().join("\n"))
}

/// The link's keys as JSON.
#[wasm_bindgen]
pub fn state() -> Result<String, JsError> {
    let page = page().map_err(error)?;
    with_app(&page, |app| to_object(app.state()).to_string()).map_err(error)
}

/// The pose document of what is on the screen.
#[wasm_bindgen]
pub fn pose() -> Result<String, JsError> {
    let page = page().map_err(error)?;
    with_app(&page, |app| pose_document(app.library(), app.state()).to_string()).map_err(error)
}

#[wasm_bindgen]
pub fn stats() -> Result<String, JsError> {
    let page = page().map_err(error)?;
    with_app(&page, |app| app.stats().to_string()).map_err(error)
}

/// PNG bytes of the picture alone.
#[wasm_bindgen]
pub async fn screenshot() -> Result<Uint8Array, JsError> {
    let page = page().map_err(error)?;
    let (promise, reply) = promise::<Vec<u8>>(|png| Uint8Array::from(png.as_slice()).into());
    page.inbox.send(Message::Script(ScriptCall::Screenshot(reply)));
    settled(promise).await.map(JsValue::unchecked_into).map_err(error)
}

/// Resolves when the first picture is drawn. From then on time goes by.
#[wasm_bindgen]
pub async fn begin() -> Result<(), JsError> {
    let page = page().map_err(error)?;
    with_app(&page, |app| app.drawn()).map_err(error)?.await;
    with_app(&page, App::begin).map_err(error)
}

/// What the live regions say: `{model, clip, playing, problem}`; no clip is the rest pose.
#[wasm_bindgen]
pub fn summary() -> Result<String, JsError> {
    let page = page().map_err(error)?;
    let summary = |app: &mut App| {
        let state = app.state();
        let model = app.library().active();
        let clip = model.and_then(|model| model.clip_titles().get(active_clip(model, state)?));
        json!({ "model": state.sources.model.join(", "), "clip": clip, "playing": state.playback.playing, "problem": app.problem() })
            .to_string()
    };
    with_app(&page, summary).map_err(error)
}

/// Whether files have to be read before `state` can be shown instead of `before`.
fn needs_files(before: &ViewerState, state: &ViewerState) -> bool {
    let has_map_file = || state.retarget.map.iter().any(|map| matches!(map, MotionMap::File(_)));
    state.sources.model != before.sources.model || state.sources.motion != before.sources.motion || has_map_file()
}

/// Shows a state, with its files where they are others than those shown, or in any case. What a link lacks is for the shell
/// to say.
async fn take_over(page: &Rc<Page>, state: ViewerState, again: bool, is_link: bool) -> Result<String, String> {
    let before = with_app(page, |app| app.state().clone())?;
    if !again && !needs_files(&before, &state) {
        page.inbox.send(Message::Commands(vec![Command::Replace(Box::new(state))]));
        return Ok(news(&[], &[]));
    }
    let with_model = again || !with_app(page, |app| app.editor().holds(&state))?;
    let held = if again { Vec::new() } else { with_app(page, |app| app.library().motions().to_vec())? };
    let models = state.sources.model.iter().filter(|_| with_model);
    let motions = state.sources.motion.iter().filter(|source| !held.iter().any(|motion| motion.origin == **source));
    let loaded: Vec<String> = models.chain(motions).cloned().collect();
    let shown = show(page, What::View { state: Box::new(state), with_model, held, is_link }).await?;
    Ok(news(&loaded, &shown.problems))
}

fn news(loaded: &[String], problems: &[String]) -> String {
    json!({ "loaded": loaded, "problems": problems }).to_string()
}

/// What is to be opened.
enum What {
    /// The present state is kept as far as it fits.
    Items { items: Vec<Item>, role: Role, is_own: bool },
    /// A whole view, with its model or with the one that is shown; of a link, the shell says what is missing.
    View { state: Box<ViewerState>, with_model: bool, held: Vec<Motion>, is_link: bool },
}

struct Shown {
    /// `model`, `motion` or `map`.
    what: &'static str,
    /// The inspect document.
    document: Value,
    /// What could not be had.
    problems: Vec<String>,
}

/// Loads and shows.
async fn show(page: &Rc<Page>, what: What) -> Result<Shown, String> {
    let load = page.loads.get() + 1;
    page.loads.set(load);
    let progress = |name: &str, received_bytes: u64, total_bytes: u64| {
        if page.loads.get() == load {
            let opening = Opening { name: name.to_owned(), received_bytes, total_bytes };
            page.inbox.send(Message::OpenProgress(opening));
        }
    };
    let shell_tells = matches!(what, What::View { is_link: true, .. });
    let opened: Result<(Contents, Option<Box<ViewerState>>), OpenError> = match what {
        What::Items { items, role, is_own } => {
            let contents = open_items(items, role, &progress).await;
            contents.map(|contents| (if is_own { contents.owned() } else { contents }, None))
        }
        What::View { state, with_model, held, .. } => {
            let opened = open_view(*state, with_model, &held, &progress).await;
            opened.map(|(contents, state)| (contents, Some(Box::new(state))))
        }
    };
    if page.loads.get() != load {
        return Err("something else was opened meanwhile".to_owned());
    }
    match opened {
        Ok((mut contents, state)) => {
            let what = match &contents {
                Contents { models, .. } if !models.is_empty() => "model",
                Contents { motions: Some(_), .. } => "motion",
                _ => "map",
            };
            let problems = contents.problems.clone();
            if shell_tells {
                contents.problems.clear();
            } else {
                problems.iter().for_each(|problem| page.shell.warn(problem));
            }
            let (promise, reply) = promise::<Value>(|document| JsValue::from_str(&document.to_string()));
            page.inbox.send(Message::Opened { contents: Box::new(contents), state, reply: Some(reply) });
            let text = settled(promise).await?.as_string().unwrap_or_default();
            let document = serde_json::from_str(&text).map_err(|error| error.to_string())?;
            Ok(Shown { what, document, problems })
        }
        Err(problem) => {
            let problem = problem.to_string();
            let told = if shell_tells { Message::OpenGivenUp } else { Message::OpenFailed(problem.clone()) };
            page.inbox.send(told);
            Err(problem)
        }
    }
}

pub(super) fn items_of(items: &Array) -> Result<Vec<Item>, String> {
    let wrong = || "expected addresses, files, or one object with a buffer for each name".to_owned();
    items
        .iter()
        .map(|item| {
            if let Some(url) = item.as_string() {
                return Ok(Item::Address(url.into()));
            }
            let pair: Array = item.dyn_into().map_err(|_| wrong())?;
            let name = pair.get(0).as_string().ok_or_else(wrong)?;
            let bytes: Uint8Array = pair.get(1).dyn_into().map_err(|_| wrong())?;
            Ok(Item::File(name, bytes.to_vec()))
        })
        .collect()
}

fn with_app<T>(page: &Page, read: impl FnOnce(&mut App) -> T) -> Result<T, String> {
    let mut app = page.runner.app_mut::<App>().ok_or_else(|| "Gaitway is busy or has stopped".to_owned())?;
    Ok(read(&mut app))
}

/// A promise, and the reply that settles it.
fn promise<T: 'static>(into: impl FnOnce(T) -> JsValue + 'static) -> (Promise, Reply<T>) {
    let mut functions = None;
    let promise = Promise::new(&mut |resolve, reject| functions = Some((resolve, reject)));
    let reply: Reply<T> = Box::new(move |answer| {
        let call = |function: &Function, value: &JsValue| {
            // Settling a promise runs nothing at once and cannot fail.
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
    let settled = wasm_bindgen_futures::JsFuture::from(promise).await;
    settled.map_err(|message| message.as_string().unwrap_or_default())
}

fn error(message: impl AsRef<str>) -> JsError {
    JsError::new(message.as_ref())
}
