//! Soles: the lowest points of the feet's meshes, whatever the rotation of a foot. Toe and heel joints can't stand in for them,
//! since rigs place these anywhere in the shoe.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::{Asset, MeshInstance, Slot};
use gaitway_character::mesh::{Influences, Skin};
use glam::{DAffine3, DQuat, DVec3, Vec3};

use crate::map::Pair;
use crate::pose::{WorldPose, is_within};
use crate::transfer::Transfer;

/// A vertex belongs to a foot if the foot's joints have at least this share of its weights.
const MIN_WEIGHT: f32 = 0.5;

/// Angles from straight down of the directions in which the outermost points of a foot are kept.
const TILTS_DEGREES: [f64; 3] = [25.0, 50.0, 75.0];

/// Number of directions per tilt.
const AZIMUTHS: u32 = 8;

/// Ankle and toes of each foot.
const FEET: [[Slot; 2]; 2] = [[Slot::LeftFoot, Slot::LeftToes], [Slot::RightFoot, Slot::RightToes]];

/// The pair that a foot's contacts are found with: its toes if both sides have those, else its ankle.
pub fn foot_pairs<'a>(transfer: &Transfer<'a>) -> [Option<&'a Pair>; 2] {
    FEET.map(|[ankle, toes]| transfer.pair(toes).or_else(|| transfer.pair(ankle)))
}

/// The sole of one foot, as points attached to its joints.
#[derive(Debug, Clone)]
pub struct Sole {
    /// Each with its offset from the joint, which rotates with the joint but doesn't scale.
    points: Vec<(JointIndex, DVec3)>,
}

impl Sole {
    /// Returns the height of the lowest point.
    pub fn lowest(&self, pose: &WorldPose) -> f64 {
        self.positions(pose).map(|point| point.y).fold(f64::INFINITY, f64::min)
    }

    /// Returns what [`Self::lowest`] would be if the foot were turned about its ankle.
    pub fn lowest_turned(&self, pose: &WorldPose, ankle: JointIndex, turn: DQuat) -> f64 {
        let center = pose.position(ankle);
        center.y + self.positions(pose).map(|point| (turn * (point - center)).y).fold(f64::INFINITY, f64::min)
    }

    /// Returns the sole's offset from its ankle, which points ahead: the mean of its points, weighted by their squared distances.
    pub fn ahead(&self, pose: &WorldPose, ankle: JointIndex) -> DVec3 {
        let offsets = || self.positions(pose).map(|point| point - pose.position(ankle));
        let weight: f64 = offsets().map(DVec3::length_squared).sum();
        let sum: DVec3 = offsets().map(|offset| offset * offset.length_squared()).sum();
        if weight > 0.0 { sum / weight } else { DVec3::ZERO }
    }

    /// The joints that the sole is attached to, repeatedly.
    pub fn joints(&self) -> impl Iterator<Item = JointIndex> {
        self.points.iter().map(|&(joint, _)| joint)
    }

    fn positions(&self, pose: &WorldPose) -> impl Iterator<Item = DVec3> {
        self.points.iter().map(|&(joint, offset)| pose.position(joint) + pose.rotation(joint) * offset)
    }
}

/// The soles of both feet, and the ground they stand on.
#[derive(Debug, Default)]
pub struct Soles {
    /// Left, right; `None` for a foot that is not mapped.
    pub feet: [Option<Sole>; 2],
    /// Height of the lowest point of either at rest.
    pub ground: f64,
}

impl Soles {
    /// The soles of the target.
    pub fn new(transfer: &Transfer) -> Self {
        Self::of(transfer, transfer.target, &transfer.alignment.unaligned_target, |pair| pair.target)
    }

    /// The place of a foot among those that are mapped. `side` is 0 for the left one, 1 for the right one.
    pub fn index(&self, side: usize) -> usize {
        self.feet[..side].iter().flatten().count()
    }

    /// The soles of either side.
    pub fn of(transfer: &Transfer, asset: &Asset, rest: &WorldPose, joint: fn(&Pair) -> JointIndex) -> Self {
        let feet = FEET.map(|slots| {
            let [ankle, toes] = slots.map(|slot| transfer.pair(slot).map(joint));
            let foot = ankle.or(toes)?;
            let of_mesh = mesh_sole(asset, rest, foot);
            Some(if of_mesh.points.is_empty() { joint_sole(rest, foot, toes) } else { of_mesh })
        });
        let ground = feet.iter().flatten().map(|sole| sole.lowest(rest)).fold(f64::INFINITY, f64::min);
        Self { feet, ground }
    }
}

/// Returns the sole of a foot without a mesh: the toe joint, and a heel at the same height below the ankle.
fn joint_sole(rest: &WorldPose, ankle: JointIndex, toes: Option<JointIndex>) -> Sole {
    let Some(toes) = toes.filter(|&toes| toes != ankle) else { return Sole { points: vec![(ankle, DVec3::ZERO)] } };
    let down = (rest.position(ankle).y - rest.position(toes).y).max(0.0);
    let heel = rest.rotation(ankle).conjugate() * (-down * DVec3::Y);
    Sole { points: vec![(toes, DVec3::ZERO), (ankle, heel)] }
}

