//! The page: trunk compiles and binds, wasm-opt and esbuild make it smaller, the length of the program is written down so that
//! the page can show how far its loading has got, and `xtask/site` puts samples, pictures and the service worker beside it.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;

use crate::process::{repository, run};

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
    let features = features.join(",");
    let mut arguments = vec!["build", "--offline"];
    if !features.is_empty() {
        arguments.extend(["--features", &features]);
    }
    run("trunk", &arguments)?;
    let wasm = file_with_suffix("_bg.wasm")?;
    optimise(&wasm)?;
    rename_imports(&wasm)?;
    write_length(&wasm)?;
    let dist = dist();
    let folder = dist.to_str().context("the repository's path is not UTF-8")?;
    run("node", &["xtask/site/scripts.mjs", folder])?;
    let mut arguments = vec!["xtask/site/finish.mjs", folder];
    arguments.extend(url);
    run("node", &arguments)
}

fn optimise(wasm: &Path) -> anyhow::Result<()> {
    let file = wasm.to_str().context("the repository's path is not UTF-8")?;
    run(
        "node",
        &[&["node_modules/binaryen/bin/wasm-opt", "--gufa", "-Oz"], &WASM_FEATURES[..], &[file, "-o", file]].concat(),
    )
}

/// The script has the program's name with another suffix.
fn rename_imports(wasm: &Path) -> anyhow::Result<()> {
    let program = wasm.to_str().context("the repository's path is not UTF-8")?;
    let script = program.replace("_bg.wasm", ".js");
    run("node", &["xtask/site/imports.mjs", program, &script])
}

/// If the host sends the program compressed, its Content-Length isn't the length that the page counts up to.
fn write_length(wasm: &Path) -> anyhow::Result<()> {
    let index = dist().join("index.html");
    let length = fs::metadata(wasm)?.len();
    let html = fs::read_to_string(&index).context("dist/index.html")?;
    let marked = html.replacen(" data-wasm=", &format!(" data-bytes=\"{length}\" data-wasm="), 1);
    anyhow::ensure!(marked != html, "dist/index.html doesn't name the program: see pattern_script in Trunk.toml");
    Ok(fs::write(&index, marked)?)
}

fn file_with_suffix(suffix: &str) -> anyhow::Result<PathBuf> {
    let mut paths = files()?.into_iter();
    let found = paths.find(|path| path.to_str().is_some_and(|path| path.ends_with(suffix)));
    found.with_context(|| format!("trunk left no *{suffix} in dist/"))
}

fn files() -> anyhow::Result<Vec<PathBuf>> {
    let entries = fs::read_dir(dist()).context("dist/")?;
    Ok(entries.filter_map(|entry| Some(entry.ok()?.path())).collect())
}
