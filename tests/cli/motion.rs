//! The subcommands that use motions, as scripts use them.

use std::path::PathBuf;

use serde_json::{Value, json};

use crate::data_folder::data_folder;
use crate::program::{check_fails, document, run};
use crate::walk_bvh::BVH;

/// Creates a folder for one test with the BVH file in it.
pub fn folder(name: &str) -> (PathBuf, String) {
    let folder = std::env::temp_dir().join(format!("gaitway-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let motion = folder.join("walk.bvh");
    std::fs::write(&motion, BVH).expect("a file");
    (folder, motion.to_str().expect("a plain path").to_owned())
}

#[test]
fn a_proposed_map_is_explained_and_can_be_reused() {
    let (folder, motion) = folder("map");
    let out = folder.join("map.json");
    let out = out.to_str().expect("a plain path");
    let call = ["map", "--model", "sample:walker", "--motion", &motion, "--out", out, "--json"];
    let proposed = document(&call);
    assert_eq!(proposed["gaitway_map"], 1);
    let joints = proposed["joints"].as_object().expect("joints");
    assert!(joints.len() >= 8, "{joints:?}");
    let leg = joints.values().find(|entry| entry["slot"] == "leftLowerLeg").expect("a shin");
    assert_eq!(leg["source"], "LeftLeg");
    assert!(leg["confidence"].as_f64().expect("a number") > 0.5 && leg["reason"].is_string());
    // Both the written file and the printed document are maps.
    let printed = folder.join("printed.json");
    std::fs::write(&printed, proposed.to_string()).expect("a file");
    let pose =
        |map: &str| document(&["pose", "sample:walker", "--motion", &motion, "--map", map, "--time", "0.3", "--json"]);
    let (written, printed) = (pose(out), pose(printed.to_str().expect("a plain path")));
    assert_eq!(written, printed);
    assert_eq!(written["clip"], "walk");
    let unposed = document(&["pose", "sample:walker", "--json"]);
    assert_ne!(unposed["nodes"], written["nodes"]);
}

/// Nothing to propose: the map lists the model's joints without sources.
#[test]
fn without_a_match_the_map_is_empty_to_be_filled_in() {
    let (folder, _) = folder("nothing");
    let snake = folder.join("snake.bvh");
    let text = "HIERARCHY\nROOT s1\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT s2\n{\nOFFSET 0 0 9\n\
                CHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 0 9\n}\n}\n}\nMOTION\nFrames: 1\nFrame Time: 1\n\
                0 0 0 0 0 0\n";
    std::fs::write(&snake, text).expect("a file");
    let snake = snake.to_str().expect("a plain path");
    let map = document(&["map", "--model", "sample:walker", "--motion", snake, "--json"]);
    let joints = map["joints"].as_object().expect("joints");
    assert!(joints.len() > 10 && joints.values().all(|entry| entry["source"].is_null()), "{joints:?}");
    assert_eq!(map["warnings"][0]["code"], "nothing-matches");
}

#[test]
fn a_link_loads_its_motion_and_map() {
    let (folder, motion) = folder("linked");
    let named = document(&["pose", "sample:walker", "--motion", &motion, "--time", "0.3", "--json"]);
    let unposed = document(&["pose", "sample:walker", "--json"]);
    let own = document(&["inspect", "sample:walker", "--json"])["clips"].as_array().map_or(0, Vec::len);
    let link = format!("v=1&motion=file:{motion}&clip={own}&t=0.3");
    let linked = document(&["pose", "sample:walker", &motion, "--view", &link, "--json"]);
    assert_eq!(linked["nodes"], named["nodes"]);
    assert_ne!(linked["nodes"], unposed["nodes"]);
    // The joints of an exercise model have generated names, which its map refers to.
    let file = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).expect("a file");
        path.to_str().expect("a plain path").to_owned()
    };
    let model = file("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
    file("m.skel", "0 0 0 -1\n0 1 0 0\n");
    file("m.attach", "1\n1\n1\n");
    let map = file("m.json", r#"{ "gaitway_map": 1, "joints": { "joint 1": { "source": "LeftUpLeg" } } }"#);
    let out = folder.join("out.glb");
    let out = out.to_str().expect("a plain path");
    let convert = |link: &str| {
        let done = run(&["convert", &model, "--view", link, "--out", out]);
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let stderr = String::from_utf8_lossy(&done.stderr).into_owned();
        (document(&["pose", out, "--json"])["nodes"][1]["world"].clone(), stderr)
    };
    let (still, stderr) = convert("v=1");
    assert_eq!(stderr, "");
    let (moved, stderr) = convert(&format!("v=1&motion=file:{motion}&map={map}&clip=walk&t=0"));
    assert_ne!(moved, still, "{stderr}");
    let (left_out, stderr) = convert("v=1&motion=file:nowhere.bvh&map=nowhere.json&clip=walk");
    assert_eq!(left_out, still);
    assert!(stderr.contains("nowhere.bvh") && stderr.contains("nowhere.json"), "{stderr}");
}

#[test]
fn retarget_reports_the_documented_keys() {
    let (folder, motion) = folder("retarget");
    let out = folder.join("out.glb");
    let out = out.to_str().expect("a plain path");
    let call = ["retarget", "--model", "sample:walker", "--motion", &motion, "--clip-only", "--out", out, "--json"];
    let report = document(&call);
    for key in [
        "mapped",
        "unmapped_targets",
        "unused_sources",
        "hips_scale",
        "duration_secs",
        "keys_in",
        "keys_out",
        "resampled",
        "figures",
        "motion_rest",
        "planting",
        "warnings",
    ] {
        assert!(report.get(key).is_some(), "{key}");
    }
    for key in [
        "orientation_error_degrees_mean",
        "orientation_error_degrees_max",
        "limb_direction_error_degrees_mean",
        "limb_direction_error_degrees_max",
        "facing_error_degrees_mean",
        "facing_error_degrees_max",
        "foot_slide_metres_per_sec",
        "foot_slide_source_metres_per_sec",
        "ground_penetration_metres_max",
        "foot_hover_metres_mean",
        "sole_penetration_metres_max",
        "largest_turn_degrees_per_frame",
        "jerk_metres_per_sec3_mean",
        "self_penetration_share",
        "contact_error_metres_mean",
        "facing_path_error_degrees_mean",
        "skin_stretch_max",
        "skin_stretch_mean",
        "skin_stretch_max_joint",
        "skin_tear_max",
        "skin_tear_max_joint",
        "idle_chains",
        "coverage",
    ] {
        assert!(report["figures"].get(key).is_some(), "{key}");
    }
    assert_eq!(report["duration_secs"], 0.5);
    // The walker's spine shares the bend of the motion's, which has one joint.
    assert_eq!(report["resampled"], true);
    assert!(report["figures"]["orientation_error_degrees_max"].as_f64().expect("a number") < 0.01);
    let written = document(&["inspect", out, "--json"]);
    assert_eq!(written["clips"][0]["name"], "walk");
    assert_eq!(written["meshes"], 0);
}

#[test]
fn convert_writes_a_motion_in_the_requested_unit() {
    let (folder, motion) = folder("convert");
    let out = folder.join("out.glb");
    let out = out.to_str().expect("a plain path");
    let height = |unit: &str| {
        let done = run(&["convert", &motion, "--unit", unit, "--out", out]);
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let bounds = &document(&["inspect", out, "--json"])["bounds"];
        bounds["max"][1].as_f64().expect("a number") - bounds["min"][1].as_f64().expect("a number")
    };
    let (centimetres, inches) = (height("cm"), height("in"));
    assert!((centimetres - 1.45).abs() < 0.01 && (inches / centimetres - 2.54).abs() < 1e-3, "{centimetres}, {inches}");
}

#[test]
fn convert_refuses_options_that_would_have_no_effect() {
    let (folder, _) = folder("convert-options");
    let out = folder.join("out.glb");
    let out = out.to_str().expect("a plain path");
    check_fails(&["convert", "assets/samples/pilot.glb", "--unit", "cm", "--out", out], 1, "--unit: expected a .bvh");
    let view = ["convert", "assets/samples/ssd.obj", "--view", "pose=1:0:0:20", "--out", out];
    for (options, found) in [(["--unit", "cm"], "--unit"), (["--clip", "0"], "--clip"), (["--speed", "2"], "changes")] {
        let arguments: Vec<&str> = view.iter().chain(&options).copied().collect();
        check_fails(&arguments, 1, "--view: expected a pose alone, found ");
        check_fails(&arguments, 1, found);
    }
}

#[test]
fn errors_say_what_to_do() {
    let (folder, motion) = folder("errors");
    let file = |name: &str, content: Value| {
        let path = folder.join(name);
        std::fs::write(&path, content.to_string()).expect("a file");
        path.to_str().expect("a plain path").to_owned()
    };
    let pose = |map: &str| ["pose", "sample:walker", "--motion", &motion, "--map", map].map(str::to_owned);
    let check = |map: Value, says: &str| {
        let path = file("map.json", map);
        let arguments = pose(&path);
        check_fails(&arguments.each_ref().map(String::as_str), 1, says);
    };
    check(json!({ "gaitway_map": 1, "joints": { "Heed": { "source": "Head" } } }), "Head");
    check(json!({ "gaitway_map": 1, "joints": { "Head": { "source": 99 } } }), "99");
    check(json!({ "gaitway_map": 2, "joints": {} }), "version 1");
    check(json!({ "joints": {} }), "gaitway_map");
    check_fails(&["pose", "sample:walker", "--map", &file("map.json", json!({ "gaitway_map": 1 }))], 1, "--motion");
    check_fails(&["pose", "sample:walker", "--motion", &motion, "--clip", "Fly"], 1, "walk");
    let out = folder.join("no.glb");
    let out = out.to_str().expect("a plain path");
    let retarget = ["retarget", "--model", "sample:walker", "--motion", &motion, "--out", out];
    check_fails(&[&retarget[..], &["--clip", "Fly"]].concat(), 1, "walk");
    check_fails(&retarget, 1, "--clip-only");
    assert!(!std::path::Path::new(out).exists(), "a failed command writes nothing");
    check_fails(&["retarget", "--model", "sample:walker", "--out", out], 2, "--motion");
    check_fails(&["pose", "sample:walker", "--motion", &motion, "--clip", "-1"], 1, "“-1”; its clips are “Walk”");
    check_fails(&[&retarget[..], &["--clip", "-1"]].concat(), 1, "“-1”; its clips are “walk”");
}

#[test]
fn errors_in_a_map_name_its_file() {
    let (folder, motion) = folder("map-errors");
    let map = folder.join("map.json");
    let path = map.to_str().expect("a plain path");
    let out = folder.join("out.glb");
    let retarget = ["retarget", "--model", "sample:walker", "--motion", &motion, "--map", path, "--out"];
    let retarget = [&retarget[..], &[out.to_str().expect("a plain path"), "--clip-only"]].concat();
    let pose = ["pose", "sample:walker", "--motion", &motion, "--map", path];
    for (joints, says) in [
        (
            json!({ "Heed": { "source": "Head" } }),
            "map.json: joints.Heed: the model has no joint “Heed”; nearest: Head",
        ),
        (json!({ "Head": { "source": null } }), "map.json: no joint of the model follows the motion"),
    ] {
        std::fs::write(&map, json!({ "gaitway_map": 1, "joints": joints }).to_string()).expect("a file");
        check_fails(&retarget, 1, says);
        check_fails(&pose, 1, says);
    }
    std::fs::write(&map, json!({ "gaitway_map": 1, "joints": { "Head": { "source": "Head" } } }).to_string())
        .expect("a map");
    let of_option = [&retarget[..], &["--unmapped", "Fly"]].concat();
    check_fails(&of_option, 1, "error: --unmapped: unmapped.clip: the model has no clip “Fly”");
}

/// Its rest pose and its clip are written as well, in the order in which they play.
#[test]
fn a_motion_alone_can_be_the_model() {
    let (folder, motion) = folder("bvh-model");
    let out = folder.join("out.glb");
    let out = out.to_str().expect("a plain path");
    let report = document(&["retarget", "--model", &motion, "--motion", "sample:walker", "--out", out, "--json"]);
    assert_eq!(report["clip"], "Walk");
    let inspect = |file: &str| document(&["inspect", file, "--json"]);
    let (before, written) = (inspect(&motion), inspect(out));
    let names: Vec<&Value> = written["clips"].as_array().expect("clips").iter().map(|clip| &clip["name"]).collect();
    assert_eq!(names, ["walk", "Walk"]);
    assert_eq!((&written["nodes"], &written["format"]), (&before["nodes"], &"glb".into()));
    let pose = |file: &str| document(&["pose", file, "--clip", "walk", "--time", "0.3", "--json"])["nodes"].clone();
    assert_eq!(pose(out), pose(&motion));
}

/// A model beside motions, in a folder or an archive.
#[test]
fn one_of_several_files_in_a_folder_is_named_with_it() {
    let (folder, motion) = folder("members");
    let path = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    let set = folder.join("set");
    std::fs::create_dir_all(&set).expect("a folder");
    let walker = path("set/walker.glb");
    let retarget = ["retarget", "--model", "sample:walker", "--motion", &motion, "--clip-only", "--out", &walker];
    assert!(run(&retarget).status.success());
    for name in ["a.bvh", "b.bvh"] {
        std::fs::copy(&motion, set.join(name)).expect("a copy");
    }
    let (set, out) = (path("set"), path("out.glb"));
    check_fails(
        &["map", "--model", &walker, "--motion", &set],
        1,
        "expected one motion, found a.bvh, b.bvh, walker.glb",
    );
    let member = format!("{set}#!/b.bvh");
    let report = document(&["retarget", "--model", &walker, "--motion", &member, "--out", &out, "--json"]);
    assert_eq!(report["clip"], "b");
    check_fails(
        &["inspect", &format!("{set}#!/c.bvh")],
        1,
        "“c.bvh” is not among the files (a.bvh, b.bvh, walker.glb)",
    );
}

/// The extension of the output chooses the format; what can't be written in it fails before anything is.
#[test]
fn clips_are_written_as_bvh_and_vrma() {
    let (folder, motion) = folder("clips");
    let path = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    let inspect = |file: &str| document(&["inspect", file, "--json"]);
    let (bvh, vrma, again) = (path("out.bvh"), path("out.vrma"), path("again.vrma"));
    for out in [&bvh, &vrma] {
        let call = ["retarget", "--model", "sample:walker", "--motion", &motion, "--out", out, "--json"];
        assert_eq!(document(&call)["clip"], "walk");
    }
    assert!(run(&["convert", &bvh, "--out", &again]).status.success());
    let (bvh, vrma, again) = (inspect(&bvh), inspect(&vrma), inspect(&again));
    assert_eq!([&bvh["format"], &vrma["format"], &again["format"]], ["bvh", "vrma", "vrma"]);
    for written in [&bvh, &vrma, &again] {
        assert_eq!(written["clips"][0]["duration_secs"], 0.5);
    }
    assert_eq!(vrma["extensions_used"], json!(["VRMC_vrm_animation"]));
    let out = path("own.bvh");
    assert!(run(&["convert", &motion, "--clip", "walk", "--out", &out]).status.success());
    let pose = |file: &str| document(&["pose", file, "--clip", "0", "--time", "0.25", "--json"])["nodes"].clone();
    let (own, written) = (pose(&motion), pose(&out));
    for (one, other) in own.as_array().expect("nodes").iter().zip(written.as_array().expect("nodes")) {
        for (a, b) in one["world"].as_array().expect("16").iter().zip(other["world"].as_array().expect("16")) {
            assert!((a.as_f64().expect("a number") - b.as_f64().expect("a number")).abs() < 2e-5, "{one} {other}");
        }
    }
    check_fails(&["convert", &motion, "--clip", "Fly", "--out", &out], 1, "Fly");
    check_fails(&["convert", &motion, "--clip", "walk", "--out", &path("own.glb")], 1, "a .glb has all clips");
}

/// `pose --json` of the first clip: world positions by node.
fn places(file: &str, clip: &str, time: &str) -> Vec<[f64; 3]> {
    let document = document(&["pose", file, "--clip", clip, "--time", time, "--json"]);
    let place = |node: &Value| [12, 13, 14].map(|at| node["world"][at].as_f64().expect("a number"));
    document["nodes"].as_array().expect("nodes").iter().map(place).collect()
}

#[test]
fn clips_are_changed_on_the_way() {
    let (folder, motion) = folder("changes");
    let path = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    let (mirrored, twice, reversed, model) = (path("1.bvh"), path("2.bvh"), path("3.bvh"), path("4.glb"));
    assert!(run(&["convert", &motion, "--mirror", "--out", &mirrored]).status.success());
    assert!(run(&["convert", &mirrored, "--mirror", "--out", &twice]).status.success());
    assert!(run(&["convert", &motion, "--reverse", "--speed", "2", "--out", &reversed]).status.success());
    let near = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4);
    let (own, once, back) = (places(&motion, "0", "0.5"), places(&mirrored, "0", "0.5"), places(&twice, "0", "0.5"));
    assert!(own.iter().zip(&back).all(|(a, b)| near(a, b)), "twice is the clip");
    // In file order: 5 is the left foot, 8 the right one.
    let in_mirror = |at: &[f64; 3]| [-at[0], at[1], at[2]];
    assert!(near(&in_mirror(&own[5]), &once[8]) && near(&in_mirror(&own[8]), &once[5]), "{own:?} {once:?}");
    assert!(!near(&own[5], &once[5]));
    let start = places(&motion, "0", "0");
    assert!(
        places(&reversed, "0", "0.25").iter().zip(&start).all(|(a, b)| near(a, b)),
        "ends where it began, in half the time"
    );
    // A whole model keeps its clips, and the changed one is added.
    assert!(run(&["convert", &motion, "--turn", "90", "--offset", "1,-2", "--out", &model]).status.success());
    let names: Vec<Value> = document(&["inspect", &model, "--json"])["clips"]
        .as_array()
        .expect("clips")
        .iter()
        .map(|clip| clip["name"].clone())
        .collect();
    assert_eq!(names, ["walk", "walk (changed)"]);
    let moved = places(&model, "1", "0");
    assert!((moved[0][0] - start[0][0] - 1.0).abs() < 1e-5 && (moved[0][2] - start[0][2] + 2.0).abs() < 1e-5);
    let out = path("5.glb");
    let report = document(&[
        "retarget",
        "--model",
        "sample:walker",
        "--motion",
        &motion,
        "--mirror",
        "--make-loop",
        "0.1",
        "--out",
        &out,
        "--clip-only",
        "--json",
    ]);
    assert_eq!(report["changed"]["changes"]["mirror"], true);
    assert!(report["changed"]["seam"]["degrees_max"].as_f64().expect("a number") > 10.0, "{}", report["changed"]);
    assert_eq!(
        report["warnings"].as_array().map(|list| list.iter().filter(|one| one["code"] == "nothing-to-swap").count()),
        Some(0)
    );
    check_fails(&["convert", &motion, "--trim", "1,0.5", "--out", &out], 2, "START,END");
    let beyond = "--trim: expected an end within the 0.500 s of clip “walk”, found 0.9 s";
    check_fails(&["convert", &motion, "--trim", "0.2,0.9", "--out", &out], 1, beyond);
    // Durations are printed in milliseconds.
    assert!(run(&["convert", &motion, "--trim", "0.2,0.5004", "--out", &out]).status.success());
    check_fails(&["convert", &motion, "--speed", "0", "--out", &out], 2, "0.1 to 10");
}

/// A clip that ends elsewhere than it starts says by how much, in the report for people, too.
#[test]
fn a_loop_says_how_far_apart_its_ends_were() {
    let (folder, motion) = folder("loop");
    let out = folder.join("looped.bvh");
    let out = out.to_str().expect("a plain path");
    let output = run(&["convert", &motion, "--make-loop", "0.1", "--out", out]);
    let told = [output.stdout, output.stderr].concat();
    let told = String::from_utf8(told).expect("UTF-8");
    // Thighs and shins swing by 40°, and the hips travel by 30 cm of 165.
    assert!(told.contains("40.0° and 0.0 cm apart, not counting 0.30 m of travel"), "{told}");
    let near = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4);
    let (start, end) = (places(out, "0", "0"), places(out, "0", "0.5"));
    let travelled = |at: &[f64; 3]| [at[0], at[1], at[2] - 0.3];
    assert!(start.iter().zip(&end).all(|(start, end)| near(start, &travelled(end))), "{start:?} {end:?}");
}

