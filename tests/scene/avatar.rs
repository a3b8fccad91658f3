//! Expressions, node constraints, eyes and spring bones, from files to frames.

use std::collections::BTreeMap;
use std::sync::Arc;

use gaitway::anim::{JointIndex, LoopMode, PropertyTarget};
use gaitway::asset::Asset;
use gaitway::avatar::{Expression, Override, resolve_weights};
use gaitway::frame::{Frame, evaluate};
use gaitway::library::{Library, Model, Motion, inspect};
use gaitway::state::{
    CameraChoice, ClipChoice, Command, History, LookTarget, OrbitCamera, SavedMotion, ViewerState, apply,
};
use glam::{Quat, Vec2, Vec3, Vec4};
use serde_json::{Value, json};

use crate::allocations::allocations_after;
use crate::build_gltf::{Build, F32, floats};
use crate::data::{library_of, open};
use crate::data_folder::data_folder;

fn loaded(build: Build) -> Asset {
    build.load().unwrap_or_else(|problem| panic!("{problem}"))
}

fn library(build: Build) -> Library {
    library_of(Model::new("avatar.vrm".to_owned(), loaded(build), Vec::new()))
}

fn model(library: &Library) -> &Model {
    library.active().expect("a model")
}

fn frame(library: &Library, state: &ViewerState) -> Frame {
    let mut frame = Frame::default();
    evaluate(library, state, 1.5, &mut frame);
    frame
}

fn joint(library: &Library, name: &str) -> JointIndex {
    model(library).asset.skeleton.find(name).unwrap_or_else(|| panic!("no joint {name}"))
}

fn place(library: &Library, frame: &Frame, name: &str) -> Vec3 {
    frame.characters[0].world_from_joint[joint(library, name).get()].translation.into()
}

fn rotation(library: &Library, frame: &Frame, name: &str) -> Quat {
    frame.pose().local(joint(library, name)).rotation
}

fn is_near(a: Quat, b: Quat) -> bool {
    a.dot(b).abs() > 1.0 - 1e-6
}

/// A triangle with two morph targets, an animation of their weights to 0.25 and 0, and a material with a texture.
fn face(extension: &str, value: Value) -> Build {
    let mut build = Build::triangle();
    let offsets = build.accessor(F32, "VEC3", 3, &floats(&[0.1; 9]));
    let times = build.accessor(F32, "SCALAR", 2, &floats(&[0.0, 1.0]));
    let weights = build.accessor(F32, "SCALAR", 4, &floats(&[0.25, 0.0, 0.25, 0.0]));
    build.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": offsets }, { "POSITION": offsets }]);
    build.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    build.json["materials"] = json!([{
        "name": "skin",
        "pbrMetallicRoughness": { "baseColorFactor": [0.2, 0.4, 0.6, 1.0], "baseColorTexture": { "index": 0 } },
        "emissiveFactor": [0.1, 0.1, 0.1],
    }]);
    build.json["textures"] = json!([{}]);
    build.json["animations"] = json!([{
        "name": "face",
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "weights" } }],
        "samplers": [{ "input": times, "output": weights }],
    }]);
    build.json["extensionsUsed"] = json!([extension]);
    build.json["extensions"] = json!({ extension: value });
    build
}

fn face_1() -> Build {
    let happy = json!({
        "morphTargetBinds": [{ "node": 0, "index": 1, "weight": 0.8 }, { "node": 0, "index": 0, "weight": 0.5 }],
        "materialColorBinds": [
            { "material": 0, "type": "color", "targetValue": [1.0, 0.0, 0.0, 0.5] },
            { "material": 0, "type": "emissionColor", "targetValue": [0.5, 0.1, 0.1, 1.0] },
            { "material": 0, "type": "rimColor", "targetValue": [1.0, 1.0, 1.0, 1.0] },
        ],
        "textureTransformBinds": [{ "material": 0, "scale": [0.5, 1.0], "offset": [0.25, 0.5] }],
    });
    let wink = json!({ "morphTargetBinds": [{ "node": 0, "index": 0 }] });
    face("VRMC_vrm", json!({ "expressions": { "preset": { "happy": happy }, "custom": { "wink": wink } } }))
}

fn face_0() -> Build {
    let joy = json!({
        "name": "Joy",
        "presetName": "joy",
        "binds": [{ "mesh": 0, "index": 1, "weight": 80 }, { "mesh": 0, "index": 0, "weight": 50 }],
        "materialValues": [
            { "materialName": "skin", "propertyName": "_Color", "targetValue": [1.0, 0.0, 0.0, 0.5] },
            { "materialName": "skin", "propertyName": "_EmissionColor", "targetValue": [0.5, 0.1, 0.1, 1.0] },
            { "materialName": "skin", "propertyName": "_RimColor", "targetValue": [1.0, 1.0, 1.0, 1.0] },
            { "materialName": "skin", "propertyName": "_MainTex_ST", "targetValue": [0.5, 1.0, 0.25, -0.5] },
        ],
    });
    let wink = json!({ "name": "wink", "presetName": "unknown", "binds": [{ "mesh": 0, "index": 0, "weight": 100 }] });
    face("VRM", json!({ "blendShapeMaster": { "blendShapeGroups": [joy, wink] } }))
}

