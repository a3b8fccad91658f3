//! Joint maps: waiting, faulty, empty and matched again.

use gaitway_retarget::JointMapFile;
use gaitway_scene::editor::{Contents, Editor, Event, OpenedMap};
use gaitway_scene::library::{Library, Motion};
use gaitway_scene::state::{
    CharacterView, ClipChoice, Command, MapEdit, Sources, ViewerState, active_map, from_link, to_link, to_object,
};
use glam::Vec3;
use serde_json::json;

use super::{any, contents, editor, motion, notices, open_motion, title};
use crate::by_place::motion_at;
use crate::data::moving_box;
use crate::texts::object_of;

#[test]
fn a_manual_map_does_not_start_without_room_for_the_motion() {
    let mut editor = editor("sample:morphs");
    let stranger = moving_box(0.5, &[0.0, 1.0], &[Vec3::ZERO, Vec3::X]).active().expect("a box").asset.clone();
    let motions: Vec<Motion> =
        (0..Library::MAX_MOTIONS).map(|number| Motion::new(format!("{number}.glb"), stranger.clone())).collect();
    let motion = motions.iter().map(|motion| motion.origin.clone()).collect();
    let now = editor.state().clone();
    let view = ViewerState {
        character: CharacterView { sources: Sources { motion, ..now.character.sources }, ..now.character },
        ..now
    };
    let contents = Contents { motions: Some(motions), ..Contents::default() };
    editor.open(contents, Some(view), &mut any).expect("the model stays");
    editor.remove_motion(&motion_at(editor.library(), 1));
    let again = Contents { motions: Some(vec![Motion::new("again.glb".to_owned(), stranger)]), ..Contents::default() };
    editor.open(again, None, &mut any).expect_err("does not fit");
    editor.undo();
    assert_eq!(editor.library().motions().len(), Library::MAX_MOTIONS);
    editor.take_events();
    editor.map_refused_manually();
    let events = editor.take_events();
    assert!(matches!(&events[..], [Event::Problem(problem)] if problem.contains("at most 64 motions")), "{events:?}");
}

#[test]
fn the_rest_pose_is_active_while_a_map_is_empty() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    let playing = title(&editor).map(str::to_owned);
    let plays = |editor: &Editor| title(editor).map(str::to_owned);
    editor.apply(Command::EditMap { motion: motion_at(editor.library(), 0), edit: MapEdit::Clear });
    assert_eq!(plays(&editor), None);
    assert_eq!(to_object(editor.state(), editor.library())["clip"], "", "the link has the rest pose");
    editor.undo();
    assert_eq!(plays(&editor), playing);
    editor.redo();
    assert_eq!(plays(&editor), None);
    editor.apply(Command::SetMap { motion: motion_at(editor.library(), 0), map: None });
    assert_eq!(plays(&editor), playing);
    // A clip that the user chose meanwhile stays.
    editor.apply(Command::EditMap { motion: motion_at(editor.library(), 0), edit: MapEdit::Clear });
    editor.apply(Command::SetClip(ClipChoice::First));
    editor.undo();
    assert_eq!(editor.state().character.playhead.clip, ClipChoice::First);
}

#[test]
fn a_faulty_map_is_blamed_on_its_own_file() {
    let mut editor = editor("sample:pilot");
    let map = r#"{"gaitway_map": 1, "joints": {"nope": {"source": 0}}}"#;
    let map = || Some(OpenedMap { name: "map.json".to_owned(), map: JointMapFile::from_json(map).expect("is valid") });
    let both = Contents { motions: Some(vec![motion("dance.glb")]), map: map(), ..Contents::default() };
    editor.open(both, None, &mut any).expect("the motion fits");
    let expected = "map.json: doesn't fit dance.glb: joints.nope: ";
    let events = editor.take_events();
    let is_expected = |event: &Event| matches!(event, Event::Problem(text) if text.starts_with(expected));
    assert!(events.iter().any(is_expected), "{events:?}");
    let alone = Contents { map: map(), ..Contents::default() };
    let error = editor.open(alone, None, &mut any).expect_err("fits nothing");
    assert!(error.starts_with(expected), "{error}");
}

