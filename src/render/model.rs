//! A model on the GPU: its primitives with their materials.

use std::collections::HashMap;
use std::sync::Arc;

use wgpu::util::DeviceExt;

use super::UploadError;
use super::geometry::{GpuGeometry, edges};
use super::pipelines::{Features, Layouts, MATERIAL_MAPS, Shading};
use super::texture::{MipMaker, sampler, single_texel};
use super::uniforms::{MaterialUniform, UvTransformUniform};
use crate::asset::Asset;
use crate::library::{Model, ModelId};
use crate::mesh::{AlphaMode, Geometry, Material, Sampler, TextureRef, Topology, smooth_normals};

pub(super) struct GpuModel {
    pub id: ModelId,
    asset: Arc<Asset>,
    /// The primitives of each mesh; none for one with nothing to draw.
    pub meshes: Vec<Vec<Option<GpuPrimitive>>>,
}

pub(super) struct GpuPrimitive {
    pub geometry: GpuGeometry,
    pub bind_group: wgpu::BindGroup,
    pub shading: Shading,
    pub features: Features,
    pub double_sided: bool,
    /// Blended surfaces cast a shadow only if they are more than half opaque.
    pub casts_shadow: bool,
    /// Index buffer of the edges and its length; built when the wireframe is first shown.
    pub edges: Option<(wgpu::Buffer, u32)>,
}

/// Uploads models. Holds the mipmap pipelines and placeholders for missing maps and vertex data.
pub(super) struct ModelUploader {
    mips: MipMaker,
    white: wgpu::TextureView,
    no_numbers: wgpu::TextureView,
    anisotropy: u16,
}

impl ModelUploader {
    /// `anisotropy` should be 1 on software adapters.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, anisotropy: u16) -> Self {
        Self {
            mips: MipMaker::new(device),
            white: single_texel(device, queue, wgpu::TextureFormat::Rgba8Unorm, &[255; 4]),
            no_numbers: single_texel(device, queue, wgpu::TextureFormat::Rgba32Float, &[0; 16]),
            anisotropy,
        }
    }

    pub fn upload(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layouts: &Layouts,
        model: &Model,
    ) -> Result<GpuModel, UploadError> {
        let asset = &model.asset;
        let mut materials = Materials {
            uploader: self,
            device,
            queue,
            model,
            images: HashMap::new(),
            samplers: HashMap::new(),
            created: HashMap::new(),
        };
        let mut meshes = Vec::with_capacity(asset.meshes.len());
        for (mesh_index, mesh) in asset.meshes.iter().enumerate() {
            let mut primitives = Vec::with_capacity(mesh.primitives.len());
            let smooth = smooth_normals(&mesh.primitives);
            for (primitive_index, (geometry, smooth)) in mesh.primitives.iter().zip(&smooth).enumerate() {
                let drawable = geometry.indices.len() >= geometry.topology.indices_per_element();
                primitives.push(match drawable {
                    false => None,
                    true => {
                        let gpu = GpuGeometry::new(device, queue, geometry, smooth, mesh_index, primitive_index)?;
                        Some(materials.primitive(layouts, geometry, gpu))
                    }
                });
            }
            meshes.push(primitives);
        }
        Ok(GpuModel { id: model.id, asset: asset.clone(), meshes })
    }
}

impl GpuModel {
    /// Builds the edge lists of a mesh on first use.
    pub fn prepare_edges(&mut self, device: &wgpu::Device, mesh: usize) {
        let (Some(mesh), Some(primitives)) = (self.asset.meshes.get(mesh), self.meshes.get_mut(mesh)) else { return };
        for (geometry, primitive) in mesh.primitives.iter().zip(primitives) {
            let Some(primitive) = primitive.as_mut().filter(|primitive| primitive.edges.is_none()) else { continue };
            let indices = edges(&geometry.indices);
            let buffer = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("edges"),
                contents: bytemuck::cast_slice(&indices),
                usage: wgpu::BufferUsages::INDEX,
            });
            primitive.edges = Some((buffer, indices.len() as u32));
        }
    }
}

/// A material's uniform buffer and maps, shared by the primitives that use it.
struct GpuMaterial {
    uniform: wgpu::Buffer,
    maps: [Option<(wgpu::TextureView, wgpu::Sampler)>; MATERIAL_MAPS],
}

/// Materials of a model during upload. An image is uploaded once as sRGB and once as linear, as its uses require.
struct Materials<'a> {
    uploader: &'a mut ModelUploader,
    device: &'a wgpu::Device,
    queue: &'a wgpu::Queue,
    model: &'a Model,
    images: HashMap<(usize, bool), Option<wgpu::TextureView>>,
    samplers: HashMap<Sampler, wgpu::Sampler>,
    created: HashMap<Option<usize>, GpuMaterial>,
}

