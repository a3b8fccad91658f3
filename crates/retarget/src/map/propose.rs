//! Proposes a joint map: by shared names if most are shared, else by humanoid slots. Remaining joints are paired by
//! name if they hang in the same place.

use std::collections::{BTreeMap, BTreeSet};

use gaitway_character::anim::{JointIndex, Keys, Skeleton};
use gaitway_character::asset::{Asset, Slot};
use gaitway_character::sort::{collect_map, collect_set};

use super::joint_map::{JointMap, MapEntry};
use super::shared_names::shared_names;
use crate::recognize::{Reason, Recognized, RecognizedJoint, chains, recognize};

/// Which joints could follow which, and why.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Proposal {
    /// Ascending by target; each target and each source appears once.
    pub pairs: Vec<ProposedPair>,
    /// Joints of the model's skins (all joints if it has none) that follow nothing.
    pub unmapped_targets: Vec<JointIndex>,
    /// Joints that the motion's clips move and that nothing follows.
    pub unused_sources: Vec<JointIndex>,
    /// What was recognized in the model, including contradictions.
    pub model: Recognized,
    /// What was recognized in the motion.
    pub motion: Recognized,
}

/// A joint of the model, the joint of the motion that it could follow, and why.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProposedPair {
    /// Joint of the model.
    pub target: JointIndex,
    /// Joint of the motion.
    pub source: JointIndex,
    /// The target's slot.
    pub slot: Option<Slot>,
    /// How the pair was found; of two recognized joints, how the less certain one was.
    pub reason: Reason,
    /// 0 (a guess) to 1 (the files say so).
    pub confidence: f32,
}

/// Minimum share of the joints a motion moves that must have their name in the model for names to decide.
const MIN_SHARED_NAMES: f32 = 0.8;

/// Confidence in a shared name outside the humanoid slots.
const NAME_CONFIDENCE: f32 = 0.9;

/// Minimum number of common slots that make a body, unless the motion itself says what it moves.
const MIN_SHARED_SLOTS: usize = 3;

const TRUNK: [Slot; 3] = [Slot::Spine, Slot::Chest, Slot::UpperChest];

/// Proposes a map; deterministic. It has no pairs if neither names nor slots agree.
pub fn propose(model: &Asset, motion: &Asset) -> Proposal {
    propose_recognized(model, motion, recognize(model), recognize(motion))
}

/// Like [`propose`], for bodies that were recognized before.
pub fn propose_recognized(model: &Asset, motion: &Asset, targets: Recognized, sources: Recognized) -> Proposal {
    let moved = moved_joints(motion);
    let shared = shared_names(&model.skeleton, &motion.skeleton);
    let mut pairs = Pairs::default();
    if names_decide(&shared, &moved, &targets, &sources) {
        for (&target, &source) in &shared {
            pairs.add(target, source, targets.slot(target), Reason::SameName, 1.0);
        }
    } else if targets.parts.is_empty() && sources.parts.is_empty() {
        pair_creatures(&mut pairs, &shared, model, motion);
    } else {
        pair_by_slots(&mut pairs, &targets, &sources);
    }
    let leftovers = Leftovers {
        model: &model.skeleton,
        motion: &motion.skeleton,
        moved: &moved,
        targets: &targets,
        sources: &sources,
    };
    pair_leftovers(&mut pairs, &shared, &leftovers);
    let skinned = skinned_joints(model);
    let unmapped_targets = skinned.into_iter().filter(|joint| !pairs.by_target.contains_key(joint)).collect();
    let unused_sources = moved.into_iter().filter(|joint| !pairs.sources.contains(joint)).collect();
    let pairs = pairs.by_target.into_values().collect();
    Proposal { pairs, unmapped_targets, unused_sources, model: targets, motion: sources }
}

#[derive(Default)]
struct Pairs {
    by_target: BTreeMap<JointIndex, ProposedPair>,
    sources: BTreeSet<JointIndex>,
}

impl Pairs {
    /// Does nothing if either joint is taken.
    fn add(&mut self, target: JointIndex, source: JointIndex, slot: Option<Slot>, reason: Reason, confidence: f32) {
        if !self.by_target.contains_key(&target) && self.sources.insert(source) {
            self.by_target.insert(target, ProposedPair { target, source, slot, reason, confidence });
        }
    }
}

