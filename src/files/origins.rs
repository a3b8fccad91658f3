//! Where the files of a set came from, which decides what models and motions are called and what a view lists to open them
//! again.

use gaitway_character::asset::Asset;
use gaitway_character::sort::sort_by_key;
use gaitway_formats::{FileSet, with_references};
use gaitway_scene::editor::{Contents, ModelFiles, OpenedModel};
use gaitway_scene::library::{Derived, Environment, ImageData, Model, Motion, container_of};
use gaitway_scene::state::MEMBER_SEPARATOR;

use super::{Role, Sorted};

#[derive(Debug, Default)]
pub(super) struct Origins {
    /// Name in the set and origin of each file that was asked for, in that order.
    pub known: Vec<(String, String)>,
    /// Name in the set and folder or archive of each file that came from one.
    pub members: Vec<(String, String)>,
    /// The origin of all other files.
    pub container: String,
}

impl Origins {
    /// Returns a file's origin and display name. A file from a folder or an archive goes by its own name.
    fn origin_and_source(&self, name: &str) -> (String, String) {
        let find = |list: &[(String, String)]| list.iter().find(|(known, _)| known == name).map(|(_, of)| of.clone());
        match find(&self.known) {
            Some(origin) => (origin.clone(), origin),
            None => (find(&self.members).unwrap_or_else(|| self.container.clone()), name.to_owned()),
        }
    }

    pub fn model(
        &self,
        set: &FileSet,
        name: String,
        asset: Asset,
        derived: Derived,
        images: Vec<Option<ImageData>>,
    ) -> OpenedModel {
        let (origin, source) = self.origin_and_source(&name);
        let mut model = Model::with_derived(source, asset, derived, images);
        model.origin = origin;
        OpenedModel { model, files: Some(ModelFiles { set: set.clone(), name }) }
    }

    fn motion(&self, set: &FileSet, name: String, asset: Asset) -> Motion {
        let (origin, source) = self.origin_and_source(&name);
        let mut motion = Motion::new(source, asset.into());
        motion.origin = origin;
        // A folder may have hundreds of others.
        motion.files = Some(ModelFiles { set: with_references(set, &name), name });
        motion
    }

    /// Gathers everything in the order it was asked for. `models` are the models of the set; `samples` join them unless the
    /// role is [`Role::Motion`].
    pub fn contents(
        &self,
        set: &FileSet,
        sorted: Sorted,
        mut models: Vec<OpenedModel>,
        samples: Vec<Model>,
        role: Role,
    ) -> Contents {
        let mut motions: Vec<Motion> =
            sorted.motions.into_iter().map(|(name, asset)| self.motion(set, name, asset)).collect();
        if role == Role::Motion {
            motions.extend(samples.into_iter().map(|sample| Motion::new(sample.source, sample.asset)));
        } else {
            models.extend(samples.into_iter().map(OpenedModel::from));
        }
        name_members(&mut models);
        let place_of = |origin: &str| self.known.iter().position(|(_, known)| known == origin);
        let place = |origin: &str| place_of(origin).or_else(|| place_of(container_of(origin))).unwrap_or(usize::MAX);
        sort_by_key(&mut models, |opened| place(&opened.model.origin));
        let problems = if role == Role::Motion { Vec::new() } else { self.missing_members(&models) };
        let motions = (!motions.is_empty()).then_some(motions);
        let environment = sorted.environment.map(|(name, panorama)| Environment {
            origin: self.origin_and_source(&name).0,
            panorama: panorama.into(),
            file: set.get(&name).cloned().unwrap_or_default(),
            is_own: false,
        });
        Contents { motions, models, map: sorted.map, environment, problems, ..Contents::default() }
    }

    /// Reports models that were asked for by their path in an archive which has no such model.
    fn missing_members(&self, models: &[OpenedModel]) -> Vec<String> {
        let is_missing = |origin: &&String| {
            container_of(origin) != *origin && !models.iter().any(|opened| opened.model.origin == **origin)
        };
        let asked = self.known.iter().map(|(_, origin)| origin);
        asked
            .filter(is_missing)
            .map(|origin| format!("{origin}: there is no such model in this file; its first one is shown"))
            .collect()
    }
}

/// Adds the path inside the archive to the origin of every model but its first, which goes by the archive's name.
fn name_members(models: &mut [OpenedModel]) {
    let mut seen: Vec<String> = Vec::new();
    for OpenedModel { model, files } in models {
        match files {
            Some(files) if seen.contains(&model.origin) => {
                model.origin = format!("{}{MEMBER_SEPARATOR}{}", model.origin, files.name);
            }
            _ => seen.push(model.origin.clone()),
        }
    }
}
