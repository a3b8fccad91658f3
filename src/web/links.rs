//! The text form of links for the page's scripts: pure functions that need no running app. Lists are passed as JSON text.

use serde_json::json;
use wasm_bindgen::prelude::*;

use crate::state;

/// Returns the files that a link names, as a JSON list of `{role, name, member, isToBring}`; see [`state::LinkedFile`].
#[wasm_bindgen]
pub fn linked_files(link: &str) -> String {
    let files = state::linked_files(link);
    let json = files.iter().map(|file| {
        json!({ "role": file.role.key(), "name": file.name, "member": file.member, "isToBring": file.is_to_bring })
    });
    json!(json.collect::<Vec<_>>()).to_string()
}

/// Returns a key for the files of a link: links with the same key show the same files.
#[wasm_bindgen]
pub fn shown_files(link: &str) -> String {
    state::shown_files(link)
}

/// Returns the link to share: the files named in `local` are marked for the recipient to supply.
#[wasm_bindgen]
pub fn public_link(link: &str, local: Vec<String>) -> String {
    state::public_link(link, &local)
}

/// Returns the link of a page that is embedded in another one.
#[wasm_bindgen]
pub fn embedded_link(link: &str) -> String {
    state::embedded_link(link)
}

/// Returns the part of a link that can be shown before its missing files arrive.
#[wasm_bindgen]
pub fn link_without_missing(link: &str) -> String {
    state::link_without_missing(link)
}

/// Returns a link with the missing files of the one that asks for them, if it shows what could be shown of that one.
#[wasm_bindgen]
pub fn link_with_missing(link: &str, asking: &str) -> String {
    state::link_with_missing(link, asking)
}

/// Returns the link with its missing files renamed to `names`, in the order of [`linked_files`].
#[wasm_bindgen]
pub fn link_with_files(link: &str, names: Vec<String>) -> String {
    state::link_with_files(link, &names)
}

/// Returns the index of the link in `others` that shows the same files in the most similar view.
#[wasm_bindgen]
pub fn most_similar_link(link: &str, others: Vec<String>) -> Option<usize> {
    state::most_similar_link(link, &others)
}
