//! Loaded files: models and motions.

use std::path::PathBuf;
use std::sync::Arc;

use gaitway::cli::functions::{self, Loaded};
use gaitway::files::Opened;
use gaitway_character::anim::{Clip as CoreClip, Skeleton};
use gaitway_character::asset::{Asset, AssetParts};
use gaitway_scene::library::{self, inspect};
use numpy::{Ix2, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Arrays, KeysLike, Sampled, Scratch, Space, TimesLike, array, clip_of, read_times};
use crate::clip::{Clip, Which};
use crate::error::{argument_error, raised};
use crate::retarget::{arguments, read_map, to_python};

/// Where clips and joints come from.
#[derive(Clone)]
pub enum Source {
    Model(Arc<Loaded<Opened>>),
    Motion(Arc<Loaded<library::Motion>>),
}

impl Source {
    pub fn asset(&self) -> &Asset {
        match self {
            Self::Model(model) => &model.content.model.asset,
            Self::Motion(motion) => &motion.content.asset,
        }
    }

    pub fn skeleton(&self) -> &Skeleton {
        &self.asset().skeleton
    }

    /// The file as a model, with or without meshes.
    pub fn model(&self) -> &library::Model {
        match self {
            Self::Model(model) => &model.content.model,
            Self::Motion(motion) => motion.content.stage(),
        }
    }

    pub fn files_read(&self) -> &[PathBuf] {
        match self {
            Self::Model(model) => &model.files_read,
            Self::Motion(motion) => &motion.files_read,
        }
    }
}

/// A loaded file: joints in their rest pose, and clips.
#[pyclass(frozen, subclass, module = "gaitway")]
pub struct File(pub Source);

#[pymethods]
impl File {
    /// The file's name, without its folder.
    #[getter]
    fn name(&self) -> &str {
        &self.0.model().source
    }

    /// The names of all joints, parents before their children. Arrays have the joints in this order. A joint without a name, or
    /// with one that others have too, is `#NODE`, its index in the file, as in joint maps.
    #[getter]
    fn joints(&self) -> Vec<String> {
        let skeleton = self.0.skeleton();
        skeleton.joints().map(|joint| skeleton.label(joint)).collect()
    }

    /// The index of each joint's parent in `joints`, -1 for a root.
    #[getter]
    fn parents<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        let parents = self.0.skeleton().parents().iter();
        PyArray1::from_vec(py, parents.map(|parent| parent.map_or(-1, |parent| parent.0 as i32)).collect())
    }

    /// The index of each joint in the file: the glTF node, or the BVH joint.
    #[getter]
    fn nodes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        let skeleton = self.0.skeleton();
        PyArray1::from_vec(py, skeleton.joints().map(|joint| skeleton.source_index(joint) as i32).collect())
    }

    /// The file's own clips.
    #[getter]
    fn clips(&self) -> Vec<Clip> {
        (0..self.0.asset().clips.len()).map(|index| Clip::new(self.0.clone(), Which::Own(index))).collect()
    }

    /// Returns positions (joints × 3) and rotations (joints × 4) of the rest pose, relative to the model or, with
    /// `space="parent"`, to the parent joint.
    #[pyo3(signature = (space = "model"))]
    fn rest<'py>(&self, py: Python<'py>, space: &str) -> PyResult<Arrays<'py, Ix2>> {
        let skeleton = self.0.skeleton();
        let mut sampled = Sampled::default();
        sampled.push(skeleton, skeleton.rest(), Space::read(space)?, &mut Scratch::default());
        let Sampled { positions, rotations } = sampled;
        Ok((array(py, [skeleton.len(), 3], positions)?, array(py, [skeleton.len(), 4], rotations)?))
    }

    /// Returns the document of `gaitway inspect --json`: what the file contains, and its warnings.
    fn inspect(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let names = match &self.0 {
            Source::Model(model) => model.content.files.clone(),
            Source::Motion(motion) => vec![motion.content.source.clone()],
        };
        to_python(py, &py.detach(|| inspect(self.0.model(), &names)))
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        let (kind, file) = (slf.get_type().name()?, slf.get());
        let (joints, clips) = (file.0.skeleton().len(), file.0.asset().clips.len());
        Ok(format!("<gaitway.{kind} {}, {joints} joints, {clips} clips>", file.name()))
    }
}

/// A file to retarget clips to, with its meshes.
#[pyclass(frozen, extends = File, module = "gaitway")]
pub struct Model(pub Arc<Loaded<Opened>>);

#[pymethods]
impl Model {
    /// Writes the model as a .glb (or a .vrm, if it was one) with more clips after its own: clips for the same joints.
    ///
    /// The file keeps everything else as it is. Files that were read are never overwritten.
    #[pyo3(signature = (path, clips = Vec::new()))]
    fn write(&self, py: Python<'_>, path: PathBuf, clips: Vec<PyRef<'_, Clip>>) -> PyResult<()> {
        let skeleton = &self.0.content.model.asset.skeleton;
        if let Some(other) = clips.iter().find(|clip| !have_same_joints(skeleton, clip.source.skeleton())) {
            let (clip, model) = (other.core().name(), &self.0.content.model.source);
            return Err(argument_error(format!(
                "clip “{clip}” is for other joints than those of {model}; retarget it first"
            )));
        }
        let clips: Vec<&Clip> = clips.iter().map(|clip| &**clip).collect();
        raised(py.detach(|| {
            let clips: Vec<&CoreClip> = clips.iter().map(|clip| clip.core()).collect();
            functions::save_model(&path, &self.0.content, &clips, &self.0.files_read)
        }))
    }