fn check_weights(expressions: &[(&str, bool, [Override; 3], f32)], expected: &[f32]) {
    let made = |&(name, is_binary, overrides, _): &(&str, bool, [Override; 3], f32)| Expression {
        is_binary,
        overrides,
        ..Expression::new(name, name, Expression::PRESETS.contains(&name))
    };
    let mut weights: Vec<f32> = expressions.iter().map(|expression| expression.3).collect();
    let expressions: Vec<Expression> = expressions.iter().map(made).collect();
    resolve_weights(&expressions, &mut weights);
    assert!(weights.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{weights:?}, expected {expected:?}");
}

#[test]
fn expressions_override_groups() {
    const NOTHING: [Override; 3] = [Override::None; 3];
    const BLOCK_BLINK: [Override; 3] = [Override::Block, Override::None, Override::None];
    const BLEND_ALL: [Override; 3] = [Override::Blend; 3];
    check_weights(&[("happy", false, BLOCK_BLINK, 0.1), ("blink", false, NOTHING, 0.9)], &[0.1, 0.0]);
    check_weights(&[("happy", false, BLOCK_BLINK, 0.0), ("blink", false, NOTHING, 0.9)], &[0.0, 0.9]);
    // Only what the group contains.
    check_weights(&[("happy", false, BLOCK_BLINK, 1.0), ("aa", false, NOTHING, 0.9)], &[1.0, 0.9]);
    check_weights(&[("happy", false, BLOCK_BLINK, 1.0), ("Blink", false, NOTHING, 0.9)], &[1.0, 0.9]);
    check_weights(&[("aa", false, NOTHING, 0.8), ("sad", false, BLEND_ALL, 0.25)], &[0.6, 0.25]);
    check_weights(&[("lookUp", false, NOTHING, 1.0), ("sad", false, BLEND_ALL, 1.0)], &[0.0, 1.0]);
    // Several add up, to nothing less than nothing.
    let two = |a, b| [("oh", false, NOTHING, 1.0), ("sad", false, BLEND_ALL, a), ("angry", false, BLEND_ALL, b)];
    check_weights(&two(0.25, 0.5), &[0.25, 0.25, 0.5]);
    check_weights(&two(0.75, 0.5), &[0.0, 0.75, 0.5]);
    // Binary expressions: rounded, before they override and when they are overridden in part.
    check_weights(&[("happy", true, BLEND_ALL, 0.6), ("blink", false, NOTHING, 1.0)], &[1.0, 0.0]);
    check_weights(&[("happy", true, BLEND_ALL, 0.5), ("blink", false, NOTHING, 1.0)], &[0.0, 1.0]);
    check_weights(&[("happy", false, BLEND_ALL, 0.1), ("blink", true, NOTHING, 1.0)], &[0.1, 0.0]);
    check_weights(&[("happy", false, NOTHING, 7.0), ("sad", false, NOTHING, -1.0)], &[1.0, 0.0]);
}

#[test]
fn expressions_move_morphs_colours_and_textures_on_top_of_the_clip() {
    for build in [face_1(), face_0()] {
        let library = library(build);
        assert!(model(&library).asset.warnings.is_empty(), "{:?}", model(&library).asset.warnings);
        let mut state = ViewerState::default();
        assert_eq!(frame(&library, &state).pose().morph_weights, [0.25, 0.0]);
        apply(&mut state, &library, Command::SetExpression { name: "happy".to_owned(), weight: Some(0.5) });
        let half = frame(&library, &state);
        assert!((Vec2::from_slice(&half.pose().morph_weights) - Vec2::new(0.5, 0.4)).length() < 1e-6);
        let [(0, material)] = &half.characters[0].materials[..] else { panic!("one animated material") };
        assert!((material.base_color - Vec4::new(0.6, 0.2, 0.3, 0.75)).length() < 1e-6);
        assert!((material.emissive - Vec3::new(0.3, 0.1, 0.1)).length() < 1e-6);
        let uvs = material.base_color_texture.expect("a texture").uv_transform;
        assert_eq!((uvs.offset, uvs.scale), (Vec2::new(0.125, 0.25), Vec2::new(0.75, 1.0)));
        // A second expression adds; a weight set manually wins.
        apply(&mut state, &library, Command::SetExpression { name: "wink".to_owned(), weight: Some(0.5) });
        assert_eq!(frame(&library, &state).pose().morph_weights[0], 1.0);
        apply(&mut state, &library, Command::SetMorph { index: 0, weight: Some(0.125) });
        assert_eq!(frame(&library, &state).pose().morph_weights[0], 0.125);
        apply(&mut state, &library, Command::ClearExpressions);
        assert_eq!(frame(&library, &state).pose().morph_weights, [0.125, 0.0]);
        assert!(frame(&library, &state).characters[0].materials.is_empty());
    }
}

#[test]
fn both_versions_of_vrm_give_the_same_expressions() {
    let [new, old] = [face_1(), face_0()].map(loaded);
    let titles = |asset: &Asset| -> Vec<String> {
        asset.avatar.expressions.iter().map(|expression| expression.title.clone()).collect()
    };
    assert_eq!(titles(&new), ["happy", "wink"]);
    assert_eq!(titles(&old), ["Joy", "wink"]);
    for (new, old) in new.avatar.expressions.iter().zip(&old.avatar.expressions) {
        assert_eq!(*new, Expression { title: new.title.clone(), ..old.clone() });
    }
}

#[test]
fn expressions_that_do_not_exist_are_ignored_and_edits_can_be_undone() {
    let mut library = library(face_1());
    let (mut state, mut history) = (ViewerState::default(), History::default());
    let set = |name: &str, weight: f32| Command::SetExpression { name: name.to_owned(), weight: Some(weight) };
    history.apply(&mut state, &library, set("grin", 1.0));
    history.apply(&mut state, &library, set("happy", f32::NAN));
    assert_eq!(state, ViewerState::default());
    history.apply(&mut state, &library, set("happy", 3.0));
    assert_eq!(state.edits.expressions, BTreeMap::from([("happy".to_owned(), 1.0)]));
    assert!(history.undo(&mut state, &mut SavedMotion::default(), &mut library));
    assert_eq!(state, ViewerState::default());
    // From a link, before the model is there.
    state.edits.expressions.insert("grin".to_owned(), 1.0);
    assert_eq!(frame(&library, &state).pose().morph_weights, [0.25, 0.0]);
}

/// A skeleton with the bones that the humanoid map needs most, with or without expressions.
fn person(extension: &str, nodes: Value, more: Value) -> Build {
    let mut build = Build::new();
    let mut all = json!([
        { "name": "hips", "translation": [0.0, 1.0, 0.0], "children": [1, 3, 4] },
        { "name": "spine", "translation": [0.0, 0.3, 0.0], "children": [2] },
        { "name": "head", "translation": [0.0, 0.3, 0.0], "children": [5, 6] },
        { "name": "leg.L", "translation": [0.1, 0.0, 0.0] },
        { "name": "leg.R", "translation": [-0.1, 0.0, 0.0] },
        { "name": "eye.L", "translation": [0.03, 0.1, 0.05] },
        { "name": "eye.R", "translation": [-0.03, 0.1, 0.05] },
    ]);
    if let (Some(all), Value::Array(nodes)) = (all.as_array_mut(), nodes) {
        all.extend(nodes);
    }
    build.json["nodes"] = all;
    let bones = ["hips", "spine", "head", "leftUpperLeg", "rightUpperLeg", "leftEye", "rightEye"];
    let mut value = more;
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
fn a_vrma_animates_the_expressions_of_the_model_by_name() {
    let vrma = json!({ "expressions": { "preset": { "happy": { "node": 7 } }, "custom": { "grin": { "node": 8 } } } });
    let mut motion = person("VRMC_vrm_animation", json!([{ "name": "happy" }, { "name": "grin" }]), vrma);
    let times = motion.accessor(F32, "SCALAR", 2, &floats(&[0.0, 1.0]));
    let weights = motion.accessor(F32, "VEC3", 2, &floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]));
    let turns = motion.accessor(F32, "VEC4", 2, &floats(&[0.0, 0.0, 0.0, 1.0, 0.6, 0.0, 0.0, 0.8]));
    let channel = |sampler: usize, node: usize, path: &str| {
        let target = json!({ "node": node, "path": path });
        json!({ "sampler": sampler, "target": target })
    };
    motion.json["animations"] = json!([{
        "name": "smile",
        "channels": [channel(0, 7, "translation"), channel(0, 8, "translation"), channel(1, 1, "rotation")],
        "samplers": [{ "input": times, "output": weights }, { "input": times, "output": turns }],
    }]);
    let motion = loaded(motion);
    let targets: Vec<PropertyTarget> = motion.clips[0].properties().iter().map(|channel| channel.target).collect();
    assert_eq!(targets, [PropertyTarget::Expression(0), PropertyTarget::Expression(1)]);

    let expressions = json!({ "expressions": { "preset": { "sad": {}, "happy": {} } } });
    let mut library = library(person("VRMC_vrm", json!([]), expressions));
    library.set_motions(vec![Motion::new("smile.vrma".to_owned(), Arc::new(motion))]);
    library.borrow_each(vec![None]);
    let clip = model(&library).clip(0).expect("a borrowed clip");
    assert_eq!(clip.properties().len(), 1, "the model has no expression “grin”");
    let mut state = ViewerState::default();
    apply(&mut state, &library, Command::Seek(0.25));
    let quarter = frame(&library, &state);
    assert_eq!(quarter.expressions(), [0.0, 0.25]);
    assert!(rotation(&library, &quarter, "spine").x > 0.05);
    apply(&mut state, &library, Command::SetExpression { name: "happy".to_owned(), weight: Some(0.75) });
    assert_eq!(frame(&library, &state).expressions(), [0.0, 0.75]);
    let document = inspect(model(&library), &[]);
    assert_eq!(document["borrowed_clips"][0]["properties"], json!(["/extensions/VRMC_vrm/expressions/preset/happy"]));
}

