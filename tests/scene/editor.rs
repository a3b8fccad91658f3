//! The editor without a shell: opening, activating, closing and undoing, with their notices.

use std::path::PathBuf;
use std::sync::Arc;

use gaitway::anim::{ClipBuilder, Interpolation, JointIndex, Keys, TimeRange};
use gaitway::asset::{Asset, AssetParts, Panorama};
use gaitway::editor::{Contents, Editor, Event, Export, OpenedMap};
use gaitway::files::{Held, Role, open_view, read_paths};
use gaitway::frame::{Frame, evaluate};
use gaitway::library::{Environment, Library, Model, Motion};
use gaitway::retarget::{Feet, JointMapFile, RootOptions, RootPart};
use gaitway::samples;
use gaitway::state::{
    CameraChoice, ClipChoice, Command, EnvironmentChoice, Inspect, Lighting, MapEdit, OrbitCamera, RetargetEdits, Show,
    Sources, UpAxis, ViewerState, active_clip, active_map, from_link, resolve_camera, to_link, to_object,
};
use glam::Vec3;
use serde_json::json;

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

/// Grey from all directions.
fn environment(origin: &str) -> Contents {
    let panorama = Panorama::new(2, 1, vec![Vec3::splat(0.5); 2]).expect("the right size");
    let environment = Environment { origin: origin.to_owned(), panorama: panorama.into(), is_own: false };
    Contents { environment: Some(environment), ..Contents::default() }
}

#[test]
fn an_environment_lights_the_scene_until_it_is_undone() {
    let mut editor = editor("sample:walker");
    editor.open(environment("beach.hdr"), None, &mut any).expect("fits");
    assert_eq!(notices(&editor.take_events()), ["Lit by beach.hdr."]);
    assert_eq!(editor.state().lighting.environment, EnvironmentChoice::File("beach.hdr".to_owned()));
    let mut frame = Frame::default();
    evaluate(editor.library(), editor.state(), 1.0, &mut frame);
    assert!(frame.panorama.is_some() && !editor.is_private());
    // Another model is lit by it, too.
    open(&mut editor, "sample:pilot");
    assert_eq!(editor.state().lighting.environment, EnvironmentChoice::File("beach.hdr".to_owned()));
    editor.undo();
    editor.undo();
    assert_eq!(editor.state().lighting, Lighting::default());
    // A view names what lights it, so opening the file for it changes nothing.
    let view = ViewerState { sources: editor.state().sources.clone(), ..ViewerState::default() };
    let contents = Contents { motions: Some(Vec::new()), ..environment("sky.hdr").into_private() };
    editor.open(contents, Some(view), &mut any).expect("is loaded");
    assert_eq!(editor.state().lighting, Lighting::default());
    assert!(!editor.is_private(), "it is loaded, but not shown");
    editor.apply(Command::SetLight(EnvironmentChoice::File("sky.hdr".to_owned())));
    assert!(editor.is_private());
}

#[test]
fn a_few_environments_are_kept() {
    let mut editor = editor("sample:walker");
    for index in 0..6 {
        editor.open(environment(&format!("{index}.hdr")), None, &mut any).expect("fits");
    }
    let kept: Vec<&str> = editor.library().environments().iter().map(|kept| kept.origin.as_str()).collect();
    assert_eq!(kept, ["2.hdr", "3.hdr", "4.hdr", "5.hdr"]);
}

/// Returns the events.
fn open(editor: &mut Editor, file: &str) -> Vec<Event> {
    editor.open(contents(&[file]), None, &mut any).expect("fits");
    editor.take_events()
}

/// The walker's clips as a motion of this name.
fn motion(name: &str) -> Motion {
    Motion::new(name.to_owned(), samples::load("walker").expect("is generated").asset)
}

fn open_motion(editor: &mut Editor, name: &str) {
    let contents = Contents { motions: Some(vec![motion(name)]), ..Contents::default() };
    editor.open(contents, None, &mut any).expect("fits");
    editor.take_events();
}

