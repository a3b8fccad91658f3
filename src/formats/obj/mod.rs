//! Wavefront .obj: a mesh as text, alone or with a skeleton (.skel) and weights (.attach) as in the skinning exercise of MIT
//! 6.837: [`skel`] and [`attach`] begin with their facts.
//!
//! The mesh is where it is bound: the skeleton's rest is the sum of its offsets, so at rest nothing moves. Units are taken
//! for metres and Y points up, since no file says so.

mod attach;
mod mesh;
mod mtl;
mod polygon;
mod skel;
mod text;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Affine3A;

use super::file_set::bare_name;
use super::gltf::image_header;
use super::{FileSet, LoadError, ending};
use crate::anim::{Joint, Skeleton, Transform, model_from_joint};
use crate::asset::{Asset, Image, MeshInstance, Warning, Warnings};
use crate::formats::error::Problem;
use crate::mesh::{Geometry, Influences, Mesh, Sampler, Skin, Texture, TextureRef, UvTransform};
use mtl::MtlMaterial;
use text::ObjText;

pub(super) fn is_obj(name: &str) -> bool {
    ending(name) == "obj"
}

/// Whether a file only says something about an .obj that is to be with it.
pub(super) fn is_companion(name: &str) -> bool {
    matches!(ending(name).as_str(), "skel" | "attach")
}

/// Names of the files beside an .obj, or beside one of its companions, which would belong to it and are not in the set:
/// .obj, .skel and .attach of the same stem, material libraries, and what these name.
pub(super) fn missing_files(files: &FileSet, file: &str, bytes: &[u8]) -> Vec<String> {
    let mut missing = Vec::new();
    for kind in ["obj", "skel", "attach"] {
        if companion(files, file, kind).is_none() {
            missing.extend(sibling(file, kind).map(|name| bare_name(&name).to_owned()));
        }
    }
    if !is_obj(file) {
        return missing;
    }
    let mut materials = BTreeMap::new();
    for library in text::libraries(bytes) {
        match files.resolve(file, &library) {
            Some(found) => mtl::read(found.name, found.bytes, &mut materials, &mut Warnings::default()),
            None => missing.push(library),
        }
    }
    for picture in materials.into_values().filter_map(|material| material.picture) {
        if files.resolve(file, &picture).is_none() && !missing.contains(&picture) {
            missing.push(picture);
        }
    }
    missing
}

/// The same name with another ending.
fn sibling(file: &str, kind: &str) -> Option<String> {
    let bare = bare_name(file);
    let length = ending(file).len();
    // An address may go on behind the name.
    let end = file.len() - bare.len() + bare.split(['?', '#']).next().unwrap_or(bare).len();
    let stem = file.get(..end.checked_sub(length)?)?;
    Some(format!("{stem}{kind}{}", file.get(end..)?))
}

/// The file of another kind that belongs to `file`: of the same stem; else the only one, if there is only one .obj as well.
fn companion<'a>(files: &'a FileSet, file: &str, kind: &str) -> Option<(&'a str, &'a Arc<[u8]>)> {
    let wanted = sibling(file, kind)?.to_lowercase();
    if let Some(found) = files.iter().find(|(name, _)| name.to_lowercase() == wanted) {
        return Some(found);
    }
    let only = |kind: &str| {
        let mut found = files.iter().filter(|(name, _)| ending(name) == kind);
        found.next().filter(|_| found.next().is_none())
    };
    // With several of one kind, each goes with its own name.
    let one_set = ["obj", "skel", "attach"]
        .iter()
        .all(|kind| files.iter().filter(|(name, _)| ending(name) == **kind).count() <= 1);
    only(kind).filter(|_| one_set)
}

/// What to say of companions without an .obj.
pub(super) fn without_obj(file: &str) -> LoadError {
    let uri = sibling(file, "obj").map_or_else(|| "the .obj".to_owned(), |name| bare_name(&name).to_owned());
    LoadError::MissingFile { file: file.to_owned(), place: "the mesh it belongs to".to_owned(), uri }
}

pub(super) fn load(
    files: &FileSet,
    file: &str,
    bytes: &[u8],
    on_images: &mut dyn FnMut(&[Image]),
) -> Result<Asset, LoadError> {
    let mut warnings = Warnings::default();
    let obj = text::read(bytes, &mut warnings).map_err(|problem| problem.in_file(file))?;
    if obj.faces.is_empty() {
        return Err(Problem::new("the whole file", "a face (a line that begins with “f”)", "none").in_file(file));
    }
    let missing = |place: &str, kind: &str| LoadError::MissingFile {
        file: file.to_owned(),
        place: place.to_owned(),
        uri: sibling(file, kind).map_or_else(String::new, |name| bare_name(&name).to_owned()),
    };
    let skinned = match (companion(files, file, "skel"), companion(files, file, "attach")) {
        (Some(skel), Some(attach)) => Some((skel, attach)),
        (None, None) => None,
        (Some(_), None) => return Err(missing("the file with its weights", "attach")),
        (None, Some(_)) => return Err(missing("the file with its skeleton", "skel")),
    };
    let stem = sibling(file, "").unwrap_or_default();
    let stem = bare_name(&stem).trim_end_matches('.');
    let (skeleton, skin, influences) = match skinned {
        None => (lone_joint(stem), None, Influences::default()),
        Some(((skel_file, skel), (attach_file, attach))) => {
            let skeleton = skel::read(skel).map_err(|problem| problem.in_file(skel_file))?;
            let skin = skin(stem, &skeleton).map_err(|problem| problem.in_file(skel_file))?;
            let influences = attach::read(attach_file, attach, obj.positions.len(), skeleton.len(), &mut warnings)
                .map_err(|problem| problem.in_file(attach_file))?;
            (skeleton, Some(skin), influences)
        }
    };
    let mut built = mesh::build(&obj, stem);
    if skin.is_some() {
        for (geometry, file_vertex) in built.mesh.primitives.iter_mut().zip(&built.file_vertex) {
            geometry.influences = mesh::copied(&influences, file_vertex);
        }
    }
    let mut asset = Asset { format: "obj", skeleton, ..Asset::default() };
    add_materials(files, file, &obj, &built.parts, &mut built.mesh.primitives, &mut asset, &mut warnings);
    on_images(&asset.images);
    place_mesh(&mut asset, built.mesh, skin);
    asset.warnings = warnings;
    Ok(asset)
}

