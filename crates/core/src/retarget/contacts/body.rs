//! Both bodies as solids, part by part, and points on the limbs, which are at corresponding places of both.

use glam::{DQuat, DVec3};

use super::solid::{Place, Solid};
use crate::anim::{JointIndex, Skeleton};
use crate::asset::{Asset, MeshInstance, Slot};
use crate::retarget::map::Pair;
use crate::retarget::pose::{WorldPose, ancestry};
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
        [Self::LeftArm, Self::RightArm].iter().position(|&arm| arm == self)
    }

    fn is_leg(self) -> bool {
        matches!(self, Self::LeftLeg | Self::RightLeg)
    }

    /// Whether points of this limb may touch a part: arms touch everything but themselves, legs only each other.
    fn touches(self, other: Self) -> bool {
        self != other && (!self.is_leg() || other.is_leg())
    }
}

/// One kind of body part.
struct Kind {
    slot: Slot,
    region: Region,
    /// The axis leads to the first of these that is mapped; without one, as `without_end` says.
    ends: &'static [Slot],
    /// Without a mesh: radii to the front and to the side, and how far it extends beyond its ends, as shares of the body's height.
    radii: [f64; 2],
    beyond: [f64; 2],
    /// How far points move if their limb's end does: at the part's beginning and at its end. `None` for parts without points.
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

/// Points per part: heights along the axis and directions about it.
const POINT_RINGS: usize = 4;
const POINT_SECTORS: usize = 6;

/// At most about this many vertices of a body are looked at.
const MAX_VERTICES: usize = 6000;

/// A point on the surface of a limb.
#[derive(Debug, Clone, Copy)]
pub struct LimbPoint {
    /// Index of its part.
    pub part: usize,
    pub region: Region,
    place: Place,
    /// How far it moves if the end of its limb does, as a share.
    pub lever: f64,
    /// Whether it is on a hand: what hands touch is kept.
    pub is_hand: bool,
}

/// One side of the retarget. All lists are by part.
#[derive(Debug)]
pub struct Body {
    joints: Vec<JointIndex>,
    solids: Vec<Solid>,
    /// Rotations of the joints at the aligned rest.
    rest: Vec<DQuat>,
    /// Of limb points, relative to their part's joint at the aligned rest.
    points: Vec<DVec3>,
    /// Whether any solid is fitted to vertices.
    pub has_mesh: bool,
}

/// Where the parts of a body are: the positions of their joints, and their rotations away from the aligned rest.
pub type Frames = Vec<(DVec3, DQuat)>;

impl Body {
    pub fn frames(&self, pose: &WorldPose) -> Frames {
        let frame =
            |(&joint, &rest): (&JointIndex, &DQuat)| (pose.position(joint), pose.rotation(joint) * rest.conjugate());
        self.joints.iter().zip(&self.rest).map(frame).collect()
    }

    /// Where a limb point is.
    pub fn point(&self, index: usize, part: usize, frames: &Frames) -> DVec3 {
        let (position, turn) = frames[part];
        position + turn * self.points[index]
    }

    /// Returns how far a point is outside a part, and the nearest place on it; `None` if further away than `reach`.
    pub fn locate(&self, part: usize, frames: &Frames, point: DVec3, reach: f64) -> Option<(f64, Place)> {
        let (position, turn) = frames[part];
        self.solids[part].locate(turn.conjugate() * (point - position), reach)
    }

    pub fn surface(&self, part: usize, frames: &Frames, place: Place) -> DVec3 {
        let (position, turn) = frames[part];
        position + turn * self.solids[part].surface(place)
    }

