//! Enforces what Cargo doesn't of the layers: parses the sources for the modules that each module uses, and the documents for
//! what they say about the sources.

mod circles;
mod documents;
mod release;

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

/// A module may use only lower ranks and its own folder. ARCHITECTURE.md has the same table.
const RANKS: [(&str, u32); 19] = [
    ("anim", 0),
    ("json_text", 0),
    ("sort", 0),
    ("avatar", 1),
    ("mesh", 1),
    ("asset", 2),
    ("formats", 3),
    ("retarget", 3),
    ("library", 4),
    ("samples", 5),
    ("state", 5),
    ("frame", 6),
    ("render", 7),
    ("editor", 7),
    ("ui", 8),
    ("files", 8),
    ("app", 9),
    ("cli", 10),
    ("web", 10),
];

/// Modules up to this rank must not use disk, network or clock, of the system or of the browser. `render`, which uploads the
/// browser's images, is the one exception. What comes in packages, GPU and user interface, Cargo keeps from them.
const LAST_CORE_RANK: u32 = 7;

const OUTSIDE: [&str; 8] =
    ["std::fs", "std::net", "std::env", "std::process", "std::time", "Instant::now", "SystemTime", "web_sys"];

fn rank(module: &str) -> Option<u32> {
    RANKS.iter().find(|(name, _)| *name == module).map(|(_, rank)| *rank)
}

/// Removes comments, which may mention anything. URLs in strings are cut off, which is harmless.
fn without_comments(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n")
}

fn identifier(text: &str) -> &str {
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    &text[..end]
}

/// Whether the text contains this word, not just as part of a longer one.
fn names(text: &str, word: &str) -> bool {
    let part_of_word = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(word).any(|(at, _)| {
        !text[..at].chars().next_back().is_some_and(part_of_word)
            && !text[at + word.len()..].chars().next().is_some_and(part_of_word)
    })
}

/// Returns the names directly after each `crate::`, including those in `crate::{a, b::{c, d}}`.
fn modules_used(text: &str) -> Vec<String> {
    let mut modules = Vec::new();
    for (at, _) in text.match_indices("crate::") {
        let before = text[..at].chars().next_back();
        if before.is_some_and(|c| c.is_alphanumeric() || c == '_') {
            continue;
        }
        let rest = &text[at + "crate::".len()..];
        let Some(group) = rest.strip_prefix('{') else {
            modules.push(identifier(rest).to_owned());
            continue;
        };
        let (mut depth, mut start) = (0, true);
        for (at, c) in group.char_indices() {
            match c {
                '}' if depth == 0 => break,
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => start = true,
                c if start && !c.is_whitespace() => {
                    modules.push(identifier(&group[at..]).to_owned());
                    start = false;
                }
                _ => {}
            }
        }
    }
    modules
}

/// Returns the violations of a file. `path` is relative to `src`, with `/`.
fn violations(path: &str, text: &str) -> Vec<String> {
    let text = &without_comments(text);
    let parts: Vec<&str> = path.trim_end_matches(".rs").split('/').filter(|part| *part != "mod").collect();
    let own = parts[0];
    if parts.len() == 1 && (own == "lib" || own == "main") {
        return Vec::new();
    }
    let Some(own_rank) = rank(own) else { return vec![format!("{path}: `{own}` has no rank in this test")] };
    let mut found = Vec::new();
    for used in modules_used(text) {
        match rank(&used) {
            _ if used == own => {}
            Some(rank) if rank < own_rank => {}
            Some(rank) => found.push(format!("{path}: `{own}` ({own_rank}) uses `{used}` ({rank})")),
            None => found.push(format!("{path}: `crate::{used}` is not a module with a rank")),
        }
    }
    // `super` is the only other way out of a module's folder.
    let upwards = "super::".repeat(parts.len());
    if text.contains(&upwards) {
        found.push(format!("{path}: `{upwards}` leaves the module; say `crate::`"));
    }
    if own_rank <= LAST_CORE_RANK && own != "render" {
        // The library stores the browser's decoded images as opaque handles, and readers use its tables of encodings.
        let text = match own {
            "library" => text.replace("web_sys::ImageBitmap", ""),
            "formats" => text.replace("web_sys::TextDecoder", ""),
            _ => text.to_owned(),
        };
        for word in OUTSIDE.iter().filter(|word| names(&text, word)) {
            found.push(format!("{path}: the core must not know `{word}`"));
        }
    }
    let forbidden: &[&str] = match own {
        "render" => &["ViewerState", "state::Command", "state::apply"],
        "ui" => &["state::apply", "std::fs"],
        _ => &[],
    };
    for word in forbidden.iter().filter(|word| names(text, word)) {
        found.push(format!("{path}: `{own}` must not know `{word}`"));
    }
    found
}

fn sources(folder: &Path, extensions: &[&str], files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, extensions, files);
        } else if path.extension().and_then(OsStr::to_str).is_some_and(|extension| extensions.contains(&extension)) {
            files.push(path);
        }
    }
}

