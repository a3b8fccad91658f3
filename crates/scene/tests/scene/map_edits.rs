//! Edits of the joint map: their effect, their undo, and that links hold them completely.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use gaitway_character::anim::Transform;
use gaitway_character::asset::Asset;
use gaitway_retarget::{
    Chains, ClipRef, Contacts, Feet, JointMap, Keep, MapEntry, MutedChannel, MutedProperty, RestChoice, RestChoices,
    RootOptions, RootPart, Unmapped, UpChoice,
};
use gaitway_scene::editor::reconciled_maps;
use gaitway_scene::frame::pose_document;
use gaitway_scene::library::{Library, Model, Motion};
use gaitway_scene::state::{
    CharacterView, ClipChoice, Command, History, MapEdit, MotionMap, NumberedMap, Playback, Playhead, RetargetEdits,
    ViewerState, active_map, active_maps, apply, from_link, muted_properties,
};
use glam::{Quat, Vec3};

use crate::by_place::{motion_at, motion_called};
use crate::data::walker;
use crate::history::{redo, undo};
use crate::skeletons;
use crate::texts::link_of;

/// The walker with its own clips retargeted to itself, shortly after the start of the first of them.
fn walker_with_motion() -> (Library, ViewerState) {
    let mut library = walker();
    let asset = library.active().expect("a model").asset.clone();
    library.set_motions(vec![Motion::new("dance.glb".to_owned(), asset)]);
    let clip = ClipChoice::called("3");
    let mut state = ViewerState {
        character: CharacterView {
            playhead: Playhead { time_secs: 0.3, clip, ..Playhead::default() },
            ..CharacterView::default()
        },
        playback: Playback { playing: false, ..Playback::default() },
        ..ViewerState::default()
    };
    reconcile(&mut library, &mut state);
    (library, state)
}

fn reconcile(library: &mut Library, state: &mut ViewerState) {
    let (maps, _) = reconciled_maps(library, state);
    apply(state, library, Command::ReconcileMaps(maps));
    library.borrow_each(active_maps(library, state));
}

fn number(library: &Library, name: &str) -> usize {
    let skeleton = &library.active().expect("a model").asset.skeleton;
    skeleton.source_index(skeleton.find(name).expect("a joint of the walker"))
}

fn map(library: &Library, state: &ViewerState) -> JointMap {
    active_map(library, state, &motion_at(library, 0)).expect("a map")
}

fn source(map: &JointMap, target: usize) -> Option<usize> {
    map.source_of(target).flatten()
}

fn edited(library: &Library, state: &ViewerState, edit: MapEdit) -> ViewerState {
    let mut state = state.clone();
    apply(&mut state, library, Command::EditMap { motion: motion_at(library, 0), edit });
    state
}

fn turn() -> Quat {
    Quat::from_rotation_z(0.6)
}

/// One edit of each kind.
fn all_edits(library: &Library) -> Vec<MapEdit> {
    let [neck, head, hips] = ["Neck", "Head", "Hips"].map(|name| number(library, name));
    let frozen = Unmapped::Clip { clip: ClipRef::Index(1), frozen: true };
    let loaded = JointMap {
        joints: BTreeMap::from([(hips, MapEntry::following(Some(hips)))]),
        feet: Feet::Plant,
        ..JointMap::default()
    };
    vec![
        MapEdit::SwapSides,
        MapEdit::Correction { target: neck, correction: turn() },
        MapEdit::Mute { source: head, property: MutedProperty::Rotation, muted: true },
        MapEdit::Unmapped { target: head, unmapped: Some(frozen) },
        MapEdit::Rest(RestChoices { model: RestChoice::Bind, motion: RestChoice::FirstFrame, up: UpChoice::Z }),
        MapEdit::Translations(Keep::Drop),
        MapEdit::Scales(Keep::Keep),
        MapEdit::CrossfadeSecs(0.4),
        MapEdit::UnmuteAll,
        MapEdit::Clear,
        MapEdit::Load(Box::new(loaded)),
    ]
}

