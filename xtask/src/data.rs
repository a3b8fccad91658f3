//! Downloads the models that tests read. They are other people's work and not part of the repository: `tests/data.tsv`
//! names the public repository of each file, its path there, and the SHA-256 of the version that the tests know.
//! Files made by conversion, or whose place in a repository is not on record, cannot be listed there; a test below says which.

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use anyhow::{Context, bail, ensure};
use sha2::{Digest, Sha256};

use crate::process::{command, repository};

const MANIFEST: &str = "tests/data.tsv";
const RAW_FILES: &str = "https://raw.githubusercontent.com";

/// One line of the manifest.
struct Entry<'a> {
    /// Relative to the data folder.
    file: &'a str,
    /// `OWNER/NAME` on GitHub.
    repository: &'a str,
    /// Relative to the repository's root.
    path: &'a str,
    /// In hexadecimal.
    sha256: &'a str,
}

pub fn run() -> anyhow::Result<()> {
    let manifest = fs::read_to_string(repository().join(MANIFEST)).context(MANIFEST)?;
    fetch(&entries(&manifest)?, &folder(), RAW_FILES)
}

/// Where the tests look for their models.
fn folder() -> PathBuf {
    std::env::var_os("GAITWAY_DATA").map_or_else(|| repository().join("../shared/data"), PathBuf::from)
}

fn entries(manifest: &str) -> anyhow::Result<Vec<Entry<'_>>> {
    let mut lines = manifest.lines().zip(1..);
    let header = lines.next().map(|(line, _)| line);
    ensure!(header == Some("file\trepository\tpath\tsha256"), "{MANIFEST}:1: unexpected header {header:?}");
    lines.map(|(line, number)| entry(line).with_context(|| format!("{MANIFEST}:{number}"))).collect()
}

fn entry(line: &str) -> anyhow::Result<Entry<'_>> {
    match line.split('\t').collect::<Vec<_>>()[..] {
        [file, repository, path, sha256] if sha256.len() == 64 => Ok(Entry { file, repository, path, sha256 }),
        _ => bail!("expected four columns, the last one a SHA-256"),
    }
}

/// Downloads every entry that `folder` lacks and checks the hashes of all. `host` serves raw files the way GitHub does.
fn fetch(entries: &[Entry], folder: &Path, host: &str) -> anyhow::Result<()> {
    let mut problems = Vec::new();
    let (present, missing): (Vec<&Entry>, Vec<&Entry>) =
        entries.iter().partition(|entry| folder.join(entry.file).exists());
    for entry in &present {
        if sha256(&folder.join(entry.file))? != entry.sha256 {
            problems.push(format!("{}: differs from {MANIFEST}; delete it to download it again", entry.file));
        }
    }
    eprintln!("{} files are in {}, {} are missing", present.len(), folder.display(), missing.len());
    download(&missing, folder, host)?;
    for entry in &missing {
        let partial = partial(folder, entry);
        let origin = format!("{}/{}", entry.repository, entry.path);
        if !partial.exists() {
            problems.push(format!("{}: couldn't download {origin}", entry.file));
        } else if sha256(&partial)? == entry.sha256 {
            fs::rename(&partial, folder.join(entry.file))?;
        } else {
            fs::remove_file(&partial)?;
            problems.push(format!("{}: {origin} has changed since {MANIFEST} was written", entry.file));
        }
    }
    ensure!(problems.is_empty(), "{} of {} files:\n{}", problems.len(), entries.len(), problems.join("\n"));
    eprintln!("all {} files of {MANIFEST} are in place", entries.len());
    Ok(())
}

/// Runs one curl for all files, each into its partial file. Which of them arrived is for the caller to check.
fn download(entries: &[&Entry], folder: &Path, host: &str) -> anyhow::Result<()> {
    if entries.is_empty() {
        return Ok(());
    }
    let mut config = String::new();
    for entry in entries {
        let output = partial(folder, entry);
        let output = output.to_str().context("the data folder's path is not UTF-8")?.replace('\\', "/");
        let path = entry.path.replace('%', "%25").replace(' ', "%20").replace('#', "%23");
        writeln!(config, "url = \"{host}/{}/HEAD/{path}\"\noutput = \"{output}\"", entry.repository)?;
    }
    let mut curl = command("curl")
        .args(["--parallel", "--parallel-max", "8", "--fail", "--location", "--retry", "3", "--create-dirs"])
        .args(["--config", "-"])
        .stdin(Stdio::piped())
        .spawn()
        .context("couldn't run curl, which does the downloading")?;
    let mut stdin = curl.stdin.take().context("curl's standard input is closed")?;
    stdin.write_all(config.as_bytes())?;
    drop(stdin);
    curl.wait()?;
    Ok(())
}

/// Beside the final place, so that an interrupted download is never mistaken for the file.
fn partial(folder: &Path, entry: &Entry) -> PathBuf {
    folder.join(format!("{}.part", entry.file))
}

