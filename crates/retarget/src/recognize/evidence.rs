//! What an asset shows about its joints besides names: where they are in its poses, which of them a clip turns, and how much
//! of the skin each one holds.

use gaitway_character::anim::{JointIndex, Pose, SampleCursor, model_from_joint};
use gaitway_character::asset::Asset;
use glam::{Affine3A, Vec3};

use crate::pose::mirror_from_model;

/// Number of times at which the first clip is sampled.
const MOMENTS: u8 = 8;

/// Smaller changes of a rotation are ignored.
const MIN_TURN: f32 = 1e-3;

pub(super) struct Evidence {
    /// Positions of all joints in model space: at rest, then at moments of the first clip.
    pub poses: Vec<Vec<Vec3>>,
    /// By joint: the box around the vertices at rest that it influences most.
    regions: Vec<Option<Region>>,
    is_skinned: Option<Vec<bool>>,
    turns: Option<Vec<bool>>,
}

/// A box in model space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Region {
    pub min: Vec3,
    pub max: Vec3,
}

impl Region {
    pub fn size(self) -> f32 {
        (self.max - self.min).length()
    }
}

impl Evidence {
    pub fn new(asset: &Asset) -> Self {
        let skeleton = &asset.skeleton;
        let at_rest = matrices(asset, skeleton.rest());
        let regions = regions(asset, &at_rest);
        let mut poses = vec![positions(&at_rest)];
        let mut turns = None;
        if let Some(clip) = asset.clips.first() {
            let (mut pose, mut cursor) = (skeleton.rest().clone(), SampleCursor::default());
            let mut moved = vec![false; skeleton.len()];
            let mut first: Option<Pose> = None;
            for moment in 0..MOMENTS {
                let time_secs = clip.duration_secs() * f32::from(moment) / f32::from(MOMENTS);
                clip.sample(skeleton, time_secs, &mut cursor, &mut pose);
                poses.push(positions(&matrices(asset, &pose)));
                let first = first.get_or_insert_with(|| pose.clone());
                for (moved, (now, then)) in moved.iter_mut().zip(pose.locals().zip(first.locals())) {
                    *moved |= now.rotation.dot(then.rotation).abs() < 1.0 - MIN_TURN * MIN_TURN;
                }
            }
            turns = Some(moved).filter(|moved| moved.contains(&true));
        }
        let is_skinned = (!asset.skins.is_empty()).then(|| {
            let mut skinned = vec![false; skeleton.len()];
            for joint in asset.skins.iter().flat_map(|skin| skin.joints()) {
                skinned[joint.get()] = true;
            }
            skinned
        });
        Self { poses, regions, is_skinned, turns }
    }

    /// None if the joint holds no vertex, or there is no mesh.
    pub fn region(&self, joint: JointIndex) -> Option<Region> {
        self.regions[joint.get()]
    }

    /// Whether a joint holds vertices or is in a skin; None without a skin.
    pub fn is_skinned(&self, joint: JointIndex) -> Option<bool> {
        let skinned = self.is_skinned.as_ref()?;
        Some(skinned[joint.get()] || self.regions[joint.get()].is_some())
    }

    /// Whether the first clip turns a joint; None without a clip, or if it turns none.
    pub fn turns(&self, joint: JointIndex) -> Option<bool> {
        self.turns.as_ref().map(|turns| turns[joint.get()])
    }
}

/// By joint: the box around the vertices at rest that it influences most.
pub(super) fn regions_at_rest(asset: &Asset) -> Vec<Option<Region>> {
    regions(asset, &matrices(asset, asset.skeleton.rest()))
}

/// The middle of the vertices at rest that a joint influences most, in the space of [`crate::pose::node_locals`].
pub fn middle_of_skin(asset: &Asset, joint: JointIndex) -> Option<Vec3> {
    regions_at_rest(asset)[joint.get()].map(|region| region.min.midpoint(region.max))
}

fn matrices(asset: &Asset, pose: &Pose) -> Vec<Affine3A> {
    let mut matrices = Vec::new();
    model_from_joint(&asset.skeleton, pose, mirror_from_model(&asset.skeleton), &mut matrices);
    matrices
}

fn positions(matrices: &[Affine3A]) -> Vec<Vec3> {
    matrices.iter().map(|matrix| matrix.translation.into()).collect()
}

fn regions(asset: &Asset, at_rest: &[Affine3A]) -> Vec<Option<Region>> {
    let mut regions = vec![None; at_rest.len()];
    for instance in &asset.instances {
        let skin = instance.skin.map(|skin| &asset.skins[skin]);
        let at_rest_from_mesh = at_rest[instance.joint.get()] * instance.joint_from_mesh;
        for geometry in &asset.meshes[instance.mesh].primitives {
            for (vertex, position) in geometry.positions.iter().enumerate() {
                let Some(skin) = skin else {
                    grow(&mut regions, instance.joint, at_rest_from_mesh.transform_point3(*position));
                    continue;
                };
                let strongest = geometry.influences.of_vertex(vertex).max_by(|a, b| a.1.total_cmp(&b.1));
                let Some(slot) = strongest.map(|(slot, _)| usize::from(slot)) else { continue };
                let joint = skin.joints()[slot];
                let model_from_bind = at_rest[joint.get()] * skin.joint_from_bind()[slot];
                grow(&mut regions, joint, model_from_bind.transform_point3(*position));
            }
        }
    }
    regions
}

fn grow(regions: &mut [Option<Region>], joint: JointIndex, at: Vec3) {
    let region = regions[joint.get()].get_or_insert(Region { min: at, max: at });
    (region.min, region.max) = (region.min.min(at), region.max.max(at));
}
