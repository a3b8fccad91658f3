//! How large the page is on its way: with both back ends at most 1.9 MB. Compressed copies are left beside the files.

use anyhow::Context;

use crate::page::dist;
use crate::process::run;

const MOST_BYTES: &str = "1900000";

/// `limited`: fails when it is more than that.
pub fn compress_and_print(limited: bool) -> anyhow::Result<()> {
    let dist = dist();
    let folder = dist.to_str().context("the repository's path is not UTF-8")?;
    run("node", &["xtask/site/sizes.mjs", folder, if limited { MOST_BYTES } else { "Infinity" }])
}
