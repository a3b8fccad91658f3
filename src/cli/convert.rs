//! `gaitway convert`: any readable model as one GLB.

use anyhow::{Context, bail};

use super::borrow::{Borrowing, state_of_link};
use super::{ConvertArguments, open};
use crate::editor::ModelFiles;
use crate::files::read_set;
use crate::formats::{LoadOptions, convert, write_model};
use crate::library::Library;
use crate::state::written_skeleton;

pub(super) fn run(arguments: &ConvertArguments) -> anyhow::Result<()> {
    let bytes = match &arguments.view {
        Some(link) => posed(arguments, link)?,
        None => {
            let set = read_set(&arguments.input.files)?;
            let unit = arguments.unit.map(|unit| unit.metres());
            convert(&set, &LoadOptions { bvh_unit_metres: unit, ..LoadOptions::default() })?
        }
    };
    std::fs::write(&arguments.out, bytes).with_context(|| format!("{}", arguments.out.display()))
}

/// A model of another format as it stands in a view.
fn posed(arguments: &ConvertArguments, link: &str) -> anyhow::Result<Vec<u8>> {
    let opened = open(&arguments.input.files)?;
    let ModelFiles { set, name } = match &opened.model_files {
        Some(files) if opened.model.asset.format == "obj" => files.clone(),
        _ => bail!("{}: --view is for .obj: a file that is a glTF already is written as it is", opened.model.source),
    };
    let mut library = Library::default();
    library.set(opened.model);
    let state = state_of_link(&mut library, link, &Borrowing::default())?;
    let skeleton = library.active().map(|model| written_skeleton(model, &state, true)).unwrap_or_default();
    Ok(write_model(&set, &name, &skeleton, &[])?)
}
