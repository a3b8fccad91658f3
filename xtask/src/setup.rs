//! Installs missing tools; a no-op when everything is present.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use crate::process::{output, repository, run};
use crate::python;

const WASM: &str = "wasm32-unknown-unknown";

/// Everything needed to build the page.
pub fn page() -> anyhow::Result<()> {
    if !has_wasm_target() {
        run("rustup", &["target", "add", WASM])
            .context("Rust's wasm32-unknown-unknown target is missing and rustup couldn't add it")?;
    }
    npm_packages()
}

/// What the tests need on top of [`page`]: a browser, ffmpeg, a software Vulkan driver and Python with some packages.
pub fn tests() -> anyhow::Result<()> {
    let missing = missing_packages();
    if !missing.is_empty() {
        system_packages(&missing)?;
    }
    python::setup()
}

/// Installs system packages where that takes no password; otherwise the error has the command.
pub fn system_packages(missing: &[&str]) -> anyhow::Result<()> {
    let names = missing.join(" ");
    if !cfg!(target_os = "linux") || output("apt-get", &["--version"]).is_none() {
        bail!("missing: {names}. Install the equivalents for this system, and set CHROMIUM to the browser's path");
    }
    let is_root = output("id", &["-u"]).as_deref() == Some("0");
    if !is_root && output("sudo", &["-n", "true"]).is_none() {
        bail!("missing: {names}. Install with: sudo apt-get install --no-install-recommends {names}");
    }
    let (program, first): (&str, &[&str]) = if is_root { ("apt-get", &[]) } else { ("sudo", &["-n", "apt-get"]) };
    run(program, &[first, &["update"]].concat())?;
    run(program, &[first, &["install", "--yes", "--no-install-recommends"], missing].concat())
}

fn missing_packages() -> Vec<&'static str> {
    let mut missing = Vec::new();
    if chromium().is_none() {
        missing.push(if is_ubuntu() { "chromium-browser" } else { "chromium" });
    }
    if output("ffmpeg", &["-version"]).is_none() {
        missing.push("ffmpeg");
    }
    if !python::is_present() {
        missing.push("python3-venv");
    }
    if cfg!(target_os = "linux") {
        if !has_vulkan_driver() {
            missing.push("mesa-vulkan-drivers");
        }
        if !has_library("libvulkan.so.1") {
            missing.push("libvulkan1");
        }
    }
    missing
}

/// The browser that the tests drive.
pub fn chromium() -> Option<PathBuf> {
    const COMMON_PATHS: [&str; 6] = [
        "/usr/bin/chromium",
        "/usr/bin/chromium-browser",
        "/usr/bin/google-chrome",
        "/snap/bin/chromium",
        "/Applications/Chromium.app/Contents/MacOS/Chromium",
        "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    ];
    let named = std::env::var_os("CHROMIUM").map(PathBuf::from);
    named.into_iter().chain(COMMON_PATHS.map(PathBuf::from)).find(|path| path.exists())
}

fn is_ubuntu() -> bool {
    fs::read_to_string("/etc/os-release").is_ok_and(|release| release.lines().any(|line| line == "ID=ubuntu"))
}

fn has_wasm_target() -> bool {
    output("rustc", &["--print", "target-libdir", "--target", WASM]).is_some_and(|folder| Path::new(&folder).exists())
}

fn npm_packages() -> anyhow::Result<()> {
    let installed = repository().join("node_modules/.package-lock.json");
    let modified = |path: &Path| fs::metadata(path).and_then(|metadata| metadata.modified()).ok();
    if modified(&installed).is_some_and(|then| Some(then) >= modified(&repository().join("package-lock.json"))) {
        return Ok(());
    }
    let npm = if cfg!(windows) { "npm.cmd" } else { "npm" };
    run(npm, &["ci", "--no-audit", "--no-fund"]).context("Node.js 20.19 or later with npm is required")
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
