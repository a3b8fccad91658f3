//! Writes a clip as an animation with its accessors (§3.11), with the clip's own keys, not resampled. Channels with the same key
//! times share an accessor.

use std::collections::BTreeMap;

use gaitway_character::anim::{Channel, Clip, Interpolation, Keys, Property, Skeleton};
use glam::{DQuat, Quat, Vec3};
use serde_json::{Map, Value, json};

use super::WriteError;
use super::glb::pad;
use crate::gltf::animations::Extras;
use crate::gltf::object::{Array, raw};

/// A rotation whose squared length is farther from 1 is normalized. Rounding errors are far smaller, so a clip that was
/// loaded is written back bit for bit.
const UNIT_TOLERANCE: f32 = 1e-5;

/// The elements that clips add to the arrays of a file.
#[derive(Default)]
pub struct Added {
    pub animations: Array,
    pub accessors: Array,
    pub buffer_views: Array,
}

/// Lengths of the arrays before anything is added.
#[derive(Clone, Copy, Default)]
pub struct Counts {
    pub accessors: usize,
    pub buffer_views: usize,
}

/// Appends the keys of `clips` to `binary`, the beginning of the buffer. The first `own` are the file's, the others are marked as
/// added to it. `weights` includes morph weights.
pub fn add(
    clips: &[&Clip],
    own: usize,
    skeleton: &Skeleton,
    weights: bool,
    counts: Counts,
    binary: &mut Vec<u8>,
) -> Result<Added, WriteError> {
    let mut added = Added::default();
    for (index, clip) in clips.iter().enumerate() {
        pad(binary, 0);
        let mut data = Data {
            start: binary.len(),
            binary: &mut *binary,
            view: counts.buffer_views + added.buffer_views.len(),
            first: counts.accessors,
            accessors: &mut added.accessors,
        };
        let mut animation = animation(clip, skeleton, weights, &mut data)?;
        if index >= own {
            animation.insert("extras".to_owned(), json!(Extras { gaitway_added: true }));
        }
        let (start, end) = (data.start, data.binary.len());
        added.animations.push(raw(&animation));
        added.buffer_views.push(raw(&json!({ "buffer": 0, "byteOffset": start, "byteLength": end - start })));
    }
    Ok(added)
}

/// The buffer view of one clip.
struct Data<'a> {
    start: usize,
    binary: &'a mut Vec<u8>,
    view: usize,
    /// Number of accessors that the file already has.
    first: usize,
    accessors: &'a mut Array,
}

impl Data<'_> {
    /// Adds an accessor over `numbers`, `width` per element, and returns its index.
    fn accessor(&mut self, shape: &str, width: usize, numbers: &[f32], with_bounds: bool) -> usize {
        let mut accessor = json!({
            "bufferView": self.view,
            "byteOffset": self.binary.len() - self.start,
            "componentType": 5126,
            "count": numbers.len() / width,
            "type": shape,
        });
        if with_bounds {
            let min = numbers.iter().copied().fold(f32::INFINITY, f32::min);
            let max = numbers.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            // With all digits, since validators compare them with the data.
            accessor["min"] = json!([f64::from(min)]);
            accessor["max"] = json!([f64::from(max)]);
        }
        self.binary.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        self.accessors.push(raw(&accessor));
        self.first + self.accessors.len() - 1
    }
}

