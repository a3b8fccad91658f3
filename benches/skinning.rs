//! CPU skinning of positions and normals, per vertex: each mode with 4 and with 16 influences.

mod support;

use std::hint::black_box;

use gaitway_character::mesh::{
    DeformedVertices, Geometry, Influences, PaletteEntry, SkinningMode, deform, palette_entry,
};
use glam::{Affine3A, Quat, Vec3};
use support::measure;

const VERTICES: usize = 20_000;
const JOINTS: usize = 67;

fn main() {
    println!("{:40} {:>10} {:>10}", "", "ns/vertex", "(fastest)");
    for (name, mode) in [
        ("linear", SkinningMode::Linear),
        ("rigid", SkinningMode::Rigid),
        ("dual quaternion", SkinningMode::DualQuaternion),
    ] {
        let matrix = |at: usize| {
            let angle = at as f32 / JOINTS as f32;
            Affine3A::from_rotation_translation(Quat::from_rotation_x(angle), Vec3::Y * angle)
        };
        let palette: Vec<PaletteEntry> = (0..JOINTS).map(|at| palette_entry(&matrix(at), mode)).collect();
        for influences in [4, 16] {
            let geometry = geometry(influences);
            let mut out = DeformedVertices::default();
            let nanos = measure(|| deform(black_box(&geometry), &[], &palette, mode, &mut out));
            println!(
                "{:40} {:>10.1} {:>10.1}",
                format!("{name}, {influences} influences"),
                nanos.median / VERTICES as f64,
                nanos.fastest / VERTICES as f64
            );
        }
    }
}

/// Adjacent vertices follow adjacent joints, as on a character.
fn geometry(influences: usize) -> Geometry {
    let joint = |vertex: usize, at: usize| ((vertex * JOINTS / VERTICES + at) % JOINTS) as u16;
    let weight = |at: usize| 2.0 * (influences - at) as f32 / (influences * (influences + 1)) as f32;
    Geometry {
        positions: (0..VERTICES).map(|vertex| Vec3::new(vertex as f32, 1.0, 0.5)).collect(),
        normals: vec![Vec3::Y; VERTICES],
        influences: Influences {
            stride: influences,
            joints: (0..VERTICES).flat_map(|vertex| (0..influences).map(move |at| joint(vertex, at))).collect(),
            weights: (0..VERTICES).flat_map(|_| (0..influences).map(weight)).collect(),
        },
        ..Geometry::default()
    }
}
