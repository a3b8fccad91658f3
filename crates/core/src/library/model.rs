//! A loaded file with its decoded images and cached derived data.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock};

use glam::{Affine3A, Vec3};

use super::ImageData;
use super::borrowed::{BorrowedClip, file_title};
use super::extent::Extent;
use super::lints::{joint_of_place, lint};
use super::rig::Rig;
use crate::anim::{Clip, Joint, JointIndex, PropertyValues, SampleCursor, Skeleton, model_from_joint};
use crate::asset::{Asset, AssetParts, Humanoid, MeshInstance, SceneJoints, Warning};
use crate::mesh::{Bounds, Mesh};
use crate::retarget::{Body, ChangedClip, ClipChanges, LayerClip, Recognized, Symmetry, change_clip, recognize};

/// Identifies a model, or a motion shown as one, within its library. 0 until the library assigns one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct ModelId(pub u64);

/// A loaded file that can be shown: its asset, decoded images and borrowed clips.
#[derive(Debug)]
pub struct Model {
    /// Assigned by the library.
    pub id: ModelId,
    /// A file name, URL or `sample:NAME`.
    pub source: String,
    /// What a link lists to open it again: the source, or the archive or folder that contains it.
    pub origin: String,
    /// Whether it is the user's local file, which an embedding page must not learn about.
    pub is_own: bool,
    is_placeholder: bool,
    /// The file's content.
    pub asset: Arc<Asset>,
    /// One per image of the asset; none if it could not be decoded (a warning says why).
    pub images: Vec<Option<ImageData>>,
    /// Clips of other files retargeted to this model; their indices follow the asset's own.
    borrowed: Vec<BorrowedClip>,
    /// Copies of clips; their indices follow the borrowed ones.
    copies: Vec<ClipCopy>,
    clips_revision: u32,
    /// Changed clips and their changes, by index among all clips.
    changed: BTreeMap<usize, (ClipChanges, ChangedClip)>,
    clip_titles: Vec<String>,
    slots: Humanoid,
    recognized: Recognized,
    findings: OnceLock<Vec<Finding>>,
    rig: Rig,
    extent: Extent,
    swept: Mutex<BTreeMap<SweptKey, Bounds>>,
}

/// What a model derives from an asset whatever its images are: their decoding needn't be awaited for it.
#[derive(Debug)]
pub struct Derived {
    rig: Rig,
    extent: Extent,
    recognized: Recognized,
}

impl Derived {
    /// Examines an asset.
    pub fn new(asset: &Asset) -> Self {
        let rig = Rig::new(asset);
        let extent = Extent::new(asset, &rig);
        Self { rig, extent, recognized: recognize(asset) }
    }
}

/// A warning of a reader or a lint.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The problem and its place in the file.
    pub warning: Warning,
    /// The node that it concerns, if any.
    pub joint: Option<JointIndex>,
}

/// A clip under another name, to have changes of its own.
#[derive(Debug)]
struct ClipCopy {
    /// Index of the original, which is no copy.
    of: usize,
    clip: Clip,
}

/// Key of cached clip bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct SweptKey {
    scene: Option<usize>,
    clip: Option<usize>,
    /// Without the root's ground-plane travel.
    in_place: bool,
}

impl Model {
    /// Poses sampled to find a clip's bounds.
    const SWEEP_SAMPLES: usize = 24;

    /// Wraps an asset. `images` has one entry per image of the asset. The origin is the source until the caller sets
    /// another.
    pub fn new(source: String, asset: impl Into<Arc<Asset>>, images: Vec<Option<ImageData>>) -> Self {
        let asset = asset.into();
        let derived = Derived::new(&asset);
        Self::with_derived(source, asset, derived, images)
    }

    /// Like [`Self::new`], with what has already been derived from the same asset.
    pub fn with_derived(
        source: String,
        asset: impl Into<Arc<Asset>>,
        derived: Derived,
        images: Vec<Option<ImageData>>,
    ) -> Self {
        let asset = asset.into();
        let clip_titles = unique_titles(&source, &asset.clips, &[], &[]);
        let Derived { rig, extent, recognized } = derived;
        Self {
            id: ModelId::default(),
            origin: source.clone(),
            is_own: false,
            is_placeholder: false,
            source,
            asset,
            images,
            borrowed: Vec::new(),
            copies: Vec::new(),
            clips_revision: 0,
            changed: BTreeMap::new(),
            clip_titles,
            slots: recognized.humanoid(),
            recognized,
            findings: OnceLock::new(),
            rig,
            extent,
            swept: Mutex::default(),
        }
    }

