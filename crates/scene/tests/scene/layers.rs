//! Layers over the active clip, as commands set them and as frames, exports and undo have them.

use gaitway_character::anim::{Pose, SampleCursor};
use gaitway_retarget::{BodyPart, ClipLayer, LayerMask, LayerMode};
use gaitway_scene::editor::{ClipFormat, Event, Export};
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::library::{ClipId, LayeredClip, Library};
use gaitway_scene::state::{Command, History, ViewerState, apply, from_object};
use serde_json::json;

use crate::allocation::allocations_while_playing;
use crate::data::{sampled, walker};
use crate::editor::editor;
use crate::history::undo;
use crate::texts::with_keys;

const WALK: ClipId = ClipId::Own(0);
const WAVE: ClipId = ClipId::Own(2);

fn wave() -> ClipLayer {
    ClipLayer::default()
}

/// Layers of the wave.
fn waves(layers: Vec<ClipLayer>) -> Vec<LayeredClip> {
    layers.into_iter().map(|layer| LayeredClip { clip: WAVE, layer }).collect()
}

/// A clip that the walker lacks.
fn fly() -> LayeredClip {
    LayeredClip { clip: ClipId::called("Fly"), layer: ClipLayer::default() }
}

fn right_arm(layer: ClipLayer) -> ClipLayer {
    ClipLayer { mask: LayerMask::of_parts(&[BodyPart::RightArm]), ..layer }
}

fn state_with(library: &Library, layers: Vec<LayeredClip>, time_secs: f64) -> ViewerState {
    let mut state = ViewerState::default();
    apply(&mut state, library, Command::SetPlaying(false));
    apply(&mut state, library, Command::Seek(time_secs));
    apply(&mut state, library, Command::SetLayers(layers));
    state
}

fn shown(library: &Library, state: &ViewerState) -> Pose {
    let mut frame = Frame::default();
    evaluate(library, state, 1.5, &mut frame);
    frame.pose().clone()
}

fn of_clip(library: &Library, clip: ClipId, time_secs: f64) -> Pose {
    let model = library.active().expect("a model");
    let skeleton = &model.asset.skeleton;
    let mut pose = skeleton.rest().clone();
    let clip = model.clip(&clip).expect("a clip").clip();
    clip.sample(skeleton, time_secs as f32, &mut SampleCursor::default(), &mut pose);
    pose
}

#[test]
fn weights_0_and_1_are_exact() {
    let library = walker();
    for time_secs in [0.0, 0.3, 0.77] {
        let with = |layer: ClipLayer| shown(&library, &state_with(&library, waves(vec![layer]), time_secs));
        let walk = of_clip(&library, WALK, time_secs);
        assert_eq!(with(ClipLayer { weight: 0.0, ..wave() }), walk);
        assert_eq!(with(wave()), of_clip(&library, WAVE, time_secs));
        assert_ne!(with(ClipLayer { weight: 0.5, ..wave() }), walk);
        // What a clip adds to itself at its reference is nothing.
        let still = ClipLayer { mode: LayerMode::Additive, speed: 0.0, ..wave() };
        assert_eq!(with(still), walk);
    }
}

#[test]
fn legs_walk_while_the_arm_waves() {
    let library = walker();
    let model = library.active().expect("a model");
    let pose = shown(&library, &state_with(&library, waves(vec![right_arm(wave())]), 0.6));
    let (walk, wave) = (of_clip(&library, WALK, 0.6), of_clip(&library, WAVE, 0.6));
    let included = LayerMask::of_parts(&[BodyPart::RightArm]).included(&model.body());
    assert!(included.iter().filter(|&&included| included).count() >= 3);
    for (joint, included) in model.asset.skeleton.joints().zip(included) {
        let expected = if included { &wave } else { &walk };
        assert_eq!(pose.local(joint), expected.local(joint), "{}", model.asset.skeleton.name(joint));
    }
}

/// The wave goes on where the walk starts over.
#[test]
fn a_layer_outlasts_the_loops_of_the_clip() {
    let library = walker();
    let mut state = state_with(&library, waves(vec![right_arm(wave())]), 0.0);
    apply(&mut state, &library, Command::SetPlaying(true));
    for _ in 0..90 {
        apply(&mut state, &library, Command::Advance(1.0 / 45.0));
    }
    assert!((state.character.playhead.time_secs - 2.0).abs() < 1e-4, "{}", state.character.playhead.time_secs);
    let model = library.active().expect("a model");
    let arm = LayerMask::of_parts(&[BodyPart::RightArm]).included(&model.body());
    let joint = model.asset.skeleton.joints().find(|joint| arm[joint.get()]).expect("an arm");
    let (found, expected) = (shown(&library, &state), of_clip(&library, WAVE, state.character.playhead.time_secs));
    assert_eq!(found.local(joint), expected.local(joint));
}

#[test]
fn numbers_are_clamped_and_unknown_clips_skipped() {
    let library = walker();
    let wild = ClipLayer { weight: 7.0, speed: f64::NAN, start_secs: -1e9, ..wave() };
    let state = state_with(&library, waves(vec![wild]), 0.0);
    let expected = ClipLayer { start_secs: -ClipLayer::MAX_START_SECS, ..wave() };
    assert_eq!(state.character.edits.layers, waves(vec![expected]));
    let mut replaced = ViewerState::default();
    let wild = ClipLayer { weight: f64::INFINITY, ..wave() };
    let mut whole = ViewerState::default();
    whole.character.edits.layers = waves(vec![wild]);
    apply(&mut replaced, &library, Command::Replace(Box::new(whole)));
    assert_eq!(replaced.character.edits.layers, waves(vec![wave()]));
    let waves = waves(vec![right_arm(wave())]);
    let state = state_with(&library, [vec![fly()], waves.clone()].concat(), 0.4);
    let without = state_with(&library, waves, 0.4);
    assert_eq!(shown(&library, &state), shown(&library, &without));
    let (_, errors) = with_keys(&ViewerState::default(), &json!({ "layers": ["Wave:weight:NaN", "Wave:mask:wing"] }));
    let told: Vec<String> = errors.iter().map(ToString::to_string).collect();
    assert!(told.len() == 2 && told[0].starts_with("layers=Wave:weight:NaN: expected a clip"), "{told:?}");
    assert!(told[1].contains("left-arm"), "{told:?}");
}

