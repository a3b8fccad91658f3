//! Layers over a clip: their time, their masks, and the clip they are baked into.

use std::collections::BTreeMap;

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, JointMask, Keys, Pose, SampleCursor};
use gaitway_character::asset::{Humanoid, Slot};
use gaitway_retarget::{
    Body, BodyPart, ClipLayer, ClipOverLayers, LayerBuffers, LayerMask, LayerMode, StackedLayer, bake_stack,
};
use glam::{DQuat, DVec3, Quat, Vec3};

use crate::figure::{Figure, Rig, build};
use crate::laws::degrees;
use crate::skeletons::{asset, chain};

/// A figure with a clip, and another clip for it.
fn dancer(interpolation: Interpolation, armature: bool) -> (Figure, Clip) {
    let mut figure = build(&Rig { axes: 3, armature, doubled: vec![Slot::LeftLowerArm], ..Rig::default() });
    figure.dance(9, 50.0, interpolation);
    let other = figure.asset.clips[0].clone();
    figure.dance(5, 40.0, Interpolation::Linear);
    (figure, other)
}

fn included(figure: &Figure, mask: &LayerMask) -> Vec<bool> {
    mask.included(&Body { asset: &figure.asset, slots: &figure.slots })
}

/// The pose of the figure's clip with layers of another one.
fn played(figure: &Figure, other: &Clip, layers: &[ClipLayer], time_secs: f64) -> Pose {
    let skeleton = &figure.asset.skeleton;
    let mut pose = skeleton.rest().clone();
    figure.asset.clips[0].sample(skeleton, time_secs as f32, &mut SampleCursor::default(), &mut pose);
    for layer in layers {
        let mask = JointMask::new(skeleton, &included(figure, &layer.mask));
        let source = ClipOverLayers { clip: other, below: &[] };
        layer.apply(skeleton, source, &mask, time_secs, &mut LayerBuffers::default(), &mut pose);
    }
    pose
}

fn sampled(figure: &Figure, clip: &Clip, time_secs: f64) -> Pose {
    let mut pose = figure.asset.skeleton.rest().clone();
    clip.sample(&figure.asset.skeleton, time_secs as f32, &mut SampleCursor::default(), &mut pose);
    pose
}

fn arms() -> LayerMask {
    LayerMask::of_parts(&[BodyPart::LeftArm, BodyPart::RightArm])
}

#[test]
fn a_layer_runs_at_its_own_speed_from_its_start() {
    let (figure, other) = dancer(Interpolation::Linear, false);
    assert_eq!(other.duration_secs(), 1.5);
    let layer = ClipLayer { speed: 2.0, start_secs: 0.25, ..ClipLayer::default() };
    for (time_secs, expected) in [(0.25, 0.0), (0.5, 0.5), (0.0, 1.0), (1.0, 0.0), (1.25, 0.5)] {
        let found = played(&figure, &other, std::slice::from_ref(&layer), time_secs);
        assert_eq!(found, sampled(&figure, &other, expected), "{time_secs}");
    }
    let frozen = ClipLayer { speed: 0.0, ..ClipLayer::default() };
    assert_eq!(played(&figure, &other, &[frozen], 1.1), sampled(&figure, &other, 0.0));
}

#[test]
fn the_order_of_layers_matters() {
    let (figure, other) = dancer(Interpolation::Linear, false);
    let half = ClipLayer { weight: 0.5, ..ClipLayer::default() };
    let sum = ClipLayer { mode: LayerMode::Additive, start_secs: 0.4, ..ClipLayer::default() };
    let up = played(&figure, &other, &[half.clone(), sum.clone()], 0.6);
    let down = played(&figure, &other, &[sum.clone(), half], 0.6);
    assert_ne!(up, down);
    // A full override hides what is below it.
    let full = ClipLayer::default();
    let both = played(&figure, &other, &[sum, full], 0.6);
    assert_eq!(both, sampled(&figure, &other, 0.6));
}

