//! Loads files in memory as an [`Asset`], and writes GLB, BVH and VRM animations. Knows neither disk nor network: callers ask
//! [`missing_files`] what else a file refers to, add it to the [`FileSet`], then call [`load`].
//!
//! ```
//! use gaitway_formats::{FileSet, load, missing_files};
//!
//! # fn main() -> Result<(), gaitway_formats::LoadError> {
//! let json = r#"{
//!     "asset": { "version": "2.0" },
//!     "nodes": [{ "name": "hips" }],
//!     "buffers": [{ "uri": "fox.bin", "byteLength": 4 }]
//! }"#;
//! let mut files = FileSet::default();
//! files.insert("fox.gltf", json.as_bytes());
//! // The caller finds these files, wherever they are.
//! assert_eq!(missing_files(&files), ["fox.bin"]);
//! files.insert("fox.bin", [0; 4]);
//!
//! let asset = load(&files)?;
//! assert!(asset.skeleton.find("hips").is_some());
//! # Ok(())
//! # }
//! ```

#![forbid(unsafe_code)]
// Files are untrusted: whatever is wrong with them must be reported, never panic.
#![warn(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

mod bvh;
mod encoding;
mod error;
mod file_set;
mod gltf;
mod hdr;
pub mod limits;
mod lines;
mod obj;
mod part;
mod prepare;

use std::collections::BTreeSet;

pub use error::LoadError;
pub use file_set::FileSet;
pub use gltf::{Early, OwnClips, WriteError, early, insert_root, pointer_to};
pub use hdr::{HdrError, is_hdr, read_hdr};
pub use part::Part;
#[cfg(not(target_arch = "wasm32"))]
pub use prepare::prepare;
pub use prepare::{Preparation, next_preparation};

use gaitway_character::anim::{Clip, JointIndex, Skeleton};
use gaitway_character::asset::{Asset, Humanoid, Image, SharedBytes};
use glam::Vec3;

pub use file_set::file_stem;
use file_set::{bare_name, without_query};

/// Limit on .obj, .skel and .attach files together. Beyond it, which no real scene reaches, companions are not looked up:
/// each lookup walks the set.
const MAX_OBJ_FILES: usize = 256;

/// Returns the relative URIs (percent-decoded) that the models and motions in this set refer to and that are not in the set,
/// not even by their bare names; for an .obj also the .skel and .attach of the same stem, which need not exist.
pub fn missing_files(files: &FileSet) -> Vec<String> {
    let (mut missing, mut known) = (Vec::new(), BTreeSet::new());
    let mut add = |uris: Vec<String>| missing.extend(uris.into_iter().filter(|uri| known.insert(uri.clone())));
    for (name, bytes) in files.iter().filter(|(name, bytes)| is_gltf(name, bytes) && !is_bvh(name, bytes)) {
        add(gltf::missing_files(files, name, bytes));
    }
    let of_obj = || files.iter().filter(|(name, bytes)| is_obj(name, bytes) || obj::is_companion(name));
    if of_obj().count() <= MAX_OBJ_FILES {
        of_obj().for_each(|(name, bytes)| add(obj::missing_files(files, name, bytes)));
    }
    missing
}

/// Returns the file that the glTF `name` refers to by a URI, as its buffers and images are found.
pub fn referred_file<'a>(files: &'a FileSet, name: &str, uri: &str) -> Option<&'a SharedBytes> {
    gltf::find_file(files, name, uri).map(|found| found.bytes)
}

/// Returns a file and those that it refers to as a set of their own, in the form that they have now: converted ones stay converted.
pub fn with_references(files: &FileSet, name: &str) -> FileSet {
    let mut own = FileSet::default();
    let add = |own: &mut FileSet, name: &str| match files.get(name) {
        Some(bytes) if own.get(name).is_none() => {
            own.insert_shared(name, bytes.clone());
            true
        }
        _ => false,
    };
    add(&mut own, name);
    if obj::is_obj(name) {
        obj::companions(files, name).into_iter().for_each(|companion| _ = add(&mut own, companion));
    }
    // What was found may refer to more, such as a material library to its images.
    loop {
        let missing = missing_files(&own);
        let found = missing.iter().filter_map(|uri| files.resolve(name, uri));
        if found.filter(|file| add(&mut own, file.name)).count() == 0 {
            return own;
        }
    }
}

