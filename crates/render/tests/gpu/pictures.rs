//! Small pictures with known colours.

use gaitway_character::mesh::{
    AlphaMode, Bounds, Geometry, Influences, Material, SkinningMode, Texture, TextureRef, Topology, UvTransform,
    palette_entry,
};
use gaitway_render::{Renderer, RendererOptions, read_pixels};
use gaitway_scene::frame::{Bone, Line};
use gaitway_scene::library::ImageData;
use gaitway_scene::state::{Background, ToneMap};
use glam::camera::rh::view::look_at_mat4;
use glam::{Affine3A, Vec2, Vec3, Vec4};

use crate::device::{Gpu, gl, gpu};
use crate::scene::{Picture, SIZE, Scene, near, square, unlit};

fn linear(color: [u8; 3]) -> Vec4 {
    let linear = |value: u8| {
        let value = f32::from(value) / 255.0;
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    };
    Vec3::from(color.map(linear)).extend(1.0)
}

#[test]
fn an_unlit_colour_is_drawn_unchanged() {
    let Some(gpu) = gpu() else { return };
    for color in [[200, 100, 50], [255, 255, 255], [0, 0, 0], [10, 20, 30], [250, 0, 3], [128, 128, 128]] {
        for exposure in [1.0, 4.0, 0.25] {
            let mut scene = Scene::new(vec![square(0)], vec![unlit(linear(color))]);
            scene.frame.look.exposure = exposure;
            let picture = scene.draw(&gpu);
            near(picture.at(0.0, 0.0), [color[0], color[1], color[2], 255], 1);
        }
    }
}

#[test]
fn an_unlit_material_does_not_glow() {
    let Some(gpu) = gpu() else { return };
    let material = Material { emissive: Vec3::new(0.0, 0.5, 0.5), ..unlit(linear([200, 100, 50])) };
    let shown = Scene::new(vec![square(0)], vec![material.clone()]).draw(&gpu).at(0.0, 0.0);
    near(shown, [200, 100, 50, 255], 1);
    // Points and lines without normals, which have no side to light, do (glTF 2.0 §3.9.6).
    let points = Geometry { topology: Topology::Points, normals: Vec::new(), ..square(0) };
    let material = Material { unlit: false, emissive: Vec3::Y, base_color: Vec4::new(1.0, 0.0, 0.0, 1.0), ..material };
    let picture = Scene::new(vec![points], vec![material]).draw(&gpu);
    assert!(picture.0.as_chunks::<4>().0.contains(&[255, 255, 0, 255]));
}

#[test]
fn a_square_covers_exactly_its_pixels() {
    let Some(gpu) = gpu() else { return };
    let picture = Scene::new(vec![square(0)], vec![unlit(Vec4::ONE)]).draw(&gpu);
    assert_eq!(picture.covered(), (SIZE * SIZE / 4) as usize);
    assert_eq!(picture.at(-0.9, 0.9), [0; 4]);
}

#[test]
fn a_pane_shows_only_its_own_characters() {
    let Some(gpu) = gpu() else { return };
    let mut scene = Scene::new(vec![square(0)], vec![unlit(Vec4::ONE)]);
    let whole = scene.draw(&gpu).covered();
    scene.frame.panes = [2, 1];
    let both = scene.draw(&gpu);
    assert!(both.covered() > whole / 2, "a character without a pane is in all of them");
    assert_eq!((both.at(-0.5, 0.0)[3], both.at(0.5, 0.0)[3]), (255, 255));
    scene.frame.characters[0].pane = Some(1);
    let right = scene.draw(&gpu);
    assert_eq!((right.at(-0.5, 0.0)[3], right.at(0.5, 0.0)[3]), (0, 255));
    assert_eq!(2 * right.covered(), both.covered());
}

#[test]
fn a_mask_cuts_without_blending() {
    let Some(gpu) = gpu() else { return };
    for (alpha, shown) in [(0.4, 0), (0.5, 255), (0.6, 255)] {
        let material =
            Material { alpha_mode: AlphaMode::Mask { cutoff: 0.5 }, ..unlit(Vec4::new(1.0, 1.0, 1.0, alpha)) };
        let picture = Scene::new(vec![square(0)], vec![material]).draw(&gpu);
        assert_eq!(picture.at(0.0, 0.0)[3], shown, "alpha {alpha}");
    }
}

