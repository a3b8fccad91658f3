//! Laws of changed clips on real characters, whose rests are neither symmetric nor all turned one way.

use std::mem::discriminant;
use std::path::Path;

use gaitway_character::anim::{
    Channel, Clip, ClipBuilder, Interpolation, Keys, Pose, SampleCursor, Skeleton, TimeRange, model_from_joint,
};
use gaitway_retarget::{ClipChanges, Symmetry, change_clip, recognize};
use glam::{Affine3A, DMat3, DVec3, Vec3};

use crate::data_folder::data_folder;
use crate::people::{Loaded, load_people, model_rotations};

const NONE: ClipChanges = ClipChanges::NONE;

/// One clip of a character.
struct Case<'a> {
    name: String,
    person: &'a Loaded,
    clip: &'a Clip,
}

impl Case<'_> {
    fn changed(&self, clip: &Clip, changes: &ClipChanges) -> Clip {
        let asset = &self.person.asset;
        change_clip(asset, clip, changes, || Symmetry::of(asset, &recognize(asset))).clip
    }

    /// The clip changed once, and once more.
    fn changed_twice(&self, changes: &ClipChanges) -> [Clip; 2] {
        let once = self.changed(self.clip, changes);
        let twice = self.changed(&once, changes);
        [once, twice]
    }

    fn skeleton(&self) -> &Skeleton {
        &self.person.asset.skeleton
    }
}

/// Passes every clip of every character on, and fails with what was found wrong.
fn in_each_clip(folder: &Path, mut check: impl FnMut(&Case) -> Result<(), String>) {
    let people = load_people(folder);
    let (mut count, mut problems) = (0, Vec::new());
    for person in &people {
        for clip in person.asset.clips.iter().filter(|clip| clip.duration_secs() > 0.0) {
            count += 1;
            let case = Case { name: format!("{} {}", person.name, clip.name()), person, clip };
            problems.extend(check(&case).err().map(|problem| format!("{}: {problem}", case.name)));
        }
    }
    assert_eq!(problems, Vec::<String>::new());
    assert!(count > 140, "{count} clips");
}

/// The numbers of a key with its tangents, and how large numbers of its kind are.
fn numbers(keys: &Keys) -> (Vec<f32>, f32) {
    let flat = |values: &[Vec3]| values.iter().flat_map(|value| value.to_array()).collect::<Vec<f32>>();
    let values = match keys {
        Keys::Translation(values) | Keys::Scale(values) => flat(values),
        Keys::Rotation(values) => values.iter().flat_map(|value| value.to_array()).collect(),
        Keys::MorphWeights { values, .. } => values.clone(),
    };
    let size = values.iter().fold(1e-6_f32, |size, value| size.max(value.abs()));
    (values, size)
}

/// The channel of the same target; a later one overrides an earlier one.
fn counterpart<'a>(clip: &'a Clip, channel: &Channel) -> Option<&'a Channel> {
    let kind = discriminant(&channel.keys);
    clip.channels().iter().rfind(|found| found.joint == channel.joint && discriminant(&found.keys) == kind)
}

fn times_of<'a>(clip: &'a Clip, channel: &Channel) -> &'a [f32] {
    &clip.timelines()[channel.timeline as usize]
}

/// Compares clips key by key: the same channels with the same times, and values that differ by a share of their size at most.
fn same_keys(one: &Clip, other: &Clip, tolerance: f32) -> Result<(), String> {
    for channel in one.channels() {
        let Some(expected) = counterpart(one, channel) else { continue };
        let found = counterpart(other, channel).ok_or("a channel is missing")?;
        let (before, after) = (times_of(one, expected), times_of(other, found));
        let is_close = |(a, b): (&f32, &f32)| (a - b).abs() <= tolerance * one.duration_secs();
        if before.len() != after.len() || !before.iter().zip(after).all(is_close) {
            return Err(format!("joint {:?} has keys at other times", channel.joint));
        }
        let ((before, size), (after, _)) = (numbers(&expected.keys), numbers(&found.keys));
        let largest = before.iter().zip(&after).map(|(a, b)| (a - b).abs() / size).fold(0.0, f32::max);
        if largest > tolerance {
            return Err(format!("joint {:?} differs by {largest}", channel.joint));
        }
    }
    Ok(())
}