/// Extensions of glTF files, in lower case; [`AssetParts::format`](gaitway_character::asset::AssetParts::format) uses the same
/// words.
pub const GLTF_EXTENSIONS: [&str; 4] = ["glb", "gltf", "vrm", "vrma"];

/// Extensions of other files with a skeleton or clips, in lower case.
pub const OTHER_MOTION_EXTENSIONS: [&str; 5] = ["bvh", "fbx", "npy", "npz", "x"];

/// What a file does not state but the user may know, and what it still lacks.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LoadOptions {
    /// Metres per unit of a .bvh. `None` guesses it from the skeleton's size.
    pub bvh_unit_metres: Option<f32>,
    /// Whether Z is up in a .bvh (else Y). `None` guesses it from the rest pose and the motion.
    pub bvh_z_up: Option<bool>,
    /// The images of a glTF have not arrived yet: they stay empty, which is reported, and a buffer may end before them. See
    /// [`early`].
    pub awaits_images: bool,
}

/// Loads the only model in a set of files. A set with none, or with several, is an error that lists what was found.
pub fn load(files: &FileSet) -> Result<Asset, LoadError> {
    load_with(files, &LoadOptions::default())
}

/// Like [`load`], with options for what a file does not state.
pub fn load_with(files: &FileSet, options: &LoadOptions) -> Result<Asset, LoadError> {
    let (name, bytes) = find_model(files)?;
    read(files, name, bytes, options, &mut |_| ())
}

/// Returns the names of the files in the set that are models or motions. [`load`] expects exactly one.
pub fn main_files(files: &FileSet) -> Vec<String> {
    files.iter().filter(|(name, bytes)| is_model(name, bytes)).map(|(name, _)| name.to_owned()).collect()
}

/// Loads one of the set's [`main_files`]. The others may contain its buffers and images.
pub fn load_named(files: &FileSet, name: &str, options: &LoadOptions) -> Result<Asset, LoadError> {
    load_noticing_images(files, name, options, &mut |_| ())
}

/// Like [`load_named`]. Calls `on_images` with the asset's images as soon as they are known, before the rest is read, so
/// that a platform can decode them meanwhile.
pub fn load_noticing_images(
    files: &FileSet,
    name: &str,
    options: &LoadOptions,
    on_images: &mut dyn FnMut(&[Image]),
) -> Result<Asset, LoadError> {
    read(files, name, named(files, name)?, options, on_images)
}

/// Writes the set's model `name` (one of its [`main_files`]) as a self-contained GLB, with `clips` added after its own. The
/// clips are for `skeleton`, which was loaded from the same file. The contents of a glTF are preserved to the letter: its
/// first buffer is the beginning of the new one, and its JSON only grows. Other formats take joint names and rest pose from
/// `skeleton`.
pub fn write_model(files: &FileSet, name: &str, skeleton: &Skeleton, clips: &[&Clip]) -> Result<Vec<u8>, WriteError> {
    write_edited_model(files, name, skeleton, &OwnClips::default(), clips)
}

/// Like [`write_model`], with some of the model's own clips renamed or left out.
pub fn write_edited_model(
    files: &FileSet,
    name: &str,
    skeleton: &Skeleton,
    own: &OwnClips,
    clips: &[&Clip],
) -> Result<Vec<u8>, WriteError> {
    let bytes = named(files, name)?;
    if !is_converted(name, bytes) {
        return gltf::write_model(files, name, skeleton, own, clips);
    }
    let asset = read(files, name, bytes, &LoadOptions::default(), &mut |_| ())?;
    check_skeleton(name, &asset, skeleton)?;
    let renamed = |(index, clip): (usize, &Clip)| match own.names.get(&index) {
        Some(name) => clip.clone().with_name(name.clone()),
        None => clip.clone(),
    };
    let kept = asset.clips.iter().enumerate().filter(|(index, _)| !own.left_out.contains(index));
    let kept: Vec<Clip> = kept.map(renamed).collect();
    let all: Vec<&Clip> = kept.iter().chain(clips.iter().copied()).collect();
    gltf::write_asset(&asset, skeleton, kept.len(), &all)
}

