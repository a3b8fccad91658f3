//! Judges whether a body could rest in a pose: upright and symmetric.

use gaitway_character::anim::{Clip, Keys, Skeleton};
use gaitway_character::asset::{Humanoid, Slot};
use glam::{DQuat, DVec3};

use super::common_frame::{front, nearest_quarter};
use crate::math::{angle_between, degrees_between, unit};
use crate::pose::{Local, Scratch, WorldPose, clip_locals};

/// Number of times at which the clip is compared.
const REST_SAMPLES: usize = 64;

/// Minimum gain in score for a pose of the clip to replace the rest, or a later one an earlier one.
const MIN_GAIN: f64 = 0.01;

/// Even in motion, bodies are more upright than this; rests whose bones all lie along one axis aren't.
const MIN_BODY_UPRIGHTNESS: f64 = 0.3;

/// Poses whose joints are turned by less than this on average are the same.
const SAME_POSE_DEGREES: f64 = 2.0;

/// Segments that left and right are compared by; the right ones are the mirrored slots.
const SEGMENTS: [(Slot, Slot); 5] = [
    (Slot::LeftUpperLeg, Slot::LeftLowerLeg),
    (Slot::LeftLowerLeg, Slot::LeftFoot),
    (Slot::LeftFoot, Slot::LeftToes),
    (Slot::LeftUpperArm, Slot::LeftLowerArm),
    (Slot::LeftLowerArm, Slot::LeftHand),
];

/// How a body stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stance {
    /// Mean cosine between the torso and the four leg segments, from −1 to 1: 1 for straight legs in line with the torso.
    pub uprightness: f64,
    /// Mean angle between the limbs of one side and the mirrored ones of the other.
    pub asymmetry_degrees: f64,
}

impl Stance {
    /// None without hips, head and legs.
    pub fn of(pose: &WorldPose, slots: &Humanoid) -> Option<Self> {
        Some(Self { uprightness: uprightness(pose, slots)?, asymmetry_degrees: asymmetry_degrees(pose, slots)? })
    }

    /// How much this looks like a rest, from 0 to 1. Rests of real rigs are symmetric within 5° and straighter than 25°.
    pub fn confidence(self) -> f64 {
        let upright = (self.uprightness - 0.6) / 0.3;
        let symmetric = (25.0 - self.asymmetry_degrees) / 20.0;
        upright.min(symmetric).clamp(0.0, 1.0)
    }

    /// Compares poses, none of which may look like a rest.
    fn score(self) -> f64 {
        self.uprightness - self.asymmetry_degrees / 90.0
    }
}

/// A pose of a clip that looks more like a rest than its skeleton's own.
pub struct Standing {
    pub locals: Vec<Local>,
    pub stance: Stance,
    /// None for the mean of the clip.
    pub time_secs: Option<f32>,
}

/// Returns the pose of the clip, at some time or averaged, that looks most like a rest; None if none beats `rest`. In a
/// walk no single pose is symmetric, but the mean is.
pub fn best_standing(skeleton: &Skeleton, slots: &Humanoid, clip: &Clip, rest: Stance) -> Option<Standing> {
    let mut scratch = Scratch::default();
    let mut best: Option<Standing> = None;
    let mut mean: Vec<Local> = Vec::new();
    let mut consider = |locals: Vec<Local>, time_secs: Option<f32>| {
        let pose = WorldPose::new(skeleton, locals, DQuat::IDENTITY);
        let Some(stance) = Stance::of(&pose, slots) else { return };
        let to_beat = best.as_ref().map_or(rest, |best| best.stance).score();
        if stance.score() > to_beat + MIN_GAIN {
            best = Some(Standing { locals: pose.locals, stance, time_secs });
        }
    };
    for time_secs in sample_times(clip) {
        let locals = clip_locals(skeleton, clip, time_secs, &mut scratch);
        add_rotations(&mut mean, &locals);
        consider(locals, Some(time_secs));
    }
    mean.iter_mut().for_each(|local| local.rotation = unit(local.rotation));
    consider(mean, None);
    best
}

fn sample_times(clip: &Clip) -> impl Iterator<Item = f32> {
    let (first_secs, last_secs) = (clip.first_key_secs(), clip.duration_secs());
    (0..=REST_SAMPLES).map(move |sample| first_secs + (last_secs - first_secs) * sample as f32 / REST_SAMPLES as f32)
}