    /// Writes the model with its clips and those of motions, as `gaitway export` does: as one .glb or .fbx, or each clip as a file in a
    /// folder or .zip. Clips of the model's own rig keep their keys, others are retargeted.
    ///
    /// `map` is a joint map for all motions; without one it is proposed for each. Options are those of `gaitway export`:
    /// `clips=["walk", "run"]`, `rename={"walk": "Walk"}`, `for_="godot"`, `format="bvh"`. Returns the document of its `--json`: clips,
    /// files, and warnings, such as what the files can't hold. Files that were read are never overwritten.
    #[pyo3(signature = (path, motions = Vec::new(), map = None, **options))]
    fn export(
        &self,
        py: Python<'_>,
        path: PathBuf,
        motions: Vec<PyRef<'_, Motion>>,
        map: Option<&Bound<'_, PyAny>>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<PyAny>> {
        let map = map.map(read_map).transpose()?;
        let options = options.map(arguments).transpose()?.unwrap_or_default();
        let motions: Vec<Arc<Loaded<library::Motion>>> = motions.iter().map(|motion| motion.0.clone()).collect();
        let read =
            motions.iter().flat_map(|motion| &motion.files_read).chain(&self.0.files_read).cloned().collect::<Vec<_>>();
        let document = py.detach(|| {
            let motions = motions.iter().map(|motion| motion.content.clone()).collect();
            functions::export(&path, &self.0.content, motions, map, &options, &read)
        });
        to_python(py, &raised(document)?)
    }
}

fn have_same_joints(first: &Skeleton, second: &Skeleton) -> bool {
    first.parents() == second.parents() && first.joints().all(|joint| first.name(joint) == second.name(joint))
}

/// A file with clips to retarget.
#[pyclass(frozen, extends = File, module = "gaitway")]
pub struct Motion(pub Arc<Loaded<library::Motion>>);

#[pymethods]
impl Motion {
    /// Makes a motion with one clip for the joints of a file from arrays.
    ///
    /// `times` are seconds from 0; `rotations` (times × joints × 4) and `translations` (times × joints × 3) are relative to the
    /// parent joint, as `Clip.sample(times, space="parent")` returns them. Without translations, joints keep those of the rest.
    #[staticmethod]
    #[pyo3(signature = (file, times, rotations, translations = None, *, name = "arrays"))]
    fn from_arrays(
        py: Python<'_>,
        file: &File,
        times: TimesLike<'_>,
        rotations: KeysLike<'_>,
        translations: Option<KeysLike<'_>>,
        name: &str,
    ) -> PyResult<Py<Self>> {
        let asset = file.0.asset();
        let translations = translations.as_ref().map(|translations| translations.as_array());
        let clip = clip_of(&asset.skeleton, name, &read_times(&times)?, rotations.as_array(), translations)?;
        let parts = AssetParts {
            format: "arrays",
            skeleton: asset.skeleton.clone(),
            clips: vec![clip],
            humanoid: asset.humanoid.clone(),
            ..AssetParts::default()
        };
        let asset = Asset::new(parts).map_err(|problem| argument_error(problem.to_string()))?;
        let content = library::Motion::new(name.to_owned(), Arc::new(asset));
        Self::loaded(py, Loaded { content, files_read: Vec::new() })
    }
}

impl Motion {
    fn loaded(py: Python<'_>, loaded: Loaded<library::Motion>) -> PyResult<Py<Self>> {
        let shared = Arc::new(loaded);
        let file = File(Source::Motion(shared.clone()));
        Py::new(py, PyClassInitializer::from(file).add_subclass(Self(shared)))
    }
}

/// Loads a model with its parts: files, folders, archives, or `sample:NAME`, as `gaitway inspect` takes them.
#[pyfunction]
#[pyo3(signature = (*paths))]
pub fn load_model(py: Python<'_>, paths: Vec<PathBuf>) -> PyResult<Py<Model>> {
    let shared = Arc::new(raised(py.detach(|| functions::load_model(&paths)))?);
    let file = File(Source::Model(shared.clone()));
    Py::new(py, PyClassInitializer::from(file).add_subclass(Model(shared)))
}

/// Loads a motion: .glb, .gltf, .vrma, .fbx, .x, .bvh, .npy, .npz, with or without meshes.
#[pyfunction]
pub fn load_motion(py: Python<'_>, path: PathBuf) -> PyResult<Py<Motion>> {
    Motion::loaded(py, raised(py.detach(|| functions::load_motion(&path)))?)
}
