//! The source's channels by joint and property, in double precision. Gives the values that the player samples (glTF 2.0,
//! appendix C), whereas the player's sampler works on whole poses in single precision.

use std::collections::HashSet;

use gaitway_character::anim::{Channel, Clip, Interpolation, JointIndex, Keys, Property, Reflection, Skeleton};
use glam::{DQuat, DVec3, DVec4, Quat, Vec3};

use crate::math::{slerp, unit};
use crate::pose::{Local, ancestry, parent_frame};

/// One property of one joint over time.
#[derive(Debug, Clone, Copy)]
pub enum Track<'a, T> {
    /// Never changes.
    Constant(T),
    Keys {
        times: &'a [f32],
        channel: &'a Channel,
    },
}

impl<T> Track<'_, T> {
    pub fn times(&self) -> &[f32] {
        match self {
            Self::Constant(_) => &[],
            Self::Keys { times, .. } => times,
        }
    }

    /// Times at which the value jumps: the keys of a stepped channel.
    pub fn jumps(&self) -> &[f32] {
        match self {
            Self::Keys { times, channel } if channel.interpolation == Interpolation::Step => times,
            Self::Constant(_) | Self::Keys { .. } => &[],
        }
    }

    pub fn is_moving(&self) -> bool {
        matches!(self, Self::Keys { .. })
    }
}

/// The source clip without its muted channels.
#[derive(Debug)]
pub struct SourceTracks<'a> {
    pub skeleton: &'a Skeleton,
    pub clip: &'a Clip,
    pub translations: Vec<Track<'a, DVec3>>,
    pub rotations: Vec<Track<'a, DQuat>>,
    pub scales: Vec<Track<'a, DVec3>>,
    /// Which joints have a channel at all, even a constant one.
    pub has_channel: Vec<bool>,
    muted: HashSet<(JointIndex, Property)>,
    /// Tracks have the values of the file; transforms are those in the mirror.
    reflection: &'a Reflection,
}

impl<'a> SourceTracks<'a> {
    /// `unmoved` holds the local transforms of joints that the clip does not animate.
    pub fn new(skeleton: &'a Skeleton, clip: &'a Clip, muted: &[(JointIndex, Property)], unmoved: &[Local]) -> Self {
        let reflection = skeleton.reflection();
        let in_file = |(joint, local): (JointIndex, &Local)| local.in_mirror(reflection, joint);
        let unmoved: Vec<Local> = skeleton.joints().zip(unmoved).map(in_file).collect();
        let mut tracks = Self {
            skeleton,
            clip,
            translations: unmoved.iter().map(|local| Track::Constant(local.translation)).collect(),
            rotations: unmoved.iter().map(|local| Track::Constant(local.rotation)).collect(),
            scales: unmoved.iter().map(|local| Track::Constant(local.scale)).collect(),
            has_channel: vec![false; unmoved.len()],
            muted: muted.iter().copied().collect(),
            reflection,
        };
        for channel in clip.channels() {
            if !tracks.is_muted(channel) {
                tracks.set(&clip.timelines()[channel.timeline as usize], channel);
            }
        }
        tracks
    }

    /// Whether the map ignores a channel of the clip.
    pub fn is_muted(&self, channel: &Channel) -> bool {
        self.muted.contains(&(channel.joint, channel.keys.property()))
    }

    fn set(&mut self, times: &'a [f32], channel: &'a Channel) {
        let joint = channel.joint.get();
        let vector = |values: &[Vec3]| match constant(channel.interpolation, values, Vec3::ZERO) {
            Some(value) => Track::Constant(value.as_dvec3()),
            None => Track::Keys { times, channel },
        };
        match &channel.keys {
            Keys::Translation(values) => self.translations[joint] = vector(values),
            Keys::Scale(values) => self.scales[joint] = vector(values),
            Keys::Rotation(values) => {
                let zero = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
                self.rotations[joint] = match constant(channel.interpolation, values, zero) {
                    Some(value) => Track::Constant(unit(value.as_dquat())),
                    None => Track::Keys { times, channel },
                };
            }
            Keys::MorphWeights { .. } => return,
        }
        self.has_channel[joint] = true;
    }

    /// The joint's local transform at a time.
    pub fn local(&self, joint: JointIndex, time_secs: f32) -> Local {
        self.locals_at(time_secs)(joint)
    }

    /// Returns the joints' local transforms at a time. For several joints, timelines that they share are searched once.
    pub fn locals_at(&self, time_secs: f32) -> impl FnMut(JointIndex) -> Local {
        let mut search = Search { time_secs, last: None };
        move |joint| {
            let local = Local {
                translation: vector(&self.translations[joint.get()], &mut search),
                rotation: rotation(&self.rotations[joint.get()], &mut search),
                scale: vector(&self.scales[joint.get()], &mut search),
            };
            local.in_mirror(self.reflection, joint)
        }
    }

    /// The joint's local rotation at a time.
    pub fn rotation(&self, joint: JointIndex, time_secs: f32) -> DQuat {
        let local = rotation(&self.rotations[joint.get()], &mut Search { time_secs, last: None });
        self.reflection.rotation(joint, local)
    }

    /// Whether the joint's keys are its transforms, and not those in a mirror.
    pub fn has_own_keys(&self, joint: JointIndex) -> bool {
        !self.reflection.changes(joint)
    }

