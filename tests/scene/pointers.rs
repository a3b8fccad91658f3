//! KHR_animation_pointer and KHR_node_visibility, from files to frames.

use std::collections::BTreeMap;
use std::sync::Arc;

use gaitway::anim::{ClipBuilder, Interpolation, JointIndex, MaterialProperty, PropertyTarget, TextureSlot};
use gaitway::asset::{Asset, CameraProjection, LightKind};
use gaitway::frame::{Frame, evaluate, pick_vertex, pose_document};
use gaitway::library::{Library, Model, Motion, inspect};
use gaitway::mesh::{DeformedVertices, Lobes, Material};
use gaitway::retarget::{JointMap, propose};
use gaitway::samples;
use gaitway::state::{
    CameraChoice, ClipChoice, Command, Fade, Playhead, PoseSampler, ViewerState, apply, resolved_bounds,
};
use glam::{DQuat, Vec2, Vec3, Vec4};
use serde_json::{Value, json};

use crate::allocations::allocations_after;
use crate::build_gltf::{Build, F32, U8};
use crate::data::{library_of, open};
use crate::data_folder::data_folder;

/// The keys of a channel as the file has them.
struct Curve {
    interpolation: String,
    times_secs: Vec<f64>,
    /// One per key, or three.
    entries: Vec<Vec<f64>>,
}

impl Curve {
    /// glTF 2.0 appendix C. Rotations take the shorter arc.
    fn at(&self, time_secs: f64, is_rotation: bool) -> Vec<f64> {
        let times = &self.times_secs;
        let key = times.iter().rposition(|&start| start <= time_secs).unwrap_or(0);
        let next = if time_secs > times[key] { (key + 1).min(times.len() - 1) } else { key };
        let length = times[next] - times[key];
        let u = if length > 0.0 { (time_secs - times[key]) / length } else { 0.0 };
        let mix = |parts: &[(f64, usize)]| -> Vec<f64> {
            let width = self.entries[0].len();
            (0..width).map(|at| parts.iter().map(|&(share, entry)| share * self.entries[entry][at]).sum()).collect()
        };
        let value = match &*self.interpolation {
            "STEP" => mix(&[(1.0, key)]),
            "LINEAR" if is_rotation => {
                let [from, to] = [key, next].map(|key| DQuat::from_slice(&self.entries[key]).normalize());
                from.slerp(to, u).to_array().to_vec()
            }
            "LINEAR" => mix(&[(1.0 - u, key), (u, next)]),
            _ => mix(&[
                (2.0 * u * u * u - 3.0 * u * u + 1.0, 3 * key + 1),
                (length * (u * u * u - 2.0 * u * u + u), 3 * key + 2),
                (3.0 * u * u - 2.0 * u * u * u, 3 * next + 1),
                (length * (u * u * u - u * u), 3 * next),
            ]),
        };
        match is_rotation {
            true => DQuat::from_slice(&value).normalize().to_array().to_vec(),
            false => value,
        }
    }
}

fn number(value: &Value) -> usize {
    value.as_u64().unwrap_or(0) as usize
}

/// The elements of an accessor.
fn elements(json: &Value, buffers: &[Vec<u8>], accessor: usize) -> Vec<Vec<f64>> {
    let accessor = &json["accessors"][accessor];
    let view = &json["bufferViews"][number(&accessor["bufferView"])];
    let start = number(&view["byteOffset"]) + number(&accessor["byteOffset"]);
    let width = match accessor["type"].as_str() {
        Some("SCALAR") => 1,
        Some(vector) => vector.trim_start_matches("VEC").parse().expect("a vector"),
        None => panic!("no type"),
    };
    let bytes = &buffers[number(&view["buffer"])][start..];
    let size = if accessor["componentType"] == F32 { 4 } else { 1 };
    let stride = view["byteStride"].as_u64().map_or(size * width, |stride| stride as usize);
    let at = |offset: usize| match number(&accessor["componentType"]) as u32 {
        F32 => f64::from(f32::from_le_bytes(bytes[offset..offset + 4].try_into().expect("four bytes"))),
        U8 => f64::from(bytes[offset]),
        other => panic!("component type {other}"),
    };
    (0..number(&accessor["count"]))
        .map(|element| (0..width).map(|part| at(element * stride + part * size)).collect())
        .collect()
}