#[test]
fn sides_are_swapped_and_swapped_back() {
    let (library, state) = walker_with_motion();
    let swapped = edited(&library, &state, MapEdit::SwapSides);
    let now = map(&library, &swapped);
    for (target, expected) in
        [("LeftUpperArm", "RightUpperArm"), ("RightFoot", "LeftFoot"), ("Neck", "Neck"), ("Hips", "Hips")]
    {
        let expected = Some(number(&library, expected));
        assert_eq!(source(&now, number(&library, target)), expected, "{target}");
    }
    assert_eq!(edited(&library, &swapped, MapEdit::SwapSides), state);
}

/// All joints are children of the first.
fn animal(names: &[&str]) -> Arc<Asset> {
    let joint = |(index, name): (usize, &&str)| {
        let rest = Transform::from_translation(Vec3::new(index as f32, 1.0, 0.0));
        skeletons::joint(name, (index > 0).then_some(0), rest)
    };
    Arc::new(skeletons::asset(names.iter().enumerate().map(joint).collect()))
}

/// Checks the pairs of target and source after swapping sides; all are indices in the file.
fn check_swapped(model: &[&str], motion: &[&str], pairs: &[(usize, usize)], expected: &[(usize, usize)]) {
    let mut library = Library::default();
    library.add(Model::new("beast.glb".to_owned(), animal(model), Vec::new()));
    library.set_motions(vec![Motion::new("run.bvh".to_owned(), animal(motion))]);
    let mut state = ViewerState::default();
    apply(&mut state, &library, Command::EditMap { motion: motion_at(&library, 0), edit: MapEdit::Clear });
    for &(target, source) in pairs {
        apply(
            &mut state,
            &library,
            Command::SetSource { motion: motion_at(&library, 0), target, source: Some(source) },
        );
    }
    let swapped = edited(&library, &state, MapEdit::SwapSides);
    let map = map(&library, &swapped);
    let now: Vec<(usize, usize)> =
        (0..model.len()).filter_map(|target| Some((target, source(&map, target)?))).collect();
    assert_eq!(now, expected, "{model:?} {motion:?}");
}

/// Bodies that aren't humanoid have sides too, if names differ only in left and right.
#[test]
fn sides_of_animals_are_recognized_by_name() {
    let wings = ["trunk", "wing_l", "wing_r", "tail"];
    check_swapped(&wings, &wings, &[(0, 0), (1, 1), (2, 2), (3, 3)], &[(0, 0), (1, 2), (2, 1), (3, 3)]);
    // The motion's names have no sides: the model's joints swap their sources.
    let numbered = ["a", "b", "c", "d"];
    check_swapped(&wings, &numbered, &[(0, 0), (1, 1), (2, 3)], &[(0, 0), (1, 3), (2, 1)]);
    check_swapped(&wings, &numbered, &[(0, 0), (1, 1)], &[(0, 0), (2, 1)]);
    check_swapped(&numbered, &numbered, &[(0, 0), (1, 2)], &[(0, 0), (1, 2)]);
}

#[test]
fn a_rotation_offset_turns_the_playing_joint() {
    let (mut library, mut state) = walker_with_motion();
    let before = pose_document(&library, &state);
    let neck = number(&library, "Neck");
    apply(
        &mut state,
        &library,
        Command::EditMap {
            motion: motion_at(&library, 0),
            edit: MapEdit::Correction { target: neck, correction: turn() * 3.0 },
        },
    );
    let correction = map(&library, &state).joints[&neck].correction;
    assert!(correction.abs_diff_eq(turn(), 1e-6), "it is normalized: {correction}");
    reconcile(&mut library, &mut state);
    assert_ne!(pose_document(&library, &state), before);
    for bad in [Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)] {
        assert_eq!(edited(&library, &state, MapEdit::Correction { target: neck, correction: bad }), state);
    }
}

