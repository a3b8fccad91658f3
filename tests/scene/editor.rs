//! The editor without a shell: opening, activating, closing and undoing, with their notices.

use std::path::PathBuf;

use gaitway::editor::{Contents, Editor, Event, Export};
use gaitway::files::{Role, read_paths};
use gaitway::library::{Library, Model, Motion};
use gaitway::state::{
    CameraChoice, ClipChoice, Command, Inspect, OrbitCamera, RetargetEdits, Show, Sources, UpAxis, ViewerState,
};
use glam::Vec3;

use crate::data::moving_box;

fn contents(files: &[&str]) -> Contents {
    let files: Vec<PathBuf> = files.iter().map(PathBuf::from).collect();
    read_paths(&files, Role::Any).expect("samples can be read")
}

fn any(_: &Model) -> Result<(), String> {
    Ok(())
}

fn editor(first: &str) -> Editor {
    let mut editor = Editor::default();
    open(&mut editor, first);
    editor
}

/// Returns the events.
fn open(editor: &mut Editor, file: &str) -> Vec<Event> {
    editor.open(contents(&[file]), None, &mut any).expect("fits");
    editor.take_events()
}

fn active(editor: &Editor) -> &str {
    &editor.library().active().expect("a model").source
}

fn notices(events: &[Event]) -> Vec<&str> {
    let mut texts = Vec::new();
    for event in events {
        if let Event::Notice { text, .. } = event {
            texts.push(text.as_str());
        }
    }
    texts
}

fn orbit(editor: &Editor) -> OrbitCamera {
    let CameraChoice::Orbit(orbit) = editor.state().camera else { panic!("{:?}", editor.state().camera) };
    orbit
}

#[test]
fn a_model_that_is_not_admitted_changes_nothing() {
    let mut editor = editor("sample:pilot");
    let before = editor.state().clone();
    let refuse = &mut |model: &Model| Err(format!("{} is too large", model.source));
    let error = editor.open(contents(&["sample:creature"]), None, refuse).expect_err("is refused");
    assert_eq!(error, "sample:creature is too large");
    assert_eq!((active(&editor), editor.state(), editor.can_undo()), ("sample:pilot", &before, false));
    assert_eq!(editor.library().models().len(), 1);
    // Nor does activating a loaded one.
    open(&mut editor, "sample:creature");
    let pilot = editor.library().models()[0].id;
    let before = editor.state().clone();
    editor.activate(pilot, refuse).expect_err("is refused");
    assert_eq!((active(&editor), editor.state()), ("sample:creature", &before));
}

#[test]
fn another_model_resets_model_settings_and_keeps_the_rest() {
    let mut editor = editor("sample:pilot");
    let show = Show { wireframe: true, ..Show::default() };
    let commands = [
        Command::SetShow(show),
        Command::SetInspect(Inspect { split: true, weights: true }),
        Command::SetUp(UpAxis::Z),
        Command::SetSpeed(2.0),
        Command::SetFov(50.0),
        Command::SelectJoint(Some(3)),
        Command::SetClip(ClipChoice::RestPose),
    ];
    commands.into_iter().for_each(|command| editor.apply(command));
    let pilot = editor.state().clone();
    open(&mut editor, "sample:creature");
    let now = editor.state();
    assert_eq!((now.inspect, now.edits.up, now.selection.joint), (Inspect::default(), UpAxis::Y, None));
    assert_eq!((&now.playhead.clip, &now.retarget), (&ClipChoice::First, &RetargetEdits::default()));
    assert_eq!((now.display.show, now.playback.speed, now.camera_options.fov_degrees), (show, 2.0, 50.0));
    editor.undo();
    assert_eq!(editor.state(), &pilot);
}

#[test]
fn notices_say_how_to_go_back() {
    let mut editor = editor("sample:pilot");
    assert_eq!(notices(&open(&mut editor, "sample:creature")), ["Opened Fox."]);
    assert_eq!(notices(&open(&mut editor, "sample:pilot")), ["Reopened Pilot."]);
    editor.undo();
    assert_eq!(notices(&editor.take_events()), ["Back to Fox. Ctrl+Y returns to Pilot."]);
    editor.redo();
    editor.take_events();
    let added = open(&mut editor, "sample:walk");
    assert_eq!(notices(&added), ["Added 1 clip from Walk."]);
    assert!(matches!(added.last(), Some(Event::Notice { undoable: true, .. })));
    editor.undo();
    let undone = editor.take_events();
    assert_eq!(notices(&undone), ["Removed motion Walk. Ctrl+Y brings it back."]);
    assert_eq!(undone[0], Event::Stepped, "earlier notices are outdated");
}

