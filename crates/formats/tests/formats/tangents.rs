//! Tangents agree with another implementation of MikkTSpace, corner by corner.

use gaitway_character::mesh::{Geometry, corner_tangents};
use glam::{Vec2, Vec3, Vec4};

use crate::data_folder::data_folder;
use crate::file_set::file_set;

struct Reference<'a> {
    geometry: &'a Geometry,
    tangents: Vec<Option<Vec4>>,
}

impl Reference<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.geometry.indices[3 * face + corner] as usize
    }
}

impl bevy_mikktspace::Geometry for Reference<'_> {
    fn num_faces(&self) -> usize {
        self.geometry.indices.len() / 3
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.geometry.positions[self.vertex(face, corner)].into()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.geometry.normals[self.vertex(face, corner)].into()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.geometry.uvs[0][self.vertex(face, corner)].into()
    }

    fn set_tangent(&mut self, tangent: Option<bevy_mikktspace::TangentSpace>, face: usize, corner: usize) {
        // V points up in MikkTSpace, down in glTF.
        let as_gltf = |[x, y, z, sign]: [f32; 4]| Vec4::new(x, y, z, -sign);
        self.tangents[3 * face + corner] = tangent.map(|tangent| as_gltf(tangent.tangent_encoded()));
    }
}

fn compare(name: &str, geometry: &Geometry) {
    let mut reference = Reference { geometry, tangents: vec![None; geometry.indices.len()] };
    bevy_mikktspace::generate_tangents(&mut reference).expect("triangles");
    let ours = corner_tangents(geometry, 0);
    let (mut compared, mut off) = (0, 0);
    for (ours, other) in ours.iter().zip(&reference.tangents) {
        let Some(other) = other.filter(|tangent| tangent.truncate().length() > 0.5) else { continue };
        compared += 1;
        off += usize::from(ours.distance(other) > 1e-3);
    }
    assert!(compared > geometry.indices.len() / 2, "{name}: only {compared} of {} compared", geometry.indices.len());
    assert_eq!(off, 0, "{name}: corners that differ, of {compared}");
}

/// A wavy sheet, its texture mirrored along the middle, with seams and with faces degenerate in UV or in space.
fn sheet() -> Geometry {
    const EDGE: u32 = 24;
    let mut geometry = Geometry::default();
    for y in 0..=EDGE {
        for x in 0..=EDGE {
            let (fx, fy) = (x as f32, y as f32);
            geometry.positions.push(Vec3::new(fx, (0.7 * fx).sin() + (0.5 * fy).cos(), fy));
            geometry.normals.push(Vec3::new(-0.7 * (0.7 * fx).cos(), 1.0, 0.5 * (0.5 * fy).sin()).normalize());
            let u = if x < EDGE / 2 { fx } else { (EDGE - x) as f32 };
            let uv = Vec2::new(0.1 * u, 0.13 * fy + 0.02 * fx);
            geometry.uvs[0].push(if (5..8).contains(&x) && (5..8).contains(&y) { Vec2::ONE } else { uv });
        }
    }
    for y in 0..EDGE {
        for x in 0..EDGE {
            let [a, b] = [y * (EDGE + 1) + x, (y + 1) * (EDGE + 1) + x];
            geometry.indices.extend([a, b, a + 1, a + 1, b, b + 1]);
        }
    }
    geometry.indices.extend([3, 3, 4, 30, 40, 30]);
    geometry
}

#[test]
fn a_sheet_with_seams_agrees() {
    compare("sheet", &sheet());
}

#[test]
fn copies_of_a_vertex_count_as_one() {
    let shared = sheet();
    let mut split = Geometry::default();
    for (at, &vertex) in shared.indices.iter().enumerate() {
        let vertex = vertex as usize;
        split.positions.push(shared.positions[vertex]);
        split.normals.push(shared.normals[vertex]);
        split.uvs[0].push(shared.uvs[0][vertex]);
        split.indices.push(at as u32);
    }
    assert_eq!(corner_tangents(&split, 0), corner_tangents(&shared, 0));
}

#[test]
fn real_models_agree() {
    let Some(folder) = data_folder() else { return };
    for name in ["threejs/Soldier.glb", "kaykit/Knight.glb", "threejs/Xbot.glb"] {
        let asset = gaitway_formats::load(&file_set(&folder.join(name))).expect("a file that is known to be fine");
        for (at, geometry) in asset.meshes.iter().flat_map(|mesh| &mesh.primitives).enumerate() {
            if !geometry.normals.is_empty() && !geometry.uvs[0].is_empty() {
                compare(&format!("{name}, primitive {at}"), geometry);
            }
        }
    }
}