/// The curves of the first animation, by pointer. Of several for one pointer, the last.
fn curves(json: &Value, buffers: &[Vec<u8>]) -> BTreeMap<String, Curve> {
    let animation = &json["animations"][0];
    let mut curves = BTreeMap::new();
    for channel in animation["channels"].as_array().expect("channels") {
        let pointer = channel["target"]["extensions"]["KHR_animation_pointer"]["pointer"].as_str().expect("a pointer");
        let sampler = &animation["samplers"][number(&channel["sampler"])];
        let times_secs = elements(json, buffers, number(&sampler["input"])).concat();
        let mut entries = elements(json, buffers, number(&sampler["output"]));
        // All weights of a mesh are one value.
        if pointer.ends_with("/weights") {
            let per_key = if sampler["interpolation"] == "CUBICSPLINE" { 3 } else { 1 };
            let width = entries.len() / times_secs.len() / per_key;
            entries = entries.concat().chunks(width).map(<[f64]>::to_vec).collect();
        }
        let interpolation = sampler["interpolation"].as_str().unwrap_or("LINEAR").to_owned();
        curves.insert(pointer.to_owned(), Curve { interpolation, times_secs, entries });
    }
    curves
}

/// What a frame shows of the property; `None` if it is none that is shown.
fn shown(asset: &Asset, json: &Value, frame: &Frame, pointer: &str) -> Option<Vec<f32>> {
    let parts: Vec<&str> = pointer.split('/').skip(1).collect();
    let index: usize = parts.iter().find_map(|part| part.parse().ok())?;
    let joint = || asset.skeleton.joint_of_source(index).expect("a node");
    let weights = |joint: JointIndex| frame.pose().morph_weights[asset.skeleton.morph_range(joint)].to_vec();
    let of_mesh = || {
        let nodes = json["nodes"].as_array().expect("nodes").iter().enumerate();
        let nodes = nodes.filter(|(_, node)| node["mesh"] == json!(index) && node.get("weights").is_none());
        let joints = nodes.map(|(node, _)| asset.skeleton.joint_of_source(node).expect("a node"));
        let all: Vec<Vec<f32>> = joints.map(weights).collect();
        assert!(!all.is_empty() && all.iter().all(|other| *other == all[0]), "{pointer}: {all:?}");
        all[0].clone()
    };
    Some(match parts[..] {
        ["nodes", _, "translation"] => frame.pose().local(joint()).translation.to_array().to_vec(),
        ["nodes", _, "rotation"] => frame.pose().local(joint()).rotation.to_array().to_vec(),
        ["nodes", _, "scale"] => frame.pose().local(joint()).scale.to_array().to_vec(),
        ["nodes", _, "weights"] => weights(joint()),
        ["nodes", _, "weights", target] => vec![weights(joint())[target.parse::<usize>().expect("an index")]],
        ["meshes", _, "weights"] => of_mesh(),
        ["meshes", _, "weights", target] => vec![of_mesh()[target.parse::<usize>().expect("an index")]],
        ["nodes", _, "extensions", "KHR_node_visibility", "visible"] => {
            vec![f32::from(u8::from(frame.is_visible(joint())))]
        }
        ["cameras", _, kind, property] => vec![of_camera(asset, frame, index, kind, property)?],
        ["extensions", "KHR_lights_punctual", "lights", _, ref property @ ..] => {
            of_light(asset, frame, index, &property.join("/"))
        }
        ["materials", _, ref property @ ..] => {
            let animated = &frame.characters[0].materials;
            let material = &animated.iter().find(|(number, _)| *number == index)?.1;
            of_material(material, &property.join("/"))?
        }
        _ => return None,
    })
}

