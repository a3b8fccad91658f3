//! Moves knees to the ground where the source's rest there: how far the hips and the legs go up or down, smooth over time, and the
//! turns of thigh and shin that follow in closed form. Arms and trunk go along with the hips.

use gaitway_character::anim::{Clip, JointIndex};
use glam::{DQuat, DVec3};

use super::scene::Scene;
use super::smooth::eased;
use super::{MAX_MOVE, MAX_TURN_DEGREES, MAX_TURN_DEGREES_PER_SEC, MIN_MOVE};
use crate::feet::{Leg, solve_leg};
use crate::keys::channel::NewChannel;
use crate::limit::limit_turns;
use crate::map::Feet;
use crate::math::{HORIZONTAL, limited, slerp, smooth};
use crate::pose::{WorldPose, moved};
use crate::two_bones::limb_rotations;

/// A foot of the source that is higher above the ground than this share of the body's height doesn't rest on it.
const LOW: f64 = 0.04;

/// How much higher a knee that rests on the ground should be, and the ankle behind it.
#[derive(Clone, Copy)]
struct Wish {
    knee: f64,
    ankle: f64,
}

/// Returns all channels of the clip with its knees on the ground, or `None` if none rest there. `resampled` lists the joints whose
/// keys in `clip` are not the source's own.
pub fn grounded_knees(scene: &Scene, clip: &Clip, resampled: &[JointIndex]) -> Option<Vec<NewChannel>> {
    let Scene { transfer, poses, .. } = scene;
    let times = &scene.source.times;
    let legs: Vec<(Leg, Vec<Option<Wish>>)> = (0..2).filter_map(|side| wishes(scene, side)).collect();
    if legs.iter().all(|(_, wishes)| wishes.iter().all(Option::is_none)) {
        return None;
    }
    let [limit, least] = [MAX_MOVE, MIN_MOVE].map(|share| share * scene.bodies.target.height);
    let carrier = transfer.hips_carrier();
    let hips = (0..times.len()).map(|at| match carrier.and_then(|_| hips_wish(&legs, &poses[at], at)) {
        Some(by) => (limited(by, -limit, limit) * DVec3::Y, 1.0),
        None => (DVec3::ZERO, 0.0),
    });
    let hips = eased(times, &hips.collect::<Vec<_>>());
    let hips: Vec<DVec3> = hips.into_iter().map(|by| if by.length() > least { by } else { DVec3::ZERO }).collect();
    let mut rotations = Vec::new();
    for (leg, wishes) in &legs {
        // The share of the leg that kneels, and the moves of knee and ankle, come and go alike.
        let wanted = wishes.iter().map(|wish| match wish {
            Some(Wish { knee, ankle }) => {
                (DVec3::new(1.0, limited(*knee, -limit, limit), limited(*ankle, -limit, limit)), 1.0)
            }
            None => (DVec3::ZERO, 0.0),
        });
        let moves = eased(times, &wanted.collect::<Vec<_>>());
        let turns = poses.iter().zip(moves).zip(&hips).map(|((pose, by), hips)| {
            let is_moved = by.y.abs().max(by.z.abs()) > least || *hips != DVec3::ZERO;
            if is_moved { leg_turns(leg, pose, by, hips.y) } else { [DQuat::IDENTITY; 2] }
        });
        let turns: Vec<[DQuat; 2]> = turns.collect();
        if turns.iter().all(|turns| *turns == [DQuat::IDENTITY; 2]) {
            continue;
        }
        let mut turns = [0, 1].map(|bone| turns.iter().map(|turns| turns[bone]).collect::<Vec<_>>());
        for turns in &mut turns {
            limit_turns(times, turns, MAX_TURN_DEGREES.to_radians(), MAX_TURN_DEGREES_PER_SEC.to_radians());
        }
        let turns = turns.each_ref().map(Vec::as_slice);
        rotations.extend(limb_rotations(transfer.target_skeleton, [leg.hip, leg.knee, leg.ankle], poses, turns));
    }
    let carrier = carrier.filter(|_| hips.iter().any(|&by| by != DVec3::ZERO));
    let translation = carrier.map(|joint| (joint, moved(transfer.target_skeleton, joint, poses, &hips)));
    let is_changed = translation.is_some() || !rotations.is_empty();
    is_changed.then(|| NewChannel::corrected(clip, resampled, times, translation, rotations))
}

