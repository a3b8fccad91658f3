//! Each lint fires on the smallest model with the trouble, and says nothing about the same model without it.

use gaitway_character::anim::{ClipBuilder, Interpolation, Joint, JointIndex, Keys, Skeleton, Transform};
use gaitway_character::asset::{Asset, AssetParts, MeshInstance};
use gaitway_character::mesh::{Geometry, Influences, Mesh, Skin};
use gaitway_retarget::recognize;
use glam::{Affine3A, Quat, Vec3};

use super::{joint_of_place, lint};

/// Root, hips, head, head end, and a pole beside the hips; the mesh is on a node of its own.
const NAMES: [&str; 6] = ["Root", "Hips", "Head", "Head_End", "Pole", "Body"];
const HIPS: JointIndex = JointIndex(1);
const HEAD: JointIndex = JointIndex(2);

fn skeleton(hips_scale: Vec3) -> Skeleton {
    let parents = [None, Some(0), Some(1), Some(2), Some(0), None];
    let joint = |(index, parent): (usize, Option<usize>)| {
        let scale = if index == 1 { hips_scale } else { Vec3::ONE };
        let rest = Transform { translation: Vec3::Y, scale, ..Transform::IDENTITY };
        Joint { name: NAMES[index].to_owned(), parent, rest, ..Joint::default() }
    };
    Skeleton::new(parents.into_iter().enumerate().map(joint).collect()).expect("parents come first")
}

/// A triangle skinned to hips and head, with these joints in its skin.
fn parts(skeleton: Skeleton, in_skin: &[&str]) -> AssetParts {
    let joints: Vec<JointIndex> = in_skin.iter().map(|name| skeleton.find(name).expect("there")).collect();
    let matrices = vec![Affine3A::IDENTITY; joints.len()];
    let skin = Skin::new(String::new(), joints, matrices, skeleton.len()).expect("as many matrices");
    let influences = Influences { stride: 4, joints: [0, 1, 0, 0].repeat(3), weights: [0.5, 0.5, 0.0, 0.0].repeat(3) };
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let geometry = Geometry { file_vertices: 3, positions, indices: vec![0, 1, 2], influences, ..Geometry::default() };
    AssetParts {
        meshes: vec![Mesh { primitives: vec![geometry], ..Mesh::default() }],
        skins: vec![skin],
        instances: vec![MeshInstance::new(skeleton.find("Body").expect("there"), 0, Some(0))],
        skeleton,
        ..AssetParts::default()
    }
}

fn plain() -> AssetParts {
    parts(skeleton(Vec3::ONE), &["Hips", "Head"])
}

/// Codes and places of the lints of an asset.
#[track_caller]
fn check(parts: AssetParts, expected: &[(&str, &str)]) {
    let asset = Asset::new(parts).expect("indices in range");
    let lints = lint(&asset, &recognize(&asset));
    let found: Vec<(&str, &str)> = lints.iter().map(|lint| (lint.code(), lint.place())).collect();
    assert_eq!(found, expected, "{:?}", lints.iter().map(ToString::to_string).collect::<Vec<_>>());
}

#[test]
fn a_model_without_trouble_has_no_lints() {
    check(plain(), &[]);
    check(AssetParts::default(), &[]);
}

#[test]
fn influences_without_a_skin_are_unused() {
    let mut parts = plain();
    parts.instances[0].skin = None;
    check(parts, &[("influences-unused", "meshes[0]")]);
    // Drawn with and without: some node needs them.
    let mut parts = plain();
    parts.instances.push(MeshInstance { skin: None, ..parts.instances[0] });
    check(parts, &[]);
}

#[test]
fn joints_that_move_nothing_are_found_but_not_ends_of_chains() {
    check(parts(skeleton(Vec3::ONE), &["Hips", "Head", "Head_End"]), &[]);
    // The root moves vertices through the hips.
    check(parts(skeleton(Vec3::ONE), &["Hips", "Head", "Root"]), &[]);
    check(parts(skeleton(Vec3::ONE), &["Hips", "Head", "Pole"]), &[("joints-without-effect", "nodes[4]")]);
    // A prop hangs on it.
    let mut with_prop = parts(skeleton(Vec3::ONE), &["Hips", "Head", "Pole"]);
    with_prop.instances.push(MeshInstance::new(JointIndex(4), 0, None));
    check(with_prop, &[]);
}

