//! Channels show single inputs of shading exactly as materials and vertices define them.

use gaitway_character::mesh::{
    AlphaMode, Geometry, Influences, Lobes, Material, Sampler, SkinningMode, Texture, TextureRef, Toon, UvTransform,
    palette_entry,
};
use gaitway_render::RendererOptions;
use gaitway_scene::library::ImageData;
use gaitway_scene::state::{Background, Channel, ToneMap};
use glam::{Affine3A, Vec2, Vec3, Vec4};

use crate::device::{Gpu, gl, gpu};
use crate::scene::{Picture, Scene, near, square};

const MAP: Option<TextureRef> = Some(TextureRef { texture: 0, uv_set: 0, uv_transform: UvTransform::IDENTITY });
/// Colour of surfaces without the attribute.
const MISSING: [u8; 4] = [59, 56, 64, 255];

fn scene(geometry: Geometry, material: Material, pixel: [u8; 4], channel: Channel) -> Scene {
    let image = ImageData::Rgba8 { width: 1, height: 1, pixels: pixel.to_vec() };
    let texture = Texture { image: Some(0), sampler: Sampler::default() };
    let mut scene = Scene::textured(vec![geometry], vec![material], vec![texture], vec![Some(image)]);
    scene.frame.look.channel = channel;
    // Channels ignore both.
    (scene.frame.look.exposure, scene.frame.look.tone_map) = (3.0, ToneMap::Aces);
    scene
}

fn middle(gpu: &Gpu, geometry: Geometry, material: Material, pixel: [u8; 4], channel: Channel) -> [u8; 4] {
    scene(geometry, material, pixel, channel).draw(gpu).at(0.1, 0.1)
}

/// Runs a check on both back ends.
fn on_each(check: impl Fn(&Gpu)) {
    for gpu in [gpu(), gl()].into_iter().flatten() {
        check(&gpu);
    }
}

#[test]
fn maps_are_shown_as_in_their_textures() {
    let pixel = [200, 100, 50, 255];
    let every_map = Material {
        metallic: 1.0,
        emissive: Vec3::ONE,
        base_color_texture: MAP,
        metallic_roughness_texture: MAP,
        occlusion_texture: MAP,
        emissive_texture: MAP,
        ..Material::default()
    };
    on_each(|gpu| {
        let shown = |channel| middle(gpu, square(0), every_map.clone(), pixel, channel);
        near(shown(Channel::BaseColor), pixel, 1);
        near(shown(Channel::Roughness), [100, 100, 100, 255], 1);
        near(shown(Channel::Metallic), [50, 50, 50, 255], 1);
        near(shown(Channel::Occlusion), [200, 200, 200, 255], 1);
        near(shown(Channel::Emissive), pixel, 1);
    });
}

#[test]
fn factors_and_vertex_colours_count() {
    let material = Material {
        roughness: 0.4,
        metallic: 0.8,
        occlusion_strength: 0.5,
        occlusion_texture: MAP,
        base_color: Vec4::new(0.5, 1.0, 0.0, 1.0),
        ..Material::default()
    };
    let colored = Geometry { colors: vec![Vec4::new(1.0, 0.5, 1.0, 1.0); 4], ..square(0) };
    on_each(|gpu| {
        let shown = |channel| middle(gpu, colored.clone(), material.clone(), [0, 0, 0, 255], channel);
        near(shown(Channel::Roughness), [102, 102, 102, 255], 1);
        near(shown(Channel::Metallic), [204, 204, 204, 255], 1);
        near(shown(Channel::Occlusion), [128, 128, 128, 255], 1);
        // A linear 0.5 is 188 in sRGB.
        near(shown(Channel::BaseColor), [188, 188, 0, 255], 1);
        near(shown(Channel::VertexColor), [255, 188, 255, 255], 1);
        near(shown(Channel::Emissive), [0, 0, 0, 255], 0);
    });
}

