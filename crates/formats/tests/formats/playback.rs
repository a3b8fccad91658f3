//! Real clips, sampled by the optimized code and by the formulas of glTF 2.0 appendix C, one joint at a time in f64.

use gaitway_character::anim::{
    Clip, Interpolation, JointIndex, Keys, SampleCursor, Skeleton, Transform, model_from_joint,
};
use gaitway_formats::load;
use glam::{Affine3A, DAffine3, DQuat, DVec3, DVec4};

use crate::data_folder::data_folder;
use crate::file_set::file_set;
use crate::model_files::models_under;
use crate::sweep::GLTF;

/// Relative to the model's size.
const TOLERANCE: f64 = 1e-5;

struct Local {
    translation: DVec3,
    rotation: DQuat,
    scale: DVec3,
}

impl From<Transform> for Local {
    fn from(local: Transform) -> Self {
        let Transform { translation, rotation, scale } = local;
        Self { translation: translation.as_dvec3(), rotation: rotation.as_dquat(), scale: scale.as_dvec3() }
    }
}

/// Two keys, the seconds between them, and the position of the time from 0 to 1.
struct Segment {
    keys: [usize; 2],
    length_secs: f64,
    factor: f64,
}

fn segment(times: &[f32], time_secs: f32) -> Segment {
    let key = times.iter().rposition(|&start| start <= time_secs).unwrap_or(0);
    match times.get(key + 1) {
        Some(&end) if time_secs > times[key] => {
            let [start, end, time] = [times[key], end, time_secs].map(f64::from);
            Segment { keys: [key, key + 1], length_secs: end - start, factor: (time - start) / (end - start) }
        }
        _ => Segment { keys: [key, key], length_secs: 0.0, factor: 0.0 },
    }
}

impl Segment {
    fn value(&self, interpolation: Interpolation, at: impl Fn(usize) -> DVec4) -> DVec4 {
        let ([from, to], t) = (self.keys, self.factor);
        match interpolation {
            Interpolation::Step => at(from),
            Interpolation::Linear => at(from).lerp(at(to), t),
            Interpolation::CubicSpline => {
                let (t2, t3) = (t * t, t * t * t);
                at(3 * from + 1) * (2.0 * t3 - 3.0 * t2 + 1.0)
                    + at(3 * from + 2) * (self.length_secs * (t3 - 2.0 * t2 + t))
                    + at(3 * to + 1) * (3.0 * t2 - 2.0 * t3)
                    + at(3 * to) * (self.length_secs * (t3 - t2))
            }
        }
    }

    /// `None` between rotations half a turn apart, where both ways round are equally short.
    fn rotation(&self, interpolation: Interpolation, at: impl Fn(usize) -> DVec4) -> Option<DQuat> {
        let unit = |value: DVec4| DQuat::from_vec4(value.try_normalize().unwrap_or(DVec4::W));
        if interpolation != Interpolation::Linear {
            return Some(unit(self.value(interpolation, at)));
        }
        let [from, to] = self.keys.map(|key| unit(at(key)));
        if from.dot(to).abs() < 1e-6 {
            return None;
        }
        let to = if from.dot(to) < 0.0 { -to } else { to };
        let angle = 2.0 * (0.5 * (to - from).length()).asin();
        if angle < 1e-9 {
            return Some(from);
        }
        let weights = [(1.0 - self.factor) * angle, self.factor * angle].map(|part| part.sin() / angle.sin());
        Some(from * weights[0] + to * weights[1])
    }
}

/// Model-space transforms of all joints; `None` where the clip leaves a joint's direction of rotation ambiguous.
fn reference(skeleton: &Skeleton, clip: &Clip, time_secs: f32) -> Option<Vec<DAffine3>> {
    let mut locals: Vec<Local> = skeleton.rest().locals().map(Local::from).collect();
    for channel in clip.channels() {
        let at = segment(&clip.timelines()[channel.timeline as usize], time_secs);
        let local = &mut locals[channel.joint.get()];
        match &channel.keys {
            Keys::Translation(values) => {
                let value = at.value(channel.interpolation, |key| values[key].as_dvec3().extend(0.0));
                local.translation = value.truncate();
            }
            Keys::Scale(values) => {
                local.scale = at.value(channel.interpolation, |key| values[key].as_dvec3().extend(0.0)).truncate();
            }
            Keys::Rotation(values) => {
                local.rotation = at.rotation(channel.interpolation, |key| values[key].as_dquat().into())?;
            }
            Keys::MorphWeights { .. } => {}
        }
    }
    let mut model: Vec<DAffine3> = Vec::new();
    for (local, parent) in locals.iter().zip(skeleton.parents()) {
        let parent = parent.map_or(DAffine3::IDENTITY, |parent| model[parent.get()]);
        let Local { translation, rotation, scale } = *local;
        model.push(parent * DAffine3::from_scale_rotation_translation(scale, rotation.normalize(), translation));
    }
    Some(model)
}

/// Returns the largest deviation of a joint, relative to the model's size; 0 without a reference.
fn deviation(skeleton: &Skeleton, clip: &Clip, time_secs: f32) -> (f64, JointIndex) {
    let mut pose = skeleton.rest().clone();
    clip.sample(skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
    let mut found = Vec::new();
    model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut found);
    let Some(expected) = reference(skeleton, clip, time_secs) else { return (0.0, JointIndex(0)) };
    let size = expected.iter().map(|joint| joint.translation.length()).fold(1e-9, f64::max);
    skeleton
        .joints()
        .map(|joint| {
            let off = found[joint.get()].translation.as_dvec3() - expected[joint.get()].translation;
            (off.length() / size, joint)
        })
        .fold((0.0, JointIndex(0)), |worst, off| if off.0 > worst.0 { off } else { worst })
}

#[test]
fn every_clip_plays_as_its_keys_say() {
    let Some(data) = data_folder() else { return };
    let mut paths = Vec::new();
    models_under(&data, &[&GLTF[..], &["bvh"]].concat(), &mut paths);
    let (mut clips, mut worst, mut failures) = (0, 0.0_f64, Vec::new());
    for path in paths {
        let Ok(asset) = load(&file_set(&path)) else { continue };
        for clip in &asset.clips {
            clips += 1;
            for share in [0.0, 0.013, 0.21, 0.377, 0.5, 0.618, 0.83, 0.97, 1.0] {
                let time_secs = share * clip.duration_secs();
                let (off, joint) = deviation(&asset.skeleton, clip, time_secs);
                worst = worst.max(off);
                if off > TOLERANCE {
                    let joint = asset.skeleton.label(joint);
                    failures.push(format!("{}: {} at {time_secs} s: {joint}: {off:e}", path.display(), clip.name()));
                }
            }
        }
    }
    println!("{clips} clips, off by {worst:e} of the size at most");
    assert!(clips > 300, "only {clips} clips");
    assert!(failures.is_empty(), "{} of {clips} clips:\n{}", failures.len(), failures.join("\n"));
}
