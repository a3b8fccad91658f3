//! Finds motions among files, folders and patterns.

use std::fs;
use std::path::{Component, Path, PathBuf};

use gaitway_formats::limits::MAX_FOLDER_DEPTH;
use gaitway_formats::{GLTF_EXTENSIONS, OTHER_MOTION_EXTENSIONS};

use super::failure::{Failure, Outcome};
use super::output::extension_of;
use crate::files::is_below;

/// A motion.
pub(super) struct Input {
    pub file: PathBuf,
    /// Its path relative to the given folder, or its file name.
    pub relative: PathBuf,
}

/// Returns the motions in the order given, those in folders and of patterns sorted. A file given by its name may have any
/// extension. Neither `out_dir`, which may hold the results of an earlier run, nor symbolic links to folders are searched, and
/// symbolic links to files outside the given folder are left out.
pub(super) fn motions(paths: &[PathBuf], out_dir: &Path) -> Outcome<Vec<Input>> {
    let out_dir = fs::canonicalize(out_dir).ok();
    let mut inputs = Vec::new();
    for path in paths {
        let before = inputs.len();
        if path.is_dir() {
            walk(path, path, out_dir.as_deref(), MAX_FOLDER_DEPTH, &mut inputs)?;
        } else if path.exists() || !is_pattern(path) {
            inputs.push(Input { file: path.clone(), relative: path.file_name().unwrap_or_default().into() });
        } else {
            let base = path.components().take_while(|part| !is_pattern(Path::new(part.as_os_str())));
            let base: PathBuf = base.collect();
            let from = if base.as_os_str().is_empty() { PathBuf::from(".") } else { base.clone() };
            let mut found = Vec::new();
            walk(&from, &base, out_dir.as_deref(), MAX_FOLDER_DEPTH, &mut found)?;
            let pattern: Vec<&str> = parts(path);
            inputs.extend(found.into_iter().filter(|input| {
                let file = base.join(&input.relative);
                matches(&pattern, &parts(&file))
            }));
        }
        if inputs.len() == before {
            return Err(Failure::expected("motions", "none").in_file(path.display()));
        }
    }
    Ok(inputs)
}

fn is_pattern(path: &Path) -> bool {
    path.to_str().is_some_and(|text| text.contains(['*', '?']))
}

fn parts(path: &Path) -> Vec<&str> {
    let is_named = |part: &Component<'_>| !matches!(part, Component::CurDir);
    path.components().filter(is_named).filter_map(|part| part.as_os_str().to_str()).collect()
}

/// Adds the motions in a folder and its subfolders.
fn walk(folder: &Path, base: &Path, out_dir: Option<&Path>, depth: usize, inputs: &mut Vec<Input>) -> Outcome {
    let problem = |error: std::io::Error| Failure::new(crate::files::describe(&error)).in_file(folder.display());
    let mut entries: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(folder).map_err(problem)? {
        entries.push(entry.map_err(problem)?.path());
    }
    entries.sort();
    for path in entries {
        if path.is_dir() {
            let is_searched = depth > 0 && !path.is_symlink() && fs::canonicalize(&path).ok().as_deref() != out_dir;
            if is_searched {
                walk(&path, base, out_dir, depth - 1, inputs)?;
            }
        } else if is_motion(&path) && path.is_file() && (!path.is_symlink() || is_below(base, &path)) {
            let stripped = path.strip_prefix(base).unwrap_or(&path);
            let relative = stripped.strip_prefix(".").unwrap_or(stripped).to_owned();
            inputs.push(Input { file: path, relative });
        }
    }
    Ok(())
}

fn is_motion(path: &Path) -> bool {
    extension_of(path).is_some_and(|extension| {
        GLTF_EXTENSIONS.iter().chain(&OTHER_MOTION_EXTENSIONS).any(|known| *known == extension)
    })
}

/// Whether a path matches a pattern, part by part; `**` stands for any number of folders.
fn matches(pattern: &[&str], path: &[&str]) -> bool {
    match (pattern, path) {
        ([], []) => true,
        ([first, rest @ ..], _) if *first == "**" => {
            matches(rest, path) || path.split_first().is_some_and(|(_, below)| matches(pattern, below))
        }
        ([first, pattern @ ..], [name, path @ ..]) => name_matches(first, name) && matches(pattern, path),
        _ => false,
    }
}

/// Whether a name matches one part of a pattern; `*` stands for any text, `?` for one character.
fn name_matches(pattern: &str, name: &str) -> bool {
    let (mut patterns, mut letters) = (pattern.chars(), name.chars());
    match (patterns.next(), letters.next()) {
        (None, letter) => letter.is_none(),
        (Some('*'), letter) => {
            name_matches(patterns.as_str(), name) || letter.is_some() && name_matches(pattern, letters.as_str())
        }
        (Some(expected), Some(letter)) => {
            (expected == '?' || expected == letter) && name_matches(patterns.as_str(), letters.as_str())
        }
        (Some(_), None) => false,
    }
}

#[cfg(test)]
mod tests {
    use super::{matches, parts};
    use std::path::Path;

    #[test]
    fn patterns_match_part_by_part() {
        let check = |pattern: &str, path: &str| matches(&parts(Path::new(pattern)), &parts(Path::new(path)));
        assert!(check("a/*.bvh", "a/walk.bvh") && check("./a/w??k.*", "a/walk.bvh"));
        assert!(check("**/*.bvh", "a/b/walk.bvh") && check("**/*.bvh", "walk.bvh") && check("a/**/c/*", "a/c/x"));
        assert!(check("b?r.bvh", "bär.bvh") && check("*?r.bvh", "bär.bvh") && !check("b??r.bvh", "bär.bvh"));
        assert!(!check("a/*.bvh", "a/b/walk.bvh") && !check("a/*", "b/walk.bvh") && !check("*.bvh", "walk.fbx"));
    }
}
