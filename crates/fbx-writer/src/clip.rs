//! Clips as animation stacks of one layer, with curves for what moves.

use std::collections::BTreeMap;

use gaitway_character::anim::{Clip, Interpolation, JointIndex, Keys as ClipKeys, Property, PropertyTarget};
use glam::{DQuat, DVec3, DVec4, Quat, Vec3};

use crate::document::{Take, ticks};
use crate::fit::{Keys, Segment, fit};
use crate::layout::{Contents, Layout};
use crate::names::Names;
use crate::objects::{Id, Objects};
use crate::record::{Properties, Record};
use crate::source::{Kind, Source};
use crate::tolerance::{self, Tolerance, Tolerances};

/// Flags of a key: what follows it, and that its slopes are its own on both sides.
const CONSTANT: i32 = 0x2;
const LINEAR: i32 = 0x4;
const CUBIC: i32 = 0x8;
const OWN_SLOPES: i32 = 0x400 | 0x800;
/// A third, twice, as both weights of a tangent.
const WEIGHTS: u32 = 0x0d05_0d05;

/// A property of an object in FBX.
#[derive(Debug, Clone, Copy)]
struct Target {
    /// Name of its node of curves.
    node: &'static str,
    property: &'static str,
    /// Names of its curves.
    curves: &'static [&'static str],
    kind: Kind,
    /// The file's numbers per one of the source's.
    unit: f64,
}

const XYZ: &[&str] = &["d|X", "d|Y", "d|Z"];
const TRANSLATION: Target =
    Target { node: "T", property: "Lcl Translation", curves: XYZ, kind: Kind::Numbers, unit: 1.0 };
const ROTATION: Target = Target {
    node: "R",
    property: "Lcl Rotation",
    curves: XYZ,
    kind: Kind::Rotation,
    unit: 180.0 / std::f64::consts::PI,
};
const SCALE: Target = Target { node: "S", property: "Lcl Scaling", curves: XYZ, kind: Kind::Numbers, unit: 1.0 };
const WEIGHT: Target = Target {
    node: "DeformPercent",
    property: "DeformPercent",
    curves: &["d|DeformPercent"],
    kind: Kind::Numbers,
    unit: 100.0,
};

/// What clips are written for.
#[derive(Debug)]
pub struct Rig<'a> {
    pub contents: Contents<'a>,
    pub layout: &'a Layout,
    pub tolerances: &'a Tolerances,
    /// Channels of the blend shapes of each joint's meshes.
    pub channels: &'a BTreeMap<JointIndex, Vec<Vec<Id>>>,
}

/// A curve's object, property and keys.
struct Curves {
    object: Id,
    target: Target,
    keys: Keys,
}

/// Writes a clip. Returns none if there is nothing in it that FBX can hold.
pub fn write(rig: &Rig, clip: &Clip, names: &mut Names, objects: &mut Objects) -> Option<Take> {
    let mut all = Vec::new();
    rig.add_joints(clip, &mut all);
    rig.add_weights(clip, &mut all);
    if all.is_empty() {
        return None;
    }
    let name = names.unique(if clip.name().is_empty() { "clip" } else { clip.name() });
    let end_secs = f64::from(clip.duration_secs());
    // Some programs take the last key for the end.
    if all.iter().all(|curves| curves.keys.times.last().is_none_or(|&last| last < end_secs))
        && let Some(first) = all.first_mut()
        && let Some(&last) = first.keys.values.last()
    {
        first.keys.times.push(end_secs);
        first.keys.values.push(last);
        first.keys.segments.push(Segment::Linear);
    }
    let end_ticks = ticks(end_secs);
    let range = Properties::new()
        .time("LocalStart", 0)
        .time("LocalStop", end_ticks)
        .time("ReferenceStart", 0)
        .time("ReferenceStop", end_ticks);
    let stack = objects.add("AnimationStack", (&name, "AnimStack", ""), |record| record.with(range.record()));
    let layer = objects.add("AnimationLayer", (&name, "AnimLayer", ""), Record::list);
    objects.connect(layer, stack);
    for curves in all {
        curves.write(layer, objects);
    }
    Some(Take { name, end_ticks })
}