/// The packages of the layers: folder, name in paths, and the module that it is unless it has several.
const PACKAGES: [(&str, &str, Option<&str>); 7] = [
    ("crates/character/src", "gaitway_character", None),
    ("crates/json-text/src", "gaitway_json_text", Some("json_text")),
    ("crates/formats/src", "gaitway_formats", Some("formats")),
    ("crates/retarget/src", "gaitway_retarget", Some("retarget")),
    ("crates/scene/src", "gaitway_scene", None),
    ("crates/render/src", "gaitway_render", Some("render")),
    ("src", "gaitway", None),
];

/// Returns path and text as they would be if all packages were one, where each module is a folder.
fn in_one_package(path: &str, text: &str, module: Option<&str>) -> (String, String) {
    let path = match module {
        Some(module) => format!("{module}/{}", path.replace("lib.rs", "mod.rs")),
        None => path.to_owned(),
    };
    let root = |module: Option<&str>| module.map_or("crate".to_owned(), |module| format!("crate::{module}"));
    let mut text = text.replace("crate::", &format!("{}::", root(module)));
    for (_, name, module) in PACKAGES {
        for after in ["::", " as "] {
            text = text.replace(&format!("{name}{after}"), &format!("{}{after}", root(module)));
        }
    }
    (path, text)
}

/// Returns the path and text of every source file, sorted, as if all packages were one.
fn all_sources() -> Vec<(String, String)> {
    let mut all = Vec::new();
    for (root, _, module) in PACKAGES {
        let root = Path::new(root);
        let mut files = Vec::new();
        sources(root, &["rs"], &mut files);
        assert!(!files.is_empty(), "no sources in {}", root.display());
        all.extend(files.into_iter().map(|file| {
            let path = file.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
            in_one_package(&path, &fs::read_to_string(&file).unwrap(), module)
        }));
    }
    assert!(all.len() > 300, "only {} sources found", all.len());
    all.sort();
    all
}

#[test]
fn paths_between_packages_are_those_between_modules() {
    let read = |path, text, module| in_one_package(path, text, module);
    let (path, text) = read("lib.rs", "use crate::gltf::X; use gaitway_character::mesh::Skin;", Some("formats"));
    assert_eq!((&*path, &*text), ("formats/mod.rs", "use crate::formats::gltf::X; use crate::mesh::Skin;"));
    let (path, text) = read("frame/mod.rs", "use gaitway_json_text as text; crate::state::f()", None);
    assert_eq!((&*path, &*text), ("frame/mod.rs", "use crate::json_text as text; crate::state::f()"));
}

#[track_caller]
fn check(path: &str, text: &str, expected: usize) {
    let found = violations(path, text);
    assert_eq!(found.len(), expected, "{path}: {text}: {found:?}");
}

#[test]
fn violations_are_recognized() {
    assert_eq!(
        modules_used(
            "use crate::anim::Clip; use crate::{mesh::{Skin, Bounds}, asset}; pub(crate) fn f() { crate::ui::g() }"
        ),
        ["anim", "mesh", "asset", "ui"]
    );
    check("mesh/skin.rs", "use crate::anim::JointIndex;", 0);
    check("mesh/skin.rs", "use crate::mesh::Bounds; // not crate::ui", 0);
    check("anim/clip.rs", "use crate::mesh::Skin;", 1);
    check("anim/clip.rs", "use super::super::mesh::Skin;", 1);
    check("anim/mod.rs", "use super::mesh::Skin;", 1);
    check("anim/clip.rs", "let now = std::time::Instant::now();", 2);
    check("formats/gltf/mod.rs", "use super::FileSet; use crate::retarget::x;", 1);
    check("formats/gltf/read.rs", "use super::super::FileSet; std::fs::read(path)", 1);
    check("library/image.rs", "Bitmap(web_sys::ImageBitmap)", 0);
    check("library/image.rs", "web_sys::window()", 1);
    check("formats/encoding.rs", "web_sys::TextDecoder::new()", 0);
    check("formats/encoding.rs", "web_sys::window()", 1);
    check("state/view.rs", "pub std_fs: bool, web_sys_like: bool", 0);
    check("state/mod.rs", "Bitmap(web_sys::ImageBitmap)", 1);
    check("render/mod.rs", "use crate::state::ViewerState;", 1);
    check("render/mod.rs", "use crate::editor::Contents;", 1);
    check("editor/mod.rs", "std::fs::read", 1);
    check("editor/mod.rs", "use crate::render::Renderer; use crate::frame::Frame;", 1);
    check("files/mod.rs", "use crate::ui::style;", 1);
    check("elsewhere.rs", "", 1);
    check("lib.rs", "use crate::ui;", 0);
}

