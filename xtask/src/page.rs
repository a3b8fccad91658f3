//! The page: one program per back end, compiled, bound and optimized here; `xtask/site` makes a site of them.

use std::fs;
use std::path::PathBuf;
use std::thread;

use anyhow::{Context, anyhow};

use crate::process::{repository, run, target_folder};

const BACK_ENDS: [&str; 2] = ["webgpu", "webgl2"];

/// WebAssembly features that rustc uses today. Every browser with SIMD supports them.
const WASM_FEATURES: [&str; 8] = [
    "--enable-simd",
    "--enable-bulk-memory",
    "--enable-bulk-memory-opt",
    "--enable-nontrapping-float-to-int",
    "--enable-sign-ext",
    "--enable-mutable-globals",
    "--enable-reference-types",
    "--enable-multivalue",
];

pub fn dist() -> PathBuf {
    repository().join("dist")
}

/// `url` is the site's future URL, for link previews.
pub fn build(features: &[&str], url: Option<&str>) -> anyhow::Result<()> {
    // Cargo spends most of a build on one core, in link-time optimization: meanwhile another runs wasm-opt on the first program.
    thread::scope(|scope| {
        let mut optimizing = Vec::new();
        for back_end in BACK_ENDS {
            compile(back_end, features)?;
            optimizing.push(scope.spawn(move || optimize(back_end)));
        }
        optimizing
            .into_iter()
            .try_for_each(|thread| thread.join().map_err(|_| anyhow!("wasm-opt's thread panicked"))?)
    })?;
    let (dist, programs) = (dist(), programs());
    let mut arguments = vec!["xtask/site/finish.mjs", text(&dist)?, text(&programs)?];
    arguments.extend(url);
    run("node", &arguments)
}

/// Holds `BACK_END.js` and `BACK_END.wasm`.
fn programs() -> PathBuf {
    target_folder().join("page")
}

fn compile(back_end: &str, features: &[&str]) -> anyhow::Result<()> {
    let features = [&["viewer", back_end], features].concat().join(",");
    let cargo = ["build", "--locked", "--bin", "gaitway", "--target", "wasm32-unknown-unknown", "--profile", "web"];
    run("cargo", &[&cargo[..], &["--no-default-features", "--features", &features]].concat())?;
    let built = target_folder().join("wasm32-unknown-unknown/web/gaitway.wasm");
    let folder = programs();
    let bind =
        ["--target", "web", "--no-typescript", "--out-name", back_end, "--out-dir", text(&folder)?, text(&built)?];
    run("wasm-bindgen", &bind)
}

fn optimize(back_end: &str) -> anyhow::Result<()> {
    let bound = programs().join(format!("{back_end}_bg.wasm"));
    let optimized = programs().join(format!("{back_end}.wasm"));
    // The second round saves another 5 KB of brotli.
    let wasm_opt = ["node_modules/binaryen/bin/wasm-opt", "--gufa", "-Oz", "--gufa", "-Oz"];
    run("node", &[&wasm_opt, &WASM_FEATURES[..], &[text(&bound)?, "-o", text(&optimized)?]].concat())?;
    Ok(fs::remove_file(bound)?)
}

fn text(path: &std::path::Path) -> anyhow::Result<&str> {
    path.to_str().with_context(|| format!("{} is not UTF-8", path.display()))
}
