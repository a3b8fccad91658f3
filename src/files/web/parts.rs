//! Parts of Gaitway in separate modules, downloaded when a file needs them.

use gaitway_formats::{Part, Preparation};
use gaitway_part::{Answer, decode};
use js_sys::{Promise, Uint8Array};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;

use super::{absolute, fetch};
use crate::files::OpenError;
use crate::files::source::Reading;

#[wasm_bindgen]
extern "C" {
    /// `None` if the page was built without the part.
    #[wasm_bindgen(js_namespace = ["gaitway", "parts"], js_name = url)]
    fn part_url(name: &str) -> Option<String>;

    /// Runs a part in a worker. Rejects if it traps or takes too long.
    #[wasm_bindgen(js_namespace = ["gaitway", "parts"], js_name = run)]
    fn run_part(name: &str, module: Uint8Array, input: Uint8Array) -> Promise;
}

/// Downloads the part and runs it.
pub async fn convert(preparation: &Preparation, reading: &mut Reading<'_>) -> Result<Answer, OpenError> {
    let part = preparation.part;
    let module = download(part, reading).await.map_err(|problem| {
        let file = preparation.file().to_owned();
        OpenError::PartMissing { file, part: part.title(), problem }
    })?;
    Ok(finish(part, start(part, &module, &preparation.input)).await)
}

/// Returns the part's module, or why it is unavailable.
pub async fn download(part: Part, reading: &mut Reading<'_>) -> Result<Vec<u8>, String> {
    let url = part_url(part.name()).and_then(|url| absolute(&url, None));
    let url = url.ok_or("this page was built without it")?;
    fetch::fetch(&url, part.title(), reading, &|_| ()).await.map_err(|problem| problem.to_string())
}

/// Starts a part in a separate worker; [`finish`] waits for it.
pub fn start(part: Part, module: &[u8], input: &[u8]) -> JsFuture {
    run_part(part.name(), module.into(), input.into()).into()
}

/// Returns the answer of a part that was started.
pub async fn finish(part: Part, running: JsFuture) -> Answer {
    match running.await {
        Ok(encoded) => decode(&Uint8Array::from(encoded).to_vec()),
        Err(problem) => {
            let named = |error: js_sys::Error| (String::from(error.name()), String::from(error.message()));
            let (name, message) = problem.dyn_into().map_or_else(|_| Default::default(), named);
            let title = part.title();
            // The shell throws this if the module isn't the one the page was built with.
            Err(match name == "ChangedPart" {
                true => format!("the {title} is damaged or from another version: {message}"),
                false => format!("the {title} stopped ({message}); the file may be damaged"),
            })
        }
    }
}
