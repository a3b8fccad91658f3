//! Files that were opened, kept so that a new instance, back and forward can show them again: a link only has their names.

use serde::{Deserialize, Serialize};

use crate::item::{has_files, is_companion, list_of};
use crate::{Item, Link, LinkRole, LinkedFile};

const MAX_SETS: usize = 32;

/// Sets of files that were opened together, the most recent last.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Held(Vec<Vec<Item>>);

/// What a link is opened from, besides addresses.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Files {
    /// The model's.
    pub model: Vec<Item>,
    /// Those of the motions and the light that aren't the model's.
    pub motion: Vec<Item>,
}

impl Files {
    pub fn iter(&self) -> impl Iterator<Item = &Item> {
        self.model.iter().chain(&self.motion)
    }

    pub fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }
}

impl Held {
    pub fn iter(&self) -> impl Iterator<Item = &Item> {
        self.0.iter().flatten()
    }

    /// Keeps a set with local files, which is shown from now on. A link has addresses in full.
    pub fn hold(&mut self, items: &[Item]) {
        if !has_files(items) {
            return;
        }
        self.release(items);
        self.0.push(items.to_vec());
        if self.0.len() > MAX_SETS {
            self.0.remove(0);
        }
    }

    /// Keeps a set with local files that couldn't be shown, without hiding files of the same names that are shown.
    pub fn hold_last(&mut self, items: &[Item]) {
        if has_files(items) {
            self.release(items);
            self.0.insert(0, items.to_vec());
        }
    }

    fn release(&mut self, items: &[Item]) {
        self.0.retain(|set| set != items);
    }

    /// Drops sets with a file of this name, which was read from its address meanwhile.
    pub fn release_named(&mut self, name: &str) {
        self.0.retain(|set| set.iter().all(|item| item.name() != name));
    }

    /// Returns the most recent set with a file of this name.
    pub fn set_with(&self, name: &str) -> Option<&[Item]> {
        self.0.iter().rev().find(|set| set.iter().any(|item| item.name() == name)).map(Vec::as_slice)
    }

    /// Returns the most recent set with a .gltf; empty without one.
    pub fn last_gltf(&self) -> &[Item] {
        self.0.iter().rev().find(|set| set.iter().any(Item::is_gltf)).map_or(&[], Vec::as_slice)
    }

    /// Returns the most recent file of this name.
    pub fn item_named(&self, name: &str) -> Option<&Item> {
        self.0.iter().flatten().rev().find(|item| item.name() == name)
    }

    fn is_local(&self, name: &str) -> bool {
        self.iter().any(|item| item.id().is_some() && item.name() == name)
    }

    fn sets_of(&self, link: &Link, role: LinkRole) -> Vec<&[Item]> {
        let mut sets: Vec<&[Item]> = Vec::new();
        for file in link.files_of(role).filter(|file| !file.is_to_bring) {
            if let Some(set) = self.set_with(&file.name).filter(|set| !sets.contains(set)) {
                sets.push(set);
            }
        }
        sets
    }

    /// Returns what a link is opened from.
    pub fn of_link(&self, link: &Link) -> Files {
        let models = self.sets_of(link, LinkRole::Model);
        let mut motions = self.sets_of(link, LinkRole::Motion);
        motions.retain(|set| !models.contains(set));
        let mut motion: Vec<Item> = motions.concat();
        // Not the whole set with the light: it may contain a model that is no longer shown.
        for file in link.files_of(LinkRole::Light).filter(|file| !file.is_to_bring) {
            let light = self.item_named(&file.name);
            let is_among = |item: &&Item| models.iter().chain(&motions).any(|set| set.contains(item));
            motion.extend(light.filter(|item| !is_among(item)).cloned());
        }
        Files { model: models.concat(), motion }
    }

    /// Returns the files of a link that exist only on this computer.
    pub fn local_files<'a>(&self, link: &'a Link) -> impl Iterator<Item = &'a LinkedFile> {
        link.files().iter().filter(|file| !file.is_to_bring && self.is_local(&file.name))
    }

    /// Returns a link with the files that it asks for and that were opened before, if there are any.
    pub fn with_names(&self, link: &Link) -> Option<Link> {
        let known = |file: &LinkedFile| if self.is_local(&file.name) { file.name.clone() } else { String::new() };
        let names: Vec<String> = link.files_to_bring().map(known).collect();
        names.iter().any(|name| !name.is_empty()).then(|| link.with_names(&names))
    }

    /// Returns the link to hand to others, who have to bring the local files along.
    pub fn shareable(&self, link: &Link) -> Link {
        let names: Vec<String> = self.local_files(link).map(|file| file.name.clone()).collect();
        link.public(&names)
    }

    /// Describes a file for those who need it, with what was opened together with it.
    pub fn described(&self, file: &LinkedFile) -> String {
        let set = self.set_with(&file.name).unwrap_or_default();
        let names: Vec<&str> = set.iter().map(Item::name).filter(|other| is_companion(&file.name, other)).collect();
        let companions = if names.is_empty() { String::new() } else { format!(", with {}", list_of(&names)) };
        format!("{} ({}){companions}", file.name, file.role.key())
    }
}
