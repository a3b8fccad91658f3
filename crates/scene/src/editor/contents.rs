//! The result of opening files, before it enters the library.

use gaitway_retarget::JointMapFile;
use gaitway_session::ErrorCode;

use crate::library::{Environment, Model, ModelFiles, Motion, container_of};
use crate::state::LinkError;

/// Opened files, ready for the library.
#[derive(Debug, Default)]
pub struct Contents {
    /// The first becomes active; the others join the model list.
    pub models: Vec<OpenedModel>,
    /// Added to the motions already loaded. Together with models, an empty list removes those; `None` keeps them.
    pub motions: Option<Vec<Motion>>,
    /// A joint map for the motions; `None` if none was opened.
    pub map: Option<OpenedMap>,
    /// Lights the scene from now on; `None` if none was opened.
    pub environment: Option<Environment>,
    /// The map is one of the user's local files.
    pub is_map_private: bool,
    /// The user opened it, not a link or a script: settings that suit it may be chosen.
    pub is_by_hand: bool,
    /// What could not be opened although the rest could.
    pub problems: Vec<String>,
    /// Code of the first problem, if known.
    pub failure: Option<ErrorCode>,
    /// Of the link whose view is opened.
    pub about_link: AboutLink,
}

/// What is known of a link besides the view that it describes.
#[derive(Debug, Default)]
pub struct AboutLink {
    /// What was not understood of it.
    pub errors: Vec<LinkError>,
    /// It still waits for some of its files. Until they are there, nothing is said about what it names and the model lacks, and
    /// the first clip stands in for an unknown one.
    pub is_partial: bool,
}

/// A joint map that was just read.
#[derive(Debug)]
pub struct OpenedMap {
    /// Name of its file, for messages.
    pub name: String,
    /// The map itself.
    pub map: JointMapFile,
}

/// A model that is not in the library yet.
#[derive(Debug)]
pub struct OpenedModel {
    /// Gets its id from the library.
    pub model: Model,
    /// The model's own files, needed to write it with another clip. `None` for generated samples.
    pub files: Option<ModelFiles>,
}

impl From<Model> for OpenedModel {
    fn from(model: Model) -> Self {
        Self { model, files: None }
    }
}

impl Contents {
    /// Marks everything as the user's local files.
    pub fn into_private(mut self) -> Self {
        self.models.iter_mut().for_each(|opened| opened.model.is_own = true);
        self.motions.iter_mut().flatten().for_each(|motion| motion.is_own = true);
        self.environment.iter_mut().for_each(|environment| environment.is_own = true);
        self.is_map_private = self.map.is_some();
        self
    }

    /// Returns the origins that a view must list to load these motions again. Motions from the model's own archive are left out,
    /// since they are loaded with it.
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
