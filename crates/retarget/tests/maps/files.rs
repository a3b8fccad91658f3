//! The file form of joint maps.

use gaitway_retarget::{
    ClipRef, Feet, JointMapFile, Keep, MapEntry, MutedChannel, MutedProperty, PathOrigin, RestChoice, RestChoices,
    RootOptions, RootPart, SourceRef, Unmapped, UpChoice,
};
use glam::Quat;

/// The documentation's example, word for word.
const EXAMPLE: &str = r##"{ "gaitway_map": 1,
  "joints": {
    "spine1": { "source": "neck" },
    "head":   { "source": 5, "correction": [0, 0, 0, 1] },
    "middle": { "source": null, "unmapped": { "clip": 0, "hold": "first-key" } } },
  "unmapped": "rest",
  "rest": { "model": "auto", "motion": "auto" },
  "root": { "horizontal": "keep", "vertical": "keep", "yaw": "keep", "extract": false, "origin": "rest" },
  "translations": "auto", "scales": "auto",
  "muted_channels": [ { "source": "free3dmodel_skeleton", "property": "translation" } ],
  "feet": "off", "contacts": "off", "chains": "off", "crossfade_secs": 0 }"##;

fn check_refused(text: &str, expected: &str) {
    let message = JointMapFile::from_json(text).expect_err(text).to_string();
    assert!(message.contains(expected), "{text}\n{message}\n{expected}");
}