#[test]
fn a_vrma_turns_the_eyes_unless_they_look_elsewhere() {
    let mut motion = person("VRMC_vrm_animation", json!([{ "name": "gaze" }]), json!({ "lookAt": { "node": 7 } }));
    let times = motion.accessor(F32, "SCALAR", 2, &floats(&[0.0, 1.0]));
    let left = Quat::from_rotation_y(45.0_f32.to_radians()).to_array();
    let turns = motion.accessor(F32, "VEC4", 2, &floats(&[&[0.0, 0.0, 0.0, 1.0], &left[..]].concat()));
    let channel = |node: usize| json!({ "sampler": 0, "target": { "node": node, "path": "rotation" } });
    motion.json["animations"] = json!([{
        "channels": [channel(7), channel(1)], "samplers": [{ "input": times, "output": turns }],
    }]);
    let mut library = library(eyes("bone", json!({})));
    library.set_motions(vec![Motion::new("gaze.vrma".to_owned(), Arc::new(loaded(motion)))]);
    library.borrow_each(vec![None]);
    let mut state = ViewerState::default();
    apply(&mut state, &library, Command::Seek(0.5));
    let eye = |state: &ViewerState| rotation(&library, &frame(&library, state), "eye.L");
    // 22.5° of 45°, of at most 30° outwards.
    assert!(is_near(eye(&state), Quat::from_rotation_y(15.0_f32.to_radians())), "{}", eye(&state));
    state.display.look_at = LookTarget::Camera;
    assert!(!is_near(eye(&state), Quat::from_rotation_y(15.0_f32.to_radians())));
}

