//! Which joint of a leg, an arm or a neck is which part, by lengths, bends and the skin. Both sides are judged together.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::Slot::{self, *};
use gaitway_character::sort::sort_by;
use glam::Vec3;

use super::shape::{Halves, Shape, Twins};

/// A part of a limb.
#[derive(Debug, Clone, Copy)]
pub(super) struct LimbJoint {
    /// Of the left side.
    pub slot: Slot,
    /// Index into the chains of the limb.
    pub at: usize,
    pub confidence: f32,
}

/// Joints beyond this don't belong to an arm or leg without its fingers.
const MAX_JOINTS: usize = 9;

/// Confidence in an unambiguous part, and in one with an equally good alternative.
pub(super) const SURE: f32 = 0.85;
pub(super) const UNSURE: f32 = 0.3;

/// Minimum difference in cost for the cheaper choice to be certain.
const SURE_MARGIN: f32 = 0.3;

/// Upper joint, middle joint and end of a limb, as indices into its chains, and their cost.
type Triple = ([usize; 3], f32);

/// Mean straight-line distance between two joints of a limb.
fn span(shape: &Shape, twins: &Twins, a: usize, b: usize) -> f32 {
    let [one, other] = twins.chains.each_ref().map(|chain| shape.distance(chain[a], chain[b]));
    0.5 * (one + other)
}

/// Mean length of the forearm that the skin shows beyond the last joint of an arm; None if the arm goes on or has no skin.
fn forearm_beyond(shape: &Shape, twins: &Twins) -> Option<f32> {
    let length = |chain: &Vec<JointIndex>| {
        let last = *chain.last().filter(|&&last| shape.tree.children(last).is_empty())?;
        let region = shape.evidence.region(last)?;
        Some(region.min.midpoint(region.max).distance(shape.position(last)))
    };
    // The middle of forearm and hand is just above the wrist.
    Some(1.2 * 0.5 * (length(&twins.chains[0])? + length(&twins.chains[1])?))
}

/// Mean length of the path between two joints of a limb.
fn path_length(shape: &Shape, twins: &Twins, a: usize, b: usize) -> f32 {
    let [one, other] = twins.chains.each_ref().map(|chain| shape.length(&chain[a..=b]));
    0.5 * (one + other)
}

/// How far the path between two joints is from straight, 0 if it is: twist joints lie on the line, other joints bend it.
fn bend(shape: &Shape, twins: &Twins, a: usize, b: usize) -> f32 {
    let length = path_length(shape, twins, a, b);
    if length <= 0.0 {
        return f32::INFINITY;
    }
    let corner = |chain: &Vec<JointIndex>| {
        let corners = chain[a..=b].windows(3).map(|joints| {
            let [before, here, after] = [0, 1, 2].map(|at| shape.position(joints[at]));
            (here - before).angle_between(after - here)
        });
        corners.filter(|angle| angle.is_finite()).fold(0.0, f32::max)
    };
    let corner = twins.chains.iter().map(corner).fold(0.0, f32::max);
    3.0 * (1.0 - span(shape, twins, a, b) / length) + (corner / SHARP_RADIANS).min(1.0)
}

/// Minimum bend that rules out a twist joint.
const SHARP_RADIANS: f32 = 0.8;

