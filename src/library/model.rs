//! One loaded file with its decoded images, and what is worked out from them once and kept.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock};

use glam::Vec3;

use super::ImageData;
use super::extent::Extent;
use super::motion::BorrowedClip;
use super::rig::Rig;
use crate::anim::{Clip, JointIndex, Pose, SampleCursor, model_from_joint};
use crate::asset::{Asset, Humanoid};
use crate::mesh::Bounds;
use crate::retarget::{Body, LayerClip, recognize};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct ModelId(pub u64);

#[derive(Debug)]
pub struct Model {
    /// Given by the library.
    pub id: ModelId,
    /// What it is called: a file name, URL or `sample:NAME`.
    pub source: String,
    /// What a view lists to get it again: the source, or the archive or folder that it came out of.
    pub origin: String,
    /// It is a person's own file: a page around this one gets to know nothing of it.
    pub is_own: bool,
    pub asset: Arc<Asset>,
    /// One per image of the asset; none where it could not be decoded (a warning says why).
    pub images: Vec<Option<ImageData>>,
    /// Clips of other files, made over for this one; they follow the asset's own.
    borrowed: Vec<BorrowedClip>,
    clip_titles: Vec<String>,
    recognized: OnceLock<(Humanoid, Option<Vec3>)>,
    rig: Rig,
    extent: Extent,
    swept: Mutex<BTreeMap<SweptKey, Bounds>>,
}

/// What a swept box was made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct SweptKey {
    scene: Option<usize>,
    clip: Option<usize>,
    /// The root's travel over the ground is taken out.
    in_place: bool,
}

impl Model {
    /// How often a clip is looked at to find out how far it reaches.
    const SWEEP_SAMPLES: usize = 24;

    pub fn new(source: String, asset: impl Into<Arc<Asset>>, images: Vec<Option<ImageData>>) -> Self {
        let asset = asset.into();
        let clip_titles = unique_titles(asset.clips.iter());
        let rig = Rig::new(&asset);
        let extent = Extent::new(&asset, &rig);
        Self {
            id: ModelId::default(),
            origin: source.clone(),
            is_own: false,
            source,
            asset,
            images,
            borrowed: Vec::new(),
            clip_titles,
            recognized: OnceLock::new(),
            rig,
            extent,
            swept: Mutex::default(),
        }
    }

    /// How many clips there are to play: the asset's own, then the borrowed ones.
    pub fn clip_count(&self) -> usize {
        self.asset.clips.len() + self.borrowed.len()
    }

    pub fn clip(&self, index: usize) -> Option<&Clip> {
        let own = &self.asset.clips;
        own.get(index).or_else(|| Some(&self.borrowed.get(index.checked_sub(own.len())?)?.clip))
    }

    pub fn clips(&self) -> impl Iterator<Item = &Clip> {
        self.asset.clips.iter().chain(self.borrowed.iter().map(|borrowed| &borrowed.clip))
    }

    /// Where a clip comes from, if it is a borrowed one.
    pub fn borrowed(&self, clip: usize) -> Option<&BorrowedClip> {
        self.borrowed.get(clip.checked_sub(self.asset.clips.len())?)
    }

    /// The borrowed clips with their indices among all clips.
    pub fn borrowed_clips(&self) -> impl Iterator<Item = (usize, &BorrowedClip)> {
        self.borrowed.iter().enumerate().map(|(at, borrowed)| (self.asset.clips.len() + at, borrowed))
    }

    /// What plays below a clip on joints that it does not move; nothing for the asset's own clips.
    pub fn layers(&self, clip: usize) -> &[LayerClip] {
        self.borrowed(clip).map_or(&[], |borrowed| &borrowed.layers)
    }

    /// How long a change from one clip to another takes: what the maps of borrowed ones ask for; none is the rest pose.
    pub fn crossfade_secs(&self, from: Option<usize>, to: Option<usize>) -> f64 {
        let secs =
            |clip: Option<usize>| clip.and_then(|clip| self.borrowed(clip)).map_or(0.0, |clip| clip.crossfade_secs);
        secs(from).max(secs(to))
    }