#[test]
fn anything_but_a_map_is_refused() {
    check_refused("", "not JSON");
    check_refused("{", "not JSON: it ends too soon (cut short?) (line 1, column 1)");
    check_refused("[]", "not a joint map: expected a JSON object with “gaitway_map”");
    check_refused("{}", "not a joint map");
    check_refused(r#"{"gaitway_map": 2, "news": []}"#, "gaitway_map is 2; this program reads version 1");
    check_refused(r#"{"gaitway_map": "1"}"#, "gaitway_map is \"1\"");
}

#[test]
fn errors_in_explained_maps_keep_their_line() {
    // As `gaitway map --json` prints it, with members of its own at the beginning, between others and at the end.
    let text = |source: &str| {
        format!(
            "{{ \"unused_sources\": [\n  \"é\"],\n  \"gaitway_map\": 1, \"joints\": {{\n  \"head\": {{ \"reason\": \"a,\nb\", \"source\": {source}, \"slot\": null }},\n  \"tip\": {{ \"slot\": null, \"confidence\": 1 }} }}, \"warnings\": [] }}"
        )
        .replace("a,\n", "a, ")
    };
    let map = JointMapFile::from_json(&text("2")).expect("an explained map");
    assert_eq!(map.joints["head"].source, Some(SourceRef::Number(2)));
    assert_eq!(map.joints.len(), 2);
    let message = JointMapFile::from_json(&text("1.5")).expect_err("a source").to_string();
    assert!(message.contains("(line 4, column "), "{message}");
}

#[test]
fn errors_give_the_path_of_a_wrong_member() {
    let joint = |entry: &str| format!(r#"{{"gaitway_map": 1, "joints": {{"head": {entry}}}}}"#);
    check_refused(
        r#"{"gaitway_map": 1, "joint": {}}"#,
        "there is no member “joint” here; expected one of “gaitway_map”",
    );
    check_refused(r#"{"gaitway_map": 1, "joints": []}"#, "joints: ");
    check_refused(&joint("5"), "joints.head: ");
    check_refused(&joint(r#"{"sauce": 2}"#), "joints.head.sauce: there is no member “sauce” here");
    check_refused(&joint(r#"{"source": -1}"#), "joints.head.source: expected a joint's name, its number");
    check_refused(&joint(r#"{"source": 1.5}"#), "joints.head.source: ");
    check_refused(&joint(r#"{"source": 1, "sauce": 2}"#), "there is no member “sauce” here");
    check_refused(&joint(r#"{"source": 1, "correction": [0, 0, 1]}"#), "joints.head.correction: ");
    check_refused(&joint(r#"{"source": null, "unmapped": "rust"}"#), "joints.head.unmapped: expected \"rest\"");
    check_refused(&joint(r#"{"source": null, "unmapped": {"clip": 0, "hold": "last"}}"#), "first-key");
    check_refused(&joint(r#"{"source": null, "unmapped": {"clip": 0, "speed": 2}}"#), "joints.head.unmapped: ");
    check_refused(
        r#"{"gaitway_map": 1, "root": {"yaw": "spin"}}"#,
        "root.yaw: expected one of “keep”, “in-place”, “freeze”, found “spin”",
    );
    check_refused(r#"{"gaitway_map": 1, "rest": {"model": "pose"}}"#, "rest.model: expected one of “auto”");
    check_refused(
        r#"{"gaitway_map": 1, "muted_channels": [{"source": 1}, {"property": "scale"}]}"#,
        "muted_channels[1]",
    );
    check_refused(
        r#"{"gaitway_map": 1, "joints": {"head": {"source": 1}, "head": {"source": 2}}}"#,
        "“head” appears twice",
    );
}

#[test]
fn the_documented_example_is_read() {
    let map = JointMapFile::from_json(EXAMPLE).expect("the example");
    let entry = |source| MapEntry { source, correction: Quat::IDENTITY, unmapped: None };
    let first_key = Unmapped::Clip { clip: ClipRef::Index(0), frozen: true };
    let expected = JointMapFile {
        joints: [
            ("spine1".to_owned(), entry(Some(SourceRef::Name("neck".to_owned())))),
            ("head".to_owned(), entry(Some(SourceRef::Number(5)))),
            ("middle".to_owned(), MapEntry { unmapped: Some(first_key), ..entry(None) }),
        ]
        .into(),
        muted_channels: vec![MutedChannel {
            source: SourceRef::Name("free3dmodel_skeleton".to_owned()),
            property: Some(MutedProperty::Translation),
        }],
        ..JointMapFile::default()
    };
    assert_eq!(map, expected);
    let documented = std::fs::read_to_string("../../docs/joint-maps.md").expect("the page");
    assert!(documented.contains(EXAMPLE), "docs/joint-maps.md has another example");
}

#[test]
fn written_maps_read_back_the_same() {
    let playing = |clip, frozen| Unmapped::Clip { clip, frozen };
    let entry = |source, correction, unmapped| MapEntry { source, correction, unmapped };
    let full = JointMapFile {
        joints: [
            ("#3".to_owned(), entry(Some(SourceRef::Number(7)), Quat::from_xyzw(0.1, -0.2, 0.3, 0.9), None)),
            ("“quoted” \\ joint".to_owned(), entry(None, Quat::IDENTITY, Some(Unmapped::Rest))),
            (String::new(), entry(Some(SourceRef::Name(String::new())), Quat::IDENTITY, None)),
            ("c".to_owned(), entry(None, Quat::IDENTITY, Some(playing(ClipRef::Name("Idle".to_owned()), false)))),
        ]
        .into(),
        unmapped: playing(ClipRef::Index(2), true),
        rest: RestChoices { model: RestChoice::Bind, motion: RestChoice::FirstFrame, up: UpChoice::Z },
        root: RootOptions {
            horizontal: RootPart::InPlace,
            vertical: RootPart::Freeze,
            yaw: RootPart::InPlace,
            extract: true,
            origin: PathOrigin::Feet,
        },
        translations: Keep::Drop,
        scales: Keep::Keep,
        muted_channels: vec![MutedChannel { source: SourceRef::Number(0), property: None }],
        feet: Feet::Plant,
        crossfade_secs: 0.25,
        ..JointMapFile::default()
    };
    for map in [JointMapFile::default(), full] {
        let text = map.to_json().expect("plain data");
        assert_eq!(JointMapFile::from_json(&text).expect(&text), map, "{text}");
    }
}