#[test]
fn a_package_without_unit_tests_has_none() {
    let mut untested = 0;
    for (root, ..) in PACKAGES {
        let package = Path::new(root).parent().unwrap();
        if fs::read_to_string(package.join("Cargo.toml")).unwrap().contains("[lib]\ntest = false") {
            untested += 1;
            let mut files = Vec::new();
            sources(Path::new(root), &["rs"], &mut files);
            files.retain(|file| fs::read_to_string(file).unwrap().contains("#[test]"));
            assert!(files.is_empty(), "nobody runs the tests in {files:?}");
        }
    }
    assert!(untested > 0, "no package is without unit tests");
}

#[test]
fn modules_use_only_lower_ranks() {
    let mut all = Vec::new();
    for (path, text) in all_sources() {
        all.extend(violations(&path, &text));
    }
    assert!(all.is_empty(), "\n{}", all.join("\n"));
}

/// Names that only these files may use.
const KEPT_IN: [(&str, &[&str]); 2] = [
    // Joint maps by name exist where files and links are read and written; everything else identifies joints by number.
    (
        "JointMapFile",
        &["retarget/", "files/", "editor/contents.rs", "editor/maps.rs", "state/link/values.rs", "state/map_code.rs"],
    ),
    // A pose is sampled once, into the frame; everything else reads it there.
    ("TakeSampler", &["library/mod.rs", "library/take/", "frame/"]),
];

#[test]
fn names_stay_where_they_belong() {
    let all = all_sources();
    for (name, places) in KEPT_IN {
        let users = all.iter().filter(|(_, text)| names(&without_comments(text), name)).map(|(path, _)| path);
        let (inside, outside): (Vec<_>, Vec<_>) =
            users.partition(|path| places.iter().any(|place| path.starts_with(place)));
        assert!(outside.is_empty(), "{name} in {outside:?}");
        for place in places {
            assert!(inside.iter().any(|path| path.starts_with(place)), "{place} no longer uses {name}");
        }
    }
}

/// The groups of `ViewerState`'s fields.
const STATE_GROUPS: [&str; 9] =
    ["character", "inspect", "selection", "camera", "playback", "display", "lighting", "camera_options", "page"];

/// Operators and methods that mutate their left-hand side.
const CHANGES: [&str; 9] = ["+=", "-=", "*=", "|=", "&=", ".push(", ".insert(", ".extend(", ".clear("];

/// Places that change a field of a view state: an assignment to one of its groups, or a mutable borrow of the whole.
fn state_changes(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    if text.contains("&mut ViewerState") {
        found.push("&mut ViewerState".to_owned());
    }
    for (dot, _) in text.match_indices('.') {
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        let receiver = text[..dot].trim_end_matches(is_name).len();
        // egui's visuals have a field of the same name as a group.
        if receiver == dot || &text[receiver..dot] == "visuals" {
            continue;
        }
        let at = receiver;
        let path_end =
            |text: &str| text.find(|c: char| !c.is_alphanumeric() && c != '_' && c != '.').unwrap_or(text.len());
        let path = &text[at..at + path_end(&text[at..])];
        let after = &text[at + path.len()..];
        let is_group = path.split('.').nth(1).is_some_and(|group| STATE_GROUPS.contains(&group));
        let assigned = after.trim_start().strip_prefix('=').is_some_and(|rest| !rest.starts_with(['=', '>']));
        // A path that ends in a call has the method's name at its end.
        let method = path.rsplit_once('.').map(|(_, last)| format!(".{last}("));
        let called = after.starts_with('(') && method.is_some_and(|method| CHANGES.contains(&method.as_str()));
        if is_group && (assigned || called || CHANGES.iter().any(|change| after.trim_start().starts_with(change))) {
            found.push(format!("{path}{}", after.lines().next().unwrap_or_default()));
        }
    }
    found
}

#[test]
fn only_the_editor_changes_the_view() {
    let mut trouble = Vec::new();
    for (path, text) in all_sources() {
        let module = path.split(['/', '.']).next().unwrap_or_default();
        // Lower modules don't know the view state; their fields of the same names are unrelated.
        if rank(module) > rank("state") && module != "editor" {
            let changes = state_changes(&without_comments(&text));
            trouble.extend(changes.into_iter().map(|change| format!("{path}: {change}")));
        }
    }
    assert!(trouble.is_empty(), "only `state` and `editor` change a ViewerState:\n{}", trouble.join("\n"));
}

#[test]
fn changes_of_the_view_are_found() {
    let changing = [
        "self.state.character.playhead.time_secs = 1.0;",
        "state.camera = choice;",
        "state.playback.speed += 1.0;",
        "state.character.sources.model.push(name);",
        "view.character.sources = sources;",
        "next.lighting.key = None;",
        "fn set(state: &mut ViewerState) {}",
    ];
    for text in changing {
        assert!(!state_changes(text).is_empty(), "{text}");
    }
    let reading = [
        "if state.camera == choice {}",
        "state.character.sources.model.iter()",
        "state.playback.speed => 1",
        "let x = state.page.embed;",
    ];
    for text in reading {
        assert!(state_changes(text).is_empty(), "{text}");
    }
}
