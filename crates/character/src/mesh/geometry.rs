//! Mesh primitives, as flat arrays with one entry per vertex.

use glam::{Vec2, Vec3, Vec4};

/// Maximum number of influences per vertex.
pub const MAX_INFLUENCES: usize = 16;

/// How indices form elements. Strips, fans and loops are converted to lists on loading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Topology {
    /// One index per point.
    Points,
    /// Two indices per segment.
    Lines,
    /// Three indices per triangle, counter-clockwise seen from the front.
    #[default]
    Triangles,
}

impl Topology {
    /// Number of indices per point, line or triangle.
    pub fn indices_per_element(self) -> usize {
        match self {
            Self::Points => 1,
            Self::Lines => 2,
            Self::Triangles => 3,
        }
    }
}

/// A named list of primitives with the same morph targets.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// The name in the file; may be empty.
    pub name: String,
    /// Each with at most one material.
    pub primitives: Vec<Geometry>,
    /// Names of the morph targets that every primitive has.
    pub target_names: Vec<String>,
    /// The file's names of the primitives, if it has any.
    pub part_names: Vec<String>,
    /// Number of vertices in the file if several primitives share one vertex list; 0 if each has a list of its own.
    pub file_vertices: usize,
}

impl Mesh {
    /// Number of vertices in the file.
    pub fn file_vertex_count(&self) -> usize {
        match self.file_vertices {
            0 => self.primitives.iter().map(|geometry| geometry.file_vertices).sum(),
            count => count,
        }
    }
}

/// A primitive. Positions are in mesh space (bind space for a skinned mesh), metres. Optional attributes are empty or
/// have one entry per vertex, which [`Geometry::validate`] checks.
#[derive(Debug, Clone, Default)]
pub struct Geometry {
    /// What the indices form.
    pub topology: Topology,
    /// The number of positions is the number of vertices.
    pub positions: Vec<Vec3>,
    /// Unit length. If empty, triangles are flat-shaded or, if the view asks for it, use [`super::smooth_normals`].
    pub normals: Vec<Vec3>,
    /// xyz unit length, w the bitangent's sign.
    pub tangents: Vec<Vec4>,
    /// `TEXCOORD_0` and `TEXCOORD_1`, origin at the top left of the image.
    pub uvs: [Vec<Vec2>; 2],
    /// Linear, alpha last.
    pub colors: Vec<Vec4>,
    /// Never empty for a drawable primitive.
    pub indices: Vec<u32>,
    /// Joints and weights; empty if the primitive has none.
    pub influences: Influences,
    /// The same number in all primitives of the mesh.
    pub morph_targets: Vec<MorphTarget>,
    /// Index into the asset's materials; `None` for the default material.
    pub material: Option<usize>,
    /// Pairs of a material variant and the material that replaces [`Self::material`] in it, as indices into the asset's
    /// lists. Each variant occurs at most once.
    pub variants: Vec<(usize, usize)>,
    /// Number of vertices in the file, which come first and in the file's order. The rest are copies, made where a
    /// vertex has several tangents, texture coordinates or normals.
    pub file_vertices: usize,
    /// Each vertex's index in the file; empty if there are no copies and the indices are equal.
    pub file_vertex: Vec<u32>,
}

/// Deltas to the base attributes at weight 1, one per vertex. Each list may be empty.
#[derive(Debug, Clone, Default)]
pub struct MorphTarget {
    /// Empty if the target does not move vertices.
    pub positions: Vec<Vec3>,
    /// Added to the base normals before normalization.
    pub normals: Vec<Vec3>,
    /// xyz only: the bitangent's sign does not change.
    pub tangents: Vec<Vec3>,
}

/// Joints and weights that influence each vertex: `stride` pairs per vertex, strongest first, weights summing to 1,
/// unused pairs (0, 0.0). `stride` is 0 (not skinned) or a multiple of 4 up to [`MAX_INFLUENCES`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Influences {
    /// Pairs per vertex.
    pub stride: usize,
    /// Indices into [`super::Skin::joints`].
    pub joints: Vec<u16>,
    /// From 0 to 1, parallel to `joints`.
    pub weights: Vec<f32>,
}

impl Influences {
    /// Whether there are no influences, so the primitive is not skinned.
    pub fn is_empty(&self) -> bool {
        self.stride == 0
    }

