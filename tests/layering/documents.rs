//! What the documents say about the sources stays true: paths exist, tables match, and lists of files to touch are complete.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::{RANKS, sources};

/// Maximum size of ARCHITECTURE.md in bytes: it is an overview, and decisions are documented in the modules.
const MAX_OVERVIEW_BYTES: usize = 10_000;

/// The most files in `src` and `crates` that adding something may touch, besides tests.
const MAX_FILES: usize = 10;

/// A section of CONTRIBUTING.md, and an example of what it adds: each file below the folders that has this text is listed.
const SECTIONS: [(&str, &str, &[&str]); 5] = [
    ("A file format", ".fbx, .x", &["src", "crates", "web", "python/src"]),
    ("A part", "\"npz\"", &["src", "crates", "xtask"]),
    // What is drawn with it belongs to the feature, not to the key.
    ("A link key", "exposure", &["crates/scene/src/state", "src/ui", "web/shell"]),
    ("A change of clips", "loop_secs", &["src", "crates"]),
    ("A command", "SetExposure", &["src", "crates"]),
];

fn read(path: impl AsRef<Path>) -> String {
    let path = path.as_ref();
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Returns the part of a document below a heading, up to the next heading of any level.
fn section<'a>(text: &'a str, heading: &str) -> &'a str {
    let start = text.find(&format!("# {heading}\n")).unwrap_or_else(|| panic!("no section “{heading}”"));
    let body = &text[start + 2 + heading.len()..];
    &body[..body.find("\n#").unwrap_or(body.len())]
}

/// Returns the text without the blocks that three backticks enclose.
fn without_blocks(text: &str) -> String {
    text.split("```").step_by(2).collect()
}

/// Returns the paths of files and folders in backticks.
fn paths(text: &str) -> BTreeSet<&str> {
    const FOLDERS: [&str; 11] =
        ["src", "crates", "parts", "tests", "web", "python", "xtask", "docs", "shaders", "assets", "fuzz"];
    let is_path = |span: &str| {
        let is_plain = span.chars().all(|c| c.is_alphanumeric() || "/._-".contains(c));
        is_plain && (FOLDERS.contains(&span.split('/').next().unwrap_or_default()) || span.ends_with(".md"))
    };
    text.split('`').skip(1).step_by(2).filter(|span| is_path(span)).map(|span| span.trim_end_matches('/')).collect()
}

/// Whether the file is one that a contributor is to write.
fn is_new(path: &str) -> bool {
    path.rsplit('/').next().is_some_and(|name| name.starts_with("your"))
}

/// Returns the paths that lead nowhere. A new file needs a folder to be in.
fn missing<'a>(paths: &BTreeSet<&'a str>) -> Vec<&'a str> {
    let exists = |path: &str| match Path::new(path).parent().filter(|_| is_new(path)) {
        Some(folder) => folder.is_dir() && !Path::new(path).exists(),
        None => Path::new(path).exists(),
    };
    paths.iter().copied().filter(|path| !exists(path)).collect()
}

/// Returns the scripts and sources below a folder that have a text, without tests.
fn mentions(text: &str, folders: &[&str]) -> BTreeSet<String> {
    let mut files = Vec::new();
    folders.iter().for_each(|folder| sources(Path::new(folder), &["rs", "js", "ts"], &mut files));
    let paths = files.into_iter().filter(|file| read(file).contains(text));
    let paths = paths.map(|file| file.to_string_lossy().replace('\\', "/"));
    paths.filter(|path| !path.contains("/tests")).collect()
}

/// Returns the headings as GitHub makes anchors of them.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = text.lines().filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    let anchor = |heading: &str| -> String {
        let kept = heading.to_lowercase();
        let kept = kept.chars().filter(|&c| c.is_alphanumeric() || " -_".contains(c));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    headings.map(anchor).collect()
}

fn documents() -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = ["README", "ARCHITECTURE", "CHANGELOG", "CONTRIBUTING", "SECURITY"]
        .map(|name| format!("{name}.md").into())
        .into();
    sources(Path::new("docs"), &["md"], &mut files);
    files
}

