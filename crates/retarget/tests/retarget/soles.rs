//! Planted feet stand on the mesh below their joints, in proportion to the body.

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, Keys};
use gaitway_character::asset::{Asset, AssetParts, MeshInstance, Slot};
use gaitway_character::mesh::{Geometry, Mesh};
use gaitway_retarget::{Feet, ResolvedMap};
use glam::{Quat, Vec3};

use crate::feet::{retarget, walker};
use crate::figure::{Figure, Rig, build};
use crate::laws::map;

/// The underside of a shoe below the joint of a foot, in metres from it: toe, ball, heel.
const SHOE: [Vec3; 3] = [Vec3::new(0.0, -0.15, 0.2), Vec3::new(0.03, -0.15, 0.1), Vec3::new(0.0, -0.15, -0.08)];

/// Puts rigid shoes on the feet of a figure whose joints are not turned at rest.
fn with_shoes(mut figure: Figure) -> Figure {
    let feet = [Slot::LeftFoot, Slot::RightFoot].map(|slot| figure.joint(slot));
    let shoe = Geometry { positions: SHOE.to_vec(), indices: vec![0, 1, 2], ..Geometry::default() };
    let mesh = Mesh { primitives: vec![shoe], ..Mesh::default() };
    let instances = feet.map(|joint| MeshInstance::new(joint, 0, None)).to_vec();
    let parts = std::mem::take(&mut figure.asset).into_parts();
    figure.asset = Asset::new(AssetParts { meshes: vec![mesh], instances, ..parts }).unwrap();
    figure
}

/// Height of the lowest point of the left shoe.
fn shoe_height(figure: &Figure, clip: &Clip, time: f32) -> f64 {
    let (turn, position) = figure.world(clip, time)[figure.joint(Slot::LeftFoot).get()];
    SHOE.iter().map(|point| (position + turn * point.as_dvec3()).y).fold(f64::INFINITY, f64::min)
}

/// A body that stands still and rocks its feet on heel and toes.
fn rocking() -> Figure {
    let mut figure = build(&Rig::default());
    let mut clip = ClipBuilder::new("rock", &figure.asset.skeleton);
    let times: Vec<f32> = (0..=120).map(|frame| frame as f32 / 30.0).collect();
    let angle = |time: &f32| Quat::from_rotation_x(0.2 * (0.5 * std::f32::consts::PI * time).sin());
    for slot in [Slot::LeftFoot, Slot::RightFoot] {
        let keys = times.iter().map(angle).collect();
        clip.channel(figure.joint(slot), Interpolation::Linear, &times, Keys::Rotation(keys)).unwrap();
    }
    let clip = clip.build();
    figure.set_clip(clip);
    figure
}

#[test]
fn the_mesh_of_a_foot_stands_on_the_ground_however_the_foot_is_turned() {
    let motion = rocking();
    let model = with_shoes(build(&Rig::default()));
    let planted = ResolvedMap { feet: Feet::Plant, ..map(&model, &motion) };
    let (done, figures) = retarget(&model, &motion, &planted);
    // The ankle rests at 8 cm, 15 cm above the sole.
    let ground = 0.08 - 0.15;
    let mut highest: f64 = 0.0;
    for time in (0..=240).map(|frame| frame as f32 / 60.0) {
        let height = shoe_height(&model, &done.clip, time) - ground;
        assert!(height.abs() < 0.002, "{height} m at {time} s");
        highest = highest.max((shoe_height(&model, done.unplanted.as_ref().unwrap(), time) - ground).abs());
    }
    assert!(highest > 0.02, "nothing to plant: {highest}");
    let hover = figures.foot_hover_metres_mean.unwrap();
    assert!(hover.abs() < 0.001, "{hover}");
}

#[test]
fn hovering_is_the_height_of_the_mesh_or_without_one_of_the_joints() {
    let motion = walker(0.05);
    for model in [build(&Rig::default()), with_shoes(build(&Rig::default()))] {
        let (_, figures) = retarget(&model, &motion, &map(&model, &motion));
        let hover = figures.foot_hover_metres_mean.unwrap();
        assert!((hover - 0.05).abs() < 0.01, "{hover}");
    }
}

#[test]
fn a_motion_without_contacts_is_brought_to_the_ground() {
    let mut motion = build(&Rig::default());
    let hips = motion.joint(Slot::Hips);
    let rest = motion.asset.skeleton.rest().local(hips).translation;
    let times: Vec<f32> = (0..=30).map(|frame| frame as f32 / 30.0).collect();
    // It glides forward, 5 cm in the ground.
    let place = |time: &f32| rest + Vec3::new(0.0, -0.05, 2.0 * time);
    let mut clip = ClipBuilder::new("glide", &motion.asset.skeleton);
    clip.channel(hips, Interpolation::Linear, &times, Keys::Translation(times.iter().map(place).collect())).unwrap();
    let clip = clip.build();
    motion.set_clip(clip);
    let model = with_shoes(build(&Rig::default()));
    let planted = ResolvedMap { feet: Feet::Plant, ..map(&model, &motion) };
    let (done, _) = retarget(&model, &motion, &planted);
    let planting = done.planting.unwrap();
    assert_eq!((planting.contacts, planting.ground_metres_per_sec), (0, None));
    assert!((planting.lowered_metres + 0.05).abs() < 0.001, "{planting:?}");
    let lowest = (0..=60).map(|at| shoe_height(&model, &done.clip, at as f32 / 60.0)).fold(f64::INFINITY, f64::min);
    assert!((lowest + 0.07).abs() < 0.001, "{lowest}");
}

