//! Subcommands as functions of loaded files, for the Python package. They fail with the messages of the command line and print
//! nothing. `-` is a file like any other, not standard input or output.

use std::path::{Path, PathBuf};

use clap::Parser;
use gaitway_character::anim::Clip;
use gaitway_scene::editor::{ClipFormat, OpenedMap, write_clip};
use gaitway_scene::library::{Model, Motion};
use serde_json::Value;

use super::RetargetChoices;
use super::export::{self, ExportChoices, Place};
pub use super::failure::{Failure, Outcome};
use super::map::Proposed;
use super::motion::{MotionArguments, open_editor, open_map, read_motion};
use super::output::save_output;
pub use super::retarget::Made;
use super::retarget::{clip_format_of, make, model_extensions, model_file};
use super::usage_message;
use super::web_page::{self, View, editor_of};
pub use crate::files::Backend;
use crate::files::{Disk, Opened, STANDARD_STREAM, read_map};

/// A loaded file and the paths of all files that were read for it, none of which is overwritten.
#[derive(Debug)]
pub struct Loaded<T> {
    /// The model or the motion.
    pub content: T,
    /// Includes the files that others refer to.
    pub files_read: Vec<PathBuf>,
}

/// Opens a model with its parts, as `--model` does.
///
/// # Errors
/// If the files cannot be read or are not exactly one model.
pub fn load_model(paths: &[PathBuf]) -> Outcome<Loaded<Opened>> {
    let disk = Disk::default();
    Ok(Loaded { content: disk.open_paths(paths)?, files_read: disk.files_read() })
}

/// Opens a motion, as `--motion` does.
///
/// # Errors
/// If the file cannot be read or is not exactly one motion.
pub fn load_motion(path: &Path) -> Outcome<Loaded<Motion>> {
    let disk = Disk::default();
    Ok(Loaded { content: read_motion(path, &disk)?, files_read: disk.files_read() })
}

/// Reads a joint map from JSON. Messages call it `name`.
///
/// # Errors
/// If it is not a joint map.
pub fn parse_map(name: &str, json: &str) -> Outcome<OpenedMap> {
    Ok(OpenedMap { name: name.to_owned(), map: read_map(name, json.as_bytes())? })
}

/// Opens the file of a joint map.
///
/// # Errors
/// If it cannot be read or is not a joint map.
pub fn load_map(path: &Path) -> Outcome<OpenedMap> {
    open_map(path, &Disk::default())
}

/// Proposes a joint map: the document of `gaitway map --json`, which can be used as a map.
///
/// # Errors
/// Never in practice: a proposed map fits.
pub fn propose_map(model: &Model, motion: &Motion) -> Outcome<Value> {
    Proposed::new(model, motion)?.document()
}

/// Retargets a clip. `options` are those of `gaitway retarget` that don't name files, such as `--feet=plant`. If no map is given,
/// one is proposed.
///
/// # Errors
/// If an option, the map or the motion doesn't fit.
pub fn retarget(model: &Model, motion: &Motion, map: Option<&OpenedMap>, options: &[String]) -> Outcome<Made> {
    #[derive(Parser)]
    #[command(no_binary_name = true, disable_help_flag = true)]
    struct Options {
        #[command(flatten)]
        choices: RetargetChoices,
    }
    let options = Options::try_parse_from(options).map_err(|error| Failure::from(usage_message(&error)))?;
    make(&options.choices, model, motion, map)
}

/// Writes a clip alone, in the format that the extension asks for; without an extension, as a .glb. `inputs` are files that must
/// not be overwritten.
///
/// # Errors
/// If the format cannot hold the clip, or the file cannot be written.
pub fn save_clip(out: &Path, model: &Model, clip: &Clip, frames_per_sec: f64, inputs: &[PathBuf]) -> Outcome {
    let format = clip_format_of(out).unwrap_or(ClipFormat::Glb);
    let bytes = write_clip(model, &model.asset.skeleton, clip, frames_per_sec, format)?;
    save_output(out, &bytes, &ClipFormat::ALL.map(ClipFormat::extension), inputs)
}