fn motions(editor: &Editor) -> Vec<&str> {
    editor.library().motions().iter().map(|motion| motion.source.as_str()).collect()
}

fn id_of(editor: &Editor, source: &str) -> gaitway::library::ModelId {
    editor.library().models().iter().find(|model| model.source == source).expect("is listed").id
}

fn title(editor: &Editor) -> Option<&str> {
    let model = editor.library().active()?;
    Some(&model.clip_titles()[active_clip(model, editor.state())?])
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
        Command::SetInspect(Inspect { split: true, weights: true, ..Inspect::default() }),
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
fn the_clip_before_a_motion_plays_again_after_undo() {
    let mut editor = editor("sample:pilot");
    let before = editor.state().playhead.clip.clone();
    open(&mut editor, "sample:walk");
    let borrowed = editor.state().playhead.clip.clone();
    assert_ne!(borrowed, before);
    editor.undo();
    assert_eq!(editor.state().playhead.clip, before);
    editor.redo();
    assert_eq!(editor.state().playhead.clip, borrowed);
}

#[test]
fn motions_without_a_joint_in_common_are_refused_until_the_user_maps_them() {
    let mut editor = editor("sample:creature");
    let before = editor.state().clone();
    let error = editor.open(contents(&["sample:walk"]), None, &mut any).expect_err("does not fit");
    assert!(error.contains("no joint in common with Fox"), "{error}");
    let refused = Event::MotionsRefused { lacks_skeleton: false };
    assert_eq!((editor.take_events().last(), editor.state()), (Some(&refused), &before));
    editor.map_refused_manually();
    assert_eq!(editor.take_events(), [Event::MapStarted], "an empty map is not a problem");
    assert_eq!(editor.library().motions().len(), 1);
    editor.undo();
    assert!(editor.library().motions().is_empty());
}

#[test]
fn a_model_without_a_skeleton_is_told_what_it_lacks() {
    let moving = moving_box(0.5, &[0.0, 1.0], &[Vec3::ZERO, Vec3::X]);
    let asset = moving.active().expect("a box").asset.clone();
    drop(moving);
    let parts = AssetParts { clips: Vec::new(), ..Arc::into_inner(asset).expect("of one model").into_parts() };
    let mut library = Library::default();
    library.add(Model::new("chair.glb".to_owned(), Asset::new(parts).expect("indices in range"), Vec::new()));
    let mut editor = Editor::new(library, ViewerState::default());
    let error = editor.open(contents(&["sample:walk"]), None, &mut any).expect_err("does not fit");
    assert!(error.contains("chair.glb has no skeleton that a motion could move; bind its mesh to one"), "{error}");
    assert_eq!(editor.take_events().last(), Some(&Event::MotionsRefused { lacks_skeleton: true }));
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
fn a_model_returns_with_its_clip_time_and_range() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    editor.apply(Command::SetPlaying(false));
    editor.apply(Command::SetRange(Some(TimeRange { start_secs: 0.2, end_secs: 0.6 })));
    editor.apply(Command::Seek(0.4));
    let (playhead, playing) = (editor.state().playhead.clone(), title(&editor).map(str::to_owned));
    assert!(playing.is_some());
    open(&mut editor, "sample:walker");
    editor.close(id_of(&editor, "sample:walker"), &mut any).expect("fits");
    assert_eq!((active(&editor), &editor.state().playhead), ("sample:pilot", &playhead));
    // Also beside a motion that was added to another model.
    open(&mut editor, "sample:walker");
    open_motion(&mut editor, "other.glb");
    editor.activate(id_of(&editor, "sample:pilot"), &mut any).expect("fits");
    assert_eq!(motions(&editor), ["dance.glb", "other.glb"]);
    let now = &editor.state().playhead;
    assert_eq!((now.time_secs, now.range), (playhead.time_secs, playhead.range));
    assert_eq!(title(&editor).map(str::to_owned), playing);
}

#[test]
fn a_model_with_motions_keeps_the_loaded_ones() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    let mut both = contents(&["sample:walker"]);
    both.motions = Some(vec![motion("other.glb")]);
    editor.open(both, None, &mut any).expect("fits");
    assert_eq!(motions(&editor), ["dance.glb", "other.glb"]);
    let model = editor.library().active().expect("a model");
    let playing = active_clip(model, editor.state()).and_then(|clip| model.borrowed(clip)).expect("a borrowed clip");
    assert_eq!((playing.motion, playing.source_clip), (1, 0), "the first new clip");
    assert_eq!(notices(&editor.take_events()), ["Opened Walker. Added 3 clips from other.glb."]);
    // Motions that don't fit are named.
    let mut both = contents(&["sample:morphs"]);
    both.motions = Some(vec![motion("third.glb")]);
    editor.open(both, None, &mut any).expect("the model is fine");
    let events = editor.take_events();
    assert_eq!(motions(&editor), ["third.glb"], "stays to be mapped by hand");
    let [text] = notices(&events)[..] else { panic!("{events:?}") };
    assert!(text.ends_with("Removed motions dance.glb, other.glb: they don't fit this model."), "{text}");
    assert!(events.iter().any(|event| matches!(event, Event::Problem(text) if text.starts_with("third.glb: "))));
}