#[test]
fn paths_are_found_in_text() {
    let text = "Read `src/lib.rs`, `web/shell/`, `README.md` and `mod.rs`; run `cargo xtask test` on `parts/*`.";
    assert_eq!(paths(text), BTreeSet::from(["README.md", "src/lib.rs", "web/shell"]));
    assert_eq!(missing(&paths("`src/none.rs` and `src/lib.rs`")), ["src/none.rs"]);
    assert_eq!(
        missing(&paths("`crates/formats/tests/formats/yourformat.rs` and `none/yourfile.rs`, `src/none/yourfile.rs`")),
        ["src/none/yourfile.rs"]
    );
    assert_eq!(section("# A\n## B c\ntext\n### D\nmore\n", "B c"), "\ntext");
    assert_eq!(without_blocks("a ```sh\nb\n``` c"), "a  c");
    assert!(anchors("## Pins and gaze\n").contains("pins-and-gaze"));
}

#[test]
fn what_documents_name_exists() {
    for name in ["ARCHITECTURE.md", "CONTRIBUTING.md", "SECURITY.md"] {
        let text = without_blocks(&read(name));
        let paths = paths(&text);
        assert!(paths.len() > 20, "{name}: {paths:?}");
        assert!(missing(&paths).is_empty(), "{name} names {:?}", missing(&paths));
    }
}

#[test]
fn links_between_documents_lead_somewhere() {
    let mut count = 0;
    for document in documents() {
        let text = without_blocks(&read(&document));
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if link.contains(':') || link.is_empty() {
                continue;
            }
            let (path, anchor) = link.split_once('#').map_or((link, None), |(path, anchor)| (path, Some(anchor)));
            let target =
                if path.is_empty() { document.clone() } else { document.parent().unwrap_or(Path::new("")).join(path) };
            assert!(target.exists(), "{}: {link}", document.display());
            if let Some(anchor) = anchor.filter(|_| target.extension().is_some_and(|extension| extension == "md")) {
                assert!(anchors(&read(&target)).contains(anchor), "{}: {link}", document.display());
            }
            count += 1;
        }
    }
    assert!(count > 30, "only {count} links found");
}

#[test]
fn the_overview_has_the_layers_and_stays_short() {
    let text = read("ARCHITECTURE.md");
    assert!(text.len() <= MAX_OVERVIEW_BYTES, "ARCHITECTURE.md has {} bytes", text.len());
    let mut documented = Vec::new();
    for line in section(&text, "Layers").lines() {
        let mut cells = line.split('|').skip(1).map(str::trim);
        let (Some(rank), Some(modules)) = (cells.next(), cells.next()) else { continue };
        let Ok(rank) = rank.parse::<u32>() else { continue };
        documented.extend(modules.split('`').skip(1).step_by(2).map(|module| (module, rank)));
    }
    let sorted = |ranks: &[(&'static str, u32)]| ranks.iter().copied().collect::<BTreeSet<_>>();
    assert_eq!(documented.iter().copied().collect::<BTreeSet<_>>(), sorted(&RANKS));
}

#[test]
fn what_to_touch_is_listed() {
    let text = without_blocks(&read("CONTRIBUTING.md"));
    for (heading, example, folders) in SECTIONS {
        let listed = paths(section(&text, heading));
        let counted: Vec<&str> = listed
            .iter()
            .copied()
            .filter(|path| path.starts_with("src/") || path.starts_with("crates/") && !path.contains("/tests/"))
            .collect();
        assert!(!counted.is_empty() && counted.len() <= MAX_FILES, "{heading}: {} files: {counted:?}", counted.len());
        let having = mentions(example, folders);
        assert!(having.len() > 2, "{heading}: {example} is in {having:?}");
        let unlisted: Vec<_> = having.iter().filter(|path| !listed.contains(path.as_str())).collect();
        assert!(unlisted.is_empty(), "{heading}: {example} is in {unlisted:?}, which CONTRIBUTING.md doesn't list");
    }
}
