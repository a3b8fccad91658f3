//! The quality of a retargeted clip in numbers: measured on the finished clip as the player plays it, at the source's keys
//! and halfway between them, in the common frame.

use gaitway_character::anim::{Clip, JointIndex};
use gaitway_character::asset::{Humanoid, Slot};
use glam::DQuat;
use serde::Serialize;

use super::foot_track::{FootPositions, FootTrack, foot_tracks, mapped_feet};
use super::moments::moments;
use super::played::PlayedClip;
use super::smoothness::smoothness;
use crate::align::swing::compared_segments;
use crate::budget::{MAX_TOUCH_STEPS, measured_steps};
use crate::contacts::{Bodies, BodyMotion, SourceScene, TouchFigures};
use crate::feet::Soles;
use crate::keys::resample::union;
use crate::map::{Contacts, Feet, Pair, ResolvedMap};
use crate::math::{angle_between, degrees_between};
use crate::pose::{PartialPose, WorldPose};
use crate::times::corrected_times;
use crate::transfer::{Transfer, lowest_leg_joint, removed_travel};

/// Quality figures; `None` for what cannot be measured.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Figures {
    /// Angle between the direction of a limb (or the torso) and its source's: the visible error. Measured from positions
    /// alone, so a wrong rest shows in it, unless it turns a limb about itself.
    pub limb_direction_error_degrees_mean: Option<f64>,
    /// The largest of these angles, over all segments and measured times.
    pub limb_direction_error_degrees_max: Option<f64>,
    /// The same for what the limbs do not show: the lines through both hips and both shoulders, and the directions of feet
    /// and hands. Differences in build, such as the height of the heels, are included.
    pub facing_error_degrees_mean: Option<f64>,
    /// The largest of these angles.
    pub facing_error_degrees_max: Option<f64>,
    /// Difference between a mapped joint's rotation away from its aligned rest and its source's: how well the rotation
    /// law holds. Assumes that the rests are right. Measured without planted feet.
    pub orientation_error_degrees_mean: Option<f64>,
    /// The largest of these angles, over all mapped joints and measured times.
    pub orientation_error_degrees_max: Option<f64>,
    /// Mean horizontal speed of the toes (or ankles) while the source's are in contact, with removed travel added back.
    pub foot_slide_metres_per_sec: Option<f64>,
    /// The source's own speed during the same contacts, scaled to the target.
    pub foot_slide_source_metres_per_sec: Option<f64>,
    /// Maximum depth of a toe or ankle below the lowest leg joint of the aligned rest.
    pub ground_penetration_metres_max: Option<f64>,
    /// Mean height of the sole's lowest point above the ground while the source's foot is in contact; negative below it. The
    /// ground is where the lowest point of either sole rests: of the mesh of the feet or, without one, of their joints.
    pub foot_hover_metres_mean: Option<f64>,
    /// How deep the lowest point of either sole goes below the same ground, at any measured time.
    pub sole_penetration_metres_max: Option<f64>,
    /// The largest angle by which a mapped joint turns in model space within 1/60 s of the finished clip: a joint that snaps.
    pub largest_turn_degrees_per_frame: Option<f64>,
    /// Mean length of the third derivative of the mapped joints' positions in model space, at 60 frames per second of the finished
    /// clip: high where joints jitter.
    pub jerk_metres_per_sec3_mean: Option<f64>,
    /// Share of the points on forearms, hands, shins and feet that are inside other parts of the body, deeper than at rest. Body
    /// parts are solids fitted to the mesh; `None` without one.
    pub self_penetration_share: Option<f64>,
    /// Mean distance of the contacts that the source's hands have with its body, and hands and knees with the ground, from where
    /// the target has them.
    pub contact_error_metres_mean: Option<f64>,
    /// Mean angle between which way the body faces along its path and how its source does, by where feet point, or knees where a
    /// body has no feet; without regard to names and slots.
    pub facing_path_error_degrees_mean: Option<f64>,
    /// By how much the lengths of the skin's edges differ from those of the mesh as it was bound: the ratio for the edges around
    /// one joint, where and when it is largest. 1 if none changes. Measured where ends move differently.
    pub skin_stretch_max: Option<f64>,
    /// The same on average, over all such edges and the whole clip.
    pub skin_stretch_mean: Option<f64>,
    /// The joint of `skin_stretch_max`.
    pub skin_stretch_max_joint: Option<String>,
    /// Like `skin_stretch_max`, but only the part that is due to joints away from where they rest on their parents: 1 if the body is
    /// in one piece. `None` where translations are the motion's, on the same skeleton or between creatures.
    pub skin_tear_max: Option<f64>,
    /// The joint of `skin_tear_max`.
    pub skin_tear_max_joint: Option<String>,
    /// Limbs and other chains of joints that stay still although their counterparts in the motion move: parts of the body, or names
    /// of joints they begin with. Chains are found by hierarchy and place.
    pub idle_chains: Vec<String>,
    /// Share of a chain's length that follows the motion, on average over the chains of joints that both bodies have.
    pub coverage: Option<f64>,
    /// The map asks for planted feet or contacts, but the clip has too many keys for the poses at all of them to be held.
    #[serde(skip)]
    pub is_too_long: bool,
}

