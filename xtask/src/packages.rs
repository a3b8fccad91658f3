//! The packages that a release publishes for Rust: packs them all and builds the program from the packed files as those who install
//! it do: outside of the repository, without the crates in crates/epaint-text and the flags of .cargo/config.toml.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use serde_json::Value;

use crate::process::{Step, command, output, run, succeeded, target_folder, text};

pub fn check() -> anyhow::Result<()> {
    let packages = published()?;
    let selected = packages.iter().map(|(name, _)| format!("--package={name}"));
    let selected: Vec<String> = selected.collect();
    // Quiet, since Cargo reports each test that it doesn't pack.
    let cargo = ["package", "--no-verify", "--allow-dirty", "--quiet"].into_iter();
    run("cargo", &cargo.chain(selected.iter().map(String::as_str)).collect::<Vec<_>>())?;

    let folder = target_folder().join("packed");
    let sources = folder.join("sources");
    for (name, version) in &packages {
        unpack(name, version, &folder).with_context(|| format!("the package {name}"))?;
    }
    let lock_file = fs::read_to_string(sources.join("gaitway/Cargo.lock"))?;
    write_if_different(&sources.join("Cargo.toml"), workspace(&packages)?.as_bytes())?;
    write_if_different(&sources.join("Cargo.lock"), lock_file.as_bytes())?;
    // Not with --locked: these packages come from paths instead of the registry. All others are as the lock file says.
    build(&folder)?;
    let built = fs::read_to_string(sources.join("Cargo.lock"))?;
    ensure!(
        without_our_sources(&built) == without_our_sources(&lock_file),
        "the lock file that is published with gaitway doesn't fit it"
    );
    let program = folder.join("target/debug").join(format!("gaitway{}", std::env::consts::EXE_SUFFIX));
    run(text(&program)?, &["inspect", "sample:pilot"])
}

/// Returns the names and versions of the packages that a release publishes.
fn published() -> anyhow::Result<Vec<(String, String)>> {
    let metadata = output("cargo", &["metadata", "--no-deps", "--format-version=1"]).context("cargo metadata")?;
    let metadata: Value = serde_json::from_str(&metadata)?;
    let packages = metadata["packages"].as_array().context("cargo metadata has no packages")?;
    // An empty list of registries says `publish = false`.
    let published = packages.iter().filter(|package| package["publish"].is_null());
    let text = |value: &Value| value.as_str().map(str::to_owned);
    published
        .map(|package| text(&package["name"]).zip(text(&package["version"])).context("a package has no name"))
        .collect()
}

/// Unpacks a package into a folder of its name. Unchanged files keep their times, so that Cargo builds only what has changed.
fn unpack(name: &str, version: &str, folder: &Path) -> anyhow::Result<()> {
    let fresh = folder.join("fresh");
    fs::create_dir_all(&fresh)?;
    let archive = target_folder().join(format!("package/{name}-{version}.crate"));
    let status = command("tar").args(["-xzf", text(&archive)?, "-C", text(&fresh)?]).status();
    succeeded(status).context("tar")?;
    let unpacked = fresh.join(format!("{name}-{version}"));
    let sources = folder.join("sources").join(name);
    let (mut new, mut old) = (BTreeSet::new(), BTreeSet::new());
    files(&unpacked, &unpacked, &mut new)?;
    if sources.exists() {
        files(&sources, &sources, &mut old)?;
    }
    for file in old.difference(&new) {
        fs::remove_file(sources.join(file))?;
    }
    for file in &new {
        write_if_different(&sources.join(file), &fs::read(unpacked.join(file))?)?;
    }
    Ok(fs::remove_dir_all(fresh)?)
}

/// Collects the paths of the files in a folder, relative to `root`.
fn files(root: &Path, folder: &Path, paths: &mut BTreeSet<PathBuf>) -> anyhow::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            files(root, &path, paths)?;
        } else {
            paths.insert(path.strip_prefix(root)?.to_owned());
        }
    }
    Ok(())
}

fn write_if_different(path: &Path, content: &[u8]) -> anyhow::Result<()> {
    if fs::read(path).is_ok_and(|old| old == content) {
        return Ok(());
    }
    fs::create_dir_all(path.parent().unwrap_or(path))?;
    Ok(fs::write(path, content)?)
}

/// Returns the manifest of a workspace in which the packages find each other instead of in the registry.
fn workspace(packages: &[(String, String)]) -> anyhow::Result<String> {
    let mut manifest = "[workspace]\nresolver = \"3\"\nmembers = [\"gaitway\"]\n\n[patch.crates-io]\n".to_owned();
    for (name, _) in packages.iter().filter(|(name, _)| name != "gaitway") {
        writeln!(manifest, "{name} = {{ path = \"{name}\" }}")?;
    }
    manifest.push_str("\n[profile.dev]\ndebug = false\n");
    Ok(manifest)
}

fn build(folder: &Path) -> anyhow::Result<()> {
    let manifest = folder.join("sources/Cargo.toml");
    let arguments = ["build", "--package=gaitway", "--manifest-path", text(&manifest)?];
    let step = Step::start("cargo", &arguments, &[]);
    let mut cargo = command("cargo");
    cargo.args(arguments).env("CARGO_TARGET_DIR", folder.join("target"));
    // Cargo looks for .cargo/config.toml in the current folder and above, and has given its variables to this program.
    cargo.current_dir(std::env::temp_dir()).env_remove("CFLAGS");
    step.end(succeeded(cargo.status()))
}

/// Returns a lock file without the sources and checksums of our packages.
fn without_our_sources(lock_file: &str) -> String {
    let packages = lock_file.split("[[package]]\n").map(|package| {
        let is_ours = package.starts_with("name = \"gaitway");
        let lines = package
            .lines()
            .filter(|line| !is_ours || !(line.starts_with("source = ") || line.starts_with("checksum = ")));
        lines.collect::<Vec<_>>().join("\n")
    });
    packages.collect::<Vec<_>>().join("\n")
}
