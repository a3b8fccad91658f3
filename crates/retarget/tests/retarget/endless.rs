//! Clips of a few keys that last for ages, lie light years away, or repeat for ever: each is retargeted, measured and baked in a
//! bounded time. Without budgets, these tests don't end.

use std::time::Instant;

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, Joint, JointIndex, Keys, Property, Transform};
use gaitway_character::asset::{Asset, AssetParts, Humanoid, Slot};
use gaitway_retarget::{
    Anatomy, Body, ClipChanges, ClipLayer, ClipOverLayers, Contacts, Feet, FitWarning, Keep, Layer, LayerClip, Pair,
    ResolvedMap, RetargetError, Retargeting, StackedLayer, bake_layers, bake_stack, baking, change_clip, layer_clips,
    recognize,
};
use glam::{Quat, Vec3};

use crate::contacts::with_boxes;
use crate::figure::{Figure, Rig};
use crate::laws::{body, map};
use crate::skeletons::{asset, chain, joint};

/// The clip with its times and its translations multiplied, and an offset added to these.
fn stretched(figure: &Figure, time_factor: f32, factor: f32, offset: f32) -> Clip {
    let clip = &figure.asset.clips[0];
    let mut stretched = ClipBuilder::new(clip.name(), &figure.asset.skeleton);
    for channel in clip.channels() {
        let times: Vec<f32> =
            clip.timelines()[channel.timeline as usize].iter().map(|time| time * time_factor).collect();
        let keys = match channel.keys.clone() {
            Keys::Translation(places) => {
                Keys::Translation(places.iter().map(|place| *place * factor + offset).collect())
            }
            keys => keys,
        };
        stretched.channel(channel.joint, channel.interpolation, &times, keys).expect("a good channel");
    }
    stretched.build()
}

#[test]
fn ages_and_light_years_are_retargeted_and_measured() {
    let model = with_boxes(&Rig::default(), 0.22);
    let cases = [
        (2e38, 1.0, 0.0),
        (1e-6, 1.0, 0.0),
        (1e-43, 1.0, 0.0),
        (1.0, 1e18, 0.0),
        (1e5, 1e-18, 0.0),
        (1.0, 1e36, 0.0),
        (1.0, 1.0, 1e30),
        (1.0, 1.0, 3.4e38),
    ];
    for (time_factor, factor, offset) in cases {
        let mut motion = with_boxes(&Rig::default(), 0.1);
        motion.dance(3, 60.0, Interpolation::Linear);
        motion.set_clip(stretched(&motion, time_factor, factor, offset));
        let map = ResolvedMap { contacts: Contacts::Keep, feet: Feet::Plant, ..map(&model, &motion) };
        let pair = Retargeting::new(body(&model), body(&motion), 0, &map).expect("a map with pairs");
        // Numbers that no clip can hold are an error.
        let Ok(done) = pair.bake() else { continue };
        let figures = pair.figures(&done);
        assert!(figures.coverage.is_some(), "{time_factor} {factor} {offset}");
        assert!(done.keys_out < 1 << 20, "{time_factor} {factor} {offset}: {} keys", done.keys_out);
    }
}

/// Planting and contacts hold poses of the model all along the motion, however few joints move.
#[test]
fn clips_of_too_many_poses_are_retargeted_without_corrections() {
    let Figure { asset: bald, slots, t_pose } = with_boxes(&Rig::default(), 0.1);
    let skeleton = &bald.skeleton;
    let joint = |joint: JointIndex| Joint {
        name: skeleton.name(joint).to_owned(),
        parent: skeleton.parent(joint).map(JointIndex::get),
        rest: skeleton.rest().local(joint),
        morph_weights: Vec::new(),
    };
    let hair = chain(["hair"], Vec3::Y).into_iter().map(|hair| Joint { parent: Some(0), ..hair }).next().expect("one");
    let joints = skeleton.joints().map(joint).chain(std::iter::repeat_n(hair, 4000)).collect();
    let model = Figure { asset: asset(joints), slots, t_pose };
    // A pose is looked at every thirtieth of a second.
    for (time_factor, is_too_long) in [(10.0, false), (60.0, true)] {
        let mut motion = with_boxes(&Rig::default(), 0.1);
        motion.dance(3, 60.0, Interpolation::Linear);
        motion.set_clip(stretched(&motion, time_factor, 1.0, 0.0));
        let map = ResolvedMap { contacts: Contacts::Keep, feet: Feet::Plant, ..map(&model, &motion) };
        let pair = Retargeting::new(body(&model), body(&motion), 0, &map).expect("a map with pairs");
        let done = pair.bake().expect("a clip");
        assert_eq!((done.planting.is_none(), done.unplanted.is_none()), (is_too_long, is_too_long), "{time_factor}");
        assert_eq!(FitWarning::of(&pair.figures(&done)).contains(&FitWarning::TooLong), is_too_long, "{time_factor}");
    }
}

