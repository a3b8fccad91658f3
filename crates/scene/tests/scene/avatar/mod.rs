//! VRM avatars from file to frame: expressions, node constraints, look-at and spring bones.

mod constraints;
mod expressions;
mod files;
mod look_at;
mod springs;

use std::collections::BTreeMap;

use gaitway_character::anim::JointIndex;
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::library::{Library, LookTarget, Model};
use gaitway_scene::state::ViewerState;
use glam::{Quat, Vec3};
use serde_json::{Value, json};

use self::expressions::face_vrm_1;
use self::look_at::eyes;
use self::springs::{chain, swinging};
use crate::allocation::allocations_while_playing;
use crate::build_gltf::Build;
use crate::data::library_of;

pub fn library(build: Build) -> Library {
    library_of(Model::new("avatar.vrm".to_owned(), build.loaded(), Vec::new()))
}

pub fn model(library: &Library) -> &Model {
    library.active().expect("a model")
}

pub fn frame(library: &Library, state: &ViewerState) -> Frame {
    let mut frame = Frame::default();
    evaluate(library, state, 1.5, &mut frame);
    frame
}

pub fn joint(library: &Library, name: &str) -> JointIndex {
    model(library).asset.skeleton.find(name).unwrap_or_else(|| panic!("no joint {name}"))
}

/// The position of a joint in world space.
pub fn position(library: &Library, frame: &Frame, name: &str) -> Vec3 {
    frame.characters[0].world_from_joint[joint(library, name).get()].translation.into()
}

/// The local rotation of a joint.
pub fn rotation(library: &Library, frame: &Frame, name: &str) -> Quat {
    frame.pose().local(joint(library, name)).rotation
}

pub fn is_near(a: Quat, b: Quat) -> bool {
    a.dot(b).abs() > 1.0 - 1e-6
}

/// A minimal humanoid with eyes, as `extension` describes it: a VRM or a .vrma. `more_nodes` follow the first seven,
/// and `members` are added to the extension.
pub fn person(extension: &str, more_nodes: Value, members: Value) -> Build {
    let mut build = Build::new();
    let mut nodes = json!([
        { "name": "hips", "translation": [0.0, 1.0, 0.0], "children": [1, 3, 4] },
        { "name": "spine", "translation": [0.0, 0.3, 0.0], "children": [2] },
        { "name": "head", "translation": [0.0, 0.3, 0.0], "children": [5, 6] },
        { "name": "leg.L", "translation": [0.1, 0.0, 0.0] },
        { "name": "leg.R", "translation": [-0.1, 0.0, 0.0] },
        { "name": "eye.L", "translation": [0.03, 0.1, 0.05] },
        { "name": "eye.R", "translation": [-0.03, 0.1, 0.05] },
    ]);
    if let (Some(nodes), Value::Array(more)) = (nodes.as_array_mut(), more_nodes) {
        nodes.extend(more);
    }
    build.json["nodes"] = nodes;
    let bones = ["hips", "spine", "head", "leftUpperLeg", "rightUpperLeg", "leftEye", "rightEye"];
    let mut value = members;
    value["specVersion"] = json!("1.0");
    value["humanoid"]["humanBones"] = match extension {
        "VRM" => bones.iter().enumerate().map(|(node, bone)| json!({ "bone": bone, "node": node })).collect(),
        _ => Value::Object(
            bones.iter().enumerate().map(|(node, bone)| ((*bone).to_owned(), json!({ "node": node }))).collect(),
        ),
    };
    build.json["extensionsUsed"] = json!([extension]);
    build.json["extensions"] = json!({ extension: value });
    build
}

#[test]
fn avatars_do_not_allocate_while_they_play() {
    let sphere = json!([{ "node": 4, "shape": { "sphere": { "radius": 0.1 } } }]);
    let springs = library(chain(0.5, sphere));
    let mut face = swinging();
    face.character.edits.expressions = BTreeMap::from([("happy".to_owned(), 0.5)]);
    let mut eyes_state = swinging();
    eyes_state.display.look_at = LookTarget::Camera;
    eyes_state.camera_options.follow = true;
    let eyes = library(eyes("bone", json!({})));
    for (library, state) in [(springs, swinging()), (library(face_vrm_1()), face), (eyes, eyes_state)] {
        assert_eq!(allocations_while_playing(&library, state, 130, 300), 0);
    }
}
