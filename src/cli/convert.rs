//! `gaitway convert`: converts any supported model to a single GLB.

use anyhow::{Context, Error, bail};

use super::motion::{MotionArguments, apply_link, open_editor};
use super::{ConvertArguments, open};
use crate::editor::Export;
use crate::files::{Opened, read_set};
use crate::formats::{LoadOptions, convert};

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

/// Writes a model of another format in the pose of a link.
fn posed(arguments: &ConvertArguments, link: &str) -> anyhow::Result<Vec<u8>> {
    // Motions and maps beside the model are not part of its pose.
    let opened = Opened { motions: Vec::new(), map: None, ..open(&arguments.input.files)? };
    if opened.model.asset.format != "obj" {
        bail!("{}: --view: expected an .obj; a glTF file is written unchanged", opened.model.source);
    }
    let mut editor = open_editor(opened, &MotionArguments::default())?;
    apply_link(&mut editor, link, &MotionArguments::default())?;
    Ok(editor.export(Export::Whole { posed: true }).map_err(Error::msg)?.bytes)
}
