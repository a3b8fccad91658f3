//! Starting an instance on a canvas, and its end.

use std::cell::{Cell, RefCell};

use js_sys::Array;
use wasm_bindgen::prelude::*;

use super::shell::{self, Shell};
use crate::app::{App, Backend, Host, Inbox, set_fatal_hook, web_options};
use crate::editor::{Contents, OpenedModel};
use crate::files::{Item, OpenError, Role, open_items, open_view};
use crate::samples;
use crate::state::{ViewerState, from_link, to_link};

/// One instance draws on one canvas.
pub(super) struct Page {
    pub runner: eframe::WebRunner,
    pub inbox: Inbox,
    pub shell: Shell,
    /// Loads begun so far: of several under way only the last is shown.
    pub loads: Cell<u32>,
}

thread_local! {
    static PAGE: RefCell<Option<std::rc::Rc<Page>>> = const { RefCell::new(None) };
}

/// Nothing is drawn before the shell calls [`run`].
pub fn start() {
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        before(info);
        let message = info.payload_as_str().unwrap_or("an error without a message");
        let place = info.location().map(|place| format!(" ({place})")).unwrap_or_default();
        shell::stopped(&format!("An error inside Gaitway: {message}{place}"));
    }));
    set_fatal_hook(shell::stopped);
}

/// Shows what the link says, or `items` (see [`super::calls::open`]) in the link's view, borrowing from `motion_items` and
/// what else the link lists; `is_own`: these are a person's own files. Resolves when the first picture is on its way, to a
/// JSON list of what could not be had; [`super::calls::begin`] comes next. `renderer` is `webgpu`, `webgl2` or nothing.
/// Rejects when no device is to be had; call again with a new canvas then.
#[wasm_bindgen]
pub async fn run(
    canvas: web_sys::HtmlCanvasElement,
    renderer: Option<String>,
    link: String,
    items: Array,
    motion_items: Array,
    is_own: bool,
    shell: Shell,
) -> Result<String, JsError> {
    shell::keep(shell.clone());
    let first = first_contents(&link, &items, &motion_items, is_own, &shell).await;
    let (contents, state, problems) = first.map_err(|error| JsError::new(&error))?;
    let backend = match renderer.as_deref() {
        Some("webgpu") => Some(Backend::WebGpu),
        Some("webgl2") => Some(Backend::WebGl2),
        _ => None,
    };
    let runner = eframe::WebRunner::new();
    let made = std::rc::Rc::new(RefCell::new(None));
    let inbox_slot = made.clone();
    let host = Box::new(PageHost { shell: shell.clone() });
    let create: eframe::AppCreator<'static> = Box::new(move |cc| {
        let app = App::new(cc, host, contents, Some(state), |inbox| *inbox_slot.borrow_mut() = Some(inbox))?;
        Ok(Box::new(app))
    });
    runner.start(canvas, web_options(backend), create).await.map_err(|error| JsError::new(&text_of(&error)))?;
    let inbox = made.borrow_mut().take().ok_or_else(|| JsError::new("the app did not start"))?;
    let page = Page { runner, inbox, shell, loads: Cell::new(0) };
    PAGE.with_borrow_mut(|slot| *slot = Some(std::rc::Rc::new(page)));
    Ok(serde_json::json!(problems).to_string())
}

