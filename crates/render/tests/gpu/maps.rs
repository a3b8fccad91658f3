//! Material maps and their sampling: laws rather than colours.

use gaitway_character::mesh::{Filter, Geometry, Material, MipFilter, Sampler, Texture, TextureRef, UvTransform};
use gaitway_ktx2::{Format, Formats, MAGIC, Texture as Ktx2, decode, request};
use gaitway_render::{Renderer, RendererOptions, texture_formats};
use gaitway_scene::library::ImageData;
use gaitway_scene::state::Channel;
use glam::{Affine2, Vec2, Vec3, Vec4};
use serde_json::json;

use crate::build_gltf::Build;
use crate::device::{Gpu, gl, gpu};
use crate::scene::{SIZE, Scene, near, square, unlit};

const MAP: Option<TextureRef> = Some(TextureRef { texture: 0, uv_set: 0, uv_transform: UvTransform::IDENTITY });

/// Grey, half rough, dielectric.
fn gray() -> Material {
    Material { base_color: Vec4::new(0.4, 0.4, 0.4, 1.0), metallic: 0.0, roughness: 0.5, ..Default::default() }
}

fn flat_image(pixel: [u8; 4]) -> ImageData {
    ImageData::Rgba8 { width: 1, height: 1, pixels: pixel.to_vec() }
}

fn middle(gpu: &Gpu, geometry: Geometry, material: Material, image: ImageData) -> [u8; 4] {
    let texture = Texture { image: Some(0), sampler: Sampler::default() };
    Scene::textured(vec![geometry], vec![material], vec![texture], vec![Some(image)]).draw(gpu).at(0.1, 0.1)
}

/// The square with and without tangents.
fn squares() -> [Geometry; 2] {
    let tangents = vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 4];
    [Geometry { tangents, ..square(0) }, square(0)]
}

#[test]
fn a_flat_normal_map_changes_nothing_and_a_tilted_one_faces_its_light() {
    let Some(gpu) = gpu() else { return };
    let plain = Scene::new(vec![square(0)], vec![gray()]).draw(&gpu).at(0.1, 0.1);
    let mapped = |geometry, normal_scale, pixel| {
        let material = Material { normal_texture: MAP, normal_scale, ..gray() };
        middle(&gpu, geometry, material, flat_image(pixel))
    };
    for geometry in squares() {
        near(mapped(geometry.clone(), 1.0, [128, 128, 255, 255]), plain, 2);
        // The key light comes from above left.
        let [left, right, up, down] =
            [[38, 128, 218, 255], [218, 128, 218, 255], [128, 218, 218, 255], [128, 38, 218, 255]]
                .map(|pixel| mapped(geometry.clone(), 1.0, pixel)[1]);
        assert!(left > right + 12, "left {left}, right {right}, tangents {}", geometry.tangents.len());
        assert!(up > down + 12, "up {up}, down {down}, tangents {}", geometry.tangents.len());
        near(mapped(geometry, 0.0, [38, 128, 218, 255]), plain, 2);
    }
    let [with_tangents, without] = squares().map(|geometry| mapped(geometry, 1.0, [70, 90, 210, 255]));
    near(with_tangents, without, 2);
}

#[test]
fn white_occlusion_changes_nothing_and_black_darkens_by_its_strength() {
    let Some(gpu) = gpu() else { return };
    let plain = Scene::new(vec![square(0)], vec![gray()]).draw(&gpu).at(0.1, 0.1);
    let shown = |occlusion_strength, red| {
        let material = Material { occlusion_texture: MAP, occlusion_strength, ..gray() };
        middle(&gpu, square(0), material, flat_image([red, 77, 77, 255]))
    };
    near(shown(1.0, 255), plain, 0);
    near(shown(0.0, 0), plain, 0);
    let (half, full) = (shown(0.5, 0)[1], shown(1.0, 0)[1]);
    assert!(full + 5 < half && half + 5 < plain[1], "{full} < {half} < {}", plain[1]);
    near(shown(1.0, 128), shown(0.5, 0), 2);
}

