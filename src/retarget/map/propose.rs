//! A joint map to start from: by the names that both skeletons share where most are shared, else by parts of the body, and
//! what is left by names again where it hangs in the same place.

use std::collections::{BTreeMap, BTreeSet};

use super::{JointMap, MapEntry, SourceRef};
use crate::anim::{JointIndex, Keys, Skeleton};
use crate::asset::{Asset, Slot};
use crate::retarget::recognize::{Name, Reason, Recognized, recognize};

/// Which joints could follow which, and why.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Proposal {
    /// By target joint, ascending; a target and a source stand here once.
    pub pairs: Vec<ProposedPair>,
    /// Joints of the model's skins (of a model without: all) that follow nothing.
    pub unmapped_targets: Vec<JointIndex>,
    /// Joints that the motion's clips move and that nothing follows.
    pub unused_sources: Vec<JointIndex>,
    /// What was recognised in the model, contradictions in it included.
    pub model: Recognized,
    pub motion: Recognized,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProposedPair {
    pub target: JointIndex,
    pub source: JointIndex,
    /// What the target is.
    pub slot: Option<Slot>,
    pub reason: Reason,
    /// 0 (a guess) to 1 (the files say so).
    pub confidence: f32,
}

/// So much of what a motion moves must be named alike in the model for names to decide.
const MOST: f32 = 0.8;

/// Names of joints that are no part of a known body.
const SURE_LEFT_OVER: f32 = 0.9;

/// Fewer parts in common are no body.
const FEWEST_PARTS: usize = 3;

/// The same two assets always give the same answer. It has no pairs when neither names nor parts of the body agree.
pub fn propose(model: &Asset, motion: &Asset) -> Proposal {
    let (targets, sources) = (recognize(model), recognize(motion));
    let moved = moved(motion);
    let alike = alike(&model.skeleton, &motion.skeleton);
    let mut pairs = Pairs::default();
    if names_decide(&alike, &moved, &targets, &sources) {
        for (&target, &source) in &alike {
            pairs.add(target, source, targets.slot(target), Reason::SameName, 1.0);
        }
    } else {
        pair_parts(&mut pairs, &targets, &sources);
    }
    pair_left_over(&mut pairs, model, motion, &alike, &moved, [&targets, &sources]);
    let unmapped_targets = covered(model).into_iter().filter(|joint| !pairs.by_target.contains_key(joint)).collect();
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
    fn add(&mut self, target: JointIndex, source: JointIndex, slot: Option<Slot>, reason: Reason, confidence: f32) {
        if !self.by_target.contains_key(&target) && self.sources.insert(source) {
            self.by_target.insert(target, ProposedPair { target, source, slot, reason, confidence });
        }
    }
}

/// Joints that any clip moves; all where there is no clip.
fn moved(motion: &Asset) -> Vec<JointIndex> {
    let mut moved: BTreeSet<JointIndex> = BTreeSet::new();
    for channel in motion.clips.iter().flat_map(|clip| clip.channels()) {
        if !matches!(channel.keys, Keys::MorphWeights { .. }) {
            moved.insert(channel.joint);
        }
    }
    if moved.is_empty() { motion.skeleton.joints().collect() } else { moved.into_iter().collect() }
}

/// Joints that a mesh is bound to; all where none is.
fn covered(model: &Asset) -> BTreeSet<JointIndex> {
    let covered: BTreeSet<JointIndex> = model.skins.iter().flat_map(|skin| skin.joints().iter().copied()).collect();
    if covered.is_empty() { model.skeleton.joints().collect() } else { covered }
}

