//! Resolving a map's names in two skeletons.

use gaitway_character::anim::{ClipBuilder, Joint, Property, Skeleton};
use gaitway_character::asset::{Asset, AssetParts};
use gaitway_character::mesh::Skin;
use gaitway_retarget::{
    ClipRef, JointMapFile, Layer, MapEntry, MapError, MutedChannel, MutedProperty, Pair, ResolvedMap, SourceRef,
    Unmapped,
};
use glam::{Affine3A, Quat};

/// A chain of joints with these names, listed from tip to base, and clips.
fn chain(names: &[&str], clips: &[&str]) -> Asset {
    let joints = names.iter().enumerate().map(|(at, name)| Joint {
        name: (*name).to_owned(),
        parent: (at + 1 < names.len()).then_some(at + 1),
        ..Joint::default()
    });
    let skeleton = Skeleton::new(joints.collect()).expect("a chain");
    let clips = clips.iter().map(|name| ClipBuilder::new(*name, &skeleton).build()).collect();
    Asset::new(AssetParts { skeleton, clips, ..AssetParts::default() }).expect("indices in range")
}

fn model() -> Asset {
    chain(&["tip", "twin", "twin", "", "spine2", "base"], &["Idle", "Walk"])
}

fn motion() -> Asset {
    chain(&["head", "neck", "rep", "rep", "hip"], &[])
}

fn map(joints: &[(&str, Option<SourceRef>)]) -> JointMapFile {
    let entry =
        |source: &Option<SourceRef>| MapEntry { source: source.clone(), correction: Quat::IDENTITY, unmapped: None };
    JointMapFile {
        joints: joints.iter().map(|(name, source)| ((*name).to_owned(), entry(source))).collect(),
        ..JointMapFile::default()
    }
}

fn name(name: &str) -> Option<SourceRef> {
    Some(SourceRef::Name(name.to_owned()))
}

fn resolve(map: &JointMapFile) -> Result<ResolvedMap, MapError> {
    map.resolve(&model(), &motion())
}

fn check_refused(map: &JointMapFile, expected: &str) {
    let message = resolve(map).expect_err(expected).to_string();
    assert!(message.contains(expected), "{message}\n{expected}");
}

#[test]
fn missing_and_ambiguous_joints_are_refused() {
    check_refused(&map(&[("spine", name("neck"))]), "joints.spine: the model has no joint “spine”; nearest: spine2");
    check_refused(&map(&[("tip", name("Neck1"))]), "joints.tip.source: the motion has no joint “Neck1”; nearest: neck");
    check_refused(&map(&[("xyz", name("neck"))]), "the model has no joint “xyz”");
    check_refused(&map(&[("tip", Some(SourceRef::Number(5)))]), "no joint 5: it has 5, 0 to 4");
    check_refused(&map(&[("#6", name("neck"))]), "the model has no node 6: it has 6");
    check_refused(&map(&[("#x", name("neck"))]), "the model has no node x");
    check_refused(&map(&[("twin", name("neck"))]), "2 joints of the model are called “twin”: write one of #1, #2");
    check_refused(
        &map(&[("tip", name("rep"))]),
        "2 joints of the motion are called “rep”: write one of their numbers, 2, 3",
    );
    check_refused(&map(&[("tip", name("neck")), ("#0", name("head"))]), "“#0” and “tip” are the same joint");
    let mut muted = map(&[("tip", name("neck"))]);
    muted.muted_channels.push(MutedChannel { source: SourceRef::Name("nek".to_owned()), property: None });
    check_refused(&muted, "muted_channels[0].source: the motion has no joint “nek”; nearest: neck");
}

#[test]
fn nodes_that_only_hold_a_mesh_are_not_suggested() {
    let parts = chain(&["mixamorig:LeftLeg", "mixamorig:RightLeg", "Object_7"], &[]).into_parts();
    let joints = ["mixamorig:LeftLeg", "mixamorig:RightLeg"].map(|name| parts.skeleton.find(name).expect("a joint"));
    let skin = Skin::new(String::new(), joints.to_vec(), vec![Affine3A::IDENTITY; 2], 3).expect("a skin");
    let model = Asset::new(AssetParts { skins: vec![skin], ..parts }).expect("indices in range");
    let message =
        |wanted: &str| map(&[(wanted, name("hip"))]).resolve(&model, &motion()).expect_err(wanted).to_string();
    assert_eq!(message("Object_1"), "joints.Object_1: the model has no joint “Object_1”");
    let nearest = message("left_leg");
    assert!(nearest.contains("“left_leg”; nearest: mixamorig:LeftLeg"), "{nearest}");
}

