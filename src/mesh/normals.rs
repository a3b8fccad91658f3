//! Smooth normals for pieces of a mesh that have none.

use std::collections::HashMap;

use glam::Vec3;

use super::{Geometry, Topology};

/// For each piece that has no normals one unit normal per vertex at the bind pose: the mean of the triangles around it, of
/// all pieces, weighted by their angles there (Thürmer and Wüthrich 1998), so that how a flat part is cut into triangles does
/// not matter. Vertices at the very same place count as one, or seams would show. Empty for pieces that have normals and
/// for what is not triangles.
pub fn smooth_normals(pieces: &[Geometry]) -> Vec<Vec<Vec3>> {
    let is_surface = |piece: &Geometry| piece.topology == Topology::Triangles;
    let wanted = |piece: &Geometry| is_surface(piece) && piece.normals.is_empty();
    if !pieces.iter().any(wanted) {
        return vec![Vec::new(); pieces.len()];
    }
    let mut places: HashMap<[u32; 3], usize> = HashMap::new();
    let mut place = |at: &Vec3| {
        let next = places.len();
        *places.entry((*at + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert(next)
    };
    let place_of: Vec<Vec<usize>> =
        pieces.iter().map(|piece| piece.positions.iter().map(&mut place).collect()).collect();
    let mut sums = vec![Vec3::ZERO; places.len()];
    for (piece, place_of) in pieces.iter().zip(&place_of).filter(|(piece, _)| is_surface(piece)) {
        for &triangle in piece.indices.as_chunks::<3>().0 {
            let corners = triangle.map(|index| piece.positions[index as usize]);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
            for (at, &index) in triangle.iter().enumerate() {
                let (a, b) = (corners[(at + 1) % 3] - corners[at], corners[(at + 2) % 3] - corners[at]);
                let angle = a.angle_between(b);
                if angle.is_finite() {
                    sums[place_of[index as usize]] += angle * normal;
                }
            }
        }
    }
    let normals = |(piece, place_of): (&Geometry, &Vec<usize>)| match wanted(piece) {
        true => place_of.iter().map(|&place| sums[place].normalize_or(Vec3::Y)).collect(),
        false => Vec::new(),
    };
    pieces.iter().zip(&place_of).map(normals).collect()
}
