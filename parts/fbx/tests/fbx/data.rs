//! Every FBX of the test data, compared with ufbx's own evaluation, and with what other programs exported.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use ufbx::{Anim, Scene};

use crate::data_folder::data_folder;
use crate::glb::Glb;

/// Parts of a clip's duration that miss the keys of every file.
const TIMES: [f64; 5] = [0.0731, 0.2877, 0.4519, 0.6613, 0.9427];

/// Returns all FBX files below a folder, in order.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("fbx")) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Loads a file with none of the conversions that the converter relies on, except axes and units at the root.
fn reference(bytes: &[u8]) -> Option<ufbx::SceneRoot> {
    let options =
        ufbx::LoadOpts { target_axes: ufbx::axes_right_handed_y_up(), target_unit_meters: 1.0, ..Default::default() };
    ufbx::load_memory(bytes, options).ok()
}

fn evaluated(scene: &Scene, anim: &Anim, time: f64) -> ufbx::SceneRoot {
    let options = ufbx::EvaluateOpts { evaluate_skinning: true, ..Default::default() };
    ufbx::evaluate_scene(scene, anim, time, options).unwrap()
}

/// Returns the columns of the world matrices of all named nodes by name, in depth-first order.
fn frames(scene: &Scene) -> HashMap<String, Vec<[[f64; 3]; 4]>> {
    let mut found: HashMap<String, Vec<[[f64; 3]; 4]>> = HashMap::new();
    let mut open: Vec<&ufbx::Node> = vec![&scene.root_node];
    while let Some(node) = open.pop() {
        if !node.is_root && !node.element.name.is_empty() {
            let m = &node.node_to_world;
            found.entry(node.element.name.to_string()).or_default().push([
                [m.m00, m.m10, m.m20],
                [m.m01, m.m11, m.m21],
                [m.m02, m.m12, m.m22],
                [m.m03, m.m13, m.m23],
            ]);
        }
        let mut children: Vec<&ufbx::Node> = node.children.into_iter().collect();
        children.reverse();
        open.extend(children);
    }
    found
}

/// Returns all vertices that belong to a triangle, in world space; none if a skin isn't linear or follows two skins.
fn vertices(scene: &Scene) -> Option<Vec<[f64; 3]>> {
    let mut all = Vec::new();
    for node in &scene.nodes {
        for mesh in node.all_attribs.into_iter().filter_map(ufbx::as_mesh) {
            let linear = |skin: &ufbx::SkinDeformer| {
                matches!(skin.skinning_method, ufbx::SkinningMethod::Linear | ufbx::SkinningMethod::Rigid)
            };
            if !mesh.skin_deformers.into_iter().all(linear) || mesh.skin_deformers.count > 1 {
                return None;
            }
            let faces = mesh.faces.into_iter().zip(0..);
            let faces = faces.filter(|(_, face)| !mesh.face_hole.get(*face).copied().unwrap_or(false));
            let faces = faces.filter(|(face, _)| face.num_indices >= 3);
            for corner in faces.flat_map(|(face, _)| face.index_begin..face.index_begin + face.num_indices) {
                let vertex = mesh.skinned_position[corner as usize];
                let local = mesh.skinned_is_local;
                let p = if local { ufbx::transform_position(&node.geometry_to_world, vertex) } else { vertex };
                all.push([p.x, p.y, p.z]);
            }
        }
    }
    Some(all)
}

/// Returns the greatest distance from a point to the nearest of others, both ways, up to `limit`.
fn distance(a: &[[f64; 3]], b: &[[f64; 3]], limit: f64) -> f64 {
    let one_way = |from: &[[f64; 3]], to: &[[f64; 3]]| {
        let mut sorted = to.to_vec();
        sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let nearest = |p: &[f64; 3]| {
            let start = sorted.partition_point(|q| q[0] < p[0] - limit);
            let near = sorted[start..].iter().take_while(|q| q[0] <= p[0] + limit);
            near.map(|q| (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt()).fold(f64::INFINITY, f64::min)
        };
        from.iter().map(nearest).fold(0.0, f64::max)
    };
    one_way(a, b).max(one_way(b, a))
}

fn size<'a>(points: impl IntoIterator<Item = &'a [f64; 3]>) -> f64 {
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for point in points {
        for axis in 0..3 {
            bounds[0][axis] = bounds[0][axis].min(point[axis]);
            bounds[1][axis] = bounds[1][axis].max(point[axis]);
        }
    }
    let size = (0..3).map(|axis| bounds[1][axis] - bounds[0][axis]).fold(0.0, f64::max);
    if size > 0.0 { size } else { 1.0 }
}

