//! From the seven primitive modes to plain lists (§3.7.2.1).

use crate::mesh::Topology;

/// Topology of a mode and the list that draws the same; none for an unknown mode. Incomplete primitives at the end are
/// left out, as the specification says.
pub fn to_list(mode: u32, indices: Vec<u32>) -> Option<(Topology, Vec<u32>)> {
    let count = indices.len();
    Some(match mode {
        0 => (Topology::Points, indices),
        1 => (Topology::Lines, whole(indices, 2)),
        2 => {
            let mut list = pairs(&indices);
            if count > 1 {
                list.extend([indices[count - 1], indices[0]]);
            }
            (Topology::Lines, list)
        }
        3 => (Topology::Lines, pairs(&indices)),
        4 => (Topology::Triangles, whole(indices, 3)),
        5 => {
            // Every other triangle is turned around, so that all face the same way.
            let triangle = |(at, corners): (usize, &[u32])| match at % 2 {
                0 => [corners[0], corners[1], corners[2]],
                _ => [corners[0], corners[2], corners[1]],
            };
            (Topology::Triangles, indices.windows(3).enumerate().flat_map(triangle).collect())
        }
        6 => {
            let first = indices.first().copied().unwrap_or(0);
            let rest = indices.get(1..).unwrap_or(&[]);
            (Topology::Triangles, rest.windows(2).flat_map(|edge| [edge[0], edge[1], first]).collect())
        }
        _ => return None,
    })
}

fn whole(mut indices: Vec<u32>, per_element: usize) -> Vec<u32> {
    indices.truncate(indices.len() / per_element * per_element);
    indices
}

fn pairs(indices: &[u32]) -> Vec<u32> {
    indices.windows(2).flat_map(|pair| [pair[0], pair[1]]).collect()
}
