//! The source's channels, one joint and property at a time and in f64: what the rotation law multiplies. Reads the same
//! values as the player (glTF 2.0 appendix C); the player's own sampler reads whole poses, in f32.

use glam::{DQuat, DVec3, DVec4};

use crate::anim::{Channel, Clip, Interpolation, JointIndex, Keys, Property, Skeleton};
use crate::retarget::align::rest::{Local, node_locals, unit};

/// A property of one joint over time.
#[derive(Debug, Clone, Copy)]
pub enum Track<'a, T> {
    /// The same at every time.
    Still(T),
    Keys {
        times: &'a [f32],
        channel: &'a Channel,
    },
}

impl<T> Track<'_, T> {
    pub fn times(&self) -> &[f32] {
        match self {
            Self::Still(_) => &[],
            Self::Keys { times, .. } => times,
        }
    }

    pub fn moves(&self) -> bool {
        matches!(self, Self::Keys { .. })
    }
}

/// A clip without its muted channels, over its skeleton.
#[derive(Debug)]
pub struct Motion<'a> {
    pub skeleton: &'a Skeleton,
    pub translations: Vec<Track<'a, DVec3>>,
    pub rotations: Vec<Track<'a, DQuat>>,
    pub scales: Vec<Track<'a, DVec3>>,
    /// Which joints have a channel at all, be it a still one.
    pub has_channel: Vec<bool>,
}

impl<'a> Motion<'a> {
    pub fn new(skeleton: &'a Skeleton, clip: &'a Clip, muted: &[(JointIndex, Property)]) -> Self {
        let locals = node_locals(skeleton);
        let mut motion = Self {
            skeleton,
            translations: locals.iter().map(|local| Track::Still(local.translation)).collect(),
            rotations: locals.iter().map(|local| Track::Still(local.rotation)).collect(),
            scales: locals.iter().map(|local| Track::Still(local.scale)).collect(),
            has_channel: vec![false; locals.len()],
        };
        for channel in clip.channels() {
            let joint = channel.joint.get();
            if muted.contains(&(channel.joint, channel.keys.property())) {
                continue;
            }
            let times = &clip.timelines()[channel.timeline as usize];
            let keys = Track::Keys { times, channel };
            let vector = |values: &[glam::Vec3]| match still(channel.interpolation, values, glam::Vec3::ZERO) {
                Some(value) => Track::Still(value.as_dvec3()),
                None => Track::Keys { times, channel },
            };
            match &channel.keys {
                Keys::Translation(values) => motion.translations[joint] = vector(values),
                Keys::Scale(values) => motion.scales[joint] = vector(values),
                Keys::Rotation(values) => {
                    let zero = glam::Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
                    motion.rotations[joint] = match still(channel.interpolation, values, zero) {
                        Some(value) => Track::Still(unit(value.as_dquat())),
                        None => keys,
                    };
                }
                Keys::MorphWeights { .. } => continue,
            }
            motion.has_channel[joint] = true;
        }
        motion
    }

    /// The joint's local transform at a time.
    pub fn local(&self, joint: JointIndex, time_secs: f32) -> Local {
        Local {
            translation: vector_at(&self.translations[joint.get()], time_secs),
            rotation: rotation_at(&self.rotations[joint.get()], time_secs),
            scale: vector_at(&self.scales[joint.get()], time_secs),
        }
    }

    pub fn joint_moves(&self, joint: JointIndex) -> bool {
        let joint = joint.get();
        self.translations[joint].moves() || self.rotations[joint].moves() || self.scales[joint].moves()
    }
}

/// The value that a channel has at every time, if it has.
fn still<T: Copy + PartialEq>(interpolation: Interpolation, values: &[T], zero: T) -> Option<T> {
    match interpolation {
        Interpolation::Step | Interpolation::Linear => {
            let first = *values.first()?;
            values.iter().all(|value| *value == first).then_some(first)
        }
        Interpolation::CubicSpline => {
            let first = *values.get(1)?;
            let flat = values.chunks(3).all(|entry| *entry == [zero, first, zero]);
            (values.len() == 3 || flat).then_some(first)
        }
    }
}

