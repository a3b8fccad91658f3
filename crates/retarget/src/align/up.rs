//! Which way is up in a motion whose rest and clip disagree: some exporters write a skeleton that stands along Y and turn its root
//! for data in which Z is up. Its rest has to stand as its clip does, or the motion would lie.

use gaitway_character::anim::{Clip, Skeleton};
use gaitway_character::asset::{Humanoid, Slot};
use glam::{DQuat, DVec3};

use super::common_frame::nearest_axis;
use crate::map::UpChoice;
use crate::pose::{Local, Scratch, WorldPose, clip_locals};

/// Number of times at which the clip is sampled.
const MOMENTS: usize = 16;

/// A body stands along an axis if the cosine of the angle between them, on average, is at least this.
const MIN_UPRIGHT: f64 = 0.8;

/// As shares of the length of the legs: how far the height of the hips may be from it, and how deep joints may be in the ground.
const MAX_HEIGHT_ERROR: f64 = 0.3;
const MAX_DEPTH: f64 = 0.05;

/// How a motion's rest has to be turned to stand as its clip does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundUp {
    pub turn: DQuat,
    /// Whether the body may just as well lie on the ground.
    pub is_doubtful: bool,
}

impl FoundUp {
    const AS_IT_RESTS: Self = Self { turn: DQuat::IDENTITY, is_doubtful: false };

    /// Stands a rest pose up: turns what has no parent.
    pub fn apply(&self, skeleton: &Skeleton, locals: &mut [Local]) {
        for joint in skeleton.joints().filter(|&joint| skeleton.parent(joint).is_none()) {
            let local = &mut locals[joint.get()];
            (local.rotation, local.translation) = (self.turn * local.rotation, self.turn * local.translation);
        }
    }
}

/// Compares a rest with its clip.
pub fn find_up(skeleton: &Skeleton, slots: &Humanoid, clip: &Clip, rest: &[Local], choice: UpChoice) -> FoundUp {
    let pose = |locals: Vec<Local>| WorldPose::new(skeleton, locals, DQuat::IDENTITY);
    let Some(at_rest) = Stand::of(&pose(rest.to_vec()), slots) else { return FoundUp::AS_IT_RESTS };
    let up = nearest_axis(at_rest.head - at_rest.feet);
    // What stands on its head isn't turned: a clip may be a handstand.
    let is_turned = |axis: DVec3| axis != up && axis != -up;
    let turned_to = |axis: DVec3| FoundUp { turn: DQuat::from_rotation_arc(up, axis), is_doubtful: false };
    let chosen = match choice {
        UpChoice::Auto => None,
        UpChoice::Y => Some(DVec3::Y),
        UpChoice::Z => Some(DVec3::Z),
    };
    if let Some(axis) = chosen {
        return if is_turned(axis) { turned_to(axis) } else { FoundUp::AS_IT_RESTS };
    }
    let (first_secs, last_secs) = (clip.first_key_secs(), clip.duration_secs());
    let mut scratch = Scratch::default();
    let stands: Vec<Stand> = (0..MOMENTS)
        .filter_map(|moment| {
            let time = first_secs + (last_secs - first_secs) * moment as f32 / (MOMENTS - 1) as f32;
            Stand::of(&pose(clip_locals(skeleton, clip, time, &mut scratch)), slots)
        })
        .collect();
    let mean = |value: fn(&Stand) -> DVec3| stands.iter().map(value).sum::<DVec3>() / stands.len() as f64;
    let body = mean(|stand| (stand.head - stand.feet).normalize_or_zero());
    let axis = nearest_axis(body);
    if body.dot(axis) < MIN_UPRIGHT || !is_turned(axis) {
        return FoundUp::AS_IT_RESTS;
    }
    // By its rest's up axis, the body lies: on the ground, or because another axis is up in the data.
    let leg = (at_rest.hips - at_rest.feet).dot(up);
    let stands_along = (mean(|stand| stand.hips).dot(axis) / leg - 1.0).abs() < MAX_HEIGHT_ERROR;
    let joints = stands.iter().flat_map(|stand| &stand.joints);
    let lowest = joints.map(|joint| joint.dot(up)).fold(f64::INFINITY, f64::min);
    let may_lie = lowest > -MAX_DEPTH * leg;
    match (stands_along, may_lie) {
        (true, false) => turned_to(axis),
        (true, true) => FoundUp { is_doubtful: true, ..FoundUp::AS_IT_RESTS },
        (false, _) => FoundUp::AS_IT_RESTS,
    }
}

/// Where the ends of a body are at one moment.
struct Stand {
    head: DVec3,
    hips: DVec3,
    /// Between both feet.
    feet: DVec3,
    /// Head, hips, feet and toes.
    joints: Vec<DVec3>,
}

impl Stand {
    /// None without hips, head and two feet.
    fn of(pose: &WorldPose, slots: &Humanoid) -> Option<Self> {
        let at = |slot| slots.joint(slot).map(|joint| pose.position(joint));
        let [head, hips] = [at(Slot::Head)?, at(Slot::Hips)?];
        let [left, right] = [at(Slot::LeftFoot)?, at(Slot::RightFoot)?];
        let joints = [head, hips, left, right].into_iter().chain(at(Slot::LeftToes)).chain(at(Slot::RightToes));
        Some(Self { head, hips, feet: left.midpoint(right), joints: joints.collect() })
    }
}
