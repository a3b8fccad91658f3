//! Detects two files of one rig: same joint names, hierarchy and local frames. The rest of the motion's nodes is then
//! irrelevant: its clip means the same on the model as on its own skeleton, so the model's rest is the motion's.
//!
//! No file states its local frames, but each joint's offset is expressed in its parent's. A rest rotation leaves that
//! offset unchanged, whereas different axes rotate it; so do differences in build, by little. Between rests that hold the
//! same pose, any rotation of an offset and any roll about it means different axes.

use std::collections::BTreeMap;

use gaitway_character::anim::{Clip, JointIndex, Keys, Skeleton};
use gaitway_character::sort::sort_by;
use glam::{DMat3, DQuat, DVec3};

use crate::map::{ResolvedMap, shared_names};
use crate::math::{angle_between, degrees_between, unit};
use crate::pose::{Local, WorldPose, ancestry, node_locals};

/// Minimum share of the mapped joints that must share their names, and of these that must agree.
const MIN_SHARE: f64 = 0.9;

/// Minimum number of offsets to identify a rig.
const MIN_OFFSETS: usize = 3;

/// Offsets of characters on one rig differ by build (20° at a shoulder), those in different axes mostly by 90° or more.
const MAX_OFFSET_DEGREES: f64 = 25.0;

/// A joint whose rests differ by more than this while the pose around it is the same has different axes.
const MIN_ROLL_DEGREES: f64 = 45.0;

/// The pose around a joint is the same if the angles to all other offsets differ by less than this on average.
const MAX_POSE_DEGREES: f64 = 10.0;

/// Rests whose offsets differ by less than this in their angles to each other are the same pose.
const SAME_POSE_DEGREES: f64 = 1.0;

/// Maximum number of offsets that each one is compared with.
const MAX_COMPARED: usize = 100;

/// Minimum number of rolled joints that indicates different axes. A single one may be posed.
const MIN_ROLLED: usize = 2;

/// A skeleton in its rest pose.
#[derive(Clone, Copy)]
pub struct Resting<'a> {
    pub skeleton: &'a Skeleton,
    pub locals: &'a [Local],
}

/// The source in the model's rest.
#[derive(Debug)]
pub struct SharedRest {
    pub locals: Vec<Local>,
    /// Local transforms of joints that the clip does not animate: the model's, as if the clip were on the model.
    pub unmoved: Vec<Local>,
    /// Turns the source's model space into the target's.
    pub target_from_source: DQuat,
}

/// A skeleton in its own rest pose, usable or not.
#[derive(Clone, Copy)]
pub struct OwnRest<'a> {
    pub resting: Resting<'a>,
    /// Whether the body stands, so that its hips are at their rest position.
    pub is_standing: bool,
}

/// Returns the source in the model's rest if both are the same rig, or None.
pub fn shared_rest(target: Resting, own: OwnRest, clip: &Clip, map: &ResolvedMap) -> Option<SharedRest> {
    let source = own.resting;
    let target_of = counterparts(target.skeleton, source.skeleton);
    let rigs = Rigs {
        target,
        source,
        target_pose: WorldPose::new(target.skeleton, target.locals.to_vec(), DQuat::IDENTITY),
        source_pose: WorldPose::new(source.skeleton, source.locals.to_vec(), DQuat::IDENTITY),
        target_of: &target_of,
    };
    if !rigs.agree(map) {
        return None;
    }
    let is_shared = moved_with_their_children(source.skeleton, clip, &target_of);
    rigs.repose(is_shared, own.is_standing)
}

/// The target joint of the same name, by source joint.
fn counterparts(target: &Skeleton, source: &Skeleton) -> Vec<Option<JointIndex>> {
    let mut target_of = vec![None; source.len()];
    for (target, source) in shared_names(target, source) {
        target_of[source.get()] = Some(target);
    }
    target_of
}

fn moved_with_their_children(source: &Skeleton, clip: &Clip, target_of: &[Option<JointIndex>]) -> Vec<bool> {
    let mut is_moved = vec![false; source.len()];
    for channel in clip.channels() {
        is_moved[channel.joint.get()] |= !matches!(channel.keys, Keys::MorphWeights { .. });
    }
    for joint in source.joints() {
        is_moved[joint.get()] |= source.parent(joint).is_some_and(|parent| is_moved[parent.get()]);
    }
    is_moved.iter().zip(target_of).map(|(&moved, target)| moved && target.is_some()).collect()
}

