//! The chains of joints that both bodies have, found by hierarchy and place alone: which of them the map covers, and which stay
//! still on the model though they move in the motion. Slots name them and help where the map has nothing, but a wrong one hides
//! nothing.

use std::collections::BTreeMap;

use gaitway_character::anim::{JointIndex, Skeleton};
use gaitway_character::asset::{Asset, Humanoid};
use glam::{DQuat, DVec3};

use crate::budget::may_compare_chains;
use crate::map::ResolvedMap;
use crate::math::angle_between;
use crate::skin::moves_skin;
use crate::stack::BodyPart;
use crate::transfer::Transfer;

/// Lengths as shares of the hips' height: a chain ends where at least two others of `MIN_LIMB` begin, besides which it may carry
/// some of `MIN_CHAIN`.
const MIN_LIMB: f64 = 0.25;
const MIN_CHAIN: f64 = 0.1;

/// How far the ends of two chains without a common pair may be apart in sum, as a share of the model's chain.
const MAX_DISTANCE: f64 = 1.2;

/// A chain of the motion moves if its joints turn by this in sum. The model's is idle below this share of it, unless a third of it
/// is mapped.
const MIN_TURN_DEGREES: f64 = 20.0;
const MAX_IDLE_SHARE: f64 = 0.15;
const MAX_IDLE_COVERED: f64 = 1.0 / 3.0;

/// A joint that turns by less isn't missed.
const MIN_JOINT_DEGREES: f64 = 1.0;

/// A chain of the model and its counterpart in the motion.
pub struct Limb {
    pub name: String,
    target: Bend,
    source: Bend,
}

/// A chain, and how far its joints have turned from where they were at first.
struct Bend {
    links: Vec<Link>,
    first: Vec<DQuat>,
}

/// A joint of a chain.
struct Link {
    joint: JointIndex,
    /// Share of the chain's length that is between this joint and the next one.
    share: f64,
    is_mapped: bool,
    max_degrees: f64,
}

impl Bend {
    fn new(
        chain: &[JointIndex],
        position: impl Fn(JointIndex) -> DVec3,
        is_mapped: impl Fn(JointIndex) -> bool,
    ) -> Self {
        let length = |at: usize| chain.get(at + 1).map_or(0.0, |&next| position(chain[at]).distance(position(next)));
        let total: f64 = (0..chain.len()).map(length).sum();
        let links = chain.iter().enumerate().map(|(at, &joint)| {
            let share = if total > 0.0 { length(at) / total } else { 1.0 / chain.len() as f64 };
            Link { joint, share, is_mapped: is_mapped(joint), max_degrees: 0.0 }
        });
        Self { links: links.collect(), first: Vec::new() }
    }

    fn add(&mut self, rotation: impl FnMut(JointIndex) -> DQuat) {
        let now: Vec<DQuat> = self.links.iter().map(|link| link.joint).map(rotation).collect();
        if self.first.is_empty() {
            self.first.clone_from(&now);
        }
        for ((first, now), link) in self.first.iter().zip(now).zip(&mut self.links) {
            link.max_degrees = angle_between(*first, now).to_degrees().max(link.max_degrees);
        }
    }

    fn degrees(&self) -> f64 {
        self.links.iter().map(|link| link.max_degrees).sum()
    }

    /// The share of the chain's length without a pair, of joints that turn by at least this.
    fn unmapped(&self, min_degrees: f64) -> f64 {
        let unmapped = self.links.iter().filter(|link| !link.is_mapped && link.max_degrees >= min_degrees);
        unmapped.map(|link| link.share).sum()
    }
}

impl Limb {
    /// Adds the joints' local rotations at a moment.
    pub fn add(&mut self, target: impl FnMut(JointIndex) -> DQuat, source: impl FnMut(JointIndex) -> DQuat) {
        self.target.add(target);
        self.source.add(source);
    }

    /// The share of its length that follows the motion. What the model lacks joints for isn't missed, nor what stays still in the
    /// motion.
    fn covered(&self) -> f64 {
        1.0 - self.target.unmapped(0.0).min(self.source.unmapped(MIN_JOINT_DEGREES))
    }

    /// Whether the model's doesn't move though the motion's does.
    pub fn is_idle(&self) -> bool {
        let moved = self.source.degrees();
        moved >= MIN_TURN_DEGREES && self.target.degrees() < MAX_IDLE_SHARE * moved && self.covered() < MAX_IDLE_COVERED
    }
}

