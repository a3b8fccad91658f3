//! Installs missing tools; a no-op when everything is present.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use crate::process::{is_ci, output, repository, run, tools_folder};

const WASM: &str = "wasm32-unknown-unknown";

/// Everything needed to build the page.
pub fn page() -> anyhow::Result<()> {
    if !has_wasm_target() {
        run("rustup", &["target", "add", WASM])
            .context("Rust's wasm32-unknown-unknown target is missing and rustup couldn't add it")?;
    }
    wasm_bindgen()?;
    npm_packages()
}

/// Whether there is a C compiler for wasm, which the page's FBX reader needs.
pub fn has_clang() -> bool {
    output("clang", &["--version"]).is_some()
}

/// What the tests need on top of [`page`]: a browser, a software Vulkan driver and clang. These are system packages, so they
/// are installed only on a CI machine; anyone else is told the command.
pub fn tests() -> anyhow::Result<()> {
    let missing = missing_packages();
    if missing.is_empty() {
        return Ok(());
    }
    let names = missing.join(" ");
    if !cfg!(target_os = "linux") || output("apt-get", &["--version"]).is_none() {
        bail!("missing: {names}. Install the equivalents for this system, and set CHROMIUM to the browser's path");
    }
    if !is_ci() {
        bail!("missing: {names}. Install with: sudo apt-get install --no-install-recommends {names}");
    }
    let is_root = output("id", &["-u"]).as_deref() == Some("0");
    let (program, first): (&str, &[&str]) = if is_root { ("apt-get", &[]) } else { ("sudo", &["-n", "apt-get"]) };
    run(program, &[first, &["update"]].concat())?;
    run(program, &[first, &["install", "--yes", "--no-install-recommends"], &missing].concat())
}

fn missing_packages() -> Vec<&'static str> {
    let mut missing = Vec::new();
    if chromium().is_none() {
        missing.push("chromium");
    }
    if cfg!(target_os = "linux") {
        if !has_clang() {
            missing.push("clang");
        }
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

fn has_wasm_target() -> bool {
    output("rustc", &["--print", "target-libdir", "--target", WASM]).is_some_and(|folder| Path::new(&folder).exists())
}

/// Makes sure that wasm-bindgen has the library's version: uses one that is on the path, else downloads a binary if
/// cargo-binstall is installed, else compiles it, which takes a minute or two.
fn wasm_bindgen() -> anyhow::Result<()> {
    let version = locked_version("wasm-bindgen")?;
    if has_wasm_bindgen(&version) {
        return Ok(());
    }
    let tools = tools_folder();
    let tools = tools.to_str().context("the target folder's path is not UTF-8")?;
    let [download, compile] = wasm_bindgen_installations(&version, tools);
    if output("cargo", &["binstall", "-V"]).is_some() {
        match run("cargo", &download) {
            Ok(()) if has_wasm_bindgen(&version) => return Ok(()),
            Ok(()) => eprintln!("cargo binstall left no wasm-bindgen {version}; compiling it"),
            Err(error) => eprintln!("{error:#}; compiling wasm-bindgen instead"),
        }
    }
    run("cargo", &compile)
}

/// The arguments of cargo that download wasm-bindgen into a folder, and those that compile it.
fn wasm_bindgen_installations<'a>(version: &'a str, tools: &'a str) -> [Vec<&'a str>; 2] {
    // Without `--locked`: its own lock file has an older library.
    let package = ["--version", version, "--root", tools, "wasm-bindgen-cli"];
    [&["binstall", "--no-confirm"][..], &["install"]].map(|first| [first, &package].concat())
}

fn has_wasm_bindgen(version: &str) -> bool {
    output("wasm-bindgen", &["--version"]).is_some_and(|printed| reports_version(&printed, version))
}

/// `wasm-bindgen 0.2.130 (…)`.
fn reports_version(printed: &str, version: &str) -> bool {
    printed.split_whitespace().nth(1) == Some(version)
}

fn locked_version(package: &str) -> anyhow::Result<String> {
    let lock = fs::read_to_string(repository().join("Cargo.lock")).context("Cargo.lock")?;
    let entry = lock.split("[[package]]").find(|entry| entry.contains(&format!("name = \"{package}\"\n")));
    let version = entry.and_then(|entry| entry.split("version = \"").nth(1)).and_then(|rest| rest.split('"').next());
    version.map(str::to_owned).with_context(|| format!("Cargo.lock has no {package}"))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tool_of_another_version_does_not_count() {
        assert!(reports_version("wasm-bindgen 0.2.130", "0.2.130"));
        assert!(reports_version("wasm-bindgen 0.2.130 (0123abc 2026-01-01)", "0.2.130"));
        assert!(!reports_version("wasm-bindgen 0.2.13", "0.2.130"));
        assert!(!reports_version("wasm-bindgen", "0.2.130"));
    }

    /// Calls a `cargo-binstall` that writes down its arguments.
    #[cfg(unix)]
    #[test]
    fn cargo_binstall_is_asked_for_the_librarys_version() {
        use std::os::unix::fs::PermissionsExt;

        let folder = tools_folder().join(format!("binstall-test-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let (script, arguments) = (folder.join("cargo-binstall"), folder.join("arguments"));
        fs::write(&script, format!("#!/bin/sh\necho \"$*\" > '{}'\n", arguments.display())).unwrap();
        fs::set_permissions(&script, fs::Permissions::from_mode(0o755)).unwrap();
        let path = std::env::var_os("PATH").unwrap_or_default();
        let path = std::env::join_paths([folder.clone()].into_iter().chain(std::env::split_paths(&path))).unwrap();
        let version = locked_version("wasm-bindgen").unwrap();
        let [download, compile] = wasm_bindgen_installations(&version, "/tools");
        let status = std::process::Command::new("cargo").args(download).env("PATH", path).status().unwrap();
        let written = fs::read_to_string(&arguments);
        fs::remove_dir_all(&folder).unwrap();
        assert!(status.success());
        let expected = format!("--version {version} --root /tools wasm-bindgen-cli");
        // Cargo passes the name of the subcommand on.
        assert_eq!(written.unwrap().trim(), format!("binstall --no-confirm {expected}"));
        assert_eq!(compile.join(" "), format!("install {expected}"));
    }
}