/// The keys of `one` between two times are keys of `other`, with the same values, `later` seconds later.
fn keeps_keys(one: &Clip, other: &Clip, [start, end]: [f32; 2], later: f32) -> Result<(), String> {
    for channel in one.channels() {
        let Some(expected) = counterpart(one, channel) else { continue };
        let found = counterpart(other, channel).ok_or("a channel is missing")?;
        let (before, after) = (times_of(one, expected), times_of(other, found));
        let ((values, _), (kept, _)) = (numbers(&expected.keys), numbers(&found.keys));
        let stride = values.len() / before.len();
        for (key, time) in before.iter().enumerate().filter(|(_, time)| (start..=end).contains(*time)) {
            let wanted = time + later;
            let same = after.iter().position(|time| (time - wanted).abs() <= 1e-6 * one.duration_secs());
            let same = same.ok_or(format!("joint {:?} lost its key at {time} s", channel.joint))?;
            if values[key * stride..][..stride] != kept[same * stride..][..stride] {
                return Err(format!("joint {:?} has another key at {time} s", channel.joint));
            }
        }
    }
    Ok(())
}

fn key_count(clip: &Clip, channel: &Channel) -> usize {
    counterpart(clip, channel).map_or(0, |channel| times_of(clip, channel).len())
}

/// The largest distance between a joint's positions in two clips, as a share of the character's size.
fn apart(skeleton: &Skeleton, one: (&Clip, f32), other: (&Clip, f32)) -> f64 {
    let [before, after] = [one, other].map(|(clip, time)| places(skeleton, clip, time));
    let extent = before.iter().fold([DVec3::MAX, DVec3::MIN], |[low, high], &at| [low.min(at), high.max(at)]);
    let size = (extent[1] - extent[0]).max_element();
    before.iter().zip(&after).map(|(a, b)| a.distance(*b) / size).fold(0.0, f64::max)
}

fn at_most(value: f64, max: f64, what: &str) -> Result<(), String> {
    if value <= max { Ok(()) } else { Err(format!("{what}: {value}")) }
}

fn times(clip: &Clip) -> impl Iterator<Item = f32> + use<> {
    let duration_secs = clip.duration_secs();
    (0..8).map(move |step| duration_secs * (step as f32 + 0.37) / 8.0)
}

fn places(skeleton: &Skeleton, clip: &Clip, time_secs: f32) -> Vec<DVec3> {
    let (mut pose, mut world): (Pose, _) = (skeleton.rest().clone(), Vec::new());
    clip.sample(skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
    model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut world);
    world.iter().map(|joint| Vec3::from(joint.translation).as_dvec3()).collect()
}

/// An angle between rotations given as matrices without scale, in degrees.
fn degrees(one: DMat3, other: DMat3) -> f64 {
    let turn = one.transpose() * other;
    let cosine = 0.5 * (turn.x_axis.x + turn.y_axis.y + turn.z_axis.z - 1.0);
    let sine = DVec3::new(turn.y_axis.z - turn.z_axis.y, turn.z_axis.x - turn.x_axis.z, turn.x_axis.y - turn.y_axis.x);
    (0.5 * sine.length()).atan2(cosine).to_degrees()
}

#[test]
fn every_clip_mirrored_twice_is_the_clip() {
    let Some(folder) = data_folder() else { return };
    let mirror = ClipChanges { mirror: true, ..NONE };
    in_each_clip(&folder, |case| {
        let [_, twice] = case.changed_twice(&mirror);
        same_keys(case.clip, &twice, 1e-6)?;
        let apart = times(case.clip).map(|time| apart(case.skeleton(), (case.clip, time), (&twice, time)));
        at_most(apart.fold(0.0, f64::max), 1e-6, "positions are apart by this share of the size")
    });
}

/// In model space, a joint has turned away from its rest as the mirror image of its counterpart: S A S for a reflection S.
#[test]
fn every_clip_is_mirrored_about_its_own_plane() {
    let Some(folder) = data_folder() else { return };
    in_each_clip(&folder, |case| {
        let asset = &case.person.asset;
        let mirrored = case.changed(case.clip, &ClipChanges { mirror: true, ..NONE });
        let left = recognize(asset).facing.left.ok_or("has no left side")?.as_dvec3();
        let normal = (left * DVec3::new(1.0, 0.0, 1.0)).normalize();
        let reflection =
            DMat3::IDENTITY - 2.0 * DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        let rest = ClipBuilder::new("", case.skeleton()).build();
        let rest = model_rotations(case.skeleton(), &rest, 0.0);
        for time in times(case.clip) {
            let away = |clip: &Clip| -> Vec<DMat3> {
                let turned = model_rotations(case.skeleton(), clip, time);
                turned.iter().zip(&rest).map(|(now, rest)| DMat3::from_quat(*now * rest.inverse())).collect()
            };
            let (before, after) = (away(case.clip), away(&mirrored));
            for (slot, joint) in &case.person.slots.0 {
                let other = case.person.slots.joint(slot.mirrored()).unwrap_or(*joint);
                let apart = degrees(reflection * before[joint.get()] * reflection, after[other.get()]);
                if apart > 1e-3 {
                    return Err(format!("{slot:?} is {apart}° off at {time} s"));
                }
            }
        }
        Ok(())
    });
}