/// The hips of the motion rest beside the origin, so its own path starts away from its rest.
#[test]
fn the_path_starts_where_the_motion_or_its_rest_is() {
    let (folder, _) = folder("origin");
    let path = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    let (motion, map) = (path("aside.bvh"), path("map.json"));
    std::fs::write(&motion, BVH.replacen("OFFSET 0 90 0", "OFFSET 50 90 0", 1)).expect("a file");
    assert!(run(&["map", "--model", "sample:walker", "--motion", &motion, "--out", &map]).status.success());
    let retargeted = |options: &[&str]| {
        let out = path("out.bvh");
        let call =
            ["retarget", "--model", "sample:walker", "--motion", &motion, "--map", &map, "--out", &out, "--json"];
        let scale = document(&[&call[..], options].concat())["hips_scale"].as_f64().expect("a number");
        let posed = document(&["pose", &out, "--clip", "0", "--time", "0", "--json"]);
        let nodes = posed["nodes"].as_array().expect("nodes");
        let hips = nodes.iter().find(|node| node["name"] == "Hips").expect("is written");
        (scale, [12, 14].map(|at| hips["world"][at].as_f64().expect("a number")))
    };
    let hips = |options: &[&str]| retargeted(options).1;
    let scale = retargeted(&[]).0;
    let (feet, rest) = (hips(&["--origin", "feet"]), hips(&["--origin", "rest"]));
    assert!(feet[0].abs() < 1e-4 && (rest[0] + 0.5 * scale).abs() < 1e-4, "{feet:?} {rest:?} × {scale}");
    assert_eq!(hips(&[]), feet, "feet is the default");
    let mut written: Value = serde_json::from_slice(&std::fs::read(&map).expect("a map")).expect("JSON");
    written["root"]["origin"] = json!("rest");
    std::fs::write(&map, written.to_string()).expect("a file");
    assert_eq!((hips(&[]), hips(&["--origin", "feet"])), (rest, feet), "the option overrides the map");
}