#[test]
fn undo_says_which_models_it_brings_back() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    editor.open_motion_alone(0, &mut any).expect("fits");
    editor.take_events();
    editor.undo();
    assert_eq!(notices(&editor.take_events()), ["Back to Pilot. Ctrl+Y returns to dance.glb."]);
    open(&mut editor, "sample:creature");
    editor.close(id_of(&editor, "sample:pilot"), &mut any).expect("is not active");
    editor.take_events();
    editor.undo();
    assert_eq!(notices(&editor.take_events()), ["Reopened Pilot. Ctrl+Y closes it."]);
    editor.redo();
    assert_eq!(notices(&editor.take_events()), ["Closed Pilot. Ctrl+Z reopens it."]);
}

#[test]
fn the_rest_pose_is_active_while_a_map_is_empty() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    let playing = editor.state().playhead.clip.clone();
    editor.apply(Command::EditMap { motion: 0, edit: MapEdit::Clear });
    assert_eq!(editor.state().playhead.clip, ClipChoice::RestPose);
    editor.undo();
    assert_eq!(editor.state().playhead.clip, playing);
    editor.redo();
    assert_eq!(editor.state().playhead.clip, ClipChoice::RestPose);
    editor.apply(Command::SetMap { motion: 0, map: None });
    assert_eq!(editor.state().playhead.clip, playing);
    // A clip that the user chose meanwhile stays.
    editor.apply(Command::EditMap { motion: 0, edit: MapEdit::Clear });
    editor.apply(Command::SetClip(ClipChoice::First));
    editor.undo();
    assert_eq!(editor.state().playhead.clip, ClipChoice::First);
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

/// A map by name waits for its motion as the text that the link has.
#[test]
fn a_map_waits_for_its_motion() {
    let text = r#"{ "gaitway_map": 1, "joints": { "Hips": { "source": "Hips" } } }"#;
    let (view, errors) = from_link(&format!("model=sample:walker&map={}", text.replace(' ', "%20")));
    assert_eq!(errors, []);
    assert_eq!(to_object(&view)["map"], json!([text]));
    let mut editor = Editor::default();
    editor.open(contents(&["sample:walker"]), Some(view), &mut any).expect("fits");
    assert_eq!(to_object(editor.state())["map"], json!([text]), "written back unchanged");
    let sources = |editor: &Editor| active_map(editor.library(), editor.state(), 0).map(|map| map.joints.len());
    open_motion(&mut editor, "dance.glb");
    assert_eq!(sources(&editor), Some(1));
    assert!(to_link(editor.state()).contains("map=1."), "by number");
    editor.undo();
    assert_eq!(to_object(editor.state())["map"], json!([text]));
    editor.redo();
    assert_eq!(sources(&editor), Some(1));
    // The same for a map that is opened with its model, before any motion.
    let map = OpenedMap { name: "map.json".to_owned(), map: JointMapFile::from_json(text).expect("is valid") };
    let mut editor = Editor::default();
    editor.open(Contents { map: Some(map), ..contents(&["sample:walker"]) }, None, &mut any).expect("fits");
    let (again, errors) = from_link(&to_link(editor.state()));
    assert_eq!((&again.retarget, &errors[..]), (&editor.state().retarget, &[][..]));
    open_motion(&mut editor, "dance.glb");
    assert_eq!(sources(&editor), Some(1));
}

