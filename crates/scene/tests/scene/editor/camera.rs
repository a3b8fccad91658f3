//! The camera: framing, options that leave it alone, following.

use std::sync::Arc;

use gaitway_character::anim::{ClipBuilder, Interpolation, Keys};
use gaitway_character::asset::Asset;
use gaitway_retarget::{ClipChanges, ClipLayer, Feet, LayerMode, RootOptions, RootPart};
use gaitway_scene::editor::{Contents, Editor, Event};
use gaitway_scene::library::{ClipId, LayeredClip, Model};
use gaitway_scene::samples;
use gaitway_scene::state::{
    CameraChoice, ClipChoice, ClipEdit, Command, MapEdit, OrbitCamera, ViewerState, active_clip, from_link,
    resolve_camera, to_link,
};
use glam::Vec3;

use super::{any, contents, editor, id_of, motions, open, open_motion, orbit};
use crate::by_place::motion_at;
use crate::data_folder::data_folder;
use crate::opened;

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
    let options =
        [set(RootPart::Freeze), Command::EditMap { motion: motion_at(editor.library(), 0), edit: MapEdit::Clear }];
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

/// Opens a file as the user does, not a link or a script.
fn open_by_hand(editor: &mut Editor, file: &str) -> Vec<Event> {
    let contents = Contents { is_by_hand: true, ..contents(&[file]) };
    editor.open(contents, None, &mut any).expect("fits");
    editor.take_events()
}

/// The walker with a clip that moves it this far.
pub fn runner(metres: f32) -> Contents {
    runner_from(0.0, metres)
}

/// The same from somewhere along X.
pub fn runner_from(x: f32, metres: f32) -> Contents {
    let asset = Arc::try_unwrap(samples::load("walker").expect("is generated").asset).expect("nobody else has it");
    let mut parts = asset.into_parts();
    let hips = parts.skeleton.find("Hips").expect("it has hips");
    let mut clip = ClipBuilder::new("Run", &parts.skeleton);
    let keys = Keys::Translation(vec![Vec3::new(x, 1.0, 0.0), Vec3::new(x, 1.0, metres)]);
    clip.channel(hips, Interpolation::Linear, &[0.0, 3.0], keys).expect("two keys");
    parts.clips = vec![clip.build()];
    let model = Model::new("runner.glb".to_owned(), Asset::new(parts).expect("indices in range"), Vec::new());
    Contents { models: vec![model.into()], ..Contents::default() }
}

#[test]
fn a_joint_that_is_dragged_never_moves_the_camera() {
    const UPPER_ARM: usize = 7;
    let mut editor = editor("sample:walker");
    let (before, state) = (view(&editor), editor.state().clone());
    for turn_degrees in [40.0, 80.0] {
        editor.apply(Command::SetPose { joint: UPPER_ARM, degrees: Some([0.0, 0.0, turn_degrees]) });
        assert_eq!(view(&editor), before);
    }
    let automatic = ViewerState { camera: CameraChoice::Auto, ..editor.state().clone() };
    assert_ne!(resolve_camera(editor.library(), &automatic, 1.6), before, "it would have moved");
    editor.undo();
    assert_eq!((view(&editor), editor.state()), (before, &state));
    editor.redo();
    assert_eq!(view(&editor), before);
}