#[test]
fn a_clip_that_rests_adds_nothing_to_the_rest() {
    let (figure, _) = dancer(Interpolation::Linear, true);
    let skeleton = &figure.asset.skeleton;
    let mut resting = ClipBuilder::new("rest", skeleton);
    for joint in skeleton.joints() {
        let rest = skeleton.rest().local(joint);
        for keys in [Keys::Rotation(vec![rest.rotation; 2]), Keys::Translation(vec![rest.translation; 2])] {
            resting.channel(joint, Interpolation::Linear, &[0.0, 1.0], keys).expect("valid");
        }
    }
    let resting = resting.build();
    for mode in [LayerMode::Additive, LayerMode::AdditiveToRest] {
        let layer = ClipLayer { mode, ..ClipLayer::default() };
        assert_eq!(played(&figure, &resting, &[layer], 0.7), sampled(&figure, &figure.asset.clips[0], 0.7), "{mode:?}");
    }
}

/// Local transforms in double precision: rotation and translation. No clip here animates scale.
type Locals = Vec<(DQuat, DVec3)>;

fn locals(pose: &Pose) -> Locals {
    pose.locals().map(|local| (local.rotation.as_dquat().normalize(), local.translation.as_dvec3())).collect()
}

fn nlerp(from: DQuat, to: DQuat, weight: f64) -> DQuat {
    let to = if from.dot(to) < 0.0 { -to } else { to };
    (from * (1.0 - weight) + to * weight).normalize()
}

/// Each layer changes the result of those below it.
#[test]
fn a_stack_matches_double_precision() {
    let (figure, other) = dancer(Interpolation::Linear, true);
    let duration_secs = f64::from(other.duration_secs());
    let over = ClipLayer { weight: 0.6, speed: 1.5, start_secs: 0.1, ..ClipLayer::default() };
    let sum = ClipLayer { weight: 0.7, mode: LayerMode::Additive, start_secs: 0.35, ..ClipLayer::default() };
    let to_rest = ClipLayer { weight: 0.4, mode: LayerMode::AdditiveToRest, mask: arms(), ..ClipLayer::default() };
    let layers = [over, sum, to_rest];
    let rest = locals(figure.asset.skeleton.rest());
    let first = locals(&sampled(&figure, &other, 0.0));
    for step in 0..30 {
        let time_secs = 1.5 * (f64::from(step) + 0.37) / 30.0;
        let mut expected = locals(&sampled(&figure, &figure.asset.clips[0], time_secs));
        for layer in &layers {
            let run_secs = ((time_secs - layer.start_secs) * layer.speed).rem_euclid(duration_secs);
            let to = locals(&sampled(&figure, &other, run_secs));
            let included = included(&figure, &layer.mask);
            for joint in (0..expected.len()).filter(|&joint| included[joint]) {
                let (own, to, weight) = (&mut expected[joint], to[joint], layer.weight);
                let from = if layer.mode == LayerMode::Additive { first[joint] } else { rest[joint] };
                *own = match layer.mode {
                    LayerMode::Override => (nlerp(own.0, to.0, weight), own.1.lerp(to.1, weight)),
                    LayerMode::Additive | LayerMode::AdditiveToRest => {
                        let turn = nlerp(DQuat::IDENTITY, to.0 * from.0.conjugate(), weight);
                        (turn * own.0, own.1 + (to.1 - from.1) * weight)
                    }
                };
            }
        }
        let found = locals(&played(&figure, &other, &layers, time_secs));
        for (joint, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let size = expected.1.length().max(1.0);
            assert!(degrees(found.0, expected.0) < 1e-3, "joint {joint} at {time_secs}");
            assert!(found.1.distance(expected.1) < 1e-6 * size, "joint {joint} at {time_secs}");
        }
    }
}

/// Every joint belongs to one part, and those between slots and beyond them to the nearest above.
#[test]
fn parts_of_the_body_cover_it_once() {
    let (figure, _) = dancer(Interpolation::Linear, true);
    let skeleton = &figure.asset.skeleton;
    let mut owners = vec![0; skeleton.len()];
    for (part, name) in BodyPart::ALL {
        let included = included(&figure, &LayerMask::of_parts(&[part]));
        for (&slot, joint) in &figure.slots.0 {
            assert_eq!(included[joint.get()], BodyPart::of(slot) == part, "{slot:?} and {name}");
        }
        for (owner, included) in owners.iter_mut().zip(included) {
            *owner += usize::from(included);
        }
    }
    assert!(owners.iter().all(|&parts| parts == 1), "{owners:?}");
    let arm = included(&figure, &LayerMask::of_parts(&[BodyPart::LeftArm]));
    assert!(arm[skeleton.find("extra_leftLowerArm").expect("is doubled").get()]);
    let hips = included(&figure, &LayerMask::of_parts(&[BodyPart::Hips]));
    assert!(hips[skeleton.find("Armature").expect("is on top").get()]);
}