/// What one comparison found, relative to the model's size.
#[derive(Default, Debug, Clone, Copy)]
struct Errors {
    joints: f64,
    /// Of the joints' axes, in degrees.
    angles: f64,
    vertices: f64,
}

impl Errors {
    fn max(self, other: Errors) -> Errors {
        Errors {
            joints: self.joints.max(other.joints),
            angles: self.angles.max(other.angles),
            vertices: self.vertices.max(other.vertices),
        }
    }
}

/// Returns the angle between two axes in degrees, whichever way they point (mirroring turns some around); 0 for axes of
/// no length.
fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let (la, lb) = (length(a), length(b));
    if la < 1e-6 || lb < 1e-6 {
        return 0.0;
    }
    let difference = |sign: f64| length(std::array::from_fn(|i| a[i] / la - sign * b[i] / lb));
    difference(1.0).min(difference(-1.0)).to_degrees()
}

/// Compares one time of one clip, or the rest.
fn compare(glb: &Glb, clip: Option<(usize, f64)>, expected: &Scene, size: f64) -> Errors {
    let pose = glb.pose(clip);
    let mut found: HashMap<&str, Vec<[[f64; 3]; 4]>> = HashMap::new();
    for index in glb.depth_first() {
        if let Some(name) = glb.list("nodes")[index]["name"].as_str() {
            found.entry(name).or_default().push(pose.worlds[index].map(|[x, y, z, _]| [x, y, z]));
        }
    }
    let mut errors = Errors::default();
    for (name, expected) in frames(expected) {
        let found = found.get(&*name).unwrap_or_else(|| panic!("node {name} is missing"));
        assert_eq!(found.len(), expected.len(), "nodes named {name}");
        for (a, b) in found.iter().zip(&expected) {
            // Less what 32-bit floats can't express far from the origin.
            let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
            let error = length(std::array::from_fn(|i| a[3][i] - b[3][i])) - f64::from(f32::EPSILON) * length(b[3]);
            let error = error.max(0.0) / size;
            let angle = (0..3).map(|axis| angle(a[axis], b[axis])).fold(0.0, f64::max);
            errors = errors.max(Errors { joints: error, angles: angle, vertices: 0.0 });
        }
    }
    if let Some(expected) = vertices(expected).filter(|vertices| !vertices.is_empty()) {
        errors.vertices = distance(&glb.vertices(&pose), &expected, 0.01 * size) / size;
    }
    errors
}

/// Compares a whole file and returns the largest errors and the number of comparisons.
fn check(bytes: &[u8], converted: &[u8]) -> (Errors, usize) {
    let glb = Glb::new(converted);
    let scene = reference(bytes).unwrap();
    let rest: Vec<[f64; 3]> = frames(&scene).into_values().flatten().map(|[.., position]| position).collect();
    let size = size(rest.iter().chain(&vertices(&scene).unwrap_or_default()));
    let mut largest = Errors::default();
    let mut count = 0;
    let mut clips = glb.list("animations").iter().enumerate().peekable();
    for stack in &scene.anim_stacks {
        let Some((clip, _)) = clips.next_if(|(_, clip)| clip["name"].as_str().unwrap_or("") == &*stack.element.name)
        else {
            continue;
        };
        let duration = glb.duration(clip);
        let start = if stack.time_begin < stack.time_end { stack.time_begin } else { first_key(stack) };
        for part in TIMES {
            let time = part * duration;
            let expected = evaluated(&scene, &stack.anim, start + time);
            largest = largest.max(compare(&glb, Some((clip, time)), &expected, size));
            count += 1;
        }
    }
    assert!(clips.next().is_none(), "a clip without a stack");
    (largest, count)
}