#[test]
fn an_unnamed_borrowed_clip_is_called_like_its_file() {
    let mut editor = editor("sample:pilot");
    let unnamed = |source: &str, count: usize| {
        let walker = samples::load("walker").expect("is generated").asset;
        let mut parts = Arc::into_inner(walker).expect("of one model").into_parts();
        let clip = |_| {
            let mut clip = ClipBuilder::new("", &parts.skeleton);
            let keys = Keys::Translation(vec![Vec3::ZERO, Vec3::Y]);
            clip.channel(JointIndex(0), Interpolation::Linear, &[0.0, 1.0], keys).expect("two keys");
            clip.build()
        };
        parts.clips = (0..count).map(clip).collect();
        Motion::new(source.to_owned(), Arc::new(Asset::new(parts).expect("valid indices")))
    };
    let motions = Some(vec![unnamed("folder/one.glb", 1), unnamed("https://example.org/two.glb?a=b.c", 2)]);
    editor.open(Contents { motions, ..Contents::default() }, None, &mut any).expect("fits");
    let model = editor.library().active().expect("a model");
    assert_eq!(model.clip_titles()[model.asset.clips.len()..], ["one", "two 0", "two 1"]);
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
        assert_eq!(name, format!("Pilot-{title}-clip.glb"));
    }
}

/// A view's clip that the model lacks isn't an error, but is reported.
#[test]
fn an_unknown_clip_of_a_view_is_told() {
    let told = "clip: expected the name or index of a clip, found “Fly”; its clips are Walk, Idle, Wave; the rest pose is used.";
    let view = || {
        let mut view = ViewerState::of_model("sample:walker".to_owned());
        view.playhead.clip = ClipChoice::Named("Fly".to_owned());
        view
    };
    let mut editor = Editor::default();
    editor.open(contents(&["sample:walker"]), Some(view()), &mut any).expect("fits");
    assert_eq!(notices(&editor.take_events()), [told]);
    // A link with the same files only replaces the state.
    editor.apply(Command::SetClip(ClipChoice::First));
    editor.apply(Command::Replace(Box::new(view())));
    assert_eq!(notices(&editor.take_events()), [told]);
    editor.apply(Command::Replace(Box::new(ViewerState::of_model("sample:walker".to_owned()))));
    assert_eq!(notices(&editor.take_events()), [""; 0]);
}

#[test]
fn matching_again_says_if_that_changed_nothing() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    editor.apply(Command::SetMap { motion: 0, map: None });
    assert_eq!(notices(&editor.take_events()), ["The joints are already mapped as proposed."]);
    editor.apply(Command::EditMap { motion: 0, edit: MapEdit::Clear });
    editor.apply(Command::SetMap { motion: 0, map: None });
    assert_eq!(notices(&editor.take_events()), [""; 0], "the table shows it");
    // Nothing to propose: what was mapped by hand stays.
    let mut editor = self::editor("sample:creature");
    editor.open(contents(&["sample:walk"]), None, &mut any).expect_err("does not fit");
    editor.map_refused_manually();
    editor.apply(Command::SetSource { motion: 0, target: 1, source: Some(0) });
    editor.take_events();
    let before = editor.state().clone();
    editor.apply(Command::SetMap { motion: 0, map: None });
    assert_eq!(editor.state(), &before);
    let events = editor.take_events();
    let [text] = notices(&events)[..] else { panic!("{events:?}") };
    assert!(text.starts_with("Walk has no joint in common with Fox"), "{text}");
}

/// The camera of the viewport.
fn view(editor: &Editor) -> OrbitCamera {
    resolve_camera(editor.library(), editor.state(), 1.6)
}

