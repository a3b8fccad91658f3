//! Bringing two rests together before motion is carried over: both face the same way and stand upright, and the target's
//! limbs point where the source's do (A-pose to T-pose and so on). The result are the aligned rests `W*` of the rotation law.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};

use crate::anim::{JointIndex, Skeleton};
use crate::asset::{Humanoid, Slot};
use crate::retarget::align::rest::{Local, Reference, unit};
use crate::retarget::map::ResolvedMap;

/// Both aligned rests in one common frame: +Y up, facing +Z. Positions in each side's own units.
#[derive(Debug)]
pub struct Alignment {
    /// Turns the source's world into the common frame; and the target's.
    pub source_turn: DQuat,
    pub target_turn: DQuat,
    pub source: Reference,
    /// Joints without a source hold their node's rest below the joint they hang on.
    pub target: Reference,
    /// The target's rest before it was aligned, as it is built.
    pub target_as_built: Reference,
    /// Of mapped joints, by index into [`ResolvedMap::pairs`].
    pub pair_of_slot: BTreeMap<Slot, usize>,
}

/// Segments whose directions are brought together, parents first: from, to.
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

/// Segments that are compared in the figures: the limbs and the torso.
pub fn compared_segments() -> impl Iterator<Item = (Slot, Slot)> {
    LIMBS.into_iter().chain([(Slot::Hips, Slot::Head)])
}

/// Feet and torsos of two rests differ in build (height of the heel, curve of the spine), and a difference in build is not
/// one in posture. Only beyond these angles they are turned towards each other.
const LEAST_FOOT_TURN_DEGREES: f64 = 40.0;
const LEAST_TORSO_TURN_DEGREES: f64 = 15.0;

/// A knee or elbow bent by less than this says nothing about the roll of its limb.
const LEAST_BEND_DEGREES: f64 = 10.0;

/// A facing this near to an axis is taken as that axis: nothing is exactly symmetrical.
const AXIS_DEGREES: f64 = 2.0;

/// `source_locals` and `target_locals` are the chosen rests; `target_nodes` the rest that the player holds.
pub fn align(
    map: &ResolvedMap,
    [source_skeleton, target_skeleton]: [&Skeleton; 2],
    [source_slots, target_slots]: [&Humanoid; 2],
    source_locals: Vec<Local>,
    target_locals: Vec<Local>,
    target_nodes: &[Local],
) -> Alignment {
    let plain = |skeleton, locals: &Vec<Local>| Reference::new(skeleton, locals.clone(), DQuat::IDENTITY);
    let turns = (
        common_turn(&plain(source_skeleton, &source_locals), source_slots),
        common_turn(&plain(target_skeleton, &target_locals), target_slots),
    );
    let (source_turn, target_turn) = match turns {
        (Some(source), Some(target)) => (source, target),
        _ => (DQuat::IDENTITY, DQuat::IDENTITY),
    };
    let source = Reference::new(source_skeleton, source_locals, source_turn);
    let target = Reference::new(target_skeleton, target_locals, target_turn);
    let pair_of_slot = pairs_of_slots(map, source_slots, target_slots);
    let swings = swings(map, &pair_of_slot, target_skeleton, &source, &target);

    let mut locals = target_nodes.to_vec();
    let mut rotations: Vec<DQuat> = Vec::with_capacity(locals.len());
    let mut pairs = map.pairs.iter().zip(&swings).peekable();
    for joint in target_skeleton.joints() {
        let above = target_skeleton.parent(joint).map_or(target_turn, |parent| rotations[parent.get()]);
        let local = &mut locals[joint.get()];
        let rotation = match pairs.next_if(|(pair, _)| pair.target == joint) {
            Some((pair, swing)) => unit(*swing * target.rotations[joint.get()] * unit(pair.correction.as_dquat())),
            None => unit(above * local.rotation),
        };
        local.rotation = unit(above.conjugate() * rotation);
        rotations.push(rotation);
    }
    let aligned = Reference::new(target_skeleton, locals, target_turn);
    Alignment { source_turn, target_turn, source, target: aligned, target_as_built: target, pair_of_slot }
}

