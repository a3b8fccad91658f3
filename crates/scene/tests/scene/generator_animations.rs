//! Khronos's glTF Asset Generator: `Animation_*` files match the tables in their READMEs.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use gaitway_character::anim::LoopMode;
use gaitway_scene::frame::{Frame, evaluate, pose_document};
use gaitway_scene::library::Library;
use gaitway_scene::state::{CharacterView, ClipChoice, Playback, Playhead, ViewerState};
use glam::{Affine3A, Quat, Vec3};

use crate::data::open;

fn file(name: &str) -> Option<Library> {
    let (folder, _) = name.rsplit_once('_').expect("FOLDER_NUMBER");
    open(&format!("asset-generator/Positive/{folder}/{name}.gltf"))
}

fn at(clip: usize, time_secs: f64) -> ViewerState {
    let clip = ClipChoice::called(&clip.to_string());
    ViewerState {
        character: CharacterView {
            playhead: Playhead { clip, time_secs, ..Playhead::default() },
            ..CharacterView::default()
        },
        playback: Playback { loop_mode: LoopMode::Once, ..Playback::default() },
        ..ViewerState::default()
    }
}

fn world_from_node(library: &Library, node: usize, state: &ViewerState) -> Affine3A {
    let mut frame = Frame::default();
    evaluate(library, state, 1.0, &mut frame);
    let joint = library.active().expect("a model").asset.skeleton.joint_of_source(node).expect("a node");
    frame.characters[0].world_from_joint[joint.get()]
}

/// Checks the translation and rotation of node 0 at a time of the first clip.
fn check(name: &str, time_secs: f64, translation: Vec3, rotation: Quat) {
    check_clip(name, 0, time_secs, translation, rotation);
}

fn check_clip(name: &str, clip: usize, time_secs: f64, translation: Vec3, rotation: Quat) {
    let Some(library) = file(name) else { return };
    let found = world_from_node(&library, 0, &at(clip, time_secs));
    let expected = Affine3A::from_rotation_translation(rotation, translation);
    assert!(found.abs_diff_eq(expected, 2e-5), "{name} at {time_secs} s: {found:?} instead of {expected:?}");
}

/// Returns the positions of one mesh instance, by the index of its node.
fn positions(library: &Library, node: usize, state: &ViewerState) -> Vec<Vec3> {
    let document = pose_document(library, state);
    let meshes = document["meshes"].as_array().expect("meshes");
    let mesh = meshes.iter().find(|mesh| mesh["node"] == node).expect("a mesh on the node");
    let numbers = mesh["positions"].as_array().expect("positions").iter();
    let numbers: Vec<f32> = numbers.filter_map(|number| number.as_f64()).map(|number| number as f32).collect();
    numbers.chunks_exact(3).map(Vec3::from_slice).collect()
}

