//! Spring bones: gravity, colliders and limits, and a result that depends on the time alone.

use gaitway_character::anim::LoopMode;
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::state::{ClipChoice, Command, ViewerState, apply};
use glam::{Quat, Vec3};
use serde_json::{Value, json};

use super::{frame, library, model, person, position, rotation};
use crate::build_gltf::{Build, F32, floats};

/// A chain of spring joints along +X. Its clip moves the root one metre along +Z and back within a second.
pub fn chain(gravity: f32, colliders: Value) -> Build {
    let mut build = Build::new();
    let times = build.accessor(F32, "SCALAR", 3, &floats(&[0.0, 0.5, 1.0]));
    let places = build.accessor(F32, "VEC3", 3, &floats(&[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]));
    build.json["nodes"] = json!([
        { "name": "root", "children": [1, 4] },
        { "name": "a", "children": [2] },
        { "name": "b", "translation": [0.2, 0.0, 0.0], "children": [3] },
        { "name": "c", "translation": [0.2, 0.0, 0.0] },
        { "name": "obstacle", "translation": [0.02, -0.38, 0.0] },
    ]);
    build.json["animations"] = json!([{
        "name": "swing",
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }],
        "samplers": [{ "input": times, "output": places }],
    }]);
    let spring = |node: usize| {
        json!({
            "node": node, "hitRadius": 0.02, "stiffness": 0.8, "gravityPower": gravity,
            "gravityDir": [0, -1, 0], "dragForce": 0.3,
        })
    };
    let springs = json!([{ "joints": [spring(1), spring(2), { "node": 3 }], "colliderGroups": [0] }]);
    let group = (0..colliders.as_array().map_or(0, Vec::len)).collect::<Vec<_>>();
    build.json["extensionsUsed"] = json!(["VRMC_springBone"]);
    build.json["extensions"] = json!({ "VRMC_springBone": {
        "specVersion": "1.0", "colliders": colliders, "colliderGroups": [{ "colliders": group }], "springs": springs,
    } });
    build
}

#[test]
fn pairs_of_spring_joint_and_collider_are_limited() {
    let mut build = chain(0.0, vec![json!({ "node": 4, "shape": { "sphere": { "radius": 0.1 } } }); 1000].into());
    let springs = &mut build.json["extensions"]["VRMC_springBone"]["springs"];
    *springs = vec![springs[0].clone(); 40].into();
    let asset = build.load().expect("springs never prevent loading");
    let left_out: Vec<&str> = asset.warnings.iter().map(|warning| warning.place()).collect();
    // Three joints of 1,000 colliders each: 21 springs take 63,000 of 65,536.
    assert_eq!(left_out.len(), 19, "{left_out:?}");
    assert_eq!(left_out[0], "extensions.VRMC_springBone.springs[21]");
}

pub fn swinging() -> ViewerState {
    let mut state = ViewerState::default();
    state.display.springs = true;
    state
}

#[test]
fn playing_and_seeking_give_the_same_springs_bit_for_bit() {
    let library = library(chain(0.5, json!([])));
    let poses = |frame: &Frame| -> Vec<[u32; 4]> {
        ["a", "b"].map(|name| rotation(&library, frame, name).to_array().map(f32::to_bits)).to_vec()
    };
    let (mut state, mut playing) = (swinging(), Frame::default());
    let mut played = Vec::new();
    for _ in 0..150 {
        apply(&mut state, &library, Command::Advance(1.0 / 47.0));
        evaluate(&library, &state, 1.5, &mut playing);
        played.push((state.clone(), poses(&playing)));
    }
    let mut moved = std::collections::BTreeSet::new();
    for (state, expected) in &played {
        assert_eq!(poses(&frame(&library, state)), *expected, "at {}", state.character.playhead.time_secs);
        moved.insert(expected.clone());
    }
    assert!(moved.len() > 100, "the springs move");
    // The same frame, backwards and in jumps.
    let mut order: Vec<usize> = (0..played.len()).rev().collect();
    order.extend((0..played.len()).map(|index| index * 61 % 150));
    for index in order {
        let (state, expected) = &played[index];
        evaluate(&library, state, 1.5, &mut playing);
        assert_eq!(poses(&playing), *expected, "at {}", state.character.playhead.time_secs);
    }
}