#[test]
fn a_metallic_roughness_map_multiplies_the_factors() {
    let Some(gpu) = gpu() else { return };
    let material = |metallic, roughness| Material { metallic, roughness, ..gray() };
    let mapped = |material: Material, green, blue| {
        let material = Material { metallic_roughness_texture: MAP, ..material };
        middle(&gpu, square(0), material, flat_image([9, green, blue, 255]))
    };
    let plain = |material| Scene::new(vec![square(0)], vec![material]).draw(&gpu).at(0.1, 0.1);
    near(mapped(material(0.8, 0.4), 255, 255), plain(material(0.8, 0.4)), 1);
    near(mapped(material(1.0, 1.0), 102, 51), plain(material(0.2, 0.4)), 1);
    assert_ne!(mapped(material(1.0, 0.3), 255, 0), mapped(material(1.0, 0.3), 255, 255));
}

#[test]
fn mip_levels_average_linear_light() {
    let Some(gpu) = gpu() else { return };
    let edge = 8 * SIZE;
    let pixels = (0..edge * edge).flat_map(|at| [255 * ((at + at / edge) % 2) as u8; 3].into_iter().chain([255]));
    let image = ImageData::Rgba8 { width: edge, height: edge, pixels: pixels.collect() };
    let material = Material { base_color_texture: MAP, ..unlit(Vec4::ONE) };
    let shown = |mip| {
        let sampler = Sampler { mip, min: Filter::Linear, mag: Filter::Linear, ..Sampler::default() };
        let texture = Texture { image: Some(0), sampler };
        let images = vec![Some(image.clone())];
        Scene::textured(vec![square(0)], vec![material.clone()], vec![texture], images).draw(&gpu)
    };
    // Half the light is 188 of 255 in sRGB, not 128.
    for mip in [MipFilter::Nearest, MipFilter::Linear] {
        for (x, y) in [(0.1, 0.1), (-0.3, 0.2), (0.4, -0.4)] {
            near(shown(mip).at(x, y), [188, 188, 188, 255], 2);
        }
    }
}

#[test]
fn an_image_over_the_device_limit_is_downscaled() {
    let Some(gpu) = gpu() else { return };
    let width = gpu.device.limits().max_texture_dimension_2d + 2;
    let image = ImageData::Rgba8 { width, height: 1, pixels: [10, 200, 30, 255].repeat(width as usize) };
    let material = Material { base_color_texture: MAP, ..unlit(Vec4::ONE) };
    near(middle(&gpu, square(0), material, image), [10, 200, 30, 255], 1);
}

#[test]
fn the_mip_levels_of_a_ktx2_image_are_used_and_missing_ones_made() {
    let Some(gpu) = gpu() else { return };
    let edge = 8 * SIZE;
    let level = |edge: u32, pixel: [u8; 4]| pixel.repeat((edge * edge) as usize);
    let data = [level(edge, [255, 0, 0, 255]), level(edge / 2, [10, 200, 30, 255])].concat();
    let material = Material { base_color_texture: MAP, ..unlit(Vec4::ONE) };
    for (levels, expected) in [(1, [255, 0, 0, 255]), (2, [10, 200, 30, 255])] {
        let image = Ktx2 { format: Format::Rgba8, width: edge, height: edge, levels, data: data.clone() };
        let texture = Texture { image: Some(0), sampler: Sampler { mip: MipFilter::Linear, ..Sampler::default() } };
        let images = vec![Some(ImageData::Ktx2(image))];
        let shown = Scene::textured(vec![square(0)], vec![material.clone()], vec![texture], images).draw(&gpu);
        near(shown.at(0.1, 0.1), expected, 1);
    }
}

