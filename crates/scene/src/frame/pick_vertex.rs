//! Picks the vertex under a point of the viewport: the nearest corner of the frontmost triangle.

use gaitway_character::mesh::{DeformedVertices, Topology, deform};
use glam::{Vec2, Vec3};

use super::{Character, Frame};
use crate::library::Model;
use crate::state::VertexChoice;

/// Hidden meshes are passed through. `point` has x and y from −1 (left, bottom) to 1. Skins the whole character on the CPU
/// into `scratch` and tests every triangle, so call it when the pointer has moved, not every frame.
pub fn pick_vertex(
    model: &Model,
    frame: &Frame,
    character: &Character,
    point: Vec2,
    scratch: &mut DeformedVertices,
) -> Option<VertexChoice> {
    let world_from_projection = (frame.view.projection_from_view * frame.view.view_from_world).inverse();
    let [near, far] = [0.0, 1.0].map(|depth| world_from_projection.project_point3(point.extend(depth)));
    let along = (far - near).try_normalize()?;
    let mut nearest: Option<(f32, VertexChoice)> = None;
    for draw in character.draws.iter().filter(|draw| draw.visible) {
        let (palette, weights) = (character.palette_of(draw), character.morph_weights_of(draw));
        for (primitive, geometry) in model.asset.meshes.get(draw.mesh)?.primitives.iter().enumerate() {
            let is_hidden = character.hidden_materials.contains(&geometry.material_in(character.variant));
            if is_hidden || geometry.topology != Topology::Triangles || palette.is_empty() {
                continue;
            }
            deform(geometry, weights, palette, character.skinning, scratch);
            for &triangle in geometry.indices.as_chunks::<3>().0 {
                let corners = triangle.map(|index| scratch.positions[index as usize]);
                let hit = hit(near, along, corners).filter(|&at| nearest.is_none_or(|(best, _)| at < best));
                let Some(distance) = hit else { continue };
                let vertex = triangle[nearest_corner(corners, near + distance * along)] as usize;
                nearest = Some((distance, VertexChoice { instance: draw.instance, primitive, vertex }));
            }
        }
    }
    nearest.map(|(_, choice)| choice)
}

fn nearest_corner(corners: [Vec3; 3], to: Vec3) -> usize {
    match corners.map(|corner| corner.distance_squared(to)) {
        [a, b, c] if a <= b && a <= c => 0,
        [_, b, c] if b <= c => 1,
        _ => 2,
    }
}

/// Returns the distance along a ray to a triangle, hit from either side (Möller and Trumbore 1997).
fn hit(from: Vec3, along: Vec3, [a, b, c]: [Vec3; 3]) -> Option<f32> {
    let (ab, ac) = (b - a, c - a);
    let p = along.cross(ac);
    let determinant = ab.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let to = from - a;
    let u = to.dot(p) / determinant;
    let q = to.cross(ab);
    let v = along.dot(q) / determinant;
    let distance = ac.dot(q) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
}
