//! How the hips of both skeletons correspond: which pair they are, how their heights compare, where the ground is.

use gaitway_character::anim::{JointIndex, Skeleton};
use gaitway_character::asset::{Asset, Humanoid, Slot};
use gaitway_character::sort::sort_by;
use glam::DVec3;

use crate::align::Alignment;
use crate::keys::resample::union;
use crate::keys::tracks::SourceTracks;
use crate::map::{Pair, PathOrigin, ResolvedMap};
use crate::pose::{WorldPose, ancestry, is_within};
use crate::skin::moves_skin;

const LEGS: [Slot; 8] = [
    Slot::LeftUpperLeg,
    Slot::LeftLowerLeg,
    Slot::LeftFoot,
    Slot::LeftToes,
    Slot::RightUpperLeg,
    Slot::RightLowerLeg,
    Slot::RightFoot,
    Slot::RightToes,
];

/// Both legs from thigh to foot.
pub const LEG_CHAINS: [[Slot; 3]; 2] = [
    [Slot::LeftUpperLeg, Slot::LeftLowerLeg, Slot::LeftFoot],
    [Slot::RightUpperLeg, Slot::RightLowerLeg, Slot::RightFoot],
];

/// Moments of the clip at which the lowest foot is looked up.
const GROUND_SAMPLES: usize = 32;

/// The hips of both sides, in the common frame.
#[derive(Debug, Clone, Copy)]
pub struct Hips {
    /// Index into [`ResolvedMap::pairs`].
    pub pair: usize,
    /// The target joint whose translation takes the path: the topmost that moves skin or is part of the trunk, so that the body
    /// stays in one piece. Usually the hips themselves.
    pub carrier: JointIndex,
    /// Target units per source unit.
    pub scale: f64,
    /// Reference point of the source's path, in source units: the hips at rest; on the ground plane, with [`PathOrigin::Feet`],
    /// their offset from the midpoint of the feet.
    pub source_rest: DVec3,
    /// Where the target is when the source is at `source_rest`, in target units.
    pub target_rest: DVec3,
    /// Height of the target's hips above the ground at the aligned rest, in target units; the length of its legs if these hips are
    /// near the ground, of its torso without legs.
    pub height: f64,
}

impl Hips {
    /// Returns the same for a source without a meaningful rest: it stands where the target does, at its own size.
    pub fn resting_as_target(self) -> Self {
        Self { source_rest: self.target_rest / self.scale, ..self }
    }

    /// Maps a position of the source's hips to the target's, before any travel is removed.
    pub fn target_position(&self, source: DVec3) -> DVec3 {
        self.target_rest + self.scale * (source - self.source_rest)
    }

    /// The pair of the topmost mapped joint at or above the hips: turning it turns the whole figure.
    pub fn top_pair(&self, map: &ResolvedMap, target_skeleton: &Skeleton) -> usize {
        ancestry(target_skeleton, map.pairs[self.pair].target)
            .filter_map(|joint| map.pair_index(joint))
            .last()
            .unwrap_or(self.pair)
    }
}

/// Both sides of what [`match_hips`] compares.
#[derive(Clone, Copy)]
pub struct HipsInput<'a> {
    pub map: &'a ResolvedMap,
    pub alignment: &'a Alignment,
    pub tracks: &'a SourceTracks<'a>,
    /// The file of the target, for its skins.
    pub target: &'a Asset,
    pub source_slots: &'a Humanoid,
    pub target_slots: &'a Humanoid,
}

