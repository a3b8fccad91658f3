//! The bodies of source and target as solids, part by part, with points on their limbs at corresponding places.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use super::solid::{Place, Solid};
use crate::anim::{JointIndex, Skeleton};
use crate::asset::{Asset, Humanoid, Slot};
use crate::retarget::map::Pair;
use crate::retarget::pose::{WorldPose, ancestry, is_within};
use crate::retarget::transfer::Transfer;

/// Parts of one region don't touch each other: they are neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Region {
    Trunk,
    LeftArm,
    RightArm,
    LeftLeg,
    RightLeg,
}

impl Region {
    /// 0 for the left arm, 1 for the right one.
    pub fn arm(self) -> Option<usize> {
        match self {
            Self::LeftArm => Some(0),
            Self::RightArm => Some(1),
            _ => None,
        }
    }

    fn is_leg(self) -> bool {
        matches!(self, Self::LeftLeg | Self::RightLeg)
    }
}

/// One kind of body part. Lengths are shares of the body's height.
struct Kind {
    slot: Slot,
    region: Region,
    /// The axis leads to the first of these that is mapped.
    ends: &'static [Slot],
    /// Without a mesh: radii to the front and to the side, and how far the part extends beyond both of its ends.
    radii: [f64; 2],
    beyond: [f64; 2],
    /// How far points on it move if the end of its limb does, at the part's beginning and at its end. `None` for parts without
    /// points.
    levers: Option<[f64; 2]>,
}

const fn kind(
    slot: Slot,
    region: Region,
    ends: &'static [Slot],
    radii: [f64; 2],
    beyond: [f64; 2],
    levers: Option<[f64; 2]>,
) -> Kind {
    Kind { slot, region, ends, radii, beyond, levers }
}

/// Body parts with the proportions of an adult.
const KINDS: [Kind; 17] = {
    use Region::{LeftArm, LeftLeg, RightArm, RightLeg, Trunk};
    use Slot::*;
    const NECK: &[Slot] = &[Neck, Head];
    const ELBOW: Option<[f64; 2]> = Some([0.5, 1.0]);
    const END: Option<[f64; 2]> = Some([1.0, 1.0]);
    [
        kind(Hips, Trunk, &[Spine, Chest, UpperChest, Neck, Head], [0.07, 0.1], [0.06, 0.0], None),
        kind(Spine, Trunk, &[Chest, UpperChest, Neck, Head], [0.065, 0.085], [0.0, 0.0], None),
        kind(Chest, Trunk, &[UpperChest, Neck, Head], [0.07, 0.1], [0.0, 0.0], None),
        kind(UpperChest, Trunk, NECK, [0.065, 0.1], [0.0, 0.0], None),
        kind(Head, Trunk, &[], [0.06, 0.048], [0.0, 0.1], None),
        kind(LeftUpperArm, LeftArm, &[LeftLowerArm], [0.028, 0.028], [0.0, 0.0], None),
        kind(LeftLowerArm, LeftArm, &[LeftHand], [0.023, 0.023], [0.0, 0.0], ELBOW),
        kind(LeftHand, LeftArm, &[LeftMiddleProximal], [0.02, 0.02], [0.0, 0.05], END),
        kind(RightUpperArm, RightArm, &[RightLowerArm], [0.028, 0.028], [0.0, 0.0], None),
        kind(RightLowerArm, RightArm, &[RightHand], [0.023, 0.023], [0.0, 0.0], ELBOW),
        kind(RightHand, RightArm, &[RightMiddleProximal], [0.02, 0.02], [0.0, 0.05], END),
        kind(LeftUpperLeg, LeftLeg, &[LeftLowerLeg], [0.045, 0.045], [0.0, 0.0], None),
        kind(LeftLowerLeg, LeftLeg, &[LeftFoot], [0.03, 0.03], [0.0, 0.0], ELBOW),
        kind(LeftFoot, LeftLeg, &[LeftToes], [0.025, 0.025], [0.03, 0.04], END),
        kind(RightUpperLeg, RightLeg, &[RightLowerLeg], [0.045, 0.045], [0.0, 0.0], None),
        kind(RightLowerLeg, RightLeg, &[RightFoot], [0.03, 0.03], [0.0, 0.0], ELBOW),
        kind(RightFoot, RightLeg, &[RightToes], [0.025, 0.025], [0.03, 0.04], END),
    ]
};

/// Length of a part without an end, as a share of the body's height.
const ENDLESS: f64 = 0.05;

/// Points on each part of a limb: heights along its axis and directions about it.
const RINGS: usize = 4;
const SECTORS: usize = 6;
pub const POINTS: usize = RINGS * SECTORS;

/// At most about this many vertices of a body are looked at.
const MAX_VERTICES: usize = 6000;