#[test]
fn channels_are_muted_one_by_one() {
    let (mut library, state) = walker_with_motion();
    let arm = number(&library, "LeftUpperArm");
    let mute =
        |state: &ViewerState, property, muted| edited(&library, state, MapEdit::Mute { source: arm, property, muted });
    let rotation = mute(&state, MutedProperty::Rotation, true);
    assert_eq!(muted_properties(&map(&library, &rotation), arm), [false, true, false]);
    let two = mute(&rotation, MutedProperty::Scale, true);
    assert_eq!(muted_properties(&map(&library, &two), arm), [false, true, true]);
    let all = mute(&two, MutedProperty::Translation, true);
    let whole = MutedChannel { source: arm, property: None };
    assert_eq!(map(&library, &all).muted_channels, [whole]);
    // Unmuting one channel of an entirely muted joint leaves the others muted.
    let back = mute(&all, MutedProperty::Rotation, false);
    assert_eq!(muted_properties(&map(&library, &back), arm), [true, false, true]);
    assert_eq!(edited(&library, &back, MapEdit::UnmuteAll), state);

    let before = pose_document(&library, &state);
    let mut rotation = rotation;
    reconcile(&mut library, &mut rotation);
    assert_ne!(pose_document(&library, &rotation), before, "the arm is still");
}

#[test]
fn a_cleared_map_stays_empty_until_edited() {
    let (mut library, state) = walker_with_motion();
    let mut cleared = edited(&library, &state, MapEdit::Clear);
    assert_eq!(map(&library, &cleared).joints.len(), 0);
    reconcile(&mut library, &mut cleared);
    assert_eq!(map(&library, &cleared).joints.len(), 0, "no map is proposed again");
    let hips = number(&library, "Hips");
    apply(
        &mut cleared,
        &library,
        Command::SetSource { motion: motion_at(&library, 0), target: hips, source: Some(hips) },
    );
    reconcile(&mut library, &mut cleared);
    assert_eq!(library.borrow_errors(), []);
    let mut again = cleared.clone();
    apply(&mut again, &library, Command::SetMap { motion: motion_at(&library, 0), map: None });
    assert_eq!(again.character.retarget.map, state.character.retarget.map);
}

#[test]
fn every_member_of_a_loaded_map_is_applied() {
    let (library, mut state) = walker_with_motion();
    apply(&mut state, &library, Command::SetFeet(Some(Feet::Off)));
    apply(&mut state, &library, Command::SetContacts(Some(Contacts::Off)));
    apply(&mut state, &library, Command::SetRoot(Some(RootOptions { yaw: RootPart::Freeze, ..Default::default() })));
    let new = JointMap { feet: Feet::Plant, contacts: Contacts::Keep, ..map(&library, &state) };
    let state = edited(&library, &state, MapEdit::Load(Box::new(new.clone())));
    assert_eq!(map(&library, &state), new);
    assert_eq!(
        (state.character.retarget.root, state.character.retarget.feet, state.character.retarget.contacts),
        (None, None, None)
    );
}

#[test]
fn edits_of_missing_joints_change_nothing() {
    let (library, state) = walker_with_motion();
    let nothing = [
        MapEdit::Correction { target: 9999, correction: turn() },
        MapEdit::Unmapped { target: 9999, unmapped: Some(Unmapped::Rest) },
        MapEdit::Mute { source: 9999, property: MutedProperty::Scale, muted: true },
        MapEdit::CrossfadeSecs(f64::NAN),
    ];
    for edit in nothing {
        assert_eq!(edited(&library, &state, edit.clone()), state, "{edit:?}");
    }
    assert_eq!(map(&library, &edited(&library, &state, MapEdit::CrossfadeSecs(-1.0))).crossfade_secs, 0.0);
    let mut other = state.clone();
    apply(&mut other, &library, Command::EditMap { motion: motion_called("another.glb"), edit: MapEdit::Clear });
    assert_eq!(other, state);
}

