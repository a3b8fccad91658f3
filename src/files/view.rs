//! Opens everything a view lists: its model, the motions it borrows from and its joint maps.

use std::cell::Cell;
use std::ffi::OsStr;
use std::io::ErrorKind;

use gaitway_retarget::JointMapFile;
use gaitway_scene::editor::Contents;
use gaitway_scene::library::{Environment, Library, Model, Motion, container_of};
use gaitway_scene::state::{
    CharacterView, EnvironmentChoice, MotionMap, RetargetEdits, Sources, ViewerState, is_to_bring,
};

use super::open::{open_items, open_read};
use super::read::{Item, read_available};
use super::source::{Content, Progress, Reading, Source};
use super::{OpenError, Role, SortError, read_map};

/// Loaded files that need not be opened again, identified by their origin.
#[derive(Debug, Clone, Copy, Default)]
pub struct Held<'a> {
    /// The library's motions.
    pub motions: &'a [Motion],
    /// The library's environment images.
    pub environments: &'a [Environment],
}

impl<'a> Held<'a> {
    fn motions_of(self, origin: &str) -> impl Iterator<Item = &'a Motion> {
        self.motions.iter().filter(move |motion| motion.origin == origin)
    }

    fn has_motion(self, origin: &str) -> bool {
        self.motions_of(origin).next().is_some()
    }
}

/// Opens the files of a view that aren't `held`; its model only if `with_model` is set. If the user has yet to supply
/// the model, returns an empty stage and opens nothing else. What cannot be opened beside a model becomes a problem of the
/// contents. In the view, maps replace the addresses they were read from. Progress is reported as "2 of 3:
/// walk.bvh".
pub(super) async fn open_view<S: Source>(
    source: &S,
    view: ViewerState,
    with_model: bool,
    held: Held<'_>,
    progress: Progress<'_>,
) -> Result<(Contents, ViewerState), OpenError> {
    if let Some(awaited) = view.character.sources.model.iter().find(|model| with_model && is_to_bring(model)) {
        let models = vec![Model::placeholder(awaited).into()];
        return Ok((Contents { models, motions: Some(Vec::new()), ..Contents::default() }, view));
    }
    let Sources { model: mut models, motion: motions, scene } = view.character.sources;
    let RetargetEdits { map: maps, .. } = view.character.retarget;
    let map_files = maps.iter().take(Library::MAX_MOTIONS).filter(|map| matches!(map, MotionMap::File(_))).count();
    let light = match &view.lighting.environment {
        EnvironmentChoice::File(origin) if !held.environments.iter().any(|held| held.origin == *origin) => Some(origin),
        _ => None,
    };
    let parts = usize::from(with_model)
        + usize::from(light.is_some())
        + motions.iter().take(Library::MAX_MOTIONS).filter(|origin| !held.has_motion(origin)).count()
        + map_files;
    let part = Cell::new(0);
    let next_part = || part.set(part.get() + 1);
    let progress = &|name: &str, received: u64, total: u64| match parts {
        0 | 1 => progress(name, received, total),
        _ => progress(&format!("{} of {parts}: {name}", part.get()), received, total),
    };
    let mut contents = Contents::default();
    if with_model {
        next_part();
        contents = open_models(source, &mut models, progress).await?;
    }
    // Motions from the model's own archive are not listed.
    let is_of_model = |motion: &&Motion| {
        models.iter().any(|model| container_of(model) == motion.origin) && !motions.contains(&motion.origin)
    };
    let mut opened = contents.motions.take().unwrap_or_default();
    opened.extend(held.motions.iter().filter(is_of_model).cloned());
    for (index, origin) in motions.iter().enumerate() {
        if index == Library::MAX_MOTIONS {
            // A link may list thousands, for which there is no room.
            omit(source, "motion", &SortError::TooManyMotions { max: index }.into(), &mut contents);
            break;
        }
        if held.has_motion(origin) {
            opened.extend(held.motions_of(origin).cloned());
        } else {
            next_part();
            opened.extend(open_motion(source, origin, &mut contents, progress).await);
        }
    }
    if let Some(origin) = light {
        next_part();
        open_environment(source, origin, &mut contents, progress).await;
    }
    contents.motions = Some(opened);
    let mut read_maps = Vec::new();
    // One for each motion.
    for map in maps.into_iter().take(Library::MAX_MOTIONS) {
        if matches!(map, MotionMap::File(_)) {
            next_part();
        }
        read_maps.extend(read_map_of(source, map, &mut contents, progress).await);
    }
    let sources = Sources { model: models, motion: motions, scene };
    let retarget = RetargetEdits { map: read_maps, ..view.character.retarget };
    Ok((contents, ViewerState { character: CharacterView { sources, retarget, ..view.character }, ..view }))
}

