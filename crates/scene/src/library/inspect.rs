//! The inspect document: the contents of a file, as reported by `gaitway inspect --json` and `window.gaitway.open`.

use gaitway_character::anim::{Clip, Interpolation};
use gaitway_character::asset::{Asset, Warning, Warnings};
use gaitway_character::avatar::Avatar;
use gaitway_character::mesh::{Bounds, Geometry, Mesh};
use gaitway_formats::pointer_to;
use serde_json::{Map, Value, json};

use super::Model;

/// `files` are the names of the files that were read. Counts refer to the file: a mesh on two nodes counts once.
pub fn inspect(model: &Model, files: &[String]) -> Value {
    let asset: &Asset = &model.asset;
    let primitives = || asset.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let skins: Vec<Value> =
        asset.skins.iter().map(|skin| json!({ "name": skin.name(), "joints": skin.joints().len() })).collect();
    let borrowed: Vec<Value> = model
        .clips()
        .iter()
        .enumerate()
        .filter(|(_, clip)| clip.borrowed().is_some() && !clip.is_copy())
        .map(|(index, clip)| clip_document(asset, index, clip.unchanged()))
        .collect();
    let clips: Vec<Value> =
        asset.clips.iter().enumerate().map(|(index, clip)| clip_document(asset, index, clip)).collect();
    json!({
        "files": files,
        "format": asset.format,
        "generator": asset.generator,
        "nodes": asset.skeleton.len(),
        "skins": skins,
        "joints": model.rig().joint_count(asset),
        "meshes": asset.meshes.len(),
        "primitives": primitives().count(),
        "parts": asset.meshes.iter().flat_map(|mesh| &mesh.part_names).collect::<Vec<_>>(),
        "vertices": asset.meshes.iter().map(Mesh::file_vertex_count).sum::<usize>(),
        "triangles": primitives().map(Geometry::triangles).sum::<usize>(),
        "morph_targets": asset.meshes.iter().map(target_count).sum::<usize>(),
        "clips": clips,
        "borrowed_clips": borrowed,
        "variants": asset.variants,
        "texture_bytes": model.texture_bytes(),
        "cameras": asset.cameras.len(),
        "avatar": avatar_document(asset),
        "extensions_used": asset.extensions_used,
        "extensions_required": asset.extensions_required,
        "bounds": bounds_document(model.rest_bounds()),
        "warnings": Value::Array(model.findings().iter().map(|finding| warning_document(&finding.warning)).collect()),
    })
}

/// Builds `[{"code","message","where"}]`.
pub fn warning_documents(warnings: &Warnings) -> Value {
    Value::Array(warnings.iter().map(warning_document).collect())
}

fn warning_document(warning: &Warning) -> Value {
    json!({ "code": warning.code(), "message": warning.to_string(), "where": warning.place() })
}

fn target_count(mesh: &Mesh) -> usize {
    mesh.primitives.iter().map(|geometry| geometry.morph_targets.len()).max().unwrap_or(0)
}

/// Describes the avatar of a VRM file; null for other files. `meta` has the file's own keys.
fn avatar_document(asset: &Asset) -> Value {
    let avatar = &asset.avatar;
    if *avatar == Avatar::default() {
        return Value::Null;
    }
    let meta: Map<String, Value> =
        avatar.meta.iter().map(|(key, value)| (key.clone(), Value::String(value.clone()))).collect();
    let expressions: Vec<&str> = avatar.expressions.iter().map(|expression| &*expression.name).collect();
    let node = |joint| asset.skeleton.source_index(joint);
    let first_person: Vec<Value> =
        avatar.first_person.iter().map(|(joint, flag)| json!({ "node": node(*joint), "flag": flag })).collect();
    json!({
        "spec_version": avatar.spec_version,
        "meta": meta,
        "expressions": expressions,
        "look_at": avatar.look_at.is_some(),
        "spring_joints": avatar.springs.joints().len(),
        "constraints": avatar.constraints.len(),
        "first_person": first_person,
    })
}

/// `properties` are JSON pointers to what the clip animates besides joints.
fn clip_document(asset: &Asset, index: usize, clip: &Clip) -> Value {
    let interpolations = || {
        let properties = clip.properties().iter().map(|channel| channel.interpolation);
        clip.channels().iter().map(|channel| channel.interpolation).chain(properties)
    };
    let count = |interpolation| interpolations().filter(|&other| other == interpolation).count();
    let properties: Vec<String> = clip.properties().iter().map(|channel| pointer_to(channel.target, asset)).collect();
    json!({
        "index": index,
        "name": clip.name(),
        "duration_secs": clip.duration_secs(),
        "channels": interpolations().count(),
        "interpolations": {
            "linear": count(Interpolation::Linear),
            "step": count(Interpolation::Step),
            "cubicspline": count(Interpolation::CubicSpline),
        },
        "properties": properties,
    })
}

/// Null for empty bounds.
fn bounds_document(bounds: Bounds) -> Value {
    if bounds.is_empty() { Value::Null } else { json!({ "min": bounds.min.to_array(), "max": bounds.max.to_array() }) }
}
