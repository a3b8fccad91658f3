//! The sample characters. Native builds embed the files of `assets/samples`; the page fetches them from its own folder.
//! The walker is generated in code, so there is always something to show.
//!
//! `assets/samples/gallery.json` lists the scenes of the start screen; page, build and tests read that one table.

mod walker;

use crate::library::Model;

/// The generated sample's name after `sample:`.
pub const WALKER: &str = "walker";

/// What the window opens by default; the page opens the first scene of its gallery.
#[cfg(not(target_arch = "wasm32"))]
pub const FIRST: &str = "sample:pilot";

#[cfg(not(target_arch = "wasm32"))]
include!(concat!(env!("OUT_DIR"), "/samples.rs"));

/// Returns the files of a sample with their contents, by its name after `sample:`; empty for an unknown name.
#[cfg(not(target_arch = "wasm32"))]
pub fn files(name: &str) -> impl Iterator<Item = (&'static str, &'static [u8])> {
    FILES.iter().filter(move |(sample, ..)| *sample == name).map(|&(_, file, bytes)| (file, bytes))
}

/// Returns every name that `sample:NAME` accepts.
#[cfg(not(target_arch = "wasm32"))]
pub fn names() -> Vec<&'static str> {
    let mut names: Vec<&str> = FILES.iter().map(|&(name, ..)| name).chain([WALKER]).collect();
    names.dedup();
    names
}

/// Display titles by name.
const TITLES: [(&str, &str); 9] = [
    ("pilot", "Pilot"),
    ("mannequin", "Mannequin"),
    ("mannequin_run", "Mannequin's run"),
    ("dwarf", "Dwarf"),
    ("walk", "Walk"),
    ("ssd", "Imp"),
    ("creature", "Fox"),
    ("morphs", "Goblin"),
    (WALKER, "Walker"),
];

/// Returns a sample's display title, by its name after `sample:`.
pub fn title(name: &str) -> &str {
    TITLES.iter().find(|(sample, _)| *sample == name).map_or(name, |(_, title)| title)
}

/// Builds a generated sample by its name after `sample:`; none if no such sample is generated.
pub fn load(name: &str) -> Option<Model> {
    (name == WALKER).then(|| Model::new(format!("sample:{name}"), walker::asset(), Vec::new()))
}
