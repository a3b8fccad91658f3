//! The C compiler for wasm, which the page's FBX reader needs: clang or, where there is none, that of PyPI's `ziglang`, which is
//! installed in the target folder.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, ensure};

use crate::process::{output, run, target_folder, text};
use crate::{python, setup};

/// It contains clang 22, as `zig clang`. `zig cc` doesn't know the target.
const PACKAGE: &str = "ziglang==0.17.1";

/// The variable with which `.cargo/config.toml` chooses the compiler, unless the environment sets it.
const CC: &str = "CC_wasm32_unknown_unknown";

/// Environment variables that make cargo use a compiler.
pub type Variables = Vec<(&'static str, String)>;

/// Returns how to use clang, which is installed first if there is none.
pub fn for_wasm() -> anyhow::Result<Variables> {
    let clang = std::env::var(CC).unwrap_or_else(|_| "clang".to_owned());
    // Apple's doesn't.
    if knows_wasm(&clang, &[]) {
        return Ok(Vec::new());
    }
    ziglang().context(
        "clang for wasm32 is missing and couldn't be installed: install it, or Python with pip, and build again",
    )
}

fn knows_wasm(program: &str, first: &[&str]) -> bool {
    output(program, &[first, &["--print-targets"]].concat()).is_some_and(|targets| targets.contains("wasm32"))
}

fn ziglang() -> anyhow::Result<Variables> {
    let packages = target_folder().join(PACKAGE.replace("==", "-"));
    let folder = packages.join("ziglang");
    let zig = folder.join(format!("zig{}", std::env::consts::EXE_SUFFIX));
    let is_ready = || Ok::<_, anyhow::Error>(knows_wasm(text(&zig)?, &["clang"]));
    if !is_ready()? {
        // What an interrupted installation left.
        let _ = fs::remove_dir_all(&packages);
        if python::with_pip().is_none() {
            setup::system_packages(&["python3-venv"])?;
        }
        let python = python::with_pip().context("there is no Python with pip")?;
        let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--only-binary", ":all:"];
        run(&python, &[&pip[..], &["--no-deps", "--target", text(&packages)?, PACKAGE]].concat())?;
        ensure!(is_ready()?, "{} doesn't run", zig.display());
    }
    // The compiler's path would be split at spaces, so it is found on PATH; clang alone doesn't find its headers there.
    let headers = text(&folder.join("lib/include"))?.to_owned();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(std::iter::once(folder).chain(std::env::split_paths(&path)))?;
    let path = text(&PathBuf::from(path))?.to_owned();
    let archiver = ("AR_wasm32_unknown_unknown", "zig ar".to_owned());
    Ok(vec![(CC, "zig clang".to_owned()), archiver, ("C_INCLUDE_PATH", headers), ("PATH", path)])
}