/// Where the parts of a body are: the positions of their joints, and their rotations away from the aligned rest.
pub type Frames = Vec<(DVec3, DQuat)>;

/// One side of the retarget. All lists are by part.
#[derive(Debug)]
pub struct Body {
    pub joints: Vec<JointIndex>,
    solids: Vec<Solid>,
    /// Rotations of the joints at the aligned rest.
    rest: Vec<DQuat>,
    /// Points of the limbs' parts, relative to their joints at the aligned rest.
    points: Vec<[DVec3; POINTS]>,
    /// Whether any solid is fitted to vertices.
    pub has_mesh: bool,
    /// From the lowest to the highest mapped joint, in the body's own unit.
    pub height: f64,
}

impl Body {
    pub fn frames(&self, pose: &WorldPose) -> Frames {
        let frame =
            |(&joint, &rest): (&JointIndex, &DQuat)| (pose.position(joint), pose.rotation(joint) * rest.conjugate());
        self.joints.iter().zip(&self.rest).map(frame).collect()
    }

    /// Where a point of a limb is.
    pub fn point(&self, part: usize, point: usize, frames: &Frames) -> DVec3 {
        let (position, turn) = frames[part];
        position + turn * self.points[part][point]
    }

    pub fn surface(&self, part: usize, place: Place, frames: &Frames) -> DVec3 {
        let (position, turn) = frames[part];
        position + turn * self.solids[part].surface(place)
    }

    /// The direction away from a part's axis.
    pub fn outward(&self, part: usize, place: Place, frames: &Frames) -> DVec3 {
        frames[part].1 * self.solids[part].outward(place)
    }
}

/// A limb's part and another that it may touch: arms touch everything but themselves, legs only each other.
#[derive(Debug)]
pub struct PartPair {
    pub limb: usize,
    pub other: usize,
    /// Whether the limb's part is a hand: what hands touch is kept.
    pub is_hand: bool,
    /// How deep the limb's points are in the other part on the target at rest.
    pub at_rest: [f64; POINTS],
}

/// A point of a limb near or inside another part.
#[derive(Debug, Clone, Copy)]
pub struct Meeting {
    /// Index into [`Bodies::pairs`].
    pub pair: usize,
    pub point: usize,
    /// From the point to the other part's surface; negative inside.
    pub distance: f64,
    /// The nearest place on the other part.
    pub place: Place,
}

/// Source and target with the same parts.
#[derive(Debug)]
pub struct Bodies {
    pub source: Body,
    pub target: Body,
    /// By part.
    pub regions: Vec<Region>,
    /// How far each part moves if the end of its limb does, at its beginning and end.
    levers: Vec<[f64; 2]>,
    /// Number of points on each body's limbs.
    pub limb_points: u32,
    pub pairs: Vec<PartPair>,
}

impl Bodies {
    /// Returns `None` if no limb is mapped. `slots` are those of source and target.
    pub fn new(transfer: &Transfer, slots: [&Humanoid; 2]) -> Option<Self> {
        let alignment = transfer.alignment;
        let parts: Vec<Part> = KINDS.iter().filter_map(|kind| Part::new(kind, transfer)).collect();
        // The direction of angle 0 has to be the same for both bodies.
        let source_axis = |part: &Part| part.axis(&parts, &alignment.source, |pair| pair.source).0;
        let fronts: Vec<DVec3> =
            parts.iter().map(|part| if source_axis(part).z.abs() > 0.8 { DVec3::Y } else { DVec3::Z }).collect();
        let source = Side {
            asset: transfer.source,
            skeleton: transfer.tracks.skeleton,
            slots: slots[0],
            rest: &alignment.source,
            skinned: &alignment.source,
            joint: |pair| pair.source,
        };
        let target = Side {
            asset: transfer.target,
            skeleton: transfer.target_skeleton,
            slots: slots[1],
            rest: &alignment.target,
            skinned: &alignment.unaligned_target,
            joint: |pair| pair.target,
        };
        let [source, target] = [source, target].map(|side| side.body(transfer, &parts, &fronts));
        let regions: Vec<Region> = parts.iter().map(|part| part.kind.region).collect();
        // Upper arms turn about their beginning.
        let levers = parts.iter().map(|part| part.kind.levers.unwrap_or([0.0, 0.5])).collect();
        let mut limb_points = 0;
        let mut pairs = Vec::new();
        for (limb, part) in parts.iter().enumerate().filter(|(_, part)| part.kind.levers.is_some()) {
            limb_points += POINTS as u32;
            let is_hand = matches!(part.kind.slot, Slot::LeftHand | Slot::RightHand);
            for (other, &region) in regions.iter().enumerate() {
                let own = part.kind.region;
                if own != region && (!own.is_leg() || region.is_leg()) {
                    pairs.push(PartPair { limb, other, is_hand, at_rest: [0.0; POINTS] });
                }
            }
        }
        let mut bodies = Self { source, target, regions, levers, limb_points, pairs };
        let rest = bodies.target.frames(&alignment.unaligned_target);
        for meeting in bodies.meetings(&bodies.target, &rest, 0.0) {
            bodies.pairs[meeting.pair].at_rest[meeting.point] = -meeting.distance;
        }
        (!bodies.pairs.is_empty()).then_some(bodies)
    }