#[test]
fn an_option_never_moves_the_camera() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    let (before, state) = (view(&editor), editor.state().clone());
    let set = |part| Command::SetRoot(Some(RootOptions { horizontal: part, vertical: part, ..RootOptions::default() }));
    let options = [set(RootPart::Freeze), Command::EditMap { motion: 0, edit: MapEdit::Clear }];
    for option in options.clone() {
        editor.apply(option);
        assert_eq!(view(&editor), before);
    }
    let automatic = ViewerState { camera: CameraChoice::Auto, ..editor.state().clone() };
    assert_ne!(resolve_camera(editor.library(), &automatic, 1.6), before, "it would have moved");
    // Once the edit is undone the camera is automatic again, and frames another clip as usual.
    editor.undo();
    editor.undo();
    assert_eq!((view(&editor), editor.state()), (before, &state));
    options.into_iter().for_each(|option| editor.apply(option));
    editor.apply(Command::SetClip(ClipChoice::First));
    assert_eq!(editor.state().camera, CameraChoice::Auto);
    // A camera that the user moved stays.
    editor.apply(Command::Orbit { yaw_radians: 0.3, pitch_radians: 0.0 });
    let moved = orbit(&editor);
    editor.undo();
    editor.apply(Command::SetClip(ClipChoice::First));
    assert_eq!(orbit(&editor), moved);
}

#[test]
fn a_panel_knows_whose_edit_undo_takes_back() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    let can = |editor: &Editor| (editor.can_undo_retargeting(), editor.can_redo_retargeting());
    assert!(editor.can_undo(), "the motion");
    assert_eq!(can(&editor), (false, false));
    editor.apply(Command::EditMap { motion: 0, edit: MapEdit::SwapSides });
    assert_eq!(can(&editor), (true, false));
    editor.undo();
    assert_eq!(can(&editor), (false, true));
    editor.redo();
    editor.apply(Command::SetShow(Show { grid: false, ..Show::default() }));
    assert_eq!(can(&editor), (false, false), "the last step is the grid's");
}

#[test]
fn the_preference_for_reduced_motion_leaves_no_trace_in_links() {
    let turning = || {
        let mut view = ViewerState::of_model("sample:walker".to_owned());
        view.camera_options.turntable = 20.0;
        view
    };
    let mut editor = Editor::default();
    editor.prefer_reduced_motion(true);
    editor.open(contents(&["sample:walker"]), Some(turning()), &mut any).expect("fits");
    let calm = |editor: &Editor| !editor.state().playback.playing && editor.state().camera_options.turntable == 0.0;
    assert!(calm(&editor));
    assert_eq!(to_link(&editor.shared_state()), to_link(&turning()));
    editor.apply(Command::Replace(Box::new(turning())));
    assert!(calm(&editor));
    editor.apply(Command::SetSpeed(2.0));
    let link = to_link(&editor.shared_state());
    assert!(link.contains("turntable=20") && !link.contains("play="), "{link}");
    // The user's own choice is shared.
    editor.apply(Command::TogglePlaying);
    assert!(editor.state().playback.playing);
    editor.apply(Command::TogglePlaying);
    assert!(to_link(&editor.shared_state()).contains("play=0"));
    assert!(to_link(&editor.shared_state()).contains("turntable=20"));
}

