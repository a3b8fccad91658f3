//! Lints for clips.

use gaitway_character::anim::{Channel, Clip, Interpolation, Keys, Pose, SampleCursor};
use gaitway_character::asset::{Asset, Warnings};
use gaitway_retarget::words;
use glam::{Quat, Vec3};

use super::{at_node, key_values, name};

/// Largest deviation of a rotation's length from 1, as in the Khronos validator: that of normalized bytes.
const UNIT_TOLERANCE: f32 = 0.007_69;

/// Reports rotation keys that aren't unit quaternions. Gaitway normalizes them, but not every program does.
pub(super) fn rotations(asset: &Asset, clip: &Clip, lints: &mut Warnings) {
    let mut first: Option<&Channel> = None;
    let mut count = 0;
    for channel in clip.channels() {
        let Keys::Rotation(values) = &channel.keys else { continue };
        let is_off = |rotation: &&Quat| (rotation.length() - 1.0).abs() > UNIT_TOLERANCE;
        let off = key_values(values, channel.interpolation).filter(is_off).count();
        count += off;
        if off > 0 {
            first.get_or_insert(channel);
        }
    }
    if let Some(channel) = first {
        let joint = name(asset, channel.joint);
        let problem =
            format!("clip “{}”: {count} rotation keys aren't unit quaternions, the first of {joint}", clip.name());
        lints.push(at_node(asset, "rotation-not-unit", channel.joint, problem));
    }
}

/// Clips with fewer keys, about 200 KB, aren't reported.
const MIN_KEYS: usize = 10_000;
/// Share of redundant keys from which a clip is reported.
const MIN_SPARE_SHARE: f32 = 0.8;
/// As √(1 − |a·b|), which is θ/√8 for a small angle θ: 0.08°.
const MAX_ROTATION_ERROR: f32 = 0.000_5;
/// Relative to the size of the skeleton.
const MAX_TRANSLATION_ERROR: f32 = 0.000_2;
const MAX_SCALE_ERROR: f32 = 0.000_5;
/// Maximum number of keys that one segment spans; bounds the work on long clips.
const MAX_RUN: usize = 32;

/// Reports clips that could lose most of their keys without a visible difference, all in one warning.
pub(super) fn density(asset: &Asset, lints: &mut Warnings) {
    let size = skeleton_size(asset);
    let found = asset.clips.iter().filter_map(|clip| Some((clip, spare_keys(clip, size)?)));
    let found: Vec<(&Clip, (f32, &Channel))> = found.collect();
    let Some((clip, (share, channel))) = found.iter().max_by(|a, b| a.1.0.total_cmp(&b.1.0)) else { return };
    let percent = (100.0 * share).floor();
    let problem = match found.len() {
        1 => {
            format!("clip “{}”: {percent:.0} % of its keys could be dropped without a visible difference", clip.name())
        }
        count => format!(
            "{count} clips have far more keys than needed: {percent:.0} % of those of “{}” could be dropped without a visible \
             difference",
            clip.name()
        ),
    };
    lints.push(at_node(asset, "keys-too-dense", channel.joint, problem));
}

/// Returns the share of a clip's keys that could be dropped, if it is large, and the channel that has most of them.
fn spare_keys(clip: &Clip, size: f32) -> Option<(f32, &Channel)> {
    let (mut keys, mut needed) = (0, 0);
    let mut densest: Option<(usize, &Channel)> = None;
    for channel in clip.channels().iter().filter(|channel| channel.interpolation == Interpolation::Linear) {
        let times = &clip.timelines()[channel.timeline as usize];
        let distance = |a: Vec3, b: Vec3| a.distance(b);
        let of_channel = match &channel.keys {
            Keys::Translation(values) => kept(times, values, Vec3::lerp, distance, MAX_TRANSLATION_ERROR * size),
            Keys::Scale(values) => kept(times, values, Vec3::lerp, distance, MAX_SCALE_ERROR),
            // `lerp` takes the shorter arc.
            Keys::Rotation(values) => {
                kept(times, values, Quat::lerp, |a, b| (1.0 - a.dot(b).abs()).max(0.0).sqrt(), MAX_ROTATION_ERROR)
            }
            Keys::MorphWeights { .. } => continue,
        };
        keys += times.len();
        needed += of_channel;
        let spare = times.len() - of_channel;
        if densest.is_none_or(|(most, _)| spare > most) {
            densest = Some((spare, channel));
        }
    }
    let share = 1.0 - needed as f32 / keys.max(1) as f32;
    densest.filter(|_| keys >= MIN_KEYS && share >= MIN_SPARE_SHARE).map(|(_, channel)| (share, channel))
}

