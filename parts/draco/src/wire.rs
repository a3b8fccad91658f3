//! The decoder's input and output as bytes. All numbers are 32-bit, little-endian.

use std::ops::Range;

use gaitway_part::words;

use crate::number::Target;

/// What an accessor declares about an attribute.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Attribute {
    /// Its unique id in the compressed mesh.
    pub id: u32,
    /// glTF's code, such as 5126 for 32-bit floats.
    pub component_type: u32,
    /// Components per vertex.
    pub components: u32,
}

/// One compressed mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mesh<'a> {
    /// The compressed bytes.
    pub source: &'a [u8],
    /// Limit on the vertices, and on the triangles.
    pub max_count: u32,
    /// Those to decode; the mesh may have others.
    pub attributes: Vec<Attribute>,
}

/// Facts about a decoded mesh. Its data begins with the indices of a list of triangles, then has each attribute of all vertices.
#[derive(Debug, Clone, PartialEq)]
pub struct Decoded {
    /// Number of vertices.
    pub vertices: u32,
    /// Number of indices.
    pub indices: u32,
    /// Smallest and largest components of each attribute.
    pub bounds: Vec<[Vec<f32>; 2]>,
}

impl Attribute {
    /// Bytes from one vertex to the next: a multiple of 4, as glTF demands.
    pub fn stride(&self) -> usize {
        let size = Target::new(self.component_type).map_or(0, Target::size);
        (size * self.components as usize).next_multiple_of(4)
    }
}

/// Writes the input of [`decode`](crate::decode). All decoded data together may have `max_bytes`.
pub fn write(max_bytes: u32, meshes: &[Mesh]) -> Vec<u8> {
    let mut input = max_bytes.to_le_bytes().to_vec();
    for mesh in meshes {
        let header = [mesh.max_count, mesh.attributes.len() as u32, mesh.source.len() as u32];
        let attributes = mesh.attributes.iter().flat_map(|one| [one.id, one.component_type, one.components]);
        input.extend(header.into_iter().chain(attributes).flat_map(u32::to_le_bytes));
        input.extend(mesh.source);
    }
    input
}

/// Reads what [`write`] wrote.
pub fn read(mut input: &[u8]) -> Option<(usize, Vec<Mesh<'_>>)> {
    let [max_bytes] = words(&mut input)?;
    let mut meshes = Vec::new();
    while !input.is_empty() {
        let [max_count, attributes, length] = words(&mut input)?;
        let attribute = |_| {
            let [id, component_type, components] = words(&mut input)?;
            Some(Attribute { id, component_type, components })
        };
        let attributes = (0..attributes).map(attribute).collect::<Option<_>>()?;
        let source = input.split_off(..length as usize)?;
        meshes.push(Mesh { source, max_count, attributes });
    }
    Some((max_bytes as usize, meshes))
}

impl Decoded {
    /// Bytes of an index.
    pub fn index_bytes(&self) -> usize {
        // 65,535 is not allowed as an index of two bytes.
        if self.vertices > u16::MAX.into() { 4 } else { 2 }
    }

    /// Where the indices and then each attribute are, from the beginning of the mesh's data; each range is followed by the next.
    pub fn ranges(&self, attributes: &[Attribute]) -> Vec<Range<usize>> {
        let indices = (self.indices as usize).saturating_mul(self.index_bytes()).saturating_add(3) & !3;
        let values = attributes.iter().map(|attribute| attribute.stride().saturating_mul(self.vertices as usize));
        let mut end = 0_usize;
        let range = |length: usize| {
            let start = end;
            end = start.saturating_add(length);
            start..end
        };
        std::iter::once(indices).chain(values).map(range).collect()
    }

    pub(crate) fn write(&self, output: &mut Vec<u8>) {
        output.extend([self.vertices, self.indices].into_iter().flat_map(u32::to_le_bytes));
        output.extend(self.bounds.iter().flatten().flatten().copied().flat_map(f32::to_le_bytes));
    }

    /// Splits an output into the facts about each mesh, given their attributes, and the data of all, one after the other.
    pub fn read_all<'a>(
        mut output: &'a [u8],
        meshes: impl Iterator<Item = &'a [Attribute]>,
    ) -> Option<(Vec<Self>, &'a [u8])> {
        let facts = meshes.map(|attributes| Self::read(&mut output, attributes)).collect::<Option<_>>()?;
        Some((facts, output))
    }

    fn read(output: &mut &[u8], attributes: &[Attribute]) -> Option<Self> {
        let [vertices, indices] = words(output)?;
        let mut row = |components: u32| {
            (0..components).map(|_| words(output).map(|[bits]| f32::from_bits(bits))).collect::<Option<Vec<_>>>()
        };
        let mut bounds = |attribute: &Attribute| Some([row(attribute.components)?, row(attribute.components)?]);
        let bounds = attributes.iter().map(&mut bounds).collect::<Option<_>>()?;
        Some(Self { vertices, indices, bounds })
    }
}
