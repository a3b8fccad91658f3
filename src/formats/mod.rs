//! Loads an [`Asset`] from files in memory. Knows neither disk nor network: callers ask [`missing_files`] what else a file
//! refers to, add it to the [`FileSet`], and then call [`load`].

mod bvh;
mod error;
mod file_set;
mod gltf;
mod lines;
mod obj;

use std::collections::BTreeSet;
use std::sync::Arc;

pub use error::LoadError;
pub use file_set::FileSet;
pub use gltf::WriteError;

use crate::anim::{Clip, Skeleton};
use crate::asset::{Asset, Image};
use file_set::bare_name;

/// Of .obj, .skel and .attach together. With more, which nobody can have open at once, nothing is looked for beside them: each
/// takes a walk through the set.
const MOST_OBJ_FILES: usize = 256;

/// Relative URIs (percent-decoded) that the models and motions in this set refer to and that are not in the set, not even
/// by their bare names; for an .obj also the .skel and .attach of the same stem, which need not exist.
pub fn missing_files(files: &FileSet) -> Vec<String> {
    let (mut missing, mut known) = (Vec::new(), BTreeSet::new());
    let mut add = |uris: Vec<String>| missing.extend(uris.into_iter().filter(|uri| known.insert(uri.clone())));
    for (name, bytes) in files.iter().filter(|(name, bytes)| is_gltf(name, bytes) && !is_bvh(name, bytes)) {
        add(gltf::missing_files(files, name, bytes));
    }
    let of_obj = || files.iter().filter(|(name, bytes)| is_obj(name, bytes) || obj::is_companion(name));
    if of_obj().count() <= MOST_OBJ_FILES {
        of_obj().for_each(|(name, bytes)| add(obj::missing_files(files, name, bytes)));
    }
    missing
}

/// What a file leaves open and a person may know better.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LoadOptions {
    /// Metres in one unit of a .bvh; none: guessed by the skeleton's size.
    pub bvh_unit_metres: Option<f32>,
    /// Whether Z points up in a .bvh (else Y); none: guessed by how the skeleton stands.
    pub bvh_z_up: Option<bool>,
}

/// Loads the only model of a set. Having none, or several, is an error that lists what was found.
pub fn load(files: &FileSet) -> Result<Asset, LoadError> {
    load_with(files, &LoadOptions::default())
}

pub fn load_with(files: &FileSet, options: &LoadOptions) -> Result<Asset, LoadError> {
    let (name, bytes) = find_model(files)?;
    read(files, name, bytes, options, &mut |_| ())
}

/// Returns the names of the set's models and motions, each of which can be loaded; [`load`] expects exactly one.
pub fn main_files(files: &FileSet) -> Vec<String> {
    files.iter().filter(|(name, bytes)| is_model(name, bytes)).map(|(name, _)| name.to_owned()).collect()
}

/// Reads one of the set's [`main_files`]; the others may hold its parts.
pub fn load_named(files: &FileSet, name: &str, options: &LoadOptions) -> Result<Asset, LoadError> {
    load_noticing_images(files, name, options, &mut |_| ())
}

/// As [`load_named`]; `on_images` gets the asset's images as soon as they are known, before the rest is read, for a platform
/// that decodes them meanwhile.
pub fn load_noticing_images(
    files: &FileSet,
    name: &str,
    options: &LoadOptions,
    on_images: &mut dyn FnMut(&[Image]),
) -> Result<Asset, LoadError> {
    match files.get(name) {
        Some(bytes) => read(files, name, bytes, options, on_images),
        None => Err(LoadError::NoModel { found: files.names().map(str::to_owned).collect() }),
    }
}

/// The set's model `name` (one of its [`main_files`]) as a GLB that needs no other file, with `clips` behind its own; they
/// are for `skeleton`, which was loaded from the same file. Of a glTF, what the file had before is kept to the letter: the
/// bytes of its first buffer are the beginning of the new one, and its JSON only grows. Of an .obj, joints are called and
/// stand as `skeleton` says.
pub fn write_model(files: &FileSet, name: &str, skeleton: &Skeleton, clips: &[&Clip]) -> Result<Vec<u8>, WriteError> {
    if let Some(bytes) = files.get(name).filter(|bytes| is_obj(name, bytes)) {
        return write_obj(files, name, bytes, skeleton, clips);
    }
    gltf::write_model(files, name, skeleton, clips)
}

