//! Material lobes: white ones disappear in white light, and glass shows what is behind it.

use std::sync::Arc;

use gaitway_character::asset::{LightKind, Panorama};
use gaitway_character::mesh::{Lobes, Material};
use gaitway_render::RendererOptions;
use gaitway_scene::frame::FrameLight;
use gaitway_scene::state::{Background, LightSetup, ToneMap};
use glam::{Vec2, Vec3, Vec4};

use crate::device::{Gpu, gl, gpu};
use crate::environment::{WHITE, check_shade, drawn_pixels, sphere};
use crate::scene::{Scene, near, square, unlit};

fn dielectric(lobes: Lobes) -> Material {
    Material { metallic: 0.0, lobes: Some(Box::new(lobes)), ..Default::default() }
}

/// White lobes that absorb nothing, whatever their roughness.
fn white_lobes() -> Vec<Lobes> {
    let plain = Lobes::default;
    vec![
        Lobes { ior: 1.8, ..plain() },
        Lobes { specular: 0.3, specular_color: Vec3::new(1.0, 2.0, 30.0), ..plain() },
        Lobes { ior: 0.0, ..plain() },
        Lobes { clearcoat: 1.0, ..plain() },
        Lobes { clearcoat: 0.7, clearcoat_roughness: 0.6, ..plain() },
        Lobes { sheen_color: Vec3::ONE, sheen_roughness: 0.2, ..plain() },
        Lobes { sheen_color: Vec3::ONE, sheen_roughness: 1.0, clearcoat: 1.0, ..plain() },
        Lobes { diffuse_transmission: 0.6, ..plain() },
        Lobes { transmission: 1.0, ..plain() },
        Lobes { transmission: 1.0, thickness: 0.2, dispersion: 4.0, diffuse_transmission: 0.5, ..plain() },
    ]
}

fn check_furnace(gpu: &Gpu) {
    for lobes in white_lobes() {
        let (roughness, tone_map, white) = match lobes.transmission > 0.0 {
            true => (0.1, ToneMap::None, 255),
            false => (0.6, ToneMap::Neutral, WHITE),
        };
        let material = Material { roughness, ..dielectric(lobes) };
        let mut scene = Scene::new(vec![sphere(Vec2::ZERO, 0.8, 0)], vec![material]);
        scene.frame.look.light = LightSetup::White;
        scene.frame.look.background = Background::Environment;
        scene.frame.look.tone_map = tone_map;
        check_shade(&scene.draw(gpu), white, &format!("{lobes:?}"));
    }
}

#[test]
fn white_lobes_disappear_in_white_light() {
    let Some(gpu) = gpu() else { return };
    check_furnace(&gpu);
}

#[test]
fn white_lobes_disappear_in_white_light_with_opengl() {
    let Some(gpu) = gl() else { return };
    check_furnace(&gpu);
    check_glass(&gpu);
}

#[test]
fn thin_films_and_anisotropic_highlights_add_no_light() {
    let Some(gpu) = gpu() else { return };
    for metallic in [0.0, 1.0] {
        for lobes in [
            Lobes { iridescence: 1.0, ..Default::default() },
            Lobes { iridescence: 1.0, iridescence_ior: 1.8, iridescence_thickness_max: 650.0, ..Default::default() },
            Lobes { anisotropy: 0.8, anisotropy_rotation: 0.5, ..Default::default() },
        ] {
            let mut geometry = sphere(Vec2::ZERO, 0.8, 0);
            geometry.uvs[0] =
                geometry.normals.iter().map(|normal| Vec2::new(normal.x.atan2(normal.z), normal.y)).collect();
            let mut scene =
                Scene::new(vec![geometry], vec![Material { metallic, roughness: 0.3, ..dielectric(lobes) }]);
            scene.frame.look.light = LightSetup::White;
            let drawn = drawn_pixels(&scene.draw(&gpu));
            assert!(drawn.len() > 300);
            for pixel in drawn {
                assert!(pixel[..3].iter().all(|&channel| channel <= WHITE + 1), "{pixel:?}, {metallic}, {lobes:?}");
            }
        }
    }
}

#[test]
fn lobes_that_are_off_change_nothing() {
    let Some(gpu) = gpu() else { return };
    let drawn = |material| Scene::new(vec![sphere(Vec2::ZERO, 0.9, 0)], vec![material]).draw(&gpu).0;
    let gray =
        Material { base_color: Vec4::new(0.4, 0.3, 0.2, 1.0), metallic: 0.3, roughness: 0.4, ..Default::default() };
    let plain = drawn(gray.clone());
    let off = Lobes { clearcoat_roughness: 0.5, sheen_roughness: 0.5, thickness: 1.0, ..Default::default() };
    assert!(plain == drawn(Material { lobes: Some(Box::new(off)), ..gray.clone() }));
    let coated = Lobes { clearcoat: 1.0, ..Default::default() };
    assert!(plain != drawn(Material { lobes: Some(Box::new(coated)), ..gray }));
}