fn of_camera(asset: &Asset, frame: &Frame, number: usize, kind: &str, property: &str) -> Option<f32> {
    let camera = asset.cameras.iter().find(|camera| camera.number == number).expect("a camera");
    match (camera.animated(frame.properties()), kind, property) {
        (CameraProjection::Perspective { y_fov_radians, .. }, "perspective", "yfov") => Some(y_fov_radians),
        (CameraProjection::Perspective { near, .. }, "perspective", "znear") => Some(near),
        (CameraProjection::Perspective { far, .. }, "perspective", "zfar") => far,
        (CameraProjection::Orthographic { y_mag, .. }, "orthographic", "ymag") => Some(y_mag),
        (CameraProjection::Orthographic { near, .. }, "orthographic", "znear") => Some(near),
        (CameraProjection::Orthographic { far, .. }, "orthographic", "zfar") => Some(far),
        _ => None,
    }
}

fn of_light(asset: &Asset, frame: &Frame, number: usize, property: &str) -> Vec<f32> {
    let place = asset.lights.iter().position(|light| light.number == number).expect("a light");
    let light = asset.lights[place].animated(frame.properties());
    let drawn = frame.lights[place];
    assert_eq!((drawn.color, drawn.kind), (light.color * light.intensity, light.kind));
    assert_eq!(drawn.range, light.range.unwrap_or(0.0));
    match (property, light.kind) {
        ("color", _) => light.color.to_array().to_vec(),
        ("intensity", _) => vec![light.intensity],
        ("range", _) => vec![light.range.expect("animated")],
        ("spot/innerConeAngle", LightKind::Spot { inner_cone_radians, .. }) => vec![inner_cone_radians],
        ("spot/outerConeAngle", LightKind::Spot { outer_cone_radians, .. }) => vec![outer_cone_radians],
        _ => panic!("{property} of {light:?}"),
    }
}

fn of_material(material: &Material, property: &str) -> Option<Vec<f32>> {
    if let Some((texture, property)) = property.split_once("/extensions/KHR_texture_transform/") {
        let texture = match texture {
            "pbrMetallicRoughness/baseColorTexture" => material.base_color_texture,
            "pbrMetallicRoughness/metallicRoughnessTexture" => material.metallic_roughness_texture,
            "normalTexture" => material.normal_texture,
            "occlusionTexture" => material.occlusion_texture,
            "emissiveTexture" => material.emissive_texture,
            "extensions/KHR_materials_clearcoat/clearcoatNormalTexture" => {
                material.texture(TextureSlot::ClearcoatNormal)
            }
            _ => None,
        };
        let transform = texture?.uv_transform;
        return match property {
            "offset" => Some(transform.offset.to_array().to_vec()),
            "rotation" => Some(vec![transform.rotation_radians]),
            "scale" => Some(transform.scale.to_array().to_vec()),
            _ => None,
        };
    }
    if let Some(property) = property.strip_prefix("extensions/").filter(|property| !property.contains("emissive")) {
        return of_lobes(material.lobes.as_deref()?, property);
    }
    Some(match property {
        "pbrMetallicRoughness/baseColorFactor" => material.base_color.to_array().to_vec(),
        "pbrMetallicRoughness/metallicFactor" => vec![material.metallic],
        "pbrMetallicRoughness/roughnessFactor" => vec![material.roughness],
        "emissiveFactor" => material.emissive.to_array().to_vec(),
        "extensions/KHR_materials_emissive_strength/emissiveStrength" => vec![material.emissive_strength],
        "alphaCutoff" => match material.alpha_mode {
            gaitway::mesh::AlphaMode::Mask { cutoff } => vec![cutoff],
            other => panic!("{other:?}"),
        },
        "normalTexture/scale" => vec![material.normal_scale],
        "occlusionTexture/strength" => vec![material.occlusion_strength],
        _ => return None,
    })
}

