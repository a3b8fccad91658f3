//! Motions without a usable rest: whichever pose of the clip stands in for one, the body faces as it does in its file, and the clip
//! may begin at any of its moments.

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, Keys, SampleCursor, Skeleton};
use gaitway_character::asset::{Asset, Slot};
use gaitway_retarget::{Body, RestOrigin, Retargeting};
use glam::{DQuat, Quat, Vec3};

use crate::carriers::positions;
use crate::figure::{Figure, Rig, build};
use crate::laws::{body, degrees, map};
use crate::people::{Loaded, with_pairs};
use crate::rests::{alone, largest_degrees, resting_in_motion, walk, with_rest};

/// Turns the whole body from one angle about the vertical to another one, in a second and a half.
fn turning(figure: &mut Figure, from_degrees: f64, to_degrees: f64) {
    let hips = figure.joint(Slot::Hips);
    let skeleton = &figure.asset.skeleton;
    let rest = skeleton.rest().local(hips).rotation.as_dquat();
    let above =
        skeleton.parent(hips).map_or(DQuat::IDENTITY, |parent| skeleton.rest().local(parent).rotation.as_dquat());
    let key = |step: usize| {
        let degrees = from_degrees + (to_degrees - from_degrees) * step as f64 / 8.0;
        (above.conjugate() * DQuat::from_rotation_y(degrees.to_radians()) * above * rest).normalize().as_quat()
    };
    let times: Vec<f32> = (0..=8).map(|step| step as f32 * 1.5 / 8.0).collect();
    let mut clip = ClipBuilder::new("turn", skeleton);
    for joint in figure.slots.0.values().copied() {
        let keys = match joint == hips {
            true => (0..=8).map(key).collect(),
            false => vec![skeleton.rest().local(joint).rotation; times.len()],
        };
        clip.channel(joint, Interpolation::Linear, &times, Keys::Rotation(keys)).unwrap();
    }
    let clip = clip.build();
    figure.set_clip(clip);
}

/// The motion as some motion capture files write it: without rest rotations, so that each bone points along its own axes.
fn without_rest_rotations(figure: &Figure) -> Asset {
    let skeleton = &figure.asset.skeleton;
    let is_part = |joint| figure.slots.0.values().any(|other| *other == joint);
    let rested = with_rest(skeleton, |joint, rest| {
        if is_part(joint) {
            rest.rotation = Quat::IDENTITY;
        }
    });
    alone(rested, figure.asset.clips[0].clone())
}

/// The clip from a time on.
fn trimmed(skeleton: &Skeleton, clip: &Clip, from_secs: f32) -> Asset {
    let steps = ((clip.duration_secs() - from_secs) * 60.0).round() as usize;
    let times: Vec<f32> = (0..=steps).map(|step| step as f32 / 60.0).collect();
    let mut keys = vec![(Vec::new(), Vec::new()); skeleton.len()];
    let mut pose = skeleton.rest().clone();
    for time in &times {
        clip.sample(skeleton, time + from_secs, &mut SampleCursor::default(), &mut pose);
        for joint in skeleton.joints() {
            let local = pose.local(joint);
            keys[joint.get()].0.push(local.rotation);
            keys[joint.get()].1.push(local.translation);
        }
    }
    let mut builder = ClipBuilder::new("trimmed", skeleton);
    for (joint, (rotations, translations)) in skeleton.joints().zip(keys) {
        for keys in [Keys::Rotation(rotations), Keys::Translation(translations)] {
            builder.channel(joint, Interpolation::Linear, &times, keys).unwrap();
        }
    }
    alone(skeleton.clone(), builder.build())
}

/// The largest angle between the body parts of the model's clip and those of the motion's, from a time on, turned.
fn largest(model: &Figure, clip: &Clip, motion: &Figure, from_secs: f32, turn: DQuat) -> (f64, Slot) {
    let mut worst = (0.0, Slot::Hips);
    for step in 0..=10 {
        let time = clip.duration_secs() * step as f32 / 10.0;
        let wanted = motion.body_parts(&motion.asset.clips[0], time + from_secs);
        for (slot, found) in model.body_parts(clip, time) {
            let off = degrees(turn * wanted[&slot], found);
            if off > worst.0 {
                worst = (off, slot);
            }
        }
    }
    worst
}

