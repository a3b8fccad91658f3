//! Finds helpers that hang beside the body but belong to one of its joints: what engines aim their inverse kinematics at
//! (`ik_foot_l`, `ik_hand_gun`) and joints for what is held. They move no skin and rest where their joint does, or have a name that
//! says which one it is.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::{Side, Slot};

use super::{Form, on};
use crate::pose::{ancestry, is_within};
use crate::recognize::Name;

/// A joint beside the body that moves as if it hung on a joint of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Follower {
    /// The helper.
    pub joint: JointIndex,
    /// The joint that it belongs to.
    pub follows: JointIndex,
}

/// What helpers belong to.
const FOLLOWED: [Slot; 2] = [Slot::LeftHand, Slot::LeftFoot];

/// Greatest distance at rest from the joint that a helper rests at, as a share of the body's height.
const MAX_DISTANCE: f64 = 0.005;

pub fn find(form: &Form) -> Vec<Follower> {
    let hangs_on_body = |joint: JointIndex| {
        let hips = form.slots.joint(Slot::Hips);
        hips.is_some_and(|hips| is_within(form.skeleton, joint, hips) || is_within(form.skeleton, hips, joint))
    };
    let mut carries_skin = vec![false; form.skeleton.len()];
    let moving = form.skeleton.joints().filter(|joint| form.moves_skin[joint.get()] || form.is_slot(*joint));
    for joint in moving {
        ancestry(form.skeleton, joint).for_each(|above| carries_skin[above.get()] = true);
    }
    let height = height(form);
    let ends: Vec<(Side, Slot, JointIndex)> = [Side::Left, Side::Right]
        .into_iter()
        .flat_map(|side| FOLLOWED.map(|slot| (side, slot)))
        .filter_map(|(side, slot)| Some((side, slot, form.slots.joint(on(side, slot))?)))
        .collect();
    let followed = |joint: JointIndex| {
        let name = Name::read(form.skeleton.name(joint));
        let is_meant = |(side, slot, _): &&(Side, Slot, JointIndex)| {
            let part = if *slot == Slot::LeftHand { ["hand", "wrist"] } else { ["foot", "ankle"] };
            name.side == Some(*side) && name.has("ik") && part.iter().any(|part| name.has(part))
        };
        let is_there = |(.., end): &&(Side, Slot, JointIndex)| form.distance(joint, *end) <= MAX_DISTANCE * height;
        let end = ends.iter().find(is_meant).or_else(|| ends.iter().find(is_there));
        end.map(|&(.., follows)| Follower { joint, follows })
    };
    let is_helper = |joint: &JointIndex| !carries_skin[joint.get()] && !hangs_on_body(*joint);
    form.skeleton.joints().filter(is_helper).filter_map(followed).collect()
}

fn height(form: &Form) -> f64 {
    let heights = form.slots.0.values().map(|&joint| form.position(joint));
    let (low, high) = heights.fold((glam::DVec3::INFINITY, glam::DVec3::NEG_INFINITY), |(low, high), position| {
        (low.min(position), high.max(position))
    });
    (high - low).max_element().max(0.0)
}
