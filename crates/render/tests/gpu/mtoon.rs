//! MToon: lit and shade colour, rim, matcap and outline, each on its own in simple light.

use std::sync::Arc;

use gaitway_character::anim::TextureSlot;
use gaitway_character::asset::{LightKind, Panorama};
use gaitway_character::mesh::{
    Filter, Geometry, Material, OutlineMode, Sampler, Texture, TextureRef, Toon, UvTransform, Wrap,
};
use gaitway_scene::frame::FrameLight;
use gaitway_scene::library::ImageData;
use gaitway_scene::state::{LightSetup, ToneMap};
use glam::{Vec2, Vec3, Vec4};

use crate::device::{Gpu, gl, gpu};
use crate::environment::sphere;
use crate::scene::{Picture, Scene, near};

const MAP: Option<TextureRef> = Some(TextureRef { texture: 0, uv_set: 0, uv_transform: UvTransform::IDENTITY });
const BASE: Vec3 = Vec3::new(0.8, 0.3, 0.1);
const SHADE: Vec3 = Vec3::new(0.1, 0.1, 0.5);

fn toon(toon: Toon) -> Material {
    let mut material = Material { base_color: BASE.extend(1.0), ..Default::default() };
    material.shade_as_toon(Toon { shade_color: SHADE, shading_toony: 0.98, ..toon });
    material
}

/// A sphere half as wide as the picture, with the same texture coordinates everywhere, and an image for its material.
fn scene(material: Material, width: u32, pixels: &[[u8; 4]]) -> Scene {
    let mut ball: Geometry = sphere(Vec2::ZERO, 0.5, 0);
    ball.uvs[0] = vec![Vec2::splat(0.25); ball.positions.len()];
    let sampler = Sampler { mag: Filter::Nearest, wrap_u: Wrap::ClampToEdge, ..Default::default() };
    let texture = Texture { image: Some(0), sampler };
    let height = pixels.len() as u32 / width;
    let image = ImageData::Rgba8 { width, height, pixels: pixels.concat() };
    let mut scene = Scene::textured(vec![ball], vec![material], vec![texture], vec![Some(image)]);
    scene.frame.look.tone_map = ToneMap::None;
    scene
}

/// Replaces the light by one from the right, so bright that lit surfaces have exactly their base colour.
fn from_right(mut scene: Scene) -> Scene {
    scene.frame.lights = vec![FrameLight {
        kind: LightKind::Directional,
        color: Vec3::splat(std::f32::consts::PI),
        position: Vec3::ZERO,
        direction: Vec3::NEG_X,
        range: 0.0,
    }];
    scene.frame.panorama = Some(Arc::new(Panorama::new(2, 1, vec![Vec3::ZERO; 2]).unwrap()));
    scene
}

fn shown(gpu: &Gpu, material: Material) -> Picture {
    from_right(scene(material, 1, &[[255; 4]])).draw(gpu)
}

/// Encodes a linear colour as sRGB.
fn srgb(linear: Vec3) -> [u8; 4] {
    let encode = |x: f32| if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    let [r, g, b] = linear.to_array().map(|x| (255.0 * encode(x.min(1.0))).round() as u8);
    [r, g, b, 255]
}

fn check_two_colors(gpu: &Gpu) {
    let picture = shown(gpu, toon(Toon::default()));
    near(picture.at(0.35, 0.1), srgb(BASE), 1);
    near(picture.at(0.1, 0.1), srgb(BASE), 1);
    near(picture.at(-0.1, 0.1), srgb(SHADE), 1);
    near(picture.at(-0.35, 0.1), srgb(SHADE), 1);
}

#[test]
fn surfaces_have_a_lit_and_a_shaded_side() {
    let Some(gpu) = gpu() else { return };
    check_two_colors(&gpu);
    // A shading shift extends the lit side: at x = -0.1 the cosine is about -0.2.
    let shifted = shown(&gpu, toon(Toon { shading_shift: 0.4, ..Toon::default() }));
    near(shifted.at(-0.1, 0.1), srgb(BASE), 1);
    near(shifted.at(-0.35, 0.1), srgb(SHADE), 1);
}

#[test]
fn surfaces_have_a_lit_and_a_shaded_side_with_opengl() {
    let Some(gpu) = gl() else { return };
    check_two_colors(&gpu);
    check_outline(&gpu);
}

#[test]
fn textures_change_the_shade_and_its_boundary() {
    let Some(gpu) = gpu() else { return };
    let with = |slot: TextureSlot, pixel: [u8; 4], values: Toon| {
        let mut material = toon(values);
        *material.texture_mut(slot).unwrap() = MAP;
        from_right(scene(material, 1, &[pixel])).draw(&gpu)
    };
    let red_shade = with(TextureSlot::ShadeMultiply, [255, 0, 0, 255], Toon::default());
    near(red_shade.at(-0.35, 0.1), srgb(SHADE * Vec3::X), 1);
    near(red_shade.at(0.35, 0.1), srgb(BASE), 1);
    let scaled = Toon { shading_shift_scale: -3.0, ..Toon::default() };
    let all_shade = with(TextureSlot::ShadingShift, [255, 0, 0, 255], scaled);
    near(all_shade.at(0.35, 0.1), srgb(SHADE), 1);
}

#[test]
fn ambient_light_shows_only_the_base_colour() {
    let Some(gpu) = gpu() else { return };
    let mut scene = scene(toon(Toon::default()), 1, &[[255; 4]]);
    scene.frame.look.light = LightSetup::White;
    let picture = scene.draw(&gpu);
    near(picture.at(0.3, 0.1), srgb(BASE), 2);
    near(picture.at(-0.3, -0.1), srgb(BASE), 2);
}

