//! The skinning exercise, opened, posed, converted and retargeted.

use std::path::PathBuf;
use std::process::Command as Process;

use gaitway::files::{OpenError, open_paths};
use serde_json::Value;

use crate::bent_exercise::{BENT, bent, exercise, furthest, positions, rotations};
use crate::data_folder::data_folder;

#[test]
fn any_file_of_a_set_opens_the_whole_set() {
    let Some(folder) = data_folder() else { return };
    let folder = folder.join("mit6837");
    for name in ["Model2.obj", "Model2.skel", "Model2.attach", "Model2"] {
        let opened = open_paths(&[folder.join(name)]).unwrap_or_else(|problem| panic!("{name}: {problem}"));
        assert_eq!(opened.model.rig().skin_joints(), 18, "{name}");
        assert_eq!(opened.files.len(), 3, "{name}");
    }
    let all: Vec<PathBuf> = ["obj", "skel", "attach"].map(|kind| folder.join(format!("Model3.{kind}"))).into();
    assert_eq!(open_paths(&all).expect("together").files, ["Model3.obj", "Model3.skel", "Model3.attach"]);
    assert!(matches!(open_paths(&[folder.join("Model9")]), Err(OpenError::Read { .. })));
    let several = open_paths(&[folder]).expect_err("four models").to_string();
    assert!(several.contains("Model1.obj") && several.contains("Model4.obj"), "{several}");
}

fn run(arguments: &[&str]) -> Vec<u8> {
    let output = Process::new(env!("CARGO_BIN_EXE_gaitway")).args(arguments).output().expect("the program runs");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

#[test]
fn the_command_line_opens_poses_and_converts_exercises() {
    let (Some(folder), Some(exercise)) = (data_folder(), exercise("Model1")) else { return };
    let model = folder.join("mit6837/Model1.obj");
    let model = model.to_str().expect("a plain path");
    let inspected: Value = serde_json::from_slice(&run(&["inspect", model, "--json"])).expect("JSON");
    let numbers =
        ["nodes", "joints", "meshes", "primitives", "vertices", "triangles"].map(|key| inspected[key].as_u64());
    assert_eq!(numbers, [18, 18, 1, 1, 13336, 26668].map(Some));
    assert_eq!((inspected["format"].as_str(), inspected["warnings"].as_array().map(Vec::len)), (Some("obj"), Some(0)));
    let posed = |arguments: &[&str]| positions(&serde_json::from_slice(&run(arguments)).expect("JSON"));
    assert!(furthest(&posed(&["pose", model, "--json"]), &exercise.vertices) < 1e-6);
    let expected = exercise.skinned(&rotations(&bent()));
    assert!(furthest(&posed(&["pose", model, "--view", BENT, "--json"]), &expected) < 1e-6);

    let out = std::env::temp_dir().join(format!("gaitway-coursework-{}.glb", std::process::id()));
    let out_name = out.to_str().expect("a plain path");
    run(&["convert", model, "--out", out_name]);
    assert!(furthest(&posed(&["pose", out_name, "--json"]), &exercise.vertices) < 1e-6, "bound as before");
    let named = format!("{BENT}&names=5:Left thigh");
    run(&["convert", model, "--view", &named, "--out", out_name]);
    let document: Value = serde_json::from_slice(&run(&["pose", out_name, "--json"])).expect("JSON");
    std::fs::remove_file(&out).expect("it was written");
    assert!(furthest(&positions(&document), &expected) < 1e-6, "written in its current pose");
    assert_eq!(document["nodes"][5]["name"], "Left thigh");
}

/// The joints have no names, so the map is written manually.
#[test]
fn a_motion_can_be_retargeted_to_an_exercise() {
    let Some(folder) = data_folder() else { return };
    let (model, motion) = (folder.join("mit6837/Model1.obj"), folder.join("cosc422/original/Dwarf/avatar_walk.bvh"));
    let scratch = |name: &str| std::env::temp_dir().join(format!("gaitway-lent-{}-{name}", std::process::id()));
    let (map, out) = (scratch("map.json"), scratch("out.glb"));
    let joints = r##"{ "gaitway_map": 1, "joints": { "joint 5": { "source": 18 }, "joint 6": { "source": 19 },
        "#9": { "source": 15 }, "#10": { "source": 16 } } }"##;
    std::fs::write(&map, joints).expect("a scratch file");
    let text = |path: &PathBuf| path.to_str().expect("a plain path").to_owned();
    let arguments = [
        "retarget",
        "--model",
        &text(&model),
        "--motion",
        &text(&motion),
        "--map",
        &text(&map),
        "--out",
        &text(&out),
        "--json",
    ];
    let report: Value = serde_json::from_slice(&run(&arguments)).expect("JSON");
    let opened = open_paths(std::slice::from_ref(&out)).expect("it was written").model;
    std::fs::remove_file(&map).expect("it was written");
    std::fs::remove_file(&out).expect("it was written");
    assert_eq!(report["mapped"].as_array().map(Vec::len), Some(4));
    assert_eq!((opened.asset.clips.len(), opened.rig().skin_joints()), (1, 18));
    let moved: Vec<usize> = opened.asset.clips[0]
        .channels()
        .iter()
        .map(|channel| opened.asset.skeleton.source_index(channel.joint))
        .collect();
    assert!([5, 6, 9, 10].iter().all(|joint| moved.contains(joint)), "{moved:?}");
}
