//! A loaded file with its decoded images and cached derived data.
//!
//! A changed clip takes the place of its original, so that the player, exporters and panels need to know nothing of changes.
//! An empty stage is a model, too, with one node and no surfaces, so that nothing else has to do without one.

use std::sync::{Arc, OnceLock};

use gaitway_character::anim::{Joint, JointIndex, Skeleton};
use gaitway_character::asset::{Asset, AssetParts, Humanoid, MeshInstance, SceneJoints, Warning};
use gaitway_character::mesh::{Bounds, Mesh};
use gaitway_retarget::{Body, Recognized, Symmetry, recognize};
use gaitway_session::MEMBER_SEPARATOR;
use glam::{Affine3A, Vec3};

use super::borrowed::BorrowedClip;
use super::clips::{ClipEdits, ClipId, Clips, ModelClip};
use super::extent::Extent;
use super::lints::{joint_of_place, lint};
use super::rig::Rig;
use super::{ImageData, Images};

/// Returns the folder or archive a model came from: `ARCHIVE` for `ARCHIVE#!/MEMBER`, any other origin unchanged.
pub fn container_of(origin: &str) -> &str {
    origin.split_once(MEMBER_SEPARATOR).map_or(origin, |(container, _)| container)
}

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
    /// Its decoded images.
    pub images: Images,
    clips: Clips,
    slots: Humanoid,
    recognized: Recognized,
    findings: OnceLock<Vec<Finding>>,
    rig: Rig,
    extent: Extent,
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

impl Model {
    /// Wraps an asset. `images` has one entry per image of the asset. The origin is the source until the caller sets
    /// another.
    pub fn new(source: String, asset: impl Into<Arc<Asset>>, images: impl Into<Images>) -> Self {
        let asset = asset.into();
        let derived = Derived::new(&asset);
        Self::with_derived(source, asset, derived, images)
    }

    /// Like [`Self::new`], with what has already been derived from the same asset.
    pub fn with_derived(
        source: String,
        asset: impl Into<Arc<Asset>>,
        derived: Derived,
        images: impl Into<Images>,
    ) -> Self {
        let asset = asset.into();
        let Derived { rig, extent, recognized } = derived;
        let mut model = Self {
            id: ModelId::default(),
            origin: source.clone(),
            is_own: false,
            is_placeholder: false,
            source,
            asset,
            images: images.into(),
            clips: Clips::default(),
            slots: recognized.humanoid(),
            recognized,
            findings: OnceLock::new(),
            rig,
            extent,
        };
        model.list_clips(&[], ClipEdits::default());
        model
    }

    /// Whether the model was opened before its images had arrived, and they still haven't.
    pub fn awaits_images(&self) -> bool {
        matches!(self.images, Images::Awaited(_))
    }

    /// Takes images and warnings from the same model, read from its complete file.
    pub(super) fn complete(&mut self, complete: Self) {
        (self.asset, self.images, self.findings) = (complete.asset, complete.images, OnceLock::new());
    }

    /// The clips that it can play.
    pub fn clips(&self) -> &Clips {
        &self.clips
    }

    /// The first clip of the motions that were opened for the model. Those in its own archive are part of it.
    pub fn first_opened_clip(&self) -> Option<&ModelClip> {
        let is_opened = |borrowed: &BorrowedClip| borrowed.motion.origin() != container_of(&self.origin);
        self.clips.borrowed().find(|(_, borrowed)| is_opened(borrowed)).map(|(clip, _)| clip)
    }

    /// Finds one of its clips.
    pub fn clip(&self, id: &ClipId) -> Option<&ModelClip> {
        self.clips.get(id)
    }

    /// Replaces what the user has done to its clips; returns whether that differs from before.
    pub(super) fn edit_clips(&mut self, edits: &ClipEdits) -> bool {
        let is_changed = self.clips.edits() != edits;
        if is_changed {
            self.list_clips(&self.clips.shared_borrowed(), edits.clone());
        }
        is_changed
    }

    /// The retargeted clips, in the order of the motions.
    pub(super) fn shared_borrowed(&self) -> Vec<Arc<BorrowedClip>> {
        self.clips.shared_borrowed()
    }

    /// Replaces the retargeted clips.
    pub(super) fn set_borrowed(&mut self, borrowed: &[Arc<BorrowedClip>]) {
        self.list_clips(borrowed, self.clips.edits().clone());
    }

    fn list_clips(&mut self, borrowed: &[Arc<BorrowedClip>], edits: ClipEdits) {
        let before = std::mem::take(&mut self.clips);
        let symmetry = || Symmetry::of(&self.asset, &self.recognized);
        self.clips = Clips::new(&self.source, &self.asset, self.rig.roots(), borrowed, edits, before, symmetry);
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
        self.images.shown().iter().flatten().map(ImageData::device_bytes).sum()
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
}