    /// Whether the model was opened before its images had arrived, and they still haven't.
    pub fn awaits_images(&self) -> bool {
        self.asset.warnings.0.contains(&Warning::ImagesAwaited)
    }

    /// Takes images and warnings from the same model, read from its complete file.
    pub(super) fn complete(&mut self, complete: Self) {
        (self.asset, self.images, self.findings) = (complete.asset, complete.images, OnceLock::new());
    }

    /// Number of playable clips: the asset's own, then the borrowed ones, then copies.
    pub fn clip_count(&self) -> usize {
        self.original_count() + self.copies.len()
    }

    /// Number of clips that aren't copies.
    pub fn original_count(&self) -> usize {
        self.asset.clips.len() + self.borrowed.len()
    }

    /// Returns the index of the clip that this one is a copy of; its own if it is no copy.
    pub fn original(&self, clip: usize) -> usize {
        clip.checked_sub(self.original_count()).and_then(|at| self.copies.get(at)).map_or(clip, |copy| copy.of)
    }

    /// Indices of all clips as people list them: each copy follows its original.
    pub fn listed_clips(&self) -> impl Iterator<Item = usize> {
        let first_copy = self.original_count();
        let copies_of = move |clip: usize| {
            let copies = self.copies.iter().enumerate().filter(move |(_, copy)| copy.of == clip);
            copies.map(move |(at, _)| first_copy + at)
        };
        (0..first_copy).flat_map(move |clip| std::iter::once(clip).chain(copies_of(clip)))
    }

    /// Whether a clip is a copy of another one.
    pub fn is_copy(&self, clip: usize) -> bool {
        self.original(clip) != clip
    }

    /// Returns a clip by its index among all clips, with its changes.
    pub fn clip(&self, index: usize) -> Option<&Clip> {
        self.changed.get(&index).map(|(_, changed)| &changed.clip).or_else(|| self.unchanged_clip(index))
    }

    /// Returns a clip by its index among all clips, without its changes.
    pub fn unchanged_clip(&self, index: usize) -> Option<&Clip> {
        let own = &self.asset.clips;
        match index.checked_sub(self.original_count()) {
            Some(copy) => self.copies.get(copy).map(|copy| &copy.clip),
            None => own.get(index).or_else(|| self.borrowed.get(index - own.len()).map(|borrowed| &borrowed.clip)),
        }
    }

    /// Returns a clip with its changes, if it has any.
    pub fn changed_clip(&self, index: usize) -> Option<&ChangedClip> {
        self.changed.get(&index).map(|(_, changed)| changed)
    }

    /// Whether a clip is retargeted, changed or a copy, so that the model's file lacks it.
    pub fn is_derived(&self, clip: usize) -> bool {
        self.borrowed(clip).is_some() || self.changed.contains_key(&clip) || self.is_copy(clip)
    }

    /// Returns all clips by index without their changes: the asset's own, then the borrowed ones, then copies. Changes keep the
    /// names.
    pub fn clips(&self) -> impl Iterator<Item = &Clip> + Clone {
        let borrowed = self.borrowed.iter().map(|borrowed| &borrowed.clip);
        self.asset.clips.iter().chain(borrowed).chain(self.copies.iter().map(|copy| &copy.clip))
    }

    /// Replaces the copies, each with its name and the index of its original. Returns whether they differ from before.
    pub(super) fn copy_clips(&mut self, copies: &[(String, usize)]) -> bool {
        let known = self.copies.iter().map(|copy| (copy.clip.name(), copy.of));
        if known.eq(copies.iter().map(|(name, of)| (&**name, *of))) {
            return false;
        }
        self.copies.clear();
        let copy = |(name, of): &(String, usize)| {
            Some(ClipCopy { of: *of, clip: self.unchanged_clip(*of)?.clone().with_name(name.clone()) })
        };
        self.copies = copies.iter().filter_map(copy).collect();
        self.forget_clips_from(self.original_count());
        true
    }