/// Evaluates all choices of three joints; cheapest first.
fn triples(count: usize, cost: impl Fn([usize; 3]) -> f32) -> Vec<Triple> {
    let mut found = Vec::new();
    for upper in 0..count {
        for lower in upper + 1..count {
            found.extend((lower + 1..count).map(|end| ([upper, lower, end], cost([upper, lower, end]))));
        }
    }
    found.retain(|(_, cost)| cost.is_finite());
    sort_by(&mut found, |a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    found
}

/// The best choice, each joint with a confidence from what the best choice without it costs.
fn decide(triples: &[Triple], slots: [Slot; 3]) -> Vec<LimbJoint> {
    let Some(&(best, cost)) = triples.first() else { return Vec::new() };
    let parts = slots.into_iter().zip(best).enumerate().map(|(place, (slot, at))| {
        let other = triples.iter().find(|(joints, _)| joints[place] != at).map_or(f32::INFINITY, |(_, cost)| *cost);
        let margin = ((other - cost) / SURE_MARGIN).min(1.0);
        let fit = (1.4 - cost).clamp(0.0, 1.0);
        LimbJoint { slot, at, confidence: (UNSURE + (SURE - UNSURE) * margin) * fit }
    });
    parts.collect()
}

/// How far a ratio of lengths is from `usual`, in either direction.
fn off(ratio: f32, usual: f32) -> f32 {
    (ratio / usual).ln().abs()
}

/// Thigh, shin, foot and toes.
pub(super) fn leg(shape: &Shape, body: &Halves) -> Option<Vec<LimbJoint>> {
    let twins = &body.legs;
    let count = twins.chains[0].len().min(MAX_JOINTS);
    let height = |at: usize| {
        let [a, b] = twins.chains.each_ref().map(|chain| shape.position(chain[at]).dot(body.up));
        a.min(b)
    };
    let ground = (0..count).map(height).fold(f32::INFINITY, f32::min);
    let whole = path_length(shape, twins, 0, count - 1);
    let cost = |[upper, lower, end]: [usize; 3]| {
        let before = path_length(shape, twins, 0, upper) / whole;
        let (thigh, shin) = (span(shape, twins, upper, lower), span(shape, twins, lower, end));
        let bends = bend(shape, twins, upper, lower) + bend(shape, twins, lower, end);
        let above_ground = ((height(end) - ground) / whole - 0.15).max(0.0);
        let missing = 1.0 - (thigh + shin) / whole;
        off(thigh / shin, 1.0) + bends + 2.0 * above_ground + 1.5 * before + 0.5 * missing
    };
    let mut parts = decide(&triples(count, cost), [LeftUpperLeg, LeftLowerLeg, LeftFoot]);
    let foot = parts.get(2)?;
    let shin = span(shape, twins, parts[1].at, foot.at);
    let toes = foot.at + 1;
    if toes < count {
        let length = span(shape, twins, foot.at, toes);
        let is_alive = twins.chains.iter().all(|chain| is_alive(shape, chain[toes]));
        let turn = twins.chains.each_ref().map(|chain| {
            let segment =
                |a: usize, b: usize| (shape.position(chain[b]) - shape.position(chain[a])).normalize_or_zero();
            segment(parts[1].at, foot.at).dot(segment(foot.at, toes))
        });
        let is_forward = turn.iter().all(|turn| *turn < 0.9);
        let confidence = match (is_forward && (0.1..0.8).contains(&(length / shin)), is_alive) {
            (true, true) => 0.7_f32.min(foot.confidence),
            _ => UNSURE,
        };
        parts.push(LimbJoint { slot: LeftToes, at: toes, confidence });
    }
    Some(parts)
}

/// Collar bone, upper arm, forearm and hand.
pub(super) fn arm(shape: &Shape, body: &Halves, leg: &[LimbJoint]) -> Option<Vec<LimbJoint>> {
    let twins = &body.arms;
    let fork = (0..twins.chains[0].len()).find(|&at| is_palm(shape, twins.chains[0][at]));
    let forks = |at: usize| twins.chains.iter().all(|chain| shape.tree.children(chain[at]).len() > 1);
    let count = fork.map_or(twins.chains[0].len(), |fork| fork + 1).min(MAX_JOINTS);
    let sideways = |twins: &Twins, at: usize| {
        (shape.position(twins.chains[0][at]) - shape.position(twins.chains[1][at])).dot(body.across).abs()
    };
    let hips_width = sideways(&body.legs, leg.first()?.at);
    let leg_length = leg.windows(2).take(2).map(|pair| span(shape, &body.legs, pair[0].at, pair[1].at)).sum::<f32>();
    let whole = path_length(shape, twins, 0, count - 1);
    let cost = |[upper, lower, end]: [usize; 3]| {
        let (arm, forearm) = (span(shape, twins, upper, lower), span(shape, twins, lower, end));
        let bends = bend(shape, twins, upper, lower) + bend(shape, twins, lower, end);
        let near_spine = (1.0 - sideways(twins, upper) / hips_width).max(0.0);
        let missing = 1.0 - (arm + forearm) / whole;
        let is_before_palm = fork.is_some_and(|fork| end < fork);
        let is_beyond_palm = (lower + 1..end).any(forks);
        let misplaced = if is_before_palm || is_beyond_palm { 0.4 } else { 0.0 };
        off(arm / forearm, 1.05)
            + bends
            + 0.6 * near_spine
            + 0.5 * missing
            + misplaced
            + 0.3 * off((arm + forearm) / leg_length, 0.62)
    };
    let mut triples = triples(count, cost);
    // Of three joints, the last may be an elbow, and a forearm without a joint of its own the rest.
    if let (3, Some(forearm)) = (count, forearm_beyond(shape, twins)) {
        let arm = span(shape, twins, 1, 2);
        let near_spine = (1.0 - sideways(twins, 1) / hips_width).max(0.0);
        let cost = off(arm / forearm, 1.05) + 0.6 * near_spine + 0.3 * off((arm + forearm) / leg_length, 0.62);
        triples.push(([1, 2, 3], cost));
        sort_by(&mut triples, |a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    }
    let mut parts = decide(&triples, [LeftUpperArm, LeftLowerArm, LeftHand]);
    let upper = *parts.first()?;
    if let Some(at) = upper.at.checked_sub(1) {
        let length = span(shape, twins, at, upper.at);
        let is_short = length < 0.8 * span(shape, twins, upper.at, parts[1].at) && length > 0.0;
        let confidence = if is_short && at == 0 { upper.confidence.min(0.7) } else { UNSURE };
        parts.push(LimbJoint { slot: LeftShoulder, at, confidence });
    }
    Some(parts)
}

/// Whether at least three fingers grow from a joint.
fn is_palm(shape: &Shape, joint: JointIndex) -> bool {
    let children = shape.tree.children(joint);
    children.iter().filter(|&&child| !shape.tree.children(child).is_empty()).count() >= 3
}

/// Whether a joint belongs to the body, not only to its outline: it is in the skin or, without one, turns in the clip.
fn is_alive(shape: &Shape, joint: JointIndex) -> bool {
    shape.evidence.is_skinned(joint).or(shape.evidence.turns(joint)).unwrap_or(true)
}

/// Neck and head.
pub(super) fn head(shape: &Shape, body: &Halves) -> Vec<(Slot, JointIndex, f32)> {
    let is_inside = |joint: &&JointIndex| shape.evidence.is_skinned(**joint) != Some(false);
    let chain = &body.head[..body.head.iter().take_while(is_inside).count().max(1)];
    let (at, confidence) = head_by_skin(shape, chain).unwrap_or_else(|| head_by_lengths(shape, chain));
    let mut found = vec![(Head, chain[at], confidence)];
    if at > 0 {
        found.push((Neck, chain[0], confidence.min(0.7)));
    }
    found
}

/// The head holds more of the skin than the neck. What holds it may hang on the head's own joint.
fn head_by_skin(shape: &Shape, chain: &[JointIndex]) -> Option<(usize, f32)> {
    let size = |&joint: &JointIndex| shape.evidence.region(joint).map_or(0.0, |region| region.size());
    let sizes: Vec<f32> = chain.iter().map(size).collect();
    let largest = (0..chain.len()).max_by(|&a, &b| sizes[a].total_cmp(&sizes[b]))?;
    let next = (0..chain.len()).filter(|&at| at != largest).map(|at| sizes[at]).fold(0.0, f32::max);
    if sizes[largest] <= 0.0 {
        return None;
    }
    let is_leaf = shape.tree.children(chain[largest]).is_empty();
    let is_held = is_leaf && largest > 1 && sizes[largest - 1] == 0.0;
    let is_clear = sizes[largest] > 1.3 * next;
    let confidence = match (is_clear, chain) {
        (true, _) if is_held => 0.5,
        (true, _) => 0.8,
        // Two joints are neck and head.
        (false, [_, _]) => return Some((1, 0.5)),
        (false, _) => UNSURE,
    };
    Some((largest - usize::from(is_held), confidence))
}

/// Without a skin: two joints are neck and head. Of more, segments of equal length are those of a neck.
fn head_by_lengths(shape: &Shape, chain: &[JointIndex]) -> (usize, f32) {
    match chain {
        [_] => (0, 0.6),
        [.., before, last, tip] => {
            let ratio = shape.distance(*last, *tip) / shape.distance(*before, *last);
            match ratio {
                0.8..1.2 => (chain.len() - 1, 0.5),
                0.7..1.4 => (chain.len() - 1, UNSURE),
                _ => (chain.len() - 2, 0.5),
            }
        }
        _ => (chain.len() - 1, 0.6),
    }
}

/// Whether the first leg is the left one, and how sure that is, judging by where the feet point or else how the knees bend. A
/// body that shows neither is assumed to face +Z.
pub(super) fn is_first_left(shape: &Shape, body: &Halves, leg: &[LimbJoint]) -> (bool, f32) {
    let forward_if_first_is_left = body.across.cross(body.up);
    let at = |slot: Slot| leg.iter().find(|part| part.slot == slot).map(|part| part.at);
    let (Some(upper), Some(lower), Some(foot)) = (at(LeftUpperLeg), at(LeftLowerLeg), at(LeftFoot)) else {
        return (forward_if_first_is_left.z > 0.0, UNSURE);
    };
    let length = span(shape, &body.legs, upper, lower) + span(shape, &body.legs, lower, foot);
    let mut feet = Vec3::ZERO;
    for chain in &body.legs.chains {
        let ankle = shape.position(chain[foot]);
        if let Some(&toes) = chain.get(foot + 1) {
            feet += shape.position(toes) - ankle;
        }
        if let Some(region) = shape.evidence.region(chain[foot]) {
            feet += region.min.midpoint(region.max) - ankle;
        }
    }
    let pointing = feet.dot(forward_if_first_is_left) / length;
    if pointing.abs() > 0.05 {
        return (pointing > 0.0, SURE);
    }
    let bending = knees(shape, body, [upper, lower, foot]);
    if bending.abs() > 0.02 {
        return (bending > 0.0, 0.6);
    }
    (forward_if_first_is_left.z > 0.0, 0.5)
}

/// Mean bend of the knees over all poses, in leg lengths; positive if they bend to where the body faces when its first leg
/// is the left one.
fn knees(shape: &Shape, body: &Halves, [upper, lower, foot]: [usize; 3]) -> f32 {
    let mut sum = 0.0;
    for positions in &shape.evidence.poses {
        let [first, second] =
            body.legs.chains.each_ref().map(|chain| [upper, lower, foot].map(|at| positions[chain[at].get()]));
        let trunk = body.trunk.last().map_or(Vec3::ZERO, |top| positions[top.get()]) - first[0].midpoint(second[0]);
        let Some(forward) = (first[0] - second[0]).cross(trunk).try_normalize() else { continue };
        for [upper, lower, foot] in [first, second] {
            let leg = foot - upper;
            let along = (lower - upper).dot(leg) / leg.length_squared().max(f32::MIN_POSITIVE);
            sum += (lower - upper - leg * along).dot(forward) / leg.length().max(f32::MIN_POSITIVE);
        }
    }
    sum / (2.0 * shape.evidence.poses.len() as f32)
}