fn place_mesh(asset: &mut Asset, mesh: Mesh, skin: Option<Skin>) {
    asset.meshes.push(mesh);
    let skin_index = skin.is_some().then_some(0);
    asset.skins.extend(skin);
    // A skinned mesh goes by its joints wherever it hangs, so it needs no node of its own.
    let joint = asset.skeleton.joints().next();
    asset.instances.extend(joint.map(|joint| MeshInstance { joint, mesh: 0, skin: skin_index }));
}

/// What a static model hangs on.
fn lone_joint(name: &str) -> Skeleton {
    let joint = Joint { name: name.to_owned(), parent: None, rest: Transform::IDENTITY, morph_weights: Vec::new() };
    Skeleton::new(vec![joint]).unwrap_or_default()
}

/// All joints, in the file's order, bound where they rest.
fn skin(name: &str, skeleton: &Skeleton) -> Result<Skin, Problem> {
    let mut world = Vec::new();
    model_from_joint(skeleton, &skeleton.rest().locals, Affine3A::IDENTITY, &mut world);
    let joints: Vec<_> = (0..skeleton.len()).filter_map(|source| skeleton.joint_of_source(source)).collect();
    // Nothing is turned at rest, so the inverse is the way back.
    let joint_from_bind =
        joints.iter().map(|joint| Affine3A::from_translation((-world[joint.get()].translation).into())).collect();
    Skin::new(name.to_owned(), joints, joint_from_bind, skeleton.len())
        .map_err(|problem| Problem::new("joints", "places that fit into 32 bits", problem))
}

/// One material for each that a part names, plain ones where the libraries do not have it.
fn add_materials(
    files: &FileSet,
    file: &str,
    obj: &ObjText,
    parts: &[usize],
    primitives: &mut [Geometry],
    asset: &mut Asset,
    warnings: &mut Warnings,
) {
    let mut known: BTreeMap<String, MtlMaterial> = BTreeMap::new();
    let mut read_all = true;
    for library in &obj.libraries {
        match files.resolve(file, library) {
            Some(found) => {
                if found.by_bare_name {
                    warnings.push(Warning::FoundByBareName { uri: library.clone(), used: found.name.to_owned() });
                }
                mtl::read(found.name, found.bytes, &mut known, warnings);
            }
            None => {
                read_all = false;
                let problem = "it is not among the files, so its materials are grey; drop it together with the model";
                let (place, problem) = (library.clone(), problem.to_owned());
                warnings.push(Warning::Other { code: "materials-missing", place, problem });
            }
        }
    }
    let mut material_of_name: BTreeMap<&str, usize> = BTreeMap::new();
    let mut texture_of_picture: BTreeMap<String, Option<usize>> = BTreeMap::new();
    let mut budget = super::gltf::MAX_IMAGE_PIXELS;
    for (&part, geometry) in parts.iter().zip(primitives) {
        let name = obj.parts[part].material.as_str();
        let index = *material_of_name.entry(name).or_insert_with(|| {
            let found = known.get(name);
            if found.is_none() && !name.is_empty() && read_all {
                let problem = "no material library has it, so it is grey".to_owned();
                let place = format!("material “{name}”");
                warnings.push(Warning::Other { code: "material-missing", place, problem });
            }
            let mut material = found.map_or_else(|| mtl::plain(name), |found| found.material.clone());
            if let Some(picture) = found.and_then(|found| found.picture.as_ref()) {
                let texture = texture_of_picture.entry(picture.clone()).or_insert_with(|| {
                    let image = image(files, file, picture, &mut budget, warnings)?;
                    asset.images.push(image);
                    asset.textures.push(Texture { image: Some(asset.images.len() - 1), sampler: Sampler::default() });
                    Some(asset.textures.len() - 1)
                });
                material.base_color_texture =
                    texture.map(|texture| TextureRef { texture, uv_set: 0, uv_transform: UvTransform::IDENTITY });
            }
            asset.materials.push(material);
            asset.materials.len() - 1
        });
        geometry.material = Some(index);
    }
}

fn image(files: &FileSet, file: &str, picture: &str, budget: &mut usize, warnings: &mut Warnings) -> Option<Image> {
    let Some(found) = files.resolve(file, picture) else {
        warnings.push(Warning::ImageMissing { uri: picture.to_owned() });
        return None;
    };
    if found.by_bare_name {
        warnings.push(Warning::FoundByBareName { uri: picture.to_owned(), used: found.name.to_owned() });
    }
    match image_header(found.bytes, budget) {
        Ok((mime, width, height)) => {
            Some(Image { name: picture.to_owned(), mime, bytes: found.bytes.clone(), width, height })
        }
        Err(problem) => {
            warnings.push(Warning::ImageUnreadable { image: picture.to_owned(), problem });
            None
        }
    }
}
