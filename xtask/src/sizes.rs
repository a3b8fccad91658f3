//! Measures the page's download and leaves compressed copies beside the files.

use anyhow::Context;

use crate::page::dist;
use crate::process::run;

/// With both back ends, compressed with brotli.
const MAX_BYTES: &str = "1950000";

/// If `limited`, fails when the page exceeds [`MAX_BYTES`].
pub fn compress_and_print(limited: bool) -> anyhow::Result<()> {
    let dist = dist();
    let folder = dist.to_str().context("the repository's path is not UTF-8")?;
    run("node", &["xtask/site/sizes.mjs", folder, if limited { MAX_BYTES } else { "Infinity" }])
}
