//! Mirrors a clip across the plane between left and right.
//!
//! Each joint takes on the reflected motion of its counterpart: the rotation and translation away from its rest, in the axes
//! of the model. So the rest pose needn't be quite symmetric, and the joints' own axes don't matter. In the space of a joint,
//! both are linear maps of the keys, so no keys are added, and mirroring twice restores the clip.

use std::collections::HashMap;

use gaitway_character::anim::{JointIndex, PropertyTarget};
use gaitway_character::asset::Asset;
use glam::{DMat3, DQuat, DVec3, Quat, Vec3};

use super::track::{Target, Tracks};
use crate::map::{opposite_joints, pairs_by_side};
use crate::pose::{WorldPose, locals_of};
use crate::recognize::Recognized;

/// Left and right of a skeleton.
#[derive(Debug, Clone)]
pub struct Symmetry {
    /// The counterpart of each joint; joints in the middle, and those without one, are their own.
    opposite: Vec<JointIndex>,
    /// Unit vector from right to left.
    left: DVec3,
}

impl Symmetry {
    /// Finds the counterparts by humanoid slot, else by names that differ only in their side. `recognized` is what
    /// [`recognize`](crate::recognize) finds in the asset.
    pub fn of(asset: &Asset, recognized: &Recognized) -> Self {
        let opposite = opposite_joints(&asset.skeleton, recognized);
        let mutual = |joint: JointIndex| {
            opposite[joint.get()].filter(|other| opposite[other.get()] == Some(joint)).unwrap_or(joint)
        };
        let left = recognized.facing.left.unwrap_or(Vec3::X);
        Self {
            opposite: asset.skeleton.joints().map(mutual).collect(),
            left: (left.as_dvec3() * DVec3::new(1.0, 0.0, 1.0)).try_normalize().unwrap_or(DVec3::X),
        }
    }

    /// Number of joints that have a counterpart.
    pub fn paired(&self) -> usize {
        self.opposite.iter().enumerate().filter(|(joint, other)| other.get() != *joint).count()
    }

    fn reflection(&self) -> DMat3 {
        let n = self.left;
        DMat3::IDENTITY - 2.0 * DMat3::from_cols(n * n.x, n * n.y, n * n.z)
    }
}

pub fn mirror(tracks: &mut Tracks, asset: &Asset, symmetry: &Symmetry) {
    let skeleton = &asset.skeleton;
    let rest = WorldPose::new(skeleton, locals_of(skeleton.rest()), DQuat::IDENTITY);
    let reflection = symmetry.reflection();
    let names = asset.avatar.expressions.iter().map(|expression| expression.name.as_str());
    let expressions: Vec<[usize; 2]> = pairs_by_side(names).collect();
    // The names of a node's morph targets, as far as they have any.
    let named =
        asset.instances.iter().rev().map(|instance| (instance.joint, &asset.meshes[instance.mesh].target_names));
    let named: HashMap<JointIndex, &Vec<String>> = named.collect();
    let target_names = |node: &JointIndex| named.get(node).into_iter().copied().flatten().map(String::as_str);
    for track in &mut tracks.tracks {
        match &mut track.target {
            Target::Rotation(joint) => {
                let (from, to) = (*joint, symmetry.opposite[joint.get()]);
                *joint = to;
                let (from_parent, from_rest) = (rest.parent_rotation(skeleton, from), rest.rotation(from).inverse());
                let (before, after) = (rest.parent_rotation(skeleton, to).inverse(), rest.rotation(to));
                track.map(
                    |entry| {
                        let local = Quat::from_slice(entry).as_dquat();
                        let away = from_parent * local * from_rest;
                        // The axis is a pseudovector: reflecting also negates it.
                        let axis = -(reflection * DVec3::new(away.x, away.y, away.z));
                        let mirrored = before * DQuat::from_xyzw(axis.x, axis.y, axis.z, away.w) * after;
                        mirrored.as_quat().write_to_slice(entry);
                    },
                    &[],
                );
            }
            Target::Translation(joint) => {
                let (from, to) = (*joint, symmetry.opposite[joint.get()]);
                *joint = to;
                let [from_frame, to_frame] = [from, to].map(|joint| rest.parent_frame(skeleton, joint).matrix3);
                let inverse = to_frame.inverse();
                let inverse = if inverse.is_finite() { inverse } else { DMat3::IDENTITY };
                let linear = inverse * reflection * from_frame;
                let [from_rest, to_rest] = [from, to].map(|joint| rest.locals[joint.get()].translation);
                let affine = (to_rest - linear * from_rest).as_vec3();
                track.map(
                    |entry| {
                        (linear * Vec3::from_slice(entry).as_dvec3()).as_vec3().write_to_slice(entry);
                    },
                    &affine.to_array(),
                );
            }
            Target::Scale(joint) => *joint = symmetry.opposite[joint.get()],
            Target::Property(PropertyTarget::LookAt) => track.map(|angles| angles[0] = -angles[0], &[]),
            Target::Property(PropertyTarget::Expression(index)) => {
                *index = partner(expressions.iter().copied(), *index);
            }
            Target::Property(PropertyTarget::MorphWeight(joint, target)) => {
                *target = partner(pairs_by_side(target_names(joint)), *target);
            }
            Target::Weights(joint) => {
                for [left, right] in pairs_by_side(target_names(joint).take(track.width)) {
                    track.map(|weights| weights.swap(left, right), &[]);
                }
            }
            Target::Property(_) => {}
        }
    }
}

/// Returns the other one of the pair that an index is in, else the index itself.
fn partner(mut pairs: impl Iterator<Item = [usize; 2]>, index: usize) -> usize {
    pairs.find(|pair| pair.contains(&index)).map_or(index, |[left, right]| if index == left { right } else { left })
}