#[test]
fn blended_surfaces_are_sorted_and_blended() {
    let Some(gpu) = gpu() else { return };
    let blend = |color: Vec3, alpha| Material { alpha_mode: AlphaMode::Blend, ..unlit(color.extend(alpha)) };
    let mut scene = Scene::new(vec![square(0)], vec![blend(Vec3::ONE, 0.5)]);
    // Un-premultiplying 8-bit colours loses some precision.
    near(scene.draw(&gpu).at(0.0, 0.0), [255, 255, 255, 128], 2);
    scene.frame.look.background = Background::Color([0, 0, 0]);
    near(scene.draw(&gpu).at(0.0, 0.0), [128, 128, 128, 255], 1);

    // The nearer one is drawn last, whatever the order in the file.
    for near_first in [true, false] {
        let mut squares = vec![square(0), square(1)];
        let depths = if near_first { [1.0, 0.0] } else { [0.0, 1.0] };
        for (square, z) in squares.iter_mut().zip(depths) {
            square.positions.iter_mut().for_each(|position| position.z = z);
            square.material = Some(usize::from(z == 0.0));
        }
        let red_over_green = vec![blend(Vec3::X, 0.75), blend(Vec3::Y, 1.0)];
        let mut scene = Scene::new(squares, red_over_green);
        for (draw, z) in scene.frame.characters[0].draws.iter_mut().zip(depths) {
            draw.center.z = z;
        }
        let shown = scene.draw(&gpu).at(0.0, 0.0);
        near(shown, [191, 64, 0, 255], 1);
    }
}

#[test]
fn back_faces_are_culled_unless_double_sided_and_then_lit_from_their_side() {
    let Some(gpu) = gpu() else { return };
    let material = Material { base_color: Vec4::new(0.5, 0.5, 0.5, 1.0), metallic: 0.0, ..Default::default() };
    let double_sided = Material { double_sided: true, ..material.clone() };
    let front = Scene::new(vec![square(0)], vec![material.clone()]).draw(&gpu).at(0.0, 0.0);
    assert!(front[0] > 60, "the front is lit: {front:?}");
    let turned = || {
        let mut square = square(0);
        square.indices.reverse();
        square.normals = vec![Vec3::NEG_Z; 4];
        vec![square]
    };
    assert_eq!(Scene::new(turned(), vec![material]).draw(&gpu).covered(), 0);
    near(Scene::new(turned(), vec![double_sided]).draw(&gpu).at(0.0, 0.0), front, 1);
}

#[test]
fn a_mirrored_mesh_shows_its_front() {
    let Some(gpu) = gpu() else { return };
    for (mirrored, covered) in [(true, (SIZE * SIZE / 4) as usize), (false, 0)] {
        let mut scene = Scene::new(vec![square(0)], vec![unlit(Vec4::ONE)]);
        let character = &mut scene.frame.characters[0];
        let mirror = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
        character.palette = vec![palette_entry(&mirror, SkinningMode::Linear)];
        character.draws[0].mirrored = mirrored;
        assert_eq!(scene.draw(&gpu).covered(), covered, "{mirrored}");
    }
}

#[test]
fn flat_normals_come_from_the_triangles() {
    let Some(gpu) = gpu() else { return };
    let material = Material { base_color: Vec4::new(0.5, 0.5, 0.5, 1.0), metallic: 0.0, ..Default::default() };
    let smooth = Scene::new(vec![square(0)], vec![material.clone()]).draw(&gpu);
    let mut flat = square(0);
    flat.normals.clear();
    let flat = Scene::new(vec![flat], vec![material]).draw(&gpu);
    near(flat.at(0.3, 0.2), smooth.at(0.3, 0.2), 1);
}

/// Multiplies by a matrix given by columns, as the shader does.
fn transformed(matrix: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|row| matrix[0][row] * v[0] + matrix[1][row] * v[1] + matrix[2][row] * v[2])
}

/// The specification of Khronos PBR Neutral.
fn neutral(scene: [f64; 3]) -> [f64; 3] {
    let darkest = scene.into_iter().fold(f64::INFINITY, f64::min);
    let offset = if darkest < 0.08 { darkest - 6.25 * darkest * darkest } else { 0.04 };
    let color = scene.map(|channel| channel - offset);
    let peak = color.into_iter().fold(0.0, f64::max);
    if peak < 0.76 {
        return color;
    }
    let new_peak = 1.0 - 0.24 * 0.24 / (peak + 0.24 - 0.76);
    let gray = 1.0 - 1.0 / (0.15 * (peak - new_peak) + 1.0);
    color.map(|channel| channel * new_peak / peak * (1.0 - gray) + new_peak * gray)
}

