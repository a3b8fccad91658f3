//! Converts the seven primitive modes to plain lists (§3.7.2.1).

use gltf::json::mesh::Mode;

use gaitway_character::mesh::Topology;

/// Returns the topology of a mode and the equivalent list. Drops an incomplete primitive at the end, as the
/// specification requires.
pub fn to_list(mode: Mode, indices: Vec<u32>) -> (Topology, Vec<u32>) {
    let count = indices.len();
    match mode {
        Mode::Points => (Topology::Points, indices),
        Mode::Lines => (Topology::Lines, complete(indices, 2)),
        Mode::LineLoop => {
            let mut list = pairs(&indices);
            if count > 1 {
                list.extend([indices[count - 1], indices[0]]);
            }
            (Topology::Lines, list)
        }
        Mode::LineStrip => (Topology::Lines, pairs(&indices)),
        Mode::Triangles => (Topology::Triangles, complete(indices, 3)),
        Mode::TriangleStrip => {
            // Every other triangle is reversed, so that all face the same way.
            let triangle = |(at, corners): (usize, &[u32])| match at % 2 {
                0 => [corners[0], corners[1], corners[2]],
                _ => [corners[0], corners[2], corners[1]],
            };
            (Topology::Triangles, indices.windows(3).enumerate().flat_map(triangle).collect())
        }
        Mode::TriangleFan => {
            let first = indices.first().copied().unwrap_or(0);
            let rest = indices.get(1..).unwrap_or(&[]);
            (Topology::Triangles, rest.windows(2).flat_map(|edge| [edge[0], edge[1], first]).collect())
        }
    }
}

fn complete(mut indices: Vec<u32>, per_element: usize) -> Vec<u32> {
    indices.truncate(indices.len() / per_element * per_element);
    indices
}

fn pairs(indices: &[u32]) -> Vec<u32> {
    indices.windows(2).flat_map(|pair| [pair[0], pair[1]]).collect()
}
