//! Shared by the subcommands: opening motions, maps and links, and naming joints.

use std::path::{Path, PathBuf};

use anyhow::{Context, Error, bail};
use clap::Args;
use serde_json::{Value, json};

use crate::editor::{Contents, Editor, Event, OpenedMap, OpenedModel};
use crate::files::{Opened, Role, open_view, read_map, read_paths};
use crate::library::Motion;
use crate::retarget::{FoundRest, JointMapFile, RestOrigin};
use crate::state::{ClipChoice, Command, Sources, ViewerState, from_link};

/// A motion to retarget to the model, and its joint map.
#[derive(Debug, Default, Args)]
pub(super) struct MotionArguments {
    /// A motion to retarget to the model: .glb, .gltf, .vrma, .bvh.
    #[arg(long, value_name = "FILE")]
    pub motion: Option<PathBuf>,
    /// The joint map [default: as `gaitway map` proposes].
    #[arg(long, value_name = "MAP.json")]
    pub map: Option<PathBuf>,
}

/// Code of the warning that [`doubtful_rest`] words.
pub(super) const DOUBTFUL_REST: &str = "doubtful-rest";

/// A warning for a rest that is not certain, with what to do about it.
pub(super) fn doubtful_rest(rest: FoundRest) -> Option<String> {
    let used = match rest.origin {
        RestOrigin::Moment(secs) => format!("the clip's pose at {secs:.2} s stands in for it"),
        RestOrigin::Mean => "the mean pose of the clip stands in for it".to_owned(),
        RestOrigin::Map | RestOrigin::Motion | RestOrigin::Model => {
            "no pose of the clip looks more like one".to_owned()
        }
    };
    rest.is_doubtful().then(|| {
        format!(
            "the source's rest looks like a pose in motion, and {used}; if feet, hands or hips are turned, try another \
             --rest-motion (node, bind, first-frame)"
        )
    })
}

/// Where a rest comes from, for scripts.
pub(super) fn rest_document(rest: FoundRest) -> Value {
    let (origin, time_secs) = match rest.origin {
        RestOrigin::Map => ("map", None),
        RestOrigin::Motion => ("motion", None),
        RestOrigin::Model => ("model", None),
        RestOrigin::Moment(secs) => ("moment", Some(secs)),
        RestOrigin::Mean => ("mean", None),
    };
    json!({ "origin": origin, "time_secs": time_secs, "confidence": rest.confidence, "doubtful": rest.is_doubtful() })
}

/// Opens one motion and prints its warnings.
pub(super) fn open_motion(path: &Path) -> anyhow::Result<Motion> {
    let contents = read_paths(&[path.to_owned()], Role::Motion)?;
    let motions = contents.motions.unwrap_or_default();
    let count = motions.len();
    let Some(motion) = motions.into_iter().next().filter(|_| count == 1) else {
        bail!("{}: expected one motion, found {count}", path.display());
    };
    print_warnings(&motion);
    Ok(motion)
}

fn print_warnings(motion: &Motion) {
    for warning in motion.asset.warnings.iter() {
        eprintln!("warning: {}: {warning}", motion.source);
    }
}

pub(super) fn open_map(path: &Path) -> anyhow::Result<JointMapFile> {
    let bytes = std::fs::read(path).with_context(|| format!("{}", path.display()))?;
    Ok(read_map(&path.display().to_string(), &bytes)?)
}

/// Opens model, motions and map in an editor, paused in the rest pose. The options' motion and map override those that came
/// with the model.
pub(super) fn open_editor(opened: Opened, arguments: &MotionArguments) -> anyhow::Result<Editor> {
    let Opened { model, model_files, mut motions, map, .. } = opened;
    let map = match &arguments.map {
        Some(path) => Some(OpenedMap { name: path.display().to_string(), map: open_map(path)? }),
        None => map,
    };
    if let Some(path) = &arguments.motion {
        motions = vec![open_motion(path)?];
    }
    if motions.is_empty() && arguments.map.is_some() {
        bail!("--map: expected a motion to apply the map to; add --motion FILE");
    }
    if let Some(OpenedMap { name, map }) = &map {
        for motion in &motions {
            let context = || format!("{name}: doesn't fit {}", motion.source);
            map.resolve(&model.asset, &motion.asset).with_context(context)?;
        }
    }
    let models = vec![OpenedModel { model, files: model_files }];
    let contents = Contents { models, motions: Some(motions), map, ..Contents::default() };
    let mut editor = Editor::default();
    editor.open(contents, None, &mut |_| Ok(())).map_err(Error::msg)?;
    if let Some(problem) = take_problems(&mut editor).first() {
        bail!("{problem}");
    }
    editor.apply(Command::SetPlaying(false));
    editor.apply(Command::SetClip(ClipChoice::RestPose));
    Ok(editor)
}

/// Applies the view of a link to the open model, with those of its motions and maps that are files on disk. Command-line options
/// override the link. Warns about anything unused.
pub(super) fn apply_link(editor: &mut Editor, link: &str, arguments: &MotionArguments) -> anyhow::Result<()> {
    let fragment = link.split_once('#').map_or(link, |(_, fragment)| fragment);
    let (view, errors) = from_link(fragment);
    errors.iter().for_each(|error| eprintln!("warning: {error}"));
    let now = editor.state().clone();
    let keeps_motions = arguments.motion.is_some() || view.sources.motion.is_empty();
    let motion = if keeps_motions { now.sources.motion } else { view.sources.motion };
    let retarget = if arguments.map.is_some() { now.retarget } else { view.retarget };
    let sources = Sources { model: now.sources.model, motion, ..view.sources };
    let held = if keeps_motions { editor.library().motions().to_vec() } else { Vec::new() };
    let (mut contents, view) = open_view(ViewerState { sources, retarget, ..view }, false, &held)?;
    std::mem::take(&mut contents.problems).iter().for_each(|problem| eprintln!("warning: {problem}"));
    if keeps_motions {
        contents.motions = Some(held);
    } else {
        contents.motions.iter().flatten().for_each(print_warnings);
    }
    editor.open(contents, Some(view), &mut |_| Ok(())).map_err(Error::msg)?;
    let problems = take_problems(editor);
    // The editor keeps an empty map to itself, since it may be about to be edited.
    let errors = editor.library().borrow_errors().iter().map(ToString::to_string);
    let unreported: Vec<String> = errors.filter(|error| !problems.contains(error)).collect();
    problems.iter().chain(&unreported).for_each(|problem| eprintln!("warning: {problem}"));
    Ok(())
}

/// Takes the editor's events and returns the problems among them.
fn take_problems(editor: &mut Editor) -> Vec<String> {
    let events = editor.take_events().into_iter();
    events.filter_map(|event| if let Event::Problem(problem) = event { Some(problem) } else { None }).collect()
}
