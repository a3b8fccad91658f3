//! Undo and redo.

use gaitway::state::{Command, History, UpAxis, ViewerState};

use crate::data::walker;

#[test]
fn a_gesture_is_one_step() {
    let library = walker();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    for stops in [0.1, 0.2, 0.3] {
        history.apply(&mut state, &library, Command::SetExposure(stops));
        // Time goes by while a slider is dragged.
        history.apply(&mut state, &library, Command::Advance(0.01));
    }
    history.end_gesture();
    history.apply(&mut state, &library, Command::SetExposure(1.0));
    assert!(history.undo(&mut state));
    assert_eq!(state.exposure, 0.3);
    assert!(history.undo(&mut state));
    assert_eq!(state.exposure, 0.0);
    assert!(!history.undo(&mut state));
    assert!(history.redo(&mut state) && history.redo(&mut state) && !history.redo(&mut state));
    assert_eq!(state.exposure, 1.0);
}

#[test]
fn time_and_camera_stay_where_they_are() {
    let library = walker();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    history.apply(&mut state, &library, Command::SetUp(UpAxis::Z));
    history.apply(&mut state, &library, Command::Seek(0.5));
    history.apply(&mut state, &library, Command::Orbit { yaw_radians: 1.0, pitch_radians: 0.0 });
    let before = state.clone();
    assert!(history.undo(&mut state));
    assert_eq!(state, ViewerState { up: UpAxis::Y, ..before });
    assert!(!history.can_undo());
}

#[test]
fn a_new_edit_forgets_what_was_undone() {
    let library = walker();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    history.apply(&mut state, &library, Command::SetExposure(1.0));
    history.undo(&mut state);
    history.apply(&mut state, &library, Command::SetUp(UpAxis::X));
    assert!(!history.can_redo());
}

#[test]
fn what_changes_nothing_is_no_step() {
    let library = walker();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    history.apply(&mut state, &library, Command::SetExposure(0.0));
    assert!(!history.can_undo());
}
