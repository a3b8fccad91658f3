//! Leans the trunk where arms are too short for what the source's hands touch below the waist: how far the chest turns, smooth over
//! time, by a least-squares fit in closed form. Arms go along without turning, and so does the head; hips and legs stay.

use gaitway_character::anim::{Clip, JointIndex};
use gaitway_character::asset::Slot;
use glam::{DMat3, DQuat, DVec3};

use super::limb::ARMS;
use super::scene::Scene;
use super::smooth::eased;
use super::wish::Wish;
use super::{MAX_MOVE, MAX_TURN_DEGREES_PER_SEC, MIN_MOVE};
use crate::keys::channel::NewChannel;
use crate::limit::limit_turns;
use crate::math::{slerp, unit};
use crate::pose::{WorldPose, is_within};
use crate::two_bones::max_reach;

/// How far the chest turns at most.
const MAX_LEAN_DEGREES: f64 = 15.0;

/// Weight of a turn by one radian against a shoulder that is off by the body's height: it decides where shoulders don't, such as about
/// the line through both.
const TURN_WEIGHT: f64 = 0.01;

/// The target's spine and what it carries.
struct Trunk {
    /// From below. They share each turn equally.
    spine: Vec<JointIndex>,
    /// Upper arms and neck, which keep their directions.
    ends: Vec<JointIndex>,
    /// Whether each part of the body goes along.
    carries: Vec<bool>,
}

impl Trunk {
    /// Returns `None` without a mapped spine that carries arms and head.
    fn mapped(scene: &Scene) -> Option<Self> {
        let skeleton = scene.transfer.target_skeleton;
        let joint = |slot: Slot| scene.transfer.pair(slot).map(|pair| pair.target);
        let spine: Vec<JointIndex> =
            [Slot::Spine, Slot::Chest, Slot::UpperChest].into_iter().filter_map(joint).collect();
        let shoulders = scene.bodies.arms.iter().flatten().map(|[shoulder, ..]| *shoulder);
        let ends: Vec<JointIndex> = shoulders.chain(joint(Slot::Neck).or_else(|| joint(Slot::Head))).collect();
        let top = *spine.last()?;
        let is_chain = spine.windows(2).all(|pair| is_within(skeleton, pair[1], pair[0]));
        let carries = scene.bodies.target.joints.iter().map(|&joint| is_within(skeleton, joint, spine[0])).collect();
        (is_chain && ends.iter().all(|&end| is_within(skeleton, end, top))).then_some(Self { spine, ends, carries })
    }

    /// The point about which what is above the spine turns, to first order: each of its joints turns by an equal part.
    fn pivot(&self, pose: &WorldPose) -> DVec3 {
        self.spine.iter().map(|&joint| pose.position(joint)).sum::<DVec3>() / self.spine.len() as f64
    }

    /// Local rotations for turns of the chest in the common frame.
    fn rotations(&self, scene: &Scene, turns: &[DQuat]) -> Vec<(JointIndex, Vec<DQuat>)> {
        let skeleton = scene.transfer.target_skeleton;
        let count = self.spine.len();
        let part = |turn: DQuat, joints: usize| slerp(DQuat::IDENTITY, turn, joints as f64 / count as f64);
        // With the numbers of the spine's joints that turn the parent and the joint itself.
        let spine = self.spine.iter().enumerate().map(|(below, &joint)| (joint, below, below + 1));
        let ends = self.ends.iter().map(|&joint| (joint, count, 0));
        let rotations = |(joint, below, own): (JointIndex, usize, usize)| {
            let rotation = |(pose, &turn): (&WorldPose, &DQuat)| {
                let parent = part(turn, below) * pose.parent_rotation(skeleton, joint);
                unit(parent.conjugate() * part(turn, own) * pose.rotation(joint))
            };
            (joint, scene.poses.iter().zip(turns).map(rotation).collect())
        };
        spine.chain(ends).map(rotations).collect()
    }
}

