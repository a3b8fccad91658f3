//! The clips that a model can play, and their identities: its own, those retargeted to it, and copies of either. An identity
//! outlives the list: a clip keeps it while motions are added, removed, reordered or opened again, so whatever refers to a clip
//! (the playhead, changes, layers) holds a [`ClipId`] and never an index or a name.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::Arc;

use gaitway_character::anim::{Clip, JointIndex};
use gaitway_character::asset::Asset;
use gaitway_character::sort::{collect_map, collect_set, sort_by};
use gaitway_formats::OwnClips;
use gaitway_retarget::{ChangedClip, ClipChanges, ClipOverLayers, LayerClip, Symmetry, change_clip};
use serde::{Deserialize, Serialize};

use super::Motion;
use super::borrowed::{BorrowedClip, file_title};

/// Identifies a motion by the file that it came from. Opened again, it has the same identity.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct MotionId {
    /// See [`Motion::origin`].
    origin: Arc<str>,
    /// See [`Motion::source`].
    source: Arc<str>,
    /// Which of several alike.
    nth: u32,
}

impl MotionId {
    /// Where the motion came from, as links have it.
    pub(super) fn origin(&self) -> &str {
        &self.origin
    }

    /// Identifies motions by their files. Those that have an identity keep it; of others alike, each gets the first that is free.
    pub(super) fn assign(motions: &mut [Motion]) {
        let mut taken = BTreeSet::new();
        let mut is_new = Vec::new();
        for motion in &*motions {
            let is_known = *motion.id.origin == *motion.origin && *motion.id.source == *motion.source;
            is_new.push(!is_known || !taken.insert(motion.id.clone()));
        }
        for (motion, _) in motions.iter_mut().zip(is_new).filter(|(_, is_new)| *is_new) {
            let mut id = Self { origin: motion.origin.as_str().into(), source: motion.source.as_str().into(), nth: 0 };
            while !taken.insert(id.clone()) {
                id.nth += 1;
            }
            motion.id = id;
        }
    }
}

/// Identifies a clip of a model.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(into = "String", from = "String")]
pub enum ClipId {
    /// One of the model's own, by its index in the file.
    Own(usize),
    /// Retargeted from a motion, by its index in that file.
    Borrowed(MotionId, usize),
    /// A copy of another clip.
    Copy(CopyId),
    /// What a link or the command line calls a clip that has not been looked up yet. The files that it is in may not be there.
    Called(Arc<str>),
}

impl ClipId {
    /// Returns the identity of a clip that is still to be looked up by its name, or by its index in decimal.
    pub fn called(name: &str) -> Self {
        Self::Called(name.into())
    }

    /// The name of a clip that is still to be looked up.
    pub fn name(&self) -> Option<&str> {
        if let Self::Called(name) = self { Some(name) } else { None }
    }

    /// The motion that the clip is retargeted from.
    pub fn motion(&self) -> Option<&MotionId> {
        if let Self::Borrowed(motion, _) = self { Some(motion) } else { None }
    }
}

/// What a link calls the clip, or a text for debugging.
impl fmt::Display for ClipId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Own(index) => write!(f, "own {index}"),
            Self::Borrowed(MotionId { origin, source, nth }, clip) => write!(f, "{clip} of {source} ({origin}, {nth})"),
            Self::Copy(CopyId(number)) => write!(f, "copy {number}"),
            Self::Called(name) => f.write_str(name),
        }
    }
}

/// Maps have texts as their keys.
impl From<ClipId> for String {
    fn from(id: ClipId) -> Self {
        match id {
            ClipId::Own(index) => format!("own {index}"),
            ClipId::Borrowed(MotionId { origin, source, nth }, clip) => {
                format!("borrowed {clip} {nth} {} {source}{origin}", source.len())
            }
            ClipId::Copy(CopyId(number)) => format!("copy {number}"),
            ClipId::Called(name) => format!("called {name}"),
        }
    }
}

