//! The page: one program per back end, compiled, bound and optimized here; `xtask/site` makes a site of them.
//!
//! There are two since a browser with WebGPU has no use for naga and wgpu's GL back end, a quarter of the download.

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::thread;

use anyhow::{Context, anyhow};
use wasm_bindgen_cli_support::Bindgen;

use crate::process::{Step, repository, run, target_folder, text};
use crate::setup;

const BACK_ENDS: [&str; 2] = ["webgpu", "webgl2"];

/// The packages in parts/ that are built as separate modules.
const PARTS: [&str; 7] = ["draco", "fbx", "ktx2", "meshopt", "npz", "qr", "x"];

/// Limit on a part's memory. A damaged file must not take all of a tab's.
const MAX_PART_MEMORY: &str = "link-arg=--max-memory=2147483648";

const FOR_THE_PAGE: [&str; 5] = ["--locked", "--target", "wasm32-unknown-unknown", "--profile", "web"];

/// Removes the builder's folders from panic locations: paths in dependencies begin with the registry's folder.
fn without_folders() -> anyhow::Result<[String; 2]> {
    let cargo_home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let cargo_home = cargo_home.or_else(|| std::env::home_dir().map(|home| home.join(".cargo")));
    let sources = cargo_home.context("there is no home folder: set CARGO_HOME")?.join("registry/src");
    let flag = format!("--remap-path-prefix={}=crates", text(&sources)?);
    Ok(["--config".to_owned(), format!("target.wasm32-unknown-unknown.rustflags=['{flag}']")])
}

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
            let made = Made::new(&compiled("gaitway"), programs().join(format!("{back_end}.wasm")))?;
            if !made.is_up_to_date() {
                made.forget()?;
                bind(back_end)?;
                optimizing.push(scope.spawn(move || optimize(back_end, &made)));
            }
        }
        optimizing
            .into_iter()
            .try_for_each(|thread| thread.join().map_err(|_| anyhow!("wasm-opt's thread panicked"))?)
    })?;
    let (parts, has_clang) = (programs().join("parts"), setup::has_clang());
    PARTS.into_iter().try_for_each(|part| build_part(part, &parts, has_clang))?;
    let (dist, programs) = (dist(), programs());
    let mut arguments = vec!["xtask/site/finish.mjs", text(&dist)?, text(&programs)?];
    arguments.extend(url);
    run("node", &arguments)
}

/// Serves the built page until the process is stopped.
pub fn serve(port: u16) -> anyhow::Result<()> {
    run("node", &["xtask/site/serve.mjs", text(&dist())?, &port.to_string()])
}

/// Holds `BACK_END.js`, `BACK_END.wasm` and `parts/PART.wasm`.
fn programs() -> PathBuf {
    target_folder().join("page")
}

fn compile(back_end: &str, features: &[&str]) -> anyhow::Result<()> {
    let features = [&["viewer", back_end], features].concat().join(",");
    let without_folders = without_folders()?;
    let without_folders = without_folders.each_ref().map(String::as_str);
    let cargo = [&["build", "--bin", "gaitway"], &FOR_THE_PAGE[..], &without_folders].concat();
    run("cargo", &[&cargo[..], &["--no-default-features", "--features", &features]].concat())
}

/// Writes the program's JavaScript, and the wasm that goes with it.
fn bind(back_end: &str) -> anyhow::Result<()> {
    let step = Step::start("wasm-bindgen", &[back_end], &[]);
    let mut bindgen = Bindgen::new();
    bindgen.input_path(compiled("gaitway")).out_name(back_end).typescript(false);
    let bound = bindgen.web(true).and_then(|bindgen| bindgen.generate(programs()));
    step.end(bound)
}

fn optimize(back_end: &str, made: &Made) -> anyhow::Result<()> {
    let bound = programs().join(format!("{back_end}_bg.wasm"));
    wasm_opt(&bound, &made.wasm)?;
    fs::remove_file(bound)?;
    made.remember()
}

/// An optimized program, and what it is made from and how, which is remembered beside it: optimizing takes minutes. Times of files
/// don't tell, since cargo restores earlier builds with other features.
struct Made {
    wasm: PathBuf,
    from: String,
}

