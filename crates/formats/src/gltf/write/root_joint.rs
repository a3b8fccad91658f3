//! Inserts a node above one of a file's nodes, for engines that move a character by its root bone.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::Asset;
use glam::Mat4;
use serde_json::json;

use super::{WriteError, glb};
use crate::gltf::container;
use crate::gltf::document::{as_text, json_error};
use crate::gltf::object::{Array, Object, raw};

/// Returns a GLB with a new node, without a transform, between `joint` and its parent. It is the last of the nodes, and belongs to all
/// skins that the joint belongs to. `asset` was loaded from `bytes`.
pub fn insert_root(
    file: &str,
    bytes: &[u8],
    asset: &Asset,
    joint: JointIndex,
    name: &str,
) -> Result<Vec<u8>, WriteError> {
    let container = container::open(file, bytes)?;
    let text = as_text(container.json);
    let mut json: Object =
        serde_json::from_str(&text).map_err(|problem| json_error(file, &text, container.is_glb, &problem))?;
    let below = asset.skeleton.source_index(joint);
    let mut nodes: Vec<Object> = json.read("nodes").unwrap_or_default();
    let root = nodes.len();
    nodes.iter_mut().for_each(|node| replace(node, "children", below, root));
    let mut node = Object::default();
    node.set("name", &name);
    node.set("children", &[below]);
    nodes.push(node);
    json.set("nodes", &nodes);
    let mut scenes: Vec<Object> = json.read("scenes").unwrap_or_default();
    scenes.iter_mut().for_each(|scene| replace(scene, "nodes", below, root));
    if !scenes.is_empty() {
        json.set("scenes", &scenes);
    }
    let mut binary = container.binary.unwrap_or_default().to_vec();
    add_to_skins(&mut json, asset, joint, root, &mut binary);
    if json.count("buffers") == 1 {
        let mut buffers: Vec<Object> = json.read("buffers").unwrap_or_default();
        buffers.iter_mut().for_each(|buffer| buffer.set("byteLength", &binary.len()));
        json.set("buffers", &buffers);
    }
    glb::glb(serde_json::to_vec(&json).unwrap_or_default(), binary)
}

/// Replaces an index in a list.
fn replace(object: &mut Object, key: &str, old: usize, new: usize) {
    let Some(mut list) = object.read::<Vec<usize>>(key).filter(|list| list.contains(&old)) else { return };
    list.iter_mut().filter(|index| **index == old).for_each(|index| *index = new);
    object.set(key, &list);
}

/// Adds the root to the skins of the joint below it, as their last joint. Nothing is weighted to it.
fn add_to_skins(json: &mut Object, asset: &Asset, joint: JointIndex, root: usize, binary: &mut Vec<u8>) {
    let mut skins: Vec<Object> = json.read("skins").unwrap_or_default();
    if skins.len() != asset.skins.len() || json.count("buffers") > 1 {
        return;
    }
    let (mut views, mut accessors) = (Array::new(), Array::new());
    let (first_view, first_accessor) = (json.count("bufferViews"), json.count("accessors"));
    for (written, skin) in skins.iter_mut().zip(&asset.skins) {
        let mut joints: Vec<usize> = written.read("joints").unwrap_or_default();
        let Some(place) = skin.joints().iter().position(|&other| other == joint) else { continue };
        if joints.len() != skin.joints().len() {
            continue;
        }
        joints.push(root);
        written.set("joints", &joints);
        // The root has no transform of its own, so its space is the one that the joint's rest is relative to.
        let root_from_bind = asset.skeleton.rest().local(joint).to_affine() * skin.joint_from_bind()[place];
        let matrices = skin.joint_from_bind().iter().chain([&root_from_bind]);
        let numbers: Vec<f32> = matrices.flat_map(|matrix| Mat4::from(*matrix).to_cols_array()).collect();
        glb::pad(binary, 0);
        let view = json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": 4 * numbers.len() });
        binary.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        written.set("inverseBindMatrices", &(first_accessor + accessors.len()));
        let view_index = first_view + views.len();
        accessors.push(raw(
            &json!({ "bufferView": view_index, "componentType": 5126, "count": joints.len(), "type": "MAT4" }),
        ));
        views.push(raw(&view));
    }
    if !views.is_empty() {
        json.extend("bufferViews", views);
        json.extend("accessors", accessors);
        json.set("skins", &skins);
        if json.count("buffers") == 0 {
            json.set("buffers", &[json!({ "byteLength": binary.len() })]);
        }
    }
}