/// Retargets the clips after each step, as the editor does.
#[test]
fn fifty_edits_are_undone_and_redone() {
    let (mut library, mut state) = walker_with_motion();
    let mut history = History::default();
    let edits = all_edits(&library);
    let first = state.clone();
    let mut seen = vec![state.clone()];
    let targets: Vec<usize> =
        library.active().expect("a model").asset.skeleton.joints().map(|joint| joint.get()).collect();
    let mut at = 0;
    while seen.len() <= 50 {
        let command = match at % 3 {
            0 => Command::EditMap { motion: motion_at(&library, 0), edit: edits[at / 3 % edits.len()].clone() },
            1 => Command::SetSource {
                motion: motion_at(&library, 0),
                target: targets[at % 15],
                source: Some(targets[(7 * at) % 15]),
            },
            _ => Command::SetMap { motion: motion_at(&library, 0), map: None },
        };
        history.apply(&mut state, &library, command);
        history.end_gesture();
        reconcile(&mut library, &mut state);
        if state != seen[seen.len() - 1] {
            seen.push(state.clone());
        }
        at += 1;
        assert!(at < 200, "edits that change something");
    }
    let last = pose_document(&library, &state);
    for expected in seen.iter().rev().skip(1) {
        assert!(undo(&mut history, &mut state, &mut library));
        reconcile(&mut library, &mut state);
        assert_eq!(&state, expected);
    }
    assert_eq!(state, first);
    assert!(!history.can_undo());
    for expected in &seen[1..] {
        assert!(redo(&mut history, &mut state, &mut library));
        reconcile(&mut library, &mut state);
        assert_eq!(&state, expected);
    }
    assert!(!history.can_redo());
    assert_eq!(pose_document(&library, &state), last);
}

#[test]
fn a_drag_is_one_step() {
    let (mut library, mut state) = walker_with_motion();
    let mut history = History::default();
    let before = state.clone();
    let neck = number(&library, "Neck");
    for step in 1..40 {
        let correction = Quat::from_rotation_x(0.01 * step as f32);
        let edit = MapEdit::Correction { target: neck, correction };
        history.apply(&mut state, &library, Command::EditMap { motion: motion_at(&library, 0), edit });
        history.apply(&mut state, &library, Command::Advance(0.01));
    }
    history.end_gesture();
    assert!(undo(&mut history, &mut state, &mut library));
    assert_eq!(state, before);
    assert!(!history.can_undo());
}

#[test]
fn every_edit_round_trips_through_the_link() {
    let (mut library, state) = walker_with_motion();
    for edit in all_edits(&library) {
        let mut state = edited(&library, &state, edit.clone());
        reconcile(&mut library, &mut state);
        let (mut back, errors) = from_link(&link_of(&state));
        assert_eq!(errors, [], "{edit:?}");
        assert_eq!(reconciled_maps(&library, &back).1, [], "{edit:?}");
        reconcile(&mut library, &mut back);
        assert_eq!(back, state, "{edit:?}");
    }
}

