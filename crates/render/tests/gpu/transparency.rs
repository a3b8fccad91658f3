//! Smooth edges of masks, layers of blended surfaces, and the shadow on the ground.

use gaitway_character::mesh::{
    AlphaMode, Bounds, Filter, Geometry, Material, MipFilter, Sampler, Texture, TextureRef, UvTransform, Wrap,
};
use gaitway_render::{Renderer, RendererOptions};
use gaitway_scene::library::ImageData;
use gaitway_scene::state::{Background, KeyLight};
use glam::camera::rh::proj::directx::orthographic;
use glam::camera::rh::view::look_at_mat4;
use glam::{Vec3, Vec4};

use crate::device::{Gpu, gl, gpu};
use crate::scene::{Picture, SIZE, Scene, near, square, unlit};

/// A square whose alpha falls from left to right; lines of equal alpha aren't aligned with pixels.
fn fading(alpha_mode: AlphaMode) -> Scene {
    const WIDTH: u32 = 16;
    let alpha = |x: u32, y: u32| (255.0 * (1.15 - (x as f32 + 0.3 * y as f32) / 16.0).clamp(0.0, 1.0)) as u8;
    let pixels = (0..WIDTH * WIDTH).flat_map(|at| [255, 255, 255, alpha(at % WIDTH, at / WIDTH)]).collect();
    let sampler = Sampler {
        mag: Filter::Linear,
        min: Filter::Linear,
        mip: MipFilter::None,
        wrap_u: Wrap::ClampToEdge,
        wrap_v: Wrap::ClampToEdge,
    };
    let map = TextureRef { texture: 0, uv_set: 0, uv_transform: UvTransform::IDENTITY };
    let material = Material { alpha_mode, base_color_texture: Some(map), ..unlit(Vec4::ONE) };
    let image = ImageData::Rgba8 { width: WIDTH, height: WIDTH, pixels };
    Scene::textured(vec![square(0)], vec![material], vec![Texture { image: Some(0), sampler }], vec![Some(image)])
}

/// Counts the pixels that are neither black nor white.
fn count_gray(picture: &Picture) -> usize {
    picture.0.as_chunks::<4>().0.iter().filter(|pixel| (20..235).contains(&pixel[0])).count()
}

#[test]
fn the_edges_of_masks_are_smooth() {
    for gpu in [gpu(), gl()].into_iter().flatten() {
        for background in [Background::Color([0, 0, 0]), Background::Transparent, Background::Studio] {
            check_edges(&gpu, background);
        }
    }
}

fn check_edges(gpu: &Gpu, background: Background) {
    let mut scene = fading(AlphaMode::Mask { cutoff: 0.5 });
    scene.frame.look.background = background;
    let [hard, smooth] = [1, 4].map(|samples| scene.draw_with(gpu, RendererOptions { samples }));
    near(smooth.at(-0.4, 0.0), [255; 4], 0);
    assert_eq!(smooth.at(-0.4, 0.0), hard.at(-0.4, 0.0), "{background:?}");
    assert_eq!(smooth.at(0.45, -0.3), hard.at(0.45, -0.3), "{background:?}");
    let opaque = |picture: &Picture| picture.0.as_chunks::<4>().0.iter().all(|pixel| pixel[3] == 255);
    match background {
        Background::Color(_) => {
            assert_eq!(count_gray(&hard), 0);
            assert!(count_gray(&smooth) >= 6, "{}", count_gray(&smooth));
            assert!(opaque(&smooth));
        }
        Background::Studio => assert!(opaque(&smooth) && opaque(&hard)),
        _ => assert_eq!(count_gray(&smooth), 0, "colours stay as they are"),
    }
}

/// Two squares in one primitive, the nearer one first, so that the file's order is wrong for blending.
fn layers(alpha: f32) -> Scene {
    let mut geometry = square(0);
    geometry
        .positions
        .extend(geometry.positions.clone().iter().map(|position| Vec3::new(position.x, position.y, -1.0)));
    geometry.normals = vec![Vec3::Z; 8];
    geometry.uvs = [Vec::new(), Vec::new()];
    geometry.colors = [[Vec4::new(1.0, 0.0, 0.0, alpha); 4], [Vec4::new(0.0, 0.0, 1.0, 1.0); 4]].concat();
    geometry.indices.extend([4, 5, 6, 4, 6, 7]);
    geometry.file_vertices = 8;
    let mut scene = Scene::new(vec![geometry], vec![Material { alpha_mode: AlphaMode::Blend, ..unlit(Vec4::ONE) }]);
    scene.frame.look.background = Background::Color([0, 0, 0]);
    scene
}

