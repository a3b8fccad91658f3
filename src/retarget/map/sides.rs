//! Which joint of a skeleton lies opposite which: by parts of the body, else by names that differ in their side alone.

use std::collections::BTreeMap;

use crate::anim::{JointIndex, Skeleton};
use crate::retarget::recognize::{Name, Recognized, Side};

/// For each joint the one on the other side of the body; none for joints in the middle and where there is doubt.
pub fn opposite_joints(skeleton: &Skeleton, recognized: &Recognized) -> Vec<Option<JointIndex>> {
    let mut opposite = vec![None; skeleton.len()];
    for (slot, part) in &recognized.parts {
        let other = recognized.joint(slot.mirrored()).filter(|&other| other != part.joint);
        opposite[part.joint.get()] = other;
    }
    let mut by_words: BTreeMap<Vec<String>, [Vec<JointIndex>; 2]> = BTreeMap::new();
    for joint in skeleton.joints().filter(|&joint| recognized.slot(joint).is_none()) {
        let name = Name::read(skeleton.name(joint));
        let Some(side) = name.side else { continue };
        by_words.entry(name.words).or_default()[usize::from(side == Side::Right)].push(joint);
    }
    for sides in by_words.into_values() {
        if let ([left], [right]) = (sides[0].as_slice(), sides[1].as_slice()) {
            opposite[left.get()] = Some(*right);
            opposite[right.get()] = Some(*left);
        }
    }
    opposite
}
