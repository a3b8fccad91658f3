//! How large the page is on its way: with both back ends at most 1.9 MB.

use anyhow::Context;

use crate::page::dist;

const MOST_BYTES: &str = "1900000";

pub fn print() -> anyhow::Result<()> {
    let script = include_str!("sizes.mjs");
    let dist = dist();
    let folder = dist.to_str().context("the repository's path is not UTF-8")?;
    run_quietly(&["--input-type=module", "--eval", script, folder, MOST_BYTES])
}

/// Without printing the script.
fn run_quietly(arguments: &[&str]) -> anyhow::Result<()> {
    println!();
    let status = crate::process::command("node").args(arguments).status().context("node could not be started")?;
    anyhow::ensure!(status.success(), "the page is too large");
    Ok(())
}
