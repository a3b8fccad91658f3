//! From files in memory to an [`Asset`]. Knows no disk and no network: whoever has one asks [`missing_files`] what else a
//! file names, adds it to the [`FileSet`], and then calls [`load`].

mod error;
mod file_set;
mod gltf;

use std::sync::Arc;

pub use error::LoadError;
pub use file_set::FileSet;

use crate::asset::Asset;
use file_set::bare_name;

/// Relative URIs (percent-decoded) that the model in this set refers to and that are not in the set, not even by their
/// bare names. Empty when the set is complete or cannot be read at all ([`load`] will say why).
pub fn missing_files(files: &FileSet) -> Vec<String> {
    let Ok(files) = files.unpacked() else { return Vec::new() };
    match find_model(&files) {
        Ok((name, bytes)) => gltf::missing_files(&files, name, bytes),
        Err(_) => Vec::new(),
    }
}

/// Reads the one model in a set of files. A set with none, or with several, is an error that lists what was found.
pub fn load(files: &FileSet) -> Result<Asset, LoadError> {
    let files = files.unpacked()?;
    let (name, bytes) = find_model(&files)?;
    gltf::load(&files, name, bytes)
}

fn find_model(files: &FileSet) -> Result<(&str, &Arc<[u8]>), LoadError> {
    let mut models = files.iter().filter(|(name, bytes)| is_gltf(name, bytes));
    match (models.next(), models.next()) {
        (Some(model), None) => Ok(model),
        (Some(_), Some(_)) => Err(LoadError::SeveralModels {
            found: files.iter().filter(|(name, bytes)| is_gltf(name, bytes)).map(|(name, _)| name.to_owned()).collect(),
        }),
        (None, _) => Err(files
            .iter()
            .find_map(|(name, bytes)| {
                let format = foreign_format(name, bytes)?;
                Some(LoadError::UnsupportedFormat { file: name.to_owned(), format })
            })
            .unwrap_or_else(|| LoadError::NoModel { found: files.names().map(str::to_owned).collect() })),
    }
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
        "obj" => Some("OBJ"),
        "bvh" => Some("BVH"),
        _ => None,
    }
}

fn ending(name: &str) -> String {
    let bare = bare_name(name);
    let bare = bare.split(['?', '#']).next().unwrap_or(bare);
    bare.rsplit_once('.').map_or_else(String::new, |(_, ending)| ending.to_lowercase())
}
