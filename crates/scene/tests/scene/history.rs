//! Undo and redo.

use gaitway_scene::library::{Library, Model, ModelId, Motion};
use gaitway_scene::state::{
    CharacterView, Command, Edits, History, Playhead, SavedMotion, Sources, UpAxis, ViewerState,
};

use crate::data::walker;

/// Undoes one step without a preference for reduced motion.
pub fn undo(history: &mut History, state: &mut ViewerState, library: &mut Library) -> bool {
    history.undo(state, &mut SavedMotion::default(), library)
}

/// Redoes one step without a preference for reduced motion.
pub fn redo(history: &mut History, state: &mut ViewerState, library: &mut Library) -> bool {
    history.redo(state, &mut SavedMotion::default(), library)
}

#[test]
fn a_gesture_is_one_step() {
    let mut library = walker();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    for stops in [0.1, 0.2, 0.3] {
        history.apply(&mut state, &library, Command::SetExposure(stops));
        // Time advances while a slider is dragged.
        history.apply(&mut state, &library, Command::Advance(0.01));
    }
    history.end_gesture();
    history.apply(&mut state, &library, Command::SetExposure(1.0));
    assert!(undo(&mut history, &mut state, &mut library));
    assert_eq!(state.display.exposure, 0.3);
    assert!(undo(&mut history, &mut state, &mut library));
    assert_eq!(state.display.exposure, 0.0);
    assert!(!undo(&mut history, &mut state, &mut library));
    assert!(
        redo(&mut history, &mut state, &mut library)
            && redo(&mut history, &mut state, &mut library)
            && !redo(&mut history, &mut state, &mut library)
    );
    assert_eq!(state.display.exposure, 1.0);
}

/// A double click after a step, its first click moving a slider to `first`, the second one resetting it: undoing it leads back to
/// the step.
fn check_double_click(first: Option<f32>) {
    let mut library = walker();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    for moved_to in [Some(1.0), first, None] {
        history.pointer_pressed();
        if let Some(stops) = moved_to {
            history.apply(&mut state, &library, Command::SetExposure(stops));
        }
        history.end_gesture();
    }
    history.continue_gesture();
    history.apply(&mut state, &library, Command::SetExposure(0.0));
    assert_eq!(history.steps(), 2);
    assert!(undo(&mut history, &mut state, &mut library));
    assert_eq!(state.display.exposure, 1.0);
}

#[test]
fn a_double_click_is_one_step() {
    check_double_click(Some(0.4));
}

#[test]
fn a_double_click_whose_first_click_changes_nothing_leaves_older_steps_alone() {
    check_double_click(None);
}

#[test]
fn a_gesture_that_ends_where_it_began_is_no_step() {
    let mut library = walker();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    for stops in [0.5, 0.0] {
        history.apply(&mut state, &library, Command::SetExposure(stops));
    }
    assert!(!history.can_undo());
    history.apply(&mut state, &library, Command::SetExposure(0.7));
    assert!(undo(&mut history, &mut state, &mut library));
    assert_eq!(state.display.exposure, 0.0);
}

#[test]
fn undo_keeps_time_and_camera() {
    let mut library = walker();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    history.apply(&mut state, &library, Command::SetUp(UpAxis::Z));
    history.apply(&mut state, &library, Command::Seek(0.5));
    history.apply(&mut state, &library, Command::Orbit { yaw_radians: 1.0, pitch_radians: 0.0 });
    let before = state.clone();
    assert!(undo(&mut history, &mut state, &mut library));
    assert_eq!(
        state,
        ViewerState {
            character: CharacterView { edits: Edits { up: UpAxis::Y, ..before.character.edits }, ..before.character },
            ..before
        }
    );
    assert!(!history.can_undo());
}

#[test]
fn a_new_edit_discards_undone_steps() {
    let mut library = walker();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    history.apply(&mut state, &library, Command::SetExposure(1.0));
    undo(&mut history, &mut state, &mut library);
    history.apply(&mut state, &library, Command::SetUp(UpAxis::X));
    assert!(!history.can_redo());
}

#[test]
fn a_command_that_changes_nothing_is_not_a_step() {
    let library = walker();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    history.apply(&mut state, &library, Command::SetExposure(0.0));
    assert!(!history.can_undo());
}

/// A library with two models; the second is active.
fn two_models() -> (Library, ModelId, ModelId) {
    let mut library = Library::default();
    let model = |source: &str| Model::new(source.to_owned(), walker().active().unwrap().asset.clone(), Vec::new());
    let first = library.add(model("first.glb"));
    let second = library.add(model("second.glb"));
    (library, first, second)
}

