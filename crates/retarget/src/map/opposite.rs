//! Which joint of a skeleton mirrors which: by slot, else by names that differ only in their side.

use std::collections::BTreeMap;

use gaitway_character::anim::{JointIndex, Skeleton};
use gaitway_character::asset::Side;

use crate::recognize::{Name, Recognized};

/// Returns for each joint its counterpart on the other side of the body; None for joints in the middle and ambiguous ones.
pub fn opposite_joints(skeleton: &Skeleton, recognized: &Recognized) -> Vec<Option<JointIndex>> {
    let mut opposite = vec![None; skeleton.len()];
    for (slot, found) in &recognized.parts {
        let other = recognized.joint(slot.mirrored()).filter(|&other| other != found.joint);
        opposite[found.joint.get()] = other;
    }
    let others: Vec<JointIndex> = skeleton.joints().filter(|&joint| recognized.slot(joint).is_none()).collect();
    let pairs = pairs_by_side(others.iter().map(|&joint| skeleton.name(joint)));
    for [left, right] in pairs.map(|pair| pair.map(|at| others[at])) {
        opposite[left.get()] = Some(right);
        opposite[right.get()] = Some(left);
    }
    opposite
}

/// Returns the indices of names that differ only in their side, left first; those that fit several others are left out.
pub fn pairs_by_side<'a>(names: impl Iterator<Item = &'a str>) -> impl Iterator<Item = [usize; 2]> {
    let mut by_words: BTreeMap<Vec<String>, [Vec<usize>; 2]> = BTreeMap::new();
    for (at, name) in names.enumerate() {
        let name = Name::read(name);
        let Some(side) = name.side else { continue };
        by_words.entry(name.words).or_default()[usize::from(side == Side::Right)].push(at);
    }
    by_words.into_values().filter_map(|sides| match sides.each_ref().map(Vec::as_slice) {
        [&[left], &[right]] => Some([left, right]),
        _ => None,
    })
}
