//! Converts an FBX file to glTF, in memory.
//!
//! ufbx (C) reads the file: ASCII and binary, versions 3000 to 7700. This crate writes what it finds as one GLB in
//! metres, right-handed with Y up: the hierarchy under its own names, meshes with skins and blend shapes, materials,
//! cameras, lights, and every take as a clip. It is a separate crate, since the page downloads it as a separate wasm
//! module, only for those who open an FBX file. README.md says how both are built and what isn't carried over.

#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![deny(unsafe_code)]

mod clip;
mod curves;
mod cut;
mod fit;
mod inherit;
mod libc;
mod material;
mod mesh;
mod node;
mod raw;
mod shape;
mod tolerance;
mod warnings;

use gaitway_glb::{Glb, Warnings};
use gaitway_part::{Answer, Output};

/// Maximum size of a file.
const MAX_FILE_BYTES: usize = 1 << 29;
/// Maximum number of nodes.
const MAX_NODES: usize = 1 << 16;

/// Converts the bytes of a whole `.fbx` file into those of a `.glb`. External textures are named by the last part of their path.
///
/// # Errors
///
/// Returns a message for the user (what was expected, what was found and what to do) if the file can't be read or exceeds a
/// limit.
pub fn convert(bytes: &[u8]) -> Answer {
    check_head(bytes)?;
    let scene = raw::load(bytes)?;
    if scene.nodes.count > MAX_NODES {
        return Err(format!(
            "the FBX file is too large: expected at most {MAX_NODES} objects, found {}. Export a part of the scene.",
            scene.nodes.count
        ));
    }
    if scene.nodes.count < 2 {
        return Err(
            "the FBX file has no objects: expected meshes, joints or a clip, found none. Export it again with \
            the objects selected."
                .to_owned(),
        );
    }
    let mut glb = Glb::new("FBX");
    let mut warnings = Warnings::default();
    warnings::add_scene(&mut warnings, &scene);
    let materials = material::write(&scene, &mut glb, &mut warnings);
    let mut nodes = node::Nodes::new(&scene);
    let morphs = mesh::write(&scene, &materials, &mut nodes, &mut glb, &mut warnings)?;
    node::add_cameras_and_lights(&scene, &mut nodes, &mut glb, &mut warnings);
    nodes.write(&mut glb);
    clip::write(&scene, &nodes, &morphs, &mut glb, &mut warnings)?;
    Ok(Output { bytes: glb.write()?, warnings: warnings.into_sentences() })
}

/// Rejects files that aren't FBX, with messages that ufbx lacks the context for.
fn check_head(bytes: &[u8]) -> Result<(), String> {
    if bytes.len() > MAX_FILE_BYTES {
        return Err(format!(
            "the FBX file is too large: expected at most {MAX_FILE_BYTES} bytes, found {}. Export it without textures.",
            bytes.len()
        ));
    }
    if bytes.is_empty() {
        return Err("the FBX file is empty: download or export it again.".to_owned());
    }
    if bytes.starts_with(b"Kaydara FBX Binary") && !bytes.starts_with(b"Kaydara FBX Binary  \0\x1a\0") {
        return Err(
            "the FBX file is damaged: its zero bytes were changed, as by a text-mode transfer. Download it again."
                .to_owned(),
        );
    }
    Ok(())
}
