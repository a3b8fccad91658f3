//! Environment lighting, and how surfaces respond to it.

use std::sync::Arc;

use gaitway_character::asset::Panorama;
use gaitway_character::mesh::{Geometry, Material};
use gaitway_scene::state::{Background, KeyLight, LightSetup, ToneMap};
use glam::{Vec2, Vec3, Vec4};

use crate::device::{Gpu, gl, gpu};
use crate::scene::{Picture, Scene};

/// White, tone-mapped by Khronos Neutral: 0.96 is compressed to 0.869, which sRGB encodes as 240.
pub const WHITE: u8 = 240;

/// A sphere at a point of the picture.
pub fn sphere(center: Vec2, radius: f32, material: usize) -> Geometry {
    const RINGS: u32 = 16;
    const AROUND: u32 = 32;
    let mut geometry = Geometry { material: Some(material), ..Default::default() };
    for ring in 0..=RINGS {
        for step in 0..=AROUND {
            let (sin, cos) = (ring as f32 / RINGS as f32 * std::f32::consts::PI).sin_cos();
            let (turn_sin, turn_cos) = (step as f32 / AROUND as f32 * std::f32::consts::TAU).sin_cos();
            let normal = Vec3::new(sin * turn_sin, cos, sin * turn_cos);
            geometry.normals.push(normal);
            geometry.positions.push(center.extend(0.0) + radius * normal);
            if ring < RINGS && step < AROUND {
                let [a, b] = [ring, ring + 1].map(|ring| ring * (AROUND + 1) + step);
                geometry.indices.extend([a, b, a + 1, a + 1, b, b + 1]);
            }
        }
    }
    geometry.file_vertices = geometry.positions.len();
    geometry
}

const ROUGHNESS: [f32; 5] = [0.0, 0.1, 0.3, 0.6, 1.0];
const METALLIC: [f32; 3] = [0.0, 0.5, 1.0];

/// Spheres in columns of equal roughness and rows of equal metalness.
fn spheres(base_color: Vec3) -> Scene {
    let (mut geometries, mut materials) = (Vec::new(), Vec::new());
    for (row, metallic) in METALLIC.into_iter().enumerate() {
        for (column, roughness) in ROUGHNESS.into_iter().enumerate() {
            let center = Vec2::new(0.4 * column as f32 - 0.8, 0.6 * row as f32 - 0.6);
            geometries.push(sphere(center, 0.18, materials.len()));
            materials.push(Material { base_color: base_color.extend(1.0), roughness, metallic, ..Default::default() });
        }
    }
    Scene::new(geometries, materials)
}

pub fn drawn_pixels(picture: &Picture) -> Vec<[u8; 4]> {
    picture.0.as_chunks::<4>().0.iter().copied().filter(|pixel| pixel[3] > 0).collect()
}

/// Checks that everything drawn has this shade of grey.
pub fn check_shade(picture: &Picture, shade: u8, what: &str) {
    let drawn = drawn_pixels(picture);
    assert!(drawn.len() > 300, "{}, {what}", drawn.len());
    for pixel in drawn {
        assert!(pixel[..3].iter().all(|channel| channel.abs_diff(shade) <= 2), "{pixel:?}, {what}");
    }
}

fn check_furnace(gpu: &Gpu) {
    let mut scene = spheres(Vec3::ONE);
    scene.frame.look.light = LightSetup::White;
    check_shade(&scene.draw(gpu), WHITE, "white light");
}

/// The white furnace: no white surface absorbs or adds light, whatever its roughness, metal or dielectric.
#[test]
fn white_surfaces_disappear_in_white_light() {
    let Some(gpu) = gpu() else { return };
    check_furnace(&gpu);
}

#[test]
fn white_surfaces_disappear_in_white_light_with_opengl() {
    let Some(gpu) = gl() else { return };
    check_furnace(&gpu);
    check_panorama(&gpu);
}

/// A panorama of one colour on each side: red at −X, green at −Z, blue at +X, white at +Z.
fn four_sides() -> Panorama {
    // The image begins at −X; its middle is +X.
    let color = |column: usize| [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE][(column + 4) % 32 / 8];
    let pixels = (0..32 * 16).map(|at| color(at % 32)).collect();
    Panorama::new(32, 16, pixels).unwrap()
}

fn check_panorama(gpu: &Gpu) {
    // A panorama that is white all around is the white furnace.
    let mut scene = spheres(Vec3::ONE);
    scene.frame.panorama = Some(Arc::new(Panorama::new(2, 1, vec![Vec3::ONE; 2]).unwrap()));
    check_shade(&scene.draw(gpu), WHITE, "white panorama");
    // The camera looks along −Z; mirrors and matte surfaces see what is behind it.
    scene.frame.panorama = Some(Arc::new(four_sides()));
    let red_green_blue = |pixel: [u8; 4]| [0, 1, 2].map(|channel| pixel[channel] > 160);
    for (turn, behind, ahead) in
        [(0.0, [true; 3], [false, true, false]), (0.5, [true, false, false], [false, false, true])]
    {
        scene.frame.look.environment_radians = turn * std::f32::consts::PI;
        for background in [Background::Environment, Background::Blurred] {
            scene.frame.look.background = background;
            let picture = scene.draw(gpu);
            assert_eq!(red_green_blue(picture.at(0.0, 0.95)), ahead, "{background:?}, turned by {turn}");
            let mirror = picture.at(-0.8, 0.6);
            assert_eq!(red_green_blue(mirror), behind, "turned by {turn}: {mirror:?}");
        }
    }
}

