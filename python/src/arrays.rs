//! From poses to NumPy arrays and back. Arrays own the vectors that were sampled into; nothing is copied.

use std::fmt::Display;

use gaitway_character::anim::{
    Clip, ClipBuilder, Interpolation, JointIndex, Keys, Pose, SampleCursor, Skeleton, model_from_joint,
};
use glam::{Affine3A, Mat4, Quat, Vec3};
use numpy::ndarray::{Array, ArrayView1, ArrayView3, Axis, Dimension, IntoDimension};
use numpy::{AllowTypeChange, PyArray, PyArrayLike1, PyArrayLike3};
use pyo3::prelude::*;

use crate::error::argument_error;

/// Any sequence of numbers.
pub type TimesLike<'py> = PyArrayLike1<'py, f32, AllowTypeChange>;
/// Numbers by frame, joint and component.
pub type KeysLike<'py> = PyArrayLike3<'py, f32, AllowTypeChange>;

/// Arrays of positions and of rotations.
pub type Arrays<'py, D> = (Bound<'py, PyArray<f32, D>>, Bound<'py, PyArray<f32, D>>);

/// What positions and rotations of a joint are relative to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Space {
    Model,
    Parent,
}

impl Space {
    pub fn read(text: &str) -> PyResult<Self> {
        match text {
            "model" => Ok(Self::Model),
            "parent" => Ok(Self::Parent),
            other => Err(argument_error(format!("space: expected “model” or “parent”, found “{other}”"))),
        }
    }
}

/// Positions and rotations, three and four numbers for each joint of each pose.
#[derive(Default)]
pub struct Sampled {
    pub positions: Vec<f32>,
    pub rotations: Vec<f32>,
}

impl Sampled {
    /// Appends the joints of a pose.
    pub fn push(&mut self, skeleton: &Skeleton, pose: &Pose, space: Space, scratch: &mut Scratch) {
        match space {
            Space::Parent => pose.locals().for_each(|local| self.push_joint(local.translation, local.rotation)),
            Space::Model => {
                model_from_joint(skeleton, pose, Affine3A::IDENTITY, &mut scratch.model_from_joint);
                scratch.rotations.clear();
                for (local, parent) in pose.locals().zip(skeleton.parents()) {
                    let of_parent = parent.map_or(Quat::IDENTITY, |parent| scratch.rotations[parent.get()]);
                    scratch.rotations.push((of_parent * local.rotation).normalize());
                }
                for (model_from_joint, &rotation) in scratch.model_from_joint.iter().zip(&scratch.rotations) {
                    self.push_joint(model_from_joint.translation.into(), rotation);
                }
            }
        }
    }

    fn push_joint(&mut self, position: Vec3, rotation: Quat) {
        self.positions.extend(position.to_array());
        self.rotations.extend(rotation.to_array());
    }
}

/// Buffers reused between poses.
#[derive(Default)]
pub struct Scratch {
    model_from_joint: Vec<Affine3A>,
    rotations: Vec<Quat>,
}

/// Samples a clip at each time.
pub fn sample(skeleton: &Skeleton, clip: &Clip, times_secs: &[f32], space: Space) -> Sampled {
    let mut sampled = Sampled {
        positions: Vec::with_capacity(times_secs.len() * skeleton.len() * 3),
        rotations: Vec::with_capacity(times_secs.len() * skeleton.len() * 4),
    };
    let mut scratch = Scratch::default();
    for_each_pose(skeleton, clip, times_secs, |pose| sampled.push(skeleton, pose, space, &mut scratch));
    sampled
}

/// Samples the model-space matrices of a clip at each time: 16 numbers per joint, row by row.
pub fn sample_matrices(skeleton: &Skeleton, clip: &Clip, times_secs: &[f32]) -> Vec<f32> {
    let mut matrices = Vec::with_capacity(times_secs.len() * skeleton.len() * 16);
    let mut model = Vec::new();
    for_each_pose(skeleton, clip, times_secs, |pose| {
        model_from_joint(skeleton, pose, Affine3A::IDENTITY, &mut model);
        matrices.extend(model.iter().flat_map(|&joint| Mat4::from(joint).transpose().to_cols_array()));
    });
    matrices
}