#[test]
fn motions_without_a_joint_in_common_are_refused_until_the_user_maps_them() {
    let mut editor = editor("sample:morphs");
    let before = editor.state().clone();
    let error = editor.open(contents(&["sample:walk"]), None, &mut any).expect_err("does not fit");
    assert!(error.contains("no joint in common with Goblin"), "{error}");
    assert_eq!((editor.take_events().last(), editor.state()), (Some(&Event::MotionsRefused), &before));
    editor.map_refused_manually();
    assert_eq!(editor.take_events(), [Event::MapStarted], "an empty map is not a problem");
    assert_eq!(editor.library().motions().len(), 1);
    editor.undo();
    assert!(editor.library().motions().is_empty());
}

#[test]
fn a_manual_map_does_not_start_without_room_for_the_motion() {
    let mut editor = editor("sample:morphs");
    let stranger = moving_box(0.5, &[0.0, 1.0], &[Vec3::ZERO, Vec3::X]).active().expect("a box").asset.clone();
    let motions: Vec<Motion> =
        (0..Library::MAX_MOTIONS).map(|number| Motion::new(format!("{number}.glb"), stranger.clone())).collect();
    let motion = motions.iter().map(|motion| motion.origin.clone()).collect();
    let now = editor.state().clone();
    let view = ViewerState { sources: Sources { motion, ..now.sources }, ..now };
    let contents = Contents { motions: Some(motions), ..Contents::default() };
    editor.open(contents, Some(view), &mut any).expect("the model stays");
    editor.remove_motion(1);
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
fn framing_uses_the_viewports_aspect() {
    let mut editor = editor("sample:pilot");
    let framed = |editor: &mut Editor, aspect: f32| {
        editor.set_aspect(aspect);
        editor.apply(Command::Orbit { yaw_radians: 0.1, pitch_radians: 0.0 });
        editor.apply(Command::FrameAll);
        orbit(editor).distance
    };
    let (wide, narrow) = (framed(&mut editor, 2.0), framed(&mut editor, 0.4));
    assert!(narrow > 1.1 * wide, "a narrow viewport needs more distance: {wide} and {narrow}");
    // Grabbing the scene stops the turntable.
    editor.apply(Command::SetTurntable(12.0));
    editor.apply(Command::Pan { right: 0.1, up: 0.0 });
    assert_eq!(editor.state().camera_options.turntable, 0.0);
}

#[test]
fn a_state_about_other_files_is_ignored() {
    let mut editor = editor("sample:pilot");
    let mut other = editor.state().clone();
    other.sources.model = vec!["sample:dwarf".to_owned()];
    other.playback.speed = 3.0;
    let before = editor.state().clone();
    editor.apply(Command::Replace(Box::new(other)));
    assert_eq!(editor.state(), &before);
    let error = editor.apply_partial(&serde_json::json!({ "model": ["x.glb"], "speed": 3 })).expect_err("other files");
    assert!(error.contains("something else was opened"), "{error}");
    assert_eq!(editor.state(), &before);
    editor.apply_partial(&serde_json::json!({ "speed": 3 })).expect("is valid");
    assert_eq!(editor.state().playback.speed, 3.0);
    editor.apply_partial(&serde_json::json!({ "speed": 2, "fov": "wide" })).expect_err("all or none");
    assert_eq!(editor.state().playback.speed, 3.0);
}

#[test]
fn an_exported_clip_is_called_by_its_own_name() {
    let editor = editor("sample:pilot");
    let titles = editor.library().active().expect("a model").clip_titles().to_vec();
    assert!(titles.len() > 1, "{titles:?}");
    for (clip, title) in titles.iter().enumerate() {
        let name = editor.export(Export::Clip { clip }).expect("it has keys").name;
        assert_eq!(name, format!("Pilot-{title}.glb"));
    }
}
