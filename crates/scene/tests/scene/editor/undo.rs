//! Undo and the notices that offer it.

use gaitway_retarget::Feet;
use gaitway_scene::editor::{Contents, Editor, Event};
use gaitway_scene::state::{Command, Edited, Hidden, Inspect, KeyLight, MapEdit, Show, UpAxis};

use super::{active, any, editor, id_of, notices, open, open_motion};
use crate::by_place::motion_at;
use crate::opened::contents;

#[test]
fn notices_say_how_to_go_back() {
    let mut editor = editor("sample:pilot");
    assert_eq!(notices(&open(&mut editor, "sample:creature")), ["Opened Fox."]);
    assert_eq!(notices(&open(&mut editor, "sample:pilot")), ["Reopened Pilot."]);
    editor.undo();
    assert_eq!(notices(&editor.take_events()), ["Back to Fox. Redo returns to Pilot."]);
    editor.redo();
    editor.take_events();
    let added = open(&mut editor, "sample:walk");
    assert_eq!(notices(&added), ["Added 1 clip from Walk."]);
    assert!(matches!(added.last(), Some(Event::Notice { undoable: true, .. })));
    editor.undo();
    let undone = editor.take_events();
    assert_eq!(notices(&undone), ["Removed motion Walk. Redo brings it back."]);
    assert_eq!(undone[0], Event::Stepped { is_undo: true, edited: None }, "earlier notices are outdated");
}

#[test]
fn a_step_says_what_it_changed() {
    let mut editor = editor("sample:pilot");
    let commands = [
        (Command::SetFeet(Some(Feet::Plant)), Edited::Retargeting),
        (Command::SetPose { joint: 2, degrees: Some([0.0, 30.0, 0.0]) }, Edited::Pose),
        (Command::RenameJoint { joint: 2, name: "spine".into() }, Edited::JointNames),
        (Command::SetHidden(Hidden { nodes: [1].into(), ..Hidden::default() }), Edited::Hidden),
        (Command::SetUp(UpAxis::Z), Edited::UpAxis),
        (Command::SetKeyLight(Some(KeyLight::STUDIO)), Edited::Lighting),
        (Command::SetExposure(1.0), Edited::Display),
        (Command::SetInspect(Inspect { split: true, ..Inspect::default() }), Edited::Display),
    ];
    for (command, edited) in commands {
        editor.apply(command);
        editor.take_events();
        editor.undo();
        assert_eq!(editor.take_events()[0], Event::Stepped { is_undo: true, edited: Some(edited) });
        editor.redo();
        assert_eq!(editor.take_events()[0], Event::Stepped { is_undo: false, edited: Some(edited) });
    }
}

#[test]
fn the_clip_before_a_motion_plays_again_after_undo() {
    let mut editor = editor("sample:pilot");
    let before = editor.state().character.playhead.clip.clone();
    open(&mut editor, "sample:walk");
    let borrowed = editor.state().character.playhead.clip.clone();
    assert_ne!(borrowed, before);
    editor.undo();
    assert_eq!(editor.state().character.playhead.clip, before);
    editor.redo();
    assert_eq!(editor.state().character.playhead.clip, borrowed);
}

#[test]
fn redo_plays_the_motion_that_was_added_last() {
    let mut editor = editor("sample:pilot");
    open(&mut editor, "sample:walk");
    let walk = editor.state().character.playhead.clip.clone();
    open_motion(&mut editor, "dance.glb");
    let dance = editor.state().character.playhead.clip.clone();
    assert_ne!(dance, walk);
    editor.undo();
    assert_eq!(editor.state().character.playhead.clip, walk);
    editor.redo();
    assert_eq!(editor.state().character.playhead.clip, dance);
}

#[test]
fn undo_says_which_models_it_brings_back() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    editor.open_motion_alone(&motion_at(editor.library(), 0), &mut any).expect("fits");
    editor.take_events();
    editor.undo();
    assert_eq!(notices(&editor.take_events()), ["Back to Pilot. Redo returns to dance.glb."]);
    open(&mut editor, "sample:creature");
    editor.close(id_of(&editor, "sample:pilot"), &mut any).expect("is not active");
    editor.take_events();
    editor.undo();
    assert_eq!(notices(&editor.take_events()), ["Reopened Pilot. Redo closes it."]);
    editor.redo();
    assert_eq!(notices(&editor.take_events()), ["Closed Pilot. Undo reopens it."]);
}

#[test]
fn a_panel_knows_whose_edit_undo_takes_back() {
    let mut editor = editor("sample:pilot");
    open_motion(&mut editor, "dance.glb");
    let can = |editor: &Editor| (editor.can_undo_retargeting(), editor.can_redo_retargeting());
    assert!(editor.can_undo(), "the motion");
    assert_eq!(can(&editor), (false, false));
    editor.apply(Command::EditMap { motion: motion_at(editor.library(), 0), edit: MapEdit::SwapSides });
    assert_eq!(can(&editor), (true, false));
    editor.undo();
    assert_eq!(can(&editor), (false, true));
    editor.redo();
    editor.apply(Command::SetShow(Show { grid: false, ..Show::default() }));
    assert_eq!(can(&editor), (false, false), "the last step is the grid's");
}

/// The sample that is there before the user opens anything.
#[test]
fn the_users_first_file_is_no_step() {
    let own = || Contents { is_by_hand: true, ..contents(&["assets/samples/creature.glb"]) };
    let mut editor = editor("sample:pilot");
    editor.open(own(), None, &mut any).expect("fits");
    assert!(!editor.can_undo());
    // It stays in the list, with its view.
    let sample = id_of(&editor, "sample:pilot");
    editor.activate(sample, &mut any).expect("fits");
    assert_eq!(active(&editor), "sample:pilot");

    // Once something was done to it, undo leads back there.
    let mut editor = super::editor("sample:pilot");
    editor.apply(Command::SetPose { joint: 9, degrees: Some([90.0, 0.0, 0.0]) });
    editor.open(own(), None, &mut any).expect("fits");
    assert!(editor.undo());
    assert_eq!(active(&editor), "sample:pilot");
}
