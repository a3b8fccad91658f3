//! Any bytes as the files of a skinning exercise: four texts with a byte 0xFF between them are the .obj, .skel, .attach and
//! .mtl of one model. Whatever is made of them must be consistent, and nothing may panic, hang or take unbounded memory.
//!
//! `cargo fuzz run exercise -- -max_len=20000 -rss_limit_mb=4096`

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
            geometry.validate(skin_joints).expect("what is read is consistent");
        }
        for &[piece, vertex] in &mesh.file_vertices {
            assert!((vertex as usize) < mesh.primitives[piece as usize].positions.len());
        }
    }
    let written = convert(&files, &LoadOptions::default()).expect("what is read can be written");
    let mut files = FileSet::default();
    files.insert("written.glb", written);
    load(&files).expect("what is written can be read");
});