/// three.js r180, `ACESFilmicToneMapping`.
fn aces(scene: [f64; 3]) -> [f64; 3] {
    let input = [[0.59719, 0.076, 0.0284], [0.35458, 0.90834, 0.13383], [0.04823, 0.01566, 0.83777]];
    let output = [[1.60475, -0.10208, -0.00327], [-0.53108, 1.10813, -0.07276], [-0.07367, -0.00605, 1.07602]];
    let fitted = transformed(input, scene.map(|channel| channel / 0.6))
        .map(|v| (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.432951) + 0.238081));
    transformed(output, fitted)
}

/// three.js r180, `AgXToneMapping`.
fn agx(scene: [f64; 3]) -> [f64; 3] {
    let to_rec2020 = [[0.6274, 0.0691, 0.0164], [0.3293, 0.9195, 0.088], [0.0433, 0.0113, 0.8956]];
    let from_rec2020 = [[1.6605, -0.1246, -0.0182], [-0.5876, 1.1329, -0.1006], [-0.0728, -0.0083, 1.1187]];
    let inset = [
        [0.856627153315983, 0.137318972929847, 0.11189821299995],
        [0.0951212405381588, 0.761241990602591, 0.0767994186031903],
        [0.0482516061458583, 0.101439036467562, 0.811302368396859],
    ];
    let outset = [
        [1.1271005818144368, -0.1413297634984383, -0.14132976349843826],
        [-0.11060664309660323, 1.157823702216272, -0.11060664309660294],
        [-0.016493938717834573, -0.016493938717834257, 1.2519364065950405],
    ];
    let curve = |channel: f64| {
        let x = ((channel.max(1e-10).log2() + 12.47393) / (4.026069 + 12.47393)).clamp(0.0, 1.0);
        15.5 * x.powi(6) - 40.14 * x.powi(5) + 31.96 * x.powi(4) - 6.868 * x.powi(3) + 0.4298 * x * x + 0.1191 * x
            - 0.00232
    };
    let curved = transformed(inset, transformed(to_rec2020, scene)).map(curve);
    transformed(from_rec2020, transformed(outset, curved).map(|channel| channel.max(0.0).powf(2.2)))
}

#[test]
fn light_is_tone_mapped() {
    let Some(gpu) = gpu() else { return };
    type Mapping = fn([f64; 3]) -> [f64; 3];
    let mappings: [(ToneMap, Mapping); 4] =
        [(ToneMap::Neutral, neutral), (ToneMap::Aces, aces), (ToneMap::Agx, agx), (ToneMap::None, |scene| scene)];
    let lights = [[0.02; 3], [0.3; 3], [1.5; 3], [6.0; 3], [0.9, 0.2, 0.05], [0.0, 0.1, 3.0]];
    for (tone_map, mapping) in mappings {
        for light in lights {
            let encode = |linear: f64| match linear.clamp(0.0, 1.0) {
                linear if linear <= 0.0031308 => 12.92 * linear,
                linear => 1.055 * linear.powf(1.0 / 2.4) - 0.055,
            };
            let [r, g, b] = mapping(light).map(|channel| (255.0 * encode(channel)).round() as u8);
            // Black metal reflects only what grazes it, so head on only the emission is visible.
            let emissive = Vec3::from(light.map(|channel| channel as f32));
            let material = Material { base_color: Vec4::new(0.0, 0.0, 0.0, 1.0), emissive, ..Default::default() };
            let mut scene = Scene::new(vec![square(0)], vec![material]);
            scene.frame.look.tone_map = tone_map;
            near(scene.draw(&gpu).at(0.0, 0.0), [r, g, b, 255], 1);
        }
    }
}