/// With reduced motion, undo restores a view as it was: stopped, or playing because the user had started it.
#[test]
fn undo_returns_to_a_stopped_view_and_its_link() {
    let view = |model: &str, turntable: f32| {
        let mut view = ViewerState::of_model(model.to_owned());
        view.camera_options.turntable = turntable;
        view
    };
    let mut editor = Editor::default();
    editor.prefer_reduced_motion(true);
    let follow = |editor: &mut Editor, model: &str, turntable: f32| {
        editor.open(contents(&[model]), Some(view(model, turntable)), &mut any).expect("fits");
    };
    let moving = |editor: &Editor| (editor.state().playback.playing, editor.state().camera_options.turntable);
    follow(&mut editor, "sample:walker", 20.0);
    // One model with another link, and another model.
    follow(&mut editor, "sample:walker", 0.0);
    follow(&mut editor, "sample:pilot", 30.0);
    for (model, turntable) in [("sample:walker", 0.0), ("sample:walker", 20.0)] {
        assert!(editor.undo());
        assert_eq!(moving(&editor), (false, 0.0));
        assert_eq!(to_link(&editor.shared_state()), to_link(&view(model, turntable)));
    }
    editor.apply(Command::TogglePlaying);
    follow(&mut editor, "sample:pilot", 30.0);
    assert_eq!(moving(&editor), (false, 0.0), "another link");
    assert!(editor.undo());
    assert_eq!(moving(&editor), (true, 0.0), "the user had started it");
    assert_eq!(to_link(&editor.shared_state()), to_link(&view("sample:walker", 20.0)));
    assert!(editor.redo());
    assert_eq!(moving(&editor), (false, 0.0));
    assert_eq!(to_link(&editor.shared_state()), to_link(&view("sample:pilot", 30.0)));
}

/// An embedding page that changes something else doesn't stop a clip that the user has started.
#[test]
fn a_change_that_needs_files_leaves_a_started_clip_playing() {
    let mut editor = Editor::default();
    editor.prefer_reduced_motion(true);
    let view = ViewerState::of_model("sample:walker".to_owned());
    editor.open(contents(&["sample:walker"]), Some(view), &mut any).expect("fits");
    let change = |editor: &mut Editor, name: &str, playing: Option<bool>| {
        let mut view = editor.shared_state();
        view.sources.motion = vec![name.to_owned()];
        view.playback.playing = playing.unwrap_or(view.playback.playing);
        let contents = Contents { motions: Some(vec![motion(name)]), ..Contents::default() };
        editor.open_change(contents, view, &mut any).expect("fits");
        editor.state().playback.playing
    };
    assert!(!change(&mut editor, "a.bvh", None), "the user hasn't started it");
    assert!(!to_link(&editor.shared_state()).contains("play="));
    editor.apply(Command::TogglePlaying);
    assert!(change(&mut editor, "b.bvh", None));
    assert!(!change(&mut editor, "c.bvh", Some(false)), "the change says so");
}

/// An empty stage stands for a model that is not available yet. It keeps the whole view, and is closed once something
/// is opened.
#[test]
fn an_empty_stage_awaits_a_model() {
    let (mut view, _) =
        from_link("v=1&model=file:in/Soldier.glb&motion=file:walk.bvh&clip=run&t=0.5&camera=10,5,3,0,1,0&exposure=1");
    view.playback.playing = false;
    let mut editor = Editor::default();
    let (awaited, shown) = open_view(view.clone(), true, Held::default()).expect("there is nothing to read");
    editor.open(awaited, Some(shown), &mut any).expect("fits");
    let events = editor.take_events();
    assert_eq!((editor.state(), notices(&events)), (&view, vec![]), "no notice about its clip");
    let model = editor.library().active().expect("stands for it");
    assert_eq!((model.is_placeholder(), model.source.as_str()), (true, "in/Soldier.glb"));
    let mut frame = Frame::default();
    evaluate(editor.library(), editor.state(), 1.5, &mut frame);
    assert!(frame.bones.is_empty() && frame.characters[0].palette.len() <= 1, "there is nothing to see");
    open(&mut editor, "sample:walker");
    let listed: Vec<&str> = editor.library().models().iter().map(|model| model.source.as_str()).collect();
    assert_eq!(listed, ["sample:walker"]);
    assert_eq!(editor.state().display.exposure, 1.0);
}

/// Opens a file as the user does, not a link or a script.
fn open_by_hand(editor: &mut Editor, file: &str) -> Vec<Event> {
    let contents = Contents { is_by_hand: true, ..contents(&[file]) };
    editor.open(contents, None, &mut any).expect("fits");
    editor.take_events()
}

