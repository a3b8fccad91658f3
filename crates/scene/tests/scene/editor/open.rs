//! Opening, activating and closing models.

use std::sync::Arc;

use gaitway_character::anim::{ClipBuilder, Interpolation, JointIndex, Keys, TimeRange};
use gaitway_character::asset::{Asset, Warning};
use gaitway_formats::FileSet;
use gaitway_scene::editor::{AboutLink, ClipFormat, Contents, Editor, Event, Export, ModelFiles, OpenedModel};
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::library::{ClipId, Library, Model, ModelClip, Motion};
use gaitway_scene::samples;
use gaitway_scene::state::{
    CameraChoice, ClipChoice, Command, Inspect, OrbitCamera, RetargetEdits, Show, UpAxis, ViewerState, active_clip,
    from_link, to_link,
};
use glam::Vec3;
use serde_json::json;

use super::{active, any, contents, editor, id_of, motion, motions, notices, open, open_motion, title};
use crate::by_place::ByPlace;

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
    assert_eq!((now.inspect, now.character.edits.up, now.selection.joint), (Inspect::default(), UpAxis::Y, None));
    assert_eq!(
        (&now.character.playhead.clip, &now.character.retarget),
        (&ClipChoice::First, &RetargetEdits::default())
    );
    assert_eq!((now.display.show, now.playback.speed, now.camera_options.fov_degrees), (show, 2.0, 50.0));
    editor.undo();
    assert_eq!(editor.state(), &pilot);
}

#[test]
fn a_model_returns_with_its_clip_time_and_range() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    editor.apply(Command::SetPlaying(false));
    editor.apply(Command::SetRange(Some(TimeRange { start_secs: 0.2, end_secs: 0.6 })));
    editor.apply(Command::Seek(0.4));
    let (playhead, playing) = (editor.state().character.playhead.clone(), title(&editor).map(str::to_owned));
    assert!(playing.is_some());
    open(&mut editor, "sample:walker");
    editor.close(id_of(&editor, "sample:walker"), &mut any).expect("fits");
    assert_eq!((active(&editor), &editor.state().character.playhead), ("sample:pilot", &playhead));
    // Also beside a motion that was added to another model.
    open(&mut editor, "sample:walker");
    open_motion(&mut editor, "other.glb");
    editor.activate(id_of(&editor, "sample:pilot"), &mut any).expect("fits");
    assert_eq!(motions(&editor), ["dance.glb", "other.glb"]);
    let now = &editor.state().character.playhead;
    assert_eq!((now.time_secs, now.range), (playhead.time_secs, playhead.range));
    assert_eq!(title(&editor).map(str::to_owned), playing);
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
    assert_eq!(model.titles()[model.asset.clips.len()..], ["one", "two 0", "two 1"]);
}