/// Lines whose directions show how hips, chest, feet and hands are turned.
const FACING: [(Slot, Slot); 6] = [
    (Slot::RightUpperLeg, Slot::LeftUpperLeg),
    (Slot::RightUpperArm, Slot::LeftUpperArm),
    (Slot::LeftFoot, Slot::LeftToes),
    (Slot::RightFoot, Slot::RightToes),
    (Slot::LeftHand, Slot::LeftMiddleProximal),
    (Slot::RightHand, Slot::RightMiddleProximal),
];

/// Joints that shouldn't be below the ground.
const ON_GROUND: [Slot; 4] = [Slot::LeftFoot, Slot::LeftToes, Slot::RightFoot, Slot::RightToes];

/// Contacts of the body are looked for a bit more than 30 times per second.
const TOUCH_STEP_SECS: f32 = 0.03;

/// A clip of the target to measure.
#[derive(Debug, Clone, Copy)]
pub struct MeasuredClip<'a> {
    pub clip: &'a Clip,
    /// The same without planted feet and kept contacts, if they are.
    pub unplanted: Option<&'a Clip>,
}

/// Mean and maximum of the values added so far.
#[derive(Debug, Default)]
struct Spread {
    sum: f64,
    count: usize,
    max: f64,
}

impl Spread {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
        self.max = self.max.max(value);
    }

    fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }

    fn max(&self) -> Option<f64> {
        (self.count > 0).then_some(self.max)
    }
}

