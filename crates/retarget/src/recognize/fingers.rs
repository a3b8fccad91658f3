//! Which of the chains on a hand is which finger, by their place in the palm.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::{Side, Slot};
use gaitway_character::sort::sort_by;

use super::known::finger_slots;
use super::shape::Shape;

const CONFIDENCE: f32 = 0.6;

/// Returns the left slots of the fingers on a hand; empty if thumb and order are not clear.
pub(super) fn find(shape: &Shape, hand: JointIndex) -> Vec<(Slot, JointIndex, f32)> {
    let mut fingers: Vec<Vec<JointIndex>> = Vec::new();
    for &child in shape.tree.children(hand) {
        let chain = shape.chain(child);
        if chain.len() >= 2 {
            fingers.push(chain);
        }
    }
    if !(4..=5).contains(&fingers.len()) {
        return Vec::new();
    }
    // The thumb begins nearest to the wrist.
    let base = |finger: &Vec<JointIndex>| shape.position(segments(shape, hand, finger, false)[0]);
    let wrist = shape.position(hand);
    sort_by(&mut fingers, |a, b| base(a).distance(wrist).total_cmp(&base(b).distance(wrist)));
    let thumb = fingers.remove(0);
    let thumb_base = shape.position(thumb[0]);
    let second = shape.position(thumb[1]);
    sort_by(&mut fingers, |a, b| base(a).distance(second).total_cmp(&base(b).distance(second)));
    let (Some(index), Some(last)) = (fingers.first().map(&base), fingers.last().map(&base)) else { return Vec::new() };
    let palm = last - index;
    let steps: Vec<f32> =
        fingers.iter().map(|finger| (base(finger) - index).dot(palm) / palm.length_squared()).collect();
    let is_in_order = steps.windows(2).all(|pair| pair[1] > pair[0] + 0.1);
    let is_thumb_first = (thumb_base - index).dot(palm) < 0.3 * palm.length_squared();
    if !is_in_order || !is_thumb_first {
        return Vec::new();
    }
    let mut found = Vec::new();
    for (number, finger) in (0_u8..).zip(std::iter::once(&thumb).chain(&fingers)) {
        let joints = segments(shape, hand, finger, number == 0);
        found.extend(finger_slots(number, Side::Left).zip(joints).map(|(slot, &joint)| (slot, joint, CONFIDENCE)));
    }
    found
}

/// A finger's joints without a bone in the palm, which begins near the wrist and is longer than what follows.
fn segments<'a>(shape: &Shape, hand: JointIndex, finger: &'a [JointIndex], is_thumb: bool) -> &'a [JointIndex] {
    match finger {
        [palm, first, second, ..] if !is_thumb && finger.len() >= 4 => {
            let (inner, outer) = (shape.distance(*palm, *first), shape.distance(*first, *second));
            let is_palm = inner > 1.2 * outer && shape.distance(hand, *palm) < inner;
            &finger[usize::from(is_palm)..]
        }
        _ => finger,
    }
}
