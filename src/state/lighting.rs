//! What lights the scene besides the lights of a file.

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
