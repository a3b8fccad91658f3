//! Pins.

use glam::Vec3;
use serde_json::Value;

use crate::motion::folder;
use crate::program::{check_fails, document, run};

/// Positions of a node of the pose document.
fn node(document: &Value, name: &str) -> Vec3 {
    let nodes = document["nodes"].as_array().expect("nodes");
    let node = nodes.iter().find(|node| node["name"] == name).expect("is there");
    let at = |index: usize| node["world"][index].as_f64().expect("a number") as f32;
    Vec3::new(at(12), at(13), at(14))
}

#[test]
fn poses_are_pinned_by_name_body_part_and_index() {
    let hand = |pin: &str| {
        node(
            &document(&["pose", "sample:walker", "--clip", "Walk", "--time", "0.4", "--pin", pin, "--json"]),
            "LeftHand",
        )
    };
    for joint in ["LeftHand", "leftHand", "9", "#9"] {
        let found = hand(&format!("{joint}=at:0.25,1.2,0.3"));
        assert!(found.distance(Vec3::new(0.25, 1.2, 0.3)) < 1e-5, "{joint}: {found}");
    }
    let pinned = document(&["pose", "sample:walker", "--pin", "leftHand=joint:Hips,0.3,0.2,0.1", "--json"]);
    assert!(node(&pinned, "LeftHand").distance(node(&pinned, "Hips")) < 0.4);
    assert_eq!(hand("leftHand=at:0.25,1.2,0.3@0.8,0.9,0.1"), hand("head=look:camera"), "not yet");
}

#[test]
fn clips_are_written_with_pins() {
    let (folder, motion) = folder("pins");
    let path = |name: &str| folder.join(name).to_str().expect("a plain path").to_owned();
    let (model, out) = (path("model.glb"), path("out.glb"));
    std::fs::copy("assets/samples/dwarf.glb", &model).expect("a copy");
    let done =
        run(&["retarget", "--model", &model, "--motion", &motion, "--pin", "leftHand=at:0.3,0.9,0.4", "--out", &out]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let clips = document(&["inspect", &out, "--json"])["clips"].as_array().expect("clips").len();
    let name = {
        let model = gaitway::files::open_paths(&[model.clone().into()]).expect("opens").model;
        let hand = model.recognition().joint(gaitway_character::asset::Slot::LeftHand).expect("a hand");
        model.asset.skeleton.name(hand).to_owned()
    };
    let at = |file: &str, clip: usize, time: &str| {
        node(&document(&["pose", file, "--clip", &clip.to_string(), "--time", time, "--json"]), &name)
    };
    let (one, other) = (at(&out, clips - 1, "0.1"), at(&out, clips - 1, "0.37"));
    assert!(one.distance(other) < 3e-4, "{one} {other}: the hand stays");
    // Conversion changes one of the file's own clips, under another name.
    let converted = path("converted.glb");
    let own = document(&["inspect", &model, "--json"])["clips"].as_array().expect("clips").len();
    assert!(own > 0);
    let done = run(&["convert", &model, "--pin", &format!("{name}=at:0.3,0.9,0.4"), "--out", &converted]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let pin = format!("{name}=at:0.3,0.9,0.4");
    let shown = document(&["pose", &model, "--clip", "0", "--time", "0.3", "--pin", &pin, "--json"]);
    assert!(at(&converted, own, "0.3").distance(node(&shown, &name)) < 3e-4);
}

#[test]
fn a_written_clip_that_a_layer_makes_longer_repeats_its_pins() {
    let out = folder("pinned-layers").0.join("out.glb");
    let out = out.to_str().expect("a plain path");
    let (layer, pin) = ("Wave:speed:1.3125", "leftHand=at:0.25,1.2,0.3@0.3,0.6,0.2");
    let (model, walk) = (["--model", "sample:walker"], ["--motion", "sample:walker", "--clip", "Walk"]);
    let done =
        run(&[&["retarget"], &model[..], &walk, &["--layer", layer, "--pin", pin, "--clip-only", "--out", out]]
            .concat());
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let secs = |document: &Value| document["clips"][0]["duration_secs"].as_f64().expect("a clip");
    let walk_secs = secs(&document(&["inspect", "sample:walker", "--json"]));
    let written_secs = secs(&document(&["inspect", out, "--json"]));
    assert!((written_secs - 2.0 * walk_secs).abs() < 1e-4, "{written_secs}");
    for time_secs in [0.45, 0.45 + walk_secs] {
        let found =
            node(&document(&["pose", out, "--clip", "0", "--time", &time_secs.to_string(), "--json"]), "LeftHand");
        assert!(found.distance(Vec3::new(0.25, 1.2, 0.3)) < 3.6e-4, "{time_secs}: {found}");
    }
}

#[test]
fn wrong_pins_are_refused() {
    let pose = |pin: &'static str| ["pose", "sample:walker", "--json", "--pin", pin];
    for bad in ["LeftHand", "LeftHand=", "LeftHand=at:1,2", "LeftHand=hold:1,2,3", "LeftHand=at:1,2,3@1"] {
        let output = run(&pose(bad));
        assert_eq!(output.status.code(), Some(2), "{bad}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("look:camera"), "{bad}");
    }
    let plain = |pin: &'static str| ["pose", "sample:walker", "--pin", pin];
    check_fails(
        &plain("LeftHnad=at:0,1,0"),
        1,
        "--pin: expected the name, index or body part of a joint, found “LeftHnad”",
    );
    check_fails(&plain("leftHand=joint:Nose"), 1, "Nose");
    check_fails(&plain("Hips=at:0,1,0"), 1, "--pin: expected the end of two bones, found “Hips=at:0,1,0”");
    check_fails(&plain("leftHand=joint:LeftUpperArm"), 1, "doesn't move along");
    let (folder, motion) = folder("pin-camera");
    let out = folder.join("out.glb");
    let call = [
        "retarget",
        "--model",
        "sample:walker",
        "--motion",
        &motion,
        "--clip-only",
        "--pin",
        "Head=look:camera",
        "--out",
    ];
    check_fails(&[&call[..], &[out.to_str().expect("a plain path")]].concat(), 1, "use look:X,Y,Z");
}
