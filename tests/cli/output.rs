//! What commands write: files that are replaced completely or not at all, standard output, and `--json` with a failure.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::{Value, json};

use crate::motion::folder;
use crate::program::{check_fails, document, run};

/// A triangle whose buffer is the file `data`.
const MODEL: &str = r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0,
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[0,0,0]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"data"}]}"#;

fn text(path: &Path) -> &str {
    path.to_str().expect("a plain path")
}

/// A folder with `walk.bvh`, `model.gltf` with its buffer `data`, and `model.glb`, the same model.
struct Desk {
    folder: PathBuf,
    motion: String,
}

impl Desk {
    fn new(name: &str) -> Self {
        let (folder, motion) = folder(&format!("output-{name}"));
        fs::write(folder.join("model.gltf"), MODEL).expect("a file");
        fs::write(folder.join("data"), [0; 36]).expect("a file");
        let desk = Self { folder, motion };
        let done = run(&["convert", &desk.path("model.gltf"), "--out", &desk.path("model.glb")]);
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        desk
    }

    fn path(&self, name: &str) -> String {
        text(&self.folder.join(name)).to_owned()
    }

    fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.folder.join(name)).expect("a file")
    }

    /// Checks that the command fails and leaves the folder as it is.
    #[track_caller]
    fn check_refused(&self, arguments: &[&str], says: &str) {
        let before = self.content();
        check_fails(arguments, 1, says);
        assert!(self.content() == before, "{arguments:?} changed the folder");
    }

    fn content(&self) -> Vec<(PathBuf, Vec<u8>)> {
        let entries = fs::read_dir(&self.folder).expect("a folder").map(|entry| entry.expect("a file").path());
        let mut content: Vec<_> = entries
            .filter(|path| path.is_file())
            .map(|path| (path.clone(), fs::read(&path).expect("a file")))
            .collect();
        content.sort();
        content
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        // A leftover folder does no harm.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

const LOST: &str = "one of the files that were read";

#[test]
fn an_input_is_never_overwritten() {
    let desk = Desk::new("inputs");
    let (model, map) = (desk.path("model.glb"), desk.path("map"));
    desk.check_refused(&["convert", &model, "--out", &model], LOST);
    let other_spelling = format!("{}/../{}/model.glb", text(&desk.folder), desk.folder.file_name().unwrap().display());
    desk.check_refused(&["convert", &model, "--out", &other_spelling], LOST);
    desk.check_refused(&["convert", &desk.path("model.gltf"), "--out", &desk.path("data")], LOST);
    fs::write(&map, json!({ "gaitway_map": 1, "joints": { "Head": { "source": "Head" } } }).to_string())
        .expect("a map");
    let motion = desk.path("motion");
    fs::copy(&desk.motion, &motion).expect("a copy");
    let retarget = ["retarget", "--model", "sample:walker", "--motion", &motion, "--map", &map, "--clip-only", "--out"];
    desk.check_refused(&[&retarget[..], &[&motion]].concat(), LOST);
    desk.check_refused(&[&retarget[..], &[&map]].concat(), LOST);
    desk.check_refused(&["map", "--model", "sample:walker", "--motion", &motion, "--out", &motion], LOST);
}

#[cfg(unix)]
#[test]
fn an_input_is_never_overwritten_through_a_link() {
    let desk = Desk::new("links");
    let model = desk.path("model.glb");
    std::os::unix::fs::symlink("model.glb", desk.folder.join("symbolic.glb")).expect("a link");
    fs::hard_link(&model, desk.folder.join("hard.glb")).expect("a link");
    for link in ["symbolic.glb", "hard.glb"] {
        desk.check_refused(&["convert", &model, "--out", &desk.path(link)], LOST);
        desk.check_refused(&["convert", &desk.path(link), "--out", &model], LOST);
    }
    let before = desk.content();
    let redirected = command(&["convert", "-", "--out", &model], fs::File::open(&model).expect("a file"));
    assert_eq!(redirected.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&redirected.stderr).contains(LOST));
    assert!(desk.content() == before);
}

fn command(arguments: &[&str], input: impl Into<Stdio>) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gaitway")).args(arguments).stdin(input).output().expect("the program runs")
}

