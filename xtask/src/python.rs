//! The Python package: sets up a virtual environment in the target folder, and lints, builds and tests the package there. A test of
//! written BVH files uses Blender's module from it.

use std::fs;
use std::path::PathBuf;

use anyhow::Context;

use crate::process::{output, repository, run, run_with, target_folder, text};

/// The environment's packages: a list in `python`, copied into the environment once they are installed.
const REQUIREMENTS: &str = "requirements.txt";
/// Large packages for one test each.
const LARGE: [(&str, &str); 3] = [
    ("Ray", "requirements-ray.txt"),
    ("Blender", "requirements-blender.txt"),
    ("a notebook", "requirements-notebook.txt"),
];

const PYTHON: &str = if cfg!(windows) { "python" } else { "python3" };

/// Whether there is a Python that can make virtual environments.
pub fn is_present() -> bool {
    output(PYTHON, &["-c", "import ensurepip, venv"]).is_some()
}

/// Returns an interpreter that has pip, if there is Python: the system's or, where distributions leave pip out of it, the
/// environment's.
pub fn with_pip() -> Option<String> {
    let has_pip = |python: &String| output(python, &["-m", "pip", "--version"]).is_some();
    let own = interpreter().ok()?;
    let found = [PYTHON.to_owned(), own.clone()].into_iter().find(has_pip);
    found.or_else(|| (is_present() && make_environment().is_ok()).then_some(own))
}

/// Makes the environment. Without Ray or Blender, its test is skipped, and the next call tries again.
pub fn setup() -> anyhow::Result<()> {
    if output(&program("python")?, &["--version"]).is_none() || !is_installed(REQUIREMENTS) {
        make_environment()?;
        install(REQUIREMENTS)?;
    }
    for (name, requirements) in LARGE {
        if !is_installed(requirements)
            && let Err(error) = install(requirements)
        {
            eprintln!("warning: {error:#}; the test with {name} is skipped");
        }
    }
    Ok(())
}

/// Returns the path of the environment's interpreter, whether or not it is there.
pub fn interpreter() -> anyhow::Result<String> {
    program("python")
}

/// Format and lints of the Python code.
pub fn check() -> anyhow::Result<()> {
    let ruff = program("ruff")?;
    run(&ruff, &["format", "--check", "python"])?;
    run(&ruff, &["check", "python"])
}

/// Builds the package like the other programs, installs it in the environment and runs its tests, which compare it with `cli`.
pub fn test(cli: &str) -> anyhow::Result<()> {
    let build = ["develop", "--locked", "--quiet", "--manifest-path", "python/Cargo.toml"];
    run_with(&program("maturin")?, &build, &[("VIRTUAL_ENV", text(&environment())?)])?;
    run_with(&program("python")?, &["-m", "pytest", "--quiet", "python"], &[("GAITWAY_CLI", cli)])
}

fn make_environment() -> anyhow::Result<()> {
    run(PYTHON, &["-m", "venv", "--clear", text(&environment())?])
}

fn environment() -> PathBuf {
    target_folder().join("python")
}

/// Returns the path of one of the environment's programs.
fn program(name: &str) -> anyhow::Result<String> {
    let folder = environment().join(if cfg!(windows) { "Scripts" } else { "bin" });
    Ok(text(&folder.join(format!("{name}{}", std::env::consts::EXE_SUFFIX)))?.to_owned())
}

fn is_installed(requirements: &str) -> bool {
    let wanted = fs::read(repository().join("python").join(requirements));
    wanted.is_ok_and(|wanted| fs::read(environment().join(requirements)).is_ok_and(|installed| installed == wanted))
}

fn install(requirements: &str) -> anyhow::Result<()> {
    let wanted = repository().join("python").join(requirements);
    let pip =
        ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--only-binary", ":all:", "--requirement"];
    run(&program("python")?, &[&pip[..], &[text(&wanted)?]].concat())?;
    fs::copy(&wanted, environment().join(requirements)).with_context(|| requirements.to_owned())?;
    Ok(())
}