/// The walker with a clip that moves it this far.
fn runner(metres: f32) -> Contents {
    let asset = Arc::try_unwrap(samples::load("walker").expect("is generated").asset).expect("nobody else has it");
    let mut parts = asset.into_parts();
    let hips = parts.skeleton.find("Hips").expect("it has hips");
    let mut clip = ClipBuilder::new("Run", &parts.skeleton);
    let keys = Keys::Translation(vec![Vec3::Y, Vec3::new(0.0, 1.0, metres)]);
    clip.channel(hips, Interpolation::Linear, &[0.0, 3.0], keys).expect("two keys");
    parts.clips = vec![clip.build()];
    let model = Model::new("runner.glb".to_owned(), Asset::new(parts).expect("indices in range"), Vec::new());
    Contents { models: vec![model.into()], ..Contents::default() }
}

#[test]
fn the_camera_follows_what_travels_far_unless_the_user_says_otherwise() {
    let follows = |editor: &Editor| editor.state().camera_options.follow;
    let opened = |contents: Contents| {
        let mut editor = editor("sample:pilot");
        editor.open(contents, None, &mut any).expect("fits");
        editor
    };
    assert!(!follows(&opened(runner(8.0))), "a script gets what it says");
    assert!(!follows(&opened(Contents { is_by_hand: true, ..runner(0.5) })), "it stays in view");
    let mut editor = opened(Contents { is_by_hand: true, ..runner(8.0) });
    assert!(follows(&editor));
    assert_eq!(editor.state().camera, CameraChoice::Auto);
    editor.apply(Command::SetClip(ClipChoice::RestPose));
    assert!(!follows(&editor), "nothing travels");
    editor.apply(Command::SetClip(ClipChoice::First));
    assert!(follows(&editor));
    editor.apply(Command::SetFollow(false));
    editor.apply(Command::SetClip(ClipChoice::RestPose));
    editor.apply(Command::SetClip(ClipChoice::First));
    assert!(!follows(&editor), "the user's choice is kept");
}

#[test]
fn feet_that_would_slide_are_held_and_let_go_with_one_step() {
    let mut editor = editor("sample:dwarf");
    let told = open_by_hand(&mut editor, "sample:walk");
    assert_eq!(editor.state().retarget.feet, Some(Feet::Plant));
    let is_told =
        |event: &Event| matches!(event, Event::Notice { text, undoable: true } if text.contains("held on the ground"));
    assert!(told.iter().any(is_told), "{told:?}");
    assert_eq!(editor.state().camera, CameraChoice::Auto, "it frames the clip as it is now");
    assert!(editor.undo());
    assert_eq!((editor.state().retarget.feet, motions(&editor).len()), (None, 1), "only the planting");
    assert!(editor.undo());
    assert_eq!(motions(&editor).len(), 0);
    // Where the feet stand as well as the source's, nothing is done.
    let told = open_by_hand(&mut editor, "sample:mannequin");
    assert!(!told.iter().any(is_told));
    let told = open_by_hand(&mut editor, "sample:mannequin_run");
    assert_eq!((editor.state().retarget.feet, told.iter().any(is_told)), (None, false));
    // A script gets what it says.
    open(&mut editor, "sample:dwarf");
    editor.remove_motion(0);
    open(&mut editor, "sample:walk");
    assert_eq!(editor.state().retarget.feet, None);
}

#[test]
fn an_open_model_lends_its_clips() {
    let mut editor = editor("sample:pilot");
    open(&mut editor, "sample:mannequin");
    let pilot = id_of(&editor, "sample:pilot");
    editor.borrow_from(pilot, &mut any).expect("both are people");
    let events = editor.take_events();
    assert!(events.contains(&Event::MotionsAdded), "{events:?}");
    assert_eq!((active(&editor), motions(&editor)), ("sample:mannequin", vec!["sample:pilot"]));
    assert_eq!(editor.state().sources.motion, ["sample:pilot"]);
    assert_eq!(editor.library().active().expect("a model").borrowed_clips().count(), 6);
    while editor.can_undo() && !motions(&editor).is_empty() {
        editor.undo();
    }
    assert_eq!(active(&editor), "sample:mannequin");
}