/// The share of the chains' lengths that follows the motion, on average; `None` without any.
pub fn coverage(limbs: &[Limb]) -> Option<f64> {
    (!limbs.is_empty()).then(|| limbs.iter().map(Limb::covered).sum::<f64>() / limbs.len() as f64)
}

/// Returns the chains that both bodies have.
pub fn limbs(transfer: &Transfer, [source_slots, target_slots]: [&Humanoid; 2]) -> Vec<Limb> {
    let (map, target_skeleton, source_skeleton) = (transfer.map, transfer.target_skeleton, transfer.tracks.skeleton);
    let mut animated = vec![false; source_skeleton.len()];
    transfer.tracks.clip.channels().iter().for_each(|channel| animated[channel.joint.get()] = true);
    if !animated.contains(&true) {
        animated.fill(true);
    }
    let places = Places::new(transfer);
    let target_position = |joint| transfer.alignment.target.position(joint);
    let source_position = |joint| places.of_source(joint);
    let targets = chains(target_skeleton, &bodily(transfer.target), target_position, places.unit);
    let sources = chains(source_skeleton, &animated, source_position, places.unit);
    let source_chain = chain_by_joint(&sources, source_skeleton);
    let by_map = by_map(map, [&chain_by_joint(&targets, target_skeleton), &source_chain], targets.len());
    let mut is_free = vec![true; sources.len()];
    by_map.iter().flatten().for_each(|&source| is_free[source] = false);
    let by_slot = |target: &[JointIndex]| {
        let mut slots = target.iter().filter_map(|&joint| target_slots.slot(joint));
        let joint = slots.find_map(|slot| source_slots.joint(slot))?;
        source_chain[joint.get()].filter(|&source| is_free[source])
    };
    let may_compare = may_compare_chains(targets.len(), sources.len());
    let by_place = |target: &[JointIndex]| {
        if !may_compare {
            return None;
        }
        let length: f64 =
            target.windows(2).map(|ends| target_position(ends[0]).distance(target_position(ends[1]))).sum();
        let ends = |chain: &[JointIndex]| [chain.first().copied(), chain.last().copied()];
        let distance = |source: &[JointIndex]| -> f64 {
            let both = ends(target).into_iter().zip(ends(source));
            both.filter_map(|(target, source)| Some(target_position(target?).distance(source_position(source?)))).sum()
        };
        let free = sources.iter().enumerate().filter(|(at, _)| is_free[*at]);
        let near = free.map(|(at, source)| (at, distance(source))).filter(|(_, far)| *far < MAX_DISTANCE * length);
        near.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(at, _)| at)
    };
    let mut is_source = vec![false; source_skeleton.len()];
    map.pairs.iter().for_each(|pair| is_source[pair.source.get()] = true);
    let mut found = Vec::new();
    for (target, by_map) in targets.iter().zip(&by_map) {
        let source = by_map.or_else(|| by_slot(target)).or_else(|| by_place(target));
        let Some(source) = source.map(|at| &sources[at]) else { continue };
        let slot = target.iter().find_map(|&joint| target_slots.slot(joint));
        let slot = slot.or_else(|| source.iter().find_map(|&joint| source_slots.slot(joint)));
        found.push(Limb {
            name: name(target_skeleton, target[0], slot.map(BodyPart::of)),
            target: Bend::new(target, target_position, |joint| map.source_of(joint).is_some()),
            source: Bend::new(source, source_position, |joint| is_source[joint.get()]),
        });
    }
    found
}

/// Returns the index of each joint's chain.
fn chain_by_joint(chains: &[Vec<JointIndex>], skeleton: &Skeleton) -> Vec<Option<usize>> {
    let mut chain_by_joint = vec![None; skeleton.len()];
    for (at, chain) in chains.iter().enumerate() {
        chain.iter().for_each(|joint| chain_by_joint[joint.get()] = Some(at));
    }
    chain_by_joint
}

/// Returns for each chain of the target the source's chain that it has most pairs with, of equal ones the first.
fn by_map(map: &ResolvedMap, chain_by_joint: [&[Option<usize>]; 2], targets: usize) -> Vec<Option<usize>> {
    let [target_chain, source_chain] = chain_by_joint;
    let mut counts: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for pair in &map.pairs {
        if let (Some(target), Some(source)) = (target_chain[pair.target.get()], source_chain[pair.source.get()]) {
            *counts.entry((target, source)).or_default() += 1;
        }
    }
    let most = |target: usize| {
        let of_target = counts.range((target, 0)..(target + 1, 0)).rev();
        of_target.max_by_key(|(_, count)| **count).map(|((_, source), _)| *source)
    };
    (0..targets).map(most).collect()
}

