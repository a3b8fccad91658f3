//! Smooth normals for primitives without normals.

use foldhash::{HashMap, HashMapExt};
use glam::Vec3;

use super::{Geometry, Topology};

/// Computes unit vertex normals at the bind pose for each primitive without normals: the mean normal of the adjacent
/// triangles of all primitives, weighted by their angles at the vertex (Thürmer and Wüthrich 1998), which makes it
/// independent of the triangulation. Vertices at the same position share a normal, so that seams do not show. Empty for
/// primitives with normals and for points and lines.
pub fn smooth_normals(primitives: &[Geometry]) -> Vec<Vec<Vec3>> {
    let is_surface = |geometry: &Geometry| geometry.topology == Topology::Triangles;
    let wanted = |geometry: &Geometry| is_surface(geometry) && geometry.normals.is_empty();
    if !primitives.iter().any(wanted) {
        return vec![Vec::new(); primitives.len()];
    }
    let mut shared: HashMap<[u32; 3], usize> = HashMap::new();
    let mut share = |position: &Vec3| {
        let next = shared.len();
        // Adding zero makes -0 equal to 0.
        *shared.entry((*position + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert(next)
    };
    let shared_of: Vec<Vec<usize>> =
        primitives.iter().map(|geometry| geometry.positions.iter().map(&mut share).collect()).collect();
    let mut sums = vec![Vec3::ZERO; shared.len()];
    for (geometry, shared_of) in primitives.iter().zip(&shared_of).filter(|(geometry, _)| is_surface(geometry)) {
        for &triangle in geometry.indices.as_chunks::<3>().0 {
            let corners = triangle.map(|index| geometry.positions[index as usize]);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
            for (at, &index) in triangle.iter().enumerate() {
                let (a, b) = (corners[(at + 1) % 3] - corners[at], corners[(at + 2) % 3] - corners[at]);
                let angle = a.angle_between(b);
                if angle.is_finite() {
                    sums[shared_of[index as usize]] += angle * normal;
                }
            }
        }
    }
    let normals = |(geometry, shared_of): (&Geometry, &Vec<usize>)| match wanted(geometry) {
        true => shared_of.iter().map(|&index| sums[index].normalize_or(Vec3::Y)).collect(),
        false => Vec::new(),
    };
    primitives.iter().zip(&shared_of).map(normals).collect()
}
