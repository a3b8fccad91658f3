//! Planted feet, on a walking figure whose feet would slide.

use std::collections::BTreeMap;

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, Keys};
use gaitway_character::asset::Slot;
use gaitway_retarget::{Feet, Figures, ResolvedMap, RestChoice, Retargeted, Retargeting, RootPart, propose, recognize};
use glam::{Quat, Vec3};

use crate::data_folder::data_folder;
use crate::figure::{Figure, Rig, build};
use crate::laws::{body, map};
use crate::people::largest_excess_turn;
use crate::real::read;

/// How a figure walks.
struct Walk {
    /// Height of the whole clip above the ground.
    lift: f32,
    /// If false, it walks on the spot.
    travels: bool,
    /// How far the knee of the supporting leg is bent, in radians; below 0, the other way.
    knee: f32,
}

pub fn walker(lift: f32) -> Figure {
    walking(&Walk { lift, travels: true, knee: 0.02 })
}

/// Two steps of a second each: one foot stays in contact while the body passes over it and the other leg swings.
fn walking(walk: &Walk) -> Figure {
    let mut figure = build(&Rig::default());
    let skeleton = &figure.asset.skeleton;
    let mut clip = ClipBuilder::new("walk", skeleton);
    let times: Vec<f32> = (0..=60).map(|frame| frame as f32 / 30.0).collect();
    let hips = figure.joint(Slot::Hips);
    let (rest, length) = (skeleton.rest().local(hips).translation, 0.87f32);
    // The supporting leg turns from +20° to −20°; the hips follow so that its ankle stays.
    let angle = |time: f32, phase: f32| {
        let at = (time + phase).rem_euclid(2.0);
        let degrees: f32 = if at < 1.0 { 20.0 - 40.0 * at } else { -20.0 + 40.0 * (at - 1.0) };
        degrees.to_radians()
    };
    let mut forward = 0.0f32;
    let mut places = Vec::new();
    for (index, &time) in times.iter().enumerate() {
        let supporting = if time.rem_euclid(2.0) < 1.0 { 0.0 } else { 1.0 };
        if index > 0 {
            let before = angle(times[index - 1], supporting).sin();
            forward += length * (before - angle(time, supporting).sin());
        }
        let down = length * (1.0 - angle(time, supporting).cos());
        let travelled = if walk.travels { forward } else { 0.0 };
        places.push(rest + Vec3::new(0.0, walk.lift - down, travelled));
    }
    clip.channel(hips, Interpolation::Linear, &times, Keys::Translation(places)).unwrap();
    for (upper, foot, phase) in [(Slot::LeftUpperLeg, Slot::LeftFoot, 0.0), (Slot::RightUpperLeg, Slot::RightFoot, 1.0)]
    {
        let knee = match upper {
            Slot::LeftUpperLeg => Slot::LeftLowerLeg,
            _ => Slot::RightLowerLeg,
        };
        // A bent knee lifts the swinging foot, which stays level.
        let bend = |time: f32| {
            let at = (time + phase).rem_euclid(2.0);
            if at < 1.0 { walk.knee } else { walk.knee + 0.9 * ((at - 1.0) * std::f32::consts::PI).sin() }
        };
        let mut add = |slot, radians: &dyn Fn(f32) -> f32| {
            let keys = times.iter().map(|&time| Quat::from_rotation_x(radians(time))).collect();
            clip.channel(figure.joint(slot), Interpolation::Linear, &times, Keys::Rotation(keys)).unwrap();
        };
        add(upper, &|time| -angle(time, phase));
        add(knee, &bend);
        add(foot, &|time| angle(time, phase) - bend(time));
    }
    let clip = clip.build();
    figure.set_clip(clip);
    figure
}

pub fn retarget(model: &Figure, motion: &Figure, map: &ResolvedMap) -> (Retargeted, Figures) {
    let pair = Retargeting::new(body(model), body(motion), 0, map).unwrap();
    let done = pair.bake().unwrap();
    let figures = pair.figures(&done);
    (done, figures)
}

