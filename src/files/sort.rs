//! What a set of files is: models, motions to borrow, a joint map. The same on disk and on the page.

use crate::asset::{Asset, Image};
use crate::formats::{FileSet, LoadError, LoadOptions, load, load_noticing_images, main_files};
use crate::library::{ImageData, Library, Model, Motion};
use crate::retarget::{JointMap, MapError};
use crate::state::MEMBER_SEPARATOR;

/// What the files were chosen for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Role {
    /// As it turns out: what has a mesh is the model, what has none is motion.
    #[default]
    Any,
    /// There has to be a model; a motion by itself is shown as one.
    Model,
    /// To borrow from, meshes or not.
    Motion,
}

/// A set of files by what they are, each with its name in the set.
#[derive(Debug, Default)]
pub struct Sorted {
    pub models: Vec<(String, Asset)>,
    pub motions: Vec<(String, Asset)>,
    pub map: Option<JointMap>,
}

/// What was opened, ready for the library.
#[derive(Debug, Default)]
pub struct Contents {
    /// The first is shown, the others are there to turn to.
    pub models: Vec<OpenedModel>,
    /// None: those that are there stay.
    pub motions: Option<Vec<Motion>>,
    pub map: Option<JointMap>,
    pub has_own_map: bool,
    /// What could not be had, though the rest could.
    pub problems: Vec<String>,
}

/// A model on its way into the library.
#[derive(Debug)]
pub struct OpenedModel {
    pub model: Model,
    /// What it was read from, and which of it is the model: for writing it with another clip. None for samples.
    pub files: Option<ModelFiles>,
}

/// The set that a model was read from, and the name of its main file.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelFiles {
    pub set: FileSet,
    pub name: String,
}

impl OpenedModel {
    /// A model of a set, as its file `name`.
    pub(super) fn of(
        set: &FileSet,
        origins: &Origins,
        name: String,
        asset: Asset,
        images: Vec<Option<ImageData>>,
    ) -> Self {
        let (origin, source) = origins.origin_and_source(&name);
        let mut model = Model::new(source, asset, images);
        model.origin = origin;
        Self { model, files: Some(ModelFiles { set: set.clone(), name }) }
    }
}

impl From<Model> for OpenedModel {
    fn from(model: Model) -> Self {
        Self { model, files: None }
    }
}