/// Rotations of `a` and `b` by @pixiv/three-vrm-springbone 3.5.5 with three 0.180: the chain with gravity 3 and the
/// capsule, after 60 updates of 1/60 s at rest, and after 20 more in which the root moves as in the clip.
#[test]
fn springs_match_three_vrm() {
    let expected = [
        (0.0, [[0.0, 0.0, -0.609236, 0.792989], [0.0, 0.0, 0.138728, 0.99033]]),
        (20.0 / 60.0, [[0.0, 0.120323, -0.599207, 0.7915], [0.0, -0.022192, 0.142365, 0.989565]]),
    ];
    let capsule = json!({ "capsule": { "offset": [0, 0, -0.5], "tail": [0, 0, 0.5], "radius": 0.12 } });
    let library = library(chain(3.0, json!([{ "node": 4, "shape": capsule }])));
    for (time_secs, rotations) in expected {
        let mut state = swinging();
        apply(&mut state, &library, Command::SetLoopMode(LoopMode::Once));
        apply(&mut state, &library, Command::Seek(time_secs));
        let frame = frame(&library, &state);
        for (name, expected) in ["a", "b"].into_iter().zip(rotations) {
            let found = rotation(&library, &frame, name);
            assert!((found - Quat::from_array(expected)).length() < 1e-4, "{name} at {time_secs}: {found}");
        }
    }
}

/// Long ranges are simulated in sections.
#[test]
fn sections_of_long_clips_join_without_a_seam() {
    let mut build = chain(0.5, json!([]));
    let times = build.accessor(F32, "SCALAR", 61, &floats(&(0..61).map(|secs| secs as f32).collect::<Vec<_>>()));
    let places: Vec<f32> = (0..61).flat_map(|secs| [0.0, 0.0, (secs % 2) as f32]).collect();
    let places = build.accessor(F32, "VEC3", 61, &floats(&places));
    build.json["animations"][0]["samplers"][0] = json!({ "input": times, "output": places });
    let library = library(build);
    let mut playing = Frame::default();
    let mut at = |time_secs: f64| {
        let mut state = swinging();
        apply(&mut state, &library, Command::Seek(time_secs));
        evaluate(&library, &state, 1.5, &mut playing);
        let [played, sought] = [&playing, &frame(&library, &state)].map(|frame| position(&library, frame, "c"));
        assert_eq!(played, sought, "{time_secs}");
        played - position(&library, &playing, "root")
    };
    // The motion repeats every two seconds.
    for start in [9.9, 39.8] {
        for step in 0..20 {
            let time_secs = start + f64::from(step) / 60.0;
            let (before, now) = (at(time_secs - 2.0), at(time_secs));
            assert!((now - before).length() < 1e-3, "{time_secs}: {now}, and {before} two seconds before");
        }
    }
}

#[test]
fn springs_loop_without_a_seam() {
    let library = library(chain(0.3, json!([])));
    let at = |time_secs: f64| {
        let mut state = swinging();
        apply(&mut state, &library, Command::Seek(time_secs));
        position(&library, &frame(&library, &state), "c")
    };
    let (end, start, next) = (at(1.0), at(1e-9), at(1.0 / 60.0));
    assert!((end - start).length() < 2e-3, "{end} and {start}");
    assert!((next - start).length() > 4e-3, "not just because nothing moves: {next}");
}

#[test]
fn springs_stay_at_rest_without_gravity_and_hang_down_with_it() {
    let settled = |gravity: f32| {
        let library = library(chain(gravity, json!([])));
        let mut state = swinging();
        apply(&mut state, &library, Command::SetClip(ClipChoice::RestPose));
        let frame = frame(&library, &state);
        ["a", "b"].map(|name| rotation(&library, &frame, name))
    };
    assert!(settled(0.0).iter().all(|&rotation| rotation == Quat::IDENTITY), "{:?}", settled(0.0));
    let [a, b] = settled(0.8);
    let down = (a * b) * Vec3::X;
    assert!(down.y < -0.4 && down.z.abs() < 1e-6, "{down}");
    // Off by default.
    let library = library(chain(0.8, json!([])));
    assert_eq!(rotation(&library, &frame(&library, &ViewerState::default()), "a"), Quat::IDENTITY);
}

