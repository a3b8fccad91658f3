//! Makes JSON fit the types of the `gltf` crate: removes or completes what they reject and the reader can do without.

use std::collections::BTreeMap;

use gaitway_json_text as json_text;
use gltf::json::extensions::scene::khr_lights_punctual::{KhrLightsPunctual, Light};
use gltf::json::{Animation, Camera, Image, Index, Material, Texture, animation, texture};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use super::strict;
use crate::limits::MAX_JSON_OBJECTS;

/// Placeholder for a missing index: the `target.node` of an animation channel that an extension aims elsewhere, or a
/// reference to an element that was left out. The crate uses the same for the missing `source` of a texture.
pub const NONE: u32 = u32::MAX;

/// Members that hold an index or a code. The crate silently truncates these to 32 bits.
const NARROW_MEMBERS: [&str; 23] = [
    "buffer",
    "bufferView",
    "camera",
    "children",
    "componentType",
    "index",
    "indices",
    "input",
    "inverseBindMatrices",
    "joints",
    "light",
    "material",
    "mesh",
    "mode",
    "node",
    "nodes",
    "output",
    "sampler",
    "scene",
    "skeleton",
    "skin",
    "source",
    "targets",
];

/// Extensions that the crate has types for. The contents of all others are left alone.
const TYPED_EXTENSIONS: [&str; 4] =
    ["KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_materials_unlit", "KHR_texture_transform"];

/// Removes or completes members that the crate's types reject and the reader can do without.
pub fn loosen(root: &mut Value) {
    clean(root, None);
    let asset = root.get_mut("asset").and_then(Value::as_object_mut);
    if let Some(asset) = asset {
        for key in ["version", "minVersion"] {
            if let Some(version) = asset.get_mut(key) {
                *version = Value::from(text(version));
            }
        }
        remove_unless(asset, "copyright", Value::is_string);
    }
    objects(root, "bufferViews").for_each(|view| remove_unless(view, "target", Value::is_u64));
    objects(root, "images").for_each(|image| remove_unless(image, "mimeType", Value::is_string));
    objects(root, "scenes").for_each(|scene| set_default(scene, "nodes", empty_list()));
    objects(root, "skins").for_each(|skin| set_default(skin, "joints", empty_list()));
    for camera in objects(root, "cameras") {
        // The reader tells cameras apart by their members.
        remove_unless(camera, "type", Value::is_string);
        set_default(camera, "type", Value::from("perspective"));
    }
    for mesh in objects(root, "meshes") {
        set_default(mesh, "primitives", empty_list());
        objects_of(mesh, "primitives").for_each(loosen_attributes);
    }
    for animation in objects(root, "animations") {
        set_default(animation, "channels", empty_list());
        set_default(animation, "samplers", empty_list());
        for sampler in objects_of(animation, "samplers") {
            // Becomes an unknown name, which the reader reports.
            if let Some(interpolation) = sampler.get_mut("interpolation") {
                *interpolation = Value::from(text(interpolation));
            }
        }
        let channels = objects_of(animation, "channels");
        for target in channels.filter_map(|channel| channel.get_mut("target")?.as_object_mut()) {
            set_default(target, "node", Value::from(NONE));
        }
    }
    if let Some(lights) = root.pointer_mut("/extensions/KHR_lights_punctual").and_then(Value::as_object_mut) {
        set_default(lights, "lights", empty_list());
    }
}

/// Applies the rules for all objects: removes null members, names that are not strings and extensions that are not objects.
/// Turns whole numbers such as 3.0 and 3e2 into integers (§2.7), and integers that the crate would truncate into floats, which
/// it rejects. `key`: the member that holds the value.
fn clean(value: &mut Value, key: Option<&str>) {
    match value {
        Value::Array(list) => list.iter_mut().for_each(|value| clean(value, key)),
        Value::Number(_) => {
            let is_narrow = key.is_some_and(|key| NARROW_MEMBERS.contains(&key));
            match whole(value) {
                Some(whole) if is_narrow && whole >= u64::from(u32::MAX) => *value = Value::from(whole as f64),
                Some(whole) => *value = Value::from(whole),
                None => {}
            }
        }
        Value::Object(members) => {
            members.retain(|_, value| !value.is_null());
            remove_unless(members, "name", Value::is_string);
            remove_unless(members, "extensions", Value::is_object);
            let indices_inside = key.filter(|&key| matches!(key, "attributes" | "targets")).map(|_| "index");
            for (key, value) in members {
                match key.as_str() {
                    "extras" => {}
                    "extensions" => clean_extensions(value),
                    key => clean(value, indices_inside.or(Some(key))),
                }
            }
        }
        _ => {}
    }
}

/// Returns a non-negative integer, even if it is written as 3.0 or 3e2 (§2.7). `None` if it is not exact.
pub fn whole(value: &Value) -> Option<u64> {
    const EXACT: f64 = (1_u64 << 53) as f64;
    let float = |value: f64| ((0.0..=EXACT).contains(&value) && value.fract() == 0.0).then_some(value as u64);
    value.as_u64().or_else(|| float(value.as_f64()?))
}