/// Measures a clip and tracks its feet over time.
pub fn measure(
    transfer: &Transfer,
    bodies: Option<&Bodies>,
    slots: [&Humanoid; 2],
    measured: MeasuredClip,
) -> (Figures, Vec<FootTrack>) {
    let times = measured_times(transfer.tracks.clip);
    let removed = removed_travel(transfer, &times);
    let segments = mapped_segments(transfer, compared_segments());
    let facing_segments = mapped_segments(transfer, FACING.into_iter());
    let ground_joints: Vec<JointIndex> = ON_GROUND.into_iter().filter_map(|slot| slots[1].joint(slot)).collect();
    let ground = lowest_leg_joint(slots[1], &transfer.alignment.target.positions);

    let [mut orientation, mut direction, mut facing] = [(); 3].map(|()| Spread::default());
    let mut penetration: Option<f64> = None;
    let soles = Soles::new(transfer);
    let mut feet = mapped_feet(transfer, soles.feet.clone());
    let mut source_pose = mapped_source(transfer);
    let targets = measured_joints(transfer, &feet, &ground_joints);
    let [mut target_clip, mut unplanted_clip] = [(); 2].map(|()| PlayedClip::new(transfer, &targets));
    let touches = touches(transfer, bodies, measured.clip);
    for (index, &time) in times.iter().enumerate() {
        let source = source_pose.update(transfer.tracks.locals_at(time));
        let target = target_clip.pose(measured.clip, time);
        let unplanted = measured.unplanted.map_or(target, |clip| unplanted_clip.pose(clip, time));
        // Undoes the turning that the root options removed.
        let turn_back = removed.turn(time).conjugate();
        add_orientation_errors(&mut orientation, transfer, source, unplanted, turn_back);
        add_direction_errors(&mut direction, &segments, source, target, turn_back);
        add_direction_errors(&mut facing, &facing_segments, source, target, turn_back);
        penetration = deepest(penetration, ground, &ground_joints, target);
        for foot in &mut feet {
            foot.source.push(source.position(foot.source_joint));
            foot.target.push(removed.restored(transfer, target, foot.target_joint, index, turn_back));
            foot.heights.push(foot.sole.lowest(target) - soles.ground);
        }
    }
    let sole_penetration = feet.iter().flat_map(|foot| &foot.heights).map(|height| (-height).max(0.0)).reduce(f64::max);
    let smoothness = smoothness(transfer.target_skeleton, &transfer.map.pairs, measured.clip);
    let (contacts, tracks) = foot_tracks(transfer, &times, feet);
    let moments = moments(transfer, slots, measured.clip, soles);
    let figures = Figures {
        limb_direction_error_degrees_mean: direction.mean(),
        limb_direction_error_degrees_max: direction.max(),
        facing_error_degrees_mean: facing.mean(),
        facing_error_degrees_max: facing.max(),
        orientation_error_degrees_mean: orientation.mean(),
        orientation_error_degrees_max: orientation.max(),
        foot_slide_metres_per_sec: contacts.slide,
        foot_slide_source_metres_per_sec: contacts.source_slide,
        ground_penetration_metres_max: penetration,
        foot_hover_metres_mean: contacts.hover,
        sole_penetration_metres_max: sole_penetration,
        largest_turn_degrees_per_frame: smoothness.largest_turn_degrees,
        jerk_metres_per_sec3_mean: smoothness.jerk_mean,
        self_penetration_share: touches.self_penetration_share(),
        contact_error_metres_mean: touches.contact_error(),
        facing_path_error_degrees_mean: moments.facing_path_error_degrees,
        skin_stretch_max: moments.worst_stretch.map(|(stretch, _)| stretch),
        skin_stretch_mean: moments.mean_stretch,
        skin_stretch_max_joint: moments.worst_stretch.map(|(_, joint)| transfer.target_skeleton.label(joint)),
        skin_tear_max: moments.worst_tear.map(|(tear, _)| tear),
        skin_tear_max_joint: moments.worst_tear.map(|(_, joint)| transfer.target_skeleton.label(joint)),
        idle_chains: moments.idle_chains,
        coverage: moments.coverage,
        is_too_long: is_too_long(transfer),
    };
    (figures, tracks)
}

/// Whether the map asks for planting or contacts, and the clip is too long for them.
fn is_too_long(transfer: &Transfer) -> bool {
    let times = || corrected_times(transfer.tracks.clip, transfer.target_skeleton.len());
    wants_corrections(transfer.map) && times().is_none()
}

/// Returns how deep any of the joints has been below the ground, in this pose or in those before.
fn deepest(before: Option<f64>, ground: Option<f64>, joints: &[JointIndex], pose: &WorldPose) -> Option<f64> {
    let depths = |ground: f64| joints.iter().map(move |&joint| ground - pose.position(joint).y);
    let depths = ground.into_iter().flat_map(depths);
    depths.fold(before, |max, depth| Some(max.unwrap_or(0.0).max(depth)))
}

/// The joints of the target whose positions are measured.
fn measured_joints(transfer: &Transfer, feet: &[FootPositions], ground_joints: &[JointIndex]) -> Vec<JointIndex> {
    // The feet themselves are mapped; joints of their soles may not be.
    let of_soles = feet.iter().flat_map(|foot| foot.sole.joints());
    let mapped = transfer.map.pairs.iter().flat_map(|pair| [pair.target, transfer.turned(pair)]);
    mapped.chain(ground_joints.iter().copied()).chain(of_soles).collect()
}

