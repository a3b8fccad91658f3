//! Samples clips as defined in glTF 2.0 §3.11 and appendix C, optimized for playback.
//!
//! Most channels of real clips are LINEAR, and many share their key times. Their values are stored here a second time,
//! in the pose's groups of four joints: a row holds the values of all groups of a timeline at one key, so one search
//! and two rows serve them all. Rotations in rows are normalized and in a consistent hemisphere. Constant channels form
//! a timeline with a single key. Everything else (STEP, CUBICSPLINE, morph weights) is read from the clip's own keys.

use std::borrow::Cow;

use glam::{BVec4A, Quat, Vec3, Vec4};

use super::channel::{Channel, Interpolation, Keys};
use super::kernels::{ArcKey, ArcWeight, LANES, Quatx4, Vec3x4, unit};
use super::{Pose, Skeleton};

#[derive(Debug, Clone, Default)]
pub(super) struct Sampler {
    /// One per timeline of the clip.
    timelines: Vec<TimelineTracks>,
    /// The channels that never change.
    constants: TimelineTracks,
}

/// The channels of one timeline.
#[derive(Debug, Clone, Default)]
struct TimelineTracks {
    translations: Tracks<Vec3x4>,
    scales: Tracks<Vec3x4>,
    rotations: Tracks<ArcKey>,
    /// Indices of the clip's channels that are not in rows.
    others: Vec<u32>,
}

/// LINEAR channels of one property: row `key` of `rows` has one entry per group.
#[derive(Debug, Clone)]
struct Tracks<T> {
    groups: Vec<Group>,
    rows: Vec<T>,
}

/// A group of the pose.
#[derive(Debug, Clone, Copy)]
struct Group {
    index: u32,
    /// Lanes whose joints have a channel here; others keep their values.
    lanes: BVec4A,
}

/// Where the values of a channel go.
struct Place {
    group: usize,
    lane: usize,
    /// [`CONSTANT`] for a channel that never changes.
    timeline: usize,
}

const CONSTANT: usize = usize::MAX;

/// Channels of one timeline whose joints share a group: the indices of their values, by lane.
struct PlannedGroup {
    timeline: usize,
    group: usize,
    channels: [Option<usize>; LANES],
}

/// Channels of one property that go into rows, with one value per key, or a single one if they never change.
struct RowChannels<'a, T: Clone> {
    places: Vec<Place>,
    values: Vec<Cow<'a, [T]>>,
}

impl Sampler {
    /// `channels` must be valid for `timelines`, which the builder ensures; `rest` is the skeleton's rest pose.
    pub(super) fn new(timelines: &[Vec<f32>], channels: &[Channel], rest: &Pose) -> Self {
        let mut sampler = Self { timelines: vec![TimelineTracks::default(); timelines.len()], ..Self::default() };
        let (mut translations, mut scales) = (RowChannels::default(), RowChannels::default());
        let mut rotations = RowChannels::default();
        for (index, channel) in last_of_each_property(channels) {
            let (group, lane) = rest.place(channel.joint);
            let place = Place { group, lane, timeline: channel.timeline as usize };
            match &channel.keys {
                Keys::Translation(values) if let Some(values) = vectors_in_rows(channel.interpolation, values) => {
                    translations.push(place, Cow::Borrowed(values));
                }
                Keys::Scale(values) if let Some(values) = vectors_in_rows(channel.interpolation, values) => {
                    scales.push(place, Cow::Borrowed(values));
                }
                Keys::Rotation(values) if let Some(values) = rotations_in_rows(channel.interpolation, values) => {
                    rotations.push(place, Cow::Owned(values));
                }
                _ => sampler.timelines[place.timeline].others.push(index as u32),
            }
        }
        sampler.add_rows(timelines, translations, |tracks| &mut tracks.translations, vector_row);
        sampler.add_rows(timelines, scales, |tracks| &mut tracks.scales, vector_row);
        sampler.add_rows(timelines, rotations, |tracks| &mut tracks.rotations, rotation_row);
        sampler
    }

