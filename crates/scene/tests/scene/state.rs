//! The effect of commands on a view.

use std::f32::consts::PI;

use gaitway_character::anim::{LoopMode, TimeRange};
use gaitway_retarget::ClipChanges;
use gaitway_scene::library::{ClipId, Library, ModelClip};
use gaitway_scene::state::{
    CameraChoice, CameraOptions, CharacterView, ClipChoice, ClipEdit, Command, History, NameKind, OrbitCamera,
    Playback, Playhead, UnknownName, ViewerState, active_clip, apply, clip_secs, resolve_camera, to_object,
};
use glam::Vec3;

use crate::by_place::ByPlace;
use crate::data::{moving_box, walker};
use crate::history::{redo, undo};

type Step = fn(&mut History, &mut ViewerState, &mut Library) -> bool;

fn after(library: &Library, commands: impl IntoIterator<Item = Command>) -> ViewerState {
    let mut state = ViewerState::default();
    commands.into_iter().for_each(|command| apply(&mut state, library, command));
    state
}

/// A box that moves ten metres in one second.
fn one_second() -> Library {
    moving_box(0.5, &[0.0, 1.0], &[Vec3::ZERO, Vec3::X * 10.0])
}

fn current_secs(library: &Library, state: &ViewerState) -> f64 {
    clip_secs(library.active().expect("a model").clip_at(0), state)
}

#[test]
fn numbers_that_are_not_finite_change_nothing() {
    let library = one_second();
    let nothing = [
        Command::Seek(f64::NAN),
        Command::Advance(f64::INFINITY),
        Command::SetSpeed(f64::NAN),
        Command::SetRange(Some(TimeRange { start_secs: 0.0, end_secs: f64::NAN })),
        Command::SetMorph { index: 0, weight: Some(f32::NAN) },
        Command::Orbit { yaw_radians: f32::NAN, pitch_radians: 0.0 },
        Command::Pan { right: f32::INFINITY, up: 0.0 },
        Command::Zoom { factor: f32::NAN, right: 0.0, up: 0.0 },
        Command::Zoom { factor: -1.0, right: 0.0, up: 0.0 },
        Command::Zoom { factor: 0.5, right: f32::NAN, up: 0.0 },
        Command::SetFov(f32::NAN),
        Command::SetExposure(f32::INFINITY),
        Command::SetEnvironment(f32::NAN),
        Command::SetScene(Some(3)),
        Command::SelectJoint(Some(1)),
        Command::SetCamera(CameraChoice::File(0)),
    ];
    for command in nothing {
        assert_eq!(after(&library, [command.clone()]), ViewerState::default(), "{command:?}");
    }
}