#[test]
fn layers_are_posed_and_written() {
    let (folder, motion) = folder("layers");
    let path = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    let at = |layer: &[&str], time: &str| {
        let pose = [&["pose", "sample:walker", "--clip", "Walk", "--time", time, "--json"], layer].concat();
        document(&pose)["nodes"].clone()
    };
    let wave = document(&["pose", "sample:walker", "--clip", "Wave", "--time", "0.5", "--json"])["nodes"].clone();
    assert_eq!(at(&["--layer", "Wave"], "0.5"), wave);
    assert_eq!(at(&["--layer", "Wave:weight:0"], "0.5"), at(&[], "0.5"));
    let arm = at(&["--layer", "Wave:mask:right-arm"], "0.5");
    assert!(arm != wave && arm != at(&[], "0.5"));
    assert_eq!(at(&["--view", "v=1&layers=Wave:mask:right-arm"], "0.5"), arm);
    // On what a motion gives the model, and written.
    let out = path("out.glb");
    let retarget =
        ["retarget", "--model", "sample:walker", "--motion", &motion, "--clip-only", "--json", "--out", &out];
    let layers = ["--layer", "Wave:speed:5.6,mask:right-arm:left-arm"];
    let report = document(&[&retarget[..], &layers].concat());
    let codes = report["warnings"].as_array().expect("a list").iter().map(|warning| warning["code"].clone());
    assert_eq!(codes.collect::<Vec<_>>(), ["unit-guessed"], "the wave ends with the walk");
    let (names, plain) = (places(&out, "0", "0.25"), path("plain.glb"));
    let retarget = ["retarget", "--model", "sample:walker", "--motion", &motion, "--clip-only", "--out", &plain];
    assert!(run(&retarget).status.success());
    let apart = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let moved: Vec<f64> = names.iter().zip(&places(&plain, "0", "0.25")).map(|(a, b)| apart(a, b)).collect();
    assert!(moved.iter().any(|&distance| distance > 0.1) && moved.contains(&0.0), "{moved:?}");
    // A clip of a file over another of the same file.
    let turned = path("turned.glb");
    let convert = ["convert", &motion, "--layer", "walk:additive,start:0.25,weight:0.5", "--out", &turned];
    assert!(run(&convert).status.success());
    assert_ne!(places(&turned, "1", "0.1"), places(&motion, "0", "0.1"));
    let clips = "--layer: expected the name or index of a clip, found “Fly”; its clips are “Walk”, “Idle”, “Wave”";
    check_fails(&["pose", "sample:walker", "--clip", "Walk", "--layer", "Fly"], 1, clips);
    check_fails(&["convert", &motion, "--layer", "Fly", "--out", &turned], 1, "found “Fly”");
    check_fails(&["pose", "sample:walker", "--layer", "Wave:mask:wing"], 2, "left-arm");
    check_fails(&["pose", "sample:walker", "--layer", "Wave:weight:NaN"], 2, "expected a clip");
    check_fails(&["pose", "sample:walker", "--layer", "Wave:weight:2"], 2, "a weight from 0 to 1");
    check_fails(&["pose", "sample:walker", "--layer", "Wave:mask:4000"], 1, "found 4000");
}

