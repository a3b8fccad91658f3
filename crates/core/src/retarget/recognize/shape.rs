//! Finds a body by its shape alone, for skeletons without names: two legs that reach the ground from one joint, a chain
//! upwards from there, and two arms and a head at its end. Only for skeletons with +Y up.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use glam::Vec3;

use super::assemble::spread;
use super::tree::Tree;
use super::{Reason, RecognizedJoint};
use crate::anim::JointIndex;
use crate::asset::Slot::{self, *};

const CONFIDENCE: f32 = 0.5;

/// Maximum number of limbs on a joint and of joints in a limb. Keeps the search short in large scenes.
const MAX_COUNT: usize = 16;

/// Two chains that mirror each other.
struct Twins {
    chains: [Vec<JointIndex>; 2],
}

/// The skeleton with totals of each joint's descendants.
struct Shape<'a> {
    tree: &'a Tree<'a>,
    /// Number of joints on the longest way down.
    lengths: Vec<u32>,
    lowest: Vec<f32>,
    highest: Vec<f32>,
}

/// Lower and upper half of a body.
struct Halves {
    hips: JointIndex,
    legs: Twins,
    /// From the joint above the hips up to the one that the arms hang on.
    trunk: Vec<JointIndex>,
    arms: Twins,
    head: JointIndex,
}

/// Returns the joints of a body; empty if nothing looks like one.
pub(super) fn find(tree: &Tree) -> BTreeMap<Slot, RecognizedJoint> {
    let heights: Vec<f32> = tree.positions.iter().map(|position| position.y).collect();
    let mut shape = Shape { tree, lengths: vec![0; heights.len()], lowest: heights.clone(), highest: heights };
    for joint in tree.skeleton.joints().rev() {
        if let Some(parent) = tree.skeleton.parent(joint) {
            let (joint, parent) = (joint.get(), parent.get());
            shape.lengths[parent] = shape.lengths[parent].max(shape.lengths[joint] + 1);
            shape.lowest[parent] = shape.lowest[parent].min(shape.lowest[joint]);
            shape.highest[parent] = shape.highest[parent].max(shape.highest[joint]);
        }
    }
    let mut candidates = tree.skeleton.joints();
    candidates.find_map(|hips| slots(&shape, &halves(&shape, hips)?)).unwrap_or_default()
}

/// None if `hips` does not look like the hips of a body.
fn halves(shape: &Shape, hips: JointIndex) -> Option<Halves> {
    let tree = shape.tree;
    let (lowest, highest) = (shape.lowest[hips.get()], shape.highest[hips.get()]);
    let height = highest - lowest;
    let ends =
        |twins: &Twins| twins.chains.each_ref().map(|chain| chain.last().map_or(f32::MAX, |&end| tree.position(end).y));
    let reach_ground = |twins: &Twins| ends(twins).into_iter().all(|y| y < lowest + 0.15 * height);
    let legs = twins(shape, hips, 3)
        .into_iter()
        .find(|legs| reach_ground(legs) && tree.position(hips).y > lowest + 0.25 * height)?;
    let sideways = sideways(tree, &legs, 0)?;
    let mut trunk = Vec::new();
    let mut at = highest_child(shape, hips, &legs, f32::NEG_INFINITY)?;
    let arms = loop {
        trunk.push(at);
        let arms = twins(shape, at, 2).into_iter().find(|arms| {
            self::sideways(tree, arms, 0).is_some_and(|line| line.dot(sideways).abs() > 0.9)
                && ends(arms).into_iter().all(|y| y > lowest + 0.2 * height)
        });
        match arms {
            Some(arms) => break arms,
            None => match tree.children(at) {
                [child] if trunk.len() < MAX_COUNT => at = *child,
                _ => return None,
            },
        }
    };
    let head = highest_child(shape, at, &arms, tree.position(at).y)?;
    Some(Halves { hips, legs, trunk, arms, head })
}

/// The child outside `limbs` that reaches highest, if that is above `min_height`; of equal ones the first.
fn highest_child(shape: &Shape, joint: JointIndex, limbs: &Twins, min_height: f32) -> Option<JointIndex> {
    let children = shape.tree.children(joint).iter().copied();
    children
        .filter(|child| !limbs.chains.iter().any(|chain| chain.first() == Some(child)))
        .filter(|&child| shape.top(child) > min_height)
        .max_by(|&a, &b| shape.top(a).total_cmp(&shape.top(b)).then(b.cmp(&a)))
}