    /// `row_entry` builds a group's entry in a key's row from the values of its lanes, which are empty for lanes
    /// without a channel.
    fn add_rows<T: Clone, R>(
        &mut self,
        timelines: &[Vec<f32>],
        channels: RowChannels<'_, T>,
        tracks: impl Fn(&mut TimelineTracks) -> &mut Tracks<R>,
        row_entry: impl Fn(&[&[T]; LANES], usize) -> R,
    ) {
        let planned = planned_groups(channels.places);
        for groups in planned.chunk_by(|a, b| a.timeline == b.timeline) {
            let (tracks, keys) = match timelines.get(groups[0].timeline) {
                Some(times) => (tracks(&mut self.timelines[groups[0].timeline]), times.len()),
                None => (tracks(&mut self.constants), 1),
            };
            let values_of = |channel: Option<usize>| channel.map_or(&[][..], |channel| &*channels.values[channel]);
            let lanes: Vec<[&[T]; LANES]> = groups.iter().map(|group| group.channels.map(values_of)).collect();
            tracks.groups = groups.iter().map(Group::from).collect();
            tracks.rows.reserve_exact(keys * lanes.len());
            for key in 0..keys {
                tracks.rows.extend(lanes.iter().map(|lanes| row_entry(lanes, key)));
            }
        }
    }

    /// `timelines` and `channels` are those the sampler was built from.
    pub(super) fn sample(
        &self,
        timelines: &[Vec<f32>],
        channels: &[Channel],
        skeleton: &Skeleton,
        time_secs: f32,
        segments: &mut Vec<u32>,
        pose: &mut Pose,
    ) {
        self.constants.sample_rows(&Segment::new(&[0.0], 0, 0.0), pose);
        segments.resize(self.timelines.len(), 0);
        for ((tracks, times), segment) in self.timelines.iter().zip(timelines).zip(segments) {
            *segment = find_segment(times, time_secs, *segment as usize) as u32;
            let at = Segment::new(times, *segment as usize, time_secs);
            tracks.sample_rows(&at, pose);
            for &index in &tracks.others {
                sample_channel(&channels[index as usize], &at, skeleton, pose);
            }
        }
    }
}

impl TimelineTracks {
    fn sample_rows(&self, at: &Segment, pose: &mut Pose) {
        let groups = &mut pose.groups[..];
        for (group, from, to) in self.translations.between(at) {
            groups[group.index as usize].translation.replace(group.lanes, from.lerp(to, at.factor));
        }
        for (group, from, to) in self.scales.between(at) {
            groups[group.index as usize].scale.replace(group.lanes, from.lerp(to, at.factor));
        }
        let weight = ArcWeight::new(at.factor);
        for (group, from, to) in self.rotations.between(at) {
            groups[group.index as usize].rotation.replace(group.lanes, from.slerp(to, &weight));
        }
    }
}

impl<T> Default for Tracks<T> {
    fn default() -> Self {
        Self { groups: Vec::new(), rows: Vec::new() }
    }
}

impl<T> Tracks<T> {
    /// Returns each group with its entries at both ends of a segment.
    #[inline(always)]
    fn between(&self, at: &Segment) -> impl Iterator<Item = (&Group, &T, &T)> {
        let row = |key: usize| &self.rows[key * self.groups.len()..][..self.groups.len()];
        self.groups.iter().zip(row(at.key)).zip(row(at.next)).map(|((group, from), to)| (group, from, to))
    }
}

impl<T: Clone> Default for RowChannels<'_, T> {
    fn default() -> Self {
        Self { places: Vec::new(), values: Vec::new() }
    }
}

impl<'a, T: Clone> RowChannels<'a, T> {
    fn push(&mut self, mut place: Place, values: Cow<'a, [T]>) {
        if values.len() == 1 {
            place.timeline = CONSTANT;
        }
        self.places.push(place);
        self.values.push(values);
    }
}

impl From<&PlannedGroup> for Group {
    fn from(planned: &PlannedGroup) -> Self {
        let lanes = planned.channels.map(|channel| channel.is_some());
        Self { index: planned.group as u32, lanes: BVec4A::from_array(lanes) }
    }
}