    pub fn outward(&self, part: usize, frames: &Frames, place: Place) -> DVec3 {
        frames[part].1 * self.solids[part].outward(place)
    }
}

/// Source and target, part by part alike.
#[derive(Debug)]
pub struct Bodies {
    pub source: Body,
    pub target: Body,
    /// The region of each part.
    pub regions: Vec<Region>,
    /// How far each part moves if the end of its limb does, on average.
    pub levers: Vec<f64>,
    pub points: Vec<LimbPoint>,
    /// Parts that each point may touch, with how deep it is in them on the target at rest.
    pub others: Vec<Vec<(usize, f64)>>,
    /// Of source and target, each in its own units.
    pub heights: [f64; 2],
}

impl Bodies {
    /// Returns `None` if no limb is mapped.
    pub fn new(transfer: &Transfer) -> Option<Self> {
        let (aligned, unaligned) = (&transfer.alignment.target, &transfer.alignment.unaligned_target);
        let source_rest = &transfer.alignment.source;
        let mapped: Vec<(&Kind, &Pair)> =
            KINDS.iter().filter_map(|kind| Some((kind, transfer.pair(kind.slot)?))).collect();
        let end = |kind: &Kind| kind.ends.iter().find_map(|&slot| transfer.pair(slot));
        let height = |rest: &WorldPose, joint: fn(&Pair) -> JointIndex| {
            let heights = transfer.map.pairs.iter().map(|pair| rest.position(joint(pair)).y);
            let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), y| (a.min(y), b.max(y)));
            (high - low).max(1e-9)
        };
        // The direction of angle 0 has to be the same for both bodies.
        let fronts: Vec<DVec3> = mapped
            .iter()
            .map(|&(kind, pair)| {
                let axis =
                    axis(kind, pair.source, end(kind).map(|end| end.source), source_rest, &mapped, |p| p.source).0;
                if axis.z.abs() > 0.8 { DVec3::Y } else { DVec3::Z }
            })
            .collect();
        let side = |asset: &Asset, skeleton: &Skeleton, poses: [&WorldPose; 2], joint: fn(&Pair) -> JointIndex| {
            let [rest, meshed] = poses;
            let height = height(rest, joint);
            let joints: Vec<JointIndex> = mapped.iter().map(|(_, pair)| joint(pair)).collect();
            let is_mapped = |other: JointIndex| transfer.map.pairs.iter().any(|pair| joint(pair) == other);
            let vertices = vertices(asset, skeleton, meshed, &joints, is_mapped);
            let mut has_mesh = false;
            let solids = mapped.iter().zip(&vertices).zip(&fronts).map(|((&(kind, pair), vertices), &front)| {
                let (axis, length) = axis(kind, joint(pair), end(kind).map(joint), rest, &mapped, joint);
                let turn = rest.rotation(joint(pair));
                let points: Vec<DVec3> = vertices.iter().map(|&vertex| turn * vertex).collect();
                let solid = Solid::around(&points, axis, front);
                has_mesh |= solid.is_some();
                solid.unwrap_or_else(|| {
                    let extent = [-kind.beyond[0] * height, length.max(ENDLESS * height) + kind.beyond[1] * height];
                    Solid::elliptic(axis, front, extent, kind.radii.map(|radius| radius * height))
                })
            });
            let solids: Vec<Solid> = solids.collect();
            let rest = joints.iter().map(|&joint| rest.rotation(joint)).collect();
            (Body { joints, solids, rest, points: Vec::new(), has_mesh }, height)
        };
        let (mut source, height) =
            side(transfer.source, transfer.tracks.skeleton, [source_rest; 2], |pair| pair.source);
        let (mut target, target_height) =
            side(transfer.target, transfer.target_skeleton, [aligned, unaligned], |pair| pair.target);
        let points: Vec<LimbPoint> = mapped
            .iter()
            .enumerate()
            .filter_map(|(part, (kind, _))| Some((part, kind, kind.levers?)))
            .flat_map(|(part, kind, levers)| {
                points(part, kind.region, matches!(kind.slot, Slot::LeftHand | Slot::RightHand), levers)
            })
            .collect();
        for body in [&mut source, &mut target] {
            body.points = points.iter().map(|point| body.solids[point.part].surface(point.place)).collect();
        }
        let regions: Vec<Region> = mapped.iter().map(|(kind, _)| kind.region).collect();
        let levers = mapped.iter().map(|(kind, _)| match (kind.levers, kind.region) {
            (Some([from, to]), _) => 0.5 * (from + to),
            (None, Region::Trunk) => 0.0,
            (None, _) => 0.25,
        });
        let levers = levers.collect();
        let rest = target.frames(unaligned);
        let others = points.iter().enumerate().map(|(index, point)| {
            let others = (0..regions.len()).filter(|&part| point.region.touches(regions[part]));
            let position = target.point(index, point.part, &rest);
            let depth = |part| target.locate(part, &rest, position, 0.0).map_or(0.0, |(distance, _)| -distance);
            others.map(|part| (part, depth(part))).collect()
        });
        let others = others.collect();
        (!points.is_empty()).then_some(Self {
            source,
            target,
            regions,
            levers,
            points,
            others,
            heights: [height, target_height],
        })
    }
}