#[test]
fn a_state_about_other_files_is_ignored() {
    let mut editor = editor("sample:pilot");
    let mut other = editor.state().clone();
    other.character.sources.model = vec!["sample:dwarf".to_owned()];
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
fn a_link_to_the_loaded_files_can_be_undone() {
    let mut editor = editor("sample:pilot");
    editor.apply(Command::SetExposure(1.0));
    let before = editor.state().clone();
    let mut view = ViewerState::of_model("sample:pilot".to_owned());
    view.display.exposure = 2.0;
    let follow = |editor: &mut Editor, view: &ViewerState| {
        editor.open(Contents::default(), Some(view.clone()), &mut any).expect("is loaded");
    };
    follow(&mut editor, &view);
    assert_eq!(editor.state().display.exposure, 2.0);
    assert!(editor.undo());
    assert_eq!(editor.state(), &before);
    assert!(editor.redo());
    assert_eq!(editor.state().display.exposure, 2.0);
    // Another time is nothing to undo.
    let steps = editor.undo_steps();
    view.character.playhead.time_secs = 0.5;
    follow(&mut editor, &view);
    assert_eq!((editor.state().character.playhead.time_secs, editor.undo_steps()), (0.5, steps));
}

#[test]
fn a_clip_whose_number_is_the_name_of_another_can_be_chosen() {
    let mut editor = editor("sample:pilot");
    let walker = samples::load("walker").expect("is generated").asset;
    let mut parts = Arc::into_inner(walker).expect("of one model").into_parts();
    let clip = |name: &str| {
        let mut clip = ClipBuilder::new(name, &parts.skeleton);
        let keys = Keys::Translation(vec![Vec3::ZERO, Vec3::Y]);
        clip.channel(JointIndex(0), Interpolation::Linear, &[0.0, 1.0], keys).expect("two keys");
        clip.build()
    };
    parts.clips = ["1", "", "Walk", "Walk"].map(clip).to_vec();
    let model = Model::new("odd.glb".to_owned(), Asset::new(parts).expect("valid indices"), Vec::new());
    let models = vec![OpenedModel { model, files: None }];
    editor.open(Contents { models, ..Contents::default() }, None, &mut any).expect("fits");
    for wanted in 0..4 {
        let model = editor.library().active().expect("a model");
        let wanted = model.id_at(wanted);
        editor.apply(Command::SetClip(ClipChoice::Clip(wanted.clone())));
        // What a link calls it is found again.
        let (view, _) = from_link(&to_link(editor.state(), editor.library()));
        let model = editor.library().active().expect("a model");
        assert_eq!(active_clip(model, &view).map(ModelClip::id), Some(&wanted), "{:?}", view.character.playhead.clip);
    }
}

#[test]
fn an_exported_clip_is_called_by_its_own_name() {
    let editor = editor("sample:pilot");
    let titles = editor.library().active().expect("a model").titles();
    assert!(titles.len() > 1, "{titles:?}");
    for (clip, title) in titles.iter().enumerate() {
        let name = editor
            .export(&Export::Clip { clip: ClipId::Own(clip), format: ClipFormat::Glb })
            .expect("it has keys")
            .name;
        assert_eq!(name, format!("Pilot-{title}-clip.glb"));
    }
}

#[test]
fn a_joint_that_the_model_lacks_is_told_of_every_link() {
    let told = "joint=999: expected a joint's index in the file; this model can't show it, so it is left out.";
    let mut view = ViewerState::of_model("sample:walker".to_owned());
    view.selection.joint = Some(999);
    let mut editor = Editor::default();
    editor.open(contents(&["sample:walker"]), Some(view.clone()), &mut any).expect("fits");
    assert_eq!(notices(&editor.take_events()), [told]);
    editor.open(Contents::default(), Some(view), &mut any).expect("only replaces the state");
    assert_eq!(notices(&editor.take_events()), [told]);
}

/// A view's clip that the model lacks isn't an error, but is reported.
#[test]
fn an_unknown_clip_of_a_view_is_told() {
    let told = "clip: expected the name or index of a clip, found “Fly”; its clips are “Walk”, “Idle”, “Wave”; the rest pose is used.";
    let view = || {
        let mut view = ViewerState::of_model("sample:walker".to_owned());
        view.character.playhead.clip = ClipChoice::called("Fly");
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

/// What isn't understood, what is out of range and what the model lacks.
#[test]
fn all_that_is_wrong_with_a_link_is_told_at_once() {
    let (view, link_errors) = from_link("v=1&model=sample:walker&t=noon&fov=200&clip=Fly&joint=999&zoo=1");
    assert_eq!(link_errors.len(), 2);
    let is_complete = |text: &str| {
        let lines: Vec<&str> = text.lines().collect();
        let keys = lines.iter().map(|line| line.split([':', '=']).next().unwrap_or_default());
        assert_eq!(keys.collect::<Vec<_>>(), ["t", "zoo", "fov", "clip", "joint"]);
        assert_eq!(lines[0], "t=noon: expected seconds from 0 on.");
        assert_eq!(lines[2], "fov=200: expected degrees from 5 to 120; 120 is used.");
        assert!(lines.iter().all(|line| line.ends_with('.') && !line.ends_with("..")), "{text}");
    };
    let mut editor = Editor::default();
    let with_errors =
        |contents| Contents { about_link: AboutLink { errors: link_errors.clone(), is_partial: false }, ..contents };
    editor.open(with_errors(contents(&["sample:walker"])), Some(view.clone()), &mut any).expect("fits");
    let events = editor.take_events();
    is_complete(notices(&events)[0]);
    assert_eq!((notices(&events).len(), editor.state().camera_options.fov_degrees), (1, 120.0));
    // A link to the files that are loaded.
    editor.open(with_errors(Contents::default()), Some(view.clone()), &mut any).expect("is loaded");
    let events = editor.take_events();
    is_complete(notices(&events)[0]);
    assert_eq!(notices(&events).len(), 1);
    // Nothing is left for the next view.
    editor
        .open(Contents::default(), Some(ViewerState::of_model("sample:walker".to_owned())), &mut any)
        .expect("is loaded");
    assert_eq!(notices(&editor.take_events()), [""; 0]);
}

#[test]
fn nothing_is_said_of_what_a_link_names_before_its_files_are_there() {
    let (view, errors) = from_link("v=1&model=sample:walker&motion=walk.bvh&map=1.ffffffff.0-5&t=1&clip=Fly");
    let contents = |is_partial| Contents {
        motions: Some(vec![motion("walk.bvh")]),
        about_link: AboutLink { errors: errors.clone(), is_partial },
        ..contents(&["sample:walker"])
    };
    let mut editor = Editor::default();
    editor.open(contents(true), Some(view.clone()), &mut any).expect("fits");
    let told = |events: &[Event]| events.iter().any(|event| matches!(event, Event::Problem(_) | Event::AboutView(_)));
    assert!(!told(&editor.take_events()));
    assert_eq!(
        (&editor.state().character.playhead.clip, editor.state().character.playhead.time_secs),
        (&ClipChoice::First, 1.0)
    );
    editor.open(contents(false), Some(view), &mut any).expect("fits");
    assert!(told(&editor.take_events()));
    assert_eq!(editor.state().character.playhead.clip, ClipChoice::called("Fly"));
}

/// As for another file under the same name, or one that was exported in other units.
#[test]
fn a_camera_that_looks_past_the_model_is_told() {
    let told = |camera: &str| {
        let (view, _) = from_link(&format!("v=1&model=sample:walker&camera={camera}"));
        let mut editor = Editor::default();
        editor.open(contents(&["sample:walker"]), Some(view), &mut any).expect("fits");
        notices(&editor.take_events()).join(" ")
    };
    // Yaw and pitch in degrees, distance, target.
    for seen in ["30,10,4,0,1,0", "0,0,0.05,0,1,0", "0,0,4,1.2,1,0", "0,89,4,0,1,0"] {
        assert_eq!(told(seen), "", "{seen}");
    }
    for past in ["30,10,4,0,100,0", "0,0,4,0,1,-50", "0,0,4,9,1,0", "0,89,4,0,1,30"] {
        let expected = "camera: it looks past this model; fit everything in view (F) to see it.";
        assert_eq!(told(past), expected, "{past}");
    }
}

#[test]
fn what_is_wrong_with_a_link_is_told_with_the_problems_of_its_maps() {
    let (view, link_errors) = from_link("v=1&model=sample:walker&motion=walk.bvh&map=1.ffffffff.0-5&t=noon&clip=Fly");
    let contents = Contents {
        motions: Some(vec![motion("walk.bvh")]),
        about_link: AboutLink { errors: link_errors, is_partial: false },
        ..contents(&["sample:walker"])
    };
    let mut editor = Editor::default();
    editor.open(contents, Some(view), &mut any).expect("fits");
    let events = editor.take_events();
    assert_eq!(notices(&events), [""; 0]);
    let problem = |event: &Event| if let Event::Problem(problem) = event { Some(problem.clone()) } else { None };
    let problems: Vec<String> = events.iter().filter_map(problem).collect();
    assert_eq!(problems.len(), 3, "{problems:?}");
    assert!(problems[1].starts_with("t=noon: ") && problems[2].starts_with("clip: "), "{problems:?}");
}

/// A script hears nothing of what it didn't set.
#[test]
fn what_is_wrong_with_a_change_by_a_script_is_told() {
    let mut editor = editor("sample:walker");
    editor.apply_partial(&json!({ "joint": 999, "speed": 9 })).expect("is no error");
    let told = notices(&editor.take_events()).join("");
    assert!(told.contains("joint=999") && told.contains("4 is used"), "{told}");
    editor.apply_partial(&json!({ "t": 0.5 })).expect("is fine");
    assert_eq!(notices(&editor.take_events()), [""; 0]);
    let error = editor.apply_partial(&json!({ "change": ["Walk:trim:5:1"] })).expect_err("keeps nothing");
    assert!(error.contains("the end after the start"), "{error}");
}

#[test]
fn images_that_are_missing_or_unreadable_are_told() {
    let mut editor = editor("sample:walker");
    let mut told = |name: &str, warnings: &[Warning]| {
        let mut asset = Asset::default();
        warnings.iter().for_each(|warning| asset.warnings.push(warning.clone()));
        let model = Model::new(name.to_owned(), asset, Vec::new());
        let contents = Contents { models: vec![model.into()], ..Contents::default() };
        editor.open(contents, None, &mut any).expect("fits");
        notices(&editor.take_events()).concat()
    };
    let missing = |uri: &str| Warning::ImageMissing { uri: uri.to_owned() };
    let unreadable = |image: &str| Warning::ImageUnreadable { image: image.to_owned(), problem: "cut off".to_owned() };
    assert_eq!(told("a.gltf", &[]), "Opened a.gltf.");
    let one = "Opened b.gltf. Its image skin.png is missing; open it as well.";
    assert_eq!(told("b.gltf", &[missing("maps/skin.png")]), one);
    let several = "Opened c.gltf. Some of its images are missing; open them as well.";
    assert_eq!(told("c.gltf", &[missing("skin.png"), missing("eyes.png")]), several);
    let one = "Opened d.gltf. Its image skin.ktx2 can't be read; the Info tab says why.";
    assert_eq!(told("d.gltf", &[unreadable("maps/skin.ktx2")]), one);
    let several = "Opened e.gltf. Some of its images can't be read; the Info tab says why.";
    assert_eq!(told("e.gltf", &[unreadable("images[0]"), unreadable("images[1]")]), several);
}

#[test]
fn a_model_takes_the_place_of_the_same_one_without_its_files() {
    let mut editor = editor("sample:walker");
    // A file of this content, some of whose two images are missing.
    let open = |editor: &mut Editor, text: &str, images: &[&str]| {
        let mut asset = Asset::default();
        for &uri in images {
            asset.warnings.push(Warning::ImageMissing { uri: uri.to_owned() });
        }
        let model = Model::new("scene.gltf".to_owned(), asset, Vec::new());
        let mut set = FileSet::default();
        set.insert("scene.gltf", text.as_bytes());
        ["skin.png", "eyes.png"].iter().filter(|name| !images.contains(name)).for_each(|&name| set.insert(name, []));
        let files = Some(ModelFiles { set, name: "scene.gltf".to_owned() });
        let contents = Contents { models: vec![OpenedModel { model, files }], ..Contents::default() };
        editor.open(contents, None, &mut any).expect("fits");
        editor.library().models().len()
    };
    assert_eq!(open(&mut editor, "one", &["skin.png", "eyes.png"]), 2);
    assert_eq!(open(&mut editor, "two", &[]), 3, "another model of this name");
    assert_eq!(open(&mut editor, "one", &["eyes.png"]), 3);
    // With its view.
    let camera =
        CameraChoice::Orbit(OrbitCamera { yaw_radians: 1.0, pitch_radians: 0.0, distance: 7.0, target: Vec3::ZERO });
    editor.apply(Command::SetCamera(camera));
    editor.apply(Command::SetExposure(1.0));
    let view = editor.state().clone();
    assert_eq!(open(&mut editor, "one", &[]), 3);
    assert_eq!(editor.state(), &view);
    assert_eq!(open(&mut editor, "one", &["eyes.png"]), 4, "a worse one replaces nothing");
    assert_eq!(editor.state().camera, CameraChoice::Auto, "nor has its view");
}

/// A link to a loaded model reads no files, but is presented as any other.
#[test]
fn a_view_of_a_loaded_model_is_announced_if_another_was_active() {
    let mut editor = editor("sample:pilot");
    open(&mut editor, "sample:dwarf");
    editor.take_events();
    let view = || Some(ViewerState::of_model("sample:pilot".to_owned()));
    let nothing_new = || Contents { motions: Some(Vec::new()), ..Contents::default() };
    for is_other in [true, false] {
        editor.open(nothing_new(), view(), &mut any).expect("is loaded");
        let events = editor.take_events();
        assert_eq!(active(&editor), "sample:pilot");
        let announced = [Event::ViewOpened, Event::ModelOpened].map(|event| events.contains(&event));
        assert_eq!(announced, [is_other; 2], "{events:?}");
    }
}

/// Opens a view whose files are not available yet.
fn awaiting(view: &ViewerState) -> Editor {
    let mut editor = Editor::default();
    let models = vec![Model::placeholder(&view.character.sources.model[0]).into()];
    let awaited = Contents { models, motions: Some(Vec::new()), ..Contents::default() };
    editor.open(awaited, Some(view.clone()), &mut any).expect("fits");
    editor
}

/// An empty stage stands for a model that is not available yet. It keeps the whole view, and is closed once something
/// is opened.
#[test]
fn an_empty_stage_awaits_a_model() {
    let (mut view, _) =
        from_link("v=1&model=file:in/Soldier.glb&motion=file:walk.bvh&clip=run&t=0.5&camera=10,5,3,0,1,0&exposure=1");
    view.playback.playing = false;
    let mut editor = awaiting(&view);
    let events = editor.take_events();
    assert_eq!((editor.state(), notices(&events)), (&view, vec![]), "no notice about its clip");
    let model = editor.library().active().expect("stands for it");
    assert_eq!((model.is_placeholder(), model.source.as_str()), (true, "in/Soldier.glb"));
    let mut frame = Frame::default();
    evaluate(editor.library(), editor.state(), 1.5, &mut frame);
    assert!(frame.bones.is_empty() && frame.characters[0].palette.len() <= 1, "there is nothing to see");
    assert_eq!(notices(&open(&mut editor, "sample:walker")), ["Opened Walker."]);
    let listed: Vec<&str> = editor.library().models().iter().map(|model| model.source.as_str()).collect();
    assert_eq!(listed, ["sample:walker"]);
    assert_eq!(editor.state().display.exposure, 1.0);
    assert!(!editor.can_undo(), "nobody wants the empty stage back");
}

#[test]
fn what_a_link_says_of_a_motion_that_never_came_is_not_kept_for_another_model() {
    let mut editor = awaiting(&from_link("v=1&model=file:Soldier.glb&motion=file:walk.bvh&feet=plant").0);
    assert!(to_link(editor.state(), editor.library()).contains("feet=plant"));
    open(&mut editor, "sample:walker");
    assert!(
        !to_link(editor.state(), editor.library()).contains("feet="),
        "{}",
        to_link(editor.state(), editor.library())
    );
}

#[test]
fn the_last_models_to_give_way_are_those_that_the_user_has_edited() {
    let mut editor = editor("sample:walker");
    editor.apply(Command::SetPose { joint: 9, degrees: Some([90.0, 0.0, 0.0]) });
    let asset = samples::load("walker").expect("is generated").asset;
    let mut open = |index: usize| {
        let model = Model::new(format!("{index}.glb"), asset.clone(), Vec::new());
        let contents = Contents { models: vec![model.into()], ..Contents::default() };
        editor.open(contents, None, &mut any).expect("fits");
        notices(&editor.take_events()).join("")
    };
    for index in 1..Library::MAX_MODELS {
        assert_eq!(open(index), format!("Opened {index}.glb."));
    }
    assert_eq!(open(9), "Opened 9.glb. Closed 1.glb to make room, which undo doesn't take back.");
    let walker = id_of(&editor, "sample:walker");
    editor.activate(walker, &mut any).expect("fits");
    assert_eq!(editor.state().character.edits.pose[&9], [90.0, 0.0, 0.0]);
}

/// Before the model that it should move is there.
#[test]
fn a_motion_on_an_empty_stage_shows_its_own_skeleton() {
    let mut editor = awaiting(&from_link("v=1&model=file:Soldier.glb&motion=file:walk.bvh").0);
    let motion = Contents { is_by_hand: true, motions: Some(vec![motion("walk")]), ..Contents::default() };
    editor.open(motion, None, &mut any).expect("has joints");
    let listed: Vec<&str> = editor.library().models().iter().map(|model| model.source.as_str()).collect();
    assert_eq!(listed, ["walk"]);
}

/// Opens the file as a user does, or as a script does.
fn open_file(editor: &mut Editor, path: &str, is_by_hand: bool) -> Vec<Event> {
    editor.open(Contents { is_by_hand, ..contents(&[path]) }, None, &mut any).expect("fits");
    editor.take_events()
}

#[test]
fn a_model_exported_with_a_clip_plays_that_clip() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "walk");
    let clip = active_clip(editor.library().active().expect("a model"), editor.state()).expect("plays").id().clone();
    let exported = editor.export(&Export::Model { clip }).expect("is written");
    let path = std::env::temp_dir().join(format!("gaitway-exported-{}.glb", std::process::id()));
    std::fs::write(&path, &exported.bytes).expect("is written");
    let file = path.to_str().expect("Unicode");

    // Its motion is still loaded, and would be retargeted to the file as well.
    let events = open_file(&mut editor, file, true);
    let model = editor.library().active().expect("a model");
    let own = ClipId::Own(model.asset.clips.len() - 1);
    let active = active_clip(model, editor.state()).expect("plays");
    assert_eq!((active.id(), model.clips().borrowed().count() > 0), (&own, true));
    assert!(notices(&events)[0].contains(active.title()), "{events:?}");
    // A link names it, and gives the same.
    let link = to_link(editor.state(), editor.library());
    assert!(link.contains("clip="), "{link}");

    let mut fresh = Editor::default();
    open_file(&mut fresh, file, true);
    assert_eq!(active_clip(fresh.library().active().expect("a model"), fresh.state()).map(ModelClip::id), Some(&own));
    // Scripts get the first clip, as links do that name none.
    let mut script = Editor::default();
    open_file(&mut script, file, false);
    assert_eq!(script.state().character.playhead.clip, ClipChoice::First);
    std::fs::remove_file(&path).expect("is there");
}
