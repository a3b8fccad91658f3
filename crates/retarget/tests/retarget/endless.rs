//! Clips of a few keys that last for ages, lie light years away, or repeat for ever: each is retargeted, measured and baked in a
//! bounded time. Without budgets, these tests don't end.

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, JointIndex, Keys};
use gaitway_character::asset::{Asset, AssetParts, Humanoid};
use gaitway_retarget::{
    Body, ClipLayer, ClipOverLayers, Contacts, Feet, LayerClip, Pair, ResolvedMap, RetargetError, Retargeting,
    StackedLayer, bake_layers, bake_stack, baking,
};
use glam::{Quat, Vec3};

use crate::contacts::with_boxes;
use crate::figure::{Figure, Rig};
use crate::laws::{body, map};
use crate::skeletons::{asset, chain};

/// The clip with its times and its translations multiplied.
fn stretched(figure: &Figure, time_factor: f32, factor: f32) -> Clip {
    let clip = &figure.asset.clips[0];
    let mut stretched = ClipBuilder::new(clip.name(), &figure.asset.skeleton);
    for channel in clip.channels() {
        let times: Vec<f32> =
            clip.timelines()[channel.timeline as usize].iter().map(|time| time * time_factor).collect();
        let keys = match channel.keys.clone() {
            Keys::Translation(places) => Keys::Translation(places.iter().map(|place| *place * factor).collect()),
            keys => keys,
        };
        stretched.channel(channel.joint, channel.interpolation, &times, keys).expect("a good channel");
    }
    stretched.build()
}

#[test]
fn ages_and_light_years_are_retargeted_and_measured() {
    let model = with_boxes(&Rig::default(), 0.22);
    for (time_factor, factor) in [(2e38, 1.0), (1e-6, 1.0), (1.0, 1e18), (1e5, 1e-18), (1.0, 1e36)] {
        let mut motion = with_boxes(&Rig::default(), 0.1);
        motion.dance(3, 60.0, Interpolation::Linear);
        motion.set_clip(stretched(&motion, time_factor, factor));
        let map = ResolvedMap { contacts: Contacts::Keep, feet: Feet::Plant, ..map(&model, &motion) };
        let pair = Retargeting::new(body(&model), body(&motion), 0, &map).expect("a map with pairs");
        // Numbers that no clip can hold are an error.
        let Ok(done) = pair.bake() else { continue };
        let figures = pair.figures(&done);
        assert!(figures.coverage.is_some(), "{time_factor} {factor}");
        assert!(done.keys_out < 1 << 20, "{time_factor} {factor}: {} keys", done.keys_out);
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