#[test]
fn rim_and_matcap_are_added() {
    let Some(gpu) = gpu() else { return };
    let glow = Vec3::new(0.0, 0.2, 0.3);
    // Lifted by 1, the rim is everywhere.
    let rim = Toon { rim_color: glow, rim_lift: 1.0, rim_lighting_mix: 0.0, ..Toon::default() };
    near(shown(&gpu, toon(rim)).at(-0.35, 0.1), srgb(SHADE + glow), 1);
    let narrow = shown(&gpu, toon(Toon { rim_lift: 0.0, rim_fresnel_power: 8.0, ..rim }));
    near(narrow.at(-0.1, 0.1), srgb(SHADE), 1);
    let mut matcap = toon(Toon { rim_lighting_mix: 0.0, ..Toon::default() });
    *matcap.texture_mut(TextureSlot::Matcap).unwrap() = MAP;
    matcap.base_color = Vec4::W;
    let (red, green, blue, white) = ([255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255; 4]);
    let mut scene = scene(matcap, 2, &[red, green, blue, white]);
    scene.frame.lights = from_right(Scene::new(Vec::new(), Vec::new())).frame.lights;
    scene.frame.lights[0].color = Vec3::ZERO;
    let picture = scene.draw(&gpu);
    for (at, color) in [((-0.2, 0.2), red), ((0.2, 0.2), green), ((-0.2, -0.2), blue), ((0.2, -0.2), white)] {
        near(picture.at(at.0, at.1), color, 1);
    }
}

/// The formula of @pixiv/three-vrm: texture coordinates turn about their middle, then move, both in proportion to the mask's blue.
#[test]
fn texture_coordinates_move_and_turn_with_time() {
    let Some(gpu) = gpu() else { return };
    let (red, green, blue, white) = ([255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255; 4]);
    // All texture coordinates are (0.25, 0.25), in the first of four texels.
    let shown = |first: [u8; 4], has_mask: bool, time_secs: f32, values: Toon| {
        let mut material = toon(Toon { shading_shift: 3.0, ..values });
        material.base_color = Vec4::ONE;
        *material.texture_mut(TextureSlot::BaseColor).unwrap() = MAP;
        *material.texture_mut(TextureSlot::UvAnimationMask).unwrap() = if has_mask { MAP } else { None };
        let mut scene = from_right(scene(material, 2, &[first, green, blue, white]));
        scene.frame.look.time_secs = time_secs;
        scene.draw(&gpu).at(0.2, 0.1)
    };
    let scroll = Toon { uv_scroll: Vec2::new(0.25, 0.0), ..Toon::default() };
    let turn = Toon { uv_rotation: std::f32::consts::FRAC_PI_2, ..Toon::default() };
    let both = Toon { uv_scroll: Vec2::new(0.25, 0.0), ..turn };
    for (values, time_secs, color) in [
        (scroll, 0.0, red),
        (scroll, 2.0, green),
        (Toon { uv_scroll: Vec2::new(0.0, 0.5), ..Toon::default() }, 1.0, blue),
        (turn, 1.0, blue),
        (turn, 2.0, white),
        (turn, 3.0, green),
        (Toon { uv_rotation: -turn.uv_rotation, ..turn }, 1.0, green),
        (Toon { uv_scroll: Vec2::new(0.5, 0.0), ..both }, 1.0, white),
    ] {
        near(shown(red, false, time_secs, values), color, 1);
    }
    // A mask without blue stops it.
    near(shown(red, true, 2.0, scroll), red, 1);
    near(shown([255, 0, 255, 255], true, 2.0, scroll), green, 1);
}

const LINE: Vec3 = Vec3::new(0.0, 0.5, 0.0);

fn outlined(outline_mode: OutlineMode, outline_width: f32) -> Material {
    toon(Toon { outline_mode, outline_width, outline_color: LINE, outline_lighting_mix: 0.0, ..Toon::default() })
}

fn check_outline(gpu: &Gpu) {
    // The picture is two metres high.
    for material in [outlined(OutlineMode::World, 0.2), outlined(OutlineMode::Screen, 0.1)] {
        let picture = shown(gpu, material);
        near(picture.at(0.35, 0.0), srgb(BASE), 1);
        for (x, y) in [(0.6, 0.0), (-0.6, 0.0), (0.0, 0.6), (0.0, -0.6)] {
            near(picture.at(x, y), srgb(LINE), 1);
        }
        assert_eq!(picture.at(0.8, 0.0), [0; 4]);
    }
}

#[test]
fn an_outline_surrounds_the_surface() {
    let Some(gpu) = gpu() else { return };
    check_outline(&gpu);
    let without = shown(&gpu, toon(Toon::default())).covered();
    assert!(shown(&gpu, outlined(OutlineMode::World, 0.2)).covered() > without + 100);
    assert_eq!(shown(&gpu, outlined(OutlineMode::None, 0.2)).covered(), without);
    let mut masked = outlined(OutlineMode::World, 0.2);
    *masked.texture_mut(TextureSlot::OutlineWidth).unwrap() = MAP;
    for (green, has_outline) in [(0, false), (255, true)] {
        let picture = from_right(scene(masked.clone(), 1, &[[0, green, 0, 255]])).draw(&gpu);
        assert_eq!(picture.covered() > without, has_outline);
    }
    // The heat map and the wireframe have none.
    let mut heat = from_right(scene(outlined(OutlineMode::World, 0.2), 1, &[[255; 4]]));
    heat.frame.characters[0].draws[0].heat_joint = Some(0);
    assert_eq!(heat.draw(&gpu).covered(), without);
    let mut wireframe = from_right(scene(outlined(OutlineMode::World, 0.2), 1, &[[255; 4]]));
    wireframe.frame.look.wireframe = true;
    assert_eq!(wireframe.draw(&gpu).at(0.6, 0.0), [0; 4]);
}
