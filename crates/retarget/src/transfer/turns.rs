//! Whose rotation each target joint takes: that of its source in the map or, where chains share, that of the source's chain at the end
//! of the joint's own share.
//!
//! A chain bends where its joints are, but stands for a curve. The orientation along the source's chain is a function of the share of
//! its length, from that of the joint which carries it (0) to that of its last joint (1), interpolated between the ends of the shares
//! of its joints.

use gaitway_character::anim::JointIndex;
use gaitway_character::sort::sort_by;
use glam::DQuat;

use crate::body::{Anatomy, Chain, ChainJoint, ChainPart, Segment, shares};
use crate::keys::tracks::SourceTracks;
use crate::map::{Chains, ResolvedMap};
use crate::math::slerp;

/// The rotation away from the aligned rest that a target joint takes from its source: on the way from one joint's to another's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    from: JointIndex,
    to: JointIndex,
    share: f64,
}

/// Shares closer than this to an end are there.
const MIN_SHARE: f64 = 1e-6;

impl Turn {
    /// The whole turn of one joint.
    pub const fn whole(joint: JointIndex) -> Self {
        Self { from: joint, to: joint, share: 1.0 }
    }

    fn between(from: JointIndex, to: JointIndex, share: f64) -> Self {
        match share {
            share if share < MIN_SHARE => Self::whole(from),
            share if share > 1.0 - MIN_SHARE => Self::whole(to),
            _ => Self { from, to, share },
        }
    }

    /// Returns the joint, if the turn is that of a single one.
    pub fn joint(self) -> Option<JointIndex> {
        (self.from == self.to).then_some(self.to)
    }

    /// Returns the joints that the turn depends on.
    pub fn joints(self) -> impl Iterator<Item = JointIndex> {
        [self.from, self.to].into_iter().take(if self.from == self.to { 1 } else { 2 })
    }

    /// Returns the rotation, from those of the source's joints.
    pub fn at(self, mut of: impl FnMut(JointIndex) -> DQuat) -> DQuat {
        match self.joint() {
            Some(joint) => of(joint),
            None => slerp(of(self.from), of(self.to), self.share),
        }
    }
}

/// The turns of all target joints that have one.
#[derive(Debug, Default)]
pub struct Turns {
    /// By target joint.
    turns: Vec<Option<Turn>>,
    /// Joints without a source in the map, ascending.
    unpaired: Vec<JointIndex>,
}

impl Turns {
    /// `anatomies` are those of the source and the target, `joints` the number of the target's joints.
    pub fn new(map: &ResolvedMap, tracks: &SourceTracks, [source, target]: [&Anatomy; 2], joints: usize) -> Self {
        let mut turns = Self { turns: vec![None; joints], unpaired: Vec::new() };
        for pair in &map.pairs {
            turns.turns[pair.target.get()] = Some(Turn::whole(pair.source));
        }
        if map.chains == Chains::Share {
            for chain in target.chains.iter().filter(|chain| chain.part.bends_as_one()) {
                if let Some(source) = source.chain(chain.part) {
                    turns.share(map, &bending(source, map, tracks), chain);
                }
            }
            Segment::ALL.into_iter().for_each(|segment| turns.take_twist(map, source, target, segment));
            sort_by(&mut turns.unpaired, Ord::cmp);
        }
        turns
    }

    /// Returns the turn of a target joint; `None` if it rests.
    pub fn of(&self, target: JointIndex) -> Option<Turn> {
        self.turns[target.get()]
    }

    /// Returns the joints that turn without a source in the map, ascending.
    pub fn unpaired(&self) -> &[JointIndex] {
        &self.unpaired
    }