/// Whether a clip passes through a pose, as far as it rotates joints.
pub fn is_moment_of(skeleton: &Skeleton, clip: &Clip, pose: &[Local]) -> bool {
    let turning = clip.channels().iter().filter(|channel| matches!(channel.keys, Keys::Rotation(_)));
    let moved: Vec<usize> = turning.map(|channel| channel.joint.get()).collect();
    let mut scratch = Scratch::default();
    sample_times(clip).any(|time_secs| {
        let locals = clip_locals(skeleton, clip, time_secs, &mut scratch);
        let turn = |&joint: &usize| angle_between(locals[joint].rotation, pose[joint].rotation).to_degrees();
        moved.iter().map(turn).sum::<f64>() < SAME_POSE_DEGREES * moved.len() as f64
    })
}

/// Turns a pose of a clip about its up axis to face where the file's bodies do: along +Z, or the nearest axis to where the body of
/// the file's own rest faces, if that is one that stands as the pose does. A moment of the clip faces anywhere.
pub fn face_as_file(skeleton: &Skeleton, slots: &Humanoid, rest: &[Local], locals: &mut [Local]) {
    let world_pose = |locals: &[Local]| WorldPose::new(skeleton, locals.to_vec(), DQuat::IDENTITY);
    let (rest, pose) = (world_pose(rest), world_pose(locals));
    let (Some(found), Some(hips)) = (front(&pose, slots), slots.joint(Slot::Hips)) else { return };
    let of_rest = front(&rest, slots).filter(|front| front.upright == found.upright);
    let of_rest = of_rest.filter(|_| uprightness(&rest, slots).is_some_and(|straight| straight > MIN_BODY_UPRIGHTNESS));
    let wanted = of_rest.map_or(0.0, |front| nearest_quarter(front.yaw_degrees));
    let turn = DQuat::from_rotation_y((wanted - found.yaw_degrees).to_radians());
    let turn = unit(found.upright.conjugate() * turn * found.upright);
    let hips = pose.position(hips);
    for joint in skeleton.joints().filter(|&joint| skeleton.parent(joint).is_none()) {
        let local = &mut locals[joint.get()];
        local.rotation = unit(turn * local.rotation);
        local.translation = hips + turn * (local.translation - hips);
    }
}

/// Adds rotations up. A quaternion and its negative are the same rotation.
fn add_rotations(sum: &mut Vec<Local>, locals: &[Local]) {
    if sum.is_empty() {
        *sum = locals.to_vec();
        return;
    }
    for (sum, local) in sum.iter_mut().zip(locals) {
        let side = if sum.rotation.dot(local.rotation) < 0.0 { -1.0 } else { 1.0 };
        sum.rotation += local.rotation * side;
    }
}

fn uprightness(pose: &WorldPose, slots: &Humanoid) -> Option<f64> {
    let at = |slot| slots.joint(slot).map(|joint| pose.position(joint));
    let up = (at(Slot::Head)? - at(Slot::Hips)?).try_normalize()?;
    let leg = |upper, lower, foot| {
        let (upper, lower, foot): (DVec3, DVec3, DVec3) = (at(upper)?, at(lower)?, at(foot)?);
        Some([(upper - lower).try_normalize()?.dot(up), (lower - foot).try_normalize()?.dot(up)])
    };
    let left = leg(Slot::LeftUpperLeg, Slot::LeftLowerLeg, Slot::LeftFoot)?;
    let right = leg(Slot::RightUpperLeg, Slot::RightLowerLeg, Slot::RightFoot)?;
    Some((left[0] + left[1] + right[0] + right[1]) / 4.0)
}

fn asymmetry_degrees(pose: &WorldPose, slots: &Humanoid) -> Option<f64> {
    let between = |from, to| Some(pose.position(slots.joint(to)?) - pose.position(slots.joint(from)?));
    let sides = [(Slot::RightUpperLeg, Slot::LeftUpperLeg), (Slot::RightUpperArm, Slot::LeftUpperArm)];
    let sides = sides.map(|(right, left)| Some(between(right, left)?.normalize_or_zero()));
    let left = sides.iter().flatten().sum::<DVec3>().try_normalize()?;
    let mirrored = |direction: DVec3| direction - 2.0 * left * left.dot(direction);
    let mut angles: Vec<f64> = SEGMENTS
        .iter()
        .filter_map(|&(from, to)| {
            let (left, right) = (between(from, to)?, between(from.mirrored(), to.mirrored())?);
            Some(degrees_between(left, mirrored(right)))
        })
        .collect();
    if let [Some(hips), Some(shoulders)] = sides {
        angles.push(degrees_between(hips, shoulders));
    }
    Some(angles.iter().sum::<f64>() / angles.len() as f64)
}