#[test]
fn normals_and_tangents_are_shown_in_world_space() {
    let tangents = vec![Vec4::new(0.0, -1.0, 0.0, 1.0); 4];
    let turned = Geometry { tangents, normals: vec![Vec3::new(0.6, 0.0, 0.8); 4], ..square(0) };
    on_each(|gpu| {
        let shown = |channel| middle(gpu, turned.clone(), Material::default(), [0; 4], channel);
        near(shown(Channel::Normal), [204, 128, 230, 255], 1);
        near(shown(Channel::Tangent), [128, 0, 128, 255], 1);
        // The normal map tilts towards the tangent.
        let mapped = Material { normal_texture: MAP, ..Material::default() };
        let tangents = vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 4];
        let facing = Geometry { tangents, ..square(0) };
        near(middle(gpu, facing, mapped, [204, 128, 230, 255], Channel::Normal), [204, 128, 230, 255], 2);
    });
}

#[test]
fn a_surface_without_the_attribute_is_grey() {
    let bare = Geometry { uvs: [Vec::new(), Vec::new()], ..square(0) };
    let toon = Material { toon: Some(Box::new(Toon::default())), ..Material::default() };
    on_each(|gpu| {
        for channel in [Channel::Tangent, Channel::Uv, Channel::VertexColor, Channel::Influences] {
            near(middle(gpu, bare.clone(), Material::default(), [0; 4], channel), MISSING, 1);
        }
        for channel in [Channel::Roughness, Channel::Metallic, Channel::Occlusion] {
            near(middle(gpu, bare.clone(), toon.clone(), [0; 4], channel), MISSING, 1);
        }
    });
}

#[test]
fn the_checker_follows_the_texture_coordinates() {
    on_each(|gpu| {
        let picture = scene(square(0), Material::default(), [0; 4], Channel::Uv).draw(gpu);
        // u grows to the right, v down; fields are light or dark.
        let (left, right) = (picture.at(-0.4, 0.1), picture.at(0.4, 0.1));
        let (up, down) = (picture.at(0.1, 0.4), picture.at(0.1, -0.4));
        assert!(right[0] > left[0] + 60, "{left:?} {right:?}");
        assert!(down[1] > up[1] + 60, "{up:?} {down:?}");
    });
}

/// A square whose vertices have this many influences.
fn influenced(count: usize) -> Geometry {
    let stride = count.next_multiple_of(4);
    let joints: Vec<u16> = (0..stride as u16).map(|joint| if usize::from(joint) < count { joint } else { 0 }).collect();
    let weights: Vec<f32> = (0..stride).map(|at| if at < count { 1.0 / count as f32 } else { 0.0 }).collect();
    Geometry { influences: Influences { stride, joints: joints.repeat(4), weights: weights.repeat(4) }, ..square(0) }
}

#[test]
fn influences_are_counted_from_attributes_and_textures() {
    let expected = [
        (1, [48, 112, 224, 255]),
        (2, [41, 173, 179, 255]),
        (4, [56, 194, 89, 255]),
        (8, [250, 168, 33, 255]),
        (16, [230, 41, 71, 255]),
    ];
    on_each(|gpu| {
        for (count, color) in expected {
            let mut scene = scene(influenced(count), Material::default(), [0; 4], Channel::Influences);
            let character = &mut scene.frame.characters[0];
            character.palette = vec![palette_entry(&Affine3A::IDENTITY, SkinningMode::Linear); 16];
            character.draws[0].palette = 0..16;
            near(scene.draw(gpu).at(0.1, 0.1), color, 1);
        }
    });
}

