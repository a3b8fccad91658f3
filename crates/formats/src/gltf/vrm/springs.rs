//! `VRMC_springBone` and `secondaryAnimation` of VRM 0.x.

use gaitway_character::anim::JointIndex;
use gaitway_character::avatar::{Collider, SpringJoint, Springs};
use gaitway_character::sort::sort_by;
use glam::Vec3;
use serde_json::Value;

use super::{EXTENDED_COLLIDER, Reader, SPRING_BONE, index, list, number, vector};

/// Further spring joints, colliders and groups are skipped.
const MAX_JOINTS: usize = 4096;
const MAX_COLLIDERS: usize = 1024;
/// Maximum number of springs in a file.
const MAX_GROUPS: usize = 512;
/// Maximum number of collider groups of a spring.
const MAX_GROUPS_OF_SPRING: usize = 64;
/// Maximum number of pairs of spring joint and collider, all of which are tested in every step.
const MAX_TESTS: usize = 1 << 16;

const BONE_GROUPS: &str = "extensions.VRM.secondaryAnimation.boneGroups";

const DOWN: Vec3 = Vec3::NEG_Y;

pub fn read_1(reader: &mut Reader, value: &Value) -> Springs {
    let place_of = |list: &str| format!("extensions.{SPRING_BONE}.{list}");
    // The file's indices include colliders that are skipped.
    let (mut indices, mut colliders) = (Vec::new(), Vec::new());
    for (at, value) in reader.list(&place_of("colliders"), &value["colliders"], MAX_COLLIDERS).iter().enumerate() {
        let joint = reader.joint_at(&place_of(&format!("colliders[{at}]")), &value["node"]);
        indices.push(joint.and_then(|joint| collider(joint, value)).map(|collider| {
            colliders.push(collider);
            colliders.len() as u32 - 1
        }));
    }
    let group = |at: &Value| {
        let group = index(at).and_then(|at| value["colliderGroups"].get(at)).unwrap_or(&Value::Null);
        list(&group["colliders"]).iter().take(MAX_COLLIDERS).filter_map(|at| *indices.get(index(at)?)?)
    };
    let mut joints = Vec::new();
    let mut left = MAX_JOINTS;
    let mut tests = MAX_TESTS;
    for (at, spring) in reader.list(&place_of("springs"), &value["springs"], MAX_GROUPS).iter().enumerate() {
        let place = place_of(&format!("springs[{at}]"));
        let chain = reader.list(&format!("{place}.joints"), &spring["joints"], left);
        left -= chain.len();
        if chain.len() < 2 {
            continue;
        }
        let groups = reader.list(&format!("{place}.colliderGroups"), &spring["colliderGroups"], MAX_GROUPS_OF_SPRING);
        let colliders =
            within_test_budget(reader, &place, distinct(groups.iter().flat_map(group)), chain.len(), &mut tests);
        let center = spring.get("center").and_then(|node| reader.joint(node));
        for (end, pair) in chain.windows(2).enumerate() {
            let place = |joint: usize| format!("{place}.joints[{joint}]");
            let joint = reader.joint_at(&place(end), &pair[0]["node"]);
            let child = reader.joint_at(&place(end + 1), &pair[1]["node"]);
            let (Some(joint), Some(child)) = (joint, child) else { continue };
            match SpringJoint::rest_tail(reader.context.skeleton, joint, Some(child)) {
                Some(tail) => joints.push(spring_joint(&pair[0], "stiffness", joint, tail, center, &colliders)),
                None => reader.ignore(place(end + 1), "it isn't below the joint before it; it is left out".to_owned()),
            }
        }
        if left == 0 {
            break;
        }
    }
    Springs::new(reader.context.skeleton, joints, colliders)
}