/// One leg, and what its knee and ankle should do at each time. `None` if the leg isn't mapped.
fn wishes(scene: &Scene, side: usize) -> Option<(Leg, Vec<Option<Wish>>)> {
    let Scene { bodies, source, target, .. } = scene;
    let ground = scene.ground.as_ref()?;
    let (leg, _) = Leg::mapped(scene.transfer)[side]?;
    let shin = bodies.target.joints.iter().position(|&joint| joint == leg.knee)?;
    let sole = bodies.target.soles.index(side);
    let (source, soles) = (source.motion.soles.get(sole)?, target.soles.get(sole)?);
    let low = LOW * bodies.target.height;
    let plants = scene.transfer.map.feet == Feet::Plant;
    let wish = |at: usize| {
        let (_, knee) = ground.misses(bodies, at, &target.frames[at]).find(|(part, _)| *part == shin)?;
        let is_planted = plants && ground.feet[sole][at];
        Some(Wish { knee, ankle: ground.sole_miss([source[at], soles[at]], is_planted, low, knee) })
    };
    Some((leg, (0..soles.len()).map(wish).collect()))
}

/// How far the hips should go up: knees below them only get there with them, others by turning the thigh.
fn hips_wish(legs: &[(Leg, Vec<Option<Wish>>)], pose: &WorldPose, at: usize) -> Option<f64> {
    let (mut sum, mut shares) = (0.0, 0.0);
    for (leg, wishes) in legs {
        let Some(Wish { knee: up, ankle: ankle_up }) = wishes[at] else { continue };
        let [hip, knee, ankle] = [leg.hip, leg.knee, leg.ankle].map(|joint| pose.position(joint));
        let (thigh, shin) = (knee - hip, ankle - knee);
        // The shin tilts about the ankle, which shifts the knee to the side: then the thigh is less or more upright.
        let tilted = tilt(shin, leg.hinge(pose, [thigh, shin]), ankle_up - up) * shin;
        let sideways = ((thigh + shin - tilted) * HORIZONTAL).length_squared();
        let by = up + thigh.y + (thigh.length_squared() - sideways).max(0.0).sqrt();
        let share = smooth(2.0 * thigh.normalize_or_zero().y.powi(2));
        sum += share * share * by;
        shares += share;
    }
    (shares > 0.0).then(|| sum / shares)
}

/// Turns of a leg whose hip goes up by `hips`: so that its foot stays and, as far as its knee rests on the ground (`by.x`, from 0 to
/// 1), so that its knee goes up by `by.y` and its ankle by `by.z`.
fn leg_turns(leg: &Leg, pose: &WorldPose, by: DVec3, hips: f64) -> [DQuat; 2] {
    let standing = solve_leg(leg, pose, by.z * DVec3::Y, -hips);
    let [hip, knee, ankle] = [leg.hip, leg.knee, leg.ankle].map(|joint| pose.position(joint));
    let bones = [knee - hip, ankle - knee];
    let hinge = leg.hinge(pose, bones);
    let thigh = tilt(bones[0], hinge, by.y - hips);
    let knee = hips + (thigh * bones[0] - bones[0]).y;
    let shin = tilt(bones[1], hinge, by.z - knee);
    [slerp(standing.thigh, thigh, by.x), slerp(standing.shin, shin, by.x)]
}

/// The smallest turn of a bone about an axis that brings its end up by a height, or as near as it gets.
fn tilt(bone: DVec3, axis: DVec3, up: f64) -> DQuat {
    // The end's height is along + radius · cos(angle − top).
    let along = axis.y * bone.dot(axis);
    let (ahead, across) = (bone.y - along, axis.cross(bone).y);
    let radius = ahead.hypot(across);
    if radius <= 0.0 {
        return DQuat::IDENTITY;
    }
    let top = across.atan2(ahead);
    let away = ((bone.y + up - along) / radius).clamp(-1.0, 1.0).acos();
    // From the top, the bone is on the side to which it need not pass it.
    DQuat::from_axis_angle(axis, top - away.copysign(top))
}
