//! Which files a link and a folder reach: those that the command line names and those in their folders or below, nothing else of the
//! machine.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use crate::motion::folder;
use crate::program::run;
use crate::walk_bvh::BVH;

/// White from all directions: one pixel.
const HDR: &[u8] = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x81";
const MAP: &str = r#"{ "gaitway_map": 1, "joints": {} }"#;

/// A folder with a model `in/model.glb` and files that a link can name, in `in`, `in/below` and beside it in `out`.
fn desk(name: &str) -> PathBuf {
    let (folder, _) = folder(&format!("reach-{name}"));
    for place in ["in", "in/below", "out"] {
        fs::create_dir_all(folder.join(place)).expect("a folder");
        let file = |name: &str, bytes: &[u8]| fs::write(folder.join(place).join(name), bytes).expect("a file");
        file("a.bvh", BVH.as_bytes());
        file("sky.hdr", HDR);
        file("map.json", MAP.as_bytes());
    }
    fs::copy("assets/samples/dwarf.glb", folder.join("in/model.glb")).expect("a copy");
    folder
}

/// Runs the program in `folder`. Its standard input stays open, and what is read from it would be waited for.
fn run_in(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gaitway"));
    let child = command.args(arguments).current_dir(folder).stdin(Stdio::piped());
    let mut child = child.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program runs");
    let input = child.stdin.take();
    let output = child.wait_with_output().expect("it ends");
    drop(input);
    output
}

/// Returns what a link's key `key` with this value says beside the given files.
fn said(folder: &Path, given: &[&str], key: &str, value: &str) -> String {
    let with_motion = if key == "map" { "motion=a.bvh&map" } else { key };
    let output = run_in(folder, &[&["pose"], given, &["--view", &format!("v=1&{with_motion}={value}")]].concat());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{given:?} {key}={value}: {said}");
    said
}

const LEFT_OUT: &str = "is left out";
const REFUSED: &str = "a link can only name what is opened with it, and files in the same folders or below";

#[test]
fn a_link_reaches_what_is_given_and_what_lies_below() {
    let folder = desk("given");
    let absolute = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    for (key, name) in [("motion", "a.bvh"), ("light", "sky.hdr"), ("map", "map.json")] {
        let model = ["in/model.glb", "in/a.bvh"];
        for value in [
            name.to_owned(),
            format!("file:{name}"),
            format!("below/{name}"),
            format!("in/below/{name}"),
            format!("file:in/{name}"),
            absolute(&format!("in/below/{name}")),
        ] {
            let said = said(&folder, &model, key, &value);
            assert!(!said.contains(LEFT_OUT), "{key}={value}: {said}");
        }
        for value in [
            format!("out/{name}"),
            format!("../out/{name}"),
            format!("in/../out/{name}"),
            absolute(&format!("out/{name}")),
            absolute(&format!("in/../out/{name}")),
            format!("file:{}", absolute(&format!("out/{name}"))),
        ] {
            let said = said(&folder, &model, key, &value);
            // Seen from where the program runs, the second isn't there.
            let is_refused = said.contains(REFUSED) || value.starts_with("..") && said.contains("no such file");
            assert!(is_refused && said.matches(LEFT_OUT).count() == 1, "{key}={value}: {said}");
        }
        let missing = said(&folder, &model, key, &format!("no{name}"));
        assert!(missing.contains("there is no such file"), "{key}: {missing}");
    }
    // By its own name, wherever it is; as every file of a folder that is given.
    assert!(!said(&folder, &["in/model.glb", "out/a.bvh"], "motion", "file:a.bvh").contains(LEFT_OUT));
    fs::remove_file(folder.join("out/map.json")).expect("it is there");
    assert!(!said(&folder, &["sample:walker", "out"], "motion", "a.bvh").contains(LEFT_OUT));
    assert!(said(&folder, &["sample:walker"], "motion", "out/a.bvh").contains(REFUSED));
    // A card's picture shows no file that isn't given.
    let out = absolute("card.html");
    let link = format!("https://example.org/#model={}", absolute("in/model.glb"));
    let said = String::from_utf8_lossy(&run(&["card", &link, "--out", &out]).stderr).into_owned();
    assert!(said.contains("the card has no picture") && !folder.join("card.jpg").exists(), "{said}");
    assert!(fs::read_to_string(out).is_ok_and(|card| !card.contains("jpg")));
    fs::remove_dir_all(&folder).expect("it was created");
}

/// Nothing is waited for, nothing without an end is read.
#[cfg(unix)]
#[test]
fn a_link_reaches_no_device_pipe_or_symbolic_link_elsewhere() {
    let folder = desk("devices");
    let pipe = folder.join("in/pipe.bvh");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    std::os::unix::fs::symlink("../out/a.bvh", folder.join("in/linked.bvh")).expect("a link");
    std::os::unix::fs::symlink("/dev/zero", folder.join("in/zero.hdr")).expect("a link");
    for (key, value) in [
        ("light", "/dev/zero"),
        ("light", "file:/dev/zero"),
        ("light", "zero.hdr"),
        ("motion", "pipe.bvh"),
        ("motion", "linked.bvh"),
        ("motion", "/"),
        ("motion", "below"),
        ("map", "/dev/zero"),
    ] {
        let said = said(&folder, &["in/model.glb", "in/a.bvh"], key, value);
        assert!(said.contains(&format!(": {REFUSED}")) || said.contains("no such file"), "{key}={value}: {said}");
    }
    let said = said(&folder, &["in/model.glb"], "motion", "-");
    assert!(said.contains("-: there is no such file"), "{said}");
    fs::remove_dir_all(&folder).expect("it was created");
}

#[cfg(unix)]
#[test]
fn a_folder_of_motions_reaches_nothing_outside() {
    use std::os::unix::fs::symlink;
    let folder = desk("folder");
    fs::write(folder.join("secret"), "password").expect("a file");
    symlink("../secret", folder.join("in/secret.bvh")).expect("a link");
    symlink("../out/a.bvh", folder.join("in/elsewhere.bvh")).expect("a link");
    symlink("a.bvh", folder.join("in/here.bvh")).expect("a link");
    for motions in ["in", "in/*.bvh"] {
        let call = ["retarget", "--model", "sample:walker", "--motion", motions, "--out-dir", "made", "--clip-only"];
        let output = run_in(&folder, &call);
        let lines = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success() && !lines.contains("password") && !lines.contains("elsewhere"), "{lines}");
        assert!(lines.contains("in/here.bvh"), "{lines}");
    }
    fs::remove_dir_all(&folder).expect("it was created");
}