#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_old_file() {
    let desk = Desk::new("full");
    let out = desk.path("out.glb");
    fs::write(&out, "old").expect("a file");
    let before = desk.content();
    // The signal that exceeding the limit sends is ignored, so that writing fails instead.
    let script = "trap '' XFSZ; ulimit -f 1; exec \"$@\"";
    let program = env!("CARGO_BIN_EXE_gaitway");
    let call = ["-c", script, "sh", program, "convert", &desk.motion, "--out", &out];
    let output = Command::new("sh").args(call).output().expect("a shell");
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(error.contains("out.glb: ") && !error.contains("os error"), "{error}");
    assert!(desk.content() == before, "{:?}", desk.content().iter().map(|(path, _)| path).collect::<Vec<_>>());
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_that_is_full_is_an_error() {
    let desk = Desk::new("device");
    let says = "there is no space left";
    check_fails(&["convert", &desk.motion, "--out", "/dev/full"], 1, &format!("/dev/full: {says}"));
    for arguments in [&["convert", &desk.motion, "--out", "-"][..], &["inspect", &desk.motion, "--json"]] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("a device");
        let output = Command::new(env!("CARGO_BIN_EXE_gaitway")).args(arguments).stdout(full).output();
        let output = output.expect("the program runs");
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{error}");
        assert!(error.contains(&format!("standard output: {says}")), "{error}");
    }
    assert!(run(&["convert", &desk.motion, "--out", "/dev/null"]).status.success());
}

#[cfg(unix)]
#[test]
fn links_and_permissions_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let desk = Desk::new("target");
    let (old, link, dangling) = (desk.path("old.glb"), desk.path("link.glb"), desk.path("dangling.glb"));
    fs::write(&old, "old").expect("a file");
    fs::set_permissions(&old, fs::Permissions::from_mode(0o640)).expect("permissions");
    symlink("old.glb", &link).expect("a link");
    symlink("new.glb", &dangling).expect("a link");
    for out in [&link, &dangling] {
        assert!(run(&["convert", &desk.motion, "--out", out]).status.success());
        assert!(Path::new(out).is_symlink(), "{out}");
    }
    assert_eq!(desk.read("old.glb"), desk.read("new.glb"));
    assert_eq!(fs::metadata(&old).expect("a file").permissions().mode() & 0o777, 0o640);
}

#[test]
fn extensions_that_do_not_fit_are_refused() {
    let desk = Desk::new("extensions");
    let check = |arguments: &[&str], out: &str, expected: &str| {
        let out = desk.path(out);
        let says = format!("{out}: file extension: expected {expected}, found .");
        desk.check_refused(&[arguments, &["--out", &out]].concat(), &says);
    };
    check(&["convert", &desk.motion], "new.json", ".glb or .bvh or .vrma");
    check(&["convert", &desk.motion], "new.vrm", ".glb or .bvh or .vrma");
    check(&["map", "--model", "sample:walker", "--motion", &desk.motion], "new.glb", ".json");
    check(
        &["retarget", "--model", "sample:walker", "--motion", &desk.motion, "--clip-only"],
        "new.png",
        ".glb or .bvh or .vrma",
    );
    for out in ["NEW.GLB", "new"] {
        assert!(run(&["convert", &desk.motion, "--out", &desk.path(out)]).status.success(), "{out}");
    }
    let nowhere = desk.path("nowhere/new.glb");
    desk.check_refused(&["convert", &desk.motion, "--out", &nowhere], "there is no folder");
    desk.check_refused(&["convert", &desk.motion, "--out", text(&desk.folder)], "this is a folder");
}

#[test]
fn a_dash_is_standard_input_and_output() {
    let desk = Desk::new("streams");
    let model = || fs::File::open(desk.path("model.glb")).expect("a file");
    let piped = command(&["convert", "-", "--out", "-"], model());
    assert!(piped.status.success(), "{}", String::from_utf8_lossy(&piped.stderr));
    assert_eq!(piped.stdout, desk.read("model.glb"));
    let inspected: Value = serde_json::from_slice(&command(&["inspect", "-", "--json"], model()).stdout).expect("JSON");
    assert_eq!((&inspected["files"], &inspected["vertices"]), (&json!(["stdin"]), &3.into()));
    let map = ["map", "--model", "sample:walker", "--motion"];
    let printed = run(&[&map[..], &[&desk.motion, "--out", "-"]].concat());
    let written = desk.path("map.json");
    assert!(run(&[&map[..], &[&desk.motion, "--out", &written]].concat()).status.success());
    assert_eq!(printed.stdout, desk.read("map.json"));
    let both = run(&[&map[..], &[&desk.motion, "--out", "-", "--json"]].concat());
    assert_eq!(both.status.code(), Some(2), "{}", String::from_utf8_lossy(&both.stderr));
    let twice = command(&["map", "--model", "-", "--motion", "-"], model());
    assert!(String::from_utf8_lossy(&twice.stderr).contains("-: standard input can be read only once"));
}