    /// Applies changes to clips, by index among all clips, and restores the others. Clips whose changes are the same as before
    /// are kept. Returns whether any clip differs from before.
    pub(super) fn change_clips(&mut self, changes: &BTreeMap<usize, ClipChanges>) -> bool {
        let mut before = std::mem::take(&mut self.changed);
        let mut is_changed = false;
        let mut symmetry = None;
        for (&index, changes) in changes {
            let known = before.remove(&index).filter(|(known, _)| known == changes);
            let made = match (known, self.unchanged_clip(index)) {
                (Some(known), _) => known,
                (None, None) => continue,
                (None, Some(clip)) => {
                    is_changed = true;
                    let symmetry =
                        || symmetry.get_or_insert_with(|| Symmetry::of(&self.asset, self.recognition())).clone();
                    (changes.clone(), change_clip(&self.asset, clip, changes, symmetry))
                }
            };
            self.changed.insert(index, made);
        }
        is_changed |= !before.is_empty();
        if is_changed {
            self.clips_revision += 1;
            if let Ok(mut swept) = self.swept.lock() {
                swept.retain(|key, _| key.clip.is_none());
            }
        }
        is_changed
    }

    /// Returns the borrowed clip with this index among all clips, or that a copy with this index is of.
    pub fn borrowed(&self, clip: usize) -> Option<&BorrowedClip> {
        self.borrowed.get(self.original(clip).checked_sub(self.asset.clips.len())?)
    }

    /// Returns the borrowed clips with their indices among all clips, without copies.
    pub fn borrowed_clips(&self) -> impl Iterator<Item = (usize, &BorrowedClip)> + Clone {
        self.borrowed.iter().enumerate().map(|(at, borrowed)| (self.asset.clips.len() + at, borrowed))
    }

    /// Incremented whenever clips are borrowed, copied or changed: an index may then refer to another clip.
    pub fn clips_revision(&self) -> u32 {
        self.clips_revision
    }

    /// Layers that animate the joints a borrowed clip does not; empty for the asset's own clips.
    pub fn layers(&self, clip: usize) -> &[LayerClip] {
        self.borrowed(clip).map_or(&[], |borrowed| &borrowed.layers)
    }

    /// Crossfade between two clips as set in the joint maps of borrowed ones. `None` is the rest pose.
    pub fn crossfade_secs(&self, from: Option<usize>, to: Option<usize>) -> f64 {
        let secs =
            |clip: Option<usize>| clip.and_then(|clip| self.borrowed(clip)).map_or(0.0, |clip| clip.crossfade_secs);
        secs(from).max(secs(to))
    }

    /// Removes the borrowed clips, until [`Model::set_borrowed`] sets new ones.
    pub(super) fn take_borrowed(&mut self) -> Vec<BorrowedClip> {
        std::mem::take(&mut self.borrowed)
    }

    /// Replaces the borrowed clips, and removes the copies.
    pub(super) fn set_borrowed(&mut self, borrowed: Vec<BorrowedClip>) {
        self.borrowed = borrowed;
        self.copies.clear();
        self.forget_clips_from(self.asset.clips.len());
    }

    /// Brings up to date what is derived from the clips, of which those from this index on may be others than before.
    fn forget_clips_from(&mut self, first: usize) {
        self.clips_revision += 1;
        self.changed.retain(|&clip, _| clip < first);
        self.clip_titles = unique_titles(&self.source, &self.asset.clips, &self.borrowed, &self.copies);
        if let Ok(mut swept) = self.swept.lock() {
            swept.retain(|key, _| key.clip.is_none_or(|clip| clip < first));
        }
    }

    /// The reader's warnings, then the lints, which are computed on first use.
    pub fn findings(&self) -> &[Finding] {
        self.findings.get_or_init(|| {
            let lints = lint(&self.asset, self.recognition());
            let warnings = self.asset.warnings.iter().chain(lints.iter()).cloned();
            let finding = |warning: Warning| Finding { joint: joint_of_place(&self.asset, warning.place()), warning };
            warnings.map(finding).collect()
        })
    }