impl Made {
    fn new(compiled: &Path, wasm: PathBuf) -> anyhow::Result<Self> {
        let mut hasher = DefaultHasher::new();
        include_str!("page.rs").hash(&mut hasher);
        // It pins wasm-opt; what is compiled tells the version of wasm-bindgen.
        for path in [compiled, &repository().join("package-lock.json")] {
            fs::read(path).with_context(|| path.display().to_string())?.hash(&mut hasher);
        }
        Ok(Self { wasm, from: format!("{:016x}", hasher.finish()) })
    }

    fn note(&self) -> PathBuf {
        self.wasm.with_extension("made-from")
    }

    fn is_up_to_date(&self) -> bool {
        self.wasm.exists() && fs::read_to_string(self.note()).is_ok_and(|from| from == self.from)
    }

    /// To be called before anything that belongs to the program is made again.
    fn forget(&self) -> anyhow::Result<()> {
        if self.note().exists() { Ok(fs::remove_file(self.note())?) } else { Ok(()) }
    }

    fn remember(&self) -> anyhow::Result<()> {
        Ok(fs::write(self.note(), &self.from)?)
    }
}

fn wasm_opt(from: &Path, to: &Path) -> anyhow::Result<()> {
    // By default every function with one caller is inlined, whatever its size: the result compresses worse (20 KB of brotli), and
    // a browser, which compiles a function when it is first called, compiles a whole loader to call its first line.
    // The second round saves another 5 KB.
    // Functions sorted by name lie beside those they resemble, such as the same function for another type: 7 KB.
    // Low addresses are the far end of the stack, so a pointer and a constant never add up to one by overflowing: the constant
    // can be a part of the load, which saves another 7 KB.
    let wasm_opt = [
        "node_modules/binaryen/bin/wasm-opt",
        "--reorder-functions-by-name",
        "--low-memory-unused",
        "--one-caller-inline-max-function-size=50",
        "--gufa",
        "-Oz",
        "--gufa",
        "-Oz",
    ];
    run("node", &[&wasm_opt, &WASM_FEATURES[..], &[text(from)?, "-o", text(to)?]].concat())
}

/// Returns why a part cannot be built, and what the page won't do.
fn omission(part: &str, has_clang: bool) -> Option<&'static str> {
    (part == "fbx" && !has_clang).then_some("clang for wasm32 is missing, so this page will not open FBX files")
}

fn build_part(part: &str, folder: &Path, has_clang: bool) -> anyhow::Result<()> {
    fs::create_dir_all(folder)?;
    let wasm = folder.join(format!("{part}.wasm"));
    if let Some(omission) = omission(part, has_clang) {
        eprintln!("{omission}");
        // Left over from an earlier build.
        let _ = fs::remove_file(wasm);
        return Ok(());
    }
    let package = format!("gaitway-{part}");
    let without_folders = without_folders()?;
    let without_folders = without_folders.each_ref().map(String::as_str);
    let cargo = [&["rustc", "--package", &package, "--bin", &package], &FOR_THE_PAGE[..], &without_folders].concat();
    run("cargo", &[&cargo[..], &["--", "-C", MAX_PART_MEMORY]].concat())?;
    let compiled = compiled(&package);
    let made = Made::new(&compiled, wasm)?;
    if made.is_up_to_date() {
        return Ok(());
    }
    made.forget()?;
    wasm_opt(&compiled, &made.wasm)?;
    made.remember()
}

fn compiled(program: &str) -> PathBuf {
    target_folder().join(format!("wasm32-unknown-unknown/web/{program}.wasm"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_clang_the_page_has_every_part_but_fbx() {
        let omitted = |has_clang| PARTS.into_iter().filter(move |part| omission(part, has_clang).is_some());
        assert_eq!(omitted(true).count(), 0);
        assert_eq!(omitted(false).collect::<Vec<_>>(), ["fbx"]);
        assert!(omission("fbx", false).is_some_and(|omission| omission.contains("FBX")));
        // `finish.mjs` takes whatever is in the folder.
        let folder = std::env::temp_dir().join(format!("gaitway-parts-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("fbx.wasm"), "of an earlier build").unwrap();
        build_part("fbx", &folder, false).unwrap();
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
        fs::remove_dir(&folder).unwrap();
    }
}
