//! Which way is up in a motion whose rest and clip disagree: some exporters write a skeleton that stands along Y and turn its root for
//! data in which Z is up. Its rest has to stand as its clip does, or the motion would lie.

use gaitway_character::anim::{Clip, Skeleton};
use gaitway_character::asset::{Humanoid, Slot};
use glam::{DQuat, DVec3};

use super::common_frame::nearest_axis;
use crate::map::UpChoice;
use crate::pose::{Local, Scratch, WorldPose, clip_locals};

/// Moments of the clip that are looked at.
const LOOKS: usize = 16;

/// A body that leans less than this on average, as a cosine, stands along an axis.
const MIN_UPRIGHT: f64 = 0.8;

/// How far the height of the hips may be from the length of the legs, and joints in the ground, as shares of that length.
const MAX_HEIGHT_ERROR: f64 = 0.3;
const MAX_DEPTH: f64 = 0.05;

/// How a motion's rest has to be turned to stand as its clip does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundUp {
    pub turn: DQuat,
    /// Whether the body may as well lie.
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
    let turned_to = |axis: DVec3| {
        // What stands on its head isn't turned: a clip may be a handstand.
        let is_across = axis.dot(up).abs() < 0.5;
        FoundUp {
            turn: if is_across { DQuat::from_rotation_arc(up, axis) } else { DQuat::IDENTITY },
            is_doubtful: false,
        }
    };
    match choice {
        UpChoice::Y => return turned_to(DVec3::Y),
        UpChoice::Z => return turned_to(DVec3::Z),
        UpChoice::Auto => {}
    }
    let (first_secs, last_secs) = (clip.first_key_secs(), clip.duration_secs());
    let mut scratch = Scratch::default();
    let stands: Vec<Stand> = (0..LOOKS)
        .filter_map(|look| {
            let time = first_secs + (last_secs - first_secs) * look as f32 / (LOOKS - 1) as f32;
            Stand::of(&pose(clip_locals(skeleton, clip, time, &mut scratch)), slots)
        })
        .collect();
    let mean = |value: &dyn Fn(&Stand) -> DVec3| stands.iter().map(value).sum::<DVec3>() / stands.len() as f64;
    if stands.is_empty() {
        return FoundUp::AS_IT_RESTS;
    }
    let body = mean(&|stand| (stand.head - stand.feet).normalize_or_zero());
    let axis = nearest_axis(body);
    if body.dot(axis) < MIN_UPRIGHT || axis.dot(up).abs() > 0.5 {
        return FoundUp::AS_IT_RESTS;
    }
    // The body lies along its rest's up axis: on the ground, or because another axis is up in the data.
    let leg = (at_rest.hips - at_rest.feet).dot(up);
    let stands_along = (mean(&|stand| stand.hips).dot(axis) / leg - 1.0).abs() < MAX_HEIGHT_ERROR;
    let lowest = stands.iter().map(|stand| stand.lowest.dot(up)).fold(f64::INFINITY, f64::min);
    let may_lie = lowest > -MAX_DEPTH * leg;
    match (stands_along, may_lie) {
        (true, false) => turned_to(axis),
        (true, true) => FoundUp { is_doubtful: true, ..FoundUp::AS_IT_RESTS },
        (false, _) => FoundUp::AS_IT_RESTS,
    }
}

/// Where parts of a body are.
struct Stand {
    head: DVec3,
    hips: DVec3,
    /// Between both feet.
    feet: DVec3,
    /// The least coordinates of these and the toes.
    lowest: DVec3,
}

impl Stand {
    /// None without hips, head and two feet.
    fn of(pose: &WorldPose, slots: &Humanoid) -> Option<Self> {
        let at = |slot| slots.joint(slot).map(|joint| pose.position(joint));
        let [head, hips] = [at(Slot::Head)?, at(Slot::Hips)?];
        let [left, right] = [at(Slot::LeftFoot)?, at(Slot::RightFoot)?];
        let lowest = [head, hips, left, right].into_iter().chain(at(Slot::LeftToes)).chain(at(Slot::RightToes));
        Some(Self { head, hips, feet: left.midpoint(right), lowest: lowest.fold(DVec3::INFINITY, DVec3::min) })
    }
}
