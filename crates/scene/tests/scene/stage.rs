//! The side-by-side comparison of skinning methods, and the source of a retargeted clip beside the model.

use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, Joint, JointIndex, Keys, Skeleton, Transform};
use gaitway_character::asset::{Asset, AssetParts};
use gaitway_character::mesh::SkinningMode;
use gaitway_retarget::{JointMap, RestChoice, RestChoices};
use gaitway_scene::frame::{Frame, PickedJoint, evaluate, pick_joint, pose_document};
use gaitway_scene::library::{Library, Model, Motion, map_for};
use gaitway_scene::state::{
    CharacterView, ClipChoice, Comparison, Display, Inspect, Playhead, Selection, Show, ViewerState, compared_rests,
    resolved_bounds, source_on_stage,
};
use glam::{Quat, Vec2, Vec3};

use crate::by_place::ByPlace;
use crate::data::walker;
use crate::skeletons;

fn frame_of(library: &Library, state: &ViewerState, aspect: f32) -> Frame {
    let mut frame = Frame::default();
    evaluate(library, state, aspect, &mut frame);
    frame
}

/// The walker with a clip retargeted from a copy of itself of twice the size.
fn walker_with_larger_source() -> (Library, ViewerState) {
    let mut library = walker();
    let asset = library.active().expect("a model").asset.clone();
    library.set_motions(vec![Motion::new("twice.glb".to_owned(), Arc::new(doubled(&asset)))]);
    library.borrow_each(vec![None]);
    assert_eq!(library.borrow_errors(), []);
    let model = library.active().expect("a model");
    let clip = ClipChoice::Clip(model.id_at(model.asset.clips.len()));
    (
        library,
        ViewerState {
            character: CharacterView {
                playhead: Playhead { clip, time_secs: 0.3, ..Playhead::default() },
                ..CharacterView::default()
            },
            ..ViewerState::default()
        },
    )
}

/// Doubles all lengths of a skeleton, and the translations of its first clip.
fn doubled(asset: &Asset) -> Asset {
    let skeleton = &asset.skeleton;
    let joints = skeleton.joints().map(|joint| {
        let rest = skeleton.rest().local(joint);
        Joint {
            name: skeleton.name(joint).to_owned(),
            parent: skeleton.parent(joint).map(|parent| parent.get()),
            rest: Transform { translation: 2.0 * rest.translation, ..rest },
            morph_weights: Vec::new(),
        }
    });
    let doubled = Skeleton::new(joints.collect()).expect("the same joints");
    let clip: &Clip = &asset.clips[0];
    let mut builder = ClipBuilder::new(clip.name(), &doubled);
    for channel in clip.channels() {
        let times = &clip.timelines()[channel.timeline as usize];
        let keys = match &channel.keys {
            Keys::Translation(values) => Keys::Translation(values.iter().map(|value| 2.0 * *value).collect()),
            Keys::MorphWeights { .. } => continue,
            keys => keys.clone(),
        };
        builder.channel(channel.joint, channel.interpolation, times, keys).expect("a channel of that joint");
    }
    let clips = vec![builder.build()];
    Asset::new(AssetParts { skeleton: doubled, clips, ..AssetParts::default() }).expect("indices in range")
}

fn showing(base: &ViewerState, change: impl Fn(&mut Show)) -> ViewerState {
    let mut state = base.clone();
    change(&mut state.display.show);
    state
}

#[test]
fn compared_methods_have_one_pane_each_and_the_same_pose() {
    let library = walker();
    let inspect = Inspect { split: true, ..Inspect::default() };
    let playhead = Playhead { time_secs: 0.3, ..Playhead::default() };
    let state = ViewerState {
        character: CharacterView { playhead, ..CharacterView::default() },
        inspect,
        ..ViewerState::default()
    };
    let frame = frame_of(&library, &state, 1.5);
    let modes: Vec<_> = frame.characters.iter().map(|character| (character.pane, character.skinning)).collect();
    let expected = [SkinningMode::Linear, SkinningMode::Rigid, SkinningMode::DualQuaternion];
    assert_eq!(modes, (0..3).map(Some).zip(expected).collect::<Vec<_>>());
    assert_eq!(frame.panes, [3, 1]);
    assert_eq!(frame_of(&library, &state, 0.5).panes, [1, 3]);
    for mode in expected {
        let display = Display { skinning: mode, ..state.display };
        let alone = frame_of(&library, &ViewerState { display, inspect: Inspect::default(), ..state.clone() }, 0.5);
        let compared = frame.characters.iter().find(|character| character.skinning == mode).expect("a pane");
        assert_eq!(compared.palette, alone.characters[0].palette);
        // A pane is as high as a viewport of its own shape.
        assert_eq!(frame.view.projection_from_view, alone.view.projection_from_view);
    }
}

