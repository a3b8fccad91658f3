//! The visible part of a skeleton: which joints count, the bones between them, and the root that carries the character.

use crate::anim::{Clip, JointIndex, Keys};
use crate::asset::Asset;

/// "Real" joints are those of skins and the nodes between them; without a skin, those that clips animate; without a mesh,
/// all. Computed once per model.
#[derive(Debug, Default)]
pub struct Rig {
    real: Vec<bool>,
    bones: Vec<RigBone>,
    roots: Vec<Option<JointIndex>>,
    skin_joints: usize,
}

/// A bone from a joint to one of its children; at the end of a chain, it has no tail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RigBone {
    /// The joint it starts from.
    pub head: JointIndex,
    /// The joint it ends at, a child of `head`.
    pub tail: Option<JointIndex>,
}

impl Rig {
    pub(super) fn new(asset: &Asset) -> Self {
        let skeleton = &asset.skeleton;
        let in_skin = skin_flags(asset);
        let skin_joints = in_skin.iter().filter(|&&inside| inside).count();
        let mut real = in_skin.clone();
        if skin_joints == 0 {
            for channel in asset.clips.iter().flat_map(|clip| clip.channels()) {
                if !matches!(channel.keys, Keys::MorphWeights { .. }) {
                    real[channel.joint.get()] = true;
                }
            }
            if asset.instances.is_empty() {
                let animated = std::mem::replace(&mut real, vec![true; skeleton.len()]);
                drop_containers(asset, &animated, &mut real);
            }
        }
        fill_gaps(asset, &mut real);
        let mut has_child = vec![false; skeleton.len()];
        let mut bones = Vec::new();
        for joint in skeleton.joints().filter(|joint| real[joint.get()]) {
            if let Some(parent) = skeleton.parent(joint).filter(|parent| real[parent.get()]) {
                has_child[parent.get()] = true;
                bones.push(RigBone { head: parent, tail: Some(joint) });
            }
        }
        for joint in skeleton.joints().filter(|joint| real[joint.get()] && !has_child[joint.get()]) {
            bones.push(RigBone { head: joint, tail: None });
        }
        let roots = asset.clips.iter().map(|clip| root_of_clip(asset, clip, &in_skin)).collect();
        Self { real, bones, roots, skin_joints }
    }

    /// Returns whether the joint is real; false if the index is out of range.
    pub fn is_real(&self, joint: JointIndex) -> bool {
        self.real.get(joint.get()).copied().unwrap_or(false)
    }

    /// Returns the bones between real joints, then one without a tail for each end of a chain.
    pub fn bones(&self) -> &[RigBone] {
        &self.bones
    }

    /// Number of distinct joints in the skins.
    pub fn skin_joints(&self) -> usize {
        self.skin_joints
    }

    /// Number of joints to report: those of the skins, or all joints of a skeleton without a mesh.
    pub fn joint_count(&self, asset: &Asset) -> usize {
        if self.skin_joints == 0 && asset.instances.is_empty() { asset.skeleton.len() } else { self.skin_joints }
    }

    pub(super) fn root_of_clip(&self, clip: usize) -> Option<JointIndex> {
        self.roots.get(clip).copied().flatten()
    }
}

/// Unmarks nodes that only contain the animated joints of a skeleton without a mesh (`RootNode`, `Armature`). They stay
/// behind when a clip travels.
fn drop_containers(asset: &Asset, animated: &[bool], real: &mut [bool]) {
    let skeleton = &asset.skeleton;
    let mut contains_animated = vec![false; skeleton.len()];
    for joint in skeleton.joints().rev() {
        if (animated[joint.get()] || contains_animated[joint.get()])
            && let Some(parent) = skeleton.parent(joint)
        {
            contains_animated[parent.get()] = true;
        }
    }
    for joint in skeleton.joints() {
        let below_real = skeleton.parent(joint).is_some_and(|parent| real[parent.get()]);
        real[joint.get()] = below_real || animated[joint.get()] || !contains_animated[joint.get()];
    }
}

/// Marks joints between two real ones.
fn fill_gaps(asset: &Asset, real: &mut [bool]) {
    let skeleton = &asset.skeleton;
    let mut below_real = vec![false; skeleton.len()];
    for joint in skeleton.joints() {
        let parent = skeleton.parent(joint);
        below_real[joint.get()] = parent.is_some_and(|parent| real[parent.get()] || below_real[parent.get()]);
    }
    let mut above_real = vec![false; skeleton.len()];
    for joint in skeleton.joints().rev() {
        if (real[joint.get()] || above_real[joint.get()])
            && let Some(parent) = skeleton.parent(joint)
        {
            above_real[parent.get()] = true;
        }
    }
    for joint in 0..real.len() {
        real[joint] = real[joint] || (below_real[joint] && above_real[joint]);
    }
}

/// Finds the root-motion joint of a clip for this asset.
pub(super) fn root_of(asset: &Asset, clip: &Clip) -> Option<JointIndex> {
    root_of_clip(asset, clip, &skin_flags(asset))
}

/// Whether each joint belongs to a skin.
fn skin_flags(asset: &Asset) -> Vec<bool> {
    let mut in_skin = vec![false; asset.skeleton.len()];
    for joint in asset.skins.iter().flat_map(|skin| skin.joints()) {
        in_skin[joint.get()] = true;
    }
    in_skin
}

fn root_of_clip(asset: &Asset, clip: &Clip, in_skin: &[bool]) -> Option<JointIndex> {
    let is_translated = |channel: &&crate::anim::Channel| match &channel.keys {
        Keys::Translation(values) => values.windows(2).any(|pair| pair[0] != pair[1]),
        _ => false,
    };
    let translated = || clip.channels().iter().filter(is_translated).map(|channel| channel.joint);
    // Parents come first, so the smallest index is a topmost joint.
    translated()
        .filter(|joint| in_skin[joint.get()])
        .min()
        .or_else(|| {
            // A node above the skin travels and carries all its joints along.
            translated().min()?;
            asset.skeleton.joints().find(|joint| in_skin[joint.get()])
        })
        .or_else(|| translated().min())
}