/// Names a chain after the part of the body, else after its first joint.
fn name(skeleton: &Skeleton, first: JointIndex, part: Option<BodyPart>) -> String {
    let part = BodyPart::ALL.iter().find(|(other, _)| Some(*other) == part);
    part.map_or_else(|| skeleton.label(first), |(_, name)| (*name).to_owned())
}

/// Brings the source's rest to the target's place and size.
struct Places<'a> {
    transfer: &'a Transfer<'a>,
    scale: f64,
    source_origin: DVec3,
    target_origin: DVec3,
    /// The height of the target's hips.
    unit: f64,
}

impl<'a> Places<'a> {
    /// Without hips, the bounds of both rests correspond.
    fn new(transfer: &'a Transfer<'a>) -> Self {
        if let (Some(hips), Some(pair)) = (transfer.hips, transfer.hips_pair()) {
            let source_origin = transfer.alignment.source.position(pair.source);
            let target_origin = transfer.alignment.target.position(pair.target);
            return Self { transfer, scale: hips.scale, source_origin, target_origin, unit: hips.height };
        }
        let bounds = |positions: &[DVec3]| {
            let low = positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
            let high = positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
            (low.midpoint(high), (high.y - low.y).max(f64::MIN_POSITIVE))
        };
        let (source_origin, source_height) = bounds(&transfer.alignment.source.positions);
        let (target_origin, target_height) = bounds(&transfer.alignment.target.positions);
        let scale = target_height / source_height;
        Self { transfer, scale, source_origin, target_origin, unit: 0.5 * target_height }
    }

    fn of_source(&self, joint: JointIndex) -> DVec3 {
        let position = self.transfer.alignment.source.position(joint);
        self.target_origin + self.scale * (position - self.source_origin)
    }
}

/// The joints that move skin or carry a mesh; all if none does.
fn bodily(asset: &Asset) -> Vec<bool> {
    let mut bodily = moves_skin(asset).unwrap_or_else(|| vec![false; asset.skeleton.len()]);
    for instance in asset.instances.iter().filter(|instance| instance.skin.is_none()) {
        bodily[instance.joint.get()] = true;
    }
    if bodily.contains(&true) { bodily } else { vec![true; asset.skeleton.len()] }
}

/// Returns the chains of a skeleton from joint to tip, without what is above the first fork if there is one.
fn chains(
    skeleton: &Skeleton,
    is_wanted: &[bool],
    position: impl Fn(JointIndex) -> DVec3,
    unit: f64,
) -> Vec<Vec<JointIndex>> {
    let mut children: Vec<Vec<JointIndex>> = vec![Vec::new(); skeleton.len()];
    // How far the farthest wanted joint below is, along the bones; None if neither the joint nor any below is wanted.
    let mut reach: Vec<Option<f64>> = is_wanted.iter().map(|wanted| wanted.then_some(0.0)).collect();
    let mut roots = Vec::new();
    for joint in skeleton.joints().rev() {
        let Some(below) = reach[joint.get()] else { continue };
        match skeleton.parent(joint) {
            Some(parent) => {
                children[parent.get()].push(joint);
                let through = below + position(joint).distance(position(parent));
                let of_parent = &mut reach[parent.get()];
                *of_parent = Some(of_parent.map_or(through, |other| other.max(through)));
            }
            None => roots.push(joint),
        }
    }
    let length = |parent: JointIndex, child: &JointIndex| {
        reach[child.get()].unwrap_or(0.0) + position(parent).distance(position(*child))
    };
    let (mut found, mut above_forks) = (Vec::new(), Vec::new());
    let mut open: Vec<(JointIndex, bool)> = roots.into_iter().map(|root| (root, false)).collect();
    while let Some((first, is_limb)) = open.pop() {
        let mut chain = vec![first];
        let mut end = first;
        loop {
            let below = &children[end.get()];
            let longer = |min: f64| below.iter().filter(move |child| length(end, child) >= min * unit);
            let limbs = longer(MIN_LIMB).count();
            if limbs >= 2 {
                open.extend(longer(MIN_CHAIN).map(|&child| (child, true)));
                break;
            }
            let longest = below.iter().max_by(|a, b| length(end, a).total_cmp(&length(end, b)));
            // Fingers and the like are no part of the chain they hang on.
            let goes_on = below.len() == 1 || limbs == 1;
            let Some(&next) = longest.filter(|_| goes_on) else { break };
            chain.push(next);
            end = next;
        }
        if is_limb {
            found.push(chain);
        } else {
            above_forks.push(chain);
        }
    }
    if found.is_empty() { above_forks } else { found }
}
