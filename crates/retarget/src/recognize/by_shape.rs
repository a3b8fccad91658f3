//! Finds a body by its shape alone, for skeletons whose names say nothing. Which joint of a limb is which part is decided in
//! `limbs` and `fingers`; every part has a confidence of its own.

use std::collections::BTreeMap;

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::Side;
use gaitway_character::asset::Slot::{self, *};
use gaitway_character::sort::sort_by;

use super::assemble::spread;
use super::evidence::Evidence;
use super::shape::{Halves, Shape, halves};
use super::tree::Tree;
use super::{Reason, RecognizedJoint, fingers, limbs};

/// Parts that are less certain than this are left out.
const MIN_CONFIDENCE: f32 = 0.45;

/// What was found, and what was not certain enough to keep.
#[derive(Debug, Default)]
pub(super) struct Found {
    pub parts: BTreeMap<Slot, RecognizedJoint>,
    pub left_out: BTreeMap<Slot, RecognizedJoint>,
}

/// Returns the joints of a body; empty if nothing looks like one. Tries the rest, then the first frame of the first clip:
/// motion capture often rests with all bones along one axis.
pub(super) fn find(tree: &Tree, evidence: &Evidence) -> Found {
    let shapes = evidence.poses.iter().take(2).map(|positions| Shape::new(tree, evidence, positions));
    let mut found = Found::default();
    let Some(parts) = shapes.into_iter().find_map(|shape| slots(&shape, &halves(&shape)?)) else { return found };
    for (slot, joint, confidence) in parts {
        let part = RecognizedJoint { joint, reason: Reason::Geometry, confidence };
        // The surest part of a joint comes first.
        if found.parts.contains_key(&slot) || found.parts.values().any(|other| other.joint == joint) {
            continue;
        }
        let parts = if confidence >= MIN_CONFIDENCE { &mut found.parts } else { &mut found.left_out };
        parts.insert(slot, part);
    }
    // Legs and a trunk alone may be a bird's.
    if [Head, LeftLowerArm].iter().any(|slot| found.parts.contains_key(slot)) { found } else { Found::default() }
}

/// Slots with joint and confidence; the surest first where several are for one joint.
fn slots(shape: &Shape, body: &Halves) -> Option<Vec<(Slot, JointIndex, f32)>> {
    let legs = limbs::leg(shape, body)?;
    let arms = limbs::arm(shape, body, &legs).unwrap_or_default();
    let mut found = vec![(Hips, body.hips, if body.hips == body.legs.base { 0.9 } else { 0.7 })];
    found.extend(limbs::head(shape, body));
    let has_neck = found.iter().any(|(slot, ..)| *slot == Neck);
    found.extend(trunk(shape, body, has_neck));
    // Arms may be listed in another order than legs.
    let is_same_order = shape.apart(&body.arms)?.dot(body.across) > 0.0;
    let (is_first_left, certainty) =
        match (limbs::is_first_left(shape, body, &legs), named_left(shape, body, is_same_order)) {
            // Names may say left and right without another word that means something; only feet that point elsewhere are surer.
            ((_, certainty), Some(is_named_left)) if certainty < limbs::SURE => (is_named_left, limbs::SURE),
            (seen, _) => seen,
        };
    for (limb, twins, is_left) in
        [(&legs, &body.legs, is_first_left), (&arms, &body.arms, is_first_left == is_same_order)]
    {
        for (chain, is_left) in twins.chains.iter().zip([is_left, !is_left]) {
            let side = |slot: Slot| if is_left { slot } else { slot.mirrored() };
            // The end of an arm without a hand is not a joint.
            let joints = limb.iter().filter_map(|part| Some((side(part.slot), *chain.get(part.at)?, part)));
            found.extend(joints.map(|(slot, joint, part)| (slot, joint, part.confidence.min(certainty))));
            let hand = limb.iter().find(|part| part.slot == LeftHand && part.confidence >= MIN_CONFIDENCE);
            if let Some(hand) = hand {
                let fingers = chain.get(hand.at).map(|&hand| fingers::find(shape, hand)).unwrap_or_default();
                found.extend(
                    fingers.into_iter().map(|(slot, joint, confidence)| (side(slot), joint, confidence.min(certainty))),
                );
            }
        }
    }
    sort_by(&mut found, |a, b| b.2.total_cmp(&a.2).then(a.0.cmp(&b.0)));
    Some(found)
}

/// Whether the first leg is the left one by the names of arms and legs; None if they don't say or don't agree.
fn named_left(shape: &Shape, body: &Halves, is_same_order: bool) -> Option<bool> {
    let mut votes = Vec::new();
    for (twins, is_same_order) in [(&body.legs, true), (&body.arms, is_same_order)] {
        for (chain, side_if_first_left) in twins.chains.iter().zip([Side::Left, Side::Right]) {
            let said = chain.iter().filter_map(|joint| shape.tree.names[joint.get()].side);
            votes.extend(said.map(|said| (said == side_if_first_left) == is_same_order));
        }
    }
    let first = *votes.first()?;
    (votes.len() >= 4 && votes.iter().all(|&vote| vote == first)).then_some(first)
}

/// The joints between hips and neck. A lowest one that no skin references and that never rotates only connects the
/// spine. Without a joint for the neck, the highest ones may be it.
fn trunk(shape: &Shape, body: &Halves, has_neck: bool) -> Vec<(Slot, JointIndex, f32)> {
    let is_still = |joint: JointIndex| {
        shape.evidence.turns(joint) == Some(false) && shape.evidence.is_skinned(joint) != Some(true)
    };
    let links = usize::from(matches!(body.trunk[..], [first, second, ..] if is_still(first) && !is_still(second)));
    let torso = &body.trunk[links..];
    let confidence = if torso.len() <= 3 { 0.75 } else { 0.6 };
    let is_sure = |slot| has_neck || slot == Spine || torso.len() <= 2;
    let parts = spread(torso).into_iter();
    parts.map(|(slot, joint)| (slot, joint, if is_sure(slot) { confidence } else { limbs::UNSURE })).collect()
}