#[test]
fn the_nearest_opaque_layer_of_a_blended_surface_is_on_top() {
    let Some(gpu) = gpu() else { return };
    for samples in [1, 4] {
        let shown = |alpha| layers(alpha).draw_with(&gpu, RendererOptions { samples }).at(0.0, 0.0);
        near(shown(1.0), [255, 0, 0, 255], 1);
        near(shown(0.95), [242, 0, 0, 255], 2);
        // A clearly transparent layer hides nothing; without sorting, the far layer is drawn over it.
        near(shown(0.5), [0, 0, 255, 255], 1);
    }
}

#[test]
fn a_blended_surface_counts_its_triangles_once() {
    let Some(gpu) = gpu() else { return };
    let scene = layers(1.0);
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, RendererOptions { samples: 1 });
    renderer.upload(&gpu.device, &gpu.queue, &scene.model).unwrap();
    renderer.draw(&gpu.device, &gpu.queue, &scene.frame, [SIZE, SIZE]);
    assert_eq!(renderer.stats().triangles, 4);
}

/// A thin plate above the ground, seen from above and lit from +X at 45°, so that its shadow falls towards −X. The
/// background is transparent, and the picture is twice `half` metres wide.
fn plate(height: f32, half: f32) -> Scene {
    let corner = |x: f32, z: f32| Vec3::new(x, height, z);
    let geometry = Geometry {
        positions: vec![corner(-0.1, 0.8), corner(0.1, 0.8), corner(0.1, -0.8), corner(-0.1, -0.8)],
        normals: vec![Vec3::Y; 4],
        ..square(0)
    };
    let mut scene = Scene::new(vec![geometry], vec![unlit(Vec4::ONE)]);
    let eye = Vec3::new(0.0, 5.0, 0.0);
    scene.frame.view.view_from_world = look_at_mat4(eye, Vec3::ZERO, Vec3::NEG_Z);
    scene.frame.view.projection_from_view = orthographic(-half, half, -half, half, 1.0, 9.0);
    scene.frame.view.eye = eye;
    scene.frame.bounds = Bounds { min: Vec3::new(-0.1, 0.0, -0.8), max: Vec3::new(0.1, 1.0, 0.8) };
    scene.frame.look.shadow = true;
    scene.frame.look.key = Some(KeyLight { strength: 1.0, yaw_degrees: 90.0, pitch_degrees: 45.0 });
    scene
}

/// The opacity of the shadow along X, at z = 0.
fn shadow_along_x(scene: &Scene) -> Vec<u8> {
    let gpu = gpu().expect("checked");
    let picture = scene.draw_with(&gpu, RendererOptions { samples: 4 });
    let pixel = |at: u32| (at as f32 + 0.5) * 2.0 / SIZE as f32 - 1.0;
    (0..SIZE).map(|at| picture.at(pixel(at), 0.0)[3]).collect()
}

#[test]
fn the_ground_is_darker_around_what_stands_on_it() {
    let Some(_) = gpu() else { return };
    // Just above the ground, the plate hides its own shadow, and the ground is darker on all sides of it.
    let lying = shadow_along_x(&plate(0.01, 0.2));
    let at = |x: f32| lying[((0.5 + 0.5 * x / 0.2) * SIZE as f32) as usize];
    assert!(at(0.112) > 15 && at(-0.124) > 15, "{lying:?}");
    assert_eq!((at(0.18), at(-0.18)), (0, 0), "{lying:?}");
    // Far above the ground, it only casts a shadow.
    let high = shadow_along_x(&plate(0.6, 1.0));
    let at = |x: f32| high[((0.5 + 0.5 * x) * SIZE as f32) as usize];
    assert!(at(-0.6) > 70 && at(0.16) == 0, "{high:?}");
}

#[test]
fn shadows_soften_with_distance() {
    let Some(_) = gpu() else { return };
    // Close up, so that only one edge of the shadow is in the picture.
    let partial = |height: f32| {
        let mut scene = plate(height, 0.08);
        let eye = Vec3::new(-height - 0.1, 5.0, 0.0);
        scene.frame.view.view_from_world = look_at_mat4(eye, eye.with_y(0.0), Vec3::NEG_Z);
        scene.frame.view.eye = eye;
        let opacities = shadow_along_x(&scene);
        let full = opacities.iter().copied().max().expect("pixels");
        assert!(full > 70, "{opacities:?}");
        opacities.iter().filter(|&&opacity| opacity > 3 && opacity + 3 < full).count()
    };
    let (low, high) = (partial(0.25), partial(0.9));
    assert!(high > low + 2, "penumbra of {low} pixels near the ground, {high} far above it");
}
