//! Pins in a view: set, undone, seen and exported.

use gaitway_character::anim::JointIndex;
use gaitway_formats::{FileSet, load};
use gaitway_retarget::{ClipLayer, Pin, PinGoal, PinTimes};
use gaitway_scene::editor::{ClipFormat, Editor, Export};
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::library::{ClipId, LayeredClip, Library, Model};
use gaitway_scene::state::{
    CameraChoice, CharacterView, ClipChoice, Command, History, OrbitCamera, Playhead, UpAxis, ViewerState, apply,
    from_link,
};
use glam::{Quat, Vec3};

use crate::data::{library_of, walker};
use crate::history::{redo, undo};
use crate::texts::link_of;

/// Joints of the walker, by index in the file.
const HIPS: usize = 1;
const HEAD: usize = 5;
const LEFT_HAND: usize = 9;
const LEFT_ARM: usize = 7;
const RIGHT_HAND: usize = 13;

fn pin(goal: PinGoal) -> Pin {
    Pin { goal, times: None }
}

fn set(joint: usize, pin: Pin) -> Command {
    Command::SetPin { joint, pin: Some(pin) }
}

fn frame(library: &Library, state: &ViewerState) -> Frame {
    let mut frame = Frame::default();
    evaluate(library, state, 1.5, &mut frame);
    frame
}

fn place(library: &Library, frame: &Frame, joint: usize) -> Vec3 {
    let joint = library.active().expect("a model").asset.skeleton.joint_of_source(joint).expect("a joint");
    frame.characters[0].world_from_joint[joint.get()].translation.into()
}

#[test]
fn the_joints_are_those_of_the_walker() {
    let library = walker();
    let skeleton = &library.active().expect("a model").asset.skeleton;
    let names = [HIPS, HEAD, LEFT_ARM, LEFT_HAND, RIGHT_HAND]
        .map(|joint| skeleton.name(skeleton.joint_of_source(joint).expect("a joint")));
    assert_eq!(names, ["Hips", "Head", "LeftUpperArm", "LeftHand", "RightHand"]);
}

/// Points are in world space, whichever axis of the file points up.
#[test]
fn a_pinned_hand_stays_while_the_clip_plays() {
    let library = walker();
    for (up, at) in [(UpAxis::Y, Vec3::new(0.25, 1.2, 0.3)), (UpAxis::Z, Vec3::new(0.25, 0.3, -1.2))] {
        let mut state = ViewerState::default();
        state.character.edits.up = up;
        apply(&mut state, &library, set(LEFT_HAND, pin(PinGoal::Point(at))));
        for time_secs in [0.0, 0.2, 0.5, 0.9] {
            apply(&mut state, &library, Command::Seek(time_secs));
            let hand = place(&library, &frame(&library, &state), LEFT_HAND);
            assert!(hand.distance(at) < 1e-5, "{hand} at {time_secs}");
        }
    }
}

/// After manual poses, and only as long as it holds.
#[test]
fn a_pin_applies_after_manual_poses_and_in_its_times() {
    let library = walker();
    let at = Vec3::new(0.25, 1.2, 0.3);
    let times = Some(PinTimes { start_secs: 0.4, end_secs: 0.6, blend_secs: 0.1 });
    let mut state = ViewerState::default();
    apply(&mut state, &library, Command::SetPose { joint: LEFT_ARM, degrees: Some([0.0, 40.0, 0.0]) });
    let unpinned = state.clone();
    apply(&mut state, &library, set(LEFT_HAND, Pin { times, ..pin(PinGoal::Point(at)) }));
    let hand = |state: &ViewerState, time_secs| {
        let mut state = state.clone();
        apply(&mut state, &library, Command::Seek(time_secs));
        place(&library, &frame(&library, &state), LEFT_HAND)
    };
    assert_eq!(hand(&state, 0.2), hand(&unpinned, 0.2));
    assert!(hand(&state, 0.5).distance(at) < 1e-5);
    let between = hand(&state, 0.35);
    assert!(between.distance(at) > 0.01 && between.distance(hand(&unpinned, 0.35)) > 0.01);
}

#[test]
fn a_head_looks_at_the_camera_wherever_it_is() {
    let library = walker();
    let skeleton = &library.active().expect("a model").asset.skeleton;
    let head = skeleton.joint_of_source(HEAD).expect("a joint");
    let rest = gaitway_character::anim::model_from_single_joint(skeleton, skeleton.rest(), head)
        .to_scale_rotation_translation()
        .1;
    let mut state = ViewerState::default();
    apply(&mut state, &library, set(HEAD, pin(PinGoal::Camera)));
    for yaw_radians in [-1.0, 0.3, 1.2] {
        let orbit = OrbitCamera { yaw_radians, pitch_radians: 0.2, distance: 3.0, target: Vec3::Y };
        apply(&mut state, &library, Command::SetCamera(CameraChoice::Orbit(orbit)));
        let frame = frame(&library, &state);
        let turn = frame.characters[0].world_from_joint[head.get()].to_scale_rotation_translation().1;
        let ahead = turn * rest.conjugate() * Vec3::Z;
        let wanted = frame.view.eye - place(&library, &frame, HEAD);
        assert!(ahead.angle_between(wanted).to_degrees() < 0.1, "{ahead} {wanted}");
    }
}