#[test]
fn a_joint_brings_its_subtree() {
    let (figure, _) = dancer(Interpolation::Linear, true);
    let skeleton = &figure.asset.skeleton;
    let shoulder = figure.joint(Slot::LeftShoulder);
    let mut mask = LayerMask::default();
    assert!(mask.is_all() && included(&figure, &mask).iter().all(|&included| included));
    mask.joints.insert(skeleton.source_index(shoulder));
    let by_part = included(&figure, &LayerMask::of_parts(&[BodyPart::LeftArm]));
    assert_eq!(included(&figure, &mask), by_part);
    // One that the file lacks doesn't make it the whole body.
    let mut lacking = LayerMask::default();
    lacking.joints.insert(4000);
    assert!(!included(&figure, &lacking).contains(&true));
}

fn world(figure: &Figure, pose: &Pose) -> Vec<(DQuat, DVec3)> {
    let mut world: Vec<(DQuat, DVec3, f64)> = Vec::new();
    for (local, parent) in pose.locals().zip(figure.asset.skeleton.parents()) {
        let (turn, at, scale) = parent.map_or((DQuat::IDENTITY, DVec3::ZERO, 1.0), |parent| world[parent.get()]);
        let at = at + turn * (local.translation.as_dvec3() * scale);
        world.push(((turn * local.rotation.as_dquat()).normalize(), at, scale * f64::from(local.scale.x)));
    }
    world.into_iter().map(|(turn, at, _)| (turn, at)).collect()
}

fn key_count(clip: &Clip) -> usize {
    clip.channels().iter().map(|channel| clip.timelines()[channel.timeline as usize].len()).sum()
}

/// Bakes the layers, compares the clip with them on, beside and between its keys, and returns its number of keys.
fn check_baked(figure: &Figure, other: &Clip, layers: &[ClipLayer]) -> usize {
    let source = ClipOverLayers { clip: other, below: &[] };
    let stack: Vec<_> =
        layers.iter().map(|layer| StackedLayer { layer, source, included: included(figure, &layer.mask) }).collect();
    let clip = &figure.asset.clips[0];
    let baked = bake_stack(&figure.asset.skeleton, clip, &stack);
    let end_secs = clip.duration_secs();
    assert_eq!(baked.duration_secs(), end_secs);
    let mut keys: Vec<f32> = baked.timelines().concat();
    keys.sort_by(f32::total_cmp);
    keys.dedup();
    let mut times: Vec<f32> = (0..2000).map(|step| end_secs * (step as f32 + 0.37) / 2000.0).collect();
    times.extend(keys.iter().flat_map(|&key| [key.next_down(), key, key.next_up()]));
    times.extend(keys.windows(2).flat_map(|pair| [0.21, 0.47, 0.83].map(|part| pair[0] + part * (pair[1] - pair[0]))));
    times.retain(|time| (0.0..=end_secs).contains(time));
    // A layer that starts over at the very end does so after the clip.
    let starts_over = |layer: &ClipLayer| {
        let rounds = layer.period_secs(other).map_or(0.5, |period| (f64::from(end_secs) - layer.start_secs) / period);
        (rounds - rounds.round()).abs() < 1e-6
    };
    if layers.iter().any(starts_over) {
        times.retain(|&time| time < end_secs * (1.0 - 8.0 * f32::EPSILON));
    }
    // The figure is 1.6 m tall and 1.5 m wide at rest.
    for time in times.into_iter().map(f64::from) {
        let expected = world(figure, &played(figure, other, layers, time));
        let found = world(figure, &sampled(figure, &baked, time));
        for (expected, found) in expected.iter().zip(&found) {
            let between = expected.0.conjugate() * found.0;
            let turn = 2.0 * between.xyz().length().atan2(between.w.abs()).to_degrees();
            let distance = expected.1.distance(found.1);
            // Positions are stored as f32.
            let allowed = 1.6e-4_f64.max(4.0 * f64::from(f32::EPSILON) * expected.1.length());
            assert!(
                turn <= 0.05 && distance <= allowed,
                "off by {turn}° and {distance} m after {time} s of {end_secs} s"
            );
        }
    }
    key_count(&baked)
}

const KINDS: [Interpolation; 3] = [Interpolation::Linear, Interpolation::CubicSpline, Interpolation::Step];

