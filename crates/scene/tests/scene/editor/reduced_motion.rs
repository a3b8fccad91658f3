//! A wish for reduced motion.

use gaitway_scene::editor::{Contents, Editor};
use gaitway_scene::state::{Command, ViewerState, to_link};

use super::{any, contents, motion};
use crate::texts::link_of;

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
    assert_eq!(to_link(&editor.shared_state(), editor.library()), link_of(&turning()));
    editor.apply(Command::Replace(Box::new(turning())));
    assert!(calm(&editor));
    editor.apply(Command::SetSpeed(2.0));
    let link = to_link(&editor.shared_state(), editor.library());
    assert!(link.contains("turntable=20") && !link.contains("play="), "{link}");
    // The user's own choice is shared.
    editor.apply(Command::TogglePlaying);
    assert!(editor.state().playback.playing);
    editor.apply(Command::TogglePlaying);
    assert!(to_link(&editor.shared_state(), editor.library()).contains("play=0"));
    assert!(to_link(&editor.shared_state(), editor.library()).contains("turntable=20"));
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
        assert_eq!(to_link(&editor.shared_state(), editor.library()), link_of(&view(model, turntable)));
    }
    editor.apply(Command::TogglePlaying);
    follow(&mut editor, "sample:pilot", 30.0);
    assert_eq!(moving(&editor), (false, 0.0), "another link");
    assert!(editor.undo());
    assert_eq!(moving(&editor), (true, 0.0), "the user had started it");
    assert_eq!(to_link(&editor.shared_state(), editor.library()), link_of(&view("sample:walker", 20.0)));
    assert!(editor.redo());
    assert_eq!(moving(&editor), (false, 0.0));
    assert_eq!(to_link(&editor.shared_state(), editor.library()), link_of(&view("sample:pilot", 30.0)));
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
        view.character.sources.motion = vec![name.to_owned()];
        view.playback.playing = playing.unwrap_or(view.playback.playing);
        let contents = Contents { motions: Some(vec![motion(name)]), ..Contents::default() };
        editor.open_change(contents, view, &mut any).expect("fits");
        editor.state().playback.playing
    };
    assert!(!change(&mut editor, "a.bvh", None), "the user hasn't started it");
    assert!(!to_link(&editor.shared_state(), editor.library()).contains("play="));
    editor.apply(Command::TogglePlaying);
    assert!(change(&mut editor, "b.bvh", None));
    assert!(!change(&mut editor, "c.bvh", Some(false)), "the change says so");
}
