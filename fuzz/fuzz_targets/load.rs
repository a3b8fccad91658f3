//! Loads any bytes as one dropped file. What the loader returns must be consistent, and it must not panic, hang or use
//! unbounded memory.
//!
//! `cargo +nightly fuzz run load -- -max_len=300000 -rss_limit_mb=4096`, with real files in `corpus/load` as seeds.

#![no_main]

use gaitway::formats::{FileSet, LoadOptions, convert, load, missing_files};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let mut files = FileSet::default();
    // Without an extension the format is detected from the bytes, so archives are covered too.
    if files.add("model", bytes.to_vec()).is_err() {
        return;
    }
    let _ = missing_files(&files);
    let Ok(asset) = load(&files) else { return };
    for (index, mesh) in asset.meshes.iter().enumerate() {
        let uses = asset.instances.iter().filter(|instance| instance.mesh == index);
        let smallest_skin = uses.filter_map(|instance| Some(asset.skins[instance.skin?].joints().len())).min();
        for geometry in &mesh.primitives {
            geometry.validate(smallest_skin).expect("a loaded model is consistent");
        }
    }
    // A file may be impossible to write, but what is written must be readable.
    if let Ok(written) = convert(&files, &LoadOptions::default()) {
        let mut files = FileSet::default();
        files.insert("written.glb", written);
        load(&files).expect("a written model can be loaded");
    }
});