/// Masks keep their holes, blended surfaces their alpha; lobes and the heat map make no difference.
#[test]
fn alpha_is_kept_and_everything_else_of_the_material_ignored() {
    let Some(gpu) = gpu() else { return };
    let material = |alpha, alpha_mode| Material {
        base_color: Vec4::new(1.0, 0.0, 0.0, alpha),
        alpha_mode,
        roughness: 0.6,
        ..Material::default()
    };
    let shown = |material| middle(&gpu, square(0), material, [0; 4], Channel::Roughness);
    assert_eq!(shown(material(0.4, AlphaMode::Mask { cutoff: 0.5 })), [0; 4]);
    near(shown(material(0.6, AlphaMode::Mask { cutoff: 0.5 })), [153, 153, 153, 255], 1);
    near(shown(material(0.5, AlphaMode::Blend)), [153, 153, 153, 128], 2);
    let lobes = Lobes { clearcoat: 1.0, transmission: 1.0, ..Lobes::default() };
    near(shown(Material { lobes: Some(Box::new(lobes)), ..material(1.0, AlphaMode::Opaque) }), [153, 153, 153, 255], 1);
    let mut heat = scene(square(0), material(1.0, AlphaMode::Opaque), [0; 4], Channel::Roughness);
    heat.frame.characters[0].draws[0].heat_joint = Some(0);
    near(heat.draw(&gpu).at(0.1, 0.1), [153, 153, 153, 255], 1);
}

/// Two squares behind each other, the rear one smaller, so that its edges are inside the front one.
fn one_behind_the_other(mesh: bool, channel: Channel) -> Scene {
    let mut behind = square(0);
    for position in &mut behind.positions {
        *position = 0.5 * *position - Vec3::Z;
    }
    let mut scene = Scene::new(vec![square(0), behind], vec![Material::default()]);
    (scene.frame.look.wireframe, scene.frame.look.mesh, scene.frame.look.channel) = (!mesh, mesh, channel);
    scene.frame.look.background = Background::Color([255, 255, 255]);
    scene
}

#[test]
fn hidden_edges_are_not_drawn() {
    on_each(|gpu| {
        // The rear square's edges are at ±0.25, away from the front one's diagonal.
        let darkest = |picture: &Picture, points: [(f32, f32); 3]| {
            let near = |(x, y): (f32, f32)| [-0.05, 0.0, 0.05].map(|by| picture.at(x + by, y + by)[0]);
            points.into_iter().flat_map(near).min()
        };
        let (inside, own) = ([(0.25, 0.0), (-0.25, 0.1), (0.05, 0.25)], [(0.5, 0.0), (-0.5, 0.1), (0.0, 0.5)]);
        let alone = one_behind_the_other(false, Channel::Shaded).draw(gpu);
        assert_eq!(darkest(&alone, inside), Some(255), "without surfaces");
        assert!(darkest(&alone, own) < Some(200));
        // The background shows through surfaces that aren't drawn.
        let mut studio = one_behind_the_other(false, Channel::Shaded);
        studio.frame.look.background = Background::Studio;
        let inside_of_studio = studio.draw(gpu).at(0.1, -0.2);
        studio.frame.look.wireframe = false;
        near(inside_of_studio, studio.draw(gpu).at(0.1, -0.2), 0);
        let channel = one_behind_the_other(true, Channel::Wireframe).draw(gpu);
        assert_eq!(darkest(&channel, inside), Some(219), "on plain surfaces");
        assert!(darkest(&channel, own) < Some(60));
    });
}

#[test]
fn with_multisampling_the_channels_are_the_same() {
    let Some(gpu) = gpu() else { return };
    let material = Material { roughness: 0.6, alpha_mode: AlphaMode::Mask { cutoff: 0.5 }, ..Material::default() };
    let mut scene = scene(square(0), material, [0; 4], Channel::Roughness);
    scene.frame.look.background = Background::Color([0, 0, 0]);
    let picture = scene.draw_with(&gpu, RendererOptions { samples: 4 });
    near(picture.at(0.1, 0.1), [153, 153, 153, 255], 1);
    assert_eq!(picture.at(0.9, 0.9), [0, 0, 0, 255]);
}

#[test]
fn mirrored_texture_coordinates_show_in_the_checker() {
    let Some(gpu) = gpu() else { return };
    let mut mirrored = square(0);
    mirrored.uvs[0].iter_mut().for_each(|uv| *uv = Vec2::new(1.0 - uv.x, uv.y));
    let picture = scene(mirrored, Material::default(), [0; 4], Channel::Uv).draw(&gpu);
    assert!(picture.at(-0.4, 0.1)[0] > picture.at(0.4, 0.1)[0] + 60);
}
