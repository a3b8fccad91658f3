//! Which way a body stands and faces, and whether its names for left and right agree.

use std::collections::BTreeMap;

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::Slot::{self, *};
use gaitway_character::asset::{Asset, Side};
use glam::Vec3;

use super::evidence;
use super::tree::Tree;
use super::{Contradiction, Facing, Reason, RecognizedJoint};

/// Joints whose two sides are far enough apart to compare.
const LIMBS: [Slot; 8] =
    [LeftUpperLeg, LeftLowerLeg, LeftFoot, LeftToes, LeftShoulder, LeftUpperArm, LeftLowerArm, LeftHand];

/// Cosine of the angle between feet → hips and hips → head: 1 stands straight, 0 walks on four legs.
pub(super) fn straightness(tree: &Tree, parts: &BTreeMap<Slot, RecognizedJoint>) -> Option<f32> {
    let place = |slot| parts.get(&slot).map(|part| tree.position(part.joint));
    let hips = place(Hips)?;
    let upper = place(Head).or_else(|| place(Neck))? - hips;
    let lower = hips - feet(tree, parts)?;
    Some(upper.try_normalize()?.dot(lower.try_normalize()?))
}

/// Midpoint of the feet, or of the shins without feet.
fn feet(tree: &Tree, parts: &BTreeMap<Slot, RecognizedJoint>) -> Option<Vec3> {
    [LeftFoot, LeftLowerLeg].into_iter().find_map(|slot| {
        let (left, right) = (parts.get(&slot)?, parts.get(&slot.mirrored())?);
        Some(tree.position(left.joint).midpoint(tree.position(right.joint)))
    })
}

/// `feet_point` is what [`feet_point`] found.
pub(super) fn find(tree: &Tree, parts: &BTreeMap<Slot, RecognizedJoint>, feet_point: Option<Vec3>) -> Facing {
    let Some(up) = up(tree, parts) else { return Facing::default() };
    let left = left(tree, parts, up);
    let mut forward = feet_point
        .or_else(|| toes(tree, parts, up))
        .or_else(|| eyes(tree, parts, up))
        .or_else(|| knees(tree, parts, up));
    // Feet point outwards and rests are crooked: the line through both sides gives the axis more precisely, but not its
    // sign.
    if let (Some(across), Some(seen)) = (left.map(|left| left.cross(up)), forward) {
        let along = across.dot(seen);
        forward = (along.abs() > 0.5).then_some(across * along.signum());
    }
    Facing { up: Some(up), left, forward }
}

/// The axis nearest to the line from the feet to the head, or that line if none is near.
fn up(tree: &Tree, parts: &BTreeMap<Slot, RecognizedJoint>) -> Option<Vec3> {
    let place = |slot| parts.get(&slot).map(|part| tree.position(part.joint));
    let top = place(Head).or_else(|| place(Neck)).or_else(|| place(Chest))?;
    let bottom = feet(tree, parts).or_else(|| place(Hips))?;
    let line = (top - bottom).try_normalize()?;
    let axes = [Vec3::Y, Vec3::Z, Vec3::X, Vec3::NEG_Y, Vec3::NEG_Z, Vec3::NEG_X];
    Some(axes.into_iter().find(|axis| axis.dot(line) > 0.8).unwrap_or(line))
}

fn perpendicular(vector: Vec3, up: Vec3) -> Vec3 {
    vector - up * vector.dot(up)
}

fn left(tree: &Tree, parts: &BTreeMap<Slot, RecognizedJoint>, up: Vec3) -> Option<Vec3> {
    let apart = |slot: Slot| {
        let (left, right) = (parts.get(&slot)?, parts.get(&slot.mirrored())?);
        Some(perpendicular(tree.position(left.joint) - tree.position(right.joint), up))
    };
    [LeftUpperLeg, LeftUpperArm, LeftFoot, LeftHand].into_iter().filter_map(apart).sum::<Vec3>().try_normalize()
}

/// Where feet point for certain: from the ankles to the toes or, without toes, to the middle of the skin on the feet.
/// Swapping left and right does not change it.
pub(super) fn feet_point(asset: &Asset, tree: &Tree, parts: &BTreeMap<Slot, RecognizedJoint>) -> Option<Vec3> {
    let up = up(tree, parts)?;
    let (left, right) = (parts.get(&LeftFoot)?.joint, parts.get(&RightFoot)?.joint);
    if parts.contains_key(&LeftToes) && parts.contains_key(&RightToes) {
        return toes(tree, parts, up);
    }
    let regions = evidence::regions_at_rest(asset);
    let of_foot = |foot: JointIndex| {
        let region = regions[foot.get()]?;
        let middle = region.min.midpoint(region.max) - tree.position(foot);
        let ahead = perpendicular(middle, up);
        // What reaches down more than ahead is a shin that is called a foot.
        let is_foot = ahead.length() > 0.1 * region.size() && ahead.length() > 0.5 * middle.dot(up).abs();
        is_foot.then(|| ahead.normalize_or_zero())
    };
    significant(of_foot(left)? + of_foot(right)?, 2.0)
}

