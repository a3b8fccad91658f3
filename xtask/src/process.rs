//! Running other programs, from the repository's root, with everything they need on the path.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context, bail};

/// The checkout that `cargo xtask` was called in. Asked for when running: two checkouts that share a target folder also
/// share this program, and what was compiled in would be the other one's path.
pub fn repository() -> PathBuf {
    let package =
        std::env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| env!("CARGO_MANIFEST_DIR").into(), PathBuf::from);
    package.parent().unwrap_or(Path::new(".")).to_owned()
}

/// Where cargo builds. On a CI machine the checkout is fresh each time, so builds are kept outside of it.
pub fn target_folder() -> PathBuf {
    if let Some(folder) = std::env::var_os("CARGO_TARGET_DIR") {
        return repository().join(folder);
    }
    let in_ci = std::env::var("CI").is_ok_and(|ci| ci == "true" || ci == "1");
    match std::env::var_os("HOME") {
        Some(home) if in_ci => Path::new(&home).join(".cache/gaitway/target"),
        _ => repository().join("target"),
    }
}

/// Programs that were installed for this repository alone, so that nobody's own versions are replaced.
pub fn tools_folder() -> PathBuf {
    target_folder().join("tools")
}

pub fn command(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::iter::once(tools_folder().join("bin")).chain(std::env::split_paths(&path));
    if let Ok(path) = std::env::join_paths(folders) {
        command.env("PATH", path);
    }
    // trunk takes NO_COLOR=1 for an option with a wrong value.
    command.env_remove("NO_COLOR").env("CARGO_TARGET_DIR", target_folder()).current_dir(repository());
    command
}

/// Says what is run, runs it, and fails when it does.
pub fn run(program: &str, arguments: &[&str]) -> anyhow::Result<()> {
    run_with(program, arguments, &[])
}

/// As [`run`], with environment variables.
pub fn run_with(program: &str, arguments: &[&str], variables: &[(&str, &str)]) -> anyhow::Result<()> {
    let set: String = variables.iter().map(|(name, value)| format!("{name}=\"{value}\" ")).collect();
    let shown = format!("{set}{program} {}", arguments.join(" "));
    eprintln!("\n> {shown}");
    let start = Instant::now();
    let status = command(program)
        .args(arguments)
        .envs(variables.iter().copied())
        .status()
        .with_context(|| format!("{program} could not be started"))?;
    eprintln!("  {:.1} s", start.elapsed().as_secs_f32());
    if !status.success() {
        bail!("{shown}: {status}");
    }
    Ok(())
}

/// What a program prints; none when it is not there or fails.
pub fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = command(program).args(arguments).stdin(Stdio::null()).stderr(Stdio::null()).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