/// The slot of each pair is its target's; where that has none, its source's.
fn pairs_of_slots(map: &ResolvedMap, source_slots: &Humanoid, target_slots: &Humanoid) -> BTreeMap<Slot, usize> {
    let mut pair_of_slot = BTreeMap::new();
    for (slots, joint_of) in [
        (target_slots, (|pair| pair.target) as fn(&crate::retarget::Pair) -> JointIndex),
        (source_slots, |pair| pair.source),
    ] {
        for (index, pair) in map.pairs.iter().enumerate() {
            if !pair_of_slot.values().any(|&taken| taken == index)
                && let Some(slot) = slots.slot(joint_of(pair))
            {
                pair_of_slot.entry(slot).or_insert(index);
            }
        }
    }
    pair_of_slot
}

/// From a figure's world to the common frame: the spine's nearest axis becomes +Y, the way it faces +Z. None without hips,
/// head and two sides.
fn common_turn(rest: &Reference, slots: &Humanoid) -> Option<DQuat> {
    let at = |slot| slots.joint(slot).map(|joint| rest.positions[joint.get()]);
    let up = at(Slot::Head)? - at(Slot::Hips)?;
    let upright = upright(up);
    let at = |slot| at(slot).map(|position| upright * position);
    let across = |left, right| Some(at(left)? - at(right)?);
    let sides = [
        across(Slot::LeftUpperLeg, Slot::RightUpperLeg),
        across(Slot::LeftUpperArm, Slot::RightUpperArm),
        across(Slot::LeftFoot, Slot::RightFoot),
    ];
    let lateral: DVec3 = sides.into_iter().flatten().map(DVec3::normalize_or_zero).sum();
    let mut forward = lateral.cross(DVec3::Y).try_normalize()?;
    let toes = [across(Slot::LeftToes, Slot::LeftFoot), across(Slot::RightToes, Slot::RightFoot)];
    let pointed: DVec3 = toes.into_iter().flatten().map(DVec3::normalize_or_zero).sum();
    // Names beat geometry in the map; but whoever calls the right leg left still walks the way the toes point.
    if pointed.dot(forward) < -0.5 {
        forward = -forward;
    }
    let yaw = forward.x.atan2(forward.z).to_degrees();
    let quarter = (yaw / 90.0).round() * 90.0;
    let yaw = if (yaw - quarter).abs() < AXIS_DEGREES { quarter } else { yaw };
    Some(unit(DQuat::from_rotation_y(-yaw.to_radians()) * upright))
}

/// Turns the axis that is nearest to a direction to +Y.
fn upright(up: DVec3) -> DQuat {
    let axes = [DVec3::Y, DVec3::Z, DVec3::X, -DVec3::Y, -DVec3::Z, -DVec3::X];
    let mut nearest = DVec3::Y;
    for axis in axes {
        if up.dot(axis) > up.dot(nearest) + 1e-6 * up.length() {
            nearest = axis;
        }
    }
    if nearest == DVec3::Y { DQuat::IDENTITY } else { DQuat::from_rotation_arc(nearest, DVec3::Y) }
}

