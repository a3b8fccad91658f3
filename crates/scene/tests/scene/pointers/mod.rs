//! KHR_animation_pointer and KHR_node_visibility, from files to frames.

mod keys;
mod shown;
mod visibility;

use std::sync::Arc;

use gaitway_character::anim::{ClipBuilder, Interpolation, MaterialProperty, PropertyTarget};
use gaitway_character::asset::Asset;
use gaitway_retarget::{JointMap, propose};
use gaitway_scene::editor::Editor;
use gaitway_scene::frame::{Frame, evaluate, travelled};
use gaitway_scene::library::{Library, Model, Motion, inspect};
use gaitway_scene::samples;
use gaitway_scene::state::{CameraChoice, CharacterView, ClipChoice, Command, Fade, Playhead, ViewerState};
use glam::{Vec3, Vec4};
use serde_json::{Value, json};

use self::keys::curves;
use self::shown::shown;
use crate::allocation::allocations_while_playing;
use crate::build_gltf::{Build, warnings};
use crate::by_place::ByPlace;
use crate::data::{library_of, open, sampled};
use crate::data_folder::data_folder;

/// Compares every animated property with the file's keys at these times, and returns the pointers that aren't shown.
fn check(library: &Library, json: &Value, buffers: &[Vec<u8>], times_secs: &[f32]) -> Vec<String> {
    let asset = &library.active().expect("a model").asset;
    let curves = curves(json, buffers);
    let mut frame = Frame::default();
    let (mut not_shown, mut worst) = (Vec::new(), 0.0_f64);
    for &time_secs in times_secs {
        evaluate(library, &at(time_secs), 1.0, &mut frame);
        not_shown.clear();
        for (pointer, curve) in &curves {
            let Some(found) = shown(asset, json, &frame, pointer) else {
                not_shown.push(pointer.clone());
                continue;
            };
            let is_rotation = pointer.starts_with("/nodes/") && pointer.ends_with("/rotation");
            let expected = curve.at(f64::from(time_secs), is_rotation);
            assert_eq!(found.len(), expected.len(), "{pointer}");
            let dot: f64 = found.iter().zip(&expected).map(|(&found, expected)| f64::from(found) * expected).sum();
            let sign = if is_rotation && dot < 0.0 { -1.0 } else { 1.0 };
            for (&found, expected) in found.iter().zip(&expected) {
                let off = (sign * f64::from(found) - expected).abs() / expected.abs().max(1.0);
                worst = worst.max(off);
                assert!(off < 1e-5, "{pointer} at {time_secs} s: {found}, expected {expected}");
            }
        }
    }
    println!("{} of {} pointers, off by {worst:e} at most", curves.len() - not_shown.len(), curves.len());
    not_shown
}

/// A view of the first clip at this time.
pub fn at(time_secs: f32) -> ViewerState {
    let playhead = Playhead { time_secs: f64::from(time_secs), ..Playhead::default() };
    ViewerState { character: CharacterView { playhead, ..CharacterView::default() }, ..ViewerState::default() }
}

/// One of everything that can be animated: meshes with two morph targets on nodes 0, 5, 6 and 7, a spot light on node
/// 1, cameras on nodes 2 and 3. Node 5 is a child of node 4.
pub fn complete() -> Build {
    let mut build = Build::triangle();
    let primitive = json!({ "attributes": { "POSITION": 0 }, "material": 0,
        "targets": [{ "POSITION": 0 }, { "POSITION": 0 }] });
    build.json["meshes"] = json!([{ "primitives": [primitive] }, { "primitives": [primitive] },
        { "primitives": [primitive] }]);
    build.json["nodes"] = json!([
        { "mesh": 0 },
        { "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        { "camera": 0 },
        { "camera": 1 },
        { "children": [5] },
        { "mesh": 1, "translation": [5, 0, 0] },
        { "mesh": 0, "weights": [0.5, 0.5] },
        { "mesh": 2 },
    ]);
    let texture = json!({ "index": 0 });
    build.json["textures"] = json!([{}]);
    build.json["materials"] = json!([{
        "pbrMetallicRoughness": { "baseColorTexture": texture, "metallicRoughnessTexture": texture },
        "normalTexture": texture, "occlusionTexture": texture, "emissiveTexture": texture, "alphaMode": "MASK",
        "extensions": { "KHR_materials_clearcoat": { "clearcoatNormalTexture": texture } },
    }]);
    build.json["cameras"] = json!([
        { "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } },
        { "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "znear": 0, "zfar": 9 } },
    ]);
    build.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "spot", "spot": {} }] } });
    build.json["animations"] = json!([{ "name": "all", "channels": [], "samplers": [] }]);
    build
}

pub fn library(build: Build) -> Library {
    library_of(Model::new("built.glb".to_owned(), build.load().expect("readable"), Vec::new()))
}