/// Joints of two skeletons with the same name, target to source. Names that several joints share count where their parents
/// are the same; what exporters did to names makes no difference where it leaves no doubt.
fn alike(model: &Skeleton, motion: &Skeleton) -> BTreeMap<JointIndex, JointIndex> {
    let is_same = |joint: JointIndex| model.name(joint) == motion.name(joint);
    if model.parents() == motion.parents() && model.joints().all(is_same) {
        return model.joints().map(|joint| (joint, joint)).collect();
    }
    let mut found = BTreeMap::new();
    let mut taken = BTreeSet::new();
    let readings: [fn(&str) -> String; 2] = [str::to_owned, reading];
    for read in readings {
        let (targets, sources) = (by_name(model, read), by_name(motion, read));
        for (name, targets) in &targets {
            if let ([target], Some([source])) = (targets.as_slice(), sources.get(name).map(Vec::as_slice))
                && !found.contains_key(target)
                && !taken.contains(source)
            {
                found.insert(*target, *source);
                taken.insert(*source);
            }
        }
    }
    let mut children: Vec<BTreeMap<&str, Vec<JointIndex>>> = vec![BTreeMap::new(); motion.len()];
    for source in motion.joints().filter(|source| !taken.contains(source)).rev() {
        if let Some(parent) = motion.parent(source) {
            children[parent.get()].entry(motion.name(source)).or_default().push(source);
        }
    }
    // Parents come first, so that children of joints found here are found as well.
    for target in model.joints() {
        let Some(&source_parent) = model.parent(target).and_then(|parent| found.get(&parent)) else { continue };
        if found.contains_key(&target) || model.name(target).is_empty() {
            continue;
        }
        // The list runs backwards: its last is the first of that name.
        let twin = children[source_parent.get()].get_mut(model.name(target)).and_then(Vec::pop);
        if let Some(source) = twin {
            found.insert(target, source);
        }
    }
    found
}

fn by_name(skeleton: &Skeleton, read: fn(&str) -> String) -> BTreeMap<String, Vec<JointIndex>> {
    let mut joints: BTreeMap<String, Vec<JointIndex>> = BTreeMap::new();
    for joint in skeleton.joints().filter(|&joint| !skeleton.name(joint).is_empty()) {
        joints.entry(read(skeleton.name(joint))).or_default().push(joint);
    }
    joints
}

fn reading(name: &str) -> String {
    let name = Name::read(name);
    format!("{:?} {}", name.side, name.words.join(" "))
}

/// Whether the skeletons are named alike, and mean the same by it.
fn names_decide(
    alike: &BTreeMap<JointIndex, JointIndex>,
    moved: &[JointIndex],
    targets: &Recognized,
    sources: &Recognized,
) -> bool {
    let named: BTreeSet<JointIndex> = alike.values().copied().collect();
    let count = moved.iter().filter(|joint| named.contains(joint)).count();
    let means_same = |(&target, &source): (&JointIndex, &JointIndex)| match (targets.slot(target), sources.slot(source))
    {
        // A trunk of two joints spreads over other slots than one of three; its ends are looked at below.
        (Some(a), Some(b)) => a == b || TRUNK.contains(&a) && TRUNK.contains(&b),
        _ => true,
    };
    let tops_agree = match (trunk(targets).last(), trunk(sources).last()) {
        (Some((_, target)), Some((_, source))) => alike.get(target) == Some(source),
        _ => true,
    };
    count > 0 && count as f32 >= MOST * moved.len() as f32 && alike.iter().all(means_same) && tops_agree
}

const TRUNK: [Slot; 3] = [Slot::Spine, Slot::Chest, Slot::UpperChest];

/// The joints between hips and neck that are parts, the lowest first.
fn trunk(recognized: &Recognized) -> Vec<(Slot, JointIndex)> {
    TRUNK.into_iter().filter_map(|slot| Some((slot, recognized.joint(slot)?))).collect()
}

fn pair_parts(pairs: &mut Pairs, targets: &Recognized, sources: &Recognized) {
    let common = targets.parts.keys().filter(|slot| sources.parts.contains_key(slot)).count();
    if common < FEWEST_PARTS {
        return;
    }
    let mut pair = |target_slot: Slot, source_slot: Slot| {
        if let (Some(target), Some(source)) = (targets.parts.get(&target_slot), sources.parts.get(&source_slot)) {
            let weaker = if source.confidence < target.confidence { source } else { target };
            pairs.add(target.joint, source.joint, Some(target_slot), weaker.reason, weaker.confidence);
        }
    };
    let (target_trunk, source_trunk) = (trunk(targets), trunk(sources));
    for (target, source) in matched(target_trunk.len(), source_trunk.len()) {
        pair(target_trunk[target].0, source_trunk[source].0);
    }
    for &slot in targets.parts.keys().filter(|slot| !TRUNK.contains(slot)) {
        pair(slot, slot);
    }
}