/// Reads what [`String::from`] writes. Anything else is a name.
impl From<String> for ClipId {
    fn from(text: String) -> Self {
        let (kind, rest) = text.split_once(' ').unwrap_or((&text, ""));
        let borrowed = || {
            let mut parts = rest.splitn(4, ' ');
            let mut number = || parts.next()?.parse::<usize>().ok();
            let (clip, nth, length) = (number()?, number()?, number()?);
            let (source, origin) = parts.next()?.split_at_checked(length)?;
            let (origin, source, nth) = (origin.into(), source.into(), u32::try_from(nth).ok()?);
            Some(Self::Borrowed(MotionId { origin, source, nth }, clip))
        };
        let known = match kind {
            "own" => rest.parse().ok().map(Self::Own),
            "copy" => rest.parse().ok().map(|number| Self::Copy(CopyId(number))),
            "borrowed" => borrowed(),
            _ => None,
        };
        known.unwrap_or_else(|| Self::called(text.strip_prefix("called ").unwrap_or(&text)))
    }
}

/// Identifies a copy among the copies of one model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct CopyId(pub u32);

/// A copy of a clip, to have changes of its own.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClipCopy {
    /// Identifies the copy.
    pub id: CopyId,
    /// The original, which is no copy.
    pub of: ClipId,
}

/// What the user has done to the clips of a model.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct ClipEdits {
    /// Copies, in the order in which they were made.
    pub copies: Vec<ClipCopy>,
    /// Names that replace those of the files; never empty. Copies have theirs here, too.
    pub names: BTreeMap<ClipId, String>,
    /// Changes; never empty ones.
    pub changes: BTreeMap<ClipId, ClipChanges>,
}

impl ClipEdits {
    /// The most copies of clips at once.
    pub const MAX_COPIES: usize = 100;

    /// Returns an identity that no copy has.
    pub fn new_copy_id(&self) -> CopyId {
        CopyId(self.copies.iter().map(|copy| copy.id.0 + 1).max().unwrap_or(0))
    }

    /// Returns the changes of a clip.
    pub fn changes_of(&self, clip: &ClipId) -> ClipChanges {
        self.changes.get(clip).cloned().unwrap_or_default()
    }

    /// Removes a copy, with its name and its changes.
    pub fn remove_copy(&mut self, clip: &ClipId) {
        self.copies.retain(|copy| ClipId::Copy(copy.id) != *clip);
        self.names.remove(clip);
        self.changes.remove(clip);
    }

    /// Sets the changes of a clip, whether the model has it or not.
    pub fn set_changes(&mut self, clip: ClipId, changes: ClipChanges) {
        if changes.is_none() {
            self.changes.remove(&clip);
        } else {
            self.changes.insert(clip, changes);
        }
    }

    /// Keeps the edits of clips for which `is_kept` holds, and drops copies of the others along with theirs.
    pub fn retain(&mut self, mut is_kept: impl FnMut(&ClipId) -> bool) {
        self.copies.retain(|copy| is_kept(&copy.of));
        let copies = collect_set(self.copies.iter().map(|copy| copy.id));
        let mut is_kept = |clip: &ClipId| match clip {
            ClipId::Copy(id) => copies.contains(id),
            clip => is_kept(clip),
        };
        self.names.retain(|clip, _| is_kept(clip));
        self.changes.retain(|clip, _| is_kept(clip));
    }
}

/// A clip that a model can play.
#[derive(Debug)]
pub struct ModelClip {
    id: ClipId,
    title: String,
    original: Clip,
    borrowed: Option<Arc<BorrowedClip>>,
    /// What it is a copy of.
    copy_of: Option<ClipId>,
    /// Whether the user named it.
    is_renamed: bool,
    changed: Option<(ClipChanges, ChangedClip)>,
    root: Option<JointIndex>,
}

impl ModelClip {
    /// Its identity.
    pub fn id(&self) -> &ClipId {
        &self.id
    }

    /// The display name: not empty, and unique among the model's clips.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The name that the user gave it, otherwise the one in its file, which may be empty or that of another clip, too.
    pub fn name(&self) -> &str {
        if self.is_renamed { &self.title } else { self.original.name() }
    }

    /// The name in a written file: the display name for what the model's own file lacks, and for clips of its own the name there.
    pub fn file_name(&self) -> &str {
        let is_own = self.is_from_file() && !self.is_renamed && is_named(&self.original);
        if is_own { self.original.name() } else { &self.title }
    }

    /// The clip with its changes.
    pub fn clip(&self) -> &Clip {
        self.changed.as_ref().map_or(&self.original, |(_, changed)| &changed.clip)
    }

    /// The clip without its changes. A copy has the name that it was given, other clips have those of their files.
    pub fn unchanged(&self) -> &Clip {
        &self.original
    }