/// Why a set of files is of no use.
#[derive(Debug, thiserror::Error)]
pub enum SortError {
    #[error(transparent)]
    Load(#[from] LoadError),
    #[error("several models at once ({}); name one of them with its own files", found.join(", "))]
    SeveralModels { found: Vec<String> },
    #[error("more than {most} models at once; choose some of them")]
    TooManyModels { most: usize },
    #[error("several motions and no model ({}); open one of them, or a model together with them", found.join(", "))]
    NoModel { found: Vec<String> },
    #[error("{file}: {problem}")]
    Map { file: String, problem: MapError },
    #[error("several joint maps at once ({}); one counts, open it alone", found.join(", "))]
    SeveralMaps { found: Vec<String> },
    #[error("{found} motions at once; at most {most} are borrowed from, choose some of them")]
    TooManyMotions { found: usize, most: usize },
}

/// As many names are told of what is too many.
const MOST_NAMES: usize = 8;

/// Reads every main file of a set.
pub fn sort(files: &FileSet, role: Role) -> Result<Sorted, SortError> {
    sort_noticing_images(files, role, &mut |_, _| ())
}

/// As [`sort`]; `on_images` gets the name of each file with its images as soon as these are known.
pub(super) fn sort_noticing_images(
    files: &FileSet,
    role: Role,
    on_images: &mut dyn FnMut(&str, &[Image]),
) -> Result<Sorted, SortError> {
    let files = files.unpacked()?;
    let mut sorted = Sorted { map: find_map(&files)?, ..Sorted::default() };
    let names = main_files(&files)?;
    if names.is_empty() && (sorted.map.is_none() || role == Role::Model) {
        // Which says what is there instead.
        let asset = load(&files)?;
        sorted.models.push((String::new(), asset));
        return Ok(sorted);
    }
    if names.len() > Library::MOST_MOTIONS {
        return Err(SortError::TooManyMotions { found: names.len(), most: Library::MOST_MOTIONS });
    }
    for name in names {
        let on_images = &mut |images: &[Image]| on_images(&name, images);
        let asset = load_noticing_images(&files, &name, &LoadOptions::default(), on_images)?;
        let has_mesh = !asset.instances.is_empty();
        if has_mesh && role != Role::Motion {
            sorted.models.push((name, asset))
        } else {
            sorted.motions.push((name, asset))
        }
        if sorted.models.len() > Library::MOST_MODELS {
            return Err(SortError::TooManyModels { most: Library::MOST_MODELS });
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
    let mut names: Vec<String> = files.iter().take(MOST_NAMES).map(|(name, _)| name.clone()).collect();
    if files.len() > MOST_NAMES {
        names.push(format!("{} more", files.len() - MOST_NAMES));
    }
    names
}

/// The joint map among the files: JSON that says so. Other JSON is none of our business.
fn find_map(files: &FileSet) -> Result<Option<JointMap>, SortError> {
    let mut found: Option<(String, JointMap)> = None;
    for (name, bytes) in files.iter() {
        let says_so = || bytes.windows(13).any(|window| window == b"\"gaitway_map\"");
        if !name.to_lowercase().ends_with(".json") || !says_so() {
            continue;
        }
        let map = read_map(name, bytes)?;
        if let Some((first, _)) = found {
            return Err(SortError::SeveralMaps { found: vec![first, name.to_owned()] });
        }
        found = Some((name.to_owned(), map));
    }
    Ok(found.map(|(_, map)| map))
}

/// A joint map; `file` is what errors call it.
pub fn read_map(file: &str, bytes: &[u8]) -> Result<JointMap, SortError> {
    JointMap::from_json(&String::from_utf8_lossy(bytes))
        .map_err(|problem| SortError::Map { file: file.to_owned(), problem })
}

/// The folder or archive that one of its models came out of; of anything else, itself.
pub(super) fn container_of(origin: &str) -> &str {
    origin.split_once(MEMBER_SEPARATOR).map_or(origin, |(container, _)| container)
}

/// Where the files of a set came from: by their names in it, the path or address that a view lists.
#[derive(Debug, Default)]
pub(super) struct Origins {
    pub known: Vec<(String, String)>,
    /// For files that came out of a folder or an archive: its own.
    pub other: String,
}

impl Origins {
    /// Where a file came from, and what it is called: as that, or by its own name where it came out of something.
    fn origin_and_source(&self, name: &str) -> (String, String) {
        match self.known.iter().find(|(known, _)| known == name) {
            Some((_, origin)) => (origin.clone(), origin.clone()),
            None => (self.other.clone(), name.to_owned()),
        }
    }

    /// Everything of a sorted set, ready for the library, in the order in which it was asked for. `models` are those of the
    /// set with their images; samples are models, unless everything is to be borrowed from.
    pub fn contents(&self, sorted: Sorted, mut models: Vec<OpenedModel>, samples: Vec<Model>, role: Role) -> Contents {
        let (borrowed_from, shown) = if role == Role::Motion { (samples, Vec::new()) } else { (Vec::new(), samples) };
        models.extend(shown.into_iter().map(OpenedModel::from));
        // The first model of an archive is meant by the archive's name.
        let mut seen: Vec<String> = Vec::new();
        for OpenedModel { model, files } in &mut models {
            match files {
                Some(files) if seen.contains(&model.origin) => {
                    model.origin = format!("{}{MEMBER_SEPARATOR}{}", model.origin, files.name);
                }
                _ => seen.push(model.origin.clone()),
            }
        }
        let place = |model: &OpenedModel| self.known.iter().position(|(_, origin)| *origin == model.model.origin);
        models.sort_by_key(|model| place(model).unwrap_or(usize::MAX));
        let is_missing = |origin: &str| {
            let is_there = models.iter().any(|opened| opened.model.origin == origin);
            role != Role::Motion && container_of(origin) != origin && !is_there
        };
        let missing = self.known.iter().filter(|(_, origin)| is_missing(origin));
        let problem = |(_, origin): &(String, String)| {
            format!("{origin}: there is no such model in this file; its first one is shown")
        };
        let problems = missing.map(problem).collect();
        let of_set = |(name, asset): (String, Asset)| {
            let (origin, source) = self.origin_and_source(&name);
            let mut motion = Motion::new(source, asset.into());
            motion.origin = origin;
            motion
        };
        let of_sample = |sample: Model| Motion::new(sample.source, sample.asset);
        let motions = sorted.motions.into_iter().map(of_set).chain(borrowed_from.into_iter().map(of_sample));
        let motions: Vec<Motion> = motions.collect();
        let motions = (!motions.is_empty()).then_some(motions);
        Contents { motions, models, map: sorted.map, problems, ..Contents::default() }
    }
}

impl Contents {
    /// Says that all of it is a person's own.
    pub fn owned(mut self) -> Self {
        self.models.iter_mut().for_each(|opened| opened.model.is_own = true);
        self.motions.iter_mut().flatten().for_each(|motion| motion.is_own = true);
        self.has_own_map = self.map.is_some();
        self
    }

    /// What a view has to list to get motions again: where they came from, but for what comes along with its model.
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
