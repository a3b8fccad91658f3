//! The command line as scripts use it: exit status, one document on standard output, everything else on standard error.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

pub fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gaitway")).args(arguments).output().expect("the program runs")
}

pub fn document(arguments: &[&str]) -> Value {
    let output = run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON document")
}

/// Checks the status, that the error contains this text, and that nothing is printed to standard output.
pub fn check_fails(arguments: &[&str], status: i32, says: &str) {
    let output = run(arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{arguments:?}: {error}");
    assert!(error.contains(says), "{arguments:?}: {error}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().expect("an object").keys().map(String::as_str).collect()
}

fn positions(document: &Value) -> Vec<f64> {
    let meshes = document["meshes"].as_array().expect("meshes");
    meshes.iter().flat_map(|mesh| mesh["positions"].as_array().expect("positions")).filter_map(Value::as_f64).collect()
}

#[test]
fn incorrect_usage_is_status_2() {
    check_fails(&["inspect"], 2, "FILE");
    check_fails(&["inspect", "sample:walker", "--jason"], 2, "--jason");
    check_fails(&["pose", "sample:walker", "--skinning", "soft"], 2, "dual-quaternion");
    check_fails(&["pose", "sample:walker", "--time", "soon"], 2, "--time");
}

#[test]
fn failures_are_status_1_and_say_what_to_do() {
    check_fails(&["inspect", "no/such/file.glb"], 1, "error: no/such/file.glb");
    check_fails(&["inspect", "sample:nobody"], 1, "sample:walker");
    check_fails(&["pose", "sample:walker", "--clip", "Fly"], 1, "“Walk”, “Idle”, “Wave”");
    check_fails(&["pose", "sample:walker", "--time", "NaN"], 1, "seconds");
    check_fails(&["inspect", "Cargo.toml"], 1, "error: ");
}

#[test]
fn help_and_version_are_not_failures() {
    assert_eq!(run(&["--help"]).status.code(), Some(0));
    assert_eq!(run(&["--version"]).status.code(), Some(0));
}

#[test]
fn inspect_prints_the_documented_keys() {
    let document = document(&["inspect", "sample:walker", "--json"]);
    let expected = [
        "files",
        "format",
        "generator",
        "nodes",
        "skins",
        "joints",
        "meshes",
        "primitives",
        "parts",
        "vertices",
        "triangles",
        "morph_targets",
        "clips",
        "borrowed_clips",
        "variants",
        "texture_bytes",
        "cameras",
        "avatar",
        "extensions_used",
        "extensions_required",
        "bounds",
        "warnings",
    ];
    assert_eq!(keys(&document), expected);
    assert_eq!(document["skins"], serde_json::json!([{ "name": "Walker", "joints": 22 }]));
    assert_eq!(
        keys(&document["clips"][0]),
        ["index", "name", "duration_secs", "channels", "interpolations", "properties"]
    );
    assert_eq!(keys(&document["clips"][0]["interpolations"]), ["linear", "step", "cubicspline"]);
    assert_eq!((&document["nodes"], &document["joints"]), (&24.into(), &22.into()));
    let height = document["bounds"]["max"][1].as_f64().expect("a number");
    assert!((1.7..1.8).contains(&height), "{height}");
}

#[test]
fn pose_prints_the_documented_keys() {
    let document = document(&["pose", "sample:walker", "--clip", "Walk", "--time", "0.5", "--json"]);
    assert_eq!(keys(&document), ["clip", "time_secs", "nodes", "meshes", "warnings"]);
    assert_eq!((&document["clip"], &document["time_secs"]), (&"Walk".into(), &0.5.into()));
    let nodes = document["nodes"].as_array().expect("nodes");
    let numbers: Vec<u64> = nodes.iter().filter_map(|node| node["node"].as_u64()).collect();
    assert_eq!(numbers, (0..24).collect::<Vec<_>>());
    assert_eq!(keys(&nodes[0]), ["node", "name", "world"]);
    assert_eq!(nodes[1]["world"].as_array().map(Vec::len), Some(16));
    let mesh = &document["meshes"][0];
    assert_eq!(keys(mesh), ["node", "mesh", "primitive", "positions", "normals"]);
    assert_eq!(mesh["node"], 22);
    assert_eq!(mesh["normals"].as_array().map(Vec::len), mesh["positions"].as_array().map(Vec::len));
}

#[test]
fn no_clip_is_the_rest_pose_and_times_clamp() {
    let rest = document(&["pose", "sample:walker", "--json"]);
    assert_eq!((&rest["clip"], &rest["time_secs"]), (&Value::Null, &0.0.into()));
    // T-pose.
    assert!(positions(&rest).into_iter().step_by(3).fold(0.0, f64::max) > 0.8);
    let end = document(&["pose", "sample:walker", "--clip", "2", "--time", "99", "--json"]);
    let before = document(&["pose", "sample:walker", "--clip", "2", "--time", "-1", "--json"]);
    assert!((end["time_secs"].as_f64().expect("a number") - 2.8).abs() < 1e-6);
    assert_eq!(before["time_secs"], 0.0);
    assert_eq!(positions(&end), positions(&before), "Wave ends as it begins");
}

#[test]
fn skinning_modes_differ_where_joints_bend() {
    let of = |mode| {
        positions(&document(&[
            "pose",
            "sample:walker",
            "--clip",
            "Walk",
            "--time",
            "0.2",
            "--skinning",
            mode,
            "--json",
        ]))
    };
    let (linear, rigid, dual) = (of("linear"), of("rigid"), of("dual-quaternion"));
    let apart = |other: &[f64]| linear.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!((1e-3..0.2).contains(&apart(&rigid)), "{}", apart(&rigid));
    assert!((1e-4..0.1).contains(&apart(&dual)), "{}", apart(&dual));
}

#[test]
fn the_default_output_is_text() {
    let text = String::from_utf8(run(&["inspect", "sample:walker"]).stdout).expect("text");
    assert!(text.contains("Wave, 2.800 s") && serde_json::from_str::<Value>(&text).is_err(), "{text}");
    let text = String::from_utf8(run(&["pose", "sample:walker"]).stdout).expect("text");
    assert!(text.contains("LeftFoot"), "{text}");
}

#[test]
fn companion_files_are_found_beside_the_model_and_in_folders() {
    let Some(data) = crate::data_folder::data_folder() else { return };
    let of = |path: &Path| document(&["inspect", path.to_str().expect("a plain path"), "--json"]);
    let folder = data.join("khronos/CesiumMan/glTF");
    let (beside, inside) = (of(&folder.join("CesiumMan.gltf")), of(&folder));
    for found in [&beside, &inside] {
        assert_eq!((&found["vertices"], &found["joints"]), (&3273.into(), &19.into()), "{}", found["files"]);
        let codes: Vec<_> =
            found["warnings"].as_array().expect("warnings").iter().map(|warning| &warning["code"]).collect();
        assert!(!codes.contains(&&Value::from("image-missing")), "{codes:?}");
    }
}