#[test]
fn contacts_are_kept_by_the_option_or_by_the_map() {
    let Some(data) = data_folder() else { return };
    let (folder, _) = folder("contacts");
    let path = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    let [model, motion] = ["khronos/CesiumMan/glTF-Binary/CesiumMan.glb", "bvh/assimp_Boxing_Toes.bvh"]
        .map(|name| data.join(name).to_str().expect("a plain path").to_owned());
    let (map, out) = (path("map.json"), path("out.glb"));
    assert!(run(&["map", "--model", &model, "--motion", &motion, "--out", &map]).status.success());
    let mut written: Value = serde_json::from_slice(&std::fs::read(&map).expect("a map")).expect("JSON");
    written["contacts"] = json!("keep");
    std::fs::write(&map, written.to_string()).expect("a file");
    let made = |options: &[&str]| {
        let call = ["retarget", "--model", &model, "--motion", &motion, "--clip-only", "--out", &out, "--json"];
        let figures = document(&[&call[..], options].concat())["figures"].take();
        (figures["contact_error_metres_mean"].as_f64().expect("contacts"), std::fs::read(&out).expect("a file"))
    };
    let (plain, kept) = (made(&[]), made(&["--contacts", "keep"]));
    assert!(kept.0 < 0.6 * plain.0, "{} and {} m", plain.0, kept.0);
    assert!(made(&["--map", &map]) == kept && made(&["--map", &map, "--contacts", "off"]) == plain);
}

