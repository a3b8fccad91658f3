//! Sorts a set of files by content: models, motions to borrow, a joint map.

use gaitway_character::asset::{Asset, Image, Panorama};
use gaitway_formats::limits::MAX_MAP_BYTES;
use gaitway_formats::{
    FileSet, HdrError, LoadError, LoadOptions, is_hdr, load, load_noticing_images, main_files, read_hdr,
};
use gaitway_retarget::{JointMapFile, MapError};
use gaitway_scene::editor::OpenedMap;
use gaitway_scene::library::Library;

/// What the user opens the files for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Role {
    /// Files with meshes are models, and so are those without clips. Others are motions.
    #[default]
    Any,
    /// A model is required; a motion by itself is shown as one.
    Model,
    /// Every file is a motion, with or without meshes.
    Motion,
}

/// The files of a set by content, each with its name in the set.
#[derive(Debug, Default)]
pub struct Sorted {
    /// Files to show as models.
    pub models: Vec<(String, Asset)>,
    /// Files to borrow clips from.
    pub motions: Vec<(String, Asset)>,
    /// `None` if no file is a joint map.
    pub map: Option<OpenedMap>,
    /// An .hdr image with its name in the set; the last of several.
    pub environment: Option<(String, Panorama)>,
}

/// Why a set of files cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SortError {
    /// A file cannot be loaded, or none is a model or motion.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// Exactly one model was expected.
    #[error("several models at once ({}); name one of them with its own files, in an archive as ARCHIVE#!/FILE", found.join(", "))]
    SeveralModels {
        /// What the models are called.
        found: Vec<String>,
    },
    /// More models than the library holds.
    #[error("more than {max} models at once; open fewer")]
    TooManyModels {
        /// [`Library::MAX_MODELS`].
        max: usize,
    },
    /// A model was expected, and no single motion can stand in for it.
    #[error("several motions and no model ({}); open one of them, or a model together with them", found.join(", "))]
    NoModel {
        /// Names of the files; for many, the last entry counts the rest.
        found: Vec<String>,
    },
    /// A joint map is invalid.
    #[error("{file}: {problem}")]
    Map {
        /// Name of the file.
        file: String,
        /// Why it is invalid.
        problem: MapError,
    },
    /// A joint map exceeds the size limit.
    #[error("{file}: expected a joint map of at most {max} bytes, found {found}")]
    MapTooLarge {
        /// Name of the file.
        file: String,
        /// [`MAX_MAP_BYTES`].
        max: usize,
        /// Its size.
        found: usize,
    },
    /// At most one joint map can be opened.
    #[error("several joint maps at once ({}); open only one of them", found.join(", "))]
    SeveralMaps {
        /// Names of the first two.
        found: Vec<String>,
    },
    /// An .hdr image cannot be read.
    #[error("{file}: {problem}")]
    Hdr {
        /// Name of the file.
        file: String,
        /// What is wrong with it.
        problem: HdrError,
    },
    /// More motions than the library holds.
    #[error("more than {max} motions at once; open fewer")]
    TooManyMotions {
        /// [`Library::MAX_MOTIONS`].
        max: usize,
    },
}

/// Maximum number of names listed in an error.
const MAX_NAMES: usize = 8;

/// Loads every model and motion of a set, and its joint map.
pub fn sort(files: &FileSet, role: Role) -> Result<Sorted, SortError> {
    sort_noticing_images(files, role, &mut |_, _| ())
}

/// Like [`sort`]; `on_images` is called with each file's name and images as soon as they are known.
pub(super) fn sort_noticing_images(
    files: &FileSet,
    role: Role,
    on_images: &mut dyn FnMut(&str, &[Image]),
) -> Result<Sorted, SortError> {
    let mut sorted = Sorted { map: find_map(files)?, environment: find_environment(files)?, ..Sorted::default() };
    let names = main_files(files);
    if names.is_empty() && sorted.environment.is_some() && role != Role::Model {
        return Ok(sorted);
    }
    if names.is_empty() && (sorted.map.is_none() || role == Role::Model) {
        // Nothing but JSON was meant as a joint map, unless it is one and a model is required.
        if sorted.map.is_none()
            && let Some((name, bytes)) = files.iter().next()
            && files.iter().all(|(name, _)| is_json(name))
        {
            read_map(name, bytes)?;
        }
        // The error says what is there instead.
        return load(files).map(|_| sorted).map_err(SortError::from);
    }
    for name in names {
        let on_images = &mut |images: &[Image]| on_images(&name, images);
        let asset = load_noticing_images(files, &name, &LoadOptions::default(), on_images)?;
        let is_model = match role {
            Role::Any => !asset.instances.is_empty() || asset.clips.is_empty(),
            Role::Model => !asset.instances.is_empty(),
            Role::Motion => false,
        };
        if is_model {
            sorted.models.push((name, asset))
        } else {
            sorted.motions.push((name, asset))
        }
        if sorted.models.len() > Library::MAX_MODELS {
            return Err(SortError::TooManyModels { max: Library::MAX_MODELS });
        }
        if sorted.motions.len() > Library::MAX_MOTIONS {
            return Err(SortError::TooManyMotions { max: Library::MAX_MOTIONS });
        }
    }
    if role == Role::Model && sorted.models.is_empty() {
        if sorted.motions.len() > 1 {
            return Err(SortError::NoModel { found: few_names(&sorted.motions) });
        }
        sorted.models.extend(sorted.motions.pop());
    }
    Ok(sorted)
}

fn few_names(files: &[(String, Asset)]) -> Vec<String> {
    let mut names: Vec<String> = files.iter().take(MAX_NAMES).map(|(name, _)| name.clone()).collect();
    if files.len() > MAX_NAMES {
        names.push(format!("{} more", files.len() - MAX_NAMES));
    }
    names
}

fn find_environment(files: &FileSet) -> Result<Option<(String, Panorama)>, SortError> {
    let Some((name, bytes)) = files.iter().filter(|(_, bytes)| is_hdr(bytes)).last() else { return Ok(None) };
    let read = read_hdr(bytes).map_err(|problem| SortError::Hdr { file: name.to_owned(), problem })?;
    Ok(Some((name.to_owned(), read)))
}

/// Finds the joint map among the files: JSON with the key `gaitway_map`. Other JSON is ignored.
fn find_map(files: &FileSet) -> Result<Option<OpenedMap>, SortError> {
    let mut found: Option<OpenedMap> = None;
    for (name, bytes) in files.iter() {
        let has_key = || bytes.windows(13).any(|window| window == b"\"gaitway_map\"");
        if !is_json(name) || !has_key() {
            continue;
        }
        let map = read_map(name, bytes)?;
        if let Some(first) = found {
            return Err(SortError::SeveralMaps { found: vec![first.name, name.to_owned()] });
        }
        found = Some(OpenedMap { name: name.to_owned(), map });
    }
    Ok(found)
}

fn is_json(name: &str) -> bool {
    name.to_lowercase().ends_with(".json")
}

/// Parses a joint map; errors refer to it as `file`.
pub fn read_map(file: &str, bytes: &[u8]) -> Result<JointMapFile, SortError> {
    if bytes.len() > MAX_MAP_BYTES {
        return Err(SortError::MapTooLarge { file: file.to_owned(), max: MAX_MAP_BYTES, found: bytes.len() });
    }
    JointMapFile::from_json(&String::from_utf8_lossy(bytes))
        .map_err(|problem| SortError::Map { file: file.to_owned(), problem })
}