/// What is shown first: the items, else what the link lists, and what of that could not be had. A model that cannot be had
/// gives way to the skeleton of the first motion that can, else to the sample.
async fn first_contents(
    link: &str,
    items: &Array,
    motion_items: &Array,
    is_own: bool,
    shell: &Shell,
) -> Result<(Contents, ViewerState, Vec<String>), String> {
    let wanted = state_of_link(link, shell);
    let items = super::calls::items_of(items)?;
    let motion_items = super::calls::items_of(motion_items)?;
    let progress = |name: &str, received: u64, total: u64| shell.progress(name, received as f64, total as f64);
    let opened = async {
        let (mut models, mut held, mut problem) = (Vec::new(), Vec::new(), None);
        if !items.is_empty() {
            let found = open_items(items, Role::Model, &progress).await?;
            models = found.models;
            held.extend(found.motions.into_iter().flatten());
        }
        if !motion_items.is_empty() {
            match open_items(motion_items, Role::Motion, &progress).await {
                Ok(found) => held.extend(found.motions.into_iter().flatten()),
                Err(error) => problem = Some(error.to_string()),
            }
        }
        let (mut contents, view) = open_view(wanted.clone(), models.is_empty(), &held, &progress).await?;
        contents.models.extend(models);
        contents.problems.extend(problem);
        Ok((if is_own { contents.owned() } else { contents }, view))
    };
    let opened: Result<(Contents, ViewerState), OpenError> = opened.await;
    match opened {
        Ok((mut contents, view)) => {
            let problems = std::mem::take(&mut contents.problems);
            Ok((contents, view, problems))
        }
        Err(error) => {
            let mut problems = vec![error.to_string()];
            let mut models = Vec::new();
            for motion in &wanted.sources.motion {
                match open_items(vec![Item::Address(motion.into())], Role::Model, &progress).await {
                    Ok(found) => models.extend(found.models),
                    Err(error) => problems.push(error.to_string()),
                }
            }
            models.truncate(1);
            if models.is_empty() {
                models.extend(samples::load(samples::WALKER).map(OpenedModel::from));
            }
            let model = models.first().ok_or_else(|| problems.join("\n"))?;
            let view = wanted.for_model(ViewerState::of_model(model.model.source.clone()));
            Ok((Contents { models, motions: Some(Vec::new()), ..Contents::default() }, view, problems))
        }
    }
}

/// A link as a state; what it gets wrong is said.
pub(super) fn state_of_link(link: &str, shell: &Shell) -> ViewerState {
    let (state, errors) = from_link(link);
    errors.iter().for_each(|error| shell.warn(&error.to_string()));
    let state = state.or_sample(samples::WALKER);
    if prefers_reduced_motion() { state.calmed() } else { state }
}

fn prefers_reduced_motion() -> bool {
    let query = "(prefers-reduced-motion: reduce)";
    let query = web_sys::window().and_then(|window| window.match_media(query).ok()).flatten();
    query.is_some_and(|query| query.matches())
}

pub(super) fn page() -> Result<std::rc::Rc<Page>, String> {
    PAGE.with_borrow(Clone::clone).ok_or_else(|| "Gaitway has not started yet".to_owned())
}

/// Ends this instance and lets go of its canvas.
#[wasm_bindgen]
pub fn destroy() {
    if let Some(page) = PAGE.with_borrow_mut(Option::take) {
        page.runner.destroy();
    }
}

pub(super) fn text_of(value: &JsValue) -> String {
    value.as_string().unwrap_or_else(|| String::from(js_sys::Object::from(value.clone()).to_string()))
}

struct PageHost {
    shell: Shell,
}

impl Host for PageHost {
    fn choose_files(&self, role: Role, _inbox: &Inbox) -> bool {
        self.shell.choose(if role == Role::Motion { "motion" } else { "any" });
        true
    }

    fn has_gallery(&self) -> bool {
        true
    }

    fn show_gallery(&self) {
        self.shell.gallery();
    }

    fn save_file(&self, name: &str, bytes: &[u8]) -> bool {
        self.shell.save(name, bytes);
        true
    }

    fn start_recording(&self) -> Result<(), String> {
        let lacking = "this browser cannot record a canvas as WebM; Chrome, Edge and Firefox can, or save pictures";
        if self.shell.start_recording() { Ok(()) } else { Err(lacking.to_owned()) }
    }

    fn stop_recording(&self, name: Option<&str>) {
        self.shell.stop_recording(name);
    }

    /// The shell takes every drop before the canvas sees it, since it keeps the files and reads folders.
    fn open_dropped(&self, _files: Vec<egui::DroppedFileHandle>, _inbox: &Inbox) {}

    fn share(&self, fragment: &str) -> bool {
        self.shell.share(fragment);
        true
    }

    fn link(&self, fragment: &str) -> String {
        let href = web_sys::window().and_then(|window| window.location().href().ok()).unwrap_or_default();
        format!("{}#{fragment}", href.split('#').next().unwrap_or_default())
    }

    fn state_changed(&self, state: &ViewerState) {
        self.shell.changed(&to_link(state));
    }
}
