//! `gaitway export`: writes a model with many clips, its own and those retargeted from other files, as one file or a file for each.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use gaitway_retarget::KeyTolerance;
use gaitway_scene::editor::{
    ClipFormat, Editor, ExportPlan, ExportedFile, OneFileFormat, Packaging, PlannedClip, Recipient, RootBone,
};
use gaitway_scene::library::{Model, ModelClip};
use gaitway_scene::state::{NameKind, UnknownName};
use serde_json::{Value, json};

use super::failure::{Failure, Outcome};
use super::motion::{MotionArguments, open_editor, read_motions};
use super::output::{
    extension_of, is_standard_output, print_bytes, print_error, print_json, print_lines, save_output, warn,
};
use super::{Files, FormatArgument, RecipientArgument, inputs, open, print_warnings, read_numbers};
use crate::files::{Disk, is_stream, refuse_input, save_file, zip};

#[derive(Debug, Args)]
pub(super) struct ExportArguments {
    #[command(flatten)]
    input: Files,
    /// Motions to add: any number of files that `retarget` takes, folders, archives and patterns. Clips of the model's own rig keep
    /// their keys, others are retargeted.
    #[arg(long, value_name = "FILE|DIR", num_args = 1..)]
    motion: Vec<PathBuf>,
    /// The joint map for all motions [default: for each as `gaitway map` proposes].
    #[arg(long, value_name = "MAP.json")]
    map: Option<PathBuf>,
    #[command(flatten)]
    choices: ExportChoices,
    /// The file to write, a .glb or .fbx with the model and the clips (`-` for a .glb to standard output); or a .zip or a folder with a
    /// file for each clip, without meshes.
    #[arg(long, value_name = "OUT.glb|.fbx|.zip|DIR")]
    pub out: PathBuf,
    /// Prints the clips, the files and the warnings as a JSON document.
    #[arg(long)]
    pub json: bool,
}

/// What the plan depends on besides the files.
#[derive(Debug, Args)]
pub(super) struct ExportChoices {
    /// The clips to write: `all`, or comma-separated names or indices as the page lists them; can be repeated [default: all].
    #[arg(long, value_name = "all|NAME,…", allow_negative_numbers = true)]
    clips: Vec<String>,
    /// Another name for a clip in the file; can be repeated.
    #[arg(long, value_name = "CLIP=NAME")]
    rename: Vec<String>,
    /// Drops keys that interpolation restores, so that joints stay within this many degrees and millimetres per metre of height;
    /// 0.01,0.01 without numbers [default: all keys; fewer for web].
    #[arg(long, value_name = "DEGREES,MM", num_args = 0..=1, require_equals = true, default_missing_value = "0.01,0.01",
        value_parser = read_tolerance)]
    fewer_keys: Option<KeyTolerance>,
    /// Inserts a bone above the hips that carries the body over the ground and turns with it, for engines that move characters by
    /// their root. A rig that has one keeps it.
    #[arg(long)]
    root_bone: bool,
    /// Lets the root bone carry the height of the hips as well.
    #[arg(long, requires = "root_bone")]
    root_height: bool,
    /// The clips in which the body stays in place: `all`, or comma-separated names or indices; can be repeated.
    #[arg(long, value_name = "all|NAME,…", requires = "root_bone", allow_negative_numbers = true)]
    in_place: Vec<String>,
    /// The program that the files are for, which decides what suits it, such as fewer keys for web [default: as-is].
    #[arg(long = "for", value_enum)]
    recipient: Option<RecipientArgument>,
    /// The format of the files in a folder or .zip [default: glb].
    #[arg(long, value_enum)]
    format: Option<FormatArgument>,
}

fn read_tolerance(text: &str) -> Result<KeyTolerance, String> {
    let numbers = read_numbers(text).filter(|numbers: &[f64; 2]| numbers.iter().all(|&number| number > 0.0));
    let [degrees, millimetres_per_metre] = numbers.ok_or("expected DEGREES,MM, both above 0")?;
    Ok(KeyTolerance { degrees, millimetres_per_metre })
}

pub(super) fn run(arguments: &ExportArguments, disk: &Disk) -> Outcome {
    let place = Place::of(&arguments.out)?;
    let mut opened = open(&arguments.input.files, disk)?;
    for input in inputs::motions(&arguments.motion, &arguments.out)? {
        let motions = read_motions(&input.file, disk)?;
        motions.iter().for_each(|motion| print_warnings(&motion.source, &motion.asset.warnings));
        opened.motions.extend(motions);
    }
    let motion_arguments = MotionArguments { motion: None, map: arguments.map.clone() };
    let editor = open_editor(opened, &motion_arguments, disk)?;
    let made = make(&editor, &arguments.choices, place)?;
    made.warnings.iter().for_each(|warning| warn(warning));
    write(&arguments.out, place, &made, &disk.files_read())?;
    if arguments.json {
        return print_json(&made.document());
    }
    let lines = made.lines();
    if is_standard_output(&arguments.out) {
        lines.iter().for_each(|line| print_error(line));
        return Ok(());
    }
    print_lines(lines)
}

