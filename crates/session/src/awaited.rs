//! Links that name files of somebody's computer: the page asks for them and meanwhile shows what it can. It also accepts a copy
//! of a model that couldn't be loaded, without asking for it.

use serde::{Deserialize, Serialize};

use crate::companions::Set;
use crate::item::{companion_words, file_name, list_of, without_copy};
use crate::{Effect, Item, Link, LinkRole, LinkedFile, NamedFile, Role};

/// A link that waits for files.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Awaited {
    /// As given.
    pub link: Link,
    /// The link with all of `wanted` marked as files to bring, and the names of those that have arrived.
    pub marked: Link,
    /// The files that it waits for.
    pub wanted: Vec<LinkedFile>,
    /// Those that the page asks for.
    pub missing: Vec<LinkedFile>,
    /// The files were open in this entry of the history before the page was reloaded.
    pub is_own: bool,
}

/// Which files of a link are among some items.
pub(crate) struct Arrivals {
    /// The link with their names.
    pub link: Link,
    /// Those that aren't.
    pub rest: Vec<LinkedFile>,
}

impl Awaited {
    /// Returns what a link waits for, if it does.
    pub fn of(link: &Link, is_own: bool) -> Option<Self> {
        let wanted: Vec<LinkedFile> = link.files_to_bring().cloned().collect();
        let (link, marked, missing) = (link.clone(), link.clone(), wanted.clone());
        (!wanted.is_empty()).then_some(Self { link, marked, wanted, missing, is_own })
    }

    /// Whether nothing can be shown before its model arrives.
    pub fn lacks_model(&self) -> bool {
        has_model(&self.missing)
    }

    /// Tells what the link needs.
    pub fn need(&self) -> String {
        let names: Vec<String> = self.missing.iter().map(|file| file_name(&file.name)).collect();
        let files = if names.len() == 1 { "a file with that name" } else { "files with those names" };
        let view = if self.is_own { "view as it was" } else { "shared view" };
        format!("This link needs {}. Open {files} to see the {view}.", list_of(&names))
    }

    /// Returns which of its files are among some items; `None` if none are.
    pub fn arrivals(&self, items: &[Item]) -> Option<Arrivals> {
        let arrived: Vec<Option<&Item>> = self.wanted.iter().map(|file| file_among(items, file)).collect();
        if arrived.iter().all(Option::is_none) {
            return None;
        }
        let names: Vec<String> =
            arrived.iter().map(|item| item.map(Item::name).unwrap_or_default().to_owned()).collect();
        let left = self.wanted.iter().zip(&arrived).filter(|(_, item)| item.is_none());
        Some(Arrivals { link: self.marked.with_names(&names), rest: left.map(|(file, _)| file.clone()).collect() })
    }

    /// Returns the link that waits on for what hasn't arrived.
    pub fn for_rest(self, Arrivals { link, rest }: Arrivals) -> Self {
        let is_left = |file: &LinkedFile| rest.iter().any(|left| left.role == file.role && left.name == file.name);
        let missing = self.missing.into_iter().filter(is_left).collect();
        Self { marked: link, wanted: rest, missing, ..self }
    }

    /// Asks for the files; nothing if copies are accepted alone.
    pub fn ask(&self, others: Option<String>) -> Option<Effect> {
        let line = |LinkedFile { role, name, .. }: &LinkedFile| {
            let companions = companion_words(name).map_or_else(String::new, |words| format!(", with {words}"));
            format!("{name} ({}){companions}", role.key())
        };
        let files: Vec<String> = self.missing.iter().map(line).collect();
        (!files.is_empty()).then_some(Effect::Ask { files, others, is_own: self.is_own })
    }

    /// Gives copies of files the names that the link knows them by: clips may be named after their file.
    pub fn rename_copies(&self, items: &mut [Item]) {
        let mut names: Vec<String> = self.wanted.iter().map(|file| file_name(&file.name)).collect();
        names.retain(|name| items.iter().all(|item| item.bare_name() != *name));
        for item in items {
            let bare = without_copy(&item.bare_name());
            let Some(at) = names.iter().position(|name| without_copy(name) == bare) else { continue };
            if let Item::File(NamedFile { name, .. }) = item {
                let folder = name.rfind('/').map_or(0, |at| at + 1);
                name.replace_range(folder.., &names.remove(at));
            }
        }
    }

    /// Separates what it waits for as a motion, with its files, from the rest: a character, opened together with the link's own, would
    /// be another model. Returns the motions and the rest; parts of a .gltf may be in both.
    pub fn split(&self, Set { items, role }: Set) -> (Option<Set>, Option<Set>) {
        let of = |role: LinkRole| -> Vec<&Item> {
            let wanted = self.wanted.iter().filter(|file| file.role == role);
            wanted.filter_map(|file| file_among(&items, file)).collect()
        };
        let (models, lent) = (of(LinkRole::Model), of(LinkRole::Motion));
        let (motions, others): (Vec<&Item>, Vec<&Item>) =
            items.iter().partition(|item| lent.contains(item) && !models.contains(item));
        if motions.is_empty() {
            return (None, Some(Set { items, role }));
        }
        let has_gltf = motions.iter().any(|item| item.is_gltf());
        let parts: Vec<&Item> = others.iter().filter(|item| has_gltf && item.is_part_of_gltf()).copied().collect();
        // What the parts belong to isn't known: they go with either.
        let rest = (others.len() > parts.len()).then(|| Set { items: others.into_iter().cloned().collect(), role });
        let motions = motions.into_iter().chain(parts).cloned().collect();
        (Some(Set { items: motions, role: Role::Motion }), rest)
    }
}

/// Returns a file of a link among items, by its bare name.
fn file_among<'a>(items: &'a [Item], file: &LinkedFile) -> Option<&'a Item> {
    let name = file_name(&file.name);
    items.iter().find(|item| item.bare_name() == name)
}

pub(crate) fn has_model(files: &[LinkedFile]) -> bool {
    files.iter().any(|file| file.role == LinkRole::Model)
}
