//! The two calls into ufbx that take options.
//!
//! The safe bindings convert options in a way that links allocators and file access that nobody uses, which is a
//! tenth of the wasm module's own part; so these calls pass the C structures.
#![allow(unsafe_code)]

use std::marker::PhantomData;

use crate::cut;
use ufbx::{RawAllocatorOpts, RawLoadOpts, RawVertexStream, SceneRoot};

/// Memory limit of ufbx while it reads or sorts vertices.
const MAX_TEMPORARY_BYTES: usize = 1 << 29;
/// Memory limit of the scene.
const MAX_SCENE_BYTES: usize = 3 << 28;
const MAX_ALLOCATIONS: usize = 1 << 24;
/// Maximum depth of the node hierarchy.
const MAX_DEPTH: u32 = 1000;

const NOT_FBX: &str = "this is not an FBX file: expected \"Kaydara FBX Binary\" or \"; FBX … project file\" at its start. \
    Check the extension, or export it again.";

/// Reads a file. Its errors are for the user.
pub fn load(bytes: &[u8]) -> Result<SceneRoot, String> {
    let options = RawLoadOpts {
        temp_allocator: limit(MAX_TEMPORARY_BYTES),
        result_allocator: limit(MAX_SCENE_BYTES),
        node_depth_limit: MAX_DEPTH,
        generate_missing_normals: true,
        normalize_normals: true,
        clean_skin_weights: true,
        use_blender_pbr_material: true,
        // Scaling the geometry instead of the root keeps joints free of a scale of 0.01. Geometric transforms are baked into
        // the meshes here, because ufbx leaves blend shapes out when it does so itself.
        space_conversion: ufbx::SpaceConversion::ModifyGeometry,
        geometry_transform_handling: ufbx::GeometryTransformHandling::Preserve,
        inherit_mode_handling: ufbx::InheritModeHandling::Compensate,
        handedness_conversion_axis: ufbx::MirrorAxis::X,
        target_axes: ufbx::axes_right_handed_y_up(),
        target_unit_meters: 1.0,
        ..RawLoadOpts::default()
    };
    // SAFETY: the options are those that a program in C would set: all others are zero, and none holds a pointer.
    let scene = unsafe { ufbx::load_memory_raw(bytes, &options) }.map_err(|error| explain(&error, bytes))?;
    // ufbx reads OBJ as well, unless compiled without it, as in wasm.
    if scene.metadata.file_format != ufbx::FileFormat::Fbx {
        return Err(NOT_FBX.to_owned());
    }
    Ok(scene)
}

/// Says what ufbx found and what to do about it.
fn explain(error: &ufbx::Error, bytes: &[u8]) -> String {
    use ufbx::ErrorType;
    let found = &*error.description;
    let is_of_content = matches!(error.type_, ErrorType::TruncatedFile | ErrorType::EmptyFile | ErrorType::Unknown);
    if is_of_content && let Some(problem) = cut::problem(bytes) {
        return problem;
    }
    match error.type_ {
        ErrorType::UnrecognizedFileFormat | ErrorType::FeatureDisabled => NOT_FBX.to_owned(),
        ErrorType::TruncatedFile => {
            "the FBX file ends too early: expected more bytes. Download or export it again.".to_owned()
        }
        ErrorType::UnsupportedVersion => {
            let version = error.info();
            // Other lengths come from damaged headers: every real version has four digits.
            let what = if version.len() == 4 { "this is FBX" } else { "the FBX file is damaged: it states" };
            format!(
                "{what} version {version}, expected 3000 to 7700. Export it again, as FBX 2014 to 2020 or glTF (.glb)."
            )
        }
        ErrorType::MemoryLimit | ErrorType::AllocationLimit | ErrorType::OutOfMemory => format!(
            "the FBX file needs too much memory: expected at most {MAX_SCENE_BYTES} bytes. Export a part of the scene."
        ),
        ErrorType::NodeDepthLimit => format!(
            "the FBX file nests objects too deeply: expected at most {MAX_DEPTH} levels. Flatten its hierarchy."
        ),
        _ => {
            let info = error.info();
            let detail = if info.is_empty() { String::new() } else { format!(" ({info})") };
            format!("the FBX file is damaged: {found}{detail}. Export it again, or try another FBX version.")
        }
    }
}

fn limit(memory_limit: usize) -> RawAllocatorOpts {
    RawAllocatorOpts { memory_limit, allocation_limit: MAX_ALLOCATIONS, ..RawAllocatorOpts::default() }
}

/// One attribute of all vertices.
pub struct Stream<'a> {
    raw: RawVertexStream,
    attribute: PhantomData<&'a mut [u8]>,
}

/// Returns a stream over an attribute of plain numbers.
pub fn stream<T: Copy>(attribute: &mut [T]) -> Stream<'_> {
    let raw = RawVertexStream {
        data: attribute.as_mut_ptr().cast(),
        vertex_count: attribute.len(),
        vertex_size: size_of::<T>(),
    };
    Stream { raw, attribute: PhantomData }
}

/// Merges vertices that agree in all streams: moves the different ones to the front, writes the number of each into
/// `indices` and returns their count.
pub fn merge(streams: &mut [Stream], indices: &mut [u32]) -> Result<usize, String> {
    let raw: Vec<RawVertexStream> = streams.iter().map(|stream| RawVertexStream { ..stream.raw }).collect();
    if raw.iter().any(|stream| stream.vertex_count < indices.len()) {
        return Err("a mesh has attributes of different lengths: export it again.".to_owned());
    }
    // SAFETY: each stream is a slice that is borrowed mutably until the call returns, and at least as long as `indices`.
    unsafe { ufbx::generate_indices_raw(&raw, indices, &limit(MAX_TEMPORARY_BYTES)) }
        .map_err(|error| format!("a mesh is too large to convert: {}.", &*error.description))
}
