//! Judges whether a body could rest in a pose: upright and symmetric.

use gaitway_character::anim::{Clip, Skeleton};
use gaitway_character::asset::{Humanoid, Slot};
use glam::{DQuat, DVec3};

use crate::math::{degrees_between, unit};
use crate::pose::{Local, Scratch, WorldPose, clip_locals};

/// Number of times at which the clip is compared.
const REST_SAMPLES: usize = 64;

/// Minimum gain in score for a pose of the clip to replace the rest, or a later one an earlier one.
const MIN_GAIN: f64 = 0.01;

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
    let (first_secs, last_secs) = (clip.first_key_secs(), clip.duration_secs());
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
    for sample in 0..=REST_SAMPLES {
        let time_secs = first_secs + (last_secs - first_secs) * sample as f32 / REST_SAMPLES as f32;
        let locals = clip_locals(skeleton, clip, time_secs, &mut scratch);
        add_rotations(&mut mean, &locals);
        consider(locals, Some(time_secs));
    }
    mean.iter_mut().for_each(|local| local.rotation = unit(local.rotation));
    consider(mean, None);
    best
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