#[test]
fn a_texture_is_sampled_with_its_transform() {
    let Some(gpu) = gpu() else { return };
    // Red, green over blue, white.
    let pixels = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255; 4]].concat();
    let image = ImageData::Rgba8 { width: 2, height: 2, pixels };
    let mut texture = Texture { image: Some(0), sampler: Default::default() };
    texture.sampler.mag = gaitway_character::mesh::Filter::Nearest;
    let quarter_turn = UvTransform { rotation_radians: std::f32::consts::FRAC_PI_2, ..UvTransform::IDENTITY };
    let half = UvTransform { offset: Vec2::new(0.5, 0.0), ..UvTransform::IDENTITY };
    let cases = [
        (UvTransform::IDENTITY, [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255; 3]]),
        // u' = u + ½: the columns swap.
        (half, [[0, 255, 0], [255, 0, 0], [255; 3], [0, 0, 255]]),
        // u' = v, v' = −u (KHR_texture_transform's matrix for a quarter turn).
        (quarter_turn, [[0, 0, 255], [255, 0, 0], [255; 3], [0, 255, 0]]),
    ];
    for (uv_transform, colors) in cases {
        let material = Material {
            base_color_texture: Some(TextureRef { texture: 0, uv_set: 0, uv_transform }),
            ..unlit(Vec4::ONE)
        };
        let scene = Scene::textured(vec![square(0)], vec![material], vec![texture], vec![Some(image.clone())]);
        let picture = scene.draw(&gpu);
        for ((x, y), [r, g, b]) in [(-0.25, 0.25), (0.25, 0.25), (-0.25, -0.25), (0.25, -0.25)].into_iter().zip(colors)
        {
            near(picture.at(x, y), [r, g, b, 255], 1);
        }
    }
}

#[test]
fn the_heat_map_colours_weights() {
    let Some(gpu) = gpu() else { return };
    let mut geometry = square(0);
    geometry.influences =
        Influences { stride: 4, joints: [[0, 1, 0, 0]; 4].concat(), weights: [[1.0, 0.0, 0.0, 0.0]; 4].concat() };
    let mut scene = Scene::new(vec![geometry], vec![Material::default()]);
    let entry = scene.frame.characters[0].palette[0];
    scene.frame.characters[0].palette = vec![entry; 2];
    scene.frame.characters[0].draws[0].palette = 0..2;
    let mut color = |joint| {
        scene.frame.characters[0].draws[0].heat_joint = Some(joint);
        scene.draw(&gpu).at(0.0, 0.0)
    };
    let [r, g, b, _] = color(0);
    assert!(r > 3 * g && r > 3 * b, "full weight is red: {r} {g} {b}");
    let [r, g, b, _] = color(1);
    assert!(b > r && b < 2 * r, "no weight is grey-blue: {r} {g} {b}");
    assert_eq!(color(u32::MAX), [r, g, b, 255]);
}

#[test]
fn the_ground_shows_the_shadow() {
    let Some(gpu) = gpu() else { return };
    let mut geometry = square(0);
    // Horizontal, 0.3 above the ground, facing up.
    for position in &mut geometry.positions {
        *position = Vec3::new(position.x, 0.3, -position.y);
    }
    geometry.normals = vec![Vec3::Y; 4];
    let mut scene = Scene::new(vec![geometry], vec![unlit(Vec4::ONE)]);
    let eye = Vec3::new(0.0, 5.0, 0.0);
    scene.frame.view.eye = eye;
    scene.frame.view.view_from_world = look_at_mat4(eye, Vec3::ZERO, Vec3::NEG_Z);
    scene.frame.bounds = Bounds { min: Vec3::new(-0.5, 0.0, -0.5), max: Vec3::new(0.5, 0.3, 0.5) };
    assert_eq!(scene.draw(&gpu).at(0.6, 0.3)[3], 0, "nothing without a shadow");
    scene.frame.look.shadow = true;
    let picture = scene.draw(&gpu);
    // The key light comes from the front left, so the shadow falls to the back right.
    let [r, g, b, alpha] = picture.at(0.6, 0.3);
    assert!([r, g, b] == [0; 3] && (40..200).contains(&alpha), "{r} {g} {b} {alpha}");
    assert_eq!(picture.at(-0.8, -0.8)[3], 0, "and not on the lit side");
}

