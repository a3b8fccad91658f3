//! Pins: hands and feet that stay where they are put, and heads that look at something. A pin changes rotations: two bones
//! reach for the goal in the limb's own plane, and the joint at their end keeps its direction. An end that hangs beside its bones
//! is moved as well.
//!
//! Pins come after manual poses and before what an avatar adds, since gazes need the camera. They are solved in double
//! precision from the pose alone, without state between frames, by the two-bone solver that also plants feet.

mod bake;
mod limb;

use std::collections::BTreeMap;

use gaitway_character::anim::{JointIndex, Pose};
use gaitway_character::asset::Asset;
use glam::{Affine3A, DQuat, DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::math::{slerp, smooth};
use super::pose::is_within;
use super::recognize::Recognized;
use limb::{frame_of, parent_of, turn_joint};

/// What a joint does instead of following its clip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pin {
    /// Where the joint goes.
    pub goal: PinGoal,
    /// When it is there; `None` is always.
    pub times: Option<PinTimes>,
}

/// When a pin holds, in seconds of the clip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PinTimes {
    /// The pin counts fully from here.
    pub start_secs: f64,
    /// It counts fully up to here.
    pub end_secs: f64,
    /// Transition before the start and after the end, up to [`Self::MAX_BLEND_SECS`].
    pub blend_secs: f64,
}

/// Where a pinned joint goes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PinGoal {
    /// It stays at a point in world space.
    Point(Vec3),
    /// It stays at a point in the space of another joint, given by its index in the file.
    Joint(usize, Vec3),
    /// It turns to look at a point in world space.
    Look(Vec3),
    /// It turns to look at the camera.
    Camera,
}

impl PinTimes {
    /// Longest transition.
    pub const MAX_BLEND_SECS: f64 = 10.0;

    /// Returns the times in order and in range; `None` if one isn't finite.
    fn checked(self) -> Option<Self> {
        let Self { start_secs, end_secs, blend_secs } = self;
        (start_secs.is_finite() && end_secs.is_finite() && blend_secs.is_finite()).then(|| Self {
            start_secs: start_secs.min(end_secs),
            end_secs: start_secs.max(end_secs),
            blend_secs: blend_secs.clamp(0.0, Self::MAX_BLEND_SECS),
        })
    }
}

impl Pin {
    /// Returns the pin with its times in range; `None` if a number isn't finite.
    pub fn checked(self) -> Option<Self> {
        let is_finite = match self.goal {
            PinGoal::Point(at) | PinGoal::Joint(_, at) | PinGoal::Look(at) => at.is_finite(),
            PinGoal::Camera => true,
        };
        let times = self.times.map(PinTimes::checked);
        (is_finite && times != Some(None)).then_some(Self { times: times.flatten(), ..self })
    }

    /// Returns how much the pin counts at a time of the clip, from 0 to 1.
    pub fn weight(&self, time_secs: f64) -> f64 {
        let Some(PinTimes { start_secs, end_secs, blend_secs }) = self.times else { return 1.0 };
        let outside_secs = (start_secs - time_secs).max(time_secs - end_secs);
        if outside_secs <= 0.0 { 1.0 } else { smooth(1.0 - outside_secs / blend_secs.max(1e-9)) }
    }

    /// Points come first, so that heads look at hands that are already in place, and hands follow heads that have turned.
    fn stage(&self) -> usize {
        match self.goal {
            PinGoal::Point(_) => 0,
            PinGoal::Look(_) | PinGoal::Camera => 1,
            PinGoal::Joint(..) => 2,
        }
    }

    fn is_gaze(&self) -> bool {
        self.stage() == 1
    }
}

/// The pins of a model in a scene.
#[derive(Debug, Clone, Copy)]
pub struct Pinning<'a> {
    /// The file.
    pub asset: &'a Asset,
    /// What was recognized in it.
    pub body: &'a Recognized,
    /// Pins by their joint's index in the file.
    pub pins: &'a BTreeMap<usize, Pin>,
    /// Rotation of the model in the scene.
    pub world_from_model: Affine3A,
    /// The camera's position in world space; gazes at an unknown camera have no effect.
    pub eye: Option<Vec3>,
}

