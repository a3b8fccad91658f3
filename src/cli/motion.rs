//! Shared by the subcommands: opening motions, maps and links, and naming joints.

use std::path::{Path, PathBuf};

use clap::Args;
use gaitway_retarget::{FoundRest, RestOrigin};
use gaitway_scene::editor::{Contents, Editor, Event, OpenedMap, OpenedModel};
use gaitway_scene::library::Motion;
use gaitway_scene::state::{CharacterView, ClipChoice, Command, Sources, ViewerState, from_link, view_problems};
use serde_json::{Value, json};

use super::failure::{Failure, Outcome};
use super::output::warn;
use super::print_warnings;
use crate::files::{Disk, Held, Opened, Role, member_of};

/// A motion to retarget to the model, and its joint map.
#[derive(Debug, Default, Args)]
pub(super) struct MotionArguments {
    /// A motion to retarget to the model: .glb, .gltf, .vrma, .fbx, .x, .bvh, .npy, .npz.
    #[arg(long, value_name = "FILE")]
    pub motion: Option<PathBuf>,
    /// The joint map [default: as `gaitway map` proposes].
    #[arg(long, value_name = "MAP.json")]
    pub map: Option<PathBuf>,
}

/// Code of the warning worded by [`doubtful_rest`].
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

/// Code of the warning worded by [`doubtful_up`].
pub(super) const DOUBTFUL_UP: &str = "doubtful-up";

/// A warning for a body that may lie or stand, with what to do about it.
pub(super) fn doubtful_up(rest: FoundRest) -> Option<String> {
    let message = "the body lies throughout the clip, but would stand on the ground if another axis were up; if it should, try \
                   --up z or --up y";
    rest.is_up_doubtful.then(|| message.to_owned())
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
pub(super) fn open_motion(path: &Path, disk: &Disk) -> Outcome<Motion> {
    let motion = read_motion(path, disk)?;
    print_warnings(&motion.source, &motion.asset.warnings);
    Ok(motion)
}

/// Opens one motion.
pub(super) fn read_motion(path: &Path, disk: &Disk) -> Outcome<Motion> {
    let motions = read_motions(path, disk)?;
    let names: Vec<&str> = motions.iter().map(|motion| motion.source.as_str()).collect();
    let found = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    let Ok([motion]) = <[Motion; 1]>::try_from(motions) else {
        return Err(Failure::expected("one motion", found).in_file(path.display()));
    };
    Ok(motion)
}

/// Opens all motions of a file; an archive may have several.
pub(super) fn read_motions(path: &Path, disk: &Disk) -> Outcome<Vec<Motion>> {
    let contents = disk.read_paths(&[path.to_owned()], Role::Motion)?;
    let mut motions = contents.motions.unwrap_or_default();
    if let Some(member) = member_of(path) {
        motions.retain(|motion| motion.source == member);
    }
    Ok(motions)
}

pub(super) fn open_map(path: &Path, disk: &Disk) -> Outcome<OpenedMap> {
    Ok(OpenedMap { name: path.display().to_string(), map: disk.read_map(path)? })
}

/// Opens model, motions and map in an editor, paused in the rest pose. The options' motion and map override those that came
/// with the model.
pub(super) fn open_editor(opened: Opened, arguments: &MotionArguments, disk: &Disk) -> Outcome<Editor> {
    let Opened { model, model_files, mut motions, map, .. } = opened;
    let map = arguments.map.as_deref().map(|path| open_map(path, disk)).transpose()?.or(map);
    if let Some(path) = &arguments.motion {
        motions = vec![open_motion(path, disk)?];
    }
    if motions.is_empty() && arguments.map.is_some() {
        return Err(Failure::expected("a motion to apply the map to", "none")
            .with_hint("add --motion FILE")
            .at("--map"));
    }
    if let Some(OpenedMap { name, map }) = &map {
        for motion in &motions {
            let problem = |problem| Failure::from(problem).in_file(name);
            map.resolve(&model.asset, &motion.asset).map_err(problem)?;
        }
    }
    let models = vec![OpenedModel { model, files: model_files }];
    let contents = Contents { models, motions: Some(motions), map, ..Contents::default() };
    let mut editor = Editor::default();
    editor.open(contents, None, &mut |_| Ok(()))?;
    if let Some(error) = editor.library().borrow_errors().first() {
        return Err(error.clone().into());
    }
    if let Some(problem) = take_problems(&mut editor).into_iter().next() {
        return Err(problem.into());
    }
    editor.apply(Command::SetPlaying(false));
    editor.apply(Command::SetClip(ClipChoice::RestPose));
    Ok(editor)
}

/// Parts of a link that command-line options override.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Overrides {
    pub clip: bool,
    pub layers: bool,
    pub variant: bool,
}

/// Applies the view of a link to the open model, with those of its motions and maps that are files on disk. Command-line options
/// override the link. Warns about anything unused.
pub(super) fn apply_link(
    editor: &mut Editor,
    link: &str,
    arguments: &MotionArguments,
    overrides: Overrides,
    disk: &Disk,
) -> Outcome {
    let fragment = link.split_once('#').map_or(link, |(_, fragment)| fragment);
    let (view, errors) = from_link(fragment);
    errors.iter().for_each(|error| warn(&error.to_string()));
    let now = editor.state().clone();
    let keeps_motions = arguments.motion.is_some() || view.character.sources.motion.is_empty();
    let motion = if keeps_motions { now.character.sources.motion } else { view.character.sources.motion };
    let retarget = if arguments.map.is_some() { now.character.retarget } else { view.character.retarget };
    let sources = Sources { model: now.character.sources.model, motion, ..view.character.sources };
    let held = if keeps_motions { editor.library().motions().to_vec() } else { Vec::new() };
    let (mut contents, view) = {
        let held = Held { motions: &held, environments: editor.library().environments() };
        disk.open_view(
            ViewerState { character: CharacterView { sources, retarget, ..view.character }, ..view },
            false,
            held,
        )?
    };
    std::mem::take(&mut contents.problems).iter().for_each(|problem| warn(problem));
    if keeps_motions {
        contents.motions = Some(held);
    } else {
        let motions = contents.motions.iter().flatten();
        motions.for_each(|motion| print_warnings(&motion.source, &motion.asset.warnings));
    }
    editor.open(contents, Some(view.clone()), &mut |_| Ok(()))?;
    let unknown = view_problems(&view, editor.library().active());
    let mut problems = take_problems(editor);
    problems.retain(|problem| !unknown.iter().any(|unknown| unknown.to_string() == *problem));
    // The editor keeps an empty map to itself, since it may be about to be edited.
    let errors = editor.library().borrow_errors().iter().map(ToString::to_string);
    let unreported: Vec<String> = errors.filter(|error| !problems.contains(error)).collect();
    problems.iter().chain(&unreported).for_each(|problem| warn(problem));
    let is_overridden = |key: &str| match key {
        // A motion's first clip overrides the link's, too.
        "clip" => overrides.clip || arguments.motion.is_some(),
        "layers" => overrides.layers,
        "variant" => overrides.variant,
        _ => false,
    };
    for unknown in unknown.iter().filter(|unknown| !is_overridden(unknown.key())) {
        warn(&format!("--view: {unknown}"));
    }
    Ok(())
}

/// Takes the editor's events and returns the problems among them.
fn take_problems(editor: &mut Editor) -> Vec<String> {
    let events = editor.take_events().into_iter();
    events.filter_map(|event| if let Event::Problem(problem) = event { Some(problem) } else { None }).collect()
}
