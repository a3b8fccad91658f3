//! The page: its programs and parts are compiled, bound and optimized here; `xtask/site` makes a site of them.
//!
//! There is one program per back end, since a browser with WebGPU has no use for naga and wgpu's GL back end, a quarter of the
//! download. A quick build has one for both.

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::thread;

use anyhow::{Context, anyhow};
use lzma_rust2::{LzmaOptions, LzmaWriter};
use wasm_bindgen_cli_support::Bindgen;

use crate::clang;
use crate::process::{Step, repository, run, run_with, target_folder, text};

const BACK_ENDS: [&str; 2] = ["webgpu", "webgl2"];

/// The packages in parts/ that are built as separate modules, besides that of [`build_fbx_part`].
const PARTS: [&str; 7] = ["draco", "fbx-writer", "ktx2", "meshopt", "npz", "qr", "x"];

/// Limit on a part's memory. A damaged file must not take all of a tab's.
const MAX_PART_MEMORY: &str = "link-arg=--max-memory=2147483648";

/// How the page is built.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Build {
    /// To be hosted: small and fast.
    Optimized,
    /// To try a change: in a fraction of the time.
    Quick,
}

impl Build {
    /// The profile of cargo.
    fn profile(self) -> &'static str {
        match self {
            Self::Optimized => "web",
            Self::Quick => "quick",
        }
    }

    /// Holds `BACK_END.js`, `BACK_END.wasm` and `parts/PART.wasm`, and of an optimized build `BACK_END.wasm.lzma`.
    fn programs(self) -> PathBuf {
        target_folder().join(match self {
            Self::Optimized => "page",
            Self::Quick => "quick-page",
        })
    }

    fn compiled(self, program: &str) -> PathBuf {
        target_folder().join(format!("wasm32-unknown-unknown/{}/{program}.wasm", self.profile()))
    }

    /// Arguments of cargo.
    fn for_the_page(self) -> anyhow::Result<Vec<String>> {
        let target = ["--locked", "--target", "wasm32-unknown-unknown", "--profile", self.profile()];
        // The box about Gaitway says so.
        let about = (self == Self::Quick).then(|| ["--config".to_owned(), "env.GAITWAY_QUICK_BUILD='1'".to_owned()]);
        let target = target.map(str::to_owned).into_iter();
        Ok(target.chain(without_folders()?).chain(about.into_iter().flatten()).collect())
    }

    /// Compiles a program with these features.
    fn compile(self, features: &[&str]) -> anyhow::Result<()> {
        let features = [&["viewer"], features].concat().join(",");
        let cargo = ["build", "--bin", "gaitway", "--no-default-features", "--features", &features];
        run_cargo(&cargo, &self.for_the_page()?, &[], &[])
    }
}

fn run_cargo(arguments: &[&str], more: &[String], last: &[&str], variables: &[(&str, String)]) -> anyhow::Result<()> {
    let more: Vec<&str> = more.iter().map(String::as_str).collect();
    let variables: Vec<(&str, &str)> = variables.iter().map(|(name, value)| (*name, value.as_str())).collect();
    run_with("cargo", &[arguments, &more, last].concat(), &variables)
}

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

/// Builds the page into a folder. `url` is the site's future URL, for link previews.
pub fn build(build: Build, features: &[&str], url: Option<&str>, dist: &Path) -> anyhow::Result<()> {
    match build {
        Build::Optimized => optimized_programs(features)?,
        Build::Quick => quick_program(features)?,
    }
    PARTS.into_iter().try_for_each(|part| build_part(build, part, &[]))?;
    let without_fbx = build_fbx_part(build)?;
    let programs = build.programs();
    let mut arguments = vec!["xtask/site/finish.mjs", text(dist)?, text(&programs)?];
    arguments.extend(url);
    run("node", &arguments)?;
    if let Some(reason) = without_fbx {
        eprintln!("\nThis page will not open FBX files: {reason:#}");
    }
    Ok(())
}