/// How each mapped target joint is turned, in the common frame, from its rest to the aligned one.
fn swings(
    map: &ResolvedMap,
    pair_of_slot: &BTreeMap<Slot, usize>,
    skeleton: &Skeleton,
    source: &Reference,
    target: &Reference,
) -> Vec<DQuat> {
    let slot_of_pair: BTreeMap<usize, Slot> = pair_of_slot.iter().map(|(&slot, &pair)| (pair, slot)).collect();
    // Both directions of a segment, source first.
    let directions = |from: Slot, to: Slot| -> Option<[DVec3; 2]> {
        let from = &map.pairs[*pair_of_slot.get(&from)?];
        let to = &map.pairs[*pair_of_slot.get(&to)?];
        let source = source.positions[to.source.get()] - source.positions[from.source.get()];
        let target = target.positions[to.target.get()] - target.positions[from.target.get()];
        Some([source.try_normalize()?, target.try_normalize()?])
    };
    let torso = directions(Slot::Hips, Slot::Head)
        .filter(|[source, target]| degrees_between(*source, *target) > LEAST_TORSO_TURN_DEGREES)
        .map_or(DQuat::IDENTITY, |[source, target]| arc(target, source));
    let mut swings: Vec<DQuat> = Vec::with_capacity(map.pairs.len());
    let mut swing_of_joint: Vec<Option<DQuat>> = vec![None; skeleton.len()];
    for (index, pair) in map.pairs.iter().enumerate() {
        let above = crate::retarget::align::rest::ancestry(skeleton, pair.target)
            .skip(1)
            .find_map(|joint| swing_of_joint[joint.get()]);
        let above = above.unwrap_or(DQuat::IDENTITY);
        let slot = slot_of_pair.get(&index).copied();
        let limb = slot.and_then(|slot| LIMBS.iter().chain(&FINGERS).find(|(from, _)| *from == slot));
        let toes = match slot {
            Some(Slot::LeftFoot) => Some(Slot::LeftToes),
            Some(Slot::RightFoot) => Some(Slot::RightToes),
            _ => None,
        };
        let swing = match (slot, limb) {
            (Some(Slot::Hips), _) => DQuat::IDENTITY,
            (Some(Slot::Spine | Slot::Chest | Slot::UpperChest), _) => torso,
            (Some(_), Some(&(from, to))) => match directions(from, to) {
                Some([source, target]) => {
                    let swing = arc(above * target, source) * above;
                    bend_roll(from, to, &directions, swing) * swing
                }
                None => above,
            },
            (Some(foot), None) if toes.is_some() => foot_swing(directions(foot, toes.unwrap_or(foot)), above),
            _ => above,
        };
        let swing = unit(swing);
        swing_of_joint[pair.target.get()] = Some(swing);
        swings.push(swing);
    }
    swings
}

/// Feet stay as flat as they are, unless the two rests hold them in truly different ways; without toes nobody can tell, so
/// they follow the shin when that is turned a lot.
fn foot_swing(directions: Option<[DVec3; 2]>, above: DQuat) -> DQuat {
    match directions {
        Some([source, target]) if degrees_between(source, target) > LEAST_FOOT_TURN_DEGREES => arc(target, source),
        Some(_) => DQuat::IDENTITY,
        None if crate::retarget::keys::track::angle_between(above, DQuat::IDENTITY).to_degrees()
            > LEAST_FOOT_TURN_DEGREES =>
        {
            above
        }
        None => DQuat::IDENTITY,
    }
}

/// The roll about an upper limb that brings the two planes of its bend together, when both are bent; none for others.
fn bend_roll(from: Slot, to: Slot, directions: &impl Fn(Slot, Slot) -> Option<[DVec3; 2]>, swing: DQuat) -> DQuat {
    let upper = matches!(from, Slot::LeftUpperLeg | Slot::RightUpperLeg | Slot::LeftUpperArm | Slot::RightUpperArm);
    let lower = LIMBS.iter().find(|(start, _)| upper && *start == to);
    let both = lower.and_then(|&(start, end)| Some((directions(from, to)?, directions(start, end)?)));
    let Some(([source_upper, target_upper], [source_lower, target_lower])) = both else { return DQuat::IDENTITY };
    let bends = [degrees_between(source_upper, source_lower), degrees_between(target_upper, target_lower)];
    if bends.iter().any(|bend| !(LEAST_BEND_DEGREES..180.0 - LEAST_BEND_DEGREES).contains(bend)) {
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

pub fn degrees_between(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

/// The turn about +Y that is in a rotation (its twist), radians from −π to π.
pub fn yaw_of(rotation: DQuat) -> f64 {
    let side = if rotation.w < 0.0 { -1.0 } else { 1.0 };
    2.0 * (side * rotation.y).atan2(side * rotation.w)
}
