//! Installs what is missing; what is there costs a glance.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use crate::process::{output, repository, run, tools_folder};

const TRUNK: &str = "0.21.14";
const WASM: &str = "wasm32-unknown-unknown";

/// What building the page takes.
pub fn page() -> anyhow::Result<()> {
    if !wasm_target_is_there() {
        run("rustup", &["target", "add", WASM])
            .context("Rust's wasm32-unknown-unknown target is missing and rustup could not add it")?;
    }
    cargo_tool("trunk", TRUNK, "trunk", &["--locked"])?;
    // Its version has to be that of the library, and its own lock file knows nothing of that.
    let version = locked_version("wasm-bindgen")?;
    cargo_tool("wasm-bindgen", &version, "wasm-bindgen-cli", &[])?;
    npm_packages()
}

/// What the tests take besides: a browser and a graphics driver in software.
pub fn tests() -> anyhow::Result<()> {
    let mut missing = Vec::new();
    if chromium().is_none() {
        missing.push("chromium");
    }
    if cfg!(target_os = "linux") {
        if !has_vulkan_driver() {
            missing.push("mesa-vulkan-drivers");
        }
        if !has_library("libvulkan.so.1") {
            missing.push("libvulkan1");
        }
    }
    if missing.is_empty() {
        return Ok(());
    }
    let names = missing.join(" ");
    if !cfg!(target_os = "linux") || output("apt-get", &["--version"]).is_none() {
        bail!(
            "missing: {names}. Only apt-get is known here; install them yourself and set CHROMIUM to the browser's path"
        );
    }
    let install = |program: &str, first: &[&str]| -> anyhow::Result<()> {
        run(program, &[first, &["update"]].concat())?;
        run(program, &[first, &["install", "--yes", "--no-install-recommends"], &missing].concat())
    };
    if output("id", &["-u"]).as_deref() == Some("0") {
        install("apt-get", &[])
    } else if output("sudo", &["-n", "true"]).is_some() {
        install("sudo", &["apt-get"])
    } else {
        bail!("missing: {names}. Install them as root: apt-get install {names}")
    }
}

/// The browser that the tests drive.
pub fn chromium() -> Option<PathBuf> {
    const USUAL: [&str; 6] = [
        "/usr/bin/chromium",
        "/usr/bin/chromium-browser",
        "/usr/bin/google-chrome",
        "/snap/bin/chromium",
        "/Applications/Chromium.app/Contents/MacOS/Chromium",
        "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    ];
    let named = std::env::var_os("CHROMIUM").map(PathBuf::from);
    named.into_iter().chain(USUAL.map(PathBuf::from)).find(|path| path.exists())
}

fn wasm_target_is_there() -> bool {
    output("rustc", &["--print", "target-libdir", "--target", WASM]).is_some_and(|folder| Path::new(&folder).exists())
}

fn cargo_tool(program: &str, version: &str, package: &str, options: &[&str]) -> anyhow::Result<()> {
    // `trunk 0.21.14`, `wasm-bindgen 0.2.130 (…)`.
    let found = output(program, &["--version"]);
    if found.is_some_and(|found| found.split_whitespace().nth(1) == Some(version)) {
        return Ok(());
    }
    let tools = tools_folder();
    let root = tools.to_str().context("the target folder's path is not UTF-8")?;
    run("cargo", &[&["install", package, "--version", version, "--root", root], options].concat())
}

fn locked_version(package: &str) -> anyhow::Result<String> {
    let lock = fs::read_to_string(repository().join("Cargo.lock")).context("Cargo.lock")?;
    let entry = lock.split("[[package]]").find(|entry| entry.contains(&format!("name = \"{package}\"\n")));
    let version = entry.and_then(|entry| entry.split("version = \"").nth(1)).and_then(|rest| rest.split('"').next());
    version.map(str::to_owned).with_context(|| format!("Cargo.lock has no {package}"))
}

fn npm_packages() -> anyhow::Result<()> {
    let installed = repository().join("node_modules/.package-lock.json");
    let changed = |path: &Path| fs::metadata(path).and_then(|metadata| metadata.modified()).ok();
    if changed(&installed).is_some_and(|then| Some(then) >= changed(&repository().join("package-lock.json"))) {
        return Ok(());
    }
    let npm = if cfg!(windows) { "npm.cmd" } else { "npm" };
    run(npm, &["ci", "--no-audit", "--no-fund"]).context("Node.js with npm is needed (nodejs and npm, 20 or later)")
}

fn has_vulkan_driver() -> bool {
    let named = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].iter().any(|name| std::env::var_os(name).is_some());
    let folders = ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d"];
    named || folders.iter().any(|folder| fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()))
}

fn has_library(name: &str) -> bool {
    let folders =
        ["/usr/lib", "/lib", "/usr/lib64", "/usr/local/lib", "/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu"];
    folders.iter().any(|folder| Path::new(folder).join(name).exists())
}
