//! Bounds of a model: exact at rest, and a close estimate in any pose without skinning every vertex.
//!
//! Each joint keeps the extreme points of the vertices it influences, in joint space. A skinned vertex is a weighted
//! mean of its positions by each joint, so the bounds of the kept points enclose it.

use gaitway_character::anim::{JointIndex, model_from_joint};
use gaitway_character::asset::{Asset, MeshInstance, SceneJoints};
use gaitway_character::mesh::{
    Bounds, DeformedVertices, Geometry, Skin, SkinningMode, deform, palette_entry, write_palette,
};
use glam::{Affine3A, Vec3, Vec4};

use super::Rig;

#[derive(Debug, Default)]
pub(super) struct Extent {
    rest: Bounds,
    instances: Vec<InstanceExtent>,
}

#[derive(Debug, Default)]
struct InstanceExtent {
    joints: Vec<JointExtent>,
    /// Bounds of each morph target's deltas, in mesh space.
    morph_reach: Vec<Bounds>,
}

/// Extreme points that a joint moves rigidly.
#[derive(Debug)]
struct JointExtent {
    joint: JointIndex,
    joint_from_mesh: Affine3A,
    /// In joint space.
    points: Vec<Vec3>,
    center: Vec3,
}

/// Influences below this weight are ignored, except a vertex's strongest.
const MIN_WEIGHT: f32 = 0.05;

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
        scene: &SceneJoints,
    ) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        for (extent, instance) in self.instances.iter().zip(&asset.instances) {
            if !scene.visible[instance.joint.get()] {
                continue;
            }
            let range = asset.skeleton.morph_range(instance.joint);
            let reach = extent.reach(morph_weights.get(range).unwrap_or_default());
            for extent in &extent.joints {
                let world_from_joint = &world_from_joint[extent.joint.get()];
                let slack = reach.map_or((Vec3::ZERO, Vec3::ZERO), |reach| {
                    let mut linear = *world_from_joint * extent.joint_from_mesh;
                    linear.translation = glam::Vec3A::ZERO;
                    let slack = reach.transformed(&linear);
                    (slack.min, slack.max)
                });
                for &point in &extent.points {
                    let point = world_from_joint.transform_point3(point);
                    bounds = bounds.including(point + slack.0).including(point + slack.1);
                }
            }
        }
        if bounds.is_empty() { joint_bounds(asset, rig, world_from_joint, &scene.in_scene) } else { bounds }
    }

    pub fn instance_center(&self, asset: &Asset, instance: usize, world_from_joint: &[Affine3A]) -> Vec3 {
        let Some(extent) = self.instances.get(instance).filter(|extent| !extent.joints.is_empty()) else {
            return asset
                .instances
                .get(instance)
                .map_or(Vec3::ZERO, |instance| world_from_joint[instance.joint.get()].translation.into());
        };
        let sum: Vec3 = extent
            .joints
            .iter()
            .map(|extent| world_from_joint[extent.joint.get()].transform_point3(extent.center))
            .sum();
        sum / extent.joints.len() as f32
    }
}

impl InstanceExtent {
    fn new(asset: &Asset, instance: &MeshInstance) -> Self {
        let mesh = &asset.meshes[instance.mesh];
        let skin = instance.skin.map(|skin| &asset.skins[skin]);
        let mut supports = vec![Support::default(); skin.map_or(1, |skin| skin.joints().len())];
        for geometry in &mesh.primitives {
            add_support(geometry, skin, &instance.joint_from_mesh, &mut supports);
        }
        let mut joints = Vec::new();
        for (slot, support) in supports.iter().enumerate() {
            let points = support.points();
            if points.is_empty() {
                continue;
            }
            let (joint, joint_from_mesh) = match skin {
                Some(skin) => (skin.joints()[slot], skin.joint_from_bind()[slot]),
                None => (instance.joint, instance.joint_from_mesh),
            };
            let center = Bounds::of(points.iter().copied()).center();
            joints.push(JointExtent { joint, joint_from_mesh, points, center });
        }
        let targets = mesh.primitives.iter().map(|geometry| geometry.morph_targets.len()).max().unwrap_or(0);
        let morph_reach = (0..targets).map(|target| morph_reach(&mesh.primitives, target)).collect();
        Self { joints, morph_reach }
    }

