//! What the viewport shows of surfaces: the lit picture, or one input of shading as a flat colour.

use serde::{Deserialize, Serialize};

/// A single input of shading, drawn without light and tone mapping, or the whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Channel {
    /// The lit picture.
    #[default]
    Shaded,
    /// Base colour, as in its texture, times the material's factor and the vertex colours.
    BaseColor,
    /// World-space normals including the normal map, as `0.5 + 0.5 n`.
    Normal,
    /// World-space tangents, as `0.5 + 0.5 t`.
    Tangent,
    /// Perceptual roughness as grey.
    Roughness,
    /// Metalness as grey.
    Metallic,
    /// Ambient occlusion as grey; white is unoccluded.
    Occlusion,
    /// Emitted colour.
    Emissive,
    /// A checker that follows `TEXCOORD_0`: red along u, green along v, 16 fields per unit.
    Uv,
    /// `COLOR_0`.
    VertexColor,
    /// Number of influences per vertex, by colour.
    Influences,
    /// Triangle edges on plain surfaces that hide what is behind them.
    Wireframe,
}

impl Channel {
    /// In the order in which they are listed and cycled through.
    pub const ALL: [Self; 12] = [
        Self::Shaded,
        Self::BaseColor,
        Self::Normal,
        Self::Tangent,
        Self::Roughness,
        Self::Metallic,
        Self::Occlusion,
        Self::Emissive,
        Self::Uv,
        Self::VertexColor,
        Self::Influences,
        Self::Wireframe,
    ];

    /// Returns the channel this many places further in [`Self::ALL`], which starts over at its ends.
    pub fn cycled(self, by: isize) -> Self {
        Self::ALL[(self as isize + by).rem_euclid(Self::ALL.len() as isize) as usize]
    }
}
