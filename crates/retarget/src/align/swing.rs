//! Swings the target's limbs at rest to the directions of the source's: A-pose to T-pose and so on.

use std::collections::BTreeMap;

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::{Asset, Humanoid, Slot};
use gaitway_character::sort::collect_map;
use glam::{DQuat, DVec3};

use crate::map::ResolvedMap;
use crate::math::{angle_between, degrees_between, unit};
use crate::pose::{WorldPose, ancestry, is_within, node_locals};
use crate::recognize::middle_of_skin;

/// Segments to align, from joint to joint, parents first.
const LIMBS: [(Slot, Slot); 8] = [
    (Slot::LeftUpperLeg, Slot::LeftLowerLeg),
    (Slot::LeftLowerLeg, Slot::LeftFoot),
    (Slot::RightUpperLeg, Slot::RightLowerLeg),
    (Slot::RightLowerLeg, Slot::RightFoot),
    (Slot::LeftUpperArm, Slot::LeftLowerArm),
    (Slot::LeftLowerArm, Slot::LeftHand),
    (Slot::RightUpperArm, Slot::RightLowerArm),
    (Slot::RightLowerArm, Slot::RightHand),
];

/// The same for hands and fingers, which the figures leave out.
const FINGERS: [(Slot, Slot); 22] = [
    (Slot::LeftHand, Slot::LeftMiddleProximal),
    (Slot::LeftThumbMetacarpal, Slot::LeftThumbProximal),
    (Slot::LeftThumbProximal, Slot::LeftThumbDistal),
    (Slot::LeftIndexProximal, Slot::LeftIndexIntermediate),
    (Slot::LeftIndexIntermediate, Slot::LeftIndexDistal),
    (Slot::LeftMiddleProximal, Slot::LeftMiddleIntermediate),
    (Slot::LeftMiddleIntermediate, Slot::LeftMiddleDistal),
    (Slot::LeftRingProximal, Slot::LeftRingIntermediate),
    (Slot::LeftRingIntermediate, Slot::LeftRingDistal),
    (Slot::LeftLittleProximal, Slot::LeftLittleIntermediate),
    (Slot::LeftLittleIntermediate, Slot::LeftLittleDistal),
    (Slot::RightHand, Slot::RightMiddleProximal),
    (Slot::RightThumbMetacarpal, Slot::RightThumbProximal),
    (Slot::RightThumbProximal, Slot::RightThumbDistal),
    (Slot::RightIndexProximal, Slot::RightIndexIntermediate),
    (Slot::RightIndexIntermediate, Slot::RightIndexDistal),
    (Slot::RightMiddleProximal, Slot::RightMiddleIntermediate),
    (Slot::RightMiddleIntermediate, Slot::RightMiddleDistal),
    (Slot::RightRingProximal, Slot::RightRingIntermediate),
    (Slot::RightRingIntermediate, Slot::RightRingDistal),
    (Slot::RightLittleProximal, Slot::RightLittleIntermediate),
    (Slot::RightLittleIntermediate, Slot::RightLittleDistal),
];

/// Segments whose directions the figures compare: the limbs and the torso.
pub fn compared_segments() -> impl Iterator<Item = (Slot, Slot)> {
    LIMBS.into_iter().chain([(Slot::Hips, Slot::Head)])
}

/// Feet and torsos differ in build (heel height, curve of the spine), and a difference in build is not one in posture.
/// They are aligned only beyond these angles.
const MIN_FOOT_TURN_DEGREES: f64 = 40.0;
const MIN_TORSO_TURN_DEGREES: f64 = 15.0;

/// A knee or elbow bent by less than this does not define the roll of its limb.
const MIN_BEND_DEGREES: f64 = 10.0;

/// One of the two bodies.
#[derive(Clone, Copy)]
pub struct Side<'a> {
    pub asset: &'a Asset,
    pub slots: &'a Humanoid,
    /// The rest in the common frame.
    pub pose: &'a WorldPose,
}

/// What the swings depend on: both bodies and which pair fills which slot.
#[derive(Clone, Copy)]
pub struct SwingInput<'a> {
    pub map: &'a ResolvedMap,
    pub pair_of_slot: &'a BTreeMap<Slot, usize>,
    pub source: Side<'a>,
    pub target: Side<'a>,
}

impl SwingInput<'_> {
    /// Both directions of a segment, source first.
    fn directions(&self, from: Slot, to: Slot) -> Option<[DVec3; 2]> {
        let (pair, end) = (&self.map.pairs[*self.pair_of_slot.get(&from)?], self.pair_of_slot.get(&to));
        let (source, target) = (self.source, self.target);
        let ends = match end.map(|&end| &self.map.pairs[end]) {
            Some(end) => [source.pose.position(end.source), target.pose.position(end.target)],
            // If neither side has the end, nothing says that both limbs continue alike.
            None if LIMBS.contains(&(from, to)) && [source, target].iter().any(|side| side.has(to)) => {
                [source.unmapped_end(pair.source, to)?, target.unmapped_end(pair.target, to)?]
            }
            None => return None,
        };
        let from_source = ends[0] - source.pose.position(pair.source);
        let from_target = ends[1] - target.pose.position(pair.target);
        Some([from_source.try_normalize()?, from_target.try_normalize()?])
    }
}