fn apart(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

const STILL: Vec3 = Vec3::ZERO;

fn about_y(angle_radians: f32) -> Quat {
    Quat::from_rotation_y(angle_radians)
}

fn along_x(x: f32) -> Vec3 {
    Vec3::new(x, 0.0, 0.0)
}

#[test]
fn node_00_translation_linear() {
    for (time_secs, x) in [(0.0, -0.1), (0.5, 0.0), (0.75, 0.05), (1.0, 0.1), (1.5, 0.0), (2.0, -0.1)] {
        check("Animation_Node_00", time_secs, along_x(x), Quat::IDENTITY);
    }
}

#[test]
fn node_01_rotation_linear_takes_the_shortest_arc_at_constant_speed() {
    for (time_secs, turn) in [(0.0, 1.0), (0.25, 0.75), (0.5, 0.5), (1.0, 0.0), (1.5, -0.5), (2.0, -1.0), (3.9, 0.9)] {
        check("Animation_Node_01", time_secs, STILL, about_y(turn * FRAC_PI_2));
    }
}

#[test]
fn node_02_scale_linear() {
    let Some(library) = file("Animation_Node_02") else { return };
    for (time_secs, scale) in [(0.0, 0.8), (0.5, 1.0), (1.0, 1.2), (1.25, 1.1)] {
        let found = world_from_node(&library, 0, &at(0, time_secs));
        assert!(found.abs_diff_eq(Affine3A::from_scale(Vec3::splat(scale)), 1e-6), "{time_secs}: {found:?}");
    }
}

#[test]
fn node_03_translation_step() {
    for (time_secs, x) in [(0.0, -0.1), (0.999, -0.1), (1.0, 0.0), (1.999, 0.0), (2.5, 0.1), (3.5, 0.0), (4.0, -0.1)] {
        check("Animation_Node_03", time_secs, along_x(x), Quat::IDENTITY);
    }
}

#[test]
fn node_04_translation_cubic_spline() {
    // At the middle the value is the mean of the keys plus an eighth of the tangents' difference: out-tangent of the
    // middle key is −0.3 along Y, all others are zero.
    check("Animation_Node_04", 0.5, along_x(0.0), Quat::IDENTITY);
    check("Animation_Node_04", 1.0, along_x(0.1), Quat::IDENTITY);
    check("Animation_Node_04", 1.5, Vec3::new(0.0, -0.3 / 8.0, 0.0), Quat::IDENTITY);
    // At a quarter: h00 = 27/32.
    check("Animation_Node_04", 0.25, along_x(-0.1 * 27.0 / 32.0 + 0.1 * 5.0 / 32.0), Quat::IDENTITY);
}

#[test]
fn node_05_rotation_cubic_spline() {
    check("Animation_Node_05", 0.0, STILL, about_y(FRAC_PI_2));
    check("Animation_Node_05", 0.5, STILL, about_y(FRAC_PI_4));
    check("Animation_Node_05", 1.0, STILL, Quat::IDENTITY);
    check("Animation_Node_05", 2.0, STILL, about_y(-FRAC_PI_2));
    let (from, to) = (about_y(FRAC_PI_2), Quat::IDENTITY);
    check("Animation_Node_05", 0.25, STILL, (from * (27.0 / 32.0) + to * (5.0 / 32.0)).normalize());
}

#[test]
fn misc_00_two_channels_at_once() {
    check("Animation_NodeMisc_00", 1.0, along_x(0.0), Quat::IDENTITY);
    check("Animation_NodeMisc_00", 2.0, along_x(0.1), about_y(-FRAC_PI_2));
}

#[test]
fn misc_01_holds_the_first_value_until_the_first_key() {
    check("Animation_NodeMisc_01", 0.0, STILL, about_y(FRAC_PI_2));
    check("Animation_NodeMisc_01", 1.0, STILL, about_y(FRAC_PI_2));
    check("Animation_NodeMisc_01", 1.5, STILL, about_y(FRAC_PI_4));
}

#[test]
fn misc_02_channels_hold_outside_their_own_keys() {
    check("Animation_NodeMisc_02", 0.0, Vec3::new(0.0, -0.1, 0.0), about_y(FRAC_PI_2));
    check("Animation_NodeMisc_02", 3.0, Vec3::new(0.0, 0.0, 0.0), about_y(-FRAC_PI_2));
    check("Animation_NodeMisc_02", 5.5, Vec3::new(0.0, -0.05, 0.0), about_y(FRAC_PI_2));
}

#[test]
fn misc_03_a_single_key_holds_forever() {
    check("Animation_NodeMisc_03", 0.0, along_x(-0.1), Quat::IDENTITY);
    check("Animation_NodeMisc_03", 9.0, along_x(-0.1), Quat::IDENTITY);
}

#[test]
fn misc_04_two_nodes() {
    let Some(library) = file("Animation_NodeMisc_04") else { return };
    let half = Vec3::splat(0.5);
    for (node, rotation, x) in [(0, about_y(FRAC_PI_4), -0.2), (1, Quat::from_rotation_x(FRAC_PI_4), 0.2)] {
        let expected = Affine3A::from_scale_rotation_translation(half, rotation, along_x(x));
        assert!(world_from_node(&library, node, &at(0, 0.5)).abs_diff_eq(expected, 1e-5), "node {node}");
    }
}

#[test]
fn misc_05_a_channel_overrides_the_nodes_value() {
    check("Animation_NodeMisc_05", 0.0, STILL, about_y(-60_f32.to_radians()));
    check("Animation_NodeMisc_05", 4.0, STILL, about_y(-60_f32.to_radians()));
}

#[test]
fn misc_06_properties_without_a_channel_keep_their_value() {
    check("Animation_NodeMisc_06", 1.0, along_x(0.0), about_y(60_f32.to_radians()));
    check("Animation_NodeMisc_06", 2.0, along_x(0.1), about_y(60_f32.to_radians()));
}

#[test]
fn misc_07_two_clips_play_independently() {
    check_clip("Animation_NodeMisc_07", 0, 2.0, STILL, about_y(-FRAC_PI_2));
    check_clip("Animation_NodeMisc_07", 1, 2.0, along_x(0.1), Quat::IDENTITY);
}

#[test]
fn misc_08_a_channel_without_a_node_is_ignored() {
    check("Animation_NodeMisc_08", 0.5, STILL, Quat::from_rotation_x(FRAC_PI_4));
    check("Animation_NodeMisc_08", 2.0, STILL, Quat::from_rotation_x(-FRAC_PI_2));
}

#[test]
fn sampler_types_give_the_same_motion() {
    for name in ["Animation_SamplerType_00", "Animation_SamplerType_01", "Animation_SamplerType_02"] {
        for (time_secs, turn) in [(0.0, 1.0), (0.5, 0.5), (1.0, 0.0), (2.0, -1.0)] {
            check(name, time_secs, STILL, about_y(turn * FRAC_PI_2));
        }
    }
}

#[test]
fn skin_02_ignores_the_transforms_of_the_skinned_node_and_its_parent() {
    let (Some(plain), Some(moved)) = (file("Animation_Skin_00"), file("Animation_Skin_02")) else { return };
    let rest = ViewerState {
        character: CharacterView {
            playhead: Playhead { clip: ClipChoice::RestPose, ..Playhead::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    assert!(apart(&positions(&plain, 0, &rest), &positions(&moved, 1, &rest)) < 1e-6);
}

#[test]
fn skin_03_without_inverse_bind_matrices_only_its_joints_place_it() {
    let Some(library) = file("Animation_Skin_03") else { return };
    let rest = ViewerState {
        character: CharacterView {
            playhead: Playhead { clip: ClipChoice::RestPose, ..Playhead::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    let asset = &library.active().expect("a model").asset;
    let geometry = &asset.meshes[0].primitives[0];
    let joints = [1, 2].map(|node| world_from_node(&library, node, &rest));
    let expected: Vec<Vec3> = (0..geometry.file_vertices)
        .map(|vertex| {
            let influences = geometry.influences.of_vertex(vertex);
            let placed = |(joint, weight)| weight * joints[joint as usize].transform_point3(geometry.positions[vertex]);
            influences.filter(|(_, weight)| *weight > 0.0).map(placed).sum()
        })
        .collect();
    assert!(apart(&positions(&library, 0, &rest), &expected) < 1e-6);
}

#[test]
fn skin_04_a_mesh_on_a_joint_moves_with_it() {
    let Some(library) = file("Animation_Skin_04") else { return };
    let geometry = &library.active().expect("a model").asset.meshes[1].primitives[0].positions;
    for time_secs in [0.0, 0.5, 1.0] {
        let world_from_joint = world_from_node(&library, 2, &at(0, time_secs));
        let expected: Vec<Vec3> =
            geometry.iter().map(|&position| world_from_joint.transform_point3(position)).collect();
        assert!(apart(&positions(&library, 3, &at(0, time_secs)), &expected) < 1e-6, "{time_secs}");
    }
}

#[test]
fn skin_05_and_07_share_skins_and_joints() {
    if let Some(library) = file("Animation_Skin_05") {
        let ranges: Vec<usize> = draws(&library);
        assert_eq!(ranges, [2, 2]);
    }
    if let Some(library) = file("Animation_Skin_07") {
        assert_eq!(draws(&library), [2, 2]);
        // Both prisms bend with the joint they share.
        for node in [0, 3] {
            assert!(apart(&positions(&library, node, &at(0, 0.0)), &positions(&library, node, &at(0, 1.0))) > 0.05);
        }
    }
}

/// Returns the number of palette entries of each draw.
fn draws(library: &Library) -> Vec<usize> {
    let mut frame = Frame::default();
    evaluate(library, &ViewerState::default(), 1.0, &mut frame);
    frame.characters[0].draws.iter().map(|draw| draw.palette.len()).collect()
}

#[test]
fn skin_06_joints_need_no_common_root() {
    let (Some(chain), Some(roots)) = (file("Animation_Skin_00"), file("Animation_Skin_06")) else { return };
    let rest = ViewerState {
        character: CharacterView {
            playhead: Playhead { clip: ClipChoice::RestPose, ..Playhead::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    // The second joint is at the same position, but given in world space.
    assert!(apart(&positions(&chain, 0, &rest), &positions(&roots, 0, &rest)) < 1e-5);
}

#[test]
fn skin_09_a_node_that_is_not_a_joint_moves_the_joint_below_it() {
    let Some(library) = file("Animation_Skin_09") else { return };
    let at_rest = world_from_node(&library, 5, &at(0, 0.0)).translation;
    let bent = world_from_node(&library, 5, &at(0, 1.0)).translation;
    assert!(at_rest.distance(bent) > 0.1);
    let carried = world_from_node(&library, 4, &at(0, 1.0)).transform_point3(Vec3::new(0.0, 0.0, 0.2));
    assert!(carried.distance(bent.into()) < 1e-5);
}

#[test]
fn skin_11_one_mesh_with_two_skins() {
    let Some(library) = file("Animation_Skin_11") else { return };
    let rest = ViewerState {
        character: CharacterView {
            playhead: Playhead { clip: ClipChoice::RestPose, ..Playhead::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    let (first, second) = (positions(&library, 0, &rest), positions(&library, 3, &rest));
    let moved: Vec<Vec3> = first.iter().map(|position| position + Vec3::X * 0.6).collect();
    assert!(apart(&moved, &second) < 1e-5);
}

#[test]
fn weight_types_give_the_same_shape() {
    let Some(expected) = file("Animation_SkinType_00") else { return };
    for name in ["Animation_SkinType_01", "Animation_SkinType_02", "Animation_SkinType_03"] {
        let Some(library) = file(name) else { return };
        for time_secs in [0.0, 0.5, 1.0] {
            let state = at(0, time_secs);
            // Byte weights have steps of 1/255.
            assert!(
                apart(&positions(&library, 0, &state), &positions(&expected, 0, &state)) < 2e-3,
                "{name} {time_secs}"
            );
        }
    }
}
