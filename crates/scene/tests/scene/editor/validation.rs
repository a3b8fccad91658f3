//! Validating a model's own file: what the validator reads, and where its findings lead.

use gaitway_scene::editor::{ValidatorGroup, ValidatorReport};
use gaitway_scene::library::ModelId;
use serde_json::json;

use super::{editor, id_of, open};

#[test]
fn the_file_is_the_one_that_was_opened() {
    let mut editor = editor("sample:pilot");
    let pilot = id_of(&editor, "sample:pilot");
    assert!(editor.has_gltf());
    let file = editor.gltf_file(pilot, None).expect("a file").clone();
    assert!(file.starts_with(b"glTF"));
    assert_eq!(editor.gltf_file(pilot, Some("missing.bin")), None);
    for other in ["sample:walker", "assets/samples/walk.bvh", "sample:ssd"] {
        open(&mut editor, other);
        assert!(!editor.has_gltf(), "{other} is not a glTF");
    }
    assert_eq!(editor.gltf_file(pilot, None), Some(&file), "whatever is shown meanwhile");
    assert_eq!(editor.gltf_file(ModelId(999), None), None);
}

#[test]
fn findings_lead_to_nodes() {
    let editor = editor("sample:pilot");
    let model = editor.library().active().expect("a model");
    let places = ["/nodes/2/scale", "/skins/0", "/extensionsUsed/0", ""];
    let findings = places.map(|place| json!({ "text": format!("{place}: text"), "place": place }));
    let group = json!({ "severity": 1, "code": "CODE", "meaning": "In words", "count": 70, "findings": findings });
    let report = json!({ "counts": [0, 70, 0, 2], "isTruncated": true, "groups": [group] });
    let read = ValidatorReport::from_json(model, &report.to_string()).expect("JSON");
    assert_eq!((read.counts, read.is_truncated), ([0, 70, 0, 2], true));
    let [ValidatorGroup { severity: 1, code, meaning, count: 70, findings }] = &read.groups[..] else {
        panic!("{read:?}")
    };
    assert_eq!((&**code, &**meaning), ("CODE", "In words"));
    let skeleton = &model.asset.skeleton;
    let joints = [skeleton.joint_of_source(2), model.asset.skins[0].joints().first().copied(), None, None];
    for ((finding, joint), (place, expected)) in findings.iter().zip(places.iter().zip(joints)) {
        assert_eq!((finding.as_str(), *joint), (&*format!("{place}: text"), expected));
    }
    assert_eq!(ValidatorReport::from_json(model, "{}").expect("JSON"), ValidatorReport::default());
    assert!(ValidatorReport::from_json(model, "{").is_err());
    let severe = json!({ "groups": [{ "severity": 9 }] }).to_string();
    assert_eq!(ValidatorReport::from_json(model, &severe).expect("JSON").groups[0].severity, 3);
}
