//! Models on the page: fetched by URL together with the files they name beside themselves, or from buffers that were
//! dropped; images are decoded by the browser. Nothing is sent anywhere.

use std::cell::Cell;

use js_sys::{Array, Promise, Reflect, Uint8Array};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;

use super::image_limit::{fitted, made_smaller};
use super::sort::{Origins, sort_noticing_images};
use super::{Role, SortError, raw_address, read_map};
use crate::asset::{Asset, Image, Warning};
use crate::editor::{Contents, container_of};
use crate::formats::{FileSet, missing_files};
use crate::library::{ImageData, Model, Motion};
use crate::samples;
use crate::state::{MotionMap, ViewerState};

/// What is to be opened: one part of a set.
#[derive(Debug)]
pub enum Item {
    /// Absolute, relative to the page, or `sample:NAME`.
    Url(String),
    /// A path, `/` between folders, with the content.
    File(String, Vec<u8>),
}

/// Why nothing could be opened; each names the file and, when known, what to do.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    #[error("there is nothing to open: expected files or addresses")]
    Nothing,
    #[error("sample:{name}: there is no such sample; there are: {known}")]
    NoSuchSample { name: String, known: String },
    #[error("{url}: this is not an address; expected one such as https://example.org/character.glb")]
    NotAnAddress { url: String },
    #[error("{url}: the server answered {status}{}", hint(*status))]
    Status { url: String, status: u16 },
    #[error(
        "{url}: the site is there, but it does not let other pages read this file (CORS), or there is no such file; \
         download the file and drop it here instead"
    )]
    Refused { url: String },
    #[error("{url}: the site cannot be reached; check the address and the connection")]
    Unreachable { url: String },
    #[error(
        "{url}: nothing has come from the site for {secs} seconds; try again later, or download the file and drop it here"
    )]
    Silent { url: String, secs: u32 },
    #[error("{url}: a page that came over https may not read http addresses; try the same address with https")]
    Insecure { url: String },
    #[error("{url}: the connection broke off after {received} bytes")]
    BrokeOff { url: String, received: u64 },
    #[error("{name}: more than {most} bytes together, which a browser cannot hold; try the window (`gaitway FILE`)")]
    TooLarge { name: String, most: u64 },
    #[error(transparent)]
    Files(#[from] SortError),
}

fn hint(status: u16) -> &'static str {
    match status {
        401 | 403 => " (not allowed); download the file and drop it here instead",
        404 | 410 => " (there is no such file)",
        _ => "",
    }
}

const MOST_BYTES: u64 = 1 << 30;
const MOST_IMAGE_BYTES: u64 = 1 << 30;
/// A site that sends nothing for so long has given up.
const MOST_SILENT_SECS: u32 = 20;
const MOST_PIXELS_ACROSS: u32 = 16_384;
/// Files that name further files, one round each.
const MOST_ROUNDS: usize = 4;