    /// The asset with the humanoid slots of its joints.
    pub fn body(&self) -> Body<'_> {
        Body { asset: &self.asset, slots: &self.slots }
    }

    /// GPU memory of the textures in bytes.
    pub fn texture_bytes(&self) -> u64 {
        self.images.iter().flatten().map(ImageData::device_bytes).sum()
    }

    /// Facing direction of a recognized body at rest, in the file's axes.
    pub fn forward(&self) -> Option<Vec3> {
        self.recognized.facing.forward
    }

    /// What was recognized in the asset.
    pub fn recognition(&self) -> &Recognized {
        &self.recognized
    }

    /// Returns an empty model that stands in for one that isn't available yet. Its name is `source` without a leading `file:`.
    pub fn placeholder(source: &str) -> Self {
        // A mesh without surfaces: a skeleton alone would be drawn.
        let joint = Joint { name: "Empty".to_owned(), ..Joint::default() };
        let parts = Skeleton::new(vec![joint]).map(|skeleton| AssetParts {
            skeleton,
            meshes: vec![Mesh::default()],
            instances: vec![MeshInstance::new(JointIndex(0), 0, None)],
            ..AssetParts::default()
        });
        let asset = parts.ok().and_then(|parts| Asset::new(parts).ok()).unwrap_or_default();
        let name = source.strip_prefix("file:").unwrap_or(source);
        let model = Self::new(name.to_owned(), asset, Vec::new());
        Self { origin: source.to_owned(), is_placeholder: true, ..model }
    }

    /// Whether this stands in for a model that isn't available yet.
    pub fn is_placeholder(&self) -> bool {
        self.is_placeholder
    }

    /// Message about a model without a skeleton, to follow its name.
    pub const NO_SKELETON: &str =
        "has no skeleton that a motion could move; bind its mesh to one and export it again with its skin";

    /// Whether there is a skeleton that a motion could move: a skin, animated nodes, a recognized body, or no mesh at all.
    pub fn has_skeleton(&self) -> bool {
        let has_real = self.asset.skeleton.joints().any(|joint| self.rig.is_real(joint));
        has_real || !self.slots.0.is_empty()
    }

    /// Display names, one per clip, non-empty and unique.
    pub fn clip_titles(&self) -> &[String] {
        &self.clip_titles
    }

    /// The name of a clip in a file: its own; its title if it has none, or the one that Mixamo gives to all of its clips.
    pub fn clip_name(&self, clip: usize) -> Option<&str> {
        let named = self.clip(clip).filter(|clip| is_named(clip)).map(Clip::name);
        named.or_else(|| self.clip_titles.get(clip).map(String::as_str))
    }

    /// Whether the indices of instance, primitive and vertex are in range.
    pub fn has_vertex(&self, instance: usize, primitive: usize, vertex: usize) -> bool {
        let mesh = self.asset.instances.get(instance).and_then(|instance| self.asset.meshes.get(instance.mesh));
        let geometry = mesh.and_then(|mesh| mesh.primitives.get(primitive));
        geometry.is_some_and(|geometry| vertex < geometry.positions.len())
    }

    /// The joints and bones to draw as the skeleton.
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// Resolves a choice of scene; an index out of range falls back to the file's default.
    pub fn scene(&self, choice: Option<usize>) -> Option<usize> {
        choice.filter(|&scene| scene < self.asset.scenes.len()).or(self.asset.default_scene)
    }

    /// World-space bounds of the default scene at rest, with every vertex skinned. Without a mesh, the bounds of the
    /// joints.
    pub fn rest_bounds(&self) -> Bounds {
        self.extent.rest()
    }

    /// The largest dimension of [`Model::rest_bounds`], by which the errors of feet are judged.
    pub fn size_metres(&self) -> f64 {
        f64::from(self.rest_bounds().size().max_element())
    }

    /// Conservative bounds of a pose: they enclose every vertex (nearly, for dual quaternions) and are a little loose
    /// where joints bend. `world_from_joint` has one entry per joint. If no mesh is visible, the bounds of the joints.
    pub fn pose_bounds(&self, world_from_joint: &[Affine3A], morph_weights: &[f32], scene: &SceneJoints) -> Bounds {
        self.extent.of_pose(&self.asset, &self.rig, world_from_joint, morph_weights, scene)
    }

    /// Approximate center of a mesh instance in a pose, for sorting.
    pub fn instance_center(&self, instance: usize, world_from_joint: &[Affine3A]) -> Vec3 {
        self.extent.instance_center(&self.asset, instance, world_from_joint)
    }

    /// World-space bounds of a whole clip (without one, of the rest pose) in a scene, cached. `in_place` removes the
    /// root's ground-plane travel.
    pub fn clip_bounds(&self, scene: Option<usize>, clip: Option<usize>, in_place: bool) -> Bounds {
        let scene = self.scene(scene);
        let clip = clip.filter(|&clip| clip < self.clip_count());
        let key = SweptKey { scene, clip, in_place };
        if let Some(bounds) = self.swept.lock().ok().and_then(|swept| swept.get(&key).copied()) {
            return bounds;
        }
        let bounds = self.sweep(key, &[]);
        if let Ok(mut swept) = self.swept.lock() {
            swept.insert(key, bounds);
        }
        bounds
    }

    /// Returns [`Self::clip_bounds`] without the meshes on these joints and their descendants. Not cached.
    pub fn clip_bounds_without(
        &self,
        scene: Option<usize>,
        clip: Option<usize>,
        in_place: bool,
        hidden: &[JointIndex],
    ) -> Bounds {
        let clip = clip.filter(|&clip| clip < self.clip_count());
        self.sweep(SweptKey { scene: self.scene(scene), clip, in_place }, hidden)
    }

    /// The root-motion joint of a clip, which carries the character: the topmost translated joint of the skin, else the
    /// topmost translated joint. `None` if nothing is translated.
    pub fn root_of_clip(&self, clip: usize) -> Option<JointIndex> {
        match self.borrowed(clip) {
            Some(borrowed) => borrowed.root,
            None => self.rig.root_of_clip(clip),
        }
    }

    /// The frame rate the clip was authored at; of a borrowed clip, that of its source.
    pub fn frames_per_sec(&self, clip: usize) -> f64 {
        match (self.borrowed(clip), self.clip(clip)) {
            (Some(borrowed), _) => borrowed.frames_per_sec,
            (None, Some(clip)) => clip.frames_per_sec(),
            (None, None) => Clip::DEFAULT_FRAMES_PER_SEC,
        }
    }

    fn sweep(&self, key: SweptKey, hidden: &[JointIndex]) -> Bounds {
        let skeleton = &self.asset.skeleton;
        let (mut scene, mut values) = (SceneJoints::new(&self.asset, key.scene), PropertyValues::default());
        scene.hide(hidden.iter().copied());
        scene.show(&self.asset, &values);
        let mut pose = skeleton.rest().clone();
        let mut world_from_joint = Vec::with_capacity(skeleton.len());
        let Some(clip) = key.clip.and_then(|clip| self.clip(clip)) else {
            if key.scene == self.asset.default_scene && hidden.is_empty() {
                return self.rest_bounds();
            }
            model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut world_from_joint);
            return self.pose_bounds(&world_from_joint, &pose.morph_weights, &scene);
        };
        let root = key.clip.filter(|_| key.in_place).and_then(|clip| self.root_of_clip(clip));
        let mut start = None;
        let mut cursor = SampleCursor::default();
        let mut bounds = Bounds::EMPTY;
        for sample in 0..=Self::SWEEP_SAMPLES {
            let time_secs = clip.duration_secs() * sample as f32 / Self::SWEEP_SAMPLES as f32;
            pose.copy_from(skeleton.rest());
            clip.sample(skeleton, time_secs, &mut cursor, &mut pose);
            model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut world_from_joint);
            clip.sample_properties(time_secs, &mut cursor, &mut values);
            scene.show(&self.asset, &values);
            let mut at_time = self.pose_bounds(&world_from_joint, &pose.morph_weights, &scene);
            if let Some(root) = root {
                let position = Vec3::from(world_from_joint[root.get()].translation);
                let travel = (position - *start.get_or_insert(position)) * Vec3::new(1.0, 0.0, 1.0);
                if travel.is_finite() && !at_time.is_empty() {
                    at_time = Bounds { min: at_time.min - travel, max: at_time.max - travel };
                }
            }
            bounds = bounds.union(at_time);
            if clip.duration_secs() <= 0.0 {
                break;
            }
        }
        bounds
    }
}