impl Rig<'_> {
    fn add_joints(&self, clip: &Clip, all: &mut Vec<Curves>) {
        let Contents { asset, .. } = self.contents;
        let skeleton = &asset.skeleton;
        // Of several channels for a property, the last counts.
        let mut last: BTreeMap<(JointIndex, u8), usize> = BTreeMap::new();
        let mut animated = vec![false; skeleton.len()];
        for (index, channel) in clip.channels().iter().enumerate() {
            let part = match channel.keys.property() {
                Property::Translation => 0,
                Property::Rotation => 1,
                Property::Scale => 2,
                Property::MorphWeights => continue,
            };
            if self.layout.is_placed[channel.joint.get()] {
                last.insert((channel.joint, part), index);
                animated[channel.joint.get()] = true;
            }
        }
        let tolerances = self.tolerances.of_joints(skeleton, &animated);
        for ((joint, _), index) in last {
            let channel = &clip.channels()[index];
            let times = &clip.timelines()[channel.timeline as usize];
            all.extend(self.joint(joint, channel.interpolation, times, &channel.keys, tolerances[joint.get()]));
        }
    }

    fn joint(
        &self,
        joint: JointIndex,
        interpolation: Interpolation,
        times: &[f32],
        keys: &ClipKeys,
        tolerance: Tolerance,
    ) -> Option<Curves> {
        let space = self.contents.space;
        let model = &self.layout.models[joint.get()];
        let (index, turn) = (joint.get(), self.layout.turns[joint.get()]);
        let numbers = |values: &[Vec3], convert: &dyn Fn(DVec3) -> DVec3| {
            let values = values.iter().map(|value| convert(value.as_dvec3()).extend(0.0));
            Source::new(Kind::Numbers, interpolation, times, values)
        };
        let (target, source, allowed, rest) = match keys {
            ClipKeys::Translation(values) => {
                let source = numbers(values, &|value| space.translation(index, value));
                (TRANSLATION, source, tolerance.translation, model.local.translation)
            }
            ClipKeys::Scale(values) => {
                let source = numbers(values, &|value| space.scale(index, value));
                (SCALE, source, tolerance.scale, model.local.scale)
            }
            ClipKeys::Rotation(values) => {
                let convert = |value: &Quat| DVec4::from(times_quaternion(space.rotation(value.as_dquat()), turn));
                let source = Source::new(Kind::Rotation, interpolation, times, values.iter().map(convert));
                (ROTATION, source, tolerance.rotation, rest_angles(&model.local.rotation))
            }
            ClipKeys::MorphWeights { .. } => return None,
        };
        let keys = fit(&source, allowed, rest);
        // A rotation stays, as a sign that the clip holds the joint.
        let rests = keys.values.iter().all(|value| (*value - rest).abs().max_element() <= allowed);
        let is_needed = target.kind == Kind::Rotation || !rests || keys.segments.len() > 1;
        is_needed.then_some(Curves { object: model.id, target, keys })
    }

    fn add_weights(&self, clip: &Clip, all: &mut Vec<Curves>) {
        let skeleton = &self.contents.asset.skeleton;
        for (&joint, meshes) in self.channels {
            let rest = &skeleton.rest().morph_weights[skeleton.morph_range(joint)];
            let mut sources: BTreeMap<usize, Source> = BTreeMap::new();
            for channel in clip.channels().iter().filter(|channel| channel.joint == joint) {
                let ClipKeys::MorphWeights { values, targets } = &channel.keys else { continue };
                let times = &clip.timelines()[channel.timeline as usize];
                for target in 0..*targets {
                    let values = values.iter().skip(target).step_by(*targets);
                    let values = values.map(|&value| DVec4::new(value.into(), 0.0, 0.0, 0.0));
                    sources.insert(target, Source::new(Kind::Numbers, channel.interpolation, times, values));
                }
            }
            for property in clip.properties() {
                if let PropertyTarget::MorphWeight(other, target) = property.target
                    && other == joint
                {
                    let times = &clip.property_timelines()[property.timeline as usize];
                    let values = property.values.iter().map(|&value| DVec4::new(value.into(), 0.0, 0.0, 0.0));
                    sources.insert(target, Source::new(Kind::Numbers, property.interpolation, times, values));
                }
            }
            for (target, source) in sources {
                let keys = fit(&source, tolerance::WEIGHT, DVec3::ZERO);
                let rest = f64::from(rest.get(target).copied().unwrap_or_default());
                let rests = keys.values.iter().all(|value| (value.x - rest).abs() <= tolerance::WEIGHT);
                if rests && keys.segments.len() <= 1 {
                    continue;
                }
                let objects = meshes.iter().filter_map(|channels| channels.get(target));
                all.extend(objects.map(|&object| Curves { object, target: WEIGHT, keys: keys.clone() }));
            }
        }
    }
}

