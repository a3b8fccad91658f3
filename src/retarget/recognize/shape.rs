//! Finds a body by its shape alone, for skeletons whose joints have no names: two legs that reach the ground from one joint,
//! a way up from there, two arms and a head at its end. Only for +Y up.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use glam::Vec3;

use super::assemble::spread;
use super::tree::Tree;
use super::{Part, Reason};
use crate::anim::JointIndex;
use crate::asset::Slot::{self, *};

const SURE_GEOMETRY: f32 = 0.5;

/// No body has more limbs on one joint, or more joints in one limb. It keeps the search short in large scenes.
const MOST: usize = 16;

/// Two chains that mirror each other.
struct Twins {
    chains: [Vec<JointIndex>; 2],
}

/// The skeleton with what hangs under each joint summed up.
struct Shape<'a> {
    tree: &'a Tree<'a>,
    /// Joints on the longest way down.
    lengths: Vec<u32>,
    lowest: Vec<f32>,
    highest: Vec<f32>,
}

/// Empty where nothing looks like a body.
pub(super) fn find(tree: &Tree) -> BTreeMap<Slot, Part> {
    let heights: Vec<f32> = tree.places.iter().map(|place| place.y).collect();
    let mut shape = Shape { tree, lengths: vec![0; heights.len()], lowest: heights.clone(), highest: heights };
    for joint in tree.skeleton.joints().rev() {
        if let Some(parent) = tree.skeleton.parent(joint) {
            let (joint, parent) = (joint.get(), parent.get());
            shape.lengths[parent] = shape.lengths[parent].max(shape.lengths[joint] + 1);
            shape.lowest[parent] = shape.lowest[parent].min(shape.lowest[joint]);
            shape.highest[parent] = shape.highest[parent].max(shape.highest[joint]);
        }
    }
    tree.skeleton.joints().find_map(|hips| body(&shape, hips)).unwrap_or_default()
}

fn body(shape: &Shape, hips: JointIndex) -> Option<BTreeMap<Slot, Part>> {
    let tree = shape.tree;
    let (lowest, highest) = (shape.lowest[hips.get()], shape.highest[hips.get()]);
    let height = highest - lowest;
    let ends =
        |twins: &Twins| twins.chains.each_ref().map(|chain| chain.last().map_or(f32::MAX, |&end| tree.place(end).y));
    let on_ground = |twins: &Twins| ends(twins).into_iter().all(|y| y < lowest + 0.15 * height);
    let legs = twins(shape, hips, 3)
        .into_iter()
        .find(|legs| on_ground(legs) && tree.place(hips).y > lowest + 0.25 * height)?;
    let sideways = apart(tree, &legs, 0)?;
    let mut trunk = Vec::new();
    let mut at = *tree
        .children(hips)
        .iter()
        .filter(|child| !legs.chains.iter().any(|chain| chain.first() == Some(child)))
        .max_by(|&&a, &&b| shape.top(a).total_cmp(&shape.top(b)).then(b.cmp(&a)))?;
    let arms = loop {
        trunk.push(at);
        let arms = twins(shape, at, 2).into_iter().find(|arms| {
            apart(tree, arms, 0).is_some_and(|line| line.dot(sideways).abs() > 0.9)
                && ends(arms).into_iter().all(|y| y > lowest + 0.2 * height)
        });
        match arms {
            Some(arms) => break arms,
            None => match tree.children(at) {
                [child] if trunk.len() < MOST => at = *child,
                _ => return None,
            },
        }
    };
    let head = tree
        .children(at)
        .iter()
        .copied()
        .filter(|child| !arms.chains.iter().any(|chain| chain.first() == Some(child)))
        .filter(|&child| shape.top(child) > tree.place(at).y)
        .max_by(|&a, &b| shape.top(a).total_cmp(&shape.top(b)).then(b.cmp(&a)))?;
    let mut found = BTreeMap::new();
    let mut put = |slot, joint| {
        found.insert(slot, Part { joint, reason: Reason::Geometry, confidence: SURE_GEOMETRY });
    };
    put(Hips, hips);
    for (slot, joint) in spread(&trunk) {
        put(slot, joint);
    }
    match chain(shape, head).as_slice() {
        [head] => put(Head, *head),
        [neck, head, ..] => {
            put(Neck, *neck);
            put(Head, *head);
        }
        [] => return None,
    }
    let left_first = left_first(tree, &legs, sideways);
    for (twins, is_leg) in [(&legs, true), (&arms, false)] {
        // Arms may be listed the other way round than legs.
        let same_way = apart(tree, twins, 0).is_some_and(|line| line.dot(sideways) > 0.0);
        let count = twins.chains.iter().map(Vec::len).min()?;
        for (chain, is_first) in twins.chains.iter().zip([true, false]) {
            let chain = chain.get(..count)?;
            let slots: &[Slot] = if is_leg {
                &[LeftUpperLeg, LeftLowerLeg, LeftFoot, LeftToes]
            } else if has_collar(tree, chain) {
                &[LeftShoulder, LeftUpperArm, LeftLowerArm, LeftHand]
            } else {
                &[LeftUpperArm, LeftLowerArm, LeftHand]
            };
            let is_left = is_first == (left_first == same_way);
            for (&slot, &joint) in slots.iter().zip(chain) {
                put(if is_left { slot } else { slot.mirrored() }, joint);
            }
        }
    }
    Some(found)
}