impl Pinning<'_> {
    /// Applies all pins, as much as they count at a time of the clip, to its pose. Allocates nothing.
    pub fn apply(&self, time_secs: f64, pose: &mut Pose) {
        for (joint, pin) in self.in_order() {
            let weight = pin.weight(time_secs);
            if weight > 0.0 {
                self.apply_one(joint, pin, weight, pose);
            }
        }
    }

    /// Whether a joint, given by its index in the file, can have this goal: any can look, but only the end of two bones can be
    /// held, and not at a joint that moves along with them.
    pub fn allows(&self, joint: usize, goal: PinGoal) -> bool {
        let Some(joint) = self.asset.skeleton.joint_of_source(joint) else { return false };
        match goal {
            PinGoal::Look(_) | PinGoal::Camera => true,
            PinGoal::Point(_) | PinGoal::Joint(..) => self.limb_for(joint, goal).is_some(),
        }
    }

    /// Returns the limb that reaches for a goal; `None` for a goal that moves along with it, which it would never reach.
    fn limb_for(&self, end: JointIndex, goal: PinGoal) -> Option<[JointIndex; 3]> {
        let skeleton = &self.asset.skeleton;
        let limb = self.limb(end)?;
        let PinGoal::Joint(other, _) = goal else { return Some(limb) };
        let other = skeleton.joint_of_source(other)?;
        (!limb.into_iter().any(|own| is_within(skeleton, other, own))).then_some(limb)
    }

    /// The pins in the order they are applied.
    fn in_order(&self) -> impl Iterator<Item = (JointIndex, &Pin)> {
        let pins = |stage| self.pins.iter().filter(move |(_, pin)| pin.stage() == stage);
        let joint = |number: &usize| self.asset.skeleton.joint_of_source(*number);
        (0..3).flat_map(pins).filter_map(move |(number, pin)| Some((joint(number)?, pin)))
    }

    /// Returns `None` if the pin has no effect on this pose.
    fn apply_one(&self, joint: JointIndex, pin: &Pin, weight: f64, pose: &mut Pose) -> Option<()> {
        let skeleton = &self.asset.skeleton;
        let part = |turn: DQuat| slerp(DQuat::IDENTITY, turn, weight);
        if pin.is_gaze() {
            let turn = self.gaze(joint, self.goal(pin, pose)?, pose)?;
            turn_joint(joint, parent_of(skeleton, pose, joint), part(turn), pose);
            return Some(());
        }
        let limb = self.limb_for(joint, pin.goal)?;
        let [swing, bend] = self.reach(limb, self.goal(pin, pose)?, pose)?.map(part);
        let moved_end = self.is_detached(limb).then(|| self.turned_end(limb, [swing, bend], pose));
        let [upper, lower, parent_of_end] = limb.map(|joint| parent_of(skeleton, pose, joint));
        turn_joint(limb[0], upper, swing, pose);
        turn_joint(limb[1], lower, bend, pose);
        match moved_end.map(|end| parent_of_end.inverse().transform_point3(end)) {
            Some(end) => pose.set_translation(joint, end.is_finite().then_some(end)?.as_vec3()),
            None => turn_joint(joint, parent_of_end, (swing * bend).conjugate(), pose),
        }
        Some(())
    }

    /// The goal in model space. `None` for an unknown camera or joint.
    fn goal(&self, pin: &Pin, pose: &Pose) -> Option<DVec3> {
        let model_from_world = |at| self.world_from_model.inverse().transform_point3(at).as_dvec3();
        match pin.goal {
            PinGoal::Point(at) | PinGoal::Look(at) => Some(model_from_world(at)),
            PinGoal::Camera => self.eye.map(model_from_world),
            PinGoal::Joint(number, at) => {
                let skeleton = &self.asset.skeleton;
                Some(frame_of(skeleton, pose, skeleton.joint_of_source(number)?).transform_point3(at.as_dvec3()))
            }
        }
    }
}
