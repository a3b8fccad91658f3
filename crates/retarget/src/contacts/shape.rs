//! Fits the solids of a body to its mesh or, where there is none, to its skeleton.

use gaitway_character::anim::{JointIndex, Skeleton};
use gaitway_character::asset::{Asset, Humanoid, MeshInstance};
use gaitway_character::mesh::{Geometry, Skin};
use glam::{DVec3, Vec3};

use super::body::{Body, place_of};
use super::parts::Part;
use super::solid::{Place, Solid};
use crate::feet::Soles;
use crate::map::Pair;
use crate::pose::{WorldPose, ancestry, is_within};
use crate::transfer::Transfer;

/// Length of a part without an end, as a share of the body's height.
const ENDLESS: f64 = 0.05;

/// At most about this many vertices of a body are looked at.
const MAX_VERTICES: usize = 6000;

/// What hangs on a hand and isn't a finger is held if it reaches beyond the hand by this factor.
const HELD: f64 = 1.25;

/// Angles about a shin at which a knee is measured, from straight ahead.
const KNEE: [f64; 3] = [-0.5, 0.0, 0.5];

/// What the body of one side is made from.
pub struct Side<'a> {
    pub asset: &'a Asset,
    pub skeleton: &'a Skeleton,
    pub slots: &'a Humanoid,
    /// The aligned rest.
    pub rest: &'a WorldPose,
    /// The rest in which the mesh is measured.
    pub skinned: &'a WorldPose,
    pub joint: fn(&Pair) -> JointIndex,
}

