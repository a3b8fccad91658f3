//! Expressions: what they change, how they override each other, and where their weights come from.

use std::collections::BTreeMap;
use std::sync::Arc;

use gaitway_character::anim::{PropertyTarget, TextureSlot};
use gaitway_character::asset::Asset;
use gaitway_character::avatar::{Expression, Override, resolve_weights};
use gaitway_scene::library::{ClipId, Library, Motion, inspect};
use gaitway_scene::state::{ClipChoice, Command, History, ViewerState, apply};
use glam::{Vec2, Vec3, Vec4};
use serde_json::{Value, json};

use super::{frame, library, model, person, rotation};
use crate::build_gltf::{Build, F32, floats};
use crate::by_place::ByPlace;
use crate::history::undo;

/// A triangle with two morph targets, a clip that holds their weights at 0.25 and 0, and a textured material.
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

/// [`face`] with the expressions `happy` and `wink`, as VRM 1.0.
pub fn face_vrm_1() -> Build {
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

/// The same as VRM 0.x.
pub fn face_vrm_0() -> Build {
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

/// Each expression has a name, whether it is binary, its overrides of blink, look-at and mouth, and its weight.
fn check_weights(expressions: &[(&str, bool, [Override; 3], f32)], expected: &[f32]) {
    let expression = |&(name, is_binary, overrides, _): &(&str, bool, [Override; 3], f32)| Expression {
        is_binary,
        overrides,
        ..Expression::new(name, name, Expression::PRESETS.contains(&name))
    };
    let mut weights: Vec<f32> = expressions.iter().map(|expression| expression.3).collect();
    let expressions: Vec<Expression> = expressions.iter().map(expression).collect();
    resolve_weights(&expressions, &mut weights);
    assert!(weights.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{weights:?}, expected {expected:?}");
}

#[test]
fn expressions_override_the_groups_blink_look_at_and_mouth() {
    const NOTHING: [Override; 3] = [Override::None; 3];
    const BLOCK_BLINK: [Override; 3] = [Override::Block, Override::None, Override::None];
    const BLEND_ALL: [Override; 3] = [Override::Blend; 3];
    check_weights(&[("happy", false, BLOCK_BLINK, 0.1), ("blink", false, NOTHING, 0.9)], &[0.1, 0.0]);
    check_weights(&[("happy", false, BLOCK_BLINK, 0.0), ("blink", false, NOTHING, 0.9)], &[0.0, 0.9]);
    // Only expressions of the group.
    check_weights(&[("happy", false, BLOCK_BLINK, 1.0), ("aa", false, NOTHING, 0.9)], &[1.0, 0.9]);
    check_weights(&[("happy", false, BLOCK_BLINK, 1.0), ("Blink", false, NOTHING, 0.9)], &[1.0, 0.9]);
    check_weights(&[("aa", false, NOTHING, 0.8), ("sad", false, BLEND_ALL, 0.25)], &[0.6, 0.25]);
    check_weights(&[("lookUp", false, NOTHING, 1.0), ("sad", false, BLEND_ALL, 1.0)], &[0.0, 1.0]);
    // Several overrides add up; the result is never negative.
    let two = |a, b| [("oh", false, NOTHING, 1.0), ("sad", false, BLEND_ALL, a), ("angry", false, BLEND_ALL, b)];
    check_weights(&two(0.25, 0.5), &[0.25, 0.25, 0.5]);
    check_weights(&two(0.75, 0.5), &[0.0, 0.75, 0.5]);
    // Binary expressions are rounded before they override, and switched off when overridden in part.
    check_weights(&[("happy", true, BLEND_ALL, 0.6), ("blink", false, NOTHING, 1.0)], &[1.0, 0.0]);
    check_weights(&[("happy", true, BLEND_ALL, 0.5), ("blink", false, NOTHING, 1.0)], &[0.0, 1.0]);
    check_weights(&[("happy", false, BLEND_ALL, 0.1), ("blink", true, NOTHING, 1.0)], &[0.1, 0.0]);
    // What overrides its own group is invalid.
    check_weights(&[("blink", false, [Override::Block; 3], 0.75), ("aa", false, NOTHING, 0.5)], &[0.75, 0.0]);
    check_weights(&[("happy", false, NOTHING, 7.0), ("sad", false, NOTHING, -1.0)], &[1.0, 0.0]);
}

#[test]
fn expressions_leave_the_matcap_where_it_is() {
    let mut build = face_vrm_1();
    let toon = json!({ "specVersion": "1.0", "matcapTexture": { "index": 0 } });
    build.json["materials"][0]["extensions"] = json!({ "VRMC_materials_mtoon": toon });
    let library = library(build);
    let mut state = ViewerState::default();
    apply(&mut state, &library, Command::SetExpression { name: "happy".to_owned(), weight: Some(1.0) });
    let happy = frame(&library, &state);
    let [(0, material)] = &happy.characters[0].materials[..] else { panic!("one animated material") };
    let offset = |slot| material.texture(slot).expect("a texture").uv_transform.offset;
    assert_eq!(offset(TextureSlot::BaseColor), Vec2::new(0.25, 0.5));
    assert_eq!(offset(TextureSlot::Matcap), Vec2::ZERO);
}

#[test]
fn expressions_move_morphs_colours_and_textures_on_top_of_the_clip() {
    for build in [face_vrm_1(), face_vrm_0()] {
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
        // A second expression adds to the first; a morph weight set manually replaces the result.
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
    let [new, old] = [face_vrm_1(), face_vrm_0()].map(Build::loaded);
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
fn unknown_expressions_are_ignored_and_edits_can_be_undone() {
    let mut library = library(face_vrm_1());
    let (mut state, mut history) = (ViewerState::default(), History::default());
    let set = |name: &str, weight: f32| Command::SetExpression { name: name.to_owned(), weight: Some(weight) };
    history.apply(&mut state, &library, set("grin", 1.0));
    history.apply(&mut state, &library, set("happy", f32::NAN));
    assert_eq!(state, ViewerState::default());
    history.apply(&mut state, &library, set("happy", 3.0));
    assert_eq!(state.character.edits.expressions, BTreeMap::from([("happy".to_owned(), 1.0)]));
    assert!(undo(&mut history, &mut state, &mut library));
    assert_eq!(state, ViewerState::default());
    // As from a link that is read before its model is loaded.
    state.character.edits.expressions.insert("grin".to_owned(), 1.0);
    assert_eq!(frame(&library, &state).pose().morph_weights, [0.25, 0.0]);
}

#[test]
fn a_vrma_animates_expressions_of_the_same_name() {
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
    let motion = motion.loaded();
    let targets: Vec<PropertyTarget> = motion.clips[0].properties().iter().map(|channel| channel.target).collect();
    assert_eq!(targets, [PropertyTarget::Expression(0), PropertyTarget::Expression(1)]);

    let expressions = json!({ "expressions": { "preset": { "sad": {}, "happy": {} } } });
    let mut library = library(person("VRMC_vrm", json!([]), expressions));
    library.set_motions(vec![Motion::new("smile.vrma".to_owned(), Arc::new(motion))]);
    library.borrow_each(vec![None]);
    let clip = model(&library).clip_at(0).clip();
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

/// A .vrma may animate expressions and no bone: of an avatar, or morph targets of their names.
#[test]
fn a_vrma_of_expressions_alone_needs_no_body() {
    let mut motion = Build::new();
    motion.json["nodes"] = json!([{ "name": "happy" }, { "name": "wink" }]);
    let expressions = json!({ "preset": { "happy": { "node": 0 } }, "custom": { "wink": { "node": 1 } } });
    motion.json["extensionsUsed"] = json!(["VRMC_vrm_animation"]);
    motion.json["extensions"] = json!({ "VRMC_vrm_animation": { "specVersion": "1.0", "expressions": expressions } });
    let times = motion.accessor(F32, "SCALAR", 2, &floats(&[0.0, 1.0]));
    let weights = motion.accessor(F32, "VEC3", 2, &floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]));
    let channel = |node: usize| json!({ "sampler": 0, "target": { "node": node, "path": "translation" } });
    motion.json["animations"] = json!([{
        "name": "smile",
        "channels": [channel(0), channel(1)], "samplers": [{ "input": times, "output": weights }],
    }]);
    let motion = Arc::new(motion.loaded());
    let playing = |build: Build| {
        let mut library = library(build);
        library.set_motions(vec![Motion::new("smile.vrma".to_owned(), motion.clone())]);
        library.borrow_each(vec![None]);
        library
    };
    let at_half = |library: &Library| {
        let borrowed = ClipId::Borrowed(library.motions()[0].id().clone(), 0);
        let mut state = ViewerState::default();
        apply(&mut state, library, Command::SetClip(ClipChoice::Clip(borrowed)));
        apply(&mut state, library, Command::Seek(0.5));
        frame(library, &state)
    };
    let avatar = playing(face_vrm_1());
    assert_eq!(at_half(&avatar).expressions(), [0.5, 0.5]);

    // Without expressions of its own, a face smiles by its morph targets.
    let mut plain = face("KHR_materials_unlit", json!({}));
    plain.json["meshes"][0]["extras"] = json!({ "targetNames": ["other", "Happy"] });
    let plain = playing(plain);
    assert_eq!(at_half(&plain).pose().morph_weights, [0.0, 0.5]);
    // Nothing of it moves this one.
    let none = playing(face("KHR_materials_unlit", json!({})));
    assert!(none.borrow_errors()[0].to_string().contains("none of them"), "{:?}", none.borrow_errors());
}

#[test]
fn invalid_expressions_and_binds_are_skipped_with_a_warning() {
    let bad = json!({ "expressions": {
        "preset": {
            "happy": { "morphTargetBinds": [
                { "node": 9, "index": 0 }, { "node": 0, "index": 7 }, { "node": "x" }, 3,
            ], "materialColorBinds": [{ "material": 5, "type": "color" }, null] },
            "grin": {},
        },
        "custom": { "blink": {} },
    } });
    let asset = face("VRMC_vrm", bad).loaded();
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