#[test]
fn a_layer_is_framed_like_a_clip() {
    let mut editor = editor("sample:pilot");
    editor.open(runner(4.0), None, &mut any).expect("fits");
    let near = view(&editor);
    let layer = ClipLayer { mode: LayerMode::AdditiveToRest, ..ClipLayer::default() };
    editor.apply(Command::SetLayers(vec![LayeredClip { clip: ClipId::Own(0), layer }]));
    let far = view(&editor);
    assert!(far.distance > 1.3 * near.distance, "{} {}", near.distance, far.distance);
    editor.undo();
    assert_eq!((view(&editor), editor.state().camera), (near, CameraChoice::Auto));
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
fn a_camera_that_was_moved_goes_where_another_clip_is() {
    let mut editor = editor("sample:pilot");
    editor.open(Contents { is_by_hand: true, ..runner_from(6.0, 8.0) }, None, &mut any).expect("fits");
    editor.apply(Command::Orbit { yaw_radians: 0.3, pitch_radians: 0.0 });
    let at_the_run = orbit(&editor);
    assert!((at_the_run.target.x - 6.0).abs() < 0.5, "{at_the_run:?}");
    editor.apply(Command::SetClip(ClipChoice::RestPose));
    let at_rest = orbit(&editor);
    assert!(at_rest.target.x.abs() < 0.5, "{at_rest:?}");
    assert_eq!(OrbitCamera { target: at_the_run.target, ..at_rest }, at_the_run, "nothing else changes");
    editor.apply(Command::SetClip(ClipChoice::First));
    assert!((orbit(&editor).target - at_the_run.target).length() < 1e-4);
    // Whether it follows the character within a clip makes no difference.
    editor.apply(Command::SetFollow(false));
    editor.apply(Command::SetClip(ClipChoice::RestPose));
    assert!((orbit(&editor).target - at_rest.target).length() < 1e-4, "{:?}", orbit(&editor));
}

/// Also if the user has moved it.
#[test]
fn whether_a_camera_follows_is_decided_for_each_clip() {
    let mut editor = editor("sample:pilot");
    editor.open(Contents { is_by_hand: true, ..runner(8.0) }, None, &mut any).expect("fits");
    editor.apply(Command::Orbit { yaw_radians: 0.3, pitch_radians: 0.0 });
    let before = orbit(&editor);
    editor.apply(Command::SetClip(ClipChoice::RestPose));
    assert!(!editor.state().camera_options.follow);
    editor.apply(Command::SetClip(ClipChoice::First));
    assert!(editor.state().camera_options.follow);
    assert!((orbit(&editor).target - before.target).length() < 0.25 * before.distance, "{:?}", orbit(&editor));
}

#[test]
fn a_camera_that_was_moved_goes_along_if_an_edit_moves_the_body_out_of_its_view() {
    let mut editor = editor("sample:pilot");
    editor.open(runner(8.0), None, &mut any).expect("fits");
    editor.apply(Command::SetCamera(CameraChoice::Orbit(OrbitCamera { distance: 2.0, ..view(&editor) })));
    editor.apply(Command::Pan { right: 0.0, up: 0.0 });
    let before = orbit(&editor);
    let moved = |metres: f64| {
        let changes = Box::new(ClipChanges { offset: [metres, 0.0], ..ClipChanges::default() });
        Command::EditClip { clip: ClipId::Own(0), edit: ClipEdit::Change(changes) }
    };
    editor.apply(moved(0.2));
    assert_eq!(orbit(&editor), before);
    editor.apply(moved(9.0));
    let after = orbit(&editor);
    assert!((after.target - before.target - 9.0 * Vec3::X).length() < 0.3, "{before:?} {after:?}");
    assert_eq!(OrbitCamera { target: before.target, ..after }, before, "nothing else changes");
}

#[test]
fn the_camera_follows_again_when_a_model_comes_back() {
    let mut editor = editor("sample:pilot");
    let pilot = id_of(&editor, "sample:pilot");
    editor.open(Contents { is_by_hand: true, ..runner(8.0) }, None, &mut any).expect("fits");
    editor.apply(Command::Orbit { yaw_radians: 0.3, pitch_radians: 0.0 });
    let before = orbit(&editor);
    editor.activate(pilot, &mut any).expect("fits");
    assert!(!editor.state().camera_options.follow, "the pilot stays in place");
    let runner = id_of(&editor, "runner.glb");
    editor.activate(runner, &mut any).expect("fits");
    assert_eq!((editor.state().camera_options.follow, orbit(&editor)), (true, before));
}

fn are_automatic(editor: &Editor) -> bool {
    editor.state().character.retarget.feet_are_automatic
}

/// Whatever restores or replaces a view says who has planted its feet.
#[test]
fn who_has_planted_the_feet_belongs_to_the_view() {
    let mut editor = editor("sample:dwarf");
    open_by_hand(&mut editor, "sample:walk");
    assert!(are_automatic(&editor));
    // A link has them planted as well, but says so itself.
    let (link, errors) = from_link(&to_link(editor.state(), editor.library()));
    assert!(errors.is_empty(), "{errors:?}");
    editor.apply(Command::Replace(Box::new(link)));
    assert_eq!((editor.state().character.retarget.feet, are_automatic(&editor)), (Some(Feet::Plant), false));
    // Another model has its own.
    let mut editor = self::editor("sample:dwarf");
    open_by_hand(&mut editor, "sample:walk");
    editor.apply(Command::SetFeet(Some(Feet::Off)));
    editor.apply(Command::SetFeet(Some(Feet::Plant)));
    let dwarf = id_of(&editor, "sample:dwarf");
    open_by_hand(&mut editor, "sample:pilot");
    editor.activate(dwarf, &mut any).expect("fits");
    assert_eq!((editor.state().character.retarget.feet, are_automatic(&editor)), (Some(Feet::Plant), false));
    // A script's word counts like the user's; other keys say nothing about feet.
    let mut editor = self::editor("sample:dwarf");
    open_by_hand(&mut editor, "sample:walk");
    editor.apply_partial(&serde_json::json!({ "exposure": 1 })).expect("is valid");
    assert!(are_automatic(&editor));
    editor.apply_partial(&serde_json::json!({ "feet": "plant" })).expect("is valid");
    assert!(!are_automatic(&editor));
}

#[test]
fn a_script_that_sets_follow_is_obeyed_from_then_on() {
    let mut editor = editor("sample:pilot");
    editor.open(Contents { is_by_hand: true, ..runner(8.0) }, None, &mut any).expect("fits");
    editor.apply_partial(&serde_json::json!({ "follow": false })).expect("is valid");
    editor.apply(Command::SetClip(ClipChoice::RestPose));
    editor.apply(Command::SetClip(ClipChoice::First));
    assert!(!editor.state().camera_options.follow);
}

/// They neither slide nor hover, but sink in by 14 cm.
#[test]
fn feet_that_would_sink_in_are_held() {
    let Some(folder) = data_folder() else { return };
    let path = |name: &str| folder.join(name);
    let mut editor = editor(path("kaykit/Knight.glb").to_str().expect("is UTF-8"));
    let motion = opened::motion(path("mesh2motion/cmu_91_48.glb").to_str().expect("is UTF-8"));
    let contents = Contents { motions: Some(vec![motion]), is_by_hand: true, ..Contents::default() };
    editor.open(contents, None, &mut any).expect("fits");
    assert!(are_automatic(&editor));
    assert!(editor.undo());
    let clip = active_clip(editor.library().active().expect("is open"), editor.state()).expect("plays");
    let figures = editor.library().figures(clip.id()).expect("is borrowed");
    let slides = figures.foot_slide_metres_per_sec.expect("has feet");
    assert!(slides < 0.1 && figures.foot_hover_metres_mean.expect("has feet").abs() < 0.001, "{figures:?}");
    assert!(figures.sole_penetration_metres_max.expect("has soles") > 0.1, "{figures:?}");
}

#[test]
fn feet_that_would_slide_are_held_and_let_go_with_one_step() {
    let mut editor = editor("sample:dwarf");
    let told = open_by_hand(&mut editor, "sample:walk");
    assert_eq!(editor.state().character.retarget.feet, Some(Feet::Plant));
    let is_told =
        |event: &Event| matches!(event, Event::Notice { text, undoable: true } if text.contains("held on the ground"));
    assert!(told.iter().any(is_told), "{told:?}");
    assert_eq!(editor.state().camera, CameraChoice::Auto, "it frames the clip as it is now");
    let is_edit = |editor: &Editor| (editor.can_undo_retargeting(), editor.can_redo_retargeting());
    assert_eq!((are_automatic(&editor), is_edit(&editor)), (true, (false, false)), "not the user's edit");
    assert!(editor.undo());
    assert_eq!((are_automatic(&editor), is_edit(&editor)), (false, (false, false)));
    editor.redo();
    assert_eq!((are_automatic(&editor), is_edit(&editor)), (true, (false, false)));
    for feet in [Feet::Off, Feet::Plant] {
        editor.apply(Command::SetFeet(Some(feet)));
        editor.end_gesture();
        assert_eq!((are_automatic(&editor), is_edit(&editor)), (false, (true, false)), "now it is: {feet:?}");
    }
    editor.undo();
    assert!(editor.can_redo_retargeting());
    editor.undo();
    assert_eq!((are_automatic(&editor), is_edit(&editor)), (true, (false, true)), "as before the user's edits");
    assert!(editor.undo());
    assert_eq!((editor.state().character.retarget.feet, motions(&editor).len()), (None, 1), "only the planting");
    assert!(editor.undo());
    assert_eq!(motions(&editor).len(), 0);
    // Where the feet stand as well as the source's, nothing is done.
    let told = open_by_hand(&mut editor, "sample:mannequin");
    assert!(!told.iter().any(is_told));
    let told = open_by_hand(&mut editor, "sample:mannequin_run");
    assert_eq!((editor.state().character.retarget.feet, told.iter().any(is_told)), (None, false));
    // Opened together, model and motion are set up as one after the other.
    let both = |is_by_hand| Contents {
        is_by_hand,
        motions: contents(&["sample:walk"]).motions,
        ..contents(&["sample:dwarf"])
    };
    let opened = |contents, mut editor: Editor| {
        editor.open(contents, None, &mut any).expect("fits");
        let told = editor.take_events();
        (editor.state().character.retarget.feet, told.iter().any(is_told), told.contains(&Event::MotionsAdded))
    };
    assert_eq!(opened(both(true), super::editor("sample:pilot")), (Some(Feet::Plant), true, true));
    assert_eq!(opened(both(true), Editor::default()), (Some(Feet::Plant), true, true), "in an empty editor as well");
    // A script gets what it says.
    assert_eq!(opened(both(false), super::editor("sample:pilot")), (None, false, false));
    open(&mut editor, "sample:dwarf");
    editor.remove_motion(&motion_at(editor.library(), 0));
    open(&mut editor, "sample:walk");
    assert_eq!(editor.state().character.retarget.feet, None);
}
