//! What a release publishes: manifests, the workflow and the action agree.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

/// Finds the value between quotes after a key at the start of a line.
fn quoted<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let line = text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = \""))?;
    line.split('"').next()
}

/// Returns the lines of a manifest's table.
fn table<'a>(manifest: &'a str, name: &str) -> &'a str {
    let start = manifest.find(&format!("[{name}]\n")).unwrap_or_else(|| panic!("no table {name}"));
    let body = &manifest[start + name.len() + 3..];
    &body[..body.find("\n[").unwrap_or(body.len())]
}

fn read(path: &str) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Returns the workspace's manifests by the names of their packages.
fn manifests() -> BTreeMap<String, String> {
    let root = read("Cargo.toml");
    let members = root.split("members = [").nth(1).and_then(|rest| rest.split(']').next()).expect("members");
    let members = members.split('"').skip(1).step_by(2).map(|folder| read(&format!("{folder}/Cargo.toml")));
    let manifests: Vec<String> = members.chain([root.clone()]).collect();
    let name = |manifest: &str| quoted(table(manifest, "package"), "name").expect("a name").to_owned();
    manifests.into_iter().map(|manifest| (name(&manifest), manifest)).collect()
}

/// Returns the packages of ours that a manifest depends on, except in tests and in the table of all of them.
fn dependencies(manifest: &str) -> BTreeSet<&str> {
    let tables = manifest.split("\n[").filter(|table| {
        let name = table.split(']').next().unwrap_or_default();
        name.ends_with("dependencies") && !name.ends_with("dev-dependencies") && name != "workspace.dependencies"
    });
    let lines = tables.flat_map(str::lines);
    lines.filter(|line| line.starts_with("gaitway")).filter_map(|line| line.split([' ', '.']).next()).collect()
}

#[test]
fn what_the_program_needs_is_published_and_nothing_else() {
    let manifests = manifests();
    let mut needed = BTreeSet::from(["gaitway"]);
    let mut left = vec!["gaitway"];
    while let Some(name) = left.pop() {
        left.extend(dependencies(&manifests[name]).into_iter().filter(|name| needed.insert(name)));
    }
    assert!(needed.len() > 10, "{needed:?}");
    let is_published = |manifest: &&String| !table(manifest, "package").contains("publish = false");
    let published = manifests.iter().filter(|(_, manifest)| is_published(manifest)).map(|(name, _)| name.as_str());
    assert_eq!(published.collect::<BTreeSet<_>>(), needed);
    for name in &needed {
        let package = table(&manifests[*name], "package");
        for line in ["version.workspace = true", "license.workspace = true", "keywords.workspace = true"] {
            assert!(package.lines().any(|found| found == line), "{name} lacks {line}");
        }
        for key in ["description", "categories", "readme", "include"] {
            assert!(package.lines().any(|line| line.starts_with(key)), "{name} has no {key}");
        }
    }
}

#[test]
fn there_is_one_version() {
    let manifests = manifests();
    let version = quoted(table(&manifests["gaitway"], "workspace.package"), "version").expect("a version");
    // The workflow and the scripts of the npm package and of the action take the first one of the file.
    assert_eq!(quoted(&manifests["gaitway"], "version"), Some(version));
    let ours = table(&manifests["gaitway"], "workspace.dependencies");
    let ours: Vec<&str> = ours.lines().filter(|line| line.starts_with("gaitway")).collect();
    assert!(ours.len() > 10, "{ours:?}");
    for line in ours {
        assert!(line.ends_with(&format!("version = \"{version}\" }}")), "{line}");
    }
    // maturin reads it from the package's manifest.
    assert!(read("python/pyproject.toml").contains("dynamic = [\"version\"]"));
    assert!(table(&manifests["gaitway-python"], "package").contains("version.workspace = true"));
    assert!(read("CHANGELOG.md").contains(&format!("\n## {version}")), "CHANGELOG.md has no section {version}");
}

#[test]
fn archives_are_found_by_the_names_that_the_workflow_gives_them() {
    let (workflow, install) = (read(".github/workflows/release.yml"), read(".github/action/install.sh"));
    let programs = workflow.split("\n  programs:").nth(1).and_then(|rest| rest.split("\n  wheels:").next());
    let programs = programs.expect("the job");
    let targets: Vec<&str> = programs
        .split("target: ")
        .skip(1)
        .filter_map(|rest| rest.split(' ').next())
        .filter(|target| target.contains('-'))
        .collect();
    assert_eq!(targets.len(), 5, "{targets:?}");
    for target in targets {
        let extension = if target.contains("windows") { "zip" } else { "tar.gz" };
        assert!(install.contains(&format!("name=gaitway-{target}.{extension} ")), "install.sh lacks {target}");
    }
    assert!(programs.contains("NAME: gaitway-${{ matrix.target }}"));
    let manifest = read("Cargo.toml");
    let binstall = table(&manifest, "package.metadata.binstall");
    assert!(binstall.contains("/v{ version }/gaitway-{ target }{ archive-suffix }"), "{binstall}");
    assert_eq!(
        quoted(table(&manifest, "package.metadata.binstall.overrides.x86_64-pc-windows-msvc"), "pkg-fmt"),
        Some("zip")
    );
    // Cargo finds the order of the packages.
    assert!(workflow.contains("cargo publish --workspace"));
}
