//! Files and addresses that are opened. The page keeps the files themselves; here they have a number and a name.

use percent_encoding::percent_decode_str;
use serde::{Deserialize, Serialize};

/// A file that the page keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FileId(pub u32);

/// Something that the page does, which takes time and is answered by an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct TaskId(pub u32);

/// Somebody who waits for the answer to an opening.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct RequestId(pub u32);

/// What the program is asked to open.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Item {
    /// A URL or a sample.
    Address(String),
    /// A file that the page keeps.
    File(NamedFile),
}

/// A file in memory or on the user's disk.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NamedFile {
    /// What the page knows it by.
    pub id: FileId,
    /// Path inside the folder that was chosen or dropped, or the file's own name.
    pub name: String,
}

impl Item {
    /// Returns the address or the name of the file.
    pub fn name(&self) -> &str {
        match self {
            Self::Address(address) => address,
            Self::File(file) => &file.name,
        }
    }

    /// Returns the name without folders and, of a URL, without its query.
    pub(crate) fn bare_name(&self) -> String {
        file_name(self.name())
    }

    /// Returns which file it is; `None` for an address.
    pub fn id(&self) -> Option<FileId> {
        match self {
            Self::Address(_) => None,
            Self::File(file) => Some(file.id),
        }
    }

    /// Whether it is a .gltf, which refers to other files.
    pub(crate) fn is_gltf(&self) -> bool {
        extension(&self.bare_name()) == "gltf"
    }

    /// Whether a .gltf may refer to it, and it can't be opened by itself.
    pub(crate) fn is_part_of_gltf(&self) -> bool {
        GLTF.contains(&&*extension(&self.bare_name()))
    }

    /// Whether it has a motion and never a model.
    pub(crate) fn is_motion(&self) -> bool {
        ["bvh", "vrma", "npy", "npz"].contains(&&*extension(&self.bare_name()))
    }
}

/// Whether some of the items are files.
pub(crate) fn has_files(items: &[Item]) -> bool {
    items.iter().any(|item| item.id().is_some())
}

/// Lists the items' names for a sentence.
pub(crate) fn names_of(items: &[Item]) -> String {
    list_of(&items.iter().map(Item::bare_name).collect::<Vec<_>>())
}

/// Extensions of what a .gltf refers to.
const GLTF: [&str; 7] = ["bin", "png", "jpg", "jpeg", "webp", "avif", "ktx2"];
/// Extensions of what belongs to an .obj.
const OBJ: [&str; 6] = ["skel", "attach", "mtl", "png", "jpg", "jpeg"];

/// Returns the decoded last part of a path or URL, without its query.
pub(crate) fn file_name(address: &str) -> String {
    let path = address.split(['?', '#']).next().unwrap_or(address);
    let name = path.rsplit('/').next().unwrap_or(path);
    percent_decode_str(name).decode_utf8().map_or_else(|_| name.to_owned(), Into::into)
}

/// Returns what follows the last dot, in lower case.
pub(crate) fn extension(name: &str) -> String {
    name.rsplit_once('.').map_or_else(String::new, |(_, extension)| extension.to_lowercase())
}

/// Describes the files that belong to a file and that a link doesn't name.
pub(crate) fn companion_words(name: &str) -> Option<&'static str> {
    match &*extension(name) {
        "gltf" => Some("its .bin and images"),
        "obj" => Some("its .skel and .attach"),
        _ => None,
    }
}

/// Whether files of the name `other` belong to files of this one.
pub(crate) fn is_companion(name: &str, other: &str) -> bool {
    let extensions: &[&str] = match &*extension(name) {
        "gltf" => &GLTF,
        "obj" => &OBJ,
        _ => &[],
    };
    extensions.contains(&&*extension(other))
}

/// Removes what browsers and systems add to the names of copies: “walk (1).bvh”, “walk copy.bvh”, “walk - Copy (2).bvh”.
pub(crate) fn without_copy(name: &str) -> String {
    let Some((stem, extension)) = name.rsplit_once('.') else { return name.to_owned() };
    let stem = without_number(stem).map_or(stem, |stem| stem.strip_suffix(' ').unwrap_or(stem));
    let stem = stem.strip_suffix(" - Copy").or_else(|| stem.strip_suffix(" copy")).unwrap_or_else(|| {
        let unnumbered = stem.trim_end_matches(|digit: char| digit.is_ascii_digit());
        if unnumbered.len() < stem.len() { unnumbered.strip_suffix(" copy ").unwrap_or(stem) } else { stem }
    });
    format!("{stem}.{extension}")
}

/// Returns what precedes a number in brackets.
fn without_number(stem: &str) -> Option<&str> {
    let (before, number) = stem.strip_suffix(')')?.rsplit_once('(')?;
    let is_number = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then_some(before)
}

/// Names that a sentence lists; more would hide the rest of it.
const MAX_NAMES: usize = 4;

/// Lists names for a sentence: “a, b and c”, or the first few and how many more there are.
pub(crate) fn list_of<S: AsRef<str>>(names: &[S]) -> String {
    let mut listed: Vec<String> = names.iter().take(MAX_NAMES).map(|name| name.as_ref().to_owned()).collect();
    if names.len() > MAX_NAMES {
        listed.push(format!("{} more", names.len() - MAX_NAMES));
    }
    match listed.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => listed.concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_copies_lose_what_was_added() {
        let cases = [
            ("walk.bvh", "walk.bvh"),
            ("walk (1).bvh", "walk.bvh"),
            ("walk(2).bvh", "walk.bvh"),
            ("walk copy.bvh", "walk.bvh"),
            ("walk copy 3.bvh", "walk.bvh"),
            ("walk - Copy.bvh", "walk.bvh"),
            ("walk - Copy (2).bvh", "walk.bvh"),
            ("walk 3.bvh", "walk 3.bvh"),
            ("walk (a).bvh", "walk (a).bvh"),
            ("walk", "walk"),
        ];
        for (name, expected) in cases {
            assert_eq!(without_copy(name), expected, "{name}");
        }
    }

    #[test]
    fn names_are_listed_as_in_a_sentence() {
        assert_eq!(list_of::<&str>(&[]), "");
        assert_eq!(list_of(&["a"]), "a");
        assert_eq!(list_of(&["a", "b"]), "a and b");
        assert_eq!(list_of(&["a", "b", "c"]), "a, b and c");
        assert_eq!(list_of(&["a", "b", "c", "d", "e", "f"]), "a, b, c, d and 2 more");
    }

    #[test]
    fn a_file_goes_by_the_decoded_last_part_of_its_address() {
        let cases = [
            ("https://example.org/a/red%20fox.glb?v=1#x", "red fox.glb"),
            ("folder/Fox.glb", "Fox.glb"),
            ("100%.glb", "100%.glb"),
            ("%ff.glb", "%ff.glb"),
        ];
        for (address, expected) in cases {
            assert_eq!(file_name(address), expected, "{address}");
        }
    }
}