fn first_key(stack: &ufbx::AnimStack) -> f64 {
    let props = stack.layers.into_iter().flat_map(|layer| &layer.anim_props);
    let curves = props.flat_map(|prop| prop.anim_value.curves.iter().flatten());
    curves.map(|curve| curve.min_time).fold(f64::INFINITY, f64::min)
}

#[test]
fn every_file_moves_as_in_ufbx() {
    let Some(folder) = data_folder() else { return };
    let files = files(&folder);
    assert!(files.len() >= 280, "{} files", files.len());
    let (mut converted, mut comparisons, mut worst) = (0, 0, Errors::default());
    let mut faults = Vec::new();
    for path in &files {
        let name = path.strip_prefix(&folder).unwrap().display();
        let bytes = std::fs::read(path).unwrap();
        match gaitway_fbx::convert(&bytes) {
            Ok(result) => {
                let (errors, count) = check(&bytes, &result.bytes);
                // The converter promises 0.01 mm per metre and 0.01° for joints; a vertex may be farther from its
                // joint.
                if errors.joints > 1e-5 || errors.angles > 0.01 || errors.vertices > 1e-4 {
                    faults.push(format!("{name}: {errors:?} of size"));
                }
                worst = worst.max(errors);
                converted += 1;
                comparisons += count;
                println!("{name}: {} bytes, {errors:?}, {:?}", result.bytes.len(), result.warnings);
            }
            Err(error) if reference(&bytes).is_none_or(|scene| scene.nodes.count == 1) => println!("{name}: {error}"),
            Err(error) => faults.push(format!("{name}: {error}")),
        }
    }
    println!("{converted} of {} files, {comparisons} comparisons, largest errors of size {worst:?}", files.len());
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(converted >= files.len() - 2, "one of the files is damaged, and one has no objects");
}

/// The vertices of one frame as another program exported them.
struct Frame {
    obj: &'static str,
    files: &'static [&'static str],
    clip: &'static str,
    /// From the clip's start.
    frame: f64,
    /// What the OBJ's coordinates are multiplied by.
    factors: [f64; 3],
}

const fn frame(
    obj: &'static str,
    files: &'static [&'static str],
    clip: &'static str,
    frame: f64,
    factors: [f64; 3],
) -> Frame {
    Frame { obj, files, clip, frame, factors }
}

const FRAMES: [Frame; 10] = [
    frame("blender_279_sausage_base_0", &["blender_279_sausage_7400_binary"], "Base", 0.0, [1.0; 3]),
    frame("blender_279_sausage_spin_15", &["blender_279_sausage_7400_binary"], "Spin", 15.0, [1.0; 3]),
    // The same numbers as the OBJ's, but declared as centimetres; the take begins a frame earlier.
    frame("blender_279_sausage_base_0", &["blender_279_sausage_6100_ascii"], "Base", 1.0, [0.01; 3]),
    frame("blender_279_sausage_spin_15", &["blender_279_sausage_6100_ascii"], "Spin", 16.0, [0.01; 3]),
    frame("maya_game_sausage_deform_8", &DEFORM, "deform", 8.0, [0.01; 3]),
    frame("maya_game_sausage_spin_7", &SPIN, "spin", 7.0, [0.01; 3]),
    // This take begins at frame 1.
    frame("maya_game_sausage_wiggle_10", &WIGGLE, "wiggle", 9.0, [0.01; 3]),
    frame("maya_game_sausage_wiggle_lefthanded_10", &WIGGLE, "wiggle", 9.0, [0.01, 0.01, -0.01]),
    frame("motionbuilder_sausage_rrss_12", &MOTION_BUILDER, "Take 001", 12.0, [0.01; 3]),
    frame("motionbuilder_sausage_rrss_36", &MOTION_BUILDER, "Take 001", 36.0, [0.01; 3]),
];

const DEFORM: [&str; 4] = [
    "maya_game_sausage_6100_ascii_deform",
    "maya_game_sausage_6100_binary_deform",
    "maya_game_sausage_7500_ascii_deform",
    "maya_game_sausage_7500_binary_deform",
];
const SPIN: [&str; 4] = [
    "maya_game_sausage_6100_ascii_spin",
    "maya_game_sausage_6100_binary_spin",
    "maya_game_sausage_7500_ascii_spin",
    "maya_game_sausage_7500_binary_spin",
];
const WIGGLE: [&str; 4] = [
    "maya_game_sausage_6100_ascii_wiggle",
    "maya_game_sausage_6100_binary_wiggle",
    "maya_game_sausage_7500_ascii_wiggle",
    "maya_game_sausage_7500_binary_wiggle",
];
const MOTION_BUILDER: [&str; 2] = ["motionbuilder_sausage_rrss_7700_ascii", "motionbuilder_sausage_rrss_7700_binary"];

