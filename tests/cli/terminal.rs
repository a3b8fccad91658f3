//! Names come from files: a terminal shows whatever they contain and interprets none of it. JSON keeps them.

use std::fs;

use serde_json::{Value, json};

use crate::build_gltf::Build;
use crate::motion::folder;
use crate::program::{document, run};

/// A window title, a bell, a new line with a forged error, C1's own escape, and text that reads backwards.
const NAME: &str = "a\u{1b}]0;title\u{7}b\nerror: c\r\u{9b}2Jd\u{202e}e\u{2066}f\u{7f}g\u{2028}h\u{200f}";

#[test]
fn names_are_shown_and_obeyed_by_no_terminal() {
    let (folder, motion) = folder("terminal");
    let path = |name: &str| folder.join(name).to_str().expect("Unicode").to_owned();
    let mut build = Build::triangle();
    build.json["nodes"][0]["name"] = json!(NAME);
    build.json["asset"]["generator"] = json!(NAME);
    build.json["materials"] = json!([{ "name": NAME }]);
    build.json["extensionsUsed"] = json!([NAME, "KHR_materials_variants"]);
    build.json["extensions"] = json!({ "KHR_materials_variants": { "variants": [{ "name": NAME }] } });
    build.json["images"] = json!([{ "name": NAME, "uri": NAME }]);
    let model = path("model\u{1b}[31m.glb");
    fs::write(&model, build.glb()).expect("a file");
    let joint = path("joint.bvh");
    // A name of a .bvh ends with its line.
    let in_line = NAME.replace(['\n', '\r', '\u{2028}'], "");
    let text = fs::read_to_string(&motion).expect("a file");
    fs::write(&joint, text.replacen("LeftUpLeg", &in_line, 1)).expect("a file");
    let [out, clip, folder_out] = ["out.glb", "clip.glb", "batch"].map(path);
    let made = ["retarget", "--model", "sample:walker", "--motion", &joint, "--clip-only", "--out"];
    let batch = ["retarget", "--model", "sample:walker", "--motion", &path("no\u{1b}[m.bvh"), "--out-dir"];
    let calls: [&[&str]; 13] = [
        &["inspect", &model],
        &["pose", &model],
        &["pose", &joint, "--clip", "Fly"],
        &["pose", &joint, "--view", &format!("clip={NAME}&motion={NAME}")],
        &["pose", &model, "--motion", &joint],
        &["convert", &model, "--out", &out],
        &["map", "--model", &joint, "--motion", &motion],
        &[&made[..], &[&clip]].concat(),
        &[&made[..], &["-"]].concat(),
        &[&batch[..], &[&folder_out]].concat(),
        &["inspect", &path(NAME)],
        &["inspect", NAME],
        &["inspect", &model, &format!("--{NAME}")],
    ];
    let mut escaped = 0;
    for call in calls {
        let output = run(call);
        let is_binary = call.last() == Some(&"-");
        let printed = [&output.stderr, if is_binary { &output.stderr } else { &output.stdout }];
        for text in printed.map(|bytes| String::from_utf8(bytes.clone()).expect("UTF-8")) {
            // JSON has the characters that a name has.
            let is_obeyed = |letter: &char| {
                letter.is_control() && *letter != '\n' || "\u{202e}\u{2066}\u{2028}\u{200f}".contains(*letter)
            };
            let obeyed = if text.starts_with('{') { None } else { text.chars().find(is_obeyed) };
            assert!(obeyed.is_none() && !text.contains("\nerror: c"), "{call:?}: {obeyed:?}: {text:?}");
            escaped += text.matches("\\u{1b}").count();
        }
    }
    assert!(escaped > 20, "{escaped} names were printed");
    let inspected: Value = document(&["inspect", &model, "--json"]);
    assert_eq!((&inspected["generator"], &inspected["variants"][0]), (&json!(NAME), &json!(NAME)));
    fs::remove_dir_all(&folder).expect("it was created");
}