#[test]
fn a_panorama_lights_the_scene_and_shows_behind_it() {
    let Some(gpu) = gpu() else { return };
    check_panorama(&gpu);
}

#[test]
fn every_setup_shows_the_model_without_blowing_it_out() {
    let Some(gpu) = gpu() else { return };
    let mut brightness = Vec::new();
    for setup in [LightSetup::Studio, LightSetup::Soft, LightSetup::Hard, LightSetup::Outdoor] {
        let material = Material { base_color: Vec4::new(0.5, 0.5, 0.5, 1.0), metallic: 0.0, ..Default::default() };
        let mut scene = Scene::new(vec![sphere(Vec2::ZERO, 0.9, 0)], vec![material]);
        scene.frame.look.light = setup;
        let drawn = drawn_pixels(&scene.draw(&gpu));
        let mean = drawn.iter().map(|pixel| u32::from(pixel[1])).sum::<u32>() / drawn.len() as u32;
        let brightest = drawn.iter().map(|pixel| pixel[1]).max().unwrap();
        assert!((70..210).contains(&mean) && brightest < 252, "{setup:?}: mean {mean}, at most {brightest}");
        brightness.push((mean, brightest));
    }
    brightness.sort_unstable();
    brightness.dedup();
    assert_eq!(brightness.len(), 4, "each lights it in its own way: {brightness:?}");
}

/// Tone mapping flattens shading near white. With three quarters of a stop more, half of a white model would be flat.
#[test]
fn a_white_model_keeps_its_shading_in_the_studio() {
    let Some(gpu) = gpu() else { return };
    let near_white = |exposure: f32| {
        let material = Material { metallic: 0.0, ..Default::default() };
        let mut scene = Scene::new(vec![sphere(Vec2::ZERO, 0.9, 0)], vec![material]);
        scene.frame.look.exposure = exposure;
        let drawn = drawn_pixels(&scene.draw(&gpu));
        drawn.iter().filter(|pixel| pixel[1] > 242).count() as f32 / drawn.len() as f32
    };
    let [now, brighter] = [1.0, 1.0 / 0.6].map(near_white);
    assert!(now < 0.25 && brighter > 0.4, "{now} and {brighter} of the sphere");
}

#[test]
fn a_custom_key_light_replaces_the_environments_own() {
    let Some(gpu) = gpu() else { return };
    let shown = |strength: f32, yaw_degrees: f32| {
        let material = Material { base_color: Vec4::new(0.4, 0.4, 0.4, 1.0), metallic: 0.0, ..Default::default() };
        let mut scene = Scene::new(vec![sphere(Vec2::ZERO, 0.9, 0)], vec![material]);
        scene.frame.look.light = LightSetup::Soft;
        scene.frame.look.tone_map = ToneMap::None;
        scene.frame.look.key = Some(KeyLight { strength, yaw_degrees, pitch_degrees: 0.0 });
        let picture = scene.draw(&gpu);
        [picture.at(-0.6, 0.0)[1], picture.at(0.6, 0.0)[1]]
    };
    let [off, left, right] = [shown(0.0, 0.0), shown(1.0, -90.0), shown(1.0, 90.0)];
    assert!(left[0] > off[0] + 20 && left[1] == off[1], "{left:?} {off:?}");
    assert!(right[1] > off[1] + 20 && right[0] == off[0], "{right:?} {off:?}");
}

#[test]
fn dark_surfaces_stay_darker_than_white_light() {
    let Some(gpu) = gpu() else { return };
    let mut scene = spheres(Vec3::splat(0.2));
    scene.frame.look.light = LightSetup::White;
    let drawn = drawn_pixels(&scene.draw(&gpu));
    assert!(drawn.iter().all(|pixel| pixel[1] <= WHITE + 1), "{drawn:?}");
    // Metal of this colour, seen from the front: 0.2 − 0.04 encoded.
    let metal = scene.draw(&gpu).at(-0.8, 0.6);
    assert!(metal[1].abs_diff(111) <= 3, "{metal:?}");
}

#[test]
fn a_mirror_is_sharp_and_a_rough_surface_is_not() {
    let Some(gpu) = gpu() else { return };
    let steepest = |roughness: f32| {
        let material = Material { roughness, ..Default::default() };
        let mut scene = Scene::new(vec![sphere(Vec2::ZERO, 0.95, 0)], vec![material]);
        // Without the key light, whose highlight is as sharp.
        scene.frame.lights = vec![gaitway_scene::frame::FrameLight {
            kind: gaitway_character::asset::LightKind::Directional,
            color: Vec3::ZERO,
            position: Vec3::ZERO,
            direction: Vec3::NEG_Y,
            range: 0.0,
        }];
        let picture = scene.draw(&gpu);
        let rows = picture.0.as_chunks::<4>().0.chunks_exact(crate::scene::SIZE as usize);
        let steps = rows.flat_map(|row| row.windows(2)).filter(|pair| pair.iter().all(|pixel| pixel[3] > 0));
        steps.map(|pair| pair[0][1].abs_diff(pair[1][1])).max().unwrap()
    };
    let [mirror, satin, rough] = [0.0, 0.3, 1.0].map(steepest);
    assert!(mirror > 90 && mirror > satin + 20 && satin > rough, "{mirror} {satin} {rough}");
}