/// A joint that both have, and its offset from a parent that both have.
struct Offset {
    target: JointIndex,
    source: JointIndex,
    source_parent: JointIndex,
}

struct Rigs<'a> {
    target: Resting<'a>,
    source: Resting<'a>,
    /// Both rests in their own model spaces.
    target_pose: WorldPose,
    source_pose: WorldPose,
    target_of: &'a [Option<JointIndex>],
}

impl Rigs<'_> {
    /// Whether names, hierarchy and local frames of the mapped joints agree.
    fn agree(&self, map: &ResolvedMap) -> bool {
        let mut sources: Vec<JointIndex> = map.pairs.iter().map(|pair| pair.source).collect();
        sort_by(&mut sources, Ord::cmp);
        sources.dedup();
        let named = sources.iter().filter(|source| self.target_of[source.get()].is_some()).count();
        let (mut same_place, mut offsets) = (0, Vec::new());
        for &source in &sources {
            let Some(target) = self.target_of[source.get()] else { continue };
            same_place += usize::from(self.hangs_alike(target, source));
            offsets.extend(self.offset(target, source));
        }
        let agreeing = offsets.iter().filter(|offset| self.offset_degrees(offset) < MAX_OFFSET_DEGREES).count();
        let most = |count: usize, of: usize| count as f64 >= MIN_SHARE * of as f64;
        agreeing >= MIN_OFFSETS
            && most(named, sources.len())
            && most(same_place, named)
            && most(agreeing, offsets.len())
            && !self.has_other_ends(&offsets)
            && !self.is_rolled(&offsets)
            && !self.is_same_pose_in_other_axes(&offsets)
    }

    /// Whether the nearest shared ancestors correspond. Either side may have joints in between.
    fn hangs_alike(&self, target: JointIndex, source: JointIndex) -> bool {
        let above = ancestry(self.source.skeleton, source).skip(1).find_map(|joint| self.target_of[joint.get()]);
        above.is_none_or(|above| ancestry(self.target.skeleton, target).skip(1).any(|joint| joint == above))
    }

    fn offset(&self, target: JointIndex, source: JointIndex) -> Option<Offset> {
        let source_parent = self.source.skeleton.parent(source)?;
        let target_parent = self.target.skeleton.parent(target)?;
        let are_same = self.target_of[source_parent.get()] == Some(target_parent);
        let has_length = |locals: &[Local], joint: JointIndex| locals[joint.get()].translation.length() > 1e-6;
        (are_same && has_length(self.target.locals, target) && has_length(self.source.locals, source))
            .then_some(Offset { target, source, source_parent })
    }

    /// Angle between the two directions of an offset in its parent's frame.
    fn offset_degrees(&self, offset: &Offset) -> f64 {
        let target = self.target.locals[offset.target.get()].translation;
        let source = self.source.locals[offset.source.get()].translation;
        degrees_between(target, source)
    }

    /// Whether the axes of joints with few children, such as feet and hands, differ: too few offsets to count among all others.
    fn has_other_ends(&self, offsets: &[Offset]) -> bool {
        let mut nearest_of_parent: BTreeMap<JointIndex, f64> = BTreeMap::new();
        for offset in offsets {
            let nearest = nearest_of_parent.entry(offset.source_parent).or_insert(f64::INFINITY);
            *nearest = nearest.min(self.offset_degrees(offset));
        }
        nearest_of_parent.values().filter(|&&degrees| degrees > MIN_ROLL_DEGREES).count() >= MIN_ROLLED
    }

    /// Whether joints are rolled about their children's offsets between rests that hold the same pose around them.
    fn is_rolled(&self, offsets: &[Offset]) -> bool {
        let is_turned = |offset: &&Offset| {
            let [target, source] =
                [self.target.locals[offset.target.get()].rotation, self.source.locals[offset.source.get()].rotation];
            angle_between(target, source).to_degrees() > MIN_ROLL_DEGREES
        };
        let turned: Vec<JointIndex> = offsets.iter().filter(is_turned).map(|offset| offset.source).collect();
        // Comparing each offset with the others takes longer than retargeting a short clip.
        if turned.len() < MIN_ROLLED {
            return false;
        }
        let mut worst_of_parent: BTreeMap<JointIndex, f64> = BTreeMap::new();
        for (offset, difference) in offsets.iter().zip(self.pose_differences(offsets)) {
            let worst = worst_of_parent.entry(offset.source_parent).or_default();
            *worst = worst.max(difference);
        }
        let has_same_pose =
            |joint: &&JointIndex| worst_of_parent.get(joint).is_some_and(|&worst| worst < MAX_POSE_DEGREES);
        turned.iter().filter(has_same_pose).count() >= MIN_ROLLED
    }

    /// Whether the rests hold the same pose although the offsets in the joints' own axes differ, or although the source's joints
    /// have no rotations at all, as in BVH. The usual limit on offsets, which allows for differences in build, is too wide where
    /// the pose tells.
    fn is_same_pose_in_other_axes(&self, offsets: &[Offset]) -> bool {
        let degrees = |offset: &Offset| {
            angle_between(self.source.locals[offset.source.get()].rotation, DQuat::IDENTITY).to_degrees()
        };
        let has_other_axes = offsets.iter().any(|offset| self.offset_degrees(offset) > SAME_POSE_DEGREES);
        (has_other_axes || offsets.iter().all(|offset| degrees(offset) < 1e-3))
            && self.directions(offsets).windows(2).all(|pair| difference(&pair[0], &pair[1]) < SAME_POSE_DEGREES)
    }

    /// For each offset, the mean difference in degrees between its angles to the others in the two rests. Angles
    /// between offsets are independent of the frame.
    fn pose_differences(&self, offsets: &[Offset]) -> Vec<f64> {
        let directions = self.directions(offsets);
        let others = directions.iter().step_by(directions.len().div_ceil(MAX_COMPARED).max(1));
        let mean =
            |at: &[DVec3; 2]| others.clone().map(|other| difference(at, other)).sum::<f64>() / others.len() as f64;
        directions.iter().map(mean).collect()
    }

    /// The direction of each offset in both rests, target first, in their own model spaces.
    fn directions(&self, offsets: &[Offset]) -> Vec<[DVec3; 2]> {
        let direction = |pose: &WorldPose, skeleton: &Skeleton, joint: JointIndex| {
            let parent = skeleton.parent(joint).map_or(DVec3::ZERO, |parent| pose.position(parent));
            (pose.position(joint) - parent).normalize_or_zero()
        };
        offsets
            .iter()
            .map(|offset| {
                [
                    direction(&self.target_pose, self.target.skeleton, offset.target),
                    direction(&self.source_pose, self.source.skeleton, offset.source),
                ]
            })
            .collect()
    }

    /// Puts the source's shared joints into the model's rest pose, including the root position unless `is_in_place`.
    fn repose(&self, is_shared: Vec<bool>, is_in_place: bool) -> Option<SharedRest> {
        let source = self.source.skeleton;
        let tops = tops(source, &is_shared);
        let (&main, _) = tops.iter().rev().max_by_key(|(_, below)| **below)?;
        let source_from_target = self.source_from_target(main)?;
        let size = self.size_ratio(&is_shared);
        let mut locals = self.source.locals.to_vec();
        self.turn(&mut locals, &is_shared, &self.target_pose, source_from_target);
        let nodes = WorldPose::new(self.target.skeleton, node_locals(self.target.skeleton), DQuat::IDENTITY);
        let mut unmoved = node_locals(source);
        self.turn(&mut unmoved, &is_shared, &nodes, source_from_target);
        // The position of a moving root is no more a rest than its rotation.
        for &top in tops.keys().filter(|_| !is_in_place) {
            let Some(target) = self.target_of[top.get()] else { continue };
            let position = source_from_target * self.target_pose.position(target) * size;
            let parent_from_model = self.source_pose.parent_frame(source, top).inverse();
            locals[top.get()].translation = parent_from_model.transform_point3(position);
            unmoved[top.get()].translation = locals[top.get()].translation;
        }
        Some(SharedRest { locals, unmoved, target_from_source: source_from_target.conjugate() })
    }

    /// Rotates the shared joints to match the target's in `pose`.
    fn turn(&self, locals: &mut [Local], is_shared: &[bool], pose: &WorldPose, source_from_target: DQuat) {
        let source = self.source.skeleton;
        let mut rotations: Vec<DQuat> = Vec::with_capacity(locals.len());
        for joint in source.joints() {
            let parent = source.parent(joint).map_or(DQuat::IDENTITY, |parent| rotations[parent.get()]);
            let rotation = match self.target_of[joint.get()].filter(|_| is_shared[joint.get()]) {
                Some(target) => unit(source_from_target * pose.rotation(target)),
                None => unit(parent * locals[joint.get()].rotation),
            };
            locals[joint.get()].rotation = unit(parent.conjugate() * rotation);
            rotations.push(rotation);
        }
    }

    /// Returns the rotation from the target's model space to the source's, which is the one between the ancestors of
    /// the moving joints. If the source's own rest contradicts it, two exporters write the same thing differently, and
    /// the rest gives the rotation to a quarter turn.
    fn source_from_target(&self, top: JointIndex) -> Option<DQuat> {
        let target = self.target_of[top.get()]?;
        // Nothing animates the ancestors, so they are at their node transforms, whatever a skin says.
        let parent_rotation = |skeleton: &Skeleton, joint: JointIndex| {
            let nodes = node_locals(skeleton);
            ancestry(skeleton, joint).skip(1).fold(DQuat::IDENTITY, |below, joint| nodes[joint.get()].rotation * below)
        };
        let above =
            parent_rotation(self.source.skeleton, top) * parent_rotation(self.target.skeleton, target).conjugate();
        let rests = self.source_pose.rotation(top) * self.target_pose.rotation(target).conjugate();
        let is_turned = angle_between(above, DQuat::IDENTITY).to_degrees() > 1.0;
        let contradicts = angle_between(above, rests).to_degrees() > 45.0;
        Some(if is_turned && contradicts { nearest_quarter_turn(rests) } else { unit(above) })
    }

    /// Ratio of source to target bone length.
    fn size_ratio(&self, is_shared: &[bool]) -> f64 {
        let (mut source, mut target) = (0.0, 0.0);
        for joint in self.source.skeleton.joints().filter(|joint| is_shared[joint.get()]) {
            let offset = self.target_of[joint.get()].and_then(|target| self.offset(target, joint));
            let Some(Offset { source_parent, target: target_joint, .. }) = offset else { continue };
            let Some(target_parent) = self.target.skeleton.parent(target_joint) else { continue };
            if is_shared[source_parent.get()] {
                source += self.source_pose.position(joint).distance(self.source_pose.position(source_parent));
                target += self.target_pose.position(target_joint).distance(self.target_pose.position(target_parent));
            }
        }
        if source > 0.0 && target > 0.0 { source / target } else { 1.0 }
    }
}

