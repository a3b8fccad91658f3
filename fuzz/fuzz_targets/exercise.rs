//! Reads any bytes as the files of a skinning exercise: four texts separated by 0xFF are the .obj, .skel, .attach and .mtl of
//! one model. What the loader returns must be consistent, and it must not panic, hang or use unbounded memory.
//!
//! `cargo +nightly fuzz run exercise -- -max_len=20000 -rss_limit_mb=4096`

#![no_main]

use gaitway::formats::{FileSet, LoadOptions, convert, load, missing_files};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let mut files = FileSet::default();
    for (name, text) in ["m.obj", "m.skel", "m.attach", "m.mtl"].into_iter().zip(bytes.split(|byte| *byte == 0xFF)) {
        files.insert(name, text.to_vec());
    }
    let _ = missing_files(&files);
    let Ok(asset) = load(&files) else { return };
    let skin_joints = asset.skins.first().map(|skin| skin.joints().len());
    for mesh in &asset.meshes {
        for geometry in &mesh.primitives {
            geometry.validate(skin_joints).expect("a loaded model is consistent");
            assert!(geometry.file_vertex.iter().all(|&vertex| (vertex as usize) < mesh.file_vertex_count()));
        }
    }
    let written = convert(&files, &LoadOptions::default()).expect("a loaded model can be written");
    let mut files = FileSet::default();
    files.insert("written.glb", written);
    load(&files).expect("a written model can be loaded");
});