/// Of two motions, the second plays.
#[test]
fn a_map_that_does_not_fit_the_motion_that_plays_says_so() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    editor.open(contents(&["sample:walk"]), None, &mut any).expect("fits");
    let proposed = active_map(editor.library(), editor.state(), &motion_at(editor.library(), 1));
    let mut open = |source: &str| {
        let map = format!(r#"{{"gaitway_map": 1, "joints": {{"mixamorig:Hips": {{"source": "{source}"}}}}}}"#);
        let map = JointMapFile::from_json(&map).expect("is valid");
        editor.take_events();
        let map = Some(OpenedMap { name: "map.json".to_owned(), map });
        editor
            .open(Contents { map, ..Contents::default() }, None, &mut any)
            .map(|()| notices(&editor.take_events()).join(""))
    };
    let notice = open("Hips").expect("fits the first");
    assert!(
        notice.starts_with("Applied the joint map and its options to dance.glb. The motion that plays keeps its own"),
        "{notice}"
    );
    assert!(notice.contains("map.json: doesn't fit Walk: "), "{notice}");
    let problem = open("nope").expect_err("fits neither");
    assert!(problem.starts_with("map.json: doesn't fit Walk: "), "{problem}");
    assert_eq!(open("hip").expect("fits the second"), "Applied the joint map and its options to Walk.");
    assert_ne!(active_map(editor.library(), editor.state(), &motion_at(editor.library(), 1)), proposed);
}

/// A map by name waits for its motion as the text that the link has.
#[test]
fn a_map_waits_for_its_motion() {
    let text = r#"{ "gaitway_map": 1, "joints": { "Hips": { "source": "Hips" } } }"#;
    let (view, errors) = from_link(&format!("model=sample:walker&map={}", text.replace(' ', "%20")));
    assert_eq!(errors, []);
    assert_eq!(object_of(&view)["map"], json!([text]));
    let mut editor = Editor::default();
    editor.open(contents(&["sample:walker"]), Some(view), &mut any).expect("fits");
    assert_eq!(to_object(editor.state(), editor.library())["map"], json!([text]), "written back unchanged");
    let sources = |editor: &Editor| {
        active_map(editor.library(), editor.state(), &motion_at(editor.library(), 0)).map(|map| map.joints.len())
    };
    open_motion(&mut editor, "dance.glb");
    assert_eq!(sources(&editor), Some(1));
    assert!(to_link(editor.state(), editor.library()).contains("map=1."), "by number");
    editor.undo();
    assert_eq!(to_object(editor.state(), editor.library())["map"], json!([text]));
    editor.redo();
    assert_eq!(sources(&editor), Some(1));
    // The same for a map that is opened with its model, before any motion.
    let map = OpenedMap { name: "map.json".to_owned(), map: JointMapFile::from_json(text).expect("is valid") };
    let mut editor = Editor::default();
    editor.open(Contents { map: Some(map), ..contents(&["sample:walker"]) }, None, &mut any).expect("fits");
    let (again, errors) = from_link(&to_link(editor.state(), editor.library()));
    assert_eq!((&again.character.retarget, &errors[..]), (&editor.state().character.retarget, &[][..]));
    open_motion(&mut editor, "dance.glb");
    assert_eq!(sources(&editor), Some(1));
}

#[test]
fn matching_again_says_if_that_changed_nothing() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    editor.apply(Command::SetMap { motion: motion_at(editor.library(), 0), map: None });
    assert_eq!(notices(&editor.take_events()), ["The joints are already mapped as proposed."]);
    editor.apply(Command::EditMap { motion: motion_at(editor.library(), 0), edit: MapEdit::Clear });
    editor.apply(Command::SetMap { motion: motion_at(editor.library(), 0), map: None });
    assert_eq!(notices(&editor.take_events()), [""; 0], "the table shows it");
    // Nothing to propose: what was mapped by hand stays.
    let mut editor = self::editor("sample:creature");
    editor.open(contents(&["sample:walk"]), None, &mut any).expect_err("does not fit");
    editor.map_refused_manually();
    editor.apply(Command::SetSource { motion: motion_at(editor.library(), 0), target: 1, source: Some(0) });
    editor.take_events();
    let before = editor.state().clone();
    editor.apply(Command::SetMap { motion: motion_at(editor.library(), 0), map: None });
    assert_eq!(editor.state(), &before);
    let events = editor.take_events();
    let [text] = notices(&events)[..] else { panic!("{events:?}") };
    assert!(text.starts_with("Walk has no joint in common with Fox"), "{text}");
}
