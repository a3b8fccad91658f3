//! Converts the motion of a person in a NumPy archive (`.npz`), as AMASS and tools for SMPL bodies write it, to glTF, in memory:
//! a skeleton and one clip. It is a crate of its own, since the page downloads it as a separate wasm module, only for those
//! who open such a file.
//!
//! # The container
//!
//! A zip archive of arrays, `NAME.npy`. Each begins with `\x93NUMPY`, the version (two bytes), the length of its header (u16;
//! u32 from version 2 on), and the header: a Python dictionary with `descr` (byte order, kind and size of a number: `'<f8'`),
//! `fortran_order` (whether the first index varies fastest) and `shape`. The numbers follow. Arrays of kind `O` are pickled
//! Python objects, which could run any code when they are read: they are refused.
//!
//! # The arrays
//!
//! | what | names | shape |
//! | --- | --- | --- |
//! | rotations of all joints | `poses`, `pose`, `fullpose`, `smpl_poses` | frames × 3·joints, or frames × joints × 3 |
//! | or of each group: | | |
//! | the pelvis | `root_orient`, `global_orient` | frames × 3 |
//! | the body | `pose_body`, `body_pose` | frames × 63, or 69 with the hands |
//! | the fingers (optional) | `pose_hand`, or `left_hand_pose` and `right_hand_pose` | frames × 90, or 45 each |
//! | path (optional) | `trans`, `transl`, `smpl_trans` | frames × 3 |
//! | the path's units per metre (optional) | `smpl_scaling` | 1 |
//! | frames per second | `mocap_framerate`, `mocap_frame_rate`, `fps` | 1 |
//!
//! Rotations are axis times angle in radians, or matrices (× 3 × 3 or × 9 numbers, row by row), relative to the parent joint. A
//! batch axis of length 1 may be anywhere. Names that begin with `smpl_` are those of AIST++, which scales the body to its path.
//! Shape (`betas`), soft tissue (`dmpls`) and faces are ignored.
//!
//! # The skeleton
//!
//! The first 22 joints are those of every SMPL body, in its order and with its names. 24 have a hand each, 52 (SMPL+H) the
//! fingers instead, 55 (SMPL-X) jaw and eyes before the fingers. A file doesn't say how long the bones are: that is in the
//! body model, which Gaitway doesn't have. The proportions here are an average adult's to the centimetre, so feet may be
//! some centimetres off the ground; retargeting, which fits rotations and the height of the hips, isn't affected.
//!
//! # Conventions
//!
//! Right-handed, metres. At rest the person stands in a T-pose, faces +Z and has +Y up, with the origin near the breastbone: the
//! pelvis lies at `body::PELVIS`, and `trans` moves it from there. AMASS has Z up in the world, so that its pelvis is
//! rotated by 90° while a person stands; other data has Y up. The one that the pelvis's own Y axis is closer to on average
//! is taken as up, unless `trans` shows that the person lies: the body would be in the ground then, and wouldn't with the other
//! axis.

#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![forbid(unsafe_code)]

mod archive;
mod array;
mod body;
mod motion;

use archive::Archive;
use gaitway_glb::{Glb, Warnings};
use gaitway_part::{Answer, Output};

/// Converts the bytes of a whole `.npz` file into those of a `.glb`.
///
/// # Errors
///
/// Returns a message for the user (what was expected, what was found and what to do) if the file can't be read, holds no
/// motion, or exceeds a limit.
pub fn convert(bytes: &[u8]) -> Answer {
    let archive = Archive::open(bytes)?;
    let mut warnings = Warnings::default();
    let motion = motion::Motion::read(&archive, &mut warnings)?;
    let mut glb = Glb::new(".npz");
    body::write(motion.joints(), &mut glb);
    motion.write(&mut glb, &mut warnings)?;
    Ok(Output { bytes: glb.write()?, warnings: warnings.into_sentences() })
}
