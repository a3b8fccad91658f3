//! Tasks for working on the repository, run as `cargo xtask TASK`. Each task sets up what it needs first.

#![forbid(unsafe_code)]

mod clang;
mod data;
mod packages;
mod page;
mod process;
mod python;
mod setup;
mod sizes;
mod test;
mod trunk;

use std::process::ExitCode;

use anyhow::{Context, bail};
use page::Build;

const USAGE: &str = "\
cargo xtask serve [--port N]   builds the page quickly and serves it on 127.0.0.1 (port 8080)
cargo xtask build [--url URL]  builds the page into dist/, small and fast, for any host; link previews need the URL it will have
cargo xtask build --bench      the same, with the hooks that benches/web measures through
cargo xtask trunk              builds the page for `trunk serve` and `trunk build`, which call it
cargo xtask test               runs every check and test, the cheap ones first
cargo xtask packages           packs the Rust packages of a release and builds the program from them
cargo xtask data               downloads the public test models into ../shared/data (or $GAITWAY_DATA)
cargo xtask pictures           redraws the pictures in README.md, docs/ and the gallery
cargo xtask setup              installs whatever the other tasks need";

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments.as_slice() {
        ["serve"] => serve_page(8080),
        ["serve", "--port", port] => serve_page(port.parse().with_context(|| format!("--port {port}"))?),
        ["build"] => build_page(&[], None),
        ["build", "--url", url] => build_page(&[], Some(&site_url(url)?)),
        ["build", "--bench"] => build_page(&["bench"], None),
        ["pictures"] => redraw_pictures(),
        ["trunk"] => trunk::run(),
        ["test"] => test::run(),
        ["packages"] => packages::check(),
        ["data"] => data::run(),
        ["setup"] => setup::page().and_then(|()| setup::tests()),
        ["help" | "--help" | "-h"] => {
            println!("{USAGE}");
            Ok(())
        }
        [] => bail!("missing subcommand\n{USAGE}"),
        other => bail!("cargo xtask {}: unknown subcommand\n{USAGE}", other.join(" ")),
    }
}

fn build_page(features: &[&str], url: Option<&str>) -> anyhow::Result<()> {
    setup::page()?;
    page::build(Build::Optimized, features, url, &page::dist())?;
    sizes::compress_and_print(features.is_empty(), &page::dist())
}

/// The site's base URL, with the trailing slash that relative URLs need.
fn site_url(url: &str) -> anyhow::Result<String> {
    let is_web = url.starts_with("https://") || url.starts_with("http://");
    anyhow::ensure!(is_web, "--url {url}: expected a URL such as https://example.org/gaitway/");
    Ok(format!("{}/", url.trim_end_matches('/')))
}

fn redraw_pictures() -> anyhow::Result<()> {
    setup::page()?;
    process::run("cargo", &["build", "--workspace", "--bin", "gaitway"])?;
    process::run_with("node", &["xtask/site/pictures.mjs"], &[("GAITWAY_CLI", process::text(&process::cli())?)])
}

fn serve_page(port: u16) -> anyhow::Result<()> {
    setup::page()?;
    page::build(Build::Quick, &[], None, &page::dist())?;
    println!("{}", process::time_table());
    page::serve(port)
}