    /// Bounds of the offsets that these morph weights can cause, in mesh space; `None` if they cause none.
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

/// Adds the vertices of a primitive to the supports of the joints that influence them, in joint space.
fn add_support(geometry: &Geometry, skin: Option<&Skin>, joint_from_mesh: &Affine3A, supports: &mut [Support]) {
    let Some(skin) = skin else {
        let positions = geometry.positions.iter().map(|&position| joint_from_mesh.transform_point3(position));
        positions.for_each(|position| supports[0].add(position));
        return;
    };
    let joint_from_bind = skin.joint_from_bind();
    for (vertex, &position) in geometry.positions.iter().enumerate() {
        if geometry.influences.is_empty() {
            supports[0].add(joint_from_bind[0].transform_point3(position));
            continue;
        }
        for (rank, (slot, weight)) in geometry.influences.of_vertex(vertex).enumerate() {
            if weight > 0.0 && (rank == 0 || weight >= MIN_WEIGHT) {
                supports[slot as usize].add(joint_from_bind[slot as usize].transform_point3(position));
            }
        }
    }
}

/// Bounds of a target's deltas, including zero for the vertices it does not move.
fn morph_reach(primitives: &[Geometry], target: usize) -> Bounds {
    let deltas = primitives.iter().filter_map(|geometry| geometry.morph_targets.get(target));
    Bounds::of(deltas.flat_map(|target| target.positions.iter().copied()).chain([Vec3::ZERO]))
}

/// The extreme points along 13 axes, in both directions; none before the first.
#[derive(Debug, Clone, Default)]
struct Support(Option<Extremes>);

#[derive(Debug, Clone)]
struct Extremes {
    least: [Vec4; 4],
    most: [Vec4; 4],
    /// The points at `least` and those at `most`.
    points: [[Vec3; 16]; 2],
}

/// How far a point lies along the 13 axes, the last of which is repeated.
fn along_axes(Vec3 { x, y, z }: Vec3) -> [Vec4; 4] {
    [
        Vec4::new(x, y, z, x + y),
        Vec4::new(x - y, y + z, y - z, z + x),
        Vec4::new(z - x, x + y + z, x + y - z, x - y + z),
        Vec4::splat(y + z - x),
    ]
}

impl Support {
    fn add(&mut self, point: Vec3) {
        match &mut self.0 {
            _ if !point.is_finite() => {}
            Some(extremes) => extremes.add(point),
            None => {
                let along = along_axes(point);
                self.0 = Some(Extremes { least: along, most: along, points: [[point; 16]; 2] });
            }
        }
    }

    fn points(&self) -> Vec<Vec3> {
        let mut distinct: Vec<Vec3> = Vec::new();
        for point in self.0.iter().flat_map(|extremes| extremes.points.as_flattened()) {
            if !distinct.contains(point) {
                distinct.push(*point);
            }
        }
        distinct
    }
}

impl Extremes {
    /// Nearly every point lies between others, which four axes at a time find out sooner than one.
    fn add(&mut self, point: Vec3) {
        for (group, along) in along_axes(point).into_iter().enumerate() {
            let (least, most) = (&mut self.least[group], &mut self.most[group]);
            let beyond = [along.cmplt(*least), along.cmpgt(*most)];
            if (beyond[0] | beyond[1]).any() {
                (*least, *most) = (least.min(along), most.max(along));
                for (points, beyond) in self.points.iter_mut().zip(beyond) {
                    let lanes = points[4 * group..].iter_mut().zip(<[bool; 4]>::from(beyond));
                    lanes.filter(|(_, is_beyond)| *is_beyond).for_each(|(kept, _)| *kept = point);
                }
            }
        }
    }
}

/// Bounds of the scene's joints, for models without a visible mesh.
fn joint_bounds(asset: &Asset, rig: &Rig, world_from_joint: &[Affine3A], in_scene: &[bool]) -> Bounds {
    let joints = asset.skeleton.joints().filter(|&joint| in_scene[joint.get()] && rig.is_real(joint));
    Bounds::of(joints.map(|joint| world_from_joint[joint.get()].translation.into()))
}

/// Bounds of every visible skinned vertex of the default scene at rest.
fn exact_rest_bounds(asset: &Asset, rig: &Rig) -> Bounds {
    let mut world_from_joint = Vec::with_capacity(asset.skeleton.len());
    model_from_joint(&asset.skeleton, asset.skeleton.rest(), Affine3A::IDENTITY, &mut world_from_joint);
    let scene = SceneJoints::new(asset, asset.default_scene);
    let mut bounds = Bounds::EMPTY;
    let mut palette = Vec::new();
    let mut deformed = DeformedVertices::default();
    for instance in &asset.instances {
        if !scene.visible[instance.joint.get()] {
            continue;
        }
        palette.clear();
        match instance.skin.map(|skin| &asset.skins[skin]) {
            Some(skin) => write_palette(skin, &world_from_joint, SkinningMode::Linear, &mut palette),
            None => {
                let world_from_mesh = world_from_joint[instance.joint.get()] * instance.joint_from_mesh;
                palette.push(palette_entry(&world_from_mesh, SkinningMode::Linear));
            }
        }
        let weights = &asset.skeleton.rest().morph_weights[asset.skeleton.morph_range(instance.joint)];
        for geometry in &asset.meshes[instance.mesh].primitives {
            deform(geometry, weights, &palette, SkinningMode::Linear, &mut deformed);
            bounds = deformed.positions.iter().fold(bounds, |bounds, &position| bounds.including(position));
        }
    }
    if bounds.is_empty() { joint_bounds(asset, rig, &world_from_joint, &scene.in_scene) } else { bounds }
}
