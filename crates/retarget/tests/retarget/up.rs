//! Which way is up in a motion: its rest, its clip or the map decides, and the model stands.

use gaitway_character::anim::{Clip, ClipBuilder, Keys};
use gaitway_character::asset::{Asset, AssetParts, Slot};
use gaitway_retarget::{Body, ResolvedMap, Retargeting, UpChoice};
use glam::{Quat, Vec3};

use crate::carriers::positions;
use crate::people::{Loaded, with_pairs};

/// Motions whose rest stands, and that walk, run or dance on their feet.
const MOTIONS: [&str; 6] = [
    "cosc422_Walk.bvh",
    "cosc422_Dance.bvh",
    "cmu_01_01.bvh",
    "threejs_pirouette.bvh",
    "deepmotion_xia_neutral_16_000.bvh",
    "assimp_Boxing_Toes.bvh",
];

/// The motion with its data turned so that Z is up, but not its rest, as exporters write it. The root may stay in a place instead.
fn turned(motion: &Loaded, place: Option<Vec3>) -> Asset {
    let turn = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    let skeleton = &motion.asset.skeleton;
    let clip = &motion.asset.clips[motion.clip.unwrap()];
    let mut builder = ClipBuilder::new(clip.name(), skeleton);
    for channel in clip.channels() {
        let times = &clip.timelines()[channel.timeline as usize];
        let is_root = skeleton.parent(channel.joint).is_none();
        let keys = match &channel.keys {
            Keys::Rotation(values) if is_root => Keys::Rotation(values.iter().map(|value| turn * *value).collect()),
            Keys::Translation(values) if is_root => {
                Keys::Translation(values.iter().map(|value| place.unwrap_or(turn * *value)).collect())
            }
            keys => keys.clone(),
        };
        builder.channel(channel.joint, channel.interpolation, times, keys).unwrap();
    }
    let (skeleton, clips) = (skeleton.clone(), vec![builder.build()]);
    Asset::new(AssetParts { skeleton, clips, ..AssetParts::default() }).unwrap()
}

fn baked(model: &Loaded, motion: &Loaded, asset: &Asset, map: &ResolvedMap) -> (Clip, bool) {
    let source = Body { asset, slots: &motion.slots };
    let pair = Retargeting::new(model.body(), source, 0, map).unwrap();
    (pair.bake().unwrap().clip, pair.motion_rest().is_up_doubtful)
}

/// How far joints of two clips are apart at most.
fn apart(asset: &Asset, [one, other]: [&Clip; 2]) -> f32 {
    let times = (0..=10).map(|at| one.duration_secs() * at as f32 / 10.0);
    let distances = times.flat_map(|time| {
        let [one, other] = [one, other].map(|clip| positions(asset, clip, time));
        one.into_iter().zip(other).map(|(one, other)| one.distance(other)).collect::<Vec<f32>>()
    });
    distances.fold(0.0, f32::max)
}

/// Data in which Z is up, below a rest that stands along Y, gives the same motion.
#[test]
fn the_clip_shows_which_way_is_up() {
    with_pairs(&["human-male.glb"], &MOTIONS, |model, motion, map| {
        let z_up = turned(motion, None);
        let (expected, _) = baked(model, motion, &motion.asset, &map);
        for up in [UpChoice::Auto, UpChoice::Z] {
            let mut map = map.clone();
            map.rest.up = up;
            let (found, is_doubtful) = baked(model, motion, &z_up, &map);
            let apart = apart(&model.asset, [&expected, &found]);
            assert!(apart < 0.01 && !is_doubtful, "{}, {up:?}: {apart} m", motion.name);
        }
        // As the map says, it lies.
        let mut as_it_rests = map;
        as_it_rests.rest.up = UpChoice::Y;
        let (lying, _) = baked(model, motion, &z_up, &as_it_rests);
        let apart = apart(&model.asset, [&expected, &lying]);
        assert!(apart > 0.5, "{}: {apart}", motion.name);
    });
}

/// Someone who lies above the ground isn't put on their feet, but it's said where these would be on the ground, too.
#[test]
fn a_body_on_the_ground_lies() {
    with_pairs(&["human-male.glb"], &MOTIONS, |model, motion, map| {
        let mut as_it_rests = map.clone();
        as_it_rests.rest.up = UpChoice::Y;
        let hips = motion.slots.joint(Slot::Hips).unwrap();
        let height = positions(&motion.asset, &motion.asset.clips[0], 0.0)[hips.get()].y;
        for (along, is_unclear) in [(0.0, false), (-2.0, false), (1.0, true)] {
            let lying = turned(motion, Some(height * Vec3::new(0.0, 0.8, along)));
            let (found, is_doubtful) = baked(model, motion, &lying, &map);
            let (expected, _) = baked(model, motion, &lying, &as_it_rests);
            let apart = apart(&model.asset, [&found, &expected]);
            assert_eq!((apart, is_doubtful), (0.0, is_unclear), "{}, {along}", motion.name);
        }
    });
}