    /// Replaces the borrowed clips.
    pub(super) fn set_borrowed(&mut self, borrowed: Vec<BorrowedClip>) {
        self.borrowed = borrowed;
        self.clip_titles = unique_titles(self.clips());
        let own = self.asset.clips.len();
        if let Ok(mut swept) = self.swept.lock() {
            swept.retain(|key, _| key.clip.is_none_or(|clip| clip < own));
        }
    }

    /// Which joint is which part of a body; worked out once.
    pub fn body(&self) -> Body<'_> {
        Body { asset: &self.asset, slots: &self.recognized().0 }
    }

    /// Where a body's toes and face point at rest, in the file's own axes; none for what is no body.
    pub fn forward(&self) -> Option<Vec3> {
        self.recognized().1
    }

    fn recognized(&self) -> &(Humanoid, Option<Vec3>) {
        self.recognized.get_or_init(|| {
            let found = recognize(&self.asset);
            (found.humanoid(), found.facing.forward)
        })
    }

    /// Names to show a person: one per clip, never empty, never twice the same.
    pub fn clip_titles(&self) -> &[String] {
        &self.clip_titles
    }

    /// Whether there is such a vertex: indices of an instance, a piece of its mesh and a vertex there.
    pub fn has_vertex(&self, instance: usize, primitive: usize, vertex: usize) -> bool {
        let mesh = self.asset.instances.get(instance).and_then(|instance| self.asset.meshes.get(instance.mesh));
        let piece = mesh.and_then(|mesh| mesh.primitives.get(primitive));
        piece.is_some_and(|geometry| vertex < geometry.positions.len())
    }

    /// Which joints make up the skeleton that is drawn, and how they hang together.
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// The scene a choice stands for: an index out of range is the file's default.
    pub fn scene(&self, choice: Option<usize>) -> Option<usize> {
        choice.filter(|&scene| scene < self.asset.scenes.len()).or(self.asset.default_scene)
    }

    /// World-space box of the rest pose of the file's default scene, every vertex skinned. Without a mesh: of the
    /// joints. Empty when there is nothing.
    pub fn rest_bounds(&self) -> Bounds {
        self.extent.rest()
    }

    /// Box around one pose: encloses every vertex (nearly, for dual quaternions), a little wide where joints bend.
    /// `world_from_joint` has one entry per joint; `in_scene` too.
    pub fn pose_bounds(&self, world_from_joint: &[glam::Affine3A], morph_weights: &[f32], in_scene: &[bool]) -> Bounds {
        self.extent.of_pose(&self.asset, &self.rig, world_from_joint, morph_weights, in_scene)
    }

    /// Middle of one mesh instance in a pose, for sorting.
    pub fn instance_center(&self, instance: usize, world_from_joint: &[glam::Affine3A]) -> glam::Vec3 {
        self.extent.instance_center(&self.asset, instance, world_from_joint)
    }

    /// World-space box of everything a clip reaches (no clip: the rest pose) in a scene of the file. With `in_place` the
    /// travel of the root over the ground is taken out. Worked out once.
    pub fn clip_bounds(&self, scene: Option<usize>, clip: Option<usize>, in_place: bool) -> Bounds {
        let scene = self.scene(scene);
        let clip = clip.filter(|&clip| clip < self.clip_count());
        let key = SweptKey { scene, clip, in_place };
        if let Some(bounds) = self.swept.lock().ok().and_then(|swept| swept.get(&key).copied()) {
            return bounds;
        }
        let bounds = self.sweep(key);
        if let Ok(mut swept) = self.swept.lock() {
            swept.insert(key, bounds);
        }
        bounds
    }

    /// The joint whose travel is the character's travel in a clip: the topmost joint of the skin that the clip carries
    /// about, or the topmost at all; none when nothing moves.
    pub fn root_of_clip(&self, clip: usize) -> Option<JointIndex> {
        match self.borrowed(clip) {
            Some(borrowed) => borrowed.root,
            None => self.rig.root_of_clip(clip),
        }
    }

    /// Frames per second that the keys of a clip were set at, as far as their times tell; 30 when they do not.
    pub fn frames_per_sec(&self, clip: usize) -> f64 {
        // What was made over may have keys between the frames of its source.
        match (self.borrowed(clip), self.clip(clip)) {
            (Some(borrowed), _) => borrowed.frames_per_sec,
            (None, Some(clip)) => frames_per_sec(clip),
            (None, None) => DEFAULT_FRAMES_PER_SEC,
        }
    }

    fn sweep(&self, key: SweptKey) -> Bounds {
        let skeleton = &self.asset.skeleton;
        let in_scene = self.asset.joints_in_scene(key.scene);
        let mut pose = skeleton.rest().clone();
        let mut world_from_joint = Vec::with_capacity(skeleton.len());
        let Some(clip) = key.clip.and_then(|clip| self.clip(clip)) else {
            if key.scene == self.asset.default_scene {
                return self.rest_bounds();
            }
            model_from_joint(skeleton, &pose.locals, glam::Affine3A::IDENTITY, &mut world_from_joint);
            return self.pose_bounds(&world_from_joint, &pose.morph_weights, &in_scene);
        };
        let root = key.clip.filter(|_| key.in_place).and_then(|clip| self.root_of_clip(clip));
        let mut start = None;
        let mut cursor = SampleCursor::default();
        let mut bounds = Bounds::EMPTY;
        for sample in 0..=Self::SWEEP_SAMPLES {
            let time_secs = clip.duration_secs() * sample as f32 / Self::SWEEP_SAMPLES as f32;
            pose.copy_from(skeleton.rest());
            clip.sample(skeleton, time_secs, &mut cursor, &mut pose);
            model_from_joint(skeleton, &pose.locals, glam::Affine3A::IDENTITY, &mut world_from_joint);
            let mut at_time = self.pose_bounds(&world_from_joint, &pose.morph_weights, &in_scene);
            if let Some(root) = root {
                let position = glam::Vec3::from(world_from_joint[root.get()].translation);
                let travel = (position - *start.get_or_insert(position)) * glam::Vec3::new(1.0, 0.0, 1.0);
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

pub(super) const DEFAULT_FRAMES_PER_SEC: f64 = 30.0;

/// Frames per second that the keys of a clip were set at, as far as their times tell.
pub(super) fn frames_per_sec(clip: &Clip) -> f64 {
    const COMMON: [f64; 8] = [DEFAULT_FRAMES_PER_SEC, 24.0, 25.0, 60.0, 50.0, 48.0, 120.0, 100.0];
    const MOST_KEYS: usize = 4096;
    let on_frames = |rate: f64| {
        clip.timelines().iter().flatten().take(MOST_KEYS).all(|&time| {
            let frame = f64::from(time) * rate;
            (frame - frame.round()).abs() < 0.02
        })
    };
    COMMON.into_iter().find(|&rate| on_frames(rate)).unwrap_or(DEFAULT_FRAMES_PER_SEC)
}

/// Rest pose and box helpers need poses often enough to name it here.
pub(super) fn rest_world(asset: &Asset) -> Vec<glam::Affine3A> {
    let rest: &Pose = asset.skeleton.rest();
    let mut world_from_joint = Vec::with_capacity(asset.skeleton.len());
    model_from_joint(&asset.skeleton, &rest.locals, glam::Affine3A::IDENTITY, &mut world_from_joint);
    world_from_joint
}

fn unique_titles<'a>(clips: impl Iterator<Item = &'a Clip>) -> Vec<String> {
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    let mut titles = Vec::new();
    for (index, clip) in clips.enumerate() {
        let base = if clip.name().trim().is_empty() { format!("Clip {index}") } else { clip.name().to_owned() };
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