impl Side<'_> {
    /// `fronts` are the directions of angle 0 of the parts' solids.
    pub fn body(&self, transfer: &Transfer, parts: &[Part], fronts: &[DVec3]) -> Body {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for pair in &transfer.map.pairs {
            let y = self.rest.position((self.joint)(pair)).y;
            (low, high) = (low.min(y), high.max(y));
        }
        let soles = Soles::of(transfer, self.asset, self.skinned, self.joint);
        let mut body = Body { height: (high - low).max(1e-9), soles, ..Body::default() };
        body.joints = parts.iter().map(|part| (self.joint)(part.pair)).collect();
        let (vertices, is_holding) = self.vertices(transfer, parts, &body.joints);
        body.is_holding = is_holding;
        for ((part, mut vertices), &front) in parts.iter().zip(vertices).zip(fronts) {
            let (axis, length) = part.axis(parts, self.rest, self.joint);
            let turn = self.rest.rotation((self.joint)(part.pair));
            for vertex in &mut vertices {
                *vertex = turn * *vertex;
            }
            let fitted = Solid::around(&vertices, axis, front);
            body.has_mesh |= fitted.is_some();
            let solid = fitted.unwrap_or_else(|| {
                let [before, after] = part.kind.beyond.map(|share| share * body.height);
                let to = length.max(ENDLESS * body.height) + after;
                Solid::elliptic(axis, front, [-before, to], part.kind.radii.map(|share| share * body.height))
            });
            body.points.push(std::array::from_fn(|point| solid.surface(place_of(point))));
            body.solids.push(solid);
            body.rest.push(turn);
        }
        let shins = parts.iter().zip(&body.solids).filter(|(part, _)| part.is_shin());
        let ahead = shins.map(|(_, solid)| KNEE.map(|angle| solid.radius(Place { share: 0.0, angle })));
        let ahead: Vec<f64> = ahead.flatten().collect();
        body.knee_radius = ahead.iter().sum::<f64>() / ahead.len().max(1) as f64;
        body
    }

    /// Returns the vertices of each part, relative to its joint as that is turned, and whether each hand holds something.
    fn vertices(&self, transfer: &Transfer, parts: &[Part], joints: &[JointIndex]) -> (Vec<Vec<DVec3>>, [bool; 2]) {
        let owners: Vec<Option<Owner>> = self.skeleton.joints().map(|joint| self.owner(joint, parts, joints)).collect();
        let mut trunk: Vec<(usize, DVec3, DVec3)> = Vec::new();
        for (index, part) in parts.iter().enumerate().filter(|(_, part)| part.is_trunk()) {
            let (axis, _) = part.axis(parts, self.skinned, self.joint);
            trunk.push((index, self.skinned.position(joints[index]), axis));
        }
        let mut vertices = vec![Vec::new(); parts.len()];
        let mut beside = vec![Vec::new(); parts.len()];
        for (joint, point) in self.points(transfer) {
            let Some(Owner { mut part, is_beside }) = owners[joint.get()] else { continue };
            if parts[part].is_trunk() {
                // Models differ in how weights divide a trunk, so its vertices are divided at the joints.
                let above = trunk.iter().rev().find(|(_, start, axis)| (point - *start).dot(*axis) >= 0.0);
                part = above.unwrap_or(&trunk[0]).0;
            }
            let point = self.skinned.rotation(joints[part]).conjugate() * (point - self.skinned.position(joints[part]));
            let list = if is_beside { &mut beside } else { &mut vertices };
            list[part].push(point);
        }
        let mut is_holding = [false; 2];
        for ((part, own), beside) in parts.iter().zip(&mut vertices).zip(beside) {
            let reach = |points: &[DVec3]| points.iter().map(|point| point.length()).fold(0.0, f64::max);
            match part.kind.region.arm() {
                Some(arm) if reach(&beside) > HELD * reach(own) => is_holding[arm] = true,
                _ => own.extend(beside),
            }
        }
        (vertices, is_holding)
    }

    /// Vertices at the rest in which the mesh is measured, with the joints that they follow most.
    fn points(&self, transfer: &Transfer) -> Vec<(JointIndex, DVec3)> {
        let mut is_mapped = vec![false; self.skeleton.len()];
        transfer.map.pairs.iter().for_each(|pair| is_mapped[(self.joint)(pair).get()] = true);
        let mut frames = Vec::new();
        for joint in self.skeleton.joints() {
            let local = self.skinned.locals[joint.get()].to_affine();
            frames.push(self.skinned.parent_frame(self.skeleton, joint) * local);
        }
        let mut total = 0;
        for instance in &self.asset.instances {
            total += self.asset.meshes[instance.mesh].primitives.iter().map(|part| part.positions.len()).sum::<usize>();
        }
        let step = total.div_ceil(MAX_VERTICES).max(1);
        let mut points = Vec::new();
        for instance in &self.asset.instances {
            let skin = instance.skin.map(|skin| &self.asset.skins[skin]);
            // Unskinned meshes on joints of their own are things that a character wears or holds.
            if skin.is_none() && !is_mapped[instance.joint.get()] {
                continue;
            }
            for geometry in &self.asset.meshes[instance.mesh].primitives {
                points.extend((0..geometry.positions.len()).step_by(step).filter_map(|vertex| {
                    let (joint, position) = followed(instance, skin, geometry, vertex)?;
                    Some((joint, frames[joint.get()].transform_point3(position.as_dvec3())))
                }));
            }
        }
        points
    }

    /// The part that a joint's vertices belong to.
    fn owner(&self, joint: JointIndex, parts: &[Part], joints: &[JointIndex]) -> Option<Owner> {
        let (top, part) = ancestry(self.skeleton, joint)
            .find_map(|top| Some((top, joints.iter().position(|&other| other == top)?)))?;
        let is_finger = |joint: JointIndex| joint != top && self.slots.slot(joint).is_some();
        let has_fingers =
            || self.slots.0.values().any(|&finger| is_finger(finger) && is_within(self.skeleton, finger, top));
        let is_beside = parts[part].is_hand()
            && joint != top
            && !ancestry(self.skeleton, joint).take_while(|&above| above != top).any(is_finger)
            && has_fingers();
        Some(Owner { part, is_beside })
    }
}

/// The joint that a vertex follows most, and where the vertex is relative to that joint; `None` if it follows none.
fn followed(
    instance: &MeshInstance,
    skin: Option<&Skin>,
    geometry: &Geometry,
    vertex: usize,
) -> Option<(JointIndex, Vec3)> {
    let position = geometry.positions[vertex];
    let Some(skin) = skin else {
        return Some((instance.joint, instance.joint_from_mesh.transform_point3(position)));
    };
    if geometry.influences.is_empty() {
        return None;
    }
    let (index, _) = geometry.influences.of_vertex(vertex).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let index = usize::from(index);
    Some((skin.joints()[index], skin.joint_from_bind()[index].transform_point3(position)))
}

/// What a joint belongs to.
#[derive(Clone, Copy)]
struct Owner {
    part: usize,
    /// Whether it hangs on a hand with fingers, but not on one of them: a helper of the rig, or something that is held.
    is_beside: bool,
}