/// A collar bone is shorter than the upper arm that follows.
fn has_collar(tree: &Tree, arm: &[JointIndex]) -> bool {
    match arm {
        [a, b, c, _, ..] => tree.place(*a).distance(tree.place(*b)) < 0.6 * tree.place(*b).distance(tree.place(*c)),
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
    std::iter::successors(Some(first), longest).take(MOST).collect()
}

/// All pairs of chains from the children of a joint that lie side by side all the way, of at least `shortest` joints. The
/// longest pair comes first whatever the order of the children: a short neck can lie beside an arm as well.
fn twins(shape: &Shape, joint: JointIndex, shortest: usize) -> Vec<Twins> {
    let (tree, children) = (shape.tree, shape.tree.children(joint));
    // Two limbs and what goes on between them.
    if !(3..=MOST).contains(&children.len()) {
        return Vec::new();
    }
    let chains: Vec<Vec<JointIndex>> = children.iter().map(|&child| chain(shape, child)).collect();
    let mut found = Vec::new();
    for (at, a) in chains.iter().enumerate() {
        for b in &chains[at + 1..] {
            let twins = Twins { chains: [a.clone(), b.clone()] };
            let count = a.len().min(b.len());
            let line = apart(tree, &twins, 0);
            let alike = (0..count).all(|level| match (line, apart(tree, &twins, level)) {
                (Some(line), Some(other)) => line.dot(other) > 0.9,
                _ => false,
            });
            if count >= shortest && alike {
                found.push(twins);
            }
        }
    }
    found.sort_by_key(|twins| Reverse(twins.chains.each_ref().map(Vec::len).into_iter().min()));
    found
}

/// From the second chain to the first, level with the ground.
fn apart(tree: &Tree, twins: &Twins, level: usize) -> Option<Vec3> {
    let [a, b] = twins.chains.each_ref().map(|chain| chain.get(level).map(|&joint| tree.place(joint)));
    let line = a? - b?;
    let flat = Vec3::new(line.x, 0.0, line.z);
    if flat.length() > 0.8 * line.length() { flat.try_normalize() } else { None }
}

/// Whether the first leg is the left one, as the feet point; without feet the body looks along +Z.
fn left_first(tree: &Tree, legs: &Twins, sideways: Vec3) -> bool {
    let foot = |chain: &Vec<JointIndex>| match chain.as_slice() {
        [_, _, foot, toes, ..] => tree.place(*toes) - tree.place(*foot),
        _ => Vec3::ZERO,
    };
    let toes: Vec3 = legs.chains.iter().map(foot).sum();
    let forward = Vec3::new(toes.x, 0.0, toes.z).try_normalize().unwrap_or(Vec3::Z);
    Vec3::Y.cross(forward).dot(sideways) > 0.0
}