#[test]
fn unusable_statements_are_left_out_with_a_warning() {
    let bad = json!({ "expressions": {
        "preset": {
            "happy": { "morphTargetBinds": [
                { "node": 9, "index": 0 }, { "node": 0, "index": 7 }, { "node": "x" }, 3,
            ], "materialColorBinds": [{ "material": 5, "type": "color" }, null] },
            "grin": {},
        },
        "custom": { "blink": {} },
    } });
    let asset = loaded(face("VRMC_vrm", bad));
    assert_eq!(asset.avatar.expressions.len(), 1);
    assert!(!asset.avatar.expressions[0].has_effect());
    let warnings: Vec<(&str, &str)> = asset.warnings.iter().map(|warning| (warning.code(), warning.place())).collect();
    let binds = "extensions.VRMC_vrm.expressions.preset.happy.morphTargetBinds";
    let expected = [
        format!("{binds}[0].node"),
        format!("{binds}[1]"),
        format!("{binds}[2].node"),
        format!("{binds}[3].node"),
        "extensions.VRMC_vrm.expressions.preset.grin".to_owned(),
        "extensions.VRMC_vrm.expressions.custom.blink".to_owned(),
    ];
    let expected: Vec<(&str, &str)> = expected.iter().map(|place| ("vrm-ignored", &**place)).collect();
    assert_eq!(warnings, expected);
}

/// Nodes `source` and `follower` with rotated rests below rotated parents; the source also turns by hand.
fn constrained(constraint: Value) -> Build {
    let mut build = Build::new();
    let extension = json!({ "VRMC_node_constraint": { "specVersion": "1.0", "constraint": constraint } });
    build.json["nodes"] = json!([
        { "name": "left", "rotation": [0.0, 0.6, 0.0, 0.8], "translation": [1.0, 0.0, 0.0], "children": [2] },
        { "name": "right", "rotation": [0.6, 0.0, 0.0, 0.8], "translation": [-1.0, 0.5, 0.0], "children": [3] },
        { "name": "source", "rotation": [0.0, 0.0, 0.6, 0.8], "translation": [0.2, 0.3, 0.4] },
        { "name": "follower", "rotation": [0.28, 0.0, 0.0, 0.96], "extensions": extension },
    ]);
    build.json["extensionsUsed"] = json!(["VRMC_node_constraint"]);
    build
}

const SOURCE: usize = 2;

fn turned_source() -> ViewerState {
    let mut state = ViewerState::default();
    state.edits.pose.insert(SOURCE, [40.0, -25.0, 60.0]);
    state
}

/// The rotation of the source from its rest, in its own space.
fn turn(library: &Library, state: &ViewerState) -> Quat {
    let rest = model(library).asset.skeleton.rest().local(joint(library, "source")).rotation;
    rest.inverse() * rotation(library, &frame(library, state), "source")
}

#[test]
fn a_rotation_constraint_follows_the_turn_of_its_source() {
    let rest = Quat::from_xyzw(0.28, 0.0, 0.0, 0.96);
    for weight in [0.0, 0.3, 1.0] {
        let library = library(constrained(json!({ "rotation": { "source": SOURCE, "weight": weight } })));
        let state = turned_source();
        let (axis, angle) = turn(&library, &state).to_axis_angle();
        let expected = rest * Quat::from_axis_angle(axis, angle * weight);
        let found = rotation(&library, &frame(&library, &state), "follower");
        assert!(is_near(found, expected), "{weight}: {found}, expected {expected}");
        assert!(is_near(rotation(&library, &frame(&library, &ViewerState::default()), "follower"), rest));
    }
}

/// Compares with the twist of a swing-twist decomposition.
#[test]
fn a_roll_constraint_takes_the_twist_about_its_axis() {
    let (rest, source_rest) = (Quat::from_xyzw(0.28, 0.0, 0.0, 0.96), Quat::from_xyzw(0.0, 0.0, 0.6, 0.8));
    for (name, axis) in [("X", Vec3::X), ("Y", Vec3::Y), ("Z", Vec3::Z)] {
        let library = library(constrained(json!({ "roll": { "source": SOURCE, "rollAxis": name } })));
        let state = turned_source();
        // In the space of the follower, the source's parent taken for its own.
        let in_parent = source_rest * turn(&library, &state) * source_rest.inverse();
        let delta = rest.inverse() * in_parent * rest;
        let along = axis * Vec3::new(delta.x, delta.y, delta.z).dot(axis);
        let twist = Quat::from_xyzw(along.x, along.y, along.z, delta.w).normalize();
        let found = rotation(&library, &frame(&library, &state), "follower");
        assert!(is_near(found, rest * twist), "{name}: {found}, expected {}", rest * twist);
    }
}

