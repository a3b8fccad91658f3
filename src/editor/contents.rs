//! The result of opening files, before anything is done with it.

use crate::formats::FileSet;
use crate::library::{Model, Motion};
use crate::retarget::JointMapFile;

/// Opened files, ready for the library.
#[derive(Debug, Default)]
pub struct Contents {
    /// The first is shown; the others join the list of models.
    pub models: Vec<OpenedModel>,
    /// `None` keeps the motions already loaded.
    pub motions: Option<Vec<Motion>>,
    pub map: Option<JointMapFile>,
    /// The map is one of the user's local files.
    pub has_own_map: bool,
    /// Parts that could not be opened although the rest could.
    pub problems: Vec<String>,
}

/// A model that is not in the library yet.
#[derive(Debug)]
pub struct OpenedModel {
    pub model: Model,
    /// The model's own files, needed to write it with another clip. `None` for samples made in code.
    pub files: Option<ModelFiles>,
}

/// The files a model was read from, and the name of its main file.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelFiles {
    pub set: FileSet,
    pub name: String,
}

impl From<Model> for OpenedModel {
    fn from(model: Model) -> Self {
        Self { model, files: None }
    }
}

impl Contents {
    /// Marks everything as the user's local files.
    pub fn owned(mut self) -> Self {
        self.models.iter_mut().for_each(|opened| opened.model.is_own = true);
        self.motions.iter_mut().flatten().for_each(|motion| motion.is_own = true);
        self.has_own_map = self.map.is_some();
        self
    }

    /// Origins a view must list to load these motions again. Motions from the model's own archive are left out, since they
    /// come with it.
    pub fn motion_sources(motions: &[Motion], model: Option<&str>) -> Vec<String> {
        let mut sources: Vec<String> = Vec::new();
        for motion in motions {
            if model.map(container_of) != Some(&motion.origin) && !sources.contains(&motion.origin) {
                sources.push(motion.origin.clone());
            }
        }
        sources
    }
}

/// Separates a folder or archive from the path of a model inside it, for every model but the first. The notation is the
/// one used for .jar entries, except that `#` makes it the fragment of a URL, which is never sent to the server.
pub const MEMBER: &str = "#!/";

/// Returns the folder or archive a model came out of: `ARCHIVE` for `ARCHIVE#!/MEMBER`, any other origin unchanged.
pub fn container_of(origin: &str) -> &str {
    origin.split_once(MEMBER).map_or(origin, |(container, _)| container)
}
