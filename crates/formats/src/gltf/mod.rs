//! glTF 2.0 (ISO/IEC 12113): .glb, .gltf and what is built on them (.vrm, .vrma). Section numbers refer to the
//! specification. The `gltf` crate has the types of the JSON ([`document`]); its own readers and its validation are not used:
//! they reject good files and trust broken ones.

mod accessor;
mod animations;
mod byte_names;
mod container;
mod data;
pub(super) mod decoded;
mod document;
mod draco;
mod early;
mod extensions;
mod humanoid;
mod images;
mod indices;
mod influences;
mod instancing;
mod lobes;
mod loosen;
mod material_reader;
mod materials;
mod meshes;
mod meshopt;
mod mtoon;
mod nodes;
mod object;
mod pointer;
mod skins;
mod strict;
mod variants;
mod vrm;
mod write;

use gaitway_character::asset::{Asset, AssetParts, Image, Warning, Warnings};

use crate::error::Problem;
use crate::{FileSet, LoadError, LoadOptions};
use accessor::{Accessors, Bytes};
use container::Container;
use document::{Document, size};
use gltf::json::Root;

pub(super) use byte_names::decode_names;
pub(super) use data::find as find_file;
pub use early::{Early, early};
pub(super) use images::image_header;
pub use pointer::pointer_to;
pub(super) use write::check_frames;
pub use write::{OwnClips, WriteError, insert_root};
pub(super) use write::{asset as write_asset, model as write_model, motion as write_motion, vrma as write_vrma};

/// Returns the decoded URIs of the files that a model refers to and that are not in the set. Empty if it cannot be read.
pub(super) fn missing_files(files: &FileSet, file: &str, bytes: &[u8]) -> Vec<String> {
    let Ok(document) = container::open(file, bytes).and_then(|container| Document::read(file, &container)) else {
        return Vec::new();
    };
    let root = &document.root;
    let buffers = root.buffers.iter().filter(|buffer| !meshopt::is_fallback(buffer));
    let buffers = buffers.filter_map(|buffer| buffer.uri.as_deref());
    let images = root.images.iter().filter_map(|image| image.uri.as_deref());
    let mut seen = std::collections::BTreeSet::new();
    let mut uris: Vec<String> = Vec::new();
    for uri in buffers.chain(images).filter(|uri| !data::is_data_uri(uri)) {
        if data::find(files, file, uri).is_some() {
            continue;
        }
        let uri = data::decode_uri(uri).into_owned();
        if seen.insert(uri.clone()) {
            uris.push(uri);
        }
    }
    uris
}

pub(super) fn load(
    files: &FileSet,
    file: &str,
    bytes: &[u8],
    options: &LoadOptions,
    on_images: &mut dyn FnMut(&[Image]),
) -> Result<Asset, LoadError> {
    let mut container = container::open(file, bytes)?;
    container.awaits_images = options.awaits_images;
    let document = Document::read(file, &container)?;
    let mut warnings = Warnings::default();
    container.warn(&mut warnings);
    document.warn(&mut warnings);
    extensions::check(file, &document.root, &mut warnings)?;
    let conversion = files.conversion(file);
    for problem in conversion.into_iter().flat_map(|conversion| &conversion.warnings) {
        // The text names the place.
        warnings.push(Warning::Other { code: "conversion", place: String::new(), problem: problem.clone() });
    }
    build(files, file, &container, &document, warnings, on_images).map_err(|problem| problem.in_file(file))
}

