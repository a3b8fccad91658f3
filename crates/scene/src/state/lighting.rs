//! What lights the scene besides the lights of a file, and how radiance is tone-mapped for display.

use std::ops::RangeInclusive;

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

/// The tone-mapping operator. Unlit surfaces bypass it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToneMap {
    /// Khronos PBR Neutral: keeps colours, compresses highlights.
    #[default]
    Neutral,
    /// ACES, a filmic look.
    Aces,
    /// AgX, as in Blender.
    Agx,
    /// Cuts off what is brighter than white.
    None,
}

/// Where the light comes from, besides the lights of a file. Kept with another model and covered by undo.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Lighting {
    /// Light from all around.
    pub environment: EnvironmentChoice,
    /// Replaces the environment's own key light; `None` leaves it.
    pub key: Option<KeyLight>,
}

/// Light from all around.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EnvironmentChoice {
    /// A generated one.
    Setup(LightSetup),
    /// An .hdr file: a URL or the name of a local file. The studio stands in for it until it is loaded.
    File(String),
}

impl Default for EnvironmentChoice {
    fn default() -> Self {
        Self::Setup(LightSetup::Studio)
    }
}

/// A directional light besides the environment's. The lights of a file replace it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct KeyLight {
    /// Illuminance on a surface that faces it, over π: a white one becomes as bright as this. 0 switches it off.
    pub strength: f32,
    /// Where it comes from, without light rotation: 0 is +Z, 90 is +X.
    pub yaw_degrees: f32,
    /// Above the horizon.
    pub pitch_degrees: f32,
}

impl KeyLight {
    /// The studio's own key light.
    pub const STUDIO: Self = Self { strength: 0.32, yaw_degrees: -44.0, pitch_degrees: 46.0 };
    /// Range of the strength.
    pub const STRENGTH: RangeInclusive<f32> = 0.0..=10.0;
    /// Range of the pitch.
    pub const PITCH_DEGREES: RangeInclusive<f32> = -90.0..=90.0;
}
