//! Every check and test, the cheap ones first. Node's tests come last: their summary ends the output.

use std::fs;
use std::io::{BufRead, BufReader, IsTerminal, Read};
use std::num::NonZero;
use std::process::Stdio;
use std::thread;

use anyhow::Context;

use crate::process::{self, Step, cli, command, repository, run_with, succeeded, target_folder, text, time_table};
use crate::{packages, page, python, setup, sizes};

pub fn run() -> anyhow::Result<()> {
    setup::page()?;
    setup::tests()?;
    check_scripts()?;
    python::check()?;
    cargo_checks()?;
    let cli = cli();
    let cli = text(&cli)?;
    python::test(cli)?;
    packages::check()?;
    page::build(page::Build::Optimized, &[], None, &page::dist())?;
    sizes::compress_and_print(true, &page::dist())?;
    node_tests(cli)
}

/// Types and lints of the page's, the build's and the tests' scripts.
fn check_scripts() -> anyhow::Result<()> {
    process::run(if cfg!(windows) { "npm.cmd" } else { "npm" }, &["run", "check"])
}

fn cargo_checks() -> anyhow::Result<()> {
    process::run("cargo", &["fmt", "--all", "--check"])?;
    // Without features there is no code that isn't there with them, so it is only compiled.
    let core = ["--no-default-features", "--all-targets"];
    let wasm = ["--target", "wasm32-unknown-unknown", "--features", "bench,webgpu,webgl2"];
    for targets in [&["--workspace", "--all-targets"][..], &core, &wasm] {
        process::run("cargo", &[&["clippy"], targets, &["--", "-D", "warnings"]].concat())?;
    }
    let packages =
        ["", "-character", "-formats", "-json-text", "-retarget", "-session", "-scene", "-render", "-python"];
    let packages = packages.map(|name| format!("--package=gaitway{name}"));
    let packages = packages.each_ref().map(String::as_str);
    let doc = [&["doc", "--no-deps"][..], &packages].concat();
    run_with("cargo", &doc, &[("RUSTDOCFLAGS", "-D warnings")])?;
    // Only `cargo fuzz` runs them; the tests below exercise the same readers briefly.
    process::run("cargo", &["check", "--manifest-path", "fuzz/Cargo.toml"])?;
    test_original_text()?;
    process::run("cargo", &["test", "--workspace"])?;
    // The other tests run the programs: `cargo test` doesn't build all of them. With `--tests`,
    // dependencies keep the features that the tests gave them, so nothing is compiled twice.
    process::run("cargo", &["build", "--workspace", "--bins", "--tests"])
}

/// Builds and tests text without the crates in crates/epaint-text, where `tests/ui/text_widths.rs` then finds it built.
fn test_original_text() -> anyhow::Result<()> {
    let target = target_folder().join("tmp/original-text");
    let manifest = "crates/epaint-text/original/Cargo.toml";
    process::run("cargo", &["test", "--locked", "--manifest-path", manifest, "--target-dir", text(&target)?])
}

/// How many of Node's test files run at once at most: each starts browsers.
const MAX_FILES: usize = 4;

/// Runs the tests in tests/action, tests/three, tests/reference and tests/browser, and prints the time table before their summary.
fn node_tests(cli: &str) -> anyhow::Result<()> {
    let files = node_test_files()?;
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let chromium = setup::chromium().context("there is no browser: set CHROMIUM to its path")?;
    // Each file drives a browser that renders on the CPU and keeps about one core busy. A file takes minutes; one that hangs is killed.
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    let concurrency = format!("--test-concurrency={}", cores.min(MAX_FILES));
    let mut arguments = vec!["--test", &concurrency, "--test-timeout=1200000"];
    let python = std::env::var("GAITWAY_PYTHON").or_else(|_| python::interpreter())?;
    let mut variables = vec![("GAITWAY_CLI", cli), ("CHROMIUM", text(&chromium)?), ("GAITWAY_PYTHON", &python)];
    // Node sees a pipe and would choose the form for programs.
    if std::io::stdout().is_terminal() {
        arguments.push("--test-reporter=spec");
        variables.push(("FORCE_COLOR", "1"));
    } else {
        arguments.push("--test-reporter=tap");
    }
    arguments.push("--test-reporter-destination=stdout");
    // These tests take the longest of all steps. The time of each file is printed beside the output, which ends with the summary.
    arguments.extend(["--test-reporter=./tests/times.mjs", "--test-reporter-destination=stderr"]);
    arguments.extend(files);
    let step = Step::start("node", &arguments, &variables);
    let mut node = command("node").args(&arguments).envs(variables).stdout(Stdio::piped()).spawn()?;
    let summary = node.stdout.take().map(print_up_to_summary).transpose()?;
    let outcome = step.end(succeeded(node.wait()));
    println!("{}", time_table());
    print!("{}", summary.unwrap_or_default());
    outcome
}

/// Passes the test runner's output on as it comes, up to its summary, which is returned.
fn print_up_to_summary(output: impl Read) -> anyhow::Result<String> {
    let mut output = BufReader::new(output);
    let (mut line, mut summary) = (Vec::new(), String::new());
    while output.read_until(b'\n', &mut line)? > 0 {
        let text = String::from_utf8_lossy(&line);
        if summary.is_empty() && !is_start_of_summary(&text) {
            print!("{text}");
        } else {
            summary += &text;
        }
        line.clear();
    }
    Ok(summary)
}

/// `# tests 12` or `ℹ tests 12`, in colour or not.
fn is_start_of_summary(line: &str) -> bool {
    let line = line.trim_start_matches("\u{1b}[34m");
    let rest = line.strip_prefix("# tests ").or_else(|| line.strip_prefix("ℹ tests "));
    rest.is_some_and(|rest| rest.starts_with(|first: char| first.is_ascii_digit()))
}

fn node_test_files() -> anyhow::Result<Vec<String>> {
    let mut files = Vec::new();
    for folder in ["tests/action", "tests/three", "tests/reference", "tests/browser"] {
        for entry in fs::read_dir(repository().join(folder)).context(folder)? {
            let name = entry?.file_name();
            if let Some(name) = name.to_str().filter(|name| name.ends_with(".test.mjs")) {
                files.push(format!("{folder}/{name}"));
            }
        }
    }
    files.sort_by_key(|file| (file.starts_with("tests/browser"), file.clone()));
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_summary_is_held_back_in_each_form_node_prints() {
        let tap = "ok 1 - a test\n# tests 12\n# pass 11\n# fail 1\n";
        let spec = "✔ a test (5ms)\n\u{1b}[34mℹ tests 12\u{1b}[39m\nℹ pass 11\n✖ failing tests:\n";
        let plain = "✔ # tests of mine\nℹ tests 12\nℹ pass 11\n";
        for output in [tap, spec, plain] {
            let summary = print_up_to_summary(output.as_bytes()).unwrap();
            assert_eq!(summary, output.split_once('\n').unwrap().1);
        }
    }
}