/// A body with shoes of twice the length bends its feet down by 40 degrees, as a runner whose heels come off the ground.
#[test]
fn long_feet_are_turned_level_instead_of_folding_the_legs() {
    let mut motion = build(&Rig::default());
    let mut clip = ClipBuilder::new("tiptoe", &motion.asset.skeleton);
    let times: Vec<f32> = (0..=60).map(|frame| frame as f32 / 30.0).collect();
    let pitch = |time: &f32| 0.7 * (0.5 * std::f32::consts::PI * time).sin().powi(2);
    for slot in [Slot::LeftFoot, Slot::RightFoot] {
        let keys = times.iter().map(|time| Quat::from_rotation_x(pitch(time))).collect();
        clip.channel(motion.joint(slot), Interpolation::Linear, &times, Keys::Rotation(keys)).unwrap();
    }
    let clip = clip.build();
    motion.set_clip(clip);
    let model = with_shoes(build(&Rig { leg_length: 0.5, ..Rig::default() }));
    let planted = ResolvedMap { feet: Feet::Plant, ..map(&model, &motion) };
    let (done, figures) = retarget(&model, &motion, &planted);
    let deepest = |clip: &Clip| {
        let ground = shoe_height(&model, clip, 0.0);
        (0..=60).map(|at| ground - shoe_height(&model, clip, at as f32 / 30.0)).fold(0.0, f64::max)
    };
    let before = deepest(done.unplanted.as_ref().unwrap());
    assert!(before > 0.08, "nothing to turn: {before}");
    assert!(figures.sole_penetration_metres_max.unwrap() < 0.01, "{figures:?}");
    assert!(figures.limb_direction_error_degrees_max.unwrap() < 15.0, "{figures:?}");
}

/// Standing with the feet together is crossing them for a model whose legs are longer and whose hips are narrower.
#[test]
fn feet_are_as_far_apart_as_the_sources_in_proportion_to_the_hips() {
    let mut motion = build(&Rig::default());
    let mut clip = ClipBuilder::new("together", &motion.asset.skeleton);
    for (slot, side) in [(Slot::LeftUpperLeg, -1.0), (Slot::RightUpperLeg, 1.0)] {
        let turn = Quat::from_rotation_z(side * 0.1);
        clip.channel(motion.joint(slot), Interpolation::Linear, &[0.0, 1.0], Keys::Rotation(vec![turn; 2])).unwrap();
    }
    let clip = clip.build();
    motion.set_clip(clip);
    // Legs of twice the length on the same hips.
    let model = build(&Rig { leg_length: 2.0, ..Rig::default() });
    let planted = ResolvedMap { feet: Feet::Plant, ..map(&model, &motion) };
    let (done, _) = retarget(&model, &motion, &planted);
    let apart = |figure: &Figure, clip: &Clip| {
        let world = figure.world(clip, 0.5);
        let at = |slot| world[figure.joint(slot).get()].1.x;
        (at(Slot::LeftFoot) - at(Slot::RightFoot)) / (at(Slot::LeftUpperLeg) - at(Slot::RightUpperLeg))
    };
    let source = apart(&motion, &motion.asset.clips[0]);
    let (before, after) = (apart(&model, done.unplanted.as_ref().unwrap()), apart(&model, &done.clip));
    assert!(source > 0.0 && before < -0.1, "nothing to keep apart: {source}, {before}");
    assert!((after - source).abs() < 0.03, "{after} instead of {source}");
}

/// Capture that loses its floor: the body rises by 18 cm and stays there for seconds. A jump of the same height is kept.
#[test]
fn a_body_that_floats_for_longer_than_a_jump_is_brought_down() {
    for (secs, lands) in [(6.0_f32, true), (0.6, false)] {
        let mut motion = build(&Rig::default());
        let hips = motion.joint(Slot::Hips);
        let rest = motion.asset.skeleton.rest().local(hips).translation;
        let times: Vec<f32> = (0..=300).map(|frame| frame as f32 / 30.0).collect();
        let rise = |time: &f32| {
            let edge = |at: f32| ((time - at) / 0.3).clamp(0.0, 1.0);
            rest + 0.18 * Vec3::Y * (edge(2.0) - edge(2.0 + secs))
        };
        let mut clip = ClipBuilder::new("rise", &motion.asset.skeleton);
        clip.channel(hips, Interpolation::Linear, &times, Keys::Translation(times.iter().map(rise).collect())).unwrap();
        let clip = clip.build();
        motion.set_clip(clip);
        let model = with_shoes(build(&Rig::default()));
        let planted = ResolvedMap { feet: Feet::Plant, ..map(&model, &motion) };
        let (done, _) = retarget(&model, &motion, &planted);
        let middle = shoe_height(&model, &done.clip, 2.15 + 0.5 * secs) - shoe_height(&model, &done.clip, 0.0);
        if lands {
            assert!(middle < 0.01, "{middle} m above the ground after {secs} s");
        } else {
            assert!(middle > 0.1, "a jump of {middle} m");
        }
    }
}