/// Writes a model as a .glb, or a .vrm if it was one, with clips for its skeleton after its own.
///
/// # Errors
/// If the model has no file or the output cannot be written.
pub fn save_model(out: &Path, opened: &Opened, clips: &[&Clip], inputs: &[PathBuf]) -> Outcome {
    let bytes = model_file(opened, clips, "write the clip alone")?;
    let mut extensions = model_extensions(&opened.model.asset);
    extensions.retain(|extension| ["glb", "vrm"].contains(extension));
    save_output(out, &bytes, &extensions, inputs)
}

/// Writes a model with its clips and those of motions, as `gaitway export` does, and returns the document that its `--json`
/// prints. `options` are those of the command that don't name files. `inputs` are files that must not be overwritten.
///
/// # Errors
/// If an option, the map or a motion doesn't fit, the plan is refused, or the output cannot be written.
pub fn export(
    out: &Path,
    model: &Opened,
    motions: Vec<Motion>,
    map: Option<OpenedMap>,
    options: &[String],
    inputs: &[PathBuf],
) -> Outcome<Value> {
    #[derive(Parser)]
    #[command(no_binary_name = true, disable_help_flag = true)]
    struct Options {
        #[command(flatten)]
        choices: ExportChoices,
    }
    let options = Options::try_parse_from(options).map_err(|error| Failure::from(usage_message(&error)))?;
    // Here, `-` is a name like any other, without an extension.
    let place = if out == STANDARD_STREAM { Place::Folder } else { Place::of(out)? };
    let opened = copy_of(model, [model.motions.clone(), motions].concat(), map);
    let editor = open_editor(opened, &MotionArguments::default(), &Disk::default())?;
    let made = export::make(&editor, &options.choices, place)?;
    export::write(out, place, &made, inputs)?;
    Ok(made.document())
}

/// Returns the model without its decoded images, which only drawing needs, with other motions and another map.
fn copy_of(opened: &Opened, motions: Vec<Motion>, map: Option<OpenedMap>) -> Opened {
    let Opened { model, model_files, .. } = opened;
    let mut copy = Model::new(model.source.clone(), model.asset.clone(), vec![None; model.asset.images.len()]);
    copy.origin.clone_from(&model.origin);
    Opened { model: copy, model_files: model_files.clone(), motions, map, files: Vec::new() }
}

/// How [`page`] shows a scene. By default its first clip plays.
#[derive(Debug, Clone, Copy, Default)]
pub struct PageOptions<'a> {
    /// A clip's name or index; clips of the motion come first.
    pub clip: Option<&'a str>,
    /// A link, or its part after `#`, with the view; the clip overrides it.
    pub view: Option<&'a str>,
    /// By default the model's name.
    pub title: Option<&'a str>,
    /// What it draws with.
    pub backend: Backend,
    /// The folder with the page's program; by default what `GAITWAY_PAGE` names, beside this program, or near
    /// `prefix`.
    pub folder: Option<&'a Path>,
    /// Where packages are installed.
    pub prefix: Option<&'a Path>,
    /// The files that were read. The view can name them, and files in their folders or below.
    pub files_read: &'a [PathBuf],
}

/// Returns a self-contained page that shows a model, as `gaitway convert` writes it, without a picture for previews.
///
/// # Errors
/// If the motion, the map, the clip or the view doesn't fit, or the page's program is missing.
pub fn page(
    model: &Opened,
    motion: Option<&Motion>,
    map: Option<OpenedMap>,
    options: PageOptions<'_>,
) -> Outcome<String> {
    let template = web_page::template(options.backend, options.folder, options.prefix)?;
    let motions = motion.map_or_else(|| model.motions.clone(), |motion| vec![motion.clone()]);
    let opened = copy_of(model, motions, map);
    let view = View { link: options.view, clip: options.clip };
    let editor = editor_of(opened, &MotionArguments::default(), view, &Disk::beside(options.files_read.to_vec()))?;
    web_page::page_of(&editor, &template, options.title, None)
}