#[test]
fn values_out_of_range_are_clamped() {
    let library = one_second();
    assert_eq!(after(&library, [Command::Seek(7.0)]).character.playhead.time_secs, 1.0);
    assert_eq!(after(&library, [Command::Seek(-7.0)]).character.playhead.time_secs, 0.0);
    assert_eq!(after(&library, [Command::SetSpeed(100.0)]).playback.speed, 4.0);
    assert_eq!(after(&library, [Command::SetFov(0.0)]).camera_options.fov_degrees, 5.0);
    let range = Some(TimeRange { start_secs: -1.0, end_secs: 9.0 });
    let whole = Some(TimeRange { start_secs: 0.0, end_secs: 1.0 });
    assert_eq!(after(&library, [Command::SetRange(range)]).character.playhead.range, whole);
    let bad = ViewerState {
        character: CharacterView {
            playhead: Playhead { time_secs: f64::NAN, ..Playhead::default() },
            ..CharacterView::default()
        },
        camera: CameraChoice::Orbit(OrbitCamera {
            yaw_radians: 0.0,
            pitch_radians: 0.0,
            distance: -1.0,
            target: Vec3::ZERO,
        }),
        playback: Playback { speed: f64::INFINITY, ..Playback::default() },
        camera_options: CameraOptions { fov_degrees: 900.0, ..CameraOptions::default() },
        ..ViewerState::default()
    };
    let expected = ViewerState {
        camera_options: CameraOptions { fov_degrees: 120.0, ..CameraOptions::default() },
        ..ViewerState::default()
    };
    assert_eq!(after(&library, [Command::Replace(Box::new(bad))]), expected);
    let before_the_start = ViewerState {
        character: CharacterView {
            playhead: Playhead { time_secs: -1.0, ..Playhead::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    assert_eq!(after(&library, [Command::Replace(Box::new(before_the_start))]), ViewerState::default());
}

#[test]
fn time_advances_at_the_playback_speed() {
    let library = one_second();
    assert_eq!(after(&library, [Command::SetSpeed(0.5), Command::Advance(0.5)]).character.playhead.time_secs, 0.25);
    assert_eq!(after(&library, [Command::SetPlaying(false), Command::Advance(0.5)]).character.playhead.time_secs, 0.0);
    assert_eq!(
        after(&library, [Command::SetClip(ClipChoice::RestPose), Command::Advance(0.5)]).character.playhead.time_secs,
        0.0
    );
}

#[test]
fn playing_once_stops_at_the_end_and_restarts() {
    let library = one_second();
    let mut state =
        after(&library, [Command::SetLoopMode(LoopMode::Once), Command::Advance(0.75), Command::Advance(0.75)]);
    assert_eq!((state.character.playhead.time_secs, state.playback.playing), (1.0, false));
    apply(&mut state, &library, Command::TogglePlaying);
    assert_eq!((state.character.playhead.time_secs, state.playback.playing), (0.0, true));
}

#[test]
fn loops_fold_the_playhead_into_the_range() {
    let library = one_second();
    let range = Some(TimeRange { start_secs: 0.25, end_secs: 0.75 });
    for (mode, expected) in [(LoopMode::Loop, 0.35), (LoopMode::PingPong, 0.65)] {
        let mut state = after(&library, [Command::SetRange(range), Command::SetLoopMode(mode), Command::Seek(0.25)]);
        for _ in 0..6 {
            apply(&mut state, &library, Command::Advance(0.1));
        }
        assert!(
            (current_secs(&library, &state) - expected).abs() < 1e-9,
            "{mode:?}: {}",
            state.character.playhead.time_secs
        );
        // However long it plays, the playhead stays near the range.
        for _ in 0..1000 {
            apply(&mut state, &library, Command::Advance(0.1));
        }
        assert!(state.character.playhead.time_secs < 2.0, "{mode:?}");
        assert!(
            (current_secs(&library, &state) - expected).abs() < 1e-6,
            "{mode:?}: {}",
            state.character.playhead.time_secs
        );
    }
}

#[test]
fn steps_are_whole_frames_and_pause() {
    let library = one_second();
    let at_frame = |frames: f64| frames / 30.0;
    let state = after(&library, [Command::Seek(0.49), Command::StepFrames(1)]);
    assert_eq!((state.character.playhead.time_secs, state.playback.playing), (at_frame(16.0), false));
    assert_eq!(after(&library, [Command::StepFrames(-1)]).character.playhead.time_secs, 1.0);
    assert_eq!(after(&library, [Command::Seek(1.0), Command::StepFrames(1)]).character.playhead.time_secs, 0.0);
    let once = [Command::SetLoopMode(LoopMode::Once), Command::StepFrames(-1)];
    assert_eq!(after(&library, once).character.playhead.time_secs, 0.0);
}

#[test]
fn a_new_clip_starts_at_its_beginning() {
    let library = walker();
    let range = Some(TimeRange { start_secs: 0.25, end_secs: 0.75 });
    let wave = ClipChoice::Clip(ClipId::Own(2));
    let state = after(&library, [Command::Seek(0.5), Command::SetRange(range), Command::SetClip(wave.clone())]);
    assert_eq!(
        (state.character.playhead.time_secs, state.character.playhead.range, state.character.playhead.clip),
        (0.0, None, wave)
    );
}

#[test]
fn a_change_of_speed_keeps_the_pose_and_the_range() {
    let library = walker();
    let range = |start_secs, end_secs| Some(TimeRange { start_secs, end_secs });
    let change =
        |clip, changes| Command::EditClip { clip: ClipId::Own(clip), edit: ClipEdit::Change(Box::new(changes)) };
    let mut state = after(&library, [Command::Seek(0.5), Command::SetRange(range(0.25, 0.75))]);
    let check = |state: &ViewerState, time_secs, range| {
        assert_eq!((state.character.playhead.time_secs, state.character.playhead.range), (time_secs, range));
    };
    apply(&mut state, &library, change(1, ClipChanges { speed: 4.0, ..ClipChanges::NONE }));
    check(&state, 0.5, range(0.25, 0.75));
    apply(&mut state, &library, change(0, ClipChanges { speed: 2.0, ..ClipChanges::NONE }));
    check(&state, 0.25, range(0.125, 0.375));
    apply(&mut state, &library, change(0, ClipChanges { speed: 0.5, mirror: true, ..ClipChanges::NONE }));
    check(&state, 1.0, range(0.5, 1.5));
}

#[test]
fn a_reversed_clip_keeps_the_pose_and_the_range() {
    let library = walker();
    let end_secs = f64::from(library.active().expect("a model").asset.clips[0].duration_secs());
    let range = |start_secs, end_secs| Some(TimeRange { start_secs, end_secs });
    let change = |changes| Command::EditClip { clip: ClipId::Own(0), edit: ClipEdit::Change(Box::new(changes)) };
    let mut state = after(&library, [Command::SetRange(range(0.25, 0.5)), Command::Seek(0.375)]);
    apply(&mut state, &library, change(ClipChanges { reverse: true, ..ClipChanges::NONE }));
    check_time(&state, end_secs - 0.375, range(end_secs - 0.5, end_secs - 0.25));
    apply(&mut state, &library, change(ClipChanges { speed: 2.0, ..ClipChanges::NONE }));
    check_time(&state, 0.1875, range(0.125, 0.25));
    let half = 0.5 * end_secs;
    apply(&mut state, &library, change(ClipChanges { speed: 2.0, reverse: true, ..ClipChanges::NONE }));
    check_time(&state, half - 0.1875, range(half - 0.25, half - 0.125));
    // Of a part, twice as fast: a quarter of a second, looping for the third time.
    let part = ClipChanges { speed: 2.0, trim: range(0.25, 0.75), ..ClipChanges::NONE };
    apply(&mut state, &library, change(part.clone()));
    check_time(&state, 0.0, None);
    state.character.playhead.time_secs = 0.5625;
    apply(&mut state, &library, change(ClipChanges { reverse: true, ..part }));
    check_time(&state, 0.1875, None);
}

fn check_time(state: &ViewerState, time_secs: f64, range: Option<TimeRange>) {
    let numbers = |time_secs: f64, range: Option<TimeRange>| {
        [time_secs].into_iter().chain(range.into_iter().flat_map(|range| [range.start_secs, range.end_secs]))
    };
    let found = numbers(state.character.playhead.time_secs, state.character.playhead.range);
    let expected: Vec<f64> = numbers(time_secs, range).collect();
    let is_near = found.clone().zip(&expected).all(|(found, expected)| (found - expected).abs() < 1e-9);
    assert!(
        is_near && found.clone().count() == expected.len(),
        "{:?} instead of {expected:?}",
        found.collect::<Vec<_>>()
    );
}

#[test]
fn undoing_a_change_of_a_clip_restores_pose_and_range() {
    let mut library = walker();
    let range = |start_secs, end_secs| Some(TimeRange { start_secs, end_secs });
    let mut state = after(&library, [Command::Seek(0.5), Command::SetRange(range(0.25, 0.75))]);
    let mut history = History::default();
    let twice = ClipChanges { speed: 2.0, ..ClipChanges::NONE };
    let reversed = ClipChanges { reverse: true, ..twice.clone() };
    for changes in [twice, reversed] {
        history.apply(
            &mut state,
            &library,
            Command::EditClip { clip: ClipId::Own(0), edit: ClipEdit::Change(Box::new(changes)) },
        );
        history.end_gesture();
    }
    let end_secs = 0.5 * f64::from(library.active().expect("a model").asset.clips[0].duration_secs());
    check_time(&state, end_secs - 0.25, range(end_secs - 0.375, end_secs - 0.125));
    let expected =
        [(undo as Step, 0.25, range(0.125, 0.375)), (undo, 0.5, range(0.25, 0.75)), (redo, 0.25, range(0.125, 0.375))];
    for (step, time_secs, range) in expected {
        assert!(step(&mut history, &mut state, &mut library));
        check_time(&state, time_secs, range);
    }
    // A range that was set meanwhile stretches as well.
    apply(&mut state, &library, Command::SetRange(range(0.0, 0.25)));
    undo(&mut history, &mut state, &mut library);
    check_time(&state, 0.5, range(0.0, 0.5));
}

#[test]
fn clips_are_found_by_name_and_by_index() {
    let library = walker();
    let model = library.active().expect("a model");
    let find = |name: &str| {
        let playhead = Playhead { clip: ClipChoice::called(name), ..Playhead::default() };
        active_clip(
            model,
            &ViewerState {
                character: CharacterView { playhead, ..CharacterView::default() },
                ..ViewerState::default()
            },
        )
        .map(ModelClip::id)
    };
    let wave = Some(&ClipId::Own(2));
    assert_eq!((find("Wave"), find("2"), find("wave"), find("3"), find("")), (wave, wave, None, None, None));
    let first = active_clip(model, &ViewerState::default()).map(ModelClip::id);
    assert_eq!(first, Some(&ClipId::Own(0)));
    let state = after(&library, [Command::SetClip(ClipChoice::Clip(ClipId::Own(1)))]);
    assert_eq!(to_object(&state, &library)["clip"], "Idle");
}

#[test]
fn orbiting_starts_from_the_current_camera() {
    let library = walker();
    let auto = resolve_camera(&library, &ViewerState::default(), 16.0 / 9.0);
    let state = after(&library, [Command::Orbit { yaw_radians: 0.5, pitch_radians: 0.1 }]);
    let CameraChoice::Orbit(orbit) = state.camera else { panic!("{:?}", state.camera) };
    assert_eq!((orbit.distance, orbit.target), (auto.distance, auto.target));
    assert!((orbit.yaw_radians - auto.yaw_radians - 0.5).abs() < 1e-6);
    assert!((orbit.pitch_radians - auto.pitch_radians - 0.1).abs() < 1e-6);
}

#[test]
fn pitch_is_clamped_and_yaw_wraps() {
    let library = walker();
    let state = after(&library, [Command::Orbit { yaw_radians: 100.0, pitch_radians: 100.0 }]);
    let CameraChoice::Orbit(orbit) = state.camera else { panic!("{:?}", state.camera) };
    assert!(orbit.pitch_radians < 0.5 * PI && orbit.pitch_radians > 1.5);
    assert!(orbit.yaw_radians.abs() <= PI);
}

#[test]
fn panning_by_a_viewport_height_moves_by_the_visible_height() {
    let library = walker();
    let camera = OrbitCamera { yaw_radians: 0.0, pitch_radians: 0.0, distance: 2.0, target: Vec3::ZERO };
    let state =
        after(&library, [Command::SetCamera(CameraChoice::Orbit(camera)), Command::Pan { right: 1.0, up: 0.5 }]);
    let CameraChoice::Orbit(panned) = state.camera else { panic!("{:?}", state.camera) };
    let height = 4.0 * 17.5_f32.to_radians().tan();
    assert!(panned.target.distance(Vec3::new(height, 0.5 * height, 0.0)) < 1e-5, "{}", panned.target);
}

/// Of many clips, the message lists those with the most similar names; for an index, the first ones.
#[test]
fn the_message_about_an_unknown_clip_lists_similar_names() {
    let names = ["Idle", "Jump", "Run_Backwards", "Sit", "Walk", "walk_b", "Wave", "Walking", "Run"];
    let check = |name: &str, clips: &[&str], expected: &str| {
        let clips = clips.iter().map(|clip| (*clip).to_owned()).collect();
        let message = UnknownName { kind: NameKind::Clip, name: name.to_owned(), names: clips }.to_string();
        assert_eq!(message, format!("expected the name or index of a clip, found “{name}”; {expected}"));
    };
    check("Fly", &[], "there are no clips");
    check("Walc", &names[..5], "its clips are “Idle”, “Jump”, “Run_Backwards”, “Sit”, “Walk”");
    check("WALC", &names, "its clips are “Walk”, “walk_b”, “Walking”, “Wave”, “Run_Backwards” and 4 more");
    check("9", &names, "its clips are “Idle”, “Jump”, “Run_Backwards”, “Sit”, “Walk” and 4 more");
    check(&"x".repeat(1 << 20), &names, "its clips are “Idle”, “Jump”, “Run_Backwards”, “Sit”, “Walk” and 4 more");
}
