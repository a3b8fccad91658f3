//! The command line: thin wrappers around the functions that the page uses.

mod batch;
mod card;
mod change;
mod convert;
mod edit;
mod export;
mod failure;
pub mod functions;
mod inputs;
mod inspect;
mod layer;
mod map;
mod moment;
mod motion;
mod output;
mod pin;
mod pose;
#[cfg(feature = "render")]
mod quiet;
#[cfg(feature = "render")]
mod render;
mod retarget;
#[cfg(feature = "render")]
mod sequence;
mod web_page;

use std::borrow::Cow;
use std::ffi::OsString;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::process::ExitCode;
use std::str::FromStr;

use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use gaitway_character::asset::Warnings;
use gaitway_retarget::{Contacts, Feet, Keep, PathOrigin, RestChoice, RootPart, UpChoice};
use gaitway_scene::editor::{ClipFormat, Recipient};
use serde_json::json;

use crate::files::{Disk, Opened};
use card::CardArguments;
use edit::EditOptions;
use export::ExportArguments;
use failure::{Failure, Outcome};
use moment::Moment;
use motion::MotionArguments;
use output::{is_standard_output, print_error, print_json, printable, warn};
use web_page::PageArguments;

/// Drop in a glTF or FBX character, watch it move, and see why it bends the way it does.
#[derive(Debug, Parser)]
#[command(name = "gaitway", version, about, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    action: Option<Action>,
    /// Opens these files in a window: a model with its parts [default: a sample].
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Summarizes a model: nodes, skins, clips, warnings.
    Inspect(InspectArguments),
    /// Prints a pose as numbers: joints and skinned vertices in world space.
    Pose(PoseArguments),
    /// Proposes a joint map from a motion to a model.
    Map(MapArguments),
    /// Retargets a clip to a model, appends it to the model's own clips, and reports how well it fits.
    Retarget(Box<RetargetArguments>),
    /// Converts any supported model to a single .glb, one of its clips to .bvh or .vrma, or a scene to a page that shows it.
    Convert(ConvertArguments),
    /// Writes a model with many clips, its own and those of other files, as one .glb, or each clip as a file.
    Export(ExportArguments),
    /// Writes a page with a title and a picture of its own, for previews, that leads to a link.
    Card(CardArguments),
    /// Renders the same image as the page, or the frames of a clip, without a window.
    #[cfg(feature = "render")]
    Render(RenderArguments),
}

#[derive(Debug, Args)]
struct Files {
    /// A model with its parts: files, folders, `-` for standard input, or `sample:NAME`. One of several models in an archive or
    /// a folder is `ARCHIVE#!/FILE`.
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
}

#[derive(Debug, Args)]
struct InspectArguments {
    #[command(flatten)]
    input: Files,
    /// Prints a JSON document to standard output.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct MapArguments {
    /// The model to animate.
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// The motion to map from.
    #[arg(long, value_name = "FILE")]
    motion: PathBuf,
    /// Writes the map to this file, for manual editing; `-` for standard output.
    #[arg(long, value_name = "MAP.json")]
    out: Option<PathBuf>,
    /// Prints the map as JSON, with each joint's slot, reason and confidence.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct RetargetArguments {
    /// The model to animate. With --out-dir, any number of models; each one's results are in a folder of its name there.
    #[arg(long, value_name = "FILE", required = true, num_args = 1..)]
    model: Vec<PathBuf>,
    /// The file with the clip to retarget: .glb, .gltf, .vrma, .fbx, .x, .bvh, .npy, .npz. With --out-dir, any number of files, folders
    /// and patterns.
    #[arg(long, value_name = "FILE", required = true, num_args = 1..)]
    motion: Vec<PathBuf>,
    /// The joint map [default: as `gaitway map` proposes].
    #[arg(long, value_name = "MAP.json")]
    map: Option<PathBuf>,
    #[command(flatten)]
    choices: RetargetChoices,
    /// The file to write; `-` for standard output. A .bvh or .vrma holds the clip alone.
    #[arg(
        long,
        value_name = "OUT.glb|.fbx|.bvh|.vrma",
        required_unless_present = "out_dir",
        conflicts_with = "out_dir"
    )]
    out: Option<PathBuf>,
    /// The folder for the results of many motions. Prints a line of JSON for each, and skips those that are up to date.
    #[arg(long, value_name = "DIR")]
    out_dir: Option<PathBuf>,
    /// The format of the files in --out-dir [default: glb].
    #[arg(long, value_enum, requires = "out_dir")]
    format: Option<FormatArgument>,
    /// Number of motions at a time in --out-dir [default: one per core].
    #[arg(long, value_name = "N", requires = "out_dir")]
    jobs: Option<NonZeroUsize>,
    /// Writes only the skeleton and the clip, without meshes.
    #[arg(long)]
    clip_only: bool,
    /// Prints the mapped joints and the quality figures as a JSON document.
    #[arg(long)]
    json: bool,
}

