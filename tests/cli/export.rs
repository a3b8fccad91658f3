//! `gaitway export`: many clips in one file, or a file for each.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use crate::motion::folder;
use crate::program::{check_fails, document, run};

/// A folder for one test.
struct TestFolder(PathBuf);

impl TestFolder {
    fn new(name: &str) -> Self {
        Self(folder(&format!("export-{name}")).0)
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().expect("a plain path").to_owned()
    }

    fn files(&self, name: &str) -> Vec<String> {
        let entries = fs::read_dir(self.0.join(name)).expect("a folder");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("a file").file_name().into_string().expect("a plain name")).collect();
        names.sort();
        names
    }
}

impl Drop for TestFolder {
    fn drop(&mut self) {
        // A leftover folder does no harm.
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn names(document: &Value, key: &str) -> Vec<String> {
    let list = document[key].as_array().expect("a list").iter();
    list.map(|entry| entry["name"].as_str().expect("a name").to_owned()).collect()
}

fn clips_of(file: &str) -> Vec<String> {
    names(&document(&["inspect", file, "--json"]), "clips")
}

/// The pilot's clips as files of their own, added to the pilot without clips again, play as before.
#[test]
fn clips_of_files_are_merged_into_one() {
    let folder = TestFolder::new("merge");
    let (parts, bare, out) = (folder.path("parts"), folder.path("bare.glb"), folder.path("hero.glb"));
    let made = document(&["export", "sample:pilot", "--out", &parts, "--json"]);
    let clips = names(&made, "clips");
    assert_eq!(clips, clips_of("sample:pilot"));
    let mut files: Vec<String> = clips.iter().map(|clip| format!("{clip}.glb")).collect();
    assert_eq!(names(&made, "files"), files);
    files.sort();
    assert_eq!(folder.files("parts"), files);

    let run_alone = ["export", "sample:pilot", "--clips", "idle", "--rename", "idle=Stand", "--out", &bare, "--json"];
    assert_eq!(names(&document(&run_alone), "clips"), ["Stand"]);
    assert_eq!(clips_of(&bare), ["Stand"]);

    let merged =
        document(&["export", &bare, "--motion", &parts, "--clips", "all", "--for", "godot", "--out", &out, "--json"]);
    files.iter_mut().for_each(|file| file.truncate(file.len() - ".glb".len()));
    assert_eq!(clips_of(&out), [vec!["Stand".to_owned()], files].concat());
    assert_eq!(names(&merged, "clips"), clips_of(&out));
    assert_eq!(merged["files"][0]["bytes"].as_u64(), Some(fs::metadata(&out).expect("a file").len()));
    for clip in ["walk", "wave"] {
        let pose = |file: &str| -> Vec<f64> {
            let pose = document(&["pose", file, "--clip", clip, "--time", "0.37", "--json"]);
            let nodes = pose["nodes"].as_array().expect("nodes").iter();
            nodes.flat_map(|node| node["world"].as_array().expect("a matrix")).filter_map(Value::as_f64).collect()
        };
        let (found, expected) = (pose(&out), pose("sample:pilot"));
        assert_eq!(found.len(), expected.len());
        // The pilot's rotations are quantized; written as 32-bit numbers, they are normalized.
        let off = found.iter().zip(expected).map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max);
        assert!(off < 1e-6, "{clip}: {off}");
    }
}

#[test]
fn motions_of_other_bodies_are_retargeted() {
    let folder = TestFolder::new("retarget");
    let out = folder.path("out.glb");
    let walk = folder.path("walk.bvh");
    let call = ["export", "sample:pilot", "--motion", &walk, "--clips", "walk (2),idle", "--out", &out];
    let done = run(&call);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert!(String::from_utf8_lossy(&done.stdout).contains("2 clips in 1 file"));
    assert_eq!(clips_of(&out), ["idle", "walk (2)"]);
    let alone = folder.path("alone.glb");
    let retargeted = run(&["retarget", "--model", "sample:pilot", "--motion", &walk, "--out", &alone]);
    assert!(retargeted.status.success());
    let pose =
        |file: &str, clip: &str| document(&["pose", file, "--clip", clip, "--time", "0.3", "--json"])["nodes"].clone();
    assert_eq!(pose(&out, "walk (2)"), pose(&alone, "6"));
}

#[test]
fn an_archive_has_a_file_for_each_clip() {
    let folder = TestFolder::new("zip");
    let out = folder.path("clips.zip");
    let made = document(&["export", "sample:pilot", "--format", "bvh", "--out", &out, "--json"]);
    let file = fs::File::open(&out).expect("a file");
    let mut archive = zip::ZipArchive::new(file).expect("an archive");
    let found: Vec<String> = archive.file_names().map(|name| name.expect("UTF-8").into_owned()).collect();
    let mut expected = names(&made, "files");
    assert!(expected.iter().all(|name| name.ends_with(".bvh")));
    let mut sorted = found.clone();
    sorted.sort();
    expected.sort();
    assert_eq!(sorted, expected);
    let mut walk = String::new();
    let mut member = archive.by_name("walk.bvh").expect("a member");
    std::io::Read::read_to_string(&mut member, &mut walk).expect("with the right checksum");
    assert!(walk.starts_with("HIERARCHY"));
    let inside = format!("{out}#!/walk.bvh");
    let map = document(&["map", "--model", "sample:pilot", "--motion", &inside, "--json"]);
    assert_eq!(map["gaitway_map"], 1);
}

/// Where joints are in the world, with their names.
type Worlds = Vec<(String, Vec<f64>)>;

fn worlds(file: &str, clip: &str, secs: &str) -> Worlds {
    let pose = document(&["pose", file, "--clip", clip, "--time", secs, "--json"]);
    let numbers = |node: &Value| node["world"].as_array().expect("a matrix").iter().filter_map(Value::as_f64).collect();
    let nodes = pose["nodes"].as_array().expect("nodes").iter();
    nodes.map(|node| (node["name"].as_str().unwrap_or_default().to_owned(), numbers(node))).collect()
}

/// Returns where a joint is above the ground: X and Z.
fn place(worlds: &Worlds, joint: &str) -> [f64; 2] {
    let (_, world) = worlds.iter().find(|(name, _)| name == joint).expect(joint);
    [world[12], world[14]]
}

#[track_caller]
fn check_near(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    let off = found.iter().zip(expected).map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max);
    assert!(off < tolerance, "{off}: {found:?}, expected {expected:?}");
}