#[test]
fn compared_rests_have_one_pane_each_with_the_clip_that_the_map_gives_with_that_rest() {
    let (mut library, state) = walker_with_larger_source();
    let state = ViewerState { inspect: Inspect { rests: true, ..Inspect::default() }, ..state };
    let map = {
        let (model, motion) = (library.active().expect("a model"), &library.motions()[0]);
        map_for(model, motion, None).0
    };
    for chosen in RestChoice::ALL {
        let borrow = |library: &mut Library, rest| {
            let rest = RestChoices { motion: rest, ..map.rest };
            library.borrow_each(vec![Some(JointMap { rest, ..map.clone() })]);
            frame_of(library, &state, 1.5)
        };
        let compared = borrow(&mut library, chosen);
        assert_eq!((compared.panes, compared.comparison), ([2, 2], Some(Comparison::Rests(chosen))));
        for (pane, rest) in compared_rests(chosen).into_iter().enumerate() {
            let alone = borrow(&mut library, rest);
            assert_eq!(compared.characters[pane].pane, Some(pane as u32));
            assert_eq!(compared.characters[pane].palette, alone.characters[0].palette, "{rest:?}");
        }
        let mut poses: Vec<_> =
            compared.characters.iter().map(|character| format!("{:?}", character.palette)).collect();
        poses.sort();
        poses.dedup();
        assert!(poses.len() > 1, "the rests differ");
    }
    let own_clip = Playhead { clip: ClipChoice::First, ..state.character.playhead.clone() };
    assert_eq!(
        frame_of(
            &library,
            &ViewerState { character: CharacterView { playhead: own_clip, ..state.character }, ..state },
            1.5
        )
        .comparison,
        None
    );
}

#[test]
fn the_pose_document_has_only_the_selected_method() {
    let library = walker();
    let plain = ViewerState {
        character: CharacterView {
            playhead: Playhead { time_secs: 0.3, ..Playhead::default() },
            ..CharacterView::default()
        },
        display: Display { skinning: SkinningMode::Rigid, ..Display::default() },
        ..ViewerState::default()
    };
    let compared = ViewerState { inspect: Inspect { split: true, ..plain.inspect }, ..plain.clone() };
    assert_eq!(pose_document(&library, &compared), pose_document(&library, &plain));
}

#[test]
fn the_source_is_beside_the_model_at_its_size_in_the_same_pose() {
    let (library, state) = walker_with_larger_source();
    let model = library.active().expect("a model");
    let state = showing(&state, |show| show.source = true);
    let frame = frame_of(&library, &state, 1.5);
    let [own, source] = &frame.characters[..] else { panic!("{} characters", frame.characters.len()) };
    let apart = source.world_from_joint[0].translation - own.world_from_joint[0].translation;
    assert!(apart.x < -0.5 && apart.y.abs() < 1e-3 && apart.z.abs() < 1e-3, "{apart}");
    for joint in model.asset.skeleton.joints().filter(|&joint| model.rig().is_real(joint)) {
        let (a, b) = (own.world_from_joint[joint.get()].translation, source.world_from_joint[joint.get()].translation);
        assert!((b - a - apart).length() < 1e-3, "{}: {a} {b}", model.asset.skeleton.name(joint));
    }
    // The camera sees both.
    let alone = showing(&state, |show| show.source = false);
    assert!(resolved_bounds(&library, &state).size().x > resolved_bounds(&library, &alone).size().x + 0.5);
}

#[test]
fn over_overlays_the_source() {
    let (library, state) = walker_with_larger_source();
    let frame = frame_of(&library, &showing(&state, |show| (show.source, show.over) = (true, true)), 1.5);
    let roots = [0, 1].map(|character: usize| frame.characters[character].world_from_joint[0].translation);
    assert!((roots[0] - roots[1]).length() < 1e-3, "{roots:?}");
}

#[test]
fn the_models_own_clips_have_no_source() {
    let (library, state) = walker_with_larger_source();
    let own = showing(
        &ViewerState {
            character: CharacterView {
                playhead: Playhead { clip: ClipChoice::First, ..state.character.playhead },
                ..state.character
            },
            ..state
        },
        |show| show.source = true,
    );
    assert!(source_on_stage(&library, &own).is_none());
    assert_eq!(frame_of(&library, &own, 1.5).characters.len(), 1);
}

#[test]
fn the_selected_joint_and_its_counterpart_are_highlighted_and_pickable() {
    let (library, state) = walker_with_larger_source();
    let chosen = 15;
    let state = ViewerState {
        selection: Selection { joint: Some(chosen), ..showing(&state, |show| show.source = true).selection },
        ..showing(&state, |show| show.source = true)
    };
    let frame = frame_of(&library, &state, 1.5);
    let plain = |of_source| {
        frame.bones.iter().find(|bone| bone.of_source == of_source && bone.joint != 15).map(|bone| bone.color)
    };
    assert_ne!(plain(false), plain(true), "the two sides look different");
    let lit: Vec<_> = frame.bones.iter().filter(|bone| bone.joint == 15).collect();
    assert_eq!((lit.len(), lit[0].color), (2, lit[1].color));
    assert_ne!(Some(lit[0].color), plain(false));
    let projection_from_world = frame.view.projection_from_view * frame.view.view_from_world;
    let project = |place: Vec3| {
        let middle = projection_from_world * place.extend(1.0);
        Vec2::new(middle.x, middle.y) / middle.w
    };
    for bone in lit {
        let picked = pick_joint(&frame, project(bone.head.midpoint(bone.tail)), 0.02);
        let expected = if bone.of_source { PickedJoint::Source(chosen) } else { PickedJoint::Model(chosen) };
        assert_eq!(picked, Some(expected));
    }
}