#[test]
fn layers_are_undone() {
    let mut library = walker();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    for weight in [0.2, 0.6] {
        let layers = waves(vec![ClipLayer { weight, ..wave() }]);
        history.apply(&mut state, &library, Command::SetLayers(layers));
    }
    assert_eq!(state.character.edits.layers.len(), 1);
    assert!(undo(&mut history, &mut state, &mut library), "a drag of a slider is one step");
    assert!(state.character.edits.layers.is_empty());
}

#[test]
fn playing_layers_does_not_allocate() {
    let library = walker();
    let sum = ClipLayer { mode: LayerMode::Additive, weight: 0.5, ..wave() };
    let mut state = ViewerState::default();
    state.character.edits.layers = waves(vec![right_arm(wave()), sum]);
    state.camera_options.follow = true;
    assert_eq!(allocations_while_playing(&library, state, 200, 200), 0);
}

/// Manually posed joints stay what they were set to.
#[test]
fn manual_poses_are_above_layers() {
    let library = walker();
    let mut state = state_with(&library, waves(vec![wave()]), 0.5);
    apply(&mut state, &library, Command::SetPose { joint: 5, degrees: Some([10.0, 20.0, 30.0]) });
    let skeleton = &library.active().expect("a model").asset.skeleton;
    let joint = skeleton.joint_of_source(5).expect("a head");
    let posed = shown(&library, &state).local(joint);
    state.character.edits.layers.clear();
    assert_eq!(posed.rotation, shown(&library, &state).local(joint).rotation);
}

#[test]
fn an_unknown_layer_of_a_view_is_told() {
    let mut editor = editor("sample:walker");
    let mut view = editor.state().clone();
    view.character.edits.layers = vec![fly()];
    editor.apply(Command::Replace(Box::new(view)));
    let told = "layers: expected the name or index of a clip, found “Fly”; its clips are “Walk”, “Idle”, “Wave”; the layer is left out.";
    let events = editor.take_events();
    assert!(events.iter().any(|event| matches!(event, Event::AboutView(text) if text == told)), "{events:?}");
}

#[test]
fn unknown_names_of_a_view_are_told_together() {
    let mut editor = editor("sample:walker");
    let (view, errors) = from_object(editor.state(), editor.library(), &json!({ "clip": "Swim", "layers": ["Fly"] }));
    assert!(errors.is_empty(), "{errors:?}");
    editor.apply(Command::Replace(Box::new(view)));
    let events = editor.take_events();
    let told =
        |event: &Event| matches!(event, Event::AboutView(text) if text.contains("“Swim”") && text.contains("“Fly”"));
    assert!(events.iter().any(told), "{events:?}");
}

/// The exported clip is read again and plays what the page showed.
#[test]
fn the_exported_clip_has_the_layers() {
    let mut editor = editor("sample:walker");
    let one_clip = Export::Model { clip: WALK };
    assert!(editor.export(&one_clip).is_err(), "it is in the file as it is");
    editor.apply(Command::SetPlaying(false));
    editor.apply(Command::SetLayers(waves(vec![right_arm(ClipLayer { speed: 2.625, ..wave() })])));
    let file = editor.export(&Export::Clip { clip: WALK, format: ClipFormat::Glb }).expect("has keys");
    assert_eq!(file.remark, None, "the wave fits the walk");
    let model = editor.export(&one_clip).expect("has layers");
    let mut files = gaitway_formats::FileSet::default();
    files.insert("walk.glb", file.bytes);
    let baked = gaitway_formats::load(&files).expect("a good file");
    for step in 0..20 {
        let time_secs = 1.0667 * f64::from(step) / 20.0;
        editor.apply(Command::Seek(time_secs));
        let shown = sampled(editor.library().active().expect("a model"), editor.state()).pose;
        let mut pose = baked.skeleton.rest().clone();
        baked.clips[0].sample(&baked.skeleton, time_secs as f32, &mut SampleCursor::default(), &mut pose);
        for (found, expected) in pose.locals().zip(shown.locals()) {
            let turn = (found.rotation * expected.rotation.conjugate()).xyz().length();
            assert!(2.0 * turn.asin().to_degrees() < 0.05, "{found:?} {expected:?}");
            assert!(found.translation.abs_diff_eq(expected.translation, 2e-4), "{found:?} {expected:?}");
        }
    }
    let mut files = gaitway_formats::FileSet::default();
    files.insert("model.glb", model.bytes);
    let names: Vec<String> =
        gaitway_formats::load(&files).expect("a good file").clips.iter().map(|clip| clip.name().to_owned()).collect();
    assert!(names.contains(&"Walk (changed)".to_owned()), "{names:?}");
    // A wave at its own speed ends in the middle of a walk.
    editor.apply(Command::SetLayers(waves(vec![right_arm(wave())])));
    let file = editor.export(&Export::Clip { clip: WALK, format: ClipFormat::Glb }).expect("has keys");
    assert!(file.remark.is_some_and(|remark| remark.contains("seam")));
}