/// Joints below each other by the ten thousand are read, but much of retargeting walks up from each of them.
#[test]
fn joints_that_are_nested_too_deep_are_refused() {
    let outcome = |count: usize| {
        let chained = asset(chain(std::iter::repeat_n("joint", count), Vec3::Y));
        let mut clip = ClipBuilder::new("turn", &chained.skeleton);
        let turns = Keys::Rotation(vec![Quat::IDENTITY, Quat::from_rotation_x(0.1)]);
        clip.channel(JointIndex(0), Interpolation::Linear, &[0.0, 1.0], turns).expect("a good channel");
        let clips = vec![clip.build()];
        let chained = Asset::new(AssetParts { clips, ..chained.into_parts() }).expect("a good asset");
        let pair = |joint| Pair { target: joint, source: joint, correction: Quat::IDENTITY };
        let pairs = chained.skeleton.joints().map(pair).collect();
        let map = ResolvedMap { pairs, ..ResolvedMap::default() };
        let slots = Humanoid::default();
        let body = || Body { asset: &chained, slots: &slots };
        Retargeting::new(body(), body(), 0, &map).map(|_| ())
    };
    assert_eq!(outcome(100_000), Err(RetargetError::TooDeep));
    assert_eq!(outcome(1000), Ok(()));
}

/// Work is proportional to the number of joints: if each were compared with each, this would take minutes.
#[test]
fn a_hundred_thousand_joints_are_retargeted_layered_and_changed_in_seconds() {
    let count = 100_000;
    let star = chain(std::iter::repeat_n("joint", count), Vec3::Y).into_iter();
    let star = asset(star.map(|joint| Joint { parent: joint.parent.map(|_| 0), ..joint }).collect());
    let mut clip = ClipBuilder::new("all", &star.skeleton);
    for joint in star.skeleton.joints() {
        let turns = Keys::Rotation(vec![Quat::IDENTITY, Quat::from_rotation_x(0.1)]);
        clip.channel(joint, Interpolation::Linear, &[0.0, 1.0], turns).expect("a good channel");
        let sizes = Keys::Scale(vec![Vec3::ONE, Vec3::splat(2.0)]);
        clip.channel(joint, Interpolation::Linear, &[0.0, 1.0], sizes).expect("a good channel");
    }
    let star = Asset::new(AssetParts { clips: vec![clip.build()], ..star.into_parts() }).expect("a good asset");
    let pair = |joint| Pair { target: joint, source: joint, correction: Quat::IDENTITY };
    // Every other joint is mapped, the rest plays a clip of the model.
    let (mapped, own): (Vec<_>, Vec<_>) = star.skeleton.joints().partition(|joint| joint.get() % 2 == 0);
    let map = ResolvedMap {
        pairs: mapped.into_iter().map(pair).collect(),
        layers: own.into_iter().map(|joint| Layer { joint, clip: 0, frozen: false }).collect(),
        muted: star.skeleton.joints().map(|joint| (joint, Property::Translation)).collect(),
        scales: Keep::Keep,
        ..ResolvedMap::default()
    };
    let slots = Humanoid::default();
    let body = || Body { asset: &star, slots: &slots };
    let begun = Instant::now();
    let pair = Retargeting::new(body(), body(), 0, &map).expect("a map with pairs");
    let retargeted = pair.bake().expect("a clip");
    pair.figures(&retargeted);
    let layers = layer_clips(&star, &map);
    let baked = bake_layers(&star, &retargeted.clip, &layers, &baking(&retargeted.clip, &layers, &[], None));
    assert_eq!(baked.channels().len(), 2 * count);
    let changes = ClipChanges { reverse: true, speed: 2.0, ..ClipChanges::NONE };
    let changed = change_clip(&star, &baked, &changes, || unreachable!("nothing is mirrored"));
    assert_eq!(changed.clip.channels().len(), 2 * count);
    let secs = begun.elapsed().as_secs();
    assert!(secs < 20, "{secs} s");
}