/// Returns how many keys remain if each run of keys on a straight line is reduced to its ends.
fn kept<T: Copy>(
    times: &[f32],
    values: &[T],
    lerp: impl Fn(T, T, f32) -> T,
    distance: impl Fn(T, T) -> f32,
    tolerance: f32,
) -> usize {
    let Some(&first) = values.first() else { return 0 };
    if values.iter().all(|&value| distance(value, first) <= tolerance) {
        return 1;
    }
    let fits = |from: usize, to: usize| {
        (from + 1..to).all(|at| {
            let share = (times[at] - times[from]) / (times[to] - times[from]);
            distance(lerp(values[from], values[to], share), values[at]) <= tolerance
        })
    };
    let (mut count, mut from) = (1, 0);
    while from + 1 < values.len() {
        let last = (from + MAX_RUN).min(values.len() - 1);
        from = (from + 2..=last).take_while(|&to| fits(from, to)).last().unwrap_or(from + 1);
        count += 1;
    }
    count
}

/// Estimates the size of a body from its longest bone, which is about a fifth of the height of most.
fn skeleton_size(asset: &Asset) -> f32 {
    let rest = asset.skeleton.joints().filter_map(|joint| asset.skeleton.rest().get(joint));
    5.0 * rest.map(|rest| rest.translation.length()).filter(|length| length.is_finite()).fold(0.0, f32::max)
}

/// Words in the names of clips that are meant to loop.
const LOOP_WORDS: [&str; 14] = [
    "walk",
    "walking",
    "walkcycle",
    "run",
    "running",
    "idle",
    "loop",
    "cycle",
    "jog",
    "jogging",
    "sprint",
    "swim",
    "swimming",
    "trot",
];
/// Words in the names of clips that lead from one motion to another.
const TRANSITION_WORDS: [&str; 5] = ["transition", "start", "stop", "end", "to"];
/// Shorter clips hold a pose.
const MIN_LOOP_SECS: f32 = 0.2;
/// Smaller jumps aren't noticeable: 8°.
const MIN_JUMP_RADIANS: f32 = 0.14;
/// Jumps of fewer times the joint's step between frames aren't noticeable.
const MIN_JUMP_STEPS: f32 = 3.0;
/// Clips with larger jumps, 52°, aren't meant as loops, whatever their names.
const MAX_JUMP_RADIANS: f32 = 0.9;

/// Reports a clip that is named like a loop and nearly closes, but jumps from its last pose to its first.
pub(super) fn closure(asset: &Asset, clip: &Clip, lints: &mut Warnings) {
    let name_words = words(clip.name());
    let has_word_of = |list: &[&str]| name_words.iter().any(|word| list.contains(&word.as_str()));
    let duration_secs = clip.duration_secs();
    if duration_secs < MIN_LOOP_SECS || !has_word_of(&LOOP_WORDS) || has_word_of(&TRANSITION_WORDS) {
        return;
    }
    let frame_secs = (1.0 / clip.frames_per_sec()) as f32;
    let mut cursor = SampleCursor::default();
    let mut at = |time_secs: f32| {
        let mut pose: Pose = asset.skeleton.rest().clone();
        clip.sample(&asset.skeleton, time_secs, &mut cursor, &mut pose);
        pose
    };
    let (first, second) = (at(0.0), at(frame_secs));
    let (before, last) = (at(duration_secs - frame_secs), at(duration_secs));
    let mut worst = None;
    let mut largest = 0.0;
    for joint in clip.channels().iter().map(|channel| channel.joint) {
        let turn = |a: &Pose, b: &Pose| match (a.get(joint), b.get(joint)) {
            (Some(a), Some(b)) => a.rotation.angle_between(b.rotation),
            _ => 0.0,
        };
        let jump = turn(&last, &first);
        let step = turn(&first, &second).max(turn(&before, &last));
        if jump > largest && jump > MIN_JUMP_RADIANS && jump > MIN_JUMP_STEPS * step {
            (worst, largest) = (Some(joint), jump);
        }
    }
    if let Some(joint) = worst.filter(|_| largest < MAX_JUMP_RADIANS) {
        let problem = format!(
            "clip “{}” doesn't close: {} jumps by {:.0}° from the last frame to the first",
            clip.name(),
            name(asset, joint),
            largest.to_degrees()
        );
        lints.push(at_node(asset, "loop-open", joint, problem));
    }
}
