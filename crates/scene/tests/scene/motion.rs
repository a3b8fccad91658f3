//! Motions and maps in a view: maps are proposed, kept, and restored by links.

use std::collections::BTreeMap;
use std::sync::Arc;

use gaitway_character::anim::{ClipBuilder, Interpolation, JointIndex, Keys};
use gaitway_character::asset::{Asset, AssetParts};
use gaitway_retarget::{
    ClipRef, Contacts, Feet, JointMap, JointMapFile, MapEntry, MutedChannel, RootOptions, RootPart, SourceRef, Unmapped,
};
use gaitway_scene::editor::{MapProblem, reconciled_maps};
use gaitway_scene::frame::pose_document;
use gaitway_scene::library::{Library, Motion, MotionId, names_checksum};
use gaitway_scene::state::{
    CharacterView, ClipChoice, Command, History, MotionMap, Playback, Playhead, RetargetEdits, ViewerState, active_map,
    active_maps, apply, from_link,
};
use glam::Vec3;

use crate::by_place::{ByPlace, motion_at};
use crate::data::walker;
use crate::history::{redo, undo};
use crate::skeletons;
use crate::texts::link_of;

/// The walker with its own clips as a motion.
fn walker_with_motion() -> Library {
    let mut library = walker();
    let asset = library.active().expect("a model").asset.clone();
    library.set_motions(vec![Motion::new("dance.glb".to_owned(), asset)]);
    library
}

/// A chain of joints with these names, without a clip.
fn chain(names: &[&str]) -> Asset {
    skeletons::asset(skeletons::chain(names.iter().copied(), Vec3::Y))
}

fn reconcile(library: &mut Library, state: &mut ViewerState) -> Vec<MapProblem> {
    let (maps, problems) = reconciled_maps(library, state);
    apply(state, library, Command::ReconcileMaps(maps));
    library.borrow_each(active_maps(library, state));
    problems
}

fn number(library: &Library, name: &str) -> usize {
    let skeleton = &library.active().expect("a model").asset.skeleton;
    skeleton.source_index(skeleton.find(name).expect("a joint of the walker"))
}

fn name(name: &str) -> Option<SourceRef> {
    Some(SourceRef::Name(name.to_owned()))
}

/// A map by name: the neck follows the head, the head is unmapped.
fn by_name() -> JointMapFile {
    let joints = [("Hips", name("Hips")), ("Neck", name("Head")), ("Head", None)];
    JointMapFile {
        joints: joints.into_iter().map(|(target, source)| (target.to_owned(), MapEntry::following(source))).collect(),
        muted_channels: vec![MutedChannel { source: SourceRef::Name("Hips".to_owned()), property: None }],
        ..JointMapFile::default()
    }
}

#[test]
fn a_map_is_proposed_for_every_motion() {
    let mut library = walker_with_motion();
    let mut state = ViewerState::default();
    assert_eq!(reconcile(&mut library, &mut state), []);
    let [MotionMap::Numbers(map)] = &state.character.retarget.map[..] else {
        panic!("{:?}", state.character.retarget.map)
    };
    let asset = &library.active().expect("a model").asset;
    assert_eq!(map.checksum, names_checksum(asset, asset));
    let hips = number(&library, "Hips");
    assert_eq!(map.map.joints[&hips].source, Some(hips));
    assert_eq!(library.borrow_errors(), []);
    assert_eq!(library.active().expect("a model").clips().len(), 6);
    // An existing map is kept.
    let before = state.clone();
    assert_eq!(reconcile(&mut library, &mut state), []);
    assert_eq!(state, before);
}