#[test]
fn colliders_keep_springs_out() {
    let obstacle = Vec3::new(0.02, -0.38, 0.0);
    // Nearly without stiffness, so that the chain hangs straight down.
    let limp = |colliders: Value| {
        let mut build = chain(1.0, colliders);
        for joint in [0, 1] {
            build = build.with(&format!("/extensions/VRMC_springBone/springs/0/joints/{joint}/stiffness"), json!(0.05));
        }
        library(build)
    };
    let closest = |colliders: Value| {
        let library = limp(colliders);
        let mut state = swinging();
        let mut nearest = f32::INFINITY;
        for step in 0..60 {
            apply(&mut state, &library, Command::Seek(f64::from(step) / 60.0));
            let frame = frame(&library, &state);
            let obstacle = position(&library, &frame, "root") + obstacle;
            for name in ["b", "c"] {
                nearest = nearest.min((position(&library, &frame, name) - obstacle).length());
            }
        }
        nearest
    };
    let touching = 0.12 + 0.02;
    let sphere = json!([{ "node": 4, "shape": { "sphere": { "radius": 0.12 } } }]);
    let capsule = json!([{
        "node": 4, "shape": { "capsule": { "offset": [0, 0, -0.5], "tail": [0, 0, 0.5], "radius": 0.12 } },
    }]);
    assert!(closest(json!([])) < 0.5 * touching, "without a collider, the chain passes through");
    for collider in [sphere, capsule] {
        let nearest = closest(collider);
        // The root moves 3 cm per step; collision and bone length take a few steps to converge.
        assert!(nearest > 0.9 * touching, "{nearest} of {touching}");
    }
    let plane = json!({ "specVersion": "1.0", "shape": { "plane": { "offset": [0, 0.33, 0], "normal": [0, 1, 0] } } });
    let plane = json!([{
        "node": 4, "shape": { "sphere": { "radius": 0 } },
        "extensions": { "VRMC_springBone_extended_collider": plane },
    }]);
    let library = limp(plane);
    let height = position(&library, &frame(&library, &swinging()), "c").y;
    assert!((height - -0.03).abs() < 3e-3, "{height}");
}

#[test]
fn springs_of_vrm_0_include_all_descendants_of_their_bones() {
    let group = json!({
        "stiffiness": 0.5, "gravityPower": 1.0, "gravityDir": { "x": 0, "y": -1, "z": 0 }, "dragForce": 0.4,
        "center": -1, "hitRadius": 0.02, "bones": [7], "colliderGroups": [0],
    });
    let sphere = json!({ "offset": { "x": 0.1, "y": 0.2, "z": 0.3 }, "radius": 0.1 });
    let springs = json!({ "secondaryAnimation": {
        "boneGroups": [group],
        "colliderGroups": [{ "node": 2, "colliders": [sphere] }],
    } });
    let nodes = json!([
        { "name": "hair1", "translation": [0.0, 0.1, 0.2], "children": [8] },
        { "name": "hair2", "translation": [0.0, 0.0, 0.2] },
    ]);
    let mut build = person("VRM", nodes, springs);
    build.json["nodes"][2]["children"] = json!([5, 6, 7]);
    let library = library(build);
    let springs = &model(&library).asset.avatar.springs;
    assert_eq!(springs.joints().len(), 2);
    assert_eq!(springs.joints()[0].stiffness, 0.5);
    assert!((springs.joints()[1].tail - Vec3::new(0.0, 0.0, 0.07)).length() < 1e-6);
    assert_eq!(springs.colliders()[0].offset, Vec3::new(0.1, 0.2, -0.3));
    let lowered = position(&library, &frame(&library, &swinging()), "hair2").y
        - position(&library, &frame(&library, &ViewerState::default()), "hair2").y;
    assert!(lowered < -0.05, "{lowered}");
}