fn build(
    files: &FileSet,
    file: &str,
    container: &Container,
    document: &Document,
    mut warnings: Warnings,
    on_images: &mut dyn FnMut(&[Image]),
) -> Result<Asset, Problem> {
    let root = &document.root;
    let buffers = resolve_buffers(files, file, container, root, &mut warnings)?;
    let accessors = Accessors::new(document, buffers);
    let materials = materials::materials(document, &mut warnings)?;
    let textures = materials::textures(document, &mut warnings)?;
    let images = images::images(files, file, container, &accessors, &mut warnings)?;
    on_images(&images);
    let variants = variants::names(root, &mut warnings)?;
    let meshes = meshes::meshes(&accessors, &materials, variants.len(), &mut warnings)?;
    let skeleton = nodes::skeleton(root, &meshes, &accessors.budget, &mut warnings)?;
    let skins = skins::skins(&accessors, &skeleton, &mut warnings)?;
    let instances = nodes::instances(&accessors, &skeleton, &meshes, &skins, &mut warnings)?;
    let humanoid = humanoid::humanoid(root, &skeleton, &mut warnings);
    let context = vrm::Context {
        root,
        skeleton: &skeleton,
        instances: &instances,
        materials: &materials,
        humanoid: humanoid.as_ref(),
    };
    let (avatar, animated) = vrm::read(&context, &mut warnings);
    let clips = animations::clips(&accessors, &skeleton, &materials, &animated, &mut warnings)?;
    let (scenes, default_scene) = nodes::scenes(root, &skeleton, &mut warnings)?;
    let cameras = nodes::cameras(document, &skeleton, &mut warnings)?;
    let hidden = nodes::hidden(root, &skeleton, &mut warnings);
    let lights = nodes::lights(document, &skeleton, &mut warnings)?;
    let conversion = files.conversion(file);
    let decoded = conversion.into_iter().flat_map(|conversion| &conversion.extensions);
    let parts = AssetParts {
        format: conversion.and_then(|conversion| conversion.format).unwrap_or_else(|| format(container, root)),
        generator: root.asset.generator.clone().unwrap_or_default(),
        skeleton,
        scenes,
        default_scene,
        clips,
        added_clip: animations::added(root),
        skins,
        meshes,
        instances,
        hidden,
        materials,
        variants,
        textures,
        images,
        cameras,
        lights,
        humanoid,
        avatar,
        extensions_used: root.extensions_used.iter().chain(decoded).cloned().collect(),
        extensions_required: root.extensions_required.clone(),
    };
    let mut asset = Asset::new(parts)?;
    asset.warnings = warnings;
    Ok(asset)
}

fn format(container: &Container, root: &Root) -> &'static str {
    let has = |name| root.extensions.as_ref().is_some_and(|extensions| extensions.others.contains_key(name));
    if has("VRMC_vrm_animation") {
        "vrma"
    } else if has("VRM") || has("VRMC_vrm") {
        "vrm"
    } else if container.is_glb {
        "glb"
    } else {
        "gltf"
    }
}

fn resolve_buffers<'a>(
    files: &FileSet,
    file: &str,
    container: &Container<'a>,
    root: &Root,
    warnings: &mut Warnings,
) -> Result<Vec<Option<Bytes<'a>>>, Problem> {
    (0..root.buffers.len()).map(|index| resolve_buffer(files, file, container, root, index, warnings)).collect()
}

/// Returns the bytes of a buffer; `None` if it has none.
fn resolve_buffer<'a>(
    files: &FileSet,
    file: &str,
    container: &Container<'a>,
    root: &Root,
    index: usize,
    warnings: &mut Warnings,
) -> Result<Option<Bytes<'a>>, Problem> {
    let buffer = &root.buffers[index];
    let place = format!("buffers[{index}]");
    let bytes = match (&buffer.uri, container.binary) {
        (Some(uri), _) if data::is_data_uri(uri) => Bytes::Owned(data::data_uri(&format!("{place}.uri"), uri)?),
        (Some(uri), _) => match data::file(files, file, uri, warnings) {
            Some(bytes) => Bytes::Shared(bytes),
            None => {
                let uri = data::decode_uri(uri).into_owned();
                return Err(Problem::MissingFile { place: format!("{place}.uri"), uri });
            }
        },
        (None, Some(binary)) if index == 0 => Bytes::Borrowed(binary),
        (None, _) => return Ok(None),
    };
    let found = bytes.as_slice().len();
    let byte_length = size(buffer.byte_length);
    if found < byte_length && !container.awaits_images {
        return Err(Problem::new(place, format!("{byte_length} bytes (byteLength)"), found));
    }
    Ok(Some(bytes))
}
