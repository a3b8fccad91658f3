//! No files use each other in a circle: each can be read with nothing but what lies below it. That a file uses what the
//! `mod.rs` above it defines doesn't count, since a folder's children share what the folder is about.

use std::collections::{BTreeMap, BTreeSet};

use super::{all_sources, identifier, without_comments};

/// Folders that still have circles. Remove each from here with its last one.
const EXEMPT: [&str; 5] = ["cli/", "frame/", "library/", "state/", "web/"];

/// A path as `["crate", "mesh", "Skin"]`.
type Path<'a> = Vec<&'a str>;

/// Returns the names that `use` declarations bring in, each with its path, and all other paths of more than one segment. What
/// `*` brings in stays the folder's own.
fn paths(text: &str) -> (Vec<(&str, Path<'_>)>, Vec<Path<'_>>) {
    let (mut used, mut others) = (Vec::new(), Vec::new());
    let mut rest = text;
    while let Some(at) = rest.find(|c: char| c.is_alphabetic() || c == '_') {
        rest = &rest[at..];
        let word = identifier(rest);
        rest = &rest[word.len()..];
        if word == "use" && rest.starts_with(char::is_whitespace) {
            let end = rest.find(';').unwrap_or(rest.len());
            tree(&rest[..end], &[], &mut used);
            rest = &rest[end..];
            continue;
        }
        let mut path = vec![word];
        while let Some(next) = rest.strip_prefix("::").filter(|next| !identifier(next).is_empty()) {
            path.push(identifier(next));
            rest = &next[identifier(next).len()..];
        }
        if path.len() > 1 {
            others.push(path);
        }
    }
    (used, others)
}

/// Adds the paths of a use tree such as `super::{a, b::{C, D as E}}`.
fn tree<'a>(text: &'a str, prefix: &[&'a str], paths: &mut Vec<(&'a str, Path<'a>)>) {
    let (mut depth, mut start) = (0, 0);
    for (at, c) in text.char_indices().chain([(text.len(), ',')]) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                let (path, group) = match text[start..at].split_once('{') {
                    Some((path, group)) => (path, group.rsplit_once('}').map(|(group, _)| group)),
                    None => (&text[start..at], None),
                };
                let (path, alias) = match path.split_once(" as ") {
                    Some((path, alias)) => (path, Some(alias.trim())),
                    None => (path, None),
                };
                let segments = path.split("::").map(str::trim).filter(|segment| !["", "self"].contains(segment));
                let path: Path<'_> = prefix.iter().copied().chain(segments).collect();
                match (group, path.last()) {
                    (Some(group), _) => tree(group, &path, paths),
                    (None, Some(last)) => paths.push((alias.unwrap_or(last), path)),
                    (None, None) => {}
                }
                start = at + 1;
            }
            _ => {}
        }
    }
}

/// The segments of a file's module: `["mesh", "skin"]` for `mesh/skin.rs`.
fn module(path: &str) -> Path<'_> {
    path.trim_end_matches(".rs").split('/').filter(|part| *part != "mod").collect()
}

/// The modules of all sources, and which names each gets from where.
struct Modules<'a> {
    files: BTreeMap<Path<'a>, usize>,
    imports: Vec<BTreeMap<&'a str, Path<'a>>>,
}

impl<'a> Modules<'a> {
    /// The path from the root of the crate; `None` for one that doesn't begin in it.
    fn absolute(&self, from: &[&'a str], path: &[&'a str]) -> Option<Path<'a>> {
        let ups = path.iter().take_while(|segment| **segment == "super").count();
        let base = match path[0] {
            "crate" => return Some(path[1..].to_vec()),
            "super" => from.get(..from.len().checked_sub(ups)?)?,
            first if self.files.contains_key(&[from, &[first]].concat()) => from,
            _ => return None,
        };
        Some([base, &path[ups..]].concat())
    }

    /// The file that defines the item at a path, however often it is re-exported on the way.
    fn file(&self, path: &[&'a str], depth: usize) -> Option<usize> {
        let (length, file) =
            (1..=path.len()).rev().find_map(|length| self.files.get(&path[..length]).map(|file| (length, *file)))?;
        let import = path.get(length).and_then(|name| self.imports[file].get(name));
        match import {
            // A name that leads back to itself is a macro's or another crate's.
            Some(import) if depth > 0 => self.file(&[import, &path[length + 1..]].concat(), depth - 1).or(Some(file)),
            _ => Some(file),
        }
    }
}