/// Opens one set. `progress` is told the name of the file on its way, the bytes received, and the total (0: not known).
pub async fn open_items(
    items: Vec<Item>,
    role: Role,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<Contents, OpenError> {
    let source = source_of(&items).ok_or(OpenError::Nothing)?;
    let mut origins = Origins { other: container_of(&source).to_owned(), ..Origins::default() };
    let mut set = FileSet::default();
    let mut samples: Vec<Model> = Vec::new();
    let mut bases = Vec::new();
    let mut bytes_left = MOST_BYTES;
    for item in items {
        match item {
            Item::File(name, bytes) => {
                let too_large = || OpenError::TooLarge { name: name.clone(), most: MOST_BYTES };
                bytes_left = bytes_left.checked_sub(bytes.len() as u64).ok_or_else(too_large)?;
                origins.known.push((name.clone(), name.clone()));
                set.insert(name, bytes);
            }
            Item::Url(url) => {
                if let Some(name) = url.strip_prefix("sample:") {
                    if let Some(sample) = samples::load(name) {
                        samples.push(sample);
                        origins.known.push((url.clone(), url));
                        continue;
                    }
                    for (file, address) in files_of_sample(name)? {
                        let bytes = fetch(&address, &file, &mut bytes_left, progress).await?;
                        origins.known.push((file.clone(), url.clone()));
                        set.insert(file, bytes);
                    }
                    continue;
                }
                let base = absolute(&url, None).ok_or_else(|| OpenError::NotAnAddress { url: url.clone() })?;
                let name = file_name(&base);
                let name = if set.get(&name).is_some() { url.clone() } else { name };
                let bytes = fetch(&base, &name, &mut bytes_left, progress).await?;
                origins.known.push((name.clone(), url));
                set.insert(name, bytes);
                bases.push(base);
            }
        }
    }
    fetch_beside(&mut set, &bases, &mut bytes_left, progress).await?;
    // Files beside a sample that is the model are what it borrows from, whatever they hold.
    let role = if samples.is_empty() || role == Role::Motion { role } else { Role::Any };
    // The browser decodes on other threads while the rest is read here.
    let mut decoding: Vec<(String, Vec<Decoding>)> = Vec::new();
    let mut sorted = if set.is_empty() && !samples.is_empty() {
        Default::default()
    } else {
        sort_noticing_images(&set, role, &mut |name, images| {
            if role != Role::Motion {
                decoding.push((name.to_owned(), start_decoding(images)));
            }
        })?
    };
    let mut models = Vec::new();
    for (name, mut asset) in std::mem::take(&mut sorted.models) {
        let started = decoding.iter_mut().find(|(of, _)| *of == name).map(|(_, started)| std::mem::take(started));
        let started = started.unwrap_or_else(|| start_decoding(&asset.images));
        let images = decoded(&mut asset, started).await;
        models.push(origins.model(&set, name, asset, images));
    }
    Ok(origins.contents(sorted, models, samples, role))
}

/// The files of a sample with their addresses: the shell's `gaitway.samples` lists those that lie beside the page.
fn files_of_sample(name: &str) -> Result<Vec<(String, String)>, OpenError> {
    let table = Reflect::get(&js_sys::global(), &"gaitway".into())
        .and_then(|gaitway| Reflect::get(&gaitway, &"samples".into()))
        .unwrap_or_else(|_| js_sys::Object::new().into());
    let addresses: Option<Array> = Reflect::get(&table, &name.into()).ok().and_then(|list| list.dyn_into().ok());
    let Some(addresses) = addresses else {
        let files = Reflect::own_keys(&table).unwrap_or_default();
        let known = files.iter().filter_map(|name| name.as_string()).chain([samples::WALKER.to_owned()]);
        let known = known.map(|name| format!("sample:{name}")).collect::<Vec<_>>().join(", ");
        return Err(OpenError::NoSuchSample { name: name.to_owned(), known });
    };
    let file = |address: String| {
        let ending = address.rsplit('.').next().unwrap_or_default();
        // The address has a hash in it; files that belong together are found by their common name.
        Some((format!("{name}.{ending}"), absolute(&address, None)?))
    };
    Ok(addresses.iter().filter_map(|address| address.as_string().and_then(file)).collect())
}

/// Opens all that a view lists, but for motions that are `held`; its model only if asked for. A motion or a map that cannot
/// be had is a problem in the answer. Addresses of maps in the view are replaced by what they hold. `progress` is told
/// which part of how many it is.
pub async fn open_view(
    state: &mut ViewerState,
    with_model: bool,
    held: &[Motion],
    progress: &dyn Fn(&str, u64, u64),
) -> Result<Contents, OpenError> {
    let mut contents = Contents::default();
    let files = state.retarget.map.iter().filter(|map| matches!(map, MotionMap::File(_))).count();
    let is_held = |source: &String| held.iter().any(|motion| motion.origin == *source);
    let parts = usize::from(with_model) + state.sources.motion.iter().filter(|source| !is_held(source)).count() + files;
    let part = Cell::new(usize::from(with_model));
    let progress = &|name: &str, received: u64, total: u64| match parts {
        0 | 1 => progress(name, received, total),
        _ => progress(&format!("{} of {parts}: {name}", part.get()), received, total),
    };
    if with_model {
        let items = state.sources.model.iter().map(|model| Item::Url(model.clone())).collect();
        contents = open_items(items, Role::Model, progress).await?;
        if let [named] = &mut state.sources.model[..]
            && !contents.models.iter().any(|opened| opened.model.origin == *named)
        {
            *named = container_of(named).to_owned();
        }
    }
    let mut motions = contents.motions.take().unwrap_or_default();
    // What came with the model out of one archive is not listed.
    let is_of_model = |motion: &&Motion| {
        state.sources.model.iter().any(|model| container_of(model) == motion.origin)
            && !state.sources.motion.contains(&motion.origin)
    };
    motions.extend(held.iter().filter(is_of_model).cloned());
    for source in &state.sources.motion {
        if is_held(source) {
            motions.extend(held.iter().filter(|motion| motion.origin == *source).cloned());
            continue;
        }
        part.set(part.get() + 1);
        match open_items(vec![Item::Url(source.clone())], Role::Motion, progress).await {
            Ok(found) => {
                motions.extend(found.motions.unwrap_or_default());
                contents.map = contents.map.or(found.map);
            }
            Err(error) => contents.problems.push(error.to_string()),
        }
    }
    contents.motions = Some(motions);
    let mut maps = Vec::new();
    for map in state.retarget.map.drain(..) {
        match map {
            MotionMap::File(url) => {
                part.set(part.get() + 1);
                match fetch_map(&url, progress).await {
                    Ok(map) => maps.push(MotionMap::Names(map)),
                    Err(error) => contents.problems.push(error.to_string()),
                }
            }
            map => maps.push(map),
        }
    }
    state.retarget.map = maps;
    Ok(contents)
}

async fn fetch_map(url: &str, progress: &dyn Fn(&str, u64, u64)) -> Result<crate::retarget::JointMap, OpenError> {
    let address = absolute(url, None).ok_or_else(|| OpenError::NotAnAddress { url: url.to_owned() })?;
    let name = file_name(&address);
    let bytes = fetch(&address, &name, &mut MOST_BYTES.clone(), progress).await?;
    Ok(read_map(&name, &bytes)?)
}

/// How the set is called in links and panels: after its model, else after its first part.
fn source_of(items: &[Item]) -> Option<String> {
    const MODELS: [&str; 7] = [".glb", ".gltf", ".vrm", ".vrma", ".bvh", ".obj", ".zip"];
    let names = || {
        items.iter().map(|item| match item {
            Item::Url(name) | Item::File(name, _) => name,
        })
    };
    let is_model = |name: &&String| {
        let name = name.to_lowercase();
        MODELS.iter().any(|ending| name.split(['?', '#']).next().unwrap_or_default().ends_with(ending))
    };
    names().find(is_model).or_else(|| names().next()).cloned()
}

/// Fetches what the set's model names beside itself, next to the address it came from. What is not found there is left to
/// the loader, which says what is missing and whether that matters.
async fn fetch_beside(
    set: &mut FileSet,
    bases: &[String],
    bytes_left: &mut u64,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<(), OpenError> {
    let mut tried: Vec<String> = Vec::new();
    if bases.is_empty() {
        return Ok(());
    }
    for _ in 0..MOST_ROUNDS {
        let missing: Vec<String> = missing_files(set).into_iter().filter(|name| !tried.contains(name)).collect();
        if missing.is_empty() {
            break;
        }
        for name in missing {
            for base in bases {
                let Some(url) = absolute(&escaped(&name), Some(base)) else { continue };
                match fetch(&url, &name, bytes_left, progress).await {
                    // Some hosts answer with a page where there is no such file.
                    Ok(bytes) if is_page(&bytes) => {}
                    Ok(bytes) => {
                        set.insert(name.clone(), bytes);
                        break;
                    }
                    Err(error @ OpenError::TooLarge { .. }) => return Err(error),
                    Err(error) => web_sys::console::warn_1(&error.to_string().into()),
                }
            }
            tried.push(name);
        }
    }
    Ok(())
}

fn is_page(bytes: &[u8]) -> bool {
    let text = bytes.trim_ascii_start();
    let begins = |with: &[u8]| text.get(..with.len()).is_some_and(|start| start.eq_ignore_ascii_case(with));
    begins(b"<!doctype html") || begins(b"<html")
}

/// A relative path with everything escaped that means something in a URL.
fn escaped(path: &str) -> String {
    let segments = path.split('/').map(|segment| String::from(js_sys::encode_uri_component(segment)));
    let path = segments.collect::<Vec<_>>().join("/");
    // A first segment with a colon must not be taken for a scheme.
    format!("./{path}")
}

/// `url` seen from `base`, or from the page; of a page about a file, the file.
fn absolute(url: &str, base: Option<&str>) -> Option<String> {
    let page = web_sys::window().and_then(|window| window.location().href().ok());
    let url = web_sys::Url::new_with_base(url, base.or(page.as_deref())?).ok()?.href();
    Some(raw_address(&url).into_owned())
}

/// The last part of an address, as a person would write it.
fn file_name(url: &str) -> String {
    let path = url.split(['?', '#']).next().unwrap_or(url);
    let last = path.rsplit('/').find(|part| !part.is_empty()).unwrap_or(path);
    percent_encoding::percent_decode_str(last).decode_utf8_lossy().into_owned()
}

async fn fetch(
    url: &str,
    name: &str,
    bytes_left: &mut u64,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<Vec<u8>, OpenError> {
    progress(name, 0, 0);
    let unreachable = || OpenError::Unreachable { url: url.to_owned() };
    let window = web_sys::window().ok_or_else(unreachable)?;
    let silent = || OpenError::Silent { url: url.to_owned(), secs: MOST_SILENT_SECS };
    let response = match unless_silent(&window, window.fetch_with_str(url)).await.ok_or_else(silent)? {
        Ok(response) => response,
        Err(_) => return Err(why_not_fetched(&window, url).await),
    };
    let response: web_sys::Response = response.dyn_into().map_err(|_| unreachable())?;
    if !response.ok() {
        return Err(OpenError::Status { url: url.to_owned(), status: response.status() });
    }
    let header = |name: &str| response.headers().get(name).ok().flatten();
    // The length of a compressed transfer says nothing about the bytes that arrive here.
    let total = match header("content-encoding") {
        None => header("content-length").and_then(|length| length.parse::<u64>().ok()).unwrap_or(0),
        Some(_) => 0,
    };
    let too_large = || OpenError::TooLarge { name: name.to_owned(), most: MOST_BYTES };
    if total > *bytes_left {
        return Err(too_large());
    }
    let mut bytes: Vec<u8> = Vec::with_capacity(total as usize);
    let Some(body) = response.body() else { return Ok(bytes) };
    let reader: web_sys::ReadableStreamDefaultReader = body.get_reader().unchecked_into();
    loop {
        let broke_off = |received: usize| OpenError::BrokeOff { url: url.to_owned(), received: received as u64 };
        let Some(chunk) = unless_silent(&window, reader.read()).await else {
            // The connection is not needed any more; that it ends is nobody's concern.
            let _ = reader.cancel();
            return Err(silent());
        };
        let chunk = chunk.map_err(|_| broke_off(bytes.len()))?;
        if Reflect::get(&chunk, &"done".into()).is_ok_and(|done| done.is_truthy()) {
            break;
        }
        let value = Reflect::get(&chunk, &"value".into()).map_err(|_| broke_off(bytes.len()))?;
        let value: Uint8Array = value.dyn_into().map_err(|_| broke_off(bytes.len()))?;
        *bytes_left = bytes_left.checked_sub(u64::from(value.length())).ok_or_else(too_large)?;
        let start = bytes.len();
        bytes.resize(start + value.length() as usize, 0);
        value.copy_to(&mut bytes[start..]);
        let received = bytes.len() as u64;
        progress(name, received, if received > total { 0 } else { total });
    }
    Ok(bytes)
}

/// What a promise of some object comes to; none when it takes too long.
async fn unless_silent(window: &web_sys::Window, promise: Promise) -> Option<Result<JsValue, JsValue>> {
    let mut timer = None;
    let limit = Promise::new(&mut |resolve, _| {
        let millis = 1000 * MOST_SILENT_SECS as i32;
        timer = window.set_timeout_with_callback_and_timeout_and_arguments_0(&resolve, millis).ok();
    });
    let answer = JsFuture::from(Promise::race(&Array::of2(&promise, &limit))).await;
    timer.inspect(|&timer| window.clear_timeout_with_handle(timer));
    let is_late = answer.as_ref().is_ok_and(JsValue::is_undefined);
    (!is_late).then_some(answer)
}

/// Browsers say no more than that it failed. A request whose answer nobody may read still tells whether there is one.
async fn why_not_fetched(window: &web_sys::Window, url: &str) -> OpenError {
    let is_https = window.location().protocol().is_ok_and(|protocol| protocol == "https:");
    let host = url.strip_prefix("http://").and_then(|rest| rest.split(['/', ':', '?', '#']).next());
    // Browsers take this machine's own servers for safe.
    let is_safe =
        host.is_some_and(|host| host == "localhost" || host.ends_with(".localhost") || host.starts_with("127."));
    if is_https && host.is_some() && !is_safe {
        return OpenError::Insecure { url: url.to_owned() };
    }
    let probe = web_sys::RequestInit::new();
    probe.set_method("HEAD");
    probe.set_mode(web_sys::RequestMode::NoCors);
    match JsFuture::from(window.fetch_with_str_and_init(url, &probe)).await {
        Ok(_) => OpenError::Refused { url: url.to_owned() },
        Err(_) => OpenError::Unreachable { url: url.to_owned() },
    }
}

/// An image on its way, or why there will be none. Not to wait for it is fine.
type Decoding = Result<JsFuture, String>;

fn start_decoding(images: &[Image]) -> Vec<Decoding> {
    let mut bytes_left = MOST_IMAGE_BYTES;
    images.iter().map(|image| start_decoding_one(image, &mut bytes_left)).collect()
}

/// One entry per image of the asset. What cannot be decoded is none, and a warning of the asset says why.
async fn decoded(asset: &mut Asset, decoding: Vec<Decoding>) -> Vec<Option<ImageData>> {
    let name = |asset: &Asset, index: usize| {
        let name = asset.images.get(index).map(|image| image.name.clone()).filter(|name| !name.is_empty());
        name.unwrap_or_else(|| index.to_string())
    };
    let mut decoded = Vec::with_capacity(decoding.len());
    for (index, image) in decoding.into_iter().enumerate() {
        let bitmap = match image {
            Ok(image) => image
                .await
                .map_err(|_| "the browser cannot decode it".to_owned())
                .and_then(|bitmap| bitmap.dyn_into().map_err(|_| "the browser cannot decode it".to_owned())),
            Err(problem) => Err(problem),
        };
        match bitmap {
            Ok(bitmap) => {
                if let Some(whole) = asset.images.get(index).map(|image| [image.width, image.height])
                    && let Some(shown) = fitted(whole[0], whole[1])
                {
                    asset.warnings.push(made_smaller(&name(asset, index), whole, shown));
                }
                decoded.push(Some(ImageData::Bitmap(bitmap)));
            }
            Err(problem) => {
                let image = name(asset, index);
                asset.warnings.push(Warning::ImageUnreadable { image, problem });
                decoded.push(None);
            }
        }
    }
    decoded
}

/// What the header says is checked first: the browser would take any amount of memory.
fn start_decoding_one(image: &Image, bytes_left: &mut u64) -> Decoding {
    let bytes = 4 * u64::from(image.width) * u64::from(image.height);
    if bytes == 0 || image.width.max(image.height) > MOST_PIXELS_ACROSS || bytes > *bytes_left {
        return Err(format!("{} × {} pixels", image.width, image.height));
    }
    *bytes_left -= bytes;
    let failed = |_: JsValue| "the browser cannot decode it".to_owned();
    let parts = Array::of1(&Uint8Array::from(&image.bytes[..]));
    let blob = web_sys::Blob::new_with_u8_array_sequence(&parts).map_err(failed)?;
    let options = web_sys::ImageBitmapOptions::new();
    options.set_premultiply_alpha(web_sys::PremultiplyAlpha::None);
    options.set_color_space_conversion(web_sys::ColorSpaceConversion::None);
    if let Some([width, height]) = fitted(image.width, image.height) {
        options.set_resize_width(width);
        options.set_resize_height(height);
    }
    let window = web_sys::window().ok_or_else(|| "there is no window".to_owned())?;
    let bitmap = window.create_image_bitmap_with_blob_and_image_bitmap_options(&blob, &options).map_err(failed)?;
    Ok(JsFuture::from(bitmap))
}
