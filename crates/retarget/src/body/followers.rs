//! Finds helpers that hang beside the body but belong to one of its joints: what engines aim their inverse kinematics at
//! (`ik_foot_l`, `ik_hand_gun`) and joints for what is held. They move no skin and rest where their joint does, or have a name that
//! says which one it is.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::{Side, Slot};

use super::{Form, on};
use crate::pose::ancestry;
use crate::recognize::Name;

/// A joint beside the body that moves as if it hung on a joint of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Follower {
    /// The helper.
    pub joint: JointIndex,
    /// The joint that it belongs to.
    pub follows: JointIndex,
}

/// Slots that helpers belong to; the right ones are mirrored.
const FOLLOWED: [Slot; 2] = [Slot::LeftHand, Slot::LeftFoot];

/// Maximum distance at rest between a helper and the joint that it belongs to, as a share of the body's height.
const MAX_DISTANCE: f64 = 0.005;

/// Maximum number of helpers: rigs have a dozen, damaged files may have thousands in one place.
const MAX_FOLLOWERS: usize = 64;

pub fn find(form: &Form) -> Vec<Follower> {
    let (hangs_on_body, carries_skin) = (hanging_on_body(form), carrying_skin(form));
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
    let is_helper = |joint: &JointIndex| !carries_skin[joint.get()] && !hangs_on_body[joint.get()];
    form.skeleton.joints().filter(is_helper).filter_map(followed).take(MAX_FOLLOWERS).collect()
}

/// Which joints are above or below the hips, or the hips themselves.
fn hanging_on_body(form: &Form) -> Vec<bool> {
    let mut hanging = vec![false; form.skeleton.len()];
    let Some(hips) = form.slots.joint(Slot::Hips) else { return hanging };
    hanging[hips.get()] = true;
    // Parents come before their children.
    for (at, parent) in form.skeleton.parents().iter().enumerate() {
        if parent.is_some_and(|parent| hanging[parent.get()]) {
            hanging[at] = true;
        }
    }
    ancestry(form.skeleton, hips).for_each(|above| hanging[above.get()] = true);
    hanging
}

/// Which joints move skin or have a slot, or carry one that does.
fn carrying_skin(form: &Form) -> Vec<bool> {
    let carries = |joint: JointIndex| form.moves_skin[joint.get()] || form.is_slot(joint);
    let mut carrying: Vec<bool> = form.skeleton.joints().map(carries).collect();
    for (at, parent) in form.skeleton.parents().iter().enumerate().rev() {
        if let Some(parent) = parent.filter(|_| carrying[at]) {
            carrying[parent.get()] = true;
        }
    }
    carrying
}

fn height(form: &Form) -> f64 {
    let heights = form.slots.0.values().map(|&joint| form.position(joint));
    let (low, high) = heights.fold((glam::DVec3::INFINITY, glam::DVec3::NEG_INFINITY), |(low, high), position| {
        (low.min(position), high.max(position))
    });
    (high - low).max_element().max(0.0)
}