/// What the retargeted clip depends on besides the files.
#[derive(Debug, Args)]
struct RetargetChoices {
    /// A clip's name or index in the motion [default: its first].
    #[arg(long, value_name = "CLIP", allow_negative_numbers = true)]
    clip: Option<String>,
    #[command(flatten)]
    options: RetargetOptions,
    #[command(flatten)]
    edits: EditOptions,
    /// Number of loops to write [default: as few as let layered clips of the model loop seamlessly].
    #[arg(long, value_name = "N", value_parser = read_loops)]
    loops: Option<u16>,
}

/// Options that override the map.
#[derive(Debug, Args)]
struct RetargetOptions {
    /// Horizontal root motion.
    #[arg(long, value_enum)]
    horizontal: Option<RootPartArgument>,
    /// Vertical root motion.
    #[arg(long, value_enum)]
    vertical: Option<RootPartArgument>,
    /// Root turn about the vertical axis.
    #[arg(long, value_enum)]
    yaw: Option<RootPartArgument>,
    /// Extracts root motion to the joint above the hips.
    #[arg(long)]
    extract_root: bool,
    /// How the path is placed on the ground: `feet` puts the model's feet where the motion's are, scaled about the origin; `rest`
    /// measures the path from both rest poses [default: as the map says; feet without one].
    #[arg(long, value_enum)]
    origin: Option<OriginArgument>,
    /// Foot planting.
    #[arg(long, value_enum)]
    feet: Option<FeetArgument>,
    /// Contacts of hands with the body and the ground, and of knees with the ground.
    #[arg(long, value_enum)]
    contacts: Option<ContactsArgument>,
    /// Translations of joints other than the hips.
    #[arg(long, value_enum)]
    translations: Option<KeepArgument>,
    /// Scales of all mapped joints, the hips included.
    #[arg(long, value_enum)]
    scales: Option<KeepArgument>,
    /// The rest pose of the model.
    #[arg(long, value_enum)]
    rest_model: Option<RestArgument>,
    /// The rest pose of the motion.
    #[arg(long, value_enum)]
    rest_motion: Option<RestArgument>,
    /// Which axis is up in the motion's data [default: as the map says; found in the motion without one].
    #[arg(long, value_enum)]
    up: Option<UpArgument>,
    /// What unmapped joints do: `rest`, or play the model's own clip of this name or index.
    #[arg(long, value_name = "rest|CLIP", allow_negative_numbers = true)]
    unmapped: Option<String>,
}

macro_rules! arguments_of {
    ($($name:ident of $kind:ty { $($choice:ident),* })*) => {
        $(
            #[derive(Debug, Clone, Copy, ValueEnum)]
            enum $name {
                $($choice,)*
            }

            impl From<$name> for $kind {
                fn from(argument: $name) -> Self {
                    match argument {
                        $($name::$choice => Self::$choice,)*
                    }
                }
            }
        )*
    };
}

arguments_of! {
    RootPartArgument of RootPart { Keep, InPlace, Freeze }
    OriginArgument of PathOrigin { Rest, Feet }
    FeetArgument of Feet { Off, Plant }
    ContactsArgument of Contacts { Off, Keep }
    KeepArgument of Keep { Auto, Keep, Drop }
    FormatArgument of ClipFormat { Glb, Bvh, Vrma }
    RecipientArgument of Recipient { Unity, Unreal, Godot, Blender, Web, Vrm, AsIs }
    RestArgument of RestChoice { Auto, Node, Bind, FirstFrame }
    UpArgument of UpChoice { Auto, Y, Z }
}