/// Names of the clips in a file.
fn clip_names(file: &str) -> Vec<String> {
    let document = document(&["inspect", file, "--json"]);
    let clips = document["clips"].as_array().expect("clips").iter();
    clips.map(|clip| clip["name"].as_str().expect("a name").to_owned()).collect()
}

#[test]
fn a_written_clip_has_the_name_that_was_asked_for_or_that_of_its_file() {
    let (folder, motion) = folder("clip-names");
    let path = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    let out = path("out.glb");
    let retarget = ["retarget", "--model", "sample:walker", "--clip-only", "--out", &out, "--motion"];
    assert!(run(&[&retarget[..], &[&motion, "--name", "Stroll: 1"]].concat()).status.success());
    assert_eq!(clip_names(&out), ["Stroll: 1"]);
    assert!(run(&["convert", &motion, "--name", "Stroll", "--out", &out]).status.success());
    assert_eq!(clip_names(&out), ["Stroll"]);
    assert!(run(&["convert", &motion, "--name", "Stroll", "--turn", "10", "--out", &out]).status.success());
    assert_eq!(clip_names(&out), ["walk", "Stroll"], "a whole model keeps the original of a changed clip");
    let pilot = ["convert", "sample:pilot", "--out", &out, "--clip", "0"];
    let own = clip_names("sample:pilot");
    let output = run(&[&pilot[..], &["--name", &own[1]]].concat());
    assert!(String::from_utf8_lossy(&output.stderr).contains("another clip"), "{output:?}");
    assert_eq!(clip_names(&out), [&[format!("{} (2)", own[1])], &own[1..]].concat());
    check_fails(&["convert", &motion, "--name", " ", "--out", &out], 2, "not empty");
    // The name that Mixamo gives to every clip says nothing.
    let mixamo = path("Samba.glb");
    assert!(run(&["convert", &motion, "--name", "mixamo.com", "--out", &mixamo]).status.success());
    assert!(run(&[&retarget[..], &[&mixamo, "--clip", "mixamo.com"]].concat()).status.success());
    assert_eq!(clip_names(&out), ["Samba"]);
}