/// Two neighbouring keys and the place between them: `from == to` outside the keys.
struct Place {
    from: usize,
    to: usize,
    factor: f64,
    length_secs: f64,
}

fn place(times: &[f32], time_secs: f32) -> Place {
    let from = times.partition_point(|&start| start <= time_secs).saturating_sub(1);
    match times.get(from + 1) {
        Some(&end) if time_secs > times[from] => {
            let length_secs = f64::from(end) - f64::from(times[from]);
            let factor = (f64::from(time_secs) - f64::from(times[from])) / length_secs;
            Place { from, to: from + 1, factor, length_secs }
        }
        _ => Place { from, to: from, factor: 0.0, length_secs: 0.0 },
    }
}

/// Appendix C.4: the weights of value, out-tangent, next value and next in-tangent.
fn hermite(place: &Place) -> [f64; 4] {
    let t = place.factor;
    let (t2, t3) = (t * t, t * t * t);
    let length = place.length_secs;
    [2.0 * t3 - 3.0 * t2 + 1.0, length * (t3 - 2.0 * t2 + t), -2.0 * t3 + 3.0 * t2, length * (t3 - t2)]
}

pub fn vector_at(track: &Track<'_, DVec3>, time_secs: f32) -> DVec3 {
    let Track::Keys { times, channel } = track else {
        let Track::Still(value) = track else { return DVec3::ZERO };
        return *value;
    };
    let (Keys::Translation(values) | Keys::Scale(values)) = &channel.keys else { return DVec3::ZERO };
    let place = place(times, time_secs);
    let value = |at: usize| values[at].as_dvec3();
    match channel.interpolation {
        Interpolation::Step => value(place.from),
        Interpolation::Linear => value(place.from).lerp(value(place.to), place.factor),
        Interpolation::CubicSpline => {
            let [p0, m0, p1, m1] = hermite(&place);
            p0 * value(3 * place.from + 1)
                + m0 * value(3 * place.from + 2)
                + p1 * value(3 * place.to + 1)
                + m1 * value(3 * place.to)
        }
    }
}

pub fn rotation_at(track: &Track<'_, DQuat>, time_secs: f32) -> DQuat {
    let Track::Keys { times, channel } = track else {
        let Track::Still(value) = track else { return DQuat::IDENTITY };
        return *value;
    };
    let Keys::Rotation(values) = &channel.keys else { return DQuat::IDENTITY };
    let place = place(times, time_secs);
    let value = |at: usize| values[at].as_dquat();
    match channel.interpolation {
        Interpolation::Step => unit(value(place.from)),
        Interpolation::Linear => slerp(unit(value(place.from)), unit(value(place.to)), place.factor),
        Interpolation::CubicSpline => {
            let [p0, m0, p1, m1] = hermite(&place);
            let value = |at: usize| DVec4::from(value(at));
            let sum = p0 * value(3 * place.from + 1)
                + m0 * value(3 * place.from + 2)
                + p1 * value(3 * place.to + 1)
                + m1 * value(3 * place.to);
            unit(DQuat::from_vec4(sum))
        }
    }
}

/// The shorter arc, at constant speed (appendix C.3).
pub fn slerp(from: DQuat, to: DQuat, factor: f64) -> DQuat {
    let cos = from.dot(to);
    let to = if cos < 0.0 { -to } else { to };
    let angle = cos.abs().min(1.0).acos();
    if angle < 1e-9 {
        return unit(from + (to - from) * factor);
    }
    unit(from * ((1.0 - factor) * angle).sin() + to * (factor * angle).sin())
}

/// The angle of the rotation between two, radians. Better than an arc cosine near zero.
pub fn angle_between(from: DQuat, to: DQuat) -> f64 {
    let turn = from.conjugate() * to;
    2.0 * turn.xyz().length().atan2(turn.w.abs())
}