#[derive(Debug, Args)]
struct ConvertArguments {
    #[command(flatten)]
    input: Files,
    /// The file to write; `-` for standard output. A .glb or .fbx has the whole model, a .bvh or .vrma one clip. An .html is a
    /// self-contained page that shows the scene, without a network.
    #[arg(long, value_name = "OUT.glb|.fbx|.bvh|.vrma|.html")]
    out: PathBuf,
    /// The clip to change, to write as .bvh or .vrma, or to show in an .html, by name or index [default: the first].
    #[arg(long, value_name = "CLIP", allow_negative_numbers = true)]
    clip: Option<String>,
    #[command(flatten)]
    edits: EditOptions,
    /// The unit of a .bvh [default: guessed from the size of its skeleton].
    #[arg(long, value_enum)]
    unit: Option<Unit>,
    /// A link of the page, or its part after `#`: the view that an .html shows, or the pose and joint names with which an .obj is
    /// written as .glb [default: the rest pose].
    #[arg(long, value_name = "LINK")]
    view: Option<String>,
    #[command(flatten)]
    page: PageArguments,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Unit {
    M,
    Cm,
    Mm,
    In,
    Ft,
}

impl Unit {
    fn metres(self) -> f32 {
        match self {
            Self::M => 1.0,
            Self::Cm => 0.01,
            Self::Mm => 0.001,
            Self::In => 0.0254,
            Self::Ft => 0.3048,
        }
    }
}

#[derive(Debug, Args)]
struct PoseArguments {
    #[command(flatten)]
    input: Files,
    #[command(flatten)]
    motion: MotionArguments,
    #[command(flatten)]
    moment: Moment,
    /// A link of the page, or its part after `#`, with the pose to evaluate. Other options override it.
    #[arg(long, value_name = "LINK")]
    view: Option<String>,
    /// Prints a JSON document to standard output.
    #[arg(long)]
    json: bool,
}

#[cfg(feature = "render")]
#[derive(Debug, Args)]
struct RenderArguments {
    #[command(flatten)]
    input: Files,
    #[command(flatten)]
    motion: MotionArguments,
    /// The image to write; `-` for standard output. With --frames, a new folder for images, or a video or GIF (.mp4, .webm,
    /// .gif; needs ffmpeg).
    #[arg(long, value_name = "PNG|FOLDER|VIDEO")]
    out: PathBuf,
    /// Renders one loop of the clip, with the loop mode and speed of the view, at this many frames per second.
    #[arg(long, value_name = "FPS", value_parser = clap::value_parser!(u32).range(1..=240), conflicts_with = "time")]
    frames: Option<u32>,
    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = read_size)]
    size: [u32; 2],
    #[command(flatten)]
    moment: Moment,
    /// Angles in degrees and distance in metres; the camera looks at the centre of the model.
    #[arg(long, value_name = "YAW,PITCH,DISTANCE", allow_hyphen_values = true, value_parser = read_camera)]
    camera: Option<[f32; 3]>,
    /// The material variant to show, by name [default: the file's own materials].
    #[arg(long, value_name = "NAME")]
    variant: Option<String>,
    /// What lights the scene: studio, white, soft, hard, outdoor, or an .hdr image.
    #[arg(long, value_name = "NAME|FILE.hdr")]
    environment: Option<String>,
    /// A link of the page, or its part after `#`, with the view to render. Other options override it.
    #[arg(long, value_name = "LINK")]
    view: Option<String>,
}

/// Runs the command line and returns its exit status.
pub fn main() -> ExitCode {
    let arguments = match Arguments::try_parse().and_then(check_usage) {
        Ok(arguments) => arguments,
        // Help and version go to stdout and are not errors. If printing fails, there is nowhere left to report it.
        Err(error) if !error.use_stderr() => {
            let _ = error.print();
            return ExitCode::SUCCESS;
        }
        Err(error) => {
            print_usage_error(&error);
            print_failure(&Failure::new(usage_message(&error)));
            return ExitCode::from(2);
        }
    };
    match run(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            print_error(&format!("error: {}", failure.message()));
            print_failure(&failure);
            ExitCode::from(1)
        }
    }
}

/// Prints clap's text in colours. It quotes arguments as they are, so if one isn't printable, only the first paragraph is printed,
/// escaped.
fn print_usage_error(error: &clap::Error) {
    let is_printable = |argument: OsString| matches!(printable(&argument.to_string_lossy()), Cow::Borrowed(_));
    if std::env::args_os().all(is_printable) {
        let _ = error.print();
    } else {
        print_error(&format!("error: {}", usage_message(error)));
    }
}