    /// How far a place on a part moves if the end of its limb does, as a share.
    pub fn lever(&self, part: usize, share: f64) -> f64 {
        let [from, to] = self.levers[part];
        from + share * (to - from)
    }

    /// Finds the points of limbs that are inside other parts of the same body or at most `reach` away, pair by pair.
    pub fn meetings(&self, body: &Body, frames: &Frames, reach: f64) -> Vec<Meeting> {
        let spheres: Vec<(DVec3, f64)> =
            body.solids.iter().zip(frames).map(|(solid, &(at, turn))| (at + turn * solid.center, solid.bound)).collect();
        let mut meetings = Vec::new();
        for (index, pair) in self.pairs.iter().enumerate() {
            let ((center, bound), (other_center, other_bound)) = (spheres[pair.limb], spheres[pair.other]);
            if center.distance(other_center) > bound + other_bound + reach {
                continue;
            }
            let (origin, turn) = frames[pair.other];
            for point in 0..POINTS {
                let position = turn.conjugate() * (body.point(pair.limb, point, frames) - origin);
                if let Some((distance, place)) = body.solids[pair.other].locate(position, reach) {
                    meetings.push(Meeting { pair: index, point, distance, place });
                }
            }
        }
        meetings
    }
}

/// Where a point of a limb is on the surface of its part.
pub fn place_of(point: usize) -> Place {
    let share = ((point / SECTORS) as f64 + 0.5) / RINGS as f64;
    Place { share, angle: TAU * (point % SECTORS) as f64 / SECTORS as f64 }
}

/// A mapped body part.
struct Part<'a> {
    kind: &'static Kind,
    pair: &'a Pair,
    /// What its axis leads to.
    end: Option<&'a Pair>,
}

impl<'a> Part<'a> {
    fn new(kind: &'static Kind, transfer: &Transfer<'a>) -> Option<Self> {
        let end = kind.ends.iter().find_map(|&slot| transfer.pair(slot));
        Some(Self { kind, pair: transfer.pair(kind.slot)?, end })
    }

    /// The axis at rest, and its length. Heads go up, feet forward, and hands on along their arm.
    fn axis(&self, parts: &[Part], rest: &WorldPose, joint: fn(&Pair) -> JointIndex) -> (DVec3, f64) {
        let start = rest.position(joint(self.pair));
        let to_end = self.end.map_or(DVec3::ZERO, |end| rest.position(joint(end)) - start);
        if let Some(axis) = to_end.try_normalize() {
            return (axis, to_end.length());
        }
        let arm = parts.iter().find(|part| self.kind.region.arm().is_some() && part.kind.ends.contains(&self.kind.slot));
        let axis = match arm {
            Some(before) => start - rest.position(joint(before.pair)),
            None if self.kind.region == Region::Trunk => DVec3::Y,
            None => DVec3::Z,
        };
        (axis.normalize_or(DVec3::Y), 0.0)
    }
}

/// What the body of one side is made from.
struct Side<'a> {
    asset: &'a Asset,
    skeleton: &'a Skeleton,
    slots: &'a Humanoid,
    /// The aligned rest.
    rest: &'a WorldPose,
    /// The rest in which the mesh is measured.
    skinned: &'a WorldPose,
    joint: fn(&Pair) -> JointIndex,
}

