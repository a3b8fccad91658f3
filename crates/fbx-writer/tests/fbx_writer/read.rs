//! Reads files back and compares them.

use std::collections::HashMap;
use std::path::Path;

use gaitway_character::anim::{Clip, JointIndex, Pose, SampleCursor, model_from_joint};
use gaitway_character::asset::{Asset, MeshInstance};
use gaitway_character::mesh::{Geometry, Topology};
use gaitway_fbx_writer::Written;
use gaitway_formats::{FileSet, LoadOptions, convert_named, load, main_files, missing_files, prepare};
use glam::{Affine3A, Vec3};

/// Returns a model's GLB, as an export writes it.
pub fn glb(path: &Path) -> Vec<u8> {
    let name = path.file_name().unwrap().to_str().unwrap();
    let mut files = FileSet::default();
    files.insert(name, std::fs::read(path).unwrap());
    prepare(&mut files).unwrap();
    for missing in missing_files(&files) {
        let uri = percent_decoded(&missing);
        if let Ok(bytes) = std::fs::read(path.with_file_name(&uri)) {
            files.insert(missing, bytes);
        }
    }
    prepare(&mut files).unwrap();
    let main = main_files(&files).first().unwrap().clone();
    convert_named(&files, &main, &LoadOptions::default()).unwrap()
}

/// Returns the GLB of a file that needs no others.
pub fn glb_of(name: &str, bytes: &[u8]) -> Vec<u8> {
    let mut files = FileSet::default();
    files.insert(name, bytes);
    prepare(&mut files).unwrap();
    convert_named(&files, name, &LoadOptions::default()).unwrap()
}

fn percent_decoded(uri: &str) -> String {
    uri.replace("%20", " ")
}

/// Reads a file with the project's own readers.
pub fn asset(name: &str, bytes: &[u8]) -> Asset {
    let mut files = FileSet::default();
    files.insert(name, bytes);
    prepare(&mut files).unwrap_or_else(|error| panic!("{name}: {error}"));
    load(&files).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A model in a pose.
pub struct Posed<'a> {
    asset: &'a Asset,
    pub worlds: Vec<Affine3A>,
    pose: Pose,
}

