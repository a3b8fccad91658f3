//! Opens files on the page: fetched from a URL, or dropped and already in memory. Nothing is sent anywhere.

mod fetch;
mod images;
mod parts;
mod timer;

use std::cell::RefCell;
use std::ffi::OsStr;

use gaitway_character::asset::{Asset, Image};
use gaitway_formats::Preparation;
use gaitway_part::Answer;
use gaitway_scene::editor::Contents;
use gaitway_scene::library::{ImageData, Model};
use gaitway_scene::samples;
use gaitway_scene::state::ViewerState;
use js_sys::{Array, Reflect};
use wasm_bindgen::JsCast;
use web_sys::ImageBitmap;

pub use timer::within;

use super::source::{Content, Located, Progress, Reading, Source};
use super::{EarlyWatch, Held, ImageLimits, Item, OpenError, Role, open, raw_address, view};

/// Called with each image of a model that is opened alone once it is decoded, while others still may be: once if materials decode it
/// from sRGB, as the flag says, and once if they don't.
pub type OnImage<'a> = &'a dyn Fn(&ImageBitmap, bool);

/// Opens one set of items, to be drawn by a device with these limits.
pub async fn open_items(
    limits: &ImageLimits,
    items: Vec<Item>,
    role: Role,
    progress: Progress<'_>,
    on_image: Option<OnImage<'_>>,
) -> Result<Contents, OpenError> {
    open::open_items(&Web { limits, on_image, early: RefCell::default() }, items, role, progress).await
}

/// Opens the files of a view, except for its model if `with_model` is not set and for what is `held`. See
/// `view` for the details. `show_early` is called once nothing but the model's images is missing, if they take longer.
pub async fn open_view(
    limits: &ImageLimits,
    view: ViewerState,
    with_model: bool,
    held: Held<'_>,
    progress: Progress<'_>,
    show_early: Option<&dyn Fn(Model)>,
    on_image: Option<OnImage<'_>>,
) -> Result<(Contents, ViewerState), OpenError> {
    let early = show_early.and_then(|show| EarlyWatch::of(&view, show));
    view::open_view(&Web { limits, early: early.into(), on_image }, view, with_model, held, progress).await
}

struct Web<'a> {
    limits: &'a ImageLimits,
    /// Shows the only file that is opened before its images have arrived.
    early: RefCell<Option<EarlyWatch<'a>>>,
    on_image: Option<OnImage<'a>>,
}

impl Source for Web<'_> {
    /// The absolute URL.
    type Place = String;
    /// The URL of the file that refers to others.
    type Base = String;
    type Decoding = Vec<images::Decoding>;

    fn locate(&self, address: &OsStr) -> Result<Located<String, String>, OpenError> {
        let address = address.to_string_lossy().into_owned();
        let url = absolute(&address, None).ok_or_else(|| OpenError::InvalidUrl { url: address.clone() })?;
        let content = Content::File {
            name: file_name(&url),
            full_name: address.clone(),
            origin: Some(address.clone()),
            place: url.clone(),
        };
        Ok(Located { content, base: url, label: address })
    }

    /// The shell lists the samples' files next to the page in `gaitway.samples`.
    fn sample(&self, name: &str) -> Result<Vec<(String, String)>, OpenError> {
        let table = Reflect::get(&js_sys::global(), &"gaitway".into())
            .and_then(|gaitway| Reflect::get(&gaitway, &"samples".into()))
            .unwrap_or_else(|_| js_sys::Object::new().into());
        let addresses: Option<Array> = Reflect::get(&table, &name.into()).ok().and_then(|list| list.dyn_into().ok());
        let Some(addresses) = addresses else {
            let files = Reflect::own_keys(&table).unwrap_or_default();
            let known = files.iter().filter_map(|name| name.as_string()).chain([samples::WALKER.to_owned()]);
            let known = known.map(|name| format!("sample:{name}")).collect();
            return Err(OpenError::NoSuchSample { name: format!("sample:{name}"), known });
        };
        // Addresses contain a hash, but files that belong together are matched by a common name.
        let file = |address: String| {
            let extension = address.rsplit('.').next().unwrap_or_default();
            Some((format!("{name}.{extension}"), absolute(&address, None)?))
        };
        Ok(addresses.iter().filter_map(|address| address.as_string().and_then(file)).collect())
    }

    async fn read(&self, url: &String, name: &str, reading: &mut Reading<'_>) -> Result<Vec<u8>, OpenError> {
        let on_bytes = |bytes: &[u8]| self.early.borrow_mut().iter_mut().for_each(|early| early.notice(name, bytes));
        fetch::fetch(url, name, reading, &on_bytes).await
    }

    async fn read_beside(
        &self,
        base: &String,
        path: &str,
        reading: &mut Reading<'_>,
    ) -> Result<Option<Vec<u8>>, OpenError> {
        let Some(url) = absolute(&escaped(path), Some(base)) else { return Ok(None) };
        match fetch::fetch(&url, path, reading, &|_| ()).await {
            // Some hosts answer with an HTML page instead of an error.
            Ok(bytes) => Ok(Some(bytes).filter(|bytes| !is_html(bytes))),
            Err(error @ OpenError::TooLarge { .. }) => Err(error),
            Err(error) => {
                web_sys::console::warn_1(&error.to_string().into());
                Ok(None)
            }
        }
    }

    async fn convert(&self, preparation: &Preparation, reading: &mut Reading<'_>) -> Result<Answer, OpenError> {
        parts::convert(preparation, reading).await
    }

    fn start_decoding(&self, images: &[Image]) -> Vec<images::Decoding> {
        images::start(images, self.limits)
    }

    async fn finish_decoding(
        &self,
        decoding: Vec<images::Decoding>,
        asset: &mut Asset,
        is_only: bool,
    ) -> Vec<Option<ImageData>> {
        images::finish(decoding, asset, self.limits, self.on_image.filter(|_| is_only)).await
    }

    fn describe_omission(&self, _part: &str, error: &OpenError) -> String {
        error.to_string()
    }
}

fn is_html(bytes: &[u8]) -> bool {
    let text = bytes.trim_ascii_start();
    let begins = |with: &[u8]| text.get(..with.len()).is_some_and(|start| start.eq_ignore_ascii_case(with));
    begins(b"<!doctype html") || begins(b"<html")
}

/// Escapes everything in a relative path that has a meaning in a URL.
fn escaped(path: &str) -> String {
    let segments = path.split('/').map(|segment| String::from(js_sys::encode_uri_component(segment)));
    let path = segments.collect::<Vec<_>>().join("/");
    // Without the dot, a colon in the first segment would make it a scheme.
    format!("./{path}")
}

/// Resolves `url` against `base`, by default the page, and replaces a web page about a file by the file itself.
fn absolute(url: &str, base: Option<&str>) -> Option<String> {
    let page = web_sys::window().and_then(|window| window.location().href().ok());
    let url = web_sys::Url::new_with_base(url, base.or(page.as_deref())?).ok()?.href();
    Some(raw_address(&url).into_owned())
}

/// Returns the last part of a URL's path, unescaped.
fn file_name(url: &str) -> String {
    let path = url.split(['?', '#']).next().unwrap_or(url);
    let last = path.rsplit('/').find(|part| !part.is_empty()).unwrap_or(path);
    percent_encoding::percent_decode_str(last).decode_utf8_lossy().into_owned()
}