/// What is at the path of the output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    File(OneFileFormat),
    Archive,
    Folder,
}

impl Place {
    pub(super) fn of(out: &Path) -> Outcome<Self> {
        let extension = extension_of(out).filter(|_| !out.is_dir());
        match extension.as_deref() {
            _ if is_standard_output(out) || is_stream(out) => Ok(Self::File(OneFileFormat::Glb)),
            None => Ok(Self::Folder),
            Some("glb" | "vrm") => Ok(Self::File(OneFileFormat::Glb)),
            Some("fbx") => Ok(Self::File(OneFileFormat::Fbx)),
            Some("zip") => Ok(Self::Archive),
            Some(other) => {
                let hint = match other {
                    "bvh" | "vrma" => "those hold a single clip, so choose a folder and --format",
                    _ => "a name without an extension is a folder",
                };
                let failure =
                    Failure::expected("a .glb, an .fbx, a .zip or a folder", format!(".{other}")).with_hint(hint);
                Err(failure.at("file extension").in_file(out.display()))
            }
        }
    }
}

/// A plan and the files made from it.
pub(super) struct MadeFiles {
    plan: ExportPlan,
    durations_secs: Vec<f64>,
    files: Vec<ExportedFile>,
    /// File extensions that suit the model's file.
    extensions: &'static [&'static str],
    /// What the files can't hold, and remarks about them.
    warnings: Vec<String>,
}

/// Makes the plan that the choices describe, and its files.
pub(super) fn make(editor: &Editor, choices: &ExportChoices, place: Place) -> Outcome<MadeFiles> {
    let Some(model) = editor.library().active() else { return Err(Failure::new("there is no model")) };
    let packaging = match (place, choices.format) {
        (Place::File(format), None) => Packaging::OneFile(format),
        (Place::File(_), Some(_)) => {
            return Err(Failure::expected("a .zip or a folder for files of another format", "one file").at("--format"));
        }
        (Place::Archive | Place::Folder, format) => Packaging::FilePerClip(format.map_or(ClipFormat::Glb, Into::into)),
    };
    let plan = plan(model, choices, packaging)?;
    plan.check(model).map_err(Failure::new)?;
    let durations_secs = plan.clips.iter().filter_map(|planned| model.clip(&planned.clip));
    let durations_secs = durations_secs.map(ModelClip::duration_secs).collect();
    let losses = editor.plan_losses(&plan).into_iter().map(|loss| format!("not in the file: {loss}"));
    let mut warnings: Vec<String> = losses.collect();
    let files = editor.export_plan(&plan)?;
    let remarks = files.iter().filter_map(|file| file.remark.as_ref().map(|remark| format!("{}: {remark}", file.name)));
    warnings.extend(remarks);
    let extensions: &[&str] = match place {
        Place::File(OneFileFormat::Fbx) => &["fbx"],
        _ if model.asset.format == "vrm" => &["glb", "vrm"],
        _ => &["glb"],
    };
    Ok(MadeFiles { plan, durations_secs, files, extensions, warnings })
}

fn plan(model: &Model, choices: &ExportChoices, packaging: Packaging) -> Outcome<ExportPlan> {
    let recipient: Recipient = choices.recipient.map_or(Recipient::AsIs, Into::into);
    let root_bone = choices.root_bone.then_some(RootBone { vertical: choices.root_height });
    let fewer_keys = choices.fewer_keys.or(recipient.fewer_keys());
    let mut plan = ExportPlan { packaging, recipient, root_bone, fewer_keys, ..ExportPlan::all_clips(model) };
    if let Some(clips) = listed(model, &choices.clips, "--clips")? {
        plan.clips = clips.into_iter().map(PlannedClip::of).collect();
    }
    if !choices.in_place.is_empty() {
        let clips = listed(model, &choices.in_place, "--in-place")?;
        let is_written = |clip: &ModelClip| plan.clips.iter().any(|planned| planned.clip == *clip.id());
        if let Some(other) = clips.iter().flatten().find(|clip| !is_written(clip)) {
            let found = format!("“{}”", other.title());
            return Err(Failure::expected("one of the clips that are written", found).at("--in-place"));
        }
        for planned in &mut plan.clips {
            planned.in_place = clips.as_ref().is_none_or(|clips| clips.iter().any(|clip| *clip.id() == planned.clip));
        }
    }
    for text in &choices.rename {
        // Either name may contain `=`.
        let mut splits = text.match_indices('=').map(|(at, _)| (&text[..at], &text[at + 1..]));
        let renamed = splits.find_map(|(clip, name)| Some((find(model, clip)?.id(), name)));
        let Some((clip, name)) = renamed else {
            let name = text.split('=').next().unwrap_or_default();
            return Err(Failure::from(unknown(model, name)).at("--rename"));
        };
        let planned = plan.clips.iter_mut().find(|planned| planned.clip == *clip);
        let Some(planned) = planned else {
            return Err(Failure::expected("one of the clips that are written", format!("“{text}”")).at("--rename"));
        };
        name.clone_into(&mut planned.name);
    }
    Ok(plan)
}