/// Which of the joints of one trunk follows which of another: lowest to lowest, highest to highest, the others evenly. A
/// trunk of one joint follows the highest, which has all turns below in it; where there is one to follow, the lowest
/// follows and carries those above along.
fn matched(targets: usize, sources: usize) -> Vec<(usize, usize)> {
    let spread = |at: usize, count: usize, over: usize| (at * (over - 1) + (count - 1) / 2) / (count - 1);
    match (targets, sources) {
        (0, _) | (_, 0) => Vec::new(),
        (1, _) => vec![(0, sources - 1)],
        (_, 1) => vec![(0, 0)],
        _ if targets <= sources => (0..targets).map(|target| (target, spread(target, targets, sources))).collect(),
        _ => (0..sources).map(|source| (spread(source, sources, targets), source)).collect(),
    }
}

/// Names that agree, of joints that are no part of a body and hang in the same place.
fn pair_left_over(
    pairs: &mut Pairs,
    model: &Asset,
    motion: &Asset,
    alike: &BTreeMap<JointIndex, JointIndex>,
    moved: &[JointIndex],
    [targets, sources]: [&Recognized; 2],
) {
    // The source that the nearest paired ancestor of each target follows, and the nearest paired ancestor of each source.
    let target_above = nearest(&model.skeleton, |joint| pairs.by_target.get(&joint).map(|pair| pair.source));
    let source_above = nearest(&motion.skeleton, |joint| pairs.sources.contains(&joint).then_some(joint));
    for (&target, &source) in alike {
        let is_part = targets.slot(target).is_some() || sources.slot(source).is_some();
        if is_part || moved.binary_search(&source).is_err() {
            continue;
        }
        let (target_above, source_above) = (target_above[target.get()], source_above[source.get()]);
        if target_above.is_some() && target_above == source_above {
            pairs.add(target, source, None, Reason::SameName, SURE_LEFT_OVER);
        }
    }
}

/// For each joint what its nearest ancestor has that has anything.
fn nearest<T: Copy>(skeleton: &Skeleton, of: impl Fn(JointIndex) -> Option<T>) -> Vec<Option<T>> {
    let mut found: Vec<Option<T>> = Vec::with_capacity(skeleton.len());
    for joint in skeleton.joints() {
        found.push(skeleton.parent(joint).and_then(|parent| of(parent).or(found[parent.get()])));
    }
    found
}

impl Proposal {
    /// The map in the form of files, with names where they say which joint is meant.
    pub fn to_map(&self, model: &Asset, motion: &Asset) -> JointMap {
        let (targets, sources) = (by_name(&model.skeleton, str::to_owned), by_name(&motion.skeleton, str::to_owned));
        let is_clear = |names: &BTreeMap<String, Vec<JointIndex>>, name: &str| {
            !name.starts_with('#') && names.get(name).is_some_and(|joints| joints.len() == 1)
        };
        let mut map = JointMap::default();
        for pair in &self.pairs {
            let (target, source) = (model.skeleton.name(pair.target), motion.skeleton.name(pair.source));
            let key = if is_clear(&targets, target) {
                target.to_owned()
            } else {
                format!("#{}", model.skeleton.source_index(pair.target))
            };
            let source = if is_clear(&sources, source) {
                SourceRef::Name(source.to_owned())
            } else {
                SourceRef::Number(motion.skeleton.source_index(pair.source))
            };
            let entry = MapEntry { source: Some(source), correction: glam::Quat::IDENTITY, unmapped: None };
            map.joints.insert(key, entry);
        }
        map
    }
}
