//! Writes binary FBX: hierarchy, bones, skinned meshes, blend shapes, materials with their textures, cameras, lights, and every clip.
//!
//! The input is a GLB, which Gaitway's export makes of a model and the chosen clips. It is read with the reader that opens models,
//! so that whatever is wrong with a file is corrected or refused there, and [`asset`] maps the result. README.md has the mapping.

#![forbid(unsafe_code)]
// Files are untrusted: whatever is wrong with them must be reported, never panic.
#![warn(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

mod clip;
mod document;
mod euler;
mod fit;
mod layout;
mod material;
mod mesh;
mod model;
mod names;
mod objects;
mod pose;
mod record;
mod source;
mod space;
mod tolerance;

use std::collections::BTreeMap;

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::Asset;
use gaitway_character::mesh::Topology;
use gaitway_formats::{FileSet, LoadError, load};

use crate::clip::Rig;
use crate::document::Take;
use crate::layout::{Attribute, Contents, Layout};
use crate::material::Materials;
use crate::names::Names;
use crate::objects::Objects;
use crate::space::Space;
use crate::tolerance::Tolerances;

/// Centimetres, which importers expect.
const UNITS_PER_METRE: f64 = 100.0;
/// What the input is called in messages.
const FILE: &str = "model.glb";

/// The program that a file is for, which decides axes and unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FbxRecipient {
    /// Centimetres, Y up, every joint as it is.
    #[default]
    AsIs,
    /// Centimetres, Y up. Even scales above bones move into the bones.
    Unity,
    /// The same with Z up, so that the root isn't turned.
    Unreal,
    /// Metres with Z up, so that objects are neither scaled nor turned; even scales as for Unity.
    Blender,
}

impl FbxRecipient {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::AsIs, Self::Unity, Self::Unreal, Self::Blender];
}

/// How a file is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FbxOptions {
    /// Whom it is for.
    pub recipient: FbxRecipient,
    /// Only the skeleton and the clips, without meshes, materials, cameras and lights.
    pub clips_only: bool,
}

/// Why a file can't be written.
#[derive(Debug, thiserror::Error)]
pub enum FbxError {
    /// The input can't be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The offsets of FBX 7.4 have 32 bits.
    #[error(
        "the FBX file would be too large: expected at most 4,294,967,295 bytes, found {bytes}; choose fewer clips or smaller textures"
    )]
    TooLarge {
        /// Size of the file.
        bytes: usize,
    },
    /// There is nothing in the input.
    #[error("the model is empty: expected a joint, a mesh or a clip")]
    Empty,
}

/// A file, and what is in it.
#[derive(Debug)]
pub struct Written {
    /// Content of the file.
    pub bytes: Vec<u8>,
    /// What the file can't hold, one sentence each.
    pub warnings: Vec<String>,
    /// The name of each joint in the file: never empty, and unique even without regard to case.
    pub names: Vec<String>,
}

/// Converts a GLB.
///
/// # Errors
/// If the GLB can't be read, has nothing in it or the result would be too large.
pub fn fbx(glb: &[u8], options: &FbxOptions) -> Result<Written, FbxError> {
    let mut files = FileSet::default();
    files.insert(FILE, glb);
    // What needs a decoder was decoded before the model was shown, but its file keeps it as it was.
    #[cfg(not(target_arch = "wasm32"))]
    gaitway_formats::prepare(&mut files)?;
    asset(&load(&files)?, options)
}

/// Writes an asset.
///
/// # Errors
/// If it is empty or the file would be too large.
pub fn asset(asset: &Asset, options: &FbxOptions) -> Result<Written, FbxError> {
    if asset.skeleton.is_empty() {
        return Err(FbxError::Empty);
    }
    let recipient = options.recipient;
    let is_z_up = matches!(recipient, FbxRecipient::Unreal | FbxRecipient::Blender);
    let unit = if recipient == FbxRecipient::Blender { 1.0 } else { UNITS_PER_METRE };
    let space = Space::new(asset, unit, is_z_up, recipient != FbxRecipient::AsIs);
    let contents = Contents { asset, space: &space, clips_only: options.clips_only };
    let mut objects = Objects::default();
    let layout = Layout::new(contents, &mut objects);
    for model in layout.models.iter().filter(|model| model.attribute != Attribute::LeftOut) {
        model::write(contents, model, &mut objects);
    }
    let mut warnings = Vec::new();
    let channels = add_meshes(contents, &layout, recipient, &mut objects, &mut warnings);
    pose::write(contents, &layout, &mut objects);
    let takes = add_clips(contents, &layout, &channels, &mut objects, &mut warnings);
    let longest = asset.clips.iter().max_by(|a, b| a.duration_secs().total_cmp(&b.duration_secs()));
    let frames_per_sec = longest.map_or(30.0, |clip| clip.frames_per_sec());
    let records = document::records(objects, &space, &takes, frames_per_sec);
    let bytes = record::file(&records).map_err(|bytes| FbxError::TooLarge { bytes })?;
    let names = layout.models.into_iter().take(asset.skeleton.len()).map(|model| model.name).collect();
    Ok(Written { bytes, warnings, names })
}