/// The axis of a part at rest, and its length. Heads go up, feet forward, and hands on along their arm.
fn axis(
    kind: &Kind,
    joint: JointIndex,
    end: Option<JointIndex>,
    rest: &WorldPose,
    mapped: &[(&Kind, &Pair)],
    joint_of: fn(&Pair) -> JointIndex,
) -> (DVec3, f64) {
    let to_end = end.map_or(DVec3::ZERO, |end| rest.position(end) - rest.position(joint));
    if let Some(axis) = to_end.try_normalize() {
        return (axis, to_end.length());
    }
    let before = mapped.iter().find(|(before, _)| before.ends.contains(&kind.slot) && kind.region != Region::Trunk);
    let axis = match before {
        _ if kind.region == Region::Trunk => DVec3::Y,
        Some((_, pair)) if !kind.region.is_leg() => rest.position(joint) - rest.position(joint_of(pair)),
        _ => DVec3::Z,
    };
    (axis.normalize_or(DVec3::Y), 0.0)
}

/// Points of a part, evenly spread.
fn points(part: usize, region: Region, is_hand: bool, [from, to]: [f64; 2]) -> impl Iterator<Item = LimbPoint> {
    (0..POINT_RINGS * POINT_SECTORS).map(move |at| {
        let share = ((at / POINT_SECTORS) as f64 + 0.5) / POINT_RINGS as f64;
        let angle = std::f64::consts::TAU * (at % POINT_SECTORS) as f64 / POINT_SECTORS as f64;
        LimbPoint { part, region, place: Place { share, angle }, lever: from + share * (to - from), is_hand }
    })
}

/// Returns the vertices that follow each of the joints, or descendants of it that are not in the list, relative to the joint as
/// `rest` turns it. Parts without a skin count if they hang on mapped joints: others are things that a character carries.
fn vertices(
    asset: &Asset,
    skeleton: &Skeleton,
    rest: &WorldPose,
    joints: &[JointIndex],
    is_mapped: impl Fn(JointIndex) -> bool,
) -> Vec<Vec<DVec3>> {
    let part_of = |joint| ancestry(skeleton, joint).find_map(|joint| joints.iter().position(|&other| other == joint));
    let part_of: Vec<Option<usize>> = skeleton.joints().map(part_of).collect();
    let frame = |joint: JointIndex| rest.parent_frame(skeleton, joint) * rest.locals[joint.get()].to_affine();
    let frames: Vec<_> = skeleton.joints().map(frame).collect();
    let mut vertices = vec![Vec::new(); joints.len()];
    let primitives = |mesh: usize| asset.meshes[mesh].primitives.iter();
    let total: usize =
        asset.instances.iter().flat_map(|instance| primitives(instance.mesh)).map(|part| part.positions.len()).sum();
    let step = total.div_ceil(MAX_VERTICES).max(1);
    for &MeshInstance { joint, mesh, skin, joint_from_mesh } in &asset.instances {
        let skin = skin.map(|skin| &asset.skins[skin]);
        if skin.is_none() && !is_mapped(joint) {
            continue;
        }
        for geometry in primitives(mesh) {
            for (vertex, &position) in geometry.positions.iter().enumerate().step_by(step) {
                let (joint, position) = match skin {
                    None => (joint, joint_from_mesh.transform_point3(position)),
                    Some(_) if geometry.influences.is_empty() => continue,
                    Some(skin) => {
                        let strongest = geometry.influences.of_vertex(vertex).max_by(|a, b| a.1.total_cmp(&b.1));
                        let index = usize::from(strongest.map_or(0, |(joint, _)| joint));
                        (skin.joints()[index], skin.joint_from_bind()[index].transform_point3(position))
                    }
                };
                if let Some(part) = part_of[joint.get()] {
                    let point = frames[joint.get()].transform_point3(position.as_dvec3());
                    let top = joints[part];
                    vertices[part].push(rest.rotation(top).conjugate() * (point - rest.position(top)));
                }
            }
        }
    }
    vertices
}
