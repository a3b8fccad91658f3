//! Measures the page's download and leaves compressed copies beside the files.
//!
//! Most of a program is not ours: egui, its text, wgpu and the standard library. The text font takes 19 KB (Latin, see
//! assets/font); the browser draws other scripts and decodes all textures but KTX2.

use std::path::Path;

use crate::process::{run, target_folder, text};

/// Limits in bytes, compressed with brotli: of the shell together with each program, and of each part by itself.
const MAX_BYTES: [(&str, u32); 15] = [
    ("webgpu", 1_450_000),
    ("webgl2", 1_900_000),
    ("parts/draco", 65_000),
    ("parts/fbx", 140_000),
    ("parts/fbx-writer", 400_000),
    ("parts/ktx2", 87_000),
    ("parts/meshopt", 20_000),
    ("parts/npz", 94_000),
    ("parts/qr", 18_000),
    ("parts/validator", 86_000),
    ("parts/video", 56_000),
    ("parts/standalone-webgl2", 1_950_000),
    ("parts/standalone-webgpu", 1_520_000),
    ("parts/web-page", 3_000),
    ("parts/x", 60_000),
];

/// If `limited`, fails when anything exceeds [`MAX_BYTES`].
pub fn compress_and_print(limited: bool, dist: &Path) -> anyhow::Result<()> {
    let kept = target_folder().join("compressed");
    let limit = |bytes: u32| if limited { bytes.to_string() } else { "Infinity".to_owned() };
    let limits = MAX_BYTES.map(|(name, bytes)| format!("{name}={}", limit(bytes)));
    run(
        "node",
        &[&["xtask/site/sizes.mjs", text(dist)?, text(&kept)?], &limits.each_ref().map(String::as_str)[..]].concat(),
    )
}
