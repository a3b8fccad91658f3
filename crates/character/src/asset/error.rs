//! Why parts don't form a valid asset.

use crate::mesh::GeometryError;

/// The first inconsistency found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AssetError {
    /// An index is out of range.
    #[error("{list}: expected an index below {count}, found {index}")]
    Index {
        /// The list with the bad index, such as `skins`.
        list: &'static str,
        /// The index found.
        index: usize,
        /// Length of the list that it points into.
        count: usize,
    },
    /// A primitive is inconsistent.
    #[error("meshes[{mesh}].primitives[{primitive}]: {problem}")]
    Geometry {
        /// Index into the asset's meshes.
        mesh: usize,
        /// Index into the mesh's primitives.
        primitive: usize,
        /// What is wrong with it.
        problem: GeometryError,
    },
}
