//! Fetches files with progress, a budget and errors that say what to do.

use js_sys::{Promise, Reflect, Uint8Array};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;

use super::within;
use crate::files::OpenError;
use crate::files::source::Reading;

/// A site that sends nothing for this long has given up.
const MAX_SILENT_SECS: u32 = 20;

/// How much of the program's own memory, which never shrinks, a download may take before it is complete, in bytes.
const BLOCK_BYTES: u32 = 64 << 20;

#[wasm_bindgen]
extern "C" {
    /// Returns whether the user may drop files.
    #[wasm_bindgen(js_namespace = gaitway, js_name = allowsFiles)]
    fn allows_files() -> bool;
}

/// Calls `on_bytes` with all that has arrived, whenever more of it has, but at most with the first [`BLOCK_BYTES`].
pub async fn fetch(
    url: &str,
    name: &str,
    reading: &mut Reading<'_>,
    on_bytes: &dyn Fn(&[u8]),
) -> Result<Vec<u8>, OpenError> {
    (reading.progress)(name, 0, 0);
    let unreachable = || OpenError::Unreachable { url: url.to_owned() };
    let window = web_sys::window().ok_or_else(unreachable)?;
    let silent = || OpenError::Silent { url: url.to_owned(), secs: MAX_SILENT_SECS, may_drop: allows_files() };
    let response = match unless_silent(window.fetch_with_str(url)).await.ok_or_else(silent)? {
        Ok(response) => response,
        Err(_) => return Err(why_not_fetched(&window, url).await),
    };
    let response: web_sys::Response = response.dyn_into().map_err(|_| unreachable())?;
    if !response.ok() {
        return Err(OpenError::Status { url: url.to_owned(), status: response.status(), may_drop: allows_files() });
    }
    let header = |name: &str| response.headers().get(name).ok().flatten();
    // The length of a compressed transfer is not that of the decoded bytes.
    let total = match header("content-encoding") {
        None => header("content-length").and_then(|length| length.parse::<u64>().ok()).unwrap_or(0),
        Some(_) => 0,
    };
    reading.check(name, total)?;
    let mut received = Received::default();
    let Some(body) = response.body() else { return Ok(Vec::new()) };
    let mut download = Download { reader: body.get_reader().unchecked_into(), is_over: false };
    loop {
        let broke_off = || OpenError::BrokeOff { url: url.to_owned(), received: received.length.into() };
        let chunk = unless_silent(download.reader.read()).await.ok_or_else(silent)?;
        download.is_over = chunk.is_err();
        let chunk = chunk.map_err(|_| broke_off())?;
        if Reflect::get(&chunk, &"done".into()).is_ok_and(|done| done.is_truthy()) {
            break;
        }
        let value = Reflect::get(&chunk, &"value".into()).map_err(|_| broke_off())?;
        let value: Uint8Array = value.dyn_into().map_err(|_| broke_off())?;
        reading.spend(name, u64::from(value.length()))?;
        received.add(&value);
        let length = received.length.into();
        (reading.progress)(name, length, if length > total { 0 } else { total });
        on_bytes(&received.start);
    }
    Ok(received.whole())
}

/// What has arrived of a file. The announced length isn't trusted, so memory grows with what arrives; past the first block it is the
/// browser's, which takes it back when a download fails or never ends.
#[derive(Default)]
struct Received {
    /// The first [`BLOCK_BYTES`].
    start: Vec<u8>,
    /// The rest, in blocks of that size.
    blocks: Vec<Uint8Array>,
    length: u32,
}

impl Received {
    fn add(&mut self, chunk: &Uint8Array) {
        let mut from = 0;
        while from < chunk.length() {
            let filled = self.length % BLOCK_BYTES;
            let to = chunk.length().min(from + BLOCK_BYTES - filled);
            let piece = chunk.subarray(from, to);
            if self.length < BLOCK_BYTES {
                push(&mut self.start, &piece);
            } else {
                if filled == 0 {
                    self.blocks.push(Uint8Array::new_with_length(BLOCK_BYTES));
                }
                self.blocks.iter().last().into_iter().for_each(|block| block.set(&piece, filled));
            }
            self.length += to - from;
            from = to;
        }
    }

    fn whole(self) -> Vec<u8> {
        let mut bytes = self.start;
        bytes.reserve_exact(self.length as usize - bytes.len());
        for block in self.blocks {
            let left = self.length - bytes.len() as u32;
            push(&mut bytes, &block.subarray(0, left.min(BLOCK_BYTES)));
        }
        bytes
    }
}

fn push(bytes: &mut Vec<u8>, piece: &Uint8Array) {
    let start = bytes.len();
    bytes.resize(start + piece.length() as usize, 0);
    piece.copy_to(&mut bytes[start..]);
}

/// A download that ends when it is dropped: when the site has gone silent, or the user has cancelled it.
struct Download {
    reader: web_sys::ReadableStreamDefaultReader,
    /// The connection broke off, and can't be closed.
    is_over: bool,
}

impl Drop for Download {
    fn drop(&mut self) {
        if !self.is_over {
            let _ = self.reader.cancel();
        }
    }
}

/// Awaits a promise; `None` if it takes too long.
async fn unless_silent(promise: Promise) -> Option<Result<JsValue, JsValue>> {
    within(JsFuture::from(promise), 1000 * MAX_SILENT_SECS as i32).await.ok()
}

/// Finds out why a request failed, which browsers do not say: an opaque request still tells whether the site answers.
async fn why_not_fetched(window: &web_sys::Window, url: &str) -> OpenError {
    let is_https = window.location().protocol().is_ok_and(|protocol| protocol == "https:");
    let host = url.strip_prefix("http://").and_then(|rest| rest.split(['/', ':', '?', '#']).next());
    // Browsers treat servers on the same machine as secure.
    let is_safe =
        host.is_some_and(|host| host == "localhost" || host.ends_with(".localhost") || host.starts_with("127."));
    if is_https && host.is_some() && !is_safe {
        return OpenError::Insecure { url: url.to_owned() };
    }
    let probe = web_sys::RequestInit::new();
    probe.set_method("HEAD");
    probe.set_mode(web_sys::RequestMode::NoCors);
    match JsFuture::from(window.fetch_with_str_and_init(url, &probe)).await {
        Ok(_) => OpenError::Refused { url: url.to_owned(), may_drop: allows_files() },
        Err(_) => OpenError::Unreachable { url: url.to_owned() },
    }
}