/// Groups channels by timeline and group, sorted. A constant joins a timeline that its group already uses.
fn planned_groups(mut places: Vec<Place>) -> Vec<PlannedGroup> {
    let mut timeline_of_group = vec![CONSTANT; places.iter().map(|place| place.group + 1).max().unwrap_or(0)];
    for place in places.iter().filter(|place| place.timeline != CONSTANT) {
        timeline_of_group[place.group] = place.timeline;
    }
    for place in places.iter_mut().filter(|place| place.timeline == CONSTANT) {
        place.timeline = timeline_of_group[place.group];
    }
    let mut order: Vec<[usize; 3]> =
        places.iter().enumerate().map(|(channel, place)| [place.timeline, place.group, channel]).collect();
    order.sort_unstable();
    let mut planned: Vec<PlannedGroup> = Vec::new();
    for [timeline, group, channel] in order {
        if planned.last().is_none_or(|last| (last.timeline, last.group) != (timeline, group)) {
            planned.push(PlannedGroup { timeline, group, channels: [None; LANES] });
        }
        if let Some(last) = planned.last_mut() {
            last.channels[places[channel].lane] = Some(channel);
        }
    }
    planned
}

/// Returns a lane's value at a key; constants have the same value at every key.
fn lane_value<T: Copy>(values: &[T], key: usize, absent: T) -> T {
    values.get(key).or(values.last()).copied().unwrap_or(absent)
}

fn vector_row(lanes: &[&[Vec3]; LANES], key: usize) -> Vec3x4 {
    Vec3x4::new(lanes.map(|values| lane_value(values, key, Vec3::ZERO)))
}

fn rotation_row(lanes: &[&[Quat]; LANES], key: usize) -> ArcKey {
    let at = |key| Quatx4::new(lanes.map(|values| lane_value(values, key, Quat::IDENTITY)));
    ArcKey::new(at(key), at(key + 1))
}

/// Returns the channels and their indices, in order, except those overridden by a later channel for the same property.
fn last_of_each_property(channels: &[Channel]) -> Vec<(usize, &Channel)> {
    let mut seen = std::collections::HashSet::new();
    let new = |(_, channel): &(usize, &Channel)| seen.insert((channel.joint, channel.keys.property()));
    let mut kept: Vec<_> = channels.iter().enumerate().rev().filter(new).collect();
    kept.reverse();
    kept
}

/// Returns the values of a LINEAR channel, a single one if it never changes; `None` for other channels that change.
fn vectors_in_rows(interpolation: Interpolation, values: &[Vec3]) -> Option<&[Vec3]> {
    let constant = match interpolation {
        Interpolation::Step | Interpolation::Linear => values.iter().all(|value| *value == values[0]).then_some(0),
        Interpolation::CubicSpline => {
            let flat = |entry: &[Vec3]| *entry == [Vec3::ZERO, values[1], Vec3::ZERO];
            (values.len() == 3 || values.chunks(3).all(flat)).then_some(1)
        }
    };
    match constant {
        Some(at) => Some(&values[at..=at]),
        None => (interpolation == Interpolation::Linear).then_some(values),
    }
}

/// Like `vectors_in_rows`, but normalizes the rotations, each in the hemisphere of the one before it.
fn rotations_in_rows(interpolation: Interpolation, values: &[Quat]) -> Option<Vec<Quat>> {
    match (interpolation, values) {
        (Interpolation::CubicSpline, &[_, value, _]) | (Interpolation::Step, &[value]) => Some(vec![unit(value)]),
        (Interpolation::Linear, _) => {
            let mut values: Vec<Quat> = values.iter().map(|value| unit(*value)).collect();
            for key in 1..values.len() {
                if values[key - 1].dot(values[key]) < 0.0 {
                    values[key] = -values[key];
                }
            }
            if values.iter().all(|value| *value == values[0]) {
                values.truncate(1);
            }
            Some(values)
        }
        _ => None,
    }
}

/// Samples STEP, CUBICSPLINE and morph-weight channels from the clip's own keys.
fn sample_channel(channel: &Channel, at: &Segment, skeleton: &Skeleton, pose: &mut Pose) {
    let (joint, interpolation) = (channel.joint, channel.interpolation);
    match &channel.keys {
        Keys::Translation(values) => pose.set_translation(joint, at.vec3(values, interpolation)),
        Keys::Scale(values) => pose.set_scale(joint, at.vec3(values, interpolation)),
        Keys::Rotation(values) => pose.set_rotation(joint, at.quat(values, interpolation)),
        Keys::MorphWeights { values, targets } => {
            let range = skeleton.morph_range(joint);
            at.numbers(values, *targets, interpolation, &mut pose.morph_weights[range]);
        }
    }
}