#[test]
fn only_motions_whose_map_changed_are_baked_again() {
    let mut library = walker_with_motion();
    let asset = library.active().expect("a model").asset.clone();
    let mut names: Vec<&str> = asset.skeleton.joints().map(|joint| asset.skeleton.name(joint)).collect();
    names[3] = "Else";
    let skeleton = chain(&names).into_parts().skeleton;
    let mut clip = ClipBuilder::new("Other", &skeleton);
    let keys = Keys::Translation(vec![Vec3::ZERO, Vec3::Y]);
    clip.channel(JointIndex(0), Interpolation::Linear, &[0.0, 1.0], keys).expect("two keys");
    let clips = vec![clip.build()];
    let other = Asset::new(AssetParts { skeleton, clips, ..AssetParts::default() }).expect("valid indices");
    let other = Motion::new("else.bvh".to_owned(), Arc::new(other));
    library.set_motions(vec![Motion::new("dance.glb".to_owned(), asset), other]);
    let mut state = ViewerState::default();
    assert_eq!(reconcile(&mut library, &mut state), []);
    let baked =
        |library: &Library| [0, 1].map(|motion| library.baked_map(&motion_at(library, motion)).expect("a map").clone());
    let motions = |library: &Library| -> Vec<MotionId> {
        library.active().expect("a model").clips().borrowed().map(|(_, borrowed)| borrowed.motion.clone()).collect()
    };
    assert_eq!(library.borrow_errors(), []);
    let (first, order) = (baked(&library), motions(&library));
    reconcile(&mut library, &mut state);
    assert!(baked(&library).iter().zip(&first).all(|(now, first)| Arc::ptr_eq(now, first)), "nothing changed");
    let (neck, head) = (number(&library, "Neck"), number(&library, "Head"));
    apply(
        &mut state,
        &library,
        Command::SetSource { motion: motion_at(&library, 0), target: neck, source: Some(head) },
    );
    reconcile(&mut library, &mut state);
    let [changed, same] = baked(&library);
    assert_eq!(changed.joints[&neck].source, Some(head));
    assert!(Arc::ptr_eq(&same, &first[1]));
    assert_eq!(motions(&library), order);
    assert_eq!(order, [0, 0, 0, 1].map(|motion| motion_at(&library, motion)));
}

