//! Exports with fewer keys, measured against those with all of them.

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, JointIndex, Keys, Skeleton};
use gaitway_character::asset::Asset;
use gaitway_retarget::{KeyTolerance, fewer_keys};
use gaitway_scene::editor::ExportPlan;
use glam::{Quat, Vec3};

use super::editor;
use super::plan::{all_clips, clip, export, together};
use crate::read_back::world;

fn count(clip: &Clip) -> usize {
    clip.channels().iter().map(|channel| clip.timelines()[channel.timeline as usize].len()).sum()
}

/// The largest distance between joints of two files' clips, at many times.
fn distance(before: &Asset, after: &Asset, clips: [&Clip; 2]) -> f32 {
    let at = |step: u16| clips[0].duration_secs() * f32::from(step) / 1117.0;
    let apart = |step| {
        let (before, after) = (world(before, clips[0], at(step)), world(after, clips[1], at(step)));
        before.iter().zip(after).map(|(before, after)| before.distance(after)).fold(0.0, f32::max)
    };
    (0..=1117).map(apart).fold(0.0, f32::max)
}

#[test]
fn all_joints_stay_within_the_tolerance() {
    let editor = editor("sample:walker");
    let plan = all_clips(&editor);
    let before = together(&editor, &plan);
    let mut fewest: usize = before.clips.iter().map(count).sum();
    // The walker is less than two metres tall and wide.
    for (degrees, millimetres_per_metre) in [(0.01, 0.01), (0.1, 0.5), (2.0, 5.0)] {
        let tolerance = KeyTolerance { degrees, millimetres_per_metre };
        let thinned = ExportPlan { fewer_keys: Some(tolerance), ..plan.clone() };
        let file = export(&editor, &thinned);
        assert!(file.remark.is_some_and(|remark| remark.contains("keys, within") && remark.contains("Walk")));
        let after = together(&editor, &thinned);
        for (one, other) in before.clips.iter().zip(&after.clips) {
            assert_eq!((one.name(), one.duration_secs()), (other.name(), other.duration_secs()));
            let off = 1e3 * f64::from(distance(&before, &after, [one, other]));
            assert!(off <= 2.0 * millimetres_per_metre + 0.005, "{}: {off} mm", one.name());
        }
        let keys = after.clips.iter().map(count).sum();
        assert!(keys < fewest, "{keys} keys");
        fewest = keys;
    }
}

fn skeleton() -> Skeleton {
    crate::skeletons::asset(crate::skeletons::chain(["a", "b", "c"], Vec3::Y)).skeleton.clone()
}

#[test]
fn keys_on_a_line_and_values_that_hold_still_go() {
    let skeleton = skeleton();
    let times_secs: Vec<f32> = (0..50).map(|key| key as f32 / 30.0).collect();
    let (mut builder, rest) = (ClipBuilder::new("Line", &skeleton), skeleton.rest());
    let mut add = |joint: u32, interpolation, keys| {
        builder.channel(JointIndex(joint), interpolation, &times_secs, keys).expect("a channel");
    };
    let line = times_secs.iter().map(|secs| Quat::from_rotation_x(*secs)).collect();
    add(0, Interpolation::Linear, Keys::Rotation(line));
    let still = rest.local(JointIndex(1));
    add(1, Interpolation::Linear, Keys::Translation(vec![still.translation; 50]));
    add(1, Interpolation::Linear, Keys::Rotation(vec![Quat::from_rotation_z(0.5); 50]));
    let steps = times_secs.iter().map(|secs| Vec3::Y * (1.0 + secs.floor())).collect();
    add(2, Interpolation::Step, Keys::Translation(steps));
    let clip = builder.build();
    let thinned = fewer_keys(&skeleton, &clip, KeyTolerance::default());
    let kept = thinned.clip.channels().iter();
    let kept = kept.map(|channel| (channel.joint.0, thinned.clip.timelines()[channel.timeline as usize].len()));
    let kept: Vec<(u32, usize)> = kept.collect();
    assert_eq!(kept, [(0, 2), (1, 1), (2, 2)], "a line, a value that isn't the rest, a step");
    assert_eq!((thinned.keys_before, thinned.keys_after), (200, 5));
    assert_eq!(thinned.clip.duration_secs(), clip.duration_secs());
}

/// A clip that holds the rest is as long as before.
#[test]
fn a_clip_that_stands_still_keeps_its_length() {
    let skeleton = skeleton();
    let mut builder = ClipBuilder::new("Still", &skeleton);
    let keys = Keys::Rotation(vec![Quat::IDENTITY; 2]);
    builder.channel(JointIndex(1), Interpolation::Linear, &[0.0, 3.0], keys).expect("a channel");
    let thinned = fewer_keys(&skeleton, &builder.build(), KeyTolerance::default());
    assert_eq!((thinned.clip.duration_secs(), thinned.keys_after), (3.0, 2));
}

#[test]
fn keys_that_are_needed_stay() {
    let skeleton = skeleton();
    let clip = clip(&skeleton, "Noise", 7);
    let thinned = fewer_keys(&skeleton, &clip, KeyTolerance::default());
    assert_eq!(thinned.keys_after, count(&clip));
    assert!(thinned.error.degrees < 1e-9 && thinned.error.millimetres_per_metre == 0.0);
}
