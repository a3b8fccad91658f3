//! `gaitway convert`: converts any supported model to a single GLB or FBX, or one of its clips to BVH or a VRM animation. Pages are
//! written by [`web_page`].

use std::path::Path;

use gaitway_character::asset::Asset;
use gaitway_fbx_writer::FbxOptions;
use gaitway_formats::{FileSet, LoadOptions, convert_named, load_named, write_edited_model, write_model};
use gaitway_retarget::ChangedClip;
use gaitway_scene::editor::{ClipFormat, Export, write_clip};
use gaitway_scene::library::{ClipEdits, ClipId, Library, Model, ModelClip};

use super::failure::{Failure, Outcome};
use super::motion::{MotionArguments, Overrides, apply_link, open_editor};
use super::output::{extension_of, print_error, warn, write_output};
use super::retarget::{choose_clip, clip_format_of, model_extensions};
use super::{ConvertArguments, Unit, open, print_warnings, web_page};
use crate::files::{Disk, Opened, Role, SortError, member_of, sort};

pub(super) fn run(arguments: &ConvertArguments, disk: &Disk) -> Outcome {
    if web_page::is_page(&arguments.out) {
        return web_page::run(arguments, disk);
    }
    if !arguments.page.is_none() {
        let failure = Failure::expected("an .html for --motion, --map, --title, --renderer and --page", "another file");
        return Err(failure.with_hint("use `gaitway retarget` for a model with a motion").at("--out"));
    }
    let (bytes, extensions) = match &arguments.view {
        Some(link) => (posed(arguments, link, disk)?, vec!["glb"]),
        None => unposed(arguments, disk)?,
    };
    if is_fbx(&arguments.out) {
        return write_output(&arguments.out, &fbx(&bytes)?, &["fbx"], disk);
    }
    write_output(&arguments.out, &bytes, &extensions, disk)
}

/// Whether the output is FBX.
pub(super) fn is_fbx(out: &Path) -> bool {
    extension_of(out).as_deref() == Some("fbx")
}

/// Converts a GLB to FBX and prints what that can't hold.
pub(super) fn fbx(glb: &[u8]) -> Outcome<Vec<u8>> {
    let written =
        gaitway_fbx_writer::fbx(glb, &FbxOptions::default()).map_err(|error| Failure::new(error.to_string()))?;
    written.warnings.iter().for_each(|warning| warn(warning));
    Ok(written.bytes)
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
    let Ok([(name, asset)]) = <[_; 1]>::try_from(models) else { return Err(SortError::SeveralModels { found }.into()) };
    if arguments.unit.is_some() && asset.format != "bvh" {
        let failure =
            Failure::expected("a .bvh", format!("a .{}", asset.format)).with_hint("other files say their unit");
        return Err(failure.at("--unit").in_file(&name));
    }
    let options = LoadOptions { bvh_unit_metres: arguments.unit.map(Unit::metres), ..LoadOptions::default() };
    let format = clip_format_of(&arguments.out).filter(|&format| {
        let is_copy = asset.format == "vrma" && arguments.clip.is_none() && arguments.edits.is_none();
        format == ClipFormat::Bvh || (format == ClipFormat::Vrma && !is_copy)
    });
    if let Some(format) = format {
        let asset = if arguments.unit.is_some() { load_named(&set, &name, &options)? } else { asset };
        print_warnings(&name, &asset.warnings);
        let extensions = vec![format.extension()];
        return Ok((clip_alone(name, asset, arguments, format)?, extensions));
    }
    if !arguments.edits.is_none() {
        if arguments.unit.is_some() {
            let failure = Failure::expected("a .bvh or .vrma to change a clip of a .bvh with a unit", "a .glb");
            return Err(failure.at("--unit"));
        }
        print_warnings(&name, &asset.warnings);
        let extensions = model_extensions(&asset);
        return Ok((edited(&set, name, asset, arguments)?, extensions));
    }
    if let Some(clip) = &arguments.clip {
        let failure = Failure::expected("a .bvh or .vrma for one clip", format!("clip {clip} of a .glb"));
        return Err(failure.with_hint("a .glb has all clips").at("--clip"));
    }
    let bytes = if arguments.unit.is_some() {
        convert_named(&set, &name, &options)?
    } else {
        print_warnings(&name, &asset.warnings);
        write_model(&set, &name, &asset.skeleton, &[])?
    };
    Ok((bytes, model_extensions(&asset)))
}

/// Writes a model with one of its clips renamed, or with the clip added as it is changed.
fn edited(set: &FileSet, name: String, asset: Asset, arguments: &ConvertArguments) -> Outcome<Vec<u8>> {
    let clip = ClipId::Own(choose_clip(&name, &asset, arguments.clip.as_deref())?);
    let mut library = Library::default();
    library.add(Model::new(name, asset, Vec::new()));
    let names = arguments.edits.name.iter().map(|name| (clip.clone(), name.clone()));
    library.edit_clips(&ClipEdits { names: names.collect(), ..ClipEdits::default() });
    let Some(model) = library.active() else { return Err(Failure::new("there is no model")) };
    let (name, clips) = (&model.source, model.clips());
    if let (Some(asked), Some(title)) = (&arguments.edits.name, clips.get(&clip).map(ModelClip::title))
        && asked != title
    {
        warn(&format!("{name}: another clip is called “{asked}”; this one is written as “{title}”"));
    }
    if arguments.edits.is_name_only() {
        return Ok(write_edited_model(set, name, &model.asset.skeleton, &clips.saved_names(None).own, &[])?);
    }
    let names = clips.saved_names(Some(&clip));
    let added = changed_clip(model, arguments)?.clip.with_name(names.added);
    if !added.properties().is_empty() {
        warn(&format!(
            "{name}: only joints and morph weights are animated in the changed clip, not materials, lights or visibility"
        ));
    }
    Ok(write_edited_model(set, name, &model.asset.skeleton, &names.own, &[&added])?)
}

/// Writes one clip with its skeleton.
fn clip_alone(name: String, asset: Asset, arguments: &ConvertArguments, format: ClipFormat) -> Outcome<Vec<u8>> {
    let model = Model::new(name, asset, Vec::new());
    let clip = changed_clip(&model, arguments)?.clip;
    Ok(write_clip(&model, &model.asset.skeleton, &clip, clip.frames_per_sec(), format)?)
}

/// Returns the chosen clip with its changes, layers and pins, and prints its seam and warnings.
fn changed_clip(model: &Model, arguments: &ConvertArguments) -> Outcome<ChangedClip> {
    let Model { asset, source, .. } = model;
    let clip = &asset.clips[choose_clip(source, asset, arguments.clip.as_deref())?];
    let mut warnings = Vec::new();
    let changed = arguments.edits.bake(model, clip.clone(), false, &mut warnings)?;
    warnings.iter().for_each(|(_, message)| warn(message));
    if let Some(seam) = &changed.seam {
        print_error(&format!("seam: {seam}; blended"));
    }
    Ok(changed)
}

/// Writes a model of another format in the pose of a link.
fn posed(arguments: &ConvertArguments, link: &str, disk: &Disk) -> Outcome<Vec<u8>> {
    let others = [
        ("--clip", arguments.clip.is_some()),
        ("--unit", arguments.unit.is_some()),
        ("its name, changes, layers and pins", !arguments.edits.is_none()),
    ];
    if let Some((other, _)) = others.into_iter().find(|(_, is_given)| *is_given) {
        return Err(Failure::expected("a pose alone", other).at("--view"));
    }
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
    Ok(editor.export(&Export::FullModel { posed: true })?.bytes)
}
