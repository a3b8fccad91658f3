//! Measures the page's download and leaves compressed copies beside the files.

use anyhow::Context;

use crate::page::dist;
use crate::process::run;

/// Compressed with brotli: the shell and the program for WebGPU, and for WebGL2.
const MAX_BYTES: [&str; 2] = ["1250000", "1700000"];

/// If `limited`, fails when the page exceeds [`MAX_BYTES`].
pub fn compress_and_print(limited: bool) -> anyhow::Result<()> {
    let dist = dist();
    let folder = dist.to_str().context("the repository's path is not UTF-8")?;
    let limits = if limited { MAX_BYTES } else { ["Infinity"; 2] };
    run("node", &[&["xtask/site/sizes.mjs", folder], &limits[..]].concat())
}