/// Checks the exit status and the whole document, and that standard error has the same message.
#[track_caller]
fn check_document(arguments: &[&str], status: i32, expected: &Value) {
    let output = run(arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{error}");
    let document: Value = serde_json::from_slice(&output.stdout).expect("one JSON document");
    assert_eq!(document, json!({ "error": expected }), "{arguments:?}");
    let said = error.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains(expected["message"].as_str().expect("a message")), "{error}");
}

#[test]
fn failures_are_documents_with_json() {
    let desk = Desk::new("json");
    check_document(
        &["inspect", "no/such.glb", "--json"],
        1,
        &json!({ "message": "no/such.glb: there is no such file", "file": "no/such.glb" }),
    );
    check_document(
        &["pose", "sample:walker", "--clip", "Fly", "--json"],
        1,
        &json!({
            "message": "sample:walker: expected the name or index of a clip, found “Fly”; its clips are “Walk”, “Idle”, “Wave”",
            "file": "sample:walker",
            "expected": "the name or index of a clip",
            "found": "“Fly”",
            "hint": "its clips are “Walk”, “Idle”, “Wave”",
        }),
    );
    let broken = desk.path("broken.gltf");
    fs::write(&broken, MODEL.replace("\"POSITION\":0", "\"POSITION\":7")).expect("a file");
    check_document(
        &["inspect", &broken, "--json"],
        1,
        &json!({
            "message": "broken.gltf: meshes[0].primitives[0].attributes.POSITION: expected an index into the 1 accessors, found 7",
            "file": "broken.gltf",
            "where": "meshes[0].primitives[0].attributes.POSITION",
            "expected": "an index into the 1 accessors",
            "found": "7",
        }),
    );
    let map = desk.path("map.json");
    let out = desk.path("out.glb");
    let retarget = ["retarget", "--model", "sample:walker", "--motion", &desk.motion, "--out", &out, "--clip-only"];
    fs::write(&map, r#"{ "gaitway_map": 1, "crossfade_secs": "x" }"#).expect("a map");
    check_document(
        &[&retarget[..], &["--map", &map, "--json"]].concat(),
        1,
        &json!({
            "message": "map.json: crossfade_secs: expected a number, found “x” (line 1, column 41)",
            "file": "map.json",
            "where": "crossfade_secs",
            "expected": "a number",
            "found": "“x”",
        }),
    );
    check_document(
        &["inspect", "--json"],
        2,
        &json!({ "message": "the following required arguments were not provided: <FILE>..." }),
    );
}

#[test]
fn an_unknown_clip_of_a_link_is_reported() {
    let says = "“Fly”; its clips are “Walk”, “Idle”, “Wave”; the rest pose is used";
    let stderr = |arguments: &[&str]| {
        let output = run(arguments);
        assert!(output.status.success());
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let unknown = stderr(&["pose", "sample:walker", "--view", "v=1&clip=Fly"]);
    assert!(unknown.contains(says), "{unknown}");
    for arguments in [
        &["pose", "sample:walker", "--view", "v=1&clip=Walk"][..],
        &["pose", "sample:walker", "--view", "v=1&clip="],
        &["pose", "sample:walker", "--view", "v=1&clip=Fly", "--clip", "Walk"],
    ] {
        assert_eq!(stderr(arguments), "", "{arguments:?}");
    }
    assert_eq!(document(&["pose", "sample:walker", "--view", "v=1&clip=Fly", "--json"])["clip"], Value::Null);
}

#[test]
fn what_a_link_asks_for_in_vain_is_reported() {
    let output =
        run(&["pose", "sample:walker", "--view", "v=1&joint=999&speed=9&expression=grin:1&zoo=1&change=Walk:trim:5:1"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success());
    let says =
        ["joint=999", "speed=9: expected a factor from 0.1 to 4; 4 is used", "“grin”", "zoo: ", "trim:START:END"];
    for part in says {
        assert_eq!(stderr.matches(part).count(), 1, "{part}: {stderr}");
    }
    assert_eq!(stderr.lines().count(), says.len(), "{stderr}");
}

#[test]
fn a_warning_about_a_converted_file_names_it_once() {
    let desk = Desk::new("converted");
    let path = desk.path("odd.x");
    fs::write(&path, "xof 0303txt 0032\nFrame a { Camera { 1.0; Lens { 2.0; } } }").expect("a file");
    for arguments in [&["inspect", &path][..], &["pose", &path], &["convert", &path, "--out", &desk.path("odd.glb")]] {
        let output = run(arguments);
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && stderr.contains("kind \"Camera\""), "{arguments:?}: {stderr}");
        assert_eq!(stderr.matches("odd.x").count(), 1, "{arguments:?}: {stderr}");
    }
}
