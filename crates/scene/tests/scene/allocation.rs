//! Playback stops allocating once the frame's buffers have grown.

use gaitway_retarget::{Pin, PinGoal, PinTimes};
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::library::Library;
use gaitway_scene::state::{CameraOptions, Command, Selection, ViewerState, apply};
use glam::Vec3;

use crate::allocations::allocations_after;
use crate::data::walker;

/// Counts the allocations of `frames` frames of playback, after `warm_up` frames that grow the buffers.
pub fn allocations_while_playing(library: &Library, mut state: ViewerState, warm_up: usize, frames: usize) -> usize {
    let mut frame = Frame::default();
    let mut play = |frames: usize| {
        for _ in 0..frames {
            apply(&mut state, library, Command::Advance(1.0 / 60.0));
            evaluate(library, &state, 1.5, &mut frame);
        }
    };
    allocations_after(&mut play, |play| play(warm_up), |play| play(frames))
}

#[test]
fn a_second_loop_of_the_clip_does_not_allocate() {
    let library = walker();
    let mut state = ViewerState {
        camera_options: CameraOptions { follow: true, ..CameraOptions::default() },
        selection: Selection { joint: Some(5), ..Selection::default() },
        ..ViewerState::default()
    };
    state.display.show.skeleton = true;
    state.display.show.bounds = true;
    state.inspect.weights = true;
    state.inspect.split = true;
    state.character.edits.pose.insert(15, [20.0, 0.0, 0.0]);
    let times = Some(PinTimes { start_secs: 0.2, end_secs: 0.6, blend_secs: 0.1 });
    for (joint, goal) in [(9, PinGoal::Point(Vec3::Y)), (13, PinGoal::Joint(5, Vec3::X)), (5, PinGoal::Camera)] {
        state.character.edits.pins.insert(joint, Pin { goal, times });
    }
    assert_eq!(allocations_while_playing(&library, state, 70, 200), 0);
}