fn for_each_pose(skeleton: &Skeleton, clip: &Clip, times_secs: &[f32], mut each: impl FnMut(&Pose)) {
    let (mut pose, mut cursor) = (skeleton.rest().clone(), SampleCursor::default());
    for &time_secs in times_secs {
        clip.sample(skeleton, time_secs, &mut cursor, &mut pose);
        each(&pose);
    }
}

/// Turns a vector into an array that owns it.
pub fn array<'py, D: Dimension>(
    py: Python<'py>,
    shape: impl IntoDimension<Dim = D>,
    values: Vec<f32>,
) -> PyResult<Bound<'py, PyArray<f32, D>>> {
    let array = Array::from_shape_vec(shape.into_dimension(), values);
    Ok(PyArray::from_owned_array(py, array.map_err(|problem| argument_error(problem.to_string()))?))
}

/// Reads times; an error names the first one that isn't finite.
pub fn read_times(times: &TimesLike) -> PyResult<Vec<f32>> {
    let times = times.as_array().to_vec();
    match times.iter().find(|time| !time.is_finite()) {
        Some(time) => Err(argument_error(format!("times: expected finite numbers of seconds, found {time}"))),
        None => Ok(times),
    }
}

/// Builds a clip from the rotations and translations of all joints, relative to their parents. What stays at rest gets no
/// channel, except the first joint's rotation, which gives the clip its length.
pub fn clip_of(
    skeleton: &Skeleton,
    name: &str,
    times_secs: &[f32],
    rotations: ArrayView3<f32>,
    translations: Option<ArrayView3<f32>>,
) -> PyResult<Clip> {
    check_shape("rotations", &rotations, [times_secs.len(), skeleton.len(), 4])?;
    if let Some(translations) = &translations {
        check_shape("translations", translations, [times_secs.len(), skeleton.len(), 3])?;
    }
    let mut builder = ClipBuilder::new(name, skeleton);
    for joint in skeleton.joints() {
        let rest = skeleton.rest().local(joint);
        let turned = rotation_keys(rotations, joint)?;
        let turned = (joint.get() == 0 || turned.iter().any(|&key| key != rest.rotation)).then_some(turned);
        let moved = translations.map(|translations| translation_keys(translations, joint)).transpose()?;
        let moved = moved.filter(|keys| keys.iter().any(|&key| key != rest.translation));
        for keys in turned.map(Keys::Rotation).into_iter().chain(moved.map(Keys::Translation)) {
            let added = builder.channel(joint, Interpolation::Linear, times_secs, keys);
            added.map_err(|problem| argument_error(format!("times: {problem}")))?;
        }
    }
    Ok(builder.build())
}

fn check_shape(name: &str, array: &ArrayView3<f32>, expected: [usize; 3]) -> PyResult<()> {
    if array.shape() == expected {
        return Ok(());
    }
    let message =
        format!("{name}: expected an array of times × joints × components, {expected:?}, found {:?}", array.shape());
    Err(argument_error(message))
}

fn rotation_keys(rotations: ArrayView3<f32>, joint: JointIndex) -> PyResult<Vec<Quat>> {
    let read = |at: ArrayView1<f32>| Quat::from_xyzw(at[0], at[1], at[2], at[3]);
    let is_valid = |key: &Quat| key.is_finite() && key.length_squared() > 0.0;
    keys_of("rotations", "a quaternion", rotations, joint, read, is_valid)
}

fn translation_keys(translations: ArrayView3<f32>, joint: JointIndex) -> PyResult<Vec<Vec3>> {
    let read = |at: ArrayView1<f32>| Vec3::new(at[0], at[1], at[2]);
    keys_of("translations", "finite numbers", translations, joint, read, |key| key.is_finite())
}

/// Reads a joint's keys; an error names the first one that isn't valid.
fn keys_of<T: Display>(
    name: &str,
    expected: &str,
    array: ArrayView3<f32>,
    joint: JointIndex,
    read: impl Fn(ArrayView1<f32>) -> T,
    is_valid: impl Fn(&T) -> bool,
) -> PyResult<Vec<T>> {
    let of_joint = array.index_axis_move(Axis(1), joint.get());
    let keys: Vec<T> = of_joint.outer_iter().map(read).collect();
    match keys.iter().position(|key| !is_valid(key)) {
        Some(at) => {
            Err(argument_error(format!("{name}[{at}, {}]: expected {expected}, found {}", joint.get(), keys[at])))
        }
        None => Ok(keys),
    }
}