/// As a colour map, which is sRGB, and as data; close up, and far away on the smaller mip levels.
#[test]
fn ktx2_textures_look_the_same_in_every_format_of_the_device() {
    let Some(gpu) = gpu() else { return };
    let files = [
        &include_bytes!("../../../../tests/support/ktx2/etc1s.ktx2")[..],
        include_bytes!("../../../../tests/support/ktx2/etc1s-alpha.ktx2"),
        include_bytes!("../../../../tests/support/ktx2/uastc.ktx2"),
    ];
    let supported = texture_formats(gpu.device.features());
    let mut compared = Vec::new();
    for file in files {
        let shown = |formats: Formats, scale: f32, is_color: bool| {
            let output = decode(&request(formats, 4096, file)).expect("a sound file");
            let image = Ktx2::read(&output.bytes).expect("an answer of the transcoder");
            let format = image.format;
            let uv_transform = UvTransform { scale: Vec2::splat(scale), ..UvTransform::IDENTITY };
            let map = Some(TextureRef { uv_transform, ..MAP.expect("a map") });
            let material = match is_color {
                true => Material { base_color_texture: map, ..unlit(Vec4::ONE) },
                false => Material { metallic_roughness_texture: map, ..gray() },
            };
            let texture = Texture { image: Some(0), sampler: Sampler { mip: MipFilter::Linear, ..Sampler::default() } };
            let images = vec![Some(ImageData::Ktx2(image))];
            (format, Scene::textured(vec![square(0)], vec![material], vec![texture], images).draw(&gpu).0)
        };
        for formats in [Formats::BC7, Formats::ETC2, Formats::ASTC].into_iter().filter(|one| supported.contains(*one)) {
            for (scale, is_color) in [(1.0, true), (8.0, true), (1.0, false)] {
                let (_, plain) = shown(Formats::default(), scale, is_color);
                let (format, found) = shown(formats, scale, is_color);
                let difference: u32 = found.iter().zip(&plain).map(|(a, b)| u32::from(a.abs_diff(*b))).sum();
                let mean = f64::from(difference) / plain.len() as f64;
                assert!(
                    mean < 1.5,
                    "{format:?}, scale {scale}, colour {is_color}: the pictures differ by {mean} of 255"
                );
                compared.push(format);
            }
        }
    }
    println!("{supported:?}: {compared:?}");
}

/// A KTX2 file of 4 × 4 pixels of one colour with its mip levels. UASTC keeps such blocks exactly (mode 8, whose code is 10111).
fn uastc(color: [u8; 4]) -> Vec<u8> {
    const LEVELS: u32 = 3;
    // Linear RGB in blocks of 4 × 4 texels and 16 bytes: one sample of 128 bits.
    let description = [44, 0, 2 | 40 << 16, 166 | 1 << 16, 3 | 3 << 8, 16, 0, 127 << 16, 0, 0, u32::MAX];
    let after_index = 80 + 24 * LEVELS;
    // No Vulkan format, bytes, the size, one face, the levels, no supercompression.
    let header = [0, 1, 4, 4, 0, 0, 1, LEVELS, 0, after_index, description[0], 0, 0, 0, 0, 0, 0];
    let index = (0..LEVELS).flat_map(|level| [after_index + description[0] + 16 * level, 0, 16, 0, 16, 0]);
    let words = header.into_iter().chain(index).chain(description).flat_map(u32::to_le_bytes);
    let block = (u128::from(u32::from_le_bytes(color)) << 5 | 0b10111).to_le_bytes();
    MAGIC.into_iter().chain(words).chain(block.repeat(LEVELS as usize)).collect()
}

