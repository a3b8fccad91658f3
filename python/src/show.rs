//! Showing a scene in a notebook: a frame with a self-contained page.

use std::path::PathBuf;

use gaitway::cli::functions::{self, Backend, PageOptions};
use gaitway::files::save_file;
use pyo3::prelude::*;

use crate::error::{argument_error, raised};
use crate::file::{Model, Motion};
use crate::retarget::read_map;

/// Notebook servers cut the output of a cell at 3 MB.
const MAX_BYTES: usize = 2_900_000;

/// A self-contained page that shows a scene. The last value of a notebook's cell is displayed.
#[pyclass(frozen, module = "gaitway")]
pub struct Scene {
    html: String,
    title: String,
    height: u32,
    /// The frame shows this file instead of holding the page.
    file: Option<String>,
    files_read: Vec<PathBuf>,
}

#[pymethods]
impl Scene {
    /// The page: a document of its own, which needs neither a network nor other files.
    #[getter]
    fn html(&self) -> &str {
        &self.html
    }

    /// Writes the page to a file.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| save_file(&path, self.html.as_bytes(), &self.files_read))
            .map_err(|problem| argument_error(problem.to_string()))
    }

    /// Returns the frame that notebooks display.
    fn _repr_html_(&self) -> String {
        let Self { height, .. } = self;
        let title = escaped(&self.title);
        let source = match &self.file {
            Some(file) => format!("src='{}'", escaped(file)),
            None => format!("srcdoc='{}'", escaped(&self.html)),
        };
        format!(
            "<iframe sandbox='allow-scripts' title='{title}' width='100%' height='{height}' style='border: 0' {source}></iframe>"
        )
    }

    fn __repr__(&self) -> String {
        format!("<gaitway.Scene {}, {:.1} MB>", self.title, self.html.len() as f64 / 1e6)
    }
}

/// Escapes a text for HTML between single quotation marks, of which pages have fewer than double ones.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('\'', "&#39;")
}

/// Shows a model in a notebook, with a motion retargeted to it, to orbit and play.
///
/// Everything is inside the output, which works offline and can be shared with the notebook. `clip` is a name or an index, of the
/// motion's clips first; `view` is a link of the page, or its part after `#`, with the camera and all else. `map` is a joint map: a
/// dictionary or the path of a file. `renderer` is `"webgl2"`, for every current browser, or `"webgpu"`, which is smaller. With
/// `file`, the page is written there and the frame shows it: for scenes that are larger than notebooks take. `page` is the folder
/// with the page's program, if it isn't where the package was installed.
#[pyfunction]
#[pyo3(signature = (model, motion = None, *, clip = None, view = None, map = None, title = None, renderer = "webgl2", height = 480, file = None, page = None))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments")]
pub fn show(
    py: Python<'_>,
    model: PyRef<'_, Model>,
    motion: Option<PyRef<'_, Motion>>,
    clip: Option<&Bound<'_, PyAny>>,
    view: Option<String>,
    map: Option<&Bound<'_, PyAny>>,
    title: Option<String>,
    renderer: &str,
    height: u32,
    file: Option<PathBuf>,
    page: Option<PathBuf>,
) -> PyResult<Scene> {
    let backend = match renderer {
        "webgl2" => Backend::WebGl2,
        "webgpu" => Backend::WebGpu,
        other => return Err(argument_error(format!("renderer: expected webgl2 or webgpu, found {other}"))),
    };
    let clip = clip.map(|clip| Ok::<_, PyErr>(clip.str()?.to_string())).transpose()?;
    let map = map.map(read_map).transpose()?;
    let prefix: PathBuf = py.import("sys")?.getattr("prefix")?.extract()?;
    let (model, motion) = (model.0.clone(), motion.map(|motion| motion.0.clone()));
    let title = title.unwrap_or_else(|| model.content.model.source.clone());
    let mut files_read = model.files_read.clone();
    files_read.extend(motion.iter().flat_map(|motion| motion.files_read.iter().cloned()));
    let html = py.detach(|| {
        let options = PageOptions {
            clip: clip.as_deref(),
            view: view.as_deref(),
            title: Some(&title),
            backend,
            folder: page.as_deref(),
            prefix: Some(&prefix),
            files_read: &files_read,
        };
        functions::page(&model.content, motion.as_deref().map(|motion| &motion.content), map, options)
    });
    let address = file.as_ref().map(|file| file.display().to_string());
    let scene = Scene { html: raised(html)?, title, height, file: address, files_read };
    match file {
        Some(file) => scene.write(py, file)?,
        None => check_size(&scene, backend)?,
    }
    Ok(scene)
}

/// Refuses what notebooks would cut.
fn check_size(scene: &Scene, backend: Backend) -> PyResult<()> {
    let bytes = scene._repr_html_().len();
    if bytes <= MAX_BYTES {
        return Ok(());
    }
    let smaller = if backend == Backend::WebGl2 { "show it with renderer=\"webgpu\", " } else { "" };
    Err(argument_error(format!(
        "the scene: expected at most {:.1} MB, which notebooks take, found {:.1} MB; {smaller}make the model's textures smaller, or \
         keep it in a file beside the notebook with file=\"scene.html\"",
        MAX_BYTES as f64 / 1e6,
        bytes as f64 / 1e6,
    )))
}