/// Writes the meshes with their materials. Returns the channels of the blend shapes of each joint's meshes.
fn add_meshes(
    contents: Contents,
    layout: &Layout,
    recipient: FbxRecipient,
    objects: &mut Objects,
    warnings: &mut Vec<String>,
) -> BTreeMap<JointIndex, Vec<Vec<objects::Id>>> {
    let Contents { asset, space, .. } = contents;
    let mut materials = Materials::new(asset, recipient);
    let mut names = Names::default();
    let mut channels: BTreeMap<JointIndex, Vec<Vec<objects::Id>>> = BTreeMap::new();
    let mut shared: BTreeMap<(usize, u64), objects::Id> = BTreeMap::new();
    for model in &layout.models {
        let Attribute::Mesh(index) = model.attribute else { continue };
        let instance = &asset.instances[index];
        let mesh = &asset.meshes[instance.mesh];
        let has_targets = mesh.primitives.iter().any(|geometry| !geometry.morph_targets.is_empty());
        // Weights belong to the object, but FBX has them with the mesh.
        let key = (instance.mesh, space.of_joint(instance.joint.get()).to_bits());
        let known = shared.get(&key).copied().filter(|_| instance.skin.is_none() && !has_targets);
        let geometry = known.unwrap_or_else(|| {
            let (geometry, of_shapes) = mesh::write(contents, layout, index, (&mut *objects, &mut names));
            if instance.skin.is_none() {
                shared.insert(key, geometry);
            }
            if !of_shapes.is_empty() {
                channels.entry(instance.joint).or_default().push(of_shapes);
            }
            geometry
        });
        objects.connect(geometry, model.id);
        for material in mesh::materials(mesh) {
            let material = materials.get(asset, material, objects);
            objects.connect(material, model.id);
        }
    }
    if !contents.clips_only {
        warn(asset, &materials, warnings);
    }
    channels
}

/// Says what of meshes and materials the file can't hold.
fn warn(asset: &Asset, materials: &Materials, warnings: &mut Vec<String>) {
    let primitives = asset.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let others = primitives.filter(|geometry| geometry.topology != Topology::Triangles).count();
    if others > 0 {
        warnings.push(format!("Points and lines are left out: FBX holds polygons ({others} of them)."));
    }
    if !materials.unknown_images.is_empty() {
        let names = materials.unknown_images.join("”, “");
        warnings.push(format!("Textures that are neither PNG nor JPEG are left out: “{names}”."));
    }
    if !materials.simplified.is_empty() {
        let names = materials.simplified.join("”, “");
        warnings.push(format!(
            "Metalness, roughness and occlusion maps are left out, which Phong doesn't have: “{names}”."
        ));
    }
}

fn add_clips(
    contents: Contents,
    layout: &Layout,
    channels: &BTreeMap<JointIndex, Vec<Vec<objects::Id>>>,
    objects: &mut Objects,
    warnings: &mut Vec<String>,
) -> Vec<Take> {
    let asset = contents.asset;
    let tolerances = Tolerances::new(contents, layout);
    let rig = Rig { contents, layout, tolerances: &tolerances, channels };
    let mut names = Names::default();
    let mut takes = Vec::new();
    for clip in &asset.clips {
        match clip::write(&rig, clip, &mut names, objects) {
            Some(take) => takes.push(take),
            None => {
                let name = clip.name();
                warnings.push(format!("Clip “{name}” is left out: it moves neither joints nor blend shapes."));
            }
        }
    }
    takes
}
