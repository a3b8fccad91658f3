//! Supported extensions, and what to tell the user about the others.

use gltf::json::Root;

use gaitway_character::asset::{Warning, Warnings};

use super::instancing;
use super::lobes;
use super::mtoon::MTOON;
use super::nodes::VISIBILITY;
use super::pointer::POINTER;
use super::variants;
use super::vrm::{EXTENDED_COLLIDER, NODE_CONSTRAINT, SPRING_BONE};
use crate::LoadError;

const SUPPORTED: &[&str] = &[
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "KHR_lights_punctual",
    lobes::SPECULAR_GLOSSINESS,
    variants::NAME,
    instancing::NAME,
    POINTER,
    VISIBILITY,
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_texture_basisu",
    // Decoded before the file is loaded. It still has them only if it could not be prepared or also has the original
    // data.
    "EXT_meshopt_compression",
    "KHR_draco_mesh_compression",
    "KHR_meshopt_compression",
    "VRM",
    "VRMC_vrm",
    MTOON,
    "VRMC_vrm_animation",
    NODE_CONSTRAINT,
    SPRING_BONE,
    EXTENDED_COLLIDER,
];

/// Rejects required extensions that are not supported, and warns about each optional one.
pub fn check(file: &str, root: &Root, warnings: &mut Warnings) -> Result<(), LoadError> {
    let unsupported =
        |name: &&String| !SUPPORTED.contains(&name.as_str()) && !lobes::EXTENSIONS.contains(&name.as_str());
    if let Some(name) = root.extensions_required.iter().find(unsupported) {
        return Err(LoadError::RequiredExtension {
            file: file.to_owned(),
            name: name.clone(),
            advice: "export the model without it",
        });
    }
    for name in root.extensions_used.iter().filter(unsupported) {
        warnings.push(Warning::UnsupportedExtension { name: name.clone() });
    }
    Ok(())
}
