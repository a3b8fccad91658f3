//! The skinning exercise's real files against its formula in double precision: as they are read, and as they are written.

use gaitway_character::anim::model_from_joint;
use gaitway_character::asset::Asset;
use gaitway_character::mesh::{DeformedVertices, SkinningMode, deform, write_palette};
use gaitway_formats::{FileSet, LoadOptions, convert, load};
use glam::{Affine3A, DMat4, DVec3, Vec3};

use crate::coursework::{Exercise, pose};
use crate::data_folder::data_folder;
use crate::write::{chunks_of, json_of};

fn real(name: &str) -> Option<(Asset, Exercise, FileSet)> {
    let folder = data_folder()?.join("mit6837");
    let mut files = FileSet::default();
    let text = |kind: &str| std::fs::read_to_string(folder.join(format!("{name}.{kind}"))).expect("a real file");
    for kind in ["obj", "skel", "attach"] {
        files.insert(format!("{name}.{kind}"), text(kind).into_bytes());
    }
    Some((load(&files).expect("it loads"), Exercise::read(&text("obj"), &text("skel"), &text("attach")), files))
}

/// All vertices as the CPU reference deforms them with these joint rotations.
fn deformed(asset: &Asset, locals: &[glam::Quat], mode: SkinningMode) -> Vec<Vec3> {
    let skeleton = &asset.skeleton;
    let mut pose = skeleton.rest().clone();
    for (source, &rotation) in locals.iter().enumerate() {
        pose.set_rotation(skeleton.joint_of_source(source).unwrap(), rotation);
    }
    let (mut world, mut palette) = (Vec::new(), Vec::new());
    model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut world);
    write_palette(&asset.skins[0], &world, mode, &mut palette);
    let mut moved = DeformedVertices::default();
    deform(&asset.meshes[0].primitives[0], &[], &palette, mode, &mut moved);
    moved.positions
}

#[test]
fn exercise_models_match_the_formula_at_rest_and_bent() {
    for name in ["Model1", "Model2", "Model3", "Model4"] {
        let Some((asset, exercise, _)) = real(name) else { return };
        assert_eq!(
            (asset.skeleton.len(), exercise.vertices.len(), asset.meshes[0].primitives[0].triangles()),
            (18, 13336, 26668)
        );
        assert_eq!(asset.warnings.len(), 0, "{name}");
        assert_eq!(asset.skeleton.name(asset.skeleton.joint_of_source(7).unwrap()), "joint 7");
        let largest = |moved: &[Vec3], wanted: &[DVec3]| {
            assert_eq!(moved.len(), wanted.len());
            moved.iter().zip(wanted).map(|(a, b)| a.as_dvec3().distance(*b)).fold(0.0, f64::max)
        };
        let rest = vec![glam::Quat::IDENTITY; 18];
        for mode in [SkinningMode::Linear, SkinningMode::Rigid, SkinningMode::DualQuaternion] {
            let off = largest(&deformed(&asset, &rest, mode), &exercise.vertices);
            assert!(off < 1e-6, "{name} at rest, {mode:?}: {off}");
        }
        for seed in 1..=8 {
            let (exact, rounded) = pose(18, seed);
            let off = largest(&deformed(&asset, &rounded, SkinningMode::Linear), &exercise.skinned(&exact));
            assert!(off < 1e-6, "{name}, pose {seed}: {off}");
        }
    }
}

#[test]
fn a_written_exercise_model_matches_the_formula_in_another_reader() {
    for name in ["Model1", "Model3"] {
        let Some((_, exercise, files)) = real(name) else { return };
        let written = convert(&files, &LoadOptions::default()).unwrap();
        let (json, (_, binary)) = (json_of(&written), chunks_of(&written));
        let (exact, _) = pose(18, 5);
        let found = bent_glb(&json, binary, &exact);
        let off = found.iter().zip(exercise.skinned(&exact)).map(|(a, b)| a.distance(b)).fold(0.0, f64::max);
        assert_eq!(found.len(), exercise.vertices.len());
        assert!(off < 1e-6, "{name}: {off}");
        // And in our own reader.
        let mut set = FileSet::default();
        set.insert("written.glb", written);
        let asset = load(&set).unwrap();
        assert_eq!(
            (asset.warnings.len(), asset.meshes[0].primitives[0].influences.stride),
            (0, if name == "Model3" { 12 } else { 16 })
        );
    }
}