    /// World position of a joint, without sampling the joints beside its ancestors.
    pub fn position(&self, joint: JointIndex, time_secs: f32, world_from_model: DQuat) -> DVec3 {
        let world_from_parent =
            parent_frame(self.skeleton, joint, world_from_model, |ancestor| self.local(ancestor, time_secs));
        let local = vector(&self.translations[joint.get()], &mut Search { time_secs, last: None });
        world_from_parent.transform_point3(self.reflection.translation(joint, local))
    }

    pub fn is_moving(&self, joint: JointIndex) -> bool {
        let joint = joint.get();
        self.translations[joint].is_moving() || self.rotations[joint].is_moving() || self.scales[joint].is_moving()
    }

    /// Timelines of everything that moves a joint's origin.
    pub fn path_timelines(&self, joint: JointIndex) -> Vec<&[f32]> {
        let own = self.translations[joint.get()].times();
        let ancestors = ancestry(self.skeleton, joint).skip(1).flat_map(|joint| {
            let joint = joint.get();
            [self.translations[joint].times(), self.rotations[joint].times(), self.scales[joint].times()]
        });
        ancestors.chain([own]).collect()
    }
}

/// The value that a channel has at every time, if it never changes.
fn constant<T: Copy + PartialEq>(interpolation: Interpolation, values: &[T], zero: T) -> Option<T> {
    match interpolation {
        Interpolation::Step | Interpolation::Linear => {
            let first = *values.first()?;
            values.iter().all(|value| *value == first).then_some(first)
        }
        Interpolation::CubicSpline => {
            let first = *values.get(1)?;
            let is_flat = values.chunks(3).all(|entry| *entry == [zero, first, zero]);
            (values.len() == 3 || is_flat).then_some(first)
        }
    }
}

/// Two neighbouring keys and the position between them; `from == to` outside the keys.
#[derive(Clone, Copy)]
struct Segment {
    from: usize,
    to: usize,
    factor: f64,
    length_secs: f64,
}

fn segment_at(times: &[f32], time_secs: f32) -> Segment {
    let from = times.partition_point(|&start| start <= time_secs).saturating_sub(1);
    match times.get(from + 1) {
        Some(&end) if time_secs > times[from] => {
            let length_secs = f64::from(end) - f64::from(times[from]);
            let factor = (f64::from(time_secs) - f64::from(times[from])) / length_secs;
            Segment { from, to: from + 1, factor, length_secs }
        }
        _ => Segment { from, to: from, factor: 0.0, length_secs: 0.0 },
    }
}

/// Finds segments at one time.
struct Search<'a> {
    time_secs: f32,
    /// Most tracks of a clip have the same times.
    last: Option<(&'a [f32], Segment)>,
}

impl<'a> Search<'a> {
    fn segment(&mut self, times: &'a [f32]) -> Segment {
        if let Some((last, segment)) = self.last
            && std::ptr::eq(last, times)
        {
            return segment;
        }
        let segment = segment_at(times, self.time_secs);
        self.last = Some((times, segment));
        segment
    }
}

/// Weights of value, out-tangent, next value and next in-tangent (appendix C.4).
fn hermite(segment: &Segment) -> [f64; 4] {
    let t = segment.factor;
    let (t2, t3) = (t * t, t * t * t);
    let length = segment.length_secs;
    [2.0 * t3 - 3.0 * t2 + 1.0, length * (t3 - 2.0 * t2 + t), -2.0 * t3 + 3.0 * t2, length * (t3 - t2)]
}

fn vector<'a>(track: &Track<'a, DVec3>, search: &mut Search<'a>) -> DVec3 {
    let (times, channel) = match track {
        Track::Constant(value) => return *value,
        Track::Keys { times, channel } => (times, channel),
    };
    let (Keys::Translation(values) | Keys::Scale(values)) = &channel.keys else { return DVec3::ZERO };
    let segment = search.segment(times);
    let value = |at: usize| values[at].as_dvec3();
    match channel.interpolation {
        Interpolation::Step => value(segment.from),
        Interpolation::Linear => value(segment.from).lerp(value(segment.to), segment.factor),
        Interpolation::CubicSpline => {
            let [p0, m0, p1, m1] = hermite(&segment);
            p0 * value(3 * segment.from + 1)
                + m0 * value(3 * segment.from + 2)
                + p1 * value(3 * segment.to + 1)
                + m1 * value(3 * segment.to)
        }
    }
}

fn rotation<'a>(track: &Track<'a, DQuat>, search: &mut Search<'a>) -> DQuat {
    let (times, channel) = match track {
        Track::Constant(value) => return *value,
        Track::Keys { times, channel } => (times, channel),
    };
    let Keys::Rotation(values) = &channel.keys else { return DQuat::IDENTITY };
    let segment = search.segment(times);
    let value = |at: usize| values[at].as_dquat();
    match channel.interpolation {
        Interpolation::Step => unit(value(segment.from)),
        // Exactly at a key, where most times are that anyone asks for.
        Interpolation::Linear if segment.factor == 0.0 => unit(value(segment.from)),
        Interpolation::Linear => slerp(unit(value(segment.from)), unit(value(segment.to)), segment.factor),
        Interpolation::CubicSpline => {
            let [p0, m0, p1, m1] = hermite(&segment);
            let value = |at: usize| DVec4::from(value(at));
            let sum = p0 * value(3 * segment.from + 1)
                + m0 * value(3 * segment.from + 2)
                + p1 * value(3 * segment.to + 1)
                + m1 * value(3 * segment.to);
            unit(DQuat::from_vec4(sum))
        }
    }
}
