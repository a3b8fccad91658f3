//! Look-at: eyes that turn to a point, to the camera or where a .vrma says, by bones or by expressions.

use std::sync::Arc;

use gaitway_scene::library::{LookTarget, Motion};
use gaitway_scene::state::{CameraChoice, Command, OrbitCamera, ViewerState, apply};
use glam::{Quat, Vec2, Vec3};
use serde_json::{Value, json};

use super::{frame, is_near, library, person, rotation};
use crate::build_gltf::{Build, F32, floats};

/// A person whose eyes are turned by `kind`: `bone` or `expression`. `members` are added to the extension.
pub fn eyes(kind: &str, members: Value) -> Build {
    let map = |input: f32, output: f32| json!({ "inputMaxValue": input, "outputScale": output });
    let mut value = members;
    value["lookAt"] = json!({
        "type": kind,
        "offsetFromHeadBone": [0.0, 0.1, 0.0],
        "rangeMapHorizontalInner": map(90.0, 10.0),
        "rangeMapHorizontalOuter": map(45.0, if kind == "bone" { 30.0 } else { 0.5 }),
        "rangeMapVerticalDown": map(90.0, if kind == "bone" { 20.0 } else { 1.0 }),
        "rangeMapVerticalUp": map(60.0, if kind == "bone" { 12.0 } else { 1.0 }),
    });
    person("VRMC_vrm", json!([]), value)
}

/// A point three metres from the middle of the eyes of [`eyes`]; positive yaw is to the left, positive pitch down, in
/// degrees.
fn seen_at(yaw: f32, pitch: f32) -> Vec3 {
    let turn = Quat::from_rotation_y(yaw.to_radians()) * Quat::from_rotation_x(pitch.to_radians());
    Vec3::new(0.0, 1.7, 0.0) + turn * Vec3::Z * 3.0
}

pub fn looking_at(point: Vec3) -> ViewerState {
    let mut state = ViewerState::default();
    state.display.look_at = LookTarget::Point(point);
    state
}

#[test]
fn range_maps_scale_and_limit_the_eyes_rotation() {
    let library = library(eyes("bone", json!({})));
    let check = |yaw: f32, pitch: f32, left_yaw: f32, right_yaw: f32, eye_pitch: f32| {
        let frame = frame(&library, &looking_at(seen_at(yaw, pitch)));
        for (eye, eye_yaw) in [("eye.L", left_yaw), ("eye.R", right_yaw)] {
            let turn = |yaw: f32, pitch: f32| {
                Quat::from_rotation_y(yaw.to_radians()) * Quat::from_rotation_x(pitch.to_radians())
            };
            let found = rotation(&library, &frame, eye);
            assert!(is_near(found, turn(eye_yaw, eye_pitch)), "{eye} at {yaw}, {pitch}: {found}");
        }
    };
    check(0.0, 0.0, 0.0, 0.0, 0.0);
    // Looking left turns the left eye outwards.
    check(30.0, 0.0, 20.0, 30.0 / 9.0, 0.0);
    check(-30.0, 0.0, -30.0 / 9.0, -20.0, 0.0);
    check(80.0, 0.0, 30.0, 80.0 / 9.0, 0.0);
    check(0.0, 45.0, 0.0, 0.0, 10.0);
    check(0.0, -30.0, 0.0, 0.0, -6.0);
}

#[test]
fn eye_rotations_are_relative_to_the_head() {
    let library = library(eyes("bone", json!({})));
    let mut state = looking_at(seen_at(30.0, 0.0));
    // The head (node 2) turns towards the target about an axis through the middle of the eyes.
    state.character.edits.pose.insert(2, [0.0, 30.0, 0.0]);
    assert!(is_near(rotation(&library, &frame(&library, &state), "eye.L"), Quat::IDENTITY));
}