/// Prints the document of a failure if the arguments, right or wrong, have `--json`.
fn print_failure(failure: &Failure) {
    if std::env::args_os().any(|argument| argument == "--json") {
        // What failed may be standard output itself.
        let _ = print_json(&json!({ "error": failure }));
    }
}

/// What is wrong with the arguments, in one line: the first paragraph of clap's text.
fn usage_message(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let first = text.trim_start_matches("error: ").split("\n\n").next().unwrap_or_default();
    first.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Refuses what clap cannot: two documents on standard output.
fn check_usage(arguments: Arguments) -> Result<Arguments, clap::Error> {
    let is_used_twice = match &arguments.action {
        Some(Action::Map(map)) => map.json && map.out.as_deref().is_some_and(is_standard_output),
        Some(Action::Retarget(retarget)) => retarget.json && retarget.out.as_deref().is_some_and(is_standard_output),
        Some(Action::Export(export)) => export.json && is_standard_output(&export.out),
        _ => false,
    };
    if is_used_twice {
        let message = "--json and --out - both write to standard output; write one of them to a file";
        return Err(Arguments::command().error(ErrorKind::ArgumentConflict, message));
    }
    Ok(arguments)
}

fn run(arguments: Arguments) -> Outcome {
    let disk = Disk::with_standard_input();
    match arguments.action {
        Some(Action::Inspect(arguments)) => inspect::run(&arguments, &disk),
        Some(Action::Map(arguments)) => map::run(&arguments, &disk),
        Some(Action::Pose(arguments)) => pose::run(&arguments, &disk),
        Some(Action::Retarget(arguments)) => retarget::run(&arguments, &disk),
        Some(Action::Convert(arguments)) => convert::run(&arguments, &disk),
        Some(Action::Export(arguments)) => export::run(&arguments, &disk),
        Some(Action::Card(arguments)) => card::run(&arguments, &disk),
        #[cfg(feature = "render")]
        Some(Action::Render(arguments)) => render::run(&arguments, &disk),
        None => open_window(arguments.files),
    }
}

#[cfg(feature = "viewer")]
fn open_window(files: Vec<PathBuf>) -> Outcome {
    Ok(crate::app::run_native(files)?)
}

#[cfg(not(feature = "viewer"))]
fn open_window(_files: Vec<PathBuf>) -> Outcome {
    Err(Failure::new("this gaitway was built without the viewer; build it with the feature `viewer` to open a window"))
}

/// Opens a model and prints its warnings.
fn open(files: &[PathBuf], disk: &Disk) -> Outcome<Opened> {
    let opened = disk.open_paths(files)?;
    print_warnings(&opened.model.source, &opened.model.asset.warnings);
    Ok(opened)
}

/// Prints the warnings of a file.
fn print_warnings(file: &str, warnings: &Warnings) {
    for warning in warnings.iter() {
        warn(&format!("{file}: {warning}"));
    }
}

#[cfg(feature = "render")]
fn read_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    let fits = |side: &u32| (1..=8192).contains(side);
    sides
        .filter(|sides| sides.iter().all(fits))
        .ok_or_else(|| "expected WxH in pixels, from 1x1 to 8192x8192".to_owned())
}

fn read_loops(text: &str) -> Result<u16, String> {
    let loops: Option<u16> = text.trim().parse().ok();
    loops.filter(|loops| (1..=1000).contains(loops)).ok_or_else(|| "expected a whole number from 1 to 1000".to_owned())
}

#[cfg(feature = "render")]
fn read_camera(text: &str) -> Result<[f32; 3], String> {
    let camera = read_numbers(text).filter(|[_, _, distance]| *distance > 0.0);
    camera.ok_or_else(|| "expected YAW,PITCH,DISTANCE: degrees, degrees, metres above 0".to_owned())
}

/// Reads `N` finite numbers with commas between them.
fn read_numbers<T: FromStr + Copy + Into<f64>, const N: usize>(text: &str) -> Option<[T; N]> {
    let numbers: Option<Vec<T>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let numbers = <[T; N]>::try_from(numbers?).ok()?;
    numbers.iter().all(|&number| number.into().is_finite()).then_some(numbers)
}