#[test]
fn lines_have_their_width_and_colour_and_may_be_on_top() {
    let Some(gpu) = gpu() else { return };
    let line = |y: f32, on_top| Line {
        from: Vec3::new(-0.9, y, -1.0),
        to: Vec3::new(0.9, y, -1.0),
        color: Vec4::new(1.0, 0.0, 0.0, 1.0),
        width_pixels: 4.0,
        on_top,
    };
    let mut scene = Scene::new(vec![square(0)], vec![unlit(Vec4::ONE)]);
    scene.frame.lines = vec![line(0.25, true), line(-0.25, false)];
    let picture = scene.draw(&gpu);
    near(picture.at(0.0, 0.25), [255, 0, 0, 255], 2);
    near(picture.at(0.0, -0.25), [255, 255, 255, 255], 1);
    near(picture.at(0.7, -0.25), [255, 0, 0, 255], 2);
    let column: usize = (0..SIZE).filter(|row| picture.0[(4 * (row * SIZE + 2) + 3) as usize] > 128).count();
    assert_eq!(column, 8, "two lines of four pixels");
}

#[test]
fn bones_are_visible_through_the_mesh() {
    let Some(gpu) = gpu() else { return };
    let mut scene = Scene::new(vec![square(0)], vec![unlit(Vec4::ONE)]);
    scene.frame.bones = vec![Bone {
        head: Vec3::new(0.0, -0.4, -2.0),
        tail: Vec3::new(0.0, 0.4, -2.0),
        radius: 0.15,
        color: Vec4::new(0.0, 0.0, 1.0, 1.0),
        joint: 0,
        of_source: false,
        visible: true,
    }];
    let [r, _, b, _] = scene.draw(&gpu).at(0.0, -0.15);
    assert!(b > 100 && r < 100, "{r} {b}");
}

#[test]
fn a_wireframe_is_drawn_with_and_without_the_mesh() {
    let Some(gpu) = gpu() else { return };
    let mut scene = Scene::new(vec![square(0)], vec![unlit(Vec4::ONE)]);
    scene.frame.look.wireframe = true;
    let over = scene.draw(&gpu);
    assert_eq!(over.at(0.2, -0.2)[3], 255);
    let dark = |picture: &Picture| picture.0.as_chunks::<4>().0.iter().filter(|p| p[3] > 0 && p[0] < 230).count();
    assert!(dark(&over) >= SIZE as usize / 2, "the diagonal is drawn over the mesh: {}", dark(&over));
    scene.frame.look.mesh = false;
    let alone = scene.draw(&gpu);
    assert!((40..120).contains(&alone.covered()), "{}", alone.covered());
}

#[test]
fn points_and_lines_are_drawn() {
    let Some(gpu) = gpu() else { return };
    for (topology, indices, covered) in [
        (Topology::Points, vec![0, 1, 2, 3], 2..=4),
        (Topology::Lines, vec![0, 2], SIZE as usize / 2 - 1..=SIZE as usize / 2 + 1),
    ] {
        let geometry = Geometry { topology, indices, normals: Vec::new(), ..square(0) };
        let picture = Scene::new(vec![geometry], vec![Material { metallic: 0.0, ..Default::default() }]).draw(&gpu);
        assert!(covered.contains(&picture.covered()), "{topology:?}: {}", picture.covered());
    }
}

#[test]
fn an_empty_frame_and_an_unknown_model_draw_the_background() {
    let Some(gpu) = gpu() else { return };
    let Gpu { device, queue } = &gpu;
    let mut renderer = Renderer::new(device, queue, RendererOptions { samples: 4 });
    let mut scene = Scene::new(vec![square(0)], vec![unlit(Vec4::ONE)]);
    scene.frame.look.background = Background::Color([10, 200, 30]);
    renderer.draw(device, queue, &scene.frame, [SIZE, SIZE]);
    let picture = Picture(pollster::block_on(read_pixels(device, queue, renderer.output())));
    assert!(picture.0.as_chunks::<4>().0.iter().all(|pixel| *pixel == [10, 200, 30, 255]));
    assert_eq!(renderer.stats().triangles, 0);
    // The same for a model whose data was freed.
    renderer.upload(device, queue, &scene.model).unwrap();
    renderer.draw(device, queue, &scene.frame, [SIZE, SIZE]);
    assert_eq!(renderer.stats().triangles, 2);
    renderer.retain(&[]);
    renderer.draw(device, queue, &scene.frame, [SIZE, SIZE]);
    assert_eq!(renderer.stats().triangles, 0);
}