impl Side<'_> {
    fn has(&self, slot: Slot) -> bool {
        self.slots.joint(slot).is_some()
    }

    /// Returns where a limb without a mapped end leads: to the joint in the end's slot, or else to its farthest child or the middle of
    /// its skin.
    fn unmapped_end(&self, joint: JointIndex, slot: Slot) -> Option<DVec3> {
        let skeleton = &self.asset.skeleton;
        if let Some(end) = self.slots.joint(slot).filter(|&end| is_within(skeleton, end, joint)) {
            return Some(self.pose.position(end));
        }
        let start = self.pose.position(joint);
        let children = skeleton.joints().filter(|&child| skeleton.parent(child) == Some(joint));
        let ends = children.map(|child| self.pose.position(child));
        let farthest = ends.max_by(|a, b| a.distance(start).total_cmp(&b.distance(start)));
        farthest.filter(|end| *end != start).or_else(|| {
            let nodes = WorldPose::new(skeleton, node_locals(skeleton), DQuat::IDENTITY);
            let along = middle_of_skin(self.asset, joint)?.as_dvec3() - nodes.position(joint);
            Some(start + self.pose.rotation(joint) * nodes.rotation(joint).conjugate() * along)
        })
    }
}

/// Returns for each pair the rotation, in the common frame, from the target joint's rest to its aligned rest.
pub fn swings(input: SwingInput) -> Vec<DQuat> {
    let slot_of_pair = collect_map(input.pair_of_slot.iter().map(|(&slot, &pair)| (pair, slot)));
    let torso = input
        .directions(Slot::Hips, Slot::Head)
        .filter(|[source, target]| degrees_between(*source, *target) > MIN_TORSO_TURN_DEGREES)
        .map_or(DQuat::IDENTITY, |[source, target]| arc(target, source));
    let mut swings: Vec<DQuat> = Vec::with_capacity(input.map.pairs.len());
    let mut swing_of_joint: Vec<Option<DQuat>> = vec![None; input.target.asset.skeleton.len()];
    for (index, pair) in input.map.pairs.iter().enumerate() {
        let mut above = ancestry(&input.target.asset.skeleton, pair.target).skip(1);
        let inherited = above.find_map(|joint| swing_of_joint[joint.get()]).unwrap_or(DQuat::IDENTITY);
        let swing = match slot_of_pair.get(&index) {
            Some(Slot::Hips) => DQuat::IDENTITY,
            Some(Slot::Spine | Slot::Chest | Slot::UpperChest) => torso,
            Some(&slot) => slot_swing(input, slot, inherited),
            None => inherited,
        };
        let swing = unit(swing);
        swing_of_joint[pair.target.get()] = Some(swing);
        swings.push(swing);
    }
    swings
}

/// The swing of a joint outside the trunk. `inherited` is that of its nearest mapped ancestor.
fn slot_swing(input: SwingInput, slot: Slot, inherited: DQuat) -> DQuat {
    if let Some(&(from, to)) = LIMBS.iter().chain(&FINGERS).find(|(from, _)| *from == slot) {
        let Some([source, target]) = input.directions(from, to) else { return inherited };
        let swing = arc(inherited * target, source) * inherited;
        return bend_roll(input, from, to, swing) * swing;
    }
    match slot {
        Slot::LeftFoot => foot_swing(input.directions(slot, Slot::LeftToes), inherited),
        Slot::RightFoot => foot_swing(input.directions(slot, Slot::RightToes), inherited),
        _ => inherited,
    }
}

/// Feet keep their pitch unless the two rests hold them clearly differently. Without toes that is unknown, so the foot
/// follows a shin that is swung far.
fn foot_swing(directions: Option<[DVec3; 2]>, inherited: DQuat) -> DQuat {
    match directions {
        Some([source, target]) if degrees_between(source, target) > MIN_FOOT_TURN_DEGREES => arc(target, source),
        Some(_) => DQuat::IDENTITY,
        None if angle_between(inherited, DQuat::IDENTITY).to_degrees() > MIN_FOOT_TURN_DEGREES => inherited,
        None => DQuat::IDENTITY,
    }
}

/// The roll about an upper limb that makes both bend in the same plane, if both are bent; the identity for other segments.
fn bend_roll(input: SwingInput, from: Slot, to: Slot, swing: DQuat) -> DQuat {
    let is_upper = matches!(from, Slot::LeftUpperLeg | Slot::RightUpperLeg | Slot::LeftUpperArm | Slot::RightUpperArm);
    let lower = LIMBS.iter().find(|(start, _)| is_upper && *start == to);
    let both = lower.and_then(|&(start, end)| Some((input.directions(from, to)?, input.directions(start, end)?)));
    let Some(([source_upper, target_upper], [source_lower, target_lower])) = both else { return DQuat::IDENTITY };
    let bends = [degrees_between(source_upper, source_lower), degrees_between(target_upper, target_lower)];
    if bends.iter().any(|bend| !(MIN_BEND_DEGREES..180.0 - MIN_BEND_DEGREES).contains(bend)) {
        return DQuat::IDENTITY;
    }
    let source_normal = source_upper.cross(source_lower).normalize_or_zero();
    let target_normal = (swing * target_upper.cross(target_lower)).normalize_or_zero();
    let angle = target_normal.cross(source_normal).dot(source_upper).atan2(target_normal.dot(source_normal));
    DQuat::from_axis_angle(source_upper, angle)
}

fn arc(from: DVec3, to: DVec3) -> DQuat {
    DQuat::from_rotation_arc(from.normalize_or(DVec3::Y), to.normalize_or(DVec3::Y))
}