/// Returns None if no pair involves the hips. In a map without humanoid slots, the pair whose source travels and whose target
/// carries most others stands in for them.
pub fn match_hips(input: HipsInput) -> Option<Hips> {
    let HipsInput { map, alignment, tracks, target, source_slots, target_slots } = input;
    let pair = alignment.pair_of_slot.get(&Slot::Hips).copied().or_else(|| travelling_pair(input))?;
    let mut source_rest = alignment.source.position(map.pairs[pair].source);
    let mut target_rest = alignment.target.position(map.pairs[pair].target);
    // Compare the same joints on both sides: a rig without toes does not have shorter legs.
    let both = |slot: &Slot| Some((source_slots.joint(*slot)?, target_slots.joint(*slot)?));
    let legs: Vec<(JointIndex, JointIndex)> = LEGS.iter().filter_map(both).collect();
    let (source_ground, target_ground) = if legs.is_empty() {
        lowest_joints(alignment, map.pairs.iter().map(|pair| (pair.source, pair.target)))
    } else {
        lowest_joints(alignment, legs.iter().copied())
    };
    let (source_height, height) = (source_rest.y - source_ground, target_rest.y - target_ground);
    let of_both = |length: fn(&WorldPose, &Humanoid) -> Option<f64>| {
        Some((length(&alignment.source, source_slots)?, length(&alignment.target, target_slots)?))
    };
    // Hips may be a root on the ground, and a bust has no legs to stand on.
    let instead = match (of_both(leg_length), of_both(torso_length)) {
        (Some(legs), _) => {
            (source_height < MIN_HIPS_HEIGHT * legs.0 || height < MIN_HIPS_HEIGHT * legs.1).then_some(legs)
        }
        (None, torso) => torso.filter(|_| legs.is_empty()),
    };
    let (source_height, height) = instead.unwrap_or((source_height, height));
    let is_usable = source_height > 1e-9 && height > 1e-9 && (height / source_height).is_finite();
    let source_legs: Vec<JointIndex> = legs.into_iter().map(|(source, _)| source).collect();
    if rests_in_the_ground(input, pair, &source_legs, source_ground) {
        source_rest.y -= source_ground;
    }
    if map.root.origin == PathOrigin::Feet
        && let Some(source_feet) = between_feet(tracks.skeleton, source_slots, |joint| alignment.source.position(joint))
        && let Some(target_feet) =
            between_feet(&target.skeleton, target_slots, |joint| alignment.target.position(joint))
    {
        source_rest -= source_feet.with_y(0.0);
        target_rest -= target_feet.with_y(0.0);
    }
    Some(Hips {
        pair,
        carrier: carrier(input, map.pairs[pair].target),
        scale: if is_usable { height / source_height } else { 1.0 },
        source_rest,
        target_rest,
        height: height.max(1e-9),
    })
}

/// Hips that are less high than this share of a leg's length aren't at the top of the legs.
const MIN_HIPS_HEIGHT: f64 = 0.25;

/// Mean length of the legs, from hip to ankle. None without two whole ones.
fn leg_length(pose: &WorldPose, slots: &Humanoid) -> Option<f64> {
    let [left, right] = LEG_CHAINS.map(|leg| {
        let [hip, knee, ankle] = leg.map(|slot| slots.joint(slot).map(|joint| pose.position(joint)));
        Some(hip?.distance(knee?) + knee?.distance(ankle?))
    });
    Some(0.5 * (left? + right?))
}

/// Distance from the hips to the head.
fn torso_length(pose: &WorldPose, slots: &Humanoid) -> Option<f64> {
    let [hips, head] = [Slot::Hips, Slot::Head].map(|slot| slots.joint(slot).map(|joint| pose.position(joint)));
    Some(hips?.distance(head?))
}

/// The joint that takes the path of these hips.
fn carrier(input: HipsInput, hips: JointIndex) -> JointIndex {
    let HipsInput { map, alignment, target, .. } = input;
    let trunk = [Slot::Spine, Slot::Chest, Slot::UpperChest].into_iter().filter_map(|slot| alignment.pair(map, slot));
    let hangs_from = trunk.map(|pair| pair.target).filter(|joint| is_within(&target.skeleton, hips, *joint)).min();
    let in_skin = |joint: &JointIndex| target.skins.iter().any(|skin| skin.joints().contains(joint));
    // Extracted travel has a joint of its own above the hips.
    let may_carry = !map.root.extract && ancestry(&target.skeleton, hips).skip(1).any(|joint| in_skin(&joint));
    let moves = if may_carry { moves_skin(target) } else { None };
    let skinned = moves.and_then(|moves| ancestry(&target.skeleton, hips).filter(|joint| moves[joint.get()]).last());
    [Some(hips), hangs_from, skinned].into_iter().flatten().min().unwrap_or(hips)
}

