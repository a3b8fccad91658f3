//! Runs other programs from the repository's root and records their times.

use std::ffi::OsStr;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use anyhow::{Context, bail};

/// The checkout that `cargo xtask` was called in. Looked up at run time: checkouts that share a target folder also share
/// this program, so the path compiled into it may belong to another one.
pub fn repository() -> PathBuf {
    let package =
        std::env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| env!("CARGO_MANIFEST_DIR").into(), PathBuf::from);
    package.parent().unwrap_or(Path::new(".")).to_owned()
}

pub fn is_ci() -> bool {
    std::env::var("CI").is_ok_and(|ci| ci == "true" || ci == "1")
}

/// Where cargo builds. CI checks out afresh each time, so its builds are kept outside of the checkout.
pub fn target_folder() -> PathBuf {
    if let Some(folder) = std::env::var_os("CARGO_TARGET_DIR") {
        return repository().join(folder);
    }
    match std::env::var_os("HOME") {
        Some(home) if is_ci() => Path::new(&home).join(".cache/gaitway/target"),
        _ => repository().join("target"),
    }
}

/// Where cargo puts the command line.
pub fn cli() -> PathBuf {
    target_folder().join("debug").join(format!("gaitway{}", std::env::consts::EXE_SUFFIX))
}

pub fn command(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    command.env("CARGO_TARGET_DIR", target_folder()).current_dir(repository());
    command
}

/// Prints a command, runs it, and fails if it does.
pub fn run(program: &str, arguments: &[&str]) -> anyhow::Result<()> {
    run_with(program, arguments, &[])
}

/// Like [`run`], with environment variables.
pub fn run_with(program: &str, arguments: &[&str], variables: &[(&str, &str)]) -> anyhow::Result<()> {
    let step = Step::start(program, arguments, variables);
    let status = command(program).args(arguments).envs(variables.iter().copied()).status();
    step.end(succeeded(status))
}

/// A running command, for callers that need more than [`run_with`] offers.
pub struct Step {
    command: String,
    start: Instant,
}

impl Step {
    pub fn start(program: &str, arguments: &[&str], variables: &[(&str, &str)]) -> Self {
        // PATH is long, and its last part is the reader's own.
        let set = variables.iter().filter(|(name, _)| *name != "PATH");
        let set: String = set.map(|(name, value)| format!("{name}=\"{value}\" ")).collect();
        let command = format!("{program} {}", arguments.join(" "));
        eprintln!("\n> {set}{command}");
        Self { command, start: Instant::now() }
    }

    /// Records the time. An error says which command failed.
    pub fn end(self, outcome: anyhow::Result<()>) -> anyhow::Result<()> {
        let took = self.start.elapsed();
        eprintln!("  {:.1} s", took.as_secs_f32());
        let outcome = outcome.with_context(|| self.command.clone());
        if let Ok(mut times) = TIMES.lock() {
            times.push((self.command, took));
        }
        outcome
    }
}

/// Turns the end of a program into an error unless it succeeded.
pub fn succeeded(status: std::io::Result<ExitStatus>) -> anyhow::Result<()> {
    let status = status.context("couldn't run it")?;
    if status.success() { Ok(()) } else { bail!("{status}") }
}

static TIMES: Mutex<Vec<(String, Duration)>> = Mutex::new(Vec::new());

/// Where the time went: every command so far that took a second or more, in order, and the sum of all.
pub fn time_table() -> String {
    TIMES.lock().map(|times| format_times(&times)).unwrap_or_default()
}

fn format_times(times: &[(String, Duration)]) -> String {
    const MAX_CHARS: usize = 90;
    let mut table = "\nWhere the time went:\n".to_owned();
    let mut row = |took: Duration, name: &str| {
        let name: String = name.chars().take(MAX_CHARS).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(table, "{:8.1} s  {name}", took.as_secs_f32());
    };
    let (long, short): (Vec<_>, Vec<_>) = times.iter().partition(|(_, took)| *took >= Duration::from_secs(1));
    for (name, took) in &long {
        row(*took, name);
    }
    if !short.is_empty() {
        row(short.iter().map(|(_, took)| *took).sum(), &format!("{} shorter steps", short.len()));
    }
    row(times.iter().map(|(_, took)| *took).sum(), "in total");
    table
}

/// Returns a path as an argument.
pub fn text(path: &Path) -> anyhow::Result<&str> {
    path.to_str().with_context(|| format!("{} is not UTF-8", path.display()))
}

/// Returns a program's output; none if it is missing or fails.
pub fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = command(program).args(arguments).stdin(Stdio::null()).stderr(Stdio::null()).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_table_lists_long_steps_and_sums_short_ones() {
        let step = |name: &str, millis| (name.to_owned(), Duration::from_millis(millis));
        let table = format_times(&[step("cargo test", 61_250), step("terser a", 400), step("terser b", 450)]);
        let lines: Vec<&str> = table.trim().lines().collect();
        assert_eq!(
            lines,
            ["Where the time went:", "    61.2 s  cargo test", "     0.9 s  2 shorter steps", "    62.1 s  in total"]
        );
    }
}