#[test]
fn a_baked_stack_is_what_is_played() {
    for kind in KINDS {
        for armature in [false, true] {
            let (figure, other) = dancer(kind, armature);
            let whole = ClipLayer { weight: 0.4, ..ClipLayer::default() };
            let wave = ClipLayer { mask: arms(), speed: 1.3, start_secs: 0.2, ..ClipLayer::default() };
            let sum = ClipLayer { mode: LayerMode::Additive, weight: 0.7, start_secs: -0.3, ..ClipLayer::default() };
            let to_rest = ClipLayer { mode: LayerMode::AdditiveToRest, weight: 0.5, ..ClipLayer::default() };
            check_baked(&figure, &other, std::slice::from_ref(&whole));
            check_baked(&figure, &other, std::slice::from_ref(&wave));
            check_baked(&figure, &other, std::slice::from_ref(&sum));
            check_baked(&figure, &other, std::slice::from_ref(&to_rest));
            check_baked(&figure, &other, &[whole, sum, wave]);
        }
    }
}

/// A clip whose last key is a step shows its value at the end only.
#[test]
fn a_step_at_the_end_stays_a_step() {
    for kind in KINDS {
        let (mut figure, other) = dancer(kind, false);
        figure.dance(5, 40.0, Interpolation::Step);
        let sum = ClipLayer { mode: LayerMode::Additive, weight: 0.7, start_secs: 0.4, ..ClipLayer::default() };
        check_baked(&figure, &other, std::slice::from_ref(&sum));
        // A layer's own step, half-way through it, falls on the end.
        let (figure, other) = dancer(Interpolation::Step, false);
        let clips_end = f64::from(figure.asset.clips[0].duration_secs());
        for step in other.timelines().iter().map(|times| f64::from(times[1])) {
            check_baked(&figure, &other, &[ClipLayer { start_secs: clips_end - step, ..sum.clone() }]);
        }
    }
}

/// Layers that start over at times of their own, some of them together with the clip.
#[test]
fn loops_of_different_periods_are_baked() {
    for kind in KINDS {
        let (figure, other) = dancer(kind, false);
        for speed in [0.37, 1.0, 2.0, 3.7, 1.5 / 0.7] {
            let first = ClipLayer { weight: 0.6, speed, ..ClipLayer::default() };
            let late = ClipLayer { speed: 1.1, start_secs: 100.0 / 3.0, mask: arms(), ..first.clone() };
            check_baked(&figure, &other, &[first, late]);
        }
    }
}

/// Half-way between rotations, the shorter arc is another one as soon as they are more than 180° apart.
#[test]
fn a_change_of_the_shorter_arc_is_a_jump() {
    let (mut figure, _) = dancer(Interpolation::Linear, false);
    let joint = figure.joint(Slot::LeftUpperArm);
    let turning = |from_degrees: f32, to_degrees: f32| {
        let mut clip = ClipBuilder::new("Turn", &figure.asset.skeleton);
        let keys = [from_degrees, to_degrees].map(|degrees| Quat::from_rotation_x(degrees.to_radians()));
        clip.channel(joint, Interpolation::Linear, &[0.0, 2.0], Keys::Rotation(keys.to_vec())).unwrap();
        clip.build()
    };
    let (base, other) = (turning(-50.0, -110.0), turning(50.0, 110.0));
    figure.set_clip(base);
    let keys = check_baked(&figure, &other, &[ClipLayer { weight: 0.5, ..ClipLayer::default() }]);
    // One at each end and on each side of the jump. Others have no more than the one that they rest in.
    assert!(keys < 4 + figure.asset.skeleton.len(), "{keys} keys");
}

/// The same clip, elsewhere. Its keys aren't splines.
fn moved(figure: &Figure, clip: &Clip, by: Vec3) -> Clip {
    let mut moved = ClipBuilder::new(clip.name(), &figure.asset.skeleton);
    for channel in clip.channels() {
        let keys = match &channel.keys {
            Keys::Translation(places) => Keys::Translation(places.iter().map(|&place| place + by).collect()),
            keys => keys.clone(),
        };
        let times = &clip.timelines()[channel.timeline as usize];
        moved.channel(channel.joint, channel.interpolation, times, keys).unwrap();
    }
    moved.build()
}

