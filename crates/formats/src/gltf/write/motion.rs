//! Writes a skeleton with clips and nothing else, which other programs read as an animation file.

use gaitway_character::anim::{Clip, JointIndex, Skeleton};
use gaitway_character::asset::Asset;
use gaitway_character::sort::sort_by;
use serde_json::{Value, json};

use super::{WriteError, clip, glb};

/// Writes a GLB with `skeleton`'s joints (those of the asset, perhaps renamed) as nodes, numbered as in the source file, the
/// asset's scenes, and `clips` of this skeleton. Meshes are left out, and with them channels of morph weights.
pub fn motion(asset: &Asset, skeleton: &Skeleton, clips: &[&Clip]) -> Result<Vec<u8>, WriteError> {
    let mut root = nodes_and_scenes(asset, skeleton);
    let mut binary = Vec::new();
    let added = clip::add(clips, clips.len(), skeleton, false, clip::Counts::default(), &mut binary)?;
    if !added.animations.is_empty() {
        root["animations"] = json!(added.animations);
        root["accessors"] = json!(added.accessors);
        root["bufferViews"] = json!(added.buffer_views);
        root["buffers"] = json!([{ "byteLength": binary.len() }]);
    }
    glb::glb(root.to_string().into_bytes(), binary)
}

/// Returns the beginning of a file's JSON: the joints of `skeleton` (those of the asset, perhaps with other names and another
/// rest pose) in the asset's scenes.
pub(super) fn nodes_and_scenes(asset: &Asset, skeleton: &Skeleton) -> Value {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); skeleton.len()];
    let joints = || (0..skeleton.len()).filter_map(|source| skeleton.joint_of_source(source));
    for joint in joints() {
        if let Some(parent) = skeleton.parent(joint) {
            children[parent.get()].push(skeleton.source_index(joint));
        }
    }
    let nodes: Vec<Value> = joints().map(|joint| node(skeleton, joint, &children[joint.get()])).collect();
    let mut root =
        json!({ "asset": { "version": "2.0", "generator": concat!("Gaitway ", env!("CARGO_PKG_VERSION")) } });
    let source = |joints: &mut dyn Iterator<Item = JointIndex>| -> Vec<usize> {
        let mut sources: Vec<usize> = joints.map(|joint| skeleton.source_index(joint)).collect();
        sort_by(&mut sources, Ord::cmp);
        sources
    };
    if !nodes.is_empty() {
        let mut scenes: Vec<Value> = Vec::new();
        for scene in &asset.scenes {
            let mut value = json!({});
            if !scene.name.is_empty() {
                value["name"] = json!(scene.name);
            }
            if !scene.roots.is_empty() {
                value["nodes"] = json!(source(&mut scene.roots.iter().copied()));
            }
            scenes.push(value);
        }
        if scenes.is_empty() {
            let mut roots = skeleton.joints().filter(|&joint| skeleton.parent(joint).is_none());
            scenes.push(json!({ "nodes": source(&mut roots) }));
        }
        root["scene"] = json!(asset.default_scene.unwrap_or(0));
        root["scenes"] = json!(scenes);
        root["nodes"] = json!(nodes);
    }
    root
}

/// `children`: their numbers in the source file, in ascending order.
fn node(skeleton: &Skeleton, joint: JointIndex, children: &[usize]) -> Value {
    let mut node = json!({});
    if !skeleton.name(joint).is_empty() {
        node["name"] = json!(skeleton.name(joint));
    }
    let rest = skeleton.rest().local(joint);
    let mut set_unless = |key: &str, numbers: &[f32], default: f32, last: f32| {
        let (end, others) = numbers.split_last().unwrap_or((&last, &[]));
        if *end != last || others.iter().any(|number| *number != default) {
            node[key] = json!(numbers);
        }
    };
    set_unless("translation", &rest.translation.to_array(), 0.0, 0.0);
    set_unless("rotation", &rest.rotation.to_array(), 0.0, 1.0);
    set_unless("scale", &rest.scale.to_array(), 1.0, 1.0);
    if !children.is_empty() {
        node["children"] = json!(children);
    }
    node
}
