//! Proposing joint maps and retargeting. Maps and reports are the documents of the command line, as dictionaries.

use std::path::PathBuf;
use std::sync::Arc;

use gaitway::cli::functions::{self, Made};
use gaitway_scene::editor::OpenedMap;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyList, PyString, PyTuple};
use serde_json::Value;

use crate::clip::{Clip, Which};
use crate::error::raised;
use crate::file::{Model, Motion, Source};

/// A retargeted clip, and how well it fits.
#[pyclass(frozen, module = "gaitway")]
pub struct Retargeted {
    model: Source,
    made: Arc<Made>,
}

#[pymethods]
impl Retargeted {
    /// The clip, for the joints of the model.
    #[getter]
    fn clip(&self) -> Clip {
        Clip::new(self.model.clone(), Which::Made(self.made.clone()))
    }

    /// The quality figures: a dictionary of numbers, None for what doesn't apply (docs/retargeting.md describes them).
    #[getter]
    fn figures(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        to_python(py, &self.made.document["figures"])
    }

    /// The document of `gaitway retarget --json`: mapped joints, figures, warnings and more.
    #[getter]
    fn report(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        to_python(py, &self.made.document)
    }

    fn __repr__(&self) -> String {
        format!("<gaitway.Retargeted “{}”, {:.3} s>", self.made.clip.name(), self.made.clip.duration_secs())
    }
}

/// Proposes which joint of the model follows which joint of the motion.
///
/// Returns the document of `gaitway map --json`, a dictionary with each joint's body part, reason and confidence. It can be changed
/// and given to `retarget`, or saved with `json.dump` for the page and the command line (docs/joint-maps.md describes it).
#[pyfunction]
pub fn propose_map(py: Python<'_>, model: PyRef<'_, Model>, motion: PyRef<'_, Motion>) -> PyResult<Py<PyAny>> {
    let (model, motion) = (&*model.0, &*motion.0);
    to_python(py, &raised(py.detach(|| functions::propose_map(&model.content.model, &motion.content)))?)
}

/// Retargets a clip of a motion to a model.
///
/// `map` is a joint map: a dictionary or the path of a file; without one it is proposed. Options are those of `gaitway retarget`
/// with `_` for `-`, which override the map: `clip="run"`, `feet="plant"`, `horizontal="in-place"`, `mirror=True`, `trim=(0.5, 1.7)`. A
/// list repeats an option.
#[pyfunction]
#[pyo3(signature = (model, motion, map = None, **options))]
pub fn retarget(
    py: Python<'_>,
    model: PyRef<'_, Model>,
    motion: PyRef<'_, Motion>,
    map: Option<&Bound<'_, PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Retargeted> {
    let map = map.map(read_map).transpose()?;
    let options = options.map(arguments).transpose()?.unwrap_or_default();
    let (model, motion) = (model.0.clone(), motion.0.clone());
    let made = py.detach(|| functions::retarget(&model.content.model, &motion.content, map.as_ref(), &options));
    Ok(Retargeted { made: Arc::new(raised(made)?), model: Source::Model(model) })
}

pub fn read_map(map: &Bound<'_, PyAny>) -> PyResult<OpenedMap> {
    if map.is_instance_of::<PyDict>() {
        let json: String = map.py().import("json")?.call_method1("dumps", (map,))?.extract()?;
        return raised(functions::parse_map("map", &json));
    }
    let path: PathBuf = map.extract()?;
    raised(map.py().detach(|| functions::load_map(&path)))
}

/// Writes keyword arguments as the command line has them: a flag is `True`, several numbers are a tuple, and a list or a dictionary
/// repeats the option. A `_` at the end, for names that Python reserves, is dropped.
pub fn arguments(options: &Bound<'_, PyDict>) -> PyResult<Vec<String>> {
    let mut arguments = Vec::new();
    for (name, value) in options {
        let name = format!("--{}", name.cast::<PyString>()?.to_string().trim_end_matches('_').replace('_', "-"));
        if let Ok(flag) = value.cast::<PyBool>() {
            arguments.extend(flag.is_true().then_some(name));
        } else if let Ok(numbers) = value.cast::<PyTuple>() {
            arguments.push(format!("{name}={}", texts(numbers)?.join(",")));
        } else if let Ok(values) = value.cast::<PyList>() {
            arguments.extend(texts(values)?.iter().map(|value| format!("{name}={value}")));
        } else if let Ok(values) = value.cast::<PyDict>() {
            for (key, value) in values {
                arguments.push(format!("{name}={}={}", key.str()?, value.str()?));
            }
        } else if !value.is_none() {
            arguments.push(format!("{name}={}", value.str()?));
        }
    }
    Ok(arguments)
}

fn texts(values: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    values.try_iter()?.map(|value| Ok(value?.str()?.to_string())).collect()
}

/// Turns a document into dictionaries, lists and numbers.
pub fn to_python(py: Python<'_>, document: &Value) -> PyResult<Py<PyAny>> {
    Ok(py.import("json")?.call_method1("loads", (document.to_string(),))?.unbind())
}
