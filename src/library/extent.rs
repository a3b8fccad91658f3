//! How far a model reaches: exactly at rest, and closely in any pose without touching every vertex.
//!
//! For each joint of a skin the outermost of the vertices it pulls are kept, in the joint's space. A skinned vertex is a
//! weighted mean of where its joints would put it, so the box around the kept points holds all.

use glam::{Affine3A, Vec3};

use super::Rig;
use super::model::rest_world;
use crate::anim::JointIndex;
use crate::asset::{Asset, MeshInstance};
use crate::mesh::{Bounds, DeformedVertices, Geometry, SkinningMode, deform, palette_entry, write_palette};

#[derive(Debug, Default)]
pub(super) struct Extent {
    rest: Bounds,
    instances: Vec<InstanceExtent>,
}

#[derive(Debug, Default)]
struct InstanceExtent {
    parts: Vec<Part>,
    /// Per morph target, the box of its differences in mesh space.
    morph_reach: Vec<Bounds>,
}

/// Outermost points that follow one joint rigidly.
#[derive(Debug)]
struct Part {
    joint: JointIndex,
    joint_from_mesh: Affine3A,
    /// In joint space.
    points: Vec<Vec3>,
    center: Vec3,
}

/// An influence weaker than this carries no point along, unless it is the vertex's strongest.
const LEAST_WEIGHT: f32 = 0.05;

impl Extent {
    pub fn new(asset: &Asset, rig: &Rig) -> Self {
        let instances = asset.instances.iter().map(|instance| InstanceExtent::new(asset, instance)).collect();
        Self { rest: exact_rest_bounds(asset, rig), instances }
    }

    pub fn rest(&self) -> Bounds {
        self.rest
    }

    pub fn of_pose(
        &self,
        asset: &Asset,
        rig: &Rig,
        world_from_joint: &[Affine3A],
        morph_weights: &[f32],
        in_scene: &[bool],
    ) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        for (extent, instance) in self.instances.iter().zip(&asset.instances) {
            if !in_scene[instance.joint.get()] {
                continue;
            }
            let range = asset.skeleton.morph_range(instance.joint);
            let reach = extent.reach(morph_weights.get(range).unwrap_or_default());
            for part in &extent.parts {
                let world_from_joint = &world_from_joint[part.joint.get()];
                let slack = reach.map_or((Vec3::ZERO, Vec3::ZERO), |reach| {
                    let mut linear = *world_from_joint * part.joint_from_mesh;
                    linear.translation = glam::Vec3A::ZERO;
                    let slack = reach.transformed(&linear);
                    (slack.min, slack.max)
                });
                for &point in &part.points {
                    let point = world_from_joint.transform_point3(point);
                    bounds = bounds.including(point + slack.0).including(point + slack.1);
                }
            }
        }
        if bounds.is_empty() { joint_bounds(asset, rig, world_from_joint, in_scene) } else { bounds }
    }

    pub fn instance_center(&self, asset: &Asset, instance: usize, world_from_joint: &[Affine3A]) -> Vec3 {
        let Some(extent) = self.instances.get(instance).filter(|extent| !extent.parts.is_empty()) else {
            return asset
                .instances
                .get(instance)
                .map_or(Vec3::ZERO, |instance| world_from_joint[instance.joint.get()].translation.into());
        };
        let sum: Vec3 =
            extent.parts.iter().map(|part| world_from_joint[part.joint.get()].transform_point3(part.center)).sum();
        sum / extent.parts.len() as f32
    }
}

impl InstanceExtent {
    fn new(asset: &Asset, instance: &MeshInstance) -> Self {
        let mesh = &asset.meshes[instance.mesh];
        let skin = instance.skin.map(|skin| &asset.skins[skin]);
        let slots = skin.map_or(1, |skin| skin.joints().len());
        let mut supports = vec![Support::default(); slots];
        for geometry in &mesh.primitives {
            for (vertex, &position) in geometry.positions.iter().enumerate() {
                match skin {
                    Some(skin) if !geometry.influences.is_empty() => {
                        for (rank, (slot, weight)) in geometry.influences.of_vertex(vertex).enumerate() {
                            if weight > 0.0 && (rank == 0 || weight >= LEAST_WEIGHT) {
                                let joint_from_bind = &skin.joint_from_bind()[slot as usize];
                                supports[slot as usize].add(joint_from_bind.transform_point3(position));
                            }
                        }
                    }
                    Some(skin) => supports[0].add(skin.joint_from_bind()[0].transform_point3(position)),
                    None => supports[0].add(position),
                }
            }
        }
        let mut parts = Vec::new();
        for (slot, support) in supports.iter().enumerate() {
            let points = support.points();
            if points.is_empty() {
                continue;
            }
            let (joint, joint_from_mesh) = match skin {
                Some(skin) => (skin.joints()[slot], skin.joint_from_bind()[slot]),
                None => (instance.joint, Affine3A::IDENTITY),
            };
            let center = Bounds::of(points.iter().copied()).center();
            parts.push(Part { joint, joint_from_mesh, points, center });
        }
        let targets = mesh.primitives.iter().map(|geometry| geometry.morph_targets.len()).max().unwrap_or(0);
        let morph_reach = (0..targets).map(|target| morph_reach(&mesh.primitives, target)).collect();
        Self { parts, morph_reach }
    }