#[test]
fn non_uniform_scale_matters_above_joints_only() {
    let stretched = Vec3::new(1.0, 2.0, 1.0);
    check(parts(skeleton(stretched), &["Hips", "Head"]), &[("scale-non-uniform", "nodes[1]")]);
    check(parts(skeleton(Vec3::splat(2.0)), &["Hips", "Head"]), &[]);
    check(parts(skeleton(Vec3::new(-1.0, 1.0, 1.0)), &["Hips", "Head"]), &[]);
    let animate = |joint, scale| {
        with_clip("Squash", &[0.0, 1.0], joint, Keys::Scale(vec![Vec3::ONE, scale]), Interpolation::Linear)
    };
    check(animate(HIPS, stretched), &[("scale-non-uniform", "nodes[1]")]);
    check(animate(HIPS, Vec3::splat(2.0)), &[]);
    check(animate(HEAD, stretched), &[]);
    // Tangents may be anything.
    let spline = |scale| {
        let keys = Keys::Scale(vec![Vec3::X, scale, Vec3::X]);
        with_clip("Squash", &[0.0], HIPS, keys, Interpolation::CubicSpline)
    };
    check(spline(stretched), &[("scale-non-uniform", "nodes[1]")]);
    check(spline(Vec3::splat(2.0)), &[]);
}

fn with_clip(name: &str, times: &[f32], joint: JointIndex, keys: Keys, interpolation: Interpolation) -> AssetParts {
    let mut parts = plain();
    let mut builder = ClipBuilder::new(name, &parts.skeleton);
    builder.channel(joint, interpolation, times, keys).expect("keys fit");
    let clip = builder.build();
    parts.clips.push(clip);
    parts
}

#[test]
fn rotations_that_are_not_unit_quaternions_are_found() {
    let turned = |length: f32, interpolation| {
        let tangent = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
        let values = match interpolation {
            Interpolation::CubicSpline => {
                vec![tangent, Quat::IDENTITY, tangent, tangent, Quat::IDENTITY * length, tangent]
            }
            _ => vec![Quat::IDENTITY, Quat::IDENTITY * length],
        };
        with_clip("Turn", &[0.0, 1.0], HEAD, Keys::Rotation(values), interpolation)
    };
    for interpolation in [Interpolation::Linear, Interpolation::CubicSpline] {
        check(turned(1.0, interpolation), &[]);
        // Normalized bytes.
        check(turned(1.005, interpolation), &[]);
        check(turned(1.02, interpolation), &[("rotation-not-unit", "nodes[2]")]);
    }
}

#[test]
fn keys_on_straight_lines_are_too_dense() {
    let moved = |wave: f32| {
        let times: Vec<f32> = (0..12_000).map(|frame| frame as f32 / 30.0).collect();
        let values = times.iter().map(|time| Vec3::new(0.1 * time, wave * (9.0 * time).sin(), 0.0)).collect();
        with_clip("Slide", &times, HIPS, Keys::Translation(values), Interpolation::Linear)
    };
    check(moved(0.0), &[("keys-too-dense", "nodes[1]")]);
    check(moved(0.5), &[]);
}

#[test]
fn a_loop_that_does_not_close_is_found_by_its_name() {
    // The last of 30 frames is this far from the first; each frame turns by 2°.
    let walk = |name: &str, jump_degrees: f32| {
        let times: Vec<f32> = (0..30).map(|frame| frame as f32 / 30.0).collect();
        let angle = |frame: i32| if frame < 15 { 2.0 * frame as f32 } else { 2.0 * (29 - frame) as f32 };
        let offset = |frame: i32| if frame < 15 { 0.0 } else { jump_degrees };
        let degrees = (0..30).map(|frame| angle(frame) + offset(frame));
        let values = degrees.map(|degrees: f32| Quat::from_rotation_x(degrees.to_radians())).collect();
        with_clip(name, &times, HEAD, Keys::Rotation(values), Interpolation::Linear)
    };
    check(walk("Walk", 0.0), &[]);
    check(walk("Walk", 20.0), &[("loop-open", "nodes[2]")]);
    check(walk("Wave", 20.0), &[]);
    check(walk("Idle to walk", 20.0), &[]);
    check(walk("Walk", 90.0), &[]);
    check(walk("Crunch", 20.0), &[]);
    check(walk("Bend_walk", 20.0), &[("loop-open", "nodes[2]")]);
}

#[test]
fn places_lead_to_nodes() {
    let asset = Asset::new(plain()).expect("indices in range");
    let number = |place| joint_of_place(&asset, place).map(|joint| asset.skeleton.source_index(joint));
    let body = Some(5);
    for (place, node) in [
        ("nodes[2]", Some(2)),
        ("/nodes/2/scale", Some(2)),
        ("nodes[99]", None),
        ("meshes[0].primitives[0]", body),
        ("/meshes/0/primitives/0/attributes/WEIGHTS_0", body),
        ("meshes[1]", None),
        ("skins[0]", Some(1)),
        ("/skins/0/joints/1", Some(2)),
        ("skins[0].joints[9]", None),
        ("/materials/0", None),
        ("animations[0].channels[1]", None),
        ("extensionsUsed", None),
        ("", None),
    ] {
        assert_eq!(number(place), node, "{place}");
    }
}
