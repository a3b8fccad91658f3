//! Biovision hierarchy (.bvh): a skeleton and one motion as text.
//!
//! ```text
//! HIERARCHY
//! ROOT hip { OFFSET x y z  CHANNELS 6 Xposition … Yrotation  JOINT … { … }  End Site { OFFSET x y z } }
//! MOTION
//! Frames: 14
//! Frame Time: 0.066667
//! one line of numbers per frame, channels in file order
//! ```
//!
//! The format has no owner. Programs agree on the following: keywords in any case, any white space; angles in degrees; a
//! joint's rotation is the product of its rotation channels in the order listed (the first is the outermost); position channels
//! replace the OFFSET. Units and up axis are not stated: see [`frame_of_reference`]. End Sites give the length of the
//! last bones and help to guess the size; they are not joints and have no number.

mod clip;
mod frame_of_reference;
mod hierarchy;
mod motion;
mod write;

use gaitway_character::anim::{Clip, Joint, Skeleton, Transform};
use gaitway_character::asset::{Asset, AssetParts, Warnings};

use super::{LoadError, LoadOptions};
use crate::encoding;
use crate::error::Problem;
use crate::file_set::file_stem;
use crate::limits::Budget;
use crate::lines::{self, Lines};
use frame_of_reference::FrameOfReference;
use hierarchy::Hierarchy;
pub use write::write;

pub(super) fn is_bvh(bytes: &[u8]) -> bool {
    // Some programs write UTF-16: every other byte of its ASCII is zero.
    let start = bytes.iter().take(64).filter(|&&byte| !matches!(byte, 0 | 0xFE | 0xFF)).copied().collect::<Vec<u8>>();
    let text = start.strip_prefix(lines::BYTE_ORDER_MARK).unwrap_or(&start).trim_ascii_start();
    text.get(..9).is_some_and(|word| word.eq_ignore_ascii_case(b"HIERARCHY"))
}

/// Reads a file's skeleton (rest pose: the OFFSETs, unrotated) and its motion, one key per frame, in metres and Y up.
pub(super) fn load(file: &str, bytes: &[u8], options: &LoadOptions) -> Result<Asset, LoadError> {
    read(file, bytes, options).map_err(|problem| problem.in_file(file))
}

fn read(file: &str, bytes: &[u8], options: &LoadOptions) -> Result<Asset, Problem> {
    let mut warnings = Warnings::default();
    let budget = Budget::default();
    let text = encoding::utf8(bytes);
    let mut lines = Lines::new(&text);
    let hierarchy = Hierarchy::read(&mut lines, &budget, &mut warnings)?;
    let motion = motion::read(&mut lines, &hierarchy, &budget, &mut warnings)?;
    let frame = FrameOfReference::find(&hierarchy, motion.as_ref(), options, &mut warnings);
    let skeleton = skeleton(&hierarchy, &frame)?;
    let clips: Vec<Clip> = match motion {
        Some(motion) => {
            motion.into_clip(stem(file), &hierarchy, &frame, &skeleton, &budget, &mut warnings)?.into_iter().collect()
        }
        None => Vec::new(),
    };
    let mut asset = Asset::new(AssetParts { format: "bvh", skeleton, clips, ..AssetParts::default() })?;
    asset.warnings = warnings;
    Ok(asset)
}

fn skeleton(hierarchy: &Hierarchy, frame: &FrameOfReference) -> Result<Skeleton, Problem> {
    let mut joints = Vec::with_capacity(hierarchy.joints.len());
    for (index, joint) in hierarchy.joints.iter().enumerate() {
        let translation = frame.point(joint.offset);
        if !translation.is_finite() {
            let found = format!("{:?}", joint.offset.to_array());
            return Err(Problem::new(format!("OFFSET of joint {index}"), "numbers that fit into 32 bits", found));
        }
        joints.push(Joint {
            name: joint.name.clone(),
            parent: joint.parent,
            rest: Transform::from_translation(translation),
            morph_weights: Vec::new(),
        });
    }
    Skeleton::new(joints).map_err(|problem| Problem::new("HIERARCHY", "a tree of joints", problem))
}

/// Names the clip after the file, since BVH has no clip names.
fn stem(file: &str) -> &str {
    match file_stem(file) {
        "" => "motion",
        stem => stem,
    }
}
