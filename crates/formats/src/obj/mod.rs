//! Wavefront .obj: a mesh as text, alone or with a skeleton (.skel) and weights (.attach) as in the skinning exercise of MIT
//! 6.837: see [`skel`] and [`attach`].
//!
//! The mesh is in its bind pose, and the skeleton's rest pose is the sum of its offsets, so that nothing moves at rest.
//! No file states units or axes: metres and Y up are assumed.

mod attach;
mod mesh;
mod mtl;
mod skel;
mod text;

use std::collections::BTreeMap;

use gaitway_character::anim::{Joint, Skeleton, Transform, model_from_joint};
use gaitway_character::asset::{Asset, AssetParts, Image, MeshInstance, SharedBytes, Warning, Warnings};
use gaitway_character::mesh::{Geometry, Influences, Mesh, Sampler, Skin, Texture, TextureRef, UvTransform};
use gaitway_character::sort::collect_set;
use glam::Affine3A;

use super::file_set::{bare_name, without_query};
use super::gltf::image_header;
use super::{FileSet, LoadError, extension};
use crate::error::Problem;
use crate::limits::Budget;
use mtl::MtlMaterial;
use text::ObjText;

/// Limit on images, each of which is looked up among the files or fetched.
const MAX_IMAGES: usize = 512;

pub(super) fn is_obj(name: &str) -> bool {
    extension(name) == "obj"
}

/// Whether a file only accompanies an .obj.
pub(super) fn is_companion(name: &str) -> bool {
    matches!(extension(name).as_str(), "skel" | "attach")
}

/// Returns the names of files that would belong to an .obj or one of its companions and are not in the set: .obj, .skel and
/// .attach of the same stem, material libraries, and their images.
pub(super) fn missing_files(files: &FileSet, file: &str, bytes: &[u8]) -> Vec<String> {
    let mut missing = Vec::new();
    for kind in ["obj", "skel", "attach"] {
        if companion(files, file, kind).is_none() {
            missing.extend(sibling_name(file, kind));
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
    let images = collect_set(materials.into_values().filter_map(|material| material.image));
    missing.extend(images.into_iter().take(MAX_IMAGES).filter(|image| files.resolve(file, image).is_none()));
    missing
}

/// Returns the .skel and .attach of an .obj.
pub(super) fn companions<'a>(files: &'a FileSet, file: &str) -> Vec<&'a str> {
    ["skel", "attach"].iter().filter_map(|kind| Some(companion(files, file, kind)?.0)).collect()
}

/// The same path or URL with another extension. A URL keeps its query.
fn sibling(file: &str, kind: &str) -> Option<String> {
    let path = without_query(file);
    let stem = path.get(..path.len().checked_sub(extension(file).len())?)?;
    Some(format!("{stem}{kind}{}", &file[path.len()..]))
}

/// The bare name with another extension.
fn sibling_name(file: &str, kind: &str) -> Option<String> {
    sibling(without_query(file), kind).map(|name| bare_name(&name).to_owned())
}

/// Finds the file of another kind that belongs to `file`: the one with the same stem, else the only one if there is only one
/// .obj as well.
fn companion<'a>(files: &'a FileSet, file: &str, kind: &str) -> Option<(&'a str, &'a SharedBytes)> {
    let wanted = sibling(file, kind)?.to_lowercase();
    if let Some(found) = files.iter().find(|(name, _)| name.to_lowercase() == wanted) {
        return Some(found);
    }
    let only = |kind: &str| {
        let mut found = files.iter().filter(|(name, _)| extension(name) == kind);
        found.next().filter(|_| found.next().is_none())
    };
    // With several of a kind, only names tell what belongs together.
    let one_set = ["obj", "skel", "attach"]
        .iter()
        .all(|kind| files.iter().filter(|(name, _)| extension(name) == **kind).count() <= 1);
    only(kind).filter(|_| one_set)
}

/// The error for companions without an .obj.
pub(super) fn without_obj(file: &str) -> LoadError {
    let uri = sibling_name(file, "obj").unwrap_or_else(|| "the .obj".to_owned());
    LoadError::MissingFile { file: file.to_owned(), place: "the mesh it belongs to".to_owned(), uri }
}