/// A joint that moves back and forth within so many seconds.
fn wave(figure: &Figure, joint: u32, secs: f32) -> Clip {
    let mut clip = ClipBuilder::new("wave", &figure.asset.skeleton);
    let keys = Keys::Translation(vec![Vec3::ZERO, Vec3::X, Vec3::ZERO]);
    clip.channel(JointIndex(joint), Interpolation::Linear, &[0.0, 0.5 * secs, secs], keys).expect("a good channel");
    clip.build()
}

#[test]
fn short_layers_below_and_over_long_clips_are_baked() {
    let figure = with_boxes(&Rig::default(), 0.1);
    for (clip_secs, layer_secs) in [(1e5, 1e-3), (3e38, 1e-30), (10.0, 1e-6)] {
        let (clip, short) = (wave(&figure, 0, clip_secs), wave(&figure, 1, layer_secs));
        let below = [LayerClip { clip: short.clone(), duration_secs: layer_secs, frozen: false }];
        for asked in [None, Some(1000)] {
            let chosen = baking(&clip, &below, &[], asked);
            let baked = bake_layers(&figure.asset, &clip, &below, &chosen);
            let keys: usize = baked.timelines().iter().map(Vec::len).sum();
            assert!(keys < 1 << 23, "{clip_secs} {layer_secs}: {keys} keys");
        }
        let layer = ClipLayer { speed: ClipLayer::MAX_SPEED, ..ClipLayer::default() };
        let source = ClipOverLayers { clip: &short, below: &[] };
        let included = vec![true; figure.asset.skeleton.len()];
        let baked = bake_stack(&figure.asset.skeleton, &clip, &[StackedLayer { layer: &layer, source, included }]);
        assert_eq!(baked.duration_secs(), clip_secs);
    }
}

/// Each helper is looked at a bounded number of times: if each were compared with each, this would take minutes.
#[test]
fn the_chains_of_a_body_with_a_hundred_thousand_helpers_are_found_in_seconds() {
    let figure = with_boxes(&Rig::default(), 0.1);
    let skeleton = &figure.asset.skeleton;
    let mut joints: Vec<Joint> = skeleton
        .joints()
        .map(|at| joint(skeleton.name(at), skeleton.parent(at).map(JointIndex::get), skeleton.rest().local(at)))
        .collect();
    let at = |slot: Slot| figure.slots.joint(slot).expect("a slot of the figure").get();
    let halfway = Transform::from_translation(0.5 * joints[at(Slot::LeftHand)].rest.translation);
    for number in 0..50_000 {
        // Beside the forearm, where twist joints are, and in a chain of others beside the body.
        joints.push(joint("twist", Some(at(Slot::LeftLowerArm)), halfway));
        let above = if number % 100 == 0 { None } else { Some(joints.len() - 2) };
        joints.push(joint("ik_hand_l", above, Transform::default()));
    }
    let star = asset(joints);
    let of_star = |&joint: &JointIndex| star.skeleton.joint_of_source(skeleton.source_index(joint));
    let slots = Humanoid(figure.slots.0.iter().filter_map(|(&slot, joint)| Some((slot, of_star(joint)?))).collect());
    let begun = Instant::now();
    let anatomy = Anatomy::new(&star, &slots);
    let found = recognize(&star);
    assert!(!anatomy.chains.is_empty() && found.joint(Slot::Hips).is_some());
    assert!(anatomy.twists.len() + anatomy.followers.len() < 1000);
    let secs = begun.elapsed().as_secs();
    assert!(secs < 20, "{secs} s");
}