/// Returns the segments whose ends are both mapped.
fn mapped_segments<'a>(
    transfer: &Transfer<'a>,
    segments: impl Iterator<Item = (Slot, Slot)>,
) -> Vec<(&'a Pair, &'a Pair)> {
    segments.filter_map(|(from, to)| Some((transfer.pair(from)?, transfer.pair(to)?))).collect()
}

/// The mapped joints of the source, in the common frame.
fn mapped_source<'a>(transfer: &Transfer<'a>) -> PartialPose<'a> {
    let pairs = transfer.map.pairs.iter();
    let joints = pairs.flat_map(|pair| std::iter::once(pair.source).chain(transfer.turn(pair).joints()));
    PartialPose::new(transfer.tracks.skeleton, transfer.alignment.source.world_from_model, joints)
}

/// The source's keys, and halfway between them.
fn measured_times(clip: &Clip) -> Vec<f32> {
    let keys = union(clip.timelines().iter().map(Vec::as_slice));
    let mut times: Vec<f32> = Vec::with_capacity(2 * keys.len());
    for &key in &keys {
        if let Some(&before) = times.last() {
            let middle = before + 0.5 * (key - before);
            if middle > before && middle < key {
                times.push(middle);
            }
        }
        times.push(key);
    }
    times
}

fn add_orientation_errors(
    errors: &mut Spread,
    transfer: &Transfer,
    source: &WorldPose,
    target: &WorldPose,
    turn_back: DQuat,
) {
    let from_rest =
        |pose: &WorldPose, rest: &WorldPose, joint: JointIndex| pose.rotation(joint) * rest.rotation(joint).conjugate();
    for pair in &transfer.map.pairs {
        let target = turn_back * from_rest(target, &transfer.alignment.target, transfer.turned(pair));
        let source = transfer.turn(pair).at(|joint| from_rest(source, &transfer.alignment.source, joint));
        errors.add(angle_between(target, source).to_degrees());
    }
}

fn add_direction_errors(
    errors: &mut Spread,
    segments: &[(&Pair, &Pair)],
    source: &WorldPose,
    target: &WorldPose,
    turn_back: DQuat,
) {
    for (from, to) in segments {
        let source = source.position(to.source) - source.position(from.source);
        let target = turn_back * (target.position(to.target) - target.position(from.target));
        if source.length() > 0.0 && target.length() > 0.0 {
            errors.add(degrees_between(source, target));
        }
    }
}

fn wants_corrections(map: &ResolvedMap) -> bool {
    map.feet == Feet::Plant || map.contacts == Contacts::Keep
}

/// Measures contacts of the body on the clip, at even steps; nothing if the target has no mesh.
fn touches(transfer: &Transfer, bodies: Option<&Bodies>, clip: &Clip) -> TouchFigures {
    let mut figures = TouchFigures::default();
    let Some(bodies) = bodies.filter(|bodies| bodies.target.has_mesh) else { return figures };
    let steps = measured_steps(clip.duration_secs() / TOUCH_STEP_SECS, transfer.target_skeleton.len());
    let steps = steps.min(MAX_TOUCH_STEPS);
    let times: Vec<f32> = (0..=steps).map(|step| step as f32 * TOUCH_STEP_SECS).collect();
    let source = SourceScene::new(transfer, bodies, times);
    let mut played = PlayedClip::new(transfer, &bodies.target.moving_joints().collect::<Vec<_>>());
    let mut target = BodyMotion::default();
    source.times.iter().for_each(|&time| target.push(&bodies.target, played.pose(clip, time)));
    let ground = source.ground(transfer, bodies, &target);
    for (at, frames) in target.frames.iter().enumerate() {
        let on_ground = ground.iter().flat_map(|ground| ground.misses(bodies, at, frames)).map(|(_, by)| by);
        figures.add(bodies, &source.touches[at], on_ground, frames, source.target_from_source(at));
    }
    figures
}