/// From the ankles to the toes, or to their first children.
fn toes(tree: &Tree, parts: &BTreeMap<Slot, RecognizedJoint>, up: Vec3) -> Option<Vec3> {
    let of_side = |foot: Slot, toes: Slot| {
        let foot = parts.get(&foot)?.joint;
        let toes = match parts.get(&toes) {
            Some(toes) => toes.joint,
            None => *tree.children(foot).first()?,
        };
        perpendicular(tree.position(toes) - tree.position(foot), up).try_normalize()
    };
    let both = of_side(LeftFoot, LeftToes)? + of_side(RightFoot, RightToes)?;
    significant(both, 2.0)
}

fn eyes(tree: &Tree, parts: &BTreeMap<Slot, RecognizedJoint>, up: Vec3) -> Option<Vec3> {
    let head = tree.position(parts.get(&Head)?.joint);
    let (left, right) = (parts.get(&LeftEye)?, parts.get(&RightEye)?);
    let eyes = tree.position(left.joint).midpoint(tree.position(right.joint));
    significant(perpendicular(eyes - head, up), eyes.distance(head))
}

/// Knees are in front of the line from hip to ankle.
fn knees(tree: &Tree, parts: &BTreeMap<Slot, RecognizedJoint>, up: Vec3) -> Option<Vec3> {
    let place = |slot| parts.get(&slot).map(|part: &RecognizedJoint| tree.position(part.joint));
    let bend = |sides: [Slot; 3]| {
        let [upper, lower, foot] = sides.map(place);
        let (upper, lower, foot) = (upper?, lower?, foot?);
        let leg = foot - upper;
        let along = (lower - upper).dot(leg) / leg.length_squared();
        Some((lower - upper - leg * along, leg.length()))
    };
    let (left, length) = bend([LeftUpperLeg, LeftLowerLeg, LeftFoot])?;
    let (right, _) = bend([RightUpperLeg, RightLowerLeg, RightFoot])?;
    significant(perpendicular(left + right, up), 0.1 * length)
}

/// The direction of a vector; None if it is too short, compared to `whole`, to mean anything.
fn significant(vector: Vec3, whole: f32) -> Option<Vec3> {
    if vector.length() > 0.2 * whole { vector.try_normalize() } else { None }
}

/// Joints named for one side that lie on the other, as the body faces.
pub(super) fn contradictions(
    tree: &Tree,
    parts: &BTreeMap<Slot, RecognizedJoint>,
    facing: &Facing,
) -> Vec<Contradiction> {
    let (Some(up), Some(forward)) = (facing.up, facing.forward) else { return Vec::new() };
    let left = up.cross(forward);
    let mut found = Vec::new();
    for slot in LIMBS.into_iter().chain(LIMBS.map(Slot::mirrored)) {
        let (Some(part), Some(other)) = (parts.get(&slot), parts.get(&slot.mirrored())) else { continue };
        let sideways = (tree.position(part.joint) - tree.position(other.joint)).dot(left);
        let lies_left = sideways > 0.0;
        if part.reason != Reason::Geometry && sideways != 0.0 && lies_left != (slot.side() == Some(Side::Left)) {
            found.push(Contradiction::Side {
                slot,
                joint: part.joint,
                name: tree.skeleton.name(part.joint).to_owned(),
            });
        }
    }
    found
}

/// Whether position overrides the names' left and right: the feet show clearly where the body faces, and at least
/// [`MIN_SHARE`] of the limbs' joints lie on the side opposite to their names.
pub(super) fn position_decides(
    parts: &BTreeMap<Slot, RecognizedJoint>,
    feet_point: Option<Vec3>,
    contradictions: &[Contradiction],
) -> bool {
    let is_pair = |slot: &&Slot| parts.contains_key(slot) && parts.contains_key(&slot.mirrored());
    let pairs = LIMBS.iter().filter(is_pair).count();
    feet_point.is_some() && pairs >= MIN_PAIRS && contradictions.len() as f32 >= MIN_SHARE * 2.0 * pairs as f32
}

/// Minimum number of pairs of left and right joints to judge by.
const MIN_PAIRS: usize = 4;

/// Share of the joints that must contradict their names for all to be wrong.
const MIN_SHARE: f32 = 0.8;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn left_is_x_when_facing_z() {
        let facing = Facing { up: Some(Vec3::Y), left: Some(Vec3::X), forward: Some(Vec3::Z) };
        assert!(!facing.is_mirrored());
        assert!(Facing { left: Some(Vec3::NEG_X), ..facing }.is_mirrored());
        assert!(Facing { forward: Some(Vec3::NEG_Z), ..facing }.is_mirrored());
        assert!(!Facing { forward: None, ..facing }.is_mirrored());
    }
}