#[test]
fn planting_stops_the_sliding_of_legs_of_another_length() {
    let motion = walker(0.0);
    // Legs whose length the hip height doesn't account for.
    let model = build(&Rig { axes: 3, leg_length: 0.6, size: 1.4, armature: true, ..Rig::default() });
    let plain = map(&model, &motion);
    let (_, sliding) = retarget(&model, &motion, &plain);
    let planted = ResolvedMap { feet: Feet::Plant, ..plain.clone() };
    let (done, standing) = retarget(&model, &motion, &planted);
    let (before, after) = (sliding.foot_slide_metres_per_sec.unwrap(), standing.foot_slide_metres_per_sec.unwrap());
    assert!(before > 0.01 && after < 0.2 * before, "{before} → {after}");
    assert!(done.unplanted.is_some());
    assert!(standing.orientation_error_degrees_mean.unwrap() < 0.01, "measured without planted feet");
    // Knees bend the same way as before.
    for frame in 0..=60 {
        let world = model.world(&done.clip, frame as f32 / 30.0);
        let at = |slot| world[model.joint(slot).get()].1;
        let (hip, knee, ankle) = (at(Slot::LeftUpperLeg), at(Slot::LeftLowerLeg), at(Slot::LeftFoot));
        assert!((knee - hip).cross(ankle - knee).x > -1e-3, "frame {frame}");
    }
}

#[test]
fn feet_of_a_walk_stopped_by_the_map_are_planted_on_the_moving_ground() {
    let motion = walker(0.0);
    let model = build(&Rig { axes: 3, leg_length: 0.6, ..Rig::default() });
    let mut plain = map(&model, &motion);
    plain.root.horizontal = RootPart::InPlace;
    let planted = ResolvedMap { feet: Feet::Plant, ..plain.clone() };
    let (_, sliding) = retarget(&model, &motion, &plain);
    let (_, standing) = retarget(&model, &motion, &planted);
    assert!(standing.foot_slide_metres_per_sec.unwrap() < 0.5 * sliding.foot_slide_metres_per_sec.unwrap());
}

#[test]
fn feet_that_hover_or_sink_are_brought_to_the_ground() {
    // The last is higher than any hover, but a floor that every contact shares.
    for lift in [0.12, -0.08, 0.75] {
        let motion = walker(lift);
        let model = build(&Rig { axes: 3, size: 1.4, armature: true, ..Rig::default() });
        let planted = ResolvedMap { feet: Feet::Plant, ..map(&model, &motion) };
        let (done, _) = retarget(&model, &motion, &planted);
        let height = |clip, time: f32| model.world(clip, time)[model.joint(Slot::LeftToes).get()].1.y;
        let rest = 1.4 * 0.02;
        for time in (3..27).map(|frame| frame as f32 / 30.0) {
            let before = height(done.unplanted.as_ref().unwrap(), time) - rest;
            let after = height(&done.clip, time) - rest;
            assert!((before - 1.4 * f64::from(lift)).abs() < 0.02, "{before} m off the ground at {time} s, unplanted");
            assert!(after.abs() < 0.002, "{after} m off the ground at {time} s, planted");
        }
    }
}

#[test]
fn planting_leaves_good_contacts_alone() {
    let motion = walker(0.0);
    let mut same = map(&motion, &motion);
    same.rest.model = RestChoice::Node;
    same.feet = Feet::Plant;
    let (_, figures) = retarget(&motion, &motion, &same);
    let (ours, theirs) =
        (figures.foot_slide_metres_per_sec.unwrap(), figures.foot_slide_source_metres_per_sec.unwrap());
    assert!(ours <= theirs + 1e-3, "{ours} against {theirs}");
    assert!(figures.limb_direction_error_degrees_mean.unwrap() < 1.0, "{figures:?}");
}

/// In a nearly straight leg, millimetres of the foot's position turn the knee by degrees, so that it twitches.
#[test]
fn a_planted_leg_is_hardly_straighter_than_before() {
    let Some(folder) = data_folder() else { return };
    let real = |file| {
        let asset = read(&folder, file);
        Figure { slots: recognize(&asset).humanoid(), asset, t_pose: BTreeMap::new() }
    };
    let (model, motion) = (real("threejs/Soldier.glb"), real("bvh/cmu_01_01.bvh"));
    let proposed = propose(&model.asset, &motion.asset).to_map(&model.asset, &motion.asset);
    let map = ResolvedMap { feet: Feet::Plant, ..proposed.resolve(&model.asset, &motion.asset).unwrap() };
    let (done, _) = retarget(&model, &motion, &map);
    let legs = [
        [Slot::LeftUpperLeg, Slot::LeftLowerLeg, Slot::LeftFoot],
        [Slot::RightUpperLeg, Slot::RightLowerLeg, Slot::RightFoot],
    ];
    // 1 for a straight leg.
    let reach = |clip: &Clip, time: f32| {
        let world = model.world(clip, time);
        legs.map(|leg| {
            let [hip, knee, ankle] = leg.map(|slot| world[model.joint(slot).get()].1);
            hip.distance(ankle) / (hip.distance(knee) + knee.distance(ankle))
        })
    };
    let mut straightest: f64 = 0.0;
    for time in (0..22 * 30).map(|frame| frame as f32 / 30.0) {
        let (before, after) = (reach(done.unplanted.as_ref().unwrap(), time), reach(&done.clip, time));
        for (before, after) in before.into_iter().zip(after) {
            assert!(after < before.max(0.99) + 0.003, "{before} became {after} at {time} s");
            straightest = straightest.max(after);
        }
    }
    assert!(straightest > 0.98, "it never walks: {straightest}");
}

