//! Why parts do not make an asset.

use crate::mesh::GeometryError;

/// The first index that is out of range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AssetError {
    #[error("{list}: expected an index below {count}, found {index}")]
    Index { list: &'static str, index: usize, count: usize },
    #[error("meshes[{mesh}].primitives[{primitive}]: {problem}")]
    Geometry { mesh: usize, primitive: usize, problem: GeometryError },
}