impl Materials<'_> {
    fn primitive(&mut self, layouts: &Layouts, geometry: &Geometry, gpu: GpuGeometry) -> GpuPrimitive {
        let default = Material::default();
        let asset = self.model.asset.clone();
        let found = geometry.material.and_then(|index| asset.materials.get(index));
        let material = found.unwrap_or(&default);
        let key = found.and(geometry.material);
        if !self.created.contains_key(&key) {
            let created = self.create(material);
            self.created.insert(key, created);
        }
        let plain = self
            .samplers
            .entry(Sampler::default())
            .or_insert_with(|| sampler(self.device, &Sampler::default(), self.uploader.anisotropy));
        let gpu_material = &self.created[&key];
        let bind_group = primitive_bind_group(self.device, layouts, gpu_material, &gpu, plain, self.uploader);
        // Points and lines without normals have no side to light (glTF 2.0 §3.7.2.1).
        let unlit = material.unlit || (geometry.topology != Topology::Triangles && geometry.normals.is_empty());
        let blend = material.alpha_mode == AlphaMode::Blend;
        GpuPrimitive {
            bind_group,
            shading: if unlit { Shading::Unlit } else { Shading::Lit },
            features: features(material, &gpu_material.maps, geometry),
            double_sided: material.double_sided,
            casts_shadow: geometry.topology == Topology::Triangles && (!blend || material.base_color.w > 0.5),
            edges: None,
            geometry: gpu,
        }
    }

    fn create(&mut self, material: &Material) -> GpuMaterial {
        let references = [
            (material.base_color_texture, true),
            (material.metallic_roughness_texture, false),
            (material.normal_texture, false),
            (material.occlusion_texture, false),
            (material.emissive_texture, true),
        ];
        let uniform = MaterialUniform {
            base_color: material.base_color.to_array(),
            // KHR_materials_unlit ignores it, unlike glTF's points and lines without normals.
            emissive: if material.unlit { [0.0; 3] } else { material.emissive.to_array() },
            alpha_cutoff: match material.alpha_mode {
                AlphaMode::Mask { cutoff } => cutoff,
                // Cuts holes into the shadows of blended surfaces.
                AlphaMode::Opaque | AlphaMode::Blend => 0.5,
            },
            metallic: material.metallic,
            roughness: material.roughness,
            normal_scale: material.normal_scale,
            occlusion_strength: material.occlusion_strength,
            uvs: references.map(|(reference, _)| reference.map_or_else(UvTransformUniform::default, uv_transform)),
        };
        let uniform = self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("material"),
            contents: bytemuck::bytes_of(&uniform),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        GpuMaterial { uniform, maps: references.map(|(reference, srgb)| self.map(reference?, srgb)) }
    }

    fn map(&mut self, reference: TextureRef, srgb: bool) -> Option<(wgpu::TextureView, wgpu::Sampler)> {
        let texture = self.model.asset.textures.get(reference.texture)?;
        let image = texture.image?;
        let view = self
            .images
            .entry((image, srgb))
            .or_insert_with(|| {
                let data = self.model.images.get(image)?.as_ref()?;
                self.uploader.mips.upload(self.device, self.queue, data, srgb)
            })
            .clone()?;
        let sampler = self
            .samplers
            .entry(texture.sampler)
            .or_insert_with(|| sampler(self.device, &texture.sampler, self.uploader.anisotropy))
            .clone();
        Some((view, sampler))
    }
}

/// The parts of the surface shader that a primitive needs.
fn features(
    material: &Material,
    maps: &[Option<(wgpu::TextureView, wgpu::Sampler)>; MATERIAL_MAPS],
    geometry: &Geometry,
) -> Features {
    // A map without texture coordinates is ignored; otherwise its first texel would colour everything.
    let has = |slot: usize, reference: Option<TextureRef>| {
        maps[slot].is_some() && reference.is_some_and(|reference| !geometry.uvs[reference.uv_set & 1].is_empty())
    };
    Features::default()
        .with(Features::BASE_COLOR_MAP, has(0, material.base_color_texture))
        .with(Features::METALLIC_ROUGHNESS_MAP, has(1, material.metallic_roughness_texture))
        .with(Features::NORMAL_MAP, has(2, material.normal_texture))
        .with(Features::OCCLUSION_MAP, has(3, material.occlusion_texture))
        .with(Features::EMISSIVE_MAP, !material.unlit && has(4, material.emissive_texture))
        .with(Features::VERTEX_COLORS, !geometry.colors.is_empty())
        .with(Features::FLAT, geometry.normals.is_empty())
        .with(Features::TANGENTS, !geometry.tangents.is_empty())
        .with(Features::MASK, matches!(material.alpha_mode, AlphaMode::Mask { .. }))
        .with(Features::BLEND, material.alpha_mode == AlphaMode::Blend)
}

/// `plain` is the sampler of the maps that the material does not have.
fn primitive_bind_group(
    device: &wgpu::Device,
    layouts: &Layouts,
    material: &GpuMaterial,
    geometry: &GpuGeometry,
    plain: &wgpu::Sampler,
    placeholders: &ModelUploader,
) -> wgpu::BindGroup {
    let mut entries = vec![wgpu::BindGroupEntry { binding: 0, resource: material.uniform.as_entire_binding() }];
    for (slot, map) in material.maps.iter().enumerate() {
        let (view, sampler) = map.as_ref().map_or((&placeholders.white, plain), |(view, sampler)| (view, sampler));
        let binding = 1 + 2 * slot as u32;
        entries.push(wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) });
        entries.push(wgpu::BindGroupEntry { binding: binding + 1, resource: wgpu::BindingResource::Sampler(sampler) });
    }
    let numbers = [(11, &geometry.morph_view), (12, &geometry.influence_view)];
    entries.extend(numbers.map(|(binding, numbers)| wgpu::BindGroupEntry {
        binding,
        resource: wgpu::BindingResource::TextureView(numbers.as_ref().unwrap_or(&placeholders.no_numbers)),
    }));
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("primitive"),
        layout: &layouts.primitive,
        entries: &entries,
    })
}

/// KHR_texture_transform: `offset · rotation · scale`. The rotation is counter-clockwise on the image, whose v axis
/// points down, hence its sign.
fn uv_transform(reference: TextureRef) -> UvTransformUniform {
    let transform = reference.uv_transform;
    let (sin, cos) = transform.rotation_radians.sin_cos();
    UvTransformUniform {
        matrix: [cos * transform.scale.x, -sin * transform.scale.x, sin * transform.scale.y, cos * transform.scale.y],
        offset: transform.offset.to_array(),
        uv_set: reference.uv_set as u32,
        padding: 0,
    }
}