#[test]
fn maps_without_sources_are_refused() {
    check_refused(&map(&[]), "the map names no source");
    check_refused(&map(&[("tip", None)]), "the map names no source");
    check_refused(&JointMapFile { gaitway_map: 3, ..map(&[("tip", name("neck"))]) }, "gaitway_map is 3");
}

#[test]
fn invalid_clips_corrections_and_times_are_refused() {
    let good = map(&[("tip", name("neck"))]);
    let play = |clip| Unmapped::Clip { clip, frozen: false };
    let with_clip = |clip| JointMapFile { unmapped: play(clip), ..good.clone() };
    check_refused(&with_clip(ClipRef::Index(2)), "unmapped.clip: the model has no clip 2; it has 0 “Idle”, 1 “Walk”");
    check_refused(
        &with_clip(ClipRef::Name("Run".to_owned())),
        "the model has no clip “Run”; it has 0 “Idle”, 1 “Walk”",
    );
    let mut own = good.clone();
    own.joints.get_mut("tip").expect("an entry").unmapped = Some(play(ClipRef::Index(9)));
    check_refused(&own, "joints.tip.unmapped.clip: the model has no clip 9");
    for bad in [Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)] {
        let mut turned = good.clone();
        turned.joints.get_mut("tip").expect("an entry").correction = bad;
        check_refused(&turned, "joints.tip.correction: ");
    }
    for bad in [-0.5, f64::NAN, f64::INFINITY] {
        check_refused(&JointMapFile { crossfade_secs: bad, ..good.clone() }, "crossfade_secs is");
    }
}

#[test]
fn names_and_numbers_are_resolved() {
    let (model, motion) = (model(), motion());
    let mut map =
        map(&[("base", name("hip")), ("#2", Some(SourceRef::Number(2))), ("#3", name("head")), ("spine2", None)]);
    map.joints.get_mut("base").expect("an entry").correction = Quat::from_xyzw(0.0, 0.0, 0.0, 2.0);
    map.joints.get_mut("spine2").expect("an entry").unmapped =
        Some(Unmapped::Clip { clip: ClipRef::Name("Walk".to_owned()), frozen: true });
    map.unmapped = Unmapped::Clip { clip: ClipRef::Index(0), frozen: false };
    map.muted_channels = vec![
        MutedChannel { source: SourceRef::Number(3), property: Some(MutedProperty::Scale) },
        MutedChannel { source: SourceRef::Number(4), property: None },
    ];
    let resolved = map.resolve(&model, &motion).expect("every name exists");
    // The file lists joints from the tip, the skeleton from the base.
    let target = |number| model.skeleton.joint_of_source(number).expect("a joint");
    let source = |number| motion.skeleton.joint_of_source(number).expect("a joint");
    let pair = |to, from| Pair { target: target(to), source: source(from), correction: Quat::IDENTITY };
    assert_eq!(resolved.pairs, [pair(5, 4), pair(3, 0), pair(2, 2)]);
    let layer = |joint, clip, frozen| Layer { joint: target(joint), clip, frozen };
    assert_eq!(resolved.layers, [layer(4, 1, true), layer(1, 0, false), layer(0, 0, false)]);
    let all = [Property::Translation, Property::Rotation, Property::Scale];
    let mut muted = vec![(source(3), Property::Scale)];
    muted.extend(all.map(|property| (source(4), property)));
    assert_eq!(resolved.muted, muted);
}

#[test]
fn a_joint_may_rest_while_others_play() {
    let mut map = map(&[("base", name("hip")), ("tip", None)]);
    map.joints.get_mut("tip").expect("an entry").unmapped = Some(Unmapped::Rest);
    map.unmapped = Unmapped::Clip { clip: ClipRef::Index(1), frozen: false };
    let resolved = resolve(&map).expect("every name exists");
    let tip = model().skeleton.find("tip").expect("a joint");
    assert!(resolved.layers.iter().all(|layer| layer.joint != tip));
    assert_eq!(resolved.layers.len(), 4);
}