pub(super) fn load(
    files: &FileSet,
    file: &str,
    bytes: &[u8],
    on_images: &mut dyn FnMut(&[Image]),
) -> Result<Asset, LoadError> {
    let mut warnings = Warnings::default();
    let budget = &Budget::default();
    let obj = text::read(bytes, budget, &mut warnings).map_err(|problem| problem.in_file(file))?;
    if obj.faces.is_empty() {
        return Err(Problem::new("", "a face (a line that begins with “f”)", "none").in_file(file));
    }
    let stem = sibling_name(file, "").unwrap_or_default();
    let stem = stem.trim_end_matches('.');
    let rig = rig(files, file, stem, obj.positions.len(), budget, &mut warnings)?;
    let (skeleton, skin, influences) = match rig {
        None => (lone_joint(stem), None, Influences::default()),
        Some(Rig { skeleton, skin, influences }) => (skeleton, Some(skin), influences),
    };
    let mut built = mesh::build(&obj, stem, budget).map_err(|problem| problem.in_file(file))?;
    if skin.is_some() {
        for geometry in &mut built.mesh.primitives {
            let count = influences.stride * geometry.file_vertex.len();
            budget.allocate(count, attach::INFLUENCE_BYTES, &"weights").map_err(|problem| problem.in_file(file))?;
            geometry.influences = mesh::copied(&influences, &geometry.file_vertex);
        }
    }
    let mut parts = AssetParts { format: "obj", skeleton, ..AssetParts::default() };
    let mut surfaces = Surfaces { files, file, budget, parts: &mut parts, warnings: &mut warnings };
    surfaces.add_materials(&obj, &built.groups, &mut built.mesh.primitives);
    on_images(&parts.images);
    place_mesh(&mut parts, built.mesh, skin);
    let mut asset = Asset::new(parts).map_err(|problem| Problem::from(problem).in_file(file))?;
    asset.warnings = warnings;
    Ok(asset)
}

/// Contents of a .skel and a .attach. The influences are those of the file's vertices.
struct Rig {
    skeleton: Skeleton,
    skin: Skin,
    influences: Influences,
}

/// Reads the .skel and the .attach that belong to `file`: both or neither.
fn rig(
    files: &FileSet,
    file: &str,
    stem: &str,
    vertices: usize,
    budget: &Budget,
    warnings: &mut Warnings,
) -> Result<Option<Rig>, LoadError> {
    let missing = |place: &str, kind: &str| LoadError::MissingFile {
        file: file.to_owned(),
        place: place.to_owned(),
        uri: sibling_name(file, kind).unwrap_or_default(),
    };
    let ((skel_file, skel), (attach_file, attach)) =
        match (companion(files, file, "skel"), companion(files, file, "attach")) {
            (Some(skel), Some(attach)) => (skel, attach),
            (None, None) => return Ok(None),
            (Some(_), None) => return Err(missing("the file with its weights", "attach")),
            (None, Some(_)) => return Err(missing("the file with its skeleton", "skel")),
        };
    for (other, kind) in [(skel_file, "skel"), (attach_file, "attach")] {
        if sibling_name(file, kind).is_none_or(|name| name.to_lowercase() != bare_name(other).to_lowercase()) {
            let problem =
                format!("used for {}, though its name differs: it is the only file of its kind", bare_name(file));
            warnings.push(Warning::Other { code: "obj-companion", place: other.to_owned(), problem });
        }
    }
    let skeleton = skel::read(skel, budget).map_err(|problem| problem.in_file(skel_file))?;
    let skin = skin(stem, &skeleton).map_err(|problem| problem.in_file(skel_file))?;
    let influences = attach::read(attach_file, attach, vertices, skeleton.len(), budget, warnings)
        .map_err(|problem| problem.in_file(attach_file))?;
    Ok(Some(Rig { skeleton, skin, influences }))
}

fn place_mesh(parts: &mut AssetParts, mesh: Mesh, skin: Option<Skin>) {
    parts.meshes.push(mesh);
    let skin_index = skin.is_some().then_some(0);
    parts.skins.extend(skin);
    // A skinned mesh follows its joints, whichever node draws it, so it needs no node of its own.
    let joint = parts.skeleton.joints().next();
    parts.instances.extend(joint.map(|joint| MeshInstance::new(joint, 0, skin_index)));
}

/// The node that draws a static model.
fn lone_joint(name: &str) -> Skeleton {
    let joint = Joint { name: name.to_owned(), parent: None, rest: Transform::IDENTITY, morph_weights: Vec::new() };
    Skeleton::new(vec![joint]).unwrap_or_default()
}

