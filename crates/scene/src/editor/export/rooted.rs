//! A model with a root bone above its hips, and clips whose travel is on it.

use gaitway_character::anim::{Clip, JointIndex, Skeleton};
use gaitway_character::asset::Slot;
use gaitway_formats::{FileSet, insert_root, load, write_model};
use gaitway_retarget::{RootTravel, clip_for, with_root_motion};

use crate::library::Model;

/// The file that is read again in between.
const FILE: &str = "model.glb";

/// What the bone is called, with a number if a joint has that name.
const NAME: &str = "root";

/// The root bone that a model already has: the parent of its hips, if it is a bone.
pub(super) fn own_root(model: &Model) -> Option<JointIndex> {
    let parent = model.asset.skeleton.parent(hips(model)?)?;
    model.asset.skins.iter().any(|skin| skin.joints().contains(&parent)).then_some(parent)
}

/// The joint that a root bone goes above.
pub(super) fn hips(model: &Model) -> Option<JointIndex> {
    model.body().slots.joint(Slot::Hips)
}

/// Writes a model, a GLB without clips, with a root bone above the joint at index `below` and with `clips` of the skeleton `of`.
///
/// # Errors
/// The message for the user.
pub(super) fn rooted(
    bare: &[u8],
    below: usize,
    of: &Skeleton,
    clips: &[(Clip, RootTravel)],
) -> Result<Vec<u8>, String> {
    let bare_asset = load(&one_file(bare.to_vec())).map_err(|error| error.to_string())?;
    let skeleton = &bare_asset.skeleton;
    let mut names = std::iter::once(NAME.to_owned()).chain((2..).map(|number| format!("{NAME}_{number}")));
    let name = names.find(|name| skeleton.find(name).is_none()).unwrap_or_default();
    let no_hips = || "the hips are not in the file".to_owned();
    let hips = skeleton.joint_of_source(below).ok_or_else(no_hips)?;
    let bytes = insert_root(FILE, bare, &bare_asset, hips, &name).map_err(|error| error.to_string())?;
    let files = one_file(bytes);
    let asset = load(&files).map_err(|error| error.to_string())?;
    let place = |source: usize| asset.skeleton.joint_of_source(source);
    let (hips, root) = place(below).zip(place(skeleton.len())).ok_or_else(no_hips)?;
    let moved = |(clip, travel): &(Clip, RootTravel)| {
        let clip = clip_for(&asset.skeleton, clip, |joint| place(of.source_index(joint))).ok_or_else(no_hips)?;
        with_root_motion(&asset.skeleton, &clip, hips, root, *travel).map_err(|error| error.to_string())
    };
    let clips: Vec<Clip> = clips.iter().map(moved).collect::<Result<_, _>>()?;
    let clips: Vec<&Clip> = clips.iter().collect();
    write_model(&files, FILE, &asset.skeleton, &clips).map_err(|error| error.to_string())
}

fn one_file(bytes: Vec<u8>) -> FileSet {
    let mut files = FileSet::default();
    files.insert(FILE, bytes);
    files
}
