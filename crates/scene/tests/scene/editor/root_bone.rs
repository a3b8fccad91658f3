//! Exports with a root bone above the hips, which carries what they did.

use gaitway_character::anim::{
    Clip, ClipBuilder, Interpolation, JointIndex, Keys, Property, SampleCursor, Skeleton, Transform, model_from_joint,
};
use gaitway_character::asset::Asset;
use gaitway_retarget::{RootError, RootTravel, with_root_motion};
use gaitway_scene::editor::{ClipFormat, Editor, ExportPlan, Packaging, RootBone};
use glam::{Affine3A, Quat, Vec3};

use super::editor;
use super::plan::{all_clips, borrow, check_refused, clip, export, model, motion, together};

const ROOT: &str = "root";
const HIPS: &str = "mixamorig:Hips";

/// Hips that walk a curve, turn more than once, lean, and jump.
fn curve(skeleton: &Skeleton, interpolation: Interpolation) -> Clip {
    let hips = skeleton.find(HIPS).expect("hips");
    let rest = skeleton.rest().local(hips);
    let times_secs: Vec<f32> = (0..12).map(|key| 0.3 * key as f32).collect();
    let turn = |secs: &f32| Quat::from_rotation_y(2.0 * secs) * Quat::from_rotation_x(0.4 * secs.sin()) * rest.rotation;
    let at = |secs: &f32| rest.translation + Vec3::new(2.0 * secs, 0.2 * secs.cos() - 0.2, secs * secs);
    let mut builder = ClipBuilder::new("Curve", skeleton);
    let keys =
        [Keys::Translation(times_secs.iter().map(at).collect()), Keys::Rotation(times_secs.iter().map(turn).collect())];
    for keys in keys {
        builder.channel(hips, interpolation, &times_secs, keys).expect("a channel");
    }
    builder.build()
}

/// The pilot with a clip of its own rig that travels.
fn pilot(interpolation: Interpolation) -> (Editor, ExportPlan) {
    let mut editor = editor("sample:pilot");
    let skeleton = model(&editor).asset.skeleton.clone();
    borrow(&mut editor, vec![motion("curve.glb", &skeleton, vec![curve(&skeleton, interpolation)])]);
    let plan = ExportPlan { root_bone: Some(RootBone::default()), ..all_clips(&editor) };
    (editor, plan)
}

fn named<'a>(asset: &'a Asset, name: &str) -> &'a Clip {
    asset.clips.iter().find(|clip| clip.name() == name).unwrap_or_else(|| panic!("no {name}"))
}

fn world(skeleton: &Skeleton, clip: &Clip, secs: f32) -> Vec<Affine3A> {
    let (mut pose, mut world) = (skeleton.rest().clone(), Vec::new());
    clip.sample(skeleton, secs, &mut SampleCursor::default(), &mut pose);
    model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut world);
    world
}

fn local(skeleton: &Skeleton, clip: &Clip, joint: &str, secs: f32) -> Transform {
    let mut pose = skeleton.rest().clone();
    clip.sample(skeleton, secs, &mut SampleCursor::default(), &mut pose);
    pose.local(skeleton.find(joint).expect("a joint"))
}

/// Checks that all joints are where they are without the root bone, between keys as well.
fn check_world(before: &Asset, after: &Asset, name: &str) {
    let (clip, moved) = (named(before, name), named(after, name));
    let count = 7 * moved.timelines().iter().map(Vec::len).max().unwrap_or(1);
    for step in 0..count {
        let secs = clip.duration_secs() * step as f32 / count as f32;
        let (expected, found) = (world(&before.skeleton, clip, secs), world(&after.skeleton, moved, secs));
        for joint in before.skeleton.joints() {
            let same = after.skeleton.joint_of_source(before.skeleton.source_index(joint)).expect("the joint");
            let (expected, found) = (expected[joint.get()], found[same.get()]);
            let off = expected.translation.distance(found.translation);
            assert!(off < 2e-4, "{name}, {} at {secs}: off by {off}", before.skeleton.name(joint));
            assert!(expected.matrix3.abs_diff_eq(found.matrix3, 1e-3), "{name} at {secs}: {expected} {found}");
        }
    }
}

