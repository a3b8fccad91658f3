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

/// Returns the workflows and the action by their paths.
fn workflows() -> BTreeMap<String, String> {
    let folder = fs::read_dir(".github/workflows").expect("workflows");
    let paths = folder.map(|entry| entry.expect("an entry").path().to_str().expect("a path").to_owned());
    paths.chain(["action.yml".to_owned()]).map(|path| (path.clone(), read(&path))).collect()
}

/// Returns the jobs of a workflow by their names.
fn jobs(workflow: &str) -> BTreeMap<&str, &str> {
    let is_name = |line: &str| line.starts_with("  ") && !line.starts_with("   ") && line.ends_with(':');
    let body = workflow.split("\njobs:\n").nth(1).expect("jobs");
    let starts: Vec<usize> = body
        .match_indices('\n')
        .map(|(at, _)| at + 1)
        .chain([0])
        .filter(|&at| is_name(body[at..].lines().next().unwrap_or_default()))
        .collect();
    let end = |start: usize| starts.iter().copied().filter(|&other| other > start).min().unwrap_or(body.len());
    let job = |&start: &usize| body[start..end(start)].split_once(":\n").expect("a job");
    starts.iter().map(job).map(|(name, job)| (name.trim(), job)).collect()
}

#[test]
fn actions_are_pinned_by_commit() {
    let mut pins = BTreeMap::new();
    for (path, workflow) in workflows() {
        for line in workflow.lines().filter(|line| line.trim_start_matches([' ', '-']).starts_with("uses: ")) {
            let used = line.split_once("uses: ").map(|(_, used)| used).unwrap_or_default();
            if used.starts_with("./") {
                continue;
            }
            let (action, pin) = used.split_once('@').unwrap_or_else(|| panic!("{path}: {used}"));
            let (commit, version) = pin.split_once(" # v").unwrap_or_else(|| panic!("{path}: {used}: no version"));
            assert!(commit.len() == 40 && commit.chars().all(|digit| digit.is_ascii_hexdigit()), "{path}: {used}");
            assert_eq!(version.split('.').count(), 3, "{path}: {used}");
            assert_eq!(pins.entry(action.to_owned()).or_insert_with(|| pin.to_owned()), pin, "{path}: {action}");
        }
    }
    assert!(pins.len() > 10, "{pins:?}");
}

#[test]
fn what_may_publish_runs_no_code_of_the_dependencies() {
    let mut count = 0;
    for (path, workflow) in workflows() {
        if !workflow.contains("\njobs:\n") {
            continue;
        }
        let (outside, _) = workflow.split_once("\njobs:\n").expect("jobs");
        assert!(outside.contains("permissions:\n  contents: read\n"), "{path}: what its jobs may do by default");
        for (name, job) in jobs(&workflow) {
            if job.contains(": write") {
                count += 1;
                for command in ["cargo ", "npm ci", "npm install", "pip install", "npx "] {
                    assert!(!job.contains(command), "{path}: {name} runs {command}");
                }
            }
        }
    }
    assert!(count >= 5, "{count}");
}

#[test]
fn what_is_published_names_its_repository() {
    // The box about Gaitway leads there.
    let (page, workflow) = (read(".github/workflows/ci.yml"), read(".github/workflows/release.yml"));
    let builds = [&page, &workflow].into_iter().flat_map(|workflow| jobs(workflow)).filter(|(name, job)| {
        *name != "test" && ["cargo xtask build", "cargo build", "maturin build"].iter().any(|build| job.contains(build))
    });
    let mut count = 0;
    for (name, job) in builds {
        assert!(job.contains(".github/name-repository.sh \"$REPOSITORY\""), "{name}");
        count += 1;
    }
    assert_eq!(count, 4, "two of the page, the programs and the wheels");
}

#[test]
fn a_release_says_what_it_is_made_of_and_by_what() {
    let workflow = read(".github/workflows/release.yml");
    let release = jobs(&workflow)["release"];
    let attested = release.find("actions/attest-build-provenance@").expect("an attestation");
    assert!(attested < release.find("gh release create").expect("a release"));
    for needed in ["subject-path: files/*", "attestations: write", "{program-*,page,sbom}"] {
        assert!(release.contains(needed), "{needed}");
    }
    assert_eq!(workflow.matches("push: true").count(), workflow.matches("sbom: true").count());
    let script = std::process::Command::new("node").arg(".github/sbom.mjs").output().expect("node");
    assert!(script.status.success(), "{}", String::from_utf8_lossy(&script.stderr));
    let materials: serde_json::Value = serde_json::from_slice(&script.stdout).expect("JSON");
    assert_eq!(materials["bomFormat"], "CycloneDX");
    let materials = materials["components"].as_array().expect("components");
    let has = |kind: &str, name: &str| {
        let start = format!("pkg:{kind}/{name}@");
        materials.iter().any(|found| found["purl"].as_str().is_some_and(|purl| purl.starts_with(&start)))
    };
    for name in ["wgpu", "ufbx", "basisu", "pyo3"] {
        assert!(has("cargo", name), "{name} is in no list of materials");
    }
    for name in ["gltf-validator", "mediabunny"] {
        assert!(has("npm", name), "{name} is in no list of materials");
    }
    // Of the build's tools, and of the tests.
    for (kind, name) in [("npm", "esbuild"), ("npm", "playwright-core"), ("cargo", "gaitway")] {
        assert!(!has(kind, name), "{name} ships with nothing");
    }
    assert!(materials.iter().all(|found| found["licenses"][0]["expression"].is_string()));
}

#[test]
fn dependencies_are_checked_and_updated_every_week() {
    let checks = read(".github/workflows/dependencies.yml");
    for needed in ["schedule:\n    - cron:", "cargo-deny-action@", "npm audit --package-lock-only --omit dev"] {
        assert!(checks.contains(needed), "{needed}");
    }
    let updates = read(".github/dependabot.yml");
    for kind in ["cargo", "npm", "github-actions", "docker"] {
        assert!(updates.contains(&format!("package-ecosystem: {kind}\n")), "{kind}");
    }
    assert_eq!(updates.matches("interval: weekly").count(), 4);
}