#[test]
fn frames_look_as_other_programs_exported_them() {
    let Some(folder) = data_folder() else { return };
    let folder = folder.join("fbx/ufbx");
    for Frame { obj, files, clip, frame, factors } in FRAMES {
        let text =
            String::from_utf8_lossy(&std::fs::read(folder.join(obj).with_extension("obj")).unwrap()).into_owned();
        let expected: Vec<[f64; 3]> = text
            .lines()
            .filter_map(|line| line.strip_prefix("v "))
            .map(|line| {
                let values: Vec<f64> = line.split_whitespace().map(|value| value.parse().unwrap()).collect();
                std::array::from_fn(|axis| values[axis] * factors[axis])
            })
            .collect();
        let size = size(&expected);
        for file in files {
            let bytes = std::fs::read(folder.join(file).with_extension("fbx")).unwrap();
            let glb = Glb::new(&gaitway_fbx::convert(&bytes).unwrap().bytes);
            let scene = reference(&bytes).unwrap();
            let stack = scene.anim_stacks.into_iter().find(|stack| stack.element.name.ends_with(clip)).unwrap();
            let named = |animation: &serde_json::Value| animation["name"] == *stack.element.name;
            let index = glb.list("animations").iter().position(named).unwrap();
            let time = frame / scene.settings.frames_per_second;
            let found = glb.vertices(&glb.pose(Some((index, time))));
            let error = distance(&found, &expected, 0.1 * size) / size;
            println!("{file} at {time} s: {error} of size from {obj}");
            assert!(error < 1e-3, "{file} at {time} s: {error} of size from {obj}");
        }
    }
}

/// FBX files and FBX2glTF's conversions of them, at 30 keys per second.
const OTHER_CONVERTER: [[&str; 2]; 4] = [
    ["threejs/Samba_Dancing.fbx", "threejs/Samba_Dancing.glb"],
    ["cosc422/original/Mannequin/run.fbx", "cosc422/mannequin_run.glb"],
    ["fbx/cmu_91_48.fbx", "mesh2motion/cmu_91_48.glb"],
    ["fbx/cmu_91_51.fbx", "mesh2motion/cmu_91_51.glb"],
];

#[test]
fn clips_move_as_another_converter_sees_them() {
    let Some(folder) = data_folder() else { return };
    for [fbx, glb] in OTHER_CONVERTER {
        let converted = gaitway_fbx::convert(&std::fs::read(folder.join(fbx)).unwrap()).unwrap();
        let (ours, theirs) = (Glb::new(&converted.bytes), Glb::new(&std::fs::read(folder.join(glb)).unwrap()));
        let named = |glb: &Glb, clip| -> HashMap<String, [f64; 3]> {
            let pose = glb.pose(Some((0, clip)));
            let nodes = glb.list("nodes").iter().zip(pose.worlds);
            let named = nodes.filter_map(|(node, world)| Some((node["name"].as_str()?.to_owned(), world[3])));
            named.map(|(name, [x, y, z, _])| (name, [x, y, z])).collect()
        };
        for frame in [0, 5, 17] {
            let time = f64::from(frame) / 30.0;
            let (ours, theirs) = (named(&ours, time), named(&theirs, time));
            let common: Vec<_> = theirs.iter().filter_map(|(name, place)| Some((ours.get(name)?, place))).collect();
            let size = size(common.iter().map(|(ours, _)| *ours));
            let error = common.iter().map(|(a, b)| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max));
            let error = error.fold(0.0, f64::max) / size;
            println!("{fbx} at {time} s: {} joints within {error} of size {size}", common.len());
            assert!(common.len() > 40 && error < 1e-5, "{fbx} at {time} s: {} joints, {error}", common.len());
        }
    }
}