/// For each file, those that it uses, without the folders that it is in.
fn uses(sources: &[(String, String)]) -> Vec<BTreeSet<usize>> {
    let texts: Vec<String> = sources
        .iter()
        .map(|(_, text)| {
            let text = without_comments(text);
            // There `super` is the file itself.
            text.split("#[cfg(test)]\nmod ").next().unwrap_or_default().to_owned()
        })
        .collect();
    let of_file: Vec<_> = texts.iter().map(|text| paths(text)).collect();
    let names: Vec<Path<'_>> = sources.iter().map(|(path, _)| module(path)).collect();
    let files = names.iter().enumerate().map(|(file, module)| (module.clone(), file)).collect();
    let mut modules = Modules { files, imports: vec![BTreeMap::new(); sources.len()] };
    for (file, (used, _)) in of_file.iter().enumerate() {
        for (name, path) in used {
            if let Some(absolute) = modules.absolute(&names[file], path) {
                modules.imports[file].insert(name, absolute);
            }
        }
    }
    let uses_of = |file: usize| {
        let own = &names[file];
        let (used, others) = &of_file[file];
        let others = others.iter().filter_map(|path| match modules.imports[file].get(path[0]) {
            Some(import) => Some([import, &path[1..]].concat()),
            None => modules.absolute(own, path),
        });
        let all = used.iter().filter_map(|(_, path)| modules.absolute(own, path)).chain(others);
        all.filter_map(|path| modules.file(&path, 8)).filter(|&used| !own.starts_with(&names[used])).collect()
    };
    (0..sources.len()).map(uses_of).collect()
}

/// Returns the circles, each with what its files use of each other.
fn circles(sources: &[(String, String)]) -> Vec<Vec<String>> {
    let uses = uses(sources);
    let reached: Vec<BTreeSet<usize>> = (0..sources.len())
        .map(|file| {
            let (mut reached, mut next) = (BTreeSet::new(), vec![file]);
            while let Some(file) = next.pop() {
                next.extend(uses[file].iter().filter(|&&used| reached.insert(used)));
            }
            reached
        })
        .collect();
    let in_one = |a: usize, b: usize| reached[a].contains(&b) && reached[b].contains(&a);
    let first = |file: &usize| reached[*file].contains(file) && !(0..*file).any(|other| in_one(*file, other));
    let circle = |file: usize| {
        let files = (file..sources.len()).filter(|&other| in_one(file, other));
        let lines = files.flat_map(|user| uses[user].iter().map(move |&used| (user, used)));
        let inside = lines.filter(|&(_, used)| in_one(file, used));
        inside.map(|(user, used)| format!("{} uses {}", sources[user].0, sources[used].0)).collect()
    };
    (0..sources.len()).filter(first).map(circle).collect()
}

#[track_caller]
fn check(sources: &[(&str, &str)], expected: &[&[&str]]) {
    let sources: Vec<_> = sources.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())).collect();
    assert_eq!(circles(&sources), expected, "{sources:?}");
}

#[test]
fn circles_are_found() {
    let both: &[&[&str]] = &[&["a/b.rs uses a/c.rs", "a/c.rs uses a/b.rs"]];
    let folder = ("a/mod.rs", "mod b; mod c; pub use b::Y; pub use self::c::X as Z; pub struct Shared;");
    let c = ("a/c.rs", "use super::b::Y;");
    // Each way of naming another file.
    for text in [
        "use super::c::X;",
        "use super::{Shared, c::{self, X}};",
        "use crate::a::{c::X as W, Shared};",
        "use super::Z;",
        "use super::c as d; fn f() { d::f() }",
        "fn f() { super::c::f() }",
        "use crate::a; fn f() { a::c::f() }",
    ] {
        check(&[folder, ("a/b.rs", text), c], both);
    }
    // Through what the folder re-exports, in both directions.
    check(&[folder, ("a/b.rs", "use super::c::X;"), ("a/c.rs", "use super::Y;")], both);
    // Through a third file, in another folder.
    check(
        &[
            folder,
            ("a/b.rs", "use crate::d::D;"),
            c,
            ("d/mod.rs", "mod e; pub use e::D;"),
            ("d/e.rs", "use crate::a::c::X;"),
        ],
        &[&["a/b.rs uses d/e.rs", "a/c.rs uses a/b.rs", "d/e.rs uses a/c.rs"]],
    );
    // One direction, the folder's own items, comments, tests and other crates are no circle.
    for text in [
        "",
        "use super::Shared;",
        "// use super::c::X;",
        "fn f() {}\n#[cfg(test)]\nmod tests { use super::c; fn f() { c::f() } }",
        "use c::X;",
        "use super::Y;",
    ] {
        check(&[folder, ("a/b.rs", text), c], &[]);
    }
}

#[test]
fn no_files_use_each_other_in_a_circle() {
    let circles = circles(&all_sources());
    let is_in = |line: &String, folder: &str| line.split(" uses ").all(|file| file.starts_with(folder));
    let lies_in = |circle: &Vec<String>, folder: &str| circle.iter().all(|line| is_in(line, folder));
    let (known, new): (Vec<_>, Vec<_>) =
        circles.iter().partition(|circle| EXEMPT.iter().any(|folder| lies_in(circle, folder)));
    let new: Vec<String> = new.iter().map(|circle| circle.join("\n")).collect();
    assert!(new.is_empty(), "move what is shared to where it belongs:\n\n{}", new.join("\n\n"));
    for folder in EXEMPT {
        assert!(known.iter().any(|circle| lies_in(circle, folder)), "{folder} no longer has a circle");
    }
}