fn slots(shape: &Shape, body: &Halves) -> Option<BTreeMap<Slot, RecognizedJoint>> {
    let tree = shape.tree;
    let mut found = BTreeMap::new();
    let mut put = |slot, joint| {
        found.insert(slot, RecognizedJoint { joint, reason: Reason::Geometry, confidence: CONFIDENCE });
    };
    put(Hips, body.hips);
    for (slot, joint) in spread(&body.trunk) {
        put(slot, joint);
    }
    match chain(shape, body.head).as_slice() {
        [head] => put(Head, *head),
        [neck, head, ..] => {
            put(Neck, *neck);
            put(Head, *head);
        }
        [] => return None,
    }
    let sideways = sideways(tree, &body.legs, 0)?;
    let is_left_first = is_left_first(tree, &body.legs, sideways);
    for (twins, is_leg) in [(&body.legs, true), (&body.arms, false)] {
        // Arms may be listed in another order than legs.
        let is_same_order = self::sideways(tree, twins, 0).is_some_and(|line| line.dot(sideways) > 0.0);
        let count = twins.chains.iter().map(Vec::len).min()?;
        for (chain, is_first) in twins.chains.iter().zip([true, false]) {
            let chain = chain.get(..count)?;
            let is_left = is_first == (is_left_first == is_same_order);
            for (&slot, &joint) in limb_slots(tree, chain, is_leg).iter().zip(chain) {
                put(if is_left { slot } else { slot.mirrored() }, joint);
            }
        }
    }
    Some(found)
}

fn limb_slots(tree: &Tree, chain: &[JointIndex], is_leg: bool) -> &'static [Slot] {
    if is_leg {
        &[LeftUpperLeg, LeftLowerLeg, LeftFoot, LeftToes]
    } else if has_collar_bone(tree, chain) {
        &[LeftShoulder, LeftUpperArm, LeftLowerArm, LeftHand]
    } else {
        &[LeftUpperArm, LeftLowerArm, LeftHand]
    }
}

/// A collar bone is shorter than the upper arm that follows.
fn has_collar_bone(tree: &Tree, arm: &[JointIndex]) -> bool {
    match arm {
        [a, b, c, _, ..] => {
            tree.position(*a).distance(tree.position(*b)) < 0.6 * tree.position(*b).distance(tree.position(*c))
        }
        _ => false,
    }
}

impl Shape<'_> {
    fn top(&self, joint: JointIndex) -> f32 {
        self.highest[joint.get()]
    }
}

/// The joint and what follows it, along the longest way where it forks.
fn chain(shape: &Shape, first: JointIndex) -> Vec<JointIndex> {
    let length = |joint: &JointIndex| shape.lengths[joint.get()];
    let longest = |at: &JointIndex| {
        shape.tree.children(*at).iter().copied().max_by(|a, b| length(a).cmp(&length(b)).then(b.cmp(a)))
    };
    std::iter::successors(Some(first), longest).take(MAX_COUNT).collect()
}

/// All pairs of chains from a joint's children that lie side by side all the way, of at least `min_length` joints. The longest
/// pair comes first, whatever the order of the children: a short neck can lie beside an arm as well.
fn twins(shape: &Shape, joint: JointIndex, min_length: usize) -> Vec<Twins> {
    let (tree, children) = (shape.tree, shape.tree.children(joint));
    // Two limbs, and what continues between them.
    if !(3..=MAX_COUNT).contains(&children.len()) {
        return Vec::new();
    }
    let chains: Vec<Vec<JointIndex>> = children.iter().map(|&child| chain(shape, child)).collect();
    let mut found = Vec::new();
    for (at, a) in chains.iter().enumerate() {
        for b in &chains[at + 1..] {
            let twins = Twins { chains: [a.clone(), b.clone()] };
            let count = a.len().min(b.len());
            let line = sideways(tree, &twins, 0);
            let is_parallel = (0..count).all(|level| match (line, sideways(tree, &twins, level)) {
                (Some(line), Some(other)) => line.dot(other) > 0.9,
                _ => false,
            });
            if count >= min_length && is_parallel {
                found.push(twins);
            }
        }
    }
    found.sort_by_key(|twins| Reverse(twins.chains.each_ref().map(Vec::len).into_iter().min()));
    found
}

/// Horizontal direction from the second chain to the first; None if they are not side by side.
fn sideways(tree: &Tree, twins: &Twins, level: usize) -> Option<Vec3> {
    let [a, b] = twins.chains.each_ref().map(|chain| chain.get(level).map(|&joint| tree.position(joint)));
    let line = a? - b?;
    let flat = Vec3::new(line.x, 0.0, line.z);
    if flat.length() > 0.8 * line.length() { flat.try_normalize() } else { None }
}

/// Whether the first leg is the left one, as the feet point; a body without feet faces +Z.
fn is_left_first(tree: &Tree, legs: &Twins, sideways: Vec3) -> bool {
    let foot = |chain: &Vec<JointIndex>| match chain.as_slice() {
        [_, _, foot, toes, ..] => tree.position(*toes) - tree.position(*foot),
        _ => Vec3::ZERO,
    };
    let toes: Vec3 = legs.chains.iter().map(foot).sum();
    let forward = Vec3::new(toes.x, 0.0, toes.z).try_normalize().unwrap_or(Vec3::Z);
    Vec3::Y.cross(forward).dot(sideways) > 0.0
}
