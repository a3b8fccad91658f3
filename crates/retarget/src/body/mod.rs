//! A body as a value: the chains that its joints form, the twist joints beside or inside its limbs, and the helpers that follow a
//! joint. It is derived from the humanoid slots, the hierarchy and the rest; names only tell helpers apart, and tails and ears.
//! Recognizing slots is left to `recognize`, using the chains to `transfer`.

mod appendages;
mod chains;
mod followers;
mod twist;

use gaitway_character::anim::{JointIndex, Skeleton};
use gaitway_character::asset::{Asset, Humanoid, Side, Slot};
use glam::{DQuat, DVec3};

use super::pose::{WorldPose, ancestry, is_within, node_locals};
use super::skin::moves_skin;

pub(crate) use chains::shares;
pub use followers::Follower;
pub use twist::{Segment, TwistJoint};

/// The joints of a body by what they do together; empty without humanoid slots.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Anatomy {
    /// The chains, each at most once.
    pub chains: Vec<Chain>,
    /// Joints that take a share of the turn of a limb about its own axis, by segment, from its root to its tip.
    pub twists: Vec<TwistJoint>,
    /// Joints beside the body that belong to one of its joints.
    pub followers: Vec<Follower>,
    /// The segments of limbs that have both ends, with the joints of these.
    pub segments: Vec<(Segment, [JointIndex; 2])>,
}

/// Joints from root to tip, each the parent or an ancestor of the next.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// What the chain is.
    pub part: ChainPart,
    /// The joint that carries the chain.
    pub carrier: JointIndex,
    /// From root to tip.
    pub joints: Vec<ChainJoint>,
}

/// A joint of a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChainJoint {
    /// The joint.
    pub joint: JointIndex,
    /// Its share of the chain's length; shares add up to 1. Half of what lies between two joints belongs to each.
    pub share: f64,
    /// Its distance from the carrier, along the chain.
    pub along: f64,
}

/// A chain of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ChainPart {
    /// Above the hips, up to the joint that carries neck and arms.
    Trunk,
    /// Above the trunk, without the head.
    Neck,
    /// From the shoulder girdle to the hand, without twist joints.
    Arm(Side),
    /// From the thigh to the toes, without twist joints.
    Leg(Side),
    /// A finger, 0 (the thumb) to 4: its phalanges, and the thumb's metacarpal.
    Finger(Side, u8),
    /// A tail, which hangs on the hips or the lowest joint of the spine and is named so.
    Tail,
    /// An ear, which hangs on the head and is named so.
    Ear(Side),
}

impl ChainPart {
    /// Whether its joints share one curve. Those of arms and legs are hinges of their own.
    pub fn bends_as_one(self) -> bool {
        !matches!(self, Self::Arm(_) | Self::Leg(_))
    }

    /// Whether its joints have no slots.
    pub fn is_appendage(self) -> bool {
        matches!(self, Self::Tail | Self::Ear(_))
    }
}

impl Anatomy {
    /// Derives the chains of an asset from its humanoid slots.
    pub fn new(asset: &Asset, slots: &Humanoid) -> Self {
        if slots.0.is_empty() {
            return Self::default();
        }
        let form = Form::new(asset, slots);
        let segments = twist::segments(&form);
        let twists = twist::find(&form, &segments);
        Self { chains: chains::find(&form, &twists), twists, followers: followers::find(&form), segments }
    }

    /// Returns a chain.
    pub fn chain(&self, part: ChainPart) -> Option<&Chain> {
        self.chains.iter().find(|chain| chain.part == part)
    }

    /// Returns the joints that a segment begins and ends with.
    pub fn ends_of(&self, segment: Segment) -> Option<[JointIndex; 2]> {
        self.segments.iter().find(|(other, _)| *other == segment).map(|(_, ends)| *ends)
    }

    /// Returns the twist joints of a segment, from its root to its tip.
    pub fn twists_of(&self, segment: Segment) -> impl Iterator<Item = &TwistJoint> {
        self.twists.iter().filter(move |twist| twist.segment == segment)
    }
}

/// What the chains are derived from.
struct Form<'a> {
    skeleton: &'a Skeleton,
    slots: &'a Humanoid,
    /// The nodes' rest, in model space.
    rest: WorldPose,
    /// Which joints move skin; all of them without one.
    moves_skin: Vec<bool>,
    /// Which joints have a slot or carry one that has.
    carries_slot: Vec<bool>,
}

impl<'a> Form<'a> {
    fn new(asset: &'a Asset, slots: &'a Humanoid) -> Self {
        let skeleton = &asset.skeleton;
        let moves_skin = moves_skin(asset).unwrap_or_else(|| vec![true; skeleton.len()]);
        let rest = WorldPose::new(skeleton, node_locals(skeleton), DQuat::IDENTITY);
        let mut carries_slot = vec![false; skeleton.len()];
        for &joint in slots.0.values() {
            ancestry(skeleton, joint).for_each(|above| carries_slot[above.get()] = true);
        }
        Self { skeleton, slots, rest, moves_skin, carries_slot }
    }

    fn position(&self, joint: JointIndex) -> DVec3 {
        self.rest.position(joint)
    }

    fn distance(&self, a: JointIndex, b: JointIndex) -> f64 {
        self.position(a).distance(self.position(b))
    }

    /// The joints from `above` (excluded) down to `below` (included); `None` if `below` isn't a descendant.
    fn path(&self, above: JointIndex, below: JointIndex) -> Option<Vec<JointIndex>> {
        if above == below || !is_within(self.skeleton, below, above) {
            return None;
        }
        let mut path: Vec<JointIndex> = ancestry(self.skeleton, below).take_while(|&joint| joint != above).collect();
        path.reverse();
        Some(path)
    }

    fn is_slot(&self, joint: JointIndex) -> bool {
        self.slots.slot(joint).is_some()
    }
}

/// The slot on a side, from that of the left one.
fn on(side: Side, left: Slot) -> Slot {
    if side == Side::Left { left } else { left.mirrored() }
}