/// Whether a model of this format is written from the asset: it has no JSON that could be kept.
fn is_converted(name: &str, bytes: &[u8]) -> bool {
    is_bvh(name, bytes) || is_obj(name, bytes)
}

fn check_skeleton(name: &str, asset: &Asset, skeleton: &Skeleton) -> Result<(), WriteError> {
    let (nodes, joints) = (asset.skeleton.len(), skeleton.len());
    if nodes != joints {
        return Err(WriteError::OtherSkeleton { file: name.to_owned(), nodes, joints });
    }
    let mut joints = skeleton.joints();
    if let Some(joint) = joints.find(|&joint| skeleton.parent(joint) != asset.skeleton.parent(joint)) {
        let joint = skeleton.label(joint);
        return Err(WriteError::OtherParent { file: name.to_owned(), joint });
    }
    Ok(())
}

/// Writes a GLB with nothing but the skeleton of an asset and `clips` for it. `skeleton` has the asset's joints; names and rest
/// pose may differ.
pub fn write_motion(asset: &Asset, skeleton: &Skeleton, clips: &[&Clip]) -> Result<Vec<u8>, WriteError> {
    gltf::write_motion(asset, skeleton, clips)
}

/// Writes `joints` of an asset, in ascending order, and how a clip of it moves them as BVH: in metres, Y up, one frame per key if
/// all keys are frames, else `frames_per_sec`. Joints in between that are left out still move those below. The bones rest in
/// [`Asset::reference_pose`]. `skeleton` has the asset's joints; names may differ.
pub fn write_bvh(
    asset: &Asset,
    skeleton: &Skeleton,
    joints: &[JointIndex],
    clip: &Clip,
    frames_per_sec: f64,
) -> Result<Vec<u8>, WriteError> {
    bvh::write(skeleton, &asset.reference_pose(), joints, clip, frames_per_sec)
}

/// Writes a clip of an asset as a VRM animation: the bones of its `slots`, the position of the hips, expressions and gaze.
/// `forward` is where the body faces at rest; a declared humanoid faces where its format says. Without hips that is an error.
pub fn write_vrma(asset: &Asset, slots: &Humanoid, forward: Option<Vec3>, clip: &Clip) -> Result<Vec<u8>, WriteError> {
    gltf::write_vrma(asset, slots, forward, clip)
}

/// Converts the only model or motion of a set to GLB: a glTF with everything in it, a .bvh as skeleton and clip, an .obj in its
/// rest pose.
pub fn convert(files: &FileSet, options: &LoadOptions) -> Result<Vec<u8>, WriteError> {
    convert_named(files, find_model(files)?.0, options)
}

/// Like [`convert`], for one of the set's [`main_files`].
pub fn convert_named(files: &FileSet, name: &str, options: &LoadOptions) -> Result<Vec<u8>, WriteError> {
    let bytes = named(files, name)?;
    let asset = read(files, name, bytes, options, &mut |_| ())?;
    if is_converted(name, bytes) {
        return gltf::write_asset(&asset, &asset.skeleton, asset.clips.len(), &asset.clips.iter().collect::<Vec<_>>());
    }
    gltf::write_model(files, name, &asset.skeleton, &OwnClips::default(), &[])
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
        gltf::load(files, name, bytes, options, on_images)
    }
}

fn named<'a>(files: &'a FileSet, name: &str) -> Result<&'a SharedBytes, LoadError> {
    let error = || LoadError::NoSuchFile { name: name.to_owned(), found: files.names().map(str::to_owned).collect() };
    files.get(name).ok_or_else(error)
}