/// A pane that is smaller than the picture, with a red square behind its left half.
fn behind(pane: Material) -> Scene {
    let (mut front, mut back) = (square(0), square(1));
    front.positions.iter_mut().for_each(|position| *position = Vec3::new(1.6 * position.x, 1.6 * position.y, 0.5));
    back.positions
        .iter_mut()
        .for_each(|position| *position = Vec3::new(0.5 * position.x - 0.25, 2.0 * position.y, -0.5));
    let mut scene = Scene::new(vec![front, back], vec![pane, unlit(Vec4::new(1.0, 0.0, 0.0, 1.0))]);
    scene.frame.look.background = Background::Color([0, 0, 255]);
    scene
}

fn check_glass(gpu: &Gpu) {
    let clear = || Lobes { transmission: 1.0, specular: 0.0, ..Default::default() };
    for samples in [1, 4] {
        let others = [ToneMap::Aces, ToneMap::Agx, ToneMap::None].into_iter().filter(|_| samples == 1);
        for tone_map in [ToneMap::Neutral].into_iter().chain(others) {
            let shown = |material: Material| {
                let mut scene = behind(material);
                scene.frame.look.tone_map = tone_map;
                scene.draw_with(gpu, RendererOptions { samples })
            };
            // Without reflections, smooth glass shows exactly what is behind it.
            let glass = shown(Material { roughness: 0.0, ..dielectric(clear()) });
            near(glass.at(-0.25, 0.1), [255, 0, 0, 255], 6);
            near(glass.at(0.3, 0.1), [0, 0, 255, 255], 6);
            assert_eq!(glass.at(0.3, 0.1), glass.at(0.3, -0.3));
        }
        let shown = |lobes, roughness| {
            behind(Material { roughness, ..dielectric(lobes) }).draw_with(gpu, RendererOptions { samples })
        };
        // Rough glass blurs it.
        let frosted = shown(clear(), 0.5).at(0.05, 0.1);
        assert!(frosted[0] > 40 && frosted[2] > 40, "{frosted:?}");
        // The volume absorbs nearly everything but blue.
        let attenuation_color = Vec3::new(0.01, 0.01, 1.0);
        let volume = Lobes { thickness: 1.0, attenuation_distance: 0.5, attenuation_color, ..clear() };
        let absorbed = shown(volume, 0.0);
        assert!(absorbed.at(-0.25, 0.1)[0] < 40 && absorbed.at(0.3, 0.1)[2] > 220);
    }
}

#[test]
fn glass_shows_what_is_behind_it() {
    let Some(gpu) = gpu() else { return };
    check_glass(&gpu);
}

#[test]
fn glass_over_nothing_stays_transparent() {
    let Some(gpu) = gpu() else { return };
    let mut scene = behind(Material {
        roughness: 0.0,
        ..dielectric(Lobes { transmission: 1.0, specular: 0.0, ..Default::default() })
    });
    scene.frame.look.background = Background::Transparent;
    let picture = scene.draw(&gpu);
    assert_eq!((picture.at(0.3, 0.1)[3], picture.at(-0.25, 0.1)[3]), (0, 255));
}

#[test]
fn thin_cloth_is_lit_from_behind() {
    let Some(gpu) = gpu() else { return };
    let shown = |diffuse_transmission| {
        let lobes = Lobes { diffuse_transmission, diffuse_transmission_color: Vec3::X, ..Default::default() };
        let mut scene = Scene::new(vec![square(0)], vec![dielectric(lobes)]);
        // The light shines towards the viewer.
        scene.frame.lights = vec![FrameLight {
            kind: LightKind::Directional,
            color: Vec3::splat(3.0),
            position: Vec3::ZERO,
            direction: Vec3::Z,
            range: 0.0,
        }];
        scene.frame.panorama = Some(Arc::new(Panorama::new(2, 1, vec![Vec3::ZERO; 2]).unwrap()));
        scene.draw(&gpu).at(0.1, 0.1)
    };
    assert_eq!(shown(0.0)[..3], [0, 0, 0]);
    let lit = shown(0.8);
    assert!(lit[0] > 150 && lit[1] < 60, "{lit:?}");
}
