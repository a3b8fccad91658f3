//! Joins files that are opened one after the other with those they belong to: the files of a .gltf in any order, and the .skel
//! and .attach of an .obj after it.

use serde::{Deserialize, Serialize};

use crate::held::Held;
use crate::item::extension;
use crate::{Item, Role};

/// What may belong to what is opened next.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Companions {
    /// The last .gltf with its files.
    last: Set,
    /// Files opened since that it doesn't need: the next one may.
    loose: Vec<Item>,
}

/// What is opened together, and as what.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Set {
    pub items: Vec<Item>,
    pub role: Role,
}

/// How a set is joined.
pub(crate) enum Join {
    /// It is complete.
    Done(Set),
    /// Which of the candidates its .gltf refers to has to be found out: see [`Companions::found`].
    Ask(Question),
}

/// A .gltf, and what may belong to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Question {
    /// What is opened.
    opening: Set,
    /// The .gltf with the files that it has already.
    pub main: Set,
    candidates: Vec<Item>,
}

impl Companions {
    pub fn iter(&self) -> impl Iterator<Item = &Item> {
        self.last.items.iter().chain(&self.loose)
    }

    /// Adds the files from before that belong to these.
    pub fn join(&mut self, opening: Set, held: &Held) -> Join {
        let has_gltf = opening.items.iter().any(Item::is_gltf);
        if !has_gltf && !opening.items.iter().all(Item::is_part_of_gltf) {
            // What follows doesn't belong to files from before.
            *self = Self::default();
            return Join::Done(Set { items: with_mesh(opening.items, held), ..opening });
        }
        let main = match &self.last {
            _ if has_gltf => opening.clone(),
            // Another model was opened since. The page may have gone back from it, and asks for what the .gltf lacks.
            last if last.items.is_empty() => Set { items: held.last_gltf().to_vec(), role: Role::Any },
            last => last.clone(),
        };
        let opened = opening.items.iter().filter(|_| !has_gltf);
        let candidates: Vec<Item> = self.loose.iter().chain(opened).cloned().collect();
        let is_clear = candidates.is_empty() || main.items.is_empty();
        let question = Question { opening, main, candidates };
        if is_clear { Join::Done(self.found(question, &[])) } else { Join::Ask(question) }
    }

    /// Returns what to open, given the names of the files that the .gltf lacks.
    pub fn found(&mut self, question: Question, lacking: &[String]) -> Set {
        let Question { opening, main, candidates } = question;
        let has_gltf = opening.items.iter().any(Item::is_gltf);
        let lacks = |item: &&Item| lacking.iter().any(|name| key(name) == key(item.name()));
        let found: Vec<Item> = candidates.iter().filter(lacks).cloned().collect();
        if !has_gltf && found.is_empty() {
            self.loose = candidates;
            return opening;
        }
        self.last = Set { items: merged(main.items, found), role: main.role };
        self.loose.clear();
        self.last.clone()
    }
}

impl Question {
    pub fn iter(&self) -> impl Iterator<Item = &Item> {
        self.opening.items.iter().chain(&self.main.items).chain(&self.candidates)
    }
}

/// The program ignores folders and case as well (`FileSet::resolve`).
fn key(path: &str) -> String {
    path.rsplit(['/', '\\']).next().unwrap_or(path).to_lowercase()
}

/// Adds the .obj to a .skel or .attach, and the other of the two.
fn with_mesh(items: Vec<Item>, held: &Held) -> Vec<Item> {
    const OTHERS: [&str; 2] = ["skel", "attach"];
    let Some(name) = items.first().map(Item::name) else { return items };
    if !items.iter().all(|item| OTHERS.contains(&&*extension(item.name()))) {
        return items;
    }
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let Some(mesh) = held.set_with(&format!("{stem}.obj")) else { return items };
    let others = OTHERS.iter().filter_map(|extension| held.item_named(&format!("{stem}.{extension}")));
    merged(mesh.iter().chain(others).cloned().collect(), items)
}

/// Returns the items of both lists, the later ones of the same name. The .gltf comes last: a failure is titled by the last file that
/// was read.
fn merged(before: Vec<Item>, items: Vec<Item>) -> Vec<Item> {
    let mut all: Vec<Item> = Vec::new();
    for item in before.into_iter().chain(items) {
        match all.iter_mut().find(|other| other.name() == item.name()) {
            Some(other) => *other = item,
            None => all.push(item),
        }
    }
    all.sort_by_key(Item::is_gltf);
    all
}
