//! Which vertex of the model lies under a point of the picture: of the nearest triangle there, the nearest corner.

use glam::{Vec2, Vec3};

use super::{Character, Frame};
use crate::library::Model;
use crate::mesh::{DeformedVertices, Topology, deform};
use crate::state::VertexChoice;

/// `point`: x and y from −1 (left, bottom) to 1. All of the character's triangles are looked at, bent by the CPU into
/// `scratch`: for a pointer that has moved, not for every frame.
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
    for draw in &character.draws {
        let palette = character.palette.get(draw.palette.start as usize..draw.palette.end as usize)?;
        let weights =
            character.morph_weights.get(draw.morph_weights.start as usize..draw.morph_weights.end as usize)?;
        for (primitive, geometry) in model.asset.meshes.get(draw.mesh)?.primitives.iter().enumerate() {
            if geometry.topology != Topology::Triangles || palette.is_empty() {
                continue;
            }
            deform(geometry, weights, palette, character.skinning, scratch);
            for &triangle in geometry.indices.as_chunks::<3>().0 {
                let corners = triangle.map(|index| scratch.positions[index as usize]);
                let Some(distance) = hit(near, along, corners) else { continue };
                if nearest.is_none_or(|(best, _)| distance < best) {
                    let at = near + distance * along;
                    let [a, b, c] = corners.map(|corner| corner.distance_squared(at));
                    let corner = if a <= b && a <= c { 0 } else { if b <= c { 1 } else { 2 } };
                    let vertex = triangle[corner] as usize;
                    nearest = Some((distance, VertexChoice { instance: draw.instance, primitive, vertex }));
                }
            }
        }
    }
    nearest.map(|(_, choice)| choice)
}

/// How far along a line it meets a triangle, from whichever side (Möller and Trumbore 1997).
fn hit(from: Vec3, along: Vec3, [a, b, c]: [Vec3; 3]) -> Option<f32> {
    let (ab, ac) = (b - a, c - a);
    let across = along.cross(ac);
    let determinant = ab.dot(across);
    if determinant == 0.0 {
        return None;
    }
    let to = from - a;
    let u = to.dot(across) / determinant;
    let turned = to.cross(ab);
    let v = along.dot(turned) / determinant;
    let distance = ac.dot(turned) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
}
