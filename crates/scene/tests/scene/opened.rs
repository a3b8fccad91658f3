//! Opens samples and files without what the shells add: archives, addresses and decoded images.

use std::path::Path;

use gaitway_character::asset::Asset;
use gaitway_formats::{FileSet, load, prepare};
use gaitway_scene::editor::{Contents, ModelFiles, OpenedModel};
use gaitway_scene::library::{Model, Motion};
use gaitway_scene::samples;

use crate::file_set::prepared;

/// A sample, or a file by its path in the repository.
fn files(source: &str) -> Option<(FileSet, String)> {
    let Some(sample) = source.strip_prefix("sample:") else {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(source);
        let name = path.file_name()?.to_string_lossy().into_owned();
        return Some((prepared(&path).ok()?, name));
    };
    let mut set = FileSet::default();
    samples::files(sample).for_each(|(file, bytes)| set.insert(file, bytes));
    let name = set.names().next()?.to_owned();
    prepare(&mut set).ok()?;
    Some((set, name))
}

fn asset(source: &str) -> Option<(Asset, ModelFiles)> {
    let (set, name) = files(source)?;
    Some((load(&set).ok()?, ModelFiles { set, name }))
}

fn model_of(source: &str, asset: Asset) -> Model {
    let images = vec![None; asset.images.len()];
    Model::new(source.to_owned(), asset, images)
}

/// A model, also from a file that only has a motion; none if the file is invalid.
pub fn try_model(source: &str) -> Option<Model> {
    Some(model_of(source, asset(source)?.0))
}

/// A model, also from a file that only has a motion.
pub fn model(source: &str) -> Model {
    try_model(source).unwrap_or_else(|| panic!("{source}: no model"))
}

/// A motion, also from a file that has a model.
pub fn motion(source: &str) -> Motion {
    Motion::new(source.to_owned(), asset(source).unwrap_or_else(|| panic!("{source}: no motion")).0.into())
}

/// Models and motions, told apart as the shells do; none if a file is invalid.
pub fn try_contents(sources: &[&str]) -> Option<Contents> {
    let (mut models, mut motions) = (Vec::new(), Vec::new());
    for source in sources {
        if let Some(sample) = source.strip_prefix("sample:").and_then(samples::load) {
            models.push(OpenedModel::from(sample));
            continue;
        }
        let (asset, files) = asset(source)?;
        if asset.instances.is_empty() && !asset.clips.is_empty() {
            motions.push(Motion::new((*source).to_owned(), asset.into()));
        } else {
            models.push(OpenedModel { model: model_of(source, asset), files: Some(files) });
        }
    }
    Some(Contents { models, motions: (!motions.is_empty()).then_some(motions), ..Contents::default() })
}

/// Models and motions, told apart as the shells do.
pub fn contents(sources: &[&str]) -> Contents {
    try_contents(sources).unwrap_or_else(|| panic!("{sources:?}: invalid"))
}