impl Side<'_> {
    fn body(&self, transfer: &Transfer, parts: &[Part], fronts: &[DVec3]) -> Body {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for pair in &transfer.map.pairs {
            let y = self.rest.position((self.joint)(pair)).y;
            (low, high) = (low.min(y), high.max(y));
        }
        let height = (high - low).max(1e-9);
        let joints: Vec<JointIndex> = parts.iter().map(|part| (self.joint)(part.pair)).collect();
        let vertices = self.vertices(transfer, parts, &joints);
        let mut body =
            Body { joints, solids: Vec::new(), rest: Vec::new(), points: Vec::new(), has_mesh: false, height };
        for ((part, vertices), &front) in parts.iter().zip(&vertices).zip(fronts) {
            let (axis, length) = part.axis(parts, self.rest, self.joint);
            let turn = self.rest.rotation((self.joint)(part.pair));
            let fitted = Solid::around(&vertices.iter().map(|&vertex| turn * vertex).collect::<Vec<_>>(), axis, front);
            body.has_mesh |= fitted.is_some();
            let kind = part.kind;
            let solid = fitted.unwrap_or_else(|| {
                let to = length.max(ENDLESS * height) + kind.beyond[1] * height;
                Solid::elliptic(axis, front, [-kind.beyond[0] * height, to], kind.radii.map(|radius| radius * height))
            });
            body.points.push(std::array::from_fn(|point| solid.surface(place_of(point))));
            body.solids.push(solid);
            body.rest.push(turn);
        }
        body
    }

    /// Returns the vertices that follow each part's joint or what hangs on it, relative to the joint as it is turned.
    fn vertices(&self, transfer: &Transfer, parts: &[Part], joints: &[JointIndex]) -> Vec<Vec<DVec3>> {
        // How weights divide a trunk differs between models, so its vertices are divided at the joints.
        let is_trunk = |part: usize| parts[part].kind.region == Region::Trunk && parts[part].kind.slot != Slot::Head;
        let trunk: Vec<(usize, DVec3, DVec3)> = (0..parts.len())
            .filter(|&part| is_trunk(part) && super::t("TRUNK",1.0)==1.0)
            .map(|part| (part, self.skinned.position(joints[part]), parts[part].axis(parts, self.skinned, self.joint).0))
            .collect();
        let part_of: Vec<Option<usize>> = self.skeleton.joints().map(|joint| self.part_of(joint, joints)).collect();
        let is_mapped = |joint| transfer.map.pairs.iter().any(|pair| (self.joint)(pair) == joint);
        let frame = |joint: JointIndex| {
            self.skinned.parent_frame(self.skeleton, joint) * self.skinned.locals[joint.get()].to_affine()
        };
        let frames: Vec<_> = self.skeleton.joints().map(frame).collect();
        let mut total = 0;
        for instance in &self.asset.instances {
            total += self.asset.meshes[instance.mesh].primitives.iter().map(|part| part.positions.len()).sum::<usize>();
        }
        let step = total.div_ceil(MAX_VERTICES).max(1);
        let mut vertices = vec![Vec::new(); joints.len()];
        for instance in &self.asset.instances {
            let skin = instance.skin.map(|skin| &self.asset.skins[skin]);
            // Unskinned meshes below joints of their own are things that a character carries.
            if skin.is_none() && !is_mapped(instance.joint) {
                continue;
            }
            for geometry in &self.asset.meshes[instance.mesh].primitives {
                for (vertex, &position) in geometry.positions.iter().enumerate().step_by(step) {
                    let (joint, position) = match skin {
                        None => (instance.joint, instance.joint_from_mesh.transform_point3(position)),
                        Some(_) if geometry.influences.is_empty() => continue,
                        Some(skin) => {
                            let strongest = geometry.influences.of_vertex(vertex).max_by(|a, b| a.1.total_cmp(&b.1));
                            let index = usize::from(strongest.map_or(0, |(joint, _)| joint));
                            (skin.joints()[index], skin.joint_from_bind()[index].transform_point3(position))
                        }
                    };
                    if let Some(part) = part_of[joint.get()] {
                        let point = frames[joint.get()].transform_point3(position.as_dvec3());
                        let is_above = |&&(_, start, axis): &&(usize, DVec3, DVec3)| (point - start).dot(axis) >= 0.0;
                        let part = match trunk.first().filter(|_| is_trunk(part)) {
                            Some(lowest) => trunk.iter().rev().find(is_above).unwrap_or(lowest).0,
                            None => part,
                        };
                        let top = joints[part];
                        vertices[part].push(self.skinned.rotation(top).conjugate() * (point - self.skinned.position(top)));
                    }
                }
            }
        }
        vertices
    }

    /// The part that a joint belongs to. If a hand has fingers, whatever else hangs on it is something that the character holds.
    fn part_of(&self, joint: JointIndex, joints: &[JointIndex]) -> Option<usize> {
        let (top, part) = ancestry(self.skeleton, joint)
            .find_map(|top| Some((top, joints.iter().position(|&other| other == top)?)))?;
        let is_hand = matches!(self.slots.slot(top), Some(Slot::LeftHand | Slot::RightHand));
        let is_finger = |joint: JointIndex| joint != top && self.slots.slot(joint).is_some();
        let has_fingers = || self.slots.0.values().any(|&finger| is_within(self.skeleton, finger, top) && finger != top);
        let is_held = is_hand
            && joint != top
            && has_fingers()
            && !ancestry(self.skeleton, joint).take_while(|&above| above != top).any(is_finger);
        (!is_held).then_some(part)
    }
}
