//! A clip without its model, as a file: the formats, and writing them.

use gaitway_character::anim::{Clip, Skeleton};
use gaitway_character::asset::Slot;
use gaitway_formats::{WriteError, write_bvh, write_motion, write_vrma};

use crate::library::Model;

/// File format of a clip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClipFormat {
    /// glTF with the nodes of the model and no meshes.
    Glb,
    /// Biovision hierarchy, with the joints that are drawn.
    Bvh,
    /// VRM animation, with the bones of a human body.
    Vrma,
}

impl ClipFormat {
    /// All formats in display order.
    pub const ALL: [Self; 3] = [Self::Glb, Self::Bvh, Self::Vrma];

    /// Returns the format with this file extension, in lower case.
    pub fn of_extension(extension: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.extension() == extension)
    }

    /// The file extension, in lower case.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Glb => "glb",
            Self::Bvh => "bvh",
            Self::Vrma => "vrma",
        }
    }

    /// Whether clips of the model can be written in this format.
    pub fn fits(self, model: &Model) -> bool {
        self != Self::Vrma || model.body().slots.joint(Slot::Hips).is_some()
    }
}

/// Writes a clip of the model. `skeleton` has its joints, perhaps with other names; `frames_per_sec` is used where the format
/// needs a rate and the keys don't give one.
pub fn write_clip(
    model: &Model,
    skeleton: &Skeleton,
    clip: &Clip,
    frames_per_sec: f64,
    format: ClipFormat,
) -> Result<Vec<u8>, WriteError> {
    match format {
        ClipFormat::Glb => write_motion(&model.asset, skeleton, &[clip]),
        ClipFormat::Bvh => {
            let joints: Vec<_> = skeleton.joints().filter(|&joint| model.rig().is_real(joint)).collect();
            write_bvh(&model.asset, skeleton, &joints, clip, frames_per_sec)
        }
        ClipFormat::Vrma => write_vrma(&model.asset, model.body().slots, model.forward(), clip),
    }
}