#[test]
fn every_clip_reversed_runs_backwards_and_twice_forwards() {
    let Some(folder) = data_folder() else { return };
    let reverse = ClipChanges { reverse: true, ..NONE };
    in_each_clip(&folder, |case| {
        let [once, twice] = case.changed_twice(&reverse);
        let is_held = |channel: &Channel| channel.interpolation == Interpolation::Step;
        if !case.clip.channels().iter().any(is_held) {
            keeps_keys(case.clip, &twice, [0.0, case.clip.duration_secs()], 0.0)?;
        }
        for time in times(case.clip) {
            let back = case.clip.duration_secs() - time;
            at_most(apart(case.skeleton(), (case.clip, time), (&once, back)), 1e-4, "backwards")?;
            at_most(apart(case.skeleton(), (case.clip, time), (&twice, time)), 1e-4, "forwards again")?;
        }
        Ok(())
    });
}

#[test]
fn every_clip_trimmed_keeps_its_keys() {
    let Some(folder) = data_folder() else { return };
    in_each_clip(&folder, |case| {
        let [start, end] = [0.31, 0.74].map(|share| share * case.clip.duration_secs());
        let trim = Some(TimeRange { start_secs: start.into(), end_secs: end.into() });
        let part = case.changed(case.clip, &ClipChanges { trim, ..NONE });
        keeps_keys(case.clip, &part, [start, end], -start)?;
        for channel in case.clip.channels() {
            let times = counterpart(case.clip, channel).map_or(&[][..], |channel| times_of(case.clip, channel));
            let inside = times.iter().filter(|time| (start..=end).contains(*time)).count();
            // One at either end, and another where the clip would end before the part does.
            if key_count(&part, channel) > inside + 3 {
                return Err(format!("joint {:?} has {} keys", channel.joint, key_count(&part, channel)));
            }
        }
        let worst = times(&part).map(|time| apart(case.skeleton(), (case.clip, start + time), (&part, time)));
        at_most(worst.fold(0.0, f64::max), 1e-4, "the part differs")
    });
}

#[test]
fn every_loop_keeps_the_keys_outside_its_seam() {
    let Some(folder) = data_folder() else { return };
    in_each_clip(&folder, |case| {
        let secs = 0.2 * case.clip.duration_secs();
        let looped = case.changed(case.clip, &ClipChanges { loop_secs: Some(secs.into()), ..NONE });
        let middle = [1.01 * secs, case.clip.duration_secs() - 1.01 * secs];
        keeps_keys(case.clip, &looped, middle, 0.0)?;
        let again = change_clip(&case.person.asset, &looped, &ClipChanges { loop_secs: Some(0.0), ..NONE }, || {
            unreachable!("isn't mirrored")
        });
        let seam = again.seam.ok_or("has no seam")?;
        let is_held = |channel: &Channel| channel.interpolation == Interpolation::Step;
        if case.clip.channels().iter().any(is_held) {
            return Ok(());
        }
        at_most(seam.degrees_max, 0.1, "degrees between the ends")
    });
}

#[test]
fn every_path_turned_and_turned_back_is_the_path() {
    let Some(folder) = data_folder() else { return };
    in_each_clip(&folder, |case| {
        let there = ClipChanges { offset: [3.0, -2.0], turn_degrees: 75.0, ..NONE };
        let back = ClipChanges { offset: [-3.0, 2.0], turn_degrees: -75.0, ..NONE };
        let placed = case.changed(case.clip, &there);
        for channel in case.clip.channels() {
            if key_count(&placed, channel) != key_count(case.clip, channel) {
                return Err(format!("joint {:?} has other keys", channel.joint));
            }
        }
        let moved = apart(case.skeleton(), (case.clip, 0.0), (&placed, 0.0));
        at_most(-moved, -1e-3, "nothing moved")?;
        let again = case.changed(&placed, &back);
        let worst = times(case.clip).map(|time| apart(case.skeleton(), (case.clip, time), (&again, time)));
        at_most(worst.fold(0.0, f64::max), 1e-5, "it isn't back")
    });
}