    /// The clip with its changes, if it has any.
    pub fn changed(&self) -> Option<&ChangedClip> {
        self.changed.as_ref().map(|(_, changed)| changed)
    }

    /// How it was retargeted, or what it is a copy of; `None` for the model's own clips and copies of them.
    pub fn borrowed(&self) -> Option<&BorrowedClip> {
        self.borrowed.as_deref()
    }

    /// Layers that animate the joints that a retargeted clip does not; empty for the model's own clips.
    pub fn layers(&self) -> &[LayerClip] {
        self.borrowed().map_or(&[], |borrowed| &borrowed.layers)
    }

    /// The clip with its changes, over its layers.
    pub fn over_layers(&self) -> ClipOverLayers<'_> {
        ClipOverLayers { clip: self.clip(), below: self.layers() }
    }

    /// Crossfade to and from this clip, as set in the joint map of a retargeted one.
    pub fn crossfade_secs(&self) -> f64 {
        self.borrowed().map_or(0.0, |borrowed| borrowed.crossfade_secs)
    }

    /// The clip that this is a copy of; its own identity if it is no copy.
    pub fn original_id(&self) -> &ClipId {
        self.copy_of.as_ref().unwrap_or(&self.id)
    }

    /// Whether it is one of those in the model's file.
    pub fn is_from_file(&self) -> bool {
        matches!(self.id, ClipId::Own(_))
    }

    /// Whether it is a copy of another clip.
    pub fn is_copy(&self) -> bool {
        self.copy_of.is_some()
    }

    /// Whether the user gave it its name, as every copy has one.
    pub fn is_renamed(&self) -> bool {
        self.is_renamed
    }

    /// Whether the model's file has it as it is, perhaps under another name.
    pub fn is_in_file(&self) -> bool {
        self.is_from_file() && self.changed.is_none()
    }

    /// Whether it is retargeted, changed, renamed or a copy, so that the model's file lacks it or has it under another name.
    pub fn is_derived(&self) -> bool {
        !self.is_in_file() || self.is_renamed
    }

    /// The root-motion joint, which carries the character: the topmost translated joint of the skin, else the topmost translated
    /// joint. `None` if nothing is translated.
    pub fn root(&self) -> Option<JointIndex> {
        self.root
    }

    /// The frame rate that the clip was authored at; of a retargeted clip, that of its source.
    pub fn frames_per_sec(&self) -> f64 {
        self.borrowed().map_or_else(|| self.clip().frames_per_sec(), |borrowed| borrowed.frames_per_sec)
    }

    /// Duration with its changes.
    pub fn duration_secs(&self) -> f64 {
        f64::from(self.clip().duration_secs())
    }
}

/// What clips are called in a copy of the model's file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SavedNames {
    /// The names that replace those in the file.
    pub own: OwnClips,
    /// The name of the clip that is added; empty if none is.
    pub added: String,
}

/// The clips of a model: its own, then the retargeted ones by motion, then copies.
#[derive(Debug, Default)]
pub struct Clips {
    list: Vec<ModelClip>,
    /// What the list was made with.
    edits: ClipEdits,
}

