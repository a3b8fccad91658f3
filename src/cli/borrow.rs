//! Shared by the subcommands that borrow motion: opening motions, maps and links, and naming joints.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::Args;

use super::state_of_view;
use crate::anim::{JointIndex, Skeleton};
use crate::editor::Contents;
use crate::files::{Opened, Role, open_view, read_map, read_paths};
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

pub(super) fn open_map(path: &Path) -> anyhow::Result<JointMap> {
    let bytes = std::fs::read(path).with_context(|| format!("{}", path.display()))?;
    Ok(read_map(&path.display().to_string(), &bytes)?)
}

/// Builds the library of model and motions, including the borrowed clips.
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

/// Returns the view of a link, having opened the motions and maps it lists that are files on disk. Options of the command
/// line override those of the link. Warns about anything that is not used.
pub(super) fn state_of_link(library: &mut Library, link: &str, borrowing: &Borrowing) -> anyhow::Result<ViewerState> {
    let mut state = state_of_view(library, link);
    let mut listed = state.clone();
    if borrowing.motion.is_some() {
        listed.motion.clear();
    }
    if borrowing.map.is_some() {
        listed.map.clear();
    }
    let Contents { motions, map, problems, .. } = open_view(&mut listed, false, &[])?;
    for problem in problems {
        eprintln!("warning: {problem}");
    }
    if !listed.motion.is_empty() {
        let motions = motions.unwrap_or_default();
        motions.iter().for_each(print_warnings);
        library.set_motions(motions);
    }
    if borrowing.map.is_some() {
        return Ok(state);
    }
    state.map = listed.map;
    state.map.extend(map.map(MotionMap::Names));
    for problem in settled_maps(library, &state).1 {
        eprintln!("warning: {problem}");
    }
    apply(&mut state, library, Command::SettleMaps);
    library.borrow_each(maps_in_force(library, &state));
    for error in library.borrow_errors() {
        eprintln!("warning: {error}");
    }
    Ok(state)
}

/// Returns a joint's name, or `#NODE` if the name is empty or not unique.
pub(super) fn joint_name(skeleton: &Skeleton, joint: JointIndex) -> String {
    let name = skeleton.name(joint);
    let alone = skeleton.joints().filter(|&other| skeleton.name(other) == name).count() == 1;
    if alone && !name.is_empty() { name.to_owned() } else { format!("#{}", skeleton.source_index(joint)) }
}
