//! Fetches files with progress, a budget and errors that say what to do.

use js_sys::{Promise, Reflect, Uint8Array};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;

use super::within;
use crate::files::OpenError;
use crate::files::source::Reading;

/// A site that sends nothing for this long has given up.
const MAX_SILENT_SECS: u32 = 20;

/// Calls `on_bytes` with all that has arrived, whenever more of it has.
pub async fn fetch(
    url: &str,
    name: &str,
    reading: &mut Reading<'_>,
    on_bytes: &dyn Fn(&[u8]),
) -> Result<Vec<u8>, OpenError> {
    (reading.progress)(name, 0, 0);
    let unreachable = || OpenError::Unreachable { url: url.to_owned() };
    let window = web_sys::window().ok_or_else(unreachable)?;
    let silent = || OpenError::Silent { url: url.to_owned(), secs: MAX_SILENT_SECS };
    let response = match unless_silent(window.fetch_with_str(url)).await.ok_or_else(silent)? {
        Ok(response) => response,
        Err(_) => return Err(why_not_fetched(&window, url).await),
    };
    let response: web_sys::Response = response.dyn_into().map_err(|_| unreachable())?;
    if !response.ok() {
        return Err(OpenError::Status { url: url.to_owned(), status: response.status() });
    }
    let header = |name: &str| response.headers().get(name).ok().flatten();
    // The length of a compressed transfer is not that of the decoded bytes.
    let total = match header("content-encoding") {
        None => header("content-length").and_then(|length| length.parse::<u64>().ok()).unwrap_or(0),
        Some(_) => 0,
    };
    reading.check(name, total)?;
    let mut bytes: Vec<u8> = Vec::with_capacity(total as usize);
    let Some(body) = response.body() else { return Ok(bytes) };
    let mut download = Download { reader: body.get_reader().unchecked_into(), is_over: false };
    loop {
        let broke_off = |received: usize| OpenError::BrokeOff { url: url.to_owned(), received: received as u64 };
        let chunk = unless_silent(download.reader.read()).await.ok_or_else(silent)?;
        download.is_over = chunk.is_err();
        let chunk = chunk.map_err(|_| broke_off(bytes.len()))?;
        if Reflect::get(&chunk, &"done".into()).is_ok_and(|done| done.is_truthy()) {
            break;
        }
        let value = Reflect::get(&chunk, &"value".into()).map_err(|_| broke_off(bytes.len()))?;
        let value: Uint8Array = value.dyn_into().map_err(|_| broke_off(bytes.len()))?;
        reading.spend(name, u64::from(value.length()))?;
        let start = bytes.len();
        bytes.resize(start + value.length() as usize, 0);
        value.copy_to(&mut bytes[start..]);
        let received = bytes.len() as u64;
        (reading.progress)(name, received, if received > total { 0 } else { total });
        on_bytes(&bytes);
    }
    Ok(bytes)
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
        Ok(_) => OpenError::Refused { url: url.to_owned() },
        Err(_) => OpenError::Unreachable { url: url.to_owned() },
    }
}