/// Replaces elements that the crate's types reject and a model can do without: empty ones take their place, so that
/// indices stay valid. Returns their places and why they were rejected.
pub fn leave_out(root: &mut Value) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let found = &mut found;
    replace::<Camera>(root.get_mut("cameras"), "cameras", &json!({ "type": "perspective" }), found);
    replace::<Texture>(root.get_mut("textures"), "textures", &json!({}), found);
    replace::<texture::Sampler>(root.get_mut("samplers"), "samplers", &json!({}), found);
    replace::<Image>(root.get_mut("images"), "images", &json!({}), found);
    replace::<Material>(root.get_mut("materials"), "materials", &json!({}), found);
    let lights = "extensions.KHR_lights_punctual.lights";
    replace::<Light>(root.pointer_mut("/extensions/KHR_lights_punctual/lights"), lights, &json!({ "type": "" }), found);
    for (index, animation) in elements(root.get_mut("animations")) {
        let samplers = format!("animations[{index}].samplers");
        replace::<animation::Sampler>(
            animation.get_mut("samplers"),
            &samplers,
            &json!({ "input": NONE, "output": NONE }),
            found,
        );
        let (channels, empty) = (
            format!("animations[{index}].channels"),
            json!({ "sampler": NONE, "target": { "node": NONE, "path": "" } }),
        );
        replace::<animation::Channel>(animation.get_mut("channels"), &channels, &empty, found);
    }
    let no_animation = json!({ "channels": [], "samplers": [] });
    replace::<Animation>(root.get_mut("animations"), "animations", &no_animation, found);
    for (index, node) in elements(root.get_mut("nodes")) {
        remove_unreadable::<Index<Camera>>(node, "camera", &format!("nodes[{index}].camera"), found);
        if let Some(extensions) = node.get_mut("extensions") {
            let place = format!("nodes[{index}].extensions.KHR_lights_punctual");
            remove_unreadable::<KhrLightsPunctual>(extensions, "KHR_lights_punctual", &place, found);
        }
    }
    std::mem::take(found)
}

fn elements(list: Option<&mut Value>) -> impl Iterator<Item = (usize, &mut Value)> {
    list.and_then(Value::as_array_mut).into_iter().flatten().enumerate()
}

/// Replaces elements of a list that are not a `T` with `empty`.
fn replace<T: for<'a> Deserialize<'a>>(
    list: Option<&mut Value>,
    name: &str,
    empty: &Value,
    found: &mut BTreeMap<String, String>,
) {
    for (index, element) in elements(list) {
        if let Some(problem) = why_not::<T>(element) {
            *element = empty.clone();
            found.insert(format!("{name}[{index}]"), problem);
        }
    }
}

fn remove_unreadable<T: for<'a> Deserialize<'a>>(
    object: &mut Value,
    key: &str,
    place: &str,
    found: &mut BTreeMap<String, String>,
) {
    if let Some(problem) = object.get(key).and_then(why_not::<T>) {
        object.as_object_mut().and_then(|object| object.shift_remove(key));
        found.insert(place.to_owned(), problem);
    }
}

/// Returns why a value is not a `T`.
fn why_not<T: for<'a> Deserialize<'a>>(value: &Value) -> Option<String> {
    match strict::from_str::<T>(&value.to_string(), MAX_JSON_OBJECTS) {
        Err(strict::Error::Json(problem)) => Some(json_text::message(&problem)),
        _ => None,
    }
}

fn clean_extensions(extensions: &mut Value) {
    let Some(extensions) = extensions.as_object_mut() else { return };
    for name in TYPED_EXTENSIONS {
        if let Some(extension) = extensions.get_mut(name) {
            clean(extension, None);
        }
    }
    // Its presence is all that matters.
    if let Some(unlit) = extensions.get_mut("KHR_materials_unlit").filter(|unlit| !unlit.is_object()) {
        *unlit = Value::Object(Map::new());
    }
}

/// Returns a copy without null members, and with whole numbers as integers.
pub fn cleaned(value: &Value) -> Value {
    let mut value = value.clone();
    clean(&mut value, None);
    value
}

/// Removes attributes that are never read and are not indices.
fn loosen_attributes(primitive: &mut Map<String, Value>) {
    set_default(primitive, "attributes", Value::Object(Map::new()));
    let is_read = |semantic: &str| {
        matches!(semantic, "POSITION" | "NORMAL" | "TANGENT" | "TEXCOORD_0" | "TEXCOORD_1" | "COLOR_0")
            || semantic.starts_with("JOINTS_")
            || semantic.starts_with("WEIGHTS_")
    };
    if let Some(attributes) = primitive.get_mut("attributes").and_then(Value::as_object_mut) {
        attributes.retain(|semantic, index| index.is_u64() || is_read(semantic));
    }
}

fn empty_list() -> Value {
    Value::Array(Vec::new())
}

/// The objects in the list `key`.
fn objects<'v>(value: &'v mut Value, key: &str) -> impl Iterator<Item = &'v mut Map<String, Value>> + use<'v> {
    value.get_mut(key).and_then(Value::as_array_mut).into_iter().flatten().filter_map(Value::as_object_mut)
}

fn objects_of<'v>(
    members: &'v mut Map<String, Value>,
    key: &str,
) -> impl Iterator<Item = &'v mut Map<String, Value>> + use<'v> {
    members.get_mut(key).and_then(Value::as_array_mut).into_iter().flatten().filter_map(Value::as_object_mut)
}

fn set_default(members: &mut Map<String, Value>, key: &str, value: Value) {
    members.entry(key).or_insert(value);
}

fn remove_unless(members: &mut Map<String, Value>, key: &str, is_kept: fn(&Value) -> bool) {
    if members.get(key).is_some_and(|value| !is_kept(value)) {
        // Keeps the order of the others.
        members.shift_remove(key);
    }
}

/// A string as it is, any other value as JSON.
pub fn text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}