/// 5 km from the origin, f32 rounds positions by more than what is allowed. That isn't taken for movement.
#[test]
fn far_from_the_origin_rounding_takes_no_keys() {
    let (mut figure, other) = dancer(Interpolation::Linear, false);
    let base = figure.asset.clips[0].clone();
    let half = ClipLayer { weight: 0.4, ..ClipLayer::default() };
    let wave = ClipLayer { mask: arms(), speed: 1.3, start_secs: 0.2, ..ClipLayer::default() };
    let sum = ClipLayer { mode: LayerMode::Additive, weight: 0.7, start_secs: -0.3, ..ClipLayer::default() };
    for layers in [vec![half.clone()], vec![sum.clone()], vec![half, sum, wave]] {
        figure.set_clip(base.clone());
        let near = check_baked(&figure, &other, &layers);
        let by = 5000.0 * Vec3::new(0.6, 0.0, -0.8);
        figure.set_clip(moved(&figure, &base, by));
        let far = check_baked(&figure, &moved(&figure, &other, by), &layers);
        assert!(far <= near, "{far} keys instead of {near}");
    }
}

/// What each joint of a long chain is off by adds up.
#[test]
fn a_long_chain_is_close_everywhere() {
    let names: Vec<String> = (0..41).map(|joint| joint.to_string()).collect();
    let asset = asset(chain(names.iter().map(String::as_str), Vec3::new(0.0, 0.04, 0.0)));
    let swinging = |degrees: f32| {
        let mut clip = ClipBuilder::new("Swing", &asset.skeleton);
        for joint in asset.skeleton.joints() {
            let turn = |degrees: f32| Quat::from_rotation_z(degrees.to_radians());
            let still = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
            let keys = [turn(degrees), turn(-0.5 * degrees), turn(degrees)].into_iter();
            let keys = Keys::Rotation(keys.flat_map(|key| [still, key, still]).collect());
            clip.channel(joint, Interpolation::CubicSpline, &[0.0, 0.7, 1.5], keys).unwrap();
        }
        clip.build()
    };
    let (base, other) = (swinging(2.0), swinging(-3.0));
    let mut figure = Figure { asset, slots: Humanoid::default(), t_pose: BTreeMap::new() };
    figure.set_clip(base);
    let sum = ClipLayer { mode: LayerMode::AdditiveToRest, speed: 1.7, ..ClipLayer::default() };
    check_baked(&figure, &other, &[sum]);
}

/// A clip without channels shows the rest pose, and nothing is left to hold the length of the one below.
#[test]
fn a_baked_rest_pose_lasts_as_long() {
    let (figure, _) = dancer(Interpolation::Linear, false);
    let rest = ClipBuilder::new("Rest", &figure.asset.skeleton).build();
    assert_eq!(check_baked(&figure, &rest, &[ClipLayer::default()]), 2);
}

/// Joints outside all masks keep the file's keys, and a full override needs hardly more keys than its clip has.
#[test]
fn baking_adds_few_keys() {
    let (figure, other) = dancer(Interpolation::Linear, false);
    let clip = &figure.asset.clips[0];
    let wave = ClipLayer { mask: arms(), ..ClipLayer::default() };
    let source = ClipOverLayers { clip: &other, below: &[] };
    let stack = [StackedLayer { layer: &wave, source, included: included(&figure, &wave.mask) }];
    let baked = bake_stack(&figure.asset.skeleton, clip, &stack);
    let of = |clip: &Clip, slot| {
        let joint = figure.joint(slot);
        let channels = clip.channels().iter().filter(move |channel| channel.joint == joint);
        channels
            .map(|channel| (clip.timelines()[channel.timeline as usize].clone(), channel.keys.clone()))
            .collect::<Vec<_>>()
    };
    for slot in [Slot::Hips, Slot::LeftFoot, Slot::Head] {
        assert_eq!(of(&baked, slot), of(clip, slot), "{slot:?}");
    }
    for slot in [Slot::LeftUpperArm, Slot::RightHand] {
        assert_eq!(of(&baked, slot)[0].0.len(), of(&other, slot)[0].0.len(), "{slot:?}");
    }
    // A layer without effect leaves the clip alone.
    let none = ClipLayer { weight: 0.0, ..wave.clone() };
    let stack = [StackedLayer { layer: &none, source, included: included(&figure, &none.mask) }];
    assert_eq!(key_count(&bake_stack(&figure.asset.skeleton, clip, &stack)), key_count(clip));
}