/// Joints that any clip moves, ascending; all joints if there is no clip.
fn moved_joints(motion: &Asset) -> Vec<JointIndex> {
    let mut moved: BTreeSet<JointIndex> = BTreeSet::new();
    for channel in motion.clips.iter().flat_map(|clip| clip.channels()) {
        if !matches!(channel.keys, Keys::MorphWeights { .. }) {
            moved.insert(channel.joint);
        }
    }
    if moved.is_empty() { motion.skeleton.joints().collect() } else { moved.into_iter().collect() }
}

/// Joints of the skins; all joints if there is no skin.
fn skinned_joints(model: &Asset) -> BTreeSet<JointIndex> {
    let skinned = collect_set(model.skins.iter().flat_map(|skin| skin.joints().iter().copied()));
    if skinned.is_empty() { collect_set(model.skeleton.joints()) } else { skinned }
}

/// Whether the skeletons share enough names, and mean the same joints by them.
fn names_decide(
    shared: &BTreeMap<JointIndex, JointIndex>,
    moved: &[JointIndex],
    targets: &Recognized,
    sources: &Recognized,
) -> bool {
    let named = collect_set(shared.values().copied());
    let count = moved.iter().filter(|joint| named.contains(joint)).count();
    // Of two files with the same names, only one may show that they are wrong about the sides: the other one's rest may be a
    // pose in motion.
    let is_side_unknown = targets.by_position != sources.by_position;
    let means_same = |(&target, &source): (&JointIndex, &JointIndex)| match (targets.slot(target), sources.slot(source))
    {
        // A trunk of two joints spreads over other slots than one of three; its ends are compared below.
        (Some(a), Some(b)) => {
            a == b || TRUNK.contains(&a) && TRUNK.contains(&b) || is_side_unknown && a == b.mirrored()
        }
        _ => true,
    };
    let tops_agree = match (trunk(targets).last(), trunk(sources).last()) {
        (Some((_, target)), Some((_, source))) => shared.get(target) == Some(source),
        _ => true,
    };
    // One file's “Hips” may be what the other one's hips carry.
    let hips_agree = match (targets.joint(Slot::Hips), sources.joint(Slot::Hips)) {
        (Some(target), Some(source)) => shared.get(&target) == Some(&source),
        _ => true,
    };
    let agree = shared.iter().all(means_same) && tops_agree && hips_agree;
    count > 0 && count as f32 >= MIN_SHARED_NAMES * moved.len() as f32 && agree
}

/// The recognized joints between hips and neck, lowest first.
fn trunk(recognized: &Recognized) -> Vec<(Slot, JointIndex)> {
    TRUNK.into_iter().filter_map(|slot| Some((slot, recognized.joint(slot)?))).collect()
}

fn pair_by_slots(pairs: &mut Pairs, targets: &Recognized, sources: &Recognized) {
    let shared = targets.parts.keys().filter(|slot| sources.parts.contains_key(slot)).count();
    let says_so =
        |(slot, part): (&Slot, &RecognizedJoint)| part.reason == Reason::File && targets.parts.contains_key(slot);
    // A VRM animation may move any bones, even a single one.
    if shared < MIN_SHARED_SLOTS && !sources.parts.iter().any(says_so) {
        return;
    }
    let mut pair = |target_slot: Slot, source_slot: Slot| {
        if let (Some(target), Some(source)) = (targets.parts.get(&target_slot), sources.parts.get(&source_slot)) {
            let weaker = if source.confidence < target.confidence { source } else { target };
            pairs.add(target.joint, source.joint, Some(target_slot), weaker.reason, weaker.confidence);
        }
    };
    let (target_trunk, source_trunk) = (trunk(targets), trunk(sources));
    for (target, source) in match_chains(target_trunk.len(), source_trunk.len()) {
        pair(target_trunk[target].0, source_trunk[source].0);
    }
    for &slot in targets.parts.keys().filter(|slot| !TRUNK.contains(slot)) {
        pair(slot, slot);
    }
}

/// Confidence in a name that two creatures share, if it hangs under the same shared names in both.
const CREATURE_NAME_CONFIDENCE: f32 = 0.7;

/// Confidence in the counterpart of a creature's joint by its place in a chain.
const CREATURE_CHAIN_CONFIDENCE: f32 = 0.4;

/// Minimum number of shared names: fewer may be coincidence.
const MIN_CREATURE_NAMES: usize = 4;

