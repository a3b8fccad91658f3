//! Figures and warnings show what is visibly wrong with a clip, and where. That they find nothing wrong with good ones is checked
//! with every real pair (`pairs`).

use std::f64::consts::PI;

use gaitway_character::anim::{Clip, ClipBuilder, JointIndex, Keys, Skeleton};
use gaitway_character::asset::Slot;
use gaitway_retarget::{Figures, FitWarning, ResolvedMap, Retargeting};
use glam::{DQuat, Vec3};

use crate::people::{Loaded, measured, model_rotations, with_pairs};

/// Characters and motions of different rigs; two motions have no toes.
const MODELS: [&str; 4] = ["human-male.glb", "Knight.glb", "Soldier.glb", "vrm0_cryptovoxels.vrm"];
const WALK: &str = "deepmotion_xia_neutral_16_000.bvh";
const MOTIONS: [&str; 3] = ["cmu_91_48.glb", "cosc422_Walk.bvh", WALK];

fn warnings(figures: &Figures) -> Vec<&'static str> {
    FitWarning::of(figures).iter().map(FitWarning::code).collect()
}

fn is_within(skeleton: &Skeleton, joint: JointIndex, ancestor: JointIndex) -> bool {
    std::iter::successors(Some(joint), |&joint| skeleton.parent(joint)).any(|joint| joint == ancestor)
}

#[test]
fn a_limb_that_is_not_mapped_is_idle() {
    with_pairs(&MODELS, &MOTIONS, |model, motion, map| {
        let whole = measured(model, motion, &map).unwrap().0;
        for (limb, name) in [(Slot::LeftUpperArm, "left-arm"), (Slot::RightUpperLeg, "right-leg")] {
            let first = model.slots.joint(limb).unwrap();
            let mut without = map.clone();
            without.pairs.retain(|pair| !is_within(&model.asset.skeleton, pair.target, first));
            let figures = measured(model, motion, &without).unwrap().0;
            let who = format!("{} ← {} without {name}", model.name, motion.name);
            assert_eq!(figures.idle_chains, [name], "{who}");
            assert_eq!(warnings(&figures), ["idle-chain"], "{who}");
            let [covered, of_whole] = [&figures, &whole].map(|figures| figures.coverage.unwrap());
            assert!(covered < of_whole - 0.1, "{who}: {covered}, not {of_whole}");
        }
    });
}

/// The clip with the hips' path on the spine alone: some metres.
fn with_path_on(clip: &Clip, skeleton: &Skeleton, hips: JointIndex, spine: JointIndex) -> Clip {
    let mut builder = ClipBuilder::new(clip.name(), skeleton);
    for channel in clip.channels() {
        let times = &clip.timelines()[channel.timeline as usize];
        let (joint, keys) = match &channel.keys {
            Keys::Translation(path) if channel.joint == hips => {
                let rest = skeleton.rest().local(spine).translation;
                (spine, Keys::Translation(path.iter().map(|at| rest + (at - path[0])).collect::<Vec<Vec3>>()))
            }
            keys => (channel.joint, keys.clone()),
        };
        builder.channel(joint, channel.interpolation, times, keys).unwrap();
    }
    builder.build()
}

#[test]
fn a_path_on_the_spine_alone_stretches_the_skin() {
    with_pairs(&MODELS, &[WALK], |model, motion, map| {
        let pair = Retargeting::new(model.body(), motion.body(), 0, &map).unwrap();
        let made = pair.bake().unwrap();
        let [hips, spine] = [Slot::Hips, Slot::Spine].map(|slot| model.slots.joint(slot).unwrap());
        let torn = with_path_on(&made.clip, &model.asset.skeleton, hips, spine);
        let [good, torn] = [&made.clip, &torn].map(|clip| pair.measure(clip, None).0);
        assert_eq!(warnings(&good), [""; 0], "{}: {good:?}", model.name);
        let [of_good, of_torn] = [&good, &torn].map(|figures| figures.skin_stretch_mean.unwrap() - 1.0);
        assert!(of_torn > of_good, "{}: {of_torn}, not more than {of_good}", model.name);
        assert_eq!(warnings(&torn), ["torn-skin"], "{}: {torn:?}", model.name);
        assert!(good.skin_tear_max.unwrap() < 1.001, "{}: {good:?}", model.name);
        // Angles don't show it.
        assert_eq!(good.orientation_error_degrees_max, torn.orientation_error_degrees_max);
    });
}

/// The map with some joints turned back to front.
fn turned(model: &Loaded, map: &ResolvedMap, slots: &[Slot]) -> ResolvedMap {
    let skeleton = &model.asset.skeleton;
    let rest = model_rotations(skeleton, &ClipBuilder::new("without channels", skeleton).build(), 0.0);
    let mut map = map.clone();
    for joint in slots.iter().filter_map(|&slot| model.slots.joint(slot)) {
        if let Some(index) = map.pair_index(joint) {
            let rest = rest[joint.get()];
            map.pairs[index].correction = (rest.conjugate() * DQuat::from_rotation_y(PI) * rest).as_quat();
        }
    }
    map
}

#[test]
fn feet_that_point_backwards_face_away() {
    const FEET: [Slot; 4] = [Slot::LeftFoot, Slot::RightFoot, Slot::LeftToes, Slot::RightToes];
    with_pairs(&MODELS, &MOTIONS, |model, motion, map| {
        let who = format!("{} ← {}", model.name, motion.name);
        let good = measured(model, motion, &map).unwrap().0;
        assert!(good.facing_path_error_degrees_mean.unwrap() < 30.0, "{who}: {good:?}");
        let figures = measured(model, motion, &turned(model, &map, &FEET)).unwrap().0;
        assert!(figures.facing_path_error_degrees_mean.unwrap() > 120.0, "{who}: {figures:?}");
        assert!(warnings(&figures).contains(&"faces-away"), "{who}: {figures:?}");
    });
}

/// Clips of the same skeleton may stretch the body on purpose, as this one does.
#[test]
fn a_file_does_not_tear_its_own_body() {
    with_pairs(&["Xbot.glb"], &["Xbot.glb"], |model, _, map| {
        let clip = model.asset.clips.iter().position(|clip| clip.name() == "sneak_pose").unwrap();
        let pair = Retargeting::new(model.body(), model.body(), clip, &map).unwrap();
        let figures = pair.figures(&pair.bake().unwrap());
        assert_eq!(figures.skin_tear_max, None);
        assert_eq!(warnings(&figures), [""; 0], "{figures:?}");
    });
}
