//! What lights the scene besides the lights of a file, and how bright it becomes in the picture.

use serde::{Deserialize, Serialize};

/// An environment that is generated, not loaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LightSetup {
    /// Soft boxes around the model, with a key light from the front left.
    #[default]
    Studio,
    /// The same white light from all directions and no key light.
    White,
    /// A tent of large weak boxes.
    Soft,
    /// A small strong lamp in a dark room.
    Hard,
    /// A clear sky with the sun.
    Outdoor,
}

/// How the brightness of the scene becomes that of the picture. Unlit surfaces keep their colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToneMap {
    /// Khronos PBR Neutral: keeps colours, compresses highlights.
    #[default]
    Neutral,
    /// ACES, as films look.
    Aces,
    /// AgX, as in Blender.
    Agx,
    /// Cuts off what is brighter than white.
    None,
}