/// Maps that differ from the default in one member each. Add new members here.
fn one_member_each() -> Vec<(&'static str, JointMap)> {
    let JointMap {
        joints: _,
        unmapped: _,
        rest: _,
        root: _,
        translations: _,
        scales: _,
        chains: _,
        muted_channels: _,
        feet: _,
        contacts: _,
        crossfade_secs: _,
    } = JointMap::default();
    let with = |change: &dyn Fn(&mut JointMap)| {
        let mut map = JointMap::default();
        change(&mut map);
        map
    };
    let frozen = Unmapped::Clip { clip: ClipRef::Index(2), frozen: true };
    let entry = |source, correction, unmapped| MapEntry { source, correction, unmapped };
    let odd = Quat::from_xyzw(0.1, -0.7, 1.0 / 3.0, 0.2).normalize();
    vec![
        (
            "joints",
            with(&|map| {
                map.joints.insert(4, entry(Some(9), Quat::IDENTITY, None));
                map.joints.insert(5, entry(Some(9), odd, None));
                map.joints.insert(6, entry(None, Quat::IDENTITY, Some(frozen.clone())));
                map.joints.insert(7, entry(None, Quat::IDENTITY, None));
            }),
        ),
        ("unmapped", with(&|map| map.unmapped = frozen.clone())),
        ("rest", with(&|map| map.rest.motion = RestChoice::FirstFrame)),
        ("root", with(&|map| map.root = RootOptions { yaw: RootPart::InPlace, extract: true, ..Default::default() })),
        ("translations", with(&|map| map.translations = Keep::Keep)),
        ("scales", with(&|map| map.scales = Keep::Drop)),
        ("chains", with(&|map| map.chains = Chains::Share)),
        (
            "muted_channels",
            with(&|map| {
                let properties =
                    [None, Some(MutedProperty::Rotation), Some(MutedProperty::Translation), Some(MutedProperty::Scale)];
                map.muted_channels =
                    (1..).zip(properties).map(|(number, property)| MutedChannel { source: number, property }).collect();
            }),
        ),
        ("feet", with(&|map| map.feet = Feet::Plant)),
        ("contacts", with(&|map| map.contacts = Contacts::Keep)),
        ("crossfade_secs", with(&|map| map.crossfade_secs = 0.15)),
    ]
}

#[test]
fn the_map_key_holds_every_member() {
    let members = one_member_each();
    // Only chains that share their bend are written.
    let form = JointMap { chains: Chains::Share, ..JointMap::default() };
    let form = serde_json::to_value(form).expect("plain data");
    let all: BTreeSet<&str> = form.as_object().expect("an object").keys().map(String::as_str).collect();
    let tried: BTreeSet<&str> = members.iter().map(|(name, _)| *name).collect();
    assert_eq!(tried, all);
    for (name, map) in members {
        let map = MotionMap::Numbers(NumberedMap { checksum: 0x0123_4567, map });
        let state = ViewerState {
            character: CharacterView {
                retarget: RetargetEdits { map: vec![map], ..RetargetEdits::default() },
                ..CharacterView::default()
            },
            ..ViewerState::default()
        };
        assert_ne!(state.character.retarget.map, ViewerState::default().character.retarget.map, "{name}");
        let link = link_of(&state);
        let (back, errors) = from_link(&link);
        assert_eq!(errors, [], "{name}: {link}");
        assert_eq!(back, state, "{name}: {link}");
    }
}

/// Sixty joints, ten of them with rotation offsets, muted channels, and every option.
#[test]
fn a_large_map_stays_short() {
    let mut map = JointMap {
        rest: RestChoices { model: RestChoice::Bind, motion: RestChoice::FirstFrame, up: UpChoice::Z },
        root: RootOptions { horizontal: RootPart::InPlace, ..RootOptions::default() },
        translations: Keep::Drop,
        scales: Keep::Drop,
        feet: Feet::Plant,
        crossfade_secs: 0.25,
        ..JointMap::default()
    };
    for joint in 0..60 {
        let angle = 0.1 * joint as f32;
        let correction =
            if joint % 6 == 5 { Quat::from_euler(glam::EulerRot::XYZ, angle, 0.3, -angle) } else { Quat::IDENTITY };
        let source = Some(joint + 40);
        map.joints.insert(joint + 100, MapEntry { source, correction, unmapped: None });
    }
    for number in 0..4 {
        map.muted_channels.push(MutedChannel { source: number, property: Some(MutedProperty::Rotation) });
    }
    let maps = vec![MotionMap::Numbers(NumberedMap { checksum: 7, map })];
    let state = ViewerState {
        character: CharacterView {
            retarget: RetargetEdits { map: maps, ..RetargetEdits::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    let link = link_of(&state);
    assert!(link.len() < 2000, "{} characters", link.len());
    assert_eq!(from_link(&link).0, state);
}