/// Pointers into [`complete`], with the types of their accessors.
const POINTERS: [(&str, &str); 62] = [
    ("/nodes/4/translation", "VEC3"),
    ("/nodes/4/rotation", "VEC4"),
    ("/nodes/4/scale", "VEC3"),
    ("/nodes/4/extensions/KHR_node_visibility/visible", "SCALAR"),
    ("/nodes/5/weights", "SCALAR"),
    ("/nodes/6/weights/1", "SCALAR"),
    ("/meshes/0/weights", "SCALAR"),
    ("/meshes/2/weights/1", "SCALAR"),
    ("/cameras/0/perspective/yfov", "SCALAR"),
    ("/cameras/0/perspective/znear", "SCALAR"),
    ("/cameras/0/perspective/zfar", "SCALAR"),
    ("/cameras/1/orthographic/ymag", "SCALAR"),
    ("/cameras/1/orthographic/znear", "SCALAR"),
    ("/cameras/1/orthographic/zfar", "SCALAR"),
    ("/extensions/KHR_lights_punctual/lights/0/color", "VEC3"),
    ("/extensions/KHR_lights_punctual/lights/0/intensity", "SCALAR"),
    ("/extensions/KHR_lights_punctual/lights/0/range", "SCALAR"),
    ("/extensions/KHR_lights_punctual/lights/0/spot/innerConeAngle", "SCALAR"),
    ("/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle", "SCALAR"),
    ("/materials/0/pbrMetallicRoughness/baseColorFactor", "VEC4"),
    ("/materials/0/pbrMetallicRoughness/metallicFactor", "SCALAR"),
    ("/materials/0/pbrMetallicRoughness/roughnessFactor", "SCALAR"),
    ("/materials/0/emissiveFactor", "VEC3"),
    ("/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength", "SCALAR"),
    ("/materials/0/alphaCutoff", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_ior/ior", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_specular/specularFactor", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_specular/specularColorFactor", "VEC3"),
    ("/materials/0/extensions/KHR_materials_clearcoat/clearcoatFactor", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_clearcoat/clearcoatNormalTexture/scale", "SCALAR"),
    (
        "/materials/0/extensions/KHR_materials_clearcoat/clearcoatNormalTexture/extensions/KHR_texture_transform/offset",
        "VEC2",
    ),
    ("/materials/0/extensions/KHR_materials_sheen/sheenColorFactor", "VEC3"),
    ("/materials/0/extensions/KHR_materials_sheen/sheenRoughnessFactor", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_iridescence/iridescenceFactor", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_iridescence/iridescenceIor", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_iridescence/iridescenceThicknessMinimum", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_iridescence/iridescenceThicknessMaximum", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_anisotropy/anisotropyStrength", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_anisotropy/anisotropyRotation", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_transmission/transmissionFactor", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_volume/thicknessFactor", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_volume/attenuationDistance", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_volume/attenuationColor", "VEC3"),
    ("/materials/0/extensions/KHR_materials_dispersion/dispersion", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionFactor", "SCALAR"),
    ("/materials/0/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorFactor", "VEC3"),
    ("/materials/0/normalTexture/scale", "SCALAR"),
    ("/materials/0/occlusionTexture/strength", "SCALAR"),
    ("/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/offset", "VEC2"),
    ("/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/rotation", "SCALAR"),
    ("/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/scale", "VEC2"),
    ("/materials/0/pbrMetallicRoughness/metallicRoughnessTexture/extensions/KHR_texture_transform/offset", "VEC2"),
    ("/materials/0/pbrMetallicRoughness/metallicRoughnessTexture/extensions/KHR_texture_transform/rotation", "SCALAR"),
    ("/materials/0/pbrMetallicRoughness/metallicRoughnessTexture/extensions/KHR_texture_transform/scale", "VEC2"),
    ("/materials/0/normalTexture/extensions/KHR_texture_transform/offset", "VEC2"),
    ("/materials/0/normalTexture/extensions/KHR_texture_transform/rotation", "SCALAR"),
    ("/materials/0/normalTexture/extensions/KHR_texture_transform/scale", "VEC2"),
    ("/materials/0/occlusionTexture/extensions/KHR_texture_transform/offset", "VEC2"),
    ("/materials/0/occlusionTexture/extensions/KHR_texture_transform/rotation", "SCALAR"),
    ("/materials/0/emissiveTexture/extensions/KHR_texture_transform/scale", "VEC2"),
    ("/materials/0/emissiveTexture/extensions/KHR_texture_transform/rotation", "SCALAR"),
];

/// [`complete`] with all [`POINTERS`] animated over two seconds, each with its own keys.
fn all_animated(interpolation: &str) -> Build {
    let mut build = complete();
    for (at, (pointer, shape)) in POINTERS.into_iter().enumerate() {
        let times_secs = [0.0, 0.3 + 0.01 * at as f32, 1.25, 2.0];
        let is_visibility = pointer.ends_with("/visible");
        let interpolation = if is_visibility { "STEP" } else { interpolation };
        let per_entry = if pointer.ends_with("/weights") { 2 } else { 1 };
        let width = if shape == "SCALAR" { 1 } else { shape[3..].parse::<usize>().expect("a vector") };
        let per_key = if interpolation == "CUBICSPLINE" { 3 } else { 1 };
        let count = times_secs.len() * per_key * per_entry * width;
        let scattered = |index: usize| ((7 * at + 37 * index) % 23) as f32 / 23.0 + 0.1;
        let value = |index: usize| if is_visibility { (index % 2) as f32 } else { scattered(index) };
        let values: Vec<f32> = (0..count).map(value).collect();
        build.point(pointer, interpolation, shape, &times_secs, &values);
    }
    build
}

#[test]
fn every_property_follows_its_keys_by_every_interpolation() {
    for interpolation in ["STEP", "LINEAR", "CUBICSPLINE"] {
        let build = all_animated(interpolation);
        let (json, buffers) = (build.json.clone(), [build.bytes.clone()]);
        let library = library(build);
        let asset = &library.active().expect("a model").asset;
        assert_eq!(warnings(asset), [""; 0]);
        let not_shown = check(&library, &json, &buffers, &[0.0, 0.17, 0.31, 0.8, 1.25, 1.9, 1.999]);
        assert_eq!(not_shown, [""; 0], "{interpolation}");
        // Scripts see the same pointers, except those of ordinary channels.
        let document = inspect(library.active().expect("a model"), &[]);
        let listed = document["clips"][0]["properties"].as_array().expect("a list");
        for pointer in POINTERS.into_iter().map(|(pointer, _)| pointer) {
            let is_ordinary =
                ["translation", "rotation", "/4/scale", "weights"].iter().any(|end| pointer.ends_with(end));
            let is_ordinary = is_ordinary && pointer.starts_with("/nodes") || pointer.starts_with("/meshes");
            assert_eq!(listed.contains(&json!(pointer)), !is_ordinary, "{pointer}");
        }
        assert_eq!(document["clips"][0]["channels"], POINTERS.len());
    }
}

#[test]
fn a_real_file_follows_its_keys() {
    let path = "blender-io/24_animation_pointer/24_animation_pointer.gltf";
    let (Some(library), Some(folder)) = (open(path), data_folder()) else { return };
    let file = folder.join(path);
    let json: Value = serde_json::from_slice(&std::fs::read(&file).expect("there")).expect("JSON");
    let uris =
        json["buffers"].as_array().expect("buffers").iter().map(|buffer| buffer["uri"].as_str().expect("a file"));
    let buffers: Vec<Vec<u8>> = uris.map(|uri| std::fs::read(file.with_file_name(uri)).expect("there")).collect();
    let times_secs: Vec<f32> = (0..40).map(|step| 0.123 + 0.2471 * step as f32).collect();
    let not_shown = check(&library, &json, &buffers, &times_secs);
    let expected = ["/cameras/2/orthographic/xmag", "/materials/5/normalTexture/offset"];
    assert_eq!(not_shown, expected);
    let asset = &library.active().expect("a model").asset;
    let of_channels =
        asset.warnings.iter().filter(|warning| ["animation-pointer", "channel-ignored"].contains(&warning.code()));
    let of_channels: Vec<String> = of_channels.map(ToString::to_string).collect();
    assert_eq!(of_channels.len(), 1, "{of_channels:?}");
    assert!(expected.iter().all(|pointer| of_channels[0].contains(pointer)), "{of_channels:?}");
}

#[test]
fn a_clip_zooms_the_cameras_of_the_file() {
    let mut build = complete();
    build.point("/cameras/0/perspective/yfov", "LINEAR", "SCALAR", &[0.0, 2.0], &[1.0, 2.0]);
    build.point("/cameras/1/orthographic/ymag", "LINEAR", "SCALAR", &[0.0, 2.0], &[1.0, 3.0]);
    let library = library(build);
    let mut frame = Frame::default();
    let mut up = |camera, time_secs| {
        let state = ViewerState { camera: CameraChoice::File(camera), ..at(time_secs) };
        evaluate(&library, &state, 1.0, &mut frame);
        frame.view.projection_from_view.y_axis.y
    };
    assert!((up(0, 1.0) - 1.0 / 0.75_f32.tan()).abs() < 1e-5);
    assert!((up(1, 1.0) - 0.5).abs() < 1e-6);
}

/// Moving the view of a camera of the file starts from where that is in the current pose.
#[test]
fn a_camera_of_the_file_is_moved_from_where_it_is() {
    let tilt = json!([-0.130_526_2, 0.0, 0.0, 0.991_444_9]);
    let lens = json!([{ "type": "perspective", "perspective": { "yfov": 0.6, "znear": 0.1 } }]);
    let mut build = Build::triangle().with("/cameras", lens).with("/nodes/0/camera", json!(0));
    build = build.with("/nodes/0/rotation", tilt);
    build.point("/nodes/0/translation", "LINEAR", "VEC3", &[0.0, 2.0], &[0.0, 0.0, 0.0, 3.0, 1.0, -2.0]);
    let state = ViewerState { camera: CameraChoice::File(0), ..at(1.0) };
    let mut editor = Editor::new(library(build), state.clone());
    let camera = |editor: &Editor| {
        let mut frame = Frame::default();
        evaluate(editor.library(), editor.state(), 1.0, &mut frame);
        (frame.view.eye, frame.view.view_from_world.row(2).truncate())
    };
    for follow in [false, true] {
        editor.apply(Command::Replace(Box::new(state.clone())));
        editor.apply(Command::SetFollow(follow));
        let (eye, back) = camera(&editor);
        assert!(eye.distance(Vec3::new(1.5, 0.5, -1.0)) < 1e-5, "{eye}");
        for command in [Command::Orbit { yaw_radians: 0.0, pitch_radians: 0.0 }, Command::Pan { right: 0.0, up: 0.0 }] {
            editor.apply(command);
            assert!(matches!(editor.state().camera, CameraChoice::Orbit(_)));
            let (now, direction) = camera(&editor);
            assert!(now.distance(eye) < 1e-4 && direction.distance(back) < 1e-4, "{follow}: {now} {direction}");
        }
        editor.apply(Command::SetCamera(CameraChoice::File(0)));
        editor.apply(Command::FrameAll);
        assert!(camera(&editor).1.distance(back) < 1e-4, "framing keeps the direction");
    }
    assert_ne!(travelled(editor.library(), editor.state()), Vec3::ZERO);
}

/// The walker, whose first clip makes its first material red.
fn red_walker() -> Model {
    let walker = samples::load("walker").expect("built in");
    let asset = Arc::try_unwrap(walker.asset).expect("not shared");
    let mut builder = ClipBuilder::new("Red", &asset.skeleton);
    for channel in asset.clips[0].channels() {
        let times_secs = &asset.clips[0].timelines()[channel.timeline as usize];
        builder.channel(channel.joint, channel.interpolation, times_secs, channel.keys.clone()).expect("as before");
    }
    builder.property(BASE_COLOR, Interpolation::Step, &[0.0], RED.to_array().to_vec()).expect("one key");
    let red = builder.build();
    let mut parts = asset.into_parts();
    parts.clips[0] = red;
    Model::new("red.glb".to_owned(), Asset::new(parts).expect("indices in range"), Vec::new())
}

const BASE_COLOR: PropertyTarget = PropertyTarget::Material(0, MaterialProperty::BaseColor);
const RED: Vec4 = Vec4::new(1.0, 0.0, 0.0, 1.0);

#[test]
fn retargeted_clips_have_no_properties_and_crossfades_switch_halfway() {
    let mut library = library_of(red_walker());
    let asset = library.active().expect("a model").asset.clone();
    let map = JointMap { crossfade_secs: 0.4, ..propose(&asset, &asset).to_map(&asset, &asset) };
    library.set_motions(vec![Motion::new("red.glb".to_owned(), asset.clone())]);
    library.borrow_each(vec![Some(map)]);
    let model = library.active().expect("a model");
    let borrowed = asset.clips.len();
    let clip = model.clip_at(borrowed).clip();
    assert_eq!((clip.properties().len(), clip.channels().is_empty()), (0, false));
    let is_red = |from: usize, to: usize, elapsed_secs| {
        let clip = |index: usize| ClipChoice::Clip(model.id_at(index));
        let fade = Some(Fade { clip: clip(from), time_secs: 0.0, elapsed_secs });
        let playhead = Playhead { clip: clip(to), fade, ..Playhead::default() };
        sampled(
            model,
            &ViewerState {
                character: CharacterView { playhead, ..CharacterView::default() },
                ..ViewerState::default()
            },
        )
        .properties
        .get(BASE_COLOR)
            == Some(RED)
    };
    for (elapsed_secs, is_old) in [(0.0, true), (0.19, true), (0.21, false), (0.4, false)] {
        assert_eq!(is_red(0, borrowed, elapsed_secs), is_old, "{elapsed_secs}");
        assert_eq!(is_red(borrowed, 0, elapsed_secs), !is_old, "{elapsed_secs}");
    }
}

#[test]
fn animated_properties_do_not_allocate() {
    let library = library(all_animated("LINEAR"));
    assert_eq!(allocations_while_playing(&library, ViewerState::default(), 130, 300), 0);
}