/// Finds the clips of lists; `None` stands for all.
fn listed<'a>(model: &'a Model, lists: &[String], option: &str) -> Outcome<Option<Vec<&'a ModelClip>>> {
    if lists.is_empty() || lists == ["all"] {
        return Ok(None);
    }
    let found = |name: &str| find(model, name.trim()).ok_or_else(|| Failure::from(unknown(model, name)).at(option));
    let mut clips = Vec::new();
    for list in lists {
        match find(model, list) {
            // A name may contain commas.
            Some(clip) => clips.push(clip),
            None => clips.extend(list.split(',').map(found).collect::<Outcome<Vec<_>>>()?),
        }
    }
    Ok(Some(clips))
}

/// Finds a clip by the name that lists show, the one in its file, or its index in the list.
fn find<'a>(model: &'a Model, name: &str) -> Option<&'a ModelClip> {
    let clips = model.clips();
    let by_title = clips.listed().find(|clip| clip.title() == name);
    let by_name = || clips.listed().find(|clip| clip.name() == name);
    by_title.or_else(by_name).or_else(|| clips.listed().nth(name.parse().ok()?))
}

fn unknown(model: &Model, name: &str) -> UnknownName {
    let names = model.clips().listed().map(|clip| clip.title().to_owned()).collect();
    UnknownName { kind: NameKind::Clip, name: name.trim().to_owned(), names }
}

/// Writes the files, or an archive of them.
pub(super) fn write(out: &Path, place: Place, made: &MadeFiles, inputs: &[PathBuf]) -> Outcome {
    let files = made.files.as_slice();
    let named = files.iter().map(|file| (file.name.as_str(), file.bytes.as_slice()));
    match (place, files) {
        (Place::File(_), [file]) if is_standard_output(out) => print_bytes(&file.bytes),
        (Place::File(_), [file]) => save_output(out, &file.bytes, made.extensions, inputs),
        (Place::File(_), _) => Err(Failure::new("the plan has several files").in_file(out.display())),
        (Place::Archive, _) => {
            let Some(bytes) = zip(named) else {
                return Err(Failure::new("the archive would be too large; write a folder").in_file(out.display()));
            };
            Ok(save_file(out, &bytes, inputs)?)
        }
        (Place::Folder, _) => {
            for (name, _) in named.clone() {
                refuse_input(&out.join(name), inputs)?;
            }
            let problem = |error: std::io::Error| Failure::new(crate::files::describe(&error)).in_file(out.display());
            fs::create_dir_all(out).map_err(problem)?;
            named.into_iter().try_for_each(|(name, bytes)| Ok(save_file(&out.join(name), bytes, &[])?))
        }
    }
}

impl MadeFiles {
    /// The document of `--json`.
    pub(super) fn document(&self) -> Value {
        let clips = self.plan.clips.iter().zip(&self.durations_secs);
        let clips: Vec<Value> =
            clips.map(|(clip, duration_secs)| json!({ "name": clip.name, "duration_secs": duration_secs })).collect();
        let files: Vec<Value> =
            self.files.iter().map(|file| json!({ "name": file.name, "bytes": file.bytes.len() })).collect();
        json!({ "clips": clips, "files": files, "warnings": self.warnings })
    }

    /// The summary for people.
    fn lines(&self) -> Vec<String> {
        let clips = self.plan.clips.iter().zip(&self.durations_secs);
        let mut lines: Vec<String> = clips.map(|(clip, secs)| format!("{secs:8.2} s  {}", clip.name)).collect();
        let bytes: usize = self.files.iter().map(|file| file.bytes.len()).sum();
        let count = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
        let (clips, files) = (count(self.plan.clips.len(), "clip"), count(self.files.len(), "file"));
        lines.push(format!("{clips} in {files}, {:.1} MB", bytes as f64 / 1e6));
        lines
    }
}
