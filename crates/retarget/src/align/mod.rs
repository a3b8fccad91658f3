//! Aligns the two rest poses before motion is transferred: both face the same way and stand upright, and the target's
//! limbs point where the source's do. The results are the aligned rests `W*` of the rotation law.

mod common_frame;
pub mod rest;
mod same_rig;
mod stance;
pub mod swing;
mod up;

use std::collections::BTreeMap;

use gaitway_character::anim::{JointIndex, Skeleton};
use gaitway_character::asset::{Asset, Humanoid, Slot};
use glam::DQuat;

use super::map::{Pair, ResolvedMap};
use super::math::unit;
use super::pose::{Local, WorldPose};
use swing::{Side, SwingInput};

/// Both rests in the common frame: +Y up, facing +Z. Positions are in each side's own units.
#[derive(Debug)]
pub struct Alignment {
    pub source: WorldPose,
    /// The aligned rest. Joints without a source keep their node's rest relative to their parent. So do the translations of those
    /// without a slot, which are often helpers, of the face, and of all joints if both skeletons are the same rig.
    pub target: WorldPose,
    /// The target's rest before its limbs were swung.
    pub unaligned_target: WorldPose,
    /// Index into [`ResolvedMap::pairs`] of the pair that fills a slot.
    pub pair_of_slot: BTreeMap<Slot, usize>,
}

impl Alignment {
    pub fn pair<'m>(&self, map: &'m ResolvedMap, slot: Slot) -> Option<&'m Pair> {
        self.pair_of_slot.get(&slot).map(|&pair| &map.pairs[pair])
    }
}

/// One body with its chosen rest.
#[derive(Debug)]
pub struct Rest<'a> {
    pub asset: &'a Asset,
    pub slots: &'a Humanoid,
    pub locals: Vec<Local>,
}

impl Rest<'_> {
    fn world_pose(&self, world_from_model: DQuat) -> WorldPose {
        WorldPose::new(&self.asset.skeleton, self.locals.clone(), world_from_model)
    }
}

/// `target_nodes` is the target's rest pose as the player sees it; `unpaired` are the joints that turn without a pair.
/// `target_from_source` is set if the rest poses match; it rotates one model space into the other, and nothing else needs aligning.
pub fn align(
    map: &ResolvedMap,
    source: &Rest,
    target: &Rest,
    target_nodes: &[Local],
    unpaired: &[JointIndex],
    target_from_source: Option<DQuat>,
) -> Alignment {
    let pair_of_slot = pairs_of_slots(map, source.slots, target.slots);
    let common_from = |rest: &Rest| common_frame::common_from_model(&rest.world_pose(DQuat::IDENTITY), rest.slots);
    let [common_from_source, common_from_target] = match target_from_source {
        Some(target_from_source) => {
            let common_from_target = common_from(target).unwrap_or(DQuat::IDENTITY);
            [unit(common_from_target * target_from_source), common_from_target]
        }
        None => match [common_from(source), common_from(target)] {
            [Some(source), Some(target)] => [source, target],
            _ => [DQuat::IDENTITY; 2],
        },
    };
    let (source_pose, target_pose) = (source.world_pose(common_from_source), target.world_pose(common_from_target));
    let swings = match target_from_source {
        Some(_) => vec![DQuat::IDENTITY; map.pairs.len()],
        None => swing::swings(SwingInput {
            map,
            pair_of_slot: &pair_of_slot,
            source: Side { asset: source.asset, slots: source.slots, pose: &source_pose },
            target: Side { asset: target.asset, slots: target.slots, pose: &target_pose },
        }),
    };
    let mut locals = target_nodes.to_vec();
    let body = pair_of_slot.iter().filter(|(slot, _)| target_from_source.is_none() && !is_face(**slot));
    for (_, &pair) in body {
        let joint = map.pairs[pair].target.get();
        locals[joint].translation = target.locals[joint].translation;
    }
    for joint in unpaired {
        locals[joint.get()].rotation = target_pose.locals[joint.get()].rotation;
    }
    align_rotations(&mut locals, map, &swings, &target.asset.skeleton, &target_pose);
    let aligned = WorldPose::new(&target.asset.skeleton, locals, common_from_target);
    Alignment { source: source_pose, target: aligned, unaligned_target: target_pose, pair_of_slot }
}

fn is_face(slot: Slot) -> bool {
    matches!(slot, Slot::LeftEye | Slot::RightEye | Slot::Jaw)
}

/// Turns the nodes' local transforms into the aligned rest: swings and corrections on mapped joints, the given rotations on others.
fn align_rotations(locals: &mut [Local], map: &ResolvedMap, swings: &[DQuat], skeleton: &Skeleton, target: &WorldPose) {
    let mut rotations: Vec<DQuat> = Vec::with_capacity(locals.len());
    let mut pairs = map.pairs.iter().zip(swings).peekable();
    for joint in skeleton.joints() {
        let parent = skeleton.parent(joint).map_or(target.world_from_model, |parent| rotations[parent.get()]);
        let local = &mut locals[joint.get()];
        let rotation = match pairs.next_if(|(pair, _)| pair.target == joint) {
            Some((pair, swing)) => unit(*swing * target.rotation(joint) * unit(pair.correction.as_dquat())),
            None => unit(parent * local.rotation),
        };
        local.rotation = unit(parent.conjugate() * rotation);
        rotations.push(rotation);
    }
}

/// A pair fills its target's slot, or its source's if the target has none.
fn pairs_of_slots(map: &ResolvedMap, source_slots: &Humanoid, target_slots: &Humanoid) -> BTreeMap<Slot, usize> {
    let mut pair_of_slot = BTreeMap::new();
    let mut fill = |slots: &Humanoid, joint_of: fn(&Pair) -> JointIndex| {
        for (index, pair) in map.pairs.iter().enumerate() {
            if !pair_of_slot.values().any(|&taken| taken == index)
                && let Some(slot) = slots.slot(joint_of(pair))
            {
                pair_of_slot.entry(slot).or_insert(index);
            }
        }
    };
    fill(target_slots, |pair| pair.target);
    fill(source_slots, |pair| pair.source);
    pair_of_slot
}
