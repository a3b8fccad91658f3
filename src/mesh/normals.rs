//! Smooth normals for a mesh that has none.

use std::collections::HashMap;

use glam::Vec3;

use super::{Geometry, Topology};

/// One unit normal per vertex at the bind pose: the mean of the triangles around it, weighted by their angles there
/// (Thürmer and Wüthrich 1998), so that how a flat part is cut into triangles does not matter. Vertices at the very same
/// place count as one, or seams would show. Empty for what is not triangles.
pub fn smooth_normals(geometry: &Geometry) -> Vec<Vec3> {
    if geometry.topology != Topology::Triangles {
        return Vec::new();
    }
    let mut first_at: HashMap<[u32; 3], u32> = HashMap::with_capacity(geometry.positions.len());
    let place = |at: &Vec3| (*at + Vec3::ZERO).to_array().map(f32::to_bits);
    let first: Vec<u32> =
        geometry.positions.iter().zip(0..).map(|(at, vertex)| *first_at.entry(place(at)).or_insert(vertex)).collect();
    let mut sums = vec![Vec3::ZERO; geometry.positions.len()];
    for &triangle in geometry.indices.as_chunks::<3>().0 {
        let corners = triangle.map(|index| geometry.positions[index as usize]);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        for (at, &index) in triangle.iter().enumerate() {
            let (a, b) = (corners[(at + 1) % 3] - corners[at], corners[(at + 2) % 3] - corners[at]);
            let angle = a.angle_between(b);
            if angle.is_finite() {
                sums[first[index as usize] as usize] += angle * normal;
            }
        }
    }
    first.iter().map(|&vertex| sums[vertex as usize].normalize_or(Vec3::Y)).collect()
}
