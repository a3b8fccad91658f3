//! `gaitway convert`: converts any supported model to a single GLB.

use super::failure::{Failure, Outcome};
use super::motion::{MotionArguments, Overrides, apply_link, open_editor};
use super::output::write_output;
use super::retarget::model_extensions;
use super::{ConvertArguments, open, print_warnings};
use crate::editor::Export;
use crate::files::{Disk, Opened, Role, SortError, member_of, sort};
use crate::formats::{LoadOptions, convert_named, write_model};

pub(super) fn run(arguments: &ConvertArguments, disk: &Disk) -> Outcome {
    let (bytes, extensions) = match &arguments.view {
        Some(link) => (posed(arguments, link, disk)?, vec!["glb"]),
        None => unposed(arguments, disk)?,
    };
    write_output(&arguments.out, &bytes, &extensions, disk)
}

/// Writes the only model of the files, or their only motion, and returns the extensions that fit.
fn unposed(arguments: &ConvertArguments, disk: &Disk) -> Outcome<(Vec<u8>, Vec<&'static str>)> {
    let set = disk.read_set(&arguments.input.files)?;
    if set.is_empty() {
        return Err(Failure::new("a sample that is generated has no file to convert; name a file"));
    }
    let mut models = sort(&set, Role::Model)?.models;
    let members: Vec<&str> = arguments.input.files.iter().filter_map(|path| member_of(path)).collect();
    if models.iter().any(|(name, _)| members.contains(&&**name)) {
        models.retain(|(name, _)| members.contains(&&**name));
    }
    let found = models.iter().map(|(name, _)| name.clone()).collect();
    let [(name, asset)] = &models[..] else { return Err(SortError::SeveralModels { found }.into()) };
    let bytes = match arguments.unit {
        Some(unit) => {
            let options = LoadOptions { bvh_unit_metres: Some(unit.metres()), ..LoadOptions::default() };
            convert_named(&set, name, &options)?
        }
        None => {
            print_warnings(name, &asset.warnings);
            write_model(&set, name, &asset.skeleton, &[])?
        }
    };
    Ok((bytes, model_extensions(asset)))
}

/// Writes a model of another format in the pose of a link.
fn posed(arguments: &ConvertArguments, link: &str, disk: &Disk) -> Outcome<Vec<u8>> {
    // Motions and maps beside the model are not part of its pose.
    let opened = Opened { motions: Vec::new(), map: None, ..open(&arguments.input.files, disk)? };
    let format = opened.model.asset.format;
    if format != "obj" {
        let failure =
            Failure::expected("an .obj", format!("a .{format}")).with_hint("other models are written unchanged");
        return Err(failure.at("--view").in_file(&opened.model.source));
    }
    let mut editor = open_editor(opened, &MotionArguments::default(), disk)?;
    apply_link(&mut editor, link, &MotionArguments::default(), Overrides::default(), disk)?;
    Ok(editor.export(Export::FullModel { posed: true })?.bytes)
}