#[test]
fn opening_is_a_step_between_edits() {
    let (mut library, first, second) = two_models();
    let mut history = History::default();
    library.show(first);
    let mut state = ViewerState {
        character: CharacterView {
            playhead: Playhead { time_secs: 0.7, ..Playhead::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    history.apply(&mut state, &library, Command::SetExposure(1.0));
    history.opened(state.clone(), SavedMotion::default(), library.loaded());
    library.show(second);
    let asset = library.active().unwrap().asset.clone();
    library.set_motions(vec![Motion::new("dance.glb".to_owned(), asset)]);
    state = ViewerState {
        character: CharacterView {
            sources: Sources { motion: vec!["dance.glb".to_owned()], ..Sources::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    history.end_gesture();
    history.apply(&mut state, &library, Command::SetExposure(2.0));

    let active = |library: &Library| library.active().map(|model| model.id);
    assert!(undo(&mut history, &mut state, &mut library));
    assert_eq!(
        (active(&library), state.display.exposure, state.character.sources.motion.len()),
        (Some(second), 0.0, 1)
    );
    assert!(undo(&mut history, &mut state, &mut library));
    assert_eq!((active(&library), state.display.exposure, state.character.playhead.time_secs), (Some(first), 1.0, 0.7));
    assert!(library.motions().is_empty() && state.character.sources.motion.is_empty());
    assert!(undo(&mut history, &mut state, &mut library));
    assert_eq!(state.display.exposure, 0.0);
    while redo(&mut history, &mut state, &mut library) {}
    assert_eq!((active(&library), state.display.exposure, library.motions().len()), (Some(second), 2.0, 1));
}

#[test]
fn steps_to_an_evicted_model_are_dropped() {
    let (mut library, first, second) = two_models();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    history.apply(&mut state, &library, Command::SetExposure(1.0));
    library.show(first);
    history.opened(state.clone(), SavedMotion::default(), library.loaded());
    library.show(second);
    history.apply(&mut state, &library, Command::SetExposure(2.0));
    library.remove(first);
    history.forget_gone(&library);
    assert!(undo(&mut history, &mut state, &mut library));
    assert!(!history.can_undo());
    assert_eq!(library.active().map(|model| model.id), Some(second));
}

#[test]
fn undo_relists_a_closed_model_and_keeps_the_view() {
    let (mut library, first, second) = two_models();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    history.closed(library.listed());
    library.close(second);
    assert_eq!(library.listed(), [first, second], "the active model stays");
    library.close(first);
    assert_eq!(library.listed(), [second]);
    state.character.playhead.time_secs = 0.7;
    assert!(undo(&mut history, &mut state, &mut library));
    assert_eq!((library.listed(), state.character.playhead.time_secs), (vec![first, second], 0.7));
    assert!(redo(&mut history, &mut state, &mut library));
    assert_eq!(library.listed(), [second]);
    assert_eq!(library.active().map(|model| model.id), Some(second));
    assert!(library.show(first), "a step may activate a closed model");
    assert_eq!(library.listed(), [first, second]);
}

#[test]
fn closed_models_are_evicted_first() {
    let (mut library, first, second) = two_models();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    let asset = library.active().unwrap().asset.clone();
    history.closed(library.listed());
    library.close(first);
    for index in 1..Library::MAX_MODELS {
        library.add(Model::new(format!("{index}.glb"), asset.clone(), Vec::new()));
    }
    assert!(library.trim(|_| false).is_empty(), "evicting closed models is not reported");
    assert!(library.get(first).is_none() && library.get(second).is_some());
    history.forget_gone(&library);
    assert!(!undo(&mut history, &mut state, &mut library), "the steps to lists with it are dropped");
}

#[test]
fn the_oldest_model_is_evicted_but_never_the_active_one() {
    let (mut library, first, second) = two_models();
    let asset = library.active().unwrap().asset.clone();
    for index in library.models().len()..Library::MAX_MODELS {
        library.add(Model::new(format!("{index}.glb"), asset.clone(), Vec::new()));
    }
    assert!(library.trim(|_| false).is_empty());
    let newest = library.add(Model::new("one-more.glb".to_owned(), asset.clone(), Vec::new()));
    library.show(first);
    let gone: Vec<ModelId> = library.trim(|_| false).iter().map(|model| model.id).collect();
    assert_eq!((gone, library.models().len()), (vec![second], Library::MAX_MODELS));
    assert_eq!(library.active().map(|model| model.id), Some(first));
    // One that is precious gives way only where all are.
    let inactive: Vec<ModelId> = library.models().iter().map(|model| model.id).filter(|id| *id != first).collect();
    for (is_precious, evicted) in
        [(&(|id| id == inactive[0]) as &dyn Fn(ModelId) -> bool, inactive[1]), (&|_| true, inactive[0])]
    {
        library.add(Model::new("another.glb".to_owned(), asset.clone(), Vec::new()));
        library.show(first);
        assert_eq!(library.trim(is_precious).iter().map(|model| model.id).collect::<Vec<_>>(), [evicted]);
    }
    library.remove(first);
    assert!(library.get(first).is_some(), "the active model stays");
    library.remove(newest);
    assert!(library.get(newest).is_none());
}