#[test]
fn a_root_bone_carries_the_clips_that_travel() {
    const CLIP: &str = "walk (2)";
    const HIPS: &str = "mixamorig:Hips";
    let folder = TestFolder::new("root");
    let (walk, out) = (folder.path("walk.bvh"), folder.path("out.glb"));
    let exported = |options: &[&str]| {
        let call = ["export", "sample:pilot", "--motion", &walk, "--clips", CLIP, "--out", &out];
        let done = run(&[&call[..], options].concat());
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        ["0", "0.8"].map(|secs| worlds(&out, CLIP, secs))
    };
    let (plain, rooted) = (exported(&[]), exported(&["--root-bone"]));
    let in_place = exported(&["--root-bone", "--in-place", CLIP]);
    for ((before, after), stays) in plain.iter().zip(&rooted).zip(&in_place) {
        assert_eq!(after.len(), before.len() + 1);
        assert_eq!(after[before.len()].0, "root");
        for ((name, expected), (same, found)) in before.iter().zip(after) {
            assert_eq!(name, same);
            check_near(found, expected, 2e-3);
        }
        check_near(&place(after, "root"), &place(after, HIPS), 2e-3);
        check_near(&place(stays, "root"), &[0.0; 2], 1e-9);
        check_near(&place(stays, HIPS), &[0.0; 2], 2e-3);
    }
    let [start, end] = plain.each_ref().map(|worlds| place(worlds, HIPS));
    let travel = (end[0] - start[0]).hypot(end[1] - start[1]);
    assert!(travel > 0.2, "the walk goes {travel} m");
    check_fails(&["export", "sample:pilot", "--in-place", "run", "--out", &out], 2, "--root-bone");
    check_fails(&["export", "sample:pilot", "--root-bone", "--in-place", "fly", "--out", &out], 1, "--in-place");
}

#[test]
fn fewer_keys_make_a_smaller_file() {
    let folder = TestFolder::new("keys");
    let bytes = |options: &[&str]| {
        let out = folder.path("out.glb");
        let made = document(&[&["export", "sample:walker", "--out", &out, "--json"], options].concat());
        let is_said = made["warnings"].to_string().contains("keys, within");
        assert_eq!(is_said, !options.is_empty(), "{made}");
        made["files"][0]["bytes"].as_u64().expect("a number")
    };
    let (all, few, fewer) = (bytes(&[]), bytes(&["--fewer-keys"]), bytes(&["--fewer-keys=0.5,1"]));
    assert!(fewer < few && few < all, "{fewer}, {few} and {all} bytes");
    assert_eq!(bytes(&["--for", "web"]), few);
    check_fails(&["export", "sample:pilot", "--fewer-keys=0,1", "--out", "out.glb"], 2, "above 0");
}

