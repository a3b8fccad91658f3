//! What is fuzzed: one function per reader, and one for all that follows reading. Whatever it returns must be consistent, and it must
//! not panic, hang or use unbounded memory. The fuzz targets call these with libFuzzer's bytes, and `tests/damage/fuzz.rs` with
//! damaged files for a moment in every test run.

// Each target uses one of them.
#![allow(dead_code)]

#[path = "pipeline.rs"]
mod pipeline;

use gaitway_character::asset::Asset;
use gaitway_formats::{
    Early, FileSet, LoadOptions, Part, convert, early, load, load_with, missing_files, prepare, read_hdr,
};
use gaitway_retarget::JointMapFile;
use gaitway_scene::library::Library;
use gaitway_scene::state::{from_link, to_link};

pub use pipeline::pipeline;

/// A reader's name and its entry point.
pub type Entry = (&'static str, fn(&[u8]));

/// All entries; each has a fuzz target of the same name in `fuzz_targets`.
pub const ENTRIES: [Entry; 14] = [
    ("gltf", gltf),
    ("bvh", bvh),
    ("fbx", fbx),
    ("x", x),
    ("npz", npz),
    ("draco", draco),
    ("meshopt", meshopt),
    ("ktx2", ktx2),
    ("exercise", exercise),
    ("archive", archive),
    ("map", map),
    ("link", link),
    ("hdr", hdr),
    ("pipeline", pipeline),
];

/// A .glb, or a .gltf whose data is inside; also as if its images had not arrived.
pub fn gltf(bytes: &[u8]) {
    match early(bytes) {
        Some(Early::Wait(needed)) => assert!(needed > bytes.len()),
        Some(Early::Ready(glb)) => {
            assert!(glb.len() <= bytes.len());
            let awaiting = LoadOptions { awaits_images: true, ..LoadOptions::default() };
            let _ = load_with(&one("model.glb", &glb), &awaiting);
        }
        None => {}
    }
    check_model(&one("model.gltf", bytes));
}

/// A .bvh.
pub fn bvh(bytes: &[u8]) {
    check_model(&one("motion.bvh", bytes));
}

/// An .fbx, text or binary, read by a library in C.
pub fn fbx(bytes: &[u8]) {
    check_converted(one("model.fbx", bytes));
}

/// A .x, text or binary, compressed or not.
pub fn x(bytes: &[u8]) {
    check_converted(one("model.x", bytes));
}

/// A .npz.
pub fn npz(bytes: &[u8]) {
    check_converted(one("motion.npz", bytes));
}

/// A .glb with compressed meshes, or the decoder's own input.
pub fn draco(bytes: &[u8]) {
    compressed(Part::Draco, bytes);
}

/// A .glb with compressed buffers, or the decoder's own input.
pub fn meshopt(bytes: &[u8]) {
    compressed(Part::Meshopt, bytes);
}

/// The KTX2 decoder's input: a request, then the image.
pub fn ktx2(bytes: &[u8]) {
    compressed(Part::Ktx2, bytes);
}

fn compressed(part: Part, bytes: &[u8]) {
    if bytes.starts_with(b"glTF") {
        check_converted(one("model.glb", bytes));
    } else if let Err(problem) = part.run(bytes) {
        check_problem(&problem);
    }
}

fn check_converted(mut files: FileSet) {
    match prepare(&mut files) {
        Ok(()) => check_model(&files),
        Err(problem) => check_problem(&problem.to_string()),
    }
}

/// Programs report a panic in a part as an error.
fn check_problem(problem: &str) {
    assert!(!problem.contains("unexpectedly"), "{problem}");
}

/// Four texts separated by 0xFF: the .obj, .skel, .attach and .mtl of one model.
pub fn exercise(bytes: &[u8]) {
    let mut files = FileSet::default();
    for (name, text) in ["m.obj", "m.skel", "m.attach", "m.mtl"].into_iter().zip(bytes.split(|byte| *byte == 0xFF)) {
        files.insert(name, text.to_vec());
    }
    check_model(&files);
}

/// A zip archive, or any file without a name: its format is detected from its content.
pub fn archive(bytes: &[u8]) {
    let mut files = FileSet::default();
    if files.add("dropped", bytes.to_vec()).is_ok() {
        check_model(&files);
    }
}

/// A joint map.
pub fn map(bytes: &[u8]) {
    let Ok(mut map) = JointMapFile::from_json(&String::from_utf8_lossy(bytes)) else { return };
    let written = map.to_json().expect("a map that was read can be written");
    let read = JointMapFile::from_json(&written).expect("a written map can be read");
    // serde_json may read the last digit of a huge number differently.
    if (read.crossfade_secs - map.crossfade_secs).abs() <= f64::EPSILON * map.crossfade_secs {
        map.crossfade_secs = read.crossfade_secs;
    }
    assert_eq!(read, map);
}

/// The part of a link after its `#`.
pub fn link(bytes: &[u8]) {
    let (state, _) = from_link(&String::from_utf8_lossy(bytes));
    let library = Library::default();
    let written = to_link(&state, &library);
    assert_eq!(to_link(&from_link(&written).0, &library), written, "a link that was written is read as it is");
}

/// An .hdr image.
pub fn hdr(bytes: &[u8]) {
    let Ok(panorama) = read_hdr(bytes) else { return };
    assert!(panorama.pixels().iter().all(|pixel| pixel.is_finite() && pixel.min_element() >= 0.0));
}

fn one(name: &str, bytes: &[u8]) -> FileSet {
    let mut files = FileSet::default();
    files.insert(name, bytes.to_vec());
    files
}

fn check_model(files: &FileSet) {
    let _ = missing_files(files);
    let Ok(asset) = load(files) else { return };
    check_asset(&asset);
    // A file may be impossible to write, but what is written must be readable.
    if let Ok(written) = convert(files, &LoadOptions::default()) {
        load(&one("written.glb", &written)).expect("a written model can be loaded");
    }
}

fn check_asset(asset: &Asset) {
    for (index, mesh) in asset.meshes.iter().enumerate() {
        let uses = asset.instances.iter().filter(|instance| instance.mesh == index);
        let smallest_skin = uses.filter_map(|instance| Some(asset.skins[instance.skin?].joints().len())).min();
        for geometry in &mesh.primitives {
            geometry.validate(smallest_skin).expect("a loaded model is consistent");
            assert!(geometry.file_vertex.iter().all(|&vertex| (vertex as usize) < mesh.file_vertex_count()));
        }
    }
    assert!(asset.skeleton.rest().locals().all(|local| local.is_finite()));
}