/// All joints, in the file's order, bound in the rest pose.
fn skin(name: &str, skeleton: &Skeleton) -> Result<Skin, Problem> {
    let mut world = Vec::new();
    model_from_joint(skeleton, skeleton.rest(), Affine3A::IDENTITY, &mut world);
    let joints: Vec<_> = (0..skeleton.len()).filter_map(|source| skeleton.joint_of_source(source)).collect();
    // Nothing is rotated at rest, so the inverse is a translation.
    let joint_from_bind =
        joints.iter().map(|joint| Affine3A::from_translation((-world[joint.get()].translation).into())).collect();
    Skin::new(name.to_owned(), joints, joint_from_bind, skeleton.len())
        .map_err(|problem| Problem::new("joints", "positions that fit into 32 bits", problem))
}

/// Adds materials and textures to the parts of a model.
struct Surfaces<'a> {
    files: &'a FileSet,
    file: &'a str,
    budget: &'a Budget,
    parts: &'a mut AssetParts,
    warnings: &'a mut Warnings,
}

impl Surfaces<'_> {
    /// Adds one material for each one named by a group of faces; a plain one if it is in none of the libraries.
    fn add_materials(&mut self, obj: &ObjText, groups: &[usize], primitives: &mut [Geometry]) {
        let Libraries { materials, complete } = read_libraries(self.files, self.file, obj, self.warnings);
        let mut material_of_name: BTreeMap<&str, usize> = BTreeMap::new();
        let mut texture_of_image: BTreeMap<&str, Option<usize>> = BTreeMap::new();
        for (&group, geometry) in groups.iter().zip(primitives) {
            let name = obj.groups[group].material.as_str();
            let index = *material_of_name.entry(name).or_insert_with(|| {
                let found = materials.get(name);
                if found.is_none() && !name.is_empty() && complete {
                    let problem = "no material library has it, so it is grey".to_owned();
                    let place = format!("material “{name}”");
                    self.warnings.push(Warning::Other { code: "material-missing", place, problem });
                }
                let mut material = found.map_or_else(|| mtl::plain(name), |found| found.material.clone());
                if let Some(uri) = found.and_then(|found| found.image.as_ref()) {
                    let texture = *texture_of_image.entry(uri).or_insert_with(|| self.add_texture(uri));
                    material.base_color_texture =
                        texture.map(|texture| TextureRef { texture, uv_set: 0, uv_transform: UvTransform::IDENTITY });
                }
                self.parts.materials.push(material);
                self.parts.materials.len() - 1
            });
            geometry.material = Some(index);
        }
    }

    /// Returns the index of the new texture.
    fn add_texture(&mut self, uri: &str) -> Option<usize> {
        let image = image(self.files, self.file, uri, self.budget, self.warnings)?;
        self.parts.images.push(image);
        let image = Some(self.parts.images.len() - 1);
        self.parts.textures.push(Texture { image, sampler: Sampler::default() });
        Some(self.parts.textures.len() - 1)
    }
}

/// The materials of all libraries by name, and whether all libraries were found.
struct Libraries {
    materials: BTreeMap<String, MtlMaterial>,
    complete: bool,
}

fn read_libraries(files: &FileSet, file: &str, obj: &ObjText, warnings: &mut Warnings) -> Libraries {
    let mut libraries = Libraries { materials: BTreeMap::new(), complete: true };
    for library in &obj.libraries {
        let Some(found) = files.resolve(file, library) else {
            libraries.complete = false;
            let problem = "it is not among the files, so its materials are grey; open it with the model";
            let (place, problem) = (library.clone(), problem.to_owned());
            warnings.push(Warning::Other { code: "materials-missing", place, problem });
            continue;
        };
        if found.by_bare_name {
            warnings.push(Warning::FoundByBareName { uri: library.clone(), used: found.name.to_owned() });
        }
        mtl::read(found.name, found.bytes, &mut libraries.materials, warnings);
    }
    libraries
}

fn image(files: &FileSet, file: &str, uri: &str, budget: &Budget, warnings: &mut Warnings) -> Option<Image> {
    let Some(found) = files.resolve(file, uri) else {
        warnings.push(Warning::ImageMissing { uri: uri.to_owned() });
        return None;
    };
    if found.by_bare_name {
        warnings.push(Warning::FoundByBareName { uri: uri.to_owned(), used: found.name.to_owned() });
    }
    match image_header(found.bytes, budget) {
        Ok((mime, width, height)) => {
            Some(Image { name: uri.to_owned(), mime, bytes: found.bytes.clone(), width, height })
        }
        Err(problem) => {
            warnings.push(Warning::ImageUnreadable { image: uri.to_owned(), problem });
            None
        }
    }
}
