//! Metadata, real files, and files with invalid values.

use gaitway_scene::library::{LookTarget, Model, Motion, inspect};
use gaitway_scene::state::{Command, ViewerState, apply};
use glam::{Quat, Vec3};
use serde_json::{Value, json};

use super::constraints::{SOURCE, constrained};
use super::expressions::{face_vrm_0, face_vrm_1};
use super::look_at::{eyes, looking_at};
use super::springs::{chain, swinging};
use super::{frame, is_near, library, model, person, rotation};
use crate::build_gltf::Build;
use crate::data::{library_of, open};
use crate::data_folder::data_folder;

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
fn real_avatars_load_and_move() {
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
        state.character.edits.expressions = weights.iter().map(|&(name, weight)| (name.to_owned(), weight)).collect();
        frame(&binary, &state).characters[0].materials.clone()
    };
    assert_eq!(materials(&[("blink", 0.4)]), []);
    assert_ne!(materials(&[("blink", 0.6)]), []);
    assert_eq!(
        materials(&[("blink", 1.0), ("happy", 0.2)]),
        materials(&[("happy", 0.2)]),
        "an override switches blink off"
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
        // The chains hang straight down, out of reach of the collider and without gravity.
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
    let max = weights.iter().copied().fold(0.0, f32::max);
    assert!(max > 0.5 && weights.iter().any(|&weight| weight < 0.5 * max), "{weights:?}");
}

/// Collects the JSON pointers of a value and of everything in it.
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

/// Whatever value is replaced in the extensions, the model loads or is rejected, and its pose has no NaN.
#[test]
fn invalid_values_do_no_harm() {
    let capsule =
        json!([{ "node": 4, "shape": { "capsule": { "offset": [0, 0, 0], "tail": [0, 0, 1], "radius": 0.1 } } }]);
    let spring_0 = json!({ "secondaryAnimation": {
        "boneGroups": [{ "stiffiness": 1, "gravityDir": { "x": 0, "y": -1 }, "bones": [1], "colliderGroups": [0] }],
        "colliderGroups": [{ "node": 2, "colliders": [{ "offset": { "x": 0 }, "radius": 0.1 }] }],
    } });
    let fixtures = [
        face_vrm_0(),
        face_vrm_1(),
        eyes("bone", json!({})),
        constrained(json!({ "aim": { "source": SOURCE, "aimAxis": "PositiveX", "weight": 0.5 } })),
        chain(1.0, capsule),
        person("VRM", json!([]), spring_0),
    ];
    let invalid = [
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
        for (place, value) in places.iter().flat_map(|place| invalid.iter().map(move |value| (place, value))) {
            let mut build = Build { json: json.clone(), bytes: bytes.clone() };
            *build.json.pointer_mut(place).expect("a place") = value.clone();
            let Ok(asset) = build.load() else { continue };
            let library = library_of(Model::new("invalid.vrm".to_owned(), asset, Vec::new()));
            let mut state = looking_at(Vec3::new(0.3, 2.0, 1.0));
            state.display.springs = true;
            let names = model(&library).asset.avatar.expressions.iter().map(|expression| expression.name.clone());
            state.character.edits.expressions = names.map(|name| (name, 1.0)).collect();
            state.character.playhead.time_secs = 0.4;
            let frame = frame(&library, &state);
            let is_nan = frame.characters[0].world_from_joint.iter().any(|world| world.is_nan());
            let has_nan_weight = frame.pose().morph_weights.iter().any(|weight| weight.is_nan());
            assert!(!is_nan && !has_nan_weight, "{place} = {value}");
            loaded += 1;
        }
    }
    assert!(loaded > 2000, "{loaded}");
}