/// Nothing is written.
#[test]
fn bad_plans_are_refused() {
    let folder = TestFolder::new("refused");
    let (out, walk) = (folder.path("out.glb"), folder.path("walk.bvh"));
    let check = |arguments: &[&str], says: &str| {
        check_fails(&[&["export", "sample:pilot", "--motion", &walk], arguments].concat(), 1, says);
        assert_eq!(folder.files(""), ["walk.bvh"], "{arguments:?}");
    };
    check(&["--clips", "idle,fly", "--out", &out], "“fly”");
    check(&["--rename", "idle=run", "--out", &out], "“idle” and “run” would both be called “run”");
    check(&["--rename", "fly=run", "--out", &out], "--rename");
    check(&["--clips", "idle", "--rename", "run=fast", "--out", &out], "one of the clips that are written");
    let other_in_place = ["--clips", "idle", "--root-bone", "--in-place", "run", "--out", &out];
    check(&other_in_place, "one of the clips that are written");
    check(&["--for", "unreal", "--out", &out], "Unreal imports FBX; choose an .fbx");
    check(&["--for", "vrm", "--out", &out], "VRM avatar yet");
    check(&["--format", "bvh", "--out", &folder.path("out.fbx")], "--format");
    check(&["--out", &folder.path("out.bvh")], "choose a folder and --format");
    check(&["--out", &folder.path("out.vrm")], "expected .glb, found .vrm");
    check(&["--format", "bvh", "--out", &out], "--format");
    check(&["--map", "no.json", "--out", &out], "no.json");
    check_fails(&["export", "assets/samples/mannequin.glb", "--out", &out], 1, "no clip is chosen");
    check_fails(&["export", "sample:pilot", "--for", "maya", "--out", &out], 2, "unreal");
    let twice = run(&["export", "sample:pilot", "--json", "--out", "-"]);
    assert_eq!(twice.status.code(), Some(2), "two documents on standard output");
    assert_eq!(folder.files(""), ["walk.bvh"]);
}

/// Every surface that writes a model writes FBX, and what it writes opens and moves as the model does.
#[test]
fn models_are_written_as_fbx() {
    let folder = TestFolder::new("fbx");
    let [all, one, moved] = ["all.fbx", "one.fbx", "moved.fbx"].map(|name| folder.path(name));
    let made = document(&["export", "sample:pilot", "--for", "unity", "--out", &all, "--json"]);
    assert_eq!(names(&made, "clips"), clips_of("sample:pilot"));
    assert_eq!(names(&made, "files"), ["Pilot.fbx"]);
    assert_eq!(clips_of(&all), clips_of("sample:pilot"));
    assert!(run(&["convert", "assets/samples/pilot.glb", "--out", &one]).status.success());
    assert_eq!(clips_of(&one), clips_of("sample:pilot"));
    let retargeted = ["retarget", "--model", "sample:pilot", "--motion", &all, "--clip", "walk", "--out", &moved];
    assert!(run(&retargeted).status.success());
    for (file, clip) in [(&all, "run"), (&one, "run"), (&moved, "wave")] {
        let heads = ["sample:pilot", file].map(|file| {
            let pose = document(&["pose", file, "--clip", clip, "--time", "0.37", "--json"]);
            let nodes = pose["nodes"].as_array().expect("nodes").clone();
            let head = nodes.into_iter().find(|node| node["name"] == "mixamorig:Head").expect("a head");
            [12, 13, 14].map(|at| head["world"][at].as_f64().expect("a number"))
        });
        let off = (0..3).map(|axis| (heads[0][axis] - heads[1][axis]).abs()).fold(0.0, f64::max);
        assert!(off < 1e-4, "{file}: {off} m off");
    }
}

#[test]
fn an_input_is_never_overwritten() {
    let folder = TestFolder::new("inputs");
    let (parts, model) = (folder.path("parts"), folder.path("hero.glb"));
    assert!(run(&["export", "sample:pilot", "--clips", "run", "--out", &parts]).status.success());
    assert!(run(&["export", "sample:pilot", "--out", &model]).status.success());
    let before = fs::read(folder.0.join("parts/run.glb")).expect("a file");
    let again =
        ["export", &model, "--motion", &format!("{parts}/run.glb"), "--clips", "run (2)", "--rename", "run (2)=run"];
    check_fails(&[&again[..], &["--out", &parts]].concat(), 1, "one of the files that were read");
    check_fails(&["export", &model, "--out", &model], 1, "one of the files that were read");
    assert_eq!(fs::read(folder.0.join("parts/run.glb")).expect("a file"), before);
}