#[test]
fn hips_and_root_together_move_as_the_hips_did() {
    for interpolation in [Interpolation::Linear, Interpolation::Step] {
        let (editor, plan) = pilot(interpolation);
        let before = together(&editor, &ExportPlan { root_bone: None, ..plan.clone() });
        let after = together(&editor, &plan);
        assert_eq!(after.skeleton.len(), before.skeleton.len() + 1);
        let (root, hips) = (after.skeleton.find(ROOT).expect("a root"), after.skeleton.find(HIPS).expect("hips"));
        assert_eq!((after.skeleton.parent(root), after.skeleton.parent(hips)), (None, Some(root)));
        assert_eq!(after.skeleton.rest().local(root), Transform::IDENTITY);
        assert!(after.skins[0].joints().contains(&root), "a bone");
        for clip in &before.clips {
            check_world(&before, &after, clip.name());
        }
        // All of the way is the root's; the hips only lean and rise.
        let (clip, rest) = (named(&after, "Curve"), after.skeleton.rest().local(hips).translation);
        for secs in [0.0, 0.6, 1.5, 2.7] {
            let (root, hips) = (local(&after.skeleton, clip, ROOT, secs), local(&after.skeleton, clip, HIPS, secs));
            assert!((hips.translation - rest).with_y(0.0).length() < 2e-4, "{secs}: {hips:?}");
            assert!(root.translation.y.abs() < 1e-5 && (root.rotation * Vec3::Y).abs_diff_eq(Vec3::Y, 1e-5));
            let facing = Quat::from_rotation_y(2.0 * secs) * Vec3::Z;
            assert!((root.rotation * Vec3::Z).dot(facing) > 0.9, "it faces where the hips face");
        }
        let rising = ExportPlan { root_bone: Some(RootBone { vertical: true }), ..plan };
        let rising = together(&editor, &rising);
        check_world(&before, &rising, "Curve");
        let hips = local(&rising.skeleton, named(&rising, "Curve"), HIPS, 1.5);
        assert!((hips.translation - rest).length() < 2e-4, "the height is the root's, too");
    }
}

#[test]
fn clips_in_place_leave_the_way_to_the_engine() {
    let (editor, mut plan) = pilot(Interpolation::Linear);
    let before = together(&editor, &ExportPlan { root_bone: None, ..plan.clone() });
    plan.clips.iter_mut().filter(|planned| planned.name == "Curve").for_each(|planned| planned.in_place = true);
    let after = together(&editor, &plan);
    let (root, curve) = (after.skeleton.find(ROOT).expect("a root"), named(&after, "Curve"));
    assert!(curve.channels().iter().all(|channel| channel.joint != root));
    let hips = after.skeleton.find(HIPS).expect("hips");
    let rest = after.skeleton.rest().local(hips).translation;
    let at = local(&after.skeleton, curve, HIPS, 1.7).translation;
    assert!((at - rest).with_y(0.0).length() < 2e-4, "{at}");
    check_world(&before, &after, "walk");
}

#[test]
fn a_rig_with_a_root_bone_keeps_it() {
    let editor = editor("sample:walker");
    let mut plan = ExportPlan { root_bone: Some(RootBone::default()), ..all_clips(&editor) };
    let file = export(&editor, &plan);
    assert!(file.remark.is_some_and(|remark| remark.contains("“Root” is the root bone of this rig")));
    assert_eq!(together(&editor, &plan).skeleton.len(), model(&editor).asset.skeleton.len());
    plan.clips[0].in_place = true;
    check_refused(&editor, &plan, "this rig has a root bone");
}

#[test]
fn what_no_root_bone_can_carry_is_refused() {
    let (editor, plan) = pilot(Interpolation::Linear);
    let mut in_place = ExportPlan { root_bone: None, ..plan.clone() };
    in_place.clips[0].in_place = true;
    check_refused(&editor, &in_place, "need a root bone");
    check_refused(
        &editor,
        &ExportPlan { packaging: Packaging::FilePerClip(ClipFormat::Glb), ..plan },
        "choose one file",
    );

    let skeleton = |top: Transform| {
        let mut joints = crate::skeletons::chain(["top", ROOT, "hips", "spine"], Vec3::Y);
        joints[0].rest = top;
        joints[1].rest = Transform::IDENTITY;
        crate::skeletons::asset(joints).skeleton.clone()
    };
    let [top, root, hips] = [0, 1, 2].map(JointIndex);
    let carried =
        |skeleton: &Skeleton, clip: &Clip| with_root_motion(skeleton, clip, hips, root, RootTravel::default());
    let even = skeleton(Transform { scale: Vec3::splat(0.01), ..Transform::IDENTITY });
    let moves = clip(&even, "Moves", 5);
    let only = |joints: &[JointIndex]| {
        let mut builder = ClipBuilder::new("Moves", &even);
        for channel in moves.channels().iter().filter(|channel| joints.contains(&channel.joint)) {
            let times_secs = &moves.timelines()[channel.timeline as usize];
            builder.channel(channel.joint, channel.interpolation, times_secs, channel.keys.clone()).expect("a channel");
        }
        let keys = Keys::Translation(vec![Vec3::ZERO, Vec3::X]);
        if joints.contains(&top) {
            builder.channel(top, Interpolation::Linear, &[0.0, 1.0], keys).expect("a channel");
        }
        builder.build()
    };
    let above = RootError::AboveMoves { clip: "Moves".to_owned(), joint: "top".to_owned() };
    assert_eq!(carried(&even, &only(&[top, hips])).err(), Some(above));
    let carried_hips = carried(&even, &only(&[hips])).expect("stands still above");
    assert!(
        carried_hips
            .channels()
            .iter()
            .any(|channel| channel.joint == root && channel.keys.property() == Property::Rotation)
    );
    let stretched = skeleton(Transform { scale: Vec3::new(1.0, 2.0, 1.0), ..Transform::IDENTITY });
    assert_eq!(carried(&stretched, &only(&[hips])).err(), Some(RootError::Stretched));
}