/// The name of every clip that Mixamo exports, alone or within a longer one such as `Armature|mixamo.com|Layer0`.
const MIXAMO_CLIP: &str = "mixamo.com";

/// Whether a clip has a name of its own.
fn is_named(clip: &Clip) -> bool {
    !clip.name().trim().is_empty() && !clip.name().contains(MIXAMO_CLIP)
}

/// Titles by index: each clip's name, otherwise its number in its own file. Mixamo's clips are called as their file is.
fn unique_titles(source: &str, own: &[Clip], borrowed: &[BorrowedClip], copies: &[ClipCopy]) -> Vec<String> {
    let title = |index: usize, clip: &Clip| match clip.name().trim() {
        "" => format!("Clip {index}"),
        _ => file_title(source, index, own.len()),
    };
    let own = own.iter().enumerate().map(|(index, clip)| (clip, title(index, clip)));
    let borrowed = borrowed.iter().map(|borrowed| (&borrowed.clip, borrowed.file_title.clone()));
    let copies = copies.iter().map(|copy| (&copy.clip, copy.clip.name().to_owned()));
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    let mut titles = Vec::new();
    for (clip, unnamed) in own.chain(borrowed).chain(copies) {
        let base = if is_named(clip) { clip.name().to_owned() } else { unnamed };
        let mut title = base.clone();
        loop {
            let count = seen.entry(title.clone()).or_insert(0);
            *count += 1;
            if *count == 1 {
                break;
            }
            title = format!("{base} ({})", *count);
        }
        titles.push(title);
    }
    titles
}