/// Multiplies quaternions that needn't be of length 1, such as tangents.
fn times_quaternion(a: DQuat, b: DQuat) -> DQuat {
    if b == DQuat::IDENTITY {
        return a;
    }
    let (v, u) = (DVec3::new(a.x, a.y, a.z), DVec3::new(b.x, b.y, b.z));
    let xyz = u * a.w + v * b.w + v.cross(u);
    DQuat::from_xyzw(xyz.x, xyz.y, xyz.z, a.w * b.w - v.dot(u))
}

/// Returns the angles of a joint at rest.
pub fn rest_angles(rotation: &DQuat) -> DVec3 {
    crate::euler::nearest(*rotation, DVec3::ZERO)
}

impl Curves {
    fn write(self, layer: Id, objects: &mut Objects) {
        let Curves { object, target, keys } = self;
        let first = keys.values.first().copied().unwrap_or_default() * target.unit;
        let mut properties = Properties::new();
        for (curve, value) in target.curves.iter().zip(first.to_array()) {
            properties = properties.number(curve, value);
        }
        let node = objects
            .add("AnimationCurveNode", (target.node, "AnimCurveNode", ""), |record| record.with(properties.record()));
        objects.connect(node, layer);
        objects.connect_property(node, object, target.property);
        let times: Vec<i64> = keys.times.iter().map(|&time| ticks(time)).collect();
        for (axis, name) in target.curves.iter().enumerate() {
            let curve = objects
                .add("AnimationCurve", ("", "AnimCurve", ""), |record| fill(record, &times, &keys, axis, target.unit));
            objects.connect_property(curve, node, name);
        }
    }
}

/// Adds the keys of one axis.
fn fill(record: Record, times: &[i64], keys: &Keys, axis: usize, unit: f64) -> Record {
    let values: Vec<f32> = keys.values.iter().map(|value| (value[axis] * unit) as f32).collect();
    let (mut flags, mut data, mut counts): (Vec<i32>, Vec<[u32; 4]>, Vec<i32>) = (Vec::new(), Vec::new(), Vec::new());
    for segment in &keys.segments {
        let slope = |slope: f64| ((slope * unit) as f32).to_bits();
        let (flag, slopes) = match *segment {
            Segment::Step => (CONSTANT, [0, 0]),
            Segment::Linear => (LINEAR, [0, 0]),
            Segment::Cubic(out, arrival) => (CUBIC | OWN_SLOPES, [slope(out[axis]), slope(arrival[axis])]),
        };
        let attribute = [slopes[0], slopes[1], WEIGHTS, 0];
        // Keys of the same kind share their attributes.
        match (flags.last(), data.last(), counts.last_mut()) {
            (Some(&last), Some(&same), Some(count)) if last == flag && same == attribute => *count += 1,
            _ => {
                flags.push(flag);
                data.push(attribute);
                counts.push(1);
            }
        }
    }
    let data: Vec<f32> = data.into_iter().flatten().map(f32::from_bits).collect();
    record
        .with(Record::new("Default").f64(values.first().copied().unwrap_or_default().into()))
        .with(Record::new("KeyVer").i32(4009))
        .with(Record::new("KeyTime").i64s(times))
        .with(Record::new("KeyValueFloat").f32s(&values))
        .with(Record::new("KeyAttrFlags").i32s(&flags))
        .with(Record::new("KeyAttrDataFloat").f32s(&data))
        .with(Record::new("KeyAttrRefCount").i32s(&counts))
}
