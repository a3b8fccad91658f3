//! Pictures drawn with one sample per pixel are refined to four; lines have no gaps.

use gaitway_character::mesh::{Geometry, Lobes, Material, Topology, palette_entry};
use gaitway_render::{Renderer, RendererOptions, read_pixels};
use gaitway_scene::state::Background;
use glam::{Affine3A, Quat, Vec2, Vec3, Vec4};

use crate::device::{Gpu, gl, gpu};
use crate::scene::{Picture, SIZE, Scene, square, unlit};

/// A white square, turned so that its edges cross pixels.
fn turned() -> Scene {
    let mut scene = Scene::new(vec![square(0)], vec![unlit(Vec4::ONE)]);
    let turn = Affine3A::from_rotation_z(0.3);
    scene.frame.characters[0].palette = vec![palette_entry(&turn, Default::default())];
    scene
}

/// The same through clear glass, which refracts a copy of the picture so far.
fn behind_glass() -> Scene {
    let (mut front, mut back) = (square(0), square(1));
    front.positions.iter_mut().for_each(|position| position.z = 0.5);
    let turn = Quat::from_rotation_z(0.3);
    back.positions.iter_mut().for_each(|position| *position = turn * (0.7 * *position));
    let lobes = Lobes { transmission: 1.0, specular: 0.0, ..Default::default() };
    let glass = Material { metallic: 0.0, roughness: 0.0, lobes: Some(Box::new(lobes)), ..Default::default() };
    Scene::new(vec![front, back], vec![glass, unlit(Vec4::ONE)])
}

fn pixels(gpu: &Gpu, renderer: &Renderer) -> Vec<u8> {
    pollster::block_on(read_pixels(&gpu.device, &gpu.queue, renderer.output()))
}

fn mean_difference(a: &[u8], b: &[u8]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / a.len() as f64
}

/// Pixels of the reference per pixel of the picture, along each axis.
const FINE: usize = 8;

/// Averages squares of `FINE` by `FINE` pixels.
fn averaged(fine: &[u8]) -> Vec<u8> {
    let size = SIZE as usize;
    let byte = |x: usize, y: usize, channel: usize| u32::from(fine[4 * (y * size * FINE + x) + channel]);
    let mean = |at: usize| {
        let (channel, x, y) = (at % 4, at / 4 % size, at / 4 / size);
        let square = (0..FINE * FINE).map(|part| byte(x * FINE + part % FINE, y * FINE + part / FINE, channel));
        (square.sum::<u32>() / (FINE * FINE) as u32) as u8
    };
    (0..4 * size * size).map(mean).collect()
}

#[test]
fn a_refined_picture_has_four_samples_per_pixel() {
    let Some(gpu) = gpu() else { return };
    let Gpu { device, queue } = &gpu;
    for (panes, mut scene) in
        [([1, 1], turned()), ([2, 1], turned()), ([1, 1], behind_glass()), ([2, 1], behind_glass())]
    {
        (scene.frame.panes, scene.frame.look.background) = (panes, Background::Color([40, 80, 120]));
        let draw = |samples: u32, is_refined: bool, size: u32| {
            let mut renderer = Renderer::new(device, queue, RendererOptions { samples });
            renderer.upload(device, queue, &scene.model).unwrap();
            renderer.draw(device, queue, &scene.frame, [size; 2]);
            while is_refined && renderer.refine(device, queue, &scene.frame) {}
            pixels(&gpu, &renderer)
        };
        let reference = averaged(&draw(1, false, SIZE * FINE as u32));
        let error = |samples, is_refined| mean_difference(&draw(samples, is_refined, SIZE), &reference);
        let (coarse, refined, multisampled) = (error(1, false), error(1, true), error(4, false));
        assert!(refined < 0.5 * coarse, "{panes:?}: {coarse}, refined {refined}, multisampled {multisampled}");
        assert_eq!(draw(4, true, SIZE), draw(4, false, SIZE), "nothing is left to refine");
    }
}

#[test]
fn refining_ends_and_starts_again_with_the_next_picture() {
    let Some(gpu) = gpu() else { return };
    let Gpu { device, queue } = &gpu;
    let scene = turned();
    let mut renderer = Renderer::new(device, queue, RendererOptions { samples: 1 });
    renderer.upload(device, queue, &scene.model).unwrap();
    assert!(!renderer.refine(device, queue, &scene.frame), "nothing was drawn");
    renderer.draw(device, queue, &scene.frame, [SIZE, SIZE]);
    let (coarse, stats) = (pixels(&gpu, &renderer), renderer.stats());
    let left: Vec<bool> = (0..5).map(|_| renderer.refine(device, queue, &scene.frame)).collect();
    assert_eq!(left, [true, true, false, false, false]);
    let refined = pixels(&gpu, &renderer);
    assert_ne!(refined, coarse);
    assert_eq!(renderer.stats(), stats, "samples don't count as pictures");
    renderer.draw(device, queue, &scene.frame, [SIZE, SIZE]);
    assert_eq!(pixels(&gpu, &renderer), coarse);
    // Resizing starts a new picture.
    renderer.draw_refined(device, queue, &scene.frame, [SIZE / 2, SIZE]);
    renderer.draw_refined(device, queue, &scene.frame, [SIZE, SIZE]);
    assert_eq!(pixels(&gpu, &renderer), refined);
    renderer.give_output_away(device);
    assert!(!renderer.refine(device, queue, &scene.frame), "the output belongs to someone else");
}

/// Lines from the centre in 17 directions, one pixel wide on every device: whatever their slope, every step along them
/// is covered, with one sample per pixel, with several, and refined.
#[test]
fn lines_have_no_gaps() {
    let (Some(vulkan), gl) = (gpu(), gl()) else { return };
    let end = |index: u32| Vec2::from_angle(index as f32 * 0.37) * 0.9;
    for gpu in [Some(vulkan), gl].into_iter().flatten() {
        let Gpu { device, queue } = &gpu;
        for (samples, is_refined) in [(1, false), (1, true), (4, false)] {
            for index in 0..17 {
                let geometry = Geometry {
                    topology: Topology::Lines,
                    positions: vec![Vec3::ZERO, 0.5 * end(index).extend(0.0), end(index).extend(0.0)],
                    indices: vec![0, 1, 1, 2],
                    material: Some(0),
                    file_vertices: 3,
                    ..Geometry::default()
                };
                let scene = Scene::new(vec![geometry], vec![unlit(Vec4::ONE)]);
                let mut renderer = Renderer::new(device, queue, RendererOptions { samples });
                renderer.upload(device, queue, &scene.model).unwrap();
                renderer.draw(device, queue, &scene.frame, [SIZE, SIZE]);
                while is_refined && renderer.refine(device, queue, &scene.frame) {}
                let picture = Picture(pixels(&gpu, &renderer));
                // The last steps are left out: the pixel where a line ends is drawn only if the line leaves it.
                for step in 1..36 {
                    let at = end(index) * (step as f32 / 41.0);
                    let pixel = 2.0 / SIZE as f32;
                    let near = [(0.0, 0.0), (pixel, 0.0), (-pixel, 0.0), (0.0, pixel), (0.0, -pixel)];
                    let covered = near.map(|(x, y)| u32::from(picture.at(at.x + x, at.y + y)[3])).iter().sum::<u32>();
                    assert!(covered >= 128, "{samples}, {is_refined}: line {index} at {at}: {covered}");
                }
            }
        }
    }
}
