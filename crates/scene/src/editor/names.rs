//! Short display names for files.

use crate::samples;

/// Returns the last part of a path or URL, and where it is; `None` without a path, as of a file that was dropped.
pub fn name_and_place(source: &str) -> (String, Option<String>) {
    if let Some(sample) = source.strip_prefix("sample:") {
        return (samples::title(sample).to_owned(), Some("Sample".to_owned()));
    }
    let source = source.split(['?', '#']).next().unwrap_or(source);
    match source.trim_end_matches('/').rsplit_once(['/', '\\']) {
        Some((place, name)) => (name.to_owned(), Some(place.to_owned())),
        None if source.is_empty() => ("Untitled".to_owned(), Some(String::new())),
        None => (source.to_owned(), None),
    }
}

/// Returns the last part of a path or URL.
pub fn short_name(source: &str) -> String {
    name_and_place(source).0
}

/// Returns a file's short name without its extension.
pub(super) fn stem(source: &str) -> String {
    let name = short_name(source);
    name.rsplit_once('.').map_or(name.clone(), |(stem, _)| stem.to_owned())
}

/// Returns a file name that every system allows: other characters become hyphens.
pub(super) fn plain_name(name: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "-_. ()".contains(letter);
    name.chars().map(|letter| if is_plain(letter) { letter } else { '-' }).collect()
}

pub(super) fn is_obj(name: &str) -> bool {
    name.to_lowercase().ends_with(".obj")
}