/// The accessors of a GLB as numbers in double precision, without any code of the real reader.
struct Numbers<'a> {
    json: &'a serde_json::Value,
    binary: &'a [u8],
}

impl Numbers<'_> {
    fn index(value: &serde_json::Value) -> usize {
        value.as_u64().unwrap_or(0) as usize
    }

    fn read(&self, accessor: &serde_json::Value) -> Vec<f64> {
        let accessor = &self.json["accessors"][Self::index(accessor)];
        let view = &self.json["bufferViews"][Self::index(&accessor["bufferView"])];
        let bytes = &self.binary[Self::index(&view["byteOffset"]) + Self::index(&accessor["byteOffset"])..];
        let width = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            other => panic!("{other}"),
        };
        let count = Self::index(&accessor["count"]) * width;
        match Self::index(&accessor["componentType"]) {
            5123 => bytes[..2 * count]
                .as_chunks::<2>()
                .0
                .iter()
                .map(|bytes| f64::from(u16::from_le_bytes(*bytes)))
                .collect(),
            5126 => bytes[..4 * count]
                .as_chunks::<4>()
                .0
                .iter()
                .map(|bytes| f64::from(f32::from_le_bytes(*bytes)))
                .collect(),
            other => panic!("{other}"),
        }
    }
}

/// World matrices of all nodes, rotated by `rotations`.
fn node_matrices(json: &serde_json::Value, rotations: &[glam::DQuat]) -> Vec<DMat4> {
    let nodes = json["nodes"].as_array().unwrap();
    let mut parent: Vec<Option<usize>> = vec![None; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for child in node["children"].as_array().into_iter().flatten() {
            parent[Numbers::index(child)] = Some(index);
        }
    }
    let mut world = vec![DMat4::IDENTITY; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        let coordinate = |axis: usize| node["translation"][axis].as_f64().unwrap_or(0.0);
        let translation = DVec3::new(coordinate(0), coordinate(1), coordinate(2));
        let local = DMat4::from_rotation_translation(rotations.get(index).copied().unwrap_or_default(), translation);
        // Parents precede children in these files.
        world[index] = parent[index].map_or(local, |parent| world[parent] * local);
    }
    world
}

/// Deforms a skinned GLB in double precision, joints rotated by `rotations`.
fn bent_glb(json: &serde_json::Value, binary: &[u8], rotations: &[glam::DQuat]) -> Vec<DVec3> {
    let numbers = Numbers { json, binary };
    let world = node_matrices(json, rotations);
    let attributes = &json["meshes"][0]["primitives"][0]["attributes"];
    let skin = &json["skins"][0];
    let inverse = numbers.read(&skin["inverseBindMatrices"]);
    let joints = skin["joints"].as_array().unwrap().iter().zip(inverse.as_chunks::<16>().0);
    let palette: Vec<DMat4> =
        joints.map(|(joint, inverse)| world[Numbers::index(joint)] * DMat4::from_cols_array(inverse)).collect();
    let sets: Vec<[Vec<f64>; 2]> = (0..4)
        .map(|set| [format!("JOINTS_{set}"), format!("WEIGHTS_{set}")])
        .filter(|[joints, _]| !attributes[joints].is_null())
        .map(|keys| keys.map(|key| numbers.read(&attributes[key])))
        .collect();
    let positions = numbers.read(&attributes["POSITION"]);
    let vertices = positions.as_chunks::<3>().0.iter().enumerate();
    vertices
        .map(|(vertex, position)| {
            let mut sum = DVec3::ZERO;
            for [joints, weights] in &sets {
                for at in 4 * vertex..4 * vertex + 4 {
                    sum += weights[at] * palette[joints[at] as usize].transform_point3(DVec3::from_array(*position));
                }
            }
            sum
        })
        .collect()
}
