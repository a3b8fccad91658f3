//! Finds the chains of a body: the joints between its slots, and tails and ears.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::{Side, Slot};

use super::{Chain, ChainJoint, ChainPart, Form, TwistJoint, appendages, on};
use crate::pose::ancestry;

pub fn find(form: &Form, twists: &[TwistJoint]) -> Vec<Chain> {
    let slot = |slot: Slot| form.slots.joint(slot);
    let head = slot(Slot::Head);
    let is_twist = |joint: JointIndex| twists.iter().any(|twist| twist.joint == joint);
    let mut chains: Vec<Chain> = Vec::new();
    let mut add = |part: ChainPart, carrier: Option<JointIndex>, tip: Option<JointIndex>| {
        let (carrier, path) = (carrier?, form.path(carrier?, tip?)?);
        let is_in_hips =
            |joint: &JointIndex| part == ChainPart::Trunk && is_level_with(form, carrier, *joint, head.or(tip));
        let path = path.into_iter().skip_while(is_in_hips);
        let joints: Vec<JointIndex> = path.filter(|&joint| !is_twist(joint)).collect();
        let last = *joints.last()?;
        chains.push(Chain { part, carrier, joints: with_shares(form, carrier, &joints) });
        Some(last)
    };
    let trunk = add(ChainPart::Trunk, slot(Slot::Hips), trunk_top(form));
    let below_head = head.and_then(|head| form.skeleton.parent(head)).filter(|&joint| Some(joint) != trunk);
    add(ChainPart::Neck, trunk, below_head);
    for side in [Side::Left, Side::Right] {
        let tip = |slots: &[Slot]| slots.iter().find_map(|&left| slot(on(side, left)));
        let hand = tip(&[Slot::LeftHand, Slot::LeftLowerArm]);
        add(ChainPart::Arm(side), trunk, hand);
        add(ChainPart::Leg(side), slot(Slot::Hips), tip(&[Slot::LeftToes, Slot::LeftFoot, Slot::LeftLowerLeg]));
        for (finger, slots) in (0_u8..).zip(FINGERS) {
            let first = slots.iter().find_map(|&left| slot(on(side, left)));
            let carrier = first.and_then(|first| form.skeleton.parent(first));
            add(ChainPart::Finger(side, finger), carrier, slots.iter().rev().find_map(|&left| slot(on(side, left))));
        }
    }
    for (part, joints) in appendages::find(form) {
        let carrier = joints.first().and_then(|&root| form.skeleton.parent(root));
        chains.extend(carrier.map(|carrier| Chain { part, carrier, joints: with_shares(form, carrier, &joints) }));
    }
    chains
}

/// The slots of each finger of the left hand, thumb first.
const FINGERS: [[Slot; 3]; 5] = [
    [Slot::LeftThumbMetacarpal, Slot::LeftThumbProximal, Slot::LeftThumbDistal],
    [Slot::LeftIndexProximal, Slot::LeftIndexIntermediate, Slot::LeftIndexDistal],
    [Slot::LeftMiddleProximal, Slot::LeftMiddleIntermediate, Slot::LeftMiddleDistal],
    [Slot::LeftRingProximal, Slot::LeftRingIntermediate, Slot::LeftRingDistal],
    [Slot::LeftLittleProximal, Slot::LeftLittleIntermediate, Slot::LeftLittleDistal],
];

/// Returns the joint that carries neck and arms: the one below the neck that the arms hang on, or else the highest slot of the trunk.
fn trunk_top(form: &Form) -> Option<JointIndex> {
    let slot = |slot: Slot| form.slots.joint(slot);
    let highest = [Slot::UpperChest, Slot::Chest, Slot::Spine].into_iter().find_map(slot);
    let hips = slot(Slot::Hips)?;
    let above_hips = |joint: JointIndex| form.path(hips, joint).is_some();
    let arm = |left: [Slot; 2], side: Side| left.into_iter().find_map(|left| slot(on(side, left)));
    let [left, right] = [Side::Left, Side::Right].map(|side| arm([Slot::LeftShoulder, Slot::LeftUpperArm], side));
    let meeting = left.zip(right).and_then(|(left, right)| {
        ancestry(form.skeleton, left).skip(1).find(|&joint| form.path(joint, right).is_some())
    });
    // Arms that hang on the hips say nothing. If they hang on the neck, no joint between trunk and neck is known to be either's.
    let top = meeting.filter(|&joint| above_hips(joint)).or(highest).filter(|&joint| above_hips(joint));
    let above = slot(Slot::Neck).or(slot(Slot::Head));
    top.filter(|&joint| above.is_none_or(|above| form.path(joint, above).is_some()))
}

/// Whether a joint without a slot lies no higher than the hips: it carries the skin of the pelvis, or nothing at all, and trunks don't
/// bend there.
fn is_level_with(form: &Form, hips: JointIndex, joint: JointIndex, top: Option<JointIndex>) -> bool {
    let [hips, top] = [hips, top.unwrap_or(joint)].map(|joint| form.position(joint));
    let up = top - hips;
    !form.is_slot(joint) && (form.position(joint) - hips).dot(up) < MIN_RISE * up.length_squared()
}

/// Minimum height of a trunk's first joint above the hips, as a share of the way to the head.
const MIN_RISE: f64 = 0.025;

fn with_shares(form: &Form, carrier: JointIndex, joints: &[JointIndex]) -> Vec<ChainJoint> {
    let steps = std::iter::once(&carrier).chain(joints).zip(joints);
    let along: Vec<f64> = steps
        .scan(0.0, |along, (above, joint)| {
            *along += form.distance(*above, *joint);
            Some(*along)
        })
        .collect();
    let joints = joints.iter().zip(&along).zip(shares(&along));
    joints.map(|((&joint, &along), share)| ChainJoint { joint, share, along }).collect()
}

/// Returns each joint's share of a chain's length, from the joints' distances along it. The first and the last joint reach as
/// far beyond the chain as into it.
pub fn shares(along: &[f64]) -> Vec<f64> {
    let gaps: Vec<f64> = along.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let length = |at: usize| {
        let before = at.checked_sub(1).and_then(|at| gaps.get(at)).or(gaps.first()).copied().unwrap_or(0.0);
        let after = gaps.get(at).or(gaps.last()).copied().unwrap_or(0.0);
        0.5 * (before + after)
    };
    let whole: f64 = (0..along.len()).map(length).sum();
    let share = |at: usize| if whole > 0.0 { length(at) / whole } else { 1.0 / along.len() as f64 };
    (0..along.len()).map(share).collect()
}