/// By how much the angle between two offsets differs in the two rests, in degrees.
fn difference(a: &[DVec3; 2], b: &[DVec3; 2]) -> f64 {
    (degrees_between(a[0], b[0]) - degrees_between(a[1], b[1])).abs()
}

/// The topmost shared joints, with the number of joints in each one's subtree.
fn tops(skeleton: &Skeleton, is_shared: &[bool]) -> BTreeMap<JointIndex, usize> {
    let mut tops = BTreeMap::new();
    let mut top_of: Vec<Option<JointIndex>> = Vec::with_capacity(is_shared.len());
    for joint in skeleton.joints() {
        let above = skeleton.parent(joint).and_then(|parent| top_of[parent.get()]);
        let top = above.or_else(|| is_shared[joint.get()].then_some(joint));
        top_of.push(top);
        if let Some(top) = top {
            *tops.entry(top).or_default() += 1;
        }
    }
    tops
}

/// The nearest rotation that maps axes to axes.
fn nearest_quarter_turn(rotation: DQuat) -> DQuat {
    let matrix = DMat3::from_quat(rotation);
    let x = nearest_axis(matrix.x_axis);
    let y = nearest_axis(matrix.y_axis - x * x.dot(matrix.y_axis));
    unit(DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))))
}

fn nearest_axis(direction: DVec3) -> DVec3 {
    let size = direction.abs();
    let axis = if size.x >= size.y.max(size.z) {
        DVec3::X
    } else if size.y >= size.z {
        DVec3::Y
    } else {
        DVec3::Z
    };
    axis * axis.dot(direction).signum()
}