    /// Box of the differences that these weights can make, in mesh space; none when there are none.
    fn reach(&self, weights: &[f32]) -> Option<Bounds> {
        let mut sum: Option<Bounds> = None;
        for (reach, &weight) in self.morph_reach.iter().zip(weights) {
            if weight == 0.0 || !weight.is_finite() || reach.is_empty() {
                continue;
            }
            let (a, b) = (weight * reach.min, weight * reach.max);
            let before = sum.unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ZERO });
            sum = Some(Bounds { min: before.min + a.min(b), max: before.max + a.max(b) });
        }
        sum
    }
}

/// Vertices that a target leaves alone count too: their difference is zero.
fn morph_reach(primitives: &[Geometry], target: usize) -> Bounds {
    let deltas = primitives.iter().filter_map(|geometry| geometry.morph_targets.get(target));
    Bounds::of(deltas.flat_map(|target| target.positions.iter().copied()).chain([Vec3::ZERO]))
}

/// The outermost points seen so far along 13 axes, both ways.
#[derive(Debug, Clone)]
struct Support {
    furthest: [(f32, Vec3); 26],
}

impl Default for Support {
    fn default() -> Self {
        Self { furthest: [(f32::NEG_INFINITY, Vec3::ZERO); 26] }
    }
}

impl Support {
    fn add(&mut self, point: Vec3) {
        if !point.is_finite() {
            return;
        }
        let Vec3 { x, y, z } = point;
        let along = [x, y, z, x + y, x - y, y + z, y - z, z + x, z - x, x + y + z, x + y - z, x - y + z, -x + y + z];
        for (axis, along) in along.into_iter().enumerate() {
            if along > self.furthest[2 * axis].0 {
                self.furthest[2 * axis] = (along, point);
            }
            if -along > self.furthest[2 * axis + 1].0 {
                self.furthest[2 * axis + 1] = (-along, point);
            }
        }
    }

    fn points(&self) -> Vec<Vec3> {
        let mut points: Vec<Vec3> = Vec::new();
        for &(along, point) in &self.furthest {
            if along > f32::NEG_INFINITY && !points.contains(&point) {
                points.push(point);
            }
        }
        points
    }
}

/// Box of the joints themselves, of those that bones are drawn for when there is no mesh.
fn joint_bounds(asset: &Asset, rig: &Rig, world_from_joint: &[Affine3A], in_scene: &[bool]) -> Bounds {
    let joints = asset.skeleton.joints().filter(|&joint| in_scene[joint.get()] && rig.is_real(joint));
    Bounds::of(joints.map(|joint| world_from_joint[joint.get()].translation.into()))
}

/// Every vertex of the default scene's rest pose, skinned.
fn exact_rest_bounds(asset: &Asset, rig: &Rig) -> Bounds {
    let world_from_joint = rest_world(asset);
    let in_scene = asset.joints_in_scene(asset.default_scene);
    let mut bounds = Bounds::EMPTY;
    let mut palette = Vec::new();
    let mut deformed = DeformedVertices::default();
    for instance in &asset.instances {
        if !in_scene[instance.joint.get()] {
            continue;
        }
        palette.clear();
        match instance.skin.map(|skin| &asset.skins[skin]) {
            Some(skin) => write_palette(skin, &world_from_joint, SkinningMode::Linear, &mut palette),
            None => palette.push(palette_entry(&world_from_joint[instance.joint.get()], SkinningMode::Linear)),
        }
        let weights = &asset.skeleton.rest().morph_weights[asset.skeleton.morph_range(instance.joint)];
        for geometry in &asset.meshes[instance.mesh].primitives {
            deform(geometry, weights, &palette, SkinningMode::Linear, &mut deformed);
            bounds = deformed.positions.iter().fold(bounds, |bounds, &position| bounds.including(position));
        }
    }
    if bounds.is_empty() { joint_bounds(asset, rig, &world_from_joint, &in_scene) } else { bounds }
}
