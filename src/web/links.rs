//! The text form of links for the page's scripts: pure functions that need no running app. Lists are passed as JSON text.

use serde_json::json;
use wasm_bindgen::prelude::*;

use crate::state::Link;

/// Returns the files that a link names, as a JSON list of `{role, name, member, isToBring}`; see [`LinkedFile`](crate::state::LinkedFile).
#[wasm_bindgen]
pub fn linked_files(link: &str) -> String {
    let link = Link::from(link);
    let json = link.files().iter().map(|file| {
        json!({ "role": file.role.key(), "name": file.name, "member": file.member, "isToBring": file.is_to_bring })
    });
    json!(json.collect::<Vec<_>>()).to_string()
}

/// Returns a key for the files of a link: links with the same key show the same files.
#[wasm_bindgen]
pub fn shown_files(link: &str) -> String {
    Link::from(link).shown_files()
}

/// Returns the link to share: the files named in `local` are marked for the recipient to supply.
#[wasm_bindgen]
pub fn public_link(link: &str, local: Vec<String>) -> String {
    Link::from(link).public(&local).into()
}

/// Returns the link of a page that is embedded in another one.
#[wasm_bindgen]
pub fn embedded_link(link: &str) -> String {
    Link::from(link).embedded().into()
}

/// Returns the part of a link that can be shown before its missing files arrive.
#[wasm_bindgen]
pub fn link_without_missing(link: &str) -> String {
    Link::from(link).without_missing().into()
}

/// Returns a link with the missing files of the one that asks for them, if it shows what could be shown of that one.
#[wasm_bindgen]
pub fn link_with_missing(link: &str, asking: &str) -> String {
    Link::from(link).with_missing(&asking.into()).into()
}

/// Returns the link with its missing files renamed to `names`, in the order of [`linked_files`].
#[wasm_bindgen]
pub fn link_with_files(link: &str, names: Vec<String>) -> String {
    Link::from(link).with_names(&names).into()
}

/// Returns the index of the link in `others` that shows the same files in the most similar view.
#[wasm_bindgen]
pub fn most_similar_link(link: &str, others: Vec<String>) -> Option<usize> {
    let others: Vec<Link> = others.into_iter().map(Link::from).collect();
    Link::from(link).most_similar(&others)
}
