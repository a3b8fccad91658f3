//! Manually posed joints, and the turntable.

use gaitway_character::anim::JointIndex;
use gaitway_retarget::{Pin, PinGoal};
use gaitway_scene::editor::{ClipFormat, Editor, Export};
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::library::{ClipId, Library, manual_degrees, manual_rotation};
use gaitway_scene::state::{
    CameraChoice, CameraOptions, CharacterView, ClipChoice, Command, History, Playback, Playhead, ViewerState, apply,
};
use glam::{EulerRot, Quat, Vec3};

use crate::data::{sampled, walker};
use crate::history::undo;
use crate::pins::{check_written, exported};

/// Joints of the walker, by index in the file.
const HEAD: usize = 5;
const SHIN: usize = 15;
const UPPER_ARM: usize = 7;
const HAND: usize = 9;

fn local_rotation(library: &Library, state: &ViewerState, joint: usize) -> Quat {
    let model = library.active().expect("a model");
    sampled(model, state).pose.local(model.asset.skeleton.joint_of_source(joint).expect("a joint")).rotation
}

fn rest_rotation(library: &Library, joint: usize) -> Quat {
    let skeleton = &library.active().expect("a model").asset.skeleton;
    skeleton.rest().local(skeleton.joint_of_source(joint).expect("a joint")).rotation
}

#[test]
fn a_manual_pose_overrides_the_clip_and_starts_from_the_rest_pose() {
    let library = walker();
    let mut state = ViewerState {
        character: CharacterView {
            playhead: Playhead { time_secs: 0.3, ..Playhead::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    let before = local_rotation(&library, &state, SHIN);
    let head = local_rotation(&library, &state, HEAD);
    apply(&mut state, &library, Command::SetPose { joint: SHIN, degrees: Some([90.0, 0.0, 0.0]) });
    let expected = rest_rotation(&library, SHIN) * Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    assert!(local_rotation(&library, &state, SHIN).angle_between(expected) < 1e-5);
    assert_eq!(local_rotation(&library, &state, HEAD), head);
    apply(&mut state, &library, Command::SetPose { joint: SHIN, degrees: None });
    assert_eq!(local_rotation(&library, &state, SHIN), before);
}

#[test]
fn posing_a_joint_moves_its_descendants() {
    let library = walker();
    let foot = |state: &ViewerState| {
        let mut frame = Frame::default();
        evaluate(&library, state, 1.5, &mut frame);
        let skeleton = &library.active().expect("a model").asset.skeleton;
        let shin = skeleton.joint_of_source(SHIN).expect("a joint");
        let foot: JointIndex = skeleton.children(shin).next().expect("a foot");
        Vec3::from(frame.characters[0].world_from_joint[foot.get()].translation)
    };
    let rest = ViewerState {
        character: CharacterView {
            playhead: Playhead { clip: ClipChoice::RestPose, ..Playhead::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    let mut posed = rest.clone();
    apply(&mut posed, &library, Command::SetPose { joint: SHIN, degrees: Some([90.0, 0.0, 0.0]) });
    assert!(foot(&rest).distance(foot(&posed)) > 0.2);
}

#[test]
fn angles_and_rotations_convert_both_ways() {
    let rest = Quat::from_euler(EulerRot::ZXY, 0.4, -1.0, 2.0);
    for degrees in [[0.0, 0.0, 0.0], [10.0, -70.0, 160.0], [-120.0, 35.0, 5.0], [90.0, 90.0, -30.0]] {
        let rotation = manual_rotation(rest, degrees);
        let again = manual_rotation(rest, manual_degrees(rest, rotation));
        assert!(rotation.angle_between(again) < 2e-3, "{degrees:?}");
    }
}

#[test]
fn missing_joints_and_angles_that_are_not_finite_change_nothing() {
    let library = walker();
    for (joint, degrees) in [(4000, [1.0, 2.0, 3.0]), (HEAD, [f32::NAN, 0.0, 0.0]), (HEAD, [0.0, f32::INFINITY, 0.0])] {
        let mut state = ViewerState::default();
        apply(&mut state, &library, Command::SetPose { joint, degrees: Some(degrees) });
        assert_eq!(state, ViewerState::default());
    }
    let mut state = ViewerState::default();
    apply(&mut state, &library, Command::SetPose { joint: HEAD, degrees: Some([190.0, -540.0, 180.0]) });
    assert_eq!(state.character.edits.pose[&HEAD], [-170.0, -180.0, 180.0]);
}

/// Together with a pin, which applies afterwards.
#[test]
fn exports_have_what_is_set_manually() {
    let mut editor = Editor::new(walker(), ViewerState::default());
    let what = Export::Clip { clip: ClipId::Own(0), format: ClipFormat::Glb };
    assert_eq!(editor.export(&what).expect("has keys").remark, None);
    assert!(editor.export(&Export::Model { clip: ClipId::Own(0) }).is_err(), "the file has this clip");
    let hand = Pin { goal: PinGoal::Point(Vec3::new(0.25, 1.2, 0.3)), times: None };
    for command in [
        Command::SetPose { joint: SHIN, degrees: Some([90.0, 0.0, 10.0]) },
        Command::SetPose { joint: UPPER_ARM, degrees: Some([20.0, 30.0, 0.0]) },
        Command::SetPin { joint: HAND, pin: Some(hand) },
    ] {
        editor.apply(command);
    }
    let remark = editor.export(&what).expect("has keys").remark;
    assert_eq!(remark.as_deref(), Some("Manually posed joints hold their pose in it."));
    for what in [&what, &Export::Model { clip: ClipId::Own(0) }] {
        check_written(&editor, &exported(&editor, what), 1.0, (1.8e-4, 0.1));
    }
}

#[test]
fn manual_poses_are_undone_one_gesture_at_a_time() {
    let mut library = walker();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    for angle in [5.0, 10.0, 15.0] {
        history.apply(&mut state, &library, Command::SetPose { joint: HEAD, degrees: Some([angle, 0.0, 0.0]) });
    }
    history.end_gesture();
    history.apply(&mut state, &library, Command::ClearPose);
    assert!(state.character.edits.pose.is_empty());
    assert!(undo(&mut history, &mut state, &mut library));
    assert_eq!(state.character.edits.pose[&HEAD], [15.0, 0.0, 0.0]);
    assert!(undo(&mut history, &mut state, &mut library));
    assert!(state.character.edits.pose.is_empty());
}

#[test]
fn the_turntable_turns_while_paused_unless_the_camera_is_the_files() {
    let library = walker();
    let mut state = ViewerState {
        playback: Playback { playing: false, ..Playback::default() },
        camera_options: CameraOptions { turntable: 90.0, ..CameraOptions::default() },
        ..ViewerState::default()
    };
    apply(&mut state, &library, Command::Advance(0.5));
    let CameraChoice::Orbit(first) = state.camera else { panic!("an orbit camera") };
    apply(&mut state, &library, Command::Advance(0.5));
    let CameraChoice::Orbit(second) = state.camera else { panic!("an orbit camera") };
    assert!((second.yaw_radians - first.yaw_radians - std::f32::consts::FRAC_PI_4).abs() < 1e-5);
    assert_eq!(state.character.playhead.time_secs, 0.0);
    let mut fixed = ViewerState { camera: CameraChoice::File(0), ..state };
    apply(&mut fixed, &library, Command::Advance(0.5));
    assert_eq!(fixed.camera, CameraChoice::File(0));
}
