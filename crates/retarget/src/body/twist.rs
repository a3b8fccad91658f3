//! Finds twist joints: joints on the line between the ends of a limb's segment. Those inside the chain lie between its joints, the
//! others are leaves beside it. A name that says twist or roll allows them to be further off that line.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::Slot;
use gaitway_character::sort::sort_by;

use super::Form;
use crate::recognize::Name;

/// A part of a limb that turns about its own axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Segment {
    /// The joint that it begins with.
    pub from: Slot,
    /// The joint that it ends with.
    pub to: Slot,
    /// Whether the turn enters at the root, which is that of an upper arm or a thigh; otherwise at the tip.
    pub is_upper: bool,
}

/// A joint that takes a share of the turn of a limb's segment about its axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwistJoint {
    /// The joint.
    pub joint: JointIndex,
    /// The segment it belongs to.
    pub segment: Segment,
    /// Its place, from 0 (the segment's root) to 1 (its tip).
    pub along: f64,
    /// Whether the tip hangs on it.
    pub in_chain: bool,
}

impl Segment {
    const fn new(from: Slot, to: Slot, is_upper: bool) -> Self {
        Self { from, to, is_upper }
    }

    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::new(Slot::LeftUpperArm, Slot::LeftLowerArm, true),
        Self::new(Slot::LeftLowerArm, Slot::LeftHand, false),
        Self::new(Slot::RightUpperArm, Slot::RightLowerArm, true),
        Self::new(Slot::RightLowerArm, Slot::RightHand, false),
        Self::new(Slot::LeftUpperLeg, Slot::LeftLowerLeg, true),
        Self::new(Slot::LeftLowerLeg, Slot::LeftFoot, false),
        Self::new(Slot::RightUpperLeg, Slot::RightLowerLeg, true),
        Self::new(Slot::RightLowerLeg, Slot::RightFoot, false),
    ];
}

/// Maximum distance of a twist joint from the line, as a share of the segment's length: with a name that says so, and without.
const MAX_NAMED_OFFSET: f64 = 0.25;
const MAX_OFFSET: f64 = 0.03;

/// Where a leaf without such a name may lie: closer to the ends it may be a helper of an elbow or a knee.
const UNNAMED_RANGE: std::ops::RangeInclusive<f64> = 0.15..=0.92;

/// Where any twist joint may lie.
const NAMED_RANGE: std::ops::RangeInclusive<f64> = -0.05..=1.05;

/// Maximum number of joints inside a segment, and of leaves beside it: rigs have a few, damaged files may have thousands.
const MAX_TWISTS: usize = 64;

/// Returns the segments of a body whose end hangs below their root, with both joints.
pub fn segments(form: &Form) -> Vec<(Segment, [JointIndex; 2])> {
    let ends = |segment: Segment| {
        let ends = [form.slots.joint(segment.from)?, form.slots.joint(segment.to)?];
        form.path(ends[0], ends[1]).map(|_| (segment, ends))
    };
    Segment::ALL.into_iter().filter_map(ends).collect()
}

pub fn find(form: &Form, segments: &[(Segment, [JointIndex; 2])]) -> Vec<TwistJoint> {
    segments.iter().flat_map(|&(segment, ends)| of_segment(form, segment, ends).unwrap_or_default()).collect()
}

/// `None` for a limb with more segments than these, whose joints in between aren't on the line.
fn of_segment(form: &Form, segment: Segment, ends: [JointIndex; 2]) -> Option<Vec<TwistJoint>> {
    let [from, to] = ends;
    let twist = |joint: JointIndex, in_chain: bool| {
        let along = placed(form, ends, joint)?.clamp(0.0, 1.0);
        Some(TwistJoint { joint, segment, along, in_chain })
    };
    let path = form.path(from, to).filter(|path| path.len() <= MAX_TWISTS)?;
    let inside = path.iter().filter(|&&joint| joint != to).map(|&joint| twist(joint, true));
    let inside = inside.collect::<Option<Vec<_>>>()?;
    let mut leaves: Vec<TwistJoint> = Vec::new();
    for joint in form.skeleton.joints().filter(|&joint| form.moves_skin[joint.get()] && !form.is_slot(joint)) {
        let parent = form.skeleton.parent(joint);
        let is_beside = parent == Some(from) || leaves.iter().any(|leaf| parent == Some(leaf.joint));
        if is_beside && !form.carries_slot[joint.get()] && leaves.len() < MAX_TWISTS && !path.contains(&joint) {
            leaves.extend(twist(joint, false));
        }
    }
    sort_by(&mut leaves, |a, b| a.along.total_cmp(&b.along));
    Some(inside.into_iter().chain(leaves).collect())
}

/// Where a joint lies between the ends of a segment, if it may be a twist joint.
fn placed(form: &Form, [from, to]: [JointIndex; 2], joint: JointIndex) -> Option<f64> {
    let (start, line) = (form.position(from), form.position(to) - form.position(from));
    let length = line.length();
    let reach = form.position(joint) - start;
    let along = reach.dot(line) / line.length_squared();
    let offset = (reach - line * along).length() / length;
    let name = Name::read(form.skeleton.name(joint));
    let is_named = name.has("twist") || name.has("roll");
    let (max_offset, range) = if is_named { (MAX_NAMED_OFFSET, NAMED_RANGE) } else { (MAX_OFFSET, UNNAMED_RANGE) };
    (offset <= max_offset && range.contains(&along)).then_some(along)
}
