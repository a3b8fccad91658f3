//! What a device may be too small for.

/// Why a model cannot be drawn.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum UploadError {
    /// A vertex or index buffer, or the texture of the influences, exceeds the device's limits.
    #[error("mesh {mesh}, primitive {primitive}: {vertices} vertices are more than this device can hold")]
    TooManyVertices {
        /// Index of the mesh in the asset.
        mesh: usize,
        /// Index of the primitive in the mesh.
        primitive: usize,
        /// Number of vertices in the primitive.
        vertices: usize,
    },
    /// The texture of the morph deltas exceeds the device's limits.
    #[error(
        "mesh {mesh}, primitive {primitive}: {targets} morph targets of {vertices} vertices are more than this device can hold"
    )]
    TooManyMorphTargets {
        /// Index of the mesh in the asset.
        mesh: usize,
        /// Index of the primitive in the mesh.
        primitive: usize,
        /// Number of vertices in the primitive.
        vertices: usize,
        /// Number of morph targets.
        targets: usize,
    },
}