    /// Joint and weight pairs of one vertex, including unused ones.
    pub fn of_vertex(&self, vertex: usize) -> impl Iterator<Item = (u16, f32)> + '_ {
        let range = vertex * self.stride..(vertex + 1) * self.stride;
        self.joints[range.clone()].iter().copied().zip(self.weights[range].iter().copied())
    }
}

/// Why a primitive is inconsistent.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum GeometryError {
    /// An attribute has the wrong number of entries.
    #[error("{attribute} has {found} entries, expected {expected}")]
    Count {
        /// The attribute, as named in messages.
        attribute: &'static str,
        /// Number of vertices; for influences, times `stride`.
        expected: usize,
        /// Number of entries.
        found: usize,
    },
    /// An index refers to a vertex that does not exist.
    #[error("index {index} is out of range, there are {vertices} vertices")]
    IndexOutOfRange {
        /// The first such index.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// An influence refers to a joint that the skin does not have.
    #[error("vertex {vertex} references joint {joint}, but the skin has only {joints} joints")]
    JointOutOfRange {
        /// The first such vertex.
        vertex: usize,
        /// Index into [`super::Skin::joints`].
        joint: u16,
        /// Number of joints in the skin.
        joints: usize,
    },
}

/// Returns the position of the first index that is not below `count`. Finds the maximum first: without an early exit,
/// that search is vectorized.
pub fn first_not_below<T: Copy + Ord + TryInto<usize>>(indices: &[T], count: usize) -> Option<usize> {
    let is_outside = |index: T| index.try_into().map_or(true, |index| index >= count);
    let largest = indices.iter().copied().max()?;
    if is_outside(largest) { indices.iter().position(|&index| is_outside(index)) } else { None }
}

impl Geometry {
    /// Checks that array lengths match and indices are in range. `skin_joints` is the joint count of the smallest skin
    /// that this geometry is used with, if any.
    pub fn validate(&self, skin_joints: Option<usize>) -> Result<(), GeometryError> {
        let vertices = self.positions.len();
        let check = |attribute: &'static str, found: usize, optional: bool| {
            if found == vertices || (optional && found == 0) {
                Ok(())
            } else {
                Err(GeometryError::Count { attribute, expected: vertices, found })
            }
        };
        check("normals", self.normals.len(), true)?;
        check("tangents", self.tangents.len(), true)?;
        check("texture coordinates 0", self.uvs[0].len(), true)?;
        check("texture coordinates 1", self.uvs[1].len(), true)?;
        check("colours", self.colors.len(), true)?;
        check("file vertices", self.file_vertex.len(), true)?;
        for target in &self.morph_targets {
            check("morph target positions", target.positions.len(), true)?;
            check("morph target normals", target.normals.len(), true)?;
            check("morph target tangents", target.tangents.len(), true)?;
        }
        let expected = self.influences.stride * vertices;
        for found in [self.influences.joints.len(), self.influences.weights.len()] {
            if found != expected {
                return Err(GeometryError::Count { attribute: "influences", expected, found });
            }
        }
        if let Some(at) = first_not_below(&self.indices, vertices) {
            return Err(GeometryError::IndexOutOfRange { index: self.indices[at], vertices });
        }
        if let Some(joints) = skin_joints
            && let Some(at) = first_not_below(&self.influences.joints, joints)
        {
            let (vertex, joint) = (at / self.influences.stride, self.influences.joints[at]);
            return Err(GeometryError::JointOutOfRange { vertex, joint, joints });
        }
        Ok(())
    }

    /// Returns the material in a variant; `None` is the default material.
    pub fn material_in(&self, variant: Option<usize>) -> Option<usize> {
        let of_variant = self.variants.iter().find(|&&(index, _)| Some(index) == variant);
        of_variant.map_or(self.material, |&(_, material)| Some(material))
    }

    /// Returns the file's index of a vertex.
    pub fn number_in_file(&self, vertex: usize) -> usize {
        self.file_vertex.get(vertex).map_or(vertex, |&number| number as usize)
    }

    /// Number of triangles; 0 for points and lines.
    pub fn triangles(&self) -> usize {
        if self.topology == Topology::Triangles { self.indices.len() / 3 } else { 0 }
    }
}
