//! Converts the motion of people in NumPy arrays (`.npz` and `.npy`), as AMASS, tools for SMPL bodies and motion models write it, to
//! glTF, in memory: a skeleton and a clip for each person or sample. It is a crate of its own, since the page downloads it as a
//! separate wasm module, only for those who open such a file.
//!
//! # The container
//!
//! An array, or a zip archive of arrays, `NAME.npy`. Each begins with `\x93NUMPY`, the version (two bytes), the length of its header
//! (u16; u32 from version 2 on), and the header: a Python dictionary with `descr` (byte order, kind and size of a number: `'<f8'`),
//! `fortran_order` (whether the first index varies fastest) and `shape`. The numbers follow. Arrays of kind `O` are pickled
//! Python objects, which could run any code when they are read: they are refused.
//!
//! # The arrays
//!
//! | what | names | shape |
//! | --- | --- | --- |
//! | rotations of all joints | `poses`, `pose`, `fullpose`, `smpl_poses` (AMASS, AIST++), `rot6d` (HY-Motion), `local_rot_mats`, `global_rot_mats` (Kimodo), `thetas` (MDM) … | frames × joints × 3, 4, 6, 9 or 3 × 3 |
//! | or of each group: | | |
//! | the pelvis | `root_orient`, `global_orient` | frames × 1 × … |
//! | the body | `pose_body`, `body_pose` | frames × 21 × …, or 23 with the hands |
//! | the fingers (optional) | `pose_hand`, or `left_hand_pose` and `right_hand_pose` | frames × 30 × …, or 15 each |
//! | path (optional) | `trans`, `transl`, `smpl_trans`, `root_translation` | frames × 3 |
//! | the path's units per metre (optional) | `smpl_scaling` | 1 |
//! | position of the pelvis (optional) | `root_positions` (Kimodo) | frames × 3 |
//! | positions, alone or besides rotations | `posed_joints` (Kimodo), `keypoints3d` (HY-Motion), `joints`, … | frames × joints × 3 |
//! | frames per second | `mocap_framerate`, `mocap_frame_rate`, `fps` | 1 |
//!
//! Other names are recognized by what the array holds (`find`). Rotations are axis times angle in radians, matrices row by row,
//! quaternions or two axes of a matrix (`rotations`), relative to the parent joint, except those that are called global. Axes may be in
//! any order, with a further one for people or samples (`layout`). Joints that are only placed are turned by `solve`. Names that begin
//! with `smpl_` are those of AIST++, which scales the body to its path. Shape (`betas`), soft tissue (`dmpls`) and faces are ignored.
//!
//! Sources: the documentation of AMASS and SMPL-X; Kimodo's “Output Formats” and its `skeleton/definitions.py`; HY-Motion's
//! `pipeline/body_model.py` and `utils/geometry.py`; HumanML3D's `paramUtil.py` and `quaternion.py`; MDM's `sample/generate.py`.
//!
//! # The skeleton
//!
//! The first 22 joints are those of every SMPL body, in its order and with its names, and those of HumanML3D. 24 have a hand each,
//! 52 (SMPL+H) the fingers instead, 55 (SMPL-X) jaw and eyes before the fingers. SOMA has 30 joints in Kimodo's model and 77 in what
//! it writes. A file with rotations alone doesn't say how long the bones are: that is in the body model, which Gaitway doesn't have. The
//! proportions here are an average adult's to the centimetre, so feet may be some centimetres off the ground; retargeting, which
//! fits rotations and the height of the hips, isn't affected. With positions, the bones are the file's.
//!
//! # Conventions
//!
//! Right-handed, metres. At rest the person stands in a T-pose, faces +Z and has +Y up; of SMPL, with the origin near the breastbone:
//! the pelvis lies at `skeleton::PELVIS`, and `trans` moves it from there. AMASS has Z up in the world, so that its pelvis is
//! rotated by 90° while a person stands; other data has Y up (`up`).

#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![forbid(unsafe_code)]

mod archive;
mod array;
mod find;
mod layout;
mod motion;
mod rotations;
mod skeleton;
mod solve;
mod up;

use archive::Archive;
use gaitway_glb::Warnings;
use gaitway_part::{Answer, Output};

/// Converts the bytes of a whole `.npz` or `.npy` file into those of a `.glb`.
///
/// # Errors
///
/// Returns a message for the user (what was expected, what was found and what to do) if the file can't be read, holds no
/// motion, or exceeds a limit.
pub fn convert(bytes: &[u8]) -> Answer {
    let archive = Archive::open(bytes)?;
    let mut warnings = Warnings::default();
    let motion = motion::Motion::read(&archive, &mut warnings)?;
    let bytes = motion.write(archive.extension(), &mut warnings)?;
    Ok(Output { bytes, warnings: warnings.into_sentences() })
}