fn of_lobes(lobes: &Lobes, property: &str) -> Option<Vec<f32>> {
    Some(match property {
        "KHR_materials_ior/ior" => vec![lobes.ior],
        "KHR_materials_specular/specularFactor" => vec![lobes.specular],
        "KHR_materials_specular/specularColorFactor" => lobes.specular_color.to_array().to_vec(),
        "KHR_materials_clearcoat/clearcoatFactor" => vec![lobes.clearcoat],
        "KHR_materials_clearcoat/clearcoatRoughnessFactor" => vec![lobes.clearcoat_roughness],
        "KHR_materials_clearcoat/clearcoatNormalTexture/scale" => vec![lobes.clearcoat_normal_scale],
        "KHR_materials_sheen/sheenColorFactor" => lobes.sheen_color.to_array().to_vec(),
        "KHR_materials_sheen/sheenRoughnessFactor" => vec![lobes.sheen_roughness],
        "KHR_materials_iridescence/iridescenceFactor" => vec![lobes.iridescence],
        "KHR_materials_iridescence/iridescenceIor" => vec![lobes.iridescence_ior],
        "KHR_materials_iridescence/iridescenceThicknessMinimum" => vec![lobes.iridescence_thickness_min],
        "KHR_materials_iridescence/iridescenceThicknessMaximum" => vec![lobes.iridescence_thickness_max],
        "KHR_materials_anisotropy/anisotropyStrength" => vec![lobes.anisotropy],
        "KHR_materials_anisotropy/anisotropyRotation" => vec![lobes.anisotropy_rotation],
        "KHR_materials_transmission/transmissionFactor" => vec![lobes.transmission],
        "KHR_materials_volume/thicknessFactor" => vec![lobes.thickness],
        "KHR_materials_volume/attenuationDistance" => vec![lobes.attenuation_distance],
        "KHR_materials_volume/attenuationColor" => lobes.attenuation_color.to_array().to_vec(),
        "KHR_materials_dispersion/dispersion" => vec![lobes.dispersion],
        "KHR_materials_diffuse_transmission/diffuseTransmissionFactor" => vec![lobes.diffuse_transmission],
        "KHR_materials_diffuse_transmission/diffuseTransmissionColorFactor" => {
            lobes.diffuse_transmission_color.to_array().to_vec()
        }
        _ => return None,
    })
}

/// Compares all pointers of a file with its keys at these times, and returns those that aren't shown.
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

/// The first clip at this time.
fn at(time_secs: f32) -> ViewerState {
    let playhead = Playhead { time_secs: f64::from(time_secs), ..Playhead::default() };
    ViewerState { playhead, ..ViewerState::default() }
}