/// Opens a motion of a view, with a joint map beside it. A failure becomes a problem of the contents.
async fn open_motion<S: Source>(
    source: &S,
    origin: &str,
    contents: &mut Contents,
    progress: Progress<'_>,
) -> Vec<Motion> {
    match open_items(source, vec![Item::Address(origin.into())], Role::Motion, progress).await {
        Ok(found) => {
            contents.map = contents.map.take().or(found.map);
            found.motions.unwrap_or_default()
        }
        Err(error) => {
            omit(source, "motion", &error, contents);
            Vec::new()
        }
    }
}

/// Records that a view is opened without one of its files.
fn omit<S: Source>(source: &S, part: &str, error: &OpenError, contents: &mut Contents) {
    contents.problems.push(source.describe_omission(part, error));
    contents.failure.get_or_insert(error.code());
}

/// Adds the image that lights a view to the contents. A failure becomes a problem of the contents.
async fn open_environment<S: Source>(source: &S, origin: &String, contents: &mut Contents, progress: Progress<'_>) {
    match open_items(source, vec![Item::Address(origin.into())], Role::Any, progress).await {
        // The view's own name for it.
        Ok(Contents { environment: Some(found), .. }) => {
            contents.environment = Some(Environment { origin: origin.clone(), ..found });
        }
        Ok(_) => contents.problems.push(format!("{origin}: expected an .hdr image")),
        Err(error) => omit(source, "light", &error, contents),
    }
}

/// Reads a map if it is a file. One that cannot be read becomes a problem of the contents.
async fn read_map_of<S: Source>(
    source: &S,
    map: MotionMap,
    contents: &mut Contents,
    progress: Progress<'_>,
) -> Option<MotionMap> {
    let MotionMap::File(address) = &map else { return Some(map) };
    let read = open_map(source, address.as_ref(), progress).await;
    let read = read.inspect_err(|error| omit(source, "map", error, contents));
    read.ok().map(|map| MotionMap::of_file(&map))
}

/// How many files of models a view may name: a link may list thousands, and a model may be several, such as an .obj with its .skel and
/// .attach.
const MAX_MODEL_FILES: usize = 64;

/// Opens the models that a view lists; one of several that cannot be read becomes a problem of the contents. If the one it names is
/// not in its archive, the archive's first one is named instead.
async fn open_models<S: Source>(
    source: &S,
    models: &mut [String],
    progress: Progress<'_>,
) -> Result<Contents, OpenError> {
    if models.len() > MAX_MODEL_FILES {
        return Err(SortError::TooManyModels { max: Library::MAX_MODELS }.into());
    }
    let items = models.iter().map(|model| Item::Address(model.into())).collect();
    let (read, failed) = read_available(source, items, progress).await?;
    let mut contents = match open_read(source, read, Role::Model).await {
        Ok(contents) => contents,
        // The rest is nothing without what is missing, such as the .skel of an .obj.
        Err(error) => return Err(failed.into_iter().next().unwrap_or(error)),
    };
    failed.iter().for_each(|error| omit(source, "model", error, &mut contents));
    if let [model] = models
        && !contents.models.iter().any(|opened| opened.model.origin == *model)
    {
        *model = container_of(model).to_owned();
    }
    Ok(contents)
}

pub(super) async fn open_map<S: Source>(
    source: &S,
    address: &OsStr,
    progress: Progress<'_>,
) -> Result<JointMapFile, OpenError> {
    match source.locate(address)?.content {
        Content::File { place, name, .. } => {
            let bytes = source.read(&place, &name, &mut Reading::new(progress)).await?;
            Ok(read_map(&name, &bytes)?)
        }
        Content::Folder(_) => Err(OpenError::Read { path: address.into(), source: ErrorKind::IsADirectory.into() }),
    }
}