impl Clips {
    /// Lists the clips of an asset. `roots` has the root-motion joint of each of its own clips. Changed clips of `before` are kept
    /// where neither changes nor originals differ; `symmetry` is only called to mirror others.
    pub(super) fn new(
        source: &str,
        asset: &Asset,
        roots: &[Option<JointIndex>],
        borrowed: &[Arc<BorrowedClip>],
        edits: ClipEdits,
        mut before: Self,
        symmetry: impl Fn() -> Symmetry,
    ) -> Self {
        let mut titles = Titles::taken([REST_POSE].into_iter());
        let mut clips = Self::default();
        let mut add = |clips: &mut Self, id: ClipId, untitled: String, clip: ModelClip| {
            let name = edits.names.get(&id).cloned();
            let is_renamed = name.is_some();
            let title = titles.unique(name.unwrap_or(untitled));
            clips.list.push(ModelClip { id, title, is_renamed, ..clip });
        };
        // Names that are given in a link yield to those of the file.
        let own = || (0..asset.clips.len()).map(|index| (index, edits.names.contains_key(&ClipId::Own(index))));
        let in_file = own().filter(|(_, is_renamed)| !is_renamed);
        for (index, _) in in_file.chain(own().filter(|(_, is_renamed)| *is_renamed)) {
            let (clip, root) = (&asset.clips[index], roots.get(index).copied().flatten());
            let untitled = match clip.name().trim() {
                "" => format!("Clip {index}"),
                _ if is_named(clip) => clip.name().to_owned(),
                _ => file_title(source, index, asset.clips.len()),
            };
            add(&mut clips, ClipId::Own(index), untitled, ModelClip::of(clip.clone(), root, None));
        }
        sort_by(&mut clips.list, |first, second| first.id.cmp(&second.id));
        for borrowed in borrowed {
            let id = ClipId::Borrowed(borrowed.motion.clone(), borrowed.source_clip);
            let named = is_named(&borrowed.clip);
            let untitled = if named { borrowed.clip.name() } else { &borrowed.file_title }.to_owned();
            let clip = ModelClip::of(borrowed.clip.clone(), borrowed.root, Some(borrowed.clone()));
            add(&mut clips, id, untitled, clip);
        }
        for copy in &edits.copies {
            let Some(original) = clips.get(&copy.of).filter(|original| !original.is_copy()) else { continue };
            let (untitled, copy_of) = (original.title.clone(), Some(copy.of.clone()));
            let name = edits.names.get(&ClipId::Copy(copy.id)).unwrap_or(&untitled);
            let clip = original.original.clone().with_name(name.clone());
            let clip = ModelClip::of(clip, original.root, original.borrowed.clone());
            add(&mut clips, ClipId::Copy(copy.id), untitled, ModelClip { copy_of, ..clip });
        }
        let mut known = None;
        let mut symmetry = || known.get_or_insert_with(&symmetry).clone();
        for clip in &mut clips.list {
            let Some(changes) = edits.changes.get(&clip.id) else { continue };
            let kept =
                before.list.iter_mut().find(|before| before.id == clip.id && before.original.is_same(&clip.original));
            let kept = kept.and_then(|before| before.changed.take_if(|(known, _)| known == changes));
            let change = || (changes.clone(), change_clip(asset, &clip.original, changes, &mut symmetry));
            clip.changed = Some(kept.unwrap_or_else(change));
        }
        Self { edits, ..clips }
    }

    /// The edits that the list was made with.
    pub(super) fn edits(&self) -> &ClipEdits {
        &self.edits
    }

    /// The retargeted clips, to list them again with other edits.
    pub(super) fn shared_borrowed(&self) -> Vec<Arc<BorrowedClip>> {
        let originals = self.list.iter().filter(|clip| !clip.is_copy());
        originals.filter_map(|clip| clip.borrowed.clone()).collect()
    }

    /// Finds a clip; `None` if the model lacks it.
    pub fn get(&self, id: &ClipId) -> Option<&ModelClip> {
        self.list.iter().find(|clip| clip.id == *id)
    }

    /// The first clip.
    pub fn first(&self) -> Option<&ModelClip> {
        self.list.first()
    }