    /// Shares the bend of a source's chain, unless its joints are mapped one to one.
    fn share(&mut self, map: &ResolvedMap, source: &Chain, target: &Chain) {
        let place = |joint: JointIndex| source.joints.iter().position(|other| other.joint == joint);
        let mapped: Option<Vec<(usize, usize)>> = (0..)
            .zip(&target.joints)
            .filter_map(|(at, joint)| Some((at, map.source_of(joint.joint)?)))
            .map(|(at, source)| Some((at, place(source)?)))
            .collect();
        // A joint that follows another part of the body means that the map does something else on purpose.
        let Some(mapped) = mapped.filter(|mapped| mapped.windows(2).all(|pair| pair[0].1 < pair[1].1)) else { return };
        let last = mapped.last().copied();
        // Tails and ears have no slots: a map pairs them by names, if at all.
        let Some((mut target_end, mut source_end)) = last.or(target.part.is_appendage().then_some((0, 0))) else {
            return;
        };
        if source.joints.is_empty() {
            return;
        }
        // Only a neck's first joint has a slot, and a trunk of one joint is mapped to the lowest of several; but all of them bend. A
        // finger without its tip is as short as the motion's.
        if target.part == ChainPart::Neck || target.part.is_appendage() {
            source_end = source.joints.len() - 1;
        }
        if source_end + 1 == source.joints.len() && !matches!(target.part, ChainPart::Finger(..)) {
            target_end += target.joints[target_end + 1..].iter().take_while(|joint| is_free(map, joint.joint)).count();
        }
        let (targets, sources) = (&target.joints[..=target_end], &source.joints[..=source_end]);
        let is_one_to_one = targets.len() == sources.len() && mapped.iter().all(|(target, source)| target == source);
        let turns: Vec<Turn> = if is_one_to_one {
            sources.iter().map(|source| Turn::whole(source.joint)).collect()
        } else if target.part == ChainPart::Neck && targets.len() == 1 {
            // A single joint doesn't bend: it points where the motion's neck does on average, and the head does the rest.
            vec![turn_at(source.carrier, sources, mean_end(sources))]
        } else {
            ends(targets).map(|end| turn_at(source.carrier, sources, end)).collect()
        };
        for (joint, turn) in targets.iter().zip(turns) {
            self.set(map, joint.joint, turn);
        }
    }

    /// Gives an upper arm or a thigh the turn of the source's twist joints, without which elbow and knee would turn against it.
    fn take_twist(&mut self, map: &ResolvedMap, source: &Anatomy, target: &Anatomy, segment: Segment) {
        let follows = |joint: JointIndex| map.pairs.iter().any(|pair| pair.source == joint);
        let Some(twist) = source.twists_of(segment).filter(|twist| twist.in_chain).last() else { return };
        let Some([joint, _]) = target.ends_of(segment).filter(|_| segment.is_upper && !follows(twist.joint)) else {
            return;
        };
        if self.turns[joint.get()] == source.ends_of(segment).map(|[joint, _]| Turn::whole(joint)) {
            self.set(map, joint, Turn::whole(twist.joint));
        }
    }

    /// Does nothing to a joint that rests or plays a clip of the model's on purpose.
    fn set(&mut self, map: &ResolvedMap, joint: JointIndex, turn: Turn) {
        let turns = &mut self.turns[joint.get()];
        if turns.is_none() {
            if !is_free(map, joint) {
                return;
            }
            self.unpaired.push(joint);
        }
        *turns = Some(turn);
    }
}

/// Whether a map leaves a joint to its chain.
pub fn is_free(map: &ResolvedMap, joint: JointIndex) -> bool {
    map.source_of(joint).is_none()
        && map.without_source.binary_search(&joint).is_err()
        && map.layers.binary_search_by_key(&joint, |layer| layer.joint).is_err()
}

/// Returns a source's chain without joints that neither move nor have a counterpart, which would take a share of the bend.
fn bending(chain: &Chain, map: &ResolvedMap, tracks: &SourceTracks) -> Chain {
    let is_mapped = |joint: JointIndex| map.pairs.iter().any(|pair| pair.source == joint);
    let is_part = |joint: &&ChainJoint| is_mapped(joint.joint) || tracks.rotations[joint.joint.get()].is_moving();
    let mut joints: Vec<ChainJoint> = chain.joints.iter().filter(is_part).copied().collect();
    let shares = shares(&joints.iter().map(|joint| joint.along).collect::<Vec<f64>>());
    joints.iter_mut().zip(shares).for_each(|(joint, share)| joint.share = share);
    Chain { joints, ..*chain }
}

/// The ends of the joints' shares of their chain, from 0 to 1.
fn ends(joints: &[ChainJoint]) -> impl Iterator<Item = f64> {
    let whole: f64 = joints.iter().map(|joint| joint.share).sum();
    joints.iter().scan(0.0, move |end, joint| {
        *end += joint.share / whole;
        Some(*end)
    })
}

/// Where the orientation along an evenly bent chain is that of its joints on average, each weighted by its share.
fn mean_end(joints: &[ChainJoint]) -> f64 {
    let whole: f64 = joints.iter().map(|joint| joint.share).sum();
    joints.iter().zip(ends(joints)).map(|(joint, end)| joint.share / whole * end).sum()
}

/// The orientation of a source's chain at a share of its length.
fn turn_at(carrier: JointIndex, joints: &[ChainJoint], share: f64) -> Turn {
    let (mut from, mut start) = (carrier, 0.0);
    for (joint, end) in joints.iter().zip(ends(joints)) {
        if share <= end + MIN_SHARE {
            return Turn::between(from, joint.joint, (share - start) / (end - start).max(MIN_SHARE));
        }
        (from, start) = (joint.joint, end);
    }
    Turn::whole(from)
}
