//! A file opened again after it was changed takes the place of its older version, and the view stays.

use gaitway_formats::{FileSet, OwnClips, load, write_edited_model};
use gaitway_scene::editor::{Contents, Editor, Event, ModelFiles, OpenedModel, Reading};
use gaitway_scene::library::{ClipId, Model};
use gaitway_scene::samples;
use gaitway_scene::state::{CameraChoice, ClipChoice, Command};

use super::{active, any, notices, title};

/// A sample's file under another name, without some of its clips, as a user's own.
fn own(sample: &str, name: &str, left_out: &[usize]) -> Contents {
    let mut set = FileSet::default();
    samples::files(sample).for_each(|(file, bytes)| set.insert(file, bytes));
    let main = set.names().next().expect("a file").to_owned();
    let original = load(&set).expect("is valid");
    let own = OwnClips { left_out: left_out.iter().copied().collect(), ..OwnClips::default() };
    let bytes = write_edited_model(&set, &main, &original.skeleton, &own, &[]).expect("is written");
    let mut set = FileSet::default();
    set.insert(name, bytes);
    let asset = load(&set).expect("is valid");
    let images = vec![None; asset.images.len()];
    let model = Model::new(name.to_owned(), asset, images);
    let files = Some(ModelFiles { set, name: name.to_owned() });
    let contents = Contents { models: vec![OpenedModel { model, files }], is_by_hand: true, ..Contents::default() };
    contents.into_private()
}

fn open(editor: &mut Editor, contents: Contents) -> Vec<Event> {
    editor.open(contents, None, &mut any).expect("fits");
    editor.take_events()
}

/// The pilot with a clip, a time, a camera and a pose that the user has chosen.
fn edited() -> Editor {
    let mut editor = Editor::default();
    open(&mut editor, own("pilot", "hero.glb", &[]));
    for command in [
        Command::SetClip(ClipChoice::Clip(ClipId::Own(2))),
        Command::Seek(0.25),
        Command::SetPose { joint: 9, degrees: Some([30.0, 0.0, 0.0]) },
        Command::Orbit { yaw_radians: 1.0, pitch_radians: 0.1 },
    ] {
        editor.apply(command);
    }
    editor
}

fn listed(editor: &Editor) -> Vec<&str> {
    editor.library().models().iter().map(|model| model.source.as_str()).collect()
}

#[test]
fn a_new_version_takes_the_place_of_the_old_one() {
    let mut editor = edited();
    let (before, playing) = (editor.state().clone(), title(&editor).map(str::to_owned));
    let older = editor.library().active().expect("a model").id;
    // Without its first clip.
    let events = open(&mut editor, own("pilot", "hero.glb", &[0]));
    assert_eq!(listed(&editor), ["hero.glb"]);
    assert_ne!(editor.library().active().expect("a model").id, older);
    assert!(events.contains(&Event::OtherReading(Reading::Both)), "{events:?}");
    let now = editor.state();
    assert_eq!(title(&editor), playing.as_deref());
    assert_eq!(now.character.playhead.time_secs, before.character.playhead.time_secs);
    assert_eq!((now.camera, &now.character.edits.pose), (before.camera, &before.character.edits.pose));
    assert!(matches!(now.camera, CameraChoice::Orbit(_)));

    // Undo brings the old one back, redo the new one.
    assert!(editor.undo());
    assert_eq!(editor.library().active().expect("a model").id, older);
    assert_eq!(editor.state().character, before.character);
    assert!(editor.redo());
    assert_ne!(editor.library().active().expect("a model").id, older);
}

#[test]
fn both_versions_stay_if_that_was_meant() {
    let mut editor = edited();
    open(&mut editor, own("pilot", "hero.glb", &[0]));
    let newer = editor.library().active().expect("a model").id;
    editor.read_otherwise();
    let events = editor.take_events();
    assert_eq!(listed(&editor), ["hero.glb", "hero.glb"]);
    assert_eq!(editor.library().active().expect("a model").id, newer);
    assert_eq!(notices(&events), ["Both versions of hero.glb are in the model list."]);
    assert!(editor.undo());
    assert_eq!(listed(&editor), ["hero.glb"]);
}

/// The same file with one more node before the others.
fn with_another_node() -> Contents {
    let contents = own("pilot", "hero.glb", &[]);
    let files = contents.models[0].files.as_ref().expect("has files");
    let glb = files.set.iter().next().expect("a file").1;
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
    let mut json: serde_json::Value = serde_json::from_slice(&glb[20..20 + length]).expect("is JSON");
    let nodes = json["nodes"].as_array_mut().expect("has nodes");
    let number = nodes.len();
    nodes.push(serde_json::json!({ "name": "socket" }));
    json["scenes"][0]["nodes"].as_array_mut().expect("has a scene").push(number.into());
    let mut text = serde_json::to_vec(&json).expect("is JSON");
    text.resize(text.len().next_multiple_of(4), b' ');
    let rest = &glb[20 + length..];
    let mut bytes = glb[..8].to_vec();
    bytes.extend(((20 + text.len() + rest.len()) as u32).to_le_bytes());
    bytes.extend((text.len() as u32).to_le_bytes());
    bytes.extend(&glb[16..20]);
    bytes.extend(text);
    bytes.extend(rest);
    let mut set = FileSet::default();
    set.insert("hero.glb", bytes);
    let asset = load(&set).expect("is valid");
    let images = vec![None; asset.images.len()];
    let model = Model::new("hero.glb".to_owned(), asset, images);
    let files = Some(ModelFiles { set, name: "hero.glb".to_owned() });
    let contents = Contents { models: vec![OpenedModel { model, files }], is_by_hand: true, ..Contents::default() };
    contents.into_private()
}

#[test]
fn what_is_about_joints_in_other_places_is_dropped() {
    let mut editor = edited();
    let camera = editor.state().camera;
    let events = open(&mut editor, with_another_node());
    assert!(editor.state().character.edits.pose.is_empty());
    assert_eq!((listed(&editor), editor.state().camera), (vec!["hero.glb"], camera));
    assert!(notices(&events)[0].contains("dropped"), "{events:?}");
    editor.undo();
    assert!(!editor.state().character.edits.pose.is_empty());
}

#[test]
fn other_files_of_that_name_and_the_same_file_again_are_not_new_versions() {
    let mut editor = edited();
    let events = open(&mut editor, own("creature", "hero.glb", &[]));
    assert_eq!(listed(&editor), ["hero.glb", "hero.glb"], "another character");
    assert!(!events.iter().any(|event| matches!(event, Event::OtherReading(_))), "{events:?}");

    let mut editor = edited();
    let id = editor.library().active().expect("a model").id;
    open(&mut editor, own("pilot", "hero.glb", &[]));
    assert_eq!((editor.library().active().expect("a model").id, active(&editor)), (id, "hero.glb"));

    // A script says what it wants.
    let mut editor = edited();
    open(&mut editor, Contents { is_by_hand: false, ..own("pilot", "hero.glb", &[0]) });
    assert_eq!(listed(&editor).len(), 2);
}
