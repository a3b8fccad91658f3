//! Parts of Gaitway that are modules of their own, downloaded when a file needs them.

use gaitway_part::{Answer, decode};
use js_sys::{JsString, Uint8Array};
use wasm_bindgen::prelude::*;

use super::{absolute, fetch};
use crate::files::OpenError;
use crate::files::source::Reading;
use crate::formats::Preparation;

#[wasm_bindgen]
extern "C" {
    /// `None` if the page was built without the part.
    #[wasm_bindgen(js_namespace = ["gaitway", "parts"], js_name = url)]
    fn part_url(name: &str) -> Option<String>;

    /// Runs a part in a worker. Rejects if it traps or takes too long.
    #[wasm_bindgen(js_namespace = ["gaitway", "parts"], js_name = run, catch)]
    async fn run_part(name: &str, module: Uint8Array, input: Uint8Array) -> Result<JsValue, JsValue>;
}

/// Downloads the part and runs it.
pub async fn convert(preparation: &Preparation, reading: &mut Reading<'_>) -> Result<Answer, OpenError> {
    let part = preparation.part;
    let missing = |problem: String| {
        let file = preparation.file().to_owned();
        OpenError::PartMissing { file, part: part.title(), problem }
    };
    let url = part_url(part.name()).and_then(|url| absolute(&url, None));
    let url = url.ok_or_else(|| missing("this page was built without it".to_owned()))?;
    let module = fetch::fetch(&url, part.title(), reading).await.map_err(|problem| missing(problem.to_string()))?;
    let (module, input) = (Uint8Array::from(&module[..]), Uint8Array::from(&preparation.input[..]));
    Ok(match run_part(part.name(), module, input).await {
        Ok(encoded) => decode(&Uint8Array::from(encoded).to_vec()),
        Err(problem) => {
            let problem =
                problem.dyn_into::<js_sys::Error>().map_or_else(|_| JsString::from(""), |error| error.message());
            Err(format!("the {} stopped ({problem}); the file may be damaged", part.title()))
        }
    })
}