impl<'a> Posed<'a> {
    pub fn new(asset: &'a Asset, clip: Option<(&Clip, f32)>) -> Posed<'a> {
        let mut pose = asset.skeleton.rest().clone();
        if let Some((clip, time)) = clip {
            clip.sample(&asset.skeleton, time, &mut SampleCursor::default(), &mut pose);
        }
        let mut worlds = Vec::new();
        model_from_joint(&asset.skeleton, &pose, Affine3A::IDENTITY, &mut worlds);
        Posed { asset, worlds, pose }
    }

    /// Returns the corners of an instance's triangles, by material in the order of their first use.
    pub fn corners(&self, instance: &MeshInstance) -> Vec<Vec3> {
        let mesh = &self.asset.meshes[instance.mesh];
        let drawn = || mesh.primitives.iter().filter(|geometry| geometry.topology == Topology::Triangles);
        let mut materials: Vec<Option<usize>> = Vec::new();
        drawn().for_each(|geometry| {
            if !materials.contains(&geometry.material) && !geometry.indices.is_empty() {
                materials.push(geometry.material);
            }
        });
        let mut corners = Vec::new();
        for material in materials {
            for geometry in drawn().filter(|geometry| geometry.material == material) {
                corners.extend(geometry.indices.iter().map(|&index| self.vertex(instance, geometry, index as usize)));
            }
        }
        corners
    }

    fn vertex(&self, instance: &MeshInstance, geometry: &Geometry, vertex: usize) -> Vec3 {
        let mut position = geometry.positions[vertex];
        let weights = &self.pose.morph_weights[self.asset.skeleton.morph_range(instance.joint)];
        for (target, weight) in geometry.morph_targets.iter().zip(weights) {
            position += *weight * target.positions.get(vertex).copied().unwrap_or_default();
        }
        let Some(skin) = instance.skin.map(|skin| &self.asset.skins[skin]) else {
            return (self.worlds[instance.joint.get()] * instance.joint_from_mesh).transform_point3(position);
        };
        let influences = geometry.influences.of_vertex(vertex).filter(|(_, weight)| *weight > 0.0);
        influences.fold(Vec3::ZERO, |sum, (joint, weight)| {
            let joint = usize::from(joint);
            let world = self.worlds[skin.joints()[joint].get()] * skin.joint_from_bind()[joint];
            sum + weight * world.transform_point3(position)
        })
    }
}

/// The greatest distances between a model and what was read of it, per its size.
#[derive(Debug, Default, Clone)]
pub struct Difference {
    pub joints: f32,
    pub vertices: f32,
    pub poses: usize,
    pub corners: usize,
    /// Where vertices are farthest off: clip, time and corner.
    pub place: String,
}

/// Parts of a clip's duration that miss the keys of every file.
const TIMES: [f32; 5] = [0.0731, 0.2877, 0.4519, 0.6613, 0.9427];

/// Compares a model with its file at rest and within all clips.
pub fn compare(name: &str, original: &Asset, written: &Written, read: &Asset) -> Difference {
    let by_name: HashMap<&str, JointIndex> =
        read.skeleton.joints().map(|joint| (read.skeleton.name(joint), joint)).collect();
    let joints: Vec<Option<JointIndex>> =
        written.names.iter().map(|name| by_name.get(name.as_str()).copied()).collect();
    let size = size(&Posed::new(original, None));
    let mut worst = Difference::default();
    let mut times = vec![None];
    assert_eq!(
        original.clips.iter().filter(|clip| moves(clip)).count(),
        read.clips.len(),
        "{name}: {:?}",
        written.warnings
    );
    for (before, after) in original.clips.iter().filter(|clip| moves(clip)).zip(&read.clips) {
        assert!((before.duration_secs() - after.duration_secs()).abs() < 1e-4, "{name}: {}", before.name());
        times.extend(TIMES.map(|part| Some((before, after, part * before.duration_secs()))));
    }
    for time in times {
        let expected = Posed::new(original, time.map(|(clip, _, time)| (clip, time)));
        let found = Posed::new(read, time.map(|(_, clip, time)| (clip, time)));
        worst.poses += 1;
        for (index, joint) in joints.iter().enumerate() {
            // A skinned mesh is where its joints are, wherever its node is.
            let moves_only_mesh = original.instances.iter().any(|i| i.joint.get() == index && i.skin.is_some())
                && !original.skins.iter().any(|skin| skin.joints().iter().any(|joint| joint.get() == index));
            let Some(joint) = joint.filter(|_| !moves_only_mesh) else { continue };
            let [a, b] = [expected.worlds[index], found.worlds[joint.get()]].map(|world| world.translation);
            worst.joints = worst.joints.max((a - b).length() / size);
        }
        let before = worst.vertices;
        compare_meshes(name, &expected, &found, size, &mut worst);
        if worst.vertices > before {
            worst.place = time.map_or(String::new(), |(clip, _, time)| format!("{} at {time} s", clip.name()));
        }
    }
    worst
}

fn moves(clip: &Clip) -> bool {
    use gaitway_character::anim::PropertyTarget;
    !clip.channels().is_empty()
        || clip.properties().iter().any(|property| matches!(property.target, PropertyTarget::MorphWeight(..)))
}

/// Compares all corners: those of each instance are written in the order of the joints, then what is below them.
fn compare_meshes(name: &str, expected: &Posed, found: &Posed, size: f32, worst: &mut Difference) {
    let all = |posed: &Posed| -> Vec<Vec3> {
        posed.asset.instances.iter().flat_map(|instance| posed.corners(instance)).collect()
    };
    let (expected, found) = (all(expected), all(found));
    assert_eq!(expected.len(), found.len(), "{name}: corners");
    worst.corners = expected.len();
    let in_order = expected.iter().zip(&found).map(|(a, b)| (*a - *b).length()).fold(0.0, f32::max);
    let distance = if in_order / size > 1e-4 { nearest(&expected, &found, 5e-4 * size) } else { in_order };
    worst.vertices = worst.vertices.max(distance / size);
}

/// Returns the greatest distance from a point to the nearest of others, both ways, up to `limit`: meshes may be in another order.
fn nearest(a: &[Vec3], b: &[Vec3], limit: f32) -> f32 {
    let one_way = |from: &[Vec3], to: &[Vec3]| {
        let mut sorted = to.to_vec();
        sorted.sort_by(|a, b| a.x.total_cmp(&b.x));
        let nearest = |p: &Vec3| {
            let start = sorted.partition_point(|q| q.x < p.x - limit);
            let near = sorted[start..].iter().take_while(|q| q.x <= p.x + limit);
            near.map(|q| (*p - *q).length()).fold(f32::INFINITY, f32::min)
        };
        from.iter().map(nearest).fold(0.0, f32::max)
    };
    one_way(a, b).max(one_way(b, a))
}

/// Returns the longest side of the box around all joints and vertices.
fn size(posed: &Posed) -> f32 {
    let joints = posed.worlds.iter().map(|world| Vec3::from(world.translation));
    let corners = posed.asset.instances.iter().flat_map(|instance| posed.corners(instance));
    let (low, high) = joints
        .chain(corners)
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), point| (low.min(point), high.max(point)));
    let size = (high - low).max_element();
    if size > 0.0 { size } else { 1.0 }
}