#[test]
fn bones_are_coloured_by_rotation_error() {
    let (library, state) = walker_with_larger_source();
    let state = showing(&state, |show| (show.source, show.error) = (true, true));
    let color = |state: &ViewerState| {
        let frame = frame_of(&library, state, 1.5);
        let bone = frame.bones.iter().find(|bone| bone.joint == 15 && !bone.of_source).expect("a shin");
        (bone.color.x, bone.color.y)
    };
    let (red, green) = color(&state);
    assert!(green > 3.0 * red, "a faithful copy is green: {red} {green}");
    let mut wrong = state.clone();
    wrong.character.edits.pose.insert(15, [120.0, 0.0, 0.0]);
    let (red, green) = color(&wrong);
    assert!(red > 3.0 * green, "{red} {green}");
}

#[test]
fn the_source_plays_along() {
    let (library, state) = walker_with_larger_source();
    let state = showing(&state, |show| show.source = true);
    let early = frame_of(&library, &state, 1.5);
    let late = frame_of(
        &library,
        &ViewerState {
            character: CharacterView {
                playhead: Playhead { time_secs: 0.6, ..state.character.playhead },
                ..state.character
            },
            ..state
        },
        1.5,
    );
    assert_ne!(early.characters[1].world_from_joint, late.characters[1].world_from_joint);
}

/// A chain that lies along Z at rest and along X in its clip, borrowed from itself.
fn long_model() -> (Library, ViewerState) {
    let joints = skeletons::chain(["Tail1", "Tail2", "Tail3", "Tail4"], Vec3::Z);
    let skeleton = Skeleton::new(joints).expect("a tree");
    let mut clip = ClipBuilder::new("turn", &skeleton);
    let keys = Keys::Rotation(vec![Quat::IDENTITY, Quat::from_rotation_y(FRAC_PI_2)]);
    clip.channel(JointIndex(0), Interpolation::Linear, &[0.0, 1.0], keys).expect("two keys");
    let clips = vec![clip.build()];
    let asset = Arc::new(Asset::new(AssetParts { skeleton, clips, ..AssetParts::default() }).expect("in range"));
    let mut library = Library::default();
    library.add(Model::new("snake.glb".to_owned(), asset.clone(), Vec::new()));
    library.set_motions(vec![Motion::new("turn.glb".to_owned(), asset)]);
    library.borrow_each(vec![None]);
    assert_eq!(library.borrow_errors(), []);
    let clip = ClipChoice::Clip(library.active().expect("a model").id_at(1));
    let playhead = Playhead { clip, time_secs: 1.0, ..Playhead::default() };
    (
        library,
        ViewerState { character: CharacterView { playhead, ..CharacterView::default() }, ..ViewerState::default() },
    )
}

#[test]
fn a_long_model_has_its_source_clear_of_itself() {
    let (library, state) = long_model();
    let frame = frame_of(&library, &showing(&state, |show| show.source = true), 1.5);
    let ends = |character: usize| {
        let joints = frame.characters[character].world_from_joint.iter().map(|world| world.translation.x);
        joints.fold((f32::INFINITY, f32::NEG_INFINITY), |(min, max), x| (min.min(x), max.max(x)))
    };
    let ((from, to), (_, source_to)) = (ends(0), ends(1));
    assert!(to - from > 2.9, "it lies across: {from} {to}");
    assert!(source_to < from, "the source ends at {source_to}, the model begins at {from}");
}

/// Documented: `show=source` shows the source, `skeleton` the skeletons.
#[test]
fn the_source_draws_no_skeleton_that_was_not_asked_for() {
    let (library, state) = walker_with_larger_source();
    let drawn = |change: fn(&mut Show)| {
        let frame = frame_of(&library, &showing(&state, change), 1.5);
        let of = |of_source| frame.bones.iter().any(|bone| bone.of_source == of_source && bone.visible);
        [of(false), of(true)]
    };
    // The source has no mesh: only its skeleton can be shown.
    assert_eq!(drawn(|show| show.source = true), [false, true]);
    assert_eq!(drawn(|show| (show.source, show.skeleton) = (true, true)), [true, true]);
    assert_eq!(drawn(|show| (show.source, show.error) = (true, true)), [true, true], "errors are colours of bones");
    assert_eq!(drawn(|show| show.error = true), [false, false]);
}