#[test]
fn what_cannot_be_pinned_stays() {
    let library = walker();
    let point = PinGoal::Point(Vec3::Y);
    let nan = PinTimes { start_secs: 0.0, end_secs: f64::NAN, blend_secs: 0.0 };
    for (joint, pin) in [
        (4000, pin(point)),
        (HIPS, pin(point)),
        (LEFT_HAND, pin(PinGoal::Point(Vec3::NAN))),
        (LEFT_HAND, pin(PinGoal::Joint(LEFT_ARM, Vec3::ZERO))),
        (LEFT_HAND, pin(PinGoal::Joint(4000, Vec3::ZERO))),
        (LEFT_HAND, Pin { times: Some(nan), ..pin(point) }),
    ] {
        let mut state = ViewerState::default();
        apply(&mut state, &library, set(joint, pin));
        assert_eq!(state, ViewerState::default(), "{joint}: {pin:?}");
        // A link may have them; they have no effect.
        state.character.edits.pins.insert(joint, pin);
        let mut replaced = ViewerState::default();
        apply(&mut replaced, &library, Command::Replace(Box::new(state)));
        assert_eq!(frame(&library, &replaced).pose(), frame(&library, &ViewerState::default()).pose());
    }
    let times = PinTimes { start_secs: 2.0, end_secs: 1.0, blend_secs: 99.0 };
    let mut state = ViewerState::default();
    apply(&mut state, &library, set(LEFT_HAND, Pin { times: Some(times), ..pin(point) }));
    let clamped = PinTimes { start_secs: 1.0, end_secs: 2.0, blend_secs: PinTimes::MAX_BLEND_SECS };
    assert_eq!(state.character.edits.pins[&LEFT_HAND].times, Some(clamped));
}

#[test]
fn a_drag_of_a_pin_is_one_step() {
    let mut library = walker();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    for x in [0.1, 0.2, 0.3] {
        history.apply(&mut state, &library, set(LEFT_HAND, pin(PinGoal::Point(Vec3::new(x, 1.0, 0.3)))));
    }
    history.end_gesture();
    let dragged = state.character.edits.pins.clone();
    history.apply(&mut state, &library, Command::SetPin { joint: LEFT_HAND, pin: None });
    assert!(state.character.edits.pins.is_empty());
    assert!(undo(&mut history, &mut state, &mut library));
    assert_eq!(state.character.edits.pins, dragged);
    assert!(undo(&mut history, &mut state, &mut library));
    assert!(state.character.edits.pins.is_empty());
    assert!(redo(&mut history, &mut state, &mut library));
    assert_eq!(state.character.edits.pins, dragged);
}

#[test]
fn malformed_pins_are_reported_and_the_rest_is_kept() {
    for bad in [
        "",
        "9",
        "9:",
        "9:at:1,2",
        "9:at:1,2,x",
        "9:at:1,2,3,4",
        "hand:at:1,2,3",
        "9:on:1,2,3",
        "9:look:sky",
        "9:joint:",
        "9:joint:x,1,2,3",
        "9:at:1,2,3@",
        "9:at:1,2,3@1,2",
        "9:at:1,2,3@1,2,NaN",
        "9:at:inf,0,0",
    ] {
        let (state, errors) = from_link(&format!("pin={bad}&pin=5:look:camera"));
        assert_eq!(errors.len(), 1, "{bad}: {errors:?}");
        assert!(errors[0].to_string().contains("look:camera"), "{}", errors[0]);
        assert_eq!(state.character.edits.pins.keys().collect::<Vec<_>>(), [&HEAD]);
    }
    let (state, errors) = from_link("pin=9:joint:4");
    assert_eq!((errors, link_of(&state)), (Vec::new(), "v=2&pin=9:joint:4,0,0,0".to_owned()));
}

pub fn exported(editor: &Editor, what: &Export) -> Library {
    let file = editor.export(what).expect("can be written");
    let mut files = FileSet::default();
    files.insert(&*file.name, file.bytes);
    library_of(Model::new(file.name, load(&files).expect("can be read"), Vec::new()))
}

