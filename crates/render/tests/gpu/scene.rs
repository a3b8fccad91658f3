//! Surfaces in front of a camera, drawn into a small picture.

use gaitway_character::asset::{Asset, AssetParts, Image};
use gaitway_character::mesh::{Bounds, Geometry, Material, Mesh, SkinningMode, Texture, palette_entry};
use gaitway_render::{Renderer, RendererOptions, read_pixels};
use gaitway_scene::frame::{Character, Draw, Frame, View};
use gaitway_scene::library::{ImageData, Model, ModelId};
use gaitway_scene::state::Background;
use glam::camera::rh::proj::directx::orthographic;
use glam::camera::rh::view::look_at_mat4;
use glam::{Affine3A, Vec2, Vec3, Vec4};

use crate::device::Gpu;

pub const SIZE: u32 = 32;

/// A square from −0.5 to 0.5 at z = 0, facing +Z.
pub fn square(material: usize) -> Geometry {
    let corners = [Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(1.0, 0.0), Vec2::ZERO];
    Geometry {
        positions: corners.map(|uv| Vec3::new(uv.x - 0.5, 0.5 - uv.y, 0.0)).to_vec(),
        normals: vec![Vec3::Z; 4],
        uvs: [corners.to_vec(), Vec::new()],
        indices: vec![0, 1, 2, 0, 2, 3],
        material: Some(material),
        file_vertices: 4,
        ..Default::default()
    }
}

pub fn unlit(color: Vec4) -> Material {
    Material { base_color: color, unlit: true, metallic: 0.0, ..Default::default() }
}

/// One mesh per geometry at the origin, seen from +Z; the picture spans −1 to 1.
pub struct Scene {
    pub model: Model,
    pub frame: Frame,
}

impl Scene {
    pub fn new(geometries: Vec<Geometry>, materials: Vec<Material>) -> Self {
        Self::textured(geometries, materials, Vec::new(), Vec::new())
    }

    /// A scene with this many material variants, whose names don't matter.
    pub fn with_variants(geometries: Vec<Geometry>, materials: Vec<Material>, variants: usize) -> Self {
        let variants = (0..variants).map(|index| index.to_string()).collect();
        let parts = AssetParts { materials, variants, ..AssetParts::default() };
        Self::of_parts(geometries, parts, Vec::new())
    }

    pub fn textured(
        geometries: Vec<Geometry>,
        materials: Vec<Material>,
        textures: Vec<Texture>,
        images: Vec<Option<ImageData>>,
    ) -> Self {
        // The pixels are passed separately; only the number of image files matters.
        let file = Image { name: String::new(), mime: "image/png", width: 1, height: 1, ..Image::default() };
        let files = vec![file; images.len()];
        let parts = AssetParts { materials, textures, images: files, ..AssetParts::default() };
        Self::of_parts(geometries, parts, images)
    }

    fn of_parts(geometries: Vec<Geometry>, parts: AssetParts, images: Vec<Option<ImageData>>) -> Self {
        let count = geometries.len();
        let meshes =
            geometries.into_iter().map(|geometry| Mesh { primitives: vec![geometry], ..Default::default() }).collect();
        let asset = Asset::new(AssetParts { meshes, ..parts }).expect("indices in range");
        let eye = Vec3::new(0.0, 0.0, 5.0);
        let mut frame = Frame::default();
        frame.view = View {
            view_from_world: look_at_mat4(eye, Vec3::ZERO, Vec3::Y),
            projection_from_view: orthographic(-1.0, 1.0, -1.0, 1.0, 1.0, 9.0),
            eye,
        };
        frame.bounds = Bounds { min: Vec3::splat(-0.5), max: Vec3::splat(0.5) };
        frame.look.shadow = false;
        frame.look.background = Background::Transparent;
        frame.characters.push(Character {
            model: ModelId::default(),
            palette: vec![palette_entry(&Affine3A::IDENTITY, SkinningMode::Linear)],
            draws: (0..count)
                .map(|mesh| Draw {
                    instance: mesh,
                    mesh,
                    is_copy: false,
                    visible: true,
                    palette: 0..1,
                    morph_weights: 0..0,
                    mirrored: false,
                    heat_joint: None,
                    center: Vec3::ZERO,
                })
                .collect(),
            ..Default::default()
        });
        Self { model: Model::new(String::new(), asset, images), frame }
    }

    /// Adds a transformed copy of the only mesh.
    pub fn add_copy(&mut self, world_from_copy: Affine3A) {
        let character = &mut self.frame.characters[0];
        let next = character.palette.len() as u32;
        character.palette.push(palette_entry(&world_from_copy, SkinningMode::Linear));
        let first = &character.draws[0];
        let center = world_from_copy.translation.into();
        let copy = Draw {
            is_copy: true,
            palette: next..next + 1,
            center,
            mirrored: world_from_copy.matrix3.determinant() < 0.0,
            ..first.clone()
        };
        character.draws.push(copy);
    }

    pub fn draw(&self, gpu: &Gpu) -> Picture {
        self.draw_with(gpu, RendererOptions { samples: 1 })
    }

    pub fn draw_with(&self, gpu: &Gpu, options: RendererOptions) -> Picture {
        let Gpu { device, queue } = gpu;
        let mut renderer = Renderer::new(device, queue, options);
        renderer.upload(device, queue, &self.model).unwrap();
        renderer.draw(device, queue, &self.frame, [SIZE, SIZE]);
        Picture(pollster::block_on(read_pixels(device, queue, renderer.output())))
    }
}

pub struct Picture(pub Vec<u8>);

impl Picture {
    /// Returns the pixel at x and y from −1 to 1, right and up.
    pub fn at(&self, x: f32, y: f32) -> [u8; 4] {
        let pixel = |at: f32| ((0.5 + 0.5 * at) * SIZE as f32) as usize;
        let offset = 4 * (pixel(-y) * SIZE as usize + pixel(x));
        self.0[offset..offset + 4].try_into().unwrap()
    }

    pub fn covered(&self) -> usize {
        self.0.as_chunks::<4>().0.iter().filter(|pixel| pixel[3] > 0).count()
    }
}

#[track_caller]
pub fn near(found: [u8; 4], expected: [u8; 4], tolerance: u8) {
    let differs = found.iter().zip(expected).any(|(a, b)| a.abs_diff(b) > tolerance);
    assert!(!differs, "{found:?} instead of {expected:?}");
}
