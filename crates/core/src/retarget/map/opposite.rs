//! Which joint of a skeleton mirrors which: by slot, else by names that differ only in their side.

use std::collections::BTreeMap;

use crate::anim::{JointIndex, Skeleton};
use crate::retarget::recognize::{Name, Recognized, Side};

/// Returns for each joint its counterpart on the other side of the body; None for joints in the middle and ambiguous ones.
pub fn opposite_joints(skeleton: &Skeleton, recognized: &Recognized) -> Vec<Option<JointIndex>> {
    let mut opposite = vec![None; skeleton.len()];
    for (slot, found) in &recognized.parts {
        let other = recognized.joint(slot.mirrored()).filter(|&other| other != found.joint);
        opposite[found.joint.get()] = other;
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