/// Every joint below the bones of a group swings. Its first child is its tail.
pub fn read_0(reader: &mut Reader, vrm: &Value) -> Springs {
    let value = &vrm["secondaryAnimation"];
    let mut colliders = Vec::new();
    let mut groups = Vec::new();
    for group in list(&value["colliderGroups"]) {
        let start = colliders.len() as u32;
        let spheres = list(&group["colliders"]).iter().take(MAX_COLLIDERS - colliders.len());
        if let Some(joint) = reader.joint(&group["node"]) {
            colliders.extend(spheres.map(|sphere| {
                // Written for Unity, whose Z axis is mirrored.
                let offset = vector(&sphere["offset"], Vec3::ZERO) * Vec3::new(1.0, 1.0, -1.0);
                let radius = number(sphere, "radius", 0.0);
                Collider { joint, offset, tail: offset, radius, inside: false, normal: None }
            }));
        }
        groups.push(start..colliders.len() as u32);
    }
    let skeleton = reader.context.skeleton;
    let mut first_child = vec![None; skeleton.len()];
    for joint in skeleton.joints().rev() {
        if let Some(parent) = skeleton.parent(joint) {
            first_child[parent.get()] = Some(joint);
        }
    }
    let mut joints: Vec<SpringJoint> = Vec::new();
    let mut tests = MAX_TESTS;
    for group in reader.list(BONE_GROUPS, &value["boneGroups"], MAX_GROUPS) {
        let of_group = |at: &Value| index(at).and_then(|at| groups.get(at)).cloned().into_iter().flatten();
        let colliders = list(&group["colliderGroups"]).iter().take(MAX_GROUPS_OF_SPRING).flat_map(of_group);
        let colliders = distinct(colliders);
        // Exporters write −1 for none.
        let center = reader.joint(&group["center"]);
        let mut is_below = vec![false; skeleton.len()];
        for root in list(&group["bones"]).iter().filter_map(|node| reader.joint(node)) {
            is_below[root.get()] = true;
        }
        for joint in skeleton.joints() {
            is_below[joint.get()] |= skeleton.parent(joint).is_some_and(|parent| is_below[parent.get()]);
        }
        let count = is_below.iter().filter(|is_below| **is_below).count();
        let colliders = within_test_budget(reader, BONE_GROUPS, colliders, count, &mut tests);
        for joint in skeleton.joints() {
            if let Some(tail) = SpringJoint::rest_tail(skeleton, joint, first_child[joint.get()])
                && is_below[joint.get()]
                && joints.len() < MAX_JOINTS
            {
                joints.push(spring_joint(group, "stiffiness", joint, tail, center, &colliders));
            }
        }
    }
    Springs::new(skeleton, joints, colliders)
}

/// Returns the colliders of a spring, or none, with a warning, if testing its joints against them exceeds what is left
/// of [`MAX_TESTS`].
fn within_test_budget(
    reader: &mut Reader,
    place: &str,
    colliders: Vec<u32>,
    joints: usize,
    tests: &mut usize,
) -> Vec<u32> {
    match tests.checked_sub(colliders.len() * joints) {
        Some(left) => {
            *tests = left;
            colliders
        }
        None => {
            let problem =
                format!("more than {MAX_TESTS} pairs of joint and collider in all; its collisions are ignored");
            reader.ignore(place.to_owned(), problem);
            Vec::new()
        }
    }
}

fn distinct(indices: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut indices: Vec<u32> = indices.collect();
    sort_by(&mut indices, Ord::cmp);
    indices.dedup();
    indices
}

/// `stiffness` is the name of that member, which 0.x misspells.
fn spring_joint(
    value: &Value,
    stiffness: &str,
    joint: JointIndex,
    tail: Vec3,
    center: Option<JointIndex>,
    colliders: &[u32],
) -> SpringJoint {
    SpringJoint {
        joint,
        tail,
        stiffness: number(value, stiffness, 1.0),
        gravity: vector(&value["gravityDir"], DOWN) * number(value, "gravityPower", 0.0),
        drag: number(value, "dragForce", 0.4).clamp(0.0, 1.0),
        radius: number(value, "hitRadius", 0.0),
        center,
        colliders: colliders.to_vec(),
    }
}

fn collider(joint: JointIndex, value: &Value) -> Option<Collider> {
    let extended = &value["extensions"][EXTENDED_COLLIDER]["shape"];
    let shape = if extended.is_object() { extended } else { &value["shape"] };
    let collider = |shape: &Value, tail_key: &str, normal| {
        let offset = vector(&shape["offset"], Vec3::ZERO);
        let tail = shape.get(tail_key).map_or(offset, |tail| vector(tail, Vec3::ZERO));
        let inside = shape["inside"] == true;
        Some(Collider { joint, offset, tail, radius: number(shape, "radius", 0.0), inside, normal })
    };
    if let Some(sphere) = shape.get("sphere") {
        collider(sphere, "", None)
    } else if let Some(capsule) = shape.get("capsule") {
        collider(capsule, "tail", None)
    } else {
        let plane = shape.get("plane")?;
        collider(plane, "", Some(vector(&plane["normal"], Vec3::Z)))
    }
}
