//! Clips: sampling and writing.

use std::path::PathBuf;
use std::sync::Arc;

use gaitway::cli::functions::{Made, save_clip};
use gaitway_character::anim;
use numpy::{Ix3, PyArray1, PyArray4};
use pyo3::prelude::*;

use crate::arrays::{Arrays, Sampled, Space, TimesLike, array, read_times, sample, sample_matrices};
use crate::error::raised;
use crate::file::Source;

/// An animation of the joints of a file: its own, or one retargeted to them.
#[pyclass(frozen, module = "gaitway")]
pub struct Clip {
    pub source: Source,
    which: Which,
}

/// One of the clips for a skeleton.
pub enum Which {
    /// Index into the file's own clips.
    Own(usize),
    Made(Arc<Made>),
}

impl Clip {
    pub fn new(source: Source, which: Which) -> Self {
        Self { source, which }
    }

    pub fn core(&self) -> &anim::Clip {
        match &self.which {
            Which::Own(index) => &self.source.asset().clips[*index],
            Which::Made(made) => &made.clip,
        }
    }
}

#[pymethods]
impl Clip {
    /// The name that the file gives it; may be empty.
    #[getter]
    fn name(&self) -> &str {
        self.core().name()
    }

    /// The time of the last key in seconds.
    #[getter]
    fn duration_secs(&self) -> f32 {
        self.core().duration_secs()
    }

    /// The frame rate that the clip was authored at, as far as its keys show it, otherwise 30.
    #[getter]
    fn frames_per_sec(&self) -> f64 {
        match &self.which {
            Which::Own(_) => self.core().frames_per_sec(),
            Which::Made(made) => made.frames_per_sec,
        }
    }

    /// The times of all keys in seconds, sorted, each once.
    #[getter]
    fn key_times<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        let mut times: Vec<f32> = self.core().key_times_secs().collect();
        times.sort_by(f32::total_cmp);
        times.dedup();
        PyArray1::from_vec(py, times)
    }

    /// Samples all joints at times in seconds: returns positions (times × joints × 3) and rotations (times × joints × 4).
    ///
    /// They are relative to the model or, with `space="parent"`, to the parent joint. Before the first key and after the last one,
    /// the clip holds its pose. Rotations relative to the model are products of joint rotations, without any scale; an avatar's
    /// spring bones, constraints and gaze are not part of the clip.
    #[pyo3(signature = (times, space = "model"))]
    fn sample<'py>(&self, py: Python<'py>, times: TimesLike<'py>, space: &str) -> PyResult<Arrays<'py, Ix3>> {
        let (times, space, skeleton) = (read_times(&times)?, Space::read(space)?, self.source.skeleton());
        let Sampled { positions, rotations } = py.detach(|| sample(skeleton, self.core(), &times, space));
        let [times, joints] = [times.len(), skeleton.len()];
        Ok((array(py, [times, joints, 3], positions)?, array(py, [times, joints, 4], rotations)?))
    }

    /// Samples the transform of each joint relative to the model, scale included: matrices (times × joints × 4 × 4) for column
    /// vectors, so that `matrices @ [x, y, z, 1]` is a point in the model.
    fn matrices<'py>(&self, py: Python<'py>, times: TimesLike<'py>) -> PyResult<Bound<'py, PyArray4<f32>>> {
        let (times, skeleton) = (read_times(&times)?, self.source.skeleton());
        let matrices = py.detach(|| sample_matrices(skeleton, self.core(), &times));
        array(py, [times.len(), skeleton.len(), 4, 4], matrices)
    }

    /// Writes the clip with its joints, without meshes, as .glb, .bvh or .vrma.
    ///
    /// Files that were read are never overwritten.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        raised(py.detach(|| {
            let source = &self.source;
            save_clip(&path, source.model(), self.core(), self.frames_per_sec(), source.files_read())
        }))
    }

    fn __repr__(&self) -> String {
        format!("<gaitway.Clip “{}”, {:.3} s>", self.name(), self.duration_secs())
    }
}