/// Returns the index of the last key at or before `time_secs` (0 before the first key), trying a guess first.
pub(super) fn find_segment(times: &[f32], time_secs: f32, guess: usize) -> usize {
    let fits = |index: usize| {
        times.get(index).is_some_and(|&start| start <= time_secs)
            && times.get(index + 1).is_none_or(|&end| time_secs < end)
    };
    if fits(guess) {
        guess
    } else if fits(guess + 1) {
        guess + 1
    } else {
        times.partition_point(|&start| start <= time_secs).saturating_sub(1)
    }
}

/// Two adjacent keys and the position of the time between them.
pub(super) struct Segment {
    key: usize,
    /// Equals `key` outside the keys, where values hold.
    next: usize,
    length_secs: f32,
    /// 0 at `key`, 1 at `next`.
    factor: f32,
}

impl Segment {
    pub(super) fn new(times: &[f32], key: usize, time_secs: f32) -> Self {
        let start = times[key];
        match times.get(key + 1) {
            Some(&end) if time_secs > start => {
                let length_secs = end - start;
                Self { key, next: key + 1, length_secs, factor: ((time_secs - start) / length_secs).clamp(0.0, 1.0) }
            }
            _ => Self { key, next: key, length_secs: 0.0, factor: 0.0 },
        }
    }

    /// Hermite basis of glTF 2.0 appendix C.4, with the segment's length multiplied into the tangent factors.
    fn cubic_factors(&self) -> [f32; 4] {
        let (t, t2, t3) = (self.factor, self.factor * self.factor, self.factor * self.factor * self.factor);
        let length = self.length_secs;
        [2.0 * t3 - 3.0 * t2 + 1.0, length * (t3 - 2.0 * t2 + t), -2.0 * t3 + 3.0 * t2, length * (t3 - t2)]
    }

    /// STEP or CUBICSPLINE; LINEAR channels are in the rows. At a factor of 0 the spline equals the key.
    fn vec3(&self, values: &[Vec3], interpolation: Interpolation) -> Vec3 {
        if interpolation != Interpolation::CubicSpline {
            return values[self.key];
        }
        if self.factor == 0.0 {
            return values[3 * self.key + 1];
        }
        let [p0, m0, p1, m1] = self.cubic_factors();
        p0 * values[3 * self.key + 1]
            + m0 * values[3 * self.key + 2]
            + p1 * values[3 * self.next + 1]
            + m1 * values[3 * self.next]
    }

    /// Not normalized.
    fn quat(&self, values: &[Quat], interpolation: Interpolation) -> Quat {
        if interpolation != Interpolation::CubicSpline {
            return values[self.key];
        }
        if self.factor == 0.0 {
            return values[3 * self.key + 1];
        }
        let [p0, m0, p1, m1] = self.cubic_factors();
        let at = |index: usize| Vec4::from(values[index]);
        let sum =
            p0 * at(3 * self.key + 1) + m0 * at(3 * self.key + 2) + p1 * at(3 * self.next + 1) + m1 * at(3 * self.next);
        Quat::from_vec4(sum)
    }

    /// Interpolates entries of `width` numbers, each number on its own, with any interpolation.
    pub(super) fn numbers(&self, values: &[f32], width: usize, interpolation: Interpolation, out: &mut [f32]) {
        let at = |entry: usize, component: usize| values[entry * width + component];
        match interpolation {
            Interpolation::Step => out.copy_from_slice(&values[self.key * width..(self.key + 1) * width]),
            Interpolation::Linear => {
                for (component, number) in out.iter_mut().enumerate() {
                    let (from, to) = (at(self.key, component), at(self.next, component));
                    *number = from + (to - from) * self.factor;
                }
            }
            Interpolation::CubicSpline => {
                let [p0, m0, p1, m1] = self.cubic_factors();
                for (component, number) in out.iter_mut().enumerate() {
                    *number = p0 * at(3 * self.key + 1, component)
                        + m0 * at(3 * self.key + 2, component)
                        + p1 * at(3 * self.next + 1, component)
                        + m1 * at(3 * self.next, component);
                }
            }
        }
    }
}
