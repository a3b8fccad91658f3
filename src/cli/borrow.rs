//! What the subcommands that borrow motion have in common: reading the motion and the map, and naming joints.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::Args;

use super::state_of_view;
use crate::anim::{JointIndex, Skeleton};
use crate::files::{Opened, Role, read_map, read_paths};
use crate::library::{Library, Motion};
use crate::retarget::JointMap;
use crate::state::{Command, MotionMap, ViewerState, apply, maps_in_force, settled_maps};

/// A motion to borrow, and by which map.
#[derive(Debug, Default, Args)]
pub(super) struct Borrowing {
    /// A file whose motion the model borrows: .glb, .gltf, .vrma, .bvh.
    #[arg(long, value_name = "FILE")]
    pub motion: Option<PathBuf>,
    /// Which joints follow which (none: as `gaitway map` proposes).
    #[arg(long, value_name = "MAP.json")]
    pub map: Option<PathBuf>,
}

/// Reads one motion; what is odd about it is said.
pub(super) fn open_motion(path: &Path) -> anyhow::Result<Motion> {
    let contents = read_paths(&[path.to_owned()], Role::Motion)?;
    let motions = contents.motions.unwrap_or_default();
    let count = motions.len();
    let Some(motion) = motions.into_iter().next().filter(|_| count == 1) else {
        bail!("{}: expected one motion, found {count}", path.display());
    };
    for warning in motion.asset.warnings.iter() {
        eprintln!("warning: {}: {warning}", motion.source);
    }
    Ok(motion)
}

pub(super) fn open_map(path: &Path) -> anyhow::Result<JointMap> {
    let bytes = std::fs::read(path).with_context(|| format!("{}", path.display()))?;
    Ok(read_map(&path.display().to_string(), &bytes)?)
}

/// Puts model and motions into the library and makes the borrowed clips.
pub(super) fn load_library(opened: Opened, borrowing: &Borrowing) -> anyhow::Result<Library> {
    let Opened { model, mut motions, map, .. } = opened;
    let map = match &borrowing.map {
        Some(path) => Some(open_map(path)?),
        None => map,
    };
    if let Some(path) = &borrowing.motion {
        motions = vec![open_motion(path)?];
    }
    if motions.is_empty() && borrowing.map.is_some() {
        bail!("--map says how a motion is borrowed; name the motion with --motion FILE");
    }
    let mut library = Library::default();
    library.set(model);
    library.set_motions(motions);
    library.borrow(map.as_ref());
    if let Some(error) = library.borrow_errors().first() {
        bail!("{error}");
    }
    Ok(library)
}

/// What a link says, with the motions and maps that it names read as far as they are files here; the command line's own win.
/// What is not used of it is said.
pub(super) fn state_of_link(library: &mut Library, link: &str, borrowing: &Borrowing) -> ViewerState {
    let mut state = state_of_view(library, link);
    if borrowing.motion.is_none() && !state.sources.motion.is_empty() {
        let read = |source: &String| match open_motion(Path::new(source.strip_prefix("file:").unwrap_or(source))) {
            Ok(motion) => Some(motion),
            Err(error) => {
                eprintln!("warning: {error:#}; the link's motion is left out: it has to be a file here");
                None
            }
        };
        let motions = state.sources.motion.iter().filter_map(read).collect();
        library.set_motions(motions);
    }
    if borrowing.map.is_some() {
        return state;
    }
    for map in &mut state.retarget.map {
        if let MotionMap::File(file) = map {
            match open_map(Path::new(file.as_str())) {
                Ok(read) => *map = MotionMap::Names(read),
                Err(error) => eprintln!("warning: {error:#}; the link's map is left out: it has to be a file here"),
            }
        }
    }
    for problem in settled_maps(library, &state).1 {
        eprintln!("warning: {problem}");
    }
    apply(&mut state, library, Command::SettleMaps);
    library.borrow_each(maps_in_force(library, &state));
    for error in library.borrow_errors() {
        eprintln!("warning: {error}");
    }
    state
}

/// A joint's name, or `#NODE` where it has none or shares it.
pub(super) fn joint_name(skeleton: &Skeleton, joint: JointIndex) -> String {
    let name = skeleton.name(joint);
    let alone = skeleton.joints().filter(|&other| skeleton.name(other) == name).count() == 1;
    if alone && !name.is_empty() { name.to_owned() } else { format!("#{}", skeleton.source_index(joint)) }
}