/// Returns the outermost points of all meshes that follow the foot's joint or its descendants.
fn mesh_sole(asset: &Asset, rest: &WorldPose, foot: JointIndex) -> Sole {
    let mut hull = Hull::new(asset, rest, foot);
    for &MeshInstance { joint, mesh, skin, joint_from_mesh } in &asset.instances {
        let skin = skin.map(|skin| &asset.skins[skin]);
        // One flag per joint that moves the mesh.
        let movers = skin.map_or(std::slice::from_ref(&joint), Skin::joints);
        let in_foot: Vec<bool> = movers.iter().map(|&joint| hull.is_in_foot(joint)).collect();
        if !in_foot.contains(&true) {
            continue;
        }
        for geometry in &asset.meshes[mesh].primitives {
            for (vertex, &position) in geometry.positions.iter().enumerate() {
                let bound = match skin {
                    None => Some((joint, joint_from_mesh.transform_point3(position))),
                    Some(skin) => bound_to_foot(&in_foot, skin, &geometry.influences, vertex, position),
                };
                if let Some((joint, position)) = bound {
                    hull.add(joint, position);
                }
            }
        }
    }
    hull.into_sole(asset)
}

/// Returns the foot's joint with the most influence on a vertex, and the vertex in its frame; `None` for vertices outside the
/// foot.
fn bound_to_foot(
    in_foot: &[bool],
    skin: &Skin,
    influences: &Influences,
    vertex: usize,
    position: Vec3,
) -> Option<(JointIndex, Vec3)> {
    if influences.is_empty() {
        return None;
    }
    let own = influences.of_vertex(vertex).filter(|&(joint, _)| in_foot[usize::from(joint)]);
    let (sum, strongest) = own.fold((0.0, (0, 0.0)), |(sum, strongest), next| {
        (sum + next.1, if next.1 > strongest.1 { next } else { strongest })
    });
    let index = usize::from(strongest.0);
    (sum >= MIN_WEIGHT).then(|| (skin.joints()[index], skin.joint_from_bind()[index].transform_point3(position)))
}

/// Collects, for each joint of a foot, the outermost point in each direction.
struct Hull<'a> {
    rest: &'a WorldPose,
    directions: Vec<DVec3>,
    /// By joint; `None` for joints outside the foot.
    world_from_joint: Vec<Option<DAffine3>>,
    /// By joint and direction: how far out the outermost point is, and its position at rest in the common frame.
    outermost: Vec<Vec<(f64, DVec3)>>,
}

impl<'a> Hull<'a> {
    fn new(asset: &Asset, rest: &'a WorldPose, foot: JointIndex) -> Self {
        let skeleton = &asset.skeleton;
        let frame = |joint: JointIndex| rest.parent_frame(skeleton, joint) * rest.locals[joint.get()].to_affine();
        let in_foot = |joint: JointIndex| is_within(skeleton, joint, foot).then(|| frame(joint));
        let tilted = TILTS_DEGREES.into_iter().flat_map(|tilt| {
            let tilt = DQuat::from_rotation_x(tilt.to_radians());
            let step = std::f64::consts::TAU / f64::from(AZIMUTHS);
            (0..AZIMUTHS).map(move |at| DQuat::from_rotation_y(f64::from(at) * step) * tilt * -DVec3::Y)
        });
        Self {
            rest,
            directions: std::iter::once(-DVec3::Y).chain(tilted).collect(),
            world_from_joint: skeleton.joints().map(in_foot).collect(),
            outermost: vec![Vec::new(); skeleton.len()],
        }
    }

    fn is_in_foot(&self, joint: JointIndex) -> bool {
        self.world_from_joint[joint.get()].is_some()
    }

    /// Adds a point in the frame of a joint.
    fn add(&mut self, joint: JointIndex, position: Vec3) {
        let Some(world_from_joint) = self.world_from_joint[joint.get()] else { return };
        let point = world_from_joint.transform_point3(position.as_dvec3());
        let outermost = &mut self.outermost[joint.get()];
        outermost.resize(self.directions.len(), (f64::NEG_INFINITY, DVec3::ZERO));
        for (direction, outermost) in self.directions.iter().zip(outermost) {
            let distance = direction.dot(point);
            if distance > outermost.0 {
                *outermost = (distance, point);
            }
        }
    }

    fn into_sole(self, asset: &Asset) -> Sole {
        let mut points: Vec<(JointIndex, DVec3)> = Vec::new();
        for (joint, outermost) in asset.skeleton.joints().zip(&self.outermost) {
            for (_, point) in outermost.iter().filter(|(distance, _)| distance.is_finite()) {
                let offset = self.rest.rotation(joint).conjugate() * (*point - self.rest.position(joint));
                if !points.contains(&(joint, offset)) {
                    points.push((joint, offset));
                }
            }
        }
        Sole { points }
    }
}