    /// Number of clips.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// All clips: the model's own, then the retargeted ones, then copies.
    pub fn iter(&self) -> std::slice::Iter<'_, ModelClip> {
        self.list.iter()
    }

    /// All clips as people list them: each copy follows its original.
    pub fn listed(&self) -> impl Iterator<Item = &ModelClip> {
        let originals = self.list.iter().filter(|clip| !clip.is_copy());
        originals.flat_map(|original| {
            let copies = self.list.iter().filter(|clip| clip.copy_of.as_ref() == Some(&original.id));
            std::iter::once(original).chain(copies)
        })
    }

    /// The retargeted clips, without copies.
    pub fn borrowed(&self) -> impl Iterator<Item = (&ModelClip, &BorrowedClip)> + Clone {
        self.list.iter().filter(|clip| !clip.is_copy()).filter_map(|clip| Some((clip, clip.borrowed()?)))
    }

    /// Returns a title for a clip: this name, with a number if another clip or the rest pose has it.
    pub fn free_title(&self, clip: &ClipId, name: &str) -> String {
        let others = self.list.iter().filter(|other| other.id != *clip).map(ModelClip::title);
        Titles::taken(others.chain([REST_POSE])).unique(name.to_owned())
    }

    /// Returns the names of clips in a copy of the model's file that `added` is added to; `None` if nothing is. A renamed clip that
    /// the file has is called so there. The file has the originals of changed clips under their own names, with a number if those
    /// are taken now.
    pub fn saved_names(&self, added: Option<&ClipId>) -> SavedNames {
        let is_added = |clip: &ModelClip| added == Some(&clip.id);
        // The name of the clip is not that of its original, which the file has.
        let has_original = |clip: &ModelClip| clip.is_renamed && (!clip.is_in_file() || is_added(clip));
        let is_taken = |clip: &&ModelClip| is_added(clip) || (clip.is_from_file() && !has_original(clip));
        let mut taken = Titles::taken(self.list.iter().filter(is_taken).map(ModelClip::file_name));
        let mut own = OwnClips::default();
        for clip in &self.list {
            let ClipId::Own(index) = clip.id else { continue };
            if clip.is_renamed && !has_original(clip) {
                own.names.insert(index, clip.title.clone());
            }
        }
        for clip in self.list.iter().filter(|clip| has_original(clip)) {
            let (ClipId::Own(index), name) = (&clip.id, clip.original.name()) else { continue };
            let free = if name.is_empty() { String::new() } else { taken.unique(name.to_owned()) };
            if free != name {
                own.names.insert(*index, free);
            }
        }
        let added =
            self.list.iter().find(|clip| is_added(clip)).map(|clip| match clip.is_from_file() && !clip.is_renamed {
                true => taken.unique(format!("{} (changed)", clip.file_name())),
                false => clip.file_name().to_owned(),
            });
        SavedNames { own, added: added.unwrap_or_default() }
    }

    /// The display names, in the order of the list.
    pub fn titles(&self) -> impl Iterator<Item = &str> {
        self.list.iter().map(ModelClip::title)
    }
}

impl<'a> IntoIterator for &'a Clips {
    type Item = &'a ModelClip;
    type IntoIter = std::slice::Iter<'a, ModelClip>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl ModelClip {
    /// An unchanged clip, still without identity and title.
    fn of(original: Clip, root: Option<JointIndex>, borrowed: Option<Arc<BorrowedClip>>) -> Self {
        Self {
            id: ClipId::Own(0),
            title: String::new(),
            original,
            borrowed,
            copy_of: None,
            is_renamed: false,
            changed: None,
            root,
        }
    }
}

/// What lists of clips call the rest pose. No clip has this title.
pub const REST_POSE: &str = "Rest pose";

/// The name of every clip that Mixamo exports, alone or within a longer one such as `Armature|mixamo.com|Layer0`.
const MIXAMO_CLIP: &str = "mixamo.com";

/// Whether a clip has a name of its own.
fn is_named(clip: &Clip) -> bool {
    !clip.name().trim().is_empty() && !clip.name().contains(MIXAMO_CLIP)
}

/// Returns the name under which a clip of a file is written elsewhere: its own, or that of its file if it has none.
pub fn clip_file_name(source: &str, clip: usize, asset: &Asset) -> Option<String> {
    let named = asset.clips.get(clip)?;
    Some(if is_named(named) { named.name().to_owned() } else { file_title(source, clip, asset.clips.len()) })
}

/// Makes names unique. Holds how often each was asked for.
#[derive(Debug)]
struct Titles(BTreeMap<String, usize>);

impl Titles {
    fn taken<'a>(names: impl Iterator<Item = &'a str>) -> Self {
        Self(collect_map(names.map(|name| (name.to_owned(), 1))))
    }

    /// Numbers a title that was taken before.
    fn unique(&mut self, base: String) -> String {
        let mut title = base.clone();
        loop {
            let count = self.0.entry(title.clone()).or_insert(0);
            *count += 1;
            if *count == 1 {
                return title;
            }
            title = format!("{base} ({})", *count);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identities_are_serialized_as_texts() {
        let motion = |source: &str| MotionId { origin: "a b.zip".into(), source: source.into(), nth: 2 };
        let names = ["Walk", "own 3", "called x", "borrowed 1 2 3", "歩 1", ""];
        let called = names.map(ClipId::called);
        let others = [ClipId::Own(3), ClipId::Copy(CopyId(7)), ClipId::Borrowed(motion("歩 く.fbx"), 1)];
        for id in called.into_iter().chain(others) {
            assert_eq!(ClipId::from(String::from(id.clone())), id);
        }
    }
}