/// Compares a written clip with what is shown over `secs`.
pub fn check_written(editor: &Editor, written: &Library, secs: f64, (max_metres, max_degrees): (f32, f32)) {
    let skeleton = &editor.library().active().expect("a model").asset.skeleton;
    let model = written.active().expect("a model");
    for step in 0..120 {
        let time_secs = secs * (f64::from(step) + 0.37) / 121.0;
        let at = |state: &ViewerState| {
            let playhead = Playhead { time_secs, ..state.character.playhead.clone() };
            ViewerState { character: CharacterView { playhead, ..state.clone().character }, ..state.clone() }
        };
        let shown = frame(editor.library(), &at(editor.state()));
        let again = frame(written, &at(&ViewerState::default()));
        for joint in skeleton.joints() {
            let found = model.asset.skeleton.find(skeleton.name(joint)).expect("has the name");
            let world = |frame: &Frame, joint: JointIndex| frame.characters[0].world_from_joint[joint.get()];
            let (a, b) = (world(&shown, joint), world(&again, found));
            assert!(a.translation.distance(b.translation) < max_metres, "{} at {time_secs}", skeleton.name(joint));
            let turn = |world: glam::Affine3A| -> Quat { world.to_scale_rotation_translation().1 };
            let off = turn(a).angle_between(turn(b)).to_degrees();
            assert!(off < max_degrees, "{} at {time_secs}: {off}", skeleton.name(joint));
        }
    }
}

/// The exported clip is what is shown; the model's own is still there.
#[test]
fn exports_have_the_pins() {
    let times = Some(PinTimes { start_secs: 0.3, end_secs: 0.6, blend_secs: 0.2 });
    let orbit = OrbitCamera { yaw_radians: 0.7, pitch_radians: 0.1, distance: 3.0, target: Vec3::Y };
    let mut editor = Editor::new(walker(), ViewerState::default());
    for command in [
        Command::SetCamera(CameraChoice::Orbit(orbit)),
        set(LEFT_HAND, Pin { times, ..pin(PinGoal::Point(Vec3::new(0.25, 1.2, 0.3))) }),
        set(RIGHT_HAND, pin(PinGoal::Joint(HIPS, Vec3::new(-0.2, 0.1, 0.1)))),
        set(HEAD, pin(PinGoal::Camera)),
    ] {
        editor.apply(command);
    }
    let format = ClipFormat::Glb;
    for what in [&Export::Clip { clip: ClipId::Own(0), format }, &Export::Model { clip: ClipId::Own(0) }] {
        check_written(&editor, &exported(&editor, what), 1.0, (1.8e-4, 0.1));
    }
}

/// Two walks fit a wave of this speed: a pin of the walk holds in both. Layers and pins are baked one after the other, and each
/// may be off by as much as is allowed.
#[test]
fn exports_repeat_the_pins_of_a_clip_that_a_layer_makes_longer() {
    let times = Some(PinTimes { start_secs: 0.3, end_secs: 0.6, blend_secs: 0.2 });
    let hand = pin(PinGoal::Point(Vec3::new(0.25, 1.2, 0.3)));
    let mut editor = Editor::new(walker(), ViewerState::default());
    let layer = ClipLayer { speed: 1.3125, ..ClipLayer::default() };
    let wave = LayeredClip { clip: ClipId::called("Wave"), layer };
    for command in [
        Command::SetLayers(vec![wave]),
        set(LEFT_HAND, Pin { times, ..hand }),
        set(RIGHT_HAND, pin(PinGoal::Joint(HIPS, Vec3::new(-0.2, 0.1, 0.1)))),
    ] {
        editor.apply(command);
    }
    let written = exported(&editor, &Export::Clip { clip: ClipId::Own(0), format: ClipFormat::Glb });
    let walk_secs = f64::from(editor.library().active().expect("a model").asset.clips[0].duration_secs());
    let secs = f64::from(written.active().expect("a model").asset.clips[0].duration_secs());
    assert!((secs - 2.0 * walk_secs).abs() < 1e-4, "{secs}");
    check_written(&editor, &written, secs, (3.6e-4, 0.1));
    let at = |time_secs: f64| {
        let playhead = Playhead { time_secs, ..Playhead::default() };
        let state =
            ViewerState { character: CharacterView { playhead, ..CharacterView::default() }, ..ViewerState::default() };
        let frame = frame(&written, &state);
        let skeleton = &written.active().expect("a model").asset.skeleton;
        let joint = skeleton.find("LeftHand").expect("a hand");
        Vec3::from(frame.characters[0].world_from_joint[joint.get()].translation)
    };
    for time_secs in [0.45, 0.45 + walk_secs] {
        assert!(at(time_secs).distance(Vec3::new(0.25, 1.2, 0.3)) < 3.6e-4, "{time_secs}");
    }
}

/// The rest pose can be pinned, too, and a link gives the same pose.
#[test]
fn a_link_has_its_pins() {
    let library = walker();
    let mut state = ViewerState::default();
    state.character.playhead.clip = ClipChoice::RestPose;
    apply(&mut state, &library, set(LEFT_HAND, pin(PinGoal::Point(Vec3::new(0.25, 1.2, 0.3)))));
    let (again, errors) = from_link(&link_of(&state));
    assert_eq!(errors, []);
    assert_eq!(frame(&library, &again).pose(), frame(&library, &state).pose());
    assert_ne!(
        frame(&library, &again).pose(),
        frame(
            &library,
            &ViewerState { character: CharacterView { edits: Default::default(), ..state.character }, ..state }
        )
        .pose()
    );
}