/// One image as a colour map, which is sRGB, and as a normal map, which is linear. The channels show both as they were encoded.
#[test]
fn a_ktx2_image_is_linear_as_a_normal_map_and_srgb_as_a_colour_map() {
    let color = [204, 128, 230, 255];
    let mut build = Build::triangle();
    let view = build.view(&uastc(color));
    build.json["images"] = json!([{ "bufferView": view, "mimeType": "image/ktx2" }]);
    build.json["textures"] = json!([{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }]);
    let map = json!({ "index": 0 });
    build.json["materials"] = json!([{ "normalTexture": map, "pbrMetallicRoughness": { "baseColorTexture": map } }]);
    build.json["extensionsRequired"] = json!(["KHR_texture_basisu"]);
    build.json["extensionsUsed"] = json!(["KHR_texture_basisu"]);
    let asset = build.loaded();
    let file = asset.images[0].bytes.clone();
    assert!(asset.warnings.is_empty(), "{:?}", asset.warnings);
    for gpu in [gpu(), gl()].into_iter().flatten() {
        let supported = texture_formats(gpu.device.features());
        let compressed = [Formats::BC7, Formats::ASTC].into_iter().filter(|one| supported.contains(*one));
        for formats in [Formats::default()].into_iter().chain(compressed) {
            let output = decode(&request(formats, 4096, &file)).expect("a sound file");
            let image = ImageData::Ktx2(Ktx2::read(&output.bytes).expect("an answer of the transcoder"));
            let [geometry, _] = squares();
            let (materials, textures) = (asset.materials.clone(), asset.textures.clone());
            let mut scene = Scene::textured(vec![geometry], materials, textures, vec![Some(image)]);
            for channel in [Channel::Normal, Channel::BaseColor] {
                scene.frame.look.channel = channel;
                near(scene.draw(&gpu).at(0.1, 0.1), color, 2);
            }
        }
    }
}

#[test]
fn multisampling_smooths_edges_and_keeps_the_area() {
    let Some(gpu) = gpu() else { return };
    let mut turned = square(0);
    for position in &mut turned.positions {
        let at = Affine2::from_angle(0.4).transform_point2(Vec2::new(position.x, position.y));
        *position = Vec3::new(at.x, at.y, 0.0);
    }
    let scene = Scene::new(vec![turned], vec![unlit(Vec4::ONE)]);
    let [hard, smooth] = [1, 4].map(|samples| scene.draw_with(&gpu, RendererOptions { samples }));
    let between = |pixels: &[u8]| pixels.as_chunks::<4>().0.iter().filter(|pixel| !matches!(pixel[3], 0 | 255)).count();
    assert_eq!(between(&hard.0), 0);
    assert!(between(&smooth.0) > SIZE as usize, "{}", between(&smooth.0));
    let area: f32 = smooth.0.as_chunks::<4>().0.iter().map(|pixel| f32::from(pixel[3]) / 255.0).sum();
    let expected = (SIZE * SIZE / 4) as f32;
    assert!((area - expected).abs() < 0.03 * expected, "{area} of {expected} pixels");
}

#[test]
fn thumbnails_show_the_images_as_they_are() {
    let Some(gpu) = gpu() else { return };
    let material = Material { base_color_texture: MAP, normal_texture: second(), ..gray() };
    let textures = [0, 1, 2].map(|image| Texture { image: Some(image), sampler: Sampler::default() });
    let images = [[200, 100, 50, 255], [128, 40, 250, 0], [1, 2, 3, 255]].map(flat_image).map(Some);
    let scene = Scene::textured(vec![square(0)], vec![material], textures.to_vec(), images.to_vec());
    let Gpu { device, queue } = &gpu;
    let mut renderer = Renderer::new(device, queue, RendererOptions { samples: 1 });
    renderer.upload(device, queue, &scene.model).unwrap();
    // Nothing uses the third.
    let thumbnails = renderer.thumbnails(device, queue, scene.model.id);
    let shown: Vec<Option<[u8; 4]>> = thumbnails
        .iter()
        .map(|view| view.as_ref().map(|view| gpu.read(view.texture(), 4)[..4].try_into().unwrap()))
        .collect();
    near(shown[0].unwrap(), [200, 100, 50, 255], 1);
    near(shown[1].unwrap(), [128, 40, 250, 255], 1);
    assert_eq!((shown.len(), shown[2]), (3, None));
    // Two images of one texel.
    let [geometry, images] = renderer.device_bytes();
    assert!(geometry >= 4 * (24 + 40) && images == 8, "{geometry}, {images}");
    renderer.retain(&[]);
    assert_eq!(renderer.device_bytes(), [0, 0]);
    assert!(renderer.thumbnails(device, queue, scene.model.id).is_empty());
}

fn second() -> Option<TextureRef> {
    Some(TextureRef { texture: 1, uv_set: 0, uv_transform: UvTransform::IDENTITY })
}