fn find_model(files: &FileSet) -> Result<(&str, &SharedBytes), LoadError> {
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
                if whole_file_part(name, bytes).is_some() {
                    let problem = "a file of this format is loaded after `prepare` has converted it".to_owned();
                    return Some(LoadError::Conversion { file: name.to_owned(), problem });
                }
                let (format, advice) = foreign_format(name, bytes)?;
                Some(LoadError::UnsupportedFormat { file: name.to_owned(), format, advice })
            })
            .or_else(|| files.names().find(|name| extension(name) == "bin").map(without_gltf))
            .unwrap_or_else(|| LoadError::NoModel { found: files.names().map(str::to_owned).collect() })),
    }
}

/// The error for a glTF's buffer without its .gltf.
fn without_gltf(file: &str) -> LoadError {
    let (stem, _) = split_extension(file);
    let place = "the model it belongs to".to_owned();
    LoadError::MissingFile { file: file.to_owned(), place, uri: format!("{stem}.gltf") }
}

fn is_model(name: &str, bytes: &[u8]) -> bool {
    is_bvh(name, bytes) || is_gltf(name, bytes) || is_obj(name, bytes)
}

/// Decided by the name alone: nothing in the text is distinctive.
fn is_obj(name: &str, bytes: &[u8]) -> bool {
    obj::is_obj(name) && !is_bvh(name, bytes) && !is_gltf(name, bytes)
}

fn is_bvh(name: &str, bytes: &[u8]) -> bool {
    bvh::is_bvh(bytes) || (extension(name) == "bvh" && !bytes.starts_with(b"glTF"))
}

/// Decided by the content if possible (URLs often have no file extension), else by the extension.
fn is_gltf(name: &str, bytes: &[u8]) -> bool {
    if bytes.starts_with(b"glTF") {
        return true;
    }
    let extension = extension(name);
    if GLTF_EXTENSIONS.contains(&extension.as_str()) {
        return true;
    }
    // A URL without a telling name: JSON that mentions an asset.
    extension != "json"
        && bytes.iter().find(|byte| !byte.is_ascii_whitespace()) == Some(&b'{')
        && bytes.windows(7).take(4096).any(|window| window == b"\"asset\"")
}

/// Returns the part that converts a file as a whole, until it has done so.
fn whole_file_part(name: &str, bytes: &[u8]) -> Option<Part> {
    if bytes.starts_with(b"glTF") {
        return None;
    }
    if bytes.starts_with(b"Kaydara FBX") {
        return Some(Part::Fbx);
    }
    if bytes.starts_with(b"xof ") {
        return Some(Part::X);
    }
    if file_set::is_npz(bytes) || file_set::is_npy(bytes) {
        return Some(Part::Npz);
    }
    match extension(name).as_str() {
        "fbx" => Some(Part::Fbx),
        "x" => Some(Part::X),
        "npy" | "npz" => Some(Part::Npz),
        _ => None,
    }
}

/// Returns a format that users may expect to be read, and how to convert it.
fn foreign_format(name: &str, bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    match extension(name).as_str() {
        _ if is_html(bytes) => {
            Some(("HTML", "this is a web page; use the address of the file itself, such as its download link"))
        }
        "dae" => Some((
            "COLLADA",
            "import it into Blender (File › Import, up to version 4.5), then export glTF 2.0 (.glb) and drop that",
        )),
        "blend" => {
            Some(("Blender's own", "open it in Blender (File › Open), then export glTF 2.0 (.glb) and drop that"))
        }
        "exr" => Some(("OpenEXR", "save the image as Radiance HDR (.hdr) and drop that")),
        _ => None,
    }
}

fn is_html(bytes: &[u8]) -> bool {
    let text = bytes.trim_ascii_start();
    let starts_with =
        |start: &str| text.get(..start.len()).is_some_and(|found| found.eq_ignore_ascii_case(start.as_bytes()));
    starts_with("<!doctype html") || starts_with("<html")
}

/// The file extension in lower case, even if a URL has a query.
fn extension(name: &str) -> String {
    split_extension(name).1.to_lowercase()
}

/// The bare name without its extension, and the extension.
fn split_extension(name: &str) -> (&str, &str) {
    let bare = bare_name(without_query(name));
    bare.rsplit_once('.').unwrap_or((bare, ""))
}