fn animation(
    clip: &Clip,
    skeleton: &Skeleton,
    weights: bool,
    data: &mut Data,
) -> Result<Map<String, Value>, WriteError> {
    let written = written(clip, skeleton, weights);
    if written.is_empty() {
        return Err(WriteError::EmptyClip { clip: clip.name().to_owned() });
    }
    let mut times: BTreeMap<u32, usize> = BTreeMap::new();
    let (mut channels, mut samplers) = (Vec::new(), Vec::new());
    for channel in written {
        let input = match times.get(&channel.timeline) {
            Some(&input) => input,
            None => {
                let secs = &clip.timelines()[channel.timeline as usize];
                *times.entry(channel.timeline).or_insert(data.accessor("SCALAR", 1, secs, true))
            }
        };
        let (path, shape, width, mut numbers) = numbers(channel);
        let mut interpolation = channel.interpolation;
        if interpolation == Interpolation::CubicSpline && clip.timelines()[channel.timeline as usize].len() == 1 {
            // A spline has at least two keys (§3.11): the value between the tangents of a single one is constant.
            let third = numbers.len() / 3;
            (interpolation, numbers) = (Interpolation::Step, numbers[third..2 * third].to_vec());
        }
        if numbers.iter().any(|number| !number.is_finite()) {
            let (clip, joint) = (clip.name().to_owned(), skeleton.label(channel.joint));
            return Err(WriteError::NotFinite { clip, joint });
        }
        let output = data.accessor(shape, width, &numbers, false);
        let interpolation = match interpolation {
            Interpolation::Linear => "LINEAR",
            Interpolation::Step => "STEP",
            Interpolation::CubicSpline => "CUBICSPLINE",
        };
        let node = skeleton.source_index(channel.joint);
        channels.push(json!({ "sampler": samplers.len(), "target": { "node": node, "path": path } }));
        samplers.push(json!({ "input": input, "interpolation": interpolation, "output": output }));
    }
    let mut animation = Map::new();
    if !clip.name().is_empty() {
        animation.insert("name".to_owned(), json!(clip.name()));
    }
    animation.insert("channels".to_owned(), json!(channels));
    animation.insert("samplers".to_owned(), json!(samplers));
    Ok(animation)
}

/// Returns the channels to write. A file may have only one per property: the last, which is the one that the player uses.
pub fn written<'a>(clip: &'a Clip, skeleton: &Skeleton, weights: bool) -> Vec<&'a Channel> {
    let mut last: BTreeMap<(u32, u8), usize> = BTreeMap::new();
    let key = |channel: &Channel| (channel.joint.0, channel.keys.property() as u8);
    for (index, channel) in clip.channels().iter().enumerate() {
        last.insert(key(channel), index);
    }
    let counts = |(index, channel): &(usize, &Channel)| {
        last.get(&key(channel)) == Some(index)
            && channel.joint.get() < skeleton.len()
            && (weights || channel.keys.property() != Property::MorphWeights)
    };
    clip.channels().iter().enumerate().filter(counts).map(|(_, channel)| channel).collect()
}

/// Returns a channel's path, the type of its accessor with its number of components, and its numbers.
fn numbers(channel: &Channel) -> (&'static str, &'static str, usize, Vec<f32>) {
    let vectors = |values: &[Vec3]| values.iter().flat_map(|value| value.to_array()).collect();
    match &channel.keys {
        Keys::Translation(values) => ("translation", "VEC3", 3, vectors(values)),
        Keys::Scale(values) => ("scale", "VEC3", 3, vectors(values)),
        Keys::Rotation(values) if channel.interpolation == Interpolation::CubicSpline => {
            ("rotation", "VEC4", 4, values.iter().flat_map(|value| value.to_array()).collect())
        }
        Keys::Rotation(values) => ("rotation", "VEC4", 4, values.iter().flat_map(|value| unit(*value)).collect()),
        Keys::MorphWeights { values, .. } => ("weights", "SCALAR", 1, values.clone()),
    }
}

/// Normalizes a rotation, as the specification requires. A zero quaternion becomes the identity.
fn unit(rotation: Quat) -> [f32; 4] {
    if (rotation.length_squared() - 1.0).abs() <= UNIT_TOLERANCE || !rotation.is_finite() {
        return rotation.to_array();
    }
    let exact: DQuat = rotation.as_dquat();
    let length = exact.length();
    if length > 0.0 { (exact / length).as_quat().to_array() } else { Quat::IDENTITY.to_array() }
}