#[test]
fn an_aim_constraint_points_at_its_source() {
    let axes = [("PositiveX", Vec3::X), ("NegativeY", Vec3::NEG_Y), ("PositiveZ", Vec3::Z)];
    for (name, axis) in axes {
        let angle_at = |weight: f32| {
            let library =
                library(constrained(json!({ "aim": { "source": SOURCE, "aimAxis": name, "weight": weight } })));
            let frame = frame(&library, &turned_source());
            let world = frame.characters[0].world_from_joint[joint(&library, "follower").get()];
            let to_source = place(&library, &frame, "source") - place(&library, &frame, "follower");
            world.transform_vector3(axis).angle_between(to_source)
        };
        assert!(angle_at(1.0) < 1e-3, "{name}: {}", angle_at(1.0));
        assert!((angle_at(0.5) - 0.5 * angle_at(0.0)).abs() < 1e-3, "{name}: {}, {}", angle_at(0.5), angle_at(0.0));
    }
}

fn rotation_of(source: usize) -> Value {
    json!({ "VRMC_node_constraint": { "specVersion": "1.0", "constraint": { "rotation": { "source": source } } } })
}

#[test]
fn constraints_apply_in_the_order_of_their_dependencies() {
    let mut build = Build::new();
    // The third follows the second, which follows the first, whatever their order in the file.
    build.json["nodes"] = json!([
        { "name": "third", "extensions": rotation_of(2) },
        { "name": "first" },
        { "name": "second", "extensions": rotation_of(1) },
    ]);
    let library = library(build);
    let mut state = ViewerState::default();
    state.edits.pose.insert(1, [30.0, 0.0, 0.0]);
    let turned = Quat::from_rotation_x(30.0_f32.to_radians());
    assert!(is_near(rotation(&library, &frame(&library, &state), "third"), turned));
}

#[test]
fn constraints_in_a_cycle_are_left_out() {
    let mut build = Build::new();
    build.json["nodes"] = json!([
        { "name": "a", "extensions": rotation_of(1) },
        { "name": "b", "extensions": rotation_of(0) },
        { "name": "c", "extensions": rotation_of(9) },
        { "name": "d", "extensions": { "VRMC_node_constraint": { "constraint": { "roll": { "rollAxis": "W" } } } } },
        { "name": "e", "extensions": rotation_of(3) },
    ]);
    let asset = loaded(build);
    assert_eq!(asset.avatar.constraints.len(), 1);
    assert_eq!(asset.warnings.iter().filter(|warning| warning.code() == "vrm-ignored").count(), 4);
}