/// One of everything that can be animated: meshes with two morph targets on nodes 0, 5, 6 and 7, a spot light on node 1, cameras on
/// nodes 2 and 3; node 5 is below node 4.
fn complete() -> Build {
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

fn library(build: Build) -> Library {
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

/// [`complete`] with every one of [`POINTERS`] animated, over two seconds, with keys of their own.
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
        assert_eq!(asset.warnings.iter().map(ToString::to_string).collect::<Vec<_>>(), [""; 0]);
        let not_shown = check(&library, &json, &buffers, &[0.0, 0.17, 0.31, 0.8, 1.25, 1.9, 1.999]);
        assert_eq!(not_shown, [""; 0], "{interpolation}");
        // Scripts get the pointers back.
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

/// A camera of the file sees through the lens that the clip animates.
#[test]
fn a_camera_of_the_file_zooms() {
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

/// [`complete`] with node 4 hidden, which node 5 is below.
fn with_hidden_node() -> Build {
    complete().with("/nodes/4/extensions", json!({ "KHR_node_visibility": { "visible": false } }))
}

#[test]
fn a_hidden_node_hides_what_is_below_it() {
    let [shown, hidden] = [complete(), with_hidden_node()].map(library);
    let state = ViewerState::default();
    let visible = |library: &Library| {
        let mut frame = Frame::default();
        evaluate(library, &state, 1.0, &mut frame);
        frame.characters[0].draws.iter().map(|draw| draw.visible).collect::<Vec<_>>()
    };
    assert_eq!(visible(&shown), [true; 4]);
    assert_eq!(visible(&hidden), [true, false, true, true]);
    // A node below that says it is visible is hidden all the same.
    let also = json!({ "KHR_node_visibility": { "visible": true } });
    let insisting = library(with_hidden_node().with("/nodes/5/extensions", also));
    assert_eq!(visible(&insisting), [true, false, true, true]);
    // Bounds, and with them the framing.
    let rest = |library: &Library| library.active().expect("a model").rest_bounds().max.x;
    assert_eq!((rest(&shown), rest(&hidden)), (6.0, 2.0));
    let framed = |library: &Library| resolved_bounds(library, &state).max.x;
    assert_eq!((framed(&shown), framed(&hidden)), (6.0, 2.0));
    // The numbers stay: nodes move and meshes deform whether or not they are shown.
    let [shown, hidden] = [&shown, &hidden].map(|library| pose_document(library, &state));
    assert_eq!((&shown["nodes"], &shown["meshes"]), (&hidden["nodes"], &hidden["meshes"]));
}

#[test]
fn hidden_meshes_cannot_be_picked() {
    for (build, found) in [(complete(), Some(1)), (with_hidden_node(), None)] {
        let library = library(build);
        let model = library.active().expect("a model");
        let mut frame = Frame::default();
        evaluate(&library, &ViewerState::default(), 1.0, &mut frame);
        let projection_from_world = frame.view.projection_from_view * frame.view.view_from_world;
        let on_screen = projection_from_world.project_point3(Vec3::new(5.2, 0.2, 0.0));
        let point = Vec2::new(on_screen.x, on_screen.y);
        let picked = pick_vertex(model, &frame, &frame.characters[0], point, &mut DeformedVertices::default());
        assert_eq!(picked.map(|choice| choice.instance), found);
    }
}

/// The FBX reader hides the coarser levels of detail of an object, and what its file hides.
#[test]
fn hidden_objects_of_fbx_files_are_not_shown() {
    let frame_of = |path| {
        let library = open(path)?;
        let mut frame = Frame::default();
        evaluate(&library, &ViewerState::default(), 1.0, &mut frame);
        let asset = &library.active().expect("a model").asset;
        let visible = frame.characters[0].draws.iter().filter(|draw| draw.visible);
        let joints = visible.map(|draw| asset.instances[draw.instance].joint);
        let names: Vec<String> = joints.map(|joint| asset.skeleton.name(joint).to_owned()).collect();
        Some((names, frame))
    };
    let Some((names, frame)) = frame_of("fbx/ufbx/maya_lod_group_7500_binary.fbx") else { return };
    assert_eq!(names, ["pPlatonic1", "pSphere1"]);
    assert_eq!((frame.characters[0].draws.len(), frame.bones.iter().any(|bone| bone.visible)), (6, false));
    // Its only mesh is hidden: the skeleton is all there is to see, and is framed.
    let Some((names, frame)) = frame_of("fbx/ufbx/max7_skin_5000_binary.fbx") else { return };
    assert_eq!((names, frame.bones.iter().any(|bone| bone.visible)), (vec![], true));
    assert!(frame.bounds.diagonal() > 0.0 && frame.bones.len() > 2);
}

#[test]
fn what_is_not_a_boolean_leaves_the_node_visible() {
    let build = complete().with("/nodes/4/extensions", json!({ "KHR_node_visibility": { "visible": 0 } }));
    let asset = build.load().expect("readable");
    assert_eq!(asset.hidden, []);
    let warnings: Vec<String> = asset.warnings.iter().map(ToString::to_string).collect();
    assert!(warnings.len() == 1 && warnings[0].contains("nodes[4].extensions.KHR_node_visibility"), "{warnings:?}");
}

#[test]
fn visibility_is_animated_in_steps() {
    let mut build = with_hidden_node();
    let keys = [0.0, 1.0, 1.5, 2.0];
    build.point("/nodes/4/extensions/KHR_node_visibility/visible", "STEP", "SCALAR", &keys, &[0.0, 1.0, 0.0, 1.0]);
    let library = library(build);
    let mut frame = Frame::default();
    for (time_secs, is_shown) in [(0.0, false), (0.99, false), (1.0, true), (1.49, true), (1.5, false), (1.9, false)] {
        evaluate(&library, &at(time_secs), 1.0, &mut frame);
        assert_eq!(frame.characters[0].draws[1].visible, is_shown, "{time_secs}");
    }
    assert_eq!(resolved_bounds(&library, &at(0.0)).max.x, 6.0, "the framing leaves room for it");
    // The rest pose is as the file says.
    let playhead = Playhead { clip: ClipChoice::RestPose, ..Playhead::default() };
    evaluate(&library, &ViewerState { playhead, ..ViewerState::default() }, 1.0, &mut frame);
    assert!(!frame.characters[0].draws[1].visible);
}

/// The studio's key light replaces missing lights only.
#[test]
fn a_light_that_the_clip_hides_is_dark_and_one_that_the_file_hides_is_not_there() {
    let visibility = "/nodes/1/extensions/KHR_node_visibility";
    let mut build = complete();
    build.point(&format!("{visibility}/visible"), "STEP", "SCALAR", &[0.0, 1.0], &[1.0, 0.0]);
    let library_of_clip = library(build);
    let colors = |library: &Library, time_secs| {
        let mut frame = Frame::default();
        evaluate(library, &at(time_secs), 1.0, &mut frame);
        frame.lights.iter().map(|light| light.color).collect::<Vec<_>>()
    };
    assert_eq!(colors(&library_of_clip, 0.5), [Vec3::ONE]);
    assert_eq!(colors(&library_of_clip, 1.0), [Vec3::ZERO]);
    let hidden = complete().with(visibility, json!({ "visible": false }));
    assert_eq!(colors(&library(hidden), 0.0), []);
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
fn retargeted_clips_have_none_and_crossfades_switch_halfway() {
    let mut library = library_of(red_walker());
    let asset = library.active().expect("a model").asset.clone();
    let map = JointMap { crossfade_secs: 0.4, ..propose(&asset, &asset).to_map(&asset, &asset) };
    library.set_motions(vec![Motion::new("red.glb".to_owned(), asset.clone())]);
    library.borrow_each(vec![Some(map)]);
    let model = library.active().expect("a model");
    let borrowed = asset.clips.len();
    assert_eq!(model.clip(borrowed).map(|clip| clip.properties().len()), Some(0));
    assert_eq!(model.clip(borrowed).map(|clip| clip.channels().is_empty()), Some(false));
    let is_red = |from: usize, to: usize, elapsed_secs| {
        let clip = |index: usize| ClipChoice::Named(index.to_string());
        let fade = Some(Fade { clip: clip(from), time_secs: 0.0, elapsed_secs });
        let playhead = Playhead { clip: clip(to), fade, ..Playhead::default() };
        let mut sampler = PoseSampler::default();
        sampler.sample(model, &ViewerState { playhead, ..ViewerState::default() });
        sampler.properties.get(BASE_COLOR) == Some(RED)
    };
    for (elapsed_secs, is_old) in [(0.0, true), (0.19, true), (0.21, false), (0.4, false)] {
        assert_eq!(is_red(0, borrowed, elapsed_secs), is_old, "{elapsed_secs}");
        assert_eq!(is_red(borrowed, 0, elapsed_secs), !is_old, "{elapsed_secs}");
    }
}

#[test]
fn animated_properties_do_not_allocate() {
    let library = library(all_animated("LINEAR"));
    let (mut state, mut frame) = (ViewerState::default(), Frame::default());
    let mut play = |frames: usize| {
        for _ in 0..frames {
            apply(&mut state, &library, Command::Advance(1.0 / 60.0));
            evaluate(&library, &state, 1.5, &mut frame);
        }
    };
    assert_eq!(allocations_after(&mut play, |play| play(130), |play| play(300)), 0);
}