/// The midpoint of the feet at the aligned rest. None unless each foot is a descendant of its upper leg: the others don't turn with
/// the legs.
fn between_feet(skeleton: &Skeleton, slots: &Humanoid, position: impl Fn(JointIndex) -> DVec3) -> Option<DVec3> {
    let sides = [(Slot::LeftUpperLeg, Slot::LeftFoot), (Slot::RightUpperLeg, Slot::RightFoot)];
    let [left, right] = sides.map(|(leg, foot)| {
        let (leg, foot) = (slots.joint(leg)?, slots.joint(foot)?);
        ancestry(skeleton, foot).any(|joint| joint == leg).then(|| position(foot))
    });
    Some(left?.midpoint(right?))
}

/// The pair whose source travels, without one above it that does, and whose target carries most others.
fn travelling_pair(input: HipsInput) -> Option<usize> {
    let HipsInput { map, alignment, tracks, target, .. } = input;
    if !alignment.pair_of_slot.is_empty() {
        return None;
    }
    let mut is_source = vec![false; tracks.skeleton.len()];
    map.pairs.iter().for_each(|pair| is_source[pair.source.get()] = true);
    // A joint travels along with what isn't mapped above it.
    let travels = |pair: &Pair| {
        let moves = |joint: JointIndex| tracks.translations[joint.get()].is_moving();
        let mut above = ancestry(tracks.skeleton, pair.source).skip(1).take_while(|joint| !is_source[joint.get()]);
        moves(pair.source) || above.any(moves)
    };
    // By joint of the target: whether its pair travels, and how many mapped joints are at or below it.
    let mut is_travelling = vec![false; target.skeleton.len()];
    let mut carried = vec![0_usize; target.skeleton.len()];
    for pair in &map.pairs {
        is_travelling[pair.target.get()] = travels(pair);
        ancestry(&target.skeleton, pair.target).for_each(|joint| carried[joint.get()] += 1);
    }
    let is_carrier = |pair: &Pair| {
        let mut above = ancestry(&target.skeleton, pair.target).skip(1);
        is_travelling[pair.target.get()] && !above.any(|joint| is_travelling[joint.get()])
    };
    let carriers = map.pairs.iter().enumerate().filter(|(_, pair)| is_carrier(pair));
    carriers.rev().max_by_key(|(_, pair)| carried[pair.target.get()]).map(|(index, _)| index)
}

/// Heights of the lowest source joint and the lowest target joint at the aligned rest.
fn lowest_joints(alignment: &Alignment, joints: impl Iterator<Item = (JointIndex, JointIndex)>) -> (f64, f64) {
    joints.fold((f64::INFINITY, f64::INFINITY), |(source_low, target_low), (source, target)| {
        (source_low.min(alignment.source.position(source).y), target_low.min(alignment.target.position(target).y))
    })
}

/// Some skeletons, usually BVH, rest with their hips at the origin and their legs below the ground, and every clip
/// lifts them. Where the feet go shows whether the ground is under the resting feet or in the plane of the origin.
fn rests_in_the_ground(input: HipsInput, pair: usize, legs: &[JointIndex], source_ground: f64) -> bool {
    let HipsInput { map, alignment, tracks, .. } = input;
    let hips = map.pairs[pair].source;
    let height = alignment.source.position(hips).y - source_ground;
    if source_ground.abs() < 0.25 * height || legs.is_empty() {
        return false;
    }
    let mut times = union(tracks.path_timelines(hips));
    let step = times.len().div_ceil(GROUND_SAMPLES).max(1);
    times = times.into_iter().step_by(step).collect();
    if times.is_empty() {
        times.push(0.0);
    }
    let lowest_at = |time: &f32| {
        let heights = legs.iter().map(|&joint| tracks.position(joint, *time, alignment.source.world_from_model).y);
        heights.fold(f64::INFINITY, f64::min)
    };
    let mut lows: Vec<f64> = times.iter().map(lowest_at).collect();
    sort_by(&mut lows, f64::total_cmp);
    let median = lows[lows.len() / 2];
    median.abs() < (median - source_ground).abs()
}

/// Height of the lowest leg joint, or None without legs.
pub fn lowest_leg_joint(slots: &Humanoid, positions: &[DVec3]) -> Option<f64> {
    LEGS.iter().filter_map(|&slot| Some(positions[slots.joint(slot)?.get()].y)).reduce(f64::min)
}
