//! Every check and test, cheap ones first. Node's tests come last: their summary is the end of the output.

use std::fs;

use anyhow::Context;

use crate::process::{self, repository, run_with, target_folder};
use crate::{page, setup, sizes};

pub fn run() -> anyhow::Result<()> {
    setup::page()?;
    setup::tests()?;
    check_scripts()?;
    run_cargo()?;
    page::build(&[], None)?;
    sizes::compress_and_print(true)?;
    let files = node_tests()?;
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let target = target_folder();
    let program = target.join("release").join(format!("gaitway{}", std::env::consts::EXE_SUFFIX));
    let program = program.to_str().context("the target folder's path is not UTF-8")?;
    let chromium = setup::chromium().context("there is no browser: set CHROMIUM")?;
    let chromium = chromium.to_str().context("the browser's path is not UTF-8")?;
    // One file at a time: each drives a browser that draws on the processor. A file takes minutes; one that hangs is ended.
    let arguments = [&["--test", "--test-concurrency=1", "--test-timeout=1200000"], files.as_slice()].concat();
    run_with("node", &arguments, &[("GAITWAY_CLI", program), ("CHROMIUM", chromium)])
}

/// Types and lints of the page's, the build's and the tests' scripts.
fn check_scripts() -> anyhow::Result<()> {
    process::run(if cfg!(windows) { "npm.cmd" } else { "npm" }, &["run", "check"])
}

fn run_cargo() -> anyhow::Result<()> {
    process::run("cargo", &["fmt", "--all", "--check"])?;
    let clippy = ["clippy", "--workspace", "--all-targets"];
    process::run("cargo", &[&clippy[..], &["--", "-D", "warnings"]].concat())?;
    let wasm = ["clippy", "--target", "wasm32-unknown-unknown", "--features", "bench"];
    process::run("cargo", &[&wasm[..], &["--", "-D", "warnings"]].concat())?;
    run_with("cargo", &["doc", "--no-deps"], &[("RUSTDOCFLAGS", "-D warnings")])?;
    process::run("cargo", &["test", "--no-default-features"])?;
    process::run("cargo", &["test", "--workspace"])?;
    process::run("cargo", &["build", "--release"])
}

fn node_tests() -> anyhow::Result<Vec<String>> {
    let mut files = Vec::new();
    for folder in ["tests/three", "tests/browser"] {
        for entry in fs::read_dir(repository().join(folder)).context(folder)? {
            let name = entry?.file_name();
            if let Some(name) = name.to_str().filter(|name| name.ends_with(".test.mjs")) {
                files.push(format!("{folder}/{name}"));
            }
        }
    }
    files.sort_by_key(|file| (file.starts_with("tests/browser"), file.clone()));
    Ok(files)
}