fn optimized_programs(features: &[&str]) -> anyhow::Result<()> {
    let build = Build::Optimized;
    // Cargo spends most of a build on one core, in link-time optimization: meanwhile another runs wasm-opt on the first program.
    thread::scope(|scope| {
        let mut optimizing = Vec::new();
        for back_end in BACK_ENDS {
            build.compile(&[&[back_end], features].concat())?;
            let made = Made::new(&build.compiled("gaitway"), build.programs().join(format!("{back_end}.wasm")))?;
            if !made.is_up_to_date() {
                made.forget()?;
                bind(build, back_end)?;
                optimizing.push(scope.spawn(move || optimize(back_end, &made)));
            }
        }
        optimizing
            .into_iter()
            .try_for_each(|thread| thread.join().map_err(|_| anyhow!("wasm-opt's thread panicked"))?)
    })
}

/// One program, under the name of each back end.
fn quick_program(features: &[&str]) -> anyhow::Result<()> {
    let build = Build::Quick;
    build.compile(&[&BACK_ENDS, features].concat())?;
    bind(build, "both")?;
    let programs = build.programs();
    for back_end in BACK_ENDS {
        fs::copy(programs.join("both.js"), programs.join(format!("{back_end}.js")))?;
        fs::copy(programs.join("both_bg.wasm"), programs.join(format!("{back_end}.wasm")))?;
    }
    Ok(())
}

/// Serves the built page until the process is stopped.
pub fn serve(port: u16) -> anyhow::Result<()> {
    run("node", &["xtask/site/serve.mjs", text(&dist())?, &port.to_string()])
}

/// Writes the program's JavaScript, and the wasm that goes with it.
fn bind(build: Build, name: &str) -> anyhow::Result<()> {
    let step = Step::start("wasm-bindgen", &[name], &[]);
    let mut bindgen = Bindgen::new();
    bindgen.input_path(build.compiled("gaitway")).out_name(name).typescript(false);
    let bound = bindgen.web(true).and_then(|bindgen| bindgen.generate(build.programs()));
    step.end(bound)
}

fn optimize(back_end: &str, made: &Made) -> anyhow::Result<()> {
    let bound = Build::Optimized.programs().join(format!("{back_end}_bg.wasm"));
    wasm_opt(&bound, &made.wasm)?;
    fs::remove_file(bound)?;
    pack(&made.wasm)?;
    made.remember()
}

/// Packs a program for the pages that have it in their text (xtask/site/standalone.mjs): a quarter smaller than with Deflate.
fn pack(wasm: &Path) -> anyhow::Result<()> {
    let content = fs::read(wasm)?;
    let step = Step::start("lzma", &[text(wasm)?], &[]);
    // More than a program has.
    let options = LzmaOptions { dict_size: 1 << 23, ..LzmaOptions::with_preset(9) };
    let mut writer = LzmaWriter::new_use_header(Vec::new(), &options, Some(content.len() as u64))?;
    writer.write_all(&content)?;
    let packed = writer.finish().and_then(|packed| fs::write(wasm.with_added_extension("lzma"), packed));
    step.end(packed.map_err(Into::into))
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

/// Builds the only part that needs a C compiler. If there is none, the page goes without the part, and the reason is returned.
fn build_fbx_part(build: Build) -> anyhow::Result<Option<anyhow::Error>> {
    match clang::for_wasm() {
        Ok(variables) => build_part(build, "fbx", &variables).map(|()| None),
        Err(reason) => {
            // Left over from an earlier build.
            let _ = fs::remove_file(part_path(build, "fbx"));
            Ok(Some(reason))
        }
    }
}

fn part_path(build: Build, part: &str) -> PathBuf {
    build.programs().join(format!("parts/{part}.wasm"))
}

fn build_part(build: Build, part: &str, variables: &[(&str, String)]) -> anyhow::Result<()> {
    let wasm = part_path(build, part);
    fs::create_dir_all(build.programs().join("parts"))?;
    let package = format!("gaitway-{part}");
    let cargo = ["rustc", "--package", &package, "--bin", &package];
    run_cargo(&cargo, &build.for_the_page()?, &["--", "-C", MAX_PART_MEMORY], variables)?;
    let compiled = build.compiled(&package);
    if build == Build::Quick {
        fs::copy(compiled, wasm)?;
        return Ok(());
    }
    let made = Made::new(&compiled, wasm)?;
    if made.is_up_to_date() {
        return Ok(());
    }
    made.forget()?;
    wasm_opt(&compiled, &made.wasm)?;
    made.remember()
}
