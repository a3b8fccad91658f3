//! The lights of a file (KHR_lights_punctual): what they illuminate and what they do not.

use gaitway_character::asset::LightKind;
use gaitway_character::mesh::Material;
use gaitway_scene::frame::FrameLight;
use glam::{Vec3, Vec4};

use crate::device::{Gpu, gpu};
use crate::scene::{Picture, Scene, square};

/// In front of the left half of the square.
const LEFT: Vec3 = Vec3::new(-0.3, 0.0, 0.3);

fn light(kind: LightKind) -> FrameLight {
    FrameLight { kind, color: Vec3::ONE, position: LEFT, direction: Vec3::NEG_Z, range: 0.0 }
}

/// A matte square in the studio with these lights instead of the key light.
fn lit(gpu: &Gpu, lights: &[FrameLight]) -> Picture {
    let material =
        Material { base_color: Vec4::new(0.3, 0.3, 0.3, 1.0), metallic: 0.0, roughness: 1.0, ..Default::default() };
    let mut scene = Scene::new(vec![square(0)], vec![material]);
    scene.frame.lights = lights.to_vec();
    scene.draw(gpu)
}

fn dark(gpu: &Gpu) -> Picture {
    lit(gpu, &[FrameLight { color: Vec3::ZERO, ..light(LightKind::Directional) }])
}

#[test]
fn a_directional_light_illuminates_front_faces_everywhere() {
    let Some(gpu) = gpu() else { return };
    let none = dark(&gpu);
    let front = lit(&gpu, &[light(LightKind::Directional)]);
    assert!(front.at(0.4, 0.4)[1] > none.at(0.4, 0.4)[1] + 20);
    let far_away = FrameLight { position: Vec3::splat(1e6), ..light(LightKind::Directional) };
    assert_eq!(lit(&gpu, &[far_away]).0, front.0, "its position does not matter");
    let behind = FrameLight { direction: Vec3::Z, ..light(LightKind::Directional) };
    assert_eq!(lit(&gpu, &[behind]).0, none.0);
}

#[test]
fn a_point_light_falls_off_and_ends_at_its_range() {
    let Some(gpu) = gpu() else { return };
    let none = dark(&gpu);
    let point = FrameLight { color: Vec3::splat(0.2), ..light(LightKind::Point) };
    let shown = lit(&gpu, &[point]);
    let [near, far] = [shown.at(-0.3, 0.0)[1], shown.at(0.4, 0.0)[1]];
    assert!(near > far + 20, "{near} near, {far} far");
    assert!(far > none.at(0.4, 0.0)[1], "the far side is lit as well");
    let reversed = FrameLight { direction: Vec3::Z, ..point };
    assert_eq!(lit(&gpu, &[reversed]).0, shown.0, "it has no direction");
    // The far side is at a distance of 0.76.
    let short = lit(&gpu, &[FrameLight { range: 0.6, ..point }]);
    assert_eq!(short.at(0.4, 0.0), none.at(0.4, 0.0));
    assert!(short.at(-0.3, 0.0)[1] > none.at(-0.3, 0.0)[1] + 20);
}

#[test]
fn a_spot_light_stays_inside_its_cone() {
    let Some(gpu) = gpu() else { return };
    let none = dark(&gpu);
    let kind = LightKind::Spot { inner_cone_radians: 0.3, outer_cone_radians: 0.6 };
    let spot = FrameLight { color: Vec3::splat(0.2), ..light(kind) };
    let shown = lit(&gpu, &[spot]);
    let point = lit(&gpu, &[FrameLight { kind: LightKind::Point, ..spot }]);
    assert_eq!(shown.at(-0.3, 0.0), point.at(-0.3, 0.0), "as bright as a point light within the inner cone");
    assert_eq!(shown.at(0.2, 0.0), none.at(0.2, 0.0), "nothing outside the outer cone");
    // Between the cones, 0.45 rad off the axis.
    let (x, y) = (-0.3 + 0.3 * 0.45_f32.tan(), 0.0);
    assert!(shown.at(x, y)[1] < point.at(x, y)[1] && shown.at(x, y)[1] > none.at(x, y)[1]);
}

#[test]
fn lights_add_up() {
    let Some(gpu) = gpu() else { return };
    let one = FrameLight { color: Vec3::splat(0.5), ..light(LightKind::Directional) };
    assert_eq!(lit(&gpu, &[one, one]).0, lit(&gpu, &[light(LightKind::Directional)]).0);
}