fn write_obj(
    files: &FileSet,
    name: &str,
    bytes: &[u8],
    skeleton: &Skeleton,
    clips: &[&Clip],
) -> Result<Vec<u8>, WriteError> {
    let asset = obj::load(files, name, bytes, &mut |_| ())?;
    if asset.skeleton.parents() != skeleton.parents() {
        let (nodes, joints) = (asset.skeleton.len(), skeleton.len());
        return Err(WriteError::OtherSkeleton { file: name.to_owned(), nodes, joints });
    }
    gltf::write_asset(&asset, skeleton, clips)
}

/// The skeleton of an asset with `clips` (which are for it) and nothing else, as a GLB. Joints keep their numbers and are called
/// and stand as `skeleton` says, which is the asset's own but for that.
pub fn write_motion(asset: &Asset, skeleton: &Skeleton, clips: &[&Clip]) -> Result<Vec<u8>, WriteError> {
    gltf::write_motion(asset, skeleton, clips)
}

/// The one model or motion of a set as a GLB: a glTF with all that is in it, a .bvh as its skeleton and its clip, an .obj at
/// rest.
pub fn convert(files: &FileSet, options: &LoadOptions) -> Result<Vec<u8>, WriteError> {
    let (name, bytes) = find_model(files)?;
    let asset = read(files, name, bytes, options, &mut |_| ())?;
    if is_bvh(name, bytes) {
        return gltf::write_motion(&asset, &asset.skeleton, &asset.clips.iter().collect::<Vec<_>>());
    }
    if is_obj(name, bytes) {
        return gltf::write_asset(&asset, &asset.skeleton, &[]);
    }
    gltf::write_model(files, name, &asset.skeleton, &[])
}

fn read(
    files: &FileSet,
    name: &str,
    bytes: &[u8],
    options: &LoadOptions,
    on_images: &mut dyn FnMut(&[Image]),
) -> Result<Asset, LoadError> {
    if is_bvh(name, bytes) {
        bvh::load(name, bytes, options)
    } else if is_obj(name, bytes) {
        obj::load(files, name, bytes, on_images)
    } else {
        gltf::load(files, name, bytes, on_images)
    }
}

fn find_model(files: &FileSet) -> Result<(&str, &Arc<[u8]>), LoadError> {
    let mut models = files.iter().filter(|(name, bytes)| is_model(name, bytes));
    match (models.next(), models.next()) {
        (Some(model), None) => Ok(model),
        (Some(_), Some(_)) => Err(LoadError::SeveralModels { found: main_files(files) }),
        (None, _) => Err(files
            .iter()
            .find_map(|(name, bytes)| {
                if obj::is_companion(name) {
                    return Some(obj::without_obj(name));
                }
                let format = foreign_format(name, bytes)?;
                Some(LoadError::UnsupportedFormat { file: name.to_owned(), format })
            })
            .unwrap_or_else(|| LoadError::NoModel { found: files.names().map(str::to_owned).collect() })),
    }
}

fn is_model(name: &str, bytes: &[u8]) -> bool {
    is_bvh(name, bytes) || is_gltf(name, bytes) || is_obj(name, bytes)
}

/// By the name alone: nothing in the text tells it from others.
fn is_obj(name: &str, bytes: &[u8]) -> bool {
    obj::is_obj(name) && !is_bvh(name, bytes) && !is_gltf(name, bytes)
}

fn is_bvh(name: &str, bytes: &[u8]) -> bool {
    bvh::is_bvh(bytes) || (ending(name) == "bvh" && !bytes.starts_with(b"glTF"))
}

/// By content where it can be told (addresses often have no ending), else by the name's ending.
fn is_gltf(name: &str, bytes: &[u8]) -> bool {
    if bytes.starts_with(b"glTF") {
        return true;
    }
    let ending = ending(name);
    if matches!(ending.as_str(), "glb" | "gltf" | "vrm" | "vrma") {
        return true;
    }
    // An address without a telling name: JSON that speaks of an asset.
    ending != "json"
        && bytes.iter().find(|byte| !byte.is_ascii_whitespace()) == Some(&b'{')
        && bytes.windows(7).take(4096).any(|window| window == b"\"asset\"")
}

fn foreign_format(name: &str, bytes: &[u8]) -> Option<&'static str> {
    if bytes.starts_with(b"Kaydara FBX") {
        return Some("FBX");
    }
    if bytes.starts_with(b"xof ") {
        return Some("DirectX .x");
    }
    match ending(name).as_str() {
        "fbx" => Some("FBX"),
        "x" => Some("DirectX .x"),
        "dae" => Some("COLLADA"),
        "blend" => Some("Blender's own"),
        _ => None,
    }
}

fn ending(name: &str) -> String {
    let bare = bare_name(name);
    let bare = bare.split(['?', '#']).next().unwrap_or(bare);
    bare.rsplit_once('.').map_or_else(String::new, |(_, ending)| ending.to_lowercase())
}