#[test]
fn a_body_faces_as_in_its_file_wherever_its_clip_begins() {
    let model = build(&Rig { axes: 8, prefix: "b_", size: 1.2, ..Rig::default() });
    for (seed, armature) in [(3, false), (4, true), (6, false)] {
        let mut motion = build(&Rig { axes: seed, armature, prefix: "a_", ..Rig::default() });
        turning(&mut motion, 5.0, -135.0);
        let asset = without_rest_rotations(&motion);
        for from_secs in [0.0, 0.4, 1.1] {
            let asset = trimmed(&asset.skeleton, &asset.clips[0], from_secs);
            let map = map(&model, &motion);
            let source = Body { asset: &asset, slots: &motion.slots };
            let retargeting = Retargeting::new(body(&model), source, 0, &map).unwrap();
            assert_ne!(retargeting.motion_rest().origin, RestOrigin::Motion);
            let found = retargeting.bake().unwrap().clip;
            let worst = largest(&model, &found, &motion, from_secs, DQuat::IDENTITY);
            assert!(worst.0 < 1.0, "{seed}, from {from_secs} s: {worst:?} degrees");
        }
    }
}

/// A rest at any moment of a walk, on another rig.
#[test]
fn a_rest_in_motion_never_stands() {
    let model = build(&Rig { axes: 8, prefix: "b_", size: 1.2, ..Rig::default() });
    for facing_degrees in [0.0, 90.0] {
        let mut walker = build(&Rig { axes: 3, prefix: "a_", facing_degrees, ..Rig::default() });
        walk(&mut walker);
        let map = map(&model, &walker);
        let wanted = Retargeting::new(body(&model), body(&walker), 0, &map).unwrap().bake().unwrap().clip;
        let mut first: Option<Clip> = None;
        for step in 0..16 {
            let stride = resting_in_motion(&walker, step as f32 / 16.0);
            let source = Body { asset: &stride, slots: &walker.slots };
            let retargeting = Retargeting::new(body(&model), source, 0, &map).unwrap();
            let found = retargeting.bake().unwrap().clip;
            let worst = largest_degrees(&model.asset.skeleton, &wanted, &found);
            assert!(worst.0 < 18.0, "{facing_degrees}, {step}: {worst:?} degrees");
            let first = first.get_or_insert_with(|| found.clone());
            let other = largest_degrees(&model.asset.skeleton, first, &found);
            assert!(other.0 < 0.1, "{facing_degrees}, {step}: {other:?} degrees from the clip of another rest");
        }
    }
}

/// Motions without a skin, some of which rest in no usable pose.
const MOTIONS: [&str; 8] = [
    "cmu_01_01.bvh",
    "cosc422_Walk.bvh",
    "cosc422_Dance.bvh",
    "threejs_pirouette.bvh",
    "assimp_Boxing_Toes.bvh",
    "deepmotion_xia_neutral_16_000.bvh",
    "animateddrawings_fair1_zombie.bvh",
    "animateddrawings_rokoko_jesse_dance.bvh",
];

/// The directions of the limbs from joint to joint.
fn limbs(model: &Loaded, clip: &Clip, time_secs: f32) -> Vec<Vec3> {
    use Slot::{LeftFoot, LeftHand, LeftLowerArm, LeftLowerLeg, LeftUpperArm, LeftUpperLeg};
    let at = positions(&model.asset, clip, time_secs);
    let left = [LeftUpperArm, LeftLowerArm, LeftHand, LeftUpperLeg, LeftLowerLeg, LeftFoot];
    let sides =
        [left, left.map(Slot::mirrored)].map(|side| side.map(|slot| at[model.slots.joint(slot).unwrap().get()]));
    let limbs =
        sides.iter().flat_map(|side| [[side[0], side[1]], [side[1], side[2]], [side[3], side[4]], [side[4], side[5]]]);
    limbs.map(|[from, to]| (to - from).normalize()).collect()
}

#[test]
fn a_motion_does_the_same_wherever_it_begins() {
    with_pairs(&["human-male.glb", "Xbot.glb"], &MOTIONS, |model, motion, map| {
        let (skeleton, clip) = (&motion.asset.skeleton, &motion.asset.clips[motion.clip.unwrap()]);
        let baked = |asset: &Asset, clip: usize| {
            let source = Body { asset, slots: &motion.slots };
            Retargeting::new(model.body(), source, clip, &map).unwrap().bake().unwrap().clip
        };
        let wanted = baked(&motion.asset, motion.clip.unwrap());
        let from_secs = 0.4 * clip.duration_secs();
        let found = baked(&trimmed(skeleton, clip, from_secs), 0);
        for step in 0..=10 {
            let time = found.duration_secs() * step as f32 / 10.0;
            let [wanted, found] = [limbs(model, &wanted, time + from_secs), limbs(model, &found, time)];
            let angles = wanted.iter().zip(&found).map(|(wanted, found)| wanted.angle_between(*found).to_degrees());
            let worst = angles.fold(0.0, f32::max);
            assert!(worst < 3.0, "{} ← {}: {worst} degrees at {time}", model.name, motion.name);
        }
    });
}