#[test]
fn a_walk_in_place_is_planted_on_a_treadmill() {
    let motion = walking(&Walk { lift: -0.1, travels: false, knee: 0.02 });
    let model = build(&Rig { size: 1.4, leg_length: 0.8, ..Rig::default() });
    let planted = ResolvedMap { feet: Feet::Plant, ..map(&model, &motion) };
    let (done, figures) = retarget(&model, &motion, &planted);
    let planting = done.planting.unwrap();
    // The foot goes from 20° before the hips to 20° behind them in a second.
    let speed = done.hips_scale.unwrap() * 2.0 * 0.87 * 20f64.to_radians().sin();
    let found = planting.ground_metres_per_sec.unwrap();
    assert!((found - speed).abs() < 0.06 * speed, "{found} m/s instead of {speed}");
    assert!(planting.contacts >= 2, "{planting:?}");
    assert!(figures.foot_slide_metres_per_sec.unwrap() < 0.05, "{figures:?}");
    assert!(figures.foot_hover_metres_mean.unwrap().abs() < 0.005, "{figures:?}");
    // The clip repeats without a jump.
    let ends = [0.0, 2.0].map(|time| model.world(&done.clip, time));
    let gap = ends[0].iter().zip(&ends[1]).map(|(first, last)| first.1.distance(last.1)).fold(0.0, f64::max);
    assert!(gap < 0.002, "{gap} m");
}

/// The same clip, jumping from key to key.
fn stepped(mut figure: Figure) -> Figure {
    let clip = &figure.asset.clips[0];
    let mut builder = ClipBuilder::new("stepped", &figure.asset.skeleton);
    for channel in clip.channels() {
        let times = &clip.timelines()[channel.timeline as usize];
        builder.channel(channel.joint, Interpolation::Step, times, channel.keys.clone()).unwrap();
    }
    let clip = builder.build();
    figure.set_clip(clip);
    figure
}

#[test]
fn feet_are_planted_without_hips() {
    let motion = walker(0.0);
    let model = build(&Rig { leg_length: 0.8, ..Rig::default() });
    let mut planted = ResolvedMap { feet: Feet::Plant, ..map(&model, &motion) };
    planted.pairs.retain(|pair| pair.target != model.joint(Slot::Hips));
    let (done, _) = retarget(&model, &motion, &planted);
    let positions = (0..=60).flat_map(|at| model.world(&done.clip, at as f32 / 30.0));
    assert!(positions.into_iter().all(|(turn, position)| turn.is_finite() && position.is_finite()));
}

/// Legs that are too short for their steps, and knees that bend a little the wrong way: neither may snap.
#[test]
fn planting_turns_no_leg_faster_than_its_source_by_5_degrees_a_frame() {
    for knee in [0.02, -0.05, 0.0] {
        let mut motion = walking(&Walk { lift: 0.0, travels: true, knee });
        for leg_length in [0.5, 0.7, 1.3, 0.6] {
            if leg_length == 0.6 {
                motion = stepped(motion);
            }
            let model = build(&Rig { axes: 3, leg_length, ..Rig::default() });
            let planted = ResolvedMap { feet: Feet::Plant, ..map(&model, &motion) };
            let (done, _) = retarget(&model, &motion, &planted);
            let clips = [&done.clip, &motion.asset.clips[0]];
            let excess = largest_excess_turn([&model.asset, &motion.asset], clips, &planted, &model.slots);
            assert!(excess < 5.0, "{excess}° with legs of {leg_length}, knees at {knee}");
        }
    }
}
