//! The frames of a video of one loop: how many there are, and what each shows.

use gaitway_character::anim::{LoopMode, TimeRange};
use gaitway_scene::library::Library;
use gaitway_scene::state::{CameraChoice, Command, LoopFrames, ViewerState, apply, clip_secs, resolve_camera};
use glam::Vec3;

use crate::by_place::ByPlace;
use crate::data::moving_box;

const ASPECT: f32 = 16.0 / 9.0;

/// A box that moves ten metres in one second.
fn one_second() -> Library {
    moving_box(0.5, &[0.0, 1.0], &[Vec3::ZERO, Vec3::X * 10.0])
}

/// Returns the view after these commands, paused in the middle of a frame.
fn paused(library: &Library, commands: impl IntoIterator<Item = Command>) -> ViewerState {
    let mut state = ViewerState::default();
    let end = [Command::Seek(0.43), Command::SetPlaying(false)];
    commands.into_iter().chain(end).for_each(|command| apply(&mut state, library, command));
    state
}

/// Checks the clip times of all frames of a video with 10 frames per second.
#[track_caller]
fn check(commands: impl IntoIterator<Item = Command>, expected: &[f64]) {
    let library = one_second();
    let frames = LoopFrames::new(&library, &paused(&library, commands), ASPECT, 10).expect("something plays");
    let model = library.active().expect("a model");
    let secs: Vec<f64> =
        (0..frames.count()).map(|frame| clip_secs(model.clip_at(0), &frames.state(&library, frame))).collect();
    assert_eq!(secs.len(), expected.len(), "{secs:?}");
    for (secs, expected) in secs.iter().zip(expected) {
        assert!((secs - expected).abs() < 1e-6, "{secs} instead of {expected}");
    }
}

#[test]
fn nothing_plays_in_the_rest_pose() {
    let library = moving_box(0.5, &[0.0], &[Vec3::ZERO]);
    assert_eq!(LoopFrames::new(&library, &ViewerState::default(), ASPECT, 30), None);
    assert_eq!(LoopFrames::new(&Library::default(), &ViewerState::default(), ASPECT, 30), None);
}

#[test]
fn a_loop_ends_before_its_first_frame_is_repeated() {
    check([], &[0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]);
}

#[test]
fn speed_and_range_are_kept() {
    let range = Some(TimeRange { start_secs: 0.25, end_secs: 0.75 });
    check([Command::SetRange(range)], &[0.25, 0.35, 0.45, 0.55, 0.65]);
    check([Command::SetRange(range), Command::SetSpeed(2.0)], &[0.25, 0.45, 0.65]);
    check([Command::SetSpeed(4.0)], &[0.0, 0.4, 0.8]);
}

#[test]
fn ping_pong_goes_both_ways_and_once_ends_with_the_last_pose() {
    let range = Some(TimeRange { start_secs: 0.5, end_secs: 0.8 });
    let mode = |mode| [Command::SetRange(range), Command::SetLoopMode(mode)];
    check(mode(LoopMode::PingPong), &[0.5, 0.6, 0.7, 0.8, 0.7, 0.6]);
    check(mode(LoopMode::Once), &[0.5, 0.6, 0.7, 0.8]);
}

#[test]
fn a_clip_shorter_than_a_frame_has_one() {
    check([Command::SetRange(Some(TimeRange { start_secs: 0.5, end_secs: 0.51 }))], &[0.5]);
}

#[test]
fn the_turntable_turns_the_camera_of_the_first_frame() {
    let library = one_second();
    let state = paused(&library, [Command::SetTurntable(90.0)]);
    let frames = LoopFrames::new(&library, &state, ASPECT, 10).expect("something plays");
    let orbit = |frame| match frames.state(&library, frame).camera {
        CameraChoice::Orbit(orbit) => orbit,
        camera => panic!("{camera:?}"),
    };
    let mut start = state.clone();
    apply(&mut start, &library, Command::Seek(0.0));
    assert_eq!(orbit(0), resolve_camera(&library, &start, ASPECT));
    let turned = orbit(5).yaw_radians - orbit(0).yaw_radians;
    assert!((turned - std::f32::consts::FRAC_PI_4).abs() < 1e-5, "{turned}");
    assert_eq!(orbit(5).distance, orbit(0).distance);
}

/// A clip of a thousand years is more than anyone draws, and no reason to count wrongly.
#[test]
fn frames_of_ages_are_too_many() {
    let library = moving_box(0.5, &[0.0, 3e10], &[Vec3::ZERO, Vec3::X]);
    let frames = LoopFrames::new(&library, &ViewerState::default(), ASPECT, 60).expect("something plays");
    assert!(frames.count() > LoopFrames::MAX_COUNT);
}