/// Returns all channels of the clip with its trunk leaning, or `None` if arms reach everything. `resampled` lists the joints whose keys
/// in `clip` are not the source's own.
pub fn leaning_trunk(scene: &Scene, clip: &Clip, resampled: &[JointIndex]) -> Option<Vec<NewChannel>> {
    let trunk = Trunk::mapped(scene)?;
    let wanted: Vec<(DVec3, f64)> = (0..scene.poses.len()).map(|at| wanted_lean(scene, &trunk, at)).collect();
    if wanted.iter().all(|(_, share)| *share == 0.0) {
        return None;
    }
    let times = &scene.source.times;
    let leans = eased(times, &wanted);
    let mut turns: Vec<DQuat> = leans.into_iter().map(DQuat::from_scaled_axis).collect();
    let [max_turn, max_rate] = [MAX_LEAN_DEGREES, MAX_TURN_DEGREES_PER_SEC].map(f64::to_radians);
    limit_turns(times, &mut turns, max_turn, max_rate);
    let rotations = trunk.rotations(scene, &turns);
    Some(NewChannel::corrected(clip, resampled, times, None, rotations))
}

/// How the chest would turn for the shoulders to be where arms reach from, as a scaled axis, and how much that is wanted.
fn wanted_lean(scene: &Scene, trunk: &Trunk, at: usize) -> (DVec3, f64) {
    let (pose, height) = (&scene.poses[at], scene.bodies.target.height);
    let pivot = trunk.pivot(pose);
    let mut matrix = DMat3::from_diagonal(DVec3::splat(TURN_WEIGHT * height * height));
    let (mut right, mut wanted) = (DVec3::ZERO, 0.0_f64);
    for (joints, wish) in scene.bodies.arms.iter().zip(wishes(scene, trunk, at)) {
        let (by, share) = wish.fit();
        let Some(joints) = joints.filter(|_| share > 0.0) else { continue };
        let [shoulder, elbow, wrist] = joints.map(|joint| pose.position(joint));
        let goal = wrist + by.clamp_length_max(MAX_MOVE * height) - shoulder;
        let reached = goal.clamp_length_max(max_reach([elbow - shoulder, wrist - elbow]));
        let lacking = wrist + by - shoulder - reached;
        // A turn moves the shoulder by turn × away.
        let away = shoulder - pivot;
        let outer = DMat3::from_cols(away.x * away, away.y * away, away.z * away);
        matrix += share * (DMat3::from_diagonal(DVec3::splat(away.length_squared())) - outer);
        right += share * away.cross(lacking);
        if lacking.length() > MIN_MOVE * height {
            wanted = wanted.max(share);
        }
    }
    // Limited before it is smoothed: the other way round, a lean at its limit would begin and end with a kink.
    ((matrix.inverse() * right).clamp_length_max(MAX_LEAN_DEGREES.to_radians()), wanted)
}

/// What the source touches with each arm that the trunk doesn't carry: legs, hips and the ground.
fn wishes(scene: &Scene, trunk: &Trunk, at: usize) -> [Wish; ARMS] {
    let Scene { bodies, source, .. } = scene;
    let frames = &scene.target.frames[at];
    let mut wishes = [Wish::default(); ARMS];
    for miss in bodies.misses(&source.touches[at], frames, source.target_from_source(at)) {
        let pair = &bodies.pairs[miss.pair];
        if let Some(arm) = bodies.regions[pair.limb].arm().filter(|_| !trunk.carries[pair.other]) {
            wishes[arm].add(miss.by, 1.0, miss.weight, miss.weight);
        }
    }
    for (part, up) in scene.ground.iter().flat_map(|ground| ground.misses(bodies, at, frames)) {
        if let Some(arm) = bodies.regions[part].arm() {
            wishes[arm].add(up * DVec3::Y, 1.0, 1.0, 1.0);
        }
    }
    wishes
}