fn eyes(kind: &str, more: Value) -> Build {
    let map = |input: f32, output: f32| json!({ "inputMaxValue": input, "outputScale": output });
    let mut value = more;
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

/// A point in this direction from between the eyes of [`eyes`], yaw to the left and pitch down in degrees.
fn seen_at(yaw: f32, pitch: f32) -> Vec3 {
    let turn = Quat::from_rotation_y(yaw.to_radians()) * Quat::from_rotation_x(pitch.to_radians());
    Vec3::new(0.0, 1.7, 0.0) + turn * Vec3::Z * 3.0
}

fn looking_at(point: Vec3) -> ViewerState {
    let mut state = ViewerState::default();
    state.display.look_at = LookTarget::Point(point);
    state
}

#[test]
fn eyes_turn_as_far_as_their_range_maps_say() {
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
    // To the left: outwards for the left eye.
    check(30.0, 0.0, 20.0, 30.0 / 9.0, 0.0);
    check(-30.0, 0.0, -30.0 / 9.0, -20.0, 0.0);
    check(80.0, 0.0, 30.0, 80.0 / 9.0, 0.0);
    check(0.0, 45.0, 0.0, 0.0, 10.0);
    check(0.0, -30.0, 0.0, 0.0, -6.0);
}

#[test]
fn eyes_look_relative_to_the_head() {
    let library = library(eyes("bone", json!({})));
    let mut state = looking_at(seen_at(30.0, 0.0));
    // The head (node 2) turns to where the target is; the point between the eyes stays on its axis.
    state.edits.pose.insert(2, [0.0, 30.0, 0.0]);
    assert!(is_near(rotation(&library, &frame(&library, &state), "eye.L"), Quat::IDENTITY));
}

#[test]
fn eyes_that_look_at_the_camera_look_where_it_is() {
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
fn vrm_0_faces_the_other_way() {
    let map = json!({ "xRange": 90, "yRange": 10 });
    let first_person = json!({ "firstPerson": {
        "firstPersonBoneOffset": { "x": 0.0, "y": 0.1, "z": 0.0 },
        "lookAtTypeName": "Bone",
        "lookAtHorizontalInner": map, "lookAtHorizontalOuter": map, "lookAtVerticalDown": map, "lookAtVerticalUp": map,
    } });
    let library = library(person("VRM", json!([]), first_person));
    // In front of a model that faces −Z, to its left and below.
    let middle = Vec3::new(0.0, 1.7, 0.0);
    let point = middle + Quat::from_rotation_y(0.5) * Vec3::new(0.0, -0.5, -3.0);
    let frame = frame(&library, &looking_at(point));
    let gaze = rotation(&library, &frame, "eye.L") * Vec3::NEG_Z;
    assert!(gaze.x < -0.03 && gaze.y < -0.01 && gaze.z < -0.9, "{gaze}");
}

#[test]
fn eyes_can_be_expressions() {
    let preset = json!({ "lookLeft": {}, "lookRight": {}, "lookUp": {}, "lookDown": {}, "happy": {} });
    let bind = json!({ "expressions": { "preset": preset } });
    let asset = loaded(eyes("expression", bind));
    let look_at = asset.avatar.look_at.expect("eyes");
    let mut weights = [0.0; 5];
    let mut pose = asset.skeleton.rest().clone();
    let direction = look_at.direction(seen_at(22.5, 45.0), &asset.skeleton, &pose).expect("a direction");
    assert!((Vec2::from(direction) - Vec2::new(22.5, 45.0)).length() < 1e-3, "{direction:?}");
    look_at.apply(direction, &asset.skeleton, &mut pose, &mut weights);
    let expected = [0.25, 0.0, 0.0, 0.5, 0.0];
    assert!(weights.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-4), "{weights:?}");
}

/// A chain along +X on a root that moves along Z and back in a second.
fn chain(gravity: f32, colliders: Value) -> Build {
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
fn springs_share_a_limited_number_of_tests_against_colliders() {
    let mut build = chain(0.0, vec![json!({ "node": 4, "shape": { "sphere": { "radius": 0.1 } } }); 1000].into());
    let springs = &mut build.json["extensions"]["VRMC_springBone"]["springs"];
    *springs = vec![springs[0].clone(); 40].into();
    let asset = build.load().expect("springs never prevent loading");
    let left_out: Vec<&str> = asset.warnings.iter().map(|warning| warning.place()).collect();
    // Three joints of 1,000 colliders each: 21 springs take 63,000 of 65,536.
    assert_eq!(left_out.len(), 19, "{left_out:?}");
    assert_eq!(left_out[0], "extensions.VRMC_springBone.springs[21]");
}

fn swinging() -> ViewerState {
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
        assert_eq!(poses(&frame(&library, state)), *expected, "at {}", state.playhead.time_secs);
        moved.insert(expected.clone());
    }
    assert!(moved.len() > 100, "it moves");
    // The same frame, backwards and in jumps.
    let mut order: Vec<usize> = (0..played.len()).rev().collect();
    order.extend((0..played.len()).map(|index| index * 61 % 150));
    for index in order {
        let (state, expected) = &played[index];
        evaluate(&library, state, 1.5, &mut playing);
        assert_eq!(poses(&playing), *expected, "at {}", state.playhead.time_secs);
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
fn springs_go_on_without_a_seam_in_long_clips() {
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
        let [played, sought] = [&playing, &frame(&library, &state)].map(|frame| place(&library, frame, "c"));
        assert_eq!(played, sought, "{time_secs}");
        played - place(&library, &playing, "root")
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
fn a_loop_of_springs_has_no_seam() {
    let library = library(chain(0.3, json!([])));
    let at = |time_secs: f64| {
        let mut state = swinging();
        apply(&mut state, &library, Command::Seek(time_secs));
        place(&library, &frame(&library, &state), "c")
    };
    let (end, start, next) = (at(1.0), at(1e-9), at(1.0 / 60.0));
    assert!((end - start).length() < 2e-3, "{end} and {start}");
    assert!((next - start).length() > 4e-3, "not just because nothing moves: {next}");
}

#[test]
fn springs_hang_still_without_gravity_and_swing_down_with_it() {
    let still = |gravity: f32| {
        let library = library(chain(gravity, json!([])));
        let mut state = swinging();
        apply(&mut state, &library, Command::SetClip(ClipChoice::RestPose));
        let frame = frame(&library, &state);
        ["a", "b"].map(|name| rotation(&library, &frame, name))
    };
    assert!(still(0.0).iter().all(|&rotation| rotation == Quat::IDENTITY), "{:?}", still(0.0));
    let [a, b] = still(0.8);
    let down = (a * b) * Vec3::X;
    assert!(down.y < -0.4 && down.z.abs() < 1e-6, "{down}");
    // Off by default.
    let library = library(chain(0.8, json!([])));
    assert_eq!(rotation(&library, &frame(&library, &ViewerState::default()), "a"), Quat::IDENTITY);
}

#[test]
fn colliders_keep_springs_out() {
    let obstacle = Vec3::new(0.02, -0.38, 0.0);
    // Limp, so that it hangs straight down.
    let limp = |colliders: Value| {
        let mut build = chain(1.0, colliders);
        for joint in [0, 1] {
            build = build.with(&format!("/extensions/VRMC_springBone/springs/0/joints/{joint}/stiffness"), json!(0.05));
        }
        library(build)
    };
    let deepest = |colliders: Value| {
        let library = limp(colliders);
        let mut state = swinging();
        let mut nearest = f32::INFINITY;
        for step in 0..60 {
            apply(&mut state, &library, Command::Seek(f64::from(step) / 60.0));
            let frame = frame(&library, &state);
            let obstacle = place(&library, &frame, "root") + obstacle;
            for name in ["b", "c"] {
                nearest = nearest.min((place(&library, &frame, name) - obstacle).length());
            }
        }
        nearest
    };
    let touching = 0.12 + 0.02;
    let sphere = json!([{ "node": 4, "shape": { "sphere": { "radius": 0.12 } } }]);
    let capsule = json!([{
        "node": 4, "shape": { "capsule": { "offset": [0, 0, -0.5], "tail": [0, 0, 0.5], "radius": 0.12 } },
    }]);
    assert!(deepest(json!([])) < 0.5 * touching, "they would pass through");
    for collider in [sphere, capsule] {
        let nearest = deepest(collider);
        // The root jerks by 3 cm a step; a push and the length of the bone agree only after some steps.
        assert!(nearest > 0.9 * touching, "{nearest} of {touching}");
    }
    let plane = json!({ "specVersion": "1.0", "shape": { "plane": { "offset": [0, 0.33, 0], "normal": [0, 1, 0] } } });
    let plane = json!([{
        "node": 4, "shape": { "sphere": { "radius": 0 } },
        "extensions": { "VRMC_springBone_extended_collider": plane },
    }]);
    let library = limp(plane);
    let height = place(&library, &frame(&library, &swinging()), "c").y;
    assert!((height - -0.03).abs() < 3e-3, "{height}");
}

#[test]
fn springs_of_vrm_0_swing_with_everything_below_their_bones() {
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
    let lowered = place(&library, &frame(&library, &swinging()), "hair2").y
        - place(&library, &frame(&library, &ViewerState::default()), "hair2").y;
    assert!(lowered < -0.05, "{lowered}");
}

#[test]
fn avatars_do_not_allocate_while_they_play() {
    let springs = library(chain(0.5, json!([{ "node": 4, "shape": { "sphere": { "radius": 0.1 } } }])));
    let mut face = swinging();
    face.edits.expressions = BTreeMap::from([("happy".to_owned(), 0.5)]);
    let mut eyes_state = swinging();
    eyes_state.display.look_at = LookTarget::Camera;
    eyes_state.camera_options.follow = true;
    let eyes = library(eyes("bone", json!({})));
    for (library, mut state) in [(springs, swinging()), (library(face_1()), face), (eyes, eyes_state)] {
        let mut frame = Frame::default();
        let mut play = |frames: usize| {
            for _ in 0..frames {
                apply(&mut state, &library, Command::Advance(1.0 / 60.0));
                evaluate(&library, &state, 1.5, &mut frame);
            }
        };
        assert_eq!(allocations_after(&mut play, |play| play(130), |play| play(300)), 0);
    }
}

#[test]
fn licence_and_first_person_flags_are_listed() {
    let vrm = json!({
        "meta": {
            "name": "Cube", "authors": ["A", "B"], "allowRedistribution": true, "thumbnailImage": 0, "references": [],
            "licenseUrl": "https://vrm.dev/licenses/1.0/",
        },
        "firstPerson": { "meshAnnotations": [{ "node": 0, "type": "thirdPersonOnly" }, { "node": 7, "type": "both" }] },
    });
    let document = inspect(model(&library(person("VRMC_vrm", json!([]), vrm))), &[]);
    let avatar = &document["avatar"];
    assert_eq!(avatar["spec_version"], "1.0");
    let meta = json!({
        "name": "Cube", "authors": "A, B", "allowRedistribution": "yes", "licenseUrl": "https://vrm.dev/licenses/1.0/",
    });
    assert_eq!(avatar["meta"], meta);
    assert_eq!(avatar["first_person"], json!([{ "node": 0, "flag": "thirdPersonOnly" }]));
    assert_eq!(inspect(model(&crate::data::walker()), &[])["avatar"], Value::Null);
}

#[test]
fn real_avatars_have_what_their_files_say_and_move() {
    if data_folder().is_none() {
        return;
    }
    let open = |path: &str| open(path).expect("the data folder");
    let cube = open("materials/three-vrm/core/cube.gltf");
    let mut state = ViewerState::default();
    let rest = frame(&cube, &state).pose().clone();
    apply(&mut state, &cube, Command::SetExpression { name: "aa".to_owned(), weight: Some(0.5) });
    let aa = frame(&cube, &state).pose().clone();
    assert!(aa.morph_weights.iter().zip(&rest.morph_weights).any(|(now, rest)| (now - rest - 1.5).abs() < 1e-6));
    apply(&mut state, &cube, Command::SetLookAt(LookTarget::Camera));
    assert_ne!(frame(&cube, &state).pose().locals().collect::<Vec<_>>(), rest.locals().collect::<Vec<_>>());

    let binary = open("vrm/vrm1_VRMC_vrm_expressions_isBinary_Overridden.vrm");
    let materials = |weights: &[(&str, f32)]| {
        let mut state = ViewerState::default();
        state.edits.expressions = weights.iter().map(|&(name, weight)| (name.to_owned(), weight)).collect();
        frame(&binary, &state).characters[0].materials.clone()
    };
    assert_eq!(materials(&[("blink", 0.4)]), []);
    assert_ne!(materials(&[("blink", 0.6)]), []);
    assert_eq!(
        materials(&[("blink", 1.0), ("happy", 0.2)]),
        materials(&[("happy", 0.2)]),
        "an override puts blink out"
    );

    let cubes = open("materials/three-vrm/node-constraint/cubes.gltf");
    let mut state = ViewerState::default();
    apply(&mut state, &cubes, Command::SetPose { joint: 0, degrees: Some([0.0, 80.0, 0.0]) });
    let turned = frame(&cubes, &state);
    assert!(is_near(rotation(&cubes, &turned, "CubeB"), Quat::from_rotation_y(80.0_f32.to_radians())));
    assert!(is_near(rotation(&cubes, &turned, "CubeC"), Quat::from_rotation_y(40.0_f32.to_radians())));

    for name in ["sphere", "plane", "inside"] {
        let springs = open(&format!("materials/three-vrm/springbone/{name}-collider.gltf"));
        assert_eq!(model(&springs).asset.avatar.springs.joints().len(), 4, "{name}");
        assert_eq!(model(&springs).asset.avatar.springs.colliders().len(), 1, "{name}");
        // They hang straight down, out of reach of the collider, and have no gravity.
        let (rest, swung) = (frame(&springs, &ViewerState::default()), frame(&springs, &swinging()));
        assert!(
            rest.pose().locals().zip(swung.pose().locals()).all(|(a, b)| is_near(a.rotation, b.rotation)),
            "{name}"
        );
    }
    let old = open("vrm/vrm0_EmissionMigration_v0.107.0.vrm");
    assert_eq!(model(&old).asset.avatar.expressions.len(), 17);
    assert!(model(&old).asset.avatar.expression("happy").is_some());
}

#[test]
fn a_real_vrma_animates_a_real_avatar() {
    if data_folder().is_none() {
        return;
    }
    let open = |path: &str| open(path).expect("the data folder");
    let mut library = open("vrm/vrm1_VRMC_vrm_expressions_isBinary_Overridden.vrm");
    let motion = model(&open("vrm/three-vrm_test.vrma")).asset.clone();
    library.set_motions(vec![Motion::new("three-vrm_test.vrma".to_owned(), motion)]);
    library.borrow_each(vec![None]);
    let mut state = ViewerState::default();
    let mut weights = Vec::new();
    for step in 0..30 {
        apply(&mut state, &library, Command::Seek(0.1 * f64::from(step)));
        weights.push(frame(&library, &state).expressions()[0]);
    }
    let most = weights.iter().copied().fold(0.0, f32::max);
    assert!(most > 0.5 && weights.iter().any(|&weight| weight < 0.5 * most), "{weights:?}");
}

/// Pointers to everything at or below a value.
fn pointers(value: &Value, at: &str, out: &mut Vec<String>) {
    out.push(at.to_owned());
    match value {
        Value::Array(list) => {
            for (index, value) in list.iter().enumerate() {
                pointers(value, &format!("{at}/{index}"), out);
            }
        }
        Value::Object(object) => {
            for (key, value) in object {
                pointers(value, &format!("{at}/{}", key.replace('~', "~0").replace('/', "~1")), out);
            }
        }
        _ => {}
    }
}

/// Whatever stands where in the extensions, the model loads or is refused, and its pose has no NaN.
#[test]
fn odd_values_do_no_harm() {
    let capsule =
        json!([{ "node": 4, "shape": { "capsule": { "offset": [0, 0, 0], "tail": [0, 0, 1], "radius": 0.1 } } }]);
    let spring_0 = json!({ "secondaryAnimation": {
        "boneGroups": [{ "stiffiness": 1, "gravityDir": { "x": 0, "y": -1 }, "bones": [1], "colliderGroups": [0] }],
        "colliderGroups": [{ "node": 2, "colliders": [{ "offset": { "x": 0 }, "radius": 0.1 }] }],
    } });
    let fixtures = [
        face_0(),
        face_1(),
        eyes("bone", json!({})),
        constrained(json!({ "aim": { "source": SOURCE, "aimAxis": "PositiveX", "weight": 0.5 } })),
        chain(1.0, capsule),
        person("VRM", json!([]), spring_0),
    ];
    let odd = [
        Value::Null,
        json!(-1),
        json!(1e30),
        json!(0),
        json!(1_u64 << 40),
        json!("x"),
        json!([]),
        json!([[], 3]),
        json!({ "node": 0 }),
        json!(true),
    ];
    let mut loaded = 0;
    for Build { json, bytes } in fixtures {
        let mut places = Vec::new();
        for root in ["/extensions", "/nodes/3/extensions"] {
            if let Some(value) = json.pointer(root) {
                pointers(value, root, &mut places);
            }
        }
        for (place, value) in places.iter().flat_map(|place| odd.iter().map(move |value| (place, value))) {
            let mut build = Build { json: json.clone(), bytes: bytes.clone() };
            *build.json.pointer_mut(place).expect("a place") = value.clone();
            let Ok(asset) = build.load() else { continue };
            let library = library_of(Model::new("odd.vrm".to_owned(), asset, Vec::new()));
            let mut state = looking_at(Vec3::new(0.3, 2.0, 1.0));
            state.display.springs = true;
            let names = model(&library).asset.avatar.expressions.iter().map(|expression| expression.name.clone());
            state.edits.expressions = names.map(|name| (name, 1.0)).collect();
            state.playhead.time_secs = 0.4;
            let frame = frame(&library, &state);
            let is_nan = frame.characters[0].world_from_joint.iter().any(|world| world.is_nan());
            let has_nan_weight = frame.pose().morph_weights.iter().any(|weight| weight.is_nan());
            assert!(!is_nan && !has_nan_weight, "{place} = {value}");
            loaded += 1;
        }
    }
    assert!(loaded > 2000, "{loaded}");
}