fn sha256(path: &Path) -> anyhow::Result<String> {
    let bytes = fs::read(path).with_context(|| path.display().to_string())?;
    Ok(hex_sha256(&bytes))
}

fn hex_sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;
    use std::io::{BufRead, BufReader};
    use std::process::Child;

    use super::*;

    const LICENCE: &str = "anyone may have it";

    /// An empty folder of this test's own.
    fn empty_folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("gaitway-xtask-{}-{name}", std::process::id()));
        fs::remove_dir_all(&folder).ok();
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    fn hash(text: &str) -> String {
        hex_sha256(text.as_bytes())
    }

    fn manifest(rows: &[[&str; 4]]) -> String {
        let rows = rows.iter().map(|row| row.join("\t") + "\n");
        std::iter::once("file\trepository\tpath\tsha256\n".to_owned()).chain(rows).collect()
    }

    /// A local stand-in for GitHub with one repository, `owner/name`. Dropping it stops the server.
    struct Host {
        server: Child,
        origin: String,
    }

    impl Drop for Host {
        fn drop(&mut self) {
            self.server.kill().ok();
            self.server.wait().ok();
        }
    }

    fn host(name: &str, files: &[(&str, &str)]) -> Host {
        let folder = empty_folder(name);
        for (path, text) in files {
            let path = folder.join("owner/name/HEAD").join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        let mut server =
            command("node").arg("xtask/site/serve.mjs").arg(&folder).arg("0").stdout(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let origin = line.split(' ').find(|word| word.starts_with("http://")).unwrap().trim_end_matches('/').to_owned();
        Host { server, origin }
    }

    #[test]
    fn fetches_only_missing_files_and_leaves_them_in_place() {
        let host = host("origin", &[("models/a 1.glb", "first"), ("b.glb", "second")]);
        let folder = empty_folder("fetched");
        fs::write(folder.join("here.glb"), LICENCE).unwrap();
        let text = manifest(&[
            // Not on the host: it has to be left alone.
            ["here.glb", "owner/name", "gone.glb", &hash(LICENCE)],
            ["deep/er/a.glb", "owner/name", "models/a 1.glb", &hash("first")],
            ["b.glb", "owner/name", "b.glb", &hash("second")],
        ]);
        let entries = entries(&text).unwrap();
        fetch(&entries, &folder, &host.origin).unwrap();
        assert_eq!(fs::read_to_string(folder.join("deep/er/a.glb")).unwrap(), "first");
        assert_eq!(fs::read_to_string(folder.join("b.glb")).unwrap(), "second");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 3, "no partial file is left behind");
        // With everything in place the host is not asked again.
        fetch(&entries, &folder, "http://127.0.0.1:9").unwrap();
    }

    #[test]
    fn names_every_file_that_is_missing_changed_or_damaged() {
        let host = host("changed-origin", &[("changed.glb", "other bytes"), ("good.glb", "good")]);
        let folder = empty_folder("changed");
        fs::write(folder.join("damaged.glb"), "half of i").unwrap();
        let text = manifest(&[
            ["changed.glb", "owner/name", "changed.glb", &hash("bytes")],
            ["gone.glb", "owner/name", "gone.glb", &hash("gone")],
            ["damaged.glb", "owner/name", "damaged.glb", &hash("half of it")],
            ["good.glb", "owner/name", "good.glb", &hash("good")],
        ]);
        let error = fetch(&entries(&text).unwrap(), &folder, &host.origin).unwrap_err().to_string();
        for expected in [
            "3 of 4 files",
            "changed.glb: owner/name/changed.glb has changed",
            "gone.glb: couldn't download owner/name/gone.glb",
            "damaged.glb: differs",
        ] {
            assert!(error.contains(expected), "{expected:?} is not in {error:?}");
        }
        let mut left: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        left.sort();
        assert_eq!(left, ["damaged.glb", "good.glb"]);
    }

    #[test]
    fn a_malformed_manifest_is_refused_with_its_line() {
        let error = |text: &str| entries(text).err().map(|error| format!("{error:#}")).unwrap_or_default();
        assert!(error("path\tsha256\n").contains("tests/data.tsv:1"));
        let short = manifest(&[["a", "owner/name", "a", &hash("a")], ["b", "owner/name", "b", "12"]]);
        assert!(error(&short).contains("tests/data.tsv:3"));
    }

    const REDUCED: &str = "made smaller than at its origin";
    const CONVERTED: &str = "converted or compressed from another file of the folder, or from one that isn't in it";
    const UNCONFIRMED: &str = "the folder's README names a repository, but not where in it the file is";
    const EARLIER: &str =
        "in the history of three.js, but not known to be in its latest commit, which is what is downloaded";
    const NOTES: &str = "about the folder";

    /// What the manifest leaves out: how the paths begin, and why.
    const UNLISTED: [(&str, &str); 37] = [
        ("README.md", NOTES),
        ("asset-generator/Positive/Buffer_Interleaved/Textures/", REDUCED),
        ("asset-generator/Positive/Material_AlphaBlend/Textures/", REDUCED),
        ("asset-generator/Positive/Material_AlphaMask/Textures/", REDUCED),
        ("asset-generator/Positive/Material_DoubleSided/Textures/", REDUCED),
        ("asset-generator/Positive/Mesh_PrimitiveAttribute/Textures/", REDUCED),
        ("asset-generator/Positive/Mesh_PrimitivesUV/Textures/", REDUCED),
        ("asset-generator/Positive/Node_NegativeScale/Textures/", REDUCED),
        ("asset-generator/Positive/Texture_Sampler/Textures/", REDUCED),
        ("compressed/Duck-vp-12-vt-12-vn-12.glb", UNCONFIRMED),
        ("compressed/Fox-", CONVERTED),
        ("compressed/RobotExpressive-", CONVERTED),
        ("compressed/agi-ktx2.glb", UNCONFIRMED),
        ("compressed/loaders-gl-meshopt/pirate.glb", UNCONFIRMED),
        ("cosc422/ArmyPilot.glb", CONVERTED),
        ("cosc422/dwarf.glb", CONVERTED),
        ("cosc422/mannequin", CONVERTED),
        ("fbx/cmu_91_", UNCONFIRMED),
        ("kaykit/Knight.glb", UNCONFIRMED),
        ("khronos/CesiumMan/glTF-Draco/", EARLIER),
        ("khronos/InterpolationTest/", UNCONFIRMED),
        ("khronos/Monster/glTF-Draco/", EARLIER),
        ("materials/babylon/PBR_Spheres.glb", UNCONFIRMED),
        ("materials/babylon/shaderBall/", UNCONFIRMED),
        ("mesh2motion/bird-animations.glb", UNCONFIRMED),
        ("mesh2motion/cmu_91_", CONVERTED),
        ("mesh2motion/fox-animations.glb", UNCONFIRMED),
        ("mesh2motion/human-", UNCONFIRMED),
        ("mesh2motion/import-negative/", UNCONFIRMED),
        ("mesh2motion/model-human.glb", UNCONFIRMED),
        ("mesh2motion/retarget/", UNCONFIRMED),
        ("mesh2motion/rig-human.glb", UNCONFIRMED),
        ("mesh2motion/spider-animations.glb", UNCONFIRMED),
        ("misc/godot_robot_player.glb", UNCONFIRMED),
        ("threejs/Samba_Dancing.glb", CONVERTED),
        ("vrm/chatvrm_idle_loop.vrma", UNCONFIRMED),
        ("vrm/vrm0_cryptovoxels.vrm", UNCONFIRMED),
    ];

    /// The data folder; none without one, unless it is required.
    fn data_folder() -> Option<PathBuf> {
        let folder = folder();
        if folder.is_dir() {
            return Some(folder);
        }
        assert!(std::env::var("GAITWAY_REQUIRE_DATA").as_deref() != Ok("1"), "no folder {}", folder.display());
        println!("skipped: no folder {}", folder.display());
        None
    }

    /// The hashes are those of the very files that the tests read.
    #[test]
    fn the_manifest_agrees_with_the_data_folder() {
        let Some(folder) = data_folder() else { return };
        let text = fs::read_to_string(repository().join(MANIFEST)).unwrap();
        let entries = entries(&text).unwrap();
        assert!(entries.windows(2).all(|pair| pair[0].file < pair[1].file), "sorted, each file once");
        let differing =
            entries.iter().filter(|entry| sha256(&folder.join(entry.file)).ok().as_deref() != Some(entry.sha256));
        let differing: Vec<&str> = differing.map(|entry| entry.file).collect();
        assert_eq!(differing, [""; 0]);
    }

    /// Adds the paths of all files below `folder`, relative to `root` and with slashes.
    fn add_files(folder: &Path, root: &Path, files: &mut Vec<String>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                add_files(&path, root, files);
            } else {
                files.push(path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/"));
            }
        }
    }

    #[test]
    fn every_file_is_in_the_manifest_or_left_out_for_a_reason() {
        let Some(folder) = data_folder() else { return };
        let text = fs::read_to_string(repository().join(MANIFEST)).unwrap();
        let listed: HashSet<&str> = entries(&text).unwrap().iter().map(|entry| entry.file).collect();
        let mut files = Vec::new();
        add_files(&folder, &folder, &mut files);
        let unlisted: Vec<&String> = files.iter().filter(|file| !listed.contains(file.as_str())).collect();
        let is_excused = |file: &str| UNLISTED.iter().any(|(start, _)| file.starts_with(start));
        let unexplained: Vec<_> = unlisted.iter().filter(|file| !is_excused(file)).collect();
        assert!(unexplained.is_empty(), "neither in {MANIFEST} nor in UNLISTED: {unexplained:?}");
        for (start, reason) in UNLISTED {
            assert!(unlisted.iter().any(|file| file.starts_with(start)), "{start} ({reason}): no file is left out");
        }
    }
}