#[test]
fn a_variant_has_its_own_material() {
    let Some(gpu) = gpu() else { return };
    let glass = Material { alpha_mode: AlphaMode::Blend, ..unlit(Vec4::new(0.0, 1.0, 0.0, 0.5)) };
    let geometry = Geometry { variants: vec![(1, 1), (2, 2)], ..square(0) };
    let mut scene = Scene::with_variants(vec![geometry], vec![unlit(Vec4::ONE), unlit(linear([255, 0, 0])), glass], 3);
    for (variant, shown) in [
        (None, [255, 255, 255, 255]),
        (Some(0), [255, 255, 255, 255]),
        (Some(1), [255, 0, 0, 255]),
        (Some(2), [0, 255, 0, 128]),
    ] {
        scene.frame.characters[0].variant = variant;
        near(scene.draw(&gpu).at(0.0, 0.0), shown, 2);
    }
    // The wireframe is the same in all variants.
    scene.frame.look.wireframe = true;
    scene.frame.look.mesh = false;
    assert!((40..120).contains(&scene.draw(&gpu).covered()));
}

#[test]
fn copies_are_drawn_in_one_call_unless_they_have_to_be_sorted() {
    let half = Affine3A::from_scale(Vec3::splat(0.5));
    let gpus: Vec<Gpu> = [gpu(), gl()].into_iter().flatten().collect();
    let modes = [(AlphaMode::Opaque, 2), (AlphaMode::Blend, 6)];
    for (Gpu { device, queue }, (alpha_mode, calls)) in gpus.iter().flat_map(|gpu| modes.map(|mode| (gpu, mode))) {
        let material = Material { alpha_mode, ..unlit(Vec4::ONE) };
        let mut scene = Scene::new(vec![square(0)], vec![material]);
        scene.frame.characters[0].palette = vec![palette_entry(&half, SkinningMode::Linear)];
        scene.add_copy(Affine3A::from_translation(Vec3::new(0.5, 0.5, 0.0)) * half);
        // Mirroring flips the winding, which takes a draw call of its own.
        let mirrored = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0)) * half;
        scene.add_copy(Affine3A::from_translation(Vec3::new(-0.5, -0.5, 0.0)) * mirrored);
        let mut renderer = Renderer::new(device, queue, RendererOptions { samples: 1 });
        renderer.upload(device, queue, &scene.model).unwrap();
        renderer.draw(device, queue, &scene.frame, [SIZE, SIZE]);
        let picture = Picture(pollster::block_on(read_pixels(device, queue, renderer.output())));
        for (x, y, covered) in [(0.0, 0.0, true), (0.5, 0.5, true), (-0.5, -0.5, true), (0.5, -0.5, false)] {
            assert_eq!(picture.at(x, y)[3] == 255, covered, "{alpha_mode:?} at {x}, {y}");
        }
        assert_eq!((renderer.stats().draw_calls, renderer.stats().triangles), (calls, 6), "{alpha_mode:?}");
    }
}

#[test]
fn surfaces_with_hidden_materials_are_not_drawn() {
    let Some(gpu) = gpu() else { return };
    let [red, blue] = [Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::new(0.0, 0.0, 1.0, 1.0)];
    let default = Geometry { material: None, ..square(0) };
    let mut scene = Scene::new(vec![square(0), default], vec![unlit(red), unlit(blue)]);
    scene.frame.look.shadow = true;
    let mut shown = |hidden: &[Option<usize>]| {
        scene.frame.characters[0].hidden_materials = hidden.to_vec();
        let Gpu { device, queue } = &gpu;
        let mut renderer = Renderer::new(device, queue, RendererOptions { samples: 1 });
        renderer.upload(device, queue, &scene.model).unwrap();
        renderer.draw(device, queue, &scene.frame, [SIZE, SIZE]);
        (renderer.stats().triangles, renderer.stats().draw_calls)
    };
    let (all, calls) = shown(&[]);
    assert_eq!(all, 4);
    for one in [None, Some(0)] {
        let (triangles, fewer) = shown(&[one]);
        assert_eq!(triangles, 2, "{one:?}");
        assert!(fewer + 2 <= calls, "neither in the picture nor in the shadow map: {fewer} of {calls}");
    }
    assert_eq!(shown(&[Some(1)]), (all, calls), "nothing has this material");
    assert_eq!(shown(&[None, Some(0)]).0, 0);
}