/// Pairs the joints of two creatures: by the names they share, then along trunk, tail, legs and wings.
fn pair_creatures(pairs: &mut Pairs, shared: &BTreeMap<JointIndex, JointIndex>, model: &Asset, motion: &Asset) {
    let sources = collect_set(shared.values().copied());
    let above_target = nearest_above(&model.skeleton, |joint| shared.get(&joint).copied());
    let above_source = nearest_above(&motion.skeleton, |joint| sources.contains(&joint).then_some(joint));
    let hangs_alike = |(target, source): &(&JointIndex, &JointIndex)| {
        !model.skeleton.name(**target).is_empty() && above_target[target.get()] == above_source[source.get()]
    };
    let alike: Vec<_> = shared.iter().filter(hangs_alike).collect();
    if alike.len() >= MIN_CREATURE_NAMES {
        for (&target, &source) in alike {
            pairs.add(target, source, None, Reason::SameName, CREATURE_NAME_CONFIDENCE);
        }
    }
    let (targets, sources) = (chains(model), chains(motion));
    for (limb, targets) in &targets {
        let Some(sources) = sources.get(limb) else { continue };
        let is_named = targets.iter().any(|target| pairs.by_target.contains_key(target))
            || sources.iter().any(|source| pairs.sources.contains(source));
        let matched = if is_named { Vec::new() } else { match_chains(targets.len(), sources.len()) };
        for (target, source) in matched {
            pairs.add(targets[target], sources[source], None, Reason::Geometry, CREATURE_CHAIN_CONFIDENCE);
        }
    }
}

/// Matches the joints of two chains, target to source: lowest to lowest, highest to highest, the others evenly. A single
/// target follows the highest source, which has accumulated all turns below it; a single source moves the lowest target,
/// which carries those above along.
fn match_chains(targets: usize, sources: usize) -> Vec<(usize, usize)> {
    let spread = |at: usize, count: usize, over: usize| (at * (over - 1) + (count - 1) / 2) / (count - 1);
    match (targets, sources) {
        (0, _) | (_, 0) => Vec::new(),
        (1, _) => vec![(0, sources - 1)],
        (_, 1) => vec![(0, 0)],
        _ if targets <= sources => (0..targets).map(|target| (target, spread(target, targets, sources))).collect(),
        _ => (0..sources).map(|source| (spread(source, sources, targets), source)).collect(),
    }
}

/// Context for pairing joints outside the slots.
struct Leftovers<'a> {
    model: &'a Skeleton,
    motion: &'a Skeleton,
    /// Ascending.
    moved: &'a [JointIndex],
    targets: &'a Recognized,
    sources: &'a Recognized,
}

/// Pairs joints that share a name, have no slot and hang in the same place.
fn pair_leftovers(pairs: &mut Pairs, shared: &BTreeMap<JointIndex, JointIndex>, input: &Leftovers) {
    // The source of each target's nearest paired ancestor, and the nearest paired ancestor of each source.
    let above_target = nearest_above(input.model, |joint| pairs.by_target.get(&joint).map(|pair| pair.source));
    let above_source = nearest_above(input.motion, |joint| pairs.sources.contains(&joint).then_some(joint));
    for (&target, &source) in shared {
        let has_slot = input.targets.slot(target).is_some() || input.sources.slot(source).is_some();
        if has_slot || input.moved.binary_search(&source).is_err() {
            continue;
        }
        let (above_target, above_source) = (above_target[target.get()], above_source[source.get()]);
        if above_target.is_some() && above_target == above_source {
            pairs.add(target, source, None, Reason::SameName, NAME_CONFIDENCE);
        }
    }
}

/// For each joint, the value of `of` at the nearest ancestor that has one.
fn nearest_above<T: Copy>(skeleton: &Skeleton, of: impl Fn(JointIndex) -> Option<T>) -> Vec<Option<T>> {
    let mut found: Vec<Option<T>> = Vec::with_capacity(skeleton.len());
    for joint in skeleton.joints() {
        found.push(skeleton.parent(joint).and_then(|parent| of(parent).or(found[parent.get()])));
    }
    found
}

impl Proposal {
    /// Returns the proposed pairs as a map. Without any, the map lists the model's joints to fill in.
    pub fn to_map(&self, model: &Asset, motion: &Asset) -> JointMap {
        let entry = |pair: &ProposedPair| {
            let source = motion.skeleton.source_index(pair.source);
            (model.skeleton.source_index(pair.target), MapEntry::following(Some(source)))
        };
        let open = self.unmapped_targets.iter().filter(|_| self.pairs.is_empty());
        let open = open.map(|&joint| (model.skeleton.source_index(joint), MapEntry::following(None)));
        JointMap { joints: collect_map(self.pairs.iter().map(entry).chain(open)), ..JointMap::with_proposed_options() }
    }
}