#[test]
fn eyes_follow_the_camera() {
    let library = library(eyes("bone", json!({})));
    let mut state = ViewerState::default();
    let point = seen_at(20.0, 10.0);
    let target = Vec3::new(0.0, 1.7, 0.0);
    let orbit = OrbitCamera {
        yaw_radians: 20.0_f32.to_radians(),
        pitch_radians: -(10.0_f32.to_radians()),
        distance: 3.0,
        target,
    };
    state.camera = CameraChoice::Orbit(orbit);
    assert!(is_near(rotation(&library, &frame(&library, &state), "eye.L"), Quat::IDENTITY), "off by default");
    state.display.look_at = LookTarget::Camera;
    let at_camera = frame(&library, &state);
    assert!((at_camera.view.eye - point).length() < 1e-4, "{} and {point}", at_camera.view.eye);
    let at_point = frame(&library, &looking_at(point));
    assert!(is_near(rotation(&library, &at_camera, "eye.L"), rotation(&library, &at_point, "eye.L")));
    assert!(!is_near(rotation(&library, &at_point, "eye.L"), Quat::IDENTITY));
}

#[test]
fn vrm_0_faces_minus_z() {
    let map = json!({ "xRange": 90, "yRange": 10 });
    let first_person = json!({ "firstPerson": {
        "firstPersonBoneOffset": { "x": 0.0, "y": 0.1, "z": 0.0 },
        "lookAtTypeName": "Bone",
        "lookAtHorizontalInner": map, "lookAtHorizontalOuter": map, "lookAtVerticalDown": map, "lookAtVerticalUp": map,
    } });
    let library = library(person("VRM", json!([]), first_person));
    // In front of the model, to its left and below its eyes.
    let middle = Vec3::new(0.0, 1.7, 0.0);
    let point = middle + Quat::from_rotation_y(0.5) * Vec3::new(0.0, -0.5, -3.0);
    let frame = frame(&library, &looking_at(point));
    let gaze = rotation(&library, &frame, "eye.L") * Vec3::NEG_Z;
    assert!(gaze.x < -0.03 && gaze.y < -0.01 && gaze.z < -0.9, "{gaze}");
}

#[test]
fn eyes_can_be_turned_by_expressions() {
    let preset = json!({ "lookLeft": {}, "lookRight": {}, "lookUp": {}, "lookDown": {}, "happy": {} });
    let expressions = json!({ "expressions": { "preset": preset } });
    let asset = eyes("expression", expressions).loaded();
    let look_at = asset.avatar.look_at.expect("eyes");
    let mut weights = [0.0; 5];
    let mut pose = asset.skeleton.rest().clone();
    let direction = look_at.direction(seen_at(22.5, 45.0), &asset.skeleton, &pose).expect("a direction");
    assert!((Vec2::from(direction) - Vec2::new(22.5, 45.0)).length() < 1e-3, "{direction:?}");
    look_at.apply(direction, &asset.skeleton, &mut pose, &mut weights);
    let expected = [0.25, 0.0, 0.0, 0.5, 0.0];
    assert!(weights.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-4), "{weights:?}");
}

#[test]
fn a_vrma_turns_the_eyes_unless_a_target_is_chosen() {
    let mut motion = person("VRMC_vrm_animation", json!([{ "name": "gaze" }]), json!({ "lookAt": { "node": 7 } }));
    let times = motion.accessor(F32, "SCALAR", 2, &floats(&[0.0, 1.0]));
    let left = Quat::from_rotation_y(45.0_f32.to_radians()).to_array();
    let turns = motion.accessor(F32, "VEC4", 2, &floats(&[&[0.0, 0.0, 0.0, 1.0], &left[..]].concat()));
    let channel = |node: usize| json!({ "sampler": 0, "target": { "node": node, "path": "rotation" } });
    motion.json["animations"] = json!([{
        "channels": [channel(7), channel(1)], "samplers": [{ "input": times, "output": turns }],
    }]);
    let mut library = library(eyes("bone", json!({})));
    library.set_motions(vec![Motion::new("gaze.vrma".to_owned(), Arc::new(motion.loaded()))]);
    library.borrow_each(vec![None]);
    let mut state = ViewerState::default();
    apply(&mut state, &library, Command::Seek(0.5));
    let eye = |state: &ViewerState| rotation(&library, &frame(&library, state), "eye.L");
    // The gaze is halfway to 45°, and the outer range map turns 45° into 30°.
    assert!(is_near(eye(&state), Quat::from_rotation_y(15.0_f32.to_radians())), "{}", eye(&state));
    state.display.look_at = LookTarget::Camera;
    assert!(!is_near(eye(&state), Quat::from_rotation_y(15.0_f32.to_radians())));
}