#[test]
fn without_motions_no_map_is_proposed_or_lost() {
    let mut library = walker();
    let map = vec![MotionMap::of_file(&by_name()), MotionMap::File("map.json".to_owned())];
    let mut state = ViewerState {
        character: CharacterView {
            retarget: RetargetEdits { map: map.clone(), ..RetargetEdits::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    assert_eq!(reconcile(&mut library, &mut state), []);
    assert_eq!(state.character.retarget.map, map);
}

#[test]
fn a_map_by_name_becomes_numbers_and_round_trips() {
    let mut library = walker_with_motion();
    let mut state = ViewerState {
        character: CharacterView {
            retarget: RetargetEdits { map: vec![MotionMap::of_file(&by_name())], ..RetargetEdits::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    assert_eq!(reconcile(&mut library, &mut state), []);
    let map = active_map(&library, &state, &motion_at(&library, 0)).expect("the given map");
    let (neck, head) = (number(&library, "Neck"), number(&library, "Head"));
    assert_eq!(map.joints[&neck].source, Some(head));
    assert_eq!(map.joints[&head].source, None);
    assert_eq!(map.joints.len(), 3);
    assert_eq!(map.muted_channels[0].source, number(&library, "Hips"));
    let asset = &library.active().expect("a model").asset;
    assert_eq!(map.to_file(asset, asset), by_name());
    assert_eq!(by_name().to_joint_map(asset, asset), Ok(map));
}

#[test]
fn a_map_that_fits_no_motion_is_reported_and_replaced() {
    let mut library = walker_with_motion();
    let wrong = JointMapFile {
        joints: BTreeMap::from([("Hips".to_owned(), MapEntry::following(name("Pelvis")))]),
        ..JointMapFile::default()
    };
    let mut state = ViewerState {
        character: CharacterView {
            retarget: RetargetEdits { map: vec![MotionMap::of_file(&wrong)], ..RetargetEdits::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    let problems = reconcile(&mut library, &mut state);
    assert!(matches!(&problems[..], [MapProblem::NoFit { motion, .. }] if motion == "dance.glb"), "{problems:?}");
    assert!(problems[0].to_string().contains("Pelvis"), "{}", problems[0]);
    assert!(active_map(&library, &state, &motion_at(&library, 0)).expect("an automatic map").joints.len() > 10);
}

/// If joint names changed since a link was made, its numbers may identify other joints.
#[test]
fn numbers_for_other_names_are_not_used() {
    let mut library = walker_with_motion();
    let mut state = ViewerState::default();
    reconcile(&mut library, &mut state);
    let link = link_of(&state);
    let (mut other, errors) = from_link(&link);
    assert_eq!(errors, []);
    let asset = library.active().expect("a model").asset.clone();
    let mut names: Vec<&str> = asset.skeleton.joints().map(|joint| asset.skeleton.name(joint)).collect();
    names[3] = "Else";
    library.set_motions(vec![Motion::new("else.bvh".to_owned(), Arc::new(chain(&names)))]);
    assert_eq!(reconcile(&mut library, &mut other), [MapProblem::OtherFiles]);
    assert_ne!(other.character.retarget.map, state.character.retarget.map);
}

#[test]
fn a_source_can_be_changed_and_restored() {
    let mut library = walker_with_motion();
    let (mut state, mut history) = (ViewerState::default(), History::default());
    reconcile(&mut library, &mut state);
    let before = state.clone();
    let (neck, head) = (number(&library, "Neck"), number(&library, "Head"));
    let change = Command::SetSource { motion: motion_at(&library, 0), target: neck, source: Some(head) };
    history.apply(&mut state, &library, change);
    let source = |library: &Library, state: &ViewerState| {
        active_map(library, state, &motion_at(library, 0)).expect("a map").joints[&neck].source
    };
    assert_eq!(source(&library, &state), Some(head));
    history.end_gesture();
    history.apply(&mut state, &library, Command::SetFeet(Some(Feet::Plant)));
    assert!(
        undo(&mut history, &mut state, &mut library)
            && undo(&mut history, &mut state, &mut library)
            && !history.can_undo()
    );
    assert_eq!(state, before);
    assert!(redo(&mut history, &mut state, &mut library));
    assert_eq!(source(&library, &state), Some(head));
    for (target, source) in [(9999, None), (neck, Some(9999))] {
        let now = state.clone();
        apply(&mut state, &library, Command::SetSource { motion: motion_at(&library, 0), target, source });
        assert_eq!(state, now, "missing joints change nothing");
    }
    apply(&mut state, &library, Command::SetMap { motion: motion_at(&library, 0), map: None });
    assert_eq!(state.character.retarget.map, before.character.retarget.map, "the proposed map is back");
}

#[test]
fn overrides_take_precedence_over_the_map() {
    let mut library = walker_with_motion();
    let mut state = ViewerState::default();
    reconcile(&mut library, &mut state);
    let root = RootOptions { vertical: RootPart::Freeze, ..RootOptions::default() };
    let unmapped = Unmapped::Clip { clip: ClipRef::Index(1), frozen: true };
    let own = active_map(&library, &state, &motion_at(&library, 0)).expect("a map");
    for command in [
        Command::SetRoot(Some(root)),
        Command::SetUnmapped(Some(unmapped.clone())),
        Command::SetFeet(Some(Feet::Plant)),
        Command::SetContacts(Some(Contacts::Keep)),
    ] {
        apply(&mut state, &library, command);
    }
    let map = active_map(&library, &state, &motion_at(&library, 0)).expect("a map");
    assert_eq!(map, JointMap { root, unmapped, feet: Feet::Plant, contacts: Contacts::Keep, ..own.clone() });
    // Editing a joint doesn't write them into the map.
    let head = number(&library, "Head");
    apply(&mut state, &library, Command::SetSource { motion: motion_at(&library, 0), target: head, source: None });
    let cleared =
        [Command::SetRoot(None), Command::SetUnmapped(None), Command::SetFeet(None), Command::SetContacts(None)];
    for command in cleared {
        apply(&mut state, &library, command);
    }
    let map = active_map(&library, &state, &motion_at(&library, 0)).expect("a map");
    assert_eq!((map.root, map.unmapped, map.feet, map.contacts), (own.root, own.unmapped, own.feet, own.contacts));
}

#[test]
fn a_motion_without_anything_in_common_has_no_map() {
    let mut library = walker();
    library.set_motions(vec![Motion::new("snake.bvh".to_owned(), Arc::new(chain(&["s1", "s2", "s3"])))]);
    let mut state = ViewerState::default();
    assert_eq!(reconcile(&mut library, &mut state), []);
    assert_eq!(state.character.retarget.map, []);
    let [error] = library.borrow_errors() else { panic!("{:?}", library.borrow_errors()) };
    assert!(error.to_string().starts_with("snake.bvh: "), "{error}");
    assert!(error.to_string().contains("no joint in common"), "{error}");
    assert_eq!(library.active().expect("a model").clips().len(), 3);
    // It can still be mapped manually.
    let head = number(&library, "Head");
    apply(&mut state, &library, Command::SetSource { motion: motion_at(&library, 0), target: head, source: Some(1) });
    let map = active_map(&library, &state, &motion_at(&library, 0)).expect("a map");
    assert_eq!(map.joints.len(), 1);
    let before = state.character.retarget.map.clone();
    reconcile(&mut library, &mut state);
    assert_eq!(state.character.retarget.map, before, "a manual map is not replaced by a proposal");
}

/// A link is complete: with the same files, it gives the same pose.
#[test]
fn a_link_restores_the_same_pose() {
    let mut library = walker_with_motion();
    let mut state = ViewerState {
        character: CharacterView {
            playhead: Playhead { time_secs: 0.3, ..Playhead::default() },
            ..CharacterView::default()
        },
        playback: Playback { playing: false, ..Playback::default() },
        ..ViewerState::default()
    };
    reconcile(&mut library, &mut state);
    let arm = number(&library, "LeftUpperArm");
    state.character.playhead.clip = ClipChoice::called("3");
    apply(&mut state, &library, Command::SetSource { motion: motion_at(&library, 0), target: arm, source: None });
    apply(&mut state, &library, Command::SetUnmapped(Some(Unmapped::Clip { clip: ClipRef::Index(2), frozen: false })));
    let root = RootOptions { horizontal: RootPart::InPlace, ..RootOptions::default() };
    apply(&mut state, &library, Command::SetRoot(Some(root)));
    assert_eq!(reconcile(&mut library, &mut state), []);
    let pose = pose_document(&library, &state);
    assert_eq!(library.active().expect("a model").clip_at(3).name(), "Walk");

    let (mut back, errors) = from_link(&link_of(&state));
    assert_eq!(errors, []);
    let mut fresh = walker_with_motion();
    assert_eq!(reconcile(&mut fresh, &mut back), []);
    assert_eq!(back, state);
    assert_eq!(pose_document(&fresh, &back), pose);
    let plain = ViewerState {
        character: CharacterView {
            playhead: Playhead { clip: ClipChoice::called("3"), ..Playhead::default() },
            ..CharacterView::default()
        },
        ..ViewerState::default()
    };
    let mut plain = ViewerState {
        character: CharacterView {
            playhead: Playhead { time_secs: 0.3, ..plain.character.playhead },
            ..plain.character
        },
        playback: Playback { playing: false, ..plain.playback },
        ..plain
    };
    reconcile(&mut fresh, &mut plain);
    assert_ne!(pose_document(&fresh, &plain), pose, "and it differs from the pose without them");
}
