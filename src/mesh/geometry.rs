//! One drawable piece of a mesh, as flat arrays with one entry per vertex.

use glam::{Vec2, Vec3, Vec4};

/// The most influences a vertex keeps.
pub const MAX_INFLUENCES: usize = 16;

/// What the indices mean. Strips, fans and loops are turned into lists when a file is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Topology {
    Points,
    Lines,
    #[default]
    Triangles,
}

impl Topology {
    pub fn indices_per_element(self) -> usize {
        match self {
            Self::Points => 1,
            Self::Lines => 2,
            Self::Triangles => 3,
        }
    }
}

/// A named list of pieces that share morph targets' names and default weights.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    pub name: String,
    pub primitives: Vec<Geometry>,
    /// Names of the morph targets; as many as each primitive has targets.
    pub target_names: Vec<String>,
    /// What the file calls its pieces, one name for each; empty when it has no names for them.
    pub part_names: Vec<String>,
    /// How many vertices the file has, if it has one list for all pieces and the mesh several of them; else 0: each piece
    /// has a list of its own.
    pub file_vertices: usize,
}

impl Mesh {
    /// How many vertices the file has for it.
    pub fn file_vertex_count(&self) -> usize {
        match self.file_vertices {
            0 => self.primitives.iter().map(|geometry| geometry.file_vertices).sum(),
            count => count,
        }
    }
}

/// Positions in mesh space (bind space for a skinned mesh), metres. Optional attributes are empty or have one entry per
/// vertex; [`Geometry::validate`] says whether they do.
#[derive(Debug, Clone, Default)]
pub struct Geometry {
    pub topology: Topology,
    pub positions: Vec<Vec3>,
    /// Unit length; empty: flat, computed from the deformed triangles where they are drawn.
    pub normals: Vec<Vec3>,
    /// xyz unit length, w the bitangent's sign.
    pub tangents: Vec<Vec4>,
    pub uvs: [Vec<Vec2>; 2],
    /// Linear, alpha last.
    pub colors: Vec<Vec4>,
    /// Always a list; never empty for a drawable geometry.
    pub indices: Vec<u32>,
    pub influences: Influences,
    pub morph_targets: Vec<MorphTarget>,
    pub material: Option<usize>,
    /// How many vertices the file has. Vertices past it are copies made where one has two tangents, texture coordinates or
    /// normals; they come last, so the first `file_vertices` are the file's own in the file's order.
    pub file_vertices: usize,
    /// Which vertex of the file each is a copy of; empty: there are no copies, the numbers are the file's.
    pub file_vertex: Vec<u32>,
}

/// Differences from the base attributes at weight 1; normals and tangents may be empty.
#[derive(Debug, Clone, Default)]
pub struct MorphTarget {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub tangents: Vec<Vec3>,
}

/// Which joints pull a vertex and how hard: `stride` pairs per vertex, strongest first, weights summing to 1, unused
/// pairs (0, 0.0). `stride` is 0 (not skinned) or a multiple of 4 up to [`MAX_INFLUENCES`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Influences {
    pub stride: usize,
    /// Indices into [`super::Skin::joints`].
    pub joints: Vec<u16>,
    pub weights: Vec<f32>,
}

impl Influences {
    pub fn is_empty(&self) -> bool {
        self.stride == 0
    }

    pub fn of_vertex(&self, vertex: usize) -> impl Iterator<Item = (u16, f32)> + '_ {
        let range = vertex * self.stride..(vertex + 1) * self.stride;
        self.joints[range.clone()].iter().copied().zip(self.weights[range].iter().copied())
    }
}

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum GeometryError {
    #[error("{attribute} has {found} entries, expected {expected}")]
    Count { attribute: &'static str, expected: usize, found: usize },
    #[error("index {index} points at a vertex, but there are only {vertices}")]
    IndexOutOfRange { index: u32, vertices: usize },
    #[error("vertex {vertex} follows joint {joint}, but the skin has only {joints}")]
    JointOutOfRange { vertex: usize, joint: u16, joints: usize },
}

impl Geometry {
    /// Checks that all arrays agree in length and that indices are in range. `skin_joints` is the size of the smallest
    /// skin this geometry is used with, if any.
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
        check("vertices of the file", self.file_vertex.len(), true)?;
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
        // The folds come first because, without early exit, they are vectorized.
        let is_outside = |index: &u32| *index as usize >= vertices;
        if self.indices.iter().fold(false, |found, index| found | is_outside(index))
            && let Some(&index) = self.indices.iter().find(|&index| is_outside(index))
        {
            return Err(GeometryError::IndexOutOfRange { index, vertices });
        }
        let joints_of_vertices = &self.influences.joints;
        if let Some(joints) = skin_joints
            && joints_of_vertices.iter().fold(false, |found, &joint| found | (usize::from(joint) >= joints))
            && let Some(at) = joints_of_vertices.iter().position(|&joint| usize::from(joint) >= joints)
        {
            let (vertex, joint) = (at / self.influences.stride, self.influences.joints[at]);
            return Err(GeometryError::JointOutOfRange { vertex, joint, joints });
        }
        Ok(())
    }

    /// The number that the file has for a vertex.
    pub fn number_in_file(&self, vertex: usize) -> usize {
        self.file_vertex.get(vertex).map_or(vertex, |&number| number as usize)
    }

    pub fn triangles(&self) -> usize {
        if self.topology == Topology::Triangles { self.indices.len() / 3 } else { 0 }
    }
}
