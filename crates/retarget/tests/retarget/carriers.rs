//! Which joint takes the path: the body stays in one piece, whatever its hips are.

use gaitway_character::anim::{
    Clip, ClipBuilder, Interpolation, Joint, JointIndex, Keys, SampleCursor, Transform, model_from_joint,
};
use gaitway_character::asset::{Asset, AssetParts};
use gaitway_retarget::{Body, Retargeting, propose, recognize};
use glam::{Affine3A, Vec3};

use crate::skeletons;

/// Names, parents and offsets of a body whose legs hang on `legs_on`; `top` is what hangs above its spine.
fn body(top: &[&str], legs_on: &str) -> Asset {
    let mut joints: Vec<Joint> = Vec::new();
    let mut add = |name: &str, parent: Option<&str>, at: [f32; 3]| {
        let parent = parent.map(|parent| joints.iter().position(|joint| joint.name == parent).expect("a parent"));
        joints.push(skeletons::joint(name, parent, Transform::from_translation(Vec3::from(at))));
    };
    for (index, name) in top.iter().enumerate() {
        let above = index.checked_sub(1).map(|above| top[above]);
        add(name, above, [0.0, if index == 0 { 1.0 } else { 0.0 }, 0.0]);
    }
    add("Spine", top.last().copied(), [0.0, 0.05, 0.0]);
    for (name, above, height) in [("Spine1", "Spine", 0.2), ("Neck", "Spine1", 0.25), ("Head", "Neck", 0.1)] {
        add(name, Some(above), [0.0, height, 0.0]);
    }
    for (side, x) in [("L", 1.0), ("R", -1.0)] {
        let name = |part: &str| format!("{side} {part}");
        let limb = [
            ("Clavicle", "Spine1", [0.05 * x, 0.15, 0.0]),
            ("UpperArm", "Clavicle", [0.15 * x, 0.0, 0.0]),
            ("Forearm", "UpperArm", [0.28 * x, 0.0, 0.0]),
            ("Hand", "Forearm", [0.26 * x, 0.0, 0.0]),
            ("Thigh", legs_on, [0.1 * x, -0.05, 0.0]),
            ("Calf", "Thigh", [0.0, -0.45, 0.0]),
            ("Foot", "Calf", [0.0, -0.45, 0.0]),
        ];
        for (part, above, at) in limb {
            let own = name(above);
            let above = if ["Spine1", legs_on].contains(&above) { above } else { &own };
            add(&name(part), Some(above), at);
        }
    }
    skeletons::asset(joints)
}

/// The same body, in which all joints but `without` move skin.
fn skinned(asset: &Asset, without: &[&str]) -> Asset {
    let names: Vec<&str> = asset.skeleton.joints().map(|joint| asset.skeleton.name(joint)).collect();
    skeletons::with_skin(asset, &names.into_iter().filter(|name| !without.contains(name)).collect::<Vec<_>>())
}

/// The same with a clip in which a joint travels 2 m in 1 s.
fn travelling(asset: &Asset, joint: &str) -> Asset {
    let joint = asset.skeleton.find(joint).expect("a joint");
    let start = asset.skeleton.rest().local(joint).translation;
    let mut builder = ClipBuilder::new("walk", &asset.skeleton);
    let keys = Keys::Translation(vec![start, start + 2.0 * Vec3::Z]);
    builder.channel(joint, Interpolation::Linear, &[0.0, 1.0], keys).expect("a channel");
    let clips = vec![builder.build()];
    let skeleton = asset.skeleton.clone();
    Asset::new(AssetParts { skeleton, clips, ..AssetParts::default() }).expect("an asset")
}

/// The motion's first clip, retargeted with the proposed map.
pub fn retargeted(model: &Asset, motion: &Asset) -> Clip {
    let slots = [model, motion].map(|asset| recognize(asset).humanoid());
    let map = propose(model, motion).to_map(model, motion).resolve(model, motion).expect("a map");
    let [model, motion] = [Body { asset: model, slots: &slots[0] }, Body { asset: motion, slots: &slots[1] }];
    Retargeting::new(model, motion, 0, &map).expect("fits").bake().expect("bakes").clip
}

/// Positions of all joints in model space.
pub fn positions(asset: &Asset, clip: &Clip, time_secs: f32) -> Vec<Vec3> {
    let (mut pose, mut world) = (asset.skeleton.rest().clone(), Vec::new());
    clip.sample(&asset.skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
    model_from_joint(&asset.skeleton, &pose, Affine3A::IDENTITY, &mut world);
    world.into_iter().map(|joint| joint.translation.into()).collect()
}

/// Checks that all joints but `still` travel 2 m together.
fn check_in_one_piece(model: &Asset, clip: &Clip, still: &[&str]) {
    let [start, end] = [0.0, 1.0].map(|time| positions(model, clip, time));
    for joint in model.skeleton.joints() {
        let name = model.skeleton.name(joint);
        let expected = if still.contains(&name) { Vec3::ZERO } else { 2.0 * Vec3::Z };
        let found = end[joint.get()] - start[joint.get()];
        assert!(found.distance(expected) < 1e-3, "{name} moves by {found}, not {expected}");
    }
}

#[test]
fn skin_above_the_hips_goes_along() {
    let motion = travelling(&body(&["Hips"], "Hips"), "Hips");
    // The thighs hang on the spine, which is where legs and spine meet; or on what carries the hips.
    for (top, legs_on) in [(vec!["Bip01", "Pelvis"], "Spine"), (vec!["Root", "Body", "Pelvis"], "Body")] {
        let model = skinned(&body(&top, legs_on), &[]);
        check_in_one_piece(&model, &retargeted(&model, &motion), &[]);
    }
    // A root without skin stays where the character is placed.
    let model = skinned(&body(&["root", "Hips"], "Hips"), &["root"]);
    check_in_one_piece(&model, &retargeted(&model, &motion), &["root"]);
}

/// The path is in the joint that had it, and not in the hips as well.
#[test]
fn a_rig_plays_its_own_clip_exactly() {
    for (top, legs_on, moving) in [
        (vec!["Bip01", "Pelvis"], "Spine", "Bip01"),
        (vec!["Bip01", "Pelvis"], "Spine", "Pelvis"),
        (vec!["Bip01", "Pelvis"], "Spine", "Spine"),
        (vec!["root", "Hips"], "Hips", "root"),
    ] {
        let own = body(&top, legs_on);
        let (model, motion) = (skinned(&own, &[]), travelling(&own, moving));
        let clip = retargeted(&model, &motion);
        for time in [0.0, 0.4, 1.0] {
            let (expected, found) = (positions(&motion, &motion.clips[0], time), positions(&model, &clip, time));
            for joint in motion.skeleton.joints() {
                let off = expected[joint.get()].distance(found[joint.get()]);
                let name = motion.skeleton.name(joint);
                assert!(off < 1e-4, "{moving} moves: {name} at {time} s is {off} m away");
            }
        }
    }
}

/// Its hips are what another file calls its body.
#[test]
fn names_that_mean_other_joints_do_not_decide() {
    let model = body(&["Root", "Body", "Hips"], "Body");
    let motion = travelling(&body(&["Root", "Hips"], "Hips"), "Hips");
    let hips = |asset: &Asset| -> Option<JointIndex> { recognize(asset).joint(gaitway_character::asset::Slot::Hips) };
    let proposal = propose(&model, &motion);
    let pair = proposal.pairs.iter().find(|pair| Some(pair.target) == hips(&model)).expect("the hips follow");
    assert_eq!(Some(pair.source), hips(&motion));
    assert_eq!(model.skeleton.name(pair.target), "Body");
}
